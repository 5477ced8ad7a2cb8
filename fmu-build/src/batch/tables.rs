//! The CSV files that go into a batch.

use anyhow::{Context, Result, bail};
use std::path::Path;

/// A design: one row per scene, cells as texts.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// Header.
    pub columns: Vec<String>,
    /// As many cells in each row as columns.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, has no row, a column twice, or a row of another length.
    pub fn read(path: &Path) -> Result<Self> {
        let context = || format!("reading {}", path.display());
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_path(path).with_context(context)?;
        let columns: Vec<String> = reader.headers().with_context(context)?.iter().map(str::to_owned).collect();
        if let Some((at, twice)) = columns.iter().enumerate().find(|(at, column)| columns[..*at].contains(column)) {
            bail!("{}: column {} is named {twice:?} like another one", path.display(), at + 1);
        }
        let rows = reader
            .records()
            .map(|record| Ok(record?.iter().map(str::to_owned).collect()))
            .collect::<Result<Vec<Vec<String>>, csv::Error>>()
            .with_context(context)?;
        if rows.is_empty() {
            bail!("{} has no row below its header", path.display());
        }
        Ok(Self { columns, rows })
    }
}

/// Inputs over time.
#[derive(Clone, PartialEq, Debug)]
pub struct Inputs {
    /// Names, one per column.
    pub names: Vec<String>,
    /// s
    pub times: Vec<f64>,
    /// Row by row.
    pub values: Vec<f64>,
}

impl Inputs {
    /// Reads a file with the column `time` and one per input.
    ///
    /// # Errors
    /// As [`Table::read`], where the first column is not `time`, or a cell is no number.
    pub fn read(path: &Path) -> Result<Self> {
        let table = Table::read(path)?;
        if table.columns[0] != "time" {
            bail!("{}: the first column must be time, not {:?}", path.display(), table.columns[0]);
        }
        let (mut times, mut values) = (Vec::new(), Vec::new());
        for (at, row) in table.rows.iter().enumerate() {
            for (column, cell) in row.iter().enumerate() {
                let value: f64 = cell.parse().with_context(|| {
                    format!("{}: {} = {cell:?} in row {} is no number", path.display(), table.columns[column], at + 1)
                })?;
                if column == 0 { times.push(value) } else { values.push(value) }
            }
        }
        Ok(Self { names: table.columns[1..].to_vec(), times, values })
    }

    /// First time, s.
    pub fn start(&self) -> f64 {
        self.times[0]
    }

    /// Last time, s.
    pub fn stop(&self) -> f64 {
        self.times[self.times.len() - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("batch-tables-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        path
    }

    #[test]
    fn designs_and_inputs_are_read() {
        let path = file("design", "# a note\npunch.width, level\n0.1, lumped\n0.2,auto\n");
        let table = Table::read(&path).unwrap();
        assert_eq!(table.columns, ["punch.width", "level"]);
        assert_eq!(table.rows, [["0.1", "lumped"], ["0.2", "auto"]]);
        let path = file("inputs", "time,load\n0,1\n2.5,3e3\n");
        let inputs = Inputs::read(&path).unwrap();
        assert_eq!((inputs.start(), inputs.stop(), inputs.values), (0.0, 2.5, vec![1.0, 3000.0]));
    }

    #[test]
    fn broken_files_are_told_with_the_place() {
        let told = |result: Result<()>| format!("{:#}", result.unwrap_err());
        let table = |name, text| told(Table::read(&file(name, text)).map(|_| ()));
        assert!(table("twice", "a,a\n1,2\n").contains("\"a\""));
        assert!(table("empty", "a,b\n").contains("no row"));
        assert!(table("short", "a,b\n1\n").contains("short.csv"));
        let inputs = |name, text| told(Inputs::read(&file(name, text)).map(|_| ()));
        assert!(inputs("notime", "load,time\n1,2\n").contains("first column must be time"));
        assert!(inputs("word", "time,load\n0,heavy\n").contains("load = \"heavy\" in row 1"));
    }
}
