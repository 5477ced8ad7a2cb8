//! Worn track of a straight strip under the cells of the contact line, stored in the strip's own coordinate.
//!
//! # Transport of the worn shape
//!
//! A straight strip slides through the contact: material worn under one cell is under other cells a moment later. With the
//! middle of the contact at `x(t)` and the depth rate `f(xi, t)` at `xi` in the frame of the punch, the depth `W` at the
//! point `X` of the strip follows
//!
//! ```text
//! dW/dt (X, t) = f(X - x(t), t)   where |X - x(t)| <= a,   0 elsewhere
//! ```
//!
//! and the gap of the contact contains `s_i`, the mean of `W` over `[x + e_i, x + e_(i+1)]`, e_i the edges of its cells.
//!
//! # Steps
//!
//! While the contact moves at constant speed from x0 to x1 = x0 + L and cell j would wear a point that stayed under it all
//! the time by the depth d_j, a point is worn by `d_j` times the fraction of the time that it spends under cell j:
//!
//! ```text
//! s_i(x1) = mean of W(before) over the cell at x1 + sum_j T_ij(L) d_j,
//! T_ij(L) = 1/(w_i |L|) area of { xi in cell i, eta in cell j, eta - xi between 0 and L }
//! ```
//!
//! [`LineTrack::depth_under`] is the first term, [`LineTrack::operator`] is T, [`LineTrack::deposit`] updates W. T is the
//! identity at L = 0; with L > 0 its diagonal is `1 - L/(2 w_i)`, for `L >= w_i` `w_i/(2 L)`, and cells ahead (larger x)
//! contribute to those behind; once L exceeds the width, L T is the operator of the steady groove.
//!
//! In a step of SDIRK2 the rate of the first stage acts during the fraction `1 - gamma` of the step, that of the second
//! during the remaining fraction `gamma`. That is second order, and one operator `T(gamma L)` serves both stages:
//!
//! ```text
//! first:  s = depth_under(x0 + gamma L)         + gamma h T(gamma L) f_1;    deposit(x0, x1 - gamma L, (1 - gamma) h f_1)
//! end:    s = depth_under(x1)                   + gamma h T(gamma L) f_2;    deposit(x1 - gamma L, x1, gamma h f_2)
//! ```
//!
//! A travel of at most [`LineTrack::longest_travel`] per step bounds the change of shape by advection, which is explicit.
//!
//! # Accuracy
//!
//! The track is a row of cells of equal length, each with its mean depth. Deposits are exact means of the integral above,
//! and their sum telescopes: the worn volume is the integral of the law to rounding. The track itself is not advected, so
//! there is no numerical diffusion. Reading reconstructs W linearly within a track cell (with limited slopes, so that no new
//! extremum arises): second order in the track's cell, which is half the smallest contact cell as long as 8192 cells
//! suffice.
//!
//! # Short strokes
//!
//! For strokes up to [`AVERAGED_STROKE`] half-widths the mean over a cycle is used instead: one constant operator, and steps
//! of any length. The neglected effect is the correlation of pressure and position within a stroke. The error of the mean
//! pressure over a cycle is at most 0.4 % of the mean pressure on a half-plane at |x| < 0.8 a (0.06 % on a Winkler
//! foundation); within a stroke of the edges, where the contact rides up the ends of its own groove, tens of percent of the
//! local peak. [`LineTrack::resolved`] never averages.
//!
//! Theory: docs/theory.md, section 5.5.

mod averaged;
mod operator;
#[cfg(test)]
mod tests;

use averaged::Averaged;
use elasticity::Cells;
use nalgebra::DMatrix;

/// Largest number of cells of a track: 64 KB.
const LARGEST: usize = 8192;
/// Smallest number of cells of a track.
const SMALLEST: usize = 256;
/// Longest stroke, in half-widths, that is averaged over the cycle.
pub const AVERAGED_STROKE: f64 = 0.02;

/// Worn track of a straight strip. No allocation after [`LineTrack::new`], except in [`LineTrack::save`].
#[derive(Clone, Debug, PartialEq)]
pub struct LineTrack {
    /// Edges of the contact's cells, m, from -a to a.
    edges: Vec<f64>,
    /// Length of the track's cells, m. Cell k spans [k, k + 1] times this in the strip's coordinate.
    cell: f64,
    /// Ring buffer of mean depths: cell k is in slot k modulo the length, a power of two. Zero outside the worn span.
    depth: Vec<f64>,
    /// First cell of the worn span, and their number.
    first: i64,
    count: usize,
    /// Bounds of the discarded worn cells: those below the first, or from the second on, were dropped from the window.
    discarded: Option<(i64, i64)>,
    revisited: bool,
    /// Present where strokes are short enough to be averaged.
    averaged: Option<Averaged>,
    /// Whether strokes are averaged: until the contact leaves the span of a stroke.
    averaging: bool,
    /// Workspace: integral of a deposit up to the edges of the contact's cells, and its own integral.
    taken: Vec<f64>,
    taken_twice: Vec<f64>,
}

impl LineTrack {
    /// Fresh track for strokes of the length `stroke` (m; 0: unidirectional) of a contact with these cells.
    ///
    /// The window holds a stroke and a quarter, the contact, and half a half-width more on both sides. It follows a contact
    /// that slides on and discards the cells behind it. Strokes up to [`AVERAGED_STROKE`] half-widths are averaged until the
    /// contact leaves the span of one and a half strokes.
    pub fn new(cells: &Cells, stroke: f64) -> Self {
        let averaging = stroke > 0.0 && stroke <= AVERAGED_STROKE * cells.half_width();
        let averaged = averaging.then(|| Averaged::new(cells, stroke));
        Self { averaging, averaged, ..Self::resolved(cells, stroke) }
    }

    /// [`Self::new`] without averaging, however short the strokes are.
    pub(crate) fn resolved(cells: &Cells, stroke: f64) -> Self {
        let half_width = cells.half_width();
        let length = 1.25 * stroke + 3.0 * half_width;
        let finest = cells.widths().iter().copied().fold(f64::INFINITY, f64::min);
        let wanted = (2.0 * length / finest).ceil().clamp(SMALLEST as f64, LARGEST as f64) as usize;
        let room = wanted.next_power_of_two().min(LARGEST);
        let count = cells.count();
        Self {
            edges: cells.edges().to_vec(),
            cell: length / (room - 4) as f64,
            depth: vec![0.0; room],
            first: 0,
            count: 0,
            discarded: None,
            revisited: false,
            averaged: None,
            averaging: false,
            taken: vec![0.0; count + 1],
            taken_twice: vec![0.0; count + 1],
        }
    }

    /// Whether the contact returned to a discarded worn part of the track, where depths are too small.
    pub fn revisited(&self) -> bool {
        self.revisited
    }

    /// Whether the strip is worn as the mean over a cycle.
    pub(crate) fn is_averaged(&self) -> bool {
        self.averaging
    }

    /// Longest travel (m) of one step: a quarter of the half-width; no limit while strokes are averaged.
    pub fn longest_travel(&self) -> f64 {
        // Longest travel of one step in half-widths.
        if self.is_averaged() { f64::INFINITY } else { 0.25 * self.half_width() }
    }

    /// Worn volume in the window, m2 (per depth of the contact), without the discarded cells.
    pub fn volume(&self) -> f64 {
        let averaged = self.active().map_or(0.0, |averaged| averaged.volume(&self.edges));
        (0..self.count as i64).map(|k| self.depth[self.slot(self.first + k)]).sum::<f64>() * self.cell + averaged
    }

    /// T for a travel of `travel` (m, signed), N x N: `out[(i, j)]` is the mean depth under cell i at the end per depth by
    /// which cell j would wear a point that stays under it. Independent of the travel while strokes are averaged.
    pub fn operator(&self, travel: f64, out: &mut DMatrix<f64>) {
        match self.active() {
            Some(averaged) => out.copy_from(averaged.operator()),
            None => operator::travelling(&self.edges, travel, out),
        }
    }

    /// Mean worn depth (m) under every cell of a contact whose middle is at `position` (m, strip's coordinate).
    pub fn depth_under(&self, position: f64, out: &mut [f64]) {
        assert_eq!(out.len() + 1, self.edges.len(), "one depth per cell");
        if let Some(averaged) = self.active() {
            out.copy_from_slice(averaged.shape());
            return;
        }
        // Lengths in track cells relative to `base` keep their accuracy however far the contact has moved.
        let base = ((position + self.edges[0]) / self.cell).floor();
        let offset = position / self.cell - base;
        let mut index = 0;
        let mut local = self.linear(base as i64);
        let mut left = offset + self.edges[0] / self.cell;
        for (value, edge) in out.iter_mut().zip(&self.edges[1..]) {
            let right = offset + edge / self.cell;
            let (mut sum, mut from) = (0.0, left);
            // A cell of the contact covers no more cells than the track has.
            for _ in 0..=self.depth.len() {
                let to = right.min((index + 1) as f64);
                sum += (to - from) * (local[0] + local[1] * (0.5 * (from + to) - index as f64 - 0.5));
                if right <= (index + 1) as f64 {
                    break;
                }
                from = to;
                index += 1;
                local = self.linear(base as i64 + index);
            }
            *value = sum / (right - left);
            left = right;
        }
    }

    /// Updates the track for a motion at constant speed from `x0` to `x1` (m) in which cell j would wear a point that stays
    /// under it by `depth[j]` (m).
    ///
    /// Motions longer than the window are split. Worn volume: `sum_j w_j depth[j]`, to rounding.
    pub fn deposit(&mut self, x0: f64, x1: f64, depth: &[f64]) {
        assert_eq!(depth.len() + 1, self.edges.len(), "one depth per cell");
        if let Some(averaged) = self.averaged.as_mut().filter(|_| self.averaging) {
            if averaged.follow(x0, x1) {
                averaged.deposit(depth);
                return;
            }
            self.resolve();
        }
        let edges = std::mem::take(&mut self.edges);
        let longest = (self.depth.len() - 2) as f64 * self.cell - (edges[edges.len() - 1] - edges[0]);
        let pieces = ((x1 - x0).abs() / longest).ceil().max(1.0);
        let at = |piece: f64| x0 + (x1 - x0) * (piece / pieces);
        // Of a very long motion only the part that remains in the window.
        for left in [3.0, 2.0, 1.0] {
            let piece = pieces - left;
            if piece >= 0.0 {
                self.deposit_piece(&edges, depth, 1.0 / pieces, at(piece), at(piece + 1.0));
            }
        }
        self.edges = edges;
    }

    /// Continues without averaging: the mean profile becomes the track under the middle of the strokes.
    fn resolve(&mut self) {
        let Some(averaged) = self.averaged.take() else { return };
        let (middle, edges) = (averaged.middle(), std::mem::take(&mut self.edges));
        self.deposit_piece(&edges, averaged.shape(), 1.0, middle, middle);
        for (edges, depth) in averaged.margins(&edges) {
            self.deposit_piece(&edges, &[depth], 1.0, middle, middle);
        }
        self.edges = edges;
        self.averaged = Some(averaged);
        self.averaging = false;
    }

    fn active(&self) -> Option<&Averaged> {
        self.averaged.as_ref().filter(|_| self.averaging)
    }

    /// The deposit `share * depth` of cells with the given edges, over a motion that the window can hold.
    fn deposit_piece(&mut self, edges: &[f64], depth: &[f64], share: f64, x0: f64, x1: f64) {
        let count = depth.len();
        let (left, right) = (x0.min(x1), x0.max(x1));
        let base = ((left + edges[0]) / self.cell).floor();
        // Rounding of distant positions exceeds a cell; the window's length bounds the rest.
        let last = (((right + edges[count]) / self.cell).ceil() as i64)
            .saturating_sub(1)
            .min((base as i64).saturating_add(self.depth.len() as i64 - 1));
        self.cover(base as i64, last.max(base as i64));
        // D, the integral of the depth up to an edge, and its integral.
        (self.taken[0], self.taken_twice[0]) = (0.0, 0.0);
        for j in 0..count {
            let (width, part) = (edges[j + 1] - edges[j], share * depth[j]);
            self.taken[j + 1] = self.taken[j] + width * part;
            self.taken_twice[j + 1] = self.taken_twice[j] + width * (self.taken[j] + 0.5 * width * part);
        }
        let total = self.taken[count];
        // Mean of D over [low, high]; the cursors count the edges below them.
        let (mut low_cursor, mut high_cursor) = (0, 0);
        let (low_offset, high_offset) = (base * self.cell - right, base * self.cell - left);
        let cells = last - base as i64;
        let mut before = 0.0;
        for k in 0..=cells {
            let after = if k == cells {
                total
            } else {
                let far = (k + 1) as f64 * self.cell;
                let (low, high) = (far + low_offset, far + high_offset);
                low_cursor = advance(edges, low_cursor, low);
                high_cursor = advance(edges, high_cursor, high);
                self.mean_taken(edges, total, (low, low_cursor), (high, high_cursor))
            };
            let slot = self.slot(base as i64 + k);
            self.depth[slot] += (after - before) / self.cell;
            before = after;
        }
    }

    /// Mean of D between two points with the number of edges below each.
    fn mean_taken(&self, edges: &[f64], total: f64, low: (f64, usize), high: (f64, usize)) -> f64 {
        let count = edges.len();
        let value = |(x, cursor): (f64, usize)| match cursor {
            0 => 0.0,
            _ if cursor >= count => total,
            _ => {
                let (here, next) = (edges[cursor - 1], edges[cursor]);
                let taken = self.taken[cursor - 1];
                taken + (self.taken[cursor] - taken) * ((x - here) / (next - here))
            }
        };
        if low.1 == high.1 {
            return 0.5 * (value(low) + value(high));
        }
        let (inner_low, inner_high) = (low.1, high.1 - 1);
        let lengths = [edges[inner_low] - low.0, edges[inner_high] - edges[inner_low], high.0 - edges[inner_high]];
        let sum = 0.5 * lengths[0] * (value(low) + self.taken[inner_low])
            + (self.taken_twice[inner_high] - self.taken_twice[inner_low])
            + 0.5 * lengths[2] * (self.taken[inner_high] + value(high));
        sum / (lengths[0] + lengths[1] + lengths[2])
    }

    fn half_width(&self) -> f64 {
        self.edges[self.edges.len() - 1]
    }

    fn slot(&self, index: i64) -> usize {
        // The length is a power of two: the mask gives the remainder, also of negative numbers.
        (index & (self.depth.len() as i64 - 1)) as usize
    }

    fn at(&self, index: i64) -> f64 {
        let inside = index >= self.first && index < self.first + self.count as i64;
        if inside { self.depth[self.slot(index)] } else { 0.0 }
    }

    /// Mean and limited slope per cell (slope limiter): the central slope, at most twice the smaller of the differences to
    /// both sides.
    fn linear(&self, index: i64) -> [f64; 2] {
        let (before, mean, after) = (self.at(index - 1), self.at(index), self.at(index + 1));
        let (down, up) = (mean - before, after - mean);
        let slope = if down * up <= 0.0 {
            0.0
        } else {
            (0.5 * (down + up)).abs().min(2.0 * down.abs()).min(2.0 * up.abs()).copysign(up)
        };
        [mean, slope]
    }

    /// Extends the worn span to the cells from `low` to `high`, and discards cells at its far end.
    fn cover(&mut self, low: i64, high: i64) {
        let room = self.depth.len() as i64;
        if self.count == 0 {
            self.first = low;
        }
        let end = self.first + self.count as i64;
        let (mut from, mut to) = (low.min(self.first), (high + 1).max(end));
        if to - from > room {
            if low < self.first {
                to = from + room;
            } else {
                from = to - room;
            }
            let (below, above) = self.discarded.unwrap_or((i64::MIN, i64::MAX));
            let below = if from > self.first { below.max(from) } else { below };
            let above = if to < end { above.min(to) } else { above };
            self.discarded = Some((below, above));
        }
        if self.discarded.is_some_and(|(below, above)| low < below || high >= above) {
            self.revisited = true;
        }
        for index in self.first..from.min(end) {
            let slot = self.slot(index);
            self.depth[slot] = 0.0;
        }
        for index in to.max(self.first)..end {
            let slot = self.slot(index);
            self.depth[slot] = 0.0;
        }
        self.first = from;
        self.count = (to - from) as usize;
    }

    /// Copies another track of the same contact and stroke without allocating: restores the state before a rejected step.
    pub fn copy_from(&mut self, other: &Self) {
        self.depth.copy_from_slice(&other.depth);
        (self.first, self.count) = (other.first, other.count);
        (self.discarded, self.revisited) = (other.discarded, other.revisited);
        self.averaging = other.averaging;
        if let (Some(own), Some(averaged)) = (&mut self.averaged, &other.averaged) {
            own.copy_from(averaged);
        }
    }

    /// Appends the numbers of a saved state; see [`LineTrack::load`].
    pub fn save(&self, out: &mut Vec<f64>) {
        let (below, above) = self.discarded.unwrap_or((0, 0));
        let flag = |value: bool| f64::from(u8::from(value));
        out.extend([self.first as f64, self.count as f64, flag(self.revisited)]);
        out.extend([flag(self.discarded.is_some()), below as f64, above as f64]);
        out.extend((0..self.count as i64).map(|k| self.depth[self.slot(self.first + k)]));
        out.push(flag(self.is_averaged()));
        if let Some(averaged) = self.active() {
            averaged.save(out);
        }
    }

    /// Reads the numbers of [`LineTrack::save`] of a track of the same cells and stroke; `None`, and an unchanged track,
    /// where they are not valid.
    pub fn load(&mut self, numbers: &mut std::slice::Iter<'_, f64>) -> Option<()> {
        let mut next = || numbers.next().copied();
        let (first, count, revisited) = (next()?, next()?, next()?);
        let (discarded, below, above) = (next()?, next()?, next()?);
        let whole = |value: f64| value.is_finite() && value.abs() < 9e18 && value.fract() == 0.0;
        if ![first, count].into_iter().all(whole) || !(0.0..=self.depth.len() as f64).contains(&count) {
            return None;
        }
        let count = count as usize;
        let depth = numbers.as_slice().get(..count)?;
        let mut rest = numbers.as_slice()[count..].iter();
        if depth.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let averaging = *rest.next()? != 0.0;
        if averaging {
            self.averaged.as_mut()?.load(&mut rest)?;
        }
        self.averaging = averaging;
        (self.first, self.count) = (first as i64, count);
        self.revisited = revisited != 0.0;
        // The bounds i64::MIN and MAX survive: the conversion to f64 and back saturates.
        self.discarded = (discarded != 0.0).then_some((below as i64, above as i64));
        self.depth.fill(0.0);
        for (k, value) in depth.iter().enumerate() {
            let slot = self.slot(self.first + k as i64);
            self.depth[slot] = *value;
        }
        *numbers = rest;
        Some(())
    }
}

/// Number of edges at or below x, from a smaller one on.
fn advance(edges: &[f64], mut cursor: usize, x: f64) -> usize {
    while cursor < edges.len() && edges[cursor] <= x {
        cursor += 1;
    }
    cursor
}
