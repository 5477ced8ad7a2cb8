//! Parts of the error estimate of a step.
//!
//! Theory: docs/theory.md, section 7.2.

use super::operators::BodyOperators;
use super::state::LumpedState;
use super::stepper::Stepper;
use numerics::maximum::maximum;

/// Factor by which the residual of the heat exchange between the bodies may exceed the tolerance of the flux `scale` (W/m2) at
/// constant conditions. There it belongs to the thermal layer of the last jump of the inputs, which hardly outlasts the step: the
/// relevant measure is the temperature across `resistance` (K m2/W) relative to the largest rise so far.
#[inline]
pub(crate) fn layer_allowance(resistance: f64, scale: f64, state: &LumpedState) -> f64 {
    (state.peak_rise / (resistance * scale)).max(1.0)
}

/// Least temperature rise to which errors are relative, K: a slider that hardly warms is not computed finer.
pub(crate) const LEAST_LUMPED_RISE: f64 = 1e-3;

/// Error of the temperatures at the end of a step, K, by a flux into a cooled face that is not linear between the stages, from the
/// `residual` of its law at the point 2/3, W/m2. `fall` is the decrease of the law with the temperature; `gains`, the temperatures of
/// the face, of the contact and of the body's mean per flux that is constant over the step, K m2/W. What reaches the face changes the
/// flux in return.
#[inline]
pub(crate) fn cooling_error(residual: f64, fall: f64, gains: [f64; 3]) -> f64 {
    let own = gains[0];
    let damped = |x: f64| {
        let through = 1.0 + fall * (own - x).max(0.0);
        // Part of the stiffness of a law of cooling by which the residual at the point 2/3 overstates the error at the end of the step: the
        // largest for which the error of a single decaying temperature is never understated (test).
        x * through / (through + 0.1 * fall * x)
    };
    let most = maximum(damped(own), maximum(damped(gains[1]), damped(gains[2])));
    residual.abs() / (1.0 + fall * own) * most
}

/// [`cooling_error`] where the conditions change, from the residuals of the law at the start of the step and at the point 2/3. At that point
/// the parts of the conditions and of the temperature may cancel, whereas the mean of the flux errs by its third difference.
#[inline]
pub(crate) fn varying_cooling_error(start: f64, residual: f64, fall: f64, gains: [f64; 3]) -> f64 {
    let third = 0.125 * (start + 3.0 * residual).abs();
    let left = |x: f64| {
        let through = 1.0 + fall * (gains[0] - x).max(0.0);
        // The law makes up for what errs early in the step: integral of exp(-s (1 - x)) (x - 1/3) (x - 2/3) (x - 1), relative to s = 0.
        let s = fall * x / through;
        third * x / (through * (1.0 + s + 0.125 * s * s))
    };
    maximum(cooling_error(residual, fall, gains), gains.into_iter().map(left).fold(0.0, maximum))
}

impl Stepper<'_> {
    /// Whether the piece begins at touch-down. Its heat rises from zero, without the layer of a jump, so that [`layer_allowance`]
    /// does not apply.
    pub(crate) fn touches_down(&self) -> bool {
        self.ends.is_some_and(|ends| ends[0].load <= 1e-6 * ends[1].load && ends[1].load > 0.0)
    }

    /// Wear rate of a body, m/s, at a pressure (Pa), a speed (m/s), a kinetic friction coefficient and a temperature (K).
    #[inline(always)]
    pub(crate) fn wear_rate(
        &self,
        body: &BodyOperators,
        pressure: f64,
        speed: f64,
        friction: f64,
        temperature: f64,
    ) -> f64 {
        body.wear.rate(pressure, speed, friction, temperature) * (body.wear_factor * self.tunables.wear_acceleration)
    }

    /// Third difference of the wear rate over the start and the three points, which is the quadrature error, in units of the
    /// tolerance: `rates` at the stages, `others` at the start and at the point 2/3, m/s; `uneven`, an additional error; friction
    /// coefficient and temperature (K) at the end of the step, and the slip speed (m/s) of a bristle, which also slips where the bodies
    /// rest; the highest rate so far.
    pub(crate) fn wear_error(
        &self,
        body: &BodyOperators,
        rates: &[f64; 2],
        others: [f64; 2],
        uneven: f64,
        [friction, temperature, slip]: [f64; 3],
        peak: f64,
    ) -> f64 {
        let [first, second] = others;
        let third = (first - 3.0 * rates[0] + 3.0 * second - rates[1]).abs() + uneven;
        // Near standstill a rate like |v|^a, a < 1, is not polynomial at any step size; its error is small relative to the wear
        // of the whole piece.
        let whole = self.ends.map_or(0.0, |ends| {
            let load = ends[0].load.max(ends[1].load);
            let slip = ends[0].slip.max(ends[1].slip).max(slip);
            0.1 * self.cut * self.wear_rate(body, load / self.operators.area, slip, friction, temperature)
        });
        let scale = rates[0].max(rates[1]).max(0.02 * peak).max(body.least_wear).max(whole);
        if third == 0.0 { 0.0 } else { third / (self.operators.budget.steps.lumped_wear * scale) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lumped::stage::{BASIS, POINTS, weights};

    /// A body of one temperature, T' = -z T over a step of 1 by stages with the flux z T, against exp(-z).
    #[test]
    fn the_error_of_a_decaying_temperature_is_never_understated() {
        let mut waste: f64 = 0.0;
        for k in 0..=80 {
            let z = 10f64.powf(-3.0 + 0.1 * f64::from(k));
            let [first, middle, end] = POINTS.map(|c| weights(0.0, 1.0, c, c));
            let [[a, b], [c, d]] = [[1.0 + z * first[0], z * first[1]], [z * end[0], 1.0 + z * end[1]]];
            let stages = [(d - b) / (a * d - b * c), (a - c) / (a * d - b * c)];
            let at_middle = 1.0 - z * (middle[0] * stages[0] + middle[1] * stages[1]);
            let residual = z * (at_middle - BASIS[1][0] * stages[0] - BASIS[1][1] * stages[1]);
            let (estimate, error) = (cooling_error(residual, z, [1.0; 3]), (stages[1] - (-z).exp()).abs());
            assert!(estimate >= 0.99 * error, "{z}: {estimate:e} for {error:e}");
            if z > 1.0 {
                waste = waste.max(estimate / error);
            }
        }
        assert!(waste < 5.0, "{waste}");
    }

    /// T' = -z T over a step of 1 with z linear in time, against the closed form.
    #[test]
    fn a_step_under_changing_cooling_is_accepted_within_the_tolerance_only() {
        let range = || (0..=76).map(|k| 10f64.powf(-2.0 + 0.05 * f64::from(k)));
        let mut accepted = 0;
        for (start, end) in range().flat_map(|start| range().map(move |end| (start, end))) {
            let z = |x: f64| start + (end - start) * x;
            let [first, middle, last] = POINTS.map(|c| weights(0.0, 1.0, c, c));
            let by = z(POINTS[0]);
            let [[a, b], [c, d]] = [[1.0 + by * first[0], end * first[1]], [by * last[0], 1.0 + end * last[1]]];
            let stages = [(d - b) / (a * d - b * c), (a - c) / (a * d - b * c)];
            let flux = [by * stages[0], end * stages[1]];
            let fall = z(POINTS[1]);
            let residual = fall * (1.0 - middle[0] * flux[0] - middle[1] * flux[1]) - 0.5 * (flux[0] + flux[1]);
            let at_start = start - (1.5 * flux[0] - 0.5 * flux[1]);
            let estimate = varying_cooling_error(at_start, residual, fall, [1.0; 3]);
            let error = (stages[1] - (-0.5 * (start + end)).exp()).abs();
            for tolerance in [3e-3, 1e-3, 1e-4] {
                accepted += u32::from(estimate <= tolerance);
                assert!(estimate > tolerance || error <= tolerance, "{start} to {end}: {estimate:e} for {error:e}");
            }
        }
        assert!(accepted > 100, "{accepted}");
    }
}
