//! Direct solutions for steady states with heat, and cycle jumps, against Fourier sums, time stepping and Galin's relaxation.
//!
//! Theory: docs/theory.md, sections 9.4, 9.6.

use super::driver::Driven;
use super::{Fallible, Problem, known};
use elasticity::discretization::{cells_for, compliances};
use exact::GalinRelaxation;
use exact::reference::{ClosedPath, LayerBase};
use model::line::cycle::map::sliding_scene;
use model::line::cycle::{CycleMap, JumpOptions, Jumps, MapResolution};
use model::line::operators::LineOperators;
use numerics::maximum::{largest, maximum};
use scene::Scene;
use scene::variables::changed;
use sliding_contact::component::Values;
use steady::states::Sliding;
use steady::thermal::{HotState, hot_state, nominal_half_strokes};

const CLOSED: f64 = 2.0;
const INSULATED: f64 = 3.0;
const AMBIENT: f64 = 293.15;

/// The reciprocating punch of the examples, steel on steel, at 6 mm wide and high, without air: thermal transients end within seconds.
const SMALL: &[(&str, f64)] = &[
    ("solver.fidelity", 3.0),
    ("solver.cells", 17.0),
    ("punch.width", 6e-3),
    ("punch.height", 6e-3),
    ("punch.convection", 0.0),
    ("punch.wear_coefficient", 4e-13),
    ("strip.height", 6e-3),
    ("strip.convection", 0.0),
    ("strip.convection_forced", 0.0),
    ("nominal.load", 1e3),
    ("nominal.velocity", 0.01),
    ("nominal.stroke", 1e-3),
    ("nominal.duration", 60.0),
];

/// Mean pressure of [`SMALL`], Pa.
const MEAN: f64 = 1e3 / (6e-3 * 0.01);

fn small(changes: &[(&str, f64)]) -> Fallible<Values> {
    let punch = scene_file::parse(include_str!("../../../examples/reciprocating_punch/scene.toml"))?;
    Ok(changed(&punch.packaged.starts, &[SMALL, changes].concat())?)
}

fn scene(changes: &[(&str, f64)]) -> Fallible<Scene> {
    Ok(Scene::new(&small(changes)?, None)?)
}

fn hot(changes: &[(&str, f64)]) -> Fallible<HotState> {
    let scene = scene(changes)?;
    let cells = cells_for(&scene, scene.cells)?;
    let bodies = compliances(&scene, &cells)?;
    Ok(hot_state(&scene, &cells, &bodies, &Sliding::nominal(&scene))?)
}

pub(super) fn problems(all: &mut Vec<Problem>) {
    closed_paths(all);
    unidirectional(all);
    reciprocating(all);
    relaxation(all);
}

/// A run-in insulating punch on a ring: uniform pressure and flux.
fn closed_paths(all: &mut Vec<Problem>) {
    for velocity in [0.01, 1.0, 30.0] {
        let path = ClosedPath {
            length: 0.05,
            half_length: 3e-3,
            height: 6e-3,
            conductivity: 55.0,
            diffusivity: 55.0 / (7800.0 * 460.0),
            base: LayerBase::Held,
        };
        let flux = 0.25 * MEAN * velocity;
        let uniform = 2.0 * path.half_length / path.length * path.height / path.conductivity;
        all.push(Problem {
            name: format!("direct hot state on a closed path, plain Fourier sum, {velocity} m/s"),
            quantity: "rise of the contact temperature, K",
            exact: Box::new(move || Ok(flux * (path.steady_mean(velocity, 200_000) + uniform))),
            scale: None,
            compute: Box::new(move || {
                let state = hot(&[
                    ("solver.cells", 33.0),
                    ("strip.path", CLOSED),
                    ("strip.length", 0.05),
                    ("punch.conductivity", 0.0),
                    ("contact.conductance", 1e15),
                    ("nominal.stroke", 0.0),
                    ("nominal.velocity", velocity),
                ])?;
                Ok(state.heat.contact_temperature[1] - AMBIENT)
            }),
            bound: 1e-4,
            reason: "reduction and table over the velocity",
        });
    }
}

/// The line level in unidirectional sliding, stepped to the steady state.
fn unidirectional(all: &mut Vec<Problem>) {
    let way: &[(&str, f64)] = &[("nominal.stroke", 0.0), ("nominal.velocity", 0.05), ("nominal.duration", 400.0)];
    for (name, changes) in [
        ("straight path", &[][..]),
        (
            "closed path, insulated base",
            &[("strip.path", CLOSED), ("strip.length", 0.05), ("strip.base_thermal", INSULATED)],
        ),
    ] {
        let all_changes = [way, changes].concat();
        let direct = all_changes.clone();
        all.push(Problem {
            name: format!("direct unidirectional hot state against long stepping, {name}"),
            quantity: "rise of the contact temperature, K",
            exact: Box::new(move || {
                let mut driven = Driven::of(small(&all_changes)?)?;
                driven.set("normal_load", 1e3)?;
                driven.set("sliding_velocity", 0.05)?;
                for step in 0..60 {
                    driven.steps(0.01 * 1.2_f64.powi(step), 1)?;
                }
                Ok(driven.get("contact_temperature")? - AMBIENT)
            }),
            scale: None,
            compute: Box::new(move || Ok(hot(&direct)?.heat.contact_temperature[1] - AMBIENT)),
            bound: 1e-3,
            reason: "bodies reduced for different durations at solver.tolerance = 1e-3",
        });
    }
}

/// The line level in reciprocating sliding, stepped to the steady cycle.
fn reciprocating(all: &mut Vec<Problem>) {
    for (quantity, scale, bound) in [
        ("peak pressure at the end of a half-stroke, Pa", None, 1e-3),
        ("largest contact temperature in a cycle, K", Some(1.5), 2e-3),
    ] {
        let pressure = scale.is_none();
        all.push(Problem {
            name: format!(
                "direct reciprocating hot cycle against 300 stepped cycles, {}",
                if pressure { "pressure" } else { "heat" }
            ),
            quantity,
            exact: Box::new(move || {
                let mut driven = Driven::of(small(&[("solver.cells", 9.0), ("solver.tolerance", 1e-4)])?)?;
                driven.set("normal_load", 1e3)?;
                let mut hottest = 0.0;
                for cycle in 0..300 {
                    let steps = if cycle == 299 { 40 } else { 10 };
                    for velocity in [0.01, -0.01] {
                        driven.set("sliding_velocity", velocity)?;
                        for _ in 0..steps {
                            driven.steps(0.1 / f64::from(steps), 1)?;
                            if cycle == 299 {
                                hottest = maximum(hottest, driven.get("contact_temperature")?);
                            }
                        }
                    }
                }
                if pressure { driven.get("pressure_max") } else { Ok(hottest) }
            }),
            scale,
            compute: Box::new(move || {
                let state = hot(&[("solver.cells", 9.0)])?;
                Ok(if pressure {
                    largest(state.heat.strokes[1].pressure_at[1].iter().copied())
                } else {
                    state.heat.contact_temperature[2]
                })
            }),
            bound,
            reason: "steps of a tenth of the half-stroke on the way, and the rest of the transient",
        });
    }
}

/// A flat rigid punch on a half-plane, tau = 1 after a million cycles.
fn relaxation(all: &mut Vec<Problem>) {
    for (x, exact) in [(0.0, 0.91408), (0.5, 0.99292), (0.9, 1.0931)] {
        debug_assert!((GalinRelaxation::new(60).pressure(1.0, x) - exact).abs() < 1e-3);
        all.push(Problem {
            name: format!("a million cycles in jumps, Galin's relaxation at tau = 1, x = {x} a"),
            quantity: "p/p_m",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || {
                let (cycles, modulus) = (1e6, 200e9 / (1.0 - 0.09));
                let scene = scene(&[
                    ("punch.body", 1.0),
                    ("strip.body", 3.0),
                    ("contact.shear_coupling", 0.0),
                    ("punch.wear_coefficient", 3e-3 / (cycles * 2e-3 * modulus)),
                    ("solver.cells", 65.0),
                ])?;
                let operators = LineOperators::with_heat(&sliding_scene(&scene), false, steady::run_in)?;
                let mut map = CycleMap::new(operators, nominal_half_strokes(&scene), MapResolution::COLD)?;
                let start = map.start();
                let cells = map.operators().cells.clone();
                let mut jumps = Jumps::new(&mut map, start, JumpOptions::default());
                let mut pressure = Vec::new();
                let watch = |jump: &model::line::cycle::Jump| pressure.clone_from(&jump.passage.strokes[1].pressure);
                jumps.carry_to(cycles, watch)?;
                Ok(cells.point_value(&pressure, 3e-3 * x) / MEAN)
            }),
            bound: 2e-3,
            reason: "estimates of 1e-3 a jump, 65 cells",
        });
    }
}
