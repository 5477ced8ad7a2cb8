//! Growth of pressure perturbations over a run above the critical speed of thermoelastic instability.
//!
//! A perturbation that grows at the rate b (1/s) is larger by `exp(g)` at the end of a run, with the exponent
//!
//! ```text
//! g = integral of b dt over the time under load above the critical speed.
//! ```
//!
//! b is the upper bound of [`crate::fastest_growth`] over all waves between the contact's width and a 129th of it, and over all modes
//! of a strip between two faces. A short time above the critical speed changes little: near it, a wave takes longer to grow by a factor
//! e than it would take to fade without friction.
//!
//! Theory: docs/theory.md, section 7.5.

use crate::fastest_growth::FastestGrowth;
use crate::instability::{CriticalSpeed, FarFaces};
use numerics::maximum::maximum;
use scene::Scene;

/// Speeds of the table of rates, over the critical one: this many, in a geometric series up to this ratio. Beyond, rates grow with the
/// square of the speed.
const SPEED_RATIOS: usize = 32;
const FASTEST: f64 = 30.0;

/// Whether perturbations grow otherwise in a scene that is tuned from another one.
pub(crate) fn grows_otherwise(from: &Scene, tuned: &Scene) -> bool {
    let of = |scene: &Scene| (scene.conductance, scene.punch.far_boundary(), scene.strip.far_boundary());
    of(from) != of(tuned)
}

/// Growth of the perturbations of a scene.
#[derive(Clone, PartialEq, Debug)]
pub struct PerturbationGrowth {
    /// Critical speed of thermoelastic instability.
    pub critical: CriticalSpeed,
    /// Friction coefficient of the table, and its critical speed (m/s); 0: nothing grows at any speed.
    friction: f64,
    slowest: f64,
    /// Upper bounds of the growth rate (1/s) at the speeds of the table, over the square of the speed's ratio to the critical one:
    /// they hardly change.
    rates: Vec<f64>,
}

impl PerturbationGrowth {
    /// Growth in a scene.
    pub fn new(scene: &Scene) -> PerturbationGrowth {
        let critical = CriticalSpeed::new(scene);
        let friction = scene.friction_coefficient;
        let slowest = if critical.is_neutral() { 0.0 } else { critical.at(friction) };
        if slowest == 0.0 {
            return PerturbationGrowth { critical, friction, slowest, rates: Vec::new() };
        }
        // The mode that a contact line contains, and those of a strip between two faces beyond it.
        let FarFaces { own, others } = FarFaces::of(scene);
        let faces = std::iter::once(own).chain(others.iter().copied());
        // Shortest wave in half widths of the contact: the smallest cell that `solver.cells` = 0 gives. Shorter waves grow more slowly than
        // the longest ones wherever the bodies conduct as in machines.
        let bounds: Vec<_> = faces.map(|far| FastestGrowth::of_mode(scene, far, scene.width / 129.0)).collect();
        let modelled = critical.modelled(friction);
        let rate = |speed: f64| {
            let contained = if modelled > 0.0 && speed > modelled { 0 } else { 1 };
            bounds.iter().skip(contained).map(|bound| bound.fastest(friction, speed)).fold(0.0, maximum)
        };
        let ratios = (0..=SPEED_RATIOS).map(|i| FASTEST.powf(i as f64 / SPEED_RATIOS as f64));
        let rates = ratios.map(|ratio| rate(slowest * ratio) / (ratio * ratio)).collect();
        PerturbationGrowth { critical, friction, slowest, rates }
    }

    /// Upper bound of the growth rate (1/s) at this friction coefficient and sliding speed (m/s), whose critical speed is `critical`
    /// (m/s); 0 up to that, or where it is 0. Friction and speed count by their product, which heats.
    fn rate_beyond(&self, critical: f64, friction: f64, speed: f64) -> f64 {
        if self.rates.is_empty() || critical == 0.0 || speed <= critical {
            return 0.0;
        }
        let ratio = speed * friction / (self.slowest * self.friction);
        let at = (ratio.max(1.0).ln() / FASTEST.ln() * SPEED_RATIOS as f64).min(SPEED_RATIOS as f64);
        // The parabola through three nodes.
        let node = (at.round() as usize).clamp(1, SPEED_RATIOS - 1);
        let [before, here, after] = [node - 1, node, node + 1].map(|node| self.rates[node]);
        let part = at - node as f64;
        let change = 0.5 * (after - before) + 0.5 * part * (after - 2.0 * here + before);
        ratio * ratio * (here + part * change)
    }

    /// Exponent by which perturbations grow while the velocity changes linearly between these (m/s) within `step` s: Simpson's rule
    /// over the time above the critical speed, in either direction.
    pub(crate) fn over(&self, friction: f64, [start, end]: [f64; 2], step: f64) -> f64 {
        let fastest = start.abs().max(end.abs());
        if !self.critical.may_be_exceeded(friction, fastest) {
            return 0.0;
        }
        let critical = self.critical.at(friction);
        let rate = |part: f64| self.rate_beyond(critical, friction, (start + part * (end - start)).abs());
        if start == end {
            return step * rate(0.0);
        }
        let exponent = |sign: f64| {
            let crossing = ((sign * critical - start) / (end - start)).clamp(0.0, 1.0);
            let rises = sign * end > sign * start;
            let [from, to] = if rises { [crossing, 1.0] } else { [0.0, crossing] };
            if from == to {
                return 0.0;
            }
            (to - from) / 6.0 * (rate(from) + 4.0 * rate(0.5 * (from + to)) + rate(to))
        };
        step * (exponent(1.0) + exponent(-1.0))
    }
}

/// Exponent from which on growth matters: a perturbation as small as the tolerance becomes as large as the pressure itself.
pub(crate) fn noticeable(tolerance: f64) -> f64 {
    -tolerance.ln()
}
