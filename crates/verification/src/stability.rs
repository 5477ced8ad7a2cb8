//! Stability maps: where a method is right, where it rings, grows or refuses, over the ranges that decide it, with the
//! bound of the theory drawn in. `cargo fmu stability` draws them.
//!
//! A map is data: panels of judged points and curves. Whoever adds one adds a module beside this file and a line to
//! [`maps`].

pub mod conductance;
pub mod conductivity;
pub mod growth_step;
mod half_spaces;
pub mod peclet;
pub mod reversal;
pub mod wear_speed;
pub mod wear_step;

use std::fmt;

/// How many points a map has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grid {
    /// A third as many on each axis: for tests.
    Coarse,
    /// As published.
    Normal,
    /// Twice as many on each axis.
    Fine,
}

impl Grid {
    /// `normal` as this grid has it.
    pub fn count(self, normal: usize) -> usize {
        match self {
            Self::Coarse => normal.div_ceil(3).max(3),
            Self::Normal => normal,
            Self::Fine => 2 * normal,
        }
    }

    /// As many values as that from `first` to `last`, in equal ratios.
    pub fn spread(self, first: f64, last: f64, normal: usize) -> Vec<f64> {
        let count = self.count(normal);
        (0..count).map(|k| first * (last / first).powf(k as f64 / (count - 1) as f64)).collect()
    }
}

/// What became of one run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// Within the largest error of a method of its order.
    Right,
    /// Of the right kind, growing or decaying, but outside it.
    Inexact,
    /// Stable, but outside it: an oscillation that dies out slowly.
    Rings,
    /// Dies out where the exact solution grows.
    Hides,
    /// An error that does not die out where the solution comes to rest: unstable.
    Grows,
    /// The method said that it cannot, and why.
    Refused,
}

impl Verdict {
    /// All verdicts, in the order in which legends list them.
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

/// One run: where it lies in the panel, and what became of it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Point {
    /// Value on the horizontal axis.
    pub x: f64,
    /// Value on the vertical axis.
    pub y: f64,
    /// What became of it.
    pub verdict: Verdict,
    /// Its error, in the measure that the map's header gives; NaN where it was refused.
    pub error: f64,
}

/// A curve: the theory, or a value of the runs.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    /// What it shows.
    pub name: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// Theory: drawn dashed. Otherwise computed: drawn as points.
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

/// One pair of axes.
#[derive(Clone, PartialEq, Debug)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Judged runs.
    pub points: Vec<Point>,
    /// Curves over them.
    pub curves: Vec<Curve>,
}

/// A computed map.
#[derive(Clone, PartialEq, Debug)]
pub struct Map {
    /// Headline.
    pub title: &'static str,
    /// What is computed, what the verdicts mean, and what the error is relative to.
    pub header: Vec<String>,
    /// What is seen: sentences with the numbers of these runs.
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

    /// Largest error of the runs that have one.
    pub fn largest_error(&self) -> f64 {
        self.points.iter().map(|point| point.error).filter(|error| !error.is_nan()).fold(0.0, f64::max)
    }
}

/// A logarithmic or linear axis over a range.
fn axis(label: &'static str, logarithmic: bool, range: (f64, f64)) -> Axis {
    Axis { label, logarithmic, range: Some(range) }
}

/// A curve of the theory (drawn dashed) or of the runs (drawn as points).
fn curve(name: &str, points: Vec<(f64, f64)>, theory: bool) -> Curve {
    Curve { name: name.to_owned(), points, theory }
}

/// A map that can be computed.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Name on the command line, and of its files.
    pub name: &'static str,
    /// What it is about, in one line.
    pub summary: &'static str,
    /// Computes it on a grid; the function is told the part that is done, from 0 to 1.
    pub compute: Compute,
}

/// What computes a map.
pub type Compute = fn(Grid, &dyn Fn(f64)) -> Result<Map, String>;

/// Every map.
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
