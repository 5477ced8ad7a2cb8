//! Conductivity and specific heat of a body over its temperature.
//!
//! Linear between the points, constant beyond the ends. The enthalpy by mass is the exact integral of the specific heat,
//! quadratic between the points, and its inverse is exact too.
//!
//! Theory: docs/theory.md, section 4.15.

/// Most points of the table.
pub const PROPERTY_POINTS: usize = 16;

/// Conductivities and specific heats at increasing temperatures.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PropertyTable {
    /// Number of points, at least 1.
    pub points: usize,
    /// Temperatures, K.
    pub temperature: [f64; PROPERTY_POINTS],
    /// Conductivities at these, W/(m K).
    pub conductivity: [f64; PROPERTY_POINTS],
    /// Specific heats at these, J/(kg K).
    pub specific_heat: [f64; PROPERTY_POINTS],
}

impl PropertyTable {
    /// Number of points at or below `temperature` (K).
    fn below(&self, temperature: f64) -> usize {
        self.temperature[..self.points].iter().take_while(|point| **point <= temperature).count()
    }

    /// Both properties at `temperature` (K): conductivity, W/(m K), and specific heat, J/(kg K).
    #[inline]
    pub fn at(&self, temperature: f64) -> [f64; 2] {
        let i = self.below(temperature);
        if i == 0 || i == self.points {
            let end = i.min(self.points - 1);
            return [self.conductivity[end], self.specific_heat[end]];
        }
        let (left, right) = (self.temperature[i - 1], self.temperature[i]);
        let part = (temperature - left) / (right - left);
        [&self.conductivity, &self.specific_heat].map(|row| row[i - 1] + part * (row[i] - row[i - 1]))
    }

    /// Conductivity at `temperature` (K), W/(m K).
    pub(crate) fn conductivity_at(&self, temperature: f64) -> f64 {
        self.at(temperature)[0]
    }

    /// Specific heat at `temperature` (K), J/(kg K).
    pub fn specific_heat_at(&self, temperature: f64) -> f64 {
        self.at(temperature)[1]
    }

    /// Heat by mass of a rise by `rise` (K) from the temperature `from` (K), J/kg.
    pub fn heat_of_rise(&self, from: f64, rise: f64) -> f64 {
        let (mut sum, mut left) = (0.0, 0.0);
        let rising = rise >= 0.0;
        let mut heat = self.specific_heat_at(from);
        // Every point between is an end of a part on which the specific heat is linear.
        for step in 0..self.points {
            let point = if rising { step } else { self.points - 1 - step };
            let (next, here) = (self.specific_heat[point], self.temperature[point] - from);
            if here > rise.min(0.0) && here < rise.max(0.0) {
                sum += 0.5 * (heat + next) * (here - left);
                (left, heat) = (here, next);
            }
        }
        sum + 0.5 * (heat + self.specific_heat_at(from + rise)) * (rise - left)
    }

    /// Rise (K) of a body at `from` (K) by which it takes up `heat` (J/kg): inverse of [`PropertyTable::heat_of_rise`].
    pub fn rise_by(&self, from: f64, heat: f64) -> f64 {
        let rising = heat >= 0.0;
        let (mut left, mut rest) = (0.0, heat);
        let mut here = self.specific_heat_at(from);
        for step in 0..self.points {
            let point = if rising { step } else { self.points - 1 - step };
            let at = self.temperature[point] - from;
            if if rising { at <= left } else { at >= left } {
                continue;
            }
            let next = self.specific_heat[point];
            let whole = 0.5 * (here + next) * (at - left);
            if if rising { whole > rest } else { whole < rest } {
                // Outside of the table the specific heat is constant up to its first point.
                let slope = (next - here) / (at - left);
                // c x + slope x^2/2 = rest, in the form without cancellation.
                return left + 2.0 * rest / (here + (here * here + 2.0 * slope * rest).max(0.0).sqrt());
            }
            (left, here, rest) = (at, next, rest - whole);
        }
        left + rest / here
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: usize) -> PropertyTable {
        let mut table = PropertyTable {
            points,
            temperature: [0.0; PROPERTY_POINTS],
            conductivity: [50.0; PROPERTY_POINTS],
            specific_heat: [500.0; PROPERTY_POINTS],
        };
        for i in 0..points {
            table.temperature[i] = 300.0 + 100.0 * i as f64 + 7.0 * (i * i) as f64;
            table.conductivity[i] = 50.0 - 2.0 * i as f64;
            table.specific_heat[i] = 450.0 + 90.0 * (i as f64).sin().abs() + 30.0 * i as f64;
        }
        table
    }

    #[test]
    fn values_are_linear_between_and_constant_beyond() {
        let table = table(3);
        assert_eq!(table.at(100.0), [50.0, 450.0]);
        assert_eq!(table.at(9e3), [46.0, table.specific_heat[2]]);
        let middle = 0.5 * (table.temperature[0] + table.temperature[1]);
        assert_eq!(table.conductivity_at(middle), 49.0);
    }

    #[test]
    fn heat_is_the_integral_and_its_inverse_exact() {
        for points in [1, 2, 5, 16] {
            let table = table(points);
            for from in [200.0, 300.0, 407.0, 555.5, 2000.0, 4000.0] {
                for to in [150.0, 300.0, 433.0, 900.0, 1500.0, 5000.0] {
                    let parts = 20_000;
                    let width = (to - from) / f64::from(parts);
                    let sum: f64 =
                        (0..parts).map(|i| table.specific_heat_at(from + width * (f64::from(i) + 0.5)) * width).sum();
                    let heat = table.heat_of_rise(from, to - from);
                    assert!((heat - sum).abs() <= 1e-6 * sum.abs(), "{points} {from} {to}: {heat} {sum}");
                    let back = from + table.rise_by(from, heat);
                    assert!((back - to).abs() < 1e-11 * to.max(from), "{points} {from} {to}: {back}");
                }
                // Relative to the rise, however small.
                let heat = table.heat_of_rise(from, 1e-12);
                assert!((table.rise_by(from, heat) / 1e-12 - 1.0).abs() < 1e-12, "{points} {from}");
            }
        }
    }
}
