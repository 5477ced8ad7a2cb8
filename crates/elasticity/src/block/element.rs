//! Matrices of one rectangular element, and the condensation of its interior modes.
//!
//! The shape functions are products N_a(x) N_b(z), so every element matrix is a short sum of Kronecker products of
//! exact one-dimensional matrices. Local order: the skeleton functions entity by entity (see `mesh`), then the interior
//! ones (a, b >= 2); the components of a vector field alternate.
//!
//! Theory: docs/theory.md, section 3.4.

use super::lobatto::ReferenceMatrices;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;
use numerics::factorization;

/// Pairs (a, b) of one-dimensional functions in the local order, and the number of those that belong to the skeleton.
pub(crate) fn local_functions(order_x: usize, order_z: usize) -> (Vec<(usize, usize)>, usize) {
    let mut functions = vec![(0, 0), (1, 0), (0, 1), (1, 1)];
    for b in 0..2 {
        functions.extend((2..=order_x).map(|a| (a, b)));
    }
    for a in 0..2 {
        functions.extend((2..=order_z).map(|b| (a, b)));
    }
    let skeleton = functions.len();
    for a in 2..=order_x {
        functions.extend((2..=order_z).map(|b| (a, b)));
    }
    (functions, skeleton)
}

/// Size and orders of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Extent along x, m.
    pub size_x: f64,
    /// Extent along z, m.
    pub size_z: f64,
    /// Polynomial order along x.
    pub order_x: usize,
    /// Polynomial order along z.
    pub order_z: usize,
}

impl Shape {
    /// Whether the shapes are equal up to a scale and rounding.
    pub(crate) fn similar(&self, other: &Self) -> bool {
        let (ratio, other_ratio) = (self.size_z / self.size_x, other.size_z / other.size_x);
        (self.order_x, self.order_z) == (other.order_x, other.order_z) && (ratio - other_ratio).abs() <= 1e-13 * ratio
    }

    /// Whether the shapes are equal up to rounding.
    pub(crate) fn congruent(&self, other: &Self) -> bool {
        self.similar(other) && (self.size_x - other.size_x).abs() <= 1e-13 * self.size_x
    }
}

/// Stiffness of plane strain per unit depth over the shear modulus, components (u_x, u_z) alternating.
///
/// a(u, v) = int [ (lambda div u) div v + 2 G eps(u) : eps(v) ] dx dz with `lambda_over_shear` = lambda / G. It depends
/// on the ratio of the element's sides only.
pub(crate) fn elastic_stiffness(reference: &ReferenceMatrices, shape: Shape, lambda_over_shear: f64) -> DMatrix<f64> {
    let (functions, _) = local_functions(shape.order_x, shape.order_z);
    let ratio = shape.size_z / shape.size_x;
    let modulus = lambda_over_shear + 2.0;
    let ReferenceMatrices { mass, stiffness, mixed } = reference;
    let n = functions.len();
    let mut matrix = DMatrix::zeros(2 * n, 2 * n);
    for (j, &(c, d)) in functions.iter().enumerate() {
        for (i, &(a, b)) in functions.iter().enumerate() {
            let along = ratio * stiffness[(a, c)] * mass[(b, d)];
            let across = mass[(a, c)] * stiffness[(b, d)] / ratio;
            matrix[(2 * i, 2 * j)] = modulus * along + across;
            matrix[(2 * i + 1, 2 * j + 1)] = along + modulus * across;
            let coupling = lambda_over_shear * mixed[(a, c)] * mixed[(d, b)] + mixed[(c, a)] * mixed[(b, d)];
            matrix[(2 * i, 2 * j + 1)] = coupling;
            matrix[(2 * j + 1, 2 * i)] = coupling;
        }
    }
    matrix
}

/// Heat conduction per unit depth, int k grad T . grad v dx dz [W/(m K)], for the conductivity `conductivity` [W/(m K)].
pub(crate) fn conduction(reference: &ReferenceMatrices, shape: Shape, conductivity: f64) -> DMatrix<f64> {
    let (functions, _) = local_functions(shape.order_x, shape.order_z);
    let ratio = shape.size_z / shape.size_x;
    let ReferenceMatrices { mass, stiffness, .. } = reference;
    DMatrix::from_fn(functions.len(), functions.len(), |i, j| {
        let ((a, b), (c, d)) = (functions[i], functions[j]);
        conductivity * (ratio * stiffness[(a, c)] * mass[(b, d)] + mass[(a, c)] * stiffness[(b, d)] / ratio)
    })
}

/// Heat capacity per unit depth, int rho c T v dx dz [J/(m K)], for the volumetric capacity rho c [J/(m3 K)].
pub(crate) fn capacity(reference: &ReferenceMatrices, shape: Shape, volumetric_heat_capacity: f64) -> DMatrix<f64> {
    let (functions, _) = local_functions(shape.order_x, shape.order_z);
    let scale = 0.25 * shape.size_x * shape.size_z * volumetric_heat_capacity;
    DMatrix::from_fn(functions.len(), functions.len(), |i, j| {
        let ((a, b), (c, d)) = (functions[i], functions[j]);
        scale * reference.mass[(a, c)] * reference.mass[(b, d)]
    })
}

/// int T div v dx dz, m: rows are the displacement functions (components alternating), columns those of T.
pub(crate) fn dilatation(reference: &ReferenceMatrices, shape: Shape) -> DMatrix<f64> {
    let (functions, _) = local_functions(shape.order_x, shape.order_z);
    let ReferenceMatrices { mass, mixed, .. } = reference;
    DMatrix::from_fn(2 * functions.len(), functions.len(), |row, j| {
        let ((a, b), (c, d)) = (functions[row / 2], functions[j]);
        if row % 2 == 0 {
            0.5 * shape.size_z * mixed[(a, c)] * mass[(b, d)]
        } else {
            0.5 * shape.size_x * mass[(a, c)] * mixed[(b, d)]
        }
    })
}

/// Element with condensed interior modes, and the factors that recover them.
#[derive(Clone, Debug)]
pub(crate) struct CondensedElement {
    /// Schur complement on the skeleton's degrees of freedom.
    pub skeleton: DMatrix<f64>,
    /// Lower Cholesky factor L of the interior block (its upper triangle is not used).
    interior_factor: DMatrix<f64>,
    /// L^-1 times the interior rows of the skeleton's columns.
    coupling: DMatrix<f64>,
}

/// Eliminates the degrees of freedom behind the first `skeleton` ones of a symmetric positive semidefinite element
/// matrix whose interior block is definite. None if that block is not positive definite.
pub(crate) fn condense(matrix: &DMatrix<f64>, skeleton: usize) -> Option<CondensedElement> {
    let mut condensed = CondensedElement::empty(matrix.nrows(), skeleton);
    condensed.fill(matrix).then_some(condensed)
}

impl CondensedElement {
    /// Allocates an element of `functions` degrees of freedom, of which `skeleton` are not eliminated.
    pub(crate) fn empty(functions: usize, skeleton: usize) -> CondensedElement {
        let interior = functions - skeleton;
        CondensedElement {
            skeleton: DMatrix::zeros(skeleton, skeleton),
            interior_factor: DMatrix::zeros(interior, interior),
            coupling: DMatrix::zeros(interior, skeleton),
        }
    }

    /// Condenses another element matrix of the same size, see [`condense`]; no allocation. False if its interior block is
    /// not positive definite: then it must be filled again before use.
    pub(crate) fn fill(&mut self, matrix: &DMatrix<f64>) -> bool {
        let (interior, skeleton) = self.coupling.shape();
        self.skeleton.copy_from(&matrix.view((0, 0), (skeleton, skeleton)));
        self.coupling.copy_from(&matrix.view((skeleton, 0), (interior, skeleton)));
        if interior > 0 {
            // An empty matrix takes no memory; a failed factorisation has consumed the block's memory.
            let mut block = std::mem::replace(&mut self.interior_factor, DMatrix::zeros(0, 0));
            if block.nrows() != interior {
                block = DMatrix::zeros(interior, interior);
            }
            block.copy_from(&matrix.view((skeleton, skeleton), (interior, interior)));
            let Ok(factor) = factorization::cholesky(block) else { return false };
            self.interior_factor = factor.unpack_dirty();
            solve_lower_triangular_in_place(view(&self.interior_factor), view_mut(&mut self.coupling), Par::Seq);
            self.skeleton.gemm_tr(-1.0, &self.coupling, &self.coupling, 1.0);
        }
        true
    }

    /// Moves interior loads to the skeleton: writes the contribution to `skeleton`, and leaves in `interior` the data of
    /// [`Self::recover_in_place`]. One column for each load.
    pub(crate) fn reduce_in_place(&self, mut interior: MatMut<'_, f64>, skeleton: MatMut<'_, f64>) {
        solve_lower_triangular_in_place(view(&self.interior_factor), interior.rb_mut(), Par::Seq);
        matmul(skeleton, Accum::Replace, view(&self.coupling).transpose(), interior.rb(), -1.0, Par::Seq);
    }

    /// Replaces reduced interior loads by the interior solution for the skeleton's solution.
    pub(crate) fn recover_in_place(&self, skeleton: MatRef<'_, f64>, mut interior: MatMut<'_, f64>) {
        matmul(interior.rb_mut(), Accum::Add, view(&self.coupling), skeleton, -1.0, Par::Seq);
        solve_upper_triangular_in_place(view(&self.interior_factor).transpose(), interior, Par::Seq);
    }

    /// [`Self::reduce_in_place`] into a new matrix.
    pub(crate) fn reduce(&self, interior: &mut DMatrix<f64>) -> DMatrix<f64> {
        let mut skeleton = DMatrix::zeros(self.skeleton.nrows(), interior.ncols());
        self.reduce_in_place(view_mut(interior), view_mut(&mut skeleton));
        skeleton
    }

    /// [`Self::recover_in_place`] for dense matrices.
    pub(crate) fn recover(&self, skeleton: &DMatrix<f64>, interior: &mut DMatrix<f64>) {
        self.recover_in_place(view(skeleton), view_mut(interior));
    }
}

fn view(matrix: &DMatrix<f64>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(matrix.as_slice(), matrix.nrows(), matrix.ncols())
}

fn view_mut(matrix: &mut DMatrix<f64>) -> MatMut<'_, f64> {
    let (rows, columns) = matrix.shape();
    MatMut::from_column_major_slice_mut(matrix.as_mut_slice(), rows, columns)
}
