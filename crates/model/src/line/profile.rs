//! Interpolation from the cells of the contact line to the stations of the profiles.
//!
//! A station's value is the mean over its own interval, half an interval at the two edges, so the trapezoid sum over
//! the stations is the integral over the cells to rounding, whatever the number of cells. Between the cell boundaries,
//! where the cumulative integral is known exactly, it is interpolated by monotone cubics (Fritsch and Carlson, SIAM
//! Journal on Numerical Analysis 17, 1980): third order where the quantity is smooth, and never below 0 where the cells
//! are not.
//!
//! Theory: docs/theory.md, section 8.4.

use elasticity::Cells;
use scene::{InitialShape, STATIONS, Scene};

/// Stations and the boundaries of their intervals.
#[derive(Clone, PartialEq, Debug)]
pub struct Profile {
    positions: [f64; STATIONS],
    widths: Vec<f64>,
    /// Every inner boundary of an interval: its cell and its relative position in the cell, from 0 to 1.
    ends: [(usize, f64); STATIONS - 1],
}

impl Profile {
    /// Stations equally spaced from edge to edge.
    pub fn new(cells: &Cells) -> Profile {
        let half_width = cells.half_width();
        let spacing = 2.0 * half_width / (STATIONS - 1) as f64;
        let edges = cells.edges();
        let ends = std::array::from_fn(|k| {
            let x = spacing * (k as f64 + 0.5) - half_width;
            let cell = edges[1..cells.count()].partition_point(|&edge| edge <= x);
            (cell, ((x - edges[cell]) / cells.widths()[cell]).clamp(0.0, 1.0))
        });
        let positions = std::array::from_fn(|k| spacing * k as f64 - half_width);
        Profile { positions, widths: cells.widths().to_vec(), ends }
    }

    /// Positions of the stations, m.
    pub fn positions(&self) -> &[f64; STATIONS] {
        &self.positions
    }

    /// Station values of the quantity with these cell means (N values, >= 0).
    pub fn fill(&self, means: &[f64], out: &mut [f64]) {
        if means.iter().all(|&mean| mean == 0.0) {
            return out.fill(0.0);
        }
        self.integrate(means, means, out);
    }

    /// Rates of the station values where the cell means change at `rates`.
    pub(crate) fn fill_rates(&self, means: &[f64], rates: &[f64], out: &mut [f64]) {
        self.integrate(means, rates, out);
    }

    /// Station values of the quantity whose cell means are `values`, with the limiters of `means`.
    fn integrate(&self, means: &[f64], values: &[f64], out: &mut [f64]) {
        let spacing = self.positions[1] - self.positions[0];
        let (mut cell, mut passed, mut before) = (0, 0.0, 0.0);
        // Cell in which the last interval ended, and the densities at both its ends: many intervals end in one cell.
        let (mut at, mut densities) = (usize::MAX, [0.0; 2]);
        for (station, &(end, part)) in self.ends.iter().enumerate() {
            while cell < end {
                passed += self.widths[cell] * values[cell];
                cell += 1;
            }
            if at != cell {
                let shared = at.wrapping_add(1) == cell && cell > 0;
                let left = if shared { densities[1] } else { self.density(cell, means, values) };
                (at, densities) = (cell, [left, self.density(cell + 1, means, values)]);
            }
            let integral = passed + self.within(cell, part, densities, values[cell]);
            out[station] = (integral - before) / if station == 0 { 0.5 * spacing } else { spacing };
            before = integral;
        }
        while cell < values.len() {
            passed += self.widths[cell] * values[cell];
            cell += 1;
        }
        out[STATIONS - 1] = (passed - before) / (0.5 * spacing);
    }

    /// Integral over the first `part` of a cell of a quantity with this mean and these densities at the cell's ends.
    fn within(&self, cell: usize, part: f64, [left, right]: [f64; 2], mean: f64) -> f64 {
        // Monotone cubic with the densities at both ends as slopes.
        self.widths[cell]
            * part
            * (left + part * ((3.0 * mean - 2.0 * left - right) + part * (left + right - 2.0 * mean)))
    }

    /// Density at a cell boundary: slope of the parabola through the integrals around it, limited to three times the smaller
    /// mean.
    fn density(&self, boundary: usize, means: &[f64], values: &[f64]) -> f64 {
        let count = means.len();
        if count == 1 {
            return values[0];
        }
        let outer = boundary == 0 || boundary == count;
        let (a, b) = match boundary {
            0 => (0, 1),
            _ if boundary == count => (count - 1, count - 2),
            _ => (boundary - 1, boundary),
        };
        let total = self.widths[a] + self.widths[b];
        let at = |of: &[f64]| {
            if outer {
                of[a] + (of[a] - of[b]) * self.widths[a] / total
            } else {
                (of[a] * self.widths[b] + of[b] * self.widths[a]) / total
            }
        };
        let free = at(means);
        let lower = if outer || means[a] <= means[b] { a } else { b };
        if free < 0.0 {
            0.0
        } else if free > 3.0 * means[lower] {
            3.0 * values[lower]
        } else {
            at(values)
        }
    }
}

/// Gap of the unworn bodies of a scene, by cell, m; 0 for one that starts run in.
pub fn initial_gap(scene: &Scene, cells: &Cells) -> Vec<f64> {
    match &scene.initial_shape {
        InitialShape::Flat | InitialShape::RunIn => vec![0.0; cells.count()],
        InitialShape::Parabolic(radius) => cells.means_from_primitive(|x| x * x * x / (6.0 * radius)),
        InitialShape::Tabulated(values) => cell_means(cells, values),
    }
}

/// Cell means of a quantity given at the stations and linear between them.
fn cell_means(cells: &Cells, values: &[f64; STATIONS]) -> Vec<f64> {
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
        for count in [1, 2, 3, 7, 33, 129, 257] {
            let cells = Cells::graded(0.03, count).unwrap();
            let means: Vec<f64> = (0..count).map(|i| if i % 5 == 0 { 0.0 } else { 1.0 + (i as f64).sin() }).collect();
            let profile = Profile::new(&cells);
            let mut values = [0.0; STATIONS];
            profile.fill(&means, &mut values);
            let sum: f64 = (0..STATIONS).map(|k| values[k] * if k == 0 || k + 1 == STATIONS { 0.5 } else { 1.0 }).sum();
            let spacing = 0.06 / 32.0;
            assert!((sum * spacing - cells.integral(&means)).abs() < 1e-15, "{count}");
            assert!(values.iter().all(|value| *value >= -1e-14), "{count}: {values:?}");
            assert_eq!((profile.positions()[0], profile.positions()[16]), (-0.03, 0.0));
        }
    }

    #[test]
    fn smooth_quantities_come_out_at_third_order() {
        let error = |count: usize| {
            let cells = Cells::graded(1.0, count).unwrap();
            let means = cells.means_from_primitive(|x| 2.0 * x + x.sin() + 0.2 * x * x);
            let mut values = [0.0; STATIONS];
            Profile::new(&cells).fill(&means, &mut values);
            let primitive = |x: f64| 2.0 * x + x.sin() + 0.2 * x * x;
            (1..STATIONS - 1)
                .map(|k| {
                    let x = k as f64 / 16.0 - 1.0;
                    let exact = (primitive(x + 1.0 / 32.0) - primitive(x - 1.0 / 32.0)) * 16.0;
                    (values[k] - exact).abs()
                })
                .fold(0.0, f64::max)
        };
        assert!(error(33) < 1e-3 && error(129) < error(33) / 30.0, "{:e} {:e}", error(33), error(129));
    }

    #[test]
    fn rates_are_differences() {
        let cells = Cells::graded(1.0, 21).unwrap();
        let profile = Profile::new(&cells);
        let means: Vec<f64> = (0..21).map(|i| (0.4 * f64::from(i) - 2.0).max(0.0)).collect();
        let rates: Vec<f64> = (0..21).map(|i| if means[i] > 0.0 { (1.3 * i as f64).cos() } else { 0.0 }).collect();
        let at = |t: f64| {
            let moved: Vec<f64> = means.iter().zip(&rates).map(|(m, r)| m + t * r).collect();
            let mut values = [0.0; STATIONS];
            profile.fill(&moved, &mut values);
            values
        };
        let (low, high, mut exact) = (at(-1e-6), at(1e-6), [0.0; STATIONS]);
        profile.fill_rates(&means, &rates, &mut exact);
        for k in 0..STATIONS {
            assert!((exact[k] - (high[k] - low[k]) / 2e-6).abs() < 1e-8, "{k}");
        }
    }

    #[test]
    fn tabulated_values_come_back_as_means() {
        let cells = Cells::graded(0.5, 65).unwrap();
        let values: [f64; STATIONS] = std::array::from_fn(|k| 2.0 + 3.0 * (k as f64 / 32.0 - 0.5));
        for (mean, x) in cell_means(&cells, &values).iter().zip(cells.centres()) {
            assert!((mean - (2.0 + 3.0 * x)).abs() < 1e-13);
        }
        // A hat function at one station has the area of its triangle.
        let mut hat = [0.0; STATIONS];
        hat[20] = 1.0;
        assert!((cells.integral(&cell_means(&cells, &hat)) - 1.0 / 32.0).abs() < 1e-15);
    }
}
