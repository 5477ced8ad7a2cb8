//! Preparation of bodies and operators for a step with resolved heat.
//!
//! Theory: docs/theory.md, sections 5.3, 6.4, 4.11.

use super::stage::{Prepared, state_of};
use super::{FrozenCoefficients, ThermalCoupling};
use crate::line::heat::partition::PartitionKey;
use crate::line::stages::StepData;
use crate::line::trajectory::InputTrajectory;
use crate::lumped::conditions::Conditions;
use conduction::line::contact_parts::ContactParts;
use conduction::line::{Boundary, Exchange, GAMMA, Stage, Surroundings};
use contact::friction::OperatingPoint;

impl ThermalCoupling {
    /// Prepares bodies and heat partitions for a part of `step` (s) that begins at `start` (s from the start of the piece).
    pub fn prepare(&mut self, given: &StepData<'_>, path: &InputTrajectory, start: f64, step: f64) -> Prepared<'_> {
        let (heat, state) = (self, state_of(given));
        let velocity = [path.velocity(start), path.velocity(start + step)];
        let operators = given.operators;
        heat.freeze_properties(given, step);
        let reference_velocity = state.reference.choose(velocity, heat.validity_radius(step));
        let key = (step, reference_velocity, heat.frozen.scales);
        heat.open = path.is_open(start, step);
        heat.set_contact_parts(given, step);
        if !heat.open {
            heat.take_partitions(key);
        }
        heat.iterations = 0;
        let flat = operators.scene.friction_fade.flat;
        let kinetic_coefficient = if flat {
            given.friction.kinetic_coefficient(0.0)
        } else {
            given.friction.coefficient * state.reference.fade
        };
        let operating_point = OperatingPoint { velocity: reference_velocity, ..path.operating_point(start + step) };
        let (stribeck, sign) = (given.friction.stribeck(operating_point), given.friction.sign(reference_velocity));
        heat.reference = FrozenCoefficients {
            velocity: reference_velocity,
            exact: flat && velocity == [reference_velocity; 2],
            per_pressure: kinetic_coefficient * (stribeck * (sign * reference_velocity)),
            friction: sign.abs() * kinetic_coefficient * stribeck,
            speed: sign * reference_velocity,
            kinetic_coefficient,
        };
        (heat.step, heat.velocity) = (step, velocity);
        let conditions = |time: f64| {
            let inputs = path.inputs(time);
            Conditions::new(&operators.mean, given.tunables, given.reference, &inputs)
        };
        let [from, first, end] = [start, start + GAMMA * step, start + step].map(conditions);
        heat.faces.set_conditions([first, end], given.reference, heat.frozen.scales);
        for side in 0..2 {
            let held = [&operators.scene.punch, &operators.scene.strip][side].far_is_prescribed();
            let around = |at: &Conditions| {
                let far = if held { [at.punch_far, at.strip_far][side] } else { 0.0 };
                Boundary { ambient: at.ambient, far, cooling: 0.0 }
            };
            heat.surroundings[side] = Surroundings::linear(around(&from), around(&end));
        }
        let [of_first, of_end] = &heat.contact_parts;
        let exchange = Exchange::Parts([of_first, of_end]);
        for (side, body) in heat.bodies.iter_mut().enumerate() {
            body.iter_mut().for_each(|own| own.prepare(&heat.frozen.step(side, step, velocity, exchange)));
        }
        Prepared(heat)
    }

    /// Takes the heat partitions of this key with the rounded parts in contact, from the cache or built.
    fn take_partitions(&mut self, key: PartitionKey) {
        let ThermalCoupling { partitions, bodies, rounded_parts, frozen, .. } = self;
        let (step, velocity, _) = key;
        let on = |side: usize, exchange| frozen.step(side, step, [velocity; 2], exchange);
        if !partitions.take(key) {
            for (side, body) in bodies.iter_mut().enumerate() {
                body.iter_mut().for_each(|own| own.prepare(&on(side, Exchange::Whole)));
            }
            for stage in [Stage::First, Stage::End] {
                let influence = bodies.each_mut().map(|body| body.as_mut().map(|own| own.influence(stage)));
                partitions[stage as usize].build_whole(key, influence);
            }
        }
        let [punch, strip] = bodies;
        let (Some(punch), Some(strip)) = (punch, strip) else { return };
        if (0..2).all(|stage| partitions[stage].is_for(key, &rounded_parts[stage])) {
            return;
        }
        let exchange = Exchange::Parts([&rounded_parts[0], &rounded_parts[1]]);
        punch.prepare(&on(0, exchange));
        for stage in [Stage::First, Stage::End] {
            let (partition, contact_parts) = (&mut partitions[stage as usize], &rounded_parts[stage as usize]);
            if !partition.set_parts(contact_parts, punch.influence(stage)) {
                strip.prepare(&on(1, exchange));
                partition.build(key, contact_parts, [Some(punch.influence(stage)), Some(strip.influence(stage))]);
            }
        }
    }

    /// Sets the parts of the cells in contact at both stages of a step of `step` s.
    fn set_contact_parts(&mut self, given: &StepData<'_>, step: f64) {
        let Some(edges) = &self.edges else { return };
        let state = state_of(given);
        let were_whole = self.contact_parts.iter().all(ContactParts::is_whole);
        for (contact_parts, ahead) in self.contact_parts.iter_mut().zip([GAMMA * step, step]) {
            match self.open {
                true => contact_parts.make_whole(),
                false => edges.find(&state.edges, state.ahead(ahead), contact_parts),
            }
        }
        let rounded = self.rounded_parts.iter_mut().zip(&self.contact_parts);
        rounded.for_each(|(rounded, contact_parts)| rounded.round(contact_parts));
        if were_whole && self.contact_parts.iter().all(ContactParts::is_whole) {
            return;
        }
        for (half, contact_parts) in self.half_resistance.iter_mut().zip(&self.contact_parts) {
            for (i, half) in half.iter_mut().enumerate() {
                *half = self.parameters.half_resistance / contact_parts.fraction(i);
            }
        }
    }

    /// Validity radius of the frozen operators in velocity (m/s), for a step of `step` s.
    fn validity_radius(&self, step: f64) -> f64 {
        let bodies = self.bodies.iter().zip(&self.frozen.scales);
        let radii = bodies.filter_map(|(body, scales)| Some(scales.pace * body.as_ref()?.velocity_validity()));
        let velocity_radius = radii.fold(f64::INFINITY, f64::min);
        // Travel within which the frozen operators remain valid, in diffusion lengths over the step.
        velocity_radius.min(0.25 * (self.parameters.diffusivity / step).sqrt())
    }
}
