//! Serialisation of the line level's state.
//!
//! Theory: docs/theory.md, section 1.3.

use super::heat::state::HeatState;
use super::operators::{LineOperators, StripWear};
use super::state::LineState;
use crate::{INPUTS, Inputs};
use numerics::maximum::all_finite;

/// Name and value of a number of a state of [`LineState::numbers`] that is larger than `most` in magnitude, if any.
pub(crate) fn larger_than(numbers: &[f64], most: f64) -> Option<(&'static str, f64)> {
    let (index, &value) = numbers.iter().enumerate().find(|(_, number)| number.abs() > most)?;
    let count = numbers[0] as usize;
    let rows = ["the wear depth of the punch (m)", "the wear depth of the strip (m)", "the pressure (Pa)"];
    let name = match index {
        0 => "the number of cells",
        _ => rows.get((index - 1) / count.max(1)).copied().unwrap_or("a temperature, flux, displacement or energy"),
    };
    Some((name, value))
}

impl LineState {
    /// Copies `other` without allocating.
    pub(crate) fn copy_from(&mut self, other: &LineState) {
        if let (Some(mine), Some(heat)) = (&mut self.heat, &other.heat) {
            mine.copy_bodies_from(heat);
        }
        self.copy_contact_from(other);
    }

    /// Copies everything except the temperatures inside the bodies.
    pub(crate) fn copy_contact_from(&mut self, other: &LineState) {
        self.punch.copy_from_slice(&other.punch);
        self.strip.copy_from_slice(&other.strip);
        match (&mut self.track, &other.track) {
            (Some(mine), Some(track)) => mine.copy_from(track),
            (mine, track) => mine.clone_from(track),
        }
        match (&mut self.heat, &other.heat) {
            (Some(mine), Some(heat)) => mine.copy_contact_from(heat),
            (mine, heat) => mine.clone_from(heat),
        }
        self.volume = other.volume;
        self.pressure.copy_from_slice(&other.pressure);
        (self.approach, self.tilt) = (other.approach, other.tilt);
        self.current = other.current;
        self.end_inputs = other.end_inputs;
        (self.scales, self.fastest, self.direction) = (other.scales, other.fastest, other.direction);
        (self.carried, self.position) = (other.carried, other.position);
        self.status.copy_from(&other.status);
        (self.refinement, self.limits) = (other.refinement, other.limits);
        (self.error, self.steps, self.rejected) = (other.error, other.steps, other.rejected);
    }

    /// Whether the state is one of `operators`, as any state of their scene is.
    pub(crate) fn fits(&self, operators: &LineOperators) -> bool {
        let states = |state: &HeatState| state.bodies.each_ref().map(Vec::len);
        self.punch.len() == operators.count()
            && self.heat.as_ref().map(states) == operators.heat.as_ref().map(|bodies| bodies.states)
            && self.track.is_some() == (operators.strip_wear == StripWear::Track)
    }

    /// All numbers of the state, in the order that [`LineState::load`] reads.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let mut out = vec![self.punch.len() as f64];
        out.extend(&self.punch);
        out.extend(&self.strip);
        out.extend(&self.pressure);
        out.extend(self.volume);
        out.extend([self.approach, self.tilt, f64::from(u8::from(self.current)), self.carried, self.position]);
        out.extend(self.end_inputs.to_array());
        out.extend(self.scales);
        out.extend([self.fastest, self.direction]);
        out.extend([f64::from(self.refinement), f64::from(self.limits), self.error]);
        out.extend([self.steps as f64, self.rejected as f64]);
        self.status.save(&mut out);
        if let Some(heat) = &self.heat {
            heat.save(&mut out);
        }
        out.push(f64::from(u8::from(self.track.is_some())));
        if let Some(track) = &self.track {
            track.save(&mut out);
        }
        out
    }

    /// Reads [`LineState::numbers`] for `operators`; `None` if the numbers are not one.
    pub(crate) fn load(operators: &LineOperators, numbers: &[f64]) -> Option<LineState> {
        let numbers = &mut numbers.iter();
        let mut state = LineState::new(operators);
        let mut next = || numbers.next().copied();
        if next()? != operators.count() as f64 {
            return None;
        }
        for slot in state.punch.iter_mut().chain(&mut state.strip).chain(&mut state.pressure) {
            *slot = next()?;
        }
        for slot in &mut state.volume {
            *slot = next()?;
        }
        (state.approach, state.tilt) = (next()?, next()?);
        state.current = next()? != 0.0;
        (state.carried, state.position) = (next()?, next()?);
        let mut inputs = [0.0; INPUTS];
        for slot in &mut inputs {
            *slot = next()?;
        }
        state.end_inputs = Inputs::from_array(inputs);
        for slot in &mut state.scales {
            *slot = next()?;
        }
        (state.fastest, state.direction) = (next()?, next()?);
        let (refinement, limits) = (next()?, next()?);
        if !(0.0..=60.0).contains(&refinement) || !(0.0..256.0).contains(&limits) {
            return None;
        }
        (state.refinement, state.limits) = (refinement as u8, limits as u8);
        state.error = next()?;
        (state.steps, state.rejected) = (next()? as u64, next()? as u64);
        state.status.load(numbers)?;
        if let Some(heat) = &mut state.heat {
            heat.load(numbers)?;
        }
        match (*numbers.next()? != 0.0, &mut state.track) {
            (true, Some(track)) => track.load(numbers)?,
            (false, None) => {}
            _ => return None,
        }
        let cells = [&state.punch, &state.strip, &state.pressure];
        let scalars =
            [state.approach, state.tilt, state.carried, state.position, state.fastest, state.direction, state.error];
        let finite = cells.iter().all(|values| all_finite(values))
            && [&scalars[..], &state.volume, &state.scales].iter().all(|values| all_finite(values))
            && state.heat.as_ref().is_none_or(HeatState::is_finite);
        (finite && numbers.next().is_none()).then_some(state)
    }
}
