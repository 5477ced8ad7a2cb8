//! Finds scenes by the path of their file or by the name of a built-in one.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use scene::Scene;
use scene::slot::{LARGEST_TOLERANCE, Packaged};
use scene_file::{self, SceneFile};

use crate::project;

/// The scene of this name or path; without one the stock scene, the variable table's own start values.
///
/// A path is what names an existing file, has a separator or ends in `.toml`; anything else is the name of a folder
/// in `examples`.
///
/// # Errors
/// Where there is no such scene (the built-in ones are listed), or all that is wrong with its file.
pub fn load(scene: Option<&str>) -> Result<SceneFile> {
    let Some(scene) = scene else {
        return Ok(SceneFile { packaged: Packaged::stock(), description: String::new(), given: Vec::new() });
    };
    let path = locate(scene)?;
    scene_file::read(&path).with_context(|| format!("the scene {}", path.display()))
}

/// Gives one variable of a scene another start value: `assignment` is a line of a scene file, `key = value`, in which
/// text may stand without its quotes (`holder.pivot_height = 30 mm`).
///
/// # Errors
/// Where it is no assignment, or what a scene file with that line would be refused for.
pub fn assign(scene: &mut SceneFile, assignment: &str) -> Result<()> {
    let Some((key, value)) = assignment.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
        bail!("{assignment:?} must be KEY=VALUE, as holder.pivot_height=\"30 mm\"");
    };
    let as_it_is =
        value.parse::<f64>().is_ok() || value.starts_with(['"', '\'', '[']) || ["true", "false"].contains(&value);
    let value = if as_it_is { value.to_owned() } else { format!("\"{value}\"") };
    let line = scene_file::parse(&format!("{key} = {value}\nname = {:?}\n", scene.packaged.name))
        .with_context(|| format!("setting {assignment}"))?;
    if line.given.is_empty() {
        bail!("{key} is no variable of the scene");
    }
    for &reference in &line.given {
        scene.packaged.starts[reference as usize] = line.packaged.starts[reference as usize];
    }
    scene.given.extend(line.given);
    scene.given.sort_unstable();
    scene.given.dedup();
    Ok(())
}

/// Prints the warnings about the values of a scene; nothing where the scene is refused anyway.
pub fn warn(scene: &SceneFile) {
    let warnings =
        Scene::new(&scene.packaged.starts, Some(scene.packaged.experiment.tolerance)).map(|scene| scene.warnings());
    for text in warnings.unwrap_or_default() {
        eprintln!("warning: {text}");
    }
}

/// A relative tolerance as an argument, in the limits of those of scene files.
///
/// # Errors
/// With the limits.
pub fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && value <= LARGEST_TOLERANCE => Ok(value),
        _ => Err(format!("must be a number above 0 and at most {LARGEST_TOLERANCE}")),
    }
}

/// File of the scene of this name or path.
///
/// # Errors
/// Where there is no such scene.
pub fn locate(scene: &str) -> Result<PathBuf> {
    let given = Path::new(scene);
    if given.is_file() || given.components().count() > 1 || given.extension().is_some_and(|kind| kind == "toml") {
        return Ok(given.to_owned());
    }
    let built_in = project::root().join("examples").join(scene).join("scene.toml");
    if built_in.is_file() {
        return Ok(built_in);
    }
    bail!("there is no scene {scene:?}; name a scene file or one of {}", names().join(", "))
}

/// Names of the built-in scenes, in alphabetical order.
pub fn names() -> Vec<String> {
    let folders = std::fs::read_dir(project::root().join("examples"));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scene_loads_under_the_name_of_its_folder() {
        let names = names();
        for wanted in ["clutch", "disc_brake", "pin_on_disk", "reciprocating_punch"] {
            assert!(names.iter().any(|name| name == wanted), "{wanted} is not among {names:?}");
        }
        for name in names {
            let scene = load(Some(&name)).unwrap();
            assert_eq!(scene.packaged.name, name);
            assert!(!scene.description.is_empty(), "{name} has no description");
            assert!(!scene.given.is_empty());
        }
    }

    #[test]
    fn an_assignment_is_a_line_of_a_scene_file() {
        let mut scene = load(Some("reciprocating_punch")).unwrap();
        let before = scene.clone();
        for assignment in
            ["holder.pivot_height=30 mm", "holder.constraint = translate_and_rotate", "wear_acceleration=10"]
        {
            assign(&mut scene, assignment).unwrap();
        }
        let starts = |name: &str| {
            let reference = scene::variables::find(name).unwrap() as usize;
            [before.packaged.starts[reference], scene.packaged.starts[reference]]
        };
        assert_eq!(starts("holder.pivot_height"), [0.0, 0.03]);
        assert_eq!(starts("holder.constraint"), [1.0, 2.0]);
        assert_eq!(starts("wear_acceleration"), [1.0, 10.0]);
        assert_eq!(starts("punch.height"), [0.1, 0.1]);
        for (wrong, reason) in [
            ("holder.pivot_height", "must be KEY=VALUE"),
            ("holder.pivot_heigth=1", "holder.pivot_height"),
            ("holder.pivot_height=-30 mm", "holder.pivot_height"),
            ("experiment.stop=1", "is no variable"),
        ] {
            let error = format!("{:#}", assign(&mut scene, wrong).unwrap_err());
            assert!(error.contains(reason), "{wrong}: {error}");
        }
    }

    #[test]
    fn a_path_and_a_name_are_told_apart() {
        let path = project::root().join("examples/disc_brake/scene.toml");
        assert_eq!(load(Some(path.to_str().unwrap())).unwrap(), load(Some("disc_brake")).unwrap());
        assert!(format!("{:#}", load(Some("disc_break")).unwrap_err()).contains("disc_brake"));
        assert!(format!("{:#}", load(Some("disc_brake.toml")).unwrap_err()).contains("cannot be read"));
        assert_eq!(load(None).unwrap().packaged, Packaged::stock());
    }
}
