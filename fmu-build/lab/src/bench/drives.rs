//! Third part of `cargo fmu bench --line`: a brake stop and a city cycle on the contact line, and what their initialisation takes.
//!
//! The disc brake of the examples stops a car from 100 km/h at 8 m/s2, and drives the UDDS. Every communication step has another
//! velocity, so what counts here are the operators of a step that is met only once. The unit is one dense system of as many
//! unknowns, factorised and solved.

use super::level::{component, cost};
use super::{Cost, DRIVE_TURNS};
use crate::scenes;
use anyhow::{Result, anyhow};
use fmu_build::bench;
use sliding_contact::component::{Component, Snapshot, Values};
use std::time::Instant;
use verification::timed_steps::{DenseSolution, STEPS};

/// Rubbing speed at 100 km/h (m/s), and what it loses (m/s2): those of the car by the mean radius of the ring over that of the
/// wheel.
const SPEED: f64 = 100.0 / 3.6 * 0.1175 / 0.31;
const DECELERATION: f64 = 8.0 * 0.1175 / 0.31;
/// Clamping force that decelerates a car of 1,500 kg so, N, and the time in which it rises, s.
const LOAD: f64 = 13_851.0;
const RISE: f64 = 0.2;

/// Communication step, s, and velocity (m/s) and load (N) at its ends, step by step.
struct Drive {
    step: f64,
    points: Vec<[f64; 2]>,
}

impl Drive {
    fn stop() -> Drive {
        let step = 0.01;
        let count = (SPEED / (DECELERATION * step)) as usize;
        let at = |time: f64| [SPEED - DECELERATION * time, LOAD * (time / RISE).min(1.0)];
        Drive { step, points: (0..=count).map(|number| at(number as f64 * step)).collect() }
    }

    fn city() -> Result<Drive> {
        Ok(Drive { step: bench::STEP, points: bench::drive(bench::STEP)? })
    }

    /// Makes every step of the drive; `fastest` are the shortest times so far, s.
    fn make(&self, component: &mut Component, fastest: &mut [f64]) -> Result<()> {
        for (ends, fastest) in self.points.windows(2).zip(fastest) {
            let begin = Instant::now();
            for (input, (from, to)) in (0..).zip(ends[0].iter().zip(&ends[1])) {
                component.set_input(input, *from);
                component.set_input_derivative(input, (to - from) / self.step);
            }
            component.step(self.step).map_err(|text| anyhow!(text))?;
            *fastest = fastest.min(begin.elapsed().as_secs_f64());
        }
        Ok(())
    }
}

pub(crate) fn measure() -> Result<Vec<Cost>> {
    let starts = scenes::load(Some("disc_brake"))?.packaged.starts;
    let mut costs = Vec::new();
    for (name, drive, cells, tolerance, target) in [
        ("a brake stop", Drive::stop(), 33, 1e-2, 8.0),
        ("a brake stop", Drive::stop(), 129, 1e-3, 8.0),
        ("the city cycle", Drive::city()?, 17, 1e-2, 3.0),
    ] {
        let nominal = [("nominal.load", LOAD), ("nominal.velocity", SPEED), ("nominal.duration", 4.0)];
        let of_stop = if name == "a brake stop" { &nominal[..] } else { &[] };
        let (mut component, _) = initialised(&starts, cells, tolerance, of_stop)?;
        let mut start = Snapshot::default();
        component.snapshot(&mut start);
        let mut system = DenseSolution::new(cells);
        let count = drive.points.len() - 1;
        let (mut fastest, mut unit) = (vec![f64::INFINITY; count], f64::INFINITY);
        let before = (component.work(), component.contact_work());
        for _ in 0..DRIVE_TURNS {
            unit = unit.min(system.seconds_anew(STEPS));
            component.restore(&start).map_err(|text| anyhow!(text))?;
            drive.make(&mut component, &mut fastest)?;
        }
        let after = (component.work(), component.contact_work());
        let seconds = fastest.iter().sum::<f64>() / count as f64;
        let per_step = |after: u64, before: u64| (after - before) as f64 / count as f64;
        eprintln!(
            "N = {cells:3}, {name}, {:8.2} µs a doStep, {:6.2} systems of {:.2} µs; {:.2} internal steps, {:.2} factorisations",
            1e6 * seconds,
            seconds / unit,
            1e6 * unit,
            // Steps are counted by the state that is restored.
            per_step(after.0.0, before.0.0),
            per_step(after.1.factorisations, before.1.factorisations) / DRIVE_TURNS as f64
        );
        let quantity = format!("doStep of {name}, N = {cells}, {tolerance:.0e}, in systems");
        costs.push(cost(quantity, seconds / unit, "1", target, false));
    }
    for (cells, target) in [(17, 5.0), (33, 7.0)] {
        let mut fastest = f64::INFINITY;
        for _ in 0..10 {
            fastest = fastest.min(initialised(&starts, cells, 1e-2, &[])?.1);
        }
        costs.push(cost(
            format!("initialisation of the disc brake, N = {cells}, 1e-2"),
            1e3 * fastest,
            "ms",
            target,
            false,
        ));
    }
    Ok(costs)
}

/// The disc brake, and the time of its initialisation, s.
fn initialised(starts: &Values, cells: usize, tolerance: f64, changes: &[(&str, f64)]) -> Result<(Component, f64)> {
    let level = [
        ("solver.fidelity", 3.0),
        ("strip.property_table.points", 0.0),
        ("solver.cells", cells as f64),
        ("solver.tolerance", tolerance),
    ];
    let begin = Instant::now();
    let component = component(starts, &[&level[..], changes].concat())?;
    Ok((component, begin.elapsed().as_secs_f64()))
}
