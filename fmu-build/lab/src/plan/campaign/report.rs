//! Report of a campaign: a line for every trial, and the summary statistics with their targets.

use std::fmt::Write as _;

use serde_json::{Value, json};
use verification::applications::trial::largest;

use super::{Outcome, TOLERANCES, Trial, Tried};
use crate::chart::machine;

/// Values of `estimated_error` from here on mean that the error is unknown.
const UNKNOWN: f64 = 0.999;

/// A trial whose errors are known, with the largest of them.
struct Known<'a> {
    trial: &'a Trial,
    outcome: &'a Outcome,
    error: f64,
    /// Uncertainty of the error due to the reference's own error.
    doubt: f64,
}

impl Known<'_> {
    fn met(&self) -> bool {
        self.error <= self.trial.tolerance
    }

    /// Whether the tolerance is missed by more than a factor of 2 without the estimate showing it.
    fn silently_missed(&self) -> bool {
        let error = self.error - self.doubt;
        error > 2.0 * self.trial.tolerance && self.outcome.estimated < (0.5 * error).min(UNKNOWN)
    }

    fn too_small_by(&self, factor: f64) -> bool {
        factor * self.outcome.estimated < self.error - self.doubt && self.outcome.estimated < UNKNOWN
    }

    fn too_large_by(&self, factor: f64) -> bool {
        self.outcome.estimated > factor * (self.error + self.doubt)
    }

    fn cost_ratio(&self) -> Option<f64> {
        self.trial.cheapest().map(|cheapest| self.outcome.work / cheapest.work)
    }
}

fn known<'a>(tried: &'a Tried, trial: &'a Trial) -> Option<Known<'a>> {
    let outcome = trial.auto.as_ref().ok()?;
    if !tried.converges() {
        return None;
    }
    let (error, doubt) = (largest(outcome.errors), largest(tried.truth_errors));
    // A reference that is not accurate enough for the tolerance still shows a clear miss.
    (trial.is_judged() || error - doubt > trial.tolerance).then_some(Known { trial, outcome, error, doubt })
}

/// The lines of a scene, one for every tolerance.
pub fn lines(tried: &Tried) -> Vec<String> {
    let line = |trial: &Trial| {
        let mut text =
            format!("{:3} {:14} V/Vc {:4.2} {:.0e}", tried.index, tried.name, tried.speed_ratio, trial.tolerance);
        let outcome = match &trial.auto {
            Ok(outcome) => outcome,
            Err(reason) => {
                let _ = write!(text, " FAILED: {reason}");
                return text;
            }
        };
        let _ = write!(text, " {:22}", outcome.level);
        match known(tried, trial) {
            Some(known) => {
                let ratio = known.error / trial.tolerance;
                let verdict = if known.met() { "met   " } else { "MISSED" };
                let _ = write!(
                    text,
                    " {verdict} error {:.1e} ({ratio:5.2} of tolerance), estimate {:.1e} ({:.2} of error, on the way {:.2})",
                    known.error,
                    outcome.estimated,
                    outcome.estimated / known.error.max(1e-12),
                    outcome.lowest_on_the_way
                );
                match trial.cheapest() {
                    Some(cheapest) => {
                        let _ = write!(
                            text,
                            ", work {:.2} of {}, {:.2} s of {:.2} s",
                            outcome.work / cheapest.work,
                            cheapest.setting,
                            outcome.seconds,
                            cheapest.seconds
                        );
                    }
                    None => {
                        let _ = write!(text, ", no fixed setting meets it, {:.2} s", outcome.seconds);
                    }
                }
            }
            None => {
                let _ = write!(
                    text,
                    " truth only to {:.1e}, error {:.1e}, estimate {:.1e}",
                    largest(tried.truth_errors),
                    largest(outcome.errors),
                    outcome.estimated
                );
            }
        }
        let _ = write!(text, ", planning {:.0} ms", 1e3 * outcome.planning);
        text
    };
    tried.trials.iter().map(line).collect()
}

/// A statistic with its target.
pub struct Asked {
    text: String,
    /// Counted, of how many.
    count: [usize; 2],
    /// Least part of them, or the most that may be.
    bound: Bound,
    tolerance: Option<f64>,
}

enum Bound {
    AtLeast(f64),
    None,
}

impl Asked {
    fn passes(&self) -> bool {
        let [count, of] = self.count;
        match self.bound {
            Bound::AtLeast(part) => count as f64 >= part * of as f64,
            Bound::None => count == 0,
        }
    }
}

impl std::fmt::Display for Asked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [count, of] = self.count;
        let asked = match self.bound {
            Bound::AtLeast(part) => format!("{:.0} % required", 100.0 * part),
            Bound::None => "none required".into(),
        };
        let at = self.tolerance.map_or(String::new(), |tolerance| format!("{tolerance:.0e}: "));
        let part = if of > 0 { 100.0 * count as f64 / of as f64 } else { 0.0 };
        let verdict = if self.passes() { "ok    " } else { "NOT OK" };
        write!(f, "{verdict} {at}{} {count} of {of} ({part:.0} %, {asked})", self.text)
    }
}

/// The summary statistics.
pub fn summary(all: &[Tried]) -> Vec<Asked> {
    let mut asked = Vec::new();
    let mut add = |tolerance: Option<f64>, text: &str, count: usize, of: usize, bound: Bound| {
        asked.push(Asked { text: text.into(), count: [count, of], bound, tolerance });
    };
    for tolerance in TOLERANCES {
        let trials = || {
            all.iter()
                .flat_map(move |tried| tried.trials.iter().map(move |trial| (tried, trial)))
                .filter(move |(_, trial)| trial.tolerance == tolerance)
        };
        let judged: Vec<Known> = trials().filter_map(|(tried, trial)| known(tried, trial)).collect();
        let failed = trials().filter(|(_, trial)| trial.auto.is_err()).count();
        let count = |is: &dyn Fn(&Known) -> bool| judged.iter().filter(|known| is(known)).count();
        let (of, at) = (judged.len(), Some(tolerance));
        let part = if tolerance < 5e-3 { 0.9 } else { 0.95 };
        add(at, "met by", count(&|known| known.met()), of + failed, Bound::AtLeast(part));
        add(at, "runs that failed", failed, of + failed, Bound::None);
        add(at, "missed more than twice without saying so", count(&|known| known.silently_missed()), of, Bound::None);
        let honest = count(&|known| !known.too_small_by(5.0) && !known.too_large_by(5.0));
        add(at, "estimated_error within a factor 5 in", honest, of, Bound::AtLeast(0.9));
        add(
            at,
            "estimated_error too small by more than 10 in",
            count(&|known| known.too_small_by(10.0)),
            of,
            Bound::None,
        );
        let costs: Vec<f64> = judged.iter().filter_map(Known::cost_ratio).collect();
        let cheap = costs.iter().filter(|ratio| **ratio <= 2.0).count();
        add(
            at,
            "stepping work at most twice that of the cheapest fixed setting in",
            cheap,
            costs.len(),
            Bound::AtLeast(0.9),
        );
        let open: Vec<&Outcome> = trials()
            .filter(|(tried, _)| !tried.converges())
            .filter_map(|(_, trial)| trial.auto.as_ref().ok())
            .collect();
        let said = open.iter().filter(|outcome| outcome.estimated >= UNKNOWN).count();
        add(at, "estimated_error is 1 where the truth does not converge in", said, open.len(), Bound::AtLeast(1.0));
    }
    // Named levels: their error is estimated, or marked as unknown.
    let named: Vec<(f64, f64)> = all
        .iter()
        .filter(|tried| tried.converges())
        .flat_map(|tried| tried.trials.iter().map(move |trial| (tried, trial)))
        .filter(|(_, trial)| trial.is_judged())
        .flat_map(|(tried, trial)| {
            let doubt = largest(tried.truth_errors);
            trial.fixed.iter().map(move |fixed| (fixed.estimated, largest(fixed.errors) - doubt))
        })
        .collect();
    let unknown = named.iter().filter(|(estimated, _)| *estimated >= UNKNOWN).count();
    let small = named.iter().filter(|(estimated, error)| *estimated < UNKNOWN && 10.0 * estimated < *error).count();
    add(None, "named levels: estimated_error too small by more than 10 in", small, named.len() - unknown, Bound::None);
    add(None, "named levels: estimated_error is 1 in", unknown, named.len(), Bound::AtLeast(0.0));
    asked
}

/// The table for a file.
pub fn table(all: &[Tried], left_out: &[String]) -> String {
    let mut text = format!(
        "# solver.fidelity = auto on scenes as users build them; errors against a run of truth_cells, whose own errors are \
         truth_wear to truth_force.\n\
         # Errors of wear depth (of the most worn), contact temperature (of the peak rise), friction force (of its peak).\n\
         # {}; commit {}.\n",
        machine::name(),
        machine::commit()
    );
    left_out.iter().for_each(|reason| text.push_str(&format!("# left out: {reason}\n")));
    text.push_str(
        "scene,tolerance,setting,level,error_wear,error_temperature,error_force,estimated_error,lowest_on_the_way,steps,work_us,seconds,\
         planning_seconds,truth_cells,truth_wear,truth_temperature,truth_force\n",
    );
    for tried in all {
        let [wear, temperature, force] = tried.truth_errors;
        let truth = format!("{},{wear:.2e},{temperature:.2e},{force:.2e}", tried.cells);
        for trial in &tried.trials {
            let begin = format!("{},{:e}", tried.name, trial.tolerance);
            match &trial.auto {
                Ok(auto) => {
                    let [wear, temperature, force] = auto.errors;
                    let _ = writeln!(
                        text,
                        "{begin},auto,\"{}\",{wear:.2e},{temperature:.2e},{force:.2e},{:.2e},{:.2e},{},{:.0},{:.2e},{:.2e},{truth}",
                        auto.level,
                        auto.estimated,
                        auto.lowest_on_the_way,
                        auto.steps,
                        auto.work,
                        auto.seconds,
                        auto.planning
                    );
                }
                Err(reason) => {
                    let _ = writeln!(text, "# {begin}: auto failed: {reason}");
                }
            }
            for fixed in &trial.fixed {
                let [wear, temperature, force] = fixed.errors;
                let _ = writeln!(
                    text,
                    "{begin},{},,{wear:.2e},{temperature:.2e},{force:.2e},{:.2e},,{},{:.0},{:.2e},,{truth}",
                    fixed.setting, fixed.estimated, fixed.steps, fixed.work, fixed.seconds
                );
            }
        }
    }
    text
}

/// The same for machines.
pub fn record(all: &[Tried], left_out: &[String], summary: &[Asked]) -> Value {
    let scenes: Vec<Value> = all
        .iter()
        .map(|tried| {
            let trials: Vec<Value> = tried
                .trials
                .iter()
                .map(|trial| {
                    let auto = match &trial.auto {
                        Ok(auto) => json!({
                            "level": auto.level, "errors": auto.errors, "estimated_error": auto.estimated,
                            "lowest_on_the_way": auto.lowest_on_the_way, "steps": auto.steps,
                            "work_microseconds": auto.work, "seconds": auto.seconds, "planning_seconds": auto.planning,
                        }),
                        Err(reason) => json!({ "failed": reason }),
                    };
                    json!({
                        "tolerance": trial.tolerance, "judged": trial.judged, "auto": auto, "fixed": trial.fixed,
                        "cheapest": trial.cheapest().map(|fixed| fixed.setting.clone()),
                    })
                })
                .collect();
            json!({
                "scene": tried.name, "index": tried.index, "speed_ratio": tried.speed_ratio, "truth_cells": tried.cells, "truth_errors": tried.truth_errors,
                "converges": tried.converges(), "trials": trials,
            })
        })
        .collect();
    let asked: Vec<Value> = summary
        .iter()
        .map(|asked| {
            json!({ "number": asked.text, "tolerance": asked.tolerance, "count": asked.count[0], "of": asked.count[1],
                    "passes": asked.passes() })
        })
        .collect();
    json!({ "scenes": scenes, "left_out": left_out, "asked": asked })
}
