//! One comparison of the lumped level with two contact lines over the nominal course.
//!
//! Theory: docs/theory.md, section 8.2.

use super::ModelLevel;
use super::distance::{Distance, Main, largest};
use super::nominal::NominalCourse;
use crate::levels::ModelOperators;
use crate::line::operators::{RunIn, Shared};
use numerics::maximum::maximum;
use scene::{HeatResolution, Scene};

/// Cells of the two lines.
const COMPARED_CELLS: [usize; 2] = [9, 17];

/// Most internal steps of a line, 10 to 60 ms: more than the nominal course takes where cells agree.
const MOST_LINE_STEPS: u32 = 200;

/// Result of a comparison.
#[derive(Clone, PartialEq, Debug)]
pub struct Comparison {
    /// Error of the lumped level: what it is at least where a part of the lines was enough to decide.
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

/// Compares the lumped level of `scene` with contact lines; the operators that it builds join those `known`.
///
/// # Errors
/// The reason for which nothing can be compared.
pub(crate) fn compare(
    scene: &Scene,
    known: &mut Vec<ModelOperators>,
    shared: &mut Shared,
    run_in: RunIn,
) -> Result<Comparison, String> {
    let course = NominalCourse::new(scene)?;
    let mut compared = course.scene(scene);
    // Tolerance of the three runs.
    (compared.tolerance, compared.heat_resolution) = (1e-2, HeatResolution::Resolved);
    let lumped = ModelOperators::new(&ModelLevel::Lumped.apply(&compared), run_in)?;
    known.push(lumped.clone());
    let run = course.run(&lumped, MOST_LINE_STEPS, |_, _| false)?;
    let mut comparison = Comparison {
        error: 0.0,
        fastest: course.fastest(),
        work: course.repeats * run.work,
        steps: run.steps,
        rise: run.history.iter().map(|main| main[1].abs()).fold(0.0, f64::max),
    };
    // Runs that a line is compared with, and the largest values of each.
    let mut others = vec![(highest(&run.history), run.history)];
    for cells in COMPARED_CELLS {
        let compared = ModelLevel::Line(cells).apply(&compared);
        let line = ModelOperators::sharing(&compared, Some(&lumped), shared, run_in)?;
        known.push(line.clone());
        let mut distances = vec![Distance::default(); others.len()];
        let sum = |parts: Vec<Main>| largest(std::array::from_fn(|output| parts.iter().map(|part| part[output]).sum()));
        let run = course.run(&line, MOST_LINE_STEPS, |segment, main| {
            let others = distances.iter_mut().zip(&others);
            let parts = others.map(|(distance, (highest, history))| {
                distance.follow(*main, history[segment]);
                distance.at_least(highest)
            });
            comparison.error = sum(parts.collect());
            comparison.error > scene.tolerance
        })?;
        comparison.steps += run.steps;
        if comparison.error <= scene.tolerance {
            comparison.error = sum(distances.iter().map(Distance::relative).collect());
        }
        if comparison.error > scene.tolerance {
            break;
        }
        others.push((highest(&run.history), run.history));
    }
    Ok(comparison)
}

/// Largest magnitude of each output.
fn highest(history: &[Main]) -> Main {
    std::array::from_fn(|output| history.iter().map(|main| main[output].abs()).fold(0.0, maximum))
}
