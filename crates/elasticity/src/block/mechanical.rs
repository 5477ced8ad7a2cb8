//! Elasticity of the block: stiffness, compliance of the contact line, strain energy.
//!
//! Theory: docs/theory.md, section 3.4.

use super::boundary::{are_symmetric, contact_cells, contact_integrals, side_loads, top_values};
use super::condense::{Factor, FactorizationError, Pattern};
use super::element::{CondensedElement, Shape, condense, elastic_stiffness, local_functions};
use super::half_plane::HalfPlane;
use super::lobatto::{ReferenceMatrices, shape_values};
use super::mesh::{Grid, Mesh};
use super::{BlockError, Discretization, check_dimensions, check_positive};
use faer::Mat;
use nalgebra::DMatrix;
use numerics::quadrature::gauss_legendre;

/// Shape and elasticity of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockProperties {
    /// Extent along the sliding direction, m, > 0.
    pub width: f64,
    /// Extent from the contact to the holder, m, > 0.
    pub height: f64,
    /// Young's modulus, Pa, > 0.
    pub youngs_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poissons_ratio: f64,
}

impl BlockProperties {
    fn check(&self) -> Result<(), BlockError> {
        check_dimensions(self.width, self.height)?;
        check_positive(&[("youngs_modulus", self.youngs_modulus)])?;
        let value = self.poissons_ratio;
        if !(value > -1.0 && value < 0.5) {
            return Err(BlockError::OutOfRange { name: "poissons_ratio", value, limit: "above -1 and below 0.5" });
        }
        Ok(())
    }

    /// G = E / (2 (1 + nu)), Pa.
    pub(crate) fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)
    }

    /// lambda / G = 2 nu / (1 - 2 nu).
    pub(super) fn lambda_over_shear(&self) -> f64 {
        2.0 * self.poissons_ratio / (1.0 - 2.0 * self.poissons_ratio)
    }
}

/// Compliance of the contact line of one body, N x N.
#[derive(Clone, Debug)]
pub struct Compliance {
    /// C: mean normal displacement into the body over cell i per unit pressure on cell j [m/Pa]. diag(cell widths) C is
    /// symmetric and positive definite.
    pub normal: DMatrix<f64>,
    /// S: mean normal displacement into the body over cell i per unit shear traction in +x on cell j [m/Pa].
    pub shear: DMatrix<f64>,
    /// Largest asymmetry of diag(cell widths) C before it was made symmetric, relative to its largest entry: an estimate
    /// of the discretisation error.
    pub asymmetry: f64,
}

/// An elastic block with its factorised stiffness.
#[derive(Debug)]
pub struct Block {
    pub(super) properties: BlockProperties,
    discretization: Option<Discretization>,
    pub(super) order: usize,
    pub(super) mesh: Mesh,
    pub(super) pattern: Pattern,
    pub(super) elements: Vec<CondensedElement>,
    pub(super) kind: Vec<usize>,
    factor: Factor,
}

impl Block {
    /// Meshes the block, assembles and factorises its stiffness.
    ///
    /// # Errors
    /// A property or discretisation outside its range, named with its limit; a stiffness that is not positive definite
    /// in floating point (extremely fine grading) or does not fit into memory.
    pub fn new(properties: BlockProperties, discretization: Discretization) -> Result<Self, BlockError> {
        properties.check()?;
        discretization.check()?;
        let (x, z) = discretization.grids(properties.width, properties.height);
        let block = Self::on_grids(properties, x, z, discretization.order)?;
        Ok(Self { discretization: Some(discretization), ..block })
    }

    /// Whether [`Self::new`] makes this block from these arguments.
    pub(crate) fn is(&self, properties: BlockProperties, discretization: Discretization) -> bool {
        self.properties == properties && self.discretization == Some(discretization)
    }

    pub(super) fn on_grids(properties: BlockProperties, x: Grid, z: Grid, order: usize) -> Result<Self, BlockError> {
        let mesh = Mesh::new(x, z, true);
        let (elements, kind) = condensed_elements(&mesh, order, properties.lambda_over_shear());
        let failed = |reason| BlockError::Factorization { quantity: "stiffness", degrees: 2 * mesh.free, reason };
        let elements = elements.ok_or(failed(FactorizationError::NotPositiveDefinite))?;
        let pattern = Pattern::new(&mesh, 2).map_err(failed)?;
        let (mut factor, mut workspace) = (pattern.empty_factor(), pattern.workspace(0).map_err(failed)?);
        pattern.factorize_into(&mut factor, &mesh, &elements, &kind, &[], &mut workspace).map_err(failed)?;
        Ok(Self { properties, discretization: None, order, mesh, pattern, elements, kind, factor })
    }

    /// Number of unknowns after condensation.
    pub(crate) fn degrees(&self) -> usize {
        self.pattern.degrees()
    }

    /// Normal and shear compliance on the cells between ascending `boundaries` (N + 1 values from -a to a).
    ///
    /// # Errors
    /// Boundaries that do not ascend or do not span the contact.
    pub fn compliance(&self, boundaries: &[f64]) -> Result<Compliance, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let n = cells.len();
        let half_plane = HalfPlane { poissons_ratio: self.properties.poissons_ratio, scale: self.properties.width };
        // A cell and its mirror image have mirrored fields.
        let solved = if are_symmetric(boundaries) { n.div_ceil(2) } else { n };
        let remainder = self.remainder(&half_plane, &cells[..solved])?;
        let integrals = contact_integrals(&self.mesh, &cells);
        let observe = |component: usize, observed: usize, loaded: usize| -> f64 {
            let mirrored = loaded >= solved;
            let (observed, loaded) = if mirrored { (n - 1 - observed, n - 1 - loaded) } else { (observed, loaded) };
            let column = remainder.col(loaded);
            let sum: f64 =
                integrals[observed].iter().map(|&(degree, weight)| weight * column[2 * degree + component]).sum();
            if mirrored && component == 0 { -sum } else { sum }
        };
        // Integrals over the observed cell; those of the normal displacement are symmetric by Betti's theorem.
        let normal = DMatrix::from_fn(n, n, |i, j| half_plane.normal_influence(cells[i], cells[j]) + observe(1, i, j));
        let asymmetry = (&normal - normal.transpose()).amax() / normal.amax();
        let width = |i: usize| cells[i].1 - cells[i].0;
        let modulus = self.properties.shear_modulus();
        let symmetric = DMatrix::from_fn(n, n, |i, j| 0.5 * (normal[(i, j)] + normal[(j, i)]) / (width(i) * modulus));
        // By Betti's theorem the normal displacement by shear is the displacement along x by pressure, transposed.
        let shear = DMatrix::from_fn(n, n, |i, j| {
            (half_plane.tangential_influence(cells[j], cells[i]) + observe(0, j, i)) / (width(i) * modulus)
        });
        Ok(Compliance { normal: symmetric, shear, asymmetry })
    }

    /// Strain energy per unit depth [J/m] under the smooth pressure `pressure(x)`, Pa, by finite elements alone.
    ///
    /// For a pressure that is analytic on the contact the error falls exponentially with the order.
    pub fn strain_energy(&self, pressure: impl Fn(f64) -> f64) -> Result<f64, BlockError> {
        let mut load = Mat::zeros(self.degrees(), 1);
        let rule = gauss_legendre(self.order + 8);
        let mut values = vec![0.0; self.order + 1];
        for column in 0..self.mesh.x.intervals() {
            let degrees = self.mesh.horizontal_degrees(column, false);
            let (start, size) = (self.mesh.x.points[column], self.mesh.x.size(column));
            for &(xi, weight) in &rule {
                shape_values(xi, &mut values[..degrees.len()]);
                let force = 0.5 * size * weight * pressure(start + 0.5 * size * (1.0 + xi));
                for (degree, value) in degrees.iter().zip(&values) {
                    load[(2 * degree + 1, 0)] += force * value;
                }
            }
        }
        let mut displacement = load.clone();
        self.solve_in_place(&mut displacement)?;
        let work: f64 = (0..self.degrees()).map(|i| load[(i, 0)] * displacement[(i, 0)]).sum();
        Ok(0.5 * work / self.properties.shear_modulus())
    }

    pub(super) fn solve_in_place(&self, loads: &mut Mat<f64>) -> Result<(), BlockError> {
        let failed = |reason| BlockError::Factorization { quantity: "stiffness", degrees: self.degrees(), reason };
        let mut workspace = self.pattern.workspace(loads.ncols()).map_err(failed)?;
        self.pattern.solve_in_workspace(&self.factor, loads.as_mut(), &mut workspace);
        Ok(())
    }

    /// Unit tractions on the cells of these integrals of shape functions, along x (0) or into the block (1), one column each.
    pub(super) fn cell_loads(&self, cells: &[Vec<(usize, f64)>], component: usize) -> Mat<f64> {
        let mut loads = Mat::zeros(self.degrees(), cells.len());
        for (cell, integrals) in cells.iter().enumerate() {
            for &(degree, integral) in integrals {
                loads[(2 * degree + component, cell)] += integral;
            }
        }
        loads
    }

    /// Coefficients of the remainder v (times the shear modulus) for unit pressure on each cell, one column per cell.
    fn remainder(&self, half_plane: &HalfPlane, cells: &[(f64, f64)]) -> Result<Mat<f64>, BlockError> {
        let mesh = &self.mesh;
        let half_width = 0.5 * self.properties.width;
        let mut loads = side_loads(mesh, cells.len(), |j, right, z| {
            let normal = if right { 1.0 } else { -1.0 };
            let stress = half_plane.stress(cells[j], normal * half_width, z);
            [-normal * stress.xx, -normal * stress.xz]
        });
        let z = self.properties.height;
        let held = top_values(
            mesh,
            cells.len(),
            |j, x| {
                let (along, into) = half_plane.displacement(cells[j], x, z);
                [-along, -into]
            },
            |j, x| {
                // The derivative of the cell's displacement is the difference of two line loads' displacements.
                let right = half_plane.line_load_displacement(x - cells[j].0, z);
                let left = half_plane.line_load_displacement(x - cells[j].1, z);
                [left.0 - right.0, left.1 - right.1]
            },
        );
        self.pattern.subtract_held(mesh, &self.elements, &self.kind, &mut loads, &held);
        self.solve_in_place(&mut loads)?;
        Ok(loads)
    }
}

/// Condensed stiffness of every kind of element of the mesh, and the kind of each element. Elements of the same shape
/// up to a scale have the same stiffness.
fn condensed_elements(
    mesh: &Mesh,
    order: usize,
    lambda_over_shear: f64,
) -> (Option<Vec<CondensedElement>>, Vec<usize>) {
    let reference = ReferenceMatrices::new(order);
    let (shapes, kind) = mesh.distinct_shapes(Shape::similar);
    let elements = shapes
        .iter()
        .map(|&shape| {
            let (_, skeleton) = local_functions(shape.order_x, shape.order_z);
            condense(&elastic_stiffness(&reference, shape, lambda_over_shear), 2 * skeleton)
        })
        .collect();
    (elements, kind)
}
