//! The C interface through the exported functions only, as an importer calls it.
//!
//! The required status of each call is given here as data, from the standard and from the
//! interface's description, independent of the tables of the library.

mod calls;
mod handles;
#[cfg(all(target_os = "linux", target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod host;
mod instantiation;
mod messages;
mod sequences;
mod states;
#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod symbols;
