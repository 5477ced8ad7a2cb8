//! `cargo fmu plan --against-field`: cost ratio of a step at the reference level to one at the planned model level.
//!
//! Both take the same communication steps at nominal load, so the ratio of their costs is that of whole runs.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use model::Inputs;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use model::plan::Prepared;
use scene::variables::find;
use scene::{Fidelity, Scene};
use verification::clock::processor_seconds;

use crate::chart::machine;
use crate::output::print_line;
use crate::scenes;

/// Tolerance of the planned model level.
const TOLERANCE: f64 = 1e-2;

/// Communication steps at the planned model level, and at `field`.
const STEPS: [usize; 2] = [200, 6];

/// Scenes measured by default: those with line geometry, which `field` requires. The hot spots have a level of their own.
const SCENES: [&str; 3] = ["disc_brake", "reciprocating_punch", "pin_on_disk"];

/// Measures one scene, or all, and writes a table where asked.
///
/// # Errors
/// Where a scene, a level or a step fails.
pub fn measure(scene: Option<&str>, output: Option<&Path>) -> Result<()> {
    let mut table = format!(
        "# Processor time of a communication step of the model level planned for an error of {TOLERANCE:e}, and of \
         solver.fidelity = field; nominal load and speed from a cold start.\n# {}; commit {}.\n\
         scene,cells,step_s,model_level_seconds,field_seconds,ratio\n",
        machine::name(),
        machine::commit()
    );
    let names = scene.map_or_else(|| SCENES.to_vec(), |scene| vec![scene]);
    for name in names {
        let file = scenes::load(Some(name))?;
        let mut starts = file.packaged.starts;
        let tolerance = find("solver.tolerance").context("no variable solver.tolerance")?;
        starts[tolerance as usize] = TOLERANCE;
        let mut scene = Scene::new(&starts, None).map_err(|broken| anyhow!("{broken}"))?;
        scene.fidelity = Fidelity::Auto;
        let prepared = Prepared::new(&scene, steady::run_in).map_err(|text| anyhow!(text))?;
        let mut finest = scene.clone();
        finest.fidelity = Fidelity::Field;
        let field = ModelOperators::new(&finest, steady::run_in).map_err(|text| anyhow!(text))?;
        let step = file.packaged.experiment.step;
        let own = seconds_per_step(&scene, &prepared.operators, step, STEPS[0])?;
        let reference = seconds_per_step(&scene, &field, step, STEPS[1])?;
        let (cells, ratio) = (prepared.operators.cells(), reference / own);
        writeln!(table, "{name},{cells},{step},{own:.3e},{reference:.3e},{ratio:.0}")?;
        print_line!(
            "{name}: {cells} cells: {own:.2e} s a step of {step} s; field: {reference:.2e} s, {ratio:.0} times as much"
        );
    }
    if let Some(path) = output {
        fs::write(path, table).with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
}

fn seconds_per_step(scene: &Scene, operators: &ModelOperators, step: f64, steps: usize) -> Result<f64> {
    let ambient = scene.ambient_temperature;
    let tunables = Tunables::of(scene);
    let mut inputs = Inputs::new(scene.nominal_velocity, scene.nominal_load, ambient);
    let mut model = Model::new(operators, tunables, &inputs);
    let begin = processor_seconds();
    for count in 0..steps {
        if scene.nominal_stroke > 0.0 {
            // Reciprocating with the nominal speed as the mean.
            let phase = PI * scene.nominal_velocity / scene.nominal_stroke * step * count as f64;
            inputs.sliding_velocity = 0.5 * PI * scene.nominal_velocity * phase.cos();
        }
        model.step(&inputs, None, step).map_err(|failure| anyhow!("{failure}"))?;
    }
    Ok((processor_seconds() - begin) / steps as f64)
}
