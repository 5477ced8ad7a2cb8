//! Admissible functions in each phase, and random sequences of calls.

use core::ffi::c_void;
use std::ptr;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::Status;

use test_support::Random;
use test_support::importer::{Importer, STAGES, Stage, reference};

const OK: Status = Status::Ok;
const DISCARD: Status = Status::Discard;
const ERROR: Status = Status::Error;

/// A function, the phases in which it is allowed (i: instantiated, n: initialization mode, s: step
/// complete, t: terminated, e: error), its status there, and a call of it with good arguments. `c` and
/// `s` are an instance and an FMU state.
pub(crate) type Row = (&'static str, &'static str, Status, fn(*mut c_void, *mut c_void) -> Status);

// SAFETY of all: the arrays and places are there.
pub(crate) const GRID: &[Row] = &[
    ("fmi2SetDebugLogging", "inste", OK, |c, _| unsafe { fmi2SetDebugLogging(c, 0, 0, ptr::null()) }),
    ("fmi2SetupExperiment", "i", OK, |c, _| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, 100.0) }),
    ("fmi2EnterInitializationMode", "i", OK, |c, _| unsafe { fmi2EnterInitializationMode(c) }),
    ("fmi2ExitInitializationMode", "n", OK, |c, _| unsafe { fmi2ExitInitializationMode(c) }),
    ("fmi2Terminate", "se", OK, |c, _| unsafe { fmi2Terminate(c) }),
    ("fmi2Reset", "inste", OK, |c, _| unsafe { fmi2Reset(c) }),
    ("fmi2GetReal", "inste", OK, |c, _| unsafe { fmi2GetReal(c, &0, 1, &mut 0.0) }),
    ("fmi2GetInteger", "inste", OK, |c, _| unsafe { fmi2GetInteger(c, &reference("contact.faces"), 1, &mut 0) }),
    ("fmi2GetBoolean", "inste", OK, |c, _| unsafe {
        fmi2GetBoolean(c, &reference("contact.shear_coupling"), 1, &mut 0)
    }),
    ("fmi2GetString", "inste", OK, |c, _| unsafe { fmi2GetString(c, ptr::null(), 0, ptr::null_mut()) }),
    ("fmi2SetReal", "ins", OK, |c, _| unsafe { fmi2SetReal(c, &0, 1, &1.0) }),
    ("fmi2SetInteger", "in", OK, |c, _| unsafe { fmi2SetInteger(c, &reference("contact.faces"), 1, &1) }),
    ("fmi2SetBoolean", "in", OK, |c, _| unsafe { fmi2SetBoolean(c, &reference("contact.shear_coupling"), 1, &1) }),
    ("fmi2SetString", "ins", OK, |c, _| unsafe { fmi2SetString(c, ptr::null(), 0, ptr::null()) }),
    ("fmi2GetFMUstate", "inste", OK, |c, mut s| unsafe { fmi2GetFMUstate(c, &mut s) }),
    ("fmi2SetFMUstate", "inste", OK, |c, s| unsafe { fmi2SetFMUstate(c, s) }),
    ("fmi2FreeFMUstate", "inste", OK, |c, _| unsafe { fmi2FreeFMUstate(c, &mut ptr::null_mut()) }),
    ("fmi2SerializedFMUstateSize", "inste", OK, |c, s| unsafe { fmi2SerializedFMUstateSize(c, s, &mut 0) }),
    ("fmi2SerializeFMUstate", "inste", OK, |c, s| {
        let (mut size, mut bytes) = (0, vec![0; 1 << 16]);
        let status = unsafe { fmi2SerializedFMUstateSize(c, s, &mut size) };
        assert!(size <= bytes.len());
        if status == OK { unsafe { fmi2SerializeFMUstate(c, s, bytes.as_mut_ptr(), size) } } else { status }
    }),
    ("fmi2DeSerializeFMUstate", "inste", ERROR, |c, _| unsafe {
        fmi2DeSerializeFMUstate(c, ptr::null(), 0, &mut ptr::null_mut())
    }),
    ("fmi2GetDirectionalDerivative", "nste", OK, |c, _| unsafe {
        fmi2GetDirectionalDerivative(c, ptr::null(), 0, ptr::null(), 0, ptr::null(), ptr::null_mut())
    }),
    ("fmi2SetRealInputDerivatives", "ins", OK, |c, _| unsafe { fmi2SetRealInputDerivatives(c, &0, 1, &1, &0.5) }),
    // Where an input is no number there is none to tell.
    ("fmi2GetRealOutputDerivatives", "st", OK, |c, _| unsafe {
        fmi2GetRealOutputDerivatives(c, &reference("wear_depth"), 1, &1, &mut 0.0)
    }),
    ("fmi2DoStep", "s", OK, |c, _| {
        let mut time = 0.0;
        let _ = unsafe { fmi2GetRealStatus(c, 2, &mut time) };
        unsafe { fmi2DoStep(c, time, 0.01, 1) }
    }),
    ("fmi2CancelStep", "", ERROR, |c, _| unsafe { fmi2CancelStep(c) }),
    ("fmi2GetStatus", "ste", DISCARD, |c, _| unsafe { fmi2GetStatus(c, 0, &mut Status::Ok) }),
    ("fmi2GetRealStatus", "ste", OK, |c, _| unsafe { fmi2GetRealStatus(c, 2, &mut 0.0) }),
    ("fmi2GetIntegerStatus", "ste", DISCARD, |c, _| unsafe { fmi2GetIntegerStatus(c, 0, &mut 0) }),
    ("fmi2GetBooleanStatus", "ste", OK, |c, _| unsafe { fmi2GetBooleanStatus(c, 3, &mut 0) }),
    ("fmi2GetStringStatus", "ste", DISCARD, |c, _| unsafe { fmi2GetStringStatus(c, 1, &mut ptr::null()) }),
    // Of model exchange: their arguments are never used.
    ("fmi2EnterEventMode", "", ERROR, |c, _| unsafe { fmi2EnterEventMode(c) }),
    ("fmi2NewDiscreteStates", "", ERROR, |c, _| unsafe { fmi2NewDiscreteStates(c, ptr::null_mut()) }),
    ("fmi2EnterContinuousTimeMode", "", ERROR, |c, _| unsafe { fmi2EnterContinuousTimeMode(c) }),
    ("fmi2CompletedIntegratorStep", "", ERROR, |c, _| unsafe {
        fmi2CompletedIntegratorStep(c, 1, ptr::null_mut(), ptr::null_mut())
    }),
    ("fmi2SetTime", "", ERROR, |c, _| unsafe { fmi2SetTime(c, 0.0) }),
    ("fmi2SetContinuousStates", "", ERROR, |c, _| unsafe { fmi2SetContinuousStates(c, ptr::null(), 1) }),
    ("fmi2GetDerivatives", "", ERROR, |c, _| unsafe { fmi2GetDerivatives(c, ptr::null_mut(), 1) }),
    ("fmi2GetEventIndicators", "", ERROR, |c, _| unsafe { fmi2GetEventIndicators(c, ptr::null_mut(), 1) }),
    ("fmi2GetContinuousStates", "", ERROR, |c, _| unsafe { fmi2GetContinuousStates(c, ptr::null_mut(), 1) }),
    ("fmi2GetNominalsOfContinuousStates", "", ERROR, |c, _| unsafe {
        fmi2GetNominalsOfContinuousStates(c, ptr::null_mut(), usize::MAX)
    }),
];

#[test]
fn each_function_is_allowed_in_its_phases_only() {
    let mut donor = ptr::null_mut();
    let other = Importer::at(Stage::Instantiated);
    assert_eq!(other.save(&mut donor), OK);
    for &(name, allowed, status, call) in GRID {
        for (stage, letter) in STAGES {
            let importer = Importer::at(stage);
            let before = importer.bytes();
            let expected = if allowed.contains(letter) { status } else { ERROR };
            assert_eq!(call(importer.component, donor), expected, "{name}, {stage:?}: {:?}", importer.take_log());
            if expected != OK {
                assert_eq!(importer.bytes(), before, "{name}, {stage:?}");
                let log = importer.take_log();
                let explained = log.iter().any(|entry| entry.0 == expected && entry.2.starts_with(name));
                assert!(explained, "{name}, {stage:?}: {log:?}");
            }
        }
    }
    assert_eq!(other.free(&mut donor), OK);
}

/// The phase after a call that succeeded, by name of the function.
fn moved(name: &str, from: Stage) -> Stage {
    match name {
        "fmi2EnterInitializationMode" => Stage::Initialization,
        "fmi2ExitInitializationMode" => Stage::Stepping,
        "fmi2Terminate" => Stage::Terminated,
        "fmi2Reset" => Stage::Instantiated,
        _ => from,
    }
}

/// Whether the sequences of this seed leave the level to `auto`, whose plans and finer model levels take most of the time.
fn planned(seed: usize) -> bool {
    seed.is_multiple_of(15)
}

/// Takes the lumped level, except where the sequences of this seed are `planned`.
fn level(importer: &Importer, seed: usize) {
    if !planned(seed) {
        assert_eq!(importer.set_integer("solver.fidelity", 2), OK);
    }
}

#[test]
fn random_sequences_keep_to_the_state_machine() {
    for seed in 1..=60_usize {
        let mut random = Random(seed as u64 * 0x9e37_79b9);
        let importer = Importer::new();
        level(&importer, seed);
        let mut stage = Stage::Instantiated;
        for _ in 0..200 {
            let (name, allowed, status, call) = GRID[(random.next() * GRID.len() as f64) as usize];
            if name.contains("FMUstate") {
                continue;
            }
            let letter = STAGES.iter().find(|entry| entry.0 == stage).unwrap().1;
            // A state taken before every call and set at times: sequences may jump back.
            let before = importer.bytes();
            let expected = if allowed.contains(letter) { status } else { ERROR };
            assert_eq!(call(importer.component, ptr::null_mut()), expected, "{seed}, {name}, {stage:?}");
            if expected == OK {
                if random.next() < 0.25 {
                    let mut state = importer.deserialize(&before).unwrap();
                    assert_eq!(importer.restore(state), OK);
                    assert_eq!(importer.bytes(), before);
                    assert_eq!(importer.free(&mut state), OK);
                } else {
                    stage = moved(name, stage);
                    if name == "fmi2Reset" {
                        level(&importer, seed);
                    }
                }
            } else {
                assert_eq!(importer.bytes(), before, "{seed}, {name}, {stage:?}");
            }
        }
        assert_eq!(importer.reset(), OK);
        assert_eq!(importer.bytes(), Importer::new().bytes(), "{seed}: a reset instance is as new");
    }
}
