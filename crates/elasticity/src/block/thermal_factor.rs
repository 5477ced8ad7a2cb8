//! Factor of K + shift M and solutions with it, also in reusable memory.
//!
//! Theory: docs/theory.md, section 4.8.

use super::BlockError;
use super::condense::{Factor, FactorizationError, Workspace};
use super::element::CondensedElement;
use super::thermal::ThermalBlock;
use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut};
use nalgebra::DMatrix;
use scene::FarBoundary;

/// Factor of K + shift M.
#[derive(Clone, Debug)]
pub struct ThermalFactor {
    elements: Vec<CondensedElement>,
    factor: Factor,
}

impl ThermalFactor {
    /// Element matrices with condensed interiors.
    pub(super) fn elements(&self) -> &[CondensedElement] {
        &self.elements
    }
}

/// Workspace of factorisation, solution and products.
#[derive(Debug)]
pub(crate) struct ThermalWorkspace {
    condensed: Workspace,
    /// K + shift M of one element.
    local: DMatrix<f64>,
    /// Values of all loads on the skeleton of one element.
    skeleton: Vec<f64>,
    /// Largest number of loads together.
    columns: usize,
}

impl ThermalBlock {
    /// Degrees of freedom of an element's skeleton; those beyond the free ones of the mesh are held. The interior ones
    /// follow, with consecutive degrees of freedom.
    fn skeleton(&self, element: usize) -> &[usize] {
        let count = self.skeleton_functions();
        &self.skeletons[element * count..(element + 1) * count]
    }

    /// All elements are of one order.
    fn skeleton_functions(&self) -> usize {
        self.skeletons.len() / self.kind.len()
    }

    /// First and number of the interior degrees of freedom of an element.
    fn interior(&self, element: usize) -> (usize, usize) {
        let interior = self.mesh.interior(element);
        (self.mesh.free + interior.start, interior.len())
    }

    fn failed(&self, reason: FactorizationError) -> BlockError {
        BlockError::Factorization { quantity: "conduction", degrees: self.mesh.free, reason }
    }

    /// Allocates a factor.
    pub(crate) fn empty_factor(&self) -> ThermalFactor {
        let empty = |matrix: &DMatrix<f64>| CondensedElement::empty(matrix.nrows(), self.skeleton_functions());
        ThermalFactor { elements: self.capacity.iter().map(empty).collect(), factor: self.pattern.empty_factor() }
    }

    /// Workspace for factorising, and for solving with up to `columns` loads together.
    pub(crate) fn workspace(&self, columns: usize) -> Result<ThermalWorkspace, BlockError> {
        let functions = self.capacity.first().map_or(0, DMatrix::nrows);
        Ok(ThermalWorkspace {
            condensed: self.pattern.workspace(columns).map_err(|reason| self.failed(reason))?,
            local: DMatrix::zeros(functions, functions),
            skeleton: vec![0.0; self.skeleton_functions() * columns],
            columns,
        })
    }

    /// Factorises K + `shift` M, `shift` [1/s] >= 0.
    ///
    /// # Errors
    /// The matrix is singular: `shift` is 0 and no heat can leave, or it is below rounding.
    pub fn factorize(&self, shift: f64) -> Result<ThermalFactor, BlockError> {
        let mut factor = self.empty_factor();
        self.factorize_into(&mut factor, shift, &mut self.workspace(0)?)?;
        Ok(factor)
    }

    /// [`Self::factorize`] into a factor of this block. No allocation, except buffers of the matrix product per thread when
    /// it first runs there.
    ///
    /// # Errors
    /// As [`Self::factorize`]; then the content of the factor is undefined.
    pub(crate) fn factorize_into(
        &self,
        factor: &mut ThermalFactor,
        shift: f64,
        workspace: &mut ThermalWorkspace,
    ) -> Result<(), BlockError> {
        let properties = &self.properties;
        let leaves = shift > 0.0
            || properties.top == FarBoundary::Held
            || properties.side_convection > 0.0
            || properties.top_convection() > 0.0;
        if !leaves {
            return Err(self.failed(FactorizationError::NotPositiveDefinite));
        }
        for ((condensed, conduction), capacity) in factor.elements.iter_mut().zip(&self.conduction).zip(&self.capacity)
        {
            workspace.local.copy_from(conduction);
            workspace.local.zip_apply(capacity, |entry, capacity| *entry += shift * capacity);
            if !condensed.fill(&workspace.local) {
                return Err(self.failed(FactorizationError::NotPositiveDefinite));
            }
        }
        self.pattern
            .factorize_into(
                &mut factor.factor,
                &self.mesh,
                &factor.elements,
                &self.kind,
                &self.convection,
                &mut workspace.condensed,
            )
            .map_err(|reason| self.failed(reason))
    }

    /// Overwrites the columns of `loads` with the solutions of (K + shift M) T = load.
    pub fn solve_in_place(&self, factor: &ThermalFactor, loads: &mut Mat<f64>) -> Result<(), BlockError> {
        let mut workspace = self.workspace(loads.ncols())?;
        self.solve_in_workspace(factor, loads.as_mut(), &mut workspace);
        Ok(())
    }

    /// [`Self::solve_in_place`] with at most as many columns as the workspace has; allocates as little as
    /// [`Self::factorize_into`].
    pub(crate) fn solve_in_workspace(
        &self,
        factor: &ThermalFactor,
        mut loads: MatMut<'_, f64>,
        workspace: &mut ThermalWorkspace,
    ) {
        let (free, columns) = (self.mesh.free, loads.ncols());
        assert!(columns <= workspace.columns, "{columns} loads in memory for {}", workspace.columns);
        let functions = self.skeleton_functions();
        let values = &mut workspace.skeleton[..functions * columns];
        for (element, &kind) in self.kind.iter().enumerate() {
            let (first, count) = self.interior(element);
            let mut outer = MatMut::from_column_major_slice_mut(values, functions, columns);
            factor.elements[kind].reduce_in_place(loads.rb_mut().subrows_mut(first, count), outer.rb_mut());
            for k in 0..columns {
                for (i, &degree) in self.skeleton(element).iter().enumerate().filter(|&(_, &degree)| degree < free) {
                    loads[(degree, k)] += outer[(i, k)];
                }
            }
        }
        self.pattern.solve_in_workspace(&factor.factor, loads.rb_mut().subrows_mut(0, free), &mut workspace.condensed);
        for (element, &kind) in self.kind.iter().enumerate() {
            let (first, count) = self.interior(element);
            let mut outer = MatMut::from_column_major_slice_mut(values, functions, columns);
            for k in 0..columns {
                for (i, &degree) in self.skeleton(element).iter().enumerate() {
                    outer[(i, k)] = if degree < free { loads[(degree, k)] } else { 0.0 };
                }
            }
            factor.elements[kind].recover_in_place(outer.as_ref(), loads.rb_mut().subrows_mut(first, count));
        }
    }
}
