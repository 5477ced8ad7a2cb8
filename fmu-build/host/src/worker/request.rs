//! A scene with its names resolved and all checks done that do not require the FMU.

use crate::description::{Causality, Description, Kind, Variable};
use crate::error::Failure;
use crate::scene::Scene;
use crate::schedule::Interpolation;
use std::ffi::c_int;

pub(super) struct Numbers<T> {
    pub references: Vec<u32>,
    pub values: Vec<T>,
}

impl<T> Numbers<T> {
    const fn new() -> Self {
        Self { references: Vec::new(), values: Vec::new() }
    }

    fn push(&mut self, reference: u32, value: T) {
        self.references.push(reference);
        self.values.push(value);
    }
}

/// A scene with its names resolved.
pub(super) struct Request<'a> {
    /// Parameters, by type; items of enumerations are integers.
    pub reals: Numbers<f64>,
    pub integers: Numbers<c_int>,
    pub booleans: Numbers<c_int>,
    /// Inputs, the order of their derivatives, and what the schedule's columns are multiplied by.
    pub inputs: Vec<u32>,
    pub orders: Vec<c_int>,
    pub factors: Vec<f64>,
    pub outputs: Vec<&'a Variable>,
    pub steps: usize,
    /// Indices of the communication points to record at.
    pub points: Vec<usize>,
}

impl<'a> Request<'a> {
    /// An error where a name is none of the FMU's or stands twice, a value is none of its type, or times do not fit.
    pub(crate) fn resolve(description: &'a Description, scene: &Scene) -> Result<Self, Failure> {
        let wrong = |reason: String| Err(Failure::request(reason));
        let (mut reals, mut integers, mut booleans) = (Numbers::new(), Numbers::new(), Numbers::new());
        for (at, &(name, value)) in scene.parameters.iter().enumerate() {
            let variable = description.find_as(name, Causality::Parameter)?;
            if scene.parameters[..at].iter().any(|&(before, _)| before == name) {
                return wrong(format!("the parameter {name} is given twice"));
            }
            if !value.is_finite() {
                return wrong(format!("{name} = {value} must be finite"));
            }
            match variable.kind {
                Kind::Real => reals.push(variable.reference, value),
                Kind::Integer | Kind::Enumeration(_) => integers.push(variable.reference, variable.whole(value)?),
                Kind::Boolean => booleans.push(variable.reference, variable.whole(value)?),
                Kind::String => return wrong(format!("{name} is a text; a scene sets numbers only")),
            }
        }
        if scene.inputs.len() != scene.schedule.columns() {
            return wrong(format!("{} inputs for {} columns", scene.inputs.len(), scene.schedule.columns()));
        }
        let mut inputs = Vec::with_capacity(scene.inputs.len());
        for (at, &name) in scene.inputs.iter().enumerate() {
            let variable = description.find_as(name, Causality::Input)?;
            if scene.inputs[..at].contains(&name) || variable.kind != Kind::Real {
                return wrong(format!("the input {name} stands twice or is no Real"));
            }
            inputs.push(variable.reference);
        }
        let factors = if scene.factors.is_empty() { vec![1.0; inputs.len()] } else { scene.factors.to_vec() };
        if factors.len() != inputs.len() || factors.iter().any(|factor| !factor.is_finite()) {
            return wrong(format!("the factors {factors:?} must be finite and one for each of {:?}", scene.inputs));
        }
        if let Some(tolerance) = scene.tolerance.filter(|tolerance| !(tolerance.is_finite() && *tolerance > 0.0)) {
            return wrong(format!("the tolerance {tolerance} must be positive"));
        }
        if scene.interpolation == Interpolation::Linear && !description.takes_input_derivatives {
            return wrong(format!("{} takes no derivatives of inputs", description.model_name));
        }
        let outputs: Vec<&Variable> =
            scene.outputs.iter().map(|name| description.find(name)).collect::<Result<_, _>>()?;
        if let Some(text) = outputs.iter().find(|variable| variable.kind == Kind::String) {
            return wrong(format!("{} is a text and cannot be recorded", text.name));
        }
        Ok(Self {
            reals,
            integers,
            booleans,
            orders: vec![1; inputs.len()],
            inputs,
            factors,
            outputs,
            steps: scene.span.steps()?,
            points: scene.span.indices(scene.points)?,
        })
    }
}
