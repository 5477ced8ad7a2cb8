//! Effects that a level includes or neglects, each with the quantity on which this is based.
//!
//! Theory: docs/theory.md, section 8.2.

use super::Candidate;
use super::groups::Groups;
use super::model_level::ModelLevel;
use crate::levels::ModelOperators;
use scene::{HeatResolution, Scene};

/// Physical effect.
#[derive(Clone, PartialEq, Debug)]
pub struct Effect {
    /// Name of the effect.
    pub name: &'static str,
    /// Definition of the number.
    pub measure: &'static str,
    /// Value of the number.
    pub number: f64,
    /// Whether the chosen model level includes it.
    pub kept: bool,
    /// Relative error of the main outputs by neglecting it; 0 where it is included.
    ///
    /// The error of a uniform pressure is measured as a whole and divided among the effects that make the pressure nonuniform, in
    /// proportion to the nonuniformity by each.
    pub error: f64,
}

/// Evaluates the effects of a scene; `fine` is a contact line of it.
pub fn judge(
    scene: &Scene,
    groups: &Groups,
    fine: &ModelOperators,
    candidates: &[Candidate],
    chosen: ModelLevel,
) -> Vec<Effect> {
    let uneven = match fine {
        ModelOperators::Line(line) => line.unevenness(),
        ModelOperators::Lumped(_) => Default::default(),
    };
    let distortion = groups.distortion_over_approach;
    let line = chosen != ModelLevel::Lumped;
    let by_cells = chosen.heat() == Some(HeatResolution::Resolved);
    let find =
        |wanted: ModelLevel| candidates.iter().find(|candidate| candidate.model_level == wanted).map(Candidate::error);
    let cells = match fine {
        ModelOperators::Line(line) => line.count(),
        ModelOperators::Lumped(_) => 1,
    };
    let uniform = find(ModelLevel::Lumped).unwrap_or(0.0);
    let exact = find(ModelLevel::Line { cells, heat: HeatResolution::Resolved });
    let mean = find(ModelLevel::Line { cells, heat: HeatResolution::Lumped });
    let heat_error = match (mean, exact) {
        (Some(mean), Some(exact)) => (mean - exact).max(0.0),
        _ => 0.0,
    };
    let changes = [uneven.pressure, uneven.shear, uneven.rotation, distortion.min(1.0)];
    let total: f64 = changes.iter().sum();
    let share = |number: f64| if total > 0.0 && !line { uniform * number / total } else { 0.0 };
    let flash = match fine {
        ModelOperators::Line(line) => line.mean.flash.is_some(),
        ModelOperators::Lumped(_) => false,
    };
    let wears = scene.strip.wear_coefficient > 0.0;
    vec![
        effect("pressure along the contact", "rms deviation from its mean", uneven.pressure, line, share(changes[0])),
        effect("strip elasticity", "its part of the compliance", groups.strip_compliance, line, 0.0),
        effect(
            "shear coupling",
            "rms change of the pressure",
            uneven.shear,
            line && uneven.shear > 0.0,
            share(changes[1]),
        ),
        effect(
            "rotation",
            "rms change of the pressure",
            uneven.rotation,
            line && uneven.rotation > 0.0,
            share(changes[2]),
        ),
        effect(
            "thermal distortion",
            "distortion over elastic approach",
            distortion,
            by_cells && distortion > 0.0,
            if line && !by_cells { heat_error } else { share(changes[3]) },
        ),
        effect(
            "heat along the contact",
            "change of the main outputs",
            heat_error,
            by_cells,
            if by_cells { 0.0 } else { heat_error },
        ),
        effect("strip wear", "its part of the worn depth", groups.strip_wear, wears, 0.0),
        effect("moving source", "Peclet number", groups.peclet, flash || by_cells, 0.0),
    ]
}

fn effect(name: &'static str, measure: &'static str, number: f64, kept: bool, error: f64) -> Effect {
    Effect { name, measure, number, kept, error: if kept { 0.0 } else { error } }
}
