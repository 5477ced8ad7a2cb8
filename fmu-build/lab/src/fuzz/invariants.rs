//! Invariants of the outputs after every `fmi2OK`.

use std::sync::LazyLock;

use scene::variables::{COUNT, Causality, FLAT, Kind, Row, TABLE, ValueReference, lookup, reference};

/// Relative tolerance of inequalities between outputs that are evaluated in different ways.
const SLACK: f64 = 1e-9;
/// Energy balance: tolerance relative to the sum of its terms' magnitudes.
const BALANCE: f64 = 1e-7;
/// Rounding error of a heat flow, W: a steady one is a difference of large terms, and adds up over years.
const FLOW: f64 = 1e-12;

/// Every Real variable that the library calculates.
pub(crate) static OUTPUTS: LazyLock<Vec<ValueReference>> = LazyLock::new(|| {
    rows(|row| matches!(row.causality, Causality::Output | Causality::Local) && matches!(row.kind, Kind::Real { .. }))
});

/// References of the variables whose row fulfils a condition.
pub(crate) fn rows(condition: impl Fn(&Row) -> bool) -> Vec<ValueReference> {
    (0..COUNT).filter(|&at| condition(&TABLE[FLAT[at].0 as usize])).map(|at| at as ValueReference).collect()
}

/// Full name of a variable.
pub(crate) fn name_of(reference: ValueReference) -> String {
    lookup(reference).map_or_else(|| format!("#{reference}"), |(row, element)| row.element_name(element))
}

#[derive(Clone, Debug)]
pub(crate) struct Outputs {
    values: Vec<f64>,
    /// The run has not left the model's validity: bit 4 of `limit_reached`.
    is_valid: bool,
    /// Simulated time, s.
    seconds: f64,
}

const TEMPERATURES: [ValueReference; 3] =
    [reference("contact_temperature"), reference("punch.mean_temperature"), reference("strip.mean_temperature")];

/// Bit of `limit_reached`.
pub(crate) const VALIDITY: i32 = 4;

impl Outputs {
    /// Of values in the order of [`OUTPUTS`], and `limit_reached`.
    pub(crate) fn new(values: Vec<f64>, limits: i32) -> Self {
        Self { values, is_valid: limits & VALIDITY == 0, seconds: 0.0 }
    }

    /// At the end of `seconds` of simulated time.
    pub(crate) fn at(self, seconds: f64) -> Self {
        Self { seconds: seconds.abs(), ..self }
    }

    fn of(&self, reference: ValueReference) -> f64 {
        OUTPUTS.binary_search(&reference).ok().and_then(|at| self.values.get(at)).copied().unwrap_or(f64::NAN)
    }

    pub(crate) fn bits(&self) -> impl Iterator<Item = u64> {
        self.values.iter().map(|value| value.to_bits())
    }

    /// The first that differs in its bits from another's.
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        let at = self.bits().zip(other.bits()).position(|(own, other)| own != other)?;
        Some(format!("{} = {:e} and {:e}", name_of(OUTPUTS[at]), self.values[at], other.values[at]))
    }

    /// The error is the first output that is not finite.
    pub(crate) fn check_finite(&self) -> Result<(), String> {
        match self.values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!("{} = {}", name_of(OUTPUTS[at]), self.values[at])),
            None => Ok(()),
        }
    }

    /// The error is the first invariant that does not hold; `before`: the outputs of the step before, where the run was not set back.
    pub(crate) fn check(&self, before: Option<&Self>) -> Result<(), String> {
        self.check_finite()?;
        const NOT_NEGATIVE: [ValueReference; 9] = [
            reference("pressure_mean"),
            reference("pressure_max"),
            reference("contact_fraction"),
            reference("wear_volume_punch"),
            reference("wear_volume_strip"),
            reference("sliding_distance"),
            reference("remaining_life"),
            reference("estimated_error"),
            reference("estimated_step_error"),
        ];
        for reference in NOT_NEGATIVE.into_iter().chain((0..33).map(|at| reference("profile.pressure") + at)) {
            if self.of(reference) < 0.0 {
                return Err(format!("{} = {:e} is negative", name_of(reference), self.of(reference)));
            }
        }
        // A body of a few modes undershoots where a face is at temperatures that no contact has: the run is then told to be
        // outside the model's validity.
        for reference in TEMPERATURES {
            if self.is_valid && self.of(reference) < 0.0 {
                return Err(format!("{} = {} K is below 0 K", name_of(reference), self.of(reference)));
            }
        }
        for reference in [reference("contact_fraction"), reference("remaining_life")] {
            if self.of(reference) > 1.0 + SLACK {
                return Err(format!("{} = {} is above 1", name_of(reference), self.of(reference)));
            }
        }
        let (mean, highest) =
            (self.of(reference("contact_temperature")), self.of(reference("contact_temperature_max")));
        if highest < mean * (1.0 - SLACK) {
            return Err(format!("contact_temperature_max = {highest} is below contact_temperature = {mean}"));
        }
        // Heat that was stored at temperatures that no contact has leaves its rounding errors.
        if self.is_valid {
            self.check_balance()?;
        }
        let Some(before) = before else { return Ok(()) };
        for reference in [reference("wear_volume_punch"), reference("wear_volume_strip"), reference("sliding_distance")]
        {
            if self.of(reference) < before.of(reference) {
                return Err(format!(
                    "{} decreases from {:e} to {:e}",
                    name_of(reference),
                    before.of(reference),
                    self.of(reference)
                ));
            }
        }
        Ok(())
    }

    /// The error is dissipated, stored and lost heat, where they do not add up.
    fn check_balance(&self) -> Result<(), String> {
        let terms = [
            reference("dissipated_energy"),
            reference("stored_heat"),
            reference("heat_lost_punch_top"),
            reference("heat_lost_strip_base"),
            reference("heat_lost_ambient"),
        ]
        .map(|reference| self.of(reference));
        let rest = terms[0] - terms[1..].iter().sum::<f64>();
        let magnitude: f64 = terms.iter().map(|term| term.abs()).sum();
        if rest.abs() > BALANCE * magnitude + FLOW * self.seconds.max(1.0) {
            return Err(format!("dissipated, stored and lost heat {terms:?} J leave {rest:e} J"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outputs that hold, with one changed.
    fn with(name: &str, value: f64) -> Outputs {
        let mut outputs = Outputs::new(vec![0.0; OUTPUTS.len()], 0);
        let changed = OUTPUTS.iter().position(|&reference| name_of(reference) == name);
        outputs.values[changed.unwrap()] = value;
        outputs
    }

    #[test]
    fn each_invariant_is_judged() {
        let before = with("wear_volume_punch", 1e-9);
        assert_eq!(with("wear_volume_punch", 1e-9).check(Some(&before)), Ok(()));
        for (name, value, told) in [
            ("wear_depth", f64::NAN, "wear_depth = NaN"),
            ("profile.wear_strip[33]", f64::INFINITY, "profile.wear_strip[33] = inf"),
            ("pressure_max", -1e-3, "pressure_max = -1e-3 is negative"),
            ("profile.pressure[7]", -1e-3, "profile.pressure[7] = -1e-3 is negative"),
            ("contact_fraction", 1.1, "contact_fraction = 1.1 is above 1"),
            ("contact_temperature", 1.0, "is below contact_temperature = 1"),
            ("punch.mean_temperature", -1.0, "punch.mean_temperature = -1 K is below 0 K"),
            ("estimated_error", -1.0, "estimated_error = -1e0 is negative"),
            ("stored_heat", 1.0, "leave -1e0 J"),
            ("wear_volume_punch", 0.9e-9, "wear_volume_punch decreases from 1e-9 to 9e-10"),
        ] {
            let found = with(name, value).check(Some(&before)).unwrap_err();
            assert!(found.contains(told), "{found}");
        }
        let beyond = Outputs::new(with("punch.mean_temperature", -1.0).values, VALIDITY);
        assert_eq!(beyond.check(None), Ok(()));
        assert_eq!(with("stored_heat", 1e-5).at(1e8).check(None), Ok(()));
        assert!(with("stored_heat", 1e-5).at(1e6).check(None).is_err());
        let difference = before.difference(&with("wear_volume_punch", 2e-9)).unwrap();
        assert_eq!(difference, "wear_volume_punch = 1e-9 and 2e-9");
        assert!(before.difference(&before).is_none());
    }
}
