//! `cargo fmu cycles`: reciprocating sliding over many cycles by cycle jumps.

use crate::output::{self, Interrupted, print_line, print_text};
use crate::{arguments, ctrl_c, drawing, scenes};
use analyses::cycles::{CycleHistory, Options, advance};
use anyhow::{Result, bail};
use fmu_build::progress::Progress;
use std::path::PathBuf;

/// Cycles are computed one by one only where the contact changes from one to the next; elsewhere implicit cycle jumps with an
/// error estimate each skip many cycles. On a straight track that wears, without heat, a jump is a cycle with many times the wear.
/// Prints the jumps, and the worn depths and contact temperature at the end.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock scene.
    scene: Option<String>,
    /// Number of cycles.
    #[arg(long, value_name = "N", default_value_t = 1e6, value_parser = arguments::number, allow_negative_numbers = true)]
    cycles: f64,
    /// Largest estimated error of a jump: of the shape over the elastic displacement under the mean pressure, of the heat over
    /// the heat, of the wear over that of the jump.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-3, value_parser = arguments::number, allow_negative_numbers = true)]
    tolerance: f64,
    /// Cells of the contact line; by default the scene's, or 33.
    #[arg(long, value_name = "N", value_parser = arguments::whole::<u16>(3..=1025), allow_negative_numbers = true)]
    cells: Option<u16>,
    /// Without heat.
    #[arg(long)]
    cold: bool,
    /// Give a variable of the scene another value, as punch.wear_coefficient=1e-14; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the jumps as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Draw pressure, wear and temperature over the cycles, as SVG, PDF or PNG by the file's ending.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    if let Some(path) = &arguments.output {
        output::check_file("--output", path)?;
        drawing::format("--output", path)?;
    }
    let history = history(arguments)?;
    if arguments.json {
        print_line!("{:#}", history.record());
    } else {
        print_text!("{}", history.table());
    }
    if let Some(path) = &arguments.output {
        drawing::write("cycles", &history.record(), "--output", path)?;
        if !arguments.json {
            print_line!("drawn in {}", path.display());
        }
    }
    if let Some(warning) = &history.warning {
        eprintln!("warning: {warning}");
    }
    if history.interrupted {
        let passed = history.stations.last().map_or(0.0, |station| station.jump.cycles);
        bail!(Interrupted(format!("interrupted after {passed} of {} cycles", arguments.cycles)));
    }
    Ok(())
}

fn history(arguments: &Arguments) -> Result<CycleHistory> {
    let file = scenes::changed(arguments.scene.as_deref(), &arguments.set)?;
    scenes::warn(&file);
    let Arguments { cycles, tolerance, cells, cold, .. } = *arguments;
    let mut progress = Progress::default();
    ctrl_c::attended(|| {
        advance(&file, &Options { cycles, tolerance, cells, cold }, &mut |passed, computed| {
            let part = (1.0 + passed).ln() / (1.0 + cycles).ln();
            progress.reached(part, || format!("{passed} cycles, {computed} computed"));
        })
    })
}
