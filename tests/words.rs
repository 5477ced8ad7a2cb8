//! Private words of former versions do not come back: tests/words.toml lists them with the field's terms.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// A word or phrase, and what to write instead.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    words: Vec<String>,
    term: String,
    #[serde(default)]
    allowed: Vec<String>,
}

#[derive(serde::Deserialize)]
struct Rules {
    rule: Vec<Rule>,
}

fn rules() -> Vec<Rule> {
    toml::from_str::<Rules>(include_str!("words.toml")).unwrap().rule
}

fn is_part_of_word(letter: Option<char>) -> bool {
    letter.is_some_and(|letter| letter.is_alphanumeric() || letter == '_')
}

/// Text of a doc comment's line.
fn of_doc(line: &str) -> Option<&str> {
    let line = line.trim_start();
    Some(line.strip_prefix("///").or(line.strip_prefix("//!"))?.trim_start())
}

/// Whether a line holds a word as a whole; `word*`: with any ending; `^word`: at the beginning of a doc comment's line.
fn holds(line: &str, word: &str) -> bool {
    let (line, begins, word) = match word.strip_prefix('^') {
        Some(word) => match of_doc(line) {
            Some(text) => (text, true, word),
            None => return false,
        },
        None => (line, false, word),
    };
    let (word, open) = word.strip_suffix('*').map_or((word, false), |word| (word, true));
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        (!begins || at == 0) && !is_part_of_word(before) && (open || !is_part_of_word(after))
    })
}

/// Sources and pages below a folder, as paths from the root of the project.
fn texts(root: &Path, folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(root.join(folder)).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let path = folder.join(&name);
        if entry.file_type().unwrap().is_dir() {
            let is_generated = name.starts_with('.') || ["target", "__pycache__"].contains(&name.as_str());
            if !is_generated && path != Path::new("tests/golden/records") && path != Path::new("docs/accuracy") {
                texts(root, &path, found);
            }
        } else if ["rs", "md", "py", "html"].iter().any(|kind| path.extension().is_some_and(|own| own == *kind)) {
            found.push(path);
        }
    }
}

/// Of the changelog, what is not yet released: its history says what it said.
fn judged<'a>(path: &Path, text: &'a str) -> &'a str {
    if path != Path::new("CHANGELOG.md") {
        return text;
    }
    let first = text.find("\n## ").map_or(text.len(), |at| at + 1);
    let second = text[first..].find("\n## ").map_or(text.len(), |at| first + at);
    &text[..second]
}

/// Every use of a listed word: file, line, word, term.
fn uses(rules: &[Rule], path: &Path, text: &str) -> String {
    let mut told = String::new();
    let name = path.to_str().unwrap();
    for rule in rules {
        if rule.allowed.iter().any(|allowed| name == allowed || allowed.ends_with('/') && name.starts_with(allowed)) {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            for word in rule.words.iter().filter(|word| holds(line, word)) {
                writeln!(told, "{name}:{}: \"{word}\"; the field says: {}", number + 1, rule.term).unwrap();
            }
        }
    }
    told
}

#[test]
fn no_private_word_has_come_back() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    texts(root, Path::new(""), &mut found);
    assert!(found.len() > 300, "{} files", found.len());
    found.retain(|path| path != Path::new(file!()));
    let rules = rules();
    let read = |path: &PathBuf| fs::read_to_string(root.join(path)).unwrap();
    let told: String = found.iter().map(|path| uses(&rules, path, judged(path, &read(path)))).collect();
    assert!(told.is_empty(), "{} uses of private words:\n{told}", told.lines().count());
}

#[test]
fn a_listed_word_is_found_with_its_file_line_and_term() {
    let rule = |words: &[&str], allowed: &[&str]| Rule {
        words: words.iter().map(|word| (*word).to_owned()).collect(),
        term: "model level".to_owned(),
        allowed: allowed.iter().map(|file| (*file).to_owned()).collect(),
    };
    let text = "//! Levels.\n/// The rung above.\nfn rungs() {}\n/// What is held.\n// What else, strung\n";
    let told = |words: &[&str], allowed: &[&str]| uses(&[rule(words, allowed)], Path::new("src/level.rs"), text);
    assert_eq!(told(&["rung"], &[]), "src/level.rs:2: \"rung\"; the field says: model level\n");
    assert_eq!(told(&["rung*"], &[]).lines().count(), 2);
    assert_eq!(told(&["^What"], &[]), "src/level.rs:4: \"^What\"; the field says: model level\n");
    assert_eq!(told(&["rung*"], &["src/"]), "");
    assert_eq!(told(&["rung*"], &["src/level.rs"]), "");
    let changes = "# Changes\n## Unreleased\nNew rung.\n## 0.1\nFirst rung.\n";
    assert_eq!(judged(Path::new("CHANGELOG.md"), changes).matches("rung").count(), 1);
}

#[test]
fn every_rule_names_its_words_and_what_to_write_instead() {
    for rule in rules() {
        assert!(!rule.words.is_empty() && !rule.term.is_empty());
        for word in &rule.words {
            assert!(word.len() > 2 && word.trim() == word, "{word:?}");
        }
        for file in &rule.allowed {
            assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(file).exists(), "{file} is allowed and does not exist");
        }
    }
}
