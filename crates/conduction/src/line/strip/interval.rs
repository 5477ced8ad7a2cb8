//! Response of one stage: influence matrices, and weights of the known fluxes.
//!
//! Theory: docs/theory.md, section 5.3.

use crate::line::GAMMA;
use crate::line::strip::CONTACT;
use crate::line::strip::distance::Nodes;
use crate::line::strip::operators::StripOperators;
use crate::line::strip::propagate::abreast::PhaseRotation;
use crate::line::strip::stage_response::{Parts, StageResponse};
use crate::line::strip::state_layout::{self, stage_weights};
use nalgebra::{Complex, DMatrix};
use numerics::dense;

/// Index of the stage's own flux among its weights.
pub(crate) const OWN: usize = 1;

/// Velocity-independent data of a stage.
#[derive(Clone, Copy)]
pub(crate) struct Interval<'a> {
    pub at_end: bool,
    /// Its length, s, and the last fraction of it whose heat the contact still feels.
    pub length: f64,
    pub felt: f64,
    /// Decay factors over that fraction.
    pub decay: &'a [f64],
    pub mean_weight: &'a [[f64; 2]],
}

/// Workspace of stage responses: responses of the modes by distance and on the cells, of temperature and distortion.
#[derive(Clone, Debug)]
pub(crate) struct IntervalWorkspace {
    nodes: Nodes,
    slow: [DMatrix<f64>; 2],
    /// Response of each mode: of temperature and distortion.
    influence: [Vec<Complex<f64>>; 2],
    /// Phase factors of the modes, and weights of fluxes in the states of one level; real and imaginary parts alternate.
    phases: [Vec<f64>; 2],
    fluxes: [Vec<f64>; 4],
}

impl IntervalWorkspace {
    pub(crate) fn new(operators: &StripOperators) -> IntervalWorkspace {
        let waves = operators.waves.len();
        IntervalWorkspace {
            nodes: operators.distance_sum.nodes(),
            slow: [operators.widths.len(), operators.lagged()].map(|count| DMatrix::zeros(count, count)),
            influence: [vec![Complex::from(0.0); waves], vec![Complex::from(0.0); waves]],
            phases: [0; 2].map(|_| vec![0.0; waves]),
            fluxes: [0; 4].map(|_| vec![0.0; waves]),
        }
    }
}

impl Interval<'_> {
    /// Stage response for a velocity that is linear over the interval, without direct feedthrough and Robin correction.
    pub(crate) fn respond(
        &self,
        operators: &StripOperators,
        velocity: [f64; 2],
        workspace: &mut IntervalWorkspace,
        response: &mut StageResponse,
    ) {
        self.weigh(operators, velocity, workspace, response);
        let IntervalWorkspace { nodes, slow, influence: [warm, moved], .. } = workspace;
        for (influence, own) in [&mut *warm, &mut *moved].into_iter().zip(response.own().chunks_exact(2)) {
            let parts = own[0].iter().zip(own[1]).zip(&operators.weight);
            influence.iter_mut().zip(parts).for_each(|(gain, ((re, im), weight))| {
                *gain = Complex::new(weight * re, weight * im);
            });
        }
        operators.distance_sum.find([warm, moved], nodes);
        let levels = [0, 1].map(|moving| self.level(operators, moving));
        operators.distance_sum.set(nodes, &operators.widths, levels, slow);
        let (influence, parts) = response.gains_and_parts();
        for ((own, whole), lifted) in influence.iter_mut().zip(slow).zip(parts.lifted) {
            if own.is_empty() {
                continue;
            }
            own.take(whole.as_slice(), &operators.widths);
            if let Some(robin_correction) = &operators.robin_correction {
                robin_correction.lift_by(own, lifted);
            }
        }
    }

    /// Response of the mean mode per heat into the contact: of temperature or distortion.
    fn level(&self, operators: &StripOperators, moving: usize) -> f64 {
        let mean = &operators.mean;
        let observed = if moving == 1 { &mean.mean_temperature } else { &mean.contact_temperature };
        let mut level = observed.direct[CONTACT];
        for k in 0..mean.count {
            level += observed.states[k] * mean.input[CONTACT][k] * self.mean_weight[k][OWN];
        }
        let distortion = if moving == 1 { operators.mean_distortion } else { 1.0 };
        level * operators.remembered() * distortion / operators.length
    }

    /// Computes the weights of both fluxes in the modes and, at the end, in the states, without the influence matrices.
    pub(crate) fn weigh(
        &self,
        operators: &StripOperators,
        velocity: [f64; 2],
        workspace: &mut IntervalWorkspace,
        response: &mut StageResponse,
    ) {
        let [from, to] = velocity;
        let (step, velocity) = (self.felt * self.length, [to - self.felt * (to - from), to]);
        let IntervalWorkspace { phases: [cosine, sine], fluxes, .. } = workspace;
        state_layout::phases(0.5 * step * (velocity[0] + velocity[1]), &operators.numbers, cosine, sine);
        let turning = PhaseRotation { velocity, step, numbers: &operators.numbers, phases: [cosine, sine] };
        let Parts { weights: mut kept, mut carried, mut own, .. } = response.parts();
        carried.iter_mut().chain(own.iter_mut()).for_each(|part| part.fill(0.0));
        for level in &operators.state_layout {
            let mut weights = fluxes.each_mut().map(|part| &mut part[..level.len()]);
            let [a, b, c, d] = &mut weights;
            turning.weights(&operators.rate[level.clone()], &self.decay[level.clone()], [a, b, c, d]);
            if self.felt < 1.0 {
                // At its start a flux that falls over the whole interval is `felt`, a rising one the rest.
                for (falling, rising) in [(a, c), (b, d)] {
                    dense::multiply_add(falling, &[1.0 - self.felt], rising);
                    falling.iter_mut().for_each(|weight| *weight *= self.felt);
                }
            }
            let [a, b, c, d] = &mut weights;
            let seen = [&operators.temperature[level.clone()], &operators.distortion[level.clone()]];
            let share = self.at_end.then_some(1.0 / (1.0 - GAMMA));
            let [carried, own] = [&mut carried, &mut own].map(|parts| parts.each_mut().map(|part| &mut part[..]));
            stage_weights(share, seen, [a, b, c, d], carried, own);
            if self.at_end {
                for (kept, found) in kept.iter_mut().zip(&weights) {
                    kept[level.clone()].copy_from_slice(found);
                }
            }
        }
    }
}

/// Weights of the known flux and the stage's own from those of a flux falling to 0 and one rising from 0 over the
/// interval. In the first stage the flux is `q1 + e (1 - t/(gamma h))`, at the end
/// `[q1 (1 - t/h) + q2 (t/h - gamma)]/(1 - gamma)`.
pub(crate) fn stage_fluxes<T>(at_end: bool, falling: T, rising: T) -> [T; 2]
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    if at_end {
        let by_first = falling * (1.0 / (1.0 - GAMMA));
        [by_first, falling + rising - by_first]
    } else {
        [falling, falling + rising]
    }
}
