//! Directional derivatives of outputs against differences of get after set.

use crate::{Drive, Random, reference};
use scene::variables::{COUNT, Kind, Row, ValueReference, lookup};

/// Inputs with a typical size of each, in its SI unit.
pub const INPUTS: [(&str, f64); 7] = [
    ("sliding_velocity", 5.0),
    ("normal_load", 4e3),
    ("angular_velocity", 20.0),
    ("ambient_temperature_offset", 20.0),
    ("cooling_velocity", 5.0),
    ("strip.external_temperature", 300.0),
    ("punch.external_temperature", 300.0),
];

/// Friction by a table of the speed.
pub const FRICTION_TABLE: [(&str, f64); 9] = [
    ("contact.static_friction_ratio", 1.0),
    ("contact.friction_table.points", 4.0),
    ("contact.friction_table.speed[2]", 1.0),
    ("contact.friction_table.speed[3]", 4.0),
    ("contact.friction_table.speed[4]", 15.0),
    ("contact.friction_table.coefficient[1]", 0.5),
    ("contact.friction_table.coefficient[2]", 0.45),
    ("contact.friction_table.coefficient[3]", 0.3),
    ("contact.friction_table.coefficient[4]", 0.35),
];

/// One to `most` steps of random length up to `longest` (s) at random inputs; the last inputs.
pub fn run_at_random(drive: &mut Drive, random: &mut Random, most: f64, longest: f64) -> [f64; 7] {
    let direction = if random.next() < 0.5 { -1.0 } else { 1.0 };
    let mut inputs = [0.0; 7];
    for _ in 0..1 + (most * random.next()) as usize {
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
        drive.step(random.between(0.05, longest));
    }
    inputs
}

/// Compares the derivatives of real outputs with differences. Checks that those named in `answering` have one other than 0. On a
/// contact line the cells' pressures belong to them, and entries at a kink, with a derivative on each side, do not count; returns their
/// share.
///
/// # Panics
/// Where one differs by more than 1e-6 of the largest of its output.
pub fn assert_derivatives(
    on_line: bool,
    cases: impl IntoIterator<Item = (Drive, [f64; 7])>,
    answering: &[&str],
) -> f64 {
    let answers = |row: &Row| {
        (row.is_result() || (on_line && row.name == "profile.pressure")) && matches!(row.kind, Kind::Real { .. })
    };
    let (references, names): (Vec<ValueReference>, Vec<String>) = (0..COUNT as ValueReference)
        .filter_map(|reference| {
            let (row, element) = lookup(reference)?;
            answers(row).then(|| (reference, row.element_name(element)))
        })
        .unzip();
    let mut nonzero = vec![false; names.len()];
    let (mut failed, mut kinks, mut compared) = (Vec::new(), 0, 0);
    for (case, (mut drive, inputs)) in cases.into_iter().enumerate() {
        // Entries scaled by a typical size of the input, so that they compare.
        let mut entries = vec![[(0.0, 0.0); 7]; names.len()];
        for (index, (name, size)) in INPUTS.iter().enumerate() {
            let mut exact = vec![0.0; names.len()];
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
            for output in 0..names.len() {
                // Richardson: the error falls with the sixth power of the step.
                let first = (4.0 * narrow[output] - wide[output]) / 3.0;
                let second = (4.0 * finest[output] - narrow[output]) / 3.0;
                let numeric = (16.0 * second - first) / 15.0;
                compared += 1;
                // Where a cell lifts off, or another one carries the largest pressure, there is a derivative on each side. Rounding of the
                // values, tens of units in the last place, over the least differences is none.
                let size_of = numeric.abs().max(exact[output].abs() * size);
                let rounding = 5e-11 * middle[output].abs();
                let at_kink = (forward[output] - backward[output]).abs() > 0.02 * size_of + rounding
                    || (second - first).abs() > 1e-4 * size_of + 0.1 * rounding;
                if on_line && at_kink {
                    kinks += 1;
                    entries[output][index] = (numeric, numeric);
                    continue;
                }
                entries[output][index] = (exact[output] * size, numeric);
                nonzero[output] |= exact[output] != 0.0;
            }
        }
        for ((row, name), &output) in entries.iter().zip(&names).zip(&references) {
            let largest = row.iter().map(|entry| entry.1.abs()).fold(0.0, f64::max);
            // Rounding of a difference of values.
            let rounding = 1e-11 * drive.0.get(output).abs();
            // Differences over a point of the table of critical speeds mix the slopes on both sides of it.
            let relative = if name == "critical_speed" { 1e-5 } else { 1e-6 };
            for (entry, (input, _)) in row.iter().zip(INPUTS) {
                if (entry.0 - entry.1).abs() > relative * largest + rounding {
                    failed.push(format!("case {case}: d {name} / d {input}: {entry:?}, largest {largest}"));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} differ:\n{}", failed.len(), failed[..failed.len().min(30)].join("\n"));
    for name in answering {
        assert!(nonzero[names.iter().position(|other| other == name).unwrap()], "{name} has no derivative");
    }
    f64::from(kinks) / f64::from(compared)
}
