//! Conduction through the depth at one wave number: exact impedance and distortion, and their reduction to states.
//!
//! With `kappa^2 = q^2 + s/kd` a flux `exp(iqx)` of amplitude 1 and frequency s heats the layer to
//! `Z(q, s) [exp(-kappa z) + rho exp(-kappa (2h - z))]/[1 + rho exp(-2 kappa h)]`, rho the reflection coefficient of
//! the base, and by reciprocity displaces its surface by
//!
//! ```text
//! D(q, s) = -2 (1+nu) alpha integral_0^h T(z) [A exp(-qz) + B exp(-q(h-z))] dz
//! ```
//!
//! where the bracket times -(1-2nu)/G is the (harmonic) dilatation under a unit pressure `exp(iqx)`; a half-plane has
//! `A = 1`, `B = 0`. Heating lifts the surface: D < 0.
//!
//! The exact fields at a few real frequencies span the reduced space. Mass, load and observations follow from values of
//! Z and D alone (symmetric Loewner pencil): the reduced rates are real, positive and bounded below by the smallest of
//! the layer, the impedance is interpolated with its derivative, and the stationary response (s = 0) is exact.
//!
//! Theory: docs/theory.md, section 4.5.

use crate::lateral::{Lateral, spread};
use crate::slab::Slab;
use elasticity::{self, Material};
use nalgebra::{Complex, DMatrix, Matrix4, Vector4};
use numerics::factorization::{self, Unfactorable};

/// Thermal expansion of the strip.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Expansion {
    /// Elastic constants.
    pub material: Material,
    /// Linear coefficient alpha, 1/K.
    pub coefficient: f64,
    /// Mechanical support of the base.
    pub base: elasticity::Base,
}

/// The layer at one wave number q > 0.
#[derive(Clone, Copy, Debug)]
pub struct Depth {
    slab: Slab,
    number: f64,
    /// `2 (1+nu) alpha` times A and B; `None`: no thermal expansion.
    dilatation: Option<(f64, f64)>,
    /// Conduction out of the plane.
    lateral: Option<Lateral>,
}

impl Depth {
    /// The layer `slab` at the wave number `number`.
    pub(crate) fn new(slab: &Slab, expansion: Option<&Expansion>, number: f64) -> Depth {
        let dilatation = expansion.map(|expansion| {
            let nu = expansion.material.poissons_ratio();
            let (direct, reflected) = dilatation(expansion.base, nu, number * slab.height);
            let factor = 2.0 * (1.0 + nu) * expansion.coefficient;
            (factor * direct, factor * reflected)
        });
        Depth { slab: *slab, number, dilatation, lateral: None }
    }

    /// The layer at the wave number `number` with given coefficients A and B of the dilatation under a unit pressure,
    /// multiplied by `2 (1+nu) alpha`; B must be 0 from q h = 20 on.
    pub fn with_dilatation(slab: &Slab, dilatation: Option<(f64, f64)>, number: f64) -> Depth {
        Depth { slab: *slab, number, dilatation, lateral: None }
    }

    /// The layer with conduction out of the plane, beside the contact.
    pub(crate) fn spreading(self, lateral: Option<Lateral>) -> Depth {
        Depth { lateral, ..self }
    }

    /// Z(q, s), K m2/W.
    pub(crate) fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        spread(self.lateral.as_ref(), s, |s| self.slab.impedance(s, self.number))
    }

    /// D(q, s), m3/W; 0 without thermal expansion.
    pub(crate) fn distortion(&self, s: Complex<f64>) -> Complex<f64> {
        self.respond(s)[1]
    }

    /// Z and D together.
    pub fn respond(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let Some(lateral) = &self.lateral else { return self.respond_in_plane(s) };
        let mut sum = [Complex::from(0.0); 2];
        for (share, s) in lateral.frequencies(s) {
            let response = self.respond_in_plane(s);
            sum = [sum[0] + response[0] * share, sum[1] + response[1] * share];
        }
        sum
    }

    fn respond_in_plane(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let q = self.number;
        let impedance = self.slab.impedance(s, q);
        let Some((direct, reflected)) = self.dilatation else { return [impedance, Complex::from(0.0)] };
        [impedance, -self.slab.moment(s, q, impedance, [direct, reflected])]
    }

    /// Reduces the layer to states, accurate at frequencies from `slowest` to `fastest` (1/s, of the excitation as of
    /// the layer's own decay); `ratio`: ratio of neighbouring shifts.
    pub(crate) fn reduce(&self, slowest: f64, fastest: f64, ratio: f64) -> DepthModes {
        let own = self.slowest_decay();
        let first = own.max(self.slab.own_rate()).min(fastest);
        let steps = (fastest / first).ln() / ratio.ln();
        let intervals = steps.ceil().max(1.0);
        let factor = (steps / intervals * ratio.ln()).exp().max(1.5);
        // The stationary response is exact (shift 0); the other shifts are decay rates through the depth, beyond that
        // along the layer.
        let mut shifts = vec![0.0];
        let mut decay = first;
        for _ in 0..intervals as usize {
            decay *= factor;
            if decay - own > slowest {
                shifts.push(decay - own);
            }
        }
        // In decreasing order, so that of nearly dependent fields the slow ones are dropped.
        shifts[1..].reverse();
        let mut modes = self.pencil(&shifts);
        self.leave_what_is_passive(&mut modes);
        modes
    }

    /// Weakens the fastest state until the truncated part `Z - Z_reduced` at imaginary frequencies about its decay rate
    /// has a real part >= 0.
    ///
    /// The truncated part acts as direct feedthrough. If it is not passive, two bodies in thermal contact raise each
    /// other's flux without bound in short steps; near the fastest decay rate its real part is a tenth below 0, because
    /// the last state represents all faster decays. The steady response stays exact, since the static correction
    /// compensates.
    fn leave_what_is_passive(&self, modes: &mut DepthModes) {
        let fastest = modes.rate.iter().enumerate().max_by(|left, right| left.1.total_cmp(right.1));
        let Some((fastest, &decay)) = fastest else { return };
        let mut share: f64 = 1.0;
        for k in 0..FREQUENCIES {
            // From a third of the fastest decay to ten times it.
            let frequency = decay * 10f64.powf(1.5 * k as f64 / (FREQUENCIES - 1) as f64 - 0.5);
            let s = Complex::new(0.0, frequency);
            let last = (modes.temperature[fastest].powi(2) / (s + decay)).re;
            share = share.min((self.impedance(s).re - modes.impedance(s).re) / last + 1.0);
        }
        let factor = share.max(0.0).sqrt();
        modes.temperature[fastest] *= factor;
        modes.distortion[fastest] *= factor;
    }

    /// Galerkin on the exact fields at the shifts, from values of Z and D alone. A field that is linearly dependent on
    /// the others to rounding is left out.
    fn pencil(&self, shifts: &[f64]) -> DepthModes {
        let values: Vec<(f64, f64, f64)> = shifts
            .iter()
            .map(|&s| {
                // A complex step gives the derivative without cancellation.
                let step = 1e-20 * (s + self.slowest_decay());
                let value = self.impedance(Complex::new(s, step));
                (value.re, value.im / step, self.distortion(Complex::from(s)).re)
            })
            .collect();
        let entry = |i: usize, j: usize| {
            let ((zi, di, _), (zj, _, _)) = (values[i], values[j]);
            let (si, sj) = (shifts[i], shifts[j]);
            if i == j { (-di, zi + si * di) } else { ((zi - zj) / (sj - si), (si * zi - sj * zj) / (si - sj)) }
        };
        // Scaled to a mass matrix of unit diagonal.
        let scale: Vec<f64> = (0..shifts.len()).map(|i| entry(i, i).0.sqrt().recip()).collect();
        let mut kept: Vec<usize> = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for candidate in 0..shifts.len() {
            let mut row: Vec<f64> = Vec::new();
            for (known, other) in kept.iter().zip(&rows) {
                let product: f64 = row.iter().zip(other).map(|(l, r)| l * r).sum();
                let mass = scale[candidate] * scale[*known] * entry(candidate, *known).0;
                row.push((mass - product) / other[row.len()]);
            }
            let pivot = 1.0 - row.iter().map(|value| value * value).sum::<f64>();
            // Smallest squared norm of the part of a normalised trial field independent of the others.
            if pivot > 1e-12 {
                row.push(pivot.sqrt());
                rows.push(row);
                kept.push(candidate);
            }
        }
        let count = kept.len();
        let factor = DMatrix::from_fn(count, count, |i, j| rows[i].get(j).copied().unwrap_or(0.0));
        let stiffness =
            DMatrix::from_fn(count, count, |i, j| scale[kept[i]] * scale[kept[j]] * entry(kept[i], kept[j]).1);
        let solve = |matrix: &DMatrix<f64>| factor.solve_lower_triangular(matrix).expect("pivots are positive");
        let reduced = solve(&solve(&stiffness).transpose());
        let eigen = factorization::symmetric_eigen_or_nan(0.5 * (&reduced + reduced.transpose()));
        let loads = DMatrix::from_fn(count, 2, |i, part| {
            let (temperature, _, distortion) = values[kept[i]];
            scale[kept[i]] * if part == 0 { temperature } else { distortion }
        });
        let observed = eigen.eigenvectors.transpose() * solve(&loads);
        DepthModes {
            // The decay rate of the mode along the layer is a lower bound.
            rate: eigen.eigenvalues.iter().map(|&rate| rate.max(self.slowest_decay())).collect(),
            temperature: observed.column(0).iter().copied().collect(),
            distortion: observed.column(1).iter().copied().collect(),
        }
    }

    /// Decay rate kd q^2 of the mode along the layer, a lower bound of every rate.
    fn slowest_decay(&self) -> f64 {
        self.slab.slowest_decay(self.number)
    }
}

/// Number of frequencies at which the truncated part is tested.
const FREQUENCIES: usize = 16;

/// Reduced layer at one wave number: `dx_k/dt = -rate_k x_k + temperature_k f`, T = sum temperature_k x_k,
/// u = sum distortion_k x_k.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct DepthModes {
    /// Decay rates, 1/s.
    pub rate: Vec<f64>,
    /// Input and observation of the surface temperature.
    pub temperature: Vec<f64>,
    /// Observation of the distortion.
    pub distortion: Vec<f64>,
}

impl DepthModes {
    /// Reduced Z(q, s).
    pub(crate) fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        self.rate.iter().zip(&self.temperature).map(|(rate, b)| b * b / (s + rate)).sum()
    }

    /// Reduced Z and D together.
    pub(crate) fn respond(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        self.respond_for(s, f64::INFINITY)
    }

    /// Reduced Z and D of a flux that began only this `time` (s) ago.
    pub(crate) fn respond_for(&self, s: Complex<f64>, time: f64) -> [Complex<f64>; 2] {
        let mut sums = [Complex::from(0.0); 2];
        for (rate, (b, d)) in self.rate.iter().zip(self.temperature.iter().zip(&self.distortion)) {
            let decay = s + rate;
            let begun = if time.is_finite() { 1.0 - (-decay * time).exp() } else { Complex::from(1.0) };
            let part = begun / decay * b;
            sums[0] += part * b;
            sums[1] += part * d;
        }
        sums
    }
}

/// Coefficients A and B of the dilatation at u = q h.
///
/// Smooth base, by symmetry about it: `2 sinh u cosh(q(h-z))/(sinh 2u + 2u)`. Bonded: the coefficients of the two
/// solutions with a dilatation, from the boundary conditions.
pub fn dilatation(base: elasticity::Base, nu: f64, u: f64) -> (f64, f64) {
    if u > 20.0 {
        return (1.0, 0.0);
    }
    if base == elasticity::Base::Smooth {
        let decay = (-2.0 * u).exp();
        let both = -(-2.0 * u).exp_m1() / (0.5 * (1.0 - decay * decay) + 2.0 * u * decay);
        return (0.5 * both, 0.5 * both * (-u).exp());
    }
    // Displacements (U sin qx, W cos qx) with G = q = 1, height u, z downwards; the pairs that decay from the surface
    // and from the base: exp(-z) (1, 1), exp(-z) (z - kappa, z), and their mirror images.
    let kappa = 3.0 - 4.0 * nu;
    let fields = |z: f64, mirrored: bool| {
        let t = if mirrored { u - z } else { z };
        let decay = (-t).exp();
        let sign = if mirrored { -1.0 } else { 1.0 };
        // (U, W, shear stress, normal stress) of the two solutions.
        let first = [decay, sign * decay, -2.0 * sign * decay, -2.0 * decay];
        // lambda div + 2 W' with div = (1 - kappa) exp(-t) = -2 (1-2nu) exp(-t): the factor 1-2nu cancels.
        let normal = (-4.0 * nu + 2.0 * (1.0 - t)) * decay;
        let second = [(t - kappa) * decay, sign * t * decay, sign * (1.0 - t + kappa - t) * decay, normal];
        [first, second]
    };
    let mut matrix = Matrix4::zeros();
    for (pair, mirrored) in [(0, false), (2, true)] {
        let (top, bottom) = (fields(0.0, mirrored), fields(u, mirrored));
        for k in 0..2 {
            matrix[(0, pair + k)] = top[k][3];
            matrix[(1, pair + k)] = top[k][2];
            matrix[(2, pair + k)] = bottom[k][0];
            matrix[(3, pair + k)] = bottom[k][1];
        }
    }
    // The dilatation of the second and fourth is (1 - kappa) exp(..); a half-plane's is -(1-2nu).
    match factorization::solve(&matrix, &Vector4::new(-1.0, 0.0, 0.0, 0.0)) {
        Ok(c) => (2.0 * c[1], 2.0 * c[3]),
        Err(Unfactorable::NotFinite { .. }) => (f64::NAN, f64::NAN),
        Err(_) => (1.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::FarBoundary;

    #[test]
    fn long_waves_expand_uniformly_and_short_ones_like_a_half_plane() {
        for nu in [0.0, 0.3, 0.49] {
            let (direct, reflected) = dilatation(elasticity::Base::Smooth, nu, 1e-4);
            assert!((direct + reflected - 0.5).abs() < 1e-4, "{direct} {reflected}");
            let (direct, reflected) = dilatation(elasticity::Base::Bonded, nu, 1e-4);
            assert!((direct + reflected - 0.5 / (1.0 - nu)).abs() < 1e-4, "{nu}: {direct} {reflected}");
            for base in [elasticity::Base::Smooth, elasticity::Base::Bonded] {
                let (direct, reflected) = dilatation(base, nu, 19.9);
                assert!((direct - 1.0).abs() < 1e-12 && reflected.abs() < 1e-6, "{base:?} {direct} {reflected}");
            }
        }
    }

    #[test]
    fn reduced_wave_follows_impedance_and_distortion() {
        let material = Material::new(200e9, 0.3).unwrap();
        for base in [FarBoundary::Held, FarBoundary::Insulated, FarBoundary::Convecting(3e3)] {
            let slab = Slab { surface_transfer: 20.0, ..Slab::bare(0.02, [55.0, 7800.0 * 460.0], base) };
            let expansion = Expansion { material, coefficient: 1.1e-5, base: elasticity::Base::Bonded };
            for number in [10.0, 100.0, 3000.0] {
                let depth = Depth::new(&slab, Some(&expansion), number);
                let modes = depth.reduce(1e-3, 4e3, 2.5);
                assert!(modes.rate.iter().all(|rate| *rate > 0.0));
                // The static correction at rest compensates the weakened state.
                let rest = depth.impedance(Complex::from(0.0)) - modes.impedance(Complex::from(0.0));
                let still = depth.distortion(Complex::from(0.0)) - modes.respond(Complex::from(0.0))[1];
                for frequency in [0.0, 0.01, 1.0, 30.0, 1e3] {
                    let s = Complex::new(0.0, frequency);
                    let (z, d) = (depth.impedance(s), depth.distortion(s));
                    let error = (modes.impedance(s) + rest - z).norm();
                    let moved = (modes.respond(s)[1] + still - d).norm();
                    let bound = if frequency < 1e3 { 4e-4 } else { 4e-3 };
                    assert!(
                        error < bound * depth.impedance(Complex::from(0.0)).norm(),
                        "{base:?} {number} {frequency}: {error:e} {z}"
                    );
                    assert!(
                        moved < bound * depth.distortion(Complex::from(0.0)).norm(),
                        "{base:?} {number} {frequency}: {moved:e} {d}"
                    );
                    assert!(d.re < 0.0 || frequency > 0.0);
                }
                // The truncated part is passive, up to the error of the reduction.
                for k in 0..60 {
                    let s = Complex::new(0.0, 1e-2 * 10f64.powf(0.15 * f64::from(k)));
                    let rest = (depth.impedance(s) - modes.impedance(s)).re / depth.impedance(s).re;
                    assert!(rest > -1e-3, "{base:?} {number} {}: {rest:e}", s.im);
                }
            }
        }
    }
}
