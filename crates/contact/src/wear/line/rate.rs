//! Depth rate of wear as a function of the local pressure, in a variable that is regular for every wear law.
//!
//! Theory: docs/theory.md, sections 2.3, 6.7.

use crate::wear::law::{PressureLaw, REFERENCE_PRESSURE};

/// Depth rate at the reference pressure, in m/s (or m per m of sliding, if time is counted in sliding distance), >= 0,
/// including speed, friction and temperature factors.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// One value for all cells.
    Uniform(f64),
    /// N values, which are overwritten in place to change them from step to step without allocating.
    PerCell(Vec<f64>),
}

impl Coefficient {
    /// Value of a cell.
    #[inline]
    pub fn at(&self, cell: usize) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::PerCell(values) => values[cell],
        }
    }

    /// Whether every cell has the value 0.
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Uniform(value) => *value == 0.0,
            Self::PerCell(values) => values.iter().all(|value| *value == 0.0),
        }
    }
}

impl From<f64> for Coefficient {
    fn from(value: f64) -> Self {
        Self::Uniform(value)
    }
}

impl From<Vec<f64>> for Coefficient {
    fn from(values: Vec<f64>) -> Self {
        Self::PerCell(values)
    }
}

/// Depth rate of one body: coefficient times law of p/p0 on every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct WearTerm {
    /// Depth rate at the reference pressure.
    pub coefficient: Coefficient,
    /// Factor of the pressure.
    pub law: PressureLaw,
}

/// Depth rate `f(p) = sum_i c_i f_i(p/p0)` of the cells, over all bodies that wear in the frame of the punch.
#[derive(Clone, Debug, PartialEq)]
pub struct CellRate {
    /// Reference pressure p0, in Pa.
    pub reference_pressure: f64,
    /// The terms; none: no wear.
    pub terms: Vec<WearTerm>,
}

/// Pressure of a cell with its linearisation in the local displacement `t = alpha p + tau f<(p)`, f< the
/// concave terms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LocalState {
    pub pressure: f64,
    /// Local displacement t, in m.
    pub displacement: f64,
    /// Slope dp/dt, from 0 to 1/alpha.
    pub pressure_slope: f64,
    /// Depth worn in the stage, `tau f(p)` of all terms, in m.
    pub wear: f64,
    /// Slope d(tau f)/dt of the wear.
    pub wear_slope: f64,
}

impl CellRate {
    /// Sum of these terms, of the wear laws of bodies.
    pub fn of_bodies(terms: Vec<WearTerm>) -> Self {
        Self { reference_pressure: REFERENCE_PRESSURE, terms }
    }

    /// Archard's law `f = k |v| p` with the same k for all cells: k in 1/Pa, speed in m/s.
    pub fn archard(wear: f64, speed: f64) -> Self {
        Self::uniform(1.0, wear * speed.abs(), 1.0)
    }

    /// One term `coefficient (p/p0)^exponent` for all cells: m/s, p0 in Pa.
    pub fn uniform(reference_pressure: f64, coefficient: f64, exponent: f64) -> Self {
        let term = WearTerm { coefficient: Coefficient::Uniform(coefficient), law: PressureLaw::power(exponent) };
        Self { reference_pressure, terms: vec![term] }
    }

    /// Whether all cells have the same coefficients.
    pub(crate) fn is_uniform(&self) -> bool {
        self.terms.iter().all(|term| matches!(term.coefficient, Coefficient::Uniform(_)))
    }

    /// Whether f is linear in p.
    pub fn is_linear(&self) -> bool {
        self.terms.iter().all(|term| term.law.is_linear())
    }

    /// Whether a term has an infinite slope where its wear begins.
    pub(super) fn is_concave(&self) -> bool {
        self.terms.iter().any(|term| term.law.is_concave())
    }

    /// Depth rate of a cell at the pressure p >= 0.
    pub fn rate(&self, cell: usize, pressure: f64) -> f64 {
        let relative = pressure / self.reference_pressure;
        self.terms.iter().map(|term| term.law.rate(term.coefficient.at(cell), relative)).sum()
    }

    /// df/dp of a cell at the pressure p >= 0; infinite where the wear of a concave term begins.
    pub fn slope(&self, cell: usize, pressure: f64) -> f64 {
        let relative = pressure / self.reference_pressure;
        let term = |term: &WearTerm| match term.coefficient.at(cell) {
            0.0 => 0.0,
            coefficient => term.law.slope(coefficient, relative),
        };
        self.terms.iter().map(term).sum::<f64>() / self.reference_pressure
    }

    /// Depth rate and df/dp of a cell at the pressure p >= 0, as [`Self::rate`] and [`Self::slope`] with one power.
    pub(crate) fn rate_and_slope(&self, cell: usize, pressure: f64) -> (f64, f64) {
        let relative = pressure / self.reference_pressure;
        let (mut rate, mut slope) = (0.0, 0.0);
        for WearTerm { coefficient, law } in &self.terms {
            let coefficient = coefficient.at(cell);
            if coefficient == 0.0 {
                continue;
            }
            let part = law.rate(coefficient, relative);
            rate += part;
            slope += if part > 0.0 {
                law.logarithmic_slope(relative) * part / pressure
            } else {
                law.slope(coefficient, relative) / self.reference_pressure
            };
        }
        (rate, slope)
    }

    /// Inverse of the rate: pressure at which the depth rate of a cell is f >= 0, to rounding; infinite for a cell without
    /// wear.
    pub fn pressure_at(&self, cell: usize, rate: f64) -> f64 {
        let active = self.terms.iter().map(|term| (term.coefficient.at(cell), term.law)).filter(|(c, _)| *c > 0.0);
        self.reference_pressure * PressureLaw::inverse(active, 0.0, rate)
    }

    /// Linearised state of a cell at the pressure p, for an elastic scale alpha > 0 (m/Pa) and a stage length tau (s).
    ///
    /// A concave term has an infinite slope in p where its wear begins, but not in the local displacement t: p(t) and
    /// f<(p(t)) are Lipschitz continuous with the constants 1/alpha and 1/tau, as Newton's method needs. The other terms are
    /// convex in p, and Newton's method in p, that is in t without the first terms, is suitable for them.
    pub(super) fn local(&self, cell: usize, alpha: f64, tau: f64, pressure: f64) -> LocalState {
        let relative = pressure / self.reference_pressure;
        let (mut displacement, mut concave, mut convex, mut wear) = (alpha * pressure, 0.0, 0.0, 0.0);
        for WearTerm { coefficient, law } in &self.terms {
            let coefficient = tau * coefficient.at(cell);
            if coefficient <= 0.0 {
                continue;
            }
            let part = law.rate(coefficient, relative);
            let slope = law.slope(coefficient, relative) / self.reference_pressure;
            wear += part;
            if law.is_concave() {
                displacement += part;
                concave += slope;
            } else {
                convex += slope;
            }
        }
        let pressure_slope = if concave.is_finite() { 1.0 / (alpha + concave) } else { 0.0 };
        let wear_slope = (1.0 - alpha * pressure_slope) + convex * pressure_slope;
        LocalState { pressure, displacement, pressure_slope, wear, wear_slope }
    }

    /// The pressure at which `alpha p + tau f<(p) = t`, to rounding; 0 for t <= 0.
    pub(super) fn invert(&self, cell: usize, alpha: f64, tau: f64, displacement: f64) -> f64 {
        let concave = self.terms.iter().filter(|term| term.law.is_concave());
        let active = concave.map(|term| (tau * term.coefficient.at(cell), term.law)).filter(|(c, _)| *c > 0.0);
        self.reference_pressure * PressureLaw::inverse(active, alpha * self.reference_pressure, displacement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(terms: &[(f64, f64)]) -> CellRate {
        let term = |&(coefficient, exponent): &(f64, f64)| WearTerm {
            coefficient: coefficient.into(),
            law: PressureLaw::power(exponent),
        };
        CellRate { reference_pressure: 2.0, terms: terms.iter().map(term).collect() }
    }

    #[test]
    fn inversion_returns_the_pressure() {
        for terms in [
            vec![],
            vec![(3.0, 1.0)],
            vec![(3.0, 0.3)],
            vec![(3.0, 3.0)],
            vec![(1e-9, 0.3), (1e4, 3.0)],
            vec![(0.0, 0.5), (2.0, 1.3)],
        ] {
            let rate = rate(&terms);
            for tau in [0.0, 1e-12, 1.0, 1e9] {
                for exponent in -30..12 {
                    let pressure = 10f64.powi(exponent);
                    let displacement = rate.local(0, 0.7, tau, pressure).displacement;
                    let error = rate.invert(0, 0.7, tau, displacement) / pressure - 1.0;
                    assert!(error.abs() < 1e-13, "{terms:?} tau {tau:e} p {pressure:e}: {error:e}");
                }
            }
            assert_eq!(rate.invert(0, 0.7, 1.0, 0.0), 0.0);
        }
        assert_eq!((rate(&[]).pressure_at(0, 1.0), rate(&[(1.0, 1.0)]).pressure_at(0, 0.0)), (f64::INFINITY, 0.0));
    }

    #[test]
    fn slopes_are_bounded_and_right() {
        for terms in [vec![(3.0, 0.3)], vec![(3.0, 1.0)], vec![(3.0, 2.0)], vec![(3.0, 0.5), (2.0, 1.5)]] {
            let rate = rate(&terms);
            for pressure in [1e-6f64, 0.1, 30.0] {
                let local = rate.local(0, 0.7, 0.2, pressure);
                let at = |t: f64| rate.local(0, 0.7, 0.2, rate.invert(0, 0.7, 0.2, t));
                let h = 1e-6 * local.displacement;
                let (low, high) = (at(local.displacement - h), at(local.displacement + h));
                let numeric = (high.pressure - low.pressure) / (2.0 * h);
                assert!((local.pressure_slope / numeric - 1.0).abs() < 1e-7, "{terms:?} {pressure}");
                let numeric = (high.wear - low.wear) / (2.0 * h);
                assert!((local.wear_slope / numeric - 1.0).abs() < 1e-7, "{terms:?} {pressure}");
                assert!((local.wear - 0.2 * rate.rate(0, pressure)).abs() <= 1e-15 * local.wear);
            }
            let open = rate.local(0, 0.7, 0.2, 0.0);
            assert!(open.wear_slope <= 1.0 + 1e-15 && open.pressure_slope <= 1.0 / 0.7);
        }
    }
    #[test]
    fn laws_with_thresholds() {
        // Coefficient, exponent, threshold over p0 = 2.
        for terms in [
            vec![(3.0, 1.0, 0.4)],
            vec![(3.0, 0.3, 0.4)],
            vec![(3.0, 2.5, 0.4)],
            vec![(3.0, 0.5, 0.4), (2.0, 0.3, 1.1)],
            vec![(1e-3, 0.5, 0.0), (10.0, 3.0, 0.7), (1.0, 0.8, 0.7)],
        ] {
            let law = |exponent, threshold| PressureLaw::power(exponent).above(threshold);
            let term = |&(c, b, z): &(f64, f64, f64)| WearTerm { coefficient: c.into(), law: law(b, z) };
            let rate = CellRate { reference_pressure: 2.0, terms: terms.iter().map(term).collect() };
            let exact = |p: f64| terms.iter().map(|(c, b, z)| c * (0.5 * p - z).max(0.0).powf(*b)).sum::<f64>();
            for pressure in [1e-3, 0.1, 0.79, 0.8, 0.80001, 1.0, 1.4, 1.6, 2.2, 2.3, 7.0, 1e3] {
                let case = format!("{terms:?} p {pressure}");
                assert!((rate.rate(0, pressure) - exact(pressure)).abs() <= 1e-14 * exact(pressure), "{case}");
                let (value, slope) = rate.rate_and_slope(0, pressure);
                assert_eq!(value, rate.rate(0, pressure), "{case}");
                assert!(slope == rate.slope(0, pressure) || (slope / rate.slope(0, pressure) - 1.0).abs() < 1e-13);
                let h = 1e-6 * pressure;
                let numeric = (exact(pressure + h) - exact(pressure - h)) / (2.0 * h);
                if terms.iter().all(|(_, _, z)| (pressure - 2.0 * z).abs() > 1e-2) {
                    assert!((slope - numeric).abs() <= 1e-6 * slope, "{case}: {slope} {numeric}");
                }
                let displacement = rate.local(0, 0.7, 0.2, pressure).displacement;
                assert!((rate.invert(0, 0.7, 0.2, displacement) / pressure - 1.0).abs() < 1e-13, "{case}");
                if value > 0.0 {
                    assert!((rate.pressure_at(0, value) / pressure - 1.0).abs() < 1e-13, "{case}");
                }
            }
        }
    }
}
