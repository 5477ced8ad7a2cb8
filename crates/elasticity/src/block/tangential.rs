//! Tangential displacement of the block's contact line by shear.
//!
//! Theory: docs/theory.md, section 3.8.

use super::boundary::{contact_cells, contact_integrals};
use super::{Block, BlockError};
use nalgebra::DMatrix;

impl Block {
    /// Mean displacement along x over cell i per unit shear traction in +x on cell j [m/Pa], N x N; diag(cell widths)
    /// times it is symmetric and positive definite.
    ///
    /// By finite elements alone: for tractions that are smooth along the contact as accurate as
    /// [`Block::strain_energy`], while single entries of cells smaller than their element are not resolved.
    ///
    /// # Errors
    /// Boundaries that do not ascend or do not span the contact.
    pub(crate) fn tangential_by_shear(&self, boundaries: &[f64]) -> Result<DMatrix<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let integrals = contact_integrals(&self.mesh, &cells);
        let n = cells.len();
        let mut displacement = self.cell_loads(&integrals, 0);
        self.solve_in_place(&mut displacement)?;
        let modulus = self.properties.shear_modulus();
        Ok(DMatrix::from_fn(n, n, |i, j| {
            let work: f64 = integrals[i].iter().map(|&(degree, weight)| weight * displacement[(2 * degree, j)]).sum();
            work / ((cells[i].1 - cells[i].0) * modulus)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BlockProperties, Discretization};
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn a_slender_block_bends_and_shears_like_a_beam() {
        let properties = BlockProperties { width: 1.0, height: 12.0, youngs_modulus: 0.91, poissons_ratio: 0.3 };
        let block = Block::new(properties, Discretization::uniform(6, 3)).unwrap();
        let boundaries: Vec<f64> = (0..=16).map(|i| f64::from(i) / 16.0 - 0.5).collect();
        let matrix = block.tangential_by_shear(&boundaries).unwrap();
        assert!((&matrix - matrix.transpose()).amax() < 1e-10 * matrix.amax());
        let sway = (&matrix * DVector::repeat(16, 1.0)).mean();
        // Timoshenko with E* = 1, I = 1/12, G = 0.35, shear factor 5/6; the held end is a little stiffer.
        let beam = 12.0f64.powi(3) * 12.0 / 3.0 + 12.0 / (5.0 / 6.0 * 0.35);
        assert!((sway / beam - 1.0).abs() < 5e-3, "{sway} {beam}");
    }
}
