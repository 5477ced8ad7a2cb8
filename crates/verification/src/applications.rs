//! Scenes as users build them, with their input trajectories: the test set of `solver.fidelity = auto`.
//!
//! Each family is a scene file, a table with a row of numbers for every scene, and an input trajectory. The numbers are
//! written out: rank-1 lattices over the ranges of data sheets and test benches, rounded, so that no two rows are
//! neighbours. `nominal.*` are typical data-sheet values: some trajectories stay below, some exceed them.
//!
//! Theory: docs/theory.md, section 8.2.

mod blocks;
mod brakes;
pub mod courses;
mod rotating;
pub mod trial;
pub mod variants;

use sliding_contact::component::Values;

use courses::Point;
use scene::variables::{ValueReference, find, reference};

/// Builds an input trajectory from the numbers of a scene, by name.
type Course = fn(&dyn Fn(&str) -> f64) -> Vec<Point>;

/// Scenes of one kind.
struct Family {
    name: &'static str,
    /// Scene file common to all of them.
    file: &'static str,
    /// Names of the columns: variables in their SI units, and parameters of the input trajectory.
    columns: &'static [&'static str],
    rows: &'static [&'static [f64]],
    course: Course,
}

/// A scene with its input trajectory.
#[derive(Clone, Debug)]
pub struct Application {
    /// Family and number in it.
    pub name: String,
    /// Start values; `solver.*` are those of the table.
    pub starts: Box<Values>,
    /// Inputs at the communication points.
    pub course: Vec<Point>,
    /// Other inputs at the communication points.
    pub others: Vec<(ValueReference, Vec<f64>)>,
}

impl Application {
    /// All time-varying inputs at the communication points.
    pub fn inputs(&self) -> Vec<(ValueReference, Vec<f64>)> {
        let column = |at: usize| self.course.iter().map(|point| point[at]).collect();
        let own = [(reference("sliding_velocity"), column(1)), (reference("normal_load"), column(2))];
        own.into_iter().chain(self.others.iter().cloned()).collect()
    }
}

impl Family {
    fn application(&self, row: usize) -> Result<Application, String> {
        let numbers = self.rows[row];
        let name = format!("{}_{}", self.name, row + 1);
        if numbers.len() != self.columns.len() {
            return Err(format!("{name} has {} numbers for {} columns", numbers.len(), self.columns.len()));
        }
        let read = scene_file::parse(self.file).map_err(|problems| format!("{name}: {problems}"))?;
        let mut starts = Box::new(read.packaged.starts);
        for (column, number) in self.columns.iter().zip(numbers) {
            if let Some(reference) = find(column) {
                starts[reference as usize] = *number;
            }
        }
        let of = |wanted: &str| {
            self.columns
                .iter()
                .zip(numbers)
                .find(|(column, _)| **column == wanted)
                .map_or(f64::NAN, |(_, number)| *number)
        };
        Ok(Application { name, starts, course: (self.course)(&of), others: Vec::new() })
    }
}

/// All applications, in a fixed order.
///
/// # Errors
/// An invalid scene file.
pub fn all() -> Result<Vec<Application>, String> {
    let families = [brakes::FAMILIES, blocks::FAMILIES, rotating::FAMILIES].into_iter().flatten();
    families.flat_map(|family| (0..family.rows.len()).map(|row| family.application(row))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;
    use scene::variables::{check_parameter, lookup};

    #[test]
    fn every_application_is_a_legal_scene_with_a_course_of_increasing_times() {
        let [own, variants] = [all().unwrap(), variants::all().unwrap()];
        assert!(own.len() >= 60 && variants.len() >= 60, "{} and {}", own.len(), variants.len());
        for application in own.iter().chain(&variants) {
            let name = &application.name;
            Scene::new(&application.starts, Some(1e-3)).unwrap_or_else(|broken| panic!("{name}: {broken}"));
            let mut before = -1.0;
            for point in &application.course {
                assert!(point.iter().all(|number| number.is_finite()) && point[0] > before, "{name}: {point:?}");
                assert!(point[2] >= 0.0, "{name}: {point:?}");
                before = point[0];
            }
            assert!((12..6000).contains(&application.course.len()), "{name}: {}", application.course.len());
        }
    }

    #[test]
    fn every_number_is_within_the_bounds_of_its_variable_and_every_other_column_belongs_to_a_course() {
        for family in [brakes::FAMILIES, blocks::FAMILIES, rotating::FAMILIES].into_iter().flatten() {
            for (index, column) in family.columns.iter().enumerate() {
                match find(column) {
                    Some(reference) => {
                        assert!(lookup(reference).is_some());
                        for row in family.rows {
                            check_parameter(reference, row[index]).unwrap();
                        }
                    }
                    // A column that no trajectory uses is a mistake in the table.
                    None => {
                        let read = std::cell::Cell::new(false);
                        let (name, numbers) = (family.name, family.rows[0]);
                        let _ = (family.course)(&|wanted| {
                            read.set(read.get() || wanted == *column);
                            let at = family.columns.iter().position(|column| *column == wanted);
                            numbers[at.unwrap_or_else(|| panic!("{name} has no column {wanted}"))]
                        });
                        assert!(read.get(), "{name}: nothing reads {column}");
                    }
                }
            }
        }
    }
}
