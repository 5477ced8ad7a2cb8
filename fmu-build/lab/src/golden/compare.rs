//! Where two records of a scene differ first, and by how much.

use super::record::{Record, Series};
use super::run::{DERIVATIVE, WORK};
use scene::variables::{Kind, TABLE};
use std::fmt;

/// How much may differ.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Allowed {
    /// Nothing: bits, work counters and messages are the same.
    Nothing,
    /// Values by so much of their scale, see [`least_scale`]; work counters, derivatives, which jump at kinks, and the
    /// numbers in messages by anything.
    Relative(f64),
}

#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Value {
    pub name: String,
    /// Communication point and time, s; `None` for what has none.
    pub point: Option<(usize, f64)>,
    pub recorded: f64,
    pub now: f64,
}

#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Differences {
    /// Differences that are not of values: messages, communication points, variables.
    pub structure: Vec<String>,
    /// The first kept value that differs.
    pub first: Option<Value>,
    /// The first communication point, kept or not, at which anything differs.
    pub from: Option<usize>,
    /// Variables that differ only between the kept communication points.
    pub between: Vec<String>,
    /// Last values of the work counters that differ.
    pub work: Vec<Value>,
    /// Number of variables, profiles and arrays of which a kept value differs.
    pub count: usize,
    /// The largest difference over the scale of its variable, see [`least_scale`], and the variable.
    pub largest: (f64, String),
}

impl Differences {
    pub(crate) fn is_none(&self) -> bool {
        self.structure.is_empty()
            && self.first.is_none()
            && self.from.is_none()
            && self.between.is_empty()
            && self.work.is_empty()
    }
}

/// Numbers of the format between two; 0 and -0 are one apart, and so are neighbours.
fn units_in_the_last_place(a: f64, b: f64) -> u64 {
    let order = |value: f64| {
        let bits = value.to_bits();
        if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
    };
    order(a).abs_diff(order(b))
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name)?;
        if let Some((point, time)) = self.point {
            write!(f, " at {time} s (communication point {point})")?;
        }
        let units = units_in_the_last_place(self.recorded, self.now);
        let plural = if units == 1 { "" } else { "s" };
        write!(f, ": recorded {:e}, now {:e}, {units} unit{plural} in the last place", self.recorded, self.now)
    }
}

/// The least scale of a variable's differences; the scale is the variable's largest magnitude in the scene where that is more.
///
/// A tenth of the variable's nominal value: rounding around 0, as of the heat flow through a base that no heat has reached yet,
/// counts as 0. Errors and residuals are relative numbers already.
fn least_scale(variable: &str) -> f64 {
    if variable.contains("error") || variable.contains("change_of") {
        return 1.0;
    }
    match TABLE.iter().find(|row| row.name == variable).map(|row| row.kind) {
        Some(Kind::Real { nominal, .. }) => 0.1 * nominal,
        _ => 0.0,
    }
}

/// The name without the communication point of a profile, and that point.
fn split(name: &str) -> (&str, Option<usize>) {
    match name.split_once('@') {
        Some((variable, point)) => (variable, point.parse().ok()),
        None => (name, None),
    }
}

/// A message without its numbers.
fn wording(message: &str) -> String {
    let kept = |c: char| !(c.is_ascii_digit() || ".-+".contains(c));
    message
        .split_whitespace()
        .filter(|word| !word.contains(|c: char| c.is_ascii_digit()))
        .collect::<Vec<_>>()
        .join(" ")
        .chars()
        .filter(|&c| kept(c))
        .collect()
}

/// Differences between a record and the present results.
pub(crate) fn compare(recorded: &Record, now: &Record, allowed: Allowed) -> Differences {
    let mut found = Differences::default();
    let exact = allowed == Allowed::Nothing;
    let same_message = match (&recorded.error, &now.error) {
        (Some(then), Some(now)) if !exact => wording(then) == wording(now),
        (then, now) => then == now,
    };
    if !same_message {
        let text = |error: &Option<String>| error.clone().unwrap_or_else(|| "none".into());
        found.structure.push(format!("error: recorded {:?}, now {:?}", text(&recorded.error), text(&now.error)));
    }
    if recorded.points != now.points || recorded.kept != now.kept {
        let text = format!("communication points: recorded {}, now {}, or at other times", recorded.points, now.points);
        found.structure.push(text);
        return found;
    }
    let find = |record: &Record, name: &str| record.series.iter().position(|series| series.name == name);
    for series in now.series.iter().filter(|series| find(recorded, &series.name).is_none()) {
        found.structure.push(format!("{} is not in the record", series.name));
    }
    if exact {
        found.from = recorded.hashes.iter().zip(&now.hashes).position(|(then, now)| then != now);
    }
    let mut earliest = (usize::MAX, true);
    for then in &recorded.series {
        let Some(index) = find(now, &then.name) else {
            found.structure.push(format!("{} is in the record and not computed any more", then.name));
            continue;
        };
        let series = &now.series[index];
        if then.values.len() != series.values.len() {
            let lengths = [then, series].map(|series| series.values.len());
            found.structure.push(format!("{}: recorded {} values, now {}", then.name, lengths[0], lengths[1]));
            continue;
        }
        if !exact && [WORK, DERIVATIVE].iter().any(|kind| then.name.starts_with(kind)) {
            continue;
        }
        compare_series(recorded, [then, series], allowed, &mut earliest, &mut found);
    }
    found
}

fn compare_series(
    record: &Record,
    [then, now]: [&Series; 2],
    allowed: Allowed,
    earliest: &mut (usize, bool),
    found: &mut Differences,
) {
    let (variable, profile_point) = split(&then.name);
    let is_work = variable.starts_with(WORK);
    // Values that are not numbers are no magnitude; they show in the difference.
    let magnitudes = then.values.iter().map(|value| value.abs()).filter(|magnitude| magnitude.is_finite());
    let scale = magnitudes.fold(least_scale(variable), f64::max);
    let mut differs = false;
    for (place, (&old, &new)) in then.values.iter().zip(&now.values).enumerate() {
        if old.to_bits() == new.to_bits() {
            continue;
        }
        let relative = if old == new { 0.0 } else { (old - new).abs() / scale };
        let relative = if relative.is_nan() { f64::INFINITY } else { relative };
        let tolerated = matches!(allowed, Allowed::Relative(most) if relative <= most);
        if !is_work && relative > found.largest.0 {
            found.largest = (relative, variable.to_owned());
        }
        if tolerated {
            continue;
        }
        let is_timed = profile_point.is_none() && then.values.len() == record.kept.len();
        let point = if is_timed {
            record.kept.get(place).copied()
        } else {
            profile_point.and_then(|point| record.kept.iter().find(|kept| kept.0 == point).copied())
        };
        let name =
            if is_timed || then.values.len() == 1 { variable.to_owned() } else { format!("{variable}[{}]", place + 1) };
        let value = Value { name, point, recorded: old, now: new };
        let order = (point.map_or(usize::MAX - 1, |point| point.0), is_work);
        if order < *earliest {
            *earliest = order;
            found.first = Some(value.clone());
        }
        if is_work && place + 1 == then.values.len() {
            found.work.push(value);
        }
        differs = true;
    }
    found.count += usize::from(differs);
    if !differs
        && allowed == Allowed::Nothing
        && then.hash != now.hash
        && !found.between.iter().any(|name| name == variable)
    {
        found.between.push(variable.to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::hash;
    use super::*;

    fn record(values: [f64; 3], steps: f64) -> Record {
        let series = |name: &str, values: &[f64]| {
            let hash = hash(values.iter().copied());
            Series { name: name.into(), hash, values: values.to_vec() }
        };
        Record {
            error: None,
            points: 5,
            kept: vec![(0, 0.0), (2, 0.2), (4, 0.4)],
            hashes: values.iter().map(|value| value.to_bits() as u32).collect(),
            series: vec![series("work.steps", &[0.0, 3.0, steps]), series("wear_depth", &values)],
        }
    }

    #[test]
    fn units_in_the_last_place_count_over_zero() {
        assert_eq!(units_in_the_last_place(1.0, 1.0_f64.next_up()), 1);
        assert_eq!(units_in_the_last_place(-1.0, (-1.0_f64).next_up()), 1);
        assert_eq!(units_in_the_last_place(0.0, -0.0), 1);
        assert_eq!(units_in_the_last_place(-f64::from_bits(1), f64::from_bits(1)), 3);
        assert_eq!(units_in_the_last_place(2.5, 2.5), 0);
    }

    #[test]
    fn the_first_difference_is_named_with_its_time_and_size() {
        let (then, now) = (record([0.0, 1.0, 2.0], 5.0), record([0.0, 1.0_f64.next_up(), 4.0], 6.0));
        assert!(compare(&then, &then, Allowed::Nothing).is_none());
        let found = compare(&then, &now, Allowed::Nothing);
        let text = found.first.as_ref().unwrap().to_string();
        assert!(
            text.starts_with("wear_depth at 0.2 s (communication point 2): recorded 1e0, now 1.0000000000000002e0"),
            "{text}"
        );
        assert!(text.ends_with(", 1 unit in the last place"), "{text}");
        assert_eq!((found.count, found.from), (2, Some(1)));
        assert_eq!(found.largest, (1.0, "wear_depth".to_owned()));
        assert_eq!(found.work.len(), 1);
    }

    #[test]
    fn a_tolerance_is_relative_to_the_largest_magnitude_and_bears_no_number_that_is_none() {
        let then = record([0.0, 1.0, 2.0], 5.0);
        let within = |values: [f64; 3], tolerance: f64| {
            compare(&then, &record(values, 7.0), Allowed::Relative(tolerance)).is_none()
        };
        assert!(within([1e-9, 1.0, 2.0], 1e-9) && !within([3e-9, 1.0, 2.0], 1e-9));
        assert!(!within([0.0, 1.0, f64::NAN], 1e9));
    }

    #[test]
    fn rounding_around_zero_is_no_large_difference() {
        let named = |name: &str, value: f64| {
            let mut record = record([0.0, value, 0.0], 5.0);
            record.series[1].name = name.into();
            record
        };
        let same = |name: &str, [then, now]: [f64; 2]| {
            compare(&named(name, then), &named(name, now), Allowed::Relative(1e-6)).is_none()
        };
        // W, of 100 W; m, of 1e-6 m; relative.
        assert!(same("heat_flow_strip_base", [1e-12, -7e-12]) && !same("heat_flow_strip_base", [1e-3, 2e-3]));
        assert!(same("wear_depth", [0.0, 9e-14]) && !same("wear_depth", [0.0, 1.1e-13]));
        assert!(same("estimated_error", [1e-9, 5e-7]) && !same("estimated_error", [1e-9, 1e-5]));
    }

    #[test]
    fn what_differs_between_the_kept_points_only_is_found_by_the_hashes() {
        let then = record([0.0, 1.0, 2.0], 5.0);
        let mut now = then.clone();
        now.series[1].hash = now.series[1].hash.with(1);
        assert_eq!(compare(&then, &now, Allowed::Nothing).between, ["wear_depth"]);
        assert!(compare(&then, &now, Allowed::Relative(1e-12)).is_none());
    }

    #[test]
    fn messages_and_variables_that_come_or_go_are_differences() {
        let then = Record { error: Some("step at 0.2 s: at most 3 N".into()), ..record([0.0, 1.0, 2.0], 5.0) };
        let other = Record { error: Some("step at 0.3 s: at most 3 N".into()), ..then.clone() };
        assert!(compare(&then, &other, Allowed::Nothing).structure[0].contains("0.3 s"));
        assert!(compare(&then, &other, Allowed::Relative(0.0)).is_none());
        let mut less = then.clone();
        let _ = less.series.pop();
        assert!(
            !compare(&then, &less, Allowed::Nothing).is_none()
                && !compare(&less, &then, Allowed::Relative(1.0)).is_none()
        );
    }
}
