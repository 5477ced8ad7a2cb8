//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.
//!
//! With d the distance of two runs, f the finest line, f' that on half of its cells, and t the line f at a tenth of the tolerance, the
//! error of a level is stated as `d(level, t) + d(f', f)`: the second part bounds the error of f where cells converge at first order.

use crate::simulation::{Recording, Trajectory, run};
use anyhow::{Result, bail};
use model::plan::ModelLevel;
use model::plan::distance::{Distance, Main, largest};
use numerics::interruption::part;
use scene::slot::LARGEST_TOLERANCE;
use scene::variables::{find, reference};
use scene_file::SceneFile;
use serde_json::{Value, json};

/// Levels from the coarsest to the finest, the last ones only where they are needed.
pub const LEVELS: [ModelLevel; 6] = [
    ModelLevel::Lumped,
    ModelLevel::Line(9),
    ModelLevel::Line(17),
    ModelLevel::Line(33),
    ModelLevel::Line(65),
    ModelLevel::Line(129),
];

/// Tolerance of the reference run relative to the requested one.
const FINER_STEPS: f64 = 0.1;

/// Difference of the two finest lines relative to the tolerance below which refinement ends.
const ENOUGH: f64 = 0.1;

/// A level on the inputs.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The level.
    pub level: ModelLevel,
    /// Errors of the main outputs; not numbers where fewer than two lines were run before an interruption.
    pub errors: Main,
    /// Internal steps.
    pub steps: u64,
    /// Time of the communication steps, s.
    pub seconds: f64,
}

/// All levels that were run.
#[derive(Debug)]
pub struct Levels {
    /// Relative tolerance that a level must meet.
    pub tolerance: f64,
    /// Levels with their errors.
    pub candidates: Vec<Candidate>,
    /// Levels that could not be run.
    pub failed: Vec<String>,
    /// Difference of the two finest lines, below which errors are not told apart.
    pub resolution: f64,
    /// Whether the comparison was ended on request ([`numerics::interruption`]): errors are against the finest line that was run.
    pub interrupted: bool,
}

impl Levels {
    /// As a table: errors and cost of every level, and the cheapest that meets the tolerance.
    pub fn table(&self, name: &str, trajectory: &Trajectory) -> String {
        let (first, last) = trajectory.span();
        let mut text = format!(
            "{name}: {} s, tolerance {:e}; errors of wear depth, temperature rise and friction force\n\
             {:16} {:>10} {:>12} {:>10} {:>10} {:>10}\n",
            last - first,
            self.tolerance,
            "level",
            "wear",
            "temperature",
            "friction",
            "steps",
            "seconds"
        );
        for Candidate { level, errors, steps, seconds } in &self.candidates {
            let level = level.to_string();
            let shown = |error: f64| if error.is_nan() { "-".into() } else { format!("{error:.1e}") };
            let [wear, temperature, force] = errors.map(shown);
            text += &format!("{level:16} {wear:>10} {temperature:>12} {force:>10} {steps:10} {seconds:10.4}\n");
        }
        if self.resolution.is_finite() {
            text += &format!("The two finest lines differ by {:.1e}, which is part of every error.\n", self.resolution);
        }
        for reason in &self.failed {
            text += &format!("not run: {reason}\n");
        }
        if self.interrupted {
            text += "Interrupted: errors are against the finest line above, with its own steps.\n";
        } else if let Ok(cheapest) = self.cheapest() {
            text += &format!(
                "The cheapest that meets it: {}, solver.tolerance = {:e}; error {:.1e}, {:.4} s\n",
                settings_text(cheapest.level),
                self.tolerance,
                largest(cheapest.errors),
                cheapest.seconds
            );
        }
        text
    }

    /// The coarsest level that meets the tolerance.
    ///
    /// # Errors
    /// Where none does, with the smallest error.
    pub fn cheapest(&self) -> Result<&Candidate> {
        if let Some(good) = self.candidates.iter().find(|known| largest(known.errors) <= self.tolerance) {
            return Ok(good);
        }
        let error = |known: &Candidate| largest(known.errors);
        match self.candidates.iter().min_by(|one, other| error(one).total_cmp(&error(other))) {
            Some(best) => bail!(
                "no level meets the tolerance {:e}: the smallest error is {:.1e}, with {}; a looser tolerance has one, and \
                 nominal.duration, nominal.load and nominal.velocity near those of the inputs lower the error",
                self.tolerance,
                error(best),
                best.level
            ),
            None => bail!("no level could be run: {}", self.failed.join("; ")),
        }
    }
}

/// Value of `solver.fidelity`, and of `solver.cells` on a line.
pub fn settings(level: ModelLevel) -> (&'static str, usize) {
    match level {
        ModelLevel::Lumped => ("lumped", 0),
        ModelLevel::Line(cells) => ("line", cells),
    }
}

/// A level as settings of a scene, in words.
pub fn settings_text(level: ModelLevel) -> String {
    let (fidelity, cells) = settings(level);
    let cells = if cells > 0 { format!(", solver.cells = {cells}") } else { String::new() };
    format!("solver.fidelity = {fidelity:?}{cells}")
}

/// Tolerance of the comparison: the given one, the scene's own, that of its default experiment.
pub fn tolerance(file: &SceneFile, given: Option<f64>) -> Result<f64> {
    let own = file.packaged.starts[const { reference("solver.tolerance") } as usize];
    let tolerance = given.unwrap_or(if own > 0.0 { own } else { file.packaged.experiment.tolerance });
    if !(tolerance > 0.0 && tolerance <= LARGEST_TOLERANCE) {
        bail!("the tolerance is {tolerance}, but must be above 0 and at most {LARGEST_TOLERANCE}");
    }
    Ok(tolerance)
}

fn history(recording: &Recording, ambient: f64) -> Vec<Main> {
    let [wear, temperature, force] =
        ["wear_depth", "contact_temperature", "friction_force"].map(|name| recording.values(name));
    (0..recording.times.len()).map(|row| [wear[row], temperature[row] - ambient, force[row]]).collect()
}

/// Runs the levels until lines agree far better than the tolerance. `progress`: of the level with this number, the part done.
pub fn compare(
    file: &SceneFile,
    trajectory: &Trajectory,
    tolerance: f64,
    progress: &mut dyn FnMut(usize, f64),
) -> Result<Levels> {
    let ambient = file.packaged.starts[const { reference("ambient_temperature") } as usize];
    let (first, last) = trajectory.span();
    let mut on = |number: usize, level: ModelLevel, tolerance: f64| -> Result<Recording> {
        let mut file = file.clone();
        let (fidelity, cells) = settings(level);
        let fidelity = if fidelity == "lumped" { 2.0 } else { 3.0 };
        for (name, value) in [
            ("solver.fidelity", fidelity),
            ("solver.cells", cells as f64),
            ("solver.tolerance", tolerance),
            // Named levels without a companion: the comparison is this one.
            ("solver.error_estimate", 2.0),
        ] {
            file.packaged.starts[find(name).map_or(0, |found| found as usize)] = value;
        }
        run(&file, trajectory, &[], &mut |time| progress(number, (time - first) / (last - first)))
    };
    let mut runs: Vec<(ModelLevel, Recording, Vec<Main>)> = Vec::new();
    let (mut failed, mut reasons) = (Vec::new(), Vec::new());
    let (mut resolution, mut interrupted) = (f64::INFINITY, false);
    for (number, level) in LEVELS.into_iter().enumerate() {
        let recording = match part(|| on(number, level, tolerance)).filter(is_whole) {
            None => {
                interrupted = true;
                break;
            }
            Some(Ok(recording)) => recording,
            Some(Err(reason)) => {
                failed.push(format!("{level}: {reason:#}"));
                reasons.push(reason.to_string());
                continue;
            }
        };
        if let Some(reason) = recording.failure {
            failed.push(format!("{level}: {reason}"));
            continue;
        }
        let main = history(&recording, ambient);
        if let Some((ModelLevel::Line(_), _, coarser)) = runs.last() {
            resolution = largest(Distance::of(&main, coarser).relative());
        }
        runs.push((level, recording, main));
        if resolution <= ENOUGH * tolerance {
            break;
        }
    }
    let mut truth = None;
    match runs.last().filter(|_| resolution.is_finite()) {
        Some((_, _, main)) if interrupted => truth = Some(main.clone()),
        None if interrupted => {}
        Some((finest, _, main)) => {
            let finer = part(|| on(runs.len(), *finest, FINER_STEPS * tolerance)).filter(is_whole);
            interrupted = finer.is_none();
            truth = Some(finer.transpose()?.map_or_else(|| main.clone(), |finer| history(&finer, ambient)));
        }
        // What is wrong with the scene or the inputs is so at every level.
        None if reasons.len() == LEVELS.len() && reasons.iter().all(|reason| *reason == reasons[0]) => {
            bail!("{}", reasons[0])
        }
        None => bail!("fewer than two contact lines can be run: {}", failed.join("; ")),
    }
    let candidates = runs.iter().map(|(level, recording, main)| {
        let (accepted, rejected) = recording.internal_steps;
        let errors = truth.as_ref().map(|truth| Distance::of(truth, main).relative().map(|apart| apart + resolution));
        Candidate {
            level: *level,
            errors: errors.unwrap_or([f64::NAN; 3]),
            steps: accepted + rejected,
            seconds: recording.seconds[1],
        }
    });
    Ok(Levels { tolerance, candidates: candidates.collect(), failed, resolution, interrupted })
}

fn is_whole(run: &Result<Recording>) -> bool {
    run.as_ref().map_or(true, |recording| !recording.interrupted)
}

/// All levels as JSON.
pub fn record(levels: &Levels) -> Value {
    let candidates = levels.candidates.iter().map(|known| {
        let (fidelity, cells) = settings(known.level);
        let [wear, temperature, force] = known.errors;
        json!({
            "fidelity": fidelity,
            "cells": cells.max(1),
            "error_wear_depth": wear,
            "error_contact_temperature": temperature,
            "error_friction_force": force,
            "steps": known.steps,
            "seconds": known.seconds,
        })
    });
    let cheapest = levels.cheapest().ok().filter(|_| !levels.interrupted).map(|known| {
        let (fidelity, cells) = settings(known.level);
        json!({ "fidelity": fidelity, "cells": cells.max(1), "estimated_error": largest(known.errors) })
    });
    json!({
        "tolerance": levels.tolerance,
        "resolution": levels.resolution,
        "levels": candidates.collect::<Vec<_>>(),
        "failed": levels.failed,
        "cheapest": cheapest,
        "interrupted": levels.interrupted,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene_file::columns::{self, Column, Reading};
    use std::path::Path;

    fn stock() -> SceneFile {
        scene_file::shipped::load(None, Path::new("")).unwrap()
    }

    fn stop(text: &str) -> Result<Trajectory> {
        Trajectory::new(
            &stock(),
            Some(columns::parse(text.as_bytes(), Path::new("drive.csv"), &Column::inputs(), &Reading::default())?),
            None,
        )
    }

    const STOP: &str = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,18,2\n0.5,18,2\n1,9,2\n2,0,2\n";

    /// The stated error of the cheapest level agrees with its distance from a finer run, and no coarser level meets the tolerance.
    #[test]
    fn the_cheapest_level_on_a_short_stop_meets_the_tolerance() {
        let (file, trajectory) = (stock(), stop(STOP).unwrap());
        let begin = std::time::Instant::now();
        let levels = compare(&file, &trajectory, 1e-2, &mut |_, _| ()).unwrap();
        let whole = begin.elapsed().as_secs_f64();
        let cheapest = levels.cheapest().unwrap();
        let on = |level: ModelLevel, tolerance: f64| {
            let mut file = file.clone();
            for (name, value) in [
                ("solver.fidelity", if level == ModelLevel::Lumped { 2.0 } else { 3.0 }),
                ("solver.cells", settings(level).1 as f64),
                ("solver.tolerance", tolerance),
            ] {
                file.packaged.starts[find(name).unwrap() as usize] = value;
            }
            history(&run(&file, &trajectory, &[], &mut |_| ()).unwrap(), 293.15)
        };
        // Times are those of the runs, not of a part of them that was multiplied.
        let seconds: f64 = levels.candidates.iter().map(|known| known.seconds).sum();
        assert!(seconds > 0.02 * whole && seconds < whole, "{seconds} of {whole} s: {levels:?}");
        let error = largest(Distance::of(&on(ModelLevel::Line(49), 5e-4), &on(cheapest.level, 1e-2)).relative());
        let stated = largest(cheapest.errors);
        assert!(error <= 1e-2, "{error}: {levels:?}");
        assert!(error <= 2.0 * stated && stated <= 5.0 * error.max(1e-3), "{error} {stated}: {levels:?}");
        for known in levels.candidates.iter().take_while(|known| known.level != cheapest.level) {
            assert!(largest(known.errors) > 1e-2, "{known:?}");
        }
    }

    /// Two rows of a stop say what its 41 rows say: what happens between them counts, and every level has an error.
    #[test]
    fn sparse_rows_are_divided_and_every_level_has_an_error() {
        let header = "time [s],sliding_velocity [m/s],normal_load [N]";
        let dense: String =
            (0..=40).map(|k| format!("{},{},3000\n", 0.1 * f64::from(k), 5.0 - 0.125 * f64::from(k))).collect();
        let [sparse, dense] = [format!("{header}\n0,5,3000\n4,0,3000\n"), format!("{header}\n{dense}")].map(|text| {
            let levels = compare(&stock(), &stop(&text).unwrap(), 0.1, &mut |_, _| ()).unwrap();
            levels.candidates.iter().map(|known| known.errors).collect::<Vec<_>>()
        });
        assert!(sparse.len() >= 3 && sparse.as_flattened().iter().all(|error| error.is_finite()), "{sparse:?}");
        for (one, other) in sparse.as_flattened().iter().zip(dense.as_flattened()) {
            assert!((one - other).abs() < 0.2 * other + 1e-3, "{sparse:?} {dense:?}");
        }
    }

    #[test]
    fn where_no_level_meets_the_tolerance_the_smallest_error_is_named() {
        let known = |level, error| Candidate { level, errors: [error; 3], steps: 1, seconds: 1.0 };
        let candidates = vec![known(ModelLevel::Lumped, 0.2), known(ModelLevel::Line(9), 3e-3)];
        let mut levels =
            Levels { tolerance: 1e-2, candidates, failed: Vec::new(), resolution: 1e-3, interrupted: false };
        assert_eq!(levels.cheapest().unwrap().level, ModelLevel::Line(9));
        levels.tolerance = 1e-3;
        let told = levels.cheapest().unwrap_err().to_string();
        assert!(told.contains("the smallest error is 3.0e-3, with line, 9 cells"), "{told}");
    }

    #[test]
    fn what_is_wrong_with_a_drive_is_told() {
        for (text, wanted) in [
            ("time [s],sliding_velocity\n0,1\n1,1\n", "does not say its unit"),
            ("time [s],normal_load [N]\n0,1\n1,1\n", "neither a column sliding_velocity"),
            ("time [s],sliding_velocity [m/s]\n0,1\n1,fast\n", "line 3, column 2"),
        ] {
            let told = stop(text).and_then(|trajectory| compare(&stock(), &trajectory, 1e-2, &mut |_, _| ()));
            let told = format!("{:#}", told.unwrap_err());
            assert!(told.contains(wanted), "{told}\nis without {wanted}");
        }
    }

    #[test]
    fn a_tolerance_that_no_run_can_have_is_refused() {
        for tolerance in [0.0, -1.0, 7.0, f64::NAN] {
            let told = super::tolerance(&stock(), Some(tolerance)).unwrap_err().to_string();
            assert!(told.contains("at most 0.5"), "{told}");
        }
    }
}
