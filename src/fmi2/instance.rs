//! What each function does to an instance.
//!
//! Every method here is one exported function with its arguments made safe; the gate has checked the
//! phase. A method either does its work or returns a [`Problem`] and has changed nothing.

#![forbid(unsafe_code)]

mod problem;

use core::ffi::{CStr, c_void};
use std::sync::{Arc, OnceLock};

use super::exports::arguments::{Sink, Source};
use super::gate::{STATES, catch};
use super::log::{Category, Log};
use super::policy::{self, Fault, Function, INPUT_DERIVATIVE_ORDER, OUTPUT_DERIVATIVE_ORDER, Phase};
use super::state::{self, Clock, Saved};
use super::types::{
    Boolean, CO_SIMULATION, CallbackFunctions, FALSE, Integer, LAST_SUCCESSFUL_TIME, Real, Status, StatusKind,
    TERMINATED, Type,
};
use crate::component::{Component, Snapshot, Subject, Values};
use crate::slot;
use crate::variables::{self, Causality, ValueReference};
pub use problem::{Outcome, Problem};
use problem::{argument, reference_problem};

/// The scene of this library with what every instance needs of it, made once.
struct Scene {
    name: String,
    guid: String,
    starts: Arc<Values>,
}

fn scene() -> Result<&'static Scene, &'static str> {
    static SCENE: OnceLock<Result<Scene, &'static str>> = OnceLock::new();
    let scene = SCENE.get_or_init(|| {
        let packaged = slot::current()?;
        Ok(Scene { name: packaged.name.clone(), guid: packaged.guid(), starts: Arc::new(packaged.starts) })
    });
    scene.as_ref().map_err(|reason| *reason)
}

/// One instance of the FMU.
pub struct Instance {
    phase: Phase,
    clock: Clock,
    component: Component,
    /// A panic may have left the component half changed: it is used no more, only replaced.
    broken: bool,
    scene: &'static Scene,
    log: Log,
    scratch: Scratch,
}

/// Arguments of `fmi2GetDirectionalDerivative`, kept so that calling it again allocates nothing.
#[derive(Default)]
struct Scratch {
    unknowns: Vec<ValueReference>,
    knowns: Vec<ValueReference>,
    seed: Vec<f64>,
    result: Vec<f64>,
}

/// Life cycle and log.
impl Instance {
    /// `fmi2Instantiate`: `None` after a message that says why.
    pub fn instantiate(
        callbacks: &CallbackFunctions,
        name: Option<&CStr>,
        kind: Type,
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
            return refuse(&format!("this FMU is for co-simulation (fmuType 1); fmuType {kind} was asked for"));
        }
        let scene = match scene() {
            Ok(scene) => scene,
            Err(reason) => return refuse(reason),
        };
        if guid.is_none_or(|guid| guid.to_bytes() != scene.guid.as_bytes()) {
            let given = guid.map_or("none".into(), CStr::to_string_lossy);
            return refuse(&format!("the GUID of this FMU is {}, {given} was given", scene.guid));
        }
        if log.wants(Category::Events) {
            log.send(Status::Ok, Category::Events, &format!("fmi2Instantiate: scene {}", scene.name));
        }
        Some(Box::new(Instance {
            phase: Phase::Instantiated,
            clock: Clock::default(),
            component: Component::new(scene.starts.clone()),
            broken: false,
            scene,
            log,
            scratch: Scratch::default(),
        }))
    }

    /// The phase that the call sequences are checked against.
    #[inline(always)]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The problem of a call that is not allowed now.
    #[cold]
    pub fn out_of_order(&self, function: Function) -> Outcome {
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
    pub fn conclude(&mut self, function: Function, outcome: Outcome) -> Status {
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
        let messages = self.component.messages();
        if messages.len() == 0 {
            return;
        }
        for message in messages {
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
    pub fn set_debug_logging(&mut self, on: bool, categories: Option<&[Category]>) -> Outcome {
        self.log.enable(on, categories.unwrap_or(Log::categories()));
        Ok(())
    }

    /// `fmi2SetupExperiment`
    pub fn setup_experiment(&mut self, tolerance: Option<Real>, start: Real, stop: Option<Real>) -> Outcome {
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
    pub fn enter_initialization_mode(&mut self) -> Outcome {
        self.component.enter_initialization();
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`
    pub fn exit_initialization_mode(&mut self) -> Outcome {
        match self.component.initialise(self.clock.tolerance) {
            Ok(()) => {
                self.phase = Phase::StepComplete;
                Ok(())
            }
            Err(text) => Err(Problem { fault: Fault::Initialisation, text: text.to_string() }),
        }
    }

    /// `fmi2Terminate`
    pub fn terminate(&mut self) -> Outcome {
        self.phase = Phase::Terminated;
        Ok(())
    }

    /// `fmi2Reset`: the instance is as new; only the logging stays as it was set.
    pub fn reset(&mut self) -> Outcome {
        if self.broken {
            self.component = Component::new(self.scene.starts.clone());
            self.broken = false;
        } else {
            self.component.reset();
        }
        self.clock = Clock::default();
        self.phase = Phase::Instantiated;
        Ok(())
    }
}

/// Variables.
impl Instance {
    /// `fmi2SetReal`, `fmi2SetInteger`, `fmi2SetBoolean`. Nothing is stored unless all of it is fine.
    #[inline(always)]
    pub fn set<T: Copy + Into<f64>>(
        &mut self,
        kind: policy::Type,
        references: Source<'_, ValueReference>,
        values: Source<'_, T>,
    ) -> Outcome {
        for index in 0..references.count() {
            let reference = references.at(index);
            let access = policy::access(reference);
            if !access.is(kind) || !access.settable().contains(self.phase) {
                return Err(reference_problem(reference, Some(kind), Some(self.phase)));
            }
            if !access.is_input() {
                let value = values.at(index).into();
                if variables::check_parameter(reference, value).is_err() {
                    return Err(self.refused_values(kind, references, values));
                }
            }
        }
        for index in 0..references.count() {
            let (reference, value) = (references.at(index), values.at(index).into());
            if policy::access(reference).is_input() {
                self.component.set_input(reference, value);
            } else {
                self.component.set_parameter(reference, value);
            }
        }
        Ok(())
    }

    /// All of a vector's refused values in one problem; a wrong reference behind them weighs more.
    #[cold]
    fn refused_values<T: Copy + Into<f64>>(
        &self,
        kind: policy::Type,
        references: Source<'_, ValueReference>,
        values: Source<'_, T>,
    ) -> Problem {
        let mut refusals = Vec::new();
        for index in 0..references.count() {
            let reference = references.at(index);
            let access = policy::access(reference);
            if !access.is(kind) || !access.settable().contains(self.phase) {
                return reference_problem(reference, Some(kind), Some(self.phase));
            }
            if !access.is_input()
                && let Err(refusal) = variables::check_parameter(reference, values.at(index).into())
            {
                refusals.push(refusal.to_string());
            }
        }
        Problem { fault: Fault::Value, text: format!("{}; the old value stays", refusals.join("; ")) }
    }

    /// `fmi2GetReal`, `fmi2GetInteger`, `fmi2GetBoolean`
    #[inline(always)]
    pub fn get<T: Copy>(
        &mut self,
        kind: policy::Type,
        references: Source<'_, ValueReference>,
        values: Sink<'_, T>,
        convert: impl Fn(f64) -> T,
    ) -> Outcome {
        for index in 0..references.count() {
            if !policy::access(references.at(index)).is(kind) {
                return Err(reference_problem(references.at(index), Some(kind), None));
            }
        }
        for index in 0..references.count() {
            values.put(index, convert(self.component.get(references.at(index))));
        }
        Ok(())
    }

    /// `fmi2GetString`, `fmi2SetString`: there are no such variables.
    pub fn no_strings(&mut self, references: Source<'_, ValueReference>) -> Outcome {
        if references.count() == 0 { Ok(()) } else { Err(reference_problem(references.at(0), None, None)) }
    }

    /// `fmi2SetRealInputDerivatives`: only order 1. They hold for the next step; as the inputs
    /// themselves they are stored whatever they are, and that step refuses what is no number.
    pub fn set_real_input_derivatives(
        &mut self,
        references: Source<'_, ValueReference>,
        orders: Source<'_, Integer>,
        values: Source<'_, Real>,
    ) -> Outcome {
        for index in 0..references.count() {
            let (reference, order) = (references.at(index), orders.at(index));
            let access = policy::access(reference);
            if !access.is(policy::Type::Real) {
                return Err(reference_problem(reference, Some(policy::Type::Real), None));
            }
            if !access.is_input() {
                return Err(problem::not_an(Causality::Input, reference));
            }
            if order != INPUT_DERIVATIVE_ORDER {
                return argument(format!("input derivatives are of order {INPUT_DERIVATIVE_ORDER}, not {order}"));
            }
        }
        for index in 0..references.count() {
            self.component.set_input_derivative(references.at(index), values.at(index));
        }
        Ok(())
    }

    /// `fmi2GetRealOutputDerivatives`: none are offered.
    pub fn get_real_output_derivatives(
        &mut self,
        references: Source<'_, ValueReference>,
        orders: Source<'_, Integer>,
    ) -> Outcome {
        if references.count() == 0 {
            return Ok(());
        }
        argument(format!(
            "order {} was asked for; output derivatives are offered up to order {OUTPUT_DERIVATIVE_ORDER}",
            orders.at(0)
        ))
    }

    /// `fmi2GetDirectionalDerivative`: of outputs by inputs.
    pub fn get_directional_derivative(
        &mut self,
        unknowns: Source<'_, ValueReference>,
        knowns: Source<'_, ValueReference>,
        seed: Source<'_, Real>,
        result: Sink<'_, Real>,
    ) -> Outcome {
        for (references, causality) in [(unknowns, Causality::Output), (knowns, Causality::Input)] {
            for index in 0..references.count() {
                let reference = references.at(index);
                if !policy::access(reference).is(policy::Type::Real) {
                    return Err(reference_problem(reference, Some(policy::Type::Real), None));
                }
                if variables::lookup(reference).is_none_or(|(row, _)| row.causality != causality) {
                    return Err(problem::not_an(causality, reference));
                }
            }
        }
        let scratch = &mut self.scratch;
        unknowns.copy_into(&mut scratch.unknowns);
        knowns.copy_into(&mut scratch.knowns);
        seed.copy_into(&mut scratch.seed);
        if let Some(value) = scratch.seed.iter().find(|value| !value.is_finite()) {
            return argument(format!("the seed {value} must be finite"));
        }
        scratch.result.clear();
        scratch.result.resize(scratch.unknowns.len(), 0.0);
        self.component
            .directional_derivative(&scratch.unknowns, &scratch.knowns, &scratch.seed, &mut scratch.result)
            .map_err(|text| Problem { fault: Fault::Derivative, text: text.to_string() })?;
        for (index, &value) in scratch.result.iter().enumerate() {
            result.put(index, value);
        }
        Ok(())
    }
}

/// Steps.
impl Instance {
    /// `fmi2DoStep`. The step has the length that was asked for, to the last bit, and the next one
    /// begins where the importer says that this one ends: rounding differences between its clock and
    /// the sum of the steps do not pile up, and a constant step stays constant.
    #[inline(always)]
    pub fn do_step(&mut self, from: Real, step: Real) -> Outcome {
        let end = from + step;
        let fits = step >= 0.0
            && (from - self.clock.time).abs() <= policy::same_time_within(self.clock.time)
            && self.clock.stop.is_none_or(|stop| end <= stop + policy::same_time_within(stop))
            && end.is_finite();
        if !fits {
            return self.misfit(from, step);
        }
        match self.component.step(step) {
            Ok(()) => {
                self.clock.time = end;
                Ok(())
            }
            Err(text) => Err(Problem { fault: Fault::Step, text: format!("step of {step} s from {from} s: {text}") }),
        }
    }

    #[cold]
    fn misfit(&self, from: Real, step: Real) -> Outcome {
        let (time, end) = (self.clock.time, from + step);
        if !(step >= 0.0 && step.is_finite()) {
            return argument(format!("the step {step} s must be a finite number >= 0"));
        }
        if !((from - time).abs() <= policy::same_time_within(time) && end.is_finite()) {
            return argument(format!(
                "the communication point {from} s is not the end of the last step, {time} s (within {} s)",
                policy::same_time_within(time)
            ));
        }
        let stop = self.clock.stop.unwrap_or(f64::INFINITY);
        argument(format!("the step of {step} s from {from} s ends at {end} s, past the stop time {stop} s"))
    }

    /// `fmi2GetRealStatus`: the time of the last successful step.
    pub fn real_status(&mut self, kind: StatusKind) -> Result<Real, Problem> {
        if kind == LAST_SUCCESSFUL_TIME { Ok(self.clock.time) } else { Err(problem::no_status(kind)) }
    }

    /// `fmi2GetBooleanStatus`: this slave never asks to end the simulation.
    pub fn boolean_status(&mut self, kind: StatusKind) -> Result<Boolean, Problem> {
        if kind == TERMINATED { Ok(FALSE) } else { Err(problem::no_status(kind)) }
    }

    /// `fmi2GetStatus`, `fmi2GetIntegerStatus`, `fmi2GetStringStatus`: they tell about steps that are
    /// still running and about nothing else; there are none.
    pub fn no_status<T>(&mut self, kind: StatusKind) -> Result<T, Problem> {
        Err(problem::no_status(kind))
    }
}

/// FMU states.
impl Instance {
    /// `fmi2GetFMUstate`: into the state `current`, or into a new one where that is NULL.
    pub fn get_fmu_state(&mut self, current: *mut c_void) -> Result<*mut c_void, Problem> {
        if self.broken {
            return problem::state("a defect has left this instance without a valid state");
        }
        if !current.is_null() {
            let mut saved = STATES.acquire(current).map_err(problem::unknown_state)?;
            saved.phase = self.phase;
            saved.clock = self.clock;
            self.component.snapshot(&mut saved.component);
            return Ok(current);
        }
        let mut saved = Box::new(Saved { phase: self.phase, clock: self.clock, component: Snapshot::default() });
        self.component.snapshot(&mut saved.component);
        keep(saved)
    }

    /// `fmi2SetFMUstate`: all is as it was then, also after an error.
    pub fn set_fmu_state(&mut self, state: *mut c_void) -> Outcome {
        let saved = STATES.acquire(state).map_err(problem::unknown_state)?;
        let failed = |text: &dyn ToString| Problem { fault: Fault::State, text: text.to_string() };
        if self.broken {
            let mut fresh = Component::new(self.scene.starts.clone());
            fresh.restore(&saved.component).map_err(|text| failed(&text))?;
            self.component = fresh;
            self.broken = false;
        } else {
            self.component.restore(&saved.component).map_err(|text| failed(&text))?;
        }
        self.phase = saved.phase;
        self.clock = saved.clock;
        Ok(())
    }

    /// `fmi2FreeFMUstate`; NULL is ignored.
    pub fn free_fmu_state(&mut self, state: *mut c_void) -> Outcome {
        if !state.is_null() {
            drop(STATES.remove(state).map_err(problem::unknown_state)?);
        }
        Ok(())
    }

    /// `fmi2SerializedFMUstateSize`
    pub fn serialized_size(&mut self, state: *mut c_void) -> Result<usize, Problem> {
        Ok(STATES.acquire(state).map_err(problem::unknown_state)?.encoded_size(&self.scene.guid))
    }

    /// `fmi2SerializeFMUstate`: into exactly as many bytes as `fmi2SerializedFMUstateSize` told.
    pub fn serialize(&mut self, state: *mut c_void, bytes: Sink<'_, u8>) -> Outcome {
        let saved = STATES.acquire(state).map_err(problem::unknown_state)?;
        let written = saved.encode(&self.scene.guid).map_err(|text| Problem { fault: Fault::State, text })?;
        if written.len() != bytes.count() {
            return argument(format!("the FMU state takes {} bytes, {} were given", written.len(), bytes.count()));
        }
        for (index, &byte) in written.iter().enumerate() {
            bytes.put(index, byte);
        }
        Ok(())
    }

    /// `fmi2DeSerializeFMUstate`: a new state.
    pub fn deserialize(&mut self, bytes: Source<'_, u8>) -> Result<*mut c_void, Problem> {
        let problem = |text| Problem { fault: Fault::State, text };
        let given = bytes.count();
        if given < state::HEADER {
            return Err(problem(state::shorter_than_header(given)));
        }
        let announced = state::announced_size(&std::array::from_fn(|index| bytes.at(index))).map_err(problem)?;
        if announced != given {
            return Err(problem(state::wrong_length(announced, given)));
        }
        let mut copy = Vec::new();
        bytes.copy_into(&mut copy);
        keep(Box::new(Saved::decode(&copy, &self.scene.guid).map_err(problem)?))
    }
}

fn keep(saved: Box<Saved>) -> Result<*mut c_void, Problem> {
    match STATES.insert(saved) {
        Some(handle) => Ok(handle),
        None => problem::state("there are too many FMU states; free some"),
    }
}

/// Drops an instance that was taken out of the registry.
pub fn free(instance: Box<Instance>) {
    // A component that a panic left half changed may panic again; there is nobody left to tell.
    let _ = catch(|| drop(instance));
}
