//! Half of an elastic layer in bending: the pressure on one of its faces is the suction on the other.
//!
//! Disc between two pads, seen from its mid plane at the depth h, half of the thickness. Normal displacements of both faces
//! are equal; on the mid plane the normal stress and the in-plane displacement vanish. With u = q h, under the pressure
//! `cos q x` on the face
//!
//! ```text
//! displacement  (1-nu)/(G q) Phi(u) cos q x,              Phi = (cosh 2u + 1)/(sinh 2u - 2u)
//! dilatation   -(1-2nu)/G 2 cosh u sinh(q(h-z))/(sinh 2u - 2u) cos q x
//! ```
//!
//! Limits: the half-plane for u -> infinity; a plate in bending, Phi = 3/(2 u^3), for u -> 0. Relative error about 1e-15.
//!
//! Theory: docs/theory.md, section 3.6.

use super::strip_kernel::sinh_less_argument;

/// Beyond this `u` the other face has no effect to rounding.
const DEEP: f64 = 20.0;

/// Normal compliance kernel Phi(u), u > 0.
pub(crate) fn compliance(u: f64) -> f64 {
    if u > DEEP {
        return 1.0;
    }
    let e = (-2.0 * u).exp();
    (1.0 + e).powi(2) / denominator(u, e)
}

/// A and B of the dilatation `-(1-2nu)/G [A exp(-qz) + B exp(-q(h-z))]` at u > 0.
pub fn dilatation(u: f64) -> (f64, f64) {
    if u > DEEP {
        return (1.0, 0.0);
    }
    let e = (-2.0 * u).exp();
    let direct = (1.0 + e) / denominator(u, e);
    (direct, -direct * (-u).exp())
}

/// 2 (sinh 2u - 2u) exp(-2u).
fn denominator(u: f64, e: f64) -> f64 {
    // Below this `u` the difference `sinh 2u - 2u` is summed as a series.
    if u < 0.5 { 2.0 * e * sinh_less_argument(2.0 * u) } else { 1.0 - e * e - 4.0 * u * e }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thick_layers_are_half_planes_and_thin_ones_plates_in_bending() {
        assert!((compliance(19.9) - 1.0).abs() < 1e-13 && compliance(20.1) == 1.0);
        let (direct, reflected) = dilatation(19.9);
        assert!((direct - 1.0).abs() < 1e-13 && reflected.abs() < 1e-8);
        for u in [1e-5, 1e-3, 1e-2] {
            assert!((compliance(u) * 2.0 * u.powi(3) / 3.0 - 1.0).abs() < 1.3 * u * u + 1e-14, "{u}");
        }
        // Series and closed form.
        assert!((compliance(0.5 - 1e-12) / compliance(0.5 + 1e-12) - 1.0).abs() < 1e-10);
    }

    /// Stress function F cos qx, F = P sinh + Q (q(h-z)) cosh of q(h-z), for the pressure without shear; its normal
    /// displacement by the plane-strain law equals the kernel.
    #[test]
    fn the_stress_function_gives_both() {
        for u in [0.1_f64, 0.7, 2.0, 6.0] {
            let (sinh, cosh) = (u.sinh(), u.cosh());
            // F(u) = 1, F'(u) = 0 at q = 1: the pressure is 1.
            let ratio = -(cosh + u * sinh) / cosh;
            let q = 1.0 / (ratio * sinh + u * cosh);
            let p = ratio * q;
            // Laplacian of F: 2 Q sinh; sigma_x + sigma_z = 2 (lambda + G) e.
            let (direct, reflected) = dilatation(u);
            for z in [0.0, 0.3 * u, u] {
                let t: f64 = u - z;
                let expected = -q * t.sinh();
                let found = direct * (-z).exp() + reflected * (-(u - z)).exp();
                assert!((found - expected).abs() < 1e-12 * direct, "{u} {z}: {found} {expected}");
            }
            // The work of the pressure, Phi, is twice the strain energy. In units (1-nu)/G the energy density of plane strain is
            // [(1-nu)(sx + sz)^2 - 2 (sx sz - t^2)]/(4 G).
            let n = 4000;
            let nu = 0.3;
            let mut energy = 0.0;
            for k in 0..n {
                let t = u * (k as f64 + 0.5) / n as f64;
                let f = p * t.sinh() + q * t * t.cosh();
                let slope = p * t.cosh() + q * (t.cosh() + t * t.sinh());
                let curve = p * t.sinh() + q * (2.0 * t.sinh() + t * t.cosh());
                // sx = F'' cos, sz = -F cos, shear = F' sin: means of both squares 1/2.
                let sum: f64 = curve - f;
                energy += ((1.0 - nu) * sum * sum + 2.0 * (curve * f + slope * slope)) / 4.0 * u / n as f64;
            }
            let found = 2.0 * energy / (1.0 - nu);
            assert!((found / compliance(u) - 1.0).abs() < 2e-6, "{u}: {found} {}", compliance(u));
        }
    }
}
