//! Totals and extremes of a cycle.
//!
//! Theory: docs/theory.md, section 9.5.

use crate::line::operators::LineOperators;

/// Totals that increase from cycle to cycle, per depth and punch.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Totals {
    /// Worn volumes of punch and strip, m2.
    pub volume: [f64; 2],
    /// Work of wear, `integral p dw` of both bodies, J/m.
    pub wear_dissipation: f64,
    /// Friction heat, J/m.
    pub dissipated: f64,
    /// Heat out of the bodies through the punch's top, the strip's base and to the ambient, J/m.
    pub lost: [f64; 3],
    /// Heat received by punch and strip, J/m.
    pub received: [f64; 2],
}

impl Totals {
    fn entries(&self) -> [f64; 9] {
        let Totals { volume, wear_dissipation, dissipated, lost, received } = *self;
        [volume[0], volume[1], wear_dissipation, dissipated, lost[0], lost[1], lost[2], received[0], received[1]]
    }

    fn of(e: [f64; 9]) -> Totals {
        Totals {
            volume: [e[0], e[1]],
            wear_dissipation: e[2],
            dissipated: e[3],
            lost: [e[4], e[5], e[6]],
            received: [e[7], e[8]],
        }
    }

    /// `self + factor other`.
    pub(crate) fn plus(&self, factor: f64, other: &Totals) -> Totals {
        let (mine, its) = (self.entries(), other.entries());
        Totals::of(std::array::from_fn(|i| mine[i] + factor * its[i]))
    }
}

/// Range of the temperatures over a cycle.
pub(super) struct Extremes {
    pub range: [[Vec<f64>; 2]; 2],
    /// Minimum, time integral and maximum of the mean contact temperature.
    pub contact: [f64; 3],
    pub highest: f64,
    /// Temperatures of punch and strip recorded last, and their mean.
    pub last: [Vec<f64>; 2],
    mean: f64,
}

impl Extremes {
    /// Empty range of N cells.
    pub(crate) fn new(count: usize) -> Extremes {
        let all = |value: f64| [vec![value; count], vec![value; count]];
        Extremes {
            range: [all(f64::INFINITY), all(f64::NEG_INFINITY)],
            contact: [f64::INFINITY, 0.0, f64::NEG_INFINITY],
            highest: f64::NEG_INFINITY,
            last: all(0.0),
            mean: 0.0,
        }
    }

    /// Adds the temperatures of punch and strip at the end of a step of `step` s; 0: the start of the cycle.
    pub(crate) fn record(&mut self, temperature: &[Vec<f64>; 2], operators: &LineOperators, step: f64) {
        let areas = &operators.weights;
        let highest = operators.hottest.of(temperature);
        if highest > self.highest || highest.is_nan() {
            self.highest = highest;
        }
        let area: f64 = areas.iter().sum();
        let mut mean = 0.0;
        for (side, values) in temperature.iter().enumerate() {
            for (i, &t) in values.iter().enumerate() {
                self.range[0][side][i] = self.range[0][side][i].min(t);
                self.range[1][side][i] = self.range[1][side][i].max(t);
                mean += 0.5 * areas[i] / area * t;
            }
        }
        self.contact[0] = self.contact[0].min(mean);
        self.contact[1] += step * 0.5 * (mean + self.mean);
        self.contact[2] = self.contact[2].max(mean);
        self.mean = mean;
        self.last.iter_mut().zip(temperature).for_each(|(last, now)| last.copy_from_slice(now));
    }
}
