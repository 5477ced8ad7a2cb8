//! The uniform temperature of a body that loses heat by its sides: bands of its modes with one state each.
//!
//! It has parts in all even modes across the width, and in each in all shapes through the height that have heat, as the modes separate:
//! those of the first mode, with a rate r_k of their own. Under an insulated top that is the uniform one alone.
//!
//! ```text
//! T = sum b_m u_k X_m(x) Z_k(z) exp(-l t),   b_m = integral X_m dx,   u_k = C integral Z_k dz,   l = kd xi_m^2 + r_k
//! ```
//!
//! The responses to fluxes into the contact do not contain it where a mode decays within the height. Under an insulated top a mode with
//! much of the heat has the uniform temperature as a trial function. All other products form bands of neighbours in the rate with the sum
//! of their products as the one trial function (Galerkin). With the parts w of the heat a band decays with `L = sum w l/sum w`. By
//! Jensen's inequality and Taylor's theorem the error of the mean temperature is within
//!
//! ```text
//! 0 <= sum w exp(-l t) - sum w exp(-L t) <= t^2/2 exp(-l_1 t) sum w (l - L)^2 <= 2/e^2 sum w (l - L)^2/l_1^2
//! ```
//!
//! with the slowest rate l_1, largest at t = 2/l_1: every band has its own time.
//!
//! Theory: docs/theory.md, section 4.6.

use super::AMBIENT;
use super::assembly::Assembly;
use crate::line::reduced::{ModeStates, ReducedOperators};
use crate::shares::PUNCH_BAND;

/// Least part of the heat of a uniform temperature that counts.
const LEAST_HEAT: f64 = 1e-6;

/// A product of a mode and a shape in the uniform temperature.
pub(super) struct Product {
    pub mode: usize,
    pub shape: usize,
    /// Heat over that of the body.
    pub heat: f64,
    /// Decay rate, 1/s.
    pub rate: f64,
}

/// Heat of some products in ascending order of the rates, and its spread.
#[derive(Clone, Copy, Default)]
pub(super) struct Spread {
    slowest: f64,
    /// Sums of the heats times the powers 0, 1 and 2 of the rates.
    moments: [f64; 3],
}

impl Spread {
    /// With one more heat at a rate.
    pub(crate) fn and(mut self, heat: f64, rate: f64) -> Spread {
        if self.moments[0] == 0.0 {
            self.slowest = rate;
        }
        for (power, moment) in (0..).zip(&mut self.moments) {
            *moment += heat * rate.powi(power);
        }
        self
    }

    /// Whether one state suffices for `tolerance`.
    pub(crate) fn is_one(&self, tolerance: f64) -> bool {
        let [heat, first, second] = self.moments;
        let spread = second - first * first / heat.max(f64::MIN_POSITIVE);
        2.0 * spread <= PUNCH_BAND * tolerance * (std::f64::consts::E * self.slowest).powi(2)
    }
}

/// The fewest bands of these products; the last one is also that of all further ones.
pub(super) fn bands(products: impl Iterator<Item = Product>, tolerance: f64) -> Vec<Vec<Product>> {
    let mut products: Vec<Product> = products.filter(|product| product.heat > LEAST_HEAT).collect();
    products.sort_by(|one, other| one.rate.total_cmp(&other.rate));
    let (mut bands, mut spread) = (vec![Vec::new()], Spread::default());
    for product in products {
        spread = spread.and(product.heat, product.rate);
        if !spread.is_one(tolerance) {
            spread = Spread::default().and(product.heat, product.rate);
            bands.push(Vec::new());
        }
        bands.last_mut().expect("there is a first one").push(product);
    }
    bands
}

/// What a uniform temperature of 1 K has in a band.
struct Part {
    /// Heat, J/m, and its flows to the air and through the top, W/m.
    heat: f64,
    flows: [f64; 2],
    /// Temperatures of the cells and of both faces, and distortion of the cells.
    temperature: Vec<f64>,
    faces: [f64; 2],
    distortion: Vec<f64>,
}

impl Assembly<'_> {
    /// Gives every band its state, the last one with all that is left. `distortion` is that of the bands but the last. Called when all
    /// but the first-order dynamics is complete; a prescribed temperature has its own remainder.
    pub(super) fn store_bands(&self, distortion: Vec<Vec<f64>>, operators: &mut ReducedOperators) {
        let Some((_, bands)) = self.bands.split_last() else { return };
        let mut distortion = distortion.into_iter();
        for band in bands {
            let part = self.part(band, distortion.next().unwrap_or_default(), operators);
            self.store(part, operators);
        }
        self.store(self.rest(operators), operators);
    }

    fn part(&self, band: &[Product], distortion: Vec<f64>, operators: &ReducedOperators) -> Part {
        let (mut heat, mut exposed, mut flow, mut top) = (0.0, 0.0, 0.0, 0.0);
        let mut temperature = vec![0.0; self.cells.count()];
        for product in band {
            let (wave, (shape, state)) = (self.waves.wave(product.mode), self.uniform_shape(product.shape));
            let state = wave.integral * state;
            heat += state * state;
            exposed += self.exposure(wave) * state * shape.integral;
            flow += self.top_transfer() * wave.integral * state * shape.top;
            top += wave.integral * state * self.top(shape);
            let integrals = self.waves.integrals(product.mode);
            for ((sum, integral), width) in temperature.iter_mut().zip(integrals).zip(&operators.widths) {
                *sum += state * shape.contact * integral / width;
            }
        }
        let per_width = if self.depth.driven_top { 0.5 / self.across.half_width } else { 0.0 };
        Part {
            heat,
            flows: [self.cooled.transfer * exposed, flow],
            temperature,
            faces: [exposed / operators.cooled_length, per_width * top],
            distortion,
        }
    }

    /// The heat and the loss at first that the body has beyond its states, `C - stored u` and `H L - flow u` of the uniform states u.
    fn rest(&self, operators: &ReducedOperators) -> Part {
        let beyond = |whole: f64, weights: &[f64]| {
            whole - weights.iter().zip(&operators.uniform).map(|(weight, state)| weight * state).sum::<f64>()
        };
        let top = self.top_transfer() * 2.0 * self.across.half_width;
        Part {
            heat: beyond(operators.heat_capacity, &operators.stored),
            flows: [
                beyond(self.cooled.transfer * operators.cooled_length, &operators.ambient_flow.states),
                beyond(top, &operators.far_flow.states).max(0.0),
            ],
            temperature: operators.temperature_by_port[AMBIENT].clone(),
            faces: [&operators.cooled, &operators.far_face].map(|face| face.ports[AMBIENT]),
            distortion: operators.distortion_by_port[AMBIENT].clone(),
        }
    }

    /// Gives a part a state, which replaces its direct feedthrough from the air.
    fn store(&self, part: Part, operators: &mut ReducedOperators) {
        if part.heat < LEAST_HEAT * operators.heat_capacity || part.flows[0] <= 0.0 {
            return;
        }
        let (norm, rate) = (part.heat.sqrt(), (part.flows[0] + part.flows[1]) / part.heat);
        let state = operators.rate.len();
        operators.rate.push(rate);
        operators.contact.push(1.0);
        operators.uniform.push(norm);
        operators.stored.push(norm);
        for (port, input) in operators.input.iter_mut().enumerate() {
            input.push(if port == AMBIENT { rate * norm } else { 0.0 });
        }
        let direct = &mut operators.temperature_by_port[AMBIENT];
        direct.iter_mut().zip(&part.temperature).for_each(|(direct, part)| *direct -= part);
        let direct = &mut operators.distortion_by_port[AMBIENT];
        direct.iter_mut().zip(&part.distortion).for_each(|(direct, part)| *direct -= part);
        operators.modes.push(ModeStates {
            states: state..state + 1,
            integrals: vec![0.0; self.cells.count()],
            means: part.temperature.iter().map(|temperature| temperature / norm).collect(),
            by_part: vec![0.0; operators.part_areas.len()],
        });
        operators.distortion.extend(part.distortion.iter().map(|distortion| distortion / norm));
        let faces =
            [&mut operators.cooled, &mut operators.far_face, &mut operators.ambient_flow, &mut operators.far_flow];
        for (observed, part) in faces.into_iter().zip(part.faces.into_iter().chain(part.flows)) {
            observed.states.push(part / norm);
            observed.ports[AMBIENT] -= part;
        }
    }
}
