use super::*;
use crate::HalfPlane;

fn steel() -> Material {
    Material::new(2.6, 0.3).unwrap()
}

fn largest(matrix: &DMatrix<f64>) -> f64 {
    matrix.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[test]
fn zeta_values() {
    assert!((zeta_less_one(2) - (PI * PI / 6.0 - 1.0)).abs() < 1e-15);
    assert!((zeta_less_one(4) - (PI.powi(4) / 90.0 - 1.0)).abs() < 1e-15);
    assert!((zeta_less_one(20) / 9.539_620_338_728e-7 - 1.0).abs() < 1e-12);
}

/// Brute-force Fourier sum of the cell means on a closed strip, all modes to the given number.
fn fourier_sum(strip: &Strip, cells: &Cells, period: f64, modes: usize, i: usize, j: usize) -> (f64, f64) {
    let nu = strip.material.poissons_ratio();
    let kernel = StripKernel::new(strip.base, nu);
    let (x, c) = (cells.centres(), cells.widths());
    // All round a layer cannot expand sideways on the mean: its height over lambda + 2G, whatever its base.
    let confined = 0.5 * (1.0 - 2.0 * nu) / (1.0 - nu).powi(2);
    let (mut normal, mut shear) = (PI * strip.height / period * confined, 0.0);
    for k in (1..=modes).rev() {
        let q = 2.0 * PI * k as f64 / period;
        let mean = sinc(0.5 * q * c[i]) * sinc(0.5 * q * c[j]) / k as f64;
        normal += mean * kernel.normal(q * strip.height) * (q * (x[i] - x[j])).cos();
        shear += mean * kernel.shear(q * strip.height) * (q * (x[i] - x[j])).sin();
    }
    let g = strip.material.shear_modulus();
    ((1.0 - nu) / (PI * g) * c[j] * normal, 0.5 / (PI * g) * c[j] * shear)
}

#[test]
fn closed_strip_equals_its_fourier_sum() {
    // The sum converges like 1/modes^2 for cells of one width.
    for (base, count, length) in
        [(Base::Bonded, 8, 2.0), (Base::Smooth, 8, 3.0), (Base::Bonded, 1, 2.0), (Base::Smooth, 2, 2.0)]
    {
        let strip = Strip::new(steel(), 0.4, base, Extent::Closed(length)).unwrap();
        let cells = Cells::graded(1.0, count).unwrap();
        let compliance = strip.compliance(&cells);
        for i in 0..count {
            for j in 0..count {
                let (normal, shear) = fourier_sum(&strip, &cells, length, 100_000, i, j);
                let error = (compliance.normal[(i, j)] - normal).abs();
                assert!(error < 2e-8, "{base:?} C({i},{j}) {error:e}");
                let error = (compliance.shear[(i, j)] - shear).abs();
                assert!(error < 2e-8, "{base:?} S({i},{j}) {error:e}");
            }
        }
    }
}

#[test]
fn straight_strip_does_not_depend_on_the_auxiliary_period() {
    for base in [Base::Bonded, Base::Smooth] {
        for (nu, height) in [(0.0, 1.0), (0.3, 0.02), (0.3, 50.0), (0.4999, 1.0), (0.4999, 0.02)] {
            let material = Material::new(2.6, nu).unwrap();
            let strip = Strip::new(material, height, base, Extent::Straight).unwrap();
            let cells = Cells::graded(1.0, 17).unwrap();
            let usual = strip.compliance(&cells);
            let longer = strip.on_period(&cells, f64::INFINITY, 2.0 + 1.37 * 40.0 * height);
            let scale = largest(&HalfPlane { material }.compliance(&cells).normal);
            let error = largest(&(&usual.normal - &longer.normal)) / scale;
            assert!(error < 1e-11, "{base:?} nu {nu} h {height}: C {error:e}");
            let error = largest(&(&usual.shear - &longer.shear)) / scale;
            assert!(error < 1e-11, "{base:?} nu {nu} h {height}: S {error:e}");
        }
    }
}

#[test]
fn a_closed_strip_longer_than_its_memory_is_summed_over_less_than_its_length() {
    for base in [Base::Bonded, Base::Smooth] {
        for (nu, length) in [(0.0, 5.0), (0.3, 3.0), (0.4999, 7.0)] {
            let strip = Strip::new(Material::new(2.6, nu).unwrap(), 0.02, base, Extent::Closed(length)).unwrap();
            let cells = Cells::graded(1.0, 17).unwrap();
            let (usual, whole) = (strip.compliance(&cells), strip.on_period(&cells, length, length));
            let scale = largest(&whole.normal);
            for (usual, whole) in [(&usual.normal, &whole.normal), (&usual.shear, &whole.shear)] {
                assert!(largest(&(usual - whole)) < 1e-11 * scale, "{base:?} nu {nu} length {length}");
            }
        }
    }
}

#[test]
fn a_strip_too_flat_for_its_fourier_sum_is_refused() {
    let cells = Cells::graded(1.0, 5).unwrap();
    let strip = |height: f64| Strip::new(steel(), height, Base::Bonded, Extent::Straight).unwrap();
    assert!(strip(1e-4).try_compliance(&cells).is_ok());
    let refused = strip(1e-4_f64.next_down()).try_compliance(&cells).unwrap_err().to_string();
    assert!(refused.contains("strip height") && refused.contains("twenty thousandth"), "{refused}");
}

#[test]
fn straight_strip_equals_its_fourier_integral() {
    // Entries of C and S by direct quadrature over q: trapezoidal rule on a far longer period is no independent
    // check, so composite Gauss quadrature with the half-plane's logarithm of a finite cut-off removed:
    // 1/q (Phi - 1 + exp(-q h)) decays, and integral (1 - exp(-q h)) cos(q r)/q dq = -ln r + ln(r^2 + h^2)/2.
    let (height, cells) = (0.7, Cells::graded(1.0, 4).unwrap());
    let gauss = gauss_legendre(12);
    for base in [Base::Bonded, Base::Smooth] {
        let strip = Strip::new(steel(), height, base, Extent::Straight).unwrap();
        let kernel = StripKernel::new(base, 0.3);
        let point = |r: f64| {
            let (mut normal, mut shear) = (0.0, 0.0);
            for panel in 0..80 {
                for (node, weight) in &gauss {
                    let u = 0.25 * (2.0 * panel as f64 + 1.0 + node);
                    normal += 0.25 * weight * (kernel.normal_remainder(u) + (-u).exp()) / u * (u * r / height).cos();
                    let decaying = kernel.shear_remainder(u) + (-u).exp() * (0.4 - kernel.shear_at_zero());
                    shear += 0.25 * weight * decaying / u * (u * r / height).sin();
                }
            }
            let smooth = 0.5 * (r * r + height * height).ln();
            // integral (1 - exp(-u)) sin(u t)/u du = pi/2 - arctan t
            let t = r / height;
            let far = 0.4 * 0.5 * PI * t.signum() - (0.4 - kernel.shear_at_zero()) * t.atan();
            (normal + smooth, shear + far)
        };
        let compliance = strip.compliance(&cells);
        let (x, c) = (cells.centres(), cells.widths());
        for (i, j) in [(3, 0), (3, 1), (2, 0), (1, 3)] {
            let (mut normal, mut shear) = (mean_logarithm(x[i] - x[j], 0.5 * c[i], 0.5 * c[j]), 0.0);
            for (node_i, weight_i) in &gauss {
                for (node_j, weight_j) in &gauss {
                    let r = x[i] - x[j] + 0.5 * c[i] * node_i - 0.5 * c[j] * node_j;
                    let (n, s) = point(r);
                    normal += 0.25 * weight_i * weight_j * n;
                    shear += 0.25 * weight_i * weight_j * s;
                }
            }
            let error = (compliance.normal[(i, j)] - 0.7 / PI * c[j] * normal).abs();
            assert!(error < 1e-10, "{base:?} C({i},{j}) {error:e}");
            let error = (compliance.shear[(i, j)] - 0.5 / PI * c[j] * shear).abs();
            assert!(error < 1e-10, "{base:?} S({i},{j}) {error:e}");
        }
    }
}

#[test]
fn refusals_carry_the_numbers() {
    let short = Strip::new(steel(), 0.3, Base::Bonded, Extent::Closed(1.0)).unwrap();
    let message = short.try_compliance(&Cells::graded(1.0, 3).unwrap()).unwrap_err().to_string();
    assert_eq!(message, "strip length = 1 is out of range: must be at least the width of the contact zone");
    assert!(Strip::new(steel(), 0.0, Base::Bonded, Extent::Straight).is_err());
    assert!(Strip::new(steel(), 1.0, Base::Bonded, Extent::Closed(f64::NAN)).is_err());
}
