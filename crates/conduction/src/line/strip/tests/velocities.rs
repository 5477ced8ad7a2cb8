//! Responses are functions of step length and velocity alone, whatever the velocity table holds.

use super::{march, steel, unit};
use crate::line::strip::{Resolution, SlidingPath, StripHeat};
use crate::line::{Observed, Stage, Step, ThermalBody};
use elasticity::Cells;
use scene::FarBoundary;

#[test]
fn responses_do_not_depend_on_which_velocities_came_before() {
    let cells = Cells::graded(0.03, 9).unwrap();
    let resolution = Resolution { duration: 100.0, shortest: 0.1, travel: f64::INFINITY, tolerance: 1e-2 };
    for path in [SlidingPath::Unidirectional, SlidingPath::Stroke { stroke: 0.02, length: 0.0 }] {
        let mut properties = unit(0.5, FarBoundary::Held, path);
        properties.slab.surface_transfer = 0.2;
        let strip = || StripHeat::new(&properties, &cells, &resolution).unwrap();
        let influence = |body: &mut StripHeat, velocity: f64| {
            body.prepare(&Step::new(0.3, [velocity; 2]));
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

/// A layer that is thin against every cell conducts through its height alone: q h/K, at rest and while sliding slowly.
#[test]
fn a_layer_as_thin_as_is_accepted_conducts_through_its_height() {
    let cells = Cells::uniform(0.05, 65).unwrap();
    let resolution = Resolution { duration: 10.0, shortest: 0.01, travel: f64::INFINITY, tolerance: 1e-3 };
    let layer = |height: f64| steel(height, FarBoundary::Held, SlidingPath::Closed(0.5), 0.0);
    let thinnest = 0.1 / 2000.0;
    let mut strip = StripHeat::new(&layer(thinnest), &cells, &resolution).unwrap();
    for velocity in [0.0, 0.01] {
        let mut state = vec![0.0; strip.states()];
        let found = march(&mut strip, &mut state, 1.0, 5, |_| velocity);
        for t in &found[3..62] {
            assert!((t / (thinnest / 55.0) - 1.0).abs() < 1e-3, "{velocity}: {t:e}");
        }
        // One heated cell, 31 heights wide, loses heat past its edges.
        let own = strip.influence(Stage::End).temperature[(32, 32)] / (thinnest / 55.0);
        assert!(own > 0.96 && own < 1.0, "{velocity}: {own}");
    }
    let refused = StripHeat::new(&layer(thinnest.next_down()), &cells, &resolution).unwrap_err().to_string();
    assert!(refused.contains("strip height") && refused.contains("two thousandth"), "{refused}");
}
