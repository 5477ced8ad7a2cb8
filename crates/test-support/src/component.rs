//! The component driven by names, changed scenes, the FMU as an importer sees it.

mod application;
pub mod derivatives;
mod drive;
pub mod importer;

pub use application::{Application, Run};
pub use drive::Drive;

use scene::Scene;
use scene::variables::{COUNT, Causality, Kind, ValueReference, find, lookup};
use sliding_contact::component::{Component, Values};
use std::path::PathBuf;
use std::sync::Arc;

/// `solver.fidelity`: the level is chosen by the tolerance.
pub(crate) const AUTO: f64 = 1.0;
/// `solver.fidelity`: uniform pressure.
pub const LUMPED: f64 = 2.0;
/// `solver.fidelity`: pressure along the contact.
pub const LINE: f64 = 3.0;

/// Face of a body: held at a temperature.
pub const HELD: f64 = 1.0;
/// Face of a body: cooled by the air.
pub const CONVECTING: f64 = 2.0;
/// Face of a body: no heat passes.
pub const INSULATED: f64 = 3.0;
/// Face of a body: at a temperature that is an input.
pub const EXTERNAL: f64 = 4.0;

/// Value reference of a variable.
///
/// # Panics
/// Where there is no variable of that name.
pub fn reference(name: &str) -> ValueReference {
    find(name).unwrap_or_else(|| panic!("no variable {name}"))
}

/// `starts` with changes by name. `*` in a name stands for anything: both bodies, or all elements of an array.
///
/// # Panics
/// Where there is no variable of a name.
pub fn changed(starts: &Values, changes: &[(&str, f64)]) -> Values {
    let mut values = *starts;
    for (name, value) in changes {
        references(name).into_iter().for_each(|reference| values[reference as usize] = *value);
    }
    values
}

/// References of the variables of a name, in which `*` stands for anything.
fn references(name: &str) -> Vec<ValueReference> {
    let Some((head, tail)) = name.split_once('*') else { return vec![reference(name)] };
    let is_meant = |reference: &ValueReference| {
        let (row, element) = lookup(*reference).unwrap();
        row.element_name(element).strip_prefix(head).is_some_and(|rest| rest.ends_with(tail))
    };
    let found: Vec<_> = (0..COUNT as ValueReference).filter(is_meant).collect();
    assert!(found.len() > 1, "no variables {name}");
    found
}

/// A change whose name is made, as one whose name stands in the source.
pub fn named(name: String, value: f64) -> (&'static str, f64) {
    (name.leak(), value)
}

/// The property table of `body` with points of temperature (K), conductivity (W/(m K)) and specific heat (J/(kg K)).
pub fn property_table(body: &str, points: &[(f64, f64, f64)]) -> Vec<(&'static str, f64)> {
    let mut changes = vec![named(format!("{body}.property_table.points"), points.len() as f64)];
    for (i, point) in points.iter().enumerate() {
        for (row, value) in [("temperature", point.0), ("conductivity", point.1), ("specific_heat", point.2)] {
            changes.push(named(format!("{body}.property_table.{row}[{}]", i + 1), value));
        }
    }
    changes
}

/// An initial gap (m) at the stations, given over -1/2 to 1/2 of the width.
pub fn initial_gap(gap: impl Fn(f64) -> f64) -> impl Iterator<Item = (&'static str, f64)> {
    (0..33).map(move |station| {
        named(format!("contact.initial_gap[{}]", station + 1), gap(f64::from(station) / 32.0 - 0.5))
    })
}

/// The scene of `starts` with changes by name.
///
/// # Panics
/// Where there is no variable of a name, or the scene is refused.
pub fn changed_scene(starts: &Values, changes: &[(&str, f64)]) -> Scene {
    Scene::new(&changed(starts, changes), None).unwrap_or_else(|error| panic!("{error}"))
}

/// The component of an example scene with changes, before initialisation.
///
/// # Panics
/// Where there is no such scene or variable.
pub fn component(name: &str, changes: &[(&str, f64)]) -> Component {
    Component::new(Arc::new(changed(&scene(name), changes)))
}

/// References of the real variables that are calculated.
pub fn real_outputs() -> Vec<ValueReference> {
    let calculated = |reference: &u32| {
        let (row, _) = lookup(*reference).unwrap();
        matches!(row.causality, Causality::Output | Causality::Local) && matches!(row.kind, Kind::Real { .. })
    };
    (0..COUNT as u32).filter(calculated).collect()
}

/// The folder of the example scenes and their data.
pub fn examples() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples"))
}

/// Start values of an example scene by the name of its folder.
///
/// # Panics
/// Where there is no such scene, or it does not read.
pub fn scene(name: &str) -> Values {
    scene_file::read(&examples().join(name).join("scene.toml")).unwrap().packaged.starts
}

/// Every example scene with the load and the velocity it is made for.
pub fn scenes() -> [(&'static str, f64, f64); 4] {
    [
        ("disc_brake", 2.6e3, 3.8),
        ("pin_on_disk", 10.0, 0.1),
        ("reciprocating_punch", 1e4, 9.549e-3),
        ("clutch", 5e3, 29.7),
    ]
}
