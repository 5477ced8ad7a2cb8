//! Elastic bodies as compliances of the contact line.
//!
//! A body is represented by its [`Compliance`], the displacement of every cell of its surface under a unit traction on every
//! cell. Plane strain; displacement *into* the body counts positive; tractions are forces per area, `x` runs along the
//! sliding direction from the -x to the +x edge.
//!
//! Theory: docs/theory.md, section 3.1.

#![forbid(unsafe_code)]

pub mod antisymmetric;
pub mod block;
mod body_error;
mod cells;
pub mod discretization;
mod half_plane;
pub mod kinds;
mod logarithm;
mod material;
mod strip;
mod strip_kernel;
mod strip_shear;
pub mod tangential;
mod winkler;

pub use cells::{Cells, MAXIMUM_CELLS};
pub use half_plane::HalfPlane;
pub use logarithm::mean_logarithm;
pub use material::{Material, OutOfRange};
pub use strip::{Extent, Strip};
pub use strip_kernel::{Base, StripKernel};
pub use winkler::{Rigid, Winkler};

use nalgebra::DMatrix;

/// Compliance of one body's surface under tractions on the N cells of the contact line.
///
/// Both matrices are N x N, row: cell whose mean displacement is given, column: loaded cell, cells from the -x to the +x
/// edge, m/Pa. Displacements are means over a cell under tractions constant on a cell (Galerkin), so that
/// `c_i normal[(i, j)]`, `c_i` the cell widths, is symmetric by the reciprocal theorem, and positive definite on pressures
/// of zero resultant.
#[derive(Clone, Debug)]
pub struct Compliance {
    /// `C`: mean normal displacement into the body per pressure.
    pub normal: DMatrix<f64>,
    /// `S`: mean normal displacement into the body per shear traction that acts on this body in +x.
    ///
    /// Friction acts with `s mu p` on the strip and with `-s mu p` on the punch, `s` the sign of the sliding velocity.
    pub shear: DMatrix<f64>,
}

/// A body with an elastic surface.
pub trait ElasticBody {
    /// Compliance on the given cells.
    fn compliance(&self, cells: &Cells) -> Compliance;
}

/// Fills an N x N matrix from its values on and below the diagonal, with `parity` +1 (symmetric) or -1 (antisymmetric)
/// of the values above it.
fn fill(count: usize, parity: f64, value: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(count, count);
    for j in 0..count {
        for i in j..count {
            let entry = value(i, j);
            matrix[(j, i)] = parity * entry;
            matrix[(i, j)] = entry;
        }
    }
    matrix
}
