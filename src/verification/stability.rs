//! Stability maps: where a method is right, where it rings, grows or refuses, over the ranges that decide it, with the
//! bound of the theory drawn in. `cargo fmu stability` draws them.
//!
//! A map is data: panels of judged points and curves. Whoever adds one adds a module beside this file and a line to
//! [`maps`].

pub mod wear_step;

use std::fmt;

/// What became of one run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// Within the largest error of a method of its order.
    Right,
    /// Stable, but outside it: an oscillation that dies out slowly.
    Rings,
    /// An error that does not die out where the solution comes to rest: unstable.
    Grows,
    /// The method said that it cannot, and why.
    Refused,
}

impl Verdict {
    /// All verdicts, in the order in which legends list them.
    pub const ALL: [Self; 4] = [Self::Right, Self::Rings, Self::Grows, Self::Refused];
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Right => "right",
            Self::Rings => "rings",
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
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
}

/// A map that can be computed.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Name on the command line, and of its files.
    pub name: &'static str,
    /// What it is about, in one line.
    pub summary: &'static str,
    /// Computes it; the argument is told the part that is done, from 0 to 1.
    pub compute: fn(&dyn Fn(f64)) -> Result<Map, String>,
}

/// Every map.
pub fn maps() -> Vec<Definition> {
    vec![Definition { name: "wear-step", summary: wear_step::SUMMARY, compute: wear_step::map }]
}
