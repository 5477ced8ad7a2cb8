//! Course of a run so far: what the error of its plan depends on.
//!
//! Theory: docs/theory.md, section 8.2.

use super::UNKNOWN;
use super::distance::LevelDistance;
use numerics::maximum::maximum;

/// Ratio of load, speed and friction work to the nominal ones up to which the error of the nominal trajectory is that of the run:
/// more than the largest speed of a sinusoid over its mean.
const PLANNED: f64 = 2.0;

/// Ratio up to which the error is known, and factor of growth of a perturbation. From [`PLANNED`] on it is extrapolated in proportion:
/// the levels differ by the uneven pressure that the heat causes, which to first order is proportional to the heat.
const KNOWN: f64 = 10.0;

/// Least part of the planned error that a run gentler than nominal has at the lumped level: a part of the difference of the levels is that of the
/// flash temperatures, which does not depend on how far the bodies bow.
const LEAST_PART: f64 = 0.25;

/// Fraction of the largest load so far below which the load counts as released.
const RELEASED: f64 = 0.5;

/// Course of a run so far.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Course {
    /// Largest ratio of speed, load and friction work so far to the nominal ones.
    pub severity: f64,
    /// Largest ratio of temperature rise to load so far, under load, over that of the nominal trajectory; 1 at most.
    pub relative_bow: f64,
    /// Exponent by which perturbations may have grown above the critical speed; see [`super::growth`].
    pub growth: f64,
    /// Largest load so far, N.
    pub largest_load: f64,
    /// The load has been released: the levels differ more then than under load.
    pub is_released: bool,
    /// Distance of a contact line from the lumped level in parallel, where that is advanced; see [`super::parallel`].
    pub distance: Option<LevelDistance>,
}

impl Course {
    /// Takes a load (N).
    pub fn follow_load(&mut self, load: f64) {
        self.is_released |= self.releases(load);
        self.largest_load = maximum(self.largest_load, load);
    }

    /// Whether a load (N) counts as released.
    pub fn releases(&self, load: f64) -> bool {
        load < RELEASED * self.largest_load
    }

    /// Exponent of growth beyond the one that the plan contains.
    fn excess(&self, planned_growth: f64) -> f64 {
        if self.growth <= planned_growth { 0.0 } else { self.growth - planned_growth }
    }

    /// Whether the error of the plan is known; `planned_growth`: exponent of growth that the plan contains.
    pub fn is_known(&self, planned_growth: f64) -> bool {
        self.severity <= KNOWN && self.excess(planned_growth) <= KNOWN.ln()
    }

    /// Whether the run exceeds the conditions of the plan.
    pub fn is_beyond(&self, planned_growth: f64) -> bool {
        self.severity > PLANNED || self.excess(planned_growth) > PLANNED.ln()
    }

    /// Error of a level, from that of the plan. `planned`: errors in the plan under load and with the load released; `uniform`: the same
    /// of the lumped level.
    ///
    /// Where the lumped level is advanced in parallel, the error is in proportion to the distance from it, under load and with the load
    /// released apart. Otherwise it is in proportion to the conditions beyond those of the plan, and within them to how uneven the heat
    /// makes the pressure: the bodies bow in proportion to their temperature, and are flattened in proportion to the load.
    pub fn level_error(&self, planned_growth: f64, planned: [f64; 2], uniform: [f64; 2]) -> f64 {
        let by_conditions = |planned: f64| match self.severity / PLANNED {
            beyond if beyond > 1.0 => beyond,
            _ if planned >= UNKNOWN => 1.0,
            _ => self.relative_bow.clamp(LEAST_PART, 1.0),
        };
        let in_phase = |is_released: bool| {
            let phase = usize::from(is_released);
            match self.distance {
                Some(distance) if uniform[phase] > 0.0 => planned[phase] * distance.most(is_released) / uniform[phase],
                _ => planned[phase] * by_conditions(planned[phase]),
            }
        };
        let error = match (self.is_released, self.distance) {
            (true, Some(_)) => maximum(in_phase(false), in_phase(true)),
            (is_released, _) => in_phase(is_released),
        };
        error * self.excess(planned_growth).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(severity: f64, growth: f64) -> Course {
        Course { severity, growth, relative_bow: 1.0, ..Course::default() }
    }

    #[test]
    fn within_the_plan_the_error_of_the_lumped_level_is_in_proportion_to_temperature_over_load() {
        let error = |severity: f64, relative_bow: f64| {
            Course { relative_bow, ..after(severity, 0.0) }.level_error(0.0, [0.5, 0.9], [0.1; 2])
        };
        assert_eq!([0.0, 0.1, 0.5, 1.0].map(|bow| error(1.0, bow)), [0.125, 0.125, 0.25, 0.5]);
        assert_eq!(error(5.0, 0.1), 1.25);
        // One that is not known stays so.
        let unknown = Course { relative_bow: 0.1, ..after(1.0, 0.0) };
        assert_eq!(unknown.level_error(0.0, [UNKNOWN; 2], [0.0; 2]), UNKNOWN);
        // Beside a contact line it is measured instead.
        let mut distance = LevelDistance::default();
        distance.follow([1.0, 100.0, 1.0], [1.0, 95.0, 1.0], false);
        let beside = Course { relative_bow: 0.1, distance: Some(distance), ..after(1.0, 0.0) };
        assert_eq!(beside.level_error(f64::INFINITY, [1.0, 8.0], [0.1, 0.4]), 0.5);
    }

    #[test]
    fn beyond_twice_the_nominal_conditions_the_error_is_in_proportion_up_to_ten_times() {
        let error = |severity: f64| after(severity, 0.0).level_error(0.0, [1.0, 9.0], [0.1; 2]);
        assert_eq!([0.0, 1.0, 2.0, 5.0].map(error), [1.0, 1.0, 1.0, 2.5]);
        let released = Course { is_released: true, ..after(5.0, 0.0) };
        assert_eq!(released.level_error(0.0, [1.0, 9.0], [0.1; 2]), 22.5);
        assert!(!after(2.0, 0.0).is_beyond(0.0) && after(2.0_f64.next_up(), 0.0).is_beyond(0.0));
        assert!(after(10.0, 0.0).is_known(0.0) && !after(10.0_f64.next_up(), 0.0).is_known(0.0));
    }

    #[test]
    fn the_error_grows_with_perturbations_up_to_ten_times() {
        let double = 2.0_f64.ln();
        let error = |course: Course, planned: f64| course.level_error(planned, [1.0; 2], [0.1; 2]);
        assert_eq!(error(after(4.0, double), 0.0), 4.0);
        assert_eq!([double, f64::INFINITY].map(|planned| error(after(1.0, double), planned)), [1.0; 2]);
        assert!(!after(1.0, double).is_beyond(0.0) && after(1.0, 1.01 * double).is_beyond(0.0));
        assert!(after(1.0, 9.9_f64.ln()).is_known(0.0) && !after(1.0, 10.1_f64.ln()).is_known(0.0));
        assert!(!after(1.0, f64::INFINITY).is_known(0.0));
    }

    #[test]
    fn the_error_is_in_proportion_to_the_distance_from_the_lumped_level_in_parallel() {
        let mut distance = LevelDistance::default();
        distance.follow([1.0, 100.0, 1.0], [1.0, 95.0, 1.0], false);
        let mut course = Course { distance: Some(distance), ..after(4.0, 2.0_f64.ln()) };
        let planned = [1.0, 8.0];
        assert_eq!(course.level_error(f64::INFINITY, planned, [0.1, 0.4]), 0.5);
        assert_eq!(course.level_error(0.0, planned, [0.1, 0.4]), 1.0);
        assert_eq!(course.level_error(f64::INFINITY, planned, [0.0; 2]), 2.0);
        // A release adds what both levels are apart then.
        course.is_released = true;
        assert_eq!(course.level_error(f64::INFINITY, planned, [0.1, 0.4]), 0.5);
        distance.follow([1.0, 50.0, 1.0], [1.0, 40.0, 1.0], true);
        course.distance = Some(distance);
        assert_eq!(course.level_error(f64::INFINITY, planned, [0.1, 0.4]), 2.0);
    }

    #[test]
    fn a_load_is_released_below_half_of_the_largest() {
        let mut course = Course::default();
        for (load, released) in [(0.0, false), (10.0, false), (5.0, false), (20.0, false), (9.0, true), (30.0, true)] {
            course.follow_load(load);
            assert_eq!(course.is_released, released, "{load}");
        }
        assert_eq!(course.largest_load, 30.0);
    }
}
