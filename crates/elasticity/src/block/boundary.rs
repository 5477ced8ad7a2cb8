//! Loads and prescribed values on the boundary of the block, for fields of C components per scalar degree of freedom.
//!
//! Theory: docs/theory.md, section 3.4.

use super::BlockError;
use super::lobatto::{shape_derivatives, shape_values};
use super::mesh::Mesh;
use faer::Mat;
use numerics::quadrature::gauss_legendre;
use std::cmp::Ordering;

/// Quadrature points beyond the order of the shape functions: the half-plane's fields are analytic on every element of
/// a graded mesh, and four more points resolve them to better than the finite elements do.
const EXTRA_POINTS: usize = 4;

/// The cells between ascending `boundaries`, which must span the contact of the given width.
pub(crate) fn contact_cells(width: f64, boundaries: &[f64]) -> Result<Vec<(f64, f64)>, BlockError> {
    for (index, pair) in boundaries.windows(2).enumerate() {
        if pair[1].partial_cmp(&pair[0]) != Some(Ordering::Greater) {
            return Err(BlockError::CellsNotAscending { index: index + 1, before: pair[0], value: pair[1] });
        }
    }
    let half_width = 0.5 * width;
    let first = boundaries.first().copied().unwrap_or(f64::NAN);
    let last = boundaries.last().copied().unwrap_or(f64::NAN);
    let tolerance = 1e-12 * width;
    let spans = (first + half_width).abs() <= tolerance && (last - half_width).abs() <= tolerance;
    if !(spans && boundaries.len() > 1) {
        return Err(BlockError::CellsDoNotSpanContact { first, last, half_width });
    }
    Ok(boundaries.windows(2).map(|pair| (pair[0], pair[1])).collect())
}

/// Whether cells between these boundaries are their own mirror images about x = 0.
pub(crate) fn are_symmetric(boundaries: &[f64]) -> bool {
    let width = boundaries.last().map_or(0.0, |last| 2.0 * last.abs());
    boundaries.iter().zip(boundaries.iter().rev()).all(|(x, mirrored)| (x + mirrored).abs() <= 1e-14 * width)
}

/// Integrals of the contact's shape functions over each cell: (scalar degree of freedom, integral, m). Exact, also
/// where a cell covers a part of an element.
pub(crate) fn contact_integrals(mesh: &Mesh, cells: &[(f64, f64)]) -> Vec<Vec<(usize, f64)>> {
    let grid = &mesh.x;
    let degrees: Vec<Vec<usize>> = (0..grid.intervals()).map(|column| mesh.horizontal_degrees(column, false)).collect();
    let highest = degrees.iter().map(Vec::len).max().unwrap_or(0);
    let rule = gauss_legendre(highest / 2 + 1);
    let mut values = vec![0.0; highest];
    let mut result = Vec::with_capacity(cells.len());
    for &(left, right) in cells {
        let mut integrals = Vec::new();
        for (column, degrees) in degrees.iter().enumerate() {
            let (start, size) = (grid.points[column], grid.size(column));
            let (from, to) = (left.max(start), right.min(start + size));
            if from >= to {
                continue;
            }
            let first = integrals.len();
            integrals.extend(degrees.iter().map(|&degree| (degree, 0.0)));
            for &(t, weight) in &rule {
                let x = 0.5 * (from + to) + 0.5 * (to - from) * t;
                shape_values(2.0 * (x - start) / size - 1.0, &mut values[..degrees.len()]);
                for (entry, value) in integrals[first..].iter_mut().zip(&values) {
                    entry.1 += 0.5 * (to - from) * weight * value;
                }
            }
        }
        result.push(integrals);
    }
    result
}

/// Loads of `columns` fields of traction or flux `density(column, right side, z)` on both sides, in the order of the
/// free skeleton's degrees of freedom.
pub(crate) fn side_loads<const C: usize>(
    mesh: &Mesh,
    columns: usize,
    density: impl Fn(usize, bool, f64) -> [f64; C],
) -> Mat<f64> {
    let mut loads = Mat::zeros(C * mesh.free, columns);
    for row in 0..mesh.z.intervals() {
        let (start, size) = (mesh.z.points[row], mesh.z.size(row));
        let rule = gauss_legendre(mesh.z.orders[row] + EXTRA_POINTS);
        for right in [false, true] {
            let degrees = mesh.vertical_degrees(row, right);
            let mut values = vec![0.0; degrees.len()];
            for &(xi, weight) in &rule {
                shape_values(xi, &mut values);
                let z = start + 0.5 * size * (1.0 + xi);
                for j in 0..columns {
                    let density = density(j, right, z);
                    for (&degree, value) in degrees.iter().zip(&values).filter(|&(&degree, _)| degree < mesh.free) {
                        for (i, component) in density.iter().enumerate() {
                            loads[(C * degree + i, j)] += 0.5 * size * weight * component * value;
                        }
                    }
                }
            }
        }
    }
    loads
}

/// Coefficients of `columns` prescribed fields at the held top, in the order of the held degrees of freedom: exact at the
/// vertices, the best approximation of `slope` = d `value` / dx in the mean square between them.
pub(crate) fn top_values<const C: usize>(
    mesh: &Mesh,
    columns: usize,
    value: impl Fn(usize, f64) -> [f64; C],
    slope: impl Fn(usize, f64) -> [f64; C],
) -> Mat<f64> {
    let mut held = Mat::zeros(C * (mesh.total - mesh.free), columns);
    for column in 0..mesh.x.intervals() {
        let degrees = mesh.horizontal_degrees(column, true);
        let (start, size) = (mesh.x.points[column], mesh.x.size(column));
        let first = |degree: usize| C * (degree - mesh.free);
        for j in 0..columns {
            for (&degree, x) in degrees.iter().zip([start, start + size]) {
                for (i, component) in value(j, x).into_iter().enumerate() {
                    held[(first(degree) + i, j)] = component;
                }
            }
        }
        let mut slopes = vec![0.0; degrees.len()];
        for (xi, weight) in gauss_legendre(mesh.x.orders[column] + EXTRA_POINTS) {
            shape_derivatives(xi, &mut slopes);
            let x = start + 0.5 * size * (1.0 + xi);
            for j in 0..columns {
                let known = slope(j, x);
                for (&degree, shape_slope) in degrees.iter().zip(&slopes).skip(2) {
                    for (i, component) in known.iter().enumerate() {
                        held[(first(degree) + i, j)] += 0.5 * size * weight * shape_slope * component;
                    }
                }
            }
        }
    }
    held
}
