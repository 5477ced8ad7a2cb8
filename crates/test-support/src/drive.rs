//! Driver of the component for the tests: variables by name, from the stock scene or one of the examples.

use crate::{AUTO, LUMPED, changed, reference};
use scene::variables::STARTS;
use sliding_contact::component::{Component, Values};
use std::sync::Arc;

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
        let starts = changed(&starts, changes);
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
        let passed = ["heat_received_punch", "heat_received_strip"].map(|name| self.get(name));
        let moved = terms.iter().chain(&passed).fold(0.0, |largest: f64, term| largest.max(term.abs()));
        if moved == 0.0 { 0.0 } else { (terms[0] - terms[1..].iter().sum::<f64>()).abs() / moved }
    }
}
