//! `cargo fmu plan --campaign`: `solver.fidelity = auto` on scenes as users build them, driven as an importer does, compared with
//! every fixed setting and with a far finer reference run.
//!
//! Every third scene is held out: it is run with `--hold-out` only, so that nothing is tuned on it.

mod cache;
mod report;

use crate::output::print_line;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, anyhow, bail};
use indicatif::{ProgressBar, ProgressStyle};
use verification::applications::trial::{self, Setting, errors_so_far, largest};
use verification::applications::{self, Application};

use cache::{Fixed, Reference};

/// Tolerances of the campaign.
pub const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// Settings that a user can fix.
pub const FIXED: [Setting; 6] =
    [Setting::Lumped, Setting::Line(5), Setting::Line(9), Setting::Line(17), Setting::Line(33), Setting::Line(65)];

/// Period of the held-out scenes.
const HELD_OUT: usize = 3;

/// Largest error of the reference, as a fraction of the tolerance, at which runs are compared with it.
const TRUTH_SHARE: f64 = 1.0 / 3.0;

/// Selection of scenes and outputs of a campaign.
#[derive(Clone, Debug)]
pub struct Request {
    /// Variants of the shipped scenes instead of the applications.
    pub variants: bool,
    /// Number of the first scene.
    pub first: usize,
    /// Number of scenes from there on.
    pub scenes: usize,
    /// Only scenes whose name contains this.
    pub only: Option<String>,
    /// Only those that are held out, instead of only the others.
    pub hold_out: bool,
    /// Runs the fixed settings again.
    pub fresh: bool,
    /// Prints JSON.
    pub json: bool,
    /// File for the table.
    pub output: Option<PathBuf>,
}

/// A scene at a tolerance.
pub struct Trial {
    pub tolerance: f64,
    /// Outputs for which the reference is accurate enough.
    pub judged: [bool; 3],
    /// The automatic run, or why it failed.
    pub auto: Result<Outcome, String>,
    /// Fixed settings at this tolerance.
    pub fixed: Vec<Fixed>,
}

/// Outcome of an automatic run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub level: String,
    /// Errors of the three main outputs.
    pub errors: [f64; 3],
    /// `estimated_error` at the end.
    pub estimated: f64,
    /// Least of `estimated_error` over the error so far, where that is above a tenth of the tolerance; 1 where it nowhere is.
    pub lowest_on_the_way: f64,
    pub steps: u64,
    pub work: f64,
    /// Processor time of the steps, and of planning: initialisation without building the level that it chose, s.
    pub seconds: f64,
    pub planning: f64,
}

/// A scene with its trials.
pub struct Tried {
    pub index: usize,
    pub name: String,
    /// Largest speed over the critical one of thermoelastic instability; 0 where there is none.
    pub speed_ratio: f64,
    /// Cells of the reference, and its own errors.
    pub cells: usize,
    pub truth_errors: [f64; 3],
    pub trials: Vec<Trial>,
}

impl Trial {
    /// Whether the reference is accurate enough for all outputs.
    pub fn is_judged(&self) -> bool {
        self.judged == [true; 3]
    }

    /// Cheapest fixed setting that meets the tolerance.
    pub fn cheapest(&self) -> Option<&Fixed> {
        let good = self.fixed.iter().filter(|fixed| largest(fixed.errors) <= self.tolerance);
        good.min_by(|one, other| one.work.total_cmp(&other.work))
    }
}

impl Tried {
    /// Whether the reference itself converges: to a third of the coarsest tolerance.
    pub fn converges(&self) -> bool {
        largest(self.truth_errors) <= TRUTH_SHARE * TOLERANCES[0]
    }
}

/// Runs the campaign.
///
/// # Errors
/// Where no scene is selected or a file cannot be written.
pub fn execute(request: &Request) -> Result<()> {
    let all = if request.variants { applications::variants::all() } else { applications::all() };
    let all = all.map_err(|text| anyhow!(text))?;
    let selected: Vec<(usize, Application)> = all
        .into_iter()
        .enumerate()
        .skip(request.first)
        .take(request.scenes)
        .filter(|(index, _)| (index % HELD_OUT == HELD_OUT - 1) == request.hold_out)
        .filter(|(_, scene)| request.only.as_ref().is_none_or(|part| scene.name.contains(part.as_str())))
        .collect();
    if selected.is_empty() {
        let (first, scenes) = (request.first, request.scenes);
        let only = request.only.as_ref().map_or(String::new(), |part| format!(" and --only {part}"));
        bail!(
            "no scene is selected by --first {first}, --scenes {scenes}{only}; {HELD_OUT} in a row hold one that is held out"
        );
    }
    let bar = ProgressBar::new(selected.len() as u64)
        .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}")?);
    let (mut tried, mut left_out) = (Vec::new(), Vec::new());
    for (index, scene) in selected {
        bar.set_message(scene.name.clone());
        match try_scene(index, &scene, request.fresh) {
            Ok(one) => {
                if !request.json {
                    bar.suspend(|| report::lines(&one).iter().for_each(|line| print_line!("{line}")));
                }
                tried.push(one);
            }
            Err(text) => left_out.push(format!("{}: {text}", scene.name)),
        }
        // A long campaign shows what it has.
        if let Some(path) = &request.output {
            fs::write(path, report::table(&tried, &left_out)).with_context(|| format!("writing {}", path.display()))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let summary = report::summary(&tried);
    if request.json {
        print_line!("{:#}", report::record(&tried, &left_out, &summary));
    } else {
        left_out.iter().for_each(|reason| print_line!("left out: {reason}"));
        summary.iter().for_each(|line| print_line!("{line}"));
    }
    Ok(())
}

fn try_scene(index: usize, scene: &Application, fresh: bool) -> Result<Tried, String> {
    let mut reference = cache::reference(scene)?;
    reference.run_fixed(scene, fresh);
    let Reference { truth, cells, errors: truth_errors, fixed, .. } = &reference;
    let trials = TOLERANCES.map(|tolerance| {
        let auto = trial::run(scene, Setting::Auto, tolerance).map(|run| {
            let so_far = errors_so_far(&run.main, truth);
            let errors = so_far.last().copied().unwrap_or_default();
            let ratios = so_far.iter().zip(&run.estimated).filter_map(|(errors, estimated)| {
                let error = largest(*errors);
                (error > 0.1 * tolerance).then(|| estimated / error)
            });
            Outcome {
                level: run.level,
                errors,
                estimated: run.estimated.last().copied().unwrap_or(0.0),
                lowest_on_the_way: ratios.fold(1.0, f64::min),
                steps: run.steps,
                work: run.work,
                seconds: run.seconds[1],
                planning: (run.seconds[0] - run.building).max(0.0),
            }
        });
        Trial {
            tolerance,
            judged: truth_errors.map(|error| error <= TRUTH_SHARE * tolerance),
            auto,
            fixed: fixed.iter().filter(|fixed| fixed.tolerance == tolerance).cloned().collect(),
        }
    });
    let speed_ratio = trial::speed_ratio(scene)?;
    Ok(Tried {
        index,
        name: scene.name.clone(),
        speed_ratio,
        cells: *cells,
        truth_errors: *truth_errors,
        trials: trials.into(),
    })
}
