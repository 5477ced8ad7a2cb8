//! Derivative of the heat after a cycle with respect to the heat before it: decay, and heat exchange between the surfaces.
//!
//! The surfaces of two conductors have nearly the same temperature, and the smaller the heat of a cycle relative to the heat
//! stored in the bodies, the larger the exchange between the bodies for a small temperature difference. A change `dx` of the heat
//! at the start of a cycle therefore changes the flux into the punch by `dq`, that into the strip by `-dq`, constant over the
//! cycle:
//!
//! ```text
//! change of the heat over the cycle      -(1 - exp(-rate P)) dx_i +- b_i dq
//! mean temperature of the surface        Theta_i dx_i +- g_i dq
//! Theta_1 dx_1 - Theta_2 dx_2 + (g_1 + g_2 + 1/h_c) dq = 0      on cells in contact
//! ```
//!
//! b and g are computed by a cycle of the bodies alone under a unit flux into each cell.
//!
//! Theory: docs/theory.md, section 9.5.

use crate::line::Line;
use conduction::line::{self, FrozenState, SingleStep, Surroundings};
use nalgebra::{DMatrix, DVector, Dyn, LU};
use numerics::factorization;
use numerics::interruption::checkpoint;

/// Response matrices b and g of both bodies.
#[derive(Clone, Debug)]
pub(crate) struct Exchange {
    /// Rows: entries of the heat; columns: heated cells.
    entering: [DMatrix<f64>; 2],
    /// N x N, K m2/W.
    within: [DMatrix<f64>; 2],
    /// 1/h_c, K m2/W.
    resistance: f64,
}

/// Solver for dq, for an equation with given factors of the changes over a cycle.
#[derive(Clone, Debug)]
pub(crate) struct ExchangeSolver {
    factors: LU<f64, Dyn, Dyn>,
    cells: Vec<usize>,
}

impl Exchange {
    /// Response matrices of the bodies of a line; `None` where one does not conduct, or the surfaces do not exchange heat.
    pub(crate) fn new(line: &mut Line, strokes: &[(f64, Vec<f64>); 2], sizes: [usize; 2]) -> Option<Exchange> {
        let count = line.operators.count();
        let conductance = line.operators.scene.conductance;
        let heat = line.heat.as_mut()?;
        if conductance <= 0.0 || heat.bodies.iter().any(Option::is_none) {
            return None;
        }
        let period: f64 = strokes.iter().flat_map(|(_, steps)| steps).sum();
        let around = Surroundings::default();
        let mut entering = sizes.map(|size| DMatrix::zeros(size, count));
        let mut within = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
        for (side, body) in heat.bodies.iter_mut().enumerate() {
            let Some(body) = body else { continue };
            let mut work = body.workspace();
            let mut states = vec![vec![0.0; body.states()]; count];
            let (mut flux, mut warm) = (vec![0.0; count], vec![0.0; count]);
            for (velocity, steps) in strokes {
                for &step in steps {
                    checkpoint();
                    body.prepare(&heat.frozen.step(side, step, [*velocity; 2], line::Exchange::Whole));
                    for (cell, state) in states.iter_mut().enumerate() {
                        flux.fill(0.0);
                        flux[cell] = 1.0;
                        body.step(state, &around, &flux, &flux);
                        body.temperature_at_frozen_state(
                            &FrozenState { state, surroundings: &around, flux: &flux, velocity: *velocity },
                            &mut warm,
                            &mut work,
                        );
                        let mut column = within[side].column_mut(cell);
                        column.iter_mut().zip(&warm).for_each(|(mean, t)| *mean += step / period * t);
                    }
                }
            }
            for (cell, state) in states.iter().enumerate() {
                entering[side].column_mut(cell).copy_from_slice(&state[..sizes[side]]);
            }
        }
        Some(Exchange { entering, within, resistance: 1.0 / conductance })
    }

    /// Solver for an equation in which a change over the cycle by `c_k` moves entry k of the heat by `made[k] c_k`;
    /// `surface(side, entries)` is the surface temperature of a body by its entries.
    pub(crate) fn solver(
        &self,
        made: &[f64],
        touching: &[bool],
        surface: impl Fn(usize, &[f64]) -> Vec<f64>,
    ) -> Option<ExchangeSolver> {
        let count = self.within[0].nrows();
        let cells: Vec<usize> =
            (0..count).filter(|&i| touching.iter().skip(i).step_by(count).any(|touches| *touches)).collect();
        let mut system = &self.within[0] + &self.within[1];
        let mut first = 0;
        for (side, entering) in self.entering.iter().enumerate() {
            let size = entering.nrows();
            for cell in 0..count {
                let column = entering.column(cell);
                let moved: Vec<f64> = column.iter().zip(&made[first..first + size]).map(|(b, w)| b * w).collect();
                let warm = surface(side, &moved);
                system.column_mut(cell).iter_mut().zip(&warm).for_each(|(sum, t)| *sum += t);
            }
            first += size;
        }
        for i in 0..count {
            system[(i, i)] += self.resistance;
        }
        let small = DMatrix::from_fn(cells.len(), cells.len(), |a, b| system[(cells[a], cells[b])]);
        let factors = factorization::lu(small).ok()?;
        factors.is_invertible().then_some(ExchangeSolver { factors, cells })
    }

    /// Adds the exchange between the surfaces to the step of the heat; `difference` is the surface temperature of the punch less
    /// that of the strip by the step without exchange.
    pub(crate) fn complete(&self, solver: &ExchangeSolver, difference: &[f64], made: &[f64], step: &mut [f64]) {
        let mut right = DVector::from_iterator(solver.cells.len(), solver.cells.iter().map(|&i| -difference[i]));
        solver.factors.solve_mut(&mut right);
        let mut first = 0;
        for (entering, sign) in self.entering.iter().zip([1.0, -1.0]) {
            for (a, &cell) in solver.cells.iter().enumerate() {
                for (k, b) in entering.column(cell).iter().enumerate() {
                    step[first + k] += sign * made[first + k] * b * right[a];
                }
            }
            first += entering.nrows();
        }
    }
}
