//! Conduction in one body as the N cells of the contact line see it.
//!
//! The coupled step is implicit with two stages, at `gamma h` and `h`, `gamma = 1 - 1/sqrt 2`. A body does not know
//! the other body, the pressure or the wear; it answers with temperatures and distortions that are linear in the
//! fluxes of the stage being solved.
//!
//! # Fluxes over a step
//!
//! In the first stage the flux into a cell is linear on `[0, gamma h]`, from `q_1 + e` to `q_1`; the deviation `e` at the
//! start is known before the stage is solved (that of the slope of the step before as far as it is smooth, 0 after a jump). In the second it is
//! linear through `q_1` at `gamma h` and `q_2` at `h`, back to the start of the step. What enters over the step is therefore
//! `h [(1 - gamma) q_1 + gamma q_2]`, the weights of the wear in the same step. States follow these fluxes without
//! error (exponentially), so no decay, however fast, rings or blows up.
//!
//! With `e = 0` the first stage would take its flux for constant, which is wrong by `h`: a conductor answers fluxes like the
//! root of time, so temperatures would converge at order 3/2 only.
//!
//! # Units and signs
//!
//! Temperatures are K above the reference at which nothing is distorted and heat is counted from. Fluxes are W/m2 of
//! contact zone, positive into the body. Distortion is the displacement of the surface *into* the body in m, so heating
//! gives negative values. Energies are per depth, J/m, flows W/m. Cells run from the -x to the +x edge.

pub mod disc;
pub mod field;
pub mod punch;
pub mod reduced;
pub mod strip;

use nalgebra::DMatrix;
use std::fmt::Debug;

pub use numerics::sdirk::GAMMA;

/// Numbers of a matrix on the cells, for all steps that are kept, unless fewer than [`LEAST_STEPS`] fit.
const CACHED_NUMBERS: usize = 400_000;
const LEAST_STEPS: usize = 2;
const MOST_STEPS: usize = 8;

/// Number of steps whose operators are kept on `cells` cells: those that a step control goes back and forth between. One that
/// hesitates at every event takes up to six lengths by turns.
pub fn cache_capacity(cells: usize) -> usize {
    (CACHED_NUMBERS / (cells * cells)).clamp(LEAST_STEPS, MOST_STEPS)
}

/// The two stages of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// At `gamma h`.
    First,
    /// At `h`.
    End,
}

/// Faces that the air cools beyond their constant heat transfer: the free surface beside the contact, and the far face (punch
/// top, strip base) where its temperature is not prescribed.
pub const FACES: usize = 2;
pub const BESIDE: usize = 0;
pub const FAR: usize = 1;

/// What acts on a body besides the contact: constant over a step but for the fluxes by the air, which are linear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Flux into the surface beside the contact beyond its constant convection (forced part, radiation) at the end of the step,
    /// W/m2 of cooled area.
    pub cooling: f64,
    /// By how much it falls over the step.
    pub cooling_fall: f64,
    /// Temperature of the air.
    pub ambient: f64,
    /// What is prescribed at the far face at the end of the step: its temperature where it is held or external; where the air takes
    /// more than by its constant convection, the flux into it by that, W/m2.
    pub far: f64,
    /// By how much it falls over the step; 0 of a temperature.
    pub far_fall: f64,
}

impl Surroundings {
    /// The same from the start of the step to the stage.
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

    /// Mean of what is prescribed at the far face over the step.
    fn mean_far(&self) -> f64 {
        self.far + 0.5 * self.far_fall
    }

    /// The fluxes by the air at the end of the step; `temperature_at_frozen_state`: the far face has a temperature.
    pub fn by_air(&self, held: bool) -> [f64; FACES] {
        [self.cooling, if held { 0.0 } else { self.far }]
    }

    /// The same surroundings with these fluxes by the air, constant over the step; `temperature_at_frozen_state` as above.
    pub fn with_air(&self, flux: [f64; FACES], held: bool) -> Surroundings {
        let far = if held { self.far } else { flux[FAR] };
        Surroundings { cooling: flux[BESIDE], cooling_fall: 0.0, far, far_fall: 0.0, ..*self }
    }
}

/// What is to be expected of the cooled faces at the end of the prepared step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CooledAhead {
    /// Their mean temperatures there.
    pub temperature: [f64; FACES],
    /// By how much those (rows) rise with the fluxes by the air there (columns), the fluxes at the start held, K m2/W.
    pub rise: [[f64; FACES]; FACES],
    /// What is in the first of `temperature` as it is at the start of the step: the part that is not looked ahead for.
    pub lagging: f64,
}

/// Response of the cells to the fluxes of one stage, N x N each, row: answering cell, column: heated cell.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceInfluence {
    /// K per W/m2.
    pub temperature: DMatrix<f64>,
    /// m per W/m2, positive into the body; zero where nothing expands.
    pub distortion: DMatrix<f64>,
}

/// Where the heat that entered a body has gone since its states were 0. J per m of depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Entered through the contact.
    pub received: f64,
    /// In the body now.
    pub stored: f64,
    /// Left to the air, through the cooled surface.
    pub ambient: f64,
    /// Left through the far face.
    pub far: f64,
}

/// One body. Implementations share what a scene makes of them (`Arc`) and own only what depends on the step, so a clone
/// is cheap. After the first `prepare` no call allocates.
pub trait ThermalBody: Debug + Send {
    /// N.
    fn cells(&self) -> usize;

    /// Length of the state vector. All zero: the body at the reference temperature.
    fn states(&self) -> usize;

    /// State of a body that is `rise` (K) above the reference everywhere.
    fn uniform(&self, rise: f64, state: &mut [f64]);

    /// Rates (1/s, >= 0) at which the leading entries of the state, those that hold temperatures, fade without heat; what
    /// the state holds behind them is the account. Empty: not known.
    fn decay_rates(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The same while the contact slides at a velocity (m/s), where that changes the rates.
    fn decay_rates_while_sliding(&self, _velocity: f64) -> Vec<f64> {
        self.decay_rates()
    }

    /// Difference of the sliding velocity, m/s, that hardly changes what answers at once, however short the step.
    fn velocity_validity(&self) -> f64 {
        f64::INFINITY
    }

    /// Weights and gains for a step of `step` s in which the sliding velocity changes linearly between the two values
    /// (m/s, signed: the material of the strip moves with -v in the punch's frame). Equal arguments cost a comparison.
    /// Gains are functions of the arguments alone, never of what was prepared before.
    fn prepare(&mut self, step: f64, velocity: [f64; 2]);

    /// The same for one implicit Euler step, as an operator split takes it: both stages lie at the end of the step and
    /// answer to a flux that is constant over it, which [`Self::advance`] takes twice. So is the cooling.
    fn prepare_euler(&mut self, step: f64, velocity: [f64; 2]);

    /// Response at `stage` to the fluxes of that stage.
    fn influence(&self, stage: Stage) -> &SurfaceInfluence;

    /// Temperature and distortion of the N cells at `stage` if the flux of that stage were 0: from the state at the
    /// start of the step, the surroundings and `known`: in the first stage the deviation e of the flux at the start from
    /// that of the stage, at the end the fluxes of the first stage, W/m2.
    fn free_response(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    );

    /// [`ThermalBody::free_response`] at the end, where the last base asked for was that of the first stage, from the same state with the
    /// same surroundings: takes over what both have in common.
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

    /// Carries the state over the prepared step with the fluxes of both stages.
    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]);

    /// [`ThermalBody::advance`], where the last base asked for was that of the end, from the same state with the same surroundings
    /// and the fluxes `first`: takes over what it has found.
    fn advance_from_end(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        self.advance(state, surroundings, first, end);
    }

    /// [`ThermalBody::advance_from_end`] from the state `before`, which stays, to the state `after`.
    fn advance_to(&self, before: &[f64], after: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        after.copy_from_slice(before);
        self.advance_from_end(after, surroundings, first, end);
    }

    /// Temperature (K above the reference) of the N cells with the state held and the flux `flux` into the cells, which
    /// acts at the sliding velocity `velocity` (m/s) through what answers at once only.
    fn temperature_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        temperature: &mut [f64],
    );

    /// Distortion of the N cells with the state held, m into the body; arguments as in [`ThermalBody::temperature_at_frozen_state`].
    fn distortion_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        distortion: &mut [f64],
    );

    /// Mean temperatures of the cooled faces, with the state held.
    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; FACES];

    /// The cooled faces at the end of the prepared step, for the fluxes that are expected into the cells at both stages.
    fn cooled_ahead(&self, state: &[f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) -> CooledAhead;

    /// Heat flows with the state held, W/m: to the air beside the contact (without the flux `cooling`) and out of the far face, all
    /// that passes it.
    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2];

    /// Mean temperature of the whole body.
    fn mean_temperature(&self, state: &[f64]) -> f64;

    /// Where the heat went; exact for the exact propagation of the states.
    fn account(&self, state: &[f64]) -> Account;

    /// Relative error of the reduction at the contact line, computed when the body was made.
    fn error(&self) -> f64;

    /// The same of the mean contact temperature.
    fn error_of_the_mean(&self) -> f64 {
        self.error()
    }

    /// A copy with weights of its own.
    fn boxed(&self) -> Box<dyn ThermalBody>;
}
