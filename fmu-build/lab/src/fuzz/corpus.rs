//! The committed executions: tests/fuzz/corpus.txt, and files of inputs beside it.

use std::time::Duration;

use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use fmu_build::project;

use super::{Arguments, Kinds, Target, keep_panics, run, scenes, watchdog};
use crate::output::print_line;

/// Executes all of them in this process, under the watchdog.
pub(crate) fn replay(arguments: &Arguments) -> Result<()> {
    keep_panics();
    let limit = arguments.limit;
    watchdog::start(Duration::from_secs_f64(limit), move |function| {
        eprintln!("error: {function} takes longer than {limit} s");
        std::process::exit(1);
    });
    let (count, found) = run_all(&arguments.target, &mut Kinds::default())?;
    if !found.is_empty() {
        bail!("{}", found.join("\n"));
    }
    print_line!("{count} executions, nothing found");
    Ok(())
}

/// Executes those of some targets, or all: their number, and what was found.
pub(crate) fn run_all(targets: &[Target], kinds: &mut Kinds) -> Result<(usize, Vec<String>)> {
    let folder = project::root().join("tests").join("fuzz");
    let file = folder.join("corpus.txt");
    let text = std::fs::read_to_string(&file).with_context(|| format!("reading {}", file.display()))?;
    let mut found = Vec::new();
    let mut count = 0;
    for (at, line) in text.lines().enumerate() {
        let entry = line.split('#').next().unwrap_or("").trim();
        let Some((name, what)) = entry.split_once(' ') else {
            if entry.is_empty() {
                continue;
            }
            bail!("{}, line {}: {entry:?} is no target with a seed or a file", file.display(), at + 1);
        };
        let place = format!("{}, line {}: {entry}", file.display(), at + 1);
        let target = Target::from_str(name, false).map_err(|wrong| anyhow::anyhow!("{place}: {wrong}"))?;
        if !targets.is_empty() && !targets.contains(&target) {
            continue;
        }
        let verdict = match (what.parse(), target) {
            (Ok(seed), _) => run(target, seed, kinds),
            (Err(_), Target::Scenes) => {
                let text = std::fs::read_to_string(folder.join(what)).with_context(|| place.clone())?;
                scenes::check(&text, kinds)
            }
            _ => bail!("{place}: {what:?} is no seed"),
        };
        count += 1;
        found.extend(verdict.err().map(|text| format!("{place}: {text}")));
    }
    Ok((count, found))
}
