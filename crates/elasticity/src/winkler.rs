//! Bodies without interaction between cells: the Winkler foundation and the rigid body.
//!
//! Theory: docs/theory.md, section 3.5.

use super::{Cells, Compliance, ElasticBody, OutOfRange};
use nalgebra::DMatrix;

/// Winkler foundation: `u = p/k_w`, no influence of shear. The limit of a strip thin against the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winkler {
    stiffness: f64,
}

impl Winkler {
    /// Foundation of the given stiffness k_w, in Pa/m, positive.
    pub fn new(stiffness: f64) -> Result<Self, OutOfRange> {
        let positive = stiffness.is_finite() && stiffness > 0.0;
        OutOfRange::unless(positive, "foundation stiffness", stiffness, "positive, in Pa/m")?;
        Ok(Self { stiffness })
    }
}

impl ElasticBody for Winkler {
    fn compliance(&self, cells: &Cells) -> Compliance {
        let count = cells.count();
        Compliance {
            normal: DMatrix::from_diagonal_element(count, count, 1.0 / self.stiffness),
            shear: DMatrix::zeros(count, count),
        }
    }
}

/// Rigid body: its surface does not move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rigid;

impl ElasticBody for Rigid {
    fn compliance(&self, cells: &Cells) -> Compliance {
        let count = cells.count();
        Compliance { normal: DMatrix::zeros(count, count), shear: DMatrix::zeros(count, count) }
    }
}
