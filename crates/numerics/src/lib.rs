//! Numerical tools shared by all parts of the physics.

#![cfg_attr(not(test), forbid(unsafe_code))]

pub mod acceleration;
pub mod cache;
pub mod dense;
pub mod factorization;
pub(crate) mod four_fifths;
pub mod grading;
pub mod interruption;
pub mod krylov;
mod leading_bits;
pub mod maximum;
pub mod quadrature;
pub mod scalar;
pub mod sdirk;
pub mod subnormal;

pub use leading_bits::leading_bits;
