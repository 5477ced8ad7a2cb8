//! Tables of the admissible call sequences, of the phases in which each variable may be set, and of the status of each refusal.
//!
//! The phases are those of the co-simulation state machine (FMI 2.0.4, section 4.2.4). Steps are
//! synchronous and never return `fmi2Discard`, so *step in progress*, *step failed* and *step
//! canceled* do not occur; `fmi2Fatal` is never returned, so there is no phase for it either.
//!
//! Accepted beyond the standard, because importers do it and it is unambiguous: inputs set while
//! instantiated; any variable read in any phase (the start or the last value); `fmi2SetupExperiment`
//! omitted (start time 0, no stop time, no tolerance) or repeated; `fmi2Terminate` after an error.
//!
//! # Phase transitions
//!
//! | function | phase after success | after failure |
//! |---|---|---|
//! | `fmi2EnterInitializationMode` | initialization mode | error |
//! | `fmi2ExitInitializationMode` | step complete | error |
//! | `fmi2DoStep` | step complete | error |
//! | `fmi2Terminate` | terminated | - |
//! | `fmi2Reset` | instantiated | - |
//! | `fmi2SetFMUstate` | that of the FMU state | as before |
//!
//! Failure means that the model failed ([`Fault::Initialisation`], [`Fault::Step`], and
//! [`Fault::Panic`] in any function). A call that is refused before the model is evaluated, for its order
//! or its arguments, leaves the instance unchanged.

#![forbid(unsafe_code)]

use super::types::Status;
use scene::variables::{COUNT, Causality, FLAT, Kind, TABLE, ValueReference, Variability};

/// Phase of an instance. The discriminants are the bits of the masks.
#[repr(u8)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Phase {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated = 1,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization = 2,
    /// Initialised, between two steps.
    StepComplete = 4,
    /// After `fmi2Terminate`.
    Terminated = 8,
    /// After a failed initialisation or step.
    Error = 16,
}

impl Phase {
    /// Every phase with its name in messages.
    pub(crate) const ALL: [(Phase, &'static str); 5] = [
        (Phase::Instantiated, "instantiated"),
        (Phase::Initialization, "initialization mode"),
        (Phase::StepComplete, "step complete"),
        (Phase::Terminated, "terminated"),
        (Phase::Error, "error"),
    ];

    /// The phase of a bit, as it stands in a serialised FMU state.
    pub(crate) fn from_bit(bit: u8) -> Option<Phase> {
        Phase::ALL.iter().map(|entry| entry.0).find(|&phase| phase as u8 == bit)
    }
}

/// A set of phases.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Phases(u8);

impl Phases {
    /// Whether `phase` is in the set.
    #[inline(always)]
    pub(crate) const fn contains(self, phase: Phase) -> bool {
        self.0 & phase as u8 != 0
    }

    const fn and(self, other: Phases) -> Phases {
        Phases(self.0 | other.0)
    }

    /// The names of the phases, for messages.
    pub(crate) fn names(self) -> String {
        let names: Vec<_> =
            Phase::ALL.iter().filter(|&&(phase, _)| self.contains(phase)).map(|&(_, name)| name).collect();
        if names.is_empty() { "no phase".into() } else { names.join(", ") }
    }
}

const NEVER: Phases = Phases(0);
const INSTANTIATED: Phases = Phases(Phase::Instantiated as u8);
const INITIALIZATION: Phases = Phases(Phase::Initialization as u8);
const BEFORE: Phases = INSTANTIATED.and(INITIALIZATION);
const STEP_COMPLETE: Phases = Phases(Phase::StepComplete as u8);
const UNTIL_TERMINATED: Phases = BEFORE.and(STEP_COMPLETE);
const FAILED: Phases = Phases(Phase::Error as u8);
const STEPPED: Phases = STEP_COMPLETE.and(Phases(Phase::Terminated as u8)).and(FAILED);
const ANY: Phases = BEFORE.and(STEPPED);

/// One row of the table of call sequences.
pub(crate) struct Rule {
    /// Name of the function in C.
    pub name: &'static str,
    /// Phases in which it may be called.
    pub allowed: Phases,
}

macro_rules! call_sequences {
    ($($function:ident = $name:literal, $allowed:expr;)*) => {
        /// The functions that take an instance, except `fmi2FreeInstance`, which is allowed in every phase.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub(crate) enum Function {
            $(#[doc = $name] $function,)*
        }

        /// The call sequences, in the order of [`Function`].
        const RULES: &[Rule] = &[$(Rule { name: $name, allowed: $allowed }),*];
    };
}

call_sequences! {
    SetDebugLogging = "fmi2SetDebugLogging", ANY;
    SetupExperiment = "fmi2SetupExperiment", INSTANTIATED;
    EnterInitializationMode = "fmi2EnterInitializationMode", INSTANTIATED;
    ExitInitializationMode = "fmi2ExitInitializationMode", INITIALIZATION;
    Terminate = "fmi2Terminate", STEP_COMPLETE.and(FAILED);
    Reset = "fmi2Reset", ANY;
    GetReal = "fmi2GetReal", ANY;
    GetInteger = "fmi2GetInteger", ANY;
    GetBoolean = "fmi2GetBoolean", ANY;
    GetString = "fmi2GetString", ANY;
    // The phases in which a variable may be set are in `ACCESS`.
    SetReal = "fmi2SetReal", UNTIL_TERMINATED;
    SetInteger = "fmi2SetInteger", UNTIL_TERMINATED;
    SetBoolean = "fmi2SetBoolean", UNTIL_TERMINATED;
    SetString = "fmi2SetString", UNTIL_TERMINATED;
    GetFmuState = "fmi2GetFMUstate", ANY;
    SetFmuState = "fmi2SetFMUstate", ANY;
    FreeFmuState = "fmi2FreeFMUstate", ANY;
    SerializedFmuStateSize = "fmi2SerializedFMUstateSize", ANY;
    SerializeFmuState = "fmi2SerializeFMUstate", ANY;
    DeSerializeFmuState = "fmi2DeSerializeFMUstate", ANY;
    GetDirectionalDerivative = "fmi2GetDirectionalDerivative", INITIALIZATION.and(STEPPED);
    SetRealInputDerivatives = "fmi2SetRealInputDerivatives", UNTIL_TERMINATED;
    GetRealOutputDerivatives = "fmi2GetRealOutputDerivatives", STEPPED;
    DoStep = "fmi2DoStep", STEP_COMPLETE;
    // Steps are synchronous: none can be in progress during another call.
    CancelStep = "fmi2CancelStep", NEVER;
    GetStatus = "fmi2GetStatus", STEPPED;
    GetRealStatus = "fmi2GetRealStatus", STEPPED;
    GetIntegerStatus = "fmi2GetIntegerStatus", STEPPED;
    GetBooleanStatus = "fmi2GetBooleanStatus", STEPPED;
    GetStringStatus = "fmi2GetStringStatus", STEPPED;
    // Of model exchange: refused in every phase for what they are ([`Fault::ModelExchange`]), not for their order.
    EnterEventMode = "fmi2EnterEventMode", ANY;
    NewDiscreteStates = "fmi2NewDiscreteStates", ANY;
    EnterContinuousTimeMode = "fmi2EnterContinuousTimeMode", ANY;
    CompletedIntegratorStep = "fmi2CompletedIntegratorStep", ANY;
    SetTime = "fmi2SetTime", ANY;
    SetContinuousStates = "fmi2SetContinuousStates", ANY;
    GetDerivatives = "fmi2GetDerivatives", ANY;
    GetEventIndicators = "fmi2GetEventIndicators", ANY;
    GetContinuousStates = "fmi2GetContinuousStates", ANY;
    GetNominalsOfContinuousStates = "fmi2GetNominalsOfContinuousStates", ANY;
}

impl Function {
    /// The function's row.
    #[inline(always)]
    pub(crate) const fn rule(self) -> &'static Rule {
        &RULES[self as usize]
    }

    /// Whether the call always computes. Getting and setting values mostly copies numbers; where it computes, it sees to the
    /// floating-point environment itself.
    #[inline(always)]
    pub(crate) const fn computes(self) -> bool {
        use Function::{GetBoolean, GetInteger, GetReal, SetBoolean, SetInteger, SetReal};
        !matches!(self, GetReal | GetInteger | GetBoolean | SetReal | SetInteger | SetBoolean)
    }
}

/// Type of a variable at the interface; enumerations are integers.
#[repr(u8)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Type {
    /// `fmi2Real`
    Real = 1,
    /// `fmi2Integer`, enumerations included
    Integer = 2,
    /// `fmi2Boolean`
    Boolean = 3,
}

impl Type {
    /// Name in messages.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Type::Real => "Real",
            Type::Integer => "Integer or enumeration",
            Type::Boolean => "Boolean",
        }
    }
}

/// Type, role and settable phases of a variable in one byte: bits 0..5 the phases in which it may be
/// set, bits 5..7 the type (0: no such variable), bit 7 whether it is an input.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Access(u8);

impl Access {
    const NONE: Access = Access(0);
    const TYPE_SHIFT: u32 = 5;
    const INPUT: u8 = 0x80;

    const fn of(row: &scene::variables::Row) -> Access {
        let settable = match (row.causality, row.variability) {
            (Causality::Parameter, Variability::Tunable) => UNTIL_TERMINATED,
            (Causality::Parameter, _) => BEFORE,
            (Causality::Input, _) => UNTIL_TERMINATED,
            (Causality::Output | Causality::Local, _) => NEVER,
        };
        let kind = match row.kind {
            Kind::Real { .. } => Type::Real,
            Kind::Integer { .. } | Kind::Enumeration(_) => Type::Integer,
            Kind::Boolean => Type::Boolean,
        };
        let input = if matches!(row.causality, Causality::Input) { Access::INPUT } else { 0 };
        Access(settable.0 | (kind as u8) << Access::TYPE_SHIFT | input)
    }

    /// Whether the variable exists and is of type `kind`.
    #[inline(always)]
    pub(crate) const fn is(self, kind: Type) -> bool {
        (self.0 >> Access::TYPE_SHIFT) & 3 == kind as u8
    }

    /// Whether the variable is an input.
    #[inline(always)]
    pub(crate) const fn is_input(self) -> bool {
        self.0 & Access::INPUT != 0
    }

    /// Phases in which the variable may be set.
    #[inline(always)]
    pub(crate) const fn settable(self) -> Phases {
        Phases(self.0 & 31)
    }
}

static ACCESS: [Access; COUNT] = {
    let mut table = [Access::NONE; COUNT];
    let mut reference = 0;
    while reference < COUNT {
        table[reference] = Access::of(&TABLE[FLAT[reference].0 as usize]);
        reference += 1;
    }
    table
};

/// Access rights of a value reference.
#[inline(always)]
pub(crate) fn access(reference: ValueReference) -> Access {
    ACCESS.get(reference as usize).copied().unwrap_or(Access::NONE)
}

/// Reason for the failure of a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Fault {
    /// Not allowed in this phase.
    Order,
    /// A pointer is NULL, a number out of range, an order that is not offered, time that does not fit.
    Argument,
    /// Unknown value reference, wrong type, or a variable that may not be set (now).
    Reference,
    /// A parameter's value was refused.
    Value,
    /// A status that this slave does not have.
    Nothing,
    /// A function of model exchange.
    ModelExchange,
    /// An output or a derivative that does not exist at the present inputs.
    Undefined,
    /// An FMU state that is unknown, damaged, or of another FMU.
    State,
    /// The model cannot be initialised with these parameters.
    Initialisation,
    /// A step failed, also for inputs that are no numbers.
    Step,
    /// A defect of this library, caught.
    Panic,
}

impl Fault {
    /// The status that a call with this fault returns.
    pub(crate) const fn status(self) -> Status {
        match self {
            Fault::Value | Fault::Nothing => Status::Discard,
            _ => Status::Error,
        }
    }

    /// Whether the instance is in the error phase afterwards.
    pub(crate) const fn fails_instance(self) -> bool {
        matches!(self, Fault::Initialisation | Fault::Step | Fault::Panic)
    }
}

/// Highest order of the input derivatives that are taken.
pub(crate) const INPUT_DERIVATIVE_ORDER: i32 = 1;

/// Tolerance for the equality of two times, in seconds: `1e-9 max(1, |t|)`.
///
/// Used for the communication point against the end of the last step, and for the end of a step against the
/// stop time. Masters add up steps in their own arithmetic; the largest difference found in practice is that
/// of a clock in whole nanoseconds.
pub(crate) fn same_time_within(time: f64) -> f64 {
    1e-9 * time.abs().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::lookup;

    #[test]
    fn every_variable_has_one_type_and_only_parameters_and_inputs_can_be_set() {
        for reference in 0..COUNT as u32 {
            let access = access(reference);
            let kinds = [Type::Real, Type::Integer, Type::Boolean];
            assert_eq!(kinds.iter().filter(|&&kind| access.is(kind)).count(), 1);
            let row = lookup(reference).unwrap().0;
            let is_set = matches!(row.causality, Causality::Parameter | Causality::Input);
            assert_eq!(access.settable() != NEVER, is_set, "{}", row.name);
        }
    }

    #[test]
    fn a_phase_comes_back_from_its_bit_and_no_other_number_is_one() {
        let phases = (0..=255).filter_map(Phase::from_bit).collect::<Vec<_>>();
        assert_eq!(phases, Phase::ALL.map(|entry| entry.0));
    }
}
