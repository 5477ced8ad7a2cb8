//! Surface displacement of an elastic layer under sinusoidal tractions.
//!
//! Theory: docs/theory.md, section 3.3.

/// Boundary condition at the base of the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// Bonded to a rigid base: no displacement.
    Bonded,
    /// On a smooth rigid base: no normal displacement, no shear traction.
    Smooth,
}

/// Fourier kernels of a layer of height `h`, as functions of `u = q h`, `q > 0` the wave number.
///
/// Under the pressure `cos q x` the surface moves by `(1-nu)/(G q) Phi(u) cos q x` into the layer, under the shear
/// traction `cos q x` in +x by `1/(2 G q) (1-2nu) Psi(u) sin q x`, with `kappa = 3 - 4 nu` and
///
/// ```text
/// bonded: Phi = (2 kappa sinh 2u - 4u)/(2 kappa cosh 2u + 1 + kappa^2 + 4u^2)
///         (1-2nu) Psi = [kappa (1-2nu) sinh^2 u - u^2]/[kappa sinh^2 u + u^2 + 4 (1-nu)^2]
/// smooth: Phi = (cosh 2u - 1)/(sinh 2u + 2u)
///         (1-2nu) Psi = [(1-2nu) sinh 2u - 2u]/(sinh 2u + 2u)
/// ```
///
/// Both tend to the half-plane's, Phi = Psi = 1, like `u^2 exp(-2u)`. The factor `1 - 2nu` of the shear kernel is part of
/// it, which avoids a division by a small number near nu = 0.5. All are scaled by `exp(-2u)`: no overflow. Relative error of
/// Phi about 1e-15 for every u; absolute error of (1-2nu) Psi the same (it changes sign).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripKernel {
    base: Base,
    nu: f64,
    kappa: f64,
}

impl StripKernel {
    /// Kernels for a base and a Poisson's ratio.
    pub fn new(base: Base, poissons_ratio: f64) -> Self {
        Self { base, nu: poissons_ratio, kappa: 3.0 - 4.0 * poissons_ratio }
    }

    /// Normal kernel Phi(u), u > 0.
    pub fn normal(&self, u: f64) -> f64 {
        let e = (-2.0 * u).exp();
        match self.base {
            Base::Bonded => {
                // Below this `u` the difference `sinh 2u - 2u` is summed as a series.
                let numerator = if u < 0.5 {
                    e * (2.0 * self.kappa * sinh_less_argument(2.0 * u) + 4.0 * u * (self.kappa - 1.0))
                } else {
                    self.kappa * (1.0 - e * e) - 4.0 * u * e
                };
                numerator / self.bonded_normal_denominator(u, e)
            }
            Base::Smooth => 0.5 * (-2.0 * u).exp_m1().powi(2) / smooth_denominator(u, e),
        }
    }

    /// Phi(u) - 1, accurate where it is small, u > 0.
    pub(crate) fn normal_remainder(&self, u: f64) -> f64 {
        let e = (-2.0 * u).exp();
        match self.base {
            Base::Bonded => {
                let kappa = self.kappa;
                -e * (2.0 * kappa * e + 1.0 + kappa * kappa + 4.0 * u + 4.0 * u * u)
                    / self.bonded_normal_denominator(u, e)
            }
            Base::Smooth => e * ((-2.0 * u).exp_m1() - 2.0 * u) / smooth_denominator(u, e),
        }
    }

    /// Limit of Phi(u)/u for u -> 0: a uniform pressure p compresses the layer by `(1-nu) h/G` times this times p.
    pub(crate) fn normal_at_zero(&self) -> f64 {
        match self.base {
            Base::Bonded => 0.5 * (1.0 - 2.0 * self.nu) / (1.0 - self.nu).powi(2),
            Base::Smooth => 0.5,
        }
    }

    /// Tangential kernel less the normal one, Theta(u) - Phi(u), u > 0: the shear traction `cos q x` moves the surface
    /// along x by `(1-nu)/(G q) Theta(u) cos q x`,
    ///
    /// ```text
    /// bonded: Theta = (2 kappa sinh 2u + 4u)/(2 kappa cosh 2u + 1 + kappa^2 + 4u^2)
    /// smooth: Theta = (cosh 2u + 1)/(sinh 2u + 2u)
    /// ```
    ///
    /// The half-plane has the same kernel for both, so the difference decays like `u exp(-2u)`. On a smooth base it grows
    /// like `1/(2u)` for u -> 0: the layer is unconstrained against a net shear.
    pub(crate) fn tangential_less_normal(&self, u: f64) -> f64 {
        let e = (-2.0 * u).exp();
        match self.base {
            Base::Bonded => 8.0 * u * e / self.bonded_normal_denominator(u, e),
            Base::Smooth => 2.0 * e / smooth_denominator(u, e),
        }
    }

    /// Shear kernel (1-2nu) Psi(u), u > 0.
    pub fn shear(&self, u: f64) -> f64 {
        let e = (-2.0 * u).exp();
        let squeezed = 1.0 - 2.0 * self.nu;
        match self.base {
            Base::Bonded => {
                let sinh_squared = (-2.0 * u).exp_m1().powi(2);
                (self.kappa * squeezed * sinh_squared - 4.0 * e * u * u) / self.bonded_shear_denominator(u, e)
            }
            Base::Smooth => (-squeezed * (-4.0 * u).exp_m1() - 4.0 * u * e) / (2.0 * smooth_denominator(u, e)),
        }
    }

    /// (1-2nu) (Psi(u) - 1), accurate where it is small, u > 0.
    pub(crate) fn shear_remainder(&self, u: f64) -> f64 {
        let e = (-2.0 * u).exp();
        let squeezed = 1.0 - 2.0 * self.nu;
        match self.base {
            Base::Bonded => {
                let numerator = squeezed * (u * u + 4.0 * (1.0 - self.nu).powi(2)) + u * u;
                -4.0 * e * numerator / self.bonded_shear_denominator(u, e)
            }
            Base::Smooth => -4.0 * u * e * (1.0 - self.nu) / smooth_denominator(u, e),
        }
    }

    /// Limit of (1-2nu) Psi(u) for u -> 0. Not zero for a smooth base: a net shear stretches the layer on one side of
    /// the contact and compresses it on the other, and its height follows by Poisson's ratio.
    pub(crate) fn shear_at_zero(&self) -> f64 {
        match self.base {
            Base::Bonded => 0.0,
            Base::Smooth => -self.nu,
        }
    }

    /// `(2 kappa cosh 2u + 1 + kappa^2 + 4 u^2) exp(-2u)`, `e = exp(-2u)`.
    fn bonded_normal_denominator(&self, u: f64, e: f64) -> f64 {
        self.kappa * (1.0 + e * e) + e * (1.0 + self.kappa * self.kappa + 4.0 * u * u)
    }

    /// `4 [kappa sinh^2 u + u^2 + 4 (1-nu)^2] exp(-2u)`, `e = exp(-2u)`.
    fn bonded_shear_denominator(&self, u: f64, e: f64) -> f64 {
        self.kappa * (-2.0 * u).exp_m1().powi(2) + 4.0 * e * (u * u + 4.0 * (1.0 - self.nu).powi(2))
    }
}

/// `(sinh 2u + 2u) exp(-2u)`, `e = exp(-2u)`.
fn smooth_denominator(u: f64, e: f64) -> f64 {
    -0.5 * (-4.0 * u).exp_m1() + 2.0 * u * e
}

/// `sinh x - x` by its series, for |x| up to 1.
pub(super) fn sinh_less_argument(x: f64) -> f64 {
    let square = x * x;
    let (mut term, mut sum) = (x, 0.0);
    for k in 1..12 {
        term *= square / ((2 * k) * (2 * k + 1)) as f64;
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};

    const NU: [f64; 4] = [0.0, 0.3, 0.45, 0.4999];

    /// Surface displacements (normal into the layer per pressure, per shear; along x per shear) of a layer with G = 1,
    /// h = 1, from the displacement equations alone: four exponential solutions, coefficients from the boundary conditions.
    ///
    /// With z downwards, `u_x = U(z) sin qx`, `u_z = W(z) cos qx`. Papkovich-Neuber gives the solutions
    /// `exp(-qz) (1, 1)`, `exp(-qz) (qz - kappa, qz)` for (U, W) and their images under z -> -z, W -> -W.
    fn layer(base: Base, nu: f64, q: f64) -> (f64, f64, f64) {
        let kappa = 3.0 - 4.0 * nu;
        let lambda = 2.0 * nu / (1.0 - 2.0 * nu);
        // (U, W, U', W') of the four solutions at z, the growing pair referred to the base z = 1.
        let solution = |k: usize, z: f64| -> [f64; 4] {
            let sign = if k < 2 { 1.0 } else { -1.0 };
            let t = if k < 2 { z } else { z - 1.0 };
            let e = (-sign * q * t).exp();
            let s = sign * q * t;
            let (u, w, du, dw) = if k.is_multiple_of(2) {
                (e, e, -q * e, -q * e)
            } else {
                ((s - kappa) * e, s * e, q * (1.0 - s + kappa) * e, q * (1.0 - s) * e)
            };
            // Reflection: U(-z), -W(-z); derivatives U' -> -U', W' -> W'.
            [u, sign * w, sign * du, dw]
        };
        let stresses = |f: [f64; 4]| {
            let normal = lambda * (q * f[0] + f[3]) + 2.0 * f[3]; // sigma_zz / cos
            let shear = f[2] - q * f[1]; // sigma_xz / sin
            (normal, shear)
        };
        let mut matrix = Matrix4::zeros();
        for k in 0..4 {
            let top = solution(k, 0.0);
            let bottom = solution(k, 1.0);
            let (normal, shear) = stresses(top);
            matrix[(0, k)] = normal;
            matrix[(1, k)] = shear;
            matrix[(2, k)] = bottom[1];
            matrix[(3, k)] = if base == Base::Bonded { bottom[0] } else { stresses(bottom).1 };
        }
        let solve = |load: Vector4<f64>, component: usize| {
            let c = matrix.lu().solve(&load).unwrap();
            (0..4).map(|k| c[k] * solution(k, 0.0)[component]).sum::<f64>()
        };
        // Pressure p = cos: sigma_zz = -p on the surface z = 0 (z into the layer).
        let per_pressure = solve(Vector4::new(-1.0, 0.0, 0.0, 0.0), 1);
        // Shear traction sin qx in +x acts as sigma_xz = -sin qx on a surface with outward normal -z; the response
        // -W cos qx to sin qx is the response W sin qx to cos qx, shifted by a quarter wave.
        let shear = Vector4::new(0.0, -1.0, 0.0, 0.0);
        (per_pressure, -solve(shear, 1), solve(shear, 0))
    }

    #[test]
    fn kernels_equal_the_solution_of_the_layer_equations() {
        for base in [Base::Bonded, Base::Smooth] {
            for nu in NU {
                let kernel = StripKernel::new(base, nu);
                for u in [0.05, 0.2, 0.49, 0.51, 1.0, 2.0, 5.0, 15.0] {
                    let (normal, shear, tangential) = layer(base, nu, u);
                    let error = (1.0 - nu) / u * kernel.normal(u) / normal - 1.0;
                    // The reference loses digits at small u and near incompressibility, by the size of lambda.
                    let bound = 1e-10 / (1.0 - 2.0 * nu).max(1e-2);
                    assert!(error.abs() < bound, "{base:?} nu {nu} u {u}: normal {error:e}");
                    let error = kernel.shear(u) / (2.0 * u) - shear;
                    assert!(error.abs() < bound, "{base:?} nu {nu} u {u}: shear {error:e}");
                    let own = kernel.normal(u) + kernel.tangential_less_normal(u);
                    let error = (1.0 - nu) / u * own / tangential - 1.0;
                    assert!(error.abs() < bound, "{base:?} nu {nu} u {u}: tangential {error:e}");
                }
            }
        }
    }

    #[test]
    fn remainders_are_what_is_left_of_the_half_plane() {
        for base in [Base::Bonded, Base::Smooth] {
            for nu in NU {
                let kernel = StripKernel::new(base, nu);
                for u in [1e-3, 0.1, 0.499, 0.5, 1.0, 4.0] {
                    assert!((kernel.normal(u) - 1.0 - kernel.normal_remainder(u)).abs() < 1e-15 * 4.0);
                    let shear = kernel.shear(u) - (1.0 - 2.0 * nu) - kernel.shear_remainder(u);
                    assert!(shear.abs() < 4e-15, "{base:?} {nu} {u}: {shear:e}");
                }
                assert!(kernel.normal_remainder(20.0) < 0.0 && kernel.normal_remainder(20.0) > -1e-13);
            }
        }
    }

    #[test]
    fn limits_of_long_and_short_waves() {
        for base in [Base::Bonded, Base::Smooth] {
            for nu in NU {
                let kernel = StripKernel::new(base, nu);
                let ratio = kernel.normal(1e-8) / 1e-8 / kernel.normal_at_zero();
                assert!((ratio - 1.0).abs() < 1e-10, "{base:?} {nu}: {ratio}");
                assert!((kernel.shear(1e-8) - kernel.shear_at_zero()).abs() < 1e-14);
                assert_eq!((kernel.normal(1e4), kernel.shear(1e4)), (1.0, 1.0 - 2.0 * nu));
            }
        }
    }
}
