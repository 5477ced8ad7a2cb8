//! Modules of the layers and of the FMU: those beside each other use each other in one direction only.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Path of a module within its crate, from the root.
type Module = Vec<String>;

/// All modules below a folder, each with the part of its text that is compiled into the library.
fn modules(folder: &Path, own: &Module, found: &mut BTreeMap<Module, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let of = |name: String| own.iter().cloned().chain([name]).collect::<Module>();
        if path.is_dir() {
            modules(&path, &of(name), found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && name != "tests" {
            let text = fs::read_to_string(&path).unwrap();
            let compiled = text.split("#[cfg(test)]").next().unwrap().to_owned();
            let lines = compiled.lines().filter(|line| !line.trim_start().starts_with("//"));
            let module = if ["lib", "mod"].contains(&name.as_str()) { own.clone() } else { of(name) };
            found.insert(module, lines.collect::<Vec<_>>().join("\n"));
        }
    }
}

/// Paths that begin at the start of `text`, with its groups in braces written out.
fn paths(text: &str, before: &Module, found: &mut Vec<Module>) {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    let mut path = before.clone();
    if end > 0 {
        path.push(text[..end].to_owned());
    }
    let Some(rest) = text[end..].strip_prefix("::") else { return found.push(path) };
    let Some(group) = rest.strip_prefix('{') else { return paths(rest, &path, found) };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                paths(group[start..at].trim_start(), &path, found);
                start = at + 1;
                if c == '}' {
                    return;
                }
            }
            _ => {}
        }
    }
}

/// Modules that `module` uses by a path from `crate` or `super`.
fn used(module: &Module, text: &str, all: &BTreeMap<Module, String>) -> BTreeSet<Module> {
    let mut named = Vec::new();
    for word in ["crate::", "super::"] {
        for (at, _) in text.match_indices(word) {
            let is_start = !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
            if is_start {
                paths(&text[at..], &Vec::new(), &mut named);
            }
        }
    }
    let absolute = named.into_iter().map(|path| {
        let above = path.iter().take_while(|part| *part == "super").count();
        let base = if above > 0 { &module[..module.len() - above.min(module.len())] } else { &[] };
        base.iter().chain(path.iter().skip(above.max(1))).cloned().collect::<Module>()
    });
    // The longest beginning that is a module; what follows is an item of it.
    let known = absolute
        .filter_map(|path| (1..=path.len()).rev().map(|n| path[..n].to_vec()).find(|path| all.contains_key(path)));
    known.filter(|target| target != module).collect()
}

/// Circles among the modules beside each other, as text.
fn circles(all: &BTreeMap<Module, String>) -> Vec<String> {
    let mut uses: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    for (module, text) in all {
        for target in used(module, text, all) {
            let shared = module.iter().zip(&target).take_while(|(one, other)| one == other).count();
            // A module and those within it belong together.
            if shared < module.len() && shared < target.len() {
                uses.entry(module[..=shared].to_vec()).or_default().insert(target[..=shared].to_vec());
            }
        }
    }
    let reached = |from: &Module| {
        let (mut found, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = next.pop() {
            for target in uses.get(&module).into_iter().flatten() {
                if found.insert(target.clone()) {
                    next.push(target.clone());
                }
            }
        }
        found
    };
    uses.keys().filter(|module| reached(module).contains(*module)).map(|module| module.join("::")).collect()
}

#[test]
fn modules_beside_each_other_form_no_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let layers = ["numerics", "scene", "elasticity", "conduction", "contact", "model", "steady"];
    let folders = layers.map(|layer| root.join("crates").join(layer).join("src")).into_iter().chain([root.join("src")]);
    let mut faults = Vec::new();
    for folder in folders {
        let mut all = BTreeMap::new();
        modules(&folder, &Vec::new(), &mut all);
        assert!(all.len() > 5, "{}", folder.display());
        faults.extend(circles(&all).into_iter().map(|module| format!("{}: {module}", folder.display())));
    }
    assert!(faults.is_empty(), "modules in a circle:\n{}", faults.join("\n"));
}

#[test]
fn a_circle_is_found_through_groups_and_folders() {
    let sources = [
        (vec![], "mod a; mod b; mod c;"),
        (vec!["a"], "use super::b::{Item, inner::{One, Two}};"),
        (vec!["b"], "mod inner; pub struct Item;"),
        (vec!["b", "inner"], "fn f() { crate::c::g() }"),
        (vec!["c"], "use crate::{a::Thing, b};"),
    ];
    let of = |count: usize| -> BTreeMap<Module, String> {
        let own = |path: &Vec<&str>| path.iter().map(|part| (*part).to_owned()).collect();
        sources[..count].iter().map(|(path, text)| (own(path), (*text).to_owned())).collect()
    };
    assert_eq!(circles(&of(4)), Vec::<String>::new());
    assert_eq!(circles(&of(5)), ["a", "b", "c"]);
}
