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
