//! The punch as an elastic block, by hp finite elements condensed onto the contact line.
//!
//! Plane strain, x in [-a, a] with a = width/2 along the contact, z from the contact (0) up to the top (height). The
//! sides are free, the top is held (u = 0), the contact carries tractions that are uniform on each of N cells.
//!
//! # Method
//! A pressure that jumps between cells has a logarithmic slope in its displacement at every jump, which polynomials
//! resolve poorly. The field of each cell's pressure is therefore split into that of a half-plane (closed form, see
//! [`half_plane`]) and a remainder that only corrects the sides and the top:
//!
//! ```text
//! u = u_half_plane + v,    div sigma(v) = 0 in the block,
//! sigma(v) n = -sigma(u_half_plane) n on the sides,   v = -u_half_plane at the top,   sigma(v) n = 0 at the contact
//! ```
//!
//! v is smooth away from the four corners, so the error falls exponentially on a mesh that is graded to them, with few
//! unknowns whose number does not depend on N, and no cell boundary has to be an element boundary.
//!
//! # Signs
//! Normal displacement into the body (+z) and pressure (pushing into +z) count positive. A shear traction counts
//! positive in +x on this body. On the punch friction acts in -x for s = +1: its shear compliance enters the gap
//! with -s.

pub mod condense;
pub mod element;
pub mod half_plane;
pub mod lobatto;
pub mod mesh;
#[cfg(test)]
mod tests;

use condense::{Factor, FactorizationError, Pattern};
use element::{CondensedElement, Shape, condense, elastic_stiffness, local_functions};
use faer::Mat;
use half_plane::HalfPlane;
use lobatto::{MAXIMUM_ORDER, ReferenceMatrices, gauss_legendre, shape_derivatives, shape_values};
use mesh::{Division, Grid, Mesh};
use nalgebra::DMatrix;
use std::cmp::Ordering;
use std::fmt;

/// What was refused, with its value and its limit.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockError {
    /// A number outside its range.
    OutOfRange { name: &'static str, value: f64, limit: &'static str },
    /// Cell boundary `index` is not above its predecessor.
    CellsNotAscending { index: usize, before: f64, value: f64 },
    /// The first or last cell boundary is not an end of the contact.
    CellsDoNotSpanContact { first: f64, last: f64, half_width: f64 },
    /// The stiffness matrix of `degrees` unknowns could not be factorised.
    Factorization { degrees: usize, reason: FactorizationError },
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
            Self::Factorization { degrees, reason } => {
                write!(f, "stiffness matrix of the block with {degrees} unknowns: {reason:?}")
            }
        }
    }
}

impl std::error::Error for BlockError {}

/// Shape and elasticity of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockProperties {
    /// Extent along the sliding direction [m], > 0.
    pub width: f64,
    /// Extent from the contact to the holder [m], > 0.
    pub height: f64,
    /// Young's modulus [Pa], > 0.
    pub youngs_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poissons_ratio: f64,
}

impl BlockProperties {
    /// Largest height / width: the bending of a more slender block amplifies rounding beyond 1e-4 of S.
    pub const LARGEST_SLENDERNESS: f64 = 20.0;
    /// Largest width / height: the mesh grows in proportion to it.
    pub const LARGEST_FLATNESS: f64 = 500.0;

    fn check(&self) -> Result<(), BlockError> {
        for (name, value) in [("width", self.width), ("height", self.height), ("youngs_modulus", self.youngs_modulus)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(BlockError::OutOfRange { name, value, limit: "positive and finite" });
            }
        }
        let value = self.poissons_ratio;
        if !(value > -1.0 && value < 0.5) {
            return Err(BlockError::OutOfRange { name: "poissons_ratio", value, limit: "above -1 and below 0.5" });
        }
        let value = self.height / self.width;
        if !(1.0 / Self::LARGEST_FLATNESS..=Self::LARGEST_SLENDERNESS).contains(&value) {
            return Err(BlockError::OutOfRange { name: "height / width", value, limit: "from 0.002 to 20" });
        }
        Ok(())
    }

    /// G = E / (2 (1 + nu)) [Pa].
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)
    }

    /// lambda / G = 2 nu / (1 - 2 nu).
    fn lambda_over_shear(&self) -> f64 {
        2.0 * self.poissons_ratio / (1.0 - 2.0 * self.poissons_ratio)
    }
}

/// The finite-element mesh and order.
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
}

impl Discretization {
    /// Grading at which layers and order are used best for the singularities of the corners.
    pub const CORNER_GRADING: f64 = 0.15;
    /// Grading at which they are used best for the remainder fields of the cells next to the corners, which vary over
    /// the distance between cell and corner: a steeper one takes higher orders, a milder one more layers.
    pub const CELL_GRADING: f64 = 0.25;
    /// Order that `for_cells` does not exceed.
    pub const HIGHEST_ORDER: usize = 8;

    /// The same number of layers at all four corners, for smooth loads.
    pub fn uniform(order: usize, layers: usize) -> Self {
        Self { order, contact_layers: layers, top_layers: layers, grading: Self::CORNER_GRADING }
    }

    /// Order and layers for the compliance on the cells between `boundaries` to the relative `tolerance` (of the largest
    /// entry of C).
    ///
    /// Measured on a square block with 9 to 129 cells: the error is 1.2e-3 at order 4 and falls by 4 with each order
    /// (nu <= 0.45; up to four times that near nu = 0.5), once the smallest element is a third of the smallest cell.
    /// About 1e-5 is the most that order 8 gives.
    pub fn for_cells(properties: &BlockProperties, boundaries: &[f64], tolerance: f64) -> Self {
        let order = 4.0 + (1.2e-3 / tolerance).ln() / 4.0f64.ln();
        let order = (order.ceil() as usize).clamp(3, Self::HIGHEST_ORDER);
        let smallest = boundaries.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let reach = graded_reach(properties);
        let ratio = (smallest / (3.0 * reach)).clamp(1e-10, 1.0);
        let contact_layers = 1 + (ratio.ln() / Self::CELL_GRADING.ln()).ceil() as usize;
        let top_layers = 1 + order / 2;
        Self { order, contact_layers: contact_layers.max(2), top_layers, grading: Self::CELL_GRADING }
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
}

/// Distance from a corner over which the elements shrink [m].
fn graded_reach(properties: &BlockProperties) -> f64 {
    (0.5 * properties.width).min(properties.height)
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
    properties: BlockProperties,
    order: usize,
    mesh: Mesh,
    pattern: Pattern,
    elements: Vec<CondensedElement>,
    kind: Vec<usize>,
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
        let BlockProperties { width, height, .. } = properties;
        let Discretization { order, contact_layers, top_layers, grading } = discretization;
        let layers = contact_layers.max(top_layers);
        // Elements much larger than the other dimension would miss the field's decay over that dimension.
        let x = Division { first_layers: layers, last_layers: layers, grading, largest: height };
        let z = Division { first_layers: contact_layers, last_layers: top_layers, grading, largest: width };
        Self::on_grids(
            properties,
            Grid::graded(-0.5 * width, 0.5 * width, x, order),
            Grid::graded(0.0, height, z, order),
            order,
        )
    }

    fn on_grids(properties: BlockProperties, x: Grid, z: Grid, order: usize) -> Result<Self, BlockError> {
        let mesh = Mesh::new(x, z, true);
        let (elements, kind) = condensed_elements(&mesh, order, properties.lambda_over_shear());
        let failed = |reason| BlockError::Factorization { degrees: 2 * mesh.free, reason };
        let elements = elements.ok_or(failed(FactorizationError::NotPositiveDefinite))?;
        let pattern = Pattern::new(&mesh, 2).map_err(failed)?;
        let factor = pattern.factorize(&mesh, &elements, &kind).map_err(failed)?;
        Ok(Self { properties, order, mesh, pattern, elements, kind, factor })
    }

    /// Number of unknowns after condensation.
    pub fn degrees(&self) -> usize {
        self.pattern.degrees()
    }

    /// Number of entries of the Cholesky factor.
    pub fn factor_entries(&self) -> usize {
        self.pattern.factor_entries()
    }

    /// Normal and shear compliance on the cells between ascending `boundaries` (N + 1 values from -a to a).
    ///
    /// # Errors
    /// Boundaries that do not ascend or do not span the contact.
    pub fn compliance(&self, boundaries: &[f64]) -> Result<Compliance, BlockError> {
        let cells = self.cells(boundaries)?;
        let n = cells.len();
        let half_plane = HalfPlane { poissons_ratio: self.properties.poissons_ratio, scale: self.properties.width };
        let remainder = self.remainder(&half_plane, &cells)?;
        let integrals = self.contact_integrals(&cells);
        let observe = |component: usize, observed: usize, loaded: usize| -> f64 {
            let column = remainder.col(loaded);
            integrals[observed].iter().map(|&(degree, weight)| weight * column[2 * degree + component]).sum()
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

    /// Strain energy per unit depth [J/m] under the smooth pressure `pressure(x)` [Pa], by finite elements alone.
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

    fn solve_in_place(&self, loads: &mut Mat<f64>) -> Result<(), BlockError> {
        self.pattern
            .solve_in_place(&self.factor, loads.as_mut())
            .map_err(|reason| BlockError::Factorization { degrees: self.degrees(), reason })
    }

    fn cells(&self, boundaries: &[f64]) -> Result<Vec<(f64, f64)>, BlockError> {
        for (index, pair) in boundaries.windows(2).enumerate() {
            if pair[1].partial_cmp(&pair[0]) != Some(Ordering::Greater) {
                return Err(BlockError::CellsNotAscending { index: index + 1, before: pair[0], value: pair[1] });
            }
        }
        let half_width = 0.5 * self.properties.width;
        let first = boundaries.first().copied().unwrap_or(f64::NAN);
        let last = boundaries.last().copied().unwrap_or(f64::NAN);
        let tolerance = 1e-12 * self.properties.width;
        if !((first + half_width).abs() <= tolerance && (last - half_width).abs() <= tolerance && boundaries.len() > 1)
        {
            return Err(BlockError::CellsDoNotSpanContact { first, last, half_width });
        }
        Ok(boundaries.windows(2).map(|pair| (pair[0], pair[1])).collect())
    }

    /// Coefficients of the remainder v (times the shear modulus) for unit pressure on each cell, one column per cell.
    fn remainder(&self, half_plane: &HalfPlane, cells: &[(f64, f64)]) -> Result<Mat<f64>, BlockError> {
        let mut loads = self.side_loads(half_plane, cells);
        let held = self.held_displacements(half_plane, cells);
        self.subtract_held(&mut loads, &held);
        self.solve_in_place(&mut loads)?;
        Ok(loads)
    }

    /// Loads of the negative half-plane tractions on both sides.
    fn side_loads(&self, half_plane: &HalfPlane, cells: &[(f64, f64)]) -> Mat<f64> {
        let mut loads = Mat::zeros(self.degrees(), cells.len());
        let rule = gauss_legendre(self.order + 4);
        let mut values = vec![0.0; self.order + 1];
        for row in 0..self.mesh.z.intervals() {
            let (start, size) = (self.mesh.z.points[row], self.mesh.z.size(row));
            for (right, x) in [(false, -0.5 * self.properties.width), (true, 0.5 * self.properties.width)] {
                let normal = if right { 1.0 } else { -1.0 };
                let degrees = self.mesh.vertical_degrees(row, right);
                for &(xi, weight) in &rule {
                    shape_values(xi, &mut values[..degrees.len()]);
                    let z = start + 0.5 * size * (1.0 + xi);
                    let factor = -normal * 0.5 * size * weight;
                    for (j, &cell) in cells.iter().enumerate() {
                        let stress = half_plane.stress(cell, x, z);
                        for (&degree, value) in degrees.iter().zip(&values).filter(|&(&d, _)| d < self.mesh.free) {
                            loads[(2 * degree, j)] += factor * stress.xx * value;
                            loads[(2 * degree + 1, j)] += factor * stress.xz * value;
                        }
                    }
                }
            }
        }
        loads
    }

    /// Negative half-plane displacements at the top in the order of the held degrees of freedom: exact at the vertices,
    /// the best approximation in the energy norm of one dimension between them.
    fn held_displacements(&self, half_plane: &HalfPlane, cells: &[(f64, f64)]) -> Mat<f64> {
        let mut held = Mat::zeros(2 * (self.mesh.total - self.mesh.free), cells.len());
        let rule = gauss_legendre(self.order + 4);
        let mut slopes = vec![0.0; self.order + 1];
        let z = self.properties.height;
        let index = |degree: usize| 2 * (degree - self.mesh.free);
        for column in 0..self.mesh.x.intervals() {
            let degrees = self.mesh.horizontal_degrees(column, true);
            let (start, size) = (self.mesh.x.points[column], self.mesh.x.size(column));
            for (j, &cell) in cells.iter().enumerate() {
                for (&degree, x) in degrees.iter().zip([start, start + size]) {
                    let (along, into) = half_plane.displacement(cell, x, z);
                    held[(index(degree), j)] = -along;
                    held[(index(degree) + 1, j)] = -into;
                }
            }
            for &(xi, weight) in &rule {
                shape_derivatives(xi, &mut slopes[..degrees.len()]);
                let x = start + 0.5 * size * (1.0 + xi);
                for (j, &cell) in cells.iter().enumerate() {
                    // The derivative of the cell's displacement is the difference of two line loads' displacements.
                    let right = half_plane.line_load_displacement(x - cell.0, z);
                    let left = half_plane.line_load_displacement(x - cell.1, z);
                    let factor = -0.5 * size * weight;
                    for (&degree, slope) in degrees.iter().zip(&slopes).skip(2) {
                        held[(index(degree), j)] += factor * slope * (right.0 - left.0);
                        held[(index(degree) + 1, j)] += factor * slope * (right.1 - left.1);
                    }
                }
            }
        }
        held
    }

    /// Moves the known displacements of the top to the right-hand side.
    fn subtract_held(&self, loads: &mut Mat<f64>, held: &Mat<f64>) {
        let row = self.mesh.z.intervals() - 1;
        let free = 2 * self.mesh.free;
        for column in 0..self.mesh.x.intervals() {
            let kind = self.kind[column * self.mesh.z.intervals() + row];
            let matrix = &self.elements[kind].skeleton;
            let degrees: Vec<usize> =
                self.mesh.element_degrees(column, row).into_iter().flat_map(|d| [2 * d, 2 * d + 1]).collect();
            for j in 0..loads.ncols() {
                for (b, &known) in degrees.iter().enumerate().filter(|&(_, &d)| d >= free) {
                    let value = held[(known - free, j)];
                    for (a, &unknown) in degrees.iter().enumerate().filter(|&(_, &d)| d < free) {
                        loads[(unknown, j)] -= matrix[(a, b)] * value;
                    }
                }
            }
        }
    }

    /// Integrals of the contact's shape functions over each cell: (scalar degree of freedom, integral [m]).
    fn contact_integrals(&self, cells: &[(f64, f64)]) -> Vec<Vec<(usize, f64)>> {
        let rule = gauss_legendre(self.order / 2 + 1);
        let mut values = vec![0.0; self.order + 1];
        let grid = &self.mesh.x;
        let degrees: Vec<Vec<usize>> =
            (0..grid.intervals()).map(|column| self.mesh.horizontal_degrees(column, false)).collect();
        let mut result = Vec::with_capacity(cells.len());
        for &(left, right) in cells {
            let mut integrals = Vec::new();
            for (column, degrees) in degrees.iter().enumerate() {
                let (start, size) = (grid.points[column], grid.size(column));
                let (from, to) = (left.max(start), right.min(start + size));
                if from >= to {
                    continue;
                }
                let first = integrals.len();
                integrals.extend(degrees.iter().map(|&degree| (degree, 0.0)));
                for &(t, weight) in &rule {
                    let x = 0.5 * (from + to) + 0.5 * (to - from) * t;
                    shape_values(2.0 * (x - start) / size - 1.0, &mut values[..degrees.len()]);
                    for (entry, value) in integrals[first..].iter_mut().zip(&values) {
                        entry.1 += 0.5 * (to - from) * weight * value;
                    }
                }
            }
            result.push(integrals);
        }
        result
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
