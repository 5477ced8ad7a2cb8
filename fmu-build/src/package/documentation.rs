//! documentation/index.html: the committed page with the tables of the variables and the scene's values filled in.

mod markdown;
pub mod pages;
mod tables;

use std::fmt::Write;

use quick_xml::escape::escape;
use scene::slot::STOCK_NAME;
use scene::variables::reference;
use scene_file::SceneFile;

use super::description::{LOG_CATEGORIES, SUMMARY, enumerations};
use super::xml::number;

/// The page without its tables and values, which stand in it as `{{name}}`.
const PAGE: &str = include_str!("../../../modelDescription/documentation/index.html");
/// Its section on importers.
const IMPORTERS: &str = include_str!("../../../modelDescription/documentation/importers.html");
/// Its section on messages.
const MESSAGES: &str = include_str!("../../../modelDescription/documentation/messages.html");

/// Pictures of the page, under their names beside it.
pub const PICTURES: [(&str, &[u8]); 7] = [
    ("model.svg", include_bytes!("../../../docs/model.svg")),
    ("stopping_distance.svg", include_bytes!("../../../examples/vehicle_brake/stopping_distance.svg")),
    ("engagement.svg", include_bytes!("../../../examples/clutch/engagement.svg")),
    ("realtime.svg", include_bytes!("../../../docs/realtime/cold.svg")),
    ("steady.svg", include_bytes!("../../../examples/reciprocating_punch/steady.svg")),
    ("hot_spots.svg", include_bytes!("../../../examples/hot_spots/hot_spots.svg")),
    ("sensitivities.svg", include_bytes!("../../../examples/batch/sensitivities.svg")),
];

/// Writes the page for a scene.
pub fn write(scene: &SceneFile) -> String {
    let packaged = &scene.packaged;
    let start = |name: u32| number(packaged.starts[name as usize]);
    let description = match (scene.description.as_str(), packaged.name.as_str()) {
        ("", STOCK_NAME) => format!("{SUMMARY}; the start values are those of a car's front disc brake."),
        ("", _) => format!("{SUMMARY}."),
        (text, _) => format!("{text}."),
    };
    let values = [
        ("importers", IMPORTERS.to_owned()),
        ("messages", MESSAGES.to_owned()),
        ("scene", escape(packaged.name.as_str()).into_owned()),
        ("description", escape(description.as_str()).into_owned()),
        ("start", number(packaged.experiment.start)),
        ("stop", number(packaged.experiment.stop)),
        ("step", number(packaged.experiment.step)),
        ("velocity", start(const { reference("nominal.velocity") })),
        ("load", start(const { reference("nominal.load") })),
        ("categories", categories()),
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

/// Log categories with their meaning, as a list in a sentence.
fn categories() -> String {
    let categories: Vec<String> =
        LOG_CATEGORIES.iter().map(|(name, about)| format!("<code>{name}</code> ({})", escape(*about))).collect();
    categories.join(", ")
}

fn variables(starts: &[f64]) -> String {
    let mut html = String::new();
    for topic in tables::topics(starts) {
        let kind = match topic.title {
            "Inputs" | "Outputs" => "",
            _ if topic.given => "Parameters: ",
            _ => "Results, to be read but not to be connected: ",
        };
        let class = if topic.given { "variables given" } else { "variables" };
        let _ = write!(
            html,
            "<h3>{kind}{}</h3>\n<div class=\"wide\"><table class=\"{class}\">\n<tr><th>name</th><th>unit</th>",
            topic.title
        );
        html += if topic.given { "<th>start</th><th>limits</th>" } else { "" };
        html += "<th>meaning</th></tr>\n";
        for entry in &topic.entries {
            let _ = write!(html, "<tr><td><code>{}</code></td><td class=\"number\">{}</td>", entry.name, entry.unit);
            if topic.given {
                let class = if entry.limits.contains(", ") { "" } else { " class=\"number\"" };
                let _ = write!(html, "<td>{}</td><td{class}>{}</td>", entry.start, entry.limits);
            }
            let _ = writeln!(html, "<td>{}</td></tr>", escape(entry.meaning.as_str()));
        }
        html += "</table></div>\n";
    }
    html
}

fn enumeration_tables() -> String {
    let mut html = "<div class=\"wide\"><table>\n<tr><th>type</th><th>items</th></tr>\n".to_owned();
    for kind in enumerations() {
        let items: Vec<String> = kind
            .items
            .iter()
            .enumerate()
            .map(|(index, (name, about))| format!("{} <code>{name}</code>: {}", index + 1, escape(*about)))
            .collect();
        let _ = writeln!(html, "<tr><td><code>{}</code></td><td>{}</td></tr>", kind.name, items.join("<br>"));
    }
    html + "</table></div>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use model::lumped::limit;
    use scene::variables::TABLE;

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

    /// The page's text without tags and entities, white space made one blank.
    fn plain(html: &str) -> String {
        let mut text = String::new();
        let mut inside = false;
        for letter in html.chars() {
            match letter {
                '<' => inside = true,
                '>' => inside = false,
                _ if !inside => text.push(letter),
                _ => {}
            }
        }
        let text = text.replace("&gt;", ">").replace("&lt;", "<").replace("&hellip;", "\u{2026}").replace("&amp;", "&");
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The first text after every `marker` in a source file, each as its longest part between places for values.
    fn messages(source: &str, marker: &str) -> Vec<String> {
        let code = source.split("#[cfg(test)]").next().unwrap();
        let text = |rest: &str| {
            let start = rest.find('"')?;
            // Between the marker and the text there are only white space, a formatter and opening brackets.
            let between = rest[..start].trim().trim_end_matches(['\n', ' ']);
            if !["", "format!(", "f,", "text,"].contains(&between) {
                return None;
            }
            let rest = &rest[start + 1..];
            let written = rest[..rest.find('"')?].replace("\\\n", " ");
            let mut parts = Vec::new();
            for part in written.split('{') {
                parts.push(part.split_once('}').map_or(part, |(_, after)| after));
            }
            let longest = parts.into_iter().max_by_key(|part| part.len())?;
            Some(longest.split_whitespace().collect::<Vec<_>>().join(" "))
        };
        code.split(marker).skip(1).filter_map(text).filter(|text| !text.is_empty()).collect()
    }

    #[test]
    fn every_message_of_the_model_stands_in_the_page() {
        let page = plain(MESSAGES);
        let sources = [
            ("rules", include_str!("../../../crates/scene/src/rules.rs"), "broken(", 20),
            ("lumped level", include_str!("../../../crates/model/src/lumped/advance.rs"), "StepFailure(", 1),
            ("work of a step", include_str!("../../../crates/model/src/budget.rs"), "StepFailure(", 1),
            ("bodies worn through", include_str!("../../../crates/model/src/lumped/mod.rs"), "StepFailure(", 1),
            ("line level", include_str!("../../../crates/model/src/line/mod.rs"), "StepFailure(", 1),
            ("operator split", include_str!("../../../crates/model/src/line/staggered.rs"), "StepFailure(", 1),
            ("growth", include_str!("../../../crates/model/src/line/growth.rs"), "Err(", 1),
            ("growth", include_str!("../../../crates/model/src/line/growth.rs"), "write!(", 1),
            (
                "critical speed",
                include_str!("../../../crates/model/src/instability.rs"),
                "write!(\n            text,\n            ",
                1,
            ),
            ("step of the line", include_str!("../../../crates/model/src/line/step.rs"), "StepFailure(", 2),
            ("steady states", include_str!("../../../crates/steady/src/lib.rs"), "write!(", 7),
            ("contact", include_str!("../../../crates/contact/src/problem.rs"), "write!(", 4),
            ("wear stage", include_str!("../../../crates/contact/src/wear/line/contact.rs"), "write!(", 1),
            ("steps", include_str!("../../../src/component.rs"), "return Err(", 2),
            ("outputs", include_str!("../../../src/component/outputs.rs"), "return Err(", 2),
            ("warnings", include_str!("../../../crates/model/src/levels.rs"), "warnings.push(", 1),
            (
                "warnings of the line",
                include_str!("../../../crates/model/src/line/operators.rs"),
                "warnings.push(format!(",
                1,
            ),
            ("error of a run", include_str!("../../../crates/model/src/run_error.rs"), "write!(", 5),
            ("limits", include_str!("../../../src/component/reports.rs"), "(limit::WEAR, ", 1),
            ("limits", include_str!("../../../src/component/reports.rs"), "limit::VALIDITY,", 1),
            ("limits with values", include_str!("../../../src/component/reports.rs"), "let text = format_args!(", 3),
            ("temperatures", include_str!("../../../crates/scene/src/warnings.rs"), "    format!(", 1),
            ("instance", include_str!("../../../src/fmi2/instance.rs"), "refuse(&format!(", 2),
            ("instance", include_str!("../../../src/fmi2/instance.rs"), "refuse(", 1),
            ("instance", include_str!("../../../src/fmi2/instance.rs"), "argument(", 3),
            ("arguments of steps", include_str!("../../../src/fmi2/instance/steps.rs"), "argument(", 3),
            ("derivatives", include_str!("../../../src/fmi2/instance/variables.rs"), "argument(", 3),
            ("states", include_str!("../../../src/fmi2/instance/states.rs"), "argument(", 1),
            ("serialised states", include_str!("../../../src/fmi2/state.rs"), "Err(", 3),
            ("value references", include_str!("../../../src/fmi2/problem.rs"), "None => ", 1),
        ];
        // Said by functions that no importer reaches.
        let inside =
            ["is not an output", "is not an input", "the component is not initialised", "no derivatives before"];
        for (name, source, marker, least) in sources {
            let found = messages(source, marker);
            assert!(found.len() >= least, "{name}: {} messages of at least {least}: {found:?}", found.len());
            for message in found.iter().filter(|message| !inside.iter().any(|text| message.contains(text))) {
                assert!(page.contains(message.as_str()), "{name}: {message:?} is not in the page");
            }
        }
    }

    #[test]
    fn every_bit_of_limit_reached_stands_in_the_page() {
        for bit in [limit::WEAR, limit::TEMPERATURE, limit::VALIDITY] {
            assert!(MESSAGES.contains(&format!("<tr><td>{bit}</td>")), "bit {bit}");
        }
    }

    #[test]
    fn the_page_needs_nothing_from_outside() {
        let page = write(&scenes::load(None).unwrap());
        for outside in ["http:", "https:", "<script", "<link", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        for anchor in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
            let target = anchor.strip_prefix('#').unwrap_or_else(|| panic!("{anchor} leads out of the page"));
            assert!(page.contains(&format!("id=\"{target}\"")), "{anchor} leads nowhere");
        }
        // Pictures lie beside the page, each is shown, and each says in words what it shows.
        let shown: Vec<&str> = page.split("<img src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(shown, PICTURES.map(|(name, _)| name));
        assert_eq!(page.matches("src=").count(), PICTURES.len());
        assert_eq!(page.matches("\" alt=\"").count(), PICTURES.len());
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
