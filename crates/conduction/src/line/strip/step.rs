//! Propagation weights and influence matrices of one step.
//!
//! Theory: docs/theory.md, sections 5.3, 4.1.

pub(crate) mod stage;

pub(crate) use super::interval::{IntervalWorkspace, OWN};
pub(crate) use stage::StageWeights;

use super::operators::StripOperators;
use super::stage_response::Feedthrough;
use crate::line::{GAMMA, Stage, SurfaceInfluence, cache_capacity};
use nalgebra::DMatrix;
use numerics::cache::KeyedCache;
use numerics::dense;

/// The prepared step.
#[derive(Clone, Debug)]
pub(crate) struct PreparedStep {
    /// Length, s, and velocities, m/s; not a number before the first step.
    pub length: f64,
    pub velocity: [f64; 2],
    /// No cell exchanges heat: the influence on the cells is not there.
    pub open: bool,
    /// A cell may exchange heat.
    pub touches: bool,
    pub first: StageWeights,
    pub end: StageWeights,
    /// Index of the cached responses after the first, by the bits of length and velocities.
    kept: KeyedCache<[u64; 3], ()>,
    /// Steps at a varying velocity are kept too. A step-size control alternates between a few lengths, while a varying velocity hardly
    /// recurs, but in equal strokes.
    recurs: bool,
    workspace: IntervalWorkspace,
    feedthrough: DirectFeedthrough,
}

/// A velocity rounded in the last twelve bits of its significand: the end of one step and the start of the next differ
/// by rounding.
fn rounded(velocity: f64) -> f64 {
    f64::from_bits((velocity.to_bits() + 0x800) & !0xfff)
}

/// Direct feedthrough on the cells at the velocities last used, by their bits: the end of a step is the start of the next.
#[derive(Clone, Debug)]
struct DirectFeedthrough {
    cache: KeyedCache<u64, Feedthrough>,
    ones: Vec<f64>,
}

impl DirectFeedthrough {
    fn new(operators: &StripOperators) -> DirectFeedthrough {
        let count = operators.widths.len();
        let moving = if operators.expands { count } else { 0 };
        let lifted = operators.rank() * count;
        let empty = |_| Feedthrough {
            matrices: [DMatrix::zeros(count, count), DMatrix::zeros(moving, moving)],
            lifted: vec![0.0; lifted],
            uniform: vec![0.0; count],
        };
        DirectFeedthrough { cache: KeyedCache::new((0..3).map(empty)), ones: vec![1.0; count] }
    }

    /// Cache slot of the influence matrices at a velocity.
    fn find(&mut self, operators: &StripOperators, velocity: f64) -> usize {
        let velocity = rounded(velocity);
        self.cache.get_or_compute(velocity.to_bits(), |Feedthrough { matrices, lifted, uniform }| {
            for (moving, matrix) in matrices.iter_mut().enumerate().filter(|(_, matrix)| !matrix.is_empty()) {
                operators.table.respond(moving, velocity, matrix);
            }
            uniform.fill(0.0);
            dense::multiply_add(matrices[0].as_slice(), &self.ones, uniform);
            if let Some(robin_correction) = &operators.robin_correction {
                robin_correction.lift_by(matrices[0].as_slice(), lifted);
            }
        })
    }

    /// What is in a cache slot.
    fn at(&self, place: usize) -> &Feedthrough {
        &self.cache[place]
    }
}

/// Adds multiples of the direct feedthrough to the influence matrices of temperature and distortion.
fn add(feedthrough: &Feedthrough, parts: [f64; 2], influence: &mut SurfaceInfluence) {
    let gains = [&mut influence.temperature, &mut influence.distortion];
    for ((matrix, gain), part) in feedthrough.matrices.iter().zip(gains).zip(parts) {
        if !matrix.is_empty() {
            dense::multiply_add(matrix.as_slice(), &[part], gain.as_mut_slice());
        }
    }
}

/// Velocities from the start of a step to its first stage.
fn to_first_stage([from, to]: [f64; 2]) -> [f64; 2] {
    [from, from + GAMMA * (to - from)]
}

impl PreparedStep {
    pub(crate) fn new(operators: &StripOperators) -> PreparedStep {
        Self::keeping(operators, cache_capacity(operators.widths.len()), false)
    }

    /// A step that keeps the responses of `cached` others, at a varying velocity too where that `recurs`.
    pub(crate) fn keeping(operators: &StripOperators, cached: usize, recurs: bool) -> PreparedStep {
        PreparedStep {
            length: f64::NAN,
            velocity: [f64::NAN; 2],
            open: false,
            touches: true,
            first: StageWeights::new(operators, false, cached),
            end: StageWeights::new(operators, true, cached),
            kept: KeyedCache::new(vec![(); cached]),
            recurs,
            workspace: IntervalWorkspace::new(operators),
            feedthrough: DirectFeedthrough::new(operators),
        }
    }

    pub(crate) fn stage(&self, stage: Stage) -> &StageWeights {
        match stage {
            Stage::First => &self.first,
            Stage::End => &self.end,
        }
    }

    /// Whether the responses of a step are kept.
    fn keeps(&self, [from, to]: [f64; 2]) -> bool {
        (self.recurs || from == to) && self.kept.capacity() > 0
    }

    /// Place of the responses of a step among the cached ones, and whether they are stored there; place 0 serves those not kept.
    fn response_place(&mut self, length: f64, velocity: [f64; 2]) -> (usize, bool) {
        if !self.keeps(velocity) {
            return (0, false);
        }
        let key = [length, velocity[0], velocity[1]].map(f64::to_bits);
        let known = self.kept.lookup(&key);
        (1 + known.unwrap_or_else(|| self.kept.insert(key)), known.is_some())
    }

    pub(crate) fn prepare(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2], open: bool) {
        self.touches = !open;
        // Responses that are kept serve an open contact too.
        let open = open && !self.keeps(velocity);
        if self.length == length && self.velocity == velocity && self.open == open {
            return;
        }
        (self.length, self.velocity, self.open) = (length, velocity, open);
        let (place, known) = self.response_place(length, velocity);
        (self.first.current, self.end.current) = (place, place);
        if known {
            self.first.resume(operators, GAMMA * length, to_first_stage(velocity));
            self.end.resume(operators, length, velocity);
        } else {
            self.find(operators, length, velocity);
        }
    }

    /// Computes the responses of both stages.
    fn find(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        let [_, middle] = to_first_stage(velocity);
        let PreparedStep { first, end, workspace, feedthrough, open, .. } = self;
        let last = feedthrough.find(operators, velocity[1]);
        // Relative change of the velocity over a step up to which the direct feedthrough is linear in time.
        let straight = (velocity[1] - velocity[0]).abs() <= 0.1 * operators.table.scale().hypot(middle);
        if straight && velocity[0] != velocity[1] {
            let start = feedthrough.find(operators, velocity[0]);
            let both = [(feedthrough.at(start), 1.0 - GAMMA), (feedthrough.at(last), GAMMA)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &both, *open, workspace);
        } else {
            let between = feedthrough.find(operators, middle);
            let one = [(feedthrough.at(between), 1.0)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &one, *open, workspace);
        }
        end.prepare(operators, length, velocity, &[(feedthrough.at(last), 1.0)], *open, workspace);
    }
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use crate::line::{Step, cache_capacity, strip};
    use crate::slab::Slab;
    use elasticity::Material;
    use scene::FarBoundary;

    /// Up to six alternating lengths, interspersed with steps of varying velocity.
    #[test]
    fn steps_by_turns_keep_their_responses_to_the_bit() {
        let cells = Cells::graded(0.02, 9).unwrap();
        let material = Material::new(2e11, 0.3).unwrap();
        let expansion = strip::Expansion { coefficient: 1e-5, material, base: elasticity::Base::Bonded };
        let properties = StripProperties {
            expansion: Some(expansion),
            ..StripProperties::bare(
                Slab { surface_transfer: 30.0, ..Slab::bare(0.02, [50.0, 3.6e6], FarBoundary::Held) },
                SlidingPath::Stroke { stroke: 0.05, length: 0.0 },
            )
        };
        let resolution = Resolution { duration: 10.0, shortest: 1e-3, travel: f64::INFINITY, tolerance: 1e-2 };
        let body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let (mut kept, mut recurring) = (body.clone(), body.clone());
        recurring.recur(12);
        let mut places = std::collections::BTreeSet::new();
        for phase in 0..40_u32 {
            let length = 1e-3 * f64::from(1 << (phase % 6));
            let velocity = if phase % 5 == 4 { [0.1, 0.2] } else { [0.1; 2] };
            let mut fresh = body.clone();
            [&mut kept, &mut recurring, &mut fresh]
                .into_iter()
                .for_each(|own| own.prepare(&Step::new(length, velocity)));
            let [one, other, again] = [&kept, &fresh, &recurring].map(|own| [&own.step.first, &own.step.end]);
            for (one, other) in one.into_iter().chain(again).zip(other.into_iter().chain(other)) {
                assert_eq!(one.current_response().influence, other.current_response().influence, "{phase}");
                assert_eq!(one.current_response().weights(), other.current_response().weights(), "{phase}");
                assert_eq!(one.current_response().carried(), other.current_response().carried(), "{phase}");
                assert_eq!(one.factor, other.factor, "{phase}");
                assert_eq!(one.mean_weight, other.mean_weight, "{phase}");
            }
            places.insert((std::ptr::from_ref(kept.influence(Stage::End)) as usize, velocity == [0.1; 2]));
        }
        // One slot per length, and one for a varying velocity.
        assert!(cache_capacity(9) >= 6);
        assert_eq!(places.len(), 7);
    }
}
