//! Parts of the command line that `fmu-lab`, which computes natively, shares with `cargo fmu`.
//!
//! This package depends on no crate of the model: what `cargo fmu package` and `run` need compiles in seconds, and the
//! model itself once, for the library in the FMU.

// Everything is printed by `output`, which bears that nobody reads it to the end.
#![deny(clippy::print_stdout)]

pub mod arguments;
pub mod batch;
pub mod bench;
pub mod command_line;
pub mod drawing;
pub mod fit;
pub mod native;
pub mod output;
pub mod package;
pub mod parquet;
pub mod plot;
pub mod progress;
pub mod project;
pub mod python;
pub mod realtime;
pub mod reference;
pub mod release;
pub mod run;
pub mod scenes;
pub mod site;
pub mod soak;
pub mod test;

pub use scene_file::columns;
