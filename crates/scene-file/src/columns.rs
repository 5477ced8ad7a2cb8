//! CSV files of quantities over time: columns are known by their names, values come out in SI units.
//!
//! A column's header is the name of a quantity, alone (then in its SI unit), with a unit in brackets
//! (`sliding_velocity [km/h]`) or with a unit spelled behind it (`speed_km_per_h`). Lines that begin with `#` are notes. A first column
//! without a name that numbers the rows is left out: pandas writes one, and calls it `Unnamed: 0` when it reads it.

use crate::unit_names::canonical;
use crate::{division, nearest, quantity};
use anyhow::{Context, Result, anyhow, bail, ensure};
use scene::message::{Clipped, Quoted, listed};
use scene::variables::units::{ONE, SECOND, Unit};
use scene::variables::{Causality, Kind, Row, TABLE};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Name of the column that every file must have.
const TIME: &str = "time";

/// Most columns that a message lists.
const LISTED: usize = 12;

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
}

impl Column {
    /// An optional column, in the SI unit where the header says none.
    pub fn optional(name: &str, unit: &'static Unit) -> Self {
        Self { name: name.to_owned(), unit, absolute: true, required: false, unit_required: false, taken: true }
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

    /// The column of the numbers of trips, which a file of inputs may have beside [`Column::inputs`].
    pub fn trip() -> Self {
        Self::optional("trip", &ONE)
    }

    /// The headers that are accepted, for messages.
    fn headers(&self) -> String {
        let others = quantity::units(self.unit, self.absolute).map(|display| display.name);
        let units: Vec<&str> = std::iter::once(self.unit.name).chain(others).collect();
        let alone = if self.unit_required { String::new() } else { format!("{} or ", self.name) };
        format!("{alone}{} [{}]", self.name, units.join(" or "))
    }

    /// The unit that a header says of this quantity; `None` where it is another quantity's header.
    fn unit_of<'a>(&self, header: &'a str) -> Option<Said<'a>> {
        let rest = header.strip_prefix(self.name.as_str())?;
        if rest.is_empty() {
            return Some(Said::Nothing);
        }
        if let Some(symbol) = rest.trim_start().strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            // Several columns that no comma separates are none.
            if symbol.contains(['[', ']']) {
                return None;
            }
            return Some(Said::Symbol(symbol.trim()));
        }
        let spelled = rest.strip_prefix('_')?;
        let others = quantity::units(self.unit, self.absolute).map(|display| display.name);
        std::iter::once(self.unit.name)
            .chain(others)
            .find(|symbol| spell(symbol) == spelled || *symbol == canonical(spelled))
            .map(Said::Symbol)
    }
}

/// Unit given in a header.
enum Said<'a> {
    Nothing,
    Symbol(&'a str),
}

/// A unit as part of a name: `m_per_s` for `m/s`.
fn spell(symbol: &str) -> String {
    symbol.replace('/', "_per_").replace('.', "_").replace(['(', ')'], "")
}

/// Quantities over time, in SI units.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// The file.
    pub path: PathBuf,
    /// Time of every row, s, strictly increasing.
    pub times: Vec<f64>,
    /// Quantities, in the order of the file, without the time.
    pub names: Vec<String>,
    /// Row by row, `names.len()` values each.
    pub values: Vec<f64>,
    /// Line of the file that every row stands in.
    pub lines: Vec<u64>,
    /// Known quantities of the file that are not taken.
    pub left_out: Vec<String>,
}

impl Table {
    /// The values of a quantity, where the file has it.
    pub fn column(&self, name: &str) -> Option<impl Iterator<Item = f64>> {
        let at = self.names.iter().position(|own| own == name)?;
        Some(self.values.iter().skip(at).step_by(self.names.len()).copied())
    }

    /// The same quantities, linear between their rows, at the communication points of [`division::points`].
    pub fn divided(&self) -> Self {
        let width = self.names.len();
        let columns: Vec<Vec<f64>> =
            (0..width).map(|at| self.values.iter().skip(at).step_by(width).copied().collect()).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let mut divided = Self { times: Vec::new(), values: Vec::new(), lines: Vec::new(), ..self.clone() };
        for time in division::points(&self.times, &columns) {
            let after = self.times.partition_point(|own| *own < time);
            let before = after.saturating_sub(1);
            let part = if self.times[after] == time {
                1.0
            } else {
                (time - self.times[before]) / (self.times[after] - self.times[before])
            };
            let value = |column: &&[f64]| {
                if part == 1.0 { column[after] } else { column[before] + part * (column[after] - column[before]) }
            };
            divided.times.push(time);
            divided.values.extend(columns.iter().map(value));
            divided.lines.push(self.lines[after]);
        }
        divided
    }
}

/// Reads a file with the time and some of the `accepted` quantities.
///
/// # Errors
/// Names file, line, column and value: where the file cannot be read, has no row, a required column is missing, a column
/// is not accepted or stands twice, or it has a unit that does not fit, a cell that is no finite number, or a time that does not
/// increase.
pub fn read(path: &Path, accepted: &[Column]) -> Result<Table> {
    parse(open(path)?, path, accepted)
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
pub fn parse(content: impl Read, path: &Path, accepted: &[Column]) -> Result<Table> {
    let time = Column { required: true, ..Column::optional(TIME, &SECOND) };
    let known: Vec<&Column> = std::iter::once(&time).chain(accepted).collect();
    let (mut times, mut values, mut lines) = (Vec::<f64>::new(), Vec::new(), Vec::new());
    let [names, left_out] = rows(content, path, &known, &mut |cells| {
        for cell in cells {
            if cell.name != TIME {
                values.push(cell.value);
                continue;
            }
            if let Some(last) = times.last().filter(|last| cell.value <= **last) {
                let place = cell.place();
                bail!("{place}: the time must increase from row to row, and was {last} s in the row before");
            }
            times.push(cell.value);
        }
        lines.extend(cells.first().map(|cell| cell.line));
        Ok(())
    })?;
    let names = names.into_iter().filter(|name| name != TIME).collect();
    Ok(Table { path: path.to_owned(), times, names, values, lines, left_out })
}

/// A cell of a row.
pub(crate) struct Cell<'a> {
    /// Name of its quantity.
    pub(crate) name: &'a str,
    /// Its value in the SI unit.
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

/// Gives the rows of a file of `known` quantities to `take`, one after the other; returns those that are
/// taken and those that are not, in the order of the file.
///
/// # Errors
/// As [`read`], and those of `take`.
pub(crate) fn rows(
    content: impl Read,
    path: &Path,
    known: &[&Column],
    take: &mut dyn FnMut(&[Cell<'_>]) -> Result<()>,
) -> Result<[Vec<String>; 2]> {
    let file = path.display();
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(content);
    let headers = whole(reader.headers().cloned(), path)?;
    let line = headers.position().map_or(1, csv::Position::line);
    if headers.is_empty() {
        let first = known.first().map_or_else(String::new, |column| format!("{} [{}]", column.name, column.unit.name));
        bail!("{file} is empty; its first line must name the columns, as {first}");
    }
    let mut found: Vec<Found> = Vec::with_capacity(headers.len());
    for (at, header) in headers.iter().enumerate() {
        let of = if at == 0 && ["", "Unnamed: 0"].contains(&header) {
            Ok(Found::row_number())
        } else {
            Found::of(header, known)
        };
        let column = of.map_err(|wrong| anyhow!("{file}, line {line}, column {}: {wrong}", at + 1))?;
        if let Some(twice) = found.iter().position(|other| other.name == column.name) {
            bail!("{file}, line {line}, column {}: {} stands in column {} already", at + 1, column.name, twice + 1);
        }
        found.push(column);
    }
    if let Some(missing) = known.iter().find(|known| known.required && found.iter().all(|own| own.name != known.name)) {
        bail!("{file}, line {line}: no column {}; found are {}", missing.headers(), listed(headers.iter()));
    }
    let mut is_empty = true;
    for record in reader.records() {
        let record = whole(record, path)?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut cells = Vec::with_capacity(found.len());
        for (at, (text, column)) in record.iter().zip(&found).enumerate() {
            let mut cell =
                Cell { name: &column.name, value: f64::NAN, path, line, column: at + 1, header: &headers[at], text };
            let number: f64 = text.parse().ok().with_context(|| {
                format!("{} {}", cell.place(), quantity::decimal_comma(text).unwrap_or("is no number"))
            })?;
            cell.value = quantity::in_si(number, column.symbol, column.unit, column.absolute)
                .map_err(|wrong| anyhow!("{}: {wrong}", cell.place()))?;
            if column.name.is_empty() && number.fract() != 0.0 {
                bail!("{} is no number of a row, and its column has no name", cell.place());
            }
            if column.taken {
                cells.push(cell);
            }
        }
        take(&cells)?;
        is_empty = false;
    }
    if is_empty {
        bail!("{file} has no row below its header");
    }
    let of = |taken: bool| {
        found.iter().filter(|own| own.taken == taken && !own.name.is_empty()).map(|own| own.name.clone()).collect()
    };
    Ok([of(true), of(false)])
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
struct Found<'a> {
    name: String,
    symbol: &'a str,
    unit: &'static Unit,
    absolute: bool,
    taken: bool,
}

impl<'a> Found<'a> {
    /// A column without a name that numbers the rows.
    fn row_number() -> Self {
        Self { name: String::new(), symbol: ONE.name, unit: &ONE, absolute: true, taken: false }
    }

    /// # Errors
    /// The fault of the header, and the accepted headers.
    fn of(header: &'a str, known: &[&Column]) -> Result<Self, String> {
        let Some((column, said)) = known.iter().find_map(|column| Some((column, column.unit_of(header)?))) else {
            return Err(format!(
                "{} is not a known quantity with a known unit; {}",
                Quoted(header),
                alternatives(header, known)
            ));
        };
        let symbol = match said {
            Said::Nothing if column.unit_required => {
                return Err(format!("{} does not say its unit; accepted is {}", Quoted(header), column.headers()));
            }
            Said::Nothing => column.unit.name,
            Said::Symbol(symbol) => symbol,
        };
        quantity::in_si(0.0, symbol, column.unit, column.absolute)
            .map_err(|wrong| format!("{}: {wrong}", Quoted(header)))?;
        let Column { name, unit, absolute, taken, .. } = column;
        Ok(Self { name: name.clone(), symbol, unit, absolute: *absolute, taken: *taken })
    }
}

/// The accepted headers; of many those near the given one.
fn alternatives(header: &str, known: &[&Column]) -> String {
    if let Err(separated) = check_separator(&csv::StringRecord::from(vec![header])) {
        return separated;
    }
    let name = header.split('[').next().unwrap_or(header).trim();
    let wrong_unit = known.iter().find(|column| column.name == name);
    let known: Vec<&&Column> = known.iter().filter(|column| column.taken || wrong_unit.is_some()).collect();
    if known.len() <= LISTED || wrong_unit.is_some() {
        let listed = known.iter().filter(|column| wrong_unit.is_none_or(|own| own.name == column.name));
        let near = match wrong_unit {
            Some(_) => String::new(),
            None => nearest(name, known.iter().map(|column| column.name.as_str())),
        };
        return format!("accepted are {}{near}", listed.map(|column| column.headers()).collect::<Vec<_>>().join(", "));
    }
    let example: Vec<String> = known.iter().take(2).map(|column| column.headers()).collect();
    let near = nearest(name, known.iter().map(|column| column.name.as_str()));
    format!("accepted are the time, inputs and outputs of the FMU by their names, as {}{near}", example.join(", "))
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
        let result = read(&path, &accepted());
        std::fs::remove_file(&path).unwrap();
        result
    }

    #[test]
    fn the_record_of_a_run_is_read_as_inputs_with_or_without_the_index_of_pandas() {
        let parsed = |text: &str| parse(text.as_bytes(), Path::new("run.csv"), &Column::inputs());
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
            (run.replace("wear_depth", "wear_dept"), "is not a known quantity"),
        ] {
            let message = parsed(&text).unwrap_err().to_string();
            assert!(message.contains(told), "{message}");
        }
    }

    #[test]
    fn divided_rows_lie_on_the_lines_between_the_given_ones() {
        let given = table("divided", "time,speed [m/s],normal_load\n0,10,5\n8,0,5\n800,0,0\n").unwrap();
        let divided = given.divided();
        let (speed, load) = (divided.column("speed").unwrap(), divided.column("normal_load").unwrap());
        for ((time, speed), load) in divided.times.iter().zip(speed).zip(load) {
            let exact = if *time <= 8.0 { [10.0 - 1.25 * time, 5.0] } else { [0.0, 5.0 - 5.0 * (time - 8.0) / 792.0] };
            assert!((speed - exact[0]).abs() < 1e-12 && (load - exact[1]).abs() < 1e-12, "{time} s: {speed} {load}");
        }
        assert!(
            divided.times.iter().filter(|time| **time < 8.0).count() >= 20
                && divided.lines.len() == divided.times.len()
        );
        assert_eq!((divided.lines[1], divided.lines.last()), (3, Some(&4)));
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
            ("missing", "time,normal_load\n0,1\n", "no column speed [m/s or km/h or mm/s or m/min or cm/s]"),
            ("unknown", "time,velocity\n0,1\n", "line 1, column 2: \"velocity\" is not a known"),
            ("unknown", "time,velocity\n0,1\n", "accepted are time or time [s or min or h or ms], speed [m/s or km/h"),
            ("bare", "time,speed\n0,1\n", "column 2: \"speed\" does not say its unit; accepted is speed [m/s"),
            ("unit", "time,speed [mph]\n0,1\n", "\"mph\" is the wrong unit; accepted are m/s, km/h, mm/s"),
            ("difference", "time,speed [m/s],offset [degC]\n0,1,2\n", "accepted are K"),
            ("twice", "time,speed_m_per_s,speed [km/h]\n0,1,2\n", "column 3: speed stands in column 2 already"),
            ("word", "time,speed_m_per_s\n0,1\n1,fast\n", "line 3, column 2 (speed_m_per_s): \"fast\" is no number"),
            ("empty", "time,speed_m_per_s\n0,\n", "line 2, column 2 (speed_m_per_s): \"\" is no number"),
            ("infinite", "time,speed_m_per_s\n0,nan\n", "\"nan\": NaN is not a finite number"),
            (
                "beyond",
                "time,speed_m_per_s,normal_load [kN]\n0,1,1e306\n",
                "\"1e306\": 1e306 kN is no finite number in the SI unit",
            ),
            ("back", "time,speed_m_per_s\n0,1\n1,1\n1,1\n", "line 4, column 1 (time): \"1\": the time must increase"),
            ("none", "time,speed_m_per_s\n", "has no row"),
            ("nothing", "", "is empty; its first line must name the columns"),
            ("notes", "# nothing\n", "is empty"),
            ("semicolons", "time;speed_m_per_s\n0;1\n", "columns are separated by commas, and this header has ';'"),
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
