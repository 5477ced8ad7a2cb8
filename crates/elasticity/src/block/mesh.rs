//! Tensor-product mesh of rectangles, graded geometrically to all four corners of the block, and the numbering of
//! its degrees of freedom.
//!
//! Reentrant or mixed corners make the solution behave like r^lambda, and polynomials of higher order alone then
//! converge only algebraically. With element sizes that shrink by a constant factor towards the corner, the error falls
//! exponentially with the order and the number of layers. The corners between the held top and the free sides are the
//! worst (lambda = 0.71 at a Poisson's ratio of 0.3).
//!
//! Vertices, edges and interiors are called entities. Interiors are condensed out element by element, so only vertices
//! and edges (the skeleton) are numbered: by nested dissection of the grid, which keeps the Cholesky factor sparse
//! without a general ordering algorithm.
//!
//! Theory: docs/theory.md, section 3.4.

use super::element::Shape;

/// Break points and polynomial orders of one direction of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Ascending coordinates of the element boundaries, m, one more than there are intervals.
    pub points: Vec<f64>,
    /// Polynomial order of each interval.
    pub orders: Vec<usize>,
}

/// Subdivision of one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Division {
    /// Layers of elements that shrink towards the first end.
    pub first_layers: usize,
    /// Layers of elements that shrink towards the second end.
    pub last_layers: usize,
    /// Ratio of neighbouring layers' sizes, in (0, 1).
    pub grading: f64,
    /// Largest element, m.
    pub largest: f64,
}

impl Grid {
    /// Divides [start, end] geometrically towards both ends and evenly, by at most `division.largest`, in between.
    pub(crate) fn graded(start: f64, end: f64, division: Division, order: usize) -> Self {
        let length = end - start;
        let reach = (0.5 * length).min(division.largest);
        let powers = |layers: usize| (1..layers).rev().map(move |k| reach * division.grading.powi(k as i32));
        let mut points = vec![start];
        points.extend(powers(division.first_layers).map(|distance| start + distance));
        let middle = length - 2.0 * reach;
        let parts = (middle / division.largest - 1e-9).ceil().max(0.0) as usize;
        points.push(start + reach);
        points.extend((1..=parts).map(|i| start + reach + middle * i as f64 / parts as f64));
        let mut last: Vec<f64> = powers(division.last_layers).map(|distance| end - distance).collect();
        last.reverse();
        points.extend(last);
        points.push(end);
        let orders = vec![order; points.len() - 1];
        Self { points, orders }
    }

    /// Number of intervals.
    pub(crate) fn intervals(&self) -> usize {
        self.orders.len()
    }

    /// Length of interval `i`, m.
    pub(crate) fn size(&self, i: usize) -> f64 {
        self.points[i + 1] - self.points[i]
    }

    /// Shape functions that belong to position `u` alone: even positions are break points, odd ones intervals.
    fn functions_at(&self, u: usize) -> usize {
        if u.is_multiple_of(2) { 1 } else { self.orders[u / 2] - 1 }
    }

    fn positions(&self) -> usize {
        2 * self.intervals() + 1
    }
}

/// Number of vertices and edges of an element.
pub(crate) const ENTITIES_PER_ELEMENT: usize = 8;

/// Positions of an element's skeleton entities relative to its lower left vertex: vertices, then edges along x
/// (below, above), then edges along z (left, right).
const LOCAL_POSITIONS: [(usize, usize); ENTITIES_PER_ELEMENT] =
    [(0, 0), (2, 0), (0, 2), (2, 2), (1, 0), (1, 2), (0, 1), (2, 1)];

/// One vertex or edge of the skeleton.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entity {
    /// Position in the grid of vertices (even) and intervals (odd).
    #[cfg(test)]
    position: (usize, usize),
    /// Number of its first scalar degree of freedom.
    pub first: usize,
    /// Number of its scalar degrees of freedom.
    pub count: usize,
}

/// The mesh: columns times rows of rectangles, x along the contact, z from the contact (0) to the top.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    /// Columns.
    pub x: Grid,
    /// Rows.
    pub z: Grid,
    /// Skeleton entities in the order of their numbers; those of the top edge come last if the top is held.
    pub entities: Vec<Entity>,
    /// Number of free entities; the rest is held.
    pub free_entities: usize,
    /// Number of free scalar degrees of freedom.
    pub free: usize,
    /// Scalar degrees of freedom of the skeleton.
    pub total: usize,
    /// First scalar interior mode of each element, counted over all interiors, and their number at the end.
    interiors: Vec<usize>,
    number_at: Vec<usize>,
}

impl Mesh {
    /// Numbers the skeleton of the grid `x` times `z`. With `top_held` the degrees of freedom at the largest z are
    /// numbered behind all others.
    pub(crate) fn new(x: Grid, z: Grid, top_held: bool) -> Self {
        let (columns, rows) = (x.positions(), z.positions());
        let mut order = Vec::with_capacity(columns * rows);
        let last_free = if top_held { rows - 2 } else { rows - 1 };
        dissect((0, columns - 1), (0, last_free), &mut order);
        if top_held {
            order.extend((0..columns).map(|u| (u, rows - 1)));
        }
        let mut number_at = vec![usize::MAX; columns * rows];
        let mut entities = Vec::with_capacity(order.len());
        let (mut total, mut free, mut free_entities) = (0, 0, 0);
        for position in order {
            let (u, w) = position;
            let count = x.functions_at(u) * z.functions_at(w);
            number_at[u * rows + w] = entities.len();
            entities.push(Entity {
                #[cfg(test)]
                position,
                first: total,
                count,
            });
            total += count;
            if w <= last_free {
                (free, free_entities) = (total, entities.len());
            }
        }
        let mut interiors = vec![0];
        for order_x in &x.orders {
            interiors.extend(z.orders.iter().map(|order_z| (order_x - 1) * (order_z - 1)));
        }
        for element in 1..interiors.len() {
            interiors[element] += interiors[element - 1];
        }
        Self { x, z, entities, free_entities, free, total, interiors, number_at }
    }

    /// Number of elements.
    pub(crate) fn elements(&self) -> usize {
        self.x.intervals() * self.z.intervals()
    }

    /// Scalar interior modes of element `element`, counted over all interiors.
    pub(crate) fn interior(&self, element: usize) -> std::ops::Range<usize> {
        self.interiors[element]..self.interiors[element + 1]
    }

    /// Number of scalar interior modes of all elements.
    pub(crate) fn interior_total(&self) -> usize {
        self.interiors[self.elements()]
    }

    /// Shape of element `element`.
    pub(crate) fn shape(&self, element: usize) -> Shape {
        let (column, row) = self.column_and_row(element);
        Shape {
            size_x: self.x.size(column),
            size_z: self.z.size(row),
            order_x: self.x.orders[column],
            order_z: self.z.orders[row],
        }
    }

    /// The distinct shapes of the elements under the relation `same`, and the index of each element's shape.
    pub(crate) fn distinct_shapes(&self, same: impl Fn(&Shape, &Shape) -> bool) -> (Vec<Shape>, Vec<usize>) {
        let mut shapes: Vec<Shape> = Vec::new();
        let kind = (0..self.elements())
            .map(|element| {
                let shape = self.shape(element);
                shapes.iter().position(|other| same(other, &shape)).unwrap_or_else(|| {
                    shapes.push(shape);
                    shapes.len() - 1
                })
            })
            .collect();
        (shapes, kind)
    }

    /// Number of the element in `column`, `row`.
    pub(crate) fn element(&self, column: usize, row: usize) -> usize {
        column * self.z.intervals() + row
    }

    /// Column and row of element `element`.
    pub(crate) fn column_and_row(&self, element: usize) -> (usize, usize) {
        (element / self.z.intervals(), element % self.z.intervals())
    }

    fn entity_at(&self, u: usize, w: usize) -> usize {
        self.number_at[u * self.z.positions() + w]
    }

    /// Numbers of the entities of the element in `column`, `row`, in the order of the element matrices.
    pub(crate) fn element_entities(&self, column: usize, row: usize) -> [usize; ENTITIES_PER_ELEMENT] {
        LOCAL_POSITIONS.map(|(u, w)| self.entity_at(2 * column + u, 2 * row + w))
    }

    /// Scalar degrees of freedom of the element in `column`, `row`, in the order of the element matrices.
    pub(crate) fn element_degrees(&self, column: usize, row: usize) -> Vec<usize> {
        let mut degrees = Vec::new();
        for entity in self.element_entities(column, row) {
            let Entity { first, count, .. } = self.entities[entity];
            degrees.extend(first..first + count);
        }
        degrees
    }

    fn line_degrees(&self, ends: [usize; 2], interior: usize) -> Vec<usize> {
        let mut degrees: Vec<usize> = ends.iter().map(|&end| self.entities[end].first).collect();
        let Entity { first, count, .. } = self.entities[interior];
        degrees.extend(first..first + count);
        degrees
    }

    /// Degrees of freedom of the shape functions 0 .. order of column `column` on the contact (`top` false) or the
    /// top edge.
    pub(crate) fn horizontal_degrees(&self, column: usize, top: bool) -> Vec<usize> {
        let w = if top { self.z.positions() - 1 } else { 0 };
        let u = 2 * column;
        self.line_degrees([self.entity_at(u, w), self.entity_at(u + 2, w)], self.entity_at(u + 1, w))
    }

    /// Degrees of freedom of the shape functions 0 .. order of row `row` on the left or right side.
    pub(crate) fn vertical_degrees(&self, row: usize, right: bool) -> Vec<usize> {
        let u = if right { self.x.positions() - 1 } else { 0 };
        let w = 2 * row;
        self.line_degrees([self.entity_at(u, w), self.entity_at(u, w + 2)], self.entity_at(u, w + 1))
    }

    /// Coordinates of the vertex behind entity `entity`, if it is one.
    #[cfg(test)]
    pub(crate) fn vertex(&self, entity: &Entity) -> Option<(f64, f64)> {
        let (u, w) = entity.position;
        (u.is_multiple_of(2) && w.is_multiple_of(2)).then(|| (self.x.points[u / 2], self.z.points[w / 2]))
    }
}

/// Appends the skeleton positions of the box (inclusive ranges) in nested-dissection order: the two halves first, then
/// the grid line between them.
fn dissect(u: (usize, usize), w: (usize, usize), order: &mut Vec<(usize, usize)>) {
    if u.0 > u.1 || w.0 > w.1 {
        return;
    }
    let (across, along) = (u.1 - u.0, w.1 - w.0);
    if across.max(along) < 3 {
        for i in u.0..=u.1 {
            for k in w.0..=w.1 {
                if i.is_multiple_of(2) || k.is_multiple_of(2) {
                    order.push((i, k));
                }
            }
        }
        return;
    }
    // Element boundaries are the even positions, and one lies strictly inside any range of four.
    let middle = |range: (usize, usize)| {
        let half = range.0.midpoint(range.1);
        if half.is_multiple_of(2) { half } else { half + 1 }
    };
    if across >= along {
        let line = middle(u);
        dissect((u.0, line - 1), w, order);
        dissect((line + 1, u.1), w, order);
        order.extend((w.0..=w.1).map(|k| (line, k)));
    } else {
        let line = middle(w);
        dissect(u, (w.0, line - 1), order);
        dissect(u, (line + 1, w.1), order);
        order.extend((u.0..=u.1).map(|i| (i, line)));
    }
}
