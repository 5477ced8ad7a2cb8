//! Cache index of steps at a constant velocity: step-size control alternates between a few lengths, while a varying
//! velocity hardly recurs.
//!
//! Theory: docs/theory.md, section 6.4.

/// Length (s) and velocity (m/s) of a cached step, and the time of its last use.
#[derive(Clone, Copy, Debug)]
struct CachedStep {
    length: f64,
    velocity: f64,
    used: u64,
}

/// Steps in the cache slots from 1 on; slot 0 serves all others.
#[derive(Clone, Debug)]
pub struct SteadySteps {
    steps: Vec<CachedStep>,
    clock: u64,
}

impl SteadySteps {
    /// An empty index of this capacity.
    pub fn new(most: usize) -> SteadySteps {
        let none = CachedStep { length: f64::NAN, velocity: f64::NAN, used: 0 };
        SteadySteps { steps: vec![none; most], clock: 0 }
    }

    /// Cache slot of a step, and whether its response is stored there; if not, the caller stores it there.
    pub fn take(&mut self, length: f64, velocity: [f64; 2]) -> (usize, bool) {
        if velocity[0] != velocity[1] || self.steps.is_empty() {
            return (0, false);
        }
        self.clock += 1;
        let [velocity, _] = velocity;
        let is = |kept: &CachedStep| kept.length == length && kept.velocity.to_bits() == velocity.to_bits();
        let known = self.steps.iter().position(is);
        let oldest = || (0..self.steps.len()).min_by_key(|&place| self.steps[place].used);
        let place = known.or_else(oldest).unwrap_or(0);
        self.steps[place] = CachedStep { length, velocity, used: self.clock };
        (place + 1, known.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use crate::line::{cache_capacity, strip};
    use elasticity::Material;
    use scene::FarBoundary;

    /// Up to six alternating lengths, interspersed with steps of varying velocity and implicit Euler steps.
    #[test]
    fn steps_by_turns_keep_their_responses_to_the_bit() {
        let cells = Cells::graded(0.02, 9).unwrap();
        let material = Material::new(2e11, 0.3).unwrap();
        let expansion = strip::Expansion { coefficient: 1e-5, material, base: elasticity::Base::Bonded };
        let properties = StripProperties {
            conductivity: 50.0,
            capacity: 3.6e6,
            height: 0.02,
            base: FarBoundary::Held,
            convection: 30.0,
            path: SlidingPath::Stroke { stroke: 0.05, length: 0.0 },
            expansion: Some(expansion),
            lateral: None,
        };
        let resolution = Resolution { duration: 10.0, shortest: 1e-3, tolerance: 1e-2 };
        let body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut kept = body.clone();
        let mut places = std::collections::BTreeSet::new();
        for phase in 0..40_u32 {
            let length = 1e-3 * f64::from(1 << (phase % 6));
            let velocity = if phase % 5 == 4 { [0.1, 0.2] } else { [0.1; 2] };
            if phase % 7 == 3 {
                kept.prepare_euler(length, velocity);
            }
            kept.prepare(length, velocity);
            let mut fresh = body.clone();
            fresh.prepare(length, velocity);
            let (one, other) = (&kept.step, &fresh.step);
            for (one, other) in [(&one.first, &other.first), (&one.end, &other.end)] {
                assert_eq!(one.current_response().influence, other.current_response().influence, "{phase}");
                assert_eq!(one.current_response().weights(), other.current_response().weights(), "{phase}");
                assert_eq!(one.current_response().carried(), other.current_response().carried(), "{phase}");
                assert_eq!(one.factor, other.factor, "{phase}");
                assert_eq!(one.mean_weight, other.mean_weight, "{phase}");
            }
            places.insert((std::ptr::from_ref(kept.influence(Stage::End)) as usize, velocity == [0.1; 2]));
        }
        // One slot per length, and one for a varying velocity.
        assert!(cache_capacity(9) >= 6);
        assert_eq!(places.len(), 7);
    }
}
