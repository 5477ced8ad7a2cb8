//! Hostile numbers: every step ends in finite outputs or in an error that names what is wrong, and a failed step leaves
//! everything as it was.

use super::drive::{Drive, EXTERNAL, reference, scene};
use sliding_contact::component::{Component, Snapshot};
use sliding_contact::variables::{COUNT, Causality, STARTS, lookup};
use std::panic::{AssertUnwindSafe, catch_unwind};

const CONVECTING: f64 = super::drive::CONVECTING;

/// What a case must come to.
#[derive(Clone, Copy)]
enum Expected {
    /// Every step succeeds with finite outputs.
    Finite,
    /// Initialisation or a step fails with a text that contains this.
    Refused(&'static str),
    /// Either: nothing but numbers, or an error.
    FiniteOrRefused,
}
use Expected::{Finite, FiniteOrRefused, Refused};

struct Case {
    name: &'static str,
    /// Parameters, and inputs at initialisation.
    scene: &'static [(&'static str, f64)],
    inputs: &'static [(&'static str, f64)],
    slopes: &'static [(&'static str, f64)],
    step: f64,
    steps: usize,
    expected: Expected,
}

const fn case(name: &'static str, scene: &'static [(&'static str, f64)], expected: Expected) -> Case {
    Case { name, scene, inputs: SLIDING, slopes: &[], step: 0.01, steps: 3, expected }
}

const SLIDING: &[(&str, f64)] = &[("sliding_velocity", 10.0), ("normal_load", 5e3)];

/// Names the outputs that are no finite number, or temperatures below 0 K.
fn nonsense(component: &mut Component) -> Vec<String> {
    let mut found = Vec::new();
    for reference in 0..COUNT as u32 {
        let (row, element) = lookup(reference).unwrap();
        if !matches!(row.causality, Causality::Output | Causality::Local) {
            continue;
        }
        let value = component.get(reference);
        let is_temperature = row.name.contains("temperature");
        if !value.is_finite() || is_temperature && value < 0.0 {
            found.push(format!("{} = {value}", row.element_name(element)));
        }
    }
    found
}

fn bits(component: &mut Component) -> Vec<u64> {
    (0..COUNT as u32).map(|reference| component.get(reference).to_bits()).collect()
}

/// What went wrong in a case, if anything did.
fn run(case: &Case) -> Result<(), String> {
    let ended = |text: String| match case.expected {
        Refused(part) if text.contains(part) => Ok(()),
        FiniteOrRefused => Ok(()),
        Refused(part) => Err(format!("refused without \"{part}\": {text}")),
        Finite => Err(format!("refused: {text}")),
    };
    let mut drive = match Drive::attempt(&STARTS, case.scene) {
        Ok(drive) => drive,
        Err(text) => return ended(text),
    };
    let found = nonsense(&mut drive.0);
    if !found.is_empty() {
        return Err(format!("after initialisation {found:?}"));
    }
    for number in 1..=case.steps {
        case.inputs.iter().for_each(|(name, value)| _ = drive.set(name, *value));
        case.slopes.iter().for_each(|(name, value)| _ = drive.slope(name, *value));
        let before = bits(&mut drive.0);
        if let Err(text) = drive.0.step(case.step) {
            if bits(&mut drive.0) != before {
                return Err(format!("step {number} failed and moved something: {text}"));
            }
            // Another one must not bring down the host either.
            let _ = drive.0.step(case.step);
            let _ = bits(&mut drive.0);
            return ended(text);
        }
        let found = nonsense(&mut drive.0);
        if !found.is_empty() {
            return Err(format!("after step {number} {found:?}"));
        }
    }
    match case.expected {
        Refused(part) => Err(format!("not refused with \"{part}\"")),
        Finite | FiniteOrRefused => Ok(()),
    }
}

const CASES: &[Case] = &[
    Case {
        steps: 20,
        ..case(
            "a radiating punch on an insulating strip, with a bristle and fading friction",
            &[
                ("punch.top_thermal", EXTERNAL),
                ("punch.emissivity", 0.27877),
                ("contact.friction_fade.factor[1]", 1.0867),
                ("strip.conductivity", 0.0),
                ("punch.external_temperature", 467.89),
                ("contact.stick_stiffness", 3631.2),
                ("solver.tolerance", 0.0284834),
            ],
            Finite,
        )
    },
    case(
        "a radiating punch in surroundings of 1e5 K",
        &[("punch.emissivity", 0.6), ("ambient_temperature_offset", 1e5)],
        FiniteOrRefused,
    ),
    Case {
        inputs: &[("sliding_velocity", 100.0), ("normal_load", 10.0)],
        step: 60.6,
        ..case(
            "a stiff caliper in a long step",
            &[("punch.youngs_modulus", 2.08e11), ("holder.stiffness", 1e10)],
            FiniteOrRefused,
        )
    },
    Case {
        inputs: &[("sliding_velocity", 0.1), ("normal_load", 10.0)],
        step: 16.0636,
        ..case(
            "a small radiating pin behind a caliper in a long step",
            &[
                ("punch.youngs_modulus", 2.08e11),
                ("punch.width", 0.00187),
                ("depth", 0.00187),
                ("contact.mean_radius", 0.00029761974358184426),
                ("punch.emissivity", 0.77551),
                ("holder.stiffness", 1.5279e8),
                ("solver.tolerance", 4.7757e-4),
            ],
            FiniteOrRefused,
        )
    },
    case(
        "a thin punch with a cooled area of 1000 m2",
        &[("punch.width", 0.00187), ("punch.top_thermal", 1.0), ("punch.cooled_area", 1000.0)],
        FiniteOrRefused,
    ),
];

#[test]
fn every_hostile_case_ends_in_numbers_or_in_an_error_that_says_why() {
    let mut failures = Vec::new();
    for case in CASES {
        let outcome = catch_unwind(AssertUnwindSafe(|| run(case))).unwrap_or_else(|_| Err("panicked".into()));
        if let Err(text) = outcome {
            failures.push(format!("{}: {text}", case.name));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
