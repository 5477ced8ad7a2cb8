//! Quantities over time from files: columns are known by their names, values come out in SI units.
//!
//! A column's header is the name of a quantity, alone (then in its SI unit), with a unit in brackets
//! (`sliding_velocity [km/h]`) or with a unit spelled behind it (`speed_km_per_h`), or what rigs call it (`Friction force [N]`), found by
//! its words and its unit; [`Reading`] names further ones. Other columns are left out, and named. A first column without a name that
//! numbers the rows is none: pandas writes one, and calls it `Unnamed: 0` when it reads it.
//!
//! An empty cell and NaN are gaps, so channels of different rates stand in one file. Measured values keep their gaps. Inputs are linear over
//! theirs where that invents nothing ([`bridged`]). A time that stands in two rows is a jump.

mod headers;
mod rows;
mod sheet;
#[cfg(test)]
mod tests;

use anyhow::{Context, Result, bail, ensure};
pub use rows::whole;
pub(crate) use rows::{has_candidate, lacks_column, rows};
use scene::message::{Number, Quantity, Quoted, listed};
use scene::variables::units::{ONE, SECOND, Unit};
use scene::variables::{Causality, Kind, Row, TABLE};
pub use sheet::{separator, text};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Name of the column that every file must have.
const TIME: &str = "time";

/// Gap in an input over the usual time between its values up to which it is bridged: one value is missing, or two.
const BRIDGED: f64 = 3.0;

/// Change of an input over a gap, over its largest magnitude, up to which it is bridged whatever its length.
const SAME_VALUE: f64 = 0.02;

/// A column that a file may have beside the time.
#[derive(Clone, Debug)]
pub struct Column {
    /// Name of the quantity.
    pub name: String,
    /// Its SI unit; display units of it are accepted too and converted.
    pub unit: &'static Unit,
    /// Whether units with an offset (degC) are accepted: not for differences of temperatures.
    pub absolute: bool,
    /// Whether the file must have it.
    pub required: bool,
    /// Whether its header must say the unit.
    pub unit_required: bool,
    /// Whether its values are taken; else the column is checked and left out.
    pub taken: bool,
    /// Whether its gaps are kept, as NaN; else they are bridged or refused.
    pub gaps: bool,
}

impl Column {
    /// An optional column, in the SI unit where the header says none.
    pub fn optional(name: &str, unit: &'static Unit) -> Self {
        Self {
            name: name.to_owned(),
            unit,
            absolute: true,
            required: false,
            unit_required: false,
            taken: true,
            gaps: false,
        }
    }

    /// An optional column for a variable of the table, which must say its unit where it has one; `None` where the variable
    /// is an item of an enumeration. A Boolean is 0 or 1.
    pub(crate) fn of(row: &Row) -> Option<Self> {
        let unit = match row.kind {
            Kind::Real { unit, .. } => unit,
            Kind::Integer { .. } | Kind::Boolean => &ONE,
            Kind::Enumeration(_) => return None,
        };
        let (absolute, unit_required) = (!row.is_difference(), unit.name != ONE.name);
        Some(Self { absolute, unit_required, ..Self::optional(row.name, unit) })
    }

    /// The columns of a file of inputs. The record of a run is one, with its outputs left out.
    pub fn inputs() -> Vec<Self> {
        let of = |row: &Row| Some(Self { taken: row.causality == Causality::Input, ..Self::of(row)? });
        TABLE.iter().filter(|row| row.causality == Causality::Input || row.is_result()).filter_map(of).collect()
    }

    /// The columns of a measured record: inputs and outputs, with their gaps.
    pub fn record() -> Vec<Self> {
        let rows = TABLE.iter().filter(|row| row.causality == Causality::Input || row.is_result());
        rows.filter_map(Self::of).map(|column| Self { gaps: true, ..column }).collect()
    }

    /// The column of the numbers of trips, which a file of inputs may have beside [`Column::inputs`].
    pub fn trip() -> Self {
        Self::optional("trip", &ONE)
    }
}

/// What is meant by headers, and whether those that mean nothing are refused.
#[derive(Clone, Default, Debug)]
pub struct Reading {
    /// Columns named by the user.
    pub columns: Vec<Named>,
    /// Whether a column that is not known is refused; else it is left out and named.
    pub strict: bool,
    /// Whether messages name the argument of Python instead of the option of the command line.
    pub python: bool,
}

/// A column named by the user, as `COF=friction_coefficient`.
#[derive(Clone, PartialEq, Debug)]
pub struct Named {
    /// Its header, with or without the unit.
    header: String,
    /// Its quantity, with a unit if the header has another one or none; empty: the column is left out.
    quantity: String,
}

impl std::fmt::Display for Named {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.header, self.quantity)
    }
}

impl std::str::FromStr for Named {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (header, quantity) =
            text.rsplit_once('=').ok_or("must be HEADER=VARIABLE, as \"COF=friction_coefficient\"")?;
        Ok(Self { header: header.trim().to_owned(), quantity: quantity.trim().to_owned() })
    }
}

impl Reading {
    /// Refuses what is not known.
    pub fn strict() -> Self {
        Self { strict: true, ..Self::default() }
    }

    /// How a user names a column, and how he leaves it out.
    fn spelled(&self) -> [&'static str; 2] {
        match self.python {
            false => ["--column \"HEADER=VARIABLE\"", "\"HEADER=\""],
            true => ["columns={\"HEADER\": \"VARIABLE\"}", "\"HEADER\": \"\""],
        }
    }

    /// How a user names this column.
    fn naming(&self, header: &str, quantity: &str) -> String {
        let spelled = self.spelled()[0];
        spelled.replacen("HEADER", header, 1).replacen("VARIABLE", quantity, 1)
    }

    /// What a header is read as.
    fn renamed(&self, header: &str) -> Option<String> {
        let (name, symbol) = headers::split(header);
        let named = self.columns.iter().find(|named| [header, name].contains(&named.header.as_str()))?;
        let has_unit = headers::split(&named.quantity).1.is_some();
        let unit = symbol.filter(|_| !has_unit && !named.quantity.is_empty());
        Some(unit.map_or(named.quantity.clone(), |unit| format!("{} [{unit}]", named.quantity)))
    }

    /// Whether every named column is in one of the tables with these headers.
    ///
    /// # Errors
    /// With the first that is not.
    pub fn check(&self, tables: &[&[String]]) -> Result<()> {
        let has = |named: &Named, header: &str| [header, headers::split(header).0].contains(&named.header.as_str());
        let missing = |named: &&Named| !tables.iter().any(|headers| headers.iter().any(|own| has(named, own)));
        if let Some(Named { header, quantity }) = self.columns.iter().find(missing) {
            let found = tables.iter().flat_map(|headers| headers.iter().map(String::as_str));
            let place = if self.python { "columns".to_owned() } else { format!("--column {header}={quantity}") };
            bail!("{place}: there is no column {}; found are {}", Quoted(header), listed(found));
        }
        Ok(())
    }
}

/// Quantities over time, in SI units.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// The file.
    pub path: PathBuf,
    /// Time of every row, s, increasing; the same in two rows where values jump.
    pub times: Vec<f64>,
    /// Quantities, in the order of the file, without the time.
    pub names: Vec<String>,
    /// Row by row, `names.len()` values each.
    pub values: Vec<f64>,
    /// Line of the file that every row stands in.
    pub lines: Vec<u64>,
    /// Known quantities of the file that are not taken.
    pub left_out: Vec<String>,
    /// Headers of the file.
    pub headers: Vec<String>,
    /// What was made of headers that are no names of quantities, a line each.
    pub notes: Vec<String>,
}

impl Table {
    /// The values of a quantity, where the file has it.
    pub fn column(&self, name: &str) -> Option<impl Iterator<Item = f64>> {
        let at = self.names.iter().position(|own| own == name)?;
        Some(self.values.iter().skip(at).step_by(self.names.len()).copied())
    }

    /// Times and values of a measured quantity, where the file has it: without gaps, and of a time in two rows the first alone, as a run has
    /// at that time the value before the jump.
    pub fn points(&self, name: &str) -> Option<Vec<(f64, f64)>> {
        let is_behind_jump = |row: usize| row > 0 && self.times[row] == self.times[row - 1];
        let points = self.times.iter().copied().zip(self.column(name)?).enumerate();
        Some(
            points.filter(|(row, (_, value))| value.is_finite() && !is_behind_jump(*row)).map(|(_, own)| own).collect(),
        )
    }

    /// Without the columns of these names.
    pub fn without(&self, names: &[&str]) -> Self {
        let kept: Vec<usize> = (0..self.names.len()).filter(|at| !names.contains(&self.names[*at].as_str())).collect();
        let row = |row: usize| kept.iter().map(move |at| self.values[row * self.names.len() + at]);
        Self {
            names: kept.iter().map(|at| self.names[*at].clone()).collect(),
            values: (0..self.times.len()).flat_map(row).collect(),
            ..self.clone()
        }
    }
}

/// Reads a file with the time and some of the `accepted` quantities.
///
/// # Errors
/// Names file, line, column and value: where the file cannot be read, has no row, a required column is missing, a column
/// stands twice, is a known one mistyped, or has a unit that does not fit, a cell that is no finite number, a time that decreases or
/// stands in more than two rows, or a gap in an input that is not to be bridged.
pub fn read(path: &Path, accepted: &[Column], reading: &Reading) -> Result<Table> {
    parse(open(path)?, path, accepted, reading)
}

/// A file to be read.
///
/// # Errors
/// Where there is none, or a folder.
pub fn open(path: &Path) -> Result<File> {
    ensure!(!path.is_dir(), "{} is a folder; a CSV file is needed", path.display());
    File::open(path).with_context(|| format!("reading {}", path.display()))
}

/// Reads the content of a file; `path` names it in messages.
pub fn parse(content: impl Read, path: &Path, accepted: &[Column], reading: &Reading) -> Result<Table> {
    let time = Column { required: true, ..Column::optional(TIME, &SECOND) };
    let known: Vec<&Column> = std::iter::once(&time).chain(accepted).collect();
    let (mut times, mut values, mut lines) = (Vec::<f64>::new(), Vec::new(), Vec::new());
    let read = rows(content, path, &known, reading, &mut |cells| {
        for cell in cells {
            if cell.name != TIME {
                values.push(cell.value);
                continue;
            }
            let (now, count) = (cell.value, times.len());
            if now.is_nan() {
                bail!("{} is no number, and every row needs a time", cell.place());
            }
            if let Some(last) = times.last().filter(|last| now < **last) {
                bail!("{}: the time must not decrease, and was {last} s in the row before", cell.place());
            }
            if count > 1 && times[count - 2] == now {
                bail!("{}: a time may stand in two rows, for a jump, and this one stands in more", cell.place());
            }
            times.push(now);
        }
        lines.extend(cells.first().map(|cell| cell.line));
        Ok(())
    })?;
    let names: Vec<String> = read.taken.into_iter().filter(|name| name != TIME).collect();
    let mut table = Table {
        path: path.to_owned(),
        times,
        names,
        values,
        lines,
        left_out: read.left_out,
        headers: read.headers,
        notes: read.notes,
    };
    for at in 0..table.names.len() {
        if let Some(column) = known.iter().find(|column| column.name == table.names[at] && !column.gaps) {
            for (row, value) in bridged(&table, at, column)? {
                let place = row * table.names.len() + at;
                table.values[place] = value;
            }
        }
    }
    Ok(table)
}

/// The values in the gaps of an input, by row: linear, at the ends the one beside them, where that invents nothing. The gap lasts up to
/// [`BRIDGED`] times the median time between its values, as in a slower channel and where single values are lost, or the input is the same
/// on both sides, within [`SAME_VALUE`] of its largest magnitude.
fn bridged(table: &Table, at: usize, column: &Column) -> Result<Vec<(usize, f64)>> {
    let Table { path, times, lines, names, values, .. } = table;
    let (file, name) = (path.display(), &column.name);
    let value = |row: usize| values[row * names.len() + at];
    let given: Vec<usize> = (0..times.len()).filter(|row| value(*row).is_finite()).collect();
    let (Some(&first), Some(&last)) = (given.first(), given.last()) else {
        bail!("{file}: the column {name} has no value");
    };
    let mut apart: Vec<f64> = given.windows(2).map(|pair| times[pair[1]] - times[pair[0]]).collect();
    apart.sort_unstable_by(f64::total_cmp);
    let usual = apart.get(apart.len() / 2).copied().unwrap_or(0.0);
    let largest = given.iter().map(|row| value(*row).abs()).fold(0.0, f64::max);
    let check = |from: usize, to: usize, change: f64, how: &str| {
        let length = times[to] - times[from];
        if length <= BRIDGED * usual || change <= SAME_VALUE * largest {
            return Ok(());
        }
        let [length, usual] = [length, usual].map(Number);
        bail!(
            "{file}, lines {} to {}: {name} has no value for {length} s {how}, and its values are {usual} s apart; an input is not \
             bridged over such a gap: fill it, or cut the file there",
            lines[from],
            lines[to]
        )
    };
    let end = times.len() - 1;
    check(0, first, f64::INFINITY, "at the beginning")?;
    check(last, end, f64::INFINITY, "at the end")?;
    let mut filled: Vec<(usize, f64)> = (0..first).map(|row| (row, value(first))).collect();
    filled.extend((last + 1..=end).map(|row| (row, value(last))));
    for pair in given.windows(2).filter(|pair| pair[1] - pair[0] > 1) {
        let (from, to) = (pair[0], pair[1]);
        let (before, after) = (value(from), value(to));
        let [shown, changed] = [before, after].map(|value| Quantity(value, column.unit.name));
        check(from, to, (after - before).abs(), &format!("from {shown} to {changed}"))?;
        let part = |row: usize| (times[row] - times[from]) / (times[to] - times[from]);
        filled.extend((from + 1..to).map(|row| (row, before + part(row) * (after - before))));
    }
    Ok(filled)
}
