//! The scripts of examples/batch with everything they need ready.

use crate::{package, project, python};
use anyhow::{Context, Result};

/// A script of examples/batch.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Script {
    /// A design of experiments on Dask.
    Sweep,
}

/// Runs a file of examples/batch with the Python package and the FMUs of these shipped scenes, unless the arguments name others.
pub(crate) fn run(file: &str, fmus: &[&str], arguments: &[String], json: bool) -> Result<()> {
    let python = python::own(python::BATCH)?;
    let is_given = |name: &str| {
        arguments.iter().any(|argument| {
            argument.strip_prefix(name).is_some_and(|rest| matches!(rest.chars().next(), None | Some('=')))
        })
    };
    let mut command = python::script(&python, "python-batch", &format!("batch/{file}"));
    let fmus = if is_given("--fmu") { &[][..] } else { fmus };
    command.env("PYTHONPATH", package::wheel::unpacked(fmus)?);
    if !is_given("--output") {
        command.arg("--output").arg(project::target().join("batch").join(file.trim_end_matches(".py")));
    }
    if json && !is_given("--json") {
        command.arg("--json");
    }
    command.args(arguments);
    project::leave_ctrl_c()?;
    let status = command.status().with_context(|| format!("starting {}", python.display()))?;
    if !status.success() {
        project::leave(status, file)?;
    }
    Ok(())
}
