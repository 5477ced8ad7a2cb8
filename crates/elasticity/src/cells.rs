//! Cells of the contact line; pressure is one mean value per cell.
//!
//! Theory: docs/theory.md, section 3.1.

use super::OutOfRange;
use std::f64::consts::PI;

/// Largest number of cells of a contact line.
pub const MAXIMUM_CELLS: usize = 1025;

/// Partition of the contact zone `-a <= x <= a` into N cells, from the -x edge to the +x edge.
///
/// Pressure, shear traction, gap and wear depth are vectors of N cell means in this order.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    edges: Vec<f64>,
    centres: Vec<f64>,
    widths: Vec<f64>,
}

impl Cells {
    /// Cells graded to both edges, `x_i = -a cos(pi i/N)`: the edge cells have the width `a pi^2/(2 N^2)`.
    ///
    /// This quadratic grading suits a pressure with the edge singularity `1/sqrt(a^2 - x^2)`: the cell means of piecewise
    /// constant pressure then converge at second order away from the edges (uniform cells: at first order). Stronger grading
    /// makes the interior coarser and the edge cells, which bound explicit time steps, needlessly small.
    pub fn graded(half_width: f64, count: usize) -> Result<Self, OutOfRange> {
        check(half_width, count)?;
        let edge = |i: usize| {
            // Odd symmetry to the last bit: evaluated on one half only.
            let sine = |k: usize| (PI * k as f64 / (2.0 * count as f64)).sin();
            if 2 * i >= count { half_width * sine(2 * i - count) } else { -half_width * sine(count - 2 * i) }
        };
        Ok(Self::from_edges((0..=count).map(edge).collect()))
    }

    /// Cells of equal width, for contact without edges (periodic) and for comparison.
    pub fn uniform(half_width: f64, count: usize) -> Result<Self, OutOfRange> {
        check(half_width, count)?;
        let edge = |i: usize| half_width * (2.0 * i as f64 - count as f64) / count as f64;
        Ok(Self::from_edges((0..=count).map(edge).collect()))
    }

    pub(super) fn from_edges(edges: Vec<f64>) -> Self {
        let centres = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        let widths = edges.windows(2).map(|e| e[1] - e[0]).collect();
        Self { edges, centres, widths }
    }

    /// These cells divided into `parts` of equal width each.
    pub fn divided(&self, parts: usize) -> Self {
        let count = self.count();
        // Symmetric cells have symmetric parts, to the last bit.
        let edge = |i: usize| {
            let (cell, part) = (i / parts, i % parts);
            let left = |part: usize| self.edges[cell] + self.widths[cell] * part as f64 / parts as f64;
            match (part, 2 * part > parts) {
                (0, _) => self.edges[cell],
                (_, false) => left(part),
                (_, true) => self.edges[cell + 1] - self.widths[cell] * (parts - part) as f64 / parts as f64,
            }
        };
        Self::from_edges((0..=count * parts).map(edge).collect())
    }

    /// Number of cells N.
    pub fn count(&self) -> usize {
        self.widths.len()
    }

    /// Half-width `a` of the contact zone, in m.
    pub fn half_width(&self) -> f64 {
        self.edges[self.edges.len() - 1]
    }

    /// The N + 1 cell boundaries, in m, ascending.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The N cell centres, in m.
    pub fn centres(&self) -> &[f64] {
        &self.centres
    }

    /// The N cell widths, in m.
    pub fn widths(&self) -> &[f64] {
        &self.widths
    }

    /// Integral over the contact zone of a quantity given by its cell means.
    pub fn integral(&self, means: &[f64]) -> f64 {
        assert_eq!(means.len(), self.count(), "one mean per cell");
        means.iter().zip(&self.widths).map(|(m, c)| m * c).sum()
    }

    /// First moment about x = 0 of a quantity given by its cell means, taken constant on each cell.
    pub fn moment(&self, means: &[f64]) -> f64 {
        assert_eq!(means.len(), self.count(), "one mean per cell");
        means.iter().zip(&self.widths).zip(&self.centres).map(|((m, c), x)| m * c * x).sum()
    }

    /// Cell means of a function given by its primitive (antiderivative).
    pub fn means_from_primitive(&self, primitive: impl Fn(f64) -> f64) -> Vec<f64> {
        self.edges.windows(2).map(|e| (primitive(e[1]) - primitive(e[0])) / (e[1] - e[0])).collect()
    }

    /// Point value at `x` of the polynomial of degree 4 whose means over the five nearest cells are the given ones
    /// (fewer cells: lower degree). Fifth order where the quantity is smooth.
    pub fn point_value(&self, means: &[f64], x: f64) -> f64 {
        assert_eq!(means.len(), self.count(), "one mean per cell");
        let count = self.count();
        let stencil = count.min(5);
        let cell = self.edges[1..count].partition_point(|&e| e <= x);
        let first = cell.saturating_sub(stencil / 2).min(count - stencil);
        // The cumulative integral is known at stencil + 1 cell boundaries; the value is its derivative.
        let nodes = &self.edges[first..=first + stencil];
        let mut cumulative = vec![0.0; stencil + 1];
        for k in 0..stencil {
            cumulative[k + 1] = cumulative[k] + means[first + k] * self.widths[first + k];
        }
        (0..=stencil).map(|k| cumulative[k] * lagrange_derivative(nodes, k, x)).sum()
    }
}

/// Derivative at `x` of the Lagrange polynomial that is 1 at node `k` and 0 at the others.
fn lagrange_derivative(nodes: &[f64], k: usize, x: f64) -> f64 {
    let others = |skip: usize| (0..nodes.len()).filter(move |&j| j != k && j != skip);
    (0..nodes.len())
        .filter(|&m| m != k)
        .map(|m| others(m).map(|j| (x - nodes[j]) / (nodes[k] - nodes[j])).product::<f64>() / (nodes[k] - nodes[m]))
        .sum()
}

fn check(half_width: f64, count: usize) -> Result<(), OutOfRange> {
    OutOfRange::unless(half_width.is_finite() && half_width > 0.0, "contact half-width", half_width, "positive, in m")?;
    OutOfRange::unless((1..=MAXIMUM_CELLS).contains(&count), "number of cells", count as f64, "from 1 to 1025")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_value_reproduces_a_quartic_from_its_means() {
        let cells = Cells::graded(2.0, 9).unwrap();
        let value = |x: f64| 1.0 - 2.0 * x + 0.5 * x.powi(2) + x.powi(3) - 0.3 * x.powi(4);
        let means =
            cells.means_from_primitive(|x| x - x.powi(2) + x.powi(3) / 6.0 + x.powi(4) / 4.0 - 0.06 * x.powi(5));
        for x in [-2.0, -1.99, -0.7, 0.0, 0.31, 1.5, 2.0] {
            let error = (cells.point_value(&means, x) - value(x)).abs();
            assert!(error < 1e-12, "x = {x}: {error:e}");
        }
        let single = Cells::graded(2.0, 1).unwrap();
        assert_eq!(single.point_value(&[7.0], 0.3), 7.0);
    }

    #[test]
    fn bad_cells_are_refused_with_the_numbers() {
        let message = Cells::graded(0.1, 1026).unwrap_err().to_string();
        assert_eq!(message, "number of cells = 1026 is out of range: must be from 1 to 1025");
        assert!(Cells::graded(0.1, 0).is_err());
        for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Cells::uniform(width, 3).is_err());
        }
    }
}
