//! Numerical tools that every part of the physics shares.

pub mod factorization;
pub mod grading;
pub mod maximum;
