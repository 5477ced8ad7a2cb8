//! How finely the heat of a body has to be known for the temperature of the contact.
//!
//! A reduction states its error e relative to the body's own rise by a uniform flux over the whole duration D. With the
//! impedances Z1 and Z2 of both bodies (K m2/W, mean over the contact per uniform flux, at the real frequency s) and half of the
//! contact's resistance r, the punch takes the share
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
//! An error `e Z1(1/D)` of the impedance at any frequency is then, relative to the rise at the end of the duration,
//!
//! ```text
//! e Z1(1/D) max S^2 q/T(1/D).
//! ```
//!
//! A block that keeps its heat beside a strip that gives it away warms up to the strip's temperature and takes next to nothing
//! from then on. Its own rise by a flux that lasts would be a hundred times as high, and an error that is small beside that is none
//! that is small beside the contact's.

use super::operators::{path_of, punch_slab, strip_slab};
use crate::heat::moving_source::{MovingSource, Part, Path};
use crate::scene::Scene;
use nalgebra::Complex;

/// Frequencies per decade, and decades above 1/D.
const PER_DECADE: i32 = 2;
const DECADES: i32 = 5;

/// T(1/D)/(Z(1/D) q max S^2) of punch and strip, at most 1: what the tolerance of the contact's temperature is multiplied by for that
/// of the body's own. 1 where the other body is an insulator.
pub fn shares(scene: &Scene) -> [f64; 2] {
    if scene.punch.conductivity == 0.0 || scene.strip.conductivity == 0.0 {
        return [1.0; 2];
    }
    let area = scene.contact_area() * scene.count;
    let (path, length) = path_of(scene);
    let endless = path == Path::Endless;
    let punch = punch_slab(scene, area);
    let (strip, coverage) = strip_slab(scene, area, length, endless);
    let source = (scene.coverage() < 1.0 - 1e-9).then(|| MovingSource::new(strip, 0.5 * scene.sliding_extent(), path));
    let resistance = if scene.conductance > 0.0 { 0.5 / scene.conductance } else { 0.0 };
    let impedances = |frequency: f64| {
        let s = Complex::from(frequency);
        // Fresh material brings nothing along.
        let mean = if endless { 0.0 } else { coverage * strip.impedance(s, 0.0).re };
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
    std::array::from_fn(|side| (rise / (last[side] * largest[side].powi(2))).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ThermalBoundary;
    use crate::variables::STARTS;

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
        let ([punch, strip], [other, _]) = (shares(&kept), shares(&held));
        assert!(punch < 0.5 * other && punch < 0.1, "kept {punch}, held {other}");
        assert!((0.3..=1.0).contains(&strip), "strip {strip}");
    }

    #[test]
    fn alone_a_body_is_judged_by_its_own_rise() {
        let mut alone = scene();
        alone.strip.conductivity = 0.0;
        assert_eq!(shares(&alone), [1.0; 2]);
    }
}
