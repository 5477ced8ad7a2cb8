//! Second half of `cargo fmu bench --line`: the line level as the FMU runs it, through the component.
//!
//! Steps of 1 ms with mean heat, in solutions of one dense system of as many unknowns and in microseconds;
//! initialisation with the punch as an elastic block; saved states; the relaxation of a flat punch on a half-plane to
//! tau = 1.

use super::{Cost, TURNS};
use crate::scenes;
use anyhow::{Context, Result, anyhow, ensure};
use exact::GalinRelaxation;
use scene::variables::{STARTS, changed, find};
use sliding_contact::component::{Component, Snapshot, Values};
use std::sync::Arc;
use std::time::Instant;
use verification::timed_steps::{DenseSolution, STEPS};

/// Steps timed together.
const CHUNK: usize = 20;
/// Chunks of a turn.
const CHUNKS: usize = 10;
/// Turns of a step with heat and without.
const HOT_TURNS: usize = 100;

/// Rigid punch on a half-plane, unidirectional sliding.
const PUNCH: &[(&str, f64)] = &[
    ("solver.fidelity", 3.0),
    ("solver.heat", 2.0),
    ("punch.width", 0.06),
    ("depth", 0.01),
    ("punch.body", 1.0),
    ("strip.body", 3.0),
    ("strip.youngs_modulus", 200e9),
    ("strip.poissons_ratio", 0.3),
    ("strip.path", 2.0),
    ("strip.length", 2.0),
    ("contact.geometry", 1.0),
    ("contact.mean_radius", 0.0),
    ("contact.faces", 1.0),
    ("punch.count", 1.0),
    ("punch.thermal_expansion", 0.0),
    ("strip.thermal_expansion", 0.0),
    ("punch.wear_coefficient", 1e-13),
    ("strip.wear_coefficient", 0.0),
    ("nominal.load", 1e4),
    ("nominal.velocity", 1.0),
    ("nominal.duration", 100.0),
];

pub(super) fn component(starts: &Values, changes: &[(&str, f64)]) -> Result<Component> {
    let starts = changed(starts, changes).map_err(|text| anyhow!(text))?;
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).map_err(|text| anyhow!(text))?;
    Ok(component)
}

/// The name is kept until the program ends; there are few.
pub(super) fn cost(quantity: String, value: f64, unit: &'static str, limit: f64, gated: bool) -> Cost {
    Cost { quantity: quantity.leak(), value, unit, peer: None, limit, gated }
}

pub(crate) fn measure() -> Result<Vec<Cost>> {
    let mut costs = Vec::new();
    for (count, target) in [(33, 10.0), (129, 150.0)] {
        steps(count, target, &mut costs)?;
    }
    for (count, target) in [(33, 30.0), (129, 400.0)] {
        hot_steps(count, target, &mut costs)?;
    }
    initialisation(&mut costs)?;
    states(&mut costs)?;
    relaxation(&mut costs)?;
    Ok(costs)
}

/// Steps of 1 ms, with three outputs read after each.
fn steps(count: usize, target: f64, costs: &mut Vec<Cost>) -> Result<()> {
    let mut solution = DenseSolution::new(count);
    type Drive = fn(usize) -> [f64; 2];
    let drives: [(&str, f64, Drive); 3] = [
        ("v, mu and status stay", 5.0, |_| [1.0, 1e4]),
        ("the load changes", 5.0, |n| [1.0, 1e4 + 100.0 * (0.3 * n as f64).sin()]),
        ("the speed changes", 25.0, |n| [1.0 + 1e-4 * n as f64, 1e4]),
    ];
    for (name, limit, drive) in drives {
        let mut component = component(&STARTS, &[PUNCH, &[("solver.cells", count as f64)]].concat())?;
        let (mut fastest, mut unit, mut number) = (f64::INFINITY, f64::INFINITY, 0);
        // The edges relax first.
        for _ in 0..2000 {
            advance(&mut component, drive(0))?;
        }
        let before = component.work();
        for _ in 0..TURNS {
            unit = unit.min(solution.seconds(STEPS));
            for _ in 0..CHUNKS {
                let begin = Instant::now();
                for _ in 0..CHUNK {
                    advance(&mut component, drive(number))?;
                    number += 1;
                }
                fastest = fastest.min(begin.elapsed().as_secs_f64() / CHUNK as f64);
            }
        }
        let after = component.work();
        eprintln!(
            "N = {count:3}, {name:24} {:8.2} µs a doStep, {:6.2} solutions of {:.3} µs; {:.2} internal steps, {:.3} rejected",
            1e6 * fastest,
            fastest / unit,
            1e6 * unit,
            (after.0 - before.0) as f64 / number as f64,
            (after.1 - before.1) as f64 / number as f64
        );
        costs.push(cost(format!("doStep, N = {count}, {name}"), fastest / unit, "1", limit, true));
        costs.push(cost(format!("doStep, N = {count}, {name}"), 1e6 * fastest, "us", target, false));
    }
    Ok(())
}

/// Velocity, its rate and load of a step.
type Drive = fn(usize) -> [f64; 3];

/// Name, start values and inputs of a timed case.
type Case<'a> = (&'static str, &'a [(&'static str, f64)], Drive);

/// Steps of 1 ms of the reciprocating punch with resolved heat, against the same steps without; both in turns.
fn hot_steps(count: usize, target: f64, costs: &mut Vec<Cost>) -> Result<()> {
    let starts = scenes::load(Some("reciprocating_punch"))?.packaged.starts;
    let line = [("solver.fidelity", 3.0), ("solver.cells", count as f64)];
    let cold = [("solver.heat", 2.0), ("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
    let unidirectional = [("nominal.stroke", 0.0), ("strip.path", 1.0)];
    let cases: [Case<'_>; 3] = [
        ("reciprocating", &[], |n| {
            let velocity = |n: usize| 0.015 * (0.01 * n as f64).cos();
            [velocity(n), (velocity(n + 1) - velocity(n)) / 1e-3, 1e4]
        }),
        ("unidirectional, the speed changes", &unidirectional, |n| {
            let velocity = |n: usize| 0.012 + 0.003 * (0.01 * n as f64).cos();
            [velocity(n), (velocity(n + 1) - velocity(n)) / 1e-3, 1e4]
        }),
        ("unidirectional, the load changes", &unidirectional, |n| [0.0095, 0.0, 1e4 + 100.0 * (0.3 * n as f64).sin()]),
    ];
    for (name, changes, drive) in cases {
        let mut both = [
            component(&starts, &[&line[..], changes].concat())?,
            component(&starts, &[&line[..], changes, &cold].concat())?,
        ];
        let (mut fastest, mut number) = ([f64::INFINITY; 2], 0);
        for turn in 0..HOT_TURNS {
            for (component, fastest) in both.iter_mut().zip(&mut fastest) {
                let begin = Instant::now();
                for step in number..number + CHUNK {
                    let [velocity, slope, load] = drive(step);
                    component.set_input(0, velocity);
                    component.set_input_derivative(0, slope);
                    component.set_input(1, load);
                    component.step(1e-3).map_err(|text| anyhow!(text))?;
                }
                // The first turns fill the caches.
                if turn >= CHUNKS {
                    *fastest = fastest.min(begin.elapsed().as_secs_f64() / CHUNK as f64);
                }
            }
            number += CHUNK;
        }
        let [hot, cold] = fastest;
        // Shown only: the cost of heat is judged by its time, and the ratio depends on how fast the step without heat is.
        costs.push(cost(format!("doStep with heat over without, N = {count}, {name}"), hot / cold, "1", 3.0, false));
        costs.push(cost(format!("doStep with heat, N = {count}, {name}"), 1e6 * hot, "us", target, false));
    }
    Ok(())
}

fn advance(component: &mut Component, [velocity, load]: [f64; 2]) -> Result<()> {
    component.set_input(0, velocity);
    component.set_input(1, load);
    component.step(1e-3).map_err(|text| anyhow!(text))?;
    for name in ["wear_depth", "contact_temperature", "friction_force"] {
        std::hint::black_box(component.get(find(name).expect("a row of the table")));
    }
    Ok(())
}

/// The reciprocating punch, both bodies elastic, anew and with unchanged geometry.
fn initialisation(costs: &mut Vec<Cost>) -> Result<()> {
    let starts = scenes::load(Some("reciprocating_punch"))?.packaged.starts;
    // Without heat: resolved heat builds thermal bodies of its own.
    let changes = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 33.0),
        ("solver.tolerance", 1e-4),
        ("solver.heat", 2.0),
        ("punch.thermal_expansion", 0.0),
        ("strip.thermal_expansion", 0.0),
    ];
    let (mut anew, mut again) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..10 {
        let begin = Instant::now();
        let mut component = component(&starts, &changes)?;
        anew = anew.min(begin.elapsed().as_secs_f64());
        component.reset();
        let begin = Instant::now();
        component.enter_initialization();
        component.initialise(None).map_err(|text| anyhow!(text))?;
        again = again.min(begin.elapsed().as_secs_f64());
    }
    costs.push(cost("initialisation, elastic block, N = 33, 1e-4".into(), 1e3 * anew, "ms", 50.0, true));
    costs.push(cost("reset + initialise, the same geometry, N = 33".into(), 1e3 * again, "ms", 0.3, false));
    let mut hot = f64::INFINITY;
    for _ in 0..10 {
        let begin = Instant::now();
        component(&starts, &changes[..3])?;
        hot = hot.min(begin.elapsed().as_secs_f64());
    }
    costs.push(cost("initialisation with heat, N = 33, 1e-4".into(), 1e3 * hot, "ms", 150.0, false));
    Ok(())
}

/// Saving and restoring a state: on 129 cells with a worn track, and with resolved heat and its companion.
fn states(costs: &mut Vec<Cost>) -> Result<()> {
    let track = [
        ("solver.cells", 129.0),
        ("strip.path", 1.0),
        ("strip.length", 0.0),
        ("strip.wear_coefficient", 1e-13),
        ("nominal.stroke", 0.02),
    ];
    let worn = component(&STARTS, &[PUNCH, &track].concat())?;
    let companion = [("solver.fidelity", 3.0), ("solver.cells", 33.0), ("solver.error_estimate", 3.0)];
    let hot = component(&scenes::load(Some("disc_brake"))?.packaged.starts, &companion)?;
    for (name, mut component) in [("N = 129, worn track", worn), ("N = 33, heat, companion", hot)] {
        for _ in 0..3 {
            advance(&mut component, [0.1, 1e4])?;
        }
        let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
        let mut fastest = f64::INFINITY;
        for _ in 0..TURNS {
            let begin = Instant::now();
            component.snapshot(&mut saved);
            component.restore(&saved).map_err(|text| anyhow!(text))?;
            fastest = fastest.min(begin.elapsed().as_secs_f64());
        }
        saved.encode(&mut bytes);
        costs.push(cost(format!("get + set state, {name}"), 1e6 * fastest, "us", 30.0, true));
        costs.push(cost(format!("serialised state, {name}"), bytes.len() as f64, "byte", 262_144.0, true));
    }
    Ok(())
}

/// From the flat punch's singular pressure to tau = k s E*/a = 1 in one doStep, within 1e-3 at |x| < 0.9 a.
fn relaxation(costs: &mut Vec<Cost>) -> Result<()> {
    let changes = [
        ("solver.cells", 33.0),
        ("solver.tolerance", 2e-3),
        ("contact.shear_coupling", 0.0),
        ("contact.initial_shape", 1.0),
    ];
    let (modulus, half_width, wear) = (200e9 / 0.91, 0.03, 1e-13);
    let duration = half_width / (wear * modulus);
    let exact = GalinRelaxation::new(40);
    let (mut fastest, mut error) = (f64::INFINITY, 0.0_f64);
    for _ in 0..TURNS {
        let mut component = component(&STARTS, &[PUNCH, &changes].concat())?;
        component.set_input(0, 1.0);
        component.set_input(1, 1e4);
        let begin = Instant::now();
        component.step(duration).map_err(|text| anyhow!(text))?;
        fastest = fastest.min(begin.elapsed().as_secs_f64());
        let mean = 1e4 / 6e-4;
        error = 0.0;
        for station in 2..31 {
            let x = station as f64 / 16.0 - 1.0;
            let name = format!("profile.pressure[{}]", station + 1);
            let pressure = component.get(find(&name).context("a station")?);
            let truth = exact.mean_pressure(1.0, x - 1.0 / 32.0, x + 1.0 / 32.0);
            error = error.max((pressure / mean - truth).abs());
        }
    }
    ensure!(error < 1e-3, "the relaxation to tau = 1 is off by {error:e} of the mean pressure");
    costs.push(cost(format!("relaxation to tau = 1, error {error:.1e}"), 1e3 * fastest, "ms", 1.0, true));
    Ok(())
}
