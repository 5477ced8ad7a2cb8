//! Errors from the assumption of a rigid sliding velocity in wear and friction heat.
//!
//! Theory: docs/theory.md, section 3.8.

use super::states::{SteadyState, SteadyStroke};
use contact::pair_compliance;
use elasticity::discretization::{BodyError, load_weights};
use elasticity::tangential::{TangentialCompliance, tangential_compliances};
use elasticity::{Cells, Compliance};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use numerics::maximum::{largest, maximum};
use scene::{Constraint, Geometry, Scene};

/// Contributions to the velocity of punch over strip beside the rigid sliding velocity v, relative to |v|, over the steady cycle.
/// Friction power, wear and heat are computed with v alone; each contribution is the relative error by neglecting it (for the
/// wear velocity, which is normal to v, its square).
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeVelocity {
    /// Largest wear velocity of both bodies, normal to the surface: `max (dw1/dt + dw2/dt)/|v|`.
    pub wear: f64,
    /// Elastic contributions; `None` on an annulus, where sliding is normal to the modelled plane.
    pub elastic: Option<ElasticVelocity>,
}

/// Elastic contributions to the relative velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticVelocity {
    /// Strain along x of the strip's surface, N values per stroke. The strip is stretched by it as it passes below the punch, so
    /// that the sliding velocity is `v (1 + strain)`.
    pub strain: Vec<Vec<f64>>,
    /// Mean of its absolute value over contact and cycle.
    pub mean_strain: f64,
    /// Largest absolute value at |x| < 0.9 a: at the edges of a uniform traction it has a logarithmic singularity.
    pub largest_strain: f64,
    /// Mean elastic displacement along x of one surface relative to the other that is reversed at a reversal, over the mean
    /// length of a half-stroke: the fraction of the stroke in which the surfaces deform instead of sliding. 0 in unidirectional
    /// sliding.
    pub reversal: f64,
    /// Ratio as above for the punch's rotation about its pivot: `H |tilt jump|` over the length of a half-stroke.
    pub pivot: f64,
    /// Largest velocity along x by the change of the pressure within a stroke, over |v|: wear redistributes the pressure.
    pub within_stroke: f64,
    /// Largest normal velocity by this change, an elastic contribution to the wear velocity, over |v|.
    pub normal_within_stroke: f64,
}

/// Neglected contributions in a steady state on these cells.
///
/// With `U = (T2 - T1) p + s mu (V1 + V2) p` the elastic displacement of the strip's surface against the punch's (T per
/// pressure, V per shear traction, see [`TangentialCompliance`]): the strip's own part gives the strain; the difference of
/// U between forward and backward the reversal; within a stroke the pressure changes by
/// `(C + s mu S) dp/dt = d(delta + theta x)/dt - dw/dt` on the cells in contact at constant load and moment.
pub fn assess(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    state: &SteadyState,
) -> Result<RelativeVelocity, BodyError> {
    let wear = |stroke: &SteadyStroke| {
        let [punch, strip] = &stroke.wear_rates;
        largest(punch.iter().zip(strip).map(|(a, b)| a + b)) / stroke.velocity.abs()
    };
    let wear = largest(state.strokes.iter().map(wear));
    if scene.geometry == Geometry::Annular {
        return Ok(RelativeVelocity { wear, elastic: None });
    }
    let bodies = tangential_compliances(scene, cells)?;
    Ok(RelativeVelocity { wear, elastic: Some(elastic(scene, cells, compliances, &bodies, state)) })
}

fn elastic(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    bodies: &[TangentialCompliance; 2],
    state: &SteadyState,
) -> ElasticVelocity {
    let [punch, strip] = bodies;
    let half_width = cells.half_width();
    let width = 2.0 * half_width;
    let mut relative = Vec::new();
    let mut strain = Vec::new();
    let (mut within_stroke, mut normal_within_stroke) = (0.0f64, 0.0f64);
    for stroke in &state.strokes {
        // Displacement of the strip's surface, and relative to the punch's.
        let own = &strip.by_pressure + &strip.by_shear * stroke.friction;
        let both = &own - &punch.by_pressure + &punch.by_shear * stroke.friction;
        let pressure = DVector::from_column_slice(&stroke.pressure);
        strain.push(derivative(cells, (&own * &pressure).as_slice()));
        let matrix = pair_compliance(&compliances[0], &compliances[1], stroke.friction);
        let change = pressure_change(scene, cells, &matrix, stroke);
        let speed = stroke.velocity.abs();
        within_stroke = maximum(within_stroke, (&both * &change).amax() / speed);
        normal_within_stroke = normal_within_stroke.max((&matrix * &change).amax() / speed);
        relative.push(both * pressure);
    }
    let mean = |values: &dyn Fn(usize) -> f64| -> f64 {
        (0..cells.count()).map(|i| cells.widths()[i] * values(i).abs()).sum::<f64>() / width
    };
    let total: f64 = state.strokes.iter().map(|stroke| stroke.duration).sum();
    let shares = state.strokes.iter().map(|stroke| stroke.duration / total);
    let mean_strain = strain.iter().zip(shares).map(|(strain, share)| share * mean(&|i| strain[i])).sum();
    let inside = |i: &usize| cells.centres()[*i].abs() < 0.9 * half_width;
    let largest = |strain: &Vec<f64>| (0..cells.count()).filter(inside).map(|i| strain[i].abs()).fold(0.0, f64::max);
    let largest_strain = strain.iter().map(largest).fold(0.0, f64::max);
    let (mut reversal, mut pivot) = (0.0, 0.0);
    if let ([forward, backward], [to, fro]) = (&relative[..], &state.strokes[..]) {
        let length = 0.5 * (to.duration * to.velocity.abs() + fro.duration * fro.velocity.abs());
        reversal = mean(&|i| forward[i] - backward[i]) / length;
        pivot = scene.pivot_height * (to.tilt - fro.tilt).abs() / length;
    }
    ElasticVelocity { strain, mean_strain, largest_strain, reversal, pivot, within_stroke, normal_within_stroke }
}

/// dp/dt within a stroke, N values, in Pa/s; 0 out of contact.
fn pressure_change(scene: &Scene, cells: &Cells, matrix: &DMatrix<f64>, stroke: &SteadyStroke) -> DVector<f64> {
    let weights = load_weights(scene, cells);
    let active: Vec<usize> = (0..cells.count()).filter(|&i| stroke.pressure[i] > 0.0).collect();
    let (n, free) = (active.len(), 1 + usize::from(scene.constraint == Constraint::TranslateAndRotate));
    let lever = stroke.friction * scene.pivot_height;
    let scale = matrix.diagonal().amax();
    let mut change = DVector::zeros(cells.count());
    if n <= free {
        return change;
    }
    let mut system = DMatrix::zeros(n + free, n + free);
    let mut right = DVector::zeros(n + free);
    // The punch's wear reshapes its contact; that of a strip is uniform (closed path) or steady (fresh material).
    let rates = &stroke.wear_rates[0];
    for (a, &i) in active.iter().enumerate() {
        for (b, &j) in active.iter().enumerate() {
            system[(a, b)] = matrix[(i, j)] / scale;
        }
        right[a] = -rates[i] / scale;
        let x = cells.centres()[i] / cells.half_width();
        for (k, (column, row)) in [(1.0, 1.0), (x, x - lever / cells.half_width())][..free].iter().enumerate() {
            system[(a, n + k)] = -column;
            system[(n + k, a)] = row * weights[i] / cells.half_width();
        }
    }
    if factorization::solve_mut(system, &mut right).is_ok() {
        active.iter().enumerate().for_each(|(a, &i)| change[i] = right[a]);
    }
    change
}

/// Slope at the cells' centres of a quantity given by cell means: differences to both neighbours, weighted for second
/// order on unequal cells; one-sided at the edges.
fn derivative(cells: &Cells, values: &[f64]) -> Vec<f64> {
    let x = cells.centres();
    let last = values.len() - 1;
    if last == 0 {
        return vec![0.0];
    }
    let slope = |i: usize| (values[i + 1] - values[i]) / (x[i + 1] - x[i]);
    (0..=last)
        .map(|i| match i {
            0 => slope(0),
            _ if i == last => slope(last - 1),
            _ => {
                let (before, after) = (x[i] - x[i - 1], x[i + 1] - x[i]);
                (slope(i - 1) * after + slope(i) * before) / (before + after)
            }
        })
        .collect()
}
