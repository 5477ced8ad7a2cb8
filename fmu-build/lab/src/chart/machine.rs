//! Machine and source version of the charts.

use crate::project;
use std::process::Command;

/// Processor, number of cores and operating system.
pub(crate) fn name() -> String {
    let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let (system, architecture) = (std::env::consts::OS, std::env::consts::ARCH);
    format!("{}, {cores} cores, {system} {architecture}", processor.unwrap_or_else(|| "unknown processor".into()))
}

/// Machine and source version of a chart.
pub(crate) fn measured(quick: bool) -> String {
    format!("{}; commit {}{}.", name(), commit(), if quick { " (--quick)" } else { "" })
}

/// The commit, with a mark where files differ from it; "unknown" outside a clone.
pub(crate) fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(project::root()).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) else { return "unknown".into() };
    // Files written by the charts themselves do not count as changes of the measured code.
    let changed = git(&["status", "--porcelain", "--untracked-files=no", "--", ".", ":!documentation", ":!docs"]);
    if changed.is_some_and(|files| !files.is_empty()) { format!("{commit} with changes") } else { commit }
}
