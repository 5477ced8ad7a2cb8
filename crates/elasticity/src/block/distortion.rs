//! Thermal distortion of the contact line: displacement of the heated block without traction on the contact.
//!
//! Plane strain with free thermal strain alpha T, the top held, sides and contact free:
//!
//! ```text
//! a(u, v) = int (3 lambda + 2 G) alpha T div v dx dz   for all v
//! ```
//!
//! Normal displacements count positive into the body (+z), so heating gives negative ones: the surface moves towards
//! the partner and closes the gap.
//!
//! Theory: docs/theory.md, section 4.9.

use super::boundary::{are_symmetric, contact_cells, contact_integrals};
use super::element::{Shape, dilatation, local_functions};
use super::lobatto::{ReferenceMatrices, shape_derivatives, shape_values};
use super::mechanical::Block;
use super::thermal::ThermalBlock;
use super::{BlockError, check_same_mesh};
use faer::Mat;
use nalgebra::DMatrix;
use numerics::quadrature::gauss_legendre;

/// A quadrature point through the height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthPoint {
    /// Distance from the contact, m.
    pub z: f64,
    /// Weight of the quadrature, m.
    pub weight: f64,
    /// Row of elements.
    row: usize,
    /// Fraction of the row's height that lies below.
    reference: f64,
}

/// Functions across the width, factors of the product temperature fields.
pub struct FunctionsAcross<'a> {
    /// Number of functions.
    pub count: usize,
    /// Bound of their variation: that of cos(`steepest` x).
    pub steepest: f64,
    /// Value of a function by its number and x.
    pub value: &'a dyn Fn(usize, f64) -> f64,
    /// Parity of a function by its number, even (1) or odd (-1); None: neither.
    pub parity: &'a dyn Fn(usize) -> Option<f64>,
}

impl Block {
    /// Mean normal displacement over each cell per unit thermal expansion coefficient by each column of `fields`
    /// (temperatures in the order of `thermal`'s vectors), N x columns, m.
    ///
    /// # Errors
    /// The two blocks differ in shape or discretisation; boundaries that do not ascend or do not span the contact.
    pub fn thermal_distortion(
        &self,
        thermal: &ThermalBlock,
        fields: &Mat<f64>,
        boundaries: &[f64],
    ) -> Result<DMatrix<f64>, BlockError> {
        check_same_mesh(&self.mesh, &thermal.mesh)?;
        self.distortion(boundaries, fields.ncols(), |element| {
            let degrees = thermal.local_degrees(element);
            DMatrix::from_fn(degrees.len(), fields.ncols(), |i, k| degrees[i].map_or(0.0, |d| fields[(d, k)]))
        })
    }

    /// Mean normal displacement over each cell per unit thermal expansion coefficient and unit rise of a uniform
    /// temperature, N x 1 [m/K].
    pub fn uniform_distortion(&self, boundaries: &[f64]) -> Result<DMatrix<f64>, BlockError> {
        self.distortion(boundaries, 1, |element| {
            let Shape { order_x, order_z, .. } = self.mesh.shape(element);
            // The functions of the four vertices come first and sum to 1.
            DMatrix::from_fn((order_x + 1) * (order_z + 1), 1, |i, _| if i < 4 { 1.0 } else { 0.0 })
        })
    }

    fn distortion(
        &self,
        boundaries: &[f64],
        columns: usize,
        temperature: impl Fn(usize) -> DMatrix<f64>,
    ) -> Result<DMatrix<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let mut loads = self.thermal_loads(columns, temperature);
        self.solve_in_place(&mut loads)?;
        let integrals = contact_integrals(&self.mesh, &cells);
        Ok(DMatrix::from_fn(cells.len(), columns, |i, k| {
            let sum: f64 = integrals[i].iter().map(|&(degree, integral)| integral * loads[(2 * degree + 1, k)]).sum();
            sum / (cells[i].1 - cells[i].0)
        }))
    }

    /// Points through the height at which [`Self::product_distortion`] needs the profiles of its fields.
    pub fn depth_points(&self) -> Vec<DepthPoint> {
        let rule = gauss_legendre(self.order + 4);
        let mut points = Vec::new();
        for row in 0..self.mesh.z.intervals() {
            let (start, size) = (self.mesh.z.points[row], self.mesh.z.size(row));
            // Temperature fields at short times decay within the first elements.
            let parts: &[f64] = if row == 0 { &[0.0, 0.001, 0.01, 0.1, 1.0] } else { &[0.0, 1.0] };
            for part in parts.windows(2) {
                let (middle, half) = (0.5 * (part[0] + part[1]), 0.5 * (part[1] - part[0]));
                points.extend(rule.iter().map(|&(node, weight)| {
                    let reference = middle + half * node;
                    DepthPoint { row, reference, z: start + size * reference, weight: size * half * weight }
                }));
            }
        }
        points
    }

    /// Mean normal displacement over each cell per unit thermal expansion coefficient by temperature fields that are
    /// products, N x fields [m/K].
    ///
    /// `fields` name one of the functions across, and give the profile at the [`Self::depth_points`]. By Betti's theorem
    /// the displacement of a cell is the thermal stress times the dilatation under unit pressure on that cell: one elastic
    /// solution per cell, whatever the number of fields, and the fields need not be polynomials. Of cells and functions
    /// that are symmetric one half follows from the other.
    ///
    /// # Errors
    /// Boundaries that do not ascend or do not span the contact.
    pub fn product_distortion(
        &self,
        boundaries: &[f64],
        functions: &FunctionsAcross<'_>,
        fields: &[(usize, &[f64])],
    ) -> Result<DMatrix<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let parities: Option<Vec<f64>> = (0..functions.count).map(functions.parity).collect();
        let parities = parities.filter(|_| are_symmetric(boundaries));
        let pressed_cells = if parities.is_some() { cells.len().div_ceil(2) } else { cells.len() };
        let mut pressed = self.cell_loads(&contact_integrals(&self.mesh, &cells[..pressed_cells]), 1);
        self.solve_in_place(&mut pressed)?;
        let along = self.moments_along(functions);
        let up = self.moments_of_profiles(fields);
        let mut result = DMatrix::zeros(cells.len(), fields.len());
        for (row, [up_values, up_slopes]) in up.iter().enumerate() {
            // int T div u = sum over the functions a, b of u_x int X N_a' int Z N_b + u_z int X N_a int Z N_b'.
            let [along_x, along_z] = self.displacements_along(row, &pressed);
            let [values, slopes] = &along;
            let sums = [along_x * slopes, along_z * values];
            for (field, &(index, _)) in fields.iter().enumerate() {
                let mut answer = result.column_mut(field);
                let mut answer = answer.rows_mut(0, pressed_cells);
                for b in 0..up_values.nrows() {
                    let first = b * pressed_cells;
                    answer.axpy(up_values[(b, field)], &sums[0].column(index).rows(first, pressed_cells), 1.0);
                    answer.axpy(up_slopes[(b, field)], &sums[1].column(index).rows(first, pressed_cells), 1.0);
                }
            }
        }
        if let Some(parities) = parities {
            for (mut column, &(index, _)) in result.column_iter_mut().zip(fields) {
                for cell in pressed_cells..cells.len() {
                    column[cell] = parities[index] * column[cells.len() - 1 - cell];
                }
            }
        }
        let factor = 3.0 * self.properties.lambda_over_shear() + 2.0;
        for (mut row, cell) in result.row_iter_mut().zip(&cells) {
            row *= factor / (cell.1 - cell.0);
        }
        Ok(result)
    }

    /// Integrals over the columns of elements of the functions across (columns) times the shape functions, and times their slopes.
    fn moments_along(&self, across: &FunctionsAcross<'_>) -> [DMatrix<f64>; 2] {
        let x = &self.mesh.x;
        let mut moments =
            [(); 2].map(|()| DMatrix::zeros(x.intervals() + x.orders.iter().sum::<usize>(), across.count));
        let mut first = 0;
        for (column, &order) in x.orders.iter().enumerate() {
            let (start, size) = (x.points[column], x.size(column));
            let rule = gauss_legendre(order + 5 + (0.5 * across.steepest * size).ceil() as usize);
            let values = DMatrix::from_fn(rule.len(), across.count, |at, index| {
                (across.value)(index, start + 0.5 * size * (1.0 + rule[at].0))
            });
            let shapes = weighted_shapes(order, size, rule.iter().map(|&(xi, weight)| (xi, 0.5 * size * weight)));
            for (moments, shapes) in moments.iter_mut().zip(shapes) {
                shapes.mul_to(&values, &mut moments.rows_mut(first, order + 1));
            }
            first += order + 1;
        }
        moments
    }

    /// [`Self::moments_along`] through the height, for every row of elements and every field.
    fn moments_of_profiles(&self, fields: &[(usize, &[f64])]) -> Vec<[DMatrix<f64>; 2]> {
        let mut next = 0;
        (self.depth_points().chunk_by(|one, other| one.row == other.row))
            .map(|points| {
                let first = next;
                next += points.len();
                let profiles = DMatrix::from_fn(points.len(), fields.len(), |at, field| fields[field].1[first + at]);
                let (order, size) = (self.mesh.z.orders[points[0].row], self.mesh.z.size(points[0].row));
                let points = points.iter().map(|point| (2.0 * point.reference - 1.0, point.weight));
                weighted_shapes(order, size, points).map(|all| all * &profiles)
            })
            .collect()
    }

    /// Both components of the displacements `solutions` (columns) in a row of elements: rows by function b through the height, then
    /// solution; columns by element, then function a across.
    fn displacements_along(&self, row: usize, solutions: &Mat<f64>) -> [DMatrix<f64>; 2] {
        let (x, count) = (&self.mesh.x, solutions.ncols());
        let functions_across = x.intervals() + x.orders.iter().sum::<usize>();
        let mut components = [(); 2].map(|()| DMatrix::zeros((self.mesh.z.orders[row] + 1) * count, functions_across));
        let mut first = 0;
        for column in 0..x.intervals() {
            let element = self.mesh.element(column, row);
            let Shape { order_x, order_z, .. } = self.mesh.shape(element);
            let degrees = self.mesh.element_degrees(column, row);
            let skeleton = DMatrix::from_fn(2 * degrees.len(), count, |i, k| {
                if degrees[i / 2] < self.mesh.free { solutions[(2 * degrees[i / 2] + i % 2, k)] } else { 0.0 }
            });
            let (functions, _) = local_functions(order_x, order_z);
            let mut interior = DMatrix::zeros(2 * (functions.len() - degrees.len()), count);
            self.elements[self.kind[element]].recover(&skeleton, &mut interior);
            for (i, &(a, b)) in functions.iter().enumerate() {
                let (from, i) = if i < degrees.len() { (&skeleton, i) } else { (&interior, i - degrees.len()) };
                for (component, matrix) in components.iter_mut().enumerate() {
                    let mut target = matrix.view_mut((b * count, first + a), (count, 1));
                    from.row(2 * i + component).transpose_to(&mut target);
                }
            }
            first += order_x + 1;
        }
        components
    }

    /// Loads on the free skeleton of the thermal stress over shear modulus and expansion coefficient, for the
    /// temperatures `temperature(element)` (local functions by columns).
    pub(super) fn thermal_loads(&self, columns: usize, temperature: impl Fn(usize) -> DMatrix<f64>) -> Mat<f64> {
        let factor = 3.0 * self.properties.lambda_over_shear() + 2.0;
        let mesh = &self.mesh;
        let order = mesh.x.orders.iter().chain(&mesh.z.orders).copied().max().unwrap_or(1);
        let reference = ReferenceMatrices::new(order);
        let (shapes, shape_of) = mesh.distinct_shapes(Shape::congruent);
        let dilatations: Vec<DMatrix<f64>> = shapes.iter().map(|&shape| dilatation(&reference, shape)).collect();
        let mut loads = Mat::zeros(self.degrees(), columns);
        for element in 0..mesh.elements() {
            let load = factor * &dilatations[shape_of[element]] * temperature(element);
            let condensed = &self.elements[self.kind[element]];
            let skeleton = condensed.skeleton.nrows();
            let mut interior = load.rows(skeleton, load.nrows() - skeleton).into_owned();
            let reduced = load.rows(0, skeleton) + condensed.reduce(&mut interior);
            let (column, row) = mesh.column_and_row(element);
            for (i, degree) in mesh.element_degrees(column, row).into_iter().enumerate() {
                if degree < mesh.free {
                    for k in 0..columns {
                        loads[(2 * degree, k)] += reduced[(2 * i, k)];
                        loads[(2 * degree + 1, k)] += reduced[(2 * i + 1, k)];
                    }
                }
            }
        }
        loads
    }
}

/// Shape functions of an element of this order and size, and their slopes, by points (columns) on [-1, 1], times their weights.
fn weighted_shapes(order: usize, size: f64, points: impl ExactSizeIterator<Item = (f64, f64)>) -> [DMatrix<f64>; 2] {
    let mut shapes = [(); 2].map(|()| DMatrix::zeros(order + 1, points.len()));
    for (at, (xi, weight)) in points.enumerate() {
        let [values, slopes] = &mut shapes;
        shape_values(xi, values.column_mut(at).as_mut_slice());
        shape_derivatives(xi, slopes.column_mut(at).as_mut_slice());
        values.column_mut(at).scale_mut(weight);
        slopes.column_mut(at).scale_mut(weight * 2.0 / size);
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::super::boundary::top_values;
    use super::super::{BlockProperties, Discretization, ThermalProperties};
    use super::*;
    use crate::Cells;
    use scene::FarBoundary;
    use std::f64::consts::PI;

    fn pair(width: f64, poissons_ratio: f64) -> (Block, ThermalBlock) {
        let discretization = Discretization::uniform(6, 4);
        let elastic = BlockProperties { width, height: 1.0, youngs_modulus: 3.0, poissons_ratio };
        let thermal = ThermalProperties {
            width,
            height: 1.0,
            conductivity: 2.0,
            volumetric_heat_capacity: 1.0,
            side_convection: 0.0,
            top: FarBoundary::Held,
        };
        (Block::new(elastic, discretization).unwrap(), ThermalBlock::new(thermal, discretization).unwrap())
    }

    /// A harmonic temperature leaves a free body without stress in the plane, so sides do not matter, and the surface rises by
    /// alpha (1 + nu) cos(q x)/q (Boley and Weiner, 4.6). Up to waves of four of the largest cells.
    #[test]
    fn harmonic_fields_of_short_wavelength_distort_by_their_closed_form() {
        let (width, nu) = (0.06, 0.3);
        for (height, count, tolerance) in [(0.12, 17, 1e-3), (0.06, 33, 1e-3), (0.02, 33, 1e-3), (0.06, 65, 1e-5)] {
            let cells = Cells::graded(0.5 * width, count).unwrap();
            let properties = BlockProperties { width, height, youngs_modulus: 1.0, poissons_ratio: nu };
            let discretization = Discretization::for_cells(width, height, cells.edges(), tolerance);
            let block = Block::new(properties, discretization).unwrap();
            for m in [count / 4, count / 3] {
                let q = m as f64 * PI / width;
                let profile: Vec<f64> = block.depth_points().iter().map(|point| (-q * point.z).exp()).collect();
                let functions = FunctionsAcross {
                    count: 1,
                    steepest: q,
                    value: &|_, x| (q * (x + 0.5 * width)).cos(),
                    parity: &|_| None,
                };
                let found = block.product_distortion(cells.edges(), &functions, &[(0, &profile)]).unwrap();
                let amplitude = (1.0 + nu) / q;
                let exact = cells.means_from_primitive(|x| -amplitude / q * (q * (x + 0.5 * width)).sin());
                // The held top moves by exp(-q h) of the amplitude.
                let bound = amplitude * (1e-3 + 2.0 * (-q * height).exp());
                for (found, exact) in found.iter().zip(&exact) {
                    assert!((found - exact).abs() < bound, "{height} {count} {m}: {found:e} {exact:e} {bound:e}");
                }
            }
        }
    }

    #[test]
    fn free_expansion_is_exact() {
        // A top that expands freely along x leaves the heated block free of stress in the plane.
        let (block, _) = pair(2.0, 0.3);
        let stretch = 1.3;
        let mesh = &block.mesh;
        let held = top_values(mesh, 1, |_, x| [stretch * x, stretch], |_, _| [stretch, 0.0]);
        let mut loads = block.thermal_loads(1, |_| DMatrix::from_fn(49, 1, |i, _| if i < 4 { 1.0 } else { 0.0 }));
        block.pattern.subtract_held(mesh, &block.elements, &block.kind, &mut loads, &held);
        block.solve_in_place(&mut loads).unwrap();
        for entity in &mesh.entities[..mesh.free_entities] {
            if let Some((x, z)) = mesh.vertex(entity) {
                assert!((loads[(2 * entity.first, 0)] - stretch * x).abs() < 1e-11);
                assert!((loads[(2 * entity.first + 1, 0)] - stretch * z).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn wide_block_expands_like_a_layer_towards_the_partner() {
        // u = -alpha (1 + nu)/(1 - nu) times the integral of T over the height.
        let (block, thermal) = pair(30.0, 0.3);
        let boundaries: Vec<f64> = (0..=15).map(|i| -15.0 + 2.0 * i as f64).collect();
        let expected = -1.3 / 0.7;
        let uniform = block.uniform_distortion(&boundaries).unwrap();
        assert!((uniform[(7, 0)] - expected).abs() < 1e-5, "{}", uniform[(7, 0)]);
        // A uniform flux of 2 makes T = 1 - z with conductivity 2: half the integral.
        let loads = thermal.flux_loads(&boundaries).unwrap();
        let mut field = Mat::from_fn(thermal.degrees(), 1, |i, _| (0..15).map(|j| 2.0 * loads[(i, j)]).sum());
        thermal.solve_in_place(&thermal.factorize(0.0).unwrap(), &mut field).unwrap();
        let linear = block.thermal_distortion(&thermal, &field, &boundaries).unwrap();
        assert!((linear[(7, 0)] - 0.5 * expected).abs() < 1e-5, "{}", linear[(7, 0)]);
        assert_eq!(linear.shape(), (15, 1));
    }

    #[test]
    fn products_are_distorted_as_the_same_fields_of_elements() {
        let (block, thermal) = pair(2.0, 0.3);
        // T = 1 everywhere; T = 1 - z by a uniform flux; T = x (1 - z), which the elements hold by its values at vertices.
        let points = block.depth_points();
        let one = vec![1.0; points.len()];
        let falling: Vec<f64> = points.iter().map(|point| 1.0 - point.z).collect();
        let fields = [(0, &one[..]), (0, &falling[..]), (1, &falling[..])];
        let mut elements = Mat::zeros(thermal.degrees(), 2);
        for entity in &thermal.mesh.entities[..thermal.mesh.free_entities] {
            if let Some((x, z)) = thermal.mesh.vertex(entity) {
                elements[(entity.first, 0)] = 1.0 - z;
                elements[(entity.first, 1)] = x * (1.0 - z);
            }
        }
        // Cells that are their own mirror images, with and without one in the middle, and others.
        let sets: [&[f64]; 3] =
            [&[-1.0, -0.3, 0.4, 0.9, 1.0], &[-1.0, -0.7, -0.2, 0.2, 0.7, 1.0], &[-1.0, -0.7, 0.0, 0.7, 1.0]];
        for boundaries in sets {
            let uniform = block.uniform_distortion(boundaries).unwrap();
            let others = block.thermal_distortion(&thermal, &elements, boundaries).unwrap();
            for parities in [[Some(1.0), Some(-1.0)], [None; 2]] {
                let functions = FunctionsAcross {
                    count: 2,
                    steepest: 0.0,
                    value: &|index, x| if index == 0 { 1.0 } else { x },
                    parity: &|index| parities[index],
                };
                let found = block.product_distortion(boundaries, &functions, &fields).unwrap();
                for i in 0..boundaries.len() - 1 {
                    let expected = [uniform[(i, 0)], others[(i, 0)], others[(i, 1)]];
                    for (column, expected) in expected.into_iter().enumerate() {
                        let found = found[(i, column)];
                        assert!((found - expected).abs() < 1e-9, "{i} {column}: {found} {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn distortion_is_reciprocal_to_the_dilatation_by_pressure() {
        // Betti: sum over cells of width times u_T = -(3 lambda + 2 G) alpha int T e, with e the dilatation by unit
        // pressure on the whole contact; for uniform T the integral of e is minus the lost volume, known from the
        // displacements of the boundary.
        let (block, _) = pair(2.0, 0.3);
        let boundaries = [-1.0, -0.3, 0.4, 1.0];
        let widths = [0.7, 0.7, 0.6];
        let distortion = block.uniform_distortion(&boundaries).unwrap();
        let swept: f64 = widths.iter().zip(distortion.iter()).map(|(width, u)| width * u).sum();
        let compliance = block.compliance(&boundaries).unwrap().normal;
        let pushed_in: f64 = (0..3).map(|i| widths[i] * compliance.row(i).sum()).sum();
        // Work of the pressure and of the thermal stress in the sides' normal displacement, from the loads themselves.
        let mut pressed = Mat::zeros(block.degrees(), 1);
        for (degree, integral) in contact_integrals(&block.mesh, &[(-1.0, 1.0)]).remove(0) {
            pressed[(2 * degree + 1, 0)] += integral;
        }
        block.solve_in_place(&mut pressed).unwrap();
        let shear_modulus = block.properties.shear_modulus();
        let mut bulged = 0.0;
        for row in 0..block.mesh.z.intervals() {
            for (right, normal) in [(false, -1.0), (true, 1.0)] {
                let integrals = [1.0, 1.0, -(2.0f64 / 3.0).sqrt()].map(|i| 0.5 * block.mesh.z.size(row) * i);
                for (degree, integral) in block.mesh.vertical_degrees(row, right).into_iter().zip(integrals) {
                    if degree < block.mesh.free {
                        bulged += normal * integral * pressed[(2 * degree, 0)] / shear_modulus;
                    }
                }
            }
        }
        let modulus = shear_modulus * (3.0 * block.properties.lambda_over_shear() + 2.0);
        let expected = modulus * (bulged - pushed_in);
        assert!(swept < 0.0 && (swept - expected).abs() < 1e-5 * swept.abs(), "{swept} {expected}");
    }

    #[test]
    fn blocks_of_different_mesh_are_refused() {
        let (block, _) = pair(2.0, 0.3);
        let (_, thermal) = pair(3.0, 0.3);
        let fields = Mat::zeros(thermal.degrees(), 1);
        let refused = block.thermal_distortion(&thermal, &fields, &[-1.0, 1.0]);
        assert!(matches!(refused, Err(BlockError::DifferentMeshes { .. })));
    }
}
