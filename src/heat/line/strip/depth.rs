//! Conduction through the depth at one wave number: exact impedance and distortion, and their reduction to states.
//!
//! With `kappa^2 = q^2 + s/kd` a flux `exp(iqx)` of amplitude 1 and frequency s heats the layer by
//! `Z(q, s) [exp(-kappa z) + rho exp(-kappa (2h - z))]/[1 + rho exp(-2 kappa h)]`, rho the reflection at the base, and by
//! reciprocity displaces its surface by
//!
//! ```text
//! D(q, s) = -2 (1+nu) alpha integral_0^h T(z) [A exp(-qz) + B exp(-q(h-z))] dz
//! ```
//!
//! where the bracket times -(1-2nu)/G is the (harmonic) dilatation under a unit pressure `exp(iqx)`; a half-plane has
//! A = 1, B = 0. Heating lifts the surface: D < 0.
//!
//! The exact fields at a few real frequencies span the reduced space. Mass, load and observations follow from values
//! of Z and D alone (symmetric Loewner pencil), so the reduced rates are real, positive and bounded below by those of the
//! layer, the impedance is interpolated with its derivative, and the stationary response (s = 0) is exact.

use crate::elastic::{self, Material};
use crate::heat::slab::{Base, Slab};
use nalgebra::{Complex, DMatrix, DVector, Matrix4, SymmetricEigen, Vector4};

/// What makes the surface move under heat.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Expansion {
    /// Elastic constants.
    pub material: Material,
    /// Linear coefficient alpha, 1/K.
    pub coefficient: f64,
    /// What holds the strip at its base.
    pub base: elastic::Base,
}

/// The layer at one wave number q > 0.
#[derive(Clone, Copy, Debug)]
pub struct Depth<'a> {
    slab: &'a Slab,
    number: f64,
    /// `2 (1+nu) alpha` times A and B; `None`: nothing expands.
    dilatation: Option<(f64, f64)>,
}

impl<'a> Depth<'a> {
    /// The layer `slab` at the wave number `number`.
    pub fn new(slab: &'a Slab, expansion: Option<&Expansion>, number: f64) -> Depth<'a> {
        let dilatation = expansion.map(|expansion| {
            let nu = expansion.material.poissons_ratio();
            let (direct, reflected) = dilatation(expansion.base, nu, number * slab.height);
            let factor = 2.0 * (1.0 + nu) * expansion.coefficient;
            (factor * direct, factor * reflected)
        });
        Depth { slab, number, dilatation }
    }

    /// Z(q, s), K m2/W.
    pub fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        self.slab.impedance(s, self.number)
    }

    /// D(q, s), m3/W; 0 where nothing expands.
    pub fn distortion(&self, s: Complex<f64>) -> Complex<f64> {
        let Some((direct, reflected)) = self.dilatation else { return Complex::from(0.0) };
        let (q, h) = (self.number, self.slab.height);
        let kappa = (s / self.slab.diffusivity() + q * q).sqrt();
        let reflection = match self.slab.base {
            Base::Held => Complex::from(-1.0),
            Base::Insulated => Complex::from(1.0),
            Base::Convecting(transfer) => {
                let beta = transfer / (kappa * self.slab.conductivity);
                (1.0 - beta) / (1.0 + beta)
            }
        };
        // Integrals over the depth of the four products of exponentials.
        let (slow, fast) = ((-q * h).exp(), (-kappa * h).exp());
        let together = (1.0 - slow * fast) / (kappa + q);
        let difference = (kappa - q) * h;
        let apart = if difference.norm() < 1e-3 {
            // (1 - exp(-x))/x
            slow * h * (1.0 - 0.5 * difference + difference * difference / 6.0 - difference.powi(3) / 24.0)
        } else {
            (slow - fast) / (kappa - q)
        };
        let integral = together * direct + apart * reflected
            + reflection * fast * (apart * direct + together * reflected);
        -self.impedance(s) * integral / (1.0 + reflection * fast * fast)
    }

    /// Reduces the layer to states that answer frequencies up to `fastest` (1/s, of the decay and of what drives it alike),
    /// shifts `ratio` apart.
    pub fn reduce(&self, slowest: f64, fastest: f64, ratio: f64) -> DepthModes {
        let diffusivity = self.slab.diffusivity();
        let own = diffusivity * self.number * self.number;
        let first = own.max(0.5 * diffusivity / self.slab.height.powi(2)).max(slowest).min(fastest);
        let steps = (fastest / first).ln() / ratio.ln();
        let intervals = steps.ceil().max(1.0);
        let factor = (steps / intervals * ratio.ln()).exp().max(1.5);
        let mut shifts = vec![0.0];
        let mut decay = first;
        for _ in 0..intervals as usize {
            decay *= factor;
            shifts.push(decay - own.min(first));
        }
        let mut kept = shifts;
        loop {
            if let Some(modes) = self.pencil(&kept) {
                return modes;
            }
            // Fewer frequencies are better conditioned; a single one always works.
            kept = kept.iter().copied().step_by(2).collect();
        }
    }

    fn pencil(&self, shifts: &[f64]) -> Option<DepthModes> {
        let count = shifts.len();
        let values: Vec<(f64, f64, f64)> = shifts
            .iter()
            .map(|&s| {
                // A complex step gives the derivative without cancellation.
                let step = 1e-20 * (s + self.slab.diffusivity() * self.number * self.number);
                let value = self.impedance(Complex::new(s, step));
                (value.re, value.im / step, self.distortion(Complex::from(s)).re)
            })
            .collect();
        if count == 1 {
            let (value, slope, distortion) = values[0];
            let rate = -value / slope - shifts[0];
            let load = (-slope).sqrt() * (rate + shifts[0]);
            return Some(DepthModes {
                rate: vec![rate],
                temperature: vec![load],
                distortion: vec![load * distortion / value],
            });
        }
        let entry = |i: usize, j: usize| {
            let ((zi, di, _), (zj, _, _)) = (values[i], values[j]);
            let (si, sj) = (shifts[i], shifts[j]);
            if i == j { (-di, zi + si * di) } else { ((zi - zj) / (sj - si), (si * zi - sj * zj) / (si - sj)) }
        };
        // Scaled to a unit diagonal of the mass.
        let scale: Vec<f64> = (0..count).map(|i| entry(i, i).0.sqrt().recip()).collect();
        let mass = DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * entry(i, j).0);
        let stiffness = DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * entry(i, j).1);
        let factor = mass.cholesky()?.l();
        if factor.diagonal().min() < 1e-5 {
            return None;
        }
        let half = factor.solve_lower_triangular(&stiffness)?;
        let reduced = factor.solve_lower_triangular(&half.transpose())?;
        let eigen = SymmetricEigen::new(0.5 * (&reduced + reduced.transpose()));
        let observed = |value: &dyn Fn(usize) -> f64| -> Option<DVector<f64>> {
            let row = DVector::from_fn(count, |i, _| scale[i] * value(i));
            Some(eigen.eigenvectors.transpose() * factor.solve_lower_triangular(&row)?)
        };
        let temperature = observed(&|i| values[i].0)?;
        let distortion = observed(&|i| values[i].2)?;
        if eigen.eigenvalues.min() <= 0.0 {
            return None;
        }
        Some(DepthModes {
            rate: eigen.eigenvalues.iter().copied().collect(),
            temperature: temperature.iter().copied().collect(),
            distortion: distortion.iter().copied().collect(),
        })
    }
}

/// Reduced layer at one wave number: `dx_k/dt = -rate_k x_k + temperature_k f`, T = sum temperature_k x_k,
/// u = sum distortion_k x_k.
#[derive(Clone, PartialEq, Debug)]
pub struct DepthModes {
    /// Decay rates, 1/s.
    pub rate: Vec<f64>,
    /// Input and observation of the surface temperature.
    pub temperature: Vec<f64>,
    /// Observation of the distortion.
    pub distortion: Vec<f64>,
}

impl DepthModes {
    /// Reduced Z(q, s).
    pub fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        self.rate.iter().zip(&self.temperature).map(|(rate, b)| b * b / (s + rate)).sum()
    }

    /// Reduced D(q, s).
    pub fn distortion(&self, s: Complex<f64>) -> Complex<f64> {
        let observed = self.temperature.iter().zip(&self.distortion);
        self.rate.iter().zip(observed).map(|(rate, (b, d))| b * d / (s + rate)).sum()
    }
}

/// A and B of the module at u = q h.
///
/// Smooth base, by symmetry about it: `2 sinh u cosh(q(h-z))/(sinh 2u + 2u)`. Bonded: the coefficients of the two
/// solutions that have a dilatation, from the boundary conditions.
pub fn dilatation(base: elastic::Base, nu: f64, u: f64) -> (f64, f64) {
    if u > 20.0 {
        return (1.0, 0.0);
    }
    if base == elastic::Base::Smooth {
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
        let second =
            [(t - kappa) * decay, sign * t * decay, sign * (1.0 - t + kappa - t) * decay, normal];
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
    let solved = matrix.lu().solve(&Vector4::new(-1.0, 0.0, 0.0, 0.0));
    // The dilatation of the second and fourth is (1 - kappa) exp(..); a half-plane's is -(1-2nu).
    solved.map_or((1.0, 0.0), |c| (2.0 * c[1], 2.0 * c[3]))
}
