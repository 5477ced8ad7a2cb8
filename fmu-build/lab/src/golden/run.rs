//! Drives a golden scene through the component as the FMU sees it, by the names of the variables.

use super::record::{Record, Series, hash};
use super::scenes::{GoldenScene, Replay, Segment};
use crate::{project, scenes};
use anyhow::{Context, Result, bail};
use scene::fnv::Fnv;
use scene::variables::{COUNT, Causality, ValueReference, Variability, find, lookup};
use sliding_contact::component::{Component, Snapshot};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::sync::Arc;

/// Communication points at which values are kept, the first and the last among them.
const KEPT: usize = 8;

/// Beginning of the names of work counters.
pub(crate) const WORK: &str = "work.";

/// Beginning of the names of derivatives.
pub(crate) const DERIVATIVE: &str = "derivative.";

/// Numbers of a command that are times measured.
const MEASURED: [&str; 1] = ["planning_seconds"];

/// Numbers of a command that count its work.
const COUNTED: [&str; 3] = ["compared_steps", "computed", "cycles_computed"];

/// Work counters of the component so far; the only access to more than the FMU's outputs.
fn work(component: &Component) -> [(&'static str, u64); 8] {
    let (steps, rejected) = component.work();
    let contact = component.contact_work();
    let cells = component.operators().map_or(0, |operators| operators.cells());
    [
        ("work.cells", cells as u64),
        ("work.steps", steps),
        ("work.rejected_steps", rejected),
        ("work.contact_solves", contact.solves),
        ("work.contact_iterations", contact.iterations),
        ("work.contact_factorisations", contact.factorisations),
        ("work.contact_fallbacks", contact.fallbacks),
        ("work.contact_pivots", contact.pivots),
    ]
}

/// Name of a row, value reference of its first element, number of elements (0: a scalar).
type Calculated = (&'static str, ValueReference, u32);

/// Everything that the FMU calculates: outputs and locals.
fn layout() -> Vec<Calculated> {
    let calculated = |reference: ValueReference| {
        let (row, _) = lookup(reference)
            .filter(|(row, element)| *element == 0 && matches!(row.causality, Causality::Output | Causality::Local))?;
        Some((row.name, reference, row.elements))
    };
    (0..COUNT as ValueReference).filter_map(calculated).collect()
}

struct Point {
    time: f64,
    outputs: Vec<f64>,
    work: Vec<f64>,
}

struct Run<'a> {
    starts: Arc<[f64; COUNT]>,
    tolerance: f64,
    layout: &'a [Calculated],
    component: Component,
    time: f64,
    points: Vec<Point>,
}

pub(crate) fn record(golden: &GoldenScene) -> Result<Record> {
    let record = match &golden.command {
        Some(arguments) => run_command(arguments),
        None => drive(golden),
    };
    let record = record.with_context(|| format!("the golden scene {}", golden.name))?;
    match (&record.error, golden.fails) {
        (Some(error), false) => bail!("the golden scene {} fails: {error}", golden.name),
        (None, true) => bail!("the golden scene {} should end with an error and does not", golden.name),
        _ => Ok(record),
    }
}

fn drive(golden: &GoldenScene) -> Result<Record> {
    let scene = scenes::changed(golden.scene.as_deref(), &golden.set)?;
    let packaged = scene.packaged;
    let (starts, tolerance) = (Arc::new(packaged.starts), packaged.experiment.tolerance);
    let layout = layout();
    let component = Component::new(starts.clone()).declaring(tolerance);
    let mut run = Run { starts, tolerance, layout: &layout, component, time: 0.0, points: Vec::new() };
    run.component.enter_initialization();
    for (&reference, &value) in named(&golden.start)?.iter() {
        run.component.set_input(reference, value);
    }
    let mut error = run.component.initialise(None).err().map(|text| format!("initialisation: {text}"));
    if error.is_none() {
        run.keep();
        'driven: for _ in 0..golden.repeat {
            for segment in &golden.drive {
                error = run.take(segment)?;
                if error.is_some() {
                    break 'driven;
                }
            }
        }
    }
    let mut record = compress(&layout, &run.points, &run.component);
    if error.is_none() {
        derivatives(&layout, &mut run.component, &mut record)?;
    }
    record.error = error;
    Ok(record)
}

/// Value references by name.
fn named(values: &BTreeMap<String, f64>) -> Result<BTreeMap<ValueReference, f64>> {
    let reference = |name: &str| find(name).with_context(|| format!("{name:?} is no variable"));
    values.iter().map(|(name, &value)| Ok((reference(name)?, value))).collect()
}

impl Run<'_> {
    fn keep(&mut self) {
        let references = self.layout.iter().flat_map(|&(_, first, elements)| first..first + elements.max(1));
        let outputs = references.map(|reference| self.component.get(reference)).collect();
        let work = work(&self.component).map(|(_, count)| count as f64).to_vec();
        self.points.push(Point { time: self.time, outputs, work });
    }

    /// Takes a segment; the error that ended it, where one did.
    fn take(&mut self, segment: &Segment) -> Result<Option<String>> {
        let (inputs, slopes, tune) = (named(&segment.inputs)?, named(&segment.slopes)?, named(&segment.tune)?);
        let (mut saved, began, first) = (Snapshot::default(), self.time, self.points.len());
        self.component.snapshot(&mut saved);
        for pass in 0..if segment.replay == Replay::None { 1 } else { 2 } {
            if pass == 1 {
                if segment.replay == Replay::Fresh {
                    self.component = Component::new(self.starts.clone()).declaring(self.tolerance);
                }
                if let Err(text) = self.component.restore(&saved) {
                    bail!("a saved state is refused: {text}");
                }
                self.time = began;
            }
            for (&reference, &value) in &tune {
                self.component.set_parameter(reference, value);
            }
            for (&reference, &value) in &inputs {
                self.component.set_input(reference, value);
            }
            for step in 0..segment.steps {
                for (&reference, &value) in &slopes {
                    self.component.set_input_derivative(reference, value);
                }
                if let Err(text) = self.component.step(segment.step) {
                    return Ok(Some(format!("step at {} s: {text}", self.time)));
                }
                self.time += segment.step;
                self.keep();
                if pass == 1 {
                    let bits = |index: usize| self.points[index].outputs.iter().map(|value| value.to_bits());
                    if !bits(first + step).eq(bits(first + segment.steps + step)) {
                        bail!("the step to {} s gives other bits when it is taken again from a saved state", self.time);
                    }
                }
            }
        }
        Ok(None)
    }
}

/// Indices of the points that are kept.
fn kept(points: usize) -> Vec<usize> {
    let count = KEPT.min(points);
    (0..count).map(|index| if count < 2 { 0 } else { index * (points - 1) / (count - 1) }).collect()
}

fn compress(layout: &[Calculated], points: &[Point], component: &Component) -> Record {
    let kept = kept(points.len());
    let mut record = Record {
        points: points.len(),
        kept: kept.iter().map(|&index| (index, points[index].time)).collect(),
        ..Record::default()
    };
    record.hashes.extend(points.iter().map(|point| {
        let hash = hash(point.outputs.iter().chain(&point.work).copied());
        (hash.0 >> 32) as u32 ^ hash.0 as u32
    }));
    if points.is_empty() {
        return record;
    }
    let over = |name: &str, value: &dyn Fn(&Point) -> f64| {
        let all: Vec<f64> = points.iter().map(value).collect();
        let values = kept.iter().map(|&index| all[index]).collect();
        Series { name: name.to_owned(), hash: hash(all), values }
    };
    for (index, (name, _)) in work(component).iter().enumerate() {
        record.series.push(over(name, &|point| point.work[index]));
    }
    let mut at = 0;
    for &(name, first, elements) in layout {
        let range = at..at + elements.max(1) as usize;
        at = range.end;
        if elements == 0 {
            record.series.push(over(name, &|point| point.outputs[range.start]));
            continue;
        }
        // Of a profile, one point in the middle and the last are kept; of one that is calculated once, the last.
        let hash = hash(points.iter().flat_map(|point| point.outputs[range.clone()].iter().copied()));
        let mut shown = vec![kept[kept.len() / 2], kept[kept.len() - 1]];
        let is_fixed = lookup(first).is_some_and(|(row, _)| row.variability == Variability::Fixed);
        shown.dedup_by(|last, earlier| is_fixed || last == earlier);
        for index in shown {
            let values = points[index].outputs[range.clone()].to_vec();
            record.series.push(Series { name: format!("{name}@{index}"), hash, values });
        }
    }
    record
}

/// Derivatives of the scalar outputs by velocity and load at the last communication point.
fn derivatives(layout: &[Calculated], component: &mut Component, record: &mut Record) -> Result<()> {
    let scalars: Vec<_> = layout.iter().filter(|row| row.2 == 0).collect();
    let unknowns: Vec<ValueReference> = scalars.iter().map(|row| row.1).collect();
    for input in ["sliding_velocity", "normal_load"] {
        let known = find(input).with_context(|| format!("{input:?} is no variable"))?;
        let mut result = vec![0.0; unknowns.len()];
        if let Err(text) = component.directional_derivative(&unknowns, &[known], &[1.0], &mut result) {
            bail!("derivatives by {input}: {text}");
        }
        for (row, value) in scalars.iter().zip(result) {
            if value != 0.0 {
                let name = format!("{DERIVATIVE}{input}.{}", row.0);
                record.series.push(Series { name, hash: hash([value]), values: vec![value] });
            }
        }
    }
    Ok(())
}

/// The numbers that a command of this program prints as JSON.
fn run_command(arguments: &[String]) -> Result<Record> {
    let program = project::program()?;
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output()?;
    let error = (!output.status.success()).then(|| {
        String::from_utf8_lossy(&output.stderr).lines().filter(|line| line.starts_with("error")).collect::<String>()
    });
    let series = flatten(&String::from_utf8(output.stdout)?);
    Ok(Record { error, series, ..Record::default() })
}

/// The numbers of JSON that is printed with one value in a line, arrays under one name.
fn flatten(json: &str) -> Vec<Series> {
    let (mut path, mut counts) = (Vec::<String>::new(), vec![0_usize]);
    let mut series: Vec<Series> = Vec::new();
    for line in json.lines() {
        let line = line.trim().trim_end_matches(',');
        let (key, value) = match line.strip_prefix('"').and_then(|rest| rest.split_once("\": ")) {
            Some((key, value)) => (key.to_owned(), value),
            None => (String::new(), line),
        };
        match value {
            "}" | "]" => {
                path.pop();
                counts.pop();
            }
            "{" | "[" => {
                let count = counts.last_mut().expect("the outermost is never taken");
                *count += 1;
                path.push(if key.is_empty() { count.to_string() } else { key });
                counts.push(0);
            }
            _ if MEASURED.contains(&key.as_str()) => {}
            _ => {
                let Ok(number) = value.parse::<f64>() else { continue };
                let mut name = path[1.min(path.len())..].join(".");
                if !key.is_empty() {
                    name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                }
                let mut name = name.replace(' ', "_");
                if COUNTED.contains(&key.as_str()) {
                    name.insert_str(0, WORK);
                }
                match series.last_mut().filter(|last| key.is_empty() && last.name == name) {
                    Some(last) => last.values.push(number),
                    None => series.push(Series { name, hash: Fnv::new(), values: vec![number] }),
                }
            }
        }
    }
    series.iter_mut().for_each(|series| series.hash = hash(series.values.iter().copied()));
    series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_json_are_found_by_their_path() {
        let json = serde_json::json!({"a": 0.1, "b": {"c": [1.0, 2.5e-300], "text": "x"}, "d": [{"e": 3}, {"e": 4}],
            "planning_seconds": 1.5, "z": {"computed": 7}});
        let names: Vec<(String, Vec<f64>)> =
            flatten(&format!("{json:#}")).into_iter().map(|series| (series.name, series.values)).collect();
        let expected = [
            ("a", vec![0.1]),
            ("b.c", vec![1.0, 2.5e-300]),
            ("d.1.e", vec![3.0]),
            ("d.2.e", vec![4.0]),
            ("work.z.computed", vec![7.0]),
        ];
        assert_eq!(names, expected.map(|(name, values)| (name.to_owned(), values)));
    }

    #[test]
    fn the_kept_points_are_spread_from_the_first_to_the_last() {
        assert_eq!(kept(1), [0]);
        assert_eq!(kept(3), [0, 1, 2]);
        assert_eq!(kept(71), [0, 10, 20, 30, 40, 50, 60, 70]);
        assert!(kept(0).is_empty());
    }
}
