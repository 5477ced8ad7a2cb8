//! Numerical tools that every part of the physics shares.

pub mod factorization;
pub mod maximum;
