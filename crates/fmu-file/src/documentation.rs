//! documentation/index.html: introduction, manual, messages and variables of a scene, written in Markdown.

mod markdown;
pub mod pages;
mod tables;

use scene::slot::STOCK_NAME;
use scene::variables::reference;
use scene_file::SceneFile;

use crate::description::SUMMARY;
use crate::xml::number;
use markdown::{contents, escaped, section, to_html};

const FRAME: &str = include_str!("../../../modelDescription/documentation/index.html");
/// What stands in the page alone. The scene's values stand in it as `{{name}}`.
const INTRODUCTION: &str = include_str!("../../../modelDescription/documentation/introduction.md");
const MANUAL: &str = include_str!("../../../docs/manual.md");
const MESSAGES: &str = include_str!("../../../docs/messages.md");

/// Pictures of the page, under their names beside it.
pub const PICTURES: [(&str, &[u8]); 7] = [
    ("model.svg", include_bytes!("../../../docs/model.svg")),
    ("stopping_distance.svg", include_bytes!("../../../examples/vehicle_brake/stopping_distance.svg")),
    ("engagement.svg", include_bytes!("../../../examples/clutch/engagement.svg")),
    ("cold.svg", include_bytes!("../../../docs/realtime/cold.svg")),
    ("steady.svg", include_bytes!("../../../examples/reciprocating_punch/steady.svg")),
    ("hot_spots.svg", include_bytes!("../../../examples/hot_spots/hot_spots.svg")),
    ("sensitivities.svg", include_bytes!("../../../examples/batch/sensitivities.svg")),
];

pub(crate) fn write(scene: &SceneFile) -> String {
    let packaged = &scene.packaged;
    let start = |name: u32| number(packaged.starts[name as usize]);
    let description = match (scene.description.as_str(), packaged.name.as_str()) {
        ("", STOCK_NAME) => format!("{SUMMARY}; the start values are those of a car's front disc brake."),
        ("", _) => format!("{SUMMARY}."),
        (text, _) => format!("{text}."),
    };
    let manual = MANUAL.find("\n## ").map_or(MANUAL, |at| &MANUAL[at + 1..]);
    let variables = pages::variables(&packaged.starts, "Start values are those of this scene.");
    let licence = format!(
        "## Licence and version\n\nVersion {}, GUID `{}`. Licence: MIT or Apache-2.0, at your choice; the texts, and the licences of the \
         libraries inside, are in the folder `licenses` beside this page. The Linux library for x86-64 runs with glibc 2.17 and newer.\n",
        env!("CARGO_PKG_VERSION"),
        packaged.guid()
    );
    let sections = [INTRODUCTION, manual, &section(MESSAGES), &section(&variables), &licence].join("\n");
    let values = [
        ("contents", contents(sections.lines().filter_map(|line| line.strip_prefix("## ")))),
        ("scene", escaped(&packaged.name)),
        ("description", escaped(&description)),
        ("start", number(packaged.experiment.start)),
        ("stop", number(packaged.experiment.stop)),
        ("step", number(packaged.experiment.step)),
        ("velocity", start(const { reference("nominal.velocity") })),
        ("load", start(const { reference("nominal.load") })),
    ];
    let filled = |text: String, (name, value): &(&str, String)| text.replace(&format!("{{{{{name}}}}}"), value);
    let body = to_html(&values.iter().fold(sections, filled));
    [("scene", escaped(&packaged.name)), ("body", body)].iter().fold(FRAME.to_owned(), filled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::TABLE;
    use scene_file::shipped;

    #[test]
    fn every_variable_stands_in_the_page_and_no_place_is_left_open() {
        for scene in [None, Some("clutch")] {
            let page = write(&shipped::load(scene, &crate::examples()).unwrap());
            assert!(!page.contains("{{") && !page.contains("}}"));
            for row in TABLE {
                assert!(page.contains(&format!("<code>{}", row.name)), "{}", row.name);
            }
        }
    }

    #[test]
    fn the_page_needs_nothing_from_outside() {
        let page = write(&shipped::load(None, &crate::examples()).unwrap());
        for outside in ["http:", "https:", "<script", "<link", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        for anchor in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
            let target = anchor.strip_prefix('#').unwrap_or_else(|| panic!("{anchor} leads out of the page"));
            assert_eq!(page.matches(&format!("id=\"{target}\"")).count(), 1, "{anchor}");
        }
        // Pictures lie beside the page, each is shown, and each says in words what it shows.
        let shown: Vec<&str> = page.split("<img src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(shown, PICTURES.map(|(name, _)| name));
        assert_eq!(page.matches("src=").count(), PICTURES.len());
        assert_eq!(page.matches("\" alt=\"").count() - page.matches("\" alt=\"\"").count(), PICTURES.len());
    }

    #[test]
    fn values_are_those_of_the_scene_in_both_units() {
        let page = write(&shipped::load(Some("clutch"), &crate::examples()).unwrap());
        for expected in
            [">SlidingContact.clutch</h1>", "<td>0.039 (39 mm)</td>", "<td>333.15 (60 degC)</td>", "<td>annular</td>"]
        {
            assert!(page.contains(expected), "{expected}");
        }
    }
}
