//! Findings of a chart: the cheapest settings within 1 %, their cost, and the cost ratios of the peers.

use super::Chart;
use super::measure::Point;
use serde_json::{Value, json};
use std::fmt;
use verification::drives::{FORMER, Quantity};

/// Error that a setting must reach.
const WANTED: f64 = 1e-2;

pub(crate) struct Findings {
    /// The cheapest run within 1 % in wear depth, contact temperature and friction force.
    pub right: Option<Reached>,
    /// The cheapest within 1 % in all four.
    pub with_pressure: Option<Reached>,
    /// Model errors of the lumped level (wear depth, contact temperature, friction force), independent of its tolerance.
    pub lumped: Option<[f64; 3]>,
    /// Of every run of a peer: its error and cost, and the cheapest own run that is at least as accurate.
    pub peers: Vec<(Reached, Reached)>,
    omissions: Vec<String>,
}

pub(crate) struct Reached {
    pub family: String,
    pub setting: String,
    /// Largest error; NaN where it did not finish.
    pub error: f64,
    /// Processor time, s.
    pub cost: f64,
}

fn reached(point: &Point, error: f64) -> Reached {
    Reached { family: point.family.clone(), setting: point.setting.clone(), error, cost: point.cost() }
}

/// The quantities to which `solver.tolerance` refers.
pub(crate) const MAIN: &[Quantity] = &[Quantity::WearDepth, Quantity::ContactTemperature, Quantity::FrictionForce];

/// Largest error of the quantities that are judged; `None` where the run did not finish.
pub(crate) fn worst(point: &Point, quantities: &[Quantity]) -> Option<f64> {
    if point.failure.is_some() {
        return None;
    }
    let errors = quantities.iter().filter_map(|&quantity| point.error(quantity));
    errors.fold(None, |worst: Option<f64>, error| Some(worst.map_or(error, |worst| worst.max(error))))
}

/// The cheapest own run (of a method that the component has) whose error over `quantities` is at most `most`; it models all of
/// them that the reference has.
fn cheapest(chart: &Chart, quantities: &[Quantity], most: f64) -> Option<Reached> {
    let judged = |quantity: &Quantity| chart.points.iter().any(|point| point.error(*quantity).is_some());
    let quantities: Vec<Quantity> = quantities.iter().copied().filter(judged).collect();
    let models_all = |point: &&Point| quantities.iter().all(|&quantity| point.error(quantity).is_some());
    let shipped = |point: &&Point| !point.peer && !FORMER.contains(&point.family.as_str());
    let own = chart.points.iter().filter(shipped).filter(models_all);
    let good = own.filter_map(|point| worst(point, &quantities).filter(|error| *error <= most).map(|e| (point, e)));
    good.min_by(|a, b| a.0.cost().total_cmp(&b.0.cost())).map(|(point, error)| reached(point, error))
}

pub(crate) fn of(chart: &Chart) -> Findings {
    let main = MAIN;
    let lumped = chart.family("lumped").filter_map(|point| Some((point, worst(point, main)?)));
    let lumped = lumped.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(point, _)| {
        let mut errors = [f64::NAN; 3];
        errors.iter_mut().zip(main).for_each(|(error, &quantity)| *error = point.error(quantity).unwrap_or(f64::NAN));
        errors
    });
    let peers = chart.points.iter().filter(|point| point.peer && !point.family.contains("FMU")).filter_map(|point| {
        // A peer is compared in the quantities that it models.
        let modelled: Vec<Quantity> = Quantity::ALL.into_iter().filter(|&q| point.error(q).is_some()).collect();
        let error = worst(point, &modelled)?;
        Some((reached(point, error), cheapest(chart, &modelled, error)?))
    });
    Findings {
        right: cheapest(chart, main, WANTED),
        with_pressure: cheapest(chart, &Quantity::ALL, WANTED),
        lumped,
        peers: peers.chain(in_importer(chart)).collect(),
        omissions: chart.omissions.clone(),
    }
}

/// Peers that run in the same importer as the FMU are compared with it there, at the same communication step.
fn in_importer(chart: &Chart) -> Vec<(Reached, Reached)> {
    let (own, others): (Vec<&Point>, Vec<&Point>) =
        chart.points.iter().filter(|p| p.peer && p.family.contains("FMU")).partition(|p| p.family.starts_with("this"));
    let run = |point: &Point| reached(point, worst(point, MAIN).unwrap_or(f64::NAN));
    let pair = |other: &&Point| own.iter().find(|own| own.setting == other.setting).map(|own| (run(other), run(own)));
    others.iter().filter_map(pair).collect()
}

impl fmt::Display for Reached {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = if self.error.is_finite() { format!("error {:.1e}, ", self.error) } else { String::new() };
        write!(formatter, "{} ({}): {error}{}", self.family, self.setting, time(self.cost))
    }
}

pub(crate) fn time(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", significant(factor * seconds))
}

/// A positive number with three digits, as far as they are behind the point.
pub(crate) fn significant(number: f64) -> String {
    let decimals = (2.0 - number.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{number:.decimals$}")
}

/// The errors that were judged, by quantity.
pub(crate) fn lumped_errors(errors: [f64; 3]) -> String {
    let named = ["wear", "temperature", "force"].iter().zip(errors).filter(|(_, error)| error.is_finite());
    named.map(|(name, error)| format!("{name} {error:.1e}")).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for Findings {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = |found: &Option<Reached>| found.as_ref().map_or("nothing".into(), Reached::to_string);
        writeln!(formatter, "  1 % of wear, temperature and force: {}", line(&self.right))?;
        writeln!(formatter, "  1 % of the peak pressure as well:   {}", line(&self.with_pressure))?;
        if let Some([wear, temperature, force]) = self.lumped {
            writeln!(formatter, "  lumped, whatever its tolerance:     {}", lumped_errors([wear, temperature, force]))?;
        }
        let mut rest = self.peers.as_slice();
        // Runs of a family follow each other, from coarse to fine.
        while let Some((first, _)) = rest.first() {
            let count = rest.iter().take_while(|(peer, _)| peer.family == first.family).count();
            let (runs, after) = rest.split_at(count);
            let ratios = || runs.iter().map(|(peer, own)| peer.cost / own.cost);
            let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
            writeln!(formatter, "  {least:.1} to {most:.1} times the cost: {}", first.family)?;
            for (peer, own) in runs {
                writeln!(formatter, "    {:.1}: {peer}; here {own}", peer.cost / own.cost)?;
            }
            rest = after;
        }
        self.omissions.iter().try_for_each(|text| writeln!(formatter, "  left out: {text}"))
    }
}

impl Findings {
    pub(crate) fn record(&self, chart: &Chart) -> Value {
        // What is not finite becomes null.
        let run = |found: &Reached| json!({ "family": found.family, "setting": found.setting, "error": found.error, "seconds": found.cost });
        let mut record = json!({
            "scene": chart.problem.name,
            "title": chart.problem.title,
            "truth": chart.how,
            "omissions": chart.omissions,
        });
        record["within_1_percent"] = self.right.as_ref().map_or(Value::Null, run);
        record["within_1_percent_with_pressure"] = self.with_pressure.as_ref().map_or(Value::Null, run);
        record["lumped"] = self.lumped.map_or(Value::Null, |[wear, temperature, force]| {
            json!({ "error_wear_depth": wear, "error_contact_temperature": temperature, "error_friction_force": force })
        });
        let pair = |(peer, own): &(Reached, Reached)| json!({ "peer": run(peer), "own": run(own), "ratio": peer.cost / own.cost });
        record["peers"] = self.peers.iter().map(pair).collect();
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::drives::{Errors, problems};

    #[test]
    fn only_runs_that_model_what_is_asked_are_compared() {
        let problem = problems().unwrap().swap_remove(0);
        let point = |family: &str, cost: f64, errors: [f64; 4]| Point {
            family: family.into(),
            setting: String::new(),
            peer: family == "peer",
            seconds: [0.0, cost],
            steps: 1,
            errors: Errors(errors),
            failure: None,
        };
        let points = vec![
            point("with heat", 10.0, [1e-3, 2e-3, f64::NAN, 5e-3]),
            point("isothermal", 1.0, [1e-3, f64::NAN, f64::NAN, 5e-3]),
            point("peer", 200.0, [1e-3, f64::NAN, f64::NAN, 5e-3]),
            point("staggered", 0.5, [1e-3, 2e-3, f64::NAN, 5e-3]),
            point("lumped", 0.1, [1e-3, 0.3, f64::NAN, 0.5]),
            point("lumped", 0.2, [2e-3, 0.1, f64::NAN, 0.5]),
        ];
        let chart = Chart {
            problem,
            how: String::new(),
            data: String::new(),
            measured: String::new(),
            points,
            omissions: Vec::new(),
            quick: false,
        };
        // The reference of this chart has no force; a run without temperature does not qualify for the first finding.
        let findings = of(&chart);
        assert_eq!(findings.right.as_ref().unwrap().family, "with heat");
        assert!(
            matches!(findings.lumped, Some([wear, temperature, force]) if wear == 2e-3 && temperature == 0.1 && force.is_nan())
        );
        assert!(findings.to_string().contains("lumped, whatever its tolerance:     wear 2.0e-3, temperature 1.0e-1"));
        let (peer, own) = &findings.peers[0];
        assert_eq!((own.family.as_str(), peer.cost / own.cost), ("isothermal", 200.0));
    }
}
