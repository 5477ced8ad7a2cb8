//! The coupled problem of contact, wear and heat, level by level.
//!
//! [`levels::Model`] is the front door. The operators of a level follow from the scene alone and are shared; its state is a list of
//! numbers. An instance has both, and a workspace. A step of the contact line goes from `line::Line::step` to `line::step` (SDIRK2)
//! and `line::coupling::stage`, one nonlinear system. All calls: docs/architecture.md, "One communication step".
//!
//! Theory: docs/theory.md, sections 1.3, 8.1.

#![forbid(unsafe_code)]

pub(crate) mod budget;
pub(crate) mod events;
pub(crate) mod fastest_growth;
pub mod growth;
pub mod instability;
pub mod levels;
pub mod line;
pub mod lumped;
pub mod plan;
pub mod run_error;
pub(crate) mod step_control;
pub(crate) mod tolerance;

use numerics::scalar::Scalar;

/// Inputs of the component in the order of the variable table.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Inputs<S = f64> {
    /// Velocity of the punch over the strip, m/s.
    pub sliding_velocity: S,
    /// Load per face, N.
    pub normal_load: S,
    /// Angular velocity, rad/s.
    pub angular_velocity: S,
    /// Offset of the ambient temperature, K.
    pub ambient_temperature_offset: S,
    /// Velocity of forced convection, m/s.
    pub cooling_velocity: S,
    /// External temperature of the strip, K.
    pub strip_external_temperature: S,
    /// External temperature of the punch, K.
    pub punch_external_temperature: S,
}

/// Number of inputs.
pub const INPUTS: usize = 7;

impl Inputs {
    /// Sliding at a velocity (m/s) under a load (N), with neighbours of the temperature `around` (K).
    pub fn new(sliding_velocity: f64, normal_load: f64, around: f64) -> Inputs {
        Inputs {
            sliding_velocity,
            normal_load,
            strip_external_temperature: around,
            punch_external_temperature: around,
            ..Inputs::constant(0.0)
        }
    }

    /// These inputs after `time` (s) at the rates `slopes`.
    #[must_use]
    pub(crate) fn after(&self, slopes: Option<&Inputs>, time: f64) -> Inputs {
        match slopes {
            Some(slopes) => self.zip(slopes, |input, slope| input + slope * time),
            None => *self,
        }
    }
}

impl<S: Scalar> Inputs<S> {
    /// Sliding velocity at the mean radius `radius` (m), m/s.
    #[inline]
    pub(crate) fn velocity(&self, radius: f64) -> S {
        self.sliding_velocity + self.angular_velocity * radius
    }
}

impl<S: Copy> Inputs<S> {
    /// The same value of every input.
    pub fn constant(value: S) -> Self {
        Self::from_array([value; INPUTS])
    }

    /// The inputs in the order of the variable table.
    pub fn to_array(self) -> [S; INPUTS] {
        [
            self.sliding_velocity,
            self.normal_load,
            self.angular_velocity,
            self.ambient_temperature_offset,
            self.cooling_velocity,
            self.strip_external_temperature,
            self.punch_external_temperature,
        ]
    }

    /// A function of every input and its partner.
    #[must_use]
    pub(crate) fn zip<T: Copy, U: Copy>(&self, other: &Inputs<T>, of: impl Fn(S, T) -> U) -> Inputs<U> {
        let (own, other) = (self.to_array(), other.to_array());
        Inputs::from_array(std::array::from_fn(|i| of(own[i], other[i])))
    }

    /// Inputs from an array in the order of the variable table.
    pub fn from_array(array: [S; INPUTS]) -> Self {
        let [
            sliding_velocity,
            normal_load,
            angular_velocity,
            ambient_temperature_offset,
            cooling_velocity,
            strip_external_temperature,
            punch_external_temperature,
        ] = array;
        Inputs {
            sliding_velocity,
            normal_load,
            angular_velocity,
            ambient_temperature_offset,
            cooling_velocity,
            strip_external_temperature,
            punch_external_temperature,
        }
    }
}

/// Reason for which a step fails; names the quantity, its value and the limit.
#[derive(Clone, PartialEq, Debug)]
pub struct StepFailure(pub String);

impl std::fmt::Display for StepFailure {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for StepFailure {}
