//! The table of hostile cases.

mod calls;
mod inputs;
mod scenes;

use std::panic::{self, AssertUnwindSafe};
use std::ptr;

use scene::fnv::Fnv;
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::Status::{self, Discard, Error, Ok};

use crate::run::Call::{Initialise, Other, Set, Slope, Step, StepFrom, Steps};
use crate::run::From::{Instantiated, Stepping};
use crate::run::{Call, Case, Level, Runner};
use test_support::importer::{Importer, reference};
use test_support::{CONVECTING, EXTERNAL, HELD, LINE};

const NAN: f64 = f64::NAN;
const INFINITE: f64 = f64::INFINITY;

// Items of enumerations.
const RIGID: f64 = 1.0;
const STRAIGHT: f64 = 1.0;
const ANNULAR: f64 = 2.0;
const PERIODIC: f64 = 3.0;
const PARABOLIC: f64 = 2.0;
const RUN_IN: f64 = 3.0;
const TABULATED: f64 = 4.0;
const ROTATE: f64 = 2.0;

const LUMPED: &[Level] = &[Level::Lumped];
const HOT: &[Level] = &[Level::Hot];
const CELLS: &[Level] = &[Level::Cold, Level::Hot];
const EACH: &[Level] = &[Level::Lumped, Level::Cold, Level::Hot];
const ALL: &[Level] = &[Level::Lumped, Level::Cold, Level::Hot, Level::Auto];

type Says = &'static [&'static str];
type Calls = &'static [Call];

/// While stepping.
const fn stepping(what: &'static str, levels: &'static [Level], calls: Calls, status: Status, says: Says) -> Case {
    Case { what, levels, example: "", scene: &[], from: Stepping, calls, status, says }
}

/// Before initialisation.
const fn before(what: &'static str, levels: &'static [Level], calls: Calls, status: Status, says: Says) -> Case {
    Case { what, levels, example: "", scene: &[], from: Instantiated, calls, status, says }
}

impl Case {
    const fn of(self, scene: &'static [(&'static str, f64)]) -> Case {
        Case { scene, ..self }
    }
    const fn example(self, example: &'static str) -> Case {
        Case { example, ..self }
    }
}

const V: &str = "sliding_velocity";
const F: &str = "normal_load";
const BRISTLE: &[(&str, f64)] = &[("contact.stick_stiffness", 1e7), ("contact.stick_damping", 1e3)];

fn status<T>(result: Result<T, Status>) -> Status {
    result.err().unwrap_or(Ok)
}

/// Deserialises and restores the instance's own state after `damage`.
fn restored(importer: &Importer, damage: fn(&mut Vec<u8>)) -> Status {
    let mut bytes = importer.bytes();
    damage(&mut bytes);
    restored_from(importer, &bytes)
}

fn restored_from(importer: &Importer, bytes: &[u8]) -> Status {
    match importer.deserialize(bytes) {
        Result::Ok(mut state) => {
            let status = importer.restore(state);
            assert_eq!(importer.free(&mut state), Ok);
            status
        }
        Err(status) => status,
    }
}

/// Offset of the phase in the bytes of a state.
fn phase(bytes: &[u8]) -> usize {
    20 + usize::from(u16::from_le_bytes([bytes[6], bytes[7]]))
}

/// Replaces the last number of a state.
fn last_number(bytes: &mut [u8], number: f64) {
    let at = bytes.len() - 8;
    bytes[at..].copy_from_slice(&number.to_le_bytes());
}

/// Makes length and checksum fit.
fn forge(bytes: &mut [u8]) {
    let payload = (bytes.len() - phase(bytes)) as u32;
    bytes[8..12].copy_from_slice(&payload.to_le_bytes());
    let sum = Fnv::of(bytes[..12].iter().chain(&bytes[20..]).copied()).0;
    bytes[12..20].copy_from_slice(&sum.to_le_bytes());
}

/// A state that was freed.
fn freed(importer: &Importer) -> *mut core::ffi::c_void {
    let mut state = ptr::null_mut();
    assert_eq!(importer.save(&mut state), Ok);
    let handle = state;
    assert_eq!(importer.free(&mut state), Ok);
    handle
}

fn serialised_short(importer: &Importer) -> Status {
    let mut state = ptr::null_mut();
    assert_eq!(importer.save(&mut state), Ok);
    let mut bytes = [0_u8; 40];
    // SAFETY: the array is as long as told.
    let status = unsafe { fmi2SerializeFMUstate(importer.component, state, bytes.as_mut_ptr().cast(), bytes.len()) };
    assert_eq!(importer.free(&mut state), Ok);
    status
}

/// Runs a group of the table.
fn check(cases: &[Case]) {
    let (mut runner, mut failures) = (Runner::default(), Vec::new());
    for case in cases {
        for &level in case.levels {
            let run = panic::catch_unwind(AssertUnwindSafe(|| runner.run(case, level)));
            if let Err(text) = run.unwrap_or_else(|_| Err("panicked".into())) {
                failures.push(format!("{}, {level:?}: {text}", case.what));
            }
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

macro_rules! groups {
    ($($test:ident: $cases:path;)*) => {
        const GROUPS: &[&[Case]] = &[$($cases),*];

        $(
            #[test]
            fn $test() {
                check($cases);
            }
        )*
    };
}

groups! {
    inputs_that_are_no_numbers: inputs::NO_NUMBERS;
    inputs_beyond_their_limits: inputs::BEYOND;
    extreme_inputs_that_are_allowed: inputs::EXTREME;
    lengths_of_steps_and_times: inputs::STEPS;
    parameters_one_by_one: scenes::PARAMETERS;
    geometry: scenes::GEOMETRY;
    options_that_contradict_each_other: scenes::OPTIONS;
    limits_of_the_model: calls::LIMITS;
    states: calls::STATES;
    order_of_calls: calls::ORDER;
    arrays_references_and_types: calls::ARRAYS;
}

#[test]
fn the_table_has_rows_enough_and_none_twice() {
    let mut names: Vec<&str> = GROUPS.iter().flat_map(|cases| cases.iter().map(|case| case.what)).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert!(count >= 60 && names.len() == count, "{count} rows, {} names", names.len());
}
