//! `cargo fmu soak`: very many steps, life cycles and states in one process; memory stays flat and results stay the same.

use crate::output::print_line;
use crate::{arguments, bench, package, project};
use anyhow::{Result, ensure};
use fmu_host::timing::{Component, Instance, Variables};
use scene::fnv::Fnv;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Communication step, s.
const STEP: f64 = 1e-2;
/// Factor on the velocities of the drive: below the critical speed, above which steps with resolved heat cost milliseconds.
const SPEED: f64 = 0.3;
/// Cells of the contact line.
const CELLS: usize = 17;
/// Repetitions of the same run whose results are compared.
const ROUNDS: usize = 10;
/// Loads and unloads in a short soak at least.
const LIVES: usize = 99;
/// Steps in every life of an instance, and after every saved state.
const FEW: usize = 20;
/// Growth of the resident memory that is put down to the allocator, in KiB.
const GROWTH: i64 = 1024;

/// Step, load, unload, save and restore very often in one process: memory stays flat, and the last results are the first ones.
///
/// Steps are made in ten rounds of the same drive, each from a reset instance; a round's outputs are compared with the first
/// round's to the bit. Resident memory is measured behind the first round and at the end, and may grow by 1 MiB. Over loads and
/// unloads it is the least growth over a third of them: a leak grows in each, while the free memory of a thread that has ended
/// stays once. After every unloading the library must be gone from the process (both on Linux).
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Steps of the lumped level.
    #[arg(long, default_value_t = 100_000_000, value_parser = arguments::whole::<usize>(0..=1_000_000_000_000), allow_negative_numbers = true)]
    lumped: usize,
    /// Steps of the contact line with resolved heat.
    #[arg(long, default_value_t = 1_000_000, value_parser = arguments::whole::<usize>(0..=1_000_000_000_000), allow_negative_numbers = true)]
    line: usize,
    /// Rounds of loading the library, instantiating, initialising, stepping, freeing and unloading it.
    #[arg(long, default_value_t = 5000, value_parser = arguments::whole::<usize>(0..=1_000_000_000_000), allow_negative_numbers = true)]
    rounds: usize,
    /// States that are saved, restored and stepped from again.
    #[arg(long, default_value_t = 100_000, value_parser = arguments::whole::<usize>(0..=1_000_000_000_000), allow_negative_numbers = true)]
    states: usize,
    /// A five hundredth of all: seconds.
    #[arg(long, conflicts_with_all = ["lumped", "line", "rounds", "states"])]
    short: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(serde::Serialize, Debug)]
pub(crate) struct Outcome {
    what: &'static str,
    count: usize,
    seconds: f64,
    /// Resident memory at the beginning and at the end, KiB; `None` where the system does not tell.
    memory: Option<[i64; 2]>,
    /// The last round gave the first round's results, to the bit.
    is_same: bool,
    /// Rounds after which the library was still mapped.
    still_mapped: usize,
}

impl Outcome {
    fn is_flat(&self) -> bool {
        self.memory.is_none_or(|[before, after]| after - before <= GROWTH)
    }

    fn is_good(&self) -> bool {
        self.is_same && self.still_mapped == 0 && self.is_flat()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outcome { what, count, seconds, .. } = self;
        write!(formatter, "{what:44} {count:>11} {seconds:8.1} s")?;
        if let Some([before, after]) = self.memory {
            write!(formatter, "  memory {before} to {after} KiB{}", if self.is_flat() { "" } else { ": grows" })?;
        }
        write!(formatter, "  results {}", if self.is_same { "the same" } else { "DIFFER" })?;
        match self.still_mapped {
            0 => Ok(()),
            rounds => write!(formatter, "  still mapped after {rounds} rounds"),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Where the FMU cannot be built, a call fails, memory grows, or results differ.
pub fn execute(arguments: &Arguments) -> Result<()> {
    let share = |count: usize| if arguments.short { count / 500 } else { count };
    let [lumped, line] = [build("lumped")?, build("line")?];
    let mut outcomes = Vec::new();
    let mut note = |outcome: Outcome| {
        if !arguments.json {
            print_line!("{outcome}");
        }
        outcomes.push(outcome);
    };
    note(steps("steps, lumped", &lumped, share(arguments.lumped))?);
    note(steps("steps, contact line with resolved heat", &line, share(arguments.line))?);
    note(states("states saved and restored, lumped", &lumped, share(arguments.states))?);
    note(states("states saved and restored, contact line", &line, share(arguments.states))?);
    note(lives("loaded, run and unloaded, lumped", &lumped, share(arguments.rounds).max(LIVES))?);
    note(lives("loaded, run and unloaded, contact line", &line, share(arguments.rounds).max(LIVES))?);
    if arguments.json {
        print_line!("{}", serde_json::to_string_pretty(&outcomes)?);
    }
    let bad: Vec<String> = outcomes.iter().filter(|outcome| !outcome.is_good()).map(ToString::to_string).collect();
    ensure!(bad.is_empty(), "not as it should be:\n{}", bad.join("\n"));
    Ok(())
}

/// Library and GUID of the stock brake at a level.
type Built = (PathBuf, String);

fn build(level: &str) -> Result<Built> {
    let folder = project::target().join("soak").join(level);
    let changes = [format!("solver.fidelity={level}"), format!("solver.cells={CELLS}")];
    let fmu = package::build_changed(None, &changes, folder.join("SlidingContact.fmu"))?;
    bench::unpack(&fmu, &folder)
}

/// Inputs of a drive, over and over.
fn drive() -> Result<Vec<[f64; 2]>> {
    Ok(bench::drive(STEP)?.into_iter().map(|[velocity, load]| [SPEED * velocity, load]).collect())
}

/// Steps an instance and adds the bits of its outputs to a digest.
fn advance(
    instance: &Instance<'_>,
    variables: &Variables,
    inputs: impl Iterator<Item = [f64; 2]>,
    mut digest: Fnv,
) -> Result<Fnv> {
    for pair in inputs {
        let outputs = instance.exchange(variables, &pair, None, STEP)?;
        ensure!(outputs.iter().all(|value| value.is_finite()), "the outputs {outputs:?} are not finite");
        digest = outputs.iter().flat_map(|value| value.to_bits().to_le_bytes()).fold(digest, Fnv::with);
    }
    Ok(digest)
}

fn steps(what: &'static str, (library, guid): &Built, count: usize) -> Result<Outcome> {
    let begin = Instant::now();
    let component = Component::load(library, guid)?;
    let (variables, inputs) = (bench::variables()?, drive()?);
    let mut instance = component.instantiate()?;
    let mut round = || {
        instance.reset()?;
        instance.initialise()?;
        advance(&instance, &variables, inputs.iter().copied().cycle().take(count.div_ceil(ROUNDS)), Fnv::new())
    };
    let first = round()?.0;
    let before = resident();
    let mut is_same = true;
    for _ in 1..ROUNDS {
        is_same &= round()?.0 == first;
    }
    let memory = before.zip(resident()).map(|(before, after)| [before, after]);
    let count = ROUNDS * count.div_ceil(ROUNDS);
    Ok(Outcome { what, count, seconds: begin.elapsed().as_secs_f64(), memory, is_same, still_mapped: 0 })
}

/// Saves, steps, goes back, steps again, and goes on from there with the next inputs of the drive.
fn states(what: &'static str, (library, guid): &Built, count: usize) -> Result<Outcome> {
    let begin = Instant::now();
    let component = Component::load(library, guid)?;
    let (variables, inputs) = (bench::variables()?, drive()?);
    let mut instance = component.instantiate()?;
    instance.initialise()?;
    let (mut before, mut is_same) = (None, true);
    for number in 0..count {
        let ahead = inputs.iter().copied().cycle().skip(number % inputs.len()).take(2);
        let state = instance.state()?;
        let first = advance(&instance, &variables, ahead.clone(), Fnv::new())?.0;
        state.restore()?;
        is_same &= advance(&instance, &variables, ahead, Fnv::new())?.0 == first;
        if number == count / ROUNDS {
            before = resident();
        }
    }
    let memory = before.zip(resident()).map(|(before, after)| [before, after]);
    Ok(Outcome { what, count, seconds: begin.elapsed().as_secs_f64(), memory, is_same, still_mapped: 0 })
}

fn lives(what: &'static str, (library, guid): &Built, count: usize) -> Result<Outcome> {
    let begin = Instant::now();
    let (variables, inputs) = (bench::variables()?, drive()?);
    let (mut first, mut residents, mut is_same, mut still_mapped) = (None, Vec::new(), true, 0);
    for _ in 0..count {
        let component = Component::load(library, guid)?;
        let mut instance = component.instantiate()?;
        instance.initialise()?;
        let digest = advance(&instance, &variables, inputs.iter().copied().skip(1000).take(FEW), Fnv::new())?.0;
        drop(instance);
        drop(component);
        is_same &= *first.get_or_insert(digest) == digest;
        still_mapped += usize::from(is_mapped(library));
        residents.extend(resident());
    }
    let later = residents.iter().skip(residents.len() / 3);
    let least = residents.iter().zip(later).min_by_key(|(before, after)| *after - *before);
    let memory = least.map(|(&before, &after)| [before, after]);
    Ok(Outcome { what, count, seconds: begin.elapsed().as_secs_f64(), memory, is_same, still_mapped })
}

/// Resident memory of this process in KiB, where the system is Linux.
fn resident() -> Option<i64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Whether a library is part of this process, where the system is Linux.
fn is_mapped(library: &Path) -> bool {
    let path = fs::canonicalize(library).unwrap_or_else(|_| library.to_owned());
    fs::read_to_string("/proc/self/maps").is_ok_and(|maps| maps.contains(&*path.to_string_lossy()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_is_bad_where_memory_grows_results_differ_or_a_library_stays() {
        let good = |memory, is_same, still_mapped| {
            Outcome { what: "steps", count: 1, seconds: 1.0, memory, is_same, still_mapped }.is_good()
        };
        assert!(good(Some([9000, 9000 + GROWTH]), true, 0) && good(None, true, 0));
        assert!(!good(Some([9000, 9001 + GROWTH]), true, 0));
        assert!(!good(None, false, 0) && !good(None, true, 1));
    }
}
