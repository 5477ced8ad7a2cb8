//! Heat conduction in one body, as seen by the N cells of the contact line.
//!
//! The coupled step is implicit with two stages, at `gamma h` and `h`, `gamma = 1 - 1/sqrt 2`. A body is independent of the
//! other body, of the pressure and of the wear: its temperatures and distortions are affine in the fluxes of the stage being
//! solved, with the free response as the constant term and the surface influence matrices as the linear one.
//!
//! # Fluxes over a step
//!
//! In the first stage the flux into a cell is linear on `[0, gamma h]`, from `q_1 + e` to `q_1`; the deviation `e` at the
//! start is known before the stage is solved (extrapolated from the slope of the previous step where the flux is smooth, 0
//! after a jump). In the second stage it is linear through `q_1` at `gamma h` and `q_2` at `h`, extended back to the start
//! of the step. The heat input over the step is therefore `h [(1 - gamma) q_1 + gamma q_2]`, with the same weights as the
//! wear. The states are propagated exactly (exponentially) for these fluxes, so no decay rate, however fast, causes
//! oscillation or instability.
//!
//! With `e = 0` the first stage would have a constant flux, an error of order `h`: as a conductor responds to fluxes like
//! the square root of time, temperatures would converge with order 3/2 only.
//!
//! # Units and signs
//!
//! Temperatures are K above the reference at which nothing is distorted and stored heat is zero. Fluxes are W/m2 of contact
//! zone, positive into the body. Distortion is the displacement of the surface *into* the body in m, so heating gives
//! negative values. Energies are per depth, J/m, flows W/m. Cells run from the -x to the +x edge.
//!
//! Theory: docs/theory.md, sections 4.1, 5.3.

pub mod contact_parts;
pub mod disc;
pub mod field;
pub mod punch;
pub mod reduced;
pub mod strip;

use contact_parts::ContactParts;
use nalgebra::DMatrix;
use std::fmt::Debug;

pub use numerics::sdirk::GAMMA;

/// Times between which the heat of a body is followed, s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Times {
    /// Longest time.
    pub duration: f64,
    /// Shortest time after a change of the fluxes at which temperature and distortion are right.
    pub shortest: f64,
}

impl Times {
    /// Part of the duration that is the shortest time unless the drive is periodic.
    const SHORTEST: f64 = 1e-3;

    /// Least decay within the shortest time, as a logarithm: to a twentieth. At a tolerance of .1 surfaces beside heated cells would
    /// cool by 1.6 % of the rise otherwise.
    const LEAST_DECAY: f64 = 3.0;

    /// Times up to `duration` (s).
    pub fn up_to(duration: f64) -> Times {
        Times { duration, shortest: Times::SHORTEST * duration }
    }

    /// The same with a cycle of `period` s, a sixtieth of which is resolved.
    pub fn with_cycle(self, period: f64) -> Times {
        Times { shortest: self.shortest.min(period / 60.0), ..self }
    }

    /// Decay rate (1/s) of what leaves only a part `tolerance` of itself within the shortest time: what decays faster may follow
    /// its flux at once.
    pub fn fastest(&self, tolerance: f64) -> f64 {
        (1.0 / tolerance).ln().max(Times::LEAST_DECAY) / self.shortest
    }
}

/// Cache size in entries of an N x N matrix over all cached steps, unless fewer than [`LEAST_STEPS`] fit.
const CACHED_NUMBERS: usize = 400_000;
const LEAST_STEPS: usize = 2;
const MOST_STEPS: usize = 8;

/// Cache capacity: number of step sizes whose operators are cached on `cells` cells. A step control alternates between a few
/// step sizes, up to six where it locates events.
pub fn cache_capacity(cells: usize) -> usize {
    (CACHED_NUMBERS / (cells * cells)).clamp(LEAST_STEPS, MOST_STEPS)
}

/// The two stages of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// First stage, at `gamma h`.
    First,
    /// Second stage, at the end of the step, `h`.
    End,
}

/// Number of faces with forced cooling beyond their constant heat transfer: the free surface beside the contact, and the far
/// face (punch top, strip base) where its temperature is not prescribed.
pub const FACES: usize = 2;
pub const BESIDE: usize = 0;
pub const FAR: usize = 1;

/// Thermal boundary conditions of a body apart from the contact: constant over a step except for the fluxes by the air,
/// which are linear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Flux into the surface beside the contact beyond its constant convection (forced part, radiation) at the end of the
    /// step, W/m2 of cooled area.
    pub cooling: f64,
    /// Decrease of `cooling` over the step, W/m2.
    pub cooling_fall: f64,
    /// Temperature of the air.
    pub ambient: f64,
    /// Boundary value of the far face at the end of the step: its temperature where the face is held or external; where the
    /// air takes more than by its constant convection, the flux into it beyond that, W/m2.
    pub far: f64,
    /// Decrease of `far` over the step; 0 for a temperature.
    pub far_fall: f64,
}

impl Surroundings {
    /// Boundary conditions from the start of the step to the stage.
    fn until(&self, stage: Stage) -> Surroundings {
        match stage {
            Stage::First => Surroundings {
                cooling: self.cooling + (1.0 - GAMMA) * self.cooling_fall,
                cooling_fall: GAMMA * self.cooling_fall,
                far: self.far + (1.0 - GAMMA) * self.far_fall,
                far_fall: GAMMA * self.far_fall,
                ..*self
            },
            Stage::End => *self,
        }
    }

    /// Mean of the cooling over the step.
    fn mean_cooling(&self) -> f64 {
        self.cooling + 0.5 * self.cooling_fall
    }

    /// Mean of the boundary value of the far face over the step.
    fn mean_far(&self) -> f64 {
        self.far + 0.5 * self.far_fall
    }

    /// Fluxes by the air at the end of the step; `held`: the temperature of the far face is prescribed.
    pub fn by_air(&self, held: bool) -> [f64; FACES] {
        [self.cooling, if held { 0.0 } else { self.far }]
    }

    /// The same boundary conditions with these fluxes by the air, constant over the step; `held` as above.
    pub fn with_air(&self, flux: [f64; FACES], held: bool) -> Surroundings {
        let far = if held { self.far } else { flux[FAR] };
        Surroundings { cooling: flux[BESIDE], cooling_fall: 0.0, far, far_fall: 0.0, ..*self }
    }
}

/// Linear prediction of the temperatures of the cooled faces at the end of the prepared step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CooledAhead {
    /// Mean temperatures at the end of the step.
    pub temperature: [f64; FACES],
    /// Their increase (rows) per flux by the air at the end of the step (columns) for fixed fluxes at its start, K m2/W.
    pub rise: [[f64; FACES]; FACES],
    /// Part of the first of `temperature` that is not extrapolated but taken at the start of the step.
    pub not_extrapolated: f64,
}

/// Surface influence matrices of one stage, N x N: responses of the cells (rows) to a unit flux into each cell (columns).
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceInfluence {
    /// Temperature, K per W/m2.
    pub temperature: DMatrix<f64>,
    /// Distortion, m per W/m2, positive into the body; zero where nothing expands.
    pub distortion: DMatrix<f64>,
}

/// Heat account since the states were 0, J per m of depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Heat that entered through the contact.
    pub received: f64,
    /// Heat in the body at present.
    pub stored: f64,
    /// Heat that left to the air, through the cooled surface.
    pub ambient: f64,
    /// Heat that left through the far face.
    pub far: f64,
}

/// One heat-conducting body. Implementations share their operators (`Arc`) and own only what depends on the step, so a clone
/// is cheap. No call allocates after the first `prepare`.
pub trait ThermalBody: Debug + Send {
    /// Number of cells N.
    fn cells(&self) -> usize;

    /// Length of the state vector; all zero is the body at the reference temperature.
    fn states(&self) -> usize;

    /// State of a body at the uniform temperature `rise` (K) above the reference.
    fn uniform(&self, rise: f64, state: &mut [f64]);

    /// Decay rates (1/s, >= 0) of the leading, temperature-like entries of the state; the entries behind them are the heat
    /// account. Empty if not available.
    fn decay_rates(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Decay rates while the contact slides at a velocity (m/s), for bodies in which they depend on it.
    fn decay_rates_while_sliding(&self, _velocity: f64) -> Vec<f64> {
        self.decay_rates()
    }

    /// Validity radius of a linearization in the sliding velocity, m/s: a smaller difference hardly changes the direct
    /// feedthrough.
    fn velocity_validity(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether heat can enter through parts of the cells alone.
    fn divides_cells(&self) -> bool {
        false
    }

    /// Sets the parts of the cells through which the fluxes of both stages enter in the steps prepared from now on, and whose mean
    /// temperatures the influence matrices and the free response give; at frozen state a temperature remains that of the whole cell. Without
    /// effect on a body that does not divide its cells.
    fn set_contact_parts(&mut self, _contact_parts: [&ContactParts; 2]) {}

    /// Computes weights and surface influence matrices for a step of `step` s in which the sliding velocity changes linearly
    /// between the two values (m/s, signed: the material of the strip moves with -v in the punch's frame). Equal arguments
    /// cost a comparison. The result is a function of the arguments and the parts in contact alone, never of earlier preparations.
    fn prepare(&mut self, step: f64, velocity: [f64; 2]);

    /// [`Self::prepare`] for one implicit Euler step of an operator split: both stages lie at the end of the step and
    /// respond to a flux that is constant over it, which is passed to [`Self::advance`] twice. The cooling is constant too.
    fn prepare_euler(&mut self, step: f64, velocity: [f64; 2]);

    /// Surface influence matrices of `stage`.
    fn influence(&self, stage: Stage) -> &SurfaceInfluence;

    /// The same through whole cells, whatever parts of them are in contact.
    fn influence_of_whole(&self, stage: Stage) -> &SurfaceInfluence {
        self.influence(stage)
    }

    /// Free response: temperature and distortion of the N cells at `stage` for zero flux of that stage, from the state at
    /// the start of the step, the surroundings and `known`, W/m2: in the first stage the deviation e of the flux at the
    /// start from that of the stage, at the end the fluxes of the first stage.
    fn free_response(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    );

    /// [`ThermalBody::free_response`] at the end, valid directly after that of the first stage with the same state and
    /// surroundings: reuses their common part.
    fn free_response_at_end(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) {
        self.free_response(state, surroundings, Stage::End, known, temperature, distortion);
    }

    /// Propagates the state over the prepared step with the fluxes of both stages.
    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]);

    /// [`ThermalBody::advance`], valid directly after the free response at the end with the same state, surroundings and
    /// fluxes `first`: reuses its result.
    fn advance_from_end(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        self.advance(state, surroundings, first, end);
    }

    /// [`ThermalBody::advance_from_end`] from the state `before`, which is unchanged, to the state `after`.
    fn advance_to(&self, before: &[f64], after: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        after.copy_from_slice(before);
        self.advance_from_end(after, surroundings, first, end);
    }

    /// Output map at frozen state: temperature (K above the reference) of the N cells for the flux `flux`, which acts
    /// through the direct feedthrough only, at the sliding velocity `velocity` (m/s).
    fn temperature_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        temperature: &mut [f64],
    );

    /// Distortion of the N cells at frozen state, m into the body; arguments as in [`ThermalBody::temperature_at_frozen_state`].
    fn distortion_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        distortion: &mut [f64],
    );

    /// Mean temperatures of the cooled faces at frozen state.
    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; FACES];

    /// Prediction for the cooled faces at the end of the prepared step, with the predicted fluxes into the cells at both stages.
    fn cooled_ahead(&self, state: &[f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) -> CooledAhead;

    /// Heat flows at frozen state, W/m: to the air beside the contact (without the flux `cooling`), and the total out of the
    /// far face.
    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2];

    /// Mean temperature of the whole body.
    fn mean_temperature(&self, state: &[f64]) -> f64;

    /// Heat account; exact for the exact propagation of the states.
    fn account(&self, state: &[f64]) -> Account;

    /// Relative error of the reduction at the contact line, computed when the body was made.
    fn error(&self) -> f64;

    /// Relative error of the reduction for the mean contact temperature.
    fn error_of_the_mean(&self) -> f64 {
        self.error()
    }

    /// A copy with weights of its own.
    fn boxed(&self) -> Box<dyn ThermalBody>;
}

impl Clone for Box<dyn ThermalBody> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}
