//! Critical speed of thermoelastic instability: above it friction heat makes a pressure wave grow.
//!
//! Two layers of the bodies' own heights slide on each other at the speed V. A wave of wave number q and constant amplitude moves
//! at the speed c relative to the punch; in the frame of body i it moves at `c_i` (c for the punch, c - V for the strip). By the
//! heat uptake and thermal lift of the layers ([`layer`]) the wave is neutral where
//!
//! ```text
//! mu V = Z(V, c).
//! ```
//!
//! The imaginary part gives c, the real part V. A half-plane on an insulator: c = 0 and V = 2 K q/(mu alpha (1+nu) E*),
//! explicitly. A wave at rest in one of two conductors moves over the other, which absorbs far more heat than if the wave were at
//! rest in it too: for a pair of steel and lining the formula of neither body alone is close.
//!
//! Admissible waves, by geometry:
//! - periodic: whole waves on the path, every c from 0 to V;
//! - line: from half a wave across the width where the holder prevents rotation of the punch, from a whole one where it permits
//!   rotation. c = 0, since a wave moving relative to the punch leaves the contact; on a closed path also c = V (hot spots of a
//!   disc), which are heated for the fraction of each revolution that the punches cover;
//! - annular: around the full ring as in periodic contact, under a shorter punch as on a line; and across the width, where there
//!   is no motion along the wave (bands), from half a wave.
//!
//! Layers: the punch is bonded at its top, the strip bonded or smooth at its base, with the thermal conditions of the scene
//! there. Where `contact.faces` = 2 and the strip's base is insulated, the base is the mid plane of a strip between two punches:
//! then the waves of both faces may also be symmetric (a smooth base) or antisymmetric (a strip that bends, with constant
//! temperature of its mid plane). The antisymmetric ones grow first in a thin disc between soft pads. A contact line does not
//! resolve them, with its single face and the base of the scene: [`CriticalSpeed::modelled`] excludes them.
//!
//! The lowest critical speed over all admissible waves is taken: in half-planes that of the longest wave, in layers often of a
//! shorter one. From q h = 4 on layers are half-planes, so the search ends there.
//!
//! Shear coupling changes the critical speed by the order of (mu (1-2nu)/(2(1-nu)))^2 and is neglected, and so are the edges of
//! the contact, which stabilise the longest waves: a punch of a wave's or half a wave's width may be stable up to twice the
//! speed. Sources: R. A. Burton, V. Nerlikar, S. R. Kilaparti, Thermoelastic instability in a seal-like configuration, Wear 24
//! (1973) 177-188; K. Lee, J. R. Barber, Frictionally excited thermoelastic instability in automotive disk brakes, J. Tribology
//! 115 (1993) 607-614.
//!
//! Theory: docs/theory.md, section 7.4.

pub(crate) mod layer;
mod waves;

use numerics::scalar::Scalar;
use scene::message::Number;
use scene::{Body, Scene};
use std::fmt;
pub(crate) use waves::FarFaces;
use waves::{Families, Least};

/// First speeds of the table: number, four per decade from 1e-5 to 1e4 m/s.
const SPEEDS: usize = 37;
/// Decades of speeds above, one speed each, up to 1e12 m/s: no input is larger, and what grows only above it does not grow.
const FAST_DECADES: usize = 8;

/// Number of speeds from one comparison of all waves to the next; between, the minimum is followed from neighbour to neighbour.
const COMPARED: usize = 6;

/// Friction coefficients, over that of the scene, between which the table is refined.
const REFINED: [f64; 2] = [1.0 / 3.0, 3.0];

/// Relative error of the critical speed above which an interval of the table is halved, length (in the logarithm of the speed) from
/// which on it is halved in any case, and largest number of halvings.
const ERROR: f64 = 3e-3;
const LONG: f64 = 0.3;
const MOST_HALVINGS: usize = 120;

/// Critical speed as a function of the friction coefficient, by tables built once for a scene.
#[derive(Clone, PartialEq, Debug)]
pub struct CriticalSpeed {
    /// Tables for all waves, and for those that a contact line resolves.
    all: Table,
    modelled: Table,
    /// Least Z of one body by itself at rest, m/s, over the waves that a contact line resolves.
    alone: f64,
    /// Product of speed and friction coefficient, m/s, below which nothing grows; half the least of the table, whose last slopes are
    /// extrapolated.
    least_product: f64,
}

impl CriticalSpeed {
    /// Builds the tables for the scene's geometry and materials.
    pub fn new(scene: &Scene) -> CriticalSpeed {
        let families = Families::of(scene);
        if families.is_neutral() {
            return CriticalSpeed {
                all: Table::default(),
                modelled: Table::default(),
                alone: f64::INFINITY,
                least_product: f64::INFINITY,
            };
        }
        let mut points: Vec<SpeedPoint> = Vec::with_capacity(SPEEDS);
        for k in 0..SPEEDS {
            let near = if k % COMPARED == 0 { None } else { points.last().map(|point| &point.least) };
            points.push(SpeedPoint::new(&families, (1e-5 * 10f64.powf(k as f64 / 4.0)).ln(), near));
        }
        for decade in 1..=FAST_DECADES {
            let speed = points[SPEEDS - 1].speed + decade as f64 * 10f64.ln();
            points.push(SpeedPoint::new(&families, speed, None));
        }
        let range = REFINED.map(|part| (part * scene.friction_coefficient).ln());
        let interval =
            |left: &SpeedPoint, right: &SpeedPoint| SpeedInterval::new(&families, range, left.clone(), right.clone());
        let mut intervals: Vec<SpeedInterval> = points.windows(2).map(|pair| interval(&pair[0], &pair[1])).collect();
        for _ in 0..MOST_HALVINGS {
            let error = |interval: &SpeedInterval| interval.error;
            let largest = numerics::maximum::largest(intervals.iter().map(error));
            let worst = intervals.iter().position(|interval| interval.error == largest && largest > ERROR);
            let Some(worst) = worst else { break };
            let SpeedInterval { left, middle, right, .. } = intervals[worst].clone();
            intervals[worst] = interval(&left, &middle);
            intervals.insert(worst + 1, interval(&middle, &right));
        }
        let refined = || points.iter().take(1).chain(intervals.iter().flat_map(|own| [&own.middle, &own.right]));
        let [all, modelled] = [0, 1].map(|waves| Table::new(refined().map(|own| [own.speed, own.values()[waves]])));
        let least_product = 0.5 * all.0.iter().map(|[speed, value]| speed + value).fold(f64::INFINITY, f64::min).exp();
        CriticalSpeed { all, modelled, alone: families.alone(), least_product }
    }

    /// Critical speed at this friction coefficient, m/s; 0: nothing grows below 1e12 m/s. Relative error of the table: 5e-3 within a
    /// factor of three of the scene's friction coefficient, none for one conductor on an insulator.
    pub fn at<S: Scalar>(&self, friction: S) -> S {
        self.all.at(friction)
    }

    /// Critical speed of the waves that a contact line resolves, without those of a strip's other face, m/s; 0: nothing grows.
    pub fn modelled(&self, friction: f64) -> f64 {
        self.modelled.at(friction)
    }

    /// Whether pressure perturbations may grow at this friction coefficient and speed, m/s. The table costs logarithms, and most steps are
    /// far below it.
    #[inline]
    pub(crate) fn may_be_exceeded(&self, friction: f64, speed: f64) -> bool {
        friction > 0.0 && speed * friction > self.least_product
    }

    /// Whether nothing grows at any speed.
    pub(crate) fn is_neutral(&self) -> bool {
        self.all.0.is_empty()
    }

    /// Writes the message that perturbations have grown by `exp(exponent)`, at this speed, m/s. `resolved`: the level has the
    /// temperature along the contact.
    pub(crate) fn write_message(
        &self,
        text: &mut dyn fmt::Write,
        exponent: f64,
        friction: f64,
        speed: f64,
        resolved: bool,
    ) -> fmt::Result {
        let own = self.modelled(friction);
        let grows = if own > 0.0 && speed > own {
            "the critical speed"
        } else {
            "the critical speed of an antisymmetric mode, which bends the strip between its two faces; the contact line \
             models one face and does not contain that mode"
        };
        let missing =
            if resolved { "" } else { "; this level has one temperature along the contact and does not show them" };
        write!(
            text,
            "thermoelastically unstable: pressure perturbations may have grown by exp({exponent:.1}) since the start of the run, \
             sliding at {} m/s now; {} m/s is {grows}{missing}",
            Number(speed),
            Number(self.at(friction))
        )
    }

    /// Lower bound of the critical speed of the waves that a contact line resolves, at this friction coefficient, m/s: with only
    /// one body absorbing heat, the more unstable one. Heat uptake by the mate increases the critical speed.
    pub(crate) fn stable_speed(&self, friction: f64) -> f64 {
        self.alone / friction
    }
}

/// Least impedances at a speed.
#[derive(Clone, Debug)]
struct SpeedPoint {
    /// Logarithm of the speed (m/s).
    speed: f64,
    least: Least,
}

impl SpeedPoint {
    fn new(families: &Families, speed: f64, near: Option<&Least>) -> SpeedPoint {
        SpeedPoint { speed, least: families.least(speed.exp(), near) }
    }

    /// Logarithms of Z/V over all waves, and over those that a contact line resolves.
    fn values(&self) -> [f64; 2] {
        [self.least.all, self.least.modelled].map(|least| least.ln() - self.speed)
    }
}

/// Interval of the table.
#[derive(Clone, Debug)]
struct SpeedInterval {
    left: SpeedPoint,
    middle: SpeedPoint,
    right: SpeedPoint,
    /// Estimated relative error of the critical speed by linear interpolation between its ends; at most its length. 0 outside the
    /// refined range.
    error: f64,
}

impl SpeedInterval {
    /// Interval between two points, refined for values of ln(Z/V) in `range`.
    fn new(families: &Families, range: [f64; 2], left: SpeedPoint, right: SpeedPoint) -> SpeedInterval {
        let length = right.speed - left.speed;
        let (from, to) = (left.values(), right.values());
        if (0..2).all(|waves| from[waves] <= range[0] || to[waves] >= range[1]) {
            return SpeedInterval { middle: right.clone(), left, right, error: 0.0 };
        }
        let middle = SpeedPoint::new(families, left.speed + 0.5 * length, Some(&left.least));
        let between = middle.values();
        let error = |waves: usize| {
            let (from, between, to) = (from[waves], between[waves], to[waves]);
            // Where growth begins within the interval only its length counts.
            let error = (0.5 * (from + to) - between).abs() / ((from - to) / length).abs();
            if error < length { error } else { length }
        };
        let error = if length > LONG { length } else { error(0).max(error(1)) };
        SpeedInterval { left, middle, right, error }
    }
}

/// Logarithms of speed and Z/V, the latter decreasing; empty where nothing can grow.
#[derive(Clone, PartialEq, Debug, Default)]
struct Table(Vec<[f64; 2]>);

impl Table {
    /// Each value is limited by the previous ones: a wave unstable at a lower speed remains unstable at a higher one. Where the values
    /// fall below this limit again is a point of the table.
    fn new(points: impl Iterator<Item = [f64; 2]>) -> Table {
        let mut table: Vec<[f64; 2]> = Vec::new();
        let mut before = [f64::NAN; 2];
        let mut lowest = f64::INFINITY;
        for [speed, value] in points {
            let [last_speed, last] = before;
            if last.is_finite() && last > lowest && value < lowest {
                table.push([last_speed + (speed - last_speed) * (last - lowest) / (last - value), lowest]);
            }
            lowest = lowest.min(value);
            table.push([speed, lowest]);
            before = [speed, value];
        }
        Table(table)
    }

    fn at<S: Scalar>(&self, friction: S) -> S {
        if friction.value() <= 0.0 || self.0.last().is_none_or(|[_, last]| !last.is_finite()) {
            return S::from(0.0);
        }
        let wanted = friction.value().ln();
        let (first, last) = (self.0.partition_point(|[_, value]| !value.is_finite()), self.0.len() - 1);
        let above = self.0.partition_point(|&[_, value]| value > wanted);
        if above > last {
            return S::from(0.0);
        }
        // Below the lowest speed the first slope is extrapolated.
        let above = above.max((first + 1).min(last));
        let ([slow, left], [fast, right]) = (self.0[above - 1], self.0[above]);
        // Flat piece: a wave that appears at this speed.
        let fall = (left - right).max(1e-9);
        // V = V_left (stiffness_left/friction)^(d ln V/d ln friction).
        let ratio = friction * (-left).exp();
        ratio.powf(-(fast - slow) / fall) * slow.exp()
    }
}

/// Body in which the waves that grow first are at rest, the better conductor of those with thermal expansion: a wave at rest in
/// the other one moves over it and is cooled.
pub(crate) fn driving_body(scene: &Scene) -> Option<&Body> {
    [&scene.punch, &scene.strip]
        .into_iter()
        .filter(|body| body.conductivity > 0.0 && body.thermal_expansion > 0.0)
        .max_by(|one, other| one.conductivity.total_cmp(&other.conductivity))
}

#[cfg(test)]
mod tests;
