//! The FMU's variables: one table, from which everything else is generated.
//!
//! [`TABLE`] is the only definition of a variable's name, causality, variability, unit, start, bounds,
//! nominal value and description. The XML, the C dispatch, the documentation page, the scene
//! file and the GUID are derived from it. A wrong row (a duplicate name, a start out of range, a combination of
//! causality, variability and initial that FMI 2.0 forbids) does not compile: see [`check`].
//!
//! A value reference is the position of the element in the flattened table, the same number space
//! for every type, so that a reference of the wrong type is detected.

mod check;
mod rows;
pub mod types;
pub mod units;

use crate::message;
pub use rows::TABLE;
use std::sync::LazyLock;
use types::RealType;
use units::Unit;

/// Position of one scalar variable in the flattened table; the FMI value reference.
pub type ValueReference = u32;

/// Highest order of the output derivatives that are offered; as `maxOutputDerivativeOrder` in the XML.
pub const OUTPUT_DERIVATIVE_ORDER: i32 = 1;

/// Role of a variable towards the importer (FMI 2.0.4, section 2.2.7).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Causality {
    /// Set by the importer before the simulation.
    Parameter,
    /// Set by the importer at every communication point.
    Input,
    /// Read by the importer, may be connected.
    Output,
    /// Read by the importer, not to be connected.
    Local,
}

/// Variability of a variable in time (FMI 2.0.4, section 2.2.7).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Variability {
    /// Constant after initialisation.
    Fixed,
    /// A parameter that may be changed between steps.
    Tunable,
    /// Changes at events only.
    Discrete,
    /// Changes at any time.
    Continuous,
}

/// Origin of the value at initialisation (FMI 2.0.4, section 2.2.7).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Initial {
    /// The start value.
    Exact,
    /// Calculated by the FMU.
    Calculated,
}

/// An enumeration of the interface; items are numbered from 1 in the order given.
#[derive(Debug)]
pub struct EnumerationType {
    /// Name of the type, as it stands in the XML.
    pub name: &'static str,
    /// Meaning of the enumeration.
    pub description: &'static str,
    /// Item names and descriptions; item `i` has the value `i + 1`.
    pub items: &'static [(&'static str, &'static str)],
}

/// Type and attributes of a row. Bounds are inclusive.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// fmi2Real
    Real {
        /// Unit of the value as exchanged through the interface.
        unit: &'static Unit,
        /// Name of the display unit, one of the unit's own; empty: none.
        display: &'static str,
        /// Lowest accepted value.
        min: Option<f64>,
        /// Highest accepted value.
        max: Option<f64>,
        /// Typical magnitude, > 0.
        nominal: f64,
    },
    /// fmi2Integer
    Integer {
        /// Lowest accepted value.
        min: Option<i32>,
        /// Highest accepted value.
        max: Option<i32>,
    },
    /// fmi2Boolean
    Boolean,
    /// fmi2Integer with named items, 1 to the number of items.
    Enumeration(&'static EnumerationType),
}

/// Start values of a row: none (calculated), one for every element, or one per element.
/// Integers, booleans and enumeration items are stored as their exact f64.
#[derive(Clone, Copy, Debug)]
pub enum Start {
    /// Calculated by the FMU.
    None,
    /// The same for every element.
    Uniform(f64),
    /// One per element.
    Each(&'static [f64]),
}

/// Direct dependence of an output on the inputs at frozen states (ModelStructure).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Depends {
    /// On states only: wear, distance, energy.
    OnStates,
    /// On the inputs as well.
    OnInputs,
}

/// One row of the table: a scalar variable (`elements == 0`) or an array `name[1..elements]`.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Name without index.
    pub name: &'static str,
    /// Meaning of the variable, for the user.
    pub description: &'static str,
    /// Role.
    pub causality: Causality,
    /// Change in time.
    pub variability: Variability,
    /// Origin of its initial value; `None` for inputs.
    pub initial: Option<Initial>,
    /// Type and attributes.
    pub kind: Kind,
    /// Start values.
    pub start: Start,
    /// 0: scalar; n: elements `name[1]` to `name[n]`.
    pub elements: u32,
    /// Direct dependence of an output.
    pub depends: Depends,
    /// Least magnitude of a parameter other than 0.
    pub least_magnitude: f64,
    /// Name of the type of a Real; empty: the first of [`types::TYPES`] with its unit.
    pub type_name: &'static str,
    /// Setting that replaces the value 0, which former versions took for it; empty: none.
    pub instead_of_zero: &'static str,
    /// Whether a scene file may give the first elements of the array only.
    pub may_be_shorter: bool,
}

impl Row {
    /// Number of scalar variables of this row.
    pub const fn count(&self) -> u32 {
        if self.elements == 0 { 1 } else { self.elements }
    }

    /// Start value of element `index` (from 0), if the row has one.
    pub const fn start_of(&self, index: u32) -> Option<f64> {
        match self.start {
            Start::None => None,
            Start::Uniform(value) => Some(value),
            Start::Each(values) => Some(values[index as usize]),
        }
    }

    /// Name of element `index` (from 0) as it stands in the XML.
    pub fn element_name(&self, index: u32) -> String {
        if self.elements == 0 { self.name.to_owned() } else { format!("{}[{}]", self.name, index + 1) }
    }

    /// Type of a Real; `None` for other kinds.
    pub const fn real_type(&self) -> Option<&'static RealType> {
        match self.kind {
            Kind::Real { unit, .. } => types::find(self.type_name, unit),
            _ => None,
        }
    }

    /// Whether the value is a difference, to which the offset of a display unit must not be applied.
    pub const fn is_difference(&self) -> bool {
        matches!(self.real_type(), Some(kind) if kind.is_difference)
    }

    /// Whether the row is a single number that the FMU calculates, connected or not: everything calculated but the profiles.
    pub const fn is_result(&self) -> bool {
        matches!(self.causality, Causality::Output | Causality::Local) && self.elements == 0
    }

    /// Inclusive bounds as f64 (enumerations: 1 to the number of items; booleans: 0 to 1).
    pub const fn bounds(&self) -> (Option<f64>, Option<f64>) {
        match self.kind {
            Kind::Real { min, max, .. } => (min, max),
            Kind::Integer { min, max } => (
                match min {
                    Some(value) => Some(value as f64),
                    None => None,
                },
                match max {
                    Some(value) => Some(value as f64),
                    None => None,
                },
            ),
            Kind::Boolean => (Some(0.0), Some(1.0)),
            Kind::Enumeration(kind) => (Some(1.0), Some(kind.items.len() as f64)),
        }
    }
}

/// Relative tolerances that a scene may have.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-10..=0.5;

/// Number of scalar variables; value references run from 0 to `COUNT - 1`.
pub const COUNT: usize = {
    let mut count = 0;
    let mut row = 0;
    while row < TABLE.len() {
        count += TABLE[row].count() as usize;
        row += 1;
    }
    count
};

/// Row and element of every value reference.
pub static FLAT: [(u16, u16); COUNT] = POSITIONS;

/// Start value of every reference; 0 where the FMU calculates it.
pub static STARTS: [f64; COUNT] = {
    let mut starts = [0.0; COUNT];
    let mut reference = 0;
    while reference < COUNT {
        let (row, element) = POSITIONS[reference];
        if let Some(value) = TABLE[row as usize].start_of(element as u32) {
            starts[reference] = value;
        }
        reference += 1;
    }
    starts
};

const POSITIONS: [(u16, u16); COUNT] = {
    let mut flat = [(0, 0); COUNT];
    let (mut row, mut reference) = (0, 0);
    while row < TABLE.len() {
        let mut element = 0;
        while element < TABLE[row].count() {
            flat[reference] = (row as u16, element as u16);
            element += 1;
            reference += 1;
        }
        row += 1;
    }
    flat
};

const _: () = check::table(TABLE);

/// Value reference of the (first element of the) row called `name`; for use in constants, where an
/// unknown name does not compile.
pub const fn reference(name: &str) -> ValueReference {
    let (mut row, mut reference) = (0, 0);
    while row < TABLE.len() {
        if check::same(TABLE[row].name, name) {
            return reference;
        }
        reference += TABLE[row].count();
        row += 1;
    }
    panic!("no row of the variable table has this name")
}

/// Row and element of a value reference; `None` where there is none.
pub fn lookup(reference: ValueReference) -> Option<(&'static Row, u32)> {
    let (row, element) = *FLAT.get(reference as usize)?;
    Some((&TABLE[row as usize], u32::from(element)))
}

/// `values` with changes by name.
///
/// # Errors
/// Names what is no variable.
pub fn changed(values: &[f64; COUNT], changes: &[(&str, f64)]) -> Result<[f64; COUNT], String> {
    let mut values = *values;
    for (name, value) in changes {
        values[find(name).ok_or_else(|| format!("there is no variable {name}"))? as usize] = *value;
    }
    Ok(values)
}

/// Value reference of a full name such as `punch.height` or `profile.pressure[3]`.
pub fn find(name: &str) -> Option<ValueReference> {
    let (base, element) = match name.strip_suffix(']').and_then(|rest| rest.split_once('[')) {
        Some((base, index)) => (base, Some(index.parse::<u32>().ok()?)),
        None => (name, None),
    };
    let (_, first, elements) = ROWS[ROWS.binary_search_by_key(&base, |row| row.0).ok()?];
    match (elements, element) {
        (0, None) => Some(first),
        (count, Some(index)) if (1..=count).contains(&index) => Some(first + index - 1),
        _ => None,
    }
}

/// Name, value reference of the first element and number of elements of every row, by name. Not on the heap: an importer that unloads the
/// library would not get that back.
static ROWS: LazyLock<[(&str, ValueReference, u32); TABLE.len()]> = LazyLock::new(|| {
    let mut next = 0;
    let mut rows = std::array::from_fn(|row| {
        let (row, first) = (&TABLE[row], next);
        next += row.count();
        (row.name, first, row.elements)
    });
    rows.sort_unstable_by_key(|row| row.0);
    rows
});

/// Reason for refusing a value; `Display` names the variable, the value and the limit.
#[derive(Clone, PartialEq, Debug)]
pub struct Refusal {
    /// Full name of the variable.
    pub name: String,
    /// The fault, with value and limit.
    pub reason: String,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}: {}", self.name, self.reason)
    }
}

impl std::error::Error for Refusal {}

/// Unit of a row for messages; empty for anything but a Real.
pub fn unit_of(row: &Row) -> &'static str {
    match row.kind {
        Kind::Real { unit, .. } => unit.name,
        _ => "",
    }
}

/// Checks a parameter's value against its row. Inputs are not checked here: by policy
/// an invalid value is stored and the next step refuses it.
///
/// # Errors
/// [`Refusal`] where the value is not finite, outside the bounds or no item of the enumeration.
pub fn check_parameter(reference: ValueReference, value: f64) -> Result<(), Refusal> {
    let Some((row, element)) = lookup(reference) else {
        return Err(Refusal { name: format!("#{reference}"), reason: "unknown value reference".into() });
    };
    let refuse = |reason| Err(Refusal { name: row.element_name(element), reason });
    if !value.is_finite() {
        return refuse(format!("{value} is not a finite number"));
    }
    if let Kind::Enumeration(kind) = row.kind
        && (value < 1.0 || value > kind.items.len() as f64)
    {
        let items: Vec<String> =
            kind.items.iter().enumerate().map(|(i, item)| format!("{} = {}", i + 1, item.0)).collect();
        return refuse(format!("{value} is not an item of {}; items: {}", kind.name, items.join(", ")));
    }
    let limited = |side: &str, limit: f64| {
        let [value, limit] = message::apart([value, limit], unit_of(row));
        let instead = if value == "0 K" && !row.instead_of_zero.is_empty() {
            format!("; set {} instead", row.instead_of_zero)
        } else {
            String::new()
        };
        refuse(format!("{value} is {side} {limit}{instead}"))
    };
    match row.bounds() {
        (Some(min), _) if value < min => limited("below the minimum", min),
        (_, Some(max)) if value > max => limited("above the maximum", max),
        _ if value != 0.0 && value.abs() < row.least_magnitude => {
            limited("below the least value other than 0,", row.least_magnitude)
        }
        _ => Ok(()),
    }
}
