//! Cycle map: one cycle of the stepped model.
//!
//! Theory: docs/theory.md, section 9.5.

use super::error::CycleError;
use super::exchange::Exchange;
use super::records::{Extremes, Totals};
use super::tangent::WearJacobian;
use crate::Inputs;
use crate::line::Line;
#[cfg(doc)]
use crate::line::hottest::Hottest;
use crate::line::operators::{LineOperators, StripWear};
use crate::lumped::air::transfer;
use crate::lumped::conditions::Tunables;
use conduction::line::{FrozenState, GAMMA, Surroundings, ThermalBody};
use scene::{Body, Scene, ThermalBoundary};
use std::sync::Arc;

/// Steps of a half-stroke: one interval from its start to `2^-levels` of its duration and one from there to each doubling, each
/// in `parts` equal steps. The transient after a reversal begins like the square root of time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MapResolution {
    /// Number of doublings.
    pub levels: u32,
    /// Equal parts of each interval between doublings.
    pub parts: u32,
}

impl MapResolution {
    /// With resolved heat: errors of the half-strokes' mean pressures of about 1e-4 of the mean pressure.
    pub const WITH_HEAT: MapResolution = MapResolution { levels: 4, parts: 3 };
    /// Without heat: wear changes little in a half-stroke.
    pub const COLD: MapResolution = MapResolution { levels: 0, parts: 1 };

    fn steps(self, duration: f64) -> Vec<f64> {
        let parts = f64::from(self.parts);
        let interval = |level: u32| duration / f64::from(1_u32 << (self.levels - level.saturating_sub(1)));
        (0..=self.levels).flat_map(|level| std::iter::repeat_n(interval(level) / parts, self.parts as usize)).collect()
    }
}

/// Results of a half-stroke of a cycle. Vectors have N values.
#[derive(Clone, PartialEq, Debug)]
pub struct StrokePassage {
    /// Sliding velocity, m/s, signed.
    pub velocity: f64,
    /// Duration, s.
    pub duration: f64,
    /// Friction coefficient with the sign of the velocity at the end.
    pub signed_friction: f64,
    /// Time mean of the pressure over the half-stroke, Pa, with the quadrature weights of the wear.
    pub pressure: Vec<f64>,
    /// Pressure at the end of the first step after the reversal, and at the end.
    pub pressure_at: [Vec<f64>; 2],
    /// Time means of the temperatures of punch and strip, K above the reference; empty without heat.
    pub temperature: [Vec<f64>; 2],
    /// Mean fluxes into punch and strip, W/m2; empty without heat.
    pub flux: [Vec<f64>; 2],
    /// Depth worn off punch and strip, m.
    pub worn: [Vec<f64>; 2],
    /// Work of wear, `integral p dw` of both bodies, J/m.
    pub wear_dissipation: f64,
    /// Time mean of the approach, m.
    pub approach: f64,
    /// Time mean of the tilt, rad.
    pub tilt: f64,
}

/// Results of a computed cycle.
#[derive(Clone, Debug)]
pub struct Passage {
    /// F: change of the state over the cycle.
    pub change: Vec<f64>,
    /// Forward and backward.
    pub strokes: [StrokePassage; 2],
    /// Least and largest temperature of punch and strip in the cycle, N values each, K above the reference.
    pub range: [[Vec<f64>; 2]; 2],
    /// Least, mean and largest value in the cycle of the contact's mean temperature.
    pub contact_temperature: [f64; 3],
    /// Maximum over the cycle of the highest temperature, see [`Hottest`]; K above the reference.
    pub highest: f64,
    /// Totals of the cycle.
    pub totals: Totals,
    /// Derivative of the wear of the cycle with respect to the gap.
    pub(super) tangent: WearJacobian,
}

/// Cycle map. The state ("memory") is one vector: heat in the punch, heat in the strip, worn depth of the punch and of the strip
/// (N values each, m).
#[derive(Debug)]
pub struct CycleMap {
    pub(super) line: Line,
    load: f64,
    strokes: [(f64, Vec<f64>); 2],
    /// Decay rates of the entries of heat, 1/s.
    pub(super) decay_rates: Vec<f64>,
    /// Numbers of entries of punch and strip.
    sizes: [usize; 2],
    /// Heat exchange between two conductors.
    pub(super) exchange: Option<Exchange>,
    /// Least decay rate of the heat of a body, 1/s: by radiation and forced convection, which act from step to step.
    pub(super) least_rate: [f64; 2],
    start: Vec<f64>,
}

/// The scene for cycles: sliding throughout.
pub fn sliding_scene(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.stick_stiffness = 0.0;
    scene.elastic_slip = false;
    scene
}

impl CycleMap {
    /// Cycle map at the nominal load, with half-strokes of these velocities (forward > 0, backward < 0, m/s) and durations (s).
    ///
    /// # Errors
    /// A strip that wears on a straight track, whose shape is not one per cell; friction or wear that depend on a temperature
    /// which the contact line does not resolve; conductivity and specific heat that depend on temperature.
    pub fn new(
        mut operators: LineOperators,
        sliding: [(f64, f64); 2],
        resolution: MapResolution,
    ) -> Result<CycleMap, CycleError> {
        if operators.strip_wear == StripWear::Track {
            return Err(CycleError::Unsuitable(
                "cycle map: a strip that wears on a straight track has no shape of one depth per cell; see TrackedCycles"
                    .into(),
            ));
        }
        if operators.follows_heat() && operators.heat.is_none() {
            return Err(CycleError::Unsuitable(
                "cycles: friction or wear follow the mean temperature, which is not carried from cycle to cycle".into(),
            ));
        }
        let bodies = [("punch", &operators.scene.punch), ("strip", &operators.scene.strip)];
        let tabulated = bodies.into_iter().find(|(_, body)| operators.heat.is_some() && body.properties.is_some());
        if let Some((name, points)) = tabulated.and_then(|(name, body)| Some((name, body.properties?.points))) {
            return Err(CycleError::Unsuitable(format!(
                "cycle map: with heat at {name}.property_table.points = {points}, whose properties change from cycle to cycle; see \
                 steady::thermal::at_steady_properties"
            )));
        }
        // Every step is accepted, so that the cycle is a smooth function of its start.
        operators.accept_any_step();
        let scene = &operators.scene;
        let tunables = Tunables::of(scene);
        let load = scene.nominal_load;
        let strokes = sliding.map(|(velocity, duration)| (velocity, resolution.steps(duration)));
        let start = inputs(scene, strokes[0].0, load);
        let mut line = Line::new(Arc::new(operators), tunables, &start);
        let period: f64 = sliding.iter().map(|(_, duration)| duration).sum();
        let mut decay_rates = Vec::new();
        let mut sizes = [0; 2];
        if let Some(heat) = &line.heat {
            for (size, body) in sizes.iter_mut().zip(&heat.bodies) {
                let Some(body) = body else { continue };
                let mut rates = vec![0.0; body.decay_rates(0.0).len()];
                for (velocity, duration) in sliding {
                    add(&mut rates, duration / period, &body.decay_rates(velocity));
                }
                if rates.is_empty() {
                    return Err(CycleError::Unsuitable("cycles: a thermal body has no decay rates".into()));
                }
                *size = rates.len();
                decay_rates.extend(rates);
            }
        }
        let exchange = Exchange::new(&mut line, &strokes, sizes);
        let scene = &line.operators.scene;
        let speed = sliding.iter().map(|(velocity, _)| velocity.abs()).fold(0.0, f64::max);
        let least_rate = [&scene.punch, &scene.strip].map(|body| variable_transfer(body, scene, speed));
        let mut map = CycleMap { line, load, strokes, decay_rates, sizes, exchange, least_rate, start: Vec::new() };
        map.start = map.memory();
        Ok(map)
    }

    /// Operators of the contact line.
    pub fn operators(&self) -> &LineOperators {
        self.line.operators()
    }

    /// Reference temperature, K.
    pub fn reference(&self) -> f64 {
        self.line.mean.state().reference
    }

    /// Duration of a cycle, s.
    pub fn period(&self) -> f64 {
        self.strokes.iter().flat_map(|(_, steps)| steps).sum()
    }

    /// Sliding distance of a cycle, m.
    pub fn distance(&self) -> f64 {
        self.strokes.iter().map(|(velocity, steps)| velocity.abs() * steps.iter().sum::<f64>()).sum()
    }

    /// Number of entries of heat in the state.
    pub(crate) fn heat_entries(&self) -> usize {
        self.decay_rates.len()
    }

    /// Ranges of the heat of the punch and of the strip in the state.
    pub(crate) fn heat_ranges(&self) -> [std::ops::Range<usize>; 2] {
        [0..self.sizes[0], self.sizes[0]..self.sizes[0] + self.sizes[1]]
    }

    /// Ranges of the worn depth of the punch and of the strip in the state.
    pub fn worn_ranges(&self) -> [std::ops::Range<usize>; 2] {
        let (first, count) = (self.decay_rates.len(), self.operators().count());
        [first..first + count, first + count..first + 2 * count]
    }

    /// State of the unworn bodies at their initial temperatures.
    pub fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn memory(&self) -> Vec<f64> {
        let state = &self.line.state;
        let mut memory = Vec::with_capacity(self.decay_rates.len() + 2 * state.punch.len());
        if let Some(heat) = &state.heat {
            for (body, &size) in heat.bodies.iter().zip(&self.sizes) {
                memory.extend(&body[..size]);
            }
        }
        memory.extend(&state.punch);
        memory.extend(&state.strip);
        memory
    }

    fn remember(&mut self, memory: &[f64]) {
        let (ranges, worn) = (self.heat_ranges(), self.worn_ranges());
        let state = &mut self.line.state;
        if let Some(heat) = &mut state.heat {
            for (body, range) in heat.bodies.iter_mut().zip(ranges) {
                body[..range.len()].copy_from_slice(&memory[range]);
            }
        }
        state.punch.copy_from_slice(&memory[worn[0].clone()]);
        state.strip.copy_from_slice(&memory[worn[1].clone()]);
        state.current = false;
        state.refinement = 0;
        self.line.invalidate_equilibrium();
    }

    /// Displacement of both surfaces (m into the bodies, N values) by the heat in a state, or in a change of one.
    pub(super) fn displacement(&self, heat: &[f64], target: &mut [f64]) {
        target.fill(0.0);
        let (surroundings, flux) = (&Surroundings::default(), &vec![0.0; target.len()][..]);
        for (side, range) in self.heat_ranges().into_iter().enumerate() {
            let (Some(body), Some(state)) = (self.body(side), self.full(side, &heat[range])) else { continue };
            let part = FrozenState { state: &state, surroundings, flux, velocity: 0.0 }.distortion(body);
            target.iter_mut().zip(&part).for_each(|(sum, value)| *sum += value);
        }
    }

    /// Surface temperature (N values, K) by the entries of a body.
    pub(super) fn surface(&self, side: usize, entries: &[f64]) -> Vec<f64> {
        let flux = vec![0.0; self.operators().count()];
        let (Some(body), Some(state)) = (self.body(side), self.full(side, entries)) else { return flux };
        FrozenState { state: &state, surroundings: &Surroundings::default(), flux: &flux, velocity: 0.0 }
            .temperature(body)
    }

    /// Mean temperatures of the bodies (K above the reference) in a state.
    pub fn body_temperatures(&self, memory: &[f64]) -> [f64; 2] {
        let [punch, strip] = self.heat_ranges();
        [(0, punch), (1, strip)].map(|(side, range)| match (self.body(side), self.full(side, &memory[range])) {
            (Some(body), Some(state)) => body.mean_temperature(&state),
            _ => 0.0,
        })
    }

    /// Temperatures of punch and strip (N values, K above the reference) in the present state.
    fn temperature(&self) -> [Vec<f64>; 2] {
        let (Some(own), Some(heat)) = (&self.line.heat, &self.line.state.heat) else { return Default::default() };
        let mut temperature = heat.temperature.clone();
        for (side, values) in temperature.iter_mut().enumerate() {
            if let Some(body) = self.body(side) {
                let (state, around) = (&heat.bodies[side], &own.surroundings[side]);
                let (flux, velocity) = (&heat.flux[side], self.strokes[1].0);
                *values = FrozenState { state, surroundings: around, flux, velocity }.temperature(body);
            }
        }
        temperature
    }

    fn body(&self, side: usize) -> Option<&dyn ThermalBody> {
        self.line.heat.as_ref()?.bodies[side].as_deref()
    }

    /// Body state with these entries and a heat account of zero.
    fn full(&self, side: usize, entries: &[f64]) -> Option<Vec<f64>> {
        let mut state = vec![0.0; self.line.state.heat.as_ref()?.bodies[side].len()];
        state[..entries.len()].copy_from_slice(entries);
        Some(state)
    }

    fn totals(&self) -> Totals {
        let state = &self.line.state;
        let mut totals = Totals { volume: state.volume, ..Totals::default() };
        if let (Some(heat), Some(own)) = (&state.heat, &self.line.heat) {
            totals.dissipated = heat.dissipated;
            for (side, body) in own.bodies.iter().enumerate() {
                let Some(body) = body else { continue };
                let account = heat.account(side, body.as_ref());
                totals.received[side] = account.received;
                totals.lost[side] = account.far;
                totals.lost[2] += account.ambient;
            }
        }
        totals
    }

    /// Advances the state over one cycle.
    ///
    /// # Errors
    /// [`CycleError::Step`].
    pub fn pass(&mut self, memory: &[f64]) -> Result<Passage, CycleError> {
        self.remember(memory);
        let before = self.totals();
        let count = self.operators().count();
        let mut extremes = Extremes::new(count);
        if self.line.heat.is_some() {
            extremes.record(&self.temperature(), &self.line.operators, 0.0);
        }
        let mut tangent = WearJacobian::new(count);
        let strokes = self.strokes.clone();
        let mut passed = Vec::with_capacity(2);
        for (velocity, steps) in &strokes {
            passed.push(self.stroke(*velocity, steps, &mut extremes)?);
            tangent.add(&mut self.line, steps.iter().sum())?;
        }
        let after = self.memory();
        let mut totals = self.totals().plus(-1.0, &before);
        totals.wear_dissipation = passed.iter().map(|stroke| stroke.wear_dissipation).sum();
        let [forward, backward]: [StrokePassage; 2] = passed.try_into().unwrap_or_else(|_| unreachable!("two strokes"));
        Ok(Passage {
            change: after.iter().zip(memory).map(|(after, before)| after - before).collect(),
            strokes: [forward, backward],
            range: extremes.range,
            contact_temperature: [extremes.contact[0], extremes.contact[1] / self.period(), extremes.contact[2]],
            highest: extremes.highest,
            totals,
            tangent,
        })
    }

    fn stroke(&mut self, velocity: f64, steps: &[f64], extremes: &mut Extremes) -> Result<StrokePassage, CycleError> {
        let inputs = inputs(&self.operators().scene, velocity, self.load);
        let count = self.operators().count();
        let warm = self.line.heat.is_some();
        let zeros = |wanted: bool| vec![0.0; if wanted { count } else { 0 }];
        let pair = |wanted: bool| [zeros(wanted), zeros(wanted)];
        let duration: f64 = steps.iter().sum();
        let mut passage = StrokePassage {
            velocity,
            duration,
            signed_friction: 0.0,
            pressure: zeros(true),
            pressure_at: pair(true),
            temperature: pair(warm),
            flux: pair(warm),
            worn: pair(true),
            wear_dissipation: 0.0,
            approach: 0.0,
            tilt: 0.0,
        };
        let worn = |line: &Line| [line.state.punch.clone(), line.state.strip.clone()];
        let before = worn(&self.line);
        for (number, &step) in steps.iter().enumerate() {
            self.line.step(&inputs, None, step)?;
            let (state, work) = (&self.line.state, &self.line.stages);
            let weights = &self.line.operators.weights;
            let stages = [((1.0 - GAMMA) * step, &work.first), (GAMMA * step, &work.end)];
            for (index, (weight, stage)) in stages.into_iter().enumerate() {
                add(&mut passage.pressure, weight / duration, &stage.pressure);
                passage.approach += weight / duration * stage.approach;
                passage.tilt += weight / duration * stage.tilt;
                for rates in &work.rates[index] {
                    let power = |i: usize| weights[i] * stage.pressure[i] * rates[i];
                    passage.wear_dissipation += weight * (0..count).map(power).sum::<f64>();
                }
            }
            if number == 0 {
                passage.pressure_at[0].copy_from_slice(&state.pressure);
            }
            if let (Some(own), Some(heat)) = (&self.line.heat, &state.heat) {
                for (stage, weight) in [(1.0 - GAMMA) * step, GAMMA * step].into_iter().enumerate() {
                    for (mean, flux) in passage.flux.iter_mut().zip(&own.flux[stage]) {
                        add(mean, weight / duration, flux);
                    }
                }
                // By the trapezoidal rule: the stages have temperatures only where something depends on them.
                for side in 0..2 {
                    for values in [&extremes.last[side], &heat.temperature[side]] {
                        add(&mut passage.temperature[side], 0.5 * step / duration, values);
                    }
                }
                extremes.record(&heat.temperature, &self.line.operators, step);
            }
        }
        passage.pressure_at[1].copy_from_slice(&self.line.state.pressure);
        let after = worn(&self.line);
        for (side, depth) in passage.worn.iter_mut().enumerate() {
            depth.copy_from_slice(&after[side]);
            add(depth, -1.0, &before[side]);
        }
        passage.signed_friction = self.line.stages.conditions.signed_friction;
        Ok(passage)
    }
}

/// Heat transfer coefficient of radiation and forced convection over the heat capacity per area, 1/s.
fn variable_transfer(body: &Body, scene: &Scene, speed: f64) -> f64 {
    let faces = if body.far_thermal == ThermalBoundary::Convecting { 2.0 } else { 1.0 };
    faces * transfer(0.0, body, scene, speed) / body.areal_capacity()
}

/// Inputs of steady sliding: ambient and external temperatures are the ambient temperature.
fn inputs(scene: &Scene, velocity: f64, load: f64) -> Inputs {
    let external = |body: &Body| if body.has_neighbour() { scene.ambient_temperature } else { 0.0 };
    Inputs::from_array([velocity, load, 0.0, 0.0, 0.0, external(&scene.strip), external(&scene.punch)])
}

fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
}
