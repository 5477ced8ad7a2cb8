//! Bristle model of the friction force at standstill (`contact.stick_stiffness`) and of elastic slip (`contact.tangential_compliance`).
//!
//! A spring of stiffness k with a damper c, in series with a Coulomb slider of limit L:
//!
//! ```text
//! stick: dz/dt = v,                          f = k z + c v        while |k z + c v| <= L
//! slip:  dz/dt = (L sgn - k z)/c,            f = L sgn            (c = 0: z = L sgn/k instantly)
//! ```
//!
//! The work f v equals the change of k z^2/2 plus heat; the heat is never negative. There is no creep: below the limit a constant
//! force corresponds to a constant deflection. Velocity and limit are linear over a step, for which the solution is exact:
//! sticking ends at a root of a quadratic; the slip speed is a linear function plus an exponential, with at most two zeros.
//!
//! An explicit time stepping of step h and mass m outside this component is stable in stick for h k < c < 2 m/h - h k/2.
//!
//! Theory: docs/theory.md, section 2.6.

use super::stage::{POINTS, averages};

/// Bristle of all faces together.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Bristle {
    /// k, N/m, > 0.
    pub stiffness: f64,
    /// c, N s/m, >= 0.
    pub damping: f64,
}

/// Result of a step of the bristle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Moved {
    /// Deflection at the end, m.
    pub deflection: f64,
    /// Friction heat, J.
    pub heat: f64,
    /// Distance slipped, m, >= 0.
    pub slipped: f64,
    /// Friction heat per time at the three points of the step, W.
    pub power: [f64; 3],
    /// Slip speed at these points, m/s, >= 0.
    pub speed: [f64; 3],
    /// What of the above is released at the start of the step.
    pub released: Released,
}

/// Heat and slip by which the spring returns to a limit that is below its force when the step starts, as after a jump of the load:
/// `(k z^2 - L^2/k)/2` and `|z| - L/k`. It takes the time c/k. Nothing where that is so long that the points of the step see it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Released {
    /// Part of the friction heat, J.
    pub heat: f64,
    /// Part of the distance slipped, m.
    pub slipped: f64,
}

impl Moved {
    /// Bristle at rest at the deflection `z` (m).
    pub(crate) fn none(z: f64) -> Moved {
        let released = Released::default();
        Moved { deflection: z, heat: 0.0, slipped: 0.0, power: [0.0; 3], speed: [0.0; 3], released }
    }
}

/// Linear function of time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Line {
    /// Value at the start.
    pub start: f64,
    /// Rate per second.
    pub rate: f64,
}

impl Line {
    /// Constant function.
    pub(crate) fn level(value: f64) -> Line {
        Line { start: value, rate: 0.0 }
    }

    /// Linear function through its values at the points 1/3 and 1 of a step (s).
    pub(crate) fn through_stages(values: [f64; 2], step: f64) -> Line {
        let rate = (values[1] - values[0]) / ((POINTS[2] - POINTS[0]) * step);
        Line { start: values[0] - rate * POINTS[0] * step, rate }
    }

    pub(crate) fn at(&self, time: f64) -> f64 {
        self.start + self.rate * time
    }

    fn from(&self, time: f64) -> Line {
        Line { start: self.at(time), rate: self.rate }
    }

    fn integral(&self, time: f64) -> f64 {
        time * (self.start + 0.5 * self.rate * time)
    }

    /// Integral of the product with another linear function.
    fn work(&self, other: &Line, time: f64) -> f64 {
        let mixed = self.start * other.rate + self.rate * other.start;
        time * (self.start * other.start + time * (0.5 * mixed + time / 3.0 * self.rate * other.rate))
    }
}

/// Relative distance to the limit within which a bristle without damper that is loaded further counts as slipping.
const MEETING: f64 = 1e-4;

/// Part of the deflection beyond the limit, as the exponent of e, that is left at the first point of a step after a return that the
/// points do not see: rounding.
const RETURNED: f64 = 36.0;

/// Parts of [`Bristle::deflection_by_parts`].
const GRADED: i32 = 10;

/// Largest number of transitions between sticking and slipping in a step; linear velocity and limit cause fewer.
const MOST_CHANGES: usize = 16;

/// Time at which `a + b t + c t^2`, not above 0 at t = 0, next rises through 0.
fn rises_through_zero(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let root = discriminant.sqrt();
    if b > 0.0 {
        (-2.0 * a / (b + root)).max(0.0)
    } else if c > 0.0 {
        0.5 * (root - b) / c
    } else {
        f64::INFINITY
    }
}

impl Bristle {
    /// Force (N) at deflection `z` (m), velocity `v` (m/s) and limit `limit` (N), and whether it slips.
    pub(crate) fn force(&self, z: f64, v: f64, limit: f64) -> (f64, bool) {
        let trial = self.stiffness * z + self.damping * v;
        // Without a damper a slipping bristle is at its limit only to rounding and to the error of the temperature.
        let meets = self.damping == 0.0 && trial * v > 0.0 && trial.abs() > (1.0 - MEETING) * limit;
        if trial.abs() > limit || meets { (limit.copysign(trial), true) } else { (trial, false) }
    }

    /// Advances the deflection `z` (m) over `step` (s) at the velocity `v` (m/s), which does not change its sign, and the limit
    /// `limit` (N, 0 where it is negative).
    pub(crate) fn advance(&self, z: f64, v: Line, limit: Line, step: f64) -> Moved {
        let mut moved = Moved::none(z);
        let (first, last) = (limit.start, limit.at(step));
        if first >= 0.0 && last >= 0.0 {
            self.carry(&mut moved, v, limit, [0.0, step], step);
        } else if first <= 0.0 && last <= 0.0 {
            self.carry(&mut moved, v, Line::level(0.0), [0.0, step], step);
        } else {
            // One part has the limit 0.
            let change = (-first / limit.rate).clamp(0.0, step);
            let nothing = Line::level(0.0);
            let (early, late) = if first < 0.0 { (nothing, limit) } else { (limit, nothing) };
            self.carry(&mut moved, v, early, [0.0, change], step);
            self.carry(&mut moved, v, late, [change, step], step);
        }
        moved
    }

    /// Deflection (m) at the end of `step` (s) under the limit `limit` (N) times a factor of the time (s). Its parts are halved towards the
    /// lower speed, where a Stribeck factor is steep.
    pub(crate) fn deflection_by_parts(
        &self,
        z: f64,
        v: Line,
        limit: Line,
        step: f64,
        factor: impl Fn(f64) -> f64,
    ) -> f64 {
        let slows = v.at(step).abs() < v.start.abs();
        let at = |part: i32| match (slows, part) {
            (true, GRADED) => step,
            (true, _) => step * (1.0 - 0.5_f64.powi(part)),
            (false, 0) => 0.0,
            (false, _) => step * 0.5_f64.powi(GRADED - part),
        };
        (0..GRADED).fold(z, |z, part| {
            let [start, length] = [at(part), at(part + 1) - at(part)];
            let [first, last] = [start, start + length].map(|time| limit.at(time).max(0.0) * factor(time));
            self.advance(z, v.from(start), Line { start: first, rate: (last - first) / length }, length).deflection
        })
    }

    /// Advances `moved` over the part `span` of the step.
    fn carry(&self, moved: &mut Moved, v: Line, limit: Line, span: [f64; 2], step: f64) {
        let k = self.stiffness;
        let mut now = span[0];
        let mut slipping = None;
        for change in 0..MOST_CHANGES {
            let (v, limit, left) = (v.from(now), limit.from(now), span[1] - now);
            let trial = k * moved.deflection + self.damping * v.start;
            if change == 0 && trial.abs() > limit.start {
                slipping = Some(1.0_f64.copysign(trial));
                let (z, held) = (moved.deflection.abs(), limit.start.max(0.0) / k);
                if now == 0.0 && z > held && k * POINTS[0] * step >= RETURNED * self.damping {
                    moved.released = Released { heat: 0.5 * k * (z - held) * (z + held), slipped: z - held };
                }
            }
            let (length, next) = match slipping {
                None => {
                    let (length, side) = self.sticks_until(moved.deflection, v, limit);
                    (length, Some(side))
                }
                Some(side) => (self.slips_until(moved.deflection, v, limit, side, left), None),
            };
            let last = change + 1 == MOST_CHANGES || length >= left;
            let length = if last { left } else { length };
            for (point, c) in POINTS.into_iter().enumerate() {
                let time = c * step - now;
                // The end of the step belongs to its last part.
                if time > 0.0 && time <= length || last && point == 2 && span[1] == step {
                    let (_, rate) = self.deflects(moved.deflection, v, limit, slipping, time);
                    let slip = if slipping.is_some() { (v.at(time) - rate).abs() } else { 0.0 };
                    // Dissipation of the damper, in sticking and in slipping.
                    moved.power[point] = limit.at(time) * slip + self.damping * rate * rate;
                    moved.speed[point] = slip;
                }
            }
            let before = moved.deflection;
            let (change, _) = self.deflects(before, v, limit, slipping, length);
            let heat = match slipping {
                None => self.damping * v.work(&v, length),
                Some(side) => side * limit.work(&v, length) - k * change * (before + 0.5 * change),
            };
            moved.heat += heat.max(0.0);
            if slipping.is_some() {
                moved.slipped += (v.integral(length) - change).abs();
            }
            moved.deflection = before + change;
            if last {
                return;
            }
            now += length;
            slipping = next;
        }
    }

    /// Change of the deflection, and its rate, after `time` of sticking, or of slipping to the given side. Not the new deflection, whose
    /// rounding is a large speed in a short step.
    fn deflects(&self, z: f64, v: Line, limit: Line, slipping: Option<f64>, time: f64) -> (f64, f64) {
        let (k, c) = (self.stiffness, self.damping);
        let Some(side) = slipping else { return (v.integral(time), v.at(time)) };
        if c == 0.0 {
            return (side * limit.at(time) / k - z, side * limit.rate / k);
        }
        let x = k * time / c;
        let decay = (-x).exp();
        let (first, second) = averages(x, decay);
        let (goal, drift) = (side * limit.start / k, side * limit.rate / k);
        // Not (L sgn - k z)/c, which for a weak damper is the rounding error of z.
        let rate = drift * (1.0 - decay) + (goal - z) * k / c * decay;
        ((goal - z) * x * first + drift * time * x * second, rate)
    }

    /// Duration of sticking, 0 where it slips.
    pub(crate) fn sticks_for(&self, z: f64, v: Line, limit: Line) -> f64 {
        if self.force(z, v.start, limit.start).1 { 0.0 } else { self.sticks_until(z, v, limit).0 }
    }

    /// Duration of sticking, and the side to which the bristle then slips.
    fn sticks_until(&self, z: f64, v: Line, limit: Line) -> (f64, f64) {
        let (k, c) = (self.stiffness, self.damping);
        let [up, down] = [1.0, -1.0].map(|side| {
            let excess = side * (k * z + c * v.start) - limit.start;
            rises_through_zero(excess.min(0.0), side * (k * v.start + c * v.rate) - limit.rate, 0.5 * side * k * v.rate)
        });
        if up <= down { (up, 1.0) } else { (down, -1.0) }
    }

    /// Duration of slipping, at most `left`: until the limit exceeds the force at zero slip speed.
    fn slips_until(&self, z: f64, v: Line, limit: Line, side: f64, left: f64) -> f64 {
        let (k, c) = (self.stiffness, self.damping);
        if c == 0.0 {
            // The slip speed is linear.
            let (speed, rate) = (side * v.start - limit.rate / k, side * v.rate);
            let rounding = 1e-12 * (v.start.abs() + limit.rate.abs() / k);
            return match rate {
                rate if rate > 0.0 && speed >= -rounding => left,
                rate if rate < 0.0 && speed > 0.0 => (-speed / rate).min(left),
                _ if speed > 0.0 => left,
                _ => 0.0,
            };
        }
        // c times the slip speed: a straight line of slope `far` plus an exponential.
        let excess = |time: f64| {
            let (change, _) = self.deflects(z, v, limit, Some(side), time);
            side * (k * (z + change) + c * v.at(time)) - limit.at(time)
        };
        let far = side * c * v.rate;
        let near = far + side * k * (side * limit.start - k * z) / c - limit.rate;
        let mut right = left;
        if near < far {
            // Convex: the minimum is where the slope is 0, and the function is positive from some later time on.
            if far > 0.0 {
                if near >= 0.0 {
                    return left;
                }
                right = right.min(c / k * (1.0 - near / far).ln());
            }
        }
        if excess(right) >= 0.0 {
            return left;
        }
        let mut ends = [0.0, right];
        for _ in 0..60 {
            let middle = 0.5 * (ends[0] + ends[1]);
            ends[usize::from(excess(middle) < 0.0)] = middle;
        }
        ends[1]
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
            let moved = bristle.advance(z, Line::level(v), Line::level(500.0), step);
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
        let once = bristle.advance(0.0, Line::level(0.01), Line::level(500.0), 0.2);
        assert!((once.deflection - 500.0 / 1e6).abs() < 1e-12);
    }

    #[test]
    fn a_bristle_at_its_limit_dissipates_force_times_velocity_throughout_the_step() {
        let bristle = Bristle { stiffness: 1e6, damping: 0.0 };
        let moved = bristle.advance(5e-4, Line::level(0.01), Line::level(500.0), 0.1);
        for (power, speed) in moved.power.into_iter().zip(moved.speed) {
            assert!((power - 5.0).abs() < 1e-9 && (speed - 0.01).abs() < 1e-12, "{power} W {speed} m/s");
        }
    }

    #[test]
    fn below_the_limit_nothing_creeps() {
        let bristle = Bristle { stiffness: 1e6, damping: 0.0 };
        let mut z = 3e-4;
        for _ in 0..1000 {
            z = bristle.advance(z, Line::level(0.0), Line::level(500.0), 1.0).deflection;
        }
        assert_eq!(z, 3e-4);
        // A limit that falls below the force releases the spring, whose energy becomes heat.
        let released = bristle.advance(z, Line::level(0.0), Line::level(100.0), 1.0);
        assert!((released.deflection - 1e-4).abs() < 1e-15);
        assert!((released.heat - 0.5e6 * (9e-8 - 1e-8)).abs() < 1e-12);
    }
}
