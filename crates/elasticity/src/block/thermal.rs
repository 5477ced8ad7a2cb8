//! Heat conduction in the block on the same kind of mesh as its elasticity.
//!
//! Per unit depth, with temperatures T measured from a reference that the caller chooses:
//!
//! ```text
//! M dT/dt + K T = F q + f_side T_ambient + f_top T_outside
//! M: int rho c T v      K: int k grad T . grad v + int_sides h T v + int_top h_top T v
//! F: one column per contact cell, int_cell v (heat flux q into the body [W/m2])
//! f_side: int_sides h v    f_top: int_top h_top v
//! ```
//!
//! A held top is T = 0 there; where the prescribed temperature varies, T is relative to it, f_side has the ambient
//! temperature relative to it as well, and its rate enters as -M 1 dT_top/dt.
//!
//! Vectors hold the free skeleton's degrees of freedom (vertices and edges), then the interior modes element by element.
//!
//! Theory: docs/theory.md, section 4.8.

use super::boundary::{contact_cells, contact_integrals, side_loads, top_values};
use super::condense::Pattern;
use super::element::{Shape, capacity, conduction, local_functions};
use super::half_plane::ConductingHalfPlane;
use super::lobatto::ReferenceMatrices;
use super::mesh::Mesh;
use super::{BlockError, Discretization, check_dimensions, check_positive};
use faer::Mat;
use nalgebra::DMatrix;
use scene::FarBoundary;

/// Shape and thermal properties of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalProperties {
    /// Extent along the sliding direction, m, > 0.
    pub width: f64,
    /// Extent from the contact to the holder, m, > 0.
    pub height: f64,
    /// Conductivity k [W/(m K)], > 0.
    pub conductivity: f64,
    /// Density times specific heat, rho c [J/(m3 K)], > 0.
    pub volumetric_heat_capacity: f64,
    /// Convection h at the two sides [W/(m2 K)], >= 0.
    pub side_convection: f64,
    /// Condition at the top.
    pub top: FarBoundary,
}

impl ThermalProperties {
    fn check(&self) -> Result<(), BlockError> {
        check_dimensions(self.width, self.height)?;
        check_positive(&[
            ("conductivity", self.conductivity),
            ("volumetric_heat_capacity", self.volumetric_heat_capacity),
        ])?;
        for (name, value) in [("side_convection", self.side_convection), ("top_convection", self.top_convection())] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(BlockError::OutOfRange { name, value, limit: "at least 0 and finite" });
            }
        }
        Ok(())
    }

    pub(super) fn top_convection(&self) -> f64 {
        self.top.transfer()
    }
}

/// A conducting block.
#[derive(Debug)]
pub struct ThermalBlock {
    pub(super) properties: ThermalProperties,
    discretization: Discretization,
    pub(super) mesh: Mesh,
    pub(super) pattern: Pattern,
    /// Distinct element matrices K (without convection) and M, and the index of each element's.
    pub(super) conduction: Vec<DMatrix<f64>>,
    pub(super) capacity: Vec<DMatrix<f64>>,
    pub(super) kind: Vec<usize>,
    /// Convection per unit temperature: (element, matrix on its skeleton).
    pub(super) convection: Vec<(usize, DMatrix<f64>)>,
    /// Skeleton degrees of freedom of all elements, concatenated; [`ThermalBlock::skeleton`].
    pub(super) skeletons: Vec<usize>,
}

impl ThermalBlock {
    /// Meshes the block and computes its element matrices.
    ///
    /// # Errors
    /// A property or discretisation outside its range, named with its limit.
    pub fn new(properties: ThermalProperties, discretization: Discretization) -> Result<Self, BlockError> {
        properties.check()?;
        discretization.check()?;
        let (x, z) = discretization.grids(properties.width, properties.height);
        let mesh = Mesh::new(x, z, properties.top == FarBoundary::Held);
        let pattern = Pattern::new(&mesh, 1).map_err(|reason| BlockError::Factorization {
            quantity: "conduction",
            degrees: mesh.free,
            reason,
        })?;
        let reference = ReferenceMatrices::new(discretization.order);
        let (shapes, kind) = mesh.distinct_shapes(Shape::congruent);
        let conduction = shapes.iter().map(|&shape| conduction(&reference, shape, properties.conductivity)).collect();
        let capacity =
            shapes.iter().map(|&shape| capacity(&reference, shape, properties.volumetric_heat_capacity)).collect();
        let convection = convection(&mesh, &reference, properties.side_convection, properties.top_convection());
        let skeletons = (0..mesh.elements())
            .flat_map(|element| {
                let (column, row) = mesh.column_and_row(element);
                mesh.element_degrees(column, row)
            })
            .collect();
        Ok(Self { properties, discretization, mesh, pattern, conduction, capacity, kind, convection, skeletons })
    }

    /// Length of a vector of temperatures: free skeleton and interiors.
    pub fn degrees(&self) -> usize {
        self.mesh.free + self.mesh.interior_total()
    }

    /// Position in a vector of each local function of element `element`; None where the temperature is held.
    pub(super) fn local_degrees(&self, element: usize) -> Vec<Option<usize>> {
        let (column, row) = self.mesh.column_and_row(element);
        let skeleton = self.mesh.element_degrees(column, row).into_iter();
        let interior = self.mesh.interior(element).map(|mode| Some(self.mesh.free + mode));
        skeleton.map(|degree| (degree < self.mesh.free).then_some(degree)).chain(interior).collect()
    }

    /// F: heat per unit depth into each degree of freedom by unit flux on each cell, m.
    pub fn flux_loads(&self, boundaries: &[f64]) -> Result<Mat<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let mut loads = Mat::zeros(self.degrees(), cells.len());
        for (j, integrals) in contact_integrals(&self.mesh, &cells).into_iter().enumerate() {
            for (degree, integral) in integrals {
                loads[(degree, j)] += integral;
            }
        }
        Ok(loads)
    }

    /// Mean temperature over each cell of each column of `fields`, N x columns, K.
    pub fn contact_temperatures(&self, boundaries: &[f64], fields: &Mat<f64>) -> Result<DMatrix<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let integrals = contact_integrals(&self.mesh, &cells);
        Ok(DMatrix::from_fn(cells.len(), fields.ncols(), |i, j| {
            let sum: f64 = integrals[i].iter().map(|&(degree, integral)| integral * fields[(degree, j)]).sum();
            sum / (cells[i].1 - cells[i].0)
        }))
    }

    /// M times each column of `fields`.
    pub fn apply_capacity(&self, fields: &Mat<f64>) -> Mat<f64> {
        self.apply(&self.capacity, fields)
    }

    fn apply(&self, matrices: &[DMatrix<f64>], fields: &Mat<f64>) -> Mat<f64> {
        let mut result = Mat::zeros(self.degrees(), fields.ncols());
        for (element, &kind) in self.kind.iter().enumerate() {
            let degrees = self.local_degrees(element);
            let local =
                DMatrix::from_fn(degrees.len(), fields.ncols(), |i, k| degrees[i].map_or(0.0, |d| fields[(d, k)]));
            let product = &matrices[kind] * local;
            for (i, degree) in degrees.iter().enumerate() {
                if let Some(degree) = degree {
                    for k in 0..fields.ncols() {
                        result[(*degree, k)] += product[(i, k)];
                    }
                }
            }
        }
        result
    }

    /// Error of the finite elements in the contact's mean temperatures by a flux that is discontinuous between cells, N x N
    /// [m2 K/W]: the exact static response less F'K^-1 F over the cell widths.
    ///
    /// Polynomials resolve neither the jumps nor cells smaller than the elements. The unresolved part is local to the
    /// contact and so fast that it is quasi-steady: this matrix times the flux is added to the mean temperatures at any
    /// time. It is computed, as in the block's elasticity, from the half-plane and a smooth remainder, with the top held and
    /// the sides insulated, which have no effect on it.
    pub fn unresolved_response(&self, boundaries: &[f64]) -> Result<DMatrix<f64>, BlockError> {
        let cells = contact_cells(self.properties.width, boundaries)?;
        let held_top = ThermalProperties {
            conductivity: 1.0,
            volumetric_heat_capacity: 1.0,
            side_convection: 0.0,
            top: FarBoundary::Held,
            ..self.properties
        };
        let block = Self::new(held_top, self.discretization)?;
        let factor = block.factorize(0.0)?;
        let (half_width, z) = (0.5 * self.properties.width, self.properties.height);
        let half_plane = ConductingHalfPlane { scale: self.properties.width };
        let side = |j: usize, right: bool, z: f64| {
            let normal = if right { 1.0 } else { -1.0 };
            [-normal * half_plane.slope_along(cells[j], normal * half_width, z)]
        };
        let value = |j: usize, x: f64| [-half_plane.temperature(cells[j], x, z)];
        let slope = |j: usize, x: f64| [-half_plane.slope_along(cells[j], x, z)];
        let mut remainder = side_loads(&block.mesh, cells.len(), side);
        let held = top_values(&block.mesh, cells.len(), value, slope);
        block.pattern.subtract_held(&block.mesh, factor.elements(), &block.kind, &mut remainder, &held);
        let mut fields = block.on_whole_vector(remainder) - block.flux_loads(boundaries)?;
        block.solve_in_place(&factor, &mut fields)?;
        let elements = block.contact_temperatures(boundaries, &fields)?;
        let width = |i: usize| cells[i].1 - cells[i].0;
        let full = DMatrix::from_fn(cells.len(), cells.len(), |i, j| {
            half_plane.influence(cells[i], cells[j]) + width(i) * elements[(i, j)]
        });
        let scale = 0.5 / self.properties.conductivity;
        Ok(DMatrix::from_fn(cells.len(), cells.len(), |i, j| scale * (full[(i, j)] + full[(j, i)]) / width(i)))
    }

    fn on_whole_vector(&self, skeleton: Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.degrees(), skeleton.ncols(), |i, k| if i < self.mesh.free { skeleton[(i, k)] } else { 0.0 })
    }
}

/// Convection at the sides and the top as matrices on the skeletons of the elements there.
fn convection(mesh: &Mesh, reference: &ReferenceMatrices, sides: f64, top: f64) -> Vec<(usize, DMatrix<f64>)> {
    let last_column = mesh.x.intervals() - 1;
    let last_row = mesh.z.intervals() - 1;
    let mut result = Vec::new();
    for element in 0..mesh.elements() {
        let (column, row) = mesh.column_and_row(element);
        let shape = mesh.shape(element);
        let (functions, skeleton) = local_functions(shape.order_x, shape.order_z);
        let mut matrix = DMatrix::zeros(skeleton, skeleton);
        let mut add = |coefficient: f64, on_edge: &dyn Fn((usize, usize)) -> Option<usize>| {
            for (j, along_j) in functions[..skeleton].iter().enumerate().filter_map(|(j, &f)| Some((j, on_edge(f)?))) {
                for (i, along_i) in
                    functions[..skeleton].iter().enumerate().filter_map(|(i, &f)| Some((i, on_edge(f)?)))
                {
                    matrix[(i, j)] += coefficient * reference.mass[(along_i, along_j)];
                }
            }
        };
        if column == 0 && sides > 0.0 {
            add(0.5 * shape.size_z * sides, &|(a, b)| (a == 0).then_some(b));
        }
        if column == last_column && sides > 0.0 {
            add(0.5 * shape.size_z * sides, &|(a, b)| (a == 1).then_some(b));
        }
        if row == last_row && top > 0.0 {
            add(0.5 * shape.size_x * top, &|(a, b)| (b == 1).then_some(a));
        }
        if matrix.amax() > 0.0 {
            result.push((element, matrix));
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROPERTIES: ThermalProperties = ThermalProperties {
        width: 0.06,
        height: 0.1,
        conductivity: 55.0,
        volumetric_heat_capacity: 3.6e6,
        side_convection: 0.0,
        top: FarBoundary::Held,
    };

    fn cells(count: usize) -> Vec<f64> {
        let angle = |i: usize| std::f64::consts::PI * (i as f64 / count as f64 - 0.5);
        (0..=count).map(|i| 0.03 * angle(i).sin()).collect()
    }

    /// Contact temperatures of (K + shift M) T = F 1.
    fn by_uniform_flux(properties: ThermalProperties, shift: f64) -> DMatrix<f64> {
        let block = ThermalBlock::new(properties, Discretization::uniform(6, 4)).unwrap();
        let loads = block.flux_loads(&cells(7)).unwrap();
        let mut field = Mat::from_fn(block.degrees(), 1, |i, _| (0..7).map(|j| loads[(i, j)]).sum());
        block.solve_in_place(&block.factorize(shift).unwrap(), &mut field).unwrap();
        block.contact_temperatures(&cells(7), &field).unwrap()
    }

    #[test]
    fn one_dimensional_limits_are_exact() {
        let ThermalProperties { height, conductivity, volumetric_heat_capacity, .. } = PROPERTIES;
        let slab = height / conductivity;
        let held = by_uniform_flux(PROPERTIES, 0.0);
        assert!(held.iter().all(|mean| (mean - slab).abs() < 1e-11 * slab), "{held}");
        let cooled = by_uniform_flux(ThermalProperties { top: FarBoundary::Convecting(200.0), ..PROPERTIES }, 0.0);
        let expected = slab + 1.0 / 200.0;
        assert!(cooled.iter().all(|mean| (mean - expected).abs() < 1e-11 * expected), "{cooled}");
        // The faster the field, the thinner the heated layer against the elements.
        for (rate, bound) in [(0.001, 1e-10), (0.1, 1e-7), (2.0, 3e-5)] {
            let wave_number = (rate * volumetric_heat_capacity / conductivity).sqrt();
            let insulated = ThermalProperties { top: FarBoundary::Insulated, ..PROPERTIES };
            for (properties, factor) in
                [(PROPERTIES, (wave_number * height).tanh()), (insulated, 1.0 / (wave_number * height).tanh())]
            {
                let means = by_uniform_flux(properties, rate);
                let expected = factor / (conductivity * wave_number);
                assert!(means.iter().all(|mean| (mean - expected).abs() < bound * expected), "{rate}: {means}");
            }
        }
    }

    #[test]
    fn unresolved_response_completes_the_elements() {
        // The static means of cells much smaller than the elements, against a mesh that resolves them.
        let boundaries = [-0.03, -0.006, -0.005, -0.004, 0.014, 0.0141, 0.03];
        let means = |discretization: Discretization| {
            let block = ThermalBlock::new(PROPERTIES, discretization).unwrap();
            let mut field = block.flux_loads(&boundaries).unwrap();
            block.solve_in_place(&block.factorize(0.0).unwrap(), &mut field).unwrap();
            let plain = block.contact_temperatures(&boundaries, &field).unwrap();
            (plain.clone(), plain + block.unresolved_response(&boundaries).unwrap())
        };
        let (coarse, completed) = means(Discretization::uniform(5, 4));
        let (_, reference) = means(Discretization { grading: 0.3, ..Discretization::uniform(10, 8) });
        let scale = reference.amax();
        assert!((&completed - &reference).amax() < 5e-5 * scale, "{}", (&completed - &reference).amax() / scale);
        assert!((&coarse - &reference).amax() > 1e-2 * scale);
        // Two narrow cells far from the edges with opposite fluxes respond as on the half-plane.
        let local = |i: usize, j: usize| {
            let cell = |i: usize| (boundaries[i], boundaries[i + 1]);
            ConductingHalfPlane { scale: 0.06 }.influence(cell(i), cell(j)) / (0.001 * 55.0)
        };
        let found = completed[(1, 1)] - completed[(1, 2)] - completed[(2, 1)] + completed[(2, 2)];
        let expected = local(1, 1) - local(1, 2) - local(2, 1) + local(2, 2);
        assert!((found - expected).abs() < 2e-4 * expected, "{found} {expected}");
    }

    #[test]
    fn a_block_without_any_outlet_is_refused_at_rest() {
        let closed = ThermalProperties { top: FarBoundary::Insulated, ..PROPERTIES };
        let block = ThermalBlock::new(closed, Discretization::uniform(3, 2)).unwrap();
        assert!(matches!(block.factorize(0.0), Err(BlockError::Factorization { .. })));
        assert!(block.factorize(1e-3).is_ok());
        let message =
            |properties| ThermalBlock::new(properties, Discretization::uniform(3, 2)).unwrap_err().to_string();
        assert_eq!(
            message(ThermalProperties { side_convection: -1.0, ..PROPERTIES }),
            "side_convection = -1, must be at least 0 and finite"
        );
        assert!(message(ThermalProperties { conductivity: 0.0, ..PROPERTIES }).starts_with("conductivity = 0"));
    }
}
