//! One instance of an FMU that runs scene after scene.

use crate::description::{Causality, Description, Kind, Variable};
use crate::error::{Failure, Stage};
use crate::functions::{self, Callbacks, FATAL, Functions, Handle, Status, WARNING, status_name};
use crate::scene::Scene;
use crate::schedule::Follower;
use libloading::Library;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::ptr;

/// What the FMU logged since it was last asked; more than this is cut.
const LONGEST_LOG: usize = 4096;

/// A loaded FMU with one instance, reused for every scene through `fmi2Reset`.
pub struct Worker {
    description: Description,
    functions: Functions,
    /// The instance; NULL before the first scene and after one that did not survive its failure.
    handle: Handle,
    /// Whether `fmi2Reset` is due before the next scene.
    used: bool,
    /// Why nothing can be run any more: the FMU reported a fatal error.
    lost: Option<String>,
    guid: CString,
    resources: CString,
    /// At an address that stays, because the instance keeps pointers to both.
    callbacks: Box<Callbacks>,
    log: Box<RefCell<String>>,
    // Last: the functions must not outlive it.
    _library: Library,
}

// SAFETY: FMI 2.0 lets an instance be driven from any thread, one at a time, and `&mut` sees to that; the log is only
// written inside its calls.
unsafe impl Send for Worker {}

impl Drop for Worker {
    fn drop(&mut self) {
        self.free();
    }
}

impl Worker {
    /// Loads the FMU that was unpacked into `folder`.
    ///
    /// # Errors
    /// Where a file is missing, the description is not of FMI 2.0 for co-simulation, the library cannot be loaded on
    /// this platform, or it does not answer to the description's GUID.
    pub fn open(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join("modelDescription.xml");
        let text = std::fs::read_to_string(&path)
            .map_err(|error| Failure::library(format!("reading {}: {error}", path.display())))?;
        let description = Description::parse(&text)?;
        let library = folder.join("binaries").join(platform()).join(format!(
            "{}{}",
            description.model_identifier,
            std::env::consts::DLL_SUFFIX
        ));
        if !library.is_file() {
            return Err(Failure::library(format!("the FMU holds no library for this platform: {}", library.display())));
        }
        // A bare file name would be looked for on the system's search path.
        let library = library.canonicalize().unwrap_or(library);
        let (functions, loaded) = Functions::load(&library)?;
        let log = Box::new(RefCell::new(String::new()));
        let callbacks = Box::new(Callbacks {
            logger: keep_message,
            allocate: functions::calloc,
            free: functions::free,
            step_finished: None,
            environment: ptr::from_ref::<RefCell<String>>(&log).cast_mut().cast::<c_void>(),
        });
        let c_string =
            |text: String| CString::new(text).map_err(|error| Failure::library(format!("{}: {error}", path.display())));
        let mut worker = Self {
            guid: c_string(description.guid.clone())?,
            resources: c_string(file_uri(&folder.canonicalize().unwrap_or(folder.to_owned()).join("resources")))?,
            description,
            functions,
            handle: ptr::null_mut(),
            used: false,
            lost: None,
            callbacks,
            log,
            _library: loaded,
        };
        // A GUID that does not fit is told now, not with the first scene.
        worker.renew()?;
        Ok(worker)
    }

    /// What the FMU says of itself.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Runs a scene and returns what was recorded: for every point in turn the outputs in their order.
    ///
    /// # Errors
    /// The first thing that went wrong. Unless its stage is [`Stage::Library`], the next scene finds an instance as
    /// good as new.
    pub fn run(&mut self, scene: &Scene) -> Result<Vec<f64>, Failure> {
        let request = Request::resolve(&self.description, scene)?;
        self.renew()?;
        self.used = true;
        let result = self.set_up(scene, &request).and_then(|()| self.step_through(scene, &request));
        self.log.borrow_mut().clear();
        result
    }

    /// Makes sure that there is an instance in its first state.
    fn renew(&mut self) -> Result<(), Failure> {
        if let Some(reason) = &self.lost {
            return Err(Failure::library(reason.clone()));
        }
        if !self.handle.is_null() && self.used {
            // SAFETY: the handle is alive.
            let status = unsafe { (self.functions.reset)(self.handle) };
            if status == FATAL {
                return Err(self.lose("fmi2Reset"));
            }
            if status > WARNING {
                self.free();
            }
        }
        if self.handle.is_null() {
            const CO_SIMULATION: c_uint = 1;
            // SAFETY: all strings end with a zero; the callbacks and what they point to live as long as the worker.
            self.handle = unsafe {
                (self.functions.instantiate)(
                    c"scene".as_ptr(),
                    CO_SIMULATION,
                    self.guid.as_ptr(),
                    self.resources.as_ptr(),
                    &raw const *self.callbacks,
                    0,
                    0,
                )
            };
            if self.handle.is_null() {
                let said = self.said();
                let guid = &self.description.guid;
                return Err(Failure::library(format!("fmi2Instantiate returned NULL for the GUID {guid}{said}")));
            }
        }
        self.used = false;
        self.log.borrow_mut().clear();
        Ok(())
    }

    fn free(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the handle came from fmi2Instantiate and is freed once.
            unsafe { (self.functions.free_instance)(self.handle) };
            self.handle = ptr::null_mut();
        }
    }

    /// After a fatal error FMI 2.0 allows no call any more, not even the one that frees.
    fn lose(&mut self, call: &str) -> Failure {
        self.handle = ptr::null_mut();
        let reason = format!("{call} returned fmi2Fatal{}; the library must be loaded anew", self.said());
        self.lost = Some(reason.clone());
        Failure::library(reason)
    }

    /// What the FMU has logged, to be put behind a sentence.
    fn said(&self) -> String {
        let log = std::mem::take(&mut *self.log.borrow_mut());
        if log.is_empty() { log } else { format!(": {log}") }
    }

    /// Turns a status into a result. `call` is only composed on failure.
    #[inline]
    fn check(&mut self, status: Status, stage: Stage, call: impl FnOnce() -> String) -> Result<(), Failure> {
        if status <= WARNING {
            return Ok(());
        }
        if status == FATAL {
            return Err(self.lose(&call()));
        }
        Err(Failure::new(stage, format!("{} returned {}{}", call(), status_name(status), self.said())))
    }

    /// Parameters and initialisation.
    fn set_up(&mut self, scene: &Scene, request: &Request) -> Result<(), Failure> {
        const STAGE: Stage = Stage::Initialisation;
        let handle = self.handle;
        let tolerance = scene.tolerance.unwrap_or(0.0);
        let (start, stop) = (scene.span.start, scene.span.time(request.steps));
        // SAFETY: the handle is alive and arrays have the lengths given; so below.
        let status = unsafe {
            (self.functions.setup_experiment)(handle, scene.tolerance.is_some().into(), tolerance, start, 1, stop)
        };
        self.check(status, STAGE, || "fmi2SetupExperiment".to_owned())?;
        let Numbers { references, values } = &request.reals;
        if !references.is_empty() {
            let status =
                unsafe { (self.functions.set_real)(handle, references.as_ptr(), references.len(), values.as_ptr()) };
            self.check(status, STAGE, || "fmi2SetReal for the parameters".to_owned())?;
        }
        let Numbers { references, values } = &request.integers;
        if !references.is_empty() {
            let status =
                unsafe { (self.functions.set_integer)(handle, references.as_ptr(), references.len(), values.as_ptr()) };
            self.check(status, STAGE, || "fmi2SetInteger for the parameters".to_owned())?;
        }
        let Numbers { references, values } = &request.booleans;
        if !references.is_empty() {
            let status =
                unsafe { (self.functions.set_boolean)(handle, references.as_ptr(), references.len(), values.as_ptr()) };
            self.check(status, STAGE, || "fmi2SetBoolean for the parameters".to_owned())?;
        }
        let status = unsafe { (self.functions.enter_initialization_mode)(handle) };
        self.check(status, STAGE, || "fmi2EnterInitializationMode".to_owned())?;
        // Outputs of the first communication point answer to the first inputs.
        let mut first = Follower::new(scene.schedule, scene.interpolation, &request.factors);
        first.advance(start, scene.span.step);
        self.set_inputs(&first, false, request, start)?;
        let status = unsafe { (self.functions.exit_initialization_mode)(handle) };
        self.check(status, STAGE, || "fmi2ExitInitializationMode".to_owned())
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
    fn step_through(&mut self, scene: &Scene, request: &Request) -> Result<Vec<f64>, Failure> {
        let Scene { span, .. } = *scene;
        let mut recorded = Vec::with_capacity(request.points.len() * request.outputs.len());
        let mut points = request.points.iter().copied().peekable();
        if points.next_if_eq(&0).is_some() {
            self.record(span.start, request, &mut recorded)?;
        }
        let mut follower = Follower::new(scene.schedule, scene.interpolation, &request.factors);
        for index in 0..request.steps {
            let time = span.time(index);
            let change = follower.advance(time, span.step);
            if change.any {
                self.set_inputs(&follower, change.sloping, request, time)?;
            }
            // SAFETY: the handle is alive.
            let status = unsafe { (self.functions.step)(self.handle, time, span.step, 1) };
            self.check(status, Stage::Stepping, || format!("fmi2DoStep from {time} s over {} s", span.step))?;
            if points.next_if_eq(&(index + 1)).is_some() {
                self.record(span.time(index + 1), request, &mut recorded)?;
            }
        }
        Ok(recorded)
    }

    /// Appends the outputs.
    fn record(&mut self, time: f64, request: &Request, recorded: &mut Vec<f64>) -> Result<(), Failure> {
        let base = recorded.len();
        recorded.resize(base + request.outputs.len(), f64::NAN);
        let handle = self.handle;
        if request.only_reals {
            let (references, count) = (request.outputs.as_ptr(), request.outputs.len());
            // SAFETY: see `set_up`.
            let status = unsafe { (self.functions.get_real)(handle, references, count, recorded[base..].as_mut_ptr()) };
            self.check(status, Stage::Stepping, || format!("fmi2GetReal at {time} s"))?;
        } else {
            for (at, (&reference, kind)) in request.outputs.iter().zip(&request.output_kinds).enumerate() {
                let mut whole: c_int = 0;
                // SAFETY: see `set_up`; each call gets one value.
                let status = unsafe {
                    match kind {
                        Kind::Real => {
                            (self.functions.get_real)(handle, &raw const reference, 1, &raw mut recorded[base + at])
                        }
                        Kind::Boolean => (self.functions.get_boolean)(handle, &raw const reference, 1, &raw mut whole),
                        _ => (self.functions.get_integer)(handle, &raw const reference, 1, &raw mut whole),
                    }
                };
                self.check(status, Stage::Stepping, || format!("getting the outputs at {time} s"))?;
                if *kind != Kind::Real {
                    recorded[base + at] = f64::from(whole);
                }
            }
        }
        match recorded[base..].iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(at) => {
                let (name, value) = (request.output_names[at], recorded[base + at]);
                Err(Failure::new(Stage::Stepping, format!("{name} is {value} at {time} s")))
            }
        }
    }
}

/// Value references and values of one type.
struct Numbers<T> {
    references: Vec<u32>,
    values: Vec<T>,
}

impl<T> Numbers<T> {
    const fn new() -> Self {
        Self { references: Vec::new(), values: Vec::new() }
    }

    fn push(&mut self, reference: u32, value: T) {
        self.references.push(reference);
        self.values.push(value);
    }
}

/// A scene with its names resolved.
struct Request<'a> {
    reals: Numbers<f64>,
    integers: Numbers<c_int>,
    booleans: Numbers<c_int>,
    inputs: Vec<u32>,
    orders: Vec<c_int>,
    factors: Vec<f64>,
    outputs: Vec<u32>,
    output_kinds: Vec<Kind>,
    output_names: &'a [&'a str],
    only_reals: bool,
    steps: usize,
    points: Vec<usize>,
}

impl<'a> Request<'a> {
    fn resolve(description: &Description, scene: &Scene<'a>) -> Result<Self, Failure> {
        let wrong = |reason: String| Err(Failure::request(reason));
        let (mut reals, mut integers, mut booleans) = (Numbers::new(), Numbers::new(), Numbers::new());
        for (at, &(name, value)) in scene.parameters.iter().enumerate() {
            let variable = description.find_as(name, Causality::Parameter)?;
            if scene.parameters[..at].iter().any(|&(before, _)| before == name) {
                return wrong(format!("the parameter {name} is given twice"));
            }
            if !value.is_finite() {
                return wrong(format!("{name} = {value} must be finite"));
            }
            match variable.kind {
                Kind::Real => reals.push(variable.reference, value),
                Kind::Integer | Kind::Enumeration(_) => integers.push(variable.reference, variable.whole(value)?),
                Kind::Boolean => booleans.push(variable.reference, variable.whole(value)?),
                Kind::String => return wrong(format!("{name} is a text; a scene sets numbers only")),
            }
        }
        if scene.inputs.len() != scene.schedule.columns() {
            return wrong(format!("{} inputs for {} columns", scene.inputs.len(), scene.schedule.columns()));
        }
        let mut inputs = Vec::with_capacity(scene.inputs.len());
        for (at, &name) in scene.inputs.iter().enumerate() {
            let variable = description.find_as(name, Causality::Input)?;
            if scene.inputs[..at].contains(&name) || variable.kind != Kind::Real {
                return wrong(format!("the input {name} stands twice or is no Real"));
            }
            inputs.push(variable.reference);
        }
        let factors = if scene.factors.is_empty() { vec![1.0; inputs.len()] } else { scene.factors.to_vec() };
        if factors.len() != inputs.len() || factors.iter().any(|factor| !factor.is_finite()) {
            return wrong(format!("the factors {factors:?} must be finite and one for each of {:?}", scene.inputs));
        }
        if let Some(tolerance) = scene.tolerance.filter(|tolerance| !(tolerance.is_finite() && *tolerance > 0.0)) {
            return wrong(format!("the tolerance {tolerance} must be positive"));
        }
        if scene.interpolation == crate::Interpolation::Linear && !description.takes_input_derivatives {
            return wrong(format!("{} takes no derivatives of inputs", description.model_name));
        }
        let recorded: Vec<&Variable> =
            scene.outputs.iter().map(|name| description.find(name)).collect::<Result<_, _>>()?;
        if let Some(text) = recorded.iter().find(|variable| variable.kind == Kind::String) {
            return wrong(format!("{} is a text and cannot be recorded", text.name));
        }
        Ok(Self {
            reals,
            integers,
            booleans,
            orders: vec![1; inputs.len()],
            inputs,
            factors,
            outputs: recorded.iter().map(|variable| variable.reference).collect(),
            output_kinds: recorded.iter().map(|variable| variable.kind.clone()).collect(),
            output_names: scene.outputs,
            only_reals: recorded.iter().all(|variable| variable.kind == Kind::Real),
            steps: scene.span.steps()?,
            points: scene.span.indices(scene.points)?,
        })
    }
}

/// The FMU's logger: keeps what it is told.
///
/// # Safety
/// `environment` is the log of a living worker; the texts end with a zero.
unsafe extern "C" fn keep_message(
    environment: *mut c_void,
    _instance: *const c_char,
    _status: Status,
    _category: *const c_char,
    format: *const c_char,
    argument: *const c_char,
) {
    if environment.is_null() || format.is_null() {
        return;
    }
    // SAFETY: the worker handed out this address and outlives its instance.
    let log = unsafe { &*environment.cast::<RefCell<String>>() };
    // SAFETY: see above.
    let format = unsafe { CStr::from_ptr(format) };
    let has_argument = cfg!(not(all(target_vendor = "apple", target_arch = "aarch64")));
    let text = if has_argument && format == c"%s" && !argument.is_null() {
        // SAFETY: the format says that the argument is a text.
        unsafe { CStr::from_ptr(argument) }
    } else {
        // Formats with other arguments are shown as they are: half a message beats a guess at its arguments.
        format
    };
    // Importers expand `#r12#` to a variable's name, so a plain `#` arrives doubled.
    let text = text.to_string_lossy().replace("##", "#");
    if let Ok(mut log) = log.try_borrow_mut() {
        if !log.is_empty() {
            log.push(' ');
        }
        let room = LONGEST_LOG.saturating_sub(log.len());
        log.push_str(&text[..text.floor_char_boundary(room)]);
    }
}

/// The folder of this platform's library in an FMU.
fn platform() -> &'static str {
    match (std::env::consts::OS, std::env::consts::ARCH) {
        ("windows", "x86_64") => "win64",
        ("windows", _) => "win32",
        ("macos", _) => "darwin64",
        ("linux", "aarch64") => "aarch64-linux",
        (_, "x86_64") => "linux64",
        (_, other) => other,
    }
}

/// URI of a folder, RFC 3986: everything but letters, digits and a few signs as `%XX`.
fn file_uri(path: &Path) -> String {
    let mut uri = String::from("file://");
    let path = path.to_string_lossy().replace('\\', "/");
    if !path.starts_with('/') {
        uri.push('/');
    }
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~:".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_escaped() {
        assert_eq!(file_uri(Path::new("/a b/ü#1")), "file:///a%20b/%C3%BC%231");
    }

    #[test]
    fn messages_are_collected_and_cut() {
        let log = RefCell::new(String::new());
        let tell = |format: &CStr, text: &CStr| {
            let environment = ptr::from_ref(&log).cast_mut().cast::<c_void>();
            // SAFETY: all texts end with a zero and the environment is a log.
            unsafe { keep_message(environment, ptr::null(), 3, ptr::null(), format.as_ptr(), text.as_ptr()) };
        };
        tell(c"%s", c"punch.width = ##1");
        tell(c"plain", c"unused");
        assert_eq!(*log.borrow(), "punch.width = #1 plain");
        tell(c"%s", &CString::new("é".repeat(LONGEST_LOG)).unwrap());
        assert!(log.borrow().len() <= LONGEST_LOG);
    }

    #[test]
    fn a_folder_that_is_no_fmu_is_refused() {
        let Err(failure) = Worker::open(Path::new("/nonexistent")) else { panic!("it was opened") };
        assert_eq!(failure.stage, Stage::Library);
        assert!(failure.reason.contains("modelDescription.xml"), "{failure}");
    }
}
