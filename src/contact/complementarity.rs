//! Unilateral contact on the cells: pressure, gap, approach and tilt together.

use super::lemke;
use super::problem::{ContactError, ContactState, Normal, Tilt, WorkCounter};
use crate::elastic::{Cells, Compliance};
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Compliance of the pair of bodies per pressure, `C + s mu S`: friction acts with `s mu p` on the strip and with
/// `-s mu p` on the punch. `signed_friction` is `s mu`, 0 without shear coupling.
pub fn pair_compliance(punch: &Compliance, strip: &Compliance, signed_friction: f64) -> DMatrix<f64> {
    let mut matrix = &punch.normal + &strip.normal;
    if signed_friction != 0.0 {
        matrix += (&strip.shear - &punch.shear) * signed_friction;
    }
    matrix
}

/// Active sets tried before complementary pivoting takes over. Contacts met so far need at most 12.
const ITERATION_LIMIT: usize = 40;
/// Pressure and gap of the wrong sign that count as zero, relative to the largest of the solution.
const SIGN_TOLERANCE: f64 = 1e-12;

/// Solver of
///
/// ```text
/// gap = g + A p - delta - theta x >= 0,   p >= 0,   p gap = 0,   sum w p = P,   sum w (x - e) p = 0
/// ```
///
/// on N cells, `A` the compliance (N x N, not symmetric with friction, a wear diagonal included where there is one),
/// `w` the cell widths (times `r/r_m` on an annulus), P the load per depth, e the lever; or approach and tilt given.
///
/// Primal-dual active set (a semismooth Newton method): the equations of the cells assumed in contact are solved
/// exactly, then cells in tension leave and cells that penetrate enter, until nothing changes. It starts from the
/// last active set and keeps the last factorisation, so that an unchanged status costs one back-substitution, `2 N^2`
/// operations. Newton steps between finitely many sets may run in a circle, so after a set returns (or 40 sets)
/// Lemke's algorithm with the lexicographic rule takes over; see [`lemke`] for why that ends. `w_i A_ij` is positive
/// definite for elastic bodies whose shear coupling is antisymmetric (half-plane, strip), so there it also ends in
/// the solution, which is unique. That does not cover a spring or a given approach together with a lever other than
/// 0: there friction can make the equilibrium unstable, and the answer may be [`ContactError::NoEquilibrium`].
#[derive(Clone, Debug)]
pub struct ContactSolver {
    positions: DVector<f64>,
    weights: DVector<f64>,
    length: f64,
    total_weight: f64,
    /// Compliance divided by `scale`.
    matrix: DMatrix<f64>,
    scale: f64,
    active: Vec<bool>,
    factor: Option<Factor>,
    counter: WorkCounter,
}

/// Which unknowns stand beside the pressure; part of the key of a factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Border {
    approach_free: bool,
    tilt_free: bool,
    /// Scaled spring stiffness and lever.
    spring: f64,
    lever: f64,
}

impl Border {
    fn count(&self) -> usize {
        usize::from(self.approach_free) + usize::from(self.tilt_free)
    }
}

#[derive(Clone, Debug)]
struct Factor {
    active: Vec<bool>,
    border: Border,
    lu: LU<f64, Dyn, Dyn>,
}

/// The scaled problem: lengths along x in half-widths, pressure in metres of displacement, load in mean pressure.
struct Scaled {
    border: Border,
    /// Initial gap less what given approach and tilt take from it.
    gap: DVector<f64>,
    load: f64,
    moment: f64,
}

impl ContactSolver {
    /// Solver for a compliance on the cells, all cells in contact at the start.
    pub fn new(cells: &Cells, compliance: DMatrix<f64>) -> Result<Self, ContactError> {
        Self::with_weights(cells, cells.widths(), compliance)
    }

    /// The same with weights of the load integral other than the cell widths, in m (annular contact).
    pub fn with_weights(cells: &Cells, weights: &[f64], compliance: DMatrix<f64>) -> Result<Self, ContactError> {
        let count = cells.count();
        assert_eq!(weights.len(), count, "one weight per cell");
        let mut solver = Self {
            positions: DVector::from_column_slice(cells.centres()) / cells.half_width(),
            weights: DVector::from_column_slice(weights) / weights.iter().sum::<f64>(),
            length: cells.half_width(),
            total_weight: weights.iter().sum(),
            matrix: DMatrix::zeros(0, 0),
            scale: 1.0,
            active: vec![true; count],
            factor: None,
            counter: WorkCounter::default(),
        };
        solver.set_compliance(compliance)?;
        Ok(solver)
    }

    /// Replaces the compliance (N x N, m/Pa); the active set stays, the factorisation goes.
    pub fn set_compliance(&mut self, compliance: DMatrix<f64>) -> Result<(), ContactError> {
        let count = self.active.len();
        assert_eq!(compliance.shape(), (count, count), "compliance is N x N");
        if let Some(&value) = compliance.iter().find(|v| !v.is_finite()) {
            return Err(ContactError::Invalid { quantity: "compliance", value });
        }
        // The softest scale of the pressure: a few cells may be stiffened by orders of magnitude (fast wear).
        let scale = compliance.diagonal().min();
        if scale <= 0.0 {
            return Err(ContactError::Rigid);
        }
        self.matrix = compliance / scale;
        self.scale = scale;
        self.factor = None;
        Ok(())
    }

    /// Work done so far.
    pub fn counter(&self) -> WorkCounter {
        self.counter
    }

    /// Which cells the next solve assumes in contact at first.
    pub fn active(&self) -> &[bool] {
        &self.active
    }

    /// Sets the cells that the next solve assumes in contact at first.
    pub fn set_active(&mut self, active: &[bool]) {
        assert_eq!(active.len(), self.active.len(), "one status per cell");
        self.active.copy_from_slice(active);
    }

    /// Finds the pressure for the gap that the undeformed bodies have at zero approach and tilt (N cell means, in m).
    ///
    /// A load of 0 gives no pressure, and the approach at which the bodies touch.
    pub fn solve(&mut self, initial_gap: &[f64], normal: Normal, tilt: Tilt) -> Result<ContactState, ContactError> {
        assert_eq!(initial_gap.len(), self.active.len(), "one gap per cell");
        self.counter.solves += 1;
        let problem = self.scaled(initial_gap, normal, tilt)?;
        if let Some(apart) = self.apart(initial_gap, normal, tilt) {
            return Ok(apart);
        }
        let mut active = self.active.clone();
        if problem.border.count() > 0 && active.iter().filter(|a| **a).count() < problem.border.count() {
            active.fill(true);
        }
        let mut tried: Vec<Vec<bool>> = Vec::new();
        while let Some((unknowns, pressure, gap)) = self.solve_on(&active, &problem) {
            let next = self.next_active(&active, &pressure, &gap);
            let too_few = next.iter().filter(|a| **a).count() < problem.border.count();
            if next == active {
                self.active = active;
                return Ok(self.state(&unknowns, &pressure, &gap, normal, tilt));
            }
            tried.push(std::mem::replace(&mut active, next));
            if too_few || tried.len() >= ITERATION_LIMIT || tried.contains(&active) {
                break;
            }
        }
        self.counter.fallbacks += 1;
        let active = self.pivoted(&problem)?;
        let (unknowns, pressure, gap) = self.solve_on(&active, &problem).ok_or(ContactError::NoEquilibrium)?;
        self.active = active;
        Ok(self.state(&unknowns, &pressure, &gap, normal, tilt))
    }

    fn scaled(&self, initial_gap: &[f64], normal: Normal, tilt: Tilt) -> Result<Scaled, ContactError> {
        let finite = |quantity, value: f64| {
            if value.is_finite() { Ok(value) } else { Err(ContactError::Invalid { quantity, value }) }
        };
        for &value in initial_gap {
            finite("initial gap", value)?;
        }
        let mut gap = DVector::from_column_slice(initial_gap);
        let mut border = Border { approach_free: true, tilt_free: false, spring: 0.0, lever: 0.0 };
        let (mut load, mut moment) = (0.0, 0.0);
        match normal {
            Normal::Load(value) => {
                if finite("load", value)? < 0.0 {
                    return Err(ContactError::Invalid { quantity: "load", value });
                }
                load = value;
            }
            Normal::Approach(value) => {
                border.approach_free = false;
                gap.add_scalar_mut(-finite("approach", value)?);
            }
            Normal::Spring { load: value, stiffness } => {
                load = finite("load", value)?;
                if finite("holder stiffness", stiffness)? < 0.0 {
                    return Err(ContactError::Invalid { quantity: "holder stiffness", value: stiffness });
                }
                border.spring = stiffness * self.scale / self.total_weight;
            }
        }
        match tilt {
            Tilt::Fixed(value) => gap.axpy(-finite("tilt", value)? * self.length, &self.positions, 1.0),
            Tilt::ResultantAt(value) => {
                let limit = self.positions[self.positions.len() - 1];
                border.tilt_free = true;
                border.lever = finite("lever", value)? / self.length;
                if border.lever.abs() >= limit {
                    return Err(ContactError::Tipping { lever: value, limit: limit * self.length });
                }
            }
            Tilt::Moment { lever, moment: value } => {
                border.tilt_free = true;
                border.lever = finite("lever", lever)? / self.length;
                moment = finite("moment", value)?;
            }
        }
        let to_mean = self.scale / self.total_weight;
        Ok(Scaled { border, gap, load: load * to_mean, moment: moment * to_mean / self.length })
    }

    /// The state without pressure, where load or spring leave none: no load puts the punch where the bodies touch, a
    /// spring where it is relaxed. A free tilt is not defined then and taken as 0.
    fn apart(&self, initial_gap: &[f64], normal: Normal, tilt: Tilt) -> Option<ContactState> {
        let tilt = match tilt {
            Tilt::Fixed(value) => value,
            Tilt::ResultantAt(_) | Tilt::Moment { .. } => 0.0,
        };
        let distance = |(g, x): (&f64, &f64)| g - tilt * x * self.length;
        let distances: Vec<f64> = initial_gap.iter().zip(&self.positions).map(distance).collect();
        let touching = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let approach = match normal {
            Normal::Load(0.0) => touching,
            Normal::Spring { load, stiffness } if load <= stiffness * touching => {
                if stiffness > 0.0 {
                    load / stiffness
                } else {
                    touching
                }
            }
            _ => return None,
        };
        let gap = distances.iter().map(|d| d - approach).collect();
        Some(ContactState { pressure: vec![0.0; initial_gap.len()], gap, approach, tilt })
    }

    /// Unknowns (pressures of the active cells, approach, tilt), pressure and gap for an assumed active set; `None`
    /// where its equations have no solution.
    fn solve_on(&mut self, active: &[bool], problem: &Scaled) -> Option<(DVector<f64>, DVector<f64>, DVector<f64>)> {
        self.counter.iterations += 1;
        let index: Vec<usize> = (0..active.len()).filter(|&i| active[i]).collect();
        let (m, border) = (index.len(), problem.border);
        let size = m + border.count();
        let kept = self.factor.as_ref().is_some_and(|f| f.border == border && f.active == active);
        if !kept {
            self.counter.factorisations += 1;
            let mut system = self.bordered(&index, &index, border);
            for k in m..size {
                system[(k, k)] += if border.approach_free && k == m { border.spring } else { 0.0 };
            }
            if border.approach_free && border.tilt_free {
                // The spring is compressed at x = 0; the unknown is the approach at the lever.
                system[(m, m + 1)] -= border.spring * border.lever;
            }
            self.factor = Some(Factor { active: active.to_vec(), border, lu: system.lu() });
        }
        let mut right = DVector::zeros(size);
        for (k, &i) in index.iter().enumerate() {
            right[k] = -problem.gap[i];
        }
        if border.approach_free {
            right[m] = problem.load;
        }
        if border.tilt_free {
            right[size - 1] = problem.moment;
        }
        let solved = size == 0 || self.factor.as_ref()?.lu.solve_mut(&mut right);
        if !solved || right.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut pressure = DVector::zeros(active.len());
        for (k, &i) in index.iter().enumerate() {
            pressure[i] = right[k];
        }
        // In full contact every gap is zero, and the product is half of the work.
        if m == active.len() {
            let gap = DVector::zeros(m);
            return Some((right, pressure, gap));
        }
        let mut gap = problem.gap.clone();
        gap.gemv(1.0, &self.matrix, &pressure, 1.0);
        for (k, column) in self.border_columns(border).into_iter().enumerate() {
            gap.axpy(right[m + k], &column, 1.0);
        }
        Some((right, pressure, gap))
    }

    /// Columns `-1` and `-(x - e)` of the free unknowns: approach at the lever, tilt. Where the approach at x = 0 is
    /// given the tilt turns the punch about there, `-x`.
    fn border_columns(&self, border: Border) -> Vec<DVector<f64>> {
        let mut columns = Vec::with_capacity(2);
        if border.approach_free {
            columns.push(DVector::repeat(self.positions.len(), -1.0));
        }
        if border.tilt_free {
            let centre = if border.approach_free { border.lever } else { 0.0 };
            columns.push(self.positions.map(|x| centre - x));
        }
        columns
    }

    /// Rows `w` and `w (x - e)` of the resultant and its moment about the lever.
    fn border_rows(&self, border: Border) -> Vec<DVector<f64>> {
        let mut rows = Vec::with_capacity(2);
        if border.approach_free {
            rows.push(self.weights.clone());
        }
        if border.tilt_free {
            rows.push(self.positions.zip_map(&self.weights, |x, w| (x - border.lever) * w));
        }
        rows
    }

    /// `[A B; R 0]` on the given rows and columns of A, without the spring. With the approach free or the lever at 0,
    /// `R = -B' diag(w)`.
    fn bordered(&self, rows: &[usize], columns: &[usize], border: Border) -> DMatrix<f64> {
        let (m, n) = (rows.len(), columns.len());
        let mut system = DMatrix::zeros(m + border.count(), n + border.count());
        for (b, &j) in columns.iter().enumerate() {
            for (a, &i) in rows.iter().enumerate() {
                system[(a, b)] = self.matrix[(i, j)];
            }
        }
        for (k, column) in self.border_columns(border).into_iter().enumerate() {
            for (a, &i) in rows.iter().enumerate() {
                system[(a, n + k)] = column[i];
            }
        }
        for (k, row) in self.border_rows(border).into_iter().enumerate() {
            for (b, &j) in columns.iter().enumerate() {
                system[(m + k, b)] = row[j];
            }
        }
        system
    }

    /// Active set by complementary pivoting. Rows are weighted with w, so that the bordered matrix is positive
    /// semidefinite; the outermost cells take the first pivot.
    fn pivoted(&mut self, problem: &Scaled) -> Result<Vec<bool>, ContactError> {
        let count = self.active.len();
        let border = problem.border;
        let all: Vec<usize> = (0..count).collect();
        let mut full = self.bordered(&all, &all, border);
        let mut q = DVector::zeros(full.nrows());
        for (i, weight) in self.weights.iter().enumerate() {
            full.row_mut(i).scale_mut(*weight);
            q[i] = problem.gap[i] * weight;
        }
        if border.approach_free {
            full[(count, count)] += border.spring;
            q[count] = -problem.load;
            if border.tilt_free {
                full[(count, count + 1)] -= border.spring * border.lever;
            }
        }
        if border.tilt_free {
            q[count + border.count() - 1] = -problem.moment;
        }
        let first = &[0, count - 1][..border.count()];
        let solution = lemke::solve_mixed(&full, &q, first).map_err(|_| ContactError::NoEquilibrium)?;
        self.counter.pivots += solution.pivots as u64;
        Ok(solution.basic)
    }

    /// Cells in tension leave, cells that penetrate enter. Compared as displacements, `A_ii p_i` with the gap.
    fn next_active(&self, active: &[bool], pressure: &DVector<f64>, gap: &DVector<f64>) -> Vec<bool> {
        let local = DVector::from_fn(active.len(), |i, _| self.matrix[(i, i)] * pressure[i]);
        let tolerance = SIGN_TOLERANCE * local.amax().max(gap.amax());
        let stays = |i: usize| if active[i] { local[i] >= -tolerance } else { gap[i] < -tolerance };
        (0..active.len()).map(stays).collect()
    }

    fn state(
        &self,
        unknowns: &DVector<f64>,
        pressure: &DVector<f64>,
        gap: &DVector<f64>,
        normal: Normal,
        tilt: Tilt,
    ) -> ContactState {
        let free = &unknowns.as_slice()[self.active.iter().filter(|a| **a).count()..];
        let (mut approach, mut angle) = match normal {
            Normal::Approach(value) => (value, 0.0),
            Normal::Load(_) | Normal::Spring { .. } => (free[0], 0.0),
        };
        match tilt {
            Tilt::Fixed(value) => angle = value,
            Tilt::ResultantAt(lever) | Tilt::Moment { lever, .. } => {
                angle += free[free.len() - 1] / self.length;
                if free.len() == 2 {
                    approach -= angle * lever;
                }
            }
        }
        ContactState {
            pressure: (0..pressure.len())
                .map(|i| if self.active[i] { pressure[i].max(0.0) / self.scale } else { 0.0 })
                .collect(),
            gap: (0..gap.len()).map(|i| if self.active[i] { 0.0 } else { gap[i].max(0.0) }).collect(),
            approach,
            tilt: angle,
        }
    }
}

#[cfg(test)]
mod tests;
