//! Utilities shared by the tests of several crates; never linked into the FMU.
//!
//! Unit tests may use its random numbers only: it links the released form of every layer, whose types are others than those of a
//! layer that is compiled for its own unit tests.

mod application;
pub mod counting;
pub mod derivatives;
mod drive;
pub mod importer;
mod random;

pub use application::{Application, Run};
pub use drive::Drive;
pub use random::Random;

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

/// `starts` with changes by name.
///
/// # Panics
/// Where there is no variable of a name.
pub fn changed(starts: &Values, changes: &[(&str, f64)]) -> Values {
    scene::variables::changed(starts, changes).unwrap()
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
