//! Small pads far above their nominal speed: a flux on few cells does not cool the others.

use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use scene::Scene;
use scene::variables::{STARTS, find};
use sliding_contact::component::Component;
use std::path::Path;
use std::sync::Arc;

fn small_pad(cells: f64, tolerance: f64) -> [f64; STARTS.len()] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/disc_brake/scene.toml");
    let mut starts = STARTS;
    starts.copy_from_slice(&scene_file::read(&path).unwrap().packaged.starts);
    for (name, value) in [
        ("punch.width", 0.020),
        ("punch.count", 3.0),
        ("solver.fidelity", 3.0),
        ("solver.cells", cells),
        ("solver.tolerance", tolerance),
    ] {
        starts[find(name).unwrap() as usize] = value;
    }
    starts
}

/// In the first milliseconds the heat is confined to its source: no cell is colder than initially.
#[test]
fn no_surface_cools_while_others_are_heated() {
    for (cells, tolerance) in [(33.0, 0.1), (17.0, 0.1), (33.0, 0.01)] {
        let scene = Scene::new(&small_pad(cells, tolerance), None).unwrap();
        let operators = ModelOperators::new(&scene, steady::run_in).unwrap();
        let tunables = Tunables {
            friction_coefficient: scene.friction_coefficient,
            ambient_temperature: scene.ambient_temperature,
            wear_acceleration: 1.0,
        };
        for step in [1e-4, 1e-3, 1e-2] {
            let inputs = [20.0, 2600.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            let mut model = Model::new(&operators, tunables, &inputs);
            for number in 0..5 {
                model.step(&inputs, None, step).unwrap();
                let Model::Line(line) = &model else { panic!("a contact line") };
                let heat = line.state().heat.as_ref().unwrap();
                let highest = heat.temperature.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
                let lowest = heat.lowest();
                assert!(lowest > -0.01 * highest, "{cells} {tolerance} {step} {number}: {lowest} to {highest} K");
            }
        }
    }
}

#[test]
fn a_long_stop_from_twenty_metres_per_second_stays_above_absolute_zero() {
    let mut component = Component::new(Arc::new(small_pad(33.0, 0.1)));
    for load in [4000.0, 10_000.0] {
        for step in [0.001, 0.1, 10.0] {
            component.reset();
            component.enter_initialization();
            component.initialise(None).unwrap();
            component.set_input(0, 20.0);
            component.set_input(1, load);
            for number in 0..4 {
                component.step(step).unwrap_or_else(|error| panic!("{load} N, {step} s, step {number}: {error}"));
            }
        }
    }
}
