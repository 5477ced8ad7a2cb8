//! Runs a row of the table.

use std::collections::HashMap;
use std::ptr;
use std::sync::LazyLock;

use scene::variables::{COUNT, Causality, FLAT, Kind, STARTS, TABLE, lookup};
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, FmuState, Status};

use test_support::importer::{Entry, Importer, reference};

/// Level of the model, with the cells of its contact line.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Level {
    /// Uniform pressure.
    Lumped,
    /// 9 cells, without thermal expansion: lumped heat.
    Cold,
    /// 9 cells with resolved heat.
    Hot,
    /// Chosen by the plan.
    Auto,
}

impl Level {
    fn parameters(self) -> &'static [(&'static str, f64)] {
        match self {
            Level::Lumped => &[("solver.fidelity", 2.0)],
            Level::Cold => &[
                ("solver.fidelity", 3.0),
                ("solver.cells", 9.0),
                ("punch.thermal_expansion", 0.0),
                ("strip.thermal_expansion", 0.0),
            ],
            Level::Hot => &[("solver.fidelity", 3.0), ("solver.cells", 9.0)],
            Level::Auto => &[("solver.fidelity", 1.0)],
        }
    }
}

/// One call of the interface.
#[derive(Clone, Copy)]
pub enum Call {
    /// `fmi2SetReal`, `fmi2SetInteger` or `fmi2SetBoolean`, by the variable's type.
    Set(&'static str, f64),
    /// `fmi2SetRealInputDerivatives` of order 1.
    Slope(&'static str, f64),
    /// `fmi2DoStep` from the communication point.
    Step(f64),
    /// As many of them, up to the first that is refused.
    Steps(f64, usize),
    /// `fmi2DoStep` from a time.
    StepFrom(f64, f64),
    /// `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialise,
    /// Any other.
    Other(fn(&Importer) -> Status),
}

/// A row of the table.
pub struct Case {
    /// The hostile part.
    pub what: &'static str,
    pub levels: &'static [Level],
    /// Name of an example scene; the stock scene if it is empty.
    pub example: &'static str,
    /// Parameters, all of them accepted.
    pub scene: &'static [(&'static str, f64)],
    /// Phase in which the calls begin.
    pub from: From,
    pub calls: &'static [Call],
    /// Status of the last call.
    pub status: Status,
    /// Parts of its message; with `fmi2OK`, of a warning that is logged on the way.
    pub says: &'static [&'static str],
}

/// Phase in which the calls of a row begin.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum From {
    Instantiated,
    /// After three steps.
    Stepping,
}

/// Communication steps before and after the hostile calls.
const USUAL_STEPS: usize = 3;
const USUAL: [Call; 3] = [Call::Set("sliding_velocity", 2.0), Call::Set("normal_load", 2e3), Call::Step(0.01)];

/// Bytes of a serialised state before its GUID; the phase is the first byte behind the GUID.
const HEADER: usize = 20;
const CHECKSUM: core::ops::Range<usize> = 12..20;

/// Start values of the example scenes.
static EXAMPLES: LazyLock<HashMap<&'static str, [f64; COUNT]>> = LazyLock::new(|| {
    let names = test_support::scenes().map(|(name, ..)| name);
    names.into_iter().map(|name| (name, test_support::scene(name))).collect()
});

fn kind(name: &str) -> Kind {
    TABLE[FLAT[reference(name) as usize].0 as usize].kind
}

/// Sets a variable by the function of its type.
pub fn set(importer: &Importer, name: &str, value: f64) -> Status {
    match kind(name) {
        Kind::Real { .. } => importer.set_real(&[name], &[value]),
        Kind::Integer { .. } | Kind::Enumeration(_) => importer.set_integer(name, value as i32),
        Kind::Boolean => importer.set_boolean(name, value as i32),
    }
}

/// Communication point.
fn time(importer: &Importer) -> f64 {
    let mut time = f64::NAN;
    // SAFETY: the place is there.
    let _ = unsafe { fmi2GetRealStatus(importer.component, types::LAST_SUCCESSFUL_TIME, &mut time) };
    time
}

impl Call {
    fn make(self, importer: &Importer) -> Status {
        match self {
            Call::Set(name, value) => set(importer, name, value),
            Call::Slope(name, value) => importer.set_derivative(name, 1, value),
            Call::Step(step) => importer.step(time(importer), step),
            Call::Steps(step, count) => {
                let mut made = (0..count).map(|_| Call::Step(step).make(importer));
                made.find(|status| *status != Status::Ok).unwrap_or(Status::Ok)
            }
            Call::StepFrom(from, step) => importer.step(from, step),
            Call::Initialise => match importer.enter() {
                Status::Ok => importer.exit(),
                refused => refused,
            },
            Call::Other(call) => call(importer),
        }
    }
}

/// References of every Real output and local.
pub static OUTPUTS: LazyLock<Vec<u32>> = LazyLock::new(|| {
    let calculated = |reference: &u32| {
        let row = &TABLE[FLAT[*reference as usize].0 as usize];
        matches!(row.causality, Causality::Output | Causality::Local) && matches!(row.kind, Kind::Real { .. })
    };
    (0..COUNT as u32).filter(calculated).collect()
});

/// The first output that is not finite, or an `estimated_error` that is none.
pub fn nonsense(importer: &Importer) -> Option<String> {
    let values = match importer.get_reals(&OUTPUTS) {
        Ok(values) => values,
        Err(status) => return Some(format!("fmi2GetReal returns {status:?}")),
    };
    let name = |reference: u32| lookup(reference).map_or_else(String::new, |(row, element)| row.element_name(element));
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Some(format!("{} = {}", name(OUTPUTS[at]), values[at]));
    }
    let estimated = importer.get_real("estimated_error");
    (!(0.0..=1.0).contains(&estimated)).then(|| format!("estimated_error = {estimated}"))
}

/// The bytes of a state without phase and checksum.
fn without_phase(mut bytes: Vec<u8>) -> Vec<u8> {
    let guid = usize::from(u16::from_le_bytes([bytes[6], bytes[7]]));
    bytes[HEADER + guid] = 0;
    bytes[CHECKSUM].fill(0);
    bytes
}

/// Gives an instance the parameters of a level and a scene; it is not initialised.
pub fn set_up(importer: &Importer, level: Level, example: &str, scene: &[(&str, f64)]) -> Result<(), String> {
    let differs = |(index, value): &(usize, f64)| *value != STARTS[*index];
    let starts = EXAMPLES.get(example).map(|starts| starts.iter().copied().enumerate().filter(differs));
    let starts = starts.into_iter().flatten().filter_map(|(index, value)| {
        let (row, element) = lookup(index as u32)?;
        (row.causality == Causality::Parameter).then(|| (row.element_name(element), value))
    });
    let parameters = level.parameters().iter().chain(scene).map(|(name, value)| ((*name).to_owned(), *value));
    for (name, value) in starts.chain(parameters) {
        let status = set(importer, &name, value);
        if status != Status::Ok {
            return Err(format!("{name} = {value} is refused with {status:?}: {:?}", importer.take_log()));
        }
    }
    match importer.setup(None, 0.0, None) {
        Status::Ok => Ok(()),
        status => Err(format!("fmi2SetupExperiment returns {status:?}")),
    }
}

/// Initialises where that is still to be done, and makes the usual steps; the bits of every output after each.
fn usual(importer: &Importer, from: From, steps: usize) -> Result<Vec<u64>, String> {
    let failed = |what: &str, status| Err(format!("{what} returns {status:?}: {:?}", importer.take_log()));
    if from == From::Instantiated {
        let status = Call::Initialise.make(importer);
        if status != Status::Ok {
            return failed("a usual initialisation", status);
        }
    }
    let mut bits = Vec::new();
    for _ in 0..steps {
        for call in USUAL {
            let status = call.make(importer);
            if status != Status::Ok {
                return failed("a usual step", status);
            }
        }
        if let Some(text) = nonsense(importer) {
            return Err(format!("after a usual step {text}"));
        }
        bits.extend(importer.get_reals(&OUTPUTS).unwrap_or_default().iter().map(|value| value.to_bits()));
    }
    Ok(bits)
}

fn saved(importer: &Importer) -> Result<FmuState, String> {
    let mut state = ptr::null_mut();
    match importer.save(&mut state) {
        Status::Ok => Ok(state),
        status => Err(format!("fmi2GetFMUstate returns {status:?}")),
    }
}

/// Whether the log has what the row requires.
fn is_told(case: &Case, log: &[Entry]) -> bool {
    let status = if case.status == Status::Ok { Status::Warning } else { case.status };
    let whole = |text: &str| case.says.iter().all(|part| text.contains(part));
    (case.status == Status::Ok && case.says.is_empty()) || log.iter().any(|entry| entry.0 == status && whole(&entry.2))
}

/// Runs rows.
#[derive(Default)]
pub struct Runner {
    /// An instance for every level and scene, which is reset before it is used again.
    instances: HashMap<String, Importer>,
    /// Outputs of the usual steps of instances that never had another call.
    references: HashMap<String, Vec<u64>>,
}

impl Runner {
    /// Runs a row at a level.
    ///
    /// # Errors
    /// Deviations from the requirements of the row.
    pub fn run(&mut self, case: &Case, level: Level) -> Result<(), String> {
        let (example, scene, from) = (case.example, case.scene, case.from);
        let key = format!("{level:?} {example} {scene:?}");
        let expected = format!("{key} {}", from == From::Stepping);
        if !self.references.contains_key(&expected) {
            let other = Importer::with_logging(false);
            set_up(&other, level, example, scene)?;
            if from == From::Stepping {
                usual(&other, From::Instantiated, USUAL_STEPS)?;
            }
            let bits = usual(&other, from, USUAL_STEPS)?;
            self.references.insert(expected.clone(), bits);
        }
        let importer = self.instances.entry(key).or_insert_with(|| Importer::with_logging(false));
        if importer.reset() != Status::Ok {
            return Err("fmi2Reset fails".into());
        }
        set_up(importer, level, example, scene)?;
        if from == From::Stepping {
            usual(importer, From::Instantiated, USUAL_STEPS)?;
        }
        let own = case.run(importer)?;
        if own != self.references[&expected] {
            return Err("the steps that follow differ from those of an instance without the call".into());
        }
        Ok(())
    }
}

impl Case {
    /// Makes the calls and the usual steps behind them; the bits of every output after each of those.
    fn run(&self, importer: &Importer) -> Result<Vec<u64>, String> {
        let mut state = saved(importer)?;
        importer.take_log();
        self.hostile_calls(importer)?;
        let is_refused = self.status != Status::Ok;
        // A refused call that was the only one and leaves the phase as it was needs no saved state.
        let goes_on =
            is_refused && self.calls.len() == 1 && importer.bytes() == importer.serialize(state).unwrap_or_default();
        if !goes_on && importer.restore(state) != Status::Ok {
            return Err(format!("the state saved before is refused: {:?}", importer.take_log()));
        }
        let bits = usual(importer, self.from, USUAL_STEPS)?;
        match importer.free(&mut state) {
            Status::Ok => Ok(bits),
            status => Err(format!("fmi2FreeFMUstate returns {status:?}")),
        }
    }

    /// Makes the calls of the row and judges the last one.
    fn hostile_calls(&self, importer: &Importer) -> Result<(), String> {
        let (last, first) = self.calls.split_last().ok_or("no calls")?;
        let is_read = self
            .calls
            .iter()
            .any(|call| matches!(call, Call::Step(_) | Call::Steps(..) | Call::StepFrom(..) | Call::Initialise));
        let has_outputs =
            |call: &Call| matches!(call, Call::Step(_) | Call::Steps(..) | Call::StepFrom(..) | Call::Initialise);
        for (number, call) in first.iter().enumerate() {
            let status = call.make(importer);
            if status != Status::Ok {
                return Err(format!("call {} returns {status:?}: {:?}", number + 1, importer.take_log()));
            }
            if let Some(text) = Some(call).filter(|call| has_outputs(call)).and_then(|_| nonsense(importer)) {
                return Err(format!("after call {} {text}", number + 1));
            }
        }
        if self.status != Status::Ok {
            importer.take_log();
        }
        // To leave initialisation is the call that is judged.
        let last = match last {
            Call::Initialise if importer.enter() == Status::Ok => &Call::Other(Importer::exit),
            other => other,
        };
        let before = importer.bytes();
        let status = last.make(importer);
        let log = importer.take_log();
        if status != self.status {
            return Err(format!("{status:?} in place of {:?}: {log:?}", self.status));
        }
        if !is_told(self, &log) {
            return Err(format!("no message with {:?}: {log:?}", self.says));
        }
        // A NaN is told where it was given, never as the result of a computation.
        if log
            .iter()
            .any(|entry| entry.2.contains("NaN") && !entry.2.contains("finite") && !entry.2.contains("point NaN"))
        {
            return Err(format!("a message with a result that is no number: {log:?}"));
        }
        if status == Status::Ok {
            return nonsense(importer).filter(|_| is_read).map_or(Ok(()), |text| Err(format!("fmi2OK with {text}")));
        }
        let after = importer.bytes();
        if after == before {
            return Ok(());
        }
        if without_phase(before) != without_phase(after) {
            return Err(format!("a refused call changes the state: {log:?}"));
        }
        // In the error phase every further step is refused.
        match Call::Step(0.01).make(importer) {
            Status::Error => Ok(()),
            status => Err(format!("a step in the error phase returns {status:?}")),
        }
    }
}
