//! Directional derivatives of every output against differences of get after set, on random scenes.

use super::contact::line;
use test_support::derivatives::{FRICTION_TABLE, assert_derivatives, run_at_random};
use test_support::{Drive, Random};

/// A random scene that has run for a random time, and the inputs it is at.
fn scene(random: &mut Random, special: u32) -> (Drive, [f64; 7]) {
    let mut changes = vec![
        ("solver.cells", 3.0 + (20.0 * random.next()).floor()),
        ("contact.static_friction_ratio", random.between(1.0, 1.5)),
        ("contact.stribeck_velocity", random.between(0.1, 3.0)),
        ("punch.wear_coefficient", 1e-13 * random.next()),
        ("punch.wear_pressure_exponent", random.between(0.4, 2.0)),
        ("punch.wear_velocity_exponent", random.between(0.2, 2.0)),
        ("punch.wear_threshold", 2e5),
        ("strip.wear_coefficient", 1e-13 * random.next()),
        ("strip.wear_velocity_exponent", random.between(0.2, 2.0)),
        ("contact.faces", 1.0 + (3.0 * random.next()).floor()),
        ("contact.friction_fade.factor[2]", random.between(0.7, 1.0)),
        ("punch.wear_fade.factor[2]", random.between(1.0, 3.0)),
        ("strip.body", 2.0 + (3.0 * random.next()).floor()),
    ];
    match special {
        1 => changes.push(("holder.stiffness", 1e8)),
        2 => changes.extend([("contact.stick_stiffness", 1e6), ("contact.stick_damping", 1e3)]),
        3 => changes.push(("contact.regularization_velocity", random.between(0.1, 2.0))),
        4 => changes.extend([("strip.path", 1.0), ("strip.length", 0.0), ("nominal.stroke", 0.05)]),
        5 => changes.extend([("holder.constraint", 2.0), ("holder.pivot_height", 0.03)]),
        6 | 9 => changes.extend([
            ("contact.geometry", 2.0),
            ("contact.mean_radius", 0.1),
            ("strip.length", 0.0),
            ("depth", 0.1),
            ("strip.body", 2.0),
        ]),
        11 => changes.extend([
            ("punch.external_conductance", random.between(1.0, 100.0)),
            ("punch.external_temperature", 310.0),
            ("strip.external_temperature", 320.0),
            ("strip.external_conductance", random.between(1.0, 100.0)),
            ("punch.top_thermal", 2.0 + (2.0 * random.next()).floor()),
            ("strip.base_thermal", 2.0 + (2.0 * random.next()).floor()),
        ]),
        10 => changes.extend(FRICTION_TABLE),
        _ => changes.extend([("contact.initial_shape", 2.0), ("contact.initial_radius", 300.0)]),
    }
    // Resolved heat that distorts the shape, in half of the scenes; in the others it changes friction alone. Little of it,
    // so that nothing grows at these speeds.
    if random.next() < 0.5 {
        changes.extend([("*.thermal_expansion", 2e-8)]);
    }
    // Where nothing depends on the temperature (9: on an annulus), heat is lumped, and the contact temperature follows the present inputs.
    if special == 3 || special == 9 {
        for (name, value) in &mut changes {
            match *name {
                "contact.friction_fade.factor[2]" | "punch.wear_fade.factor[2]" => *value = 1.0,
                "*.thermal_expansion" => *value = 0.0,
                _ => {}
            }
        }
    }
    let mut drive = line(&changes);
    let inputs = run_at_random(&mut drive, random, 4.0, 0.3);
    (drive, inputs)
}

#[test]
fn derivatives_of_every_output_are_those_of_get_after_set() {
    let mut random = Random(20_240_229);
    let cases = (0..54).map(|case| {
        let special = [case % 8, 8, 9, 10, 11][[40, 42, 46, 50].iter().filter(|&&from| case >= from).count()];
        scene(&mut random, special)
    });
    let answering = [
        "friction_force",
        "friction_slope",
        "contact_temperature",
        "heat_flow_punch",
        "pressure_mean",
        "pressure_max",
        "tilt",
        "approach",
        "effective_radius",
        "wear_dissipation_power",
        "profile.pressure[1]",
        "profile.pressure[20]",
        "friction_power",
        "friction_torque",
    ];
    let kinks = assert_derivatives(true, cases, &answering);
    assert!(kinks < 0.05, "{kinks} of the entries lie at a kink");
}
