//! Response of each kind of elastic body of a scene: to tractions on cells, to a uniform pressure, to a wave of pressure.
//!
//! The only place that distinguishes the kinds. A new one is an implementation of [`ElasticBody`] and a line in each function.
//!
//! Theory: docs/theory.md, section 3.

use crate::block::{Block, BlockProperties, Discretization, LARGEST_FLATNESS, LARGEST_SLENDERNESS};
use crate::body_error::BodyReason;
use crate::half_plane::{mean_across_to_depth, scale_columns, tangential_to_depth};
use crate::strip::FLATTEST_ELASTIC;
use crate::strip_shear::layer_difference;
use crate::{
    Base, Cells, Compliance, ElasticBody, Extent, HalfPlane, Material, OutOfRange, Rigid, Strip, StripKernel, Winkler,
    antisymmetric,
};
use nalgebra::DMatrix;
use scene::{Body, Geometry, MechanicalBody, Path, Scene};
use std::f64::consts::PI;
use std::sync::Arc;

/// Tolerance of a block's pressure where the tolerance of the scene, which concerns wear, temperature and friction force, is
/// loose.
const PRESSURE_TOLERANCE: f64 = 1e-3;

/// Fewest cells for which the finite elements of a punch are made: lines on 9 and 17 cells, which initialisation compares, share
/// them.
const FEWEST_MESHED: usize = 17;

/// Tolerance of the finite elements for a mean compliance, which then has an error of 1.4e-4, and heights over the width of the
/// contact between which the edges of a block reach each other or its top.
const MEAN_TOLERANCE: f64 = 1e-1;
const MEAN_PROPORTIONS: [f64; 2] = [0.1, 2.0];

/// Compliance of a body on the cells; see [`crate::discretization::compliances`].
/// `block` is that of the punch, if it is one.
pub(crate) fn compliance(
    scene: &Scene,
    cells: &Cells,
    body: &Body,
    punch: bool,
    block: Option<&Block>,
) -> Result<Compliance, BodyReason> {
    if body.mechanical == MechanicalBody::Rigid {
        return Ok(Rigid.compliance(cells));
    }
    if body.mechanical == MechanicalBody::Winkler && body.foundation_stiffness > 0.0 {
        return Ok(Winkler::new(body.foundation_stiffness)?.compliance(cells));
    }
    if body.mechanical == MechanicalBody::Elastic {
        check_proportions(scene, body, punch)?;
    }
    let material = Material::new(body.youngs_modulus, body.poissons_ratio)?;
    let base = if scene.smooth_base && !punch { Base::Smooth } else { Base::Bonded };
    let compliance = match (body.mechanical, scene.geometry) {
        (MechanicalBody::Rigid, _) => Rigid.compliance(cells),
        (MechanicalBody::Winkler, _) => Winkler::new(material.uniaxial_modulus() / body.height)?.compliance(cells),
        (MechanicalBody::HalfPlane, Geometry::Periodic) => periodic_half_plane(material, scene.length, cells)?,
        (MechanicalBody::HalfPlane, _) => HalfPlane { material }.compliance(cells),
        (MechanicalBody::Elastic, Geometry::Periodic) => {
            Strip::new(material, body.height, base, Extent::Closed(scene.length))?.try_compliance(cells)?
        }
        (MechanicalBody::Elastic, geometry) if !punch => {
            let closed = scene.path == Path::Closed && geometry == Geometry::Line;
            let extent = if closed { Extent::Closed(scene.length) } else { Extent::Straight };
            Strip::new(material, body.height, base, extent)?.try_compliance(cells)?
        }
        (MechanicalBody::Elastic, _) => {
            let compliance = block.expect("an elastic punch is a block").compliance(cells.edges())?;
            Compliance { normal: compliance.normal, shear: compliance.shear }
        }
    };
    Ok(compliance)
}

/// Whether the distortion of the heated punch is that of a block: also of a rigid one and of a half-plane, which conduct as blocks of
/// their own height.
pub(crate) fn is_distorted_as_block(scene: &Scene) -> bool {
    scene.geometry != Geometry::Periodic && scene.punch.mechanical != MechanicalBody::Winkler
}

/// Whether the compliance of the punch is that of a block.
pub(crate) fn is_pressed_as_block(scene: &Scene) -> bool {
    scene.geometry != Geometry::Periodic && scene.punch.mechanical == MechanicalBody::Elastic
}

/// Checks the height of an elastic body over the width of the contact: by the variables of the scene, before a method that knows
/// only the body refuses it.
fn check_proportions(scene: &Scene, body: &Body, punch: bool) -> Result<(), BodyReason> {
    let is_block = punch && scene.geometry != Geometry::Periodic;
    let (least, largest) =
        if is_block { (1.0 / LARGEST_FLATNESS, LARGEST_SLENDERNESS) } else { (1.0 / FLATTEST_ELASTIC, f64::INFINITY) };
    let (height, width) = (body.height, scene.width);
    if (least * width..=largest * width).contains(&height) {
        return Ok(());
    }
    Err(BodyReason::Proportions { height, width, least, largest })
}

/// Finite elements of the punch, of the tolerance of the scene: one of those `known`, which it joins.
pub(crate) fn block(scene: &Scene, cells: &Cells, known: &mut Vec<Arc<Block>>) -> Result<Arc<Block>, BodyReason> {
    let is_pressed = is_pressed_as_block(scene);
    if is_pressed {
        check_proportions(scene, &scene.punch, true)?;
    }
    // Without a compliance of its own the punch may have any modulus, on which its distortion does not depend.
    let youngs_modulus = if is_pressed { scene.punch.youngs_modulus } else { 1.0 };
    let body = Body { youngs_modulus, ..scene.punch.clone() };
    let is_coarse = cells.count() < FEWEST_MESHED;
    let finer = is_coarse.then(|| Cells::graded(cells.half_width(), FEWEST_MESHED)).transpose()?;
    let tolerance = scene.tolerance.min(PRESSURE_TOLERANCE);
    let (properties, discretization) = mesh_within(finer.as_ref().unwrap_or(cells), &body, tolerance);
    if let Some(block) = known.iter().find(|block| block.is(properties, discretization)) {
        return Ok(block.clone());
    }
    known.push(Arc::new(Block::new(properties, discretization)?));
    Ok(known[known.len() - 1].clone())
}

fn block_within(cells: &Cells, body: &Body, tolerance: f64) -> Result<Block, BodyReason> {
    let (properties, discretization) = mesh_within(cells, body, tolerance);
    Ok(Block::new(properties, discretization)?)
}

fn mesh_within(cells: &Cells, body: &Body, tolerance: f64) -> (BlockProperties, Discretization) {
    let properties = BlockProperties {
        width: 2.0 * cells.half_width(),
        height: body.height,
        youngs_modulus: body.youngs_modulus,
        poissons_ratio: body.poissons_ratio,
    };
    (properties, Discretization::for_cells(properties.width, body.height, cells.edges(), tolerance))
}

/// Half-plane under tractions of the given period: a layer so high that its base has no effect, less the layer's own uniform
/// compression.
fn periodic_half_plane(material: Material, period: f64, cells: &Cells) -> Result<Compliance, OutOfRange> {
    // exp(-2 q h) of the longest wave is below 1e-16 from q h = 19.
    let height = 4.0 * period;
    let mut compliance = Strip::new(material, height, Base::Smooth, Extent::Closed(period))?.try_compliance(cells)?;
    let uniform = 3.0 / (PI * material.plane_strain_modulus()) - height / (period * material.uniaxial_modulus());
    let count = cells.count();
    compliance.normal += scale_columns(DMatrix::repeat(count, count, uniform), 1.0, cells.widths());
    Ok(compliance)
}

/// Displacement along x per shear traction in +x on the cells, m/Pa, of a body with this normal compliance; see
/// [`crate::tangential::tangential_compliances`].
pub(crate) fn tangential_by_shear(
    scene: &Scene,
    cells: &Cells,
    body: &Body,
    compliance: Compliance,
    punch: bool,
    block: Option<&Block>,
) -> Result<DMatrix<f64>, BodyReason> {
    let count = cells.count();
    let periodic = scene.geometry == Geometry::Periodic;
    Ok(match body.mechanical {
        MechanicalBody::Rigid | MechanicalBody::Winkler => DMatrix::zeros(count, count),
        MechanicalBody::HalfPlane => compliance.normal,
        MechanicalBody::Elastic if punch && !periodic => {
            block.expect("an elastic punch is a block").tangential_by_shear(cells.edges())?
        }
        MechanicalBody::Elastic => {
            let base = if scene.smooth_base && !punch { Base::Smooth } else { Base::Bonded };
            let closed = periodic || scene.path == Path::Closed;
            // A straight strip as long as its displacement by pressure needs, see `Strip`.
            let period = if closed { scene.length } else { scene.width + 40.0 * body.height };
            let material = Material::new(body.youngs_modulus, body.poissons_ratio)?;
            compliance.normal + layer_difference(cells, material, body.height, base, period)
        }
    })
}

/// The same relative to the top of the punch or the base of the strip, which hold the body; of a half-plane relative to the points its
/// height below the contact. `by_shear` is that of [`tangential_by_shear`].
pub(crate) fn tangential_to_far_face(
    scene: &Scene,
    cells: &Cells,
    body: &Body,
    by_shear: DMatrix<f64>,
) -> Result<DMatrix<f64>, BodyReason> {
    if body.mechanical != MechanicalBody::HalfPlane {
        return Ok(by_shear);
    }
    let material = Material::new(body.youngs_modulus, body.poissons_ratio)?;
    if scene.geometry != Geometry::Periodic {
        return Ok(tangential_to_depth(cells, material, body.height, by_shear));
    }
    // Waves decay within the height of a path; its mean is simple shear.
    let uniform =
        body.height / (scene.length * material.shear_modulus()) - 3.0 / (PI * material.plane_strain_modulus());
    let count = cells.count();
    Ok(by_shear + scale_columns(DMatrix::repeat(count, count, uniform), 1.0, cells.widths()))
}

/// Mean displacement along the sliding direction per uniform shear traction over the contact, relative to the far face, m/Pa: that of
/// [`crate::tangential::TangentialCompliance::to_far_face`] on a single cell; on an annulus, where sliding is normal to the contact
/// line, that of out-of-plane shear. Blocks and layers flatter than their finite elements or waves allow shear by h/G but for their
/// edges, blocks more slender than [`LARGEST_SLENDERNESS`] bend like beams.
pub(crate) fn mean_tangential_compliance(scene: &Scene, body: &Body, punch: bool) -> f64 {
    let modulus = body.youngs_modulus / (2.0 * (1.0 + body.poissons_ratio));
    let material = Material::new(body.youngs_modulus, body.poissons_ratio);
    let (simple, periodic) = (body.height / modulus, scene.geometry == Geometry::Periodic);
    let (MechanicalBody::HalfPlane | MechanicalBody::Elastic, Ok(material)) = (body.mechanical, material) else {
        return 0.0;
    };
    if scene.geometry == Geometry::Annular {
        return match (body.mechanical, punch) {
            (MechanicalBody::HalfPlane, _) => mean_across_to_depth(scene.width, material, body.height),
            (_, true) => simple,
            (_, false) => across_layer(scene.width, body.height) / modulus,
        };
    }
    let is_block = punch && !periodic && body.mechanical == MechanicalBody::Elastic;
    let [least, largest] = match body.mechanical {
        MechanicalBody::Elastic if is_block => [MEAN_PROPORTIONS[0], LARGEST_SLENDERNESS],
        MechanicalBody::Elastic => [1.0 / FLATTEST_ELASTIC, f64::INFINITY],
        _ => [0.0, f64::INFINITY],
    };
    let height = body.height.clamp(least * scene.width, largest * scene.width);
    let resolved = Body { height, ..body.clone() };
    let cell = Cells::uniform(0.5 * scene.width, 1).expect("a scene has a width");
    let on_cell = || -> Result<f64, BodyReason> {
        let block = is_block.then(|| block_within(&cell, &resolved, MEAN_TOLERANCE)).transpose()?;
        let compliance = match is_block {
            // Not asked for by a block.
            true => Compliance { normal: DMatrix::zeros(1, 1), shear: DMatrix::zeros(1, 1) },
            false => compliance(scene, &cell, &resolved, punch, None)?,
        };
        let by_shear = tangential_by_shear(scene, &cell, &resolved, compliance, punch, block.as_ref())?;
        Ok(tangential_to_far_face(scene, &cell, &resolved, by_shear)?[(0, 0)])
    };
    let beside = on_cell().expect("within the proportions");
    if body.height < height {
        let (ratio, sheared) = (body.height / height, height / modulus);
        return sheared * ratio + (beside - sheared) * ratio * ratio;
    }
    // Beam of plane strain, held at its top: bending and shear.
    let beam = |h: f64| 4.0 * plane_strain_compliance(body) * h * (h / scene.width).powi(2) + 1.2 * h / modulus;
    if body.height > height { beside + beam(body.height) - beam(height) } else { beside }
}

/// Parts of the integral of [`across_layer`]; its integrand is smooth.
const ACROSS_PARTS: u32 = 200;

/// Mean displacement out of the plane under a uniform traction over the `width` (m), times the modulus of shear, of a layer held at its
/// base, m: the kernel is `-ln tanh(pi s/(4 h))/pi`.
fn across_layer(width: f64, height: f64) -> f64 {
    // s = width t^3, which leaves no singularity.
    let part = |k: u32| {
        let t = (f64::from(k) + 0.5) / f64::from(ACROSS_PARTS);
        let s = t.powi(3);
        -(1.0 - s) * (PI * width * s / (4.0 * height)).tanh().ln() * 3.0 * t * t
    };
    2.0 * width / PI * (0..ACROSS_PARTS).map(part).sum::<f64>() / f64::from(ACROSS_PARTS)
}

/// Mean normal displacement per uniform pressure over the contact width, m/Pa: the compliance on a single cell, so that the
/// lumped level has that of the contact line.
///
/// A block flatter or more slender than [`MEAN_PROPORTIONS`] differs from one of these proportions by a plate that cannot expand
/// sideways, or by a column under uniaxial stress: beyond, its edges and its held top do not interact.
pub fn mean_compliance(scene: &Scene, body: &Body, punch: bool) -> f64 {
    let is_block = punch && scene.geometry != Geometry::Periodic && body.mechanical == MechanicalBody::Elastic;
    let [least, largest] = if is_block { MEAN_PROPORTIONS } else { [1.0 / FLATTEST_ELASTIC, f64::INFINITY] };
    let height = body.height.clamp(least * scene.width, largest * scene.width);
    let resolved = Body { height, ..body.clone() };
    let cell = Cells::uniform(0.5 * scene.width, 1).expect("a scene has a width");
    let block = is_block.then(|| block_within(&cell, &resolved, MEAN_TOLERANCE).expect("within the proportions"));
    let on_cell = compliance(scene, &cell, &resolved, punch, block.as_ref());
    let resolved = confined(&resolved);
    let beside = on_cell.expect("within the proportions").normal[(0, 0)];
    if body.height < height {
        // A plate, and the edges, whose part falls as the square of the height.
        let ratio = body.height / height;
        return resolved * ratio + (beside - resolved) * ratio * ratio;
    }
    beside + (body.height - height) * plane_strain_compliance(body)
}

/// Mean displacement out of the body per kelvin of uniform temperature, m/K: alpha (1 + nu) h where it is free along the contact (a
/// block, a column, a layer on a smooth base with free ends), alpha (1 + nu)/(1 - nu) h of a layer that is bonded or all round.
pub fn mean_expansion(scene: &Scene, body: &Body, punch: bool) -> f64 {
    let nu = body.poissons_ratio;
    let is_free = match (punch, scene.geometry) {
        (true, Geometry::Periodic) => body.mechanical == MechanicalBody::Winkler,
        (true, _) => true,
        (false, Geometry::Annular) => scene.smooth_base,
        (false, _) => scene.smooth_base && scene.path == Path::Straight,
    };
    let restrained = if is_free { 1.0 } else { 1.0 - nu };
    body.thermal_expansion * (1.0 + nu) * body.height / restrained
}

/// Condition at the far face of a layer under a wave of pressure.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FarFace {
    /// Fixed mechanically, with the thermal condition of the scene.
    Held(Base),
    /// Mid plane of a layer with both faces in contact, symmetric waves.
    Symmetric,
    /// Mid plane, antisymmetric waves: the layer bends, the temperature of its mid plane is constant.
    Antisymmetric,
}

impl FarFace {
    /// Mechanical support of the far face.
    pub fn base(self) -> Base {
        match self {
            FarFace::Held(base) => base,
            FarFace::Symmetric | FarFace::Antisymmetric => Base::Smooth,
        }
    }
}

/// Amplitude of the normal displacement per amplitude of a wave of pressure of the wave number `wave` (1/m), m/Pa.
pub fn wave_compliance(body: &Body, far: FarFace, wave: f64) -> f64 {
    let (nu, u) = (body.poissons_ratio, wave * body.height);
    let half_plane = 2.0 * (1.0 - nu * nu) / (body.youngs_modulus * wave);
    match body.mechanical {
        MechanicalBody::Rigid => 0.0,
        MechanicalBody::Winkler if body.foundation_stiffness > 0.0 => body.foundation_stiffness.recip(),
        MechanicalBody::Winkler => confined(body),
        MechanicalBody::HalfPlane => half_plane,
        // q h beyond which a layer is a half-plane to rounding.
        MechanicalBody::Elastic if u > 20.0 => half_plane,
        MechanicalBody::Elastic if far == FarFace::Antisymmetric => half_plane * antisymmetric::compliance(u),
        MechanicalBody::Elastic => half_plane * StripKernel::new(far.base(), nu).normal(u),
    }
}

/// h/(lambda + 2G): displacement per pressure of a layer that cannot expand sideways, m/Pa.
fn confined(body: &Body) -> f64 {
    let nu = body.poissons_ratio;
    body.height * (1.0 + nu) * (1.0 - 2.0 * nu) / (body.youngs_modulus * (1.0 - nu))
}

/// 1/E*: (1 - nu^2)/E, 1/Pa; 0 where the body is rigid.
pub fn plane_strain_compliance(body: &Body) -> f64 {
    match body.mechanical {
        MechanicalBody::Rigid => 0.0,
        _ => (1.0 - body.poissons_ratio * body.poissons_ratio) / body.youngs_modulus,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::STARTS;

    /// Bodies of the widths and heights of brakes, pins and seals.
    fn scene(geometry: Geometry, punch: f64, strip: f64) -> Scene {
        let mut scene = Scene::new(&STARTS, Some(1e-4)).unwrap();
        (scene.geometry, scene.path, scene.width) = (geometry, Path::Closed, 0.06);
        scene.length = if geometry == Geometry::Periodic { scene.width } else { 0.7 };
        (scene.punch.height, scene.strip.height) = (punch, strip);
        scene.punch.mechanical = MechanicalBody::Elastic;
        scene.strip.mechanical = MechanicalBody::Elastic;
        scene
    }

    /// Mean displacement under uniform pressure on many cells.
    fn on_cells(scene: &Scene, body: &Body, punch: bool) -> f64 {
        let cells = crate::discretization::cells_for(scene, 33).unwrap();
        let block = is_pressed_as_block(scene).then(|| block(scene, &cells, &mut Vec::new()).unwrap());
        let by_pressure = compliance(scene, &cells, body, punch, block.as_deref()).unwrap().normal.column_sum();
        cells.integral(by_pressure.as_slice()) / scene.width
    }

    #[test]
    fn the_mean_compliance_is_that_of_the_contact_line_under_a_uniform_pressure() {
        for geometry in [Geometry::Line, Geometry::Annular, Geometry::Periodic] {
            for (punch, strip) in [(0.1, 0.08), (0.012, 0.0055), (0.06, 0.06), (0.0005, 0.3), (0.5, 1.0), (0.003, 1e-5)]
            {
                for kind in
                    [MechanicalBody::Rigid, MechanicalBody::Winkler, MechanicalBody::HalfPlane, MechanicalBody::Elastic]
                {
                    for smooth in [false, true] {
                        let mut scene = scene(geometry, punch, strip);
                        (scene.punch.mechanical, scene.strip.mechanical, scene.smooth_base) = (kind, kind, smooth);
                        for (body, is_punch) in [(&scene.punch, true), (&scene.strip, false)] {
                            let (lumped, line) =
                                (mean_compliance(&scene, body, is_punch), on_cells(&scene, body, is_punch));
                            assert!(
                                (lumped - line).abs() <= 2e-4 * line,
                                "{geometry:?} {kind:?} {is_punch} {smooth} {punch} {strip}: {lumped:e} {line:e}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// Finite elements on many cells, the sum of waves, simple shear, and the beam.
    #[test]
    fn the_mean_tangential_compliance_is_that_of_the_contact_line_under_a_uniform_traction() {
        for geometry in [Geometry::Line, Geometry::Periodic] {
            for (punch, strip) in [(0.1, 0.08), (0.012, 0.0055), (0.003, 0.0005), (0.5, 1.0)] {
                for kind in [MechanicalBody::Rigid, MechanicalBody::HalfPlane, MechanicalBody::Elastic] {
                    let mut scene = scene(geometry, punch, strip);
                    (scene.punch.mechanical, scene.strip.mechanical) = (kind, kind);
                    let cells = crate::discretization::cells_for(&scene, 33).unwrap();
                    let bodies = crate::tangential::tangential_compliances(&scene, &cells).unwrap();
                    for (own, body, is_punch) in [(&bodies[0], &scene.punch, true), (&bodies[1], &scene.strip, false)] {
                        let line = cells.integral(own.to_far_face.column_sum().as_slice()) / scene.width;
                        let lumped = mean_tangential_compliance(&scene, body, is_punch);
                        assert!(
                            (lumped - line).abs() <= 1e-3 * line,
                            "{geometry:?} {kind:?} {is_punch}: {lumped:e} {line:e}"
                        );
                    }
                }
            }
        }
        // A tall block beyond its finite elements continues as it ends.
        let mean = |height: f64| {
            let scene = scene(Geometry::Line, height, 0.1);
            mean_tangential_compliance(&scene, &scene.punch, true)
        };
        let (inside, beyond) = (mean(0.06 * 19.9), mean(0.06 * 20.1));
        assert!((beyond / inside / (20.1_f64 / 19.9).powi(3) - 1.0).abs() < 1e-3, "{inside:e} {beyond:e}");
        // Out of the plane: a thin layer shears by h, a thick one spreads like ln(4 h/(pi s)).
        assert!((across_layer(1.0, 1e-3) / 1e-3 - 1.0).abs() < 2e-3);
        assert!((across_layer(1.0, 50.0) * PI / ((200.0 / PI).ln() + 1.5) - 1.0).abs() < 1e-3);
    }
}
