//! Worn track of a straight path, stored in the strip's own coordinate.
//!
//! The track is a row of cells of equal length with their mean worn depths. A contact of half-length a that moves from x0 to
//! x1, and would wear a point that stays under it by the depth D, adds to the cell [l, r]
//!
//! ```text
//! D/(r - l) * mean over x in [x0, x1] of |[l, r] cut with [x - a, x + a]|
//! ```
//!
//! in closed form. The sum over the cells telescopes, so the worn volume is the integral of the law to rounding, whatever
//! the cell length. The window has a fixed number of cells: those far behind a contact that slides on are discarded (their
//! volume remains counted), and a return to them is reported.
//!
//! Theory: docs/theory.md, section 5.5.

/// Number of cells of the window.
const TRACK_CELLS: usize = 64;

/// Worn track under a lumped contact.
#[derive(Clone, PartialEq, Debug)]
pub struct Track {
    cell: f64,
    half_length: f64,
    /// Index of the first stored cell; cell i spans [i, i + 1] times the cell length.
    first: i64,
    /// Number of stored cells.
    count: usize,
    depth: [f64; TRACK_CELLS],
    /// Bounds of the discarded cells: those below the first or above the second.
    discarded: Option<(i64, i64)>,
    revisited: bool,
}

impl Track {
    /// A fresh track for a contact of `half_length` (m) whose strokes are `stroke` (m) long.
    pub fn new(half_length: f64, stroke: f64) -> Track {
        let width = 2.0 * half_length;
        // The window holds the stroke, the contact and as much again on both sides.
        let cell = (width / 8.0).max((stroke + 3.0 * width) / (TRACK_CELLS - 4) as f64);
        Track { cell, half_length, first: 0, count: 0, depth: [0.0; TRACK_CELLS], discarded: None, revisited: false }
    }

    /// Whether the contact returned to a discarded part of the track.
    pub fn revisited(&self) -> bool {
        self.revisited
    }

    fn at(&self, index: i64) -> f64 {
        let offset = index - self.first;
        if (0..self.count as i64).contains(&offset) { self.depth[offset as usize] } else { 0.0 }
    }

    /// Extends the window to the cells from `low` to `high`.
    fn cover(&mut self, low: i64, high: i64) {
        if self.count == 0 {
            self.first = low;
        }
        let span_low = low.min(self.first);
        let span_high = high.max(self.first + self.count as i64 - 1);
        let room = TRACK_CELLS as i64;
        // Cells are discarded on the side away from the contact.
        let (mut from, mut to) = (span_low, span_high);
        if to - from + 1 > room {
            if low < self.first {
                to = (from + room - 1).max(high);
                from = to - room + 1;
            } else {
                from = (to - room + 1).min(low);
                to = from + room - 1;
            }
            let (below, above) = self.discarded.unwrap_or((i64::MIN, i64::MAX));
            let below = if from > span_low && self.count > 0 { below.max(from) } else { below };
            let above = if to < span_high { above.min(to) } else { above };
            self.discarded = Some((below, above));
        }
        if let Some((below, above)) = self.discarded
            && (low < below || high > above)
        {
            self.revisited = true;
        }
        if from != self.first || to - from + 1 != self.count as i64 {
            let mut depth = [0.0; TRACK_CELLS];
            for index in from..=to {
                depth[(index - from) as usize] = self.at(index);
            }
            self.depth = depth;
            self.first = from;
            self.count = (to - from + 1) as usize;
        }
    }

    /// Adds the wear `depth` (m) under the contact while its middle moves from `x0` to `x1` (m). A motion longer than the
    /// window is split.
    pub fn wear(&mut self, x0: f64, x1: f64, depth: f64) {
        let longest = (TRACK_CELLS as f64 - 4.0) * self.cell - 2.0 * self.half_length;
        let pieces = ((x1 - x0).abs() / longest).ceil().max(1.0);
        // Of a very long motion only the part that remains in the window.
        for left in [3.0, 2.0, 1.0] {
            let piece = pieces - left;
            if piece >= 0.0 {
                let from = x0 + (x1 - x0) * (piece / pieces);
                let to = x0 + (x1 - x0) * ((piece + 1.0) / pieces);
                self.wear_piece(from, to, depth / pieces);
            }
        }
    }

    fn wear_piece(&mut self, x0: f64, x1: f64, depth: f64) {
        let (left, right) = (x0.min(x1) - self.half_length, x0.max(x1) + self.half_length);
        let low = (left / self.cell).floor() as i64;
        // Rounding of distant positions exceeds a cell; the window's length bounds the rest.
        let high =
            ((right / self.cell).ceil() as i64).saturating_sub(1).min(low.saturating_add(TRACK_CELLS as i64 - 1));
        self.cover(low, high);
        let mut before = self.passed(low as f64 * self.cell, x0, x1);
        for index in low..=high {
            let after = self.passed((index + 1) as f64 * self.cell, x0, x1);
            self.depth[(index - self.first) as usize] += depth * (after - before) / self.cell;
            before = after;
        }
    }

    /// Mean over x in [x0, x1] of the length of the contact [x - a, x + a] below `edge`, less a.
    fn passed(&self, edge: f64, x0: f64, x1: f64) -> f64 {
        let a = self.half_length;
        let travel = x1 - x0;
        if travel.abs() < 1e-6 * a {
            return (edge - 0.5 * (x0 + x1)).clamp(-a, a);
        }
        let primitive = |u: f64| if u.abs() < a { 0.5 * u * u } else { a * (u.abs() - 0.5 * a) };
        (primitive(edge - x0) - primitive(edge - x1)) / travel
    }

    /// Mean worn depth (m) over [from, to] (m) in the strip's coordinate; of an interval without length the depth there.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        if to <= from {
            return self.at((from / self.cell).floor() as i64);
        }
        let low = ((from / self.cell).floor() as i64).max(self.first);
        let high = ((to / self.cell).ceil() as i64 - 1).min(self.first + self.count as i64 - 1);
        let mut sum = 0.0;
        for index in low..=high {
            let (left, right) = (index as f64 * self.cell, (index + 1) as f64 * self.cell);
            sum += self.at(index) * (right.min(to) - left.max(from)).max(0.0);
        }
        sum / (to - from)
    }

    /// Mean worn depth (m) under a contact whose middle is at `x` (m).
    pub fn under(&self, x: f64) -> f64 {
        self.mean(x - self.half_length, x + self.half_length)
    }

    /// Largest mean worn depth (m) under a contact anywhere on the track.
    pub fn deepest(&self) -> f64 {
        let worn = &self.depth[..self.count];
        let (length, last) = (2.0 * self.half_length / self.cell, self.count as f64);
        // Integral over the cells from the first one, in cells; its difference over the contact is largest where an end of the
        // contact is at an end of a cell.
        let mut integrals = [0.0; TRACK_CELLS + 1];
        for (cell, depth) in worn.iter().enumerate() {
            integrals[cell + 1] = integrals[cell] + depth;
        }
        let until = |x: f64| {
            let x = x.clamp(0.0, last);
            let cell = x as usize;
            integrals[cell] + if cell < self.count { (x - cell as f64) * worn[cell] } else { 0.0 }
        };
        let ends = (0..=self.count).flat_map(|cell| [cell as f64, cell as f64 - length]);
        ends.map(|from| (until(from + length) - until(from)) / length).fold(0.0, f64::max)
    }

    /// Appends the numbers of a saved state, in order; see [`Track::load`].
    pub fn save(&self, out: &mut Vec<f64>) {
        let (below, above) = self.discarded.unwrap_or((i64::MIN, i64::MAX));
        out.extend([self.cell, self.half_length]);
        out.extend([self.first as f64, self.count as f64, f64::from(u8::from(self.revisited))]);
        out.extend([below as f64, above as f64, f64::from(u8::from(self.discarded.is_some()))]);
        out.extend(&self.depth[..self.count]);
    }

    /// Reads the numbers of [`Track::save`]; `None` if they are not a valid track.
    pub fn load(&mut self, numbers: &mut std::slice::Iter<'_, f64>) -> Option<()> {
        let mut next = || numbers.next().copied();
        (self.cell, self.half_length) = (next()?, next()?);
        let (first, count, revisited) = (next()?, next()?, next()?);
        let (below, above, discarded) = (next()?, next()?, next()?);
        if !(0.0..=TRACK_CELLS as f64).contains(&count) || !first.is_finite() {
            return None;
        }
        self.first = first as i64;
        self.count = count as usize;
        self.revisited = revisited != 0.0;
        self.discarded = (discarded != 0.0).then_some((below as i64, above as i64));
        self.depth = [0.0; TRACK_CELLS];
        for slot in &mut self.depth[..self.count] {
            *slot = next()?;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(track: &Track) -> f64 {
        track.depth[..track.count].iter().sum::<f64>() * track.cell
    }

    #[test]
    fn the_deepest_place_is_the_largest_mean_under_a_contact() {
        let mut track = Track::new(0.5, 3.0);
        assert_eq!(track.deepest(), 0.0);
        let (mut x, mut random) = (0.0, test_support::Random(11));
        for _ in 0..200 {
            let next = random.between(-1.5, 1.5);
            track.wear(x, next, random.between(1e-6, 2e-6));
            x = next;
            let searched = (0..=20_000).map(|k| track.under(f64::from(k) * 2.5e-4 - 2.5)).fold(0.0, f64::max);
            let found = track.deepest();
            assert!(found >= searched * (1.0 - 1e-12) && found < 1.001 * searched, "{found:e} {searched:e}");
        }
    }

    #[test]
    fn worn_volume_is_the_integral_of_the_law() {
        let mut track = Track::new(0.5, 3.0);
        let (mut x, mut total) = (0.0, 0.0);
        let mut random = test_support::Random(7);
        for _ in 0..2000 {
            let next = random.between(-1.5, 1.5);
            let depth = random.between(1e-6, 2e-6);
            track.wear(x, next, depth);
            total += depth * 1.0;
            x = next;
        }
        assert!((volume(&track) / total - 1.0).abs() < 1e-12, "{} {total}", volume(&track));
        assert!(!track.revisited());
    }

    #[test]
    fn far_beyond_the_resolution_of_positions_the_mean_is_that_of_a_point() {
        let mut track = Track::new(0.5, 3.0);
        track.wear(0.0, 1.0, 1e-6);
        assert_eq!(track.under(5e15), 0.0);
        assert_eq!(track.mean(0.5, 0.5), track.at((0.5 / track.cell).floor() as i64));
    }

    #[test]
    fn unidirectional_groove_is_half_the_depth_of_a_full_pass() {
        // Depth per distance r: the groove under the contact grows from 0 at the leading edge to 2 a r.
        let mut track = Track::new(0.5, 0.0);
        let rate = 1e-3;
        let mut x = 0.0;
        for _ in 0..1000 {
            track.wear(x, x + 0.01, rate * 0.01);
            x += 0.01;
        }
        assert!((track.under(x) / (0.5 * rate) - 1.0).abs() < 2e-2, "{}", track.under(x));
        // One long step gives the same as many short ones: the footprint is integrated exactly.
        let mut long = Track::new(0.5, 0.0);
        long.wear(0.0, 10.0, rate * 10.0);
        assert!((long.under(10.0) / track.under(x) - 1.0).abs() < 1e-9);
        // A return behind a window that has moved on is reported.
        track.wear(x, x - 9.9, rate * 9.9);
        assert!(track.revisited());
    }
}
