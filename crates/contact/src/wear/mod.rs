//! Wear: the law, the worn track of a straight path, and the shape of the contact line.
//!
//! Theory: docs/theory.md, sections 2.3, 5.5.

pub mod law;
pub mod line;
pub mod rocking;
pub mod track;
