//! Data of one step of the lumped level: operators, laws, propagators over its length, and its outcome.
//!
//! Theory: docs/theory.md, section 5.4.

use super::conditions::{Conditions, Tunables};
use super::flash_step::{FlashStep, decays_at_rest};
use super::operators::LumpedOperators;
use super::property_step::PropertyStep;
use super::stage::Propagator;
use conduction::flash::MAX_FLASH_STATES;
use conduction::properties::Scales;
use contact::friction::FrictionLaw;
use numerics::cache::KeyedCache;

/// Propagators that are kept of a body: recent step sizes.
const CACHED_STEPS: usize = 12;

/// The same of a body whose properties follow its temperature, 1 MB: of a few step sizes at the temperatures of a stop.
const CACHED_PROPERTIES: usize = 96;

/// Propagators of both bodies over one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Propagators<'a> {
    /// Step size, s.
    pub step: f64,
    pub(super) punch: Option<&'a Propagator>,
    pub(super) strip: Option<&'a Propagator>,
    /// Decay factors of the moving source at rest up to the point 1/3.
    pub(super) at_rest: &'a [f64; MAX_FLASH_STATES],
    /// Properties of the strip.
    pub(super) scales: Scales,
}

/// Recent propagators of both bodies, by the bits of the step size and of the temperature of their properties. Never part of the state,
/// always rebuilt to the same bits.
#[derive(Clone, Debug)]
pub(crate) struct PropagatorCache {
    bodies: [KeyedCache<[u64; 2], Cached>; 2],
    /// Bits of the step size and of both temperatures of the last step, and slots of its propagators.
    latest: ([u64; 3], [usize; 2]),
}

#[derive(Clone, Debug)]
struct Cached {
    own: Option<Propagator>,
    at_rest: [f64; MAX_FLASH_STATES],
    scales: Scales,
}

impl PropagatorCache {
    /// Memory for those of these bodies.
    pub(crate) fn new(operators: &LumpedOperators) -> PropagatorCache {
        let vacant = Cached { own: None, at_rest: [1.0; MAX_FLASH_STATES], scales: Scales::ONE };
        let bodies = operators.bodies().map(|body| {
            let capacity = if body.properties.is_some() { CACHED_PROPERTIES } else { CACHED_STEPS };
            KeyedCache::new(std::iter::repeat_n(vacant.clone(), capacity))
        });
        PropagatorCache { bodies, latest: ([f64::NAN.to_bits(); 3], [0; 2]) }
    }

    /// Forgets all, as the cooling of a body has changed.
    pub(crate) fn clear(&mut self) {
        self.latest.0 = [f64::NAN.to_bits(); 3];
        self.bodies.iter_mut().for_each(KeyedCache::clear);
    }

    /// Propagators over `step` (s) with the properties at these temperatures of punch and strip, K; of a body of constants at any.
    #[inline]
    pub(crate) fn get(&mut self, operators: &LumpedOperators, step: f64, temperatures: [f64; 2]) -> Propagators<'_> {
        let key = [step, temperatures[0], temperatures[1]].map(f64::to_bits);
        // Number by number: as a whole they are compared in memory, which waits for its writes.
        let [same, punch, strip] = [0, 1, 2].map(|of| self.latest.0[of] == key[of]);
        if !(same & punch & strip) {
            self.latest = (key, self.find(operators, step, temperatures));
        }
        let ([punch, strip], slots) = (&self.bodies, self.latest.1);
        let Cached { own, at_rest, scales } = &strip[slots[1]];
        Propagators { step, punch: punch[slots[0]].own.as_ref(), strip: own.as_ref(), at_rest, scales: *scales }
    }

    #[inline(never)]
    fn find(&mut self, operators: &LumpedOperators, step: f64, temperatures: [f64; 2]) -> [usize; 2] {
        let mut slots = [0; 2];
        for (side, (cache, body)) in self.bodies.iter_mut().zip(operators.bodies()).enumerate() {
            let temperature = temperatures[side];
            slots[side] = cache.get_or_compute([step.to_bits(), temperature.to_bits()], |made| {
                made.scales = body.properties.as_ref().map_or(Scales::ONE, |properties| properties.at(temperature));
                made.own = Propagator::new(body, step, made.scales);
                if let Some(flash) = &operators.flash {
                    made.at_rest = decays_at_rest(flash, step * made.scales.pace);
                }
            });
        }
        slots
    }
}

/// Outcome of an attempted step.
pub(crate) struct Attempt {
    /// Error in units of the tolerance; the step is accepted if at most 1.
    pub error: f64,
    /// Highest temperature of the step, K above the reference.
    pub hottest: f64,
}

/// Data of a step that are constant during it.
pub(crate) struct Stepper<'a> {
    /// Operators of the scene.
    pub operators: &'a LumpedOperators,
    /// Friction law.
    pub friction: &'a FrictionLaw,
    /// Values that may change between steps.
    pub tunables: &'a Tunables,
    /// Of the thermal states over the step.
    pub propagators: Propagators<'a>,
    /// Number of parts of the piece without events, and the conditions at its ends where they change: scale of the wear error of
    /// a part.
    pub cut: f64,
    /// Number of parts that are left of it, with this one.
    pub left: f64,
    /// Conditions at the ends of the piece; see `cut`.
    pub ends: Option<&'a [Conditions; 2]>,
    /// Moving source, prepared for this step and its speeds.
    pub flash: &'a mut FlashStep,
    /// Properties of the bodies during the step, where they follow their temperatures.
    pub properties: Option<&'a mut PropertyStep>,
}
