//! Quantities among the arguments of a command.

use scene::variables::units::SECOND;
use scene_file::quantity::text;

/// A time, in seconds or with its unit as in "20 ms"; in s.
///
/// # Errors
/// With the units that are accepted.
pub fn time(given: &str) -> Result<f64, String> {
    text(given, &SECOND, true)
}

/// As [`time`], above 0.
///
/// # Errors
/// As [`time`], and where it is not above 0.
pub fn step(given: &str) -> Result<f64, String> {
    match time(given)? {
        step if step > 0.0 => Ok(step),
        step => Err(format!("{step} s must be above 0 s")),
    }
}
