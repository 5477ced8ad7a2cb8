//! Elastic bodies of a scene on the cells of its contact line.
//!
//! Theory: docs/theory.md, section 3.1.

use super::block::Block;
pub use super::body_error::{BodyError, BodyReason};
use super::{Cells, Compliance, OutOfRange, kinds};
use scene::{Geometry, Scene};
use std::sync::Arc;

/// Cells of the scene's contact line: graded to the edges, uniform where the contact has none (periodic).
///
/// # Errors
/// A count that is not from 1 to [`super::MAXIMUM_CELLS`], a width that is not positive.
pub fn cells_for(scene: &Scene, count: usize) -> Result<Cells, OutOfRange> {
    match scene.geometry {
        Geometry::Periodic => Cells::uniform(0.5 * scene.width, count),
        Geometry::Line | Geometry::Annular => Cells::graded(0.5 * scene.width, count),
    }
}

/// Radius of every cell over the mean one, r/r_m with r = r_m + x, on an annulus; 1 elsewhere. The cells' sliding
/// velocity is that at the mean radius times this.
pub fn relative_radii(scene: &Scene, cells: &Cells) -> Vec<f64> {
    match scene.geometry {
        Geometry::Annular => cells.centres().iter().map(|x| 1.0 + x / scene.mean_radius).collect(),
        Geometry::Line | Geometry::Periodic => vec![1.0; cells.count()],
    }
}

/// Weights of the load integral, m: `F = depth sum w_i p_i`, the cell widths times r/r_m.
pub fn load_weights(scene: &Scene, cells: &Cells) -> Vec<f64> {
    cells.widths().iter().zip(relative_radii(scene, cells)).map(|(width, radius)| width * radius).collect()
}

/// Compliance of punch and strip on the given cells.
///
/// | body | rigid | winkler | half_plane | elastic |
/// |---|---|---|---|---|
/// | punch | - | k_w, or (lambda + 2G)/height where it is 0 | half-plane | finite-element block, held at the top |
/// | strip | - | the same | half-plane | Fourier layer on its base; closed with its length as period, straight and long otherwise |
///
/// In periodic geometry both bodies are layers of the path's length: the punch bonded to its holder, a half-plane's
/// mean displacement under uniform pressure fixed at `3 width/(pi E*)`, the value it has on a contact with edges.
/// On an annulus the contact line is a radius, along which the strip is straight. The shear compliance is zero on an
/// annulus, where friction acts across the line, and where the scene switches the shear coupling off.
///
/// # Errors
/// Elastic constants or a height outside their range, a block too slender or too flat.
pub fn compliances(scene: &Scene, cells: &Cells) -> Result<[Compliance; 2], BodyError> {
    compliances_with(scene, cells, punch_block(scene, cells, false)?.as_deref())
}

/// Finite elements of the punch, where its compliance or, if it is heated, its distortion is that of a block.
pub fn punch_block(scene: &Scene, cells: &Cells, heated: bool) -> Result<Option<Arc<Block>>, BodyError> {
    punch_block_among(&mut Vec::new(), scene, cells, heated)
}

/// [`punch_block`], which joins those `known`: one of the same punch on the same mesh is not made again.
pub fn punch_block_among(
    known: &mut Vec<Arc<Block>>,
    scene: &Scene,
    cells: &Cells,
    heated: bool,
) -> Result<Option<Arc<Block>>, BodyError> {
    let is_distorted = heated
        && scene.punch.conductivity > 0.0
        && scene.punch.thermal_expansion > 0.0
        && kinds::is_distorted_as_block(scene);
    if !(is_distorted || kinds::is_pressed_as_block(scene)) {
        return Ok(None);
    }
    kinds::block(scene, cells, known).map(Some).map_err(|reason| BodyError { body: "punch", reason })
}

/// [`compliances`] with the block of [`punch_block`].
pub fn compliances_with(scene: &Scene, cells: &Cells, block: Option<&Block>) -> Result<[Compliance; 2], BodyError> {
    let punch = kinds::compliance(scene, cells, &scene.punch, true, block)
        .map_err(|reason| BodyError { body: "punch", reason })?;
    let strip = kinds::compliance(scene, cells, &scene.strip, false, None)
        .map_err(|reason| BodyError { body: "strip", reason })?;
    let mut both = [punch, strip];
    if !scene.shear_coupling || scene.geometry == Geometry::Annular {
        both.iter_mut().for_each(|compliance| compliance.shear.fill(0.0));
    }
    Ok(both)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Base, ElasticBody, Extent, HalfPlane, Material, Rigid, Strip, Winkler};
    use nalgebra::DVector;
    use scene::variables::{STARTS, changed};
    use scene::{Body, Constraint, MechanicalBody, Path};
    use std::f64::consts::PI;

    fn scene(changes: &[(&str, f64)]) -> Scene {
        Scene::new(&changed(&STARTS, changes).unwrap(), None).unwrap()
    }

    /// A line contact of width 60 mm on a straight path; both bodies of one kind (rigid 1 to elastic 4).
    fn line(kind: f64) -> Scene {
        scene(&[
            ("contact.geometry", 1.0),
            ("strip.path", 1.0),
            ("strip.length", 0.0),
            ("punch.count", 1.0),
            ("punch.width", 0.06),
            ("punch.height", 0.1),
            ("punch.body", kind),
            ("strip.body", kind),
            ("strip.height", 0.08),
            ("solver.fidelity", 1.0),
        ])
    }

    #[test]
    fn every_kind_of_body_is_the_one_meant() {
        for kind in [1.0, 2.0, 3.0, 4.0] {
            let scene = line(kind);
            let cells = cells_for(&scene, 9).unwrap();
            let [punch, strip] = compliances(&scene, &cells).unwrap();
            let material = |body: &Body| Material::new(body.youngs_modulus, body.poissons_ratio).unwrap();
            let [m1, m2] = [material(&scene.punch), material(&scene.strip)];
            let straight = Strip::new(m2, 0.08, Base::Bonded, Extent::Straight).unwrap();
            let expected = match scene.strip.mechanical {
                MechanicalBody::Rigid => Rigid.compliance(&cells),
                MechanicalBody::Winkler => Winkler::new(m2.uniaxial_modulus() / 0.08).unwrap().compliance(&cells),
                MechanicalBody::HalfPlane => HalfPlane { material: m2 }.compliance(&cells),
                _ => straight.compliance(&cells),
            };
            assert_eq!((&strip.normal, &strip.shear), (&expected.normal, &expected.shear), "{kind}");
            let uniform = &punch.normal * DVector::repeat(9, 1.0);
            let mean = cells.integral(uniform.as_slice()) / 0.06;
            // A block with free sides has the mean of uniaxial stress, apart from the constraint of its held top.
            let (exact, tolerance) = match scene.punch.mechanical {
                MechanicalBody::Rigid => (0.0, 0.0),
                MechanicalBody::Winkler => (0.1 / m1.uniaxial_modulus(), 1e-15),
                MechanicalBody::HalfPlane => (3.0 * 0.06 / (PI * m1.plane_strain_modulus()), 1e-12),
                _ => (0.1 / m1.plane_strain_modulus(), 0.05),
            };
            assert!((mean - exact).abs() <= tolerance * exact, "{kind}: {mean:e} {exact:e}");
            assert_eq!(punch.shear.amax() > 0.0, kind > 2.0);
        }
    }

    #[test]
    fn a_given_foundation_stiffness_counts_and_shear_coupling_can_be_switched_off() {
        let mut scene = line(2.0);
        scene.punch.foundation_stiffness = 3e12;
        let cells = cells_for(&scene, 5).unwrap();
        assert_eq!(compliances(&scene, &cells).unwrap()[0].normal[(2, 2)], 1.0 / 3e12);
        let mut scene = line(3.0);
        scene.shear_coupling = false;
        assert!(compliances(&scene, &cells).unwrap().iter().all(|body| body.shear.amax() == 0.0));
    }

    #[test]
    fn closed_paths_have_their_period_and_annuli_a_straight_radius() {
        let mut scene = line(4.0);
        let cells = cells_for(&scene, 17).unwrap();
        let straight = compliances(&scene, &cells).unwrap();
        (scene.path, scene.length) = (Path::Closed, 0.1);
        let closed = compliances(&scene, &cells).unwrap();
        assert!((&closed[1].normal - &straight[1].normal).amax() > 1e-3 * straight[1].normal.amax());
        (scene.geometry, scene.mean_radius) = (Geometry::Annular, 0.1);
        let annular = compliances(&scene, &cells).unwrap();
        assert_eq!(annular[1].normal, straight[1].normal);
        assert!(annular.iter().all(|body| body.shear.amax() == 0.0));
        let weights = load_weights(&scene, &cells);
        // Half the ring's area over the mean circumference: the width, because r_m is in the middle.
        assert!((weights.iter().sum::<f64>() - 0.06).abs() < 1e-16);
        assert!((weights[16] / cells.widths()[16] - (1.0 + cells.centres()[16] / 0.1)).abs() < 1e-15);
    }

    #[test]
    fn periodic_bodies_answer_waves_with_their_kernels() {
        let mut scene = line(3.0);
        (scene.geometry, scene.path, scene.length) = (Geometry::Periodic, Path::Closed, 0.06);
        scene.constraint = Constraint::Translate;
        let cells = cells_for(&scene, 64).unwrap();
        let q = 2.0 * PI / 0.06;
        let wave = DVector::from_vec(cells.means_from_primitive(|x| (q * x).sin() / q));
        let sine = DVector::from_vec(cells.means_from_primitive(|x| -(q * x).cos() / q));
        let e = scene.strip.youngs_modulus / (1.0 - scene.strip.poissons_ratio.powi(2));
        let [punch, strip] = compliances(&scene, &cells).unwrap();
        // Cell means reduce a wave by a factor of sinc^2 of half a cell.
        let sinc = (PI / 64.0).sin() / (PI / 64.0);
        let answer = &strip.normal * &wave;
        assert!((&answer - &wave * (2.0 / (e * q))).amax() < (1.0 - sinc.powi(2)) * 2.1 / (e * q), "{answer}");
        let uniform = &punch.normal * DVector::repeat(64, 1.0);
        let exact = 3.0 * 0.06 / (PI * scene.punch.youngs_modulus / (1.0 - scene.punch.poissons_ratio.powi(2)));
        assert!(uniform.iter().all(|u| (u / exact - 1.0).abs() < 1e-9), "{uniform} {exact}");
        // Shear: (1-2nu)/(2Gq) sin q x under cos q x.
        let nu = scene.strip.poissons_ratio;
        let g = 0.5 * scene.strip.youngs_modulus / (1.0 + nu);
        let by_shear = &strip.shear * &wave - &sine * (0.5 * (1.0 - 2.0 * nu) / (g * q));
        assert!(by_shear.amax() < 2e-3 * (1.0 - 2.0 * nu) / (g * q), "{by_shear}");
        // Elastic layers: the longest wave is stiffer than the half-plane's by the kernel.
        (scene.punch.mechanical, scene.strip.mechanical) = (MechanicalBody::Elastic, MechanicalBody::Elastic);
        scene.strip.height = 0.01;
        let [_, layer] = compliances(&scene, &cells).unwrap();
        let expected = super::super::StripKernel::new(Base::Bonded, nu).normal(q * 0.01);
        let difference = &layer.normal * &wave - &wave * (2.0 * expected / (e * q));
        assert!(difference.amax() < 1e-3 * answer.amax(), "{:e} {:e}", difference.amax(), answer.amax());
    }

    #[test]
    fn refusals_name_the_body() {
        let mut scene = line(4.0);
        scene.punch.height = 10.0;
        let cells = cells_for(&scene, 5).unwrap();
        let message = compliances(&scene, &cells).unwrap_err().to_string();
        assert!(message.starts_with("punch.height = 10 m and punch.width = 0.06 m: "), "{message}");
        (scene.punch.height, scene.strip.poissons_ratio) = (0.1, 0.5);
        let message = compliances(&scene, &cells).unwrap_err().to_string();
        assert_eq!(message, "strip: Poisson's ratio = 0.5 is out of range: must be from 0 to below 0.5");
    }

    #[test]
    fn a_body_too_flat_or_too_slender_is_refused_by_the_variables_of_the_scene() {
        for (name, height, said) in [
            (
                "punch.height",
                1.21,
                "punch.height = 1.21 m and punch.width = 0.06 m: punch.height / punch.width = 20.1667 must be at least 0.002 \
                 and at most 20",
            ),
            (
                "punch.height",
                1e-4,
                "punch.height = 0.0001 m and punch.width = 0.06 m: punch.height / punch.width = 0.00166667 must be at least \
                 0.002 and at most 20",
            ),
            (
                "strip.height",
                2e-6,
                "strip.height = 2e-6 m and punch.width = 0.06 m: strip.height / punch.width = 0.0000333333 must be at least \
                 0.00005",
            ),
        ] {
            let mut scene = line(4.0);
            let body = if name == "punch.height" { &mut scene.punch } else { &mut scene.strip };
            body.height = height;
            let cells = cells_for(&scene, 9).unwrap();
            assert_eq!(compliances(&scene, &cells).unwrap_err().to_string(), said);
            let body = if name == "punch.height" { &mut scene.punch } else { &mut scene.strip };
            body.mechanical = MechanicalBody::Winkler;
            assert!(compliances(&scene, &cells).is_ok(), "{name}: only an elastic body has these limits");
        }
    }
}
