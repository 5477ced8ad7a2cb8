//! Linear response of the contact to a disturbance, at the present active set.
//!
//! Theory: docs/theory.md, section 9.5.

use super::{Conditions, StageError, WearingContact};
use crate::{ContactProblem, ContactState, Normal, Tilt};

/// Rates of the inputs of the contact problem at constant wear.
#[derive(Clone, Copy, Debug)]
pub struct Disturbance<'a> {
    /// Rate of the gap of the undeformed bodies, N values, m/s.
    pub gap: &'a [f64],
    /// Rate of the load (also of a spring's), N/(m s), or of the approach where that is given, m/s.
    pub normal: f64,
    /// Rate of the lever, m/s, or of the tilt where that is given, rad/s.
    pub tilt: f64,
    /// Rate of the moment, N/s; unused where the tilt is prescribed.
    pub moment: f64,
    /// Rate of the signed friction coefficient, 1/s.
    pub signed_friction: f64,
}

/// Rates of the contact state.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRate {
    /// Rates of the pressure, N values, Pa/s; 0 out of contact.
    pub pressure: Vec<f64>,
    /// Rate of the approach, m/s.
    pub approach: f64,
    /// Rate of the tilt, rad/s.
    pub tilt: f64,
}

impl ContactRate {
    /// Zero rates of `count` cells.
    pub fn new(count: usize) -> Self {
        Self { pressure: vec![0.0; count], approach: 0.0, tilt: 0.0 }
    }
}

impl WearingContact {
    /// Rate of the contact state under a disturbance with an unchanged contact set: the exact derivative of a stage of
    /// length 0 (`C + s mu S + E` without wear) at `state`, by one solution of its equations.
    ///
    /// `conditions` are those under which the state was found. Out of contact only a prescribed approach or tilt, or the
    /// relaxed spring, has a rate. No allocation.
    pub fn response_into(
        &mut self,
        conditions: &Conditions,
        state: &ContactState,
        disturbance: &Disturbance<'_>,
        rate: &mut ContactRate,
    ) -> Result<(), StageError> {
        let count = self.cells().count();
        assert_eq!(disturbance.gap.len(), count, "one gap rate per cell");
        assert_eq!(rate.pressure.len(), count, "one pressure rate per cell");
        for i in 0..count {
            self.gap[i] = disturbance.gap[i];
            self.set[i] = state.pressure[i] > 0.0;
        }
        if disturbance.signed_friction != 0.0 {
            for (kept, pressure) in self.wear.iter_mut().zip(&state.pressure) {
                *kept = disturbance.signed_friction * pressure;
            }
            self.solver.add_shear_displacement(&self.wear, &mut self.gap);
        }
        let normal = match conditions.normal {
            Normal::Load(_) => Normal::Spring { load: disturbance.normal, stiffness: 0.0 },
            Normal::Approach(_) => Normal::Approach(disturbance.normal),
            Normal::Spring { stiffness, .. } => Normal::Spring { load: disturbance.normal, stiffness },
        };
        // The moment about the lever is constant while the lever moves under the resultant.
        let tilt = match conditions.tilt {
            Tilt::Fixed(_) => Tilt::Fixed(disturbance.tilt),
            Tilt::ResultantAt(lever) | Tilt::Moment { lever, .. } => {
                let resultant: f64 = self.weights().iter().zip(&state.pressure).map(|(w, p)| w * p).sum();
                Tilt::Moment { lever, moment: disturbance.moment + disturbance.tilt * resultant }
            }
        };
        if self.set.iter().all(|active| !active) {
            rate.pressure.fill(0.0);
            rate.approach = match conditions.normal {
                Normal::Spring { stiffness, .. } if stiffness > 0.0 => disturbance.normal / stiffness,
                Normal::Approach(_) => disturbance.normal,
                _ => 0.0,
            };
            rate.tilt = if let Tilt::Fixed(_) = conditions.tilt { disturbance.tilt } else { 0.0 };
            return Ok(());
        }
        self.diagonal.fill(0.0);
        let problem = ContactProblem {
            gap: &self.gap,
            signed_friction: conditions.signed_friction,
            diagonal: &self.diagonal,
            normal,
            tilt,
        };
        (rate.approach, rate.tilt) = self.solver.solve_for_set(&problem, &self.set, &mut rate.pressure)?;
        Ok(())
    }
}
