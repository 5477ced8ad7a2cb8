//! Parameters of a conducting strip: its properties, the path of the contact, the resolution in time and the heat left behind on fresh material.
//!
//! Theory: docs/theory.md, section 4.5.

use super::depth::Expansion;
use crate::lateral::Lateral;
use crate::slab::Slab;
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
    /// Conduction through the height; the contact face is cooled beside the contact.
    pub slab: Slab,
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

/// Harmonics of a path that can have states: see [`super::reduction`].
const RESOLVED_HARMONICS: f64 = 4000.0;

/// Largest contact width over the height: below it the integral over the wave numbers has at most some ten thousand nodes.
const FLATTEST_CONDUCTING: f64 = 2000.0;

impl StripProperties {
    /// A strip that does not expand.
    pub fn bare(slab: Slab, path: SlidingPath) -> Self {
        StripProperties { slab, path, expansion: None, lateral: None }
    }

    /// The slab with a convection of at most 18,000 K over the contact's `width` (m): the air is then as close to the surface as an
    /// eighteen-thousandth of that width of material. Stronger convection changes nothing, and would take waves as short.
    pub(super) fn cooled_slab(&self, width: f64) -> Slab {
        let thinnest = Slab { height: width / FLATTEST_CONDUCTING, ..self.slab };
        let most = 0.5 * self.slab.conductivity * thinnest.half_plane_from();
        Slab { surface_transfer: self.slab.surface_transfer.min(most), ..self.slab }
    }

    pub(super) fn check(&self, width: f64) -> Result<(), OutOfRange> {
        let Slab { height, conductivity, capacity, surface_transfer: convection, .. } = self.slab;
        for (quantity, value, requirement) in [
            ("strip height", height, "positive, in m"),
            ("strip conductivity", conductivity, "positive, in W/(m K)"),
            ("strip heat capacity", capacity, "positive, in J/(m3 K)"),
        ] {
            OutOfRange::unless(value > 0.0 && value.is_finite(), quantity, value, requirement)?;
        }
        let requirement = "at least a two thousandth of the contact's width";
        OutOfRange::unless(height * FLATTEST_CONDUCTING >= width, "strip height", height, requirement)?;
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
        let shortest =
            (resolution.fastest() * self.slab.capacity / self.slab.conductivity).sqrt().min(8.0 * PI / width);
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
    /// On an endless path heat left behind spreads by `c sqrt(k_d t)` until its effect is below the tolerance, with
    /// `c = 2 sqrt(ln(1/tolerance))`. While the contact slides a width and that margin, `m = c sqrt(k_d (W + m)/v)`; at rest over the
    /// whole time. Slower than nominal it spreads further: at a tenth of that velocity under full heat the contact is up to 0.4 % wrong
    /// at a tolerance of 1e-2, and 0.2 % at 1e-3.
    pub(super) fn period(&self, width: f64, resolution: &Resolution) -> (f64, f64) {
        let Resolution { duration, travel, tolerance, .. } = *resolution;
        let Slab { height, surface_transfer: convection, .. } = self.slab;
        let [conductivity, capacity] = self.slab.spreading();
        let mut reach = (conductivity / capacity * duration).sqrt();
        if convection > 0.0 {
            reach = reach.min((conductivity * height / convection).sqrt());
        }
        if self.slab.base == FarBoundary::Held {
            reach = reach.min(height);
        }
        let fresh = self.fresh(width, resolution);
        match self.path {
            SlidingPath::Closed(length) if !fresh => (length.max(width), f64::INFINITY),
            // The allowance covers a stroke longer than planned.
            SlidingPath::Stroke { stroke, length } if !fresh => {
                ((stroke + width + 8.0 * reach).max(length), width + 1.5 * stroke)
            }
            _ => {
                let spread = -4.0 * tolerance.ln();
                let resting = reach * spread.sqrt();
                let sliding = spread * conductivity / capacity * duration / travel;
                let margin = 0.5 * (sliding + (sliding * (sliding + 4.0 * width)).sqrt());
                (2.0 * (width + resting).max(2.0 * (width + margin.min(resting))), f64::INFINITY)
            }
        }
    }
}
