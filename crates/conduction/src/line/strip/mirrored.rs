//! Influence of fluxes into the cells of a strip on these cells.
//!
//! The strip is homogeneous along the path and the cells are symmetric about x = 0, so the influence per heat is the same for a pair of
//! cells and its mirror image:
//!
//! ```text
//! G_jl = K_jl w_l,    K_jl = K_(N-1-l)(N-1-j)
//! ```
//!
//! With J, which reverses the order of the cells, S = K J is symmetric, and its lower triangle is kept alone. Linear combinations of
//! influence matrices, in velocity and time, cost by the memory that they read.
//!
//! Theory: docs/theory.md, section 4.5.

use numerics::dense;

/// Lower triangle of S = K J by columns; empty: none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MirroredInfluence(Vec<f64>);

/// Place of the entry (row, column) of a lower triangle with `count` rows.
fn place(count: usize, row: usize, column: usize) -> usize {
    column * (2 * count - column - 1) / 2 + row
}

impl MirroredInfluence {
    /// Zeros in untouched pages, which cost no physical memory until written.
    pub(crate) fn new(count: usize) -> MirroredInfluence {
        MirroredInfluence(vec![0.0; count * (count + 1) / 2])
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes the influence per flux G, N x N, of cells of these widths: the mean of both mirror images.
    pub(crate) fn take(&mut self, influence: &[f64], widths: &[f64]) {
        let count = widths.len();
        let entry = |row: usize, column: usize| {
            let other = count - 1 - column;
            influence[other * count + row] / widths[other]
        };
        for column in 0..count {
            for row in column..count {
                self.0[place(count, row, column)] = 0.5 * (entry(row, column) + entry(column, row));
            }
        }
    }

    /// Sets the influence per flux G, N x N.
    pub(crate) fn fill(&self, influence: &mut [f64], widths: &[f64]) {
        let count = widths.len();
        for column in 0..count {
            for row in column..count {
                let value = self.0[place(count, row, column)];
                for (row, column) in [(row, count - 1 - column), (column, count - 1 - row)] {
                    influence[column * count + row] = value * widths[column];
                }
            }
        }
    }

    /// Sets this to a linear combination.
    pub(crate) fn combine<const K: usize>(&mut self, others: [&MirroredInfluence; K], factors: [f64; K]) {
        dense::combine(&mut self.0, others.map(|other| &other.0[..]), factors);
    }

    /// Adds a multiple of another one.
    pub(crate) fn add(&mut self, other: &MirroredInfluence, factor: f64) {
        dense::multiply_add(&other.0, &[factor], &mut self.0);
    }

    /// Adds the response to the heat (W/m) into the cells, which are in reverse order in `mirrored_heat`.
    pub(crate) fn respond(&self, mirrored_heat: &[f64], response: &mut [f64]) {
        dense::multiply_add_symmetric(&self.0, mirrored_heat, response);
    }

    /// Makes it that at the opposite velocity, J S J.
    pub(crate) fn reverse(&mut self, count: usize) {
        if self.is_empty() {
            return;
        }
        for column in 0..count {
            for row in column..count {
                let (here, there) = (place(count, row, column), place(count, count - 1 - column, count - 1 - row));
                if here < there {
                    self.0.swap(here, there);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elasticity::Cells;

    /// An influence that depends on the distance alone, and on its sign.
    #[test]
    fn a_lower_triangle_is_the_whole_influence() {
        for count in [1, 2, 7, 16, 33, 130] {
            let cells = Cells::graded(0.02, count).unwrap();
            let (x, widths) = (cells.centres(), cells.widths());
            let of = |velocity: f64| {
                let entry = |j: usize, l: usize| {
                    let distance = (x[j] - x[l]) / 0.02;
                    widths[l] * (1.0 + velocity * distance) / (1.0 + distance * distance)
                };
                (0..count * count).map(|at| entry(at % count, at / count)).collect::<Vec<_>>()
            };
            let full = of(0.4);
            let mut own = MirroredInfluence::new(count);
            own.take(&full, widths);
            let mut back = vec![f64::NAN; count * count];
            own.fill(&mut back, widths);
            let near = |one: &[f64], other: &[f64]| one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-14);
            assert!(near(&full, &back), "{count}");
            let flux: Vec<f64> = (0..count).map(|i| (1.7 * i as f64).sin()).collect();
            let mirrored: Vec<f64> = widths.iter().zip(flux.iter().rev()).map(|(width, flux)| width * flux).collect();
            let (mut expected, mut found) = (vec![1.0; count], vec![1.0; count]);
            dense::multiply_add(&full, &flux, &mut expected);
            own.respond(&mirrored, &mut found);
            assert!(near(&expected, &found), "{count}");
            own.reverse(count);
            own.fill(&mut back, widths);
            assert!(near(&of(-0.4), &back), "{count}");
        }
    }
}
