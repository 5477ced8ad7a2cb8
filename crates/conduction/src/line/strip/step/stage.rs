//! Propagation of the state to one stage.
//!
//! Theory: docs/theory.md, section 5.3.

use crate::line::Stage;
use crate::line::strip::feedthrough::Feedthrough;
use crate::line::strip::interval::{Interval, IntervalWorkspace, stage_fluxes};
use crate::line::strip::nodes::InterpolationNodes;
use crate::line::strip::operators::StripOperators;
use crate::line::strip::propagate::{LEAST_DRIFT, PhaseRate};
use crate::line::strip::stage_response::StageResponse;
use crate::line::strip::state_layout::{self, phases};
use nalgebra::Complex;

/// Phase rotation of the shortest mode in a step up to which the response is interpolated between velocities, rad.
pub(crate) const SHORT_ROTATION: f64 = 20.0;

/// Propagation factors and weights of one stage, and its responses.
#[derive(Clone, Debug)]
pub(crate) struct StageWeights {
    /// This is the end of the step.
    pub at_end: bool,
    /// Propagation factor of each state of the modes: real parts, imaginary parts.
    pub factor: [Vec<f64>; 2],
    /// Propagation factors and flux weights of the mean mode's states, input excluded.
    pub mean_factor: Vec<f64>,
    pub mean_weight: Vec<[f64; 2]>,
    /// Velocity-dependent responses: that of the current step if not cached, and the cached ones of steps at constant
    /// velocity.
    pub responses: Vec<StageResponse>,
    pub current: usize,
    /// Factor of a lagged flux over the interval, and its weights of the known flux and of the stage's own.
    pub lag: [f64; 3],
    /// Length of the interval, s.
    length: f64,
    /// Decay factor of each state over the part of the interval whose heat the contact still feels, and its length, s.
    decay: Vec<f64>,
    felt: f64,
    nodes: InterpolationNodes,
    /// Phase factor of each mode, real and imaginary part.
    phases: [Vec<f64>; 2],
}

impl StageWeights {
    /// Which stage this is.
    pub(crate) fn stage(&self) -> Stage {
        if self.at_end { Stage::End } else { Stage::First }
    }

    /// The response of the current step.
    pub(crate) fn current_response(&self) -> &StageResponse {
        &self.responses[self.current]
    }

    /// Weights with a cache of `cached` responses.
    pub(crate) fn new(operators: &StripOperators, at_end: bool, cached: usize) -> StageWeights {
        let (states, waves) = (operators.rate.len(), operators.waves.len());
        let layout = operators.response_layout(at_end);
        StageWeights {
            at_end,
            factor: [vec![0.0; states], vec![0.0; states]],
            mean_factor: vec![0.0; operators.mean.count],
            mean_weight: vec![[0.0; 2]; operators.mean.count],
            responses: (0..=cached).map(|_| StageResponse::new(layout)).collect(),
            current: 0,
            decay: vec![0.0; states],
            lag: [1.0, 0.0, 0.0],
            length: f64::NAN,
            felt: f64::NAN,
            nodes: InterpolationNodes::new(layout),
            phases: [vec![0.0; waves], vec![0.0; waves]],
        }
    }

    /// Prepares the stage; `unknown`: what its response follows from, if it is not in the cache.
    pub(crate) fn prepare(
        &mut self,
        operators: &StripOperators,
        length: f64,
        velocity: [f64; 2],
        unknown: Option<(&Feedthrough, &mut IntervalWorkspace)>,
    ) {
        self.take(operators, length, velocity);
        if let Some((feedthrough, workspace)) = unknown {
            self.respond(operators, velocity, feedthrough, workspace);
        }
        self.carry(operators, velocity);
    }

    /// Computes the response.
    fn respond(
        &mut self,
        operators: &StripOperators,
        velocity: [f64; 2],
        feedthrough: &Feedthrough,
        workspace: &mut IntervalWorkspace,
    ) {
        let (length, at_end, felt, lagged) = (self.length, self.at_end, self.felt / self.length, self.lag[2]);
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let motion = PhaseRate { turning: velocity.map(|v| shortest * v), step: length };
        let drift = motion.drift();
        let phase = length * motion.turning[0].abs().max(motion.turning[1].abs());
        let interval = Interval { at_end, length, felt, decay: &self.decay, mean_weight: &self.mean_weight };
        let response = &mut self.responses[self.current];
        if drift < operators.steady && phase < SHORT_ROTATION && felt == 1.0 {
            let middle = 0.5 * (velocity[0] + velocity[1]);
            self.nodes.interpolate(operators, &interval, length, middle, (feedthrough, lagged), workspace, response);
            if drift > LEAST_DRIFT {
                interval.weigh(operators, velocity, workspace, response);
            }
        } else {
            interval.respond(operators, velocity, workspace, response);
            response.add(feedthrough, lagged);
        }
        if let Some(robin_correction) = &operators.robin_correction {
            robin_correction.complete(feedthrough, response);
        }
    }

    /// Computes the factors that depend on the length of the interval alone, and of the part of it whose heat is felt.
    fn take(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        let mean = &operators.mean;
        if self.length != length {
            self.length = length;
            for k in 0..mean.count {
                let motion = PhaseRate { turning: [0.0; 2], step: length };
                let (factor, falling, rising) = motion.weights(mean.rate[k], Complex::from(1.0));
                self.mean_factor[k] = factor.re;
                self.mean_weight[k] = stage_fluxes(self.at_end, falling.re, rising.re);
            }
        }
        let rate = operators.lag_rate(velocity);
        let (factor, falling, rising) = PhaseRate { turning: [0.0; 2], step: length }.weights(rate, Complex::from(1.0));
        let [known, own] = stage_fluxes(self.at_end, falling.re, rising.re);
        self.lag = [factor.re, rate * known, rate * own];
        let felt = length * operators.felt(length, velocity);
        if self.felt != felt {
            self.felt = felt;
            for (decay, rate) in self.decay.iter_mut().zip(&operators.rate) {
                *decay = (-rate * felt).exp();
            }
        }
    }

    /// Computes the propagation factors of the modes' states over the interval: 0 where the contact left their heat behind.
    fn carry(&mut self, operators: &StripOperators, velocity: [f64; 2]) {
        if self.felt < self.length {
            return self.factor.iter_mut().for_each(|part| part.fill(0.0));
        }
        let [cosine, sine] = &mut self.phases;
        phases(0.5 * self.length * (velocity[0] + velocity[1]), &operators.numbers, cosine, sine);
        state_layout::phase(
            &operators.state_layout,
            &self.decay,
            [cosine, sine],
            self.factor.each_mut().map(|part| &mut part[..]),
        );
    }
}
