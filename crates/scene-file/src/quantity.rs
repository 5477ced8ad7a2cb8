//! A value of a scene file in the unit of its variable.

use toml::de::DeValue;

pub(crate) use crate::unit_names::units;
use crate::unit_names::{canonical, hint};
use scene::message::{Clipped, Quoted};
use scene::variables::units::{DisplayUnit, ONE, Unit};
use scene::variables::{EnumerationType, Kind, Row};

/// Type of a value with its article, for messages.
pub(crate) fn type_of(value: &DeValue) -> String {
    match value {
        DeValue::String(text) => format!("the string {}", Quoted(text)),
        DeValue::Integer(number) => format!("the number {}", Clipped(number.as_str())),
        DeValue::Float(number) => format!("the number {}", Clipped(number.as_str())),
        DeValue::Boolean(flag) => format!("the boolean {flag}"),
        DeValue::Datetime(time) => format!("the date {time}"),
        DeValue::Array(_) => "an array".into(),
        DeValue::Table(_) => "a table".into(),
    }
}

/// The value for one element of `row`, checked against its bounds.
pub(crate) fn value(value: &DeValue, row: &Row) -> Result<f64, String> {
    match row.kind {
        Kind::Real { unit, .. } => Written::of(value, unit, !row.is_difference())?.checked(row, unit),
        Kind::Integer { min, max } => {
            let DeValue::Integer(number) = value else {
                return Err(format!("is {}, but must be an integer", type_of(value)));
            };
            let written = Written { number: integer(number.as_str(), number.radix()), unit: None, name: "" };
            within(&written, min.map(f64::from), max.map(f64::from))?;
            Ok(written.number)
        }
        Kind::Boolean => match value {
            DeValue::Boolean(flag) => Ok(f64::from(u8::from(*flag))),
            other => Err(format!("is {}, but must be true or false", type_of(other))),
        },
        Kind::Enumeration(kind) => {
            let DeValue::String(text) = value else {
                let items = kind.items.iter().map(|item| item.0).collect::<Vec<_>>().join(", ");
                return Err(format!("is {}, but must be one of the strings {items}", type_of(value)));
            };
            item(text, kind)
        }
    }
}

/// Number of the item `text` of an enumeration.
fn item(text: &str, kind: &EnumerationType) -> Result<f64, String> {
    match kind.items.iter().position(|item| item.0 == text) {
        Some(index) => Ok(index as f64 + 1.0),
        None => {
            let items = kind.items.iter().map(|item| item.0).collect::<Vec<_>>().join(", ");
            Err(format!("{} is none of {items}", Quoted(text)))
        }
    }
}

/// The value for one element of `row` from a cell of a table, checked as by [`value`]: a number in the unit `symbol` of its column (`None`:
/// the SI unit) or with a unit of its own, `true` or `false`, an item of an enumeration by its name or number.
pub fn cell(text: &str, symbol: Option<&str>, row: &Row) -> Result<f64, String> {
    let text = text.trim();
    match row.kind {
        Kind::Real { unit, .. } => Written::in_cell(text, symbol, unit, !row.is_difference())?.checked(row, unit),
        Kind::Integer { min, max } => {
            // Tables of numbers often have a point in every one.
            let whole = text.parse().ok().filter(|number: &f64| number.fract() == 0.0);
            let number = whole.ok_or_else(|| format!("{} must be an integer", Quoted(text)))?;
            let written = Written { number, unit: None, name: "" };
            within(&written, min.map(f64::from), max.map(f64::from))?;
            Ok(written.number)
        }
        Kind::Boolean => match text {
            "true" | "1" => Ok(1.0),
            "false" | "0" => Ok(0.0),
            _ => Err(format!("{} must be true or false", Quoted(text))),
        },
        Kind::Enumeration(kind) => {
            let numbered = text.parse().ok().filter(|number| (1..=kind.items.len()).contains(number));
            numbered.map_or_else(|| item(text, kind), |number| Ok(number as f64))
        }
    }
}

/// A factor from a cell of a table; arguments as in [`cell`].
///
/// # Errors
/// Where it is no finite number.
pub fn factor(text: &str, symbol: Option<&str>) -> Result<f64, String> {
    let written = Written::in_cell(text.trim(), symbol, &ONE, true)?;
    within(&written, None, None)?;
    Ok(written.si())
}

/// A number in `unit`; `absolute`: whether units with an offset, such as degC, make sense.
pub(crate) fn real(value: &DeValue, unit: &'static Unit, absolute: bool) -> Result<f64, String> {
    let written = Written::of(value, unit, absolute)?;
    within(&written, None, None)?;
    Ok(written.si())
}

/// A plain number, then in the SI unit, or a number with a unit (`100 ms`); `absolute` as in [`real`].
///
/// # Errors
/// The fault and the accepted alternatives.
pub fn text(text: &str, unit: &'static Unit, absolute: bool) -> Result<f64, String> {
    let name = if unit.name == "1" { "" } else { unit.name };
    let written = match text.trim().parse() {
        Ok(number) => Written { number, unit: None, name },
        Err(_) => Written::from_text(text, unit, name, absolute)?,
    };
    within(&written, None, None)?;
    Ok(written.si())
}

/// `number` of the unit `symbol` in `unit`; `absolute` as in [`real`].
///
/// # Errors
/// Where the unit is not accepted (with the accepted ones), or the number is not finite.
pub fn in_si(number: f64, symbol: &str, unit: &'static Unit, absolute: bool) -> Result<f64, String> {
    let written = Written::in_unit(number, symbol, unit, absolute).map_err(|names| {
        let wrong = if symbol.is_empty() {
            "a unit is missing".into()
        } else {
            format!("{} is the wrong unit", Quoted(symbol))
        };
        format!("{wrong}; accepted are {names}")
    })?;
    within(&written, None, None)?;
    Ok(written.si())
}

/// A number as written in the file.
struct Written {
    number: f64,
    /// `None`: the SI unit.
    unit: Option<&'static DisplayUnit>,
    /// Name of the unit, for messages; empty for the dimensionless.
    name: &'static str,
}

impl Written {
    fn of(value: &DeValue, unit: &'static Unit, absolute: bool) -> Result<Written, String> {
        let name = if unit.name == "1" { "" } else { unit.name };
        let plain = |number| Ok(Written { number, unit: None, name });
        match value {
            DeValue::Integer(number) => plain(integer(number.as_str(), number.radix())),
            // TOML's own spellings of floats, `inf` and `nan` among them, are those of Rust.
            DeValue::Float(number) => plain(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::String(text) => Self::from_text(text, unit, name, absolute),
            other => Err(format!("is {}, but must be a number or a string such as {:?}", type_of(other), sample(unit))),
        }
    }

    fn from_text(text: &str, unit: &'static Unit, name: &'static str, absolute: bool) -> Result<Written, String> {
        let text = text.trim();
        if let Some(hint) = decimal_comma(text) {
            return Err(format!("{} {hint}", Quoted(text)));
        }
        let (number, symbol) = split(text)
            .ok_or_else(|| format!("{} is not a number with a unit, such as {:?}", Quoted(text), sample(unit)))?;
        if symbol.is_empty() && name.is_empty() {
            return Ok(Written { number, unit: None, name });
        }
        Self::in_unit(number, symbol, unit, absolute).map_err(|names| {
            let wrong = if symbol.is_empty() {
                "has no unit".to_owned()
            } else {
                format!("has the wrong unit {}", Quoted(symbol))
            };
            format!("{} {wrong}; accepted are {names}", Quoted(text))
        })
    }

    fn in_cell(text: &str, symbol: Option<&str>, unit: &'static Unit, absolute: bool) -> Result<Written, String> {
        let name = if unit.name == "1" { "" } else { unit.name };
        match (text.parse(), symbol) {
            (Ok(number), Some(symbol)) => Self::in_unit(number, symbol, unit, absolute)
                .map_err(|names| format!("{} is the wrong unit; accepted are {names}", Quoted(symbol))),
            (Ok(number), None) => Ok(Written { number, unit: None, name }),
            (Err(_), _) => Self::from_text(text, unit, name, absolute),
        }
    }

    /// Its value in the SI unit of `row`, within the row's bounds.
    fn checked(&self, row: &Row, unit: &'static Unit) -> Result<f64, String> {
        let (min, max) = row.bounds();
        within(self, min, max).map_err(|reason| match row.instead_of_zero {
            setting if !setting.is_empty() && self.si() == 0.0 => format!("{reason}; set {setting} instead"),
            _ => format!("{reason}{}", self.other_unit(unit)),
        })?;
        let si = self.si();
        if si != 0.0 && si.abs() < row.least_magnitude {
            let least = self.shown(row.least_magnitude);
            return Err(format!(
                "{} is below the least value other than 0, {}",
                self.show(self.number),
                self.show(least)
            ));
        }
        Ok(si)
    }

    /// The error tells the units that would be accepted.
    fn in_unit(number: f64, symbol: &str, unit: &'static Unit, absolute: bool) -> Result<Written, String> {
        let symbol = canonical(symbol);
        if symbol == unit.name {
            let name = if unit.name == "1" { "" } else { unit.name };
            return Ok(Written { number, unit: None, name });
        }
        match units(unit, absolute).find(|display| display.name == symbol) {
            Some(display) => Ok(Written { number, unit: Some(display), name: display.name }),
            None => {
                let others = units(unit, absolute).map(|display| display.name);
                let names = std::iter::once(unit.name).chain(others).collect::<Vec<_>>().join(", ");
                let hint = if unit.name == "m2/N" { hint(&symbol) } else { None };
                Err(names + hint.unwrap_or_default())
            }
        }
    }

    fn si(&self) -> f64 {
        self.unit.map_or(self.number, |unit| decimal((self.number - unit.offset) / unit.factor))
    }

    /// A number in the unit that was written, as a text.
    fn show(&self, number: f64) -> String {
        let number = match number.abs() {
            size if size != 0.0 && !(1e-6..1e9).contains(&size) => format!("{number:e}"),
            _ => format!("{number}"),
        };
        if self.name.is_empty() { number } else { format!("{number} {}", self.name) }
    }

    /// A number that says no unit may be meant in another one.
    fn other_unit(&self, unit: &'static Unit) -> String {
        match (self.unit, unit.display.first()) {
            (None, Some(display)) if self.number > 1.0 && self.number < 1e9 => {
                format!("; in {} it is written as {:?}", display.name, format!("{} {}", self.number, display.name))
            }
            _ => String::new(),
        }
    }

    fn shown(&self, si: f64) -> f64 {
        self.unit.map_or(si, |unit| decimal(unit.factor * si + unit.offset))
    }
}

/// Rounding to 15 significant decimal digits, so that `"20 um"` is the same number as `2e-5`.
fn decimal(number: f64) -> f64 {
    if number.is_finite() { format!("{number:.14e}").parse().unwrap_or(number) } else { number }
}

fn within(written: &Written, min: Option<f64>, max: Option<f64>) -> Result<(), String> {
    let show = |number: f64| written.show(number);
    if !written.number.is_finite() {
        return Err(format!("{} is not a finite number", written.number));
    }
    let si = written.si();
    if !si.is_finite() {
        return Err(format!("{:e} {} is no finite number in the SI unit", written.number, written.name));
    }
    if min.is_none_or(|min| si >= min) && max.is_none_or(|max| si <= max) {
        return Ok(());
    }
    let range = match (min.map(|min| written.shown(min)), max.map(|max| written.shown(max))) {
        (Some(min), Some(max)) => format!("from {} to {}", show(min), show(max)),
        (Some(min), None) => format!("at least {}", show(min)),
        (None, Some(max)) => format!("at most {}", show(max)),
        (None, None) => "any".into(),
    };
    Err(format!("{} is outside the allowed range: {range}", show(written.number)))
}

fn integer(digits: &str, radix: u32) -> f64 {
    i64::from_str_radix(digits, radix).map_or(f64::NAN, |number| number as f64)
}

/// A remark about a number that has a comma in place of its decimal point; `None` where it has none.
pub(crate) fn decimal_comma(text: &str) -> Option<&'static str> {
    let (before, after) = text.split_once(',')?;
    let digits = before.ends_with(|symbol: char| symbol.is_ascii_digit())
        && after.starts_with(|symbol: char| symbol.is_ascii_digit());
    digits.then_some("has a comma; numbers have a decimal point")
}

/// A text whose number has a point in place of its decimal comma; as it is where it has both, or two commas.
pub fn with_point(text: &str) -> String {
    let is_plain = |(before, after): (&str, &str)| {
        let rest = after.trim_start_matches(|symbol: char| symbol.is_ascii_digit());
        !before.contains('.') && !rest.starts_with(['.', ','])
    };
    match text.split_once(',').filter(|_| decimal_comma(text).is_some()) {
        Some(parts) if is_plain(parts) => text.replacen(',', ".", 1),
        _ => text.to_owned(),
    }
}

/// Number and unit of a text such as `1.2e3 mm3/(N.m)`, with or without the space.
fn split(text: &str) -> Option<(f64, &str)> {
    // The longest number wins, so that an exponent is not taken for a unit.
    let ends = text.char_indices().map(|(at, symbol)| at + symbol.len_utf8());
    ends.rev().find_map(|end| {
        let (number, unit) = text.split_at(end);
        // Rust would also read `inf` and `nan`, which no unit begins a number with.
        let number = number.trim_end();
        if !number.ends_with(|symbol: char| symbol.is_ascii_digit() || symbol == '.') {
            return None;
        }
        Some((number.parse().ok()?, unit.trim_start()))
    })
}

fn sample(unit: &Unit) -> String {
    let symbol = unit.display.first().map_or(unit.name, |display| display.name);
    format!("20 {symbol}")
}
