//! Growth of pressure perturbations over a run: above the critical speed of thermoelastic instability the differences between levels
//! grow with them.
//!
//! A perturbation that grows at the rate b (1/s) is larger by `exp(g)` at the end of a run, with the exponent
//!
//! ```text
//! g = integral of b dt over the time above the critical speed.
//! ```
//!
//! b is the upper bound of [`crate::fastest_growth`] over all waves between the contact's width and its smallest cell. A short time
//! above the critical speed changes little: near it, a wave takes longer to grow by a factor e than it would take to fade without friction.
//!
//! Theory: docs/theory.md, section 8.2.

use super::MOST_IN_VAIN;
use super::trajectory::{NominalTrajectory, Segment};
use crate::fastest_growth::FastestGrowth;
use crate::instability::CriticalSpeed;
use numerics::maximum::maximum;
use scene::Scene;

/// Exponent from which on cells have to be seen to converge.
const NOTICEABLE: f64 = 1.0;

/// How much perturbations may grow over the nominal duration: what it takes for two numbers of cells to show that they converge.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Growth {
    /// By less than a factor of e.
    Little,
    /// By more. Either the finest lines agree within the tolerance, or their differences decrease.
    Noticeable,
    /// From the size of a rounding error to that of the solution: both, since each of them may be chance.
    FromRounding,
}

impl Growth {
    /// Growth by `exp(exponent)`.
    pub fn by(exponent: f64) -> Growth {
        if exponent >= -f64::EPSILON.ln() {
            Growth::FromRounding
        } else if exponent >= NOTICEABLE {
            Growth::Noticeable
        } else {
            Growth::Little
        }
    }
}

/// Growth of the perturbations of a scene.
#[derive(Clone, Debug)]
pub struct PerturbationGrowth {
    critical: CriticalSpeed,
    bound: FastestGrowth,
}

impl PerturbationGrowth {
    /// Growth in a scene with this critical speed.
    pub fn new(scene: &Scene, critical: &CriticalSpeed) -> PerturbationGrowth {
        let smallest = scene.width / MOST_IN_VAIN as f64;
        PerturbationGrowth { critical: critical.clone(), bound: FastestGrowth::new(scene, smallest) }
    }

    /// Upper bound of the growth rate (1/s) at this friction coefficient and sliding speed (m/s), of the modes that a contact line
    /// contains; 0 up to their critical speed.
    fn modelled_rate(&self, friction: f64, speed: f64) -> f64 {
        let critical = self.critical.modelled(friction);
        if !(critical > 0.0 && speed > critical) {
            return 0.0;
        }
        [0, 1].map(|body| self.bound.of_body(body, friction, speed)).into_iter().fold(0.0, maximum)
    }

    /// The same of all modes: infinite where only one grows that no level contains.
    pub fn rate(&self, friction: f64, speed: f64) -> f64 {
        if !self.critical.is_exceeded(friction, speed) {
            return 0.0;
        }
        let critical = self.critical.modelled(friction);
        if critical > 0.0 && speed > critical { self.modelled_rate(friction, speed) } else { f64::INFINITY }
    }

    /// Exponents at the friction coefficient of `scene`: the one that a comparison over the trajectory contains, and that of the modes
    /// of a contact line over the nominal duration, of which a reciprocating trajectory is a part. The first is infinite where what
    /// exceeds it has no meaning: a mode grows that no level contains, or waves may be at rest in neither body, for which the bound is
    /// far above the rate.
    pub fn over(&self, course: &NominalTrajectory, scene: &Scene) -> [f64; 2] {
        let exponent = |rate: &dyn Fn(f64) -> f64| {
            let of_segment = |segment: &Segment| {
                let [start, end] = segment.velocity;
                segment.duration * rate((0.5 * (start + end)).abs())
            };
            course.segments[..course.loaded].iter().map(of_segment).sum::<f64>()
        };
        let friction = scene.friction_coefficient;
        let modelled = exponent(&|speed| self.modelled_rate(friction, speed));
        let all = exponent(&|speed| self.rate(friction, speed));
        let contained = if all > 0.0 && self.bound.has_free_waves() { f64::INFINITY } else { all };
        [contained, course.repeats * modelled]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perturbations_grow_from_rounding_errors_beyond_an_exponent_of_36() {
        assert_eq!([0.0, 1.0_f64.next_down()].map(Growth::by), [Growth::Little; 2]);
        assert_eq!([1.0, 36.0].map(Growth::by), [Growth::Noticeable; 2]);
        assert_eq!([36.1, f64::INFINITY].map(Growth::by), [Growth::FromRounding; 2]);
    }
}
