//! What one body contributes to the equations of a step.

use super::operators::BodyOperators;
use super::point::{cooling_flux, cooling_slope};
use super::stage::{Observed, Propagator, QUADRATURE};
use super::state::{BodyState, NewHeat};
use crate::heat::reduced::{PORTS, Port};
use crate::numerics::maximum::maximum;

/// What one body contributes to the stage equations.
pub struct StageBody<'a> {
    pub body: &'a BodyOperators,
    pub propagator: Option<&'a Propagator>,
    /// Contact temperature at the three points without contact and cooling flux.
    pub level: [f64; 3],
    /// Temperature of the cooled surface likewise.
    pub cooled: [f64; 3],
    /// Stage fluxes through every port.
    pub flux: [[f64; 2]; PORTS],
    pub active: [bool; PORTS],
}

impl<'a> StageBody<'a> {
    pub fn new(
        body: &'a BodyOperators,
        propagator: Option<&'a Propagator>,
        state: &BodyState,
        ambient: [f64; 2],
        far: [f64; 2],
    ) -> Self {
        let mut stage = StageBody {
            body,
            propagator,
            level: [ambient[0], 0.0, ambient[1]],
            cooled: [0.0; 3],
            flux: [[0.0; 2]; PORTS],
            active: [true, body.variable_cooling, ambient != [0.0; 2], far != [0.0; 2]],
        };
        stage.flux[Port::Ambient as usize] = ambient;
        stage.flux[Port::Base as usize] = far;
        if let (Some(propagator), Some(heat)) = (propagator, &body.heat) {
            for point in [0, 2] {
                stage.level[point] = stage.observe(&propagator.contact, point, state, heat.count);
                if body.variable_cooling {
                    stage.cooled[point] = if body.cooled_is_contact {
                        stage.level[point]
                    } else {
                        stage.observe(&propagator.cooled, point, state, heat.count)
                    };
                }
            }
        }
        stage
    }

    /// What states and prescribed temperatures give at `point`.
    #[inline]
    fn observe(&self, observed: &Observed, point: usize, state: &BodyState, count: usize) -> f64 {
        let mut sum = observed.of_states(point, &state.heat, count);
        for port in [Port::Ambient as usize, Port::Base as usize] {
            if self.active[port] {
                sum += observed.of_flux(port, point, self.flux[port]);
            }
        }
        sum
    }

    /// Contact temperature at the point 2/3 without contact flux and cooling: only the error estimate needs it.
    pub fn middle_level(&self, state: &BodyState) -> f64 {
        match (self.propagator, &self.body.heat) {
            (Some(propagator), Some(heat)) => self.observe(&propagator.contact, 1, state, heat.count),
            _ => 0.5 * (self.level[0] + self.level[2]),
        }
    }

    /// Contact temperature at `point` under the present stage fluxes.
    pub fn contact(&self, point: usize) -> f64 {
        self.level[point] + self.add(|propagator| &propagator.contact, point)
    }

    /// Contact temperature at `point` without contact flux.
    pub fn contact_level(&self, point: usize) -> f64 {
        let cooling = Port::Cooling as usize;
        match self.propagator {
            Some(propagator) if self.active[cooling] => {
                self.level[point] + propagator.contact.of_flux(cooling, point, self.flux[cooling])
            }
            _ => self.level[point],
        }
    }

    pub fn add(&self, of: impl Fn(&Propagator) -> &Observed, point: usize) -> f64 {
        let Some(propagator) = self.propagator else { return 0.0 };
        let observed = of(propagator);
        let mut sum = observed.of_flux(0, point, self.flux[0]);
        let cooling = Port::Cooling as usize;
        if self.active[cooling] {
            sum += observed.of_flux(cooling, point, self.flux[cooling]);
        }
        sum
    }

    pub fn gain(&self, point: usize) -> [f64; 2] {
        self.propagator.map_or([0.0; 2], |propagator| propagator.contact.gain[0][point])
    }

    /// Updates the cooling fluxes from the present temperatures, linearised in the own flux; returns the
    /// largest change of temperature that this makes.
    pub fn cool(&mut self, reference: f64, ambient: [f64; 2], forced: [f64; 2]) -> f64 {
        let cooling = Port::Cooling as usize;
        let Some(propagator) = self.propagator else { return 0.0 };
        let mut change: f64 = 0.0;
        for stage in 0..2 {
            let point = 2 * stage;
            let t = self.cooled[point] + self.add(|propagator| &propagator.cooled, point);
            let wanted = cooling_flux(self.body, reference, t, ambient[stage], forced[stage]);
            let gain = propagator.cooled.gain[cooling][point][stage];
            let slope = cooling_slope(self.body, reference, t, forced[stage]);
            let step = (wanted - self.flux[cooling][stage]) / (1.0 + slope * gain);
            self.flux[cooling][stage] += step;
            change = maximum(change, (step * propagator.contact.gain[cooling][2][stage]).abs());
        }
        change
    }

    /// Heat at the end of the step, and what the ports have received by then.
    pub fn advanced(&self, state: &BodyState, step: f64) -> NewHeat {
        let mut new = NewHeat { heat: state.heat, received: state.received };
        if let (Some(propagator), Some(heat)) = (self.propagator, &self.body.heat) {
            propagator.advance(&mut new.heat, heat.count, &self.flux, self.active);
            for port in 0..PORTS {
                if port == 0 || self.active[port] {
                    new.received[port] +=
                        step * (QUADRATURE[0] * self.flux[port][0] + QUADRATURE[1] * self.flux[port][1]);
                }
            }
        }
        new
    }
}
