//! Thermal steady state of unidirectional sliding.
//!
//! Over a step much longer than the slowest time constant the bodies respond to a flux with their steady temperatures and
//! distortion, so the equations of a stage of the coupled step, without wear, are those of the steady state: the heat partition
//! is one linear system ([`ActivePartition`]), and the distortion a thermal compliance. Wear determines the pressure where the
//! punch wears; otherwise the pressure is that of the contact with this compliance. Temperature-dependent tables, radiation and
//! forced convection require an iteration over the temperatures of the cells.
//!
//! Theory: docs/theory.md, section 9.4.

use super::partition::{ActivePartition, Heat, steady_bodies};
use super::{Accuracy, HeatFlows, HotState, SteadyHeat, StrokeHeat};
use crate::states::{Contact, Sliding, SteadyKind, SteadyState, direction, of_law, per_distance};
use crate::{SteadyError, groove, punch_run_in};
use conduction::line::{
    BESIDE, Boundary, FACES, FAR, FaceInfluence, FrozenState, SingleStep, Stage, SurfaceInfluence, Surroundings,
};
use contact::friction::{FrictionLaw, OperatingPoint};
use contact::wear::law::WearLaw;
use contact::wear::line::CellRate;
use contact::{ContactSolver, Normal};
use elasticity::discretization::relative_radii;
use elasticity::{Cells, Compliance};
use model::instability::CriticalSpeed;
use model::line::heat::bodies::cooled_part;
use model::line::hottest::Hottest;
use model::line::profile::initial_gap;
use model::lumped::air::Air;
use nalgebra::{DMatrix, DVector};
use numerics::acceleration::Anderson;
use numerics::factorization;
use numerics::maximum::maximum;
use scene::{Body, Geometry, Path, Scene, ThermalBoundary};

/// Iterations after which the state counts as not found.
const MOST_ITERATIONS: usize = 200;

/// Differences stored for the Anderson acceleration.
const ACCELERATION_DEPTH: usize = 12;

/// Result of one evaluation of the equations. Pairs: punch, strip; temperatures in K above the ambient.
struct Found {
    pressure: Vec<f64>,
    temperature: [Vec<f64>; 2],
    flux: [Vec<f64>; 2],
    /// Thermal distortion: displacement of both surfaces, m into the bodies.
    moved: DVector<f64>,
    states: [Vec<f64>; 2],
    surroundings: [Surroundings; 2],
}

struct Problem<'a> {
    contact: Contact<'a>,
    kind: SteadyKind,
    bodies: Heat,
    /// Surface influence matrices of the bodies.
    influence: [Option<SurfaceInfluence>; 2],
    /// Cooled lengths beside the contact, m.
    cooled_length: [f64; 2],
    partition: ActivePartition,
    half_resistance: f64,
    friction: FrictionLaw,
    laws: [WearLaw; 2],
    gap: Vec<f64>,
    /// Sliding velocity of the cells over that at the mean radius.
    radii: Vec<f64>,
}

pub(super) fn solve(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    cold: &SteadyState,
    sliding: &Sliding,
) -> Result<HotState, SteadyError> {
    let (mut bodies, cooled_length) = steady_bodies(scene, cells, cold.strokes[0].velocity)?;
    let influence = bodies.each_mut().map(|body| body.as_mut().map(|body| body.influence(Stage::End).clone()));
    let partition = ActivePartition::new(influence.each_ref().map(Option::as_ref), cells.count(), scene.conductance);
    let law = |body: &Body| WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade);
    let mut problem = Problem {
        contact: Contact::new(scene, cells, compliances, sliding),
        kind: cold.kind,
        bodies,
        influence,
        cooled_length,
        partition,
        half_resistance: if scene.conductance > 0.0 { 0.5 / scene.conductance } else { 0.0 },
        friction: FrictionLaw::new(scene),
        laws: [law(&scene.punch), law(&scene.strip)],
        gap: initial_gap(scene, cells),
        radii: relative_radii(scene, cells),
    };
    let count = cells.count();
    // Unknowns of the iteration: local contact temperatures of the cells and temperatures of the cooled faces, K above the
    // ambient; the pressure over its mean, for the mean of the friction coefficient.
    let mean = problem.contact.load / problem.contact.weights.iter().sum::<f64>();
    let size = 2 * count + 2 * FACES;
    let mut iterate = vec![0.0; size];
    iterate.iter_mut().zip(&cold.strokes[0].pressure).for_each(|(value, p)| *value = p / mean);
    let weights: Vec<f64> = (0..size).map(|k| if k < count { 100.0 } else { 1.0 }).collect();
    let mut anderson = Anderson::<ACCELERATION_DEPTH>::new(size);
    let mut closed = vec![true; count];
    let mut change = f64::INFINITY;
    for iterations in 1..=MOST_ITERATIONS {
        let found = problem.pass(&iterate, &closed)?;
        let mut answer: Vec<f64> = found.pressure.iter().map(|p| p / mean).collect();
        answer.extend((0..count).map(|i| 0.5 * (found.temperature[0][i] + found.temperature[1][i])));
        answer.extend(problem.cooled(&found, &iterate[2 * count..]));
        let touching: Vec<bool> = found.pressure.iter().map(|p| *p > 0.0).collect();
        let step: Vec<f64> = answer.iter().zip(&iterate).map(|(new, old)| new - old).collect();
        let largest = step.iter().zip(&weights).map(|(change, weight)| (change * weight).abs());
        change = largest.fold(0.0, maximum);
        if !change.is_finite() {
            return Err(SteadyError::Other(format!(
                "no steady state with heat found: temperatures grew beyond all numbers in {iterations} iterations"
            )));
        }
        // Change of the temperature, K, at which the iteration has converged.
        if touching == closed && change <= 1e-8 * (1.0 + peak(&found)) {
            let accuracy = Accuracy { iterations, shape: 0.0, heat: change / (1.0 + peak(&found)), speed_ratio: 0.0 };
            return Ok(problem.assembled(found, accuracy));
        }
        if touching != closed {
            closed = touching;
            anderson.clear();
        } else {
            anderson.begin(&[&iterate]);
            anderson.accelerate([&mut answer], |i| weights[i]);
        }
        iterate = answer;
    }
    Err(SteadyError::Other(format!(
        "no steady state with heat found in {MOST_ITERATIONS} iterations: the last one changed the temperature by {change:.1e} K"
    )))
}

fn peak(found: &Found) -> f64 {
    found.temperature.iter().flatten().fold(0.0, |peak: f64, t| peak.max(t.abs()))
}

impl Problem<'_> {
    fn scene(&self) -> &Scene {
        self.contact.scene
    }

    fn velocity(&self) -> f64 {
        self.contact.strokes[0].velocity
    }

    /// Evaluates the equations once.
    fn pass(&mut self, iterate: &[f64], closed: &[bool]) -> Result<Found, SteadyError> {
        let count = self.contact.cells.count();
        let (relative, rest) = iterate.split_at(count);
        let (local_temperature, cooled) = rest.split_at(count);
        let (ambient, velocity) = (self.scene().ambient_temperature, self.velocity());
        let kinetic_coefficient: Vec<f64> =
            local_temperature.iter().map(|t| self.friction.kinetic_coefficient(t + ambient)).collect();
        let stribeck = self.friction.stribeck(OperatingPoint { velocity, pressure: self.scene().nominal_pressure() });
        let sign: f64 = self.friction.sign(velocity);
        let weights = &self.contact.weights;
        let share = |i: usize| weights[i] * self.radii[i] * relative[i].max(0.0);
        let carried: f64 = (0..count).map(share).sum();
        let average = (0..count).map(|i| share(i) * kinetic_coefficient[i]).sum::<f64>() / carried;
        self.contact.strokes[0].friction = sign * average * stribeck;
        self.contact.strokes[0].rates =
            std::array::from_fn(|body| self.rate(body, local_temperature, &kinetic_coefficient));

        let surroundings = self.surroundings(cooled);
        let zero = vec![0.0; count];
        let mut base = [zero.clone(), zero.clone()];
        let mut moved = [zero.clone(), zero.clone()];
        for side in 0..2 {
            if let Some(body) = &self.bodies[side] {
                let still = vec![0.0; body.states()];
                let (base, moved) = (&mut base[side], &mut moved[side]);
                body.free_response(&still, &surroundings[side], Stage::End, &zero, base, moved);
                let held = [&self.scene().punch, &self.scene().strip][side].far_is_prescribed();
                let Boundary { cooling, far, .. } = surroundings[side].end;
                let mut by_face = FaceInfluence::new(count);
                for (face, flux) in [(BESIDE, cooling), (FAR, if held { 0.0 } else { far })] {
                    if flux != 0.0 {
                        body.face_influence(Stage::End, face, &mut by_face, &mut body.workspace());
                        base.iter_mut().zip(&by_face.temperature).for_each(|(t, rise)| *t += flux * rise);
                        moved.iter_mut().zip(&by_face.distortion).for_each(|(moved, own)| *moved += flux * own);
                    }
                }
            }
        }
        let influence = self.influence.each_ref().map(Option::as_ref);
        let conducts = influence.map(|influence| influence.is_some());
        self.partition.set_active_set(influence, closed);
        let kinetic_coefficient = kinetic_coefficient.iter().zip(&self.radii);
        let slip: Vec<f64> = kinetic_coefficient
            .map(|(kinetic_coefficient, radius)| kinetic_coefficient * stribeck * sign * velocity * radius)
            .collect();
        let thermal_compliance =
            &self.partition.distortion * DMatrix::from_diagonal(&DVector::from_column_slice(&slip));
        // Heat exchange between the surfaces without friction.
        let mut exchanged = zero.clone();
        self.partition.punch_flux(influence, [&base[0], &base[1]], &zero, &mut exchanged);
        let mut undeformed = DVector::from_iterator(count, (0..count).map(|i| moved[0][i] + moved[1][i]));
        if let [Some(punch), Some(strip)] = influence {
            let exchanged = DVector::from_column_slice(&exchanged);
            undeformed += &punch.distortion * &exchanged - &strip.distortion * &exchanged;
        }
        let pressure = self.pressure(&undeformed, &thermal_compliance)?;
        let friction: Vec<f64> = (0..count).map(|i| if closed[i] { slip[i] * pressure[i] } else { 0.0 }).collect();
        let mut flux = [zero.clone(), zero.clone()];
        self.partition.punch_flux(influence, [&base[0], &base[1]], &friction, &mut flux[0]);
        if conducts[1] {
            flux[1] = (0..count).map(|i| friction[i] - flux[0][i]).collect();
        }
        let mut temperature = base;
        for side in 0..2 {
            if let Some(influence) = influence[side] {
                let rise = &influence.temperature * DVector::from_column_slice(&flux[side]);
                temperature[side].iter_mut().zip(rise.iter()).for_each(|(t, rise)| *t += rise);
            }
        }
        // The surface temperature of an insulator follows from the interface law.
        if let [true, false] | [false, true] = conducts {
            let insulator = usize::from(!conducts[1]);
            for i in 0..count {
                temperature[insulator][i] = temperature[1 - insulator][i] + friction[i] * self.half_resistance;
            }
        }
        let moved = undeformed + thermal_compliance * DVector::from_column_slice(&pressure);
        let states = std::array::from_fn(|side| match &self.bodies[side] {
            Some(body) => {
                let mut state = vec![0.0; body.states()];
                body.step(&mut state, &surroundings[side], &flux[side], &flux[side]);
                state
            }
            None => Vec::new(),
        });
        Ok(Found { pressure, temperature, flux, moved, states, surroundings })
    }

    fn annular(&self) -> bool {
        self.scene().geometry == Geometry::Annular
    }

    /// Wear depth rate of a body on the cells at their temperatures: for the mating ring of an annulus the mean round the circle.
    fn rate(&self, body: usize, local_temperature: &[f64], kinetic_coefficient: &[f64]) -> CellRate {
        let (scene, law, speed) = (self.scene(), &self.laws[body], self.velocity().abs());
        let factor = scene.wear_acceleration * if self.annular() && body == 1 { scene.coverage() } else { 1.0 };
        let at = |((t, kinetic_coefficient), radius): ((&f64, &f64), &f64)| -> f64 {
            factor * law.coefficient(speed * radius, *kinetic_coefficient, t + scene.ambient_temperature)
        };
        of_law(law, local_temperature.iter().zip(kinetic_coefficient).zip(&self.radii).map(at))
    }

    /// Pressure on the gap displaced by `undeformed` (m) by heat without friction, with the thermal compliance `thermal_compliance` (m/Pa).
    fn pressure(&self, undeformed: &DVector<f64>, thermal_compliance: &DMatrix<f64>) -> Result<Vec<f64>, SteadyError> {
        let contact = &self.contact;
        let stroke = &contact.strokes[0];
        let (tilt, load) = (contact.tilt(stroke), contact.load);
        let gap = || -> Vec<f64> { self.gap.iter().zip(undeformed.iter()).map(|(g, moved)| g + moved).collect() };
        Ok(match self.kind {
            SteadyKind::RunIn => {
                let mut rate = stroke.rates[0].clone();
                if self.annular() {
                    // The worn depth of the mating ring is also fixed per radius.
                    rate.terms.extend(stroke.rates[1].terms.iter().cloned());
                }
                punch_run_in(contact.cells, &contact.weights, &rate, load, tilt)?.pressure
            }
            SteadyKind::Groove => {
                let rate = per_distance(&stroke.rates[1], stroke.velocity);
                let (compliance, direction) =
                    (contact.compliance(stroke) + thermal_compliance, direction(stroke.velocity));
                groove(contact.cells, compliance, &gap(), rate, direction, Normal::Load(load), tilt)?.pressure
            }
            SteadyKind::Elastic => {
                let compliance = contact.compliance(stroke) + thermal_compliance;
                let mut solver = ContactSolver::with_weights(contact.cells, &contact.weights, compliance)?;
                solver.solve(&gap(), Normal::Load(load), tilt)?.pressure
            }
        })
    }

    /// Flux into a cooled face of `t` (K above the ambient) beyond its convection, and its decrease with t.
    fn cooling(&self, side: usize, face: usize, t: f64) -> [f64; 2] {
        let scene = self.scene();
        let body = if side == 0 { &scene.punch } else { &scene.strip };
        let beside = if side == 0 { 1.0 } else { cooled_part(scene) };
        let air = Air::of(body, body.convection, beside, scene.far_areas()[side])[face];
        // Neighbours have the ambient temperature.
        air.law(scene.ambient_temperature, t, 0.0, self.velocity().abs().powf(0.8), 0.0)
    }

    /// Ambient, far-face temperatures and cooling; `cooled` are the temperatures of the cooled faces, punch first.
    fn surroundings(&self, cooled: &[f64]) -> [Surroundings; 2] {
        let scene = self.scene();
        std::array::from_fn(|side| {
            let body = if side == 0 { &scene.punch } else { &scene.strip };
            let held = body.far_thermal == ThermalBoundary::Held && body.far_temperature > 0.0;
            let far = if held { body.far_temperature - scene.ambient_temperature } else { 0.0 };
            let by_air = std::array::from_fn(|face| self.cooling(side, face, cooled[FACES * side + face])[0]);
            let around = Boundary { far, ..Boundary::default() };
            Surroundings::constant(around.with_fluxes(by_air, body.far_is_prescribed()))
        })
    }

    /// Temperatures of the cooled faces, punch first, in equilibrium with the cooling fluxes that they cause. `used` are those of
    /// the last evaluation.
    fn cooled(&self, found: &Found, used: &[f64]) -> [f64; 2 * FACES] {
        let zero = vec![0.0; found.pressure.len()];
        let mut temperatures = [0.0; 2 * FACES];
        for (side, body) in self.bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            let mut work = body.workspace();
            let held = [&self.scene().punch, &self.scene().strip][side].far_is_prescribed();
            let used = &used[FACES * side..FACES * (side + 1)];
            let slope: [f64; FACES] = std::array::from_fn(|face| self.cooling(side, face, used[face])[1]);
            let (state, around) = (&found.states[side], &found.surroundings[side]);
            let found_at = body.cooled_temperature(
                &FrozenState { state, surroundings: around, flux: &found.flux[side], velocity: self.velocity() },
                &mut work,
            );
            // One Newton step for t = found_at + R (cooling(t) - cooling(used)): (1 + R slope) (t - used) = found_at - used. R:
            // response to unit fluxes, at fixed fluxes of the contact.
            let mut matrix = nalgebra::Matrix2::identity();
            for face in (0..FACES).filter(|&face| slope[face] > 0.0) {
                let mut flux = [0.0; FACES];
                flux[face] = 1.0;
                let unit = Surroundings::constant(Boundary::default().with_fluxes(flux, held));
                let mut state = vec![0.0; body.states()];
                body.step(&mut state, &unit, &zero, &zero);
                let resistance = body.cooled_temperature(
                    &FrozenState { state: &state, surroundings: &unit, flux: &zero, velocity: self.velocity() },
                    &mut work,
                );
                for (other, resistance) in resistance.into_iter().enumerate() {
                    matrix[(other, face)] += resistance * slope[face];
                }
            }
            let residual =
                nalgebra::Vector2::from_fn(|face, _| if slope[face] > 0.0 { found_at[face] - used[face] } else { 0.0 });
            for face in (0..FACES).filter(|&face| slope[face] == 0.0) {
                // A temperature on which nothing depends is not iterated.
                (0..FACES).for_each(|other| matrix[(face, other)] = f64::from(u8::from(face == other)));
            }
            let change = factorization::solve(&matrix, &residual).unwrap_or_default();
            for face in (0..FACES).filter(|&face| slope[face] > 0.0) {
                temperatures[FACES * side + face] = used[face] + change[face];
            }
        }
        temperatures
    }

    fn assembled(&self, found: Found, mut accuracy: Accuracy) -> HotState {
        let contact = &self.contact;
        let (scene, stroke) = (contact.scene, &contact.strokes[0]);
        let count = contact.cells.count();
        let fresh_groove = scene.path == Path::Straight && self.laws[1].active();
        let groove = if fresh_groove { contact.groove_depth(stroke, &found.pressure) } else { vec![0.0; count] };
        let pressure = DVector::from_column_slice(&found.pressure);
        let shape: Vec<f64> = match self.kind {
            SteadyKind::RunIn => {
                let displaced = contact.compliance(stroke) * &pressure + &found.moved;
                let mut shape: Vec<f64> = (0..count).map(|i| -groove[i] - displaced[i]).collect();
                let least = shape.iter().copied().fold(f64::INFINITY, f64::min);
                shape.iter_mut().for_each(|depth| *depth -= least);
                shape
            }
            SteadyKind::Groove | SteadyKind::Elastic => self.gap.clone(),
        };
        // Approach and tilt of the bodies with their thermal distortion.
        let level: Vec<f64> = groove.iter().zip(found.moved.iter()).map(|(g, moved)| g + moved).collect();
        let moved = contact.state(self.kind, vec![found.pressure.clone()], shape, level);
        let state = SteadyState { groove, ..moved };
        let absolute = |values: &Vec<f64>| values.iter().map(|t| t + scene.ambient_temperature).collect::<Vec<f64>>();
        let temperature = found.temperature.each_ref().map(absolute);
        let all = scene.depth * scene.count * scene.faces;
        let sum = |values: &[f64]| values.iter().zip(&contact.weights).map(|(value, area)| value * area).sum::<f64>();
        let integral = |values: &[f64]| all * sum(values);
        let area: f64 = contact.weights.iter().sum();
        let mean = 0.5 * temperature.iter().map(|values| sum(values) / area).sum::<f64>();
        let mut flows =
            HeatFlows { punch: integral(&found.flux[0]), strip: integral(&found.flux[1]), ..HeatFlows::default() };
        flows.friction = flows.punch + flows.strip;
        for side in 0..2 {
            let Some(body) = &self.bodies[side] else { continue };
            let [air, far] = body.flows(&found.states[side], &found.surroundings[side], &found.flux[side]);
            *[&mut flows.punch_top, &mut flows.strip_base][side] = all * far;
            flows.ambient += all * (air - self.cooled_length[side] * found.surroundings[side].end.cooling);
        }
        let body_temperature = std::array::from_fn(|side| {
            let body = self.bodies[side].as_ref();
            scene.ambient_temperature + body.map_or(0.0, |body| body.mean_temperature(&found.states[side]))
        });
        let critical = CriticalSpeed::new(scene).modelled(stroke.friction.abs());
        if critical > 0.0 {
            accuracy.speed_ratio = self.velocity().abs() / critical;
        }
        let hottest = Hottest::new(contact.cells, scene.geometry == Geometry::Periodic);
        let highest = hottest.of(&temperature);
        HotState {
            state,
            heat: SteadyHeat {
                range: [temperature.clone(), temperature.clone()],
                strokes: vec![StrokeHeat {
                    temperature,
                    flux: found.flux,
                    pressure_at: [found.pressure.clone(), found.pressure],
                }],
                contact_temperature: [mean; 3],
                highest,
                body_temperature,
                flows,
                accuracy,
            },
        }
    }
}
