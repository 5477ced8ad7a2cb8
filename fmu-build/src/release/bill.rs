//! Software bill of materials in CycloneDX JSON: the packages linked into a shipped library.
//!
//! Written and validated by the CycloneDX library for Python, in an environment of its own: the one for Rust would add 35 packages to
//! every build of this program.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::package::Platform;
use crate::package::licences::tree;
use crate::{project, python};

const PROGRAM: &str = include_str!("../../python/sbom.py");

/// The bill of a package's library, built for these platforms, as JSON.
pub(crate) fn write(root: &str, platforms: &[Platform]) -> Result<String> {
    let python = python::own(python::RELEASE)?;
    let mut packages = Packages { root: root.to_owned(), checksums: checksums(&lock()?), ..Packages::default() };
    for platform in platforms {
        packages.add(&tree(root, platform.target())?)?;
    }
    // Given, the bill depends on the source alone.
    let time = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => {
            text.parse().with_context(|| format!("SOURCE_DATE_EPOCH={text:?} must be whole seconds since 1970"))?
        }
        Err(_) => SystemTime::now().duration_since(UNIX_EPOCH)?.as_secs(),
    };
    let mut command = Command::new(&python);
    let input = packages.json(time)?.to_string();
    let output = project::fed(command.args(["-c", PROGRAM]), &python.display().to_string(), input.as_bytes())?;
    if !output.status.success() {
        bail!("the bill of materials: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(String::from_utf8(output.stdout)?)
}

fn lock() -> Result<String> {
    let path = project::root().join("Cargo.lock");
    std::fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))
}

/// Packages as `name@version`, of one platform or of several.
#[derive(Default)]
struct Packages {
    /// Name of the package with the library.
    root: String,
    licences: BTreeMap<String, String>,
    checksums: BTreeMap<String, String>,
    depends: BTreeSet<(String, String)>,
}

impl Packages {
    /// Adds what the output of `cargo tree` lists, whose lines are depth, package and licence.
    fn add(&mut self, tree: &str) -> Result<()> {
        let mut above: Vec<String> = Vec::new();
        for line in tree.lines() {
            let mut parts = line.split('\t');
            let (Some(depth), Some(package), Some(licence)) = (parts.next(), parts.next(), parts.next()) else {
                bail!("cargo tree: {line:?} is not depth, package and licence");
            };
            let mut words = package.split(' ');
            let (Some(name), Some(version)) = (words.next(), words.next()) else { bail!("cargo tree: {line:?}") };
            let package = format!("{name}@{}", version.trim_start_matches('v'));
            let depth: usize = depth.parse().with_context(|| format!("cargo tree: {line:?}"))?;
            ensure!(depth <= above.len(), "cargo tree: {line:?} has no package above it");
            above.truncate(depth);
            if let Some(user) = above.last() {
                self.depends.insert((user.clone(), package.clone()));
            }
            let licence = licence.trim_end_matches("(*)").trim();
            ensure!(!licence.is_empty(), "{package} names no licence");
            self.licences.insert(package.clone(), licence.to_owned());
            above.push(package);
        }
        Ok(())
    }

    fn json(&self, time: u64) -> Result<Value> {
        let mut root = None;
        let mut components = Vec::new();
        for (package, licence) in &self.licences {
            let (name, version) = package.split_once('@').context("no version")?;
            let entry = json!({
                "name": name, "version": version, "licence": licence, "sha256": self.checksums.get(package),
            });
            if name == self.root {
                root = Some(entry);
            } else {
                components.push(entry);
            }
        }
        let root = root.context("cargo tree does not list the library itself")?;
        Ok(json!({ "root": root, "components": components, "depends": self.depends, "time": time }))
    }
}

/// SHA-256 of every package of a lock file that comes from a registry.
fn checksums(lock: &str) -> BTreeMap<String, String> {
    let value = |block: &str, key: &str| {
        let text = block.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \"")?.strip_suffix('"'));
        text.map(str::to_owned)
    };
    let entry =
        |block| Some((format!("{}@{}", value(block, "name")?, value(block, "version")?), value(block, "checksum")?));
    lock.split("[[package]]").filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_depends_on_those_one_deeper_and_has_its_checksum() {
        let tree =
            "0\tsliding-contact v0.1.0 (/source)\tMIT\n1\ta v1.0.0\tMIT\n2\tb v2.0.0\tISC\n1\tb v2.0.0\tISC (*)\n";
        let lock = "[[package]]\nname = \"b\"\nversion = \"2.0.0\"\nchecksum = \"00ff\"\n\n[[package]]\nname = \"a\"\n";
        let empty = || Packages { root: "sliding-contact".into(), checksums: checksums(lock), ..Packages::default() };
        let mut packages = empty();
        packages.add(tree).unwrap();
        let pair = |user: &str, used: &str| (user.to_owned(), used.to_owned());
        let expected = [
            pair("a@1.0.0", "b@2.0.0"),
            pair("sliding-contact@0.1.0", "a@1.0.0"),
            pair("sliding-contact@0.1.0", "b@2.0.0"),
        ];
        assert_eq!(packages.depends, expected.into());
        let json = packages.json(0).unwrap();
        assert_eq!(json["root"]["name"], "sliding-contact");
        assert_eq!(json["components"].as_array().unwrap().len(), 2);
        assert_eq!(json["components"][1], json!({"name": "b", "version": "2.0.0", "licence": "ISC", "sha256": "00ff"}));
        assert!(json["components"][0]["sha256"].is_null());
        assert!(empty().add("1\ta v1.0.0\tMIT\n").is_err());
        assert!(empty().add("0\ta v1.0.0\t\n").is_err());
        // Another platform adds what only it links.
        packages.add("0\tsliding-contact v0.1.0 (/source)\tMIT\n1\tc v3.0.0\tMIT\n").unwrap();
        assert_eq!(packages.licences.len(), 4);
        assert!(packages.depends.contains(&pair("sliding-contact@0.1.0", "c@3.0.0")) && packages.depends.len() == 4);
    }
}
