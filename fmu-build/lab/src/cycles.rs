//! `cargo fmu cycles`: reciprocating sliding over many cycles by cycle jumps.

use crate::output::{self, print_line, print_text};
use crate::plot::{Axis, Figure, Legend, Mark, Panel, Series};
use crate::scenes;
use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use model::line::cycle::map::sliding_scene;
use model::line::cycle::{CycleMap, JumpOptions, Jumps, Resolution};
use model::line::heat::bodies::is_resolved;
use model::line::operators::LineOperators;
use scene::Scene;
use serde_json::{Value, json};
use std::path::PathBuf;
use steady::thermal::nominal_half_strokes;

/// Advance a reciprocating scene over many cycles at nominal load and speed.
///
/// Cycles are computed one by one only where the contact changes from one to the next; elsewhere implicit cycle jumps with an
/// error estimate each skip many cycles. Prints the jumps, and the worn depths and contact temperature at the end.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock scene.
    scene: Option<String>,
    /// Number of cycles.
    #[arg(long, value_name = "N", default_value_t = 1e6)]
    cycles: f64,
    /// Largest estimated error of a jump: of the shape over the elastic displacement under the mean pressure, of the heat over
    /// the heat, of the wear over that of the jump.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-3)]
    tolerance: f64,
    /// Cells of the contact line; by default the scene's, or 33.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1025))]
    cells: Option<u16>,
    /// Without heat.
    #[arg(long)]
    cold: bool,
    /// Give a variable of the scene another value, as punch.wear_coefficient=1e-14; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the jumps as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Draw edge pressure, wear and temperature over the cycles as SVG into this file.
    #[arg(short, long, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}

/// Recorded quantities of a jump.
struct Station {
    cycles: f64,
    length: f64,
    estimate: f64,
    accumulated: f64,
    computed: usize,
    /// Largest pressure of the forward half-stroke's mean, Pa.
    highest_pressure: f64,
    /// Mean worn depths of punch and strip, m.
    worn: [f64; 2],
    /// K; of a cold scene the ambient temperature.
    temperature: f64,
}

struct Course {
    name: String,
    warm: bool,
    mean_pressure: f64,
    stations: Vec<Station>,
    /// Worn depth of the punch in the end, by cell, m.
    depth: Vec<f64>,
    x: Vec<f64>,
}

/// Runs the command.
///
/// # Errors
/// Everything wrong with the scene, one without reciprocating sliding, a cycle without a solution, a file that cannot be
/// written.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_ending(arguments.output.as_deref(), "svg")?;
    let course = course(arguments)?;
    if arguments.json {
        print_line!("{:#}", course.record());
    } else {
        print_text!("{}", course.table());
    }
    if let Some(path) = &arguments.output {
        course.figure().write(path)?;
        if !arguments.json {
            print_line!("drawn in {}", path.display());
        }
    }
    Ok(())
}

fn course(arguments: &Arguments) -> Result<Course> {
    let mut file = scenes::load(arguments.scene.as_deref())?;
    for assignment in &arguments.set {
        scenes::assign(&mut file, assignment)?;
    }
    scenes::warn(&file);
    let name = file.packaged.name;
    let mut scene = Scene::new(&file.packaged.starts, Some(file.packaged.experiment.tolerance))?;
    if scene.nominal_stroke == 0.0 || scene.nominal_velocity == 0.0 {
        bail!(
            "the scene {name} is not reciprocating: nominal.stroke = {} m, nominal.velocity = {} m/s",
            scene.nominal_stroke,
            scene.nominal_velocity
        );
    }
    if !(arguments.cycles >= 1.0 && arguments.cycles <= 1e15 && arguments.cycles.fract() == 0.0) {
        bail!("--cycles {}: must be a whole number from 1 to 1e15", arguments.cycles);
    }
    if !(arguments.tolerance >= 1e-6 && arguments.tolerance <= 0.1) {
        bail!("--tolerance {}: must be from 1e-6 to 0.1", arguments.tolerance);
    }
    if let Some(cells) = arguments.cells {
        scene.cells = usize::from(cells);
    }
    let half_strokes = nominal_half_strokes(&scene);
    let period = half_strokes[0].1 + half_strokes[1].1;
    // The reduced bodies must be accurate over the whole duration.
    scene.nominal_duration = scene.nominal_duration.max(period * arguments.cycles);
    let warm = !arguments.cold && is_resolved(&scene);
    let resolution = if warm { Resolution::WITH_HEAT } else { Resolution::COLD };
    let operators = LineOperators::with_heat(&sliding_scene(&scene), warm, steady::run_in)
        .map_err(|error| anyhow::anyhow!(error))
        .with_context(|| format!("the scene {name}"))?;
    let mut map = CycleMap::new(operators, half_strokes, resolution)?;
    let (x, reference) = (map.operators().cells.centres().to_vec(), map.reference());
    let width: f64 = map.operators().weights.iter().sum();
    let punch = map.worn_ranges()[0].clone();
    let start = map.start();
    let options = JumpOptions { tolerance: arguments.tolerance, ..JumpOptions::default() };
    let bar = ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:30} {msg}")?);
    let mut stations = Vec::new();
    let mut depth = vec![0.0; x.len()];
    let mut jumps = Jumps::new(&mut map, start, options);
    jumps.carry_to(arguments.cycles, |jump| {
        bar.set_position((1000.0 * (1.0 + jump.cycles).ln() / (1.0 + arguments.cycles).ln()) as u64);
        bar.set_message(format!("{} cycles, {} computed", jump.cycles, jump.computed));
        let pressure = &jump.passage.strokes[0].pressure;
        depth.copy_from_slice(&jump.memory[punch.clone()]);
        stations.push(Station {
            cycles: jump.cycles,
            length: jump.length,
            estimate: jump.estimate,
            accumulated: jump.accumulated,
            computed: jump.computed,
            highest_pressure: pressure.iter().copied().fold(0.0, f64::max),
            worn: jump.totals.volume.map(|volume| volume / width),
            temperature: reference + if warm { jump.passage.contact_temperature[1] } else { 0.0 },
        });
    })?;
    bar.finish_and_clear();
    let mean_pressure = scene.nominal_load / (scene.count * scene.contact_area());
    Ok(Course { name, warm, mean_pressure, stations, depth, x })
}

impl Course {
    fn record(&self) -> Value {
        let station = |s: &Station| {
            json!({
                "cycles": s.cycles,
                "jump": s.length,
                "estimate": s.estimate,
                "accumulated_estimate": s.accumulated,
                "cycles_computed": s.computed,
                "pressure_max": s.highest_pressure,
                "wear_depth_punch": s.worn[0],
                "wear_depth_strip": s.worn[1],
                "contact_temperature": if self.warm { json!(s.temperature) } else { Value::Null },
            })
        };
        json!({
            "scene": self.name,
            "x": self.x,
            "wear_profile_punch": self.depth,
            "jumps": self.stations.iter().map(station).collect::<Vec<_>>(),
        })
    }

    fn table(&self) -> String {
        let mut text = format!(
            "{}{}\n{:>12} {:>12} {:>10} {:>9} {:>10} {:>12} {:>12}",
            self.name,
            if self.warm { ", with heat" } else { ", without heat" },
            "cycles",
            "jump",
            "estimate",
            "computed",
            "p_max/p_m",
            "punch, um",
            "strip, um"
        );
        text += if self.warm { "    T, degC\n" } else { "\n" };
        // Of cycles computed one after the other, the first and the last.
        let single = |index: usize| self.stations.get(index).is_some_and(|station| station.length == 1.0);
        for (index, station) in self.stations.iter().enumerate() {
            if index > 0 && single(index - 1) && single(index) && single(index + 1) {
                continue;
            }
            text += &format!(
                "{:>12} {:>12} {:>10.1e} {:>9} {:>10.4} {:>12.6} {:>12.6}",
                station.cycles,
                station.length,
                station.estimate,
                station.computed,
                station.highest_pressure / self.mean_pressure,
                1e6 * station.worn[0],
                1e6 * station.worn[1]
            );
            text += &if self.warm { format!(" {:>10.2}\n", station.temperature - 273.15) } else { "\n".into() };
        }
        if let Some(last) = self.stations.last() {
            text += &format!(
                "{} cycles from {} computed ones; sum of the error estimates {:.1e}\n",
                last.cycles, last.computed, last.accumulated
            );
        }
        text
    }

    fn figure(&self) -> Figure {
        let over = |value: &dyn Fn(&Station) -> f64| -> Vec<(f64, f64)> {
            self.stations.iter().map(|station| (station.cycles, value(station))).collect()
        };
        let cycles = || Axis::logarithmic("cycles, 1");
        let worn = ["punch", "strip"].into_iter().enumerate().filter_map(|(body, name)| {
            let depth = over(&|s| 1e6 * s.worn[body]);
            let wears = depth.iter().any(|(_, depth)| *depth > 0.0);
            wears.then(|| Series::line(name, depth).with(Mark::LineAndPoints))
        });
        let worn: Vec<Series> = worn.collect();
        let mut panels = vec![
            Panel::new(
                "Largest mean pressure of the forward half-stroke",
                cycles(),
                Axis::new("pressure, MPa"),
                vec![Series::line("", over(&|s| 1e-6 * s.highest_pressure)).with(Mark::LineAndPoints)],
            ),
            Panel::new("Mean worn depth", cycles(), Axis::logarithmic("depth, um"), worn)
                .with_legend(Legend::UpperLeft),
        ];
        if self.warm {
            let temperature = vec![Series::line("", over(&|s| s.temperature - 273.15)).with(Mark::LineAndPoints)];
            panels.push(Panel::new("Mean contact temperature", cycles(), Axis::new("temperature, degC"), temperature));
        }
        Figure::new(format!("{} over its cycles", self.name), panels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_cycles_of_the_reciprocating_punch() {
        let arguments = Arguments {
            scene: Some("reciprocating_punch".into()),
            cycles: 1e6,
            tolerance: 1e-2,
            cells: Some(17),
            cold: true,
            set: Vec::new(),
            json: false,
            output: None,
        };
        let course = course(&arguments).unwrap();
        let last = course.stations.last().unwrap();
        // k p s, independent of the path.
        let expected = 3.9e-14 * course.mean_pressure * 6e-3 * 1e6;
        assert!((last.worn[0] / expected - 1.0).abs() < 1e-6, "{} {expected}", last.worn[0]);
        assert!(last.computed < 2000 && course.table().contains("1000000"), "{}", course.table());
        assert!((last.highest_pressure / course.mean_pressure - 2.0).abs() < 1e-3, "{}", course.table());
        assert!(course.figure().svg().unwrap().contains("depth, um"));
    }
}
