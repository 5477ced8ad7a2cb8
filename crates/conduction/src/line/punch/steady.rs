//! Steady response of the contact by the modes without states: that of the whole punch less the modes with states.
//!
//! Theory: docs/theory.md, section 4.10.

use super::across::{Across, Sides, Wave};
use super::depth::Depth;
use super::waves::Waves;
use elasticity::Cells;
use nalgebra::DMatrix;
use std::f64::consts::PI;
use std::ops::Range;

/// Steady response of all transverse modes but some.
///
/// In the limit of a deep body with insulated sides the sum over all modes has a closed form, because
/// `integral integral cos(m s) cos(m t)/m ds dt` sums to differences of `C3(t) = sum cos(m t)/m^3`. Only the differences
/// from that limit are summed mode by mode, and converge fast, on cells as narrow as they may be.
pub(super) struct SteadyBeyond<'a> {
    across: &'a Across,
    depth: &'a Depth,
    /// Number of modes left out, the first ones, and of those that are summed one by one.
    skipped: usize,
    last: usize,
    /// The width with insulated sides. Modes of short wavelength of an annulus are those of a straight body times the square root of r_m/r.
    insulated: Across,
    zeta: [f64; TERMS],
}

/// Cells with their modes.
pub(super) struct Span<'a> {
    waves: &'a Waves,
    /// Modes with insulated sides, where they are others.
    insulated: Option<Waves>,
    /// Phase of the slowest mode at the edges.
    edges: Vec<f64>,
    /// Root of the weight over the width.
    root: Vec<f64>,
}

impl Span<'_> {
    fn insulated(&self) -> &Waves {
        self.insulated.as_ref().unwrap_or(self.waves)
    }
}

impl<'a> SteadyBeyond<'a> {
    /// That of all modes but the first `skipped`.
    pub(crate) fn new(across: &'a Across, depth: &'a Depth, skipped: usize) -> SteadyBeyond<'a> {
        let straight = match across.sides {
            Sides::Radial(_) => Sides::Free,
            sides => sides,
        };
        let insulated = Across { transfer: 0.0, sides: straight, ..*across };
        let last = summed_modes(across, depth, skipped);
        let zeta = std::array::from_fn(|n| even_zeta(n as i32 + 1));
        SteadyBeyond { across, depth, skipped, last, insulated, zeta }
    }

    /// Period of the modes, m.
    fn period(&self) -> f64 {
        let width = 2.0 * self.across.half_width;
        match self.across.sides {
            // Even continuation at both sides.
            Sides::Free | Sides::Radial(_) => 2.0 * width,
            Sides::Closed => width,
        }
    }

    /// Prepares cells with their `waves`, at least as many as [`summed_modes`].
    pub(crate) fn over<'w>(&self, cells: &Cells, waves: &'w Waves) -> Span<'w> {
        let weights = self.across.weights(cells);
        let phase = |x: &f64| 2.0 * PI * (x + self.across.half_width) / self.period();
        Span {
            waves,
            insulated: (self.insulated != *self.across).then(|| Waves::new(&self.insulated, cells, self.last)),
            edges: cells.edges().iter().map(phase).collect(),
            root: weights.iter().zip(cells.widths()).map(|(weight, width)| (weight / width).sqrt()).collect(),
        }
    }

    /// Temperature integrals over some of the cells of one span by steady unit fluxes into some of another, K m3/W.
    pub(crate) fn between(
        &self,
        (one, rows): (&Span<'_>, Range<usize>),
        (other, columns): (&Span<'_>, Range<usize>),
    ) -> DMatrix<f64> {
        let ranges = [rows.clone(), columns.clone()];
        let per_wave = |_: usize, wave: &Wave| 1.0 / (self.depth.conductivity * wave.wave_number);
        let known = one.insulated().sum_between(other.insulated(), ranges.clone(), 1..self.last, per_wave);
        let mut result =
            self.deep_and_insulated(&one.edges[rows.start..=rows.end], &other.edges[columns.start..=columns.end]);
        result -= known;
        for (column, right) in result.column_iter_mut().zip(&other.root[columns]) {
            for (entry, left) in column.into_iter().zip(&one.root[rows.clone()]) {
                *entry *= left * right;
            }
        }
        let impedance = |_: usize, wave: &Wave| self.depth.steady_impedance(wave.decay);
        result + one.waves.sum_between(other.waves, ranges, self.skipped..self.last, impedance)
    }

    /// Sum over all modes but the uniform one of the products of their integrals between edges, over k times the wave number.
    fn deep_and_insulated(&self, rows: &[f64], columns: &[f64]) -> DMatrix<f64> {
        // Product of two edges: of sines from the side, or of cosines of their distance on the ring.
        let sum = |angle: f64| cubic_cosine_sum(angle, &self.zeta);
        let edges = DMatrix::from_fn(rows.len(), columns.len(), |i, j| match self.across.sides {
            Sides::Free | Sides::Radial(_) => 0.5 * (sum(rows[i] - columns[j]) - sum(rows[i] + columns[j])),
            Sides::Closed => sum(rows[i] - columns[j]),
        });
        let width = 2.0 * self.across.half_width;
        let scale = 2.0 / (width * self.depth.conductivity) * (self.period() / (2.0 * PI)).powi(3);
        DMatrix::from_fn(rows.len() - 1, columns.len() - 1, |i, j| {
            scale * (edges[(i + 1, j + 1)] - edges[(i + 1, j)] - edges[(i, j + 1)] + edges[(i, j)])
        })
    }
}

/// Number of modes that [`SteadyBeyond`] sums one by one.
pub(super) fn summed_modes(across: &Across, depth: &Depth, skipped: usize) -> usize {
    // Beyond 20 decay lengths the top has no effect; that of the sides falls like 1/m^4.
    let within_height = (20.0 * 2.0 * across.half_width / (PI * depth.height)).ceil() as usize;
    skipped.max(within_height).max(256)
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
            let mut scale = 0.0;
            for skipped in [0, 1, 9] {
                let beyond = SteadyBeyond::new(&across, &depth, skipped);
                let span = beyond.over(&cells, &waves);
                let found = beyond.between((&span, 0..7), (&span, 0..7));
                let mut expected = DMatrix::zeros(7, 7);
                for m in skipped..6000 {
                    let wave = across.wave(m);
                    let integrals = nalgebra::DVector::from_vec(wave.cell_integrals(&cells));
                    expected.ger(depth.steady_impedance(wave.decay), &integrals, &integrals, 1.0);
                }
                scale = found.amax().max(scale);
                let some = beyond.between((&span, 2..4), (&span, 1..6));
                assert!((some - found.view((2, 1), (2, 5))).amax() < 1e-12 * scale);
                let error = (&found - &expected).amax() / scale;
                assert!(error < 1e-6, "{sides:?} {transfer} {skipped}: {error:e}");
            }
        }
    }
}
