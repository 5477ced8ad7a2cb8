//! Tangential displacement of a layer per shear traction, less its normal displacement per pressure.
//!
//! Theory: docs/theory.md, section 3.8.

use super::{Base, Cells, Material, StripKernel};
use nalgebra::DMatrix;
use std::f64::consts::PI;

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
