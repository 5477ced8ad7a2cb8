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

impl FrictionTable {
    /// Highest coefficient of the table.
    pub(crate) fn highest(&self) -> f64 {
        self.coefficient[..self.points].iter().copied().fold(0.0, f64::max)
    }

    /// Index of the first speed that is not above its predecessor, if there is one.
    pub(crate) fn disorder(&self) -> Option<usize> {
        (1..self.points).find(|&i| self.speed[i] <= self.speed[i - 1])
    }
}
