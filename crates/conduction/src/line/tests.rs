//! What tests of several bodies share: the stages of a step with fluxes into cells and cooled faces.

use super::punch::mate::reduce_mate;
use super::punch::reduce;
use super::strip::tests::cooled_steel;
use super::strip::{Resolution, SlidingPath, StripHeat, StripProperties};
use super::{Boundary, FACES, FaceInfluence, GAMMA, SingleStep, Stage, Step, Surroundings, ThermalBody};
use crate::slab::Slab;
use elasticity::Cells;
use nalgebra::DVector;
use scene::variables::{STARTS, changed};
use scene::{FarBoundary, Scene};

/// Temperatures and distortion of the cells and temperatures of the cooled faces at a stage of the prepared step; `known` as in
/// [`SingleStep::free_response`], `own` the fluxes of the stage into the cells: by the surface influence matrices, which
/// [`ThermalBody::respond`] says without forming them.
pub(crate) fn at_stage(
    body: &mut dyn ThermalBody,
    state: &[f64],
    around: &Surroundings,
    (stage, held): (Stage, bool),
    [known, own]: [&[f64]; 2],
) -> (Vec<f64>, Vec<f64>, [f64; FACES]) {
    let count = body.cells();
    let (mut temperature, mut distortion) = (vec![0.0; count], vec![0.0; count]);
    let mut faces = body.free_response(state, around, stage, known, &mut temperature, &mut distortion);
    let (mut warm, mut moved) = (temperature.clone(), distortion.clone());
    body.respond(stage, own, [Some(&mut warm), Some(&mut moved)], &mut body.workspace());
    let influence = body.influence(stage);
    let products =
        [(&influence.temperature, &mut temperature, &warm), (&influence.distortion, &mut distortion, &moved)];
    for (matrix, response, other) in products {
        let most = matrix.amax() * own.iter().fold(0.0, |most: f64, flux| most.max(flux.abs()));
        for (i, (response, other)) in response.iter_mut().zip(other).enumerate() {
            *response += (0..count).map(|j| matrix[(i, j)] * own[j]).sum::<f64>();
            assert!(
                (*response - other).abs() <= 1e-12 * most + 1e-13 * response.abs(),
                "cell {i}: {response:e} {other:e}"
            );
        }
    }
    let mut by_face = FaceInfluence::new(count);
    for (face, flux) in [around.at(stage).cooling, around.at(stage).far].into_iter().enumerate() {
        if face == 1 && held {
            continue;
        }
        body.face_influence(stage, face, &mut by_face, &mut body.workspace());
        (0..FACES).for_each(|other| faces[other] += by_face.faces[other] * flux);
        faces[face] += by_face.by_cell.iter().zip(own).map(|(rise, flux)| rise * flux).sum::<f64>();
        for i in 0..count {
            temperature[i] += by_face.temperature[i] * flux;
            distortion[i] += by_face.distortion[i] * flux;
        }
    }
    (temperature, distortion, faces)
}

/// Linear from the first stage of one step to the end of the next, over the two parts of a step that end at its stages.
pub(crate) fn in_two_parts(start: Boundary, end: Boundary) -> [Surroundings; 2] {
    let middle = start.combined(&end, |start, end| start + GAMMA * (end - start));
    [Surroundings::linear(start, middle), Surroundings::linear(middle, end)]
}

/// Two bodies in perfect contact, whose surfaces differ in temperature in the first step only: the largest flux after the first step and
/// after `count` steps, W/m2.
fn decay(bodies: &mut [Box<dyn ThermalBody>; 2], velocity: f64, step: f64, count: usize) -> [f64; 2] {
    let cells = bodies[0].cells();
    let (zeros, around) = (vec![0.0; cells], Surroundings::default());
    bodies[0].prepare(&Step::new(step, [0.0; 2]));
    bodies[1].prepare(&Step::new(step, [velocity; 2]));
    let mut states = bodies.each_ref().map(|body| vec![0.0; body.states()]);
    let mut sizes = [0.0; 2];
    for number in 0..count {
        let mut fluxes = [[zeros.clone(), zeros.clone()], [zeros.clone(), zeros.clone()]];
        for stage in [Stage::First, Stage::End] {
            let [mut here, mut there, mut moved] = [0; 3].map(|_| zeros.clone());
            let known = &fluxes[0];
            bodies[0].free_response(&states[0], &around, stage, &known[0], &mut here, &mut moved);
            bodies[1].free_response(&states[1], &around, stage, &known[1], &mut there, &mut moved);
            let jump = |i: usize| if number == 0 { [1.0, -0.3, 0.7][i % 3] } else { 0.0 };
            let difference = DVector::from_fn(cells, |i, _| there[i] - here[i] + jump(i));
            let [here, there] = bodies.each_mut().map(|body| &body.influence(stage).temperature);
            let both = here + there;
            let flux: Vec<f64> = both.lu().solve(&difference).unwrap().iter().copied().collect();
            fluxes[stage as usize] = [flux.clone(), flux.iter().map(|q| -q).collect()];
        }
        for (b, (body, state)) in bodies.iter().zip(&mut states).enumerate() {
            body.step(state, &around, &fluxes[0][b], &fluxes[1][b]);
        }
        let size = fluxes[1][0].iter().fold(0.0, |most: f64, q| most.max(q.abs()));
        sizes = if number == 0 { [size; 2] } else { [sizes[0], size] };
    }
    sizes
}

/// A scene with these values, all others at their start.
fn scene(changes: &[(&str, f64)]) -> Scene {
    Scene::new(&changed(&STARTS, changes).unwrap(), None).unwrap()
}

/// A sliding clutch: a thin ring of friction material on a ring of steel.
fn clutch() -> Scene {
    scene(&[
        ("contact.geometry", 2.0),
        ("contact.mean_radius", 0.0945),
        ("depth", 0.59376),
        ("punch.width", 0.039),
        ("punch.height", 0.0035),
        ("punch.conductivity", 0.8),
        ("strip.path", 2.0),
        ("strip.length", 0.0),
        ("strip.height", 0.012),
    ])
}

fn block(cells: &Cells) -> Box<dyn ThermalBody> {
    let scene = scene(&[("punch.width", 2.0 * cells.half_width()), ("punch.convection", 300.0)]);
    Box::new(reduce(&scene, cells, 1e-3, 2.0).unwrap().unwrap())
}

/// Punch and mate of [`clutch`].
fn rings(cells: &Cells) -> [Box<dyn ThermalBody>; 2] {
    let scene = clutch();
    let mate = reduce_mate(&scene, cells, 1e-3, 2.0).unwrap().unwrap();
    [Box::new(reduce(&scene, cells, 1e-3, 2.0).unwrap().unwrap()), Box::new(mate)]
}

#[test]
fn two_bodies_in_perfect_contact_even_out_at_every_speed_and_step() {
    let strip = |(conductivity, capacity): (f64, f64), path: SlidingPath, cells: &Cells| {
        let properties = StripProperties::bare(Slab::bare(0.05, [conductivity, capacity], FarBoundary::Held), path);
        let resolution = Resolution { duration: 200.0, shortest: 0.2, travel: f64::INFINITY, tolerance: 1e-4 };
        Box::new(StripHeat::new(&properties, cells, &resolution).unwrap()) as Box<dyn ThermalBody>
    };
    let length = 0.0754;
    let cells = Cells::uniform(0.5 * length, 8).unwrap();
    let (steel, ceramic) = ((55.0, 3.588e6), (1.46, 1.991e6));
    let still = strip(steel, SlidingPath::Closed(length), &cells);
    let paths = [SlidingPath::Closed(length), SlidingPath::Closed(2.0 * length), SlidingPath::Unidirectional];
    let mut pairs: Vec<_> =
        paths.map(|path| (format!("{path:?}"), [still.clone(), strip(ceramic, path, &cells)])).into();
    let cells = Cells::graded(0.02, 9).unwrap();
    pairs.push(("block".into(), [block(&cells), strip(steel, SlidingPath::Unidirectional, &cells)]));
    pairs.push(("rings".into(), rings(&Cells::graded(0.0195, 9).unwrap())));
    for (name, bodies) in &mut pairs {
        for velocity in [0.01, 0.05, 0.5] {
            for step in [1e-12, 1e-10, 1e-8, 1e-6, 1e-3, 3e-3, 1e-2, 0.1] {
                let [first, last] = decay(bodies, velocity, step, 60);
                assert!(last < 0.1 * first, "{name} {velocity} m/s, {step} s: {first:e} W/m2 became {last:e}");
            }
        }
    }
}

/// Heat expands what it has entered: in steps shorter than those that the states resolve the distortion by a flux is in proportion to
/// the step. Distortion that appears at once raises the pressure that causes it, however short the step.
#[test]
fn distortion_vanishes_with_the_step() {
    let [wide, narrow] = [0.0377, 0.0195].map(|half_width| Cells::graded(half_width, 9).unwrap());
    let resolution = Resolution { duration: 100.0, shortest: 0.1, travel: 1e3, tolerance: 1e-3 };
    let mut bodies = vec![("block".to_owned(), block(&wide))];
    bodies.extend(["ring", "mate"].map(str::to_owned).into_iter().zip(rings(&narrow)));
    for path in
        [SlidingPath::Closed(0.754), SlidingPath::Stroke { stroke: 0.05, length: 0.0 }, SlidingPath::Unidirectional]
    {
        for conductivity in [55.0, 1.46] {
            let mut properties = cooled_steel(path);
            properties.slab.conductivity = conductivity;
            let strip = StripHeat::new(&properties, &wide, &resolution).unwrap();
            bodies.push((format!("{path:?}, {conductivity} W/(m K)"), Box::new(strip)));
        }
    }
    for (name, body) in &mut bodies {
        for velocity in [0.0, 0.1, 10.0] {
            for stage in [Stage::First, Stage::End] {
                let mut rate = |step: f64| {
                    body.prepare(&Step::new(step, [velocity; 2]));
                    body.influence(stage).distortion.amax() / step
                };
                let resolved = rate(0.01 / (1.0 + velocity));
                assert!(resolved > 0.0, "{name} does not expand");
                for step in [1e-3, 1e-4, 1e-5, 1e-6] {
                    let found = rate(step / (1.0 + velocity));
                    assert!(
                        found > resolved / 3.0 && found < 3.0 * resolved,
                        "{name}, {velocity} m/s, {stage:?}, {step} s: {found:e} for {resolved:e} m3/(W s)"
                    );
                }
            }
        }
    }
}
