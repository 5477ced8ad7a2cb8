//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.

mod write;

use crate::columns::{self, Column, Reading};
use crate::output::print_line;
use analyses::plan::inputs::{self, Candidate, LEVELS, Levels};
use analyses::simulation::Trajectory;
use anyhow::{Result, anyhow};
use fmu_build::progress::Progress;
use model::plan::ModelLevel;
use model::plan::distance::largest;
use scene_file::SceneFile;
use std::path::{Path, PathBuf};

/// A comparison request.
pub struct Request<'a> {
    /// The scene.
    pub scene: SceneFile,
    /// File that it came from, for `--write`.
    pub file: Option<PathBuf>,
    /// Inputs over time.
    pub inputs: &'a Path,
    pub tolerance: Option<f64>,
    pub write: bool,
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// Where the file of the inputs or the scene is wrong; where no run converges or none meets the tolerance; where the scene
/// cannot be written.
pub fn execute(request: &Request) -> Result<()> {
    let name = &request.scene.packaged.name;
    let tolerance = inputs::tolerance(&request.scene, request.tolerance)?;
    let table = columns::read(request.inputs, &Column::inputs(), &Reading::default())?;
    table.notes.iter().for_each(|note| eprintln!("{note}"));
    let trajectory = Trajectory::new(&request.scene, Some(table), None)?;
    let mut progress = Progress::default();
    let levels = inputs::compare(&request.scene, &trajectory, tolerance, &mut |number, part| {
        let what = || LEVELS.get(number).map_or("reference".into(), ModelLevel::to_string);
        progress.reached((number as f64 + part) / (LEVELS.len() + 1) as f64, what);
    });
    drop(progress);
    let levels = levels?;
    if request.json {
        print_line!("{:#}", inputs::record(&levels));
    } else {
        lines(name, &trajectory, &levels).iter().for_each(|line| print_line!("{line}"));
    }
    let cheapest = levels.cheapest()?;
    if request.write {
        let file =
            request.file.as_deref().ok_or_else(|| anyhow!("--write needs a scene file; the stock scene has none"))?;
        write::settings(file, cheapest.level, tolerance)?;
        eprintln!("{}: {}, solver.tolerance = {tolerance:e} are written", file.display(), settings(cheapest.level));
    }
    Ok(())
}

/// A level as settings of a scene.
fn settings(level: ModelLevel) -> String {
    let (fidelity, cells) = inputs::settings(level);
    let cells = if cells > 0 { format!(", solver.cells = {cells}") } else { String::new() };
    format!("solver.fidelity = {fidelity:?}{cells}")
}

fn lines(name: &str, trajectory: &Trajectory, levels: &Levels) -> Vec<String> {
    let (first, last) = trajectory.span();
    let mut lines = vec![
        format!(
            "{name}: {} s, tolerance {:e}; errors of wear depth, temperature rise and friction force",
            last - first,
            levels.tolerance
        ),
        format!(
            "{:16} {:>10} {:>12} {:>10} {:>10} {:>10}",
            "level", "wear", "temperature", "friction", "steps", "seconds"
        ),
    ];
    for Candidate { level, errors, steps, seconds } in &levels.candidates {
        let level = level.to_string();
        let [wear, temperature, force] = errors.map(|error| format!("{error:.1e}"));
        lines.push(format!("{level:16} {wear:>10} {temperature:>12} {force:>10} {steps:10} {seconds:10.4}"));
    }
    lines.push(format!("The two finest lines differ by {:.1e}, which is part of every error.", levels.resolution));
    lines.extend(levels.failed.iter().map(|reason| format!("not run: {reason}")));
    if let Ok(cheapest) = levels.cheapest() {
        lines.push(format!(
            "The cheapest that meets it: {}, solver.tolerance = {:e}; error {:.1e}, {:.4} s",
            settings(cheapest.level),
            levels.tolerance,
            largest(cheapest.errors),
            cheapest.seconds
        ));
    }
    lines
}
