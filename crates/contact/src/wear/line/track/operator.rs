//! Wear operators of a travel, and of a stroke averaged over its cycle, as areas in the plane of two positions.
//!
//! Theory: docs/theory.md, section 5.5.

use nalgebra::DMatrix;

/// `T_ij(L) = 1/(w_i |L|) area of { xi in cell i, eta in cell j, eta - xi between 0 and L }`; the identity at L = 0.
pub(super) fn travelling(edges: &[f64], travel: f64, out: &mut DMatrix<f64>) {
    let count = edges.len() - 1;
    assert_eq!(out.shape(), (count, count), "the operator is N x N");
    out.fill(0.0);
    let length = travel.abs();
    let width = |i: usize| edges[i + 1] - edges[i];
    for i in 0..count {
        let own = width(i);
        out[(i, i)] = if length < own { 1.0 - 0.5 * length / own } else { 0.5 * own / length };
        // Cells ahead: those with larger x while the contact moves to larger x.
        if travel > 0.0 {
            for j in i + 1..count {
                let gap = edges[j] - edges[i + 1];
                if gap >= length {
                    break;
                }
                out[(i, j)] = swept(length - gap, own, width(j)) / (own * length);
            }
        } else if travel < 0.0 {
            for j in (0..i).rev() {
                let gap = edges[i] - edges[j + 1];
                if gap >= length {
                    break;
                }
                out[(i, j)] = swept(length - gap, own, width(j)) / (own * length);
            }
        }
    }
}

/// Integral of `min(max(s, 0), width)` over s from `reach - own` to `reach`, without differences of large numbers.
fn swept(reach: f64, own: f64, width: f64) -> f64 {
    let (low, high) = ((reach - own).max(0.0), reach);
    let (ramp_low, ramp_high) = (low.min(width), high.min(width));
    let ramp = 0.5 * (ramp_high - ramp_low) * (ramp_high + ramp_low);
    ramp + width * (high - low.max(width)).max(0.0)
}

/// Wear operator of a stroke S, averaged over the positions of both the contact and the strip:
///
/// ```text
/// K_ij = 1/w_i integral over cell i and cell j of (S - |eta - xi|)+ / S^2
/// ```
///
/// `w_i K_ij` is symmetric and positive semidefinite. Returns the fraction of each cell's wear that falls beyond the contact.
pub(super) fn averaging(edges: &[f64], stroke: f64, out: &mut DMatrix<f64>) -> Vec<f64> {
    let count = edges.len() - 1;
    out.fill(0.0);
    let square = stroke * stroke;
    // Second integral of (S - y)+.
    let twice = |y: f64| (stroke - y).max(0.0).powi(3) / 6.0;
    let width = |i: usize| edges[i + 1] - edges[i];
    for i in 0..count {
        let own = width(i);
        out[(i, i)] = 2.0 * (0.5 * own * square + twice(own) - twice(0.0)) / (square * own);
        for j in i + 1..count {
            let gap = edges[j] - edges[i + 1];
            if gap >= stroke {
                break;
            }
            let area = twice(gap) - twice(gap + own) - twice(gap + width(j)) + twice(gap + own + width(j));
            out[(i, j)] = area / (square * own);
            out[(j, i)] = area / (square * width(j));
        }
    }
    (0..count).map(|j| 1.0 - (0..count).map(|i| width(i) * out[(i, j)]).sum::<f64>() / width(j)).collect()
}
