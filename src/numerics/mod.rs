//! Numerical tools shared by all parts of the physics.

pub mod factorization;
pub mod grading;
pub mod maximum;
