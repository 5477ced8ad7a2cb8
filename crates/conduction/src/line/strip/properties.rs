//! Parameters of a conducting strip: its properties, the path of the contact, the resolution in time and the damping of periodic images.
//!
//! Theory: docs/theory.md, section 4.5.

use super::depth::Expansion;
use crate::lateral::Lateral;
use elasticity::OutOfRange;
use scene::FarBoundary;
use std::f64::consts::PI;

/// Path of the contact on the strip.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum SlidingPath {
    /// Closed after this length, m (circumference over the number of equal punches); at least the contact's width.
    Closed(f64),
    /// Reciprocating sliding along a stroke, m, on a strip of this length, m (0: the length that heat reaches).
    Stroke {
        /// Length of one stroke.
        stroke: f64,
        /// Length of the strip.
        length: f64,
    },
    /// Unidirectional sliding on a straight path over fresh material.
    Unidirectional,
}

/// A conducting strip.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StripProperties {
    /// h, m.
    pub height: f64,
    /// K, W/(m K), > 0.
    pub conductivity: f64,
    /// rho c, J/(m3 K).
    pub capacity: f64,
    /// Heat transfer coefficient of the top beside the contact, W/(m2 K).
    pub convection: f64,
    /// Condition at the base.
    pub base: FarBoundary,
    /// Path of the contact.
    pub path: SlidingPath,
    /// Thermal expansion; `None`: no thermal distortion.
    pub expansion: Option<Expansion>,
    /// Conduction out of the plane; `None`: the strip is as deep as the contact.
    pub lateral: Option<Lateral>,
}

/// Resolution in time of the reduction.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resolution {
    /// Longest time over which heat is resolved, s.
    pub duration: f64,
    /// Shortest step, s: faster decays act as direct feedthrough.
    pub shortest: f64,
    /// Way that the contact slides in the longest time, m.
    pub travel: f64,
    /// Permitted relative error of the contact temperature by the reduction.
    pub tolerance: f64,
}

impl Resolution {
    /// Decay rate beyond which modes have no states, 1/s.
    pub(super) fn fastest(&self) -> f64 {
        (0.7 * (1e-3 / self.tolerance).powf(0.4)).clamp(0.5, 20.0) / self.shortest
    }
}

/// Damping of periodic images: the rate that sliding on fresh material adds to every decay, so that heat left behind
/// does not return with the next periodic image of the contact. It is not used where the contact does not pass a period
/// within the whole time.
///
/// `rate = per_length (sqrt(v^2 + slow^2) - slow)`: proportional to `v^2` near rest and to `|v|` beyond, smooth in
/// between, so that quantities depending on it can be interpolated through rest.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct ImageDamping {
    /// Decay rate per sliding velocity, 1/m; 0: no damping.
    pub per_length: f64,
    /// Velocity at which one period is passed in the whole duration, m/s.
    pub slow: f64,
}

impl ImageDamping {
    /// Rate at a velocity, 1/s.
    pub(crate) fn rate(&self, velocity: f64) -> f64 {
        self.per_length * velocity * velocity / (velocity.hypot(self.slow) + self.slow)
    }

    /// Mean rate over an interval in which the velocity is linear.
    pub(crate) fn mean(&self, [from, to]: [f64; 2]) -> f64 {
        if self.per_length == 0.0 {
            return 0.0;
        }
        let middle = 0.5 * (from + to);
        // Change of the velocity, relative to `hypot(v, slow)`, up to which Simpson's rule gives the mean rate to 1e-6.
        if (to - from).abs() <= 0.25 * middle.hypot(self.slow) {
            return (self.rate(from) + 4.0 * self.rate(middle) + self.rate(to)) / 6.0;
        }
        let integral = |v: f64| 0.5 * (v * v.hypot(self.slow) + self.slow * self.slow * (v / self.slow).asinh());
        self.per_length * ((integral(to) - integral(from)) / (to - from) - self.slow)
    }
}

/// Harmonics of a path that can have states: see [`super::reduction`].
const RESOLVED_HARMONICS: f64 = 4000.0;

/// Longest period on an endless path, in diffusion lengths over the whole time: 1,100 harmonics of seven states.
const LONGEST_PERIOD: f64 = 1400.0;

/// Largest contact width over the height: below it the integral over the wave numbers has at most some ten thousand nodes.
const FLATTEST: f64 = 2000.0;

impl StripProperties {
    pub(super) fn check(&self, width: f64) -> Result<(), OutOfRange> {
        for (quantity, value, requirement) in [
            ("strip height", self.height, "positive, in m"),
            ("strip conductivity", self.conductivity, "positive, in W/(m K)"),
            ("strip heat capacity", self.capacity, "positive, in J/(m3 K)"),
        ] {
            OutOfRange::unless(value > 0.0 && value.is_finite(), quantity, value, requirement)?;
        }
        let convection = self.convection;
        let requirement = "at least a two thousandth of the contact's width";
        OutOfRange::unless(self.height * FLATTEST >= width, "strip height", self.height, requirement)?;
        OutOfRange::unless(convection >= 0.0 && convection.is_finite(), "strip convection", convection, "at least 0")?;
        match self.path {
            // Full periodic contact must be accepted despite rounding of the width.
            SlidingPath::Closed(length) => OutOfRange::unless(
                length.is_finite() && length >= width * (1.0 - 1e-12),
                "strip length",
                length,
                "at least the width of the contact zone",
            ),
            SlidingPath::Unidirectional => Ok(()),
            SlidingPath::Stroke { stroke, .. } => {
                OutOfRange::unless(stroke > 0.0 && stroke.is_finite(), "stroke", stroke, "positive, in m")
            }
        }
    }

    /// Whether the contact meets fresh material: on a straight path without strokes, or one on which harmonics that decay as slowly
    /// as the resolution asks, down to a quarter of the contact, would be too many.
    pub(super) fn fresh(&self, width: f64, resolution: &Resolution) -> bool {
        let shortest = (resolution.fastest() * self.capacity / self.conductivity).sqrt().min(8.0 * PI / width);
        match self.path {
            SlidingPath::Closed(along) | SlidingPath::Stroke { stroke: along, .. } => {
                along * shortest > 2.0 * PI * RESOLVED_HARMONICS
            }
            SlidingPath::Unidirectional => true,
        }
    }

    /// Length over which the heat of the contact spreads in time, so that the contact meets its mean: of a closed path, or the
    /// `period` of a stroke's cell; none on an open one.
    pub(super) fn remembering(&self, width: f64, period: f64, fresh: bool) -> Option<f64> {
        match self.path {
            SlidingPath::Closed(length) => Some(length.max(width)),
            _ => (!fresh).then_some(period),
        }
    }

    /// Length of the period, m, and largest distance between heated and observed point along the material.
    ///
    /// On an endless path the damping of the images also takes heat from under the contact: of what a width W holds `4 W/(5 L)` where a
    /// period L is short beside the way S, and `4 W S/(10 L^2)` where it is long. Half of the tolerance limits the latter; where the way
    /// is long that would take too many harmonics, and the root of the tolerance does. Harmonics to a fifth of the diffusion length over
    /// the whole time must have states, or the first moments have none.
    pub(super) fn period(&self, width: f64, resolution: &Resolution) -> (f64, f64) {
        let Resolution { duration, travel, tolerance, .. } = *resolution;
        let mut reach = (self.conductivity / self.capacity * duration).sqrt();
        if self.convection > 0.0 {
            reach = reach.min((self.conductivity * self.height / self.convection).sqrt());
        }
        if self.base == FarBoundary::Held {
            reach = reach.min(self.height);
        }
        let fresh = self.fresh(width, resolution);
        match self.path {
            SlidingPath::Closed(length) if !fresh => (length.max(width), f64::INFINITY),
            // The allowance covers a stroke longer than planned.
            SlidingPath::Stroke { stroke, length } if !fresh => {
                ((stroke + width + 8.0 * reach).max(length), width + 1.5 * stroke)
            }
            _ => {
                let widths = (4.8 / tolerance.sqrt()).min((0.8 * travel / (width * tolerance)).sqrt());
                let widths = widths.min(LONGEST_PERIOD * reach / width).clamp(12.0, 76.0);
                ((width + 8.0 * reach).max(width * widths), f64::INFINITY)
            }
        }
    }
}
