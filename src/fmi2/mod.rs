//! The FMI 2.0 co-simulation interface in C: the only module that knows FMI and C.
//!
//! It holds no formula: what a variable is stands in [`scene::variables`], what it is worth in
//! [`crate::component`]. Here stand who may call what when, and what the call answers.
//!
//! | module | about |
//! |---|---|
//! | [`types`] | the C types of the standard, declared by hand |
//! | [`exports`] | the exported functions: raw arguments in, one call into the instance |
//! | `gate` | what every call passes: handle, busy flag, phase, panic, log, status |
//! | `registry` | handles instead of pointers: any garbage, used twice or freed, is refused |
//! | [`policy`] | call sequences, settable variables and statuses, as tables |
//! | `instance` | what each function does to an instance, in safe Rust |
//! | `state` | FMU states: what they hold and how they are written as bytes |
//! | `log` | messages to the importer's logger |
//!
//! Three things stay true whatever an importer does. Nothing that it hands over as a component or as
//! an FMU state is ever dereferenced. A call that is refused leaves the instance as it was. No panic
//! leaves the library, and nothing is printed.

#![deny(unsafe_op_in_unsafe_fn)]

pub mod exports;
mod gate;
mod instance;
mod log;
pub mod policy;
mod registry;
mod state;
pub mod types;
