//! `cargo fmu fit`: the wear law of a scene's punch from measured volumes, by examples/batch/fit.py.

use crate::batch::example;
use crate::{arguments, output, scenes};
use anyhow::{Context, Result, bail};
use scene_file::records::Records;
use std::path::PathBuf;

/// Fit the wear law to measured volumes: coefficient and exponents, with confidence intervals.
///
/// Every prediction is a run of the scene, so its geometry, temperatures and fade are part of the fit.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Tests (CSV): load [N], speed [m/s], distance [m], volume [mm3], in any unit of theirs; by default those in examples/batch/records.
    records: Option<PathBuf>,
    /// Scene of the tests: a name in examples/ or the path of a scene file.
    #[arg(long, default_value = "pin_on_disk")]
    scene: String,
    /// Exponents to fit, with commas; the others are 1.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "pressure")]
    exponents: Vec<Exponent>,
    /// Probability that the intervals hold the values.
    #[arg(long, default_value_t = 0.95, value_parser = arguments::number, allow_negative_numbers = true)]
    confidence: f64,
    /// Folder for the picture; by default batch/fit in cargo's target folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Exponents of the wear law.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
enum Exponent {
    Pressure,
    Velocity,
}

/// Runs the command.
///
/// # Errors
/// Everything wrong with the arguments and the files, records that do not determine the law.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_folder(arguments.output.as_deref())?;
    let confidence = arguments.confidence;
    if !(confidence > 0.0 && confidence < 1.0) {
        bail!("--confidence {confidence} must be above 0 and below 1");
    }
    let exponents = &arguments.exponents;
    if exponents.len() > 1 && exponents[1..].contains(&exponents[0]) {
        bail!("--exponents names one twice; accepted are pressure, velocity, or both with a comma");
    }
    scenes::load(Some(&arguments.scene))?;
    let scene = if scenes::names().contains(&arguments.scene) {
        arguments.scene.clone()
    } else {
        scenes::locate(&arguments.scene)?.display().to_string()
    };
    let mut passed = vec!["--scene".to_owned(), scene, "--confidence".to_owned(), confidence.to_string()];
    if let Some(records) = &arguments.records {
        // Before anything is built.
        let fitted = [Exponent::Pressure, Exponent::Velocity].map(|exponent| arguments.exponents.contains(&exponent));
        Records::read(records)?.check(fitted).with_context(|| records.display().to_string())?;
        passed.extend(["--records".to_owned(), records.display().to_string()]);
    }
    if let Some(folder) = &arguments.output {
        passed.extend(["--output".to_owned(), folder.display().to_string()]);
    }
    passed.push("--exponents".to_owned());
    passed.extend(arguments.exponents.iter().map(|exponent| match exponent {
        Exponent::Pressure => "pressure".to_owned(),
        Exponent::Velocity => "velocity".to_owned(),
    }));
    example::run("fit.py", &[], &passed, arguments.json)
}
