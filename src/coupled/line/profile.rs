//! From the cells of the contact line to the stations of the profiles.
//!
//! A station's value is the mean over its own interval, half an interval at the two edges, so the trapezoid sum over
//! the stations is the integral over the cells to rounding, whatever the number of cells.

use crate::elastic::Cells;
use crate::scene::STATIONS;

/// Parts of every station's interval that lie in the cells.
#[derive(Clone, PartialEq, Debug)]
pub struct Profile {
    positions: [f64; STATIONS],
    /// First overlapping cell of every station, and where its parts begin in `parts`; one more at the end.
    first: [(usize, usize); STATIONS + 1],
    parts: Vec<f64>,
}

impl Profile {
    /// Stations spread evenly over the cells, from edge to edge.
    pub fn new(cells: &Cells) -> Profile {
        let half_width = cells.half_width();
        let spacing = 2.0 * half_width / (STATIONS - 1) as f64;
        let mut profile = Profile {
            positions: [0.0; STATIONS],
            first: [(0, 0); STATIONS + 1],
            parts: Vec::with_capacity(4 * STATIONS),
        };
        let edges = cells.edges();
        for station in 0..STATIONS {
            let middle = spacing * station as f64 - half_width;
            profile.positions[station] = middle;
            let (from, to) = (middle - 0.5 * spacing, middle + 0.5 * spacing);
            let (from, to) = (from.max(-half_width), if station + 1 == STATIONS { half_width } else { to });
            let first = edges[1..].partition_point(|&edge| edge <= from);
            profile.first[station] = (first, profile.parts.len());
            for cell in first..cells.count() {
                let part = edges[cell + 1].min(to) - edges[cell].max(from);
                if part <= 0.0 {
                    break;
                }
                profile.parts.push(part / (to - from));
            }
        }
        profile.first[STATIONS] = (cells.count(), profile.parts.len());
        profile
    }

    /// Positions of the stations, m.
    pub fn positions(&self) -> &[f64; STATIONS] {
        &self.positions
    }

    /// Mean over the interval of `station` of the quantity with these cell means.
    pub fn mean(&self, station: usize, means: &[f64]) -> f64 {
        let (first, begin) = self.first[station];
        let parts = &self.parts[begin..self.first[station + 1].1];
        parts.iter().zip(&means[first..]).map(|(part, mean)| part * mean).sum()
    }
}

/// Cell means of a quantity given at the stations and linear between them.
pub fn cell_means(cells: &Cells, values: &[f64; STATIONS]) -> Vec<f64> {
    let half_width = cells.half_width();
    let spacing = 2.0 * half_width / (STATIONS - 1) as f64;
    // Integral from the -x edge; linear interpolation integrates to a quadratic within an interval.
    let primitive = |x: f64| {
        let position = ((x + half_width) / spacing).clamp(0.0, (STATIONS - 1) as f64);
        let interval = (position as usize).min(STATIONS - 2);
        let whole: f64 = (0..interval).map(|i| 0.5 * (values[i] + values[i + 1])).sum();
        let part = position - interval as f64;
        (whole + part * (values[interval] + 0.5 * part * (values[interval + 1] - values[interval]))) * spacing
    };
    cells.means_from_primitive(primitive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trapezoid_sum_is_the_integral() {
        for count in [1, 2, 7, 33, 129, 257] {
            let cells = Cells::graded(0.03, count).unwrap();
            let means: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64 * 0.7).sin()).collect();
            let profile = Profile::new(&cells);
            let sum: f64 = (0..STATIONS)
                .map(|k| profile.mean(k, &means) * if k == 0 || k + 1 == STATIONS { 0.5 } else { 1.0 })
                .sum();
            let spacing = 0.06 / 32.0;
            assert!((sum * spacing / cells.integral(&means) - 1.0).abs() < 1e-14, "{count}");
            assert_eq!((profile.positions()[0], profile.positions()[16]), (-0.03, 0.0));
        }
    }

    #[test]
    fn tabulated_values_come_back_as_means() {
        let cells = Cells::graded(0.5, 65).unwrap();
        let values: [f64; STATIONS] = std::array::from_fn(|k| 2.0 + 3.0 * (k as f64 / 32.0 - 0.5));
        for (mean, x) in cell_means(&cells, &values).iter().zip(cells.centres()) {
            assert!((mean - (2.0 + 3.0 * x)).abs() < 1e-13);
        }
        // A hat over one station has the area of its triangle.
        let mut hat = [0.0; STATIONS];
        hat[20] = 1.0;
        assert!((cells.integral(&cell_means(&cells, &hat)) - 1.0 / 32.0).abs() < 1e-15);
    }
}
