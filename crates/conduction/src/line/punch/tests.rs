mod parts;

use super::super::contact_parts::ContactParts;
use super::super::tests::{at_stage, in_two_parts};
use super::super::{
    Account, Boundary, Exchange, FaceInfluence, FrozenState, GAMMA, Observed, SingleStep, Stage, Step, Surroundings,
    ThermalBody,
};
use super::*;
use across::Wave;
use exact::unreduced_punch::Unreduced;
use nalgebra::Complex;
use parts::in_part;
use scene::FarBoundary;
use scene::variables::{STARTS, reference};

const TOLERANCE: f64 = 1e-4;

/// Steel punch, 60 mm x 100 mm x 10 mm, with changed parameters.
fn scene(changes: &[(&str, f64)]) -> Scene {
    let mut values = STARTS;
    let steel = [
        ("punch.width", 0.06),
        ("punch.height", 0.1),
        ("depth", 0.01),
        ("punch.conductivity", 55.0),
        ("punch.density", 7800.0),
        ("punch.specific_heat", 460.0),
        ("punch.thermal_expansion", 1.1e-5),
        ("punch.poissons_ratio", 0.3),
        ("punch.convection", 0.0),
        ("punch.top_thermal", 1.0),
    ];
    for (name, value) in steel.iter().chain(changes) {
        values[reference(name) as usize] = *value;
    }
    Scene::new(&values, None).unwrap()
}

fn cells(count: usize) -> Cells {
    Cells::graded(0.03, count).unwrap()
}

/// Reduced body with the temperatures and the distortion of the last step.
pub(super) struct Run {
    pub heat: ReducedHeat,
    pub state: Vec<f64>,
    pub surroundings: Surroundings,
    pub temperature: Vec<f64>,
    pub distortion: Vec<f64>,
}

impl Run {
    fn new(scene: &Scene, cells: &Cells, tolerance: f64, duration: f64) -> Run {
        Run::of(reduce(scene, cells, tolerance, duration).unwrap().unwrap())
    }

    pub(crate) fn of(heat: ReducedHeat) -> Run {
        let (state, n) = (vec![0.0; heat.states()], heat.cells());
        let surroundings = Surroundings::default();
        Run { heat, state, surroundings, temperature: vec![0.0; n], distortion: vec![0.0; n] }
    }

    fn frozen<'a>(&'a self, flux: &'a [f64]) -> FrozenState<'a> {
        FrozenState { state: &self.state, surroundings: &self.surroundings, flux, velocity: 0.0 }
    }

    pub(crate) fn step(&mut self, step: f64, first: &[f64], end: &[f64]) {
        self.step_through(Exchange::Whole, step, first, end);
    }

    /// Heat (J/m) that enters 9 cells of these areas per depth (m) in `count` steps of changing length, flux and surroundings, through
    /// the parts in contact of each step.
    pub(super) fn heat_unevenly(&mut self, count: i32, areas: &[f64], parts: fn(i32) -> Option<ContactParts>) -> f64 {
        let mut entered = 0.0;
        for i in 0..count {
            let flux =
                |k: i32| -> Vec<f64> { (0..9).map(|j| 1e4 * (0.3 * f64::from(k + j)).sin().max(-0.2)).collect() };
            let (first, end) = (flux(i), flux(i + 1));
            let far = if i % 50 < 25 { -10.0 } else { 4.0 };
            let last = Boundary { cooling: -20.0, ambient: 3.0, far };
            self.surroundings = Surroundings::linear(Boundary { cooling: -13.0, ..last }, last);
            let step = [1e-3, 0.7, 40.0][i as usize % 3];
            let contact_parts = parts(i).unwrap_or_else(|| ContactParts::whole(9));
            self.step_through(Exchange::Parts([&contact_parts; 2]), step, &first, &end);
            let both = first.iter().zip(&end).map(|(first, end)| (1.0 - GAMMA) * first + GAMMA * end);
            entered += step * both.zip(areas).map(|(flux, area)| flux * area).sum::<f64>();
        }
        entered
    }

    fn step_through(&mut self, exchange: Exchange<'_>, step: f64, first: &[f64], end: &[f64]) {
        self.heat.prepare(&Step { exchange, ..Step::new(step, [0.0; 2]) });
        let stage = (Stage::End, self.heat.holds_far_face());
        (self.temperature, self.distortion, _) =
            at_stage(&mut self.heat, &self.state, &self.surroundings, stage, [first, end]);
        self.heat.step(&mut self.state, &self.surroundings, first, end);
    }
}

fn largest_difference(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| (left - right).abs()).fold(0.0, f64::max)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// A linearly tilted flux of at most 1 W/m2.
fn leaning(cells: &Cells) -> Vec<f64> {
    cells.centres().iter().map(|x| 0.7 + 0.3 * x / 0.03).collect()
}

#[test]
fn states_and_error_at_the_finest_tolerance() {
    for (changes, count) in [
        (&[][..], 33),
        (&[("punch.top_thermal", 3.0)], 33),
        (&[("punch.top_thermal", 2.0), ("punch.convection", 20.0)], 33),
        (&[("punch.top_thermal", 3.0), ("punch.convection", 20.0)], 129),
    ] {
        let cells = cells(count);
        let heat = reduce(&scene(changes), &cells, TOLERANCE, 1000.0).unwrap().unwrap();
        println!("{changes:?} {count}: {} states, error {:.2e}", heat.own_states(), heat.error());
        assert!(heat.own_states() <= MAXIMUM_STATES && heat.error() <= TOLERANCE);
        assert!(heat.states() <= MAXIMUM_STATES + count + 4);
    }
    // A brake pad of low conductivity over a stop.
    let pad = scene(&[
        ("punch.conductivity", 1.2),
        ("punch.density", 2500.0),
        ("punch.specific_heat", 1000.0),
        ("punch.height", 0.015),
        ("punch.top_thermal", 3.0),
    ]);
    let heat = reduce(&pad, &cells(33), 1e-3, 10.0).unwrap().unwrap();
    println!("pad: {} states, error {:.2e}", heat.own_states(), heat.error());
    assert!(heat.own_states() <= MAXIMUM_STATES && heat.error() <= 1.1e-3);
    // Where the states do not suffice, the remaining error is reported.
    let heat = reduce(&scene(&[]), &cells(33), TOLERANCE, 1.0).unwrap().unwrap();
    println!("1 s: {} states, error {:.2e}", heat.own_states(), heat.error());
    assert!(heat.own_states() == MAXIMUM_STATES && heat.error() > TOLERANCE && heat.error() < 1e-3);
}

#[test]
fn steady_states_are_those_of_the_unreduced_punch() {
    let cells = cells(17);
    let spiked: Vec<f64> = (0..17).map(|j| if j % 5 == 2 { 1.0 } else { 0.2 }).collect();
    for changes in [
        &[][..],
        &[("punch.convection", 300.0)],
        &[("punch.top_thermal", 2.0), ("punch.convection", 4000.0)],
        &[("punch.top_thermal", 3.0), ("punch.convection", 30.0)],
    ] {
        let scene = scene(changes);
        let mut run = Run::new(&scene, &cells, 1e-3, 1000.0);
        let mut unreduced = Unreduced::new(&scene, &cells).unwrap();
        for _ in 0..2 {
            run.step(1e9, &spiked, &spiked);
        }
        unreduced.rest(&spiked).unwrap();
        let expected = unreduced.temperature(&spiked).unwrap();
        let error = largest_difference(&run.temperature, &expected) / largest(&expected);
        // The elements do not resolve the local field of a discontinuous flux; their correction of temperatures has no
        // distortion. Hence a smooth flux.
        let smooth = leaning(&cells);
        let mut bending = Run::new(&scene, &cells, 1e-3, 1000.0);
        bending.step(1e9, &smooth, &smooth);
        unreduced.rest(&smooth).unwrap();
        let bent = unreduced.distortion().unwrap();
        let distortion = largest_difference(&bending.distortion, &bent) / largest(&bent);
        println!("{changes:?}: temperature {error:.2e}, distortion {distortion:.2e}");
        assert!(error < 3e-5 && distortion < 3e-5, "{changes:?}: {error:e} {distortion:e}");
        let entered: f64 = spiked.iter().zip(cells.widths()).map(|(flux, width)| flux * width).sum();
        let flows = run.heat.flows(&run.state, &run.surroundings, &spiked);
        assert!((flows[0] + flows[1] - entered).abs() < 1e-9 * entered, "{flows:?}");
        // The output map at frozen state between steps equals the result at the end of the step.
        let end = run.frozen(&spiked);
        let (shown, moved) = (end.temperature(&run.heat), end.distortion(&run.heat));
        assert!(largest_difference(&shown, &run.temperature) < 1e-12 * largest(&shown));
        assert!(largest_difference(&moved, &run.distortion) < 1e-12 * largest(&moved));
    }
    // The exact response, to which states and static corrections sum.
    let mut exact = Run::new(&scene(&[]), &cells, 1e-3, 1000.0);
    exact.heat.prepare(&Step::new(1e12, [0.0; 2]));
    let across = Across { half_width: 0.03, sides: Sides::Free, cooled: 2.0, transfer: 0.0, conductivity: 55.0 };
    let depth = Depth {
        height: 0.1,
        conductivity: 55.0,
        capacity: 7800.0 * 460.0,
        top: FarBoundary::Held,
        face: 0.0,
        driven_top: false,
    };
    let waves = waves::Waves::new(&across, &cells, 256);
    let all = steady::SteadyBeyond::new(&across, &depth, 0);
    let span = all.over(&cells, &waves);
    let integrals = all.between((&span, 0..17), (&span, 0..17));
    let expected = nalgebra::DMatrix::from_fn(17, 17, |i, j| integrals[(i, j)] / cells.widths()[i]);
    let error = (&exact.heat.influence(Stage::End).temperature - &expected).amax() / expected.amax();
    assert!(error < 1e-8, "{error:e}");
    // Insulated sides and a top of prescribed temperature: the conduction of a slab for any mean flux over time.
    let mut slab = Run::new(&scene(&[]), &cells, 1e-3, 1000.0);
    slab.step(1e12, &[2.0; 17], &[2.0; 17]);
    assert!(slab.temperature.iter().all(|t| (t / (2.0 * 0.1 / 55.0) - 1.0).abs() < 1e-10), "{:?}", slab.temperature);
}

#[test]
fn short_times_are_those_of_the_half_space() {
    let mut run = Run::new(&scene(&[]), &cells(33), TOLERANCE, 1.0);
    let bound = run.heat.error();
    assert!(bound < 5e-3, "{bound:e}");
    let expected = |time: f64| 2.0 * (time / (std::f64::consts::PI * 55.0 * 7800.0 * 460.0)).sqrt();
    // Any number of steps: the propagation for a constant flux is exact.
    for count in [1, 10] {
        run.state.fill(0.0);
        for _ in 0..count {
            run.step(1.0 / f64::from(count), &[1.0; 33], &[1.0; 33]);
        }
        assert!(run.temperature.iter().all(|t| (t / expected(1.0) - 1.0).abs() < bound));
    }
    run.state.fill(0.0);
    run.step(1e-3, &[1.0; 33], &[1.0; 33]);
    assert!(run.temperature.iter().all(|t| (t - expected(1e-3)).abs() < bound * expected(1.0)));
}

#[test]
fn heat_is_accounted_for() {
    let cells = cells(9);
    for changes in [
        &[("punch.top_thermal", 3.0)][..],
        &[],
        &[("punch.convection", 300.0)],
        &[("punch.top_thermal", 3.0), ("punch.convection", 1e-7)],
        &[("punch.top_thermal", 3.0), ("punch.convection", 30.0)],
        &[("punch.top_thermal", 2.0), ("punch.convection", 30.0)],
        &[("punch.top_thermal", 2.0), ("punch.convection", 30.0), ("punch.emissivity", 0.5)],
        &[("punch.top_thermal", 2.0), ("punch.convection", 0.0), ("punch.emissivity", 0.5)],
    ] {
        let scene = scene(changes);
        let mut run = Run::new(&scene, &cells, 1e-3, 100.0);
        run.heat.uniform(5.0, &mut run.state);
        let start = run.heat.account(&run.state);
        assert!(
            (run.heat.mean_temperature(&run.state) - 5.0).abs() < 1e-4,
            "{}",
            run.heat.mean_temperature(&run.state)
        );
        // Part of the time through parts of the cells.
        let entered = run.heat_unevenly(300, cells.widths(), |i| (i % 70 < 30).then(in_part));
        let end = run.heat.account(&run.state);
        let gain = |of: fn(&Account) -> f64| of(&end) - of(&start);
        assert!((gain(|a| a.received) - entered).abs() < 1e-12 * entered.abs());
        let all = gain(|a| a.stored) + gain(|a| a.ambient) + gain(|a| a.far);
        assert!((all - entered).abs() < 1e-12 * entered.abs(), "{changes:?}: {all} of {entered}");
        // The heat account is the integral of the flows, which are those through whole cells.
        run.surroundings = Surroundings::constant(run.surroundings.end);
        let flux = [1e4; 9];
        run.step(10.0, &flux, &flux);
        let before = run.heat.account(&run.state);
        let flows = run.heat.flows(&run.state, &run.surroundings, &flux);
        run.step(1e-6, &flux, &flux);
        let after = run.heat.account(&run.state);
        let cooling = 20.0 * 0.2;
        for (flow, booked) in
            flows.iter().zip([1e6 * (after.ambient - before.ambient) - cooling, 1e6 * (after.far - before.far)])
        {
            assert!((flow - booked).abs() < 1e-3 * flow.abs() + 0.1, "{changes:?}: {flow} {booked}");
        }
    }
}

#[test]
fn a_temperature_of_the_far_face_arrives_by_diffusion() {
    // Slab of 0.1 m that is insulated at the contact: Carslaw and Jaeger, section 3.4.
    let time = 0.1 * 0.1 * 7800.0 * 460.0 / 55.0;
    let exact = |t: f64| {
        let term = |n: i32| {
            let root = (f64::from(n) + 0.5) * std::f64::consts::PI;
            2.0 * (-root * root * t).exp() / (root * if n % 2 == 0 { 1.0 } else { -1.0 })
        };
        1.0 - (0..200).map(term).sum::<f64>()
    };
    let early = [(1e-9, 1e-6), (1e-6, 1e-3), (1e-5, 1e-3), (1e-4, 1.5e-3), (0.001, 1e-3), (0.01, 1e-3), (0.03, 5e-4)];
    for (part, bound) in early.into_iter().chain([(0.1, 2e-4), (1.0, 1e-5)]) {
        let mut run = Run::new(&scene(&[]), &cells(9), 1e-3, 1000.0);
        run.surroundings = Surroundings::constant(Boundary { far: 1.0, ..Boundary::default() });
        run.step(part * time, &[0.0; 9], &[0.0; 9]);
        let (found, expected) = (run.temperature[4], if part < 1e-3 { 0.0 } else { exact(part) });
        println!("{part}: {found} {expected}");
        assert!((found - expected).abs() < bound, "after {part} of h^2/kd: {found} for {expected}");
    }
}

#[test]
fn a_body_as_warm_as_all_around_it_stays_so() {
    let cells = cells(9);
    for changes in [&[][..], &[("punch.convection", 300.0)], &[("punch.top_thermal", 2.0), ("punch.convection", 300.0)]]
    {
        let mut run = Run::new(&scene(changes), &cells, 1e-3, 100.0);
        run.surroundings = Surroundings::constant(Boundary { ambient: 7.0, far: 7.0, cooling: 0.0 });
        run.heat.uniform(7.0, &mut run.state);
        for _ in 0..10 {
            run.step(3.0, &[0.0; 9], &[0.0; 9]);
        }
        assert!(run.temperature.iter().all(|t| (t - 7.0).abs() < 7e-4), "{changes:?}: {:?}", run.temperature);
        let [cooled, _] = run.frozen(&[0.0; 9]).faces(&run.heat);
        assert!((cooled - 7.0).abs() < 1e-3, "{changes:?}: {cooled}");
        // Free expansion except where the holder constrains it: that of the elastic block.
        let unreduced = Unreduced::new(&scene(changes), &cells).unwrap();
        let expected = unreduced.elastic.uniform_distortion(cells.edges()).unwrap() * (7.0 * 1.1e-5);
        let error = largest_difference(&run.distortion, expected.as_slice());
        assert!(error < 2e-4 * expected.amax(), "{changes:?}: {error:e} of {}", expected.amax());
        assert!(run.distortion.iter().all(|u| *u < 0.0));
    }
}

#[test]
fn forced_cooling_takes_the_heat_of_the_sides() {
    // A constant flux into the sides of an otherwise insulated block warms it by the heat input.
    let cells = cells(9);
    let mut run = Run::new(&scene(&[("punch.top_thermal", 3.0)]), &cells, 1e-3, 100.0);
    run.surroundings = Surroundings::constant(Boundary { cooling: 500.0, ..Boundary::default() });
    run.step(50.0, &[0.0; 9], &[0.0; 9]);
    let expected = 50.0 * 500.0 * 0.2 / (7800.0 * 460.0 * 0.06 * 0.1);
    assert!((run.heat.mean_temperature(&run.state) - expected).abs() < 1e-9 * expected);
    let [cooled, _] = run.frozen(&[0.0; 9]).faces(&run.heat);
    assert!(cooled > expected && run.temperature[4] < run.temperature[0], "{cooled} {:?}", run.temperature);
}

#[test]
fn cooling_that_falls_over_a_step_falls_over_its_parts() {
    let cells = cells(9);
    let scene = scene(&[("punch.top_thermal", 2.0), ("punch.convection", 30.0), ("punch.emissivity", 0.5)]);
    let (mut run, mut parts) = (Run::new(&scene, &cells, 1e-3, 100.0), Run::new(&scene, &cells, 1e-3, 100.0));
    let (zero, flux, step) = ([0.0; 9], leaning(&cells), 5.0);
    run.heat.uniform(20.0, &mut run.state);
    parts.state.copy_from_slice(&run.state);
    let start = Boundary { cooling: -100.0, ambient: 8.0, far: 200.0 };
    let end = Boundary { cooling: -400.0, ambient: 3.0, far: 900.0 };
    run.surroundings = Surroundings::linear(start, end);
    run.heat.prepare(&Step::new(step, [0.0; 2]));
    // Reciprocity of the two faces, and of faces and cells.
    let areas = [0.2, 0.06];
    let mut influence = [FaceInfluence::new(9), FaceInfluence::new(9)];
    for stage in [Stage::First, Stage::End] {
        for (face, influence) in influence.iter_mut().enumerate() {
            run.heat.face_influence(stage, face, influence, &mut run.heat.workspace());
            for (i, width) in cells.widths().iter().enumerate() {
                let by_cell = influence.temperature[i] * width / areas[face];
                let apart = (influence.by_cell[i] / by_cell - 1.0).abs();
                assert!(apart < 1e-6, "{stage:?}, face {face}, cell {i}: {by_cell} {influence:?}");
            }
        }
        let [beside, far] = &influence;
        let ratio = far.faces[0] * areas[0] / (beside.faces[1] * areas[1]);
        assert!((ratio - 1.0).abs() < 1e-6 && beside.faces[0] > beside.faces[1] && far.faces[1] > 0.0, "{influence:?}");
    }
    let early = at_stage(&mut run.heat, &run.state, &run.surroundings, (Stage::First, false), [&zero, &flux]);
    let late = at_stage(&mut run.heat, &run.state, &run.surroundings, (Stage::End, false), [&flux; 2]);
    run.heat.step(&mut run.state, &run.surroundings, &flux, &flux);
    for (part, around) in [GAMMA, 1.0 - GAMMA].into_iter().zip(in_two_parts(start, end)) {
        parts.heat.prepare(&Step::new(part * step, [0.0; 2]));
        let (temperature, distortion, faces) =
            at_stage(&mut parts.heat, &parts.state, &around, (Stage::End, false), [&flux; 2]);
        parts.heat.step(&mut parts.state, &around, &flux, &flux);
        let (other, moved, others) = if part == GAMMA { &early } else { &late };
        assert!(largest_difference(&temperature, other) < 1e-9, "{part}: {temperature:?} {other:?}");
        assert!(largest_difference(&distortion, moved) < 1e-9 * largest(moved), "{part}");
        assert!(largest_difference(&faces, others) < 1e-9, "{part}: {faces:?} {others:?}");
    }
    assert!(largest_difference(&run.state, &parts.state) < 1e-9 * largest(&run.state));
    let cooled = run.frozen(&flux).faces(&run.heat);
    assert!(largest_difference(&cooled, &late.2) < 1e-9, "{cooled:?} {late:?}");
}

#[test]
fn linear_field_bends_the_contact_line() {
    // A slender block with prescribed temperature at its top: a linear field, free of stress far from the top, that gives
    // the contact the curvature alpha (1 + nu) q/k.
    let cells = Cells::uniform(0.03, 9).unwrap();
    let mut run = Run::new(&scene(&[("punch.height", 0.3)]), &cells, 1e-3, 1000.0);
    run.step(1e9, &[1e5; 9], &[1e5; 9]);
    let spacing = 0.06 / 9.0;
    for i in 1..8 {
        let bend = (run.distortion[i - 1] - 2.0 * run.distortion[i] + run.distortion[i + 1]) / (spacing * spacing);
        let expected = 1.1e-5 * 1.3 * 1e5 / 55.0;
        assert!((bend / expected - 1.0).abs() < 1e-3, "{i}: {bend} {expected}");
    }
}

#[test]
fn gains_do_not_depend_on_what_came_before() {
    let cells = cells(9);
    let mut run = Run::new(&scene(&[]), &cells, 1e-3, 100.0);
    let mut fresh = run.heat.boxed();
    for step in [1.0, 0.3, 7.0, 0.01, 2.0, 0.3] {
        run.heat.prepare(&Step::new(step, [1.0, -1.0]));
    }
    fresh.prepare(&Step::new(0.3, [0.0; 2]));
    for stage in [Stage::First, Stage::End] {
        assert_eq!(run.heat.influence(stage), fresh.influence(stage));
    }
}

#[test]
fn first_stage_is_a_shorter_step_of_constant_flux() {
    let cells = cells(9);
    let scene = scene(&[("punch.convection", 300.0)]);
    let (mut run, mut short) = (Run::new(&scene, &cells, 1e-3, 100.0), Run::new(&scene, &cells, 1e-3, 100.0));
    let flux: Vec<f64> = (0..9).map(|j| 1.0 + f64::from(j)).collect();
    for run in [&mut run, &mut short] {
        run.surroundings = Surroundings::constant(Boundary { cooling: 1.0, ambient: 2.0, far: 3.0 });
        run.step(2.0, &flux, &[0.0; 9]);
    }
    let step = 5.0;
    run.heat.prepare(&Step::new(step, [0.0; 2]));
    let stage = (Stage::First, run.heat.holds_far_face());
    let (temperature, distortion, _) =
        at_stage(&mut run.heat, &run.state, &run.surroundings, stage, [&[0.0; 9], &flux]);
    short.step(GAMMA * step, &flux, &flux);
    assert!(largest_difference(&temperature, &short.temperature) < 1e-12 * largest(&temperature));
    assert!(largest_difference(&distortion, &short.distortion) < 1e-12 * largest(&distortion));
    // A flux that is linear over the step, against many short steps that follow it.
    let (first, end) = (vec![1.0; 9], flux);
    let at = |time: f64| -> Vec<f64> {
        let part = (time / step - GAMMA) / (1.0 - GAMMA);
        first.iter().zip(&end).map(|(first, end)| first + part * (end - first)).collect()
    };
    let mut fine = Run { heat: run.heat.clone(), state: run.state.clone(), ..short };
    run.step(step, &first, &end);
    for i in 0..50 {
        let start = step * f64::from(i) / 50.0;
        fine.step(step / 50.0, &at(start + GAMMA * step / 50.0), &at(start + step / 50.0));
    }
    assert!(largest_difference(&run.temperature, &fine.temperature) < 1e-10 * largest(&run.temperature));
    assert!(largest_difference(&run.state, &fine.state) < 1e-10 * largest(&run.state));
}

#[test]
fn a_ring_is_a_layer_of_sinusoidal_modes() {
    // Five waves around a ring that is deep against them: T = q/(k m), curvature alpha (1 + nu) q/k, at rest.
    let count = 120;
    let cells = Cells::uniform(0.03, count).unwrap();
    let wave_number = 5.0 * 2.0 * std::f64::consts::PI / 0.06;
    let ring =
        [("contact.geometry", 3.0), ("strip.path", 2.0), ("strip.length", 0.06), ("contact.friction_coefficient", 0.0)];
    for (poissons_ratio, body) in [(0.3, 4.0), (0.45, 4.0), (0.3, 3.0), (0.3, 2.0)] {
        let scene = scene(&[&ring[..], &[("punch.poissons_ratio", poissons_ratio), ("punch.body", body)]].concat());
        let mut run = Run::new(&scene, &cells, 1e-3, 1000.0);
        let half = 0.5 * wave_number * 0.06 / count as f64;
        let flux: Vec<f64> = cells.centres().iter().map(|x| (wave_number * x + 0.4).cos()).collect();
        run.step(1e9, &flux, &flux);
        // Cell means of the temperature for cell means of the flux.
        let temperature = (half.sin() / half).powi(2) / (55.0 * wave_number);
        let distortion = -1.1e-5 * (1.0 + poissons_ratio) * temperature / wave_number;
        for (i, flux) in flux.iter().enumerate() {
            assert!((run.temperature[i] - flux * temperature).abs() < 1e-2 * temperature, "{i}");
            let error = (run.distortion[i] - flux * distortion).abs();
            assert!(error < 1e-2 * distortion.abs(), "{body} {i}: {} {}", run.distortion[i], flux * distortion);
        }
    }
}

/// Thermal distortion has no direct feedthrough: none in a short step, all of it in a long one, and in between the coarse
/// reduction, which with a direct feedthrough would be wrong by a large factor, follows the fine one.
#[test]
fn no_distortion_comes_at_once() {
    let cells = cells(17);
    for changes in [&[][..], &[("punch.top_thermal", 2.0)], &[("punch.width", 0.095), ("punch.conductivity", 1.2)]] {
        let scene = scene(changes);
        let distortion = |tolerance: f64, step: f64| {
            let mut heat = reduce(&scene, &cells, tolerance, 10.0).unwrap().unwrap();
            heat.prepare(&Step::new(step, [0.0; 2]));
            // A uniform displacement changes no pressure.
            let mut influence = heat.influence(Stage::First).distortion.clone();
            for mut column in influence.column_iter_mut() {
                let mean =
                    column.iter().zip(cells.widths()).map(|(u, c)| u * c).sum::<f64>() / (2.0 * cells.half_width());
                column.add_scalar_mut(-mean);
            }
            influence
        };
        let steady = distortion(0.1, 1e3).amax();
        for step in [1e-9, 1e-7] {
            let moved = distortion(0.1, step).amax();
            assert!(moved < 1e-3 * steady, "{changes:?} {step}: {moved:e} of {steady:e}");
        }
        for step in [1e-3, 1e-2, 0.1] {
            let (coarse, fine) = (distortion(0.1, step), distortion(1e-3, step));
            let error = (&coarse - &fine).amax() / fine.amax();
            println!("{changes:?} {step}: {error:e}");
            assert!(error < 0.7, "{changes:?} {step}: {error:e}");
        }
    }
}

#[test]
fn what_no_mode_carries_follows_in_its_own_time() {
    // A Fourier mode far beyond those with states, on cells that resolve it: on a deep body at rest it follows a jump of the
    // flux with the time constant 3/(4 kd m^2), distortion and temperature alike.
    let count = 96;
    let cells = Cells::uniform(0.03, count).unwrap();
    let scene = scene(&[]);
    let (number, diffusivity) = (24, 55.0 / (7800.0 * 460.0));
    let phase = |x: f64| (f64::from(number) * std::f64::consts::PI * (x + 0.03) / 0.06).cos();
    let flux: Vec<f64> = cells.centres().iter().map(|x| phase(*x)).collect();
    let wave_number = f64::from(number) * std::f64::consts::PI / 0.06;
    let time = 0.75 / (diffusivity * wave_number * wave_number);
    let amplitude = |values: &[f64]| values.iter().zip(&flux).map(|(value, q)| value * q).sum::<f64>();
    let after = |step: f64| {
        let mut run = Run::new(&scene, &cells, 0.1, 1e6);
        run.step(step, &flux, &flux);
        [amplitude(&run.temperature), amplitude(&run.distortion)]
    };
    let steady = after(1e9);
    // Means over the cells of a flux that is uniform over each cell.
    let angle = 0.5 * wave_number * cells.widths()[0];
    let even = (angle.sin() / angle).powi(2);
    let temperature = even * flux.iter().map(|q| q * q).sum::<f64>() / (55.0 * wave_number);
    assert!((steady[0] / temperature - 1.0).abs() < 1e-2, "{steady:?} {temperature}");
    for steps in [1e-6, 0.3, 1.0, 3.0] {
        let [warm, moved] = after(steps * time);
        let followed = 1.0 - (-steps).exp();
        let parts = [warm / steady[0], moved / steady[1]];
        println!("{steps}: {parts:?} {followed}");
        for part in parts {
            assert!((part - followed).abs() < 0.02, "{steps}: {parts:?} {followed}");
        }
    }
}

/// Part of a uniform temperature left in a plate that loses heat by its sides.
fn left(across: &Across, capacity: f64, time: f64) -> f64 {
    let part = |wave: Wave| wave.integral.powi(2) * (-across.conductivity / capacity * wave.decay.powi(2) * time).exp();
    (0..8000).step_by(2).map(|m| part(across.wave(m))).sum::<f64>() / (2.0 * across.half_width)
}

/// Means over the block and over the contact of the response to a flux of 1 W/m2 under an insulated top: all modes across the width
/// and through the height, in closed form.
fn heated(across: &Across, depth: &Depth, time: f64) -> [f64; 2] {
    let mut means = [0.0; 2];
    for m in (0..8000).step_by(2) {
        let wave = across.wave(m);
        let square = (wave.decay * wave.decay).max(1e-6);
        let part = wave.integral * wave.integral / (2.0 * across.half_width);
        if part == 0.0 {
            break;
        }
        let (mut contact, mut n) = (depth.steady_impedance(square.sqrt()), 0.0);
        loop {
            let square = square + (n * std::f64::consts::PI / depth.height).powi(2);
            let (fallen, gain) =
                (-depth.diffusivity() * square * time, 1.0 / (depth.conductivity * square * depth.height));
            if n == 0.0 {
                means[0] -= part * fallen.exp_m1() * gain;
            }
            contact -= if n == 0.0 { 1.0 } else { 2.0 } * fallen.exp() * gain;
            if fallen < -28.0 {
                break;
            }
            n += 1.0;
        }
        means[1] += part * contact;
    }
    means
}

/// Heat that the sides take from a uniformly warm block and from one heated by the contact: within a fifth of the tolerance. A top that
/// loses heat has few trial functions for the layer below it.
#[test]
fn sides_in_fast_air_cool_a_block_as_its_series_says() {
    let (cells, none, capacity) = (cells(17), [0.0; 17], 7800.0 * 460.0);
    for transfer in [0.0, 10.0, 100.0, 1e3, 1e4] {
        for (conductivity, height) in [(1.5, 0.012), (55.0, 0.1)] {
            let across = Across { half_width: 0.03, sides: Sides::Free, cooled: 2.0, transfer, conductivity };
            let (top, face) = (FarBoundary::Insulated, 0.0);
            let depth = Depth { height, conductivity, capacity, top, face, driven_top: false };
            let slow = Complex::new(across.wave(0).decay.powi(2), 1e-2 / depth.diffusivity()).sqrt();
            let scale = depth.impedance(slow).norm();
            for tolerance in [1e-2, 1e-3] {
                let run = |top: f64| {
                    let changes = [
                        ("punch.conductivity", conductivity),
                        ("punch.height", height),
                        ("punch.convection", transfer),
                        ("punch.top_thermal", top),
                    ];
                    let mut run = Run::new(&scene(&changes), &cells, tolerance, 100.0);
                    run.heat.uniform(1.0, &mut run.state);
                    run
                };
                let (mut cooling, mut with_top, mut heating) = (run(3.0), run(2.0), run(3.0));
                heating.heat.uniform(0.0, &mut heating.state);
                let mut now = 0.0;
                for step in [1e-3, 0.01, 0.1, 1.0, 3.0, 7.0, 20.0, 70.0, 200.0] {
                    now += step;
                    cooling.step(step, &none, &none);
                    with_top.step(step, &none, &none);
                    // A layer with one face that loses heat is half of a plate.
                    let between_sides = left(&across, capacity, now);
                    let under_top = left(&Across { half_width: height, ..across }, capacity, now);
                    heating.step(step, &[1.0; 17], &[1.0; 17]);
                    let [mean, contact] = heated(&across, &depth, now);
                    let found = heating.temperature.iter().zip(cells.widths()).map(|(t, c)| t * c).sum::<f64>() / 0.06;
                    let errors = [
                        cooling.heat.mean_temperature(&cooling.state) - between_sides,
                        with_top.heat.mean_temperature(&with_top.state) - between_sides * under_top,
                        (heating.heat.mean_temperature(&heating.state) - mean) / scale,
                        (found - contact) / scale,
                    ];
                    let bounds = [0.2, 0.4, 0.2, 1.0].map(|part| part * tolerance);
                    let within = errors.iter().zip(bounds).all(|(error, bound)| error.abs() < bound);
                    assert!(within, "{transfer} {conductivity} {tolerance} {now} s: {errors:?}");
                }
            }
        }
    }
}
