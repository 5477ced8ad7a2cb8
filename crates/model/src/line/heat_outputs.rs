//! Outputs of the resolved heat, by value reference. They are those at the end of the last step: the thermal states are frozen
//! between steps.
//!
//! Theory: docs/theory.md, section 2.7.

use super::Line;
use crate::Inputs;
use crate::lumped::conditions::Conditions;
use crate::lumped::operators::BodyOperators;
use crate::lumped::point::external_flow;
use conduction::line::{Boundary, FAR, Surroundings};
use numerics::scalar::Dual;
use scene::variables::{COUNT, reference};
use scene::{STATIONS, value};

impl Line {
    /// Ambient, far-face temperatures and cooling of both bodies at `inputs`.
    pub(super) fn around(&self, inputs: &Inputs) -> [Surroundings; 2] {
        let reference = self.mean.state().reference;
        let conditions = Conditions::new(&self.operators.mean, &self.tunables, reference, inputs);
        let cooling = self.state.heat.as_ref().map_or_else(Default::default, |heat| heat.cooling);
        let far = [conditions.punch_far, conditions.strip_far];
        let bodies = [&self.operators.scene.punch, &self.operators.scene.strip];
        std::array::from_fn(|side| {
            let around = Boundary { ambient: conditions.ambient, far: far[side], cooling: 0.0 };
            Surroundings::constant(around.with_fluxes(cooling[side], bodies[side].far_is_prescribed()))
        })
    }

    /// Temperatures of the neighbours of punch and strip behind their heat paths, K above the reference.
    fn neighbours(&self, inputs: &Inputs) -> [f64; 2] {
        Conditions::new(&self.operators.mean, &self.tunables, self.mean.state().reference, inputs).neighbours
    }

    /// A body, the conductance of its heat path per area of the far face, W/(m2 K), and that area of all faces, m2.
    fn path(&self, side: usize) -> (&BodyOperators, f64, f64) {
        let mean = &self.operators.mean;
        let body = [&mean.punch, &mean.strip][side];
        (body, body.air[FAR].path, body.area * mean.scene.faces)
    }

    /// Temperatures and heat flows.
    pub(super) fn write_heat_flows(&self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        let (Some(heat), Some(state), Some(bodies)) = (&self.heat, &self.state.heat, &self.operators.heat) else {
            return;
        };
        let operators = &self.operators;
        let all = operators.shared_depth * operators.scene.faces;
        let areas = &operators.weights;
        let absolute = self.mean.state().reference;
        let around = self.around(inputs);
        let into = |side: usize| all * state.flux[side].iter().zip(areas).map(|(q, c)| q * c).sum::<f64>();
        let (mut ambient, mut far, mut external) = (0.0, [0.0; 2], [0.0; 2]);
        let neighbours = self.neighbours(inputs);
        for side in 0..2 {
            if let Some(own) = &heat.bodies[side] {
                let [air, face] = own.flows(&state.bodies[side], &around[side], &state.flux[side]);
                ambient += air - bodies.cooled_length[side] * around[side].end.cooling;
                far[side] = all * face;
                let (body, path, area) = self.path(side);
                if path > 0.0 {
                    // The flux of the last step is in the heat flow of the face; it follows the neighbour's temperature instantly.
                    let t = own.far_temperature(&state.bodies[side], &around[side], &state.flux[side]);
                    external[side] = area * path * (t - neighbours[side]);
                    far[side] += external[side] - area * state.external[side][0];
                }
                external[side] = external_flow(body, far[side], external[side]);
            }
        }
        value!(values, "contact_temperature") = state.mean(areas) + absolute;
        value!(values, "contact_temperature_max") = operators.hottest.of(&state.temperature) + absolute;
        value!(values, "heat_flow_punch") = into(0);
        value!(values, "heat_flow_strip") = into(1);
        value!(values, "heat_flow_punch_top") = far[0];
        value!(values, "heat_flow_strip_base") = far[1];
        value!(values, "heat_flow_punch_external") = external[0];
        value!(values, "heat_flow_strip_external") = external[1];
        value!(values, "heat_flow_ambient") = all * ambient;
    }

    /// Heat account and mean temperatures.
    pub(super) fn write_heat_account(&self, values: &mut [f64; COUNT]) {
        let (Some(heat), Some(state), Some(bodies)) = (&self.heat, &self.state.heat, &self.operators.heat) else {
            return;
        };
        let operators = &self.operators;
        let all = operators.shared_depth * operators.scene.faces;
        let absolute = self.mean.state().reference;
        let [punch, strip] = [0, 1].map(|side| {
            let own = heat.bodies[side].as_ref();
            own.map_or_else(Default::default, |own| state.account(side, own.as_ref()))
        });
        value!(values, "dissipated_energy") = state.dissipated * all;
        value!(values, "heat_received_punch") = punch.received * all;
        value!(values, "heat_received_strip") = strip.received * all;
        value!(values, "stored_heat") = (punch.stored + strip.stored) * all;
        value!(values, "heat_lost_ambient") = (punch.ambient + strip.ambient) * all;
        value!(values, "heat_lost_punch_top") = punch.far * all;
        value!(values, "heat_lost_strip_base") = strip.far * all;
        let external = |side: usize, far: f64| {
            let (body, _, area) = self.path(side);
            external_flow(body, far * all, area * state.external[side][1])
        };
        value!(values, "heat_lost_punch_external") = external(0, punch.far);
        value!(values, "heat_lost_strip_external") = external(1, strip.far);
        if let Some(own) = &heat.bodies[0] {
            value!(values, "punch.mean_temperature") = own.mean_temperature(&state.bodies[0]) + absolute;
        }
        if let Some(own) = &heat.bodies[1] {
            value!(values, "strip.mean_temperature") = own.mean_temperature(&state.bodies[1]) + absolute;
        }
        value!(values, "estimated_step_error") = bodies.error + self.state.error;
    }

    /// Temperature of the contact along the line, mean of both surfaces.
    pub(super) fn write_heat_profile(&mut self, values: &mut [f64; COUNT]) {
        let (Some(heat), Some(state)) = (&mut self.heat, &self.state.heat) else { return };
        let cells = heat.mean_temperature(&state.temperature, self.mean.state().reference);
        let first = const { reference("profile.temperature") } as usize;
        self.operators.profile.fill(cells, &mut values[first..first + STATIONS]);
    }

    /// Derivatives along `seed`: at frozen states only ambient and far-face temperatures change heat flows, and no output
    /// temperature changes.
    pub(super) fn write_heat_rates(&self, inputs: &Inputs, seed: &Inputs, derivatives: &mut [f64; COUNT]) {
        let (Some(heat), Some(state)) = (&self.heat, &self.state.heat) else { return };
        for unchanged in [
            const { reference("contact_temperature") },
            const { reference("contact_temperature_max") },
            const { reference("heat_flow_punch") },
            const { reference("heat_flow_strip") },
        ] {
            derivatives[unchanged as usize] = 0.0;
        }
        let first = const { reference("profile.temperature") } as usize;
        derivatives[first..first + STATIONS].fill(0.0);
        let reference_temperature = self.mean.state().reference;
        let duals = inputs.zip(seed, |value, derivative| Dual { value, derivative });
        let conditions = Conditions::new(&self.operators.mean, &self.tunables, reference_temperature, &duals);
        let far = [conditions.punch_far.derivative, conditions.strip_far.derivative];
        let all = self.operators.shared_depth * self.operators.scene.faces;
        let (mut ambient, mut faces, mut external) = (0.0, [0.0; 2], [0.0; 2]);
        for (side, around) in self.around(inputs).iter().enumerate() {
            let Some(own) = &heat.bodies[side] else { continue };
            // Heat flows are affine in these temperatures: a difference is the exact derivative.
            let now = &around.end;
            let moved = Surroundings::constant(Boundary {
                ambient: now.ambient + conditions.ambient.derivative,
                far: now.far + far[side],
                ..*now
            });
            let of = |around| own.flows(&state.bodies[side], around, &state.flux[side]);
            let (now, then) = (of(around), of(&moved));
            ambient += all * (then[0] - now[0]);
            faces[side] = all * (then[1] - now[1]);
            let (body, path, area) = self.path(side);
            if path > 0.0 {
                let of = |around| own.far_temperature(&state.bodies[side], around, &state.flux[side]);
                external[side] = area * path * (of(&moved) - of(around) - conditions.neighbours[side].derivative);
                faces[side] += external[side];
            }
            external[side] = external_flow(body, faces[side], external[side]);
        }
        value!(derivatives, "heat_flow_ambient") = ambient;
        value!(derivatives, "heat_flow_punch_top") = faces[0];
        value!(derivatives, "heat_flow_strip_base") = faces[1];
        value!(derivatives, "heat_flow_punch_external") = external[0];
        value!(derivatives, "heat_flow_strip_external") = external[1];
    }
}
