//! Choice of the level: by `solver.fidelity = auto` before a run, or by running every level on given inputs.

mod effects;
mod groups;
pub mod inputs;

use ::steady::run_in;
use anyhow::{Result, anyhow};
use effects::{Effect, effects};
use groups::Groups;
use model::levels::ModelOperators;
use model::plan::{BuiltModel, Choice, ModelLevel};
use scene::{Fidelity, Scene};
use scene_file::SceneFile;
use serde_json::{Map, Value, json};

/// What `solver.fidelity = auto` takes for a scene, and why.
pub struct Plan {
    name: String,
    /// The scene as it is.
    pub scene: Scene,
    choice: Choice,
    prepared: BuiltModel,
    effects: Vec<Effect>,
    groups: Groups,
}

/// The plan of a scene, also where it fixes its level; `tolerance`: of the importer, where `solver.tolerance` is 0.
pub fn choose(file: &SceneFile, tolerance: Option<f64>) -> Result<Plan> {
    let importer = tolerance.or(Some(file.packaged.experiment.tolerance));
    let scene = Scene::new(&file.packaged.starts, importer).map_err(|broken| anyhow!("{broken}"))?;
    let mut free = scene.clone();
    free.fidelity = Fidelity::Auto;
    let prepared = BuiltModel::new(&free, run_in).map_err(|text| anyhow!(text))?;
    let choice = prepared.choice.clone().ok_or_else(|| anyhow!("no level was chosen"))?;
    let rise = choice.comparison.as_ref().map_or(0.0, |comparison| comparison.rise);
    let groups = Groups::new(&scene, &prepared.operators.mean().growth.critical, rise);
    let effects = match &prepared.operators {
        ModelOperators::Line(line) => effects(&scene, &groups, line, true, rise),
        _ if scene.has_rigid_bodies() => Vec::new(),
        lumped => match lumped.beside(&ModelLevel::Line(0).apply(lumped.scene()), run_in) {
            Ok(ModelOperators::Line(line)) => effects(&scene, &groups, &line, false, rise),
            _ => Vec::new(),
        },
    };
    Ok(Plan { name: file.packaged.name.clone(), scene, choice, prepared, effects, groups })
}

impl Plan {
    fn level(&self) -> &'static str {
        match self.choice.level {
            ModelLevel::Lumped => "lumped",
            ModelLevel::Line(_) => "line",
        }
    }

    /// Error of the level where it is known before the run: at the lumped level.
    fn estimated_error(&self) -> Option<f64> {
        let comparison = self.choice.comparison.as_ref().filter(|_| self.choice.level == ModelLevel::Lumped);
        comparison.map(|comparison| comparison.error)
    }

    /// The plan as a table: conditions, level and why, effects, groups.
    pub fn table(&self) -> String {
        let scene = &self.scene;
        let mut text = format!(
            "{}: load {} N, speed {} m/s, {} s, tolerance {:e}\n",
            self.name, scene.nominal_load, scene.nominal_velocity, scene.nominal_duration, scene.tolerance
        );
        let effects = self.effects.iter().map(|effect| {
            let included = if effect.included { "included" } else { "left out" };
            format!("{:28} {:42} {:>9}  {included}", effect.name, effect.measure, short(effect.number))
        });
        let groups = self.groups.named().into_iter().map(|(name, value)| format!("{name:71} {:>9}", short(value)));
        for line in self.prepared.lines().into_iter().chain(effects).chain(groups) {
            text += &format!("{line}\n");
        }
        if scene.fidelity != Fidelity::Auto {
            text += &format!(
                "The scene itself sets solver.fidelity = {}.\n",
                format!("{:?}", scene.fidelity).to_lowercase()
            );
        }
        text
    }

    /// The plan as JSON.
    pub fn record(&self) -> Value {
        let effects = self.effects.iter().map(|effect| {
            json!({
                "effect": effect.name,
                "measure": effect.measure,
                "number": effect.number,
                "included": effect.included,
            })
        });
        let groups: Map<String, Value> =
            self.groups.named().into_iter().map(|(name, value)| (name.to_owned(), json!(value))).collect();
        let comparison = self.choice.comparison.as_ref().map(|comparison| {
            json!({
                "error_of_lumped": comparison.error,
                "friction_work": comparison.work,
                "temperature_rise": comparison.rise,
                "steps": comparison.steps,
            })
        });
        let operators = &self.prepared.operators;
        json!({
            "tolerance": self.scene.tolerance,
            "level": self.level(),
            "cells": operators.cells(),
            "companion_cells": self.prepared.companion.as_ref().map(ModelOperators::cells),
            "description": operators.description(),
            "reason": self.choice.reason,
            "estimated_error": self.estimated_error(),
            "comparison": comparison,
            "effects": effects.collect::<Vec<_>>(),
            "groups": groups,
        })
    }
}

fn short(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if (0.01..1e4).contains(&value.abs()) {
        format!("{value:.3}")
    } else {
        format!("{value:.1e}")
    }
}
