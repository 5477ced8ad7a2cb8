//! Strip under strokes that are short against the contact: mean over a cycle.
//!
//! A point of the strip is under all positions of the stroke in turn, and so is a cell of the contact over points of the
//! strip. Both means together are the operator K (see [`averaging`]), and the mean shape in the gap of the contact grows by
//! `K d` per depth d: one constant matrix instead of one per travel, and no limit of the step size. Wear beyond the contact
//! is accumulated in two margins of the length of a stroke, so the worn volume is the integral of the law.
//!
//! Theory: docs/theory.md, section 5.5.

use super::operator::averaging;
use elasticity::Cells;
use nalgebra::DMatrix;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Averaged {
    stroke: f64,
    operator: DMatrix<f64>,
    /// Fraction of each cell's wear that falls beyond the contact.
    beyond: Vec<f64>,
    widths: Vec<f64>,
    /// Mean worn depth under the cells, m.
    shape: Vec<f64>,
    /// Worn volume beyond the -x and the +x edge, m2.
    margins: [f64; 2],
    /// Lowest and highest position of the middle of the contact so far, m.
    span: Option<(f64, f64)>,
}

impl Averaged {
    pub(super) fn new(cells: &Cells, stroke: f64) -> Self {
        let count = cells.count();
        let mut operator = DMatrix::zeros(count, count);
        let beyond = averaging(cells.edges(), stroke, &mut operator);
        let widths = cells.widths().to_vec();
        Self { stroke, operator, beyond, widths, shape: vec![0.0; count], margins: [0.0; 2], span: None }
    }

    pub(super) fn operator(&self) -> &DMatrix<f64> {
        &self.operator
    }

    pub(super) fn shape(&self) -> &[f64] {
        &self.shape
    }

    /// Middle of the positions so far.
    pub(super) fn middle(&self) -> f64 {
        self.span.map_or(0.0, |(low, high)| 0.5 * (low + high))
    }

    /// Records a motion; false, without recording it, where it leaves the span of a stroke.
    pub(super) fn follow(&mut self, x0: f64, x1: f64) -> bool {
        let (low, high) = self.span.unwrap_or((x0, x0));
        let span = (low.min(x0).min(x1), high.max(x0).max(x1));
        // Largest ratio of the travelled span to the nominal stroke before averaging ends.
        let inside = span.1 - span.0 <= 1.5 * self.stroke;
        if inside {
            self.span = Some(span);
        }
        inside
    }

    pub(super) fn deposit(&mut self, depth: &[f64]) {
        let count = depth.len();
        for j in 0..count {
            for i in 0..count {
                self.shape[i] += self.operator[(i, j)] * depth[j];
            }
            // Strokes are short: wear leaves across the nearer edge only.
            self.margins[usize::from(2 * j >= count)] += self.beyond[j] * self.widths[j] * depth[j];
        }
    }

    pub(super) fn volume(&self, edges: &[f64]) -> f64 {
        let cells: f64 = self.shape.iter().zip(edges.windows(2)).map(|(s, e)| s * (e[1] - e[0])).sum();
        cells + self.margins[0] + self.margins[1]
    }

    /// The margins as cells: their edges and mean depths.
    pub(super) fn margins(&self, edges: &[f64]) -> [([f64; 2], f64); 2] {
        let (left, right) = (edges[0], edges[edges.len() - 1]);
        let [below, above] = self.margins.map(|volume| volume / self.stroke);
        [([left - self.stroke, left], below), ([right, right + self.stroke], above)]
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.shape.copy_from_slice(&other.shape);
        (self.margins, self.span) = (other.margins, other.span);
    }

    pub(super) fn save(&self, out: &mut Vec<f64>) {
        let (low, high) = self.span.unwrap_or((f64::NAN, f64::NAN));
        out.extend([low, high, self.margins[0], self.margins[1]]);
        out.extend(&self.shape);
    }

    pub(super) fn load(&mut self, numbers: &mut std::slice::Iter<'_, f64>) -> Option<()> {
        let mut next = || numbers.next().copied();
        let (low, high, margins) = (next()?, next()?, [next()?, next()?]);
        let shape = numbers.as_slice().get(..self.shape.len())?;
        if shape.iter().chain(&margins).any(|value| !value.is_finite()) {
            return None;
        }
        self.shape.copy_from_slice(shape);
        *numbers = numbers.as_slice()[self.shape.len()..].iter();
        self.margins = margins;
        self.span = (low <= high).then_some((low, high));
        Some(())
    }
}
