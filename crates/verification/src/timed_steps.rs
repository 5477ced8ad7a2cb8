//! Wear steps of the contact line for `cargo fmu bench --line`, and the unit in which they are timed: one solution of a dense system
//! with cached LU factors, by faer.

use crate::Fallible;
use crate::integrator::{Integrator, Scheme};
use contact::wear::line::{CellRate, Coefficient, Conditions, WearingContact};
use contact::{ContactState, Normal, Tilt, WorkCounter, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting as lu;
use faer::perm::PermRef;
use faer::{Mat, Par};
use nalgebra::DMatrix;
use std::time::Instant;

/// Steps of a turn.
pub const STEPS: usize = 60;
/// Steps that are timed together: few, so that other work on the machine seldom falls between.
pub const CHUNK: usize = 4;
/// Wear per step over the elastic displacement, both under the mean pressure.
const STEP: f64 = 0.01;

/// One kind of step.
pub struct StepCase {
    /// Quantities that change from step to step.
    pub name: &'static str,
    /// Most that a step may cost, in solutions; `None`: shown only.
    pub limit: Option<f64>,
    exponent: f64,
    /// Radius of curvature of the punch against the elastic displacement; infinite: flat.
    curvature: f64,
    /// Load, speed and friction coefficient over the number of the step.
    drive: fn(f64) -> [f64; 3],
}

/// Kinds of steps that are timed.
pub const CASES: [StepCase; 8] = [
    StepCase { name: "nothing changes", limit: Some(5.0), exponent: 1.0, curvature: 0.0, drive: |_| [2.0, 1.0, 0.2] },
    StepCase {
        name: "the load changes",
        limit: Some(5.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0 + 0.02 * (0.3 * n).sin(), 1.0, 0.2],
    },
    StepCase {
        name: "reciprocating",
        // An edge cell touches down and lifts off within every stroke.
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0, if n % 2.0 == 0.0 { 0.2 } else { -0.2 }],
    },
    StepCase {
        name: "the speed changes",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0 + 0.01 * n, 0.2],
    },
    StepCase {
        name: "the friction changes",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 0.0,
        drive: |n| [2.0, 1.0, 0.2 + 0.001 * n],
    },
    StepCase {
        name: "a cell enters or leaves",
        limit: Some(25.0),
        exponent: 1.0,
        curvature: 1.0,
        drive: |n| [0.3 + 0.02 * n, 1.0, 0.2],
    },
    StepCase {
        name: "b = .5, nothing changes",
        limit: None,
        exponent: 0.5,
        curvature: 0.0,
        drive: |_| [2.0, 1.0, 0.2],
    },
    StepCase { name: "b = 2, nothing changes", limit: None, exponent: 2.0, curvature: 0.0, drive: |_| [2.0, 1.0, 0.2] },
];

/// A contact and its integrator, and where every turn starts.
pub struct TimedLine {
    contact: WearingContact,
    integrator: Integrator,
    worn: Vec<f64>,
    state: ContactState,
    before: (WorkCounter, u64),
    after: (WorkCounter, u64),
}

impl TimedLine {
    /// A contact of `count` cells before its first turn.
    pub fn new(count: usize, case: &StepCase) -> Fallible<Self> {
        let cells = Cells::graded(1.0, count)?;
        // E* = 1: with a = 1 and a mean pressure of 1 everything is of order 1.
        let strip = HalfPlane { material: Material::new(0.91, 0.3)? };
        let (normal, shear) = pair_operators(&Rigid.compliance(&cells), &strip.compliance(&cells));
        let gap = cells.centres().iter().map(|x| case.curvature * x * x).collect();
        let contact = WearingContact::new(&cells, cells.widths(), normal, shear, gap)?;
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
    pub fn turn(&mut self, case: &StepCase) -> Fallible<[f64; STEPS / CHUNK]> {
        self.worn.fill(0.0);
        // Caches of the last turn are dropped.
        let count = self.worn.len();
        let none = DMatrix::zeros(count, count);
        for extra in [Some(&none), None] {
            self.contact.set_added_compliance(extra)?;
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
                line.integrator.step(
                    &mut line.contact,
                    &mut line.worn,
                    STEP * n as f64,
                    STEP,
                    &mut |time, c| conditions(at(time), c),
                    &mut line.state,
                )?;
            }
            Fallible::Ok(())
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
        let finite = self.state.pressure.iter().all(|p| p.is_finite());
        if finite { Ok(seconds) } else { Err("the pressure is not finite".into()) }
    }

    /// Work per step of the last turn.
    pub fn work(&self) -> String {
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

/// One dense system and its factors.
pub struct DenseSolution {
    matrix: Mat<f64>,
    factors: Mat<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    right: Mat<f64>,
    memory: MemBuffer,
}

impl DenseSolution {
    /// A diagonally dominant matrix of `count` unknowns.
    pub fn new(count: usize) -> Self {
        let entry = |i: usize, j: usize| if i == j { 4.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) };
        let matrix = Mat::from_fn(count, count, entry);
        let memory = lu::factor::lu_in_place_scratch::<usize, f64>(count, count, Par::Seq, Default::default())
            .or(lu::solve::solve_in_place_scratch::<usize, f64>(count, 1, Par::Seq));
        let mut system = Self {
            factors: matrix.clone(),
            matrix,
            forward: vec![0; count],
            inverse: vec![0; count],
            right: Mat::zeros(count, 1),
            memory: MemBuffer::new(memory),
        };
        system.factorise();
        system
    }

    fn factorise(&mut self) {
        let Self { matrix, factors, forward, inverse, memory, .. } = self;
        factors.copy_from(matrix);
        lu::factor::lu_in_place(
            factors.as_mut(),
            forward,
            inverse,
            Par::Seq,
            MemStack::new(memory),
            Default::default(),
        );
    }

    fn solve(&mut self) {
        let count = self.factors.nrows();
        for i in 0..count {
            self.right[(i, 0)] = i as f64;
        }
        lu::solve::solve_in_place(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.forward, &self.inverse, count),
            self.right.as_mut(),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }

    /// Seconds per solution with cached factors, of so many one after the other.
    pub fn seconds(&mut self, solutions: usize) -> f64 {
        let begin = Instant::now();
        (0..solutions).for_each(|_| self.solve());
        begin.elapsed().as_secs_f64() / solutions as f64
    }

    /// The same with factors made anew for every solution.
    pub fn seconds_anew(&mut self, solutions: usize) -> f64 {
        let begin = Instant::now();
        for _ in 0..solutions {
            self.factorise();
            self.solve();
        }
        begin.elapsed().as_secs_f64() / solutions as f64
    }
}
