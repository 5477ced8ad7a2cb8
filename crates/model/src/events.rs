//! Events inside a communication step: sign changes of velocity and load.
//!
//! Theory: docs/theory.md, section 5.1.

use super::Inputs;
use numerics::scalar::Scalar;

/// Part of the step within which an event is assigned to the end of the step next to it. The inputs there differ from 0 by this
/// part of their change over the step, so rounding of an input that is intended to be 0 causes no event, in any unit.
pub(crate) const AT_END: f64 = 1e-9;

/// Load, relative to the nominal one, up to which the contact is open: rounding of an input that is intended to be 0.
const UNLOADED: f64 = 1e-12;

/// Load (N) on the contact at this one of an input, at this nominal load, N. Any load at all would close the contact, whose surfaces then
/// exchange heat.
#[inline]
pub(crate) fn load_on_contact<S: Scalar>(load: S, nominal: f64) -> S {
    if load.value() <= UNLOADED * nominal { S::from(0.0) } else { load }
}

/// Whether the load falls below 0 in a step from `inputs` to `end` by more than the rounding of an input that is intended to be 0, at
/// this nominal load, N.
pub(crate) fn load_is_negative(inputs: &Inputs, end: &Inputs, nominal: f64) -> bool {
    let [first, last] = [inputs.normal_load, end.normal_load];
    first.min(last) < -(AT_END * first.max(last)).max(UNLOADED * nominal)
}

/// Ends (s from the start of the step) of the pieces of a communication step between sign changes of velocity and load, and the
/// number of pieces.
pub(crate) fn edges(inputs: &Inputs, slopes: Option<&Inputs>, step: f64, mean_radius: f64) -> ([f64; 4], usize) {
    let mut edges = [0.0, step, step, step];
    let Some(slopes) = slopes else { return (edges, 1) };
    let mut count = 1;
    let velocity = [inputs, slopes].map(|of| of.velocity(mean_radius)).into();
    let crossings = [velocity, (inputs.normal_load, slopes.normal_load)];
    for (value, slope) in crossings {
        let time = -value / slope;
        if slope != 0.0 && time > AT_END * step && time < (1.0 - AT_END) * step {
            edges[count] = time;
            count += 1;
        }
    }
    edges[1..count].sort_by(f64::total_cmp);
    if count == 3 && edges[2] - edges[1] <= AT_END * step {
        // Both events coincide.
        count = 2;
    }
    edges[count] = step;
    (edges, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(velocity: [f64; 2], load: [f64; 2], step: f64) -> Vec<f64> {
        let (mut inputs, mut slopes) = (Inputs::constant(0.0), Inputs::constant(0.0));
        (inputs.sliding_velocity, inputs.normal_load, slopes.sliding_velocity, slopes.normal_load) =
            (velocity[0], load[0], velocity[1], load[1]);
        let (edges, count) = edges(&inputs, Some(&slopes), step, 0.0);
        edges[..=count].to_vec()
    }

    #[test]
    fn an_event_next_to_the_end_of_a_step_is_at_it() {
        let edge = AT_END * 0.5;
        for value in [edge.next_down(), edge, edge.next_up(), 0.0, -0.0, 1e-300, -1e-16, 1e-16] {
            let pieces = at([-value, 1.0], [1.0, 0.0], 0.5).len() - 1;
            assert_eq!(pieces, if value > edge { 2 } else { 1 }, "{value:e}");
        }
        let edge = (1.0 - AT_END) * 0.5;
        for value in [edge.next_down(), edge, edge.next_up(), 0.5, 0.5_f64.next_up()] {
            let pieces = at([-value, 1.0], [1.0, 0.0], 0.5).len() - 1;
            assert_eq!(pieces, if value < edge { 2 } else { 1 }, "{value}");
        }
        // Coinciding events are one; distinct ones are two, in their order, in any unit.
        for unit in [1.0, 1e-9, 3.6, 1e12] {
            assert_eq!(at([-unit, 2.0 * unit], [-3.0 * unit, 6.0 * unit], 1.0), [0.0, 0.5, 1.0]);
            assert_eq!(at([-unit, 2.0 * unit], [-unit, 4.0 * unit], 1.0), [0.0, 0.25, 0.5, 1.0]);
        }
        assert_eq!(at([0.0, 0.0], [0.0, 0.0], 1.0), [0.0, 1.0]);
    }
}
