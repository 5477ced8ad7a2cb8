//! Integrals of a state whose phase rate changes much over a step, in closed form.
//!
//! With `a = z + i eta`, `a u - i eta u^2` is the exponent of
//!
//! ```text
//! integral_0^1 exp(z u + i eta u (1-u)) {1, u} du,    eta > 0, Re z <= 0
//! ```
//!
//! and both integrals are differences of those from 0 and from 1 to infinity, whose exponentials at their ends are 1
//! and e^z:
//!
//! ```text
//! F(k) = integral_0^inf exp(-k t - i eta t^2) dt = sqrt(pi)/(2s) erfcx(k/(2s)),    s = sqrt(i eta)
//! G(k) = integral_0^inf t exp(-k t - i eta t^2) dt = (1 - k F)/(2 i eta)
//! integrals of 1 and u:   F(-a) - e^z F(i eta - z),   G(-a) - e^z [F + G](i eta - z)
//! ```
//!
//! erfcx(x) = exp(x^2) erfc(x), for Re x >= 0 by J. A. C. Weideman, SIAM J. Numer. Anal. 31 (1994) 1497-1518 (32 terms:
//! relative error 3e-12); beyond |k|^2 = 1000 eta the asymptotic series of F and G are used, since 1 - k F cancels. For
//! Re(k/s) < 0 the tail is taken in the opposite direction; the integral contains the whole Gaussian where the phase
//! rate vanishes within the step. The number of operations does not depend on the arguments.
//!
//! Theory: docs/theory.md, section 5.3.

use nalgebra::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// `integral exp(z u + i eta u (1-u)) {1, u} du` over (0, 1) for |eta| well above 1; `factor` = e^z.
pub(crate) fn integrals(z: Complex<f64>, factor: Complex<f64>, eta: f64) -> (Complex<f64>, Complex<f64>) {
    if eta < 0.0 {
        let (all, falling) = rising(z.conj(), factor.conj(), -eta);
        return (all.conj(), falling.conj());
    }
    rising(z, factor, eta)
}

fn rising(z: Complex<f64>, factor: Complex<f64>, eta: f64) -> (Complex<f64>, Complex<f64>) {
    let turned = Complex::new(0.0, eta);
    let first = Tail::new(-z - turned, eta);
    let last = Tail::new(turned - z, eta);
    let mut all = first.all - factor * last.all;
    let mut falling = first.weighted - factor * (last.all + last.weighted);
    if first.other_side && !last.other_side {
        let rate = z + turned;
        let whole = (rate * rate / (4.0 * turned)).exp() * root(eta).inv() * PI.sqrt();
        all += whole;
        falling += whole * rate / (2.0 * turned);
    }
    (all, falling)
}

/// sqrt(i eta).
fn root(eta: f64) -> Complex<f64> {
    Complex::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2) * eta.sqrt()
}

/// F and G, or their values less the whole Gaussian, in the direction of decay.
struct Tail {
    all: Complex<f64>,
    weighted: Complex<f64>,
    other_side: bool,
}

impl Tail {
    fn new(rate: Complex<f64>, eta: f64) -> Tail {
        let other_side = rate.re + rate.im < 0.0;
        let k = if other_side { -rate } else { rate };
        let (all, weighted) = if k.norm_sqr() >= ASYMPTOTIC * eta {
            let inverse = k.inv();
            let y = inverse * inverse * Complex::new(0.0, -eta);
            let sum = |coefficients: &[f64; ASYMPTOTIC_TERMS]| {
                coefficients.iter().rev().fold(Complex::from(0.0), |sum, coefficient| sum * y + coefficient)
            };
            (inverse * sum(&ALL), inverse * inverse * sum(&WEIGHTED))
        } else {
            let half = (2.0 * root(eta)).inv();
            let all = half * PI.sqrt() * scaled_erfc(k * half);
            (all, (1.0 - k * all) / Complex::new(0.0, 2.0 * eta))
        };
        Tail { all: if other_side { -all } else { all }, weighted, other_side }
    }
}

/// |k|^2/eta from which on the asymptotic series is used: its first omitted term is 7e-13.
const ASYMPTOTIC: f64 = 1000.0;
const ASYMPTOTIC_TERMS: usize = 6;
/// (2n)!/n! and (2n+1)!/n!.
const ALL: [f64; ASYMPTOTIC_TERMS] = [1.0, 2.0, 12.0, 120.0, 1680.0, 30240.0];
const WEIGHTED: [f64; ASYMPTOTIC_TERMS] = [1.0, 6.0, 60.0, 840.0, 15120.0, 332_640.0];

/// exp(x^2) erfc(x) for Re x >= 0.
fn scaled_erfc(x: Complex<f64>) -> Complex<f64> {
    let inverse = (x + SCALE).inv();
    let argument = (Complex::from(SCALE) - x) * inverse;
    let sum = WEIDEMAN.iter().rev().fold(Complex::from(0.0), |sum, coefficient| sum * argument + coefficient);
    inverse * (2.0 * sum * inverse + 1.0 / PI.sqrt())
}

/// sqrt(N/sqrt 2), N = 32.
const SCALE: f64 = 4.756_828_460_010_884;
/// Fourier coefficients of `exp(-t^2) (L^2 + t^2)`, `t = L tan(theta/2)`.
const WEIDEMAN: [f64; 32] = [
    2.572_253_408_124_569,
    2.263_537_299_900_267_6,
    1.825_669_629_632_481_3,
    1.345_544_169_234_545_1,
    0.901_925_489_364_8,
    0.546_013_972_063_934_2,
    0.295_444_510_715_087_3,
    0.140_607_162_268_937_85,
    0.057_304_403_529_837_19,
    0.019_006_155_784_845_477,
    0.004_519_541_105_349_286,
    0.000_392_591_360_700_789_6,
    -0.000_245_329_802_700_181_2,
    -0.000_130_754_492_546_098_54,
    -2.140_961_920_182_182_6e-5,
    6.821_031_944_000_645e-6,
    4.401_531_731_530_374e-6,
    4.255_833_137_355_632e-7,
    -4.184_076_371_185_529e-7,
    -1.481_307_891_793_793e-7,
    2.293_043_903_089_130_7e-8,
    2.379_755_670_492_633_2e-8,
    8.124_889_174_050_19e-10,
    -3.208_015_220_602_109e-9,
    -5.231_022_115_795_881e-10,
    4.153_742_283_768_118e-10,
    1.165_823_850_551_327e-10,
    -5.544_247_434_751_948e-11,
    -2.154_362_353_454_026e-11,
    8.030_394_123_342_998e-12,
    3.741_034_357_970_915e-12,
    -1.303_348_124_509_092_6e-12,
];
