//! The list of golden scenes: `tests/golden/scenes.toml`.

use crate::project;
use anyhow::{Context, Result, bail};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// One recorded scene: a component that is driven, or a command whose JSON output is kept.
#[derive(Clone, Deserialize, Debug)]
#[serde(deny_unknown_fields)]
pub(crate) struct GoldenScene {
    pub name: String,
    pub what: String,
    /// Whether its bits are compared where the machine is the one that recorded.
    #[serde(default)]
    pub bits: bool,
    /// A shipped scene; the stock scene where there is none.
    pub scene: Option<String>,
    /// Lines of a scene file, `key = value`, that change it.
    #[serde(default)]
    pub set: Vec<String>,
    /// Inputs while initialising.
    #[serde(default)]
    pub start: BTreeMap<String, f64>,
    #[serde(default)]
    pub drive: Vec<Segment>,
    /// How often all of it is done.
    #[serde(default = "once")]
    pub repeat: usize,
    /// The scene ends with an error, at initialisation or in a step.
    #[serde(default)]
    pub fails: bool,
    /// Arguments of a command that prints JSON, in place of a drive.
    pub command: Option<Vec<String>>,
}

/// Communication steps of one length.
#[derive(Clone, Deserialize, Debug)]
#[serde(deny_unknown_fields)]
pub(crate) struct Segment {
    /// Communication step, s.
    pub step: f64,
    #[serde(default = "once")]
    pub steps: usize,
    /// Inputs set before the first of them.
    #[serde(default)]
    pub inputs: BTreeMap<String, f64>,
    /// Time derivatives of inputs, set before each of them: the inputs then go on along a line.
    #[serde(default)]
    pub slopes: BTreeMap<String, f64>,
    /// Tunable parameters set before the first of them.
    #[serde(default)]
    pub tune: BTreeMap<String, f64>,
    /// Whether the segment is taken a second time from the state saved at its beginning.
    #[serde(default)]
    pub replay: Replay,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize, Default, Debug)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Replay {
    /// It is taken once.
    #[default]
    None,
    /// The same component, taken back.
    Same,
    /// A new component, which builds everything from the saved state.
    Fresh,
}

fn once() -> usize {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    scene: Vec<GoldenScene>,
}

/// Folder of the list and the records.
pub(crate) fn folder() -> PathBuf {
    project::root().join("tests").join("golden")
}

/// All golden scenes, or those with these names, in the order of the list.
pub(crate) fn read(wanted: &[String]) -> Result<Vec<GoldenScene>> {
    let path = folder().join("scenes.toml");
    let text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
    let list: List = toml::from_str(&text).with_context(|| format!("reading {}", path.display()))?;
    choose(list.scene, wanted)
}

fn choose(mut all: Vec<GoldenScene>, wanted: &[String]) -> Result<Vec<GoldenScene>> {
    let names: Vec<&str> = all.iter().map(|scene| scene.name.as_str()).collect();
    if let Some(unknown) = wanted.iter().find(|name| !names.contains(&name.as_str())) {
        bail!("{unknown:?} is no golden scene; they are {}", names.join(", "));
    }
    for (index, name) in names.iter().enumerate() {
        if names[..index].contains(name) {
            bail!("two golden scenes are named {name:?}");
        }
    }
    if !wanted.is_empty() {
        all.retain(|scene| wanted.contains(&scene.name));
    }
    Ok(all)
}
