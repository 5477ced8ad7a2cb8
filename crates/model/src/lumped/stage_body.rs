//! Contribution of one body to the stage equations of a step.
//!
//! Theory: docs/theory.md, sections 6.8, 4.11.

use super::air::{BESIDE, FACES, FAR, PORTS_OF_FACES};
use super::estimate::cooling_error;
use super::operators::BodyOperators;
use super::point::{air_flux, cooling_flux, cooling_slope};
use super::stage::{BASIS, Observed, Propagator, QUADRATURE};
use super::state::{BodyState, NewHeat};
use conduction::reduced::{PORTS, Port};
use numerics::maximum::maximum;

/// Contribution of one body to the stage equations.
pub struct StageBody<'a> {
    pub body: &'a BodyOperators,
    pub propagator: Option<&'a Propagator>,
    /// Contact temperature at the three points without contact and cooling flux.
    pub level: [f64; 3],
    /// Temperatures of the cooled faces at both stages without contact and cooling flux.
    pub cooled: [[f64; 2]; FACES],
    /// Stage fluxes through every port.
    pub flux: [[f64; 2]; PORTS],
    pub active: [bool; PORTS],
    /// Faces with cooling that depends on their temperature.
    pub cools: [bool; FACES],
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
            cooled: [[0.0; 2]; FACES],
            flux: [[0.0; 2]; PORTS],
            active: [true, false, ambient != [0.0; 2], far != [0.0; 2]],
            cools: body.air.each_ref().map(|face| face.acts()),
        };
        stage.flux[Port::Ambient as usize] = ambient;
        stage.flux[Port::Base as usize] = far;
        if let (Some(propagator), Some(heat)) = (propagator, &body.heat) {
            for point in [0, 2] {
                stage.level[point] = stage.observe(&propagator.contact, point, state, heat.count);
                for face in 0..FACES {
                    if stage.cools[face] {
                        stage.cooled[face][point / 2] = if face == BESIDE && body.cooled_is_contact {
                            stage.level[point]
                        } else {
                            stage.observe(&propagator.cooled[face], point, state, heat.count)
                        };
                    }
                }
            }
            for (port, cools) in PORTS_OF_FACES.into_iter().zip(stage.cools) {
                stage.active[port] |= cools;
            }
        }
        stage
    }

    /// Free response at `point`: by states and prescribed temperatures.
    #[inline]
    fn observe(&self, observed: &Observed, point: usize, state: &BodyState, count: usize) -> f64 {
        let mut sum = observed.of_states(point, &state.heat, count);
        for (port, found) in [(Port::Ambient as usize, false), (Port::Base as usize, self.cools[FAR])] {
            if self.active[port] && !found {
                sum += observed.of_flux(port, point, self.flux[port]);
            }
        }
        sum
    }

    /// Contact temperature at the point 2/3 without contact flux and cooling, for the error estimate only.
    pub fn middle_level(&self, state: &BodyState) -> f64 {
        match (self.propagator, &self.body.heat) {
            (Some(propagator), Some(heat)) => self.observe(&propagator.contact, 1, state, heat.count),
            _ => 0.5 * (self.level[0] + self.level[2]),
        }
    }

    /// Contact temperature at `point` under the current stage fluxes.
    pub fn contact(&self, point: usize) -> f64 {
        self.level[point] + self.add(|propagator| &propagator.contact, point)
    }

    /// Contact temperature at `point` without contact flux, with cooling.
    pub fn contact_level(&self, point: usize) -> f64 {
        match self.propagator {
            Some(propagator) => self.add_cooling(self.level[point], &propagator.contact, point),
            None => self.level[point],
        }
    }

    /// Whether any cooling depends on temperatures still to be solved for.
    pub fn cools(&self) -> bool {
        self.cools.contains(&true)
    }

    /// Response of an observation to contact and cooling fluxes at `point`.
    pub fn add(&self, of: impl Fn(&Propagator) -> &Observed, point: usize) -> f64 {
        self.propagator.map_or(0.0, |propagator| self.add_to(of(propagator), point))
    }

    fn add_to(&self, observed: &Observed, point: usize) -> f64 {
        self.add_cooling(observed.of_flux(0, point, self.flux[0]), observed, point)
    }

    fn add_cooling(&self, mut sum: f64, observed: &Observed, point: usize) -> f64 {
        for (port, cools) in PORTS_OF_FACES.into_iter().zip(self.cools) {
            if cools {
                sum += observed.of_flux(port, point, self.flux[port]);
            }
        }
        sum
    }

    pub fn gain(&self, point: usize) -> [f64; 2] {
        self.propagator.map_or([0.0; 2], |propagator| propagator.contact.gain[0][point])
    }

    /// Temperature of a cooled face at a stage.
    pub fn face(&self, face: usize, stage: usize) -> f64 {
        let observed = self.propagator.map_or(0.0, |own| self.add_to(&own.cooled[face], 2 * stage));
        self.cooled[face][stage] + observed
    }

    /// Error of the step by the cooling, in K, from the residuals of its laws at the point 2/3 with the conditions `middle`, and the
    /// largest temperature of a cooled face, K.
    pub fn cooling_error(&self, state: &BodyState, reference: f64, middle: &Around) -> [f64; 2] {
        let (mut error, mut rise) = (0.0, 0.0);
        let (Some(propagator), Some(heat)) = (self.propagator, &self.body.heat) else { return [0.0; 2] };
        let Around { ambient: [ambient, _], forced: [forced, _], neighbour: [neighbour, _] } = *middle;
        for face in (0..FACES).filter(|&face| self.cools[face]) {
            let (air, observed, port) = (&propagator.air[face], &propagator.cooled[face], PORTS_OF_FACES[face]);
            let t = self.observe(observed, 1, state, heat.count) + self.add_to(observed, 1);
            let between = BASIS[1][0] * self.flux[port][0] + BASIS[1][1] * self.flux[port][1];
            let residual = cooling_flux(air, reference, t, ambient, forced, neighbour) - between;
            let [own, contact, mean] = [observed, &propagator.contact, &propagator.mean]
                .map(|observed| observed.gain[port][2][0] + observed.gain[port][2][1]);
            error += cooling_error(residual, cooling_slope(air, reference, t, forced), own, [contact, mean]);
            rise = maximum(rise, maximum(self.face(face, 0).abs(), self.face(face, 1).abs()));
        }
        [error, rise]
    }

    /// Mean temperature of the body at the end of the step under the current stage fluxes, K above the reference; 0 for an insulator.
    pub fn mean_at_end(&self, state: &BodyState) -> f64 {
        let (Some(propagator), Some(heat)) = (self.propagator, &self.body.heat) else { return 0.0 };
        self.observe(&propagator.mean, 2, state, heat.count) + self.add_to(&propagator.mean, 2)
    }

    /// Thermal states and received heat of the ports at the end of the step.
    pub fn advanced(&self, state: &BodyState, reference: f64, around: &Around, step: f64) -> NewHeat {
        let mut new = NewHeat { heat: state.heat, received: state.received, external: state.external };
        if let (Some(propagator), Some(heat)) = (self.propagator, &self.body.heat) {
            propagator.advance(&mut new.heat, heat.count, &self.flux, self.active);
            for port in 0..PORTS {
                if port == 0 || self.active[port] {
                    new.received[port] +=
                        step * (QUADRATURE[0] * self.flux[port][0] + QUADRATURE[1] * self.flux[port][1]);
                }
            }
            let air = &propagator.air[FAR];
            if air.path > 0.0 {
                for stage in 0..2 {
                    let t = self.face(FAR, stage);
                    let by_air = air_flux(air, reference, t, around.ambient[stage], around.forced[stage]);
                    new.external += step * QUADRATURE[stage] * (by_air - self.flux[PORTS_OF_FACES[FAR]][stage]);
                }
            }
        }
        new
    }
}

/// Conditions around a body at both stages, or twice at one point.
pub struct Around {
    /// Ambient temperature, K above the reference.
    pub ambient: [f64; 2],
    /// Velocity factor of forced convection.
    pub forced: [f64; 2],
    /// Temperature of the neighbour behind the heat path, K above the reference.
    pub neighbour: [f64; 2],
}
