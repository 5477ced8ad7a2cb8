//! The remainder as a table over the velocity.

use super::remainder::{Blocks, Remainder};

/// Distance of the knots in asinh(v/v0).
const SPACING: f64 = 0.35;
/// Knots of one interpolation.
const STENCIL: usize = 6;

/// Responses (temperature, distortion) at the knots `v = v0 sinh(0.35 k)`, k = 0, 1, ...; the opposite velocity by symmetry,
/// beyond the last knot the limit of fast sliding, v^(-1/2) (conduction straight down).
#[derive(Clone, PartialEq, Debug)]
pub struct VelocityTable {
    scale: f64,
    temperature: Vec<Blocks>,
    distortion: Vec<Blocks>,
}

/// Weights of the knots for one velocity: index, weight, and whether it stands for the opposite velocity.
pub type Stencil = [(usize, f64, bool); STENCIL];

impl VelocityTable {
    /// `scale` is the velocity v0 below which nothing depends on the velocity, `fastest` where the limit is reached.
    pub fn new(remainder: &Remainder, half: usize, scale: f64, fastest: f64) -> VelocityTable {
        let intervals = ((fastest / scale).asinh() / SPACING).ceil().max(1.0) as usize;
        let integrals = remainder.integrals();
        let expands = remainder.expansion.is_some();
        let (mut temperature, mut distortion) = (Vec::new(), Vec::new());
        let mut unused = Blocks::zeros(half);
        for knot in 0..=intervals + STENCIL / 2 {
            let velocity = scale * (knot as f64 * SPACING).sinh();
            let (mut warm, mut moved) = (Blocks::zeros(half), Blocks::zeros(half));
            remainder.at(velocity, &integrals, &mut warm, if expands { &mut moved } else { &mut unused });
            if knot == 0 {
                // At rest the response is symmetric; what stood in for rest moves a little.
                warm.make_symmetric();
                moved.make_symmetric();
            }
            warm.make_passive();
            temperature.push(warm);
            if expands {
                distortion.push(moved);
            }
        }
        VelocityTable { scale, temperature, distortion }
    }

    /// Knots and weights at a velocity.
    pub fn stencil(&self, velocity: f64) -> Stencil {
        let last = self.temperature.len() - 1 - STENCIL / 2;
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

    /// Temperature response at one knot of a stencil.
    pub fn temperature(&self, knot: usize) -> &Blocks {
        &self.temperature[knot]
    }

    /// Distortion response at one knot of a stencil; `None` where nothing expands.
    pub fn distortion(&self, knot: usize) -> Option<&Blocks> {
        self.distortion.get(knot)
    }

    /// Number of knots.
    pub fn knots(&self) -> usize {
        self.temperature.len()
    }
}
