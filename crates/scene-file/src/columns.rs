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
mod sheet;

use crate::quantity;
use anyhow::{Context, Result, anyhow, bail, ensure};
use headers::{Match, alternatives};
use scene::message::{Clipped, Number, Quantity, Quoted, listed};
use scene::variables::units::{ONE, SECOND, Unit};
use scene::variables::{Causality, Kind, Row, TABLE};
use sheet::Sheet;
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
    pub fn of(row: &Row) -> Option<Self> {
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

    /// What a header is read as.
    fn renamed(&self, header: &str) -> Option<String> {
        let (name, symbol) = headers::split(header);
        let named = self.columns.iter().find(|named| [header, name].contains(&named.header.as_str()))?;
        let has_unit = headers::split(&named.quantity).1.is_some();
        let unit = symbol.filter(|_| !has_unit && !named.quantity.is_empty());
        Some(unit.map_or(named.quantity.clone(), |unit| format!("{} [{unit}]", named.quantity)))
    }

    /// Whether every named column is in one of the tables.
    ///
    /// # Errors
    /// With the first that is not.
    pub fn check(&self, tables: &[&Table]) -> Result<()> {
        let has = |named: &Named, header: &str| [header, headers::split(header).0].contains(&named.header.as_str());
        let missing = |named: &&Named| !tables.iter().any(|table| table.headers.iter().any(|own| has(named, own)));
        if let Some(Named { header, quantity }) = self.columns.iter().find(missing) {
            let found = tables.iter().flat_map(|table| table.headers.iter().map(String::as_str));
            let place =
                if self.python { "columns".to_owned() } else { format!("--column {header}={quantity}") };
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
///
/// # Errors
/// As [`read`].
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
///
/// # Errors
/// Where there is no value at all; another gap, with its lines.
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

/// Whether a cell says that there is no value.
fn is_gap(text: &str) -> bool {
    ["", "nan", "na", "n/a", "#n/a", "<na>", "null", "none", "-", "--"].iter().any(|gap| text.eq_ignore_ascii_case(gap))
}

/// A cell of a row.
pub(crate) struct Cell<'a> {
    /// Name of its quantity.
    pub(crate) name: &'a str,
    /// Its value in the SI unit; NaN of a gap.
    pub(crate) value: f64,
    path: &'a Path,
    line: u64,
    column: usize,
    header: &'a str,
    text: &'a str,
}

impl Cell<'_> {
    /// Where it stands and what it says, for messages.
    pub(crate) fn place(&self) -> String {
        let Self { path, line, column, header, text, .. } = self;
        format!("{}, line {line}, column {column} ({}): {}", path.display(), Clipped(header), Quoted(text))
    }
}

/// A required column that a file lacks, and whether another one has its unit.
#[derive(Debug)]
struct MissingColumn {
    text: String,
    has_candidate: bool,
}

impl std::fmt::Display for MissingColumn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for MissingColumn {}

/// Whether a file was refused because it lacks a required column, as a table without times is by [`Column::record`].
pub(crate) fn lacks_column(error: &anyhow::Error) -> bool {
    error.is::<MissingColumn>()
}

/// Whether a file that was refused for that has a column of that unit.
pub(crate) fn has_candidate(error: &anyhow::Error) -> bool {
    error.downcast_ref::<MissingColumn>().is_some_and(|missing| missing.has_candidate)
}

/// Quantities of a file, in its order.
pub(crate) struct Quantities {
    pub(crate) taken: Vec<String>,
    pub(crate) left_out: Vec<String>,
    pub(crate) headers: Vec<String>,
    pub(crate) notes: Vec<String>,
}

/// Gives the rows of a file of `known` quantities to `take`, one after the other; returns what its columns are.
///
/// # Errors
/// As [`read`], and those of `take`.
pub(crate) fn rows(
    mut content: impl Read,
    path: &Path,
    known: &[&Column],
    reading: &Reading,
    take: &mut dyn FnMut(&[Cell<'_>]) -> Result<()>,
) -> Result<Quantities> {
    let file = path.display();
    let mut bytes = Vec::new();
    content.read_to_end(&mut bytes).with_context(|| format!("reading {file}"))?;
    let column_of = |header: &str| -> Option<&Column> {
        match headers::find(&reading.renamed(header).unwrap_or_else(|| header.to_owned()), known) {
            Ok(Match::Known(column, _) | Match::Meant(column, _)) => {
                known.iter().copied().find(|own| own.name == column.name)
            }
            _ => None,
        }
    };
    // A unit may stand in the row below.
    let with_unit =
        |header: &str| known.iter().copied().find(|own| headers::split(header).0.eq_ignore_ascii_case(&own.name));
    let sheet = Sheet::new(
        &bytes,
        path,
        |header| {
            let column = column_of(header).or_else(|| with_unit(header));
            (column.is_some(), column.is_some_and(|column| column.required))
        },
        |header, unit| {
            let column = column_of(header).or_else(|| with_unit(header)).filter(|column| column.required);
            column.is_some_and(|column| quantity::in_si(0.0, unit, column.unit, column.absolute).is_ok())
        },
    )?;
    let Sheet { headers, line, separator, rows } = sheet;
    if headers.iter().all(String::is_empty) {
        let first = known.first().map_or_else(String::new, |column| format!("{} [{}]", column.name, column.unit.name));
        bail!("{file} is empty; its first line must name the columns, as {first}");
    }
    let (found, notes) = columns(path, line, &headers, &rows, known, reading)?;
    if let Some(missing) = known.iter().find(|known| known.required && found.iter().all(|own| own.name != known.name)) {
        let fits = |symbol| quantity::in_si(0.0, symbol, missing.unit, missing.absolute).is_ok();
        let unknown = headers.iter().zip(&found).filter(|(_, own)| own.is_ignored());
        let candidates: Vec<&str> = unknown
            .map(|(header, _)| header.as_str())
            .filter(|header| headers::split(header).1.is_some_and(fits))
            .collect();
        let names = listed(headers.iter().map(String::as_str));
        let mut text = format!("{file}, line {line}: no column {}; found are {names}", missing.headers());
        if !candidates.is_empty() {
            let [name, _] = reading.spelled();
            text.push_str(&format!("; {name} names {}, which has its unit", candidates.join(" or ")));
        }
        bail!(MissingColumn { text, has_candidate: !candidates.is_empty() });
    }
    if rows.is_empty() {
        bail!("{file} has no row below its header");
    }
    let mut mark = None;
    for (line, record) in &rows {
        let mut cells = Vec::with_capacity(found.len());
        for (at, (text, column)) in
            record.iter().zip(&found).enumerate().filter(|(_, (_, column))| !column.is_ignored())
        {
            let mut cell = Cell {
                name: &column.name,
                value: f64::NAN,
                path,
                line: *line,
                column: at + 1,
                header: &headers[at],
                text,
            };
            if !is_gap(text) {
                let number = number(text, separator, &mut mark).map_err(|wrong| anyhow!("{} {wrong}", cell.place()))?;
                cell.value = quantity::in_si(number, &column.symbol, column.unit, column.absolute)
                    .map_err(|wrong| anyhow!("{}: {wrong}", cell.place()))?;
                if column.name.is_empty() && number.fract() != 0.0 {
                    bail!("{} is no number of a row, and its column has no name", cell.place());
                }
            }
            if column.taken {
                cells.push(cell);
            }
        }
        take(&cells)?;
    }
    let of = |taken: bool| {
        found
            .iter()
            .filter(|own| own.taken == taken && !own.is_ignored() && !own.name.is_empty())
            .map(|own| own.name.clone())
            .collect()
    };
    let [taken, left_out] = [of(true), of(false)];
    Ok(Quantities { taken, left_out, headers, notes })
}

/// A number with a point, or where no comma separates the columns, with a comma: with one of them in all of the file, which is `mark`.
fn number(text: &str, separator: char, mark: &mut Option<char>) -> Result<f64, &'static str> {
    let own = ['.', ','].into_iter().find(|mark| text.contains(*mark));
    let plain = if own == Some(',') && separator != ',' { text.replace(',', ".") } else { text.to_owned() };
    let number = plain.parse().map_err(|_| match quantity::decimal_comma(text) {
        Some(_) if separator != ',' => {
            "has a point and a comma; one of them is the decimal mark, and thousands have none"
        }
        Some(hint) => hint,
        None => "is no number",
    })?;
    if own.is_some() && *mark.get_or_insert(own.unwrap_or('.')) != own.unwrap_or('.') {
        return Err("has another decimal mark than the numbers above");
    }
    Ok(number)
}

/// What the columns of a file are, and notes about those that are not known by their names.
fn columns(
    path: &Path,
    line: u64,
    headers: &[String],
    rows: &[(u64, csv::StringRecord)],
    known: &[&Column],
    reading: &Reading,
) -> Result<(Vec<Found>, Vec<String>)> {
    let file = path.display();
    let place = |at: usize| format!("{file}, line {line}, column {}", at + 1);
    let [name, leave] = reading.spelled();
    let (mut found, mut meant, mut ignored) = (Vec::<Found>::new(), Vec::new(), Vec::new());
    for (at, header) in headers.iter().enumerate() {
        let renamed = reading.renamed(header);
        let read = renamed.as_deref().unwrap_or(header);
        let has_values = || rows.iter().any(|(_, row)| !is_gap(&row[at]));
        let own = if at == 0 && ["", "Unnamed: 0"].contains(&read) && renamed.is_none() {
            Found::row_number()
        } else if read.is_empty() && (renamed.is_some() || !has_values()) {
            Found::ignored()
        } else {
            match headers::find(read, known).map_err(|wrong| anyhow!("{}: {wrong}", place(at)))? {
                Match::Known(column, symbol) => Found::of(column, &symbol, true),
                Match::Meant(column, symbol) => Found::of(column, &symbol, false),
                Match::Unknown(candidates) if reading.strict || read.is_empty() || renamed.is_some() => {
                    bail!(
                        "{}: {} is not a known quantity with a known unit; {}{candidates}",
                        place(at),
                        Quoted(read),
                        alternatives(known)
                    );
                }
                Match::Unknown(candidates) => {
                    ignored.push(format!("{}{candidates}", Quoted(header)));
                    Found::ignored()
                }
            }
        };
        found.push(own);
    }
    for at in 0..found.len() {
        let twice = found.iter().position(|other| other.name == found[at].name).filter(|other| *other != at);
        let Some(other) = twice.filter(|_| !found[at].is_ignored() && !found[at].name.is_empty()) else { continue };
        match (found[other].by_name, found[at].by_name) {
            (true, true) => bail!("{}: {} stands in column {} already", place(at), found[at].name, other + 1),
            (false, false) => bail!(
                "{}: {} and column {}, {}, may both be {}; choose with {name}, and leave the other out with {leave}",
                place(at),
                Quoted(&headers[at]),
                other + 1,
                Quoted(&headers[other]),
                found[at].name
            ),
            (first, _) => {
                let less = if first { at } else { other };
                ignored.push(Quoted(&headers[less]).to_string());
                found[less] = Found::ignored();
            }
        }
    }
    meant.extend(
        found
            .iter()
            .zip(headers)
            .filter(|(own, _)| !own.by_name)
            .map(|(own, header)| format!("{} as {}", Quoted(header), own.name)),
    );
    let mut notes = Vec::new();
    if !meant.is_empty() {
        notes.push(format!("{file}: read are {}", listed(meant.iter().map(String::as_str))));
    }
    if !ignored.is_empty() {
        let names = listed(ignored.iter().map(String::as_str));
        notes.push(format!("{file}: left out are {names}; {name} names a quantity"));
    }
    Ok((found, notes))
}

/// A row with as many cells as the header.
///
/// # Errors
/// With file and line, where it has not.
pub fn whole(record: csv::Result<csv::StringRecord>, path: &Path) -> Result<csv::StringRecord> {
    let file = path.display();
    record.map_err(|error| match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            let hint = if len > expected_len { "; numbers have a decimal point, a comma separates cells" } else { "" };
            anyhow!("{file}, line {line}: {len} cells, and the header has {expected_len}{hint}")
        }
        csv::ErrorKind::Utf8 { .. } => anyhow!("{file} is no text in UTF-8; a CSV file is needed"),
        _ => anyhow!(error).context(format!("reading {file}")),
    })
}

/// Whether a header is separated by commas.
///
/// # Errors
/// With what separates it.
pub fn check_separator(headers: &csv::StringRecord) -> Result<(), String> {
    match [';', '\t'].into_iter().find(|&separator| headers.iter().any(|header| header.contains(separator))) {
        Some(separator) => Err(format!("columns are separated by commas, and this header has {separator:?}")),
        None => Ok(()),
    }
}

/// A column of a file.
struct Found {
    name: String,
    symbol: String,
    unit: &'static Unit,
    absolute: bool,
    taken: bool,
    /// Whether its header is the name of the quantity.
    by_name: bool,
}

impl Found {
    fn of(column: &Column, symbol: &str, by_name: bool) -> Self {
        let Column { name, unit, absolute, taken, .. } = column;
        let (name, symbol) = (name.clone(), symbol.to_owned());
        Self { name, symbol, unit, absolute: *absolute, taken: *taken, by_name }
    }

    /// A column without a name that numbers the rows.
    fn row_number() -> Self {
        let Column { unit, absolute, .. } = Column::optional("", &ONE);
        Self { name: String::new(), symbol: ONE.name.into(), unit, absolute, taken: false, by_name: true }
    }

    /// A column whose cells are not read.
    fn ignored() -> Self {
        Self { symbol: String::new(), ..Self::row_number() }
    }

    fn is_ignored(&self) -> bool {
        self.symbol.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::units::{KELVIN, METRE_PER_SECOND, NEWTON};

    fn accepted() -> Vec<Column> {
        let speed = Column { required: true, unit_required: true, ..Column::optional("speed", &METRE_PER_SECOND) };
        let offset = Column { absolute: false, ..Column::optional("offset", &KELVIN) };
        vec![speed, Column::optional("normal_load", &NEWTON), Column::optional("outside", &KELVIN), offset]
    }

    fn table(name: &str, text: &str) -> Result<Table> {
        let path = std::env::temp_dir().join(format!("columns-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let result = read(&path, &accepted(), &Reading::default());
        std::fs::remove_file(&path).unwrap();
        result
    }

    #[test]
    fn the_record_of_a_run_is_read_as_inputs_with_or_without_the_index_of_pandas() {
        let parsed = |text: &str| parse(text.as_bytes(), Path::new("run.csv"), &Column::inputs(), &Reading::default());
        let run = "time [s],sliding_velocity [m/s],wear_depth [m],normal_load [N]\n0,1,2,3\n1,4,5,6\n";
        let indexed = ",time [s],sliding_velocity [m/s],wear_depth [m],normal_load [N]\n0,0,1,2,3\n7,1,4,5,6\n";
        for text in [run, indexed] {
            let table = parsed(text).unwrap();
            assert_eq!(table.names, ["sliding_velocity", "normal_load"], "{text}");
            assert_eq!(table.left_out, ["wear_depth"], "{text}");
            assert_eq!((table.times, table.values), (vec![0.0, 1.0], vec![1.0, 3.0, 4.0, 6.0]), "{text}");
        }
        for (text, told) in [
            (
                indexed.replace("\n7,", "\n7.5,"),
                "line 3, column 1 (): \"7.5\" is no number of a row, and its column has no name",
            ),
            (run.replace("wear_depth [m]", ""), "line 1, column 3: \"\" is not a known quantity"),
            (run.replace("wear_depth [m]", "wear_depth [s]"), "\"s\" is the wrong unit"),
            (run.replace("wear_depth", "wear_dept"), "did you mean wear_depth?"),
        ] {
            let message = parsed(&text).unwrap_err().to_string();
            assert!(message.contains(told), "{message}");
        }
    }

    #[test]
    fn gaps_of_an_input_are_bridged_where_nothing_is_invented() {
        let slow =
            table("slow", "time,speed_m_per_s,normal_load\n0,1,\n1,2,10\n2,,\n3,4,nan\n4,5,16\n5,6,n/a\n6,7,20\n")
                .unwrap();
        assert_eq!(slow.column("speed").unwrap().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert_eq!(slow.column("normal_load").unwrap().collect::<Vec<_>>(), [10.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0]);
        let rows = |load: [&str; 9]| {
            let row = |(time, load): (usize, &&str)| format!("{time},1,{load}\n");
            format!("time,speed_m_per_s,normal_load\n{}", load.iter().enumerate().map(row).collect::<String>())
        };
        // The same on both sides of a long gap.
        let held = table("held", &rows(["9", "8", "8", "", "", "", "", "8.1", "5"])).unwrap();
        assert!((held.column("normal_load").unwrap().nth(4).unwrap() - 8.04).abs() < 1e-12);
        for (load, told) in [
            (
                ["9", "8", "8", "", "", "", "", "3", "5"],
                "lines 4 to 9: normal_load has no value for 5 s from 8 N to 3 N",
            ),
            (
                ["", "", "", "", "8", "", "8", "3", "5"],
                "lines 2 to 6: normal_load has no value for 4 s at the beginning",
            ),
            (["9", "8", "8", "7", "", "", "", "", ""], "lines 5 to 10: normal_load has no value for 5 s at the end"),
            ([""; 9], "the column normal_load has no value"),
        ] {
            let message = table("gap", &rows(load)).unwrap_err().to_string();
            assert!(message.contains(told), "{message}\nis without {told}");
        }
    }

    #[test]
    fn a_record_keeps_its_gaps_and_a_time_in_two_rows() {
        let text = "time [s],contact_temperature [degC],wear_depth [um]\n0,20,\n1,,\n1,25,NaN\n2,30,4\n";
        let read = parse(text.as_bytes(), Path::new("a.csv"), &Column::record(), &Reading::default()).unwrap();
        let wear: Vec<f64> = read.column("wear_depth").unwrap().collect();
        assert_eq!(read.times, [0.0, 1.0, 1.0, 2.0]);
        assert!(wear[..3].iter().all(|wear| wear.is_nan()) && wear[3] == 4e-6, "{wear:?}");
        assert!(read.column("contact_temperature").unwrap().nth(1).unwrap().is_nan());
        assert_eq!(read.points("contact_temperature").unwrap(), [(0.0, 293.15), (2.0, 303.15)]);
        assert_eq!(read.points("wear_depth").unwrap(), [(2.0, 4e-6)]);
    }

    #[test]
    fn columns_are_renamed_left_out_or_refused() {
        let text = "time [s],Kraft [kN],Humidity [%],COF 2\n0,1,40,0.4\n1,2,41,0.5\n";
        let read = |columns: &[&str], strict: bool| {
            let reading = Reading { columns: columns.iter().map(|named| named.parse().unwrap()).collect(), strict, ..Reading::default() };
            let table = parse(text.as_bytes(), Path::new("rig.csv"), &Column::record(), &reading)?;
            reading.check(&[&table]).map(|()| table)
        };
        let all = ["Kraft=normal_load", "COF 2=friction_coefficient", "Humidity="];
        let named = read(&all, true).unwrap();
        assert_eq!((named.names.len(), named.values[0], named.values[1]), (2, 1000.0, 0.4));
        assert!(named.notes.is_empty(), "{:?}", named.notes);
        let first = read(&all[..1], false).unwrap();
        assert_eq!(first.names, ["normal_load"]);
        assert_eq!(first.notes.len(), 1);
        assert!(
            first.notes[0].contains("rig.csv: left out are \"Humidity [%]\", \"COF 2\"; --column"),
            "{:?}",
            first.notes
        );
        for (columns, strict, told) in [
            (&[][..], true, "column 2: \"Kraft [kN]\" is not a known quantity"),
            (
                &["Kraft [kN]=normal_load [N]", "Kaft=wear_depth"][..],
                false,
                "there is no column \"Kaft\"; found are time [s], Kraft",
            ),
            (&["Kraft=normal_laod"][..], false, "did you mean normal_load?"),
            (&["Kraft=nothing"][..], false, "\"nothing [kN]\" is not a known quantity"),
            (&["COF 2=normal_load"][..], false, "does not say its unit"),
        ] {
            let message = read(columns, strict).unwrap_err().to_string();
            assert!(message.contains(told), "{message}\nis without {told}");
        }
        assert!("COF".parse::<Named>().unwrap_err().contains("HEADER=VARIABLE"));
    }

    #[test]
    fn columns_are_known_by_name_and_converted() {
        let text = "\u{feff}# a note\nnormal_load[kN], time [min], outside [degC], speed_km_per_h\n3, 0, 20, 36\n4, 1, 30, 72\n";
        let read = table("units", text).unwrap();
        assert_eq!(read.times, [0.0, 60.0]);
        assert_eq!(read.names, ["normal_load", "outside", "speed"]);
        assert_eq!(read.column("speed").unwrap().collect::<Vec<_>>(), [10.0, 20.0]);
        assert_eq!(read.column("normal_load").unwrap().collect::<Vec<_>>(), [3000.0, 4000.0]);
        assert_eq!(read.column("outside").unwrap().collect::<Vec<_>>(), [293.15, 303.15]);
        assert!(read.column("offset").is_none());
        let plain = table("plain", "time_s,speed_m_per_s,normal_load\n0,0.1,7\n").unwrap();
        assert_eq!((plain.values, plain.lines), (vec![0.1, 7.0], vec![2]));
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_place_and_what_would() {
        for (name, text, wanted) in [
            (
                "order",
                "speed_m_per_s,normal_load\n0,1\n",
                "line 1: no column time or time [s or min or h or ms]; found are",
            ),
            (
                "missing",
                "Zeit [s],sliding_velocity [m/s]\n0,1\n",
                "Zeit [s], sliding_velocity [m/s]; --column \"HEADER=VARIABLE\" names Zeit [s], which has its unit",
            ),
            ("missing", "time,normal_load\n0,1\n", "no column speed [m/s or km/h or mm/s or m/min or cm/s]"),
            ("unknown", "time,slope\n0,1\n", "no column speed [m/s or km/h"),
            ("bare", "time,speed\n0,1\n", "column 2: \"speed\" does not say its unit; accepted is speed [m/s"),
            ("unit", "time,speed [mph]\n0,1\n", "\"mph\" is the wrong unit; accepted are m/s, km/h, mm/s"),
            ("difference", "time,speed [m/s],offset [degC]\n0,1,2\n", "accepted are K"),
            ("twice", "time,speed_m_per_s,speed [km/h]\n0,1,2\n", "column 3: speed stands in column 2 already"),
            ("word", "time,speed_m_per_s\n0,1\n1,fast\n", "line 3, column 2 (speed_m_per_s): \"fast\" is no number"),
            ("empty", "time,speed_m_per_s,normal_load\n,1,1\n", "line 2, column 1 (time): \"\" is no number"),
            ("infinite", "time,speed_m_per_s\n0,inf\n", "\"inf\": inf is not a finite number"),
            (
                "beyond",
                "time,speed_m_per_s,normal_load [kN]\n0,1,1e306\n",
                "\"1e306\": 1e306 kN is no finite number in the SI unit",
            ),
            (
                "back",
                "time,speed_m_per_s\n0,1\n1,1\n.5,1\n",
                "line 4, column 1 (time): \".5\": the time must not decrease",
            ),
            (
                "thrice",
                "time,speed_m_per_s\n1,1\n1,1\n1,1\n",
                "line 4, column 1 (time): \"1\": a time may stand in two rows",
            ),
            ("none", "time,speed_m_per_s\n", "has no row"),
            ("binary", "time\0speed\n", "is no text; a CSV or Parquet file is needed"),
            ("parquet", "PAR1 and no more", "reading"),
            ("nothing", "", "is empty; its first line must name the columns"),
            ("notes", "# nothing\n", "is empty"),
            (
                "marks",
                "time;speed_m_per_s\n0.5;1\n1;1,5\n",
                "line 3, column 2 (speed_m_per_s): \"1,5\" has another decimal mark",
            ),
            ("thousands", "time;speed_m_per_s\n0;1.234,5\n", "\"1.234,5\" has a point and a comma"),
            ("decimal", "time,speed_m_per_s\n0,\"0,5\"\n", "\"0,5\" has a comma; numbers have a decimal point"),
            ("slip", "time,speeed [m/s]\n0,1\n", "; did you mean speed?"),
            ("ragged", "time,speed_m_per_s\n0,1\n1\n", "line 3: 1 cells, and the header has 2"),
            (
                "comma",
                "time,speed_m_per_s\n0,5,1\n",
                "line 2: 3 cells, and the header has 2; numbers have a decimal point",
            ),
        ] {
            let told = format!("{:#}", table(name, text).unwrap_err());
            assert!(told.contains(wanted), "{told}\nis without {wanted}");
        }
    }
}
