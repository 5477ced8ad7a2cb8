//! One communication step, ten and a hundred give the same within the tolerance.

use super::{LEVELS, temperatures};
use scene::variables::reference;
use test_support::{CONVECTING, Drive, INSULATED, LUMPED, Random, named, scene};

/// Shipped scenes.
pub const SCENES: [&str; 15] = [
    "disc_brake",
    "pin_on_disk",
    "reciprocating_punch",
    "clutch",
    "hot_spots",
    "published/disc_critical_speed",
    "published/hot_bands",
    "published/uniform_wear",
    "published/clutch_engagement",
    "published/hot_spot_growth",
    "published/sliding_punch",
    "published/single_stop",
    "published/flat_punch_wear",
    "published/flash_temperature",
    "published/ball_wear",
];

/// Body without compliance.
const RIGID: f64 = 1.0;

/// Tolerance of all cases.
pub const TOLERANCE: f64 = 1e-3;

/// A shipped scene with random cooling and temperatures.
#[derive(Debug)]
pub struct Case {
    pub name: &'static str,
    pub load: f64,
    velocity: f64,
    changes: Vec<(&'static str, f64)>,
    /// Temperatures of the surroundings, K.
    pub around: [f64; 3],
}

impl Case {
    pub fn new(name: &'static str, random: &mut Random) -> Case {
        let starts = scene(name);
        let value = |name: &str| starts[reference(name) as usize];
        let closed = value("strip.path") == 2.0;
        let mut around = [0; 3].map(|_| random.between(260.0, 400.0));
        let mut changes = vec![
            ("ambient_temperature", around[0]),
            ("punch.initial_at_ambient", 0.0),
            ("punch.initial_temperature", random.between(260.0, 900.0)),
            ("strip.initial_at_ambient", 0.0),
            ("strip.initial_temperature", random.between(260.0, 900.0)),
            ("solver.tolerance", TOLERANCE),
        ];
        for (body, face) in [("punch", "punch.top_thermal"), ("strip", "strip.base_thermal")] {
            let own = |name: &str, value: f64| named(format!("{body}.{name}"), value);
            changes.push((face, if random.next() < 0.5 { INSULATED } else { CONVECTING }));
            for (name, most) in [("convection", 60.0), ("emissivity", 1.0), ("convection_forced", 60.0)] {
                changes.push(own(name, if random.next() < 0.3 { 0.0 } else { random.between(0.0, most) }));
            }
            let conductance = if random.next() < 0.5 { 0.0 } else { 10f64.powf(random.between(-2.0, 5.0)) };
            if value(&format!("{body}.conductivity")) > 0.0 && (closed || body == "punch") {
                changes.push(own("external_conductance", conductance));
            }
        }
        if !changes.iter().any(|(name, value)| name.ends_with("external_conductance") && *value > 0.0) {
            around = [around[0]; 3];
        }
        let [load, velocity] = ["nominal.load", "nominal.velocity"].map(value);
        changes.extend([("punch.external_temperature", around[1]), ("strip.external_temperature", around[2])]);
        Case { name, load, velocity, changes, around }
    }

    /// The component at rest without load; `None` where two rigid bodies have no contact line.
    pub fn drive(&self, level: &[(&'static str, f64)]) -> Option<Drive> {
        let starts = scene(self.name);
        let rigid = |name: &str| starts[reference(name) as usize] == RIGID;
        let lumped = level.contains(&("solver.fidelity", LUMPED));
        let is_one = lumped || !(rigid("punch.body") && rigid("strip.body"));
        is_one.then(|| Drive::from_starts(&starts, &[&self.changes[..], level].concat()))
    }
}

/// Inputs over a run: values at its ends.
type Ramps = [(&'static str, [f64; 2]); 5];

/// Runs the ramps in so many communication steps.
fn run(drive: &mut Drive, ramps: &Ramps, duration: f64, steps: usize) -> Result<(), String> {
    for k in 0..steps {
        for (name, [from, to]) in ramps {
            drive.set(name, from + (to - from) * k as f64 / steps as f64).slope(name, (to - from) / duration);
        }
        drive.0.step(duration / steps as f64)?;
    }
    Ok(())
}

/// Whether the contact is closed in a run: then both bodies start at one temperature on the line, where heat localises the contact.
fn touches(number: u64) -> bool {
    matches!(number % 4, 0 | 3)
}

#[test]
fn one_communication_step_ten_and_a_hundred_give_the_same() {
    for (level, changes) in LEVELS {
        let (turns, most) = if level == "line" { (2, 4.0 * TOLERANCE) } else { (16, 1.5 * TOLERANCE) };
        for number in 0..turns * SCENES.len() as u64 {
            let mut random = Random(7 + number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let mut case = Case::new(SCENES[number as usize % SCENES.len()], &mut random);
            if level == "line" && touches(number) {
                case.changes.extend([("*.initial_temperature", 500.0)]);
            }
            let (load, velocity) = (0.2 * case.load, 0.2 * case.velocity);
            let duration = 10f64.powf(random.between(0.0, 3.3));
            // Heating, cooling at rest and in motion, opening.
            let (loads, velocities) = match number % 4 {
                0 => ([load, load], [velocity, velocity]),
                1 => ([0.0, 0.0], [0.0, 0.0]),
                2 => ([0.0, 0.0], [velocity, 0.0]),
                // So slowly that friction heat does not localise the contact, which no tolerance of the heat resolves.
                _ => ([load, 0.0], [0.05 * velocity, 0.02 * velocity]),
            };
            let duration = if touches(number) { 0.02 * duration } else { duration };
            let mut air = || [random.between(0.0, 30.0), random.between(0.0, 30.0)];
            let ramps = [
                ("normal_load", loads),
                ("sliding_velocity", velocities),
                ("cooling_velocity", air()),
                ("ambient_temperature_offset", air()),
                ("punch.external_temperature", air().map(|t| case.around[1] + t)),
            ];
            let mut seen: Vec<[f64; 3]> = Vec::new();
            let mut range: f64 = 1.0;
            for steps in [1, 10, 100] {
                let Some(mut drive) = case.drive(changes) else { continue };
                let start = temperatures(&mut drive);
                run(&mut drive, &ramps, duration, steps)
                    .unwrap_or_else(|error| panic!("{level} {number} {case:?}, {steps} steps: {error}"));
                let end = temperatures(&mut drive);
                range = start
                    .iter()
                    .chain(&end)
                    .chain(&case.around)
                    .fold(range, |most, t| most.max((t - case.around[0]).abs()));
                seen.push(end);
            }
            let Some(finest) = seen.last().copied() else { continue };
            for (cut, end) in seen.iter().enumerate() {
                for (t, fine) in end.iter().zip(&finest) {
                    let apart = (t - fine).abs() / range;
                    assert!(
                        apart < most,
                        "{level} {number} {case:?}, {ramps:?} over {duration} s in 10^{cut} steps: {t} and {fine} K, {apart:e}"
                    );
                }
            }
        }
    }
}

/// A hot pin on a cold disc opens and closes while its load falls: a communication step ends the steps that step control knows, no more.
#[test]
fn the_work_does_not_depend_on_how_a_run_is_cut() {
    let work = |steps: usize| {
        let hot =
            [("punch.initial_at_ambient", 0.0), ("punch.initial_temperature", 730.0), ("solver.tolerance", TOLERANCE)];
        let mut drive = Drive::from_starts(&scene("pin_on_disk"), &[LEVELS[1].1, &hot].concat());
        let (load, velocity) = (0.2 * drive.get("nominal.load"), drive.get("nominal.velocity"));
        let still = ("cooling_velocity", [0.0; 2]);
        let ramps = [
            ("normal_load", [load, 0.0]),
            ("sliding_velocity", [0.01 * velocity, 0.004 * velocity]),
            still,
            still,
            still,
        ];
        run(&mut drive, &ramps, 0.4, steps).unwrap();
        let (accepted, rejected) = drive.0.work();
        (accepted + rejected) as usize
    };
    let works = [1, 10, 100].map(|steps| (steps, work(steps)));
    for (steps, work) in works {
        assert!(work < 2 * works[0].1 + 4 * steps, "{works:?}");
    }
}

/// A ramp of the load to 0 ends beside it by rounding. The contact is open then, also behind a caliper: bodies of different temperatures
/// exchange no heat.
#[test]
fn a_load_of_rounding_leaves_the_contact_open() {
    for (name, stiffness) in SCENES.into_iter().flat_map(|name| [(name, 0.0), (name, 1e8)]) {
        for (level, changes) in LEVELS {
            let run = |rounding: f64| {
                let mut case = Case::new(name, &mut Random(11));
                case.changes.push(("holder.stiffness", stiffness));
                let mut drive = case.drive(changes)?;
                let load = drive.get("nominal.load");
                drive.set("normal_load", load).step(0.1).set("normal_load", rounding * load);
                let opened = (temperatures(&mut drive), drive.get("pressure_max"));
                drive.step(100.0);
                Some([opened, (temperatures(&mut drive), drive.get("pressure_max"))])
            };
            let open = run(0.0);
            for rounding in [1e-16, -1e-16] {
                assert_eq!(run(rounding), open, "{name}, {stiffness} N/m, {level}, {rounding} of the nominal load");
            }
        }
    }
}

/// Under a wind that falls the parts of wind and temperature in the error of a step cancel at one point of it; and a capacity that follows the
/// temperature errs where all fluxes are exact.
#[test]
fn a_hot_strip_cools_the_same_in_one_step_and_in_fifty() {
    for (name, forced, wind) in [("published/sliding_punch", 50.0, [20.0, 0.7]), ("clutch", 0.0, [0.0, 0.0])] {
        for tenths in 0..=35 {
            let duration = 10f64.powf(0.1 * f64::from(tenths));
            let cooled = |steps: usize| {
                let own = [
                    ("solver.fidelity", LUMPED),
                    ("solver.tolerance", TOLERANCE),
                    ("strip.initial_at_ambient", 0.0),
                    ("strip.initial_temperature", 700.0),
                    ("strip.convection", 60.0),
                    ("strip.convection_forced", forced),
                ];
                let mut drive = Drive::from_starts(&scene(name), &own);
                let range = 700.0 - drive.get("ambient_temperature");
                let still = ("normal_load", [0.0; 2]);
                let ramps =
                    [still, still, still, ("cooling_velocity", wind), ("ambient_temperature_offset", [0.0, 10.0])];
                run(&mut drive, &ramps, duration, steps).unwrap();
                temperatures(&mut drive).map(|t| t / range)
            };
            for (one, fine) in cooled(1).into_iter().zip(cooled(50)) {
                let apart = (one - fine).abs();
                assert!(apart < 1.5 * TOLERANCE, "{name}, {duration} s: {apart:e}");
            }
        }
    }
}

/// Hot on cold in perfect contact: the flux begins as the inverse root of time, which no step resolves and time forgets.
#[test]
fn bodies_of_two_temperatures_may_touch_at_any_tolerance() {
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let touching = |steps: u32| {
            let own = [
                ("solver.fidelity", LUMPED),
                ("solver.tolerance", tolerance),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", 900.0),
                ("strip.initial_at_ambient", 0.0),
                ("strip.initial_temperature", 300.0),
            ];
            let mut drive = Drive::from_starts(&scene("published/hot_bands"), &own);
            temperatures(drive.set("normal_load", 1e5).steps(steps, 20.0 / f64::from(steps))).map(|t| t / 600.0)
        };
        for (one, fine) in touching(1).into_iter().zip(touching(100)) {
            let apart = (one - fine).abs();
            assert!(apart < 1.5 * tolerance, "{tolerance}: {apart:e}");
        }
    }
}
