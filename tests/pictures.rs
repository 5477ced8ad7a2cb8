//! Pictures of the pages: drawings that scale, with the units of their axes as the International System writes them.

use std::fs;
use std::path::{Path, PathBuf};

fn pictures(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pictures(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "svg") {
            found.push(path);
        }
    }
}

/// Whether a label has a unit as it is typed on a keyboard, or the unit 1.
fn is_typed(label: &str) -> bool {
    let ends = [
        ", 1", "[1]", ", um", ", µm", ", us", ", µs", ", s", ", °C", ", MPa", ", mm", "[s]", "[m]", "[mm]", "[um]",
        "(um)", "(us)", "[N m]", "(N m)",
    ];
    ends.iter().any(|end| label.trim_end().ends_with(end))
}

/// Texts of a drawing; of a picture whose letters are paths there are none.
fn texts(drawing: &str) -> Vec<&str> {
    let parts = drawing.split("<text").skip(1).filter_map(|part| part.split_once('>'));
    parts.map(|(_, rest)| rest.split('<').next().unwrap_or("").trim()).collect()
}

#[test]
fn every_picture_is_a_drawing_with_texts_and_units() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    pictures(&root.join("docs"), &mut found);
    pictures(&root.join("examples"), &mut found);
    assert!(found.len() >= 50, "{} pictures", found.len());
    let mut wrong = Vec::new();
    for path in found {
        let drawing = fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(root).unwrap().display().to_string();
        if drawing.contains("<image") {
            wrong.push(format!("{name} has a bitmap"));
        }
        let texts = texts(&drawing);
        if texts.is_empty() {
            wrong.push(format!("{name} has no text"));
        }
        wrong.extend(texts.iter().filter(|text| is_typed(text)).map(|text| format!("{name}: {text}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_typed_unit_is_found() {
    let drawing = "<svg><text x=\"1\">\ntime, us\n</text><text>pressure (MPa)</text></svg>";
    assert_eq!(texts(drawing), ["time, us", "pressure (MPa)"]);
    assert!(is_typed("time, us") && is_typed("stop [1]") && !is_typed("pressure (MPa)") && !is_typed("cells N"));
}
