//! Heat in the punch by unreduced finite elements: the reference of its reduction.
//!
//! Theory: docs/theory.md, section 4.8.

use elasticity::Cells;
use elasticity::block::{Block, BlockProperties, Discretization, ThermalBlock, ThermalProperties};
use faer::Mat;
use nalgebra::DMatrix;
use numerics::sdirk::GAMMA;
use scene::Scene;

/// Layers of elements towards the edges beyond those for the pressure: the mean temperature of an edge cell needs elements
/// that are small against it.
const MORE_LAYERS: usize = 3;

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The punch of a scene on a mesh, and its temperature field.
pub struct Unreduced {
    block: ThermalBlock,
    /// The same mesh for elasticity.
    pub elastic: Block,
    expansion: f64,
    boundaries: Vec<f64>,
    loads: Mat<f64>,
    unresolved: DMatrix<f64>,
    field: Mat<f64>,
}

impl Unreduced {
    /// The punch at the reference temperature.
    ///
    /// # Errors
    /// The mesh is refused.
    pub fn new(scene: &Scene, cells: &Cells) -> Result<Unreduced, String> {
        let (body, width) = (&scene.punch, 2.0 * cells.half_width());
        let boundaries = cells.edges().to_vec();
        let coarse = Discretization::for_cells(width, body.height, &boundaries, 1e-4);
        let discretization = Discretization { contact_layers: coarse.contact_layers + MORE_LAYERS, ..coarse };
        let properties = ThermalProperties {
            width,
            height: body.height,
            conductivity: body.conductivity,
            volumetric_heat_capacity: body.capacity(),
            side_convection: body.convection,
            top: body.far_boundary(),
        };
        let mechanical = BlockProperties {
            width,
            height: body.height,
            youngs_modulus: body.youngs_modulus,
            poissons_ratio: body.poissons_ratio,
        };
        let block = ThermalBlock::new(properties, discretization).map_err(text)?;
        let loads = block.flux_loads(&boundaries).map_err(text)?;
        let unresolved = block.unresolved_response(&boundaries).map_err(text)?;
        let field = Mat::zeros(block.degrees(), 1);
        let elastic = Block::new(mechanical, discretization).map_err(text)?;
        Ok(Unreduced { block, elastic, expansion: body.thermal_expansion, boundaries, loads, unresolved, field })
    }

    fn load(&self, flux: &[f64]) -> Mat<f64> {
        Mat::from_fn(self.block.degrees(), 1, |i, _| (0..flux.len()).map(|j| self.loads[(i, j)] * flux[j]).sum())
    }

    /// `count` steps of the two-stage method with the line's abscissae, with the flux as a function of time.
    ///
    /// # Errors
    /// The factorisation fails.
    pub fn run(&mut self, start: f64, step: f64, count: usize, flux: &dyn Fn(f64) -> Vec<f64>) -> Result<(), String> {
        let shift = 1.0 / (GAMMA * step);
        let factor = self.block.factorize(shift).map_err(text)?;
        for i in 0..count {
            let time = start + step * i as f64;
            let kept = self.block.apply_capacity(&self.field) * faer::Scale(shift);
            let mut first = &kept + self.load(&flux(time + GAMMA * step));
            self.block.solve_in_place(&factor, &mut first).map_err(text)?;
            // T_end = T + (1 - gamma)/gamma (T_first - T) + gamma h dT_end/dt.
            let part = (1.0 - GAMMA) / GAMMA;
            let start = &self.field + (&first - &self.field) * faer::Scale(part);
            let mut end = self.block.apply_capacity(&start) * faer::Scale(shift) + self.load(&flux(time + step));
            self.block.solve_in_place(&factor, &mut end).map_err(text)?;
            self.field = end;
        }
        Ok(())
    }

    /// Sets the field to the steady state under a flux.
    ///
    /// # Errors
    /// The factorisation fails.
    pub fn rest(&mut self, flux: &[f64]) -> Result<(), String> {
        self.field = self.load(flux);
        let factor = self.block.factorize(0.0).map_err(text)?;
        self.block.solve_in_place(&factor, &mut self.field).map_err(text)
    }

    /// Mean temperatures of the cells under the present flux.
    ///
    /// # Errors
    /// The boundaries are refused by the mesh.
    pub fn temperature(&self, flux: &[f64]) -> Result<Vec<f64>, String> {
        let means = self.block.contact_temperatures(&self.boundaries, &self.field).map_err(text)?;
        let local = |i: usize| (0..flux.len()).map(|j| self.unresolved[(i, j)] * flux[j]).sum::<f64>();
        Ok((0..flux.len()).map(|i| means[(i, 0)] + local(i)).collect())
    }

    /// Mean displacements of the cells, m into the body.
    ///
    /// # Errors
    /// The boundaries are refused by the mesh.
    pub fn distortion(&self) -> Result<Vec<f64>, String> {
        let means = self.elastic.thermal_distortion(&self.block, &self.field, &self.boundaries).map_err(text)?;
        Ok(means.iter().map(|mean| self.expansion * mean).collect())
    }
}
