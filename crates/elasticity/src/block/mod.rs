//! Punch as an elastic block: hp finite elements condensed onto the contact line.
//!
//! Plane strain, x in [-a, a] with a = width/2 along the contact, z from the contact (0) up to the top (height). The
//! sides are free, the top is held (u = 0), the contact carries tractions that are uniform on each of N cells.
//!
//! # Method
//! A pressure that is discontinuous between cells has a displacement with a logarithmic slope at every jump, which
//! polynomials resolve poorly. The field of each cell's pressure is therefore decomposed into that of a half-plane (closed
//! form, see [`half_plane`]) and a remainder that only corrects the sides and the top:
//!
//! ```text
//! u = u_half_plane + v,    div sigma(v) = 0 in the block,
//! sigma(v) n = -sigma(u_half_plane) n on the sides,   v = -u_half_plane at the top,   sigma(v) n = 0 at the contact
//! ```
//!
//! v is smooth away from the four corners, so the error falls exponentially on a mesh that is graded to them, with few
//! unknowns whose number does not depend on N, and no cell boundary has to be an element boundary.
//!
//! Heat conduction ([`thermal`]) uses the same kind of mesh, and [`distortion`] couples the two.
//!
//! # Signs
//! Normal displacement into the body (+z) and pressure (pushing into +z) count positive. A shear traction counts
//! positive in +x on this body. On the punch friction acts in -x for s = +1: its shear compliance enters the gap
//! with -s.
//!
//! Theory: docs/theory.md, section 3.4.

pub(crate) mod boundary;
pub(crate) mod condense;
pub(crate) mod distortion;
pub(crate) mod element;
pub(crate) mod half_plane;
mod lobatto;
pub(crate) mod mechanical;
pub(crate) mod mesh;
pub(crate) mod tangential;
#[cfg(test)]
mod tests;
pub(crate) mod thermal;
pub(crate) mod thermal_factor;

pub use distortion::FunctionsAcross;
pub use mechanical::{Block, BlockProperties, Compliance};
pub use thermal::{ThermalBlock, ThermalProperties};

use condense::FactorizationError;
use lobatto::MAXIMUM_ORDER;
use mesh::{Division, Grid, Mesh};
use std::fmt;

/// Largest height / width: the bending of a more slender block amplifies rounding beyond 1e-4 of S.
pub(crate) const LARGEST_SLENDERNESS: f64 = 20.0;
/// Largest width / height: the mesh grows in proportion to it.
pub(crate) const LARGEST_FLATNESS: f64 = 500.0;

/// Refused input, with its value and its limit.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockError {
    /// A number outside its range.
    OutOfRange {
        /// Name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is accepted, in words.
        limit: &'static str,
    },
    /// Cell boundary `index` is not above its predecessor.
    CellsNotAscending {
        /// Index of the boundary.
        index: usize,
        /// The boundary before it, m.
        before: f64,
        /// Its own value, m.
        value: f64,
    },
    /// The first or last cell boundary is not an end of the contact.
    CellsDoNotSpanContact {
        /// First boundary, m.
        first: f64,
        /// Last boundary, m.
        last: f64,
        /// Half of the contact's width, m.
        half_width: f64,
    },
    /// Temperatures of one mesh were given to a block of another; the numbers of elements.
    DifferentMeshes {
        /// Elements of the mesh of the displacements.
        mechanical: usize,
        /// Elements of the mesh of the temperatures.
        thermal: usize,
    },
    /// The stiffness or conduction matrix of `degrees` unknowns could not be factorised.
    Factorization {
        /// What the matrix is of.
        quantity: &'static str,
        /// Number of unknowns.
        degrees: usize,
        /// Why it could not.
        reason: FactorizationError,
    },
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { name, value, limit } => write!(f, "{name} = {value}, must be {limit}"),
            Self::CellsNotAscending { index, before, value } => {
                write!(f, "cell boundary {index} = {value} m, must be above its predecessor {before} m")
            }
            Self::CellsDoNotSpanContact { first, last, half_width } => write!(
                f,
                "cell boundaries from {first} m to {last} m, must span the contact from {} m to {half_width} m",
                -half_width
            ),
            Self::DifferentMeshes { mechanical, thermal } => write!(
                f,
                "temperatures on a mesh of {thermal} elements, must be on the block's own of {mechanical} elements and the \
                 same shape and orders"
            ),
            Self::Factorization { quantity, degrees, reason } => {
                write!(f, "{quantity} matrix of the block with {degrees} unknowns: {reason}")
            }
        }
    }
}

impl std::error::Error for BlockError {}

/// Finite-element mesh and order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretization {
    /// Polynomial order of the shape functions, 1 to 8 (up to 12 for reference solutions).
    pub order: usize,
    /// Layers of elements that shrink towards the contact's corners, >= 1.
    pub contact_layers: usize,
    /// Layers of elements that shrink towards the corners at the top, >= 1.
    pub top_layers: usize,
    /// Ratio of the sizes of neighbouring layers, in (0, 1).
    pub grading: f64,
    /// Largest element along the contact, m; none is longer than the block is high.
    pub longest: f64,
}

impl Discretization {
    /// Optimal grading of layers and order for the singularities of the corners.
    pub(crate) const CORNER_GRADING: f64 = 0.15;
    /// Optimal grading for the remainder fields of the cells next to the corners, which vary over the distance between cell
    /// and corner: a steeper one needs higher orders, a milder one more layers.
    pub(crate) const CELL_GRADING: f64 = 0.25;
    /// Highest order of `for_cells`.
    pub(crate) const HIGHEST_ORDER: usize = 8;

    /// The same number of layers at all four corners, for smooth loads.
    pub fn uniform(order: usize, layers: usize) -> Self {
        Self {
            order,
            contact_layers: layers,
            top_layers: layers,
            grading: Self::CORNER_GRADING,
            longest: f64::INFINITY,
        }
    }

    /// Order and layers for contact pressures on the cells between `boundaries` to `tolerance`, relative to the mean
    /// pressure, under a flat rigid partner with friction 0.25.
    ///
    /// Measured with 5 to 129 cells, `height` from width/20 to 5/3 `width` and nu <= 0.45: the pressure's error is at
    /// most 1e-3 at order 5 up to 33 cells, beyond 2.7e-5 per cell (2.5 times that at a `height` of 8 `width`, 5 times
    /// near nu = 0.5), and falls by 3.5 with each order. That of C is five times smaller relative to its largest entry.
    /// Order 8, the highest taken, gives about 5e-5.
    ///
    /// Elements span at most half as many cells as their order, which resolves temperature fields that vary from cell to cell
    /// ([`distortion`]): the distortion by cos(q x) exp(-q z) is off by at most 3e-4 of its amplitude at a wavelength of 8 cells, 8e-3
    /// at 4 cells (order 5; 2e-3 at order 6).
    pub fn for_cells(width: f64, height: f64, boundaries: &[f64], tolerance: f64) -> Self {
        let of_fifth = (2.7e-5 * boundaries.windows(2).len() as f64).max(1e-3);
        let order = 5.0 + (of_fifth / tolerance).ln() / 3.5f64.ln();
        let order = (order.ceil() as usize).clamp(3, Self::HIGHEST_ORDER);
        let sizes = boundaries.windows(2).map(|pair| pair[1] - pair[0]);
        let (smallest, largest) = sizes.fold((f64::INFINITY, 0.0_f64), |(least, most), c| (least.min(c), most.max(c)));
        // The elements shrink over this distance from a corner.
        let reach = (0.5 * width).min(height);
        // Smallest element over the smallest cell, 1: beyond order 5 a larger one would be the larger error.
        let finest = if order > 5 { 1.0 / 3.0 } else { 4.0 / 3.0 };
        let ratio = (finest * smallest / reach).clamp(1e-10, 1.0);
        let contact_layers = 1 + (ratio.ln() / Self::CELL_GRADING.ln()).ceil() as usize;
        let top_layers = 1 + order / 2;
        let longest = 0.5 * order as f64 * largest;
        Self { order, contact_layers: contact_layers.max(2), top_layers, grading: Self::CELL_GRADING, longest }
    }

    fn check(&self) -> Result<(), BlockError> {
        if !(1..=MAXIMUM_ORDER).contains(&self.order) {
            return Err(BlockError::OutOfRange { name: "order", value: self.order as f64, limit: "from 1 to 12" });
        }
        for (name, layers) in [("contact_layers", self.contact_layers), ("top_layers", self.top_layers)] {
            if !(1..=20).contains(&layers) {
                return Err(BlockError::OutOfRange { name, value: layers as f64, limit: "from 1 to 20" });
            }
        }
        if !(self.grading > 0.0 && self.grading < 1.0) {
            return Err(BlockError::OutOfRange { name: "grading", value: self.grading, limit: "between 0 and 1" });
        }
        Ok(())
    }

    /// Grids along x in [-width/2, width/2] and z in [0, height].
    fn grids(&self, width: f64, height: f64) -> (Grid, Grid) {
        let Self { order, contact_layers, top_layers, grading, longest } = *self;
        let layers = contact_layers.max(top_layers);
        // Elements much larger than the other dimension would miss the field's decay over that dimension.
        let x = Division { first_layers: layers, last_layers: layers, grading, largest: height.min(longest) };
        let z = Division { first_layers: contact_layers, last_layers: top_layers, grading, largest: width };
        (Grid::graded(-0.5 * width, 0.5 * width, x, order), Grid::graded(0.0, height, z, order))
    }
}

/// Checks that temperatures are given on the mesh of the block.
fn check_same_mesh(mechanical: &Mesh, thermal: &Mesh) -> Result<(), BlockError> {
    if mechanical.x == thermal.x && mechanical.z == thermal.z {
        return Ok(());
    }
    Err(BlockError::DifferentMeshes { mechanical: mechanical.elements(), thermal: thermal.elements() })
}

/// Checks width and height of a block against the limits of the mesh.
fn check_dimensions(width: f64, height: f64) -> Result<(), BlockError> {
    check_positive(&[("width", width), ("height", height)])?;
    let value = height / width;
    if !(1.0 / LARGEST_FLATNESS..=LARGEST_SLENDERNESS).contains(&value) {
        return Err(BlockError::OutOfRange { name: "height / width", value, limit: "from 0.002 to 20" });
    }
    Ok(())
}

fn check_positive(quantities: &[(&'static str, f64)]) -> Result<(), BlockError> {
    for &(name, value) in quantities {
        if !(value > 0.0 && value.is_finite()) {
            return Err(BlockError::OutOfRange { name, value, limit: "positive and finite" });
        }
    }
    Ok(())
}
