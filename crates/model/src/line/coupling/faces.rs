//! Cooled faces of both bodies: their fluxes (forced convection, radiation, heat path, together) are unknowns of each stage.
//!
//! A face is a port like a cell of the contact. At a stage its mean temperature is affine in the fluxes of the cells and of the
//! faces,
//!
//! ```text
//! theta = beta + B q + R phi,    T = b + G q + Gamma phi,    phi = law(theta)
//! ```
//!
//! and the law of its flux is solved by Newton's method, with the change of q by phi through the exchange of heat between the
//! bodies at the pressure of the iterate. Nothing is extrapolated, and a stiff law, as of a large conductance, limits no step.
//!
//! Theory: docs/theory.md, sections 4.11, 6.1, 7.1.

use super::ThermalCoupling;
use super::accept::{LEAST_LINE_RISE, deviation_from_line, slope_over_step};
use super::evaluation::largest;
use crate::line::heat::bodies::cooled_part;
use crate::line::heat::state::HeatState;
use crate::lumped::air::Air;
use crate::lumped::conditions::Conditions;
use crate::lumped::operators::LumpedOperators;
use conduction::line::{BESIDE, FACES, FAR, FaceInfluence, GAMMA, Stage};
use conduction::properties::Scales;
use nalgebra::{Matrix4, Vector4};
use numerics::maximum::maximum;
use numerics::{dense, factorization};

/// Largest number of cooled faces: of both bodies.
const MOST: usize = 2 * FACES;

/// Newton's method for the laws, which are convex: largest number of iterations, and the relative change at which they end. The error
/// after it is of its square.
const MOST_ITERATIONS: usize = 20;
const AGREEMENT: f64 = 1e-7;

/// A cooled face and the law of its flux.
#[derive(Clone, Debug)]
struct Face {
    /// Body (0: punch, 1: strip), and face of it.
    side: usize,
    face: usize,
    air: Air,
}

impl Face {
    /// [`Air::law`] under the conditions `at`.
    fn law(&self, reference: f64, t: f64, at: &Conditions) -> [f64; 2] {
        self.air.law(reference, t, at.ambient, at.forced, at.neighbours[self.side])
    }
}

/// Length (s), velocities (m/s) and properties of a step, which determine the responses of a body through whole cells.
type StepOfBody = (f64, [f64; 2], Scales);

/// Cooled faces of both bodies over a step. Vectors are by face, in the order of `faces`.
#[derive(Clone, Debug)]
pub struct Faces {
    faces: Vec<Face>,
    reference: f64,
    /// Conditions at both stages.
    conditions: [Option<Conditions>; 2],
    /// Fluxes into the faces at both stages, W/m2, and their temperatures, K above the reference.
    flux: [[f64; MOST]; 2],
    temperature: [[f64; MOST]; 2],
    /// Responses to the fluxes into the faces at both stages, and the step that each is of; `None`: one through parts of cells.
    influence: [Vec<FaceInfluence>; 2],
    influence_of: [[Option<StepOfBody>; MOST]; 2],
    // Stage under way.
    stage: usize,
    /// beta, by body.
    free: [[f64; FACES]; 2],
    /// Change of the flux into the punch by a unit flux, and whether it is that on the cells that exchange heat, `exchanging`.
    exchanged: Vec<Vec<f64>>,
    exchanging: Vec<bool>,
    coupled: bool,
    /// Change of the temperatures (rows) by the fluxes (columns), by way of the exchange included.
    rise: Matrix4<f64>,
}

impl Faces {
    /// Cooled faces of a line of `count` cells.
    pub fn new(mean: &LumpedOperators, count: usize) -> Faces {
        let scene = &mean.scene;
        let bodies = [(&mean.punch, &scene.punch, 1.0), (&mean.strip, &scene.strip, cooled_part(scene))];
        let mut faces = Vec::new();
        for (side, (operators, body, beside)) in bodies.into_iter().enumerate() {
            let own =
                Air::of(body, operators.convection_within, beside, 1.0).into_iter().zip(&operators.air).enumerate();
            let acting = own.filter(|(_, (_, of_mean))| of_mean.acts());
            faces.extend(acting.map(|(face, (air, of_mean))| Face {
                side,
                face,
                air: Air { path: of_mean.path, ..air },
            }));
        }
        Faces {
            reference: 0.0,
            conditions: [None; 2],
            flux: [[0.0; MOST]; 2],
            temperature: [[0.0; MOST]; 2],
            influence: [0, 1].map(|_| faces.iter().map(|_| FaceInfluence::new(count)).collect()),
            influence_of: [[None; MOST]; 2],
            stage: 0,
            free: [[0.0; FACES]; 2],
            exchanged: faces.iter().map(|_| vec![0.0; count]).collect(),
            exchanging: vec![false; count],
            coupled: false,
            rise: Matrix4::identity(),
            faces,
        }
    }

    /// Whether no face is cooled beyond its constant heat transfer.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Sets the conditions at both stages of a step, with temperatures relative to `reference`, K, and the properties of the bodies.
    pub(crate) fn set_conditions(&mut self, conditions: [Conditions; 2], reference: f64, scales: [Scales; 2]) {
        for face in &mut self.faces {
            face.air = face.air.at(scales[face.side]);
        }
        (self.conditions, self.reference) = (conditions.map(Some), reference);
    }

    /// Sets the temperatures of a body's faces without fluxes of the stage.
    pub(crate) fn set_free(&mut self, side: usize, temperature: [f64; FACES]) {
        self.free[side] = temperature;
    }

    /// Response of the temperature of face `k` to the flux into face `l`, without exchange of heat.
    fn own_rise(&self, k: usize, l: usize) -> f64 {
        let (own, other) = (&self.faces[k], &self.faces[l]);
        if own.side == other.side { self.influence[self.stage][l].faces[own.face] } else { 0.0 }
    }

    /// Temperatures at the fluxes of `stage` into the faces and `flux` into the cells of both bodies.
    fn temperatures(&self, stage: usize, flux: &[Vec<f64>; 2]) -> [f64; MOST] {
        let mut temperature = [0.0; MOST];
        for (k, face) in self.faces.iter().enumerate() {
            let by_faces: f64 = (0..self.faces.len()).map(|l| self.own_rise(k, l) * self.flux[stage][l]).sum();
            temperature[k] = self.free[face.side][face.face]
                + dense::dot(&self.influence[stage][k].by_cell, &flux[face.side])
                + by_faces;
        }
        temperature
    }

    /// Changes of the fluxes that satisfy the laws at a stage, where the temperatures are `t` and change by `rise`.
    fn balance(&self, stage: usize, t: &[f64; MOST]) -> [f64; MOST] {
        let (mut change, Some(at)) = (Vector4::zeros(), &self.conditions[stage]) else { return [0.0; MOST] };
        for _ in 0..MOST_ITERATIONS {
            let more = self.rise * change;
            let (mut residual, mut matrix) = (Vector4::zeros(), Matrix4::identity());
            for (k, face) in self.faces.iter().enumerate() {
                let [flux, fall] = face.law(self.reference, t[k] + more[k], at);
                residual[k] = flux - self.flux[stage][k] - change[k];
                (0..MOST).for_each(|l| matrix[(k, l)] += fall * self.rise[(k, l)]);
            }
            let Ok(correction) = factorization::solve(&matrix, &residual) else { break };
            change += correction;
            let settled = |k: usize| correction[k].abs() <= AGREEMENT * (self.flux[stage][k] + change[k]).abs();
            if (0..self.faces.len()).all(settled) {
                break;
            }
        }
        change.into()
    }

    /// Errors at the end of the step by fluxes that are not linear over it, K: of the temperatures of cells, faces and bodies, and
    /// whichever is largest. The deviation of a flux from the line through both stages changes a temperature with the response x by
    /// `x (1 + s (R - x))/(1 + s R)` of it, s the decrease of the law: what reaches the face changes the flux in return.
    /// `before`: fluxes at the start of the step.
    fn errors(&self, count: usize, before: &[[f64; FACES]; 2]) -> impl Iterator<Item = (&FaceInfluence, f64, f64)> {
        self.faces.iter().enumerate().map(move |(k, face)| {
            let influence = &self.influence[Stage::End as usize][k];
            let before = before[face.side][face.face];
            // A law is linear in the temperature of its face, which no jump moves at once: nothing is hidden.
            let deviation = deviation_from_line([before, self.flux[0][k], self.flux[1][k]], 0.0).abs();
            let fall =
                self.conditions[1].as_ref().map_or(0.0, |at| face.law(self.reference, self.temperature[1][k], at)[1]);
            let own = influence.faces[face.face];
            let square: f64 = influence.temperature.iter().map(|t| t * t).sum();
            let responses = [own, influence.mean, (square / count as f64).sqrt()];
            let damped = |x: f64| x * (1.0 + fall * (own - x).max(0.0)) / (1.0 + fall * own);
            let error = responses.into_iter().map(damped).fold(0.0, maximum);
            (influence, deviation, error * deviation)
        })
    }
}

impl ThermalCoupling {
    /// Sets the deviations of the fluxes at the start of the step from those of the first stage, by their slopes over the last step.
    pub(super) fn deviate_faces(&mut self, state: &HeatState) {
        for face in &self.faces.faces {
            let deviation = &mut self.surroundings[face.side].deviation;
            let deviation = if face.face == BESIDE { &mut deviation.cooling } else { &mut deviation.far };
            *deviation = -GAMMA * state.ahead(self.step) * state.cooling_slope[face.side][face.face];
        }
    }

    /// Starts the fluxes of a stage: those that satisfy the laws at the fluxes into the cells at the last stage.
    pub(super) fn begin_faces(&mut self, stage: Stage, state: &HeatState) {
        let s = stage as usize;
        let is_first = stage == Stage::First;
        let faces = &mut self.faces;
        (faces.stage, faces.coupled) = (s, false);
        for (k, face) in faces.faces.iter().enumerate() {
            if let (Some(body), Some(work)) = (&self.bodies[face.side], &mut self.work[face.side]) {
                let through_whole = self.contact_parts[s].is_whole() || !body.divides_cells();
                let step = through_whole.then_some((self.step, self.velocity, self.frozen.scales[face.side]));
                if step.is_none() || faces.influence_of[s][k] != step {
                    faces.influence_of[s][k] = step;
                    body.face_influence(stage, face.face, &mut faces.influence[s][k], work);
                }
            }
            faces.flux[s][k] = if is_first { state.cooling[face.side][face.face] } else { faces.flux[0][k] };
        }
        let last = if is_first { &state.flux } else { &self.flux[0] };
        let temperature = faces.temperatures(s, last);
        faces.rise = Matrix4::from_fn(|k, l| if k.max(l) < faces.faces.len() { faces.own_rise(k, l) } else { 0.0 });
        let change = faces.balance(s, &temperature);
        faces.flux[s].iter_mut().zip(change).for_each(|(flux, change)| *flux += change);
        let flux = faces.flux[s];
        self.shift_by_faces(&flux);
    }

    /// Adds the response to fluxes into the faces to the free response of the stage.
    fn shift_by_faces(&mut self, flux: &[f64; MOST]) {
        let Faces { faces, influence, stage, .. } = &self.faces;
        for ((face, influence), flux) in faces.iter().zip(&influence[*stage]).zip(flux) {
            let side = face.side;
            dense::multiply_add(&influence.temperature, &[*flux], &mut self.iterate.free_response[side]);
            if self.parameters.expands[side] {
                dense::multiply_add(&influence.distortion, &[*flux], &mut self.iterate.free_distortion[side]);
            }
        }
        self.iterate.temperatures_current = false;
    }

    /// Prepares the responses of the faces by way of the exchange of heat, for the cells that exchange heat at the stage.
    pub(super) fn couple_faces(&mut self, stage: Stage) {
        let s = stage as usize;
        let exchanges = !self.open && self.conducts() == [true, true] && self.parameters.half_resistance > 0.0;
        let Faces { faces, influence, exchanged, exchanging, coupled, .. } = &mut self.faces;
        if faces.is_empty() || *coupled && *exchanging == self.iterate.closed {
            return;
        }
        *coupled = true;
        exchanging.copy_from_slice(&self.iterate.closed);
        for ((face, influence), exchanged) in faces.iter().zip(&influence[s]).zip(exchanged) {
            exchanged.fill(0.0);
            if exchanges {
                let towards = if face.side == 0 { -1.0 } else { 1.0 };
                let residual = self.iterate.difference.iter_mut().zip(&influence.temperature);
                residual.for_each(|(residual, rise)| *residual = towards * rise);
                self.partitions[s].exchange(&self.iterate.difference, exchanged);
            }
        }
        let faces = &mut self.faces;
        for (k, face) in faces.faces.iter().enumerate() {
            let towards = if face.side == 0 { 1.0 } else { -1.0 };
            for l in 0..faces.faces.len() {
                let by_exchange = towards * dense::dot(&faces.influence[s][k].by_cell, &faces.exchanged[l]);
                faces.rise[(k, l)] = faces.own_rise(k, l) + by_exchange;
            }
        }
    }

    /// Satisfies the laws of the faces at the pressure of the iterate. Returns the change of the temperatures by that, relative to
    /// the largest rise of a free response or face.
    pub(super) fn solve_faces(&mut self, stage: Stage) -> f64 {
        let s = stage as usize;
        if self.faces.is_empty() {
            return 0.0;
        }
        let faces = &mut self.faces;
        let before = faces.temperatures(s, &self.flux[s]);
        let change = faces.balance(s, &before);
        faces.temperature[s] = (Vector4::from(before) + faces.rise * Vector4::from(change)).into();
        faces.flux[s].iter_mut().zip(change).for_each(|(flux, change)| *flux += change);
        let (mut moved, mut rise) = (0.0, maximum(LEAST_LINE_RISE, largest(&faces.temperature[s])));
        for (influence, change) in faces.influence[s].iter().zip(change) {
            let most = maximum(largest(&influence.temperature), largest(&influence.faces));
            moved = maximum(moved, (change * most).abs());
        }
        let [punch, strip] = &mut self.flux[s];
        for (exchanged, change) in faces.exchanged.iter().zip(change) {
            dense::multiply_add(exchanged, &[change], punch);
            dense::multiply_add(exchanged, &[-change], strip);
        }
        self.shift_by_faces(&change);
        rise = self.iterate.free_response.iter().fold(rise, |most, free| maximum(most, largest(free)));
        moved / rise
    }

    /// Hands the fluxes of a solved stage to the bodies.
    pub(super) fn surround_by_faces(&mut self, stage: Stage) {
        let s = stage as usize;
        for (face, flux) in self.faces.faces.iter().zip(self.faces.flux[s]) {
            let around = &mut self.surroundings[face.side];
            let around = if stage == Stage::First { &mut around.first } else { &mut around.end };
            *(if face.face == BESIDE { &mut around.cooling } else { &mut around.far }) = flux;
        }
    }

    /// Errors of the step by the fluxes of the faces, see [`Faces::errors`]: of temperatures, K, and the largest rise of a face, K;
    /// of the distortion less its mean where cells `touch`, m.
    pub(super) fn errors_of_faces(&self, state: &HeatState, touch: bool) -> [f64; 3] {
        let count = self.iterate.closed.len();
        let (mut temperature, mut distortion) = (0.0, 0.0);
        for (influence, deviation, error) in self.faces.errors(count, &state.cooling) {
            temperature += error;
            let mean = influence.distortion.iter().sum::<f64>() / count as f64;
            let square: f64 = influence.distortion.iter().map(|moved| (moved - mean).powi(2)).sum();
            distortion += deviation * (square / count as f64).sqrt();
        }
        [temperature, largest(&self.faces.temperature[1]), if touch { distortion } else { 0.0 }]
    }

    /// Writes the fluxes into the faces at the end of the step, W/m2, and adds up the heat paths: flow out of the far face at the
    /// end of the step, W/m2, and heat, J/m2.
    pub(super) fn accept_faces(&self, state: &mut HeatState) {
        let Faces { faces, conditions, flux, temperature, reference, .. } = &self.faces;
        let per_length = [1.0 / (GAMMA * self.step), 1.0 / ((1.0 - GAMMA) * self.step)];
        for (k, face) in faces.iter().enumerate() {
            let [before, slope] =
                [&mut state.cooling, &mut state.cooling_slope].map(|of| &mut of[face.side][face.face]);
            *slope = slope_over_step(*slope, [*before, flux[0][k], flux[1][k]], per_length);
            *before = flux[1][k];
            if face.face == FAR && face.air.path > 0.0 {
                let by_path = [0, 1].map(|s| {
                    let air = conditions[s]
                        .as_ref()
                        .map_or(0.0, |at| face.air.flux_by_air(*reference, temperature[s][k], at.ambient, at.forced));
                    air - flux[s][k]
                });
                let [flow, heat] = &mut state.external[face.side];
                *flow = by_path[1];
                *heat += self.step * ((1.0 - GAMMA) * by_path[0] + GAMMA * by_path[1]);
            }
        }
    }
}
