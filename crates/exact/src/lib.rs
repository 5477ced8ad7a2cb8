//! Exact and independently converged reference solutions of the numerics.
//!
//! Each is independent - none uses the cells, compliances or solvers it is compared with - and has tests of its own. Plane
//! strain, `E* = E/(1 - nu^2)`, loads per depth, contact zone `-a <= x <= a`, `s = sign(v)`.
//!
//! Theory: docs/theory.md, section 10.

#![forbid(unsafe_code)]

mod cyclic;
mod flat_punch;
mod galin;
mod hertz;
pub mod instability;
mod pressure_wave;
pub mod property_slab;
pub mod reference;
mod ring;
pub mod special;
pub mod unreduced_punch;
mod wear;

pub use cyclic::{CyclicHalfPlane, HolderKind};
pub use flat_punch::{FlatPunch, friction_exponent};
pub use galin::GalinRelaxation;
pub use hertz::HertzLine;
pub use pressure_wave::PressureWave;
pub use ring::{PartedRing, RadialBands};
pub use wear::{annular_pressure, unidirectional_rotating_pressure, winkler_relaxation_rate, worn_cylinder_half_width};
