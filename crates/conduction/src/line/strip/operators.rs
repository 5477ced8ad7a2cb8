//! Operators of the strip's conduction, built once and shared by every copy.
//!
//! Theory: docs/theory.md, section 4.5.

use super::depth::Expansion;
use super::distance::DistanceSum;
use super::fresh::{ENDS, Fresh};
use super::properties::{Resolution, SlidingPath, StripProperties};
use super::reduction::{Layer, Reductions};
use super::robin_correction::RobinCorrection;
use super::stage_response::Layout;
use super::state_layout::{Level, of_mode, state_layout};
use super::static_correction::StaticCorrection;
use super::velocity_table::VelocityTable;
use super::waves::{Shapes, Wave};
use crate::reduced::ReducedBody;
use crate::slab::Slab;
use elasticity::{self, Cells, OutOfRange};
use numerics::dense;
use scene::FarBoundary;
use std::f64::consts::PI;

/// Operators of the strip: constant after construction, except for the tables and caches.
#[derive(Debug)]
pub(crate) struct StripOperators {
    pub widths: Vec<f64>,
    pub half: usize,
    /// Length over which the mean mode is the mean, m: that of a closed path, else the period.
    pub length: f64,
    /// K/(rho c), m2/s.
    pub diffusivity: f64,
    /// Length of the surface beside the contact, m.
    pub free_length: f64,
    pub convection: f64,
    pub waves: Vec<Wave>,
    /// Wave numbers of the modes, 1/m.
    pub numbers: Vec<f64>,
    pub shapes: Shapes,
    /// Influence of the modes on all pairs of cells.
    pub distance_sum: DistanceSum,
    /// `2 count/L`: weight of a mode's amplitude in the temperature.
    pub weight: Vec<f64>,
    /// State layout of all modes.
    pub state_layout: Vec<Level>,
    pub rate: Vec<f64>,
    pub temperature: Vec<f64>,
    pub distortion: Vec<f64>,
    /// Reduced mean mode (q = 0), per area of strip.
    pub mean: ReducedBody,
    /// Displacement into the body per mean temperature of the mean mode, m/K.
    pub mean_distortion: f64,
    pub expands: bool,
    /// Wave number of the first harmonic without states, 1/m.
    pub unresolved: f64,
    /// The temperature of the base is prescribed.
    pub held: bool,
    /// The contact meets fresh material: no heat that it left behind returns by the modes.
    pub fresh: Option<Fresh>,
    /// The heat that the contact left behind returns as the mean over `length`.
    pub remembers: bool,
    /// Largest `q dv h/8` of the shortest mode at which the influence matrices are those of the mean velocity. The
    /// contribution of such modes to the temperature is below one in a hundred. 0: no interpolation between velocities.
    pub steady: f64,
    pub table: VelocityTable,
    pub robin_correction: Option<RobinCorrection>,
    /// Observation matrices of the real and imaginary amplitudes, the even and odd parts on the cells: (N + 1)/2 rows,
    /// one column per mode.
    pub seen: [Vec<f64>; 2],
    pub error: f64,
}

impl StripOperators {
    /// See [`super::StripHeat::new`].
    pub(crate) fn new(
        properties: &StripProperties,
        cells: &Cells,
        resolution: &Resolution,
        known: &mut Reductions,
    ) -> Result<StripOperators, OutOfRange> {
        let width = 2.0 * cells.half_width();
        properties.check(width)?;
        for (quantity, value) in [("duration", resolution.duration), ("shortest step", resolution.shortest)] {
            OutOfRange::unless(value > 0.0 && value.is_finite(), quantity, value, "positive, in s")?;
        }
        let tolerance = resolution.tolerance.clamp(1e-6, 0.1);
        let resolution = &Resolution { tolerance, ..*resolution };
        let (period, reach) = properties.period(width, resolution);
        let full = width >= period * (1.0 - 1e-9);
        let bare = Slab { surface_transfer: 0.0, ..properties.slab };
        let slab = if full { bare } else { properties.cooled_slab(width) };
        let diffusivity = bare.diffusivity();
        let spacing = 2.0 * PI / period;
        let fresh = properties.fresh(width, resolution).then_some(Fresh { way: 0.25 * period });
        let remembering = properties.remembering(width, period, fresh.is_some());
        let length = remembering.unwrap_or(period);
        let expansion = properties.expansion.as_ref().filter(|expansion| expansion.coefficient != 0.0);
        let widths = cells.widths().to_vec();
        let layer = Layer { properties, width, slab: &slab, period, reach, fresh: fresh.is_some(), tolerance };
        let reduction = known.of((properties, width, resolution), || layer.reduce(resolution));
        let (last, fastest, waves) = (reduction.last, reduction.fastest, reduction.waves.clone());
        let shapes = Shapes::new(cells, &waves);
        let narrowest = widths.iter().copied().fold(f64::INFINITY, f64::min);
        // Lowest velocity at which modes as long as the contact differ from those at rest.
        let slow =
            if fresh.is_some() { diffusivity / period } else { diffusivity * (3.0 / width).min(spacing * last as f64) };
        // Largest velocity times width over diffusivity at which the table over the velocity ends (Peclet number 2.5e6).
        let limit = (60.0 * diffusivity / narrowest).max(100.0 * fastest / spacing).max(1e7 * diffusivity / width);
        let state_layout = state_layout(&reduction.counts);
        let states = reduction.counts.iter().sum();
        let (mut rate, mut temperature, mut distortion) = (vec![0.0; states], vec![0.0; states], vec![0.0; states]);
        // States that a mode does not use stay 0.
        for (wave, mode) in reduction.modes.iter().enumerate() {
            let fastest = mode.rate.iter().copied().fold(0.0, f64::max);
            for (k, place) in of_mode(&state_layout, wave).enumerate() {
                rate[place] = mode.rate.get(k).copied().unwrap_or(fastest);
                temperature[place] = mode.temperature.get(k).copied().unwrap_or(0.0);
                distortion[place] = mode.distortion.get(k).copied().unwrap_or(0.0);
            }
        }
        let products = |other: &[f64]| temperature.iter().zip(other).map(|(b, d)| (b * d).abs()).sum::<f64>();
        let unit = products(&distortion) / products(&temperature);
        let static_correction = StaticCorrection {
            cells: cells.clone(),
            slab,
            bare,
            expansion: expansion.copied(),
            lateral: properties.lateral,
            period,
            reduction: reduction.clone(),
            unit,
            slowest: 2.0 / resolution.duration,
            fresh,
        };
        let table = VelocityTable::new(static_correction, slow, limit, tolerance);
        let mut operators = StripOperators {
            half: shapes.half(),
            distance_sum: DistanceSum::new(cells, &waves, unit),
            length,
            diffusivity,
            free_length: (length - widths.iter().sum::<f64>()).max(0.0),
            convection: slab.surface_transfer,
            weight: waves.iter().map(|wave| 2.0 * wave.count / period).collect(),
            state_layout,
            rate,
            temperature,
            distortion,
            mean: reduction.mean.clone(),
            mean_distortion: expansion.map_or(0.0, |expansion| mean_distortion(properties, expansion)),
            expands: expansion.is_some(),
            unresolved: spacing * (last + 1) as f64,
            held: bare.base == FarBoundary::Held,
            fresh,
            remembers: remembering.is_some(),
            steady: 10.0 * tolerance.min(1e-3),
            table,
            robin_correction: None,
            seen: Default::default(),
            error: reduction.error,
            numbers: waves.iter().map(|wave| wave.number).collect(),
            waves,
            shapes,
            widths,
        };
        operators.seen = std::array::from_fn(|part| {
            let columns = operators.shapes.matrices()[part].chunks_exact(operators.half).zip(&operators.weight);
            let sign = [1.0, -1.0][part];
            columns.flat_map(|(column, weight)| column.iter().map(move |shape| sign * weight * shape)).collect()
        });
        let transfer = slab.surface_transfer;
        if transfer > 0.0 {
            let rank = RobinCorrection::rank(transfer * width / slab.conductivity, tolerance);
            let over_cells = |wave: usize, polynomial: &[f64]| operators.over_cells(wave, |i| polynomial[i]);
            operators.robin_correction =
                Some(RobinCorrection::new(cells, transfer, rank, &operators.weight, over_cells));
        }
        Ok(operators)
    }

    /// Sums over all cells of width times a function times the even and the odd shape of a mode.
    pub(crate) fn over_cells(&self, wave: usize, function: impl Fn(usize) -> f64) -> (f64, f64) {
        let (even, odd) = self.shapes.rows(wave);
        let count = self.widths.len();
        let (mut sum, mut tilt) = (0.0, 0.0);
        for i in 0..count {
            let (at, sign) = if i < self.half { (i, 1.0) } else { (count - 1 - i, -1.0) };
            let value = self.widths[i] * function(i);
            sum += value * even[at];
            tilt += sign * value * odd[at];
        }
        (sum, tilt)
    }

    /// Number of polynomials of the Robin correction; 0 without one.
    pub(crate) fn rank(&self) -> usize {
        self.robin_correction.as_ref().map_or(0, |correction| correction.rank)
    }

    /// Dimensions of a stage response; weights in the states exist for the end of a step only.
    pub(crate) fn response_layout(&self, at_end: bool) -> Layout {
        Layout {
            count: self.widths.len(),
            distorted: self.lagged(),
            states: if at_end { self.rate.len() } else { 0 },
            waves: self.waves.len(),
            rank: self.rank(),
        }
    }

    /// Number of states before those of the Fourier modes: of the mean mode, and on an open path of a second one without the heat of
    /// the contact.
    pub(crate) fn mean_states(&self) -> usize {
        if self.remembers { self.mean.count } else { 2 * self.mean.count }
    }

    /// States of the mean mode that determine the temperature under the contact.
    pub(crate) fn background<'a>(&self, state: &'a [f64]) -> &'a [f64] {
        &state[self.mean_states() - self.mean.count..self.mean_states()]
    }

    /// Fraction of the mean flux whose heat returns to the contact.
    pub(crate) fn remembered(&self) -> f64 {
        if self.remembers { 1.0 } else { 0.0 }
    }

    /// Number of states of the modes, and on fresh material of what they keep of the older stretch.
    pub(crate) fn stretches(&self) -> usize {
        let modes = 2 * self.rate.len();
        if self.fresh.is_some() { 2 * modes + ENDS } else { modes }
    }

    /// Number of states of the distortion that the modes leave out: the flux into each cell, with a lag.
    pub(crate) fn lagged(&self) -> usize {
        if self.expands { self.widths.len() } else { 0 }
    }

    /// Rate at which the distortion that the modes leave out follows the flux, 1/s: that of the first harmonic without states over the
    /// moving strip.
    pub(crate) fn lag_rate(&self, [from, to]: [f64; 2]) -> f64 {
        self.unresolved * (self.diffusivity * self.unresolved + 0.5 * (from.abs() + to.abs()))
    }

    /// See [`Fresh::felt`]; all of the interval where the path is not of fresh material.
    pub(crate) fn felt(&self, length: f64, velocity: [f64; 2]) -> f64 {
        self.fresh.map_or(1.0, |fresh| fresh.felt(length, velocity))
    }

    /// Real and imaginary parts of the states of the modes.
    pub(crate) fn wave_states<'a>(&self, state: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let (first, count) = (self.mean_states(), self.rate.len());
        (&state[first..first + count], &state[first + count..first + 2 * count])
    }

    /// See [`StripOperators::wave_states`].
    pub(crate) fn wave_states_mut<'a>(&self, state: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64]) {
        let (first, count) = (self.mean_states(), self.rate.len());
        state[first..first + 2 * count].split_at_mut(count)
    }

    /// Even and odd parts of the heat (W/m) that fluxes into the cells carry.
    pub(crate) fn fold(&self, flux: &[f64], parts: &mut [Vec<f64>; 2]) {
        let [even, odd] = parts;
        let cells = flux.iter().zip(&self.widths);
        for ((even, odd), ((flux, width), (far, far_width))) in
            even.iter_mut().zip(odd.iter_mut()).zip(cells.clone().zip(cells.rev()))
        {
            let (left, right) = (width * flux, far_width * far);
            (*even, *odd) = (left + right, left - right);
        }
        if flux.len() % 2 == 1 {
            let middle = self.half - 1;
            (even[middle], odd[middle]) = (self.widths[middle] * flux[middle], 0.0);
        }
    }

    /// Heat (W/m) that fluxes into the cells carry, in reverse order; see [`MirroredInfluence`](super::mirrored::MirroredInfluence).
    pub(crate) fn mirror(&self, flux: &[f64], heat: &mut [f64]) {
        let cells = self.widths.iter().zip(flux.iter().rev());
        heat.iter_mut().zip(cells).for_each(|(heat, (width, flux))| *heat = width * flux);
    }

    /// Adds even and odd parts to values on all cells.
    pub(crate) fn unfold_onto(&self, parts: [&[f64]; 2], values: &mut [f64]) {
        let (left, right) = values.split_at_mut(self.half);
        let [even, odd] = parts;
        left.iter_mut().zip(even.iter().zip(odd)).for_each(|(value, (even, odd))| *value += even + odd);
        right.iter_mut().rev().zip(even.iter().zip(odd)).for_each(|(value, (even, odd))| *value += even - odd);
    }

    /// Amplitude of every mode in the fluxes: `sum c_j q_j exp(-iq x_j)`.
    pub(crate) fn transform(&self, flux: &[f64], parts: &mut [Vec<f64>; 2], heat: &mut [Vec<f64>; 2]) {
        self.fold(flux, parts);
        parts[1].iter_mut().for_each(|value| *value = -*value);
        let ([even, odd], [even_part, odd_part], [re, im]) = (self.shapes.transposed(), parts, heat);
        re.fill(0.0);
        im.fill(0.0);
        dense::multiply_add_each([(even, even_part, re), (odd, odd_part, im)]);
    }

    /// Temperature and distortion on the cells: a uniform value each plus the sum of the modes with these amplitudes.
    pub(crate) fn observe(
        &self,
        amplitudes: [&[Vec<f64>; 2]; 2],
        parts: &mut [[Vec<f64>; 2]; 2],
        levels: [f64; 2],
        values: [&mut [f64]; 2],
    ) {
        let [[warm_re, warm_im], [moved_re, moved_im]] = amplitudes;
        parts.iter_mut().flatten().for_each(|part| part.fill(0.0));
        let [[warm_even, warm_odd], [moved_even, moved_odd]] = parts;
        let [even, odd] = &self.seen;
        dense::multiply_add_pair(even, [warm_re, moved_re], [warm_even, moved_even]);
        dense::multiply_add_pair(odd, [warm_im, moved_im], [warm_odd, moved_odd]);
        for ((values, level), [even, odd]) in values.into_iter().zip(levels).zip(parts) {
            values.fill(level);
            self.unfold_onto([even, odd], values);
        }
    }

    /// Adds the sum of the modes with these amplitudes to `values` on the cells: temperature or distortion.
    pub(crate) fn add_modes(&self, amplitude: &[Vec<f64>; 2], parts: &mut [Vec<f64>; 2], values: &mut [f64]) {
        parts.iter_mut().for_each(|part| part.fill(0.0));
        let ([even, odd], [re, im], [even_part, odd_part]) = (&self.seen, amplitude, &mut *parts);
        dense::multiply_add_each([(even, re, even_part), (odd, im, odd_part)]);
        self.unfold_onto([&parts[0], &parts[1]], values);
    }
}

/// Displacement per mean temperature of a uniformly heated strip: `-alpha (1+nu)/(1-nu) h` with restrained elongation
/// (bonded, or closed), `-alpha (1+nu) h` with free elongation.
fn mean_distortion(properties: &StripProperties, expansion: &Expansion) -> f64 {
    let nu = expansion.material.poissons_ratio();
    let free = expansion.base == elasticity::Base::Smooth && !matches!(properties.path, SlidingPath::Closed(_));
    let restrained = if free { 1.0 } else { 1.0 - nu };
    -expansion.coefficient * (1.0 + nu) / restrained * properties.slab.height
}
