//! FMU states: replay, reuse, life time, bytes.

use std::ptr;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{FmuState, Status};

use test_support::importer::{Importer, Stage};
use test_support::real_outputs;

const OK: Status = Status::Ok;
const ERROR: Status = Status::Error;

/// Steps 20 to 40 of a run with a reversal, with derivatives; every output of every step, bit by bit.
fn stretch(importer: &Importer, from: i32, to: i32) -> Vec<u64> {
    let references = real_outputs();
    let mut bits = Vec::new();
    for step in from..to {
        let time = f64::from(step) * 0.01;
        assert_eq!(importer.set_real(&["sliding_velocity", "normal_load"], &[(12.0 * time).cos(), 300.0]), OK);
        assert_eq!(importer.set_derivative("sliding_velocity", 1, -12.0 * (12.0 * time).sin()), OK);
        assert_eq!(importer.step(time, 0.01), OK, "{:?}", importer.take_log());
        bits.extend(importer.get_reals(&references).unwrap().iter().map(|value| value.to_bits()));
    }
    bits
}

fn saved(importer: &Importer) -> FmuState {
    let mut state = ptr::null_mut();
    assert_eq!(importer.save(&mut state), OK);
    assert!(!state.is_null());
    state
}

#[test]
fn a_replay_is_bit_identical() {
    let importer = Importer::at(Stage::Stepping);
    stretch(&importer, 0, 20);
    let mut state = saved(&importer);
    let first = stretch(&importer, 20, 40);
    assert_eq!(importer.restore(state), OK);
    assert_eq!(stretch(&importer, 20, 40), first);
    // From the error phase.
    assert_eq!(importer.set_real(&["normal_load"], &[f64::NAN]), OK);
    assert_eq!(importer.step(0.4, 0.01), ERROR);
    assert_eq!(importer.restore(state), OK);
    assert_eq!(stretch(&importer, 20, 40), first);
    // From the terminated phase, through bytes, and into another instance that has not even begun.
    let bytes = importer.serialize(state).unwrap();
    assert_eq!(importer.terminate(), OK);
    let mut read = importer.deserialize(&bytes).unwrap();
    assert_eq!(importer.restore(read), OK);
    assert_eq!(stretch(&importer, 20, 40), first);
    let other = Importer::new();
    assert_eq!(other.restore(read), OK);
    assert_eq!(stretch(&other, 20, 40), first);
    // A reset instance repeats the whole.
    assert_eq!(importer.reset(), OK);
    importer.go(Stage::Stepping);
    stretch(&importer, 0, 20);
    assert_eq!(stretch(&importer, 20, 40), first);
    assert_eq!((importer.free(&mut state), importer.free(&mut read)), (OK, OK));
}

#[test]
fn a_state_holds_inputs_derivatives_parameters_phase_and_times() {
    let importer = Importer::at(Stage::Instantiated);
    assert_eq!(importer.setup(Some(1e-4), 5.0, Some(6.0)), OK);
    assert_eq!(importer.set_real(&["punch.height", "normal_load"], &[0.0123, 4.5]), OK);
    assert_eq!(importer.set_derivative("normal_load", 1, 7.0), OK);
    let mut state = saved(&importer);
    let before = importer.bytes();
    assert_eq!(importer.reset(), OK);
    assert_ne!(importer.bytes(), before);
    assert_eq!(importer.restore(state), OK);
    assert_eq!(importer.bytes(), before);
    assert_eq!((importer.get_real("punch.height"), importer.get_real("normal_load")), (0.0123, 4.5));
    assert_eq!((importer.enter(), importer.exit()), (OK, OK));
    assert_eq!(importer.step(0.0, 0.1), ERROR, "the start time came back");
    assert_eq!(importer.step(5.0, 1.1), ERROR, "and the stop time");
    assert_eq!(importer.step(5.0, 1.0), OK);
    assert_eq!(importer.free(&mut state), OK);
}

/// A state from before the first evaluation says what a new instance says, not what an error after it left.
#[test]
fn a_restored_state_shows_its_own_outputs() {
    let outputs = real_outputs();
    let importer = Importer::at(Stage::Instantiated);
    let first: Vec<u64> = importer.get_reals(&outputs).unwrap().iter().map(|value| value.to_bits()).collect();
    let state = saved(&importer);
    assert_eq!((importer.setup(None, 0.0, None), importer.enter()), (OK, OK));
    assert_eq!(importer.set_real(&["sliding_velocity"], &[f64::INFINITY]), OK);
    assert_eq!(importer.get_reals(&outputs), Err(ERROR), "no value at an infinite velocity");
    assert_eq!(importer.restore(state), OK);
    let again: Vec<u64> = importer.get_reals(&outputs).unwrap().iter().map(|value| value.to_bits()).collect();
    assert_eq!(again, first);
}

#[test]
fn a_state_is_written_over_and_dies_once() {
    let importer = Importer::at(Stage::Stepping);
    let mut state = saved(&importer);
    let (same, early) = (state, importer.bytes());
    stretch(&importer, 0, 3);
    assert_eq!(importer.save(&mut state), OK);
    assert_eq!(state, same, "a state that is there is written over");
    let late = importer.bytes();
    assert_ne!(late, early);
    assert_eq!(importer.serialize(state).unwrap(), late, "as a whole");
    let mut copy = state;
    assert_eq!(importer.free(&mut state), OK);
    assert!(state.is_null());
    assert_eq!(importer.free(&mut state), OK, "NULL is ignored");
    assert_eq!(importer.free(&mut copy), ERROR, "freed before");
    assert_eq!(importer.restore(copy), ERROR);
    assert_eq!(importer.save(&mut copy), ERROR);
    assert_eq!(importer.serialize(copy), Err(ERROR));
}

#[test]
fn a_state_outlives_its_instance() {
    let importer = Importer::at(Stage::Stepping);
    stretch(&importer, 0, 3);
    let mut state = saved(&importer);
    let next = stretch(&importer, 3, 6);
    drop(importer);
    let other = Importer::new();
    assert_eq!(other.restore(state), OK);
    assert_eq!(stretch(&other, 3, 6), next);
    assert_eq!(other.free(&mut state), OK);
}

#[test]
fn damaged_bytes_are_refused_and_change_nothing() {
    let importer = Importer::at(Stage::Stepping);
    stretch(&importer, 0, 3);
    let before = importer.bytes();
    for at in 0..before.len() {
        for flip in [0x01, 0x10, 0xff] {
            let mut damaged = before.clone();
            damaged[at] ^= flip;
            assert_eq!(importer.deserialize(&damaged), Err(ERROR), "byte {at}");
        }
    }
    for length in (0..before.len()).step_by(7).chain([before.len() - 1]) {
        assert_eq!(importer.deserialize(&before[..length]), Err(ERROR), "length {length}");
    }
    let mut longer = before.clone();
    longer.push(0);
    assert_eq!(importer.deserialize(&longer), Err(ERROR));
    let log = importer.take_log();
    assert!(log.iter().any(|entry| entry.2.contains("checksum")), "{log:?}");
    assert_eq!(importer.bytes(), before);
    // A length that is not there is found in the header, not behind the end of the bytes.
    // SAFETY: as many bytes as the header announces are there.
    let status = unsafe {
        fmi2DeSerializeFMUstate(importer.component, before.as_ptr().cast(), isize::MAX as usize, &mut ptr::null_mut())
    };
    assert_eq!(status, ERROR);
}

#[test]
fn bytes_fit_exactly_and_are_few() {
    let importer = Importer::at(Stage::Stepping);
    stretch(&importer, 0, 3);
    let mut state = saved(&importer);
    let bytes = importer.serialize(state).unwrap();
    for size in [bytes.len() - 1, bytes.len() + 1, 0] {
        let mut target = vec![0x5a; bytes.len() + 1];
        // SAFETY: so many bytes are there.
        let status = unsafe { fmi2SerializeFMUstate(importer.component, state, target.as_mut_ptr().cast(), size) };
        assert_eq!(status, ERROR, "{size}");
        assert!(target.iter().all(|&byte| byte == 0x5a), "nothing is written");
    }
    assert!(bytes.len() <= 2048, "a lumped state has {} bytes", bytes.len());
    assert_eq!(importer.free(&mut state), OK);
}
