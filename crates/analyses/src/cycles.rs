//! Reciprocating sliding over many cycles by cycle jumps.

use crate::steady::cell_count;
use ::steady::states::Sliding;
use ::steady::thermal::{at_steady_properties, instability, nominal_half_strokes};
use anyhow::{Context, Result, anyhow, bail};
use elasticity::discretization::{cells_for, compliances};
use model::line::cycle::map::sliding_scene;
use model::line::cycle::{CycleMap, JumpOptions, Jumps, MapResolution, Progress, TrackedCycles};
use model::line::heat::bodies::is_resolved;
use model::line::operators::{LineOperators, StripWear};
use numerics::interruption::part;
use scene::{Path, Scene};
use scene_file::SceneFile;
use serde_json::{Value, json};

/// Computed quantity.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Number of cycles.
    pub cycles: f64,
    /// Largest estimated error of a jump.
    pub tolerance: f64,
    /// Cells of the contact line; `None`: the scene's, or 33.
    pub cells: Option<u16>,
    /// Without heat.
    pub cold: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { cycles: 1e6, tolerance: 1e-3, cells: None, cold: false }
    }
}

/// Recorded quantities of a jump.
pub struct Station {
    /// How far it led.
    pub jump: Progress,
    /// Largest pressure of the forward half-stroke's mean, Pa; on a worn track in the middle of that stroke.
    pub highest_pressure: f64,
    /// Mean worn depths of punch and strip, m.
    pub worn: [f64; 2],
    /// K; of a cold scene the ambient temperature.
    pub temperature: f64,
}

/// A scene over its cycles.
pub struct CycleHistory {
    /// Name of the scene.
    pub name: String,
    /// Whether heat is part of it.
    pub warm: bool,
    /// What a reader of the history should know.
    pub warning: Option<String>,
    /// Pa.
    pub mean_pressure: f64,
    /// Jumps.
    pub stations: Vec<Station>,
    /// Worn depth of the punch in the end, by cell, m.
    pub depth: Vec<f64>,
    /// Worn depth of a strip that keeps its track, under the cells of the punch in the middle of its stroke, m.
    pub strip_depth: Option<Vec<f64>>,
    /// Positions of the cells, m.
    pub x: Vec<f64>,
    /// Whether it was ended on request ([`numerics::interruption`]): it goes to its last jump.
    pub interrupted: bool,
}

/// Advances a scene; `progress` is called with the cycles passed and those computed.
///
/// # Errors
/// Everything wrong with the scene and the options, one without reciprocating sliding, a cycle without a solution.
pub fn advance(file: &SceneFile, options: &Options, progress: &mut dyn FnMut(f64, usize)) -> Result<CycleHistory> {
    let name = file.packaged.name.clone();
    let mut scene = Scene::new(&file.packaged.starts, Some(file.packaged.experiment.tolerance))?;
    if scene.nominal_stroke == 0.0 || scene.nominal_velocity == 0.0 {
        bail!(
            "the scene {name} is not reciprocating: nominal.stroke = {} m, nominal.velocity = {} m/s",
            scene.nominal_stroke,
            scene.nominal_velocity
        );
    }
    if scene.nominal_load == 0.0 {
        bail!("the scene {name}: nominal.load = 0 N must be above 0 N for the wear of a cycle");
    }
    if !(options.cycles >= 1.0 && options.cycles <= 1e15 && options.cycles.fract() == 0.0) {
        bail!("cycles = {} must be a whole number from 1 to 1e15", options.cycles);
    }
    if !(options.tolerance >= 1e-6 && options.tolerance <= 0.1) {
        bail!("tolerance = {} must be from 1e-6 to 0.1", options.tolerance);
    }
    if let Some(cells) = options.cells {
        scene.cells = usize::from(cells);
    }
    let half_strokes = nominal_half_strokes(&scene);
    let period = half_strokes[0].1 + half_strokes[1].1;
    // The reduced bodies must be accurate over the whole duration.
    scene.nominal_duration = scene.nominal_duration.max(period * options.cycles);
    let warm = !options.cold && is_resolved(&scene);
    let resolution = if warm { MapResolution::WITH_HEAT } else { MapResolution::COLD };
    if warm && [&scene.punch, &scene.strip].iter().any(|body| body.properties.is_some()) {
        // The cycles have the properties of the temperatures to which they lead.
        let cells = cells_for(&scene, cell_count(&scene, None))?;
        let bodies = compliances(&scene, &cells)?;
        let steady = at_steady_properties(&scene, &cells, &bodies, &Sliding::nominal(&scene));
        let steady = steady.with_context(|| format!("the scene {name}: properties of its steady cycle"))?;
        scene = steady.0;
    }
    let tracked = scene.path == Path::Straight && scene.strip.wear_coefficient > 0.0;
    let cycled = if tracked { scene.clone() } else { sliding_scene(&scene) };
    let operators = LineOperators::with_heat(&cycled, warm, steady::run_in)
        .map_err(|error| anyhow!(error))
        .with_context(|| format!("the scene {name}"))?;
    if operators.strip_wear == StripWear::Track {
        return on_track(name, &scene, operators, half_strokes, options, progress);
    }
    let mut map = CycleMap::new(operators, half_strokes, resolution)?;
    let (x, reference) = (map.operators().cells.centres().to_vec(), map.reference());
    let width: f64 = map.operators().weights.iter().sum();
    let punch = map.worn_ranges()[0].clone();
    let warning = warm.then(|| (map.distance() / map.period(), map.speed_ratio())).and_then(|(speed, ratio)| {
        instability(
            "the cycles are thermoelastically unstable, and their fixed steps may not follow hot spots",
            speed,
            ratio,
        )
    });
    let start = map.start();
    let jump_options = JumpOptions { tolerance: options.tolerance, ..JumpOptions::default() };
    let mut stations = Vec::new();
    let mut depth = vec![0.0; x.len()];
    let mut jumps = Jumps::new(&mut map, start, jump_options);
    let carry = || {
        jumps.carry_to(options.cycles, |jump| {
            progress(jump.progress.cycles, jump.progress.computed);
            let pressure = &jump.passage.strokes[0].pressure;
            depth.copy_from_slice(&jump.memory[punch.clone()]);
            stations.push(Station {
                jump: jump.progress,
                highest_pressure: pressure.iter().copied().fold(0.0, f64::max),
                worn: jump.totals.volume.map(|volume| volume / width),
                temperature: reference + if warm { jump.passage.contact_temperature[1] } else { 0.0 },
            });
        })
    };
    let interrupted = part(carry).transpose()?.is_none();
    let mean_pressure = scene.nominal_pressure();
    Ok(CycleHistory { name, warm, warning, mean_pressure, stations, depth, strip_depth: None, x, interrupted })
}

/// Advances a scene whose strip keeps its worn track.
fn on_track(
    name: String,
    scene: &Scene,
    operators: LineOperators,
    half_strokes: [(f64, f64); 2],
    options: &Options,
    progress: &mut dyn FnMut(f64, usize),
) -> Result<CycleHistory> {
    let (x, width) = (operators.cells.centres().to_vec(), operators.weights.iter().sum::<f64>());
    let jump_options = JumpOptions { tolerance: options.tolerance, ..JumpOptions::default() };
    let mut cycles = TrackedCycles::new(operators, half_strokes, jump_options)?;
    let (mut stations, mut depths) = (Vec::new(), [vec![0.0; x.len()], vec![0.0; x.len()]]);
    let carry = || {
        cycles.carry_to(options.cycles, |jump, line| {
            progress(jump.cycles, jump.computed);
            let state = line.state();
            depths = [state.punch.clone(), state.strip.clone()];
            stations.push(Station {
                jump: *jump,
                highest_pressure: state.pressure.iter().copied().fold(0.0, f64::max),
                worn: state.volume.map(|volume| volume / width),
                temperature: scene.ambient_temperature,
            });
        })
    };
    let interrupted = part(carry).transpose()?.is_none();
    let [depth, strip_depth] = depths;
    let mean_pressure = scene.nominal_pressure();
    let strip_depth = Some(strip_depth);
    Ok(CycleHistory { name, warm: false, warning: None, mean_pressure, stations, depth, strip_depth, x, interrupted })
}

impl CycleHistory {
    /// As a table: the jumps.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{}{}\n{:>12} {:>12} {:>10} {:>9} {:>10} {:>12} {:>12}",
            self.name,
            if self.warm { ", with heat" } else { ", without heat" },
            "cycles",
            "jump",
            "estimate",
            "computed",
            "p_max/p_m",
            "punch, µm",
            "strip, µm"
        );
        text += if self.warm { "    T, degC\n" } else { "\n" };
        // Of cycles computed one after the other, the first and the last.
        let single = |index: usize| self.stations.get(index).is_some_and(|station| station.jump.length == 1.0);
        for (index, station) in self.stations.iter().enumerate() {
            if index > 0 && single(index - 1) && single(index) && single(index + 1) {
                continue;
            }
            text += &format!(
                "{:>12} {:>12} {:>10.1e} {:>9} {:>10.4} {:>12.6} {:>12.6}",
                station.jump.cycles,
                station.jump.length,
                station.jump.estimate,
                station.jump.computed,
                station.highest_pressure / self.mean_pressure,
                1e6 * station.worn[0],
                1e6 * station.worn[1]
            );
            text += &if self.warm { format!(" {:>10.2}\n", station.temperature - 273.15) } else { "\n".into() };
        }
        if let Some(last) = self.stations.last() {
            text += &format!(
                "{} cycles from {} computed ones; sum of the error estimates {:.1e}\n",
                last.jump.cycles, last.jump.computed, last.jump.accumulated
            );
        }
        text
    }

    /// As JSON.
    pub fn record(&self) -> Value {
        let station = |s: &Station| {
            json!({
                "cycles": s.jump.cycles,
                "jump": s.jump.length,
                "estimate": s.jump.estimate,
                "accumulated_estimate": s.jump.accumulated,
                "cycles_computed": s.jump.computed,
                "pressure_max": s.highest_pressure,
                "wear_depth_punch": s.worn[0],
                "wear_depth_strip": s.worn[1],
                "contact_temperature": if self.warm { json!(s.temperature) } else { Value::Null },
            })
        };
        let mut record = json!({
            "scene": self.name,
            "x": self.x,
            "wear_profile_punch": self.depth,
            "warning": self.warning,
            "interrupted": self.interrupted,
            "jumps": self.stations.iter().map(station).collect::<Vec<_>>(),
        });
        if let Some(depth) = &self.strip_depth {
            record["wear_profile_strip"] = json!(depth);
        }
        record
    }
}
