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

/// Displacement along x of the surface relative to the points at the depth `h` below it, per shear traction in +x, m/Pa:
///
/// ```text
/// u(x) = (1-nu)/(pi G) integral q(s) [ln(r/|x - s|) + h^2/(2 (1-nu) r^2)] ds,    r^2 = (x - s)^2 + h^2
/// ```
///
/// A half-plane has no displacement by itself: this is the part of it between the contact and that depth. Uniform traction on a wide
/// contact approaches `(3 - 2 nu) h/(2 G)` per traction.
///
/// Source: K. L. Johnson, Contact Mechanics, section 2.3, the force along the surface.
pub(super) fn tangential_to_depth(
    cells: &Cells,
    material: Material,
    height: f64,
    normal: nalgebra::DMatrix<f64>,
) -> nalgebra::DMatrix<f64> {
    let nu = material.poissons_ratio();
    let width = 2.0 * cells.half_width();
    // ln(r/width) and h^2/r^2 less the logarithm in `normal`.
    let scaled = (height / width).ln();
    let twice = |s: f64| {
        let (below, angle) = below(s, height);
        let logarithm = 0.25 * (s * s - height * height) * below + height * s * angle + (0.5 * scaled - 0.75) * s * s;
        logarithm + (height * s * angle - 0.5 * height * height * below) / (2.0 * (1.0 - nu))
    };
    normal + scale_columns(means(cells, twice), (1.0 - nu) / (PI * material.shear_modulus()), cells.widths())
}

/// The same across the plane, for a contact that slides normal to it: `u = 1/(pi G) integral q(s) ln(r/|x - s|) ds`, mean over the
/// contact of this `width` (m) under uniform traction, per traction, m/Pa.
pub(super) fn mean_across_to_depth(width: f64, material: Material, height: f64) -> f64 {
    let (below, angle) = below(width, height);
    let twice = 0.25 * (width * width - height * height) * below
        + height * width * angle
        + 0.5 * width * width * (height / width).ln();
    2.0 * twice / (PI * material.shear_modulus() * width)
}

/// ln(1 + s^2/h^2) and atan(s/h).
fn below(s: f64, height: f64) -> (f64, f64) {
    let ratio = s / height;
    ((ratio * ratio).ln_1p(), ratio.atan())
}

/// Means over pairs of cells of a function of their distance that is even, by its second antiderivative.
fn means(cells: &Cells, twice: impl Fn(f64) -> f64) -> nalgebra::DMatrix<f64> {
    let (x, c) = (cells.centres(), cells.widths());
    fill(cells.count(), 1.0, |i, j| {
        let (distance, sum, difference) = (x[i] - x[j], 0.5 * (c[i] + c[j]), 0.5 * (c[i] - c[j]));
        let ends = twice(distance + sum) + twice(distance - sum);
        (ends - twice(distance + difference) - twice(distance - difference)) / (c[i] * c[j])
    })
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

    /// The displacement of Johnson's equation 2.19 with its terms of the angle, summed over the sources in 4,000 parts.
    #[test]
    fn the_tangential_displacement_is_that_relative_to_the_depth() {
        let body = half_plane();
        let (e, nu) = (2.6, 0.3_f64);
        let cells = Cells::graded(0.4, 7).unwrap();
        for height in [0.1, 0.8, 9.0] {
            let normal = body.compliance(&cells).normal;
            let matrix = tangential_to_depth(&cells, body.material, height, normal);
            assert!(matrix.iter().all(|entry| *entry > 0.0), "{matrix}");
            let along = |x: f64, z: f64| {
                let (r, angle) = (x.hypot(z), z.atan2(x));
                let (sine, cosine) = angle.sin_cos();
                let first = 2.0 * (1.0 - nu * nu) / (PI * e);
                let second = (1.0 - 2.0 * nu) * (1.0 + nu) / (PI * e);
                let radial = -first * cosine * r.ln() - second * angle * sine;
                let round = first * sine * r.ln() + 2.0 * nu * (1.0 + nu) / (PI * e) * sine - second * angle * cosine
                    + second * sine;
                radial * cosine - round * sine
            };
            let parts = 4000;
            for (cell, x) in [(3, 0.0), (1, cells.centres()[1])] {
                let sources = (0..parts).map(|k| -0.4 + 0.8 * (f64::from(k) + 0.5) / f64::from(parts));
                let sum: f64 = sources.map(|s| along((x - s).abs(), 0.0) - along((x - s).abs(), height)).sum();
                let (point, mean) = (sum * 0.8 / f64::from(parts), (&matrix * DVector::repeat(7, 1.0))[cell]);
                // A cell's mean against its middle.
                assert!((mean / point - 1.0).abs() < 0.02, "{height} {x}: {mean} {point}");
            }
            let uniform = cells.integral((&matrix * DVector::repeat(7, 1.0)).as_slice()) / 0.8;
            let single = Cells::uniform(0.4, 1).unwrap();
            let alone = tangential_to_depth(&single, body.material, height, body.compliance(&single).normal);
            assert!((uniform / alone[(0, 0)] - 1.0).abs() < 1e-9);
        }
        let [shallow, wide] = [1e-3, 1e-3 / body.material.shear_modulus()];
        let single = Cells::uniform(0.4, 1).unwrap();
        let alone = tangential_to_depth(&single, body.material, shallow, body.compliance(&single).normal)[(0, 0)];
        assert!((alone / (wide * (1.5 - nu)) - 1.0).abs() < 0.01);
        assert!((mean_across_to_depth(0.8, body.material, shallow) / wide - 1.0).abs() < 0.01);
    }

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
