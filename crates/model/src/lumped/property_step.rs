//! Conductivity and specific heat over temperature in a step of the lumped level.
//!
//! During a step the properties of a body are those at a mean temperature in its middle: the mean at the start plus half a step at
//! the rate of the last one, so that the step is of second order. The step tells the mean at its end before it is accepted; where
//! the middle of both differs too much, it is repeated with that.
//!
//! The step in the body's own time ([`conduction::properties`]) is another one every time. Its propagator is interpolated
//! between those of four cached step sizes in the ratio 2^(1/8): to 1.4e-6 of the states' weights, without a jump. What is
//! in proportion to the step size is exact, so that no heat is lost.
//!
//! After the step the mean temperature is set to that by its enthalpy, with a uniform change of temperature that is of third order in the
//! step: the body has taken up exactly the heat of its fluxes. Where the states pass heat on (constant heat transfer, prescribed
//! temperature), that of the air is the integral of the flow, and that of the far face closes the account.
//!
//! Theory: docs/theory.md, section 4.15.

use super::CACHED_STEPS;
use super::flash_step::decays_at_rest;
use super::operators::{BodyOperators, LumpedOperators};
use super::stage::{Between, Propagator};
use super::state::{BodyState, LumpedState};
use super::stepper::Propagators;
use conduction::flash::MAX_FLASH_STATES;
use conduction::properties::{Properties, Scales};
use conduction::reduced::{MAX_STATES, PORTS, Port, ReducedBody};
use numerics::cache::KeyedCache;
use numerics::maximum::maximum;
use scene::ThermalBoundary;

/// Cached step sizes per factor of two.
const PER_OCTAVE: f64 = 8.0;

/// Cached propagators of a body with a table, 1 MB: sixteen factors of two, as steps after a jump of the inputs are a thousandth of the
/// longest ones.
const CACHED: usize = 128;

/// Attempts of a step with other temperatures in its middle.
pub const ATTEMPTS: usize = 3;

/// Most by which the temperature in the middle of a step is extrapolated from that at its start, K.
const FARTHEST: f64 = 50.0;

/// Propagator of a body over one step of its own time, and decays of the moving source over it.
#[derive(Clone, Debug)]
struct Node {
    propagator: Option<Propagator>,
    at_rest: [f64; MAX_FLASH_STATES],
}

/// Cached propagators of one body.
#[derive(Clone, Debug)]
struct Nodes {
    /// By the number of the step size, 2^(number/8) s.
    cache: KeyedCache<i32, Node>,
    /// First of the four that were used last, and their slots.
    latest: (i32, [usize; 4]),
    between: Between,
}

/// Bodies during a step.
#[derive(Clone, Debug)]
pub struct PropertyStep {
    /// Mean temperatures in the middle of the step, K: those with which it is computed, and those that it leads to.
    middle: [f64; 2],
    found: [f64; 2],
    /// The step is to be repeated with the temperatures that it leads to.
    repeats: bool,
    /// At its start: mean temperatures, and states of the bodies.
    start: [f64; 2],
    before: [([f64; MAX_STATES], [f64; PORTS]); 2],
    scales: [Scales; 2],
    tolerance: f64,
}

/// Propagators at the properties of a step.
#[derive(Clone, Debug)]
pub struct PropertyPropagators {
    nodes: [Nodes; 2],
    /// Of a body of constants beside one with a table, by the bits of the step size.
    constant: KeyedCache<u64, Option<Propagator>>,
    /// Those of the prepared step.
    pub step: Propagators,
    /// They are complete: not for the fast path alone.
    is_complete: bool,
}

fn bodies(operators: &LumpedOperators) -> [&BodyOperators; 2] {
    [&operators.punch, &operators.strip]
}

/// Step size of this number, s.
fn step_of(number: i32) -> f64 {
    (f64::from(number) / PER_OCTAVE).exp2()
}

impl Nodes {
    /// Memory for a body; none for one of constants.
    fn of(body: &BodyOperators) -> Nodes {
        let capacity = if body.properties.is_some() { CACHED } else { 0 };
        let empty = Node { propagator: None, at_rest: [1.0; MAX_FLASH_STATES] };
        Nodes {
            cache: KeyedCache::new(std::iter::repeat_n(empty, capacity)),
            latest: (0, [usize::MAX; 4]),
            between: Between { plain: [0.0; 4], by_step: [0.0; 4], scales: Scales::ONE, is_flux: [false; PORTS] },
        }
    }

    /// Finds the four step sizes around `step` (s) in the time of the constants at the properties `scales`, and the weights between them.
    fn find(&mut self, operators: &LumpedOperators, body: &BodyOperators, step: f64, scales: Scales) {
        let own = step * scales.pace;
        let place = PER_OCTAVE * own.log2();
        let base = place.floor();
        let first = base as i32 - 1;
        if self.latest.0 != first || self.latest.1[0] == usize::MAX {
            let slots = [0, 1, 2, 3].map(|node| {
                self.cache.get_or_compute(first + node, |made| {
                    let step = step_of(first + node);
                    made.propagator = body.heat.as_ref().map(|heat| Propagator::new(heat, step, &body.air));
                    if let Some(flash) = &operators.flash {
                        made.at_rest = decays_at_rest(flash, step);
                    }
                })
            });
            self.latest = (first, slots);
        }
        let x = place - base;
        let plain = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let mut is_flux = [true; PORTS];
        is_flux[Port::Ambient as usize] = false;
        is_flux[Port::Base as usize] = !matches!(body.far, ThermalBoundary::Held | ThermalBoundary::External);
        let by_step = [0, 1, 2, 3].map(|node| plain[node] * (own / step_of(first + node as i32)));
        self.between = Between { plain, by_step, scales, is_flux };
    }

    fn found(&self) -> [&Node; 4] {
        self.latest.1.map(|slot| &self.cache[slot])
    }
}

impl PropertyPropagators {
    /// Memory for those of these bodies; `None` where all properties are constants.
    pub fn of(operators: &LumpedOperators) -> Option<Box<PropertyPropagators>> {
        let follows = bodies(operators).iter().any(|body| body.properties.is_some());
        follows.then(|| {
            let nodes = bodies(operators).map(Nodes::of);
            let constant = KeyedCache::new(std::iter::repeat_n(None, CACHED_STEPS));
            Box::new(PropertyPropagators { nodes, constant, step: Propagators::empty(), is_complete: false })
        })
    }

    /// Prepares those of a step of `step` (s) at the properties `scales`, for the fast path alone unless `complete`.
    #[inline(always)]
    pub fn prepare(&mut self, operators: &LumpedOperators, step: f64, scales: [Scales; 2], complete: bool) {
        let is_same = self.step.step == step;
        self.step.step = step;
        self.step.scales = scales[1];
        let PropertyPropagators { nodes, constant, step: prepared, .. } = self;
        let owns = [&mut prepared.punch, &mut prepared.strip];
        for (side, ((nodes, own), body)) in nodes.iter_mut().zip(owns).zip(bodies(operators)).enumerate() {
            let Some(heat) = &body.heat else { continue };
            if body.properties.is_none() {
                // The same in every step of this length.
                if !is_same {
                    let slot = constant.get_or_compute(step.to_bits(), |made| {
                        *made = Some(Propagator::new(heat, step, &body.air));
                    });
                    own.clone_from(&constant[slot]);
                }
                continue;
            }
            nodes.find(operators, body, step, scales[side]);
            let [Some(a), Some(b), Some(c), Some(d)] = nodes.found().map(|node| node.propagator.as_ref()) else {
                continue;
            };
            own.get_or_insert_with(|| b.clone()).mix_surface([a, b, c, d], &nodes.between, heat.count);
        }
        let [_, of_strip] = &self.nodes;
        if operators.strip.properties.is_some() {
            let at_rest = of_strip.found().map(|node| &node.at_rest);
            self.step.at_rest = std::array::from_fn(|k| of_strip.between.of(at_rest.map(|row| row[k])));
        } else if let (Some(flash), false) = (&operators.flash, is_same) {
            self.step.at_rest = decays_at_rest(flash, step);
        }
        self.is_complete = false;
        if complete {
            self.complete(operators);
        }
    }

    /// Completes what [`PropertyPropagators::prepare`] made for the fast path.
    pub fn complete(&mut self, operators: &LumpedOperators) {
        if self.is_complete {
            return;
        }
        self.is_complete = true;
        let PropertyPropagators { nodes, step: prepared, .. } = self;
        let owns = [&mut prepared.punch, &mut prepared.strip];
        for ((nodes, own), body) in nodes.iter().zip(owns).zip(bodies(operators)) {
            if body.properties.is_some()
                && let ([Some(a), Some(b), Some(c), Some(d)], Some(heat), Some(own)) =
                    (nodes.found().map(|node| node.propagator.as_ref()), &body.heat, own)
            {
                own.mix_rest([a, b, c, d], &nodes.between, heat.count);
            }
        }
    }
}

impl PropertyStep {
    /// Before any step.
    pub fn new(operators: &LumpedOperators) -> PropertyStep {
        PropertyStep {
            middle: [0.0; 2],
            found: [0.0; 2],
            repeats: false,
            start: [0.0; 2],
            before: [([0.0; MAX_STATES], [0.0; PORTS]); 2],
            scales: [Scales::ONE; 2],
            tolerance: operators.scene.tolerance,
        }
    }

    /// Predicts the temperatures in the middle of a step of `step` (s) from `state`; returns the properties there.
    pub fn predict(&mut self, operators: &LumpedOperators, state: &LumpedState, step: f64) -> [Scales; 2] {
        for (side, (body, own)) in bodies(operators).into_iter().zip([&state.punch, &state.strip]).enumerate() {
            self.before[side] = (own.heat, own.received);
            if let (Some(_), Some(heat)) = (&body.properties, &body.heat) {
                let start = state.reference + body.mean_rise(heat, &own.heat, state.far[side]);
                self.start[side] = start;
                self.middle[side] = start + (0.5 * step * own.trend).clamp(-FARTHEST, FARTHEST);
            }
        }
        self.freeze(operators)
    }

    /// Properties of a repeated step.
    pub fn correct(&mut self, operators: &LumpedOperators) -> [Scales; 2] {
        self.middle = self.found;
        self.freeze(operators)
    }

    fn freeze(&mut self, operators: &LumpedOperators) -> [Scales; 2] {
        self.repeats = false;
        for (side, body) in bodies(operators).into_iter().enumerate() {
            self.scales[side] =
                body.properties.as_ref().map_or(Scales::ONE, |properties| properties.at(self.middle[side]));
        }
        self.scales
    }

    /// Whether the last attempt is to be repeated with [`PropertyStep::correct`].
    pub fn repeats(&self) -> bool {
        self.repeats
    }

    /// Error of the step by properties that are constant during it, in units of the tolerance: their difference from those at the temperatures
    /// which the step leads to, and a twelfth of the square of their change, each times the deviation of the contact temperature from
    /// the mean. `ends`: mean temperatures (K) at the end of the step; `contact`: the contact temperature there; `peak_rise` as in the
    /// state.
    pub fn error(&mut self, operators: &LumpedOperators, ends: [f64; 2], contact: f64, peak_rise: f64) -> f64 {
        let (mut missed, mut curved) = (0.0, 0.0);
        for (side, body) in bodies(operators).into_iter().enumerate() {
            let Some(properties) = &body.properties else { continue };
            let found = 0.5 * (self.start[side] + ends[side]);
            self.found[side] = found;
            let deviation = (contact - found).abs();
            let allowed = self.tolerance * maximum(peak_rise, deviation).max(1e-3);
            let enough = 0.1 * allowed / deviation.max(1e-9);
            missed += properties.change([self.middle[side], found], enough) * deviation / allowed;
            let change = properties.change([self.start[side], ends[side]], enough.sqrt());
            curved += change * change / 12.0 * deviation / allowed;
        }
        self.repeats = missed > 1.0 && curved <= 1.0;
        maximum(missed, curved)
    }

    /// After an accepted step of `step` (s): sets the mean temperatures to those by enthalpy, and counts the heat to the air.
    pub fn settle(&self, operators: &LumpedOperators, state: &mut LumpedState, step: f64) {
        let (reference, far) = (state.reference, state.far);
        for (side, (body, own)) in bodies(operators).into_iter().zip([&mut state.punch, &mut state.strip]).enumerate() {
            if let (Some(properties), Some(heat)) = (&body.properties, &body.heat) {
                self.settle_body(side, body, (properties, heat), own, [reference, far[side], step]);
            }
        }
    }

    fn settle_body(
        &self,
        side: usize,
        body: &BodyOperators,
        (properties, heat): (&Properties, &ReducedBody),
        state: &mut BodyState,
        [reference, far, step]: [f64; 3],
    ) {
        let (scales, start) = (self.scales[side], self.start[side]);
        let (states, received) = &self.before[side];
        let passed: [f64; PORTS] = std::array::from_fn(|port| state.received[port] - received[port]);
        if body.loses_to_air {
            let held = matches!(body.far, ThermalBoundary::Held | ThermalBoundary::External);
            let is_flux = [true, true, false, !held];
            let weighted: [f64; PORTS] =
                std::array::from_fn(|port| if is_flux[port] { passed[port] } else { passed[port] / scales.flux });
            // Integral of the flow: that of a state is (input - gain of the state)/rate, as the propagation is exact.
            let (by_state, by_port) = &body.lost_over_step;
            let entered: f64 = by_port.iter().zip(weighted).map(|(lost, input)| lost * input).sum();
            let kept: f64 = (0..heat.count).map(|k| by_state[k] * (state.heat[k] - states[k])).sum();
            state.lost += entered - scales.capacity() * kept;
        }
        let mean = reference + body.mean_rise(heat, &state.heat, far);
        let taken = if body.passes_heat {
            scales.capacity() * body.heat_capacity * (mean - start)
        } else {
            body.coverage * passed[Port::Contact as usize]
                + passed[Port::Cooling as usize]
                + passed[Port::Base as usize]
        };
        let mass = body.heat_capacity / properties.specific_heat();
        let end = properties.table.after(start, taken / mass);
        let uniform = (end - mean) / body.uniform_mean;
        for k in 0..heat.count {
            state.heat[k] += heat.stored.states[k] * uniform;
        }
        state.trend = (end - start) / step;
    }
}
