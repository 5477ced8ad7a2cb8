//! Heat of a lower rung on the cells of a higher one.
//!
//! The two describe a body by states that have nothing in common. What has to stay is its heat, to rounding; what should stay is
//! the temperature of its surface. So the higher rung's body starts from its initial temperature, rests in its present
//! surroundings, and gets what is missing by two fluxes in the pattern of the present one, over the time in which the present flow
//! would have brought what it received, and over a thirtieth of it: a body that was heated evenly is found again by the first alone.
//! The amounts of both follow from
//!
//! ```text
//! E = E_0 + alpha E_1 + beta E_2,    T = T_0 + alpha T_1 + beta T_2
//! ```
//!
//! the heat that the body has gained, and the mean temperature of its surface under the present flux.

use crate::coupled::INPUTS;
use crate::coupled::line::Line;
use crate::coupled::line::heat::state::{HeatState, Place, entries};
use crate::coupled::line::operators::Operators;
use crate::coupled::lumped::Lumped;
use crate::heat::line::{Account, Surroundings};

/// Second time over the first.
const SHORTER: f64 = 1.0 / 30.0;

/// Bounds of the first time, in the time that heat takes through the body's height.
const TIMES: (f64, f64) = (1e-6, 1e3);

/// Least determinant, of its larger product, from which both amounts are told apart.
const TOLD_APART: f64 = 1e-9;

/// Memory in which states are carried over.
#[derive(Clone, Debug)]
pub struct Carrier {
    /// States of two fluxes.
    states: [Vec<f64>; 2],
    /// N each: temperatures, the pattern of the flux, no flux.
    warm: Vec<f64>,
    pattern: Vec<f64>,
    none: Vec<f64>,
}

impl Carrier {
    /// For a contact line.
    pub fn new(operators: &Operators) -> Carrier {
        let longest = operators.heat.as_ref().map_or(0, |bodies| bodies.states[0].max(bodies.states[1]));
        let (states, cells) = (|| vec![0.0; longest], || vec![0.0; operators.count()]);
        Carrier { states: [states(), states()], warm: cells(), pattern: cells(), none: cells() }
    }
}

/// What a body of the lower rung knows.
struct Known {
    /// Since initialisation, J per m of depth and punch.
    account: Account,
    /// Mean temperature of the surface, K above the reference.
    surface: f64,
    /// Mean flux through the contact, W/m2.
    flux: f64,
}

impl Line {
    /// Takes the heat over that the lumped level has in the mean; `inputs` of the present.
    pub(super) fn take_heat_of_mean(&mut self, lower: &mut Lumped, carrier: &mut Carrier, inputs: &[f64; INPUTS]) {
        let point = lower.point(inputs);
        let scale = 1.0 / (self.operators.shared_depth * self.operators.scene.faces);
        let split = point.split;
        let surfaces = [(split.punch_temperature, split.punch), (split.strip_temperature, split.strip)];
        let accounts = lower.heat_accounts();
        let known = [0, 1].map(|side| {
            let Account { received, stored, ambient, far } = accounts[side];
            let account = Account {
                received: scale * received,
                stored: scale * stored,
                ambient: scale * ambient,
                far: scale * far,
            };
            Known { account, surface: surfaces[side].0, flux: surfaces[side].1 }
        });
        let dissipated = lower.state().dissipated * lower.operators().area / self.operators.shared_depth;
        carrier.pattern.fill(1.0);
        self.start_heat(dissipated, point.faded);
        for (side, known) in known.iter().enumerate() {
            self.gather(side, known, carrier, inputs);
        }
        self.finish_heat(inputs);
    }

    /// Takes the heat of a contact line over that has it on other cells.
    pub(super) fn take_heat_of_line(&mut self, lower: &Line, carrier: &mut Carrier, inputs: &[f64; INPUTS]) {
        let (Some(from), Some(bodies)) = (&lower.state.heat, &lower.heat) else { return };
        let (Some(own), Some(old)) = (&self.operators.heat, &lower.operators.heat) else { return };
        let alike = [0, 1].map(|side| own.rates[side] == old.rates[side] && own.states[side] == old.states[side]);
        let (coarse, fine) = (&lower.operators.cells, &self.operators.clone().cells);
        let width = 2.0 * coarse.half_width();
        let mean = |values: &[f64]| coarse.integral(values) / width;
        self.start_heat(from.dissipated, from.faded);
        for side in 0..2 {
            let Some(body) = &bodies.bodies[side] else { continue };
            let flux = mean(&from.flux[side]);
            if alike[side] {
                let Some(to) = &mut self.state.heat else { return };
                to.bodies[side].copy_from_slice(&from.bodies[side]);
                to.start[side] = from.start[side];
            } else {
                let known =
                    Known { account: from.account(side, body.as_ref()), surface: mean(&from.temperature[side]), flux };
                super::cover(coarse, &from.flux[side], fine, &mut carrier.pattern);
                match flux != 0.0 && carrier.pattern.iter().all(|q| q.is_finite()) {
                    true => {
                        // As far as it enters everywhere: a flux that changes sign and has hardly a mean would bring the missing
                        // heat by a great deal of either sign.
                        let lowest = carrier.pattern.iter().map(|q| q / flux).fold(f64::INFINITY, f64::min);
                        let share = (1.0 - lowest.min(0.0)).recip();
                        carrier.pattern.iter_mut().for_each(|q| *q = 1.0 + share * (*q / flux - 1.0));
                    }
                    false => carrier.pattern.fill(1.0),
                }
                self.gather(side, &known, carrier, inputs);
            }
            let Some(to) = &mut self.state.heat else { return };
            super::cover(coarse, &from.flux[side], fine, &mut to.flux[side]);
        }
        self.finish_heat(inputs);
    }

    fn start_heat(&mut self, dissipated: f64, faded: f64) {
        let Some(state) = &mut self.state.heat else { return };
        state.jump();
        state.reference = Place::none();
        (state.dissipated, state.faded) = (dissipated, faded);
        (state.cooling, state.lagging, state.last_step) = (Default::default(), [0.0; 2], 0.0);
    }

    /// Gives a body the heat and the surface temperature that the lower rung knows.
    fn gather(&mut self, side: usize, known: &Known, carrier: &mut Carrier, inputs: &[f64; INPUTS]) {
        let around = self.around(inputs)[side];
        let operators = self.operators.clone();
        let scene = &operators.scene;
        let (Some(heat), Some(state)) = (&mut self.heat, &mut self.state.heat) else { return };
        let Some(body) = &mut heat.bodies[side] else { return };
        let properties = [&scene.punch, &scene.strip][side];
        let rise = match properties.initial_temperature {
            initial if initial > 0.0 => initial - self.mean.state().reference,
            _ => 0.0,
        };
        let velocity = inputs[0] + scene.mean_radius * inputs[2];
        let width = 2.0 * operators.cells.half_width();
        let mean = |values: &[f64]| operators.cells.integral(values) / width;
        let through = properties.height * properties.height * properties.capacity() / properties.conductivity;
        let lasted = known.account.received / (known.flux * width);
        let time = if lasted > 0.0 && lasted.is_finite() { lasted } else { through };
        let time = time.clamp(TIMES.0 * through, TIMES.1 * through);

        let HeatState { bodies, flux, start, .. } = state;
        let own = &mut bodies[side];
        let Carrier { states, warm, pattern, none } = carrier;
        // The present flux acts at once, in its pattern.
        flux[side].iter_mut().zip(&*pattern).for_each(|(q, part)| *q = known.flux * part);
        body.uniform(rise, own);
        let initial = body.account(own).stored;
        body.prepare(time, [velocity; 2]);
        body.advance(own, &around, none, none);
        body.held(own, &around, &flux[side], velocity, warm);
        let missing = known.account.stored - (body.account(own).stored - initial);
        let colder = known.surface - mean(warm);
        let mut found = [[0.0; 2]; 2];
        for (k, time) in [time, SHORTER * time].into_iter().enumerate() {
            let added = &mut states[k][..own.len()];
            added.fill(0.0);
            body.prepare(time, [velocity; 2]);
            body.advance(added, &Surroundings::default(), pattern, pattern);
            body.held(added, &Surroundings::default(), none, velocity, warm);
            found[k] = [body.account(added).stored, mean(warm)];
        }
        let [[heat_long, warm_long], [heat_short, warm_short]] = found;
        let determinant = heat_long * warm_short - heat_short * warm_long;
        let told = determinant.abs() > TOLD_APART * (heat_long * warm_short).abs();
        let short = if told { (heat_long * colder - missing * warm_long) / determinant } else { 0.0 };
        // The heat is right in any case.
        let long = if heat_long == 0.0 { 0.0 } else { (missing - short * heat_short) / heat_long };
        for (amount, added) in [long, short].into_iter().zip(&*states) {
            own.iter_mut().zip(added).for_each(|(value, part)| *value += amount * part);
        }
        // From here on the account goes on where the lower rung's was.
        let (now, since) = (entries(body.account(own)), entries(known.account));
        start[side] = std::array::from_fn(|entry| now[entry] - since[entry]);
    }

    /// Temperatures and distortion of the cells by what was taken over.
    fn finish_heat(&mut self, inputs: &[f64; INPUTS]) {
        let around = self.around(inputs);
        let velocity = inputs[0] + self.operators.scene.mean_radius * inputs[2];
        let (Some(heat), Some(state)) = (&mut self.heat, &mut self.state.heat) else { return };
        state.distortion.fill(0.0);
        for side in 0..2 {
            let Some(body) = &heat.bodies[side] else { continue };
            let HeatState { bodies, flux, temperature, distortion, .. } = state;
            body.held(&bodies[side], &around[side], &flux[side], velocity, &mut temperature[side]);
            body.held_distortion(&bodies[side], &around[side], &flux[side], velocity, &mut heat.difference);
            distortion.iter_mut().zip(&heat.difference).for_each(|(sum, moved)| *sum += moved);
        }
        if let [true, false] | [false, true] = heat.bodies.each_ref().map(Option::is_some) {
            // An insulator shows the temperature of the surface it lies on.
            let [punch, strip] = &mut state.temperature;
            match heat.bodies[0].is_some() {
                true => strip.copy_from_slice(punch),
                false => punch.copy_from_slice(strip),
            }
        }
        self.tell_friction();
    }
}
