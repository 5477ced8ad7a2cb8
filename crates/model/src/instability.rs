//! Critical speed of thermoelastic instability: above it friction heat makes a pressure wave grow.
//!
//! Two layers of the bodies' own heights slide on each other at the speed V. A wave of number q keeps its size and moves at the speed
//! c against the punch; in the frame of body i it moves at `c_i` (c for the punch, c - V for the strip). What the layers take up and
//! how they are lifted ([`layer`]) leaves the wave as it is where
//!
//! ```text
//! mu V = Z(V, c).
//! ```
//!
//! The imaginary part gives c, the real part V. A half-plane on an insulator: c = 0 and V = 2 K q/(mu alpha (1+nu) E*), at
//! once. A wave that rests in one of two conductors sweeps over the other, which takes up far more heat than if it rested
//! too: of a pair of steel and lining neither body's own formula is near.
//!
//! Which waves there are, by geometry:
//! - periodic: whole waves on the path, every c from 0 to V;
//! - line: from half a wave across the width where the holder keeps the punch from turning, from a whole one where it may turn.
//!   c = 0, since what moves against the punch leaves the contact; on a closed path also c = V (hot spots of a disc), which are
//!   heated for the part of each turn that the punches cover;
//! - annular: around the full ring as in periodic contact, under a shorter punch as on a line; and across the width, where
//!   nothing moves along the wave (bands), from half a wave.
//!
//! Layers: the punch is bonded at its top, the strip bonded or smooth at its base, with the thermal conditions of the scene there. Where
//! `contact.faces` = 2 and the strip's base is insulated, the base is the mid plane of a strip between two punches: then the
//! waves of both faces may also be alike (a smooth base) or opposite (a strip that bends, its mid plane at its temperature).
//! The opposite ones grow first in a thin disc between soft pads. They are no part of what a contact line models, which carries
//! one face and the base that the scene names: [`CriticalSpeed::modelled`] leaves them out.
//!
//! Of all waves that fit, the one that grows first counts: the longest in half-planes, in layers often a shorter one. From
//! q h = 4 on layers are half-planes, so there the search ends.
//!
//! Shear coupling moves the speed by the order of (mu (1-2nu)/(2(1-nu)))^2 and is left out, and so are the edges of the
//! contact, which hold the longest waves back: a punch of a wave's or half a wave's width may be stable up to twice the speed. Sources: R. A. Burton, V. Nerlikar, S. R. Kilaparti, Thermoelastic instability in a seal-like configuration, Wear 24
//! (1973) 177-188; K. Lee, J. R. Barber, Frictionally excited thermoelastic instability in automotive disk brakes, J.
//! Tribology 115 (1993) 607-614.
//!
//! Theory: docs/theory.md, section 7.4.

pub mod layer;
mod waves;

use numerics::scalar::Scalar;
use scene::{Body, Scene};
use waves::Families;

/// Speeds of the table, m/s: from, and how many to a decade; with the number of them it ends at 1e4 m/s.
const SLOWEST: f64 = 1e-5;
const PER_DECADE: f64 = 4.0;
const SPEEDS: usize = 37;

/// Critical speed against the friction coefficient, from tables that are made once for a scene.
#[derive(Clone, PartialEq, Debug)]
pub struct CriticalSpeed {
    /// Of all waves, and of those that a contact line models.
    all: Table,
    modelled: Table,
    /// The least Z of one body by itself at rest, m/s, of the waves that a contact line models.
    alone: f64,
}

impl CriticalSpeed {
    /// Makes the tables for the scene's geometry and materials.
    pub fn new(scene: &Scene) -> CriticalSpeed {
        let mut families = Families::of(scene);
        if families.is_neutral() {
            return CriticalSpeed { all: Table::default(), modelled: Table::default(), alone: f64::INFINITY };
        }
        let (mut all, mut modelled) = (Table::default(), Table::default());
        for k in 0..SPEEDS {
            let [every, own] = families.least(speed_at(k as f64));
            all.push(every / speed_at(k as f64));
            modelled.push(own / speed_at(k as f64));
        }
        CriticalSpeed { all, modelled, alone: families.alone() }
    }

    /// The critical speed at this friction coefficient, m/s; 0: nothing grows. Relative error of the table: 2e-3, none
    /// for one conductor on an insulator.
    pub fn at<S: Scalar>(&self, friction: S) -> S {
        self.all.at(friction)
    }

    /// The critical speed of the waves that a contact line models: without those of a strip's other face, m/s; 0: nothing grows.
    pub fn modelled(&self, friction: f64) -> f64 {
        self.modelled.at(friction)
    }

    /// What grows at this speed, m/s, for a message.
    pub fn what_grows(&self, friction: f64, speed: f64) -> &'static str {
        let own = self.modelled(friction);
        if own > 0.0 && speed > own {
            "from which on a pressure wave grows"
        } else {
            "from which on a wave grows that bends the strip between its two faces; the contact line models one face and does \
             not show it"
        }
    }

    /// A speed below which nothing that a contact line models grows at this friction coefficient, m/s: either body taken for
    /// the only one that takes heat up. What the mate takes up besides only raises it.
    pub fn harmless(&self, friction: f64) -> f64 {
        self.alone / friction
    }
}

/// Logarithms of Z/V, falling, at the speeds of the table; empty where nothing can grow.
#[derive(Clone, PartialEq, Debug, Default)]
struct Table(Vec<f64>);

impl Table {
    /// What has grown at a lower speed grows at a higher one.
    fn push(&mut self, value: f64) {
        let lowest = self.0.last().copied().unwrap_or(f64::INFINITY);
        self.0.push(value.ln().min(lowest));
    }

    fn at<S: Scalar>(&self, friction: S) -> S {
        if friction.value() <= 0.0 || self.0.last().is_none_or(|last| !last.is_finite()) {
            return S::from(0.0);
        }
        let wanted = friction.value().ln();
        // Outside the table the last slope goes on.
        let first = self.0.partition_point(|value| !value.is_finite());
        let above = self.0.partition_point(|&value| value > wanted).clamp((first + 1).min(SPEEDS - 1), SPEEDS - 1);
        let (left, right) = (self.0[above - 1], self.0[above]);
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

#[cfg(test)]
mod tests;
