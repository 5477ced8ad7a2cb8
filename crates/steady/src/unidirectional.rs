//! Steady unidirectional sliding.
//!
//! Theory: docs/theory.md, section 9.1.

use super::{SteadyError, positive};
use contact::wear::line::{CellRate, Conditions, Direction, WearingContact};
use contact::{ContactState, Normal, Tilt};
use elasticity::Cells;
use nalgebra::{DMatrix, DVector};

/// Steady state of a punch that wears in unidirectional sliding.
#[derive(Clone, Debug, PartialEq)]
pub struct Unidirectional {
    /// N cell means of the pressure, in Pa.
    pub pressure: Vec<f64>,
    /// Rate at which the punch sinks at x = 0, in m/s (per unit of time of the rate).
    pub sinking_rate: f64,
    /// `sum w p f(p)`, per depth: the wear dissipation power, which the pressure minimises for one exponent.
    pub dissipation: f64,
}

impl Unidirectional {
    /// Worn depth (N values, m, minimum 0) at which this pressure is in elastic equilibrium: `g0 + w + A p` is a rigid motion
    /// where the pressure is positive; elsewhere the depth at which the gap is 0.
    pub fn shape(&self, initial_gap: &[f64], compliance: &DMatrix<f64>) -> Vec<f64> {
        let displacement = compliance * DVector::from_column_slice(&self.pressure);
        let mut shape: Vec<f64> = initial_gap.iter().zip(&displacement).map(|(g, u)| -g - u).collect();
        let least = shape.iter().copied().fold(f64::INFINITY, f64::min);
        shape.iter_mut().for_each(|w| *w -= least);
        shape
    }
}

/// Steady pressure of a wearing punch: the depth rate equals a rigid motion, `f(p) = lambda0 + lambda1 x` where
/// positive, with force and (free to rotate) moment balance; `p^b` proportional to it for one exponent.
///
/// `weights` are those of the load integral (cell widths; times r/r_m on an annulus), `load` per depth in N/m. The
/// fixed tilt's value does not matter. Two nested root searches of monotone functions, to rounding.
pub fn punch_run_in(
    cells: &Cells,
    weights: &[f64],
    rate: &CellRate,
    load: f64,
    tilt: Tilt,
) -> Result<Unidirectional, SteadyError> {
    positive("load", load)?;
    let (count, x) = (cells.count(), cells.centres());
    assert_eq!(weights.len(), count, "one weight per cell");
    let mean = load / weights.iter().sum::<f64>();
    if (0..count).any(|i| rate.rate(i, mean) == 0.0) {
        return Err(SteadyError::NothingWears);
    }
    let scale = (0..count).map(|i| rate.rate(i, mean)).fold(0.0, f64::max);
    let (lever, extra) = match tilt {
        Tilt::Fixed(_) => (0.0, None),
        Tilt::ResultantAt(lever) => (lever, Some(0.0)),
        Tilt::Moment { lever, moment } => (lever, Some(moment)),
    };
    let centre = lever + extra.unwrap_or(0.0) / load;
    if extra.is_some() && (centre.is_nan() || centre.abs() >= x[count - 1]) {
        let limit = x[count - 1];
        let text = format!("no steady state: the punch tips over, mu H = {centre} m is not below {limit} m");
        return Err(SteadyError::Other(text));
    }
    // Tilting about the resultant makes the two searches nearly independent.
    let pressures = |sinking: f64, tilting: f64| -> Vec<f64> {
        (0..count).map(|i| rate.pressure_at(i, sinking + tilting * (x[i] - centre))).collect()
    };
    let sum = |p: &[f64], f: &dyn Fn(usize) -> f64| -> f64 { (0..count).map(|i| weights[i] * p[i] * f(i)).sum() };
    let sinking_for = |tilting: f64| {
        let excess = |sinking: f64| sum(&pressures(sinking, tilting), &|_| 1.0) / load - 1.0;
        increasing_root(excess, scale, scale + tilting.abs() * cells.half_width())
    };
    let tilting = if extra.is_some() {
        let excess = |tilting: f64| {
            let p = pressures(sinking_for(tilting), tilting);
            sum(&p, &|i| (x[i] - centre) / cells.half_width()) / load
        };
        increasing_root(excess, 0.0, scale / cells.half_width())
    } else {
        0.0
    };
    let sinking = sinking_for(tilting);
    let pressure = pressures(sinking, tilting);
    let dissipation = sum(&pressure, &|i| rate.rate(i, pressure[i]));
    Ok(Unidirectional { pressure, sinking_rate: sinking - tilting * centre, dissipation })
}

/// Steady groove of a wearing strip on a fresh straight path: the strip enters unworn at the leading edge and leaves worn at the
/// trailing edge, `g0 + A p + integral_x^lead f(p) dx' = delta + theta x` where p > 0.
///
/// `rate` is the worn depth per sliding distance, `compliance` `C + s mu S` for the direction. The gap of the state is
/// that of the worn strip.
pub fn groove(
    cells: &Cells,
    compliance: DMatrix<f64>,
    initial_gap: &[f64],
    rate: CellRate,
    direction: Direction,
    normal: Normal,
    tilt: Tilt,
) -> Result<ContactState, SteadyError> {
    if rate.terms.iter().all(|term| term.coefficient.is_zero()) {
        return Err(SteadyError::NothingWears);
    }
    // The given compliance includes the shear coupling of the direction.
    let none = DMatrix::zeros(cells.count(), cells.count());
    let mut contact = WearingContact::new(cells, cells.widths(), compliance, none, initial_gap.to_vec())?;
    contact.set_operator(Some(&groove_operator(cells, direction)));
    let conditions = Conditions { signed_friction: 0.0, normal, tilt, rate };
    Ok(contact.stage(&vec![0.0; cells.count()], 1.0, &conditions)?)
}

/// Cell means of the groove per worn depth per sliding distance: N x N, `integral_x^lead f dx'`, in m.
pub(crate) fn groove_operator(cells: &Cells, direction: Direction) -> DMatrix<f64> {
    let widths = cells.widths();
    let ahead = |i: usize, j: usize| if direction == Direction::Forward { j > i } else { j < i };
    DMatrix::from_fn(cells.count(), cells.count(), |i, j| match i == j {
        true => 0.5 * widths[i],
        false if ahead(i, j) => widths[j],
        false => 0.0,
    })
}

/// Root of an increasing function, from a guess and a length of the first step: bracketed by doubling steps, then by
/// the Illinois variant of the regula falsi, with bisection where that stalls.
fn increasing_root(f: impl Fn(f64) -> f64, guess: f64, step: f64) -> f64 {
    let (mut low, mut high) = (guess, guess);
    let (mut f_low, mut f_high) = (f(guess), 0.0);
    if f_low == 0.0 {
        return guess;
    }
    let mut step = step;
    if f_low > 0.0 {
        f_high = f_low;
        while f_low > 0.0 {
            (high, f_high) = (low, f_low);
            low -= step;
            f_low = f(low);
            step *= 2.0;
        }
    } else {
        while f_high <= 0.0 {
            (low, f_low) = if high == guess { (low, f_low) } else { (high, f_high) };
            high += step;
            f_high = f(high);
            step *= 2.0;
        }
    }
    let width = high - low;
    // End of the bracket that stayed last time: the function value of an end that stays twice is halved.
    let (mut low_stays, mut high_stays) = (false, false);
    for iteration in 0..200 {
        let middle = 0.5 * (low + high);
        if high - low <= 4.0 * f64::EPSILON * (low.abs().max(high.abs())).max(1e-300) {
            return middle;
        }
        let secant = (low * f_high - high * f_low) / (f_high - f_low);
        let stalled = iteration > 8 && high - low > width * 0.5f64.powi(iteration / 2);
        let next = if stalled || !(secant > low && secant < high) { middle } else { secant };
        let value = f(next);
        if value == 0.0 {
            return next;
        }
        if value < 0.0 {
            (low, f_low) = (next, value);
            f_high *= if high_stays { 0.5 } else { 1.0 };
            (low_stays, high_stays) = (false, true);
        } else {
            (high, f_high) = (next, value);
            f_low *= if low_stays { 0.5 } else { 1.0 };
            (low_stays, high_stays) = (true, false);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::increasing_root;

    #[test]
    fn roots_of_steep_flat_and_kinked_functions() {
        for guess in [-3.0, 0.9, 1.0, 50.0] {
            let root = |f: &dyn Fn(f64) -> f64, exact: f64| {
                let error = increasing_root(f, guess, 0.1) - exact;
                assert!(error.abs() < 1e-14, "guess {guess}: {error:e}");
            };
            root(&|x| x - 1.0, 1.0);
            root(&|x| (x - 0.5).max(0.0).powf(0.2) - 0.5, 0.5 + 0.5f64.powi(5));
            root(&|x| x.max(0.0).powi(4) - 1.0, 1.0);
            root(&|x| if x < 1.0 { 1e3 * (x - 1.0) } else { 1e-3 * (x - 1.0) }, 1.0);
        }
    }
}
