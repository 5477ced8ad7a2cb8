//! Model hierarchy: the levels at which a scene can run, with their cells.
//!
//! Theory: docs/theory.md, section 8.1.

use scene::{Fidelity, HeatResolution, Scene};
use std::fmt;

/// Numbers of cells of the lines that are compared.
pub const CELLS: [usize; 6] = [9, 17, 33, 65, 129, 257];

/// Model level with its discretisation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModelLevel {
    /// Uniform pressure.
    Lumped,
    /// Contact line: pressure on cells.
    Line {
        /// Number of cells N.
        cells: usize,
        /// Lumped or resolved heat.
        heat: HeatResolution,
    },
}

impl ModelLevel {
    /// `scene` at this level.
    pub fn apply(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self {
            ModelLevel::Lumped => scene.fidelity = Fidelity::Lumped,
            ModelLevel::Line { cells, heat } => {
                scene.fidelity = Fidelity::Line;
                (scene.cells, scene.heat_resolution) = (cells, heat);
            }
        }
        scene
    }

    /// Name of the level.
    pub fn level(self) -> &'static str {
        match self {
            ModelLevel::Lumped => "lumped",
            ModelLevel::Line { .. } => "line",
        }
    }

    /// Lumped or resolved heat of a contact line.
    pub fn heat(self) -> Option<HeatResolution> {
        match self {
            ModelLevel::Lumped => None,
            ModelLevel::Line { heat, .. } => Some(heat),
        }
    }

    /// Cells of the contact.
    pub fn cells(self) -> usize {
        match self {
            ModelLevel::Lumped => 1,
            ModelLevel::Line { cells, .. } => cells,
        }
    }
}

impl fmt::Display for ModelLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ModelLevel::Lumped => f.write_str("lumped"),
            ModelLevel::Line { cells, heat: HeatResolution::Lumped } => {
                write!(f, "line, {cells} cells, mean heat")
            }
            ModelLevel::Line { cells, .. } => write!(f, "line, {cells} cells"),
        }
    }
}
