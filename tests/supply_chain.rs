//! Dependencies: licences, versions and sources as deny.toml lists them, pinned and locked; `unsafe` only where it is listed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

/// Manifests of the workspaces, with their lock files beside them.
const WORKSPACES: [&str; 2] = ["Cargo.toml", "tests/importers/Cargo.toml"];

/// Files outside of tests that contain `unsafe`, and why they must.
const UNSAFE: [(&str, &str); 19] = [
    ("python/native/src/lib.rs", "functions of the C interface of the Python package"),
    ("crates/scene/src/slot.rs", "volatile read of the scene that packaging writes into the library"),
    ("crates/numerics/src/cache.rs", "allocator that counts, of a unit test"),
    ("crates/test-support/src/importer.rs", "calls of the C interface, of tests"),
    ("crates/verification/src/clock.rs", "processor time of a thread, from the system"),
    ("src/fmi2/exports.rs", "functions of the C interface"),
    ("src/fmi2/arguments.rs", "arrays of the importer"),
    ("src/fmi2/registry.rs", "instances behind their handles"),
    ("src/panics.rs", "a thread of the system, on which operators are built, and cancellation"),
    ("src/fmi2/log.rs", "the importer's logger"),
    ("src/fmi2/floating_point.rs", "floating-point registers"),
    ("src/fmi2/gate.rs", "the importer's logger, of unit tests"),
    ("src/fmi2/types.rs", "types of the importer's functions"),
    ("fmu-build/host/src/timing.rs", "calls of a loaded FMU"),
    ("fmu-build/lab/src/fuzz", "calls of the C interface in any order"),
    ("fmu-build/host/src/functions.rs", "calls of a loaded FMU"),
    ("fmu-build/host/src/worker.rs", "calls of a loaded FMU"),
    ("fmu-build/host/src/worker", "calls of a loaded FMU"),
    ("fmu-build/host/src/c_interface.rs", "C interface of the host"),
];

/// Crates that forbid `unsafe` altogether; the others are those of [`UNSAFE`].
const SAFE: [&str; 9] =
    ["analyses", "conduction", "contact", "elasticity", "exact", "model", "numerics", "scene-file", "steady"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[derive(Deserialize)]
struct Rules {
    licenses: Licenses,
    bans: Bans,
    sources: Sources,
}

#[derive(Deserialize)]
struct Licenses {
    allow: BTreeSet<String>,
}

#[derive(Deserialize)]
struct Bans {
    skip: Vec<Skip>,
}

#[derive(Deserialize)]
struct Skip {
    #[serde(rename = "crate")]
    package: String,
    reason: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    allow_registry: Vec<String>,
    allow_git: Vec<String>,
}

fn rules() -> Rules {
    toml::from_str(&read("deny.toml")).unwrap()
}

/// Packages that are compiled anywhere for any target, as `name@version`, with their licences; [`None`]: the package gives none.
fn compiled(manifest: &str) -> BTreeMap<String, Option<String>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["tree", "--locked", "--workspace", "--target", "all", "--edges", "normal,build,dev", "--prefix", "none"])
        .args(["--format", "{p}\t{l}", "--manifest-path", manifest])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{manifest}: {}", String::from_utf8_lossy(&output.stderr));
    let mut packages = BTreeMap::new();
    for line in String::from_utf8(output.stdout).unwrap().lines().filter(|line| !line.is_empty()) {
        let (package, licence) = line.split_once('\t').unwrap();
        let mut words = package.split(' ');
        let (name, version) = (words.next().unwrap(), words.next().unwrap().trim_start_matches('v'));
        let licence = licence.trim_end_matches("(*)").trim();
        packages.insert(format!("{name}@{version}"), (!licence.is_empty()).then(|| licence.to_owned()));
    }
    assert!(packages.len() > 100, "{manifest}: {} packages", packages.len());
    packages
}

/// Whether an SPDX expression is met by these licences. Of nested expressions those that are a conjunction of alternatives are
/// understood; any other is refused.
fn is_met(expression: &str, allowed: &BTreeSet<String>) -> bool {
    expression.replace('/', " OR ").split(" AND ").all(|alternatives| {
        let alternatives = alternatives.trim();
        let inner = alternatives.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(alternatives);
        !inner.contains(['(', ')']) && inner.split(" OR ").any(|licence| allowed.contains(licence.trim()))
    })
}

#[test]
fn a_licence_expression_is_met_by_one_alternative_of_every_conjunct() {
    let allowed = ["MIT", "Unicode-3.0"].map(str::to_owned).into();
    for met in ["MIT", "MIT/Apache-2.0", "GPL-3.0-only OR MIT", "(MIT OR Apache-2.0) AND Unicode-3.0"] {
        assert!(is_met(met, &allowed), "{met}");
    }
    for refused in ["", "GPL-3.0-only", "MIT AND GPL-3.0-only", "MIT OR (A AND B)", "MIT WITH exception"] {
        assert!(!is_met(refused, &allowed), "{refused}");
    }
}

#[test]
fn licences_are_those_allowed() {
    let rules = rules();
    for manifest in WORKSPACES {
        for (package, licence) in compiled(manifest) {
            let licence = licence.unwrap_or_default();
            assert!(
                is_met(&licence, &rules.licenses.allow),
                "{manifest}: {package}: licence {licence:?}; see deny.toml"
            );
        }
    }
}

#[test]
fn a_second_version_of_a_package_is_listed() {
    let rules = rules();
    let mut unused: BTreeSet<String> = rules.bans.skip.iter().map(|skip| skip.package.clone()).collect();
    assert!(rules.bans.skip.iter().all(|skip| !skip.reason.is_empty()));
    for manifest in WORKSPACES {
        let packages = compiled(manifest);
        let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for package in packages.keys() {
            versions.entry(package.split('@').next().unwrap()).or_default().push(package);
        }
        for (_, found) in versions.into_iter().filter(|(_, found)| found.len() > 1) {
            let unlisted = |package: &&&str| rules.bans.skip.iter().all(|skip| skip.package != **package);
            assert!(found.iter().filter(unlisted).count() <= 1, "{manifest}: {found:?}; see deny.toml");
            for package in found {
                unused.remove(package);
            }
        }
    }
    assert!(unused.is_empty(), "listed in deny.toml, and no second version: {unused:?}");
}

#[test]
fn packages_come_from_the_registry_with_their_checksums() {
    let rules = rules();
    assert!(rules.sources.allow_git.is_empty());
    for manifest in WORKSPACES {
        let lock: toml::Table = toml::from_str(&read(manifest.replace("Cargo.toml", "Cargo.lock"))).unwrap();
        let text = |package: &toml::Value, key: &str| package.get(key).map(|value| value.as_str().unwrap().to_owned());
        for package in lock["package"].as_array().unwrap() {
            let name = text(package, "name").unwrap();
            let Some(source) = text(package, "source") else {
                let is_own = ["sliding-contact", "fmu-", "importers"].iter().any(|own| name.starts_with(own));
                assert!(is_own, "{manifest}: {name} has no source");
                continue;
            };
            let from = source.strip_prefix("registry+").unwrap_or_default().to_owned();
            assert!(rules.sources.allow_registry.contains(&from), "{manifest}: {name} comes from {source}");
            let checksum = text(package, "checksum").unwrap_or_default();
            assert_eq!(checksum.len(), 64, "{manifest}: {name} has no SHA-256");
        }
    }
}

fn files(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    // Nothing in the tree is deeper; links are not followed.
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if entry.file_type().unwrap().is_dir() {
                if path.file_name().unwrap() != "target" {
                    folders.push(path);
                }
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path);
            }
        }
    }
}

fn manifests() -> Vec<PathBuf> {
    let mut found = vec![root().join("Cargo.toml"), root().join("tests/importers/Cargo.toml")];
    ["crates", "fmu-build"].iter().for_each(|folder| files(&root().join(folder), "Cargo.toml", &mut found));
    found
}

#[test]
fn dependencies_are_pinned_to_one_version() {
    for path in manifests() {
        let manifest: toml::Table = toml::from_str(&read(&path)).unwrap();
        let workspace = manifest.get("workspace").and_then(toml::Value::as_table);
        for table in [Some(&manifest), workspace].into_iter().flatten() {
            for kind in ["dependencies", "dev-dependencies", "build-dependencies"] {
                for (name, requirement) in table.get(kind).and_then(toml::Value::as_table).into_iter().flatten() {
                    let own = requirement.get("path").is_some() || requirement.get("workspace").is_some();
                    let version = requirement.as_str().or_else(|| requirement.get("version")?.as_str()).unwrap_or("");
                    assert!(own || version.starts_with('='), "{}: {name} = {requirement}", path.display());
                }
            }
        }
    }
}

/// Nothing is published from here yet; what a registry would show is there all the same, but for an address of the sources.
#[test]
fn manifests_are_complete() {
    for path in manifests().into_iter().filter(|path| !path.starts_with(root().join("tests"))) {
        let manifest: toml::Table = toml::from_str(&read(&path)).unwrap();
        let package = manifest["package"].as_table().unwrap();
        let wanted = "name description version edition license rust-version readme keywords categories publish";
        for key in wanted.split(' ') {
            assert!(package.contains_key(key), "{}: no {key}", path.display());
        }
        let workspace = manifest.get("workspace").and_then(toml::Value::as_table);
        for table in [Some(&manifest), workspace].into_iter().flatten() {
            for (name, requirement) in table.get("dependencies").and_then(toml::Value::as_table).into_iter().flatten() {
                let complete = requirement.get("path").is_none() || requirement.get("version").is_some();
                assert!(complete, "{}: {name} has a path and no version, so it cannot be packaged", path.display());
            }
        }
    }
}

/// Every test runs with the least version of Rust that the manifests name; a newer toolchain is held to it by a lint.
#[test]
fn the_least_version_of_rust_is_the_one_tested() {
    let toolchain: toml::Table = toml::from_str(&read("rust-toolchain.toml")).unwrap();
    let channel = toolchain["toolchain"]["channel"].as_str().unwrap().to_owned();
    let least = |path: &Path| -> Option<String> {
        let manifest: toml::Table = toml::from_str(&read(path)).unwrap();
        let package = manifest.get("workspace").and_then(|workspace| workspace.get("package"));
        let version = package.or(manifest.get("package"))?.get("rust-version")?;
        Some(version.as_str().map_or_else(|| "workspace".to_owned(), str::to_owned))
    };
    for path in manifests() {
        let version = least(&path).unwrap_or_else(|| panic!("{}: no rust-version", path.display()));
        assert!(version == "workspace" || format!("{version}.0") == channel, "{}: {version}", path.display());
    }
    let lints: toml::Table = toml::from_str(&read("Cargo.toml")).unwrap();
    assert_eq!(lints["workspace"]["lints"]["clippy"]["incompatible_msrv"].as_str(), Some("deny"));
}

/// Lines with an unsafe block or implementation, without comments and strings.
fn unsafe_lines(text: &str) -> Vec<usize> {
    let is_unsafe = |line: &str| {
        let code = line.split("//").next().unwrap();
        ["unsafe {", "unsafe impl"].iter().any(|word| code.split('"').step_by(2).any(|part| part.contains(word)))
    };
    text.lines().enumerate().filter(|(_, line)| is_unsafe(line)).map(|(at, _)| at).collect()
}

#[test]
fn unsafe_code_is_where_it_is_listed_and_says_why_it_is_sound() {
    let mut found = Vec::new();
    ["src", "crates", "fmu-build", "python"].iter().for_each(|folder| files(&root().join(folder), ".rs", &mut found));
    assert!(found.len() > 250);
    let mut unused: BTreeSet<&str> = UNSAFE.iter().map(|(path, _)| *path).collect();
    for path in found {
        let relative = path.strip_prefix(root()).unwrap().to_owned();
        if relative.components().any(|part| part.as_os_str() == "tests") {
            continue;
        }
        let text = read(&path);
        let lines: Vec<&str> = text.lines().collect();
        let word = |line: &&str| {
            let code = line.split("//").next().unwrap();
            code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")
        };
        if !lines.iter().any(word) {
            continue;
        }
        let listed = UNSAFE.iter().find(|(listed, _)| relative.starts_with(listed));
        let Some((listed, _)) = listed else { panic!("{}: unsafe code that is not listed", relative.display()) };
        unused.remove(listed);
        for at in unsafe_lines(&text) {
            let why = lines[at.saturating_sub(8)..=at].iter().any(|line| line.contains("SAFETY"));
            assert!(why, "{}:{}: an unsafe block without a SAFETY comment", relative.display(), at + 1);
        }
    }
    assert!(unused.is_empty(), "listed, and without unsafe code: {unused:?}");
    for name in SAFE {
        let text = read(format!("crates/{name}/src/lib.rs"));
        let forbidden = ["#![forbid(unsafe_code)]", "#![cfg_attr(not(test), forbid(unsafe_code))]"];
        assert!(forbidden.iter().any(|line| text.contains(line)), "{name} does not forbid unsafe code");
    }
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().file_name());
    for name in crates.map(|name| name.into_string().unwrap()) {
        let contains = UNSAFE.iter().any(|(path, _)| path.starts_with(&format!("crates/{name}/")));
        assert!(SAFE.contains(&name.as_str()) || contains, "crates/{name}: neither listed nor without unsafe code");
    }
}
