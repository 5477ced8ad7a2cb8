//! Cache of reference solutions and runs at fixed settings in cargo's target folder; they do not depend on plans.
//!
//! Files are named after a hash of the scene's values and its input trajectory. Two cheap runs, repeated each time, detect
//! changes of the code: where they differ by more than the admissible error of the reference, the reference is recomputed; where
//! their work differs, the fixed settings are.

use std::fs;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use verification::applications::Application;
use verification::applications::trial::{Run, Setting, errors, fine_run, largest, remaining, run};

use super::{FIXED, TOLERANCES};
use crate::project;

/// Version of the file format.
const VERSION: u32 = 3;

/// Cells and tolerances of the refinement runs: the last is the reference, the ones before give its error.
const TRUTHS: [(usize, f64); 4] = [(33, 4e-4), (65, 2e-4), (129, 1e-4), (257, 1e-4)];

/// Processor time of a run beyond which no finer one is made, s.
const DEAR: f64 = 5.0;

/// Largest admissible error of a reference: a third of the smallest tolerance.
const ENOUGH: f64 = 3e-4;

/// The cheap runs that detect changes of the code.
const WITNESSES: [(Setting, f64); 2] = [(Setting::Lumped, 1e-4), (Setting::Line(9), 1e-3)];

/// Largest change of a cheap run for which a cached reference stays valid.
const SAME: f64 = 1e-4;

/// A run at a fixed setting.
#[derive(Clone, Serialize, Deserialize, Debug)]
pub struct Fixed {
    pub setting: String,
    pub tolerance: f64,
    pub errors: [f64; 3],
    /// `estimated_error` at the end.
    pub estimated: f64,
    pub steps: u64,
    pub work: f64,
    /// Processor time of the steps, s.
    pub seconds: f64,
}

#[derive(Clone, PartialEq, Serialize, Deserialize, Debug)]
struct Witness {
    main: Vec<[f64; 3]>,
    steps: u64,
    work: f64,
}

/// Reference solution of a scene and its runs at fixed settings.
#[derive(Clone, Serialize, Deserialize, Debug)]
pub struct Reference {
    version: u32,
    /// Main outputs of the reference at the communication points.
    pub truth: Vec<[f64; 3]>,
    /// Its cells.
    pub cells: usize,
    /// Its own errors, extrapolated from the differences between the runs with their ratio.
    pub errors: [f64; 3],
    /// Its processor time, s.
    pub seconds: f64,
    witnesses: Vec<Witness>,
    /// Runs at fixed settings; none where they have to be made.
    pub fixed: Vec<Fixed>,
}

/// FNV-1a over the definition of a scene.
fn key(scene: &Application) -> u64 {
    let numbers = scene.starts.iter().chain(scene.course.iter().flatten());
    ::scene::fnv::Fnv::of(numbers.flat_map(|number| number.to_le_bytes())).0
}

fn path(scene: &Application) -> PathBuf {
    project::target().join("campaign").join(format!("{}-{:016x}.json", scene.name, key(scene)))
}

fn witnesses(scene: &Application) -> Vec<Witness> {
    let of = |(setting, tolerance)| match run(scene, setting, tolerance) {
        Ok(Run { main, steps, work, .. }) => Witness { main, steps, work },
        Err(_) => Witness { main: Vec::new(), steps: 0, work: 0.0 },
    };
    WITNESSES.map(of).into()
}

/// The reference of a scene, from the cache or computed.
///
/// # Errors
/// Where fewer than two refinement runs succeed.
pub fn reference(scene: &Application) -> Result<Reference, String> {
    let now = witnesses(scene);
    let kept = fs::read(path(scene)).ok().and_then(|bytes| serde_json::from_slice::<Reference>(&bytes).ok());
    if let Some(mut kept) = kept.filter(|kept| kept.version == VERSION && kept.truth.len() == scene.course.len()) {
        let same = |(was, is): (&Witness, &Witness)| {
            was.main.len() == is.main.len() && largest(errors(&is.main, &was.main)) <= SAME
        };
        if kept.witnesses.len() == now.len() && kept.witnesses.iter().zip(&now).all(same) {
            let work =
                |(was, is): (&Witness, &Witness)| was.steps == is.steps && (was.work - is.work).abs() < 1e-9 * is.work;
            if !kept.witnesses.iter().zip(&now).all(work) {
                kept.fixed.clear();
            }
            return Ok(kept);
        }
    }
    let mut before = fine_run(scene, TRUTHS[0].0, TRUTHS[0].1)?;
    let mut last: Option<[f64; 3]> = None;
    let mut made: Option<Reference> = None;
    for (cells, tolerance) in TRUTHS.into_iter().skip(1) {
        if before.seconds[1] > DEAR {
            break;
        }
        // Where a finer run fails, the run before it is the reference.
        let Ok(run) = fine_run(scene, cells, tolerance) else { break };
        let apart = errors(&before.main, &run.main);
        let errors = remaining(last, apart);
        last = Some(apart);
        made = Some(Reference {
            version: VERSION,
            truth: run.main.clone(),
            cells,
            // JSON has no infinity.
            errors: errors.map(|error| error.min(1e9)),
            seconds: run.seconds[1],
            witnesses: now.clone(),
            fixed: Vec::new(),
        });
        if largest(errors) <= ENOUGH {
            break;
        }
        before = run;
    }
    let made = made.ok_or("no finer run to hold the coarse one against")?;
    made.keep(scene);
    Ok(made)
}

impl Reference {
    /// Runs the fixed settings if they are not cached, or if requested anew.
    /// Settings that cannot be run are omitted.
    pub fn run_fixed(&mut self, scene: &Application, fresh: bool) {
        if !fresh && !self.fixed.is_empty() {
            return;
        }
        self.fixed.clear();
        self.witnesses = witnesses(scene);
        for tolerance in TOLERANCES {
            for setting in FIXED {
                let Ok(run) = run(scene, setting, tolerance) else { continue };
                self.fixed.push(Fixed {
                    setting: setting.to_string(),
                    tolerance,
                    // JSON has no infinity.
                    errors: errors(&run.main, &self.truth).map(|error| error.min(1e9)),
                    estimated: run.estimated.last().copied().unwrap_or(0.0),
                    steps: run.steps,
                    work: run.work,
                    seconds: run.seconds[1],
                });
            }
        }
        self.keep(scene);
    }

    /// Writes the file; without it the next campaign takes longer.
    fn keep(&self, scene: &Application) {
        let path = path(scene);
        if let (Some(folder), Ok(text)) = (path.parent(), serde_json::to_vec(self)) {
            let _ = fs::create_dir_all(folder);
            let _ = fs::write(path, text);
        }
    }
}
