//! Work budget of a communication step, by counts instead of time, so that it ends identically on every machine.
//!
//! Theory: docs/theory.md, section 7.3.

use super::StepFailure;
use numerics::maximum::maximum;

/// Largest number of internal steps tried in a communication step.
pub(crate) const MOST_STEPS: u32 = 200_000;

/// Largest number of contact solutions with heat in a communication step, for few cells.
const MOST_SOLUTIONS: u64 = 1 << 20;

/// Largest number of contact solutions times their cost: the square of the number of cells, or four times the number of thermal
/// states where that is larger (finite elements).
const MOST_OPERATIONS: u64 = 1 << 30;

/// Number of contact solutions that is permitted in any case: jumps that settle require some thousand.
const LEAST_SOLUTIONS: u64 = 1 << 14;

/// Work counters of a communication step, and their limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkBudget {
    /// Internal steps tried.
    pub steps: u32,
    /// Contact solutions with heat.
    pub solutions: u64,
    most: u64,
}

impl WorkBudget {
    /// Budget for a contact on `count` cells between bodies of `states` thermal states.
    pub(crate) fn new(count: usize, states: usize) -> WorkBudget {
        let cost = (count as u64).saturating_mul(count as u64).max(4 * states as u64).max(1);
        WorkBudget { steps: 0, solutions: 0, most: (MOST_OPERATIONS / cost).clamp(LEAST_SOLUTIONS, MOST_SOLUTIONS) }
    }

    /// Resets the counters at the start of a communication step.
    pub(crate) fn start(&mut self) {
        (self.steps, self.solutions) = (0, 0);
    }

    /// Factor on the shortest step whose thermal error is controlled: 1 up to a quarter of the budget, then doubled with each 128th. Cells that
    /// open hot and close cold have no state of rest, and alternate in the shortest steps that they are given.
    pub(crate) fn relaxation(&self) -> f64 {
        let spent = maximum(f64::from(self.steps) / f64::from(MOST_STEPS), self.solutions as f64 / self.most as f64);
        (128.0 * maximum(spent - 0.25, 0.0)).exp2()
    }

    /// Counts an internal step that is about to be tried.
    ///
    /// # Errors
    /// The budget is exhausted; `rest` describes the progress for the message.
    pub(crate) fn spend(&mut self, rest: impl FnOnce() -> String) -> Result<(), StepFailure> {
        if self.steps < MOST_STEPS && self.solutions < self.most {
            self.steps += 1;
            return Ok(());
        }
        let solutions = match self.solutions {
            0 => String::new(),
            solutions => format!(" and {solutions} solutions of the contact (at most {})", self.most),
        };
        Err(StepFailure(format!(
            "a communication step exceeds the work limit: after {} internal steps (at most {MOST_STEPS}){solutions} {}; \
             shorter communication steps, fewer solver.cells or a larger solver.tolerance reduce the work",
            self.steps,
            rest()
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_ends_at_its_limits_and_says_which() {
        let mut budget = WorkBudget::new(33, 200);
        for _ in 0..MOST_STEPS {
            budget.spend(String::new).unwrap();
        }
        let text = budget.spend(|| "here".into()).unwrap_err().to_string();
        assert!(text.contains("after 200000 internal steps (at most 200000) here"), "{text}");
        budget.start();
        budget.steps = MOST_STEPS / 4;
        assert_eq!(budget.relaxation(), 1.0);
        budget.steps = MOST_STEPS / 32 * 9;
        assert_eq!(budget.relaxation(), 16.0);
        budget.start();
        let most = (1_u64 << 30) / (33 * 33);
        budget.solutions = most - 1;
        budget.spend(String::new).unwrap();
        budget.solutions += 1;
        let text = budget.spend(|| "here".into()).unwrap_err().to_string();
        assert!(text.contains(&format!("{most} solutions of the contact (at most {most})")), "{text}");
        for (count, states, most) in
            [(1, 20, 1 << 20), (32, 200, 1 << 20), (5, 8192, 1 << 15), (256, 1000, 1 << 14), (1025, 0, 1 << 14)]
        {
            assert_eq!(WorkBudget::new(count, states).most, most);
        }
    }
}
