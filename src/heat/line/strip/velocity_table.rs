//! The remainder as a table over the velocity.
//!
//! A knot costs as much as many steps, a scene needs few of them, and nothing is known of the velocities to come but the
//! nominal one. So knots are found when they are first asked for, in memory that is there from the start: a knot is a function
//! of its number alone, whoever asks first.

use super::remainder::{Blocks, Integrals, Remainder, Room};
use crate::contact::dense;
use nalgebra::DMatrix;
use std::sync::{Mutex, OnceLock};

/// Distance of the knots in asinh(v/v0); the error between them goes with its sixth power.
const SPACING: f64 = 0.35;
/// Knots of one interpolation.
const STENCIL: usize = 6;
/// Knots behind that of rest.
const BEHIND: usize = STENCIL / 2 - 1;

/// Responses on the cells (temperature, distortion) at the knots `v = v0 sinh(0.35 k)`, k = -2, -1, 0, ...; the opposite velocity
/// by symmetry, beyond the last knot the limit of fast sliding, v^(-1/2) (conduction straight down).
#[derive(Debug)]
pub struct VelocityTable {
    scale: f64,
    widths: Vec<f64>,
    knots: Vec<OnceLock<Knot>>,
    remainder: Remainder,
    integrals: Integrals,
    workshop: Mutex<Workshop>,
}

/// What knots are made in, and of.
#[derive(Debug)]
struct Workshop {
    room: Room,
    /// One for every knot that is still to be found.
    spare: Vec<Knot>,
    /// Both responses split by parity, and room for a block and a row of it.
    blocks: [Blocks; 2],
    turned: Vec<f64>,
}

/// Temperature and distortion by fluxes, N x N each, the second without values where nothing expands.
type Knot = [DMatrix<f64>; 2];

impl VelocityTable {
    /// `scale` is the velocity v0 below which nothing depends on the velocity, `fastest` where the limit is reached.
    pub fn new(remainder: Remainder, scale: f64, fastest: f64) -> VelocityTable {
        let (half, widths) = (remainder.shapes.half(), remainder.cells.widths().to_vec());
        let count = BEHIND + ((fastest / scale).asinh() / SPACING).ceil().max(1.0) as usize + 1 + STENCIL / 2;
        let integrals = remainder.integrals();
        let cells = widths.len();
        let moving = if remainder.expansion.is_some() { cells } else { 0 };
        let workshop = Workshop {
            room: Room::new(&remainder, &integrals),
            spare: (0..count).map(|_| [DMatrix::zeros(cells, cells), DMatrix::zeros(moving, moving)]).collect(),
            blocks: [Blocks::zeros(half), Blocks::zeros(half)],
            turned: vec![0.0; (half + 1) * half],
        };
        VelocityTable {
            scale,
            widths,
            knots: (0..count).map(|_| OnceLock::new()).collect(),
            remainder,
            integrals,
            workshop: Mutex::new(workshop),
        }
    }

    /// Finds the knots that velocities up to `velocity` ask for.
    pub fn expect(&self, velocity: f64) {
        let (base, _) = self.stencil(velocity);
        (0..base + STENCIL).for_each(|knot| {
            self.knot(knot);
        });
    }

    /// Both responses at a knot, counted from the first behind that of rest; takes no memory.
    fn knot(&self, knot: usize) -> &Knot {
        if let Some(known) = self.knots[knot].get() {
            return known;
        }
        let opposite = (knot < BEHIND).then(|| self.knot(2 * BEHIND - knot));
        // What a panic may have left behind is overwritten.
        let mut workshop = self.workshop.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // Somebody else may just have found it.
        if self.knots[knot].get().is_none()
            && let Some(mut found) = workshop.spare.pop()
        {
            match opposite {
                Some(opposite) => {
                    for (own, opposite) in found.iter_mut().zip(opposite) {
                        own.copy_from(opposite);
                        own.as_mut_slice().reverse();
                    }
                }
                None => self.find(knot - BEHIND, &mut workshop, &mut found),
            }
            let _ = self.knots[knot].set(found);
        }
        drop(workshop);
        self.knots[knot].get().expect("there is a spare one for every knot")
    }

    /// Finds the responses at knot `number`, 0 at rest.
    fn find(&self, number: usize, workshop: &mut Workshop, found: &mut Knot) {
        let Workshop { room, blocks, turned, .. } = workshop;
        let velocity = self.scale * (number as f64 * SPACING).sinh();
        let [warm, moved] = &mut *blocks;
        self.remainder.at(velocity, &self.integrals, room, warm, moved);
        if number == 0 {
            // At rest the response is symmetric; what stood in for rest moves a little.
            blocks.iter_mut().for_each(Blocks::make_symmetric);
        }
        blocks[0].make_passive(&mut room.passive);
        for (blocks, own) in blocks.iter().zip(found).filter(|(_, own)| !own.is_empty()) {
            blocks.unfold(&self.widths, 0.0, turned, own);
        }
    }

    /// Velocity below which nothing depends on it, m/s.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// First knot and weights for a speed.
    fn stencil(&self, velocity: f64) -> (usize, [f64; STENCIL]) {
        let last = self.knots.len() - 1 - STENCIL / 2 - BEHIND;
        let mut position = (velocity.abs() / self.scale).asinh() / SPACING;
        let mut limit = 1.0;
        if position > last as f64 {
            limit = (self.scale * (last as f64 * SPACING).sinh() / velocity.abs()).sqrt();
            position = last as f64;
        }
        let base = (position as usize).min(last);
        let offset = position - base as f64;
        let weights = std::array::from_fn(|k| {
            let node = k as f64 - BEHIND as f64;
            let weight: f64 = (0..STENCIL)
                .filter(|&other| other != k)
                .map(|other| (offset - (other as f64 - BEHIND as f64)) / (node - (other as f64 - BEHIND as f64)))
                .product();
            limit * weight
        });
        (base, weights)
    }

    /// Response at a velocity, N x N: temperature (`moving` 0), or distortion (1) where the surface moves.
    pub fn respond(&self, moving: usize, velocity: f64, response: &mut DMatrix<f64>) {
        let (base, weights) = self.stencil(velocity);
        let knots: [&[f64]; STENCIL] = std::array::from_fn(|k| self.knot(base + k)[moving].as_slice());
        dense::combine(response.as_mut_slice(), knots, weights);
        if velocity < 0.0 {
            // The cells are symmetric about x = 0.
            response.as_mut_slice().reverse();
        }
    }

    /// Adds the response to `flux` at a velocity; `room` is for as many numbers twice.
    pub fn add_response(
        &self,
        moving: usize,
        velocity: f64,
        flux: &[f64],
        room: &mut [Vec<f64>; 2],
        answer: &mut [f64],
    ) {
        let (base, weights) = self.stencil(velocity);
        let [weighted, sum] = room;
        sum.fill(0.0);
        for (k, weight) in weights.into_iter().enumerate() {
            weighted.iter_mut().zip(flux).for_each(|(own, q)| *own = weight * q);
            if velocity < 0.0 {
                weighted.reverse();
            }
            dense::multiply_add(self.knot(base + k)[moving].as_slice(), weighted, sum);
        }
        if velocity < 0.0 {
            sum.reverse();
        }
        answer.iter_mut().zip(&*sum).for_each(|(value, own)| *value += own);
    }

    /// Number of knots.
    pub fn knots(&self) -> usize {
        self.knots.len()
    }
}
