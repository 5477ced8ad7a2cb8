//! Reduction of all Fourier modes of the strip through the depth.
//!
//! Theory: docs/theory.md, sections 4.5, 4.12.

use super::depth::{Depth, DepthModes};
use super::error_sweep::ErrorSweep;
use super::properties::{Resolution, StripProperties};
use super::waves::{Wave, harmonics};
use crate::reduced::ReducedBody;
use crate::shares::STRIP_MODES;
use crate::slab::Slab;
use std::f64::consts::PI;
use std::sync::Arc;

/// Ratios of the shifts of the reduction, tried in this order until the error is small.
const SHIFT_RATIOS: [f64; 7] = [10.0, 7.0, 5.0, 3.8, 3.0, 2.5, 2.1];
/// Number of modes from which on the reduction error is first tested on a sample, and the ratio of all modes to the
/// sample.
const MANY_WAVES: usize = 200;
const SAMPLED: usize = 8;
/// Harmonics that always have states.
const FEWEST_HARMONICS: usize = 16;
/// Most harmonics with states.
const MOST_HARMONICS: usize = 8192;
/// Largest number of states of all modes: with everything else a saved state stays below 256 KB.
const MOST_STATES: usize = 16_000;
/// Most doublings of the shortest resolved time until the number of states is within its limit; at the last one only
/// [`FEWEST_HARMONICS`] are left, with a few hundred states.
const MOST_DOUBLINGS: usize = 60;

/// Reductions of strips under a contact of this width (m) at this resolution: none depends on the cells of the contact, so contact lines
/// that are built together share them.
#[derive(Debug, Default)]
pub struct Reductions(Vec<((StripProperties, f64, Resolution), Arc<Reduction>)>);

impl Reductions {
    /// The reduction of these arguments, by `make` where it is not known.
    pub(crate) fn of(
        &mut self,
        (properties, width, resolution): (&StripProperties, f64, &Resolution),
        make: impl FnOnce() -> Reduction,
    ) -> Arc<Reduction> {
        let key = (*properties, width, *resolution);
        if let Some((_, known)) = self.0.iter().find(|(other, _)| *other == key) {
            return known.clone();
        }
        self.0.push((key, Arc::new(make())));
        self.0[self.0.len() - 1].1.clone()
    }
}

/// Modes with states.
#[derive(Debug)]
pub(crate) struct Reduction {
    /// Mean mode (q = 0), per area of strip.
    pub mean: ReducedBody,
    /// Number of the last harmonic that has states.
    pub last: usize,
    /// Decay rate beyond which modes have no states, 1/s.
    pub fastest: f64,
    pub waves: Vec<Wave>,
    pub modes: Vec<DepthModes>,
    /// Number of states of each mode: at least as many as any shorter one has.
    pub counts: Vec<usize>,
    /// Error of the mean contact temperature; see [`ErrorSweep::largest_error`].
    pub error: f64,
}

/// The layer, its path in the frame of the punch, and what is asked of its reduction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer<'a> {
    pub properties: &'a StripProperties,
    /// Width of the contact, m.
    pub width: f64,
    pub slab: &'a Slab,
    /// Length of the period, and largest distance between heated and observed point along the material, m.
    pub period: f64,
    pub reach: f64,
    /// The contact meets fresh material.
    pub fresh: bool,
    pub tolerance: f64,
}

impl Layer<'_> {
    /// Reduces the modes that decay slowly against the shortest time of `resolution`. Where they have too many states,
    /// that time is doubled: modes that decay faster become direct feedthrough.
    pub(crate) fn reduce(&self, resolution: &Resolution) -> Reduction {
        let mut resolution = *resolution;
        let mean = self.slab.reduce(resolution.duration, self.tolerance);
        let mut reduction = self.reduce_at(&resolution, mean);
        // Real and imaginary parts; on fresh material of two stretches.
        let sets = if self.fresh { 4 } else { 2 };
        for _ in 0..MOST_DOUBLINGS {
            if sets * reduction.counts.iter().sum::<usize>() <= MOST_STATES {
                break;
            }
            resolution.shortest *= 2.0;
            reduction = self.reduce_at(&resolution, reduction.mean);
        }
        reduction
    }

    fn reduce_at(&self, resolution: &Resolution, mean: ReducedBody) -> Reduction {
        let Layer { properties, width, slab, period, reach, fresh, tolerance } = *self;
        let spacing = 2.0 * PI / period;
        let fastest = resolution.fastest();
        let shortest_wave = (fastest / slab.diffusivity()).sqrt();
        let last = ((shortest_wave / spacing).ceil() as usize).clamp(FEWEST_HARMONICS, MOST_HARMONICS);
        let mut waves = harmonics(period, last, reach);
        if fresh {
            // Neighbouring periodic images have opposite signs: no mean, and the midpoint rule of the endless path.
            waves.iter_mut().for_each(|wave| wave.number -= 0.5 * spacing);
        }
        let expansion = properties.expansion.as_ref();
        let layers: Vec<Depth> =
            waves.iter().map(|wave| Depth::new(slab, expansion, wave.number).spreading(properties.lateral)).collect();
        let seen = (!fresh).then_some(&mean);
        let error_sweep = ErrorSweep::new(width, slab, seen, period, (&waves, &layers), resolution);
        let mut modes: Vec<DepthModes> = Vec::new();
        let mut error = f64::INFINITY;
        for ratio in SHIFT_RATIOS {
            let reduce = |step: usize| -> Vec<DepthModes> {
                let layers = layers.iter().step_by(step);
                layers.map(|depth| depth.reduce(0.03 / resolution.duration, 4.0 * fastest, ratio)).collect()
            };
            let good = |error: f64| error <= STRIP_MODES * tolerance;
            // Errors of neighbouring modes are similar; the last ratio is accepted without the test.
            let few = waves.len() >= MANY_WAVES && Some(&ratio) != SHIFT_RATIOS.last();
            if few && !good(error_sweep.largest_error(&reduce(SAMPLED), SAMPLED)) {
                continue;
            }
            modes = reduce(1);
            error = error_sweep.largest_error(&modes, 1);
            if good(error) {
                break;
            }
        }
        let mut counts: Vec<usize> = modes.iter().map(|mode| mode.rate.len()).collect();
        for wave in (1..counts.len()).rev() {
            counts[wave - 1] = counts[wave - 1].max(counts[wave]);
        }
        Reduction { mean, last, fastest, waves, modes, counts, error }
    }
}
