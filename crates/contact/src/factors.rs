//! Compliance of the pair with wear on its diagonal, and a cache of its factors.
//!
//! Theory: docs/theory.md, sections 6.4, 6.5.

use super::problem::ContactError;
use elasticity::{Cells, MAXIMUM_CELLS};
use nalgebra::DMatrix;
use numerics::cache::KeyedCache;
use numerics::dense;

/// Size of the factor cache in numbers, unless fewer than [`LEAST_ENTRIES`] fit: both strokes and both stages of a step of
/// two step sizes, and some alternating contact sets.
const MEMO_NUMBERS: usize = 600_000;
const LEAST_ENTRIES: usize = 4;
/// Largest number of entries, however few cells.
const MOST_ENTRIES: usize = 12;
/// Number of signed friction values whose compliance is cached.
const COMPOSITIONS: usize = 2;
/// Largest number of cached added compliances: those of the step sizes between which a step control alternates.
const MOST_ADDED: usize = 6;
const LEAST_ADDED: usize = 2;

/// Largest rank of a [`LowRankUpdate`] on `count` cells.
pub fn largest_update_rank(count: usize) -> usize {
    count.div_ceil(4)
}

/// Low-rank update `left right` that is subtracted from the added compliance while some cells have no influence on the others.
#[derive(Clone, Copy, Debug)]
pub struct LowRankUpdate<'a> {
    /// Cells with influence. The product is a function of them and of the added compliance alone.
    pub acting: &'a [bool],
    /// N x m by columns, m at most [`largest_update_rank`].
    pub left: &'a [f64],
    /// m x N by columns.
    pub right: &'a [f64],
}

/// A [`LowRankUpdate`] in memory for the largest rank.
#[derive(Clone, Debug)]
struct CachedUpdate {
    acting: Vec<bool>,
    /// Whether it belongs to the current added compliance.
    current: bool,
    rank: usize,
    left: Vec<f64>,
    right: Vec<f64>,
}

/// System matrix for the pressures of the cells in contact: `C + s mu S + E + T diag(d) + beta 1 w'/W`, N x N, m/Pa.
///
/// C and S are the normal and the shear compliance of the pair (strip less punch for S), E an added compliance that changes
/// from step to step, less its low-rank update, d wear per pressure, T the wear operator (none: the identity), w the weights
/// of the load integral and W their sum. The last term only shifts the approach by `beta P/W` where the approach is free; it
/// keeps the matrix regular for bodies whose uniform displacement is not defined.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    count: usize,
    normal: Vec<f64>,
    shear: Vec<f64>,
    /// Extra matrices by names that tell each from all that came before; 0 is none.
    added_compliances: KeyedCache<u64, Vec<f64>>,
    names: u64,
    /// Cache slot of the current added compliance.
    added_compliance: Option<usize>,
    low_rank_update: CachedUpdate,
    operator: Option<Vec<f64>>,
    positions: Vec<f64>,
    length: f64,
    weights: Vec<f64>,
    total_weight: f64,
    shift: f64,
    compositions: KeyedCache<Sum, Composition>,
    entries: KeyedCache<(Sum, bool), Entry>,
    pub factorisations: u64,
}

/// Name of the extra matrix and bits of the signed friction of a compliance.
type Sum = (u64, u64);

#[derive(Clone, Debug)]
struct Composition {
    acting: Vec<bool>,
    matrix: Vec<f64>,
}

/// Factors for one contact set, and the pressures by a uniform and by a linear displacement.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    acting: Vec<bool>,
    diagonal: Vec<f64>,
    active: Vec<bool>,
    /// Cells in contact, and open cells.
    pub index: Vec<usize>,
    pub open: Vec<usize>,
    /// Gap of each open cell per pressure of the cells in contact, wear included, without the shift: row by row, m/Pa.
    /// Computed once, on first use.
    open_rows: Vec<f64>,
    has_open_rows: bool,
    /// Elastic self-compliance of every cell with its wear, m/Pa: positive whatever the thermal distortion.
    pub own: Vec<f64>,
    matrix: Vec<f64>,
    exchanged: Vec<usize>,
    regular: bool,
    /// Pressure of the cells in contact per approach, and per displacement `(x - centre)/length`; computed once, on first use.
    pub columns: [Vec<f64>; 2],
    has_columns: [bool; 2],
    /// Resultant and moment, about the centre and per length, of the two columns, per depth.
    pub sums: [[f64; 2]; 2],
    /// Weights w of the cells in contact, and `w (x - centre)/length`.
    weights: Vec<f64>,
    arms: Vec<f64>,
    /// Mean position of the cells in contact.
    pub centre: f64,
}

/// Cache key of the factors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key<'a> {
    /// Signed friction s mu.
    pub signed_friction: f64,
    /// Whether the approach is free.
    pub shifted: bool,
    /// Wear diagonal d, N values, m/Pa.
    pub diagonal: &'a [f64],
    pub active: &'a [bool],
}

/// Checks that normal compliance and shear coupling (N x N, m/Pa) can be those of a contact.
///
/// # Errors
/// A number that is not finite, or a body without compliance.
pub fn check_operators(count: usize, normal: &DMatrix<f64>, shear: &DMatrix<f64>) -> Result<(), ContactError> {
    assert_eq!(normal.shape(), (count, count), "normal compliance is N x N");
    assert_eq!(shear.shape(), (count, count), "shear compliance is N x N");
    if let Some(&value) = normal.iter().chain(shear.iter()).find(|v| !v.is_finite()) {
        return Err(ContactError::Invalid { quantity: "compliance", value });
    }
    if normal.diagonal().min() <= 0.0 {
        return Err(ContactError::Rigid);
    }
    Ok(())
}

impl Factors {
    pub(crate) fn new(
        cells: &Cells,
        weights: &[f64],
        normal: DMatrix<f64>,
        shear: DMatrix<f64>,
    ) -> Result<Self, ContactError> {
        let count = weights.len();
        check_operators(count, &normal, &shear)?;
        let acting = vec![true; count];
        let room = || vec![0.0; count * largest_update_rank(count)];
        // Every piece of memory by itself, not as a copy: zeros that nobody has touched yet cost nothing.
        let composition = |_| Composition { acting: acting.clone(), matrix: vec![0.0; count * count] };
        let entry = |_| Entry {
            acting: acting.clone(),
            diagonal: vec![0.0; count],
            active: vec![false; count],
            index: Vec::with_capacity(count),
            open: Vec::with_capacity(count),
            // Upper bound of the number of cells in contact times that of open ones.
            open_rows: vec![0.0; count * count / 4],
            has_open_rows: false,
            own: vec![0.0; count],
            matrix: vec![0.0; count * count],
            exchanged: vec![0; count],
            regular: false,
            columns: [vec![0.0; count], vec![0.0; count]],
            has_columns: [false; 2],
            sums: [[0.0; 2]; 2],
            weights: vec![0.0; count],
            arms: vec![0.0; count],
            centre: 0.0,
        };
        let added_compliances = (MEMO_NUMBERS / (count * count)).clamp(LEAST_ADDED, MOST_ADDED);
        let kept = (MEMO_NUMBERS / (count * count)).clamp(LEAST_ENTRIES, MOST_ENTRIES);
        Ok(Self {
            count,
            shift: normal.diagonal().mean(),
            normal: normal.data.into(),
            shear: shear.data.into(),
            added_compliances: KeyedCache::new((0..added_compliances).map(|_| vec![0.0; count * count])),
            names: 0,
            added_compliance: None,
            low_rank_update: CachedUpdate {
                acting: acting.clone(),
                current: true,
                rank: 0,
                left: room(),
                right: room(),
            },
            operator: None,
            positions: cells.centres().to_vec(),
            length: cells.half_width(),
            weights: weights.to_vec(),
            total_weight: weights.iter().sum(),
            compositions: KeyedCache::new((0..COMPOSITIONS).map(composition)),
            entries: KeyedCache::new((0..kept).map(entry)),
            factorisations: 0,
        })
    }

    /// beta/W, m/Pa per m: approach per load that the shift of the matrix adds.
    pub(crate) fn shift(&self) -> f64 {
        self.shift / self.total_weight
    }

    /// Sets or removes the added compliance. Factors are cached for each of the last ones.
    pub(crate) fn set_added_compliance(&mut self, added_compliance: Option<&DMatrix<f64>>) -> Result<(), ContactError> {
        if let Some(matrix) = added_compliance {
            assert_eq!(matrix.shape(), (self.count, self.count), "extra compliance is N x N");
            let known = self.added_compliances.find(|_, known| same_bits(known, matrix.as_slice()));
            if let (None, Some(&value)) = (known, matrix.iter().find(|v| !v.is_finite())) {
                return Err(ContactError::Invalid { quantity: "extra compliance", value });
            }
            let place = known.unwrap_or_else(|| {
                self.names += 1;
                let place = self.added_compliances.insert(self.names);
                self.added_compliances[place].copy_from_slice(matrix.as_slice());
                place
            });
            self.added_compliance = Some(place);
        } else {
            self.added_compliance = None;
        }
        self.low_rank_update.current = false;
        self.set_low_rank_update(None);
        Ok(())
    }

    /// Sets or removes the low-rank update. Compliances and factors are cached for every set of acting cells.
    pub(crate) fn set_low_rank_update(&mut self, low_rank_update: Option<LowRankUpdate<'_>>) {
        let kept = &mut self.low_rank_update;
        let Some(LowRankUpdate { acting, left, right }) = low_rank_update else {
            if !kept.current || kept.rank > 0 {
                kept.acting.fill(true);
                (kept.rank, kept.current) = (0, true);
            }
            return;
        };
        if kept.current && kept.rank > 0 && kept.acting == acting {
            return;
        }
        kept.acting.copy_from_slice(acting);
        kept.left[..left.len()].copy_from_slice(left);
        kept.right[..right.len()].copy_from_slice(right);
        (kept.rank, kept.current) = (left.len() / self.count, true);
    }

    pub(crate) fn set_operator(&mut self, operator: Option<&DMatrix<f64>>) {
        self.entries.clear();
        let Some(matrix) = operator else {
            self.operator = None;
            return;
        };
        assert_eq!(matrix.shape(), (self.count, self.count), "the wear operator is N x N");
        match &mut self.operator {
            Some(kept) => kept.copy_from_slice(matrix.as_slice()),
            None => self.operator = Some(matrix.as_slice().to_vec()),
        }
    }

    /// `S`, by columns.
    pub(crate) fn shear(&self) -> &[f64] {
        &self.shear
    }

    /// Wear operator T, by columns.
    pub(crate) fn operator(&self) -> Option<&[f64]> {
        self.operator.as_deref()
    }

    /// Elastic displacement of a cell by its own pressure, C_ii > 0, m/Pa.
    pub(crate) fn own(&self, cell: usize) -> f64 {
        self.normal[cell * (self.count + 1)]
    }

    /// Compliance `C + s mu S + E` less the low-rank update, by columns.
    pub(crate) fn compliance(&mut self, signed_friction: f64) -> &[f64] {
        let position = self.compose(signed_friction);
        &self.compositions[position].matrix
    }

    fn sum(&self, signed_friction: f64) -> Sum {
        let name = self.added_compliance.and_then(|place| self.added_compliances.key(place).copied());
        (name.unwrap_or(0), signed_friction.to_bits())
    }

    fn compose(&mut self, signed_friction: f64) -> usize {
        let sum = self.sum(signed_friction);
        let CachedUpdate { acting, rank, left, right, .. } = &self.low_rank_update;
        if let Some(position) = self.compositions.find(|key, known| *key == sum && known.acting == *acting) {
            return position;
        }
        let added_compliance = self.added_compliance.map(|place| &self.added_compliances[place]);
        let position = self.compositions.insert(sum);
        let composition = &mut self.compositions[position];
        composition.acting.copy_from_slice(acting);
        for ((target, normal), shear) in composition.matrix.iter_mut().zip(&self.normal).zip(&self.shear) {
            *target = normal + signed_friction * shear;
        }
        if let Some(added_compliance) = added_compliance {
            for (target, added_compliance) in composition.matrix.iter_mut().zip(added_compliance) {
                *target += added_compliance;
            }
        }
        if *rank > 0 {
            let mut weights = [0.0; MAXIMUM_CELLS];
            let columns = composition.matrix.chunks_exact_mut(self.count).zip(right.chunks_exact(*rank));
            for (target, column) in columns {
                weights.iter_mut().zip(column).for_each(|(weight, value)| *weight = -value);
                dense::multiply_add(&left[..self.count * rank], &weights[..*rank], target);
            }
        }
        position
    }

    /// Cache position of the entry for `key`, factorised on a miss; `None` where the matrix is singular.
    pub(crate) fn find(&mut self, key: Key<'_>) -> Option<usize> {
        let scalars = (self.sum(key.signed_friction), key.shifted);
        let fits = |known: &(Sum, bool), entry: &Entry| {
            *known == scalars
                && entry.active == key.active
                && entry.acting == self.low_rank_update.acting
                && entry.index.iter().all(|&i| entry.diagonal[i].to_bits() == key.diagonal[i].to_bits())
        };
        if let Some(position) = self.entries.find(fits) {
            return self.entries[position].regular.then_some(position);
        }
        self.factorisations += 1;
        let composed = self.compose(key.signed_friction);
        let position = self.entries.insert(scalars);
        let (composition, entry) = (&self.compositions[composed].matrix, &mut self.entries[position]);
        entry.diagonal.copy_from_slice(key.diagonal);
        entry.active.copy_from_slice(key.active);
        entry.acting.copy_from_slice(&self.low_rank_update.acting);
        entry.has_columns = [false; 2];
        entry.has_open_rows = false;
        entry.index.clear();
        entry.index.extend((0..self.count).filter(|&i| key.active[i]));
        entry.open.clear();
        entry.open.extend((0..self.count).filter(|&i| !key.active[i]));
        let m = entry.index.len();
        for (i, own) in entry.own.iter_mut().enumerate() {
            *own = self.normal[i * (self.count + 1)] + key.diagonal[i];
        }
        entry.centre = entry.index.iter().map(|&i| self.positions[i]).sum::<f64>() / m.max(1) as f64;
        for (k, &i) in entry.index.iter().enumerate() {
            entry.weights[k] = self.weights[i];
            entry.arms[k] = self.weights[i] * (self.positions[i] - entry.centre) / self.length;
        }
        for (b, &j) in entry.index.iter().enumerate() {
            let shift = if key.shifted { self.shift / self.total_weight * self.weights[j] } else { 0.0 };
            let column = &composition[j * self.count..(j + 1) * self.count];
            let target = &mut entry.matrix[b * m..(b + 1) * m];
            if m == self.count {
                for (value, source) in target.iter_mut().zip(column) {
                    *value = source + shift;
                }
            } else {
                for (value, &i) in target.iter_mut().zip(&entry.index) {
                    *value = column[i] + shift;
                }
            }
            match &self.operator {
                None => target[b] += key.diagonal[j],
                Some(operator) => {
                    let column = &operator[j * self.count..(j + 1) * self.count];
                    for (value, &i) in target.iter_mut().zip(&entry.index) {
                        *value += key.diagonal[j] * column[i];
                    }
                }
            }
        }
        entry.regular = dense::factorise(&mut entry.matrix[..m * m], m, &mut entry.exchanged[..m]);
        entry.regular.then_some(position)
    }

    /// The entry with the rows of its open cells.
    pub(crate) fn with_open_rows(&mut self, position: usize) -> &Entry {
        if self.entries[position].has_open_rows {
            return &self.entries[position];
        }
        let (_, signed_friction) = self.entries.key(position).map_or((0, 0), |key| key.0);
        let composed = self.compose(f64::from_bits(signed_friction));
        let (composition, entry) = (&self.compositions[composed].matrix, &mut self.entries[position]);
        entry.has_open_rows = true;
        let m = entry.index.len();
        for (row, &i) in entry.open_rows.chunks_exact_mut(m.max(1)).zip(&entry.open) {
            for (value, &j) in row.iter_mut().zip(&entry.index) {
                let worn =
                    self.operator.as_ref().map_or(0.0, |operator| entry.diagonal[j] * operator[j * self.count + i]);
                *value = composition[j * self.count + i] + worn;
            }
        }
        entry
    }

    /// The entry at a position.
    pub(crate) fn entry(&self, position: usize) -> &Entry {
        &self.entries[position]
    }

    /// The entry with its pressures per approach and per linear displacement, as `wanted`.
    pub(crate) fn with_columns(&mut self, position: usize, wanted: [bool; 2]) -> &Entry {
        let entry = &mut self.entries[position];
        let m = entry.index.len();
        for k in (0..2).filter(|&k| wanted[k]) {
            if std::mem::replace(&mut entry.has_columns[k], true) {
                continue;
            }
            let mut column = std::mem::take(&mut entry.columns[k]);
            for (value, &i) in column.iter_mut().zip(&entry.index) {
                *value = if k == 0 { 1.0 } else { (self.positions[i] - entry.centre) / self.length };
            }
            entry.substitute(&mut column[..m]);
            entry.sums[k] = entry.resultant(&column[..m]);
            entry.columns[k] = column;
        }
        entry
    }
}

impl Entry {
    /// Solves for one right-hand side over the cells in contact, in place.
    pub(crate) fn substitute(&self, right: &mut [f64]) {
        let m = self.index.len();
        dense::substitute(&self.matrix[..m * m], m, &self.exchanged[..m], right);
    }

    /// Adds the displacements by the pressures of the cells in contact to the gaps of the open cells.
    pub(crate) fn add_to_open(&self, pressure: &[f64], gaps: &mut [f64]) {
        let rows = &self.open_rows[..pressure.len() * gaps.len()];
        dense::multiply_transposed_add(rows, pressure, gaps);
    }

    /// Resultant `sum w p` and moment `sum w (x - centre)/length p` of the pressures of the cells in contact, per depth.
    pub(crate) fn resultant(&self, pressure: &[f64]) -> [f64; 2] {
        let m = pressure.len();
        [dense::dot(&self.weights[..m], pressure), dense::dot(&self.arms[..m], pressure)]
    }
}

/// Whether two matrices are bitwise equal.
fn same_bits(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| one.to_bits() == other.to_bits())
}
