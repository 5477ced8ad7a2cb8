//! Effects that a level includes or leaves out, each with the quantity on which its size depends.

use super::groups::Groups;
use model::line::operators::LineOperators;
use scene::Scene;

/// Physical effect.
#[derive(Clone, PartialEq, Debug)]
pub struct Effect {
    /// Name of the effect.
    pub name: &'static str,
    /// Definition of the number.
    pub measure: &'static str,
    /// Value of the number.
    pub number: f64,
    /// Whether the level includes it.
    pub included: bool,
}

/// Effects of a scene; `line` is a contact line of it, `on_line` whether it runs on one.
pub fn effects(scene: &Scene, groups: &Groups, line: &LineOperators, on_line: bool) -> Vec<Effect> {
    let uneven = line.unevenness();
    let by_cells = on_line && line.heat.is_some();
    let effect = |name, measure, number, included| Effect { name, measure, number, included };
    let pressure = "rms change of the pressure over its mean";
    vec![
        effect("pressure along the contact", "rms deviation from its mean", uneven.pressure, on_line),
        effect("shear coupling", pressure, uneven.shear, on_line && uneven.shear > 0.0),
        effect("rotation", pressure, uneven.rotation, on_line && uneven.rotation > 0.0),
        effect(
            "thermal distortion",
            "distortion over elastic approach",
            groups.distortion_over_approach,
            by_cells && groups.distortion_over_approach > 0.0,
        ),
        effect("heat along the contact", "Peclet number", groups.peclet, by_cells),
        effect(
            "elastic slip",
            "part of a nominal stroke",
            if scene.nominal_stroke > 0.0 { line.mean.deformation_at_reversal() / scene.nominal_stroke } else { 0.0 },
            scene.elastic_slip && scene.nominal_stroke > 0.0,
        ),
        effect("strip wear", "its part of the worn depth", groups.strip_wear, scene.strip.wear_coefficient > 0.0),
    ]
}
