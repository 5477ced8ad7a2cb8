//! Runs the settings of a family and takes their time.

use super::Chart;
use verification::clock::process_seconds;
use verification::drives::{DriveProblem, Ending, Errors, Family, Quantity, Record, Sample, Setting};

/// Time budgets of runs.
pub(crate) struct Budget {
    /// Of a run on the chart, s.
    pub run: f64,
    /// Of a reference run, s.
    pub truth: f64,
    /// Largest total time of the repeated measurements of a short run, s.
    pub repeats: f64,
}

impl Budget {
    pub(crate) fn new(quick: bool) -> Self {
        if quick { Self { run: 0.5, truth: 6.0, repeats: 0.02 } } else { Self { run: 4.0, truth: 40.0, repeats: 0.1 } }
    }
}

#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Point {
    pub family: String,
    pub setting: String,
    pub peer: bool,
    /// Processor time of the initialisation and of the whole run, s.
    pub seconds: [f64; 2],
    pub steps: u64,
    /// Errors; NaN: not judged.
    pub errors: Errors,
    /// Reason why it did not finish, and the fraction of the scene that it completed.
    pub failure: Option<(String, f64)>,
}

impl Point {
    /// Processor time of the whole run, s.
    pub(crate) fn cost(&self) -> f64 {
        self.seconds[1]
    }

    /// Error of a quantity that belongs on a chart.
    pub(crate) fn error(&self, quantity: Quantity) -> Option<f64> {
        (self.failure.is_none() && !self.errors.of(quantity).is_nan()).then(|| self.errors.of(quantity))
    }
}

/// A run with its processor time on all threads: an initialisation runs on one of its own.
fn timed(problem: &DriveProblem, setting: &Setting, budget: f64) -> Record {
    problem.run(setting, &process_seconds, budget)
}

/// Adds the family's runs to the chart: those that are refused to its omissions.
pub(crate) fn family(chart: &mut Chart, family: &Family, truth: &[Sample], budget: &Budget) {
    let duration = chart.problem.samples.last().copied().unwrap_or(1.0);
    let mut refused: Vec<String> = Vec::new();
    // A finer setting is skipped where a coarser one already exceeded the budget.
    let mut exhausted = false;
    for setting in &family.settings {
        if exhausted {
            chart.omissions.push(format!("{setting}: a coarser one already took more than {} s", budget.run));
            continue;
        }
        let mut record = timed(&chart.problem, setting, budget.run);
        let reached = match &record.ending {
            Ending::Refused(text) => {
                if !refused.contains(text) {
                    refused.push(text.clone());
                }
                continue;
            }
            Ending::Finished => duration,
            Ending::Failed(time, _) | Ending::Stopped(time) => *time,
        };
        if record.ending == Ending::Finished {
            repeat(chart, &mut record, budget);
        }
        exhausted = matches!(record.ending, Ending::Stopped(_));
        let failure = match &record.ending {
            Ending::Failed(_, text) => Some((text.clone(), reached / duration)),
            Ending::Stopped(_) => Some((format!("took more than {} s", budget.run), reached / duration)),
            _ => None,
        };
        let point = Point {
            family: family.name.into(),
            setting: setting.to_string(),
            peer: false,
            seconds: [record.seconds[0], record.cost()],
            steps: record.tried(),
            errors: Errors([f64::NAN; 4]),
            failure,
        };
        chart.judge(point, &record.samples, truth);
    }
    chart.omissions.extend(refused.into_iter().map(|text| format!("{}: {text}", family.name)));
}

/// Repeats a short run and keeps the fastest: nothing makes a run faster than it is.
fn repeat(chart: &Chart, record: &mut Record, budget: &Budget) {
    let mut spent = record.cost();
    while spent < budget.repeats {
        let again = timed(&chart.problem, &record.setting, f64::INFINITY);
        spent += again.cost().max(1e-6);
        if again.cost() < record.cost() {
            record.seconds = again.seconds;
        }
    }
}
