//! `cargo fmu fuzz`: random calls, states, scene files and batch inputs.
//!
//! | module | about |
//! |---|---|
//! | `calls` | target: sequences of calls of the C interface |
//! | `states` | target: serialised states that are damaged |
//! | `scenes` | target: scene files that are changed |
//! | `batch` | target: designs and inputs of batches that are changed |
//! | `invariants` | what must hold after every `fmi2OK` |
//! | `campaign` | processes that run a target, and what they report |
//! | `corpus` | committed executions, with the reason why each is kept |
//! | `watchdog` | time limit of a call |
//!
//! An execution is determined by its target and its seed. Executions run in a process of their own, so that one that ends
//! the process is attributed to its seed, and the campaign goes on behind it.

mod batch;
mod calls;
mod campaign;
mod corpus;
mod importer;
mod invariants;
mod random;
mod scenes;
mod states;
mod text;
mod watchdog;

use std::collections::BTreeSet;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Mutex;
use std::time::Duration;

use anyhow::{Result, bail};

use crate::arguments;
use crate::output::print_line;

/// Result of an execution: what was found.
pub(crate) type Verdict = Result<(), String>;

/// Found are crashes, panics, calls that take longer than --limit, outputs that are not finite after fmi2OK, invariants that
/// do not hold (worn volumes that decrease, pressures below zero, heat that is lost), states that a failed call changed or that
/// do not replay to the bit, and refusals without a message. Each is printed with its target and seed; --target and --seed
/// repeat it.
///
/// Under the address sanitizer, with the assertions of debug builds (Linux on x86-64):
///
///   RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Zsanitizer=address -Cdebug-assertions=yes" cargo run --release --package fmu-lab
///   --target x86_64-unknown-linux-gnu --target-dir target/sanitizer -- fuzz
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// Only these targets; all by default, each for its share of the time.
    #[arg(long, value_enum)]
    target: Vec<Target>,
    /// Seed of the only execution, whose calls are printed.
    #[arg(long, conflicts_with_all = ["seconds", "executions", "from", "corpus"], value_parser = arguments::whole::<u64>(0..=u64::MAX), allow_negative_numbers = true)]
    seed: Option<u64>,
    /// First seed; the next executions have the next ones.
    #[arg(long, default_value_t = 1, value_parser = arguments::whole::<u64>(0..=u64::MAX), allow_negative_numbers = true)]
    from: u64,
    /// Time of all targets together.
    #[arg(long, default_value_t = 60.0, value_parser = arguments::number, allow_negative_numbers = true)]
    seconds: f64,
    /// Most executions of each target.
    #[arg(long, value_parser = arguments::whole::<u64>(1..=u64::MAX), allow_negative_numbers = true)]
    executions: Option<u64>,
    /// Longest time that a call may take, in seconds. A step ends with an error after 200,000 internal steps or 2^20 contact
    /// solutions, which take about 10 s on one core.
    #[arg(long, default_value_t = 60.0, value_parser = arguments::number, allow_negative_numbers = true)]
    limit: f64,
    /// Only the committed executions of tests/fuzz.
    #[arg(long)]
    corpus: bool,
    /// Also print the seeds that make the library say something new: candidates for the corpus.
    #[arg(long)]
    novel: bool,
    /// Run in this process, and report to the one that started it.
    #[arg(long, hide = true, value_name = "FILE")]
    progress: Option<std::path::PathBuf>,
}

/// Fuzzed interface.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Target {
    /// Sequences of calls of the C interface.
    Calls,
    /// Serialised states.
    States,
    /// Scene files.
    Scenes,
    /// Designs and inputs of batches.
    Batch,
}

impl Target {
    /// All of them, with their names as arguments.
    const ALL: [(Self, &'static str); 4] =
        [(Self::Calls, "calls"), (Self::States, "states"), (Self::Scenes, "scenes"), (Self::Batch, "batch")];

    fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// Kinds of messages that were seen: texts without their numbers.
#[derive(Default, Debug)]
pub(crate) struct Kinds {
    seen: BTreeSet<String>,
}

/// Length of a message's beginning that tells its kind.
const KIND: usize = 70;

impl Kinds {
    pub(crate) fn note(&mut self, text: &str) {
        let kind = kind_of(text);
        if !self.seen.contains(&kind) {
            self.seen.insert(kind);
        }
    }

    fn count(&self) -> usize {
        self.seen.len()
    }
}

/// A text without its numbers.
fn kind_of(text: &str) -> String {
    let mut kind = String::new();
    for letter in text.chars() {
        let is_number = letter.is_ascii_digit() || "+-.e".contains(letter);
        if !(is_number && kind.ends_with('0')) {
            kind.push(if letter.is_ascii_digit() { '0' } else { letter });
        }
        if kind.len() >= KIND {
            break;
        }
    }
    kind
}

/// Source line of the last panic outside of the library's own barrier.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Keeps the place of panics instead of printing them.
fn keep_panics() {
    panic::set_hook(Box::new(|info| {
        if let Ok(mut place) = PANIC.lock() {
            *place = info.to_string();
        }
    }));
}

fn run(target: Target, seed: u64, kinds: &mut Kinds) -> Verdict {
    let body = || match target {
        Target::Calls => calls::run(seed, kinds),
        Target::States => states::run(seed, kinds),
        Target::Scenes => scenes::run(seed, kinds),
        Target::Batch => batch::run(seed, kinds),
    };
    panic::catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| {
        let place = PANIC.lock().map(|place| place.clone()).unwrap_or_default();
        Err(format!("{}: {}", watchdog::last(), place.replace('\n', " ")))
    })
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    for (option, seconds) in [("--seconds", arguments.seconds), ("--limit", arguments.limit)] {
        if !(seconds > 0.0 && seconds < 1e6) {
            bail!("{option} {seconds} s must be above 0 s and below 1e6 s");
        }
    }
    let all: Vec<Target> = Target::ALL.iter().map(|entry| entry.0).collect();
    let targets = if arguments.target.is_empty() { &all } else { &arguments.target };
    if let Some(file) = &arguments.progress {
        return campaign::serve(arguments, targets[0], file);
    }
    if arguments.corpus {
        return corpus::replay(arguments);
    }
    if let Some(seed) = arguments.seed {
        let [target] = targets[..] else { bail!("--seed needs one --target") };
        return repeat(target, seed, arguments.limit);
    }
    campaign::run(arguments, targets)
}

/// One execution in this process, with its calls on the error stream.
fn repeat(target: Target, seed: u64, limit: f64) -> Result<()> {
    watchdog::trace();
    keep_panics();
    watchdog::start(Duration::from_secs_f64(limit), move |function| {
        eprintln!("error: {function} takes longer than {limit} s");
        std::process::exit(1);
    });
    match run(target, seed, &mut Kinds::default()) {
        Ok(()) => {
            print_line!("{} {seed}: nothing found", target.name());
            Ok(())
        }
        Err(found) => bail!("{} {seed}: {found}", target.name()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corpus_finds_nothing() {
        let mut kinds = Kinds::default();
        let (count, found) = corpus::run_all(&[], &mut kinds).unwrap();
        assert!(found.is_empty(), "{}", found.join("\n"));
        assert!(count > 100 && kinds.count() > 100, "{count} executions, {} kinds of messages", kinds.count());
    }

    #[test]
    fn an_execution_is_determined_by_its_seed() {
        for (target, name) in Target::ALL {
            assert_eq!(target.name(), name);
            let said = [(); 2].map(|()| {
                let mut kinds = Kinds::default();
                (1..20).for_each(|seed| run(target, seed, &mut kinds).unwrap());
                kinds.seen
            });
            assert_eq!(said[0], said[1], "{name}");
        }
    }
}
