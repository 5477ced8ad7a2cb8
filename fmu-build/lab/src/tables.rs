//! `cargo fmu tables`: decay rates and residues of the lumped level of a scene, for independent checks.

use crate::output::print_line;
use crate::scenes;
use anyhow::Result;
use conduction::flash::Flash;
use conduction::reduced::{Observation, ReducedBody};
use model::lumped::operators::{BodyOperators, LumpedOperators};
use scene::Scene;
use serde_json::{Value, json};

/// Temperatures in K above ambient, fluxes in W/m2; the equations stand in tests/fmpy/slow/quadrature.py.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock scene.
    scene: Option<String>,
    /// Tolerance instead of the scene's own.
    #[arg(long, value_parser = scenes::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    print_line!("{:#}", tables(arguments.scene.as_deref(), arguments.tolerance)?);
    Ok(())
}

/// Speeds (m/s) at which the sliding rate is given: dense enough that cubic interpolation of its logarithm over the
/// logarithm of the speed is exact to 1e-8.
fn speeds() -> impl Iterator<Item = f64> {
    (0..=1400).map(|index| 1e-6 * (f64::from(index) / 60.0).exp())
}

pub(crate) fn tables(scene: Option<&str>, tolerance: Option<f64>) -> Result<Value> {
    let packaged = scenes::load(scene)?.packaged;
    let mut scene = Scene::new(&packaged.starts, Some(packaged.experiment.tolerance))?;
    if let Some(tolerance) = tolerance {
        scene.tolerance = tolerance;
    }
    let operators = LumpedOperators::new(&scene);
    Ok(json!({
        "tolerance": scene.tolerance,
        "faces": scene.faces,
        "contact_area": operators.area,
        "power_factor": operators.power_factor,
        "conductance": scene.conductance,
        "friction_coefficient": scene.friction_coefficient,
        "punch": body(&operators.punch),
        "strip": body(&operators.strip),
        "flash": operators.flash.as_ref().map(moving_source),
    }))
}

fn body(body: &BodyOperators) -> Value {
    let [beside, far] = &body.air;
    let mut value = json!({
        "area": body.area,
        "forced": beside.forced,
        "emissivity": beside.emissivity,
        "base_forced": far.forced,
        "base_emissivity": far.emissivity,
    });
    if let (Some(heat), Some(fields)) = (&body.heat, value.as_object_mut()) {
        fields.extend(conduction(heat));
    }
    value
}

fn conduction(heat: &ReducedBody) -> serde_json::Map<String, Value> {
    let count = heat.count;
    let observation =
        |observation: &Observation| json!({ "states": observation.states[..count], "direct": observation.direct });
    let inputs: Vec<&[f64]> = heat.input.iter().map(|weights| &weights[..count]).collect();
    let value = json!({
        "rate": heat.rate[..count],
        "input": inputs,
        "contact_temperature": observation(&heat.contact_temperature),
        "cooled_temperature": observation(&heat.cooled_temperature),
        "base_temperature": observation(&heat.base_temperature),
        "mean_temperature": observation(&heat.mean_temperature),
        "stored": observation(&heat.stored),
        "ambient_flow": observation(&heat.ambient_flow),
        "base_flow": observation(&heat.base_flow),
        "error": heat.error,
    });
    match value {
        Value::Object(fields) => fields,
        _ => unreachable!("json! of braces is an object"),
    }
}

fn moving_source(flash: &Flash) -> Value {
    let speeds: Vec<f64> = speeds().collect();
    let rates: Vec<f64> = speeds.iter().map(|&speed| flash.sliding_rate(speed)).collect();
    json!({ "rate": flash.decays.rate, "residue": flash.decays.residue, "speed": speeds, "sliding_rate": rates })
}
