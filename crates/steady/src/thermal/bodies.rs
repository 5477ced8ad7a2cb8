//! Existence of a thermal steady state, and bodies reduced for the time until it is reached.
//!
//! Theory: docs/theory.md, section 9.4.

use crate::SteadyError;
use model::lumped::air::transfer;
use scene::{Body, Geometry, InitialShape, Path, Scene, ThermalBoundary};

/// Rejects scenes without a steady state because no heat leaves: friction heats the bodies without limit.
pub(super) fn heat_leaves(scene: &Scene, speed: f64) -> Result<(), SteadyError> {
    let fresh = scene.path == Path::Straight && scene.nominal_stroke == 0.0 && scene.strip.conductivity > 0.0;
    if scene.friction_coefficient == 0.0 || fresh || leaves_punch(scene, speed) || leaves_strip(scene, speed) {
        return Ok(());
    }
    let conducts = |body: &Body| body.conductivity > 0.0;
    let closed = match (conducts(&scene.punch), conducts(&scene.strip)) {
        (false, false) => "neither body conducts",
        (true, false) => "only the punch conducts, its top is insulated and nothing cools its sides",
        (false, true) => "only the strip conducts, its base is insulated and nothing cools its top",
        (true, true) => "punch.top_thermal and strip.base_thermal are insulated and nothing cools the bodies' sides",
    };
    Err(SteadyError::NoHeatLeaves { closed })
}

fn through_far_face(body: &Body, scene: &Scene, speed: f64) -> bool {
    match body.far_thermal {
        ThermalBoundary::Held | ThermalBoundary::External => true,
        ThermalBoundary::Convecting => transfer(body.convection, body, scene, speed) > 0.0,
        ThermalBoundary::Insulated => false,
    }
}

fn leaves_punch(scene: &Scene, speed: f64) -> bool {
    let body = &scene.punch;
    let by_sides = scene.punch_cooled_area() > 0.0 && transfer(body.convection, body, scene, speed) > 0.0;
    body.conductivity > 0.0 && (through_far_face(body, scene, speed) || by_sides)
}

fn leaves_strip(scene: &Scene, speed: f64) -> bool {
    let body = &scene.strip;
    let free = scene.geometry != Geometry::Periodic;
    body.conductivity > 0.0
        && (through_far_face(body, scene, speed) || free && transfer(body.convection, body, scene, speed) > 0.0)
}

/// The scene with a nominal duration over which its reduced bodies are accurate until they are steady; without initial heat, and
/// under a dead load.
pub(super) fn with_steady_bodies(scene: &Scene, speed: f64) -> Scene {
    let mut scene = scene.clone();
    let (punch, strip) = (leaves_punch(&scene, speed), leaves_strip(&scene, speed));
    let time = |body: &Body, leaves: bool| -> f64 {
        if body.conductivity == 0.0 {
            return 0.0;
        }
        let diffusivity = body.diffusivity();
        let through = body.height * body.height / diffusivity;
        let transfer = transfer(body.convection, body, &scene, speed);
        let held = body.far_is_prescribed();
        if !leaves {
            let along = body.height + scene.width;
            // Duration until a steady state is reached along a strip without cooling, in units of the diffusion time over its height and
            // the contact's width together: its flux is 0 in the end.
            return 30.0 * along * along / diffusivity;
        }
        through + if held || transfer == 0.0 { 0.0 } else { body.areal_capacity() / transfer }
    };
    let slowest = time(&scene.punch, punch).max(time(&scene.strip, strip));
    // Duration until a steady state is reached, in units of the longest of the times in which heat leaves.
    scene.nominal_duration = scene.nominal_duration.max(5.0 * slowest);
    if scene.initial_shape == InitialShape::RunIn {
        scene.initial_shape = InitialShape::Flat;
    }
    for body in [&mut scene.punch, &mut scene.strip] {
        body.initial_temperature = 0.0;
    }
    scene.holder_stiffness = 0.0;
    scene
}
