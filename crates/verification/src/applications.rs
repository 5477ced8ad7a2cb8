//! Scenes as users build them, with the inputs that they are driven with: what `solver.fidelity = auto` is judged by.
//!
//! Each family is a scene file, a table with a row of numbers for every scene, and a course of the inputs. The numbers are written
//! out: rank-1 lattices over what data sheets and test benches have, rounded, so that no two rows are neighbours. `nominal.*` are
//! what somebody would take from a data sheet: some courses stay below, some go beyond.

mod blocks;
mod brakes;
pub mod courses;
mod rotating;
pub mod trial;

use sliding_contact::component::Values;

use courses::Point;
use scene::variables::{ValueReference, find, reference};

/// Makes a course of the numbers of a scene, asked for by name.
type Course = fn(&dyn Fn(&str) -> f64) -> Vec<Point>;

/// Scenes of one kind.
struct Family {
    name: &'static str,
    /// Scene file with what all of them share.
    file: &'static str,
    /// Names of the columns: variables in their SI units, and what the course is made of.
    columns: &'static [&'static str],
    rows: &'static [&'static [f64]],
    course: Course,
}

/// A scene with its inputs.
#[derive(Clone, Debug)]
pub struct Application {
    /// Family and number in it.
    pub name: String,
    /// Start values; `solver.*` are those of the table.
    pub starts: Box<Values>,
    /// Inputs at the communication points.
    pub course: Vec<Point>,
    /// Other inputs there.
    pub others: Vec<(ValueReference, Vec<f64>)>,
}

impl Application {
    /// Every input that changes, at the communication points.
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

/// All of them, in a fixed order.
///
/// # Errors
/// What is wrong with a scene file.
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
        let all = all().unwrap();
        assert!(all.len() >= 60, "{}", all.len());
        for application in &all {
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
                    // What no course reads would be a slip of the pen.
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
