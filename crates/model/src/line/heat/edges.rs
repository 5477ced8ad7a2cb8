//! Edges of the contact within cells, from pressure and gap of the cells on both sides.
//!
//! The overlap of the undeformed surfaces of a cell is its pressure times its local compliance c where it is in contact, and less
//! its gap where it is not. Between a cell i in contact and a neighbour j that is not the edge lies where the overlap,
//! interpolated between their centres, is 0:
//!
//! ```text
//! c_i p_i/(c_i p_i + g_j) of the distance from i,    c_i = C_ii - mean of C_ji over the neighbours j
//! ```
//!
//! A cell that has never been in contact is not worn, so that the worn surface has a kink at an edge that spreads over it. There
//! the wear of i counts as overlap of the unworn surfaces, which are smooth across the edge.
//!
//! The overlaps are extrapolated to the middle of the step, and the coverage of the cells stays the same over it. Its error is of
//! second order in the step. An edge of the zone is no edge of the contact.
//!
//! Theory: docs/theory.md, section 6.5.

use crate::line::operators::LineOperators;
use conduction::line::coverage::{Coverage, PARTS};
use scene::Geometry;

/// Geometry and local compliance of the cells, N values each.
#[derive(Clone, Debug)]
pub struct Edges {
    /// Local compliance c, m/Pa.
    compliance: Vec<f64>,
    /// Widths, m.
    widths: Vec<f64>,
    /// The cells at both ends of the zone are neighbours.
    closed_ring: bool,
}

/// State of the contact from which edges are found, N values each.
#[derive(Clone, Copy, Debug)]
pub struct Overlap<'a> {
    /// Overlap of the undeformed surfaces, m, and its rate, m/s.
    pub value: &'a [f64],
    pub rate: &'a [f64],
    /// Time to which it is extrapolated, s.
    pub ahead: f64,
    /// Worn depths of punch and strip under the cells, m.
    pub worn: [&'a [f64]; 2],
}

impl Overlap<'_> {
    fn of(&self, cell: usize) -> f64 {
        self.value[cell] + self.ahead * self.rate[cell]
    }

    fn wear(&self, cell: usize) -> f64 {
        self.worn[0][cell] + self.worn[1][cell]
    }
}

impl Edges {
    /// Edges on the cells of `operators`.
    pub fn new(operators: &LineOperators) -> Edges {
        let count = operators.count();
        let closed_ring = operators.scene.geometry == Geometry::Periodic;
        let mut edges =
            Edges { compliance: vec![0.0; count], widths: operators.cells.widths().to_vec(), closed_ring };
        for i in 0..count {
            let (sum, number) = [false, true]
                .into_iter()
                .filter_map(|right| edges.neighbour(i, right))
                .fold((0.0, 0.0), |(sum, number), j| (sum + operators.normal_compliance(j, i), number + 1.0));
            let beside = if number > 0.0 { sum / number } else { 0.0 };
            edges.compliance[i] = operators.normal_compliance(i, i) - beside;
        }
        edges
    }

    fn neighbour(&self, cell: usize, right: bool) -> Option<usize> {
        let count = self.widths.len();
        match (right, self.closed_ring && count > 1) {
            (true, _) if cell + 1 < count => Some(cell + 1),
            (false, _) if cell > 0 => Some(cell - 1),
            (true, true) => Some(0),
            (false, true) => Some(count - 1),
            _ => None,
        }
    }

    /// Overlap of the undeformed surfaces (m) of a cell with this pressure (Pa) and gap (m).
    pub fn overlap(&self, cell: usize, pressure: f64, gap: f64) -> f64 {
        self.compliance[cell] * pressure - gap
    }

    /// Covered fractions of a cell in contact and of its neighbour without contact, from the edge between them.
    fn covered(&self, overlap: &Overlap<'_>, cell: usize, open: usize) -> [f64; 2] {
        let wear = if overlap.wear(open) == 0.0 { overlap.wear(cell) } else { 0.0 };
        let (inside, outside) = (overlap.of(cell) + wear, -overlap.of(open));
        let [own, other] = [cell, open].map(|i| self.widths[i]);
        let reach = inside / (inside + outside) * 0.5 * (own + other);
        [(0.5 + reach / own).min(1.0), ((reach - 0.5 * own) / other).max(0.0)]
    }

    /// Finds the coverage of the cells.
    pub fn cover(&self, overlap: &Overlap<'_>, coverage: &mut Coverage) {
        coverage.make_whole();
        let touches = |cell: usize| overlap.of(cell) > 0.0;
        let parts = |fraction: f64| (fraction * PARTS as f64).round() as usize;
        for cell in 0..self.widths.len() {
            let inside = touches(cell);
            let [left, right] = [false, true].map(|right| {
                let other = self.neighbour(cell, right).filter(|&other| touches(other) != inside)?;
                Some(if inside {
                    parts(self.covered(overlap, cell, other)[0])
                } else {
                    parts(self.covered(overlap, other, cell)[1])
                })
            });
            match (inside, left, right) {
                (_, None, None) => {}
                (true, ..) => {
                    coverage.cover_between(cell, PARTS - left.unwrap_or(PARTS), right.unwrap_or(PARTS));
                }
                (false, ..) => coverage.cover_beside(cell, left.unwrap_or(0), PARTS - right.unwrap_or(0)),
            }
        }
    }
}
