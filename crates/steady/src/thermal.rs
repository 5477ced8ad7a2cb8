//! Steady states with heat: temperatures, heat flows and distortion in addition to pressure and shape.
//!
//! In unidirectional sliding a single stroke is solved: wear determines the pressure, the moving heat source the temperatures,
//! and elasticity with the distortion the shape. In reciprocating sliding the pressure changes within a half-stroke, since the
//! heat of one direction distorts the contact of the other; there the steady cycle of the contact line's own time steps is solved
//! for ([`model::line::cycle`]).
//!
//! Theory: docs/theory.md, section 9.4.

mod bodies;
mod cycle;
pub mod law;
mod partition;
mod unidirectional;

pub use cycle::{cycle_map, nominal_half_strokes};

use super::SteadyError;
use super::states::{Sliding, SteadyState, steady_state};
use bodies::{heat_leaves, with_steady_bodies};
use elasticity::{Cells, Compliance};
use model::line::cycle::MapResolution;
use numerics::maximum::maximum;
use scene::message::Number;
use scene::{Path, Scene};

/// Steady state of a scene with its heat.
#[derive(Clone, PartialEq, Debug)]
pub struct HotState {
    /// Pressure, shape and wear. In reciprocating sliding means over the half-strokes; the shape is that of the bodies unloaded
    /// and at the ambient temperature.
    pub state: SteadyState,
    /// Temperatures and heat flows.
    pub heat: SteadyHeat,
}

/// Heat of a steady state. Temperatures in K, N cell means; pairs are punch and strip.
#[derive(Clone, PartialEq, Debug)]
pub struct SteadyHeat {
    /// Heat of every stroke, as in the state.
    pub strokes: Vec<StrokeHeat>,
    /// Minimum and maximum over the cycle of the surface temperatures.
    pub range: [[Vec<f64>; 2]; 2],
    /// Minimum, mean and maximum over the cycle of the mean contact temperature.
    pub contact_temperature: [f64; 3],
    /// Maximum of `contact_temperature_max` over the cycle, see [`Hottest`](model::line::hottest::Hottest).
    pub highest: f64,
    /// Mean temperatures of the whole bodies, K; the ambient temperature for an insulator.
    pub body_temperature: [f64; 2],
    /// Heat flows, means over the cycle, all punches and faces.
    pub flows: HeatFlows,
    /// Convergence of the solution.
    pub accuracy: Accuracy,
}

/// Heat of a stroke.
#[derive(Clone, PartialEq, Debug)]
pub struct StrokeHeat {
    /// Mean temperatures of the surfaces, K.
    pub temperature: [Vec<f64>; 2],
    /// Mean fluxes into the bodies, W/m2.
    pub flux: [Vec<f64>; 2],
    /// Pressure just after the reversal and at the end of the stroke, Pa; twice the same in unidirectional sliding.
    pub pressure_at: [Vec<f64>; 2],
}

/// Heat flows, W.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct HeatFlows {
    /// Friction heat.
    pub friction: f64,
    /// Into the punch.
    pub punch: f64,
    /// Into the strip.
    pub strip: f64,
    /// Out of the punch's top.
    pub punch_top: f64,
    /// Out of the strip's base.
    pub strip_base: f64,
    /// To the ambient.
    pub ambient: f64,
}

/// Convergence of the solution of a steady state.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Accuracy {
    /// Number of cycles, or iterations, computed.
    pub iterations: usize,
    /// Last change of the shape over the elastic displacement under the mean pressure.
    pub shape: f64,
    /// Last change of the heat over the heat.
    pub heat: f64,
    /// Speed over the critical speed of thermoelastic instability; 0: there is none. Above 1 time stepping may depart from this
    /// state.
    pub speed_ratio: f64,
}

impl HotState {
    /// Warning that the state is above the critical speed of thermoelastic instability, where it exists and time integration departs
    /// from it.
    pub fn instability(&self) -> Option<String> {
        let (distance, duration) = (self.state.strokes.iter())
            .fold((0.0, 0.0), |(s, t), stroke| (s + stroke.velocity.abs() * stroke.duration, t + stroke.duration));
        let state =
            "the steady state is thermoelastically unstable, and a perturbed contact departs from it towards hot spots";
        instability(state, distance / duration, self.heat.accuracy.speed_ratio)
    }
}

/// `what`, where the ratio of a speed (m/s) to the critical one is above 1, with the numbers.
pub fn instability(what: &str, speed: f64, ratio: f64) -> Option<String> {
    let [speed_text, critical] = [speed, speed / ratio].map(Number);
    (ratio > 1.0).then(|| {
        format!("{what}: the sliding speed {speed_text} m/s is {ratio:.2} times the critical speed {critical} m/s")
    })
}

/// Steady state with heat of a scene under its nominal load; see [`steady_state`] for what exists.
///
/// Friction and wear depend on the temperature where they have tables. Distortion is measured from the ambient temperature.
/// External temperatures of faces are the ambient temperature. Conductivity and specific heat are those of the mean temperatures of the bodies.
///
/// # Errors
/// Those of [`steady_state`]; [`SteadyError::NoHeatLeaves`]; an iteration that does not converge.
pub fn hot_state(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    sliding: &Sliding,
) -> Result<HotState, SteadyError> {
    Ok(at_steady_properties(scene, cells, compliances, sliding)?.1)
}

/// Change of a property in an iteration over itself at which the iteration has converged.
const SAME_PROPERTIES: f64 = 1e-5;

/// Iterations after which the properties count as not found.
const MOST_ITERATIONS: usize = 50;

/// [`hot_state`], and the scene with its conductivities and specific heats there as constants: those of the mean temperatures of both bodies,
/// found by fixed-point iteration.
pub fn at_steady_properties(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    sliding: &Sliding,
) -> Result<(Scene, HotState), SteadyError> {
    let cold = steady_state(scene, cells, compliances, sliding)?;
    let speed = cold.strokes.iter().map(|stroke| stroke.velocity.abs()).fold(0.0, f64::max);
    heat_leaves(scene, speed)?;
    let mut own = scene.clone();
    let tables =
        [&mut own.punch, &mut own.strip].map(|body| body.properties.take().filter(|_| body.conductivity > 0.0));
    // Fresh material has the properties at its initial temperature.
    let fresh = scene.path == Path::Straight && scene.nominal_stroke == 0.0;
    let tables = [tables[0], tables[1].filter(|_| !fresh)];
    let mut change = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let lasting = with_steady_bodies(&own, speed);
        let hot = match *sliding {
            Sliding::Unidirectional { .. } => unidirectional::solve(&lasting, cells, compliances, &cold, sliding),
            Sliding::Reciprocating { strokes, speeds } => {
                cycle::solve(&lasting, cells, &cold, strokes, speeds, MapResolution::WITH_HEAT)
            }
        }?;
        change = 0.0;
        for (side, body) in [&mut own.punch, &mut own.strip].into_iter().enumerate() {
            let Some(table) = &tables[side] else { continue };
            let found = table.at(hot.heat.body_temperature[side]);
            for (old, new) in [&mut body.conductivity, &mut body.specific_heat].into_iter().zip(found) {
                change = maximum(change, (new / *old - 1.0).abs());
                *old = new;
            }
        }
        if change <= SAME_PROPERTIES {
            return Ok((own, hot));
        }
    }
    Err(SteadyError::Other(format!(
        "no steady state with heat found in {MOST_ITERATIONS} iterations for the properties: the last one changed conductivity or \
         specific heat by {change:.1e} of itself; simulate the scene to its steady state"
    )))
}

/// Whether a scene has a steady state with heat: steady sliding heats its contact, and the state can be computed.
pub fn has_hot_state(scene: &Scene) -> bool {
    let conducts = scene.punch.conductivity > 0.0 || scene.strip.conductivity > 0.0;
    conducts && scene.friction_coefficient > 0.0
}

/// Shape of the run-in punch of a scene whose heat feeds back: gap of the unloaded bodies at the ambient temperature, N cell
/// means, in m, minimum 0.
///
/// # Errors
/// Those of [`hot_state`], and [`SteadyError::OnlyStripWears`] where the punch would keep its shape.
pub fn hot_run_in_shape(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<Vec<f64>, SteadyError> {
    let hot = hot_state(scene, cells, compliances, &Sliding::nominal(scene))?;
    match hot.state.kind {
        super::states::SteadyKind::RunIn => Ok(hot.state.shape),
        _ => Err(SteadyError::OnlyStripWears),
    }
}

/// Gap of a run-in punch, as the contact line starts with it: with resolved `heat` that of [`hot_run_in_shape`] where friction heats the
/// contact, otherwise [`run_in_shape`](super::states::run_in_shape). It is the `RunIn` of the model.
///
/// # Errors
/// The text of what the shape is refused for.
pub fn run_in(scene: &Scene, heat: bool, cells: &Cells, compliances: &[Compliance; 2]) -> Result<Vec<f64>, String> {
    let shape = if heat && has_hot_state(scene) { hot_run_in_shape } else { super::states::run_in_shape };
    shape(scene, cells, compliances).map_err(|error| error.to_string())
}
