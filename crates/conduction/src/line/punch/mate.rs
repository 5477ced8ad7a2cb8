//! Ring of the mate under an annular contact.
//!
//! The mate rotates under the contact, so that every radius receives the circumferential mean of the flux: the contact's
//! flux times the fraction c of the circle that is covered. The ring is as wide as the contact; no heat passes its inner and
//! outer side. Its face is cooled beside the contact, also in the circumferential mean.
//!
//! Per length of the contact's mean arc the ring is equivalent to a body of 1/c times the conductivity, capacity and heat
//! transfer under the whole flux: the temperatures are the same, heat flows and stored heat are in the units of the contact.
//!
//! Theory: docs/theory.md, section 4.7.

use super::across::{Across, Sides};
use super::depth::Depth;
use super::distortion::Distortion;
use super::{By, Cooled, Wanted, project};
use crate::line::reduced::ReducedHeat;
use elasticity::block::BlockError;
use elasticity::{Base, Cells};
use scene::Scene;
use std::f64::consts::PI;

/// Cooled area of the mate per length of the contact's mean arc, m: as given, or the ring beside the contact.
pub fn cooled_length(scene: &Scene) -> f64 {
    let arcs = scene.depth * scene.count;
    let area = match scene.strip.cooled_area {
        0.0 => (2.0 * PI * scene.mean_radius - arcs) * scene.width,
        given => given,
    };
    (area / arcs).max(0.0)
}

/// Reduces the mate's ring as [`super::reduce`] does the punch.
///
/// None for an insulator.
///
/// # Errors
/// None: the distortion of a layer exists at any height.
pub fn reduce_mate(
    scene: &Scene,
    cells: &Cells,
    tolerance: f64,
    duration: f64,
) -> Result<Option<ReducedHeat>, BlockError> {
    let body = &scene.strip;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let spread = 1.0 / scene.coverage();
    let length = cooled_length(scene);
    let transfer = if length > 0.0 { body.convection } else { 0.0 };
    let depth = Depth { face: transfer * length / scene.width, ..Depth::new(body, spread) };
    let across = Across {
        half_width: cells.half_width(),
        sides: Sides::Radial(scene.mean_radius),
        cooled: 0.0,
        transfer: 0.0,
        conductivity: depth.conductivity,
    };
    let cooled = Cooled { by: By::Face, length, transfer, top_area: spread };
    let base = if scene.smooth_base { Base::Smooth } else { Base::Bonded };
    let distortion = Distortion::on_base(body, base);
    project(across, depth, cooled, distortion, cells, &Wanted { tolerances: [tolerance; 2], duration, divides: false })
        .map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::punch::tests::Run;
    use crate::line::{Boundary, Observed, Surroundings};
    use scene::variables::{STARTS, changed};

    /// A disc of 12 mm, 75 to 114 mm, with changed parameters.
    fn scene(changes: &[(&str, f64)]) -> Scene {
        let disc = [
            ("contact.geometry", 2.0),
            ("contact.mean_radius", 0.0945),
            ("punch.width", 0.039),
            ("depth", 0.1),
            ("punch.count", 2.0),
            ("strip.path", 2.0),
            ("strip.length", 0.0),
            ("strip.height", 0.012),
            ("strip.conductivity", 54.0),
            ("strip.density", 7200.0),
            ("strip.specific_heat", 460.0),
            ("strip.thermal_expansion", 1.1e-5),
            ("strip.poissons_ratio", 0.3),
            ("strip.convection", 40.0),
        ];
        Scene::new(&changed(&STARTS, &[&disc[..], changes].concat()).unwrap(), None).unwrap()
    }

    fn run(scene: &Scene, cells: &Cells) -> Run {
        Run::of(reduce_mate(scene, cells, 1e-3, 100.0).unwrap().unwrap())
    }

    const COOLED: [&[(&str, f64)]; 5] = [
        &[("strip.base_thermal", 3.0)],
        &[("strip.base_thermal", 3.0), ("strip.cooled_area", 0.1)],
        &[("strip.base_thermal", 2.0)],
        &[("strip.base_thermal", 1.0)],
        &[("strip.base_thermal", 3.0), ("strip.convection", 0.0)],
    ];

    #[test]
    fn the_ring_beside_the_contacts_is_cooled() {
        // Two pads over 0.1 m each of the mean circumference of 2 pi 0.0945 = 0.593761 m: 0.393761 m of it are free.
        let free = cooled_length(&scene(&[]));
        assert!((free - 0.393_761 * 0.039 / 0.2).abs() < 1e-7, "{free}");
        let one = cooled_length(&scene(&[("punch.count", 1.0)]));
        assert!((one - 0.493_761 * 0.039 / 0.1).abs() < 1e-6, "{one}");
        let given = cooled_length(&scene(&[("strip.cooled_area", 0.1)]));
        assert!((given - 0.5).abs() < 1e-15, "{given}");
        // A full ring has no free part.
        let full = cooled_length(&scene(&[("punch.count", 1.0), ("depth", 2.0 * PI * 0.0945)]));
        assert!(full.abs() < 1e-15, "{full}");
    }

    #[test]
    fn a_ring_as_warm_as_all_around_it_stays_so() {
        let cells = Cells::graded(0.0195, 9).unwrap();
        for changes in COOLED {
            let mut run = run(&scene(changes), &cells);
            run.surroundings = Surroundings::constant(Boundary { ambient: 7.0, far: 7.0, cooling: 0.0 });
            run.heat.uniform(7.0, &mut run.state);
            for _ in 0..10 {
                run.step(3.0, &[0.0; 9], &[0.0; 9]);
            }
            assert!(run.temperature.iter().all(|t| (t - 7.0).abs() < 7e-3), "{changes:?}: {:?}", run.temperature);
            // A layer on its base, constrained along it.
            let expected = -7.0 * 1.1e-5 * 1.3 / 0.7 * 0.012;
            let distortion = &run.distortion;
            assert!(distortion.iter().all(|u| (u / expected - 1.0).abs() < 2e-3), "{changes:?}: {distortion:?}");
            // Cooling from here on removes heat over its area.
            if changes.len() == 1 && changes[0].1 == 3.0 {
                let flows = run.heat.flows(&run.state, &run.surroundings, &[0.0; 9]);
                assert!(flows[0].abs() < 1e-2 * 40.0 * 7.0 * 0.077, "{flows:?}");
                run.surroundings.end.ambient = 0.0;
                let flows = run.heat.flows(&run.state, &run.surroundings, &[0.0; 9]);
                let expected = 40.0 * 7.0 * cooled_length(&scene(changes));
                assert!((flows[0] / expected - 1.0).abs() < 5e-3, "{flows:?} {expected}");
            }
        }
    }

    #[test]
    fn a_band_heats_and_bends_a_deep_ring_like_a_half_space() {
        // Mode 5 of the radius at rest: T = q/(K xi), curvature alpha (1 + nu) q/(K xi^2), K over the covered fraction.
        let count = 120;
        let cells = Cells::uniform(0.0195, count).unwrap();
        for changes in [&[("strip.base", 1.0)][..], &[("strip.base", 2.0)]] {
            let deep = [("strip.height", 0.2), ("strip.convection", 0.0), ("strip.base_thermal", 1.0)];
            let scene = scene(&[&deep[..], changes].concat());
            let across = Across {
                half_width: 0.0195,
                sides: Sides::Radial(0.0945),
                cooled: 0.0,
                transfer: 0.0,
                conductivity: 1.0,
            };
            let wave = across.wave(5);
            let weights = across.weights(&cells);
            let flux: Vec<f64> = wave.cell_integrals(&cells).iter().zip(&weights).map(|(f, w)| f / w).collect();
            let mut run = run(&scene, &cells);
            run.step(1e9, &flux, &flux);
            let conductivity = 54.0 / scene.coverage();
            let temperature = 1.0 / (conductivity * wave.wave_number);
            let bent = -1.1e-5 * 1.3 * temperature / wave.wave_number;
            let largest = flux.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
            for (i, q) in flux.iter().enumerate() {
                let error = (run.temperature[i] - q * temperature).abs() / (largest * temperature);
                assert!(error < 5e-3, "{i}: {error}");
                let error = ((run.distortion[i] - q * bent) / (largest * bent)).abs();
                assert!(error < 5e-3, "{i}: {error}");
            }
        }
    }
}
