//! Bodies and operators made ready for a step with heat.

use super::bodies::cooled_part;
use super::{Heat, Reference};
use crate::coupled::Inputs;
use crate::coupled::line::Line;
use crate::coupled::line::path::Path;
use crate::coupled::lumped::conditions::Conditions;
use crate::coupled::lumped::operators::BodyOperators;
use crate::heat::STEFAN_BOLTZMANN;
use crate::heat::line::{Stage, Surroundings};
use crate::scene::{Body, Scheme};

/// Travel within which heat under the contact answers as at the reference, in lengths of diffusion over the step.
const REACH: f64 = 0.25;

impl Line {
    /// Makes the bodies ready for a part of `step` (s) that begins at `start` (s from the start of the piece).
    pub(in crate::coupled::line) fn prepare_heat(&mut self, path: &Path, start: f64, step: f64) {
        let (Some(heat), Some(state)) = (&mut self.heat, &self.state.heat) else { return };
        let velocity = [path.velocity(start), path.velocity(start + step)];
        let operators = &self.operators;
        let reference_velocity = state.reference.choose(velocity, heat.zone(step));
        let key = (step, reference_velocity);
        let monolithic = operators.scene.scheme == Scheme::Monolithic;
        if monolithic && !heat.splits.iter().all(|split| split.is_for(key)) {
            heat.bodies.iter_mut().flatten().for_each(|own| own.prepare(step, [reference_velocity; 2]));
            for stage in [Stage::First, Stage::End] {
                let gains = heat.bodies.each_ref().map(|body| body.as_ref().map(|own| own.gains(stage)));
                heat.splits[stage as usize].build(key, gains);
            }
        }
        heat.renewed = [false; 2];
        let flat = operators.scene.friction_fade.flat;
        let faded = if flat { self.friction.faded(0.0) } else { self.friction.coefficient * state.reference.fade };
        let (stribeck, sign) = (self.friction.stribeck(reference_velocity), self.friction.sign(reference_velocity));
        heat.reference = Reference {
            velocity: reference_velocity,
            exact: flat && velocity == [reference_velocity; 2],
            per_pressure: faded * (stribeck * (sign * reference_velocity)),
            friction: sign.abs() * faded * stribeck,
            speed: sign * reference_velocity,
            faded,
        };
        let reference = self.mean.state().reference;
        let inputs = Inputs::from_array(path.inputs(start + 0.5 * step));
        let conditions = Conditions::new(&operators.mean, &self.tunables, reference, &inputs);
        let scene = &operators.scene;
        (heat.step, heat.velocity) = (step, velocity);
        let far = [conditions.punch_far, conditions.strip_far];
        let each: [(&BodyOperators, &Body, f64); 2] =
            [(&operators.mean.punch, &scene.punch, 1.0), (&operators.mean.strip, &scene.strip, cooled_part(scene))];
        for (side, (mean, body, part)) in each.into_iter().enumerate() {
            let ambient = conditions.ambient;
            let mut around = Surroundings { cooling: state.cooling[side], ambient, far: far[side] };
            if let Some(own) = &mut heat.bodies[side] {
                match monolithic {
                    true => own.prepare(step, velocity),
                    false => own.prepare_euler(step, velocity),
                }
                if mean.variable_cooling {
                    let now = own.cooled_temperature(&state.bodies[side], &around, &state.flux[side]);
                    heat.cooled[side] = now;
                    // The flux of the whole step is that of its middle: as the temperature goes on.
                    let rate = if state.last_step > 0.0 { (now - state.cooled[side]) / state.last_step } else { 0.0 };
                    let t = now + 0.5 * step * rate;
                    around.cooling = part * cooling(body, reference, t, ambient, conditions.forced);
                }
            }
            heat.surroundings[side] = around;
        }
    }
}

impl Heat {
    /// Difference of velocity (m/s) that hardly changes how a step of `step` s answers heat.
    fn zone(&self, step: f64) -> f64 {
        REACH * (self.diffusivity / step).sqrt()
    }
}

/// Flux (W/m2 of cooled area) into a surface of the temperature `t` by moving air and radiation; K above the reference.
fn cooling(body: &Body, reference: f64, t: f64, ambient: f64, forced: f64) -> f64 {
    let fourth = |t: f64| (t + reference).powi(4);
    (ambient - t) * forced * body.convection_forced + STEFAN_BOLTZMANN * body.emissivity * (fourth(ambient) - fourth(t))
}
