//! Fade tables: a factor over temperature.
//!
//! Theory: docs/theory.md, sections 2.2, 2.3.

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

/// The straight piece of a [`FadeTable`] between two of its temperatures.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FadeLine {
    /// Temperatures from and up to which the table follows the line, K.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// Temperature of `value`, K.
    pub start: f64,
    /// Factor there.
    pub value: f64,
    /// Derivative of the factor, 1/K.
    pub slope: f64,
}

impl FadeLine {
    /// Factor of the line at `temperature` (K).
    #[inline]
    pub fn factor(&self, temperature: f64) -> f64 {
        self.value + self.slope * (temperature - self.start)
    }

    /// Whether the table follows the line at `temperature` (K).
    #[inline]
    pub fn holds(&self, temperature: f64) -> bool {
        temperature >= self.low && temperature < self.high
    }
}

/// A piece without slope.
#[inline(always)]
fn level(low: f64, high: f64, value: f64) -> FadeLine {
    FadeLine { low, high, start: 0.0, value, slope: 0.0 }
}

impl FadeTable {
    /// A table of eight increasing temperatures (K) and their factors.
    pub fn new(temperature: [f64; 8], factor: [f64; 8]) -> FadeTable {
        let flat = factor.iter().all(|value| *value == factor[0]);
        FadeTable { temperature, factor, flat }
    }

    /// Index of the first temperature that is not above its predecessor, if there is one.
    pub(crate) fn disorder(&self) -> Option<usize> {
        crate::disorder(&self.temperature)
    }

    /// Factor at `temperature` (K), and its derivative (1/K).
    #[inline]
    pub fn at(&self, temperature: f64) -> (f64, f64) {
        let line = self.line(temperature);
        (line.factor(temperature), line.slope)
    }

    /// The piece of the table that `temperature` (K) is on.
    #[inline(always)]
    pub fn line(&self, temperature: f64) -> FadeLine {
        if self.flat { level(f64::NEG_INFINITY, f64::INFINITY, self.factor[0]) } else { self.piece(temperature) }
    }

    #[inline(never)]
    fn piece(&self, temperature: f64) -> FadeLine {
        let after = self.temperature.iter().position(|point| temperature < *point).unwrap_or(8);
        match after {
            0 => level(f64::NEG_INFINITY, self.temperature[0], self.factor[0]),
            8 => level(self.temperature[7], f64::INFINITY, self.factor[7]),
            _ => {
                let (low, high) = (self.temperature[after - 1], self.temperature[after]);
                let value = self.factor[after - 1];
                FadeLine { low, high, start: low, value, slope: (self.factor[after] - value) / (high - low) }
            }
        }
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
