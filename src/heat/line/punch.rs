//! Heat in the punch, from the cells of the contact line to the cells, the cooled surface and the top.
//!
//! The punch is a rectangle of one material: width 2a along x, height h, contact at z = 0, cooled on its sides or, as a
//! closed ring, over its volume. With the heat transfer coefficient H of the cooled surface
//!
//! ```text
//! C dT/dt = k (T_xx + T_zz)
//! -k T_z = q (contact)     -k T_n = H (T - T_ambient) - cooling (sides)     -k T_z = H_top (T - T_ambient), or T = T_far (top)
//! ```
//!
//! Conduction in a rectangle separates, so no mesh is needed: across the width the modes are exact ([`across`]), and
//! each of them is a one-dimensional problem through the height whose impedance is known in closed form ([`depth`]). That
//! is projected (Galerkin) on its responses to real rates, a rational Krylov space; the result is symmetric, its states
//! are real and decay, and the steady response is exact because it is in the space. [`selection`] spends states where
//! the error against the exact impedance is largest. What is left of fast modes has its
//! exact steady effect ([`steady`]), with the delay that it takes on the whole ([`lag`]).
//!
//! The finite elements of `elastic::block::ThermalBlock` describe the same body; the tests hold one against the other.
//!
//! On an annulus x runs along the radius, the body is a ring, and the modes across are those of the radius ([`radial`]). The
//! mate is then a ring too ([`mate`]), cooled on its face instead of its sides.

mod across;
mod cylinder;
mod depth;
mod distortion;
mod lag;
pub mod mate;
mod radial;
mod selection;
mod steady;
#[cfg(test)]
mod tests;
mod waves;

use super::reduced::{ModeStates, Observation, Operators, PORTS, ReducedHeat};
use crate::elastic::Cells;
use crate::elastic::block::BlockError;
use crate::scene::{Geometry, Scene, ThermalBoundary};
use across::{Across, Sides, Wave};
use depth::{Depth, Points, Shape, Top};
use distortion::{Distortion, Field};
use nalgebra::DMatrix;
use selection::{Scale, Selection};
use steady::{steady_beyond, summed_modes};
use waves::Waves;

/// Most states. A steel punch in minutes needs fewer than 100 for an error of 1e-4; a heated layer that is thin against
/// the width, as in a brake pad during one stop, needs more, because more modes across have a history of their own.
pub const MAXIMUM_STATES: usize = 256;

/// Modes across whose steady fields distort the contact line as those of the whole body; those of shorter waves do so as
/// on a half-plane.
const DISTORTING_MODES: usize = 96;

/// The same for a probe of few cells: the corners of the block are felt by the longest waves.
const DISTORTING_BY_PROBE: usize = 32;

/// Modes across in the steady effects that have no closed sum: what follows falls like 1/m^3.
const SUMMED_MODES: usize = 1000;

/// The same for a probe, whose levels share the punch.
const SUMMED_BY_PROBE: usize = 256;

/// Order of the ports.
const COOLING: usize = 0;
const AMBIENT: usize = 1;
const FAR: usize = 2;

/// Reduces the punch of `scene` to states that follow its exact response over `duration` (s) to `tolerance`, relative
/// to the rise of temperature by a uniform flux over that time: the error is that of the mean square of the
/// temperature over the contact, by fluxes whose mean square and that of width/pi times their slope sum to 1. Faster
/// or more jagged fluxes are followed less well in time, never in their steady effect. At most [`MAXIMUM_STATES`]
/// states; where they do not suffice, the error that is left is larger, and stated.
///
/// None where the punch is an insulator.
///
/// # Errors
/// A block that is too flat or slender, or of a Poisson's ratio out of range, for its thermal distortion.
pub fn reduce(scene: &Scene, cells: &Cells, tolerance: f64, duration: f64) -> Result<Option<ReducedHeat>, BlockError> {
    reduce_with_mean(scene, cells, [tolerance; 2], duration)
}

/// The same with a tolerance of its own, the second, for the uniform mode, which alone carries the mean temperature of the contact.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_with_mean(
    scene: &Scene,
    cells: &Cells,
    tolerances: [f64; 2],
    duration: f64,
) -> Result<Option<ReducedHeat>, BlockError> {
    let body = &scene.punch;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let cooled_area =
        if body.cooled_area > 0.0 { body.cooled_area } else { 2.0 * body.height * scene.depth * scene.count };
    let across = Across {
        half_width: cells.half_width(),
        sides: match scene.geometry {
            Geometry::Line => Sides::Free,
            Geometry::Annular => Sides::Radial(scene.mean_radius),
            Geometry::Periodic => Sides::Closed,
        },
        cooled: cooled_area / (body.height * scene.depth * scene.count),
        transfer: body.convection,
        conductivity: body.conductivity,
    };
    let depth = Depth {
        height: body.height,
        conductivity: body.conductivity,
        capacity: body.capacity(),
        top: match body.far_thermal {
            ThermalBoundary::Held | ThermalBoundary::External => Top::Held,
            ThermalBoundary::Convecting => Top::Transfer(body.convection),
            ThermalBoundary::Insulated => Top::Transfer(0.0),
        },
        face: 0.0,
    };
    let cooled = Cooled { by: By::Sides, length: across.cooled * depth.height, transfer: across.transfer };
    let distortion = Distortion::new(scene, cells)?;
    project(across, depth, cooled, distortion, cells, &Wanted::new(scene, tolerances, duration)).map(Some)
}

/// How finely a body is projected.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Tolerances of every mode across and of the uniform one.
    tolerances: [f64; 2],
    /// s.
    duration: f64,
    /// See [`SUMMED_MODES`] and [`DISTORTING_MODES`].
    summed: usize,
    distorting: usize,
    /// By a probe.
    by_probe: bool,
}

impl Wanted {
    fn new(scene: &Scene, tolerances: [f64; 2], duration: f64) -> Wanted {
        let by_probe = scene.is_probe();
        let (summed, distorting) = match by_probe {
            true => (SUMMED_BY_PROBE, DISTORTING_BY_PROBE),
            false => (SUMMED_MODES, DISTORTING_MODES),
        };
        Wanted { tolerances, duration, summed, distorting, by_probe }
    }
}

/// Projects a body.
fn project(
    across: Across,
    depth: Depth,
    cooled: Cooled,
    mut distortion: Option<Distortion>,
    cells: &Cells,
    wanted: &Wanted,
) -> Result<ReducedHeat, BlockError> {
    let scale = Scale::new(&across, &depth, wanted.duration, wanted.tolerances);
    let steepest = scale.steepest(&depth);
    if let Some(distortion) = &mut distortion {
        distortion.resolve(steepest);
    }
    let extra = distortion.as_ref().map_or(Vec::new(), Distortion::positions);
    let points = Points::new(depth.height, steepest, &extra);
    let selection = Selection::new(&across, &depth, &points, &scale, MAXIMUM_STATES);
    let assembly = Assembly::new(across, depth, cooled, cells, (&points, &selection), *wanted);
    let mut operators = assembly.operators();
    if let Some(distortion) = &distortion {
        assembly.distort(distortion, &mut operators)?;
    }
    assembly.delay(&mut operators);
    let body = ReducedHeat::new(operators);
    Ok(if wanted.by_probe { body.for_few_steps() } else { body })
}

/// The surface beside the contact that the air cools.
#[derive(Clone, Copy, Debug)]
struct Cooled {
    by: By,
    /// Area per depth, m.
    length: f64,
    /// Constant heat transfer coefficient, W/(m2 K).
    transfer: f64,
}

/// Where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    /// The sides of the body, as the modes across have it.
    Sides,
    /// The face of the contact, as evenly over it as the contact is passing by.
    Face,
}

/// A mode across with its states, and the shape that acts without delay.
struct Mode {
    wave: Wave,
    states: Vec<Shape>,
    immediate: Option<Shape>,
}

/// From the selected modes to the operators.
struct Assembly<'a> {
    across: Across,
    depth: Depth,
    cooled: Cooled,
    cells: &'a Cells,
    modes: Vec<Mode>,
    /// All modes that some sum needs, those with states first.
    waves: Waves,
    wanted: Wanted,
    errors: [f64; 2],
}

/// Effects of the steady field of one mode: at the contact and at the cooled surface, by unit flux or port.
#[derive(Default)]
struct SteadyMode {
    /// Z(0) by port, K per unit of the port.
    contact: [f64; PORTS],
    /// What the cooled surface sees of Z (its integral over the height at the sides, Z(0) on the face) by port.
    seen: [f64; PORTS],
    /// The same by unit flux.
    seen_by_flux: f64,
}

impl<'a> Assembly<'a> {
    fn new(
        across: Across,
        depth: Depth,
        cooled: Cooled,
        cells: &'a Cells,
        (points, selection): (&Points, &Selection),
        wanted: Wanted,
    ) -> Self {
        let modes: Vec<Mode> = (selection.modes.iter().filter(|mode| mode.basis.count() > 0))
            .map(|mode| {
                let mut states = mode.basis.shapes(points);
                let immediate = if mode.fastest_is_steady { states.pop() } else { None };
                Mode { wave: mode.wave, states, immediate }
            })
            .collect();
        let count = summed_modes(&across, &depth, modes.len()).max(wanted.summed);
        let waves = Waves::new(&across, cells, count);
        let errors = [selection.error, selection.mean_error];
        Assembly { across, depth, cooled, cells, modes, waves, wanted, errors }
    }

    /// What the cooled surface has of a mode across, m^(1/2) per height at the sides, m^(1/2) on the face.
    fn exposure(&self, wave: &Wave) -> f64 {
        match self.cooled.by {
            By::Sides => wave.exposure,
            By::Face => wave.integral * self.cooled.length / (2.0 * self.across.half_width),
        }
    }

    /// What it has of a shape through the height.
    fn seen(&self, shape: &Shape) -> f64 {
        match self.cooled.by {
            By::Sides => shape.integral,
            By::Face => shape.contact,
        }
    }

    fn capacity(&self) -> f64 {
        self.depth.capacity
    }

    fn held(&self) -> bool {
        self.depth.top == Top::Held
    }

    fn top_transfer(&self) -> f64 {
        match self.depth.top {
            Top::Held => 0.0,
            Top::Transfer(transfer) => transfer,
        }
    }

    /// Input of a shape by port.
    fn input(&self, wave: &Wave, shape: &Shape) -> [f64; PORTS] {
        let cooling = self.exposure(wave) * self.seen(shape);
        let ambient = self.cooled.transfer * cooling + self.top_transfer() * wave.integral * shape.top;
        [cooling, ambient, self.through_held_top(wave, shape)]
    }

    /// Heat flow of a state through a held top, in W/m over its norm.
    fn through_held_top(&self, wave: &Wave, shape: &Shape) -> f64 {
        if !self.held() {
            return 0.0;
        }
        // What the height conducts and the face does not lose.
        let by_face = match self.cooled.by {
            By::Sides => 0.0,
            By::Face => self.cooled.transfer * self.exposure(wave) * shape.contact,
        };
        shape.rate_through_height * self.uniform(wave, shape) - by_face
    }

    /// State of a shape when the body is at 1 K everywhere, J/(m K) over its norm.
    fn uniform(&self, wave: &Wave, shape: &Shape) -> f64 {
        self.capacity() * wave.integral * shape.integral
    }

    /// Steady effects of a mode; None where it cannot rest.
    fn steady(&self, wave: &Wave) -> Option<SteadyMode> {
        let (depth, transfer, decay) = (&self.depth, self.cooled.transfer, wave.decay);
        if !depth.has_steady_state(decay) {
            return None;
        }
        let exposure = self.exposure(wave);
        // A mode without decay is not exposed, or its sources leave through the top.
        let (seen_by_flux, seen_by_source) = match self.cooled.by {
            By::Sides if exposure == 0.0 => (depth.steady_integral(decay), 0.0),
            By::Sides => (depth.steady_integral(decay), depth.sourced_integral(decay)),
            By::Face => (depth.steady_impedance(decay), depth.steady_impedance(decay)),
        };
        let mut steady = SteadyMode { contact: [0.0; PORTS], seen: [0.0; PORTS], seen_by_flux };
        steady.contact[COOLING] = exposure * seen_by_flux;
        steady.seen[COOLING] = exposure * seen_by_source;
        let everywhere = match self.cooled.by {
            By::Sides => wave.integral * depth.height,
            By::Face => wave.integral,
        };
        if self.held() {
            steady.contact[AMBIENT] = transfer * steady.contact[COOLING];
            steady.seen[AMBIENT] = transfer * steady.seen[COOLING];
            steady.contact[FAR] = wave.integral - steady.contact[AMBIENT];
            steady.seen[FAR] = everywhere - steady.seen[AMBIENT];
        } else {
            // All that surrounds the body is the air: it takes its temperature.
            steady.contact[AMBIENT] = wave.integral;
            steady.seen[AMBIENT] = everywhere;
        }
        Some(steady)
    }

    fn operators(&self) -> Operators {
        let cells = self.cells.count();
        let count = self.modes.iter().map(|mode| mode.states.len()).sum();
        let width = 2.0 * self.across.half_width;
        let mut operators = Operators {
            widths: self.across.weights(self.cells),
            modes: Vec::with_capacity(self.modes.len()),
            rate: Vec::with_capacity(count),
            contact: Vec::with_capacity(count),
            distortion: Vec::new(),
            input: [(); PORTS].map(|()| Vec::with_capacity(count)),
            temperature_by_flux: steady_beyond(&self.across, &self.depth, self.cells, &self.waves, self.modes.len()),
            temperature_by_port: [(); PORTS].map(|()| vec![0.0; cells]),
            distortion_by_flux: DMatrix::zeros(cells, cells),
            distortion_by_port: [(); PORTS].map(|()| Vec::new()),
            cooled: Observation::none(count, cells),
            ambient_flow: Observation::none(count, cells),
            far_flow: Observation::none(count, cells),
            passed: Default::default(),
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
            if let Some(shape) = &mode.immediate {
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
                operators.uniform.push(self.uniform(&mode.wave, shape));
                for (port, input) in self.input(&mode.wave, shape).into_iter().enumerate() {
                    operators.input[port].push(input);
                }
            }
            let states = first..first + mode.states.len();
            first = states.end;
            operators.modes.push(ModeStates { states, integrals, means });
        }
        self.ports(&mut operators);
        self.flows(&mut operators);
        operators
    }

    /// What a mode does without delay: all that it does at rest less what its states do then; without rest, what the
    /// immediate shape does.
    fn remainder(&self, wave: &Wave, mode: Option<&Mode>) -> SteadyMode {
        let states = mode.map_or(&[][..], |mode| &mode.states[..]);
        let immediate = mode.and_then(|mode| mode.immediate.as_ref());
        let (mut left, sign, counted) = match self.steady(wave) {
            Some(steady) => (steady, -1.0, states),
            None => (SteadyMode::default(), 1.0, immediate.map_or(&[][..], std::slice::from_ref)),
        };
        for shape in counted {
            let input = self.input(wave, shape);
            for port in 0..PORTS {
                left.contact[port] += sign * shape.contact * input[port] / shape.rate;
                left.seen[port] += sign * self.seen(shape) * input[port] / shape.rate;
            }
            left.seen_by_flux += sign * self.seen(shape) * shape.contact / shape.rate;
        }
        left
    }

    /// Remainders of the cells' temperatures by the ports, and the temperature of the cooled surface.
    fn ports(&self, operators: &mut Operators) {
        let length = operators.cooled_length;
        // A surface that has no area is not looked at.
        let per_length = if length > 0.0 { 1.0 / length } else { 0.0 };
        let mut first = 0;
        for m in 0..self.wanted.summed.max(self.modes.len()) {
            let mode = self.modes.get(m);
            let wave = self.waves.wave(m);
            let exposure = self.exposure(wave);
            for shape in mode.map_or(&[][..], |mode| &mode.states[..]) {
                operators.cooled.states[first] = per_length * exposure * self.seen(shape);
                first += 1;
            }
            if exposure == 0.0 && wave.integral == 0.0 {
                continue;
            }
            let left = self.remainder(wave, mode);
            for (i, integral) in self.waves.integrals(m).iter().enumerate() {
                for port in 0..PORTS {
                    operators.temperature_by_port[port][i] += left.contact[port] * integral / operators.widths[i];
                }
                operators.cooled.fluxes[i] += per_length * exposure * left.seen_by_flux * integral;
            }
            for port in 0..PORTS {
                operators.cooled.ports[port] += per_length * exposure * left.seen[port];
            }
        }
        if self.across.sides != Sides::Closed && self.cooled.by == By::Sides {
            // The sides' heat close to them, in the modes left out: a sum of 1/m^2.
            let width = 2.0 * self.across.half_width;
            let count = 0.5 * self.wanted.summed.max(self.modes.len()) as f64;
            let square = self.across.cooled.powi(2) * 2.0 / width;
            let sum = (0.5 * width / std::f64::consts::PI).powi(2) / count;
            let beyond = square * self.depth.height / (length * self.depth.conductivity) * sum;
            operators.cooled.ports[COOLING] += beyond;
            if self.held() {
                operators.cooled.ports[AMBIENT] += self.across.transfer * beyond;
                operators.cooled.ports[FAR] -= self.across.transfer * beyond;
            }
        }
    }

    /// Flows and stored heat. Observed flows and the balance of heat over-determine them; the balance is kept exactly: the
    /// stored heat is what the flows will carry away, and what no state holds back leaves at once.
    fn flows(&self, operators: &mut Operators) {
        let transfer = self.cooled.transfer;
        let (losing, open) = (transfer > 0.0, self.depth.top != Top::Transfer(0.0));
        let mut k = 0;
        for mode in &self.modes {
            for shape in &mode.states {
                let uniform = operators.uniform[k];
                let ambient = transfer * self.exposure(&mode.wave) * self.seen(shape);
                let far =
                    self.through_held_top(&mode.wave, shape) + self.top_transfer() * mode.wave.integral * shape.top;
                operators.ambient_flow.states[k] = ambient;
                operators.far_flow.states[k] = far;
                operators.stored[k] = if losing || open { (ambient + far) / shape.rate } else { uniform };
                k += 1;
            }
        }
        // Heat that enters per unit of every input, less what the states take.
        let mut fluxes = operators.widths.clone();
        for mode in &operators.modes {
            let taken: f64 = mode.states.clone().map(|k| operators.stored[k] * operators.contact[k]).sum();
            for (flux, integral) in fluxes.iter_mut().zip(&mode.integrals) {
                *flux -= taken * integral;
            }
        }
        let mut ports = [operators.cooled_length, 0.0, 0.0];
        for (port, input) in ports.iter_mut().zip(&operators.input) {
            *port -= operators.stored.iter().zip(input).map(|(stored, input)| stored * input).sum::<f64>();
        }
        let per_kelvin = transfer * operators.cooled_length;
        let (ambient, far) = (&mut operators.ambient_flow, &mut operators.far_flow);
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
        if self.held() {
            let projected: f64 = operators.uniform.iter().map(|uniform| uniform * uniform).sum();
            operators.stored_by_far = operators.heat_capacity - projected;
        }
    }

    /// Distortion by the states, and what fast and short-waved fields do without delay.
    fn distort(&self, distortion: &Distortion, operators: &mut Operators) -> Result<(), BlockError> {
        let positions = distortion.positions();
        let (depth, cells) = (&self.depth, self.cells);
        let mut fields = Vec::new();
        // States first, in their order; then the remainders with what drives them.
        for (m, mode) in self.modes.iter().enumerate() {
            fields.extend(mode.states.iter().map(|shape| Field::of(m, shape)));
        }
        let states = fields.len();
        let mut by_flux: Vec<(usize, f64)> = Vec::new();
        let mut by_port: Vec<(usize, usize, f64)> = Vec::new();
        let first = self.modes.iter().scan(0, |next, mode| Some(std::mem::replace(next, *next + mode.states.len())));
        let first: Vec<usize> = first.collect();
        for m in 0..self.wanted.distorting.max(self.modes.len()) {
            let mode = self.modes.get(m);
            let wave = self.waves.wave(m);
            match mode {
                Some(Mode { immediate: Some(shape), .. }) => {
                    by_flux.push((fields.len(), shape.contact / shape.rate));
                    fields.push(Field::of(m, shape));
                }
                Some(_) => {}
                None => {
                    by_flux.push((fields.len(), 1.0));
                    let profile = positions.iter().map(|&z| depth.response(wave.decay, z).0).collect();
                    fields.push(Field { mode: m, integral: depth.steady_integral(wave.decay), profile });
                }
            }
            let exposure = self.exposure(wave);
            if exposure == 0.0 && wave.integral == 0.0 || !depth.has_steady_state(wave.decay) {
                continue;
            }
            // The air around the body and its held top together make it uniform.
            by_port.push((fields.len(), COOLING, exposure));
            if self.held() {
                by_port.push((fields.len(), AMBIENT, self.cooled.transfer * exposure));
                by_port.push((fields.len(), FAR, -self.cooled.transfer * exposure));
            }
            fields.push(match self.cooled.by {
                // Nothing to add, but no source in a body that nothing leaves either.
                _ if exposure == 0.0 => Field { mode: m, integral: 0.0, profile: vec![0.0; positions.len()] },
                By::Sides => Field {
                    mode: m,
                    integral: depth.sourced_integral(wave.decay),
                    profile: positions.iter().map(|&z| depth.sourced(wave.decay, z)).collect(),
                },
                By::Face => Field {
                    mode: m,
                    integral: depth.steady_integral(wave.decay),
                    profile: positions.iter().map(|&z| depth.response(wave.decay, z).0).collect(),
                },
            });
            for (i, shape) in mode.map_or(&[][..], |mode| &mode.states[..]).iter().enumerate() {
                for (port, input) in self.input(wave, shape).into_iter().enumerate() {
                    by_port.push((first[m] + i, port, -input / shape.rate));
                }
            }
        }
        let (displacements, uniform) = distortion.of(&self.across, cells, &self.waves, &fields)?;
        operators.distortion = displacements.columns(0, states).iter().copied().collect();
        for &(field, weight) in &by_flux {
            for (j, integral) in self.waves.integrals(fields[field].mode).iter().enumerate() {
                let mut column = operators.distortion_by_flux.column_mut(j);
                column.axpy(weight * integral, &displacements.column(field), 1.0);
            }
        }
        // u = -alpha (1 + nu) T/xi for the steady temperature T = q/(k xi) of a short wave.
        let longest = self.wanted.distorting.max(self.modes.len());
        let mut short = self.waves.sum(longest..self.wanted.summed.max(longest), |_, wave| {
            distortion.by_short_wave() / (depth.conductivity * wave.decay * wave.decay)
        });
        for (mut row, width) in short.row_iter_mut().zip(&operators.widths) {
            row /= *width;
        }
        operators.distortion_by_flux += short;
        operators.distortion_by_port = [(); PORTS].map(|()| vec![0.0; cells.count()]);
        for &(field, port, weight) in &by_port {
            for (sum, value) in operators.distortion_by_port[port].iter_mut().zip(displacements.column(field).iter()) {
                *sum += weight * value;
            }
        }
        let port = if self.held() { FAR } else { AMBIENT };
        if self.held() || self.cooled.transfer > 0.0 || self.top_transfer() > 0.0 {
            for (sum, value) in operators.distortion_by_port[port].iter_mut().zip(uniform) {
                *sum += value;
            }
        }
        Ok(())
    }
}
