//! Closed forms of wearing contacts.
//!
//! Theory: docs/theory.md, section 10.

/// Decay rate per sliding distance, in 1/m, of a pressure deviation on a Winkler foundation of stiffness `k_w` (Pa/m).
///
/// `k_w k b (p_m/p_0)^(b-1)`, linear in the deviation; exact for b = 1. `wear` is the wear depth per pressure and
/// distance k (1/Pa), `relative_pressure` the mean pressure over the reference pressure of the wear law.
pub fn winkler_relaxation_rate(stiffness: f64, wear: f64, exponent: f64, relative_pressure: f64) -> f64 {
    stiffness * wear * exponent * relative_pressure.powf(exponent - 1.0)
}

/// Half-width, in m, of the flat that a cylinder of radius R wears after the distance s, at late times:
/// `a^3 = (3/2) k F' R s`, the worn segment `2 a^3/(3 R)` being the worn area `k F' s`.
pub fn worn_cylinder_half_width(wear: f64, load: f64, radius: f64, distance: f64) -> f64 {
    (1.5 * wear * load * radius * distance).cbrt()
}

/// Steady pressure of an annular punch, in Pa: `p = C r^(-a/b)` with `F = depth integral p (r/r_m) dr`.
///
/// Uniform wear rate `p^b v^a` with v proportional to r. `exponents` are (a, b), `radii` inner and outer in m, r_m
/// their mean, `load` F per depth in N/m.
pub fn annular_pressure(radius: f64, load: f64, radii: (f64, f64), exponents: (f64, f64)) -> f64 {
    let (inner, outer) = radii;
    let power = exponents.0 / exponents.1;
    let mean = 0.5 * (inner + outer);
    let order = 2.0 - power;
    let integral =
        if order.abs() < 1e-9 { (outer / inner).ln() } else { (outer.powf(order) - inner.powf(order)) / order };
    load * mean / integral * radius.powf(-power)
}

/// Steady `p/pm` of a rotating punch in unidirectional sliding that wears with b = 1: `1 + 12 e x/L^2`, `e = mu H` the lever
/// of the resultant, L the width; valid for |e| <= L/6.
pub fn unidirectional_rotating_pressure(x: f64, lever: f64, width: f64) -> f64 {
    1.0 + 12.0 * lever * x / (width * width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn annular_pressure_carries_the_load() {
        for exponents in [(1.0, 1.0), (0.0, 1.0), (2.0, 1.0), (1.0, 0.5), (1.3, 0.8)] {
            let (radii, n) = ((0.09, 0.145), 20_000);
            let step = (radii.1 - radii.0) / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| {
                    let r = radii.0 + (f64::from(i) + 0.5) * step;
                    annular_pressure(r, 7e4, radii, exponents) * r / 0.1175 * step
                })
                .sum();
            assert!((sum / 7e4 - 1.0).abs() < 1e-8, "{exponents:?}");
            // Wear rate p^b r^a is uniform.
            let rate = |r: f64| annular_pressure(r, 7e4, radii, exponents).powf(exponents.1) * r.powf(exponents.0);
            assert!((rate(0.09) / rate(0.145) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn rotating_punch_at_the_limit() {
        let pressure = |x| unidirectional_rotating_pressure(x, 0.06 / 6.0, 0.06);
        assert!(pressure(-0.03).abs() < 1e-15 && (pressure(0.03) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn worn_area_of_the_cylinder() {
        // Segment of chord 2a of a circle of radius R, to first order 2 a^3/(3 R).
        let a = worn_cylinder_half_width(1e-13, 1e5, 0.02, 1e3);
        assert!((2.0 * a.powi(3) / (3.0 * 0.02) / (1e-13 * 1e5 * 1e3) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn winkler_rate() {
        assert_eq!(winkler_relaxation_rate(2e12, 1e-14, 1.0, 17.0), 0.02);
        assert!((winkler_relaxation_rate(2e12, 1e-14, 0.5, 4.0) - 0.005).abs() < 1e-15);
    }
}
