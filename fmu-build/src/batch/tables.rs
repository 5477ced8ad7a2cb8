//! The CSV files that go into a batch.

use super::FACTOR;
use crate::columns::{self, Column, Reading};
use anyhow::{Context, Result, anyhow, bail};
use fmu_host::{Causality, Description, Variable};
use scene::message::{Clipped, Quoted, listed};
use scene::variables::units::{self, ONE};
use scene::variables::{self, Kind, Row};
use scene_file::quantity;
use std::io::Read;
use std::path::Path;

/// A design: one row per scene, cells as texts.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// Header.
    pub columns: Vec<String>,
    /// As many cells in each row as columns.
    pub rows: Vec<Vec<String>>,
    /// File, for messages.
    path: String,
    header_line: u64,
    /// Line of the file that every row stands in.
    lines: Vec<u64>,
}

impl Table {
    /// Reads a file.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        Self::parse(columns::open(path)?, path)
    }

    /// Reads the content of a file; `path` names it in messages.
    pub fn parse(mut content: impl Read, path: &Path) -> Result<Self> {
        let mut bytes = Vec::new();
        content.read_to_end(&mut bytes).with_context(|| format!("reading {}", path.display()))?;
        let text = columns::text(&bytes, path)?;
        let head = text.lines().find(|line| !line.starts_with('#') && !line.trim().is_empty());
        let separator = columns::separator(head.unwrap_or_default());
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .delimiter(separator as u8)
            .from_reader(text.as_bytes());
        let headers = columns::whole(reader.headers().cloned(), separator, path)?;
        let columns: Vec<String> = headers.iter().map(str::to_owned).collect();
        if let Some((at, twice)) = columns.iter().enumerate().find(|(at, column)| columns[..*at].contains(column)) {
            bail!("{}: column {} is named {} like another one", path.display(), at + 1, Quoted(twice));
        }
        let (mut rows, mut lines) = (Vec::<Vec<String>>::new(), Vec::new());
        for record in reader.records() {
            let record = columns::whole(record, separator, path)?;
            lines.push(record.position().map_or(0, csv::Position::line));
            // A comma that separates no cells is a decimal one.
            let cell = |cell: &str| if separator == ',' { cell.to_owned() } else { quantity::with_point(cell) };
            rows.push(record.iter().map(cell).collect());
        }
        if rows.is_empty() {
            bail!("{} has no row below its header", path.display());
        }
        let header_line = headers.position().map_or(1, csv::Position::line);
        Ok(Self { columns, rows, path: path.display().to_string(), header_line, lines })
    }

    /// Its cells as the FMU takes them: without the units of headers (`punch.width [mm]`) and of cells (`40 mm`), checked against the bounds of
    /// their variables.
    pub(crate) fn for_fmu(&self, description: &Description) -> Result<Converted> {
        let mut columns: Vec<String> = Vec::with_capacity(self.columns.len());
        let mut rows: Vec<Result<Vec<String>, String>> =
            vec![Ok(Vec::with_capacity(self.columns.len())); self.rows.len()];
        for (at, header) in self.columns.iter().enumerate() {
            let (name, symbol) = split(header);
            if columns.iter().any(|other| other == name) {
                bail!("{} ({}): {} stands in another column already", self.place(at), Clipped(header), Clipped(name));
            }
            let kind = Cells::of(name, description);
            if let Some(symbol) = symbol {
                kind.check_unit(symbol)
                    .map_err(|wrong| anyhow!("{} ({}): {wrong}", self.place(at), Clipped(header)))?;
            }
            for (row, (cells, line)) in rows.iter_mut().zip(self.rows.iter().zip(&self.lines)) {
                let Ok(converted) = row else { continue };
                match kind.value(name, &cells[at], symbol) {
                    Ok(value) => converted.push(value),
                    Err(wrong) => {
                        *row = Err(format!(
                            "{}, line {line}, column {} ({}): {wrong}",
                            self.path,
                            at + 1,
                            Clipped(header)
                        ));
                    }
                }
            }
            columns.push(name.to_owned());
        }
        Ok(Converted { columns, rows })
    }

    /// Where the header of a column stands, for messages.
    pub(crate) fn place(&self, column: usize) -> String {
        format!("{}, line {}, column {}", self.path, self.header_line, column + 1)
    }
}

/// A design as the FMU takes it.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Converted {
    /// Names of variables, and factors.
    pub columns: Vec<String>,
    /// Cells of every row; the fault of a row that cannot be run.
    pub rows: Vec<Result<Vec<String>, String>>,
}

/// Name and unit of a header.
fn split(header: &str) -> (&str, Option<&str>) {
    match header.strip_suffix(']').and_then(|rest| rest.split_once('[')) {
        // The index of an element is no unit, but 1 is one.
        Some((name, symbol)) if name.ends_with(' ') || symbol.parse::<u32>().is_err() => {
            (name.trim_end(), Some(symbol.trim()))
        }
        _ => (header, None),
    }
}

/// Kind of the cells of a column.
enum Cells {
    /// Values of a variable of the table.
    Variable(&'static Row),
    /// Factors on an input.
    Factor,
    /// Values of a variable that other FMUs have.
    Foreign,
    /// No variable of the FMU, which is told elsewhere.
    Unknown,
}

impl Cells {
    fn of(name: &str, description: &Description) -> Self {
        let row = variables::find(name).and_then(variables::lookup).map(|(row, _)| row);
        match (row, description.find(name)) {
            (Some(row), Ok(_)) => Self::Variable(row),
            (None, Ok(_)) => Self::Foreign,
            _ if name.ends_with(FACTOR) => Self::Factor,
            _ => Self::Unknown,
        }
    }

    /// Refuses a unit that the column does not have, with the accepted ones.
    fn check_unit(&self, symbol: &str) -> Result<(), String> {
        let (unit, absolute) = match self {
            Self::Variable(row) => match row.kind {
                Kind::Real { unit, .. } => (unit, !row.is_difference()),
                _ => return Err(format!("it has no unit, such as {}", Quoted(symbol))),
            },
            Self::Factor => (&ONE, true),
            Self::Foreign => return Err("its units are not known here; the value is in the one of the FMU".into()),
            Self::Unknown => return Ok(()),
        };
        quantity::in_si(0.0, symbol, unit, absolute).map(|_| ())
    }

    /// A cell as the FMU takes it.
    fn value(&self, name: &str, cell: &str, symbol: Option<&str>) -> Result<String, String> {
        let value = match self {
            Self::Variable(row) => quantity::cell(cell, symbol, row)?,
            Self::Factor => {
                let factor = quantity::factor(cell, symbol)?;
                if factor < 0.0 && name.strip_suffix(FACTOR) == Some("normal_load") {
                    return Err(format!("{} must be 0 or above: a load presses", Clipped(cell)));
                }
                factor
            }
            Self::Foreign | Self::Unknown => return Ok(cell.to_owned()),
        };
        Ok(value.to_string())
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
    /// What was made of headers that are no names.
    pub notes: Vec<String>,
}

/// Inputs of which one moves the scene.
const VELOCITIES: [&str; 2] = ["sliding_velocity", "angular_velocity"];

impl Inputs {
    /// Reads a file with the column `time` and one per input, with its unit, or of another name that the user says; see [`columns`].
    pub(crate) fn read(path: &Path, description: &Description, reading: &Reading) -> Result<Self> {
        Self::parse(columns::open(path)?, path, description, reading)
    }

    /// Reads the content of a file; `path` names it in messages.
    pub fn parse(content: impl Read, path: &Path, description: &Description, reading: &Reading) -> Result<Self> {
        // The record of a run is a file of inputs, with its outputs left out.
        let known = [Causality::Input, Causality::Output];
        let accepted: Vec<Column> =
            description.variables().iter().filter(|variable| known.contains(&variable.causality)).map(column).collect();
        let columns::Table { names, times, values, headers, notes, .. } =
            columns::parse(content, path, &accepted, reading)?;
        reading.check(&[&headers])?;
        let has_velocity = names.iter().any(|name| VELOCITIES.contains(&name.as_str()));
        if !has_velocity && description.find(VELOCITIES[0]).is_ok_and(|velocity| velocity.start.parse() == Ok(0.0)) {
            let found = listed(headers.iter().map(String::as_str));
            let [sliding, angular] = VELOCITIES;
            bail!(
                "{} has neither a column {sliding} [m/s] nor {angular} [rad/s]; found are {found}; --column names another one, as \
                 \"shaft=angular_velocity [rpm]\"",
                path.display()
            );
        }
        Ok(Self { source: path.display().to_string(), names, times, values, notes })
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

/// The column of an input: with the units of its row in the table of variables, one of which its header must say.
fn column(variable: &Variable) -> Column {
    let row = variables::find(&variable.name).and_then(variables::lookup).map(|(row, _)| row);
    let unit = units::UNITS.iter().copied().find(|unit| unit.name == variable.unit).unwrap_or(&ONE);
    let absolute = row.is_none_or(|row| !row.is_difference());
    let taken = variable.causality == Causality::Input;
    Column { absolute, unit_required: unit.name != ONE.name, taken, ..Column::optional(&variable.name, unit) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `read` makes of a file with this text, which is removed afterwards.
    fn from_file<T>(name: &str, text: &str, read: impl FnOnce(&Path) -> T) -> T {
        let path = std::env::temp_dir().join(format!("batch-tables-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let read = read(&path);
        std::fs::remove_file(&path).unwrap();
        read
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
        let text = "# a note\npunch.width, level\n0.1, lumped\n0.2,auto\n";
        let table = from_file("design", text, Table::read).unwrap();
        assert_eq!(table.columns, ["punch.width", "level"]);
        assert_eq!(table.rows, [["0.1", "lumped"], ["0.2", "auto"]]);
        let text = "time,normal_load [N],sliding_velocity [km/h]\n0,1,36\n2.5,3e3,72\n";
        let inputs = from_file("inputs", text, |path| Inputs::read(path, &description(), &Reading::strict())).unwrap();
        assert_eq!((inputs.start(), inputs.stop()), (0.0, 2.5));
        assert_eq!(inputs.names, ["normal_load", "sliding_velocity"]);
        assert_eq!(inputs.values, [1.0, 10.0, 3000.0, 20.0]);
        let text = "Zeit [s];Kraft [N];sliding_velocity [km/h];Raum\n0;1;36;20\n2,5;3e3;72;20\n";
        let named = ["Zeit=time", "Kraft=normal_load"].map(|text| text.parse().unwrap()).to_vec();
        let reading = |strict| Reading { columns: named.clone(), strict, python: false };
        let read = |strict| from_file("named", text, |path| Inputs::read(path, &description(), &reading(strict)));
        let found = read(false).unwrap();
        assert_eq!((&found.names, &found.values), (&inputs.names, &inputs.values));
        assert!(found.notes[0].contains("left out are \"Raum\""), "{:?}", found.notes);
        let told = read(true).unwrap_err().to_string();
        assert!(told.contains("--column \"HEADER=VARIABLE\" names another one"), "{told}");
    }

    #[test]
    fn units_of_a_design_are_those_of_scene_files() {
        let text = "punch.width [mm], normal_load.factor [1], level\n40, 50 %, 2\n50 mm, 2, 3 mm\n";
        let converted = from_file("in_units", text, Table::read).unwrap().for_fmu(&description()).unwrap();
        assert_eq!(converted.columns, ["punch.width", "normal_load.factor", "level"]);
        assert_eq!(converted.rows[0].as_ref().unwrap(), &["0.04", "0.5", "2"]);
        assert_eq!(converted.rows[1].as_ref().unwrap(), &["0.05", "2", "3 mm"]);
        for (name, text, wanted) in [
            (
                "wrong",
                "punch.width [kN]\n1\n",
                "column 1 (punch.width [kN]): \"kN\" is the wrong unit; accepted are m, mm",
            ),
            ("factor", "normal_load.factor [kN]\n1\n", "accepted are 1, %"),
            ("same", "punch.width,punch.width [mm]\n1,1\n", "punch.width stands in another column already"),
        ] {
            let table = from_file(name, text, Table::read).unwrap();
            let told = format!("{:#}", table.for_fmu(&description()).unwrap_err());
            assert!(told.contains(wanted), "{told}");
        }
    }

    #[test]
    fn a_design_of_a_spreadsheet_is_the_same() {
        let plain =
            "punch.width [mm],punch.wear_coefficient,solver.fidelity\n1.5,2.5e-5 mm3/(N.m),lumped\n40,1e-15,auto\n";
        let expected = from_file("plain", plain, Table::read).unwrap();
        for (separator, mark) in [(";", ","), ("\t", ","), (";", "."), ("\t", ".")] {
            let text = plain.replace(',', separator).replace("1.5", &format!("1{mark}5"));
            let text = text.replace("2.5e", &format!("2{mark}5e"));
            let read = from_file("spreadsheet", &format!("\u{feff}# Entwürfe\n{text}"), Table::read).unwrap();
            assert_eq!((read.columns, read.rows), (expected.columns.clone(), expected.rows.clone()));
        }
        let thousands = from_file("thousands", "nominal.load;depth\n1,234.5;1,2,3\n", Table::read).unwrap();
        assert_eq!(thousands.rows, [["1,234.5", "1,2,3"]]);
        let long = from_file("long", "a;b\n1;2;3\n", Table::read).unwrap_err();
        assert!(format!("{long:#}").ends_with("3 cells, and the header has 2"), "{long:#}");
    }

    /// A scene that cannot be run is a row of the results, so its fault names the cell.
    #[test]
    fn cells_that_no_scene_can_have_are_told_with_their_place_and_unit() {
        let text = "# a note\npunch.width [mm],normal_load.factor\n40,1\nwide,1\n40 kN,1\n-1,1\n\"1,2\",1\nnan,1\n40,-1\n40,x\n";
        let table = from_file("cells", text, Table::read).unwrap();
        let rows = table.for_fmu(&description()).unwrap().rows;
        assert!(rows[0].is_ok());
        for (row, wanted) in rows[1..].iter().zip([
            "cells.csv, line 4, column 1 (punch.width [mm]): \"wide\" is not a number",
            "line 5, column 1 (punch.width [mm]): \"40 kN\" has the wrong unit \"kN\"; accepted are m, mm",
            "line 6, column 1 (punch.width [mm]): -1 mm is outside the allowed range: from ",
            "line 7, column 1 (punch.width [mm]): \"1,2\" has a comma; numbers have a decimal point",
            "line 8, column 1 (punch.width [mm]): NaN is not a finite number",
            "line 9, column 2 (normal_load.factor): -1 must be 0 or above",
            "line 10, column 2 (normal_load.factor): \"x\" is not a number",
        ]) {
            let told = row.as_ref().unwrap_err();
            assert!(told.contains(wanted), "{told}");
        }
    }

    #[test]
    fn broken_files_are_told_with_the_place() {
        let told = |result: Result<()>| format!("{:#}", result.unwrap_err());
        let table = |name, text| told(from_file(name, text, Table::read).map(drop));
        assert!(table("twice", "a,a\n1,2\n").contains("\"a\""));
        assert!(table("empty", "a,b\n").contains("no row"));
        assert!(table("short", "a,b\n1\n").contains("short.csv"));
        let inputs = |name, text| {
            told(from_file(name, text, |path| Inputs::read(path, &description(), &Reading::strict())).map(drop))
        };
        assert!(inputs("notime", "normal_load [N]\n1\n").contains("no column time"));
        assert!(inputs("word", "time,normal_load [N]\n0,heavy\n").contains("column 2 (normal_load [N]): \"heavy\""));
        assert!(inputs("parameter", "time,punch.width\n0,1\n").contains("accepted are time"));
    }
}
