//! `cargo fmu batch`: many scenes with one FMU, natively; one row of results for each.

pub(crate) mod example;
mod percentiles;
mod pool;
mod results;
mod tables;
mod timeline;
mod unpacked;
pub mod worker;

pub use tables::{Inputs, Table};
pub use timeline::points;

use crate::columns;
use crate::output::{self, print_line};
use crate::progress::Progress;
use crate::{arguments, package, parquet, project, scenes};
use anyhow::{Context, Result, anyhow, bail};
use fmu_host::{Causality, Description, Failure, Interpolation, Worker};
use percentiles::{Percentiles, percentiles};
use results::{Identity, Results, Row};
use scene::message::Clipped;
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::time::Instant;
use timeline::Timeline;
use unpacked::Unpacked;

/// Reasons of failures that are printed.
const REASONS: usize = 10;
/// Ending of a column that multiplies an input's column of the schedule.
const FACTOR: &str = ".factor";
/// Beginning of the columns of nominal conditions.
const NOMINAL: &str = "nominal.";
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
    #[arg(long, value_name = "FILE")]
    fmu: Option<PathBuf>,
    /// CSV file with the inputs over time: the column time, and one per input with its unit, as in "sliding_velocity [km/h]". Without it every scene runs at its nominal load and velocity for its nominal
    /// duration, over the nominal stroke where it has one.
    #[arg(long, value_name = "FILE")]
    inputs: Option<PathBuf>,
    #[command(flatten)]
    columns: arguments::Columns,
    /// File of results, in SI units: CSV, or Parquet with the CSV beside it. The same command with a longer design runs what is
    /// missing; results of another batch, or of rows that the design no longer has, are not replaced without --replace.
    #[arg(long, short, value_name = "FILE", required_unless_present = "example")]
    output: Option<PathBuf>,
    /// Replace the results of another batch, and of rows that the design no longer has.
    #[arg(long)]
    replace: bool,
    /// Scenes that run at the same time, each in a process of its own; the default is one per core.
    #[arg(long, value_name = "N", value_parser = arguments::whole::<usize>(1..=1024), allow_negative_numbers = true)]
    jobs: Option<usize>,
    /// Communication step in seconds, or with its unit as "20 ms". By default as short as the changes between the rows of the inputs
    /// need, at most about a thousandth of their time; without --inputs that of the scene.
    #[arg(long, value_name = "TIME", value_parser = arguments::time, allow_negative_numbers = true)]
    step: Option<f64>,
    /// Interpolation of the rows of the inputs: held until the next row, sampled on the line between them at the
    /// beginning of each step, or linear over each step, as `simulate` takes them.
    #[arg(long, value_enum, default_value = "linear")]
    interpolation: Reading,
    /// Outputs whose last value is kept.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "wear_depth,wear_depth_punch,wear_depth_strip,contact_temperature,friction_force,dissipated_energy,limit_reached"
    )]
    record: Vec<String>,
    /// Outputs whose largest value is kept.
    #[arg(long, value_delimiter = ',', default_value = "contact_temperature_max")]
    peak: Vec<String>,
    /// Time between the communication points that the largest values are taken from; the default is the step.
    #[arg(long, value_name = "TIME", value_parser = arguments::time, allow_negative_numbers = true)]
    every: Option<f64>,
    /// Run a script of examples/batch instead, with the Python package and its environment ready: what follows `--`
    /// goes to it.
    #[arg(
        long,
        value_enum,
        conflicts_with_all = ["design", "scene", "fmu", "inputs", "column", "strict", "output", "replace", "jobs", "step", "interpolation", "record", "peak", "every"]
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
    /// `None`: nominal inputs.
    inputs: Option<PathBuf>,
    /// Columns of the inputs named by the user.
    named: Vec<String>,
    strict: bool,
    columns: Vec<String>,
    /// `None`: as [`Timeline`] chooses it.
    step: Option<Text>,
    interpolation: Reading,
    record: Vec<String>,
    peak: Vec<String>,
    /// `None`: the step.
    every: Option<Text>,
}

impl Job {
    fn reading(&self) -> Result<columns::Reading> {
        let named = self.named.iter().map(|text| text.parse().map_err(|wrong: String| anyhow!(wrong)));
        Ok(columns::Reading { columns: named.collect::<Result<_>>()?, strict: self.strict, python: false })
    }
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
    /// The most frequent reasons.
    reasons: Vec<results::Reason>,
    percentiles: Vec<Percentiles>,
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
    if let Some(example::Script::Sweep) = arguments.example {
        return example::run("sweep.py", &["disc_brake"], &arguments.script_arguments, arguments.json);
    }
    let (Some(design), Some(output)) = (&arguments.design, &arguments.output) else {
        bail!("DESIGN and --output are needed");
    };
    let inputs = arguments.inputs.as_ref();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let jobs = arguments.jobs.unwrap_or(cores);
    let as_parquet = output::ends_with(output, "parquet");
    output::check_ending(Some(output), &["csv", "parquet"])?;
    // Rows are appended to a CSV file in any case, which stands beside the other.
    let rows = &if as_parquet { output.with_extension("csv") } else { output.clone() };
    if let Some(read) = [Some(design), inputs].into_iter().flatten().find(|read| output::would_replace(rows, read)) {
        bail!("--output {}: its rows would replace {}, which is read", output.display(), read.display());
    }
    if output::ends_with(design, "toml") {
        bail!("{} is a scene file; --scene takes it, and DESIGN is a table of what its rows vary", design.display());
    }
    let table = Table::read(design)?;
    let fmu = match (&arguments.fmu, &arguments.scene) {
        (Some(path), _) if output::ends_with(path, "toml") => {
            bail!("{} is a scene file; --scene takes it", path.display())
        }
        (Some(path), _) => fs::read(path).with_context(|| format!("reading {}", path.display()))?,
        (None, Some(scene)) => packaged(scene)?,
        (None, None) => bail!("--scene, or --fmu, is needed: what the rows of {} vary", design.display()),
    };
    let unpacked = Unpacked::new(Cursor::new(&fmu)).with_context(|| match &arguments.fmu {
        Some(path) => format!("unpacking {}", path.display()),
        None => "unpacking the scene's FMU".into(),
    })?;
    let worker = Worker::open(&unpacked.folder)?;
    let reading = arguments.columns.reading();
    let converted = table.for_fmu(worker.description())?;
    let job = Job {
        folder: unpacked.folder.clone(),
        inputs: inputs.cloned(),
        named: reading.columns.iter().map(ToString::to_string).collect(),
        strict: reading.strict,
        columns: converted.columns.clone(),
        step: arguments.step.map(Text::from),
        interpolation: arguments.interpolation,
        record: arguments.record.clone(),
        peak: arguments.peak.clone(),
        every: arguments.every.map(Text::from),
    };
    check(&job, &table, worker.description())?;
    let header = header(&job, &table, worker.description())?;
    let description = worker.description().clone();
    drop(worker);
    let inputs = inputs.map(fs::read).transpose()?;
    let recorded = format!("{:?}", (&job.record, &job.peak));
    let steps = format!("{:?}", (&job.step, job.interpolation, &job.every));
    // Not of the rows, which are compared one by one: a longer design continues a shorter one.
    let identity = Identity::of(&[
        ("scene", &fmu),
        ("columns", table.columns.join(",").as_bytes()),
        ("inputs", &[inputs.unwrap_or_default(), job.named.join(",").into_bytes()].concat()),
        ("outputs", recorded.as_bytes()),
        ("steps", steps.as_bytes()),
    ]);
    let mut results = Results::open(rows, &header, &identity, &table.rows, arguments.replace)?;
    let pending: Vec<usize> = (0..table.rows.len()).filter(|&scene| !results.has(scene)).collect();
    let ran_now = pending.len();
    if ran_now < table.rows.len() {
        eprintln!("{} of {} scenes are there already.", table.rows.len() - ran_now, table.rows.len());
    }
    project::end_at_ctrl_c("the finished scenes are kept, and the same command goes on from there")?;
    let begin = Instant::now();
    let mut progress = Progress::default();
    let (mut failed_now, mut done, count) = (0, table.rows.len() - ran_now, table.rows.len());
    pool::run(&job, &converted.rows, pending, jobs, |scene, answer| {
        failed_now += usize::from(answer.status != worker::OK);
        results.add(&Row::of(scene, &table.rows[scene], answer, job.record.len() + job.peak.len()))?;
        done += 1;
        progress.reached(done as f64 / count as f64, || {
            format!(
                "{done} of {count} scenes, {failed_now} failed; ended with Ctrl-C, the same command goes on from here"
            )
        });
        Ok(())
    })?;
    drop(progress);
    let seconds = begin.elapsed().as_secs_f64();
    let width = job.record.len() + job.peak.len();
    let first = header.len() - 2 - width;
    let start = |name: &str| description.find(name).ok().and_then(|own| own.start.parse().ok()).unwrap_or(0.0);
    let columns = &header[1..];
    let percentiles = percentiles(columns, first - 1..first - 1 + width, start, results.rows());
    let failures = results.finish()?;
    if as_parquet {
        parquet::write(rows, output)?;
    }
    let failed = failures.count;
    let reasons: Vec<results::Reason> = failures.reasons.into_iter().take(REASONS).collect();
    let output = output.clone();
    let summary = Summary { scenes: table.rows.len(), failed, reasons, percentiles, ran_now, seconds, jobs, output };
    if arguments.json {
        print_line!("{}", serde_json::to_string_pretty(&summary)?);
    } else {
        print_line!(
            "{}, {failed} failed; {ran_now} run now by {jobs} processes in {seconds:.1} s: {}",
            output::counted(summary.scenes, "scene"),
            summary.output.display()
        );
        if summary.scenes - failed > 1 {
            print_line!("{}", percentiles::table(&summary.percentiles));
        }
        for results::Reason { reason, scenes, first } in &summary.reasons {
            print_line!("  {scenes} x {reason} (first in scene {first})");
        }
    }
    if failed == summary.scenes {
        bail!("{} failed; the column reason of {} says why", all(failed), summary.output.display());
    }
    Ok(())
}

fn packaged(scene: &str) -> Result<Vec<u8>> {
    let file = scenes::load(Some(scene))?;
    let path = project::target().join("batch").join(format!("{}.{}.fmu", file.packaged.name, std::process::id()));
    let options = package::Options { output: Some(path.clone()), ..package::Options::default() };
    let bytes = fs::read(package::build_scene(&file, &options)?).with_context(|| format!("reading {}", path.display()));
    let _ = fs::remove_file(&path);
    bytes
}

/// Subject of a message about every scene.
fn all(scenes: usize) -> String {
    if scenes == 1 { "the only scene".to_owned() } else { format!("every one of the {scenes} scenes") }
}

/// Header of the results: the design's own columns as they are, outputs with their units.
fn header(job: &Job, table: &Table, description: &Description) -> Result<Vec<String>> {
    let with_unit = |name: &str, shown: String| -> Result<String> {
        let unit = &description.find(name)?.unit;
        Ok(if unit.is_empty() || unit == "1" { shown } else { format!("{shown} [{unit}]") })
    };
    let last = job.record.iter().map(|name| with_unit(name, name.clone()));
    let largest = job.peak.iter().map(|name| with_unit(name, format!("{name}{PEAK}")));
    let outputs: Vec<String> = last.chain(largest).collect::<Result<_>>()?;
    let ends = ["status", "reason"].map(str::to_owned);
    Ok(std::iter::once("scene".to_owned()).chain(table.columns.iter().cloned()).chain(outputs).chain(ends).collect())
}

/// Checks the settings that would fail for every scene, once and before any is run.
fn check(job: &Job, table: &Table, description: &Description) -> Result<()> {
    let Timeline { inputs, .. } = Timeline::new(job, description, &[])?;
    inputs.notes.iter().for_each(|note| eprintln!("note: {note}"));
    for text in implausible(&inputs, description, &job.columns).into_iter().chain(lifted(&inputs)).chain(idle(
        &inputs,
        description,
        &job.columns,
    )) {
        eprintln!("warning: {}: {text}", inputs.source);
    }
    let factors = || inputs.names.iter().map(|name| format!("{name}{FACTOR}")).collect::<Vec<_>>().join(", ");
    for (at, (column, header)) in job.columns.iter().zip(&table.columns).enumerate() {
        let place = || format!("{} ({})", table.place(at), Clipped(header));
        let input = column.strip_suffix(FACTOR).unwrap_or(column);
        let is_driven = inputs.names.iter().any(|name| name == input);
        if is_driven && input != column {
            continue;
        }
        if column.ends_with(FACTOR) || description.find_as(column, Causality::Input).is_ok() {
            let fault = if column.ends_with(FACTOR) { "no factor on a column" } else { "an input, which is that" };
            bail!("{} is {fault} of {}; accepted are {}", place(), inputs.source, factors());
        }
        if column == "time" {
            bail!("{}: a design has a row per scene; --inputs takes a file of inputs over time", place());
        }
        if let Err(Failure { reason, .. }) = description.find_as(column, Causality::Parameter) {
            bail!(
                "{}: {reason}; accepted are parameters of the FMU (`cargo fmu reference` lists them) and {}",
                place(),
                factors()
            );
        }
        if let Some(reason) = replaced(column, description, &job.columns) {
            bail!("{}: {reason}", place());
        }
        let driven = match column.as_str() {
            "nominal.load" => "normal_load",
            "nominal.velocity" => "sliding_velocity",
            _ => continue,
        };
        if job.inputs.is_some() && inputs.names.iter().any(|name| name == driven) {
            eprintln!(
                "warning: {}: {column} changes how levels are chosen, and not the inputs of {}; {driven}{FACTOR} multiplies them",
                table.place(at),
                inputs.source
            );
        }
    }
    for (option, names) in [("--record", &job.record), ("--peak", &job.peak)] {
        for name in names {
            let variable =
                description.find(name).map_err(|Failure { reason, .. }| anyhow!("{option} {name}: {reason}"))?;
            if variable.causality == Causality::Parameter {
                bail!(
                    "{option} {name} is a parameter, which keeps its value in a run; accepted are outputs, as wear_depth"
                );
            }
        }
    }
    Ok(())
}

/// Warning about loads that lift.
fn lifted(inputs: &Inputs) -> Option<String> {
    let at = inputs.names.iter().position(|name| name == "normal_load")?;
    let loads = inputs.values.iter().skip(at).step_by(inputs.names.len());
    let (time, load) = inputs.times.iter().zip(loads).find(|(_, load)| **load < 0.0)?;
    Some(format!("normal_load = {load} N at {time} s is below 0 N and counts as 0: the contact is open"))
}

/// Warning about a rotation that moves nothing.
fn idle(inputs: &Inputs, description: &Description, design: &[String]) -> Option<String> {
    const RADIUS: &str = "contact.mean_radius";
    let at = inputs.names.iter().position(|name| name == "angular_velocity")?;
    let is_zero = description.find(RADIUS).is_ok_and(|radius| radius.start.parse() == Ok(0.0));
    let turns = inputs.values.iter().skip(at).step_by(inputs.names.len()).any(|velocity| *velocity != 0.0);
    (turns && is_zero && !design.iter().any(|column| column == RADIUS))
        .then(|| format!("angular_velocity has no effect: {RADIUS} = 0 m"))
}

/// Why a column of constants has no effect: the table that replaces them.
fn replaced(column: &str, description: &Description, design: &[String]) -> Option<String> {
    let (body, "conductivity" | "specific_heat") = column.split_once('.')? else { return None };
    let points = format!("{body}.property_table.points");
    let given = &description.find(&points).ok()?.start;
    (given != "0" && !design.contains(&points))
        .then(|| format!("it has no effect while {points} = {given}; give a column {points} of 0 with it"))
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
                "{name} goes to {largest} {unit}, more than {FAR_BEYOND} times {nominal} = {} {unit}; is the unit of its header the right one?",
                own.start
            ));
        }
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of an FMU with one parameter.
    fn description(name: &str, start: &str) -> Description {
        let text = format!(
            "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"a\" guid=\"b\"><CoSimulation modelIdentifier=\"c\"/>\
             <ModelVariables><ScalarVariable name=\"{name}\" valueReference=\"1\" causality=\"parameter\"><Real start=\"{start}\"/>\
             </ScalarVariable></ModelVariables></fmiModelDescription>"
        );
        Description::parse(&text).unwrap()
    }

    #[test]
    fn a_column_that_a_table_replaces_is_refused() {
        const POINTS: &str = "strip.property_table.points";
        let told = |column, start, design: &[&str]| {
            let design: Vec<String> = design.iter().map(|name| (*name).to_owned()).collect();
            replaced(column, &description(POINTS, start), &design)
        };
        let reason = told("strip.conductivity", "7", &["strip.conductivity"]).unwrap();
        assert!(
            reason.contains("strip.property_table.points = 7; give a column strip.property_table.points"),
            "{reason}"
        );
        assert!(told("strip.specific_heat", "7", &[]).is_some());
        assert_eq!(told("strip.conductivity", "7", &["strip.conductivity", POINTS]), None);
        assert_eq!(told("strip.conductivity", "0", &[]), None);
        assert_eq!(told("punch.conductivity", "7", &[]), None);
        assert_eq!(told("strip.density", "7", &[]), None);
    }

    #[test]
    fn a_rotation_that_moves_nothing_is_told() {
        let description = |radius: &str| description("contact.mean_radius", radius);
        let inputs = |velocity: f64| Inputs {
            source: "in.csv".into(),
            names: vec!["normal_load".into(), "angular_velocity".into()],
            times: vec![0.0, 1.0],
            values: vec![1e3, 0.0, 1e3, velocity],
            notes: Vec::new(),
        };
        let told = idle(&inputs(3.0), &description("0.0"), &[]);
        assert_eq!(told.as_deref(), Some("angular_velocity has no effect: contact.mean_radius = 0 m"));
        assert_eq!(idle(&inputs(0.0), &description("0"), &[]), None);
        assert_eq!(idle(&inputs(3.0), &description("0.1"), &[]), None);
        assert_eq!(idle(&inputs(3.0), &description("0"), &["contact.mean_radius".to_owned()]), None);
    }
}
