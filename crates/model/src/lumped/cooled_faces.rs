//! Fluxes into the cooled faces of both bodies at both stages: Newton's method for their laws.
//!
//! A flux changes the temperatures of the faces of its own body, and by way of the heat exchanged in the contact those of the other.
//!
//! Theory: docs/theory.md, sections 6.8, 4.11.

use super::air::{FACES, PORTS_OF_FACES};
use super::point::{cooling_flux, cooling_slope};
use super::stage_body::{Around, StageBody};
use nalgebra::{SMatrix, SVector};
use numerics::factorization;
use numerics::maximum::maximum;

/// Unknowns: two bodies, their faces, two stages.
const UNKNOWNS: usize = 4 * FACES;

/// Newton step of the fluxes into the faces of punch and strip, with the fluxes that they exchange: `exchange` are those into the
/// punch at the stages per temperature of the strip above the punch, W/(m2 K). Returns the largest change of a temperature.
pub fn cool(bodies: [&mut StageBody; 2], exchange: Option<[[f64; 2]; 2]>, reference: f64, around: &[Around; 2]) -> f64 {
    let mut residual = SVector::<f64, UNKNOWNS>::zeros();
    let mut matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
    let mut exchanged = [[0.0; 2]; UNKNOWNS];
    let unknowns = || (0..UNKNOWNS).map(|k| (k, k / (2 * FACES), k / 2 % FACES, k % 2));
    if let Some(exchange) = exchange {
        for (k, side, face, stage) in unknowns() {
            if let (true, Some(own)) = (bodies[side].cools[face], bodies[side].propagator) {
                let gain = &own.contact.gain[PORTS_OF_FACES[face]];
                let towards = if side == 0 { -1.0 } else { 1.0 };
                let rise = [towards * gain[0][stage], towards * gain[2][stage]];
                exchanged[k] = exchange.map(|row| row[0] * rise[0] + row[1] * rise[1]);
            }
        }
    }
    for (k, side, face, stage) in unknowns() {
        let (body, Around { ambient, forced, neighbour }) = (&*bodies[side], &around[side]);
        let (true, Some(own)) = (body.cools[face], body.propagator) else { continue };
        let (air, observed, point) = (&own.air[face], &own.cooled[face], 2 * stage);
        let t = body.face(face, stage);
        let wanted = cooling_flux(air, reference, t, ambient[stage], forced[stage], neighbour[stage]);
        let slope = cooling_slope(air, reference, t, forced[stage]);
        residual[k] = wanted - body.flux[PORTS_OF_FACES[face]][stage];
        for (l, other_side, other, at) in unknowns().filter(|(_, side, face, _)| bodies[*side].cools[*face]) {
            let towards = if side == 0 { 1.0 } else { -1.0 };
            let by_exchange =
                towards * (observed.gain[0][point][0] * exchanged[l][0] + observed.gain[0][point][1] * exchanged[l][1]);
            let own = if other_side == side { observed.gain[PORTS_OF_FACES[other]][point][at] } else { 0.0 };
            matrix[(k, l)] += slope * (own + by_exchange);
        }
    }
    let Ok(step) = factorization::solve(&matrix, &residual) else { return f64::INFINITY };
    let mut change: f64 = 0.0;
    for (k, side, face, stage) in unknowns() {
        if !bodies[side].cools[face] {
            continue;
        }
        let port = PORTS_OF_FACES[face];
        bodies[side].flux[port][stage] += step[k];
        for stage in 0..2 {
            bodies[0].flux[0][stage] += exchanged[k][stage] * step[k];
            bodies[1].flux[0][stage] -= exchanged[k][stage] * step[k];
        }
        if let Some(own) = bodies[side].propagator {
            for observed in [&own.contact, &own.cooled[face]] {
                change = maximum(change, (step[k] * observed.gain[port][2][stage]).abs());
            }
        }
    }
    change
}
