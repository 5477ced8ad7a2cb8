//! Answers at velocities on a grid, from which those between are interpolated.
//!
//! From one knot to the next the shortest wave turns by a quarter of a radian in the interval. The answer is the cubic
//! through four knots: a function of the arguments alone, whatever knots are kept.

use super::answer::{Answer, AtOnce, Layout};
use super::operators::Operators;
use super::step::{Interval, Room};

/// Turn of the shortest wave from knot to knot, rad: the cubic is off by .023 of its fourth power for that wave, and by less
/// with the fourth power of the wave number for longer ones.
const KNOT_TURN: f64 = 0.25;
/// Knots kept for the usual length of the interval, and for any other.
const SLOTS: [usize; 2] = [8, 4];
/// Requests after which another length becomes the usual one.
const REQUESTS: u32 = 3;

/// See the module.
#[derive(Clone, Debug)]
pub struct Knots {
    sets: [Set; 2],
}

/// Knots of one length of the interval.
#[derive(Clone, Debug)]
struct Set {
    length: f64,
    requests: u32,
    /// Index and answer, in the slot `index mod number of slots`.
    slots: Vec<(i64, Answer)>,
}

impl Set {
    fn begin(&mut self, length: f64) {
        self.length = length;
        self.requests = 0;
        self.slots.iter_mut().for_each(|slot| slot.0 = i64::MIN);
    }
}

impl Knots {
    /// No knots yet.
    pub fn new(layout: Layout) -> Knots {
        let set = |slots: usize| Set {
            length: f64::NAN,
            requests: 0,
            slots: (0..slots).map(|_| (i64::MIN, Answer::new(layout))).collect(),
        };
        Knots { sets: SLOTS.map(set) }
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
        operators: &Operators,
        interval: &Interval<'_>,
        length: f64,
        velocity: f64,
        immediate: AtOnce<'_>,
        room: &mut Room,
        answer: &mut Answer,
    ) {
        let shortest = operators.waves.last().map_or(0.0, |wave| wave.number);
        let spacing = KNOT_TURN / (shortest * length);
        let set = self.set(length);
        let position = velocity / spacing;
        let base = position.floor();
        let t = position - base;
        let weights = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        let slots = set.slots.len() as i64;
        let slot = |k: i64| (base as i64 + k - 1).rem_euclid(slots) as usize;
        for k in 0..4 {
            let index = base as i64 + k - 1;
            let (known, knot) = &mut set.slots[slot(k)];
            if *known != index {
                interval.respond(operators, [index as f64 * spacing; 2], room, knot);
                *known = index;
            }
        }
        let slots = &set.slots;
        answer.combine([0, 1, 2, 3].map(|k| &slots[slot(k)].1), weights, immediate);
    }
}
