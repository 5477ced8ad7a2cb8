//! A reversal at a communication point gives the same result whether the velocity there is exactly 0 or off by rounding.

use scene::variables::find;
use sliding_contact::component::Component;
use test_support::component;

/// Rises of the mean contact temperature at the communication points of a triangular velocity of amplitude `velocity` (m/s) that
/// takes `steps` steps of `step` s from there to 0, where it is `left` (m/s) in place of 0; linear or held over each step.
fn rises(component: &mut Component, steps: i32, step: f64, inputs: [f64; 2], left: f64, linear: bool) -> Vec<f64> {
    component.reset();
    component.enter_initialization();
    component.initialise(None).unwrap();
    let temperature = find("contact_temperature").unwrap();
    let start = component.get(temperature);
    let at = |number: i32| {
        let phase = (number + steps).rem_euclid(4 * steps);
        match f64::from((phase - 2 * steps).abs()) / f64::from(steps) - 1.0 {
            0.0 => left,
            part => inputs[0] * part,
        }
    };
    component.set_input(1, inputs[1]);
    (0..9 * steps)
        .map(|number| {
            component.set_input(0, at(number));
            if linear {
                component.set_input_derivative(0, (at(number + 1) - at(number)) / step);
            }
            component.step(step).unwrap();
            component.get(temperature) - start
        })
        .collect()
}

#[test]
fn what_rounding_leaves_of_the_velocity_at_a_reversal_changes_nothing() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0), ("solver.tolerance", 1e-4)];
    let lumped = [("solver.fidelity", 2.0), ("solver.tolerance", 1e-4)];
    let mut worst = Vec::new();
    for (name, level, inputs) in [
        ("reciprocating_punch", &line[..], [0.015, 1e4]),
        ("reciprocating_punch", &lumped[..], [0.015, 1e4]),
        ("disc_brake", &line[..], [2.0, 2e3]),
        ("disc_brake", &lumped[..], [2.0, 2e3]),
        ("clutch", &line[..], [5.0, 5e3]),
    ] {
        let mut component = component(name, level);
        for (steps, step) in [(4, 0.02), (2, 0.5)] {
            for linear in [true, false] {
                let exact = rises(&mut component, steps, step, inputs, 0.0, linear);
                let most = exact.iter().fold(0.0_f64, |most, rise| most.max(rise.abs()));
                for left in [1e-16, -1e-16, 1e-18, -1e-14, 1e-300] {
                    let other = rises(&mut component, steps, step, inputs, left, linear);
                    let apart = exact.iter().zip(&other).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / most;
                    // The remaining difference is that of an input that differs by 1e-14 of its amplitude.
                    if apart > 1e-8 {
                        worst.push(format!("{name} {} {steps} {step} {linear} {left:e}: {apart:e}", level.len()));
                    }
                }
            }
        }
    }
    assert!(worst.is_empty(), "{}", worst.join("\n"));
}
