//! A reversal on a communication point is the same whether rounding has left the velocity at 0 or a little beside it.

use sliding_contact::component::Component;
use sliding_contact::variables::{STARTS, find};
use std::path::Path;
use std::sync::Arc;

const STEP: f64 = 0.01;

fn component(name: &str, changes: &[(&str, f64)]) -> Component {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).join("scene.toml");
    let mut starts = STARTS;
    starts.copy_from_slice(&sliding_contact::scene::file::read(&path).unwrap().packaged.starts);
    for (name, value) in changes {
        starts[find(name).unwrap() as usize] = *value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component
}

/// Rises of the mean contact temperature at the communication points of a triangular velocity of amplitude `velocity` (m/s) that
/// passes through 0 on every twentieth of them, where it is `left` (m/s) instead, linear or held over each step.
fn rises(mut component: Component, velocity: f64, load: f64, left: f64, linear: bool) -> Vec<f64> {
    let temperature = find("contact_temperature").unwrap();
    let start = component.get(temperature);
    let at = |step: i32| {
        let phase = (step + 10).rem_euclid(40);
        match f64::from((phase - 20).abs()) / 10.0 - 1.0 {
            0.0 => left,
            part => velocity * part,
        }
    };
    component.set_input(1, load);
    (0..90)
        .map(|step| {
            component.set_input(0, at(step));
            if linear {
                component.set_input_derivative(0, (at(step + 1) - at(step)) / STEP);
            }
            component.step(STEP).unwrap();
            component.get(temperature) - start
        })
        .collect()
}

#[test]
fn what_rounding_leaves_of_the_velocity_at_a_reversal_changes_nothing() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0), ("solver.tolerance", 1e-4)];
    let lumped = [("solver.fidelity", 2.0), ("solver.tolerance", 1e-4)];
    for (name, level, velocity, load) in [
        ("reciprocating_punch", &line[..], 0.015, 1e4),
        ("reciprocating_punch", &lumped[..], 0.015, 1e4),
        ("disc_brake", &line[..], 2.0, 2e3),
        ("disc_brake", &lumped[..], 2.0, 2e3),
        ("clutch", &line[..], 5.0, 5e3),
    ] {
        for linear in [true, false] {
            let exact = rises(component(name, level), velocity, load, 0.0, linear);
            let most = exact.iter().fold(0.0_f64, |most, rise| most.max(rise.abs()));
            for left in [1e-16, -1e-16, 1e-18, -1e-13, 1e-300] {
                let other = rises(component(name, level), velocity, load, left, linear);
                let apart = exact.iter().zip(&other).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                println!("{name} {} linear {linear} left {left:e}: {:e}", level.len(), apart / most);
            }
        }
    }
}
