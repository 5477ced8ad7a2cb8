//! Steady cycles with heat.
use sliding_contact::coupled::line::cycle::{Resolution, SolveOptions};
use sliding_contact::elastic::scene::{cells_for, compliances};
use sliding_contact::scene::Scene;
use sliding_contact::steady::scene::{Sliding, steady_state};
use sliding_contact::steady::thermal::{cycle_map, hot_state, nominal_half_strokes};
use std::time::Instant;

fn scene(changes: &[(&str, f64)]) -> Scene {
    let mut values = crate::drive::scene("reciprocating_punch");
    for (name, value) in changes {
        values[sliding_contact::variables::find(name).unwrap() as usize] = *value;
    }
    Scene::new(&values, None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn scratch() {
    let scene = scene(&[("solver.cells", 33.0)]);
    let cells = cells_for(&scene, 33).unwrap();
    let bodies = compliances(&scene, &cells).unwrap();
    let t = Instant::now();
    let cold = steady_state(&scene, &cells, &bodies, &Sliding::nominal(&scene)).unwrap();
    println!("cold {:?}", t.elapsed());
    for (parts, levels) in [(3, 3), (3, 5), (6, 4), (12, 4), (3, 4)] {
        let t = Instant::now();
        let mut map = cycle_map(&scene, nominal_half_strokes(&scene), Resolution { levels, parts }).unwrap();
        println!("map {:?} heat entries {}", t.elapsed(), map.heat_entries());
        let mut start = map.start();
        start[map.worn_ranges()[0].clone()].copy_from_slice(&cold.shape);
        let t = Instant::now();
        map.pass(&start).unwrap();
        println!("pass {:?}", t.elapsed());
        let t = Instant::now();
        let solved = map.steady(&start, &SolveOptions::default());
        println!("{:?}", t.elapsed());
        match solved {
            Ok(solved) => {
                println!("{} cycles, {:?}", solved.cycles, solved.residual);
                let pm = 1e4 / (0.06 * 0.01);
                for stroke in &solved.passage.strokes {
                    println!("p {:.5?}", stroke.pressure.iter().step_by(4).map(|p| p / pm).collect::<Vec<_>>());
                    println!("start {:.5?}", stroke.pressure_at[0].iter().step_by(4).map(|p| p / pm).collect::<Vec<_>>());
                    println!("end {:.5?}", stroke.pressure_at[1].iter().step_by(4).map(|p| p / pm).collect::<Vec<_>>());
                    println!("T {:.3?}", stroke.temperature[0].iter().step_by(4).collect::<Vec<_>>());
                }
                println!("cold {:.5?}", cold.strokes[0].pressure.iter().step_by(4).map(|p| p / pm).collect::<Vec<_>>());
                println!("{:?} R {}", solved.passage.contact_temperature, map.speed_ratio());
            }
            Err(error) => println!("{error}"),
        }
    }
    let t = Instant::now();
    println!("{:?}", hot_state(&scene, &cells, &bodies, &Sliding::nominal(&scene)).map(|hot| (hot.heat.flows, hot.heat.contact_temperature, hot.heat.accuracy)));
    println!("hot {:?}", t.elapsed());
}
