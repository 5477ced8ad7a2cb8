//! Tangential compliance: displacement of the surfaces of a scene's bodies along the contact.
//!
//! Theory: docs/theory.md, section 3.8.

use super::discretization::{BodyError, BodyReason, compliances};
use super::kinds::tangential_by_shear;
use super::{Base, Cells, Compliance, Material, StripKernel};
use nalgebra::DMatrix;
use scene::{Body, Scene};
use std::f64::consts::PI;

/// Displacement along x of a body's surface under tractions on the N cells: N x N matrices of cell means, rows: cell
/// that moves, columns: loaded cell, m/Pa. Sign: +x, for tractions that act on this body in +x.
#[derive(Clone, Debug)]
pub struct TangentialCompliance {
    /// Per pressure. The transpose of the normal displacement per shear, `c_i T_ij = c_j S_ji`, by Betti's theorem.
    pub by_pressure: DMatrix<f64>,
    /// Per shear traction in +x.
    pub by_shear: DMatrix<f64>,
}

/// Tangential compliance of punch and strip on the given cells of a line or periodic contact.
///
/// Per shear: the half-plane's and the periodic half-plane's equals its normal compliance per pressure (so its constant is
/// that of the approach); a Fourier layer's differs from its own normal compliance by the smooth sum over
/// [`StripKernel::tangential_less_normal`], without a mean displacement on a smooth base, where it is unconstrained; a
/// block's is computed by finite elements; zero for rigid bodies and Winkler foundations. `contact.shear_coupling` is
/// ignored.
///
/// # Errors
/// As [`compliances`].
pub fn tangential_compliances(scene: &Scene, cells: &Cells) -> Result<[TangentialCompliance; 2], BodyError> {
    let coupled = Scene { shear_coupling: true, ..scene.clone() };
    let [punch, strip] = compliances(&coupled, cells)?;
    Ok([
        body(scene, cells, &scene.punch, punch, true).map_err(|reason| BodyError { body: "punch", reason })?,
        body(scene, cells, &scene.strip, strip, false).map_err(|reason| BodyError { body: "strip", reason })?,
    ])
}

fn body(
    scene: &Scene,
    cells: &Cells,
    body: &Body,
    compliance: Compliance,
    punch: bool,
) -> Result<TangentialCompliance, BodyReason> {
    let (count, widths) = (cells.count(), cells.widths());
    let by_pressure = DMatrix::from_fn(count, count, |i, j| widths[j] * compliance.shear[(j, i)] / widths[i]);
    let by_shear = tangential_by_shear(scene, cells, body, compliance, punch)?;
    Ok(TangentialCompliance { by_pressure, by_shear })
}

/// `(1-nu)/(pi G) [pi h D'(0)/P + sum_k D(q_k h)/k cos q_k (x - s)]`, D the difference of the kernels, as cell means
/// times the loaded cells' widths.
pub(crate) fn layer_difference(
    cells: &Cells,
    material: Material,
    height: f64,
    base: Base,
    period: f64,
) -> DMatrix<f64> {
    let (count, nu) = (cells.count(), material.poissons_ratio());
    let kernel = StripKernel::new(base, nu);
    // D < 1e-16 beyond q h = 23.
    let modes = (23.0 * period / (2.0 * PI * height)).ceil() as usize;
    let means = |q: f64, wave: fn(f64) -> f64| {
        let sinc = |t: f64| if t < 1e-4 { 1.0 - t * t / 6.0 } else { t.sin() / t };
        let widths = cells.widths();
        nalgebra::DVector::from_fn(count, |i, _| wave(q * cells.centres()[i]) * sinc(0.5 * q * widths[i]))
    };
    let uniform = match base {
        // u/G per shear against the uniaxial compression.
        Base::Bonded => PI * height / period * (1.0 / (1.0 - nu) - kernel.normal_at_zero()),
        Base::Smooth => -PI * height / period * kernel.normal_at_zero(),
    };
    let mut matrix = DMatrix::repeat(count, count, uniform);
    for k in 1..=modes {
        let q = 2.0 * PI * k as f64 / period;
        let weight = kernel.tangential_less_normal(q * height) / k as f64;
        for wave in [means(q, f64::cos), means(q, f64::sin)] {
            matrix.ger(weight, &wave, &wave, 1.0);
        }
    }
    super::half_plane::scale_columns(matrix, (1.0 - nu) / (PI * material.shear_modulus()), cells.widths())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    const NU: f64 = 0.3;

    fn on(cells: &Cells, height: f64, base: Base, period: f64) -> DMatrix<f64> {
        use super::super::{Extent, Strip};
        let material = Material::new(2.6, NU).unwrap();
        let strip = Strip::new(material, height, base, Extent::Closed(period)).unwrap();
        strip.try_compliance(cells).unwrap().normal + layer_difference(cells, material, height, base, period)
    }

    #[test]
    fn a_thin_bonded_layer_shears_by_its_height_over_its_modulus() {
        let cells = Cells::graded(1.0, 33).unwrap();
        let displacement = on(&cells, 0.02, Base::Bonded, 5.0) * DVector::repeat(33, 1.0);
        assert!((displacement[16] / 0.02 - 1.0).abs() < 1e-6, "{}", displacement[16]);
    }

    #[test]
    fn waves_along_a_full_period_move_by_the_kernel() {
        let cells = Cells::uniform(1.0, 64).unwrap();
        let q = 2.0 * PI;
        let wave = DVector::from_vec(cells.means_from_primitive(|x| (q * x).sin() / q));
        let theta = |base: Base, u: f64| match base {
            Base::Bonded => {
                let k = 3.0 - 4.0 * NU;
                (2.0 * k * (2.0 * u).sinh() + 4.0 * u) / (2.0 * k * (2.0 * u).cosh() + 1.0 + k * k + 4.0 * u * u)
            }
            Base::Smooth => ((2.0 * u).cosh() + 1.0) / ((2.0 * u).sinh() + 2.0 * u),
        };
        for base in [Base::Bonded, Base::Smooth] {
            let kernel = 0.7 / q * theta(base, q * 0.1);
            let error = on(&cells, 0.1, base, 2.0) * &wave - &wave * kernel;
            assert!(error.amax() < 4e-3 * kernel, "{base:?}: {:e}", error.amax() / kernel);
        }
    }
}
