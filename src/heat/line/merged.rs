//! A body on cells of which neighbours are merged: one flux and one temperature for each group of cells.
//!
//! With the flux of a group on all its cells (P) and the mean over its cells weighted with their widths (R) the answer of the
//! body is `R G P`: exactly what cells of that size would get. States and account are those of the body itself.

use super::{Account, CooledAhead, FACES, Gains, LineHeat, Stage, Surroundings};
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

    fn fading_while_sliding(&self, velocity: f64) -> Vec<f64> {
        self.body.fading_while_sliding(velocity)
    }

    fn indifference(&self) -> f64 {
        self.body.indifference()
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

    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; FACES] {
        let [fluxes, ..] = &mut *self.scratch.borrow_mut();
        self.merging.spread(flux, fluxes);
        self.body.cooled_temperature(state, surroundings, fluxes)
    }

    fn cooled_ahead(&self, state: &[f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) -> CooledAhead {
        let [early, late, ..] = &mut *self.scratch.borrow_mut();
        self.merging.spread(first, early);
        self.merging.spread(end, late);
        self.body.cooled_ahead(state, surroundings, early, late)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elastic::Cells;
    use crate::heat::line::strip::tests::cooled_steel;
    use crate::heat::line::strip::{Path, Resolution, StripHeat};

    #[test]
    fn groups_answer_like_the_body_under_their_fluxes() {
        let cells = Cells::graded(0.02, 9).unwrap();
        let properties = cooled_steel(Path::Closed(0.3));
        let resolution = Resolution { duration: 60.0, shortest: 0.02, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let merging = Merging::pairs(&cells);
        let mut merged = MergedHeat::new(body.boxed(), merging.clone()).boxed();
        assert_eq!((merged.cells(), merged.states()), (5, body.states()));
        assert_eq!(merged.fading(), body.fading());
        assert_eq!([merged.error(), merged.error_of_the_mean()], [body.error(), body.error_of_the_mean()]);

        let air = Surroundings { cooling: -400.0, ambient: 5.0, far: 3.0, ..Surroundings::default() };
        let [groups_first, groups_end] = [[3e4, 1e4, 5e4, 2e4, 4e4], [1e4, 6e4, 2e4, 5e4, 3e4]];
        let spread = |flux: &[f64]| {
            let mut fine = vec![0.0; 9];
            merging.spread(flux, &mut fine);
            fine
        };
        let (first, end) = (spread(&groups_first), spread(&groups_end));
        let (mut state, mut own) = (vec![0.0; body.states()], vec![0.0; merged.states()]);
        body.uniform(20.0, &mut state);
        merged.uniform(20.0, &mut own);
        let (mut fine, mut coarse) = ([vec![0.0; 9], vec![0.0; 9]], [vec![0.0; 5], vec![0.0; 5]]);
        for euler in [false, true] {
            let velocity = [0.4, 0.5];
            match euler {
                false => (body.prepare(0.3, velocity), merged.prepare(0.3, velocity)),
                true => (body.prepare_euler(0.3, velocity), merged.prepare_euler(0.3, velocity)),
            };
            for stage in [Stage::First, Stage::End] {
                let (from, to) = (body.gains(stage), merged.gains(stage));
                assert_eq!(to.temperature, merging.matrix(&from.temperature));
                assert_eq!(to.distortion, merging.matrix(&from.distortion));
                let ([warm, moved], [means, depths]) = (&mut fine, &mut coarse);
                body.base(&state, &air, stage, &first, warm, moved);
                merged.base(&own, &air, stage, &groups_first, means, depths);
                assert_eq!([&*means, &*depths], [&merging.means(warm), &merging.means(moved)]);
            }
            body.advance(&mut state, &air, &first, &end);
            merged.advance(&mut own, &air, &groups_first, &groups_end);
            assert_eq!(own, state);
            let ([warm, moved], [means, depths]) = (&mut fine, &mut coarse);
            body.held(&state, &air, &end, 0.5, warm);
            merged.held(&own, &air, &groups_end, 0.5, means);
            body.held_distortion(&state, &air, &end, 0.5, moved);
            merged.held_distortion(&own, &air, &groups_end, 0.5, depths);
            assert_eq!([&*means, &*depths], [&merging.means(warm), &merging.means(moved)]);
            assert!(means.iter().all(|t| *t > 15.0) && depths.iter().all(|u| *u < 0.0), "{means:?} {depths:?}");
            let cooled = body.cooled_temperature(&state, &air, &end);
            assert_eq!(merged.cooled_temperature(&own, &air, &groups_end), cooled);
            let [ahead, expected] = [
                merged.cooled_ahead(&own, &air, &groups_first, &groups_end),
                body.cooled_ahead(&state, &air, &first, &end),
            ];
            assert_eq!(ahead, expected);
            assert_eq!(merged.flows(&own, &air, &groups_end), body.flows(&state, &air, &end));
            assert_eq!(merged.mean_temperature(&own), body.mean_temperature(&state));
            assert_eq!(merged.account(&own), body.account(&state));
        }
    }
}
