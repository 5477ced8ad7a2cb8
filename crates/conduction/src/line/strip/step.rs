//! Propagation weights and influence matrices of one step.
//!
//! Theory: docs/theory.md, sections 5.3, 4.1.

pub(crate) mod stage;

pub(crate) use super::interval::{IntervalWorkspace, OWN};
pub(crate) use stage::StageWeights;

use super::feedthrough::StageFeedthrough;
use super::operators::StripOperators;
use crate::line::{GAMMA, Stage, SurfaceInfluence, cache_capacity};
use numerics::cache::KeyedCache;
use numerics::dense;

/// The prepared step.
#[derive(Clone, Debug)]
pub(crate) struct PreparedStep {
    /// Length, s, and velocities, m/s; not a number before the first step.
    pub length: f64,
    pub velocity: [f64; 2],
    pub first: StageWeights,
    pub end: StageWeights,
    pub feedthrough: StageFeedthrough,
    /// Memory for surface influence matrices.
    influence: SurfaceInfluence,
    /// Index of the cached responses after the first, by the bits of length and velocities.
    kept: KeyedCache<[u64; 3], ()>,
    /// Steps at a varying velocity are kept too: it hardly recurs, but in equal strokes.
    recurs: bool,
    workspace: IntervalWorkspace,
}

impl PreparedStep {
    pub(crate) fn new(operators: &StripOperators) -> PreparedStep {
        Self::keeping(operators, cache_capacity(operators.widths.len()), false)
    }

    /// A step that keeps the responses of `cached` others, at a varying velocity too where that `recurs`.
    pub(crate) fn keeping(operators: &StripOperators, cached: usize, recurs: bool) -> PreparedStep {
        let count = operators.widths.len();
        let matrix = || dense::untouched(count);
        PreparedStep {
            length: f64::NAN,
            velocity: [f64::NAN; 2],
            first: StageWeights::new(operators, false, cached),
            end: StageWeights::new(operators, true, cached),
            feedthrough: StageFeedthrough::new(operators),
            influence: SurfaceInfluence { temperature: matrix(), distortion: matrix() },
            kept: KeyedCache::new(vec![(); cached]),
            recurs,
            workspace: IntervalWorkspace::new(operators),
        }
    }

    pub(crate) fn stage(&self, stage: Stage) -> &StageWeights {
        match stage {
            Stage::First => &self.first,
            Stage::End => &self.end,
        }
    }

    /// Forms the surface influence matrices of a stage.
    pub(crate) fn influence(&mut self, operators: &StripOperators, stage: Stage) -> &SurfaceInfluence {
        let Self { first, end, influence, .. } = self;
        let response = if stage == Stage::First { first } else { end }.current_response();
        let SurfaceInfluence { temperature, distortion } = &mut *influence;
        for (whole, own) in [temperature, distortion].into_iter().zip(&response.influence) {
            if !own.is_empty() {
                own.fill(whole.as_mut_slice(), &operators.widths);
            }
        }
        if let Some(robin_correction) = &operators.robin_correction {
            robin_correction.close(response, influence);
        }
        influence
    }

    /// Place of the responses of a step among the cached ones, and whether they are stored there; place 0 serves those not kept.
    fn response_place(&mut self, length: f64, velocity: [f64; 2]) -> (usize, bool) {
        let keeps = (self.recurs || velocity[0] == velocity[1]) && self.kept.capacity() > 0;
        if !keeps {
            return (0, false);
        }
        let key = [length, velocity[0], velocity[1]].map(f64::to_bits);
        let known = self.kept.lookup(&key);
        (1 + known.unwrap_or_else(|| self.kept.insert(key)), known.is_some())
    }

    /// Prepares a step.
    pub(crate) fn prepare(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity {
            return;
        }
        (self.length, self.velocity) = (length, velocity);
        let (place, known) = self.response_place(length, velocity);
        self.feedthrough.prepare(operators, velocity);
        let [from, to] = velocity;
        let to_first_stage = [from, from + GAMMA * (to - from)];
        let stages = [(&mut self.first, GAMMA * length, to_first_stage), (&mut self.end, length, velocity)];
        for (weights, length, velocity) in stages {
            weights.current = place;
            let feedthrough = self.feedthrough.at(weights.stage());
            let unknown = (!known).then_some((feedthrough, &mut self.workspace));
            weights.prepare(operators, length, velocity, unknown);
        }
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
                assert_eq!(one.current_response().weights(), other.current_response().weights(), "{phase}");
                assert_eq!(one.current_response().carried(), other.current_response().carried(), "{phase}");
                assert_eq!(one.factor, other.factor, "{phase}");
                assert_eq!(one.mean_weight, other.mean_weight, "{phase}");
            }
            for stage in [Stage::First, Stage::End] {
                assert_eq!(kept.influence(stage), fresh.influence(stage), "{phase}");
            }
            places.insert((kept.step.end.current, velocity == [0.1; 2]));
        }
        // One slot per length, and one for a varying velocity.
        assert!(cache_capacity(9) >= 6);
        assert_eq!(places.len(), 7);
    }
}
