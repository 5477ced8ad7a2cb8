//! The scripts of examples/batch with everything they need ready.

use crate::{package, project, python};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use std::process::Command;

/// A script of examples/batch.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Script {
    /// A design of experiments on Dask.
    Sweep,
    /// Wear coefficient and exponent from pin-on-disk records.
    Fit,
}

impl Script {
    /// File, and the scene whose FMU it drives unless its arguments name one.
    fn file_and_scene(self) -> (&'static str, &'static str) {
        match self {
            Script::Sweep => ("sweep.py", "disc_brake"),
            Script::Fit => ("fit.py", "pin_on_disk"),
        }
    }
}

/// Builds what the script needs unless the arguments name it, and runs it.
///
/// # Errors
/// Where something cannot be built or the script fails.
pub fn run(script: Script, arguments: &[String], json: bool) -> Result<()> {
    let python = python::batch_environment()?;
    let (file, scene) = script.file_and_scene();
    let is_given = |name: &str| {
        arguments.iter().any(|argument| {
            argument.strip_prefix(name).is_some_and(|rest| matches!(rest.chars().next(), None | Some('=')))
        })
    };
    let mut command = Command::new(&python);
    command.arg(project::root().join("examples/batch").join(file));
    if !is_given("--fmu") {
        command.arg("--fmu").arg(package::build(Some(scene), &package::Options::default())?);
    }
    if !is_given("--host") {
        command.arg("--host").arg(library()?);
    }
    if !is_given("--output") {
        command.arg("--output").arg(project::target().join("batch").join(file.trim_end_matches(".py")));
    }
    if json && !is_given("--json") {
        command.arg("--json");
    }
    command
        .args(arguments)
        // Caches of fonts and byte code belong to the target folder, not to the sources or the user's home.
        .env("MPLCONFIGDIR", project::target().join("python-batch").join("matplotlib"))
        .env("PYTHONDONTWRITEBYTECODE", "1");
    let status = command.status().with_context(|| format!("starting {}", python.display()))?;
    if !status.success() {
        bail!("{file} did not finish ({status})");
    }
    Ok(())
}

/// Builds the host library and returns its path.
///
/// # Errors
/// Where the compiler reports an error.
pub fn library() -> Result<PathBuf> {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(["build", "--package", "fmu-host", "--lib", "--release", "--locked", "--quiet", "--target-dir"])
        .arg(project::target())
        .current_dir(project::root());
    let status = command.status().with_context(|| format!("starting {}", command.get_program().display()))?;
    if !status.success() {
        bail!("building the host library failed ({status})");
    }
    let name = format!("{}fmu_host{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(project::target().join("release").join(name))
}
