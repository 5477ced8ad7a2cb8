//! Processes that run a target one after the other, and what they report.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use super::{Arguments, Kinds, Target, keep_panics, kind_of, run as execute, watchdog};
use crate::output::print_line;

/// Findings of one kind that are printed.
const MOST_OF_A_KIND: usize = 3;
/// Processes of a target that may be lost before it is given up.
const MOST_LOST: usize = 50;

/// Findings of a campaign.
#[derive(Default)]
struct Report {
    executions: u64,
    /// Calls of functions, where the process told their number.
    calls: u64,
    found: BTreeMap<String, usize>,
    lost: usize,
}

impl Report {
    fn add(&mut self, target: Target, seed: u64, text: &str) {
        let count = self.found.entry(kind_of(text)).or_default();
        *count += 1;
        if *count <= MOST_OF_A_KIND {
            print_line!("found: {} {seed}: {text}", target.name());
        }
    }
}

/// Runs the targets, each for its share of the time.
pub(crate) fn run(arguments: &Arguments, targets: &[Target]) -> Result<()> {
    let share = arguments.seconds / targets.len() as f64;
    let mut found = 0;
    for &target in targets {
        let begin = Instant::now();
        let mut report = Report::default();
        let mut next = arguments.from;
        loop {
            let left = share - begin.elapsed().as_secs_f64();
            let more = arguments.executions.map(|most| most.saturating_sub(report.executions));
            if left <= 0.0 || more == Some(0) || report.lost > MOST_LOST {
                break;
            }
            next = process(arguments, target, next, left, more, &mut report)?;
        }
        let seconds = begin.elapsed().as_secs_f64();
        print_line!(
            "{}: {} executions of {} calls in {seconds:.1} s ({:.0} executions per second), {} found, seeds from {}",
            target.name(),
            report.executions,
            report.calls,
            report.executions as f64 / seconds,
            report.found.values().sum::<usize>(),
            arguments.from
        );
        found += report.found.len();
    }
    if found > 0 {
        bail!("{found} kinds of defects found; repeat one with --target TARGET --seed SEED");
    }
    Ok(())
}

/// Runs a process until it ends; the next seed.
fn process(
    arguments: &Arguments,
    target: Target,
    from: u64,
    seconds: f64,
    executions: Option<u64>,
    report: &mut Report,
) -> Result<u64> {
    let progress = std::env::temp_dir().join(format!("fuzz-{}-{}", std::process::id(), target.name()));
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["fuzz", "--target", target.name(), "--from", &from.to_string()]);
    command.args(["--seconds", &seconds.to_string(), "--limit", &arguments.limit.to_string()]);
    command.arg("--progress").arg(&progress);
    if let Some(most) = executions {
        command.args(["--executions", &most.to_string()]);
    }
    if arguments.novel {
        command.arg("--novel");
    }
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().context("starting a process")?;
    let mut ended = false;
    let mut hung = false;
    if let Some(lines) = child.stdout.take() {
        for line in BufReader::new(lines).lines() {
            let line = line?;
            let mut words = line.splitn(3, ' ');
            let (what, seed) = (words.next().unwrap_or(""), words.next().and_then(|seed| seed.parse().ok()));
            let text = words.next().unwrap_or("");
            match (what, seed) {
                ("found", Some(seed)) => report.add(target, seed, text),
                ("late", Some(seed)) => {
                    hung = true;
                    report.add(target, seed, text);
                }
                ("novel", Some(seed)) => print_line!("novel: {} {seed}: {text}", target.name()),
                ("end", Some(_)) => {
                    ended = true;
                    report.calls += text.parse::<u64>().unwrap_or(0);
                }
                _ => print_line!("{line}"),
            }
        }
    }
    let status = child.wait()?;
    let last = std::fs::read(&progress).ok().and_then(|bytes| Some(u64::from_le_bytes(*bytes.first_chunk()?)));
    let _ = std::fs::remove_file(&progress);
    let Some(last) = last else { bail!("a process of {} ended before its first execution ({status})", target.name()) };
    report.executions += last + 1 - from;
    if !ended {
        report.lost += 1;
        if !hung {
            report.add(target, last, &format!("the process ends: {status}"));
        }
    }
    Ok(last + 1)
}

/// Runs executions in this process, writes the running seed to `file` and findings to the standard output.
pub(crate) fn serve(arguments: &Arguments, target: Target, file: &Path) -> Result<()> {
    keep_panics();
    let mut progress = File::create(file).with_context(|| format!("writing {}", file.display()))?;
    let limit = arguments.limit;
    let place = file.to_owned();
    watchdog::start(Duration::from_secs_f64(limit), move |function| {
        let seed = std::fs::read(&place).ok().and_then(|bytes| Some(u64::from_le_bytes(*bytes.first_chunk()?)));
        print_line!("late {} {function} takes longer than {limit} s", seed.unwrap_or(0));
        std::process::exit(1);
    });
    let begin = Instant::now();
    let mut kinds = Kinds::default();
    let mut seed = arguments.from;
    loop {
        progress.seek(SeekFrom::Start(0))?;
        progress.write_all(&seed.to_le_bytes())?;
        watchdog::enter("the driver");
        let known = kinds.count();
        if let Err(found) = execute(target, seed, &mut kinds) {
            print_line!("found {seed} {}", found.replace('\n', " "));
        }
        if arguments.novel && kinds.count() > known {
            print_line!("novel {seed} {} kinds of messages", kinds.count());
        }
        let count = seed - arguments.from + 1;
        if begin.elapsed().as_secs_f64() > arguments.seconds || arguments.executions.is_some_and(|most| count >= most) {
            break;
        }
        seed += 1;
    }
    print_line!("end {seed} {}", watchdog::calls());
    // Nothing is left to be done, and instances of the thread need not be freed.
    std::process::exit(0);
}
