//! Communication steps that follow given inputs, where no step is given.
//!
//! Inputs are linear between their rows. An interval over which an input changes by the fraction $c$ of its largest magnitude is
//! divided into at least $20 c$ equal steps, so that a peak between its ends is seen: between two points at most
//! $h^2 |T''|/8$ is missed, 1e-3 of the rise in a stop. After a change the solution relaxes, first fast, then slowly, so
//! within an interval a step is at most 1.25 times the one before; and none is longer than about a thousandth of the whole time. Two equal times are a
//! jump: no step lies between them, and the solution relaxes anew.

use crate::nominal::round;

/// Steps into which the whole time is divided at least.
const LEAST_STEPS: f64 = 1000.0;

/// Steps of an interval over which an input changes by its largest magnitude.
const PARTS: f64 = 20.0;

/// Ratio of a step to the one before at most, within an interval.
const GROWTH: f64 = 1.25;

/// First step over the longest one: the first row is a change too.
const FIRST: f64 = 1.0 / 16.0;

/// Steps at most: where there would be more, intervals have fewer [`PARTS`]; each has one in any case.
const MOST_STEPS: f64 = 5e4;

/// Relative excess of an interval over the longest step that is rounding of its times.
const SAME_TIME: f64 = 1e-6;

/// The longest step over the whole time, a round number, s.
pub fn longest(times: &[f64]) -> f64 {
    round((times[times.len() - 1] - times[0]) / LEAST_STEPS)
}

/// Communication points, each once, for inputs of these values at these times: all times, and those between them that follow the inputs.
pub fn points(times: &[f64], inputs: &[&[f64]]) -> Vec<f64> {
    let graded = |steps: &[f64]| divided(times, steps, GROWTH, FIRST * longest(times));
    graded(&steps(times, inputs, |steps| graded(steps).len() as f64))
}

/// The step of the same resolution where all have to be equal: the shortest that an interval needs, s.
pub fn equal(times: &[f64], inputs: &[&[f64]]) -> f64 {
    let is_jump: Vec<bool> = times.windows(2).map(|pair| pair[0] == pair[1]).collect();
    let shortest = |steps: &[f64]| {
        let lasting = steps.iter().zip(&is_jump).filter(|(_, is_jump)| !**is_jump);
        lasting.fold(f64::INFINITY, |least, (step, _)| least.min(*step))
    };
    let whole = times[times.len() - 1] - times[0];
    shortest(&steps(times, inputs, |steps| whole / shortest(steps)))
}

/// Communication points with steps of at most `step`, equal between two times.
pub fn regular(times: &[f64], step: f64) -> Vec<f64> {
    divided(times, &vec![step; times.len() - 1], f64::INFINITY, step)
}

/// Number of steps of [`regular`].
pub fn count(times: &[f64], step: f64) -> f64 {
    times.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| parts(pair[1] - pair[0], step)).sum()
}

fn parts(length: f64, step: f64) -> f64 {
    (length / step * (1.0 - SAME_TIME)).ceil().max(1.0)
}

/// Longest step of every interval between two times; `count` says how many steps they make.
fn steps(times: &[f64], inputs: &[&[f64]], count: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let (longest, changes) = (longest(times), changes(times.len(), inputs));
    let mut most = PARTS;
    loop {
        let of = |(pair, change): (&[f64], &f64)| ((pair[1] - pair[0]) / (most * change).ceil().max(1.0)).min(longest);
        let steps: Vec<f64> = times.windows(2).zip(&changes).map(of).collect();
        if most < 1.0 || count(&steps) <= MOST_STEPS {
            return steps;
        }
        most *= 0.5;
    }
}

/// Largest change of an input over every interval, over its largest magnitude.
fn changes(rows: usize, inputs: &[&[f64]]) -> Vec<f64> {
    let mut changes = vec![0.0_f64; rows - 1];
    for values in inputs {
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for (change, pair) in changes.iter_mut().zip(values.windows(2)) {
            if largest > 0.0 {
                *change = change.max((pair[1] - pair[0]).abs() / largest);
            }
        }
    }
    changes
}

/// Every interval in steps of at most its own of `steps`, each at most `growth` times the one before, which is `first` at the beginning
/// and after a jump; equal otherwise.
fn divided(times: &[f64], steps: &[f64], growth: f64, first: f64) -> Vec<f64> {
    let (mut points, mut before) = (vec![times[0]], first);
    for (pair, step) in times.windows(2).zip(steps) {
        let length = pair[1] - pair[0];
        if length == 0.0 {
            before = before.min(first);
            continue;
        }
        let parts = parts(length, *step);
        let equal = length / parts;
        if equal <= growth * before {
            points.extend((1..parts as usize).map(|part| pair[0] + length * part as f64 / parts));
            before = equal;
        } else {
            let (mut ends, mut end) = (Vec::new(), 0.0);
            while end < length * (1.0 - SAME_TIME) {
                before = equal.min(growth * before);
                end += before;
                ends.push(end);
            }
            // The last one ends with the interval.
            ends.pop();
            points.extend(ends.iter().map(|part| pair[0] + length * (part / end)));
        }
        points.push(pair[1]);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(points: &[f64]) -> Vec<f64> {
        points.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    /// A stop of 8 s, released within 1 s, in ten hours.
    const TIMES: [f64; 5] = [0.0, 17_000.0, 17_008.0, 17_009.0, 36_000.0];
    const SPEED: [f64; 5] = [30.0, 30.0, 0.0, 0.0, 0.0];
    const LOAD: [f64; 5] = [8e3, 8e3, 8e3, 0.0, 0.0];

    #[test]
    fn intervals_are_divided_as_far_as_their_inputs_change() {
        let points = points(&TIMES, &[&SPEED, &LOAD]);
        let within = |from: f64, to: f64| points.iter().filter(|time| (from..to).contains(*time)).count();
        assert!(TIMES.iter().all(|time| points.contains(time)));
        assert_eq!([within(17_000.0, 17_008.0), within(17_008.0, 17_009.0)], [20, 20]);
        let steps = lengths(&points);
        assert!(steps.iter().all(|step| *step > 0.0 && *step <= 20.0 * (1.0 + SAME_TIME)), "{steps:?}");
        assert!(steps.windows(2).all(|pair| pair[1] <= 1.1 * GROWTH * pair[0]), "{steps:?}");
        assert!(points.len() < 2000, "{}", points.len());
    }

    /// What is lost between the points: the peak of a stop, whose rise is sqrt(s) (1 - 2 s/3), and a cooling with two rates.
    #[test]
    fn peaks_and_relaxations_between_rows_are_seen() {
        let points = points(&TIMES, &[&SPEED, &LOAD]);
        let rise = |time: f64| match (time - 17_000.0) / 8.0 {
            s if (0.0..=1.0).contains(&s) => s.sqrt() * (1.0 - 2.0 * s / 3.0),
            s if s > 1.0 => (0.8 * (-(s - 1.0)).exp() + 0.2 * (-(s - 1.0) / 100.0).exp()) / 3.0,
            _ => 0.0,
        };
        let peak = 0.5_f64.sqrt() * 2.0 / 3.0;
        let seen = points.iter().map(|time| rise(*time)).fold(0.0, f64::max);
        assert!(seen > 0.998 * peak, "{}", seen / peak);
        // Linear between the points, apart from the beginning of the stop, where the rise is a square root.
        for pair in points.windows(2).filter(|pair| pair[0] >= 17_000.5) {
            for part in [0.25, 0.5, 0.75] {
                let time = pair[0] + part * (pair[1] - pair[0]);
                let apart = rise(pair[0]) + part * (rise(pair[1]) - rise(pair[0])) - rise(time);
                assert!(apart.abs() < 1e-2 * peak, "{time} s: {apart}");
            }
        }
    }

    #[test]
    fn samples_and_noise_are_taken_as_they_are() {
        let times: Vec<f64> = (0..5000).map(f64::from).collect();
        let speed: Vec<f64> = times.iter().map(|time| 20.0 + (0.01 * time).sin() + 0.1 * (7.0 * time).sin()).collect();
        let first = points(&times, &[&speed]).len();
        assert!(first < 5020, "{first}");
        // Rows that are all changes, beyond the number of points that is meant.
        let speed: Vec<f64> = times.iter().map(|time| time % 2.0).collect();
        let many = points(&times, &[&speed]).len();
        assert!((25_000..=50_001).contains(&many), "{many}");
        let times: Vec<f64> = (0..100_000).map(f64::from).collect();
        let speed: Vec<f64> = times.iter().map(|time| time % 2.0).collect();
        let points = points(&times, &[&speed]);
        assert!(
            points.len() < 100_020
                && times.iter().all(|time| points.binary_search_by(|own| own.total_cmp(time)).is_ok())
        );
    }

    #[test]
    fn a_jump_is_no_step_and_what_follows_begins_anew() {
        let times = [0.0, 500.0, 500.0, 1000.0];
        let speed = [10.0, 10.0, 0.0, 0.0];
        let points = points(&times, &[&speed]);
        assert!(points.windows(2).all(|pair| pair[1] > pair[0]) && points.contains(&500.0), "{points:?}");
        let at = points.iter().position(|time| *time == 500.0).unwrap();
        let [before, after] = [points[at] - points[at - 1], points[at + 1] - points[at]];
        assert!(before > 0.9 && after < 0.1, "{before} {after}");
        assert_eq!(equal(&times, &[&speed]), 1.0);
        assert_eq!((count(&times, 500.0), regular(&times, 500.0)), (2.0, vec![0.0, 500.0, 1000.0]));
    }

    #[test]
    fn equal_steps_resolve_the_shortest_interval_as_far_as_is_meant() {
        assert_eq!(equal(&[0.0, 100.0], &[&[3.0, 3.0]]), 0.1);
        assert!((equal(&[0.0, 0.7, 1000.0], &[&[10.0, 20.0, 10.0]]) / 0.07 - 1.0).abs() < 1e-9);
        // A jump within a microsecond, which no equal steps resolve, is met.
        assert_eq!(equal(&[0.0, 1e-6, 1000.0], &[&[10.0, 20.0, 10.0]]), 1e-6);
        assert_eq!(regular(&[1.0, 3.0, 3.5], 0.5), [1.0, 1.5, 2.0, 2.5, 3.0, 3.5]);
        assert_eq!((count(&[0.0, 1.0], 0.25), regular(&[1.0, 3.5], 10.0)), (4.0, vec![1.0, 3.5]));
    }
}
