//! Line charts as SVG: panels side by side under a text header, axes with units, linear or logarithmic.

mod scale;

use anyhow::{Result, anyhow};
use plotters::chart::ChartBuilder;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use scale::Scale;
use std::path::Path;

const FONT: &str = "Helvetica, Arial, 'DejaVu Sans', sans-serif";
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(222, 225, 230);
/// Colours that people with any colour vision tell apart (Okabe, Ito), the yellow left out.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(90, 90, 90),
];

/// Units of the drawing per pixel: the drawing library rounds coordinates to whole units, which would show as wobble of the curves.
const FINE: u32 = 10;

/// Height of a row of a figure's key and of a panel's legend, in pixels.
const KEY_ROW: u32 = 20;

/// Width of a mark in a legend with the space behind it, and of a letter at most on the average, in pixels.
const SAMPLE: u32 = 34;
const LETTER: u32 = 7;

/// Left and right of a panel's axes, in pixels.
const LEFT: u32 = 72;
const RIGHT: u32 = 18;

/// Pixels in units of the drawing.
const fn fine(pixels: i32) -> i32 {
    pixels * FINE as i32
}

/// Line style or marker of a series.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
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

impl Mark {
    /// Width of its line.
    fn width(self) -> u32 {
        if self == Self::Thin { FINE } else { 2 * FINE }
    }
}

/// One curve of a panel.
#[derive(Clone, PartialEq, Debug)]
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
#[derive(Clone, PartialEq, Debug)]
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

    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }

    fn scale(&self, values: impl Iterator<Item = f64>, margin: f64) -> Scale {
        let place = |value: f64| if self.logarithmic { value.log10() } else { value };
        let (first, last) = match self.range {
            Some((first, last)) => (place(first), place(last)),
            None => {
                let shown = values.filter(|&value| self.shows(value)).map(place);
                let (low, high) =
                    shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
                let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
                // A constant gets room around it.
                let least = if self.logarithmic { 0.5 } else { 0.05 * low.abs().max(high.abs()) };
                let room = if high - low > 1e-9 * high.abs() { margin * (high - low) } else { least.max(1e-300) };
                (low - room, high + room)
            }
        };
        Scale { first, last, logarithmic: self.logarithmic }
    }
}

/// One pair of axes with its curves.
#[derive(Clone, PartialEq, Debug)]
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

    /// Names in a row of the legend: two where the longest of them fits into half of a panel that is `width` pixels wide.
    fn legend_columns(&self, width: u32) -> usize {
        let longest = self.series.iter().map(|series| series.name.chars().count()).max().unwrap_or(0) as u32;
        if 2 * (SAMPLE + LETTER * longest) <= width - LEFT - RIGHT { 2 } else { 1 }
    }

    /// Rows of the legend above a panel that is `width` pixels wide.
    fn legend_rows(&self, width: u32) -> u32 {
        let named = self.series.iter().filter(|series| !series.name.is_empty()).count();
        named.div_ceil(self.legend_columns(width)) as u32
    }
}

/// A page of panels.
#[derive(Clone, PartialEq, Debug)]
pub struct Figure {
    /// Headline.
    pub title: String,
    /// Lines of text below it.
    pub header: Vec<String>,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of a panel, in pixels.
    pub panel_size: (u32, u32),
    /// Key of the marks of all panels, listed between header and panels; its points are not drawn.
    pub key: Vec<Series>,
}

impl Figure {
    /// Panels of 520 x 360 pixels, at most two in a row.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        let columns = panels.len().clamp(1, 2);
        Self { title: title.into(), header: Vec::new(), panels, columns, panel_size: (520, 360), key: Vec::new() }
    }

    /// The same with these lines below the headline.
    pub fn with_header(mut self, header: Vec<String>) -> Self {
        self.header = header;
        self
    }

    /// The drawing as the text of an SVG file.
    pub fn svg(&self) -> Result<String> {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns) as u32;
        let text_height = 52 + 19 * self.header.len() as u32;
        let key_columns = columns.max(2);
        let header = text_height + KEY_ROW * self.key.len().div_ceil(key_columns) as u32;
        let (width, height) = self.panel_size;
        // Axes side by side stand at one height: a row of panels has the legend rows of the longest.
        let legends: Vec<u32> = self
            .panels
            .chunks(columns)
            .map(|row| row.iter().map(|panel| panel.legend_rows(width)).max().unwrap_or(0))
            .collect();
        let above = |row: usize| KEY_ROW * legends[..row].iter().sum::<u32>();
        let size = (columns as u32 * width + 24, header + rows * height + above(legends.len()) + 12);
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, (FINE * size.0, FINE * size.1)).into_drawing_area();
            area.fill(&WHITE).map_err(failed)?;
            write(&area, &self.title, (24, 16), 21, FontStyle::Bold, (HPos::Left, VPos::Top))?;
            for (index, line) in self.header.iter().enumerate() {
                let place = (24, 46 + 19 * index as i32);
                write(&area, line, place, 14, FontStyle::Normal, (HPos::Left, VPos::Top))?;
            }
            for (index, series) in self.key.iter().enumerate() {
                let share = columns as u32 * width / key_columns as u32;
                let left = 24 + (index % key_columns) as u32 * share;
                let middle = text_height + (index / key_columns) as u32 * KEY_ROW + KEY_ROW / 2;
                series.draw_sample(&area, (left as i32, middle as i32), index)?;
                let place = ((left + SAMPLE) as i32, middle as i32);
                write(&area, &series.name, place, 13, FontStyle::Normal, (HPos::Left, VPos::Center))?;
            }
            for (index, panel) in self.panels.iter().enumerate() {
                let row = index / columns;
                let left = 12 + (index % columns) as u32 * width;
                let top = header + row as u32 * height + above(row);
                let legend = KEY_ROW * legends[row];
                let part = area
                    .clone()
                    .shrink((fine(left as i32), fine(top as i32)), (FINE * width, FINE * (height + legend)));
                panel.draw(&part, width, legend)?;
            }
            area.present().map_err(failed)?;
        }
        let drawn = format!("width=\"{}\" height=\"{}\"", FINE * size.0, FINE * size.1);
        let shown = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
        if !text.contains(&drawn) {
            return Err(failed("the size of the drawing is not where it was"));
        }
        Ok(text.replacen(&drawn, &shown, 1))
    }

    /// Writes [`Figure::svg`] to a file, and the folders above it.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = self.svg()?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| anyhow!("making {}: {error}", folder.display()))?;
        }
        std::fs::write(path, text).map_err(|error| anyhow!("writing {}: {error}", path.display()))
    }
}

impl Series {
    /// The mark in the series' colour (`index`: of its place) as a figure's key shows it, centred on the height of
    /// `place`.
    fn draw_sample(&self, area: &Area<'_>, place: (i32, i32), index: usize) -> Result<()> {
        let colour = COLOURS[self.colour.unwrap_or(index) % COLOURS.len()];
        let (left, middle) = (fine(place.0), fine(place.1));
        let stroke = |from: i32, to: i32| {
            let ends = vec![(left + fine(from), middle), (left + fine(to), middle)];
            area.draw(&PathElement::new(ends, colour.stroke_width(self.mark.width()))).map_err(failed)
        };
        let centre = (left + fine(12), middle);
        match self.mark {
            Mark::Line | Mark::Thin => stroke(0, 24)?,
            Mark::Dashes => [(0, 9), (15, 24)].iter().try_for_each(|&(from, to)| stroke(from, to))?,
            Mark::Points => {}
            Mark::LineAndPoints => stroke(0, 24)?,
            Mark::DashesAndSquares => [(0, 6), (18, 24)].iter().try_for_each(|&(from, to)| stroke(from, to))?,
            Mark::Crosses => {}
        }
        match self.mark {
            Mark::Points | Mark::LineAndPoints => {
                area.draw(&Circle::new(centre, fine(3), colour.filled())).map_err(failed)
            }
            Mark::DashesAndSquares => area.draw(&square(centre, colour)).map_err(failed),
            Mark::Crosses => area.draw(&Cross::new(centre, fine(4), colour.stroke_width(2 * FINE))).map_err(failed),
            Mark::Line | Mark::Thin | Mark::Dashes => Ok(()),
        }
    }
}

/// A filled square around a pixel.
fn square((x, y): (i32, i32), colour: RGBColor) -> Rectangle<(i32, i32)> {
    let half = fine(3);
    Rectangle::new([(x - half, y - half), (x + half, y + half)], colour.filled())
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("drawing: {error}")
}

fn write(
    area: &Area<'_>,
    text: &str,
    place: (i32, i32),
    size: i32,
    style: FontStyle,
    (horizontal, vertical): (HPos, VPos),
) -> Result<()> {
    let place = (fine(place.0), fine(place.1));
    let font = (FONT, fine(size), style).into_text_style(area).color(&INK).pos(Pos::new(horizontal, vertical));
    area.draw_text(text, &font, place).map_err(failed)
}

impl Panel {
    /// Draws title, legend (`legend` pixels high) and axes, one below the other, `width` pixels wide.
    fn draw(&self, area: &Area<'_>, width: u32, legend: u32) -> Result<()> {
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let x = self.x.scale(points().map(|point| point.0), 0.0);
        let y = self.y.scale(points().map(|point| point.1), 0.06);
        let middle = (width / 2 + 24) as i32;
        write(area, &self.title, (middle, 8), 16, FontStyle::Bold, (HPos::Center, VPos::Top))?;
        let columns = self.legend_columns(width);
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        for (row, (index, series)) in named.enumerate() {
            let left = LEFT + (row % columns) as u32 * (width - LEFT - RIGHT) / columns as u32;
            let place = (left as i32, (30 + (row / columns) as u32 * KEY_ROW + KEY_ROW / 2) as i32);
            series.draw_sample(area, place, index)?;
            let place = (place.0 + SAMPLE as i32, place.1);
            write(area, &series.name, place, 13, FontStyle::Normal, (HPos::Left, VPos::Center))?;
        }
        let mut chart = ChartBuilder::on(area)
            .margin_top((34 + legend) * FINE)
            .margin_right(RIGHT * FINE)
            .margin_bottom(4 * FINE)
            .x_label_area_size(48 * FINE)
            .y_label_area_size(LEFT * FINE)
            .build_cartesian_2d(x, y)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc(self.x.label.as_str())
            .y_desc(self.y.label.as_str())
            .x_labels(8)
            .y_labels(8)
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(FINE))
            .set_all_tick_mark_size(5 * FINE)
            .axis_style(INK.stroke_width(FINE))
            .label_style((FONT, fine(13)).into_font().color(&INK))
            .axis_desc_style((FONT, fine(14)).into_font().color(&INK))
            .draw()
            .map_err(failed)?;
        for (index, series) in self.series.iter().enumerate() {
            let colour = COLOURS[series.colour.unwrap_or(index) % COLOURS.len()];
            let stroke = colour.stroke_width(series.mark.width());
            let shown = |&(x, y): &(f64, f64)| self.x.shows(x) && self.y.shows(y);
            let lines = !matches!(series.mark, Mark::Points | Mark::Crosses);
            for part in series.points.split(|point| !shown(point)).filter(|part| lines && part.len() > 1) {
                let points = part.iter().copied();
                if matches!(series.mark, Mark::Dashes | Mark::DashesAndSquares) {
                    chart.draw_series(DashedLineSeries::new(points, 8 * FINE, 5 * FINE, stroke)).map_err(failed)?;
                } else {
                    chart.draw_series(LineSeries::new(points, stroke)).map_err(failed)?;
                }
            }
            if matches!(series.mark, Mark::Points | Mark::LineAndPoints) {
                let points = series.points.iter().filter(|point| shown(point));
                chart.draw_series(points.map(|&point| Circle::new(point, fine(3), colour.filled()))).map_err(failed)?;
            }
            let points = series.points.iter().filter(|point| shown(point)).copied();
            match series.mark {
                Mark::DashesAndSquares => {
                    let corners = [(-3, -3), (3, -3), (3, 3), (-3, 3)].map(|(x, y)| (fine(x), fine(y))).to_vec();
                    let marks =
                        points.map(|point| EmptyElement::at(point) + Polygon::new(corners.clone(), colour.filled()));
                    chart.draw_series(marks).map_err(failed)?;
                }
                Mark::Crosses => {
                    chart.draw_series(points.map(|point| Cross::new(point, fine(4), stroke))).map_err(failed)?;
                }
                _ => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_and_curve_is_drawn_and_gaps_interrupt_the_line() {
        let points = vec![(1.0, 1.0), (2.0, f64::NAN), (3.0, 0.0), (4.0, 4.0), (5.0, 5.0), (6.0, 1e3)];
        let series = vec![Series::line("computed", points.clone()), Series::line("exact", points).with(Mark::Points)];
        let panel = Panel::new("Error", Axis::new("cells"), Axis::logarithmic("error"), series);
        let svg = Figure::new("Kernels", vec![panel]).with_header(vec!["nu = 0.3".into()]).svg().unwrap();
        for text in ["computed", "exact", "Error", "cells", "error", "Kernels", "nu = 0.3"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        // Positive and finite are the points 1, 4, 5, 6; a single point makes no line.
        // The legend's sample of a line has two points as well, in the same colour.
        let blue = svg.split('<').filter(|tag| tag.starts_with("polyline") && tag.contains("#0072B2")).count();
        assert_eq!(blue, 2);
        assert_eq!(svg.matches("<circle").count(), 4 + 1);
    }
}
