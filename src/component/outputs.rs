//! Outputs, evaluated in groups when one of them is read.
//!
//! Theory: docs/theory.md, section 1.3.

use super::{Component, FIRST_OUTPUT, FIRST_PARAMETER, Phase, inputs_of};
use scene::message::Number;
use scene::value;
use scene::variables::{COUNT, ValueReference, lookup, reference};

const MAIN: [usize; 3] =
    [reference("wear_depth") as usize, reference("contact_temperature") as usize, reference("friction_force") as usize];
const CONTACT_TEMPERATURE: usize = MAIN[1];
const PROFILE_OF_TEMPERATURE: core::ops::Range<usize> =
    reference("profile.temperature") as usize..reference("profile.wear_punch") as usize;

/// Groups of outputs that are evaluated together, as bits.
pub(super) mod group {
    /// Outputs with direct feedthrough, and the worn depths.
    pub(crate) const CONTACT: u8 = 1;
    /// Outputs that depend on the states only.
    pub(crate) const ACCOUNT: u8 = 2;
    /// Profiles and the slope of the friction force.
    pub(crate) const REST: u8 = 4;
    /// The three main outputs, available at the end of a step without another evaluation.
    pub(crate) const MAIN: u8 = 8;
}

/// Group of every value reference; 0 for inputs and parameters.
pub(super) static GROUPS: [u8; COUNT] = {
    let mut groups = [group::ACCOUNT; COUNT];
    let contact = [
        "friction_torque",
        "effective_radius",
        "friction_power",
        "friction_coefficient",
        "friction_force_kinetic",
        "friction_force_limit",
        "critical_speed",
        "pressure_mean",
        "pressure_max",
        "contact_fraction",
        "tilt",
        "approach",
        "contact_temperature_max",
        "heat_flow_punch",
        "heat_flow_strip",
        "heat_flow_punch_top",
        "heat_flow_strip_base",
        "heat_flow_ambient",
        "heat_flow_punch_external",
        "heat_flow_strip_external",
        "wear_depth_punch",
        "wear_depth_strip",
        "wear_dissipation_power",
        "sticking",
        "limit_reached",
        "wear_limit_reached",
        "temperature_limit_exceeded",
        "validity_exceeded",
    ];
    let mut index = 0;
    while index < contact.len() {
        groups[reference(contact[index]) as usize] = group::CONTACT;
        index += 1;
    }
    let main = ["wear_depth", "contact_temperature", "friction_force"];
    index = 0;
    while index < main.len() {
        groups[reference(main[index]) as usize] = group::MAIN;
        index += 1;
    }
    groups[reference("friction_slope") as usize] = group::REST;
    index = reference("profile.x") as usize;
    while index < FIRST_PARAMETER {
        groups[index] = group::REST;
        index += 1;
    }
    index = 0;
    while index < COUNT {
        if index < FIRST_OUTPUT || index >= FIRST_PARAMETER {
            groups[index] = 0;
        }
        index += 1;
    }
    groups
};

impl Component {
    /// Value of the variable `reference` (below [`COUNT`]). Outputs are those of the current inputs; before initialisation they
    /// are 0, and their last values where the parameters set so far are no valid scene.
    #[inline]
    pub fn get(&mut self, reference: ValueReference) -> f64 {
        if !self.is_current(reference) {
            self.compute(GROUPS[reference as usize]);
        }
        self.values[reference as usize]
    }

    /// Whether [`Component::get`] computes nothing.
    #[inline]
    pub(crate) fn is_current(&self, reference: ValueReference) -> bool {
        GROUPS[reference as usize] & !self.current == 0
    }

    fn compute(&mut self, wanted: u8) {
        if self.run.phase == Phase::Initializing && self.stale {
            self.stale = false;
            // Rules between several parameters are checked at the end of initialisation.
            if let Ok(scene) = self.scene_of(&self.values, self.run.tolerance) {
                let _ = self.build(&scene);
            }
        }
        if let Some(model) = &mut self.model {
            let inputs = inputs_of(&self.values);
            match wanted {
                group::MAIN if self.run.at_end => model.write_end(&mut self.values),
                group::MAIN | group::CONTACT => {
                    // Values already read must not change: only groups that are not up to date are written.
                    let main = MAIN.map(|index| self.values[index]);
                    model.write_contact(&inputs, &mut self.values);
                    if self.run.at_end {
                        model.write_end(&mut self.values);
                    } else if self.current & group::MAIN != 0 {
                        for (index, value) in MAIN.into_iter().zip(main) {
                            self.values[index] = value;
                        }
                    }
                    // The step and the evaluation at frozen states agree to the tolerance of the step's own iteration.
                    let mean = value!(self.values, "contact_temperature");
                    let highest = &mut value!(self.values, "contact_temperature_max");
                    if mean > *highest {
                        *highest = mean;
                    }
                    self.current |= group::MAIN | group::CONTACT;
                }
                group::ACCOUNT => {
                    model.write_account(&mut self.values);
                    if let (Some(run_error), Some(prepared)) = (&self.run_error, &self.prepared) {
                        let steps = value!(self.values, "estimated_step_error");
                        value!(self.values, "estimated_error") = run_error.of(prepared, steps);
                    }
                }
                _ => model.write_rest(&inputs, &mut self.values),
            }
        }
        self.current |= wanted;
    }

    /// Checks at the end of initialisation that every output is finite and the contact above 0 K.
    pub(super) fn check_outputs(&mut self) -> Result<(), String> {
        self.stale = false;
        for index in FIRST_OUTPUT..FIRST_PARAMETER {
            let value = self.get(index as ValueReference);
            let name = || lookup(index as ValueReference).map_or_else(String::new, |(row, at)| row.element_name(at));
            if !value.is_finite() {
                return Err(format!(
                    "{} = {value} after initialisation: the model of these parameters has no finite solution",
                    name()
                ));
            }
            if value < 0.0 && (index == CONTACT_TEMPERATURE || PROFILE_OF_TEMPERATURE.contains(&index)) {
                return Err(format!(
                    "{} = {value} K is below 0 K after initialisation: sliding_velocity = {} m/s, normal_load = {} N and \
                     cooling_velocity = {} m/s are outside the model's validity",
                    name(),
                    Number(value!(self.values, "sliding_velocity")),
                    Number(value!(self.values, "normal_load")),
                    Number(value!(self.values, "cooling_velocity")),
                    value = Number(value)
                ));
            }
        }
        Ok(())
    }
}
