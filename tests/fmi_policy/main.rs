//! The C interface as an importer sees it: through the exported functions only.
//!
//! What each call must answer stands here as data, written down from the standard and from the
//! interface's description, not taken from the tables of the library.

mod calls;
mod handles;
mod importer;
mod instantiation;
mod messages;
mod sequences;
mod states;
#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod symbols;
