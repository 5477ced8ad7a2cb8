//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.

mod write;

use crate::columns::{self, Column};
use crate::output::print_line;
use analyses::plan::inputs::{self, Candidate, LEVELS, Levels, Setting, largest};
use anyhow::{Result, anyhow};
use indicatif::{ProgressBar, ProgressStyle};
use scene_file::SceneFile;
use std::path::{Path, PathBuf};
use verification::applications::Application;

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
    let packaged = &request.scene.packaged;
    let tolerance = inputs::tolerance(&request.scene, request.tolerance)?;
    let table = columns::read(request.inputs, &Column::inputs())?;
    let drive = inputs::drive(&packaged.name, &packaged.starts, &table)?;
    let bar = ProgressBar::new(LEVELS.len() as u64)
        .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}")?);
    let mut started = |number: usize, setting: Setting| {
        bar.set_position(number as u64);
        bar.set_message(setting.to_string());
    };
    let levels = inputs::compare(&drive, tolerance, &mut started);
    bar.finish_and_clear();
    let levels = levels?;
    if request.json {
        print_line!("{:#}", inputs::record(&levels));
    } else {
        lines(&packaged.name, &drive, &levels).iter().for_each(|line| print_line!("{line}"));
    }
    bar.reset();
    let cheapest = levels.chosen(&drive, &mut started);
    bar.finish_and_clear();
    let cheapest = cheapest?;
    if request.write {
        let file =
            request.file.as_deref().ok_or_else(|| anyhow!("--write needs a scene file; the stock scene has none"))?;
        write::settings(file, cheapest.setting, tolerance)?;
        eprintln!("{}: {}, solver.tolerance = {tolerance:e} are written", file.display(), settings(cheapest.setting));
    }
    Ok(())
}

/// A level as settings of a scene.
fn settings(setting: Setting) -> String {
    let (fidelity, cells) = inputs::level(setting);
    let cells = cells.map_or(String::new(), |cells| format!(", solver.cells = {cells}"));
    format!("solver.fidelity = {fidelity:?}{cells}")
}

fn lines(name: &str, drive: &Application, levels: &Levels) -> Vec<String> {
    let course = &drive.course;
    let time = course.last().map_or(0.0, |last| last[0] - course[0][0]);
    let mut lines = vec![
        format!("{name}: {time} s in {} communication steps, tolerance {:e}", course.len() - 1, levels.tolerance),
        format!(
            "{:10} {:>10} {:>12} {:>10} {:>10} {:>10}",
            "level", "wear", "temperature", "friction", "steps", "seconds"
        ),
    ];
    for Candidate { setting, errors, steps, seconds, .. } in &levels.candidates {
        let setting = setting.to_string();
        let [wear, temperature, force] =
            errors.map(|error| if levels.are_known() { format!("{error:.2e}") } else { "unknown".into() });
        lines.push(format!("{setting:10} {wear:>10} {temperature:>12} {force:>10} {steps:10} {seconds:10.4}"));
    }
    lines.extend(levels.failed.iter().map(|reason| format!("not run: {reason}")));
    if let Some(cheapest) = levels.cheapest() {
        lines.push(format!(
            "The cheapest that meets it: {}, solver.tolerance = {:e}; estimated error {:.2e}, {:.4} s",
            settings(cheapest.setting),
            levels.tolerance,
            largest(cheapest.errors),
            cheapest.seconds
        ));
    }
    lines
}
