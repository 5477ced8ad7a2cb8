//! Finite-element operators of a punch: loads, solutions of both stages, and observations of a field.
//!
//! Theory: docs/theory.md, section 4.8.

use crate::line::{Boundary, FACES, FaceInfluence, GAMMA, SurfaceInfluence, Surroundings};
use elasticity::block::{BlockError, ThermalBlock, ThermalFactor, ThermalProperties, ThermalWorkspace};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, Par};
use nalgebra::DMatrix;
use scene::FarBoundary;
use std::fmt;

/// Number of state entries behind the temperatures: heat received, lost to the air, lost through the top (J/m), and
/// temperature of the top.
pub const TALLIES: usize = 4;

/// Operators that follow from the scene. Vectors over the unknowns hold one number for each.
pub struct FieldOperators {
    pub block: ThermalBlock,
    pub widths: Vec<f64>,
    /// Integrals of the shape functions over the cells.
    pub cells: Vec<Vec<(usize, f64)>>,
    pub unresolved: DMatrix<f64>,
    /// Displacement into the body per unit of the unknowns, n x N, and per 1 K of uniform temperature, m/K; None without
    /// expansion.
    pub distortion: Option<(Mat<f64>, Vec<f64>)>,
    pub uniform: Vec<f64>,
    pub capacity: Vec<f64>,
    pub sides: Vec<f64>,
    pub top: Vec<f64>,
    /// Integrals of the shape functions over the top; zero where its temperature is prescribed.
    pub far_face: Vec<f64>,
    /// Heat flow out of a top of prescribed temperature, per unit of the unknowns and per temperature of the surroundings;
    /// see [`ThermalBlock::top_outflow`].
    pub outflow: Option<(Vec<f64>, f64)>,
    pub properties: ThermalProperties,
    /// Ratio of the cooled area to that of the two sides.
    pub cooled: f64,
    /// Heat capacity of the whole body, J/(m K).
    pub total_capacity: f64,
}

impl fmt::Debug for FieldOperators {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Operators").field("cells", &self.widths.len()).field("degrees", &self.degrees()).finish()
    }
}

/// Factor and surface influence matrices of one step size; allocated with a step of NaN until first used.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub step: f64,
    pub euler: bool,
    pub factor: ThermalFactor,
    pub influence: SurfaceInfluence,
    /// Responses to unit fluxes into the cooled faces.
    pub faces: [FaceInfluence; FACES],
}

impl Prepared {
    pub fn empty(operators: &FieldOperators) -> Prepared {
        let count = operators.widths.len();
        Prepared {
            step: f64::NAN,
            euler: false,
            factor: operators.block.empty_factor(),
            influence: SurfaceInfluence {
                temperature: DMatrix::zeros(count, count),
                distortion: DMatrix::zeros(count, count),
            },
            faces: [FaceInfluence::new(count), FaceInfluence::new(count)],
        }
    }
}

/// Workspace of a step.
#[derive(Debug)]
pub struct FieldWorkspace {
    pub workspace: ThermalWorkspace,
    /// Responses to unit fluxes, n x N.
    pub responses: Mat<f64>,
    pub means: Vec<f64>,
    /// Fields at the start, of the first stage, and of the second.
    pub start: Vec<f64>,
    pub early: Vec<f64>,
    pub late: Vec<f64>,
}

impl FieldWorkspace {
    pub fn new(operators: &FieldOperators) -> Result<FieldWorkspace, BlockError> {
        let (degrees, count) = (operators.degrees(), operators.widths.len());
        let field = || vec![0.0; degrees];
        Ok(FieldWorkspace {
            workspace: operators.block.workspace(count)?,
            responses: Mat::zeros(degrees, count),
            means: vec![0.0; count],
            start: field(),
            early: field(),
            late: field(),
        })
    }
}

pub fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

impl FieldOperators {
    pub fn degrees(&self) -> usize {
        self.block.degrees()
    }

    pub fn held(&self) -> bool {
        self.properties.top == FarBoundary::Held
    }

    /// Offset temperature of the unknowns, K.
    pub fn origin(&self, around: &Boundary) -> f64 {
        if self.held() { around.far } else { 0.0 }
    }

    /// Unknowns of a state relative to `origin`.
    pub fn field(&self, state: &[f64], origin: f64, field: &mut [f64]) {
        for ((field, state), uniform) in field.iter_mut().zip(state).zip(&self.uniform) {
            *field = state - origin * uniform;
        }
    }

    /// Load vector F q + ports.
    fn load(&self, flux: Option<&[f64]>, around: &Boundary, load: &mut [f64]) {
        let outside = around.ambient - self.origin(around);
        let beside = self.properties.side_convection * outside + self.cooled * around.cooling;
        for ((load, side), top) in load.iter_mut().zip(&self.sides).zip(&self.top) {
            *load = side * beside + top * outside;
        }
        if !self.held() && around.far != 0.0 {
            load.iter_mut().zip(&self.far_face).for_each(|(load, face)| *load += face * around.far);
        }
        if let Some(flux) = flux {
            for (integrals, flux) in self.cells.iter().zip(flux) {
                integrals.iter().for_each(|&(degree, integral)| load[degree] += integral * flux);
            }
        }
    }

    /// Mean temperatures of the cells relative to the origin, without the part that the elements do not resolve.
    pub fn means(&self, field: &[f64], target: &mut [f64]) {
        for ((target, integrals), width) in target.iter_mut().zip(&self.cells).zip(&self.widths) {
            *target = integrals.iter().map(|&(degree, integral)| integral * field[degree]).sum::<f64>() / width;
        }
    }

    pub fn distort(&self, field: &[f64], origin: f64, target: &mut [f64]) {
        match &self.distortion {
            None => target.fill(0.0),
            Some((by_field, uniform)) => {
                for (j, target) in target.iter_mut().enumerate() {
                    let moved: f64 = by_field.col(j).iter().zip(field).map(|(d, t)| d * t).sum();
                    *target = moved + origin * uniform[j];
                }
            }
        }
    }

    pub fn observe(&self, field: &[f64], origin: f64, temperature: &mut [f64], distortion: &mut [f64]) {
        self.means(field, temperature);
        temperature.iter_mut().for_each(|mean| *mean += origin);
        self.distort(field, origin, distortion);
    }

    /// Heat flow to the air through the sides, W/m, without the flux `cooling`.
    pub fn ambient_flow(&self, field: &[f64], around: &Boundary) -> f64 {
        let outside = around.ambient - self.origin(around);
        let length = 2.0 * self.properties.height;
        self.properties.side_convection * (dot(&self.sides, field) - length * outside)
    }

    /// Heat stored by the unknowns.
    fn stored_by(&self, field: &[f64]) -> f64 {
        dot(&self.capacity, field)
    }

    pub fn stored(&self, state: &[f64]) -> f64 {
        let free = self.stored_by(state);
        if self.held() {
            let beyond = self.total_capacity - dot(&self.capacity, &self.uniform);
            free + beyond * state[self.degrees() + TALLIES - 1]
        } else {
            free
        }
    }

    /// Shift 1/(gamma h), 1/s, common to all stages; bounded below so that the matrix of a body without heat loss is definite.
    fn shift(&self, step: f64, euler: bool) -> f64 {
        let ThermalProperties { height, conductivity, volumetric_heat_capacity, .. } = self.properties;
        let slowest = conductivity / volumetric_heat_capacity / (height * height);
        (if euler { step } else { GAMMA * step }).recip().max(1e-10 * slowest)
    }

    pub fn prepare(
        &self,
        step: f64,
        euler: bool,
        prepared: &mut Prepared,
        room: &mut FieldWorkspace,
    ) -> Result<(), BlockError> {
        self.block.factorize_into(&mut prepared.factor, self.shift(step, euler), &mut room.workspace)?;
        let responses = &mut room.responses;
        responses.fill(0.0);
        for (cell, integrals) in self.cells.iter().enumerate() {
            integrals.iter().for_each(|&(degree, integral)| responses[(degree, cell)] += integral);
        }
        self.block.solve_in_workspace(&prepared.factor, responses.as_mut(), &mut room.workspace);
        let SurfaceInfluence { temperature, distortion } = &mut prepared.influence;
        temperature.copy_from(&self.unresolved);
        for (cell, response) in responses.col_iter().enumerate() {
            // Columns of a faer matrix are contiguous.
            let Some(response) = response.try_as_col_major() else { continue };
            self.means(response.as_slice(), &mut room.means);
            temperature.column_mut(cell).iter_mut().zip(&room.means).for_each(|(gain, mean)| *gain += mean);
        }
        if let Some((by_field, _)) = &self.distortion {
            let count = self.widths.len();
            let target = MatMut::from_column_major_slice_mut(distortion.as_mut_slice(), count, count);
            matmul(target, Accum::Replace, by_field.transpose(), responses.as_ref(), 1.0, Par::Seq);
        }
        let rows = prepared.faces.each_mut().map(|face| &mut face.by_cell);
        let [beside, far] = rows;
        for ((beside, far), response) in beside.iter_mut().zip(far).zip(responses.col_iter()) {
            let Some(response) = response.try_as_col_major() else { continue };
            [*beside, *far] = self.cooled_means(response.as_slice());
        }
        (prepared.step, prepared.euler) = (step, euler);
        let FieldWorkspace { workspace, start, late, .. } = room;
        let mut faces = std::mem::replace(&mut prepared.faces, [FaceInfluence::new(0), FaceInfluence::new(0)]);
        for (face, influence) in faces.iter_mut().enumerate().take(if self.held() { 1 } else { FACES }) {
            let mut flux = [0.0; FACES];
            flux[face] = 1.0;
            start.fill(0.0);
            self.solve(prepared, start, None, &Boundary::default().with_fluxes(flux, false), workspace, late);
            influence.faces = self.cooled_means(late);
            influence.mean = self.stored_by(late) / self.total_capacity;
            self.observe(late, 0.0, &mut influence.temperature, &mut influence.distortion);
        }
        prepared.faces = faces;
        Ok(())
    }

    /// Solutions of both stages from `start`, which is overwritten, with the fluxes of both.
    pub fn solve_both(
        &self,
        prepared: &Prepared,
        start: &mut [f64],
        fluxes: Option<[&[f64]; 2]>,
        surroundings: &Surroundings,
        workspace: &mut ThermalWorkspace,
        [early, late]: [&mut [f64]; 2],
    ) {
        self.solve(prepared, start, fluxes.map(|[first, _]| first), &surroundings.first, workspace, early);
        if prepared.euler {
            return late.copy_from_slice(early);
        }
        self.extrapolate(start, early, surroundings);
        self.solve(prepared, start, fluxes.map(|[_, end]| end), &surroundings.end, workspace, late);
    }

    /// Mean temperatures of the sides and of the top relative to the origin.
    pub fn cooled_means(&self, field: &[f64]) -> [f64; FACES] {
        let ThermalProperties { width, height, .. } = self.properties;
        [dot(&self.sides, field) / (2.0 * height), dot(&self.far_face, field) / width]
    }

    /// Length of the top with a prescribed flux, m; 0 where its temperature is prescribed.
    pub fn top_width(&self) -> f64 {
        if self.held() { 0.0 } else { self.properties.width }
    }

    /// Solution of one stage from `start`.
    pub fn solve(
        &self,
        prepared: &Prepared,
        start: &[f64],
        flux: Option<&[f64]>,
        around: &Boundary,
        workspace: &mut ThermalWorkspace,
        field: &mut [f64],
    ) {
        self.load(flux, around, field);
        self.block.add_capacity(self.shift(prepared.step, prepared.euler), start, field, workspace);
        let loads = MatMut::from_column_major_slice_mut(field, self.degrees(), 1);
        self.block.solve_in_workspace(&prepared.factor, loads, workspace);
    }

    /// Overwrites the start, relative to the origin of the first stage, with the right-hand-side field of the second one relative
    /// to its own, T_0 + (1 - gamma)/gamma (T_1 - T_0).
    pub fn extrapolate(&self, start: &mut [f64], first: &[f64], surroundings: &Surroundings) {
        let moved = self.origin(&surroundings.first) - self.origin(&surroundings.end);
        for ((start, first), uniform) in start.iter_mut().zip(first).zip(&self.uniform) {
            *start += (first - *start) * ((1.0 - GAMMA) / GAMMA) + moved * uniform;
        }
    }
}
