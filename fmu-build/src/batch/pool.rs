//! Worker processes and the scenes they are given.
//!
//! Processes, not threads: a crash or an endless loop of a scene affects that scene only.

use super::Job;
use super::worker::{Answer, LOST, OK};
use crate::project;
use anyhow::{Context, Result, anyhow, bail};
use fmu_host::Stage;
use scene::message::Quoted;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc;

/// Number of attempts for a scene whose process was lost, which need not be caused by the scene.
const TRIES: usize = 2;

/// Runs the pending scenes on `jobs` processes; `keep` takes each answer as it comes. A row that is a fault is its answer.
pub(crate) fn run(
    job: &Job,
    rows: &[Result<Vec<String>, String>],
    pending: Vec<usize>,
    jobs: usize,
    mut keep: impl FnMut(usize, &Answer) -> Result<()>,
) -> Result<()> {
    let count = jobs.min(pending.len());
    let pending = Mutex::new(pending.into_iter());
    let next = || pending.lock().ok()?.next();
    let (sender, answers) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..count {
            let sender = sender.clone();
            let next = &next;
            scope.spawn(move || {
                let mut process = None;
                while let Some(scene) = next() {
                    let answer = match &rows[scene] {
                        Ok(cells) => attempt(job, cells, &mut process),
                        Err(fault) => Ok(Answer::failed(Stage::Request.name(), fault.clone())),
                    };
                    let is_over = answer.is_err();
                    if sender.send(answer.map(|answer| (scene, answer))).is_err() || is_over {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let result = answers.iter().try_for_each(|answer| {
            let (scene, answer) = answer?;
            keep(scene, &answer)
        });
        // No further scene is started once a result could not be stored.
        drop(answers);
        result
    })
}

/// One scene on this thread's process, which is started or replaced as needed.
fn attempt(job: &Job, cells: &[String], process: &mut Option<Process>) -> Result<Answer> {
    let mut reason = String::new();
    for _ in 0..TRIES {
        let own = match process {
            Some(own) => own,
            None => process.insert(Process::start(job)?),
        };
        match own.exchange(&serde_json::to_string(cells)?) {
            Ok(answer) => {
                if answer.status == fmu_host::Stage::Library.name() {
                    *process = None;
                }
                return Ok(answer);
            }
            Err(error) => {
                reason = format!("{error:#}");
                *process = None;
            }
        }
    }
    Ok(Answer::failed(LOST, format!("the worker process was lost {TRIES} times, the last time: {reason}")))
}

struct Process {
    child: Child,
    /// `None` only while it ends.
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Process {
    fn start(job: &Job) -> Result<Self> {
        let program = project::program().context("finding this program")?;
        let mut child = Command::new(&program)
            .arg("batch-worker")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .with_context(|| format!("starting {}", program.display()))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            bail!("{} was started without pipes", program.display());
        };
        let mut process = Self { child, input: Some(input), output: BufReader::new(output) };
        let answer = process.exchange(&serde_json::to_string(job)?).context("opening the FMU in a worker process")?;
        if answer.status != OK {
            bail!("a worker process could not open the FMU: {}", answer.reason);
        }
        Ok(process)
    }

    fn exchange(&mut self, line: &str) -> Result<Answer> {
        let mut said = String::new();
        let input = self.input.as_mut().ok_or_else(|| anyhow!("the process has ended"))?;
        let sent = input.write_all(format!("{line}\n").as_bytes()).and_then(|()| input.flush());
        // A broken pipe means that the process has ended; its exit status is the better message.
        if sent.is_err() || self.output.read_line(&mut said)? == 0 || !said.ends_with('\n') {
            let status = self.child.wait()?;
            bail!("it ended with {status}");
        }
        serde_json::from_str(&said).with_context(|| format!("it said {}", Quoted(&said)))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Without input it ends by itself.
        drop(self.input.take());
        let _ = self.child.wait();
    }
}
