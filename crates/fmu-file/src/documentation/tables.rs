//! The variables by topic, as the page inside the FMU and `cargo fmu reference` list them.

use scene::variables::units::Unit;
use scene::variables::{Causality, Kind, Row, TABLE};

use crate::description::variability;
use crate::xml::number;

pub(crate) struct Topic {
    /// Heading of the table.
    pub title: &'static str,
    /// Whether the user gives the values: the table then has start values and limits.
    pub given: bool,
    /// Its rows, in the order of the variable table.
    pub entries: Vec<Entry>,
}

/// A row of a table, in plain text.
pub(crate) struct Entry {
    /// Name, with the range of an array's index.
    pub name: String,
    /// Unit of the interface, or the type.
    pub unit: &'static str,
    /// Start value, with the same in the display unit; empty where the FMU calculates it.
    pub start: String,
    /// Inclusive limits; the items of an enumeration.
    pub limits: String,
    /// Meaning.
    pub meaning: String,
}

/// Title of a topic with the names in it; `*` at the beginning or the end of one stands for any text.
type Names = (&'static str, &'static [&'static str]);

/// Topics of the results, which are read and not connected.
const RESULTS: &[Names] = &[
    ("Friction", &["friction_*", "effective_radius", "bristle_*", "critical_speed"]),
    ("Contact", &["pressure_*", "contact_fraction"]),
    ("Temperature and heat", &["heat_*", "stored_heat", "dissipated_energy"]),
    ("Wear", &["wear_volume_*", "wear_dissipation_power", "sliding_distance"]),
    ("Error and limits", &["estimated_*", "*_exceeded", "wear_limit_reached"]),
    ("Profiles along the contact", &["profile.*"]),
];

/// Topics of the parameters.
const PARAMETERS: &[Names] = &[
    (
        "Geometry",
        &["depth", "*.width", "*.height", "*.length", "*.path", "*.count", "*.geometry", "*.mean_radius", "*.faces"],
    ),
    (
        "Elasticity, holder and initial shape",
        &[
            "*.body",
            "*.youngs_modulus",
            "*.poissons_ratio",
            "*.foundation_stiffness",
            "strip.base",
            "*.shear_coupling",
            "holder.*",
            "contact.initial_*",
        ],
    ),
    ("Friction", &["contact.friction_*", "contact.static_*", "contact.stribeck_*"]),
    (
        "Friction at standstill",
        &["contact.regularization_velocity", "contact.stick_*", "contact.tangential_compliance"],
    ),
    ("Wear", &["punch.wear_*", "strip.wear_*", "*.initial_wear", "*.airborne_fraction", "wear_acceleration"]),
    (
        "Heat in the bodies",
        &[
            "*.density",
            "*.specific_heat",
            "*.conductivity",
            "punch.property_*",
            "strip.property_*",
            "*.thermal_expansion",
            "contact.conductance",
            "*.initial_temperature",
            "*.initial_at_ambient",
        ],
    ),
    (
        "Cooling and heat paths",
        &[
            "ambient_temperature",
            "*.convection",
            "*.convection_forced",
            "*.emissivity",
            "*.cooled_area",
            "*.external_conductance",
            "punch.top_*",
            "strip.base_*",
        ],
    ),
    ("Limit of the contact temperature", &["contact.temperature_*"]),
    ("Nominal conditions", &["nominal.*"]),
    ("Solver", &["solver.*"]),
];

fn fits(name: &str, pattern: &str) -> bool {
    match (pattern.strip_prefix('*'), pattern.strip_suffix('*')) {
        (Some(end), _) => name.ends_with(end),
        (_, Some(beginning)) => name.starts_with(beginning),
        _ => name == pattern,
    }
}

/// Tables of a scene's variables: inputs, outputs, results by topic, parameters by topic.
pub(crate) fn topics(starts: &[f64]) -> Vec<Topic> {
    let table = |title, causality, names: Option<&[&str]>| {
        let mut first = 0;
        let mut entries = Vec::new();
        for row in TABLE {
            let own = names.is_none_or(|names| names.iter().any(|pattern| fits(row.name, pattern)));
            if row.causality == causality && own {
                entries.push(entry(row, &starts[first..first + row.count() as usize]));
            }
            first += row.count() as usize;
        }
        Topic { title, given: matches!(causality, Causality::Input | Causality::Parameter), entries }
    };
    let group = |causality, names: &'static [Names]| {
        names.iter().map(move |&(title, names)| table(title, causality, Some(names)))
    };
    [table("Inputs", Causality::Input, None), table("Outputs", Causality::Output, None)]
        .into_iter()
        .chain(group(Causality::Local, RESULTS))
        .chain(group(Causality::Parameter, PARAMETERS))
        .collect()
}

/// A row of the variable table with the start values of its elements.
pub(crate) fn entry(row: &Row, starts: &[f64]) -> Entry {
    let unit = match row.kind {
        Kind::Real { unit, .. } => unit.name,
        Kind::Integer { .. } => "Integer",
        Kind::Boolean => "Boolean",
        Kind::Enumeration(kind) => kind.name,
    };
    let tunable = if variability(row) == "tunable" { " (may be changed between steps)" } else { "" };
    let given = matches!(row.causality, Causality::Input | Causality::Parameter);
    Entry {
        name: if row.elements == 0 { row.name.to_owned() } else { format!("{}[1..{}]", row.name, row.elements) },
        unit,
        start: if given { start(row, starts) } else { String::new() },
        limits: if given { limits(row) } else { String::new() },
        meaning: format!("{}{tunable}", row.description),
    }
}

/// Start values, one where all elements have the same.
fn start(row: &Row, starts: &[f64]) -> String {
    let all_equal = starts.iter().all(|start| start == &starts[0]);
    let shown: Vec<String> =
        starts.iter().take(if all_equal { 1 } else { starts.len() }).map(|&start| value(row, start)).collect();
    shown.join(", ")
}

fn limits(row: &Row) -> String {
    match (row.kind, row.bounds()) {
        (Kind::Boolean, _) => String::new(),
        (Kind::Enumeration(kind), _) => kind.items.iter().map(|item| item.0).collect::<Vec<_>>().join(", "),
        (_, (Some(min), Some(max))) => format!("{} to {}", number(min), number(max)),
        (_, (Some(min), None)) => format!("from {}", number(min)),
        (_, (None, Some(max))) => format!("to {}", number(max)),
        (_, (None, None)) => String::new(),
    }
}

/// A start value with the same in the display unit, if it has one.
pub(crate) fn value(row: &Row, start: f64) -> String {
    match row.kind {
        Kind::Boolean => (start != 0.0).to_string(),
        Kind::Enumeration(kind) => kind.items[start as usize - 1].0.to_owned(),
        Kind::Real { unit, display, .. } => match shown(unit, display, start) {
            Some(shown) => format!("{} ({shown})", number(start)),
            None => number(start),
        },
        Kind::Integer { .. } => number(start),
    }
}

fn shown(unit: &Unit, display: &str, start: f64) -> Option<String> {
    let display = unit.display.iter().find(|known| known.name == display)?;
    // Twelve digits hide the rounding of the conversion.
    let value: f64 = format!("{:.11e}", display.factor * start + display.offset).parse().ok()?;
    (start != 0.0).then(|| format!("{} {}", number(value), display.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::STARTS;

    #[test]
    fn every_variable_has_one_topic_and_every_pattern_a_variable() {
        let topics = topics(&STARTS);
        for row in TABLE {
            let name = entry(row, &[row.start_of(0).unwrap_or(0.0)]).name;
            let listed: Vec<&str> = topics
                .iter()
                .filter(|topic| topic.entries.iter().any(|e| e.name == name))
                .map(|topic| topic.title)
                .collect();
            assert_eq!(listed.len(), 1, "{name} is in {listed:?}");
        }
        for (names, causality) in [(RESULTS, Causality::Local), (PARAMETERS, Causality::Parameter)] {
            for pattern in names.iter().flat_map(|(_, patterns)| patterns.iter()) {
                let used = TABLE.iter().any(|row| row.causality == causality && fits(row.name, pattern));
                assert!(used, "{pattern} fits no variable");
            }
        }
    }
}
