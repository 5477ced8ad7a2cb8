//! The lumped state as numbers.
//!
//! Theory: docs/theory.md, section 1.3.

use super::state::{BodyState, LumpedState};
use contact::wear::track::Track;
use numerics::maximum::all_finite;

impl LumpedState {
    /// All numbers of the state, in the order that [`LumpedState::from_numbers`] reads.
    pub fn numbers(&self) -> Vec<f64> {
        let mut out = Vec::with_capacity(96);
        for body in [&self.punch, &self.strip] {
            write_row(&mut out, &body.heat);
            out.extend(body.received);
            out.extend([body.external, body.lost, body.trend, body.depth, body.worn]);
        }
        write_row(&mut out, &self.flash);
        out.extend(self.clone().scalars().map(|(_, scalar)| *scalar));
        out.extend([f64::from(self.limits), f64::from(self.refinement), self.steps as f64, self.rejected as f64]);
        if let Some(track) = &self.track {
            out.push(1.0);
            track.save(&mut out);
        } else {
            out.push(0.0);
        }
        out
    }

    /// The state of these numbers; `None` where they are not those of a state.
    pub fn from_numbers(numbers: &mut std::slice::Iter<'_, f64>) -> Option<LumpedState> {
        let all = numbers.as_slice();
        let mut state = LumpedState::default();
        for body in [&mut state.punch, &mut state.strip] {
            read_row(numbers, &mut body.heat)?;
            let BodyState { received, external, lost, trend, depth, worn, .. } = body;
            for slot in received.iter_mut().chain([external, lost, trend, depth, worn]) {
                *slot = *numbers.next()?;
            }
        }
        read_row(numbers, &mut state.flash)?;
        let mut next = || numbers.next().copied();
        for (_, scalar) in state.scalars() {
            *scalar = next()?;
        }
        state.limits = next()? as u8;
        state.refinement = next()? as u8;
        state.steps = next()? as u64;
        state.rejected = next()? as u64;
        if next()? != 0.0 {
            let mut track = Track::new(1.0, 0.0);
            track.load(numbers)?;
            state.track = Some(track);
        }
        let read = &all[..all.len() - numbers.as_slice().len()];
        all_finite(read).then_some(state)
    }

    /// What the scalars are, in the order in which they are saved.
    fn scalars(&mut self) -> [(&'static str, &mut f64); 17] {
        let ([punch_start, strip_start], [punch_far, strip_far]) = (&mut self.far_start, &mut self.far);
        let peak = "the largest rise, flux or wear rate so far (K, W/m2, m/s)";
        let contact = "the contact temperature (K above the reference)";
        let far = "a far face's temperature (K)";
        [
            ("the position on the track (m)", &mut self.position),
            ("the sliding distance (m)", &mut self.distance),
            ("the dissipated energy (J/m2)", &mut self.dissipated),
            ("the bristle's deflection (m)", &mut self.bristle),
            ("the bristle's stiffness (N/m)", &mut self.stiffness),
            (peak, &mut self.peak_rise),
            (peak, &mut self.peak_flux),
            (peak, &mut self.peak_wear),
            (contact, &mut self.reference),
            ("the step error so far", &mut self.error),
            (contact, &mut self.end_temperature),
            ("the friction force (N)", &mut self.end_force),
            ("the growth of perturbations", &mut self.growth),
            (far, punch_start),
            (far, strip_start),
            (far, punch_far),
            (far, strip_far),
        ]
    }

    /// Name and value of a number larger than `most` in magnitude, if any.
    pub(crate) fn larger_than(&self, most: f64) -> Option<(&'static str, f64)> {
        let LumpedState { punch, strip, .. } = self;
        let mut track = Vec::new();
        self.track.iter().for_each(|own| own.save(&mut track));
        let rows: [(&str, &[f64]); 11] = [
            ("punch: a temperature (K above the reference)", &punch.heat),
            ("strip: a temperature (K above the reference)", &strip.heat),
            ("punch: heat received by a surface (J/m2)", &punch.received),
            ("strip: heat received by a surface (J/m2)", &strip.received),
            ("punch: heat from its neighbour or to the air (J/m2)", &[punch.external, punch.lost]),
            ("strip: heat from its neighbour or to the air (J/m2)", &[strip.external, strip.lost]),
            ("the rate of a mean temperature (K/s)", &[punch.trend, strip.trend]),
            ("punch: wear depth (m)", &[punch.depth, punch.worn]),
            ("strip: wear depth (m)", &[strip.depth, strip.worn]),
            ("the local temperature rise under the punch (K)", &self.flash),
            ("a depth or place of the worn track (m)", &track),
        ];
        let rows = rows.into_iter().flat_map(|(name, row)| row.iter().map(move |value| (name, *value)));
        let scalars = self.clone().scalars().map(|(name, scalar)| (name, *scalar));
        rows.chain(scalars).find(|(_, value)| value.abs() > most)
    }
}

/// Writes a row without its trailing zeros.
fn write_row(out: &mut Vec<f64>, values: &[f64]) {
    let count = values.iter().rposition(|value| value.to_bits() != 0).map_or(0, |last| last + 1);
    out.push(count as f64);
    out.extend(&values[..count]);
}

fn read_row(numbers: &mut std::slice::Iter<'_, f64>, values: &mut [f64]) -> Option<()> {
    let count = *numbers.next()?;
    if !(0.0..=values.len() as f64).contains(&count) {
        return None;
    }
    for slot in &mut values[..count as usize] {
        *slot = *numbers.next()?;
    }
    Some(())
}
