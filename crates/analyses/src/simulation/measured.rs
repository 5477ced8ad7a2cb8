//! A measured record beside the simulated one, and how far they are apart.

use super::run::Recording;
use crate::largest;
use anyhow::{Result, bail};
use scene_file::columns::{self, Column, Reading};
use serde::Serialize;
use std::path::Path;

/// A measured quantity and its deviation from the simulated one of the same name, in SI units.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Measured {
    /// Name of the variable.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Measured points within the simulated time: time and value.
    pub points: Vec<(f64, f64)>,
    /// Measured points outside of it.
    pub outside: usize,
    /// Root mean square of simulated less measured values.
    pub root_mean_square: f64,
    /// The largest of them by magnitude, with its sign.
    pub largest: f64,
    /// Time of the largest.
    pub at: f64,
    /// Largest less smallest measured value.
    pub range: f64,
}

impl Measured {
    /// A deviation over the range of the measured values; `None` where they are all the same.
    pub(crate) fn relative(&self, deviation: f64) -> Option<f64> {
        (self.range > 0.0).then(|| deviation / self.range)
    }
}

/// Reads a record: the time, and any inputs and outputs of the FMU.
///
/// # Errors
/// As [`columns::read`]; a file without a quantity.
pub fn read(path: &Path, reading: &Reading) -> Result<columns::Table> {
    check(columns::read(path, &Column::record(), reading)?)
}

/// As [`read`], from the content of a file.
pub fn parse(content: &str, path: &Path, reading: &Reading) -> Result<columns::Table> {
    check(columns::parse(content.as_bytes(), path, &Column::record(), reading)?)
}

fn check(table: columns::Table) -> Result<columns::Table> {
    if table.names.is_empty() {
        let notes: String = table.notes.iter().map(|note| format!("; {note}")).collect();
        bail!(
            "{} has the column time only; accepted beside it are inputs and outputs of the FMU, as wear_depth [um]{notes}",
            table.path.display()
        );
    }
    Ok(table)
}

/// A record without the inputs that were driven from it: one file of a rig has both.
///
/// # Errors
/// Where nothing is left.
pub fn beside(record: &columns::Table, inputs: Option<&columns::Table>) -> Result<columns::Table> {
    let was_driven = |name: &&str| {
        inputs.filter(|inputs| inputs.times == record.times).is_some_and(|inputs| {
            let mut pairs = inputs.column(name).into_iter().flatten().zip(record.column(name).into_iter().flatten());
            inputs.names.iter().any(|own| own == name) && pairs.all(|(given, own)| own.is_nan() || own == given)
        })
    };
    let driven: Vec<&str> = record.names.iter().map(String::as_str).filter(was_driven).collect();
    if driven.len() == record.names.len() {
        bail!("{} has inputs only; compared are outputs of the FMU, as wear_depth [um]", record.path.display());
    }
    Ok(record.without(&driven))
}

/// Deviations of a run from a record, whose times the run is interpolated to linearly.
pub fn compare(table: &columns::Table, recording: &Recording) -> Result<Vec<Measured>> {
    let (first, last) = (recording.times[0], recording.times[recording.times.len() - 1]);
    if !table.times.iter().any(|time| (first..=last).contains(time)) {
        bail!(
            "{}: its times, {} s to {} s, are all outside of the simulated ones, {first} s to {last} s",
            table.path.display(),
            table.times[0],
            table.times[table.times.len() - 1]
        );
    }
    let compared = table.names.iter().filter_map(|name| {
        let (channel, all) = (recording.channel(name)?, table.points(name)?);
        let points: Vec<(f64, f64)> = all.iter().copied().filter(|(time, _)| (first..=last).contains(time)).collect();
        let apart = |&(time, value): &(f64, f64)| (time, interpolated(&recording.times, &channel.values, time) - value);
        let deviations: Vec<(f64, f64)> = points.iter().map(apart).collect();
        let count = points.len() as f64;
        let root_mean_square = (deviations.iter().map(|(_, apart)| apart * apart).sum::<f64>() / count).sqrt();
        let size = largest(deviations.iter().map(|(_, apart)| *apart));
        let (at, largest) = deviations.into_iter().find(|(_, apart)| apart.abs() == size)?;
        let (low, high) = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, value)| (low.min(*value), high.max(*value)));
        Some(Measured {
            name: name.clone(),
            unit: channel.unit,
            outside: all.len() - points.len(),
            points,
            root_mean_square,
            largest,
            at,
            range: high - low,
        })
    });
    Ok(compared.collect())
}

/// Value at `time`, which is within `times`.
fn interpolated(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|own| *own < time);
    if times[after] == time {
        return values[after];
    }
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}
