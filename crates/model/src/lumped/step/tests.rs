use super::super::Lumped;
use super::super::operators::LumpedOperators;
use super::*;
use crate::lumped::conditions::Tunables;
use crate::{INPUTS, Inputs};
use scene::Scene;
use scene::variables::{STARTS, changed, find};
use std::sync::Arc;

/// One attempt from the present state over a step in which velocity and load go from the first to the second pair, by the
/// common form and by the general one.
fn attempts(run: &Lumped, ends: [[f64; 2]; 2], step: f64) -> [(Option<Attempt>, LumpedState); 2] {
    let conditions = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|part| {
        let mut inputs = [0.0; INPUTS];
        for k in 0..2 {
            inputs[k] = ends[0][k] + part * (ends[1][k] - ends[0][k]);
        }
        Conditions::new(&run.operators, &run.tunables, run.state.reference, &Inputs::from_array(inputs))
    });
    let constant = ends[0] == ends[1];
    [true, false].map(|common| {
        let mut run = run.clone();
        let propagators = run.propagators.get(&run.operators, step, [550.0; 2]);
        let speeds = conditions.each_ref().map(|now| now.velocity.abs());
        run.flash.prepare(&run.operators, &propagators, speeds);
        let mut stepper = Stepper {
            flash: &mut run.flash,
            cut: 1.0,
            left: 1.0,
            ends: None,
            operators: &run.operators,
            friction: &run.friction,
            tunables: &run.tunables,
            propagators,
            properties: None,
        };
        let at = conditions.each_ref();
        let attempt = match common {
            true => stepper.attempt::<true>(&mut run.state, at, constant),
            false => Some(stepper.attempt_any(&mut run.state, at, constant)),
        };
        (attempt, run.state)
    })
}

/// Largest difference of two states, each number relative to what it is measured by.
fn difference(one: &LumpedState, other: &LumpedState) -> (f64, &'static str) {
    let rise = other.peak_rise.max(1e-9);
    let heats = |state: &LumpedState| [state.punch.heat, state.strip.heat].into_iter().flatten().collect::<Vec<_>>();
    let relative = |one: f64, other: f64| (one - other).abs() / other.abs().max(f64::MIN_POSITIVE);
    let largest = |one: &[f64], other: &[f64]| {
        let scale = other.iter().fold(1e-9, |largest: f64, value| largest.max(value.abs()));
        one.iter().zip(other).map(|(one, other)| (one - other).abs() / scale).fold(0.0, f64::max)
    };
    [
        ((one.end_temperature - other.end_temperature).abs() / rise, "contact temperature"),
        ((one.peak_rise - other.peak_rise).abs() / rise, "highest rise"),
        (relative(one.end_force, other.end_force), "friction force"),
        (relative(one.dissipated, other.dissipated), "friction heat"),
        (relative(one.punch.received[0], other.punch.received[0]), "heat into the punch"),
        (relative(one.strip.received[0], other.strip.received[0]), "heat into the strip"),
        (largest(&one.punch.received, &other.punch.received), "heat into the faces of the punch"),
        (largest(&one.strip.received, &other.strip.received), "heat into the faces of the strip"),
        (relative(one.punch.depth, other.punch.depth), "wear of the punch"),
        (relative(one.strip.depth, other.strip.depth), "wear of the strip"),
        (relative(one.distance, other.distance), "distance"),
        (largest(&heats(one), &heats(other)), "states of the bodies"),
        (largest(&one.flash, &other.flash), "states of the moving source"),
    ]
    .into_iter()
    .fold((0.0, ""), |worst, next| if next.0 > worst.0 || next.0.is_nan() { next } else { worst })
}

#[test]
fn an_attempt_in_the_common_form_is_that_in_the_general_form() {
    const FADE: &[f64] = &[1.0, 0.9, 0.95, 0.6, 0.5, 0.45, 0.4, 0.35];
    // Without cooling that varies, both solve the same linear equations.
    let steady_air = [("strip.convection_forced", 0.0), ("strip.emissivity", 0.0)];
    let straight = [("strip.path", 1.0)];
    // The common form takes radiation as linear where that leaves 1e-3 of the tolerance, the general one 1e-6.
    let tolerance = STARTS[find("solver.tolerance").unwrap() as usize].max(1e-3);
    let (forced, radiating) = ([("strip.emissivity", 0.0)], [("strip.emissivity", 0.55)]);
    type Case<'a> = (&'a [(&'a str, f64)], &'a [(&'a str, f64)], bool, f64);
    let table = |body: &str, face: &[(&'static str, f64)]| {
        let mut changes = vec![(format!("{body}.property_table.points").leak() as &str, 2.0)];
        for (i, point) in [(293.15, 20.0, 450.0), (700.0, 12.0, 900.0)].into_iter().enumerate() {
            for (row, value) in [("temperature", point.0), ("conductivity", point.1), ("specific_heat", point.2)] {
                changes.push((format!("{body}.property_table.{row}[{}]", i + 1).leak(), value));
            }
        }
        [&changes, face].concat()
    };
    let beside = &table("strip", &[("strip.convection", 60.0)]);
    let of_punch = &table("punch", &[("punch.convection", 60.0), ("punch.top_thermal", 2.0)]);
    let of_strip = &[&beside[..], &[("strip.base_thermal", 2.0)]].concat();
    let of_both = &[&of_punch[..], of_strip].concat();
    let scenes: [Case<'_>; 15] = [
        (&steady_air, of_punch, false, 1e-12),
        (&steady_air, of_strip, false, 1e-12),
        (&steady_air, of_both, true, 1e-12),
        (&forced, of_punch, false, 1e-12),
        (&forced, beside, false, 1e-12),
        (&steady_air, &[], false, 1e-12),
        (&steady_air, &straight, false, 1e-12),
        (&steady_air, &[("strip.path", 1.0), ("nominal.stroke", 0.05)], false, 1e-12),
        (&steady_air, &[("punch.wear_pressure_exponent", 1.3), ("punch.wear_velocity_exponent", 0.8)], false, 1e-12),
        (&steady_air, &[("contact.conductance", 1e4)], false, 1e-12),
        (&steady_air, &[("contact.static_friction_ratio", 1.5)], false, 1e-12),
        (&steady_air, &[], true, 1e-12),
        (&forced, &[], false, 1e-12),
        (&radiating, &[], false, 1e-3 * tolerance),
        (&radiating, &[], true, 1e-3 * tolerance),
    ];
    for (air, changes, fades, bound) in scenes {
        let mut values = changed(&STARTS, &[air, changes].concat()).unwrap();
        if fades {
            let first = find("contact.friction_fade.factor[1]").unwrap() as usize;
            values[first..first + 8].copy_from_slice(FADE);
        }
        let scene = Scene::new(&values, None).unwrap();
        let operators = LumpedOperators::new(&scene);
        assert!(operators.has_common_form, "{changes:?}");
        let tunables = Tunables::of(&scene);
        let mut run = Lumped::new(Arc::new(operators), tunables, &Inputs::constant(0.0));
        let (mut compared, mut worst) = (0, (0.0, ""));
        for second in 0..40 {
            let speed = if second % 7 == 5 { 0.0 } else { 12.0 - 0.5 * f64::from(second % 20) };
            let load = if second % 5 == 3 { 0.0 } else { 700.0 * f64::from(second % 5) };
            run.step(&Inputs::new(speed, load, 0.0), None, 1.0).unwrap();
            for (other_speed, other_load) in [(speed, load), (0.98 * speed, load), (speed, 1.02 * load)] {
                for step in [1e-3, 1e-2, 0.1] {
                    let ends = [[speed, load], [other_speed, other_load]];
                    let [(fast, left), (general, right)] = attempts(&run, ends, step);
                    let taken = |attempt: &Option<Attempt>| attempt.as_ref().is_some_and(|one| one.error <= 1.0);
                    if taken(&fast) && taken(&general) {
                        compared += 1;
                        let now = difference(&left, &right);
                        worst = if now.0 > worst.0 || now.0.is_nan() { now } else { worst };
                    }
                }
            }
        }
        assert!(compared > 100, "{changes:?}: {compared} attempts");
        assert!(worst.0 < bound, "{air:?} {changes:?} fades {fades}: {worst:?}");
    }
}

/// Behind a caliper, with expansion by a prescribed temperature that differs from the ambient.
#[test]
fn the_load_at_the_end_of_a_step_is_that_of_the_state_reached() {
    let changes = [
        ("holder.stiffness", 1e8),
        ("strip.base_thermal", 1.0),
        ("strip.base_at_ambient", 0.0),
        ("strip.base_temperature", 400.0),
    ];
    let scene = Scene::new(&changed(&STARTS, &changes).unwrap(), None).unwrap();
    let mut run = Lumped::new(Arc::new(LumpedOperators::new(&scene)), Tunables::of(&scene), &Inputs::constant(0.0));
    let inputs = Inputs::new(5.0, 700.0, 0.0);
    for _ in 0..5 {
        run.step(&inputs, None, 0.1).unwrap();
        let force = run.point(&inputs).force;
        let error = (run.state.end_force / force - 1.0).abs();
        assert!(error < 1e-9, "{} N for {force} N: {error:e}", run.state.end_force);
    }
}
