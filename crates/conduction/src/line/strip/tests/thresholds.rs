//! Steps at the thresholds between formulas of the weights, and one unit in the last place beside them.

use super::{cooled_steel, uneven};
use crate::line::strip::propagate::{LARGEST_DRIFT, LEAST_DRIFT};
use crate::line::strip::step::stage::SHORT_ROTATION;
use crate::line::strip::{Resolution, SlidingPath, StripHeat};
use crate::line::{Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use elasticity::Cells;

/// Temperatures at the end of a step.
fn temperatures(body: &mut StripHeat, state: &[f64], flux: &[f64], step: f64, velocity: [f64; 2]) -> Vec<f64> {
    let air = Surroundings::default();
    body.prepare(&Step::new(step, velocity));
    let (mut temperature, mut distortion) = (vec![0.0; flux.len()], vec![0.0; flux.len()]);
    body.free_response(state, &air, Stage::End, flux, &mut temperature, &mut distortion);
    let influence = &body.influence(Stage::End).temperature;
    for (i, t) in temperature.iter_mut().enumerate() {
        *t += influence.row(i).iter().zip(flux).map(|(gain, q)| gain * q).sum::<f64>();
    }
    temperature
}

#[test]
fn temperatures_are_finite_and_continuous_over_every_threshold() {
    let cells = Cells::graded(0.02, 9).unwrap();
    let resolution = Resolution { duration: 10.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-2 };
    for path in [SlidingPath::Unidirectional, SlidingPath::Stroke { stroke: 0.05, length: 0.0 }] {
        let mut body = StripHeat::new(&cooled_steel(path), &cells, &resolution).unwrap();
        let flux = uneven(&cells, 1);
        let mut state = vec![0.0; body.states()];
        temperatures(&mut body, &state, &flux, 0.1, [0.1; 2]);
        body.step(&mut state, &Surroundings::default(), &flux, &flux);
        let numbers = body.operators.numbers.clone();
        let steady = body.operators.steady;
        for number in [numbers[0], numbers[numbers.len() / 2], numbers[numbers.len() - 1]] {
            for step in [0.1, 0.05, 2.0] {
                // q dv h/8, from rest, through zero and about a velocity of little phase rotation; and q v h.
                let change = |drift: f64| 8.0 * drift / (number * step);
                let mut edges: Vec<[f64; 2]> = Vec::new();
                for drift in [LEAST_DRIFT, steady, LARGEST_DRIFT] {
                    edges.extend([[0.0, change(drift)], [-0.5 * change(drift), 0.5 * change(drift)]]);
                    edges.push([0.01, 0.01 + change(drift)]);
                }
                edges.push([SHORT_ROTATION / (number * step); 2]);
                for [from, to] in edges {
                    for sign in [1.0, -1.0] {
                        let at = |to: f64| [sign * from, sign * to];
                        let held = from == to;
                        let middle = temperatures(&mut body, &state, &flux, step, at(to));
                        let largest = middle.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
                        assert!(largest.is_finite(), "{path:?} {number} {step} {from} {to}");
                        for beside in [to.next_down(), to.next_up()] {
                            let velocity = if held { [sign * beside; 2] } else { at(beside) };
                            let other = temperatures(&mut body, &state, &flux, step, velocity);
                            for (t, middle) in other.iter().zip(&middle) {
                                let apart = (t - middle).abs() / largest;
                                assert!(apart < 2e-3, "{path:?} {number} {step} {velocity:?}: {t} {middle}");
                            }
                        }
                    }
                }
            }
        }
    }
}
