//! Weights of the states for one step size: exact propagation for fluxes that are linear over a stage.
//!
//! Theory: docs/theory.md, section 5.3.

use super::ReducedOperators;
use super::modes::{ModeResponses, Modes, Scratch};
use crate::line::{GAMMA, SurfaceInfluence};
use numerics::dense;

/// Weights of the states and surface influence matrices for one step size.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    pub step: f64,
    pub stages: [StageWeights; 2],
}

/// Weights of the inputs and initial states in the states at a stage.
#[derive(Clone, Debug)]
pub(crate) struct StageWeights {
    /// Weight of the state at the start.
    pub decay: Vec<f64>,
    /// Weight of inputs that are constant from the start to the stage, s.
    pub constant: Vec<f64>,
    /// Weight of inputs that fall from 1 at the start to 0 at the stage, s.
    pub falling: Vec<f64>,
    /// Weight of the modal heat of the fluxes known before the stage (see
    /// [`free_response`](crate::line::SingleStep::free_response)), s times Z at the contact.
    pub known: Vec<f64>,
    /// Weight of the modal heat of the stage's own fluxes, and of its own fluxes into the cooled faces.
    pub own: Vec<f64>,
    pub by_face: Vec<f64>,
    pub by_heat: ModeResponses,
    /// Through whole cells.
    pub influence: SurfaceInfluence,
}

impl ReducedOperators {
    pub(super) fn allocate(&self, modes: &Modes) -> Weights {
        let states = || vec![0.0; self.states()];
        let cells = self.widths.len();
        let stage = || StageWeights {
            decay: states(),
            constant: states(),
            falling: states(),
            known: states(),
            own: states(),
            by_face: states(),
            by_heat: modes.responses(),
            influence: SurfaceInfluence { temperature: dense::untouched(cells), distortion: dense::untouched(cells) },
        };
        Weights { step: f64::NAN, stages: [stage(), stage()] }
    }

    pub(super) fn fill(&self, modes: &Modes, weights: &mut Weights, step: f64, scratch: &mut Scratch) {
        weights.step = step;
        let [first, end] = &mut weights.stages;
        for (k, &rate) in self.rate.iter().enumerate() {
            let (early, whole) = (rate * GAMMA * step, rate * step);
            let contact = self.contact[k];
            first.decay[k] = (-early).exp();
            first.constant[k] = GAMMA * step * mean_decay(early);
            first.by_face[k] = first.constant[k];
            first.own[k] = contact * first.constant[k];
            first.falling[k] = GAMMA * step * first_moment(early);
            first.known[k] = contact * first.falling[k];
            end.decay[k] = (-whole).exp();
            end.constant[k] = step * mean_decay(whole);
            // Flux q2 + (q2 - q1) (t - h)/((1 - gamma) h).
            end.falling[k] = step * first_moment(whole);
            let known = end.falling[k] / (1.0 - GAMMA);
            end.known[k] = contact * known;
            end.by_face[k] = end.constant[k] - known;
            end.own[k] = contact * end.by_face[k];
        }
        for stage in [&mut *first, &mut *end] {
            self.fill_influence(modes, stage, scratch);
        }
    }

    fn fill_influence(&self, modes: &Modes, stage: &mut StageWeights, scratch: &mut Scratch) {
        stage.influence.temperature.copy_from(&self.temperature_by_flux);
        stage.influence.distortion.copy_from(&self.distortion_by_flux);
        modes.add_influence(stage, &self.contact, scratch);
    }
}

/// Mean of exp(-x t) for t from 0 to 1.
pub(crate) fn mean_decay(x: f64) -> f64 {
    if x < 1e-5 { 1.0 - 0.5 * x * (1.0 - x / 3.0) } else { -(-x).exp_m1() / x }
}

/// Integral of t exp(-x t) for t from 0 to 1.
pub(crate) fn first_moment(x: f64) -> f64 {
    if x > 0.5 {
        return (mean_decay(x) - (-x).exp()) / x;
    }
    // sum (-x)^n / (n! (n + 2)), by Horner's rule.
    (0..14).rev().fold(0.0, |sum, n| {
        let n = f64::from(n);
        (n + 2.0).recip() - x / (n + 1.0) * sum
    })
}
