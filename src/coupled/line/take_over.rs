//! Going on from a lower rung: worn volumes and heat are those of the lower rung, to rounding.

mod heat;

pub use heat::Carrier;

use super::Line;
use crate::coupled::INPUTS;
use crate::coupled::lumped::{Lumped, state::State as MeanState};
use crate::elastic::Cells;

impl Line {
    /// Makes room for what a lower rung hands over, so that taking it over allocates nothing.
    pub fn prepare_take_over(&mut self) {
        if self.carrier.is_none() {
            self.carrier = Some(Box::new(Carrier::new(&self.operators)));
        }
    }

    /// Goes on where the lumped level stands: its worn depth under every cell, its track, its heat in the mean or, where the
    /// cells carry heat, in them. `inputs` of the present.
    ///
    /// `false`: the states of the two do not belong together, and nothing changes.
    pub fn take_over_mean(&mut self, lower: &mut Lumped, inputs: &[f64; INPUTS]) -> bool {
        let mut mean = self.unworn(lower.state());
        if !mean.fits(&self.operators.mean) {
            return false;
        }
        self.prepare_take_over();
        let from = lower.state();
        // What the lower rung has taken is no work of the contact line's.
        (mean.steps, mean.rejected) = (from.steps, from.rejected);
        let width = lower.operators().area / self.operators.shared_depth;
        self.state.punch.fill(from.punch.depth);
        self.state.strip.fill(from.strip.depth);
        self.state.volume = [from.punch.worn * width, from.strip.worn * width];
        self.state.position = from.position;
        if let (Some(track), Some(worn)) = (&mut self.state.track, &from.track) {
            track.take_over(worn.spans(), from.position);
            track.depth_under(from.position, &mut self.state.strip);
        }
        self.begin_anew();
        self.mean.set_state(&mean);
        self.take_heat_in(|line, carrier| line.take_heat_of_mean(lower, carrier, inputs));
        true
    }

    /// Goes on where a line of other cells stands, or one that carries its heat by the mean: every cell takes the mean of what it
    /// covers. `inputs` of the present.
    ///
    /// `false`: the states of the two do not belong together, and nothing changes.
    pub fn take_over_line(&mut self, lower: &mut Line, inputs: &[f64; INPUTS]) -> bool {
        let tracked = self.state.track.is_some() == lower.state.track.is_some();
        if !tracked || (lower.heat.is_some() && self.heat.is_none()) || !lower.mean.state().fits(&self.operators.mean) {
            return false;
        }
        self.prepare_take_over();
        let (coarse, fine) = (&lower.operators.cells, &self.operators.cells);
        cover(coarse, &lower.state.punch, fine, &mut self.state.punch);
        cover(coarse, &lower.state.strip, fine, &mut self.state.strip);
        let from = &lower.state;
        self.state.volume = from.volume;
        self.state.position = from.position;
        if let (Some(track), Some(worn)) = (&mut self.state.track, &from.track) {
            track.take_over(worn.spans(), from.position);
            track.depth_under(from.position, &mut self.state.strip);
        }
        (self.state.limits, self.state.error) = (from.limits, from.error);
        (self.state.steps, self.state.rejected) = (from.steps, from.rejected);
        self.begin_anew();
        self.mean.set_state(lower.mean.state());
        self.take_heat_in(|line, carrier| match lower.heat.is_some() {
            true => line.take_heat_of_line(lower, carrier, inputs),
            false => line.take_heat_of_mean(&mut lower.mean, carrier, inputs),
        });
        true
    }

    fn take_heat_in(&mut self, take: impl FnOnce(&mut Line, &mut Carrier)) {
        if self.heat.is_none() {
            return;
        }
        if let Some(mut carrier) = self.carrier.take() {
            take(self, &mut carrier);
            self.carrier = Some(carrier);
        }
    }

    /// State of the lower rung without the wear, which the cells carry.
    fn unworn(&self, from: &MeanState) -> MeanState {
        let mut mean = from.clone();
        for body in [&mut mean.punch, &mut mean.strip] {
            (body.depth, body.worn) = (0.0, 0.0);
        }
        mean.track.clone_from(&self.mean.state().track);
        mean
    }

    /// Nothing of the last step is known.
    fn begin_anew(&mut self) {
        self.state.pressure.fill(0.0);
        self.state.current = false;
        self.state.end_inputs = [f64::NAN; INPUTS];
        self.state.refinement = 0;
        self.contact.set_status(&self.state.status);
        self.forget_shown();
    }
}

/// Means of `values` (on the cells `from`, over the same contact) over the cells `to`: their integral stays.
fn cover(from: &Cells, values: &[f64], to: &Cells, target: &mut [f64]) {
    let (old, new) = (from.edges(), to.edges());
    let mut first = 0;
    for (i, slot) in target.iter_mut().enumerate() {
        let (low, high) = (new[i], new[i + 1]);
        while first + 1 < values.len() && old[first + 1] <= low {
            first += 1;
        }
        let (mut sum, mut j) = (0.0, first);
        while j < values.len() && old[j] < high {
            sum += values[j] * (old[j + 1].min(high) - old[j].max(low)).max(0.0);
            j += 1;
        }
        *slot = sum / (high - low);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covering_other_cells_keeps_the_integral() {
        let (coarse, fine) = (Cells::graded(0.03, 9).unwrap(), Cells::graded(0.03, 17).unwrap());
        let values: Vec<f64> = coarse.centres().iter().map(|x| 1e-6 + 3e-4 * x * x + 1e-5 * x).collect();
        let mut covered = vec![0.0; 17];
        cover(&coarse, &values, &fine, &mut covered);
        let (before, after) = (coarse.integral(&values), fine.integral(&covered));
        assert!((after / before - 1.0).abs() < 1e-14, "{before} {after}");
        assert!(covered.iter().all(|depth| *depth >= values.iter().copied().fold(f64::INFINITY, f64::min)));
        // Back on the same cells nothing changes.
        let mut same = vec![0.0; 9];
        cover(&coarse, &values, &coarse, &mut same);
        assert!(
            same.iter().zip(&values).all(|(same, value)| (same / value - 1.0).abs() < 1e-14),
            "{same:?} {values:?}"
        );
    }
}
