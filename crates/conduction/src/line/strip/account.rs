//! Heat balance of the strip over a step.
//!
//! Only the mean mode stores heat. Heat entering over the step follows from the fluxes, stored heat from the states,
//! heat lost to the air from the integrals of the states; the loss through the base closes the balance.
//!
//! Theory: docs/theory.md, section 2.7.

use super::scratch::Scratch;
use super::{AMBIENT, BASE, CONTACT, StripHeat, TAIL};
use crate::line::{Boundary, GAMMA, Observed, Surroundings};
use numerics::dense;

impl StripHeat {
    /// Advances the mean mode and the heat balance over the step; `effective` are the mean fluxes of both stages, Robin
    /// correction included.
    pub(super) fn keep_account(
        &self,
        scratch: &Scratch,
        state: &mut [f64],
        surroundings: &Surroundings,
        contact: [&[f64]; 2],
        effective: [f64; 2],
    ) {
        let operators = &*self.operators;
        let mean = &operators.mean;
        let weights = &self.step.end;
        let step = self.step.length;
        let over_step = |values: [f64; 2]| step * ((1.0 - GAMMA) * values[0] + GAMMA * values[1]);
        let heat = |flux: &[f64]| dense::dot(flux, &operators.widths);
        let received = over_step([heat(contact[0]), heat(contact[1])]);
        let total = over_step([heat(&scratch.first), heat(&scratch.end)]);
        // Heat into the cells besides that of the contact: the Robin correction, and minus the cooling that does not
        // act under the contact.
        let returned = total - received;
        let Boundary { cooling, ambient: air, far } = surroundings.mean();
        let before = self.account(state).stored;
        let mut ambient = 0.0;
        let carried = self.mean_states(state, surroundings, weights, effective);
        let alone = (!operators.remembers)
            .then(|| self.mean_states(operators.background(state), surroundings, weights, [0.0; 2]));
        for k in 0..mean.count {
            let (old, new) = (state[k], carried[k]);
            let source = mean.input[CONTACT][k] * (over_step(effective) + step * cooling)
                + step * (mean.input[AMBIENT][k] * air + mean.input[BASE][k] * far);
            if mean.rate[k] > 0.0 {
                ambient += mean.ambient_flow.states[k] * (old - new + source) / mean.rate[k];
            }
            state[k] = new;
            if let Some(alone) = &alone {
                state[mean.count + k] = alone[k];
            }
        }
        ambient += mean.ambient_flow.direct[CONTACT] * (over_step(effective) + step * cooling)
            + step * (mean.ambient_flow.direct[AMBIENT] * air + mean.ambient_flow.direct[BASE] * far);
        let lost = operators.length * (ambient - step * cooling) - returned;
        let tail = state.len() - TAIL;
        state[tail + 3] = surroundings.end.far;
        let stored = self.account(state).stored - before;
        state[tail] += received;
        state[tail + 1] += lost;
        state[tail + 2] += received - stored - lost;
    }
}
