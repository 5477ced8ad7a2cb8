//! Thermoelastic instability in full periodic contact: growth of pressure waves by frictional heat, distortion and wear.
//!
//! A conducting half-plane that wears slides on a rigid insulator. In a wave `exp(i m x + b t)` the elastic displacement,
//! the distortion by the heat `mu V p` and the wear sum to zero (Dow and Burton, Wear 19, 1972, without wear):
//!
//! ```text
//! 2 (1-nu^2)/(E m) (1 + i eps) - 2 alpha (1+nu) mu V/(K lambda (lambda + m)) + k V/b = 0,   lambda^2 = m^2 + b/kd
//! ```
//!
//! With `z = lambda/m`, the critical speed `2 K m (1-nu)/(mu E alpha)`, R = V over it, and `w = k K/(mu alpha (1+nu) kd)`
//! that is
//!
//! ```text
//! (1 + i eps) z^3 - (1 + i eps + (2 - w) R) z + 2 R = 0,   Re z > 0,   b = kd m^2 (z^2 - 1),
//! ```
//!
//! without wear `z (1 + z) (1 + i eps) = 2 R`, because z = 1 is then not a wave. `eps = mu (1-2nu)/(2(1-nu))` is the shear
//! coupling; its sign is the direction in which the wave travels.
//!
//! Theory: docs/theory.md, sections 10, 7.4.

use nalgebra::Complex;

/// Growth rate over `kd m^2` of the wave that grows fastest (or decays slowest) at `ratio` times the critical speed, with
/// the wear number `wear` (w above, >= 0) and the shear coupling `coupling` (eps above). The imaginary part, in either sign,
/// is the angular frequency. -1, the upper end of the continuous spectrum, where no discrete eigenvalue exists.
pub fn growth_rate(ratio: f64, wear: f64, coupling: f64) -> Complex<f64> {
    let one = Complex::new(1.0, 0.0);
    let unit = Complex::new(1.0, coupling);
    let roots = if wear == 0.0 {
        // z^2 + z - 2R/(1 + i eps) = 0.
        let root = (one + 8.0 * ratio / unit).sqrt();
        vec![0.5 * (root - one), -0.5 * (root + one)]
    } else {
        cubic(-(one + (2.0 - wear) * ratio / unit), 2.0 * ratio / unit)
    };
    let standing = roots.into_iter().filter(|z| z.re > 0.0).map(|z| z * z - one);
    standing.fold(-one, |best, b| if b.re > best.re { b } else { best })
}

/// Critical ratio: speed over the critical speed at the onset of growth, `[q^2 + 1 + sqrt(1 + 2 q^2)]/q^3`, q = 2 - w; 1
/// without wear, infinite from w = 2 on.
pub fn critical_ratio(wear: f64) -> f64 {
    let q = 2.0 - wear;
    if wear == 0.0 {
        1.0
    } else if q <= 0.0 {
        f64::INFINITY
    } else {
        (q * q + 1.0 + (1.0 + 2.0 * q * q).sqrt()) / q.powi(3)
    }
}

/// Angular frequency over `kd m^2` of waves at the critical ratio: `sqrt(c^2 - 2 c)`, c = q R.
pub fn critical_frequency(wear: f64) -> f64 {
    let c = (2.0 - wear) * critical_ratio(wear);
    (c * c - 2.0 * c).max(0.0).sqrt()
}

/// Roots of `z^3 + a z + b` (Durand and Kerner).
fn cubic(a: Complex<f64>, b: Complex<f64>) -> Vec<Complex<f64>> {
    let scale = 1.0 + a.norm().sqrt().max(b.norm().cbrt());
    let start = Complex::new(0.4, 0.9);
    let mut roots = [start.scale(scale), (start * start).scale(scale), (start * start * start).scale(scale)];
    for _ in 0..200 {
        let mut moved: f64 = 0.0;
        for i in 0..3 {
            let z = roots[i];
            let others: Complex<f64> = (0..3).filter(|&j| j != i).map(|j| z - roots[j]).product();
            let change = (z * z * z + a * z + b) / others;
            roots[i] -= change;
            moved = moved.max(change.norm());
        }
        if moved < 1e-15 * scale {
            break;
        }
    }
    roots.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_thresholds() {
        for (wear, ratio, frequency) in [(0.1, 1.09011, 0.38403), (1.0, 3.73205, 2.54246)] {
            assert!((critical_ratio(wear) / ratio - 1.0).abs() < 5e-6);
            assert!((critical_frequency(wear) / frequency - 1.0).abs() < 2e-5);
            // The root is imaginary there, with that frequency.
            let b = growth_rate(critical_ratio(wear), wear, 0.0);
            assert!(b.re.abs() < 1e-12 && (b.im.abs() / critical_frequency(wear) - 1.0).abs() < 1e-12, "{b}");
            assert!(growth_rate(0.99 * ratio, wear, 0.0).re < 0.0 && growth_rate(1.01 * ratio, wear, 0.0).re > 0.0);
        }
        assert_eq!(critical_ratio(2.0), f64::INFINITY);
        assert!(growth_rate(1e4, 2.0, 0.0).re < 0.0);
    }
}
