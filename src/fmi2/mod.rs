//! The FMI 2.0 co-simulation interface in C: the only module that depends on FMI and C.
//!
//! It contains no physics: the variables are defined in [`scene::variables`], their values computed in
//! [`crate::component`]. This module defines the call sequences and the returned statuses.
//!
//! | module | about |
//! |---|---|
//! | [`types`] | the C types of the standard, declared by hand |
//! | [`exports`] | the exported functions: raw arguments in, one call into the instance |
//! | `arguments` | arrays and strings of the importer, checked before they are read |
//! | `floating_point` | floating-point environment of the calling thread |
//! | `gate` | entry and exit of every call: handle, busy flag, phase, panic, log, status |
//! | `registry` | handles instead of pointers: invalid, busy and freed ones are refused |
//! | [`policy`] | call sequences, settable variables and statuses, as tables |
//! | `problem` | reasons of a refused call |
//! | `instance` | implementation of the functions on an instance, in safe Rust |
//! | `state` | FMU states: contents and serialisation |
//! | `log` | messages to the importer's logger |
//!
//! Three invariants hold whatever an importer does. No pointer that it passes as a component or as
//! an FMU state is ever dereferenced. A call that is refused leaves the instance unchanged. No panic
//! leaves the library, and nothing is printed.

#![deny(unsafe_op_in_unsafe_fn)]

mod arguments;
pub mod exports;
mod floating_point;
mod gate;
mod instance;
mod log;
pub(crate) mod policy;
mod problem;
mod registry;
mod state;
pub mod types;
