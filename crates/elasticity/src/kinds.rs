//! Response of each kind of elastic body of a scene: to tractions on cells, to a uniform pressure, to a wave of pressure.
//!
//! The only place that distinguishes the kinds. A new one is an implementation of [`ElasticBody`] and a line in each function.
//!
//! Theory: docs/theory.md, section 3.

use crate::block::{Block, BlockProperties, Discretization, LARGEST_FLATNESS, LARGEST_SLENDERNESS};
use crate::body_error::BodyReason;
use crate::half_plane::scale_columns;
use crate::strip::FLATTEST;
use crate::strip_shear::layer_difference;
use crate::{
    Base, Cells, Compliance, ElasticBody, Extent, HalfPlane, Material, OutOfRange, Rigid, Strip, StripKernel, Winkler,
    antisymmetric,
};
use nalgebra::DMatrix;
use scene::{Body, Geometry, MechanicalBody, Path, Scene};
use std::f64::consts::PI;

/// Tolerance of a block's pressure where the tolerance of the scene, which concerns wear, temperature and friction force, is
/// loose.
const PRESSURE_TOLERANCE: f64 = 1e-3;

/// Compliance of a body on the cells; see [`crate::discretization::compliances`].
pub(crate) fn compliance(scene: &Scene, cells: &Cells, body: &Body, punch: bool) -> Result<Compliance, BodyReason> {
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
            let compliance = block(scene, cells, body)?.compliance(cells.edges())?;
            Compliance { normal: compliance.normal, shear: compliance.shear }
        }
    };
    Ok(compliance)
}

/// Checks the height of an elastic body over the width of the contact: by the variables of the scene, before a method that knows
/// only the body refuses it.
fn check_proportions(scene: &Scene, body: &Body, punch: bool) -> Result<(), BodyReason> {
    let is_block = punch && scene.geometry != Geometry::Periodic;
    let (least, largest) =
        if is_block { (1.0 / LARGEST_FLATNESS, LARGEST_SLENDERNESS) } else { (1.0 / FLATTEST, f64::INFINITY) };
    let (height, width) = (body.height, scene.width);
    if (least * width..=largest * width).contains(&height) {
        return Ok(());
    }
    Err(BodyReason::Proportions { height, width, least, largest })
}

/// The finite-element block of the punch.
fn block(scene: &Scene, cells: &Cells, body: &Body) -> Result<Block, BodyReason> {
    let properties = BlockProperties {
        width: scene.width,
        height: body.height,
        youngs_modulus: body.youngs_modulus,
        poissons_ratio: body.poissons_ratio,
    };
    let tolerance = scene.tolerance.min(PRESSURE_TOLERANCE);
    let discretization = Discretization::for_cells(scene.width, body.height, cells.edges(), tolerance);
    Ok(Block::new(properties, discretization)?)
}

/// Half-plane under tractions of the given period: a layer so high that its base has no effect, less the layer's own uniform
/// compression.
fn periodic_half_plane(material: Material, period: f64, cells: &Cells) -> Result<Compliance, OutOfRange> {
    // exp(-2 q h) of the longest wave is below 1e-16 from q h = 19.
    let height = 4.0 * period;
    let mut compliance = Strip::new(material, height, Base::Smooth, Extent::Closed(period))?.try_compliance(cells)?;
    let uniform = (3.0 * period / PI - height) / (period * material.plane_strain_modulus());
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
) -> Result<DMatrix<f64>, BodyReason> {
    let count = cells.count();
    let periodic = scene.geometry == Geometry::Periodic;
    Ok(match body.mechanical {
        MechanicalBody::Rigid | MechanicalBody::Winkler => DMatrix::zeros(count, count),
        MechanicalBody::HalfPlane => compliance.normal,
        MechanicalBody::Elastic if punch && !periodic => {
            block(scene, cells, body)?.tangential_by_shear(cells.edges())?
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

/// Mean normal displacement per uniform pressure over the contact width, m/Pa, and mean displacement out of the body per
/// kelvin of uniform temperature, m/K.
///
/// Winkler: 1/k_w, by default h/(lambda + 2G). Elastic block (sides free): h (1 - nu^2)/E. Elastic layer (`wide`: much
/// longer than the contact): between h/(lambda + 2G) for thin layers and the half-plane for thick ones: the smaller
/// compliance of both limits. Half-plane: the approach is defined up to a constant; with the logarithm scaled with the
/// contact width the mean over a uniform pressure p on the width W is 3 p W/(pi E*). Expansion: alpha (1 + nu) h for a block
/// free at its sides, alpha (1 + nu)/(1 - nu) h for a layer.
pub fn mean_compliance(body: &Body, width: f64, wide: bool) -> (f64, f64) {
    let (e, nu, h) = (body.youngs_modulus, body.poissons_ratio, body.height);
    let plane = e / (1.0 - nu * nu);
    let half_plane = 3.0 * width / (PI * plane);
    let expansion = body.thermal_expansion * (1.0 + nu) * h / if wide { 1.0 - nu } else { 1.0 };
    let compliance = match body.mechanical {
        MechanicalBody::Rigid => 0.0,
        MechanicalBody::Winkler if body.foundation_stiffness > 0.0 => 1.0 / body.foundation_stiffness,
        MechanicalBody::Winkler => confined(body),
        MechanicalBody::HalfPlane => half_plane,
        MechanicalBody::Elastic if wide => confined(body).min(half_plane),
        MechanicalBody::Elastic => h / plane,
    };
    (compliance, expansion)
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

/// q h beyond which a layer is a half-plane to rounding.
const DEEP: f64 = 20.0;

/// Amplitude of the normal displacement per amplitude of a wave of pressure of the wave number `wave` (1/m), m/Pa.
pub fn wave_compliance(body: &Body, far: FarFace, wave: f64) -> f64 {
    let (nu, u) = (body.poissons_ratio, wave * body.height);
    let half_plane = 2.0 * (1.0 - nu * nu) / (body.youngs_modulus * wave);
    match body.mechanical {
        MechanicalBody::Rigid => 0.0,
        MechanicalBody::Winkler if body.foundation_stiffness > 0.0 => body.foundation_stiffness.recip(),
        MechanicalBody::Winkler => confined(body),
        MechanicalBody::HalfPlane => half_plane,
        MechanicalBody::Elastic if u > DEEP => half_plane,
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
