//! Counted cost of the levels: with constants calibrated once, in microseconds of a core of 3 GHz, so that no plan depends on a
//! clock.
//!
//! Theory: docs/theory.md, section 8.2.

use crate::levels::ModelOperators;
use scene::Geometry;

const LUMPED_STEP: f64 = 1.4;
const LINE_STEP: f64 = 0.7;
const LINE_CELL_PAIR: f64 = 0.009;
const HEAT_STEP: f64 = 4.0;
const HEAT_CELL_PAIR: f64 = 0.07;
const HEAT_STATE: f64 = 0.1;
const HEAT_STATE_CELLS: f64 = 600.0;

/// Costs of building a lumped level, a contact line, its resolved heat, and rings in addition; of a thermal state of punch and
/// strip.
const BUILD: [f64; 4] = [300.0, 1500.0, 500.0, 1200.0];
const BUILD_STATE: [f64; 2] = [5.0, 1.7];

/// Thermal states of both bodies with resolved heat.
pub fn states(operators: &ModelOperators) -> Option<usize> {
    match operators {
        ModelOperators::Lumped(_) => None,
        ModelOperators::Line(line) => line.heat.as_ref().map(|bodies| bodies.states[0] + bodies.states[1]),
    }
}

/// Cost of one internal step.
///
/// Lumped: a constant. The line adds its pressure, c N^2 with cached factors, and with resolved heat c (1 + N^2/n^2) per thermal
/// state, for the weights of the step and the influence matrices, and c N^2 for the heat partition.
pub fn per_step(operators: &ModelOperators) -> f64 {
    match operators {
        ModelOperators::Lumped(_) => per_step_of(1, None),
        ModelOperators::Line(line) => per_step_of(line.count(), states(operators)),
    }
}

/// Cost of one internal step by the counts: `cells`, and thermal states with resolved heat.
pub fn per_step_of(cells: usize, states: Option<usize>) -> f64 {
    if cells <= 1 {
        return LUMPED_STEP;
    }
    let pairs = (cells * cells) as f64;
    let heat = states.map_or(0.0, |states| {
        HEAT_STEP + HEAT_CELL_PAIR * pairs + HEAT_STATE * states as f64 * (1.0 + pairs / HEAT_STATE_CELLS)
    });
    LUMPED_STEP + LINE_STEP + LINE_CELL_PAIR * pairs + heat
}

/// Cost of building the operators of a level.
pub fn build_cost(operators: &ModelOperators) -> f64 {
    let ModelOperators::Line(line) = operators else { return BUILD[0] };
    let heat = line.heat.as_ref().map_or(0.0, |bodies| {
        let ring = if line.scene.geometry == Geometry::Annular { BUILD[3] } else { 0.0 };
        let states = bodies.states.iter().zip(BUILD_STATE).map(|(&count, cost)| count as f64 * cost).sum::<f64>();
        BUILD[2] + ring + states
    });
    BUILD[1] + heat
}
