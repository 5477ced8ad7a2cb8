//! Elastic half-plane.
//!
//! Theory: docs/theory.md, section 3.2.

use super::{Cells, Compliance, ElasticBody, Material, fill, mean_logarithm};
use std::f64::consts::PI;

/// Elastic half-plane in plane strain.
///
/// ```text
/// u(x) = -(1-nu)/(pi G) integral p(s) ln(|x - s|/(2a)) ds + (1-2nu)/(2G) integral q(s) sign(x - s)/2 ds
/// ```
///
/// for pressure `p` and shear traction `q` (positive in +x), `2a` the width of the contact zone. A half-plane has no
/// absolute displacement: the approach is defined up to a constant per load. Scaling the logarithm with the contact
/// width fixes it so that the compliance is positive definite (the zone's logarithmic capacity is a/2 < 2a), and
/// taking the sign function in place of the step fixes it for shear, where it makes `c_i S_ij` antisymmetric. The
/// shear term equals `(1-2nu)/(2G) integral_{-a}^{x} q ds` less half its value at the +x edge.
///
/// Source: K. L. Johnson, Contact Mechanics, sections 2.3 and 2.5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// Material of the half-plane.
    pub material: Material,
}

impl ElasticBody for HalfPlane {
    fn compliance(&self, cells: &Cells) -> Compliance {
        let (x, c) = (cells.centres(), cells.widths());
        let nu = self.material.poissons_ratio();
        let normal_scale = (1.0 - nu) / (PI * self.material.shear_modulus());
        let shear_scale = (1.0 - 2.0 * nu) / (4.0 * self.material.shear_modulus());
        let log_scale = (2.0 * cells.half_width()).ln();
        let kernel = fill(cells.count(), 1.0, |i, j| mean_logarithm(x[i] - x[j], 0.5 * c[i], 0.5 * c[j]) + log_scale);
        let sign = fill(cells.count(), -1.0, |i, j| if i == j { 0.0 } else { 1.0 });
        Compliance { normal: scale_columns(kernel, normal_scale, c), shear: scale_columns(sign, shear_scale, c) }
    }
}

/// Converts the mean of the kernel over two cells to the displacement under unit traction on the second.
pub(super) fn scale_columns(mut kernel: nalgebra::DMatrix<f64>, scale: f64, widths: &[f64]) -> nalgebra::DMatrix<f64> {
    for (mut column, width) in kernel.column_iter_mut().zip(widths) {
        column *= scale * width;
    }
    kernel
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    fn half_plane() -> HalfPlane {
        HalfPlane { material: Material::new(2.6, 0.3).unwrap() }
    }

    #[test]
    fn uniform_pressure_gives_the_closed_form_mean() {
        // The mean displacement of the whole zone does not depend on the partition: 3/2 + ln(2a) - ln(2a).
        let exact = 0.7 / PI * 1.5 * 2.0 * 0.4;
        for count in [1, 7, 64] {
            let cells = Cells::graded(0.4, count).unwrap();
            let displacement = half_plane().compliance(&cells).normal * DVector::repeat(count, 1.0);
            let mean = cells.integral(displacement.as_slice()) / 0.8;
            assert!((mean - exact).abs() < 1e-13, "{count}: {mean} {exact}");
        }
    }

    #[test]
    fn shear_term_is_the_running_integral_less_half_the_total() {
        let cells = Cells::graded(1.0, 40).unwrap();
        // q = 1 + x: cell means of the traction are exact, the running integral is (1 + x)^2/2, its total 2.
        let traction = DVector::from_iterator(40, cells.centres().iter().map(|x| 1.0 + x));
        let displacement = half_plane().compliance(&cells).shear * traction;
        let exact = cells.means_from_primitive(|x| 0.2 * ((1.0 + x).powi(3) / 6.0 - x));
        for i in 0..40 {
            // Constant traction on a cell leaves c^2/12 of the slope in the mean.
            assert!((displacement[i] - exact[i]).abs() < 0.2 * cells.widths()[i].powi(2), "{i}");
        }
        assert!((displacement[39] - 0.2).abs() < 1e-2 && (displacement[0] + 0.2).abs() < 1e-2);
    }
}
