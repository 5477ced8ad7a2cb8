//! Range checks of the inputs of a step. Inputs are stored unchecked; a step with an invalid one is rejected.

use super::{Component, Phase};
use model::INPUTS;
use scene::message::{self, Number};
use scene::variables::{ValueReference, lookup, reference, unit_of};
use scene::{ThermalBoundary, value};

/// Largest magnitude of an input, in its SI unit. Quantities derived from inputs within it (their products, the powers of the
/// wear law, the fourth power of a temperature) stay far within the range of floating-point numbers.
pub const LARGEST_INPUT: f64 = 1e12;

/// Shortest step above 0, s: far below the rounding errors of differences of simulation times, and far above where the reciprocal
/// of a step overflows.
pub(crate) const SHORTEST_STEP: f64 = 1e-24;

/// Longest step, s: 32 years. The energy balance closes to rounding only as long as the heat that flows within a step is not far
/// above the heat that is stored.
pub(crate) const LONGEST_STEP: f64 = 1e9;

/// First of the inputs that are checked at every change: the temperatures and the cooling velocity.
const FIRST_TEMPERATURE: usize = reference("ambient_temperature_offset") as usize;

/// Whether a new `value` of the input `index` has to be checked before the next step.
#[inline(always)]
pub(super) fn needs_check(index: usize, value: f64) -> bool {
    // By the bits, in the order of which NaN is the largest: setting an input computes nothing in the host's floating-point environment.
    (value.abs().to_bits() > LARGEST_INPUT.to_bits()) | (index >= FIRST_TEMPERATURE)
}

/// Whether an input is a number within its range.
#[inline(always)]
fn within(value: f64) -> bool {
    value.abs() <= LARGEST_INPUT
}

/// Name and unit of an input.
fn name_of(index: usize) -> (&'static str, &'static str) {
    lookup(index as ValueReference).map_or(("an input", ""), |(row, _)| (row.name, unit_of(row)))
}

impl Component {
    /// Checks parameters that are to be changed together while the model runs: what a step would refuse is refused before.
    ///
    /// # Errors
    /// A text with variable, value and limit.
    pub fn check_tuning(&self, changes: impl Iterator<Item = (ValueReference, f64)>) -> Result<(), String> {
        let Some(model) = self.model.as_ref().filter(|_| self.run.phase == Phase::Running) else { return Ok(()) };
        let mut values = *self.values;
        changes.for_each(|(reference, value)| values[reference as usize] = value);
        model.operators().check_tunables(&super::tunables_of(&values))
    }

    /// Checks the inputs at the beginning and at the end of a step of `step` s.
    ///
    /// # Errors
    /// A text that names the variable, its value and the limit.
    pub(crate) fn check_inputs(&self, step: f64) -> Result<(), String> {
        let inputs = self.values.iter().zip(&self.run.slopes);
        if inputs.fold(true, |all, (value, slope)| all & within(*value) & within(value + slope * step)) {
            return self.check_temperatures(step);
        }
        Err(self.refused_input(step))
    }

    /// Reason for which an input is refused that is out of range at the beginning or at the end of a step of `step` s.
    #[cold]
    fn refused_input(&self, step: f64) -> String {
        for index in 0..INPUTS {
            let ((name, unit), value, slope) = (name_of(index), self.values[index], self.run.slopes[index]);
            for (what, number) in [("", value), ("the derivative of ", slope)] {
                if !number.is_finite() {
                    return format!("{what}{name} = {number} is not a finite number");
                }
            }
            for (when, number) in [("", value), (" at the end of the step", value + slope * step)] {
                if !within(number) {
                    let [number, limit] = message::apart([number, number.signum() * LARGEST_INPUT], unit);
                    return format!("{name} = {number}{when} is beyond {limit}");
                }
            }
        }
        unreachable!("one of the inputs is out of range")
    }

    /// Checks that ambient and external temperatures are above 0 K.
    fn check_temperatures(&self, step: f64) -> Result<(), String> {
        let at_both = |index: usize| [self.values[index], self.values[index] + self.run.slopes[index] * step];
        let ambient = value!(self.values, "ambient_temperature");
        for offset in at_both(FIRST_TEMPERATURE) {
            if ambient + offset <= 0.0 {
                return Err(format!(
                    "ambient_temperature_offset = {offset} K makes an ambient temperature of {} K; ambient_temperature = \
                     {ambient} K, and the sum must be above 0 K",
                    Number(ambient + offset),
                    offset = Number(offset),
                    ambient = Number(ambient)
                ));
            }
        }
        const STRIP: usize = reference("strip.external_temperature") as usize;
        const PUNCH: usize = reference("punch.external_temperature") as usize;
        let sides = [
            ("strip", "strip.base_thermal", value!(self.values, "strip.base_thermal"), STRIP),
            ("punch", "punch.top_thermal", value!(self.values, "punch.top_thermal"), PUNCH),
        ];
        let conductances =
            [value!(self.values, "strip.external_conductance"), value!(self.values, "punch.external_conductance")];
        for ((body, face, boundary, index), conductance) in sides.into_iter().zip(conductances) {
            let external = ThermalBoundary::from_item(boundary) == ThermalBoundary::External;
            if !external && conductance == 0.0 {
                continue;
            }
            for temperature in at_both(index) {
                if temperature <= 0.0 {
                    let because = match external {
                        true => format!("{face} = external"),
                        false => format!("{body}.external_conductance = {} W/K", Number(conductance)),
                    };
                    return Err(format!(
                        "{body}.external_temperature = {} K must be above 0 K, because {because}",
                        Number(temperature)
                    ));
                }
            }
        }
        Ok(())
    }
}
