//! Third part of `cargo fmu bench --line`: a brake stop on the contact line.
//!
//! The disc brake of the examples stops a car from 100 km/h at 8 m/s2. Every communication step has another velocity, and
//! the circle is far longer than what conducts within a step, so what counts here are the operators of a step that is met
//! only once.

use super::level::{component, cost};
use super::{Cost, STOP_TURNS};
use crate::scenes;
use anyhow::{Result, anyhow};
use sliding_contact::component::{Component, Snapshot};
use std::time::Instant;

/// Communication step, s.
const STEP: f64 = 0.01;
/// Rubbing speed at 100 km/h (m/s), and what it loses (m/s2): those of the car by the mean radius of the ring over that of the
/// wheel.
const SPEED: f64 = 100.0 / 3.6 * 0.1175 / 0.31;
const DECELERATION: f64 = 8.0 * 0.1175 / 0.31;
/// Clamping force that decelerates a car of 1,500 kg so, N, and the time in which it rises, s.
const LOAD: f64 = 13_851.0;
const RISE: f64 = 0.2;

/// Velocity (m/s), load (N) and their rates over a communication step.
fn drive(number: usize) -> [f64; 4] {
    let time = number as f64 * STEP;
    let rising = time < RISE - 0.5 * STEP;
    let load = if rising { LOAD * time / RISE } else { LOAD };
    [SPEED - DECELERATION * time, load, -DECELERATION, if rising { LOAD / RISE } else { 0.0 }]
}

/// Whole communication steps until rest.
fn steps() -> usize {
    (SPEED / (DECELERATION * STEP)) as usize
}

fn advance(component: &mut Component, number: usize) -> Result<()> {
    let [velocity, load, velocity_rate, load_rate] = drive(number);
    component.set_input(0, velocity);
    component.set_input_derivative(0, velocity_rate);
    component.set_input(1, load);
    component.set_input_derivative(1, load_rate);
    component.step(STEP).map_err(|text| anyhow!(text))
}

/// Measures the stop at 33 and at 129 cells.
///
/// # Errors
/// Where the scene or a step fails.
pub(crate) fn measure() -> Result<Vec<Cost>> {
    let starts = scenes::load(Some("disc_brake"))?.packaged.starts;
    let mut costs = Vec::new();
    for (cells, tolerance, target) in [(33, 1e-2, 150.0), (129, 1e-3, 1500.0)] {
        let changes = [
            ("solver.fidelity", 3.0),
            ("strip.property_table.points", 0.0),
            ("solver.cells", f64::from(cells)),
            ("solver.tolerance", tolerance),
            ("nominal.load", LOAD),
            ("nominal.velocity", SPEED),
            ("nominal.duration", 4.0),
        ];
        let mut component = component(&starts, &changes)?;
        let mut start = Snapshot::default();
        component.snapshot(&mut start);
        let count = steps();
        let mut fastest = vec![f64::INFINITY; count];
        let (mut internal, mut rejected, mut factorisations) = (0, 0, 0);
        for _ in 0..STOP_TURNS {
            component.restore(&start).map_err(|text| anyhow!(text))?;
            let (before, contact) = (component.work(), component.contact_work());
            for (number, fastest) in fastest.iter_mut().enumerate() {
                let begin = Instant::now();
                advance(&mut component, number)?;
                *fastest = fastest.min(begin.elapsed().as_secs_f64());
            }
            let (after, contact_after) = (component.work(), component.contact_work());
            (internal, rejected) = (after.0 - before.0, after.1 - before.1);
            factorisations = contact_after.factorisations - contact.factorisations;
        }
        let seconds: f64 = fastest.iter().sum();
        eprintln!(
            "N = {cells:3}, brake stop, {:8.2} µs a doStep, {:8.2} µs an internal step; {internal} internal steps in {count}, \
             {rejected} rejected, {factorisations} factorisations",
            1e6 * seconds / count as f64,
            1e6 * seconds / (internal + rejected) as f64
        );
        let quantity = |what: &str| format!("{what} of a brake stop, N = {cells}, {tolerance:.0e}");
        costs.push(cost(quantity("doStep"), 1e6 * seconds / count as f64, "us", target, false));
        costs.push(cost(quantity("internal step"), 1e6 * seconds / (internal + rejected) as f64, "us", target, false));
    }
    Ok(costs)
}
