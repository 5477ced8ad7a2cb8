//! Entry and exit of every call on an instance: floating-point environment, handle lookup, busy flag, phase check, panic barrier, log,
//! status.
//!
//! A panic is a defect of this library and must not end the importer's process: the message goes to the instance's log, the
//! instance to the error phase, and the call returns `fmi2Error`.

use core::ffi::c_void;

use super::floating_point::Environment;
use super::instance::Instance;
use super::policy::{Fault, Function};
use super::problem::{Outcome, Problem};
use super::registry::Registry;
use super::types::Status;
use crate::panics::catch;

/// Every living instance.
pub(crate) static INSTANCES: Registry<Instance> = Registry::new(1);

/// One call of `function` on the instance of a handle.
///
/// A handle that is unknown, freed, or in use by another call returns `fmi2Error` without side effects, and
/// without a message, because the logger belongs to the instance that cannot be accessed.
#[inline(always)]
pub(crate) fn call(component: *mut c_void, function: Function, body: impl FnOnce(&mut Instance) -> Outcome) -> Status {
    let _environment = function.computes().then(Environment::enter);
    let Ok(mut guard) = INSTANCES.acquire(component) else { return Status::Error };
    let instance = &mut *guard;
    let result = catch(|| {
        let outcome = if function.rule().allowed.contains(instance.phase()) {
            body(instance)
        } else {
            instance.out_of_order(function)
        };
        instance.conclude(function, outcome)
    });
    match result {
        Ok(status) => status,
        Err(text) => panicked(instance, function, text),
    }
}

#[cold]
fn panicked(instance: &mut Instance, function: Function, text: String) -> Status {
    catch(|| instance.conclude(function, Err(Problem { fault: Fault::Panic, text }))).unwrap_or(Status::Error)
}

#[cfg(test)]
mod tests {
    use super::super::policy::Phase;
    use super::super::types::{CO_SIMULATION, CallbackFunctions, ComponentEnvironment, Logger, String as Text};
    use super::*;
    use crate::panics::tests::turn;
    use core::ffi::{CStr, c_char};
    use std::ptr;

    /// Notes category, status and text in the vector that is the environment. Not variadic, as Rust
    /// cannot define such functions; the importers' own loggers are exercised from C and Python.
    unsafe extern "C" fn note(
        environment: ComponentEnvironment,
        _: Text,
        status: Status,
        category: Text,
        _: Text,
        text: *const c_char,
    ) {
        // SAFETY: the environment is the test's vector, the strings end with a zero.
        unsafe {
            let notes = &mut *environment.cast::<Vec<(Status, String, String)>>();
            let owned = |text| CStr::from_ptr(text).to_str().unwrap().to_owned();
            notes.push((status, owned(category), owned(text)));
        }
    }

    fn with_instance(body: impl FnOnce(*mut c_void)) -> Vec<(Status, String, String)> {
        let mut notes: Vec<(Status, String, String)> = Vec::new();
        // SAFETY: on the platforms of the tests a variadic function takes a pointer as any other does.
        let logger = unsafe {
            core::mem::transmute::<
                unsafe extern "C" fn(ComponentEnvironment, Text, Status, Text, Text, *const c_char),
                Logger,
            >(note)
        };
        let callbacks = CallbackFunctions {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: (&raw mut notes).cast(),
        };
        let guid = std::ffi::CString::new(scene::slot::current().unwrap().guid()).unwrap();
        let instance = Instance::instantiate(&callbacks, Some(c"test"), CO_SIMULATION, Some(&guid), false).unwrap();
        let handle = INSTANCES.insert(instance).unwrap();
        body(handle);
        INSTANCES.remove(handle).unwrap();
        notes
    }

    #[test]
    fn a_panic_is_logged_and_fails_the_instance_until_it_is_reset() {
        let _turn = turn();
        let notes = with_instance(|handle| {
            let status = call(handle, Function::GetReal, |_| panic!("index {} of 100 % #1#", 3));
            assert_eq!(status, Status::Error);
            assert_eq!(INSTANCES.acquire(handle).unwrap().phase(), Phase::Error);
            assert_eq!(call(handle, Function::DoStep, |instance| instance.do_step(0.0, 0.1)), Status::Error);
            assert_eq!(call(handle, Function::Reset, Instance::reset), Status::Ok);
            assert_eq!(INSTANCES.acquire(handle).unwrap().phase(), Phase::Instantiated);
            assert_eq!(
                call(handle, Function::EnterInitializationMode, Instance::enter_initialization_mode),
                Status::Ok
            );
        });
        let (status, category, text) = &notes[0];
        assert_eq!((*status, category.as_str()), (Status::Error, "logStatusError"));
        assert!(text.starts_with("fmi2GetReal: defect of this FMU, please report: index 3 of 100 % ##1##"), "{text}");
        assert!(text.contains("gate.rs:"), "{text}");
    }

    #[test]
    fn an_instance_that_panicked_gives_no_state_but_takes_one() {
        let _turn = turn();
        with_instance(|handle| {
            let mut good = ptr::null_mut();
            let save = |into: &mut *mut c_void| {
                call(handle, Function::GetFmuState, |instance| instance.get_fmu_state(*into).map(|state| *into = state))
            };
            assert_eq!(save(&mut good), Status::Ok);
            call(handle, Function::GetReal, |_| panic!());
            assert_eq!(save(&mut ptr::null_mut()), Status::Error);
            assert_eq!(call(handle, Function::SetFmuState, |instance| instance.set_fmu_state(good)), Status::Ok);
            assert_eq!(INSTANCES.acquire(handle).unwrap().phase(), Phase::Instantiated);
            assert_eq!(save(&mut good), Status::Ok);
            assert_eq!(call(handle, Function::FreeFmuState, |instance| instance.free_fmu_state(good)), Status::Ok);
        });
    }
}
