//! `cargo fmu run`: the FMU of a disc brake through a real drive cycle, driven from fmpy.

use crate::{package, project, python};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Drive the disc brake's FMU through a drive cycle; CSV, plots and a table of results.
///
/// Builds the FMU and the Python environment where they are not there yet. The car's road load and the brake's share
/// of it are in examples/disc_brake/road_load.py.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene of a disc brake: a name in examples/ or the path of a scene file.
    #[arg(long, default_value = "disc_brake")]
    scene: String,
    /// Drive an .fmu that is there already instead of packaging the scene.
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    fmu: Option<PathBuf>,
    /// Drive cycle: udds, hwfet or the path of a CSV file with the columns time_s, speed_m_per_s.
    #[arg(long, default_value = "udds")]
    cycle: String,
    /// Communication step in seconds.
    #[arg(long, default_value_t = 0.1)]
    step: f64,
    /// Folder for CSV and plots; the default is run in cargo's target folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Where packaging, the Python environment or the drive fails.
pub fn execute(arguments: &Arguments) -> Result<()> {
    let cycle = cycle_file(&arguments.cycle)?;
    let python = python::environment()?;
    let fmu = match &arguments.fmu {
        Some(file) if file.is_file() => file.clone(),
        Some(file) => bail!("there is no file {}", file.display()),
        None => package::build(Some(&arguments.scene), &package::Options::default())?,
    };
    let output = arguments.output.clone().unwrap_or_else(|| project::target().join("run"));
    let mut command = drive(&python, &fmu, &cycle, &output);
    command.arg("--step").arg(arguments.step.to_string());
    if arguments.json {
        command.arg("--json");
    }
    let status = command.status().with_context(|| format!("starting {}", python.display()))?;
    if !status.success() {
        bail!("the drive did not finish ({status})");
    }
    Ok(())
}

/// Drives an .fmu through the UDDS without printing anything and returns the recording.
///
/// # Errors
/// As [`execute`].
pub fn record(python: &Path, fmu: &Path, folder: &Path) -> Result<PathBuf> {
    let output = drive(python, fmu, &cycle_file("udds")?, folder).output()?;
    if !output.status.success() {
        bail!("the drive did not finish: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(folder.join("udds.csv"))
}

/// The script that drives, in the project's environment.
fn drive(python: &Path, fmu: &Path, cycle: &Path, output: &Path) -> Command {
    let mut command = Command::new(python);
    command
        .arg(project::root().join("examples/disc_brake/drive.py"))
        .arg("--fmu")
        .arg(fmu)
        .arg("--cycle")
        .arg(cycle)
        .arg("--output")
        .arg(output)
        // Caches of fonts and byte code belong to the target folder, not to the sources or the user's home.
        .env("MPLCONFIGDIR", project::target().join("python").join("matplotlib"))
        .env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// A cycle of the project by its name, or any other by its path.
fn cycle_file(name: &str) -> Result<PathBuf> {
    let folder = project::root().join("examples/data");
    let own = folder.join(format!("{name}.csv"));
    if own.is_file() {
        return Ok(own);
    }
    if Path::new(name).is_file() {
        return Ok(PathBuf::from(name));
    }
    bail!("--cycle {name} is neither a file nor one of the cycles in {}: udds, hwfet", folder.display())
}
