//! Steady cycle of reciprocating sliding with heat.
//!
//! Theory: docs/theory.md, sections 9.4, 9.5.

use super::{Accuracy, HeatFlows, HotState, SteadyHeat, StrokeHeat};
use crate::SteadyError;
use crate::states::{SteadyKind, SteadyState, SteadyStroke};
use elasticity::Cells;
use model::line::cycle::map::sliding_scene;
use model::line::cycle::{CycleError, CycleMap, MapResolution, Passage, SolveOptions};
use model::line::operators::LineOperators;
use scene::{InitialShape, Scene};

impl From<CycleError> for SteadyError {
    fn from(error: CycleError) -> Self {
        SteadyError::Heat(error.to_string())
    }
}

/// Velocity (m/s) and duration (s) of the half-strokes of the nominal sliding.
pub fn nominal_half_strokes(scene: &Scene) -> [(f64, f64); 2] {
    let (speed, stroke) = (scene.nominal_velocity.abs(), scene.nominal_stroke);
    [(speed, stroke / speed), (-speed, stroke / speed)]
}

/// Cycle map of a scene in reciprocating sliding, with resolved heat.
pub fn cycle_map(scene: &Scene, sliding: [(f64, f64); 2], resolution: MapResolution) -> Result<CycleMap, SteadyError> {
    let operators = LineOperators::with_heat(&sliding_scene(scene), true, super::run_in).map_err(SteadyError::Heat)?;
    Ok(CycleMap::new(operators, sliding, resolution)?)
}

/// Steady state with given time steps.
pub(super) fn solve(
    scene: &Scene,
    cells: &Cells,
    cold: &SteadyState,
    strokes: [f64; 2],
    speeds: [f64; 2],
    resolution: MapResolution,
) -> Result<HotState, SteadyError> {
    let mut scene = scene.clone();
    scene.cells = cells.count();
    let runs_in = cold.kind == SteadyKind::RunIn;
    if runs_in {
        // The whole shape is solved for.
        scene.initial_shape = InitialShape::Flat;
    }
    let sliding = [(speeds[0], strokes[0] / speeds[0]), (-speeds[1], strokes[1] / speeds[1])];
    let mut map = cycle_map(&scene, sliding, resolution)?;
    let mut start = map.start();
    let [punch, _] = map.worn_ranges();
    if runs_in {
        start[punch].copy_from_slice(&cold.shape);
    }
    let solution = map.steady(&start, &SolveOptions::default())?;
    let accuracy = Accuracy {
        iterations: solution.cycles,
        shape: solution.residual[0],
        heat: solution.residual[1],
        speed_ratio: map.speed_ratio(),
    };
    Ok(assembled(&map, cold.kind, &solution.memory, &solution.passage, accuracy))
}

fn assembled(map: &CycleMap, kind: SteadyKind, memory: &[f64], passage: &Passage, accuracy: Accuracy) -> HotState {
    let operators = map.operators();
    let scene = &operators.scene;
    let (reference, period) = (map.reference(), map.period());
    let all = scene.depth * scene.count * scene.faces;
    let width: f64 = operators.weights.iter().sum();
    let [punch, strip] = map.worn_ranges();
    let mut shape: Vec<f64> = memory[punch].iter().zip(&operators.initial_gap).map(|(w, g)| w + g).collect();
    if operators.reshapes(1) {
        shape.iter_mut().zip(&memory[strip]).for_each(|(sum, depth)| *sum += depth);
    }
    let least = if kind == SteadyKind::RunIn { shape.iter().copied().fold(f64::INFINITY, f64::min) } else { 0.0 };
    shape.iter_mut().for_each(|depth| *depth -= least);
    let strokes = passage.strokes.each_ref().map(|stroke| SteadyStroke {
        velocity: stroke.velocity,
        duration: stroke.duration,
        friction: stroke.signed_friction,
        pressure: stroke.pressure.clone(),
        approach: stroke.approach - least,
        tilt: stroke.tilt,
        wear_rates: stroke.worn.each_ref().map(|worn| worn.iter().map(|depth| depth / stroke.duration).collect()),
    });
    let heats = passage.strokes.each_ref().map(|stroke| StrokeHeat {
        temperature: stroke.temperature.each_ref().map(|values| values.iter().map(|t| t + reference).collect()),
        flux: stroke.flux.clone(),
        pressure_at: stroke.pressure_at.clone(),
    });
    let totals = &passage.totals;
    let rate = |amount: f64| all * amount / period;
    let absolute = |values: &Vec<f64>| values.iter().map(|t| t + reference).collect::<Vec<f64>>();
    HotState {
        state: SteadyState {
            kind,
            strokes: strokes.to_vec(),
            groove: vec![0.0; shape.len()],
            shape,
            punch_wear_rate: totals.volume[0] / period / width,
            volume_rates: totals.volume.map(rate),
            dissipation_power: rate(totals.wear_dissipation),
            friction_power: rate(totals.dissipated),
        },
        heat: SteadyHeat {
            strokes: heats.to_vec(),
            range: passage.range.each_ref().map(|pair| pair.each_ref().map(absolute)),
            contact_temperature: passage.contact_temperature.map(|t| t + reference),
            highest: passage.highest + reference,
            body_temperature: map.body_temperatures(memory).map(|rise| rise + reference),
            flows: HeatFlows {
                friction: rate(totals.dissipated),
                punch: rate(totals.received[0]),
                strip: rate(totals.received[1]),
                punch_top: rate(totals.lost[0]),
                strip_base: rate(totals.lost[1]),
                ambient: rate(totals.lost[2]),
            },
            accuracy,
        },
    }
}
