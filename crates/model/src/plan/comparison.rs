//! One comparison of the lumped level with two contact lines over the nominal course.
//!
//! Theory: docs/theory.md, section 8.2.

use super::ModelLevel;
use super::distance::{Distance, largest};
use super::nominal::{NominalCourse, Run};
use crate::levels::ModelOperators;
use crate::line::operators::{RunIn, Shared};
use scene::{HeatResolution, Scene};

/// Cells of the two lines.
const COMPARED_CELLS: [usize; 2] = [9, 17];

/// Most internal steps of a line, 5 to 10 ms: more than the nominal course takes where cells agree.
const MOST_LINE_STEPS: u32 = 300;

/// Result of a comparison.
#[derive(Clone, PartialEq, Debug)]
pub struct Comparison {
    /// Error of the lumped level: the larger part of it where the coarser line was enough to decide.
    pub error: f64,
    /// Highest speed of the course, m/s.
    pub fastest: f64,
    /// Friction work of the course over the nominal duration, J.
    pub work: f64,
    /// Internal steps of all runs.
    pub steps: u64,
    /// Peak rise of the contact temperature, K.
    pub rise: f64,
}

/// Compares the lumped level of `scene` with contact lines; also returns the operators that were built.
///
/// # Errors
/// The reason for which nothing can be compared.
pub(crate) fn compare(
    scene: &Scene,
    shared: &mut Shared,
    run_in: RunIn,
) -> Result<(Comparison, Vec<ModelOperators>), String> {
    let course = NominalCourse::new(scene)?;
    let mut compared = course.scene(scene);
    // Tolerance of the three runs.
    (compared.tolerance, compared.heat_resolution) = (1e-2, HeatResolution::Resolved);
    let lumped = ModelOperators::new(&ModelLevel::Lumped.apply(&compared), run_in)?;
    let run = course.run(&lumped, MOST_LINE_STEPS)?;
    let mut comparison = Comparison {
        error: 0.0,
        fastest: course.fastest(),
        work: course.repeats * run.work,
        steps: run.steps,
        rise: run.history.iter().map(|main| main[1].abs()).fold(0.0, f64::max),
    };
    let mut operators = vec![lumped];
    let mut coarser: Option<Run> = None;
    for cells in COMPARED_CELLS {
        let line =
            ModelOperators::sharing(&ModelLevel::Line(cells).apply(&compared), operators.first(), shared, run_in)?;
        let line_run = course.run(&line, MOST_LINE_STEPS)?;
        operators.push(line);
        comparison.steps += line_run.steps;
        let from_line = |other: &Run| Distance::of(&line_run.history, &other.history).relative();
        let of_lumped = from_line(&run);
        let of_cells = coarser.as_ref().map_or([0.0; 3], from_line);
        comparison.error = largest(std::array::from_fn(|output| of_lumped[output] + of_cells[output]));
        if comparison.error > scene.tolerance {
            break;
        }
        coarser = Some(line_run);
    }
    Ok((comparison, operators))
}
