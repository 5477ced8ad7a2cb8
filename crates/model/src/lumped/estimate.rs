//! Parts of the error estimate shared by the fast path and the general form of the step.
//!
//! Theory: docs/theory.md, section 7.2.

use super::operators::BodyOperators;
use super::state::LumpedState;
use super::stepper::Stepper;

/// Factor by which the residual of the heat exchange between the bodies may exceed the tolerance of the flux `scale` (W/m2) at
/// constant conditions. There it belongs to the thermal layer of the last jump of the inputs, which hardly outlasts the step: the
/// relevant measure is the temperature across `resistance` (K m2/W) relative to the largest rise so far.
#[inline]
pub fn layer_allowance(resistance: f64, scale: f64, state: &LumpedState) -> f64 {
    (state.peak_rise / (resistance * scale)).max(1.0)
}

impl Stepper<'_> {
    /// Whether the piece begins at touch-down. Its heat rises from zero, without the layer of a jump, so that [`layer_allowance`]
    /// does not apply.
    pub fn touches_down(&self) -> bool {
        self.ends.is_some_and(|ends| ends[0].load <= 1e-6 * ends[1].load && ends[1].load > 0.0)
    }

    /// Third difference of the wear rate over the start and the three points, which is the quadrature error, in units of the
    /// tolerance: `rates` at the stages, `others` at the start and at the point 2/3, m/s; `uneven`, an additional error; friction
    /// coefficient and temperature (K) at the end of the step; the highest rate so far.
    pub fn wear_error(
        &self,
        body: &BodyOperators,
        rates: &[f64; 2],
        others: [f64; 2],
        uneven: f64,
        end: (f64, f64),
        peak: f64,
    ) -> f64 {
        let [first, second] = others;
        let third = (first - 3.0 * rates[0] + 3.0 * second - rates[1]).abs() + uneven;
        // Near standstill a rate like |v|^a, a < 1, is not polynomial at any step size; its error is small relative to the wear
        // of the whole piece.
        let whole = self.ends.map_or(0.0, |ends| {
            let load = ends[0].load.max(ends[1].load);
            let slip = ends[0].slip.max(ends[1].slip);
            0.1 * self.cut
                * body.wear.rate(load / self.operators.area, slip, end.0, end.1)
                * (body.wear_factor * self.tunables.wear_acceleration)
        });
        let scale = rates[0].max(rates[1]).max(0.02 * peak).max(body.least_wear).max(whole);
        if third == 0.0 { 0.0 } else { third / (5.0 * self.operators.scene.tolerance * scale) }
    }
}
