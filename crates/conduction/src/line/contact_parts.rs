//! Parts of the cells of the contact line that are in contact, and exchange heat.
//!
//! A contact that ends within the zone ends within a cell. The cell is divided into [`PARTS`] parts of equal width. Heat enters the body
//! through every part in proportion to its fraction in contact, evenly within the part, and the temperatures of the parts enter the
//! interface law by the same weights. Fluxes remain per area of the whole cell, so that heat is conserved. With the fraction phi of the
//! cell in contact
//!
//! ```text
//! T_1 - T_2 = (q_2 - q_1)/(2 phi h_c)
//! ```
//!
//! with fluxes in W/m2, temperatures in K and h_c in W/(m2 K). A body has the same states whatever parts are in contact; they remember
//! the temperature of the parts that are not.
//!
//! Theory: docs/theory.md, section 6.5.

use numerics::leading_bits;
use numerics::maximum::maximum;

/// Number of parts of a cell.
pub const PARTS: usize = 4;

/// Least fraction in contact of one part of a cell in contact, with which heat enters a width that does not vanish.
const LEAST_FRACTION: f64 = 1.0 / 16.0;

/// All of every part.
const WHOLE: [f64; PARTS] = [1.0; PARTS];

/// Parts in contact of every cell. Cells that do not exchange heat count as whole.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactParts {
    /// From the -x edge of the cell to its +x edge; not all 0.
    fractions: Vec<[f64; PARTS]>,
    /// Number of cells that are not whole.
    partial: usize,
}

impl ContactParts {
    /// Whole cells.
    pub fn whole(count: usize) -> ContactParts {
        ContactParts { fractions: vec![WHOLE; count], partial: 0 }
    }

    /// Makes all cells whole.
    pub fn make_whole(&mut self) {
        self.fractions.fill(WHOLE);
        self.partial = 0;
    }

    /// Takes those of as many other cells.
    pub fn copy_from(&mut self, other: &ContactParts) {
        self.fractions.copy_from_slice(&other.fractions);
        self.partial = other.partial;
    }

    /// Takes those of as many other cells, every fraction as the power of two that is next below.
    pub fn round(&mut self, other: &ContactParts) {
        for (own, other) in self.fractions.iter_mut().zip(&other.fractions) {
            *own = other.map(|fraction| leading_bits(fraction, 0));
        }
        self.partial = other.partial;
    }

    /// Sets the fractions in contact of the parts of a cell; a cell without contact counts as whole, the part of the most contact as at
    /// least [`LEAST_FRACTION`] in contact.
    pub fn set(&mut self, cell: usize, fractions: [f64; PARTS]) {
        let most = fractions.iter().copied().fold(0.0, maximum);
        let raised = |fraction: f64| if fraction == most { maximum(fraction, LEAST_FRACTION) } else { fraction };
        self.partial -= usize::from(self.is_partial(cell));
        self.fractions[cell] = if most == 0.0 { WHOLE } else { fractions.map(raised) };
        self.partial += usize::from(self.is_partial(cell));
    }

    /// Fraction in contact of a part of the cell.
    pub(crate) fn of_part(&self, cell: usize, part: usize) -> f64 {
        self.fractions[cell][part]
    }

    /// Whether only some parts of the cell are in contact.
    pub fn is_partial(&self, cell: usize) -> bool {
        self.fractions[cell] != WHOLE
    }

    /// Whether all cells are whole.
    pub fn is_whole(&self) -> bool {
        self.partial == 0
    }

    /// Fraction in contact of the width of a cell.
    pub fn fraction(&self, cell: usize) -> f64 {
        self.fractions[cell].iter().sum::<f64>() / PARTS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_stored_by_part_and_a_cell_without_contact_counts_as_whole() {
        let mut contact_parts = ContactParts::whole(4);
        assert!(contact_parts.is_whole());
        contact_parts.set(0, [0.0, 0.25, 1.0, 1.0]);
        contact_parts.set(1, [0.02, 0.0, 0.0, 0.0]);
        contact_parts.set(2, [1.0, 0.0, 0.0, 0.47]);
        contact_parts.set(3, [1.0, 0.98, 1.0, 1.0]);
        let of_parts = |cell: usize| [0, 1, 2, 3].map(|part| contact_parts.of_part(cell, part));
        assert_eq!([0, 2].map(of_parts), [[0.0, 0.25, 1.0, 1.0], [1.0, 0.0, 0.0, 0.47]]);
        assert_eq!([0, 1, 2, 3].map(|cell| contact_parts.fraction(cell)), [0.5625, 1.0 / 64.0, 0.3675, 0.995]);
        contact_parts.set(0, [0.0; PARTS]);
        assert_eq!(contact_parts.fraction(0), 1.0);
        contact_parts.set(0, [0.0, 0.25, 1.0, 1.0]);
        contact_parts.set(2, [1.0; PARTS]);
        assert_eq!([0, 1, 2, 3].map(|cell| contact_parts.is_partial(cell)), [true, true, false, true]);
        let mut rounded = ContactParts::whole(4);
        rounded.round(&contact_parts);
        assert_eq!([0, 1, 2, 3].map(|cell| rounded.fraction(cell)), [0.5625, 1.0 / 64.0, 1.0, 0.875]);
        contact_parts.make_whole();
        assert_eq!(contact_parts, ContactParts::whole(4));
    }
}
