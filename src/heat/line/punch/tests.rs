use super::super::{Account, GAMMA, LineHeat, Stage, Surroundings};
use super::*;
use crate::elastic::block::{Block, BlockProperties, Discretization, ThermalBlock, ThermalProperties, TopCondition};
use crate::variables::{STARTS, reference};
use faer::Mat;

const TOLERANCE: f64 = 1e-4;

/// Steel punch, 60 mm x 100 mm x 10 mm, with changed parameters.
fn scene(changes: &[(&str, f64)]) -> Scene {
    let mut values = STARTS;
    let steel = [
        ("punch.width", 0.06),
        ("punch.height", 0.1),
        ("depth", 0.01),
        ("punch.conductivity", 55.0),
        ("punch.density", 7800.0),
        ("punch.specific_heat", 460.0),
        ("punch.thermal_expansion", 1.1e-5),
        ("punch.poissons_ratio", 0.3),
        ("punch.convection", 0.0),
        ("punch.top_thermal", 1.0),
    ];
    for (name, value) in steel.iter().chain(changes) {
        values[reference(name) as usize] = *value;
    }
    Scene::new(&values, None).unwrap()
}

fn cells(count: usize) -> Cells {
    Cells::graded(0.03, count).unwrap()
}

#[test]
fn look() {
    for (count, duration, tolerance) in [(33, 1000.0, 1e-4), (33, 1000.0, 1e-3), (33, 10.0, 1e-4), (129, 1000.0, 1e-4)] {
        for changes in [vec![], vec![("punch.top_thermal", 3.0), ("punch.convection", 20.0)], vec![("punch.top_thermal", 3.0)]] {
            let scene = scene(&changes);
            let cells = cells(count);
            let start = std::time::Instant::now();
            let mut heat = reduce(&scene, &cells, tolerance, duration).unwrap().unwrap();
            let made = start.elapsed();
            let start = std::time::Instant::now();
            heat.prepare(1e-3, [0.0; 2]);
            println!("{count} {duration} {tolerance} {changes:?}: {} states, error {:.2e}, {:?}, prepare {:?}", heat.decaying_states(), heat.error(), made, start.elapsed());
        }
    }
}
