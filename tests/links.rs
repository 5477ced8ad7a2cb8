//! Relative links of the Markdown pages lead to files of the source tree, and their anchors to headings.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Markdown pages below a folder, as paths from the root of the project.
fn pages(root: &Path, folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(root.join(folder)).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let path = folder.join(&name);
        if entry.file_type().unwrap().is_dir() {
            if !name.starts_with('.') && name != "target" {
                pages(root, &path, found);
            }
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// Lines outside code blocks, with code within a line left empty.
fn prose(text: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    let mut in_block = false;
    text.lines().enumerate().filter_map(move |(number, line)| {
        let fence = line.trim_start().starts_with("```");
        in_block ^= fence;
        let indented = line.starts_with("    ") && !line.trim_start().starts_with(['-', '*', '[', '!']);
        (!in_block && !fence && !indented).then(|| {
            let parts: Vec<&str> = line.split('`').collect();
            (number + 1, parts.iter().step_by(2).copied().collect::<Vec<_>>().join("``"))
        })
    })
}

/// Targets of the links and pictures in a line.
fn targets(line: &str) -> Vec<&str> {
    let closed = |rest: &'_ str| rest.find(')');
    let ends = line.match_indices("](").map(|(at, _)| &line[at + 2..]);
    ends.filter_map(|rest| Some(rest[..closed(rest)?].split_whitespace().next().unwrap_or_default())).collect()
}

/// Anchor of a heading as repositories make it: lower case, blanks as hyphens, punctuation left out.
fn anchor(heading: &str) -> String {
    // Of a link its text.
    let mut text = String::new();
    let mut rest = heading;
    while let Some(at) = rest.find("](") {
        text += &rest[..at];
        rest = rest[at..].split_once(')').map_or("", |(_, rest)| rest);
    }
    text += rest;
    let kept = |letter: &char| letter.is_alphanumeric() || [' ', '-', '_'].contains(letter);
    text.trim().to_lowercase().chars().filter(kept).map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut in_block = false;
    for line in text.lines() {
        in_block ^= line.trim_start().starts_with("```");
        let level = line.len() - line.trim_start_matches('#').len();
        if in_block || level == 0 || !line[level..].starts_with(' ') {
            continue;
        }
        let own = anchor(&line[level..]);
        let same = found.iter().filter(|known| **known == own).count();
        found.push(if same == 0 { own } else { format!("{own}-{same}") });
    }
    found
}

/// A path without `..`; `None` where it leaves the project.
fn normal(path: &Path) -> Option<PathBuf> {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if !parts.pop() => return None,
            Component::Normal(part) => parts.push(part),
            _ => {}
        }
    }
    Some(parts)
}

/// Every link that leads nowhere: page, line, target, fault.
fn faults(root: &Path, texts: &BTreeMap<PathBuf, String>) -> String {
    let mut told = String::new();
    for (page, text) in texts {
        for (number, line) in prose(text) {
            for target in targets(&line) {
                if target.contains("://") || target.starts_with("mailto:") {
                    continue;
                }
                let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
                let path = if file.is_empty() {
                    Some(page.clone())
                } else {
                    normal(&page.parent().expect("a page is in a folder").join(file))
                };
                let fault = match path {
                    None => "leads out of the project".to_owned(),
                    Some(path) if !texts.contains_key(&path) && !root.join(&path).exists() => {
                        format!("{} does not exist", path.display())
                    }
                    Some(path) => match texts.get(&path) {
                        Some(text) if !anchor.is_empty() && !anchors(text).iter().any(|known| known == anchor) => {
                            format!("{} has no heading #{anchor}", path.display())
                        }
                        None if !anchor.is_empty() => "only a Markdown page has anchors".to_owned(),
                        _ => continue,
                    },
                };
                writeln!(told, "{}:{number}: {target}: {fault}", page.display()).unwrap();
            }
        }
    }
    told
}

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    pages(root, Path::new(""), &mut found);
    assert!(found.len() > 20, "{} pages", found.len());
    let texts: BTreeMap<PathBuf, String> =
        found.into_iter().map(|path| (path.clone(), fs::read_to_string(root.join(path)).unwrap())).collect();
    let told = faults(root, &texts);
    assert!(told.is_empty(), "{} links lead nowhere:\n{told}", told.lines().count());
}

#[test]
fn a_link_that_leads_nowhere_is_found() {
    let page = "# A *b*, `c_d` [e](f.md)\n## Two\n## Two\n[x](other.md#two-1) [y](#a-b-c_d-e) ![z](docs/none.svg)\n\
                [up](../out.md) [w](other.md#three) `[code](none.md)` [site](https://example.org/none)\n```\n[b](none.md)\n```\n";
    let texts: BTreeMap<PathBuf, String> =
        [("README.md", page), ("other.md", "# Two\n### Two\n")].map(|(name, text)| (name.into(), text.into())).into();
    let told = faults(Path::new(env!("CARGO_MANIFEST_DIR")), &texts);
    let expected = [
        "README.md:1: f.md: f.md does not exist",
        "README.md:4: docs/none.svg: docs/none.svg does not exist",
        "README.md:5: ../out.md: leads out of the project",
        "README.md:5: other.md#three: other.md has no heading #three",
    ];
    assert_eq!(told.lines().collect::<Vec<_>>(), expected);
}
