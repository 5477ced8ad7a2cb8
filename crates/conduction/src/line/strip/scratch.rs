//! Workspace of the strip's evaluations.
//!
//! Theory: docs/theory.md, section 4.5.

use super::mirrored::MirroredInfluence;
use super::operators::StripOperators;
use super::stage_response::RANK;

/// Preallocated vectors of the evaluations.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Total fluxes into the cells.
    pub first: Vec<f64>,
    pub end: Vec<f64>,
    /// Even and odd parts of fluxes, and of temperature and distortion.
    pub fold: [Vec<f64>; 2],
    pub response: [[Vec<f64>; 2]; 2],
    /// Workspace of the direct feedthrough at frozen state, of temperature and distortion, and of the total fluxes into the cells there.
    pub frozen: [MirroredInfluence; 2],
    pub total: Vec<f64>,
    /// Heat into the cells in reverse order.
    pub mirrored: Vec<f64>,
    /// Amplitudes of the modes, real and imaginary parts: fluxes of both stages, temperature, distortion.
    pub heat: [Vec<f64>; 2],
    pub heat_end: [Vec<f64>; 2],
    pub amplitude: [Vec<f64>; 2],
    pub moved: [Vec<f64>; 2],
    /// Temperatures of the cells, for the mean of the surface beside them.
    pub seen: Vec<f64>,
    /// Projected temperature that drives the Robin correction, by stage.
    pub projected: [[f64; RANK]; 2],
    /// Polynomial coefficients of the Robin correction by stage, W/m2.
    pub returned: [[f64; RANK]; 2],
}

impl Scratch {
    pub(crate) fn new(operators: &StripOperators) -> Scratch {
        let (count, half, waves) = (operators.widths.len(), operators.half, operators.waves.len());
        let halves = || [vec![0.0; half], vec![0.0; half]];
        let parts = || [vec![0.0; waves], vec![0.0; waves]];
        Scratch {
            first: vec![0.0; count],
            end: vec![0.0; count],
            fold: halves(),
            response: [halves(), halves()],
            frozen: [count, operators.lagged()].map(MirroredInfluence::new),
            total: vec![0.0; count],
            mirrored: vec![0.0; count],
            heat: parts(),
            heat_end: parts(),
            amplitude: parts(),
            moved: parts(),
            seen: vec![0.0; count],
            projected: [[0.0; RANK]; 2],
            returned: [[0.0; RANK]; 2],
        }
    }
}
