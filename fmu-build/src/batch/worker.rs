//! A worker process: one instance of the FMU, scenes in on the standard input, answers out on the standard output, one
//! line of JSON each.

use super::timeline::Timeline;
use super::{FACTOR, Job, NOMINAL};
use anyhow::{Context, Result};
use fmu_host::{Causality, Failure, Scene, Schedule, Stage, Worker};
use scene::message::Quoted;
use scene_file::nominal::with_remedy;
use std::io::{self, BufRead, ErrorKind, Write, stdin, stdout};

/// Status of a scene that did not fail.
pub(crate) const OK: &str = "ok";
/// Status of a scene whose process was lost.
pub(crate) const LOST: &str = "lost";

#[derive(serde::Serialize, serde::Deserialize, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Answer {
    /// [`OK`], [`LOST`], or the stage that failed.
    pub status: String,
    /// Reason for the failure; empty on success.
    pub reason: String,
    /// Results as texts that are read back as the same numbers; none where it failed.
    pub values: Vec<String>,
}

impl Answer {
    /// Of a scene that failed.
    pub(crate) fn failed(status: &str, reason: String) -> Self {
        Self { status: status.to_owned(), reason, values: Vec::new() }
    }
}

/// Runs scenes until the standard input ends. The first line is the job, its answer whether the FMU is open.
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
                say(&Answer::failed(failure.stage.name(), with_remedy(failure.reason)))?;
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

struct Runner<'a> {
    job: &'a Job,
    worker: Worker,
    /// Where a scene has none of its own.
    timeline: Timeline,
}

impl<'a> Runner<'a> {
    fn open(job: &'a Job) -> Result<Self> {
        let worker = Worker::open(&job.folder)?;
        let timeline = Timeline::new(job, worker.description(), &[])?;
        Ok(Self { job, worker, timeline })
    }

    fn run(&mut self, cells: &[String]) -> Result<Vec<String>, Failure> {
        let Self { job, .. } = self;
        let own;
        let timeline = if job.inputs.is_none() && job.columns.iter().any(|column| column.starts_with(NOMINAL)) {
            own =
                Timeline::new(job, self.worker.description(), cells).map_err(|wrong| request(format!("{wrong:#}")))?;
            &own
        } else {
            &self.timeline
        };
        let inputs = &timeline.inputs;
        let mut factors = vec![1.0; inputs.names.len()];
        let mut parameters = Vec::with_capacity(cells.len());
        for (column, cell) in job.columns.iter().zip(cells) {
            let factor = column.strip_suffix(FACTOR).and_then(|name| inputs.names.iter().position(|own| own == name));
            match factor {
                Some(input) => {
                    let factor: f64 =
                        cell.parse().map_err(|_| request(format!("{column} = {} is no number", Quoted(cell))))?;
                    factors[input] = factor;
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
            span: timeline.span,
            tolerance: None,
            outputs: &outputs,
            points: &timeline.points,
        })?;
        let width = outputs.len();
        let mut values = recorded[recorded.len() - width..].to_vec();
        for (at, value) in values.iter_mut().enumerate().skip(job.record.len()) {
            *value = recorded.iter().skip(at).step_by(width).copied().fold(f64::NEG_INFINITY, f64::max);
        }
        Ok(values.iter().map(f64::to_string).collect())
    }
}

/// A scene that cannot be run as it is.
fn request(reason: String) -> Failure {
    Failure { stage: Stage::Request, reason }
}
