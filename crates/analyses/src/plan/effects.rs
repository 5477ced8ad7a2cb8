//! Effects that a level includes or leaves out, each with the quantity on which its size depends.

use super::groups::Groups;
use model::line::operators::LineOperators;
use scene::{Body, Scene};
use scene_file::property_tables;

#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Effect {
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
/// `rise`: highest of the contact temperature over the nominal course, K.
pub(crate) fn effects(scene: &Scene, groups: &Groups, line: &LineOperators, on_line: bool, rise: f64) -> Vec<Effect> {
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
        effect(
            "properties over temperature",
            "part of the rise that constants add",
            excess_of_constants(scene, rise),
            [&scene.punch, &scene.strip].iter().any(|body| body.properties.is_some()),
        ),
    ]
}

/// Largest part of the rise `rise` (K) by which a body with constant specific heat gets too hot from the same heat: the mean specific heat over
/// the rise, over the constant one, less 1. By the table of the body or, where it has constants, of the preset with these; 0 where
/// there is none.
fn excess_of_constants(scene: &Scene, rise: f64) -> f64 {
    let excess = |body: &Body| {
        let of_preset =
            || property_tables::of_constants([body.conductivity, body.specific_heat]).map(|own| own.table());
        let Some(table) = body.properties.or_else(of_preset).filter(|_| rise > 0.0) else { return 0.0 };
        let first = if body.initial_temperature > 0.0 { body.initial_temperature } else { scene.ambient_temperature };
        table.heat_of_rise(first, rise) / (rise * table.specific_heat_at(first)) - 1.0
    };
    excess(&scene.punch).max(excess(&scene.strip))
}
