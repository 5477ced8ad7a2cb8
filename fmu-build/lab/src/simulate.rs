//! `cargo fmu simulate`: a scene driven by given inputs, to a table, files and a figure, beside measurements.

mod write;

use crate::arguments;
use crate::columns::{self, Column, Table};
use crate::ctrl_c;
use crate::drawing;
use crate::output::{self, Interrupted, print_line, print_text};
use crate::scenes;
use analyses::simulation::quantity::rounded;
use analyses::simulation::{Figure, Summary, Trajectory, measured, run};
use anyhow::{Result, bail};
use fmu_build::progress::Progress;
use scene_file::shipped;
use std::path::{Path, PathBuf};

/// Drives the component that the FMU contains. Without --inputs: nominal load and velocity for the nominal duration, over the
/// nominal stroke where the scene has one.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file, or name of a folder in `examples`.
    scene: String,
    /// Inputs over time (CSV or Parquet): time [s], sliding_velocity [km/h], normal_load [kN], or any input by its name and a unit.
    ///
    /// Linear between the rows, each of which is a communication point; a time in two rows is a jump. An input without a column keeps the
    /// scene's start value. Outputs and other columns are left out.
    #[arg(short, long, value_name = "FILE.csv")]
    inputs: Option<PathBuf>,
    /// Give a variable of the scene another value, as punch.width="40 mm"; may be repeated.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Longest communication step in seconds, or with its unit as "20 ms".
    ///
    /// The interval between two rows is divided into equal steps. By default steps follow the inputs: 20 where one goes to 0 between two rows,
    /// then longer and longer, at most about a thousandth of the whole time; without inputs the step of the scene.
    #[arg(long, value_name = "TIME", value_parser = arguments::step, allow_negative_numbers = true)]
    step: Option<f64>,
    /// Write every input and output over time, in SI units; for a contact line also the profiles, as FILE.profiles.csv. With the ending
    /// .parquet as Parquet, with the CSV beside it.
    #[arg(short, long, value_name = "FILE.csv|.parquet")]
    output: Option<PathBuf>,
    /// Draw inputs, outputs, energy balance and, for a contact line, pressure, temperature and worn shape over the contact, as
    /// SVG, PDF or PNG by the file's ending.
    #[arg(short, long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Measured record (CSV or Parquet), drawn over the curves of the same names: time [s], contact_temperature [degC], or any input or
    /// output by its name and a unit, or as rigs write it: "Friction force [N]", "COF". May be the file of --inputs.
    ///
    /// Empty cells and NaN are gaps. Without --step its times are communication points too, of more than 1000 every second, third and so on.
    #[arg(short, long, value_name = "FILE.csv")]
    measured: Option<PathBuf>,
    #[command(flatten)]
    columns: arguments::Columns,
    /// Times of the profiles over the contact, as 0,10,"2 min"; by default the first, middle and last at which the load is at least half of
    /// its largest.
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = arguments::time, allow_negative_numbers = true)]
    at: Vec<f64>,
    /// Print JSON instead of a table: every variable's range and end, deviations, profiles.
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    let parquet = arguments.output.as_deref().filter(|path| output::ends_with(path, "parquet"));
    output::check_ending(arguments.output.as_deref(), &["csv", "parquet"])?;
    // The table of a Parquet file is that of the CSV beside it.
    let table =
        arguments.output.as_ref().map(|path| if parquet.is_some() { path.with_extension("csv") } else { path.clone() });
    if let Some(plot) = &arguments.plot {
        drawing::format("--plot", plot)?;
    }
    let profiles = table.as_deref().map(write::beside);
    let written =
        [("--output", &table), ("--output", &profiles), ("--output", &arguments.output), ("--plot", &arguments.plot)];
    for (option, path) in written {
        let Some(path) = path else { continue };
        output::check_file(option, path)?;
        refuse_to_replace(option, path, arguments)?;
    }
    let file = scenes::changed(Some(&arguments.scene), &arguments.set)?;
    let packaged = &file.packaged;
    let (inputs, record) = read(arguments)?;
    let mut trajectory = Trajectory::new(&file, inputs, arguments.step)?;
    if let Some(record) = record.as_ref().filter(|_| arguments.step.is_none()) {
        trajectory.observe(record);
    }
    let (first, last) = trajectory.span();
    let mut progress = Progress::default();
    let recording = ctrl_c::attended(|| {
        run(&file, &trajectory, &arguments.at, &mut |time| {
            progress.reached((time - first) / (last - first), || format!("{} s of {last} s", rounded(time)));
        })
    });
    drop(progress);
    let recording = recording?;
    shipped::doubts(&file).iter().for_each(|text| eprintln!("warning: {text}"));
    let mut files = Vec::new();
    if let Some(path) = table.as_deref().filter(|_| !recording.times.is_empty()) {
        output::make_above(path)?;
        write::courses(path, &recording)?;
        if let Some(parquet) = parquet {
            crate::parquet::write(path, parquet)?;
            files.push(parquet.display().to_string());
        }
        files.push(path.display().to_string());
        if !recording.profiles.is_empty() {
            let profiles = write::beside(path);
            write::profiles(&profiles, &recording)?;
            files.push(profiles.display().to_string());
        }
    }
    if let Some(reason) = &recording.failure {
        let kept = files.first().map_or(String::new(), |file| format!("; the rows before it are in {file}"));
        bail!("the scene {}: {reason}{kept}", packaged.name);
    }
    if recording.interrupted {
        let reached = recording.times.last().copied().unwrap_or(first);
        let kept = files
            .first()
            .map_or("; --output keeps the rows".into(), |file| format!("; the rows up to there are in {file}"));
        bail!(Interrupted(format!("interrupted at {} s of {last} s{kept}", rounded(reached))));
    }
    let deviations = match &record {
        Some(record) => measured::compare(record, &recording)?,
        None => Vec::new(),
    };
    if let Some(path) = &arguments.plot {
        let figure = Figure::new(&packaged.name, &recording, &deviations);
        drawing::write("simulation", &figure, "--plot", path)?;
        files.push(path.display().to_string());
    }
    let summary = Summary {
        scene: &packaged.name,
        inputs: &trajectory.description,
        recording: &recording,
        measured: &deviations,
        files: &files,
    };
    if arguments.json {
        print_line!("{:#}", summary.record());
    } else {
        print_text!("{}", summary.table());
    }
    Ok(())
}

/// Inputs and record, which may be one file.
fn read(arguments: &Arguments) -> Result<(Option<Table>, Option<Table>)> {
    let reading = arguments.columns.reading();
    let accepted = [Column::inputs(), vec![Column::trip()]].concat();
    let inputs = arguments.inputs.as_deref().map(|path| columns::read(path, &accepted, &reading)).transpose()?;
    let record = arguments.measured.as_deref().map(|path| measured::read(path, &reading)).transpose()?;
    let tables: Vec<&Table> = inputs.iter().chain(&record).collect();
    reading.check(&tables.iter().map(|table| &table.headers[..]).collect::<Vec<_>>())?;
    let notes: Vec<&String> = tables.iter().flat_map(|table| &table.notes).collect();
    let first = |at: usize| !notes[..at].contains(&notes[at]);
    (0..notes.len()).filter(|at| first(*at)).for_each(|at| eprintln!("note: {}", notes[at]));
    let record = record.map(|record| measured::beside(&record, inputs.as_ref())).transpose()?;
    Ok((inputs, record))
}

/// Refuses to write over a file that is read.
fn refuse_to_replace(option: &str, path: &Path, arguments: &Arguments) -> Result<()> {
    let scene = scenes::locate(&arguments.scene).ok();
    for read in [&arguments.inputs, &arguments.measured, &scene].into_iter().flatten() {
        if output::would_replace(path, read) {
            bail!("{option} {} would replace a file that is read", path.display());
        }
    }
    Ok(())
}
