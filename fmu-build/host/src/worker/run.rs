//! Execution of one scene: parameters, initialisation, steps.

use super::Worker;
use super::recording::{Getters, Recording};
use super::request::{Numbers, Request};
use crate::error::{Failure, Stage};
use crate::functions::{Functions, Handle, Status};
use crate::scene::Scene;
use crate::schedule::Follower;
use std::sync::atomic::{AtomicBool, Ordering};

impl Worker {
    /// Parameters and initialisation.
    pub(super) fn set_up(&mut self, scene: &Scene, request: &Request) -> Result<(), Failure> {
        const STAGE: Stage = Stage::Initialisation;
        let handle = self.handle;
        let tolerance = scene.tolerance.unwrap_or(0.0);
        let (start, stop) = (scene.span.start, scene.span.time(request.steps));
        // SAFETY: the handle is alive and arrays have the lengths given; so below.
        let status = unsafe {
            (self.functions.setup_experiment)(handle, scene.tolerance.is_some().into(), tolerance, start, 1, stop)
        };
        self.check(status, STAGE, || "fmi2SetupExperiment".to_owned())?;
        let Functions { set_real, set_integer, set_boolean, .. } = self.functions;
        self.set_parameters(&request.reals, set_real, "fmi2SetReal")?;
        self.set_parameters(&request.integers, set_integer, "fmi2SetInteger")?;
        self.set_parameters(&request.booleans, set_boolean, "fmi2SetBoolean")?;
        // SAFETY: the handle is alive.
        let status = unsafe { (self.functions.enter_initialization_mode)(handle) };
        self.check(status, STAGE, || "fmi2EnterInitializationMode".to_owned())?;
        // Outputs of the first communication point belong to the first inputs.
        let mut first = Follower::new(scene.schedule, scene.interpolation, &request.factors);
        first.advance(start, scene.span.step);
        self.set_inputs(&first, false, request, start)?;
        // SAFETY: the handle is alive.
        let status = unsafe { (self.functions.exit_initialization_mode)(handle) };
        self.check(status, STAGE, || "fmi2ExitInitializationMode".to_owned())
    }

    fn set_parameters<T>(
        &mut self,
        Numbers { references, values }: &Numbers<T>,
        set: unsafe extern "C" fn(Handle, *const u32, usize, *const T) -> Status,
        name: &str,
    ) -> Result<(), Failure> {
        if references.is_empty() {
            return Ok(());
        }
        // SAFETY: see `set_up`.
        let status = unsafe { set(self.handle, references.as_ptr(), references.len(), values.as_ptr()) };
        self.check(status, Stage::Initialisation, || format!("{name} for the parameters"))
    }

    #[inline]
    fn set_inputs(&mut self, follower: &Follower, sloping: bool, request: &Request, time: f64) -> Result<(), Failure> {
        let (references, count) = (request.inputs.as_ptr(), request.inputs.len());
        if count == 0 {
            return Ok(());
        }
        // SAFETY: see `set_up`.
        let status = unsafe { (self.functions.set_real)(self.handle, references, count, follower.values.as_ptr()) };
        self.check(status, Stage::Stepping, || format!("fmi2SetReal for the inputs at {time} s"))?;
        if sloping {
            // SAFETY: see `set_up`.
            let status = unsafe {
                let (orders, slopes) = (request.orders.as_ptr(), follower.slopes.as_ptr());
                (self.functions.set_input_derivatives)(self.handle, references, count, orders, slopes)
            };
            self.check(status, Stage::Stepping, || format!("fmi2SetRealInputDerivatives at {time} s"))?;
        }
        Ok(())
    }

    /// All steps, with what is recorded on the way.
    pub(super) fn step_through(
        &mut self,
        scene: &Scene,
        request: &Request,
        stop: Option<&AtomicBool>,
    ) -> Result<Vec<f64>, Failure> {
        let Scene { span, .. } = *scene;
        let mut recording = Recording::new(scene.outputs, &request.outputs, request.points.len());
        let mut points = request.points.iter().copied().peekable();
        if points.next_if_eq(&0).is_some() {
            self.record(span.start, &mut recording)?;
        }
        let mut follower = Follower::new(scene.schedule, scene.interpolation, &request.factors);
        for index in 0..request.steps {
            let time = span.time(index);
            if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
                return Err(Failure::new(Stage::Stepping, format!("stopped at {time} s")));
            }
            let change = follower.advance(time, span.step);
            if change.any {
                self.set_inputs(&follower, change.sloping, request, time)?;
            }
            // SAFETY: the handle is alive.
            let status = unsafe { (self.functions.step)(self.handle, time, span.step, 1) };
            self.check(status, Stage::Stepping, || format!("fmi2DoStep from {time} s over {} s", span.step))?;
            if points.next_if_eq(&(index + 1)).is_some() {
                self.record(span.time(index + 1), &mut recording)?;
            }
        }
        Ok(recording.into_rows())
    }

    /// Appends the outputs.
    fn record(&mut self, time: f64, recording: &mut Recording) -> Result<(), Failure> {
        let Functions { get_real: real, get_integer: integer, get_boolean: boolean, .. } = self.functions;
        // SAFETY: the handle is alive, and these are its library's functions.
        let status = unsafe { recording.add(&Getters { real, integer, boolean }, self.handle) };
        self.check(status, Stage::Stepping, || format!("getting the outputs at {time} s"))?;
        recording.check(time)
    }
}
