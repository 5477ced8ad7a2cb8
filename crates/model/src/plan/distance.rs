//! Distance of two runs: largest differences of the main outputs, relative to their largest values.
//!
//! Theory: docs/theory.md, section 8.2.

use numerics::maximum::maximum;
use scene::value;
use scene::variables::COUNT;

/// Wear depth (m), rise of the contact temperature (K) and friction force (N).
pub type Main = [f64; 3];

/// The main outputs among `values`, at this ambient temperature (K).
pub(crate) fn main_outputs(values: &[f64; COUNT], ambient: f64) -> Main {
    [value!(values, "wear_depth"), value!(values, "contact_temperature") - ambient, value!(values, "friction_force")]
}

/// Largest error; infinite where one is NaN.
pub fn largest(errors: Main) -> f64 {
    errors.into_iter().fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { error.max(most) })
}

/// Distance of two runs so far.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Distance {
    /// Largest differences.
    pub apart: Main,
    /// Largest magnitudes in the first run.
    pub largest: Main,
}

impl Distance {
    /// Takes the main outputs of both runs at an instant.
    pub(crate) fn follow(&mut self, first: Main, other: Main) {
        for output in 0..3 {
            self.apart[output] = maximum(self.apart[output], (first[output] - other[output]).abs());
            self.largest[output] = maximum(self.largest[output], first[output].abs());
        }
    }

    /// The difference of each output relative to its largest value; infinite where a value is not finite, or where only the other
    /// run has values other than 0.
    pub fn relative(&self) -> Main {
        std::array::from_fn(|output| match self.apart[output] / self.largest[output] {
            _ if self.apart[output] == 0.0 => 0.0,
            ratio if ratio.is_nan() => f64::INFINITY,
            ratio => ratio,
        })
    }

    /// What [`Self::relative`] will be at least, where these are the distances so far and the other run reaches `highest` in all: the
    /// first reaches at most the sum.
    pub(crate) fn at_least(&self, highest: &Main) -> Main {
        std::array::from_fn(|output| match self.apart[output] {
            0.0 => 0.0,
            apart => apart / (highest[output] + apart),
        })
    }

    /// The distance of two histories over their common beginning, relative to the largest values of the first.
    pub fn of(first: &[Main], other: &[Main]) -> Distance {
        let mut distance = Distance::default();
        first.iter().zip(other).for_each(|(first, other)| distance.follow(*first, *other));
        distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_relative_to_the_largest_value_of_each_output() {
        let mut distance = Distance::default();
        assert_eq!(distance.relative(), [0.0; 3]);
        distance.follow([1.0, 10.0, 0.0], [1.0, 11.0, 0.0]);
        assert_eq!(distance.relative(), [0.0, 0.1, 0.0]);
        // A peak that both runs have makes what went before less.
        distance.follow([1.0, -50.0, 4.0], [1.0, -50.0, 6.0]);
        assert_eq!(distance.relative(), [0.0, 0.02, 0.5]);
        distance.follow([f64::NAN, 0.0, 4.0], [1.0, 0.0, 6.0]);
        assert_eq!(largest(distance.relative()), f64::INFINITY);
        // Two runs: what their first instants say is not above what all say.
        let runs = [[[1.0, 2.0, 0.0], [9.0, 3.0, 0.0]], [[1.5, 2.0, 0.0], [4.0, 2.5, 0.0]]];
        let [so_far, whole] = [1, 2].map(|count| Distance::of(&runs[0][..count], &runs[1][..count]));
        assert_eq!(so_far.at_least(&[4.0, 2.5, 0.0]), [0.5 / 4.5, 0.0, 0.0]);
        assert_eq!(whole.at_least(&[4.0, 2.5, 0.0]), [5.0 / 9.0, 0.5 / 3.0, 0.0]);
        assert_eq!(whole.relative(), [5.0 / 9.0, 0.5 / 3.0, 0.0]);
        assert_eq!(largest(Distance::of(&[[0.0; 3]], &[[0.0, 1.0, 0.0]]).relative()), f64::INFINITY);
    }
}
