//! Weights and gains of one step.

use super::give_back::Closure;
use super::operators::Operators;
use super::propagate::Motion;
use super::remainder::Blocks;
use crate::heat::line::{GAMMA, Gains, Stage};
use nalgebra::{Complex, DMatrix};

/// What carries the state to one stage.
#[derive(Clone, Debug)]
pub struct StageWeights {
    /// This is the end of the step.
    pub at_end: bool,
    /// Factor of each state of the waves.
    pub factor: Vec<Complex<f64>>,
    /// Weights of the two stages' fluxes in each state, input included.
    pub weight: Vec<[Complex<f64>; 2]>,
    /// Surface amplitude and distortion that the first stage's flux leaves in a wave.
    pub carried: Vec<Complex<f64>>,
    pub carried_distortion: Vec<Complex<f64>>,
    /// Factor and weights of the mean wave's states, without input.
    pub mean_factor: Vec<f64>,
    pub mean_weight: Vec<[f64; 2]>,
    /// Response of the waves to this stage's fluxes, without what answers at once and without heat given back.
    pub slow: DMatrix<f64>,
    pub slow_distortion: DMatrix<f64>,
    /// The whole response to the contact's flux.
    pub gains: Gains,
    /// Heat given back.
    pub closure: Closure,
}

/// The prepared step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Length, s, and velocities; not a number before the first one.
    pub length: f64,
    pub velocity: [f64; 2],
    pub first: StageWeights,
    pub end: StageWeights,
    blocks: [Blocks; 2],
}

/// Work space of the evaluations.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Total fluxes into the cells.
    pub first: Vec<f64>,
    pub end: Vec<f64>,
    /// Even and odd halves of fluxes and answers.
    pub fold: [Vec<f64>; 2],
    pub answer: [Vec<f64>; 2],
    /// Amplitudes of the waves: heat in both stages, temperature, distortion.
    pub heat: Vec<[f64; 2]>,
    pub heat_end: Vec<[f64; 2]>,
    pub amplitude: Vec<[f64; 2]>,
    pub moved: Vec<[f64; 2]>,
}

impl Scratch {
    pub fn new(operators: &Operators) -> Scratch {
        let (count, half, waves) = (operators.widths.len(), operators.half, operators.waves.len());
        let halves = || [vec![0.0; half], vec![0.0; half]];
        Scratch {
            first: vec![0.0; count],
            end: vec![0.0; count],
            fold: halves(),
            answer: halves(),
            heat: vec![[0.0; 2]; waves],
            heat_end: vec![[0.0; 2]; waves],
            amplitude: vec![[0.0; 2]; waves],
            moved: vec![[0.0; 2]; waves],
        }
    }
}

impl StageWeights {
    fn new(operators: &Operators, at_end: bool) -> StageWeights {
        let (count, states, waves) = (operators.widths.len(), operators.rate.len(), operators.waves.len());
        let zero = Complex::from(0.0);
        let moving = if operators.expands { count } else { 0 };
        StageWeights {
            at_end,
            factor: vec![zero; states],
            weight: vec![[zero; 2]; states],
            carried: vec![zero; waves],
            carried_distortion: vec![zero; waves],
            mean_factor: vec![0.0; operators.mean.count],
            mean_weight: vec![[0.0; 2]; operators.mean.count],
            slow: DMatrix::zeros(count, count),
            slow_distortion: DMatrix::zeros(moving, moving),
            gains: Gains { temperature: DMatrix::zeros(count, count), distortion: DMatrix::zeros(count, count) },
            closure: operators.give_back.as_ref().map_or_else(Closure::default, |give_back| give_back.closure()),
        }
    }

    /// Weights of the two stages' fluxes from those of a flux falling to 0 and one rising from 0 over the interval. In the
    /// first stage the flux is constant; at the end it is `[q1 (1 - t/h) + q2 (t/h - gamma)]/(1 - gamma)`.
    fn stage_fluxes<T>(&self, falling: T, rising: T) -> [T; 2]
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        if self.at_end {
            let by_first = falling * (1.0 / (1.0 - GAMMA));
            [by_first, falling + rising - by_first]
        } else {
            let all = falling + rising;
            [all, all - all]
        }
    }

    fn prepare(&mut self, operators: &Operators, length: f64, velocity: [f64; 2], blocks: &mut [Blocks; 2]) {
        let mean = &operators.mean;
        for k in 0..mean.count {
            let motion = Motion { turning: [0.0; 2], step: length };
            let (factor, falling, rising) = motion.weights(mean.rate[k], Complex::from(1.0));
            self.mean_factor[k] = factor.re;
            self.mean_weight[k] = self.stage_fluxes(falling.re, rising.re);
        }
        let [warm, moved] = blocks;
        warm.clear();
        moved.clear();
        let own = usize::from(self.at_end);
        for (wave, range) in operators.ranges.iter().enumerate() {
            let number = operators.waves[wave].number;
            let motion = Motion { turning: [number * velocity[0], number * velocity[1]], step: length };
            let turn = motion.turn();
            let zero = Complex::from(0.0);
            let (mut carried, mut gain) = ([zero; 2], [zero; 2]);
            for k in range.clone() {
                let (factor, falling, rising) = motion.weights(operators.rate[k], turn);
                self.factor[k] = factor;
                let weight = self.stage_fluxes(falling, rising).map(|weight| weight * operators.temperature[k]);
                self.weight[k] = weight;
                for (part, observed) in [operators.temperature[k], operators.distortion[k]].into_iter().enumerate() {
                    carried[part] += weight[0] * observed;
                    gain[part] += weight[own] * observed;
                }
            }
            (self.carried[wave], self.carried_distortion[wave]) = (carried[0], carried[1]);
            let (even, odd) = operators.shapes.rows(wave);
            warm.add_wave(gain[0] * operators.weight[wave], even, odd);
            if operators.expands {
                moved.add_wave(gain[1] * operators.weight[wave], even, odd);
            }
        }
        self.assemble(operators, velocity[1], blocks);
    }

    /// Gains from the waves' response in `blocks`, the mean wave's, and what answers at once at the stage's velocity.
    fn assemble(&mut self, operators: &Operators, velocity: f64, blocks: &mut [Blocks; 2]) {
        let mean = &operators.mean;
        let own = usize::from(self.at_end);
        for (moving, (slow, gain)) in
            [(&mut self.slow, &mut self.gains.temperature), (&mut self.slow_distortion, &mut self.gains.distortion)]
                .into_iter()
                .enumerate()
        {
            if moving == 1 && !operators.expands {
                continue;
            }
            let observed = if moving == 1 { &mean.mean_temperature } else { &mean.contact_temperature };
            let mut level = observed.direct[super::CONTACT];
            for k in 0..mean.count {
                level += observed.states[k] * mean.input[super::CONTACT][k] * self.mean_weight[k][own];
            }
            if moving == 1 {
                level *= operators.mean_distortion;
            }
            for (j, width) in operators.widths.iter().enumerate() {
                slow.column_mut(j).fill(level * width / operators.period);
            }
            blocks[moving].add_to(&operators.widths, slow);
            gain.copy_from(slow);
            blocks[moving].clear();
            for (knot, weight, reversed) in operators.table.stencil(velocity) {
                let at_knot = if moving == 1 {
                    operators.table.distortion(knot)
                } else {
                    Some(operators.table.temperature(knot))
                };
                if let Some(at_knot) = at_knot {
                    blocks[moving].add_scaled(weight, at_knot, reversed);
                }
            }
            blocks[moving].add_to(&operators.widths, gain);
        }
        if let Some(give_back) = &operators.give_back {
            give_back.close(&self.slow, &mut self.closure);
            give_back.add_gains(&self.closure, &self.slow, &mut self.gains.temperature);
            if operators.expands {
                give_back.add_gains(&self.closure, &self.slow_distortion, &mut self.gains.distortion);
            }
        }
    }
}

impl Step {
    pub fn new(operators: &Operators) -> Step {
        Step {
            length: f64::NAN,
            velocity: [f64::NAN; 2],
            first: StageWeights::new(operators, false),
            end: StageWeights::new(operators, true),
            blocks: [Blocks::zeros(operators.half), Blocks::zeros(operators.half)],
        }
    }

    pub fn stage(&self, stage: Stage) -> &StageWeights {
        match stage {
            Stage::First => &self.first,
            Stage::End => &self.end,
        }
    }

    pub fn prepare(&mut self, operators: &Operators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity {
            return;
        }
        (self.length, self.velocity) = (length, velocity);
        let middle = velocity[0] + GAMMA * (velocity[1] - velocity[0]);
        self.first.prepare(operators, GAMMA * length, [velocity[0], middle], &mut self.blocks);
        self.end.prepare(operators, length, velocity, &mut self.blocks);
    }
}
