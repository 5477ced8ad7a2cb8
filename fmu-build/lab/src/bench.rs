//! `cargo fmu bench --line`: costs of the contact line, solvers and level alike.

mod drives;
mod level;
mod line;

use anyhow::Result;
use fmu_build::bench::{Cost, TURNS, report};

/// Time wear steps of the contact line, in solutions of one dense system of as many unknowns.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// As `cargo fmu bench` knows it; there is nothing else here to time.
    #[arg(long, required = true)]
    line: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

/// Turns of a whole drive.
const DRIVE_TURNS: usize = 3;

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let mut costs = line::measure()?;
    costs.extend(level::measure()?);
    costs.extend(drives::measure()?);
    report(&costs, arguments.json)
}
