//! Finds scenes by the path of their file or by the name of a shipped one, here a folder in `examples`.

use std::path::PathBuf;

use anyhow::Result;
use scene::variables::TOLERANCES;
use scene_file::{SceneFile, shipped};
pub(crate) use scene_file::{assign, assign_all};

use crate::project;

pub(crate) fn folder() -> PathBuf {
    project::root().join("examples")
}

/// As [`shipped::load`].
pub fn load(scene: Option<&str>) -> Result<SceneFile> {
    shipped::load(scene, &folder())
}

/// As [`load`], with these changes.
pub fn changed(scene: Option<&str>, changes: &[String]) -> Result<SceneFile> {
    let mut scene = load(scene)?;
    assign_all(&mut scene, changes)?;
    Ok(scene)
}

/// As [`shipped::locate`].
pub fn locate(scene: &str) -> Result<PathBuf> {
    shipped::locate(scene, &folder())
}

/// Names of the shipped scenes, in alphabetical order.
pub fn names() -> Vec<String> {
    shipped::names(&folder())
}

/// Prints the warnings about the values of a scene; nothing where the scene is refused anyway.
pub fn warn(scene: &SceneFile) {
    for text in shipped::warnings(scene) {
        eprintln!("warning: {text}");
    }
}

/// A relative tolerance as an argument, in the limits of those of scene files.
pub fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if TOLERANCES.contains(&value) => Ok(value),
        _ => Err(format!("must be a number from {:e} to {}", TOLERANCES.start(), TOLERANCES.end())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::slot::Packaged;

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
        for assignment in [
            "holder.pivot_height=30 mm",
            "holder.constraint = translate_and_rotate",
            "wear_acceleration=10",
            "punch.width [mm] = 50",
            "contact.friction_fade.factor[2] = 70 %",
        ] {
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
        assert_eq!(starts("punch.width")[1], 0.05);
        assert_eq!(starts("contact.friction_fade.factor[2]")[1], 0.7);
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
