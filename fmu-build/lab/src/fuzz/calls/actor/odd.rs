//! Calls as no sensible importer makes them: any reference, value, length and pointer that the standard allows.

use core::ffi::{CStr, c_void};
use std::ptr;

use scene::variables::{COUNT, ValueReference, reference};
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, Status};

use super::{Actor, INPUTS, SLOTS};
use crate::fuzz::importer::guid;
use crate::fuzz::invariants::{OUTPUTS, name_of};
use crate::fuzz::watchdog::{call, enter};

/// Lengths that no array has, larger than every number of variables: refused before anything is read.
const LENGTHS: [usize; 4] = [COUNT + 1, u32::MAX as usize, isize::MAX as usize, usize::MAX];

/// Arrays of a call: exactly as long as they must be, so that the address sanitizer sees what is read beyond.
struct Arrays {
    references: Vec<ValueReference>,
    reals: Vec<f64>,
    integers: Vec<i32>,
    /// Length that is told: the true one, or one of [`LENGTHS`].
    count: usize,
    /// Which of the pointers are NULL.
    missing: [bool; 2],
}

impl Arrays {
    fn references(&self) -> *const ValueReference {
        if self.missing[0] { ptr::null() } else { self.references.as_ptr() }
    }

    fn reals(&mut self) -> *mut f64 {
        if self.missing[1] { ptr::null_mut() } else { self.reals.as_mut_ptr() }
    }

    fn integers(&mut self) -> *mut i32 {
        if self.missing[1] { ptr::null_mut() } else { self.integers.as_mut_ptr() }
    }
}

fn place<T>(is_missing: bool, to: &mut T) -> *mut T {
    if is_missing { ptr::null_mut() } else { to }
}

impl Actor {
    fn reference(&mut self) -> ValueReference {
        match self.random.below(8) {
            0 => COUNT as ValueReference,
            1 => self.random.bits() as ValueReference,
            2 => ValueReference::MAX,
            3 => INPUTS as ValueReference - self.random.below(2) as ValueReference,
            _ => self.random.below(COUNT) as ValueReference,
        }
    }

    fn integer(&mut self) -> i32 {
        if self.random.one_in(3) { self.random.bits() as i32 } else { self.random.below(7) as i32 - 1 }
    }

    fn arrays(&mut self) -> Arrays {
        let count = self.random.count();
        let are_variables = self.random.one_in(2);
        let references = (0..count)
            .map(|_| if are_variables { self.random.below(COUNT) as ValueReference } else { self.reference() })
            .collect();
        let reals = (0..count).map(|_| self.random.any()).collect();
        let integers = (0..count).map(|_| self.integer()).collect();
        let told = if self.random.one_in(6) { *self.random.pick(&LENGTHS) } else { count };
        let missing = [self.random.one_in(12), self.random.one_in(12)];
        Arrays { references, reals, integers, count: told, missing }
    }

    pub(super) fn odd(&mut self) -> Result<Status, String> {
        let mut arrays = self.arrays();
        let status = match self.random.below(24) {
            0..=8 => self.values(&mut arrays),
            9 => self.any_directional_derivative(&arrays),
            10 => {
                let [tolerance, stop] = [(); 2].map(|()| self.random.one_in(2).then(|| self.random.any()));
                let start = self.random.any();
                self.importer.setup(tolerance, start, stop)
            }
            11 => self.importer.enter(),
            12 => self.importer.exit(),
            13 if self.random.one_in(4) => self.importer.terminate(),
            14 => self.any_logging(),
            15 => self.any_status(),
            16 => {
                let slot = self.random.below(SLOTS);
                self.importer.free(&mut self.states[slot])
            }
            17 => self.any_serialisation(),
            18 => self.no_component(&mut arrays)?,
            19 => self.no_state()?,
            20 => self.no_instance()?,
            21 => self.through_bytes()?,
            22 => {
                let (from, length) = (self.random.any(), self.random.any());
                self.importer.step(from, length)
            }
            _ => {
                let index = self.random.below(INPUTS);
                let value = self.input(index);
                let status = self.importer.set_reals(&[index as ValueReference], &[value]);
                if status == Status::Ok {
                    self.inputs[index] = value;
                }
                status
            }
        };
        if !matches!(status, Status::Ok | Status::Discard | Status::Error) {
            return Err(format!("a function returns {status:?}"));
        }
        if status == Status::Ok {
            for value in arrays.reals {
                self.note_real(value);
            }
        }
        // Whatever was called: the next step is judged by itself.
        self.last = None;
        Ok(status)
    }

    fn values(&mut self, arrays: &mut Arrays) -> Status {
        let (component, count) = (self.importer.component, arrays.count);
        let orders: Vec<i32> = arrays.integers.iter().map(|order| if count % 2 == 0 { 1 } else { *order }).collect();
        let mut texts = vec![c"text".as_ptr(); arrays.references.len()];
        let which = self.random.below(12);
        // SAFETY of all: an array is NULL, as long as told, or told to be longer than there are variables, which is refused
        // before anything is read.
        unsafe {
            match which {
                0 => call!(fmi2GetInteger(component, arrays.references(), count, arrays.integers())),
                1 => call!(fmi2GetBoolean(component, arrays.references(), count, arrays.integers())),
                2 => {
                    let status = call!(fmi2SetReal(component, arrays.references(), count, arrays.reals()));
                    // Inputs may be among them.
                    self.inputs = [f64::NAN; INPUTS];
                    status
                }
                3 => {
                    let status = call!(fmi2SetInteger(component, arrays.references(), count, arrays.integers()));
                    self.keep_cheap();
                    status
                }
                4 => call!(fmi2SetBoolean(component, arrays.references(), count, arrays.integers())),
                5 => call!(fmi2GetString(component, arrays.references(), count, texts.as_mut_ptr())),
                6 => call!(fmi2SetString(component, arrays.references(), count, texts.as_ptr())),
                7 => call!(fmi2SetRealInputDerivatives(
                    component,
                    arrays.references(),
                    count,
                    orders.as_ptr(),
                    arrays.reals()
                )),
                8 => call!(fmi2GetRealOutputDerivatives(
                    component,
                    arrays.references(),
                    count,
                    orders.as_ptr(),
                    arrays.reals()
                )),
                9 => call!(fmi2CancelStep(component)),
                10 => call!(fmi2SetContinuousStates(component, arrays.reals(), count)),
                _ => call!(fmi2GetReal(component, arrays.references(), count, arrays.reals())),
            }
        }
    }

    /// Planning and fine contact lines are left to the executions that are meant to have them.
    fn keep_cheap(&mut self) {
        let log = self.importer.take_log();
        if !self.is_costly {
            let _ = self.importer.set_integer(reference("solver.fidelity"), 2);
        }
        let _ = self.importer.set_integer(reference("solver.cells"), 5);
        self.importer.take_log();
        self.importer.put_back(log);
    }

    pub(super) fn set_slopes(&mut self, references: &[ValueReference], orders: &[i32], slopes: &[f64]) -> Status {
        // SAFETY: the arrays are as long as told.
        unsafe {
            let (start, count) = (references.as_ptr(), references.len());
            call!(fmi2SetRealInputDerivatives(self.importer.component, start, count, orders.as_ptr(), slopes.as_ptr()))
        }
    }

    /// Derivatives of outputs at good inputs are finite.
    pub(super) fn derivatives(&mut self) -> Result<Status, String> {
        let output = *self.random.pick(&OUTPUTS);
        let input = self.random.below(INPUTS) as ValueReference;
        let (mut along, mut rate) = (0.0, 0.0);
        // SAFETY: one element each, here and below.
        let other = unsafe { call!(fmi2GetRealOutputDerivatives(self.importer.component, &output, 1, &1, &mut rate)) };
        self.note(other);
        let status = unsafe {
            call!(fmi2GetDirectionalDerivative(self.importer.component, &output, 1, &input, 1, &1.0, &mut along))
        };
        if self.has_good_inputs() {
            let names = [output, input].map(name_of);
            if status == Status::Ok && !along.is_finite() {
                return Err(format!("d {} / d {} = {along} at inputs {:?}", names[0], names[1], self.inputs));
            }
            if other == Status::Ok && !rate.is_finite() {
                return Err(format!("d {} / dt = {rate} at inputs {:?}", names[0], self.inputs));
            }
        }
        self.note_real(along);
        self.note_real(rate);
        Ok(status)
    }

    fn any_directional_derivative(&mut self, arrays: &Arrays) -> Status {
        let count = self.random.below(4);
        let knowns: Vec<ValueReference> = (0..count).map(|_| self.random.below(INPUTS + 2) as ValueReference).collect();
        let seeds: Vec<f64> = knowns.iter().map(|_| self.random.any()).collect();
        let mut result = vec![0.0; arrays.references.len()];
        let told = if self.random.one_in(8) { *self.random.pick(&LENGTHS) } else { knowns.len() };
        // SAFETY: as in `values`.
        unsafe {
            call!(fmi2GetDirectionalDerivative(
                self.importer.component,
                arrays.references(),
                arrays.count,
                knowns.as_ptr(),
                told,
                seeds.as_ptr(),
                result.as_mut_ptr(),
            ))
        }
    }

    fn any_logging(&mut self) -> Status {
        const NAMES: [&CStr; 5] = [c"logEvents", c"logStatusWarning", c"logStatusError", c"logAll", c""];
        let count = self.random.below(6);
        let mut names: Vec<_> = (0..count).map(|_| self.random.pick(&NAMES).as_ptr()).collect();
        if self.random.one_in(8) {
            names.push(ptr::null());
        }
        let told = if self.random.one_in(8) { *self.random.pick(&LENGTHS) } else { names.len() };
        let on = self.random.below(3) as i32 - 1;
        // SAFETY: as in `values`; the names are static.
        unsafe { call!(fmi2SetDebugLogging(self.importer.component, on, told, names.as_ptr())) }
    }

    fn any_status(&mut self) -> Status {
        enter("fmi2GetStatus");
        let component = self.importer.component;
        let kind = if self.random.one_in(4) { self.random.bits() } else { self.random.below(5) as u64 };
        let (kind, none, which) = (kind as types::StatusKind, self.random.one_in(5), self.random.below(5));
        let (mut status, mut real, mut integer, mut boolean, mut text) = (Status::Ok, 0.0, 0, 0, ptr::null());
        // SAFETY: the places are there or NULL.
        unsafe {
            match which {
                0 => fmi2GetStatus(component, kind, place(none, &mut status)),
                1 => fmi2GetRealStatus(component, kind, place(none, &mut real)),
                2 => fmi2GetIntegerStatus(component, kind, place(none, &mut integer)),
                3 => fmi2GetBooleanStatus(component, kind, place(none, &mut boolean)),
                _ => fmi2GetStringStatus(component, kind, place(none, &mut text)),
            }
        }
    }

    /// Sizes that are wrong, and places that are missing.
    fn any_serialisation(&mut self) -> Status {
        enter("fmi2SerializeFMUstate");
        let component = self.importer.component;
        let state = self.states[self.random.below(SLOTS)];
        let which = self.random.below(7);
        let mut size = 0;
        // SAFETY: the places are there or NULL; the array is as long as told, or told to be longer than the state, which is
        // refused before anything is written.
        unsafe {
            match which {
                0 => return fmi2GetFMUstate(component, ptr::null_mut()),
                1 => return fmi2FreeFMUstate(component, ptr::null_mut()),
                2 => return fmi2SerializedFMUstateSize(component, state, ptr::null_mut()),
                _ => {}
            }
            let status = fmi2SerializedFMUstateSize(component, state, &mut size);
            if status != Status::Ok {
                return status;
            }
            let mut bytes = vec![0_u8; size];
            let start = bytes.as_mut_ptr().cast();
            match which {
                3 => fmi2SerializeFMUstate(component, state, ptr::null_mut(), size),
                4 => fmi2SerializeFMUstate(component, state, start, self.random.below(size)),
                5 => fmi2SerializeFMUstate(component, state, start, usize::MAX),
                _ => fmi2SerializeFMUstate(component, state, start, size),
            }
        }
    }

    /// Components that are none: nothing happens.
    fn no_component(&mut self, arrays: &mut Arrays) -> Result<Status, String> {
        enter("a function without its instance");
        let bit = 1 << self.random.below(64);
        let wrong: *mut c_void = match self.random.below(4) {
            0 => ptr::null_mut(),
            1 => ptr::without_provenance_mut(self.random.bits() as usize),
            2 => self.states[0],
            _ => ptr::without_provenance_mut(self.importer.component as usize ^ bit),
        };
        let which = self.random.below(4);
        // SAFETY: as in `values`; a handle is never dereferenced.
        let status = unsafe {
            match which {
                0 => fmi2DoStep(wrong, f64::NAN, 0.1, 1),
                1 => fmi2GetReal(wrong, arrays.references(), LENGTHS[0], arrays.reals()),
                2 => fmi2EnterInitializationMode(wrong),
                _ => fmi2GetStatus(wrong, 0, &mut Status::Ok),
            }
        };
        // The bit may have made another instance's handle: the calls are such that they change none.
        if !matches!(status, Status::Error | Status::Discard) && which != 2 {
            return Err(format!("function {which} of the component {wrong:?}, which is none, returns {status:?}"));
        }
        fmi2FreeInstance(ptr::null_mut());
        Ok(Status::Ok)
    }

    /// States that are none.
    fn no_state(&mut self) -> Result<Status, String> {
        enter("a function of states without one");
        let component = self.importer.component;
        let wrong: *mut c_void = if self.random.one_in(2) {
            component
        } else {
            ptr::without_provenance_mut(self.random.bits() as usize | 1 << 63)
        };
        let (mut place, mut size) = (wrong, 0);
        // SAFETY: the places are there; a handle is never dereferenced.
        let statuses = unsafe {
            [
                fmi2SetFMUstate(component, wrong),
                fmi2GetFMUstate(component, &mut place),
                fmi2SerializedFMUstateSize(component, wrong, &mut size),
                fmi2FreeFMUstate(component, &mut place),
            ]
        };
        if statuses != [Status::Error; 4] {
            return Err(format!("the state {wrong:?}, which is none, is taken: {statuses:?}"));
        }
        // Their messages hold the number, which is another one in every run.
        self.importer.take_log();
        Ok(Status::Ok)
    }

    /// Instantiations that are refused.
    fn no_instance(&mut self) -> Result<Status, String> {
        enter("fmi2Instantiate");
        let guid = guid();
        let callbacks = CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: ptr::null_mut(),
        };
        let all = ptr::from_ref(&callbacks);
        let (name, guid, none) = (c"other".as_ptr(), guid.as_ptr(), ptr::null());
        let (which, kind) = (self.random.below(6), 2 * self.random.below(5) as types::FmuType);
        // SAFETY: strings and structure live through the calls, or are NULL.
        let refused = unsafe {
            match which {
                0 => fmi2Instantiate(ptr::null(), types::CO_SIMULATION, guid, none, all, 0, 0),
                1 => fmi2Instantiate(c"".as_ptr(), types::CO_SIMULATION, guid, none, all, 0, 1),
                2 => fmi2Instantiate(name, kind, guid, none, all, 0, 0),
                3 => fmi2Instantiate(name, types::CO_SIMULATION, none, none, all, 0, 0),
                4 => fmi2Instantiate(name, types::CO_SIMULATION, c"{}".as_ptr(), name, all, 1, 0),
                _ => fmi2Instantiate(name, types::CO_SIMULATION, guid, none, ptr::null(), 0, 0),
            }
        };
        if !refused.is_null() {
            return Err("fmi2Instantiate accepts wrong arguments".into());
        }
        // One that is accepted with every callback NULL, used without a logger, and used once more after its end.
        // SAFETY: as above.
        unsafe {
            let other = fmi2Instantiate(name, types::CO_SIMULATION, guid, none, all, 0, 0);
            let statuses = [fmi2DoStep(other, 0.0, 0.1, 1), fmi2SetReal(other, &0, 1, &f64::NAN)];
            fmi2FreeInstance(other);
            if other.is_null() || statuses != [Status::Error, Status::Ok] || fmi2Reset(other) != Status::Error {
                return Err("an instance without callbacks misbehaves".into());
            }
            fmi2FreeInstance(other);
        }
        Ok(Status::Ok)
    }

    /// Saved, serialised, read and restored: the same bytes.
    fn through_bytes(&mut self) -> Result<Status, String> {
        let bytes = self.importer.bytes();
        if bytes.is_empty() {
            return Err("an instance gives no state".into());
        }
        let mut state = self.importer.deserialize(&bytes).map_err(|_| "a serialised state is refused")?;
        if self.importer.restore(state) != Status::Ok || self.importer.bytes() != bytes {
            return Err(format!("a state that went through bytes is another one: {:?}", self.importer.take_log()));
        }
        Ok(self.importer.free(&mut state))
    }
}
