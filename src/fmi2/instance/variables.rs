//! Getting and setting variables, input derivatives, directional derivatives.

#![forbid(unsafe_code)]

use super::Instance;
use crate::fmi2::arguments::{Sink, Source};
use crate::fmi2::floating_point::Environment;
use crate::fmi2::policy::{self, Fault, INPUT_DERIVATIVE_ORDER};
use crate::fmi2::problem::{self, Outcome, Problem, argument, reference_problem};
use crate::fmi2::types::{Integer, Real};
use scene::variables::{self, Causality, OUTPUT_DERIVATIVE_ORDER, ValueReference};

/// Workspace of `fmi2GetDirectionalDerivative`, reused so that repeated calls allocate nothing.
#[derive(Default)]
pub(crate) struct Scratch {
    unknowns: Vec<ValueReference>,
    knowns: Vec<ValueReference>,
    seed: Vec<f64>,
    result: Vec<f64>,
}

impl Instance {
    /// `fmi2SetReal`, `fmi2SetInteger`, `fmi2SetBoolean`. Nothing is stored unless every element is valid.
    #[inline(always)]
    pub(crate) fn set<T: Copy + Into<f64>>(
        &mut self,
        kind: policy::Type,
        references: Source<'_, ValueReference>,
        values: Source<'_, T>,
    ) -> Outcome {
        let mut tunes = false;
        for index in 0..references.count() {
            let reference = references.at(index);
            let access = policy::access(reference);
            if !access.is(kind) || !access.settable().contains(self.phase) {
                return Err(reference_problem(reference, Some(kind), Some(self.phase)));
            }
            tunes |= !access.is_input();
        }
        let _environment = tunes.then(Environment::enter);
        if tunes {
            self.check_parameters(
                (0..references.count()).map(|index| (references.at(index), values.at(index).into())),
            )?;
        }
        for index in 0..references.count() {
            let (reference, value) = (references.at(index), values.at(index).into());
            if policy::access(reference).is_input() {
                self.component.set_input(reference, value);
            } else {
                self.component.set_parameter(reference, value);
            }
        }
        Ok(())
    }

    /// Checks the parameters among the variables that are to be set; all refused values are one problem.
    #[cold]
    fn check_parameters(&self, changes: impl Iterator<Item = (ValueReference, f64)> + Clone) -> Outcome {
        let parameters = changes.clone().filter(|(reference, _)| !policy::access(*reference).is_input());
        let refused: Vec<String> = parameters
            .filter_map(|(reference, value)| variables::check_parameter(reference, value).err())
            .map(|refusal| refusal.to_string())
            .collect();
        let refusal = |text: String| Problem { fault: Fault::Value, text: format!("{text}; the old value stays") };
        if !refused.is_empty() {
            return Err(refusal(refused.join("; ")));
        }
        self.component.check_tuning(changes).map_err(refusal)
    }

    /// `fmi2GetReal`, `fmi2GetInteger`, `fmi2GetBoolean`. An output that is no finite number is an error that names the input
    /// at fault; an input is returned as it was set.
    #[inline(always)]
    pub(crate) fn get<T: Copy>(
        &mut self,
        kind: policy::Type,
        references: Source<'_, ValueReference>,
        values: Sink<'_, T>,
        convert: impl Fn(f64) -> T,
    ) -> Outcome {
        let mut computes = false;
        for index in 0..references.count() {
            let reference = references.at(index);
            if !policy::access(reference).is(kind) {
                return Err(reference_problem(reference, Some(kind), None));
            }
            computes |= !self.component.is_current(reference);
        }
        let _environment = computes.then(Environment::enter);
        for index in 0..references.count() {
            let reference = references.at(index);
            let value = self.component.get(reference);
            if !value.is_finite() && !policy::access(reference).is_input() {
                return Err(self.no_number(reference, value));
            }
            values.put(index, convert(value));
        }
        Ok(())
    }

    /// An output that has no value at the present inputs.
    #[cold]
    fn no_number(&self, reference: ValueReference, value: f64) -> Problem {
        let _environment = Environment::enter();
        let name = variables::lookup(reference).map_or_else(String::new, |(row, at)| row.element_name(at));
        let reason = self.component.check_inputs(0.0).err().unwrap_or_else(|| "the inputs are out of range".to_owned());
        Problem { fault: Fault::Undefined, text: format!("{name} = {value} is not a finite number: {reason}") }
    }

    /// `fmi2GetString`, `fmi2SetString`: there are no such variables.
    pub(crate) fn no_strings(&mut self, references: Source<'_, ValueReference>) -> Outcome {
        if references.count() == 0 { Ok(()) } else { Err(reference_problem(references.at(0), None, None)) }
    }

    /// `fmi2SetRealInputDerivatives`: order 1 only, valid for the next step. Like the inputs
    /// themselves they are stored whatever their value, and that step refuses values that are not finite.
    pub(crate) fn set_real_input_derivatives(
        &mut self,
        references: Source<'_, ValueReference>,
        orders: Source<'_, Integer>,
        values: Source<'_, Real>,
    ) -> Outcome {
        check_derivatives(references, orders, Causality::Input, INPUT_DERIVATIVE_ORDER)?;
        for index in 0..references.count() {
            self.component.set_input_derivative(references.at(index), values.at(index));
        }
        Ok(())
    }

    /// `fmi2GetRealOutputDerivatives`: order 1, at the end of the last step, at the present inputs.
    pub(crate) fn get_real_output_derivatives(
        &mut self,
        references: Source<'_, ValueReference>,
        orders: Source<'_, Integer>,
        result: Sink<'_, Real>,
    ) -> Outcome {
        check_derivatives(references, orders, Causality::Output, OUTPUT_DERIVATIVE_ORDER)?;
        let scratch = &mut self.scratch;
        references.copy_into(&mut scratch.unknowns);
        scratch.result.clear();
        scratch.result.resize(scratch.unknowns.len(), 0.0);
        self.component
            .output_derivatives(&scratch.unknowns, &mut scratch.result)
            .map_err(|text| Problem { fault: Fault::Undefined, text })?;
        result.put_all(&self.scratch.result);
        Ok(())
    }

    /// `fmi2GetDirectionalDerivative`: of outputs by inputs.
    pub(crate) fn get_directional_derivative(
        &mut self,
        unknowns: Source<'_, ValueReference>,
        knowns: Source<'_, ValueReference>,
        seed: Source<'_, Real>,
        result: Sink<'_, Real>,
    ) -> Outcome {
        for (references, causality) in [(unknowns, Causality::Output), (knowns, Causality::Input)] {
            (0..references.count()).try_for_each(|index| check_real(references.at(index), causality))?;
        }
        let scratch = &mut self.scratch;
        unknowns.copy_into(&mut scratch.unknowns);
        knowns.copy_into(&mut scratch.knowns);
        seed.copy_into(&mut scratch.seed);
        if let Some(value) = scratch.seed.iter().find(|value| !value.is_finite()) {
            return argument(format!("the seed {value} must be finite"));
        }
        scratch.result.clear();
        scratch.result.resize(scratch.unknowns.len(), 0.0);
        self.component
            .directional_derivative(&scratch.unknowns, &scratch.knowns, &scratch.seed, &mut scratch.result)
            .map_err(|text| Problem { fault: Fault::Undefined, text })?;
        result.put_all(&self.scratch.result);
        Ok(())
    }
}

/// Checks that derivatives of inputs or outputs are of the order that is offered.
fn check_derivatives(
    references: Source<'_, ValueReference>,
    orders: Source<'_, Integer>,
    causality: Causality,
    offered: i32,
) -> Outcome {
    for index in 0..references.count() {
        check_real(references.at(index), causality)?;
        let order = orders.at(index);
        if order != offered {
            let kind = if causality == Causality::Input { "input" } else { "output" };
            return argument(format!("{kind} derivatives are of order {offered}, not {order}"));
        }
    }
    Ok(())
}

/// Checks that a variable is a Real and an input, or a result of the FMU.
#[inline(always)]
fn check_real(reference: ValueReference, causality: Causality) -> Outcome {
    let access = policy::access(reference);
    if !access.is(policy::Type::Real) {
        return Err(reference_problem(reference, Some(policy::Type::Real), None));
    }
    let is_result = || variables::lookup(reference).is_some_and(|(row, _)| row.is_result());
    let fits = if causality == Causality::Input { access.is_input() } else { is_result() };
    if fits { Ok(()) } else { Err(problem::not_an(causality, reference)) }
}
