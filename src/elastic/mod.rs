//! Elastic bodies, each reached only through what it does at the contact line.

#[cfg(feature = "contact-line")]
pub mod block;
pub mod mean;
