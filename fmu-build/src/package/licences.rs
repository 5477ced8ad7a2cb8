//! documentation/licenses: the licence of the model and of the libraries compiled into it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result};

use super::Platform;
use crate::project;
use fmu_file::archive::Files;

/// Folder in the FMU.
pub(crate) const FOLDER: &str = "documentation/licenses";

/// Adds the licence files of a package of this workspace and what is compiled into it, below a folder.
pub(crate) fn add(files: &mut Files, package: &str, folder: &str) -> Result<()> {
    let own = ["LICENSE-MIT", "LICENSE-APACHE"];
    let mut index = format!(
        "SlidingContact {}: MIT OR Apache-2.0, at your choice; see {} and {} beside this file.\n\n\
         The library contains the Rust standard library (MIT OR Apache-2.0) and these libraries:\n\n",
        env!("CARGO_PKG_VERSION"),
        own[0],
        own[1]
    );
    for name in own {
        let path = project::root().join(name);
        let text = std::fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
        files.insert(format!("{folder}/{name}"), text);
    }
    for (package, (licence, sources)) in dependencies(package)? {
        let _ = writeln!(index, "{package}: {licence}");
        for (name, text) in texts(&sources).with_context(|| format!("the licence of {package}"))? {
            files.insert(format!("{folder}/{package}/{name}"), text);
        }
    }
    files.insert(format!("{folder}/license.txt"), index.into_bytes());
    Ok(())
}

/// Packages linked into the library on a platform: depth, package and licence of each.
pub(crate) fn tree(root: &str, target: &str) -> Result<String> {
    let linked = ["tree", "--package", root, "--edges", "normal,no-proc-macro", "--prefix", "depth"];
    cargo(&[&linked[..], &["--target", target, "--format", "\t{p}\t{l}"]].concat())
}

fn cargo(arguments: &[&str]) -> Result<String> {
    let mut cargo = project::cargo();
    cargo.args(arguments).arg("--locked").current_dir(project::root());
    project::printed(&mut cargo, "cargo", "listing the packages: ")
}

/// Packages compiled into the library: `name-version`, licence and source folder.
fn dependencies(root: &str) -> Result<BTreeMap<String, (String, PathBuf)>> {
    let target = Platform::Linux64.target();
    let listed = tree(root, target)?;
    let metadata = cargo(&["metadata", "--format-version", "1", "--filter-platform", target])?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata)?;
    let mut folders = BTreeMap::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let manifest = PathBuf::from(text("manifest_path"));
        folders.insert(format!("{} v{}", text("name"), text("version")), manifest);
    }
    let mut found = BTreeMap::new();
    for line in listed.lines() {
        let mut parts = line.split('\t').skip(1);
        let (Some(package), Some(licence)) = (parts.next(), parts.next()) else { continue };
        // A package listed before is marked with `(*)`; the workspace's own ones come with their path.
        let mut words = package.split(' ');
        let (Some(name), Some(version)) = (words.next(), words.next()) else { continue };
        if name == root {
            continue;
        }
        let manifest = folders.get(&format!("{name} {version}")).with_context(|| format!("finding {package}"))?;
        let folder = manifest.parent().map(PathBuf::from).unwrap_or_default();
        found.insert(
            format!("{name}-{}", version.trim_start_matches('v')),
            (licence.trim_end_matches(" (*)").to_owned(), folder),
        );
    }
    Ok(found)
}

/// Files of a package that state its licence; a package without any names it in its manifest only.
fn texts(folder: &PathBuf) -> Result<Vec<(String, Vec<u8>)>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let upper = name.to_uppercase();
        if ["LICENSE", "LICENCE", "COPYING", "NOTICE", "COPYRIGHT"].iter().any(|known| upper.starts_with(known))
            && entry.path().is_file()
        {
            found.push((name, std::fs::read(entry.path())?));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_and_every_library_in_it_have_a_licence() {
        let mut files = Files::new();
        add(&mut files, "sliding-contact", FOLDER).unwrap();
        let index = String::from_utf8(files[&format!("{FOLDER}/license.txt")].clone()).unwrap();
        assert!(files.contains_key(&format!("{FOLDER}/LICENSE-MIT")));
        for package in ["nalgebra-", "libc-"] {
            let line = index.lines().find(|line| line.starts_with(package)).expect(package);
            let licence = line.split_once(": ").unwrap().1;
            assert!(licence.contains("MIT") || licence.contains("Apache-2.0"), "{line}");
        }
        // Only what is compiled in: the command line's own libraries are not.
        assert!(!index.contains("clap-") && !index.contains("toml-"), "{index}");
    }
}
