//! The table of problems itself: bounds, and that a wrong value does not pass.

use verification::problems;

#[test]
fn every_bound_has_a_reason() {
    let all = problems();
    assert!(all.len() >= 45, "{}", all.len());
    for problem in &all {
        assert!(problem.bound > 0.0 && problem.bound <= 0.1 && !problem.reason.is_empty(), "{}", problem.name);
    }
}

#[test]
fn a_wrong_or_undefined_value_does_not_pass() {
    let mut problem = problems().swap_remove(0);
    assert!(problem.solve().unwrap().passes());
    let right = problem.solve().unwrap().computed;
    problem.compute = Box::new(move || Ok(right * 1.01));
    assert!(!problem.solve().unwrap().passes());
    problem.compute = Box::new(|| Ok(f64::NAN));
    assert!(!problem.solve().unwrap().passes());
    problem.compute = Box::new(|| Err("no".into()));
    assert!(problem.solve().unwrap_err().contains("half-space"));
}
