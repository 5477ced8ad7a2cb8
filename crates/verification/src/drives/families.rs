//! Settings compared in a chart, one parameter varied at a time.

use super::{DriveProblem, Setting};
use scene::Fidelity;

/// Settings that differ in one parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct Family {
    /// Name in the legend.
    pub name: &'static str,
    /// Varied parameter, and the common values of the others.
    pub varied: &'static str,
    /// From coarse to fine.
    pub settings: Vec<Setting>,
}

/// Families of recorded charts whose methods are no part of the component any more: explicit wear, the operator split of contact
/// and heat, and the punch in unreduced finite elements.
pub const FORMER: [&str; 3] = ["explicit", "staggered", "field"];

/// Tolerance of a family with another varied parameter.
const TIGHT: f64 = 1e-4;
/// Number of cells of a family with another varied parameter.
const CELLS: usize = 33;

impl DriveProblem {
    /// Compared settings: every level; tolerances, cells, orders of the inputs and communication steps. `quick`:
    /// the coarser half of each.
    pub fn families(&self, quick: bool) -> Vec<Family> {
        let setting =
            Setting { fidelity: Fidelity::Line, tolerance: TIGHT, cells: CELLS, step: self.step, order: 1, heat: true };
        let kept = |count: usize| if quick { count.div_ceil(2) } else { count };
        let tolerances = |fidelity: Fidelity, cells: usize, exponents: &[i32]| {
            let with = |&exponent: &i32| Setting { fidelity, cells, tolerance: 10f64.powi(exponent), ..setting };
            exponents[..kept(exponents.len())].iter().map(with).collect()
        };
        let steps = |like: Setting| {
            let with = |&step: &f64| Setting { step, ..like };
            self.steps[..kept(self.steps.len())].iter().map(with).collect()
        };
        let by_cells = |tolerance: f64, cells: &[usize]| {
            let with = |&cells: &usize| Setting { cells, tolerance, ..setting };
            cells[..kept(cells.len())].iter().map(with).collect()
        };
        let fine = [17, 25, 33, 49, 65];
        // Cells and tolerance are varied together, with balanced errors.
        let pairs: [(usize, i32); 9] =
            [(5, -1), (9, -2), (13, -2), (17, -2), (21, -2), (33, -3), (49, -3), (65, -4), (97, -4)];
        let isothermal = pairs[..kept(pairs.len())].iter().map(|&(cells, exponent)| Setting {
            cells,
            tolerance: 10f64.powi(exponent),
            step: f64::INFINITY,
            order: 0,
            heat: false,
            ..setting
        });
        let isothermal = Family {
            name: "line, isothermal",
            varied: "5 to 97 cells at tolerances from 1e-1 to 1e-4, heat switched off, steps from sample to sample",
            settings: isothermal.collect(),
        };
        let mut families = vec![
            Family { name: "auto", varied: "tolerance", settings: tolerances(Fidelity::Auto, 0, &[-1, -2, -3, -4]) },
            Family {
                name: "lumped",
                varied: "tolerance",
                settings: tolerances(Fidelity::Lumped, 0, &[-1, -2, -3, -4, -5]),
            },
            Family {
                name: "lumped, inputs held",
                varied: "communication step at tolerance 1e-4",
                settings: steps(Setting { fidelity: Fidelity::Lumped, cells: 0, order: 0, ..setting }),
            },
            Family {
                name: "line, tolerance",
                varied: "tolerance at 33 cells",
                settings: tolerances(Fidelity::Line, CELLS, &[-1, -2, -3, -4]),
            },
            Family {
                name: "line, cells",
                varied: "9 to 65 cells at tolerance 1e-4",
                settings: by_cells(TIGHT, &[9, 17, 25, 33, 49, 65]),
            },
            Family {
                name: "line, cells, 1e-3",
                varied: "17 to 65 cells at tolerance 1e-3",
                settings: by_cells(1e-3, &fine),
            },
            Family {
                name: "line, cells, 1e-2",
                varied: "17 to 65 cells at tolerance 1e-2",
                settings: by_cells(1e-2, &fine),
            },
            Family {
                name: "line, inputs held",
                varied: "communication step at 33 cells, tolerance 1e-4",
                settings: steps(Setting { order: 0, ..setting }),
            },
        ];
        if self.isothermal {
            families.push(isothermal);
        }
        families
    }
}
