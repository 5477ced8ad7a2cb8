//! Parts of the error estimate that both forms of the step share.

use super::operators::BodyOperators;
use super::state::LumpedState;
use super::step::Stepper;

/// How much more than the tolerance of the flux `scale` (W/m2) the exchange between the bodies may be off at
/// constant conditions. Its residual there belongs to the layer that the last jump of the inputs has left, which hardly
/// outlasts the step: what counts is the temperature across `resistance` (K m2/W) beside the largest rise so far.
#[inline]
pub fn layer_allowance(resistance: f64, scale: f64, state: &LumpedState) -> f64 {
    (state.peak_rise / (resistance * scale)).max(1.0)
}

impl Stepper<'_> {
    /// Whether the piece begins with the bodies coming together. Its heat rises from nothing: no layer of a jump, so that the
    /// exchange counts in full ([`layer_allowance`] is not for it).
    pub fn touches_down(&self) -> bool {
        self.ends.is_some_and(|ends| ends[0].load <= 1e-6 * ends[1].load && ends[1].load > 0.0)
    }

    /// Third difference of the wear rate over the start and the three points, which the quadrature leaves, in units of the
    /// tolerance: `rates` at the stages, `others` at the start and at the point 2/3, m/s; what comes on top, `uneven`; the
    /// friction coefficient and the temperature (K) at the end of the step; the highest rate so far.
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
        // Near standstill a rate like |v|^a, a < 1, is no polynomial at any step; what it adds there is little
        // beside the wear of the whole piece.
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
