//! Two panels for a scene: errors of the main outputs and of the peak pressure against processor time, four series at most.

use super::measure::Point;
use super::{Chart, findings};
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use verification::drives::Quantity;

/// Errors below are drawn here.
const LEAST_SHOWN: f64 = 1e-6;

/// Families of the contact line at its full accuracy, of which the best settings are drawn.
const LINE: [&str; 4] = ["line, tolerance", "line, cells", "line, cells, 1e-3", "line, cells, 1e-2"];

/// Cost and error of the runs that know one of the quantities, by cost.
fn all<'a>(points: impl Iterator<Item = &'a Point>, quantities: &[Quantity]) -> Vec<(f64, f64)> {
    let mut runs: Vec<_> =
        points.filter_map(|point| Some((point.cost(), findings::worst(point, quantities)?))).collect();
    runs.sort_by(|one, next| one.0.total_cmp(&next.0).then(one.1.total_cmp(&next.1)));
    runs
}

/// Those of [`all`] for which none is both cheaper and more accurate.
fn best<'a>(points: impl Iterator<Item = &'a Point>, quantities: &[Quantity]) -> Vec<(f64, f64)> {
    let mut runs = all(points, quantities);
    let mut least = f64::INFINITY;
    runs.retain(|&(_, error)| {
        let better = error < least;
        least = least.min(error);
        better
    });
    runs
}

/// Cost and error of the runs of every method.
fn curves(chart: &Chart, quantities: &[Quantity]) -> Vec<Series> {
    let curve = |name: &str, runs, colour, mark| Series::line(name, runs).with(mark).coloured(colour);
    let line = chart.points.iter().filter(|point| LINE.contains(&point.family.as_str()));
    let family = |name: &'static str| all(chart.family(name), quantities);
    let mut curves = vec![
        curve("lumped, tolerance 1e-1 to 1e-5", family("lumped"), 0, Mark::LineAndPoints),
        curve("line, best of 9 to 65 cells at tolerance 1e-1 to 1e-4", best(line, quantities), 2, Mark::LineAndPoints),
        curve("auto, tolerance 1e-1 to 1e-4", family("auto"), 6, Mark::DashesAndSquares),
    ];
    let peers = || chart.points.iter().filter(|point| point.peer && !point.family.starts_with("this FMU"));
    if let Some(peer) = peers().next() {
        let name = peer.family.split(',').next().unwrap_or_default();
        curves.push(curve(&format!("{name}, best of its runs"), best(peers(), quantities), 1, Mark::DashesAndSquares));
    }
    curves.retain(|curve| !curve.points.is_empty());
    curves
}

/// The picture: the largest error of wear depth, contact temperature and friction force, and that of the peak pressure, which the
/// lumped level does not have.
pub(crate) fn draw(chart: &Chart) -> Figure {
    let kinds = [("wear, temperature and force", findings::MAIN), ("peak pressure", &[Quantity::PeakPressure][..])];
    let (mut key, mut panels) = (Vec::new(), Vec::new());
    for (title, quantities) in kinds {
        let mut curves = curves(chart, quantities);
        if !panels.is_empty() {
            curves.retain(|curve| !curve.name.starts_with("lumped"));
        }
        let runs = || curves.iter().flat_map(|curve| &curve.points);
        let costs = runs().fold((f64::INFINITY, 0.0_f64), |(low, high), run| (low.min(run.0), high.max(run.0)));
        let (low, high) = (0.6 * costs.0, 1.6 * costs.1);
        let least = runs().map(|run| run.1).fold(1e-3, f64::min).max(LEAST_SHOWN);
        let bound =
            if runs().any(|run| run.1 < LEAST_SHOWN) { format!(", {LEAST_SHOWN:e} at least") } else { String::new() };
        let mut series: Vec<Series> = Vec::new();
        for curve in curves {
            let points = curve.points.iter().map(|&(cost, error)| (cost, error.max(LEAST_SHOWN))).collect();
            series.push(Series { name: String::new(), points, ..curve });
            if panels.is_empty() {
                key.push(Series { points: Vec::new(), ..curve });
            }
        }
        series.push(Series::line("", vec![(low, 1e-2), (high, 1e-2)]).with(Mark::Thin).coloured(6));
        panels.push(Panel::new(
            title,
            Axis::logarithmic("processor time of the whole run (s)").over(low, high),
            Axis::logarithmic(format!("largest relative error{bound}")).over(0.6 * least, 1.5),
            series,
        ));
    }
    key.push(Series::line("1 % error", Vec::new()).with(Mark::Thin).coloured(6));
    // The part before the colon names the scene.
    let title = chart.problem.title.split(':').next().unwrap_or_default();
    Figure { key, height: 2.2, ..Figure::new(title, panels) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::drives::Errors;

    #[test]
    fn a_run_that_is_dearer_and_less_accurate_is_not_drawn() {
        let point = |cost: f64, error: f64| Point {
            family: "line, cells".into(),
            setting: String::new(),
            peer: false,
            seconds: [0.0, cost],
            steps: 1,
            errors: Errors([error, f64::NAN, 0.0, f64::NAN]),
            failure: None,
        };
        let points = [point(2.0, 1e-2), point(1.0, 5e-2), point(3.0, 2e-2), point(4.0, 1e-3)];
        assert_eq!(best(points.iter(), findings::MAIN), [(1.0, 5e-2), (2.0, 1e-2), (4.0, 1e-3)]);
        // The main outputs are not judged by the peak pressure.
        let lumped = Point { family: "lumped".into(), errors: Errors([1e-3, 2e-3, 0.0, 0.5]), ..point(1.0, 0.0) };
        assert_eq!(all([&lumped].into_iter(), findings::MAIN), [(1.0, 2e-3)]);
        assert_eq!(all([&lumped].into_iter(), &[Quantity::PeakPressure]), [(1.0, 0.5)]);
    }
}
