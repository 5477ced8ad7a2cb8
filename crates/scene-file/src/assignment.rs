//! Assignments to variables of a scene that has been read.

use crate::{SceneFile, nearest, parse, quantity};
use anyhow::{Context, Result, anyhow, bail};
use scene::variables::{Causality, TABLE, ValueReference, find, lookup};
use toml::de::DeTable;

/// Gives one variable of a scene another start value: `assignment` is a line of a scene file, `key = value`, in which
/// text may stand without its quotes (`holder.pivot_height = 30 mm`, or `holder.pivot_height [mm] = 30`), or of one element of an
/// array.
///
/// # Errors
/// Where it is no assignment, or what a scene file with that line would be refused for.
pub fn assign(scene: &mut SceneFile, assignment: &str) -> Result<()> {
    let Some((key, value)) = assignment.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
        bail!("{assignment:?} must be KEY=VALUE, as holder.pivot_height=\"30 mm\"");
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
    let as_it_is =
        value.parse::<f64>().is_ok() || value.starts_with(['"', '\'', '[']) || ["true", "false"].contains(&value);
    let value = if as_it_is { value.to_owned() } else { format!("\"{value}\"") };
    if key.ends_with(']') {
        let (reference, value) = element(key, &value).with_context(|| format!("setting {assignment}"))?;
        scene.packaged.starts[reference as usize] = value;
        scene.given.push(reference);
        scene.given.sort_unstable();
        scene.given.dedup();
        return Ok(());
    }
    if key == "name" {
        bail!("{key} is no variable of the scene");
    }
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

/// One element of an array, as `contact.friction_fade.factor[2]`, and its value.
fn element(key: &str, value: &str) -> Result<(ValueReference, f64)> {
    let known = find(key).and_then(|reference| Some((reference, lookup(reference)?.0)));
    let Some((reference, row)) = known.filter(|(_, row)| row.causality == Causality::Parameter) else {
        let name = key.split('[').next().unwrap_or(key);
        let arrays = || TABLE.iter().filter(|row| row.elements > 0 && row.causality == Causality::Parameter);
        match arrays().find(|row| row.name == name) {
            Some(row) => bail!("{key}: {name} has the elements 1 to {}", row.elements),
            None => bail!("{key} is no element of a parameter{}", nearest(name, arrays().map(|row| row.name))),
        }
    };
    let text = format!("value = {value}");
    let table = DeTable::parse(&text).map_err(|wrong| anyhow!("{key}: {}", wrong.message()))?;
    let value = table.get_ref().get("value").context("no value")?;
    Ok((reference, quantity::value(value.get_ref(), row).map_err(|wrong| anyhow!("{key}: {wrong}"))?))
}
