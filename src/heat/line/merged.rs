//! A body on cells of which neighbours are merged: one flux and one temperature for each group of cells.
//!
//! With the flux of a group on all its cells (P) and the mean over its cells weighted with their widths (R) the answer of the
//! body is `R G P`: exactly what cells of that size would get. States and account are those of the body itself.

use super::{Account, Gains, LineHeat, Stage, Surroundings};
use crate::elastic::Merging;
use nalgebra::DMatrix;
use std::cell::RefCell;

/// See the module.
#[derive(Debug)]
pub struct MergedHeat {
    body: Box<dyn LineHeat>,
    merging: Merging,
    gains: [Gains; 2],
    /// Fluxes (two) and answers (two) on the cells of the body.
    scratch: RefCell<[Vec<f64>; 4]>,
}

impl MergedHeat {
    /// `body` on the groups of `merging`, which are groups of its cells.
    pub fn new(body: Box<dyn LineHeat>, merging: Merging) -> MergedHeat {
        let (fine, coarse) = (body.cells(), merging.count());
        let gains =
            || Gains { temperature: DMatrix::zeros(coarse, coarse), distortion: DMatrix::zeros(coarse, coarse) };
        let zeros = || vec![0.0; fine];
        MergedHeat {
            gains: [gains(), gains()],
            scratch: RefCell::new([zeros(), zeros(), zeros(), zeros()]),
            body,
            merging,
        }
    }

    fn merge_gains(&mut self) {
        for stage in [Stage::First, Stage::End] {
            let (from, to) = (self.body.gains(stage), &mut self.gains[stage as usize]);
            self.merging.matrix_into(&from.temperature, &mut to.temperature);
            self.merging.matrix_into(&from.distortion, &mut to.distortion);
        }
    }
}

impl LineHeat for MergedHeat {
    fn cells(&self) -> usize {
        self.merging.count()
    }

    fn states(&self) -> usize {
        self.body.states()
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        self.body.uniform(rise, state);
    }

    fn fading(&self) -> Vec<f64> {
        self.body.fading()
    }

    fn prepare(&mut self, step: f64, velocity: [f64; 2]) {
        self.body.prepare(step, velocity);
        self.merge_gains();
    }

    fn prepare_euler(&mut self, step: f64, velocity: [f64; 2]) {
        self.body.prepare_euler(step, velocity);
        self.merge_gains();
    }

    fn gains(&self, stage: Stage) -> &Gains {
        &self.gains[stage as usize]
    }

    fn base(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) {
        let [fluxes, _, warm, moved] = &mut *self.scratch.borrow_mut();
        self.merging.spread(known, fluxes);
        self.body.base(state, surroundings, stage, fluxes, warm, moved);
        self.merging.means_into(warm, temperature);
        self.merging.means_into(moved, distortion);
    }

    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let [early, late, ..] = &mut *self.scratch.borrow_mut();
        self.merging.spread(first, early);
        self.merging.spread(end, late);
        self.body.advance(state, surroundings, early, late);
    }

    fn held(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64], velocity: f64, temperature: &mut [f64]) {
        let [fluxes, _, warm, _] = &mut *self.scratch.borrow_mut();
        self.merging.spread(flux, fluxes);
        self.body.held(state, surroundings, fluxes, velocity, warm);
        self.merging.means_into(warm, temperature);
    }

    fn held_distortion(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        distortion: &mut [f64],
    ) {
        let [fluxes, _, _, moved] = &mut *self.scratch.borrow_mut();
        self.merging.spread(flux, fluxes);
        self.body.held_distortion(state, surroundings, fluxes, velocity, moved);
        self.merging.means_into(moved, distortion);
    }

    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64 {
        let [fluxes, ..] = &mut *self.scratch.borrow_mut();
        self.merging.spread(flux, fluxes);
        self.body.cooled_temperature(state, surroundings, fluxes)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let [fluxes, ..] = &mut *self.scratch.borrow_mut();
        self.merging.spread(flux, fluxes);
        self.body.flows(state, surroundings, fluxes)
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        self.body.mean_temperature(state)
    }

    fn account(&self, state: &[f64]) -> Account {
        self.body.account(state)
    }

    fn error(&self) -> f64 {
        self.body.error()
    }

    fn error_of_the_mean(&self) -> f64 {
        self.body.error_of_the_mean()
    }

    fn boxed(&self) -> Box<dyn LineHeat> {
        Box::new(MergedHeat::new(self.body.boxed(), self.merging.clone()))
    }
}
