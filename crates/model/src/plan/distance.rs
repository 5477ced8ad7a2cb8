//! Distance of two runs at different levels: largest differences of the main outputs, relative to their largest values.
//!
//! Theory: docs/theory.md, section 8.2.

use super::largest;
use numerics::maximum::maximum;

/// Wear depth (m), rise of the contact temperature (K) and friction force (N).
pub type Main = [f64; 3];

/// Distance of two runs so far.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct LevelDistance {
    /// Largest differences.
    pub apart: Main,
    /// Largest magnitudes in the first run.
    pub largest: Main,
}

impl LevelDistance {
    /// Takes the main outputs of both runs at an instant.
    pub fn follow(&mut self, first: Main, other: Main) {
        for output in 0..3 {
            self.apart[output] = maximum(self.apart[output], (first[output] - other[output]).abs());
            self.largest[output] = maximum(self.largest[output], first[output].abs());
        }
    }

    /// The difference of each output, relative to its largest value; infinite where a value is not finite, or where only the other run
    /// has values other than 0.
    pub fn relative(&self) -> Main {
        std::array::from_fn(|output| match self.apart[output] / self.largest[output] {
            _ if self.apart[output] == 0.0 => 0.0,
            ratio if ratio.is_nan() => f64::INFINITY,
            ratio => ratio,
        })
    }

    /// The largest of them.
    pub fn most(&self) -> f64 {
        largest(self.relative())
    }
}

/// Distance of two histories over their common beginning, relative to the largest values of the second there.
pub fn distance(one: &[Main], other: &[Main]) -> Main {
    let mut distance = LevelDistance::default();
    one.iter().zip(other).for_each(|(one, other)| distance.follow(*other, *one));
    distance.relative()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_relative_to_the_largest_value_of_each_output() {
        let mut distance = LevelDistance::default();
        assert_eq!(distance.most(), 0.0);
        distance.follow([1.0, 10.0, 0.0], [1.0, 11.0, 0.0]);
        assert_eq!(distance.most(), 0.1);
        // A peak that both levels have makes what went before less.
        distance.follow([1.0, -50.0, 4.0], [1.0, -50.0, 4.0]);
        assert_eq!(distance.most(), 0.02);
        distance.follow([1.0, 0.0, 4.0], [1.0, 0.0, 6.0]);
        assert_eq!(distance.relative(), [0.0, 0.02, 0.5]);
        distance.follow([f64::NAN, 0.0, 4.0], [1.0, 0.0, 6.0]);
        assert_eq!(distance.relative(), [f64::INFINITY, 0.02, 0.5]);
        let mut without = LevelDistance::default();
        without.follow([0.0; 3], [0.0, 1.0, 0.0]);
        assert_eq!(without.most(), f64::INFINITY);
    }
}
