//! Hostile use of the C interface: what must come out, as a table.
//!
//! A row of `cases.txt` says what is done, at which levels, with which calls, the status of the last call and the words that its
//! message must contain. Of every row is checked besides:
//!
//! - calls before the last one return `fmi2OK`;
//! - after every `fmi2OK` all outputs are finite, temperatures above 0 K within the model's validity, and `estimated_error` in 0 to 1;
//! - a refused call leaves the saved state as it was, byte by byte but for the phase;
//! - the instance then goes on, from the state saved before where it is in the error phase, and gives the same bits as an
//!   instance that never had the call.
//!
//! [`states`] makes rows of forged states, [`limits`] those of every parameter from the table of variables. Calls, arrays and phases by
//! the standard are those of `tests/fmi_policy`.

mod limits;
mod run;
mod states;
mod table;
