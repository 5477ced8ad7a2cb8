//! Time derivatives of the outputs at a communication point.
//!
//! Theory: docs/theory.md, section 1.3.

use super::outputs::{GROUPS, group};
use super::{Component, check_unknowns, inputs_of};
use model::levels::Model;
use scene::variables::{COUNT, ValueReference};

impl Component {
    /// Time derivatives of `unknowns` (outputs), per second, at the last communication point with constant inputs. The states are
    /// advanced by a thousandth of the last step and by half of that, and restored; the result is the initial derivative of the
    /// parabola through the three values, second order in that length.
    ///
    /// # Errors
    /// If an unknown is not an output, there is no model yet, or the look-ahead step fails.
    pub fn output_derivatives(&mut self, unknowns: &[ValueReference], result: &mut [f64]) -> Result<(), String> {
        check_unknowns(unknowns)?;
        if unknowns.is_empty() {
            return Ok(());
        }
        self.check_inputs(0.0)?;
        let inputs = inputs_of(&self.values);
        let Some(model) = &mut self.model else {
            return Err("no output derivatives before the parameters join to a scene".into());
        };
        let ahead = match self.run.last_step {
            // Length of the look-ahead step relative to the nominal duration, before the first step.
            0.0 => 1e-7 * model.scene().nominal_duration,
            // Length of the look-ahead step relative to the last step; the error is of second order in it.
            last => 1e-3 * last,
        };
        let groups = unknowns.iter().fold(0, |groups, &unknown| groups | GROUPS[unknown as usize]);
        let mut values = vec![0.0; 3 * COUNT];
        let (now, later) = values.split_at_mut(COUNT);
        let (half, whole) = later.split_at_mut(COUNT);
        let saved = model.save();
        let mut outcome = Ok(());
        for (length, values) in [(0.0, now), (0.5 * ahead, half), (ahead, whole)] {
            if length > 0.0 {
                outcome = outcome.and_then(|()| model.step(&inputs, None, length));
            }
            write(model, groups, &inputs, values.try_into().expect("COUNT values"));
            model.set_state(&saved);
        }
        outcome.map_err(|failure| failure.to_string())?;
        for (slot, &unknown) in result.iter_mut().zip(unknowns) {
            let [now, half, whole] = [0, 1, 2].map(|time| values[time * COUNT + unknown as usize]);
            *slot = (4.0 * (half - now) - (whole - now)) / ahead;
        }
        Ok(())
    }
}

/// Writes the outputs of the groups at frozen states: at all three times by the same formulas.
fn write(model: &mut Model, groups: u8, inputs: &model::Inputs, values: &mut [f64; COUNT]) {
    if groups & (group::MAIN | group::CONTACT) != 0 {
        model.write_contact(inputs, values);
    }
    if groups & group::ACCOUNT != 0 {
        model.write_account(values);
    }
    if groups & group::REST != 0 {
        model.write_rest(inputs, values);
    }
}
