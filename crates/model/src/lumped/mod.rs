//! Lumped level: uniform pressure, a few thermal states per body, a moving source.
//!
//! Theory: docs/theory.md, section 8.1.

mod advance;
pub mod air;
pub(crate) mod bristle;
pub mod conditions;
pub(crate) mod error_weights;
mod estimate;
mod flash_step;
pub(crate) mod interface;
pub mod operators;
pub(crate) mod outputs;
pub(crate) mod point;
mod property_step;
pub(crate) mod saved;
pub(crate) mod stage;
mod stage_body;
mod stage_partition;
mod stages;
pub mod state;
pub(crate) mod step;
pub(crate) mod stepper;

use crate::{Inputs, StepFailure};
use bristle::Line;
use conditions::{Conditions, Tunables};
use contact::friction::FrictionLaw;
use flash_step::FlashStep;
use numerics::scalar::Scalar;
use operators::LumpedOperators;
use point::{Frozen, Point};
use property_step::PropertyStep;
use pulp::Arch;
use scene::Scene;
use scene::message::Number;
use state::LumpedState;
use std::sync::Arc;
use stepper::PropagatorCache;

/// Bits of [`LumpedState::limits`].
pub mod limit {
    /// A wear limit is reached.
    pub const WEAR: u8 = 1;
    /// The temperature limit is exceeded.
    pub const TEMPERATURE: u8 = 2;
    /// The scene has left the model's validity.
    pub const VALIDITY: u8 = 4;
    /// The load was below zero (not shown in the output).
    pub const NEGATIVE_LOAD: u8 = 8;
    /// Accelerated wear suppresses thermoelastic instability noticeably (not shown in the output).
    pub const ACCELERATED: u8 = 16;
    /// Pressure perturbations may have grown noticeably above the critical speed (not shown in the output).
    pub const UNSTABLE: u8 = 32;
}

/// Temperature (K) above which constant material properties are meaningless.
pub const HIGHEST_VALID_TEMPERATURE: f64 = 2500.0;

/// Fraction of a body's height that may be worn off before conduction and compliance must be rebuilt.
const HIGHEST_VALID_WEAR: f64 = 0.5;

/// Fraction of a body's height up to which a step may wear without a saved initial state.
const NEAR_END: f64 = 0.9;

/// Factor by which load and speed may exceed their nominal values before the plan becomes invalid.
const NOMINAL_MARGIN: f64 = 10.0;

/// Limit bits of a contact temperature (K).
pub(crate) fn limits_of_temperature(scene: &Scene, hottest: f64) -> u8 {
    let exceeded = scene.temperature_limit > 0.0 && hottest > scene.temperature_limit;
    let invalid = hottest > HIGHEST_VALID_TEMPERATURE;
    (if exceeded { limit::TEMPERATURE } else { 0 }) | (if invalid { limit::VALIDITY } else { 0 })
}

/// Limit bits of punch and strip with these depths (m) worn off since the start, without initial wear.
///
/// # Errors
/// A body that is worn through.
#[inline]
pub(crate) fn limits_of_wear(scene: &Scene, depths: [f64; 2]) -> Result<u8, StepFailure> {
    let mut limits = 0;
    for (name, depth, body) in [("punch", depths[0], &scene.punch), ("strip", depths[1], &scene.strip)] {
        let worn = depth + body.initial_wear;
        if worn >= body.height {
            return Err(StepFailure(format!(
                "the {name} is worn through: worn depth {worn} m reaches {name}.height = {} m",
                Number(body.height),
                worn = Number(worn)
            )));
        }
        if worn > HIGHEST_VALID_WEAR * body.height {
            limits |= limit::VALIDITY;
        }
        if body.wear_limit > 0.0 && worn >= body.wear_limit {
            limits |= limit::WEAR;
        }
    }
    Ok(limits)
}

/// Instance of a scene at the lumped level.
#[derive(Clone, Debug)]
pub struct Lumped {
    operators: Arc<LumpedOperators>,
    friction: FrictionLaw,
    tunables: Tunables,
    state: LumpedState,
    /// Free responses of the state; `None` where it has changed.
    frozen: Option<Frozen>,
    propagators: PropagatorCache,
    /// Where properties follow temperatures.
    property_step: Option<PropertyStep>,
    /// The machine's vector unit.
    arch: Arch,
    flash: FlashStep,
    /// Conditions last computed, and their inputs.
    known: (Inputs, Conditions),
}

impl Lumped {
    /// Initial state at rest at the given inputs (which give the ambient temperature of initialisation).
    pub(crate) fn new(operators: Arc<LumpedOperators>, tunables: Tunables, inputs: &Inputs) -> Lumped {
        let ambient = tunables.ambient_temperature + inputs.ambient_temperature_offset;
        let mut state = LumpedState::new(&operators, ambient);
        let mut friction = operators.friction.clone();
        friction.coefficient = tunables.friction_coefficient;
        let known = (*inputs, Conditions::new(&operators, &tunables, state.reference, inputs));
        state.far_start = [known.1.punch_far, known.1.strip_far];
        state.far = state.far_start;
        Lumped {
            frozen: None,
            friction,
            tunables,
            state,
            propagators: PropagatorCache::new(&operators),
            property_step: PropertyStep::of(&operators),
            arch: Arch::new(),
            flash: FlashStep::empty(),
            known,
            operators,
        }
    }

    /// Operators built from the scene.
    pub(crate) fn operators(&self) -> &Arc<LumpedOperators> {
        &self.operators
    }

    /// Whether a bristle models the friction force at standstill.
    pub(crate) fn has_bristle(&self) -> bool {
        self.state.stiffness > 0.0
    }

    /// Kinetic friction coefficient at the temperature at the end of the last step.
    pub(crate) fn kinetic_coefficient(&self) -> f64 {
        self.friction.kinetic_coefficient(self.end_temperature())
    }

    /// Contact temperature at the end of the last step, K.
    pub(crate) fn end_temperature(&self) -> f64 {
        self.state.end_temperature + self.state.reference
    }

    /// Time (s) for which the bristle sticks from the start of a piece of `length` (s) on, at the friction coefficient at its start;
    /// infinite without a bristle.
    pub(crate) fn sticks_for(&self, inputs: &Inputs, slopes: Option<&Inputs>, length: f64) -> f64 {
        let (operators, state) = (&self.operators, &self.state);
        let Some(bristle) = operators.bristle(state.stiffness) else { return f64::INFINITY };
        let per_load = self.kinetic_coefficient() * operators.scene.faces * operators.power_factor;
        let ends = [*inputs, inputs.after(slopes, length)].map(|at| {
            let operating_point = operators.operating_point(&at);
            [operating_point.velocity, per_load * self.friction.stribeck(operating_point) * at.normal_load.max(0.0)]
        });
        let [velocity, limit] = [0, 1].map(|k| Line { start: ends[0][k], rate: (ends[1][k] - ends[0][k]) / length });
        bristle.sticks_for(state.bristle, velocity, limit)
    }

    /// Takes the friction force over elastic displacement `elastic` (N/m) of a contact whose pressure has changed. The energy of the
    /// bristle stays: its deflection follows, by no more than the change of the stiffness.
    pub(crate) fn set_tangential_stiffness(&mut self, elastic: f64) {
        let before = self.state.stiffness;
        self.state.stiffness = self.operators.stick_stiffness(elastic);
        self.state.bristle *= (before / self.state.stiffness).sqrt();
    }

    /// Current state.
    pub(crate) fn state(&self) -> &LumpedState {
        &self.state
    }

    /// Work (J) of the friction force on all faces since initialisation.
    pub(crate) fn friction_work(&self) -> f64 {
        self.state.dissipated * self.operators.area * self.operators.scene.faces
    }

    /// Replaces the whole state.
    pub(crate) fn set_state(&mut self, state: &LumpedState) {
        self.state.clone_from(state);
        self.frozen = None;
        self.invalidate_conditions();
    }

    /// Takes `operators`, those of [`LumpedOperators::tuned`], before [`Lumped::set_tunables`]; the state stays. Of what is tuned
    /// propagators depend on the cooling alone.
    pub(crate) fn set_operators(&mut self, operators: Arc<LumpedOperators>) {
        let [own, tuned] = [&self.operators, &operators].map(|operators| operators.bodies().map(|body| body.air));
        if own != tuned {
            self.propagators.clear();
        }
        self.operators = operators;
        self.frozen = None;
    }

    /// Sets the parameters that may change between steps, without those of the operators.
    pub(crate) fn set_tunables(&mut self, tunables: Tunables) {
        self.friction.coefficient = tunables.friction_coefficient;
        self.tunables = tunables;
        self.invalidate_conditions();
    }

    /// Sets a friction coefficient that replaces the tunable parameter.
    pub(crate) fn set_friction_coefficient(&mut self, coefficient: f64) {
        self.friction.coefficient = coefficient;
    }

    /// Invalidates the conditions last computed, by NaN inputs.
    fn invalidate_conditions(&mut self) {
        self.known.0 = Inputs::constant(f64::NAN);
    }

    /// Contact for these inputs at frozen states.
    pub(crate) fn point(&mut self, inputs: &Inputs) -> Point {
        self.update_conditions(inputs);
        let conditions = self.known.1;
        self.point_at(&conditions)
    }

    /// Contact and its conditions for inputs of any numbers, at frozen states.
    pub(crate) fn evaluate<S: Scalar>(&mut self, inputs: &Inputs<S>) -> (Point<S>, Conditions<S>) {
        let conditions = Conditions::new(&self.operators, &self.tunables, self.state.reference, inputs);
        (self.point_at(&conditions), conditions)
    }

    fn point_at<S: Scalar>(&mut self, conditions: &Conditions<S>) -> Point<S> {
        let frozen = self.frozen.get_or_insert_with(|| Frozen::new(&self.operators, &self.state));
        point::evaluate(&self.operators, &self.friction, &self.state, frozen, &self.tunables, conditions)
    }

    /// Mean outward displacement of both contact surfaces by the bodies' mean temperatures, m.
    pub(crate) fn expansion_of_bodies(&self) -> f64 {
        let LumpedState { punch, strip, far, .. } = &self.state;
        self.operators.punch.expansion_at(&punch.heat, far[0]) + self.operators.strip.expansion_at(&strip.heat, far[1])
    }

    /// Computes the conditions of `inputs`, unless they are the last ones.
    #[inline]
    fn update_conditions(&mut self, inputs: &Inputs) {
        // Bitwise and without a branch per input: one vector comparison.
        let differences = self.known.0.zip(inputs, |known, now| known.to_bits() ^ now.to_bits()).to_array();
        if differences.into_iter().fold(0, |all, bits| all | bits) != 0 {
            self.known = (*inputs, Conditions::new(&self.operators, &self.tunables, self.state.reference, inputs));
        }
    }
}
