//! Finds scenes by the path of their file or by the name of a built-in one.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use sliding_contact::scene::file::{self, SceneFile};
use sliding_contact::slot::Packaged;

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
    file::read(&path).with_context(|| format!("the scene {}", path.display()))
}

fn locate(scene: &str) -> Result<PathBuf> {
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
    fn a_path_and_a_name_are_told_apart() {
        let path = project::root().join("examples/disc_brake/scene.toml");
        assert_eq!(load(Some(path.to_str().unwrap())).unwrap(), load(Some("disc_brake")).unwrap());
        assert!(format!("{:#}", load(Some("disc_break")).unwrap_err()).contains("disc_brake"));
        assert!(format!("{:#}", load(Some("disc_brake.toml")).unwrap_err()).contains("cannot be read"));
        assert_eq!(load(None).unwrap().packaged, Packaged::stock());
    }
}
