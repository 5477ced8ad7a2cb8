//! Outputs and profiles of the line level, by value reference: those of the lumped level, replaced where the contact line
//! resolves more.
//!
//! Theory: docs/theory.md, sections 2.7, 8.4.

use super::Line;
use super::operators::LineOperators;
use super::trajectory::StageConditions;
use crate::Inputs;
use crate::events::load_on_contact;
use crate::lumped::outputs::write_limits;
use contact::Normal;
use contact::friction::OperatingPoint;
use contact::wear::line::Disturbance;
use elasticity::Cells;
use numerics::maximum::maximum;
use numerics::scalar::Dual;
use scene::variables::{COUNT, reference};
use scene::{Geometry, STATIONS, value};

impl Line {
    /// Evaluates pressure, approach and tilt for these inputs at the frozen worn shape into `shown`. Without an equilibrium (the
    /// next step will report it) the last one remains.
    fn equilibrium(&mut self, inputs: &Inputs) {
        if self.shown.0 == *inputs {
            return;
        }
        // With temperature-dependent friction the end of a step is only accurate to its tolerance.
        if self.state.current
            && self.state.end_inputs == *inputs
            && (!self.operators.follows_heat() || self.heat.is_some() && self.operators.scene.friction_fade.flat)
        {
            let (state, shown) = (&self.state, &mut self.shown);
            shown.1.pressure.copy_from_slice(&state.pressure);
            (shown.1.approach, shown.1.tilt) = (state.approach, state.tilt);
            shown.0 = *inputs;
            return;
        }
        let now = self.conditions_at(inputs);
        let (given, stages, _) = self.parts();
        if stages.solve_for_outputs(&given, &now).is_ok() {
            std::mem::swap(&mut self.shown.1, &mut self.stages.shown);
        }
        self.shown.0 = *inputs;
    }

    /// Conditions of the contact for these inputs at frozen states.
    fn conditions_at(&mut self, inputs: &Inputs) -> StageConditions {
        let load = load_on_contact(inputs.normal_load, self.operators.scene.nominal_load);
        let point = self.mean.point(inputs);
        let contact_temperature_of_cells = self.state.heat.as_ref().map(|heat| heat.mean(&self.operators.weights));
        let velocity = inputs.velocity(self.operators.scene.mean_radius);
        let full = load * self.operators.mean.scene.faces * self.operators.mean.power_factor;
        let signed_friction =
            if full > 0.0 { point.force / full } else { self.friction.sign(velocity) * point.friction_coefficient };
        StageConditions {
            sign: self.friction.sign(velocity),
            stribeck: self.friction.stribeck(OperatingPoint { velocity, pressure: point.pressure }),
            signed_friction,
            load,
            speed: point.wearing_speed,
            kinetic_coefficient: point.kinetic_coefficient,
            temperature: contact_temperature_of_cells.unwrap_or(point.contact_temperature)
                + self.mean.state().reference,
            expansion: self.expansion(),
            heat_per_pressure: None,
            released: 0.0,
        }
    }

    /// Load per face (N) for the lumped level: that of the cells where they determine it, else the input.
    pub(super) fn carried(&mut self, inputs: &Inputs) -> f64 {
        if !self.operators.decides_load() {
            return inputs.normal_load;
        }
        self.equilibrium(inputs);
        self.operators.carried(&self.shown.1.pressure)
    }

    /// Gives the bristle the stiffness at the pressure that the contact has, which a contact without wear does not keep.
    pub(super) fn follow_elastic_slip(&mut self, inputs: &Inputs) {
        let operators = self.operators.clone();
        if !operators.has_tangential_compliance() {
            return;
        }
        let pressure = if self.state.current {
            &self.state.pressure
        } else {
            self.equilibrium(inputs);
            &self.shown.1.pressure
        };
        if let Some(stiffness) = operators.tangential_stiffness(pressure) {
            self.mean.set_tangential_stiffness(stiffness);
        }
    }

    /// These inputs with the load for the lumped level.
    pub(super) fn loaded(&mut self, inputs: &Inputs) -> Inputs {
        let mut loaded = *inputs;
        loaded.normal_load = self.carried(inputs);
        loaded
    }

    /// Mean worn depths of punch and strip, m.
    fn depths(&self) -> [f64; 2] {
        let operators = &self.operators;
        let total: f64 = operators.weights.iter().sum();
        [&self.state.punch, &self.state.strip].map(|depth| {
            depth.iter().zip(&operators.weights).map(|(depth, weight)| depth * weight).sum::<f64>() / total
        })
    }

    /// Writes the outputs with direct feedthrough (except `friction_slope`), and the worn depths.
    pub(crate) fn write_contact(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        self.equilibrium(inputs);
        let loaded = self.loaded(inputs);
        self.mean.write_contact(&loaded, values);
        self.write_heat_flows(inputs, values);
        let now = self.conditions_at(&loaded);
        let operators = &self.operators;
        let (scene, shown) = (&operators.scene, &self.shown.1);
        let pressure = &shown.pressure;
        let (mut rates, acceleration) = (0.0, self.tunables.wear_acceleration);
        operators.for_rates(&now, acceleration, pressure, |i, punch, strip| {
            rates += operators.weights[i] * pressure[i] * (punch + strip / operators.wear[1].1);
        });
        let carrying: f64 =
            pressure.iter().zip(operators.cells.widths()).map(|(p, c)| if *p > 0.0 { *c } else { 0.0 }).sum();
        let total: f64 = operators.weights.iter().sum();
        let load: f64 = pressure.iter().zip(&operators.weights).map(|(p, w)| p * w).sum();
        value!(values, "pressure_mean") = load / total;
        value!(values, "pressure_max") = pressure.iter().copied().fold(0.0, maximum);
        value!(values, "contact_fraction") = (carrying / (2.0 * operators.cells.half_width())).min(1.0);
        value!(values, "tilt") = shown.tilt;
        value!(values, "approach") = shown.approach;
        value!(values, "wear_dissipation_power") = rates * operators.shared_depth * scene.faces;
        if scene.geometry == Geometry::Annular && load > 0.0 {
            let torque: f64 =
                (0..pressure.len()).map(|i| operators.weights[i] * pressure[i] * operators.radius_ratio[i]).sum();
            value!(values, "effective_radius") = scene.mean_radius * torque / load;
        }
        write_limits(self.limits(), |reference, value| values[reference as usize] = value);
        self.write_depths(values);
    }

    fn write_depths(&self, values: &mut [f64; COUNT]) {
        let [punch, strip] = self.depths();
        value!(values, "wear_depth") = punch + strip;
        value!(values, "wear_depth_punch") = punch;
        value!(values, "wear_depth_strip") = strip;
    }

    /// Rise of the contact temperature at the end of the last step above the reference temperature, K.
    pub(crate) fn end_rise(&self) -> f64 {
        match &self.state.heat {
            Some(heat) => heat.mean(&self.operators.weights),
            None => self.mean.end_rise(),
        }
    }

    /// Writes the main outputs at the end of the last step, valid for its final inputs only.
    pub(crate) fn write_end(&self, values: &mut [f64; COUNT]) {
        self.mean.write_end(values);
        value!(values, "contact_temperature") = self.end_rise() + self.mean.state().reference;
        let [punch, strip] = self.depths();
        value!(values, "wear_depth") = punch + strip;
    }

    /// Writes the outputs that depend on the states only: the heat account, volumes, distance.
    pub(crate) fn write_account(&self, values: &mut [f64; COUNT]) {
        self.mean.write_account(values);
        let (operators, state) = (&self.operators, &self.state);
        let scene = &operators.scene;
        let all = operators.shared_depth * scene.faces;
        let volumes = state.volume.map(|volume| volume * all);
        let masses = scene::worn_masses([&scene.punch, &scene.strip], volumes);
        value!(values, "wear_volume_punch") = volumes[0];
        value!(values, "wear_volume_strip") = volumes[1];
        value!(values, "wear_mass_punch") = masses[0];
        value!(values, "wear_mass_strip") = masses[1];
        value!(values, "wear_mass_airborne") = masses[2];
        value!(values, "wear_taper_punch") = taper(&operators.cells, &state.punch);
        let life = |depth: &[f64], body: &scene::Body| {
            let deepest = depth.iter().copied().fold(0.0, maximum) + body.initial_wear;
            if body.wear_limit > 0.0 { (1.0 - deepest / body.wear_limit).clamp(0.0, 1.0) } else { 1.0 }
        };
        value!(values, "remaining_life") = life(&state.punch, &scene.punch).min(life(&state.strip, &scene.strip));
        value!(values, "estimated_step_error") += state.error;
        self.write_heat_account(values);
    }

    /// Writes `friction_slope` and the profiles.
    pub(crate) fn write_rest(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        self.equilibrium(inputs);
        let loaded = self.loaded(inputs);
        self.mean.write_rest(&loaded, values);
        self.write_heat_profile(values);
        let (profile, state) = (&self.operators.profile, &self.state);
        let columns = [
            (const { reference("profile.pressure") }, &self.shown.1.pressure),
            (const { reference("profile.wear_punch") }, &state.punch),
            (const { reference("profile.wear_strip") }, &state.strip),
        ];
        for (first, means) in columns {
            let first = first as usize;
            profile.fill(means, &mut values[first..first + STATIONS]);
        }
        let first = const { reference("profile.x") } as usize;
        values[first..first + STATIONS].copy_from_slice(profile.positions());
    }

    /// Derivatives of every output in the direction `seed` of the inputs, at frozen states.
    pub(crate) fn write_derivatives(&mut self, inputs: &Inputs, seed: &Inputs, derivatives: &mut [f64; COUNT]) {
        self.equilibrium(inputs);
        let now = self.conditions_at(inputs);
        let operators = self.operators.clone();
        let (scene, count) = (&operators.scene, operators.count());
        // Friction per load in dual numbers: it rotates the punch and shifts the pressure.
        let duals = inputs.zip(seed, |value, derivative| Dual { value, derivative });
        let point = self.mean.evaluate(&duals).0;
        let full = operators.mean.scene.faces * operators.mean.power_factor;
        let load = load_on_contact(inputs.normal_load, scene.nominal_load);
        let load_rate = if load > 0.0 { seed.normal_load } else { 0.0 };
        let signed_rate = if load > 0.0 {
            (point.force.derivative - now.signed_friction * full * load_rate) / (full * load)
        } else {
            0.0
        };
        let (given, stages, _) = self.parts();
        let (signed, normal, tilt) = stages.balance(&given, &now);
        let per_depth = load_rate / operators.shared_depth;
        let normal_rate = match normal {
            // The holder's reference position moves with the load by the elastic approach of the unworn bodies.
            Normal::Spring { stiffness, .. } => per_depth + stiffness * self.reference_rate(load, per_depth),
            _ => per_depth,
        };
        let stages = &mut self.stages;
        stages.conditions.signed_friction = signed;
        (stages.conditions.normal, stages.conditions.tilt) = (normal, tilt);
        let coupled = scene.shear_coupling && scene.geometry != Geometry::Annular;
        let friction_rate = if coupled { signed_rate } else { 0.0 };
        let lever_rate = operators.pivot.map_or(0.0, |height| signed_rate * height);
        let disturbance = Disturbance {
            gap: &stages.still,
            normal: normal_rate,
            tilt: lever_rate,
            moment: 0.0,
            signed_friction: friction_rate,
        };
        let rate = &mut stages.rate;
        if stages.contact.response_into(&stages.conditions, &self.shown.1, &disturbance, rate).is_err() {
            rate.pressure.fill(0.0);
            (rate.approach, rate.tilt) = (0.0, 0.0);
        }
        let carried_rate =
            if operators.decides_load() { operators.carried(&self.stages.rate.pressure) } else { load_rate };
        let mut loaded = *inputs;
        loaded.normal_load = self.carried(inputs);
        let mut seeds = *seed;
        seeds.normal_load = carried_rate;
        self.mean.write_derivatives(&loaded, &seeds, derivatives);
        self.write_heat_rates(inputs, seed, derivatives);
        let (pressure, rate) = (&self.shown.1.pressure, &self.stages.rate);
        let duals = loaded.zip(&seeds, |value, derivative| Dual { value, derivative });
        let loaded_point = self.mean.evaluate(&duals).0;
        let total: f64 = operators.weights.iter().sum();
        let sum = |of: &dyn Fn(usize) -> f64| (0..count).map(|i| operators.weights[i] * of(i)).sum::<f64>();
        let highest = (0..count).max_by(|&i, &j| pressure[i].total_cmp(&pressure[j])).unwrap_or(0);
        value!(derivatives, "pressure_mean") = sum(&|i| rate.pressure[i]) / total;
        value!(derivatives, "pressure_max") = rate.pressure[highest];
        value!(derivatives, "contact_fraction") = 0.0;
        value!(derivatives, "tilt") = rate.tilt;
        value!(derivatives, "approach") = rate.approach;
        value!(derivatives, "wear_dissipation_power") = {
            let contact_temperature_of_cells =
                self.state.heat.as_ref().map(|heat| Dual::from(heat.mean(&operators.weights)));
            let temperature = contact_temperature_of_cells.unwrap_or(loaded_point.contact_temperature)
                + Dual::from(self.mean.state().reference);
            let laws = operators.coefficients(
                loaded_point.wearing_speed,
                loaded_point.kinetic_coefficient,
                temperature,
                self.tunables.wear_acceleration,
            );
            let power = sum(&|i| operators.dissipation_rate(laws, i, pressure[i], rate.pressure[i]));
            power * operators.shared_depth * scene.faces
        };
        let load = sum(&|i| pressure[i]);
        if scene.geometry == Geometry::Annular && load > 0.0 {
            let ratio = &operators.radius_ratio;
            let torque = sum(&|i| pressure[i] * ratio[i]);
            let change = sum(&|i| rate.pressure[i] * ratio[i]) - torque / load * sum(&|i| rate.pressure[i]);
            value!(derivatives, "effective_radius") = scene.mean_radius * change / load;
        }
        let first = const { reference("profile.pressure") } as usize;
        operators.profile.fill_rates(pressure, &rate.pressure, &mut derivatives[first..first + STATIONS]);
    }

    /// Derivative of the reference approach with respect to the load, times `rate`.
    fn reference_rate(&mut self, load: f64, rate: f64) -> f64 {
        let load = load / self.operators.shared_depth;
        let step = 1e-5 * load;
        let [low, high] = [load - step, load + step].map(|load| self.stages.approach_of_unworn(&self.operators, load));
        if step > 0.0 { (high - low) / (2.0 * step) * rate } else { 0.0 }
    }
}

/// Rise, from the -x to the +x edge, of the straight line of least squares through cell means `w` of a depth, m:
/// `W sum_i c_i x_i w_i / sum_i c_i x_i^2` with widths `c_i` and centres `x_i` of the cells, which are symmetric.
fn taper(cells: &Cells, depth: &[f64]) -> f64 {
    2.0 * cells.half_width() * cells.moment(depth) / cells.moment(cells.centres())
}

impl LineOperators {
    /// Whether the contact line determines the load of the lumped level.
    pub(crate) fn decides_load(&self) -> bool {
        self.scene.holder_stiffness > 0.0 || self.scene.geometry == Geometry::Annular
    }

    /// Whether the contact line depends on the lumped temperature, or on the bristle, during a step.
    pub(crate) fn follows_heat(&self) -> bool {
        self.follows_temperature() || self.mean.has_bristle()
    }

    /// Whether tables or the load depend on the lumped temperature.
    pub(crate) fn follows_temperature(&self) -> bool {
        let scene = &self.scene;
        let expands = scene.holder_stiffness > 0.0
            && [&scene.punch, &scene.strip].iter().any(|body| body.thermal_expansion > 0.0);
        let fades = !scene.friction_fade.flat || self.wear.iter().any(|(law, _)| law.active() && !law.fade.flat);
        fades || expands
    }

    /// Calls `take(cell, punch rate, strip rate)` for every cell, m/s.
    fn for_rates(
        &self,
        now: &StageConditions,
        acceleration: f64,
        pressure: &[f64],
        mut take: impl FnMut(usize, f64, f64),
    ) {
        let laws = self.coefficients(now.speed, now.kinetic_coefficient, now.temperature, acceleration);
        for i in 0..pressure.len() {
            let [punch, strip] = std::array::from_fn(|body| laws[body] * self.relative_rate(body, i, pressure[i]));
            take(i, punch, strip);
        }
    }

    /// Change of the power per area `p (dw_1/dt + dw_2/dt)` of cell `i`, W/m2, by the change `change` of its pressure and
    /// that of the laws' coefficients.
    fn dissipation_rate(&self, laws: [Dual; 2], i: usize, pressure: f64, change: f64) -> f64 {
        let of = |body: usize| {
            let (law, factor) = &self.wear[body];
            let relative = self.relative_rate(body, i, pressure) / if body == 1 { *factor } else { 1.0 };
            let rise = 1.0 + law.logarithmic_slope(pressure);
            relative * (laws[body].derivative * pressure + laws[body].value * rise * change)
        };
        of(0) + of(1)
    }
}
