//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.
//!
//! Errors are differences to the finest run, whose tolerance is a tenth, plus that run's own error: differences between
//! refinements are extrapolated as a geometric series with the ratio of the last two. Levels are refined until that error is well
//! below the tolerance. If it does not fall below it, no level is named, because the error is unknown.

mod write;

use crate::output::print_line;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use indicatif::{ProgressBar, ProgressStyle};
use scene::variables::{COUNT, find};
use scene_file::SceneFile;
use serde_json::{Value, json};
use verification::applications::Application;
use verification::applications::trial::{Run, Setting, errors, largest, remaining, run};

use crate::columns::{self, Column};

/// Levels from the coarsest to the finest, the last ones only where they are needed.
const LEVELS: [Setting; 7] = [
    Setting::Lumped,
    Setting::Line(9),
    Setting::Line(17),
    Setting::Line(33),
    Setting::Line(65),
    Setting::Line(129),
    Setting::Line(257),
];

/// Tolerance of the reference runs relative to the requested one.
const FINER_STEPS: f64 = 0.1;

/// Error of the finest run relative to the tolerance below which refinement stops; and up to which all errors count as known.
const ENOUGH: [f64; 2] = [0.1, 1.0 / 3.0];

/// A comparison request.
pub struct Request<'a> {
    /// The scene.
    pub scene: SceneFile,
    /// File that it came from, for `--write`.
    pub file: Option<PathBuf>,
    /// Inputs over time.
    pub inputs: &'a Path,
    pub tolerance: Option<f64>,
    pub write: bool,
    pub json: bool,
}

/// A level on the inputs.
#[derive(Clone, Debug)]
struct Candidate {
    setting: Setting,
    /// Estimated errors of the main outputs.
    errors: [f64; 3],
    steps: u64,
    /// Cost by count, microseconds.
    work: f64,
    /// Processor time of the communication steps, s.
    seconds: f64,
}

/// All levels that were run.
#[derive(Debug)]
struct Levels {
    tolerance: f64,
    candidates: Vec<Candidate>,
    /// Levels that could not be run.
    failed: Vec<String>,
    finest: Setting,
    /// Error of the finest run itself.
    finest_error: f64,
}

impl Levels {
    /// Whether the finest run is good enough to tell the errors of the others.
    fn are_known(&self) -> bool {
        self.finest_error <= ENOUGH[1] * self.tolerance
    }

    /// The cheapest that meets the tolerance.
    fn cheapest(&self) -> Option<&Candidate> {
        let good = self.candidates.iter().filter(|known| self.are_known() && largest(known.errors) <= self.tolerance);
        good.min_by(|one, other| one.work.total_cmp(&other.work))
    }
}

/// Runs the command.
///
/// # Errors
/// Where the file of the inputs or the scene is wrong; where no run converges or none meets the tolerance; where the scene
/// cannot be written.
pub fn execute(request: &Request) -> Result<()> {
    let packaged = &request.scene.packaged;
    let own = find("solver.tolerance").map_or(0.0, |reference| packaged.starts[reference as usize]);
    let tolerance = request.tolerance.unwrap_or(if own > 0.0 { own } else { packaged.experiment.tolerance });
    if !(tolerance > 0.0 && tolerance <= 0.5) {
        bail!("the tolerance is {tolerance}, but must be above 0 and at most 0.5");
    }
    let drive = drive(&packaged.name, &packaged.starts, request.inputs)?;
    let levels = compare(&drive, tolerance)?;
    if request.json {
        print_line!("{:#}", record(&levels));
    } else {
        table(&packaged.name, &drive, &levels).iter().for_each(|line| print_line!("{line}"));
    }
    if !levels.are_known() {
        bail!(
            "no level is known to be good: the finest run, {}, has an error of {:.1e} itself, above a third of the tolerance {tolerance:e}; \
             estimated error: 1",
            levels.finest,
            levels.finest_error
        );
    }
    let Some(cheapest) = levels.cheapest() else {
        bail!("no level meets the tolerance {tolerance:e}; the finest that was run is {}", levels.finest);
    };
    if request.write {
        let file =
            request.file.as_deref().ok_or_else(|| anyhow!("--write needs a scene file; the stock scene has none"))?;
        write::settings(file, cheapest.setting, tolerance)?;
        eprintln!("{}: {} is written", file.display(), cheapest.setting);
    }
    Ok(())
}

/// The scene with the inputs of the file; what the file does not have keeps its start value.
fn drive(name: &str, starts: &[f64; COUNT], path: &Path) -> Result<Application> {
    let table = columns::read(path, &Column::inputs())?;
    if table.times.len() < 2 {
        bail!("{} has one row; a drive needs at least two", path.display());
    }
    if !table.names.iter().any(|name| ["sliding_velocity", "angular_velocity"].contains(&name.as_str())) {
        bail!("{} has neither a column sliding_velocity [m/s] nor angular_velocity [rad/s]", path.display());
    }
    let column = |name: &str| -> Result<Vec<f64>> {
        if let Some(values) = table.column(name) {
            return Ok(values.collect());
        }
        let reference = find(name).with_context(|| format!("no variable {name}"))?;
        Ok(vec![starts[reference as usize]; table.times.len()])
    };
    let [velocity, load] = [column("sliding_velocity")?, column("normal_load")?];
    let mut others = Vec::new();
    for other in table.names.iter().filter(|name| !["sliding_velocity", "normal_load"].contains(&name.as_str())) {
        others.push((find(other).with_context(|| format!("no variable {other}"))?, column(other)?));
    }
    let course = (0..table.times.len()).map(|row| [table.times[row], velocity[row], load[row]]).collect();
    Ok(Application { name: name.to_owned(), starts: Box::new(*starts), course, others })
}

/// Runs the levels until the finest is far better than the tolerance.
///
/// # Errors
/// Where fewer than two levels can be run.
fn compare(drive: &Application, tolerance: f64) -> Result<Levels> {
    let bar = ProgressBar::new(LEVELS.len() as u64)
        .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}")?);
    let (mut runs, mut failed): (Vec<(Setting, Run)>, Vec<String>) = (Vec::new(), Vec::new());
    // Runs with finer steps: the two before the last, and the error of the last.
    let mut fine: Vec<(Setting, Vec<[f64; 3]>)> = Vec::new();
    let (mut apart, mut own) = (None, [1.0; 3]);
    for setting in LEVELS {
        bar.set_message(setting.to_string());
        let both = run(drive, setting, tolerance)
            .and_then(|coarse| Ok((coarse, run(drive, setting, (FINER_STEPS * tolerance).max(1e-8))?)));
        bar.inc(1);
        match both {
            Ok((coarse, finer)) => {
                runs.push((setting, coarse));
                // Uniform pressure is another model, not a coarser line.
                if let (Setting::Line(_), Some((Setting::Line(_), before))) = (setting, fine.last()) {
                    let now = errors(before, &finer.main);
                    own = remaining(apart, now);
                    apart = Some(now);
                }
                fine.push((setting, finer.main));
            }
            Err(reason) => failed.push(format!("{setting}: {reason}")),
        }
        if fine.len() > 3 && largest(own) <= ENOUGH[0] * tolerance {
            break;
        }
    }
    bar.finish_and_clear();
    let Some((finest, truth)) = fine.last().filter(|_| fine.len() > 2) else {
        bail!("too few levels can be run to estimate an error: {}", failed.join("; "));
    };
    let known = largest(own) <= ENOUGH[1] * tolerance;
    let candidate = |(setting, run): &(Setting, Run)| {
        let apart = errors(&run.main, truth);
        let errors = std::array::from_fn(|output| if known { apart[output] + own[output] } else { 1.0 });
        Candidate { setting: *setting, errors, steps: run.steps, work: run.work, seconds: run.seconds[1] }
    };
    let candidates = runs.iter().map(candidate).collect();
    Ok(Levels { tolerance, candidates, failed, finest: *finest, finest_error: largest(own) })
}

fn table(name: &str, drive: &Application, levels: &Levels) -> Vec<String> {
    let course = &drive.course;
    let time = course.last().map_or(0.0, |last| last[0] - course[0][0]);
    let mut lines = vec![
        format!("{name}: {time} s in {} communication steps, tolerance {:e}", course.len() - 1, levels.tolerance),
        format!(
            "{:10} {:>10} {:>12} {:>10} {:>10} {:>10}",
            "level", "wear", "temperature", "friction", "steps", "seconds"
        ),
    ];
    for Candidate { setting, errors: [wear, temperature, force], steps, seconds, .. } in &levels.candidates {
        let setting = setting.to_string();
        lines.push(format!("{setting:10} {wear:10.1e} {temperature:12.1e} {force:10.1e} {steps:10} {seconds:10.4}"));
    }
    lines.extend(levels.failed.iter().map(|reason| format!("not run: {reason}")));
    if let Some(cheapest) = levels.cheapest() {
        let (fidelity, cells) = write::level(cheapest.setting);
        let cells = cells.map_or(String::new(), |cells| format!(", solver.cells = {cells}"));
        lines.push(format!(
            "The cheapest that meets it: solver.fidelity = {fidelity:?}{cells}, solver.tolerance = {:e}; estimated error {:.1e}, {:.4} s",
            levels.tolerance,
            largest(cheapest.errors),
            cheapest.seconds
        ));
    }
    lines
}

fn record(levels: &Levels) -> Value {
    let candidates = levels.candidates.iter().map(|known| {
        let (fidelity, cells) = write::level(known.setting);
        let [wear, temperature, force] = known.errors;
        json!({
            "fidelity": fidelity,
            "cells": cells.unwrap_or(1),
            "error_wear_depth": wear,
            "error_contact_temperature": temperature,
            "error_friction_force": force,
            "steps": known.steps,
            "work_microseconds": known.work,
            "seconds": known.seconds,
        })
    });
    let cheapest = levels.cheapest().map(|known| {
        let (fidelity, cells) = write::level(known.setting);
        json!({ "fidelity": fidelity, "cells": cells.unwrap_or(1), "estimated_error": largest(known.errors) })
    });
    json!({
        "tolerance": levels.tolerance,
        "converges": levels.are_known(),
        "finest": levels.finest.to_string(),
        "finest_error": levels.finest_error,
        "levels": candidates.collect::<Vec<_>>(),
        "failed": levels.failed,
        "cheapest": cheapest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use std::fs;

    fn with_inputs<T>(name: &str, text: &str, then: impl FnOnce(&Path) -> T) -> T {
        let path = std::env::temp_dir().join(format!("drive-{}-{name}.csv", std::process::id()));
        fs::write(&path, text).unwrap();
        let result = then(&path);
        fs::remove_file(&path).unwrap();
        result
    }

    fn stock() -> SceneFile {
        scenes::load(None).unwrap()
    }

    const STOP: &str = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,18,2\n0.5,18,2\n1,9,2\n2,0,2\n";

    #[test]
    fn columns_become_inputs_in_si_units_and_others_keep_their_start() {
        let packaged = stock().packaged;
        let text =
            "normal_load [kN],time [s],ambient_temperature_offset [K],sliding_velocity_km_per_h\n3,0,5,36\n4,2,6,72\n";
        let drive = with_inputs("units", text, |path| drive("stock", &packaged.starts, path)).unwrap();
        assert_eq!(drive.course, [[0.0, 10.0, 3e3], [2.0, 20.0, 4e3]]);
        assert_eq!(drive.others, [(find("ambient_temperature_offset").unwrap(), vec![5.0, 6.0])]);
        let text = "time [s],angular_velocity [rad/s]\n0,1\n1,2\n";
        let drive = with_inputs("angular", text, |path| super::drive("stock", &packaged.starts, path)).unwrap();
        assert_eq!(drive.course, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    }

    #[test]
    fn what_is_wrong_with_a_drive_is_told() {
        let packaged = stock().packaged;
        for (name, text, wanted) in [
            ("unit", "time [s],sliding_velocity\n0,1\n1,1\n", "does not say its unit"),
            ("one", "time [s],sliding_velocity [m/s]\n0,1\n", "at least two"),
            ("still", "time [s],normal_load [N]\n0,1\n1,1\n", "neither a column sliding_velocity"),
            ("word", "time [s],sliding_velocity [m/s]\n0,1\n1,fast\n", "line 3, column 2"),
        ] {
            let told =
                format!("{:#}", with_inputs(name, text, |path| drive("stock", &packaged.starts, path)).unwrap_err());
            assert!(told.contains(wanted), "{told}\nis without {wanted}");
        }
    }

    /// The cheapest level's stated error agrees with its distance from an independent finer run.
    #[test]
    fn the_cheapest_level_on_a_short_stop_meets_the_tolerance() {
        let packaged = stock().packaged;
        let drive = with_inputs("stop", STOP, |path| drive("stock", &packaged.starts, path)).unwrap();
        let levels = compare(&drive, 1e-2).unwrap();
        assert!(levels.are_known(), "{levels:?}");
        let cheapest = levels.cheapest().unwrap();
        let truth = run(&drive, Setting::Line(49), 5e-4).unwrap();
        let chosen = run(&drive, cheapest.setting, 1e-2).unwrap();
        let error = largest(errors(&chosen.main, &truth.main));
        let estimated = largest(cheapest.errors);
        assert!(error <= 1e-2, "{error}: {levels:?}");
        assert!(error <= 2.0 * estimated && estimated <= 5.0 * error.max(1e-4), "{error} {estimated}: {levels:?}");
        // No coarser level meets the tolerance.
        for known in levels.candidates.iter().filter(|known| known.work < cheapest.work) {
            assert!(largest(known.errors) > 1e-2, "{known:?}");
        }
    }

    #[test]
    fn a_finest_run_that_has_not_converged_names_no_level() {
        let errors = [1e-4; 3];
        let known = Candidate { setting: Setting::Lumped, errors, steps: 1, work: 1.0, seconds: 1.0 };
        let mut levels = Levels {
            tolerance: 1e-2,
            candidates: vec![known],
            failed: Vec::new(),
            finest: Setting::Line(257),
            finest_error: 3e-3,
        };
        assert!(levels.cheapest().is_some());
        levels.finest_error = 4e-3;
        assert!(levels.cheapest().is_none());
    }

    #[test]
    fn a_tolerance_that_no_run_can_have_is_refused() {
        for tolerance in [0.0, -1.0, 7.0, f64::NAN] {
            let request = Request {
                scene: stock(),
                file: None,
                inputs: Path::new("none.csv"),
                tolerance: Some(tolerance),
                write: false,
                json: false,
            };
            let told = format!("{:#}", execute(&request).unwrap_err());
            assert!(told.contains("at most 0.5"), "{told}");
        }
    }
}
