//! Small pads far above their nominal speed: what a flux on few cells heats does not cool the others.

use model::Inputs;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use test_support::{changed_scene, scene};

/// In the first milliseconds the heat is where it is made: nothing is colder than it was.
#[test]
fn no_surface_cools_while_others_are_heated() {
    for (cells, tolerance) in [(33.0, 0.1), (17.0, 0.1), (33.0, 0.01)] {
        let changes = [
            ("punch.width", 0.020),
            ("punch.count", 3.0),
            ("solver.fidelity", 3.0),
            ("solver.cells", cells),
            ("solver.tolerance", tolerance),
        ];
        let scene = changed_scene(&scene("disc_brake"), &changes);
        let operators = ModelOperators::new(&scene, steady::run_in).unwrap();
        let tunables = Tunables::of(&scene);
        for step in [1e-4, 1e-3, 1e-2] {
            let inputs = Inputs::new(20.0, 2600.0, 0.0);
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
