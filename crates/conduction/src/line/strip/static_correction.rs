//! Direct feedthrough of the strip as a function of the velocity: the static correction of all that decays fast against
//! the shortest step. Its distortion acts on lagged fluxes ([`super::operators::StripOperators::lag_rate`]).
//!
//! Two parts. For modes with states it is the truncated part `Z - Z_reduced` at the frequency -i q v of a mode at rest
//! in the punch's frame over the moving material, with a real part of up to 2 over the nominal duration: slower heat is not
//! steady. Shorter modes have no states: for them the layer is a half-plane,
//! whose sum from harmonic n + 1 on is the closed form in real space ([`super::moving_kernel`]) less the integral up to
//! the wave number (n + 1/2) 2 pi/L, with the first Euler-Maclaurin correction. What a cooled layer differs from it is added up to
//! the wave number 2 H0/K. All sums over wave numbers are one sum by distance ([`super::distance`]).
//!
//! Theory: docs/theory.md, sections 4.5, 4.10.

use super::depth::{Depth, Expansion};
use super::distance::{DistanceSum, Nodes};
use super::fresh::Fresh;
use super::moving_kernel::MeanKernel;
use super::reduction::Reduction;
use super::waves::{CONTINUOUS, Wave, continuous};
use crate::lateral::Lateral;
use crate::slab::{Slab, principal_root};
use elasticity::Cells;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::PI;
use std::sync::Arc;

/// Data of the sums of the static correction.
#[derive(Debug)]
pub(crate) struct StaticCorrection {
    pub cells: Cells,
    /// The layer with and without heat transfer on its surface.
    pub slab: Slab,
    pub bare: Slab,
    pub expansion: Option<Expansion>,
    /// Conduction out of the plane.
    pub lateral: Option<Lateral>,
    pub period: f64,
    /// Modes with states.
    pub reduction: Arc<Reduction>,
    /// Magnitude of the distortion (m) per temperature (K) of a mode.
    pub unit: f64,
    /// Frequency below which nothing is treated as steady, 1/s.
    pub slowest: f64,
    /// The contact meets fresh material.
    pub fresh: Option<Fresh>,
}

/// Wave number times contact width below which the integrand of the endless path has no further structure.
const LOWEST_WAVE_NUMBER: f64 = 1e-7;
/// Wave number times contact width below which the removed integrand is smooth in the root of the wave number, for
/// sliding by at least twice that in widths during the time of diffusion across the width.
const LONGEST_SLIDING: f64 = 0.5;

/// A sum over wave numbers: the layer at each, and its place among the wave numbers of all sums.
#[derive(Debug, Default)]
struct WaveSum {
    waves: Vec<Wave>,
    layers: Vec<Depth>,
    places: Vec<usize>,
}

impl WaveSum {
    fn iter(&self) -> impl Iterator<Item = (&Wave, &Depth, usize)> {
        self.waves.iter().zip(&self.layers).zip(&self.places).map(|((wave, layer), &place)| (wave, layer, place))
    }
}

/// Wave numbers of all sums, prepared once for all velocities.
#[derive(Debug)]
pub(crate) struct Integrals {
    /// The modes with states.
    modes: WaveSum,
    /// Integral that is subtracted while sliding, or at any velocity on fresh material.
    removed: WaveSum,
    /// Integral that is subtracted at rest over waves long against the contact, in place of the first panel.
    removed_at_rest: WaveSum,
    /// Integral over the waves without states.
    beyond: WaveSum,
    /// The last harmonic with states and the next.
    ends: WaveSum,
    images: bool,
    sum: DistanceSum,
}

/// Responses at the wave numbers of all sums: of temperature, and of distortion with thermal expansion.
#[derive(Debug)]
struct Gains {
    temperature: Vec<Complex<f64>>,
    distortion: Vec<Complex<f64>>,
}

impl Gains {
    fn add(&mut self, place: usize, weight: f64, [temperature, distortion]: [Complex<f64>; 2]) {
        self.temperature[place] += weight * temperature;
        self.distortion[place] += weight * distortion;
    }
}

/// Workspace of the sums.
#[derive(Debug)]
pub(crate) struct CorrectionWorkspace {
    gains: Gains,
    nodes: Nodes,
    source: MeanKernel,
}

impl CorrectionWorkspace {
    /// Workspace for these integrals: nothing is reallocated later.
    pub(crate) fn new(static_correction: &StaticCorrection, integrals: &Integrals) -> CorrectionWorkspace {
        let count = integrals.sum.waves();
        let zeros = || vec![Complex::from(0.0); count];
        CorrectionWorkspace {
            gains: Gains { temperature: zeros(), distortion: zeros() },
            nodes: integrals.sum.nodes(),
            source: MeanKernel::new(static_correction.cells.count()),
        }
    }
}

/// Distortion by flux of a strip that does not expand, m3/W.
const NO_DISTORTION: Complex<f64> = Complex::new(0.0, 0.0);

impl StaticCorrection {
    fn spacing(&self) -> f64 {
        2.0 * PI / self.period
    }

    /// Prepares the quadrature; see [`Integrals`].
    pub(crate) fn integrals(&self) -> Integrals {
        let width = 2.0 * self.cells.half_width();
        let fresh = self.fresh.is_some();
        // Contact width over period beyond which the nearest periodic images of the contact are summed in real space.
        let images = !fresh && width > 0.3 * self.period;
        let reach = if images { width + self.period } else { width };
        let last = (self.reduction.last as f64 + 0.5) * self.spacing();
        let mut end = self.slab.half_plane_from();
        if self.expansion.is_some() {
            // Upper limit of the sum of the distortion, which decreases like 1/q^2, relative to the last wave number with states.
            end = end.max(4.0 * last);
        }
        if let Some(lateral) = &self.lateral {
            end = end.max(lateral.shortest_wave());
        }
        // Beyond it the convection of the surface takes less than half of the flux of a wave.
        end = end.max(2.0 * self.slab.surface_transfer / self.slab.conductivity);
        let layer =
            |slab: &Slab, wave: &Wave| Depth::new(slab, self.expansion.as_ref(), wave.number).spreading(self.lateral);
        let sum = |slab: &Slab, waves: Vec<Wave>| WaveSum {
            layers: waves.iter().map(|wave| layer(slab, wave)).collect(),
            places: Vec::new(),
            waves,
        };
        let mut removed;
        let [mut removed_at_rest, mut beyond, mut ends] = [(); 3].map(|()| WaveSum::default());
        if fresh {
            removed = sum(&self.slab, continuous(LOWEST_WAVE_NUMBER / width, end.max(last), width));
        } else {
            let longest = (LONGEST_SLIDING / width).min(last);
            removed = sum(&self.bare, continuous(longest, last, reach));
            removed_at_rest = sum(&self.bare, continuous(1e-6 / width, longest, reach));
            if end > last {
                beyond = sum(&self.slab, continuous(last, end, reach).split_off(CONTINUOUS));
            }
            ends = sum(
                &self.bare,
                [0, 1].map(|next| self.reduction.last + next).map(|harmonic| self.harmonic(harmonic)).to_vec(),
            );
        }
        let mut modes = sum(&self.slab, self.reduction.waves.clone());
        let waves = arrange([&mut modes, &mut removed, &mut removed_at_rest, &mut beyond, &mut ends]);
        let sum = DistanceSum::new(&self.cells, &waves, self.unit);
        Integrals { modes, removed, removed_at_rest, beyond, ends, images, sum }
    }

    fn harmonic(&self, number: usize) -> Wave {
        Wave { number: self.spacing() * number as f64, count: 1.0 }
    }

    /// Sets the influence on temperature and distortion (N x N each, per flux into a cell; the second is empty without
    /// thermal expansion) at the velocity `velocity` >= 0.
    pub(crate) fn at(
        &self,
        velocity: f64,
        integrals: &Integrals,
        workspace: &mut CorrectionWorkspace,
        influence: &mut [DMatrix<f64>; 2],
    ) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        // At rest the sum of the half-plane diverges at q = 0; at so low a velocity all wave numbers in the sums
        // respond as at rest.
        let moving = velocity.max(1e-4 * diffusivity / self.cells.half_width());
        let CorrectionWorkspace { gains, nodes, source } = workspace;
        gains.temperature.fill(Complex::from(0.0));
        gains.distortion.fill(Complex::from(0.0));
        match self.fresh {
            Some(fresh) => self.add_fresh([velocity, moving], fresh, integrals, gains),
            None => self.add_periodic([velocity, moving], integrals, gains),
        }
        integrals.sum.find([&gains.temperature, &gains.distortion], nodes);
        integrals.sum.set(nodes, self.cells.widths(), [0.0; 2], influence);
        let shifts: &[f64] = if integrals.images { &[0.0, 1.0, -1.0] } else { &[0.0] };
        for shift in shifts {
            source.find(&self.cells, shift * self.period, 0.5 * moving / diffusivity);
            for (j, &width) in self.cells.widths().iter().enumerate() {
                for (i, entry) in influence[0].column_mut(j).iter_mut().enumerate() {
                    *entry += width / (PI * conductivity) * source.mean(i, j);
                }
            }
        }
    }

    /// Response to a heat flux of the frequency `s` (1/s), of temperature and of distortion.
    fn respond(&self, layer: &Depth, s: Complex<f64>) -> [Complex<f64>; 2] {
        if self.expansion.is_some() { layer.respond(s) } else { [layer.impedance(s), NO_DISTORTION] }
    }

    /// Adds what completes the states and the half-plane in real space on a closed path or a stroke.
    fn add_periodic(&self, [velocity, moving]: [f64; 2], integrals: &Integrals, gains: &mut Gains) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        let turning = |q: f64| Complex::new(0.0, -q * moving);
        let half_plane = |q: f64| (principal_root(turning(q) / diffusivity + q * q) * conductivity).inv();
        for ((wave, layer, place), modes) in integrals.modes.iter().zip(&self.reduction.modes) {
            let turning = wave.number * velocity;
            let s = Complex::new(self.lasting(turning), -turning);
            let (exact, reduced) = (self.respond(layer, s), modes.respond(s));
            let distortion = if self.expansion.is_some() { exact[1] - reduced[1] } else { NO_DISTORTION };
            gains.add(place, 2.0 * wave.count / self.period, [exact[0] - reduced[0], distortion]);
        }
        let copies = |q: f64| if integrals.images { 1.0 + 2.0 * (q * self.period).cos() } else { 1.0 };
        let mut remove = |(wave, _, place): (&Wave, &Depth, usize)| {
            let weight = wave.count * copies(wave.number) / PI;
            gains.add(place, weight, [-half_plane(wave.number), NO_DISTORTION]);
        };
        let width = 2.0 * self.cells.half_width();
        if moving * width < 2.0 * LONGEST_SLIDING * diffusivity {
            integrals.removed_at_rest.iter().for_each(&mut remove);
            integrals.removed.iter().skip(CONTINUOUS).for_each(&mut remove);
        } else {
            integrals.removed.iter().for_each(&mut remove);
        }
        for (wave, layer, place) in integrals.beyond.iter() {
            let [temperature, distortion] = self.respond(layer, turning(wave.number));
            let bare = self.lateral.is_none() && self.slab.surface_transfer == 0.0;
            let is_half_plane = bare && wave.number >= self.bare.half_plane_from();
            let temperature = if is_half_plane { Complex::from(0.0) } else { temperature - half_plane(wave.number) };
            gains.add(place, wave.count * copies(wave.number) / PI, [temperature, distortion]);
        }
        // Euler-Maclaurin term f'/24 at the first harmonic of the integral; that of the nearest periodic images is
        // included in their sum.
        let part = if integrals.images { 1.0 - 12.0 / (PI * PI) } else { 1.0 };
        for ((wave, _, place), sign) in integrals.ends.iter().zip([-1.0, 1.0]) {
            let weight = sign * part * 2.0 / (24.0 * self.period);
            gains.add(place, weight, [half_plane(wave.number), NO_DISTORTION]);
        }
    }

    /// Real part of the frequency at which a response that changes with `frequency` (1/s) counts as steady: what is slower than the nominal
    /// duration is not, as the reduction does not follow it.
    fn lasting(&self, frequency: f64) -> f64 {
        self.slowest * self.slowest / (self.slowest + frequency)
    }

    /// Adds the response of the endless path, as an integral over the wave number of the difference of layer and
    /// half-plane, less the response of the states.
    fn add_fresh(&self, [velocity, moving]: [f64; 2], fresh: Fresh, integrals: &Integrals, gains: &mut Gains) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        // A contact too slow to leave its heat behind within the duration is not steady.
        let passing = velocity / fresh.way;
        let lasting = self.lasting(passing);
        let resolved = 10.0 * LOWEST_WAVE_NUMBER / (2.0 * self.cells.half_width()) * moving;
        let lasting = lasting.max(resolved);
        for (wave, layer, place) in integrals.removed.iter() {
            let q = wave.number;
            let half_plane = (principal_root(Complex::new(q * q, -q * moving / diffusivity)) * conductivity).inv();
            let [temperature, distortion] = self.respond(layer, Complex::new(lasting, -q * moving));
            gains.add(place, wave.count / PI, [temperature - half_plane, distortion]);
        }
        for ((wave, _, place), modes) in integrals.modes.iter().zip(&self.reduction.modes) {
            let [temperature, distortion] =
                modes.respond_for(Complex::new(lasting, -wave.number * velocity), passing.recip());
            let distortion = if self.expansion.is_some() { distortion } else { NO_DISTORTION };
            gains.add(place, -2.0 * wave.count / self.period, [temperature, distortion]);
        }
    }
}

/// Wave numbers of all sums in ascending order; notes the place of each.
fn arrange(mut sums: [&mut WaveSum; 5]) -> Vec<Wave> {
    let mut all: Vec<(Wave, usize)> = Vec::new();
    for (owner, sum) in sums.iter_mut().enumerate() {
        sum.places.resize(sum.waves.len(), 0);
        all.extend(sum.waves.iter().map(|wave| (*wave, owner)));
    }
    // Stable: the wave numbers of each sum ascend, and keep their order.
    all.sort_by(|(left, _), (right, _)| left.number.total_cmp(&right.number));
    let mut next = [0; 5];
    for (place, &(_, owner)) in all.iter().enumerate() {
        sums[owner].places[next[owner]] = place;
        next[owner] += 1;
    }
    all.into_iter().map(|(wave, _)| wave).collect()
}
