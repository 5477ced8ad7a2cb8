//! Requests, and how each is answered.

use crate::{Answer, Control, Status, c_text};
use analyses::convergence::Convergence;
use analyses::simulation::{Channel, Figure, Recording, Summary, Trajectory, energy_residual, measured, run};
use analyses::{cycles, plan, steady};
use anyhow::{Context, Result, anyhow, bail};
use numerics::interruption::checkpoint;
use scene::variables::units::{ONE, SECOND, Unit};
use scene::variables::{Causality, Kind, Row, TABLE, ValueReference, lookup};
use scene_file::columns::{self, Column, Reading, Table};
use scene_file::records::{Records, Tests};
use scene_file::{SceneFile, nearest, quantity, shipped};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::fs;
use std::path::PathBuf;

/// A scene as it is named and changed.
#[derive(Deserialize)]
pub(crate) struct Selection {
    /// Name of a shipped scene or path of a file; `None`: the stock scene.
    scene: Option<String>,
    /// Folder of the shipped scenes.
    scenes: PathBuf,
    /// Assignments, `key=value` each.
    set: Vec<String>,
}

impl Selection {
    fn load(&self) -> Result<SceneFile> {
        let mut file = shipped::load(self.scene.as_deref(), &self.scenes)?;
        scene_file::assign_all(&mut file, &self.set)?;
        Ok(file)
    }
}

/// A file of quantities over time, or the content of one with the name that messages call it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The file, or what messages call the text.
    path: PathBuf,
    text: Option<String>,
    /// `HEADER=VARIABLE` each.
    columns: Vec<String>,
    strict: bool,
}

impl Source {
    fn reading(&self) -> Result<Reading> {
        let named = |column: &String| column.parse().map_err(|wrong| anyhow!("columns: {column:?} {wrong}"));
        let columns = self.columns.iter().map(named).collect::<Result<_>>()?;
        Ok(Reading { columns, strict: self.strict, python: true })
    }

    fn inputs(&self) -> Result<Table> {
        let reading = self.reading()?;
        let table = match &self.text {
            None => columns::read(&self.path, &Column::inputs(), &reading),
            Some(text) => columns::parse(text.as_bytes(), &self.path, &Column::inputs(), &reading),
        };
        Ok(with_missing(table?, &reading))
    }

    fn measured(&self) -> Result<Table> {
        let reading = self.reading()?;
        let table = match &self.text {
            None => measured::read(&self.path, &reading),
            Some(text) => measured::parse(text, &self.path, &reading),
        };
        Ok(with_missing(table?, &reading))
    }

    /// A record without the inputs that were driven; who is refused one has not seen its notes.
    fn beside(&self, inputs: Option<&Table>) -> Result<Table> {
        let table = self.measured()?;
        measured::beside(&table, inputs).map_err(|wrong| {
            let notes: String = table.notes.iter().map(|note| format!("; {note}")).collect();
            anyhow!("{wrong}{notes}")
        })
    }

    fn tests(&self) -> Result<Tests> {
        let reading = self.reading()?;
        match &self.text {
            None => Tests::read(&self.path, &reading),
            Some(text) => Tests::parse(text.as_bytes(), &self.path, &reading),
        }
    }
}

/// With a note where a named column is not there: it may be in another file that is read with the same names.
fn with_missing(mut table: Table, reading: &Reading) -> Table {
    let missing = reading.check(&[&table.headers]).err();
    table.notes.extend(missing.map(|wrong| format!("{}: {wrong}", table.path.display())));
    table
}

/// What was made of headers that are no names of quantities.
fn notes_of(table: Option<&Table>) -> Vec<String> {
    table.map_or_else(Vec::new, |table| table.notes.clone())
}

/// A request by the name of its analysis.
#[derive(Deserialize)]
#[serde(tag = "analysis", rename_all = "lowercase", deny_unknown_fields)]
pub enum Request {
    /// Names of the shipped scenes.
    Names {
        scenes: PathBuf,
    },
    /// Values, units and warnings of a scene.
    Scene {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
    },
    /// A variable's values in another unit: SI value = zero + slope * value.
    Unit {
        name: String,
        unit: String,
    },
    /// Records of tests in SI units: end values, or a history with times and values of every output as arrays.
    Records {
        records: Source,
    },
    /// The SI value of a text with a unit, as `80 km/h`; of a difference without the zero of units that have one.
    Quantity {
        name: String,
        text: String,
        difference: bool,
    },
    /// The names that one may be a slip of, as the end of a message.
    Nearest {
        name: String,
        names: Vec<String>,
    },
    /// A number beside that on half the cells, less `offset`.
    Convergence {
        value: f64,
        cells: usize,
        coarser: f64,
        coarser_cells: usize,
        offset: f64,
        scale: f64,
    },
    /// Inputs over time as a simulation takes them, by default nominal: times, then every input.
    Trajectory {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        inputs: Option<Source>,
    },
    Simulate {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        inputs: Option<Source>,
        /// A record that the run stands beside.
        measured: Option<Source>,
        step: Option<f64>,
        at: Vec<f64>,
    },
    /// Deviations of a run from a measured record.
    Compare {
        measured: Source,
    },
    /// The figure of a run beside a measured record.
    Figure {
        measured: Option<Source>,
    },
    Steady {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        cells: Option<u16>,
        return_speed: Option<f64>,
        cold: bool,
    },
    Cycles {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        cycles: f64,
        tolerance: f64,
        cells: Option<u16>,
        cold: bool,
    },
    Plan {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        inputs: Option<Source>,
        tolerance: Option<f64>,
    },
    /// Writes the FMU of a scene, made from an FMU of any other; its reference runs from `folder`, which is removed.
    Package {
        scene: Option<String>,
        scenes: PathBuf,
        set: Vec<String>,
        packaged: PathBuf,
        folder: PathBuf,
        output: PathBuf,
    },
}

/// A run that figures and comparisons follow from.
pub struct Run {
    scene: String,
    /// What it was driven by.
    inputs: Option<Table>,
    recording: Recording,
}

impl Request {
    /// Does what is requested; `run`: the simulation that it follows from; `control` learns the part that is done.
    ///
    /// # Errors
    /// As the analyses.
    pub fn answer(self, run: Option<&Run>, control: &Control) -> Result<Answer> {
        let run = || run.context("no simulation is given");
        let mut status = Status::Success;
        let mut ended = |interrupted: bool| {
            if interrupted {
                status = Status::Stopped;
            }
        };
        let value = match self {
            Self::Names { scenes } => json!(shipped::names(&scenes)),
            Self::Unit { name, unit } => conversion(&name, &unit)?,
            Self::Records { records } => return tests(&records),
            Self::Quantity { name, text, difference } => {
                let (unit, absolute) = unit_of(&name)?;
                let value = quantity::text(&text, unit, absolute && !difference);
                json!(value.map_err(|wrong| anyhow!("{name}: {wrong}"))?)
            }
            Self::Nearest { name, names } => json!(nearest(&name, names.iter().map(String::as_str))),
            Self::Convergence { value, cells, coarser, coarser_cells, offset, scale } => {
                json!(Convergence { value, cells, coarser, coarser_cells }.text(offset, scale))
            }
            Self::Trajectory { scene, scenes, set, inputs } => {
                let file = Selection { scene, scenes, set }.load()?;
                let table = inputs.as_ref().map(Source::inputs).transpose()?;
                let notes = notes_of(table.as_ref());
                return Ok(inputs_over_time(Trajectory::new(&file, table, None)?, &notes));
            }
            Self::Compare { measured } => {
                let Run { inputs, recording, .. } = run()?;
                let table = measured.beside(inputs.as_ref())?;
                json!({ "deviations": measured::compare(&table, recording)?, "notes": table.notes })
            }
            Self::Figure { measured } => {
                let Run { scene, inputs, recording } = run()?;
                let table = measured.as_ref().map(|own| own.beside(inputs.as_ref())).transpose()?;
                let deviations = table.as_ref().map(|table| measured::compare(table, recording)).transpose()?;
                let figure = Figure::new(scene, recording, &deviations.unwrap_or_default());
                json!({ "content": figure, "notes": notes_of(table.as_ref()) })
            }
            Self::Scene { scene, scenes, set } => described(&Selection { scene, scenes, set }.load()?)?,
            Self::Simulate { scene, scenes, set, inputs, measured, step, at } => {
                let file = Selection { scene, scenes, set }.load()?;
                return simulate(&file, [inputs.as_ref(), measured.as_ref()], step, &at, control);
            }
            Self::Steady { scene, scenes, set, cells, return_speed, cold } => {
                let file = Selection { scene, scenes, set }.load()?;
                let solved = steady::solve(&file, &steady::Options { cells, return_speed, cold })?;
                solved.check()?;
                let warnings: Vec<String> =
                    shipped::warnings(&file).into_iter().chain(steady::heat::warnings(&solved)).collect();
                with_text(solved.record(), solved.table(), &warnings)
            }
            Self::Cycles { scene, scenes, set, cycles, tolerance, cells, cold } => {
                let file = Selection { scene, scenes, set }.load()?;
                let options = cycles::Options { cycles, tolerance, cells, cold };
                let course = cycles::advance(&file, &options, &mut |passed, _| {
                    control.reached((1.0 + passed).ln() / (1.0 + cycles).ln());
                })?;
                ended(course.interrupted);
                let warnings: Vec<String> =
                    shipped::warnings(&file).into_iter().chain(course.warning.clone()).collect();
                with_text(course.record(), course.table(), &warnings)
            }
            Self::Plan { scene, scenes, set, inputs, tolerance } => {
                let file = Selection { scene, scenes, set }.load()?;
                let inputs = inputs.as_ref().map(Source::inputs).transpose()?;
                let notes = notes_of(inputs.as_ref());
                let (mut record, table) = match inputs {
                    None => {
                        let plan = plan::choose(&file, tolerance)?;
                        (plan.record(), plan.table())
                    }
                    Some(inputs) => {
                        let tolerance = plan::inputs::tolerance(&file, tolerance)?;
                        let trajectory = Trajectory::new(&file, Some(inputs), None)?;
                        let count = plan::inputs::LEVELS.len() as f64 + 1.0;
                        let levels = plan::inputs::compare(&file, &trajectory, tolerance, &mut |number, part| {
                            control.reached((number as f64 + part) / count);
                        })?;
                        ended(levels.interrupted);
                        let mut record = plan::inputs::record(&levels);
                        record["unmet"] = match levels.cheapest() {
                            Err(unmet) if !levels.interrupted => json!(unmet.to_string()),
                            _ => Value::Null,
                        };
                        (record, levels.table(&file.packaged.name, &trajectory))
                    }
                };
                record["notes"] = json!(notes);
                with_text(record, table, &shipped::warnings(&file))
            }
            Self::Package { scene, scenes, set, packaged, folder, output } => {
                let file = Selection { scene, scenes, set }.load()?;
                let shipped = fs::read(&packaged).with_context(|| format!("reading {}", packaged.display()))?;
                let fmu = fmu_file::of_scene(&shipped, &file, &folder)
                    .with_context(|| format!("the scene {}", file.packaged.name))?;
                fs::write(&output, fmu).with_context(|| format!("writing {}", output.display()))?;
                json!(file.packaged.name)
            }
        };
        Ok(Answer { status, text: c_text(&value.to_string()), arrays: Vec::new(), run: None })
    }
}

/// With the table that the command line prints.
fn with_text(mut record: Value, table: String, warnings: &[String]) -> Value {
    record["table"] = json!(table);
    with_warnings(record, warnings)
}

fn with_warnings(mut record: Value, warnings: &[String]) -> Value {
    record["scene_warnings"] = json!(warnings);
    record
}

/// End values of tests, or a history: what has a time is one.
fn tests(source: &Source) -> Result<Answer> {
    let success = |record: &Value, arrays| {
        Ok(Answer { status: Status::Success, text: c_text(&record.to_string()), arrays, run: None })
    };
    let history = match source.tests()? {
        Tests::History(table) => table,
        Tests::EndValues(Records { load, speed, distance, values, notes, .. }) => {
            // JSON has no NaN.
            let gaps = |values: Vec<f64>| -> Vec<Option<f64>> {
                values.into_iter().map(|value| value.is_finite().then_some(value)).collect()
            };
            let values: Map<String, Value> =
                values.into_iter().map(|(name, values)| (name, json!(gaps(values)))).collect();
            let record =
                json!({ "load": load, "speed": speed, "distance": distance, "values": values, "notes": notes });
            return success(&record, Vec::new());
        }
    };
    let is_output = |name: &&String| row_of(name).is_ok_and(|row| row.causality != Causality::Input);
    let outputs: Vec<&String> = history.names.iter().filter(is_output).collect();
    let points = outputs.iter().filter_map(|name| history.points(name));
    let arrays = points.flat_map(|points| <[Vec<f64>; 2]>::from(points.into_iter().unzip())).collect();
    let name = history.path.file_stem().unwrap_or(history.path.as_os_str()).to_string_lossy();
    success(&json!({ "outputs": outputs, "notes": history.notes, "name": name }), arrays)
}

/// A simulation: summary, and as arrays the times, every variable, and the profiles: times, positions, then pressure, temperature and
/// both worn depths, row by row.
fn simulate(
    file: &SceneFile,
    [inputs, measured]: [Option<&Source>; 2],
    step: Option<f64>,
    at: &[f64],
    control: &Control,
) -> Result<Answer> {
    if let Some(step) = step.filter(|step| !(step.is_finite() && *step > 0.0)) {
        bail!("step = {step} s must be above 0 s");
    }
    let name = &file.packaged.name;
    let table = inputs.map(Source::inputs).transpose()?;
    let beside = measured.map(|own| own.beside(table.as_ref())).transpose()?;
    let mut notes = notes_of(table.as_ref());
    let of_record = notes_of(beside.as_ref()).into_iter().filter(|note| !notes.contains(note));
    notes.extend(of_record.collect::<Vec<_>>());
    let mut trajectory = Trajectory::new(file, table.clone(), step)?;
    if let Some(record) = beside.as_ref().filter(|_| step.is_none()) {
        trajectory.observe(record);
    }
    let (first, last) = trajectory.span();
    let recording = run(file, &trajectory, at, &mut |time| control.reached((time - first) / (last - first)))?;
    let failure = recording.failure.as_ref().map(|reason| format!("the scene {name}: {reason}"));
    if let Some(reason) = failure.as_ref().filter(|_| recording.times.is_empty()) {
        bail!("{reason}");
    }
    if recording.times.is_empty() {
        checkpoint();
    }
    let is_whole = failure.is_none() && !recording.interrupted;
    let deviations = match beside.filter(|_| is_whole) {
        Some(record) => measured::compare(&record, &recording)?,
        None => Vec::new(),
    };
    let summary = Summary {
        scene: name,
        inputs: &trajectory.description,
        recording: &recording,
        measured: &deviations,
        files: &[],
    };
    let mut record = with_warnings(summary.record(), &shipped::warnings(file));
    let channel = |channel: &Channel| json!({ "name": channel.name, "unit": channel.unit });
    record["channels"] = recording.channels.iter().map(channel).collect();
    record["table"] = json!(summary.table());
    record["energy_residual"] = json!(energy_residual(&recording));
    record["failure"] = json!(failure);
    record["notes"] = json!(notes);
    record["last"] = json!(last);
    record["profiles"] = Value::Null;
    let mut arrays = vec![recording.times.clone()];
    arrays.extend(recording.channels.iter().map(|channel| channel.values.clone()));
    let profiles = &recording.profiles;
    arrays.push(profiles.iter().map(|own| own.time).collect());
    arrays.push(profiles.iter().flat_map(|own| own.x).collect());
    arrays.push(profiles.iter().flat_map(|own| own.pressure).collect());
    arrays.push(profiles.iter().flat_map(|own| own.temperature).collect());
    arrays.push(profiles.iter().flat_map(|own| own.worn.concat()).collect());
    let status = match (&failure, recording.interrupted) {
        (None, false) => Status::Success,
        (None, true) => Status::Stopped,
        (Some(_), _) => Status::StepFailed,
    };
    let run = Run { scene: name.clone(), inputs: table, recording };
    Ok(Answer { status, text: c_text(&record.to_string()), arrays, run: Some(run) })
}

/// Name, description, warnings, and values and units of what can be set; of arrays one entry for every element.
fn described(file: &SceneFile) -> Result<Value> {
    let packaged = &file.packaged;
    scene::Scene::new(&packaged.starts, Some(packaged.experiment.tolerance))
        .map_err(|broken| anyhow!("the scene {}: {broken}", packaged.name))?;
    let mut variables = Map::new();
    for number in 0..packaged.starts.len() {
        let Some((row, element)) = lookup(number as ValueReference) else { continue };
        if !matches!(row.causality, Causality::Parameter | Causality::Input) {
            continue;
        }
        let value = packaged.starts[number];
        let mut items = Vec::new();
        let start = value;
        let (value, unit) = match row.kind {
            Kind::Real { unit, .. } => (json!(value), unit.name),
            Kind::Integer { .. } => (json!(value as i64), "1"),
            Kind::Boolean => (json!(value != 0.0), "1"),
            Kind::Enumeration(kind) => {
                items = kind.items.iter().map(|item| item.0).collect();
                (json!(items.get(value as usize - 1)), "1")
            }
        };
        let causality = if row.causality == Causality::Parameter { "parameter" } else { "input" };
        // `start`: the value as a number; of an item its place among `items`, from 1.
        let entry = json!({
            "value": value, "start": start, "items": items, "unit": unit, "causality": causality, "description": row.description,
        });
        variables.insert(row.element_name(element), entry);
    }
    Ok(json!({
        "name": packaged.name,
        "description": file.description,
        "tolerance": packaged.experiment.tolerance,
        "scene_warnings": shipped::warnings(file),
        "variables": variables,
    }))
}

/// Unit of a variable or of the time, and whether units with an offset make sense.
fn unit_of(name: &str) -> Result<(&'static Unit, bool)> {
    if name == "time" {
        return Ok((&SECOND, true));
    }
    let row = row_of(name)?;
    Ok(match row.kind {
        Kind::Real { unit, .. } => (unit, !row.is_difference()),
        _ => (&ONE, true),
    })
}

/// Names of inputs and the longest step, with the times and the values as arrays.
fn inputs_over_time(trajectory: Trajectory, notes: &[String]) -> Answer {
    let names: Vec<String> = trajectory
        .inputs
        .iter()
        .filter_map(|(input, _)| lookup(*input).map(|(row, element)| row.element_name(element)))
        .collect();
    let record = json!({
        "inputs": names, "step": trajectory.equal_step(), "description": trajectory.description, "notes": notes,
    });
    let mut arrays = vec![trajectory.times];
    arrays.extend(trajectory.inputs.into_iter().map(|(_, values)| values));
    Answer { status: Status::Success, text: c_text(&record.to_string()), arrays, run: None }
}

/// Slope and zero of a unit over the SI one of a variable, or of the time.
fn conversion(name: &str, symbol: &str) -> Result<Value> {
    let (unit, absolute) = unit_of(name)?;
    let at = |number: f64| {
        quantity::in_si(number, symbol, unit, absolute).map_err(|wrong| anyhow!("{name} [{symbol}]: {wrong}"))
    };
    let (zero, one) = (at(0.0)?, at(1.0)?);
    let slope = one - zero;
    Ok(json!({ "unit": unit.name, "slope": slope, "zero": zero }))
}

/// The row of a variable or of an array of variables.
fn row_of(name: &str) -> Result<&'static Row> {
    if let Some(row) = TABLE.iter().find(|row| row.name == name) {
        return Ok(row);
    }
    match scene::variables::find(name).and_then(lookup) {
        Some((row, _)) => Ok(row),
        None => bail!("there is no variable {name:?}{}", nearest(name, TABLE.iter().map(|row| row.name))),
    }
}
