//! Steady response of the contact by the modes without states: that of the whole punch less the modes with states.
//!
//! Theory: docs/theory.md, section 4.10.

use super::across::{Across, Sides};
use super::depth::Depth;
use super::waves::Waves;
use elasticity::Cells;
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Mean temperatures over the cells by steady unit fluxes in all transverse modes but the first `skipped`, N x N [K m2/W].
///
/// In the limit of a deep body with insulated sides the sum over all modes has a closed form, because
/// `integral integral cos(m s) cos(m t)/m ds dt` sums to differences of `C3(t) = sum cos(m t)/m^3`. Only the differences
/// from that limit are summed mode by mode, and converge fast.
pub(super) fn steady_beyond(
    across: &Across,
    depth: &Depth,
    cells: &Cells,
    waves: &Waves,
    skipped: usize,
) -> DMatrix<f64> {
    let weights = across.weights(cells);
    // Modes of short wavelength of an annulus are those of a straight body times the square root of r_m/r.
    let straight = match across.sides {
        Sides::Radial(_) => Sides::Free,
        sides => sides,
    };
    let unlosing = Across { transfer: 0.0, sides: straight, ..*across };
    let last = summed_modes(across, depth, skipped);
    let plain;
    let plain = if unlosing == *across {
        waves
    } else {
        plain = Waves::new(&unlosing, cells, last);
        &plain
    };
    let known = plain.sum(1..last, |_, wave| 1.0 / (depth.conductivity * wave.wave_number));
    let mut result = deep_and_insulated(across, depth, cells) - known;
    let root: Vec<f64> = weights.iter().zip(cells.widths()).map(|(weight, width)| (weight / width).sqrt()).collect();
    for (j, column) in root.iter().enumerate() {
        for (i, row) in root.iter().enumerate() {
            result[(i, j)] *= row * column;
        }
    }
    result += waves.sum(skipped..last, |_, wave| depth.steady_impedance(wave.decay));
    for (row, weight) in weights.iter().enumerate() {
        result.row_mut(row).scale_mut(1.0 / weight);
    }
    result
}

/// Number of modes that [`steady_beyond`] sums one by one.
pub(super) fn summed_modes(across: &Across, depth: &Depth, skipped: usize) -> usize {
    // Beyond 20 decay lengths the top has no effect; that of the sides falls like 1/m^4.
    let within_height = (20.0 * 2.0 * across.half_width / (PI * depth.height)).ceil() as usize;
    skipped.max(within_height).max(256)
}

/// Sum over all modes but the uniform one of the products of their cell integrals over k times the wave number.
fn deep_and_insulated(across: &Across, depth: &Depth, cells: &Cells) -> DMatrix<f64> {
    let width = 2.0 * across.half_width;
    let period = match across.sides {
        // Even continuation at both sides.
        Sides::Free | Sides::Radial(_) => 2.0 * width,
        Sides::Closed => width,
    };
    let angle: Vec<f64> = cells.edges().iter().map(|x| 2.0 * PI * (x + across.half_width) / period).collect();
    // Product of two edges: of sines from the side, or of cosines of their distance on the ring.
    let zeta: [f64; TERMS] = std::array::from_fn(|n| even_zeta(n as i32 + 1));
    let sum = |angle: f64| cubic_cosine_sum(angle, &zeta);
    let edges = DMatrix::from_fn(angle.len(), angle.len(), |i, j| match across.sides {
        Sides::Free | Sides::Radial(_) => 0.5 * (sum(angle[i] - angle[j]) - sum(angle[i] + angle[j])),
        Sides::Closed => sum(angle[i] - angle[j]),
    });
    let scale = 2.0 / (width * depth.conductivity) * (period / (2.0 * PI)).powi(3);
    DMatrix::from_fn(cells.count(), cells.count(), |i, j| {
        scale * (edges[(i + 1, j + 1)] - edges[(i + 1, j)] - edges[(i, j + 1)] + edges[(i, j)])
    })
}

/// Terms of the series of [`cubic_cosine_sum`].
const TERMS: usize = 26;

/// C3(t) = sum over m >= 1 of cos(m t)/m^3, to rounding; `zeta` at 2, 4, ...
///
/// Twice the integral of -ln(2 sin t/2) = -ln t + sum zeta(2n)/n (t/2 pi)^2n.
fn cubic_cosine_sum(angle: f64, zeta: &[f64; TERMS]) -> f64 {
    const ZETA_3: f64 = 1.202_056_903_159_594_2;
    let turn = angle.abs() % (2.0 * PI);
    let t = turn.min(2.0 * PI - turn);
    if t == 0.0 {
        return ZETA_3;
    }
    let square = t * t;
    let ratio = square / (4.0 * PI * PI);
    let mut sum = ZETA_3 + 0.5 * square * (t.ln() - 1.5);
    let mut power = 1.0;
    for (n, zeta) in zeta.iter().enumerate() {
        power *= ratio;
        let order = 2.0 * (n + 1) as f64;
        sum -= 2.0 * zeta * power * square / (order * (order + 1.0) * (order + 2.0));
    }
    sum
}

/// Riemann's zeta function at 2 n.
fn even_zeta(n: i32) -> f64 {
    match n {
        1 => PI * PI / 6.0,
        2 => PI.powi(4) / 90.0,
        3 => PI.powi(6) / 945.0,
        4 => PI.powi(8) / 9450.0,
        5 => PI.powi(10) / 93555.0,
        _ => (1..=20).rev().map(|k| f64::from(k).powi(-2 * n)).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::FarBoundary;

    #[test]
    fn closed_sums_are_those_of_the_series() {
        let zeta = std::array::from_fn(|n| even_zeta(n as i32 + 1));
        for angle in [0.0f64, 1e-3, 0.4, 2.0, 3.1, 4.0, 6.2, 7.0, -1.0] {
            let series: f64 = (1..40_000).rev().map(|m| (f64::from(m) * angle).cos() / f64::from(m).powi(3)).sum();
            let error = (cubic_cosine_sum(angle, &zeta) - series).abs();
            assert!(error < 1e-9, "{angle}: {error:e}");
        }
        assert!((cubic_cosine_sum(PI, &zeta) + 0.75 * cubic_cosine_sum(0.0, &zeta)).abs() < 1e-15);
    }

    #[test]
    fn steady_response_is_the_sum_of_all_modes() {
        let cells = Cells::graded(0.03, 7).unwrap();
        let depth = Depth {
            height: 0.05,
            conductivity: 55.0,
            capacity: 3.6e6,
            top: FarBoundary::Convecting(100.0),
            face: 0.0,
            driven_top: false,
        };
        for (sides, transfer) in [(Sides::Free, 0.0), (Sides::Free, 4e3), (Sides::Closed, 4e3)] {
            let across = Across { half_width: 0.03, sides, cooled: 2.0, transfer, conductivity: 55.0 };
            let waves = Waves::new(&across, &cells, 256);
            let scale = steady_beyond(&across, &depth, &cells, &waves, 0).amax();
            for skipped in [0, 1, 9] {
                let found = steady_beyond(&across, &depth, &cells, &waves, skipped);
                let mut expected = DMatrix::zeros(7, 7);
                for m in skipped..6000 {
                    let wave = across.wave(m);
                    let integrals = nalgebra::DVector::from_vec(wave.cell_integrals(&cells));
                    expected.ger(depth.steady_impedance(wave.decay), &integrals, &integrals, 1.0);
                }
                for (row, width) in cells.widths().iter().enumerate() {
                    expected.row_mut(row).scale_mut(1.0 / width);
                }
                let error = (&found - &expected).amax() / scale;
                assert!(error < 1e-6, "{sides:?} {transfer} {skipped}: {error:e}");
            }
        }
    }
}
