//! Tangential compliance: displacement of the surfaces of a scene's bodies along the contact.
//!
//! Theory: docs/theory.md, section 3.8.

use super::block::Block;
use super::discretization::{BodyError, BodyReason, compliances_with, punch_block};
use super::kinds::mean_tangential_compliance;
use super::kinds::{tangential_by_shear, tangential_to_far_face};
use super::{Cells, Compliance};
use nalgebra::DMatrix;
use scene::{Body, Scene};

/// Displacement along x of a body's surface under tractions on the N cells: N x N matrices of cell means, rows: cell
/// that moves, columns: loaded cell, m/Pa. Sign: +x, for tractions that act on this body in +x.
#[derive(Clone, Debug)]
pub struct TangentialCompliance {
    /// Per pressure. The transpose of the normal displacement per shear, `c_i T_ij = c_j S_ji`, by Betti's theorem.
    pub by_pressure: DMatrix<f64>,
    /// Per shear traction in +x.
    pub by_shear: DMatrix<f64>,
    /// The same relative to the far face, which holds the body; of a half-plane relative to the points its height below the contact.
    pub to_far_face: DMatrix<f64>,
}

/// Friction force of all faces over the displacement of the faces against each other along the sliding direction by elasticity, under
/// a uniform traction, N/m; infinite for bodies without tangential compliance, which are rigid or Winkler foundations.
pub fn tangential_stiffness(scene: &Scene) -> f64 {
    let compliance =
        mean_tangential_compliance(scene, &scene.punch, true) + mean_tangential_compliance(scene, &scene.strip, false);
    scene.faces * scene.count * scene.contact_area() / compliance
}

/// Tangential compliance of punch and strip on the given cells of a line or periodic contact.
///
/// Per shear: the half-plane's and the periodic half-plane's equals its normal compliance per pressure (so its constant is
/// that of the approach); a Fourier layer's differs from its own normal compliance by the smooth sum over
/// [`super::StripKernel::tangential_less_normal`], without a mean displacement on a smooth base, where it is unconstrained; a
/// block's is computed by finite elements; zero for rigid bodies and Winkler foundations. `contact.shear_coupling` is
/// ignored.
pub fn tangential_compliances(scene: &Scene, cells: &Cells) -> Result<[TangentialCompliance; 2], BodyError> {
    tangential_compliances_with(scene, cells, punch_block(scene, cells, false)?.as_deref())
}

/// [`tangential_compliances`] with the block of [`punch_block`].
pub fn tangential_compliances_with(
    scene: &Scene,
    cells: &Cells,
    block: Option<&Block>,
) -> Result<[TangentialCompliance; 2], BodyError> {
    let coupled = Scene { shear_coupling: true, ..scene.clone() };
    let [punch, strip] = compliances_with(&coupled, cells, block)?;
    let of = |own: &Body, compliance, is_punch| body(scene, cells, own, compliance, is_punch, block);
    Ok([
        of(&scene.punch, punch, true).map_err(|reason| BodyError { body: "punch", reason })?,
        of(&scene.strip, strip, false).map_err(|reason| BodyError { body: "strip", reason })?,
    ])
}

fn body(
    scene: &Scene,
    cells: &Cells,
    body: &Body,
    compliance: Compliance,
    punch: bool,
    block: Option<&Block>,
) -> Result<TangentialCompliance, BodyReason> {
    let (count, widths) = (cells.count(), cells.widths());
    let by_pressure = DMatrix::from_fn(count, count, |i, j| widths[j] * compliance.shear[(j, i)] / widths[i]);
    let by_shear = tangential_by_shear(scene, cells, body, compliance, punch, block)?;
    let to_far_face = tangential_to_far_face(scene, cells, body, by_shear.clone())?;
    Ok(TangentialCompliance { by_pressure, by_shear, to_far_face })
}
