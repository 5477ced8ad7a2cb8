//! The contact problem of the stages of a step: gap of the worn bodies, operator from wear to gap, wear coefficients, equilibrium
//! of the holder, and the solutions.
//!
//! Theory: docs/theory.md, sections 6.1, 2.5, 5.5.

use super::operators::{LineOperators, StripWear};
use super::state::LineState;
use super::trajectory::StageConditions;
use crate::budget::WorkBudget;
use crate::lumped::conditions::Tunables;
use conduction::line::Stage;
use contact::friction::FrictionLaw;
use contact::wear::line::{Coefficient, Conditions, ContactRate, LineTrack, StageError, WarmStart, WearingContact};
use contact::{ContactState, Normal, Tilt};
use nalgebra::DMatrix;
use scene::Geometry;

/// Data that are given while the stages of a step are solved: operators, laws, and the state at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepData<'a> {
    pub operators: &'a LineOperators,
    pub friction: &'a FrictionLaw,
    pub tunables: &'a Tunables,
    pub state: &'a LineState,
    /// Temperature to which those of the state are relative, K.
    pub reference: f64,
}

impl StepData<'_> {
    /// Wear depth rates (m/s) of punch and strip at the reference pressure at the instant `now`.
    fn coefficients(&self, now: &StageConditions) -> [f64; 2] {
        self.operators.coefficients(
            now.speed,
            now.kinetic_coefficient,
            now.temperature,
            self.tunables.wear_acceleration,
        )
    }
}

/// Contact problem of the stages of a step, their solutions and the workspace. Vectors have N values, one per cell.
#[derive(Clone, Debug)]
pub(crate) struct ContactStages {
    /// Contact problem of a stage without resolved heat, and of the outputs; with resolved heat each stage has its own.
    pub contact: WearingContact,
    pub conditions: Conditions,
    /// Gap before the deformation, m.
    pub gap: Vec<f64>,
    /// Solutions of both stages.
    pub first: ContactState,
    pub end: ContactState,
    /// Depth rates of punch and strip at both stages, m/s.
    pub rates: [[Vec<f64>; 2]; 2],
    /// Worn track of the strip at the end of the step under way.
    pub track: Option<LineTrack>,
    /// Depths on the track: under the cells, and deposited, m.
    strip: Vec<f64>,
    pub deposit: Vec<f64>,
    /// Operator of the strip's wear under the moving punch, for the travel `carried_over` (m), and that of both bodies.
    carry: DMatrix<f64>,
    carried_over: Option<f64>,
    operator: DMatrix<f64>,
    /// Solution for outputs, and the warm start of the next step meanwhile.
    pub shown: ContactState,
    pub status: WarmStart,
    /// Derivative of the solution, and a gap that does not change.
    pub rate: ContactRate,
    pub still: Vec<f64>,
    /// Load per depth, and the approach of the unworn bodies under it.
    reference_approach: (f64, f64),
    /// Work budget of the communication step under way.
    pub budget: WorkBudget,
}

impl ContactStages {
    /// Stages of a contact line.
    pub(crate) fn new(operators: &LineOperators) -> ContactStages {
        let count = operators.count();
        let zeros = || vec![0.0; count];
        let tracked = if operators.strip_wear == StripWear::Track { count } else { 0 };
        ContactStages {
            contact: operators.contact(),
            conditions: operators.conditions(),
            gap: zeros(),
            first: ContactState::new(count),
            end: ContactState::new(count),
            rates: [[zeros(), zeros()], [zeros(), zeros()]],
            track: (tracked > 0).then(|| LineTrack::new(&operators.cells, operators.scene.nominal_stroke)),
            strip: zeros(),
            deposit: zeros(),
            carry: DMatrix::zeros(tracked, tracked),
            carried_over: None,
            operator: DMatrix::zeros(tracked, tracked),
            shown: ContactState::new(count),
            status: WarmStart::new(count),
            rate: ContactRate::new(count),
            still: zeros(),
            reference_approach: (f64::NAN, 0.0),
            budget: WorkBudget::new(count, operators.heat.as_ref().map_or(0, |bodies| bodies.states.iter().sum())),
        }
    }

    /// Takes tuned operators: bodies may begin or cease to wear.
    pub(crate) fn set_operators(&mut self, operators: &LineOperators) {
        self.conditions = operators.conditions();
        self.carried_over = None;
    }

    /// Begins a step: its track is that of the state.
    pub(crate) fn begin(&mut self, given: &StepData<'_>) {
        if let (Some(own), Some(track)) = (&mut self.track, &given.state.track) {
            own.copy_from(track);
        }
    }

    /// Sets the gap of the worn bodies before they deform: `g0 + w + u_T`.
    pub(crate) fn set_gap(&mut self, given: &StepData<'_>, expansion: f64) {
        let (operators, state) = (given.operators, given.state);
        for i in 0..operators.count() {
            self.gap[i] = operators.initial_gap[i] + state.punch[i] + state.strip[i] + expansion;
        }
    }

    /// Adds the thermal distortion at the end of the last step to the gap.
    fn add_held_distortion(&mut self, given: &StepData<'_>) {
        if let Some(heat) = &given.state.heat {
            self.gap.iter_mut().zip(&heat.distortion).for_each(|(gap, moved)| *gap += moved);
        }
    }

    /// Solves the contact at the instant `now` without wear, on the gap set, into `end`.
    ///
    /// # Errors
    /// The contact has no equilibrium.
    pub(crate) fn solve_without_wear(&mut self, given: &StepData<'_>, now: &StageConditions) -> Result<(), StageError> {
        self.set_equilibrium(given, now);
        self.contact.stage_into(&self.gap, 0.0, &self.conditions, &mut self.end)
    }

    /// A stage in which nothing touches, on the distorted `gap`: where the bodies would meet, without pressure and wear.
    ///
    /// # Errors
    /// The contact has no equilibrium.
    pub(crate) fn leave_open(
        &mut self,
        stage: Stage,
        given: &StepData<'_>,
        now: &StageConditions,
        gap: &[f64],
    ) -> Result<(), StageError> {
        self.set_equilibrium(given, now);
        self.rates[stage as usize].iter_mut().for_each(|rates| rates.fill(0.0));
        let found = match stage {
            Stage::First => &mut self.first,
            Stage::End => &mut self.end,
        };
        self.contact.stage_into(gap, 0.0, &self.conditions, found)
    }

    /// Solves the contact at the instant `now` on the worn shape, with the distortion at the end of the last step, into `shown`.
    /// The warm start of the next step stays as it is.
    ///
    /// # Errors
    /// The contact has no equilibrium.
    pub(crate) fn solve_for_outputs(&mut self, given: &StepData<'_>, now: &StageConditions) -> Result<(), StageError> {
        self.set_gap(given, now.expansion);
        self.add_held_distortion(given);
        self.set_equilibrium(given, now);
        self.status.copy_from(self.contact.status());
        let found = self.contact.stage_into(&self.gap, 0.0, &self.conditions, &mut self.shown);
        self.contact.set_status(&self.status);
        found
    }

    /// Solves a stage of length `tau` (s) without resolved heat, on the gap set.
    ///
    /// # Errors
    /// The contact has no equilibrium, or the iteration does not converge.
    pub(crate) fn solve(
        &mut self,
        stage: Stage,
        given: &StepData<'_>,
        now: &StageConditions,
        tau: f64,
    ) -> Result<(), StageError> {
        self.set_conditions(given, now, tau);
        self.budget.solutions += 1;
        let found = match stage {
            Stage::First => &mut self.first,
            Stage::End => &mut self.end,
        };
        let outcome = self.contact.stage_into(&self.gap, tau, &self.conditions, found);
        let acceleration = given.tunables.wear_acceleration;
        given.operators.rates(now, acceleration, &found.pressure, &mut self.rates[stage as usize]);
        outcome
    }

    /// Sets friction and the equilibrium of the holder at `now`.
    fn set_equilibrium(&mut self, given: &StepData<'_>, now: &StageConditions) {
        let (signed, normal, tilt) = self.balance(given, now);
        self.conditions.signed_friction = signed;
        (self.conditions.normal, self.conditions.tilt) = (normal, tilt);
    }

    /// Sets wear coefficients and the equilibrium of the holder at `now`, for a stage of length `tau` (s).
    pub(crate) fn set_conditions(&mut self, given: &StepData<'_>, now: &StageConditions, tau: f64) {
        self.set_equilibrium(given, now);
        let operators = given.operators;
        let coefficients = given.coefficients(now);
        let mut term = 0;
        for body in 0..2 {
            if operators.reshapes(body) {
                match &mut self.conditions.rate.terms[term].coefficient {
                    Coefficient::Uniform(value) => *value = coefficients[body],
                    Coefficient::PerCell(values) => {
                        for (value, radial) in values.iter_mut().zip(&operators.radial[body]) {
                            *value = coefficients[body] * radial;
                        }
                    }
                }
                term += 1;
            }
        }
        // Uniform wear of the strip unloads a caliper within the stage.
        if operators.strip_wear == StripWear::Even
            && let Normal::Spring { load, stiffness } = &mut self.conditions.normal
        {
            let pressure = &given.state.pressure;
            let [rate, change] = operators.even_rate(coefficients[1], pressure);
            let carried: f64 = pressure.iter().zip(&operators.weights).map(|(p, w)| p * w).sum();
            let slope = if carried > 0.0 { tau * change / carried } else { 0.0 };
            let softened = 1.0 + *stiffness * slope;
            *load = (*load - *stiffness * tau * (rate - change)) / softened;
            *stiffness /= softened;
        }
    }

    /// Equilibrium conditions of holder and contact at `now`: signed friction coefficient of the shear coupling, normal
    /// direction, tilt.
    pub(crate) fn balance(&mut self, given: &StepData<'_>, now: &StageConditions) -> (f64, Normal, Tilt) {
        let operators = given.operators;
        let scene = &operators.scene;
        let coupled = scene.shear_coupling && scene.geometry != Geometry::Annular;
        let signed = if coupled { now.signed_friction } else { 0.0 };
        let tilt = match (operators.rotates, operators.pivot) {
            (false, _) => Tilt::Fixed(0.0),
            (true, None) => Tilt::ResultantAt(0.0),
            (true, Some(height)) => Tilt::ResultantAt(now.signed_friction * height),
        };
        let load = now.load / operators.shared_depth;
        let stiffness = scene.holder_stiffness / operators.shared_depth;
        let normal = if stiffness > 0.0 && now.load > 0.0 {
            // The caliper is adjusted so that the unworn, cold bodies carry the actuator's load.
            let reference = self.approach_of_unworn(operators, load);
            Normal::Spring { load: load + stiffness * reference, stiffness }
        } else {
            Normal::Load(load)
        };
        (signed, normal, tilt)
    }

    /// Approach of the unworn bodies at rest under `load` (N/m), m.
    pub(crate) fn approach_of_unworn(&mut self, operators: &LineOperators, load: f64) -> f64 {
        if self.reference_approach.0 != load {
            self.conditions.signed_friction = 0.0;
            (self.conditions.normal, self.conditions.tilt) = (Normal::Load(load), Tilt::Fixed(0.0));
            self.status.copy_from(self.contact.status());
            let known = self.contact.stage_into(&operators.initial_gap, 0.0, &self.conditions, &mut self.shown);
            self.contact.set_status(&self.status);
            self.reference_approach = (load, if known.is_ok() { self.shown.approach } else { 0.0 });
        }
        self.reference_approach.1
    }

    /// Adds the strip's depth under the cells after `travel` (m) to the gap, from the track of the step.
    pub(crate) fn meet_track(&mut self, given: &StepData<'_>, travel: f64) {
        let Some(track) = &self.track else { return };
        track.depth_under(given.state.position + travel, &mut self.strip);
        for i in 0..self.gap.len() {
            self.gap[i] += self.strip[i] - given.state.strip[i];
        }
    }

    /// Deposits the first stage's wear of `duration` (s) along the first `travel` (m) on the step's track.
    pub(crate) fn leave_first_stage(&mut self, given: &StepData<'_>, travel: f64, duration: f64) {
        let Some(track) = &mut self.track else { return };
        for (deposit, rate) in self.deposit.iter_mut().zip(&self.rates[0][1]) {
            *deposit = duration * rate;
        }
        track.deposit(given.state.position, given.state.position + travel, &self.deposit);
    }

    /// Passes the operator from the wear of a stage to the gap to `contact`, another contact problem than the stages' own.
    pub(crate) fn set_operator_of(
        &mut self,
        contact: &mut WearingContact,
        given: &StepData<'_>,
        travel: f64,
        now: &StageConditions,
    ) {
        self.carried_over = None;
        std::mem::swap(&mut self.contact, contact);
        self.set_operator(given, travel, now);
        std::mem::swap(&mut self.contact, contact);
    }

    /// Sets the operator from the wear of a stage to the gap: the punch's wear stays under its cell, the strip's is carried along
    /// by `travel` (m). Where both wear, the depth of each cell is divided in the ratio of the wear rates at the pressure of the
    /// last step.
    pub(crate) fn set_operator(&mut self, given: &StepData<'_>, travel: f64, now: &StageConditions) {
        let Some(track) = &self.track else { return };
        let operators = given.operators;
        let known = self.carried_over == Some(travel);
        if !known {
            track.operator(travel, &mut self.carry);
            self.carried_over = Some(travel);
        }
        if !operators.reshapes(0) {
            if !known {
                self.contact.set_operator(Some(&self.carry));
            }
            return;
        }
        let laws = given.coefficients(now);
        let least = operators.wear.each_ref().map(|(law, _)| law.least_wearing_pressure());
        for j in 0..operators.count() {
            let pressure = given.state.pressure[j].max(least[0].min(least[1]));
            let [punch, strip] = std::array::from_fn(|body| laws[body] * operators.relative_rate(body, j, pressure));
            let share = if strip > 0.0 { strip / (punch + strip) } else { 0.0 };
            for i in 0..operators.count() {
                let own = if i == j { 1.0 - share } else { 0.0 };
                self.operator[(i, j)] = own + share * self.carry[(i, j)];
            }
        }
        self.contact.set_operator(Some(&self.operator));
    }

    /// Rate (m/s) of the gap of cell `i` by wear at a stage.
    pub(crate) fn reshaping(&self, operators: &LineOperators, stage: usize, i: usize) -> f64 {
        let [punch, strip] = &self.rates[stage];
        if operators.reshapes(1) { punch[i] + strip[i] } else { punch[i] }
    }
}
