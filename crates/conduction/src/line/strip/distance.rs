//! Influence of the modes on all pairs of cells, by interpolation in the distance.
//!
//! The strip is homogeneous along the path, so the sum of the modes depends on the distance r of two points alone:
//!
//! ```text
//! k(r) = sum over q of Re [g_q exp(iqr)],    influence of cell l on cell j = width_l (mean of k over x in j, s in l, r = x - s)
//! ```
//!
//! As k is band-limited to q_last and needed at |r| <= W only, about q_last W numbers determine it: its values at
//! evenly spaced nodes. The means over pairs of cells follow from the nodes by weights that depend on neither velocity nor step,
//! so that modes times cells squared operations become modes times nodes plus cells squared.
//!
//! Between the nodes, delta apart, a mode is interpolated by the window `phi(t) = exp(beta [sqrt(1 - (2t/w)^2) - 1])`, |t| <= w/2,
//! with the Fourier transform psi (A. H. Barnett, J. Magland, L. af Klinteberg, SIAM J. Sci. Comput. 41 (2019) C479-C504):
//!
//! ```text
//! exp(i theta x) = sum_m phi(x - m) exp(i theta m)/psi(theta),    theta = q delta,   |theta| <= pi/sigma
//! ```
//!
//! with an error of the order `exp(-pi w sqrt(1 - 1/sigma))`, 1.3e-8 for w = 10 and sigma = 1.5.
//!
//! Theory: docs/theory.md, section 4.13.

use super::waves::Wave;
use elasticity::Cells;
use elasticity::block::lobatto::gauss_legendre;
use nalgebra::{Complex, DMatrix};
use numerics::dense;
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;

/// w: width of the window in nodes, and sigma: nodes per half of the shortest wave.
const WINDOW: usize = 10;
const OVERSAMPLING: f64 = 1.5;
/// Points of the quadrature of the window's transform over half of the window.
const TRANSFORM_POINTS: usize = 24;
/// Longest part, in nodes, of an average over distances for the rule of eight points, and for that of four.
const LONGEST_PARTS: [f64; 2] = [2.0, 0.5];

/// Window of the interpolation, and the quadrature of its transform: points, and weights times the window's value.
#[derive(Clone, Debug)]
struct Window {
    shape: f64,
    rule: Vec<(f64, f64)>,
}

impl Window {
    fn new(shape: f64) -> Window {
        let mut window = Window { shape, rule: Vec::new() };
        let quarter = 0.25 * WINDOW as f64;
        // The window is even.
        let rule = gauss_legendre(TRANSFORM_POINTS).into_iter().map(|(node, weight)| (quarter * (1.0 + node), weight));
        window.rule = rule.map(|(t, weight)| (t, 2.0 * quarter * weight * window.value(t))).collect();
        window
    }

    fn value(&self, t: f64) -> f64 {
        let x = 2.0 * t / WINDOW as f64;
        let square = 1.0 - x * x;
        if square > 0.0 { (self.shape * (square.sqrt() - 1.0)).exp() } else { 0.0 }
    }

    /// psi(theta).
    fn transform(&self, theta: f64) -> f64 {
        self.rule.iter().map(|&(t, weight)| weight * (theta * t).cos()).sum()
    }
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
    waves: usize,
    /// cos(q r)/psi and sin(q r)/psi times the weight of the mode at the nodes r >= 0: a column for each mode.
    cosine: Vec<f64>,
    sine: Vec<f64>,
    /// Number of stored nodes at negative distance.
    behind: usize,
    pairs: Vec<Pair>,
    weights: Vec<f64>,
}

/// Workspace of one sum.
#[derive(Clone, Debug)]
pub(crate) struct Nodes {
    /// Sums of the real parts with the cosines and of the imaginary parts with the sines: of temperature and distortion.
    even: [Vec<f64>; 2],
    odd: [Vec<f64>; 2],
    /// k of temperature and of distortion at a node and at the opposite one.
    values: Vec<[f64; 4]>,
}

impl DistanceSum {
    /// Plan for these cells and modes, of ascending wave number; `weight`: of the response of a mode.
    pub(crate) fn new(cells: &Cells, waves: &[Wave], weight: impl Fn(&Wave) -> f64) -> DistanceSum {
        let width = 2.0 * cells.half_width();
        let last = waves.last().map_or(0.0, |wave| wave.number).max(1.0 / width);
        let delta = PI / (OVERSAMPLING * last);
        let window = Window::new(0.98 * PI * WINDOW as f64 * (1.0 - 0.5 / OVERSAMPLING));
        let widest = cells.widths().iter().copied().fold(0.0, f64::max);
        let reaching = |distance: f64| (distance / delta + 0.5 * WINDOW as f64).ceil() as usize + 1;
        let ahead = reaching(width);
        let mut sum = DistanceSum {
            count: cells.count(),
            waves: waves.len(),
            cosine: Vec::with_capacity(waves.len() * (ahead + 1)),
            sine: Vec::with_capacity(waves.len() * (ahead + 1)),
            behind: reaching(widest).min(ahead),
            pairs: Vec::new(),
            weights: Vec::new(),
        };
        for wave in waves {
            let theta = wave.number * delta;
            let (turn, mut at) =
                (Complex::from_polar(1.0, theta), Complex::from(weight(wave) / window.transform(theta)));
            for _ in 0..=ahead {
                sum.cosine.push(at.re);
                sum.sine.push(at.im);
                at *= turn;
            }
        }
        sum.average(cells, delta, &window);
        sum
    }

    /// Weights of the nodes in the mean over each pair of cells. A pair and its mirror image have the same distance.
    fn average(&mut self, cells: &Cells, delta: f64, window: &Window) {
        let (x, widths, count) = (cells.centres(), cells.widths(), cells.count());
        let rules = [gauss_legendre(4), gauss_legendre(8)];
        for j in 0..count {
            for l in 0..=j.min(count - 1 - j) {
                let (a, b) = (0.5 * widths[j] / delta, 0.5 * widths[l] / delta);
                let distance = (x[j] - x[l]) / delta;
                let (reach, flat) = (a + b, (a - b).abs());
                let first = (distance - reach - 0.5 * WINDOW as f64).ceil();
                let last = (distance + reach + 0.5 * WINDOW as f64).floor();
                let begin = self.weights.len();
                self.weights.resize(begin + (last - first) as usize + 1, 0.0);
                let weights = &mut self.weights[begin..];
                // The density of the distance about that of the centres is a trapezium: it rises, is constant and
                // falls.
                for (from, to) in [(-reach, -flat), (-flat, flat), (flat, reach)] {
                    let parts = ((to - from) / LONGEST_PARTS[0]).ceil().max(1.0);
                    let length = (to - from) / parts;
                    let rule = &rules[usize::from(length > LONGEST_PARTS[1])];
                    for part in 0..parts as usize {
                        for &(node, weight) in rule {
                            let offset = from + length * (part as f64 + 0.5 + 0.5 * node);
                            let density = (reach - offset.abs()).min(2.0 * a.min(b)) / (4.0 * a * b);
                            let at = distance + offset;
                            let lowest = (at - 0.5 * WINDOW as f64).ceil();
                            let place = (lowest - first) as usize;
                            for (k, sum) in weights[place..].iter_mut().enumerate().take(WINDOW) {
                                *sum += 0.5 * length * weight * density * window.value(at - lowest - k as f64);
                            }
                        }
                    }
                }
                let node = (first + self.behind as f64) as usize;
                self.pairs.push(Pair { cells: [j, l], node, weights: [begin, self.weights.len()] });
            }
        }
    }

    /// Number of modes.
    pub(crate) fn waves(&self) -> usize {
        self.waves
    }

    /// Allocates the workspace of a sum.
    pub(crate) fn nodes(&self) -> Nodes {
        let ahead = self.cosine.len() / self.waves.max(1);
        let zeros = || [vec![0.0; ahead], vec![0.0; ahead]];
        Nodes { even: zeros(), odd: zeros(), values: vec![[0.0; 4]; self.behind + ahead] }
    }

    /// Computes k at the nodes from the mode responses of temperature and of distortion, real and imaginary parts.
    pub(crate) fn find(&self, [warm, moved]: [[&[f64]; 2]; 2], nodes: &mut Nodes) {
        let Nodes { even, odd, values } = nodes;
        even.iter_mut().chain(&mut *odd).for_each(|part| part.fill(0.0));
        dense::multiply_add_pair(&self.cosine, [warm[0], moved[0]], even.each_mut().map(|part| &mut part[..]));
        dense::multiply_add_pair(&self.sine, [warm[1], moved[1]], odd.each_mut().map(|part| &mut part[..]));
        let both = even[0].iter().zip(&even[1]).zip(odd[0].iter().zip(&odd[1]));
        for (distance, ((warm, moved), (warm_odd, moved_odd))) in both.enumerate() {
            let (own, opposite) = ([warm - warm_odd, moved - moved_odd], [warm + warm_odd, moved + moved_odd]);
            values[self.behind + distance] = [own[0], own[1], opposite[0], opposite[1]];
            if distance <= self.behind {
                values[self.behind - distance] = [opposite[0], opposite[1], own[0], own[1]];
            }
        }
    }

    /// Sets the influence matrices (N x N; the second may be empty) per flux into cells of these widths, plus the
    /// uniform influence `level` per heat.
    pub(crate) fn set(&self, nodes: &Nodes, widths: &[f64], level: [f64; 2], influence: &mut [DMatrix<f64>; 2]) {
        let [warm, moved] = influence.each_mut().map(|matrix| matrix.as_mut_slice());
        Arch::new().dispatch(Means { sum: self, nodes, widths, level, warm, moved });
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
                    *value = widths[heated] * (moved_level + moved_mean);
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
                waves.iter().map(|wave| Complex::from_polar(1.0 / wave.number.sqrt(), turn * wave.number)).collect()
            };
            let gains = [gain(-0.02), gain(0.011).iter().map(|gain| 1e-9 * gain).collect()];
            let parts = gains.each_ref().map(|gains| {
                [gains.iter().map(|gain| gain.re).collect::<Vec<_>>(), gains.iter().map(|gain| gain.im).collect()]
            });
            let sum = DistanceSum::new(&cells, &waves, |wave| wave.count);
            let mut nodes = sum.nodes();
            sum.find(parts.each_ref().map(|parts| parts.each_ref().map(|part| &part[..])), &mut nodes);
            let mut found = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
            let level = [0.7, -3e-10];
            sum.set(&nodes, cells.widths(), level, &mut found);
            let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
            for ((gains, found), level) in gains.iter().zip(&found).zip(level) {
                let mean = |j: usize, l: usize| -> f64 {
                    let distance = cells.centres()[j] - cells.centres()[l];
                    let of_wave = |(wave, gain): (&Wave, &Complex<f64>)| {
                        let averaged = [j, l].map(|cell| sinc(0.5 * wave.number * cells.widths()[cell]));
                        (wave.count * gain * Complex::from_polar(averaged[0] * averaged[1], wave.number * distance)).re
                    };
                    waves.iter().zip(gains).map(of_wave).sum()
                };
                let scale = waves.iter().zip(gains).map(|(wave, gain)| wave.count * gain.norm()).sum::<f64>();
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
