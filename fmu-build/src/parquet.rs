//! Tables as Apache Parquet: one row group, a page a column, plain encoding without compression.
//!
//! Metadata are in Thrift's compact protocol, field by field as in parquet.thrift of the format's specification.

use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

const MAGIC: &[u8; 4] = b"PAR1";

/// Values of a column; numbers may be missing.
enum Column<'a> {
    Integers(Vec<Option<i64>>),
    Numbers(Vec<Option<f64>>),
    Truths(Vec<Option<bool>>),
    Texts(Vec<&'a str>),
}

impl<'a> Column<'a> {
    /// The narrowest type that every cell has, numbers where the title has a unit: a force is no whole number for being 0 in every row. A
    /// column without any value is one of texts.
    fn of(title: &str, cells: Vec<&'a str>) -> Self {
        fn all<T: std::str::FromStr>(cells: &[&str]) -> Option<Vec<Option<T>>> {
            let read = |cell: &&str| if cell.is_empty() { Some(None) } else { cell.parse().ok().map(Some) };
            cells.iter().map(read).collect()
        }
        if cells.iter().all(|cell| cell.is_empty()) {
            return Self::Texts(cells);
        }
        let (integers, numbers, truths) = (all(&cells), all(&cells), all(&cells));
        match (integers, numbers, truths) {
            (Some(integers), ..) if !title.ends_with(']') => Self::Integers(integers),
            (_, Some(numbers), _) => Self::Numbers(numbers),
            (.., Some(truths)) => Self::Truths(truths),
            _ => Self::Texts(cells),
        }
    }

    /// Physical type in the format's numbering.
    fn physical(&self) -> i64 {
        match self {
            Self::Truths(_) => 0,
            Self::Integers(_) => 2,
            Self::Numbers(_) => 5,
            Self::Texts(_) => 6,
        }
    }

    fn is_optional(&self) -> bool {
        !matches!(self, Self::Texts(_))
    }

    fn rows(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Numbers(values) => values.len(),
            Self::Truths(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// Definition levels and values of the only page.
    fn page(&self) -> Vec<u8> {
        let mut page = Vec::new();
        match self {
            Self::Integers(values) => {
                levels(&mut page, values);
                values.iter().flatten().for_each(|value| page.extend(value.to_le_bytes()));
            }
            Self::Numbers(values) => {
                levels(&mut page, values);
                values.iter().flatten().for_each(|value| page.extend(value.to_le_bytes()));
            }
            Self::Truths(values) => {
                levels(&mut page, values);
                page.extend(bits(values.iter().flatten().copied()));
            }
            Self::Texts(values) => {
                for value in values {
                    page.extend((value.len() as u32).to_le_bytes());
                    page.extend(value.as_bytes());
                }
            }
        }
        page
    }
}

/// Truths as bits, the least significant first.
fn bits(truths: impl Iterator<Item = bool>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (index, truth) in truths.enumerate() {
        if index % 8 == 0 {
            bytes.push(0);
        }
        if let Some(last) = bytes.last_mut() {
            *last |= u8::from(truth) << (index % 8);
        }
    }
    bytes
}

/// Which values there are, as one bit-packed run of the hybrid encoding behind its length.
fn levels<T>(page: &mut Vec<u8>, values: &[Option<T>]) {
    let mut run = Vec::new();
    let packed = bits(values.iter().map(Option::is_some));
    varint(&mut run, (packed.len() as u64) << 1 | 1);
    run.extend(packed);
    page.extend((run.len() as u32).to_le_bytes());
    page.extend(run);
}

fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// A structure in Thrift's compact protocol.
#[derive(Default)]
struct Structure {
    bytes: Vec<u8>,
    last: u8,
}

impl Structure {
    fn field(&mut self, id: u8, kind: u8) {
        // Fields stand in ascending order, at most 15 apart.
        self.bytes.push((id - self.last) << 4 | kind);
        self.last = id;
    }

    fn int32(mut self, id: u8, value: i64) -> Self {
        self.field(id, 5);
        varint(&mut self.bytes, zigzag(value));
        self
    }

    fn int64(mut self, id: u8, value: usize) -> Self {
        self.field(id, 6);
        varint(&mut self.bytes, zigzag(value as i64));
        self
    }

    fn text(mut self, id: u8, value: &str) -> Self {
        self.field(id, 8);
        varint(&mut self.bytes, value.len() as u64);
        self.bytes.extend(value.as_bytes());
        self
    }

    fn structure(mut self, id: u8, value: Structure) -> Self {
        self.field(id, 12);
        self.bytes.extend(value.end());
        self
    }

    /// A list of elements of one kind, each as it stands in the list.
    fn list(mut self, id: u8, kind: u8, elements: Vec<Vec<u8>>) -> Self {
        self.field(id, 9);
        if elements.len() < 15 {
            self.bytes.push((elements.len() as u8) << 4 | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            varint(&mut self.bytes, elements.len() as u64);
        }
        self.bytes.extend(elements.concat());
        self
    }

    fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

fn integer(value: i64) -> Vec<u8> {
    let mut bytes = Vec::new();
    varint(&mut bytes, zigzag(value));
    bytes
}

fn name(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    varint(&mut bytes, text.len() as u64);
    bytes.extend(text.as_bytes());
    bytes
}

/// The bytes of a file with these columns by name.
fn file(columns: &[(String, Column<'_>)]) -> Vec<u8> {
    const RLE: i64 = 3;
    let rows = columns.first().map_or(0, |(_, column)| column.rows());
    let mut bytes = MAGIC.to_vec();
    let mut schema = vec![Structure::default().text(4, "schema").int32(5, columns.len() as i64).end()];
    let mut chunks = Vec::new();
    for (title, column) in columns {
        let element = Structure::default().int32(1, column.physical());
        let element = element.int32(3, i64::from(column.is_optional())).text(4, title);
        // UTF-8.
        let element = if matches!(column, Column::Texts(_)) { element.int32(6, 0) } else { element };
        schema.push(element.end());
        let page = column.page();
        let data = Structure::default().int32(1, rows as i64).int32(2, 0).int32(3, RLE).int32(4, RLE);
        let size = page.len() as i64;
        let header = Structure::default().int32(1, 0).int32(2, size).int32(3, size).structure(5, data).end();
        let (offset, size) = (bytes.len(), header.len() + page.len());
        bytes.extend(header);
        bytes.extend(page);
        let meta = Structure::default()
            .int32(1, column.physical())
            .list(2, 5, vec![integer(0), integer(RLE)])
            .list(3, 8, vec![name(title)])
            .int32(4, 0)
            .int64(5, rows)
            .int64(6, size)
            .int64(7, size)
            .int64(9, offset);
        chunks.push(Structure::default().int64(2, offset).structure(3, meta).end());
    }
    let group = Structure::default().list(1, 12, chunks).int64(2, bytes.len() - MAGIC.len()).int64(3, rows).end();
    let footer = Structure::default()
        .int32(1, 1)
        .list(2, 12, schema)
        .int64(3, rows)
        .list(4, 12, vec![group])
        .text(6, "sliding_contact")
        .end();
    bytes.extend(&footer);
    bytes.extend((footer.len() as u32).to_le_bytes());
    bytes.extend(MAGIC);
    bytes
}

/// Writes the table of a CSV file as Parquet. Columns of whole numbers, of numbers and of truths have that type, with missing values
/// where cells are empty; all others are texts.
///
/// # Errors
/// Where a file cannot be read or written.
pub fn write(csv: &Path, parquet: &Path) -> Result<()> {
    let reading = || format!("reading {}", csv.display());
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(csv).with_context(reading)?;
    let titles: Vec<String> = reader.headers().with_context(reading)?.iter().map(str::to_owned).collect();
    let records: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().with_context(reading)?;
    let columns: Vec<(String, Column<'_>)> = titles
        .into_iter()
        .enumerate()
        .map(|(index, title)| {
            let column = Column::of(&title, records.iter().map(|record| &record[index]).collect());
            (title, column)
        })
        .collect();
    fs::write(parquet, file(&columns)).with_context(|| format!("writing {}", parquet.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_the_narrowest_type_of_its_cells() {
        let kind = |cells: &[&'static str]| Column::of("limit_reached", cells.to_vec()).physical();
        assert_eq!(Column::of("friction_force [N]", vec!["0", "0"]).physical(), 5);
        assert_eq!([kind(&["1", "", "-3"]), kind(&["1", "2.5"]), kind(&["true", "false"])], [2, 5, 0]);
        assert_eq!([kind(&["1", "ok"]), kind(&["", ""]), kind(&["NaN", "1"])], [6, 6, 5]);
    }

    #[test]
    fn bits_and_numbers_are_those_of_the_format() {
        assert_eq!(bits([true, false, true, true].into_iter()), [0b1101]);
        assert_eq!(bits([true; 9].into_iter()), [0xff, 1]);
        let mut bytes = Vec::new();
        varint(&mut bytes, 300);
        assert_eq!(bytes, [0xac, 0x02]);
        assert_eq!([zigzag(0), zigzag(-1), zigzag(1), zigzag(i64::MIN)], [0, 1, 2, u64::MAX]);
        let mut page = Vec::new();
        levels(&mut page, &[Some(1), None, Some(2)]);
        assert_eq!(page, [2, 0, 0, 0, 0b11, 0b101]);
    }

    #[test]
    fn a_file_begins_and_ends_as_one_and_knows_its_footer() {
        let column = Column::Numbers(vec![Some(1.0), None, Some(2.0)]);
        let bytes = file(&[("width [m]".to_owned(), column)]);
        assert!(bytes.starts_with(MAGIC) && bytes.ends_with(MAGIC));
        let at = bytes.len() - 8;
        let length = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let footer = &bytes[at - length..at];
        // The version, behind the header of field 1.
        assert_eq!(footer[..2], [0x15, 2]);
        assert!(footer.windows(9).any(|part| part == b"width [m]"));
    }
}
