//! Heat conduction in the punch, reduced from the cells of the contact line to the cells, the cooled surface and the top.
//!
//! The punch is a rectangle of one material: width 2a along x, height h, contact at z = 0, cooled on its sides or, as a
//! closed ring, over its volume. With the heat transfer coefficient H of the cooled surface
//!
//! ```text
//! C dT/dt = k (T_xx + T_zz)
//! -k T_z = q (contact)     -k T_n = H (T - T_ambient) - cooling (sides)
//! -k T_z = H_top (T - T_ambient) - far, or T = far (top)
//! ```
//!
//! Conduction in a rectangle separates, so no mesh is needed: the transverse modes across the width are exact ([`across`]),
//! and each is a one-dimensional problem through the height whose impedance has a closed form ([`depth`]). That problem is
//! projected (Galerkin) on its responses at real rates, a rational Krylov space. The result is symmetric, its states are
//! real and decay, and the steady response is exact because it lies in the space. [`shift_selection`] adds states where the
//! error against the exact impedance is largest. Truncated modes have their exact steady effect as a static correction
//! ([`steady`]) with first-order dynamics ([`quasi_static`]).
//!
//! The finite elements of `elasticity::block::ThermalBlock` discretise the same body; the tests compare the two.
//!
//! On an annulus x runs along the radius, the body is a ring, and the transverse modes are those of the radius ([`radial`]).
//! The mate is then a ring too ([`mate`]), cooled on its face instead of its sides.
//!
//! Theory: docs/theory.md, section 4.6.

mod across;
mod assembly;
mod bands;
mod cylinder;
mod depth;
mod distortion;
mod from_top;
mod galerkin;
pub mod mate;
mod quasi_static;
mod radial;
mod shift_selection;
mod steady;
#[cfg(test)]
mod tests;
mod waves;

use super::reduced::ReducedHeat;
use across::{Across, Sides};
use assembly::Assembly;
use depth::Depth;
use distortion::Distortion;
use elasticity::Cells;
use elasticity::block::{Block, BlockError};
use elasticity::discretization::{BodyError, punch_block};
use scene::{Geometry, Scene};
use shift_selection::{Scale, Selection};

/// Largest number of states. For an error of 1e-4 a steel punch over minutes needs fewer; a heated layer that is
/// thin against the width, as in a brake pad during one stop, needs more, because more transverse modes have dynamics of
/// their own.
pub(crate) const MAXIMUM_STATES: usize = 512;

/// Most transverse modes whose steady fields distort the contact line by the law of the whole body, in all and per cell; those of
/// shorter wavelength, below two thirds of a mean cell, do so as on a half-plane.
const DISTORTING_MODES: usize = 96;
const DISTORTING_MODES_PER_CELL: usize = 3;

/// Number of transverse modes in the steady effects that have no closed sum; the terms beyond fall like 1/m^3.
const SUMMED_MODES: usize = 1000;

/// Order of the ports.
const COOLING: usize = 0;
const AMBIENT: usize = 1;
const FAR: usize = 2;

/// Reduces the punch of `scene` to states that follow its exact response over `duration` (s) to `tolerance`, relative to the
/// temperature rise by a uniform flux over that time. The error is that of the root mean square of the temperature over the
/// contact, for fluxes whose mean square and that of width/(8 pi) times their slope sum to 1. Fluxes that vary faster or more
/// sharply are followed less accurately in time, but exactly in their steady effect. At most [`MAXIMUM_STATES`] states;
/// where they do not suffice, the remaining error exceeds the tolerance and is reported.
///
/// None for an insulator.
///
/// # Errors
/// A block that is too flat or slender, or of a Poisson's ratio out of range, for its thermal distortion.
pub fn reduce(scene: &Scene, cells: &Cells, tolerance: f64, duration: f64) -> Result<Option<ReducedHeat>, BodyError> {
    let block = punch_block(scene, cells, true)?;
    let refused = |error: BlockError| BodyError { body: "punch", reason: error.into() };
    reduce_with_mean(scene, cells, block.as_deref(), [tolerance; 2], duration).map_err(refused)
}

/// [`reduce`] with the finite elements of the punch, and a separate tolerance, the second, for the longest modes, of which the
/// uniform one alone carries the mean temperature of the contact.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_with_mean(
    scene: &Scene,
    cells: &Cells,
    block: Option<&Block>,
    tolerances: [f64; 2],
    duration: f64,
) -> Result<Option<ReducedHeat>, BlockError> {
    let body = &scene.punch;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let cooled_area = scene.punch_cooled_area();
    let depth = Depth::new(body, 1.0);
    let across = Across {
        half_width: cells.half_width(),
        sides: match scene.geometry {
            Geometry::Line => Sides::Free,
            Geometry::Annular => Sides::Radial(scene.mean_radius),
            Geometry::Periodic => Sides::Closed,
        },
        cooled: cooled_area / (body.height * scene.depth * scene.count),
        transfer: if cooled_area > 0.0 { body.convection } else { 0.0 },
        conductivity: depth.conductivity,
    };
    let cooled =
        Cooled { by: By::Sides, length: across.cooled * depth.height, transfer: across.transfer, top_area: 1.0 };
    let distortion = Distortion::new(scene, block);
    project(across, depth, cooled, distortion, cells, &Wanted { tolerances, duration, divides: true }).map(Some)
}

/// Accuracy of a reduction.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Tolerances of every transverse mode and of the longest ones.
    tolerances: [f64; 2],
    /// Duration of interest, s.
    duration: f64,
    /// Cells may be covered in part.
    divides: bool,
}

/// Reduces a body to its states.
fn project(
    across: Across,
    depth: Depth,
    cooled: Cooled,
    mut distortion: Option<Distortion<'_>>,
    cells: &Cells,
    wanted: &Wanted,
) -> Result<ReducedHeat, BlockError> {
    let scale = Scale::new(&across, &depth, wanted.duration, wanted.tolerances);
    let steepest = scale.steepest(&depth);
    if let Some(distortion) = &mut distortion {
        distortion.resolve(steepest);
    }
    let extra = distortion.as_ref().map_or(Vec::new(), Distortion::positions);
    let points = galerkin::points(depth.height, steepest, &extra);
    let shift_selection = Selection::new(&across, &depth, &points, &scale, MAXIMUM_STATES);
    let assembly = Assembly::new(across, depth, cooled, (cells, wanted.divides), (&points, &shift_selection));
    let mut operators = assembly.operators();
    let moved = match &distortion {
        Some(distortion) => assembly.distort(distortion, &mut operators)?,
        None => Vec::new(),
    };
    assembly.store_bands(moved, &mut operators);
    assembly.give_first_order_dynamics(&mut operators);
    let body = ReducedHeat::new(operators);
    Ok(body)
}

/// Surface beside the contact that is cooled by the air.
#[derive(Clone, Copy, Debug)]
struct Cooled {
    by: By,
    /// Area per depth, m.
    length: f64,
    /// Constant heat transfer coefficient, W/(m2 K).
    transfer: f64,
    /// Area of the far face over that of the contact.
    top_area: f64,
}

/// Location of the cooled surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    /// The sides of the body, as in the transverse modes.
    Sides,
    /// The face of the contact, uniformly in the mean over the passing contact.
    Face,
}
