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
    /// Largest differences: under load, and with the load released.
    pub apart: [Main; 2],
    /// Largest magnitudes in the first run.
    pub largest: Main,
}

impl LevelDistance {
    /// Takes the main outputs of both runs at an instant, under load or with the load released.
    pub fn follow(&mut self, first: Main, other: Main, is_released: bool) {
        let apart = &mut self.apart[usize::from(is_released)];
        for output in 0..3 {
            apart[output] = maximum(apart[output], (first[output] - other[output]).abs());
            self.largest[output] = maximum(self.largest[output], first[output].abs());
        }
    }

    /// The difference of each output, relative to its largest value, under load or with the load released; infinite where a value is not
    /// finite, or where only the other run has values other than 0.
    pub fn relative(&self, is_released: bool) -> Main {
        let apart = &self.apart[usize::from(is_released)];
        std::array::from_fn(|output| match apart[output] / self.largest[output] {
            _ if apart[output] == 0.0 => 0.0,
            ratio if ratio.is_nan() => f64::INFINITY,
            ratio => ratio,
        })
    }

    /// The largest of them.
    pub fn most(&self, is_released: bool) -> f64 {
        largest(self.relative(is_released))
    }
}

/// Distance of two histories over their common beginning, relative to the largest values of the second there.
pub fn distance(one: &[Main], other: &[Main]) -> Main {
    let mut distance = LevelDistance::default();
    one.iter().zip(other).for_each(|(one, other)| distance.follow(*other, *one, false));
    distance.relative(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_relative_to_the_largest_value_of_each_output() {
        let mut distance = LevelDistance::default();
        assert_eq!(distance.most(false), 0.0);
        distance.follow([1.0, 10.0, 0.0], [1.0, 11.0, 0.0], false);
        assert_eq!(distance.most(false), 0.1);
        // A peak that both levels have makes what went before less.
        distance.follow([1.0, -50.0, 4.0], [1.0, -50.0, 4.0], false);
        assert_eq!(distance.most(false), 0.02);
        distance.follow([1.0, 0.0, 4.0], [1.0, 0.0, 6.0], true);
        assert_eq!(
            [false, true].map(|is_released| distance.relative(is_released)),
            [[0.0, 0.02, 0.0], [0.0, 0.0, 0.5]]
        );
        distance.follow([f64::NAN, 0.0, 4.0], [1.0, 0.0, 6.0], true);
        assert_eq!(distance.relative(true), [f64::INFINITY, 0.0, 0.5]);
        let mut without = LevelDistance::default();
        without.follow([0.0; 3], [0.0, 1.0, 0.0], false);
        assert_eq!(without.most(false), f64::INFINITY);
    }
}
