//! Operators of the lumped level, built once from the scene and shared by all its states.
//!
//! Theory: docs/theory.md, sections 3.7, 4.2, 4.3, 8.1.

use super::air::{Air, BESIDE, FACES, FAR};
use super::conditions::Conditions;
use crate::Inputs;
use crate::events::load_on_contact;
use crate::growth::{PerturbationGrowth, grows_otherwise};
use crate::tolerance::ToleranceBudget;
use conduction::flash::Flash;
use conduction::lateral::Lateral;
use conduction::moving_source::{self, MovingSource};
use conduction::properties::Properties;
use conduction::reduced::{MAX_STATES, Observation, PORTS, Port, ReducedBody};
use conduction::slab::{CoolingPort, Slab};
use contact::friction::{FrictionLaw, OperatingPoint};
use contact::wear::law::WearLaw;
use elasticity::kinds::{mean_compliance, mean_expansion};
use elasticity::tangential::tangential_stiffness;
use numerics::scalar::Scalar;
use scene::{Body, Geometry, Path, Scene, ThermalBoundary};

/// Heat and wear operators of a body at the lumped level.
#[derive(Clone, PartialEq, Debug)]
pub struct BodyOperators {
    /// Reduced conduction model; `None` for an insulator.
    pub heat: Option<ReducedBody>,
    /// Conductivity and specific heat over the mean temperature; `None`: constants.
    pub properties: Option<Properties>,
    /// Heat capacity of the whole height with the constants of `heat`, J/(m2 K) of reference area.
    pub heat_capacity: f64,
    /// Mean of the temperature field that the states have of 1 K throughout.
    pub uniform_mean: f64,
    /// Heat leaves by the constant heat transfer within the states.
    pub loses_to_air: bool,
    /// Heat that leaves by it over a step, per gain of every state and per time integral of every input.
    pub lost_over_step: ([f64; MAX_STATES], [f64; PORTS]),
    /// Heat leaves through the far face, or by the constant heat transfer.
    pub passes_heat: bool,
    /// Fraction of the contact flux that enters per reference area.
    pub coverage: f64,
    /// Reference area of the conduction problem per face, m2.
    pub area: f64,
    /// Cooling beyond the constant heat transfer of the states, beside the contact and at the far face.
    pub air: [Air; FACES],
    /// That heat transfer coefficient, W/(m2 K), and the free surface beside the contact over the reference area.
    pub convection_within: f64,
    cooled_part: f64,
    /// The temperature of the cooled surface equals that of the contact surface.
    pub cooled_is_contact: bool,
    /// Thermal boundary condition of the face opposite to the contact.
    pub far: ThermalBoundary,
    /// Wear law.
    pub wear: WearLaw,
    /// Mean of (r/r_m)^(1 + a) over the contact: 1 for line geometry.
    pub wear_factor: f64,
    /// Wear rate below which errors are neglected, m/s: a millionth of the nominal one.
    pub least_wear: f64,
    /// Mean outward displacement per kelvin of mean temperature, m/K.
    pub expansion: f64,
}

impl BodyOperators {
    /// Sets what depends on wear coefficient, convection and heat path of `body`.
    fn tune(&mut self, scene: &Scene, body: &Body) {
        self.wear = WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade);
        self.least_wear = 1e-6
            * self.wear.rate(
                scene.nominal_load / scene.contact_area(),
                scene.nominal_velocity,
                scene.friction_coefficient,
                scene.ambient_temperature,
            );
        self.air = Air::of(body, self.convection_within, self.cooled_part, self.area * scene.faces);
    }

    /// Sets what the account of heat asks of the reduced body.
    fn observe_heat(&mut self) {
        let Some(heat) = &self.heat else { return };
        let any = |observation: &Observation| {
            observation.states[..heat.count].iter().any(|weight| *weight != 0.0)
                || observation.direct[Port::Contact as usize] != 0.0
        };
        let flows = heat.ambient_flow.direct[Port::Ambient as usize] != 0.0;
        self.loses_to_air = flows && any(&heat.ambient_flow);
        self.passes_heat = self.loses_to_air || heat.rate[0] > 0.0;
        let (by_state, by_port) = &mut self.lost_over_step;
        *by_port = heat.ambient_flow.direct;
        for k in (0..heat.count).filter(|&k| heat.rate[k] > 0.0) {
            by_state[k] = heat.ambient_flow.states[k] / heat.rate[k];
            by_port.iter_mut().zip(&heat.input).for_each(|(lost, input)| *lost += by_state[k] * input[k]);
        }
        let products = heat.mean_temperature.states.iter().zip(&heat.stored.states);
        self.uniform_mean = products.map(|(mean, stored)| mean * stored).sum();
    }

    /// Mean temperature of the body in this state, K above the reference, its face opposite to the contact at `far` where that is
    /// prescribed. The states hold all of it but the stationary field of that face beyond them, as in the stored heat.
    pub(crate) fn mean_rise(&self, heat: &ReducedBody, states: &[f64; MAX_STATES], far: f64) -> f64 {
        let beyond = match self.far {
            ThermalBoundary::Held | ThermalBoundary::External => {
                heat.mean_temperature.direct[Port::Base as usize] * far
            }
            ThermalBoundary::Convecting | ThermalBoundary::Insulated => 0.0,
        };
        heat.mean_temperature.of_states(states, heat.count) + beyond
    }

    /// Mean outward displacement (m) of the contact surface by the temperature of the body in this state; `far` as in
    /// [`BodyOperators::mean_rise`].
    pub(crate) fn expansion_at(&self, states: &[f64; MAX_STATES], far: f64) -> f64 {
        self.heat.as_ref().map_or(0.0, |heat| self.expansion * self.mean_rise(heat, states, far))
    }
}

/// Bounds of the common form of a step: within them a step reaches no limit and cannot fail by wear.
#[derive(Clone, PartialEq, Debug)]
pub struct CommonBounds {
    /// Worn depths of punch and strip (m) below which no limit is reached.
    pub depth: [f64; 2],
    /// Worn depths (m) that a step may reach without a check for a body worn through.
    pub depth_before_step: [f64; 2],
    /// Speed, m/s.
    pub speed: f64,
    /// Load, N.
    pub load: f64,
    /// Contact temperature, K.
    pub temperature: f64,
}

impl CommonBounds {
    fn new(scene: &Scene) -> CommonBounds {
        let bodies = [&scene.punch, &scene.strip];
        let limited = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
        let mut depth = bodies
            .map(|body| limited(body.wear_limit).min(super::HIGHEST_VALID_WEAR * body.height) - body.initial_wear);
        if scene.path == Path::Straight {
            // The wear limit of the strip is checked on its track.
            depth[1] = f64::NEG_INFINITY;
        }
        CommonBounds {
            depth,
            depth_before_step: bodies.map(|body| super::NEAR_END * body.height - body.initial_wear),
            speed: super::NOMINAL_MARGIN * limited(scene.nominal_velocity),
            load: super::NOMINAL_MARGIN * limited(scene.nominal_load),
            temperature: limited(scene.temperature_limit).min(super::HIGHEST_VALID_TEMPERATURE),
        }
    }
}

/// Operators of the lumped level.
#[derive(Clone, PartialEq, Debug)]
pub struct LumpedOperators {
    /// Scene from which the operators were built.
    pub scene: Scene,
    /// What its errors may reach of its tolerance.
    pub budget: ToleranceBudget,
    /// Of the punch.
    pub punch: BodyOperators,
    /// Of the strip.
    pub strip: BodyOperators,
    /// Flash temperature of the strip under the contact; `None` where the contact covers the whole path or the strip is an
    /// insulator.
    pub flash: Option<Flash>,
    /// The strip's mean temperature contributes to the contact temperature (not on fresh material).
    pub strip_remembers: bool,
    /// Friction law.
    pub friction: FrictionLaw,
    /// Contact area per face, all its punches, m2.
    pub area: f64,
    /// Mean heat flux over mu p v, and friction force (torque over mean radius) over mu F: 1 for line geometry.
    pub power_factor: f64,
    /// Friction force of all faces over mu p, m2.
    pub per_pressure: f64,
    /// Torque over mu F, m.
    pub effective_radius: f64,
    /// A wear rate depends on the contact temperature.
    pub wear_follows_temperature: bool,
    /// Friction heat flux below which errors are neglected, W/m2: a millionth of the nominal one.
    pub least_flux: f64,
    /// The common form of a step is possible: see [`super::stepper::Stepper::attempt`].
    pub has_common_form: bool,
    /// Bounds of the common form.
    pub common_bounds: CommonBounds,
    /// Half of the contact's thermal resistance, K m2/W; 0 without conductance.
    pub half_resistance: f64,
    /// Fraction of a closed path covered by the punches.
    pub strip_coverage: f64,
    /// Critical speed of thermoelastic instability, and growth above it.
    pub growth: PerturbationGrowth,
    /// Mean compliance of both bodies, m/Pa.
    pub compliance: f64,
    /// Friction force over the elastic displacement of the faces along the sliding direction, under a uniform traction, all faces, N/m;
    /// infinite where neither body gives way, or where nothing depends on it: without strokes and without elastic slip.
    pub tangential_stiffness: f64,
    /// Load lost per m of wear less thermal expansion, with a caliper, N/m; 0: dead load.
    pub series_stiffness: f64,
}

/// Mean displacement of both bodies per uniform pressure, m/Pa.
fn mean_compliances(scene: &Scene) -> f64 {
    mean_compliance(scene, &scene.punch, true) + mean_compliance(scene, &scene.strip, false)
}

impl LumpedOperators {
    /// Builds the lumped level of `scene`.
    pub fn new(scene: &Scene) -> LumpedOperators {
        Self::build(scene, mean_compliances(scene), true, None)
    }

    /// Builds the lumped level of `scene` with the growth of perturbations and, at the same tolerance, the reduced bodies and the moving
    /// source of `known`, whose scene has the same bodies, contact and nominal conditions: wear, friction, holder and level may differ.
    pub(crate) fn beside(scene: &Scene, known: &LumpedOperators) -> LumpedOperators {
        Self::build(scene, mean_compliances(scene), true, Some(known))
    }

    /// Builds the lumped level, by itself or beneath a contact line. `compliance`: mean displacement of both bodies per uniform pressure, m/Pa; `moves`: the temperature under the contact follows a moving source. Where the line resolves heat and no bristle asks for it,
    /// it need not. `known`: as in [`LumpedOperators::beside`].
    pub(crate) fn build(
        scene: &Scene,
        compliance: f64,
        moves: bool,
        known: Option<&LumpedOperators>,
    ) -> LumpedOperators {
        let area = scene.contact_area() * scene.count;
        let (power_factor, effective_radius) = match scene.geometry {
            Geometry::Annular => {
                let ratio = 0.5 * scene.width / scene.mean_radius;
                let factor = 1.0 + ratio * ratio / 3.0;
                (factor, scene.mean_radius * factor)
            }
            _ => (1.0, scene.mean_radius),
        };
        let conduction = StripConduction::of(scene);
        let mut punch = body_of(scene, true, area, scene.punch_cooled_area() / area, 1.0);
        let mut strip = body_of(scene, false, conduction.area, conduction.cooled_part, conduction.coverage);
        if conduction.is_endless() {
            // Fresh material arrives at the temperature for which the constants are.
            strip.properties = None;
        }
        let flash = match known.filter(|known| known.scene.tolerance == scene.tolerance) {
            Some(known) => {
                (punch.heat, strip.heat) = (known.punch.heat.clone(), known.strip.heat.clone());
                known.flash.clone().filter(|_| moves)
            }
            None => {
                punch.heat = (scene.punch.conductivity > 0.0).then(|| reduce(scene, &punch_slab(scene)));
                let flash = if moves { conduction.flash(scene) } else { None };
                strip.heat = conduction.heat(scene, flash.as_ref());
                flash
            }
        };
        for body in [&mut punch, &mut strip] {
            body.observe_heat();
            body.cooled_is_contact =
                body.heat.as_ref().is_some_and(|heat| heat.cooled_temperature == heat.contact_temperature);
        }
        let tangential_stiffness = match known {
            Some(known) => known.tangential_stiffness,
            None if scene.elastic_slip || scene.nominal_stroke > 0.0 => tangential_stiffness(scene),
            None => f64::INFINITY,
        };
        let series_stiffness =
            if scene.holder_stiffness > 0.0 { 1.0 / (1.0 / scene.holder_stiffness + compliance / area) } else { 0.0 };
        let growth = known.map_or_else(|| PerturbationGrowth::new(scene), |known| known.growth.clone());
        let mut operators = LumpedOperators {
            has_common_form: false,
            wear_follows_temperature: false,
            common_bounds: CommonBounds::new(scene),
            half_resistance: 0.0,
            strip_coverage: scene.coverage(),
            punch,
            strip,
            flash,
            strip_remembers: !conduction.is_endless(),
            friction: FrictionLaw::new(scene),
            area,
            power_factor,
            per_pressure: area * scene.faces * power_factor,
            effective_radius,
            least_flux: 1e-3 + 1e-6 * scene.friction_coefficient * scene.nominal_load / area * scene.nominal_velocity,
            growth,
            compliance,
            tangential_stiffness,
            series_stiffness,
            scene: scene.clone(),
            budget: ToleranceBudget::of(scene),
        };
        operators.derive();
        operators
    }

    /// These operators with other wear coefficients, convection, heat paths or conductance, those of `scene`: states keep their
    /// meaning.
    pub(crate) fn tuned(&self, scene: Scene) -> LumpedOperators {
        let mut tuned = self.clone();
        if grows_otherwise(&self.scene, &scene) {
            tuned.growth = PerturbationGrowth::new(&scene);
        }
        tuned.punch.tune(&scene, &scene.punch);
        tuned.strip.tune(&scene, &scene.strip);
        tuned.scene = scene;
        tuned.derive();
        tuned
    }

    /// Sets what follows from scene and bodies.
    fn derive(&mut self) {
        let fades = !self.scene.friction_fade.flat;
        let follows = |body: &BodyOperators| body.wear.active() && body.wear.follows_temperature(fades);
        self.wear_follows_temperature = follows(&self.punch) || follows(&self.strip);
        self.half_resistance = if self.scene.conductance > 0.0 { 0.5 / self.scene.conductance } else { 0.0 };
        self.has_common_form = self.allows_common_form();
    }

    /// Operating point at these inputs, under the actuator's load.
    #[inline]
    pub(crate) fn operating_point<S: Scalar>(&self, inputs: &Inputs<S>) -> OperatingPoint<S> {
        let load = load_on_contact(inputs.normal_load, self.scene.nominal_load);
        OperatingPoint { velocity: inputs.velocity(self.scene.mean_radius), pressure: load * (1.0 / self.area) }
    }

    /// Stribeck factor at `now` under the pressure of the contact, Pa: behind a caliper it is not that of the actuator's load.
    #[inline(always)]
    pub(crate) fn stribeck<S: Scalar>(&self, now: &Conditions<S>, pressure: S) -> S {
        match self.series_stiffness > 0.0 {
            true => self.friction.stribeck(OperatingPoint { velocity: now.velocity, pressure }),
            false => now.stribeck,
        }
    }

    /// Punch and strip.
    pub(crate) fn bodies(&self) -> [&BodyOperators; 2] {
        [&self.punch, &self.strip]
    }

    /// Whether the scene can be in the common regime at all.
    fn allows_common_form(&self) -> bool {
        self.punch.heat.is_some()
            && self.strip.heat.is_some()
            && self.scene.conductance > 0.0
            && self.series_stiffness == 0.0
            && !self.has_bristle()
            && self.punch.air.iter().chain([&self.strip.air[FAR]]).all(|air| !air.is_nonlinear())
            && (!self.strip.air[BESIDE].is_nonlinear() || self.strip.cooled_is_contact)
    }
}

/// Flash temperature model of the strip under the contact; `None` where the contact covers the whole path or the strip is an
/// insulator.
pub(crate) fn moving_source(scene: &Scene) -> Option<Flash> {
    StripConduction::of(scene).flash(scene)
}

/// Shortest stroke relative to the contact's length that leaves fresh material to slide on: below, the source is at rest.
const LEAST_STROKE: f64 = 1e-6;

/// Path of the heat source, and the length of the strip that it heats.
fn path_of(scene: &Scene) -> (moving_source::Path, f64) {
    match scene.path {
        Path::Closed => {
            let period = scene.length / scene.count;
            let stroke = scene.nominal_stroke;
            let is_stroke = stroke > LEAST_STROKE * scene.sliding_extent();
            let path = if is_stroke {
                moving_source::Path::Stroke { stroke, cell: period }
            } else {
                moving_source::Path::Closed(period)
            };
            (path, scene.length)
        }
        Path::Straight if scene.nominal_stroke > 0.0 => {
            let cell = stroke_cell(scene).max(scene.length);
            (moving_source::Path::Stroke { stroke: scene.nominal_stroke, cell }, cell)
        }
        Path::Straight => (moving_source::Path::Endless, scene.width),
    }
}

/// Period of a reciprocating path for which periodic images are negligible: stroke + width + 8 times the shortest of diffusion
/// length, fin length and (with a base at prescribed temperature) height.
fn stroke_cell(scene: &Scene) -> f64 {
    let strip = &scene.strip;
    let mut reach = (strip.diffusivity() * scene.nominal_duration).sqrt();
    if strip.convection > 0.0 {
        reach = reach.min((strip.conductivity * strip.height / strip.convection).sqrt());
    }
    if strip.far_is_prescribed() {
        reach = reach.min(strip.height);
    }
    scene.nominal_stroke + scene.width + 8.0 * reach
}

/// Operators of a body without its reduced model; areas of the conduction problem as in [`StripConduction`].
fn body_of(scene: &Scene, punch: bool, area: f64, cooled_part: f64, coverage: f64) -> BodyOperators {
    let body = if punch { &scene.punch } else { &scene.strip };
    let wear = WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade);
    let mut operators = BodyOperators {
        heat: None,
        properties: Properties::of(body, scene.tolerance),
        heat_capacity: body.areal_capacity(),
        uniform_mean: 1.0,
        loses_to_air: false,
        lost_over_step: ([0.0; MAX_STATES], [0.0; PORTS]),
        passes_heat: false,
        coverage,
        area,
        air: [Air::default(); FACES],
        convection_within: body.convection,
        cooled_part,
        cooled_is_contact: false,
        far: body.far_thermal,
        least_wear: 0.0,
        wear_factor: match scene.geometry {
            Geometry::Annular => wear.annular_mean(0.5 * scene.width / scene.mean_radius),
            _ => 1.0,
        },
        wear,
        expansion: mean_expansion(scene, body, punch),
    };
    operators.tune(scene, body);
    operators
}

/// Slab model of the punch.
pub(crate) fn punch_slab(scene: &Scene) -> Slab {
    let (body, area) = (&scene.punch, scene.contact_area() * scene.count);
    Slab {
        volume_transfer: body.convection * scene.punch_cooled_area() / (area * body.height),
        cooling: CoolingPort::Sides,
        ..Slab::of(body)
    }
}

fn reduce(scene: &Scene, slab: &Slab) -> ReducedBody {
    slab.reduce(scene.nominal_duration, ToleranceBudget::of(scene).reduction.whole())
}

/// Conduction problem of the strip.
pub(crate) struct StripConduction {
    /// Path of the heat source.
    path: moving_source::Path,
    /// Reference area per face, m2.
    area: f64,
    /// Fraction of it that the contact covers, and that is cooled.
    pub coverage: f64,
    cooled_part: f64,
    /// Slab model.
    pub slab: Slab,
}

impl StripConduction {
    /// Conduction problem of the strip of a scene.
    pub(crate) fn of(scene: &Scene) -> StripConduction {
        let (body, contact, (path, length)) = (&scene.strip, scene.contact_area() * scene.count, path_of(scene));
        let area = match scene.geometry {
            Geometry::Annular => length * scene.width,
            _ => length * scene.depth,
        };
        // On an endless path the problem is that of the integral over the path: all of it is cooled.
        let (coverage, free) = match path {
            moving_source::Path::Endless => (1.0, area),
            _ => (contact / area, (area - contact).max(0.0)),
        };
        let cooled = if body.cooled_area > 0.0 { body.cooled_area } else { free };
        let slab = Slab { surface_transfer: body.convection * cooled / area, ..Slab::of(body) };
        StripConduction { path, area, coverage, cooled_part: cooled / area, slab }
    }

    /// Whether the contact meets fresh material all the time.
    pub(crate) fn is_endless(&self) -> bool {
        self.path == moving_source::Path::Endless
    }

    /// Source of local heating under the contact; `None` where that covers the whole path, and for an insulator.
    pub(crate) fn source(&self, scene: &Scene) -> Option<MovingSource> {
        (scene.strip.conductivity > 0.0 && scene.coverage() < 1.0 - 1e-9).then(|| {
            MovingSource::new(self.slab, 0.5 * scene.sliding_extent(), self.path).spreading(Lateral::of(scene))
        })
    }

    fn flash(&self, scene: &Scene) -> Option<Flash> {
        let tolerance = ToleranceBudget::of(scene).reduction.whole();
        self.source(scene).map(|source| Flash::new(&source, scene.nominal_duration, tolerance))
    }

    /// Reduced conduction model; `None` for an insulator. The decaying temperature of the track of a stroke, which does not change the
    /// mean, adds states that enter the contact temperature only.
    fn heat(&self, scene: &Scene, flash: Option<&Flash>) -> Option<ReducedBody> {
        if scene.strip.conductivity == 0.0 {
            return None;
        }
        let mut heat = reduce(scene, &self.slab);
        heat.input[0].iter_mut().for_each(|weight| *weight *= self.coverage);
        for observation in [
            &mut heat.contact_temperature,
            &mut heat.cooled_temperature,
            &mut heat.base_temperature,
            &mut heat.mean_temperature,
            &mut heat.ambient_flow,
            &mut heat.base_flow,
        ] {
            observation.direct[0] *= self.coverage;
        }
        if self.is_endless() {
            // Fresh material arrives at its initial temperature: the mean heating stays behind the contact.
            heat.contact_temperature = Observation::default();
        }
        for (&rate, &residue) in flash.iter().flat_map(|flash| flash.track.rate.iter().zip(&flash.track.residue)) {
            let state = heat.count;
            heat.rate[state] = rate;
            heat.input[0][state] = residue.sqrt();
            heat.contact_temperature.states[state] = residue.sqrt();
            heat.count += 1;
        }
        Some(heat)
    }
}
