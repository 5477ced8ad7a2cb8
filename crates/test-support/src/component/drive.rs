//! Driver of the component for the tests: variables by name, from the stock scene or one of the examples.

use crate::{AUTO, LUMPED, changed, reference};
use scene::variables::STARTS;
use sliding_contact::component::{Component, Snapshot, Values};
use std::sync::Arc;

/// A component addressed by names.
pub struct Drive(pub Component);

impl Drive {
    /// The stock scene with changes.
    pub fn stock(changes: &[(&str, f64)]) -> Drive {
        Drive::from_starts(&STARTS, changes)
    }

    /// At the lumped level, unless `starts` (SI units) or the changes say otherwise; panics where the scene is refused.
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

    /// Runs `on` from here, again from the saved state, and in the component `fresh` that gets it as bytes: all give the same. Ends in
    /// the saved state.
    #[track_caller]
    pub fn assert_replay<T: PartialEq>(&mut self, mut fresh: Drive, mut on: impl FnMut(&mut Drive) -> T) -> T {
        let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
        self.0.snapshot(&mut saved);
        saved.encode(&mut bytes);
        assert!(bytes.len() == saved.encoded_size() && bytes.len() <= 256 << 10, "{} bytes", bytes.len());
        let first = on(self);
        self.0.restore(&saved).unwrap();
        assert!(first == on(self), "another result in the same component");
        fresh.0.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
        assert!(first == on(&mut fresh), "another result in a fresh component");
        self.0.restore(&saved).unwrap();
        first
    }

    /// Value of a variable, in SI units.
    pub fn get(&mut self, name: &str) -> f64 {
        self.0.get(reference(name))
    }

    /// Sets an input, in SI units.
    pub fn set(&mut self, name: &str, value: f64) -> &mut Drive {
        self.0.set_input(reference(name), value);
        self
    }

    /// Sets the time derivative of an input, per s.
    pub fn slope(&mut self, name: &str, slope: f64) -> &mut Drive {
        self.0.set_input_derivative(reference(name), slope);
        self
    }

    /// One communication step, s.
    pub fn step(&mut self, step: f64) -> &mut Drive {
        self.0.step(step).unwrap();
        self
    }

    /// As many equal steps at constant inputs.
    pub fn steps(&mut self, count: u32, step: f64) -> &mut Drive {
        (0..count).for_each(|_| _ = self.step(step));
        self
    }

    /// A profile at its 33 stations.
    pub fn profile(&mut self, name: &str) -> Vec<f64> {
        (1..=33).map(|station| self.get(&format!("profile.{name}[{station}]"))).collect()
    }

    /// Sliding to and fro at up to `speed` (m/s), in some steps linear with up to `slope` (m/s2), under a varying load; the bits of all
    /// outputs.
    pub fn strokes(&mut self, steps: std::ops::Range<u32>, speed: f64, slope: f64) -> Vec<u64> {
        let mut bits = Vec::new();
        for step in steps {
            let phase = f64::from(step) * 0.61;
            self.set("sliding_velocity", speed * phase.sin()).set("normal_load", 9e3 * (1.1 + (0.37 * phase).cos()));
            if step % 4 == 1 {
                self.slope("sliding_velocity", -slope * phase.sin());
            }
            self.step(0.05 + 0.02 * f64::from(step % 3));
            bits.extend((7..250).map(|output| self.0.get(output).to_bits()));
        }
        bits
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
