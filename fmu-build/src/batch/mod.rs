//! `cargo fmu batch`: many scenes with one FMU, natively; one row of results for each.

pub mod example;
mod pool;
mod results;
mod tables;
pub mod worker;

pub use tables::{Inputs, Table};
pub use worker::points;

use crate::output::{self, print_line};
use crate::{package, project, python, scenes};
use anyhow::{Context, Result, bail};
use fmu_host::{Causality, Description, Interpolation, Schedule, Span, Worker};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use results::{Results, Row};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Reasons of failures that are printed.
const REASONS: usize = 10;
/// Ending of a column that multiplies an input's column of the schedule.
const FACTOR: &str = ".factor";
/// Ending of a column with the largest value of an output.
const PEAK: &str = ".peak";

/// Run many variants of a scene: a row of parameters each, a row of results each.
///
/// A column of the design is a parameter of the FMU, with a unit in its header or its cells where it is not the SI one
/// (`punch.width [mm]`, `40 mm`), or NAME.factor: the factor on the column of the input NAME.
/// A scene that fails is a row with its stage and its reason. A run that was stopped is continued by the same command.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// CSV file: a header with the names of parameters, a row per scene.
    #[arg(required_unless_present = "example")]
    design: Option<PathBuf>,
    /// The scene that the rows vary: the name of a shipped one, or a scene file.
    #[arg(long, conflicts_with = "fmu")]
    scene: Option<String>,
    /// An .fmu instead of a scene.
    #[arg(long, value_name = "FILE", required_unless_present_any = ["example", "scene"])]
    fmu: Option<PathBuf>,
    /// CSV file with the inputs over time: the column time, and one per input, in the FMU's unit or in the one that the
    /// header says, as in "sliding_velocity [km/h]".
    #[arg(long, value_name = "FILE", required_unless_present = "example")]
    inputs: Option<PathBuf>,
    /// File of results: CSV, or Parquet with the CSV beside it. The same command with a longer design runs what is missing.
    #[arg(long, short, value_name = "FILE", required_unless_present = "example")]
    output: Option<PathBuf>,
    /// Scenes that run at the same time, each in a process of its own; the default is one per core.
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Communication step in seconds.
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    step: f64,
    /// Interpolation of the rows of the inputs: held until the next row, sampled on the line between them at the
    /// beginning of each step, or linear over each step, as `simulate` takes them.
    #[arg(long, value_enum, default_value = "linear")]
    interpolation: Reading,
    /// Outputs whose last value is kept.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "wear_depth,contact_temperature,friction_force,dissipated_energy,limit_reached"
    )]
    record: Vec<String>,
    /// Outputs whose largest value is kept.
    #[arg(long, value_delimiter = ',', default_value = "contact_temperature_max")]
    peak: Vec<String>,
    /// Seconds between the communication points that the largest values are taken from; the default is the step.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    every: Option<f64>,
    /// Run a script of examples/batch instead, with the Python package and its environment ready: what follows `--`
    /// goes to it.
    #[arg(
        long,
        value_enum,
        conflicts_with_all = ["design", "scene", "fmu", "inputs", "output", "jobs", "step", "interpolation", "record", "peak", "every"]
    )]
    example: Option<example::Script>,
    /// Arguments of the script.
    #[arg(last = true, requires = "example")]
    script_arguments: Vec<String>,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

/// [`Interpolation`] as an argument.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
enum Reading {
    Hold,
    Sample,
    Linear,
}

impl From<Reading> for Interpolation {
    fn from(reading: Reading) -> Self {
        match reading {
            Reading::Hold => Self::Hold,
            Reading::Sample => Self::Sample,
            Reading::Linear => Self::Linear,
        }
    }
}

/// Settings common to all scenes of a batch; sent to the worker processes.
#[derive(serde::Serialize, serde::Deserialize, Clone, Debug)]
struct Job {
    /// Of the unpacked FMU.
    folder: PathBuf,
    inputs: PathBuf,
    columns: Vec<String>,
    step: Text,
    interpolation: Reading,
    record: Vec<String>,
    peak: Vec<String>,
    every: Text,
}

/// A number as the shortest text that is read back as the same number, which not every reader of JSON promises.
#[derive(serde::Serialize, serde::Deserialize, Clone, Debug)]
struct Text(String);

impl From<f64> for Text {
    fn from(value: f64) -> Self {
        Self(value.to_string())
    }
}

impl Text {
    fn value(&self) -> Result<f64> {
        self.0.parse().with_context(|| format!("{:?} is no number", self.0))
    }
}

/// Summary printed with `--json`.
#[derive(serde::Serialize, Debug)]
struct Summary {
    scenes: usize,
    failed: usize,
    /// The most frequent reasons, with their numbers of scenes.
    reasons: Vec<(String, usize)>,
    ran_now: usize,
    seconds: f64,
    jobs: usize,
    output: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// Where a file cannot be read or written, a name is none of the FMU's, or no worker process can be started. Scenes
/// that fail are rows, not errors, unless all of them do.
pub fn execute(arguments: &Arguments) -> Result<()> {
    if let Some(script) = arguments.example {
        return script.run(&arguments.script_arguments, arguments.json);
    }
    let (Some(design), Some(inputs), Some(output)) = (&arguments.design, &arguments.inputs, &arguments.output) else {
        bail!("DESIGN, --inputs and --output are needed");
    };
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let jobs = arguments.jobs.unwrap_or(cores);
    if jobs == 0 {
        bail!("--jobs must be at least 1");
    }
    let parquet = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"));
    output::check_ending(Some(output), &["csv", "parquet"])?;
    // Rows are appended to a CSV file in any case, which stands beside the other.
    let rows = &if parquet { output.with_extension("csv") } else { output.clone() };
    let own = fs::canonicalize(rows).ok();
    if let Some(read) = [design, inputs].into_iter().find(|read| own.is_some() && fs::canonicalize(read).ok() == own) {
        bail!("--output {}: its rows would replace {}, which is read", output.display(), read.display());
    }
    let table = Table::read(design)?;
    let fmu = match (&arguments.fmu, &arguments.scene) {
        (Some(path), _) => fs::read(path).with_context(|| format!("reading {}", path.display()))?,
        (None, Some(scene)) => packaged(scene)?,
        (None, None) => bail!("--scene or --fmu is needed"),
    };
    let folder = unpack(&fmu).with_context(|| match &arguments.fmu {
        Some(path) => format!("unpacking {}", path.display()),
        None => "unpacking the scene's FMU".into(),
    })?;
    let worker = Worker::open(&folder)?;
    let converted = table.in_units_of(worker.description()).with_context(|| format!("reading {}", design.display()))?;
    let job = Job {
        folder,
        inputs: inputs.clone(),
        columns: converted.columns.clone(),
        step: arguments.step.into(),
        interpolation: arguments.interpolation,
        record: arguments.record.clone(),
        peak: arguments.peak.clone(),
        every: arguments.every.unwrap_or(arguments.step).into(),
    };
    check(&job, design, worker.description())?;
    drop(worker);
    let settings = format!("{:?}", (&job.step, job.interpolation, &job.record, &job.peak, &job.every));
    // Not of the rows, which are compared one by one: a longer design continues a shorter one.
    let columns = table.columns.join(",");
    let fingerprint = results::fingerprint(&[&fmu, columns.as_bytes(), &fs::read(inputs)?, settings.as_bytes()]);
    let header: Vec<String> = std::iter::once("scene".to_owned())
        .chain(table.columns.iter().chain(&job.record).cloned())
        .chain(job.peak.iter().map(|name| format!("{name}{PEAK}")))
        .chain(["status".to_owned(), "reason".to_owned()])
        .collect();
    let mut results = Results::open(rows, &header, &fingerprint, &table.rows)?;
    let pending: Vec<usize> = (0..table.rows.len()).filter(|&scene| !results.has(scene)).collect();
    let ran_now = pending.len();
    if ran_now < table.rows.len() {
        eprintln!("{} of {} scenes are there already.", table.rows.len() - ran_now, table.rows.len());
    }
    let begin = Instant::now();
    let bar = ProgressBar::with_draw_target(Some(table.rows.len() as u64), ProgressDrawTarget::stderr());
    bar.set_style(ProgressStyle::with_template("  Scenes [{bar:30}] {pos}/{len} {msg} {eta} left")?);
    bar.inc((table.rows.len() - ran_now) as u64);
    let mut failed_now = 0;
    pool::run(&job, &converted, pending, jobs, |scene, answer| {
        failed_now += usize::from(answer.status != worker::OK);
        results.add(&Row::of(scene, &table.rows[scene], answer, job.record.len() + job.peak.len()))?;
        bar.set_message(format!("{failed_now} failed"));
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    let seconds = begin.elapsed().as_secs_f64();
    let failures = results.finish()?;
    if parquet {
        python::parquet(rows, output)?;
    }
    let failed = failures.count;
    let reasons: Vec<(String, usize)> = failures.reasons.into_iter().take(REASONS).collect();
    let output = output.clone();
    let summary = Summary { scenes: table.rows.len(), failed, reasons, ran_now, seconds, jobs, output };
    if arguments.json {
        print_line!("{}", serde_json::to_string_pretty(&summary)?);
    } else {
        print_line!(
            "{} scenes, {failed} failed; {ran_now} run now by {jobs} processes in {seconds:.1} s: {}",
            summary.scenes,
            summary.output.display()
        );
        for (reason, count) in &summary.reasons {
            print_line!("  {count} x {reason}");
        }
    }
    if failed == summary.scenes {
        bail!("every one of the {failed} scenes failed; the column reason of {} says why", summary.output.display());
    }
    Ok(())
}

/// The FMU of a scene.
fn packaged(scene: &str) -> Result<Vec<u8>> {
    let file = scenes::load(Some(scene))?;
    let path = project::target().join("batch").join(format!("{}.{}.fmu", file.packaged.name, std::process::id()));
    let options = package::Options { output: Some(path.clone()), ..package::Options::default() };
    let bytes = fs::read(package::build_scene(&file, &options)?).with_context(|| format!("reading {}", path.display()));
    let _ = fs::remove_file(&path);
    bytes
}

/// Checks the settings that would fail for every scene, once and before any is run.
fn check(job: &Job, design: &Path, description: &Description) -> Result<()> {
    let inputs = Inputs::read(&job.inputs, description)?;
    let file = job.inputs.display();
    if inputs.times.len() < 2 {
        bail!("{file} has one row; a time interval needs at least two");
    }
    Schedule::new(&inputs.times, &inputs.values, inputs.names.len())?;
    for text in implausible(&inputs, description, &job.columns) {
        eprintln!("warning: {}: {text}", job.inputs.display());
    }
    for column in &job.columns {
        match column.strip_suffix(FACTOR).filter(|name| inputs.names.iter().any(|input| input == name)) {
            Some(_) => {}
            None => {
                let context = || format!("{}, line 1: the column {column}", design.display());
                if column.ends_with(FACTOR) {
                    let factors: Vec<String> = inputs.names.iter().map(|name| format!("{name}{FACTOR}")).collect();
                    bail!("{} is no factor on a column of {file}; accepted are {}", context(), factors.join(", "));
                }
                description.find_as(column, Causality::Parameter).with_context(context)?;
            }
        }
    }
    for (option, names) in [("--record", &job.record), ("--peak", &job.peak)] {
        for name in names {
            description.find(name).with_context(|| format!("{option} {name}"))?;
        }
    }
    let (step, every) = (job.step.value()?, job.every.value()?);
    if !(step.is_finite() && step > 0.0) {
        bail!("--step {step} s must be a finite number above 0 s");
    }
    let span = Span { start: inputs.start(), stop: inputs.stop(), step };
    span.steps().with_context(|| format!("--step {step} s, with the last time of {file} as the stop time"))?;
    let points = worker::points(span, every)?;
    span.indices(&points).with_context(|| format!("--every {every} s must be a multiple of --step {step} s"))?;
    Ok(())
}

/// Ratio to the nominal value above which an input is implausible: the model is not valid so far beyond it.
const FAR_BEYOND: f64 = 10.0;

/// Warnings about inputs far beyond the nominal values of the FMU, which are probably in another unit.
fn implausible(inputs: &Inputs, description: &Description, design: &[String]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (name, nominal) in [("sliding_velocity", "nominal.velocity"), ("normal_load", "nominal.load")] {
        // The design may set another.
        let own = description.find(nominal).ok().filter(|_| !design.iter().any(|column| column == nominal));
        let (Some(own), Some(at)) = (own, inputs.names.iter().position(|own| own == name)) else { continue };
        let Some(limit) = own.start.parse().ok().filter(|start| *start > 0.0).map(|start: f64| FAR_BEYOND * start)
        else {
            continue;
        };
        let largest =
            inputs.values.iter().skip(at).step_by(inputs.names.len()).fold(0.0, |most: f64, v| most.max(v.abs()));
        if largest > limit {
            let unit = &own.unit;
            warnings.push(format!(
                "{name} goes to {largest} {unit}, more than {FAR_BEYOND} times {nominal} = {} {unit}; is it in {unit}? A unit \
                 may stand in the header, as in \"sliding_velocity [km/h]\"",
                own.start
            ));
        }
    }
    warnings
}

/// Unpacks an .fmu into a folder of cargo's that is named after its content, unless that has been done.
fn unpack(fmu: &[u8]) -> Result<PathBuf> {
    let name = format!("fmu-{}", results::fingerprint(&[fmu]));
    let folder = project::target().join("batch").join(&name);
    if folder.is_dir() {
        return Ok(folder);
    }
    // Another process may be doing the same: the first one succeeds.
    let partial = folder.with_file_name(format!(".{name}.{}", std::process::id()));
    let mut archive = zip::ZipArchive::new(Cursor::new(fmu)).context("it is no .fmu, which is a zip archive")?;
    fs::create_dir_all(&partial)?;
    if let Err(broken) = archive.extract(&partial) {
        let _ = fs::remove_dir_all(&partial);
        return Err(broken.into());
    }
    if fs::rename(&partial, &folder).is_err() {
        fs::remove_dir_all(&partial)?;
        if !folder.is_dir() {
            bail!("{} cannot be made", folder.display());
        }
    }
    Ok(folder)
}
