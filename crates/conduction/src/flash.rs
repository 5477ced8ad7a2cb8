//! Moving source reduced to a few states whose decay rates depend on the velocity (reduced flash-temperature model).
//!
//! At rest the thermal impedance of local heating under the contact is a sum of decays, `H(s) = sum r_k/(s + lambda_k)`.
//! Sliding convects heat away from under the contact, which is modelled as one rate `sigma(v)` added to every decay rate:
//!
//! ```text
//! dx_k/dt = -(lambda_k + sigma(v)) x_k + r_k q,     T = sum x_k
//! ```
//!
//! with sigma(v) from the exact kernel, `H(sigma(v)) = R(v)`. Exact at rest for every history and at every steady velocity.
//! In between, the short-time limit (the effusivity of a half-space) is exact, and the memory is the time in which the
//! contact slides over its own length. For inputs slow against that rate the states are quasi-steady and T = R(v) q.
//!
//! The poles and residues follow from H at a few real frequencies by the symmetric Loewner pencil (a rational Krylov
//! reduction that needs values of H only), so both are positive.
//!
//! Theory: docs/theory.md, section 4.3.

use super::moving_source::{MovingSource, Part};
use nalgebra::{Complex, DMatrix, DVector};
use numerics::factorization;

/// Largest number of states of the flash part, and of the track part.
pub const MAX_FLASH_STATES: usize = 8;

/// Sum of decays `r/(s + lambda)` in ascending order of decay rate, with positive residues.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Decays {
    /// Decay rates lambda, 1/s.
    pub rate: Vec<f64>,
    /// Residues r, K m2/J.
    pub residue: Vec<f64>,
}

impl Decays {
    /// Value at the real frequency `s`.
    pub(crate) fn at(&self, s: f64) -> f64 {
        self.rate.iter().zip(&self.residue).map(|(rate, residue)| residue / (rate + s)).sum()
    }

    /// Interpolant of `response` and its derivative at the frequencies `shifts` (ascending, > 0); at fewer of them where the
    /// pencil is numerically rank-deficient. `response` must be a Stieltjes function of `s`.
    pub(crate) fn interpolate(shifts: &[f64], response: impl Fn(Complex<f64>) -> Complex<f64>) -> Decays {
        let values: Vec<(f64, f64)> = shifts
            .iter()
            .map(|&s| {
                // Complex-step derivative: free of cancellation.
                let step = 1e-20 * s;
                let value = response(Complex::new(s, step));
                (value.re, value.im / step)
            })
            .collect();
        let mut used: Vec<usize> = (0..shifts.len()).collect();
        while !used.is_empty() {
            if let Some(decays) = Decays::from_pencil(shifts, &values, &used) {
                return decays;
            }
            // Every second frequency is better conditioned; a single one always works where the values are finite.
            used = if used.len() > 1 { used.iter().copied().step_by(2).collect() } else { Vec::new() };
        }
        Decays { rate: vec![f64::NAN], residue: vec![f64::NAN] }
    }

    fn from_pencil(shifts: &[f64], values: &[(f64, f64)], used: &[usize]) -> Option<Decays> {
        let count = used.len();
        let entry = |i: usize, j: usize| {
            let ((si, (hi, di)), (sj, (hj, _))) =
                ((shifts[used[i]], values[used[i]]), (shifts[used[j]], values[used[j]]));
            if i == j { (-di, hi + si * di) } else { ((hi - hj) / (sj - si), (si * hi - sj * hj) / (si - sj)) }
        };
        // Scaled to a unit diagonal of the mass matrix.
        let scale: Vec<f64> = (0..count).map(|i| entry(i, i).0.sqrt().recip()).collect();
        let mass = DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * entry(i, j).0);
        let stiffness = DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * entry(i, j).1);
        let load = DVector::from_fn(count, |i, _| scale[i] * values[used[i]].0);
        let factor = factorization::cholesky(mass).ok()?.l();
        if factor.diagonal().min() < 1e-6 {
            return if count > 1 { None } else { Some(Decays::single(&values[used[0]], shifts[used[0]])) };
        }
        let half = factor.solve_lower_triangular(&stiffness)?;
        let reduced = factor.solve_lower_triangular(&half.transpose())?;
        let eigen = factorization::symmetric_eigen(0.5 * (&reduced + reduced.transpose())).ok()?;
        let weights = eigen.eigenvectors.transpose() * factor.solve_lower_triangular(&load)?;
        let mut pairs: Vec<(f64, f64)> =
            eigen.eigenvalues.iter().zip(weights.iter()).map(|(&rate, &weight)| (rate, weight * weight)).collect();
        pairs.sort_by(|left, right| left.0.total_cmp(&right.0));
        if count > 1 && pairs[0].0 < 0.0 {
            return None;
        }
        Some(Decays {
            rate: pairs.iter().map(|pair| pair.0.max(0.0)).collect(),
            residue: pairs.iter().map(|pair| pair.1).collect(),
        })
    }

    fn single(value: &(f64, f64), shift: f64) -> Decays {
        let rate = (-value.0 / value.1 - shift).max(0.0);
        Decays { rate: vec![rate], residue: vec![value.0 * (rate + shift)] }
    }
}

/// Reduced moving source of a strip.
#[derive(Clone, PartialEq, Debug)]
pub struct Flash {
    /// Decays of the part that moves with the contact, at rest.
    pub decays: Decays,
    /// Decay rates of `decays`, 1/s, padded to a fixed length for the time step: rate 1 and residue 0 beyond the last.
    pub rates: [f64; MAX_FLASH_STATES],
    /// Residues of `decays`, K m2/J, padded like `rates`.
    pub residues: [f64; MAX_FLASH_STATES],
    /// Decays of the part that stays in the track of a stroke.
    pub track: Decays,
    speed: SpeedTable,
}

impl Flash {
    /// Reduces `source` on decay rates from 0.3/`duration` to 10 kd/(a^2 `tolerance`), 1/s, in [`MAX_FLASH_STATES`]
    /// states: steps take that many abreast, so that fewer would save nothing. Fewer remain where the rates are too
    /// close to each other.
    pub fn new(source: &MovingSource, duration: f64, tolerance: f64) -> Flash {
        let [conductivity, capacity] = source.slab().spreading();
        let diffusivity = conductivity / capacity;
        let own = diffusivity / source.half_length().powi(2);
        // Slower decays than these (over the duration, or over the contact's own diffusion time along the path) have no effect.
        let slowest = (0.3 / duration).max(1e-6 * own);
        let fastest = (10.0 * own / tolerance).max(10.0 * slowest);
        let last = (MAX_FLASH_STATES - 1) as f64;
        let shifts: Vec<f64> =
            (0..MAX_FLASH_STATES).map(|i| slowest * (fastest / slowest).powf(i as f64 / last)).collect();
        let decays = Decays::interpolate(&shifts, |s| source.response(Part::Flash, s, 0.0));
        let track = if source.has_track() {
            Decays::interpolate(&shifts, |s| source.response(Part::Track, s, 0.0))
        } else {
            Decays::default()
        };
        let speed = SpeedTable::new(source, &decays);
        let row = |values: &[f64], rest: f64| std::array::from_fn(|k| values.get(k).copied().unwrap_or(rest));
        Flash { rates: row(&decays.rate, 1.0), residues: row(&decays.residue, 0.0), decays, track, speed }
    }

    /// Rate sigma(v), 1/s, that sliding at `speed` = |v| (m/s) adds to every decay rate.
    #[inline(always)]
    pub fn sliding_rate(&self, speed: f64) -> f64 {
        self.speed.rate(speed)
    }

    /// Quasi-steady resistance R(v), K m2/W.
    pub fn resistance(&self, speed: f64) -> f64 {
        self.decays.at(self.sliding_rate(speed))
    }
}

/// Cubic spline of ln sigma over ln v on equidistant nodes, extrapolated linearly.
#[derive(Clone, PartialEq, Debug)]
struct SpeedTable {
    /// ln v at the first node.
    low: f64,
    /// Value, and slope times node spacing, at every node.
    nodes: Vec<(f64, f64)>,
    /// Leading bits of the lowest speed of `cubics`.
    first: u64,
    /// The same curve without logarithm and exponential: coefficients of one cubic per interval between speeds that agree in
    /// their leading bits, that is between (16 + i)/16 2^e and (17 + i)/16 2^e, in the fraction of the interval. Differs
    /// from the spline by less than 1e-6 of sigma where sliding matters within the duration, elsewhere by less than 1e-3 of
    /// the sum of sigma and the slowest decay rate.
    cubics: Vec<[f64; 4]>,
}

/// Number of fraction bits that are free within an interval of [`SpeedTable::cubics`]: all but four of 52.
const FREE_BITS: u32 = 48;

/// Nodes of the speed table per unit of ln v.
const NODES_PER_UNIT: f64 = 3.0;

impl SpeedTable {
    fn new(source: &MovingSource, decays: &Decays) -> SpeedTable {
        let own = source.slab().diffusivity() / source.half_length();
        let (low, high) = ((1e-3 * own).ln(), (1e8 * own).ln());
        let count = ((high - low) * NODES_PER_UNIT).ceil() as usize + 1;
        let mut values = Vec::with_capacity(count);
        let mut guess = 0.0;
        let resistances = resistances(source, low, count);
        for resistance in resistances {
            guess = solve_rate(decays, resistance, guess);
            // A rate below a ten-thousandth of the slowest decay rate is indistinguishable from rest.
            values.push(guess.max(1e-4 * decays.rate[0]).max(1e-30).ln());
        }
        let slopes = spline_slopes(&values);
        let mut table =
            SpeedTable { low, nodes: values.into_iter().zip(slopes).collect(), first: 0, cubics: Vec::new() };
        table.first = (low.exp().to_bits() >> FREE_BITS) + 1;
        let last = high.exp().to_bits() >> FREE_BITS;
        table.cubics = (table.first..last)
            .map(|leading| {
                let [left, right] = [leading, leading + 1].map(|leading| f64::from_bits(leading << FREE_BITS));
                let [(value, slope), (next, next_slope)] = [left, right].map(|speed| table.by_spline(speed));
                cubic([value, next], [slope, next_slope].map(|slope| slope * (right - left)))
            })
            .collect();
        table
    }

    /// sigma (1/s) at `speed` >= 0 (m/s).
    #[inline(always)]
    fn rate(&self, speed: f64) -> f64 {
        if speed <= 0.0 {
            return 0.0;
        }
        let bits = speed.to_bits();
        match self.cubics.get((bits >> FREE_BITS).wrapping_sub(self.first) as usize) {
            Some([c0, c1, c2, c3]) => {
                // Fraction of the interval: the free bits.
                let x = (bits & ((1 << FREE_BITS) - 1)) as f64 * (1.0 / (1_u64 << FREE_BITS) as f64);
                c0 + x * (c1 + x * (c2 + x * c3))
            }
            None => self.by_spline(speed).0,
        }
    }

    /// sigma and its derivative with respect to the speed (> 0), from the spline.
    #[inline(never)]
    fn by_spline(&self, speed: f64) -> (f64, f64) {
        let position = (speed.ln() - self.low) * NODES_PER_UNIT;
        let last = self.nodes.len() - 1;
        let (logarithm, slope) = if position <= 0.0 {
            (self.nodes[0].0 + position * self.nodes[0].1, self.nodes[0].1)
        } else if position >= last as f64 {
            (self.nodes[last].0 + (position - last as f64) * self.nodes[last].1, self.nodes[last].1)
        } else {
            let index = position as usize;
            let x = position - index as f64;
            let ((left, left_slope), (right, right_slope)) = (self.nodes[index], self.nodes[index + 1]);
            let [c0, c1, c2, c3] = cubic([left, right], [left_slope, right_slope]);
            (c0 + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + x * 3.0 * c3))
        };
        let rate = logarithm.exp();
        (rate, rate * slope * NODES_PER_UNIT / speed)
    }
}

/// Coefficients of the cubic on [0, 1] with these values and slopes at its ends.
fn cubic([left, right]: [f64; 2], [first, last]: [f64; 2]) -> [f64; 4] {
    let rise = right - left;
    [left, first, 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise]
}

/// Resistances at `count` nodes from the speed exp(`low`) on.
fn resistances(source: &MovingSource, low: f64, count: usize) -> Vec<f64> {
    let at = |node: usize| source.resistance((low + node as f64 / NODES_PER_UNIT).exp());
    if !source.spreads() {
        return (0..count).map(at).collect();
    }
    // Out-of-plane spreading costs ten times as much per value: the nodes between follow from a spline through the
    // logarithms, to 2e-3.
    let values: Vec<f64> = (0..=count.div_ceil(APART)).map(|node| at(node * APART).ln()).collect();
    let slopes = spline_slopes(&values);
    let between = |node: usize| {
        let (index, x) = (node / APART, (node % APART) as f64 / APART as f64);
        let [c0, c1, c2, c3] = cubic([values[index], values[index + 1]], [slopes[index], slopes[index + 1]]);
        (c0 + x * (c1 + x * (c2 + x * c3))).exp()
    };
    (0..count).map(between).collect()
}

/// Spacing, in nodes, of exactly computed resistances of a source that spreads out of the plane.
const APART: usize = 3;

/// Root sigma >= 0 of `decays(sigma) = resistance`, by Newton's method on 1/decays (nearly linear in sigma); 0 where the
/// resistance is not below that at rest.
fn solve_rate(decays: &Decays, resistance: f64, guess: f64) -> f64 {
    if resistance >= decays.at(0.0) {
        return 0.0;
    }
    let mut rate = guess;
    for _ in 0..60 {
        let value = decays.at(rate);
        let slope: f64 = -decays.rate.iter().zip(&decays.residue).map(|(l, r)| r / (l + rate).powi(2)).sum::<f64>();
        // Newton step of 1/value = 1/resistance; it keeps the rate >= 0.
        let step = (1.0 / resistance - 1.0 / value) * value * value / -slope;
        let next = (rate + step).max(0.1 * rate);
        if (next - rate).abs() <= 1e-14 * next {
            return next;
        }
        rate = next;
    }
    rate
}

/// Slopes times spacing of the natural cubic spline through equidistant values.
fn spline_slopes(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let mut diagonal = vec![4.0; count];
    let mut slopes: Vec<f64> =
        (0..count).map(|i| 3.0 * (values[(i + 1).min(count - 1)] - values[i.saturating_sub(1)])).collect();
    diagonal[0] = 2.0;
    diagonal[count - 1] = 2.0;
    for i in 1..count {
        let factor = 1.0 / diagonal[i - 1];
        diagonal[i] -= factor;
        slopes[i] -= factor * slopes[i - 1];
    }
    slopes[count - 1] /= diagonal[count - 1];
    for i in (0..count - 1).rev() {
        slopes[i] = (slopes[i] - slopes[i + 1]) / diagonal[i];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::super::lateral::Lateral;
    use super::super::moving_source::Path;
    use super::super::slab::Slab;
    use super::*;
    use scene::FarBoundary;

    fn disc(base: FarBoundary) -> Slab {
        Slab::bare(0.011, [54.0, 7200.0 * 460.0], base)
    }

    #[test]
    fn every_speed_gives_the_exact_resistance() {
        for path in [Path::Closed(0.74), Path::Endless, Path::Stroke { stroke: 0.03, cell: 0.6 }] {
            for base in [FarBoundary::Insulated, FarBoundary::Held] {
                let source = MovingSource::new(disc(base), 0.0275, path);
                let flash = Flash::new(&source, 1000.0, 1e-3);
                for exponent in -30..=60 {
                    let speed = 10f64.powf(f64::from(exponent) / 10.0) * 1e-2;
                    let exact = source.resistance(speed);
                    if flash.sliding_rate(speed) < 1e-3 {
                        // Too slow to differ from rest within the whole duration of 1000 s.
                        continue;
                    }
                    let error = flash.resistance(speed) / exact - 1.0;
                    assert!(error.abs() < 5e-4, "{path:?} {base:?} v {speed}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn nodes_between_those_computed_are_exact_to_two_thousandths() {
        let slab = disc(FarBoundary::Held);
        let lateral = Lateral::new(0.01, slab.conductivity / slab.capacity);
        let source = MovingSource::new(slab, 0.0275, Path::Closed(0.74)).spreading(Some(lateral));
        // The range of the speed table.
        let low = (1e-3 * source.slab().diffusivity() / source.half_length()).ln();
        let mut largest: f64 = 0.0;
        for (node, value) in resistances(&source, low, 76).into_iter().enumerate() {
            let exact = source.resistance((low + node as f64 / NODES_PER_UNIT).exp());
            largest = largest.max((value / exact - 1.0).abs());
        }
        assert!(largest < 2e-3, "{largest:e}");
    }

    #[test]
    fn the_cubics_are_the_spline() {
        for path in [Path::Closed(0.74), Path::Endless, Path::Stroke { stroke: 0.03, cell: 0.6 }] {
            let source = MovingSource::new(disc(FarBoundary::Insulated), 0.0275, path);
            let flash = Flash::new(&source, 1000.0, 1e-3);
            let (table, slowest) = (&flash.speed, flash.decays.rate[0]);
            let (mut relative, mut worst): (f64, f64) = (0.0, 0.0);
            // From below the table to above it, with steps that sample every part of its intervals.
            for step in 0..40_000 {
                let speed = 1e-9 * (f64::from(step) * 1.1e-3).exp();
                let (by_spline, by_cubic) = (table.by_spline(speed).0, table.rate(speed));
                let error = (by_cubic - by_spline).abs();
                worst = worst.max(error / (by_spline + slowest));
                if by_spline > 1e-3 {
                    relative = relative.max(error / by_spline);
                }
            }
            assert!(relative < 1e-6 && worst < 1e-3, "{path:?}: {relative:e} {worst:e}");
        }
    }

    #[test]
    fn at_rest_the_decays_follow_the_exact_response() {
        for path in [Path::Closed(0.74), Path::Endless, Path::Stroke { stroke: 0.03, cell: 0.6 }] {
            let source = MovingSource::new(disc(FarBoundary::Insulated), 0.0275, path);
            let flash = Flash::new(&source, 1000.0, 1e-3);
            let scale = flash.decays.at(1e-3);
            for exponent in -6..6 {
                let s = 10f64.powf(f64::from(exponent) / 2.0);
                let exact = source.response(Part::Flash, Complex::from(s), 0.0).re;
                assert!(
                    (flash.decays.at(s) - exact).abs() < 2e-3 * scale,
                    "{path:?} s {s}: {} {exact}",
                    flash.decays.at(s)
                );
            }
            assert!(flash.decays.rate.iter().chain(&flash.decays.residue).all(|value| *value >= 0.0));
        }
    }
}
