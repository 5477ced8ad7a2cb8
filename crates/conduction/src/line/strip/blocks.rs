//! Influence matrices that depend on the distance of two cells alone, split by parity.
//!
//! Theory: docs/theory.md, section 4.5.

use super::passive::Passive;
use super::waves::Shapes;
use nalgebra::{Complex, DMatrix};
use numerics::dense;
use pulp::{Arch, Simd, WithSimd};

/// Half number of cells from which on a row of them fills the vector unit.
const FEW_CELLS: usize = 8;

/// Columns transposed together.
const TILE: usize = 8;

/// A translation-invariant influence on symmetric cells, per heat (W/m) into a cell, split by parity.
///
/// Three blocks of ((N + 1)/2)^2 values, by rows: even response to even heat, even to odd, odd to odd. Odd to even is
/// minus the transpose of even to odd. Reversing the velocity transposes the influence, which changes the sign of the
/// middle block: the outer ones are symmetric.
#[derive(Clone, PartialEq, Debug)]
pub struct Blocks {
    half: usize,
    /// The three blocks.
    pub values: Vec<f64>,
}

impl Blocks {
    /// Zero influence.
    pub fn zeros(half: usize) -> Blocks {
        Blocks { half, values: vec![0.0; 3 * half * half] }
    }

    /// Adds Re of `gain exp(iq(x - s))`.
    pub fn add_wave(&mut self, gain: Complex<f64>, even: &[f64], odd: &[f64]) {
        let size = self.half * self.half;
        let (even_even, rest) = self.values.split_at_mut(size);
        let (even_odd, odd_odd) = rest.split_at_mut(size);
        for a in 0..self.half {
            let row = a * self.half..(a + 1) * self.half;
            let (ee, eo, oo) = (gain.re * even[a], gain.im * even[a], gain.re * odd[a]);
            for (value, other) in even_even[row.clone()].iter_mut().zip(even) {
                *value += ee * other;
            }
            for (value, other) in even_odd[row.clone()].iter_mut().zip(odd) {
                *value += eo * other;
            }
            for (value, other) in odd_odd[row].iter_mut().zip(odd) {
                *value += oo * other;
            }
        }
    }

    /// Adds Re of `gain exp(iq(x - s))` for every mode; `terms` is workspace for one number per mode.
    pub fn add_waves(&mut self, influence: &[Complex<f64>], shapes: &Shapes, terms: &mut [f64]) {
        let (half, size, count) = (self.half, self.half * self.half, influence.len());
        let ([even, odd], [even_by_cell, odd_by_cell]) = (shapes.matrices(), shapes.transposed());
        let (even_even, rest) = self.values.split_at_mut(size);
        let (even_odd, odd_odd) = rest.split_at_mut(size);
        // With few cells the sums run over the modes, to fill the lanes of the vector unit; symmetric blocks are then
        // computed once, from `first` on.
        let few = half < FEW_CELLS;
        let multiply = |by_wave: &[f64], by_cell: &[f64], terms: &[f64], row: &mut [f64], first: usize| match few {
            true => dense::multiply_transposed_add(&by_cell[first * count..], terms, &mut row[first..]),
            false => dense::multiply_add(by_wave, terms, row),
        };
        for a in 0..half {
            let (row, cell) = (a * half..(a + 1) * half, a * count..(a + 1) * count);
            let (even_here, odd_here) = (&even_by_cell[cell.clone()], &odd_by_cell[cell]);
            for (term, (gain, shape)) in terms.iter_mut().zip(influence.iter().zip(even_here)) {
                *term = gain.re * shape;
            }
            multiply(even, even_by_cell, terms, &mut even_even[row.clone()], a);
            for (term, (gain, shape)) in terms.iter_mut().zip(influence.iter().zip(even_here)) {
                *term = gain.im * shape;
            }
            multiply(odd, odd_by_cell, terms, &mut even_odd[row.clone()], 0);
            for (term, (gain, shape)) in terms.iter_mut().zip(influence.iter().zip(odd_here)) {
                *term = gain.re * shape;
            }
            multiply(odd, odd_by_cell, terms, &mut odd_odd[row], a);
            if few {
                for b in a + 1..half {
                    even_even[b * half + a] = even_even[a * half + b];
                    odd_odd[b * half + a] = odd_odd[a * half + b];
                }
            }
        }
    }

    /// Adds a kernel given by its mean over pairs of cells (observed, heated).
    pub fn add_kernel(&mut self, count: usize, kernel: impl Fn(usize, usize) -> f64) {
        let size = self.half * self.half;
        for a in 0..self.half {
            for b in 0..self.half {
                let (mirror_a, mirror_b) = (count - 1 - a, count - 1 - b);
                let (k, l) = (kernel(a, b), kernel(a, mirror_b));
                let (m, n) = (kernel(mirror_a, b), kernel(mirror_a, mirror_b));
                let at = a * self.half + b;
                self.values[at] += 0.25 * (k + l + m + n);
                self.values[size + at] += 0.25 * (k - l + m - n);
                self.values[2 * size + at] += 0.25 * (k - l - m + n);
            }
        }
    }

    /// Sets an N x N matrix to the influence per flux (W/m2) plus the uniform influence `level`; `turned` is workspace
    /// for a block and one of its rows.
    pub fn unfold(&self, widths: &[f64], level: f64, turned: &mut [f64], matrix: &mut DMatrix<f64>) {
        struct Unfold<'a>(&'a Blocks, &'a [f64], f64, &'a mut [f64], &'a mut [f64]);
        impl WithSimd for Unfold<'_> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) {
                let Self(blocks, widths, level, turned, values) = self;
                let (half, count) = (blocks.half, widths.len());
                let (turned, mirrored) = turned.split_at_mut(half * half);
                let (even, rest) = blocks.values.split_at(half * half);
                let (mixed, odd) = rest.split_at(half * half);
                // Transposes the middle block, a few columns at a time.
                for first in (0..half).step_by(TILE) {
                    let tile = TILE.min(half - first);
                    for a in 0..half {
                        for (b, value) in mixed[a * half + first..][..tile].iter().enumerate() {
                            turned[(first + b) * half + a] = *value;
                        }
                    }
                }
                for b in 0..half {
                    let row = b * half..(b + 1) * half;
                    let parts = [&even[row.clone()], &turned[row.clone()], &mixed[row.clone()], &odd[row]];
                    for (at, sign) in [(count - 1 - b, -1.0), (b, 1.0)] {
                        let target = &mut values[at * count..(at + 1) * count];
                        column(simd, parts, [sign, widths[b], level], mirrored, target);
                    }
                }
            }
        }
        let (expected, size) = ((widths.len(), widths.len()), (self.half + 1) * self.half);
        assert!(matrix.shape() == expected && self.half == widths.len().div_ceil(2), "N x N, of N cells");
        Arch::new().dispatch(Unfold(self, widths, level, &mut turned[..size], matrix.as_mut_slice()));
    }

    /// Removes the part that is odd in the sliding velocity.
    pub fn make_symmetric(&mut self) {
        let size = self.half * self.half;
        self.values[size..2 * size].fill(0.0);
    }

    /// Makes the influence passive: removes the negative eigenvalues of the symmetric part, which is that of the even
    /// and of the odd block.
    ///
    /// The truncated part of a reduction at a frequency just beyond its range has a real part of either sign. A
    /// negative one in the direct feedthrough lets two bodies in thermal contact raise each other's flux without bound
    /// in steps short against the range; the part removed is below the reduction's own error.
    ///
    /// The response M c to a uniform flux, of even heat c = `uniform`, is preserved where c'M c > 0: of
    ///
    /// ```text
    /// M = u u'/(c'u) + S,    u = M c,    S c = 0
    /// ```
    ///
    /// only S loses eigenvalues. The steady mean temperature stays exact, and smooth in the velocity. The weight of u
    /// u' decreases to 0 as u turns away from c, where that term would be a large response to all other fluxes.
    pub fn make_passive(&mut self, uniform: &[f64], workspace: &mut Passive) {
        let (half, size) = (self.half, self.half * self.half);
        for block in [0, 2] {
            let values = &mut self.values[block * size..(block + 1) * size];
            if !workspace.is_passive(values, half) {
                workspace.project(values, half, if block == 0 { uniform } else { &[] });
            }
        }
    }

    /// Sets everything to 0.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }
}

/// Column of the influence of a cell (`sign` 1) or its mirror image (-1): even response to even and to odd heat, minus
/// odd to even, odd to odd. `mirrored` is workspace for the lower half, from the edge inwards.
#[inline(always)]
fn column<S: Simd>(
    simd: S,
    parts: [&[f64]; 4],
    [sign, width, level]: [f64; 3],
    mirrored: &mut [f64],
    target: &mut [f64],
) {
    let half = parts[0].len();
    let (top, bottom) = target.split_at_mut(half);
    let mut vectors: [(&[S::f64s], &[f64]); 4] = [(&[], &[]); 4];
    for k in 0..4 {
        vectors[k] = S::as_simd_f64s(&parts[k][..half]);
    }
    let ((top_head, top_tail), (low_head, low_tail)) =
        (S::as_mut_simd_f64s(top), S::as_mut_simd_f64s(&mut mirrored[..half]));
    let [signs, widths, levels] = [sign, width, level].map(|value| simd.splat_f64s(value));
    for i in 0..low_head.len() {
        let [even, even_to_odd, odd_to_even, odd] = [0, 1, 2, 3].map(|k| vectors[k].0[i]);
        let same = simd.add_f64s(simd.add_f64s(levels, even), simd.mul_f64s(signs, even_to_odd));
        let other = simd.sub_f64s(simd.mul_f64s(signs, odd), odd_to_even);
        top_head[i] = simd.mul_f64s(widths, simd.add_f64s(same, other));
        low_head[i] = simd.mul_f64s(widths, simd.sub_f64s(same, other));
    }
    for i in 0..low_tail.len() {
        let same = level + vectors[0].1[i] + sign * vectors[1].1[i];
        let other = sign * vectors[3].1[i] - vectors[2].1[i];
        top_tail[i] = width * (same + other);
        low_tail[i] = width * (same - other);
    }
    bottom.iter_mut().rev().zip(&*mirrored).for_each(|(value, mirrored)| *value = *mirrored);
}
