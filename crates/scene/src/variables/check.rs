//! The rules a row of the variable table must obey, evaluated at compile time.

use super::{Causality, Initial, Kind, Row, Start, Variability};

/// String equality in constants.
pub(crate) const fn same(left: &str, right: &str) -> bool {
    let (left, right) = (left.as_bytes(), right.as_bytes());
    if left.len() != right.len() {
        return false;
    }
    let mut index = 0;
    while index < left.len() {
        if left[index] != right[index] {
            return false;
        }
        index += 1;
    }
    true
}

/// Panics (a compile error, as it runs in a constant) at the first row that breaks a rule.
pub(crate) const fn table(rows: &[Row]) {
    let mut index = 0;
    while index < rows.len() {
        row(&rows[index]);
        let mut other = 0;
        while other < index {
            assert!(!same(rows[index].name, rows[other].name), "two rows have the same name");
            other += 1;
        }
        index += 1;
    }
}

const fn row(row: &Row) {
    assert!(!row.name.is_empty() && !row.description.is_empty(), "a row needs a name and a description");
    combination(row);
    if let Kind::Real { nominal, display, unit, .. } = row.kind {
        assert!(nominal > 0.0, "nominal must be positive");
        let mut known = display.is_empty();
        let mut index = 0;
        while index < unit.display.len() {
            known = known || same(unit.display[index].name, display);
            index += 1;
        }
        assert!(known, "the display unit is not one of the unit's own");
        match row.real_type() {
            None => panic!("a Real has a type of its unit"),
            // A temperature is shown as people say it, a difference never with the offset.
            Some(kind) if !same(kind.display, "") => assert!(same(kind.display, display), "shown as its type is"),
            Some(_) => {}
        }
    }
    let (min, max) = row.bounds();
    if let (Some(min), Some(max)) = (min, max) {
        assert!(min <= max, "min is above max");
    }
    if matches!(row.causality, Causality::Output | Causality::Local) {
        assert!(
            min.is_none() && max.is_none() || !matches!(row.kind, Kind::Real { .. } | Kind::Integer { .. }),
            "outputs and locals have no min or max"
        );
    }
    if let Start::Each(values) = row.start {
        assert!(values.len() == row.count() as usize, "one start per element");
    }
    let mut element = 0;
    while element < row.count() {
        if let Some(value) = row.start_of(element) {
            assert!(value.is_finite(), "start is not finite");
            if let Some(min) = min {
                assert!(value >= min, "start is below min");
            }
            if let Some(max) = max {
                assert!(value <= max, "start is above max");
            }
            if !matches!(row.kind, Kind::Real { .. }) {
                assert!(value == (value as i32) as f64, "start of a non-real row is not a whole number");
            }
        }
        element += 1;
    }
}

/// Table 17 of FMI 2.0.4 (section 2.2.7) for the combinations that a co-simulation slave without
/// internal time can use, with the start values that each requires or forbids.
const fn combination(row: &Row) {
    let has_start = !matches!(row.start, Start::None);
    match (row.causality, row.variability) {
        (Causality::Parameter, Variability::Fixed | Variability::Tunable) => {
            assert!(matches!(row.initial, Some(Initial::Exact)), "a parameter's initial is exact");
            assert!(has_start, "a parameter needs a start");
        }
        (Causality::Input, Variability::Discrete | Variability::Continuous) => {
            assert!(row.initial.is_none(), "an input has no initial");
            assert!(has_start, "an input needs a start");
        }
        (Causality::Output, Variability::Discrete | Variability::Continuous)
        | (
            Causality::Local,
            Variability::Fixed | Variability::Tunable | Variability::Discrete | Variability::Continuous,
        ) => {
            assert!(matches!(row.initial, Some(Initial::Calculated)), "outputs and locals are calculated");
            assert!(!has_start, "what the FMU calculates has no start");
        }
        _ => panic!("FMI 2.0 forbids this combination of causality and variability"),
    }
    if matches!(row.variability, Variability::Continuous) {
        assert!(matches!(row.kind, Kind::Real { .. }), "only Real can be continuous");
    }
}
