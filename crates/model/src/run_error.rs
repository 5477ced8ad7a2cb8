//! Error of a run, measured on the run itself: a companion, a contact line on half of the cells at twice the tolerance and with bodies
//! reduced to a tenth of it, is advanced on the same inputs.
//!
//! With d the largest relative difference of the main outputs so far ([`crate::plan::distance`]) and s the error of reduction and time
//! steps the error is
//!
//! ```text
//! e = sqrt(d^2 + (s/3)^2)        with a companion: d contains s where no other error cancels it
//! e = sqrt(e_c^2 + s^2)          lumped, chosen by a comparison with the error e_c, within its conditions
//! e = 1                          otherwise: not known
//! ```
//!
//! each with the part of a nominal stroke that elastic slip takes, where it is neglected
//! ([`crate::levels::ModelOperators::neglected_slip`]), as a third term under the root.
//!
//! d is the error of the companion less that of the run. It is the error of the run at first order in the cells, or where the tolerance
//! or the reduction rules; at second order it is three times as much.
//!
//! Theory: docs/theory.md, section 8.3.

use crate::levels::{Model, ModelOperators, ModelState};
use crate::lumped::conditions::Tunables;
use crate::plan::comparison::Comparison;
use crate::plan::distance::{Distance, largest, main_outputs};
use crate::plan::{BuiltModel, ModelLevel, UNKNOWN};
use crate::{Inputs, StepFailure};
use scene::message::Number;
use scene::variables::COUNT;
use std::fmt;

/// Most cells that are advised.
const MOST_CELLS: usize = 129;

/// A coarser contact line on the inputs of the run.
#[derive(Clone, Debug)]
struct Companion {
    model: Model,
    ambient: f64,
    /// `None` once the companion had no solution.
    distance: Option<Distance>,
    values: Box<[f64; COUNT]>,
}

/// Error of a run so far.
#[derive(Clone, Debug)]
pub struct RunError {
    companion: Option<Box<Companion>>,
    /// The run exceeds the conditions of the comparison.
    is_beyond: bool,
}

/// Saved [`RunError`].
#[derive(Clone, PartialEq, Default, Debug)]
pub struct SavedRunError {
    /// The run exceeds the conditions of the comparison.
    pub is_beyond: bool,
    /// Distance of the companion; `None` where it had no solution, or there is none.
    pub distance: Option<Distance>,
    /// State of the companion.
    pub companion: Option<ModelState>,
}

/// A change of what is known of the error, for the log.
#[derive(Debug)]
pub enum Notice<'a> {
    /// The run exceeds the conditions of the comparison.
    Beyond {
        /// The scene with the nominal conditions and their comparison.
        prepared: &'a BuiltModel,
        /// Speed, m/s.
        speed: f64,
        /// Load, N.
        load: f64,
        /// Friction work, J.
        work: f64,
    },
    /// The companion has no solution.
    Lost {
        /// Its cells.
        cells: usize,
        /// Reason.
        failure: StepFailure,
    },
}

impl RunError {
    /// Before the first step at these inputs.
    pub fn new(prepared: &BuiltModel, tunables: Tunables, inputs: &Inputs) -> RunError {
        let companion = prepared.companion.as_ref().map(|operators| {
            Box::new(Companion {
                model: Model::new(operators, tunables, inputs),
                ambient: tunables.ambient_temperature,
                distance: Some(Distance::default()),
                values: Box::new([0.0; COUNT]),
            })
        });
        RunError { companion, is_beyond: false }
    }

    /// Sets the parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        if let Some(companion) = &mut self.companion {
            companion.model.set_tunables(tunables);
            companion.ambient = tunables.ambient_temperature;
        }
    }

    /// Follows a step (s) that `model` has made from `inputs` with the rates `slopes`.
    pub fn follow<'a>(
        &mut self,
        prepared: &'a BuiltModel,
        model: &Model,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        step: f64,
    ) -> Option<Notice<'a>> {
        if let Some(companion) = &mut self.companion {
            let distance = companion.distance.as_mut()?;
            if let Err(failure) = companion.model.step(inputs, slopes, step) {
                companion.distance = None;
                return Some(Notice::Lost { cells: companion.model.operators().cells(), failure });
            }
            model.write_end(&mut companion.values);
            let own = main_outputs(&companion.values, companion.ambient);
            companion.model.write_end(&mut companion.values);
            distance.follow(own, main_outputs(&companion.values, companion.ambient));
            return None;
        }
        let comparison = self.comparison(prepared)?;
        let scene = &prepared.requested;
        // Inputs are linear within a step: the largest are at one of its ends.
        let most = |of: &dyn Fn(&Inputs) -> f64| of(inputs).max(of(&inputs.after(slopes, step)));
        let speed = most(&|inputs| inputs.velocity(scene.mean_radius).abs());
        let (load, work) = (most(&|inputs| inputs.normal_load), model.friction_work());
        // Admissible excess of the nominal conditions by rounding.
        let within = |value: f64, nominal: f64| value <= nominal * (1.0 + 1e-6);
        self.is_beyond =
            !(within(speed, comparison.fastest) && within(load, scene.nominal_load) && within(work, comparison.work));
        self.is_beyond.then_some(Notice::Beyond { prepared, speed, load, work })
    }

    /// Relative error of wear depth, temperature rise and friction force so far, where it is known; `step_error` is that of
    /// reduction and time steps.
    fn known(&self, prepared: &BuiltModel, step_error: f64) -> Option<f64> {
        let neglected = prepared.operators.neglected_slip().map_or(0.0, |(share, _)| share);
        self.resolved(prepared, step_error).map(|error| error.hypot(neglected))
    }

    /// The same without elastic slip.
    fn resolved(&self, prepared: &BuiltModel, step_error: f64) -> Option<f64> {
        if prepared.is_exact() {
            return Some(step_error);
        }
        if let Some(companion) = &self.companion {
            // Part of the error of reduction and time steps, which that of the cells may cancel in the difference.
            return companion.distance.map(|distance| largest(distance.relative()).hypot((1.0 / 3.0) * step_error));
        }
        self.comparison(prepared).map(|comparison| comparison.error.hypot(step_error))
    }

    /// The comparison by which the run is lumped, as long as it holds.
    fn comparison<'a>(&self, prepared: &'a BuiltModel) -> Option<&'a Comparison> {
        let choice = prepared.choice.as_ref().filter(|choice| choice.level == ModelLevel::Lumped && !self.is_beyond)?;
        choice.comparison.as_ref()
    }

    /// The same, at most [`UNKNOWN`], which also stands for an error that is not known.
    pub fn of(&self, prepared: &BuiltModel, step_error: f64) -> f64 {
        self.known(prepared, step_error).map_or(UNKNOWN, |error| error.min(UNKNOWN))
    }

    /// Writes advice where the error of the run is known and above the tolerance; without advice from [`UNKNOWN`] on.
    pub fn write_advice(&self, prepared: &BuiltModel, step_error: f64, text: &mut String) -> fmt::Result {
        use fmt::Write as _;
        let tolerance = prepared.requested.tolerance;
        let Some(error) = self.known(prepared, step_error).filter(|error| *error > tolerance) else { return Ok(()) };
        let cells = prepared.operators.cells();
        let stated = error.min(UNKNOWN);
        write!(text, "estimated_error = {} is above the tolerance {}", Number(stated), Number(tolerance))?;
        if error >= UNKNOWN {
            return write!(text, ": not known");
        }
        if self.resolved(prepared, step_error).is_some_and(|resolved| resolved <= tolerance) {
            return write!(text, " by the elastic slip: contact.tangential_compliance = elastic includes it");
        }
        match prepared.operators {
            _ if prepared.is_exact() => write!(text, " by reduction and time steps alone"),
            ModelOperators::Lumped(_) => write!(text, ": solver.fidelity = line resolves more than lumped"),
            // First order in the cells.
            ModelOperators::Line(_) if cells < MOST_CELLS => {
                let doublings = (error / tolerance).log2().ceil().clamp(1.0, 8.0) as u32;
                let advised = (((cells - 1) << doublings) + 1).min(MOST_CELLS);
                write!(text, ": take solver.cells = {advised} instead of {cells}, or a smaller solver.tolerance")
            }
            ModelOperators::Line(_) => write!(text, " on {cells} cells"),
        }
    }

    /// Copy for a saved state.
    pub fn save(&self) -> SavedRunError {
        SavedRunError {
            is_beyond: self.is_beyond,
            distance: self.companion.as_ref().and_then(|companion| companion.distance),
            companion: self.companion.as_ref().map(|companion| companion.model.save()),
        }
    }

    /// State of the companion in a saved state, if it has one ([`ModelState::of`]); the outer `None`: it belongs to no run of `prepared`.
    pub fn companion<'a>(
        saved: &'a SavedRunError,
        prepared: &BuiltModel,
        place: &'a mut Option<ModelState>,
    ) -> Option<Option<&'a ModelState>> {
        match (&saved.companion, &prepared.companion) {
            (None, None) => saved.distance.is_none().then_some(None),
            (Some(state), Some(operators)) => state.of(operators, place).map(Some),
            _ => None,
        }
    }

    /// Replaces the state by a saved one with its [`RunError::companion`].
    pub fn set(&mut self, saved: &SavedRunError, companion_state: Option<&ModelState>) {
        self.is_beyond = saved.is_beyond;
        if let (Some(companion), Some(state)) = (&mut self.companion, companion_state) {
            companion.model.set_state(state);
            companion.distance = saved.distance;
        }
    }
}

impl fmt::Display for Notice<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Beyond { prepared, speed, load, work } => {
                let scene = &prepared.requested;
                let comparison = prepared.choice.as_ref().and_then(|choice| choice.comparison.as_ref());
                let (fastest, most) = comparison.map_or((0.0, 0.0), |comparison| (comparison.fastest, comparison.work));
                write!(
                    f,
                    "the run exceeds the nominal conditions for which solver.fidelity = auto took lumped: {} m/s, {} N and {} J of \
                     friction, compared up to {} m/s, nominal.load = {} N and {} J in nominal.duration = {} s; the level stays, \
                     and estimated_error is 1 from here on (solver.error_estimate = companion measures it)",
                    Number(*speed),
                    Number(*load),
                    Number(*work),
                    Number(fastest),
                    Number(scene.nominal_load),
                    Number(most),
                    Number(scene.nominal_duration),
                )
            }
            Notice::Lost { cells, failure } => {
                write!(
                    f,
                    "estimated_error is 1 from here on: its companion on {cells} cells has no solution: {failure}"
                )
            }
        }
    }
}
