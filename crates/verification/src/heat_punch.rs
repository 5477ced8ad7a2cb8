//! The reduced punch against its unreduced finite elements: a step, a ramp and a flux of 10 Hz.
//!
//! Theory: docs/theory.md, sections 4.6, 4.8.

use super::{Fallible, Problem, known};
use conduction::line::punch::reduce;
use conduction::line::reduced::ReducedHeat;
use conduction::line::{GAMMA, Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use elasticity::Cells;
use exact::unreduced_punch::Unreduced;
use numerics::maximum::{largest, maximum};
use scene::Scene;
use scene::variables::{STARTS, changed};
use std::f64::consts::PI;

const CELLS: usize = 33;
const HALF_WIDTH: f64 = 0.03;
const TOLERANCE: f64 = 1e-4;
const DURATION: f64 = 1000.0;

/// Steel punch, 60 mm x 100 mm x 10 mm, convecting at its top and sides.
fn scene() -> Fallible<Scene> {
    let changes = [
        ("punch.width", 2.0 * HALF_WIDTH),
        ("punch.height", 0.1),
        ("depth", 0.01),
        ("punch.conductivity", 55.0),
        ("punch.density", 7800.0),
        ("punch.specific_heat", 460.0),
        ("punch.thermal_expansion", 1.1e-5),
        ("punch.poissons_ratio", 0.3),
        ("punch.convection", 300.0),
        ("punch.top_thermal", 2.0),
    ];
    Ok(Scene::new(&changed(&STARTS, &changes)?, None)?)
}

/// Reduced punch with temperatures and distortions of the last step.
struct Reduced {
    heat: ReducedHeat,
    state: Vec<f64>,
    temperature: Vec<f64>,
    distortion: Vec<f64>,
}

impl Reduced {
    fn new(scene: &Scene, cells: &Cells) -> Fallible<Reduced> {
        let heat = reduce(scene, cells, TOLERANCE, DURATION)?;
        let heat = heat.ok_or("the punch conducts no heat")?;
        let state = vec![0.0; heat.states()];
        Ok(Reduced { heat, state, temperature: vec![0.0; CELLS], distortion: vec![0.0; CELLS] })
    }

    fn step(&mut self, step: f64, first: &[f64], end: &[f64]) {
        let around = Surroundings::default();
        self.heat.prepare(&Step::new(step, [0.0; 2]));
        self.heat.free_response(&self.state, &around, Stage::End, first, &mut self.temperature, &mut self.distortion);
        let influence = self.heat.influence(Stage::End);
        for i in 0..CELLS {
            for (j, flux) in end.iter().enumerate() {
                self.temperature[i] += influence.temperature[(i, j)] * flux;
                self.distortion[i] += influence.distortion[(i, j)] * flux;
            }
        }
        self.heat.step(&mut self.state, &around, first, end);
    }
}

/// For a flux over the contact times `factor` of the time: largest differences of temperature and distortion, relative to those by a uniform flux of 1 over the duration, at the
/// ends of runs of 40 steps each.
fn differences(factor: fn(f64) -> f64, steps: &[f64]) -> Fallible<[f64; 2]> {
    let cells = Cells::graded(HALF_WIDTH, CELLS)?;
    let scene = scene()?;
    let flux = |time: f64| -> Vec<f64> {
        cells.centres().iter().map(|x| (0.7 + 0.3 * x / HALF_WIDTH) * factor(time)).collect()
    };
    let (mut reduced, mut unreduced) = (Reduced::new(&scene, &cells)?, Unreduced::new(&scene, &cells)?);
    let mut scale = Reduced::new(&scene, &cells)?;
    scale.step(DURATION, &[1.0; CELLS], &[1.0; CELLS]);
    let scale = [&scale.temperature, &scale.distortion].map(|values| largest(values.iter().map(|value| value.abs())));
    let (mut time, mut worst) = (0.0, [0.0_f64; 2]);
    for &step in steps {
        unreduced.run(time, step, 40, &flux)?;
        for i in 0..40 {
            let before = time + step * f64::from(i);
            reduced.step(step, &flux(before + GAMMA * step), &flux(before + step));
        }
        time += 40.0 * step;
        let expected = [unreduced.temperature(&flux(time))?, unreduced.distortion()?];
        for (quantity, own) in [&reduced.temperature, &reduced.distortion].into_iter().enumerate() {
            let difference = largest(own.iter().zip(&expected[quantity]).map(|(own, other)| (own - other).abs()));
            worst[quantity] = maximum(worst[quantity], difference / scale[quantity]);
        }
    }
    Ok(worst)
}

pub(super) fn problems() -> Vec<Problem> {
    let mut all = Vec::new();
    type Factor = fn(f64) -> f64;
    let fluxes: [(&str, Factor, &'static [f64]); 3] = [
        ("a step", |_| 1.0, &[1e-3, 1e-2, 0.1, 0.5]),
        ("a ramp", |time| time / 24.0, &[1e-3, 1e-2, 0.1, 0.5]),
        ("a flux of 10 Hz", |time| (20.0 * PI * time).sin(), &[1e-3; 4]),
    ];
    for (name, factor, steps) in fluxes {
        all.push(Problem {
            name: format!("reduced punch against finite elements, {name}"),
            quantity: "largest difference of temperature and distortion, relative",
            exact: known(0.0),
            scale: Some(1.0),
            compute: Box::new(move || differences(factor, steps).map(|[warm, moved]| maximum(warm, moved))),
            bound: TOLERANCE,
            reason: "tolerance of the reduction",
        });
    }
    all
}
