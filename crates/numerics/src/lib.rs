//! Numerical tools shared by all parts of the physics.

pub mod acceleration;
pub mod cache;
pub mod dense;
pub mod factorization;
pub mod four_fifths;
pub mod grading;
pub mod krylov;
pub mod maximum;
pub mod scalar;
pub mod sdirk;
