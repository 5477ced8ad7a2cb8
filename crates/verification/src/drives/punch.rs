//! Reciprocating punch, cold and hot.

use super::{DriveProblem, Setting, Truth, every};
use scene::Fidelity;
use scene::variables::changed;
use sliding_contact::component::Values;
use std::f64::consts::PI;

/// Half-stroke, m.
const AMPLITUDE: f64 = 1.5e-3;
/// Angular frequency of the stroke, 1/s.
const FREQUENCY: f64 = 10.0;
const LOAD: f64 = 10e3;
/// Number of communication steps of a cycle that resolve the velocity.
const STEPS: f64 = 60.0;

fn cycle() -> f64 {
    2.0 * PI / FREQUENCY
}

fn scene() -> Result<Values, String> {
    let text = include_str!("../../../../examples/reciprocating_punch/scene.toml");
    Ok(scene_file::parse(text).map_err(|wrong| wrong.to_string())?.packaged.starts)
}

fn inputs(time: f64) -> [f64; 2] {
    [AMPLITUDE * FREQUENCY * (FREQUENCY * time).cos(), LOAD]
}

/// Step sizes with communication points at all samples.
fn steps() -> Vec<f64> {
    [12.0, 24.0, 60.0, 120.0, 240.0].iter().map(|count| cycle() / count).collect()
}

/// Six samples in a cycle, none of them at a reversal, where the sign of friction is determined by rounding.
fn samples(cycles: f64) -> Vec<f64> {
    every(cycle() / 6.0, cycles * cycle())
}

fn finest(tolerance: f64, count: f64) -> Truth {
    let setting =
        |cells| Setting { fidelity: Fidelity::Line, tolerance, cells, step: cycle() / count, order: 1, heat: true };
    Truth::Finest([257, 129, 97, 65].map(setting).to_vec())
}

/// Without thermal distortion, with the wear accelerated as in the paper's reduced number of half-periods.
pub(super) fn cold() -> Result<DriveProblem, String> {
    let cycles = 12.0;
    let changes = [
        ("punch.thermal_expansion", 0.0),
        ("strip.thermal_expansion", 0.0),
        ("wear_acceleration", 100.0),
        ("nominal.duration", cycles * cycle()),
    ];
    Ok(DriveProblem {
        name: "reciprocating_punch",
        title: "Reciprocating punch: an elastic block wears on an elastic strip, cold",
        data: "60 x 10 mm steel on steel, 10 kN, 1.5 mm sin(10 t), mu 0.25, wear 3.9e-5 mm3/(N m) times 100 over 12 cycles",
        starts: changed(&scene()?, &changes)?,
        inputs: Box::new(inputs),
        step: cycle() / STEPS,
        steps: steps(),
        samples: samples(cycles),
        truth: finest(1e-6, 240.0),
        reason: "what remains is the difference to a run of twice its cells",
        isothermal: false,
    })
}

/// With the thermal distortion by friction heat.
pub(super) fn hot() -> Result<DriveProblem, String> {
    let cycles = 4.0;
    let changes = [("wear_acceleration", 10.0), ("nominal.duration", cycles * cycle())];
    Ok(DriveProblem {
        name: "hot_punch",
        title: "Hot reciprocating punch: the same with frictional heat and the distortion that it causes",
        data: "60 x 10 mm steel on steel, 10 kN, 1.5 mm sin(10 t), mu 0.25, expansion 1.1e-5 1/K, wear times 10, 4 cycles from cold",
        starts: changed(&scene()?, &changes)?,
        inputs: Box::new(inputs),
        step: cycle() / STEPS,
        steps: steps(),
        samples: samples(cycles),
        truth: finest(1e-4, 120.0),
        reason: "what remains is the difference to a run of twice its cells",
        isothermal: false,
    })
}
