//! Measured friction coefficient over sliding speed, as users give it.

/// Most points of the table.
pub const FRICTION_POINTS: usize = 16;

/// Friction coefficients at increasing sliding speeds, the first of which is 0.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FrictionTable {
    /// Number of points, at least 2.
    pub points: usize,
    /// Sliding speeds, m/s.
    pub speed: [f64; FRICTION_POINTS],
    /// Coefficients at these speeds.
    pub coefficient: [f64; FRICTION_POINTS],
}
