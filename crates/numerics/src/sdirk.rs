//! The Runge-Kutta scheme of every time step: singly diagonally implicit, two stages, stiffly accurate.
//!
//! ```text
//! gamma | gamma
//!   1   | 1 - gamma   gamma          gamma = 1 - 1/sqrt 2
//! ------+---------------------
//!       | 1 - gamma   gamma
//! ```
//!
//! Second order and L-stable. The embedded weights (1/2, 1/2), also of second order, estimate the error.
//! (Hairer, Wanner: Solving Ordinary Differential Equations II, section IV.6.)
//!
//! Theory: docs/theory.md, section 5.2.

/// `gamma`: the first stage lies at this part of the step.
pub const GAMMA: f64 = 1.0 - 0.5 * std::f64::consts::SQRT_2;
