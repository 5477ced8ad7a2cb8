//! Direct feedthrough of the strip as a function of the velocity: the static correction of all that decays fast against
//! the shortest step.
//!
//! Two parts. For modes with states it is the truncated part `Z - Z_reduced` at the frequency -i q v of a mode at rest
//! in the punch's frame over the moving material. Shorter modes have no states: for them the layer is a half-plane,
//! whose sum from harmonic n + 1 on is the closed form in real space ([`super::moving_kernel`]) less the integral up to
//! the wave number (n + 1/2) 2 pi/L, with the first Euler-Maclaurin correction.
//!
//! Theory: docs/theory.md, sections 4.5, 4.10.

use super::blocks::Blocks;
use super::depth::{Depth, DepthModes, Expansion};
use super::moving_kernel::MovingSource;
use super::operators::ImageDamping;
use super::passive::Passive;
use super::waves::{CONTINUOUS, Shapes, Wave, continuous};
use crate::lateral::Lateral;
use crate::slab::{Slab, principal_root};
use elasticity::Cells;
use nalgebra::Complex;
use std::f64::consts::PI;
use std::sync::Arc;

/// Data of the sums of the static correction.
#[derive(Debug)]
pub struct StaticCorrection {
    pub cells: Cells,
    /// The layer with and without heat transfer on its surface.
    pub slab: Slab,
    pub bare: Slab,
    pub expansion: Option<Expansion>,
    /// Conduction out of the plane.
    pub lateral: Option<Lateral>,
    pub period: f64,
    /// Number of the last harmonic that has states.
    pub last: usize,
    pub waves: Vec<Wave>,
    pub shapes: Arc<Shapes>,
    pub modes: Vec<DepthModes>,
    /// On fresh material: frequency below which nothing is treated as steady, 1/s, and the damping of periodic images.
    pub fresh: Option<(f64, ImageDamping)>,
}

/// Contact width over period beyond which the nearest periodic images of the contact are summed in real space.
const NEAR_IMAGES: f64 = 0.3;
/// q h beyond which the layer equals a half-plane: 2 exp(-2 q h) = 5e-16.
const HALF_PLANE: f64 = 18.0;
/// Wave number times contact width below which the integrand of the endless path has no further structure.
const SLOWEST_WAVE: f64 = 1e-7;
/// Wave number times contact width below which the removed integrand is smooth in the root of the wave number, for
/// sliding by at least twice that in widths during the time of diffusion across the width.
const LONGEST_SLIDING: f64 = 0.5;
/// Upper limit of the sum of the distortion, which decreases like 1/q^2, relative to the last wave number with states.
const DISTORTION_REACH: f64 = 4.0;

/// Quadrature nodes of an integral over the wave number.
#[derive(Debug)]
struct Integral {
    waves: Vec<Wave>,
    shapes: Shapes,
    /// The layer at each node.
    depths: Vec<Depth>,
}

impl Integral {
    fn new(
        cells: &Cells,
        slab: &Slab,
        expansion: Option<&Expansion>,
        waves: Vec<Wave>,
        lateral: Option<Lateral>,
    ) -> Integral {
        Integral {
            shapes: Shapes::new(cells, &waves),
            depths: waves.iter().map(|wave| Depth::new(slab, expansion, wave.number).spreading(lateral)).collect(),
            waves,
        }
    }

    fn iter(&self) -> impl Iterator<Item = (&Wave, &Depth)> {
        self.waves.iter().zip(&self.depths)
    }
}

/// Quadrature nodes of the integrals, prepared once for all velocities.
#[derive(Debug)]
pub struct Integrals {
    /// The layer at the wave numbers of the modes with states.
    depths: Vec<Depth>,
    /// Integral that is subtracted while sliding, or at any velocity on fresh material.
    removed: Integral,
    /// Integral that is subtracted at rest over waves long against the contact, in place of the first panel.
    removed_at_rest: Option<Integral>,
    beyond: Integral,
    /// The last harmonic with states and the next.
    ends: Shapes,
    images: bool,
}

/// Amplification of the waves of one sum: of temperature, and of distortion with thermal expansion.
#[derive(Debug, Default)]
struct Sums {
    warm: Vec<Complex<f64>>,
    moved: Vec<Complex<f64>>,
    terms: Vec<f64>,
}

impl Sums {
    fn push(&mut self, warm: Complex<f64>, moved: Option<Complex<f64>>, weight: f64) {
        self.warm.push(warm * weight);
        self.moved.extend(moved.map(|gain| gain * weight));
    }

    /// Adds the sums over these waves to the influence, and clears them.
    fn add_to(&mut self, shapes: &Shapes, temperature: &mut Blocks, distortion: &mut Blocks) {
        self.terms.resize(self.warm.len(), 0.0);
        if self.warm.iter().any(|gain| *gain != Complex::from(0.0)) {
            temperature.add_waves(&self.warm, shapes, &mut self.terms);
        }
        if !self.moved.is_empty() {
            distortion.add_waves(&self.moved, shapes, &mut self.terms);
        }
        self.warm.clear();
        self.moved.clear();
    }
}

/// Workspace of the sums.
#[derive(Debug)]
pub struct Workspace {
    sums: Sums,
    source: MovingSource,
    pub passive: Passive,
}

impl Workspace {
    /// Workspace for these integrals: nothing is reallocated later.
    pub fn new(static_correction: &StaticCorrection, integrals: &Integrals) -> Workspace {
        let at_rest = integrals.removed_at_rest.as_ref().map_or(0, |integral| integral.waves.len());
        let counts =
            [static_correction.waves.len(), integrals.removed.waves.len(), at_rest, integrals.beyond.waves.len()];
        let most = counts.into_iter().max().unwrap_or(0);
        Workspace {
            sums: Sums {
                warm: Vec::with_capacity(most),
                moved: Vec::with_capacity(most),
                terms: Vec::with_capacity(most),
            },
            source: MovingSource::new(static_correction.cells.count()),
            passive: Passive::new(static_correction.shapes.half()),
        }
    }
}

impl StaticCorrection {
    fn spacing(&self) -> f64 {
        2.0 * PI / self.period
    }

    /// Prepares the quadrature; see [`Integrals`].
    pub fn integrals(&self) -> Integrals {
        let width = 2.0 * self.cells.half_width();
        let fresh = self.fresh.is_some();
        let images = !fresh && width > NEAR_IMAGES * self.period;
        let reach = if images { width + self.period } else { width };
        let last = (self.last as f64 + 0.5) * self.spacing();
        let mut end = HALF_PLANE / self.slab.height;
        if self.expansion.is_some() {
            end = end.max(DISTORTION_REACH * last);
        }
        if let Some(lateral) = &self.lateral {
            end = end.max(lateral.shortest_wave());
        }
        let expansion = self.expansion.as_ref();
        let integral = |slab: &Slab, waves: Vec<Wave>| Integral::new(&self.cells, slab, expansion, waves, self.lateral);
        let (removed, removed_at_rest, beyond) = if fresh {
            (integral(&self.slab, continuous(SLOWEST_WAVE / width, end.max(last), width)), None, Vec::new())
        } else {
            let beyond = if end > last { continuous(last, end, reach).split_off(CONTINUOUS) } else { Vec::new() };
            let longest = (LONGEST_SLIDING / width).min(last);
            let at_rest = integral(&self.bare, continuous(1e-6 / width, longest, reach));
            (integral(&self.bare, continuous(longest, last, reach)), Some(at_rest), beyond)
        };
        let ends = [self.last, self.last + 1].map(|harmonic| self.harmonic(harmonic));
        Integrals {
            depths: (self.waves.iter())
                .map(|wave| Depth::new(&self.slab, expansion, wave.number).spreading(self.lateral))
                .collect(),
            removed,
            removed_at_rest,
            beyond: integral(&self.bare, beyond),
            ends: Shapes::new(&self.cells, &ends),
            images,
        }
    }

    fn harmonic(&self, number: usize) -> Wave {
        Wave { number: self.spacing() * number as f64, count: 1.0 }
    }

    /// Influence on temperature and distortion per heat at the velocity `velocity` >= 0.
    pub fn at(
        &self,
        velocity: f64,
        integrals: &Integrals,
        workspace: &mut Workspace,
        temperature: &mut Blocks,
        distortion: &mut Blocks,
    ) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        temperature.clear();
        distortion.clear();
        // At rest the sum of the half-plane diverges at q = 0; at so low a velocity all wave numbers in the sums
        // respond as at rest.
        let slow = 1e-4 * diffusivity / self.cells.half_width();
        let moving = velocity.max(slow);
        let turning = |q: f64| Complex::new(0.0, -q * moving);
        let half_plane = |q: f64| (principal_root(turning(q) / diffusivity + q * q) * conductivity).inv();
        if let Some(fresh) = self.fresh {
            self.add_fresh(velocity, moving, fresh, integrals, workspace, [temperature, distortion]);
            return;
        }
        let Workspace { sums, source, .. } = workspace;
        let expands = self.expansion.is_some();
        for ((wave, depth), modes) in self.waves.iter().zip(&integrals.depths).zip(&self.modes) {
            let s = Complex::new(0.0, -wave.number * velocity);
            let weight = 2.0 * wave.count / self.period;
            let (exact, reduced) = (depth.respond(s), modes.respond(s));
            sums.push(exact[0] - reduced[0], expands.then(|| exact[1] - reduced[1]), weight);
        }
        sums.add_to(&self.shapes, temperature, distortion);
        let shifts: &[f64] = if integrals.images { &[0.0, 1.0, -1.0] } else { &[0.0] };
        for shift in shifts {
            source.find(&self.cells, shift * self.period, 0.5 * moving / diffusivity);
            temperature.add_kernel(self.cells.count(), |i, j| source.mean(i, j) / (PI * conductivity));
        }
        let copies = |q: f64| if integrals.images { 1.0 + 2.0 * (q * self.period).cos() } else { 1.0 };
        let width = 2.0 * self.cells.half_width();
        let resting = moving * width < 2.0 * LONGEST_SLIDING * diffusivity;
        let mut remove = |integral: &Integral, first: usize, sums: &mut Sums| {
            for (at, wave) in integral.waves.iter().enumerate() {
                let gain = if at < first { Complex::from(0.0) } else { -half_plane(wave.number) };
                sums.push(gain, None, wave.count * copies(wave.number) / PI);
            }
            sums.add_to(&integral.shapes, temperature, distortion);
        };
        match &integrals.removed_at_rest {
            Some(at_rest) if resting => {
                remove(at_rest, 0, sums);
                remove(&integrals.removed, CONTINUOUS, sums);
            }
            _ => remove(&integrals.removed, 0, sums),
        }
        for (wave, depth) in integrals.beyond.iter() {
            let s = turning(wave.number);
            let felt = self.lateral.is_some() || wave.number * self.bare.height < HALF_PLANE;
            let [gain, moved] = if expands { depth.respond(s) } else { [depth.impedance(s), Complex::from(0.0)] };
            let gain = if felt { gain - half_plane(wave.number) } else { Complex::from(0.0) };
            sums.push(gain, expands.then_some(moved), wave.count * copies(wave.number) / PI);
        }
        sums.add_to(&integrals.beyond.shapes, temperature, distortion);
        self.correct_ends(integrals, &half_plane, temperature);
    }

    /// Response of the endless path, in real space for the half-plane and as an integral over the wave number for the
    /// difference of the layer, less the response of the states.
    fn add_fresh(
        &self,
        velocity: f64,
        moving: f64,
        (slowest, image_damping): (f64, ImageDamping),
        integrals: &Integrals,
        workspace: &mut Workspace,
        [temperature, distortion]: [&mut Blocks; 2],
    ) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        let Workspace { sums, source, .. } = workspace;
        let expands = self.expansion.is_some();
        // With damping of periodic images the states are steady by themselves; contacts too slow for it within the
        // duration are not, and their states are exact.
        let forgotten = image_damping.rate(velocity);
        let lasting = slowest * slowest / (slowest + forgotten);
        // Decay rate with which the response of the states is subtracted: a smaller one would make the direct
        // feedthrough negative.
        let lost = forgotten.hypot(lasting);
        let resolved = 10.0 * SLOWEST_WAVE / (2.0 * self.cells.half_width()) * moving;
        let lasting = lasting.max(resolved);
        source.find(&self.cells, 0.0, 0.5 * moving / diffusivity);
        temperature.add_kernel(self.cells.count(), |i, j| source.mean(i, j) / (PI * conductivity));
        for (wave, depth) in integrals.removed.iter() {
            let q = wave.number;
            let s = Complex::new(lasting, -q * moving);
            let half_plane = (principal_root(Complex::new(q * q, -q * moving / diffusivity)) * conductivity).inv();
            let [gain, moved] = depth.respond(s);
            sums.push(gain - half_plane, expands.then_some(moved), wave.count / PI);
        }
        sums.add_to(&integrals.removed.shapes, temperature, distortion);
        for (wave, modes) in self.waves.iter().zip(&self.modes) {
            let s = Complex::new(lost, -wave.number * velocity);
            let weight = 2.0 * wave.count / self.period;
            let [warm, moved] = modes.respond(s);
            sums.push(-warm, expands.then_some(-moved), weight);
        }
        sums.add_to(&self.shapes, temperature, distortion);
    }

    /// Euler-Maclaurin term f'/24 at the first harmonic of the integral; that of the nearest periodic images is
    /// included in their sum.
    fn correct_ends(&self, integrals: &Integrals, response: &dyn Fn(f64) -> Complex<f64>, blocks: &mut Blocks) {
        let part = if integrals.images { 1.0 - 12.0 / (PI * PI) } else { 1.0 };
        for (end, (harmonic, sign)) in [(self.last, -1.0), (self.last + 1, 1.0)].into_iter().enumerate() {
            let (even, odd) = integrals.ends.rows(end);
            let gain = response(self.harmonic(harmonic).number) * (sign * part * 2.0 / (24.0 * self.period));
            blocks.add_wave(gain, even, odd);
        }
    }
}
