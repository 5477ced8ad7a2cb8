//! An instance and what is done with it.

mod odd;

use core::ffi::c_void;
use std::ptr;

use scene::fnv::Fnv;
use scene::variables::{COUNT, Causality, FLAT, Kind, TABLE, ValueReference};
use sliding_contact::fmi2::types::Status;

use super::scenes;
use crate::fuzz::importer::{Importer, without_phase};
use crate::fuzz::invariants::{OUTPUTS, Outputs, VALIDITY};
use crate::fuzz::random::Random;
use crate::fuzz::{Kinds, Verdict};

fn first_difference(one: &[u8], other: &[u8]) -> Option<usize> {
    let at = one.iter().zip(other).position(|(one, other)| one != other);
    at.or((one.len() != other.len()).then(|| one.len().min(other.len())))
}

/// Number of the library's inputs: the first variables.
pub(crate) const INPUTS: usize = model::INPUTS;
/// Largest magnitude of an input at which outputs that are read must be finite.
const LARGEST_READ: f64 = 1e6;
/// States that an instance keeps.
const SLOTS: usize = 3;

fn references() -> [ValueReference; INPUTS] {
    core::array::from_fn(|index| index as ValueReference)
}

pub(crate) struct Actor {
    importer: Importer,
    random: Random,
    states: [*mut c_void; SLOTS],
    /// Inputs and steps are those of a machine.
    is_tame: bool,
    /// Steps take long: what doubles them is done seldom.
    is_costly: bool,
    /// All inputs are finite and within the library's limit.
    inputs: [f64; INPUTS],
    /// Outputs after the last step, unless the run was set back since.
    last: Option<Outputs>,
    /// Everything that the instance has answered.
    digest: Fnv,
}

impl Actor {
    /// A new instance, in a random scene or as it is.
    pub(crate) fn new(mut random: Random) -> Result<Self, String> {
        let debug = random.one_in(2);
        let importer = Importer::new(debug).ok_or("fmi2Instantiate gives no instance")?;
        let is_tame = random.one_in(2);
        let is_costly = scenes::set_up(&importer, &mut random);
        importer.take_log();
        let (states, inputs) = ([ptr::null_mut(); SLOTS], [0.0; INPUTS]);
        let mut actor = Self { importer, random, states, is_tame, is_costly, inputs, last: None, digest: Fnv::new() };
        if !actor.random.one_in(8) {
            actor.initialise()?;
        }
        Ok(actor)
    }

    /// Takes a status into the digest.
    fn note(&mut self, status: Status) {
        self.digest = self.digest.with(status as u8);
    }

    fn note_real(&mut self, value: f64) {
        self.digest = value.to_bits().to_le_bytes().into_iter().fold(self.digest, Fnv::with);
    }

    pub(crate) fn turn(&mut self, kinds: &mut Kinds) -> Verdict {
        let status = match self.random.below(40) {
            0..=17 => self.step()?,
            18..=24 => self.set_inputs(),
            25 | 26 => self.set_derivatives(),
            27 | 28 => self.get()?,
            29 => self.save(),
            30 => self.restore(),
            31 => self.replay()?,
            32 => self.derivatives()?,
            33 => self.set_parameters(),
            34 if self.random.one_in(4) => self.restart()?,
            _ => self.odd()?,
        };
        self.note(status);
        self.read_log(status, kinds)
    }

    /// Ends the sequence; the digest of all answers.
    pub(crate) fn finish(&mut self, kinds: &mut Kinds) -> Result<u64, String> {
        let _ = self.importer.terminate();
        for at in 0..SLOTS {
            let status = self.importer.free(&mut self.states[at]);
            self.note(status);
        }
        self.read_log(Status::Ok, kinds)?;
        Ok(self.digest.0)
    }

    /// Judges the messages; a refusal must have one.
    fn read_log(&mut self, status: Status, kinds: &mut Kinds) -> Verdict {
        let log = self.importer.take_log();
        if status == Status::Warning {
            return Err("a function returns fmi2Warning".into());
        }
        if status != Status::Ok && !log.iter().any(|(level, text)| *level == status && text.len() > 20) {
            return Err(format!("{status:?} without a message: {log:?}"));
        }
        for (_, text) in log {
            if text.contains("defect of this FMU") {
                return Err(text);
            }
            self.digest = text.bytes().fold(self.digest, Fnv::with);
            kinds.note(&text);
        }
        Ok(())
    }

    fn initialise(&mut self) -> Verdict {
        let tolerance = self
            .random
            .one_in(3)
            .then(|| if self.random.one_in(4) { self.random.any() } else { self.random.power(-6.0, -0.5) });
        let start = if self.random.one_in(4) { self.random.any() } else { 0.0 };
        let stop = self.random.one_in(4).then(|| start + self.random.power(0.0, 4.0));
        let mut status = self.importer.setup(tolerance, start, stop);
        self.note(status);
        status = self.importer.enter();
        self.note(status);
        if self.random.one_in(4) {
            status = self.set_inputs();
            self.note(status);
            status = self.get()?;
            self.note(status);
        }
        status = self.importer.exit();
        self.note(status);
        if status == Status::Ok {
            self.outputs()?.check(None).map_err(|text| format!("after initialisation: {text}"))?;
        }
        Ok(())
    }

    fn restart(&mut self) -> Result<Status, String> {
        self.last = None;
        self.inputs = [0.0; INPUTS];
        let status = self.importer.reset();
        if status != Status::Ok {
            return Err("fmi2Reset fails".into());
        }
        if self.random.one_in(2) {
            self.is_costly = scenes::set_up(&self.importer, &mut self.random);
        } else {
            let lumped = scene::variables::reference("solver.fidelity");
            let _ = self.importer.set_integer(lumped, 2);
            self.is_costly = false;
        }
        self.initialise()?;
        Ok(Status::Ok)
    }

    /// All outputs; NaN where reading them is refused because of an input.
    fn outputs(&mut self) -> Result<Outputs, String> {
        let values = match self.importer.get_reals(&OUTPUTS) {
            Ok(values) => values,
            Err(Status::Error) if !self.has_good_inputs() || self.importer.has_named_an_input() => {
                vec![f64::NAN; OUTPUTS.len()]
            }
            Err(status) => return Err(format!("fmi2GetReal returns {status:?}")),
        };
        let outputs = Outputs::new(values, self.importer.limits());
        self.digest = outputs.bits().flat_map(u64::to_le_bytes).fold(self.digest, Fnv::with);
        Ok(outputs)
    }

    /// Whether the inputs are such that outputs and derivatives must be finite without a step. Beyond, a step refuses what has
    /// no solution; reading does not.
    fn has_good_inputs(&self) -> bool {
        self.inputs.iter().all(|value| value.abs() <= LARGEST_READ)
    }

    /// Whether the contact is hotter than a step from there could solve: by inputs far beyond [`LARGEST_READ`] before.
    fn is_beyond_every_machine(&self) -> bool {
        let temperature = scene::variables::reference("contact_temperature");
        self.importer.get_reals(&[temperature]).is_ok_and(|values| values[0].abs() > LARGEST_READ)
    }

    fn input(&mut self, index: usize) -> f64 {
        if !self.is_tame && self.random.one_in(3) {
            return self.random.any();
        }
        if self.random.one_in(8) {
            return if self.is_tame { 0.0 } else { self.random.round() };
        }
        match index {
            0 => self.random.sign() * self.random.power(-3.0, 1.7),
            1 => self.random.power(0.0, 5.0),
            2 => {
                if self.random.one_in(4) {
                    self.random.between(-50.0, 50.0)
                } else {
                    0.0
                }
            }
            3 => self.random.between(-40.0, 60.0),
            4 => self.random.power(-1.0, 1.5),
            _ => self.random.between(250.0, 600.0),
        }
    }

    fn set_inputs(&mut self) -> Status {
        let mut references = Vec::new();
        let mut values = Vec::new();
        let most = if self.random.one_in(3) { INPUTS } else { 2 };
        for index in 0..most {
            if self.random.below(3) > 0 {
                references.push(index as ValueReference);
                values.push(self.input(index));
            }
        }
        let status = self.importer.set_reals(&references, &values);
        if status == Status::Ok {
            for (reference, value) in references.iter().zip(values) {
                self.inputs[*reference as usize] = value;
            }
        }
        status
    }

    fn set_derivatives(&mut self) -> Status {
        let index = self.random.below(2);
        let slope = if self.is_tame { self.random.sign() * self.random.power(-2.0, 4.0) } else { self.random.any() };
        self.set_slopes(&[index as ValueReference], &[1], &[slope])
    }

    fn length(&mut self) -> f64 {
        if !self.is_tame && self.random.one_in(5) {
            return self.random.any();
        }
        match self.random.below(8) {
            0 => 0.0,
            1 => self.random.round().abs().min(100.0),
            2 => self.random.power(-9.0, 2.0),
            _ => *self.random.pick(&[1e-3, 1e-2, 0.1, 0.1, 1.0]),
        }
    }

    fn step(&mut self) -> Result<Status, String> {
        let length = self.length();
        let mut from = self.importer.time();
        if self.random.one_in(40) {
            from = if self.random.one_in(2) { self.random.any() } else { from + self.random.any() };
        }
        // What doubles the cost of lumped steps is done at some of those of a contact line.
        let careful = !self.is_costly || self.random.one_in(4);
        let before = if careful { self.importer.bytes() } else { Vec::new() };
        let status = self.importer.step(from, length);
        match status {
            Status::Ok => self.check_step(length)?,
            Status::Error if careful => {
                let was_good = self.has_good_inputs() && !self.is_beyond_every_machine();
                let after = self.importer.bytes();
                if let Some(at) = first_difference(&without_phase(before.clone()), &without_phase(after)) {
                    return Err(format!(
                        "a step of {length:e} s that fails changes byte {at} of the state: {:?}",
                        self.importer.take_log()
                    ));
                }
                self.recover(&before, was_good)?;
            }
            Status::Error => {}
            other => return Err(format!("fmi2DoStep returns {other:?}")),
        }
        Ok(status)
    }

    /// Takes over the inputs as the library has them.
    fn read_inputs(&mut self) {
        if let Ok(values) = self.importer.get_reals(&references()) {
            self.inputs.copy_from_slice(&values);
        }
    }

    fn check_step(&mut self, length: f64) -> Verdict {
        let outputs = self.outputs()?.at(self.importer.time());
        // The derivatives moved the inputs.
        self.read_inputs();
        // A step of length 0 moves nothing and refuses no inputs: not even temperatures below 0 K.
        if length == 0.0 {
            self.last = None;
            return Ok(());
        }
        outputs
            .check(self.last.as_ref())
            .map_err(|text| format!("after a step of {length:e} s with inputs {:?}: {text}", self.inputs))?;
        self.last = Some(outputs);
        Ok(())
    }

    /// A restored state goes on: a short step at rest succeeds, unless inputs or state were beyond those of every machine.
    fn recover(&mut self, bytes: &[u8], was_good: bool) -> Verdict {
        let log = self.importer.take_log();
        let mut state = self.importer.deserialize(bytes).map_err(|_| "a saved state is refused")?;
        if self.importer.restore(state) != Status::Ok {
            return Err(format!(
                "a state saved before a failed step cannot be restored: {:?}",
                self.importer.take_log()
            ));
        }
        let was_valid = self.importer.limits() & VALIDITY == 0;
        let rest = [0.0, 0.0, 0.0, 0.0, 0.0, 300.0, 300.0];
        if self.importer.set_reals(&references(), &rest[..INPUTS]) == Status::Ok {
            let status = self.importer.step(self.importer.time(), 1e-3);
            self.note(status);
            if status == Status::Ok {
                let outputs = self.outputs()?.at(self.importer.time());
                outputs.check(None).map_err(|text| format!("after an error and a step at rest: {text}"))?;
            } else {
                let told = self.importer.take_log();
                let is_time =
                    told.iter().any(|(_, text)| text.contains("stop time") || text.contains("communication point"));
                let is_phase = told.iter().any(|(_, text)| text.contains("not allowed in the phase"));
                // A tunable parameter that was set since then.
                let is_tunable = told.iter().any(|(_, text)| text.contains("wear_acceleration"));
                if !is_tunable && !is_time && !is_phase && was_valid && was_good {
                    return Err(format!("after {log:?} and the state before it a step at rest fails: {told:?}"));
                }
            }
        }
        let status = self.importer.restore(state);
        self.note(status);
        let status = self.importer.free(&mut state);
        self.note(status);
        self.importer.take_log();
        // The message of the failed step is judged by the caller.
        self.importer.put_back(log);
        Ok(())
    }

    fn get(&mut self) -> Result<Status, String> {
        let outputs = self.outputs()?;
        // Before initialisation and after an error outputs keep their last values, which may be those of inputs that were
        // refused: only after a step both of these calls are allowed.
        let is_stepping = self.importer.time().is_finite() && self.importer.set_reals(&[], &[]) == Status::Ok;
        if is_stepping && self.has_good_inputs() {
            outputs.check_finite().map_err(|text| format!("read at inputs {:?}: {text}", self.inputs))?;
        }
        Ok(Status::Ok)
    }

    fn save(&mut self) -> Status {
        let slot = self.random.below(SLOTS);
        self.importer.save(&mut self.states[slot])
    }

    fn restore(&mut self) -> Status {
        let slot = self.random.below(SLOTS);
        let status = self.importer.restore(self.states[slot]);
        if status == Status::Ok {
            self.last = None;
            self.read_inputs();
        }
        status
    }

    /// Steps, goes back, and steps again: the same bits.
    fn replay(&mut self) -> Result<Status, String> {
        let mut state = ptr::null_mut();
        if self.importer.save(&mut state) != Status::Ok {
            return Err("fmi2GetFMUstate fails".into());
        }
        let (length, time) = (self.length(), self.importer.time());
        let first = self.importer.step(time, length);
        let outputs = self.outputs()?;
        let told = self.importer.take_log();
        let restored = self.importer.restore(state);
        if restored != Status::Ok {
            return Err(format!("a saved state cannot be restored: {:?}", self.importer.take_log()));
        }
        let second = self.importer.step(time, length);
        let again = self.outputs()?;
        if first != second {
            return Err(format!("a step of {length:e} s returns {first:?}, repeated {second:?}: {told:?}"));
        }
        if let Some(text) = outputs.difference(&again) {
            return Err(format!("a step of {length:e} s that is repeated gives other bits: {text}"));
        }
        let status = self.importer.restore(state);
        self.note(status);
        let status = self.importer.free(&mut state);
        self.note(status);
        self.importer.take_log();
        Ok(Status::Ok)
    }

    fn set_parameters(&mut self) -> Status {
        let reference = self.random.below(COUNT) as ValueReference;
        let row = &TABLE[FLAT[reference as usize].0 as usize];
        if row.causality != Causality::Parameter || row.name == "solver.fidelity" || row.name == "solver.cells" {
            return Status::Ok;
        }
        let value = self.random.parameter(row, row.start_of(0).unwrap_or(1.0));
        match row.kind {
            Kind::Real { .. } => self.importer.set_reals(&[reference], &[value]),
            Kind::Boolean => self.importer.set_boolean(reference, value as i32),
            Kind::Integer { .. } | Kind::Enumeration(_) => self.importer.set_integer(reference, value as i32),
        }
    }
}
