//! Responses are functions of step length and velocity alone, whatever is in the caches.

use super::{cooled_steel, expanding, steel, uneven, unit};
use crate::line::strip::{Resolution, SlidingPath, StripHeat, StripProperties};
use crate::line::{Stage, SurfaceInfluence, Surroundings, ThermalBody};
use crate::slab::Base;
use elasticity::Cells;
use std::sync::Arc;

#[test]
fn answers_do_not_depend_on_when_they_were_found() {
    let cells = Cells::graded(0.03, 9).unwrap();
    let resolution = Resolution { duration: 100.0, shortest: 0.1, tolerance: 1e-2, way: f64::INFINITY };
    for path in [SlidingPath::Unidirectional, SlidingPath::Stroke { stroke: 0.02, length: 0.0 }] {
        let properties = StripProperties { convection: 0.2, ..unit(0.5, Base::Held, path) };
        let strip = || StripHeat::new(&properties, &cells, &resolution).unwrap();
        let influence = |body: &mut StripHeat, velocity: f64| {
            body.prepare(0.3, [velocity; 2]);
            body.influence(Stage::End).clone()
        };
        let [mut planned, mut asked, mut fast] = [strip(), strip(), strip()];
        planned.expect(900.0);
        let velocities = [0.0, 3.0, -40.0, 800.0];
        let expected = velocities.map(|velocity| influence(&mut planned, velocity));
        // The fastest first, and computed by a copy that shares the table.
        let mut copy = fast.clone();
        influence(&mut copy, 800.0);
        for (velocity, expected) in velocities.into_iter().zip(&expected) {
            assert_eq!(&influence(&mut asked, velocity), expected, "{path:?} {velocity}");
            assert_eq!(&influence(&mut fast, velocity), expected, "{path:?} {velocity}");
        }
    }
}

#[test]
fn a_step_that_was_prepared_before_has_the_same_answer_to_the_bit() {
    let cells = Cells::graded(0.02, 9).unwrap();
    let properties = StripProperties {
        expansion: expanding(0.3, elasticity::Base::Bonded),
        ..steel(0.02, Base::Held, SlidingPath::Stroke { stroke: 0.05, length: 0.0 }, 30.0)
    };
    let resolution = Resolution { duration: 10.0, shortest: 0.02, tolerance: 1e-2, way: f64::INFINITY };
    let body = || StripHeat::new(&properties, &cells, &resolution).unwrap().for_few_steps(0.1);
    let steps = [(0.05, [0.1, 0.2]), (0.01, [0.2, -0.1]), (0.05, [0.1, 0.2]), (0.05, [0.1, 0.1]), (0.01, [0.2, -0.1])];
    let flux = uneven(&cells, 1);
    let air = Surroundings::default();
    let run = |body: &mut StripHeat| -> (Vec<f64>, Vec<SurfaceInfluence>) {
        let mut state = vec![0.0; body.states()];
        let mut influence = Vec::new();
        for (length, velocity) in steps {
            body.prepare(length, velocity);
            influence.extend([Stage::First, Stage::End].map(|stage| body.influence(stage).clone()));
            body.advance(&mut state, &air, &flux, &flux);
        }
        (state, influence)
    };
    // A copy has all of its steps in the cache; the other body has no cache.
    let mut first = body();
    let mut copy = first.clone();
    let mut other = body();
    Arc::get_mut(&mut other.operators).unwrap().kept = None;
    let found = run(&mut first);
    assert!(found.0.iter().any(|value| *value != 0.0));
    assert_eq!(found, run(&mut copy));
    assert_eq!(found, run(&mut other));
}

#[test]
fn the_way_back_has_the_answers_of_the_way_there_mirrored() {
    let cells = Cells::graded(0.02, 9).unwrap();
    let resolution = Resolution { duration: 10.0, shortest: 0.02, tolerance: 1e-2, way: f64::INFINITY };
    for path in [SlidingPath::Closed(0.3), SlidingPath::Stroke { stroke: 0.05, length: 0.0 }] {
        let properties = cooled_steel(path);
        let body = || StripHeat::new(&properties, &cells, &resolution).unwrap().for_few_steps(0.1);
        let (mut mirrored, mut found) = (body(), body());
        Arc::get_mut(&mut found.operators).unwrap().kept = None;
        let (flux, air) = (uneven(&cells, 1), Surroundings { ambient: 3.0, ..Surroundings::default() });
        let run = |body: &mut StripHeat| -> (Vec<f64>, Vec<f64>) {
            let (mut state, mut seen) = (vec![0.0; body.states()], Vec::new());
            for velocity in [[0.1, 0.2], [0.2, 0.0], [0.0, -0.2], [-0.2, 0.1], [-0.1, -0.2], [-0.2, 0.0]] {
                body.prepare(0.05, velocity);
                for stage in [Stage::First, Stage::End] {
                    let (mut warm, mut moved) = (vec![0.0; 9], vec![0.0; 9]);
                    body.free_response(&state, &air, stage, &flux, &mut warm, &mut moved);
                    let influence = body.influence(stage);
                    let scale = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    for values in [influence.temperature.as_slice(), influence.distortion.as_slice(), &warm, &moved] {
                        let largest = scale(values).max(f64::MIN_POSITIVE);
                        seen.extend(values.iter().map(|value| value / largest));
                    }
                }
                body.advance(&mut state, &air, &flux, &flux);
            }
            (state, seen)
        };
        let (there, other) = (run(&mut mirrored), run(&mut found));
        let largest = other.0.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(there.0.iter().zip(&other.0).all(|(one, other)| (one - other).abs() < 1e-11 * largest), "{path:?}");
        for (place, (one, other)) in there.1.iter().zip(&other.1).enumerate() {
            assert!((one - other).abs() < 1e-9, "{path:?} {place}: {one} {other}");
        }
        // Two of the six steps are mirror images of others.
        assert_eq!(mirrored.operators.kept.as_ref().unwrap().count(), 4, "{path:?}");
    }
}
