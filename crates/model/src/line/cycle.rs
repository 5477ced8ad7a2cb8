//! Cycles of to-and-fro sliding: one as a map of what the contact remembers, its fixed point, and jumps over many.
//!
//! A contact that slides to and fro under a constant load remembers from cycle to cycle the shape that it has worn and the
//! heat in its bodies, `z`. A cycle of the stepped model maps it, `z -> z + F(z)` ([`map`]). Where wear grows like a rigid
//! motion and the heat comes back, the cycle is steady ([`solve`]); in between, F is the slope of a stiff initial value
//! problem over the number of cycles, which is integrated in jumps ([`jump`]).

mod exchange;
pub mod jump;
pub mod map;
mod newton;
pub mod solve;
mod tangent;

pub use jump::{Jump, JumpOptions, Jumps};
pub use map::{CycleError, CycleMap, Passage, Resolution, StrokePassage};
pub use solve::{Solution, SolveOptions};
