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
//! oscillation or instability. The fluxes into the cooled faces are ports like the cells, the temperatures of the surroundings
//! linear in time in the same way.
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
pub mod property_body;
pub mod punch;
pub mod reduced;
pub mod strip;
#[cfg(test)]
mod tests;
mod workspace;

use crate::properties::Scales;
use contact_parts::ContactParts;
use nalgebra::DMatrix;
use std::fmt::Debug;

pub use numerics::sdirk::GAMMA;
pub use workspace::{SingleStep, Workspace};

/// Cache size in entries of an N x N matrix over all cached steps, unless fewer than [`FEWEST_CACHED`] fit.
const CACHED_NUMBERS: usize = 400_000;
const FEWEST_CACHED: usize = 2;
const MOST_CACHED: usize = 8;

/// Cache capacity: number of step sizes whose operators are cached on `cells` cells. A step control alternates between a few
/// step sizes, up to six where it locates events.
pub fn cache_capacity(cells: usize) -> usize {
    (CACHED_NUMBERS / (cells * cells)).clamp(FEWEST_CACHED, MOST_CACHED)
}

/// The two stages of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// First stage, at `gamma h`.
    First,
    /// Second stage, at the end of the step, `h`.
    End,
}

/// Number of cooled faces, through which heat flows beyond their constant heat transfer: the free surface beside the contact, and
/// the far face (punch top, strip base) where its temperature is not prescribed.
pub const FACES: usize = 2;
/// The free surface beside the contact.
pub const BESIDE: usize = 0;
/// The far face.
pub const FAR: usize = 1;

/// Boundary values of a body apart from the contact, at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Boundary {
    /// Flux into the surface beside the contact beyond its constant convection (forced part, radiation), W/m2 of cooled area.
    pub cooling: f64,
    /// Temperature of the air.
    pub ambient: f64,
    /// Value of the far face: its temperature where the face is held or external; elsewhere the flux into it beyond its constant
    /// convection, W/m2.
    pub far: f64,
}

impl Boundary {
    /// The same with these fluxes into the cooled faces; `held`: the temperature of the far face is prescribed.
    pub fn with_fluxes(&self, flux: [f64; FACES], held: bool) -> Boundary {
        Boundary { cooling: flux[BESIDE], far: if held { self.far } else { flux[FAR] }, ..*self }
    }

    /// A combination of two, value by value.
    fn combined(&self, other: &Boundary, of: impl Fn(f64, f64) -> f64) -> Boundary {
        Boundary {
            cooling: of(self.cooling, other.cooling),
            ambient: of(self.ambient, other.ambient),
            far: of(self.far, other.far),
        }
    }
}

/// Boundary values over a step, linear in time as the fluxes into the cells: see the module documentation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Deviation at the start of the step from the first stage, known before that is solved.
    pub deviation: Boundary,
    /// At the first stage.
    pub first: Boundary,
    /// At the end of the step.
    pub end: Boundary,
}

impl Surroundings {
    /// Constant over the step.
    pub fn constant(value: Boundary) -> Surroundings {
        Surroundings { deviation: Boundary::default(), first: value, end: value }
    }

    /// Linear over the step.
    pub fn linear(start: Boundary, end: Boundary) -> Surroundings {
        Surroundings {
            deviation: start.combined(&end, |start, end| GAMMA * (start - end)),
            first: start.combined(&end, |start, end| start + GAMMA * (end - start)),
            end,
        }
    }

    /// Values at `stage`.
    pub(crate) fn at(&self, stage: Stage) -> &Boundary {
        match stage {
            Stage::First => &self.first,
            Stage::End => &self.end,
        }
    }

    /// What is known before `stage`: its deviation at the start in the first stage, the first stage at the end.
    fn known(&self, stage: Stage) -> &Boundary {
        match stage {
            Stage::First => &self.deviation,
            Stage::End => &self.first,
        }
    }

    /// Decrease from the start of the step to `stage`.
    fn fall(&self, stage: Stage) -> Boundary {
        match stage {
            Stage::First => self.deviation,
            Stage::End => self.first.combined(&self.end, |first, end| (first - end) / (1.0 - GAMMA)),
        }
    }

    /// Mean over the step.
    fn mean(&self) -> Boundary {
        self.first.combined(&self.end, |first, end| (1.0 - GAMMA) * first + GAMMA * end)
    }

    /// The same without fluxes into the cooled faces at `stage`; `held`: the temperature of the far face is prescribed.
    fn without_fluxes_at(&self, stage: Stage, held: bool) -> Surroundings {
        let without = self.at(stage).with_fluxes([0.0; FACES], held);
        match stage {
            Stage::First => Surroundings { first: without, ..*self },
            Stage::End => Surroundings { end: without, ..*self },
        }
    }
}

/// Responses of one stage to a unit flux into a cooled face, and of the mean temperature of that face to the fluxes of the stage.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceInfluence {
    /// Temperatures of the N cells, K per W/m2.
    pub temperature: Vec<f64>,
    /// Distortion of the N cells, m per W/m2.
    pub distortion: Vec<f64>,
    /// Mean temperatures of the cooled faces, K per W/m2.
    pub faces: [f64; FACES],
    /// Mean temperature of the body, K per W/m2.
    pub mean: f64,
    /// Mean temperature of this face per flux into each of the N cells, K per W/m2.
    pub by_cell: Vec<f64>,
}

impl FaceInfluence {
    /// Memory for `cells` cells.
    pub fn new(cells: usize) -> FaceInfluence {
        let zeros = || vec![0.0; cells];
        FaceInfluence { temperature: zeros(), distortion: zeros(), faces: [0.0; FACES], mean: 0.0, by_cell: zeros() }
    }
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

/// How the cells of a body exchange heat over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exchange<'a> {
    /// Through whole cells.
    Whole,
    /// Through these parts of the cells, at either stage: the fluxes enter there, and the influence matrices and the free response give
    /// their mean temperatures. At frozen state a temperature remains that of the whole cell. A body that does not divide its cells takes
    /// them as whole.
    Parts([&'a ContactParts; 2]),
}

/// A step of one body, before it is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a> {
    /// Length h, s.
    pub length: f64,
    /// Sliding velocities at start and end, m/s, linear between them. Signed: the material of the strip moves with -v in the punch's frame.
    pub velocity: [f64; 2],
    /// How the cells exchange heat.
    pub exchange: Exchange<'a>,
    /// Factors of the properties during the step; a body of constants has none ([`Observed::scales_at`]).
    pub scales: Scales,
    /// Absolute temperature of the reference, K.
    pub reference: f64,
}

impl Step<'static> {
    /// A step through whole cells, with the constants.
    pub fn new(length: f64, velocity: [f64; 2]) -> Self {
        Step { length, velocity, exchange: Exchange::Whole, scales: Scales::ONE, reference: 0.0 }
    }
}

/// The free response of the first stage is evaluated. [`ThermalBody::first`] makes one, and [`ThermalBody::end`] takes it.
#[derive(Debug)]
#[non_exhaustive]
pub struct First {
    /// Mean temperatures of the cooled faces in it, K above the reference.
    pub faces: [f64; FACES],
}

/// The free response at the end of the step is evaluated. [`ThermalBody::end`] makes one, and [`ThermalBody::advance`] takes it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct End {
    /// Mean temperatures of the cooled faces in it, K above the reference.
    pub faces: [f64; FACES],
}

/// One heat-conducting body and its steps: [`prepare`](ThermalBody::prepare), [`first`](ThermalBody::first),
/// [`end`](ThermalBody::end), [`advance`](ThermalBody::advance). Implementations share their operators (`Arc`) and own only what
/// depends on the step size, so a clone is cheap. What a stage leaves for the next is in the caller's [`Workspace`], one for each
/// body. No call allocates after the first `prepare`, except `recur` and `boxed`.
pub trait ThermalBody: Observed + Debug + Send + Sync {
    /// Computes the weights of a step: a function of the step alone, never of earlier ones. That of the last step again costs a comparison
    /// in a body of constants.
    fn prepare(&mut self, step: &Step<'_>);

    /// Forms the surface influence matrices of `stage`.
    fn influence(&mut self, stage: Stage) -> &SurfaceInfluence;

    /// Adds the temperature (K) and the distortion (m) of the cells by fluxes of `stage` into them, W/m2: the products of the surface
    /// influence matrices, without forming them.
    fn respond(&self, stage: Stage, flux: &[f64], response: [Option<&mut [f64]>; 2], work: &mut Workspace);

    /// Responses of `stage` to the fluxes into a cooled face, which is not one of prescribed temperature.
    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence, work: &mut Workspace);

    /// Free response of the first stage: temperature and distortion of the N cells for zero fluxes of that stage into cells and
    /// cooled faces, from the state at the start of the step, the surroundings and the deviation e (W/m2) of the fluxes at the start
    /// from those of the stage.
    fn first(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        deviation: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> First;

    /// The same at the end of the step, after the first stage with the fluxes `flux` into the cells; state, surroundings up to that
    /// stage and workspace are those of `first`.
    fn end(
        &self,
        first: First,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> End;

    /// State after the step, from the one before it, by the fluxes of both stages; those of the first, the state before, the
    /// surroundings up to the first stage and the workspace are those of `end`.
    fn advance(
        &self,
        end: End,
        state: (&[f64], &mut [f64]),
        surroundings: &Surroundings,
        flux: [&[f64]; 2],
        work: &mut Workspace,
    );

    /// Computes now what steps at velocities up to `velocity` (m/s) need, not in the first step that needs it; results are the same either
    /// way.
    fn expect(&self, _velocity: f64) {}

    /// Keeps what the last `steps` steps prepare, of any length and velocities, for a run in which they recur; results are the same
    /// either way.
    fn recur(&mut self, _steps: usize) {}

    /// A copy with weights of its own.
    fn boxed(&self) -> Box<dyn ThermalBody>;
}

impl Clone for Box<dyn ThermalBody> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

/// A body at one instant.
#[derive(Clone, Copy, Debug)]
pub struct FrozenState<'a> {
    /// State vector.
    pub state: &'a [f64],
    /// Boundary values, at the end of a step.
    pub surroundings: &'a Surroundings,
    /// Fluxes into the N cells, W/m2.
    pub flux: &'a [f64],
    /// Sliding velocity, m/s.
    pub velocity: f64,
}

/// Observations with memory of their own, outside of a simulation.
impl FrozenState<'_> {
    /// Temperature of the N cells of `body`, K above the reference.
    pub fn temperature(&self, body: &(impl Observed + ?Sized)) -> Vec<f64> {
        let mut temperature = vec![0.0; body.cells()];
        body.temperature_at_frozen_state(self, &mut temperature, &mut body.workspace());
        temperature
    }

    /// Distortion of the N cells of `body`, m into it.
    pub fn distortion(&self, body: &(impl Observed + ?Sized)) -> Vec<f64> {
        let mut distortion = vec![0.0; body.cells()];
        body.distortion_at_frozen_state(self, &mut distortion, &mut body.workspace());
        distortion
    }

    /// Mean temperatures of the cooled faces of `body`, K above the reference.
    pub fn faces(&self, body: &(impl Observed + ?Sized)) -> [f64; FACES] {
        body.cooled_temperature(self, &mut body.workspace())
    }
}

/// What is known of a body and seen of its state. At frozen state a flux acts through the direct feedthrough only, and surroundings
/// are those of the end of a step.
pub trait Observed {
    /// Number of cells N.
    fn cells(&self) -> usize;

    /// Length of the state vector; all zero is the body at the reference temperature.
    fn states(&self) -> usize;

    /// Decay rates (1/s, >= 0) of the leading, temperature-like entries of the state while the contact slides at `velocity` (m/s);
    /// the entries behind them are the heat account.
    fn decay_rates(&self, velocity: f64) -> Vec<f64>;

    /// State of the body at the uniform temperature `rise` (K) above the reference.
    fn uniform(&self, rise: f64, state: &mut [f64]);

    /// Memory for steps and observations, which the caller owns.
    fn workspace(&self) -> Workspace;

    /// Factors of the properties at the absolute mean temperature `mean` (K): 1 for a body of constants.
    fn scales_at(&self, _mean: f64) -> Scales {
        Scales::ONE
    }

    /// Validity radius of a linearization in the sliding velocity with the constants, m/s: a smaller difference hardly changes the direct
    /// feedthrough. With other properties it is multiplied by their [`Scales::pace`].
    fn velocity_validity(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether heat can enter through parts of the cells alone.
    fn divides_cells(&self) -> bool {
        false
    }

    /// Temperature of the N cells at frozen state, K above the reference.
    fn temperature_at_frozen_state(&self, at: &FrozenState, temperature: &mut [f64], work: &mut Workspace);

    /// Distortion of the N cells at frozen state, m into the body.
    fn distortion_at_frozen_state(&self, at: &FrozenState, distortion: &mut [f64], work: &mut Workspace);

    /// Mean temperatures of the cooled faces at frozen state.
    fn cooled_temperature(&self, at: &FrozenState, work: &mut Workspace) -> [f64; FACES];

    /// Mean temperature of the far face at frozen state.
    fn far_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64;

    /// Heat flows at frozen state, W/m: to the air beside the contact (without the flux `cooling`), and the total out of the
    /// far face.
    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2];

    /// Mean temperature of the whole body.
    fn mean_temperature(&self, state: &[f64]) -> f64;

    /// Heat account; exact for the exact propagation of the states.
    fn account(&self, state: &[f64]) -> Account;

    /// Relative error of the reduction for the mean contact temperature, computed when the body was made.
    fn error_of_the_mean(&self) -> f64;
}
