//! Implementation of the FMI functions on an instance.
//!
//! Every method here is one exported function with its arguments made safe; the gate has checked the
//! phase. A method either succeeds or returns a [`Problem`] and leaves the instance unchanged. Life cycle and
//! log are here; variables, steps and FMU states have files of their own.

#![forbid(unsafe_code)]

mod states;
mod steps;
mod variables;

use core::ffi::CStr;
use std::sync::{Arc, OnceLock};

use super::log::{Category, Log};
use super::policy::{Fault, Function, Phase};
use super::problem::{self, Outcome, Problem, argument};
use super::state::Clock;
use super::types::{CO_SIMULATION, CallbackFunctions, FmuType, Real, Status};
use crate::component::{Component, Subject, Values};
use crate::panics::catch;
use scene::slot;
use variables::Scratch;

/// The scene of this library with derived data shared by all instances, computed once. All of it is in place: memory that a static
/// holds on the heap is lost when an importer unloads the library.
struct LibraryScene {
    name: Text,
    guid: Text,
    starts: Values,
    tolerance: f64,
}

/// A short text in place.
struct Text {
    bytes: [u8; slot::NAME_CAPACITY],
    length: usize,
}

impl Text {
    /// The text, cut off where it is too long.
    fn new(text: &str) -> Text {
        let length = text.floor_char_boundary(slot::NAME_CAPACITY);
        let mut bytes = [0; slot::NAME_CAPACITY];
        bytes[..length].copy_from_slice(&text.as_bytes()[..length]);
        Text { bytes, length }
    }

    fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes[..self.length]).unwrap_or_default()
    }
}

impl LibraryScene {
    fn component(&self) -> Component {
        Component::new(Arc::new(self.starts)).declaring(self.tolerance)
    }
}

fn scene() -> Result<&'static LibraryScene, &'static str> {
    static SCENE: OnceLock<Result<LibraryScene, String>> = OnceLock::new();
    let scene = SCENE.get_or_init(|| {
        let packaged = slot::current()?;
        Ok(LibraryScene {
            name: Text::new(&packaged.name),
            guid: Text::new(&packaged.guid()),
            starts: packaged.starts,
            tolerance: packaged.experiment.tolerance,
        })
    });
    scene.as_ref().map_err(String::as_str)
}

/// One instance of the FMU.
pub(crate) struct Instance {
    phase: Phase,
    clock: Clock,
    component: Component,
    /// Set after a panic, which may have left the component inconsistent: it is replaced before any further use.
    broken: bool,
    scene: &'static LibraryScene,
    log: Log,
    scratch: Scratch,
}

impl Instance {
    /// `fmi2Instantiate`: `None` after a message that says why.
    pub(crate) fn instantiate(
        callbacks: &CallbackFunctions,
        name: Option<&CStr>,
        kind: FmuType,
        guid: Option<&CStr>,
        debug: bool,
    ) -> Option<Box<Instance>> {
        let log = Log::new(callbacks, name.unwrap_or(c"").to_owned(), debug);
        let refuse = |reason: &str| {
            log.send(Status::Error, Category::Errors, &format!("fmi2Instantiate: {reason}"));
            None
        };
        if name.is_none_or(CStr::is_empty) {
            return refuse("the instance name is missing");
        }
        if kind != CO_SIMULATION {
            return refuse(&format!("this FMU is for co-simulation (fmuType 1); fmuType {kind} was requested"));
        }
        let scene = match scene() {
            Ok(scene) => scene,
            Err(reason) => return refuse(reason),
        };
        if guid.is_none_or(|guid| guid.to_bytes() != scene.guid.as_str().as_bytes()) {
            let given = guid.map_or("none".into(), CStr::to_string_lossy);
            return refuse(&format!("the GUID of this FMU is {}, {given} was given", scene.guid.as_str()));
        }
        if log.wants(Category::Events) {
            log.send(Status::Ok, Category::Events, &format!("fmi2Instantiate: scene {}", scene.name.as_str()));
        }
        Some(Box::new(Instance {
            phase: Phase::Instantiated,
            clock: Clock::default(),
            component: scene.component(),
            broken: false,
            scene,
            log,
            scratch: Scratch::default(),
        }))
    }

    /// The phase that the call sequences are checked against.
    #[inline(always)]
    pub(crate) fn phase(&self) -> Phase {
        self.phase
    }

    /// The problem of a call that is not allowed in the present phase.
    #[cold]
    pub(crate) fn out_of_order(&self, function: Function) -> Outcome {
        let text = format!(
            "not allowed in the phase {}; allowed in: {}",
            problem::phase_name(self.phase),
            function.rule().allowed.names()
        );
        Err(Problem { fault: Fault::Order, text })
    }

    /// Ends a call: passes the component's messages and the problem on to the log, moves to the error
    /// phase if the problem demands it, and gives the status.
    #[inline(always)]
    pub(crate) fn conclude(&mut self, function: Function, outcome: Outcome) -> Status {
        match outcome {
            Ok(()) => {
                self.pass_on_messages();
                Status::Ok
            }
            Err(problem) => self.conclude_problem(function, problem),
        }
    }

    #[inline(always)]
    fn pass_on_messages(&mut self) {
        for message in self.component.messages() {
            let (status, category) = match message.subject {
                Subject::Plan => (Status::Ok, Category::Events),
                Subject::Warning => (Status::Warning, Category::Warnings),
                Subject::Error => (Status::Error, Category::Errors),
            };
            self.log.send(status, category, &message.text);
        }
    }

    #[cold]
    fn conclude_problem(&mut self, function: Function, problem: Problem) -> Status {
        let status = problem.fault.status();
        if problem.fault.fails_instance() {
            self.phase = Phase::Error;
        }
        if problem.fault == Fault::Panic {
            self.broken = true;
        }
        if !self.broken {
            self.pass_on_messages();
        }
        self.log.send(status, Category::Errors, &format!("{}: {}", function.rule().name, problem.text));
        status
    }

    /// `fmi2SetDebugLogging`. `categories`: `None` for all; unknown ones are already left out.
    pub(crate) fn set_debug_logging(&mut self, on: bool, categories: Option<&[Category]>) -> Outcome {
        self.log.enable(on, categories.unwrap_or(&Category::ALL));
        Ok(())
    }

    /// `fmi2SetupExperiment`
    pub(crate) fn setup_experiment(&mut self, tolerance: Option<Real>, start: Real, stop: Option<Real>) -> Outcome {
        if let Some(tolerance) = tolerance
            && !(tolerance > 0.0 && tolerance.is_finite())
        {
            return argument(format!("the tolerance {tolerance} must be a finite number > 0"));
        }
        if !start.is_finite() {
            return argument(format!("the start time {start} s must be finite"));
        }
        if let Some(stop) = stop
            && !(stop >= start && stop.is_finite())
        {
            return argument(format!("the stop time {stop} s must be finite and not before the start time {start} s"));
        }
        self.clock = Clock { time: start, stop, tolerance };
        Ok(())
    }

    /// `fmi2EnterInitializationMode`
    pub(crate) fn enter_initialization_mode(&mut self) -> Outcome {
        self.component.set_importer_tolerance(self.clock.tolerance);
        self.component.enter_initialization();
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`
    pub(crate) fn exit_initialization_mode(&mut self) -> Outcome {
        let failed = |text| Problem { fault: Fault::Initialisation, text };
        self.component.initialise(self.clock.tolerance).map_err(failed)?;
        self.phase = Phase::StepComplete;
        Ok(())
    }

    /// `fmi2Terminate`
    pub(crate) fn terminate(&mut self) -> Outcome {
        if self.phase == Phase::StepComplete {
            self.component.conclude();
        }
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// `fmi2Reset`: the instance is as new; only the logging stays as it was set.
    pub(crate) fn reset(&mut self) -> Outcome {
        if self.broken {
            self.component = self.scene.component();
            self.broken = false;
        } else {
            self.component.reset();
        }
        self.clock = Clock::default();
        self.phase = Phase::Instantiated;
        Ok(())
    }
}

/// Drops an instance that was taken out of the registry.
pub(crate) fn free(instance: Box<Instance>) {
    // A component that a panic left inconsistent may panic again; there is no log left to report it to.
    let _ = catch(|| drop(instance));
}
