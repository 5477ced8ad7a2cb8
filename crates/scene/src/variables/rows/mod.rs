//! The rows, by group, and the short constructors they are written with.

mod inputs;
mod outputs;
mod parameters;

use super::types;
use super::units::Unit;
use super::{Causality, Depends, EnumerationType, Initial, Kind, Row, Start, Variability};

const GROUPS: &[&[Row]] = &[
    inputs::ROWS,
    outputs::ROWS,
    outputs::PROFILES,
    parameters::PUNCH,
    parameters::STRIP,
    parameters::CONTACT,
    parameters::HOLDER_AND_SOLVER,
];

const LENGTH: usize = {
    let mut length = 0;
    let mut group = 0;
    while group < GROUPS.len() {
        length += GROUPS[group].len();
        group += 1;
    }
    length
};

static ROWS: [Row; LENGTH] = {
    let mut rows = [GROUPS[0][0]; LENGTH];
    let (mut group, mut next) = (0, 0);
    while group < GROUPS.len() {
        let mut index = 0;
        while index < GROUPS[group].len() {
            rows[next] = GROUPS[group][index];
            next += 1;
            index += 1;
        }
        group += 1;
    }
    rows
};

/// Every variable of the FMU, in the order of the XML.
pub static TABLE: &[Row] = &ROWS;

/// Least magnitude of a Real other than 0: far below everything physical, and its reciprocal and the powers of that are far within
/// the range of floating-point numbers.
const LEAST_MAGNITUDE: f64 = 1e-60;

const fn real(name: &'static str, unit: &'static Unit, nominal: f64, description: &'static str) -> Row {
    Row {
        name,
        description,
        causality: Causality::Parameter,
        variability: Variability::Fixed,
        initial: Some(Initial::Exact),
        kind: Kind::Real { unit, display: types::display("", unit), min: None, max: None, nominal },
        start: Start::Uniform(0.0),
        elements: 0,
        depends: Depends::OnStates,
        least_magnitude: LEAST_MAGNITUDE,
        type_name: "",
        instead_of_zero: "",
        may_be_shorter: false,
    }
}

const fn choice(name: &'static str, kind: &'static EnumerationType, start: i32, description: &'static str) -> Row {
    Row { kind: Kind::Enumeration(kind), ..real(name, &super::units::ONE, 1.0, description) }.start(start as f64)
}

const fn integer(name: &'static str, min: i32, max: i32, start: i32, description: &'static str) -> Row {
    Row { kind: Kind::Integer { min: Some(min), max: Some(max) }, ..real(name, &super::units::ONE, 1.0, description) }
        .start(start as f64)
}

const fn boolean(name: &'static str, start: bool, description: &'static str) -> Row {
    Row { kind: Kind::Boolean, ..real(name, &super::units::ONE, 1.0, description) }.start(start as u8 as f64)
}

/// Modifiers in the notation of the table of the interface document.
impl Row {
    const fn shown(self, display: &'static str) -> Row {
        match self.kind {
            Kind::Real { unit, min, max, nominal, .. } => {
                Row { kind: Kind::Real { unit, display, min, max, nominal }, ..self }
            }
            _ => panic!("only a Real has a display unit"),
        }
    }

    const fn within(self, low: f64, high: f64) -> Row {
        match self.kind {
            Kind::Real { unit, display, nominal, .. } => {
                Row { kind: Kind::Real { unit, display, min: Some(low), max: Some(high), nominal }, ..self }
            }
            _ => panic!("only a Real has bounds of this kind"),
        }
    }

    /// 0, or a value from `least` on.
    const fn zero_or_from(self, least: f64) -> Row {
        Row { least_magnitude: least, ..self }
    }

    /// A Real of the type of this name, shown as that is.
    const fn of_type(self, name: &'static str) -> Row {
        match self.kind {
            Kind::Real { unit, min, max, nominal, .. } => {
                let kind = Kind::Real { unit, display: types::display(name, unit), min, max, nominal };
                Row { type_name: name, kind, ..self }
            }
            _ => panic!("only a Real has a type of this kind"),
        }
    }

    /// A scene file may give the first elements of the array only.
    const fn may_be_shorter(self) -> Row {
        Row { may_be_shorter: true, ..self }
    }

    /// 0, below the bounds now, was once accepted for `setting`.
    const fn instead_of_zero(self, setting: &'static str) -> Row {
        Row { instead_of_zero: setting, ..self }
    }

    const fn start(self, value: f64) -> Row {
        Row { start: Start::Uniform(value), ..self }
    }

    const fn starts(self, values: &'static [f64]) -> Row {
        Row { start: Start::Each(values), elements: values.len() as u32, ..self }
    }

    const fn array(self, elements: u32) -> Row {
        Row { elements, ..self }
    }

    const fn tunable(self) -> Row {
        Row { variability: Variability::Tunable, ..self }
    }

    const fn input(self) -> Row {
        Row { causality: Causality::Input, variability: Variability::Continuous, initial: None, ..self }
    }

    const fn output(self, depends: Depends) -> Row {
        Row {
            causality: Causality::Output,
            variability: Variability::Continuous,
            initial: Some(Initial::Calculated),
            start: Start::None,
            depends,
            ..self
        }
    }

    const fn local(self) -> Row {
        Row { causality: Causality::Local, ..self.output(Depends::OnStates) }
    }
}
