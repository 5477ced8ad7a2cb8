//! Direct feedthrough of the strip, tabulated over the sliding velocity.
//!
//! One interpolation node costs as much as many time steps, a simulation needs only a few nodes, and of the velocities
//! to come only the nominal one is known. Nodes are therefore computed on first use, in memory allocated at
//! construction. The values at a node depend on its number alone, not on the order of the requests.
//!
//! Theory: docs/theory.md, section 4.5.

use super::mirrored::MirroredInfluence;
use super::passive::Passive;
use super::static_correction::{CorrectionWorkspace, Integrals, StaticCorrection};
use nalgebra::DMatrix;
use std::sync::{Mutex, OnceLock};

/// Number of nodes of the interpolation stencil.
const STENCIL: usize = 6;
/// Nodes at negative velocity.
const NEGATIVE_NODES: usize = STENCIL / 2 - 1;

/// Surface influence matrices of the direct feedthrough (temperature, distortion) at the nodes
/// `v = v0 sinh(spacing k)`, k = -2, -1, 0, ... Negative velocities follow by symmetry; beyond the last node the
/// feedthrough is extrapolated as v^(-1/2), the limit of fast sliding (one-dimensional conduction into the depth).
///
/// Between nodes the interpolation error of the temperature under a uniform flux is below a tenth of the tolerance,
/// relative to the whole steady temperature. The interpolant of passive matrices may not be one: it is made passive as they are.
#[derive(Debug)]
pub(crate) struct VelocityTable {
    scale: f64,
    spacing: f64,
    nodes: Vec<OnceLock<Influence>>,
    /// Whether the interpolant is passive between a node and the next, by the first node of the stencil.
    passive: Vec<OnceLock<bool>>,
    static_correction: StaticCorrection,
    integrals: Integrals,
    unused: Mutex<Unused>,
}

/// Preallocated nodes that are not computed yet, and workspace to compute one.
#[derive(Debug)]
struct Unused {
    nodes: Vec<Influence>,
    workspace: CorrectionWorkspace,
    passive: Passive,
    /// Whole matrices, N x N, of temperature and distortion, and an interpolant.
    whole: [DMatrix<f64>; 2],
    between: MirroredInfluence,
}

/// Influence on temperature and distortion; the second is empty without thermal expansion.
type Influence = [MirroredInfluence; 2];

impl VelocityTable {
    /// `scale`: velocity v0 (m/s) below which the feedthrough is independent of the velocity; `fastest`: velocity (m/s)
    /// from which the limit of fast sliding holds; `tolerance`: requested relative error of the contact temperature.
    pub(crate) fn new(static_correction: StaticCorrection, scale: f64, fastest: f64, tolerance: f64) -> VelocityTable {
        // Spacing of the interpolation nodes in asinh(v/v0) at the tolerance 0.01. The interpolation error is of sixth order in the
        // spacing, so the spacing goes with the sixth root of the tolerance.
        let spacing = (0.35 * (tolerance / 0.01).powf(1.0 / 6.0)).clamp(0.15, 0.45);
        let count = NEGATIVE_NODES + ((fastest / scale).asinh() / spacing).ceil().max(1.0) as usize + 1 + STENCIL / 2;
        let integrals = static_correction.integrals();
        let cells = static_correction.cells.count();
        let distorted = if static_correction.expansion.is_some() { cells } else { 0 };
        let zeros = |size: usize| DMatrix::zeros(size, size);
        let unused = Unused {
            // Zero pages of the operating system: most nodes are never computed and touch no memory.
            nodes: (0..count).map(|_| [cells, distorted].map(MirroredInfluence::new)).collect(),
            workspace: CorrectionWorkspace::new(&static_correction, &integrals),
            passive: Passive::new(static_correction.cells.widths()),
            whole: [cells, distorted].map(zeros),
            between: MirroredInfluence::new(cells),
        };
        VelocityTable {
            scale,
            spacing,
            nodes: (0..count).map(|_| OnceLock::new()).collect(),
            passive: (0..count).map(|_| OnceLock::new()).collect(),
            static_correction,
            integrals,
            unused: Mutex::new(unused),
        }
    }

    /// Computes the nodes, and what is between them, for all velocities up to `velocity` (m/s).
    pub(crate) fn expect(&self, velocity: f64) {
        let (base, _) = self.stencil(velocity);
        (0..base + STENCIL).for_each(|node| {
            self.node(node);
        });
        (0..=base).for_each(|interval| {
            self.is_passive(interval);
        });
    }

    /// Both influence matrices at a node, counted from the first one at negative velocity; allocates nothing.
    fn node(&self, node: usize) -> &Influence {
        if let Some(known) = self.nodes[node].get() {
            return known;
        }
        let opposite = (node < NEGATIVE_NODES).then(|| self.node(2 * NEGATIVE_NODES - node));
        // The workspace is overwritten, so the state left by a panic is harmless.
        let mut unused = self.unused.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // Another thread may have computed it in the meantime.
        if self.nodes[node].get().is_none()
            && let Some(mut found) = unused.nodes.pop()
        {
            match opposite {
                Some(opposite) => {
                    for (own, opposite) in found.iter_mut().zip(opposite) {
                        own.combine([opposite], [1.0]);
                        own.reverse(self.static_correction.cells.count());
                    }
                }
                None => self.find(node - NEGATIVE_NODES, &mut unused, &mut found),
            }
            let _ = self.nodes[node].set(found);
        }
        drop(unused);
        self.nodes[node].get().expect("every node has its preallocated matrices")
    }

    /// Computes the influence matrices at node `number`, 0 at rest.
    fn find(&self, number: usize, unused: &mut Unused, found: &mut Influence) {
        let velocity = self.scale * (number as f64 * self.spacing).sinh();
        let widths = self.static_correction.cells.widths();
        let Unused { workspace, passive, whole, .. } = unused;
        self.static_correction.at(velocity, &self.integrals, workspace, whole);
        if number == 0 {
            // At rest the influence per heat is symmetric, but rest is evaluated at a small positive velocity.
            whole.iter_mut().for_each(|influence| make_symmetric(influence, widths));
        }
        passive.make_passive(&mut whole[0]);
        for (found, whole) in found.iter_mut().zip(whole).filter(|(found, _)| !found.is_empty()) {
            found.take(whole.as_slice(), widths);
        }
    }

    /// Velocity v0 below which the feedthrough is independent of the velocity, m/s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// First node and interpolation weights for a speed.
    fn stencil(&self, velocity: f64) -> (usize, [f64; STENCIL]) {
        let last = self.nodes.len() - 1 - STENCIL / 2 - NEGATIVE_NODES;
        let mut position = (velocity.abs() / self.scale).asinh() / self.spacing;
        let mut limit = 1.0;
        if position > last as f64 {
            limit = (self.scale * (last as f64 * self.spacing).sinh() / velocity.abs()).sqrt();
            position = last as f64;
        }
        // Positions within rounding of a node are moved onto it.
        // Distance from a node, relative to the spacing, that is attributed to rounding.
        if (position - position.round()).abs() < 1e-9 {
            position = position.round();
        }
        let base = (position as usize).min(last);
        (base, interpolant(position - base as f64).map(|weight| limit * weight))
    }

    /// Whether the interpolant is passive between the nodes in the middle of a stencil: at the quarters of the distance.
    fn is_passive(&self, base: usize) -> bool {
        *self.passive[base].get_or_init(|| {
            let nodes: [&MirroredInfluence; STENCIL] = std::array::from_fn(|k| &self.node(base + k)[0]);
            let mut unused = self.unused.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            let Unused { passive, between, whole: [whole, _], .. } = &mut *unused;
            [0.25, 0.5, 0.75].into_iter().all(|offset| {
                between.combine(nodes, interpolant(offset));
                between.fill(whole.as_mut_slice(), self.static_correction.cells.widths());
                passive.is_passive(whole)
            })
        })
    }

    /// Whether the interpolant with these weights is to be made passive.
    fn needs_projection(&self, moving: usize, (base, weights): &(usize, [f64; STENCIL])) -> bool {
        moving == 0 && weights.iter().filter(|weight| **weight != 0.0).count() > 1 && !self.is_passive(*base)
    }

    /// Influence of the direct feedthrough at a velocity: on temperature (`moving` 0), or distortion (1) with thermal expansion.
    pub(crate) fn respond(&self, moving: usize, velocity: f64, response: &mut MirroredInfluence) {
        let stencil @ (base, weights) = self.stencil(velocity);
        let cells = &self.static_correction.cells;
        let projected = self.needs_projection(moving, &stencil);
        // On a node the other weights are 0, and the other nodes are not computed.
        let of = |k: usize| if weights[k] == 0.0 { NEGATIVE_NODES } else { k };
        response.combine(std::array::from_fn(|k| &self.node(base + of(k))[moving]), weights);
        if projected {
            let mut unused = self.unused.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            let Unused { passive, whole: [whole, _], .. } = &mut *unused;
            response.fill(whole.as_mut_slice(), cells.widths());
            passive.make_passive(whole);
            response.take(whole.as_slice(), cells.widths());
        }
        if velocity < 0.0 {
            response.reverse(cells.count());
        }
    }

    /// Number of interpolation nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes.len()
    }
}

/// Weights of the nodes at a distance from the node below, relative to the spacing.
fn interpolant(offset: f64) -> [f64; STENCIL] {
    let position = |k: usize| k as f64 - NEGATIVE_NODES as f64;
    std::array::from_fn(|k| {
        let others = (0..STENCIL).filter(|&other| other != k);
        others.map(|other| (offset - position(other)) / (position(k) - position(other))).product()
    })
}

/// Replaces the influence per flux by that whose part per heat is symmetric.
fn make_symmetric(influence: &mut DMatrix<f64>, widths: &[f64]) {
    for j in 0..influence.ncols() {
        for i in 0..j {
            let mean = 0.5 * (influence[(i, j)] / widths[j] + influence[(j, i)] / widths[i]);
            (influence[(i, j)], influence[(j, i)]) = (mean * widths[j], mean * widths[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::strip::tests::steel;
    use crate::line::strip::{Resolution, SlidingPath, StripHeat};
    use crate::line::{Stage, Step, ThermalBody};
    use elasticity::Cells;
    use scene::FarBoundary;

    fn strip(cells: &Cells, path: SlidingPath, resolution: &Resolution) -> StripHeat {
        StripHeat::new(&steel(0.02, FarBoundary::Held, path, 0.0), cells, resolution).unwrap()
    }

    /// Temperatures under a uniform flux 1.
    fn uniform(response: &DMatrix<f64>) -> Vec<f64> {
        (0..response.nrows()).map(|i| response.row(i).sum()).collect()
    }

    /// Influence on the temperature at a velocity, N x N.
    fn at(table: &VelocityTable, cells: &Cells, velocity: f64) -> DMatrix<f64> {
        let mut response = MirroredInfluence::new(cells.count());
        table.respond(0, velocity, &mut response);
        let mut whole = DMatrix::zeros(cells.count(), cells.count());
        response.fill(whole.as_mut_slice(), cells.widths());
        whole
    }

    fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
        values.into_iter().fold(0.0, |most: f64, value| most.max(value.abs()))
    }

    /// Errors midway between two nodes under a uniform flux, relative to the whole steady temperature: of the table
    /// against the sum over the modes at that velocity, and of the passive part against the sum before it is made
    /// passive.
    fn errors(cells: &Cells, path: SlidingPath, resolution: &Resolution) -> [f64; 2] {
        let mut body = strip(cells, path, resolution);
        let operators = body.operators.clone();
        let (table, count) = (&operators.table, cells.count());
        let mut worst = [0.0f64; 2];
        for k in 0..table.nodes.len() - STENCIL - NEGATIVE_NODES {
            let velocity = table.scale * ((k as f64 + 0.5) * table.spacing).sinh();
            let between = at(table, cells, velocity);
            body.prepare(&Step::new(1e9, [velocity; 2]));
            let whole = largest(uniform(&body.influence(Stage::End).temperature));
            let Unused { workspace, passive, .. } = &mut *table.unused.lock().unwrap();
            let mut exact = [(); 2].map(|()| DMatrix::zeros(count, count));
            let mut sums = [DMatrix::zeros(count, count), DMatrix::zeros(0, 0)];
            table.static_correction.at(velocity, &table.integrals, workspace, &mut sums);
            exact.iter_mut().for_each(|exact| exact.copy_from(&sums[0]));
            passive.make_passive(&mut exact[1]);
            for (worst, [left, right]) in worst.iter_mut().zip([[&between, &exact[1]], [&exact[0], &exact[1]]]) {
                let error = largest(uniform(left).iter().zip(uniform(right)).map(|(left, right)| left - right));
                *worst = worst.max(error / whole);
            }
        }
        worst
    }

    #[test]
    fn between_the_nodes_the_table_keeps_to_a_tenth_of_the_tolerance() {
        let cells = Cells::graded(0.02, 9).unwrap();
        for path in
            [SlidingPath::Closed(0.3), SlidingPath::Stroke { stroke: 0.05, length: 0.0 }, SlidingPath::Unidirectional]
        {
            for tolerance in [5e-2, 1e-2, 1e-3, 1e-4] {
                for shortest in [1e-1, 1e-3] {
                    // In unidirectional sliding the contact leaves its heat behind within the thousand steps.
                    let duration = if path == SlidingPath::Unidirectional { 1e3 * shortest } else { 100.0 };
                    let resolution = Resolution { duration, shortest, travel: f64::INFINITY, tolerance };
                    let [between, passive] = errors(&cells, path, &resolution);
                    assert!(between < 0.1 * tolerance, "{path:?} {tolerance:e} {shortest:e} s: {between:e}");
                    assert!(passive < 0.1 * tolerance, "{path:?} {tolerance:e} {shortest:e} s: {passive:e}");
                }
            }
        }
    }

    /// Else two bodies in perfect contact raise each other's flux without bound in short steps.
    #[test]
    fn the_table_is_passive_between_its_nodes() {
        let cells = Cells::graded(0.0475, 9).unwrap();
        let widths = cells.widths();
        let paths = [
            SlidingPath::Closed(0.738),
            SlidingPath::Closed(0.12),
            SlidingPath::Stroke { stroke: 0.05, length: 0.0 },
            SlidingPath::Unidirectional,
        ];
        for path in paths {
            for (height, shortest, tolerance) in [
                (0.0326, 0.093, 5e-2),
                (0.0326, 0.093, 1e-2),
                (0.0326, 0.093, 1e-3),
                (0.005, 0.01, 1e-2),
                (0.2, 1e-3, 1e-2),
                (0.02, 1e-3, 1e-4),
            ] {
                let properties = steel(height, FarBoundary::Insulated, path, 180.0);
                let resolution = Resolution { duration: 1e3 * shortest, shortest, travel: f64::INFINITY, tolerance };
                let Ok(body) = StripHeat::new(&properties, &cells, &resolution) else { continue };
                let table = &body.operators.table;
                for k in 0..5 * (table.nodes.len() - STENCIL - NEGATIVE_NODES) {
                    let velocity = table.scale * ((0.2 * k as f64 + 0.1) * table.spacing).sinh();
                    let response = at(table, &cells, velocity);
                    let per_heat = |i: usize, j: usize| response[(i, j)] * (widths[i] / widths[j]).sqrt();
                    let symmetric = DMatrix::from_fn(9, 9, |i, j| 0.5 * (per_heat(i, j) + per_heat(j, i)));
                    let found = symmetric.symmetric_eigenvalues();
                    let [least, most] = [found.min(), found.max()];
                    assert!(
                        least > -3e-3 * most,
                        "{path:?} {height} {tolerance}: {least:e} of {most:e} at {velocity} m/s"
                    );
                }
            }
        }
    }
}
