//! Heat conduction resolved along the contact line: the conducting bodies, the cooling of their free faces, their thermal state,
//! and the partition of the friction heat between them.
//!
//! Theory: docs/theory.md, sections 6.1, 6.2.

pub mod bodies;
pub(crate) mod edges;
pub mod partition;
pub(crate) mod partitions;
pub(crate) mod state;
