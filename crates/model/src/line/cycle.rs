//! Cycles of reciprocating sliding: the cycle map, its fixed point, and cycle jumps.
//!
//! The state that a contact in reciprocating sliding under constant load carries from cycle to cycle, `z`, consists of the worn
//! shape and the heat in its bodies. A cycle of the stepped model maps it, `z -> z + F(z)` ([`map`]). The cycle is steady where
//! wear is a rigid motion and the heat is periodic ([`solve`]); before that, F is the slope of a stiff initial value problem over
//! the number of cycles, which is integrated in jumps ([`jump`]).
//!
//! Theory: docs/theory.md, section 9.5.

mod error;
mod exchange;
pub(crate) mod jump;
pub mod map;
mod newton;
mod records;
pub(crate) mod solve;
mod tangent;
pub(crate) mod tracked;

pub use error::CycleError;
pub use jump::{Jump, JumpOptions, Jumps, Progress};
pub use map::{CycleMap, MapResolution, Passage, StrokePassage};
pub use solve::{Solution, SolveOptions};
pub use tracked::TrackedCycles;
