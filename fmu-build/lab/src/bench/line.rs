//! `cargo fmu bench --line`: cost of a wear step of the contact line, in solutions of one dense system.
//!
//! The unit is one solution with the cached LU factors of an N x N matrix by faer, timed in turns with the steps. A step of
//! the second-order scheme solves two contact problems of N cells.

use super::{Cost, TURNS};
use anyhow::{Result, anyhow, ensure};
use contact::wear::line::{CellRate, Coefficient, Conditions, WearingContact};
use contact::{ContactState, Normal, Tilt, WorkCounter, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting as lu;
use faer::perm::PermRef;
use faer::{Mat, Par};
use nalgebra::DMatrix;
use std::time::Instant;
use verification::integrator::{Integrator, Scheme};

/// Steps of a turn, and how many of them are timed together: few, so that other work on the machine seldom falls between.
const STEPS: usize = 60;
const CHUNK: usize = 4;
/// Wear per step over the elastic displacement, both under the mean pressure.
const STEP: f64 = 0.01;

/// One kind of step.
struct Case {
    name: &'static str,
    /// Most that a step may cost, in solutions; `None`: shown only.
    limit: Option<f64>,
    exponent: f64,
    /// Radius of curvature of the punch against the elastic displacement; infinite: flat.
    curvature: f64,
    /// Load, speed and friction coefficient over the number of the step.
    drive: fn(f64) -> [f64; 3],
}

const CASES: [Case; 8] = [
    Case { name: "nothing changes", limit: Some(5.0), exponent: 1.0, curvature: 0.0, drive: |_| [2.0, 1.0, 0.2] },
    Case {
        name: "the load changes",
        limit: Some(5.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0 + 0.02 * (0.3 * n).sin(), 1.0, 0.2],
    },
    Case {
        name: "reciprocating",
        // An edge cell touches down and lifts off within every stroke.
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0, if n % 2.0 == 0.0 { 0.2 } else { -0.2 }],
    },
    Case {
        name: "the speed changes",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0 + 0.01 * n, 0.2],
    },
    Case {
        name: "the friction changes",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0, 0.2 + 0.001 * n],
    },
    Case {
        name: "a cell enters or leaves",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 1.0,
        drive: |n| [0.3 + 0.02 * n, 1.0, 0.2],
    },
    Case { name: "b = .5, nothing changes", limit: None, exponent: 0.5, curvature: 0.0, drive: |_| [2.0, 1.0, 0.2] },
    Case { name: "b = 2, nothing changes", limit: None, exponent: 2.0, curvature: 0.0, drive: |_| [2.0, 1.0, 0.2] },
];

/// Measures steps of contacts of 33 and 129 cells.
///
/// # Errors
/// Where a step fails.
pub fn measure() -> Result<Vec<Cost>> {
    let mut costs = Vec::new();
    for count in [33, 129] {
        let mut solution = Solution::new(count);
        for case in &CASES {
            let mut line = Line::new(count, case)?;
            line.turn(case)?;
            let (mut fastest, mut unit) = ([f64::INFINITY; STEPS / CHUNK], f64::INFINITY);
            for _ in 0..TURNS {
                unit = unit.min(solution.seconds());
                for (fastest, seconds) in fastest.iter_mut().zip(line.turn(case)?) {
                    *fastest = fastest.min(seconds);
                }
            }
            let best = fastest.iter().sum::<f64>() / STEPS as f64;
            let counter = line.work();
            eprintln!(
                "N = {count:3}, {:24} {:8.2} µs a step, {:6.2} solutions of {:.3} µs; {counter}",
                case.name,
                1e6 * best,
                best / unit,
                1e6 * unit
            );
            costs.push(Cost {
                // Few, and shown until the program ends.
                quantity: format!("N = {count}, {}", case.name).leak(),
                value: best / unit,
                unit: "1",
                peer: None,
                limit: case.limit.unwrap_or(25.0),
                gated: case.limit.is_some(),
            });
        }
    }
    Ok(costs)
}

/// A contact and its integrator, and where every turn starts.
struct Line {
    contact: WearingContact,
    integrator: Integrator,
    worn: Vec<f64>,
    state: ContactState,
    before: (WorkCounter, u64),
    after: (WorkCounter, u64),
}

impl Line {
    fn new(count: usize, case: &Case) -> Result<Self> {
        let cells = Cells::graded(1.0, count)?;
        // E* = 1: with a = 1 and a mean pressure of 1 everything is of order 1.
        let strip = HalfPlane { material: Material::new(0.91, 0.3)? };
        let (normal, shear) = pair_operators(&Rigid.compliance(&cells), &strip.compliance(&cells));
        let gap = cells.centres().iter().map(|x| case.curvature * x * x).collect();
        let contact =
            WearingContact::new(&cells, cells.widths(), normal, shear, gap).map_err(|error| anyhow!("{error}"))?;
        let zero = (WorkCounter::default(), 0);
        Ok(Self {
            contact,
            integrator: Integrator::new(Scheme::Sdirk2, count),
            worn: vec![0.0; count],
            state: ContactState::new(count),
            before: zero,
            after: zero,
        })
    }

    /// Seconds of every chunk of steps of a turn that starts after some wear.
    fn turn(&mut self, case: &Case) -> Result<[f64; STEPS / CHUNK]> {
        self.worn.fill(0.0);
        // Caches of the last turn are dropped.
        let count = self.worn.len();
        let none = DMatrix::zeros(count, count);
        for extra in [Some(&none), None] {
            self.contact.set_added_compliance(extra).map_err(|error| anyhow!("{error}"))?;
        }
        let mut conditions = |n: f64, c: &mut Conditions| {
            let [load, speed, friction] = (case.drive)(n);
            c.signed_friction = friction;
            (c.normal, c.tilt) = (Normal::Load(load), Tilt::Fixed(0.0));
            if c.rate.terms.is_empty() {
                c.rate = CellRate::uniform(1.0, 1.0, case.exponent);
            }
            c.rate.terms[0].coefficient = Coefficient::Uniform(speed);
        };
        let run = |line: &mut Self, steps: std::ops::Range<usize>, conditions: &mut dyn FnMut(f64, &mut Conditions)| {
            for n in steps {
                // Conditions are those of the step, the same in both stages, unless the speed changes.
                let changing = case.name.contains("speed");
                let at = |time: f64| if changing { n as f64 + (time - STEP * n as f64) / STEP } else { n as f64 };
                let step = line.integrator.step(
                    &mut line.contact,
                    &mut line.worn,
                    STEP * n as f64,
                    STEP,
                    &mut |time, c| conditions(at(time), c),
                    &mut line.state,
                );
                step.map_err(|error| anyhow!("{error}"))?;
            }
            anyhow::Ok(())
        };
        run(self, 0..10, &mut conditions)?;
        self.before = (self.contact.counter(), self.contact.newton_iterations());
        let mut seconds = [0.0; STEPS / CHUNK];
        for (k, seconds) in seconds.iter_mut().enumerate() {
            let begin = Instant::now();
            run(self, 10 + k * CHUNK..10 + (k + 1) * CHUNK, &mut conditions)?;
            *seconds = begin.elapsed().as_secs_f64();
        }
        self.after = (self.contact.counter(), self.contact.newton_iterations());
        ensure!(self.state.pressure.iter().all(|p| p.is_finite()), "the pressure is not finite");
        Ok(seconds)
    }

    /// Work per step of the last turn.
    fn work(&self) -> String {
        let per_step = |after: u64, before: u64| (after - before) as f64 / STEPS as f64;
        let (after, before) = (self.after.0, self.before.0);
        format!(
            "{:.2} active sets, {:.2} factorisations, {:.2} Newton iterations a step",
            per_step(after.iterations, before.iterations),
            per_step(after.factorisations, before.factorisations),
            per_step(self.after.1, self.before.1)
        )
    }
}

/// The unit: one solution with cached factors.
pub(super) struct Solution {
    factors: Mat<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    right: Mat<f64>,
    memory: MemBuffer,
}

impl Solution {
    pub(super) fn new(count: usize) -> Self {
        let entry = |i: usize, j: usize| if i == j { 4.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) };
        let mut factors = Mat::from_fn(count, count, entry);
        let (mut forward, mut inverse) = (vec![0; count], vec![0; count]);
        let parameters = Default::default();
        let mut memory = MemBuffer::new(
            lu::factor::lu_in_place_scratch::<usize, f64>(count, count, Par::Seq, parameters)
                .or(lu::solve::solve_in_place_scratch::<usize, f64>(count, 1, Par::Seq)),
        );
        lu::factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut memory),
            parameters,
        );
        Self { factors, forward, inverse, right: Mat::from_fn(count, 1, |i, _| i as f64), memory }
    }

    /// Seconds per solution.
    pub(super) fn seconds(&mut self) -> f64 {
        let count = self.factors.nrows();
        let exchange = PermRef::new_checked(&self.forward, &self.inverse, count);
        let begin = Instant::now();
        for _ in 0..STEPS {
            for i in 0..count {
                self.right[(i, 0)] = i as f64;
            }
            lu::solve::solve_in_place(
                self.factors.as_ref(),
                self.factors.as_ref(),
                exchange,
                self.right.as_mut(),
                Par::Seq,
                MemStack::new(&mut self.memory),
            );
        }
        begin.elapsed().as_secs_f64() / STEPS as f64
    }
}
