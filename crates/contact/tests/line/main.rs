//! The contact line: pressure, wear and the cases in which methods fail.

mod contact;
mod wear;

use ::contact::ContactState;
use ::contact::wear::line::{Conditions, WearingContact};

/// A step of the implicit Euler method (s): a stage of this length, and the wear that it leaves.
fn implicit_step(contact: &mut WearingContact, worn: &mut [f64], step: f64, conditions: &Conditions) -> ContactState {
    let state = contact.stage(worn, step, conditions).unwrap();
    for (i, depth) in worn.iter_mut().enumerate() {
        *depth += step * conditions.rate.rate(i, state.pressure[i]);
    }
    state
}
