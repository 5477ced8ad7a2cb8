//! Parts of the tolerance of a reduction that errors within it may reach.
//!
//! Theory: docs/theory.md, section 7.

/// Impedance of a slab.
pub(crate) const SLAB: f64 = 0.1;

/// Depth modes of the strip.
pub(crate) const STRIP_MODES: f64 = 0.2;

/// One band of the punch. The errors of bands of ratio q in rate sum to at most (e^2/4)/ln q of one: 2 at q = 2.5.
pub(crate) const PUNCH_BAND: f64 = 0.1;
