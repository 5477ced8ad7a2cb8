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

/// Shortest wave in half widths of the contact: the smallest cell that `solver.cells` = 0 gives. Shorter waves grow more slowly than
/// the longest ones wherever the bodies conduct as in machines.
const SHORTEST: f64 = 129.0;

/// Growth of the perturbations of a scene.
#[derive(Clone, PartialEq, Debug)]
pub struct PerturbationGrowth {
    /// Critical speed of thermoelastic instability.
    pub critical: CriticalSpeed,
    /// Bounds for the mode that a contact line contains, and for those of a strip between two faces beyond it; none where nothing
    /// grows at any speed.
    bounds: Vec<FastestGrowth>,
}

impl PerturbationGrowth {
    /// Growth in a scene.
    pub fn new(scene: &Scene) -> PerturbationGrowth {
        let critical = CriticalSpeed::new(scene);
        let FarFaces { own, others } = FarFaces::of(scene);
        let faces = if critical.is_neutral() { &[][..] } else { others };
        let own = (!critical.is_neutral()).then_some(own);
        let bound = |far| FastestGrowth::of_mode(scene, far, scene.width / SHORTEST);
        let bounds = own.into_iter().chain(faces.iter().copied()).map(bound).collect();
        PerturbationGrowth { critical, bounds }
    }

    /// Upper bound of the growth rate (1/s) at this friction coefficient and sliding speed (m/s); 0 up to the critical speed.
    pub fn rate(&self, friction: f64, speed: f64) -> f64 {
        if !self.critical.is_exceeded(friction, speed) {
            return 0.0;
        }
        let modelled = self.modelled_rate(friction, speed);
        self.bounds.iter().skip(1).map(|bound| bound.fastest(friction, speed)).fold(modelled, maximum)
    }

    /// The same of the modes that a contact line contains; 0 up to their critical speed.
    fn modelled_rate(&self, friction: f64, speed: f64) -> f64 {
        let critical = self.critical.modelled(friction);
        if !(critical > 0.0 && speed > critical) {
            return 0.0;
        }
        self.bounds.first().map_or(0.0, |bound| bound.fastest(friction, speed))
    }

    /// Exponent by which perturbations grow while the velocity changes linearly between these (m/s) within `step` s: Simpson's rule
    /// over the time above the critical speed, in either direction.
    pub fn over(&self, friction: f64, [start, end]: [f64; 2], step: f64) -> f64 {
        let critical = self.critical.at(friction);
        let rate = |part: f64| self.rate(friction, (start + part * (end - start)).abs());
        if start == end {
            return step * rate(0.0);
        }
        let exponent = |sign: f64| {
            let crossing = ((sign * critical - start) / (end - start)).clamp(0.0, 1.0);
            let rises = sign * end > sign * start;
            let [from, to] = if rises { [crossing, 1.0] } else { [0.0, crossing] };
            (to - from) / 6.0 * (rate(from) + 4.0 * rate(0.5 * (from + to)) + rate(to))
        };
        step * (exponent(1.0) + exponent(-1.0))
    }
}

/// Exponent from which on growth matters: a perturbation as small as the tolerance becomes as large as the pressure itself.
pub fn noticeable(tolerance: f64) -> f64 {
    -tolerance.ln()
}
