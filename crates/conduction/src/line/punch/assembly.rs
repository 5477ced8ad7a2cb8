//! Assembly of the operators of a body from its selected modes.
//!
//! Theory: docs/theory.md, section 4.6.

use super::across::{Across, Sides, Wave};
use super::bands::{Product, bands};
use super::depth::Depth;
use super::galerkin::{Shape, lag};
use super::shift_selection::Selection;
use super::steady::{SteadyBeyond, summed_modes};
use super::waves::Waves;
use super::{AMBIENT, By, COOLING, Cooled, FAR, SUMMED_MODES};
use crate::line::contact_parts::PARTS;
use crate::line::reduced::{ModeStates, Observation, PORTS, ReducedOperators};
use crate::trial_functions::Points;
use elasticity::Cells;
use nalgebra::DMatrix;
use scene::FarBoundary;

/// A transverse mode with its states, and the fastest shape through the height, which is quasi-static.
pub(super) struct Mode {
    pub wave: Wave,
    pub states: Vec<Shape>,
    pub feedthrough: Option<Shape>,
    /// Its uniform temperature is not one of the states: see [`super::bands`].
    pub banded: bool,
}

/// Assembly of the operators from the selected modes.
pub(super) struct Assembly<'a> {
    pub across: Across,
    pub depth: Depth,
    pub cooled: Cooled,
    pub cells: &'a Cells,
    pub modes: Vec<Mode>,
    /// All modes that enter some sum, those with states first.
    pub waves: Waves,
    /// Parts of the cells, and all modes on them, where cells may be in contact in part.
    pub divided: Option<(Cells, Waves)>,
    /// Uniform temperature in modes that do not have it as a state.
    pub bands: Vec<Vec<Product>>,
    errors: [f64; 2],
}

/// Steady response of one mode at the contact, the cooled surface and the top, per unit flux or port.
#[derive(Default)]
struct SteadyMode {
    /// Z(0) by port, K per unit of the port.
    contact: [f64; PORTS],
    /// Value of Z at the cooled surface (its integral over the height at the sides, Z(0) on the face) by port.
    seen: [f64; PORTS],
    /// Value of Z at the cooled surface by unit flux.
    seen_by_flux: f64,
    /// Z at a top without prescribed temperature, by port and by unit flux.
    top: [f64; PORTS],
    top_by_flux: f64,
}

impl<'a> Assembly<'a> {
    pub(crate) fn new(
        across: Across,
        depth: Depth,
        cooled: Cooled,
        (cells, divides): (&'a Cells, bool),
        (points, shift_selection): (&Points, &Selection),
    ) -> Self {
        let modes: Vec<Mode> = (shift_selection.modes.iter().filter(|mode| mode.basis.count() > 0))
            .map(|mode| {
                let mut states = mode.basis.shapes(points);
                let feedthrough = if mode.fastest_is_steady { states.pop() } else { None };
                let banded = depth.top != FarBoundary::Held && (states.is_empty() || !mode.basis.has_uniform());
                Mode { wave: mode.wave, states, feedthrough, banded }
            })
            .collect();
        let summed = summed_modes(&across, &depth, modes.len());
        let waves = Waves::new(&across, cells, summed.max(SUMMED_MODES));
        let divided = divides.then(|| {
            let parts = cells.divided(PARTS);
            let waves = waves.over(&parts, summed);
            (parts, waves)
        });
        let mut assembly = Assembly {
            across,
            depth,
            cooled,
            cells,
            modes,
            waves,
            divided,
            bands: Vec::new(),
            errors: [shift_selection.error, shift_selection.mean_error],
        };
        if !assembly.top_is_prescribed() {
            assembly.bands = bands(assembly.products(), shift_selection.tolerance);
        }
        assembly
    }

    /// Shape number k through the height of the first mode, whose space has the uniform temperature, and its state at 1 K.
    pub(crate) fn uniform_shape(&self, k: usize) -> (&Shape, f64) {
        let first = &self.modes[0];
        let shape = first.states.get(k).or(first.feedthrough.as_ref()).expect("one of the shapes");
        (shape, self.capacity() * shape.integral)
    }

    /// Products of which the uniform temperature consists, but for those of modes that have it as a state.
    fn products(&self) -> impl Iterator<Item = Product> {
        let whole = 2.0 * self.across.half_width * self.capacity() * self.depth.height;
        let shapes =
            self.modes.first().map_or(0, |first| first.states.len() + usize::from(first.feedthrough.is_some()));
        let banded = (0..self.waves.count()).filter(|&m| self.modes.get(m).is_none_or(|mode| mode.banded));
        banded.flat_map(move |mode| {
            let wave = self.waves.wave(mode);
            (0..shapes).map(move |k| {
                let (shape, state) = self.uniform_shape(k);
                let rate = self.depth.diffusivity() * wave.decay * wave.decay + shape.rate_through_height;
                Product { mode, shape: k, heat: (wave.integral * state).powi(2) / whole, rate }
            })
        })
    }

    /// Projection of the cooled surface on a transverse mode, m^(1/2) per height at the sides, m^(1/2) on the face.
    pub(crate) fn exposure(&self, wave: &Wave) -> f64 {
        match self.cooled.by {
            By::Sides => wave.exposure,
            By::Face => wave.integral * self.cooled.length / (2.0 * self.across.half_width),
        }
    }

    /// Input weight of a flux into the far face, per area of that face, m^(1/2); 0 where none is prescribed.
    pub(crate) fn top_exposure(&self, wave: &Wave) -> f64 {
        if self.depth.driven_top { self.cooled.top_area * wave.integral } else { 0.0 }
    }

    /// Value of a shape through the height at the cooled surface.
    fn seen(&self, shape: &Shape) -> f64 {
        match self.cooled.by {
            By::Sides => shape.integral,
            By::Face => shape.contact,
        }
    }

    fn capacity(&self) -> f64 {
        self.depth.capacity
    }

    pub(crate) fn top_is_prescribed(&self) -> bool {
        self.depth.top == FarBoundary::Held
    }

    pub(crate) fn top_transfer(&self) -> f64 {
        self.depth.top.transfer()
    }

    /// Input weights of a shape of a mode by port. The air enters a mode without a uniform state of its own through its band.
    pub(crate) fn input(&self, mode: &Mode, shape: &Shape) -> [f64; PORTS] {
        let wave = &mode.wave;
        let cooling = self.exposure(wave) * self.seen(shape);
        let ambient = match mode.banded {
            true => 0.0,
            false => self.cooled.transfer * cooling + self.top_transfer() * wave.integral * shape.top,
        };
        let far = match self.top_is_prescribed() {
            true => self.through_held_top(wave, shape),
            false => self.top_exposure(wave) * self.top(shape),
        };
        [cooling, ambient, far]
    }

    /// Temperature of a top without prescribed temperature by a shape: its value there but for the lag, [`lag`].
    pub(crate) fn top(&self, shape: &Shape) -> f64 {
        shape.top * lag(&self.depth, shape)
    }

    /// Heat flow of a state through a top of prescribed temperature, W/m over the norm of the state; by reciprocity its input per kelvin
    /// of that top. See [`lag`].
    fn through_held_top(&self, wave: &Wave, shape: &Shape) -> f64 {
        if !self.top_is_prescribed() {
            return 0.0;
        }
        // Conducted through the height and not lost at the face.
        let by_face = match self.cooled.by {
            By::Sides => 0.0,
            By::Face => self.cooled.transfer * self.exposure(wave) * shape.contact,
        };
        let rate = shape.rate_through_height;
        rate * self.heat_content(wave, shape) * lag(&self.depth, shape) - by_face
    }

    /// Heat content of a state, J/m over its norm.
    fn heat_content(&self, wave: &Wave, shape: &Shape) -> f64 {
        self.capacity() * wave.integral * shape.integral
    }

    /// State of a shape when the body is at 1 K everywhere, J/(m K) over its norm: under a prescribed temperature in equilibrium with top
    /// and air of 1 K.
    fn uniform(&self, mode: &Mode, shape: &Shape) -> f64 {
        match self.top_is_prescribed() {
            true => {
                let [_, ambient, far] = self.input(mode, shape);
                (ambient + far) / shape.rate
            }
            false if mode.banded => 0.0,
            false => self.heat_content(&mode.wave, shape),
        }
    }

    /// Steady response of a mode; None without a steady state.
    fn steady(&self, wave: &Wave) -> Option<SteadyMode> {
        let (depth, transfer, decay) = (&self.depth, self.cooled.transfer, wave.decay);
        if !depth.has_steady_state(decay) {
            return None;
        }
        let exposure = self.exposure(wave);
        // A mode without decay has no exposure, or its heat leaves through the top.
        let (seen_by_flux, seen_by_source) = match self.cooled.by {
            By::Sides if exposure == 0.0 => (depth.steady_integral(decay), 0.0),
            By::Sides => (depth.steady_integral(decay), depth.sourced_integral(decay)),
            By::Face => (depth.steady_impedance(decay), depth.steady_impedance(decay)),
        };
        let mut steady = SteadyMode { seen_by_flux, ..SteadyMode::default() };
        steady.contact[COOLING] = exposure * seen_by_flux;
        steady.seen[COOLING] = exposure * seen_by_source;
        let everywhere = match self.cooled.by {
            By::Sides => wave.integral * depth.height,
            By::Face => wave.integral,
        };
        if self.top_is_prescribed() {
            steady.contact[AMBIENT] = transfer * steady.contact[COOLING];
            steady.seen[AMBIENT] = transfer * steady.seen[COOLING];
            steady.contact[FAR] = wave.integral - steady.contact[AMBIENT];
            steady.seen[FAR] = everywhere - steady.seen[AMBIENT];
        } else {
            // The air is the only boundary: the body takes its temperature.
            steady.contact[AMBIENT] = wave.integral;
            steady.seen[AMBIENT] = everywhere;
            if !depth.driven_top {
                return Some(steady);
            }
            steady.top[AMBIENT] = wave.integral;
            let from_top = depth.driven_from_top(decay);
            let (at_contact, entering) = (from_top.at(0.0).0, self.top_exposure(wave));
            let seen = match self.cooled.by {
                By::Sides => from_top.integral(),
                By::Face => at_contact,
            };
            steady.contact[FAR] = entering * at_contact;
            steady.seen[FAR] = entering * seen;
            steady.top[FAR] = entering * from_top.at(depth.height).0;
            // By reciprocity.
            steady.top[COOLING] = exposure * seen;
            steady.top_by_flux = at_contact;
        }
        Some(steady)
    }

    pub(crate) fn operators(&self) -> ReducedOperators {
        let cells = self.cells.count();
        let count = self.modes.iter().map(|mode| mode.states.len()).sum();
        let width = 2.0 * self.across.half_width;
        let widths = self.across.weights(self.cells);
        let beyond = SteadyBeyond::new(&self.across, &self.depth, self.modes.len());
        let span = beyond.over(self.cells, &self.waves);
        let mut temperature_by_flux = beyond.between((&span, 0..cells), (&span, 0..cells));
        for (mut row, width) in temperature_by_flux.row_iter_mut().zip(&widths) {
            row.scale_mut(1.0 / width);
        }
        let mut operators = ReducedOperators {
            widths,
            part_areas: self.divided.as_ref().map_or(Vec::new(), |(parts, _)| self.across.weights(parts)),
            remainder: Vec::new(),
            modes: Vec::with_capacity(self.modes.len()),
            rate: Vec::with_capacity(count),
            contact: Vec::with_capacity(count),
            distortion: Vec::new(),
            input: [(); PORTS].map(|()| Vec::with_capacity(count)),
            temperature_by_flux,
            temperature_by_port: [(); PORTS].map(|()| vec![0.0; cells]),
            distortion_by_flux: DMatrix::zeros(cells, cells),
            distortion_by_port: [(); PORTS].map(|()| Vec::new()),
            cooled: Observation::none(count, cells),
            far_face: Observation::none(count, cells),
            ambient_flow: Observation::none(count, cells),
            far_flow: Observation::none(count, cells),
            passed: Default::default(),
            held: self.top_is_prescribed(),
            cooled_length: self.cooled.length,
            own: count,
            stored: vec![0.0; count],
            stored_by_far: 0.0,
            uniform: Vec::with_capacity(count),
            heat_capacity: self.capacity() * width * self.depth.height,
            error: self.errors[0],
            mean_error: self.errors[1],
        };
        let mut first = 0;
        for (m, mode) in self.modes.iter().enumerate() {
            let integrals = self.waves.integrals(m).to_vec();
            let means: Vec<f64> = integrals.iter().zip(&operators.widths).map(|(f, width)| f / width).collect();
            if let Some(shape) = &mode.feedthrough {
                let gain = shape.contact * shape.contact / shape.rate;
                for (j, integral) in integrals.iter().enumerate() {
                    for (i, mean) in means.iter().enumerate() {
                        operators.temperature_by_flux[(i, j)] += gain * mean * integral;
                    }
                }
            }
            for shape in &mode.states {
                operators.rate.push(shape.rate);
                operators.contact.push(shape.contact);
                operators.uniform.push(self.uniform(mode, shape));
                for (port, input) in self.input(mode, shape).into_iter().enumerate() {
                    operators.input[port].push(input);
                }
            }
            let states = first..first + mode.states.len();
            first = states.end;
            let by_part = self.divided.as_ref().map_or(Vec::new(), |(_, waves)| waves.integrals(m).to_vec());
            operators.modes.push(ModeStates { states, integrals, means, by_part });
        }
        self.ports(&mut operators);
        self.flows(&mut operators);
        operators
    }

    /// Static correction of a mode: its steady response less that of its states; without a steady state, the steady response
    /// of the quasi-static shape.
    fn static_correction(&self, wave: &Wave, mode: Option<&Mode>) -> SteadyMode {
        let states = mode.map_or(&[][..], |mode| &mode.states[..]);
        let feedthrough = mode.and_then(|mode| mode.feedthrough.as_ref());
        let (mut left, sign, counted) = match self.steady(wave) {
            Some(steady) => (steady, -1.0, states),
            None => (SteadyMode::default(), 1.0, feedthrough.map_or(&[][..], std::slice::from_ref)),
        };
        for shape in counted {
            let input = mode.map_or([0.0; PORTS], |mode| self.input(mode, shape));
            for port in 0..PORTS {
                left.contact[port] += sign * shape.contact * input[port] / shape.rate;
                left.seen[port] += sign * self.seen(shape) * input[port] / shape.rate;
                left.top[port] += sign * self.top(shape) * input[port] / shape.rate;
            }
            left.seen_by_flux += sign * self.seen(shape) * shape.contact / shape.rate;
            left.top_by_flux += sign * self.top(shape) * shape.contact / shape.rate;
        }
        if sign > 0.0 {
            // What the lag leaves out of the top's temperature by its own flux.
            for shape in states.iter().filter(|shape| shape.rate > 0.0) {
                let left_out = 1.0 - lag(&self.depth, shape).powi(2);
                left.top[FAR] += self.top_exposure(wave) * shape.top * shape.top * left_out / shape.rate;
            }
        }
        left
    }

    /// Static corrections of the cells' temperatures by the ports, and the temperatures of the cooled faces.
    fn ports(&self, operators: &mut ReducedOperators) {
        let length = operators.cooled_length;
        // A surface without area has no observation.
        let per_length = if length > 0.0 { 1.0 / length } else { 0.0 };
        let per_width = if self.depth.driven_top { 0.5 / self.across.half_width } else { 0.0 };
        let mut first = 0;
        for m in 0..SUMMED_MODES.max(self.modes.len()) {
            let mode = self.modes.get(m);
            let wave = self.waves.wave(m);
            let exposure = self.exposure(wave);
            for shape in mode.map_or(&[][..], |mode| &mode.states[..]) {
                operators.cooled.states[first] = per_length * exposure * self.seen(shape);
                operators.far_face.states[first] = per_width * wave.integral * self.top(shape);
                first += 1;
            }
            if exposure == 0.0 && wave.integral == 0.0 {
                continue;
            }
            let left = self.static_correction(wave, mode);
            for (i, integral) in self.waves.integrals(m).iter().enumerate() {
                for port in 0..PORTS {
                    operators.temperature_by_port[port][i] += left.contact[port] * integral / operators.widths[i];
                }
                operators.cooled.fluxes[i] += per_length * exposure * left.seen_by_flux * integral;
                operators.far_face.fluxes[i] += per_width * wave.integral * left.top_by_flux * integral;
            }
            for port in 0..PORTS {
                operators.cooled.ports[port] += per_length * exposure * left.seen[port];
                operators.far_face.ports[port] += per_width * wave.integral * left.top[port];
            }
        }
        if self.across.sides != Sides::Closed && self.cooled.by == By::Sides {
            // Temperature of the sides by their own cooling in the truncated modes: the tail of a sum of 1/m^2.
            let width = 2.0 * self.across.half_width;
            let count = 0.5 * SUMMED_MODES.max(self.modes.len()) as f64;
            let square = self.across.cooled.powi(2) * 2.0 / width;
            let sum = (0.5 * width / std::f64::consts::PI).powi(2) / count;
            let beyond = square * self.depth.height / (length * self.depth.conductivity) * sum;
            operators.cooled.ports[COOLING] += beyond;
            if self.top_is_prescribed() {
                operators.cooled.ports[AMBIENT] += self.across.transfer * beyond;
                operators.cooled.ports[FAR] -= self.across.transfer * beyond;
            }
        }
    }

    /// Flows and stored heat. Observed flows and the heat balance over-determine them; the balance is kept exact: the stored
    /// heat is the time integral of the flows that it feeds, and the part of an input that no state stores leaves as a
    /// direct feedthrough.
    fn flows(&self, operators: &mut ReducedOperators) {
        let transfer = self.cooled.transfer;
        let (losing, open) = (transfer > 0.0, self.depth.top != FarBoundary::Insulated);
        let mut k = 0;
        for mode in &self.modes {
            for shape in &mode.states {
                let content = operators.uniform[k];
                let ambient = transfer * self.exposure(&mode.wave) * self.seen(shape);
                let far =
                    self.through_held_top(&mode.wave, shape) + self.top_transfer() * mode.wave.integral * shape.top;
                operators.ambient_flow.states[k] = ambient;
                operators.far_flow.states[k] = far;
                operators.stored[k] = if losing || open { (ambient + far) / shape.rate } else { content };
                k += 1;
            }
        }
        // Heat input per unit of every input, less the part stored in the states.
        let (mut fluxes, mut by_part) = (operators.widths.clone(), operators.part_areas.clone());
        for mode in &operators.modes {
            let taken: f64 = mode.states.clone().map(|k| operators.stored[k] * operators.contact[k]).sum();
            by_part.iter_mut().zip(&mode.by_part).for_each(|(flux, integral)| *flux -= taken * integral);
            for (flux, integral) in fluxes.iter_mut().zip(&mode.integrals) {
                *flux -= taken * integral;
            }
        }
        let top_length = if self.depth.driven_top { self.cooled.top_area * 2.0 * self.across.half_width } else { 0.0 };
        let mut ports = [operators.cooled_length, 0.0, top_length];
        for (port, input) in ports.iter_mut().zip(&operators.input) {
            *port -= operators.stored.iter().zip(input).map(|(stored, input)| stored * input).sum::<f64>();
        }
        let per_kelvin = transfer * operators.cooled_length;
        let (ambient, far) = (&mut operators.ambient_flow, &mut operators.far_flow);
        // Heat of short waves leaves beside the contact rather than through the body.
        let nothing = vec![0.0; by_part.len()];
        (ambient.by_part, far.by_part) = if losing { (by_part, nothing) } else { (nothing, by_part) };
        if losing && open {
            ambient.fluxes = operators.cooled.fluxes.iter().map(|cooled| per_kelvin * cooled).collect();
            ambient.ports = operators.cooled.ports.map(|cooled| per_kelvin * cooled);
            ambient.ports[AMBIENT] -= per_kelvin;
            far.fluxes = fluxes.iter().zip(&ambient.fluxes).map(|(all, ambient)| all - ambient).collect();
            for port in 0..PORTS {
                far.ports[port] = ports[port] - ambient.ports[port];
            }
        } else if losing {
            (ambient.fluxes, ambient.ports) = (fluxes, ports);
        } else if open {
            (far.fluxes, far.ports) = (fluxes, ports);
        }
        // The flux into the far face passes it inwards.
        far.ports[FAR] -= top_length;
        if self.top_is_prescribed() {
            operators.stored_by_far = operators.heat_capacity
                - operators
                    .stored
                    .iter()
                    .zip(&operators.uniform)
                    .map(|(stored, uniform)| stored * uniform)
                    .sum::<f64>();
        }
    }
}
