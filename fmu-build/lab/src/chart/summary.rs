//! One panel for a scene: largest error against processor time, five series at most.

use super::measure::Point;
use super::{Chart, findings};
use crate::plot::{Axis, Figure, Mark, Panel, Series};

/// Errors below are drawn here.
const LEAST: f64 = 1e-6;

/// Families of the contact line at its full accuracy, of which the best settings are drawn.
const LINE: [&str; 4] = ["line, tolerance", "line, cells", "line, cells, 1e-3", "line, cells, 1e-2"];

/// Largest error of the quantities that a run models; the lumped level has no peak pressure.
fn error(point: &Point) -> Option<f64> {
    let main = point.family == "lumped";
    findings::worst(point, if main { findings::MAIN } else { findings::ALL })
}

/// Cost and error of the runs for which none is both cheaper and more accurate.
fn best<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<(f64, f64)> {
    let mut runs: Vec<(f64, f64)> = points.filter_map(|point| Some((point.cost(), error(point)?))).collect();
    runs.sort_by(|one, next| one.0.total_cmp(&next.0).then(one.1.total_cmp(&next.1)));
    let mut least = f64::INFINITY;
    runs.retain(|&(_, error)| {
        let better = error < least;
        least = least.min(error);
        better
    });
    runs
}

/// All runs of a family by cost.
fn all(chart: &Chart, family: &str) -> Vec<(f64, f64)> {
    let mut runs: Vec<(f64, f64)> =
        chart.family(family).filter_map(|point| Some((point.cost(), error(point)?))).collect();
    runs.sort_by(|one, next| one.0.total_cmp(&next.0));
    runs
}

/// The picture.
pub fn draw(chart: &Chart) -> Figure {
    let line = best(chart.points.iter().filter(|point| LINE.contains(&point.family.as_str())));
    let mut series = vec![
        (
            "lumped (without peak pressure), tolerance 1e-1 to 1e-5".to_owned(),
            all(chart, "lumped"),
            0,
            Mark::LineAndPoints,
        ),
        ("line, best of 9 to 65 cells at tolerance 1e-1 to 1e-4".to_owned(), line, 2, Mark::LineAndPoints),
        ("auto, tolerance 1e-1 to 1e-4".to_owned(), all(chart, "auto"), 6, Mark::DashesAndSquares),
        (
            "operator split, 33 cells, tolerance 1e-4, by step".to_owned(),
            all(chart, "staggered"),
            5,
            Mark::DashesAndSquares,
        ),
    ];
    let peers: Vec<&Point> =
        chart.points.iter().filter(|point| point.peer && !point.family.starts_with("this FMU")).collect();
    series.push(match peers.first() {
        Some(peer) => {
            let name = peer.family.split(',').next().unwrap_or_default();
            (format!("{name}, best of its runs"), best(peers.iter().copied()), 1, Mark::DashesAndSquares)
        }
        None => (
            "explicit wear, 33 cells, tolerance 1e-4, by step".to_owned(),
            all(chart, "explicit"),
            1,
            Mark::DashesAndSquares,
        ),
    });
    series.retain(|(_, points, ..)| !points.is_empty());
    let points = || series.iter().flat_map(|(_, points, ..)| points);
    let costs = points().fold((f64::INFINITY, 0.0_f64), |(low, high), point| (low.min(point.0), high.max(point.0)));
    let (low, high) = (0.6 * costs.0, 1.6 * costs.1);
    let least = points().map(|point| point.1).fold(1e-3, f64::min).max(LEAST);
    let mut key: Vec<Series> = Vec::new();
    let mut curves: Vec<Series> = Vec::new();
    for (name, points, colour, mark) in series {
        key.push(Series::line(name, Vec::new()).with(mark).coloured(colour));
        let shown = points.into_iter().map(|(cost, error)| (cost, error.max(LEAST))).collect();
        curves.push(Series::line("", shown).with(mark).coloured(colour));
    }
    key.push(Series::line("1 % error", Vec::new()).with(Mark::Dashes).coloured(6));
    curves.push(Series::line("", vec![(low, 1e-2), (high, 1e-2)]).with(Mark::Dashes).coloured(6));
    // The part before the colon names the scene.
    let title = chart.problem.title.split(':').next().unwrap_or_default();
    let panel = Panel::new(
        "",
        Axis::logarithmic("processor time of the whole run (s)").over(low, high),
        Axis::logarithmic("largest relative error").over(0.6 * least, 1.5),
        curves,
    );
    Figure { columns: 1, key, panel_size: (820, 380), ..Figure::new(title, vec![panel]) }
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
        assert_eq!(best(points.iter()), [(1.0, 5e-2), (2.0, 1e-2), (4.0, 1e-3)]);
        // The lumped level is not judged by a peak pressure that it does not have.
        let lumped = Point { family: "lumped".into(), errors: Errors([1e-3, 2e-3, 0.0, 0.5]), ..point(1.0, 0.0) };
        assert_eq!(error(&lumped), Some(2e-3));
    }
}
