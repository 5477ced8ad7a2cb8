//! Invariants of every scene, on random scenes and input histories: balances, symmetry, units, cuts, replays, independence.
//!
//! A failure names the number of its scene, from which the same scene is made again.

use scene::variables::{Kind, lookup};
use sliding_contact::component::Snapshot;
use test_support::{Drive, INSULATED, Random, property_table, real_outputs, scenes};

/// Communication steps of a run.
const STEPS: usize = 40;

/// A scene with changes, and the inputs at the start of each communication step: velocity, load and their derivatives.
struct Case {
    changes: Vec<(&'static str, f64)>,
    name: &'static str,
    step: f64,
    inputs: Vec<[f64; 4]>,
}

/// Level of a case.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Level {
    Lumped,
    /// Cells without thermal expansion, and with it.
    Cold,
    Hot,
}

const LEVELS: [Level; 3] = [Level::Lumped, Level::Cold, Level::Hot];

impl Case {
    /// The scene of this number at a level: a shipped one with random material, laws and inputs around its nominal ones.
    fn new(number: u64, level: Level) -> Case {
        let mut random = Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let shipped = scenes();
        let (name, load, velocity) = shipped[number as usize % shipped.len()];
        let mut changes = vec![
            ("contact.friction_coefficient", random.between(0.05, 0.6)),
            ("contact.conductance", 10f64.powf(random.between(3.0, 6.0))),
            ("punch.conductivity", 10f64.powf(random.between(0.0, 2.0))),
            ("strip.property_table.points", 0.0),
            ("strip.conductivity", 10f64.powf(random.between(0.5, 2.0))),
            ("punch.wear_pressure_exponent", random.between(0.5, 2.0)),
            ("punch.convection", random.between(0.0, 100.0)),
            ("strip.convection", random.between(0.0, 100.0)),
            ("solver.tolerance", 1e-3),
            ("solver.fidelity", if level == Level::Lumped { 2.0 } else { 3.0 }),
            ("solver.cells", [5.0, 9.0, 17.0][(3.0 * random.next()) as usize]),
            ("strip.wear_coefficient", if random.next() < 0.5 { 0.0 } else { 1e-15 }),
        ];
        if level == Level::Cold {
            changes.extend([("*.thermal_expansion", 0.0)]);
        }
        let step = random.between(0.005, 0.05);
        // A third of the histories reverses or stands still for a while, a third lifts off.
        let kind = (3.0 * random.next()) as usize;
        let largest = velocity * random.between(0.1, 1.0);
        let (period, phase) = (random.between(5.0, 40.0), random.between(0.0, 6.0));
        let at = |k: usize| {
            let wave = (phase + k as f64 * std::f64::consts::TAU / period).cos();
            let velocity = if kind == 0 { largest * wave } else { largest * (0.6 + 0.4 * wave) };
            let load = if kind == 1 { load * (0.4 - 0.6 * wave) } else { load * (0.6 + 0.3 * wave) };
            [velocity, load]
        };
        let inputs = (0..STEPS)
            .map(|k| {
                let ([velocity, load], [to, carried]) = (at(k), at(k + 1));
                [velocity, load, (to - velocity) / step, (carried - load) / step]
            })
            .collect();
        if number.is_multiple_of(3) {
            let (conductivity, specific_heat) = (random.between(5.0, 60.0), random.between(300.0, 900.0));
            let hot = random.between(295.0, 330.0);
            let [k, l, c, d] = [(0.7, 1.3), (0.5, 1.5), (1.0, 1.5), (1.0, 3.0)].map(|(a, b)| random.between(a, b));
            let points = [(250.0, 1.0, 1.0), (hot, k, c), (700.0, l, d)];
            let points = points.map(|(t, k, c)| (t, conductivity * k, specific_heat * c));
            changes.extend(property_table("strip", &points));
        }
        Case { changes, name, step, inputs }
    }

    fn has_table(&self) -> bool {
        self.changes.iter().any(|(name, points)| *name == "strip.property_table.points" && *points > 0.0)
    }

    fn drive(&self) -> Drive {
        self.attempt(&[]).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    fn attempt(&self, more: &[(&'static str, f64)]) -> Result<Drive, String> {
        Drive::attempt(&test_support::scene(self.name), &[&self.changes[..], more].concat())
    }

    fn set(&self, drive: &mut Drive, step: usize) {
        let [velocity, load, acceleration, loading] = self.inputs[step];
        drive.set("sliding_velocity", velocity).slope("sliding_velocity", acceleration);
        drive.set("normal_load", load).slope("normal_load", loading);
    }
}

/// Runs `check` on cases of every level, in each of which at least half of the communication steps succeed.
fn on_cases(count: u64, mut check: impl FnMut(&Case, Level, &str)) {
    for level in LEVELS {
        for number in 1..=count {
            let case = Case::new(number, level);
            check(&case, level, &format!("{level:?} {number} ({})", case.name));
        }
    }
}

fn values(drive: &mut Drive, of: &[u32]) -> Vec<f64> {
    of.iter().map(|&reference| drive.0.get(reference)).collect()
}

fn name(reference: u32) -> String {
    lookup(reference).map_or_else(String::new, |(row, element)| row.element_name(element))
}

/// The first of two lists of outputs that differ in their bits.
fn first_difference(of: &[u32], one: &[f64], other: &[f64]) -> Option<String> {
    let at = one.iter().zip(other).position(|(one, other)| one.to_bits() != other.to_bits())?;
    Some(format!("{} = {:e} and {:e}", name(of[at]), one[at], other[at]))
}

#[test]
fn heat_is_balanced_worn_volumes_grow_and_pressures_carry_the_load() {
    let of = real_outputs();
    on_cases(12, |case, level, text| {
        let mut drive = case.drive();
        let annular = drive.get("contact.geometry") == 2.0;
        let (mut worn, first) = ([0.0; 2], drive.get("strip.mean_temperature"));
        for step in 0..STEPS {
            case.set(&mut drive, step);
            drive.0.step(case.step).unwrap_or_else(|error| panic!("{text}, step {step}: {error}"));
            for (&reference, value) in of.iter().zip(values(&mut drive, &of)) {
                assert!(value.is_finite(), "{text}, step {step}: {} = {value}", name(reference));
            }
            // An enthalpy of a table is that of an absolute temperature: rounding of 1e-13 K in what it has risen by.
            let rounding =
                if case.has_table() { 1e-12 / (drive.get("strip.mean_temperature") - first).abs() } else { 0.0 };
            assert!(drive.imbalance() < 1e-9 + rounding, "{text}, step {step}: {:e} {rounding:e}", drive.imbalance());
            for (own, name) in worn.iter_mut().zip(["wear_volume_punch", "wear_volume_strip"]) {
                let now = drive.get(name);
                assert!(now >= *own, "{text}, step {step}: {name} from {own:e} to {now:e}");
                *own = now;
            }
            let estimated = drive.get("estimated_error");
            assert!((0.0..=1.0).contains(&estimated), "{text}, step {step}: estimated_error = {estimated}");
            if level == Level::Lumped {
                continue;
            }
            let pressure = drive.profile("pressure");
            assert!(pressure.iter().all(|p| *p >= 0.0), "{text}, step {step}: {pressure:?}");
            // The trapezoid sum over the stations is the integral over the cells; of an annulus it has no factor of the radius.
            let mean = pressure.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>() / 32.0;
            let given = drive.get("pressure_mean");
            if !annular {
                assert!((mean - given).abs() <= 1e-10 * given, "{text}, step {step}: {mean:e} {given:e}");
            }
        }
    });
}

/// Archard's law and constant friction: the heat stands for the load times the distance, on an annulus too.
#[test]
fn worn_masses_follow_from_the_heat_at_every_level_and_geometry() {
    let annulus = [("contact.geometry", 2.0), ("contact.mean_radius", 0.1), ("punch.width", 0.04), ("depth", 0.08)];
    let caliper = [("contact.faces", 2.0), ("holder.stiffness", 1e8)];
    let pads = [("contact.faces", 4.0), ("punch.count", 3.0)];
    let track = [("strip.path", 1.0), ("strip.length", 0.0)];
    for level in [2.0, 3.0] {
        for geometry in [&annulus[..], &caliper, &pads, &track] {
            for acceleration in [1.0, 8.0] {
                let own = [
                    ("solver.fidelity", level),
                    ("solver.cells", 9.0),
                    ("wear_acceleration", acceleration),
                    ("strip.wear_coefficient", 3e-15),
                    ("punch.airborne_fraction", 0.35),
                    ("strip.airborne_fraction", 0.1),
                ];
                let mut drive = Drive::stock(&[geometry, &own].concat());
                for (velocity, load) in [(4.0, 3e3), (2.0, 4e3), (0.0, 0.0)] {
                    drive.set("sliding_velocity", velocity).set("normal_load", load).step(0.2);
                }
                let way = drive.get("dissipated_energy") / drive.get("contact.friction_coefficient");
                let exact = [2600.0 * 2e-14, 7200.0 * 3e-15].map(|rate| rate * acceleration * way);
                let masses = ["wear_mass_punch", "wear_mass_strip"].map(|name| drive.get(name));
                for (mass, exact) in masses.into_iter().zip(exact) {
                    assert!(
                        (mass / exact - 1.0).abs() < 1e-9,
                        "{level} {geometry:?} {acceleration}: {mass:e} {exact:e}"
                    );
                }
                for (mass, volume, density) in
                    [(masses[0], "wear_volume_punch", 2600.0), (masses[1], "wear_volume_strip", 7200.0)]
                {
                    assert_eq!(mass, density * drive.get(volume));
                }
                assert_eq!(drive.get("wear_mass_airborne"), 0.35 * masses[0] + 0.1 * masses[1]);
            }
        }
    }
}

/// Largest number of internal steps, tried or accepted, that a communication step of these cases may take (largest: 286). Any
/// step ends with an error behind 200,000.
const MOST_INTERNAL_STEPS: u64 = 1000;

#[test]
fn a_step_of_tame_inputs_takes_few_internal_steps() {
    on_cases(12, |case, _, text| {
        let mut drive = case.drive();
        for step in 0..STEPS {
            case.set(&mut drive, step);
            let (accepted, rejected) = drive.0.work();
            drive.0.step(case.step).unwrap_or_else(|error| panic!("{text}, step {step}: {error}"));
            let (now_accepted, now_rejected) = drive.0.work();
            let taken = now_accepted - accepted + now_rejected - rejected;
            assert!((1..=MOST_INTERNAL_STEPS).contains(&taken), "{text}, step {step}: {taken} internal steps");
        }
    });
}

#[test]
fn sliding_the_other_way_mirrors_the_contact() {
    on_cases(8, |case, _, text| {
        // An annulus has an inner and an outer edge, and nothing to mirror.
        let mut drives = [case.drive(), case.drive()];
        let annular = drives[0].get("contact.geometry") == 2.0;
        for step in 0..STEPS {
            let [velocity, load, acceleration, loading] = case.inputs[step];
            for (drive, sign) in drives.iter_mut().zip([1.0, -1.0]) {
                drive.set("sliding_velocity", sign * velocity).slope("sliding_velocity", sign * acceleration);
                drive.set("normal_load", load).slope("normal_load", loading);
                drive.0.step(case.step).unwrap_or_else(|error| panic!("{text}, step {step}: {error}"));
            }
        }
        let mut alike = |name: &str, sign: f64| {
            let [one, other] = drives.each_mut().map(|drive| drive.get(name));
            assert!((one - sign * other).abs() <= 1e-7 * one.abs() + 1e-12, "{text}: {name} {one:e} {other:e}");
        };
        for name in
            ["contact_temperature", "wear_depth", "dissipated_energy", "contact_temperature_max", "pressure_max"]
        {
            alike(name, 1.0);
        }
        alike("friction_force", -1.0);
        if !annular {
            for station in 1..=33 {
                let [one, other] = drives.each_mut().map(|drive| drive.profile("pressure"));
                let largest = one.iter().fold(0.0, |most: f64, p| most.max(*p));
                let apart = (one[station - 1] - other[33 - station]).abs();
                assert!(apart <= 1e-6 * largest, "{text}, station {station}: {apart:e} of {largest:e}");
            }
        }
    });
}

#[test]
fn other_units_of_length_time_and_mass_are_the_same_run() {
    // What contains a constant of nature or of the wear law, 1 MPa, does not scale.
    let plain: &[(&str, f64)] = &[
        ("*.emissivity", 0.0),
        ("*.wear_pressure_exponent", 1.0),
        ("*.wear_velocity_exponent", 1.0),
        ("*.convection_forced", 0.0),
    ];
    let of = real_outputs();
    on_cases(8, |case, _, text| {
        let starts = test_support::changed(&test_support::scene(case.name), &[&case.changes[..], plain].concat());
        // Units of 1/2 m, 4 s and 1/8 kg.
        let factor = |reference: u32| -> f64 {
            let (row, _) = lookup(reference).unwrap();
            let Kind::Real { unit, .. } = row.kind else { return 1.0 };
            2f64.powi(i32::from(unit.m) - 2 * i32::from(unit.s) + 3 * i32::from(unit.kg))
        };
        let mut scaled = starts;
        for (index, value) in scaled.iter_mut().enumerate() {
            // A table without points stays as it is: changes without effect are refused.
            let table = ["contact.friction_table.", "punch.property_table.", "strip.property_table."]
                .into_iter()
                .find(|table| name(index as u32).starts_with(table));
            let points = |table: &str| starts[test_support::reference(&format!("{table}points")) as usize];
            let at =
                |name: String| name.rsplit_once('[').and_then(|(_, at)| at.trim_end_matches(']').parse::<f64>().ok());
            // Beyond the points of a table values keep their starts.
            if table.is_none_or(|table| at(name(index as u32)).is_none_or(|at| at <= points(table))) {
                *value *= factor(index as u32);
            }
        }
        let mut drives = [starts, scaled]
            .map(|starts| Drive::attempt(&starts, &[]).unwrap_or_else(|error| panic!("{text}: {error}")));
        let [velocity, load] = ["sliding_velocity", "normal_load"].map(test_support::reference);
        let second = 0.25;
        for step in 0..STEPS {
            let inputs = case.inputs[step];
            for (drive, own) in drives.iter_mut().zip([false, true]) {
                let by = |reference: u32, per: f64| if own { factor(reference) / per } else { 1.0 };
                drive.0.set_input(velocity, inputs[0] * by(velocity, 1.0));
                drive.0.set_input_derivative(velocity, inputs[2] * by(velocity, second));
                drive.0.set_input(load, inputs[1] * by(load, 1.0));
                drive.0.set_input_derivative(load, inputs[3] * by(load, second));
                let length = if own { second * case.step } else { case.step };
                drive.0.step(length).unwrap_or_else(|error| panic!("{text}, step {step}: {error}"));
            }
        }
        let [one, mut other] = drives.each_mut().map(|drive| values(drive, &of));
        for (value, &reference) in other.iter_mut().zip(&of) {
            *value /= factor(reference);
        }
        // Both runs solve to a tolerance of 1e-3, and where they end their iterations depends on the units. A heat flow that is the
        // small difference of large ones is measured against the largest output of its unit.
        let unit = |reference: u32| match lookup(reference).unwrap().0.kind {
            Kind::Real { unit, .. } => [unit.m, unit.s, unit.kg],
            _ => [0; 3],
        };
        let largest = |like: u32| {
            let same = of.iter().zip(&one).filter(|(reference, _)| unit(**reference) == unit(like));
            same.fold(0.0, |most: f64, (_, value)| most.max(value.abs()))
        };
        let apart: Vec<String> = (of.iter().zip(&one).zip(&other))
            .filter(|((reference, one), other)| {
                // The table of the critical speed has entries at given speeds in m/s.
                let allowed =
                    if name(**reference) == "critical_speed" { 0.01 * one.abs() } else { 1e-5 * largest(**reference) };
                let difference = (*one - *other).abs();
                difference.is_nan() || difference > allowed
            })
            .map(|((&reference, one), other)| format!("{} = {one:e} and {other:e}", name(reference)))
            .collect();
        assert!(apart.is_empty(), "{text}: {apart:#?}");
    });
}

#[test]
fn cutting_a_communication_step_stays_within_the_tolerance() {
    on_cases(8, |case, _, text| {
        let mut drives = [case.drive(), case.drive()];
        for step in 0..STEPS {
            let [velocity, load, acceleration, loading] = case.inputs[step];
            for (drive, parts) in drives.iter_mut().zip([1, 3]) {
                let length = case.step / f64::from(parts);
                for part in 0..parts {
                    let time = f64::from(part) * length;
                    drive
                        .set("sliding_velocity", velocity + acceleration * time)
                        .slope("sliding_velocity", acceleration);
                    drive.set("normal_load", load + loading * time).slope("normal_load", loading);
                    drive.0.step(length).unwrap_or_else(|error| panic!("{text}, step {step}: {error}"));
                }
            }
        }
        let ambient = drives[0].get("ambient_temperature");
        for (name, zero) in [("contact_temperature", ambient), ("wear_depth", 0.0), ("friction_force", 0.0)] {
            let [one, other] = drives.each_mut().map(|drive| drive.get(name) - zero);
            // Both runs have the tolerance of 1e-3, of the scale of the run.
            let scale = one.abs().max(if name == "friction_force" { case.inputs[STEPS - 1][1].abs() } else { 0.0 });
            assert!((one - other).abs() <= 5e-3 * scale + 1e-15, "{text}: {name} {one:e} {other:e}");
        }
    });
}

#[test]
fn a_replay_has_the_same_bits() {
    let of = real_outputs();
    on_cases(8, |case, _, text| {
        let mut drive = case.drive();
        let mut random = Random(case.inputs.len() as u64 + text.len() as u64);
        let mut saved = Snapshot::default();
        let mut step = 0;
        while step < STEPS {
            drive.0.snapshot(&mut saved);
            let ahead = (1 + (5.0 * random.next()) as usize).min(STEPS - step);
            let run = |drive: &mut Drive| {
                for k in step..step + ahead {
                    case.set(drive, k);
                    drive.0.step(case.step).unwrap_or_else(|error| panic!("{text}, step {k}: {error}"));
                }
                values(drive, &of)
            };
            let first = run(&mut drive);
            // What is played back may be another history in between, and another instance.
            drive.set("sliding_velocity", 0.3).set("normal_load", 1.0);
            let _ = drive.0.step(0.7 * case.step);
            drive.0.restore(&saved).unwrap();
            let again = run(&mut drive);
            assert_eq!(first_difference(&of, &first, &again), None, "{text}, step {step}");
            let mut bytes = Vec::new();
            saved.encode(&mut bytes);
            let mut other = case.drive();
            other.0.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
            let elsewhere = run(&mut other);
            assert_eq!(first_difference(&of, &first, &elsewhere), None, "{text}, step {step}, another instance");
            step += ahead;
        }
    });
}

#[test]
fn instances_do_not_influence_each_other() {
    let of = real_outputs();
    for level in LEVELS {
        let cases = [1, 2, 3, 4].map(|number| Case::new(number, level));
        let alone = cases.each_ref().map(|case| {
            let mut drive = case.drive();
            (0..STEPS).for_each(|step| {
                case.set(&mut drive, step);
                drive.0.step(case.step).unwrap();
            });
            values(&mut drive, &of)
        });
        let mut drives = cases.each_ref().map(Case::drive);
        for step in 0..STEPS {
            for (drive, case) in drives.iter_mut().zip(&cases) {
                case.set(drive, step);
                drive.0.step(case.step).unwrap();
            }
        }
        for ((drive, alone), case) in drives.iter_mut().zip(&alone).zip(&cases) {
            assert_eq!(first_difference(&of, alone, &values(drive, &of)), None, "{level:?} {}", case.name);
        }
    }
}

#[test]
fn friction_heat_of_an_isolated_pair_stays_in_it() {
    for level in LEVELS {
        for number in 1..=4 {
            let case = Case::new(number, level);
            let isolated: &[(&str, f64)] = &[
                ("*.convection", 0.0),
                ("*.convection_forced", 0.0),
                ("*.emissivity", 0.0),
                ("punch.top_thermal", INSULATED),
                ("strip.base_thermal", INSULATED),
            ];
            let mut drive = case.attempt(isolated).unwrap_or_else(|error| panic!("{level:?} {number}: {error}"));
            for step in 0..STEPS {
                case.set(&mut drive, step);
                drive.0.step(case.step).unwrap_or_else(|error| panic!("{level:?} {number}: {error}"));
            }
            let [made, stored] = ["dissipated_energy", "stored_heat"].map(|name| drive.get(name));
            assert!((made / stored - 1.0).abs() < 1e-9, "{level:?} {number} ({}): {made:e} {stored:e}", case.name);
        }
    }
}

#[test]
fn a_damaged_number_of_a_state_is_refused_or_does_no_harm() {
    let of = real_outputs();
    for level in LEVELS {
        let case = Case::new(4, level);
        let mut drive = case.drive();
        for step in 0..5 {
            case.set(&mut drive, step);
            drive.0.step(case.step).unwrap();
        }
        let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
        drive.0.snapshot(&mut saved);
        saved.encode(&mut bytes);
        let mut refused = 0;
        // Numbers of the state stand behind those of the component.
        let count = bytes.len() / 8;
        for at in (60..count).step_by(if level == Level::Lumped { 1 } else { 37 }) {
            for damage in [f64::NAN, f64::NEG_INFINITY, 1e300] {
                let mut damaged = bytes.clone();
                damaged[8 * at..8 * at + 8].copy_from_slice(&damage.to_le_bytes());
                let mut other = case.drive();
                let taken = Snapshot::decode(&damaged).and_then(|snapshot| other.0.restore(&snapshot));
                if taken.is_err() {
                    refused += 1;
                    continue;
                }
                for (&reference, value) in of.iter().zip(values(&mut other, &of)) {
                    assert!(value.is_finite(), "{level:?}, number {at} = {damage}: {} = {value}", name(reference));
                }
            }
        }
        assert!(refused > count / 20, "{level:?}: {refused} refused");
    }
}

/// Lengths as differences of times far from 0, beside equal ones: the same bits while nothing is made up for, and the whole time.
#[test]
fn lengths_that_differ_by_rounding_are_one_length() {
    for level in [2.0, 3.0] {
        let (start, length) = (1e4, 0.1);
        let drive = |uneven: bool, steps: u32| {
            let mut drive = Drive::stock(&[("solver.fidelity", level), ("solver.cells", 5.0)]);
            for k in 0..steps {
                drive.set("sliding_velocity", 0.3).set("normal_load", 500.0);
                let at = |k: u32| start + length * f64::from(k);
                let step = if uneven && k > 0 { at(k + 1) - at(k) } else { length };
                drive.0.step(step).unwrap();
            }
            drive
        };
        let [mut one, mut other] = [false, true].map(|uneven| drive(uneven, 30));
        let of = real_outputs();
        assert_eq!(first_difference(&of, &values(&mut one, &of), &values(&mut other, &of)), None, "{level}");
        let mut long = drive(true, 3000);
        let distance = long.get("sliding_distance");
        assert!((distance / (0.3 * 300.0) - 1.0).abs() < 1e-11, "{level}: {distance}");
    }
}
