//! Reason for refusing a call: the fault, and a sentence for the log that names variable, value and limit.

#![forbid(unsafe_code)]

use crate::fmi2::policy::{self, Fault, Phase, Type};
use crate::fmi2::registry::Refused;
use crate::fmi2::types::{DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, PENDING_STATUS, StatusKind, TERMINATED};
use scene::variables::{self, COUNT, Causality, ValueReference, Variability};

/// A refused or failed call.
#[derive(Debug)]
pub(crate) struct Problem {
    /// Kind of problem, which determines status and phase.
    pub fault: Fault,
    /// One sentence.
    pub text: String,
}

/// Of a call.
pub(crate) type Outcome = Result<(), Problem>;

/// A bad argument.
#[cold]
pub(crate) fn argument<T>(text: impl Into<String>) -> Result<T, Problem> {
    Err(Problem { fault: Fault::Argument, text: text.into() })
}

/// A bad FMU state.
#[cold]
pub(crate) fn state<T>(text: impl Into<String>) -> Result<T, Problem> {
    Err(Problem { fault: Fault::State, text: text.into() })
}

/// A handle that is no FMU state.
#[cold]
pub(crate) fn unknown_state(refused: Refused) -> Problem {
    let text = match refused {
        Refused::Unknown => "the FMU state is NULL, was freed, or never came from this FMU",
        Refused::Busy => "the FMU state is in use by another call",
    };
    Problem { fault: Fault::State, text: text.into() }
}

/// Name of a phase in messages.
pub(crate) fn phase_name(phase: Phase) -> &'static str {
    Phase::ALL.iter().find(|entry| entry.0 == phase).map_or("", |entry| entry.1)
}

/// The problem of a value reference that the call cannot access. `wanted`: the type, `None` for String; `setting`: the
/// phase in which it was to be set, `None` where it was to be read.
#[cold]
pub(crate) fn reference_problem(reference: ValueReference, wanted: Option<Type>, setting: Option<Phase>) -> Problem {
    let access = policy::access(reference);
    let text = match variables::lookup(reference) {
        None => format!("the value reference {reference} is unknown; they run from 0 to {}", COUNT - 1),
        Some((row, element)) => {
            let name = row.element_name(element);
            let actual = [Type::Real, Type::Integer, Type::Boolean].into_iter().find(|&kind| access.is(kind));
            if actual != wanted {
                format!(
                    "{name} (value reference {reference}) is {}, not {}",
                    actual.map_or("", Type::name),
                    wanted.map_or("String", Type::name)
                )
            } else if matches!(row.causality, Causality::Output | Causality::Local) {
                format!("{name} is calculated by the FMU and cannot be set")
            } else {
                let kind = match (row.causality, row.variability) {
                    (Causality::Input, _) => "an input",
                    (_, Variability::Tunable) => "a tunable parameter",
                    _ => "a fixed parameter",
                };
                format!(
                    "{name} is {kind} and cannot be set in the phase {}; it can in: {}",
                    setting.map_or("", phase_name),
                    access.settable().names()
                )
            }
        }
    };
    Problem { fault: Fault::Reference, text }
}

/// The problem of a variable whose causality is not the one that the function requires.
#[cold]
pub(crate) fn not_an(wanted: Causality, reference: ValueReference) -> Problem {
    let name = variables::lookup(reference).map_or_else(String::new, |(row, element)| row.element_name(element));
    let wanted = if wanted == Causality::Input { "an input" } else { "an output or a scalar local variable" };
    Problem { fault: Fault::Reference, text: format!("{name} (value reference {reference}) is not {wanted}") }
}

/// A status that this slave does not have.
#[cold]
pub(crate) fn no_status(kind: StatusKind) -> Problem {
    let name = match kind {
        DO_STEP_STATUS => "fmi2DoStepStatus",
        PENDING_STATUS => "fmi2PendingStatus",
        LAST_SUCCESSFUL_TIME => "fmi2LastSuccessfulTime",
        TERMINATED => "fmi2Terminated",
        _ => "an unknown status kind",
    };
    Problem { fault: Fault::Nothing, text: format!("{name} ({kind}) is not available here; steps are synchronous") }
}
