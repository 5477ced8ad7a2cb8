//! A worker process: one instance of the FMU, scenes in on the standard input, answers out on the standard output, one
//! line of JSON each.

use super::tables::Inputs;
use super::{FACTOR, Job};
use anyhow::{Context, Result, bail};
use fmu_host::{Causality, Failure, Scene, Schedule, Span, Stage, Worker};
use std::io::{self, BufRead, ErrorKind, Write, stdin, stdout};

/// Status of a scene that did not fail.
pub const OK: &str = "ok";
/// Status of a scene whose process was lost.
pub const LOST: &str = "lost";

/// Result of a scene.
#[derive(serde::Serialize, serde::Deserialize, Clone, PartialEq, Eq, Debug)]
pub struct Answer {
    /// [`OK`], [`LOST`], or the stage that failed.
    pub status: String,
    /// Reason for the failure; empty on success.
    pub reason: String,
    /// Results as texts that are read back as the same numbers; none where it failed.
    pub values: Vec<String>,
}

impl Answer {
    /// Of a scene that failed.
    pub fn failed(status: &str, reason: String) -> Self {
        Self { status: status.to_owned(), reason, values: Vec::new() }
    }
}

/// Runs scenes until the standard input ends. The first line is the job, its answer whether the FMU is open.
///
/// # Errors
/// Where the other end does not keep to this.
pub fn execute() -> Result<()> {
    match serve() {
        // The pipe is closed: the run was stopped, and the lost scenes run again later.
        Err(error) if error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe) => {
            Ok(())
        }
        result => result,
    }
}

fn serve() -> Result<()> {
    let mut lines = stdin().lock().lines();
    let Some(line) = lines.next() else { return Ok(()) };
    let job: Job = serde_json::from_str(&line?).context("reading the job")?;
    let mut runner = match Runner::open(&job) {
        Ok(runner) => runner,
        Err(error) => return say(&Answer::failed(Stage::Library.name(), format!("{error:#}"))),
    };
    say(&Answer { status: OK.to_owned(), reason: String::new(), values: Vec::new() })?;
    for line in lines {
        let cells: Vec<String> = serde_json::from_str(&line?).context("reading a scene")?;
        match runner.run(&cells) {
            Ok(values) => say(&Answer { status: OK.to_owned(), reason: String::new(), values })?,
            Err(failure) => {
                say(&Answer::failed(failure.stage.name(), failure.reason))?;
                if failure.stage == Stage::Library {
                    break;
                }
            }
        }
    }
    Ok(())
}

fn say(answer: &Answer) -> Result<()> {
    let mut line = serde_json::to_string(answer)?;
    line.push('\n');
    let mut out = stdout().lock();
    out.write_all(line.as_bytes())?;
    Ok(out.flush()?)
}

/// Most communication points that largest values are taken from: their times and values are kept in memory.
const MOST_POINTS: f64 = 1e7;

/// Communication points that largest values are taken from: every so often, and the last.
///
/// # Errors
/// Where the interval is not above 0, or makes more than [`MOST_POINTS`].
pub fn points(span: Span, every: f64) -> Result<Vec<f64>> {
    if !(every.is_finite() && every > 0.0) {
        bail!("--every {every} must be positive");
    }
    let count = ((span.stop - span.start) / every + 1e-9).floor();
    if count.is_nan() || count > MOST_POINTS {
        bail!(
            "--every {every} s makes {count:e} points from {} s to {} s; {MOST_POINTS:e} are the most (without --every it is the \
             --step)",
            span.start,
            span.stop
        );
    }
    let count = count as usize;
    let mut points: Vec<f64> = (0..=count).map(|at| span.start + at as f64 * every).collect();
    if points[count] < span.stop - 1e-9 * every {
        points.push(span.stop);
    }
    Ok(points)
}

struct Runner<'a> {
    job: &'a Job,
    worker: Worker,
    inputs: Inputs,
    span: Span,
    points: Vec<f64>,
}

impl<'a> Runner<'a> {
    fn open(job: &'a Job) -> Result<Self> {
        let worker = Worker::open(&job.folder)?;
        let inputs = Inputs::read(&job.inputs, worker.description())?;
        let span = Span { start: inputs.start(), stop: inputs.stop(), step: job.step.value()? };
        let points = if job.peak.is_empty() { vec![span.stop] } else { points(span, job.every.value()?)? };
        Ok(Self { job, worker, inputs, span, points })
    }

    fn run(&mut self, cells: &[String]) -> Result<Vec<String>, Failure> {
        let Self { job, inputs, .. } = self;
        let mut factors = vec![1.0; inputs.names.len()];
        let mut parameters = Vec::with_capacity(cells.len());
        for (column, cell) in job.columns.iter().zip(cells) {
            let factor = column.strip_suffix(FACTOR).and_then(|name| inputs.names.iter().position(|own| own == name));
            match factor {
                Some(input) => {
                    factors[input] = cell.parse().map_err(|_| Failure {
                        stage: Stage::Request,
                        reason: format!("{column} = {cell:?} is no number"),
                    })?;
                }
                None => {
                    let variable = self.worker.description().find_as(column, Causality::Parameter)?;
                    parameters.push((column.as_str(), variable.parse(cell)?));
                }
            }
        }
        let names: Vec<&str> = inputs.names.iter().map(String::as_str).collect();
        let outputs: Vec<&str> = job.record.iter().chain(&job.peak).map(String::as_str).collect();
        let recorded = self.worker.run(&Scene {
            parameters: &parameters,
            inputs: &names,
            factors: &factors,
            schedule: Schedule::new(&inputs.times, &inputs.values, names.len())?,
            interpolation: job.interpolation.into(),
            span: self.span,
            tolerance: None,
            outputs: &outputs,
            points: &self.points,
        })?;
        let width = outputs.len();
        let mut values = recorded[recorded.len() - width..].to_vec();
        for (at, value) in values.iter_mut().enumerate().skip(job.record.len()) {
            *value = recorded.iter().skip(at).step_by(width).copied().fold(f64::NEG_INFINITY, f64::max);
        }
        Ok(values.iter().map(f64::to_string).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_values_are_taken_to_the_very_end() {
        let span = Span { start: 1.0, stop: 2.0, step: 0.1 };
        let points = |span, every| points(span, every).unwrap();
        assert_eq!(points(span, 0.5), [1.0, 1.5, 2.0]);
        assert_eq!(points(span, 0.4), [1.0, 1.4, 1.8, 2.0]);
        assert_eq!(points(span, 7.0), [1.0, 2.0]);
        assert_eq!(points(span, 0.1).len(), 11);
    }

    #[test]
    fn intervals_that_no_memory_holds_the_points_of_are_refused() {
        let span = Span { start: 0.0, stop: 1e3, step: 1e-9 };
        for every in [1e-9, 1e-300, 5e-324, 0.0, -1.0, f64::NAN] {
            let told = points(span, every).unwrap_err().to_string();
            assert!(told.starts_with(&format!("--every {every} ")), "{told}");
        }
    }
}
