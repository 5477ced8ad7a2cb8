//! Cycle jumps with error estimate.
//!
//! The state changes by `F(z)` in a cycle. At n + 1/2, between the starts of the cycles n and n + 1, the state is about
//! `z + F(z)/2` and its slope over the number of cycles F(z): attributed to that point, the slope has an error of third order in
//! the rate per cycle. The slope is stiff - an edge settles within a few cycles, a heavy body warms up in a million - so that
//! explicit extrapolation is stable only over jumps hardly longer than the shortest of these times. The jumps here are implicit,
//! L-stable and of second order (SDIRK2, `gamma = 1 - 1/sqrt 2`): with J cycles and `h = gamma J - 1/2`
//!
//! ```text
//! y_1 - h F(y_1) = z,                              k_1 = F(y_1)
//! y_2 - h F(y_2) = z + (1 - gamma) J k_1,          k_2 = F(y_2)
//! z(n + J) = y_2 + k_2/2,                          estimate (1/2 - gamma) J (k_1 - k_2)
//! ```
//!
//! y are states at the start of a cycle; F is one cycle of the stepped model, and a stage requires a few. The estimate is the
//! distance from the embedded first-order solution, which for smooth and for settled components is larger than the error of the
//! second-order one. The contact settles: errors of earlier jumps decay, and the sum of the estimates bounds the error. Where a
//! jump would cover only a few cycles, they are computed one by one.
//!
//! Theory: docs/theory.md, section 9.6.

use super::error::CycleError;
use super::map::{CycleMap, Passage};
use super::newton::sum;
use super::records::Totals;
use super::solve::{Equation, SolveOptions};
use conduction::line::GAMMA;
use numerics::maximum::maximum;

/// Length below which jumps are computed cycle by cycle.
const SHORTEST: f64 = 6.0;

/// Smallest and largest ratio of successive jump lengths.
pub(super) const JUMP_GROWTH: [f64; 2] = [0.2, 4.0];

/// Largest number of cycles for one stage.
const MOST_CYCLES: usize = 40;

/// Options of cycle jumps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct JumpOptions {
    /// Largest estimate of a jump: error of the shape over the elastic displacement under the mean pressure, of the heat over
    /// the heat, of the mean wear over that of the jump.
    pub tolerance: f64,
    /// Longest jump, cycles.
    pub longest: f64,
}

impl Default for JumpOptions {
    fn default() -> Self {
        JumpOptions { tolerance: 1e-3, longest: f64::INFINITY }
    }
}

/// How far jumps have led.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Cycles since the start.
    pub cycles: f64,
    /// Length of this jump in cycles; 1: computed directly.
    pub length: f64,
    /// Its error estimate, as in [`JumpOptions::tolerance`]; 0 for a computed cycle.
    pub estimate: f64,
    /// Sum of all estimates.
    pub accumulated: f64,
    /// Cycles computed since the start.
    pub computed: usize,
}

/// Result of a jump.
#[derive(Clone, Debug)]
pub struct Jump {
    /// How far it leads.
    pub progress: Progress,
    /// State at its end.
    pub memory: Vec<f64>,
    /// Totals since the start.
    pub totals: Totals,
    /// The last cycle computed for it: it ends half a cycle after the end of the jump, or at its end where the cycle was computed
    /// directly.
    pub passage: Passage,
}

/// Integrator of a contact over many cycles.
#[derive(Debug)]
pub struct Jumps<'a> {
    map: &'a mut CycleMap,
    options: JumpOptions,
    memory: Vec<f64>,
    totals: Totals,
    cycles: f64,
    computed: usize,
    accumulated: f64,
    /// Proposed length of the next jump.
    length: f64,
    /// Change of the state in the last computed cycle.
    slope: Option<Vec<f64>>,
}

impl<'a> Jumps<'a> {
    /// Starts from the state `memory`, see [`CycleMap::start`].
    pub fn new(map: &'a mut CycleMap, memory: Vec<f64>, options: JumpOptions) -> Jumps<'a> {
        Jumps {
            map,
            options,
            memory,
            totals: Totals::default(),
            cycles: 0.0,
            computed: 0,
            accumulated: 0.0,
            length: 1.0,
            slope: None,
        }
    }

    /// Advances to `cycles` (a whole number) since the start, where the last jump ends, and calls `watch` after every jump.
    ///
    /// # Errors
    /// A cycle that has no solution.
    pub fn carry_to(&mut self, cycles: f64, mut watch: impl FnMut(&Jump)) -> Result<(), CycleError> {
        while self.cycles < cycles {
            let jump = self.jump(cycles - self.cycles)?;
            watch(&jump);
        }
        Ok(())
    }

    /// Advances by one jump of at most `most` cycles (at least 1).
    ///
    /// # Errors
    /// A cycle that has no solution.
    pub(crate) fn jump(&mut self, most: f64) -> Result<Jump, CycleError> {
        loop {
            let length = self.length.min(self.options.longest).min(most).floor();
            if length < SHORTEST {
                return self.cycle();
            }
            match self.implicit(length)? {
                Some(jump) => return Ok(jump),
                None => self.length = self.length.min(length),
            }
        }
    }

    /// Computes one cycle directly.
    fn cycle(&mut self) -> Result<Jump, CycleError> {
        let passage = self.map.pass(&self.memory)?;
        self.computed += 1;
        if let Some(earlier) = self.slope.replace(passage.change.clone()) {
            // The second difference gives the estimate of a jump.
            let bend: Vec<f64> = passage.change.iter().zip(&earlier).map(|(new, old)| new - old).collect();
            let next: Vec<f64> = self.memory.iter().zip(&passage.change).map(|(z, change)| z + change).collect();
            let per_square = (0.5 - GAMMA) * (1.0 - GAMMA) * self.error_of(&bend, &next, &passage.change, 1.0);
            let proposed = (0.5 * self.options.tolerance / per_square).sqrt();
            self.length = proposed.clamp(1.0, JUMP_GROWTH[1] * SHORTEST);
        }
        self.memory.iter_mut().zip(&passage.change).for_each(|(z, change)| *z += change);
        self.totals = self.totals.plus(1.0, &passage.totals);
        self.cycles += 1.0;
        Ok(self.made(1.0, 0.0, passage))
    }

    fn made(&self, length: f64, estimate: f64, passage: Passage) -> Jump {
        let Jumps { cycles, accumulated, computed, .. } = *self;
        let progress = Progress { cycles, length, estimate, accumulated, computed };
        Jump { progress, memory: self.memory.clone(), totals: self.totals, passage }
    }

    /// Implicit jump; `None`: its error is too large.
    fn implicit(&mut self, length: f64) -> Result<Option<Jump>, CycleError> {
        let cycles = GAMMA * length - 0.5;
        let slope = self.slope.clone().unwrap_or_else(|| vec![0.0; self.memory.len()]);
        let begin = self.memory.clone();
        let per_cycle = |to: &[f64], from: &[f64]| -> Vec<f64> {
            to.iter().zip(from).map(|(y, base)| (y - base) / cycles).collect()
        };
        let Some(first) = self.stage(&begin, &begin, cycles)? else { return Ok(None) };
        let first_slope = per_cycle(&first.memory, &begin);
        let base = sum(&begin, (1.0 - GAMMA) * length, &first_slope);
        let Some(end) = self.stage(&first.memory, &base, cycles)? else { return Ok(None) };
        let end_slope = per_cycle(&end.memory, &base);
        let memory = sum(&end.memory, 0.5, &end_slope);
        let error: Vec<f64> =
            first_slope.iter().zip(&end_slope).map(|(k1, k2)| (0.5 - GAMMA) * length * (k1 - k2)).collect();
        let estimate = self.error_of(&error, &memory, &end_slope, length);
        let factor = (0.8 * self.options.tolerance / estimate).sqrt();
        self.length = length * factor.clamp(JUMP_GROWTH[0], JUMP_GROWTH[1]);
        if estimate.is_nan() || estimate > self.options.tolerance {
            // The slope at the start remains valid after a rejected jump.
            self.slope = Some(slope);
            return Ok(None);
        }
        self.memory = memory;
        self.slope = Some(end_slope);
        self.cycles += length;
        self.accumulated += estimate;
        let weights = [(1.0 - GAMMA) * length, GAMMA * length];
        self.totals = self.totals.plus(weights[0], &first.passage.totals).plus(weights[1], &end.passage.totals);
        Ok(Some(self.made(length, estimate, end.passage)))
    }

    fn stage(&mut self, start: &[f64], base: &[f64], cycles: f64) -> Result<Option<super::Solution>, CycleError> {
        // Tolerance of the stages, as a fraction of that of the jump.
        let options = SolveOptions { tolerance: 0.02 * self.options.tolerance, most_cycles: MOST_CYCLES };
        match self.map.solve(start, Equation::Stage { base, cycles }, &options) {
            Ok(solution) => {
                self.computed += solution.cycles;
                Ok(Some(solution))
            }
            Err(CycleError::NotConverged { cycles: computed, .. }) => {
                self.computed += computed;
                self.length = 0.25 * cycles / GAMMA;
                Ok(None)
            }
            // Far from a solution a cycle may have none.
            Err(CycleError::Step(_)) if cycles > SHORTEST => {
                self.length = 0.25 * cycles / GAMMA;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Size of an error of the state: of the gap without its mean over the elastic displacement, of the heat over the heat, of
    /// the mean wear over that of `length` cycles.
    fn error_of(&self, error: &[f64], memory: &[f64], slope: &[f64], length: f64) -> f64 {
        let [shape, heat] = self.map.sizes(error, memory, false);
        let widths = self.map.operators().cells.widths();
        let mut wear: f64 = 0.0;
        for range in self.map.worn_ranges() {
            let mean = |values: &[f64]| values[range.clone()].iter().zip(widths).map(|(v, c)| v * c).sum::<f64>();
            let worn = length * mean(slope);
            if worn > 0.0 {
                wear = maximum(wear, (mean(error) / worn).abs());
            }
        }
        maximum(maximum(shape, heat), wear)
    }
}
