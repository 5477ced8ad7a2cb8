//! Monotone C1 interpolation of a measured friction coefficient over sliding speed.
//!
//! Cubic Hermite polynomials whose slopes at the points are limited as by F. N. Fritsch, R. E. Carlson, SIAM J. Numer.
//! Anal. 17 (1980) 238: no overshoot between the points, and a continuous derivative. Linear interpolation has a jump of
//! the derivative at each point, at which the slope of the force, on which a vehicle's own integrator and the
//! linearisations of the stages depend, jumps as well. Above the last speed the value is constant, and so the slope at
//! the last point is 0.
//!
//! Theory: docs/theory.md, section 2.2.

use numerics::scalar::Scalar;
use scene::{FRICTION_POINTS, FrictionTable};

/// Polynomial pieces of a table.
#[derive(Clone, PartialEq, Debug)]
pub struct FrictionCurve {
    points: usize,
    speed: [f64; FRICTION_POINTS],
    /// Coefficients of the powers 0 to 3 of the distance from the start of each piece.
    piece: [[f64; 4]; FRICTION_POINTS],
}

impl FrictionCurve {
    /// The curve through the points of `table` over the coefficient `reference`.
    pub(crate) fn new(table: &FrictionTable, reference: f64) -> FrictionCurve {
        let (points, speed) = (table.points, table.speed);
        let value = table.coefficient.map(|coefficient| coefficient / reference);
        let slope = slopes(&speed[..points], &value[..points]);
        let mut piece = [[0.0; 4]; FRICTION_POINTS];
        for k in 0..points - 1 {
            let length = speed[k + 1] - speed[k];
            let secant = (value[k + 1] - value[k]) / length;
            piece[k] = [
                value[k],
                slope[k],
                (3.0 * secant - 2.0 * slope[k] - slope[k + 1]) / length,
                (slope[k] + slope[k + 1] - 2.0 * secant) / (length * length),
            ];
        }
        piece[points - 1][0] = value[points - 1];
        FrictionCurve { points, speed, piece }
    }

    /// Value at the speed `speed` >= 0 (m/s).
    #[inline]
    pub(crate) fn at<S: Scalar>(&self, speed: S) -> S {
        let after = self.speed[..self.points].iter().position(|point| speed.value() < *point).unwrap_or(self.points);
        let k = after.saturating_sub(1);
        let [constant, linear, quadratic, cubic] = self.piece[k];
        if k + 1 == self.points {
            return S::from(constant);
        }
        let x = speed - S::from(self.speed[k]);
        ((x * cubic + S::from(quadratic)) * x + S::from(linear)) * x + S::from(constant)
    }
}

/// Limited slopes at the points; that at the last is 0.
fn slopes(speed: &[f64], value: &[f64]) -> [f64; FRICTION_POINTS] {
    let last = speed.len() - 1;
    let secant = |k: usize| (value[k + 1] - value[k]) / (speed[k + 1] - speed[k]);
    let mut slope = [0.0; FRICTION_POINTS];
    slope[0] = secant(0);
    for k in 1..last {
        let (before, after) = (secant(k - 1), secant(k));
        slope[k] = if before * after > 0.0 { 0.5 * (before + after) } else { 0.0 };
    }
    for k in 0..last {
        let secant = secant(k);
        if secant == 0.0 {
            (slope[k], slope[k + 1]) = (0.0, 0.0);
            continue;
        }
        let (alpha, beta) = (slope[k] / secant, slope[k + 1] / secant);
        let radius = alpha.hypot(beta);
        if radius > 3.0 {
            (slope[k], slope[k + 1]) = (3.0 * alpha / radius * secant, 3.0 * beta / radius * secant);
        }
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::scalar::Dual;

    fn curve(points: &[(f64, f64)]) -> FrictionCurve {
        let mut table = FrictionTable { points: points.len(), speed: [0.0; 16], coefficient: [0.0; 16] };
        for (k, &(speed, coefficient)) in points.iter().enumerate() {
            (table.speed[k], table.coefficient[k]) = (speed, coefficient);
        }
        FrictionCurve::new(&table, 1.0)
    }

    fn dual(curve: &FrictionCurve, speed: f64) -> Dual {
        curve.at(Dual { value: speed, derivative: 1.0 })
    }

    const POINTS: [(f64, f64); 7] =
        [(0.0, 0.5), (0.01, 0.42), (0.1, 0.35), (1.0, 0.35), (5.0, 0.4), (5.5, 0.2), (20.0, 0.19)];

    #[test]
    fn the_curve_meets_its_points_is_monotone_between_them_and_constant_above() {
        let curve = curve(&POINTS);
        for (speed, coefficient) in POINTS {
            assert!((curve.at(speed) - coefficient).abs() < 1e-15, "{speed}");
        }
        assert_eq!((curve.at(20.0), curve.at(1e4), dual(&curve, 1e4).derivative), (0.19, 0.19, 0.0));
        for ends in POINTS.windows(2) {
            let ([from, to], rises) = ([ends[0].0, ends[1].0], ends[1].1 - ends[0].1);
            let values: Vec<f64> = (0..=200).map(|i| curve.at(from + (to - from) * f64::from(i) / 200.0)).collect();
            for pair in values.windows(2) {
                assert!((pair[1] - pair[0]) * rises.signum() >= -1e-15, "{from} to {to}");
            }
        }
    }

    #[test]
    fn the_slope_is_that_of_the_value_and_continuous() {
        let curve = curve(&POINTS);
        for speed in [0.003, 0.04, 0.7, 3.0, 5.2, 12.0] {
            let step = 1e-6 * speed;
            let difference = (curve.at(speed + step) - curve.at(speed - step)) / (2.0 * step);
            assert!((dual(&curve, speed).derivative - difference).abs() < 1e-7 * difference.abs().max(1e-2), "{speed}");
        }
        for (speed, _) in &POINTS[1..] {
            let [below, above] = [speed.next_down(), *speed].map(|speed| dual(&curve, speed).derivative);
            assert!((below - above).abs() < 1e-10, "{speed}: {below} {above}");
        }
    }
}
