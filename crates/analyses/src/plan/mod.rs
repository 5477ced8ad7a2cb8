//! Choice of the level: by `solver.fidelity = auto` before a run, or by running every level on given inputs.

pub mod inputs;

use ::steady::run_in;
use anyhow::{Result, anyhow};
use model::plan::{self, Plan, Planned};
use scene::{Fidelity, Scene};
use scene_file::SceneFile;
use serde_json::{Value, json};

/// The plan of a scene, also where it fixes its level, and the scene as it is; `tolerance`: of the importer, where
/// `solver.tolerance` is 0. It is the plan for the scene's default experiment.
///
/// # Errors
/// Where the scene is refused, or a level cannot be built.
pub fn choose(file: &SceneFile, tolerance: Option<f64>) -> Result<(Scene, Planned)> {
    let experiment = file.packaged.experiment;
    let importer = tolerance.or(Some(experiment.tolerance));
    let scene = Scene::new(&file.packaged.starts, importer).map_err(|broken| anyhow!("{broken}"))?;
    let mut free = scene.clone();
    free.fidelity = Fidelity::Auto;
    let free = free.for_run_of(Some(experiment.stop - experiment.start));
    let planned = plan::make(&free, run_in).map_err(|text| anyhow!(text))?;
    Ok((scene, planned))
}

/// A plan as JSON.
pub fn record(plan: &Plan) -> Value {
    let effects = plan.effects.iter().map(|effect| {
        json!({
            "effect": effect.name,
            "measure": effect.measure,
            "number": effect.number,
            "kept": effect.kept,
            "error": effect.error,
        })
    });
    let candidates = plan.candidates.iter().map(|candidate| {
        let [wear, temperature, force] = candidate.errors;
        json!({
            "level": candidate.model_level.level(),
            "cells": candidate.model_level.cells(),
            "name": candidate.model_level.to_string(),
            "error_wear_depth": wear,
            "error_contact_temperature": temperature,
            "error_friction_force": force,
            "cost_per_step_microseconds": candidate.cost,
        })
    });
    let groups: serde_json::Map<String, Value> =
        plan.groups().into_iter().map(|(name, value)| (name.to_owned(), json!(value))).collect();
    json!({
        "tolerance": plan.tolerance,
        "level": plan.model_level.level(),
        "cells": plan.model_level.cells(),
        "model_level": plan.model_level.to_string(),
        "meets_tolerance": plan.meets,
        "reason": plan.reason,
        "order": plan.order,
        "thermal_states": { "punch": plan.states[0], "strip": plan.states[1], "moving_source": plan.states[2] },
        "estimated_error": plan.estimated_error,
        "reduction_error": plan.reduction_error,
        "cost_per_step_microseconds": plan.cost_per_step,
        "expected_run_seconds": 1e-6 * plan.run_cost,
        "compared_steps": plan.compared_steps,
        "compared_part": plan.covered,
        "planning_seconds": 1e-6 * plan.planning_cost,
        "effects": effects.collect::<Vec<_>>(),
        "groups": groups,
        "candidates": candidates.collect::<Vec<_>>(),
    })
}
