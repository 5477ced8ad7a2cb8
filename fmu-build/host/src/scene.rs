//! One scene of a batch: everything that a run takes besides the FMU.

use crate::error::Failure;
use crate::schedule::{Interpolation, Schedule};

/// Time of a run, in constant communication steps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Span {
    /// First communication point, s.
    pub start: f64,
    /// Last communication point, s.
    pub stop: f64,
    /// Communication step, s.
    pub step: f64,
}

/// Tolerance for the distance of a time from a communication point, in steps, for times written with few digits.
const MISSED: f64 = 1e-6;

impl Span {
    /// Number of steps.
    pub fn steps(&self) -> Result<usize, Failure> {
        let Self { start, stop, step } = *self;
        if !(start.is_finite() && stop.is_finite() && step.is_finite() && step > 0.0 && stop > start) {
            return Err(Failure::request(format!(
                "from {start} s to {stop} s in steps of {step} s: all must be finite, the step positive and the stop after the start"
            )));
        }
        self.index(stop, "the stop time")
    }

    /// Communication point `index`.
    #[inline]
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.step
    }

    /// Index of the communication point at `time`.
    fn index(&self, time: f64, what: &str) -> Result<usize, Failure> {
        let index = ((time - self.start) / self.step).round();
        // Beyond, a step is no longer a number of its own.
        let is_index = (0.0..=1e15).contains(&index);
        if is_index && (time - self.time(index as usize)).abs() <= MISSED * self.step {
            return Ok(index as usize);
        }
        Err(Failure::request(format!(
            "{what} {time} s is no communication point: they start at {} s and follow in steps of {} s",
            self.start, self.step
        )))
    }

    /// Indices of the communication points at these times.
    ///
    /// # Errors
    /// Where one is none, lies after the stop, or does not follow the one before.
    pub fn indices(&self, times: &[f64]) -> Result<Vec<usize>, Failure> {
        let steps = self.steps()?;
        let indices = times.iter().map(|&time| self.index(time, "the recorded time")).collect::<Result<Vec<_>, _>>()?;
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(Failure::request(format!(
                "recorded times must increase: {} s is followed by {} s",
                self.time(pair[0]),
                self.time(pair[1])
            )));
        }
        match indices.last() {
            Some(&last) if last > steps => Err(Failure::request(format!(
                "the recorded time {} s lies after the stop time {} s",
                self.time(last),
                self.stop
            ))),
            _ => Ok(indices),
        }
    }
}

/// Everything that a run takes.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Names and values of the parameters that differ from the FMU's own; items of enumerations and Booleans by their
    /// numbers.
    pub parameters: &'a [(&'a str, f64)],
    /// Names of the inputs, one for every column of the schedule. All others keep the FMU's start values.
    pub inputs: &'a [&'a str],
    /// Factors on the schedule's columns; empty: 1.
    pub factors: &'a [f64],
    /// The inputs over time.
    pub schedule: Schedule<'a>,
    /// Interpolation between rows.
    pub interpolation: Interpolation,
    /// From when to when.
    pub span: Span,
    /// Relative tolerance handed to the FMU; `None`: its own.
    pub tolerance: Option<f64>,
    /// Names of the variables to record.
    pub outputs: &'a [&'a str],
    /// Communication points to record at, s, increasing.
    pub points: &'a [f64],
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPAN: Span = Span { start: 0.0, stop: 1370.0, step: 0.1 };

    #[test]
    fn spans_are_whole_numbers_of_steps() {
        assert_eq!(SPAN.steps().unwrap(), 13_700);
        assert_eq!(Span { start: 3.0, stop: 3.3, step: 0.1 }.steps().unwrap(), 3);
        for broken in [
            Span { step: 0.0, ..SPAN },
            Span { step: f64::NAN, ..SPAN },
            Span { stop: 0.0, ..SPAN },
            Span { stop: 1370.05, ..SPAN },
            Span { stop: f64::INFINITY, ..SPAN },
        ] {
            assert!(broken.steps().is_err(), "{broken:?}");
        }
    }

    #[test]
    fn recorded_times_are_communication_points() {
        assert_eq!(SPAN.indices(&[0.0, 0.3, 1370.0]).unwrap(), [0, 3, 13_700]);
        let reason = |times: &[f64]| SPAN.indices(times).unwrap_err().reason;
        assert!(reason(&[0.25]).contains("0.25 s is no communication point"));
        assert!(reason(&[-0.1]).contains("no communication point"));
        assert!(reason(&[f64::NAN]).contains("no communication point"));
        assert!(reason(&[2.0, 1.0]).contains("must increase"));
        assert!(reason(&[1370.1]).contains("after the stop"));
    }
}
