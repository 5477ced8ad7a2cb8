//! Rows of a file: what its columns are, and its cells as numbers in SI units.

use super::headers::{self, Match, alternatives};
use super::sheet::{COMMAS, Sheet};
use super::{Column, Reading, TIME};
use crate::{nearest, quantity};
use anyhow::{Context, Result, anyhow, bail};
use chrono::{DateTime, Days, NaiveDateTime, NaiveTime, TimeDelta};
use scene::message::{Clipped, Quoted, listed};
use scene::variables::units::{KELVIN, ONE, Unit};
use std::io::Read;
use std::path::Path;

/// Most columns that a note lists.
const LISTED: usize = 20;

/// Whether a cell says that there is no value; with `#` begin the errors of spreadsheets, as `#NV` and `#DIV/0!`.
pub(super) fn is_gap(text: &str) -> bool {
    let gaps = ["", "nan", "na", "n/a", "<na>", "null", "none", "-", "--"];
    text.starts_with('#') || gaps.iter().any(|gap| text.eq_ignore_ascii_case(gap))
}

/// A cell of a row.
pub(crate) struct Cell<'a> {
    pub(crate) name: &'a str,
    /// Its value in the SI unit; NaN of a gap.
    pub(crate) value: f64,
    path: &'a Path,
    pub(super) line: u64,
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
            let named: Vec<String> = candidates.iter().map(|header| reading.naming(header, &missing.name)).collect();
            text.push_str(&format!("; {} names one that has its unit", named.join(" or ")));
        }
        bail!(MissingColumn { text, has_candidate: !candidates.is_empty() });
    }
    if rows.is_empty() {
        bail!("{file} has no row below its header");
    }
    let (mut mark, mut clock) = (None, Clock::default());
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
            if column.name == TIME && text.contains(':') {
                cell.value = clock.seconds(text).ok_or_else(|| {
                    anyhow!("{} is no time of day, as 09:00:00.5 or 2026-03-04 09:00:00", cell.place())
                })?;
            } else if !is_gap(text) {
                let number = number(text, separator, &mut mark).map_err(|wrong| anyhow!("{} {wrong}", cell.place()))?;
                cell.value = quantity::in_si(number, &column.symbol, column.unit, column.absolute)
                    .map_err(|wrong| anyhow!("{}: {wrong}", cell.place()))?;
                if column.absolute && column.unit.name == KELVIN.name && cell.value < 0.0 {
                    bail!("{} is below absolute zero; a gap is an empty cell or NaN", cell.place());
                }
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

/// Times of day, with a date or without, as seconds from the first of them. Without a date the day ends where they fall by half of one.
#[derive(Default)]
struct Clock {
    first: Option<NaiveDateTime>,
    last: NaiveDateTime,
}

impl Clock {
    fn seconds(&mut self, text: &str) -> Option<f64> {
        let text = text.trim_end_matches('Z').replace(',', ".");
        // A T between date and time counts as the blank; a zone may follow.
        let text = text.replacen('T', " ", 1);
        let formats = ["%Y-%m-%d %H:%M", "%Y/%m/%d %H:%M", "%d.%m.%Y %H:%M"];
        let of_twelve = ["%m/%d/%Y %I:%M:%S%.f %p", "%m/%d/%Y %I:%M %p"].map(str::to_owned);
        let of_a_day = formats.iter().flat_map(|format| [format!("{format}:%S%.f"), (*format).to_owned()]);
        let dated = of_a_day.chain(of_twelve).find_map(|format| {
            let zoned = DateTime::parse_from_str(&text, &format!("{format}%#z")).map(|own| own.naive_utc());
            NaiveDateTime::parse_from_str(&text, &format).or(zoned).ok()
        });
        let now = dated.or_else(|| {
            let times = ["%H:%M:%S%.f", "%H:%M", "%I:%M:%S%.f %p", "%I:%M %p"].iter();
            let time = times.filter_map(|format| NaiveTime::parse_from_str(&text, format).ok()).next()?;
            let now = self.last.date().and_time(time);
            let falls = self.first.is_some() && self.last - now > TimeDelta::hours(12);
            now.checked_add_days(Days::new(falls.into()))
        })?;
        self.last = now;
        (now - *self.first.get_or_insert(now)).num_microseconds().map(|passed| 1e-6 * passed as f64)
    }
}

/// A number with a point, or where no comma separates the columns, with a comma: with one of them in all of the file, which is `mark`.
/// Before it the other one, a blank or an apostrophe may mark thousands.
fn number(text: &str, separator: char, mark: &mut Option<char>) -> Result<f64, &'static str> {
    let joined = without_thousands(text);
    let text = joined.as_deref().unwrap_or(text);
    let own = ['.', ','].into_iter().find(|mark| text.contains(*mark));
    let plain = if own == Some(',') && separator != ',' { text.replace(',', ".") } else { text.to_owned() };
    let number = plain.parse().map_err(|_| match quantity::decimal_comma(text) {
        Some(_) if separator != ',' && text.contains('.') => {
            "has a point and a comma; one of them is the decimal mark, the other stands between thousands"
        }
        Some(hint) if separator == ',' => hint,
        _ => "is no number",
    })?;
    if own.is_some() && *mark.get_or_insert(own.unwrap_or('.')) != own.unwrap_or('.') {
        return Err("has another decimal mark than the numbers above");
    }
    Ok(number)
}

/// `1.234,5`, `1,234.5` or `1 234` without the marks of thousands: blanks, apostrophes, or what the decimal mark behind them is not. `None` of
/// other texts.
fn without_thousands(text: &str) -> Option<String> {
    let (whole, rest) = text.split_at(text.rfind(['.', ',']).unwrap_or(text.len()));
    let other = if rest.starts_with('.') { ',' } else { '.' };
    let mark = [other, ' ', '\u{a0}', '\u{202f}', '\'', '\u{2019}'].into_iter().find(|mark| whole.contains(*mark))?;
    let (first, groups) = whole.trim_start_matches(['-', '+']).split_once(mark)?;
    let is_of_digits = |group: &str| group.bytes().all(|digit| digit.is_ascii_digit());
    let is_grouped = (1..=3).contains(&first.len())
        && is_of_digits(first)
        && groups.split(mark).all(|group| group.len() == 3 && is_of_digits(group));
    is_grouped.then(|| whole.replace(mark, "") + rest)
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
                    let of_user = headers::split(read).0;
                    let accepted = known.iter().filter(|column| column.taken && renamed.is_some());
                    let near = nearest(of_user, accepted.map(|column| column.name.as_str()));
                    bail!(
                        "{}: {} is not a known quantity with a known unit; {}{candidates}{near}; {name} names another one, {leave} leaves \
                         it out",
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
        let more = ignored.len().saturating_sub(LISTED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let names = ignored[..ignored.len().min(LISTED)].join(", ");
        notes.push(format!("{file}: left out are {names}{more}; {name} names a quantity"));
    }
    Ok((found, notes))
}

/// A row with as many cells as the header.
///
/// # Errors
/// With file and line, where it has not.
pub fn whole(record: csv::Result<csv::StringRecord>, separator: char, path: &Path) -> Result<csv::StringRecord> {
    let file = path.display();
    record.map_err(|error| match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            let hint = if separator == ',' && len > expected_len { COMMAS } else { "" };
            anyhow!("{file}, line {line}: {len} cells, and the header has {expected_len}{hint}")
        }
        _ => anyhow!(error).context(format!("reading {file}")),
    })
}

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
