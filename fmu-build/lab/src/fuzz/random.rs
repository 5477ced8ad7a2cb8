//! Random numbers of an execution: all of them follow from its seed.

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use scene::variables::Row;

/// Values that break code more often than random ones do.
const SPECIAL: [f64; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.1,
    1e-9,
    -1e-9,
    1e3,
    -1e3,
    1e12,
    -1e12,
    1.000_000_000_000_1e12,
    1e150,
    -1e300,
    5e-324,
    f64::MIN_POSITIVE,
    f64::EPSILON,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

#[derive(Clone)]
pub(crate) struct Random(SplitMix64);

impl Random {
    /// Generator number `stream` of an execution.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut start = SplitMix64::seed_from_u64(seed ^ stream.wrapping_mul(0xd1b5_4a32_d192_ed03));
        start.next_u64();
        Self(SplitMix64::seed_from_u64(start.next_u64() ^ seed))
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A whole number below `limit`, which is above 0.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        ((u128::from(self.bits()) * limit as u128) >> 64) as usize
    }

    /// Whether an event of probability 1/`count` occurs.
    pub(crate) fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    pub(crate) fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }

    /// A number in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A power of ten with an exponent in [low, high).
    pub(crate) fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.one_in(2) { -1.0 } else { 1.0 }
    }

    /// Any double: special values, random bits, every order of magnitude, round and tame numbers.
    pub(crate) fn any(&mut self) -> f64 {
        match self.below(7) {
            0 | 1 => *self.pick(&SPECIAL),
            2 => f64::from_bits(self.bits()),
            3 => self.sign() * self.power(-324.0, 308.0),
            4 => self.round(),
            5 => self.below(40) as f64 - 3.0,
            _ => self.sign() * self.power(-3.0, 5.0),
        }
    }

    /// A round number, of which events fall on the same instant and steps divide each other.
    pub(crate) fn round(&mut self) -> f64 {
        self.sign() * self.pick(&[1.0, 2.0, 2.5, 5.0]) * 10_f64.powi(self.below(10) as i32 - 5)
    }

    /// A value for a parameter: mostly within its bounds, near the value that it has, and at times neither.
    pub(crate) fn parameter(&mut self, row: &Row, start: f64) -> f64 {
        let (low, high) = row.bounds();
        let (low, high) = (low.unwrap_or(-1e6), high.unwrap_or(1e6));
        match self.below(16) {
            0 => low,
            1 => high,
            2 => low + (high - low) * self.between(0.0, 1.0),
            3 => (low.max(1e-6 * high).max(1e-12) * self.power(0.0, 6.0)).min(high),
            4 => self.round().abs().clamp(low, high),
            5 => 0.0,
            6 if self.one_in(4) => self.any(),
            6 => start,
            7 | 8 => (start * self.power(-2.0, 2.0)).clamp(low, high),
            _ => (start * self.power(-0.3, 0.3)).clamp(low, high),
        }
    }

    /// A count: mostly small.
    pub(crate) fn count(&mut self) -> usize {
        match self.below(8) {
            0 => 0,
            1..=4 => 1,
            5 | 6 => self.below(8),
            _ => self.below(80),
        }
    }
}
