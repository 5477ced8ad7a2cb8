//! Calls and values with the status that each must return; [`super::sequences`] has every function in every phase.

use std::ptr;

use model::lumped::conditions::Tunables;
use scene::variables::COUNT;
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::Status;

use test_support::importer::Stage::{self, *};
use test_support::importer::{Importer, reference};

const OK: Status = Status::Ok;
const DISCARD: Status = Status::Discard;
const ERROR: Status = Status::Error;

/// One call: in which phases, what, the status, and a part of the message that says why.
type Case = (&'static [Stage], &'static str, fn(&Importer) -> Status, Status, &'static str);

const I: &[Stage] = &[Instantiated];
const S: &[Stage] = &[Stepping];
const IN: &[Stage] = &[Instantiated, Initialization];
const INS: &[Stage] = &[Instantiated, Initialization, Stepping];
const STE: &[Stage] = &[Stepping, Terminated, Failed];
const ALL: &[Stage] = &[Instantiated, Initialization, Stepping, Terminated, Failed];

fn status<T>(result: Result<T, Status>) -> Status {
    result.err().unwrap_or(OK)
}

/// An odd address that nothing may be read from.
fn nowhere<T>() -> *mut T {
    ptr::without_provenance_mut(7)
}

const CASES: &[Case] = &[
    // The experiment.
    (I, "no tolerance, no stop (both NaN)", |x| x.setup(None, 0.0, None), OK, ""),
    (I, "start before 0", |x| x.setup(Some(1e-4), -5.0, Some(10.0)), OK, ""),
    (I, "stop at the start", |x| x.setup(None, 3.0, Some(3.0)), OK, ""),
    (I, "tolerance 0", |x| x.setup(Some(0.0), 0.0, None), ERROR, "tolerance 0"),
    (I, "tolerance -1", |x| x.setup(Some(-1.0), 0.0, None), ERROR, "tolerance -1"),
    (I, "tolerance NaN", |x| x.setup(Some(f64::NAN), 0.0, None), ERROR, "tolerance NaN"),
    (I, "start infinite", |x| x.setup(None, f64::INFINITY, None), ERROR, "start time inf"),
    (I, "stop NaN", |x| x.setup(None, 0.0, Some(f64::NAN)), ERROR, "stop time NaN"),
    (I, "stop before the start", |x| x.setup(None, 1.0, Some(0.5)), ERROR, "stop time 0.5"),
    // Inputs take any value while they can be set.
    (INS, "input", |x| x.set_real(&["sliding_velocity"], &[1.5]), OK, ""),
    (INS, "input NaN is stored", |x| x.set_real(&["sliding_velocity"], &[f64::NAN]), OK, ""),
    (INS, "input infinite is stored", |x| x.set_real(&["normal_load"], &[f64::INFINITY]), OK, ""),
    (INS, "load below zero", |x| x.set_real(&["normal_load"], &[-10.0]), OK, ""),
    (INS, "the same input twice", |x| x.set_real(&["normal_load", "normal_load"], &[1.0, 2.0]), OK, ""),
    // Parameters.
    (IN, "fixed parameter", |x| x.set_real(&["punch.height"], &[0.02]), OK, ""),
    (S, "fixed parameter after initialisation", |x| x.set_real(&["punch.height"], &[0.02]), ERROR, "fixed parameter"),
    (INS, "tunable parameter", |x| x.set_real(&["contact.friction_coefficient"], &[0.3]), OK, ""),
    (
        INS,
        "all that is tunable",
        |x| x.set_real(&Tunables::NAMES, &[0.3, 290.0, 2.0, 1e-14, 1e-15, 20.0, 30.0, 0.0, 2.0, 1e4]),
        OK,
        "",
    ),
    (S, "wear coefficient below 0", |x| x.set_real(&["punch.wear_coefficient"], &[-1e-15]), DISCARD, "-1e-15"),
    (S, "convection NaN", |x| x.set_real(&["strip.convection"], &[f64::NAN]), DISCARD, "strip.convection"),
    (
        S,
        "heat path above its maximum",
        |x| x.set_real(&["punch.external_conductance"], &[1e10]),
        DISCARD,
        "punch.external_conductance: 1",
    ),
    (INS, "tunable below its minimum", |x| x.set_real(&["contact.friction_coefficient"], &[-0.1]), DISCARD, "-0.1"),
    (IN, "parameter below its minimum", |x| x.set_real(&["punch.height"], &[-1.0]), DISCARD, "punch.height: -1 m"),
    (IN, "parameter NaN", |x| x.set_real(&["punch.height"], &[f64::NAN]), DISCARD, "not a finite number"),
    (IN, "parameter infinite", |x| x.set_real(&["depth"], &[f64::INFINITY]), DISCARD, "depth"),
    (
        IN,
        "a refused value behind good ones",
        |x| x.set_real(&["strip.height", "sliding_velocity", "punch.height"], &[0.033, 9.0, -1.0]),
        DISCARD,
        "punch.height",
    ),
    (
        IN,
        "all refused values are named",
        |x| x.set_real(&["punch.height", "strip.height"], &[-1.0, -2.0]),
        DISCARD,
        "strip.height: -2 m",
    ),
    (
        IN,
        "a wrong reference behind a refused value",
        |x| x.set_reals(&[reference("punch.height"), COUNT as u32], &[-1.0, 1.0]),
        ERROR,
        "unknown",
    ),
    (
        INS,
        "an output behind an input",
        |x| x.set_real(&["sliding_velocity", "wear_depth"], &[7.0, 1.0]),
        ERROR,
        "wear_depth",
    ),
    (IN, "integer", |x| x.set_integer("contact.faces", 2), OK, ""),
    (IN, "integer below its minimum", |x| x.set_integer("contact.faces", 0), DISCARD, "contact.faces: 0"),
    (S, "integer after initialisation", |x| x.set_integer("contact.faces", 2), ERROR, "contact.faces"),
    (IN, "first item", |x| x.set_integer("solver.fidelity", 1), OK, ""),
    (IN, "item 0", |x| x.set_integer("solver.fidelity", 0), DISCARD, "solver.fidelity: 0"),
    (IN, "item 5 of 4", |x| x.set_integer("solver.fidelity", 5), DISCARD, "lumped"),
    (IN, "lowest integer as an item", |x| x.set_integer("punch.body", i32::MIN), DISCARD, "punch.body"),
    (IN, "boolean true", |x| x.set_boolean("contact.shear_coupling", 1), OK, ""),
    (IN, "boolean false", |x| x.set_boolean("contact.shear_coupling", 0), OK, ""),
    (IN, "boolean 2", |x| x.set_boolean("contact.shear_coupling", 2), DISCARD, "contact.shear_coupling: 2"),
    (IN, "boolean -1", |x| x.set_boolean("contact.shear_coupling", -1), DISCARD, "contact.shear_coupling: -1"),
    // Variables that cannot be set.
    (INS, "output", |x| x.set_real(&["wear_depth"], &[0.0]), ERROR, "wear_depth is calculated"),
    (INS, "integer output", |x| x.set_integer("limit_reached", 0), ERROR, "limit_reached is calculated"),
    (INS, "local", |x| x.set_real(&["profile.pressure[33]"], &[0.0]), ERROR, "profile.pressure[33]"),
    (INS, "unknown reference", |x| x.set_reals(&[COUNT as u32], &[0.0]), ERROR, "unknown"),
    (INS, "highest reference", |x| x.set_reals(&[u32::MAX], &[0.0]), ERROR, "4294967295"),
    (INS, "Real as Integer", |x| x.set_integer("normal_load", 1), ERROR, "normal_load"),
    (IN, "Integer as Real", |x| x.set_real(&["contact.faces"], &[1.0]), ERROR, "not Real"),
    (IN, "Boolean as Integer", |x| x.set_integer("contact.shear_coupling", 1), ERROR, "is Boolean"),
    (IN, "enumeration as Boolean", |x| x.set_boolean("solver.fidelity", 1), ERROR, "solver.fidelity"),
    // Reading.
    (ALL, "output", |x| status(x.get_reals(&[reference("wear_depth")])), OK, ""),
    (ALL, "input", |x| status(x.get_reals(&[reference("normal_load")])), OK, ""),
    (ALL, "parameter", |x| status(x.get_reals(&[reference("punch.height")])), OK, ""),
    (ALL, "local", |x| status(x.get_reals(&[reference("profile.temperature[1]")])), OK, ""),
    (ALL, "integer output", |x| status(x.get_integer("limit_reached")), OK, ""),
    (ALL, "enumeration", |x| status(x.get_integer("solver.fidelity")), OK, ""),
    (ALL, "boolean", |x| status(x.get_boolean("contact.shear_coupling")), OK, ""),
    (ALL, "get Integer as Real", |x| status(x.get_reals(&[reference("limit_reached")])), ERROR, "limit_reached"),
    (ALL, "get Real as Integer", |x| status(x.get_integer("wear_depth")), ERROR, "wear_depth"),
    (ALL, "get Real as Boolean", |x| status(x.get_boolean("wear_depth")), ERROR, "not Boolean"),
    (ALL, "get unknown", |x| status(x.get_reals(&[0, COUNT as u32])), ERROR, "unknown"),
    // Arrays. SAFETY of all: a NULL or refused array is not looked at, that is what is tested.
    (INS, "set nothing, NULL", |x| unsafe { fmi2SetReal(x.component, ptr::null(), 0, ptr::null()) }, OK, ""),
    (ALL, "get nothing, NULL", |x| unsafe { fmi2GetReal(x.component, ptr::null(), 0, ptr::null_mut()) }, OK, ""),
    (INS, "NULL references", |x| unsafe { fmi2SetReal(x.component, ptr::null(), 1, &1.0) }, ERROR, "vr is NULL"),
    (INS, "NULL values", |x| unsafe { fmi2SetReal(x.component, &0, 1, ptr::null()) }, ERROR, "value is NULL"),
    (ALL, "NULL results", |x| unsafe { fmi2GetReal(x.component, &0, 1, ptr::null_mut()) }, ERROR, "value is NULL"),
    (ALL, "most values", |x| unsafe { fmi2GetReal(x.component, &0, usize::MAX, nowhere()) }, ERROR, "vr has"),
    (ALL, "wrapping length", |x| unsafe { fmi2GetReal(x.component, &0, 1 << 61, nowhere()) }, ERROR, "vr has"),
    (ALL, "no strings", |x| unsafe { fmi2GetString(x.component, ptr::null(), 0, ptr::null_mut()) }, OK, ""),
    (INS, "set no strings", |x| unsafe { fmi2SetString(x.component, ptr::null(), 0, ptr::null()) }, OK, ""),
    (ALL, "a string", |x| unsafe { fmi2GetString(x.component, &0, 1, &mut c"".as_ptr()) }, ERROR, "not String"),
    (INS, "set a string", |x| unsafe { fmi2SetString(x.component, &0, 1, &c"".as_ptr()) }, ERROR, "not String"),
    // Steps.
    (S, "a step", |x| x.step(0.0, 0.1), OK, ""),
    (S, "a step of 0", |x| x.step(0.0, 0.0), OK, ""),
    (S, "a step of -0", |x| x.step(0.0, -0.0), OK, ""),
    (S, "a step up to the stop time", |x| x.step(0.0, 100.0), OK, ""),
    (S, "a step past the stop time by rounding", |x| x.step(0.0, 100.0 + 0.9e-7), OK, ""),
    (S, "a step past the stop time", |x| x.step(0.0, 100.0 + 1.1e-7), ERROR, "past the stop time 100 s"),
    (S, "a step back", |x| x.step(0.0, -0.1), ERROR, "step -0.1 s"),
    (S, "a step of NaN", |x| x.step(0.0, f64::NAN), ERROR, "step NaN"),
    (S, "an infinite step", |x| x.step(0.0, f64::INFINITY), ERROR, "step inf"),
    (S, "communication point off by rounding", |x| x.step(0.9e-9, 0.1), OK, ""),
    (S, "communication point ahead", |x| x.step(1.1e-9, 0.1), ERROR, "end of the last step, 0 s"),
    (S, "communication point behind", |x| x.step(-0.5, 0.1), ERROR, "communication point -0.5"),
    (S, "communication point NaN", |x| x.step(f64::NAN, 0.1), ERROR, "communication point NaN"),
    // Derivatives.
    (INS, "input derivative", |x| x.set_derivative("sliding_velocity", 1, 2.0), OK, ""),
    (INS, "input derivative NaN is stored", |x| x.set_derivative("normal_load", 1, f64::NAN), OK, ""),
    (INS, "input derivative of order 0", |x| x.set_derivative("sliding_velocity", 0, 2.0), ERROR, "not 0"),
    (INS, "input derivative of order 2", |x| x.set_derivative("sliding_velocity", 2, 2.0), ERROR, "not 2"),
    (INS, "derivative of a parameter", |x| x.set_derivative("punch.height", 1, 2.0), ERROR, "not an input"),
    (INS, "derivative of an output", |x| x.set_derivative("wear_depth", 1, 2.0), ERROR, "not an input"),
    (INS, "derivative of an integer", |x| x.set_derivative("contact.faces", 1, 2.0), ERROR, "contact.faces"),
    (&[Stepping, Terminated], "output derivative", |x| x.output_derivative("wear_depth", 1), OK, ""),
    // An input is no number there.
    (&[Failed], "output derivative", |x| x.output_derivative("wear_depth", 1), ERROR, "sliding_velocity"),
    (STE, "output derivative of order 2", |x| x.output_derivative("wear_depth", 2), ERROR, "not 2"),
    (STE, "output derivative of an input", |x| x.output_derivative("normal_load", 1), ERROR, "not an output"),
    (STE, "output derivative of an integer", |x| x.output_derivative("limit_reached", 1), ERROR, "limit"),
    (
        STE,
        "no output derivatives",
        |x| unsafe { fmi2GetRealOutputDerivatives(x.component, ptr::null(), 0, ptr::null(), ptr::null_mut()) },
        OK,
        "",
    ),
    (S, "by an input", |x| status(x.directional_derivative("friction_force", "normal_load", 1.0)), OK, ""),
    (S, "by a parameter", |x| status(x.directional_derivative("friction_force", "depth", 1.0)), ERROR, "depth"),
    (S, "of a local", |x| status(x.directional_derivative("profile.x[1]", "normal_load", 1.0)), ERROR, "profile.x[1]"),
    (S, "of an integer", |x| status(x.directional_derivative("limit_reached", "normal_load", 1.0)), ERROR, "limit"),
    (S, "seed NaN", |x| status(x.directional_derivative("wear_depth", "normal_load", f64::NAN)), ERROR, "seed NaN"),
    (
        S,
        "of nothing by nothing",
        |x| unsafe {
            fmi2GetDirectionalDerivative(x.component, ptr::null(), 0, ptr::null(), 0, ptr::null(), ptr::null_mut())
        },
        OK,
        "",
    ),
    // Asynchronous steps and their statuses do not exist; the standard's other two do.
    (STE, "step status", |x| unsafe { fmi2GetStatus(x.component, 0, &mut Status::Ok) }, DISCARD, "fmi2DoStepStatus"),
    (STE, "last time", |x| unsafe { fmi2GetRealStatus(x.component, 2, &mut 0.0) }, OK, ""),
    (STE, "real, other kind", |x| unsafe { fmi2GetRealStatus(x.component, 3, &mut 0.0) }, DISCARD, "fmi2Terminated"),
    (STE, "real, unknown kind", |x| unsafe { fmi2GetRealStatus(x.component, 77, &mut 0.0) }, DISCARD, "77"),
    (STE, "real, no place", |x| unsafe { fmi2GetRealStatus(x.component, 2, ptr::null_mut()) }, ERROR, "value is NULL"),
    (STE, "integer status", |x| unsafe { fmi2GetIntegerStatus(x.component, 2, &mut 0) }, DISCARD, "not available"),
    (STE, "terminated", |x| unsafe { fmi2GetBooleanStatus(x.component, 3, &mut 0) }, OK, ""),
    (STE, "boolean, other kind", |x| unsafe { fmi2GetBooleanStatus(x.component, 0, &mut 0) }, DISCARD, "not available"),
    (
        STE,
        "pending",
        |x| unsafe { fmi2GetStringStatus(x.component, 1, &mut ptr::null()) },
        DISCARD,
        "fmi2PendingStatus",
    ),
    // FMU states.
    (ALL, "no place for a state", |x| unsafe { fmi2GetFMUstate(x.component, ptr::null_mut()) }, ERROR, "NULL"),
    (ALL, "a state that never was, to write over", |x| x.save(&mut nowhere()), ERROR, "never came from this FMU"),
    (ALL, "set no state", |x| x.restore(ptr::null_mut()), ERROR, "NULL"),
    (ALL, "set a state that never was", |x| x.restore(nowhere()), ERROR, "never came from this FMU"),
    (ALL, "an instance as a state", |x| x.restore(x.component), ERROR, "never came from this FMU"),
    (ALL, "free no state", |x| x.free(&mut ptr::null_mut()), OK, ""),
    (ALL, "free at no place", |x| unsafe { fmi2FreeFMUstate(x.component, ptr::null_mut()) }, OK, ""),
    (ALL, "free a state that never was", |x| x.free(&mut nowhere()), ERROR, "never came from this FMU"),
    (ALL, "serialise no state", |x| status(x.serialize(ptr::null_mut())), ERROR, "NULL"),
    (ALL, "deserialise nothing", |x| status(x.deserialize(&[])), ERROR, "0 were given"),
    (ALL, "deserialise noise", |x| status(x.deserialize(&[0x5a; 400])), ERROR, "no serialised FMU state"),
    (
        ALL,
        "deserialise from NULL",
        |x| unsafe { fmi2DeSerializeFMUstate(x.component, ptr::null(), 100, &mut ptr::null_mut()) },
        ERROR,
        "serializedState is NULL",
    ),
    // Logging.
    (ALL, "all categories", |x| x.debug(true, &[]), OK, ""),
    (ALL, "off", |x| x.debug(false, &[c"logEvents"]), OK, ""),
    (ALL, "unknown category", |x| x.debug(true, &[c"logAll", c"", c"logEvents"]), OK, ""),
    (ALL, "NULL categories", |x| unsafe { fmi2SetDebugLogging(x.component, 1, 2, ptr::null()) }, ERROR, "NULL"),
    (ALL, "a NULL category", |x| unsafe { fmi2SetDebugLogging(x.component, 1, 1, &ptr::null()) }, ERROR, "NULL"),
];

#[test]
fn each_call_gets_its_status_and_a_refused_one_changes_nothing() {
    let mut failures = Vec::new();
    for &(stages, what, call, expected, says) in CASES {
        for &stage in stages {
            let importer = Importer::at(stage);
            let before = importer.bytes();
            let status = call(&importer);
            let log = importer.take_log();
            let mut claim = |fine: bool, complaint: &str| {
                if !fine {
                    failures.push(format!("{stage:?}: {what}: {complaint}; {status:?}, {log:?}"));
                }
            };
            claim(status == expected, &format!("should be {expected:?}"));
            if expected == OK {
                claim(!log.iter().any(|entry| entry.0 == ERROR), "a good call logs no error");
            } else {
                claim(importer.bytes() == before, "a refused call must change nothing");
                let explained = log.iter().any(|(status, category, text)| {
                    *status == expected && category == "logStatusError" && text.contains(says)
                });
                claim(explained, &format!("the log should say {says:?}"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    let calls: usize = CASES.iter().map(|case| case.0.len()).sum();
    assert!(CASES.len() >= 60 && calls > CASES.len(), "{calls}");
}

#[test]
fn an_output_without_a_value_is_an_error_that_names_the_input() {
    let importer = Importer::at(Stepping);
    assert_eq!(importer.set_real(&["normal_load"], &[f64::NAN]), OK);
    importer.take_log();
    assert_eq!(status(importer.get_reals(&[reference("friction_force")])), ERROR);
    let log = importer.take_log();
    let told = |text: &str| text.contains("friction_force = NaN") && text.contains("normal_load = NaN");
    assert!(log.iter().any(|(_, _, text)| told(text)), "{log:?}");
    assert_eq!(status(importer.directional_derivative("friction_force", "sliding_velocity", 1.0)), ERROR);
    // Nothing but the value is refused: the instance goes on.
    assert_eq!(importer.set_real(&["normal_load"], &[100.0]), OK);
    assert!(importer.get_real("friction_force").is_finite());
}

#[test]
fn values_come_back_as_they_were_set_without_a_step() {
    for stage in [Instantiated, Initialization, Stepping] {
        let importer = Importer::at(stage);
        assert_eq!(importer.set_real(&["sliding_velocity", "contact.friction_coefficient"], &[-2.5, 0.125]), OK);
        assert_eq!(importer.get_real("sliding_velocity"), -2.5);
        assert_eq!(importer.get_real("contact.friction_coefficient"), 0.125);
        assert_eq!(importer.set_real(&["normal_load"], &[f64::NAN]), OK);
        assert!(importer.get_real("normal_load").is_nan());
    }
    let importer = Importer::new();
    assert_eq!(importer.set_integer("solver.fidelity", 2), OK);
    assert_eq!(importer.get_integer("solver.fidelity"), Ok(2));
    assert_eq!(importer.set_boolean("contact.shear_coupling", 0), OK);
    assert_eq!(importer.get_boolean("contact.shear_coupling"), Ok(0));
}

#[test]
fn an_initialisation_that_fails_says_why_and_can_be_reset() {
    let importer = Importer::at(Initialization);
    assert_eq!(importer.set_real(&["punch.conductivity", "strip.conductivity"], &[0.0, 0.0]), OK);
    assert_eq!(importer.exit(), ERROR);
    let log = importer.take_log();
    assert!(log.iter().any(|entry| entry.0 == ERROR && entry.2.contains("conductivity")), "{log:?}");
    assert_eq!(importer.exit(), ERROR, "the error phase knows no initialisation");
    assert_eq!(importer.reset(), OK);
    importer.go(Stepping);
}

#[test]
fn rounding_of_the_importers_clock_does_not_pile_up() {
    let importer = Importer::at(Stepping);
    // Points in double precision, steps in single: 5e-11 s too long each, 1.4e-7 s all together.
    let step = f64::from(1e-3_f32);
    for count in 0..3000 {
        let point = f64::from(count) * 1e-3;
        assert_eq!(importer.step(point, step), OK, "{count}: {:?}", importer.take_log());
    }
    let mut last = 0.0;
    // SAFETY: the place is there.
    assert_eq!(unsafe { fmi2GetRealStatus(importer.component, 2, &mut last) }, OK);
    assert!((last - 3.0).abs() < 1e-10, "{last}");
}

/// Wear that no step can be taken with is refused before the first one, whatever the level and the nominal duration; what is
/// initialised also steps.
#[test]
fn an_accelerated_scene_that_auto_takes_can_be_stepped() {
    for duration in [10.0, 1e4] {
        for acceleration in [1.0, 1e3] {
            let importer = Importer::new();
            assert_eq!(importer.set_integer("solver.fidelity", 1), Status::Ok);
            let values = [duration, acceleration];
            assert_eq!(importer.set_real(&["nominal.duration", "wear_acceleration"], &values), Status::Ok);
            assert_eq!(importer.setup(Some(1e-2), 0.0, None), Status::Ok);
            assert_eq!(importer.enter(), Status::Ok);
            let status = importer.exit();
            let log = importer.take_log();
            let text = log.last().map(|entry| entry.2.clone()).unwrap_or_default();
            if status != Status::Ok {
                assert!(acceleration > 1.0 && text.contains("the limit is 0.5"), "{values:?}: {text}");
                continue;
            }
            assert_eq!(importer.set_real(&["sliding_velocity", "normal_load"], &[1.0, 1e3]), Status::Ok);
            for step in 0..3 {
                assert_eq!(
                    importer.step(0.1 * f64::from(step), 0.1),
                    Status::Ok,
                    "{values:?}: {:?}",
                    importer.take_log()
                );
            }
        }
    }
}

/// What would make every later step fail is refused where it is set.
#[test]
fn wear_accelerated_against_growth_is_refused_at_initialisation_and_while_stepping() {
    let line = || {
        let importer = Importer::new();
        assert_eq!(importer.set_integer("solver.fidelity", 3), Status::Ok);
        assert_eq!(importer.set_integer("solver.cells", 9), Status::Ok);
        importer
    };
    let names_limit = |importer: &Importer| {
        let log = importer.take_log();
        let text = &log.last().unwrap().2;
        assert!(text.contains("wear_acceleration = 1000 ") && text.contains("the limit is 0.5"), "{text}");
    };
    let importer = line();
    assert_eq!(importer.set_real(&["wear_acceleration"], &[1e3]), Status::Ok);
    assert_eq!(importer.setup(None, 0.0, None), Status::Ok);
    assert_eq!(importer.enter(), Status::Ok);
    assert_eq!(importer.exit(), Status::Error);
    names_limit(&importer);
    let importer = line();
    assert_eq!(importer.setup(None, 0.0, None), Status::Ok);
    assert_eq!(importer.enter(), Status::Ok);
    assert_eq!(importer.exit(), Status::Ok);
    importer.take_log();
    let names = ["sliding_velocity", "normal_load"];
    assert_eq!(importer.set_real(&names, &[1.0, 1e3]), Status::Ok);
    assert_eq!(importer.set_real(&["wear_acceleration"], &[1e3]), Status::Discard);
    names_limit(&importer);
    assert_eq!(importer.get_real("wear_acceleration"), 1.0);
    assert_eq!(importer.step(0.0, 0.1), Status::Ok);
    assert_eq!(importer.set_real(&["wear_acceleration"], &[10.0]), Status::Ok);
    assert_eq!(importer.step(0.1, 0.1), Status::Ok);
}
