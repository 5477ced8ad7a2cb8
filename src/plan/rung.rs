//! The rungs of the ladder: levels with their cells, and what a step on them costs.

use crate::coupled::model::Operators;
use crate::scene::{Fidelity, HeatAlongContact, Scene};
use std::fmt;

/// Cells of the rungs of the line level.
pub const CELLS: [usize; 6] = [9, 17, 33, 65, 129, 257];

/// A level with its discretisation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Rung {
    /// Uniform pressure.
    Lumped,
    /// A contact line.
    Line {
        /// N.
        cells: usize,
        /// Whether its heat is on the cells.
        heat: HeatAlongContact,
    },
}

impl Rung {
    /// `scene` on this rung.
    pub fn apply(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self {
            Rung::Lumped => scene.fidelity = Fidelity::Lumped,
            Rung::Line { cells, heat } => {
                scene.fidelity = Fidelity::Line;
                (scene.cells, scene.heat_along_contact) = (cells, heat);
            }
        }
        scene
    }

    /// Name of the level.
    pub fn level(self) -> &'static str {
        match self {
            Rung::Lumped => "lumped",
            Rung::Line { .. } => "line",
        }
    }

    /// Whether heat is on the cells of a contact line.
    pub fn on_the_cells(self) -> bool {
        matches!(self, Rung::Line { heat: HeatAlongContact::OnTheCells, .. })
    }

    /// Cells of the contact.
    pub fn cells(self) -> usize {
        match self {
            Rung::Lumped => 1,
            Rung::Line { cells, .. } => cells,
        }
    }
}

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rung::Lumped => f.write_str("lumped"),
            Rung::Line { cells, heat: HeatAlongContact::ByItsMean } => write!(f, "line, {cells} cells, mean heat"),
            Rung::Line { cells, .. } => write!(f, "line, {cells} cells"),
        }
    }
}

/// What one internal step costs, in microseconds of a core of 3 GHz: counted operations with constants calibrated once, so
/// that the same scene has the same cost everywhere.
///
/// Lumped: a constant. The line adds its pressure, c N^2 while factors are kept, and with heat on the cells c (1 + N^2/n^2)
/// per thermal state, for the weights of the step and the gains of the cells, and c N^2 for the split of the heat.
pub fn cost_per_step(operators: &Operators) -> f64 {
    match operators {
        Operators::Lumped(_) => cost(1, None),
        Operators::Line(line) => {
            cost(line.count(), line.heat.as_ref().map(|bodies| bodies.states[0] + bodies.states[1]))
        }
    }
}

const LUMPED_STEP: f64 = 1.4;
const LINE_STEP: f64 = 0.7;
const LINE_CELL_PAIR: f64 = 0.009;
const HEAT_STEP: f64 = 4.0;
const HEAT_CELL_PAIR: f64 = 0.07;
const HEAT_STATE: f64 = 0.1;
const HEAT_STATE_CELLS: f64 = 600.0;

/// The same from the counts: `cells`, and thermal states where heat is on them.
pub fn cost(cells: usize, states: Option<usize>) -> f64 {
    if cells <= 1 {
        return LUMPED_STEP;
    }
    let pairs = (cells * cells) as f64;
    let heat = states.map_or(0.0, |states| {
        HEAT_STEP + HEAT_CELL_PAIR * pairs + HEAT_STATE * states as f64 * (1.0 + pairs / HEAT_STATE_CELLS)
    });
    LUMPED_STEP + LINE_STEP + LINE_CELL_PAIR * pairs + heat
}
