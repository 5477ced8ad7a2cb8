//! The steady state of a scene, without time integration.

pub mod heat;
mod table;

use crate::convergence::{Convergence, half};
use ::steady::relative_velocity::{RelativeVelocity, assess};
use ::steady::states::{Sliding, SteadyKind, SteadyState, SteadyStroke, steady_state};
use ::steady::thermal::{HotState, has_hot_state, hot_state};
use anyhow::{Context, Result, bail};
use elasticity::Cells;
use elasticity::discretization::{cells_for, compliances};
use model::line::profile::Profile;
use scene::message::Number;
use scene::{Constraint, STATIONS, Scene};
use scene_file::SceneFile;
use serde_json::{Value, json};

const CELLS: usize = 65;

/// Largest speed of a half-stroke, that of `nominal.velocity`, m/s.
const FASTEST: f64 = 1e4;

/// Computed quantity.
#[derive(Clone, Copy, Default, Debug)]
pub struct Options {
    /// Cells of the contact line; `None`: the scene's, or 65.
    pub cells: Option<u16>,
    /// Speed of the backward half-stroke where it is not the nominal velocity, m/s.
    pub return_speed: Option<f64>,
    /// Without heat.
    pub cold: bool,
}

/// A solved scene.
pub struct Solved {
    /// Name of the scene.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Cells of the contact.
    pub cells: Cells,
    /// State without heat.
    pub state: SteadyState,
    /// Contributions to the velocity beside the sliding velocity.
    pub velocity: RelativeVelocity,
    /// With heat, or the reason why there is none; `None`: nothing is heated, or without heat.
    pub hot: Option<Result<HotState, String>>,
    /// Highest surface temperature (K) of the state with heat, beside that on half the cells; `None` where they would be too few.
    pub highest: Option<Convergence>,
    /// Reason why the state with heat is beyond the model's validity; it is then refused.
    pub too_hot: Option<String>,
}

/// Number of cells of the contact line: what is asked for, the scene's, or the default.
pub(crate) fn cell_count(scene: &Scene, cells: Option<u16>) -> usize {
    let own = if scene.cells > 0 { scene.cells } else { CELLS };
    cells.map_or(own, usize::from)
}

/// Solves a scene.
///
/// # Errors
/// Everything wrong with the scene and the options; the reason why there is no steady state.
pub fn solve(file: &SceneFile, options: &Options) -> Result<Solved> {
    let packaged = &file.packaged;
    let name = packaged.name.clone();
    let scene = Scene::new(&packaged.starts, Some(packaged.experiment.tolerance))?;
    let count = cell_count(&scene, options.cells);
    let cells = cells_for(&scene, count)?;
    let mut sliding = Sliding::nominal(&scene);
    match (options.return_speed, &mut sliding) {
        (None, _) => {}
        (Some(speed), Sliding::Reciprocating { .. }) if !(speed > 0.0 && speed <= FASTEST) => {
            bail!("return_speed = {} m/s must be above 0 m/s and at most {FASTEST} m/s", Number(speed))
        }
        (Some(speed), Sliding::Reciprocating { speeds, .. }) => speeds[1] = speed,
        (Some(speed), _) => bail!(
            "return_speed = {speed} m/s: the scene {name} slides in one direction (nominal.stroke = {} m)",
            scene.nominal_stroke
        ),
    }
    let bodies = compliances(&scene, &cells)?;
    let state = steady_state(&scene, &cells, &bodies, &sliding).with_context(|| format!("the scene {name}"))?;
    let velocity = assess(&scene, &cells, &bodies, &state)?;
    let warm = !options.cold && has_hot_state(&scene);
    let hot = warm.then(|| hot_state(&scene, &cells, &bodies, &sliding).map_err(|error| error.to_string()));
    let highest = hot.as_ref().and_then(|hot| hot.as_ref().ok()).and_then(|hot| on_half(&scene, &cells, &sliding, hot));
    let too_hot = hot.as_ref().and_then(|hot| hot.as_ref().ok()).and_then(|hot| heat::beyond_validity(&scene, hot));
    let hot = match &too_hot {
        Some(reason) => Some(Err(reason.clone())),
        None => hot,
    };
    Ok(Solved { name, scene, cells, state, velocity, hot, highest, too_hot })
}

/// The highest surface temperature beside that of the same state on half the cells.
fn on_half(scene: &Scene, cells: &Cells, sliding: &Sliding, hot: &HotState) -> Option<Convergence> {
    let coarser_cells = half(cells.count());
    let cells_of_half = cells_for(scene, coarser_cells).ok()?;
    let bodies = compliances(scene, &cells_of_half).ok()?;
    let coarser = hot_state(scene, &cells_of_half, &bodies, sliding).map_or(f64::NAN, |hot| hot.heat.highest);
    Some(Convergence { value: hot.heat.highest, cells: cells.count(), coarser, coarser_cells })
}

pub(crate) fn direction(stroke: &SteadyStroke) -> &'static str {
    if stroke.velocity < 0.0 { "backward" } else { "forward" }
}

/// Five figures; by the exponent where they would not be seen.
pub(crate) fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-2..1e6).contains(&size) => format!("{value:.3e}"),
        _ => format!("{value:.4}"),
    }
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

impl Solved {
    /// Refuses a state with heat that is beyond the model's validity.
    pub fn check(&self) -> Result<()> {
        match &self.too_hot {
            Some(reason) => bail!("the scene {}: {reason}; the option cold leaves heat out", self.name),
            None => Ok(()),
        }
    }

    pub(crate) fn kind(&self) -> &'static str {
        match (self.state.kind, self.state.strokes.len()) {
            (SteadyKind::RunIn, 1) => "run-in, unidirectional",
            (SteadyKind::RunIn, _) => "run-in, reciprocating",
            (SteadyKind::Groove, _) => "steady groove of the wearing strip, unidirectional",
            (SteadyKind::Elastic, _) => "elastic: even wear of a closed path reshapes nothing",
        }
    }

    /// Pa
    pub(crate) fn mean_pressure(&self) -> f64 {
        self.scene.nominal_pressure()
    }

    /// Pressure at the -x and +x edge; 0 where it is rounding.
    pub(crate) fn edges(&self, stroke: &SteadyStroke) -> [f64; 2] {
        let half_width = self.cells.half_width();
        [-half_width, half_width].map(|x| {
            let pressure = self.cells.point_value(&stroke.pressure, x);
            if pressure > 1e-9 * self.mean_pressure() { pressure } else { 0.0 }
        })
    }

    /// The holder by the names of its parameters.
    fn holder(&self) -> Value {
        let rotates = self.scene.constraint == Constraint::TranslateAndRotate;
        let constraint = if rotates { "translate_and_rotate" } else { "translate" };
        json!({ "constraint": constraint, "pivot_height": self.scene.pivot_height })
    }

    /// As JSON.
    pub fn record(&self) -> Value {
        let profile = Profile::new(&self.cells);
        let stroke = |stroke: &SteadyStroke| {
            let mut stations = [0.0; STATIONS];
            profile.fill(&stroke.pressure, &mut stations);
            json!({
                "direction": direction(stroke),
                "velocity": stroke.velocity,
                "duration": stroke.duration,
                "friction": stroke.friction,
                "pressure": stroke.pressure,
                "profile_pressure": stations.to_vec(),
                "pressure_max": largest(&stroke.pressure),
                "pressure_edges": self.edges(stroke),
                "approach": stroke.approach,
                "tilt": stroke.tilt,
            })
        };
        // The profiles' interpolation is for depths from 0.
        let highest = self.state.shape.iter().copied().fold(f64::INFINITY, f64::min);
        let depths: Vec<f64> = self.state.shape.iter().map(|depth| depth - highest).collect();
        let mut shape = [0.0; STATIONS];
        profile.fill(&depths, &mut shape);
        let elastic = self.velocity.elastic.as_ref().map(|elastic| {
            json!({
                "mean_strain": elastic.mean_strain,
                "largest_strain": elastic.largest_strain,
                "reversal": elastic.reversal,
                "pivot": elastic.pivot,
                "within_stroke": elastic.within_stroke,
                "normal_within_stroke": elastic.normal_within_stroke,
            })
        });
        json!({
            "scene": self.name,
            "kind": self.kind(),
            "holder": self.holder(),
            "stroke": self.scene.nominal_stroke,
            "load": self.scene.nominal_load,
            "pressure_mean": self.mean_pressure(),
            "x": self.cells.centres(),
            "profile_x": profile.positions().to_vec(),
            "widths": self.cells.widths(),
            "strokes": self.state.strokes.iter().map(stroke).collect::<Vec<_>>(),
            "shape": self.state.shape,
            "profile_shape": shape.to_vec(),
            "groove": self.state.groove,
            "punch_wear_rate": self.state.punch_wear_rate,
            "volume_rates": self.state.volume_rates,
            "wear_dissipation_power": self.state.dissipation_power,
            "friction_power": self.state.friction_power,
            "relative_velocity": { "wear": self.velocity.wear, "elastic": elastic },
            "heat": heat::record(self),
        })
    }

    /// Relative velocities that the model neglects, over the rigid one.
    pub(crate) fn neglected(&self) -> Vec<(&'static str, f64)> {
        let mut parts = vec![("wear, normal to it", self.velocity.wear)];
        if let Some(elastic) = &self.velocity.elastic {
            parts.extend([
                ("strain of the strip's surface, mean", elastic.mean_strain),
                ("strain of the strip's surface, |x| < .9 a", elastic.largest_strain),
                ("turned over by a reversal, elastic", elastic.reversal),
                ("turned over by a reversal, pivot", elastic.pivot),
                ("elastic within a stroke", elastic.within_stroke),
                ("elastic within a stroke, normal to it", elastic.normal_within_stroke),
            ]);
        }
        parts
    }
}
