//! FMU states: saving, restoring, freeing and serialising.

#![forbid(unsafe_code)]

use core::ffi::c_void;

use super::Instance;
use crate::component::Snapshot;
use crate::fmi2::arguments::{Sink, Source};
use crate::fmi2::policy::Fault;
use crate::fmi2::problem::{self, Outcome, Problem, argument};
use crate::fmi2::state::STATES;
use crate::fmi2::state::{self, Saved};

impl Instance {
    /// `fmi2GetFMUstate`: into the state `current`, or into a new one where that is NULL.
    pub(crate) fn get_fmu_state(&mut self, current: *mut c_void) -> Result<*mut c_void, Problem> {
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

    /// `fmi2SetFMUstate`: restores the saved state, also after an error.
    pub(crate) fn set_fmu_state(&mut self, state: *mut c_void) -> Outcome {
        let saved = STATES.acquire(state).map_err(problem::unknown_state)?;
        let failed = |text| Problem { fault: Fault::State, text };
        if self.broken {
            let mut fresh = self.scene.component();
            fresh.restore(&saved.component).map_err(failed)?;
            self.component = fresh;
            self.broken = false;
        } else {
            self.component.restore(&saved.component).map_err(failed)?;
        }
        self.phase = saved.phase;
        self.clock = saved.clock;
        Ok(())
    }

    /// `fmi2FreeFMUstate`; NULL is ignored.
    pub(crate) fn free_fmu_state(&mut self, state: *mut c_void) -> Outcome {
        if !state.is_null() {
            drop(STATES.remove(state).map_err(problem::unknown_state)?);
        }
        Ok(())
    }

    /// `fmi2SerializedFMUstateSize`
    pub(crate) fn serialized_size(&mut self, state: *mut c_void) -> Result<usize, Problem> {
        Ok(STATES.acquire(state).map_err(problem::unknown_state)?.encoded_size(self.scene.guid.as_str()))
    }

    /// `fmi2SerializeFMUstate`: into exactly as many bytes as `fmi2SerializedFMUstateSize` returned.
    pub(crate) fn serialize(&mut self, state: *mut c_void, bytes: Sink<'_, u8>) -> Outcome {
        let saved = STATES.acquire(state).map_err(problem::unknown_state)?;
        let written = saved.encode(self.scene.guid.as_str()).map_err(|text| Problem { fault: Fault::State, text })?;
        if written.len() != bytes.count() {
            return argument(format!("the FMU state takes {} bytes, {} were given", written.len(), bytes.count()));
        }
        bytes.put_all(&written);
        Ok(())
    }

    /// `fmi2DeSerializeFMUstate`: a new state.
    pub(crate) fn deserialize(&mut self, bytes: Source<'_, u8>) -> Result<*mut c_void, Problem> {
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
        keep(Box::new(Saved::decode(&copy, self.scene.guid.as_str()).map_err(problem)?))
    }
}

fn keep(saved: Box<Saved>) -> Result<*mut c_void, Problem> {
    match STATES.insert(saved) {
        Some(handle) => Ok(handle),
        None => problem::state("there are too many FMU states; free some"),
    }
}
