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
//! The overlaps are extrapolated to the middle of the step, and the parts in contact stay the same over it. Its error is of
//! second order in the step. An edge of the zone is no edge of the contact.
//!
//! Theory: docs/theory.md, section 6.5.

use conduction::line::contact_parts::{ContactParts, PARTS};
use contact::ContactState;

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

/// Worn depths that shape the contact along the line, m: N values of the punch, and of the strip where it wears by radius. A strip
/// with an even path or a worn track has no kink at the edge.
#[derive(Clone, Copy, Debug)]
pub struct Worn<'a> {
    pub punch: &'a [f64],
    pub strip: Option<&'a [f64]>,
}

impl Worn<'_> {
    fn at(&self, cell: usize) -> f64 {
        self.punch[cell] + self.strip.map_or(0.0, |strip| strip[cell])
    }
}

impl Edges {
    /// Edges on cells of these widths (m), of which the first and the last are neighbours on a closed ring. `compliance(i, j)`:
    /// displacement of cell i per pressure on cell j, of both bodies, m/Pa.
    pub fn new(widths: &[f64], closed_ring: bool, compliance: impl Fn(usize, usize) -> f64) -> Edges {
        let mut edges = Edges { compliance: vec![0.0; widths.len()], widths: widths.to_vec(), closed_ring };
        for i in 0..widths.len() {
            let neighbours = [false, true].into_iter().filter_map(|right| edges.neighbour(i, right));
            let (sum, number) = neighbours.fold((0.0, 0.0), |(sum, number), j| (sum + compliance(j, i), number + 1.0));
            let beside = if number > 0.0 { sum / number } else { 0.0 };
            edges.compliance[i] = compliance(i, i) - beside;
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

    /// Fractions in contact of a cell in contact with the overlap `inside` (m) and of its neighbour with the gap `outside` (m), by the
    /// edge between them.
    fn fractions(&self, [cell, open]: [usize; 2], inside: f64, outside: f64) -> [f64; 2] {
        let [own, other] = [cell, open].map(|i| self.widths[i]);
        let reach = inside / (inside + outside) * 0.5 * (own + other);
        [(0.5 + reach / own).min(1.0), ((reach - 0.5 * own) / other).max(0.0)]
    }

    /// Finds the parts of the cells in contact in a step of `step` s.
    pub fn find(&self, state: &EdgeState, step: f64, worn: Worn<'_>, contact_parts: &mut ContactParts) {
        contact_parts.make_whole();
        let overlap = |cell: usize| state.overlap[cell] + 0.5 * step * state.rate[cell];
        let touches = |cell: usize| overlap(cell) > 0.0;
        if (0..self.widths.len()).all(touches) {
            return;
        }
        let fractions = |cells: [usize; 2], right: bool| {
            let [inside, outside] = cells.map(overlap);
            let since = worn.at(cells[0]) - state.wear_then[usize::from(!right)][cells[1]];
            self.fractions(cells, inside + since.max(0.0), -outside)
        };
        let parts = |fraction: f64| (fraction * PARTS as f64).round() as usize;
        for cell in 0..self.widths.len() {
            let inside = touches(cell);
            let [left, right] = [false, true].map(|right| {
                let other = self.neighbour(cell, right).filter(|&other| touches(other) != inside)?;
                Some(if inside {
                    parts(fractions([cell, other], right)[0])
                } else {
                    parts(fractions([other, cell], !right)[1])
                })
            });
            match (inside, left, right) {
                (_, None, None) => {}
                (true, ..) => {
                    contact_parts.include_between(cell, PARTS - left.unwrap_or(PARTS), right.unwrap_or(PARTS));
                }
                (false, ..) => contact_parts.include_beside(cell, left.unwrap_or(0), PARTS - right.unwrap_or(0)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(closed_ring: bool) -> Edges {
        Edges { compliance: vec![2.0; 6], widths: vec![1.0; 6], closed_ring }
    }

    /// Contact of which the undeformed surfaces overlap by these depths.
    fn contact(depth: [f64; 6]) -> ContactState {
        let mut state = ContactState::new(6);
        for (i, depth) in depth.into_iter().enumerate() {
            (state.pressure[i], state.gap[i]) = (0.5 * depth.max(0.0), (-depth).max(0.0));
        }
        state
    }

    fn fractions(edges: &Edges, state: &EdgeState, step: f64, worn: &[f64; 6]) -> [f64; 6] {
        let mut contact_parts = ContactParts::whole(6);
        edges.find(state, step, Worn { punch: worn, strip: None }, &mut contact_parts);
        std::array::from_fn(|cell| contact_parts.fraction(cell))
    }

    #[test]
    fn edges_are_where_the_overlap_is_zero() {
        let (edges, none) = (edges(false), [0.0; 6]);
        let worn = Worn { punch: &none, strip: None };
        let mut state = EdgeState::new(6);
        // 1/4 of a cell outside the centre of cell 1 to the left, 3/4 outside that of cell 3 to the right, which is 1/4 within
        // cell 4; the zone's own edges are no edges of the contact.
        let steady = contact([-3.0, 1.0, 4.0, 3.0, -1.0, -5.0]);
        edges.follow([&steady, &steady], 1.0, worn, &mut state);
        assert_eq!(fractions(&edges, &state, 1.0, &none), [1.0, 0.75, 1.0, 1.0, 0.25, 1.0]);
        // In the middle of the next step the edge on the left is another quarter further outside, at the cell's boundary.
        let early = contact([-5.0, -1.0, 4.0, 3.0, -1.0, -5.0]);
        edges.follow([&early, &steady], 2.0, worn, &mut state);
        assert_eq!(fractions(&edges, &state, 2.0, &none), [1.0, 1.0, 1.0, 1.0, 0.25, 1.0]);
        let all = contact([1.0; 6]);
        edges.follow([&all, &all], 1.0, worn, &mut state);
        assert_eq!(fractions(&edges, &state, 1.0, &none), [1.0; 6]);
    }

    #[test]
    fn the_ends_of_a_ring_are_neighbours() {
        let none = [0.0; 6];
        let worn = Worn { punch: &none, strip: None };
        for closed_ring in [false, true] {
            let edges = edges(closed_ring);
            let mut state = EdgeState::new(6);
            let steady = contact([3.0, 3.0, 3.0, 3.0, -9.0, -1.0]);
            edges.follow([&steady, &steady], 1.0, worn, &mut state);
            let last = if closed_ring { 0.25 } else { 1.0 };
            assert_eq!(fractions(&edges, &state, 1.0, &none), [1.0, 1.0, 1.0, 0.75, 1.0, last]);
        }
    }

    #[test]
    fn what_wore_since_the_neighbour_was_in_contact_counts_as_overlap() {
        let edges = edges(false);
        let mut state = EdgeState::new(6);
        let mut follow = |worn: &[f64; 6], depth: [f64; 6]| {
            let steady = contact(depth);
            edges.follow([&steady, &steady], 1.0, Worn { punch: worn, strip: None }, &mut state);
            fractions(&edges, &state, 1.0, worn)
        };
        // All cells wear alike: no kink.
        let (even, more) = ([7.0; 6], [7.0, 7.0, 7.0, 9.0, 7.0, 7.0]);
        assert_eq!(follow(&even, [1.0; 6]), [1.0; 6]);
        assert_eq!(follow(&even, [1.0, 1.0, 1.0, 1.0, -3.0, -9.0])[3..], [0.75, 1.0, 1.0]);
        // Cell 3 wears by 2 while cell 4 is open: as if it overlapped by 3, the edge is at the boundary.
        assert_eq!(follow(&more, [1.0, 1.0, 1.0, 1.0, -3.0, -9.0])[3..], [1.0, 1.0, 1.0]);
        assert_eq!(follow(&more, [1.0, 1.0, 1.0, 1.0, -1.0, -9.0])[3..], [1.0, 0.25, 1.0]);
    }
}
