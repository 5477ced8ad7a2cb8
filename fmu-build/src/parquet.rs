//! Tables as Apache Parquet: one row group, without compression.

use ::parquet::basic::{LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use ::parquet::errors::Result as Written;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::Type;
use anyhow::{Context, Result};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

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

    fn schema(&self, title: &str) -> Written<Type> {
        let (physical, repetition, logical) = match self {
            Self::Integers(_) => (Physical::INT64, Repetition::OPTIONAL, None),
            Self::Numbers(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            Self::Truths(_) => (Physical::BOOLEAN, Repetition::OPTIONAL, None),
            Self::Texts(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
        };
        Type::primitive_type_builder(title, physical).with_repetition(repetition).with_logical_type(logical).build()
    }

    fn write(&self, to: &mut SerializedColumnWriter) -> Written<()> {
        match self {
            Self::Integers(values) => known::<Int64Type>(to, values)?,
            Self::Numbers(values) => known::<DoubleType>(to, values)?,
            Self::Truths(values) => known::<BoolType>(to, values)?,
            Self::Texts(values) => {
                let values: Vec<ByteArray> = values.iter().map(|&value| value.into()).collect();
                to.typed::<ByteArrayType>().write_batch(&values, None, None)?
            }
        };
        Ok(())
    }
}

/// The values that are known, and which those are.
fn known<T: DataType>(to: &mut SerializedColumnWriter, values: &[Option<T::T>]) -> Written<usize> {
    let levels: Vec<i16> = values.iter().map(|value| value.is_some().into()).collect();
    to.typed::<T>().write_batch(&values.iter().flatten().cloned().collect::<Vec<_>>(), Some(&levels), None)
}

fn write_columns(columns: &[(String, Column<'_>)], parquet: &Path) -> Result<()> {
    let fields = columns.iter().map(|(title, column)| Ok(Arc::new(column.schema(title)?))).collect::<Written<_>>()?;
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
    let mut file = SerializedFileWriter::new(File::create(parquet)?, schema, Arc::default())?;
    let mut rows = file.next_row_group()?;
    for (_, column) in columns {
        let mut writer = rows.next_column()?.context("a column has no place in the schema")?;
        column.write(&mut writer)?;
        writer.close()?;
    }
    rows.close()?;
    file.close()?;
    Ok(())
}

/// Writes the table of a CSV file as Parquet. Columns of whole numbers, of numbers and of truths have that type, with missing values
/// where cells are empty; all others are texts.
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
    write_columns(&columns, parquet).with_context(|| format!("writing {}", parquet.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};

    #[test]
    fn a_table_reads_back_with_the_narrowest_type_of_each_column() {
        let folder = std::env::temp_dir().join(format!("parquet-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (csv, parquet) = (folder.join("table.csv"), folder.join("table.parquet"));
        let table = "# a comment\nlimit,width [m],force [N],open,status,reason\n1,,4,true,1,\n,2.5,4,false,ok,\n";
        std::fs::write(&csv, table).unwrap();
        write(&csv, &parquet).unwrap();
        let reader = SerializedFileReader::new(File::open(&parquet).unwrap()).unwrap();
        let rows: Vec<String> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        let expected = [
            "{limit: 1, width [m]: null, force [N]: 4.0, open: true, status: \"1\", reason: \"\"}",
            "{limit: null, width [m]: 2.5, force [N]: 4.0, open: false, status: \"ok\", reason: \"\"}",
        ];
        assert_eq!(rows, expected);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
