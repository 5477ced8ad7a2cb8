//! The answer of one stage: gains, and weights of what is known before it.
//!
//! Theory: docs/theory.md, section 5.3.

use crate::line::GAMMA;
use crate::line::strip::CONTACT;
use crate::line::strip::answer::Answer;
use crate::line::strip::blocks::Blocks;
use crate::line::strip::operators::StripOperators;
use crate::line::strip::propagate::Motion;
use crate::line::strip::state_layout::of_mode;
use nalgebra::{Complex, DMatrix};

/// Index of the stage's own flux among its weights.
pub const OWN: usize = 1;

/// A stage without its velocity.
#[derive(Clone, Copy)]
pub struct Interval<'a> {
    pub at_end: bool,
    pub length: f64,
    pub decay: &'a [f64],
    pub mean_weight: &'a [[f64; 2]],
}

/// Where answers are built: responses of the waves, split by parity and on the cells; of temperature and distortion.
#[derive(Clone, Debug)]
pub struct Workspace {
    blocks: [Blocks; 2],
    slow: [DMatrix<f64>; 2],
    /// Gains of the waves, and a number for each.
    pub influence: [Vec<Complex<f64>>; 2],
    terms: Vec<f64>,
    /// Room for a block and a row of it.
    turned: Vec<f64>,
}

impl Workspace {
    pub fn new(operators: &StripOperators) -> Workspace {
        let (count, waves) = (operators.widths.len(), operators.waves.len());
        let moving = if operators.expands { count } else { 0 };
        Workspace {
            blocks: [Blocks::zeros(operators.half), Blocks::zeros(operators.half)],
            slow: [DMatrix::zeros(count, count), DMatrix::zeros(moving, moving)],
            influence: [vec![Complex::from(0.0); waves], vec![Complex::from(0.0); waves]],
            terms: vec![0.0; waves],
            turned: vec![0.0; (operators.half + 1) * operators.half],
        }
    }

    /// Sums the waves by their gains.
    pub fn sum_waves(&mut self, operators: &StripOperators) {
        let moving = 1 + usize::from(operators.expands);
        for (blocks, influence) in self.blocks.iter_mut().zip(&self.influence).take(moving) {
            blocks.clear();
            blocks.add_waves(influence, &operators.shapes, &mut self.terms);
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
    pub fn respond(
        &self,
        operators: &StripOperators,
        velocity: [f64; 2],
        workspace: &mut Workspace,
        answer: &mut Answer,
    ) {
        let [warm, moved] = &mut workspace.influence;
        warm.fill(Complex::from(0.0));
        moved.fill(Complex::from(0.0));
        self.weigh_states(operators, velocity, answer, |wave, k, own| {
            warm[wave] += own * operators.temperature[k];
            moved[wave] += own * operators.distortion[k];
        });
        for influence in [warm, moved] {
            influence.iter_mut().zip(&operators.weight).for_each(|(gain, weight)| *gain *= *weight);
        }
        workspace.sum_waves(operators);
        self.assemble(operators, workspace, answer);
    }

    /// Rate at which fresh material makes forget, and its factor over the interval.
    fn damping_of_images(&self, operators: &StripOperators, velocity: [f64; 2]) -> (f64, f64) {
        let fade = operators.image_damping.mean(velocity);
        (fade, (-fade * self.length).exp())
    }

    /// Gains from the waves' response in the blocks and the mean wave's, with the heat given back.
    pub fn assemble(&self, operators: &StripOperators, workspace: &mut Workspace, answer: &mut Answer) {
        let mean = &operators.mean;
        let Workspace { blocks, slow, turned, .. } = workspace;
        for (moving, slow) in slow.iter_mut().enumerate() {
            if moving == 1 && !operators.expands {
                continue;
            }
            let observed = if moving == 1 { &mean.mean_temperature } else { &mean.contact_temperature };
            let mut level = observed.direct[CONTACT];
            for k in 0..mean.count {
                level += observed.states[k] * mean.input[CONTACT][k] * self.mean_weight[k][OWN];
            }
            level *= operators.remembered();
            if moving == 1 {
                level *= operators.mean_distortion;
            }
            blocks[moving].unfold(&operators.widths, level / operators.period, turned, slow);
            let gain = if moving == 1 { &mut answer.influence.distortion } else { &mut answer.influence.temperature };
            gain.copy_from(slow);
            answer.parts().set_uniform(moving, slow);
        }
        if let Some(robin_correction) = &operators.robin_correction {
            let parts = answer.parts();
            robin_correction.close(slow, parts);
            let (influence, parts) = answer.gains_and_parts();
            robin_correction.add_gains(&parts, 0, &mut influence.temperature);
            if operators.expands {
                robin_correction.add_gains(&parts, 1, &mut influence.distortion);
            }
        }
    }

    /// The weights of the known fluxes and, at the end, those in the states, without the gains.
    pub fn weigh(&self, operators: &StripOperators, velocity: [f64; 2], answer: &mut Answer) {
        self.weigh_states(operators, velocity, answer, |_, _, _| {});
    }

    /// The same; `see` gets wave, state and the weight of the stage's own flux in it.
    #[inline(always)]
    fn weigh_states(
        &self,
        operators: &StripOperators,
        velocity: [f64; 2],
        answer: &mut Answer,
        mut see: impl FnMut(usize, usize, Complex<f64>),
    ) {
        let (fade, damping) = self.damping_of_images(operators, velocity);
        let parts = answer.parts();
        for (wave, &number) in operators.numbers.iter().enumerate() {
            let motion = Motion { turning: velocity.map(|v| number * v), step: self.length };
            let phase = motion.phase();
            let mut carried = [Complex::from(0.0); 2];
            for k in of_mode(&operators.state_layout, wave) {
                let (_, falling, rising) =
                    motion.weights_of_decay(operators.rate[k] + fade, damping * self.decay[k], phase);
                let [known, own] = self.stage_fluxes(falling, rising).map(|weight| weight * operators.temperature[k]);
                if self.at_end {
                    parts.weights[0][k] = known.re;
                    parts.weights[1][k] = known.im;
                    parts.weights[2][k] = own.re;
                    parts.weights[3][k] = own.im;
                }
                carried[0] += known * operators.temperature[k];
                carried[1] += known * operators.distortion[k];
                see(wave, k, own);
            }
            parts.carried[0][wave] = carried[0].re;
            parts.carried[1][wave] = carried[0].im;
            parts.carried[2][wave] = carried[1].re;
            parts.carried[3][wave] = carried[1].im;
        }
    }
}

pub fn stage_fluxes<T>(at_end: bool, falling: T, rising: T) -> [T; 2]
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
