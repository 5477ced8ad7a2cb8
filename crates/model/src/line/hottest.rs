//! Highest temperature of the contact: the largest mean over a stated length.
//!
//! A pressure that is singular at an edge, like x^(-1/2) under a sharp corner, has its friction heat there, so the temperature of
//! the edge cell increases without bound on finer meshes, while the mean over a length independent of the mesh converges. The
//! length L is the station spacing of a profile, a 32nd of the width.
//!
//! ```text
//! T_max = max over surfaces, and x from -a to a - L, of  1/L integral of T from x to x + L
//! ```
//!
//! Temperatures are constant on the cells, so the mean is piecewise linear in x, with breakpoints where either end of the
//! interval is a cell boundary: its maximum is at one of these. On a closed line intervals cross the seam.
//!
//! Theory: docs/theory.md, section 8.4.

use elasticity::{Cells, MAXIMUM_CELLS};
use scene::STATIONS;

/// Number of lengths L in the width.
const LENGTHS: usize = STATIONS - 1;

/// End of an interval: its cell, and distance from the cell's left edge, m.
type End = (usize, f64);

/// Candidate intervals for the largest mean temperature.
#[derive(Clone, PartialEq, Debug)]
pub struct Hottest {
    widths: Vec<f64>,
    /// L, m.
    length: f64,
    /// Both ends, and whether the interval crosses the seam.
    intervals: Vec<(End, End, bool)>,
}

impl Hottest {
    /// Intervals on these cells; `closed`: the last cell is beside the first.
    pub fn new(cells: &Cells, closed: bool) -> Hottest {
        let (edges, count) = (cells.edges(), cells.count());
        let (first, last) = (edges[0], edges[count]);
        let length = (last - first) / LENGTHS as f64;
        let end = |x: f64| -> End {
            let cell = edges[1..count].partition_point(|&edge| edge <= x);
            (cell, (x - edges[cell]).clamp(0.0, cells.widths()[cell]))
        };
        let at = |boundary: usize| -> End {
            if boundary < count { (boundary, 0.0) } else { (count - 1, cells.widths()[count - 1]) }
        };
        let period = last - first;
        // An interval as long as the distance to the edge ends there in spite of rounding.
        let slack = 1e-9 * length;
        let mut intervals = Vec::with_capacity(2 * count + 2);
        for boundary in 0..=count {
            let (to, from) = (edges[boundary] + length, edges[boundary] - length);
            if to <= last + slack {
                intervals.push((at(boundary), end(to), false));
            } else if closed && boundary < count {
                intervals.push((at(boundary), end(to - period), true));
            }
            if from >= first - slack {
                intervals.push((end(from), at(boundary), false));
            } else if closed && boundary > 0 {
                intervals.push((end(from + period), at(boundary), true));
            }
        }
        Hottest { widths: cells.widths().to_vec(), length, intervals }
    }

    /// Highest mean temperature of two surfaces with these temperatures of their cells; NaN where one is NaN.
    pub fn of(&self, surfaces: &[Vec<f64>; 2]) -> f64 {
        let higher = |most: f64, t: f64| if t > most || t.is_nan() { t } else { most };
        surfaces.iter().map(|temperatures| self.of_surface(temperatures)).fold(f64::NEG_INFINITY, higher)
    }

    fn of_surface(&self, temperatures: &[f64]) -> f64 {
        // Cumulative integrals up to the cell boundaries.
        let mut integrals = [0.0; MAXIMUM_CELLS + 1];
        let mut sum = 0.0;
        for (integral, (width, t)) in integrals[1..].iter_mut().zip(self.widths.iter().zip(temperatures)) {
            sum += width * t;
            *integral = sum;
        }
        let until = |(cell, part): End| integrals[cell] + part * temperatures[cell];
        let mut most = f64::NEG_INFINITY;
        for &(from, to, across) in &self.intervals {
            let integral = until(to) - until(from) + if across { sum } else { 0.0 };
            if integral > most || integral.is_nan() {
                most = integral;
            }
        }
        most / self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hottest(cells: &Cells, closed: bool, of: impl Fn(f64, f64) -> f64) -> f64 {
        let means = |side: f64| -> Vec<f64> {
            let ends = cells.edges().windows(2);
            ends.map(|pair| side * of(pair[0], pair[1])).collect()
        };
        Hottest::new(cells, closed).of(&[means(0.5), means(1.0)])
    }

    #[test]
    fn a_singular_edge_has_a_limit() {
        // x^(-1/2) from the left edge of a width of 2: over the first 16th its mean is 2/sqrt(1/16) = 8.
        let mean = |from: f64, to: f64| 2.0 * ((to + 1.0).max(0.0).sqrt() - (from + 1.0).max(0.0).sqrt()) / (to - from);
        let of = |count: usize| (hottest(&Cells::graded(1.0, count).unwrap(), false, mean) - 8.0).abs();
        let errors = [9, 17, 33, 65, 129, 257].map(of);
        assert!(errors[0] < 1.0 && errors[5] < 1e-2, "{errors:?}");
        // The temperature of the hottest cell increases without bound.
        let edge = |count: usize| {
            let cells = Cells::graded(1.0, count).unwrap();
            mean(cells.edges()[0], cells.edges()[1])
        };
        assert!(edge(257) > 100.0, "{}", edge(257));
    }

    #[test]
    fn cells_longer_than_the_length_are_their_own_mean() {
        let cells = Cells::uniform(1.0, 9).unwrap();
        let found = hottest(&cells, false, |from, to| 3.0 - 0.5 * (from + to));
        assert!((found - (3.0 + 8.0 / 9.0)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_peak_is_found_wherever_it_lies() {
        // One cell of 0.9 of the length among cold ones, and one on either side of the seam.
        let count = 257;
        let cells = Cells::uniform(1.0, count).unwrap();
        let length = 2.0 / 32.0;
        for hot in [0, 1, 100, 255, 256] {
            let peak = |i: usize| if i == hot { 1.0 } else { 0.0 };
            let expected = 2.0 / count as f64 / length;
            for closed in [false, true] {
                let temperatures: Vec<f64> = (0..count).map(peak).collect();
                let found = Hottest::new(&cells, closed).of(&[vec![0.0; count], temperatures]);
                assert!((found - expected).abs() < 1e-12, "{hot} {closed}: {found} {expected}");
            }
        }
        let ends = |i: usize| if i == 0 || i == count - 1 { 1.0 } else { 0.0 };
        let temperatures: Vec<f64> = (0..count).map(ends).collect();
        let both = |closed| Hottest::new(&cells, closed).of(&[vec![0.0; count], temperatures.clone()]);
        assert!((both(true) / both(false) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_a_number_is_not_lost() {
        let cells = Cells::graded(1.0, 17).unwrap();
        for hot in [0, 8, 16] {
            let mut temperatures = vec![1.0; 17];
            temperatures[hot] = f64::NAN;
            let hottest = Hottest::new(&cells, false);
            assert!(hottest.of(&[temperatures.clone(), vec![2.0; 17]]).is_nan());
            assert!(hottest.of(&[vec![2.0; 17], temperatures]).is_nan());
        }
    }
}
