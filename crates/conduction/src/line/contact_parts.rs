//! Parts of the cells of the contact line that are in contact, and exchange heat.
//!
//! A contact that ends within the zone ends within a cell. The cell is divided into [`PARTS`] parts of equal width, of which
//! whole ones are in contact: heat enters the body through these alone, evenly, and it is their mean temperature that enters the
//! interface law. Fluxes remain per area of the whole cell, so that heat is conserved. With the fraction phi in contact
//!
//! ```text
//! T_1 - T_2 = (q_2 - q_1)/(2 phi h_c)
//! ```
//!
//! with fluxes in W/m2, temperatures in K and h_c in W/(m2 K). A body has the same states whatever parts are in contact; they remember
//! the temperature of the parts that are not. Valid where at most one edge lies between two neighbouring cells.
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

/// Parts in contact of every cell. Cells that do not exchange heat count as whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactParts {
    /// By bits, from the -x edge of the cell to its +x edge; never 0.
    touching: Vec<u8>,
}

impl ContactParts {
    /// Whole cells.
    pub fn whole(count: usize) -> ContactParts {
        ContactParts { touching: vec![WHOLE; count] }
    }

    /// Makes all cells whole.
    pub fn make_whole(&mut self) {
        self.touching.fill(WHOLE);
    }

    /// Takes those of as many other cells.
    pub fn copy_from(&mut self, other: &ContactParts) {
        self.touching.copy_from_slice(&other.touching);
    }

    /// Covers the parts from `start` to `end` of a cell alone, at least one.
    pub fn include_between(&mut self, cell: usize, start: usize, end: usize) {
        let start = start.min(PARTS - 1);
        self.touching[cell] = between(start, end.clamp(start + 1, PARTS));
    }

    /// Covers the parts of a cell before `start` and from `end` on; where these are none, it counts as whole.
    pub fn include_beside(&mut self, cell: usize, start: usize, end: usize) {
        let touching = between(0, start) | between(end, PARTS);
        self.touching[cell] = if touching == 0 { WHOLE } else { touching };
    }

    /// Whether a part of the cell is in contact.
    pub fn includes(&self, cell: usize, part: usize) -> bool {
        self.touching[cell] >> part & 1 == 1
    }

    /// Whether only some parts of the cell are in contact.
    pub fn is_partial(&self, cell: usize) -> bool {
        self.touching[cell] != WHOLE
    }

    /// Whether all cells are whole.
    pub fn is_whole(&self) -> bool {
        self.touching.iter().all(|touching| *touching == WHOLE)
    }

    /// Fraction in contact of the width of a cell.
    pub fn fraction(&self, cell: usize) -> f64 {
        f64::from(self.touching[cell].count_ones()) / PARTS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_in_contact_between_edges_or_beside_them() {
        let mut contact_parts = ContactParts::whole(4);
        assert!(contact_parts.is_whole());
        contact_parts.include_between(0, 1, PARTS);
        contact_parts.include_between(1, 3, 2);
        contact_parts.include_beside(2, 1, 3);
        contact_parts.include_beside(3, 0, PARTS);
        let touching = |cell: usize| (0..PARTS).map(|part| contact_parts.includes(cell, part)).collect::<Vec<_>>();
        assert_eq!(touching(0), [false, true, true, true]);
        // At least one part, where both edges fall on the same boundary.
        assert_eq!(touching(1), [false, false, false, true]);
        assert_eq!(touching(2), [true, false, false, true]);
        assert_eq!([0, 1, 2, 3].map(|cell| contact_parts.fraction(cell)), [0.75, 0.25, 0.5, 1.0]);
        assert_eq!([0, 1, 2, 3].map(|cell| contact_parts.is_partial(cell)), [true, true, true, false]);
        contact_parts.make_whole();
        assert_eq!(contact_parts, ContactParts::whole(4));
    }
}
