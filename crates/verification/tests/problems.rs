//! Every problem with a known answer is solved within its bound: the rows of `cargo fmu verify`, one test each.
//!
//! The tests are the table's own rows, so that none can be missing.

use libtest_mimic::{Arguments, Failed, Trial};
use std::collections::BTreeSet;
use std::process::ExitCode;
use verification::{Problem, problems};

thread_local! {
    /// Rows of a table share what is costly to set up; a problem stays on its thread.
    static PROBLEMS: Vec<Problem> = problems();
}

fn check(number: usize) -> Result<(), Failed> {
    PROBLEMS.with(|problems| {
        let problem = &problems[number];
        let row = problem.solve()?;
        if row.passes() {
            return Ok(());
        }
        Err(format!(
            "{}, {}: {} instead of {}, error {:.2e} above {:.2e} ({})",
            row.problem, row.quantity, row.computed, row.exact, row.error, row.bound, problem.reason
        )
        .into())
    })
}

fn main() -> ExitCode {
    let names: Vec<String> = problems().into_iter().map(|problem| problem.name).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "two problems share a name");
    let trials = names.into_iter().enumerate().map(|(number, name)| Trial::test(name, move || check(number)));
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}
