//! Assignments to variables of a scene that has been read.

use crate::{SceneFile, parse};
use anyhow::{Context, Result, bail};

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
    let line = parse(&format!("{key} = {value}\nname = {:?}\n", scene.packaged.name))
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
