//! The CSV files that go into a batch.

use super::FACTOR;
use crate::columns::{self, Column};
use anyhow::{Context, Result, anyhow, bail};
use fmu_host::{Causality, Description, Variable};
use scene::variables::{self, units};
use scene_file::quantity;
use std::fs::File;
use std::io::Read;
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
        Self::parse(File::open(path).with_context(|| format!("reading {}", path.display()))?, path)
    }

    /// Reads the content of a file; `path` names it in messages.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(content: impl Read, path: &Path) -> Result<Self> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(content);
        let headers = columns::whole(reader.headers().cloned(), path)?;
        let columns: Vec<String> = headers.iter().map(str::to_owned).collect();
        columns::check_separator(&headers).map_err(|wrong| anyhow!("{}, line 1: {wrong}", path.display()))?;
        if let Some((at, twice)) = columns.iter().enumerate().find(|(at, column)| columns[..*at].contains(column)) {
            bail!("{}: column {} is named {twice:?} like another one", path.display(), at + 1);
        }
        let rows = reader
            .records()
            .map(|record| Ok(columns::whole(record, path)?.iter().map(str::to_owned).collect()))
            .collect::<Result<Vec<Vec<String>>>>()?;
        if rows.is_empty() {
            bail!("{} has no row below its header", path.display());
        }
        Ok(Self { columns, rows })
    }

    /// The same with the units of headers (`punch.width [mm]`) and of cells (`40 mm`) converted to those of the FMU, and
    /// headers that are names alone. A cell that is no number of its unit stays, so that it fails its own scene only.
    ///
    /// # Errors
    /// A header with a unit that is not one of its variable, with those that are accepted; a column that is there twice then.
    pub fn in_units_of(&self, description: &Description) -> Result<Self> {
        let mut converted = self.clone();
        for (at, header) in self.columns.iter().enumerate() {
            let (name, symbol) = match header.strip_suffix(']').and_then(|rest| rest.split_once('[')) {
                // The index of an element is no unit.
                Some((name, symbol)) if symbol.parse::<u32>().is_err() => (name.trim_end(), Some(symbol.trim())),
                _ => (header.as_str(), None),
            };
            if converted.columns[..at].iter().any(|other| other == name) {
                bail!("the design's column {header}: {name} stands in another column already");
            }
            name.clone_into(&mut converted.columns[at]);
            let unit = match description.find(name) {
                Ok(variable) if !variable.unit.is_empty() => column(variable),
                Err(_) if name.ends_with(FACTOR) => Column::optional(name, &units::ONE),
                _ if symbol.is_none() => continue,
                // A choice or a number of things has no unit; an unknown name is told as such.
                Err(unknown) => bail!("the design's column {header}: {unknown}"),
                Ok(_) => Column::optional(name, &units::ONE),
            };
            if let Some(symbol) = symbol {
                quantity::in_si(0.0, symbol, unit.unit, unit.absolute)
                    .map_err(|wrong| anyhow!("the design's column {header}: {wrong}"))?;
            }
            for row in &mut converted.rows {
                let cell = &row[at];
                let value = match (symbol, cell.parse()) {
                    (Some(symbol), Ok(number)) => quantity::in_si(number, symbol, unit.unit, unit.absolute),
                    (None, Err(_)) => quantity::text(cell, unit.unit, unit.absolute),
                    _ => continue,
                };
                if let Ok(value) = value {
                    row[at] = value.to_string();
                }
            }
        }
        Ok(converted)
    }
}

/// Inputs of an FMU over time, in its units.
#[derive(Clone, PartialEq, Debug)]
pub struct Inputs {
    /// File, or description, for messages.
    pub source: String,
    /// Names, one per column.
    pub names: Vec<String>,
    /// s
    pub times: Vec<f64>,
    /// Row by row.
    pub values: Vec<f64>,
}

impl Inputs {
    /// Reads a file with the column `time` and one per input, with or without a unit; see [`columns`].
    ///
    /// # Errors
    /// As [`columns::read`].
    pub fn read(path: &Path, description: &Description) -> Result<Self> {
        Self::parse(File::open(path).with_context(|| format!("reading {}", path.display()))?, path, description)
    }

    /// Reads the content of a file; `path` names it in messages.
    ///
    /// # Errors
    /// As [`columns::read`].
    pub fn parse(content: impl Read, path: &Path, description: &Description) -> Result<Self> {
        let inputs = description.variables().iter().filter(|variable| variable.causality == Causality::Input);
        let accepted: Vec<Column> = inputs.map(column).collect();
        let columns::Table { names, times, values, .. } = columns::parse(content, path, &accepted)?;
        Ok(Self { source: path.display().to_string(), names, times, values })
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

/// The column of a variable: with the units of its row in the table of variables.
fn column(variable: &Variable) -> Column {
    let row = variables::find(&variable.name).and_then(variables::lookup).map(|(row, _)| row);
    let unit = units::UNITS.iter().copied().find(|unit| unit.name == variable.unit).unwrap_or(&units::ONE);
    Column { absolute: row.is_none_or(|row| !row.is_difference()), ..Column::optional(&variable.name, unit) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("batch-tables-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        path
    }

    fn description() -> Description {
        let variable = |name: &str, causality: &str, unit: &str| {
            format!(
                "<ScalarVariable name=\"{name}\" valueReference=\"1\" causality=\"{causality}\"><Real unit=\"{unit}\"/></ScalarVariable>"
            )
        };
        let text = format!(
            "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"a\" guid=\"b\"><CoSimulation modelIdentifier=\"c\"/>\
             <ModelVariables>{}{}{}</ModelVariables></fmiModelDescription>",
            variable("sliding_velocity", "input", "m/s"),
            variable("normal_load", "input", "N"),
            variable("punch.width", "parameter", "m"),
        );
        Description::parse(&text).unwrap()
    }

    #[test]
    fn designs_and_inputs_are_read() {
        let path = file("design", "# a note\npunch.width, level\n0.1, lumped\n0.2,auto\n");
        let table = Table::read(&path).unwrap();
        assert_eq!(table.columns, ["punch.width", "level"]);
        assert_eq!(table.rows, [["0.1", "lumped"], ["0.2", "auto"]]);
        let path = file("inputs", "time,normal_load,sliding_velocity [km/h]\n0,1,36\n2.5,3e3,72\n");
        let inputs = Inputs::read(&path, &description()).unwrap();
        assert_eq!((inputs.start(), inputs.stop()), (0.0, 2.5));
        assert_eq!(inputs.names, ["normal_load", "sliding_velocity"]);
        assert_eq!(inputs.values, [1.0, 10.0, 3000.0, 20.0]);
    }

    #[test]
    fn units_of_a_design_are_those_of_scene_files() {
        let path = file("in_units", "punch.width [mm], normal_load.factor, level\n40, 50 %, 2\nwide, 2, 3 mm\n");
        let table = Table::read(&path).unwrap().in_units_of(&description()).unwrap();
        assert_eq!(table.columns, ["punch.width", "normal_load.factor", "level"]);
        // What is no number fails its scene, and says so there.
        assert_eq!(table.rows, [["0.04", "0.5", "2"], ["wide", "2", "3 mm"]]);
        let path = file("in_cells", "punch.width\n40 mm\n0.05\n40 kN\n");
        let table = Table::read(&path).unwrap().in_units_of(&description()).unwrap();
        assert_eq!(table.rows, [["0.04"], ["0.05"], ["40 kN"]]);
        for (name, text, wanted) in [
            ("wrong", "punch.width [kN]\n1\n", "column punch.width [kN]: \"kN\" is the wrong unit; accepted are m, mm"),
            ("factor", "normal_load.factor [kN]\n1\n", "accepted are 1, %"),
            ("same", "punch.width,punch.width [mm]\n1,1\n", "punch.width stands in another column already"),
        ] {
            let table = Table::read(&file(name, text)).unwrap();
            let told = format!("{:#}", table.in_units_of(&description()).unwrap_err());
            assert!(told.contains(wanted), "{told}");
        }
    }

    #[test]
    fn broken_files_are_told_with_the_place() {
        let told = |result: Result<()>| format!("{:#}", result.unwrap_err());
        let table = |name, text| told(Table::read(&file(name, text)).map(|_| ()));
        assert!(table("twice", "a,a\n1,2\n").contains("\"a\""));
        assert!(table("empty", "a,b\n").contains("no row"));
        assert!(table("short", "a,b\n1\n").contains("short.csv"));
        let inputs = |name, text| told(Inputs::read(&file(name, text), &description()).map(|_| ()));
        assert!(inputs("notime", "normal_load\n1\n").contains("no column time"));
        assert!(inputs("word", "time,normal_load\n0,heavy\n").contains("column 2 (normal_load): \"heavy\""));
        assert!(inputs("parameter", "time,punch.width\n0,1\n").contains("accepted are time"));
    }
}
