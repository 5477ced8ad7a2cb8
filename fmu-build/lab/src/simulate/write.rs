//! Files of a run: every variable over the time, and the profiles.

use analyses::simulation::Recording;
use anyhow::{Context, Result};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Writes inputs and outputs, in SI units, numbers as the shortest texts that are read back as the same.
pub(crate) fn courses(path: &Path, recording: &Recording) -> Result<()> {
    let headers = recording.channels.iter().map(|channel| format!("{} [{}]", channel.name, channel.unit));
    let header: Vec<String> = std::iter::once("time [s]".to_owned()).chain(headers).collect();
    let rows = recording.times.iter().enumerate().map(|(row, time)| {
        let values = recording.channels.iter().map(move |channel| channel.values[row]);
        std::iter::once(*time).chain(values)
    });
    table(path, &header, rows)
}

/// File of the profiles beside that of the variables.
pub(crate) fn beside(path: &Path) -> PathBuf {
    path.with_extension("profiles.csv")
}

/// Writes the profiles, a row for every station and time.
pub(crate) fn profiles(path: &Path, recording: &Recording) -> Result<()> {
    let header = [
        "time [s]",
        "profile.x [m]",
        "profile.pressure [Pa]",
        "profile.temperature [K]",
        "profile.wear_punch [m]",
        "profile.wear_strip [m]",
    ];
    let rows = recording.profiles.iter().flat_map(|own| {
        (0..own.x.len()).map(move |at| {
            [own.time, own.x[at], own.pressure[at], own.temperature[at], own.worn[0][at], own.worn[1][at]].into_iter()
        })
    });
    table(path, &header.map(str::to_owned), rows)
}

fn table<R: Iterator<Item = f64>>(path: &Path, header: &[String], rows: impl Iterator<Item = R>) -> Result<()> {
    let context = || format!("writing {}", path.display());
    let mut file = BufWriter::new(File::create(path).with_context(context)?);
    let mut line = header.join(",");
    line.push('\n');
    file.write_all(line.as_bytes()).with_context(context)?;
    for row in rows {
        line.clear();
        for (at, value) in row.enumerate() {
            let separator = if at == 0 { "" } else { "," };
            write!(line, "{separator}{value:?}")?;
        }
        line.push('\n');
        file.write_all(line.as_bytes()).with_context(context)?;
    }
    file.flush().with_context(context)
}
