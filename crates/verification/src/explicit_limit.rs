//! Stability bound of explicit wear steps.
//!
//! Theory: docs/theory.md, section 5.6.

use contact::wear::line::{Conditions, WearingContact};
use contact::{Normal, Tilt};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;

/// Longest explicit Euler step, in the unit of time of the rate, that does not amplify a disturbance of the shape.
///
/// A disturbance of the worn depth changes the pressure by `-R dw`, R the inverse of the compliance on the cells in contact
/// restricted to pressures that load and moment balance allow, and is amplified by the eigenvalues `1 - h mu` of
/// `I - h f' R`: stable while `h < 2 Re mu/|mu|^2` for all of them. For b = 1 and without friction this is
/// `k ds < 2 lambda_min` of the compliance on the zero-mean space. Infinite without wear or contact; 0 where the response is
/// not finite, so that every step is refused. Cost: the eigenvalues of an N x N matrix.
pub(crate) fn explicit_limit(contact: &mut WearingContact, conditions: &Conditions, pressure: &[f64]) -> f64 {
    let active: Vec<usize> = (0..pressure.len()).filter(|&i| pressure[i] > 0.0).collect();
    let compliance = contact.compliance(conditions.signed_friction);
    let block = compliance.select_rows(&active).select_columns(&active);
    let m = active.len();
    let free = match conditions.normal {
        Normal::Approach(_) => 0,
        _ => 1,
    } + usize::from(!matches!(conditions.tilt, Tilt::Fixed(_)));
    if m <= free {
        return f64::INFINITY;
    }
    let scale = block.diagonal().amax();
    let mut bordered = DMatrix::zeros(m + free, m + free);
    bordered.view_mut((0, 0), (m, m)).copy_from(&(&block / scale));
    let length = contact.cells().half_width();
    let total: f64 = contact.weights().iter().sum();
    for (k, &i) in active.iter().enumerate() {
        let mut columns = Vec::with_capacity(2);
        if !matches!(conditions.normal, Normal::Approach(_)) {
            let stiffness = match conditions.normal {
                Normal::Spring { stiffness, .. } => stiffness * scale / total,
                _ => 0.0,
            };
            bordered[(m, m)] = stiffness;
            columns.push((1.0, 1.0));
        }
        let x = contact.cells().centres()[i] / length;
        match conditions.tilt {
            Tilt::Fixed(_) => {}
            Tilt::ResultantAt(lever) | Tilt::Moment { lever, .. } => columns.push((x, x - lever / length)),
        }
        for (c, (column, row)) in columns.into_iter().enumerate() {
            bordered[(k, m + c)] = -column;
            bordered[(m + c, k)] = row * contact.weights()[i] / total;
        }
    }
    let Ok(inverse) = factorization::inverse(bordered) else { return 0.0 };
    let response = inverse.view((0, 0), (m, m)) / scale;
    let slopes = DVector::from_iterator(m, active.iter().map(|&i| conditions.rate.slope(i, pressure[i])));
    // Similar to f' R, and symmetric where the compliance is: D = sqrt(f' w).
    let root = DVector::from_iterator(m, active.iter().zip(&slopes).map(|(&i, s)| (s * contact.weights()[i]).sqrt()));
    let symmetrised =
        DMatrix::from_fn(m, m, |i, j| response[(i, j)] * root[i] * (slopes[j] / contact.weights()[active[j]]).sqrt());
    let asymmetry = (&symmetrised - symmetrised.transpose()).amax();
    if asymmetry < 1e-9 * symmetrised.amax() {
        let Ok(eigen) = factorization::symmetric_eigen(symmetrised) else { return 0.0 };
        let largest = eigen.eigenvalues.max();
        return if largest > 0.0 { 2.0 / largest } else { f64::INFINITY };
    }
    let Ok(eigenvalues) = factorization::eigenvalues(symmetrised) else { return 0.0 };
    eigenvalues
        .iter()
        .filter(|value| value.norm_sqr() > 0.0)
        .map(|value| if value.re > 0.0 { 2.0 * value.re / value.norm_sqr() } else { f64::INFINITY })
        .fold(f64::INFINITY, f64::min)
}
