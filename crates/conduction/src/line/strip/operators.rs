//! What a strip's conduction is made of, built once and shared by every copy.
//!
//! Theory: docs/theory.md, section 4.5.

use super::depth::{Depth, DepthModes, Expansion};
use super::distance::DistanceSum;
use super::error_sweep::ErrorSweep;
use super::kept::Kept;
use super::robin_correction::RobinCorrection;
use super::state_layout::{Level, of_mode, state_layout};
use super::static_correction::StaticCorrection;
use super::velocity_table::VelocityTable;
use super::waves::{Shapes, Wave, harmonics};
use crate::lateral::Lateral;
use crate::reduced::ReducedBody;
use crate::slab::{Base, CoolingPort, Slab};
use elasticity::{self, Cells, OutOfRange};
use numerics::dense;
use std::f64::consts::PI;
use std::sync::Arc;

/// Path of the contact on the strip.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum SlidingPath {
    /// Closed after this length, m (circumference over the number of equal punches); at least the contact's width.
    Closed(f64),
    /// To and fro: the length of one stroke, m, on a strip of this length, m (0: as long as is felt).
    Stroke {
        /// Length of one stroke.
        stroke: f64,
        /// Length of the strip.
        length: f64,
    },
    /// One way, over material that has never been under the contact before.
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
    pub base: Base,
    /// Where the contact goes.
    pub path: SlidingPath,
    /// Thermal expansion; `None`: the surface does not move under heat.
    pub expansion: Option<Expansion>,
    /// Conduction out of the plane; `None`: the strip is as deep as the contact.
    pub lateral: Option<Lateral>,
}

/// What has to be resolved.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resolution {
    /// Longest time over which heat is followed, s.
    pub duration: f64,
    /// Shortest step, s: what decays faster answers at once.
    pub shortest: f64,
    /// Relative error of the contact temperature that the reduction may cost.
    pub tolerance: f64,
    /// Length of the way on fresh material, m; infinite where it is not known.
    pub way: f64,
}

/// Rate by which sliding on fresh material adds to every decay: heat left behind must not come back with the next copy of
/// the contact. Contacts too slow to pass a period within the whole time have nothing to forget.
///
/// `rate = per_length (sqrt(v^2 + slow^2) - slow)`: like `v^2` at rest, like `|v|` beyond, and smooth in between, so that what
/// depends on it can be interpolated through rest.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ImageDamping {
    /// Decays per length, 1/m; 0: a path that remembers.
    pub per_length: f64,
    /// Velocity at which one period takes the whole time, m/s.
    pub slow: f64,
}

/// Change of the velocity, relative to where the rate bends, up to which Simpson's rule finds its mean to 1e-6.
const STRAIGHT: f64 = 0.25;

impl ImageDamping {
    /// Rate at a velocity, 1/s.
    pub fn rate(&self, velocity: f64) -> f64 {
        self.per_length * velocity * velocity / (velocity.hypot(self.slow) + self.slow)
    }

    /// Mean rate over an interval in which the velocity is linear.
    pub fn mean(&self, [from, to]: [f64; 2]) -> f64 {
        if self.per_length == 0.0 {
            return 0.0;
        }
        let middle = 0.5 * (from + to);
        if (to - from).abs() <= STRAIGHT * middle.hypot(self.slow) {
            return (self.rate(from) + 4.0 * self.rate(middle) + self.rate(to)) / 6.0;
        }
        let integral = |v: f64| 0.5 * (v * v.hypot(self.slow) + self.slow * self.slow * (v / self.slow).asinh());
        self.per_length * ((integral(to) - integral(from)) / (to - from) - self.slow)
    }
}

/// See the module.
#[derive(Debug)]
pub struct StripOperators {
    pub widths: Vec<f64>,
    pub half: usize,
    pub period: f64,
    /// K/(rho c), m2/s.
    pub diffusivity: f64,
    /// Length of the surface beside the contact, m.
    pub free_length: f64,
    pub convection: f64,
    pub waves: Vec<Wave>,
    /// Their wave numbers, 1/m.
    pub numbers: Vec<f64>,
    pub shapes: Arc<Shapes>,
    /// Sum over the modes on all pairs of cells.
    pub distance_sum: DistanceSum,
    /// `2 count/L`: what a wave's amplitude counts in the temperature.
    pub weight: Vec<f64>,
    /// Places of the states of all waves.
    pub state_layout: Vec<Level>,
    pub rate: Vec<f64>,
    pub temperature: Vec<f64>,
    pub distortion: Vec<f64>,
    /// The mean wave, per area of strip.
    pub mean: ReducedBody,
    /// Displacement into the body per mean temperature of the mean wave, m/K.
    pub mean_distortion: f64,
    pub expands: bool,
    /// The temperature of the base is prescribed.
    pub held: bool,
    /// The material under the contact has never been there before: heat received does not come back.
    pub fresh: bool,
    pub image_damping: ImageDamping,
    /// Largest `q dv h/8` of the shortest wave at which the gains are those of the mean velocity. Such waves are less than one
    /// in a hundred of the temperature. 0: every step finds its own.
    pub steady: f64,
    pub table: VelocityTable,
    /// Answers of the steps that were prepared, where several probes take them; `None`: every step finds its own.
    pub kept: Option<Kept>,
    pub robin_correction: Option<RobinCorrection>,
    /// Even and odd parts on the cells that a wave's real and imaginary amplitude show: (N + 1)/2 rows, one column per wave.
    pub seen: [Vec<f64>; 2],
    /// Mean over the contact of what a state's real part shows.
    pub contact_mean: Vec<f64>,
    pub error: f64,
}

/// Ratios of the frequencies at which the layer is reduced, tried in this order until the error is small.
const SHIFT_RATIOS: [f64; 7] = [10.0, 7.0, 5.0, 3.8, 3.0, 2.5, 2.1];
/// Part of the tolerance that the reduction of the waves may take.
const REDUCTION_PART: f64 = 0.2;
/// Shortest period of a one-way path, in widths of the contact.
const SHORTEST_WAY: f64 = 12.0;
/// Period of a one-way path that is known and short, over what its contact heats.
const FREE_OF_COPIES: f64 = 1.5;
/// Waves from which on a few are asked first whether a ratio of frequencies will do, and how many of them there are to one of those.
const MANY_WAVES: usize = 200;
const SAMPLED: usize = 8;
/// Largest velocity times width over diffusivity at which the table over the velocity ends (Peclet number 2.5e6).
const FASTEST: f64 = 1e7;
/// Decays over which a one-way path forgets while the contact passes one period.
const FORGOTTEN: f64 = 4.0;
/// Harmonics that always have states.
const FEWEST_HARMONICS: usize = 16;
/// Most harmonics with states.
const MOST_HARMONICS: usize = 8192;

impl StripProperties {
    fn check(&self, width: f64) -> Result<(), OutOfRange> {
        for (quantity, value, requirement) in [
            ("strip height", self.height, "positive, in m"),
            ("strip conductivity", self.conductivity, "positive, in W/(m K)"),
            ("strip heat capacity", self.capacity, "positive, in J/(m3 K)"),
        ] {
            OutOfRange::unless(value > 0.0 && value.is_finite(), quantity, value, requirement)?;
        }
        let convection = self.convection;
        OutOfRange::unless(convection >= 0.0 && convection.is_finite(), "strip convection", convection, "at least 0")?;
        match self.path {
            // Rounding of the width must not refuse full periodic contact.
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

    /// Length of the period, and largest distance between source and observer counted along the material.
    fn period(&self, width: f64, Resolution { duration, way, .. }: &Resolution) -> (f64, f64) {
        let mut reach = (self.conductivity / self.capacity * *duration).sqrt();
        if self.convection > 0.0 {
            reach = reach.min((self.conductivity * self.height / self.convection).sqrt());
        }
        if self.base == Base::Held {
            reach = reach.min(self.height);
        }
        match self.path {
            SlidingPath::Closed(length) => (length.max(width), f64::INFINITY),
            // A stroke longer than planned still finds its own track.
            SlidingPath::Stroke { stroke, length } => {
                ((stroke + width + 8.0 * reach).max(length), width + 1.5 * stroke)
            }
            SlidingPath::Unidirectional => {
                // On a short way no copy of the contact comes near heat that is not its own.
                let apart = FREE_OF_COPIES * (width + way + 8.0 * reach);
                ((width + 8.0 * reach).max(apart.min(SHORTEST_WAY * width)), f64::INFINITY)
            }
        }
    }
}

impl StripOperators {
    /// See [`super::StripHeat::new`].
    pub fn new(
        properties: &StripProperties,
        cells: &Cells,
        resolution: &Resolution,
    ) -> Result<StripOperators, OutOfRange> {
        let width = 2.0 * cells.half_width();
        properties.check(width)?;
        for (quantity, value) in [("duration", resolution.duration), ("shortest step", resolution.shortest)] {
            OutOfRange::unless(value > 0.0 && value.is_finite(), quantity, value, "positive, in s")?;
        }
        let tolerance = resolution.tolerance.clamp(1e-6, 0.1);
        let (period, reach) = properties.period(width, resolution);
        let full = width >= period * (1.0 - 1e-9);
        let bare = Slab {
            height: properties.height,
            conductivity: properties.conductivity,
            capacity: properties.capacity,
            surface_transfer: 0.0,
            volume_transfer: 0.0,
            base: properties.base,
            cooling: CoolingPort::Surface,
        };
        let convection = if full { 0.0 } else { properties.convection };
        let slab = Slab { surface_transfer: convection, ..bare };
        let diffusivity = bare.diffusivity();
        let spacing = 2.0 * PI / period;
        let fastest = (0.7 * (1e-3 / tolerance).powf(0.4)).clamp(0.5, 20.0) / resolution.shortest;
        let shortest_wave = (fastest / diffusivity).sqrt();
        let last = ((shortest_wave / spacing).ceil() as usize).clamp(FEWEST_HARMONICS, MOST_HARMONICS);
        let fresh = properties.path == SlidingPath::Unidirectional;
        let forgets = fresh && width + resolution.way > period;
        let image_damping = ImageDamping {
            per_length: if forgets { FORGOTTEN / period } else { 0.0 },
            slow: period / resolution.duration,
        };
        let mut waves = harmonics(period, last, reach);
        if fresh {
            // Neighbouring copies of the contact with opposite signs: no mean, and the midpoint rule of the endless path.
            waves.iter_mut().for_each(|wave| wave.number -= 0.5 * spacing);
        }
        let shapes = Arc::new(Shapes::new(cells, &waves));
        let expansion = properties.expansion.as_ref().filter(|expansion| expansion.coefficient != 0.0);
        let widths = cells.widths().to_vec();
        let mean = slab.reduce(resolution.duration, tolerance);
        let layers: Vec<Depth> =
            waves.iter().map(|wave| Depth::new(&slab, expansion, wave.number).spreading(properties.lateral)).collect();
        let error_sweep =
            ErrorSweep::new(cells, &slab, (!fresh).then_some(&mean), period, (&waves, &layers), &shapes, resolution);
        let mut modes: Vec<DepthModes> = Vec::new();
        let mut error = f64::INFINITY;
        for ratio in SHIFT_RATIOS {
            let reduce = |step: usize| -> Vec<DepthModes> {
                let layers = layers.iter().step_by(step);
                layers.map(|depth| depth.reduce(0.03 / resolution.duration, 4.0 * fastest, ratio)).collect()
            };
            let good = |error: f64| error <= REDUCTION_PART * tolerance;
            // Neighbouring waves have neighbouring errors; the last ratio is taken as it is.
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
        let narrowest = widths.iter().copied().fold(f64::INFINITY, f64::min);
        // The slowest motion that the waves as long as the contact can tell from rest.
        let slow = if fresh { diffusivity / period } else { diffusivity * (3.0 / width).min(spacing * last as f64) };
        let limit = (60.0 * diffusivity / narrowest).max(100.0 * fastest / spacing).max(FASTEST * diffusivity / width);
        // As many states as any shorter wave has: those it does not need stay 0.
        let mut counts: Vec<usize> = modes.iter().map(|mode| mode.rate.len()).collect();
        for wave in (1..counts.len()).rev() {
            counts[wave - 1] = counts[wave - 1].max(counts[wave]);
        }
        let state_layout = state_layout(&counts);
        let states = counts.iter().sum();
        let (mut rate, mut temperature, mut distortion) = (vec![0.0; states], vec![0.0; states], vec![0.0; states]);
        for (wave, mode) in modes.iter().enumerate() {
            let fastest = mode.rate.iter().copied().fold(0.0, f64::max);
            for (k, place) in of_mode(&state_layout, wave).enumerate() {
                rate[place] = mode.rate.get(k).copied().unwrap_or(fastest);
                temperature[place] = mode.temperature.get(k).copied().unwrap_or(0.0);
                distortion[place] = mode.distortion.get(k).copied().unwrap_or(0.0);
            }
        }
        let static_correction = StaticCorrection {
            cells: cells.clone(),
            slab,
            bare,
            expansion: expansion.copied(),
            lateral: properties.lateral,
            period,
            last,
            waves: waves.clone(),
            shapes: shapes.clone(),
            modes,
            fresh: fresh.then_some((2.0 / resolution.duration, image_damping)),
        };
        let table = VelocityTable::new(static_correction, slow, limit, tolerance);
        let products = |other: &[f64]| temperature.iter().zip(other).map(|(b, d)| (b * d).abs()).sum::<f64>();
        let unit = products(&distortion) / products(&temperature);
        let mut operators = StripOperators {
            half: shapes.half(),
            distance_sum: DistanceSum::new(cells, &waves, unit),
            period,
            diffusivity,
            free_length: (period - widths.iter().sum::<f64>()).max(0.0),
            convection,
            weight: waves.iter().map(|wave| 2.0 * wave.count / period).collect(),
            state_layout,
            rate,
            temperature,
            distortion,
            mean,
            mean_distortion: expansion.map_or(0.0, |expansion| mean_distortion(properties, expansion)),
            expands: expansion.is_some(),
            held: properties.base == Base::Held,
            fresh,
            image_damping,
            steady: 10.0 * tolerance.min(1e-3),
            table,
            kept: None,
            robin_correction: None,
            seen: Default::default(),
            contact_mean: Vec::new(),
            error,
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
        operators.contact_mean = vec![0.0; operators.rate.len()];
        for wave in 0..operators.waves.len() {
            let mean = operators.weight[wave] * operators.over_cells(wave, |_| 1.0).0 / width;
            for k in of_mode(&operators.state_layout, wave) {
                operators.contact_mean[k] = mean * operators.temperature[k];
            }
        }
        if convection > 0.0 {
            operators.robin_correction = Some(RobinCorrection::new(cells, convection, &operators));
        }
        Ok(operators)
    }

    /// Sums over all cells of width times a function times a wave's even and odd shape.
    pub fn over_cells(&self, wave: usize, function: impl Fn(usize) -> f64) -> (f64, f64) {
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

    /// Number of states before those of the waves: of the mean wave, and on fresh material once more without the contact.
    pub fn mean_states(&self) -> usize {
        if self.fresh { 2 * self.mean.count } else { self.mean.count }
    }

    /// States of the mean wave that the contact zone sees.
    pub fn background<'a>(&self, state: &'a [f64]) -> &'a [f64] {
        &state[self.mean_states() - self.mean.count..self.mean_states()]
    }

    /// Part of the mean flux that the contact zone sees again.
    pub fn remembered(&self) -> f64 {
        if self.fresh { 0.0 } else { 1.0 }
    }

    /// Real and imaginary parts of the waves' states.
    pub fn wave_states<'a>(&self, state: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let (first, count) = (self.mean_states(), self.rate.len());
        (&state[first..first + count], &state[first + count..first + 2 * count])
    }

    /// See [`StripOperators::wave_states`].
    pub fn wave_states_mut<'a>(&self, state: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64]) {
        let (first, count) = (self.mean_states(), self.rate.len());
        state[first..first + 2 * count].split_at_mut(count)
    }

    /// Even and odd parts of the heat (W/m) that fluxes into the cells carry.
    pub fn fold(&self, flux: &[f64], parts: &mut [Vec<f64>; 2]) {
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

    /// Adds even and odd parts to values on all cells.
    pub fn unfold_onto(&self, parts: [&[f64]; 2], values: &mut [f64]) {
        let (left, right) = values.split_at_mut(self.half);
        let [even, odd] = parts;
        left.iter_mut().zip(even.iter().zip(odd)).for_each(|(value, (even, odd))| *value += even + odd);
        right.iter_mut().rev().zip(even.iter().zip(odd)).for_each(|(value, (even, odd))| *value += even - odd);
    }

    /// Amplitude of every wave in the fluxes: `sum c_j q_j exp(-iq x_j)`.
    pub fn transform(&self, flux: &[f64], parts: &mut [Vec<f64>; 2], heat: &mut [Vec<f64>; 2]) {
        self.fold(flux, parts);
        parts[1].iter_mut().for_each(|value| *value = -*value);
        let ([even, odd], [even_part, odd_part], [re, im]) = (self.shapes.transposed(), parts, heat);
        re.fill(0.0);
        im.fill(0.0);
        dense::multiply_add_each([(even, even_part, re), (odd, odd_part, im)]);
    }

    /// Values on the cells, of temperature and distortion: a level each plus what the waves of these amplitudes give.
    pub fn observe(
        &self,
        amplitudes: [&[Vec<f64>; 2]; 2],
        parts: &mut [[Vec<f64>; 2]; 2],
        state_layout: [f64; 2],
        values: [&mut [f64]; 2],
    ) {
        let [[warm_re, warm_im], [moved_re, moved_im]] = amplitudes;
        parts.iter_mut().flatten().for_each(|part| part.fill(0.0));
        let [[warm_even, warm_odd], [moved_even, moved_odd]] = parts;
        let [even, odd] = &self.seen;
        dense::multiply_add_pair(even, [warm_re, moved_re], [warm_even, moved_even]);
        dense::multiply_add_pair(odd, [warm_im, moved_im], [warm_odd, moved_odd]);
        for ((values, level), [even, odd]) in values.into_iter().zip(state_layout).zip(parts) {
            values.fill(level);
            self.unfold_onto([even, odd], values);
        }
    }

    /// One of them.
    pub fn observe_one(&self, amplitude: &[Vec<f64>; 2], parts: &mut [Vec<f64>; 2], level: f64, values: &mut [f64]) {
        parts.iter_mut().for_each(|part| part.fill(0.0));
        let ([even, odd], [re, im], [even_part, odd_part]) = (&self.seen, amplitude, &mut *parts);
        dense::multiply_add_each([(even, re, even_part), (odd, im, odd_part)]);
        values.fill(level);
        self.unfold_onto([&parts[0], &parts[1]], values);
    }
}

/// Displacement per mean temperature of a uniformly heated strip: `-alpha (1+nu)/(1-nu) h` where it cannot get longer (bonded,
/// or closed), `-alpha (1+nu) h` where it can.
fn mean_distortion(properties: &StripProperties, expansion: &Expansion) -> f64 {
    let nu = expansion.material.poissons_ratio();
    let free = expansion.base == elasticity::Base::Smooth && !matches!(properties.path, SlidingPath::Closed(_));
    let restrained = if free { 1.0 } else { 1.0 - nu };
    -expansion.coefficient * (1.0 + nu) / restrained * properties.height
}
