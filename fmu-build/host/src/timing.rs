//! An FMI 2.0 co-simulation library loaded into this process: the timed calls only, any library's that exports them.
//!
//! Here and not beside the clock that reads them: the command line is compiled without optimisation.

use crate::functions::{self, Callbacks, Handle, Status, functions};
use anyhow::{Context, Result, anyhow, bail};
use libloading::Library;
use std::cell::Cell;
use std::ffi::{CString, c_char, c_double, c_int, c_uint, c_void};
use std::path::Path;
use std::ptr::{self, NonNull};

/// Callbacks without a logger, shared: an instance keeps their address.
struct Shared(Callbacks);
// SAFETY: it is never written and holds no pointer.
unsafe impl Sync for Shared {}
static CALLBACKS: Shared = Shared(Callbacks {
    logger: None,
    allocate: functions::calloc,
    free: functions::free,
    step_finished: None,
    environment: ptr::null_mut(),
});

functions! {
    /// Functions that every peer exports.
    Functions:
    instantiate = c"fmi2Instantiate" (*const c_char, c_uint, *const c_char, *const c_char, *const Callbacks, c_int, c_int) -> Handle;
    free = c"fmi2FreeInstance" (Handle) -> ();
    setup = c"fmi2SetupExperiment" (Handle, c_int, c_double, c_double, c_int, c_double) -> Status;
    enter = c"fmi2EnterInitializationMode" (Handle) -> Status;
    exit = c"fmi2ExitInitializationMode" (Handle) -> Status;
    reset = c"fmi2Reset" (Handle) -> Status;
    set = c"fmi2SetReal" (Handle, *const c_uint, usize, *const c_double) -> Status;
    get = c"fmi2GetReal" (Handle, *const c_uint, usize, *mut c_double) -> Status;
    step = c"fmi2DoStep" (Handle, c_double, c_double, c_int) -> Status;
}

functions! {
    /// Functions for the state of an FMU.
    StateFunctions:
    get = c"fmi2GetFMUstate" (Handle, *mut Handle) -> Status;
    set = c"fmi2SetFMUstate" (Handle, Handle) -> Status;
    free = c"fmi2FreeFMUstate" (Handle, *mut Handle) -> Status;
    size = c"fmi2SerializedFMUstateSize" (Handle, Handle, *mut usize) -> Status;
}

functions! {
    /// The function for derivatives of inputs.
    DerivativeFunctions:
    set = c"fmi2SetRealInputDerivatives" (Handle, *const c_uint, usize, *const c_int, *const c_double) -> Status;
}

/// A loaded library.
pub struct Component {
    functions: Functions,
    derivatives: Option<DerivativeFunctions>,
    state: Option<StateFunctions>,
    guid: CString,
    // Last: the functions must not outlive it.
    _library: Library,
}

impl Component {
    /// Loads a library and checks that it accepts this GUID.
    pub fn load(path: &Path, guid: &str) -> Result<Self> {
        // SAFETY: loading runs the library's initialisers; both libraries are made by this project.
        let library = unsafe { Library::new(path) }.with_context(|| format!("loading {}", path.display()))?;
        let functions = Functions::find(&library).map_err(|missing| anyhow!("{}: {missing}", path.display()))?;
        let (derivatives, state) = (DerivativeFunctions::find(&library).ok(), StateFunctions::find(&library).ok());
        Ok(Self { functions, derivatives, state, guid: CString::new(guid)?, _library: library })
    }

    /// A new instance, not initialised.
    pub fn instantiate(&self) -> Result<Instance<'_>> {
        const CO_SIMULATION: c_uint = 1;
        // SAFETY: all strings end with a zero and the callbacks live for ever.
        let handle = unsafe {
            (self.functions.instantiate)(
                c"bench".as_ptr(),
                CO_SIMULATION,
                self.guid.as_ptr(),
                ptr::null(),
                &raw const CALLBACKS.0,
                0,
                0,
            )
        };
        match NonNull::new(handle) {
            Some(handle) => Ok(Instance { component: self, handle, time: Cell::new(0.0) }),
            None => bail!("fmi2Instantiate returned NULL for the GUID {:?}", self.guid),
        }
    }
}

/// An instance; freed when dropped.
pub struct Instance<'a> {
    component: &'a Component,
    handle: NonNull<c_void>,
    /// Communication point, s.
    time: Cell<f64>,
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle came from fmi2Instantiate and is freed once.
        unsafe { (self.component.functions.free)(self.handle.as_ptr()) }
    }
}

fn ok(status: Status, call: &str) -> Result<()> {
    if status == 0 { Ok(()) } else { bail!("{call} returned status {status}") }
}

impl Instance<'_> {
    /// Set-up and initialisation from time 0.
    ///
    /// # Errors
    /// Where a call does not return fmi2OK; so below.
    pub fn initialise(&mut self) -> Result<()> {
        self.time.set(0.0);
        let (functions, handle) = (&self.component.functions, self.handle.as_ptr());
        // SAFETY: the handle is alive; so below.
        unsafe {
            ok((functions.setup)(handle, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment")?;
            ok((functions.enter)(handle), "fmi2EnterInitializationMode")?;
            ok((functions.exit)(handle), "fmi2ExitInitializationMode")
        }
    }

    /// Back to the start values.
    pub fn reset(&mut self) -> Result<()> {
        // SAFETY: see `initialise`.
        ok(unsafe { (self.component.functions.reset)(self.handle.as_ptr()) }, "fmi2Reset")
    }

    /// The timed exchange: sets two inputs, and their derivatives if there are any, steps, gets three outputs.
    ///
    /// # Errors
    /// See [`Self::initialise`]; also where the library takes no derivatives.
    #[inline]
    pub fn exchange(
        &self,
        variables: &Variables,
        inputs: &[f64; 2],
        slopes: Option<&[f64; 2]>,
        step: f64,
    ) -> Result<[f64; 3]> {
        let (functions, handle) = (&self.component.functions, self.handle.as_ptr());
        let mut outputs = [0.0; 3];
        // SAFETY: the arrays have the lengths given.
        unsafe {
            ok((functions.set)(handle, variables.inputs.as_ptr(), 2, inputs.as_ptr()), "fmi2SetReal")?;
            if let Some(slopes) = slopes {
                const FIRST: [c_int; 2] = [1; 2];
                let Some(derivatives) = &self.component.derivatives else {
                    bail!("the library takes no input derivatives")
                };
                let status = (derivatives.set)(handle, variables.inputs.as_ptr(), 2, FIRST.as_ptr(), slopes.as_ptr());
                ok(status, "fmi2SetRealInputDerivatives")?;
            }
            ok((functions.step)(handle, self.time.get(), step, 1), "fmi2DoStep")?;
            ok((functions.get)(handle, variables.outputs.as_ptr(), 3, outputs.as_mut_ptr()), "fmi2GetReal")?;
        }
        self.time.set(self.time.get() + step);
        Ok(outputs)
    }

    /// Exchanges one after the other; the outputs of the last.
    pub fn exchanges(
        &self,
        variables: &Variables,
        inputs: &[[f64; 2]],
        slopes: Option<&[[f64; 2]]>,
        step: f64,
    ) -> Result<[f64; 3]> {
        let mut outputs = [0.0; 3];
        for (index, pair) in inputs.iter().enumerate() {
            outputs = self.exchange(variables, pair, slopes.map(|slopes| &slopes[index]), step)?;
        }
        Ok(outputs)
    }

    /// The state of the instance.
    pub fn state(&self) -> Result<State<'_>> {
        let Some(functions) = &self.component.state else { bail!("the library keeps no states") };
        let mut handle = ptr::null_mut();
        // SAFETY: NULL asks for a new state.
        ok(unsafe { (functions.get)(self.handle.as_ptr(), &raw mut handle) }, "fmi2GetFMUstate")?;
        Ok(State { instance: self, functions, handle, time: self.time.get() })
    }
}

/// A saved state; freed when dropped.
pub struct State<'a> {
    instance: &'a Instance<'a>,
    functions: &'a StateFunctions,
    handle: Handle,
    time: f64,
}

impl State<'_> {
    /// Overwrites the saved state with the present one.
    pub fn update(&mut self) -> Result<()> {
        self.time = self.instance.time.get();
        // SAFETY: both handles are alive; so below.
        ok(unsafe { (self.functions.get)(self.instance.handle.as_ptr(), &raw mut self.handle) }, "fmi2GetFMUstate")
    }

    /// Restores the saved state.
    pub fn restore(&self) -> Result<()> {
        self.instance.time.set(self.time);
        // SAFETY: both handles are alive.
        ok(unsafe { (self.functions.set)(self.instance.handle.as_ptr(), self.handle) }, "fmi2SetFMUstate")
    }

    /// Bytes of the serialised state.
    pub fn size(&self) -> Result<usize> {
        let mut size = 0;
        // SAFETY: see `update`.
        let status = unsafe { (self.functions.size)(self.instance.handle.as_ptr(), self.handle, &raw mut size) };
        ok(status, "fmi2SerializedFMUstateSize").map(|()| size)
    }
}

impl Drop for State<'_> {
    fn drop(&mut self) {
        // SAFETY: the state came from fmi2GetFMUstate of this instance and is freed once.
        unsafe { (self.functions.free)(self.instance.handle.as_ptr(), &raw mut self.handle) };
    }
}

/// Value references of the exchanged variables.
#[derive(Clone, Copy, Debug)]
pub struct Variables {
    /// Sliding velocity and normal load.
    pub inputs: [u32; 2],
    /// Wear depth, contact temperature and friction force.
    pub outputs: [u32; 3],
}
