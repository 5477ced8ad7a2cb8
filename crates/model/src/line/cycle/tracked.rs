//! Many cycles on a straight track that wears, without heat.
//!
//! The shape of the track is not one depth per cell of the contact, so that the implicit jumps of [`super::jump`] have no state of
//! the size of the contact. The stepped model itself makes a jump of J cycles: one cycle with J times the wear. Its steps are
//! implicit in the wear, so that edges which settle within a few cycles do not limit J. A cycle begins and ends in the middle of the
//! forward stroke,
//!
//! ```text
//! half of the forward stroke, backward stroke, half of the forward stroke
//! ```
//!
//! which is symmetric (Strang): the error of a jump is of third order in J, as in the splitting of two flows. Two jumps of J/2 against
//! one of J estimate it; the two are taken.
//!
//! Theory: docs/theory.md, section 9.6.

use super::error::CycleError;
use super::jump::{JUMP_GROWTH, JumpOptions, Progress};
use super::solve::uneven;
use crate::line::Line;
use crate::line::operators::LineOperators;
use crate::lumped::conditions::Tunables;
use crate::{Inputs, StepFailure};
use numerics::maximum::maximum;
use scene::Scene;
use std::sync::Arc;

/// Steps of half of a stroke, where none is longer than the track permits. One instead of two takes half of the time and leaves 0.3 % of
/// the deepest wear in a fretting test, instead of 0.05 %.
const STEPS: u32 = 2;

/// Integrator of a contact on a worn track over many cycles.
#[derive(Debug)]
pub struct TrackedCycles {
    line: Line,
    strokes: [(f64, f64); 2],
    options: JumpOptions,
    cycles: f64,
    computed: usize,
    accumulated: f64,
    /// Proposed length of the next jump.
    length: f64,
}

impl TrackedCycles {
    /// A contact at the nominal load, with half-strokes of these velocities (forward > 0, backward < 0, m/s) and durations (s), at
    /// rest in the middle of its track.
    ///
    /// # Errors
    /// Heat or temperature that feeds back: wear is faster in a jump than heat.
    pub fn new(
        mut operators: LineOperators,
        sliding: [(f64, f64); 2],
        options: JumpOptions,
    ) -> Result<TrackedCycles, CycleError> {
        if operators.heat.is_some() || operators.follows_temperature() {
            return Err(CycleError::Unsuitable(
                "cycles: on a straight track that wears (strip.path = straight, strip.wear_coefficient > 0) a jump multiplies wear and \
                 not heat, and heat or temperature act on this contact; a cold run without a table or expansion that follows the \
                 temperature is accepted"
                    .into(),
            ));
        }
        // The estimate of a jump contains the error of its steps.
        operators.accept_any_step();
        let scene = &operators.scene;
        let tunables = tunables(scene, 1.0);
        let start = inputs(scene, sliding[0].0);
        let line = Line::new(Arc::new(operators), tunables, &start);
        Ok(TrackedCycles { line, strokes: sliding, options, cycles: 0.0, computed: 0, accumulated: 0.0, length: 2.0 })
    }

    /// The contact, in the middle of its forward stroke.
    pub fn line(&self) -> &Line {
        &self.line
    }

    /// Advances to `cycles` (a whole number) since the start, where the last jump ends, and calls `watch` after every jump.
    ///
    /// # Errors
    /// A cycle that has no solution.
    pub fn carry_to(&mut self, cycles: f64, mut watch: impl FnMut(&Progress, &Line)) -> Result<(), CycleError> {
        while self.cycles < cycles {
            let jump = self.jump(cycles - self.cycles)?;
            watch(&jump, &self.line);
        }
        Ok(())
    }

    /// Advances by one jump of at most `most` cycles (at least 1).
    fn jump(&mut self, most: f64) -> Result<Progress, CycleError> {
        loop {
            let length = self.length.min(self.options.longest).min(most).floor();
            if length < 2.0 {
                self.pass(1.0)?;
                self.length = JUMP_GROWTH[1];
                return Ok(self.made(1.0, 0.0));
            }
            let before = self.line.clone();
            let mut whole = None;
            if self.pass(length).is_ok() {
                whole = Some(std::mem::replace(&mut self.line, before.clone()));
            }
            let halves = self.pass(0.5 * length).and_then(|()| self.pass(0.5 * length));
            let estimate = match (whole, halves) {
                // Error of two halves over their difference from the whole.
                (Some(whole), Ok(())) => (1.0 / 3.0) * self.difference(&whole, &before),
                // A jump that is too long may have no solution.
                _ if length >= 4.0 => f64::INFINITY,
                (_, Err(error)) => return Err(error.into()),
                (None, Ok(())) => 0.0,
            };
            let factor = (0.8 * self.options.tolerance / estimate).cbrt();
            self.length = (length * factor.clamp(JUMP_GROWTH[0], JUMP_GROWTH[1])).max(1.0);
            if estimate <= self.options.tolerance {
                return Ok(self.made(length, estimate));
            }
            self.line = before;
        }
    }

    fn made(&mut self, length: f64, estimate: f64) -> Progress {
        self.cycles += length;
        self.accumulated += estimate;
        let TrackedCycles { cycles, accumulated, computed, .. } = *self;
        Progress { cycles, length, estimate, accumulated, computed }
    }

    /// One cycle with `length` times the wear.
    fn pass(&mut self, length: f64) -> Result<(), StepFailure> {
        self.computed += 1;
        let scene = self.line.operators.scene.clone();
        self.line.set_tunables(tunables(&scene, length));
        let [forward, backward] = self.strokes;
        let half = (forward.0, 0.5 * forward.1);
        for ((velocity, duration), steps) in [(half, STEPS), (backward, 2 * STEPS), (half, STEPS)] {
            for _ in 0..steps {
                self.line.step(&inputs(&scene, velocity), None, duration / f64::from(steps))?;
            }
        }
        Ok(())
    }

    /// Difference of the contact from `other`, which both come from `before`: of the gap without its mean over the elastic
    /// displacement under the mean pressure, of the mean wear over that of the jump.
    fn difference(&self, other: &Line, before: &Line) -> f64 {
        let (operators, own) = (&self.line.operators, &self.line.state);
        let cells = &operators.cells;
        let gap: Vec<f64> = (0..cells.count())
            .map(|i| own.punch[i] + own.strip[i] - other.state.punch[i] - other.state.strip[i])
            .collect();
        let scale = operators.displacement_scale * operators.scene.nominal_load
            / (operators.scene.count * operators.scene.contact_area());
        let mut error = uneven(&gap, cells.centres(), cells.widths(), false) / scale;
        for body in 0..2 {
            let worn = own.volume[body] - before.state.volume[body];
            if worn > 0.0 {
                error = maximum(error, ((own.volume[body] - other.state.volume[body]) / worn).abs());
            }
        }
        error
    }
}

/// Parameters of the run with `length` times the wear.
fn tunables(scene: &Scene, length: f64) -> Tunables {
    Tunables { wear_acceleration: scene.wear_acceleration * length, ..Tunables::of(scene) }
}

/// Inputs of sliding at the nominal load.
fn inputs(scene: &Scene, velocity: f64) -> Inputs {
    Inputs { sliding_velocity: velocity, normal_load: scene.nominal_load, ..Inputs::constant(0.0) }
}
