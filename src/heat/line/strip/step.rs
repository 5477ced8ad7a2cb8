//! Weights and gains of one step.

use super::answer::{Answer, AtOnce, Layout};
use super::blocks::Blocks;
use super::give_back::RANK;
use super::knots::Knots;
use super::levels::{self, of_wave, turns};
use super::operators::Operators;
use super::propagate::Motion;
use crate::contact::dense;
use crate::heat::line::{GAMMA, Gains, Stage};
use nalgebra::{Complex, DMatrix};

/// Index of the stage's own flux among its weights.
pub const OWN: usize = 1;

/// Turn of the shortest wave in a step up to which the answer is interpolated between velocities, rad.
const SHORT_TURN: f64 = 20.0;

/// Relative change of the velocity over a step up to which what answers at once changes linearly.
const LINEAR: f64 = 0.1;

/// Largest `q dv h/8` of the shortest wave at which its weights are those of the mean velocity.
const LEAST_DRIFT: f64 = 5e-4;

/// What carries the state to one stage.
#[derive(Clone, Debug)]
pub struct StageWeights {
    /// This is the end of the step.
    pub at_end: bool,
    /// Factor of each state of the waves: real parts, imaginary parts.
    pub factor: [Vec<f64>; 2],
    /// Factor and weights of the mean wave's states, without input.
    pub mean_factor: Vec<f64>,
    pub mean_weight: Vec<[f64; 2]>,
    /// What depends on the velocity.
    pub answer: Answer,
    /// Decay of each state over the interval, of this length.
    decay: Vec<f64>,
    length: f64,
    knots: Knots,
    /// Turn of each wave, real and imaginary part.
    turns: [Vec<f64>; 2],
}

/// A stage without its velocity.
#[derive(Clone, Copy)]
pub struct Interval<'a> {
    at_end: bool,
    length: f64,
    decay: &'a [f64],
    mean_weight: &'a [[f64; 2]],
}

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
    room: Room,
    immediate: Immediate,
}

/// Where answers are built: responses of the waves, split by parity and on the cells; of temperature and distortion.
#[derive(Clone, Debug)]
pub struct Room {
    blocks: [Blocks; 2],
    slow: [DMatrix<f64>; 2],
    /// Gains of the waves, and a number for each.
    gains: [Vec<Complex<f64>>; 2],
    terms: Vec<f64>,
    /// Room for a block and a row of it.
    turned: Vec<f64>,
}

impl Room {
    fn new(operators: &Operators) -> Room {
        let (count, waves) = (operators.widths.len(), operators.waves.len());
        let moving = if operators.expands { count } else { 0 };
        Room {
            blocks: [Blocks::zeros(operators.half), Blocks::zeros(operators.half)],
            slow: [DMatrix::zeros(count, count), DMatrix::zeros(moving, moving)],
            gains: [vec![Complex::from(0.0); waves], vec![Complex::from(0.0); waves]],
            terms: vec![0.0; waves],
            turned: vec![0.0; (operators.half + 1) * operators.half],
        }
    }

    /// Sums the waves by their gains.
    fn sum_waves(&mut self, operators: &Operators) {
        let moving = 1 + usize::from(operators.expands);
        for (blocks, gains) in self.blocks.iter_mut().zip(&self.gains).take(moving) {
            blocks.clear();
            blocks.add_waves(gains, &operators.shapes, &mut self.terms);
        }
    }
}

/// Work space of the evaluations.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Total fluxes into the cells.
    pub first: Vec<f64>,
    pub end: Vec<f64>,
    /// Even and odd halves of fluxes and of answers, of temperature and distortion.
    pub fold: [Vec<f64>; 2],
    pub answer: [[Vec<f64>; 2]; 2],
    /// States of the waves that are carried in place, real and imaginary parts.
    pub before: [Vec<f64>; 2],
    /// For what answers at once with the state held.
    pub held: [Vec<f64>; 2],
    /// Amplitudes of the waves, real and imaginary parts: heat in both stages, temperature, distortion.
    pub heat: [Vec<f64>; 2],
    pub heat_end: [Vec<f64>; 2],
    pub amplitude: [Vec<f64>; 2],
    pub moved: [Vec<f64>; 2],
    /// What the heat transfer given back at either stage follows.
    pub projected: [[f64; RANK]; 2],
    /// How much of it there is, by polynomial.
    pub returned: [[f64; RANK]; 2],
}

impl Scratch {
    pub fn new(operators: &Operators) -> Scratch {
        let (count, half, waves) = (operators.widths.len(), operators.half, operators.waves.len());
        let halves = || [vec![0.0; half], vec![0.0; half]];
        let parts = || [vec![0.0; waves], vec![0.0; waves]];
        Scratch {
            first: vec![0.0; count],
            end: vec![0.0; count],
            fold: halves(),
            answer: [halves(), halves()],
            before: [vec![0.0; operators.rate.len()], vec![0.0; operators.rate.len()]],
            held: [vec![0.0; count], vec![0.0; count]],
            heat: parts(),
            heat_end: parts(),
            amplitude: parts(),
            moved: parts(),
            projected: [[0.0; RANK]; 2],
            returned: [[0.0; RANK]; 2],
        }
    }
}

impl Interval<'_> {
    /// Weights of the known flux and the stage's own from those of a flux falling to 0 and one rising from 0 over the
    /// interval. In the first stage the flux is `q1 + e (1 - t/(gamma h))`, at the end
    /// `[q1 (1 - t/h) + q2 (t/h - gamma)]/(1 - gamma)`.
    fn stage_fluxes<T>(&self, falling: T, rising: T) -> [T; 2]
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        stage_fluxes(self.at_end, falling, rising)
    }

    /// The answer for a velocity that is linear over the interval.
    pub fn respond(&self, operators: &Operators, velocity: [f64; 2], room: &mut Room, answer: &mut Answer) {
        let (fade, faded) = self.fading(operators, velocity);
        let parts = answer.parts();
        for (wave, &number) in operators.numbers.iter().enumerate() {
            let motion = Motion { turning: velocity.map(|v| number * v), step: self.length };
            let turn = motion.turn();
            let zero = Complex::from(0.0);
            let (mut carried, mut gain) = ([zero; 2], [zero; 2]);
            for k in of_wave(&operators.levels, wave) {
                let (_, falling, rising) =
                    motion.weights_of_decay(operators.rate[k] + fade, faded * self.decay[k], turn);
                let [known, own] = self.stage_fluxes(falling, rising).map(|weight| weight * operators.temperature[k]);
                if self.at_end {
                    parts.weights[0][k] = known.re;
                    parts.weights[1][k] = known.im;
                    parts.weights[2][k] = own.re;
                    parts.weights[3][k] = own.im;
                }
                for (part, observed) in [operators.temperature[k], operators.distortion[k]].into_iter().enumerate() {
                    carried[part] += known * observed;
                    gain[part] += own * observed;
                }
            }
            parts.carried[0][wave] = carried[0].re;
            parts.carried[1][wave] = carried[0].im;
            parts.carried[2][wave] = carried[1].re;
            parts.carried[3][wave] = carried[1].im;
            for (gains, gain) in room.gains.iter_mut().zip(gain) {
                gains[wave] = gain * operators.weight[wave];
            }
        }
        room.sum_waves(operators);
        self.assemble(operators, room, answer);
    }

    /// Rate at which fresh material makes forget, and its factor over the interval.
    fn fading(&self, operators: &Operators, velocity: [f64; 2]) -> (f64, f64) {
        let fade = operators.forgetting.mean(velocity);
        (fade, (-fade * self.length).exp())
    }

    /// Gains from the waves' response in the blocks and the mean wave's, with the heat given back.
    fn assemble(&self, operators: &Operators, room: &mut Room, answer: &mut Answer) {
        let mean = &operators.mean;
        let Room { blocks, slow, turned, .. } = room;
        for (moving, slow) in slow.iter_mut().enumerate() {
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
            blocks[moving].unfold(&operators.widths, level / operators.period, turned, slow);
            let gain = if moving == 1 { &mut answer.gains.distortion } else { &mut answer.gains.temperature };
            gain.copy_from(slow);
            answer.parts().set_uniform(moving, slow);
        }
        if let Some(give_back) = &operators.give_back {
            let parts = answer.parts();
            give_back.close(slow, parts);
            let (gains, parts) = answer.gains_and_parts();
            give_back.add_gains(&parts, 0, &mut gains.temperature);
            if operators.expands {
                give_back.add_gains(&parts, 1, &mut gains.distortion);
            }
        }
    }
}

fn stage_fluxes<T>(at_end: bool, falling: T, rising: T) -> [T; 2]
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

impl StageWeights {
    /// Which stage this is.
    pub fn stage(&self) -> Stage {
        if self.at_end { Stage::End } else { Stage::First }
    }

    /// Weight in a state of the mean wave of a flux falling to 0 at the stage, from that of the known flux.
    pub fn falling(&self, known: f64) -> f64 {
        if self.at_end { (1.0 - GAMMA) * known } else { known }
    }

    fn new(operators: &Operators, at_end: bool) -> StageWeights {
        let (states, waves) = (operators.rate.len(), operators.waves.len());
        let layout = Layout::new(operators, at_end);
        StageWeights {
            at_end,
            factor: [vec![0.0; states], vec![0.0; states]],
            mean_factor: vec![0.0; operators.mean.count],
            mean_weight: vec![[0.0; 2]; operators.mean.count],
            answer: Answer::new(layout),
            decay: vec![0.0; states],
            length: f64::NAN,
            knots: Knots::new(layout, operators.steady > 0.0),
            turns: [vec![0.0; waves], vec![0.0; waves]],
        }
    }

    fn prepare(
        &mut self,
        operators: &Operators,
        length: f64,
        velocity: [f64; 2],
        immediate: AtOnce<'_>,
        room: &mut Room,
    ) {
        self.take_length(operators, length);
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let motion = Motion { turning: velocity.map(|v| shortest * v), step: length };
        let drift = motion.drift();
        let turn = length * motion.turning[0].abs().max(motion.turning[1].abs());
        let interval = Interval { at_end: self.at_end, length, decay: &self.decay, mean_weight: &self.mean_weight };
        let interpolated = drift < operators.steady && turn < SHORT_TURN;
        if interpolated {
            let middle = 0.5 * (velocity[0] + velocity[1]);
            self.knots.interpolate(operators, &interval, length, middle, immediate, room, &mut self.answer);
        } else {
            interval.respond(operators, velocity, room, &mut self.answer);
            immediate.iter().for_each(|(responses, share)| add(responses, *share, &mut self.answer.gains));
        }
        if interpolated && drift > LEAST_DRIFT {
            interval.weigh(operators, velocity, &mut self.answer);
        }
        self.carry(operators, velocity);
    }

    /// What depends on the length of the interval alone.
    fn take_length(&mut self, operators: &Operators, length: f64) {
        let mean = &operators.mean;
        if self.length != length {
            self.length = length;
            for k in 0..mean.count {
                let motion = Motion { turning: [0.0; 2], step: length };
                let (factor, falling, rising) = motion.weights(mean.rate[k], Complex::from(1.0));
                self.mean_factor[k] = factor.re;
                self.mean_weight[k] = stage_fluxes(self.at_end, falling.re, rising.re);
            }
            for (decay, rate) in self.decay.iter_mut().zip(&operators.rate) {
                *decay = (-rate * length).exp();
            }
        }
    }

    /// Factors of the waves' states over the interval.
    fn carry(&mut self, operators: &Operators, velocity: [f64; 2]) {
        let fade = operators.forgetting.mean(velocity);
        let faded = (-fade * self.length).exp();
        let [cosine, sine] = &mut self.turns;
        turns(0.5 * self.length * (velocity[0] + velocity[1]), &operators.numbers, cosine, sine);
        levels::turn(
            &operators.levels,
            &self.decay,
            faded,
            [cosine, sine],
            self.factor.each_mut().map(|part| &mut part[..]),
        );
    }
}

impl Interval<'_> {
    /// The weights of the known fluxes and, at the end, those in the states, without the gains.
    fn weigh(&self, operators: &Operators, velocity: [f64; 2], answer: &mut Answer) {
        let (fade, faded) = self.fading(operators, velocity);
        let parts = answer.parts();
        for (wave, &number) in operators.numbers.iter().enumerate() {
            let motion = Motion { turning: velocity.map(|v| number * v), step: self.length };
            let turn = motion.turn();
            let mut carried = [Complex::from(0.0); 2];
            for k in of_wave(&operators.levels, wave) {
                let (_, falling, rising) =
                    motion.weights_of_decay(operators.rate[k] + fade, faded * self.decay[k], turn);
                let [known, own] = self.stage_fluxes(falling, rising).map(|weight| weight * operators.temperature[k]);
                if self.at_end {
                    parts.weights[0][k] = known.re;
                    parts.weights[1][k] = known.im;
                    parts.weights[2][k] = own.re;
                    parts.weights[3][k] = own.im;
                }
                carried[0] += known * operators.temperature[k];
                carried[1] += known * operators.distortion[k];
            }
            parts.carried[0][wave] = carried[0].re;
            parts.carried[1][wave] = carried[0].im;
            parts.carried[2][wave] = carried[1].re;
            parts.carried[3][wave] = carried[1].im;
        }
    }
}

impl StageWeights {
    /// Weights of one implicit Euler step of the interval's length, with a flux that is constant over it.
    fn prepare_euler(&mut self, operators: &Operators, length: f64, velocity: [f64; 2], room: &mut Room) {
        // The next step of two stages makes its own decays.
        self.length = f64::NAN;
        let mean = &operators.mean;
        for k in 0..mean.count {
            let (factor, weight) = Motion { turning: [0.0; 2], step: length }.euler(mean.rate[k]);
            self.mean_factor[k] = factor.re;
            self.mean_weight[k] = [0.0, weight.re];
        }
        let fade = operators.forgetting.mean(velocity);
        let parts = self.answer.parts();
        for known in parts.carried {
            known.fill(0.0);
        }
        let [known_re, known_im, own_re, own_im] = parts.weights;
        known_re.fill(0.0);
        known_im.fill(0.0);
        for (wave, &number) in operators.numbers.iter().enumerate() {
            let motion = Motion { turning: velocity.map(|v| number * v), step: length };
            let mut gain = [Complex::from(0.0); 2];
            for k in of_wave(&operators.levels, wave) {
                let (factor, weight) = motion.euler(operators.rate[k] + fade);
                let weight = weight * operators.temperature[k];
                (self.factor[0][k], self.factor[1][k]) = (factor.re, factor.im);
                if self.at_end {
                    (own_re[k], own_im[k]) = (weight.re, weight.im);
                }
                gain[0] += weight * operators.temperature[k];
                gain[1] += weight * operators.distortion[k];
            }
            for (gains, gain) in room.gains.iter_mut().zip(gain) {
                gains[wave] = gain * operators.weight[wave];
            }
        }
        room.sum_waves(operators);
        let interval = Interval { at_end: self.at_end, length, decay: &self.decay, mean_weight: &self.mean_weight };
        interval.assemble(operators, room, &mut self.answer);
    }
}

/// A velocity without its last twelve bits: what the next step starts with differs from the end of this one by rounding.
fn rounded(velocity: f64) -> f64 {
    f64::from_bits((velocity.to_bits() + 0x800) & !0xfff)
}

/// What answers at once, on the cells, at the velocities last asked for: the end of a step is the start of the next.
#[derive(Clone, Debug)]
struct Immediate {
    known: [(f64, u64, [DMatrix<f64>; 2]); 3],
    clock: u64,
}

impl Immediate {
    fn new(operators: &Operators) -> Immediate {
        let count = operators.widths.len();
        let moving = if operators.expands { count } else { 0 };
        let matrices = || (f64::NAN, 0, [DMatrix::zeros(count, count), DMatrix::zeros(moving, moving)]);
        Immediate { known: [matrices(), matrices(), matrices()], clock: 0 }
    }

    /// Place of the responses at a velocity.
    fn find(&mut self, operators: &Operators, velocity: f64) -> usize {
        let velocity = rounded(velocity);
        self.clock += 1;
        let found = self.known.iter().position(|known| known.0 == velocity);
        let place = found.unwrap_or_else(|| (0..3).min_by_key(|&place| self.known[place].1).unwrap_or(0));
        let (of, used, matrices) = &mut self.known[place];
        *used = self.clock;
        if found.is_none() {
            *of = velocity;
            for (moving, matrix) in matrices.iter_mut().enumerate() {
                if matrix.ncols() == 0 {
                    continue;
                }
                operators.table.respond(moving, velocity, matrix);
            }
        }
        place
    }

    /// Responses at a place.
    fn at(&self, place: usize) -> &[DMatrix<f64>; 2] {
        &self.known[place].2
    }
}

/// Adds part of responses to the gains.
fn add([warm, moved]: &[DMatrix<f64>; 2], part: f64, gains: &mut Gains) {
    for (matrix, gain) in [(warm, &mut gains.temperature), (moved, &mut gains.distortion)] {
        if !matrix.is_empty() {
            dense::multiply_add(matrix.as_slice(), &[part], gain.as_mut_slice());
        }
    }
}

/// Velocities from the start of a step to its first stage.
fn to_first_stage([from, to]: [f64; 2]) -> [f64; 2] {
    [from, from + GAMMA * (to - from)]
}

impl Step {
    pub fn new(operators: &Operators) -> Step {
        Step {
            length: f64::NAN,
            velocity: [f64::NAN; 2],
            euler: false,
            first: StageWeights::new(operators, false),
            end: StageWeights::new(operators, true),
            room: Room::new(operators),
            immediate: Immediate::new(operators),
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
        let Some(kept) = &operators.kept else { return self.find(operators, length, velocity) };
        // The way back is that there mirrored: one answer serves both.
        let back = velocity[0] + velocity[1] < 0.0;
        let forwards = if back { velocity.map(|v| 0.0 - v) } else { velocity };
        match kept.get(length, forwards) {
            Some(known) => {
                let stages = [&mut self.first, &mut self.end].into_iter().zip(known.iter());
                for ((stage, answer), length) in stages.zip([GAMMA * length, length]) {
                    stage.take_length(operators, length);
                    stage.answer.copy_from(answer);
                }
            }
            None => {
                self.find(operators, length, forwards);
                kept.keep(length, forwards, [&self.first.answer, &self.end.answer]);
            }
        }
        for (stage, velocity) in [&mut self.first, &mut self.end].into_iter().zip([to_first_stage(velocity), velocity])
        {
            if back {
                stage.answer.mirror();
            }
            stage.carry(operators, velocity);
        }
    }

    /// Finds the answers of both stages.
    fn find(&mut self, operators: &Operators, length: f64, velocity: [f64; 2]) {
        let [_, middle] = to_first_stage(velocity);
        let Step { first, end, room, immediate, .. } = self;
        let last = immediate.find(operators, velocity[1]);
        let straight = (velocity[1] - velocity[0]).abs() <= LINEAR * operators.table.scale().hypot(middle);
        if straight && velocity[0] != velocity[1] {
            let start = immediate.find(operators, velocity[0]);
            let both = [(immediate.at(start), 1.0 - GAMMA), (immediate.at(last), GAMMA)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &both, room);
        } else {
            let between = immediate.find(operators, middle);
            let one = [(immediate.at(between), 1.0)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &one, room);
        }
        end.prepare(operators, length, velocity, &[(immediate.at(last), 1.0)], room);
    }

    /// One implicit Euler step: both stages are its end.
    pub fn prepare_euler(&mut self, operators: &Operators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity && self.euler {
            return;
        }
        (self.length, self.velocity, self.euler) = (length, velocity, true);
        for stage in [&mut self.first, &mut self.end] {
            stage.prepare_euler(operators, length, velocity, &mut self.room);
        }
        let end = self.immediate.find(operators, velocity[1]);
        for stage in [&mut self.first, &mut self.end] {
            add(self.immediate.at(end), 1.0, &mut stage.answer.gains);
        }
    }
}
