//! Charts: panels side by side under a text header, axes with units, linear or logarithmic. The Python package draws them.

use crate::drawing;
use anyhow::Result;
use serde::Serialize;
use std::path::Path;

/// Line style or marker of a series.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A thin line through them: a limit that curves are held against.
    Thin,
    /// A dashed line through them.
    Dashes,
    /// The points alone.
    Points,
    /// A line through the points, and the points.
    LineAndPoints,
    /// A dashed line through the points, and squares at them.
    DashesAndSquares,
    /// Crosses at the points alone.
    Crosses,
}

/// One curve of a panel.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Series {
    /// Legend; empty: none.
    pub name: String,
    /// (x, y); points that are not finite, or not positive on a logarithmic axis, interrupt the line.
    pub points: Vec<(f64, f64)>,
    /// Line style or marker.
    pub mark: Mark,
    /// Index of the colour; `None`: its place in the panel.
    pub colour: Option<usize>,
}

impl Series {
    /// A line through `points`.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, mark: Mark::Line, colour: None }
    }

    /// The same, drawn otherwise.
    pub fn with(mut self, mark: Mark) -> Self {
        self.mark = mark;
        self
    }

    /// The same in the colour of this index.
    pub fn coloured(mut self, index: usize) -> Self {
        self.colour = Some(index);
        self
    }
}

/// An axis of a panel.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Axis {
    /// Quantity with its unit: `pressure (MPa)`.
    pub label: String,
    /// Logarithmic to base 10.
    pub logarithmic: bool,
    /// Range shown; `None`: that of the data with a margin.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis over the range of the data.
    pub(crate) fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), logarithmic: false, range: None }
    }

    /// A logarithmic axis over the range of the data.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { logarithmic: true, ..Self::new(label) }
    }

    /// The same over this range.
    pub fn over(mut self, first: f64, last: f64) -> Self {
        self.range = Some((first, last));
        self
    }
}

/// One pair of axes with its curves.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Panel {
    /// Title above the axes.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, drawn in this order. Those with a name are listed above the axes, where they hide no curve.
    pub series: Vec<Series>,
}

impl Panel {
    /// A panel of these curves.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self { title: title.into(), x, y, series }
    }
}

/// A page of panels.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Figure {
    /// Headline.
    pub title: String,
    /// Texts below it, wrapped to the page.
    pub header: Vec<String>,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// Height of the axes of a panel, in inches.
    pub height: f64,
    /// Key of the marks of all panels, listed between header and panels; its points are not drawn.
    pub key: Vec<Series>,
}

impl Figure {
    /// Two panels in a row, if there are as many.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        let columns = panels.len().clamp(1, 2);
        Self { title: title.into(), header: Vec::new(), panels, columns, height: 1.9, key: Vec::new() }
    }

    /// The same with these texts below the headline.
    pub fn with_header(mut self, header: Vec<String>) -> Self {
        self.header = header;
        self
    }

    /// Draws it into a file, whose folder is made.
    pub fn write(&self, path: &Path) -> Result<()> {
        drawing::write("panels", self, "--output", path)
    }
}
