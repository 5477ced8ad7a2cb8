//! Stability maps: ranges in which a method is accurate, oscillates, diverges or is refused, over the governing parameters,
//! with the theoretical bound. Drawn by `cargo fmu stability`.
//!
//! A map is data: panels of judged points and curves. A new map is a module beside this file and a line in [`maps`].
//!
//! Theory: docs/theory.md, section 7.

pub mod conductance;
pub(crate) mod conductivity;
pub mod growth_step;
mod half_spaces;
pub mod peclet;
pub mod reversal;
pub mod wear_speed;
pub mod wear_step;

use crate::Fallible;
use std::fmt;

/// Resolution of a map.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grid {
    /// A third of the points on each axis: for tests.
    Coarse,
    /// As published.
    Normal,
    /// Twice the points on each axis.
    Fine,
}

impl Grid {
    /// Number of points on this grid for the published number `normal`.
    pub(crate) fn count(self, normal: usize) -> usize {
        match self {
            Self::Coarse => normal.div_ceil(3).max(3),
            Self::Normal => normal,
            Self::Fine => 2 * normal,
        }
    }

    /// Geometrically spaced values from `first` to `last`, [`Self::count`] of them.
    pub(crate) fn spread(self, first: f64, last: f64, normal: usize) -> Vec<f64> {
        let count = self.count(normal);
        (0..count).map(|k| first * (last / first).powf(k as f64 / (count - 1) as f64)).collect()
    }
}

/// Verdict on one run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// Error within the bound for a method of its order.
    Right,
    /// Qualitatively correct, growing or decaying, but with a larger error.
    Inexact,
    /// Stable, but with a larger error: a slowly decaying oscillation.
    Rings,
    /// Decays where the exact solution grows.
    Hides,
    /// Unstable: an error that does not decay where the solution comes to rest.
    Grows,
    /// Refused by the method, with a reason.
    Refused,
}

impl Verdict {
    /// All verdicts, in the order of the legends.
    pub const ALL: [Self; 6] = [Self::Right, Self::Inexact, Self::Rings, Self::Hides, Self::Grows, Self::Refused];
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Right => "right",
            Self::Inexact => "inexact",
            Self::Rings => "rings",
            Self::Hides => "hides growth",
            Self::Grows => "grows",
            Self::Refused => "refused",
        })
    }
}

/// One run: its position in the panel and its verdict.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Point {
    /// Value on the horizontal axis.
    pub x: f64,
    /// Value on the vertical axis.
    pub y: f64,
    /// Verdict.
    pub verdict: Verdict,
    /// Its error, in the measure of the map; NaN where it was refused.
    pub error: f64,
}

/// A curve: theoretical, or computed from the runs.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    /// Label.
    pub name: String,
    /// Points (x, y).
    pub points: Vec<(f64, f64)>,
    /// Theoretical: drawn dashed. Otherwise computed: drawn as points.
    pub theory: bool,
}

/// An axis of a panel.
#[derive(Clone, PartialEq, Debug)]
pub struct Axis {
    /// Quantity with its unit.
    pub label: &'static str,
    /// Logarithmic to base 10.
    pub logarithmic: bool,
    /// Range shown; `None`: that of the data.
    pub range: Option<(f64, f64)>,
}

/// A panel: one pair of axes.
#[derive(Clone, PartialEq, Debug)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Judged runs.
    pub points: Vec<Point>,
    /// Curves.
    pub curves: Vec<Curve>,
}

/// A computed map.
#[derive(Clone, PartialEq, Debug)]
pub struct Map {
    /// Headline.
    pub title: &'static str,
    /// What is computed; the page of the maps has the meaning of the verdicts.
    pub problem: String,
    /// Findings: sentences with the numbers of these runs.
    pub findings: Vec<String>,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
}

impl Panel {
    /// Number of runs with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.points.iter().filter(|point| point.verdict == verdict).count()
    }

    pub(crate) fn largest_error(&self) -> f64 {
        self.points.iter().map(|point| point.error).filter(|error| !error.is_nan()).fold(0.0, f64::max)
    }
}

/// A logarithmic or linear axis over a range.
fn axis(label: &'static str, logarithmic: bool, range: (f64, f64)) -> Axis {
    Axis { label, logarithmic, range: Some(range) }
}

/// A theoretical curve (drawn dashed) or a computed one (drawn as points).
fn curve(name: &str, points: Vec<(f64, f64)>, theory: bool) -> Curve {
    Curve { name: name.to_owned(), points, theory }
}

/// A map that can be computed.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Name on the command line, and of its files.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Computes the map on a grid; the callback receives the completed fraction, from 0 to 1.
    pub compute: Compute,
}

/// Function that computes a map.
pub(crate) type Compute = fn(Grid, &dyn Fn(f64)) -> Fallible<Map>;

/// All maps.
pub fn maps() -> Vec<Definition> {
    vec![
        Definition { name: "growth-step", summary: growth_step::SUMMARY, compute: growth_step::map },
        Definition { name: "wear-speed", summary: wear_speed::SUMMARY, compute: wear_speed::map },
        Definition { name: "reversal", summary: reversal::SUMMARY, compute: reversal::map },
        Definition { name: "conductance", summary: conductance::SUMMARY, compute: conductance::map },
        Definition { name: "peclet", summary: peclet::SUMMARY, compute: peclet::map },
        Definition { name: "conductivity", summary: conductivity::SUMMARY, compute: conductivity::map },
        Definition { name: "wear-step", summary: wear_step::SUMMARY, compute: wear_step::map },
    ]
}
