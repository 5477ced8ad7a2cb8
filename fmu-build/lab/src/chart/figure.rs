//! The picture of a scene: error of each quantity against processor time and against internal steps.

use super::measure::Point;
use super::{Chart, table};
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use verification::drives::Quantity;

type Cost = fn(&Point) -> f64;

/// Errors below are drawn here.
const LEAST_ERROR: f64 = 1e-8;
/// Height at which runs that did not finish are marked.
const FAILED: f64 = 1.5;
const HIGHEST: f64 = 3.0;

/// Colour of a family in the order of the plot's palette, and how it is drawn.
fn look(name: &str, peer: bool) -> (usize, Mark) {
    match name {
        "auto" => (6, Mark::LineAndPoints),
        "lumped" => (0, Mark::LineAndPoints),
        "lumped, inputs held" => (0, Mark::DashesAndSquares),
        "line, tolerance" => (2, Mark::LineAndPoints),
        "line, cells" => (5, Mark::LineAndPoints),
        "line, cells, 1e-3" => (5, Mark::DashesAndSquares),
        "line, cells, 1e-2" => (5, Mark::Points),
        "line, inputs held" => (2, Mark::DashesAndSquares),
        "line, isothermal" => (6, Mark::DashesAndSquares),
        // Recorded charts only.
        "explicit" => (4, Mark::LineAndPoints),
        "staggered" => (4, Mark::DashesAndSquares),
        "field" => (3, Mark::LineAndPoints),
        _ if peer && (name.contains("this FMU") || name.contains("Euler")) => (3, Mark::DashesAndSquares),
        _ => (1, Mark::DashesAndSquares),
    }
}

pub(crate) fn draw(chart: &Chart) -> Figure {
    let costs: [(&str, Cost); 2] =
        [("processor time of the whole run (s)", Point::cost), ("internal time steps", |point| point.steps as f64)];
    let mut panels = Vec::new();
    for quantity in Quantity::ALL {
        for (label, cost) in costs {
            panels.push(panel(chart, quantity, label, cost));
        }
    }
    let varied: Vec<(String, String)> = chart
        .problem
        .families(chart.quick)
        .iter()
        .map(|family| (family.name.to_owned(), format!("{}: {}", family.name, family.varied)))
        .collect();
    let mut key: Vec<Series> = Vec::new();
    for name in chart.families() {
        let peer = chart.family(name).any(|point| point.peer);
        let (colour, mark) = look(name, peer);
        let text = varied.iter().find(|(own, _)| own == name).map_or_else(|| name.to_owned(), |(_, text)| text.clone());
        key.push(Series::line(text, Vec::new()).with(mark).coloured(colour));
    }
    if chart.points.iter().any(|point| point.failure.is_some()) {
        key.push(Series::line("did not come to its end, in its colour", Vec::new()).with(Mark::Crosses).coloured(6));
    }
    key.push(Series::line("1 % error", Vec::new()).with(Mark::Thin).coloured(6));
    Figure { key, height: 1.4, ..Figure::new(chart.problem.title, panels).with_header(table::header(chart)) }
}

fn panel(chart: &Chart, quantity: Quantity, label: &str, cost: Cost) -> Panel {
    let mut series = Vec::new();
    for name in chart.families() {
        let peer = chart.family(name).any(|point| point.peer);
        let (colour, mark) = look(name, peer);
        let place = |point: &Point| Some((cost(point), point.error(quantity)?.clamp(LEAST_ERROR, HIGHEST)));
        let points: Vec<(f64, f64)> = chart.family(name).filter_map(place).collect();
        let failed: Vec<(f64, f64)> =
            chart.family(name).filter(|point| point.failure.is_some()).map(|point| (cost(point), FAILED)).collect();
        if !points.is_empty() {
            series.push(Series::line("", points).with(mark).coloured(colour));
        }
        if !failed.is_empty() {
            series.push(Series::line("", failed).with(Mark::Crosses).coloured(colour));
        }
    }
    let costs = chart.points.iter().map(cost).filter(|cost| *cost > 0.0);
    let (low, high) = costs.fold((f64::INFINITY, 0.0_f64), |(low, high), cost| (low.min(cost), high.max(cost)));
    let (low, high) = if low < high { (0.7 * low, 1.4 * high) } else { (0.5 * high.max(1e-6), 2.0 * high.max(1e-6)) };
    series.push(Series::line("", vec![(low, 1e-2), (high, 1e-2)]).with(Mark::Thin).coloured(6));
    let errors = chart.points.iter().filter_map(|point| point.error(quantity));
    let least = errors.fold(1e-3, f64::min).max(LEAST_ERROR);
    Panel::new(
        quantity.to_string(),
        Axis::logarithmic(label).over(low, high),
        Axis::logarithmic(format!("error / {}", quantity.relative_to())).over(0.6 * least, HIGHEST),
        series,
    )
}
