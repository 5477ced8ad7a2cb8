//! Steady reciprocating sliding for any wear law and unequal half-strokes.
//!
//! Theory: docs/theory.md, section 9.3.

use super::box_programme::ROUNDING;
use super::{SteadyError, not_negative, positive};
use contact::wear::line::CellRate;
use elasticity::{Cells, Compliance};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use numerics::maximum::maximum;

/// Reciprocating sliding of a wearing punch with a vanishing wear per stroke, any pressure exponents.
#[derive(Clone, Copy, Debug)]
pub struct CycleProblem<'a> {
    /// Cells of the contact.
    pub cells: &'a Cells,
    /// Punch.
    pub punch: &'a Compliance,
    /// Strip.
    pub strip: &'a Compliance,
    /// Friction coefficients mu of the forward and the backward half-stroke, in the shear coupling and in the holder's
    /// moment.
    pub friction: [f64; 2],
    /// Load per depth, in N/m.
    pub load: f64,
    /// Pivot height H, in m, where the punch can rotate.
    pub pivot_height: Option<f64>,
    /// Wear depth rate at the speed to which the durations refer, with all cells wearing.
    pub rate: &'a CellRate,
    /// Weights of the forward and the backward half-stroke in the wear of the cycle, in s: the duration at the speed
    /// of `rate`. Equal distances at unequal speeds differ where the velocity exponent is not 1.
    pub durations: [f64; 2],
}

/// Steady cycle of a [`CycleProblem`].
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Pressure while v > 0, N cell means, in Pa.
    pub forward: Vec<f64>,
    /// Pressure while v < 0.
    pub backward: Vec<f64>,
    /// Worn depth (N values, m, minimum 0), tilt divided equally between the directions.
    pub shape: Vec<f64>,
    /// Jump of the approach from backward to forward, in m.
    pub approach_jump: f64,
    /// Jump of the tilt from backward to forward, in rad.
    pub tilt_jump: f64,
    /// Depth by which the punch sinks at x = 0 in a cycle, in m.
    pub sinking: f64,
    /// Rotation by which it tilts in a cycle, in rad.
    pub tilting: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Touching {
    /// In contact backward only.
    BackwardOnly,
    Both,
    /// In contact forward only.
    ForwardOnly,
}

/// Pressures of one cell and their derivatives with respect to the difference `r = p+ - p-` and the depth per cycle.
#[derive(Clone, Copy)]
struct CellState {
    forward: f64,
    backward: f64,
    /// d(p+ + p-)/dr at constant depth.
    sum_by_difference: f64,
    /// d(p+ - p-) and d(p+ + p-) with respect to the depth per cycle, the latter at constant r in contact both ways.
    difference_by_depth: f64,
    sum_by_depth: f64,
}

/// Iterations after which a cycle counts as not found.
const ITERATION_LIMIT: usize = 200;

impl CycleProblem<'_> {
    /// Solves
    ///
    /// ```text
    /// t+ f(p+) + t- f(p-) = lambda0 + lambda1 x            depth per cycle: a rigid motion
    /// C (p+ - p-) + S (mu+ p+ + mu- p-) = jump0 + jump1 x   one shape for both directions, where both are in contact
    /// p+ = 0 or p- = 0 with the inequality elsewhere; load and moment balance of both
    /// ```
    ///
    /// by Newton's method with an active set in the pressure difference r = p+ - p-, of which both pressures are Lipschitz
    /// continuous functions for every exponent; lambda1 and jump1 only where the punch can rotate. For b = 1 and equal durations
    /// this is the quadratic programme of [`super::ReciprocatingProblem`]. Where no steady cycle exists - wear increases the tilt
    /// without bound - the iteration does not converge and returns an error.
    pub fn solve(&self) -> Result<Cycle, SteadyError> {
        self.check()?;
        let (count, x, weights) = (self.cells.count(), self.cells.centres(), self.cells.widths());
        let half_width = self.cells.half_width();
        // S (mu+ p+ + mu- p-) in terms of the difference and the sum of the pressures.
        let [friction, unequal] =
            [0.5 * (self.friction[0] + self.friction[1]), 0.5 * (self.friction[0] - self.friction[1])];
        let shear = &self.strip.shear - &self.punch.shear;
        let normal = &self.punch.normal + &self.strip.normal + &shear * unequal;
        let shear = shear * friction;
        let elastic = normal.diagonal().amax();
        let mean = self.load / (2.0 * half_width);
        let free = if self.pivot_height.is_some() { 2 } else { 1 };
        let shift = |k: usize, i: usize| if k == 0 { 1.0 } else { x[i] / half_width };
        let levers = self.friction.map(|friction| self.pivot_height.map_or(0.0, |h| friction * h) / half_width);

        let mut difference = DVector::zeros(count);
        let mut places = vec![Touching::Both; count];
        let mut depth = [self.durations.iter().sum::<f64>() * self.rate.rate(0, mean), 0.0];
        let mut jump = [0.0, 0.0];
        for _ in 0..ITERATION_LIMIT {
            let depth_at = |i: usize| depth[0] + depth[1] * shift(1, i);
            let states: Vec<CellState> =
                (0..count).map(|i| self.cell(i, places[i], difference[i], depth_at(i))).collect();
            for i in 0..count {
                difference[i] = states[i].forward - states[i].backward;
            }
            let sum = DVector::from_fn(count, |i, _| states[i].forward + states[i].backward);
            let jump_at = |i: usize| jump[0] + jump[1] * shift(1, i);
            let mut residual = (&normal * &difference + &shear * &sum) / elastic;
            for i in 0..count {
                residual[i] -= jump_at(i);
            }
            let both: Vec<usize> = (0..count).filter(|&i| places[i] == Touching::Both).collect();
            let n = both.len();
            let mut system = DMatrix::zeros(n + 2 * free, n + 2 * free);
            let mut right = DVector::zeros(n + 2 * free);
            // Unknowns: differences of the cells in contact both ways, depths, jumps.
            for (b, &j) in both.iter().enumerate() {
                for (a, &i) in both.iter().enumerate() {
                    system[(a, b)] = (normal[(i, j)] + shear[(i, j)] * states[j].sum_by_difference) / elastic;
                }
                for k in 0..free {
                    system[(n + k, b)] = weights[j] * shift(k, j);
                    system[(n + free + k, b)] = weights[j] * shift(k, j) * states[j].sum_by_difference;
                }
            }
            for l in 0..free {
                for (j, state) in states.iter().enumerate() {
                    let by_depth = [state.difference_by_depth * shift(l, j), state.sum_by_depth * shift(l, j)];
                    for (a, &i) in both.iter().enumerate() {
                        system[(a, n + l)] += (normal[(i, j)] * by_depth[0] + shear[(i, j)] * by_depth[1]) / elastic;
                    }
                    for k in 0..free {
                        system[(n + k, n + l)] += weights[j] * shift(k, j) * by_depth[0];
                        system[(n + free + k, n + l)] += weights[j] * shift(k, j) * by_depth[1];
                    }
                }
                for (a, &i) in both.iter().enumerate() {
                    system[(a, n + free + l)] = -shift(l, i);
                }
            }
            for (a, &i) in both.iter().enumerate() {
                right[a] = -residual[i];
            }
            // Equal loads and opposite levers, +mu+ H and -mu- H: the differences carry no load.
            let targets =
                [[0.0, (levers[0] + levers[1]) * self.load], [2.0 * self.load, (levers[0] - levers[1]) * self.load]];
            for k in 0..free {
                let integral = |p: &DVector<f64>| (0..count).map(|i| weights[i] * p[i] * shift(k, i)).sum::<f64>();
                right[n + k] = targets[0][k] - integral(&difference);
                right[n + free + k] = targets[1][k] - integral(&sum);
            }
            let size = (0..2 * free).map(|k| right[n + k].abs()).fold(0.0, maximum) / self.load;
            if factorization::solve_mut(system, &mut right).is_err() {
                return Err(self.not_found());
            }
            // Steps are limited so that the depth per cycle stays positive.
            let change = |i: usize| (0..free).map(|k| right[n + k] * shift(k, i)).sum::<f64>();
            let share =
                (0..count).filter(|&i| change(i) < 0.0).map(|i| -0.8 * depth_at(i) / change(i)).fold(1.0, f64::min);
            let step = both.iter().enumerate().map(|(a, _)| right[a].abs()).fold(0.0, maximum) / mean;
            // Cells with violated inequality re-enter the active set; cells beyond an end of the curve leave it, in `cell`.
            let mut changed = false;
            for i in 0..count {
                let tolerance = ROUNDING * mean;
                let joins = match places[i] {
                    Touching::Both => false,
                    Touching::ForwardOnly => residual[i] > tolerance,
                    Touching::BackwardOnly => residual[i] < -tolerance,
                };
                if joins {
                    places[i] = Touching::Both;
                    changed = true;
                }
            }
            for k in 0..free {
                depth[k] += share * right[n + k];
                jump[k] += share * right[n + free + k];
            }
            for (a, &i) in both.iter().enumerate() {
                difference[i] += share * right[a];
                let depth = depth[0] + depth[1] * shift(1, i);
                let [low, high] = self.ends(i, depth);
                if difference[i] >= high || difference[i] <= low {
                    places[i] = if difference[i] >= high { Touching::ForwardOnly } else { Touching::BackwardOnly };
                    changed = true;
                }
            }
            if !changed && share == 1.0 && step < ROUNDING && size < ROUNDING {
                return Ok(self.cycle(&states, depth, jump, elastic, &normal, &shear));
            }
        }
        Err(self.not_found())
    }

    fn check(&self) -> Result<(), SteadyError> {
        positive("load", self.load)?;
        not_negative("friction coefficient", self.friction[0])?;
        not_negative("friction coefficient", self.friction[1])?;
        positive("duration of the forward half-stroke", self.durations[0])?;
        positive("duration of the backward half-stroke", self.durations[1])?;
        if let Some(height) = self.pivot_height {
            not_negative("pivot height", height)?;
        }
        let wears = |i: usize| self.rate.rate(i, self.load) > 0.0;
        if (0..self.cells.count()).all(wears) { Ok(()) } else { Err(SteadyError::NothingWears) }
    }

    fn not_found(&self) -> SteadyError {
        let lever = self.pivot_height.map_or(0.0, |h| self.friction[0].max(self.friction[1]) * h);
        SteadyError::NoCycle { lever, half_width: self.cells.half_width(), iterations: ITERATION_LIMIT }
    }

    /// Smallest and largest difference of the pressures that wear `depth` in a cycle.
    fn ends(&self, cell: usize, depth: f64) -> [f64; 2] {
        [
            -self.rate.pressure_at(cell, depth / self.durations[1]),
            self.rate.pressure_at(cell, depth / self.durations[0]),
        ]
    }

    /// Pressures of a cell on the curve `t+ f(p+) + t- f(p-) = depth`, at the difference or at an end.
    fn cell(&self, cell: usize, place: Touching, difference: f64, depth: f64) -> CellState {
        let [t_forward, t_backward] = self.durations;
        let [low, high] = self.ends(cell, depth);
        match place {
            Touching::ForwardOnly | Touching::BackwardOnly => {
                let (side, time, pressure) =
                    if place == Touching::ForwardOnly { (1.0, t_forward, high) } else { (-1.0, t_backward, -low) };
                let slope = 1.0 / (time * self.rate.slope(cell, pressure));
                let [forward, backward] = if side > 0.0 { [pressure, 0.0] } else { [0.0, pressure] };
                let difference_by_depth = side * slope;
                CellState { forward, backward, sum_by_difference: side, difference_by_depth, sum_by_depth: slope }
            }
            Touching::Both => {
                let r = difference.clamp(low, high);
                let base = self.smaller(cell, r, depth);
                let (forward, backward) = (base + r.max(0.0), base + (-r).max(0.0));
                let slopes = [t_forward * self.rate.slope(cell, forward), t_backward * self.rate.slope(cell, backward)];
                // Derivatives with respect to r: p+ in proportion to t- f'(p-), p- to t+ f'(p+); a pressure with infinite slope
                // does not change.
                let sum_by_difference = match (slopes[0].is_finite(), slopes[1].is_finite()) {
                    (true, true) => (slopes[1] - slopes[0]) / (slopes[1] + slopes[0]),
                    (false, _) => -1.0,
                    (true, false) => 1.0,
                };
                let sum_by_depth = 2.0 / (slopes[0] + slopes[1]);
                CellState { forward, backward, sum_by_difference, difference_by_depth: 0.0, sum_by_depth }
            }
        }
    }

    /// Smaller of the two pressures that differ by r and wear `depth` in a cycle: bisection with Newton steps.
    fn smaller(&self, cell: usize, r: f64, depth: f64) -> f64 {
        let [t_forward, t_backward] = self.durations;
        let (up, down) = (r.max(0.0), (-r).max(0.0));
        let excess =
            |q: f64| t_forward * self.rate.rate(cell, q + up) + t_backward * self.rate.rate(cell, q + down) - depth;
        let slope = |q: f64| t_forward * self.rate.slope(cell, q + up) + t_backward * self.rate.slope(cell, q + down);
        let (mut low, mut high) = (0.0, self.rate.pressure_at(cell, depth / (t_forward + t_backward)));
        if excess(0.0) >= 0.0 {
            return 0.0;
        }
        let mut q = 0.5 * high;
        for _ in 0..120 {
            let value = excess(q);
            if value > 0.0 {
                high = q;
            } else {
                low = q;
            }
            let newton = q - value / slope(q);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - q).abs() <= 2.0 * f64::EPSILON * (q + up + down) {
                return next;
            }
            q = next;
        }
        q
    }

    fn cycle(
        &self,
        states: &[CellState],
        depth: [f64; 2],
        jump: [f64; 2],
        elastic: f64,
        normal: &DMatrix<f64>,
        shear: &DMatrix<f64>,
    ) -> Cycle {
        let (x, half_width) = (self.cells.centres(), self.cells.half_width());
        let forward = DVector::from_iterator(states.len(), states.iter().map(|s| s.forward));
        let backward = DVector::from_iterator(states.len(), states.iter().map(|s| s.backward));
        let to = normal * &forward + shear * &forward;
        let fro = normal * &backward - shear * &backward;
        let half_jump = |i: usize| 0.5 * elastic * (jump[0] + jump[1] * x[i] / half_width);
        let shape = |i: usize| if backward[i] > 0.0 { -half_jump(i) - fro[i] } else { half_jump(i) - to[i] };
        let mut shape: Vec<f64> = (0..states.len()).map(shape).collect();
        let least = shape.iter().copied().fold(f64::INFINITY, f64::min);
        shape.iter_mut().for_each(|w| *w -= least);
        Cycle {
            forward: forward.as_slice().to_vec(),
            backward: backward.as_slice().to_vec(),
            shape,
            approach_jump: jump[0] * elastic,
            tilt_jump: jump[1] * elastic / half_width,
            sinking: depth[0],
            tilting: depth[1] / half_width,
        }
    }
}
