//! Equations for the state of a cycle: the steady cycle, and the stage of an implicit jump.
//!
//! ```text
//! F(z) = a rigid motion of the shape, no change of the heat          the steady cycle
//! z - h F(z) = base                                                  an implicit stage of h cycles
//! ```
//!
//! One evaluation of F is one cycle of the stepped model. A quasi-Newton step neglects the feedback of the pressure on the heat:
//! the heat decays and is exchanged as in [`super::exchange`], and the wear follows the gap, which the heat distorts, by the
//! matrix J of [`super::tangent`]. The neglected effects - the pressure's feedback on the heat, cells that open or close - are
//! resolved by [acceleration](numerics::acceleration), and for the steady cycle, where that does not converge, by
//! [`super::newton`].
//!
//! Theory: docs/theory.md, section 9.5.

use super::error::CycleError;
use super::exchange::ExchangeSolver;
use super::map::{CycleMap, Passage};
use super::tangent::WearJacobian;
use nalgebra::{DVector, Dyn, LU};
use numerics::acceleration::Anderson;
use numerics::maximum::maximum;

/// Cycles after which the full derivative is used for the steady cycle: where acceleration converges, it requires about ten.
const MOST_ACCELERATED: usize = 30;

/// Differences stored for the Anderson acceleration.
const ACCELERATION_DEPTH: usize = 12;

/// Convergence criterion and limit of an iteration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SolveOptions {
    /// Relative tolerance: change of shape over the elastic displacement under the mean pressure, and of heat over the heat, at
    /// which an iteration has converged.
    pub tolerance: f64,
    /// Largest number of cycles computed.
    pub most_cycles: usize,
}

impl Default for SolveOptions {
    fn default() -> Self {
        SolveOptions { tolerance: 1e-7, most_cycles: 400 }
    }
}

/// Converged solution.
#[derive(Clone, Debug)]
pub struct Solution {
    /// State at the start of the cycle.
    pub memory: Vec<f64>,
    /// The cycle from this state.
    pub passage: Passage,
    /// Cycles computed.
    pub cycles: usize,
    /// Last change of the shape over the elastic displacement under the mean pressure, and of the heat over the heat.
    pub residual: [f64; 2],
}

/// Equation to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) enum Equation<'a> {
    Steady,
    Stage { base: &'a [f64], cycles: f64 },
}

/// Factors of the incomplete derivative.
pub(super) struct Newton {
    pub(super) tangent: WearJacobian,
    factors: LU<f64, Dyn, Dyn>,
    pub(super) touching: Vec<bool>,
    /// Number of force and moment equations, which follow those of the cells.
    balances: usize,
    /// Change of the heat in a step per change of it over a cycle.
    made: Vec<f64>,
    exchange: Option<ExchangeSolver>,
}

impl CycleMap {
    /// The steady cycle: the heat is periodic, and the wear is a rigid motion. `start` is the initial iterate, best with the
    /// shape of the steady cycle without heat.
    ///
    /// The solution is the fixed point to which time stepping with the same steps converges. Above the critical speed of
    /// thermoelastic instability it may be an unstable fixed point, and where cycles are long enough for hot spots to grow in a
    /// half-stroke there is none. Where [the cycle is discontinuous](super::newton) beside it, the residual is the size of the
    /// discontinuity.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn steady(&mut self, start: &[f64], options: &SolveOptions) -> Result<Solution, CycleError> {
        let few = SolveOptions { most_cycles: options.most_cycles.min(MOST_ACCELERATED), ..*options };
        let state = self.line.state.clone();
        if let Ok(solution) = self.solve(start, Equation::Steady, &few) {
            return Ok(solution);
        }
        self.line.state = state;
        let found = self.newton_krylov(start, options);
        let (speed, ratio) = (self.distance() / self.period(), self.speed_ratio());
        // Ratio of speed to critical speed above which instability is reported as a possible reason for the absence of a steady cycle.
        found.map_err(|reason| match ratio > 0.5 {
            true => CycleError::Unstable { speed, critical_speed: speed / ratio, reason: Box::new(reason) },
            false => reason,
        })
    }

    pub(super) fn solve(
        &mut self,
        start: &[f64],
        equation: Equation,
        options: &SolveOptions,
    ) -> Result<Solution, CycleError> {
        let mut memory = start.to_vec();
        let mut newton: Option<Newton> = None;
        let mut anderson = Anderson::<ACCELERATION_DEPTH>::new(start.len());
        let mut weights = Vec::new();
        let mut residual = [f64::INFINITY; 2];
        // Smallest step so far, and the iterate after it.
        let mut best = (f64::INFINITY, memory.clone());
        for cycles in 1..=options.most_cycles {
            let passage = self.pass(&memory)?;
            let changed = |newton: &Newton| {
                newton.touching.iter().zip(&passage.tangent.touching).filter(|(before, now)| before != now).count()
            };
            let current = newton.take();
            if current.as_ref().is_none_or(|newton| changed(newton) > self.operators().count() / 8) {
                // Another active set invalidates the earlier differences.
                anderson.clear();
            }
            let current = current.filter(|newton| changed(newton) == 0);
            let current = match current {
                Some(current) => current,
                None => self.newton(&passage, equation)?,
            };
            let step = self.newton_step(&current, &memory, &passage, equation);
            let tilts = matches!(equation, Equation::Steady) && self.operators().rotates;
            residual = self.sizes(&step, &memory, tilts);
            if residual[0] <= options.tolerance && residual[1] <= options.tolerance {
                if let Equation::Stage { .. } = equation {
                    // Uniform wear of all cells is not part of the residual: this step corrects it.
                    memory.iter_mut().zip(&step).for_each(|(value, step)| *value += step);
                }
                return Ok(Solution { memory, passage, cycles, residual });
            }
            newton = Some(current);
            let size = maximum(residual[0], residual[1]);
            if !size.is_finite() {
                return Err(CycleError::NotConverged { cycles, shape: residual[0], heat: residual[1] });
            }
            if size < best.0 {
                best = (size, memory.iter().zip(&step).map(|(value, step)| value + step).collect());
            // Ratio of the step to the smallest one so far at which the iteration restarts from there.
            } else if size > 100.0 * best.0 {
                // Extrapolation has diverged: restart from the best iterate without it.
                anderson.clear();
                memory.clone_from(&best.1);
                continue;
            }
            if anderson.is_clear() {
                weights = self.weights_of_both(&memory, &memory);
            }
            anderson.begin(&[&memory]);
            memory.iter_mut().zip(&step).for_each(|(value, step)| *value += step);
            anderson.accelerate([&mut memory], |i| weights[i]);
        }
        Err(CycleError::NotConverged { cycles: options.most_cycles, shape: residual[0], heat: residual[1] })
    }

    pub(super) fn newton(&self, passage: &Passage, equation: Equation) -> Result<Newton, CycleError> {
        let cells = &self.operators().cells;
        let tangent = passage.tangent.clone();
        let factors = match equation {
            Equation::Steady => tangent.steady(cells.centres(), cells.widths())?,
            Equation::Stage { cycles, .. } => tangent.implicit(cycles)?,
        };
        let made: Vec<f64> = (0..self.heat_entries())
            .map(|k| {
                let side = usize::from(k >= self.heat_ranges()[0].end);
                let rate = self.decay_rates[k].max(self.least_rate[side]);
                let loss = -(-rate * self.period()).exp_m1();
                match equation {
                    // Least fraction of an entry of heat that counts as lost in a cycle: heat that leaves through the other body alone does
                    // not decay by itself.
                    Equation::Steady => 1.0 / loss.max(1e-7),
                    Equation::Stage { cycles, .. } => cycles / (1.0 + cycles * loss),
                }
            })
            .collect();
        let ranges = self.heat_ranges();
        let surface = |side: usize, entries: &[f64]| {
            let first = ranges[side].start;
            let decayed: Vec<f64> = entries.iter().enumerate().map(|(k, x)| x * self.mean_left(first + k)).collect();
            self.surface(side, &decayed)
        };
        let exchange = self.exchange.as_ref().and_then(|exchange| exchange.solver(&made, &tangent.touching, surface));
        let (touching, balances) = (tangent.touching.clone(), tangent.balances());
        Ok(Newton { touching, balances, tangent, factors, made, exchange })
    }

    /// Mean over a cycle of the decay factor of entry k of the heat.
    fn mean_left(&self, k: usize) -> f64 {
        let turns = self.decay_rates[k] * self.period();
        if turns > 1e-8 { -(-turns).exp_m1() / turns } else { 1.0 }
    }

    pub(super) fn newton_step(
        &self,
        newton: &Newton,
        memory: &[f64],
        passage: &Passage,
        equation: Equation,
    ) -> Vec<f64> {
        let heat = self.heat_entries();
        let count = self.operators().count();
        let worn = self.worn_ranges();
        let mut step = vec![0.0; memory.len()];
        for k in 0..heat {
            step[k] = match equation {
                Equation::Steady => newton.made[k] * passage.change[k],
                Equation::Stage { base, cycles } => {
                    newton.made[k] * (passage.change[k] + (base[k] - memory[k]) / cycles)
                }
            };
        }
        let decayed = |step: &[f64]| -> Vec<f64> { (0..heat).map(|k| step[k] * self.mean_left(k)).collect() };
        if let (Some(exchange), Some(solver)) = (&self.exchange, &newton.exchange) {
            let left = decayed(&step);
            let [punch, strip] = self.heat_ranges();
            let (punch, strip) = (self.surface(0, &left[punch]), self.surface(1, &left[strip]));
            let difference: Vec<f64> = punch.iter().zip(&strip).map(|(punch, strip)| punch - strip).collect();
            exchange.complete(solver, &difference, &newton.made, &mut step[..heat]);
        }
        // Distortion by the mean of the heat over the cycle.
        let mut moved = vec![0.0; count];
        self.displacement(&decayed(&step), &mut moved);
        let moved = DVector::from_vec(moved);
        let reshapes = [0, 1].map(|body| self.operators().reshapes(body));
        match equation {
            Equation::Steady if reshapes == [false; 2] => {}
            Equation::Steady => {
                let mut right = DVector::zeros(count + newton.balances);
                for (body, range) in worn.iter().enumerate() {
                    if self.operators().reshapes(body) {
                        range.clone().enumerate().for_each(|(i, k)| right[i] += passage.change[k]);
                    }
                }
                newton.factors.solve_mut(&mut right);
                // The whole change is assigned to one wearing body.
                let body = usize::from(!reshapes[0]);
                for (i, k) in worn[body].clone().enumerate() {
                    step[k] = right[i] - moved[i];
                }
            }
            Equation::Stage { base, cycles } => {
                let rest = |k: usize| base[k] + cycles * passage.change[k] - memory[k];
                let mut right = DVector::zeros(count);
                for (body, range) in worn.iter().enumerate() {
                    if self.operators().reshapes(body) {
                        range.clone().enumerate().for_each(|(i, k)| right[i] += rest(k));
                        right += newton.tangent.wear_by_gap(body, &moved) * cycles;
                    }
                }
                newton.factors.solve_mut(&mut right);
                let gap = right + &moved;
                for (body, range) in worn.iter().enumerate() {
                    let answer = newton.tangent.wear_by_gap(body, &gap) * cycles;
                    range.clone().enumerate().for_each(|(i, k)| step[k] = rest(k) + answer[i]);
                }
            }
        }
        step
    }

    /// Elastic displacement under the mean pressure, m: scale of shapes.
    fn shape_scale(&self) -> f64 {
        let operators = self.operators();
        let mean = operators.scene.nominal_pressure();
        operators.displacement_scale * mean
    }

    /// Weights for entries of the state: of heat by the larger of that in a state and in a change of it, since the initial heat may be
    /// zero; of depths by the elastic displacement.
    pub(super) fn weights_of_both(&self, memory: &[f64], change: &[f64]) -> Vec<f64> {
        let mut weights = vec![1.0 / self.shape_scale(); memory.len()];
        for range in self.heat_ranges() {
            let size = norm(&memory[range.clone()]).max(norm(&change[range.clone()]));
            weights[range].fill(if size > 0.0 { 1.0 / size } else { 0.0 });
        }
        weights
    }

    /// Size of a change of the state: of the gap without its rigid motion (the tilt where `tilts`) over the elastic displacement,
    /// and of the heat over the heat of `memory`.
    pub fn sizes(&self, change: &[f64], memory: &[f64], tilts: bool) -> [f64; 2] {
        let cells = &self.operators().cells;
        let mut gap = vec![0.0; cells.count()];
        self.displacement(&change[..self.heat_entries()], &mut gap);
        for (body, range) in self.worn_ranges().into_iter().enumerate() {
            if self.operators().reshapes(body) {
                gap.iter_mut().zip(&change[range]).for_each(|(sum, depth)| *sum += depth);
            }
        }
        let shape = uneven(&gap, cells.centres(), cells.widths(), tilts) / self.shape_scale();
        let mut heat: f64 = 0.0;
        for range in self.heat_ranges() {
            let (size, step) = (norm(&memory[range.clone()]), norm(&change[range]));
            if step != 0.0 {
                heat = maximum(heat, step / size.max(step));
            }
        }
        [shape, heat]
    }

    /// Nominal speed over the critical speed of thermoelastic instability at the nominal friction; 0: no instability.
    pub fn speed_ratio(&self) -> f64 {
        let scene = &self.operators().scene;
        let critical = self.operators().mean.growth.critical.modelled(scene.friction_coefficient);
        let speed = self.distance() / self.period();
        if critical > 0.0 { speed / critical } else { 0.0 }
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Root mean square of values on cells after removal of their mean, or of the straight line through them.
pub(super) fn uneven(values: &[f64], x: &[f64], widths: &[f64], rotates: bool) -> f64 {
    let total: f64 = widths.iter().sum();
    let mean = values.iter().zip(widths).map(|(v, c)| v * c).sum::<f64>() / total;
    let moment = |f: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| widths[i] * x[i] * f(i)).sum::<f64>();
    let slope = if rotates { moment(&|i| values[i] - mean) / moment(&|i| x[i]) } else { 0.0 };
    let rest = |i: usize| values[i] - mean - slope * x[i];
    ((0..x.len()).map(|i| widths[i] * rest(i) * rest(i)).sum::<f64>() / total).sqrt()
}
