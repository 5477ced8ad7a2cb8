//! Numbers and quantities among the arguments of a command.

use scene::variables::units::SECOND;
use scene_file::columns::{Named, Reading};
use scene_file::quantity::text;
use std::ops::RangeInclusive;

/// How the columns of files are read.
#[derive(clap::Args, Clone, Debug)]
pub struct Columns {
    /// Read a column as a variable, as "COF=friction_coefficient" or "Load=normal_load [N]"; without a variable it is left out. May be
    /// repeated.
    #[arg(long, value_name = "HEADER=VARIABLE", value_parser = str::parse::<Named>)]
    column: Vec<Named>,
    /// Refuse files with columns that are no known quantity, instead of leaving these out.
    #[arg(long)]
    strict: bool,
}

impl Columns {
    /// What a file is read with.
    pub fn reading(&self) -> Reading {
        Reading { columns: self.column.clone(), strict: self.strict, python: false }
    }

    /// The options again, for a script.
    pub(crate) fn options(&self) -> impl Iterator<Item = String> {
        let columns = self.column.iter().map(|named| format!("--column={named}"));
        columns.chain(self.strict.then(|| "--strict".to_owned()))
    }
}

/// A number.
pub fn number(given: &str) -> Result<f64, String> {
    given.trim().parse().map_err(|_| match given.contains(',') {
        true => "numbers have a decimal point".to_owned(),
        false => "must be a number".to_owned(),
    })
}

/// A parser of whole numbers in a range.
pub fn whole<T: TryFrom<u64> + Send + Sync + 'static>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |given| {
        let value = given.trim().parse().ok().filter(|value| range.contains(value));
        value.and_then(|value| T::try_from(value).ok()).ok_or_else(|| {
            let least = range.start();
            match *range.end() {
                u64::MAX => format!("must be a whole number from {least} on"),
                most => format!("must be a whole number from {least} to {most}"),
            }
        })
    }
}

/// A time, in seconds or with its unit as in "20 ms"; in s.
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
