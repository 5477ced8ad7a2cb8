//! Scene files: the start values of a scene in TOML.
//!
//! ```toml
//! name = "my_brake"
//! description = "What it is"
//!
//! [experiment]            # the default experiment
//! stop = "20 min"         # default: nominal.duration
//! step = 0.1              # default: a thousandth of the duration
//!
//! [punch]
//! material = "brake_lining"
//! width = "55 mm"         # a display unit of the variable, or its SI unit
//! conductivity = 0.9      # a plain number is in the SI unit; explicit keys override the material
//! property_table.material = "structural_steel"  # conductivity and specific heat over temperature, published
//! body = "elastic"        # an enumeration by the name of the item
//!
//! [contact]
//! shear_coupling = false
//! friction_fade.temperature = ["20 degC", "300 degC"]  # a table has as many points as are given, up to those of the FMU
//! friction_fade.factor = [1, 0.8]
//! ```
//!
//! Keys are the names of the variable table's parameters and inputs (inputs: their start values);
//! dotted names are TOML's own tables. A variable that the file does not set keeps the start value of the table.
//! Rules that join parameters are not checked here but by the scene itself.

#![forbid(unsafe_code)]

mod assignment;
pub mod columns;
pub mod division;
pub mod materials;
pub mod nominal;
pub mod property_tables;
pub mod quantity;
pub mod records;
pub mod shipped;
mod suggest;
pub mod unit_names;

pub use assignment::{assign, assign_all};
pub use suggest::nearest;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::materials::MATERIALS;
use crate::property_tables::TABLES;
use scene::message::{Clipped, Quoted};
use scene::slot::{self, Experiment, Packaged, STOCK_EXPERIMENT};
use scene::variables::units::{ONE, SECOND, Unit};
use scene::variables::{COUNT, Causality, Row, STARTS, TABLE, ValueReference, find, reference};

/// Keys of version 0.1 that are gone, and what replaces them.
const FORMER: [(&str, &str); 1] = [(
    "solver.scheme",
    "every run is monolithic, and the schemes of version 0.1 for comparison are gone: leave it out",
)];

/// A scene as read from a file.
#[derive(Clone, PartialEq, Debug)]
pub struct SceneFile {
    /// Name, start values and default experiment.
    pub packaged: Packaged,
    /// Description of the scene; may be empty.
    pub description: String,
    /// The value references that the file or a material preset of it sets, ascending.
    pub given: Vec<ValueReference>,
}

/// One thing wrong with a scene file.
#[derive(Clone, PartialEq, Debug)]
pub struct Problem {
    /// Line, from 1; 0 where the problem is not at one place.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// Full key; empty where the file cannot be read as TOML.
    pub key: String,
    /// The fault, with the value and the accepted alternatives.
    pub reason: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(formatter, "line {}, column {}: ", self.line, self.column)?;
        }
        if !self.key.is_empty() {
            write!(formatter, "{}: ", Clipped(&self.key))?;
        }
        formatter.write_str(&self.reason)
    }
}

/// Everything that is wrong with a scene file, in the order of its lines.
#[derive(Clone, PartialEq, Debug)]
pub struct Problems(pub Vec<Problem>);

impl fmt::Display for Problems {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.0.iter().enumerate() {
            if index > 0 {
                formatter.write_str("\n")?;
            }
            problem.fmt(formatter)?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

/// Reads a scene file.
///
/// # Errors
/// [`Problems`] as of [`parse`], or one that says why the file cannot be read.
pub fn read(path: &Path) -> Result<SceneFile, Problems> {
    match std::fs::read_to_string(path) {
        Ok(text) => parse(&text),
        Err(error) => Err(Problems(vec![Problem {
            line: 0,
            column: 0,
            key: String::new(),
            reason: format!("{} cannot be read: {error}", path.display()),
        }])),
    }
}

/// Reads a scene from the text of a file.
///
/// # Errors
/// All [`Problems`] together: text that is not TOML, unknown, repeated or missing keys, values of the
/// wrong type, unit, range or number, unknown materials and items.
pub fn parse(text: &str) -> Result<SceneFile, Problems> {
    let (scene, preset) = lines(text)?;
    match scene::without_effect(&scene.packaged.starts, &preset) {
        Some(reason) => Err(Problems(vec![Problem { line: 0, column: 0, key: String::new(), reason }])),
        None => Ok(scene),
    }
}

/// A scene from some lines of a file, and the start values with its presets alone.
fn lines(text: &str) -> Result<(SceneFile, [f64; COUNT]), Problems> {
    let mut reader = Reader { text, leaves: BTreeMap::new(), arrays: Vec::new(), problems: Vec::new() };
    match DeTable::parse(text) {
        Ok(table) => reader.flatten("", table.get_ref()),
        Err(error) => {
            let at = error.span().map_or(text.len(), |span| span.start);
            reader.problem(at, "", format!("not TOML: {}", error.message().trim_end().replace('\n', ", ")));
            return Err(Problems(reader.problems));
        }
    }
    let scene = reader.scene();
    if reader.problems.is_empty() {
        Ok(scene)
    } else {
        reader.problems.sort_by_key(|problem| (problem.line, problem.column));
        Err(Problems(reader.problems))
    }
}

/// A value of the file and where it stands.
struct Leaf<'text> {
    at: usize,
    value: Spanned<DeValue<'text>>,
}

struct Reader<'text> {
    text: &'text str,
    leaves: BTreeMap<String, Leaf<'text>>,
    /// Place, name and number of elements of the arrays that are given.
    arrays: Vec<(usize, String, usize)>,
    problems: Vec<Problem>,
}

impl<'text> Reader<'text> {
    fn problem(&mut self, at: usize, key: &str, reason: String) {
        let before = &self.text[..at.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&symbol| symbol != '\n').count() + 1;
        self.problems.push(Problem { line, column, key: key.to_owned(), reason });
    }

    fn flatten(&mut self, prefix: &str, table: &DeTable<'text>) {
        for (key, value) in table {
            let at = key.span().start;
            let name =
                if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
            if let DeValue::Table(inner) = value.get_ref()
                && row_called(&name).is_none()
            {
                self.flatten(&name, inner);
            } else if self.leaves.insert(name.clone(), Leaf { at, value: value.clone() }).is_some() {
                // TOML itself refuses a repeated key, but not `"a.b"` beside `a.b`.
                self.problem(at, &name, "is given more than once".into());
            }
        }
    }

    /// Converts with `convert`, recording the reason where it fails.
    fn take<T>(&mut self, key: &str, convert: impl FnOnce(&DeValue<'text>) -> Result<T, String>) -> Option<T> {
        let leaf = self.leaves.remove(key)?;
        match convert(leaf.value.get_ref()) {
            Ok(value) => Some(value),
            Err(reason) => {
                self.problem(leaf.value.span().start, key, reason);
                None
            }
        }
    }

    fn scene(&mut self) -> (SceneFile, [f64; COUNT]) {
        let named = self.leaves.contains_key("name");
        let name = self.take("name", text_of);
        if !named {
            self.problem(0, "name", "is missing: a letter, then letters, digits and underscores".into());
        }
        let description = self.take("description", xml_text_of).unwrap_or_default();
        let mut starts = STARTS;
        let mut given = Vec::new();
        for body in ["punch", "strip"] {
            let key = format!("{body}.material");
            if let Some(material) = self.take(&key, material_of) {
                for (property, value) in material.values() {
                    if let Some(reference) = find(&format!("{body}.{property}")) {
                        starts[reference as usize] = value;
                        given.push(reference);
                    }
                }
            }
        }
        for body in ["punch", "strip"] {
            let key = format!("{body}.property_table.material");
            if let Some(table) = self.take(&key, property_table_of) {
                for (property, value) in table.values() {
                    if let Some(reference) = find(&format!("{body}.{property}")) {
                        starts[reference as usize] = value;
                        given.push(reference);
                    }
                }
            }
        }
        let preset = starts;
        let experiment = self.experiment(&mut starts, &mut given);
        for (key, leaf) in std::mem::take(&mut self.leaves) {
            self.variable(&key, &leaf, &mut starts, &mut given);
        }
        self.tables(&mut starts, &mut given);
        given.sort_unstable();
        given.dedup();
        let packaged = Packaged { name: name.unwrap_or_default(), starts, experiment };
        if self.problems.is_empty()
            && let Err(reason) = slot::check(&packaged)
        {
            self.problems.push(Problem { line: 0, column: 0, key: String::new(), reason });
        }
        (SceneFile { packaged, description, given }, preset)
    }

    fn experiment(&mut self, starts: &mut [f64; COUNT], given: &mut Vec<ValueReference>) -> Experiment {
        const DURATION: &str = "nominal.duration";
        if let Some(leaf) = self.leaves.remove(DURATION) {
            self.variable(DURATION, &leaf, starts, given);
        }
        let mut real = |key: &str, unit: &'static Unit| self.take(key, |value| quantity::real(value, unit, true));
        let start = real("experiment.start", &SECOND).unwrap_or(0.0);
        let stop = real("experiment.stop", &SECOND).unwrap_or(start + starts[reference(DURATION) as usize]);
        Experiment {
            start,
            stop,
            step: real("experiment.step", &SECOND).unwrap_or((stop - start) / 1000.0),
            tolerance: real("experiment.tolerance", &ONE).unwrap_or(STOCK_EXPERIMENT.tolerance),
        }
    }

    /// Joins the arrays of a table, which has as many points as they have elements: their number where the FMU has one, else further
    /// elements, over which the table is constant. An array that is given alone leaves the number of points.
    fn tables(&mut self, starts: &mut [f64; COUNT], given: &mut Vec<ValueReference>) {
        let arrays = std::mem::take(&mut self.arrays);
        let length = |name: &str| arrays.iter().find(|(_, key, _)| key == name).map(|(.., elements)| *elements);
        let table_of = |name: &str| name.rsplit_once('.').map(|(table, _)| table.to_owned());
        let mut completed = Vec::new();
        for (at, key, elements) in &arrays {
            let Some((first, row)) = row_called(key).filter(|(_, row)| row.may_be_shorter) else { continue };
            let Some(table) = table_of(key) else { continue };
            let mut beside =
                TABLE.iter().filter(|other| other.may_be_shorter && table_of(other.name) == Some(table.clone()));
            let other = beside.find(|other| length(other.name) != Some(*elements));
            if let Some((points, row)) = row_called(&format!("{table}.points")) {
                let wanted = starts[points as usize];
                match other.map(|other| (other.name, length(other.name))) {
                    _ if given.contains(&points) => {
                        if (*elements as f64) < wanted {
                            self.problem(*at, key, format!("has {elements} elements, but {} = {wanted}", row.name));
                        }
                    }
                    None => {
                        starts[points as usize] = *elements as f64;
                        completed.push(points);
                    }
                    Some((name, Some(others))) => {
                        self.problem(*at, key, format!("has {elements} elements, but {name} has {others}"));
                    }
                    Some((_, None)) => {}
                }
            } else if *elements < row.elements as usize {
                if let Some(other) = other {
                    let reason = format!(
                        "has {elements} elements, but must have {}, or as many as {}",
                        row.elements, other.name
                    );
                    self.problem(*at, key, reason);
                    continue;
                }
                let last = first + *elements as ValueReference - 1;
                let rise = if row.name.ends_with(".temperature") { 1.0 } else { 0.0 };
                for element in last + 1..first + row.elements {
                    starts[element as usize] = starts[last as usize] + rise * f64::from(element - last);
                    completed.push(element);
                }
            }
        }
        given.extend(completed);
    }

    fn variable(&mut self, key: &str, leaf: &Leaf, starts: &mut [f64; COUNT], given: &mut Vec<ValueReference>) {
        let Some((first, row)) = row_called(key) else {
            let former = FORMER.iter().find(|(name, _)| *name == key);
            let hint = former.map_or_else(|| suggest::nearest(key, known_keys()), |(_, hint)| format!("; {hint}"));
            let reason = format!("there is no such key{hint}");
            return self.problem(leaf.at, key, reason);
        };
        if !matches!(row.causality, Causality::Parameter | Causality::Input) {
            let near = suggest::nearest(key, known_keys());
            return self.problem(leaf.at, key, format!("is calculated by the FMU and cannot be given{near}"));
        }
        let mut store = |element: u32, value: &Spanned<DeValue>| match quantity::value(value.get_ref(), row) {
            Ok(value) => {
                starts[(first + element) as usize] = value;
                given.push(first + element);
                None
            }
            Err(reason) => Some((value.span().start, row.element_name(element), reason)),
        };
        let problems: Vec<(usize, String, String)> = match (row.elements, leaf.value.get_ref()) {
            (0, _) => store(0, &leaf.value).into_iter().collect(),
            (count, DeValue::Array(elements))
                if elements.len() == count as usize
                    || row.may_be_shorter && (1..count as usize).contains(&elements.len()) =>
            {
                self.arrays.push((leaf.value.span().start, key.to_owned(), elements.len()));
                (0..count).zip(elements.iter()).filter_map(|(element, value)| store(element, value)).collect()
            }
            (count, DeValue::Array(elements)) => {
                let most = if row.may_be_shorter { "1 to " } else { "" };
                let reason = format!("has {} elements, but must have {most}{count}", elements.len());
                vec![(leaf.value.span().start, key.to_owned(), reason)]
            }
            (count, other) => {
                let reason = format!("is {}, but must be an array of {count} elements", quantity::type_of(other));
                vec![(leaf.value.span().start, key.to_owned(), reason)]
            }
        };
        for (at, key, reason) in problems {
            self.problem(at, &key, reason);
        }
    }
}

fn row_called(name: &str) -> Option<(ValueReference, &'static Row)> {
    let mut first = 0;
    for row in TABLE {
        if row.name == name {
            return Some((first, row));
        }
        first += row.count();
    }
    None
}

fn known_keys() -> impl Iterator<Item = &'static str> {
    let special = [
        "name",
        "description",
        "experiment.start",
        "experiment.stop",
        "experiment.step",
        "experiment.tolerance",
        "punch.material",
        "strip.material",
        "punch.property_table.material",
        "strip.property_table.material",
    ];
    let variables =
        TABLE.iter().filter(|row| matches!(row.causality, Causality::Parameter | Causality::Input)).map(|row| row.name);
    special.into_iter().chain(variables)
}

fn text_of(value: &DeValue) -> Result<String, String> {
    match value {
        DeValue::String(text) => Ok(text.to_string()),
        other => Err(format!("is {}, but must be a string", quantity::type_of(other))),
    }
}

/// A text that the modelDescription can hold: XML 1.0 has no control characters but tab and line ends.
fn xml_text_of(value: &DeValue) -> Result<String, String> {
    let text = text_of(value)?;
    let refused = |c: &char| c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}');
    match text.chars().find(refused) {
        Some(found) => Err(format!(
            "has the character U+{:04X}, which XML cannot hold; of the control characters only tab and line ends are allowed",
            u32::from(found)
        )),
        None => Ok(text),
    }
}

fn material_of(value: &DeValue) -> Result<&'static materials::Material, String> {
    let name = text_of(value)?;
    materials::find(&name).ok_or_else(|| {
        let known: Vec<&str> = MATERIALS.iter().map(|material| material.name).collect();
        format!("there is no material {}; known are {}", Quoted(&name), known.join(", "))
    })
}

fn property_table_of(value: &DeValue) -> Result<&'static property_tables::Tabulated, String> {
    let name = text_of(value)?;
    property_tables::find(&name).ok_or_else(|| {
        let known: Vec<&str> = TABLES.iter().map(|table| table.name).collect();
        format!("there is no property table of {}; known are {}", Quoted(&name), known.join(", "))
    })
}

#[cfg(test)]
mod tests;
