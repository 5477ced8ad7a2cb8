//! What answers at once: everything that decays fast against the shortest step, as a function of the velocity.
//!
//! Two parts. Waves that have states lack the depth modes that were left out, which answer `Z - Z_reduced` at the
//! frequency -i q v with which a wave at rest in the punch's frame turns over the material. Shorter waves have no states: on them
//! the layer is a half-plane, whose sum from harmonic n + 1 on is the closed form in real space ([`super::moving_kernel`]) less
//! the integral up to the wave number (n + 1/2) 2 pi/L, with the first correction of Euler and Maclaurin.

use super::depth::{Depth, DepthModes, Expansion};
use super::moving_kernel::MovingSource;
use super::operators::Forgetting;
use super::waves::{CONTINUOUS, Shapes, Wave, continuous};
use crate::contact::dense;
use crate::elastic::Cells;
use crate::heat::slab::{Slab, principal_root};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Col, Mat, Par};
use nalgebra::{Complex, DMatrix};
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

/// A translation-invariant response on symmetric cells, per heat (W/m) into a cell, split by parity.
///
/// Three blocks of ((N + 1)/2)^2 rows by rows: even answers to even heat, even to odd, odd to odd. Odd to even is minus the
/// transpose of even to odd. Reversing the velocity changes the sign of the middle block, and transposes: the outer ones are
/// symmetric.
#[derive(Clone, PartialEq, Debug)]
pub struct Blocks {
    half: usize,
    /// The three blocks.
    pub values: Vec<f64>,
}

impl Blocks {
    /// No response.
    pub fn zeros(half: usize) -> Blocks {
        Blocks { half, values: vec![0.0; 3 * half * half] }
    }

    /// Adds Re of `gain exp(iq(x - s))`.
    pub fn add_wave(&mut self, gain: Complex<f64>, even: &[f64], odd: &[f64]) {
        let size = self.half * self.half;
        let (even_even, rest) = self.values.split_at_mut(size);
        let (even_odd, odd_odd) = rest.split_at_mut(size);
        for a in 0..self.half {
            let row = a * self.half..(a + 1) * self.half;
            let (ee, eo, oo) = (gain.re * even[a], gain.im * even[a], gain.re * odd[a]);
            for (value, other) in even_even[row.clone()].iter_mut().zip(even) {
                *value += ee * other;
            }
            for (value, other) in even_odd[row.clone()].iter_mut().zip(odd) {
                *value += eo * other;
            }
            for (value, other) in odd_odd[row].iter_mut().zip(odd) {
                *value += oo * other;
            }
        }
    }

    /// Adds Re of `gain exp(iq(x - s))` for every wave; `terms` is room for a number each.
    pub fn add_waves(&mut self, gains: &[Complex<f64>], shapes: &Shapes, terms: &mut [f64]) {
        let (half, size, count) = (self.half, self.half * self.half, gains.len());
        let ([even, odd], [even_by_cell, odd_by_cell]) = (shapes.matrices(), shapes.transposed());
        let (even_even, rest) = self.values.split_at_mut(size);
        let (even_odd, odd_odd) = rest.split_at_mut(size);
        // Few cells leave lanes of the vector unit empty, many waves do not; and what is symmetric is found once, from `first` on.
        let few = half < FEW_CELLS;
        let multiply = |by_wave: &[f64], by_cell: &[f64], terms: &[f64], row: &mut [f64], first: usize| match few {
            true => dense::multiply_transposed_add(&by_cell[first * count..], terms, &mut row[first..]),
            false => dense::multiply_add(by_wave, terms, row),
        };
        for a in 0..half {
            let (row, cell) = (a * half..(a + 1) * half, a * count..(a + 1) * count);
            let (even_here, odd_here) = (&even_by_cell[cell.clone()], &odd_by_cell[cell]);
            for (term, (gain, shape)) in terms.iter_mut().zip(gains.iter().zip(even_here)) {
                *term = gain.re * shape;
            }
            multiply(even, even_by_cell, terms, &mut even_even[row.clone()], a);
            for (term, (gain, shape)) in terms.iter_mut().zip(gains.iter().zip(even_here)) {
                *term = gain.im * shape;
            }
            multiply(odd, odd_by_cell, terms, &mut even_odd[row.clone()], 0);
            for (term, (gain, shape)) in terms.iter_mut().zip(gains.iter().zip(odd_here)) {
                *term = gain.re * shape;
            }
            multiply(odd, odd_by_cell, terms, &mut odd_odd[row], a);
            if few {
                for b in a + 1..half {
                    even_even[b * half + a] = even_even[a * half + b];
                    odd_odd[b * half + a] = odd_odd[a * half + b];
                }
            }
        }
    }

    /// Adds a kernel given by its mean over pairs of cells (answering, heated).
    pub fn add_kernel(&mut self, count: usize, kernel: impl Fn(usize, usize) -> f64) {
        let size = self.half * self.half;
        for a in 0..self.half {
            for b in 0..self.half {
                let (mirror_a, mirror_b) = (count - 1 - a, count - 1 - b);
                let (k, l) = (kernel(a, b), kernel(a, mirror_b));
                let (m, n) = (kernel(mirror_a, b), kernel(mirror_a, mirror_b));
                let at = a * self.half + b;
                self.values[at] += 0.25 * (k + l + m + n);
                self.values[size + at] += 0.25 * (k - l + m - n);
                self.values[2 * size + at] += 0.25 * (k - l - m + n);
            }
        }
    }

    /// Sets an N x N matrix to the response per flux (W/m2), with `level` more of it everywhere; `turned` is room for a block
    /// and a row of it.
    pub fn unfold(&self, widths: &[f64], level: f64, turned: &mut [f64], matrix: &mut DMatrix<f64>) {
        struct Unfold<'a>(&'a Blocks, &'a [f64], f64, &'a mut [f64], &'a mut [f64]);
        impl WithSimd for Unfold<'_> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) {
                let Self(blocks, widths, level, turned, values) = self;
                let (half, count) = (blocks.half, widths.len());
                let (turned, mirrored) = turned.split_at_mut(half * half);
                let (even, rest) = blocks.values.split_at(half * half);
                let (mixed, odd) = rest.split_at(half * half);
                // The middle block by columns, a few of them at a time.
                for first in (0..half).step_by(TILE) {
                    let tile = TILE.min(half - first);
                    for a in 0..half {
                        for (b, value) in mixed[a * half + first..][..tile].iter().enumerate() {
                            turned[(first + b) * half + a] = *value;
                        }
                    }
                }
                for b in 0..half {
                    let row = b * half..(b + 1) * half;
                    let parts = [&even[row.clone()], &turned[row.clone()], &mixed[row.clone()], &odd[row]];
                    for (at, sign) in [(count - 1 - b, -1.0), (b, 1.0)] {
                        let target = &mut values[at * count..(at + 1) * count];
                        column(simd, parts, [sign, widths[b], level], mirrored, target);
                    }
                }
            }
        }
        let (expected, size) = ((widths.len(), widths.len()), (self.half + 1) * self.half);
        assert!(matrix.shape() == expected && self.half == widths.len().div_ceil(2), "N x N, of N cells");
        Arch::new().dispatch(Unfold(self, widths, level, &mut turned[..size], matrix.as_mut_slice()));
    }

    /// Leaves out what depends on the direction of sliding.
    pub fn make_symmetric(&mut self) {
        let size = self.half * self.half;
        self.values[size..2 * size].fill(0.0);
    }

    /// Takes away what would give more heat back than it is given: negative eigenvalues of the symmetric part, which is that of the
    /// even and of the odd half.
    ///
    /// What a reduction leaves out at a frequency just beyond its range has a real part of either sign. As an answer at
    /// once, a negative one lets two bodies that exchange heat raise each other's flux without end in steps short
    /// against the range; what is taken away is below the reduction's own error.
    ///
    /// The answer M c to a uniform flux, which has the even heat c = `uniform`, stays as it is where c'M c > 0: of
    ///
    /// ```text
    /// M = u u'/(c'u) + S,    u = M c,    S c = 0
    /// ```
    ///
    /// only S loses eigenvalues. So the steady mean temperature stays exact, and smooth in the velocity. Where u has turned away
    /// from c, the share of u u' fades out: it would stand for a large answer to everything else.
    pub fn make_passive(&mut self, uniform: &[f64], room: &mut Passive) {
        let (half, size) = (self.half, self.half * self.half);
        for block in [0, 2] {
            let values = &mut self.values[block * size..(block + 1) * size];
            if !room.is_passive(values, half) {
                room.project(values, half, if block == 0 { uniform } else { &[] });
            }
        }
    }

    /// Sets everything to 0.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }
}

/// Square of the cosine between a uniform flux and the answer to it, from which on the answer stays as it is.
const TURNED: f64 = 0.25;

/// Half of the cells from which on a row of them fills the vector unit.
const FEW_CELLS: usize = 8;

/// Columns turned at once.
const TILE: usize = 8;

/// Column of the response to a cell (`sign` 1) or its mirror image (-1): even answers to even and to odd heat, minus odd to
/// even, odd to odd. `mirrored` is room for the lower half, from the edge inwards.
#[inline(always)]
fn column<S: Simd>(
    simd: S,
    parts: [&[f64]; 4],
    [sign, width, level]: [f64; 3],
    mirrored: &mut [f64],
    target: &mut [f64],
) {
    let half = parts[0].len();
    let (top, bottom) = target.split_at_mut(half);
    let mut vectors: [(&[S::f64s], &[f64]); 4] = [(&[], &[]); 4];
    for k in 0..4 {
        vectors[k] = S::as_simd_f64s(&parts[k][..half]);
    }
    let ((top_head, top_tail), (low_head, low_tail)) =
        (S::as_mut_simd_f64s(top), S::as_mut_simd_f64s(&mut mirrored[..half]));
    let [signs, widths, levels] = [sign, width, level].map(|value| simd.splat_f64s(value));
    for i in 0..low_head.len() {
        let [even, even_to_odd, odd_to_even, odd] = [0, 1, 2, 3].map(|k| vectors[k].0[i]);
        let same = simd.add_f64s(simd.add_f64s(levels, even), simd.mul_f64s(signs, even_to_odd));
        let other = simd.sub_f64s(simd.mul_f64s(signs, odd), odd_to_even);
        top_head[i] = simd.mul_f64s(widths, simd.add_f64s(same, other));
        low_head[i] = simd.mul_f64s(widths, simd.sub_f64s(same, other));
    }
    for i in 0..low_tail.len() {
        let same = level + vectors[0].1[i] + sign * vectors[1].1[i];
        let other = sign * vectors[3].1[i] - vectors[2].1[i];
        top_tail[i] = width * (same + other);
        low_tail[i] = width * (same - other);
    }
    bottom.iter_mut().rev().zip(&*mirrored).for_each(|(value, mirrored)| *value = *mirrored);
}

/// Memory in which a symmetric matrix loses its negative eigenvalues.
pub struct Passive {
    matrix: Mat<f64>,
    vectors: Mat<f64>,
    values: Col<f64>,
    /// Answer to a uniform flux.
    answer: Vec<f64>,
    stack: MemBuffer,
}

impl fmt::Debug for Passive {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Passive").field("size", &self.values.nrows()).finish()
    }
}

impl Passive {
    /// For matrices of this size.
    pub fn new(size: usize) -> Passive {
        let eigenvectors = ComputeEigenvectors::Yes;
        let stack = self_adjoint_evd_scratch::<f64>(size, eigenvectors, Par::Seq, Default::default());
        Passive {
            matrix: Mat::zeros(size, size),
            vectors: Mat::zeros(size, size),
            values: Col::zeros(size),
            answer: vec![0.0; size],
            stack: MemBuffer::new(stack),
        }
    }

    fn set(&mut self, values: &[f64], size: usize) {
        for j in 0..size {
            for i in 0..size {
                self.matrix[(i, j)] = 0.5 * (values[j * size + i] + values[i * size + j]);
            }
        }
    }

    /// Whether the symmetric part has no eigenvalue below 0, but for rounding: its Cholesky factor exists.
    fn is_passive(&mut self, values: &[f64], size: usize) -> bool {
        self.set(values, size);
        let matrix = &mut self.matrix;
        let shift = 1e-12 * (0..size).map(|i| matrix[(i, i)].abs()).fold(0.0, f64::max);
        for k in 0..size {
            let mut pivot = matrix[(k, k)] + shift;
            for i in 0..k {
                pivot -= matrix[(i, k)] * matrix[(i, k)];
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let root = pivot.sqrt();
            // The upper factor by columns: both sums run down a column.
            for j in k + 1..size {
                let mut entry = matrix[(k, j)];
                for i in 0..k {
                    entry -= matrix[(i, k)] * matrix[(i, j)];
                }
                matrix[(k, j)] = entry / root;
            }
        }
        true
    }

    /// Takes the part u u'/(c'u) from the matrix, where c = `uniform`; returns 1/(c'u), or what is left of it.
    fn split_uniform(&mut self, uniform: &[f64]) -> f64 {
        self.answer.fill(0.0);
        for (j, heat) in uniform.iter().enumerate() {
            for (answer, entry) in self.answer.iter_mut().zip(self.matrix.col_as_slice(j)) {
                *answer += entry * heat;
            }
        }
        let [given, square, own] = [[&self.answer[..], uniform], [&self.answer, &self.answer], [uniform, uniform]]
            .map(|[l, r]| dense::dot(l, r));
        if given.is_nan() || given <= 0.0 {
            return 0.0;
        }
        let share = (given * given / (TURNED * square * own)).min(1.0) / given;
        for j in 0..uniform.len() {
            for i in 0..uniform.len() {
                self.matrix[(i, j)] -= share * self.answer[i] * self.answer[j];
            }
        }
        share
    }

    /// Sets the matrix to its symmetric part without the negative eigenvalues; the answer to `uniform` stays, if there is one.
    fn project(&mut self, values: &mut [f64], size: usize, uniform: &[f64]) {
        self.set(values, size);
        let share = if uniform.is_empty() { 0.0 } else { self.split_uniform(uniform) };
        let stack = MemStack::new(&mut self.stack);
        let (diagonal, vectors) = (self.values.as_diagonal_mut(), self.vectors.as_mut());
        let found =
            self_adjoint_evd(self.matrix.as_ref(), diagonal, Some(vectors), Par::Seq, stack, Default::default());
        if found.is_err() {
            // Of numbers that are none.
            return;
        }
        values.fill(0.0);
        if share > 0.0 {
            for (column, part) in values.chunks_exact_mut(size).zip(&self.answer) {
                let part = share * part;
                column.iter_mut().zip(&self.answer).for_each(|(entry, other)| *entry = part * other);
            }
        }
        for k in 0..size {
            let eigenvalue = self.values[k].max(0.0);
            let vector = self.vectors.col_as_slice(k);
            for (column, part) in values.chunks_exact_mut(size).zip(vector) {
                let part = eigenvalue * part;
                column.iter_mut().zip(vector).for_each(|(entry, other)| *entry += part * other);
            }
        }
    }
}

/// What the sums of the remainder are made of.
#[derive(Debug)]
pub struct Remainder {
    pub cells: Cells,
    /// The layer with and without heat transfer on its surface.
    pub slab: Slab,
    pub bare: Slab,
    pub expansion: Option<Expansion>,
    pub period: f64,
    /// Number of the last harmonic that has states.
    pub last: usize,
    pub waves: Vec<Wave>,
    pub shapes: Arc<Shapes>,
    pub modes: Vec<DepthModes>,
    /// On fresh material: frequency below which nothing counts as steady, 1/s, and how the states forget.
    pub fresh: Option<(f64, Forgetting)>,
}

/// Beyond this part of the period the nearest images of the contact are taken one by one.
const NEAR_IMAGES: f64 = 0.3;
/// Beyond this q h a layer is a half-plane: 2 exp(-2 q h) = 5e-16.
const HALF_PLANE: f64 = 18.0;
/// Wave number, in units of the contact's width, below which the endless path's integral has no structure left.
const SLOWEST_WAVE: f64 = 1e-7;
/// Wave number, in units of the contact's width, below which what is removed is smooth in the root of the wave number, where
/// the contact slides by twice that in widths over the time of diffusion across the width, or faster.
const LONGEST_SLIDING: f64 = 0.5;
/// The distortion's sum, which falls like 1/q^2, goes on to this multiple of the last wave number with states.
const DISTORTION_REACH: f64 = 4.0;

/// Waves of an integral over the wave number.
#[derive(Debug)]
struct Integral {
    waves: Vec<Wave>,
    shapes: Shapes,
    /// The layer at each of them.
    depths: Vec<Depth>,
}

impl Integral {
    fn new(cells: &Cells, slab: &Slab, expansion: Option<&Expansion>, waves: Vec<Wave>) -> Integral {
        Integral {
            shapes: Shapes::new(cells, &waves),
            depths: waves.iter().map(|wave| Depth::new(slab, expansion, wave.number)).collect(),
            waves,
        }
    }

    fn iter(&self) -> impl Iterator<Item = (&Wave, &Depth)> {
        self.waves.iter().zip(&self.depths)
    }
}

/// Waves of the integrals: prepared once for all velocities.
#[derive(Debug)]
pub struct Integrals {
    /// The layer at the waves with states.
    depths: Vec<Depth>,
    /// What is removed while sliding, or at any velocity on fresh material.
    removed: Integral,
    /// What is removed at rest of waves that are long against the contact, instead of the first of those.
    removed_at_rest: Option<Integral>,
    beyond: Integral,
    /// The two harmonics about the end of those with states.
    ends: Shapes,
    images: bool,
}

/// Gains of waves that are summed together: of temperature, and of distortion where there is one.
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

    /// Adds the sums over these waves, and begins anew.
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

/// Memory that the sums are taken in.
#[derive(Debug)]
pub struct Room {
    sums: Sums,
    source: MovingSource,
    pub passive: Passive,
}

impl Room {
    /// For these integrals: nothing in it grows later.
    pub fn new(remainder: &Remainder, integrals: &Integrals) -> Room {
        let at_rest = integrals.removed_at_rest.as_ref().map_or(0, |integral| integral.waves.len());
        let counts = [remainder.waves.len(), integrals.removed.waves.len(), at_rest, integrals.beyond.waves.len()];
        let most = counts.into_iter().max().unwrap_or(0);
        Room {
            sums: Sums {
                warm: Vec::with_capacity(most),
                moved: Vec::with_capacity(most),
                terms: Vec::with_capacity(most),
            },
            source: MovingSource::new(remainder.cells.count()),
            passive: Passive::new(remainder.shapes.half()),
        }
    }
}

impl Remainder {
    fn spacing(&self) -> f64 {
        2.0 * PI / self.period
    }

    /// See [`Integrals`].
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
        let expansion = self.expansion.as_ref();
        let integral = |slab: &Slab, waves: Vec<Wave>| Integral::new(&self.cells, slab, expansion, waves);
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
            depths: self.waves.iter().map(|wave| Depth::new(&self.slab, expansion, wave.number)).collect(),
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

    /// Temperature and distortion per heat at the velocity `velocity` >= 0.
    pub fn at(
        &self,
        velocity: f64,
        integrals: &Integrals,
        room: &mut Room,
        temperature: &mut Blocks,
        distortion: &mut Blocks,
    ) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        temperature.clear();
        distortion.clear();
        // At rest the half-plane's own sum has no end at q = 0; so slow a motion is rest for every wave that is left.
        let slow = 1e-4 * diffusivity / self.cells.half_width();
        let moving = velocity.max(slow);
        let turning = |q: f64| Complex::new(0.0, -q * moving);
        let half_plane = |q: f64| (principal_root(turning(q) / diffusivity + q * q) * conductivity).inv();
        if let Some(fresh) = self.fresh {
            self.add_fresh(velocity, moving, fresh, integrals, room, [temperature, distortion]);
            return;
        }
        let Room { sums, source, .. } = room;
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
            let felt = wave.number * self.bare.height < HALF_PLANE;
            let [gain, moved] = if expands { depth.respond(s) } else { [depth.impedance(s), Complex::from(0.0)] };
            let gain = if felt { gain - half_plane(wave.number) } else { Complex::from(0.0) };
            sums.push(gain, expands.then_some(moved), wave.count * copies(wave.number) / PI);
        }
        sums.add_to(&integrals.beyond.shapes, temperature, distortion);
        self.correct_ends(integrals, &half_plane, temperature);
    }

    /// The endless path's whole response, in real space for the half-plane and as an integral over the wave number for what
    /// the layer differs from it, less what the states answer.
    fn add_fresh(
        &self,
        velocity: f64,
        moving: f64,
        (slowest, forgetting): (f64, Forgetting),
        integrals: &Integrals,
        room: &mut Room,
        [temperature, distortion]: [&mut Blocks; 2],
    ) {
        let (conductivity, diffusivity) = (self.bare.conductivity, self.bare.diffusivity());
        let Room { sums, source, .. } = room;
        let expands = self.expansion.is_some();
        // Contacts that forget are steady by themselves; slow ones within the duration are not, and their states are exact.
        let forgotten = forgetting.rate(velocity);
        let lasting = slowest * slowest / (slowest + forgotten);
        // What the states lose for that: never less, or what is left for the answer at once would be negative.
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

    /// f'/24 at the first harmonic left to the integral; the nearest images have their part of it already.
    fn correct_ends(&self, integrals: &Integrals, response: &dyn Fn(f64) -> Complex<f64>, blocks: &mut Blocks) {
        let part = if integrals.images { 1.0 - 12.0 / (PI * PI) } else { 1.0 };
        for (end, (harmonic, sign)) in [(self.last, -1.0), (self.last + 1, 1.0)].into_iter().enumerate() {
            let (even, odd) = integrals.ends.rows(end);
            let gain = response(self.harmonic(harmonic).number) * (sign * part * 2.0 / (24.0 * self.period));
            blocks.add_wave(gain, even, odd);
        }
    }
}
