//! The remainder as a table over the velocity.
//!
//! A knot costs as much as many steps, a scene needs few of them, and nothing is known of the velocities to come but the
//! nominal one. So knots are found when they are first asked for, in memory that is there from the start: a knot is a function
//! of its number alone, whoever asks first.

use super::remainder::{Blocks, Integrals, Remainder, Room};
use std::sync::{Mutex, OnceLock};

/// Distance of the knots in asinh(v/v0).
const SPACING: f64 = 0.35;
/// Knots of one interpolation.
const STENCIL: usize = 6;

/// Responses (temperature, distortion) at the knots `v = v0 sinh(0.35 k)`, k = 0, 1, ...; the opposite velocity by symmetry,
/// beyond the last knot the limit of fast sliding, v^(-1/2) (conduction straight down).
#[derive(Debug)]
pub struct VelocityTable {
    scale: f64,
    /// Temperature and distortion, the second without values where nothing expands.
    knots: Vec<OnceLock<[Blocks; 2]>>,
    remainder: Remainder,
    integrals: Integrals,
    workshop: Mutex<Workshop>,
}

/// What knots are made in, and of.
#[derive(Debug)]
struct Workshop {
    room: Room,
    /// One for every knot that is still to be found.
    spare: Vec<[Blocks; 2]>,
    /// Where the distortion goes that nobody asks for.
    unused: Blocks,
}

/// Weights of the knots for one velocity: index, weight, and whether it stands for the opposite velocity.
pub type Stencil = [(usize, f64, bool); STENCIL];

impl VelocityTable {
    /// `scale` is the velocity v0 below which nothing depends on the velocity, `fastest` where the limit is reached.
    pub fn new(remainder: Remainder, scale: f64, fastest: f64) -> VelocityTable {
        let half = remainder.shapes.half();
        let count = ((fastest / scale).asinh() / SPACING).ceil().max(1.0) as usize + 1 + STENCIL / 2;
        let integrals = remainder.integrals();
        let moving = if remainder.expansion.is_some() { half } else { 0 };
        let workshop = Workshop {
            room: Room::new(&remainder, &integrals),
            spare: (0..count).map(|_| [Blocks::zeros(half), Blocks::zeros(moving)]).collect(),
            unused: Blocks::zeros(half),
        };
        VelocityTable {
            scale,
            knots: (0..count).map(|_| OnceLock::new()).collect(),
            remainder,
            integrals,
            workshop: Mutex::new(workshop),
        }
    }

    /// Finds the knots that velocities up to `velocity` ask for.
    pub fn expect(&self, velocity: f64) {
        let furthest = self.stencil(velocity).into_iter().map(|(knot, ..)| knot).max().unwrap_or(0);
        (0..=furthest).for_each(|knot| {
            self.knot(knot);
        });
    }

    /// Both responses at a knot; takes no memory.
    fn knot(&self, knot: usize) -> &[Blocks; 2] {
        if let Some(known) = self.knots[knot].get() {
            return known;
        }
        // What a panic may have left behind is overwritten.
        let mut workshop = self.workshop.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // Somebody else may just have found it.
        if self.knots[knot].get().is_none()
            && let Some(mut found) = workshop.spare.pop()
        {
            let Workshop { room, unused, .. } = &mut *workshop;
            let expands = self.remainder.expansion.is_some();
            let velocity = self.scale * (knot as f64 * SPACING).sinh();
            let [warm, moved] = &mut found;
            self.remainder.at(velocity, &self.integrals, room, warm, if expands { moved } else { unused });
            if knot == 0 {
                // At rest the response is symmetric; what stood in for rest moves a little.
                found.iter_mut().for_each(Blocks::make_symmetric);
            }
            found[0].make_passive(&mut room.passive);
            let _ = self.knots[knot].set(found);
        }
        drop(workshop);
        self.knots[knot].get().expect("there is a spare one for every knot")
    }

    /// Velocity below which nothing depends on it, m/s.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Knots and weights at a velocity.
    pub fn stencil(&self, velocity: f64) -> Stencil {
        let last = self.knots.len() - 1 - STENCIL / 2;
        let mut position = (velocity.abs() / self.scale).asinh() / SPACING;
        let mut limit = 1.0;
        if position > last as f64 {
            limit = (self.scale * (last as f64 * SPACING).sinh() / velocity.abs()).sqrt();
            position = last as f64;
        }
        let base = (position as usize).min(last);
        let reversed = velocity < 0.0;
        let offset = position - base as f64;
        std::array::from_fn(|k| {
            let node = k as f64 - 2.0;
            let weight: f64 = (0..STENCIL)
                .filter(|&other| other != k)
                .map(|other| (offset - (other as f64 - 2.0)) / (node - (other as f64 - 2.0)))
                .product();
            let index = base as isize + k as isize - 2;
            (index.unsigned_abs(), limit * weight, reversed != (index < 0))
        })
    }

    /// Response at one knot of a stencil: temperature (0) or distortion (1), where the surface moves.
    pub fn response(&self, moving: usize, knot: usize) -> &Blocks {
        &self.knot(knot)[moving]
    }

    /// Number of knots.
    pub fn knots(&self) -> usize {
        self.knots.len()
    }
}
