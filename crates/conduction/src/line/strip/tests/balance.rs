//! Consistency of stages, states and heat balance, and the paths of heat loss.

use super::{expanding, march, mean, steel, uneven};
use crate::line::strip::{Resolution, SlidingPath, StripHeat};
use crate::line::tests::{at_stage, in_two_parts};
use crate::line::{
    Boundary, FaceInfluence, FrozenState, GAMMA, Observed, SingleStep, Stage, Step, Surroundings, ThermalBody,
};
use elasticity::Cells;
use scene::FarBoundary;

#[test]
fn what_a_stage_says_is_what_the_state_then_shows_and_heat_is_conserved() {
    for (base, path, convection, cooling) in [
        (FarBoundary::Held, SlidingPath::Closed(0.3), 0.0, 0.0),
        (FarBoundary::Insulated, SlidingPath::Stroke { stroke: 0.01, length: 0.0 }, 3000.0, 0.0),
        (FarBoundary::Convecting(500.0), SlidingPath::Closed(0.1), 2000.0, -700.0),
        (FarBoundary::Convecting(500.0), SlidingPath::Unidirectional, 1000.0, -300.0),
    ] {
        let mut properties = steel(0.02, base, path, convection);
        properties.expansion = expanding(0.3, elasticity::Base::Bonded);
        let cells = Cells::graded(0.02, 12).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        // A prescribed temperature, or the flux of forced convection.
        let held = base == FarBoundary::Held;
        let [before, far] = if held { [1.0, 2.0] } else { [0.5 * cooling, 0.4 * cooling] };
        let air = Surroundings::linear(
            Boundary { cooling: 0.7 * cooling, ambient: 4.0, far: before },
            Boundary { cooling, ambient: 5.0, far },
        );
        let (mut received, mut largest) = (0.0, 0.0f64);
        for index in 0..40 {
            let velocity = [0.05 * (index as f64 * 0.3).sin(), 0.05 * (index as f64 * 0.3 + 0.3).sin()];
            let step = if index % 3 == 0 { 0.02 } else { 0.3 };
            body.prepare(&Step::new(step, velocity));
            let (first, end) = (uneven(&cells, 2 * index), uneven(&cells, 2 * index + 1));
            let (temperature, distortion, faces) =
                at_stage(&mut body, &state, &air, (Stage::End, held), [&first, &end]);
            body.step(&mut state, &air, &first, &end);
            let gamma = GAMMA;
            received += step * ((1.0 - gamma) * cells.integral(&first) + gamma * cells.integral(&end));
            let at = FrozenState { state: &state, surroundings: &air, flux: &end, velocity: velocity[1] };
            let (shown, moved, cooled) = (at.temperature(&body), at.distortion(&body), at.faces(&body));
            for i in 0..12 {
                largest = largest.max((temperature[i] - shown[i]).abs() / shown[i].abs());
                largest = largest.max((distortion[i] - moved[i]).abs() / moved[i].abs());
            }
            for face in 0..if held { 1 } else { 2 } {
                largest = largest.max((faces[face] - cooled[face]).abs() / mean(&cells, &shown).abs());
            }
        }
        // The influence matrices of a varying velocity are interpolated between velocities.
        assert!(largest < 1e-4, "{base:?}: {largest:e}");
        let account = body.account(&state);
        let balance = account.received - account.stored - account.ambient - account.far;
        assert!((account.received - received).abs() < 1e-12 * received && balance.abs() < 1e-9 * received);
        if base == FarBoundary::Insulated {
            assert!(account.far.abs() < 1e-9 * received, "{}", account.far / received);
        }
    }
}

#[test]
fn cooling_that_falls_over_a_step_falls_over_its_parts() {
    let stroke = SlidingPath::Stroke { stroke: 0.01, length: 0.0 };
    for (path, convection) in [
        (SlidingPath::Closed(0.3), 0.0),
        (SlidingPath::Closed(0.06), 400.0),
        (stroke, 0.0),
        (SlidingPath::Unidirectional, 0.0),
    ] {
        let properties = steel(0.02, FarBoundary::Convecting(500.0), path, convection);
        let cells = Cells::graded(0.02, 12).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let (mut state, flux) = (vec![0.0; body.states()], vec![1e5; 12]);
        body.uniform(20.0, &mut state);
        let mut parts = state.clone();
        let (step, velocity) = (2.0, [0.01; 2]);
        let start = Boundary { cooling: -1e4, ambient: 9.0, far: 2e3 };
        let end = Boundary { cooling: -4e4, ambient: 5.0, far: 9e3 };
        let air = Surroundings::linear(start, end);
        body.prepare(&Step::new(step, velocity));
        let early = at_stage(&mut body, &state, &air, (Stage::First, false), [&[0.0; 12], &flux]);
        let late = at_stage(&mut body, &state, &air, (Stage::End, false), [&flux; 2]);
        // The mean temperature of the surface beside the contact per flux there, over that per flux into the whole contact.
        let mut influence = FaceInfluence::new(12);
        body.face_influence(Stage::End, 0, &mut influence, &mut body.workspace());
        let rise = influence.faces[0];
        assert!(rise > 0.0 && influence.mean > 0.0, "{path:?}: {influence:?}");
        body.step(&mut state, &air, &flux, &flux);
        for (part, around) in [GAMMA, 1.0 - GAMMA].into_iter().zip(in_two_parts(start, end)) {
            body.prepare(&Step::new(part * step, velocity));
            let (shown, _, faces) = at_stage(&mut body, &parts, &around, (Stage::End, false), [&flux; 2]);
            body.step(&mut parts, &around, &flux, &flux);
            let (other, _, others) = if part == GAMMA { &early } else { &late };
            let apart = shown.iter().zip(other).chain(faces.iter().zip(others)).map(|(a, b)| (a - b).abs());
            let apart = apart.fold(0.0, f64::max);
            // The Robin correction starts from rest in the whole step and from its rate in the second part.
            let hottest = shown.iter().fold(0.0, |most: f64, t| most.max((t - 20.0).abs()));
            let bound = if convection > 0.0 { 1e-2 * hottest } else { 2e-3 * 3e4 * rise };
            assert!(apart < bound, "{path:?}: {shown:?} {other:?} {faces:?} {others:?}");
        }
        // Up to the interpolation of responses between velocities.
        let lost = body.account(&state).ambient;
        let tolerance = if convection > 0.0 { 1e-2 } else { 1e-9 };
        let other = body.account(&parts).ambient;
        assert!((other / lost - 1.0).abs() < tolerance, "{path:?}: {other} and {lost}");
        let end = FrozenState { state: &state, surroundings: &air, flux: &flux, velocity: velocity[1] };
        let cooled = end.faces(&body);
        let apart = (0..2).map(|face| (cooled[face] - late.2[face]).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3 * 3e4 * rise, "{path:?}: {cooled:?} {late:?}");
    }
}

#[test]
fn faces_and_cells_are_reciprocal_in_reversed_sliding() {
    // The mean temperature of the free surface per flux into a cell is that of the cell per flux into the free surface, weighted by
    // their lengths, with the velocity reversed and the cell in the place of its mirror image.
    for convection in [0.0, 300.0] {
        let properties = steel(0.02, FarBoundary::Insulated, SlidingPath::Closed(0.1), convection);
        let cells = Cells::graded(0.02, 12).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-4 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let [mut forth, mut back] = [FaceInfluence::new(12), FaceInfluence::new(12)];
        for stage in [Stage::First, Stage::End] {
            for (velocity, influence) in [(0.003, &mut forth), (-0.003, &mut back)] {
                body.prepare(&Step::new(3.0, [velocity; 2]));
                body.face_influence(stage, 0, influence, &mut body.workspace());
            }
            let largest = forth.by_cell.iter().copied().fold(0.0, f64::max);
            for (i, width) in cells.widths().iter().enumerate() {
                let expected = back.temperature[i] * width / 0.06;
                // Short waves, which have no states, enter the response of the face to the cells only.
                let apart = (forth.by_cell[i] - expected).abs() / largest;
                assert!(apart < 0.03, "{convection}, {stage:?}, {i}: {} {expected} {forth:?}", forth.by_cell[i]);
            }
        }
    }
}

#[test]
fn convection_acts_beside_the_contact_only() {
    // A strip of so high a conductivity that its temperature is uniform: all heat leaves through the free surface.
    let mut properties = steel(0.02, FarBoundary::Insulated, SlidingPath::Closed(0.3), 400.0);
    properties.slab.conductivity = 1e6;
    let cells = Cells::graded(0.1, 16).unwrap();
    let resolution = Resolution { duration: 1e4, shortest: 1.0, travel: f64::INFINITY, tolerance: 1e-4 };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let mut state = vec![0.0; body.states()];
    march(&mut body, &mut state, 1e4, 20, |_| 0.3);
    let air = Surroundings::default();
    let flux = vec![1.0; 16];
    let end = FrozenState { state: &state, surroundings: &air, flux: &flux, velocity: 0.3 };
    let temperature = end.temperature(&body);
    let exact = 0.2 / (400.0 * 0.1);
    assert!((mean(&cells, &temperature) / exact - 1.0).abs() < 1e-3, "{} {exact}", mean(&cells, &temperature));
    let [ambient, far] = body.flows(&state, &air, &flux);
    assert!((ambient / 0.2 - 1.0).abs() < 1e-6 && far.abs() < 1e-6 * 0.2, "{ambient} {far}");
    let [free, _] = end.faces(&body);
    assert!((free * 400.0 * 0.1 / 0.2 - 1.0).abs() < 1e-6, "{free}");
}

#[test]
fn everything_at_one_temperature_stays_there() {
    for base in [FarBoundary::Held, FarBoundary::Insulated, FarBoundary::Convecting(300.0)] {
        let properties = steel(0.02, base, SlidingPath::Closed(0.3), 100.0);
        let cells = Cells::graded(0.05, 9).unwrap();
        let resolution = Resolution { duration: 100.0, shortest: 0.1, travel: f64::INFINITY, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        body.uniform(10.0, &mut state);
        let far = if base == FarBoundary::Held { 10.0 } else { 0.0 };
        let air = Surroundings::constant(Boundary { ambient: 10.0, far, cooling: 0.0 });
        body.prepare(&Step::new(5.0, [1.0, 1.0]));
        let (zero, mut temperature, mut distortion) = (vec![0.0; 9], vec![0.0; 9], vec![0.0; 9]);
        for _ in 0..5 {
            body.free_response(&state, &air, Stage::End, &zero, &mut temperature, &mut distortion);
            assert!(temperature.iter().all(|t| (t - 10.0).abs() < 1e-2), "{base:?} {temperature:?}");
            body.step(&mut state, &air, &zero, &zero);
        }
        assert!((body.mean_temperature(&state) - 10.0).abs() < 1e-2);
    }
}

#[test]
fn an_open_contact_does_not_depend_on_what_was_prepared_before() {
    for (path, convection, base) in [
        (SlidingPath::Closed(0.1), 2000.0, FarBoundary::Convecting(500.0)),
        (SlidingPath::Unidirectional, 1000.0, FarBoundary::Insulated),
        (SlidingPath::Closed(0.3), 0.0, FarBoundary::Held),
    ] {
        let mut properties = steel(0.02, base, path, convection);
        properties.expansion = expanding(0.3, elasticity::Base::Bonded);
        let cells = Cells::graded(0.02, 9).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-3 };
        let body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        let (hot, none) = (uneven(&cells, 0), vec![0.0; 9]);
        let mut used = body.clone();
        used.prepare(&Step::new(0.3, [0.4, 0.5]));
        used.step(&mut state, &Surroundings::default(), &hot, &hot);
        let at = |cooling: f64, ambient: f64| Boundary { cooling, ambient, far: 0.3 * cooling };
        let air = Surroundings::linear(at(-900.0, 4.0), at(-700.0, 5.0));
        let (step, velocity) = (0.2, [0.5, 0.7]);
        let [fresh, again] = [body, used].map(|mut body| {
            body.prepare(&Step::new(step, velocity));
            let mut influence = FaceInfluence::new(9);
            body.face_influence(Stage::End, 0, &mut influence, &mut body.workspace());
            let mut after = state.clone();
            body.step(&mut after, &air, &none, &none);
            (influence, after)
        });
        assert_eq!(fresh, again, "{base:?}");
    }
}
