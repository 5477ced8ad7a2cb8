//! Transverse modes along the radius of a ring: exact, in Bessel functions.
//!
//! ```text
//! (r X')'/r + xi^2 X = 0 on r_i < r < r_o,     X' = eta X at r_i,   X' = -eta X at r_o,   eta = h/k
//! X = A J0(xi r) + B Y0(xi r),   X' = -xi Z1(xi r),   Z1 = A J1 + B Y1
//! ```
//!
//! orthonormal in the weight r/r_m: `integral X^2 r/r_m dr = 1`. Since `(r X')' = -xi^2 r X`, integrals of a mode over cells
//! are differences of `r Z1/(xi r_m)`, and `integral r Z0^2 dr = r^2 (Z0^2 + Z1^2)/2`.
//!
//! Wave number m lies between that of insulated sides, `m pi < xi (r_o - r_i) < (m + 1/2) pi`, and `(m + 1) pi`, an upper
//! bound of that of sides at a prescribed temperature. Source: H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids
//! (1959), 7.10 and 13.4.
//!
//! Theory: docs/theory.md, section 4.7.

use super::cylinder::Cylinder;
use nalgebra::Complex;
use std::f64::consts::PI;

/// Radii of a ring, with the heat loss of its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Radii {
    pub inner: f64,
    pub outer: f64,
    /// Mean radius r_m, m.
    pub mean: f64,
    /// Ratio eta of heat transfer coefficient and conductivity, 1/m.
    pub loss: f64,
}

/// One transverse mode of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RadialMode {
    /// Wave number xi, 1/m.
    pub wave_number: f64,
    /// A and B, m^(-1/2); at zero wave number A is the constant value.
    first: f64,
    second: f64,
    mean: f64,
}

/// Gauss-Legendre rule of four points on [-1, 1]: positions and weights of one half, unlike those of [`numerics::quadrature::GAUSS_4`] all to rounding.
const GAUSS: [(f64, f64); 2] =
    [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];

impl Radii {
    /// Mode number `m` in ascending order of the wave numbers.
    pub(crate) fn mode(&self, m: usize) -> RadialMode {
        let width = self.outer - self.inner;
        if m == 0 && self.loss == 0.0 {
            return RadialMode { wave_number: 0.0, first: width.sqrt().recip(), second: 0.0, mean: self.mean };
        }
        let wave_number = self.wave_number(m);
        let (inner, _) = self.boundary_function(wave_number, self.inner, 1.0);
        // Y grows without bound towards the centre.
        let inner = inner / inner.norm();
        let mut mode = RadialMode { wave_number, first: inner.im, second: -inner.re, mean: self.mean };
        let square = |r: f64| {
            let (value, slope) = mode.at_radius(r);
            0.5 * r * r / self.mean * (value * value + slope * slope)
        };
        // Positive at the inner side, so that the sign of a mode is independent of that of the Bessel functions.
        let scale = (square(self.outer) - square(self.inner)).sqrt().recip().copysign(mode.at_radius(self.inner).0);
        mode.first *= scale;
        mode.second *= scale;
        mode
    }

    /// Wave number m, 1/m, by Newton's method on the phase, safeguarded by bisection.
    ///
    /// With H = J + i Y the real function `Im(conj(H) w_i)` satisfies the condition at the inner side, and that at the outer one where
    ///
    /// ```text
    /// arg w_o - arg w_i = m pi,    w_i = H1 + (eta/xi) H0 at xi r_i,    w_o = H1 - (eta/xi) H0 at xi r_o
    /// ```
    ///
    /// The phase is nearly linear in xi.
    fn wave_number(&self, m: usize) -> f64 {
        let width = self.outer - self.inner;
        let half_turn = PI / width;
        // Below the wave number of a straight bar with insulated sides, and that of sides at a prescribed temperature.
        let (mut low, mut high) = ((m as f64 - 0.01).max(0.0) * half_turn, (m as f64 + 1.0) * half_turn);
        let mut at = if m > 0 { m as f64 * half_turn } else { half_turn.min((2.0 * self.loss / width).sqrt()) };
        // An argument xi r is exact to rounding, and so is its phase.
        let exact = 4.0 * f64::EPSILON * (1.0 + self.outer / width);
        for _ in 0..100 {
            let (inner, inner_slope) = self.boundary_function(at, self.inner, 1.0);
            let (outer, outer_slope) = self.boundary_function(at, self.outer, -1.0);
            let turned = inner.conj() * outer;
            let excess = (if m.is_multiple_of(2) { turned } else { -turned }).arg();
            *(if excess > 0.0 { &mut high } else { &mut low }) = at;
            let newton = at - excess / (outer_slope - inner_slope);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - at).abs();
            at = next;
            if moved <= exact * at {
                break;
            }
        }
        at
    }

    /// `H1(x) + side (eta/xi) H0(x)` at x = xi r, and the slope of its phase over xi, m.
    fn boundary_function(&self, wave_number: f64, r: f64, side: f64) -> (Complex<f64>, f64) {
        let (x, biot) = (wave_number * r, side * self.loss / wave_number);
        let Cylinder { zero, one } = Cylinder::at(x);
        let (zero, one) = (Complex::new(zero.0, zero.1), Complex::new(one.0, one.1));
        let value = one + zero * biot;
        let slope = zero - one / x - (zero / x + one) * biot;
        (value, r * (value.conj() * slope).im / value.norm_sqr())
    }
}

impl RadialMode {
    /// Eigenfunction X at x = r - r_m.
    pub(crate) fn value(&self, x: f64) -> f64 {
        self.at_radius(self.mean + x).0
    }

    /// X and Z1 = -X'/xi.
    fn at_radius(&self, r: f64) -> (f64, f64) {
        if self.wave_number == 0.0 {
            return (self.first, 0.0);
        }
        let Cylinder { zero, one } = Cylinder::at(self.wave_number * r);
        (self.first * zero.0 + self.second * zero.1, self.first * one.0 + self.second * one.1)
    }

    /// Integrals of X r/r_m between consecutive boundaries (x = r - r_m, ascending), m^(1/2).
    pub(crate) fn integrals(&self, boundaries: &[f64]) -> Vec<f64> {
        let ratio = |x: f64| 1.0 + x / self.mean;
        if self.wave_number == 0.0 {
            return boundaries
                .windows(2)
                .map(|pair| self.first * (pair[1] - pair[0]) * ratio(0.5 * (pair[0] + pair[1])))
                .collect();
        }
        let primitive = |x: f64| ratio(x) * self.at_radius(self.mean + x).1 / self.wave_number;
        let mut last: Option<f64> = None;
        let mut integrals = Vec::with_capacity(boundaries.len());
        for pair in boundaries.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            // Half the phase of a mode over a cell below which its integral is computed by quadrature, because the difference of its
            // primitive cancels.
            if half * self.wave_number < 0.2 {
                last = None;
                let at = |x: f64| ratio(x) * self.value(x);
                let sum = |(node, weight): (f64, f64)| weight * (at(middle - half * node) + at(middle + half * node));
                integrals.push(half * GAUSS.into_iter().map(sum).sum::<f64>());
                continue;
            }
            let before = last.unwrap_or_else(|| primitive(pair[0]));
            let after = primitive(pair[1]);
            integrals.push(after - before);
            last = Some(after);
        }
        integrals
    }

    /// Sum of X r/r_m at both sides, m^(-1/2).
    pub(crate) fn at_sides(&self, radii: &Radii) -> f64 {
        (radii.inner * self.at_radius(radii.inner).0 + radii.outer * self.at_radius(radii.outer).0) / radii.mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Long cells by their primitive, short ones by quadrature.
    #[test]
    fn long_cells_integrate_like_the_short_ones_that_they_are_made_of() {
        let radii = Radii { inner: 0.04, outer: 0.08, mean: 0.06, loss: 3.0 };
        let short: Vec<f64> = (0..=400).map(|k| -0.02 + 1e-4 * f64::from(k)).collect();
        for m in 0..8 {
            let mode = radii.mode(m);
            let parts = mode.integrals(&short);
            let long: Vec<f64> = short.iter().copied().step_by(100).collect();
            for (sum, whole) in parts.chunks(100).map(|cell| cell.iter().sum::<f64>()).zip(mode.integrals(&long)) {
                assert!((sum - whole).abs() < 2e-10, "{m}: {sum} {whole}");
            }
        }
    }

    #[test]
    fn modes_satisfy_their_equations_and_are_orthonormal() {
        let edges: Vec<f64> = (0..=4000).map(|k| -0.02 + 1e-5 * f64::from(k)).collect();
        for (mean, loss) in [
            (0.1, 0.0),
            (0.1, 1e6),
            (0.0201, 0.0),
            (0.0201, 1e3),
            (0.021, 0.0),
            (0.1, 1e-8),
            (0.021, 3.0),
            (0.1, 400.0),
            (50.0, 7.0),
        ] {
            let radii = Radii { inner: mean - 0.02, outer: mean + 0.02, mean, loss };
            let modes: Vec<RadialMode> = (0..8).map(|m| radii.mode(m)).collect();
            let exact: Vec<Vec<f64>> = modes.iter().map(|mode| mode.integrals(&edges)).collect();
            for (m, mode) in modes.iter().enumerate() {
                let scale = mode.wave_number.max(loss).max(1.0);
                for (x, sign) in [(-0.02, 1.0), (0.02, -1.0)] {
                    let slope = -mode.wave_number * mode.at_radius(mean + x).1;
                    let residual = slope - sign * loss * mode.value(x);
                    assert!(
                        residual.abs() < 1e-8 * scale * mode.value(-0.02).abs().max(1.0),
                        "{mean} {loss} {m}: {residual}"
                    );
                }
                // Between insulated sides and sides of prescribed temperature, and no mode omitted.
                let turns = mode.wave_number * 0.04 / PI;
                assert!(turns >= m as f64 - 1e-9 && turns < m as f64 + 1.0, "{mean} {loss} {m}: {turns}");
                for (n, other) in modes.iter().enumerate() {
                    let sum: f64 =
                        edges.iter().zip(&exact[m]).map(|(x, integral)| integral * other.value(x + 5e-6)).sum();
                    let expected = if m == n { 1.0 } else { 0.0 };
                    assert!((sum - expected).abs() < 1e-5, "{mean} {loss} {m} {n}: {sum}");
                }
                let total: f64 = exact[m].iter().sum();
                let lost = loss * mode.at_sides(&radii);
                let expected = if mode.wave_number > 0.0 { lost / mode.wave_number.powi(2) } else { 0.2 };
                assert!((total - expected).abs() < 2e-8, "{mean} {loss} {m}: {total} {expected}");
            }
        }
    }
}
