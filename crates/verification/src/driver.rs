//! Component driver of the verification problems, with variables by name.

use crate::Fallible;
use scene::variables::{STARTS, ValueReference, changed, find};
use sliding_contact::component::{Component, Values};
use std::sync::Arc;

/// An initialised component with variables by name.
pub(crate) struct Driven(Component);

fn reference(name: &str) -> Fallible<ValueReference> {
    Ok(find(name).ok_or_else(|| format!("there is no variable {name}"))?)
}

impl Driven {
    /// The stock scene with changed start values, initialised.
    pub(crate) fn new(changes: &[(&str, f64)]) -> Fallible<Driven> {
        // Problems at another level select it; the default is the lumped one.
        Driven::of(changed(&changed(&STARTS, &[("solver.fidelity", 2.0)])?, changes)?)
    }

    /// A scene file with changed start values, initialised.
    pub(crate) fn read(file: &str, changes: &[(&str, f64)]) -> Fallible<Driven> {
        let scene = scene_file::parse(file)?;
        Driven::of(changed(&scene.packaged.starts, changes)?)
    }

    /// These start values, initialised.
    pub(crate) fn of(starts: Values) -> Fallible<Driven> {
        let mut component = Component::new(Arc::new(starts));
        component.enter_initialization();
        component.initialise(None)?;
        Ok(Driven(component))
    }

    pub(crate) fn set(&mut self, name: &str, value: f64) -> Fallible<()> {
        self.0.set_input(reference(name)?, value);
        Ok(())
    }

    pub(crate) fn set_slope(&mut self, name: &str, slope: f64) -> Fallible<()> {
        self.0.set_input_derivative(reference(name)?, slope);
        Ok(())
    }

    pub(crate) fn get(&mut self, name: &str) -> Fallible<f64> {
        Ok(self.0.get(reference(name)?))
    }

    /// Internal steps accepted and rejected so far.
    pub(crate) fn work(&self) -> (u64, u64) {
        self.0.work()
    }

    pub(crate) fn steps(&mut self, step: f64, count: u32) -> Fallible<()> {
        Ok((0..count).try_for_each(|_| self.0.step(step))?)
    }
}
