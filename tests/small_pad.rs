//! scan
use sliding_contact::coupled::lumped::conditions::Tunables;
use sliding_contact::coupled::model::{Model, Operators};
use sliding_contact::scene::Scene;
use sliding_contact::variables::{STARTS, find};
use std::path::Path;

#[test]
fn scan() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/disc_brake/scene.toml");
    for (stock, cells, tolerance, h, load, n) in [
        (false, 33.0, 0.1, 0.001, 2600.0, 3),
        (false, 33.0, 0.01, 0.001, 2600.0, 3),
        (false, 33.0, 0.1, 0.0001, 2600.0, 3),
        (true, 33.0, 0.1, 0.1, 2000.0, 3),
    ] {
        let mut starts = STARTS;
        if !stock {
            starts.copy_from_slice(&sliding_contact::scene::file::read(&path).unwrap().packaged.starts);
        }
        for (name, value) in [
            ("punch.width", 0.020),
            ("punch.count", 3.0),
            ("solver.fidelity", 3.0),
            ("solver.cells", cells),
            ("solver.tolerance", tolerance),
        ] {
            starts[find(name).unwrap() as usize] = value;
        }
        let scene = Scene::new(&starts, None).unwrap();
        let operators = Operators::new(&scene).unwrap();
        let inputs = [20.0, load, 0.0, 0.0, 0.0, 0.0, 0.0];
        let tunables = Tunables {
            friction_coefficient: scene.friction_coefficient,
            ambient_temperature: scene.ambient_temperature,
            wear_acceleration: 1.0,
        };
        let mut model = Model::new(&operators, tunables, &inputs);
        for step in 0..n {
            println!("{cells} {tolerance} {h} step {step} {:?} {:?}", model.step(&inputs, None, h), model.work());
            if let Model::Line(line) = &model {
                let heat = line.state().heat.as_ref().unwrap();
                println!("x {:.2?}", line.operators().cells.centres().iter().map(|x| x * 1e3).collect::<Vec<_>>());
                println!("p {:.2?}", line.state().pressure.iter().map(|p| p / 1e6).collect::<Vec<_>>());
                println!("punch T {:.1?}", heat.temperature[0]);
                println!("strip T {:.1?}", heat.temperature[1]);
                println!("punch q {:.2?}", heat.flux[0].iter().map(|q| q / 1e6).collect::<Vec<_>>());
                println!("strip q {:.2?}", heat.flux[1].iter().map(|q| q / 1e6).collect::<Vec<_>>());
            }
        }
    }
}
