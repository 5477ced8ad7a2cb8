//! Counted cost of the levels, in microseconds of a core of 3 GHz: a function of cells and thermal states alone, so that no plan depends
//! on a clock.
//!
//! The constants are those of a fit to 900 runs of users' scenes, with the inputs of each (`docs/decisions.md`): four of five
//! runs with resolved heat take from 0.66 to 1.5 times the counted time.
//!
//! Theory: docs/theory.md, section 8.2.

use crate::levels::ModelOperators;

/// Internal step of the lumped level.
const LUMPED_STEP: f64 = 1.6;

/// Step of a contact line with lumped heat, by the square of its cells.
const LINE_STEP: f64 = 1.6;
const LINE_CELL_PAIR: f64 = 0.0017;

/// Step of a contact line with resolved heat: by its cells, by their cube (factors of the stage matrix), and by the thermal states.
const HEAT_STEP: f64 = 4.2;
const HEAT_CELL: f64 = 0.81;
const HEAT_CELL_TRIPLE: f64 = 3.3e-4;
const HEAT_STATE: f64 = 0.011;

/// Building the lumped level; a contact line with lumped heat, by its cells; one with resolved heat, by its cells, their square and the
/// thermal states.
const BUILD_LUMPED: f64 = 1000.0;
const BUILD_LINE: [f64; 2] = [2700.0, 100.0];
const BUILD_HEAT: [f64; 3] = [6800.0, 210.0, 1.9];
const BUILD_STATE: f64 = 2.8;

/// Thermal states of both bodies with resolved heat.
pub fn states(operators: &ModelOperators) -> Option<usize> {
    match operators {
        ModelOperators::Lumped(_) => None,
        ModelOperators::Line(line) => line.heat.as_ref().map(|bodies| bodies.states[0] + bodies.states[1]),
    }
}

/// Cost of one internal step.
pub fn per_step(operators: &ModelOperators) -> f64 {
    per_step_of(operators.cells(), states(operators))
}

/// Cost of one internal step by the counts: `cells`, and thermal `states` with resolved heat.
pub fn per_step_of(cells: usize, states: Option<usize>) -> f64 {
    let count = cells as f64;
    match states {
        _ if cells <= 1 => LUMPED_STEP,
        None => LINE_STEP + LINE_CELL_PAIR * count * count,
        Some(states) => HEAT_STEP + count * (HEAT_CELL + HEAT_CELL_TRIPLE * count * count) + HEAT_STATE * states as f64,
    }
}

/// Cost of building the operators of a level.
pub fn build_cost(operators: &ModelOperators) -> f64 {
    build_cost_of(operators.cells(), states(operators))
}

/// Cost of building the operators of a level by the counts: `cells`, and thermal `states` with resolved heat.
pub fn build_cost_of(cells: usize, states: Option<usize>) -> f64 {
    let count = cells as f64;
    match states {
        _ if cells <= 1 => BUILD_LUMPED,
        None => BUILD_LINE[0] + BUILD_LINE[1] * count,
        Some(states) => BUILD_HEAT[0] + count * (BUILD_HEAT[1] + BUILD_HEAT[2] * count) + BUILD_STATE * states as f64,
    }
}
