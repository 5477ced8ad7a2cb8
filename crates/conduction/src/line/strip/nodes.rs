//! Answers at velocities on a grid, from which those between are interpolated.
//!
//! From one knot to the next the shortest wave turns by a quarter of a radian in the interval. On fresh material the rate of
//! forgetting bends near rest however short the interval, and there the knots lie closer. The answer is the cubic through four
//! knots: a function of the arguments alone, whatever knots are kept.
//!
//! Theory: docs/theory.md, sections 4.5, 6.4.

use super::answer::{Answer, Layout, SingleStepAttempt};
use super::operators::{ImageDamping, StripOperators};
use super::step::{Interval, Workspace};

/// Turn of the shortest wave from knot to knot, rad: the cubic is off by .023 of its fourth power for that wave, and by less
/// with the fourth power of the wave number for longer ones.
const KNOT_TURN: f64 = 0.25;
/// Distance of the knots in asinh(v/slow) where forgetting bends: the cubic through four is off by 3e-4 of its rate at `slow`.
/// What it is off by adds up over the steps, so it must not depend on their length.
const KNOT_BEND: f64 = 0.25;
/// Knots kept for the usual length of the interval, and for any other.
const SLOTS: [usize; 2] = [8, 4];
/// Requests after which another length becomes the usual one.
const REQUESTS: u32 = 3;

/// Velocities of the knots: `v/phase + asinh(v/bend)/KNOT_BEND` is the number of a knot.
#[derive(Clone, Copy, Debug)]
struct Grid {
    phase: f64,
    /// Nothing bends: infinite.
    bend: f64,
}

impl Grid {
    fn new(phase: f64, image_damping: &ImageDamping) -> Grid {
        Grid { phase, bend: if image_damping.per_length > 0.0 { image_damping.slow } else { f64::INFINITY } }
    }

    /// Place of a velocity among the numbers of the knots.
    fn position(&self, velocity: f64) -> f64 {
        velocity / self.phase + (velocity / self.bend).asinh() / KNOT_BEND
    }

    /// Velocity of a knot.
    fn node(&self, number: i64) -> f64 {
        let target = number as f64;
        if self.bend.is_infinite() {
            return target * self.phase;
        }
        // Newton's method in u = asinh(v/bend), where the place is convex: down from what either part alone would give.
        let distance = target.abs();
        let mut u = (distance * KNOT_BEND).min((distance * self.phase / self.bend).asinh());
        for _ in 0..MOST_ITERATIONS {
            let (part, slope) = (self.bend / self.phase * u.sinh(), self.bend / self.phase * u.cosh());
            let change = (part + u / KNOT_BEND - distance) / (slope + KNOT_BEND.recip());
            u -= change;
            if change.abs() <= f64::EPSILON * u {
                break;
            }
        }
        (self.bend * u.sinh()).copysign(target)
    }
}

/// Iterations after which a knot is where it is: the method doubles its digits from a start that is at most twice too far.
const MOST_ITERATIONS: usize = 20;

/// See the module.
#[derive(Clone, Debug)]
pub struct InterpolationNodes {
    sets: [Set; 2],
}

/// Knots of one length of the interval.
#[derive(Clone, Debug)]
struct Set {
    length: f64,
    requests: u32,
    /// Number, velocity and answer, in the slot `number mod number of slots`.
    slots: Vec<Slot>,
}

#[derive(Clone, Debug)]
struct Slot {
    number: i64,
    velocity: f64,
    answer: Answer,
}

impl Set {
    fn begin(&mut self, length: f64) {
        self.length = length;
        self.requests = 0;
        self.slots.iter_mut().for_each(|slot| slot.number = i64::MIN);
    }
}

impl InterpolationNodes {
    /// No knots yet; and no memory for them where nothing is interpolated.
    pub fn new(layout: Layout, used: bool) -> InterpolationNodes {
        let set = |slots: usize| Set {
            length: f64::NAN,
            requests: 0,
            slots: (0..slots).map(|_| Slot { number: i64::MIN, velocity: 0.0, answer: Answer::new(layout) }).collect(),
        };
        InterpolationNodes { sets: SLOTS.map(|slots| set(if used { slots } else { 0 })) }
    }

    /// The set for a length.
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

    /// The answer of `interval`, `length` s long, at a constant velocity, with what answers at once.
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
        immediate: SingleStepAttempt<'_>,
        workspace: &mut Workspace,
        answer: &mut Answer,
    ) {
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let grid = Grid::new(KNOT_TURN / (shortest * length), &operators.image_damping);
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
                interval.respond(operators, [own.velocity; 2], workspace, &mut own.answer);
            }
            nodes[k as usize] = own.velocity;
        }
        let weights = std::array::from_fn(|k| {
            let others = (0..4).filter(|&other| other != k).map(|other| nodes[other]);
            others.map(|other| (velocity - other) / (nodes[k] - other)).product()
        });
        let slots = &set.slots;
        answer.combine([0, 1, 2, 3].map(|k| &slots[slot(k)].answer), weights, immediate);
    }
}
