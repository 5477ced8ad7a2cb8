//! The contact: friction law and the pressure it acts on.

pub mod friction;
