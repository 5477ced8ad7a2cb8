//! The text of a table file: header and rows of cells, whatever program wrote it.
//!
//! A file is Parquet where it begins as such, else text: UTF-8, UTF-16 with its mark, or Latin-1. Columns are separated by what the header has
//! of semicolon, tab and comma, in this order. Lines that begin with `#` are notes, and so are lines above the header: the first line
//! that names a required column and another known one; where none does, the first one with as many cells as the last. A row of units may
//! stand below it.

use super::rows::is_gap;
use anyhow::{Context, Result, anyhow, bail};
use chrono::DateTime;
use csv::StringRecord;
use parquet::basic::{LogicalType, TimeUnit};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet::schema::types::Type;
use std::fmt::Write as _;
use std::fs::File;
use std::path::Path;

/// Lines among which the header is looked for.
const HEAD: usize = 200;

/// A file as header and rows.
pub(super) struct Sheet {
    /// Cells of the header, with the units of the row below it.
    pub headers: Vec<String>,
    /// Line of the header in the file.
    pub line: u64,
    /// What separates the columns.
    pub separator: char,
    /// Rows with their lines, each with as many cells as the header.
    pub rows: Vec<(u64, StringRecord)>,
}

impl Sheet {
    /// `known` says of a header whether it is a known column, and whether it is a required one; `is_unit` whether a text is a unit of a
    /// header's column.
    pub(crate) fn new(
        content: &[u8],
        path: &Path,
        known: impl Fn(&str) -> (bool, bool),
        is_unit: impl Fn(&str, &str) -> bool,
    ) -> Result<Self> {
        // Lines are counted by their ends.
        let text = text(content, path)?.replace("\r\n", "\n");
        let (above, offset) = head(&text, known);
        let body = &text[offset..];
        let separator = separator(body.lines().next().unwrap_or_default());
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .delimiter(separator as u8)
            .flexible(true)
            .from_reader(body.as_bytes());
        let reading = || format!("reading {}", path.display());
        let line_of = |record: &StringRecord| above + record.position().map_or(1, csv::Position::line);
        let head = reader.headers().with_context(reading)?.clone();
        let line = line_of(&head);
        let mut headers: Vec<String> = head.iter().map(str::to_owned).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let mut record = record.with_context(reading)?;
            let line = line_of(&record);
            let (count, expected) = (record.len(), headers.len());
            // Programs end rows with a separator.
            if count > expected && record.iter().skip(expected).all(str::is_empty) {
                record.truncate(expected);
            } else if count != expected {
                let hint = match separator {
                    ',' if count > expected => COMMAS,
                    _ => "",
                };
                bail!("{}, line {line}: {count} cells, and the header has {expected}{hint}", path.display());
            }
            if record.iter().any(|cell| !is_gap(cell)) {
                rows.push((line, record));
            }
        }
        let says_units = |(_, row): &(u64, StringRecord)| {
            let unit = |(header, cell): (&String, &str)| is_unit(header, bare(cell));
            headers.iter().zip(row).any(unit) && row.iter().all(|cell| cell.parse::<f64>().is_err() || cell == "1")
        };
        if rows.first().is_some_and(says_units) {
            for (header, unit) in headers.iter_mut().zip(rows.remove(0).1.iter().map(bare)) {
                if !unit.is_empty() && !header.ends_with([']', ')']) {
                    let _ = write!(header, " [{unit}]");
                }
            }
        }
        Ok(Self { headers, line, separator, rows })
    }
}

/// A unit without its brackets.
fn bare(cell: &str) -> &str {
    let inner = |open, close| cell.strip_prefix(open).and_then(|rest: &str| rest.strip_suffix(close));
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell).trim()
}

/// What ends the message about a row that has too many commas.
pub(super) const COMMAS: &str = "; numbers have a decimal point, a comma separates cells";

/// What separates the columns of a header.
pub fn separator(header: &str) -> char {
    // What stands in quotes is text.
    let outside: String = header.split('"').step_by(2).collect();
    [';', '\t'].into_iter().find(|&separator| outside.contains(separator)).unwrap_or(',')
}

/// Number of the lines above the header, and where it begins.
fn head(text: &str, known: impl Fn(&str) -> (bool, bool)) -> (u64, usize) {
    let (mut offset, mut required, mut lines) = (0, None, Vec::new());
    for (above, line) in text.split_inclusive('\n').take(HEAD).enumerate() {
        if !line.starts_with('#') && !line.trim().is_empty() {
            lines.push((line.split(separator(line)).count(), (above as u64, offset)));
            let cells = line.trim().split(separator(line)).map(|cell| cell.trim().trim_matches('"').trim());
            let found: Vec<(bool, bool)> = cells.map(&known).collect();
            let count = found.iter().filter(|(known, _)| *known).count();
            if found.iter().any(|(_, required)| *required) {
                if count > 1 {
                    return (above as u64, offset);
                }
                required.get_or_insert((above as u64, offset));
            }
        }
        offset += line.len();
    }
    let alike = lines.iter().find(|(count, _)| lines.last().is_some_and(|(last, _)| count == last));
    required.or(alike.map(|(_, place)| *place)).unwrap_or((0, 0))
}

/// The content of a table file as text.
///
/// # Errors
/// Where it is none.
pub fn text(content: &[u8], path: &Path) -> Result<String> {
    let units = |order: fn([u8; 2]) -> u16| -> Vec<u16> {
        content[2..].chunks_exact(2).map(|pair| order([pair[0], pair[1]])).collect()
    };
    match content {
        [b'P', b'A', b'R', b'1', ..] => of_parquet(path).with_context(|| format!("reading {}", path.display())),
        [0xff, 0xfe, ..] => Ok(String::from_utf16_lossy(&units(u16::from_le_bytes))),
        [0xfe, 0xff, ..] => Ok(String::from_utf16_lossy(&units(u16::from_be_bytes))),
        _ => match std::str::from_utf8(content) {
            Ok(text) if !text.contains('\0') => Ok(text.strip_prefix('\u{feff}').unwrap_or(text).to_owned()),
            // Of Latin-1 the bytes are the characters.
            Err(_) if !content.contains(&0) => Ok(content.iter().map(|byte| char::from(*byte)).collect()),
            _ => Err(anyhow!("{} is no text; a CSV or Parquet file is needed", path.display())),
        },
    }
}

/// The table of a Parquet file as comma-separated text, missing values as empty cells.
fn of_parquet(path: &Path) -> Result<String> {
    let reader = SerializedFileReader::new(File::open(path)?)?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(schema.root_schema().get_fields().iter().map(|field| field.name()))?;
    let has_nanoseconds = |own: &Type| {
        let time = own.get_basic_info().logical_type_ref();
        matches!(time, Some(LogicalType::Timestamp(own)) if own.unit == TimeUnit::NANOS)
    };
    let nanoseconds: Vec<bool> = schema.root_schema().get_fields().iter().map(|own| has_nanoseconds(own)).collect();
    for row in reader.get_row_iter(None)? {
        let row = row?;
        writer.write_record(row.get_column_iter().zip(&nanoseconds).map(|((_, field), is_time)| match field {
            Field::Long(time) if *is_time => DateTime::from_timestamp_nanos(*time).naive_utc().to_string(),
            Field::Null => String::new(),
            Field::Bool(truth) => u8::from(*truth).to_string(),
            Field::Str(text) => text.clone(),
            Field::Double(number) => format!("{number:?}"),
            Field::Float(number) => format!("{number:?}"),
            other => other.to_string(),
        }))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
