//! Every output is finite, at every level, over random legal scenes far wider than the shipped ones: after initialisation, at inputs
//! that were just set, and after steps in which loads and speeds jump.

use sliding_contact::component::Snapshot;
use test_support::{Drive, Random, named, real_outputs, scene, scenes};

/// One of these values.
fn one_of<T: Copy>(random: &mut Random, values: &[T]) -> T {
    values[(random.next() * values.len() as f64) as usize]
}

/// Changes of a shipped scene.
fn changes(random: &mut Random) -> Vec<(&'static str, f64)> {
    let mut changes = Vec::new();
    for (body, insulates) in [("punch", false), ("strip", random.next() < 0.1)] {
        let own = [
            ("conductivity", if insulates { 0.0 } else { 10f64.powf(random.between(-1.0, 2.6)) }),
            ("thermal_expansion", one_of(random, &[0.0, 1e-7, 1e-6, 1.1e-5, 1.86e-5])),
            ("height", 10f64.powf(random.between(-2.7, -1.0))),
            ("youngs_modulus", 10f64.powf(random.between(6.0, 12.0))),
            ("poissons_ratio", random.between(0.0, 0.49)),
            ("convection", random.between(0.0, 200.0)),
            ("emissivity", one_of(random, &[0.0, 0.8])),
            ("wear_pressure_exponent", one_of(random, &[0.5, 1.0, 2.0])),
            ("wear_velocity_exponent", one_of(random, &[0.5, 1.0, 2.0])),
            ("wear_threshold", one_of(random, &[0.0, 0.0, 1e5, 1e7])),
        ];
        changes.extend(own.map(|(name, value)| named(format!("{body}.{name}"), value)));
    }
    changes.extend([
        ("strip.property_table.points", 0.0),
        ("contact.conductance", one_of(random, &[1e2, 1e4, 1e6, 1e9, 1e11, 1e13])),
        ("contact.friction_coefficient", random.between(0.02, 1.2)),
        ("contact.static_friction_ratio", one_of(random, &[1.0, 1.2, 1.5])),
        ("contact.stribeck_velocity", 10f64.powf(random.between(-3.0, 1.0))),
        ("contact.stick_stiffness", one_of(random, &[0.0, 1e6, 1e9])),
        ("contact.stick_damping", one_of(random, &[0.0, 1e-6, 1e3])),
        ("holder.stiffness", one_of(random, &[0.0, 0.0, 1e7])),
        ("solver.tolerance", one_of(random, &[1e-2, 1e-3])),
    ]);
    changes
}

fn sweep(level: &[(&'static str, f64)], count: u32) {
    let mut random = Random(864);
    let (outputs, shipped) = (real_outputs(), scenes());
    let (mut failed, mut refused, mut steps, mut failures) = (Vec::new(), Vec::new(), 0, Vec::new());
    for number in 0..count {
        let (name, load, velocity) = shipped[number as usize % shipped.len()];
        let changes = [&changes(&mut random)[..], level].concat();
        let mut drive = match Drive::attempt(&scene(name), &changes) {
            Ok(drive) => drive,
            Err(text) if text.contains("finite") => {
                failed.push(format!("{number} ({name}): {text}"));
                continue;
            }
            Err(text) => {
                refused.push(format!("{number} ({name}): {text}"));
                continue;
            }
        };
        let mut check = |drive: &mut Drive, when: &str| {
            for &output in &outputs {
                let value = drive.0.get(output);
                if !value.is_finite() {
                    failed.push(format!("{number} ({name}) {when}: {output} is {value}"));
                }
            }
        };
        check(&mut drive, "after initialisation");
        let length = 10f64.powf(random.between(-3.0, 1.0));
        for _ in 0..6 {
            let speed = velocity * one_of(&mut random, &[0.0, 1e-3, 0.3, 1.0, -1.0]);
            let load = load * one_of(&mut random, &[0.0, 1e-3, 0.3, 1.0]);
            drive.set("sliding_velocity", speed).set("normal_load", load);
            check(&mut drive, "before a step");
            steps += 1;
            if let Err(text) = drive.0.step(length) {
                // A punch that tips over, as it may at these friction coefficients, is told.
                if text.contains("no equilibrium of the contact") {
                    break;
                }
                failures.push(format!("{number} ({name}), {length} s at {speed} m/s, {load} N: {text}"));
                break;
            }
            check(&mut drive, "after a step");
        }
    }
    assert!(failed.is_empty(), "{} of {count}:\n{}", failed.len(), failed.join("\n"));
    assert!(4 * refused.len() < count as usize, "{} of {count} refused", refused.len());
    assert!(failures.len() <= steps / 200, "{} of {steps} steps fail", failures.len());
}

#[test]
fn outputs_are_finite_over_a_sweep_of_scenes_at_the_lumped_level() {
    sweep(&[("solver.fidelity", 2.0)], 1000);
}

#[test]
fn outputs_are_finite_over_a_sweep_of_scenes_on_the_contact_line() {
    sweep(&[("solver.fidelity", 3.0), ("solver.cells", 9.0)], 60);
}

/// A state with one of its numbers replaced by 1e61.
#[test]
fn a_state_beyond_its_range_is_refused_by_quantity_value_and_limit() {
    for (level, output, name) in [
        (2.0, "wear_depth_punch", "punch: wear depth (m)"),
        (2.0, "sliding_distance", "the sliding distance (m)"),
        (2.0, "bristle_deflection", "the bristle's deflection (m)"),
        (3.0, "pressure_max", "the pressure (Pa)"),
    ] {
        let changes = [("solver.fidelity", level), ("solver.cells", 9.0), ("contact.stick_stiffness", 1e6)];
        let mut drive = Drive::stock(&changes);
        drive.set("sliding_velocity", 1.0).set("normal_load", 1e3).step(1.0);
        let value = drive.get(output);
        let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
        drive.0.snapshot(&mut saved);
        saved.encode(&mut bytes);
        let mut again = Vec::new();
        Snapshot::decode(&bytes).unwrap().encode(&mut again);
        assert!(again == bytes, "{output}");
        let numbers = bytes.chunks_exact(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap()));
        let at = numbers.clone().position(|number| (number - value).abs() <= 1e-12 * value).expect(output);
        bytes[8 * at..8 * at + 8].copy_from_slice(&1e61_f64.to_le_bytes());
        let text = Snapshot::decode(&bytes).unwrap_err();
        assert!(text.contains(&format!("{name} is 1e61")) && text.contains("at most 1e60"), "{text}");
    }
}
