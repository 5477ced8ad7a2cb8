//! Heat conduction in the punch by unreduced finite elements: the reference for the reduced punch.
//!
//! ```text
//! M dT/dt + K T = F q + ports
//! ```
//!
//! on the hp mesh of [`ThermalBlock`], graded to all four corners, with elements that are small against the smallest contact
//! cell. The time discretisation is that of the contact, SDIRK2 with the fluxes of the two stages,
//!
//! ```text
//! (K + M/(gamma h)) T_1 = M T_0/(gamma h) + F q_1 + ports
//! (K + M/(gamma h)) T_2 = M [T_0 + (1 - gamma)/gamma (T_1 - T_0)]/(gamma h) + F q_2 + ports
//! ```
//!
//! second order and L-stable (the deviation of the first stage's flux at its start is not used), with the heat input
//! `h [(1 - gamma) q_1 + gamma q_2]`. The sparse factor of a step size, and the surface influence matrices from N responses
//! to unit fluxes, are cached for the last few step sizes. The part of the response to fluxes discontinuous between cells
//! that the elements do not resolve is a direct feedthrough ([`ThermalBlock::unresolved_response`]).
//!
//! Cost: sparse solutions with thousands of unknowns per step, a factorisation and N more solutions per new step size. This
//! is a reference, not a level for long runs. All memory is allocated when the body is made (the matrix product has buffers
//! of its own per thread, allocated when it first runs there).
//!
//! Theory: docs/theory.md, section 4.8.

mod operators;

use super::{Account, FACES, FaceInfluence, GAMMA, Stage, SurfaceInfluence, Surroundings, ThermalBody};
use elasticity::Cells;
use elasticity::block::{Block, BlockError, BlockProperties, Discretization, ThermalBlock, ThermalProperties};
use faer::Mat;
use numerics::cache::KeyedCache;
use operators::{FieldOperators, FieldWorkspace, Prepared, TALLIES, dot};
use scene::{FarBoundary, Scene};
use std::cell::RefCell;
use std::sync::Arc;

/// Step sizes whose factors are kept.
const CAPACITY: usize = 4;

/// Layers of elements towards the contact's corners beyond those that elasticity needs: the mean temperature of an edge cell
/// needs elements that are small against it.
const EXTRA_LAYERS: usize = 3;

/// Accuracy of the mesh, see [`Discretization::for_cells`].
const MESH_TOLERANCE: f64 = 1e-4;

/// Punch with unreduced finite elements.
#[derive(Debug)]
pub struct FieldHeat {
    operators: Arc<FieldOperators>,
    /// By the bits of the step and whether it is one of implicit Euler.
    prepared: KeyedCache<(u64, bool), Prepared>,
    room: RefCell<FieldWorkspace>,
}

/// Unreduced punch of `scene`; None for an insulator.
///
/// # Errors
/// A block that is too flat or slender for its mesh, or of a Poisson's ratio out of range.
pub fn unreduced(scene: &Scene, cells: &Cells) -> Result<Option<FieldHeat>, BlockError> {
    let body = &scene.punch;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let (width, height) = (2.0 * cells.half_width(), body.height);
    let boundaries = cells.edges();
    let coarse = Discretization::for_cells(width, height, boundaries, MESH_TOLERANCE);
    let discretization = Discretization { contact_layers: coarse.contact_layers + EXTRA_LAYERS, ..coarse };
    let cooled = scene.punch_cooled_area() / (2.0 * height * scene.depth * scene.count);
    let properties = ThermalProperties {
        width,
        height,
        conductivity: body.conductivity,
        volumetric_heat_capacity: body.capacity(),
        side_convection: body.convection * cooled,
        top: body.far_boundary(),
    };
    let block = ThermalBlock::new(properties, discretization)?;
    let distortion = if body.thermal_expansion > 0.0 {
        // Stiffness does not affect the thermal distortion of a traction-free surface.
        let elastic = BlockProperties { width, height, youngs_modulus: 1.0, poissons_ratio: body.poissons_ratio };
        let elastic = Block::new(elastic, discretization)?;
        let by_field = elastic.distortion_operator(&block, boundaries)? * faer::Scale(body.thermal_expansion);
        let uniform = elastic.uniform_distortion(boundaries)?;
        Some((by_field, uniform.iter().map(|moved| body.thermal_expansion * moved).collect()))
    } else {
        None
    };
    let operators = FieldOperators {
        widths: cells.widths().to_vec(),
        cells: block.cell_integrals(boundaries)?,
        unresolved: block.unresolved_response(boundaries)?,
        distortion,
        uniform: vector(&block.uniform_field()),
        capacity: vector(&block.uniform_capacity()),
        sides: vector(&block.side_integrals()),
        top: vector(&block.top_load()),
        far_face: vector(&block.top_integrals()),
        outflow: block.top_outflow().map(|outflow| (vector(&outflow.by_field), outflow.by_outside)),
        properties,
        cooled,
        total_capacity: properties.volumetric_heat_capacity * width * height,
        block,
    };
    let room = FieldWorkspace::new(&operators)?;
    let prepared = KeyedCache::new((0..CAPACITY).map(|_| Prepared::empty(&operators)));
    Ok(Some(FieldHeat { operators: Arc::new(operators), prepared, room: RefCell::new(room) }))
}

/// The only column of a matrix.
fn vector(matrix: &Mat<f64>) -> Vec<f64> {
    matrix.col(0).iter().copied().collect()
}

impl FieldHeat {
    fn select(&mut self, step: f64, euler: bool) {
        let (operators, room) = (&self.operators, self.room.get_mut());
        self.prepared.get_or_compute((step.to_bits(), euler), |prepared| {
            // The shift keeps the matrix definite, so there is always a factor.
            operators
                .prepare(step, euler, prepared, room)
                .unwrap_or_else(|error| panic!("punch, step of {step} s: {error}"));
        });
    }

    fn prepared(&self) -> &Prepared {
        self.prepared.latest().expect("prepare comes before any step")
    }

    /// Result of `observe` for the field of a state, given with the temperature offset of that field.
    fn of_state<T>(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        observe: impl FnOnce(&FieldOperators, &[f64], f64) -> T,
    ) -> T {
        let operators = &*self.operators;
        let origin = operators.origin(&surroundings.end);
        let room = &mut *self.room.borrow_mut();
        operators.field(state, origin, &mut room.start);
        observe(operators, &room.start, origin)
    }
}

impl ThermalBody for FieldHeat {
    fn cells(&self) -> usize {
        self.operators.widths.len()
    }

    fn states(&self) -> usize {
        self.operators.degrees() + TALLIES
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let (field, tallies) = state.split_at_mut(self.operators.degrees());
        field.iter_mut().zip(&self.operators.uniform).for_each(|(t, uniform)| *t = rise * uniform);
        tallies.fill(0.0);
        tallies[TALLIES - 1] = rise;
    }

    fn prepare(&mut self, step: f64, _velocity: [f64; 2]) {
        self.select(step, false);
    }

    fn prepare_euler(&mut self, step: f64, _velocity: [f64; 2]) {
        self.select(step, true);
    }

    fn influence(&self, _stage: Stage) -> &SurfaceInfluence {
        // Both stages share the matrix.
        &self.prepared().influence
    }

    fn face_influence(&self, _stage: Stage, face: usize, influence: &mut FaceInfluence) {
        // Both stages share the matrix.
        let own = &self.prepared().faces[face];
        influence.temperature.copy_from_slice(&own.temperature);
        influence.distortion.copy_from_slice(&own.distortion);
        influence.by_cell.copy_from_slice(&own.by_cell);
        (influence.faces, influence.mean) = (own.faces, own.mean);
    }

    fn free_response(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) -> [f64; FACES] {
        let (operators, prepared) = (&*self.operators, self.prepared());
        let around = surroundings.without_fluxes_at(stage, operators.held());
        let FieldWorkspace { workspace, start, early, late, .. } = &mut *self.room.borrow_mut();
        operators.field(state, operators.origin(&around.first), start);
        if stage == Stage::First || prepared.euler {
            operators.solve(prepared, start, None, around.at(stage), workspace, late);
        } else {
            operators.solve(prepared, start, Some(known), &around.first, workspace, early);
            operators.extrapolate(start, early, &around);
            operators.solve(prepared, start, None, &around.end, workspace, late);
        }
        let origin = operators.origin(around.at(stage));
        operators.observe(late, origin, temperature, distortion);
        operators.cooled_means(late).map(|mean| mean + origin)
    }

    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let (operators, prepared) = (&*self.operators, self.prepared());
        let (origin, step) = (operators.origin(&surroundings.end), prepared.step);
        let FieldWorkspace { workspace, start, early, late, .. } = &mut *self.room.borrow_mut();
        let before = operators.stored(state);
        operators.field(state, operators.origin(&surroundings.first), start);
        operators.solve_both(prepared, start, Some([first, end]), surroundings, workspace, [&mut *early, &mut *late]);
        let stages = [(&*early, &surroundings.first), (&*late, &surroundings.end)];
        let flows = stages.map(|(field, around)| operators.ambient_flow(field, around));
        let ambient = if prepared.euler { flows[1] } else { (1.0 - GAMMA) * flows[0] + GAMMA * flows[1] };
        let heat = |flux: &[f64]| flux.iter().zip(&operators.widths).map(|(q, c)| q * c).sum::<f64>();
        let received = step * ((1.0 - GAMMA) * heat(first) + GAMMA * heat(end));
        let length = 2.0 * operators.properties.height * operators.cooled;
        let lost = step * (ambient - length * surroundings.mean().cooling);
        let degrees = operators.degrees();
        for ((state, field), uniform) in state.iter_mut().zip(&*late).zip(&operators.uniform) {
            *state = field + origin * uniform;
        }
        state[degrees + 3] = surroundings.end.far;
        let gained = operators.stored(state) - before;
        let tallies = &mut state[degrees..];
        tallies[0] += received;
        tallies[1] += lost;
        // The far-face flow closes the heat balance; at an insulated top, rounding is assigned to the sides.
        let rest = received - gained - lost;
        let through_top = step * operators.top_width() * surroundings.mean().far;
        tallies[2] -= through_top;
        tallies[if operators.properties.top == FarBoundary::Insulated { 1 } else { 2 }] += rest + through_top;
    }

    fn temperature_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        _velocity: f64,
        temperature: &mut [f64],
    ) {
        self.of_state(state, surroundings, |operators, field, origin| {
            operators.means(field, temperature);
            for (i, mean) in temperature.iter_mut().enumerate() {
                *mean += origin + (0..flux.len()).map(|j| operators.unresolved[(i, j)] * flux[j]).sum::<f64>();
            }
        });
    }

    fn distortion_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        _flux: &[f64],
        _velocity: f64,
        distortion: &mut [f64],
    ) {
        self.of_state(state, surroundings, |operators, field, origin| operators.distort(field, origin, distortion));
    }

    fn cooled_temperature(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        _flux: &[f64],
        _velocity: f64,
    ) -> [f64; FACES] {
        let mean =
            |operators: &FieldOperators, field: &[f64], origin| operators.cooled_means(field).map(|mean| mean + origin);
        self.of_state(state, surroundings, mean)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, _flux: &[f64]) -> [f64; 2] {
        self.of_state(state, surroundings, |operators, field, origin| {
            let outside = surroundings.end.ambient - origin;
            let far = match (&operators.outflow, operators.properties.top) {
                (Some((by_field, by_outside)), _) => dot(by_field, field) - by_outside * outside,
                (None, FarBoundary::Convecting(transfer)) => {
                    dot(&operators.top, field) - transfer * operators.properties.width * outside
                }
                (None, FarBoundary::Held | FarBoundary::Insulated) => 0.0,
            };
            [operators.ambient_flow(field, &surroundings.end), far - operators.top_width() * surroundings.end.far]
        })
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        self.operators.stored(state) / self.operators.total_capacity
    }

    fn account(&self, state: &[f64]) -> Account {
        let tallies = &state[self.operators.degrees()..];
        Account { received: tallies[0], stored: self.operators.stored(state), ambient: tallies[1], far: tallies[2] }
    }

    fn error(&self) -> f64 {
        // Unreduced: no reduction error.
        0.0
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        let operators = self.operators.clone();
        // Room that nothing was prepared in costs no memory until something is.
        let prepared = self.prepared.clone_occupied(|_| Prepared::empty(&operators));
        let room = RefCell::new(FieldWorkspace::new(&operators).unwrap_or_else(|error| panic!("punch: {error}")));
        Box::new(FieldHeat { operators, prepared, room })
    }
}
