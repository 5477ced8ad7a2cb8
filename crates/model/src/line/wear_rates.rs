//! Wear depth rates of both bodies on the cells.
//!
//! Theory: docs/theory.md, section 2.3.

use super::operators::{LineOperators, StripWear};
use super::trajectory::StageConditions;
use numerics::scalar::Scalar;

impl LineOperators {
    /// Whether any body wears.
    #[inline]
    pub(crate) fn wears(&self) -> bool {
        self.wear[0].0.active() || self.wear[1].0.active()
    }

    /// Whether the wear of the body (0: punch, 1: strip) changes the gap cell by cell.
    #[inline]
    pub fn reshapes(&self, body: usize) -> bool {
        match body {
            0 => self.wear[0].0.active(),
            _ => matches!(self.strip_wear, StripWear::ByRadius | StripWear::Track),
        }
    }

    /// Wear depth rates (m/s) of punch and strip at the reference pressure and the mean radius.
    pub(super) fn coefficients<S: Scalar>(
        &self,
        speed: S,
        kinetic_coefficient: S,
        temperature: S,
        acceleration: f64,
    ) -> [S; 2] {
        std::array::from_fn(|body| {
            let (law, factor) = &self.wear[body];
            law.coefficient(speed, kinetic_coefficient, temperature) * (factor * acceleration)
        })
    }

    /// Wear depth rate of the body (0: punch, 1: strip) on cell `i`, relative to that at the reference pressure and the mean
    /// radius.
    #[inline]
    pub(super) fn relative_rate(&self, body: usize, i: usize, pressure: f64) -> f64 {
        self.wear[body].0.rate_of(self.radial[body][i], pressure)
    }

    /// Multiplies `rates`, of all cells, by [`LineOperators::relative_rate`].
    pub(super) fn scale_by_relative_rates(&self, body: usize, pressure: &[f64], rates: &mut [f64]) {
        let law = &self.wear[body].0;
        let cells = rates.iter_mut().zip(self.radial[body].iter().zip(pressure));
        cells.for_each(|(rate, (radial, p))| *rate *= law.rate_of(*radial, *p));
    }

    /// Wear depth rates (m/s) of punch and strip on the cells at the pressure `pressure`.
    pub(super) fn rates(&self, now: &StageConditions, acceleration: f64, pressure: &[f64], rates: &mut [Vec<f64>; 2]) {
        let laws = self.coefficients(now.speed, now.kinetic_coefficient, now.temperature, acceleration);
        for body in 0..2 {
            if laws[body] == 0.0 {
                rates[body].fill(0.0);
                continue;
            }
            for i in 0..pressure.len() {
                rates[body][i] = laws[body] * self.relative_rate(body, i, pressure[i]);
            }
        }
    }

    /// Mean wear depth rate (m/s) of a strip that wears uniformly, `coefficient` at the reference pressure, and its change with
    /// the logarithm of the load.
    pub(super) fn even_rate(&self, coefficient: f64, pressure: &[f64]) -> [f64; 2] {
        let law = &self.wear[1].0;
        let [mut rate, mut change] = [0.0; 2];
        for (width, p) in self.cells.widths().iter().zip(pressure) {
            let part = law.rate_of(*width, *p);
            rate += part;
            change += law.logarithmic_slope(*p) * part;
        }
        [rate, change].map(|sum| coefficient * sum / (2.0 * self.cells.half_width()))
    }
}
