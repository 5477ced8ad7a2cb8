//! Outputs and profiles of the lumped level, by value reference.
//!
//! Theory: docs/theory.md, sections 2.7, 7.3.

use super::Lumped;
use super::conditions::Conditions;
use super::limit;
use super::operators::BodyOperators;
use super::point::{self, Point};
use super::state::BodyState;
use crate::Inputs;
use conduction::properties::Properties;
use conduction::reduced::ReducedBody;
use contact::friction::OperatingPoint;
use numerics::maximum::maximum;
use numerics::scalar::{Dual, Scalar};
use scene::variables::{COUNT, ValueReference, reference};
use scene::{STATIONS, ThermalBoundary, value};

macro_rules! emit {
    ($emit:ident, $($name:literal = $value:expr),* $(,)?) => {
        $( $emit(const { reference($name) }, $value); )*
    };
}

/// Emits the limits reached, as a sum and one by one.
pub(crate) fn write_limits(limits: u8, mut emit: impl FnMut(ValueReference, f64)) {
    let reached = |bit: u8| f64::from(u8::from(limits & bit != 0));
    emit!(
        emit,
        "limit_reached" = f64::from(limits & 7),
        "wear_limit_reached" = reached(limit::WEAR),
        "temperature_limit_exceeded" = reached(limit::TEMPERATURE),
        "validity_exceeded" = reached(limit::VALIDITY),
    );
}

impl Lumped {
    /// Writes the outputs with direct feedthrough (except `friction_slope`), and the worn depths.
    pub(crate) fn write_contact(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        let (point, conditions) = self.evaluate(inputs);
        self.on_inputs(&point, &conditions, &mut |reference: ValueReference, value: f64| {
            values[reference as usize] = value;
        });
        let strip = self.strip_depth();
        value!(values, "wear_depth") = self.state.punch.depth + strip;
        value!(values, "wear_depth_punch") = self.state.punch.depth;
        value!(values, "wear_depth_strip") = strip;
    }

    /// Rise of the contact temperature at the end of the last step above the reference temperature, K.
    pub(crate) fn end_rise(&self) -> f64 {
        self.state.end_temperature
    }

    /// Writes the main outputs at the end of the last step, valid for its final inputs only.
    pub(crate) fn write_end(&self, values: &mut [f64; COUNT]) {
        value!(values, "wear_depth") = self.state.punch.depth + self.strip_depth();
        value!(values, "contact_temperature") = self.state.end_temperature + self.state.reference;
        value!(values, "friction_force") = self.state.end_force;
    }

    /// Writes the outputs that depend on the states only: the heat account, volumes, distance.
    pub(crate) fn write_account(&self, values: &mut [f64; COUNT]) {
        let mut emit = |reference: ValueReference, value: f64| values[reference as usize] = value;
        let (operators, scene, state) = (&self.operators, &self.operators.scene, &self.state);
        let faces = scene.faces;
        let (bodies, states) = (operators.bodies(), [&state.punch, &state.strip]);
        let (depths, accounts) = ([state.punch.depth, self.strip_depth()], [0, 1].map(|side| self.account(side)));
        let external = [0, 1].map(|side| {
            point::external_flow(bodies[side], accounts[side].far, states[side].external * bodies[side].area * faces)
        });
        let life = [0, 1].map(|side| match [&scene.punch, &scene.strip][side] {
            body if body.wear_limit > 0.0 => {
                (1.0 - (depths[side] + body.initial_wear) / body.wear_limit).clamp(0.0, 1.0)
            }
            _ => 1.0,
        });
        let volumes = [0, 1].map(|side| states[side].worn * operators.area * faces);
        let [punch, strip] = &accounts;
        let masses = scene::worn_masses([&scene.punch, &scene.strip], volumes);
        emit!(
            emit,
            "wear_volume_punch" = volumes[0],
            "wear_volume_strip" = volumes[1],
            "wear_mass_punch" = masses[0],
            "wear_mass_strip" = masses[1],
            "wear_mass_airborne" = masses[2],
            "wear_taper_punch" = 0.0,
            "remaining_life" = life[0].min(life[1]),
            "sliding_distance" = state.distance,
            "dissipated_energy" = state.dissipated * operators.area * faces,
            "bristle_deflection" = state.bristle,
            "bristle_energy" = 0.5 * state.stiffness * state.bristle * state.bristle,
            "heat_lost_ambient" = punch.ambient + strip.ambient,
            "heat_lost_punch_top" = punch.far,
            "heat_lost_strip_base" = strip.far,
            "heat_lost_punch_external" = external[0],
            "heat_lost_strip_external" = external[1],
            "heat_received_punch" = punch.received,
            "heat_received_strip" = strip.received,
            "stored_heat" = punch.stored + strip.stored,
            "punch.mean_temperature" = self.mean_temperature(&operators.punch, &state.punch, self.state.far[0], 1.0),
            "strip.mean_temperature" = self.strip_mean_temperature(),
            "estimated_step_error" = self.estimated_step_error(),
        );
    }

    /// Writes `friction_slope` and the profiles.
    pub(crate) fn write_rest(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        value!(values, "friction_slope") = self.slope(inputs);
        let point = self.point(inputs);
        let temperature = point.contact_temperature + self.state.reference;
        let scene = &self.operators.scene;
        let strip = self.strip_depth();
        let columns = [
            (const { reference("profile.pressure") }, point.pressure),
            (const { reference("profile.temperature") }, temperature),
            (const { reference("profile.wear_punch") }, self.state.punch.depth),
            (const { reference("profile.wear_strip") }, strip),
        ];
        for (first, value) in columns {
            values[first as usize..first as usize + STATIONS].fill(value);
        }
        let first = const { reference("profile.x") } as usize;
        for station in 0..STATIONS {
            let part = station as f64 / (STATIONS - 1) as f64;
            values[first + station] = scene.width * (part - 0.5);
        }
        if let Some(track) = &self.state.track {
            let first = const { reference("profile.wear_strip") } as usize;
            let spacing = scene.width / (STATIONS - 1) as f64;
            for station in 0..STATIONS {
                let middle = spacing * station as f64 - 0.5 * scene.width;
                let (from, to) =
                    ((middle - 0.5 * spacing).max(-0.5 * scene.width), (middle + 0.5 * spacing).min(0.5 * scene.width));
                values[first + station] = track.mean(self.state.position + from, self.state.position + to);
            }
        }
    }

    /// Derivatives of every output in the direction `seed` of the inputs, at frozen states.
    pub(crate) fn write_derivatives(&mut self, inputs: &Inputs, seed: &Inputs, derivatives: &mut [f64; COUNT]) {
        let inputs = inputs.zip(seed, |value, derivative| Dual { value, derivative });
        let (point, conditions) = self.evaluate(&inputs);
        derivatives.fill(0.0);
        self.on_inputs(&point, &conditions, &mut |reference: ValueReference, value: Dual| {
            derivatives[reference as usize] = value.derivative;
        });
        value!(derivatives, "friction_slope") = self.slope(&inputs).derivative;
    }

    /// d friction_force / d velocity at frozen states, N s/m.
    fn slope<S: Scalar>(&mut self, inputs: &Inputs<S>) -> S {
        let lift = |value: S, derivative: f64| Dual { value, derivative: S::from(derivative) };
        let sliding = Inputs { sliding_velocity: 1.0, ..Inputs::constant(0.0) };
        let inputs = inputs.zip(&sliding, lift);
        self.evaluate(&inputs).0.force.derivative
    }

    /// Outputs with direct feedthrough.
    fn on_inputs<S: Scalar>(
        &self,
        point: &Point<S>,
        conditions: &Conditions<S>,
        emit: &mut impl FnMut(ValueReference, S),
    ) {
        let (operators, scene, state) = (&self.operators, &self.operators.scene, &self.state);
        let faces = scene.faces;
        let absolute = S::from(state.reference);
        let surface = point.partition;
        let hotter = if surface.punch_temperature.value() > surface.strip_temperature.value() {
            surface.punch_temperature
        } else {
            surface.strip_temperature
        };
        let kinetic = point.friction_coefficient * point.load * (faces * operators.power_factor);
        let at_rest = OperatingPoint { velocity: S::from(0.0), pressure: point.pressure };
        let limit = point.kinetic_coefficient
            * point.load
            * (self.friction.stribeck(at_rest) * (faces * operators.power_factor));
        let carries = if point.pressure.value() > 0.0 { 1.0 } else { 0.0 };
        let wearing = (point.wear_rate[0] + point.wear_rate[1]) * point.pressure * (operators.area * faces);
        let closed = state.punch.depth + self.strip_depth() - self.expansion_of_bodies();
        emit!(
            emit,
            "contact_temperature" = point.contact_temperature + absolute,
            "contact_temperature_max" = hotter + absolute,
            "friction_force" = point.force,
            "friction_torque" = point.force * scene.mean_radius,
            "effective_radius" = S::from(operators.effective_radius),
            "friction_power" = point.force * conditions.velocity,
            "friction_coefficient" = point.friction_coefficient,
            "friction_force_kinetic" = kinetic,
            "friction_force_limit" = limit,
            "critical_speed" = operators.growth.critical.at(point.friction_coefficient),
            "pressure_mean" = point.pressure,
            "pressure_max" = point.pressure,
            "contact_fraction" = S::from(carries),
            "tilt" = S::from(0.0),
            "approach" = point.pressure * operators.compliance + S::from(closed),
            "heat_flow_punch" = surface.punch * (operators.area * faces),
            "heat_flow_strip" = surface.strip * (operators.area * faces),
            "heat_flow_punch_top" = point.far_flow[0],
            "heat_flow_strip_base" = point.far_flow[1],
            "heat_flow_punch_external" = point.external_flow[0],
            "heat_flow_strip_external" = point.external_flow[1],
            "heat_flow_ambient" = point.ambient_flow[0] + point.ambient_flow[1],
            "wear_dissipation_power" = wearing,
        );
        emit(const { reference("sticking") }, S::from(f64::from(u8::from(point.sticking))));
        write_limits(state.limits, |reference, value| emit(reference, S::from(value)));
    }

    /// Worn depth of the strip under the contact, m.
    fn strip_depth(&self) -> f64 {
        match &self.state.track {
            Some(track) => track.under(self.state.position),
            None => self.state.strip.depth,
        }
    }

    fn mean_temperature(&self, body: &BodyOperators, state: &BodyState, far: f64, share: f64) -> f64 {
        let ambient = self.tunables.ambient_temperature;
        let rise = |heat: &ReducedBody| self.state.reference + share * body.mean_rise(heat, &state.heat, far);
        body.heat.as_ref().map_or(ambient, rise)
    }

    /// Mean temperature of a strip in unidirectional sliding on a straight path: over the track swept so far, above the
    /// material's initial temperature.
    fn strip_mean_temperature(&self) -> f64 {
        let operators = &self.operators;
        if operators.strip_remembers {
            return self.mean_temperature(&operators.strip, &self.state.strip, self.state.far[1], 1.0);
        }
        let swept = operators.scene.sliding_extent();
        let share = swept / (swept + self.state.distance);
        self.mean_temperature(&operators.strip, &self.state.strip, 0.0, share)
            + point::strip_entry(operators, &self.state)
    }

    /// Heat account of the punch (0) or the strip (1), J, all faces.
    fn account(&self, side: usize) -> Account {
        let operators = &self.operators;
        let (body, state) = (operators.bodies()[side], [&self.state.punch, &self.state.strip][side]);
        let Some(heat) = &body.heat else { return Account::default() };
        let (faces, reference) = (operators.scene.faces, self.state.reference);
        let all = body.area * faces;
        let own = [&operators.scene.punch, &operators.scene.strip][side].initial_temperature;
        let initial = if own > 0.0 && (side == 0 || operators.strip_remembers) { own - reference } else { 0.0 };
        let received = state.received[0] * operators.area * faces;
        if let Some(properties) = &body.properties {
            return self.account_by_enthalpy(side, (properties, heat), initial, received);
        }
        // Integral of a state: (input - gain of the state)/rate, exact for the exact propagation.
        let (mut ambient, mut far, mut stored) = (0.0, 0.0, 0.0);
        for k in 0..heat.count {
            let gained = state.heat[k] - heat.uniform[k] * initial;
            stored += heat.stored.states[k] * gained;
            if heat.rate[k] > 0.0 {
                let entered: f64 = (0..4).map(|port| heat.input[port][k] * state.received[port]).sum();
                let integral = (entered - gained) / heat.rate[k];
                ambient += heat.ambient_flow.states[k] * integral;
                far += heat.base_flow.states[k] * integral;
            }
        }
        for port in 0..4 {
            ambient += heat.ambient_flow.direct[port] * state.received[port];
            far += heat.base_flow.direct[port] * state.received[port];
        }
        // The heat of the quasi-static field of the far face, which is not in the states, entered through that face.
        let beyond = heat.stored.direct[3] * (self.state.far[side] - self.state.far_start[side]);
        stored += beyond;
        far -= beyond;
        // The flux into the cooled surface is heat from the ambient.
        Account { received, ambient: (ambient - state.received[1]) * all, far: far * all, stored: stored * all }
    }

    /// [`Lumped::account`] where the properties follow the temperature: the heat stored is the enthalpy of the mean temperature. With an
    /// insulated far face the rest went to the air; otherwise the heat to the air is counted step by step, and the rest passed the far
    /// face. `initial`: rise at initialisation, K; `received`: heat through the contact, J.
    fn account_by_enthalpy(
        &self,
        side: usize,
        (properties, heat): (&Properties, &ReducedBody),
        initial: f64,
        received: f64,
    ) -> Account {
        let scene = &self.operators.scene;
        let (body, state) = (self.operators.bodies()[side], [&self.state.punch, &self.state.strip][side]);
        let all = body.area * scene.faces;
        let mass = body.heat_capacity / properties.specific_heat();
        // States at a uniform rise. A face of prescribed temperature has it from the start.
        let start = heat.stored.states.map(|stored| stored * initial);
        let rises = [(start, self.state.far_start[side]), (state.heat, self.state.far[side])];
        let [from, to] = rises.map(|(heats, far)| body.mean_rise(heat, &heats, far));
        let stored = mass * properties.table.heat_of_rise(self.state.reference + from, to - from);
        let [_, cooling, _, base] = state.received;
        let (ambient, far) = match [&scene.punch, &scene.strip][side].far_thermal {
            ThermalBoundary::Insulated => (received / all + base - stored, -base),
            _ => (state.lost - cooling, received / all + cooling - state.lost - stored),
        };
        Account { received, ambient: ambient * all, far: far * all, stored: stored * all }
    }

    /// Estimated relative error of the reduction of both bodies and of the time steps.
    fn estimated_step_error(&self) -> f64 {
        let reduction = [&self.operators.punch, &self.operators.strip]
            .iter()
            .filter_map(|body| body.heat.as_ref())
            .map(|heat| heat.error)
            .fold(0.0, maximum);
        reduction + self.state.error
    }

    /// Limits reached so far; see [`limit`].
    pub(crate) fn limits(&self) -> u8 {
        self.state.limits
    }
}

#[derive(Default)]
struct Account {
    received: f64,
    ambient: f64,
    far: f64,
    stored: f64,
}
