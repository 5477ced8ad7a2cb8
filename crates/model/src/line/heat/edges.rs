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
//! Wear makes a kink in the surface at an edge that stands still or spreads, because only the side in contact wears. The surfaces
//! as they were when j was last in contact are smooth there, so the wear of i since then counts as overlap too. For an edge that
//! recedes over worn cells this reaches too far by a part of a cell, the smaller the less a cell wears while the edge passes it.
//!
//! The overlaps are extrapolated to the middle of the step, and the coverage of the cells stays the same over it. Its error is of
//! second order in the step. An edge of the zone is no edge of the contact.
//!
//! Theory: docs/theory.md, section 6.5.

use crate::line::operators::{LineOperators, StripWear};
use conduction::line::coverage::{Coverage, PARTS};
use contact::ContactState;
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

/// State of the contact from which its edges are found, N values each; part of a saved state.
#[derive(Clone, PartialEq, Debug)]
pub struct EdgeState {
    /// Overlap of the undeformed surfaces at the end of the last step, m, and its rate over that step, m/s; the rate is 0 after a
    /// jump and after a reversal.
    pub overlap: Vec<f64>,
    pub rate: Vec<f64>,
    /// Worn depth of the neighbours towards -x and +x when the cell was last in contact, m.
    pub wear_then: [Vec<f64>; 2],
}

impl EdgeState {
    /// Cells that were never in contact.
    pub fn new(count: usize) -> EdgeState {
        let zeros = || vec![0.0; count];
        EdgeState { overlap: zeros(), rate: zeros(), wear_then: [zeros(), zeros()] }
    }

    /// All numbers.
    pub fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let EdgeState { overlap, rate, wear_then } = self;
        overlap.iter_mut().chain(rate).chain(wear_then.iter_mut().flatten())
    }

    /// The vectors.
    pub fn vectors(&self) -> [&Vec<f64>; 4] {
        let [left, right] = &self.wear_then;
        [&self.overlap, &self.rate, left, right]
    }

    /// Copies another state of as many cells.
    pub fn copy_from(&mut self, other: &EdgeState) {
        self.numbers().zip(other.vectors().into_iter().flatten()).for_each(|(own, other)| *own = *other);
    }
}

/// Worn depths that shape the contact along the line, m: N values of the punch, and of the strip where it wears by radius. An even
/// path or a worn track has no kink at the edge.
#[derive(Clone, Copy, Debug)]
pub struct Worn<'a> {
    punch: &'a [f64],
    strip: Option<&'a [f64]>,
}

impl Worn<'_> {
    /// From the worn depths of punch and strip under the cells.
    pub fn new<'a>(operators: &LineOperators, punch: &'a [f64], strip: &'a [f64]) -> Worn<'a> {
        Worn { punch, strip: (operators.strip_wear == StripWear::ByRadius).then_some(strip) }
    }

    fn at(&self, cell: usize) -> f64 {
        self.punch[cell] + self.strip.map_or(0.0, |strip| strip[cell])
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

    /// Updates the state by a step that ends `duration` (s) after its first stage, with the contact of both.
    pub fn follow(&self, [first, end]: [&ContactState; 2], duration: f64, worn: Worn<'_>, state: &mut EdgeState) {
        for i in 0..self.widths.len() {
            let [early, late] = [first, end].map(|stage| self.compliance[i] * stage.pressure[i] - stage.gap[i]);
            (state.overlap[i], state.rate[i]) = (late, (late - early) / duration);
            if end.pressure[i] > 0.0 {
                for (right, then) in [false, true].into_iter().zip(&mut state.wear_then) {
                    then[i] = self.neighbour(i, right).map_or(0.0, |other| worn.at(other));
                }
            }
        }
    }

    /// Covered fractions of a cell in contact with the overlap `inside` (m) and of its neighbour with the gap `outside` (m), by the
    /// edge between them.
    fn covered(&self, [cell, open]: [usize; 2], inside: f64, outside: f64) -> [f64; 2] {
        let [own, other] = [cell, open].map(|i| self.widths[i]);
        let reach = inside / (inside + outside) * 0.5 * (own + other);
        [(0.5 + reach / own).min(1.0), ((reach - 0.5 * own) / other).max(0.0)]
    }

    /// Finds the coverage of the cells in a step of `step` s.
    pub fn cover(&self, state: &EdgeState, step: f64, worn: Worn<'_>, coverage: &mut Coverage) {
        coverage.make_whole();
        let overlap = |cell: usize| state.overlap[cell] + 0.5 * step * state.rate[cell];
        let touches = |cell: usize| overlap(cell) > 0.0;
        let covered = |cells: [usize; 2], right: bool| {
            let [inside, outside] = cells.map(overlap);
            let since = worn.at(cells[0]) - state.wear_then[usize::from(!right)][cells[1]];
            self.covered(cells, inside + since.max(0.0), -outside)
        };
        let parts = |fraction: f64| (fraction * PARTS as f64).round() as usize;
        for cell in 0..self.widths.len() {
            let inside = touches(cell);
            let [left, right] = [false, true].map(|right| {
                let other = self.neighbour(cell, right).filter(|&other| touches(other) != inside)?;
                Some(if inside {
                    parts(covered([cell, other], right)[0])
                } else {
                    parts(covered([other, cell], !right)[1])
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
