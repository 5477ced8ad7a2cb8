//! Coverage of the cells of the contact line: the part of every cell that is in contact, and exchanges heat.
//!
//! A contact that ends within the zone ends within a cell. The cell is divided into [`PARTS`] parts of equal width, of which
//! whole ones are covered: heat enters the body through these alone, evenly, and it is their mean temperature that enters the
//! interface law. Fluxes remain per area of the whole cell, so that heat is conserved. With the covered fraction phi
//!
//! ```text
//! T_1 - T_2 = (q_2 - q_1)/(2 phi h_c)
//! ```
//!
//! with fluxes in W/m2, temperatures in K and h_c in W/(m2 K). A body has the same states with a coverage as without; they remember
//! the temperature of the parts that are not covered. Valid where at most one edge lies between two neighbouring cells.
//!
//! Theory: docs/theory.md, section 6.5.

/// Number of parts of a cell.
pub const PARTS: usize = 4;

/// All parts, by bits.
const WHOLE: u8 = (1 << PARTS) - 1;

/// The parts from `start` to `end`, by bits.
fn between(start: usize, end: usize) -> u8 {
    (WHOLE >> (PARTS - end)) & (WHOLE << start)
}

/// Covered parts of every cell. Cells that do not exchange heat count as whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coverage {
    /// By bits, from the -x edge of the cell to its +x edge; never 0.
    covered: Vec<u8>,
}

impl Coverage {
    /// Whole cells.
    pub fn whole(count: usize) -> Coverage {
        Coverage { covered: vec![WHOLE; count] }
    }

    /// Makes all cells whole.
    pub fn make_whole(&mut self) {
        self.covered.fill(WHOLE);
    }

    /// Takes another coverage of as many cells.
    pub fn copy_from(&mut self, other: &Coverage) {
        self.covered.copy_from_slice(&other.covered);
    }

    /// Covers the parts from `start` to `end` of a cell alone, at least one.
    pub fn cover_between(&mut self, cell: usize, start: usize, end: usize) {
        let start = start.min(PARTS - 1);
        self.covered[cell] = between(start, end.clamp(start + 1, PARTS));
    }

    /// Covers the parts of a cell before `start` and from `end` on; where these are none, it counts as whole.
    pub fn cover_beside(&mut self, cell: usize, start: usize, end: usize) {
        let covered = between(0, start) | between(end, PARTS);
        self.covered[cell] = if covered == 0 { WHOLE } else { covered };
    }

    /// Whether a part of the cell is covered.
    pub fn covers(&self, cell: usize, part: usize) -> bool {
        self.covered[cell] >> part & 1 == 1
    }

    /// Whether only some parts of the cell are covered.
    pub fn is_partial(&self, cell: usize) -> bool {
        self.covered[cell] != WHOLE
    }

    /// Whether all cells are whole.
    pub fn is_whole(&self) -> bool {
        self.covered.iter().all(|covered| *covered == WHOLE)
    }

    /// Covered fraction of the width of a cell.
    pub fn fraction(&self, cell: usize) -> f64 {
        f64::from(self.covered[cell].count_ones()) / PARTS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_covered_between_edges_or_beside_them() {
        let mut coverage = Coverage::whole(4);
        assert!(coverage.is_whole());
        coverage.cover_between(0, 1, PARTS);
        coverage.cover_between(1, 3, 2);
        coverage.cover_beside(2, 1, 3);
        coverage.cover_beside(3, 0, PARTS);
        let covered = |cell: usize| (0..PARTS).map(|part| coverage.covers(cell, part)).collect::<Vec<_>>();
        assert_eq!(covered(0), [false, true, true, true]);
        // At least one part, where both edges fall on the same boundary.
        assert_eq!(covered(1), [false, false, false, true]);
        assert_eq!(covered(2), [true, false, false, true]);
        assert_eq!([0, 1, 2, 3].map(|cell| coverage.fraction(cell)), [0.75, 0.25, 0.5, 1.0]);
        assert_eq!([0, 1, 2, 3].map(|cell| coverage.is_partial(cell)), [true, true, true, false]);
        coverage.make_whole();
        assert_eq!(coverage, Coverage::whole(4));
    }
}
