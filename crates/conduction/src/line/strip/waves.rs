//! Wave numbers along the path, and the shapes of the Fourier modes on the cells.
//!
//! On a period L the surface temperature is a sum over the harmonics `q = 2 pi n/L`, n >= 1, besides the mean. Slowly
//! decaying harmonics are taken one by one. Fast ones on a path whose reach |x - s| <= r is much shorter than L enter
//! only through `exp(i q r)`, a smooth function of n over many harmonics: such a range of the sum is evaluated by the
//! Gauss rule of the counting measure (with the Gram polynomials as its orthogonal polynomials), which is exact for
//! polynomials of degree below twice its order and equals the plain sum when it has as many nodes as there are
//! harmonics.
//!
//! Theory: docs/theory.md, section 4.5.

use elasticity::Cells;
use nalgebra::DMatrix;
use numerics::factorization;
use numerics::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// A wave number, or a quadrature node that represents several.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Wave {
    /// q, 1/m.
    pub number: f64,
    /// Number of harmonics represented: the quadrature weight.
    pub count: f64,
}

/// Nodes a panel needs beyond those that resolve its reach.
const EXTRA: f64 = 10.0;

/// The harmonics 1 to `last` of the period, summed accurately at distances up to `reach` between heated and observed
/// point, counted along the material.
pub(crate) fn harmonics(period: f64, last: usize, reach: f64) -> Vec<Wave> {
    let spacing = 2.0 * PI / period;
    let per_harmonic = 0.25 * spacing * reach;
    // Most nodes in a panel.
    let longest = if per_harmonic < 1.0 { ((48.0 - EXTRA) / per_harmonic) as usize } else { 1 };
    let mut waves = Vec::new();
    let mut first = 1;
    while first <= last {
        let end = last.min(2 * first - 1).min(first + longest.max(1) - 1);
        let count = end - first + 1;
        let nodes = (count as f64 * per_harmonic + EXTRA).ceil() as usize;
        if nodes >= count {
            waves.extend((first..=end).map(|n| Wave { number: spacing * n as f64, count: 1.0 }));
        } else {
            let rule = gram_rule(count, nodes);
            waves.extend(rule.iter().map(|&(n, weight)| Wave { number: spacing * (first as f64 + n), count: weight }));
        }
        first = end + 1;
    }
    waves
}

/// Gauss rule with `nodes` nodes for the sum over 0, 1, ..., `count` - 1, from the eigenvalues of the Jacobi matrix of the
/// Gram polynomials (G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221-230).
fn gram_rule(count: usize, nodes: usize) -> Vec<(f64, f64)> {
    let (m, middle) = (count as f64, 0.5 * (count as f64 - 1.0));
    let mut jacobi = DMatrix::zeros(nodes, nodes);
    for k in 1..nodes {
        let degree = k as f64;
        jacobi[(k - 1, k)] = 0.5 * degree * ((m * m - degree * degree) / (4.0 * degree * degree - 1.0)).sqrt();
        jacobi[(k, k - 1)] = jacobi[(k - 1, k)];
    }
    let eigen = factorization::symmetric_eigen(jacobi).expect("a function of the number of nodes alone");
    let first = eigen.eigenvectors.row(0);
    let nodes = eigen.eigenvalues.iter().zip(first.iter());
    let mut rule: Vec<(f64, f64)> = nodes.map(|(&node, &v)| (middle + node, m * v * v)).collect();
    rule.sort_by(|left, right| left.0.total_cmp(&right.0));
    rule
}

/// Nodes in a panel of [`continuous`].
pub(crate) const CONTINUOUS: usize = 12;

/// Gauss nodes and weights for integrals over the wave number from 0 to `last` of functions that vary like
/// `exp(i q r)`, |r| <= `reach`, and have structure at every scale of q down to `least`.
pub(crate) fn continuous(least: f64, last: f64, reach: f64) -> Vec<Wave> {
    let rule = gauss_legendre(CONTINUOUS);
    let mut waves = Vec::new();
    // Below `least` the integrand is singular at most like q^(-1/2): smooth in y with q = least y^2.
    for &(node, weight) in &rule {
        let y = 0.5 * (1.0 + node);
        waves.push(Wave { number: least * y * y, count: least * y * weight });
    }
    let mut from = least;
    while from < last {
        let to = (2.5 * from).min(from + 16.0 / reach).min(last);
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        waves.extend(rule.iter().map(|&(node, w)| Wave { number: middle + half * node, count: half * w }));
        from = to;
    }
    waves
}

/// Even and odd parts of the modes on cells that are symmetric about x = 0: one row of (N + 1)/2 entries per mode,
/// `cos(q x_i) sinc(q c_i/2)` and `sin(q x_i) sinc(q c_i/2)`, from the -x edge to the centre.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Shapes {
    half: usize,
    even: Vec<f64>,
    odd: Vec<f64>,
    /// The same by cells: one row per cell with one entry per mode.
    transposed: [Vec<f64>; 2],
}

impl Shapes {
    /// Shapes of all modes.
    pub(crate) fn new(cells: &Cells, waves: &[Wave]) -> Shapes {
        let half = cells.count().div_ceil(2);
        let mut shapes = Shapes { half, even: Vec::new(), odd: Vec::new(), transposed: Default::default() };
        for wave in waves {
            for (&x, &c) in cells.centres()[..half].iter().zip(cells.widths()) {
                let phase = 0.5 * wave.number * c;
                let mean = if phase < 1e-4 { 1.0 - phase * phase / 6.0 } else { phase.sin() / phase };
                let (sine, cosine) = (wave.number * x).sin_cos();
                shapes.even.push(mean * cosine);
                shapes.odd.push(mean * sine);
            }
        }
        let transpose = |rows: &[f64]| {
            let entry = |index: usize| rows[index % waves.len() * half + index / waves.len()];
            (0..rows.len()).map(entry).collect()
        };
        shapes.transposed = [transpose(&shapes.even), transpose(&shapes.odd)];
        shapes
    }

    /// Even and odd parts as matrices by columns: (N + 1)/2 rows, one column per mode.
    pub(crate) fn matrices(&self) -> [&[f64]; 2] {
        [&self.even, &self.odd]
    }

    /// The transposed matrices, by columns.
    pub(crate) fn transposed(&self) -> [&[f64]; 2] {
        self.transposed.each_ref().map(|matrix| &matrix[..])
    }

    /// Even and odd row of a mode.
    #[inline]
    pub(crate) fn rows(&self, wave: usize) -> (&[f64], &[f64]) {
        let range = wave * self.half..(wave + 1) * self.half;
        (&self.even[range.clone()], &self.odd[range])
    }

    /// (N + 1)/2.
    pub(crate) fn half(&self) -> usize {
        self.half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_of_the_counting_measure_sums_waves_within_their_reach() {
        let (period, reach) = (0.86, 0.066);
        let last = 1100;
        let waves = harmonics(period, last, reach);
        assert!(waves.len() < 330, "{}", waves.len());
        let total: f64 = waves.iter().map(|wave| wave.count).sum();
        assert!((total - last as f64).abs() < 1e-9 * total);
        for r in [0.0, 1e-3, -0.03, 0.066] {
            // A decaying factor as conduction gives it.
            let term = |q: f64| (q * r).cos() / q * (-1e-8 * q * q).exp();
            let exact: f64 = (1..=last).map(|n| term(2.0 * PI * n as f64 / period)).sum();
            let computed: f64 = waves.iter().map(|wave| wave.count * term(wave.number)).sum();
            assert!((computed - exact).abs() < 1e-6 * exact.abs().max(0.01), "{r}: {computed} {exact}");
        }
    }

    #[test]
    fn without_a_limit_to_the_reach_every_harmonic_stands_alone() {
        let waves = harmonics(0.74, 300, f64::INFINITY);
        assert_eq!(waves.len(), 300);
        assert_eq!(waves[299], Wave { number: 300.0 * (2.0 * PI / 0.74), count: 1.0 });
    }

    #[test]
    fn integrals_from_zero_take_an_inverse_root() {
        let waves = continuous(1e-6, 50.0, 2.0);
        let computed: f64 = waves.iter().map(|wave| wave.count * (2.0 * wave.number).cos() / wave.number.sqrt()).sum();
        // integral_0^X cos(2q)/sqrt(q) dq by the substitution q = y^2 and a fine midpoint rule.
        let (steps, end) = (400_000, 50f64.sqrt());
        let exact: f64 = (0..steps)
            .map(|i| {
                let y = end * (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * (2.0 * y * y).cos()
            })
            .sum::<f64>()
            * end
            / f64::from(steps);
        assert!((computed - exact).abs() < 1e-8, "{computed} {exact}");
    }
}
