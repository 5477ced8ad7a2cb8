//! Reciprocating punch, cold and hot.

use super::{DriveProblem, Setting, Truth, every};
use scene::Fidelity;
use scene::variables::changed;
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

/// Without thermal distortion, with the wear accelerated as in the paper's reduced number of half-periods.
pub(super) fn cold() -> Result<DriveProblem, String> {
    let rigid = [("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
    Ok(DriveProblem {
        name: "reciprocating_punch",
        title: "Reciprocating punch: an elastic block wears on an elastic strip, cold",
        data: "60 x 10 mm steel on steel, 10 kN, 1.5 mm sin(10 t), mu 0.25, wear 3.9e-5 mm3/(N m) times 100 over 12 cycles",
        ..problem(12.0, 100.0, &rigid, (1e-6, 240.0))?
    })
}

/// With the thermal distortion by friction heat.
pub(super) fn hot() -> Result<DriveProblem, String> {
    Ok(DriveProblem {
        name: "hot_punch",
        title: "Hot reciprocating punch: the same with frictional heat and the distortion that it causes",
        data: "60 x 10 mm steel on steel, 10 kN, 1.5 mm sin(10 t), mu 0.25, expansion 1.1e-5 1/K, wear times 10, 4 cycles from cold",
        ..problem(4.0, 10.0, &[], (1e-4, 120.0))?
    })
}

/// What both share; the truth's tolerance and number of steps in a cycle.
fn problem(
    cycles: f64,
    acceleration: f64,
    changes: &[(&str, f64)],
    (tolerance, count): (f64, f64),
) -> Result<DriveProblem, String> {
    let text = include_str!("../../../../examples/reciprocating_punch/scene.toml");
    let scene = scene_file::parse(text).map_err(|wrong| wrong.to_string())?.packaged.starts;
    let own = [("wear_acceleration", acceleration), ("nominal.duration", cycles * cycle())];
    let setting =
        |cells| Setting { fidelity: Fidelity::Line, tolerance, cells, step: cycle() / count, order: 1, heat: true };
    Ok(DriveProblem {
        name: "",
        title: "",
        data: "",
        starts: changed(&scene, &[changes, &own].concat())?,
        inputs: Box::new(|time| [AMPLITUDE * FREQUENCY * (FREQUENCY * time).cos(), LOAD]),
        step: cycle() / STEPS,
        // With communication points at all samples.
        steps: [12.0, 24.0, 60.0, 120.0, 240.0].iter().map(|count| cycle() / count).collect(),
        // Six in a cycle, none of them at a reversal, where the sign of friction is determined by rounding.
        samples: every(cycle() / 6.0, cycles * cycle()),
        truth: Truth::Finest([257, 129, 97, 65].map(setting).to_vec()),
        reason: "what remains is the difference to a run of twice its cells",
        isothermal: false,
    })
}
