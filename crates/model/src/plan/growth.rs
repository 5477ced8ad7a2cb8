//! Growth of pressure perturbations over the planned run: above the critical speed of thermoelastic instability the differences between
//! levels grow with them.
//!
//! Theory: docs/theory.md, section 8.2.

use super::trajectory::{NominalTrajectory, Segment};
use crate::growth::PerturbationGrowth;
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

/// Upper bound of the growth rate (1/s) at this friction coefficient and sliding speed (m/s): infinite where only a mode grows that no
/// level contains.
pub fn rate(growth: &PerturbationGrowth, friction: f64, speed: f64) -> f64 {
    if !growth.critical.is_exceeded(friction, speed) {
        return 0.0;
    }
    let critical = growth.critical.modelled(friction);
    if critical > 0.0 && speed > critical { growth.modelled_rate(friction, speed) } else { f64::INFINITY }
}

/// Exponents at the friction coefficient of `scene`: the one that a comparison over the trajectory contains, and that of the modes
/// of a contact line over the nominal duration, of which a reciprocating trajectory is a part. The first is infinite where what
/// exceeds it has no meaning: a mode grows that no level contains, or waves may be at rest in neither body, for which the bound is
/// far above the rate.
pub fn over(growth: &PerturbationGrowth, course: &NominalTrajectory, scene: &Scene) -> [f64; 2] {
    let exponent = |rate: &dyn Fn(f64) -> f64| {
        let of_segment = |segment: &Segment| {
            let [start, end] = segment.velocity;
            segment.duration * rate((0.5 * (start + end)).abs())
        };
        course.segments[..course.loaded].iter().map(of_segment).sum::<f64>()
    };
    let friction = scene.friction_coefficient;
    let modelled = exponent(&|speed| growth.modelled_rate(friction, speed));
    let all = exponent(&|speed| rate(growth, friction, speed));
    let contained = if all > 0.0 && growth.has_free_waves() { f64::INFINITY } else { all };
    [contained, course.repeats * modelled]
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
