//! `cargo fmu plan SCENE --inputs drive.csv`: error and cost of every level on given inputs.
//!
//! Errors are differences to the finest run, whose tolerance is a tenth, plus that run's own error: differences between
//! refinements are extrapolated as a geometric series with the ratio of the last two. Levels are refined until that error is well
//! below the tolerance. If it does not fall below it, no level is named, because the error is unknown.

use anyhow::{Context, Result, bail};
use scene::variables::{COUNT, find};
use scene_file::SceneFile;
use scene_file::columns::Table;
use serde_json::{Value, json};
use verification::applications::Application;
use verification::applications::trial::{Run, errors, remaining, run};
pub use verification::applications::trial::{Setting, largest};

/// Levels from the coarsest to the finest, the last ones only where they are needed.
pub const LEVELS: [Setting; 7] = [
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

/// Wider tolerances that are tried where none is met.
const WIDER: usize = 3;

/// Largest tolerance of a run.
const MOST: f64 = 0.5;

/// A level on the inputs.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub setting: Setting,
    /// Estimated errors of the main outputs.
    pub errors: [f64; 3],
    pub steps: u64,
    /// Cost by count, microseconds.
    pub work: f64,
    /// Processor time of the communication steps, s.
    pub seconds: f64,
}

/// All levels that were run.
#[derive(Debug)]
pub struct Levels {
    pub tolerance: f64,
    pub candidates: Vec<Candidate>,
    /// Levels that could not be run.
    pub failed: Vec<String>,
    pub finest: Setting,
    /// Error of the finest run itself.
    pub finest_error: f64,
}

impl Levels {
    /// Whether the finest run is good enough to tell the errors of the others.
    pub fn are_known(&self) -> bool {
        self.finest_error <= ENOUGH[1] * self.tolerance
    }

    /// A wider tolerance at which a level is known to be good, with the levels at it. Errors at it are found by runs at it: what the runs at
    /// hand reach need not be reached with longer steps.
    pub fn wider(&self, drive: &Application, started: &mut dyn FnMut(usize, Setting)) -> Option<Self> {
        let mut levels = None::<Self>;
        for _ in 0..WIDER {
            let tried = levels.as_ref().unwrap_or(self);
            let least = (tried.finest_error / ENOUGH[1]).max(2.0 * tried.tolerance);
            let tolerance = round_up(least).filter(|tolerance| *tolerance <= MOST)?;
            let wider = compare(drive, tolerance, started).ok()?;
            if wider.cheapest().is_some() {
                return Some(wider);
            }
            levels = Some(wider);
        }
        None
    }

    /// The cheapest that meets the tolerance.
    pub fn cheapest(&self) -> Option<&Candidate> {
        let good = self.candidates.iter().filter(|known| self.are_known() && largest(known.errors) <= self.tolerance);
        good.min_by(|one, other| one.work.total_cmp(&other.work))
    }

    /// The cheapest level that meets the tolerance.
    ///
    /// # Errors
    /// Where no run converges or none meets it, with the level and the tolerance of [`Self::wider`].
    pub fn chosen(&self, drive: &Application, started: &mut dyn FnMut(usize, Setting)) -> Result<&Candidate> {
        if let Some(cheapest) = self.cheapest() {
            return Ok(cheapest);
        }
        let wider = self.wider(drive, started);
        let instead = wider.as_ref().and_then(|wider| Some((wider.tolerance, wider.cheapest()?)));
        let instead = instead.map_or(String::new(), |(tolerance, known)| {
            let error = largest(known.errors);
            format!(
                ". With the tolerance {tolerance:e} it is {}, with an estimated error of {error:.1e}",
                known.setting
            )
        });
        if self.are_known() {
            bail!(
                "no level meets the tolerance {:e}; the finest that was run is {}{instead}",
                self.tolerance,
                self.finest
            );
        }
        bail!(
            "no level is known to be good: the finest run, {}, has an error of {:.1e} itself, above a third of the tolerance {:e}; \
             estimated error: 1{instead}",
            self.finest,
            self.finest_error,
            self.tolerance,
        )
    }
}

/// The next number of one significant digit; `None` where there is none.
fn round_up(number: f64) -> Option<f64> {
    let power = number.log10().floor();
    let digit = (number / 10.0_f64.powf(power) * (1.0 - 1e-12)).ceil();
    format!("{digit}e{power}").parse().ok().filter(|rounded: &f64| rounded.is_finite())
}

/// Value of `solver.fidelity`, and of `solver.cells` on a line.
pub fn level(setting: Setting) -> (&'static str, Option<usize>) {
    match setting {
        Setting::Auto => ("auto", None),
        Setting::Lumped => ("lumped", None),
        Setting::Line(cells) => ("line", Some(cells)),
    }
}

/// Tolerance of the comparison: the given one, the scene's own, that of its default experiment.
///
/// # Errors
/// Where it is none that a run can have.
pub fn tolerance(file: &SceneFile, given: Option<f64>) -> Result<f64> {
    let packaged = &file.packaged;
    let own = find("solver.tolerance").map_or(0.0, |reference| packaged.starts[reference as usize]);
    let tolerance = given.unwrap_or(if own > 0.0 { own } else { packaged.experiment.tolerance });
    if !(tolerance > 0.0 && tolerance <= MOST) {
        bail!("the tolerance is {tolerance}, but must be above 0 and at most {MOST}");
    }
    Ok(tolerance)
}

/// The scene with the inputs of a table; what it does not have keeps its start value.
///
/// # Errors
/// A single row, no velocity.
pub fn drive(name: &str, starts: &[f64; COUNT], table: &Table) -> Result<Application> {
    let path = &table.path;
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
pub fn compare(drive: &Application, tolerance: f64, started: &mut dyn FnMut(usize, Setting)) -> Result<Levels> {
    let (mut runs, mut failed): (Vec<(Setting, Run)>, Vec<String>) = (Vec::new(), Vec::new());
    // Runs with finer steps: the two before the last, and the error of the last.
    let mut fine: Vec<(Setting, Vec<[f64; 3]>)> = Vec::new();
    let (mut apart, mut own) = (None, [1.0; 3]);
    for (number, setting) in LEVELS.into_iter().enumerate() {
        started(number, setting);
        let both = run(drive, setting, tolerance)
            .and_then(|coarse| Ok((coarse, run(drive, setting, (FINER_STEPS * tolerance).max(1e-8))?)));
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

/// All levels as JSON.
pub fn record(levels: &Levels) -> Value {
    let candidates = levels.candidates.iter().map(|known| {
        let (fidelity, cells) = level(known.setting);
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
        let (fidelity, cells) = level(known.setting);
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
    use scene_file::columns::{self, Column};
    use std::path::Path;

    fn driven(text: &str, starts: &[f64; COUNT]) -> Result<Application> {
        drive("stock", starts, &columns::parse(text.as_bytes(), Path::new("drive.csv"), &Column::inputs())?)
    }

    fn stock() -> SceneFile {
        scene_file::shipped::load(None, Path::new("")).unwrap()
    }

    const STOP: &str = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,18,2\n0.5,18,2\n1,9,2\n2,0,2\n";

    #[test]
    fn columns_become_inputs_in_si_units_and_others_keep_their_start() {
        let packaged = stock().packaged;
        let text =
            "normal_load [kN],time [s],ambient_temperature_offset [K],sliding_velocity_km_per_h\n3,0,5,36\n4,2,6,72\n";
        let drive = driven(text, &packaged.starts).unwrap();
        assert_eq!(drive.course, [[0.0, 10.0, 3e3], [2.0, 20.0, 4e3]]);
        assert_eq!(drive.others, [(find("ambient_temperature_offset").unwrap(), vec![5.0, 6.0])]);
        let text = "time [s],angular_velocity [rad/s]\n0,1\n1,2\n";
        let drive = driven(text, &packaged.starts).unwrap();
        assert_eq!(drive.course, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    }

    #[test]
    fn what_is_wrong_with_a_drive_is_told() {
        let packaged = stock().packaged;
        for (text, wanted) in [
            ("time [s],sliding_velocity\n0,1\n1,1\n", "does not say its unit"),
            ("time [s],sliding_velocity [m/s]\n0,1\n", "at least two"),
            ("time [s],normal_load [N]\n0,1\n1,1\n", "neither a column sliding_velocity"),
            ("time [s],sliding_velocity [m/s]\n0,1\n1,fast\n", "line 3, column 2"),
        ] {
            let told = format!("{:#}", driven(text, &packaged.starts).unwrap_err());
            assert!(told.contains(wanted), "{told}\nis without {wanted}");
        }
    }

    /// The cheapest level's stated error agrees with its distance from an independent finer run.
    #[test]
    fn the_cheapest_level_on_a_short_stop_meets_the_tolerance() {
        let packaged = stock().packaged;
        let drive = driven(STOP, &packaged.starts).unwrap();
        let levels = compare(&drive, 1e-2, &mut |_, _| ()).unwrap();
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

    /// A tolerance proposed in place of one that is not met is met.
    #[test]
    fn a_wider_tolerance_that_is_proposed_is_one_that_is_met() {
        let packaged = stock().packaged;
        let drive = driven(STOP, &packaged.starts).unwrap();
        let mut levels = compare(&drive, 1e-2, &mut |_, _| ()).unwrap();
        // As where nothing is known.
        (levels.tolerance, levels.finest_error) = (1e-4, 1e-3);
        let wider = levels.wider(&drive, &mut |_, _| ()).unwrap();
        assert_eq!(wider.tolerance, 3e-3);
        let again = compare(&drive, wider.tolerance, &mut |_, _| ()).unwrap();
        assert_eq!(again.cheapest().unwrap().setting, wider.cheapest().unwrap().setting);
        let told = levels.chosen(&drive, &mut |_, _| ()).unwrap_err().to_string();
        assert!(
            told.contains(&format!("With the tolerance 3e-3 it is {}", wider.cheapest().unwrap().setting)),
            "{told}"
        );
        levels.finest_error = 0.4;
        assert!(!levels.chosen(&drive, &mut |_, _| ()).unwrap_err().to_string().contains("With the tolerance"));
    }

    #[test]
    fn tolerances_have_one_digit() {
        for (number, rounded) in [(8.3e-3, 9e-3), (9e-3, 9e-3), (9.1e-3, 1e-2), (0.31, 0.4), (1e-10, 1e-10)] {
            assert_eq!(round_up(number), Some(rounded));
        }
        assert_eq!((round_up(0.0), round_up(f64::NAN), round_up(f64::INFINITY)), (None, None, None));
    }

    #[test]
    fn a_tolerance_that_no_run_can_have_is_refused() {
        for tolerance in [0.0, -1.0, 7.0, f64::NAN] {
            let told = super::tolerance(&stock(), Some(tolerance)).unwrap_err().to_string();
            assert!(told.contains("at most 0.5"), "{told}");
        }
    }
}
