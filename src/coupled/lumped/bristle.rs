//! The bristle that carries the friction force at standstill (`contact.stick_stiffness`).
//!
//! A spring of stiffness k with a damper c, in series with a Coulomb slider of limit L:
//!
//! ```text
//! stick: dz/dt = v,                          f = k z + c v        while |k z + c v| <= L
//! slip:  dz/dt = (L sgn - k z)/c,            f = L sgn            (c = 0: z = L sgn/k at once)
//! ```
//!
//! Work f v equals the change of k z^2/2 plus heat; the heat is never negative. Nothing creeps: below
//! the limit a constant force stands on a constant deflection. Velocity and limit are constant over the
//! step taken here; the caller cuts the step where they change.
//!
//! An explicit master of step h and mass m is stable in stick for h k < c < 2 m/h - h k/2.

/// See the module; all faces together.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bristle {
    /// k, N/m, > 0.
    pub stiffness: f64,
    /// c, N s/m, >= 0.
    pub damping: f64,
}

/// What a step of the bristle gives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Moved {
    /// Deflection at the end, m.
    pub deflection: f64,
    /// Friction heat, J.
    pub heat: f64,
    /// Distance slipped, m, >= 0.
    pub slipped: f64,
}

impl Bristle {
    /// Force (N) at deflection `z` (m), velocity `v` (m/s) and limit `limit` (N), and whether it slips.
    pub fn force(&self, z: f64, v: f64, limit: f64) -> (f64, bool) {
        let trial = self.stiffness * z + self.damping * v;
        if trial.abs() > limit { (limit.copysign(trial), true) } else { (trial, false) }
    }

    /// Rate of deflection (m/s) in the same situation.
    pub fn rate(&self, z: f64, v: f64, limit: f64) -> f64 {
        let (force, slips) = self.force(z, v, limit);
        if !slips {
            v
        } else if self.damping > 0.0 {
            (force - self.stiffness * z) / self.damping
        } else {
            0.0
        }
    }

    /// Carries the deflection `z` over `step` (s) at constant velocity `v` (m/s) and limit `limit` (N).
    pub fn advance(&self, z: f64, v: f64, limit: f64, step: f64) -> Moved {
        let (k, c) = (self.stiffness, self.damping);
        let mut moved = Moved { deflection: z, heat: 0.0, slipped: 0.0 };
        let mut left = step;
        if k * z.abs() > limit && c == 0.0 {
            // The limit has fallen below what the spring holds: the excess is released as heat.
            let held = limit / k;
            moved.heat += 0.5 * k * (z * z - held * held);
            moved.slipped += z.abs() - held;
            moved.deflection = held.copysign(z);
        }
        let (_, slips) = self.force(moved.deflection, v, limit);
        if !slips {
            // Sticks until the force reaches the limit on the side it moves to.
            let side = v.signum();
            let room = side * limit - k * moved.deflection - c * v;
            let until = if v == 0.0 { left } else { (room / (k * v)).clamp(0.0, left) };
            moved.heat += c * v * v * until;
            moved.deflection += v * until;
            left -= until;
        }
        if left > 0.0 && (slips || v != 0.0) {
            let (force, _) = self.force(moved.deflection, v, limit);
            let force = if slips { force } else { limit.copysign(v) };
            let goal = force / k;
            let before = moved.deflection;
            let after = if c > 0.0 { goal + (before - goal) * (-k / c * left).exp() } else { goal };
            // Work of the force on the sliding velocity, less what the spring keeps.
            let heat = force * v * left - 0.5 * k * (after * after - before * before);
            moved.heat += heat.max(0.0);
            moved.slipped += (v * left - (after - before)).abs();
            moved.deflection = after;
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_stored_or_heat() {
        let bristle = Bristle { stiffness: 1e6, damping: 2e3 };
        let (mut z, mut work, mut heat) = (0.0, 0.0, 0.0);
        // Load, slip, reverse, slip back: many small steps measure the work of the force itself.
        for i in 0..40_000 {
            let v = if i < 20_000 { 0.01 } else { -0.02 };
            let step = 1e-5;
            let (force, _) = bristle.force(z, v, 500.0);
            let moved = bristle.advance(z, v, 500.0, step);
            let (after, _) = bristle.force(moved.deflection, v, 500.0);
            work += 0.5 * (force + after) * v * step;
            heat += moved.heat;
            assert!(moved.heat >= 0.0);
            z = moved.deflection;
        }
        let stored = 0.5 * bristle.stiffness * z * z;
        assert!((work - heat - stored).abs() < 2e-4 * work, "{work} {heat} {stored}");
        assert!((z + 500.0 / 1e6).abs() < 1e-9);
        // One step over everything gives the same end.
        let once = bristle.advance(0.0, 0.01, 500.0, 0.2);
        assert!((once.deflection - 500.0 / 1e6).abs() < 1e-12);
    }

    #[test]
    fn below_the_limit_nothing_creeps() {
        let bristle = Bristle { stiffness: 1e6, damping: 0.0 };
        let mut z = 3e-4;
        for _ in 0..1000 {
            z = bristle.advance(z, 0.0, 500.0, 1.0).deflection;
        }
        assert_eq!(z, 3e-4);
        // A limit that falls below the held force lets go, and the spring's energy becomes heat.
        let released = bristle.advance(z, 0.0, 100.0, 1.0);
        assert!((released.deflection - 1e-4).abs() < 1e-15);
        assert!((released.heat - 0.5e6 * (9e-8 - 1e-8)).abs() < 1e-12);
    }
}
