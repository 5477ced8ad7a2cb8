//! The scenes that are shipped: a folder with a `scene.toml` in a folder of every name.

use crate::suggest::{near, nearest, question};
use crate::{SceneFile, quantity, read};
use anyhow::{Context, Result, bail};
use scene::Scene;
use scene::message::{Number, Quoted};
use scene::slot::Packaged;
use scene::variables::{Kind, ValueReference, lookup, reference};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// The scene of this name or path; without one the stock scene, the variable table's own start values.
///
/// # Errors
/// Where there is no such scene (the shipped ones are listed), or all that is wrong with its file.
pub fn load(scene: Option<&str>, folder: &Path) -> Result<SceneFile> {
    let Some(scene) = scene else {
        return Ok(SceneFile { packaged: Packaged::stock(), description: String::new(), given: Vec::new() });
    };
    let path = locate(scene, folder)?;
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("fmu")) {
        bail!("{} is an FMU, and a scene file is needed: the TOML file that it was packaged from", path.display());
    }
    if !path.exists() {
        bail!("the scene {} cannot be read: there is no such file{}", path.display(), beside(&path));
    }
    read(&path).with_context(|| format!("the scene {}", path.display()))
}

/// File of the scene of this name or path.
///
/// A path is what names an existing file, has a separator or ends in `.toml`; anything else is the name of a folder
/// in `folder`.
///
/// # Errors
/// Where there is no such scene.
pub fn locate(scene: &str, folder: &Path) -> Result<PathBuf> {
    let given = Path::new(scene);
    if given.is_file() || given.components().count() > 1 || given.extension().is_some_and(|kind| kind == "toml") {
        return Ok(given.to_owned());
    }
    let shipped = folder.join(scene).join("scene.toml");
    if shipped.is_file() {
        return Ok(shipped);
    }
    let near = nearest(scene, names(folder).iter().map(String::as_str));
    bail!("there is no scene {}; name a scene file or one of {}{near}", Quoted(scene), names(folder).join(", "))
}

/// Scene files in the folder of a missing one whose names are near to its own, for messages.
fn beside(missing: &Path) -> String {
    let folder = missing.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let scenes = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let stem = |path: &Path| path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let stems: Vec<String> = scenes.map(|path| stem(&path)).collect();
    let near: Vec<String> =
        near(&stem(missing), stems.iter().map(String::as_str)).iter().map(|stem| format!("{stem}.toml")).collect();
    question(&near)
}

/// Names of the shipped scenes, in alphabetical order.
pub fn names(folder: &Path) -> Vec<String> {
    let folders = std::fs::read_dir(folder);
    let mut names: Vec<String> = folders
        .into_iter()
        .flatten()
        .flatten()
        .filter(|folder| folder.path().join("scene.toml").is_file())
        .filter_map(|folder| folder.file_name().into_string().ok())
        .collect();
    names.sort();
    names
}

/// What a scene of one's own gives; else it would run with the dimensions of the stock brake.
const EXPECTED: [&str; 5] = ["punch.width", "punch.height", "depth", "strip.height", "contact.friction_coefficient"];

/// Lengths and densities of machines over the typical magnitudes of their variables.
const OF_MACHINES: RangeInclusive<f64> = 1e-2..=500.0;

/// Warning about a length or a density that is far from the typical magnitude of its variable, and near to it in its display unit.
fn in_other_unit(reference: ValueReference, value: f64) -> Option<String> {
    let (row, element) = lookup(reference)?;
    let Kind::Real { unit, display, nominal, .. } = row.kind else { return None };
    if !["m", "kg/m3"].contains(&unit.name) {
        return None;
    }
    let is_near = |value: f64| OF_MACHINES.contains(&(value.abs() / nominal));
    let meant = quantity::in_si(value, display, unit, true).ok().filter(|_| !display.is_empty())?;
    (value != 0.0 && !is_near(value) && is_near(meant)).then(|| {
        let (name, unit, value) = (row.element_name(element), unit.name, Number(value));
        format!("{name} = {value} {unit} is improbable; \"{value} {display}\" may be meant")
    })
}

/// Warnings about the values of a scene; none where the scene is refused anyway.
pub fn warnings(scene: &SceneFile) -> Vec<String> {
    let values = &scene.packaged.starts;
    let Ok(known) = Scene::new(values, Some(scene.packaged.experiment.tolerance)) else { return Vec::new() };
    let mut warnings = known.warnings();
    warnings.extend(doubts(scene));
    warnings
}

/// Those warnings that a run does not give.
pub fn doubts(scene: &SceneFile) -> Vec<String> {
    let values = &scene.packaged.starts;
    let missing = EXPECTED.iter().map(|name| (name, reference(name))).filter(|(_, own)| !scene.given.contains(own));
    let missing: Vec<String> =
        missing.map(|(name, own)| format!("{name} = {}", Number(values[own as usize]))).collect();
    let mut warnings: Vec<String> =
        scene.given.iter().filter_map(|own| in_other_unit(*own, values[*own as usize])).collect();
    let name = &scene.packaged.name;
    if !(missing.is_empty() || scene.given.is_empty() || *name == Packaged::stock().name) {
        let missing = missing.join(", ");
        warnings.push(format!("{name} does not give {missing}: these are of the stock brake, in SI units"));
    }
    warnings
}
