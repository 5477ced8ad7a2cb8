//! Assignments to variables of a scene that has been read.

use crate::{SceneFile, lines, nearest, quantity};
use anyhow::{Context, Result, anyhow, bail};
use scene::message::{Clipped, Quoted};
use scene::variables::{Causality, TABLE, ValueReference, find, lookup};
use scene::without_effect;
use toml::de::DeTable;

/// Makes assignments to variables of a scene, each as of [`assign`].
///
/// # Errors
/// As [`assign`], and where one of them has no effect in the scene that they make.
pub fn assign_all(scene: &mut SceneFile, assignments: &[impl AsRef<str>]) -> Result<()> {
    let before = scene.packaged.starts;
    for assignment in assignments {
        assign(scene, assignment.as_ref())?;
    }
    without_effect(&scene.packaged.starts, &before).map_or(Ok(()), |text| Err(anyhow!(text)))
}

/// Gives one variable of a scene another start value: `assignment` is a line of a scene file, `key = value`, in which
/// text may stand without its quotes (`holder.pivot_height = 30 mm`, or `holder.pivot_height [mm] = 30`), of one element of an
/// array, or the arrays of a table together (`contact.friction_fade = { temperature = [293, 573], factor = [1, 0.8] }`).
///
/// # Errors
/// Where it is no assignment, or what a scene file with that line would be refused for.
pub fn assign(scene: &mut SceneFile, assignment: &str) -> Result<()> {
    let Some((key, value)) = assignment.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
        bail!("{} must be KEY=VALUE, as holder.pivot_height=\"30 mm\"", Quoted(assignment));
    };
    // As in the header of a column.
    let with_unit = key.strip_suffix(']').and_then(|key| key.rsplit_once(" ["));
    let joined;
    let (key, value) = match with_unit {
        Some((name, unit)) => {
            joined = format!("{value} {unit}");
            (name.trim(), joined.as_str())
        }
        None => (key, value),
    };
    let value = in_toml(value);
    let setting = || format!("setting {}", Clipped(assignment));
    if key.ends_with(']') {
        let (reference, value) = element(key, &value).with_context(setting)?;
        scene.packaged.starts[reference as usize] = value;
        scene.given.push(reference);
        scene.given.sort_unstable();
        scene.given.dedup();
        return Ok(());
    }
    if key == "name" {
        bail!("{} is no variable of the scene", Clipped(key));
    }
    let (line, _) = lines(&format!("{key} = {value}\nname = {:?}\n", scene.packaged.name)).with_context(setting)?;
    if line.given.is_empty() {
        bail!("{} is no variable of the scene", Clipped(key));
    }
    for &reference in &line.given {
        scene.packaged.starts[reference as usize] = line.packaged.starts[reference as usize];
    }
    scene.given.extend(line.given);
    scene.given.sort_unstable();
    scene.given.dedup();
    Ok(())
}

/// A value as TOML writes it: numbers may begin with a sign or their point, or end with it (`.005`, `+2`, `1.`), and texts have no quotes.
fn in_toml(value: &str) -> String {
    if let Some(elements) = value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        // A comma within a text parts it for a moment.
        let elements: Vec<String> =
            elements.split(',').map(|part| number(part.trim()).unwrap_or_else(|| part.to_owned())).collect();
        return format!("[{}]", elements.join(","));
    }
    if value.starts_with(['"', '\'', '[', '{']) || ["true", "false"].contains(&value) {
        return value.to_owned();
    }
    number(value).unwrap_or_else(|| format!("\"{value}\""))
}

/// A number as TOML writes it; `None` where it is none.
fn number(text: &str) -> Option<String> {
    let whole = text.parse().ok().map(|number: i64| number.to_string());
    whole.or_else(|| text.parse().ok().map(|number: f64| format!("{number:?}").to_lowercase()))
}

/// One element of an array, as `contact.friction_fade.factor[2]`, and its value.
fn element(key: &str, value: &str) -> Result<(ValueReference, f64)> {
    let known = find(key).and_then(|reference| Some((reference, lookup(reference)?.0)));
    let Some((reference, row)) = known.filter(|(_, row)| row.causality == Causality::Parameter) else {
        let name = key.split('[').next().unwrap_or(key);
        let arrays = || TABLE.iter().filter(|row| row.elements > 0 && row.causality == Causality::Parameter);
        match arrays().find(|row| row.name == name) {
            Some(row) => bail!("{}: {name} has the elements 1 to {}", Clipped(key), row.elements),
            None => {
                bail!("{} is no element of a parameter{}", Clipped(key), nearest(name, arrays().map(|row| row.name)))
            }
        }
    };
    let text = format!("value = {value}");
    let table = DeTable::parse(&text).map_err(|wrong| anyhow!("{key}: {}", wrong.message()))?;
    let value = table.get_ref().get("value").context("no value")?;
    Ok((reference, quantity::value(value.get_ref(), row).map_err(|wrong| anyhow!("{key}: {wrong}"))?))
}
