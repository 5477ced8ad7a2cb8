//! `cargo fmu plan`: what `solver.fidelity = auto` chooses for a scene, and how good its choices are.

mod field;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use anyhow::{Context, Result, anyhow, bail};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use sliding_contact::plan::{self, Plan};
use sliding_contact::scene::{Fidelity, Scene};
use sliding_contact::verification::planning::judge::{Judged, judge, timed_plan, truth};
use sliding_contact::verification::planning::scenes::{Generated, generate};

use crate::chart::machine;
use crate::output::{self, print_line, print_text};
use crate::scenes;

/// Tolerances of the campaign.
const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// Print what `solver.fidelity = auto` takes for a scene: effects with the number that decided, kept or dropped, and
/// what that costs.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of a folder in `examples`; by default the stock scene.
    scene: Option<String>,
    /// Give a variable another value, as KEY=VALUE.
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Tolerance of the importer, where `solver.tolerance` is 0.
    #[arg(long, value_parser = scenes::tolerance)]
    tolerance: Option<f64>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Try plans on generated scenes against every fixed setting, with a far finer run as the truth.
    #[arg(long, conflicts_with_all = ["scene", "set", "tolerance", "json"])]
    campaign: bool,
    /// Generated scenes of the campaign.
    #[arg(long, default_value_t = 50, requires = "campaign")]
    scenes: u64,
    /// Seed of the first of them.
    #[arg(long, default_value_t = 0, requires = "campaign")]
    first: u64,
    /// Cells of the truth.
    #[arg(long, default_value_t = 129, requires = "campaign")]
    cells: usize,
    /// Measure what a step costs on the planned rung and at the level `field`, for an error of 1 %.
    #[arg(long, conflicts_with_all = ["campaign", "set", "tolerance", "json"])]
    against_field: bool,
    /// File to write the table of the campaign, or of the costs, to.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Where the scene is refused, or a level cannot be built.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_ending(arguments.output.as_deref(), "csv")?;
    if arguments.output.is_some() && !(arguments.campaign || arguments.against_field) {
        bail!("--output holds the table of --campaign or --against-field, and neither is asked for");
    }
    if arguments.campaign {
        return campaign(arguments);
    }
    if arguments.against_field {
        return field::measure(arguments.scene.as_deref(), arguments.output.as_deref());
    }
    let mut file = scenes::load(arguments.scene.as_deref())?;
    for assignment in &arguments.set {
        scenes::assign(&mut file, assignment)?;
    }
    scenes::warn(&file);
    let starts = &file.packaged.starts;
    let importer = arguments.tolerance.or(Some(file.packaged.experiment.tolerance));
    let mut scene = Scene::new(starts, importer).map_err(|broken| anyhow!("{broken}"))?;
    // The plan is printed also where the scene fixes its level.
    let fixed = scene.fidelity;
    scene.fidelity = Fidelity::Auto;
    let planned = plan::make(&scene).map_err(|text| anyhow!(text))?;
    if arguments.json {
        print_line!("{:#}", record(&planned.plan));
        return Ok(());
    }
    print_line!(
        "{}: load {} N, speed {} m/s, {} s",
        file.packaged.name,
        scene.nominal_load,
        scene.nominal_velocity,
        scene.nominal_duration
    );
    for line in planned.plan.lines() {
        print_line!("{line}");
    }
    if fixed != Fidelity::Auto {
        print_line!("The scene itself sets solver.fidelity = {}.", format!("{fixed:?}").to_lowercase());
    }
    Ok(())
}

fn record(plan: &Plan) -> Value {
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
            "level": candidate.rung.level(),
            "cells": candidate.rung.cells(),
            "name": candidate.rung.to_string(),
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
        "level": plan.rung.level(),
        "cells": plan.rung.cells(),
        "rung": plan.rung.to_string(),
        "meets_tolerance": plan.meets,
        "reason": plan.reason,
        "order": plan.order,
        "thermal_states": { "punch": plan.states[0], "strip": plan.states[1], "moving_source": plan.states[2] },
        "estimated_error": plan.estimated_error,
        "reduction_error": plan.reduction_error,
        "cost_per_step_microseconds": plan.cost_per_step,
        "expected_run_seconds": 1e-6 * plan.effort.run,
        "probe_steps": plan.probe_steps,
        "probe_covered": plan.covered,
        "planning_seconds": 1e-6 * plan.effort.planning(),
        "effects": effects.collect::<Vec<_>>(),
        "groups": groups,
        "candidates": candidates.collect::<Vec<_>>(),
    })
}

/// A generated scene at a tolerance.
struct Case {
    scene: Generated,
    /// Cells of the truth, and its largest error.
    truth: (usize, f64),
    judged: Judged,
}

/// What became of a scene: its cases, or why there are none.
#[derive(Default)]
struct Tried {
    cases: Vec<Case>,
    left_out: Vec<String>,
}

/// Processor time of planning and of building at the tolerances of the campaign, s, with nothing else under way.
type Alone = [Option<[f64; 2]>; TOLERANCES.len()];

fn tried(seed: u64, cells: usize, alone: &Alone) -> Tried {
    let scene = generate(seed);
    let mut tried = Tried::default();
    let truth = match truth(&scene, cells) {
        Ok(truth) => truth,
        Err(text) => {
            tried.left_out.push(format!("{}: {text}", scene.name()));
            return tried;
        }
    };
    for (tolerance, alone) in TOLERANCES.into_iter().zip(alone) {
        match judge(&scene, tolerance, &truth) {
            Ok(mut judged) => {
                judged.planning_seconds = alone.unwrap_or(judged.planning_seconds);
                let truth = (truth.cells, truth.errors.into_iter().fold(0.0, f64::max));
                tried.cases.push(Case { scene: scene.clone(), truth, judged });
            }
            Err(text) => tried.left_out.push(format!("{} at {tolerance:e}: {text}", scene.name())),
        }
    }
    tried
}

fn campaign(arguments: &Arguments) -> Result<()> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}")?;
    let bar = ProgressBar::new(arguments.scenes).with_style(style);
    let seeds = arguments.first..arguments.first + arguments.scenes;
    // Before the cores are busy with runs: a plan is as dear as it is, not as what runs beside it.
    let alone: BTreeMap<u64, Alone> = (seeds.clone())
        .map(|seed| (seed, TOLERANCES.map(|tolerance| Some(timed_plan(&generate(seed), tolerance).ok()?.1))))
        .collect();
    let (next, all) = (AtomicU64::new(seeds.start), Mutex::new(BTreeMap::new()));
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        break;
                    }
                    let tried = tried(seed, arguments.cells, &alone[&seed]);
                    let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
                    all.insert(seed, tried);
                    // A long campaign shows what it has.
                    if let Some(path) = &arguments.output {
                        let _ = fs::write(path, table(&all, arguments.cells));
                    }
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    if all.values().all(|tried: &Tried| tried.cases.is_empty()) {
        let reasons: Vec<&str> = all.values().flat_map(|tried| &tried.left_out).map(String::as_str).collect();
        bail!("no scene could be run: {}", reasons.join("; "));
    }
    let table = table(&all, arguments.cells);
    match &arguments.output {
        Some(path) => fs::write(path, table).with_context(|| format!("writing {}", path.display()))?,
        None => print_text!("{table}"),
    }
    let cases: Vec<&Judged> = all.values().flat_map(|tried| &tried.cases).map(|case| &case.judged).collect();
    print_text!("{}", verdict(&cases));
    Ok(())
}

fn table(all: &BTreeMap<u64, Tried>, cells: usize) -> String {
    let mut text = format!(
        "# Plans of solver.fidelity = auto on generated scenes; truth: {cells} cells (truth_cells) at solver.tolerance 1e-4; truth_error: how far half \
         as many cells at 2e-4 are from it.\n\
         # Errors of wear depth (of the most worn), contact temperature (of the peak rise), friction force (of its peak).\n\
         # planning_seconds without building the rung that is chosen, which takes building_seconds: processor time, the least of three, nothing else under way.\n\
         # {}; commit {}.\n",
        machine::name(),
        machine::commit()
    );
    for reason in all.values().flat_map(|tried| &tried.left_out) {
        let _ = writeln!(text, "# left out: {reason}");
    }
    text.push_str(
        "group,seed,tolerance,rung,planned_error,estimated_error,error_wear,error_temperature,error_force,truth_cells,truth_error,work_us,seconds,\
         planning_seconds,building_seconds,cheapest,cheapest_work_us\n",
    );
    for Case { scene, truth, judged } in all.values().flat_map(|tried| &tried.cases) {
        let [wear, temperature, force] = judged.chosen.errors;
        let (cheapest, work) =
            judged.cheapest().map_or((String::new(), f64::NAN), |cheapest| (cheapest.rung.to_string(), cheapest.work));
        let _ = writeln!(
            text,
            "{},{},{:e},\"{}\",{:.2e},{:.2e},{wear:.2e},{temperature:.2e},{force:.2e},{},{:.2e},{:.0},{:.2e},{:.2e},{:.2e},\"{cheapest}\",{work:.0}",
            scene.group.name(),
            scene.seed,
            judged.tolerance,
            judged.chosen.rung,
            judged.planned_error,
            judged.estimated_error,
            truth.0,
            truth.1,
            judged.chosen.work,
            judged.chosen.seconds,
            judged.planning_seconds[0],
            judged.planning_seconds[1],
        );
    }
    text
}

/// The campaign's numbers, a line per tolerance.
fn verdict(cases: &[&Judged]) -> String {
    let mut text = String::new();
    let part = |count: usize, all: usize| if all > 0 { 100.0 * count as f64 / all as f64 } else { f64::NAN };
    for tolerance in TOLERANCES {
        let of: Vec<&Judged> = cases.iter().copied().filter(|judged| judged.tolerance == tolerance).collect();
        let met = of.iter().filter(|judged| judged.chosen.error() <= tolerance).count();
        let worst = of.iter().map(|judged| judged.chosen.error() / tolerance).fold(0.0, f64::max);
        let possible = of.iter().filter(|judged| judged.cheapest().is_some()).count();
        let cheap = of.iter().filter(|judged| judged.cost_ratio().is_some_and(|ratio| ratio <= 2.0)).count();
        let ratio = |judged: &&Judged| judged.estimated_error / judged.chosen.error().max(1e-12);
        let honest = of.iter().filter(|judged| (0.2..=5.0).contains(&ratio(judged))).count();
        let quick = of.iter().filter(|judged| judged.planning_is_cheap()).count();
        let lowest = of.iter().map(ratio).fold(f64::INFINITY, f64::min);
        let _ = writeln!(
            text,
            "tolerance {tolerance:e}: met by {met} of {} ({:.0} %), at worst {worst:.2} times; a fixed setting meets it in {possible}; \
             at most twice the cheapest in {cheap} ({:.0} %); estimated_error within 5 in {honest} ({:.0} %), lowest {lowest:.2} of the error; planning below 20 ms or 1 % of the run in {quick} ({:.0} %)",
            of.len(),
            part(met, of.len()),
            part(cheap, possible),
            part(honest, of.len()),
            part(quick, of.len()),
        );
    }
    text
}
