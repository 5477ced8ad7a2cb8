//! Stage responses at the nodes of a velocity grid, and interpolation between them.
//!
//! From node to node the phase of the shortest mode changes by a quarter of a radian over the interval. On fresh
//! material the damping rate of periodic images has its largest curvature near rest however short the interval, and the
//! nodes are denser there. The interpolant is the cubic through four nodes, a function of its arguments alone, whatever
//! nodes are in the cache.
//!
//! Theory: docs/theory.md, sections 4.5, 6.4.

use super::interval::{Interval, IntervalWorkspace};
use super::operators::StripOperators;
use super::properties::ImageDamping;
use super::stage_response::{FeedthroughTerms, Layout, StageResponse};
use numerics::cache::KeyedCache;

/// Spacing of the nodes in asinh(v/slow) where the damping rate of periodic images curves: the error of the cubic is
/// 3e-4 of the rate at `slow`. This error accumulates over the steps, so it must not depend on their length.
const NODE_SPACING: f64 = 0.25;
/// Cached nodes: four of each of two lengths between which a step control alternates, and as many that a changing velocity left.
const CACHED: usize = 12;

/// Velocities of the nodes: the number of a node is `v/phase + asinh(v/bend)/NODE_SPACING`.
#[derive(Clone, Copy, Debug)]
struct Grid {
    phase: f64,
    /// Velocity scale of the damping of periodic images, m/s; infinite without damping.
    bend: f64,
}

impl Grid {
    fn new(phase: f64, image_damping: &ImageDamping) -> Grid {
        Grid { phase, bend: if image_damping.per_length > 0.0 { image_damping.slow } else { f64::INFINITY } }
    }

    /// Node number of a velocity, as a real number.
    fn position(&self, velocity: f64) -> f64 {
        velocity / self.phase + (velocity / self.bend).asinh() / NODE_SPACING
    }

    /// Velocity of a node.
    fn node(&self, number: i64) -> f64 {
        let target = number as f64;
        if self.bend.is_infinite() {
            return target * self.phase;
        }
        // Newton's method in u = asinh(v/bend). The function is convex, and the start, the smaller of the solutions
        // with either term alone, is an upper bound, so the iterates decrease.
        let distance = target.abs();
        let mut u = (distance * NODE_SPACING).min((distance * self.phase / self.bend).asinh());
        for _ in 0..MOST_ITERATIONS {
            let (part, slope) = (self.bend / self.phase * u.sinh(), self.bend / self.phase * u.cosh());
            let change = (part + u / NODE_SPACING - distance) / (slope + NODE_SPACING.recip());
            u -= change;
            if change.abs() <= f64::EPSILON * u {
                break;
            }
        }
        (self.bend * u.sinh()).copysign(target)
    }
}

/// Iterations for convergence to rounding: Newton's method converges quadratically from a start at most twice too
/// large.
const MOST_ITERATIONS: usize = 20;

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
        feedthrough: FeedthroughTerms<'_>,
        workspace: &mut IntervalWorkspace,
        response: &mut StageResponse,
    ) {
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        // Phase change of the shortest mode from node to node, rad: the error of the cubic is .023 of its fourth power for that mode, and
        // decreases with the fourth power of the wave number for longer ones.
        let grid = Grid::new(0.25 / (shortest * length), &operators.image_damping);
        let base = grid.position(velocity).floor() as i64;
        let places: [usize; 4] = std::array::from_fn(|k| {
            let number = base + k as i64 - 1;
            self.cache.get_or_compute((length.to_bits(), number), |node| {
                node.velocity = grid.node(number);
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
