//! Data of one step of the lumped level: operators, laws, propagators over its length, and its outcome.
//!
//! Theory: docs/theory.md, section 5.4.

use super::conditions::{Conditions, Tunables};
use super::flash_step::{FlashStep, decays_at_rest};
use super::operators::{BodyOperators, LumpedOperators};
use super::property_step::PropertyStep;
use super::stage::Propagator;
use conduction::flash::MAX_FLASH_STATES;
use conduction::properties::Scales;
use contact::friction::FrictionLaw;

/// Propagators of both bodies over one step size.
#[derive(Clone, Debug)]
pub struct Propagators {
    /// Step size, s.
    pub step: f64,
    pub(super) punch: Option<Propagator>,
    pub(super) strip: Option<Propagator>,
    /// Decay factors of the moving source at rest up to the point 1/3.
    pub(super) at_rest: [f64; MAX_FLASH_STATES],
    /// Properties of the strip.
    pub(super) scales: Scales,
}

impl Propagators {
    /// Memory for the weights of a step.
    pub fn empty() -> Propagators {
        Propagators { step: f64::NAN, punch: None, strip: None, at_rest: [1.0; MAX_FLASH_STATES], scales: Scales::ONE }
    }

    /// Weights for the step `step` (s).
    pub fn new(operators: &LumpedOperators, step: f64) -> Propagators {
        let of = |body: &BodyOperators| body.heat.as_ref().map(|heat| Propagator::new(heat, step, &body.air));
        let at_rest = operators.flash.as_ref().map_or([1.0; MAX_FLASH_STATES], |flash| decays_at_rest(flash, step));
        Propagators { step, punch: of(&operators.punch), strip: of(&operators.strip), at_rest, scales: Scales::ONE }
    }
}

/// Outcome of an attempted step.
pub struct Attempt {
    /// Error in units of the tolerance; the step is accepted if at most 1.
    pub error: f64,
    /// Highest temperature of the step, K above the reference.
    pub hottest: f64,
}

/// Data of a step that are constant during it.
pub struct Stepper<'a> {
    /// Operators of the scene.
    pub operators: &'a LumpedOperators,
    /// Friction law.
    pub friction: &'a FrictionLaw,
    /// Values that may change between steps.
    pub tunables: &'a Tunables,
    /// Of the thermal states over the step.
    pub propagators: &'a Propagators,
    /// Number of parts of the piece without events, and the conditions at its ends where they change: scale of the wear error of
    /// a part.
    pub cut: f64,
    /// Conditions at the ends of the piece; see `cut`.
    pub ends: Option<&'a [Conditions; 2]>,
    /// Moving source, prepared for this step and its speeds.
    pub flash: &'a mut FlashStep,
    /// Properties of the bodies during the step, where they follow their temperatures.
    pub properties: Option<&'a mut PropertyStep>,
}

impl Stepper<'_> {
    /// The same data, borrowed for a shorter time.
    pub fn reborrow(&mut self) -> Stepper<'_> {
        Stepper { flash: &mut *self.flash, properties: self.properties.as_deref_mut(), ..*self }
    }
}
