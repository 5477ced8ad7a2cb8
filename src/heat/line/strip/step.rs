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
    /// Weights of the fluxes in each state, input included: of those known before the stage (in the first stage the
    /// deviation at its start, at the end the fluxes of the first) and of its own.
    pub weight: Vec<[Complex<f64>; 2]>,
    /// Surface amplitude and distortion that the known flux leaves in a wave.
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
    /// Decay of each state over the interval, of this length.
    decay: Vec<f64>,
    length: f64,
    knots: Knots,
}

/// Gains of the waves at velocities that are multiples of one spacing, for one length of the interval: neighbouring
/// velocities share them.
#[derive(Clone, Debug)]
struct Knots {
    length: f64,
    spacing: f64,
    /// Index and gains of temperature and distortion, in the slot `index mod SLOTS`.
    slots: Vec<(i64, [Blocks; 2])>,
}

/// Index of the stage's own flux among its weights.
pub const OWN: usize = 1;

/// Knots kept.
const SLOTS: i64 = 8;
/// Turn of the shortest wave from knot to knot, rad: the cubic through four knots is off by .023 of its fourth power for that
/// wave, and by less with the fourth power of the wave number for longer ones.
const KNOT_TURN: f64 = 0.5;
/// The prepared step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Length, s, and velocities; not a number before the first one.
    pub length: f64,
    pub velocity: [f64; 2],
    /// One implicit Euler step.
    euler: bool,
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
            decay: vec![0.0; states],
            length: f64::NAN,
            knots: Knots {
                length: f64::NAN,
                spacing: 1.0,
                slots: (0..SLOTS)
                    .map(|_| (i64::MIN, [Blocks::zeros(operators.half), Blocks::zeros(operators.half)]))
                    .collect(),
            },
            closure: operators.give_back.as_ref().map_or_else(Closure::default, |give_back| give_back.closure()),
        }
    }

    /// Weights of the known flux and the stage's own from those of a flux falling to 0 and one rising from 0 over the
    /// interval. In the first stage the flux is `q1 + e (1 - t/(gamma h))`, at the end
    /// `[q1 (1 - t/h) + q2 (t/h - gamma)]/(1 - gamma)`.
    fn stage_fluxes<T>(&self, falling: T, rising: T) -> [T; 2]
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        if self.at_end {
            let by_first = falling * (1.0 / (1.0 - GAMMA));
            [by_first, falling + rising - by_first]
        } else {
            [falling, falling + rising]
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
        if self.length != length {
            self.length = length;
            for (decay, rate) in self.decay.iter_mut().zip(&operators.rate) {
                *decay = (-rate * length).exp();
            }
        }
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let drift = Motion { turning: velocity.map(|v| shortest * v), step: length }.drift();
        // A constant velocity is worth its own gains; one that changes slowly takes them from its neighbours.
        let between = velocity[0] != velocity[1] && drift < operators.steady;
        let [warm, moved] = blocks;
        warm.clear();
        moved.clear();
        let fade = operators.forgetting.mean(velocity);
        let faded = (-fade * length).exp();
        for (wave, range) in operators.ranges.iter().enumerate() {
            let number = operators.waves[wave].number;
            let motion = Motion { turning: [number * velocity[0], number * velocity[1]], step: length };
            let turn = motion.turn();
            let zero = Complex::from(0.0);
            let (mut carried, mut gain) = ([zero; 2], [zero; 2]);
            for k in range.clone() {
                let (factor, falling, rising) =
                    motion.weights_of_decay(operators.rate[k] + fade, faded * self.decay[k], turn);
                self.factor[k] = factor;
                let weight = self.stage_fluxes(falling, rising).map(|weight| weight * operators.temperature[k]);
                self.weight[k] = weight;
                for (part, observed) in [operators.temperature[k], operators.distortion[k]].into_iter().enumerate() {
                    carried[part] += weight[0] * observed;
                    gain[part] += weight[OWN] * observed;
                }
            }
            (self.carried[wave], self.carried_distortion[wave]) = (carried[0], carried[1]);
            if !between {
                let (even, odd) = operators.shapes.rows(wave);
                warm.add_wave(gain[0] * operators.weight[wave], even, odd);
                if operators.expands {
                    moved.add_wave(gain[1] * operators.weight[wave], even, odd);
                }
            }
        }
        if between {
            self.interpolate(operators, shortest, 0.5 * (velocity[0] + velocity[1]), blocks);
        }
        self.assemble(operators, velocity[1], blocks);
    }

    /// Weights of one implicit Euler step of the interval's length, with a flux that is constant over it.
    fn prepare_euler(&mut self, operators: &Operators, length: f64, velocity: [f64; 2], blocks: &mut [Blocks; 2]) {
        let own = usize::from(self.at_end);
        let mean = &operators.mean;
        for k in 0..mean.count {
            let (factor, weight) = Motion { turning: [0.0; 2], step: length }.euler(mean.rate[k]);
            self.mean_factor[k] = factor.re;
            self.mean_weight[k] = [0.0; 2];
            self.mean_weight[k][own] = weight.re;
        }
        let zero = Complex::from(0.0);
        self.carried.fill(zero);
        self.carried_distortion.fill(zero);
        let [warm, moved] = blocks;
        warm.clear();
        moved.clear();
        let fade = operators.forgetting.mean(velocity);
        for (wave, range) in operators.ranges.iter().enumerate() {
            let number = operators.waves[wave].number;
            let motion = Motion { turning: velocity.map(|v| number * v), step: length };
            let mut gain = [zero; 2];
            for k in range.clone() {
                let (factor, weight) = motion.euler(operators.rate[k] + fade);
                let weight = weight * operators.temperature[k];
                self.factor[k] = factor;
                self.weight[k] = [zero; 2];
                self.weight[k][own] = weight;
                gain[0] += weight * operators.temperature[k];
                gain[1] += weight * operators.distortion[k];
            }
            let (even, odd) = operators.shapes.rows(wave);
            warm.add_wave(gain[0] * operators.weight[wave], even, odd);
            if operators.expands {
                moved.add_wave(gain[1] * operators.weight[wave], even, odd);
            }
        }
        self.assemble(operators, velocity[1], blocks);
    }

    /// Gains of the waves at a velocity from the four knots around it.
    fn interpolate(&mut self, operators: &Operators, shortest: f64, velocity: f64, blocks: &mut [Blocks; 2]) {
        if self.knots.length != self.length {
            self.knots.length = self.length;
            self.knots.spacing = KNOT_TURN / (shortest * self.length);
            self.knots.slots.iter_mut().for_each(|slot| slot.0 = i64::MIN);
        }
        let position = velocity / self.knots.spacing;
        let base = position.floor();
        let t = position - base;
        let weights = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        for (k, weight) in weights.into_iter().enumerate() {
            let index = base as i64 + k as i64 - 1;
            let slot = index.rem_euclid(SLOTS) as usize;
            if self.knots.slots[slot].0 != index {
                let mut fresh = std::mem::replace(&mut self.knots.slots[slot].1, [Blocks::empty(), Blocks::empty()]);
                self.gains_at(operators, index as f64 * self.knots.spacing, &mut fresh);
                self.knots.slots[slot] = (index, fresh);
            }
            for (total, knot) in blocks.iter_mut().zip(&self.knots.slots[slot].1) {
                total.add_scaled(weight, knot, false);
            }
        }
    }

    /// Gains of the waves at a constant velocity.
    fn gains_at(&self, operators: &Operators, velocity: f64, blocks: &mut [Blocks; 2]) {
        let [warm, moved] = blocks;
        warm.clear();
        moved.clear();
        let fade = operators.forgetting.rate(velocity);
        let faded = (-fade * self.length).exp();
        for (wave, range) in operators.ranges.iter().enumerate() {
            let turning = operators.waves[wave].number * velocity;
            let motion = Motion { turning: [turning; 2], step: self.length };
            let turn = motion.turn();
            let mut gain = [Complex::from(0.0); 2];
            for k in range.clone() {
                let (_, falling, rising) =
                    motion.weights_of_decay(operators.rate[k] + fade, faded * self.decay[k], turn);
                let weight = self.stage_fluxes(falling, rising)[OWN] * operators.temperature[k];
                gain[0] += weight * operators.temperature[k];
                gain[1] += weight * operators.distortion[k];
            }
            let (even, odd) = operators.shapes.rows(wave);
            warm.add_wave(gain[0] * operators.weight[wave], even, odd);
            if operators.expands {
                moved.add_wave(gain[1] * operators.weight[wave], even, odd);
            }
        }
    }

    /// Gains from the waves' response in `blocks`, the mean wave's, and what answers at once at the stage's velocity.
    fn assemble(&mut self, operators: &Operators, velocity: f64, blocks: &mut [Blocks; 2]) {
        let mean = &operators.mean;
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
                level += observed.states[k] * mean.input[super::CONTACT][k] * self.mean_weight[k][OWN];
            }
            level *= operators.remembered();
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
            euler: false,
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
        if self.length == length && self.velocity == velocity && !self.euler {
            return;
        }
        (self.length, self.velocity, self.euler) = (length, velocity, false);
        let middle = velocity[0] + GAMMA * (velocity[1] - velocity[0]);
        self.first.prepare(operators, GAMMA * length, [velocity[0], middle], &mut self.blocks);
        self.end.prepare(operators, length, velocity, &mut self.blocks);
    }

    /// One implicit Euler step: both stages are its end.
    pub fn prepare_euler(&mut self, operators: &Operators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity && self.euler {
            return;
        }
        (self.length, self.velocity, self.euler) = (length, velocity, true);
        for stage in [&mut self.first, &mut self.end] {
            stage.prepare_euler(operators, length, velocity, &mut self.blocks);
        }
    }
}
