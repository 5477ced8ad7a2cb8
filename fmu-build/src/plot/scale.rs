//! Scale of a chart's axis: coordinates, tick values and tick labels.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// Coordinate of an axis: linear, or logarithmic with its range given by exponents of 10.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Scale {
    pub(super) first: f64,
    pub(super) last: f64,
    pub(super) logarithmic: bool,
}

impl Scale {
    fn ticks(&self, most: usize) -> Vec<f64> {
        if self.logarithmic { self.decades(most) } else { round_numbers(self.first, self.last, most) }
    }

    fn decades(&self, most: usize) -> Vec<f64> {
        let (first, last) = (self.first.ceil() as i32, self.last.floor() as i32);
        let count = (last - first + 1).max(0) as usize;
        if count >= 3 {
            let every = count.div_ceil(most.max(1));
            return (first..=last).step_by(every).map(|exponent| 10f64.powi(exponent)).collect();
        }
        // Less than three powers of ten: 1, 2 and 5 times each.
        let within = |value: &f64| (self.first..=self.last).contains(&value.log10());
        (first - 1..=last + 1)
            .flat_map(|exponent| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(exponent)))
            .filter(within)
            .collect()
    }
}

/// Multiples of 1, 2 or 5 times a power of 10 between two values, `most` at most.
fn round_numbers(first: f64, last: f64, most: usize) -> Vec<f64> {
    let (low, high) = (first.min(last), first.max(last));
    let coarse = (high - low) / most.max(1) as f64;
    if !(coarse > 0.0 && coarse.is_finite()) {
        return vec![low];
    }
    let power = 10f64.powf(coarse.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|&step| step >= coarse);
    let step = step.unwrap_or(10.0 * power);
    let (from, to) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (from..=to).map(|index| index as f64 * step).collect()
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (begin, end): (i32, i32)) -> i32 {
        let place = if self.logarithmic { value.log10() } else { *value };
        let share = (place - self.first) / (self.last - self.first);
        // Far outside is still a number of pixels.
        (f64::from(begin) + share.clamp(-50.0, 50.0) * f64::from(end - begin)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.ticks(hint.max_num_points())
    }

    fn range(&self) -> Range<f64> {
        let value = |place: f64| if self.logarithmic { 10f64.powf(place) } else { place };
        value(self.first)..value(self.last)
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        if self.logarithmic { power_of_ten(*value) } else { plain(*value, self.last - self.first) }
    }
}

/// `2000` as 2e3, which every font shows; between 0.01 and 100 as plain decimals.
fn power_of_ten(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    if (-2..=2).contains(&exponent) {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    format!("{}e{exponent}", (value / 10f64.powi(exponent)).round())
}

/// A tick's value with as many decimals as the axis needs; very large or small ones by their exponent.
fn plain(value: f64, span: f64) -> String {
    let span = span.abs();
    let value = if value.abs() < 1e-9 * span { 0.0 } else { value };
    if value != 0.0 && !(1e-4..1e5).contains(&span) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - span.log10()).ceil().clamp(0.0, 8.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(round_numbers(-30.0, 30.0, 8), [-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0]);
        assert_eq!(round_numbers(0.13, 0.97, 5), [0.2, 0.4, 0.6000000000000001, 0.8]);
        let scale = |first, last| Scale { first, last, logarithmic: true };
        assert_eq!(scale(-3.2, 0.5).ticks(8), [1e-3, 1e-2, 0.1, 1.0]);
        assert_eq!(scale(0.0, 0.8).ticks(8), [1.0, 2.0, 5.0]);
        assert_eq!(scale(-8.0, 8.0).ticks(8).len(), 6);
    }
}
