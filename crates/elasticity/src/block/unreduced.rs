//! Operators of the block for unreduced temperature fields: distortion by any field, and the heat flow through its faces.
//!
//! Theory: docs/theory.md, sections 4.8, 4.9.

use super::boundary::{contact_cells, contact_integrals, side_loads};
use super::element::{Shape, dilatation};
use super::lobatto::ReferenceMatrices;
use super::mechanical::Block;
use super::thermal::ThermalBlock;
use super::{BlockError, check_same_mesh};
use faer::Mat;
use nalgebra::DMatrix;
use scene::FarBoundary;

/// Heat per unit depth that leaves through a held top [W/m]: `by_field` times the temperatures, less `by_outside` times the
/// temperature of the surroundings, both relative to the top's.
#[derive(Clone, Debug)]
pub struct TopOutflow {
    /// Weights of the temperatures, n x 1 [W/(m K)].
    pub by_field: Mat<f64>,
    /// Weight of the temperature of the surroundings [W/(m K)].
    pub by_outside: f64,
}

impl ThermalBlock {
    /// Uniform temperature 1, except at a held top, n x 1.
    pub fn uniform_field(&self) -> Mat<f64> {
        let mut field = Mat::zeros(self.degrees(), 1);
        for element in 0..self.mesh.elements() {
            // The first four local functions are those of the vertices and sum to 1.
            for degree in self.local_degrees(element).into_iter().take(4).flatten() {
                field[(degree, 0)] = 1.0;
            }
        }
        field
    }

    /// Integrals of the shape functions over both sides, n x 1, m.
    pub fn side_integrals(&self) -> Mat<f64> {
        let sides = side_loads(&self.mesh, 1, |_, _, _| [1.0]);
        Mat::from_fn(self.degrees(), 1, |i, _| if i < self.mesh.free { sides[(i, 0)] } else { 0.0 })
    }

    /// Integrals of the shape functions over each cell, by cell: (degree of freedom, integral, m).
    ///
    /// # Errors
    /// Boundaries that do not ascend or do not span the contact.
    pub fn cell_integrals(&self, boundaries: &[f64]) -> Result<Vec<Vec<(usize, f64)>>, BlockError> {
        Ok(contact_integrals(&self.mesh, &contact_cells(self.properties.width, boundaries)?))
    }

    /// The reaction of a held top to a field at rest: the residual of the equation tested with the function that is 1 at the
    /// top and 0 below its row of elements. None where the top is not held.
    pub fn top_outflow(&self) -> Option<TopOutflow> {
        if self.properties.top != FarBoundary::Held {
            return None;
        }
        let mut outflow = TopOutflow { by_field: Mat::zeros(self.degrees(), 1), by_outside: 0.0 };
        let last = self.mesh.z.intervals() - 1;
        // The third and the fourth local function are those of the upper vertices.
        let mut add = |element: usize, matrix: &DMatrix<f64>| {
            for (j, degree) in self.local_degrees(element).into_iter().take(matrix.ncols()).enumerate() {
                if let Some(degree) = degree {
                    outflow.by_field[(degree, 0)] -= matrix[(2, j)] + matrix[(3, j)];
                }
            }
        };
        for element in (0..self.mesh.elements()).filter(|&element| self.mesh.column_and_row(element).1 == last) {
            add(element, &self.conduction[self.kind[element]]);
        }
        for (element, matrix) in &self.convection {
            if self.mesh.column_and_row(*element).1 == last {
                add(*element, matrix);
            }
        }
        outflow.by_outside = -self.properties.side_convection * self.mesh.z.size(last);
        Some(outflow)
    }
}

impl Block {
    /// Mean normal displacement over each cell per unit thermal expansion coefficient by unit values of each degree of
    /// freedom of `thermal`, n x N [m/K]: by Betti's theorem the thermal stress times the dilatation under unit pressure on
    /// the cell.
    ///
    /// # Errors
    /// The two blocks differ in shape or discretisation; boundaries that do not ascend or do not span the contact.
    pub fn distortion_operator(&self, thermal: &ThermalBlock, boundaries: &[f64]) -> Result<Mat<f64>, BlockError> {
        check_same_mesh(&self.mesh, &thermal.mesh)?;
        let cells = contact_cells(self.properties.width, boundaries)?;
        let mut pressed = Mat::zeros(self.degrees(), cells.len());
        for (cell, integrals) in contact_integrals(&self.mesh, &cells).into_iter().enumerate() {
            for (degree, integral) in integrals {
                pressed[(2 * degree + 1, cell)] += integral / (cells[cell].1 - cells[cell].0);
            }
        }
        self.solve_in_place(&mut pressed)?;
        let factor = 3.0 * self.properties.lambda_over_shear() + 2.0;
        let order = self.mesh.x.orders.iter().chain(&self.mesh.z.orders).copied().max().unwrap_or(1);
        let reference = ReferenceMatrices::new(order);
        let (shapes, shape_of) = self.mesh.distinct_shapes(Shape::congruent);
        let dilatations: Vec<DMatrix<f64>> =
            shapes.iter().map(|&shape| factor * dilatation(&reference, shape)).collect();
        let mut operator = Mat::zeros(thermal.degrees(), cells.len());
        for element in 0..self.mesh.elements() {
            let displacement = self.element_displacement(element, &pressed);
            let product = dilatations[shape_of[element]].tr_mul(&displacement);
            for (i, degree) in thermal.local_degrees(element).into_iter().enumerate() {
                if let Some(degree) = degree {
                    for cell in 0..cells.len() {
                        operator[(degree, cell)] += product[(i, cell)];
                    }
                }
            }
        }
        Ok(operator)
    }

    /// Displacements `solutions` (columns) in an element: local functions, components alternating.
    fn element_displacement(&self, element: usize, solutions: &Mat<f64>) -> DMatrix<f64> {
        let (column, row) = self.mesh.column_and_row(element);
        let degrees = self.mesh.element_degrees(column, row);
        let Shape { order_x, order_z, .. } = self.mesh.shape(element);
        let (skeleton, all) = (2 * degrees.len(), 2 * (order_x + 1) * (order_z + 1));
        let mut local = DMatrix::from_fn(all, solutions.ncols(), |i, k| match degrees.get(i / 2) {
            Some(&degree) if degree < self.mesh.free => solutions[(2 * degree + i % 2, k)],
            _ => 0.0,
        });
        let mut interior = DMatrix::zeros(all - skeleton, solutions.ncols());
        self.elements[self.kind[element]].recover(&local.rows(0, skeleton).into_owned(), &mut interior);
        local.rows_mut(skeleton, all - skeleton).copy_from(&interior);
        local
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BlockProperties, Discretization, ThermalProperties};
    use super::*;

    fn boundaries() -> Vec<f64> {
        [-1.0, -0.7, -0.1, 0.2, 0.9, 1.0].to_vec()
    }

    fn pair(top: FarBoundary) -> (Block, ThermalBlock) {
        let discretization = Discretization::uniform(4, 3);
        let elastic = BlockProperties { width: 2.0, height: 1.3, youngs_modulus: 3.0, poissons_ratio: 0.3 };
        let thermal = ThermalProperties {
            width: 2.0,
            height: 1.3,
            conductivity: 2.0,
            volumetric_heat_capacity: 1.5,
            side_convection: 0.7,
            top,
        };
        (Block::new(elastic, discretization).unwrap(), ThermalBlock::new(thermal, discretization).unwrap())
    }

    #[test]
    fn operator_is_the_distortion_by_every_field() {
        for top in [FarBoundary::Held, FarBoundary::Convecting(0.4)] {
            let (block, thermal) = pair(top);
            let fields = Mat::from_fn(thermal.degrees(), 3, |i, k| ((5 * i + 3 * k) % 17) as f64 - 8.0);
            let expected = block.thermal_distortion(&thermal, &fields, &boundaries()).unwrap();
            let operator = block.distortion_operator(&thermal, &boundaries()).unwrap();
            let found = operator.transpose() * &fields;
            for i in 0..5 {
                for k in 0..3 {
                    assert!((found[(i, k)] - expected[(i, k)]).abs() < 1e-10 * expected.amax(), "{top:?} {i} {k}");
                }
            }
        }
    }

    #[test]
    fn at_rest_the_faces_pass_on_what_enters() {
        let (_, thermal) = pair(FarBoundary::Held);
        let mut field = thermal.flux_loads(&boundaries()).unwrap();
        let outside = 0.3;
        let sides = thermal.side_integrals();
        for i in 0..thermal.degrees() {
            field[(i, 2)] += 0.7 * outside * sides[(i, 0)];
        }
        thermal.solve_in_place(&thermal.factorize(0.0).unwrap(), &mut field).unwrap();
        let outflow = thermal.top_outflow().unwrap();
        let flow =
            |weights: &Mat<f64>, k: usize| (0..thermal.degrees()).map(|i| weights[(i, 0)] * field[(i, k)]).sum::<f64>();
        for (k, cell) in boundaries().windows(2).enumerate() {
            let outside = if k == 2 { outside } else { 0.0 };
            let beside = 0.7 * (flow(&sides, k) - 2.0 * 1.3 * outside);
            let above = flow(&outflow.by_field, k) - outflow.by_outside * outside;
            assert!((beside + above - (cell[1] - cell[0])).abs() < 1e-10, "{k}: {beside} {above}");
        }
        let uniform = thermal.uniform_field();
        assert!((flow(&sides, 0) != 0.0) && (0..thermal.degrees()).all(|i| [0.0, 1.0].contains(&uniform[(i, 0)])));
        assert!(pair(FarBoundary::Convecting(1.0)).1.top_outflow().is_none());
    }
}
