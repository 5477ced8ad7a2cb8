//! Stage responses at the nodes of a velocity grid, and interpolation between them.
//!
//! From node to node the phase of the shortest mode changes by a quarter of a radian over the interval. On fresh
//! material the damping rate of periodic images has its largest curvature near rest however short the interval, and the
//! nodes are denser there. The interpolant is the cubic through four nodes, a function of its arguments alone, whatever
//! nodes are in the cache.
//!
//! Theory: docs/theory.md, sections 4.5, 6.4.

use super::interval::{Interval, Workspace};
use super::operators::StripOperators;
use super::properties::ImageDamping;
use super::stage_response::{FeedthroughTerms, Layout, StageResponse};

/// Phase change of the shortest mode from node to node, rad: the error of the cubic is .023 of its fourth power for
/// that mode, and decreases with the fourth power of the wave number for longer ones.
const NODE_PHASE: f64 = 0.25;
/// Spacing of the nodes in asinh(v/slow) where the damping rate of periodic images curves: the error of the cubic is
/// 3e-4 of the rate at `slow`. This error accumulates over the steps, so it must not depend on their length.
const NODE_SPACING: f64 = 0.25;
/// Cached nodes for the usual length of the interval, and for any other.
const SLOTS: [usize; 2] = [8, 4];
/// Requests after which another length becomes the usual one.
const REQUESTS: u32 = 3;

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

/// Cached interpolation nodes for two lengths of the interval.
#[derive(Clone, Debug)]
pub struct InterpolationNodes {
    sets: [Set; 2],
}

/// Nodes of one length of the interval.
#[derive(Clone, Debug)]
struct Set {
    length: f64,
    requests: u32,
    /// Number, velocity and stage response, in the slot `number mod number of slots`.
    slots: Vec<Slot>,
}

#[derive(Clone, Debug)]
struct Slot {
    number: i64,
    velocity: f64,
    response: StageResponse,
}

impl Set {
    fn begin(&mut self, length: f64) {
        self.length = length;
        self.requests = 0;
        self.slots.iter_mut().for_each(|slot| slot.number = i64::MIN);
    }
}

impl InterpolationNodes {
    /// An empty cache.
    pub fn new(layout: Layout) -> InterpolationNodes {
        let set = |slots: usize| Set {
            length: f64::NAN,
            requests: 0,
            slots: (0..slots)
                .map(|_| Slot { number: i64::MIN, velocity: 0.0, response: StageResponse::new(layout) })
                .collect(),
        };
        InterpolationNodes { sets: SLOTS.map(set) }
    }

    /// Nodes of an interval of this length, emptied where they were those of another length.
    fn set(&mut self, length: f64) -> &mut Set {
        let [usual, other] = &mut self.sets;
        if usual.length.is_nan() {
            usual.begin(length);
        }
        if usual.length == length {
            return usual;
        }
        if other.length != length {
            other.begin(length);
        }
        other.requests += 1;
        if other.requests <= REQUESTS {
            return other;
        }
        other.begin(f64::NAN);
        usual.begin(length);
        usual
    }

    /// Response of `interval`, `length` s long, at a constant velocity, direct feedthrough included.
    #[expect(
        clippy::too_many_arguments,
        reason = "an interval, its velocity, and where to build what is not there yet"
    )]
    pub fn interpolate(
        &mut self,
        operators: &StripOperators,
        interval: &Interval<'_>,
        length: f64,
        velocity: f64,
        immediate: FeedthroughTerms<'_>,
        workspace: &mut Workspace,
        response: &mut StageResponse,
    ) {
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let grid = Grid::new(NODE_PHASE / (shortest * length), &operators.image_damping);
        let set = self.set(length);
        let base = grid.position(velocity).floor() as i64;
        let slots = set.slots.len() as i64;
        let slot = |k: i64| (base + k - 1).rem_euclid(slots) as usize;
        let mut nodes = [0.0; 4];
        for k in 0..4 {
            let number = base + k - 1;
            let own = &mut set.slots[slot(k)];
            if own.number != number {
                (own.number, own.velocity) = (number, grid.node(number));
                interval.respond(operators, [own.velocity; 2], workspace, &mut own.response);
            }
            nodes[k as usize] = own.velocity;
        }
        let weights = std::array::from_fn(|k| {
            let others = (0..4).filter(|&other| other != k).map(|other| nodes[other]);
            others.map(|other| (velocity - other) / (nodes[k] - other)).product()
        });
        let slots = &set.slots;
        response.combine([0, 1, 2, 3].map(|k| &slots[slot(k)].response), weights, immediate);
    }
}
