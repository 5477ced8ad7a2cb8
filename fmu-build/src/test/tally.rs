//! Steps of a test run and what they counted.

use crate::output::print_line;
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Format from which a step's results are counted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Counter {
    /// `test result: ok. 3 passed; 0 failed; 1 ignored; ...`, once per test binary.
    CargoTest,
    /// `==== 3 passed, 1 skipped in 2.00s ====`, at the end.
    Pytest,
}

/// Passed, failed and skipped tests of one line.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
struct Counts {
    passed: usize,
    failed: usize,
    skipped: usize,
}

impl Counts {
    fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

pub(crate) struct Tally {
    json: bool,
    steps: Vec<(String, Counts, f64)>,
    skipped: Vec<(String, String)>,
}

pub(crate) struct Step {
    json: bool,
    counts: Counts,
    skipped: Vec<String>,
}

impl Tally {
    /// Nothing counted yet; with `json` the log goes to the error stream.
    pub(crate) fn new(json: bool) -> Self {
        Self { json, steps: Vec::new(), skipped: Vec::new() }
    }

    /// Runs one step; where it ends with an error, that counts as a failure and the run goes on.
    pub(crate) fn step(&mut self, name: &str, work: impl FnOnce(&mut Step) -> Result<()>) {
        say(self.json, &format!("== {name}"));
        let begin = Instant::now();
        let mut step = Step { json: self.json, counts: Counts::default(), skipped: Vec::new() };
        if let Err(error) = work(&mut step) {
            say(self.json, &format!("{name} failed: {error:#}"));
            // Failures counted by the runner itself are not counted again.
            step.counts.failed = step.counts.failed.max(1);
        }
        self.skipped.extend(step.skipped.into_iter().map(|reason| (name.to_owned(), reason)));
        self.steps.push((name.to_owned(), step.counts, begin.elapsed().as_secs_f64()));
    }

    pub(crate) fn skip(&mut self, name: &str, reason: &str) {
        say(self.json, &format!("== {name}: skipped, {reason}"));
        self.steps.push((name.to_owned(), Counts { skipped: 1, ..Counts::default() }, 0.0));
        self.skipped.push((name.to_owned(), reason.to_owned()));
    }

    /// Prints the steps, what was skipped and why, and the closing line.
    pub(crate) fn close(self) -> Result<()> {
        let mut total = Counts::default();
        let width = self.steps.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
        say(self.json, "");
        for (name, counts, seconds) in &self.steps {
            total.add(*counts);
            let Counts { passed, failed, skipped } = counts;
            say(
                self.json,
                &format!("{name:width$}  {passed:4} passed {failed:3} failed {skipped:3} skipped  {seconds:6.1} s"),
            );
        }
        say(self.json, if self.skipped.is_empty() { "Nothing was skipped." } else { "Skipped:" });
        for (name, reason) in &self.skipped {
            say(self.json, &format!("  {name}: {reason}"));
        }
        if self.json {
            let steps: Vec<_> = self
                .steps
                .iter()
                .map(|(name, counts, seconds)| {
                    serde_json::json!({"name": name, "passed": counts.passed, "failed": counts.failed,
                                       "skipped": counts.skipped, "seconds": seconds})
                })
                .collect();
            let skipped: Vec<_> =
                self.skipped.iter().map(|(name, why)| serde_json::json!({"name": name, "reason": why})).collect();
            let all = serde_json::json!({"passed": total.passed, "failed": total.failed, "skipped": total.skipped,
                                         "steps": steps, "reasons": skipped});
            print_line!("{all:#}");
        } else {
            print_line!("{} passed, {} failed, {} skipped", total.passed, total.failed, total.skipped);
        }
        if total.failed > 0 {
            bail!("{} of {} failed", total.failed, total.passed + total.failed);
        }
        Ok(())
    }
}

impl Step {
    pub(crate) fn pass(&mut self) {
        self.counts.passed += 1;
    }

    /// Counts one measurement, shown as `text`.
    pub(crate) fn judge(&mut self, text: &str, holds: bool) {
        say(self.json, &format!("{text}{}", if holds { "" } else { "  FAILED" }));
        if holds {
            self.counts.passed += 1;
        } else {
            self.counts.failed += 1;
        }
    }

    /// Runs a program that reports only through its exit status.
    pub(crate) fn check(&mut self, command: Command) -> Result<()> {
        self.stream(command, |_, _| ())
    }

    pub(crate) fn run(&mut self, command: Command, counter: Counter) -> Result<()> {
        let result = self.stream(command, |step, line| {
            if let Some(counts) = counts_of(line, counter) {
                step.counts.add(counts);
            }
            if let Some(reason) = reason_of(line, counter) {
                step.skipped.push(reason);
            }
        });
        result?;
        if self.counts.passed == 0 {
            bail!("no test ran");
        }
        Ok(())
    }

    /// Shows a program's output line by line while `look` reads it.
    fn stream(&mut self, mut command: Command, mut look: impl FnMut(&mut Self, &str)) -> Result<()> {
        let name = command.get_program().to_string_lossy().into_owned();
        let mut child =
            command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().with_context(|| format!("starting {name}"))?;
        for line in BufReader::new(child.stdout.take().expect("stdout is piped")).split(b'\n') {
            let line = String::from_utf8_lossy(&line?).into_owned();
            say(self.json, &line);
            look(self, &line);
        }
        let status = child.wait()?;
        if !status.success() {
            let arguments: Vec<_> = command.get_args().map(|word| word.to_string_lossy()).collect();
            bail!("{name} {} ended with {status}", arguments.join(" "));
        }
        Ok(())
    }
}

fn say(json: bool, line: &str) {
    if json {
        eprintln!("{line}");
    } else {
        print_line!("{line}");
        // In order with what child processes write to the error stream.
        let _ = std::io::stdout().flush();
    }
}

fn counts_of(line: &str, counter: Counter) -> Option<Counts> {
    let (text, separator) = match counter {
        Counter::CargoTest => (line.strip_prefix("test result: ")?.split_once(". ")?.1, ';'),
        Counter::Pytest => {
            let text = line.strip_prefix('=')?.trim_matches('=').trim();
            (text.rsplit_once(" in ")?.0, ',')
        }
    };
    let mut counts = Counts::default();
    for part in text.split(separator) {
        let mut words = part.split_whitespace();
        let (Some(Ok(number)), Some(word)) = (words.next().map(str::parse::<usize>), words.next()) else { continue };
        match word {
            "passed" | "xpassed" => counts.passed += number,
            "failed" | "error" | "errors" => counts.failed += number,
            "ignored" | "skipped" | "deselected" | "xfailed" => counts.skipped += number,
            _ => {}
        }
    }
    (counts != Counts::default()).then_some(counts)
}

/// Reason for skipping a test.
fn reason_of(line: &str, counter: Counter) -> Option<String> {
    match counter {
        Counter::CargoTest => {
            let (name, why) = line.strip_prefix("test ")?.split_once(" ... ignored")?;
            Some(format!("{name}{}", if why.is_empty() { ": ignored" } else { why }))
        }
        Counter::Pytest => line.strip_prefix("SKIPPED ").map(str::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_of_the_runners_are_counted() {
        let cargo =
            "test result: FAILED. 12 passed; 2 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.01s";
        assert_eq!(counts_of(cargo, Counter::CargoTest), Some(Counts { passed: 12, failed: 2, skipped: 1 }));
        let pytest = "=========== 1 failed, 40 passed, 2 skipped, 3 warnings, 1 error in 12.34s ===========";
        assert_eq!(counts_of(pytest, Counter::Pytest), Some(Counts { passed: 40, failed: 2, skipped: 2 }));
        for line in ["=== test session starts ===", "running 3 tests", "=== no tests ran in 0.01s ==="] {
            assert_eq!(counts_of(line, Counter::Pytest), None, "{line}");
            assert_eq!(counts_of(line, Counter::CargoTest), None, "{line}");
        }
        assert_eq!(
            reason_of("test slow::one ... ignored, takes an hour", Counter::CargoTest).as_deref(),
            Some("slow::one, takes an hour")
        );
    }
}
