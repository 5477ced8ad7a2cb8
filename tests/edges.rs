//! Inputs at the thresholds of the step, one unit in the last place beside them and at the limits of the admissible range, held
//! and linear: a step gives finite outputs that do not jump, or fails with a reason and leaves the state unchanged.

use scene::variables::find;
use sliding_contact::component::Component;
use test_support::component;

/// Scenes at both levels: closed paths, an annulus, and a straight strip that keeps its worn track.
fn scenes() -> Vec<(&'static str, Component)> {
    let lumped = [("solver.fidelity", 2.0)];
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0), ("solver.tolerance", 1e-2)];
    let worn = [("strip.wear_coefficient", 1e-15)];
    vec![
        ("brake lumped", component("disc_brake", &lumped)),
        ("brake line", component("disc_brake", &line)),
        ("clutch lumped", component("clutch", &lumped)),
        ("clutch line", component("clutch", &line)),
        ("punch lumped", component("reciprocating_punch", &[&lumped[..], &worn].concat())),
        ("punch line", component("reciprocating_punch", &[&line[..], &worn].concat())),
    ]
}

fn outputs(component: &mut Component) -> Vec<f64> {
    (7..250).map(|output| component.get(output)).collect()
}

/// Half a second at moderate inputs, then a step; its temperature, distance and dissipated energy.
fn after(component: &mut Component, inputs: [f64; 2], slopes: Option<[f64; 2]>, step: f64) -> Option<[f64; 3]> {
    component.reset();
    component.enter_initialization();
    component.initialise(None).unwrap();
    component.set_input(0, 0.015);
    component.set_input(1, 1e3);
    component.step(0.5).unwrap();
    component.set_input(0, inputs[0]);
    component.set_input(1, inputs[1]);
    if let Some(slopes) = slopes {
        component.set_input_derivative(0, slopes[0]);
        component.set_input_derivative(1, slopes[1]);
    }
    let before = outputs(component);
    match component.step(step) {
        Ok(()) => {
            let after = outputs(component);
            let bad = (7..).zip(&after).find(|(_, value)| !value.is_finite());
            assert!(bad.is_none(), "{bad:?} at {inputs:?} {slopes:?} {step}");
        }
        Err(error) => {
            assert!(!error.is_empty());
            // Compared by bits: for inputs far out of range the outputs are too.
            let same = before.iter().zip(outputs(component)).all(|(one, other)| one.to_bits() == other.to_bits());
            assert!(same, "{error} at {inputs:?} {slopes:?} {step}");
            return None;
        }
    }
    let of = |name: &str| find(name).unwrap();
    Some(["contact_temperature", "sliding_distance", "dissipated_energy"].map(|name| component.get(of(name))))
}

#[test]
fn outputs_do_not_jump_over_the_thresholds_of_the_step() {
    let half_width = |name: &str| if name.starts_with("punch") { 0.03 } else { 0.0475 };
    for (name, mut component) in scenes() {
        let a = half_width(name);
        // Jumps that count, travel of a quarter of the half-width and of nearly none, and the ends of a step.
        let jumped = 0.015 * (1.0 + 1e-6);
        for value in [jumped, 0.25 * a, 0.25 * a / 0.5, 1e-6 * a, 1e-6 * a / 0.5, 1e-9, 0.5e-9] {
            for step in [0.5, 0.1] {
                for kind in 0..4 {
                    let mut at = |value: f64| match kind {
                        0 => after(&mut component, [value, 1e3], None, step),
                        1 => after(&mut component, [-value, 1e3], None, step),
                        // Through zero at a part of the step, and onto zero.
                        2 => after(&mut component, [-value, 1e3], Some([1.0, 0.0]), step),
                        _ => after(&mut component, [value, 1e3], Some([-value / step, 100.0]), step),
                    };
                    let middle = at(value).unwrap();
                    for beside in [value.next_down(), value.next_up()] {
                        let other = at(beside).unwrap();
                        for (one, two) in middle.iter().zip(&other) {
                            let scale = middle[0].max(one.abs());
                            assert!((one - two).abs() <= 1e-6 * scale, "{name} {kind} {value} {step}: {one} {two}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_edges_of_the_range_of_numbers_leave_nothing_that_is_no_number() {
    let tiny = [0.0, -0.0, 5e-324, -5e-324, f64::MIN_POSITIVE, 1e-300, 1e-16, -1e-16];
    let large = [1e4, -1e5, 1e6];
    for (name, mut component) in scenes() {
        for velocity in tiny {
            for load in tiny {
                for slopes in
                    [None, Some([5e-324, -5e-324]), Some([0.0, 0.0]), Some([-velocity, -load]), Some([1.0, 1e3])]
                {
                    for step in [0.1, 1e-12] {
                        let found = after(&mut component, [velocity, load], slopes, step);
                        assert!(
                            found.is_some() || name.ends_with("line"),
                            "{name} {velocity:e} {load:e} {slopes:?} {step}"
                        );
                    }
                }
            }
        }
        // On the line these take the seconds that a step may take at most.
        for velocity in large.into_iter().filter(|_| name.ends_with("lumped")) {
            for load in [0.0, 1.0, 1e3] {
                for slopes in [None, Some([-2.0 * velocity, 0.0]), Some([velocity, load])] {
                    after(&mut component, [velocity, load], slopes, 1.0);
                }
            }
        }
    }
}
