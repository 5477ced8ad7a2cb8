//! State layout of the Fourier modes, level by level, and the vectorised operations on all states at every step.
//!
//! A mode has as many states as its reduction needs, one on each of its levels; the states of one level are contiguous
//! in the order of the modes. Every operation then runs over independent modes. No multiply-add is fused, so every
//! machine gives the same bits.
//!
//! Theory: docs/theory.md, section 4.5.

use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::FRAC_2_PI;
use std::ops::Range;

/// Index range of the states of one level; its length is the number of modes with a state on it, those of the longest
/// waves.
pub(crate) type Level = Range<usize>;

/// Real and imaginary parts.
pub(crate) type Parts<'a> = [&'a [f64]; 2];

/// State layout for modes with these numbers of states, in non-increasing order.
pub(crate) fn state_layout(counts: &[usize]) -> Vec<Level> {
    let mut levels = Vec::new();
    let mut first = 0;
    for level in 0..counts.first().copied().unwrap_or(0) {
        let end = first + counts.iter().take_while(|count| **count > level).count();
        levels.push(first..end);
        first = end;
    }
    levels
}

/// State indices of a mode, level by level.
pub(crate) fn of_mode(state_layout: &[Level], wave: usize) -> impl Iterator<Item = usize> + '_ {
    state_layout.iter().take_while(move |level| wave < level.len()).map(move |level| level.start + wave)
}

/// Values of one level.
#[inline(always)]
fn on<'a>(level: &Level, [re, im]: Parts<'a>) -> Parts<'a> {
    [&re[level.clone()], &im[level.clone()]]
}

/// Amplitudes of the modes by two observations of the states, each state multiplied by its propagation factor first;
/// real and imaginary parts.
pub(crate) fn observe(
    state_layout: &[Level],
    states: Parts<'_>,
    factors: Parts<'_>,
    seen: Parts<'_>,
    sums: [&mut [Vec<f64>; 2]; 2],
) {
    struct Observe<'a>(&'a [Level], Parts<'a>, Parts<'a>, Parts<'a>, [&'a mut [Vec<f64>; 2]; 2]);
    impl WithSimd for Observe<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(state_layout, states, factors, seen, [first, second]) = self;
            let ([first_re, first_im], [second_re, second_im]) = (first, second);
            for level in state_layout {
                let count = level.len();
                let [re, im] = on(level, states);
                let [cosine, sine] = on(level, factors);
                let [one, other] = on(level, seen);
                let (first_re, first_im) = (&mut first_re[..count], &mut first_im[..count]);
                let (second_re, second_im) = (&mut second_re[..count], &mut second_im[..count]);
                for w in 0..count {
                    let turned_re = cosine[w] * re[w] - sine[w] * im[w];
                    let turned_im = cosine[w] * im[w] + sine[w] * re[w];
                    first_re[w] += one[w] * turned_re;
                    first_im[w] += one[w] * turned_im;
                    second_re[w] += other[w] * turned_re;
                    second_im[w] += other[w] * turned_im;
                }
            }
        }
    }
    let [first, second] = sums;
    first.iter_mut().chain(second.iter_mut()).for_each(|part| part.fill(0.0));
    Arch::new().dispatch(Observe(state_layout, states, factors, seen, [first, second]));
}

/// Adds amplitudes, each multiplied by a complex factor.
pub(crate) fn add_products(sums: &mut [Vec<f64>; 2], factors: Parts<'_>, amplitudes: Parts<'_>) {
    struct Add<'a>(&'a mut [f64], &'a mut [f64], Parts<'a>, Parts<'a>);
    impl WithSimd for Add<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(re, im, factors, amplitudes) = self;
            let count = re.len();
            let (im, [c, s]) = (&mut im[..count], [&factors[0][..count], &factors[1][..count]]);
            let [x, y] = [&amplitudes[0][..count], &amplitudes[1][..count]];
            for w in 0..count {
                re[w] += c[w] * x[w] - s[w] * y[w];
                im[w] += c[w] * y[w] + s[w] * x[w];
            }
        }
    }
    let [re, im] = sums;
    Arch::new().dispatch(Add(re, im, factors, amplitudes));
}

/// Propagation of the states over a step: propagation factors, and the weights of the flux amplitudes of both stages.
#[derive(Clone, Copy)]
pub(crate) struct Carrier<'a> {
    pub factors: Parts<'a>,
    pub known: Parts<'a>,
    pub own: Parts<'a>,
}

/// Propagates the states over a step, from `before` to `after`; `heat`: amplitudes of the fluxes of both stages.
pub(crate) fn carry(
    state_layout: &[Level],
    before: Parts<'_>,
    after: [&mut [f64]; 2],
    carrier: Carrier<'_>,
    heat: [Parts<'_>; 2],
) {
    struct Carry<'a>(&'a [Level], Parts<'a>, [&'a mut [f64]; 2], Carrier<'a>, [Parts<'a>; 2]);
    impl WithSimd for Carry<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(state_layout, before, [all_re, all_im], carrier, [first, end]) = self;
            for level in state_layout {
                let count = level.len();
                let (re, im) = (&mut all_re[level.clone()], &mut all_im[level.clone()]);
                let [start_re, start_im] = on(level, before);
                let [cosine, sine] = on(level, carrier.factors);
                let [a, b] = on(level, carrier.known);
                let [d, e] = on(level, carrier.own);
                let [first_re, first_im] = [&first[0][..count], &first[1][..count]];
                let [end_re, end_im] = [&end[0][..count], &end[1][..count]];
                for w in 0..count {
                    let x = [start_re[w], start_im[w]];
                    re[w] = cosine[w] * x[0] - sine[w] * x[1] + a[w] * first_re[w] - b[w] * first_im[w]
                        + d[w] * end_re[w]
                        - e[w] * end_im[w];
                    im[w] = cosine[w] * x[1]
                        + sine[w] * x[0]
                        + a[w] * first_im[w]
                        + b[w] * first_re[w]
                        + d[w] * end_im[w]
                        + e[w] * end_re[w];
                }
            }
        }
    }
    Arch::new().dispatch(Carry(state_layout, before, after, carrier, heat));
}

/// Converts the weights of a falling and of a rising flux in the states of one level into those of the known flux and
/// of the stage's own, input included, and adds the response of the modes to both: temperature and distortion, by the
/// observations `seen`; real and imaginary parts alternate. At the end of a step the known flux has the fraction
/// `share` of the falling one; `None`: all of it, the first stage.
pub(crate) fn stage_weights(
    share: Option<f64>,
    seen: Parts<'_>,
    weights: [&mut [f64]; 4],
    known: [&mut [f64]; 4],
    own: [&mut [f64]; 4],
) {
    struct StageWeights<'a>(Option<f64>, Parts<'a>, [&'a mut [f64]; 4], [&'a mut [f64]; 4], [&'a mut [f64]; 4]);
    impl WithSimd for StageWeights<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(share, [warm, moved], [a, b, c, d], mut known, mut own) = self;
            let count = warm.len();
            let ([share, taken], moved) = (share.map_or([1.0, 0.0], |share| [share, share]), &moved[..count]);
            let (a, b, c, d) = (&mut a[..count], &mut b[..count], &mut c[..count], &mut d[..count]);
            for (part, (falling, rising)) in [(a, c), (b, d)].into_iter().enumerate() {
                let [first, second] = [part, part + 2];
                let [known_warm, known_moved] =
                    known.get_disjoint_mut([first, second]).expect("two parts").map(|sum| &mut sum[..count]);
                let [own_warm, own_moved] =
                    own.get_disjoint_mut([first, second]).expect("two parts").map(|sum| &mut sum[..count]);
                for w in 0..count {
                    let before = warm[w] * (share * falling[w]);
                    let here = warm[w] * (falling[w] + rising[w] - taken * falling[w]);
                    (falling[w], rising[w]) = (before, here);
                    known_warm[w] += before * warm[w];
                    known_moved[w] += before * moved[w];
                    own_warm[w] += here * warm[w];
                    own_moved[w] += here * moved[w];
                }
            }
        }
    }
    Arch::new().dispatch(StageWeights(share, seen, weights, known, own));
}

/// Propagation factors of the states: the decay of each, times the phase factor of its mode.
pub(crate) fn phase(state_layout: &[Level], decay: &[f64], phases: Parts<'_>, factors: [&mut [f64]; 2]) {
    struct Turn<'a>(&'a [Level], &'a [f64], Parts<'a>, [&'a mut [f64]; 2]);
    impl WithSimd for Turn<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(state_layout, decay, phases, [all_re, all_im]) = self;
            for level in state_layout {
                let count = level.len();
                let decay = &decay[level.clone()];
                let (re, im) = (&mut all_re[level.clone()], &mut all_im[level.clone()]);
                let (cosine, sine) = (&phases[0][..count], &phases[1][..count]);
                for w in 0..count {
                    re[w] = cosine[w] * decay[w];
                    im[w] = sine[w] * decay[w];
                }
            }
        }
    }
    Arch::new().dispatch(Turn(state_layout, decay, phases, factors));
}

/// pi/2 in three parts, the first two of 33 bits: their products with the number of quarter turns are exact (Cody and Waite).
#[expect(clippy::excessive_precision, reason = "parts of pi/2 to the bit")]
const QUARTER: [f64; 3] =
    [1.570_796_326_734_125_614_17, 6.077_100_506_303_965_976_60e-11, 2.022_266_248_795_950_631_54e-21];

/// `cos` and `sin` of `angle` times each of the numbers, which are in ascending order.
pub(crate) fn phases(angle: f64, numbers: &[f64], cosine: &mut [f64], sine: &mut [f64]) {
    struct Phases<'a>(f64, &'a [f64], &'a mut [f64], &'a mut [f64]);
    impl WithSimd for Phases<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(angle, numbers, cosine, sine) = self;
            let count = numbers.len();
            let (cosine, sine) = (&mut cosine[..count], &mut sine[..count]);
            for w in 0..count {
                let whole = angle * numbers[w];
                let turns = (whole * FRAC_2_PI).round_ties_even();
                let x = ((whole - turns * QUARTER[0]) - turns * QUARTER[1]) - turns * QUARTER[2];
                let square = x * x;
                // Taylor series: at pi/4 the truncation error is below rounding.
                let mut even = 0.0;
                for factor in EVEN {
                    even = even * square + factor;
                }
                let mut odd = 0.0;
                for factor in ODD {
                    odd = odd * square + factor;
                }
                let (c, s) = (1.0 + square * even, x + x * square * odd);
                // Quarter turns modulo 4.
                let quarter = turns - 4.0 * (0.25 * turns).floor();
                let across = quarter == 1.0 || quarter == 3.0;
                let (c, s) = if across { (s, c) } else { (c, s) };
                cosine[w] = if quarter == 1.0 || quarter == 2.0 { -c } else { c };
                sine[w] = if quarter >= 2.0 { -s } else { s };
            }
        }
    }
    let largest = numbers.last().map_or(0.0, |number| (angle * number).abs());
    // Largest angle, rad, for which the number of quarter turns is exact.
    if largest <= 5e5 {
        return Arch::new().dispatch(Phases(angle, numbers, cosine, sine));
    }
    for (number, (cosine, sine)) in numbers.iter().zip(cosine.iter_mut().zip(sine)) {
        (*sine, *cosine) = (angle * number).sin_cos();
    }
}

/// `(cos x - 1)/x^2` and `(sin x - x)/x^3` as polynomials of x^2, from the highest power down.
const EVEN: [f64; 8] = alternating(16);
const ODD: [f64; 8] = alternating(17);

/// `-1/n!, 1/(n-2)!, ...` down to 2 or 3, with the sign -1 at the end.
const fn alternating(highest: u32) -> [f64; 8] {
    let mut result = [0.0; 8];
    let mut at = 0;
    while at < 8 {
        let (mut factorial, mut k) = (1.0, 2);
        while k <= highest - 2 * at as u32 {
            factorial *= k as f64;
            k += 1;
        }
        // Power 2m or 2m + 1 of x has the sign (-1)^m.
        let even = (highest / 2 - at as u32).is_multiple_of(2);
        result[at] = if even { 1.0 / factorial } else { -1.0 / factorial };
        at += 1;
    }
    result
}
