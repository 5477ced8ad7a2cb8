//! Communication steps and their status functions.

#![forbid(unsafe_code)]

use super::Instance;
use crate::fmi2::policy::{self, Fault};
use crate::fmi2::problem::{self, Outcome, Problem, argument};
use crate::fmi2::types::{Boolean, FALSE, LAST_SUCCESSFUL_TIME, Real, StatusKind, TERMINATED};
use scene::message::Exact;

impl Instance {
    /// `fmi2DoStep`. The step has exactly the given length, and the next one begins at the importer's own
    /// communication point: rounding differences between its clock and the sum of the steps do not
    /// accumulate, and a constant step stays constant.
    #[inline(always)]
    pub(crate) fn do_step(&mut self, from: Real, step: Real) -> Outcome {
        let end = from + step;
        let fits = step >= 0.0
            && (from - self.clock.time).abs() <= policy::same_time_within(self.clock.time)
            && self.clock.stop.is_none_or(|stop| end <= stop + policy::same_time_within(stop))
            && end.is_finite();
        if !fits {
            return self.misfit(from, step);
        }
        match self.component.step(step) {
            Ok(()) => {
                self.clock.time = end;
                Ok(())
            }
            Err(text) => {
                let (step, from) = (Exact(step), Exact(from));
                Err(Problem { fault: Fault::Step, text: format!("step of {step} s from {from} s: {text}") })
            }
        }
    }

    #[cold]
    fn misfit(&self, from: Real, step: Real) -> Outcome {
        let (time, end) = (self.clock.time, from + step);
        if !(step >= 0.0 && step.is_finite()) {
            return argument(format!("the step {} s must be a finite number >= 0", Exact(step)));
        }
        if !((from - time).abs() <= policy::same_time_within(time) && end.is_finite()) {
            return argument(format!(
                "the communication point {} s is not the end of the last step, {} s (within {} s)",
                Exact(from),
                Exact(time),
                Exact(policy::same_time_within(time))
            ));
        }
        let [step, from, end, stop] = [step, from, end, self.clock.stop.unwrap_or(f64::INFINITY)].map(Exact);
        argument(format!("the step of {step} s from {from} s ends at {end} s, past the stop time {stop} s"))
    }

    /// `fmi2GetRealStatus`: the time of the last successful step.
    pub(crate) fn real_status(&mut self, kind: StatusKind) -> Result<Real, Problem> {
        if kind == LAST_SUCCESSFUL_TIME { Ok(self.clock.time) } else { Err(problem::no_status(kind)) }
    }

    /// `fmi2GetBooleanStatus`: this slave never terminates the simulation.
    pub(crate) fn boolean_status(&mut self, kind: StatusKind) -> Result<Boolean, Problem> {
        if kind == TERMINATED { Ok(FALSE) } else { Err(problem::no_status(kind)) }
    }

    /// `fmi2GetStatus`, `fmi2GetIntegerStatus`, `fmi2GetStringStatus`: they report on steps that are
    /// still running, of which there are none.
    pub(crate) fn no_status<T>(&mut self, kind: StatusKind) -> Result<T, Problem> {
        Err(problem::no_status(kind))
    }
}
