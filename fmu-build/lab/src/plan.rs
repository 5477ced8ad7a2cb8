//! `cargo fmu plan`: the choice of `solver.fidelity = auto` for a scene, and the quality of its choices.

mod campaign;
mod field;
mod inputs;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use scene::Fidelity;

use crate::output::{self, print_line};
use crate::{arguments, scenes};

/// Print the level that `solver.fidelity = auto` takes for a scene: effects with their governing numbers, kept or dropped, and
/// the error of each.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of a folder in `examples`; by default the stock scene.
    scene: Option<String>,
    /// Give a variable another value, as KEY=VALUE.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Tolerance of the importer, where `solver.tolerance` is 0; with --inputs that of the levels, before the scene's own.
    #[arg(long, value_parser = scenes::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Run every level on these inputs, print its error and cost, and name the cheapest that meets the tolerance.
    ///
    /// CSV with the columns time [s] and inputs with their units, as sliding_velocity [m/s] and normal_load [N]; linear between rows,
    /// each of which is a communication point.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["campaign", "against_field"])]
    inputs: Option<PathBuf>,
    /// Write the named level with its tolerance into the scene's file.
    #[arg(long, requires = "inputs", conflicts_with = "set")]
    write: bool,
    /// Compare auto on scenes as users build them with every fixed setting and a far finer reference run.
    ///
    /// Every third scene is held out. Reference runs and runs at fixed settings are cached in cargo's target folder.
    #[arg(long, conflicts_with_all = ["scene", "set", "tolerance"])]
    campaign: bool,
    /// Variants of the shipped scenes, driven by random ramps, instead of the scenes that the choice of the level was adjusted to.
    #[arg(long, requires = "campaign")]
    variants: bool,
    /// Scenes of the campaign, held-out ones counted.
    #[arg(long, default_value_t = 1000, requires = "campaign", value_parser = arguments::whole::<usize>(1..=1_000_000), allow_negative_numbers = true)]
    scenes: usize,
    /// Number of the first of them.
    #[arg(long, default_value_t = 0, requires = "campaign", value_parser = arguments::whole::<usize>(0..=1_000_000), allow_negative_numbers = true)]
    first: usize,
    /// Only scenes whose name contains this.
    #[arg(long, value_name = "TEXT", requires = "campaign")]
    only: Option<String>,
    /// The scenes that are held out, instead of the others.
    #[arg(long, requires = "campaign")]
    hold_out: bool,
    /// Run the fixed settings again.
    #[arg(long, requires = "campaign")]
    fresh: bool,
    /// Measure the cost of a step at the planned model level and at the level `field`, for an error of 1 %.
    #[arg(long, conflicts_with_all = ["campaign", "set", "tolerance", "json"])]
    against_field: bool,
    /// File to write the table of the campaign, or of the costs, to.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Where the scene is refused, or a level cannot be built.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_ending(arguments.output.as_deref(), &["csv"])?;
    if arguments.output.is_some() && !(arguments.campaign || arguments.against_field) {
        bail!("--output holds the table of --campaign or --against-field, and neither is given");
    }
    if arguments.campaign {
        return campaign::execute(&campaign::Request {
            variants: arguments.variants,
            first: arguments.first,
            scenes: arguments.scenes,
            only: arguments.only.clone(),
            hold_out: arguments.hold_out,
            fresh: arguments.fresh,
            json: arguments.json,
            output: arguments.output.clone(),
        });
    }
    if arguments.against_field {
        return field::measure(arguments.scene.as_deref(), arguments.output.as_deref());
    }
    let mut file = scenes::load(arguments.scene.as_deref())?;
    for assignment in &arguments.set {
        scenes::assign(&mut file, assignment)?;
    }
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
            tolerance: arguments.tolerance,
            write: arguments.write,
            json: arguments.json,
        });
    }
    let (scene, planned) = analyses::plan::choose(&file, arguments.tolerance)?;
    if arguments.json {
        print_line!("{:#}", analyses::plan::record(&planned.plan));
        return Ok(());
    }
    print_line!(
        "{}: load {} N, speed {} m/s, {} s",
        file.packaged.name,
        scene.nominal_load,
        scene.nominal_velocity,
        planned.plan.duration
    );
    for line in planned.plan.lines() {
        print_line!("{line}");
    }
    if scene.fidelity != Fidelity::Auto {
        print_line!("The scene itself sets solver.fidelity = {}.", format!("{:?}", scene.fidelity).to_lowercase());
    }
    Ok(())
}
