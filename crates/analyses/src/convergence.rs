//! What a number on the cells of a contact line deserves: the same number on half the cells beside it.

use scene::message::Number;

/// Part of the reference (a temperature's rise) by which both numbers may differ where the finer one counts as converged.
const CONVERGED: f64 = 1e-2;

/// A number on the cells of a contact line, and on half of them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Convergence {
    /// On `cells` cells.
    pub value: f64,
    /// Cells of the contact line.
    pub cells: usize,
    /// On `coarser_cells`; NaN where there is none.
    pub coarser: f64,
    /// About half of them.
    pub coarser_cells: usize,
}

/// Half of the cells: 65, 33, 17, 9.
pub(crate) fn half(cells: usize) -> usize {
    cells / 2 + cells % 2
}

impl Convergence {
    fn is_reached(&self, scale: f64) -> bool {
        (self.value - self.coarser).abs() <= CONVERGED * scale.abs()
    }

    /// Both numbers less `offset`, with the decimals that their difference supports.
    pub fn text(&self, offset: f64, scale: f64) -> String {
        let difference = (self.value - self.coarser).abs();
        let text = |value: f64| rounded(value - offset, difference);
        if !difference.is_finite() {
            return format!("{} (none on {} cells)", rounded(self.value - offset, 0.0), self.coarser_cells);
        }
        let state = if self.is_reached(scale) { "" } else { ", not converged" };
        format!("{} ({} cells: {}{state})", text(self.value), self.coarser_cells, text(self.coarser))
    }

    /// A warning that `name` (in `unit`, less `offset`) is not converged.
    pub(crate) fn warning(&self, name: &str, unit: &str, offset: f64, scale: f64) -> Option<String> {
        let [value, coarser] = [self.value, self.coarser].map(|value| rounded(value - offset, 0.1 * CONVERGED * scale));
        (!self.is_reached(scale)).then(|| match self.coarser.is_finite() {
            true => format!(
                "{name} is not converged: {value} {unit} on {} cells, {coarser} {unit} on {}; more cells tell",
                self.cells, self.coarser_cells
            ),
            false => format!(
                "{name} may not be converged: {value} {unit} on {} cells, no such state on {}",
                self.cells, self.coarser_cells
            ),
        })
    }
}

/// A number without the decimals below a difference; four decimals at most.
fn rounded(value: f64, difference: f64) -> String {
    let decimals = if difference > 0.0 { (-difference.log10().floor()).clamp(0.0, 4.0) } else { 4.0 };
    match value.is_finite() {
        true => format!("{value:.*}", decimals as usize),
        false => Number(value).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_the_digits_that_its_difference_to_half_the_cells_leaves() {
        let of = |value: f64, coarser: f64| Convergence { value, cells: 65, coarser, coarser_cells: half(65) };
        assert_eq!(of(315.5854, 315.5723).text(273.15, 20.0), "42.44 (33 cells: 42.42)");
        assert_eq!(of(315.5854, 315.5723).warning("T", "degC", 273.15, 20.0), None);
        assert_eq!(of(498.15, 568.15).text(273.15, 200.0), "225 (33 cells: 295, not converged)");
        let warning = of(498.15, 568.15).warning("T", "degC", 273.15, 200.0).unwrap();
        assert!(warning.contains("225.0 degC on 65 cells, 295.0 degC on 33"), "{warning}");
        assert_eq!(of(2.0, 2.0).text(0.0, 1.0), "2.0000 (33 cells: 2.0000)");
        assert!(!of(2.0, f64::NAN).is_reached(1.0) && of(2.0, f64::NAN).text(0.0, 1.0).contains("none on 33"));
    }

    #[test]
    fn half_the_cells_are_those_of_every_other_edge() {
        assert_eq!([129, 65, 33, 17, 9, 5].map(half), [65, 33, 17, 9, 5, 3]);
    }
}
