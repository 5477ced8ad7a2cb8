//! `cargo fmu plan`: the choice of `solver.fidelity = auto` for a scene, or every level on given inputs.

mod inputs;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::arguments;
use crate::output::{print_line, print_text};
use crate::scenes;

#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file, or name of a folder in `examples`; by default the stock scene.
    scene: Option<String>,
    /// Give a variable another value, as KEY=VALUE.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Tolerance of the importer, where `solver.tolerance` is 0; with --inputs it is before the scene's own.
    #[arg(long, value_parser = scenes::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Run every level on these inputs, print its error and cost, and name the cheapest that meets the tolerance.
    ///
    /// CSV with the columns time [s] and inputs with their units, as sliding_velocity [m/s] and normal_load [N]; linear between rows,
    /// divided into communication steps as by `simulate`.
    #[arg(long, value_name = "FILE")]
    inputs: Option<PathBuf>,
    #[command(flatten)]
    columns: arguments::Columns,
    /// Write the named level with its tolerance into the scene's file.
    #[arg(long, requires = "inputs", conflicts_with = "set")]
    write: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let file = scenes::changed(arguments.scene.as_deref(), &arguments.set)?;
    scenes::warn(&file);
    if let (true, Some(name)) = (arguments.write, arguments.scene.as_deref().filter(|name| !Path::new(name).is_file()))
    {
        bail!(
            "--write changes a scene file, and {name} is a shipped scene: copy examples/{name}/scene.toml and name the copy"
        );
    }
    if let Some(inputs) = &arguments.inputs {
        return inputs::execute(&inputs::Request {
            file: arguments.scene.as_deref().map(scenes::locate).transpose()?,
            scene: file,
            inputs,
            reading: arguments.columns.reading(),
            tolerance: arguments.tolerance,
            write: arguments.write,
            json: arguments.json,
        });
    }
    let plan = analyses::plan::choose(&file, arguments.tolerance)?;
    if arguments.json {
        print_line!("{:#}", plan.record());
        return Ok(());
    }
    print_text!("{}", plan.table());
    Ok(())
}
