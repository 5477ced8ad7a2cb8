//! Steady reciprocating sliding with wear proportional to pressure.
//!
//! Theory: docs/theory.md, section 9.2.

use super::{BoxProgramme, SteadyError, not_negative, positive};
use elasticity::{Cells, Compliance};
use nalgebra::{DMatrix, DVector};

/// Reciprocating sliding, with equal half-strokes under constant load, of a punch that wears with b = 1 (or of both bodies, on a
/// closed path).
#[derive(Clone, Copy, Debug)]
pub struct ReciprocatingProblem<'a> {
    /// Cells of the contact.
    pub cells: &'a Cells,
    /// Punch.
    pub punch: &'a Compliance,
    /// Strip.
    pub strip: &'a Compliance,
    /// Friction coefficient mu of the shear coupling and of the holder's moment.
    pub friction: f64,
    /// Load per depth, in N/m.
    pub load: f64,
    /// Pivot height H, in m, where the punch can rotate.
    pub pivot_height: Option<f64>,
    /// Worn depth per pressure in one half-stroke, `k times the half-stroke's sliding distance`, in m/Pa: the states at
    /// the ends of half-strokes as implicit Euler finds them with one step each. 0: a vanishing wear per stroke.
    pub wear_per_stroke: f64,
}

/// Steady cycle of a [`ReciprocatingProblem`].
#[derive(Clone, Debug)]
pub struct Reciprocating {
    /// Pressure while v > 0, N cell means, in Pa; the mean over the half-stroke with finite wear per stroke.
    pub forward: Vec<f64>,
    /// Pressure while v < 0.
    pub backward: Vec<f64>,
    /// Worn depth of the cells at the end of a backward half-stroke, minimum 0, tilt divided equally between the directions, in
    /// m.
    pub shape: Vec<f64>,
    /// Jump of the approach from backward to forward, in m.
    pub approach_jump: f64,
    /// Jump of the tilt from backward to forward, in rad.
    pub tilt_jump: f64,
    /// Strain energy functional of the programme at the solution, per depth, in N.
    pub energy: f64,
}

impl ReciprocatingProblem<'_> {
    /// Solves `p+- = pm +- d` from
    ///
    /// ```text
    /// minimise 1/2 d'C d + mu pm d'(S 1)   with  sum w d = 0,  |d| <= pm,  and  sum w x d = mu H P  if it can rotate
    /// ```
    ///
    /// C with `wear_per_stroke/2` on its diagonal, w the cell widths. The worn depth per cycle is uniform because `p+ + p-` is.
    /// Where |d| = pm the pressure is 0 in one direction and twice the mean in the other.
    pub fn solve(&self) -> Result<Reciprocating, SteadyError> {
        let programme = self.programme()?;
        let count = self.cells.count();
        let mean = self.load / (2.0 * self.cells.half_width());
        let solution = programme.solve()?;
        let d = &solution.values;
        let forward: Vec<f64> = d.iter().map(|d| (mean + d).max(0.0)).collect();
        let backward: Vec<f64> = d.iter().map(|d| (mean - d).max(0.0)).collect();
        // C d + mu pm S 1 = lambda0 + lambda1 x: half the jumps of approach and tilt.
        let lambda = [solution.multipliers[0], solution.multipliers.get(1).copied().unwrap_or(0.0)];
        let (normal, shear) = self.operators();
        let displacement = |p: &[f64], signed: f64| {
            let p = DVector::from_column_slice(p);
            &normal * &p + &shear * &p * (signed * self.friction)
        };
        let (to, fro) = (displacement(&forward, 1.0), displacement(&backward, -1.0));
        let x = self.cells.centres();
        let mut shape: Vec<f64> = (0..count)
            .map(|i| {
                let rigid = lambda[0] + lambda[1] * x[i];
                if backward[i] > 0.0 {
                    -rigid - fro[i]
                } else {
                    // No contact backward: the shape is that required by forward sliding, less the wear in it.
                    rigid - to[i] - self.wear_per_stroke * (forward[i] - mean)
                }
            })
            .collect();
        let least = shape.iter().copied().fold(f64::INFINITY, f64::min);
        shape.iter_mut().for_each(|w| *w -= least);
        let energy = 0.5 * (programme.quadratic * d).dot(d) + programme.linear.dot(d);
        Ok(Reciprocating {
            forward,
            backward,
            shape,
            approach_jump: 2.0 * lambda[0],
            tilt_jump: 2.0 * lambda[1],
            energy,
        })
    }

    /// Quadratic programme in d; an error where there is no steady state.
    pub fn programme(&self) -> Result<BoxProgramme, SteadyError> {
        positive("load", self.load)?;
        not_negative("friction coefficient", self.friction)?;
        not_negative("wear per stroke", self.wear_per_stroke)?;
        let count = self.cells.count();
        let (x, widths, half_width) = (self.cells.centres(), self.cells.widths(), self.cells.half_width());
        let mean = self.load / (2.0 * half_width);
        let mut right = vec![0.0];
        if let Some(height) = self.pivot_height {
            not_negative("pivot height", height)?;
            let lever = self.friction * height;
            if lever >= 0.5 * half_width {
                return Err(SteadyError::RocksItselfRound { lever, limit: 0.5 * half_width, exponent: 1.0 });
            }
            right.push(lever * self.load);
        }
        let (normal, shear) = self.operators();
        let weighted = |matrix: &DMatrix<f64>, i: usize, j: usize| widths[i] * matrix[(i, j)];
        let mut quadratic =
            DMatrix::from_fn(count, count, |i, j| 0.5 * (weighted(&normal, i, j) + weighted(&normal, j, i)));
        for (i, width) in widths.iter().enumerate() {
            quadratic[(i, i)] += 0.5 * self.wear_per_stroke * width;
        }
        let uniform = shear * DVector::repeat(count, self.friction * mean);
        Ok(BoxProgramme {
            quadratic,
            linear: DVector::from_fn(count, |i, _| widths[i] * uniform[i]),
            constraints: DMatrix::from_fn(count, right.len(), |i, k| if k == 0 { widths[i] } else { widths[i] * x[i] }),
            right: DVector::from_vec(right),
            lower: DVector::repeat(count, -mean),
            upper: DVector::repeat(count, mean),
        })
    }

    /// C and S of the pair.
    fn operators(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        (&self.punch.normal + &self.strip.normal, &self.strip.shear - &self.punch.shear)
    }
}
