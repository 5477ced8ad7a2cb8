//! Directional derivatives of every output against differences of get after set, on random scenes.

use scene::variables::{COUNT, Kind, ValueReference, lookup};
use test_support::{Drive, Random, reference};

const INPUTS: [(&str, f64); 7] = [
    ("sliding_velocity", 5.0),
    ("normal_load", 4e3),
    ("angular_velocity", 20.0),
    ("ambient_temperature_offset", 20.0),
    ("cooling_velocity", 5.0),
    ("strip.external_temperature", 300.0),
    ("punch.external_temperature", 300.0),
];

fn outputs() -> Vec<(ValueReference, String)> {
    (0..COUNT as ValueReference)
        .filter_map(|reference| {
            let (row, element) = lookup(reference)?;
            let real = matches!(row.kind, Kind::Real { .. });
            (row.is_result() && real).then(|| (reference, row.element_name(element)))
        })
        .collect()
}

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
        6 => changes.extend([
            ("contact.static_friction_ratio", 1.0),
            ("contact.friction_table.points", 4.0),
            ("contact.friction_table.speed[2]", 1.0),
            ("contact.friction_table.speed[3]", 4.0),
            ("contact.friction_table.speed[4]", 15.0),
            ("contact.friction_table.coefficient[1]", 0.5),
            ("contact.friction_table.coefficient[2]", 0.45),
            ("contact.friction_table.coefficient[3]", 0.3),
            ("contact.friction_table.coefficient[4]", 0.35),
        ]),
        _ => {}
    }
    let mut drive = Drive::stock(&changes);
    let direction = if random.next() < 0.5 { -1.0 } else { 1.0 };
    let mut inputs = [0.0; 7];
    for _ in 0..1 + (8.0 * random.next()) as usize {
        inputs = [
            direction * random.between(0.5, 8.0),
            random.between(1e3, 8e3),
            direction * random.between(0.0, 30.0),
            random.between(-20.0, 20.0),
            random.between(0.1, 10.0),
            random.between(290.0, 330.0),
            random.between(290.0, 330.0),
        ];
        for ((name, _), value) in INPUTS.iter().zip(inputs) {
            drive.set(name, value);
        }
        drive.step(random.between(0.05, 3.0));
    }
    (drive, inputs)
}

#[test]
fn derivatives_of_every_output_are_those_of_get_after_set() {
    let outputs = outputs();
    let references: Vec<ValueReference> = outputs.iter().map(|output| output.0).collect();
    let mut random = Random(20_240_229);
    let mut nonzero = vec![false; outputs.len()];
    let mut failed = Vec::new();
    for case in 0..78 {
        let special = if case < 60 { case % 6 } else { 6 + u32::from(case >= 66) };
        let (mut drive, inputs) = scene(&mut random, special);
        // Entries scaled by a typical size of the input, so that they compare.
        let mut entries = vec![[(0.0, 0.0); 7]; outputs.len()];
        for (index, (name, size)) in INPUTS.iter().enumerate() {
            let mut exact = vec![0.0; outputs.len()];
            drive.0.directional_derivative(&references, &[reference(name)], &[1.0], &mut exact).unwrap();
            let mut at = |offset: f64| -> Vec<f64> {
                drive.set(name, inputs[index] + offset * size);
                references.iter().map(|&output| drive.0.get(output)).collect()
            };
            let step = 4e-3;
            let difference = |high: Vec<f64>, low: Vec<f64>, width: f64| -> Vec<f64> {
                high.iter().zip(&low).map(|(a, b)| (a - b) / width).collect()
            };
            let wide = difference(at(step), at(-step), 2.0 * step);
            let narrow = difference(at(0.5 * step), at(-0.5 * step), step);
            let finest = difference(at(0.25 * step), at(-0.25 * step), 0.5 * step);
            drive.set(name, inputs[index]);
            for output in 0..outputs.len() {
                // Richardson: the error falls with the sixth power of the step.
                let first = (4.0 * narrow[output] - wide[output]) / 3.0;
                let second = (4.0 * finest[output] - narrow[output]) / 3.0;
                entries[output][index] = (exact[output] * size, (16.0 * second - first) / 15.0);
                nonzero[output] |= exact[output] != 0.0;
            }
        }
        for (output, row) in entries.iter().enumerate() {
            let largest = row.iter().map(|entry| entry.1.abs()).fold(0.0, f64::max);
            // Rounding of a difference of values.
            let rounding = 1e-11 * drive.0.get(references[output]).abs();
            for (entry, (name, _)) in row.iter().zip(INPUTS) {
                if (entry.0 - entry.1).abs() > 1e-6 * largest + rounding {
                    failed
                        .push(format!("case {case}: d {} / d {name}: {entry:?}, largest {largest}", outputs[output].1));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} differ:\n{}", failed.len(), failed[..failed.len().min(30)].join("\n"));
    // Whatever answers the inputs has been seen to.
    for name in [
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
    ] {
        assert!(nonzero[outputs.iter().position(|output| output.1 == name).unwrap()], "{name}");
    }
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
