//! Critical speed of thermoelastic instability: above it friction heat makes a pressure wave grow.
//!
//! Two half-planes slide on each other at the speed V. A wave of number m keeps its size and moves at the speed c against the punch; in
//! the frame of body i it moves at `c_i` (c for the punch, c - V for the strip), so that its temperature decays into the body as
//! `exp(-lambda_i z)`, `lambda_i^2 = m^2 - i m c_i/kd_i`, takes up the flux `K_i lambda_i T_i` and lifts the surface by
//! `2 alpha_i (1 + nu_i) T_i/(lambda_i + m)`. With the friction heat `mu V p`, the pressure `(E* m/2) (u_1 + u_2)` of what is lifted
//! and the resistance `1/(2 h_c)` between each surface and the other the wave stays as it is where
//!
//! ```text
//! mu V = Z(V, c),   Z = sum K_i lambda_i T_i / (E* m sum alpha_i (1 + nu_i) T_i/(lambda_i + m)),   T_1/T_2 = (1 + K_2 lambda_2/2h_c)/(1 + K_1 lambda_1/2h_c).
//! ```
//!
//! The imaginary part gives c, the real part V. One conductor on an insulator: c = 0 and V = 2 K m/(mu alpha (1+nu) E*), at once.
//! A wave that rests in one of two conductors sweeps over the other, which takes up far more heat than if it rested too:
//! of a pair of steel and lining neither body's own formula is near.
//!
//! Which waves there are, by geometry (m: the longest that fits):
//! - periodic: every c from 0 to V;
//! - line: c = 0, since what moves against the punch leaves the contact; on a closed path also c = V (hot spots of a
//!   disc), which are heated for the part of each turn that the punches cover;
//! - annular: around the ring as in periodic contact, and across its width, where nothing moves along the wave (bands).
//!
//! Half-planes: bodies thinner than a wave length/(2 pi) are off by the ratio of their stiffness to that of the half-plane.
//! Shear coupling moves the speed by the order of (mu (1-2nu)/(2(1-nu)))^2 and is left out. Source: R. A. Burton,
//! V. Nerlikar, S. R. Kilaparti, Thermoelastic instability in a seal-like configuration, Wear 24 (1973) 177-188.

use crate::coupled::scalar::Scalar;
use crate::scene::{Body, Geometry, MechanicalBody, Path, Scene};
use nalgebra::Complex;
use std::f64::consts::PI;

/// Speeds of the table, m/s: from, and how many to a decade; with the number of them it ends at 1e4 m/s.
const SLOWEST: f64 = 1e-5;
const PER_DECADE: f64 = 4.0;
const SPEEDS: usize = 37;
/// Wave speeds looked at between a body at rest and half the sliding speed, in geometric steps; a little beyond, because bodies
/// that are alike share the speed equally.
const WAVE_SPEEDS: usize = 24;
const SLOWEST_WAVE: f64 = 1e-10;
const FASTEST_WAVE: f64 = 0.5001;

/// Half of the resistance between surfaces that exchange nothing, K m2/W: each gets half of the heat.
const NO_EXCHANGE: f64 = 1e12;

/// Critical speed against the friction coefficient, from a table that is made once for a scene.
#[derive(Clone, PartialEq, Debug)]
pub struct CriticalSpeed {
    /// Logarithms of Z/V, falling, at the speeds of the table; empty where nothing can grow.
    stiffness: Vec<f64>,
    /// The least Z of one body by itself at rest, Pa.m/s.
    alone: f64,
}

impl CriticalSpeed {
    /// Makes the table for the scene's geometry and materials.
    pub fn new(scene: &Scene) -> CriticalSpeed {
        let waves = Waves::of(scene);
        if waves.iter().all(|wave| wave.pair.is_neutral()) {
            return CriticalSpeed { stiffness: Vec::new(), alone: f64::INFINITY };
        }
        let mut lowest = f64::INFINITY;
        let stiffness = (0..SPEEDS).map(|k| {
            let speed = speed_at(k as f64);
            let value = waves.iter().map(|wave| wave.least(speed) / speed).fold(f64::INFINITY, f64::min);
            // What has grown at a lower speed grows at a higher one.
            lowest = lowest.min(value);
            lowest.ln()
        });
        let stiffness = stiffness.collect();
        CriticalSpeed { stiffness, alone: waves.iter().map(|wave| wave.pair.alone()).fold(f64::INFINITY, f64::min) }
    }

    /// A speed below which nothing grows at this friction coefficient, m/s: either body taken for the only one that
    /// takes heat up. What the mate takes up besides only raises it.
    pub fn harmless(&self, friction: f64) -> f64 {
        self.alone / friction
    }

    /// The critical speed at this friction coefficient, m/s; 0: nothing grows. Relative error of the table: 2e-3, none
    /// for one conductor on an insulator.
    pub fn at<S: Scalar>(&self, friction: S) -> S {
        if self.stiffness.is_empty() || friction.value() <= 0.0 {
            return S::from(0.0);
        }
        let wanted = friction.value().ln();
        // Outside the table the last slope goes on.
        let above = self.stiffness.partition_point(|&value| value > wanted).clamp(1, SPEEDS - 1);
        let (left, right) = (self.stiffness[above - 1], self.stiffness[above]);
        // A flat piece: a wave that appears at this speed.
        let fall = (left - right).max(1e-9);
        let decades = 1.0 / (PER_DECADE * fall);
        // V = V_left (stiffness_left/friction)^(d ln V/d ln friction).
        let ratio = friction * (-left).exp();
        ratio.powf(-decades * std::f64::consts::LN_10) * speed_at((above - 1) as f64)
    }
}

fn speed_at(index: f64) -> f64 {
    SLOWEST * 10f64.powf(index / PER_DECADE)
}

/// The body that carries the waves which grow first, the better conductor of those that expand: a wave that rests in the
/// other one sweeps over it and is cooled.
pub fn driving_body(scene: &Scene) -> Option<&Body> {
    [&scene.punch, &scene.strip]
        .into_iter()
        .filter(|body| body.conductivity > 0.0 && body.thermal_expansion > 0.0)
        .max_by(|one, other| one.conductivity.total_cmp(&other.conductivity))
}

/// A conductor of the pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conductor {
    /// K, W/(m K); rho c, J/(m3 K); alpha (1 + nu), 1/K.
    pub conductivity: f64,
    pub capacity: f64,
    pub expansion: f64,
}

impl Conductor {
    fn of(body: &Body) -> Conductor {
        Conductor {
            conductivity: body.conductivity,
            capacity: body.density * body.specific_heat,
            expansion: if body.conductivity > 0.0 { body.thermal_expansion * (1.0 + body.poissons_ratio) } else { 0.0 },
        }
    }

    /// Decay into the body, 1/m, of a wave that moves at `speed` m/s in its frame; an insulator is not entered.
    pub fn decay(&self, wave: f64, speed: f64) -> Complex<f64> {
        if self.conductivity == 0.0 {
            return Complex::new(wave, 0.0);
        }
        Complex::new(wave * wave, -wave * speed * self.capacity / self.conductivity).sqrt()
    }
}

/// Two bodies under one wave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub bodies: [Conductor; 2],
    pub wave: f64,
    /// E*, Pa.
    pub modulus: f64,
    /// 1/(2 h_c), K m2/W.
    pub half_resistance: f64,
}

impl Pair {
    /// Both bodies of the scene under a wave of the length `length`, m.
    pub fn of(scene: &Scene, length: f64) -> Pair {
        let compliance = |body: &Body| match body.mechanical {
            MechanicalBody::Rigid => 0.0,
            _ => (1.0 - body.poissons_ratio * body.poissons_ratio) / body.youngs_modulus,
        };
        Pair {
            bodies: [Conductor::of(&scene.punch), Conductor::of(&scene.strip)],
            wave: 2.0 * PI / length,
            modulus: 1.0 / (compliance(&scene.punch) + compliance(&scene.strip)),
            half_resistance: if scene.conductance > 0.0 { 0.5 / scene.conductance } else { NO_EXCHANGE },
        }
    }

    /// Whether no heat lifts anything.
    fn is_neutral(&self) -> bool {
        self.bodies.iter().all(|body| body.expansion == 0.0) || !self.modulus.is_finite()
    }

    /// Z of the body that is easier to make unstable, at rest and by itself, Pa.m/s.
    fn alone(&self) -> f64 {
        let own = |body: &Conductor| 2.0 * self.wave * body.conductivity / (body.expansion * self.modulus);
        self.bodies.iter().filter(|body| body.expansion > 0.0).map(own).fold(f64::INFINITY, f64::min)
    }

    /// Z in Pa.m/s where the wave moves at these speeds in the frames of the two bodies.
    pub fn impedance(&self, speeds: [f64; 2]) -> Complex<f64> {
        let [first, second] = self.bodies;
        let decay = [first.decay(self.wave, speeds[0]), second.decay(self.wave, speeds[1])];
        let uptake = [decay[0] * first.conductivity, decay[1] * second.conductivity];
        let temperature = [uptake[1] * self.half_resistance + 1.0, uptake[0] * self.half_resistance + 1.0];
        let heat = uptake[0] * temperature[0] + uptake[1] * temperature[1];
        let lift = temperature[0] * first.expansion / (decay[0] + self.wave)
            + temperature[1] * second.expansion / (decay[1] + self.wave);
        heat / (lift * (self.modulus * self.wave))
    }
}

/// How the wave may move.
#[derive(Clone, Copy)]
enum Motion {
    /// At any speed between those of the bodies.
    Free,
    /// With this body; heated for this part of the time.
    With(usize, f64),
    /// Across the sliding direction: at rest in both.
    Across,
}

struct Waves {
    pair: Pair,
    motion: Motion,
}

impl Waves {
    /// The waves of the scene's geometry.
    fn of(scene: &Scene) -> Vec<Waves> {
        let mut waves = Vec::new();
        let mut add = |length: f64, motion: Motion| waves.push(Waves { pair: Pair::of(scene, length), motion });
        match scene.geometry {
            Geometry::Periodic => add(scene.width, Motion::Free),
            Geometry::Annular => {
                add(scene.depth, Motion::Free);
                add(scene.width, Motion::Across);
            }
            Geometry::Line => {
                add(scene.width, Motion::With(0, 1.0));
                if scene.path == Path::Closed {
                    add(scene.width, Motion::With(1, scene.coverage()));
                }
            }
        }
        waves
    }

    /// The least Re Z over the wave's motions at the sliding speed `speed`, Pa.m/s; infinite: there is no such wave.
    fn least(&self, speed: f64) -> f64 {
        let pair = &self.pair;
        if pair.is_neutral() {
            return f64::INFINITY;
        }
        let positive = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
        match self.motion {
            Motion::Across => positive(pair.impedance([0.0, 0.0]).re),
            Motion::With(body, part) => {
                let speeds = if body == 0 { [0.0, -speed] } else { [speed, 0.0] };
                positive(pair.impedance(speeds).re / part)
            }
            Motion::Free => {
                [false, true].map(|swapped| self.least_free(speed, swapped)).into_iter().fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Waves that move with the punch at less than half the sliding speed; `swapped`: with the strip.
    fn least_free(&self, speed: f64, swapped: bool) -> f64 {
        let at = |part: f64| {
            let (near, far) = (part * speed, (part - 1.0) * speed);
            let pair = &self.pair;
            // Seen from the strip, the punch slides the other way.
            pair.impedance(if swapped { [-far, -near] } else { [near, far] })
        };
        let mut least = f64::INFINITY;
        let mut take = |value: Complex<f64>| {
            if value.re > 0.0 {
                least = least.min(value.re);
            }
        };
        let step = (FASTEST_WAVE / SLOWEST_WAVE).powf(1.0 / (WAVE_SPEEDS - 1) as f64);
        let mut before = (0.0, at(0.0));
        if before.1.im == 0.0 {
            take(before.1);
        }
        let mut part = SLOWEST_WAVE;
        for _ in 0..WAVE_SPEEDS {
            let now = (part, at(part));
            if before.1.im * now.1.im < 0.0 {
                take(root(&at, before, now));
            }
            before = now;
            part *= step;
        }
        least
    }
}

/// Z where its imaginary part passes through 0 between two wave speeds (false position, Illinois variant).
fn root(at: &impl Fn(f64) -> Complex<f64>, from: (f64, Complex<f64>), to: (f64, Complex<f64>)) -> Complex<f64> {
    let (mut left, mut right) = ((from.0, from.1.im), (to.0, to.1.im));
    let mut value = to.1;
    for _ in 0..30 {
        let part = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        value = at(part);
        if value.im.abs() <= 1e-6 * value.re.abs() {
            break;
        }
        if value.im * right.1 < 0.0 {
            left = right;
        } else {
            left.1 *= 0.5;
        }
        right = (part, value.im);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Conductor = Conductor { conductivity: 55.0, capacity: 7800.0 * 460.0, expansion: 1.1e-5 * 1.3 };
    const LINING: Conductor = Conductor { conductivity: 1.2, capacity: 2600.0 * 1000.0, expansion: 15e-6 * 1.25 };
    const INSULATOR: Conductor = Conductor { conductivity: 0.0, capacity: 1e6, expansion: 0.0 };

    fn pair(first: Conductor, second: Conductor) -> Pair {
        Pair { bodies: [first, second], wave: 50.0, modulus: 1.06e9, half_resistance: 0.0 }
    }

    #[test]
    fn one_conductor_on_an_insulator_has_the_closed_form() {
        let exact = 2.0 * 55.0 * 50.0 / (1.1e-5 * 1.3 * 1.06e9);
        for bodies in [(STEEL, INSULATOR), (INSULATOR, STEEL)] {
            let wave = Waves { pair: pair(bodies.0, bodies.1), motion: Motion::Free };
            for speed in [1e-4, 1.0, 1e3] {
                let found = wave.least(speed);
                assert!((found - exact).abs() < 1e-9 * exact, "{speed}: {found} against {exact}");
            }
        }
    }

    #[test]
    fn the_imaginary_part_vanishes_and_the_pair_can_be_turned_round() {
        for speed in [1e-3, 0.1, 3.0, 40.0] {
            let one = Waves { pair: pair(STEEL, LINING), motion: Motion::Free }.least(speed);
            let other = Waves { pair: pair(LINING, STEEL), motion: Motion::Free }.least(speed);
            assert!((one - other).abs() < 1e-4 * one, "{speed}: {one} against {other}");
            if speed < 1.0 {
                continue;
            }
            // The lining that the wave sweeps over takes heat up: harder to make unstable than steel on an insulator.
            let alone = Waves { pair: pair(STEEL, INSULATOR), motion: Motion::Free }.least(speed);
            assert!(one > alone * 3.0, "{speed}: {one} against {alone}");
        }
    }

    #[test]
    fn alike_bodies_share_the_wave_or_one_keeps_it() {
        // By symmetry a wave at half the speed is always neutral in its phase.
        let wave = Waves { pair: pair(STEEL, STEEL), motion: Motion::Free };
        let slow = wave.least(1e-6);
        let at_rest = 2.0 * 2.0 * 55.0 * 50.0 / (2.0 * 1.1e-5 * 1.3 * 1.06e9);
        assert!((slow - at_rest).abs() < 1e-3 * at_rest, "{slow} against {at_rest}");
        assert!(wave.least(10.0).is_finite());
    }
}
