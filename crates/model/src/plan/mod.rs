//! Choice of the level by `solver.fidelity = auto`, and the error of a run.
//!
//! 1. Two rigid bodies: `lumped`, exact.
//! 2. Otherwise `lumped` where one comparison over the nominal course ([`nominal`]) shows that it is enough: with d the distance of
//!    two runs ([`distance`]), `e = d(lumped, 17 cells) + d(9 cells, 17 cells)` is at most the tolerance ([`comparison`]).
//! 3. Otherwise, and where nothing can be compared, the contact line with its cells by the tolerance
//!    ([`crate::line::operators`]).
//!
//! The error of a run is measured on the run itself ([`crate::run_error`]).
//!
//! The choice depends on counts and computed numbers alone, never on timings: the same scene has the same level on every machine.
//!
//! Theory: docs/theory.md, section 8.2.

pub(crate) mod comparison;
pub mod distance;
pub(crate) mod nominal;

use crate::levels::ModelOperators;
use crate::line::heat::bodies::can_be_resolved;
use crate::line::operators::{RunIn, Shared};
use crate::tolerance::set_companion;
use comparison::{Comparison, compare};
use scene::message::Number;
use scene::{ErrorEstimate, Fidelity, HeatResolution, Scene};
use std::fmt;

/// Stated error where it is not known.
pub(crate) const UNKNOWN: f64 = 1.0;

/// Cells of the companion of a lumped run.
const CELLS_BESIDE_LUMPED: usize = 9;

/// Fewest cells of a companion.
const FEWEST_COMPANION_CELLS: usize = 5;

/// A level with its discretisation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModelLevel {
    /// Uniform pressure.
    Lumped,
    /// Contact line with `solver.cells`; 0: by the tolerance.
    Line(usize),
}

impl ModelLevel {
    /// `scene` at this level.
    pub fn apply(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self {
            ModelLevel::Lumped => scene.fidelity = Fidelity::Lumped,
            ModelLevel::Line(cells) => (scene.fidelity, scene.cells) = (Fidelity::Line, cells),
        }
        scene
    }
}

/// Choice of a level, and its basis.
#[derive(Clone, PartialEq, Debug)]
pub struct Choice {
    /// The level.
    pub level: ModelLevel,
    /// Reason, with the numbers.
    pub reason: String,
    /// The comparison, where there was one.
    pub comparison: Option<Comparison>,
}

impl Choice {
    /// Chooses the level of `scene`; also returns the operators that were built.
    pub fn new(scene: &Scene, shared: &mut Shared, run_in: RunIn) -> (Choice, Vec<ModelOperators>) {
        if scene.has_rigid_bodies() {
            let reason = "both bodies are rigid, so the pressure is uniform".into();
            return (Choice { level: ModelLevel::Lumped, reason, comparison: None }, Vec::new());
        }
        let line = ModelLevel::Line(scene.cells);
        let mut known = Vec::new();
        let choice = match compare(scene, &mut known, shared, run_in) {
            Ok(comparison) => {
                let error = comparison.error;
                let (level, by, relation) = match error <= scene.tolerance {
                    true => (ModelLevel::Lumped, "by", "not above"),
                    false => (line, "by at least", "above"),
                };
                let reason = format!(
                    "over the nominal course lumped differs {by} {error:.1e} from the line, {relation} the tolerance"
                );
                Choice { level, reason, comparison: Some(comparison) }
            }
            Err(reason) => {
                let reason = format!("nothing to compare lumped with: {reason}");
                Choice { level: line, reason, comparison: None }
            }
        };
        (choice, known)
    }
}

/// Scene at its level, built at the end of initialisation.
#[derive(Clone, Debug)]
pub struct BuiltModel {
    /// Scene as given by the parameters.
    pub requested: Scene,
    /// The choice of the level; `None` where it is named.
    pub choice: Option<Choice>,
    /// Operators of the level.
    pub operators: ModelOperators,
    /// Operators of the coarser contact line that is advanced beside the run.
    pub companion: Option<ModelOperators>,
}

impl BuiltModel {
    /// Builds the level of `scene` and its companion.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<BuiltModel, String> {
        let requested = scene.clone();
        let mut shared = Shared::default();
        let (choice, known) = match scene.fidelity {
            Fidelity::Auto => {
                let (choice, known) = Choice::new(scene, &mut shared, run_in);
                (Some(choice), known)
            }
            _ => (None, Vec::new()),
        };
        let mut build = |wanted: Scene, beside: Option<&ModelOperators>| {
            let same = known.iter().find(|operators| *operators.scene() == wanted);
            let made = || ModelOperators::sharing(&wanted, beside, &mut shared, run_in);
            same.cloned().map_or_else(made, Ok)
        };
        let wanted = choice.as_ref().map_or_else(|| scene.clone(), |choice| choice.level.apply(scene));
        // A companion is not: whoever needs steps of even cost has none, and a run meets a few of the velocities.
        let operators = build(wanted, known.first())?.ready();
        let companion = companion_of(&operators, choice.is_some());
        let companion = companion.map(|wanted| build(wanted, Some(&operators))).transpose()?;
        Ok(BuiltModel { requested, choice, operators, companion })
    }

    /// Whether the level is exact but for reduction and time steps.
    pub(crate) fn is_exact(&self) -> bool {
        self.requested.has_rigid_bodies()
    }

    /// Description for the log, line by line.
    pub fn lines(&self) -> Vec<String> {
        let level = self.operators.description();
        let beside = match &self.companion {
            Some(companion) => format!("; a companion on {} cells measures estimated_error", companion.cells()),
            None => String::new(),
        };
        let mut lines = match &self.choice {
            Some(choice) => vec![format!("auto takes {level}{beside}: {}", choice.reason)],
            None => vec![format!("level {level}{beside}")],
        };
        if let Some((share, lost)) = self.operators.neglected_slip() {
            lines.push(format!(
                "elastic slip is neglected: at each end of a nominal stroke the bodies deform by {} m, {} % of the stroke, before \
                 they slide; contact.tangential_compliance = elastic includes it",
                Number(lost),
                Number(100.0 * share)
            ));
        }
        lines
    }
}

/// Scene of the companion of a run at the level of `operators`, if it has one; `chosen`: automatically. Its heat is resolved
/// wherever it can be, so that the error of mean heat is measured too.
fn companion_of(operators: &ModelOperators, chosen: bool) -> Option<Scene> {
    let scene = operators.scene();
    let wanted = match scene.error_estimate {
        ErrorEstimate::Companion => true,
        ErrorEstimate::Automatic => chosen && matches!(operators, ModelOperators::Line(_)),
        ErrorEstimate::Off => false,
    };
    if !wanted || scene.has_rigid_bodies() {
        return None;
    }
    let cells = match operators {
        ModelOperators::Lumped(_) => CELLS_BESIDE_LUMPED,
        ModelOperators::Line(line) => Some(line.count().div_ceil(2)).filter(|half| *half >= FEWEST_COMPANION_CELLS)?,
    };
    let mut companion = ModelLevel::Line(cells).apply(scene);
    set_companion(&mut companion);
    if can_be_resolved(scene) {
        companion.heat_resolution = HeatResolution::Resolved;
    }
    Some(companion)
}

impl fmt::Display for ModelLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ModelLevel::Lumped => f.write_str("lumped"),
            ModelLevel::Line(0) => f.write_str("line"),
            ModelLevel::Line(cells) => write!(f, "line, {cells} cells"),
        }
    }
}
