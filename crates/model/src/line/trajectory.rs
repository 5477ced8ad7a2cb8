//! Input trajectory of the contact line over a piece of a communication step.
//!
//! Theory: docs/theory.md, sections 5.1, 2.2.

use super::Line;
use crate::Inputs;
use crate::events::load_on_contact;
use conduction::line::GAMMA;
use contact::friction::{FrictionLaw, OperatingPoint};

/// Lumped temperature and expansion over a piece: parabolas through start, middle and end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LumpedTemperature {
    /// Contact temperature, K.
    pub temperature: [f64; 3],
    /// Thermal displacement of both surfaces, m into the bodies.
    pub expansion: [f64; 3],
    /// Slip of a bristle in the piece.
    pub slipped: Option<Slipped>,
}

/// Slip of a bristle in a piece, the same for all cells and in proportion to the sliding velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slipped {
    /// Slip speed in the middle of the piece, m/s.
    pub speed: f64,
    /// The bristle slips throughout, so that friction is that of the law.
    pub throughout: bool,
    /// Friction force over normal load at the end, signed.
    pub ratio: f64,
    /// Friction heat flux over the pressure in the middle of the piece, without Stribeck factor, m/s.
    pub heat_per_pressure: f64,
    /// Heat flux that the bristle leaves where the contact opens at once, W/m2.
    pub released: f64,
}

impl LumpedTemperature {
    /// Constant temperature and expansion, without a bristle.
    pub(crate) fn constant(temperature: f64, expansion: f64) -> LumpedTemperature {
        LumpedTemperature { temperature: [temperature; 3], expansion: [expansion; 3], slipped: None }
    }
}

/// Conditions of the contact at the instant of a stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageConditions {
    /// s: sign of the velocity, regularised where the friction law is.
    pub sign: f64,
    /// Stribeck factor.
    pub stribeck: f64,
    /// s mu.
    pub signed_friction: f64,
    /// Load per face by the actuator, N, >= 0; in `Line::write_contact` that of the lumped level.
    pub load: f64,
    /// Sliding speed in the wear law, m/s.
    pub speed: f64,
    /// Kinetic friction coefficient (without Stribeck factor).
    pub kinetic_coefficient: f64,
    /// Contact temperature, K.
    pub temperature: f64,
    /// Thermal displacement of both surfaces, m into the bodies.
    pub expansion: f64,
    /// Friction heat flux over the pressure, m/s, where a bristle determines it.
    pub heat_per_pressure: Option<f64>,
    /// Heat flux into open surfaces, W/m2: see [`Slipped::released`].
    pub released: f64,
}

impl StageConditions {
    /// Takes the kinetic friction coefficient of an iterate, and s mu with it. The force of a bristle is unchanged.
    pub(crate) fn set_kinetic_coefficient(&mut self, coefficient: f64) {
        self.kinetic_coefficient = coefficient;
        if self.heat_per_pressure.is_none() {
            self.signed_friction = self.sign * self.stribeck * coefficient;
        }
    }

    /// Friction heat flux over kinetic friction coefficient and pressure, m/s: the slip speed times the Stribeck factor.
    pub(crate) fn slip(&self) -> f64 {
        match self.heat_per_pressure {
            Some(heat) if self.kinetic_coefficient > 0.0 => heat / self.kinetic_coefficient,
            Some(_) => 0.0,
            None => self.stribeck * self.speed,
        }
    }
}

/// Motion in a stage of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageMotion {
    /// Length of the stage, s.
    pub tau: f64,
    /// Distance by which the strip is carried along in it, m.
    pub travel: f64,
}

/// Speed, relative to the highest so far, up to which the bodies are at rest: rounding of an input that is intended to be 0.
const AT_REST: f64 = 1e-12;

/// Input trajectory over a piece.
#[derive(Clone, Debug)]
pub(crate) struct InputTrajectory {
    inputs: Inputs,
    slopes: Option<Inputs>,
    length: f64,
    heat: LumpedTemperature,
    friction: FrictionLaw,
    mean_radius: f64,
    nominal_load: f64,
    /// Mean apparent pressure over the actuator's load, 1/m2.
    pressure_per_load: f64,
    /// Sliding direction throughout the piece; 0 at rest.
    direction: f64,
}

impl InputTrajectory {
    /// Input trajectory from the inputs at the start of a piece of `length` (s) and their rates; `carried`: load (N) that the contact
    /// carries at the start.
    pub(crate) fn new(
        line: &Line,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        carried: f64,
        length: f64,
        heat: LumpedTemperature,
    ) -> InputTrajectory {
        let scene = &line.operators.scene;
        let ratio = if inputs.normal_load > 0.0 { carried / inputs.normal_load } else { 1.0 };
        let mut path = InputTrajectory {
            inputs: *inputs,
            slopes: slopes.copied(),
            length,
            heat,
            friction: line.friction.clone(),
            mean_radius: scene.mean_radius,
            nominal_load: scene.nominal_load,
            pressure_per_load: ratio / line.operators.mean.area,
            direction: 0.0,
        };
        // At a reversal, at the ends, the velocity is 0 to rounding only: its sign is that in the middle.
        let middle = path.velocity(0.5 * length);
        let rests = middle.abs() <= AT_REST * line.state.fastest;
        path.direction = if rests { 0.0 } else { middle.signum() };
        path
    }

    /// Load of the actuator at `time` (s from the start of the piece), N, >= 0.
    fn load(&self, time: f64) -> f64 {
        load_on_contact(self.inputs(time).normal_load, self.nominal_load)
    }

    /// Slip speed of a bristle at `time` (s from the start of the piece) over that in the middle: the ratio of the velocities, which
    /// have one sign but for rounding.
    fn slip_ratio(&self, time: f64) -> f64 {
        if self.direction == 0.0 {
            return 1.0;
        }
        (self.velocity(time) / self.velocity(0.5 * self.length)).clamp(0.0, 2.0)
    }

    /// Time integral of the load times slip ratio and Stribeck factor, N s, by Simpson's rule on four parts: exact but for that factor.
    pub(crate) fn impulse(&self) -> f64 {
        let part = 0.125 * self.length;
        let sum: f64 = [1.0, 4.0, 2.0, 4.0, 2.0, 4.0, 2.0, 4.0, 1.0]
            .iter()
            .enumerate()
            .map(|(k, weight)| (weight, part * k as f64))
            .map(|(weight, time)| {
                weight * self.load(time) * self.slip_ratio(time) * self.friction.stribeck(self.operating_point(time))
            })
            .sum();
        sum * part / 3.0
    }

    /// Sliding velocity at `time` (s from the start of the piece), m/s.
    pub(crate) fn velocity(&self, time: f64) -> f64 {
        self.inputs(time).velocity(self.mean_radius)
    }

    /// Operating point at `time` (s from the start of the piece).
    pub(crate) fn operating_point(&self, time: f64) -> OperatingPoint {
        OperatingPoint { velocity: self.velocity(time), pressure: self.pressure_per_load * self.load(time) }
    }

    /// Length of the piece, s.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Error of the friction work of the piece in one step of SDIRK2, relative to the work: load and speed are linear, so its power is
    /// quadratic, and the weights of the stages are exact for linear functions only. In n equal steps it falls as 1/n^2.
    pub(crate) fn error_of_work(&self) -> f64 {
        let power = |part: f64| {
            let now = self.at(part * self.length);
            (now.load * now.signed_friction * now.speed).abs()
        };
        let [first, middle, last] = [0.0, 0.5, 1.0].map(power);
        // Coefficient of the square, and the integral by Simpson's rule.
        let (square, work) = (2.0 * (first - 2.0 * middle + last), (first + 4.0 * middle + last) / 6.0);
        let error = (1.0 - GAMMA) * GAMMA * GAMMA + GAMMA - 1.0 / 3.0;
        if work > 0.0 { error * square.abs() / work } else { 0.0 }
    }

    /// Inputs at `time` (s from the start of the piece).
    pub(crate) fn inputs(&self, time: f64) -> Inputs {
        self.inputs.after(self.slopes.as_ref(), time)
    }

    /// Conditions at `time` (s from the start of the piece).
    pub(crate) fn at(&self, time: f64) -> StageConditions {
        let part = time / self.length;
        let between = |[start, middle, end]: [f64; 3]| {
            let bend = middle - 0.5 * (start + end);
            start + (end - start + 4.0 * bend * (1.0 - part)) * part
        };
        let velocity = self.velocity(time);
        let temperature = between(self.heat.temperature);
        let kinetic_coefficient = self.friction.kinetic_coefficient(temperature);
        let regularised = self.friction.regularization_velocity > 0.0;
        let sign = if regularised { self.friction.sign(velocity) } else { self.direction };
        let stribeck = self.friction.stribeck(self.operating_point(time));
        let sticking = self.heat.slipped.filter(|slipped| !slipped.throughout);
        let signed_friction = match sticking {
            Some(slipped) => slipped.ratio,
            None => sign * (kinetic_coefficient * stribeck),
        };
        let speed = match self.heat.slipped {
            Some(slipped) => slipped.speed * self.slip_ratio(time),
            None => (sign * velocity).max(0.0),
        };
        let heat_per_pressure = sticking.map(|slipped| slipped.heat_per_pressure * self.slip_ratio(time) * stribeck);
        let released = sticking.map_or(0.0, |slipped| slipped.released);
        let expansion = between(self.heat.expansion);
        StageConditions {
            sign,
            stribeck,
            signed_friction,
            load: self.load(time),
            speed,
            kinetic_coefficient,
            temperature,
            expansion,
            heat_per_pressure,
            released,
        }
    }

    /// Whether nothing touches in a step of `step` s from `start` (s from the start of the piece) on: without load, and without heat
    /// that a bristle leaves.
    pub(crate) fn is_open(&self, start: f64, step: f64) -> bool {
        [GAMMA * step, step].map(|time| self.at(start + time)).iter().all(|at| at.load == 0.0 && at.released == 0.0)
    }

    /// Whether the contact is open or at rest throughout.
    pub(crate) fn idle(&self) -> bool {
        let [start, end] = [self.at(0.0), self.at(self.length)];
        start.speed == 0.0 && end.speed == 0.0 || start.load == 0.0 && end.load == 0.0
    }
}
