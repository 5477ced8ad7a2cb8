//! Inputs over time.

use crate::error::Failure;

/// Interpolation of the rows of a schedule to inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Interpolation {
    /// The last row at or before the beginning of a step holds over the step: piecewise constant.
    Hold,
    /// Linear between the rows, taken at the beginning of a step and held over it: what importers do that interpolate
    /// a table between communication points.
    Sample,
    /// Linear over each step, through the input's derivative: a row within a step is met at the step's ends only.
    Linear,
}

impl Interpolation {
    /// The one of this number in the C interface.
    pub(crate) fn of_number(number: u32) -> Option<Self> {
        [Self::Hold, Self::Sample, Self::Linear].into_iter().find(|own| *own as u32 == number)
    }
}

/// Rows of a time and the values of every input, row by row. Before the first row its values hold, after the last row
/// those of the last.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Schedule<'a> {
    times: &'a [f64],
    values: &'a [f64],
    columns: usize,
}

impl<'a> Schedule<'a> {
    /// `times` in s, increasing, the same in two rows where inputs jump; `values`: `times.len()` rows of `columns`.
    ///
    /// # Errors
    /// Where there is no row, a length does not fit, a number is not finite or time does not increase.
    pub fn new(times: &'a [f64], values: &'a [f64], columns: usize) -> Result<Self, Failure> {
        let wrong = |reason: String| Err(Failure::request(format!("schedule: {reason}")));
        if times.is_empty() {
            return wrong("it has no row".to_owned());
        }
        if times.len().checked_mul(columns) != Some(values.len()) {
            return wrong(format!("{} rows of {columns} inputs do not make {} values", times.len(), values.len()));
        }
        if let Some(at) = times.iter().position(|time| !time.is_finite()) {
            return wrong(format!("the time of row {at} is {}", times[at]));
        }
        if let Some(at) = times.windows(2).position(|pair| pair[0] > pair[1]) {
            return wrong(format!("time must increase: {} s is followed by {} s", times[at], times[at + 1]));
        }
        if let Some(at) = times.windows(3).position(|rows| rows[0] == rows[2]) {
            return wrong(format!("{} s stands in three rows; in two it is a jump", times[at]));
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return wrong(format!("row {}, input {} is {}", at / columns, at % columns, values[at]));
        }
        Ok(Self { times, values, columns })
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    fn row(&self, at: usize) -> &'a [f64] {
        &self.values[at * self.columns..][..self.columns]
    }
}

/// Changes of the inputs since the step before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Change {
    /// A value, or a derivative: both must then be given, because setting a value clears its derivative.
    pub any: bool,
    /// Whether any derivative is other than 0.
    pub sloping: bool,
}

/// Follows a schedule from step to step, forwards.
pub(crate) struct Follower<'a> {
    schedule: Schedule<'a>,
    interpolation: Interpolation,
    factors: &'a [f64],
    /// The last row at or before the present time (or the first).
    at: usize,
    started: bool,
    /// Values at the beginning of the step.
    pub values: Vec<f64>,
    /// Derivatives over the step, per second.
    pub slopes: Vec<f64>,
}

/// Times that agree to this part of a step are one: communication points are sums of rounded numbers.
const SAME_TIME: f64 = 1e-9;

impl<'a> Follower<'a> {
    /// From before the first step. `factors`: one for every column.
    pub(crate) fn new(schedule: Schedule<'a>, interpolation: Interpolation, factors: &'a [f64]) -> Self {
        debug_assert_eq!(factors.len(), schedule.columns);
        let zeros = vec![0.0; schedule.columns];
        Self { schedule, interpolation, factors, at: 0, started: false, values: zeros.clone(), slopes: zeros }
    }

    /// Goes on to the step from `time` over `step`; times must not go back.
    #[inline]
    pub(crate) fn advance(&mut self, time: f64, step: f64) -> Change {
        let before = self.at;
        let times = self.schedule.times;
        while self.at + 1 < times.len() && times[self.at + 1] <= time + SAME_TIME * step {
            self.at += 1;
        }
        let moved = self.at != before || !self.started;
        self.started = true;
        match self.interpolation {
            Interpolation::Hold => {
                if moved {
                    let row = self.schedule.row(self.at);
                    for ((value, &given), &factor) in self.values.iter_mut().zip(row).zip(self.factors) {
                        *value = factor * given;
                    }
                }
                Change { any: moved, sloping: false }
            }
            Interpolation::Sample => Change { any: self.interpolate(self.at, time, step, moved), sloping: false },
            Interpolation::Linear => {
                let mut any = self.interpolate(self.at, time, step, moved);
                let mut end = self.at;
                while end + 1 < times.len() && times[end + 1] <= time + step * (1.0 + SAME_TIME) {
                    end += 1;
                }
                // A step that ends at a jump ends with the values before it.
                if end > self.at && times[end] == times[end - 1] && times[end] >= time + step * (1.0 - SAME_TIME) {
                    end -= 1;
                }
                let mut sloping = false;
                for column in 0..self.values.len() {
                    let last = self.factors[column] * self.value(end, time + step, step, column);
                    let slope = (last - self.values[column]) / step;
                    any |= slope != self.slopes[column];
                    sloping |= slope != 0.0;
                    self.slopes[column] = slope;
                }
                // A derivative holds for one step only.
                Change { any: any || sloping, sloping }
            }
        }
    }

    /// Values at `time`, `at` being the row at or before it; returns whether one of them changed.
    #[inline]
    fn interpolate(&mut self, at: usize, time: f64, step: f64, first: bool) -> bool {
        let mut changed = first;
        for column in 0..self.values.len() {
            let value = self.factors[column] * self.value(at, time, step, column);
            changed |= value != self.values[column];
            self.values[column] = value;
        }
        changed
    }

    #[inline]
    fn value(&self, at: usize, time: f64, step: f64, column: usize) -> f64 {
        let Schedule { times, values, columns } = self.schedule;
        let from = values[at * columns + column];
        // A time that rounding carries past its row must not produce a spurious slope.
        if at + 1 == times.len() || time <= times[at] + SAME_TIME * step {
            return from;
        }
        let to = values[(at + 1) * columns + column];
        from + (to - from) * ((time - times[at]) / (times[at + 1] - times[at]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f64; 3] = [0.0, 1.0, 1.5];
    const VALUES: [f64; 6] = [0.0, 5.0, 10.0, 5.0, 10.0, 7.0];

    #[test]
    fn inputs_jump_at_a_time_that_stands_twice() {
        let schedule = Schedule::new(&[0.0, 1.0, 1.0, 2.0], &[0.0, 2.0, 6.0, 8.0], 1).unwrap();
        for (interpolation, values, slopes) in [
            (Interpolation::Hold, [0.0, 0.0, 6.0, 6.0], [0.0; 4]),
            (Interpolation::Sample, [0.0, 1.0, 6.0, 7.0], [0.0; 4]),
            (Interpolation::Linear, [0.0, 1.0, 6.0, 7.0], [2.0; 4]),
        ] {
            let mut follower = Follower::new(schedule, interpolation, &[1.0]);
            for step in 0..4 {
                follower.advance(0.5 * step as f64, 0.5);
                assert_eq!((follower.values[0], follower.slopes[0]), (values[step], slopes[step]), "{interpolation:?}");
            }
        }
        assert!(Schedule::new(&[0.0, 1.0, 1.0, 1.0], &[0.0; 4], 1).is_err());
    }

    fn steps(interpolation: Interpolation, factors: [f64; 2]) -> Vec<(Change, Vec<f64>, Vec<f64>)> {
        let schedule = Schedule::new(&TIMES, &VALUES, 2).unwrap();
        let mut follower = Follower::new(schedule, interpolation, &factors);
        (0..8)
            .map(|step| {
                let change = follower.advance(0.25 * f64::from(step), 0.25);
                (change, follower.values.clone(), follower.slopes.clone())
            })
            .collect()
    }

    #[test]
    fn held_inputs_change_with_the_rows_only() {
        let steps = steps(Interpolation::Hold, [1.0, 2.0]);
        let changed: Vec<usize> = (0..8).filter(|&at| steps[at].0.any).collect();
        assert_eq!(changed, [0, 4, 6]);
        assert_eq!(steps[3].1, [0.0, 10.0]);
        assert_eq!(steps[4].1, [10.0, 10.0]);
        assert_eq!(steps[7].1, [10.0, 14.0]);
    }

    #[test]
    fn sampled_inputs_lie_on_the_line_between_the_rows() {
        let steps = steps(Interpolation::Sample, [1.0, 1.0]);
        assert_eq!(steps[1].1, [2.5, 5.0]);
        assert_eq!(steps[5].1, [10.0, 6.0]);
        assert_eq!(steps[7].1, [10.0, 7.0]);
        assert!(!steps[7].0.any && !steps[1].0.sloping);
    }

    #[test]
    fn derivatives_lead_from_step_to_step() {
        let steps = steps(Interpolation::Linear, [3.0, 1.0]);
        for pair in steps.windows(2) {
            for column in 0..2 {
                let end = pair[0].1[column] + 0.25 * pair[0].2[column];
                assert!((end - pair[1].1[column]).abs() < 1e-12, "{pair:?}");
            }
        }
        assert_eq!(steps[0].2, [30.0, 0.0]);
        assert!(steps[5].0.any && steps[5].0.sloping);
        // After the last row everything rests; the derivative of the step before must still be cleared.
        assert_eq!((steps[6].0, steps[7].0.any), (Change { any: true, sloping: false }, false));
    }

    #[test]
    fn a_rounded_communication_point_meets_its_row() {
        let times = [0.0, 0.3];
        let schedule = Schedule::new(&times, &[1.0, 2.0], 1).unwrap();
        let mut follower = Follower::new(schedule, Interpolation::Hold, &[1.0]);
        follower.advance(0.3 - 1e-16, 0.1);
        assert_eq!(follower.values, [2.0]);
        let mut follower = Follower::new(schedule, Interpolation::Hold, &[1.0]);
        follower.advance(0.2, 0.1);
        assert_eq!(follower.values, [1.0]);
    }

    #[test]
    fn rounding_past_a_row_makes_no_slope() {
        // 18.900000000000002 + 0.1 is beyond 19.
        let (times, time) = ([0.0, 19.0, 20.0], 189.0 * 0.1);
        assert!(time + 0.1 > 19.0);
        let schedule = Schedule::new(&times, &[7.0, 7.0, 0.0], 1).unwrap();
        let mut follower = Follower::new(schedule, Interpolation::Linear, &[1.0]);
        assert!(!follower.advance(time, 0.1).sloping);
        assert!(follower.advance(190.0 * 0.1, 0.1).sloping);
    }

    #[test]
    fn a_broken_schedule_is_refused() {
        let reason = |times: &[f64], values: &[f64], columns| Schedule::new(times, values, columns).unwrap_err().reason;
        assert!(reason(&[], &[], 1).contains("no row"));
        assert!(reason(&[0.0, 1.0], &[1.0], 1).contains("2 rows of 1 inputs"));
        assert!(reason(&[1.0, 0.0], &[1.0, 1.0], 1).contains("must increase"));
        assert!(reason(&[0.0, f64::NAN], &[1.0, 1.0], 1).contains("row 1"));
        assert!(reason(&[0.0], &[1.0, f64::INFINITY], 2).contains("row 0, input 1 is inf"));
    }
}
