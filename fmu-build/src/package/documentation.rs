//! documentation/index.html: the committed page with the tables of the variables and the scene's values filled in.

use std::fmt::Write;

use quick_xml::escape::escape;
use sliding_contact::scene::file::SceneFile;
use sliding_contact::slot::STOCK_NAME;
use sliding_contact::variables::units::Unit;
use sliding_contact::variables::{Causality, Kind, Row, TABLE, reference};

use super::description::{LOG_CATEGORIES, SUMMARY, enumerations, variability};
use super::xml::number;

/// The page without its tables and values, which stand in it as `{{name}}`.
const PAGE: &str = include_str!("../../../modelDescription/documentation/index.html");

/// Writes the page for a scene.
pub fn write(scene: &SceneFile) -> String {
    let packaged = &scene.packaged;
    let start = |name: u32| number(packaged.starts[name as usize]);
    let description = match (scene.description.as_str(), packaged.name.as_str()) {
        ("", STOCK_NAME) => format!("{SUMMARY}; the start values are those of a car's front disc brake."),
        ("", _) => format!("{SUMMARY}."),
        (text, _) => format!("{text}."),
    };
    let categories: Vec<String> =
        LOG_CATEGORIES.iter().map(|(name, about)| format!("<code>{name}</code> ({})", escape(*about))).collect();
    let values = [
        ("scene", escape(packaged.name.as_str()).into_owned()),
        ("description", escape(description.as_str()).into_owned()),
        ("start", number(packaged.experiment.start)),
        ("stop", number(packaged.experiment.stop)),
        ("step", number(packaged.experiment.step)),
        ("velocity", start(const { reference("nominal.velocity") })),
        ("load", start(const { reference("nominal.load") })),
        ("categories", categories.join(", ")),
        ("variables", variables(&packaged.starts)),
        ("enumerations", enumeration_tables()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("guid", packaged.guid()),
    ];
    let mut page = PAGE.to_owned();
    for (name, value) in values {
        page = page.replace(&format!("{{{{{name}}}}}"), &value);
    }
    page
}

fn variables(starts: &[f64]) -> String {
    let groups = [
        (Causality::Input, "Inputs"),
        (Causality::Output, "Outputs"),
        (Causality::Parameter, "Parameters"),
        (Causality::Local, "Profiles along the contact, to be read but not to be connected"),
    ];
    let mut html = String::new();
    for (causality, title) in groups {
        let given = matches!(causality, Causality::Input | Causality::Parameter);
        html += &format!("<h3>{title}</h3>\n<table>\n<tr><th>name</th><th>unit</th>");
        html += if given { "<th>start</th><th>limits</th>" } else { "" };
        html += "<th>meaning</th></tr>\n";
        let mut first = 0;
        for row in TABLE {
            if row.causality == causality {
                html += &table_row(row, &starts[first..first + row.count() as usize], given);
            }
            first += row.count() as usize;
        }
        html += "</table>\n";
    }
    html
}

fn table_row(row: &Row, starts: &[f64], given: bool) -> String {
    let name = if row.elements == 0 { row.name.to_owned() } else { format!("{}[1..{}]", row.name, row.elements) };
    let unit = match row.kind {
        Kind::Real { unit, .. } => unit.name,
        Kind::Integer { .. } => "Integer",
        Kind::Boolean => "Boolean",
        Kind::Enumeration(kind) => kind.name,
    };
    let mut html = format!("<tr><td><code>{name}</code></td><td class=\"number\">{unit}</td>");
    if given {
        let all_equal = starts.iter().all(|start| start == &starts[0]);
        let shown: Vec<String> =
            starts.iter().take(if all_equal { 1 } else { starts.len() }).map(|&start| value(row, start)).collect();
        let (min, max) = row.bounds();
        let limits = match (min, max) {
            _ if matches!(row.kind, Kind::Boolean | Kind::Enumeration(_)) => String::new(),
            (Some(min), Some(max)) => format!("{} to {}", number(min), number(max)),
            (Some(min), None) => format!("from {}", number(min)),
            (None, Some(max)) => format!("to {}", number(max)),
            (None, None) => String::new(),
        };
        let _ = write!(html, "<td>{}</td><td class=\"number\">{limits}</td>", shown.join(", "));
    }
    let tunable = if variability(row) == "tunable" { " (may be changed between steps)" } else { "" };
    let _ = writeln!(html, "<td>{}{tunable}</td></tr>", escape(row.description));
    html
}

/// A start value with the same in the display unit, if it has one.
fn value(row: &Row, start: f64) -> String {
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

fn enumeration_tables() -> String {
    let mut html = "<table>\n<tr><th>type</th><th>items</th></tr>\n".to_owned();
    for kind in enumerations() {
        let items: Vec<String> = kind
            .items
            .iter()
            .enumerate()
            .map(|(index, (name, about))| format!("{} <code>{name}</code>: {}", index + 1, escape(*about)))
            .collect();
        let _ = writeln!(html, "<tr><td><code>{}</code></td><td>{}</td></tr>", kind.name, items.join("<br>"));
    }
    html + "</table>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn every_variable_stands_in_the_page_and_no_place_is_left_open() {
        for scene in [None, Some("clutch")] {
            let page = write(&scenes::load(scene).unwrap());
            assert!(!page.contains("{{") && !page.contains("}}"));
            for row in TABLE {
                assert!(page.contains(&format!("<code>{}", row.name)), "{}", row.name);
                assert!(page.contains(&*escape(row.description)), "{}", row.name);
            }
        }
    }

    #[test]
    fn values_are_those_of_the_scene_in_both_units() {
        let page = write(&scenes::load(Some("clutch")).unwrap());
        for expected in [
            "<h1>SlidingContact.clutch</h1>",
            "<td>0.039 (39 mm)</td>",
            "<td>333.15 (60 degC)</td>",
            "<td>annular</td>",
        ] {
            assert!(page.contains(expected), "{expected}");
        }
    }
}
