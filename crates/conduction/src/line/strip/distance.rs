//! Influence of the modes on all pairs of cells, by interpolation in the distance.
//!
//! The strip is homogeneous along the path, so the sum of the modes depends on the distance r of two points alone:
//!
//! ```text
//! k(r) = sum over q of Re [g_q exp(iqr)],    influence of cell l on cell j = width_l (mean of k over x in j, s in l, r = x - s)
//! ```
//!
//! As k is band-limited to q_last and needed at |r| <= W only, about q_last W numbers determine it: its values at
//! evenly spaced nodes. They follow from the mode responses by one Fourier transform, and the means over pairs of cells
//! from the nodes by weights that depend on neither velocity nor step. Modes times cells squared operations become
//! `M log M + N^2`.
//!
//! Wave numbers need not be evenly spaced (strokes), nor are distances. Both are spread to their grids by the window
//! `phi(t) = exp(beta [sqrt(1 - (2t/w)^2) - 1])`, |t| <= w/2, with the Fourier transform psi (A. H. Barnett, J.
//! Magland, L. af Klinteberg, SIAM J. Sci. Comput. 41 (2019) C479-C504):
//!
//! ```text
//! exp(i theta x) = sum_m phi(x - m) exp(i theta m)/psi(theta),    |theta| <= pi/sigma
//! ```
//!
//! with an error of the order `exp(-pi w sqrt(1 - 1/sigma))`, 1.3e-8 for w = 10 at the smallest sigma, 1.5. Temperature
//! and distortion are real, so one complex transform gives both, the distortion scaled to the magnitude of the
//! temperature.
//!
//! Theory: docs/theory.md, section 4.13.

use super::waves::Wave;
use elasticity::Cells;
use nalgebra::{Complex, DMatrix};
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;

/// w: width of the window in nodes.
const WINDOW: usize = 10;
/// Grid places below wave number 0 within the window.
const BELOW: usize = WINDOW / 2;
/// Least number of nodes of the transform.
const FEWEST_NODES: usize = 64;
/// Half-width, in nodes, up to which a cell is as a point: its own mean differs by 1e-8, as do second differences by rounding.
const NARROWEST: f64 = 2e-4;

/// Window of the spreading, with the terms of two sums of cosines, [`cosine_sum`], both exact to the window's value at its ends.
#[derive(Clone, Debug)]
struct Window {
    shape: f64,
    /// psi by theta/2: the trapezoidal rule at the multiples of 1/2.
    samples: [f64; WINDOW + 1],
    /// Mean over its own width, and the Fourier series there, integrated twice, by 2 pi t/w.
    mean: f64,
    integrated: [f64; WINDOW + 1],
}

impl Window {
    fn new(shape: f64) -> Window {
        let (width, nothing) = (WINDOW as f64, [0.0; WINDOW + 1]);
        let mut window = Window { shape, samples: nothing, mean: 0.0, integrated: nothing };
        window.samples = std::array::from_fn(|k| if k == 0 { 0.5 } else { window.value(0.5 * k as f64) });
        window.mean = window.transform(0.0) / width;
        for n in 1..=WINDOW {
            let turn = 2.0 * PI * n as f64 / width;
            window.integrated[n] = -2.0 * window.transform(turn) / (width * turn * turn);
        }
        window
    }

    fn value(&self, t: f64) -> f64 {
        let x = 2.0 * t / WINDOW as f64;
        let square = 1.0 - x * x;
        if square > 0.0 { (self.shape * (square.sqrt() - 1.0)).exp() } else { 0.0 }
    }

    /// psi(theta).
    fn transform(&self, theta: f64) -> f64 {
        cosine_sum(&self.samples, 0.5 * theta)
    }

    /// Second antiderivative of the window, even; linear beyond the window.
    fn second_antiderivative(&self, t: f64) -> f64 {
        let inside = t.abs().min(0.5 * WINDOW as f64);
        let mean = self.mean * inside * (t.abs() - 0.5 * inside);
        mean + cosine_sum(&self.integrated, 2.0 * PI / WINDOW as f64 * inside)
    }
}

/// Sum of `terms[k] cos(k x)`.
fn cosine_sum(terms: &[f64; WINDOW + 1], x: f64) -> f64 {
    let cosine = x.cos();
    let (mut sum, mut before, mut now) = (0.0, cosine, 1.0);
    for term in terms {
        sum += term * now;
        (before, now) = (now, 2.0 * cosine * now - before);
    }
    sum
}

/// Two cells, j not behind l, and the range of their weights.
#[derive(Clone, Copy, Debug)]
struct Pair {
    cells: [usize; 2],
    /// First node, counted from the first stored one.
    node: usize,
    weights: [usize; 2],
}

/// Plan of the sum over the modes for given cells and wave numbers.
#[derive(Debug)]
pub(crate) struct DistanceSum {
    count: usize,
    /// Unit of the distortion, m/K.
    unit: f64,
    /// M, a power of 2.
    size: usize,
    /// By mode: first grid place, counted from -w/2, and the weights from there on.
    spread: Vec<(usize, [f64; WINDOW])>,
    /// exp(2 pi i k/M), k < M/2, real and imaginary parts.
    roots: [Vec<f64>; 2],
    /// Number of stored nodes at negative distance, and the window's transform correction at distance 0, 1, ... nodes.
    behind: usize,
    scale: Vec<f64>,
    pairs: Vec<Pair>,
    weights: Vec<f64>,
}

/// Workspace of one sum.
#[derive(Clone, Debug)]
pub(crate) struct Nodes {
    /// Spread to the grid of wave numbers from -w/2 on: real and imaginary part of temperature, then of distortion.
    gathered: Vec<[f64; 4]>,
    /// Spectrum and its transform, real and imaginary parts alternate.
    spectrum: [Vec<f64>; 4],
    /// k of temperature and of distortion at a node and at the opposite one.
    values: Vec<[f64; 4]>,
}

impl DistanceSum {
    /// Plan for these cells and modes, of ascending wave number; `unit`: magnitude of the distortion (m) per
    /// temperature (K) of a mode.
    pub(crate) fn new(cells: &Cells, waves: &[Wave], unit: f64) -> DistanceSum {
        let width = 2.0 * cells.half_width();
        let last = waves.last().map_or(0.0, |wave| wave.number).max(1.0 / width);
        let window = WINDOW as f64;
        // Both grids are oversampled by sigma: M = sigma^2 (2 W + w delta) q_last/pi, delta = pi/(sigma q_last).
        let needed = |sigma: f64| sigma * (sigma * 2.0 * width * last / PI + window);
        // Least oversampling sigma: extent of the grids over band and distances.
        let size = (needed(1.5).ceil() as usize).next_power_of_two().max(FEWEST_NODES);
        let half = 0.5 * window / (2.0 * width * last / PI);
        let sigma = (half * half + size as f64 / (2.0 * width * last / PI)).sqrt() - half;
        let (delta, step) = (PI / (sigma * last), 2.0 * sigma * last / size as f64);
        let window = Window::new(0.98 * PI * WINDOW as f64 * (1.0 - 0.5 / sigma));
        let spread = waves.iter().map(|wave| {
            let place = wave.number / step;
            let first = (place - 0.5 * WINDOW as f64).ceil();
            let factor = 0.5 / window.transform(wave.number * delta);
            let weights = std::array::from_fn(|k| factor * window.value(place - first - k as f64));
            ((first + BELOW as f64) as usize, weights)
        });
        let turn = |k: usize| 2.0 * PI * k as f64 / size as f64;
        let mut sum = DistanceSum {
            count: cells.count(),
            unit: if unit > 0.0 && unit.is_finite() { unit } else { 1.0 },
            size,
            spread: spread.collect(),
            roots: [(0..size / 2).map(|k| turn(k).cos()).collect(), (0..size / 2).map(|k| turn(k).sin()).collect()],
            behind: 0,
            scale: Vec::new(),
            pairs: Vec::new(),
            weights: Vec::new(),
        };
        let widest = cells.widths().iter().copied().fold(0.0, f64::max);
        sum.behind = (widest / delta + 0.5 * WINDOW as f64).ceil() as usize + 1;
        let ahead = (width / delta + 0.5 * WINDOW as f64).ceil() as usize + 1;
        sum.scale = (0..=ahead.max(sum.behind)).map(|m| window.transform(turn(m)).recip()).collect();
        sum.scale.truncate(size / 2);
        sum.average(cells, delta, &window);
        sum
    }

    /// Weights of the nodes in the mean over each pair of cells: second differences of the window's second antiderivative. A pair and
    /// its mirror image have the same distance.
    fn average(&mut self, cells: &Cells, delta: f64, window: &Window) {
        let (x, widths, count) = (cells.centres(), cells.widths(), cells.count());
        for j in 0..count {
            for l in 0..=j.min(count - 1 - j) {
                let [a, b] = [j, l].map(|cell| (0.5 * widths[cell] / delta).max(NARROWEST));
                let (distance, reach) = ((x[j] - x[l]) / delta, a + b + 0.5 * WINDOW as f64);
                let (first, last) = ((distance - reach).ceil(), (distance + reach).floor());
                let begin = self.weights.len();
                self.weights.extend((0..=(last - first) as usize).map(|k| {
                    let [left, right] = [-a, a].map(|end| distance - first - k as f64 + end);
                    let rise = |t: f64| window.second_antiderivative(t + b) - window.second_antiderivative(t - b);
                    (rise(right) - rise(left)) / (4.0 * a * b)
                }));
                let node = (first + self.behind as f64) as usize;
                self.pairs.push(Pair { cells: [j, l], node, weights: [begin, self.weights.len()] });
            }
        }
    }

    /// Number of modes.
    pub(crate) fn waves(&self) -> usize {
        self.spread.len()
    }

    /// Allocates the workspace of a sum.
    pub(crate) fn nodes(&self) -> Nodes {
        let places = self.spread.iter().map(|(first, _)| first + WINDOW).max().unwrap_or(WINDOW);
        Nodes {
            gathered: vec![[0.0; 4]; places],
            spectrum: [0; 4].map(|_| vec![0.0; self.size]),
            values: vec![[0.0; 4]; self.behind + self.scale.len()],
        }
    }

    /// Computes k at the nodes from the mode responses of temperature and of distortion.
    pub(crate) fn find(&self, gains: [&[Complex<f64>]; 2], nodes: &mut Nodes) {
        let Nodes { gathered, spectrum, values } = nodes;
        Arch::new().dispatch(Gather { sum: self, gains, gathered });
        let [re, im, ..] = spectrum;
        re.fill(0.0);
        im.fill(0.0);
        // Masks in place of remainders: the size is a power of 2.
        let mask = self.size - 1;
        for (place, [warm_re, warm_im, moved_re, moved_im]) in gathered.iter().enumerate() {
            // g + i d at q and g* + i d* at -q: the sum is real in g and in d.
            let at = (place + self.size - BELOW) & mask;
            re[at] += warm_re - moved_im;
            im[at] += warm_im + moved_re;
            let opposite = (self.size - at) & mask;
            re[opposite] += warm_re + moved_im;
            im[opposite] += moved_re - warm_im;
        }
        let into = Arch::new().dispatch(Transform { roots: &self.roots, spectrum });
        let (re, im) = (&spectrum[into], &spectrum[into + 1]);
        for (place, value) in values.iter_mut().enumerate() {
            let ahead = place >= self.behind;
            let distance = place.abs_diff(self.behind);
            let scale = self.scale.get(distance).copied().unwrap_or(0.0);
            let (own, opposite) = (distance & mask, (self.size - distance) & mask);
            let [own, opposite] = if ahead { [own, opposite] } else { [opposite, own] };
            *value = [re[own], im[own], re[opposite], im[opposite]].map(|value| scale * value);
        }
    }

    /// Sets the influence matrices (N x N; the second may be empty) per flux into cells of these widths, plus the
    /// uniform influence `level` per heat.
    pub(crate) fn set(&self, nodes: &Nodes, widths: &[f64], level: [f64; 2], influence: &mut [DMatrix<f64>; 2]) {
        let [warm, moved] = influence.each_mut().map(|matrix| matrix.as_mut_slice());
        Arch::new().dispatch(Means { sum: self, nodes, widths, level, warm, moved });
    }
}

/// Spreading of the mode responses to the grid of wave numbers.
struct Gather<'a> {
    sum: &'a DistanceSum,
    gains: [&'a [Complex<f64>]; 2],
    gathered: &'a mut [[f64; 4]],
}

impl WithSimd for Gather<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sum, gains: [warm, moved], gathered } = self;
        let per_unit = 1.0 / sum.unit;
        gathered.fill([0.0; 4]);
        for ((first, weights), (warm, moved)) in sum.spread.iter().zip(warm.iter().zip(moved)) {
            let gain = [warm.re, warm.im, per_unit * moved.re, per_unit * moved.im];
            for (place, weight) in gathered[*first..][..WINDOW].iter_mut().zip(weights) {
                for part in 0..4 {
                    place[part] += weight * gain[part];
                }
            }
        }
    }
}

/// Fourier transform of twice as many numbers as there are roots; returns the index of the part of the memory that
/// holds the result. Self-sorting (T. G. Stockham; C. Van Loan, Computational Frameworks for the Fast Fourier
/// Transform, 1992, 1.7).
struct Transform<'a> {
    roots: &'a [Vec<f64>; 2],
    spectrum: &'a mut [Vec<f64>; 4],
}

impl WithSimd for Transform<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        let Self { roots, spectrum: [a, b, c, d] } = self;
        let [cosine, sine] = roots;
        let half = cosine.len();
        let (mut from, mut to) = ([&mut a[..], &mut b[..]], [&mut c[..], &mut d[..]]);
        let (mut blocks, mut length, mut into) = (half, 1, 0);
        while blocks > 0 {
            let ([re, im], [to_re, to_im]) = (&from, &mut to);
            match length {
                1 => short::<1>(roots, [re, im], [to_re, to_im]),
                2 => short::<2>(roots, [re, im], [to_re, to_im]),
                4 => short::<4>(roots, [re, im], [to_re, to_im]),
                _ => {}
            }
            for block in 0..if length < 8 { 0 } else { blocks } {
                let (c, s) = (cosine[block * length], sine[block * length]);
                let (first, second) = (block * length, block * length + half);
                let (x_re, x_im) = (&re[first..first + length], &im[first..first + length]);
                let (y_re, y_im) = (&re[second..second + length], &im[second..second + length]);
                let (sum_re, difference_re) = to_re[2 * first..2 * first + 2 * length].split_at_mut(length);
                let (sum_im, difference_im) = to_im[2 * first..2 * first + 2 * length].split_at_mut(length);
                for k in 0..length {
                    sum_re[k] = x_re[k] + y_re[k];
                    sum_im[k] = x_im[k] + y_im[k];
                    let (re, im) = (x_re[k] - y_re[k], x_im[k] - y_im[k]);
                    difference_re[k] = c * re - s * im;
                    difference_im[k] = c * im + s * re;
                }
            }
            std::mem::swap(&mut from, &mut to);
            into = 2 - into;
            (blocks, length) = (blocks / 2, 2 * length);
        }
        into
    }
}

/// A pass of [`Transform`] whose butterflies are so short that loops over them would cost more than their arithmetic.
#[inline(always)]
fn short<const LENGTH: usize>([cosine, sine]: &[Vec<f64>; 2], [re, im]: [&[f64]; 2], [to_re, to_im]: [&mut [f64]; 2]) {
    let half = cosine.len();
    let ((x_re, y_re), (x_im, y_im)) = (re.split_at(half), im.split_at(half));
    let [x_re, y_re, x_im, y_im] = [x_re, y_re, x_im, y_im].map(|part| part.as_chunks::<LENGTH>().0);
    let [to_re, to_im] = [to_re, to_im].map(|part| part.as_chunks_mut::<LENGTH>().0.as_chunks_mut::<2>().0);
    let roots = cosine.iter().zip(sine).step_by(LENGTH);
    let from = x_re.iter().zip(y_re).zip(x_im.iter().zip(y_im));
    for (((c, s), ((x_re, y_re), (x_im, y_im))), (to_re, to_im)) in roots.zip(from).zip(to_re.iter_mut().zip(to_im)) {
        for k in 0..LENGTH {
            to_re[0][k] = x_re[k] + y_re[k];
            to_im[0][k] = x_im[k] + y_im[k];
            let (re, im) = (x_re[k] - y_re[k], x_im[k] - y_im[k]);
            to_re[1][k] = c * re - s * im;
            to_im[1][k] = c * im + s * re;
        }
    }
}

/// The means over pairs of cells.
struct Means<'a> {
    sum: &'a DistanceSum,
    nodes: &'a Nodes,
    widths: &'a [f64],
    level: [f64; 2],
    warm: &'a mut [f64],
    moved: &'a mut [f64],
}

impl WithSimd for Means<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sum, nodes, widths, level: [level, moved_level], warm, moved } = self;
        let last = sum.count - 1;
        for pair in &sum.pairs {
            let weights = &sum.weights[pair.weights[0]..pair.weights[1]];
            let mut means = [0.0; 4];
            for (weight, values) in weights.iter().zip(&nodes.values[pair.node..]) {
                for part in 0..4 {
                    means[part] += weight * values[part];
                }
            }
            let [j, l] = pair.cells;
            let mut set = |observed: usize, heated: usize, mean: f64, moved_mean: f64| {
                let at = heated * sum.count + observed;
                warm[at] = widths[heated] * (level + mean);
                if let Some(value) = moved.get_mut(at) {
                    *value = widths[heated] * (moved_level + sum.unit * moved_mean);
                }
            };
            set(j, l, means[0], means[1]);
            set(last - l, last - j, means[0], means[1]);
            if j != l {
                set(l, j, means[2], means[3]);
                set(last - j, last - l, means[2], means[3]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::waves::harmonics;
    use super::*;

    /// Against the sum over the modes for each pair of cells.
    #[test]
    fn means_over_pairs_of_cells_are_those_of_the_sum_over_the_modes() {
        for (cells, period, last, reach) in [
            (Cells::graded(0.0475, 33).unwrap(), 0.738, 326, f64::INFINITY),
            (Cells::graded(0.03, 10).unwrap(), 0.06, 100, f64::INFINITY),
            (Cells::graded(0.0475, 129).unwrap(), 0.6, 385, 0.2),
            (Cells::graded(0.001, 9).unwrap(), 1.0, 16, f64::INFINITY),
        ] {
            let waves = harmonics(period, last, reach);
            let count = cells.count();
            // A moving source: the mode responses decrease with the root of the wave number and rotate in phase.
            let gain = |turn: f64| -> Vec<Complex<f64>> {
                waves
                    .iter()
                    .map(|wave| Complex::from_polar(wave.count / wave.number.sqrt(), turn * wave.number))
                    .collect()
            };
            let gains = [gain(-0.02), gain(0.011).iter().map(|gain| 1e-9 * gain).collect()];
            let sum = DistanceSum::new(&cells, &waves, 1e-9);
            let mut nodes = sum.nodes();
            sum.find([&gains[0], &gains[1]], &mut nodes);
            let mut found = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
            let level = [0.7, -3e-10];
            sum.set(&nodes, cells.widths(), level, &mut found);
            let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
            for ((gains, found), level) in gains.iter().zip(&found).zip(level) {
                let mean = |j: usize, l: usize| -> f64 {
                    let distance = cells.centres()[j] - cells.centres()[l];
                    let of_wave = |(wave, gain): (&Wave, &Complex<f64>)| {
                        let averaged = [j, l].map(|cell| sinc(0.5 * wave.number * cells.widths()[cell]));
                        (gain * Complex::from_polar(averaged[0] * averaged[1], wave.number * distance)).re
                    };
                    waves.iter().zip(gains).map(of_wave).sum()
                };
                let scale = gains.iter().map(|gain| gain.norm()).sum::<f64>();
                for l in 0..count {
                    for j in 0..count {
                        let apart = (found[(j, l)] / cells.widths()[l] - level - mean(j, l)).abs();
                        assert!(apart < 1e-7 * scale, "{count} {j} {l}: {apart:e} of {scale:e}");
                    }
                }
            }
        }
    }
}
