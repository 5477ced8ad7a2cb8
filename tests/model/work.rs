//! Counted work of steps with resolved heat at changing speed: solutions of the contact problem, matrix factorisations, internal
//! steps.

use model::Inputs;
use model::levels::{Model, ModelOperators};
use model::line::cycle::{JumpOptions, TrackedCycles};
use model::line::operators::LineOperators;
use model::lumped::conditions::Tunables;
use test_support::{changed_scene, scene};

/// Work of a run: accepted internal steps per communication step; rejections, solutions and factorisations per accepted step.
#[derive(Debug)]
struct Work {
    steps: f64,
    rejected: f64,
    solutions: f64,
    factorisations: f64,
}

/// Steps of `step` s at the velocities `velocity(n)`, linear between them, under the nominal load; from the second hundred on.
fn work(name: &str, changes: &[(&str, f64)], step: f64, velocity: impl Fn(u32) -> f64) -> Work {
    let scene = changed_scene(&scene(name), changes);
    let tunables = Tunables::of(&scene);
    let ambient = scene.ambient_temperature;
    let inputs = |velocity: f64| Inputs::new(velocity, scene.nominal_load, ambient);
    let mut model = Model::new(&ModelOperators::new(&scene, steady::run_in).unwrap(), tunables, &inputs(velocity(0)));
    let mut run = |numbers: std::ops::Range<u32>| {
        for n in numbers {
            let mut slopes = Inputs::constant(0.0);
            slopes.sliding_velocity = (velocity(n + 1) - velocity(n)) / step;
            model.step(&inputs(velocity(n)), Some(&slopes), step).unwrap();
        }
        let (contact, (accepted, rejected)) = (model.contact_work(), model.work());
        [accepted, rejected, contact.solves, contact.factorisations].map(|count| count as f64)
    };
    let before = run(0..100);
    let after = run(100..400);
    let [accepted, rejected, solutions, factorisations] = std::array::from_fn(|k| after[k] - before[k]);
    // The lumped heat takes one step for all steps of the line.
    let line = accepted - 300.0;
    Work {
        steps: line / 300.0,
        rejected: rejected / line,
        solutions: solutions / line,
        factorisations: factorisations / line,
    }
}

/// Operators of another velocity, or of the opposite direction, are no approximation.
#[test]
fn unidirectional_a_changing_speed_costs_what_a_held_one_does() {
    let unidirectional =
        [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("nominal.stroke", 0.0), ("strip.path", 1.0)];
    let held = work("reciprocating_punch", &unidirectional, 1e-3, |_| 0.012);
    let swinging = work("reciprocating_punch", &unidirectional, 1e-3, |n| 0.012 + 0.003 * (0.01 * f64::from(n)).cos());
    assert!((1.9..2.3).contains(&held.solutions), "{held:?}");
    assert!((2.0..3.5).contains(&swinging.solutions) && swinging.factorisations < 0.5, "{swinging:?}");
    assert!(swinging.steps < 1.1, "{swinging:?}");
}

/// Near marginal stability of a mode the operators of another velocity are a poor linearization: the iteration solves for the
/// modes concerned, and the next linearization point is nearer.
#[test]
fn braking_through_the_critical_speed_takes_few_repetitions() {
    let ring = [("solver.cells", 32.0)];
    let stop = work("hot_spots", &ring, 1e-4, |n| 0.1 + 0.1 * (0.02 * f64::from(n)).cos());
    assert!(stop.solutions < 10.0 && stop.factorisations < 0.9, "{stop:?}");
}

/// A step size rejected by the growth guard is not retried after every other step.
#[test]
fn above_the_critical_speed_hardly_a_step_is_rejected() {
    let ring = [("solver.cells", 32.0)];
    let held = work("hot_spots", &ring, 0.1, |_| 0.2);
    assert!((4.0..12.0).contains(&held.steps) && held.rejected < 0.1, "{held:?}");
}

/// The error of a jump is estimated by its halves, so that a cycle on a worn track takes its eight steps at any tolerance.
#[test]
fn a_cycle_on_a_worn_track_takes_its_eight_steps() {
    let track = [("solver.fidelity", 3.0), ("solver.heat", 2.0), ("strip.wear_coefficient", 1e-13)];
    for tolerance in [1e-2, 1e-6] {
        let scene =
            changed_scene(&scene("reciprocating_punch"), &[&track[..], &[("solver.tolerance", tolerance)]].concat());
        let operators = LineOperators::with_heat(&scene, false, steady::run_in).unwrap();
        let half = 1.0;
        let velocity = scene.nominal_stroke / half;
        let mut cycles =
            TrackedCycles::new(operators, [(velocity, half), (-velocity, half)], JumpOptions::default()).unwrap();
        let mut computed = 0;
        cycles.carry_to(100.0, |progress, _| computed = progress.computed).unwrap();
        let steps = cycles.line().state().steps;
        assert!(steps <= 8 * computed as u64, "{steps} steps of {computed} cycles");
    }
}
