//! Error weights: sensitivity of the contact temperature to errors of a body's thermal impedance.
//!
//! The error e of a model reduction is relative to the body's own temperature rise by a uniform flux over the whole duration D.
//! With the impedances Z1 and Z2 of both bodies (K m2/W, mean over the contact per uniform flux, at the real frequency s) and
//! half of the contact's resistance r, the heat partition gives the punch the fraction
//!
//! ```text
//! S(s) = (Z2 + r)/(Z1 + Z2 + 2 r)
//! ```
//!
//! of the friction heat q, and the contact temperature, the mean of both surfaces, rises by
//!
//! ```text
//! T(s) = [S Z1 + (1 - S) Z2] q/2,    dT/dZ1 = S^2 q.
//! ```
//!
//! An error `e Z1(1/D)` of the impedance at the frequency s is then, relative to the rise at the end of the duration,
//!
//! ```text
//! f(s) e,    f(s) = S(s)^2 Z1(1/D) q/T(1/D).
//! ```
//!
//! A block with little heat loss beside a strip with large heat loss reaches the strip's temperature and receives next to no heat
//! from then on. Its own rise by a constant flux would be a hundred times as high, and an error small relative to that need not
//! be small relative to the contact temperature.
//!
//! Theory: docs/theory.md, section 4.12.

use super::operators::{StripConduction, punch_slab};
use conduction::moving_source::Part;
use nalgebra::Complex;
use scene::Scene;

/// Frequencies per decade, and number of decades above 1/D.
const PER_DECADE: i32 = 2;
const DECADES: i32 = 5;

/// Least factor of a tolerance: where f is large only at frequencies at which the contact's resistance dominates, the body's own
/// impedance is already small.
const LEAST_WEIGHT: f64 = 0.1;

/// Error weight of a body: ratio of the relative error of the contact temperature to that of the body's own rise.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct ErrorWeight {
    /// 1/max f over the frequencies from 1/D on, from 0.1 to 1: factor from the tolerance of the contact temperature to that of
    /// the body's own rise.
    pub tolerance: f64,
    /// f(1/D), from 0.1 to 1: factor from the error of the body's own rise to that of the contact temperature.
    pub accounted: f64,
}

impl ErrorWeight {
    /// Weight of a body that receives all heat.
    pub(crate) const ALL: ErrorWeight = ErrorWeight { tolerance: 1.0, accounted: 1.0 };
}

/// Error weights of punch and strip.
pub(crate) fn error_weights(scene: &Scene) -> [ErrorWeight; 2] {
    if scene.punch.conductivity == 0.0 || scene.strip.conductivity == 0.0 {
        return [ErrorWeight::ALL; 2];
    }
    let (punch, strip) = (punch_slab(scene), StripConduction::of(scene));
    let source = strip.source(scene);
    let resistance = if scene.conductance > 0.0 { 0.5 / scene.conductance } else { 0.0 };
    let impedances = |frequency: f64| {
        let s = Complex::from(frequency);
        // Fresh material arrives without a temperature rise.
        let mean = if strip.is_endless() { 0.0 } else { strip.coverage * strip.slab.impedance(s, 0.0).re };
        let local = source.as_ref().map_or(0.0, |source| {
            let track = if source.has_track() { source.response(Part::Track, s, 0.0).re } else { 0.0 };
            source.response(Part::Flash, s, scene.nominal_velocity).re + track
        });
        [punch.impedance(s, 0.0).re, mean + local]
    };
    let share = |[punch, strip]: [f64; 2]| (strip + resistance) / (punch + strip + 2.0 * resistance);
    let slowest = 1.0 / scene.nominal_duration;
    let last = impedances(slowest);
    let taken = [share(last), 1.0 - share(last)];
    let rise = 0.5 * (taken[0] * last[0] + taken[1] * last[1]);
    let mut largest = taken;
    for k in 1..=DECADES * PER_DECADE {
        let share = share(impedances(slowest * 10f64.powf(f64::from(k) / f64::from(PER_DECADE))));
        largest = [largest[0].max(share), largest[1].max(1.0 - share)];
    }
    std::array::from_fn(|side| {
        let factor = |share: f64| share.powi(2) * last[side] / rise;
        ErrorWeight {
            tolerance: factor(largest[side]).recip().clamp(LEAST_WEIGHT, 1.0),
            accounted: factor(taken[side]).clamp(LEAST_WEIGHT, 1.0),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::ThermalBoundary;
    use scene::variables::STARTS;

    fn scene() -> Scene {
        let mut scene = Scene::new(&STARTS, None).expect("the start values are a scene");
        scene.nominal_duration = 1000.0;
        scene
    }

    #[test]
    fn a_block_that_keeps_its_heat_has_to_be_known_better_than_its_own_rise_asks() {
        let mut kept = scene();
        kept.strip.far_thermal = ThermalBoundary::Held;
        kept.punch.far_thermal = ThermalBoundary::Insulated;
        kept.punch.convection = 0.0;
        let mut held = kept.clone();
        held.punch.far_thermal = ThermalBoundary::Held;
        let ([punch, strip], [other, _]) = (error_weights(&kept), error_weights(&held));
        assert!(punch.tolerance < 0.5 && punch.accounted < 0.5, "{punch:?}");
        assert!(punch.accounted <= other.accounted, "kept {punch:?}, held {other:?}");
        assert!(strip.tolerance > 0.5 && strip.accounted > 0.5, "{strip:?}");
    }

    #[test]
    fn alone_a_body_is_judged_by_its_own_rise() {
        let mut alone = scene();
        alone.strip.conductivity = 0.0;
        assert_eq!(error_weights(&alone), [ErrorWeight::ALL; 2]);
    }
}
