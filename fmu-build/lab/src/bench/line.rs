//! `cargo fmu bench --line`: cost of a wear step of the contact line, in solutions of one dense system.
//!
//! The unit is one solution with the cached LU factors of an N x N matrix by faer, timed in turns with the steps. A step of
//! the second-order scheme solves two contact problems of N cells.

use super::level::cost;
use super::{Cost, TURNS};
use anyhow::{Result, anyhow};
use verification::timed_steps::{CASES, CHUNK, DenseSolution, STEPS, TimedLine};

/// Measures steps of contacts of 33 and 129 cells.
pub(crate) fn measure() -> Result<Vec<Cost>> {
    let mut costs = Vec::new();
    for count in [33, 129] {
        let mut solution = DenseSolution::new(count);
        for case in &CASES {
            let mut line = TimedLine::new(count, case).map_err(|text| anyhow!(text))?;
            line.turn(case).map_err(|text| anyhow!(text))?;
            let (mut fastest, mut unit) = ([f64::INFINITY; STEPS / CHUNK], f64::INFINITY);
            for _ in 0..TURNS {
                unit = unit.min(solution.seconds(STEPS));
                for (fastest, seconds) in fastest.iter_mut().zip(line.turn(case).map_err(|text| anyhow!(text))?) {
                    *fastest = fastest.min(seconds);
                }
            }
            let best = fastest.iter().sum::<f64>() / STEPS as f64;
            let counter = line.work();
            eprintln!(
                "N = {count:3}, {:24} {:8.2} µs a step, {:6.2} solutions of {:.3} µs; {counter}",
                case.name,
                1e6 * best,
                best / unit,
                1e6 * unit
            );
            let limit = case.limit.unwrap_or(25.0);
            costs.push(cost(format!("N = {count}, {}", case.name), best / unit, "1", limit, case.limit.is_some()));
        }
    }
    Ok(costs)
}
