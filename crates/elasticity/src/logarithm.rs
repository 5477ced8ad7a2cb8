//! Mean of the logarithmic kernel over pairs of cells.
//!
//! The kernel `-ln |x - s|` is the short-distance limit of every elastic plane body. Its mean over two cells,
//! `1/(c_i c_j) integral_i integral_j -ln |x - s| ds dx`, has a closed form as a second difference of
//! `-r^2 ln|r|/2 + 3 r^2/4`. That difference cancels for small cells far apart (cells graded to the edges are 1e-4 of the
//! contact width wide), so for distant pairs the series in the moments of the distance is used instead.
//!
//! Theory: docs/theory.md, section 3.2.

/// Below this ratio of summed half-widths to distance the moment series is used; it then needs at most 36 terms.
const SERIES_RATIO: f64 = 0.6;

/// Mean of `-ln |x - s|` over `x` in a cell of half-width `alpha` and `s` in a cell of half-width `beta` whose centre
/// lies at `distance`.
///
/// Relative error about 1e-14 for cells that do not overlap or are identical. Units: the logarithm of a length in
/// the caller's unit.
pub fn mean_logarithm(distance: f64, alpha: f64, beta: f64) -> f64 {
    let distance = distance.abs();
    let reach = alpha + beta;
    if reach < SERIES_RATIO * distance {
        return series(distance, alpha, beta);
    }
    // Scaled with the reach, so that the logarithms are of order one and cancellation is least.
    let (d, a, b) = (distance / reach, alpha / reach, beta / reach);
    let difference = second_primitive(d + a + b) - second_primitive(d + a - b) - second_primitive(d - a + b)
        + second_primitive(d - a - b);
    difference / (4.0 * a * b) - reach.ln()
}

/// Second antiderivative of `-ln |r|`.
fn second_primitive(r: f64) -> f64 {
    let r = r.abs();
    if r == 0.0 { 0.0 } else { r * r * (0.75 - 0.5 * r.ln()) }
}

/// `-ln d + sum_m E[z^2m]/(2 m d^2m)` with `z` the sum of two uniform deviations of half-widths alpha and beta.
///
/// `E[z^2m] = 2 T_m/((2m+1)(2m+2))` with `T_m = sum_i s^i t^(m-i)`, `s = (alpha+beta)^2`, `t = (alpha-beta)^2`.
fn series(distance: f64, alpha: f64, beta: f64) -> f64 {
    let s = ((alpha + beta) / distance).powi(2);
    let t = ((alpha - beta) / distance).powi(2);
    let (mut sum, mut moment_sum, mut t_power) = (0.0, 1.0, 1.0);
    for m in 1..60 {
        t_power *= t;
        moment_sum = s * moment_sum + t_power;
        let order = 2.0 * m as f64;
        let term = 2.0 * moment_sum / ((order + 1.0) * (order + 2.0) * order);
        sum += term;
        if term < 1e-17 {
            break;
        }
    }
    sum - distance.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identical_cells() {
        // Mean of -ln|x - s| over one cell of width c: 3/2 - ln c.
        for width in [1e-6, 0.3, 40.0] {
            let error = mean_logarithm(0.0, width / 2.0, width / 2.0) - (1.5 - f64::ln(width));
            assert!(error.abs() < 1e-14, "{error:e}");
        }
    }

    #[test]
    fn neighbours() {
        // Two touching cells of width 1: integral over the union, 4 (3/2 - ln 2), less the two own ones, 2 * 3/2.
        let exact = (4.0 * (1.5 - f64::ln(2.0)) - 3.0) / 2.0;
        assert!((mean_logarithm(1.0, 0.5, 0.5) - exact).abs() < 1e-14);
        assert!((mean_logarithm(-1.0, 0.5, 0.5) - exact).abs() < 1e-14);
    }

    #[test]
    fn series_and_closed_form_agree_where_both_hold() {
        for (alpha, beta) in [(0.5, 0.5), (0.9, 0.1), (0.3, 0.1)] {
            let distance = (alpha + beta) / (0.999 * SERIES_RATIO);
            let by_series = mean_logarithm(distance, alpha, beta);
            let (a, b) = (alpha, beta);
            let exact = (second_primitive(distance + a + b)
                - second_primitive(distance + a - b)
                - second_primitive(distance - a + b)
                + second_primitive(distance - a - b))
                / (4.0 * a * b);
            assert!((by_series - exact).abs() < 1e-13, "{:e}", by_series - exact);
        }
    }

    #[test]
    fn tiny_cells_far_apart_keep_full_accuracy() {
        // -ln d + (alpha^2 + beta^2)/(6 d^2) + O(d^-4)
        let value = mean_logarithm(2.0, 1e-6, 2e-6);
        assert!((value + f64::ln(2.0) - 5e-12 / 24.0).abs() < 1e-16);
    }
}
