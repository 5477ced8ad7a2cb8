//! Edges of the contact within cells, from overlap and wear of the cells on both sides.
//!
//! The overlap of the undeformed surfaces of a cell is its pressure times its local compliance c where it is in contact, and less
//! its gap where it is not:
//!
//! ```text
//! a_i = c_i p_i - g_i,    c_i = C_ii - mean of C_ji over the neighbours j
//! ```
//!
//! Between the centres of two neighbouring cells lie the points of the relief m (m), the depth by which the surfaces are worn beyond the
//! depth interpolated between the centres, where it is 0. Between the points it is linear, and the surfaces are in contact where the
//! interpolated overlap `a` exceeds it. At points in contact wear is in proportion to the overlap, at the others there is none:
//!
//! ```text
//! dm/dt = r max(a - m, 0) - dw/dt,    r = (dw_i/dt)/a_i of the cells i in contact
//! ```
//!
//! with the interpolated wear w (m). At an edge that stands still or spreads the relief makes the kink between what wears and
//! what does not, at one that recedes it is small, and a bump that comes into contact again is worn off. Without it edges that
//! stand still would be too far inside; with all of the wear since a point was last in contact, edges that recede were too far outside.
//!
//! The overlaps are extrapolated to both stages of a step: second order in the step but for the relief (implicit Euler in [`PIECES`]
//! pieces of the step). An edge of the zone is no edge of the contact. The wear
//! law is linearised at the cell in contact.
//!
//! Theory: docs/theory.md, section 6.5.

use conduction::line::contact_parts::{ContactParts, PARTS};
use contact::ContactState;

/// Points of the relief in a part of a cell: the centres of as many equal pieces. Behind an edge that recedes the depth to which points still
/// overlap is small, so the edge is found up to half of a piece too far inside.
const POINTS: usize = 4;

/// Points of the relief between the centres of two neighbouring cells.
const BETWEEN: usize = POINTS * PARTS;

/// Pieces of a step for the relief, with overlaps linear in time: an edge may pass several points in one step, and a point may wear by more
/// than its overlap.
const PIECES: u8 = 4;

/// Geometry and local compliance of the cells, N values each.
#[derive(Clone, Debug)]
pub(crate) struct Edges {
    /// Local compliance c, m/Pa.
    compliance: Vec<f64>,
    /// Distance of the points between a cell and its neighbour towards +x from the centre of the first, over that of both centres.
    positions: Vec<[f64; BETWEEN]>,
    /// The cells at both ends of the zone are neighbours.
    closed_ring: bool,
}

/// State of the contact from which its edges are found; part of a saved state.
#[derive(Clone, PartialEq, Debug)]
pub struct EdgeState {
    /// Overlap of the undeformed surfaces at the end of the last step, m; N values.
    pub overlap: Vec<f64>,
    /// Its rate over that step, m/s; 0 after a jump and after a reversal. N values.
    pub rate: Vec<f64>,
    /// Worn depth of the cells at the end of the last step, m.
    pub worn: Vec<f64>,
    /// Relief at the points between the centres of a cell and of its neighbour towards +x, m; [`BETWEEN`] values for each cell.
    pub relief: Vec<f64>,
}

impl EdgeState {
    /// Unworn cells.
    pub(crate) fn new(count: usize) -> EdgeState {
        let zeros = || vec![0.0; count];
        EdgeState { overlap: zeros(), rate: zeros(), worn: zeros(), relief: vec![0.0; BETWEEN * count] }
    }

    /// The vectors.
    pub(crate) fn vectors(&mut self) -> [&mut Vec<f64>; 4] {
        let EdgeState { overlap, rate, worn, relief } = self;
        [overlap, rate, worn, relief]
    }

    /// Copies another state of as many cells.
    pub(crate) fn copy_from(&mut self, other: &EdgeState) {
        let others = [&other.overlap, &other.rate, &other.worn, &other.relief];
        self.vectors().into_iter().zip(others).for_each(|(own, other)| own.copy_from_slice(other));
    }
}

/// Worn depths that shape the contact along the line. A strip with an even path or a worn track has no kink at the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Worn<'a> {
    /// Of the punch at N cells, m.
    pub punch: &'a [f64],
    /// Of the strip at N cells where it wears by radius, m.
    pub strip: Option<&'a [f64]>,
}

impl Worn<'_> {
    fn at(&self, cell: usize) -> f64 {
        self.punch[cell] + self.strip.map_or(0.0, |strip| strip[cell])
    }
}

/// Value at a point between two cells, from those of both, or at a time between two.
fn interpolate(position: f64, [first, second]: [f64; 2]) -> f64 {
    (1.0 - position) * first + position * second
}

/// Relief at a point after a piece of a step, from that before it, with the overlaps of both cells at the end and the depths by which they
/// wore.
///
/// The point wears like the cells in contact, in proportion to its overlap. Implicit Euler.
fn worn_relief(before: f64, position: f64, overlap: [f64; 2], wear: [f64; 2]) -> f64 {
    let [level, interpolated] = [overlap, wear].map(|values| interpolate(position, values));
    // Overlap and wear of the cells in contact.
    let [depth, worn] = match (overlap[0] > 0.0, overlap[1] > 0.0) {
        (false, false) => return before,
        (true, true) => [level, interpolated],
        (_, second) => [overlap[usize::from(second)], wear[usize::from(second)]],
    };
    let touching = (depth * (before - interpolated) + worn * level) / (depth + worn);
    if level > touching { touching } else { before - interpolated }
}

impl Edges {
    /// Edges on cells of these widths (m), of which the first and the last are neighbours on a closed ring. `compliance(i, j)`:
    /// displacement of cell i per pressure on cell j, of both bodies, m/Pa.
    pub(crate) fn new(widths: &[f64], closed_ring: bool, compliance: impl Fn(usize, usize) -> f64) -> Edges {
        let count = widths.len();
        let mut edges = Edges { compliance: vec![0.0; count], positions: vec![[0.0; BETWEEN]; count], closed_ring };
        for i in 0..count {
            let neighbours = [false, true].into_iter().filter_map(|right| edges.neighbour(i, right));
            let (sum, number) = neighbours.fold((0.0, 0.0), |(sum, number), j| (sum + compliance(j, i), number + 1.0));
            let beside = if number > 0.0 { sum / number } else { 0.0 };
            edges.compliance[i] = compliance(i, i) - beside;
            let Some(other) = edges.neighbour(i, true) else { continue };
            let halves = [i, other].map(|cell| 0.5 * widths[cell]);
            edges.positions[i] = std::array::from_fn(|point| {
                let [half, within] = [point / (BETWEEN / 2), point % (BETWEEN / 2)];
                let piece = 2.0 * halves[half] / BETWEEN as f64;
                (halves[0] * half as f64 + (within as f64 + 0.5) * piece) / (halves[0] + halves[1])
            });
        }
        edges
    }

    fn neighbour(&self, cell: usize, right: bool) -> Option<usize> {
        let count = self.compliance.len();
        match (right, self.closed_ring && count > 1) {
            (true, _) if cell + 1 < count => Some(cell + 1),
            (false, _) if cell > 0 => Some(cell - 1),
            (true, true) => Some(0),
            (false, true) => Some(count - 1),
            _ => None,
        }
    }

    /// Updates the state by a step that ends `duration` (s) after its first stage, with the contact of both.
    pub(crate) fn follow(
        &self,
        [first, end]: [&ContactState; 2],
        duration: f64,
        worn: Worn<'_>,
        state: &mut EdgeState,
    ) {
        let EdgeState { overlap, rate, worn: worn_before, relief } = state;
        let of = |stage: &ContactState, cell: usize| self.compliance[cell] * stage.pressure[cell] - stage.gap[cell];
        let count = overlap.len();
        let touches = |cell: usize| overlap[cell] > 0.0 && of(end, cell) > 0.0;
        let uneven = holds_for_any(relief, |relief| relief != 0.0) || !(0..count).all(touches);
        for i in (0..count).filter(|_| uneven) {
            let Some(other) = self.neighbour(i, true) else { continue };
            let wear = [i, other].map(|cell| (worn.at(cell) - worn_before[cell]).max(0.0) / f64::from(PIECES));
            let ends = [i, other].map(|cell| [overlap[cell], of(end, cell)]);
            let points = &mut relief[BETWEEN * i..][..BETWEEN];
            let stays_even =
                ends.iter().flatten().all(|end| *end > 0.0) && !holds_for_any(points, |relief| relief != 0.0);
            if stays_even || wear == [0.0; 2] {
                continue;
            }
            for piece in 1..=PIECES {
                let overlaps = ends.map(|ends| interpolate(f64::from(piece) / f64::from(PIECES), ends));
                for (own, position) in points.iter_mut().zip(self.positions[i]) {
                    *own = worn_relief(*own, position, overlaps, wear);
                }
            }
        }
        for i in 0..overlap.len() {
            let [early, late] = [first, end].map(|stage| of(stage, i));
            (overlap[i], rate[i]) = (late, (late - early) / duration);
            worn_before[i] = worn.at(i);
        }
    }

    /// Finds the parts of the cells in contact `ahead` s after the state: those at which the overlap exceeds the relief, whether or not the
    /// centres of their cells touch.
    pub(crate) fn find(&self, state: &EdgeState, ahead: f64, contact_parts: &mut ContactParts) {
        contact_parts.make_whole();
        let overlap = |cell: usize| state.overlap[cell] + ahead * state.rate[cell];
        let count = self.compliance.len();
        if (0..count).all(|cell| overlap(cell) > 0.0) && !holds_for_any(&state.relief, |relief| relief > 0.0) {
            return;
        }
        const HALF: usize = PARTS / 2;
        let between = |first: usize| {
            let other = self.neighbour(first, true)?;
            Some(self.in_contact(first, [first, other].map(overlap), &state.relief[BETWEEN * first..][..BETWEEN]))
        };
        let outside = |cell: usize| [if overlap(cell) > 0.0 { 1.0 } else { 0.0 }; PARTS];
        let mut left = self.neighbour(0, false).and_then(between).unwrap_or_else(|| outside(0));
        for cell in 0..count {
            let right = between(cell).unwrap_or_else(|| outside(cell));
            let part = |part: usize| if part < HALF { left[HALF + part] } else { right[part - HALF] };
            contact_parts.set(cell, std::array::from_fn(part));
            left = right;
        }
    }

    /// Fractions in contact of the parts between the centres of a cell and of its neighbour towards +x.
    fn in_contact(&self, first: usize, overlaps: [f64; 2], relief: &[f64]) -> [f64; PARTS] {
        if overlaps.iter().all(|overlap| *overlap > 0.0) && !holds_for_any(relief, |relief| relief > 0.0) {
            return [1.0; PARTS];
        }
        if overlaps.iter().all(|overlap| *overlap <= 0.0) && !holds_for_any(relief, |relief| relief < 0.0) {
            return [0.0; PARTS];
        }
        let positions = &self.positions[first];
        let depth: [f64; BETWEEN] =
            std::array::from_fn(|point| interpolate(positions[point], overlaps) - relief[point]);
        // Between two points, and at the centres of the cells at both ends.
        let boundary = |point: usize| match point {
            0 => overlaps[0],
            BETWEEN => overlaps[1],
            _ => 0.5 * (depth[point - 1] + depth[point]),
        };
        let around = |point: usize| {
            0.5 * (positive_part(boundary(point), depth[point]) + positive_part(depth[point], boundary(point + 1)))
        };
        std::array::from_fn(|part| (POINTS * part..POINTS * (part + 1)).map(around).sum::<f64>() / POINTS as f64)
    }
}

/// Whether a condition holds for any of the values, without a branch for each.
fn holds_for_any(values: &[f64], condition: impl Fn(f64) -> bool) -> bool {
    values.iter().fold(false, |any, value| any | condition(*value))
}

/// Part of an interval in which the straight line between two values is positive.
fn positive_part(from: f64, to: f64) -> f64 {
    match (from > 0.0, to > 0.0) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        _ => from.max(to) / (from.abs() + to.abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(closed_ring: bool) -> Edges {
        Edges::new(&[1.0; 6], closed_ring, |i, j| if i == j { 2.0 } else { 0.0 })
    }

    /// Contact of which the undeformed surfaces overlap by these depths.
    fn contact(depth: &[f64]) -> ContactState {
        let mut state = ContactState::new(depth.len());
        for (i, depth) in depth.iter().enumerate() {
            (state.pressure[i], state.gap[i]) = (0.5 * depth.max(0.0), (-depth).max(0.0));
        }
        state
    }

    fn fractions(edges: &Edges, state: &EdgeState, ahead: f64) -> Vec<f64> {
        let count = state.overlap.len();
        let mut contact_parts = ContactParts::whole(count);
        edges.find(state, ahead, &mut contact_parts);
        (0..count).map(|cell| contact_parts.fraction(cell)).collect()
    }

    /// With fractions in steps of a 64th of a cell the fluxes jumped at each of them, and hot bands took 7 to 19 times the steps.
    #[test]
    fn the_width_in_contact_follows_the_edge_without_steps() {
        let edges = edges(false);
        // From 0.2 to 0.9 of the way between the centres of cells 3 and 4, of which the second counts as whole without contact.
        let width = |number: i32| {
            let mut state = EdgeState::new(6);
            let steady = contact(&[4.0, 3.0, 2.0, 1.0, -4.0 + 3.9e-3 * f64::from(number), -9.0]);
            edges.follow([&steady, &steady], 1.0, worn(&[0.0; 6]), &mut state);
            let fractions = fractions(&edges, &state, 0.0);
            fractions[3] + fractions[4] % 1.0
        };
        let changes = (0..999).map(|number| width(number + 1) - width(number));
        let jumps: Vec<f64> = changes.filter(|change| !(0.0..4e-3).contains(change)).collect();
        // The least contact of the cell that begins to touch.
        assert!(matches!(jumps[..], [jump] if (0.0..0.02).contains(&jump)), "{jumps:?}");
    }

    /// Surfaces between two centres that stand out (relief below 0) touch before these do, those that are hollow (above 0) after them. Counted
    /// only beside a cell that touches, they made the width jump by half of a cell, and heat through it made the cell open and close.
    #[test]
    fn the_width_in_contact_does_not_jump_where_a_cell_begins_to_touch() {
        let edges = edges(false);
        for relief in [-0.4, 0.4] {
            let [before, after] = [-1e-9, 1e-9].map(|overlap| {
                let mut state = EdgeState::new(6);
                state.overlap = vec![2.0, 1.0, overlap, -1.0, -2.0, -2.0];
                state.relief[BETWEEN..3 * BETWEEN].fill(relief);
                let mut contact_parts = ContactParts::whole(6);
                edges.find(&state, 0.0, &mut contact_parts);
                let touches = |i: usize| state.overlap[i] > 0.0 || contact_parts.is_partial(i);
                (0..6).filter(|&i| touches(i)).map(|i| contact_parts.fraction(i)).sum::<f64>()
            });
            assert!((after - before).abs() < 0.05, "relief {relief}: {before} and {after} cells");
        }
    }

    fn worn(punch: &[f64]) -> Worn<'_> {
        Worn { punch, strip: None }
    }

    #[test]
    fn edges_are_where_the_overlap_is_zero() {
        let (edges, none) = (edges(false), [0.0; 6]);
        let mut state = EdgeState::new(6);
        // 1/4 of a cell outside the centre of cell 1 to the left, 3/4 outside that of cell 3 to the right, which is 1/4 within
        // cell 4; the zone's own edges are no edges of the contact.
        let steady = contact(&[-3.0, 1.0, 4.0, 3.0, -1.0, -5.0]);
        edges.follow([&steady, &steady], 1.0, worn(&none), &mut state);
        assert_eq!(fractions(&edges, &state, 1.0), [1.0, 0.75, 1.0, 1.0, 0.25, 1.0]);
        // 1 s later the edge on the left is another quarter further outside, at the cell's boundary.
        let early = contact(&[-5.0, -1.0, 4.0, 3.0, -1.0, -5.0]);
        edges.follow([&early, &steady], 2.0, worn(&none), &mut state);
        assert_eq!(fractions(&edges, &state, 1.0), [1.0, 1.0, 1.0, 1.0, 0.25, 1.0]);
        let all = contact(&[1.0; 6]);
        edges.follow([&all, &all], 1.0, worn(&none), &mut state);
        assert_eq!(fractions(&edges, &state, 1.0), [1.0; 6]);
    }

    #[test]
    fn the_ends_of_a_ring_are_neighbours() {
        for closed_ring in [false, true] {
            let edges = edges(closed_ring);
            let mut state = EdgeState::new(6);
            let steady = contact(&[3.0, 3.0, 3.0, 3.0, -9.0, -1.0]);
            edges.follow([&steady, &steady], 1.0, worn(&[0.0; 6]), &mut state);
            let last = if closed_ring { 0.25 } else { 1.0 };
            assert_eq!(fractions(&edges, &state, 1.0), [1.0, 1.0, 1.0, 0.75, 1.0, last]);
        }
    }

    #[test]
    fn even_wear_makes_no_relief_and_a_vanishing_overlap_none_that_is_not_finite() {
        let edges = edges(true);
        let mut state = EdgeState::new(6);
        let even = contact(&[1.0; 6]);
        edges.follow([&even, &even], 1.0, worn(&[7.0; 6]), &mut state);
        assert!(state.relief.iter().all(|relief| relief.abs() < 1e-15), "{:?}", state.relief);
        let least = contact(&[f64::MIN_POSITIVE, 1.0, -1.0, f64::MIN_POSITIVE, -1.0, 0.0]);
        edges.follow([&least, &least], 1.0, worn(&[9.0; 6]), &mut state);
        assert!(state.relief.iter().all(|relief| relief.is_finite()), "{:?}", state.relief);
    }

    /// Cells of the bed of springs.
    const CELLS: usize = 20;

    /// Error of the width in contact over a run, in cells: its mean, and the largest magnitude of its deviation.
    ///
    /// A parabola of height `height(t)` and curvature `bow(t)` is pressed into a bed of springs that wears at `rate` times its compression,
    /// 1 s long. The bed is resolved by 64 springs a cell for the exact width, and by one for that of the edges.
    fn error_of_width(rate: f64, height: impl Fn(f64) -> f64, bow: impl Fn(f64) -> f64) -> [f64; 2] {
        const FINE: usize = 64;
        const STEPS: usize = 200;
        let width = 2.0 / CELLS as f64;
        let edges = Edges::new(&[width; CELLS], false, |i, j| if i == j { 2.0 } else { 0.0 });
        let mut state = EdgeState::new(CELLS);
        let (mut fine_wear, mut wear) = ([0.0; CELLS * FINE], [0.0; CELLS]);
        let step = 1.0 / STEPS as f64;
        let (mut errors, mut before) = (Vec::new(), None);
        for n in 0..=STEPS {
            let time = n as f64 * step;
            let overlap = |x: f64| height(time) - bow(time) * x * x;
            let (mut depth, mut exact) = ([0.0; CELLS], 0);
            for (k, worn) in fine_wear.iter_mut().enumerate() {
                let compressed = overlap((k as f64 + 0.5) * width / FINE as f64 - 1.0) - *worn;
                exact += usize::from(compressed > 0.0);
                *worn += rate * step * compressed.max(0.0);
            }
            for (i, depth) in depth.iter_mut().enumerate() {
                let centre = (i as f64 + 0.5) * width - 1.0;
                *depth = height(time) - bow(time) * (centre * centre + width * width / 12.0) - wear[i];
            }
            let end = contact(&depth);
            edges.follow([before.as_ref().unwrap_or(&end), &end], step, worn(&wear), &mut state);
            let parts: f64 = (fractions(&edges, &state, 0.0).into_iter().zip(depth))
                .map(|(fraction, depth)| if depth > 0.0 || fraction < 1.0 { fraction } else { 0.0 })
                .sum();
            errors.push(parts - exact as f64 / FINE as f64);
            wear.iter_mut().zip(depth).for_each(|(worn, depth)| *worn += rate * step * depth.max(0.0));
            before = Some(end);
        }
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        [mean, errors.iter().fold(0.0, |most, error| error.abs().max(most))]
    }

    #[test]
    fn the_width_in_contact_is_that_of_a_fine_bed_of_springs() {
        for rate in [0.0, 0.3, 3.0, 30.0] {
            let cases = [
                ("recedes", error_of_width(rate, |t| 1.0 + rate * t, |t| 1.5 + (5.0 + rate) * t)),
                ("stands", error_of_width(rate, |_| 1.0, |_| 3.3)),
                ("spreads", error_of_width(rate, |t| 0.3 + 1.2 * t, |_| 2.5)),
            ];
            for (course, [mean, most]) in cases {
                assert!(mean.abs() < 0.08 && most < 0.15, "rate {rate}, {course}: {mean} and {most} cells");
            }
        }
    }
}
