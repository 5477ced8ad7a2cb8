//! Preparation of bodies and operators for a step with resolved heat.
//!
//! Theory: docs/theory.md, sections 5.3, 6.4, 4.11.

use super::stage::{Prepared, state_of};
use super::{FrozenCoefficients, ThermalCoupling};
use crate::Inputs;
use crate::line::heat::air::{balance, cooling};
use crate::line::heat::bodies::cooled_part;
use crate::line::stages::StepData;
use crate::line::trajectory::InputTrajectory;
use crate::lumped::conditions::Conditions;
use crate::lumped::operators::BodyOperators;
use conduction::line::contact_parts::ContactParts;
use conduction::line::{BESIDE, FACES, FAR, GAMMA, Stage, Surroundings};
use scene::{Body, Scheme};

/// Longest extrapolation, in lengths of the last step: step control doubles a step at most. Where the importer increases the step
/// by more, perhaps from microseconds after a reversal, the rate of the last step is no estimate at the end of the next.
const MOST_EXTRAPOLATED: f64 = 2.0;

/// Travel within which the frozen operators remain valid, in diffusion lengths over the step.
const REACH: f64 = 0.25;

impl ThermalCoupling {
    /// Prepares bodies and heat partitions for a part of `step` (s) that begins at `start` (s from the start of the piece).
    pub fn prepare(&mut self, given: &StepData<'_>, path: &InputTrajectory, start: f64, step: f64) -> Prepared<'_> {
        let (heat, state) = (self, state_of(given));
        let velocity = [path.velocity(start), path.velocity(start + step)];
        let operators = given.operators;
        let reference_velocity = state.reference.choose(velocity, heat.validity_radius(step));
        let key = (step, reference_velocity);
        let monolithic = operators.scene.scheme == Scheme::Monolithic;
        heat.set_contact_parts(given, step);
        if monolithic {
            heat.take_partitions(key);
        }
        heat.iterations = 0;
        let flat = operators.scene.friction_fade.flat;
        let kinetic_coefficient = if flat {
            given.friction.kinetic_coefficient(0.0)
        } else {
            given.friction.coefficient * state.reference.fade
        };
        let (stribeck, sign) = (given.friction.stribeck(reference_velocity), given.friction.sign(reference_velocity));
        heat.reference = FrozenCoefficients {
            velocity: reference_velocity,
            exact: flat && velocity == [reference_velocity; 2],
            per_pressure: kinetic_coefficient * (stribeck * (sign * reference_velocity)),
            friction: sign.abs() * kinetic_coefficient * stribeck,
            speed: sign * reference_velocity,
            kinetic_coefficient,
        };
        let reference = given.reference;
        let conditions = |time: f64| {
            let inputs = Inputs::from_array(path.inputs(time));
            Conditions::new(&operators.mean, given.tunables, reference, &inputs)
        };
        let middle = conditions(start + 0.5 * step);
        let scene = &operators.scene;
        (heat.step, heat.velocity) = (step, velocity);
        let far = [middle.punch_far, middle.strip_far];
        let each: [(&BodyOperators, &Body, [f64; FACES]); 2] = [
            (&operators.mean.punch, &scene.punch, [1.0; FACES]),
            (&operators.mean.strip, &scene.strip, [cooled_part(scene), 1.0]),
        ];
        for (side, (mean, body, parts)) in each.into_iter().enumerate() {
            let ambient = middle.ambient;
            let held = body.far_is_prescribed();
            let around = Surroundings { ambient, far: far[side], ..Surroundings::default() };
            let mut around = around.with_air(state.cooling[side], held);
            if let Some(own) = &mut heat.bodies[side] {
                match monolithic {
                    true => own.prepare(step, velocity),
                    false => own.prepare_euler(step, velocity),
                }
                if mean.is_cooled_variably() {
                    let [from, to] = [start, start + step].map(conditions);
                    let by_air = |face: usize, t: f64, at: &Conditions| match mean.air[face].is_cooled() {
                        true => cooling(body, reference, t, at.ambient, at.forced).map(|value| parts[face] * value),
                        false => [0.0; 2],
                    };
                    let law = |face: usize, t: f64, at: &Conditions| match mean.air[face].path {
                        0.0 => by_air(face, t, at),
                        path => {
                            let [flux, fall] = by_air(face, t, at);
                            [flux + path * (at.neighbours[side] - t), fall + path]
                        }
                    };
                    let with = |flux: [f64; FACES]| {
                        let around = around.with_air(flux, held);
                        own.cooled_temperature(&state.bodies[side], &around, &state.flux[side])
                    };
                    let last = state.cooling[side];
                    let now = with(last);
                    // Part of the surface temperature is direct feedthrough of the cooling, which jumps with the inputs.
                    let mut rise = [[0.0; FACES]; FACES];
                    for face in (0..FACES).filter(|&face| mean.air[face].acts()) {
                        let mut more = last;
                        more[face] += 1.0;
                        let then = with(more);
                        (0..FACES).for_each(|other| rise[other][face] = then[other] - now[other]);
                    }
                    let begin = balance(last, now, rise, |face, t| law(face, t, &from));
                    // The contact's fluxes, extrapolated at their last rates.
                    let [first, end] = &mut heat.flux;
                    let slopes = state.flux[side].iter().zip(&state.slope[side]);
                    let expected = first[side].iter_mut().zip(&mut end[side]).zip(slopes);
                    for ((first, end), (flux, slope)) in expected {
                        (*first, *end) = (flux + GAMMA * step * slope, flux + step * slope);
                    }
                    around = around.with_air(begin, held);
                    let mut ahead = own.cooled_ahead(&state.bodies[side], &around, &first[side], &end[side]);
                    let drift = match state.last_step > 0.0 {
                        true => {
                            (step / state.last_step).min(MOST_EXTRAPOLATED)
                                * (ahead.not_extrapolated - state.unpredicted_rise[side])
                        }
                        false => 0.0,
                    };
                    heat.unpredicted_rise[side] = ahead.not_extrapolated;
                    ahead.temperature[BESIDE] += drift;
                    let end = balance(begin, ahead.temperature, ahead.rise, |face, t| law(face, t, &to));
                    if mean.air[FAR].path > 0.0 {
                        let by_path =
                            |flux: [f64; FACES], known: [f64; FACES], t: f64, rise: [f64; FACES], at: &Conditions| {
                                let t = t + rise[0] * (flux[0] - known[0]) + rise[1] * (flux[1] - known[1]);
                                flux[FAR] - by_air(FAR, t, at)[0]
                            };
                        let early = by_path(begin, last, now[FAR], rise[FAR], &from);
                        let late = by_path(end, begin, ahead.temperature[FAR], ahead.rise[FAR], &to);
                        let mean = if monolithic { 0.5 * (early + late) } else { late };
                        heat.external[side] = (-late, -step * mean);
                    }
                    around = around.with_air(end, held);
                    if monolithic {
                        around.cooling_fall = begin[BESIDE] - end[BESIDE];
                        around.far_fall = if held { 0.0 } else { begin[FAR] - end[FAR] };
                    }
                }
            }
            heat.surroundings[side] = around;
        }
        Prepared(heat)
    }

    /// Takes the heat partitions of a step (s) and reference velocity (m/s) with the current parts in contact, from the cache or built.
    fn take_partitions(&mut self, key: (f64, f64)) {
        let ThermalCoupling { partitions, bodies, contact_parts, edges, .. } = self;
        let known = partitions.take(key);
        if known && (0..2).all(|stage| partitions[stage].is_for(key, &contact_parts[stage])) {
            return;
        }
        let (step, velocity) = key;
        let updates = (0..2).all(|stage| partitions[stage].updates_for(&contact_parts[stage]));
        if !(known && updates) {
            bodies.iter_mut().flatten().for_each(|own| own.prepare(step, [velocity; 2]));
        } else if let Some(punch) = &mut bodies[0] {
            punch.prepare(step, [velocity; 2]);
        }
        for stage in [Stage::First, Stage::End] {
            let (partition, contact_parts) = (&mut partitions[stage as usize], &contact_parts[stage as usize]);
            let influence = bodies.each_ref().map(|body| body.as_ref().map(|own| own.influence(stage)));
            let whole = bodies[0].as_ref().map(|punch| punch.influence_of_whole(stage));
            if edges.is_some() && !known {
                partition.build_whole(key, [whole, influence[1]]);
            }
            match (whole, influence[0]) {
                (Some(whole), Some(through_parts)) if updates => {
                    partition.set_parts(contact_parts, [whole, through_parts])
                }
                _ => partition.build(key, contact_parts, influence),
            }
        }
    }

    /// Sets the parts of the cells in contact at both stages of a step of `step` s.
    fn set_contact_parts(&mut self, given: &StepData<'_>, step: f64) {
        let Some(edges) = &self.edges else { return };
        let state = state_of(given);
        let were_whole = self.contact_parts.iter().all(ContactParts::is_whole);
        for (contact_parts, ahead) in self.contact_parts.iter_mut().zip([GAMMA * step, step]) {
            edges.find(&state.edges, ahead.min(MOST_EXTRAPOLATED * state.last_step), contact_parts);
        }
        if were_whole && self.contact_parts.iter().all(ContactParts::is_whole) {
            return;
        }
        let [first, end] = &self.contact_parts;
        self.bodies[0].iter_mut().for_each(|own| own.set_contact_parts([first, end]));
        for (half, contact_parts) in self.half_resistance.iter_mut().zip(&self.contact_parts) {
            for (i, half) in half.iter_mut().enumerate() {
                *half = self.parameters.half_resistance / contact_parts.fraction(i);
            }
        }
    }

    /// Validity radius of the frozen operators in velocity (m/s), for a step of `step` s.
    fn validity_radius(&self, step: f64) -> f64 {
        let velocity_radius =
            self.bodies.iter().flatten().map(|own| own.velocity_validity()).fold(f64::INFINITY, f64::min);
        velocity_radius.min(REACH * (self.parameters.diffusivity / step).sqrt())
    }
}
