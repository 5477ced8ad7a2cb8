//! Direct feedthrough at the stages of a step: that of the velocity table, and what the Robin correction needs of it.
//!
//! Theory: docs/theory.md, section 4.5.

use super::mirrored::MirroredInfluence;
use super::operators::StripOperators;
use crate::line::{GAMMA, Stage};
use numerics::cache::KeyedCache;
use numerics::dense;

/// Direct feedthrough at a velocity.
#[derive(Clone, Debug)]
pub(crate) struct Feedthrough {
    /// Influence on temperature and, of the lagged flux, distortion; the second empty without thermal expansion.
    pub influence: [MirroredInfluence; 2],
    /// Temperatures by the polynomials of the Robin correction, by columns.
    pub lifted: Vec<f64>,
    /// Responses to a uniform unit flux; the distortion's is empty without thermal expansion.
    pub uniform: [Vec<f64>; 2],
}

impl Feedthrough {
    fn new(operators: &StripOperators) -> Feedthrough {
        let count = operators.widths.len();
        let moving = if operators.expands { count } else { 0 };
        Feedthrough {
            influence: [count, moving].map(MirroredInfluence::new),
            lifted: vec![0.0; operators.rank() * count],
            uniform: [count, moving].map(|count| vec![0.0; count]),
        }
    }

    /// Sets this to a combination of two.
    fn combine(&mut self, others: [&Feedthrough; 2], factors: [f64; 2]) {
        for (k, (own, uniform)) in self.influence.iter_mut().zip(&mut self.uniform).enumerate() {
            own.combine(others.map(|other| &other.influence[k]), factors);
            dense::combine(uniform, others.map(|other| &other.uniform[k][..]), factors);
        }
        dense::combine(&mut self.lifted, others.map(|other| &other.lifted[..]), factors);
    }
}

/// Direct feedthrough at both stages of the prepared step, and at the velocities last used, by their bits: the end of a step is the
/// start of the next.
#[derive(Clone, Debug)]
pub(crate) struct StageFeedthrough {
    cache: KeyedCache<u64, Feedthrough>,
    /// At the first stage, linear in time between start and end of the step.
    between: Feedthrough,
    /// Cache slots of both stages; `None`: `between`.
    places: [Option<usize>; 2],
}

/// A velocity rounded in the last twelve bits of its significand: the end of one step and the start of the next differ
/// by rounding.
fn rounded(velocity: f64) -> f64 {
    f64::from_bits((velocity.to_bits() + 0x800) & !0xfff)
}

impl StageFeedthrough {
    pub(crate) fn new(operators: &StripOperators) -> StageFeedthrough {
        StageFeedthrough {
            cache: KeyedCache::new((0..3).map(|_| Feedthrough::new(operators))),
            between: Feedthrough::new(operators),
            places: [None; 2],
        }
    }

    /// Takes a step between these velocities.
    pub(crate) fn prepare(&mut self, operators: &StripOperators, [from, to]: [f64; 2]) {
        let middle = from + GAMMA * (to - from);
        let last = self.find(operators, to);
        // Relative change of the velocity over a step up to which the direct feedthrough is linear in time.
        let straight = (to - from).abs() <= 0.1 * operators.table.scale().hypot(middle);
        self.places = if straight && from != to {
            let start = self.find(operators, from);
            let both = [start, last].map(|place| &self.cache[place]);
            self.between.combine(both, [1.0 - GAMMA, GAMMA]);
            [None, Some(last)]
        } else {
            [Some(self.find(operators, middle)), Some(last)]
        };
    }

    /// Cache slot of the influence matrices at a velocity.
    fn find(&mut self, operators: &StripOperators, velocity: f64) -> usize {
        let velocity = rounded(velocity);
        self.cache.get_or_compute(velocity.to_bits(), |Feedthrough { influence, lifted, uniform }| {
            let responses = influence.iter_mut().zip(uniform).enumerate();
            for (moving, (influence, uniform)) in responses.filter(|(_, (influence, _))| !influence.is_empty()) {
                operators.table.respond(moving, velocity, influence);
                uniform.fill(0.0);
                influence.respond(&operators.widths, uniform);
            }
            if let Some(robin_correction) = &operators.robin_correction {
                robin_correction.lift_by(&influence[0], lifted);
            }
        })
    }

    /// That of a stage.
    pub(crate) fn at(&self, stage: Stage) -> &Feedthrough {
        self.places[stage as usize].map_or(&self.between, |place| &self.cache[place])
    }
}
