//! State of the contact line, as it is saved.
//!
//! Theory: docs/theory.md, section 1.3.

use super::heat::state::HeatState;
use super::operators::{LineOperators, StripWear};
use crate::Inputs;
use contact::wear::line::{LineTrack, WarmStart};
use numerics::maximum::all_finite;

/// State of the contact line. Vectors have N values, one per cell.
#[derive(Clone, PartialEq, Debug)]
pub struct LineState {
    /// Worn depth of the punch, m.
    pub punch: Vec<f64>,
    /// Worn depth of the strip under the cells, m.
    pub strip: Vec<f64>,
    /// Worn track of the strip on a straight path; `None` otherwise.
    pub track: Option<LineTrack>,
    /// Thermal state, with resolved heat.
    pub heat: Option<HeatState>,
    /// Position of the punch on the strip, m.
    pub position: f64,
    /// Worn volumes per depth and punch (punch, strip), m2.
    pub volume: [f64; 2],
    /// Pressure at the end of the last step, Pa.
    pub pressure: Vec<f64>,
    /// Approach at the end of the last step, m.
    pub approach: f64,
    /// Tilt at the end of the last step, rad.
    pub tilt: f64,
    /// Whether pressure, approach and tilt are those of the end of the last step.
    pub current: bool,
    /// Inputs at the end of the last step; NaN: none, or a parameter has changed since then.
    pub end_inputs: Inputs,
    /// Largest magnitudes of velocity, load and angular velocity at the ends of the last step.
    pub scales: [f64; 3],
    /// Highest speed at the ends of a step so far, m/s.
    pub fastest: f64,
    /// Last sliding direction: the sign of the velocity between two events.
    pub direction: f64,
    /// Load per face that the lumped level takes from the cells ([`LineOperators::carried`]) at the end of the last step, N.
    pub carried: f64,
    /// Active set for the warm start of the contact solver.
    pub status: WarmStart,
    /// log2 of the number of parts of the last communication step.
    pub refinement: u8,
    /// Bits of `limit_reached` set so far.
    pub limits: u8,
    /// Running estimate of the relative error of the worn shape.
    pub error: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
}

impl LineState {
    /// Initial state: unworn; bodies with resolved heat at the reference temperature.
    pub(crate) fn new(operators: &LineOperators) -> LineState {
        let zeros = vec![0.0; operators.count()];
        LineState {
            punch: zeros.clone(),
            strip: zeros.clone(),
            track: (operators.strip_wear == StripWear::Track)
                .then(|| LineTrack::new(&operators.cells, operators.scene.nominal_stroke)),
            heat: (operators.heat.as_ref()).map(|bodies| HeatState::new(bodies, operators.count())),
            position: 0.0,
            volume: [0.0; 2],
            pressure: zeros,
            approach: 0.0,
            tilt: 0.0,
            current: false,
            end_inputs: Inputs::constant(f64::NAN),
            scales: [0.0; 3],
            fastest: 0.0,
            direction: 0.0,
            carried: 0.0,
            status: WarmStart::new(operators.count()),
            refinement: 0,
            limits: 0,
            error: 0.0,
            steps: 0,
            rejected: 0,
        }
    }

    /// Name of a quantity that is not finite, if any.
    pub(crate) fn not_finite(&self) -> Option<&'static str> {
        let contact = [self.approach, self.tilt, self.carried, self.position, self.volume[0], self.volume[1]];
        let rows = [
            ("the pressure", &self.pressure[..]),
            ("the worn depth of the punch", &self.punch),
            ("the worn depth of the strip", &self.strip),
            ("approach, tilt, load, position or worn volume", &contact),
        ];
        let own = rows.into_iter().find(|(_, numbers)| !all_finite(numbers)).map(|(name, _)| name);
        own.or_else(|| self.heat.as_ref().and_then(HeatState::not_finite))
    }
}
