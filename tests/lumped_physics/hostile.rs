//! Extreme values: every step gives finite outputs or an error that names the cause, and a failed step leaves
//! the state unchanged.

use scene::variables::{COUNT, Causality, STARTS, lookup};
use sliding_contact::component::{Component, Snapshot};
use std::panic::{AssertUnwindSafe, catch_unwind};
use test_support::{Drive, EXTERNAL, reference, scene};

/// Required outcome of a case.
#[derive(Clone, Copy)]
enum Expected {
    /// Every step succeeds with finite outputs.
    Finite,
    /// Initialisation or a step fails with a text that contains this.
    Refused(&'static str),
    /// Either finite outputs, or an error.
    FiniteOrRefused,
}
use Expected::{Finite, FiniteOrRefused, Refused};

struct Case {
    name: &'static str,
    /// Name of an example; the stock scene if there is none.
    example: &'static str,
    /// Parameters, and inputs at initialisation.
    scene: &'static [(&'static str, f64)],
    inputs: &'static [(&'static str, f64)],
    slopes: &'static [(&'static str, f64)],
    step: f64,
    steps: usize,
    expected: Expected,
}

const fn case(name: &'static str, scene: &'static [(&'static str, f64)], expected: Expected) -> Case {
    Case { name, example: "", scene, inputs: SLIDING, slopes: &[], step: 0.01, steps: 3, expected }
}

const SLIDING: &[(&str, f64)] = &[("sliding_velocity", 10.0), ("normal_load", 5e3)];

/// Names of the outputs that are not finite, and of temperatures below 0 K.
fn invalid_outputs(component: &mut Component) -> Vec<String> {
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

/// Everything that the continuation depends on, as bytes, and every variable.
fn bits(component: &mut Component) -> (Vec<u8>, Vec<u64>) {
    let (mut snapshot, mut bytes) = (Snapshot::default(), Vec::new());
    component.snapshot(&mut snapshot);
    snapshot.encode(&mut bytes);
    (bytes, (0..COUNT as u32).map(|reference| component.get(reference).to_bits()).collect())
}

/// Runs a case; the error describes the deviation from its required outcome.
fn run(case: &Case) -> Result<(), String> {
    let ended = |text: String| match case.expected {
        Refused(part) if text.contains(part) => Ok(()),
        FiniteOrRefused => Ok(()),
        Refused(part) => Err(format!("refused without \"{part}\": {text}")),
        Finite => Err(format!("refused: {text}")),
    };
    let starts = if case.example.is_empty() { STARTS } else { scene(case.example) };
    let mut drive = match Drive::attempt(&starts, case.scene) {
        Ok(drive) => drive,
        Err(text) => return ended(text),
    };
    let found = invalid_outputs(&mut drive.0);
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
        let found = invalid_outputs(&mut drive.0);
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
            // Friction falls with the heat of the bristle's own release, which ends in no time: that heat is spread over the step.
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
    Case {
        inputs: &[("sliding_velocity", 10.0), ("normal_load", 5e3), ("ambient_temperature_offset", 1e5)],
        ..case("a cold radiating punch in surroundings of 1e5 K", &[("punch.emissivity", 0.6)], FiniteOrRefused)
    },
    case(
        "a thin punch with a cooled area of 1000 m2",
        &[("punch.width", 0.00187), ("punch.top_thermal", 1.0), ("punch.cooled_area", 1000.0)],
        FiniteOrRefused,
    ),
    Case {
        inputs: &[("sliding_velocity", 1e61), ("normal_load", 5e3)],
        ..case("a velocity beyond the limit", &[], Refused("sliding_velocity = 1"))
    },
    Case {
        inputs: &[("sliding_velocity", 10.0), ("normal_load", 2e12)],
        ..case("a load beyond the limit", &[], Refused("beyond 1e12 N"))
    },
    Case {
        slopes: &[("normal_load", 1e15)],
        ..case("a load that passes the limit in the step", &[], Refused("at the end of the step is beyond 1e12 N"))
    },
    Case {
        inputs: &[("sliding_velocity", 10.0), ("normal_load", f64::NAN)],
        ..case("a load that is no number", &[], Refused("normal_load = NaN is not a finite number"))
    },
    Case {
        slopes: &[("sliding_velocity", f64::INFINITY)],
        ..case("an infinite derivative", &[], Refused("the derivative of sliding_velocity = inf"))
    },
    Case {
        inputs: &[("sliding_velocity", 1e12), ("normal_load", 1e12)],
        ..case(
            "velocity and load at the limit",
            &[("punch.emissivity", 0.6), ("strip.emissivity", 0.6)],
            FiniteOrRefused,
        )
    },
    Case {
        inputs: &[("sliding_velocity", 10.0), ("normal_load", 5e3), ("ambient_temperature_offset", -300.0)],
        ..case("ambient below 0 K", &[], Refused("ambient_temperature_offset = -300 K"))
    },
    Case {
        slopes: &[("ambient_temperature_offset", -1e5)],
        ..case("ambient that falls below 0 K in the step", &[], Refused("must be above 0 K"))
    },
    case(
        "ambient below 0 K at initialisation",
        &[("ambient_temperature_offset", -300.0)],
        Refused("must be above 0 K"),
    ),
    case("an external temperature that is not given", &[("punch.top_thermal", EXTERNAL)], Refused("must be above 0 K")),
    Case {
        slopes: &[("punch.external_temperature", -1e5)],
        ..case(
            "an external temperature that falls below 0 K in the step",
            &[("punch.top_thermal", EXTERNAL), ("punch.external_temperature", 300.0)],
            Refused("punch.external_temperature = -700 K must be above 0 K"),
        )
    },
    Case { step: 1e-310, ..case("a step of 1e-310 s", &[], Refused("shorter than 1e-24 s")) },
    Case { step: 1e-24, ..case("the shortest step", &[], Finite) },
    Case { step: 1e-17, ..case("a step of rounding", &[], Finite) },
    Case { step: 1e-12, ..case("a tiny step", &[], Finite) },
    Case { step: 1e-12, slopes: &[("sliding_velocity", 1e9)], ..case("a tiny step with a slope", &[], Finite) },
    Case { step: 1e-24, ..case("the shortest step on cells", ON_CELLS, Finite) },
    Case { step: 1e-12, ..case("a tiny step on cells", ON_CELLS, Finite) },
    Case {
        inputs: &[("sliding_velocity", 1e12), ("normal_load", 1e12)],
        ..case("velocity and load at the limit on cells", ON_CELLS, FiniteOrRefused)
    },
    Case { step: 1e300, ..case("a step of 1e300 s", &[], Refused("longer than 1e9 s")) },
    Case { step: 1.1e9, ..case("a step that is too long", &[], Refused("the step of 1.1e9 s is longer than 1e9 s")) },
    Case { step: 1e9, inputs: RESTING, ..case("the longest step", &[], Finite) },
    Case { step: 1e9, inputs: RESTING, ..case("the longest step on cells", ON_CELLS, Finite) },
    case(
        "an air speed of 1e12 m/s at initialisation",
        &[("cooling_velocity", 1e12), ("ambient_temperature_offset", 12.0)],
        Finite,
    ),
    Case {
        example: "disc_brake",
        ..case(
            "a velocity of 1e12 m/s at initialisation",
            &[("sliding_velocity", 1e12), ("ambient_temperature_offset", -0.2)],
            Finite,
        )
    },
    Case {
        inputs: &[("sliding_velocity", 1e4), ("normal_load", 250.0), ("cooling_velocity", 1e12)],
        step: 1e-9,
        ..case(
            "an air speed of 1e12 m/s at a radiating base",
            &[("strip.base_thermal", 2.0), ("strip.emissivity", 0.55), ("strip.convection_forced", 8.0)],
            FiniteOrRefused,
        )
    },
    Case {
        example: "disc_brake",
        ..case(
            "a run-in periodic contact, whose open cells have no heat to share",
            &[
                ("solver.fidelity", 3.0),
                ("solver.cells", 17.0),
                ("contact.geometry", 3.0),
                ("strip.length", 0.095),
                ("contact.mean_radius", 0.01512),
                ("contact.initial_shape", 3.0),
            ],
            Refused("no steady state"),
        )
    },
];

const RESTING: &[(&str, f64)] = &[("sliding_velocity", 0.0), ("normal_load", 5e3)];

const ON_CELLS: &[(&str, f64)] = &[("solver.fidelity", 3.0), ("solver.cells", 9.0), ("solver.tolerance", 0.01)];

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

/// Wear follows the friction coefficient, which is tunable: more friction than at initialisation wears a body through within a
/// step that would otherwise have been far from it.
#[test]
fn a_step_that_wears_the_punch_through_by_tuned_friction_changes_nothing() {
    let mut refused = 0;
    for exponent in 0..60 {
        let wear = 1e-11 * 10f64.powf(0.1 * f64::from(exponent));
        let changes = [("punch.wear_coefficient", wear), ("contact.friction_coefficient", 0.1), ("punch.height", 1e-6)];
        let mut drive = Drive::stock(&changes);
        drive.0.set_parameter(reference("contact.friction_coefficient"), 0.9);
        drive.set("sliding_velocity", 10.0).set("normal_load", 5e3).slope("sliding_velocity", 1e-3);
        let before = bits(&mut drive.0);
        if let Err(text) = drive.0.step(1e-6) {
            assert!(text.contains("worn through"), "{wear:e}: {text}");
            assert!(bits(&mut drive.0) == before, "{wear:e}: {text}");
            refused += 1;
        }
    }
    assert!((10..50).contains(&refused), "{refused}");
}
