//! Time steps: subdivision of a communication step, convergence with input derivatives, events inside a step.

use test_support::{Drive, LINE, LUMPED, scene, scenes};

/// Temperatures relative to the peak rise, the rest to their own size.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    wear: f64,
    temperature: f64,
    force: f64,
    heat: f64,
    received: f64,
}

impl Outcome {
    fn of(drive: &mut Drive) -> Outcome {
        Outcome {
            wear: drive.get("wear_volume_punch") + drive.get("wear_volume_strip"),
            temperature: drive.get("contact_temperature"),
            force: drive.get("friction_force"),
            heat: drive.get("dissipated_energy"),
            received: drive.get("heat_received_punch"),
        }
    }

    /// Largest difference from `other`, with `rise` the peak temperature rise and `force` the peak force.
    fn difference(&self, other: &Outcome, rise: f64, force: f64) -> f64 {
        let relative = |a: f64, b: f64, scale: f64| if scale == 0.0 { 0.0 } else { (a - b).abs() / scale };
        [
            relative(self.wear, other.wear, other.wear),
            relative(self.temperature, other.temperature, rise),
            relative(self.force, other.force, force),
            relative(self.heat, other.heat, other.heat),
            relative(self.received, other.received, other.heat),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }
}

/// Changes that switch on every nonlinearity of a step.
const HARD: &[(&str, f64)] = &[
    ("contact.friction_fade.factor[1]", 1.0),
    ("contact.friction_fade.factor[2]", 0.9),
    ("contact.friction_fade.factor[3]", 0.7),
    ("contact.friction_fade.factor[4]", 0.6),
    ("contact.friction_fade.factor[5]", 0.5),
    ("contact.friction_fade.factor[6]", 0.45),
    ("contact.friction_fade.factor[7]", 0.4),
    ("contact.friction_fade.factor[8]", 0.35),
    ("punch.wear_fade.factor[3]", 2.0),
    ("punch.wear_fade.factor[4]", 4.0),
    ("punch.emissivity", 0.9),
    ("strip.emissivity", 0.55),
    ("punch.convection_forced", 20.0),
    ("strip.convection_forced", 40.0),
    ("punch.wear_pressure_exponent", 0.5),
    ("punch.wear_velocity_exponent", 0.3),
];

const PLAIN: &[(&str, f64)] = &[];

/// Five communication steps with a jump of the inputs at each, each cut into `parts`; with `ramped` inputs
/// that change inside the step too. Outcomes after every step.
fn run(name: &str, changes: &[(&str, f64)], tolerance: f64, parts: u32, ramped: bool) -> Vec<Outcome> {
    let (_, load, velocity) = *scenes().iter().find(|entry| entry.0 == name).unwrap();
    let changes = [changes, &[("solver.tolerance", tolerance), ("contact.stick_stiffness", 0.0)]].concat();
    let mut drive = Drive::from_starts(&scene(name), &changes);
    let step = 1.0;
    [(1.0, 1.0), (2.0, 0.7), (0.3, 2.0), (-1.0, 1.5), (1.5, 0.0)]
        .into_iter()
        .map(|(speed, force)| {
            let (v, f) = (speed * velocity, force * load);
            for part in 0..parts {
                let time = f64::from(part) / f64::from(parts);
                if ramped {
                    // Away from v = 0: the events have tests of their own.
                    drive.set("sliding_velocity", v * (1.0 + 0.6 * time)).slope("sliding_velocity", 0.6 * v / step);
                    drive.set("normal_load", f * (1.0 - 0.5 * time)).slope("normal_load", -0.5 * f / step);
                } else {
                    drive.set("sliding_velocity", v).set("normal_load", f);
                }
                drive.step(step / f64::from(parts));
            }
            Outcome::of(&mut drive)
        })
        .collect()
}

fn cutting(changes: &[(&str, f64)], ramped: bool, tolerances: &[f64]) {
    let mut failed = Vec::new();
    for (name, ..) in scenes() {
        for &tolerance in tolerances {
            let fine = run(name, changes, tolerance, 100, ramped);
            let ambient = fine.last().unwrap().temperature.min(fine[0].temperature);
            let start = {
                let mut drive = Drive::from_starts(&scene(name), changes);
                drive.get("contact_temperature").min(ambient)
            };
            let rise = fine.iter().map(|outcome| outcome.temperature - start).fold(0.0, f64::max);
            let force = fine.iter().map(|outcome| outcome.force.abs()).fold(0.0, f64::max);
            for parts in [1, 2, 7] {
                let coarse = run(name, changes, tolerance, parts, ramped);
                let worst = coarse.iter().zip(&fine).map(|(a, b)| a.difference(b, rise, force)).fold(0.0, f64::max);
                if worst > tolerance {
                    failed.push(format!(
                        "{name} ramped {ramped} {tolerance:e} {parts} parts: {worst:.2e}\n {coarse:?}\n {fine:?}"
                    ));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// With plain laws, and with fade, radiation, forced convection and exponents.
#[test]
fn cutting_a_step_changes_at_most_the_tolerance() {
    for changes in [PLAIN, HARD] {
        for ramped in [false, true] {
            cutting(changes, ramped, &[1e-2, 1e-3, 1e-4]);
        }
    }
}

/// A smooth history with input derivatives taken from it, over 8 s.
fn smooth(steps: u32, derivatives: bool) -> [f64; 4] {
    let changes = [HARD, &[("solver.tolerance", 1e-6)]].concat();
    let mut drive = Drive::stock(&changes);
    let step = 8.0 / f64::from(steps);
    for index in 0..steps {
        let t = f64::from(index) * step;
        drive.set("sliding_velocity", 8.0 + 3.0 * (0.9 * t).sin()).set("normal_load", 5e3 + 2e3 * (1.3 * t).cos());
        if derivatives {
            drive.slope("sliding_velocity", 2.7 * (0.9 * t).cos()).slope("normal_load", -2.6e3 * (1.3 * t).sin());
        }
        drive.step(step);
    }
    drive.set("sliding_velocity", 8.0 + 3.0 * 7.2_f64.sin()).set("normal_load", 5e3 + 2e3 * 10.4_f64.cos());
    ["wear_volume_punch", "contact_temperature", "dissipated_energy", "heat_received_strip"].map(|name| drive.get(name))
}

#[test]
fn input_derivatives_give_second_order() {
    let exact = smooth(8192, true);
    let error = |steps, derivatives| {
        let outcome = smooth(steps, derivatives);
        [0, 1, 2, 3].map(|index| {
            let scale = if index == 1 { exact[1] - 293.15 } else { exact[index] };
            ((outcome[index] - exact[index]) / scale).abs()
        })
    };
    let (coarse, fine) = (error(32, true), error(128, true));
    let (held_coarse, held_fine) = (error(32, false), error(128, false));
    for index in 0..4 {
        // A step four times shorter: a factor of 16 at second order, less a margin for the floor set by the tolerance.
        let order = (coarse[index] / fine[index].max(1e-12)).log2() / 2.0;
        assert!(order > 1.8 || coarse[index] < 2e-6, "order {order}: {coarse:?} {fine:?}");
        assert!(fine[index] < 0.2 * held_fine[index], "{index}: {fine:?} {held_fine:?}");
    }
    // Held inputs converge too, at first order at least.
    assert!((0..4).all(|index| held_fine[index] < 0.5 * held_coarse[index]), "{held_coarse:?} {held_fine:?}");
}

/// One ramp of the inputs over 4 s, in `steps` equal communication steps.
fn ramp(changes: &[(&str, f64)], v: [f64; 2], f: [f64; 2], steps: u32) -> [f64; 6] {
    let mut drive = Drive::stock(changes);
    drive.set("sliding_velocity", 6.0).set("normal_load", 5e3).step(5.0);
    for index in 0..steps {
        let part = f64::from(index) / f64::from(steps);
        drive.set("sliding_velocity", v[0] + (v[1] - v[0]) * part).slope("sliding_velocity", (v[1] - v[0]) / 4.0);
        drive.set("normal_load", f[0] + (f[1] - f[0]) * part).slope("normal_load", (f[1] - f[0]) / 4.0);
        drive.step(4.0 / f64::from(steps));
    }
    [
        "wear_volume_punch",
        "contact_temperature",
        "friction_force",
        "dissipated_energy",
        "sliding_distance",
        "heat_lost_ambient",
    ]
    .map(|name| drive.get(name))
}

#[test]
fn reversals_and_lift_off_inside_a_step_are_located() {
    let tolerance = 1e-4;
    for (what, changes) in [("plain", PLAIN), ("hard", HARD)] {
        let changes = [changes, &[("solver.tolerance", tolerance)]].concat();
        for (event, v, f) in [
            ("reversal", [5.0, -3.0], [5e3, 4e3]),
            ("lift-off", [5.0, 4.0], [5e3, -2e3]),
            ("touch-down", [5.0, 4.0], [-2e3, 5e3]),
            ("both", [5.0, -3.0], [6e3, -1e3]),
            ("both, the other order", [3.0, -5.0], [-1e3, 6e3]),
        ] {
            let (once, fine) = (ramp(&changes, v, f, 1), ramp(&changes, v, f, 1000));
            let rise = 100.0;
            for (index, (a, b)) in once.iter().zip(&fine).enumerate() {
                // Temperature against the rise, heat lost against the friction heat.
                let scale = match index {
                    1 => rise,
                    5 => fine[3],
                    _ => b.abs().max(1e-12),
                };
                let error = (a - b).abs() / scale;
                assert!(error <= tolerance, "{what} {event}: {index}: {once:?} {fine:?}");
            }
            // The distance is the integral of |v|, exactly.
            let distance =
                if v[1] < 0.0 { 2.0 * (v[0] * v[0] + v[1] * v[1]) / (v[0] - v[1]) } else { 2.0 * (v[0] + v[1]) };
            assert!((once[4] - 30.0 - distance).abs() < 1e-9, "{event}: {} {distance}", once[4]);
        }
    }
}

#[test]
fn an_open_contact_neither_rubs_nor_wears_and_says_so_once() {
    for level in [LUMPED, LINE] {
        let mut drive = Drive::stock(&[("solver.fidelity", level), ("solver.cells", 9.0)]);
        drive.set("sliding_velocity", 10.0).set("normal_load", 0.0).step(1.0);
        drive.set("normal_load", -100.0).steps(5, 1.0);
        for name in
            ["wear_depth", "dissipated_energy", "friction_force", "pressure_max", "contact_fraction", "limit_reached"]
        {
            assert_eq!(drive.get(name), 0.0, "level {level}: {name}");
        }
        assert_eq!(drive.get("sliding_distance"), 60.0, "level {level}");
        let warnings = drive.0.messages().filter(|message| message.text.contains("normal_load")).count();
        assert_eq!(warnings, 1, "level {level}");
    }
}

/// A brake in the city cycle for `seconds` s, each step of 0.1 s divided into `parts`: temperatures after every step, and
/// accepted and rejected internal steps.
fn city(name: &str, tolerance: f64, seconds: usize, parts: u32) -> (Vec<f64>, (u64, u64)) {
    let text = std::fs::read_to_string(test_support::examples().join("data/udds.csv")).unwrap();
    let speeds: Vec<f64> = text.lines().skip(1).map(|line| line.split_once(',').unwrap().1.parse().unwrap()).collect();
    let mut drive = Drive::from_starts(&scene(name), &[("solver.tolerance", tolerance)]);
    let mut temperatures = Vec::new();
    for pair in speeds.windows(2).take(seconds) {
        let acceleration = pair[1] - pair[0];
        for tenth in 0..10 {
            let speed = pair[0] + 0.1 * f64::from(tenth) * acceleration;
            drive.set("sliding_velocity", 0.379 * speed).set("normal_load", 2000.0 * (-acceleration).max(0.0));
            drive.steps(parts, 0.1 / f64::from(parts));
            temperatures.push(drive.get("contact_temperature"));
        }
    }
    (temperatures, drive.0.work())
}

#[test]
fn inputs_that_jump_at_every_step_cost_little_more_than_held_ones() {
    for (tolerance, most) in [(1e-3, 1.25), (1e-4, 2.2)] {
        let (seconds, exchanges) = (340, 3400.0);
        let (coarse, (accepted, rejected)) = city("disc_brake", tolerance, seconds, 1);
        let (fine, _) = city("disc_brake", tolerance, seconds, 32);
        let rise = fine.iter().fold(0.0, |highest: f64, value| highest.max(*value)) - fine[0];
        let worst = coarse.iter().zip(&fine).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        let attempts = (accepted + rejected) as f64 / exchanges;
        assert!(worst <= 0.3 * tolerance * rise, "{tolerance:e}: {worst} K of {rise} K");
        assert!(attempts <= most, "{tolerance:e}: {attempts}");
    }
}
