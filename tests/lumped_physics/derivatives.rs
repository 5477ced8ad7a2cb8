//! Directional derivatives of every output against differences of get after set, on random scenes.

use test_support::derivatives::{FRICTION_TABLE, INPUTS, assert_derivatives, run_at_random};
use test_support::{Drive, Random, reference};

/// A random scene that has run for a random time, and the inputs it is at.
fn scene(random: &mut Random, special: u32) -> (Drive, [f64; 7]) {
    let boundary = |random: &mut Random| 1.0 + (4.0 * random.next()).floor();
    let mut changes = vec![
        ("punch.top_thermal", boundary(random)),
        ("strip.base_thermal", boundary(random)),
        ("strip.external_temperature", 320.0),
        ("punch.external_temperature", 310.0),
        ("punch.emissivity", random.next()),
        ("strip.emissivity", random.next()),
        ("punch.convection_forced", random.between(0.0, 50.0)),
        ("strip.convection_forced", random.between(0.0, 50.0)),
        ("contact.conductance", 10_f64.powf(random.between(2.0, 7.0))),
        ("contact.static_friction_ratio", random.between(1.0, 1.5)),
        ("contact.stribeck_velocity", random.between(0.1, 3.0)),
        ("punch.wear_pressure_exponent", random.between(0.4, 2.0)),
        ("punch.wear_velocity_exponent", random.between(0.2, 2.0)),
        ("punch.wear_threshold", 2e4),
        ("strip.wear_velocity_exponent", random.between(0.2, 2.0)),
        ("contact.geometry", 1.0 + (2.0 * random.next()).floor()),
        ("contact.faces", 1.0 + (3.0 * random.next()).floor()),
    ];
    let fade =
        ["contact.friction_fade.factor[1]", "contact.friction_fade.factor[2]", "contact.friction_fade.factor[3]"];
    for (name, factor) in fade.into_iter().zip([1.0, 0.8, 0.6]) {
        changes.push((name, factor * random.between(0.9, 1.1)));
    }
    changes.push(("punch.wear_fade.factor[2]", random.between(1.0, 3.0)));
    match special {
        1 => changes.push(("holder.stiffness", 1e7)),
        2 => changes.extend([("contact.stick_stiffness", 1e6), ("contact.stick_damping", 1e3)]),
        3 => changes.push(("contact.regularization_velocity", random.between(0.1, 2.0))),
        4 => changes.extend([("strip.path", 1.0), ("contact.geometry", 1.0), ("nominal.stroke", 0.05)]),
        7 => changes.extend([
            ("punch.external_conductance", 10_f64.powf(random.between(-1.0, 3.0))),
            ("strip.external_conductance", 10_f64.powf(random.between(-1.0, 3.0))),
            ("punch.top_thermal", 2.0 + (2.0 * random.next()).floor()),
            ("strip.base_thermal", 2.0 + (2.0 * random.next()).floor()),
        ]),
        6 => changes.extend(FRICTION_TABLE),
        _ => {}
    }
    let mut drive = Drive::stock(&changes);
    let inputs = run_at_random(&mut drive, random, 8.0, 3.0);
    (drive, inputs)
}

#[test]
fn derivatives_of_every_output_are_those_of_get_after_set() {
    let mut random = Random(20_240_229);
    let cases = (0..78).map(|case| scene(&mut random, if case < 60 { case % 6 } else { 6 + u32::from(case >= 66) }));
    let answering = [
        "friction_force",
        "friction_slope",
        "contact_temperature",
        "contact_temperature_max",
        "heat_flow_punch",
        "heat_flow_ambient",
        "heat_flow_punch_top",
        "heat_flow_strip_base",
        "heat_flow_punch_external",
        "heat_flow_strip_external",
        "wear_dissipation_power",
        "critical_speed",
        "approach",
        "friction_power",
        "friction_torque",
    ];
    assert_derivatives(false, cases, &answering);
}

#[test]
fn what_only_states_give_has_no_derivative_and_directions_add_up() {
    let mut random = Random(7);
    let (mut drive, _) = scene(&mut random, 0);
    let held = ["wear_depth", "sliding_distance", "dissipated_energy", "stored_heat", "remaining_life"].map(reference);
    let knowns = INPUTS.map(|(name, _)| reference(name));
    let mut result = [1.0; 5];
    drive.0.directional_derivative(&held, &knowns, &[1.0; 7], &mut result).unwrap();
    assert_eq!(result, [0.0; 5]);
    let force = [reference("friction_force"), reference("contact_temperature")];
    let mut sum = [0.0; 2];
    for known in knowns {
        let mut part = [0.0; 2];
        drive.0.directional_derivative(&force, &[known], &[0.5], &mut part).unwrap();
        sum = [sum[0] + part[0], sum[1] + part[1]];
    }
    let mut all = [0.0; 2];
    drive.0.directional_derivative(&force, &knowns, &[0.5; 7], &mut all).unwrap();
    assert!(sum.iter().zip(all).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs()), "{sum:?} {all:?}");
    assert!(drive.0.directional_derivative(&knowns[..1], &knowns, &[1.0; 7], &mut [0.0]).is_err());
    assert!(drive.0.directional_derivative(&force, &force, &[1.0; 2], &mut [0.0; 2]).is_err());
}
