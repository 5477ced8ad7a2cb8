//! Fade tables: a factor over temperature.

/// Piecewise linear factor over temperature, constant outside the table.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FadeTable {
    /// Temperatures, K, increasing.
    pub temperature: [f64; 8],
    /// Factors at these temperatures.
    pub factor: [f64; 8],
    /// All factors are equal: the temperature does not matter.
    pub flat: bool,
}

impl FadeTable {
    /// A table of eight increasing temperatures (K) and their factors.
    pub fn new(temperature: [f64; 8], factor: [f64; 8]) -> FadeTable {
        let flat = factor.iter().all(|value| *value == factor[0]);
        FadeTable { temperature, factor, flat }
    }

    /// Index of the first temperature that is not above its predecessor, if there is one.
    pub fn disorder(&self) -> Option<usize> {
        (1..8).find(|&i| self.temperature[i] <= self.temperature[i - 1])
    }

    /// Factor at `temperature` (K), and its derivative (1/K).
    #[inline]
    pub fn at(&self, temperature: f64) -> (f64, f64) {
        if self.flat {
            return (self.factor[0], 0.0);
        }
        let after = self.temperature.iter().position(|knot| temperature < *knot).unwrap_or(8);
        if after == 0 {
            return (self.factor[0], 0.0);
        }
        if after == 8 {
            return (self.factor[7], 0.0);
        }
        let (left, right) = (self.temperature[after - 1], self.temperature[after]);
        let slope = (self.factor[after] - self.factor[after - 1]) / (right - left);
        (self.factor[after - 1] + slope * (temperature - left), slope)
    }
}

#[cfg(test)]
mod tests {
    use super::FadeTable;

    #[test]
    fn linear_between_and_constant_outside() {
        let table = FadeTable::new(
            [300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0],
            [1.0, 1.0, 0.8, 0.5, 0.5, 0.4, 0.4, 0.3],
        );
        assert_eq!(table.at(200.0), (1.0, 0.0));
        assert!((table.at(450.0).0 - 0.9).abs() < 1e-15 && (table.at(450.0).1 + 0.002).abs() < 1e-15);
        assert_eq!(table.at(1000.0), (0.3, 0.0));
        assert_eq!(table.at(5000.0), (0.3, 0.0));
        assert_eq!(table.disorder(), None);
        assert_eq!(
            FadeTable::new([300.0, 300.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0], [1.0; 8]).disorder(),
            Some(1)
        );
    }
}
