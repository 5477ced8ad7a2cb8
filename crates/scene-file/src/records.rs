//! End values of wear tests at constant load and speed: one row for every test, for fits.

use crate::columns::{self, Column, Reading, Table};
use anyhow::{Context, Result, anyhow, bail};
use scene::variables::TABLE;
use scene::variables::units::{CUBIC_METRE, METRE, METRE_PER_SECOND, NEWTON, Unit};
use std::io::Read;
use std::path::Path;

/// Conditions of a test, each of which a file must have with its unit.
const CONDITIONS: [(&str, &Unit); 3] = [("load", &NEWTON), ("speed", &METRE_PER_SECOND), ("distance", &METRE)];

/// The volume that the punch lost, by its short name.
const VOLUME: &str = "volume";

/// The variable that [`VOLUME`] stands for.
const WORN: &str = "wear_volume_punch";

/// Tests at constant load and speed, one value each.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Records {
    /// Normal load, N.
    pub load: Vec<f64>,
    /// Sliding speed [m/s].
    pub speed: Vec<f64>,
    /// Sliding distance, m.
    pub distance: Vec<f64>,
    /// Outputs at the end of the distance, by name and in SI units; NaN where a test has none.
    pub values: Vec<(String, Vec<f64>)>,
    /// Headers of the file.
    pub headers: Vec<String>,
    /// Notes of [`columns::Table`].
    pub notes: Vec<String>,
}

impl Records {
    /// Reads a file.
    ///
    /// # Errors
    /// Names file, line, column and value: as [`columns::read`], where a condition or a worn volume is not above 0, and where there is no
    /// output.
    pub fn read(path: &Path, reading: &Reading) -> Result<Self> {
        Self::parse(columns::open(path)?, path, reading)
    }

    /// Reads the content of a file; `path` names it in messages.
    pub(crate) fn parse(content: impl Read, path: &Path, reading: &Reading) -> Result<Self> {
        let conditions = CONDITIONS.map(|(name, unit)| Column {
            required: true,
            unit_required: true,
            ..Column::optional(name, unit)
        });
        let volume = Column { unit_required: true, ..Column::optional(VOLUME, &CUBIC_METRE) };
        let results = TABLE.iter().filter(|row| row.is_result() && row.name != "sliding_distance");
        let results: Vec<Column> = results.filter_map(Column::of).collect();
        let known: Vec<&Column> = conditions.iter().chain([&volume]).chain(&results).collect();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let read = columns::rows(content, path, &known, reading, &mut |cells| {
            for cell in cells {
                let is_condition = CONDITIONS.iter().any(|(name, _)| *name == cell.name);
                let must_be_positive = is_condition || [VOLUME, WORN].contains(&cell.name);
                // A gap is no condition either.
                if must_be_positive && (cell.value <= 0.0 || is_condition && cell.value.is_nan()) {
                    bail!("{}: a test has a {} above 0", cell.place(), cell.name);
                }
            }
            rows.push(cells.iter().map(|cell| cell.value).collect());
            Ok(())
        })?;
        let mut records = Self { headers: read.headers, notes: read.notes, ..Self::default() };
        for (at, name) in read.taken.iter().enumerate() {
            let values = rows.iter().map(|row| row[at]).collect();
            match name.as_str() {
                "load" => records.load = values,
                "speed" => records.speed = values,
                "distance" => records.distance = values,
                VOLUME => records.values.push((WORN.to_owned(), values)),
                _ => records.values.push((name.clone(), values)),
            }
        }
        let file = path.display();
        if records.values.is_empty() {
            let notes: String = records.notes.iter().map(|note| format!("; {note}")).collect();
            bail!("{file}: no column of a result, as volume [mm3] or contact_temperature [degC]{notes}");
        }
        if [VOLUME, WORN].iter().all(|name| read.taken.iter().any(|own| own == name)) {
            bail!("{file}: {VOLUME} is {WORN} too; one column has it");
        }
        Ok(records)
    }
}

/// What a file of tests holds.
pub enum Tests {
    /// A row for every test.
    EndValues(Records),
    /// One test over time, its inputs and outputs.
    History(Table),
}

impl Tests {
    /// Headers of the file.
    pub fn headers(&self) -> &[String] {
        match self {
            Self::EndValues(records) => &records.headers,
            Self::History(table) => &table.headers,
        }
    }

    /// Reads a file.
    pub fn read(path: &Path, reading: &Reading) -> Result<Self> {
        let mut content = Vec::new();
        columns::open(path)?.read_to_end(&mut content).with_context(|| format!("reading {}", path.display()))?;
        Self::parse(&content, path, reading)
    }

    /// Reads the content of a file: a history where it has a column for the time.
    ///
    /// # Errors
    /// As [`columns::read`] and [`Records::read`]; a file with neither the time nor load, speed and distance.
    pub fn parse(content: &[u8], path: &Path, reading: &Reading) -> Result<Self> {
        let untimed = match columns::parse(content, path, &Column::record(), reading) {
            Ok(history) => return Ok(Self::History(history)),
            // A column may be named as a quantity of end values alone.
            Err(wrong) if !columns::lacks_column(&wrong) && reading.columns.is_empty() => return Err(wrong),
            Err(wrong) => wrong,
        };
        let lenient = Reading { strict: false, ..reading.clone() };
        Records::parse(content, path, reading).map(Self::EndValues).map_err(|wrong| {
            let hint =
                "the history of a test has time [s], end values of tests have load [N], speed [m/s] and distance [m]";
            match [&untimed, &wrong].map(columns::lacks_column) {
                [true, true] if columns::has_candidate(&untimed) => anyhow!("{untimed}; {hint}"),
                [true, true] => anyhow!("{wrong}; {hint}"),
                // With a column that is refused alone it is a history.
                [false, false] if columns::parse(content, path, &Column::record(), &lenient).is_ok() => untimed,
                [_, false] => wrong,
                [false, true] => untimed,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_with_a_time_is_a_history_and_else_holds_end_values() {
        let read = |text: &str| Tests::parse(text.as_bytes(), Path::new("tests.csv"), &Reading::default());
        let history = read("Time [s],Load [N],Distance [m],Temp. [°C]\n0,5,0,20\n1,5,1,21\n");
        assert!(matches!(history, Ok(Tests::History(table)) if table.times == [0.0, 1.0]));
        let ends = read("Load [N],Speed [m/s],Distance [m],Temp. [°C]\n5,1,1,21\n");
        assert!(matches!(ends, Ok(Tests::EndValues(records)) if records.load == [5.0]));
        let neither = read("a,b\n1,2\n").err().unwrap().to_string();
        assert!(
            neither.contains("no column load") && neither.contains("the history of a test has time [s]"),
            "{neither}"
        );
    }

    #[test]
    fn a_history_with_columns_of_other_names_is_refused_for_what_is_not_known() {
        let columns = ["Zeit=time", "Kraft=normal_load"].map(|text| text.parse().unwrap()).to_vec();
        let reading = Reading { columns, strict: true, python: false };
        let told =
            Tests::parse(b"Zeit [s];Kraft [N];COF;Raum\n0;5;0,4;20\n1;5;0,4;21\n", Path::new("rig.csv"), &reading);
        let told = told.err().unwrap().to_string();
        assert!(told.starts_with("rig.csv, line 1, column 4: \"Raum\" is not a known quantity"), "{told}");
    }

    fn records(text: &str) -> Result<Records> {
        Records::parse(text.as_bytes(), Path::new("tests.csv"), &Reading::default())
    }

    #[test]
    fn records_come_in_si_units() {
        let found =
            records("# a rig\nload [kN],distance [km],speed_m_per_s,volume [mm3]\n0.01,0.3,0.1,2\n0.02,1,0.1,5\n");
        let found = found.unwrap();
        assert_eq!((found.load, found.distance), (vec![10.0, 20.0], vec![300.0, 1000.0]));
        assert_eq!((found.speed[0], found.values[0].1[1]), (0.1, 5e-9));
    }

    #[test]
    fn other_end_values_stand_beside_the_volume_with_their_gaps() {
        let found =
            records("Load [N];Speed [m/s];Distance [m];Temp. [°C];COF\n5;0,1;300;30;\n10;0,1;300;;0,45\n").unwrap();
        assert_eq!(found.values.len(), 2);
        let (name, values) = &found.values[0];
        assert!(name == "contact_temperature" && values[0] == 303.15 && values[1].is_nan(), "{values:?}");
        assert_eq!((found.values[1].0.as_str(), found.values[1].1[1]), ("friction_coefficient", 0.45));
    }

    #[test]
    fn conditions_and_results_have_the_names_of_rigs() {
        for (header, wear) in [
            ("Normal load [N];Sliding speed (m/s);Sliding distance [m];Pin wear [\u{b5}m]", "wear_depth_punch"),
            ("Normalkraft [N];Gleitgeschwindigkeit [m/s];Gleitweg [m];Stiftverschlei\u{df} [mm\u{b3}]", WORN),
            ("Fn [N];v / m/s;Weg [m];Verschlei\u{df} Scheibe [mg]", "wear_mass_strip"),
        ] {
            let found = records(&format!("{header}\n8;0,12;500;1,5\n16;0,12;500;NaN\n")).unwrap();
            assert_eq!((found.load[1], found.speed[0], found.distance[0]), (16.0, 0.12, 500.0), "{header}");
            assert_eq!(found.values[0].0, wear, "{header}");
        }
    }

    #[test]
    fn a_worn_volume_is_of_a_body_that_the_file_names() {
        let head = "Load [N],Speed [m/s],Distance [m],";
        let found = records(&format!("{head}Pin wear [mm3]\n5,.1,300,2\n")).unwrap();
        assert_eq!(found.values, [(WORN.to_owned(), vec![2e-9])]);
        assert_eq!(records(&format!("{head}Volume (mm3)\n5,.1,300,2\n")).unwrap().values, found.values);
        for (columns, told) in [
            ("Wear volume [mm3]\n5,.1,300,2\n", "\"Wear volume [mm3]\" (wear_volume_punch or wear_volume_strip?)"),
            ("volume [mm3],Pin wear [mm3]\n5,.1,300,2,2\n", "volume is wear_volume_punch too"),
        ] {
            let error = records(&format!("{head}{columns}")).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
    }

    #[test]
    fn a_wrong_record_is_refused_with_its_place() {
        let head = "load [N],speed [m/s],distance [m],volume [mm3]\n";
        for (text, parts) in [
            (String::new(), &["tests.csv is empty", "load [N]"][..]),
            (head.to_owned(), &["no row"]),
            (head.replace("[N]", "[m/s]"), &["line 1, column 1", "\"m/s\"", "accepted are N, kN"]),
            (head.replace("load", "force"), &["line 1", "no column load [N or kN or mN]", "force [N]"]),
            (format!("{}5,.1,300\n", head.replace(",volume [mm3]", "")), &["no column of a result, as volume [mm3]"]),
            (format!("{head}5,.1,300,1\nheavy,.1,300,1\n"), &["line 3, column 1 (load [N]): \"heavy\" is no number"]),
            (format!("{head}5,.1,300,0\n"), &["line 2, column 4 (volume [mm3]): \"0\"", "above 0"]),
            (format!("{head}5,,300,1\n"), &["line 2, column 2 (speed [m/s]): \"\"", "above 0"]),
            (format!("{head}5,.1,300\n"), &["tests.csv, line 2: 3 cells, and the header has 4"]),
        ] {
            let error = format!("{:#}", records(&text).unwrap_err());
            assert!(parts.iter().all(|part| error.contains(part)), "{text}: {error}");
        }
    }
}
