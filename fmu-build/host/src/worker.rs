//! One instance of an FMU that runs scene after scene.

mod log;
mod recording;
mod request;
mod run;

use crate::description::Description;
use crate::error::{Failure, Stage};
use crate::functions::{self, Callbacks, FATAL, Functions, Handle, Status, WARNING, status_name};
use crate::scene::Scene;
use libloading::Library;
use log::keep_message;
use request::Request;
use std::cell::RefCell;
use std::ffi::{CString, c_uint, c_void};
use std::path::Path;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A loaded FMU with one instance, reused for every scene through `fmi2Reset`.
pub struct Worker {
    description: Arc<Description>,
    functions: Functions,
    /// The instance; NULL before the first scene and after a failure that destroyed it.
    handle: Handle,
    /// Whether `fmi2Reset` is due before the next scene.
    used: bool,
    /// Reason why no further scene can be run: the FMU reported a fatal error.
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
            logger: Some(keep_message),
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
            description: Arc::new(description),
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

    /// The FMU's model description.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Runs a scene and returns what was recorded: for every point in turn the outputs in their order.
    ///
    /// # Errors
    /// The first failure. Unless its stage is [`Stage::Library`], the next scene starts from a fresh
    /// instance.
    pub fn run(&mut self, scene: &Scene) -> Result<Vec<f64>, Failure> {
        self.run_until(scene, None)
    }

    /// As [`Worker::run`], until another thread sets `stop`.
    pub(crate) fn run_until(&mut self, scene: &Scene, stop: Option<&AtomicBool>) -> Result<Vec<f64>, Failure> {
        // A handle of its own, so that the request may point into the description while the worker changes.
        let description = Arc::clone(&self.description);
        let request = Request::resolve(&description, scene)?;
        self.renew()?;
        self.used = true;
        let result = self.set_up(scene, &request).and_then(|()| self.step_through(scene, &request, stop));
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

    /// The FMU's log messages, to be appended to a sentence.
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
}

/// The folder of this platform's library in an FMU.
pub fn platform() -> &'static str {
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
    fn a_folder_that_is_no_fmu_is_refused() {
        let Err(failure) = Worker::open(Path::new("/nonexistent")) else { panic!("it was opened") };
        assert_eq!(failure.stage, Stage::Library);
        assert!(failure.reason.contains("modelDescription.xml"), "{failure}");
    }
}
