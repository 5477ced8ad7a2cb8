//! Growth of pressure perturbations above the critical speed.

use model::growth::PerturbationGrowth;
use scene::{Geometry, ThermalBoundary};
use test_support::{changed_scene, scene};

/// The bound of the growth rate vanishes below the critical speed and rises above it; a mode of a strip between two faces, which no
/// level contains, counts.
#[test]
fn perturbations_grow_above_the_critical_speed_only() {
    let starts = scene("hot_spots");
    let scene = changed_scene(&starts, &[]);
    let growth = PerturbationGrowth::new(&scene);
    let friction = scene.friction_coefficient;
    let speed = growth.critical.at(friction);
    let [below, above, twice] = [0.99, 1.1, 2.0].map(|ratio| growth.rate(friction, ratio * speed));
    assert!(below == 0.0 && above > 0.0 && twice > above && twice.is_finite(), "{below} {above} {twice}");
    // A thin ring of iron between two pads bends.
    let mut ring = changed_scene(&self::scene("disc_brake"), &[]);
    (ring.geometry, ring.faces, ring.smooth_base) = (Geometry::Periodic, 2.0, true);
    (ring.width, ring.length, ring.punch.height, ring.strip.height) = (0.7, 0.7, 0.02, 0.0055);
    (ring.strip.far_thermal, ring.punch.thermal_expansion) = (ThermalBoundary::Insulated, 0.0);
    let growth = PerturbationGrowth::new(&ring);
    let (all, modelled) = (growth.critical.at(friction), growth.critical.modelled(friction));
    assert!(all > 0.0 && all < 0.9 * modelled, "{all} {modelled}");
    let rates = [0.99 * all, 1.01 * all].map(|speed| growth.rate(friction, speed));
    assert!(rates[0] == 0.0 && rates[1] > 0.0 && rates[1].is_finite(), "{rates:?}");
}
