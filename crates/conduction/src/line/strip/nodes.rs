//! Stage responses at the nodes of a velocity grid, and interpolation between them.
//!
//! From node to node the phase of the shortest mode changes by a quarter of a radian over the interval. The interpolant is the
//! cubic through four nodes, a function of its arguments alone, whatever nodes are in the cache.
//!
//! Theory: docs/theory.md, sections 4.5, 6.4.

use super::feedthrough::Feedthrough;
use super::interval::{Interval, IntervalWorkspace};
use super::operators::StripOperators;
use super::stage_response::{Layout, StageResponse};
use numerics::cache::KeyedCache;

/// Cached nodes: four of each of two lengths between which a step control alternates, and as many that a changing velocity left.
const CACHED: usize = 12;

/// Cached interpolation nodes, by the bits of the length of the interval and their number.
#[derive(Clone, Debug)]
pub(crate) struct InterpolationNodes {
    cache: KeyedCache<(u64, i64), Node>,
}

/// Velocity (m/s) and stage response of a node.
#[derive(Clone, Debug)]
struct Node {
    velocity: f64,
    response: StageResponse,
}

impl InterpolationNodes {
    /// An empty cache.
    pub(crate) fn new(layout: Layout) -> InterpolationNodes {
        let node = || Node { velocity: 0.0, response: StageResponse::new(layout) };
        InterpolationNodes { cache: KeyedCache::new((0..CACHED).map(|_| node())) }
    }

    /// Response of `interval`, `length` s long, at a constant velocity, direct feedthrough included.
    #[expect(
        clippy::too_many_arguments,
        reason = "an interval, its velocity, and where to build what is not there yet"
    )]
    pub(crate) fn interpolate(
        &mut self,
        operators: &StripOperators,
        interval: &Interval<'_>,
        length: f64,
        velocity: f64,
        feedthrough: (&Feedthrough, f64),
        workspace: &mut IntervalWorkspace,
        response: &mut StageResponse,
    ) {
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        // Phase change of the shortest mode from node to node, rad: the error of the cubic is 0.023 of its fourth power
        // for that mode, and decreases with the fourth power of the wave number for longer ones.
        let spacing = 0.25 / (shortest * length);
        let base = (velocity / spacing).floor() as i64;
        let places: [usize; 4] = std::array::from_fn(|k| {
            let number = base + k as i64 - 1;
            self.cache.get_or_compute((length.to_bits(), number), |node| {
                node.velocity = number as f64 * spacing;
                interval.respond(operators, [node.velocity; 2], workspace, &mut node.response);
            })
        });
        let nodes = places.map(|place| self.cache[place].velocity);
        let weights = std::array::from_fn(|k| {
            let others = (0..4).filter(|&other| other != k).map(|other| nodes[other]);
            others.map(|other| (velocity - other) / (nodes[k] - other)).product()
        });
        response.combine(places.map(|place| &self.cache[place].response), weights, feedthrough);
    }
}
