//! Runs a row of the table.

use std::collections::HashMap;
use std::panic::{self, AssertUnwindSafe};
use std::ptr;
use std::sync::LazyLock;

use scene::variables::{COUNT, Causality, FLAT, Kind, STARTS, TABLE, lookup};
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, FmuState, Status};

use test_support::importer::{Entry, Importer, reference};
use test_support::real_outputs;

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
#[derive(Clone)]
pub enum Call {
    /// `fmi2SetReal`, `fmi2SetInteger` or `fmi2SetBoolean`, by the variable's type.
    Set(String, f64),
    /// `fmi2SetRealInputDerivatives` of order 1.
    Slope(String, f64),
    /// `fmi2DoStep` from the communication point, as many times, up to the first that is refused.
    Steps(f64, usize),
    /// `fmi2SetupExperiment` with a tolerance and a start time.
    SetUp(Option<f64>, f64),
    /// `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialise,
    /// Any other.
    Other(fn(&Importer) -> Status),
}

/// A row of the table.
pub struct Case {
    /// The hostile part.
    pub what: String,
    pub levels: Vec<Level>,
    /// Name of an example scene; the stock scene if it is empty.
    pub example: String,
    /// Parameters, all of them accepted.
    pub scene: Vec<(String, f64)>,
    /// Phase in which the calls begin.
    pub from: From,
    pub calls: Vec<Call>,
    /// Status of the last call; `None`: `fmi2OK`, or a refusal with a message.
    pub status: Option<Status>,
    /// Parts of its message; with `fmi2OK`, of a warning that is logged on the way.
    pub says: Vec<String>,
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
const USUAL: [(&str, f64); 2] = [("sliding_velocity", 2.0), ("normal_load", 2e3)];

/// Bytes of a serialised state before its GUID; the phase is the first byte behind the GUID.
const HEADER: usize = 20;
const CHECKSUM: core::ops::Range<usize> = 12..20;

/// Start values of the example scenes.
static EXAMPLES: LazyLock<HashMap<&'static str, [f64; COUNT]>> = LazyLock::new(|| {
    let names = test_support::scenes().map(|(name, ..)| name);
    names.into_iter().map(|name| (name, test_support::scene(name))).collect()
});

pub fn kind(name: &str) -> Kind {
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
    fn make(&self, importer: &Importer) -> Status {
        match self {
            Call::Set(name, value) => set(importer, name, *value),
            Call::Slope(name, value) => importer.set_derivative(name, 1, *value),
            Call::Steps(step, count) => {
                let mut made = (0..*count).map(|_| importer.step(time(importer), *step));
                made.find(|status| *status != Status::Ok).unwrap_or(Status::Ok)
            }
            Call::SetUp(tolerance, start) => importer.setup(*tolerance, *start, None),
            Call::Initialise => match importer.enter() {
                Status::Ok => importer.exit(),
                refused => refused,
            },
            Call::Other(call) => call(importer),
        }
    }

    /// Whether outputs are judged after it.
    fn has_outputs(&self) -> bool {
        matches!(self, Call::Steps(..) | Call::Initialise)
    }
}

/// References of every Real output and local.
static OUTPUTS: LazyLock<Vec<u32>> = LazyLock::new(real_outputs);

/// The first output that is not finite, or an `estimated_error` that is none.
pub(crate) fn nonsense(importer: &Importer) -> Option<String> {
    let values = match importer.get_reals(&OUTPUTS) {
        Ok(values) => values,
        Err(status) => return Some(format!("fmi2GetReal returns {status:?}")),
    };
    let name = |reference: u32| lookup(reference).map_or_else(String::new, |(row, element)| row.element_name(element));
    // Bodies of a few modes undershoot where a face is at temperatures that no contact has.
    let is_valid = importer.get_integer("limit_reached").is_ok_and(|bits| bits & 4 == 0);
    for (&reference, value) in OUTPUTS.iter().zip(values) {
        let name = name(reference);
        if !value.is_finite() || is_valid && value < 0.0 && name.contains("temperature") && !name.contains("rate") {
            return Some(format!("{name} = {value}"));
        }
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
pub fn set_up(importer: &Importer, level: Level, example: &str, scene: &[(String, f64)]) -> Result<(), String> {
    let differs = |(index, value): &(usize, f64)| *value != STARTS[*index];
    let starts = EXAMPLES.get(example).map(|starts| starts.iter().copied().enumerate().filter(differs));
    let starts = starts.into_iter().flatten().filter_map(|(index, value)| {
        let (row, element) = lookup(index as u32)?;
        (row.causality == Causality::Parameter).then(|| (row.element_name(element), value))
    });
    let level = level.parameters().iter().map(|(name, value)| ((*name).to_owned(), *value));
    for (name, value) in starts.chain(level).chain(scene.iter().cloned()) {
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
        let calls = USUAL.map(|(name, value)| Call::Set(name.to_owned(), value));
        for call in calls.iter().chain([&Call::Steps(0.01, 1)]) {
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
fn is_told(case: &Case, status: Status, log: &[Entry]) -> bool {
    let silent = status == Status::Ok && case.says.is_empty();
    let status = if status == Status::Ok { Status::Warning } else { status };
    let whole = |text: &str| case.says.iter().all(|part| text.contains(part));
    silent || log.iter().any(|entry| entry.0 == status && whole(&entry.2))
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
        let (example, scene, from) = (&case.example[..], &case.scene[..], case.from);
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
        let is_refused = self.hostile_calls(importer)? != Status::Ok;
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

    /// Makes the calls of the row and judges the last one; its status.
    fn hostile_calls(&self, importer: &Importer) -> Result<Status, String> {
        let (last, first) = self.calls.split_last().ok_or("no calls")?;
        for (number, call) in first.iter().enumerate() {
            let status = call.make(importer);
            if status != Status::Ok {
                return Err(format!("call {} returns {status:?}: {:?}", number + 1, importer.take_log()));
            }
            if let Some(text) = Some(call).filter(|call| call.has_outputs()).and_then(|_| nonsense(importer)) {
                return Err(format!("after call {} {text}", number + 1));
            }
        }
        // To leave initialisation is the call that is judged.
        let last = match last {
            Call::Initialise if importer.enter() == Status::Ok => &Call::Other(Importer::exit),
            other => other,
        };
        let (before, earlier) = (importer.bytes(), importer.take_log());
        let status = last.make(importer);
        let mut log = importer.take_log();
        if self.status.is_some_and(|expected| status != expected) {
            return Err(format!("{status:?} in place of {:?}: {log:?}", self.status));
        }
        if status == Status::Ok {
            log.extend(earlier);
        }
        if !is_told(self, status, &log) {
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
            let is_read = self.calls.iter().any(Call::has_outputs);
            return nonsense(importer)
                .filter(|_| is_read)
                .map_or(Ok(status), |text| Err(format!("fmi2OK with {text}")));
        }
        let after = importer.bytes();
        if after == before {
            return Ok(status);
        }
        if without_phase(before) != without_phase(after) {
            return Err(format!("a refused call changes the state: {log:?}"));
        }
        // In the error phase every further step is refused.
        match Call::Steps(0.01, 1).make(importer) {
            Status::Error => Ok(status),
            other => Err(format!("a step in the error phase returns {other:?}")),
        }
    }
}

/// Runs rows.
pub fn check(cases: &[Case]) {
    let (mut runner, mut failures) = (Runner::default(), Vec::new());
    for case in cases {
        for &level in &case.levels {
            let run = panic::catch_unwind(AssertUnwindSafe(|| runner.run(case, level)));
            if let Err(text) = run.unwrap_or_else(|_| Err("panicked".into())) {
                failures.push(format!("{}, {level:?}: {text}", case.what));
            }
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}
