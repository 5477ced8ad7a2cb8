//! Properties of a body at its own mean temperature.
//!
//! With conductivity K and heat capacity C by volume uniform in the body, and functions of time through its mean temperature, the
//! deviation from the mean obeys `dT/dt = (K/C) T''` with the flux `-K T'` at the faces. It is the problem of the constants K0 and
//! C0 in the body's own time, under a scaled flux:
//!
//! ```text
//! dtau = (kd/kd0) dt,   q' = (K0/K) q,   kd = K/C
//! ```
//!
//! So a reduced body keeps its states and its operators: its decay rates are multiplied by kd/kd0 and the weights of fluxes by K0/K.
//! A prescribed temperature is not scaled, and a heat transfer coefficient H within the states acts as H K/K0. Temperatures are
//! continuous when properties change. The mean itself is an enthalpy: the heat that enters is the exact integral of C.
//!
//! Validity: deviations from the mean over which K and C change little; measured against the nonlinear problem in the section below.
//!
//! Theory: docs/theory.md, section 4.15.

use scene::{Body, PROPERTY_POINTS, PropertyTable};

/// Factors from the constants of a reduced body to its properties at another temperature.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scales {
    /// K0/K: factor of every flux.
    pub flux: f64,
    /// kd/kd0: factor of every decay rate.
    pub pace: f64,
}

impl Scales {
    /// Those of the constants.
    pub const ONE: Scales = Scales { flux: 1.0, pace: 1.0 };

    /// Factor from heat and flows as the reduced body counts them in its own time to joules: C/C0.
    pub fn capacity(&self) -> f64 {
        1.0 / (self.flux * self.pace)
    }
}

/// Conductivity and heat capacity of a body over its mean temperature, relative to the constants of its reduced model.
#[derive(Clone, PartialEq, Debug)]
pub struct Properties {
    /// The table of the body.
    pub table: PropertyTable,
    /// Conductivity (W/(m K)) and specific heat (J/(kg K)) of the reduced model.
    constants: [f64; 2],
    /// Largest relative change of a property per kelvin, 1/K.
    steepest: f64,
    /// Relative change of the property that changes more, added up from the first point of the table to each.
    changes: [f64; PROPERTY_POINTS],
    /// Relative change over a part of the temperature in which the properties count as constant.
    part: f64,
}

/// Largest relative change of the properties over a part of the temperature in which they count as constant, and the same over the
/// tolerance of the scene: half of it, times the deviation from the mean, is the error of a step by it.
const PART: f64 = 0.01;
const PART_OVER_TOLERANCE: f64 = 10.0;

/// Distance from the ends of a part within which rounding decides to which of both a temperature belongs, K.
const WITHIN: f64 = 1e-6;

/// Most by which the temperature in the middle of a step is extrapolated from that at its start, K.
const FARTHEST: f64 = 50.0;

/// Temperature in the middle of a step of `step` (s) from `start` (K), by the rate of the last one `trend` (K/s).
#[inline]
pub fn middle_of_step(start: f64, trend: f64, step: f64) -> f64 {
    start + (0.5 * step * trend).clamp(-FARTHEST, FARTHEST)
}

impl Properties {
    /// Of a body with a table in a scene of this `tolerance`; `None` for constants, and for an insulator.
    pub fn of(body: &Body, tolerance: f64) -> Option<Properties> {
        let table = body.properties.filter(|_| body.conductivity > 0.0)?;
        let steepest = (1..table.points).flat_map(|i| {
            let width = table.temperature[i] - table.temperature[i - 1];
            [&table.conductivity, &table.specific_heat]
                .map(|row| (row[i] - row[i - 1]).abs() / (width * row[i].min(row[i - 1])))
        });
        let steepest = steepest.fold(0.0, f64::max);
        let mut changes = [0.0; PROPERTY_POINTS];
        for i in 1..table.points {
            let logarithms = [&table.conductivity, &table.specific_heat].map(|row| (row[i] / row[i - 1]).ln().abs());
            changes[i] = changes[i - 1] + logarithms[0].max(logarithms[1]);
        }
        let (constants, part) = ([body.conductivity, body.specific_heat], PART.min(PART_OVER_TOLERANCE * tolerance));
        Some(Properties { table, constants, steepest, changes, part })
    }

    /// Specific heat of the reduced model, J/(kg K).
    pub fn specific_heat(&self) -> f64 {
        self.constants[1]
    }

    /// Factors at the mean temperature `temperature`, K.
    #[inline]
    pub fn at(&self, temperature: f64) -> Scales {
        let [conductivity, specific_heat] = self.table.at(temperature);
        let flux = self.constants[0] / conductivity;
        Scales { flux, pace: self.constants[1] / (specific_heat * flux) }
    }

    /// Temperature (K) that stands for the part of the temperature around `temperature` in which the properties count as constant: the middle
    /// of the part, by the change of the properties; and ends between which all temperatures have it.
    pub fn part(&self, temperature: f64) -> (f64, [f64; 2]) {
        let (points, changes) = (&self.table.temperature[..self.table.points], &self.changes);
        let next = points.partition_point(|point| *point <= temperature);
        let change = if next == 0 || next == points.len() {
            changes[next.min(points.len() - 1)]
        } else {
            let part = (temperature - points[next - 1]) / (points[next] - points[next - 1]);
            changes[next - 1] + (changes[next] - changes[next - 1]) * part
        };
        let (number, last) = ((change / self.part).floor(), changes[points.len() - 1]);
        let at = |change: f64| {
            let at = changes[..points.len()].partition_point(|known| *known < change).clamp(1, points.len() - 1);
            let width = changes[at] - changes[at - 1];
            let inside = if width > 0.0 { (change - changes[at - 1]) / width } else { 1.0 };
            points[at - 1] + inside * (points[at] - points[at - 1])
        };
        let end = |number: f64, beyond: f64| {
            let change = number * self.part;
            if change > 0.0 && change <= last { at(change) } else { beyond }
        };
        let ends = [end(number, f64::NEG_INFINITY) + WITHIN, end(number + 1.0, f64::INFINITY) - WITHIN];
        (at(((number + 0.5) * self.part).min(last)), ends)
    }

    /// Larger relative change of conductivity and specific heat between two temperatures, K; its bound by the steepest part of the table
    /// where that is below `enough`.
    pub fn change(&self, [from, to]: [f64; 2], enough: f64) -> f64 {
        let bound = self.steepest * (to - from).abs();
        if bound <= enough {
            return bound;
        }
        let (from, to) = (self.table.at(from), self.table.at(to));
        (0..2).map(|i| (to[i] - from[i]).abs() / from[i].min(to[i])).fold(0.0, f64::max)
    }
}

#[cfg(test)]
impl Properties {
    /// Properties that are `conductivity` and `specific_heat` at every temperature, of a reduced model with these constants.
    pub(crate) fn uniform(conductivity: f64, specific_heat: f64, constants: [f64; 2]) -> Properties {
        let mut temperature = [0.0; PROPERTY_POINTS];
        temperature.iter_mut().enumerate().for_each(|(i, t)| *t = 100.0 * (i + 1) as f64);
        let table = PropertyTable {
            points: 2,
            temperature,
            conductivity: [conductivity; PROPERTY_POINTS],
            specific_heat: [specific_heat; PROPERTY_POINTS],
        };
        Properties { table, constants, steepest: 0.0, changes: [0.0; PROPERTY_POINTS], part: PART }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;
    use scene::variables::{STARTS, find};

    fn properties() -> Properties {
        let mut starts = STARTS;
        let mut set = |name: String, value: f64| starts[find(&name).unwrap() as usize] = value;
        set("strip.property_table.points".into(), 4.0);
        for (i, point) in [(300.0, 50.0, 450.0), (400.0, 50.0, 450.0), (700.0, 40.0, 500.0), (900.0, 42.0, 800.0)]
            .into_iter()
            .enumerate()
        {
            for (row, value) in [("temperature", point.0), ("conductivity", point.1), ("specific_heat", point.2)] {
                set(format!("strip.property_table.{row}[{}]", i + 1), value);
            }
        }
        Properties::of(&Scene::new(&starts, None).unwrap().strip, PART).unwrap()
    }

    #[test]
    fn properties_change_by_at_most_a_hundredth_within_a_part() {
        let properties = properties();
        let mut parts = Vec::new();
        for i in 0..4000 {
            let t = 250.0 + 0.2 * f64::from(i);
            let (part, ends) = properties.part(t);
            assert_eq!(properties.part(part), (part, ends), "{t}: {part}");
            assert!(ends[0] <= t + 1e-5 && t <= ends[1] + 1e-5, "{t}: {ends:?}");
            let [one, other] = [properties.table.at(t), properties.table.at(part)];
            for k in 0..2 {
                assert!((one[k] / other[k] - 1.0).abs() < 0.7 * PART, "{t} {part}: {one:?} {other:?}");
            }
            if parts.last() != Some(&part) {
                parts.push(part);
            }
        }
        // ln(50/40) + ln(800/500) in hundredths, and the ends.
        assert!((65..75).contains(&parts.len()), "{}", parts.len());
        assert!(parts.windows(2).all(|pair| pair[0] < pair[1]), "{parts:?}");
    }

    #[test]
    fn a_bound_of_a_change_is_not_below_it() {
        let properties = properties();
        for (from, to) in [(310.0, 350.0), (390.0, 410.0), (500.0, 650.0), (880.0, 1000.0), (900.0, 350.0)] {
            let exact = properties.change([from, to], 0.0);
            let bound = properties.change([from, to], f64::INFINITY);
            assert!(exact <= bound * (1.0 + 1e-12), "{from} {to}: {exact} {bound}");
        }
    }
}
