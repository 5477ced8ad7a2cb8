//! `cargo fmu fit`: parameters of a scene from records of tests, by examples/batch/fit.py.

use crate::batch::example;
use crate::{arguments, output, scenes};
use anyhow::{Result, anyhow, bail};
use scene::variables::{Causality, TABLE, find, lookup};
use scene_file::nearest;
use scene_file::records::Tests;
use std::path::PathBuf;

/// Fit parameters of a scene to records: values with confidence intervals, and those that the records do not determine.
///
/// Every prediction is a run of the scene at its level and tolerance, so its geometry, temperatures and laws are part of the fit.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Files (CSV or Parquet): end values with load [N], speed [m/s], distance [m] and volume [mm3] or other outputs, a row for every test, or the
    /// history of a test with time [s], inputs and outputs; by default the tests in examples/batch/records.
    records: Vec<PathBuf>,
    /// Scene of the tests: a name in examples/ or the path of a scene file.
    #[arg(long, default_value = "pin_on_disk")]
    scene: String,
    #[command(flatten)]
    columns: arguments::Columns,
    /// Parameters to fit, with commas, from the scene's values on.
    #[arg(long, value_delimiter = ',', default_value = "punch.wear_coefficient,punch.wear_pressure_exponent")]
    parameters: Vec<String>,
    /// Give a variable of the scene another value, as punch.width="40 mm"; may be repeated.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Probability that the intervals hold the values.
    #[arg(long, default_value_t = 0.95, value_parser = arguments::number, allow_negative_numbers = true)]
    confidence: f64,
    /// Folder for the picture and the result as JSON; by default batch/fit in cargo's target folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Write a design of this many scenes, whose parameters have the joint distribution of the fit, for `cargo fmu batch`.
    #[arg(long, value_name = "SCENES", default_value_t = 0)]
    draw: u32,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Everything wrong with the arguments and the files, records that determine no parameter.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let confidence = arguments.confidence;
    if !(confidence > 0.0 && confidence < 1.0) {
        bail!("--confidence {confidence} must be above 0 and below 1");
    }
    for (at, name) in arguments.parameters.iter().enumerate() {
        check(name).map_err(|wrong| anyhow!("--parameters: {wrong}"))?;
        if arguments.parameters[..at].contains(name) {
            bail!("--parameters names {name} twice");
        }
    }
    scenes::changed(Some(&arguments.scene), &arguments.set)?;
    let scene = if scenes::names().contains(&arguments.scene) {
        arguments.scene.clone()
    } else {
        scenes::locate(&arguments.scene)?.display().to_string()
    };
    // Before anything is built.
    let reading = arguments.columns.reading();
    let tests = arguments.records.iter().map(|path| Tests::read(path, &reading)).collect::<Result<Vec<_>>>()?;
    reading.check(&tests.iter().map(Tests::headers).collect::<Vec<_>>())?;
    let mut passed = vec!["--scene".to_owned(), scene, "--confidence".to_owned(), confidence.to_string()];
    let records = arguments.records.iter().map(|path| path.display().to_string());
    let folder = arguments.output.iter().map(|path| path.display().to_string());
    for (option, values) in [
        ("--records", records.collect()),
        ("--output", folder.collect()),
        ("--parameters", arguments.parameters.clone()),
        ("--set", arguments.set.clone()),
        ("--draw", vec![arguments.draw.to_string()]),
    ] {
        let values: Vec<String> = values;
        if !values.is_empty() {
            passed.push(option.to_owned());
            passed.extend(values);
        }
    }
    passed.extend(arguments.columns.options());
    example::run("fit.py", &[], &passed, arguments.json)
}

fn check(name: &str) -> Result<(), String> {
    match find(name).and_then(lookup) {
        Some((row, _)) if row.causality == Causality::Parameter => Ok(()),
        Some(_) => Err(format!("{name} is no parameter")),
        None => {
            let parameters = TABLE.iter().filter(|row| row.causality == Causality::Parameter);
            Err(format!("there is no parameter {name:?}{}", nearest(name, parameters.map(|row| row.name))))
        }
    }
}
