//! Driver of the component for the tests: variables by name, from the stock scene or one of the examples.

use scene::variables::{STARTS, ValueReference, find};
use sliding_contact::component::{Component, Values};
use std::sync::Arc;

pub const AUTO: f64 = 1.0;
pub const LUMPED: f64 = 2.0;

pub const HELD: f64 = 1.0;
pub const CONVECTING: f64 = 2.0;
pub const INSULATED: f64 = 3.0;
pub const EXTERNAL: f64 = 4.0;

pub fn reference(name: &str) -> ValueReference {
    find(name).unwrap_or_else(|| panic!("no variable {name}"))
}

/// A component addressed by names.
pub struct Drive(pub Component);

impl Drive {
    /// The stock scene with changes.
    pub fn stock(changes: &[(&str, f64)]) -> Drive {
        Drive::from_starts(&STARTS, changes)
    }

    pub fn from_starts(starts: &Values, changes: &[(&str, f64)]) -> Drive {
        Drive::attempt(starts, changes).unwrap()
    }

    /// At the lumped level, unless `starts` or the changes say otherwise: auto would choose by the tolerance.
    pub fn attempt(starts: &Values, changes: &[(&str, f64)]) -> Result<Drive, String> {
        let mut starts = *starts;
        let level = &mut starts[reference("solver.fidelity") as usize];
        if *level == AUTO {
            *level = LUMPED;
        }
        for (name, value) in changes {
            starts[reference(name) as usize] = *value;
        }
        let mut component = Component::new(Arc::new(starts));
        component.enter_initialization();
        component.initialise(None)?;
        Ok(Drive(component))
    }

    pub fn get(&mut self, name: &str) -> f64 {
        self.0.get(reference(name))
    }

    pub fn set(&mut self, name: &str, value: f64) -> &mut Drive {
        self.0.set_input(reference(name), value);
        self
    }

    pub fn slope(&mut self, name: &str, slope: f64) -> &mut Drive {
        self.0.set_input_derivative(reference(name), slope);
        self
    }

    pub fn step(&mut self, step: f64) -> &mut Drive {
        self.0.step(step).unwrap();
        self
    }

    /// Contact area of one punch and one face, m2.
    pub fn area(&mut self) -> f64 {
        self.get("punch.width") * self.get("depth")
    }

    /// Relative residual of the energy balance from outputs alone: heat in less heat stored and lost, over the heat transferred.
    pub fn imbalance(&mut self) -> f64 {
        let terms =
            ["dissipated_energy", "stored_heat", "heat_lost_ambient", "heat_lost_punch_top", "heat_lost_strip_base"]
                .map(|name| self.get(name));
        let moved = terms.iter().fold(0.0, |largest: f64, term| largest.max(term.abs()));
        if moved == 0.0 { 0.0 } else { (terms[0] - terms[1..].iter().sum::<f64>()).abs() / moved }
    }
}

/// Start values of an example scene by the name of its folder.
pub fn scene(name: &str) -> Values {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).join("scene.toml");
    scene_file::read(&path).unwrap().packaged.starts
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

/// Reproducible numbers in [0, 1): a linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}
