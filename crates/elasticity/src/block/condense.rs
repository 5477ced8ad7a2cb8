//! Assembly of the condensed element matrices into a sparse symmetric matrix, and its Cholesky factor.
//!
//! The pattern depends on the mesh alone: a [`Pattern`] is built once, with the symbolic factorisation, and serves every
//! matrix on that mesh. Columns follow the mesh's nested-dissection numbers, so no further ordering is needed.
//!
//! Theory: docs/theory.md, section 3.4.

use super::element::CondensedElement;
use super::mesh::{ENTITIES_PER_ELEMENT, Mesh};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Mat, MatMut, Par, Side};
use nalgebra::DMatrix;
use numerics::factorization;
use std::fmt;

/// Reason why a factorisation failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorizationError {
    /// The matrix is not positive definite.
    NotPositiveDefinite,
    /// The factor does not fit into memory.
    OutOfMemory,
}

impl fmt::Display for FactorizationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotPositiveDefinite => "not positive definite",
            Self::OutOfMemory => "its factor does not fit into memory",
        })
    }
}

/// Sparsity pattern of the free skeleton and its symbolic factorisation.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// Components per scalar degree of freedom: 2 for displacements, 1 for temperature.
    components: usize,
    symbolic_matrix: SymbolicSparseColMat<usize>,
    symbolic_factor: SymbolicCholesky<usize>,
    /// For each free entity: the entities in its columns (ascending, itself last) and the first row entry of each.
    neighbours: Vec<Vec<(usize, usize)>>,
}

impl Pattern {
    /// The pattern of the free entities of `mesh`.
    pub(crate) fn new(mesh: &Mesh, components: usize) -> Result<Self, FactorizationError> {
        let mut neighbours: Vec<Vec<(usize, usize)>> = vec![Vec::new(); mesh.free_entities];
        for element in 0..mesh.elements() {
            let (column, row) = mesh.column_and_row(element);
            let entities = mesh.element_entities(column, row);
            for later in entities.into_iter().filter(|&entity| entity < mesh.free_entities) {
                neighbours[later].extend(entities.iter().filter(|&&entity| entity <= later).map(|&entity| (entity, 0)));
            }
        }
        let degrees = components * mesh.free;
        let mut column_starts = Vec::with_capacity(degrees + 1);
        column_starts.push(0);
        let mut rows = Vec::new();
        for (entity, list) in neighbours.iter_mut().enumerate() {
            list.sort_unstable();
            list.dedup();
            let mut offset = 0;
            for (neighbour, first_entry) in list.iter_mut() {
                *first_entry = offset;
                offset += components * mesh.entities[*neighbour].count;
            }
            let own = mesh.entities[entity];
            for degree in components * own.first..components * (own.first + own.count) {
                for &(neighbour, _) in list.iter() {
                    let other = mesh.entities[neighbour];
                    let end = (components * (other.first + other.count)).min(degree + 1);
                    rows.extend(components * other.first..end);
                }
                column_starts.push(rows.len());
            }
        }
        let symbolic_matrix = SymbolicSparseColMat::new_checked(degrees, degrees, column_starts, None, rows);
        let symbolic_factor = factorize_symbolic_cholesky(
            symbolic_matrix.as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            // Columns of an element's edges are eliminated together, however few there are.
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|_| FactorizationError::OutOfMemory)?;
        Ok(Self { components, symbolic_matrix, symbolic_factor, neighbours })
    }

    /// Number of free degrees of freedom, components counted.
    pub(crate) fn degrees(&self) -> usize {
        self.symbolic_matrix.ncols()
    }

    /// Allocates a factor.
    pub(crate) fn empty_factor(&self) -> Factor {
        Factor { values: vec![0.0; self.symbolic_factor.len_val()] }
    }

    /// Workspace for factorising, and for solving with up to `columns` loads together.
    pub(crate) fn workspace(&self, columns: usize) -> Result<Workspace, FactorizationError> {
        let factorizing = self.symbolic_factor.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solving = self.symbolic_factor.solve_in_place_scratch::<f64>(columns, Par::Seq);
        let stack = MemBuffer::try_new(factorizing.or(solving)).map_err(|_| FactorizationError::OutOfMemory)?;
        Ok(Workspace { values: vec![0.0; self.symbolic_matrix.col_ptr()[self.degrees()]], stack })
    }

    /// Sums the element matrices and factorises, into a factor of this pattern. `kind[element]` is the index of its matrix in
    /// `elements`; `boundary` holds further (element, skeleton matrix) contributions. No allocation (except buffers of the matrix
    /// product per thread when it first runs there).
    ///
    /// # Errors
    /// The sum is not positive definite; then the content of the factor is undefined.
    pub(crate) fn factorize_into(
        &self,
        factor: &mut Factor,
        mesh: &Mesh,
        elements: &[CondensedElement],
        kind: &[usize],
        boundary: &[(usize, DMatrix<f64>)],
        workspace: &mut Workspace,
    ) -> Result<(), FactorizationError> {
        let column_starts = self.symbolic_matrix.col_ptr();
        let Workspace { values, stack } = workspace;
        values.fill(0.0);
        let bulk = kind.iter().enumerate().map(|(element, &kind)| (element, &elements[kind].skeleton));
        for (element, matrix) in bulk.chain(boundary.iter().map(|(element, matrix)| (*element, matrix))) {
            let (column, row) = mesh.column_and_row(element);
            self.scatter(mesh, mesh.element_entities(column, row), matrix, column_starts, values);
        }
        factorization::check(values, values.len()).map_err(|_| FactorizationError::NotPositiveDefinite)?;
        let matrix = SparseColMatRef::new(self.symbolic_matrix.as_ref(), values);
        self.symbolic_factor
            .factorize_numeric_llt(
                &mut factor.values,
                matrix,
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(stack),
                Default::default(),
            )
            .map_err(|_| FactorizationError::NotPositiveDefinite)?;
        Ok(())
    }

    fn scatter(
        &self,
        mesh: &Mesh,
        entities: [usize; ENTITIES_PER_ELEMENT],
        matrix: &DMatrix<f64>,
        column_starts: &[usize],
        values: &mut [f64],
    ) {
        let mut starts = [0; ENTITIES_PER_ELEMENT + 1];
        for (i, &entity) in entities.iter().enumerate() {
            starts[i + 1] = starts[i] + self.components * mesh.entities[entity].count;
        }
        for (j, &later) in entities.iter().enumerate() {
            if later >= mesh.free_entities {
                continue;
            }
            let first_column = self.components * mesh.entities[later].first;
            for (i, &earlier) in entities.iter().enumerate() {
                let list = &self.neighbours[later];
                let Ok(found) = list.binary_search_by_key(&earlier, |&(entity, _)| entity) else { continue };
                for local_column in 0..starts[j + 1] - starts[j] {
                    let start = column_starts[first_column + local_column] + list[found].1;
                    let rows = if earlier == later { local_column + 1 } else { starts[i + 1] - starts[i] };
                    let source = matrix.column(starts[j] + local_column);
                    for (local_row, value) in values[start..start + rows].iter_mut().enumerate() {
                        *value += source[starts[i] + local_row];
                    }
                }
            }
        }
    }

    /// Moves the values of the held degrees of freedom to the right-hand side.
    pub(crate) fn subtract_held(
        &self,
        mesh: &Mesh,
        elements: &[CondensedElement],
        kind: &[usize],
        loads: &mut Mat<f64>,
        held: &Mat<f64>,
    ) {
        let row = mesh.z.intervals() - 1;
        let free = self.components * mesh.free;
        for column in 0..mesh.x.intervals() {
            let matrix = &elements[kind[column * mesh.z.intervals() + row]].skeleton;
            let expand = |degree: usize| self.components * degree..self.components * (degree + 1);
            let degrees: Vec<usize> = mesh.element_degrees(column, row).into_iter().flat_map(expand).collect();
            for j in 0..loads.ncols() {
                for (b, &known) in degrees.iter().enumerate().filter(|&(_, &degree)| degree >= free) {
                    let value = held[(known - free, j)];
                    for (a, &unknown) in degrees.iter().enumerate().filter(|&(_, &degree)| degree < free) {
                        loads[(unknown, j)] -= matrix[(a, b)] * value;
                    }
                }
            }
        }
    }

    /// Overwrites the columns of `loads` (free degrees of freedom) with the solutions: at most as many as the workspace has. Allocates
    /// as little as [`Self::factorize_into`].
    pub(crate) fn solve_in_workspace(&self, factor: &Factor, loads: MatMut<'_, f64>, workspace: &mut Workspace) {
        LltRef::new(&self.symbolic_factor, &factor.values).solve_in_place_with_conj(
            Conj::No,
            loads,
            Par::Seq,
            MemStack::new(&mut workspace.stack),
        );
    }
}

/// Workspace of factorisation and solution on a [`Pattern`].
pub(crate) struct Workspace {
    values: Vec<f64>,
    stack: MemBuffer,
}

impl fmt::Debug for Workspace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Workspace").field("bytes", &(8 * self.values.len() + self.stack.len())).finish()
    }
}

/// Values of a Cholesky factor on a [`Pattern`].
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    values: Vec<f64>,
}
