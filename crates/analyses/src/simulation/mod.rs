//! Simulation of a scene along inputs: trajectory, run, summary, figure, and the deviation from a measured record.

mod figure;
pub mod measured;
mod neglected_slip;
pub mod quantity;
mod rig;
mod run;
mod summary;
mod trajectory;
mod trips;

pub use figure::{Figure, Panel, Series};
pub use run::{Channel, Profiles, Progress, Recording, energy_residual, run};
pub use summary::Summary;
pub use trajectory::Trajectory;
