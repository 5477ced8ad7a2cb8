//! Directional derivatives of every output against differences of get after set, on random scenes.

use super::contact::line;
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
            let answers = row.is_result() || row.name == "profile.pressure";
            (answers && real).then(|| (reference, row.element_name(element)))
        })
        .collect()
}

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
        10 => changes.extend([
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
        _ => changes.extend([("contact.initial_shape", 2.0), ("contact.initial_radius", 300.0)]),
    }
    // Resolved heat that distorts the shape, in half of the scenes; in the others it changes friction alone. Little of it,
    // so that nothing grows at these speeds.
    if random.next() < 0.5 {
        changes.extend([("punch.thermal_expansion", 2e-8), ("strip.thermal_expansion", 2e-8)]);
    }
    // Where nothing depends on the temperature (9: on an annulus), heat is lumped, and the contact temperature follows the present inputs.
    if special == 3 || special == 9 {
        for (name, value) in &mut changes {
            match *name {
                "contact.friction_fade.factor[2]" | "punch.wear_fade.factor[2]" => *value = 1.0,
                "punch.thermal_expansion" | "strip.thermal_expansion" => *value = 0.0,
                _ => {}
            }
        }
    }
    let mut drive = line(&changes);
    let direction = if random.next() < 0.5 { -1.0 } else { 1.0 };
    let mut inputs = [0.0; 7];
    for _ in 0..1 + (4.0 * random.next()) as usize {
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
        drive.step(random.between(0.05, 0.3));
    }
    (drive, inputs)
}

#[test]
fn derivatives_of_every_output_are_those_of_get_after_set() {
    let outputs = outputs();
    let references: Vec<ValueReference> = outputs.iter().map(|output| output.0).collect();
    let mut random = Random(20_240_229);
    let mut nonzero = vec![false; outputs.len()];
    let (mut failed, mut kinks, mut compared) = (Vec::new(), 0, 0);
    for case in 0..54 {
        let special = [case % 8, 8, 9, 10, 11][[40, 42, 46, 50].iter().filter(|&&from| case >= from).count()];
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
            let middle = at(0.0);
            let forward = difference(at(0.05 * step), middle.clone(), 0.05 * step);
            let backward = difference(middle.clone(), at(-0.05 * step), 0.05 * step);
            let wide = difference(at(step), at(-step), 2.0 * step);
            let narrow = difference(at(0.5 * step), at(-0.5 * step), step);
            let finest = difference(at(0.25 * step), at(-0.25 * step), 0.5 * step);
            drive.set(name, inputs[index]);
            for output in 0..outputs.len() {
                // Richardson: the error falls with the sixth power of the step.
                let first = (4.0 * narrow[output] - wide[output]) / 3.0;
                let second = (4.0 * finest[output] - narrow[output]) / 3.0;
                let numeric = (16.0 * second - first) / 15.0;
                compared += 1;
                // Where a cell lifts off, or another one carries the largest pressure, there is a derivative on each side.
                let size_of = numeric.abs().max(exact[output].abs() * size);
                let at_kink = (forward[output] - backward[output]).abs() > 0.02 * size_of
                    || (second - first).abs() > 1e-4 * size_of;
                // Outputs independent of the input differ by rounding.
                if at_kink && size_of > 1e-11 * middle[output].abs() {
                    kinks += 1;
                    entries[output][index] = (numeric, numeric);
                    continue;
                }
                entries[output][index] = (exact[output] * size, numeric);
                nonzero[output] |= exact[output] != 0.0;
            }
        }
        for (output, row) in entries.iter().enumerate() {
            let largest = row.iter().map(|entry| entry.1.abs()).fold(0.0, f64::max);
            // Rounding of a difference of values.
            let rounding = 1e-11 * drive.0.get(references[output]).abs();
            for (entry, (name, _)) in row.iter().zip(INPUTS) {
                // Differences over a point of the table of critical speeds mix the slopes on both sides of it.
                let relative = if outputs[output].1 == "critical_speed" { 1e-5 } else { 1e-6 };
                if (entry.0 - entry.1).abs() > relative * largest + rounding {
                    failed
                        .push(format!("case {case}: d {} / d {name}: {entry:?}, largest {largest}", outputs[output].1));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} differ:\n{}", failed.len(), failed[..failed.len().min(300)].join("\n"));
    assert!(kinks < compared / 20, "{kinks} of {compared} entries lie at a kink");
    // Whatever answers the inputs has been seen to.
    for name in [
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
    ] {
        assert!(nonzero[outputs.iter().position(|output| output.1 == name).unwrap()], "{name}");
    }
}
