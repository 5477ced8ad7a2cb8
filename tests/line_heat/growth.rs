//! Thermoelastic instability in full periodic contact: one conducting half-plane on a rigid insulator.
//!
//! A pressure wave of the number m grows at the rate b with `z (1 + z) = 2 R`, `z^2 = 1 + b/(kd m^2)`, R the speed over
//! `2 K m (1 - nu)/(mu E alpha)`.

use std::f64::consts::PI;
use test_support::{Drive, initial_gap, reference};

const FRICTION: f64 = 0.3;
const WAVELENGTH: f64 = 0.01;
const CONDUCTIVITY: f64 = 45.0;
const CAPACITY: f64 = 7800.0 * 460.0;
const YOUNGS_MODULUS: f64 = 2e11;
const EXPANSION: f64 = 1.1e-5;

/// Full contact of a conducting half-plane with a rigid insulator, at R times the critical speed, with a gap of one wave of
/// the amplitude `gap` (m).
fn ring_changes(ratio: f64, gap: f64) -> Vec<(&'static str, f64)> {
    let wave = 2.0 * PI / WAVELENGTH;
    let critical = 2.0 * CONDUCTIVITY * wave * 0.7 / (FRICTION * YOUNGS_MODULUS * EXPANSION);
    let fixed = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 32.0),
        ("contact.geometry", 3.0),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_coefficient", FRICTION),
        ("contact.initial_shape", 4.0),
        ("strip.path", 2.0),
        ("strip.length", WAVELENGTH),
        ("punch.width", WAVELENGTH),
        ("punch.height", 0.1),
        ("punch.body", 3.0),
        ("punch.youngs_modulus", YOUNGS_MODULUS),
        ("punch.poissons_ratio", 0.3),
        ("punch.density", 7800.0),
        ("punch.specific_heat", 460.0),
        ("punch.conductivity", CONDUCTIVITY),
        ("punch.thermal_expansion", EXPANSION),
        ("punch.convection", 0.0),
        ("*.wear_coefficient", 0.0),
        ("strip.body", 1.0),
        ("strip.conductivity", 0.0),
        ("nominal.velocity", ratio * critical),
        ("nominal.load", 1e4),
        ("nominal.duration", 1.0),
        ("solver.tolerance", 1e-5),
    ];
    fixed.into_iter().chain(initial_gap(|x| gap * (1.0 - (2.0 * PI * x).cos()))).collect()
}

/// That contact, loaded and sliding.
fn ring(ratio: f64, changes: &[(&str, f64)], gap: f64) -> Drive {
    let mut drive = Drive::stock(&[&ring_changes(ratio, gap)[..], changes].concat());
    let speed = drive.get("nominal.velocity");
    drive.set("normal_load", 1e4).set("sliding_velocity", speed);
    drive
}

/// Beyond the critical speed a small disturbance grows until the surfaces separate, and the run continues with patches that
/// carry the load.
#[test]
fn above_the_critical_speed_the_contact_parts_into_patches() {
    let mut drive = ring(2.0, &[("solver.tolerance", 1e-3), ("nominal.duration", 2.0)], 1e-9);
    let critical = drive.get("critical_speed");
    let speed = drive.get("nominal.velocity");
    assert!((speed / critical - 2.0).abs() < 1e-12);
    let area = drive.area();
    let mut parted = None;
    for number in 0..150 {
        drive.step(0.02);
        let load = drive.get("pressure_mean") * area;
        assert!((load / 1e4 - 1.0).abs() < 1e-12, "{load}");
        let values = ["pressure_max", "contact_temperature_max", "contact_fraction"].map(|name| drive.get(name));
        assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
        if values[2] < 1.0 {
            parted.get_or_insert(number);
        }
    }
    let (imbalance, fraction) = (drive.imbalance(), drive.get("contact_fraction"));
    assert!(parted.is_some_and(|number| number < 120) && fraction > 0.0 && fraction < 1.0);
    assert!(imbalance < 1e-9, "{imbalance:e}");
    assert!(drive.get("pressure_max") > 2.0 * drive.get("pressure_mean"));
}

/// The message comes once, when a perturbation of the size of the tolerance has grown to the pressure itself: after ln(1/tolerance)
/// growth times of the wave that grows at the exact rate, at both levels, and not in a run that is shorter, slower or unloaded.
#[test]
fn growth_is_said_once_when_it_matters() {
    let wave = 2.0 * PI / WAVELENGTH;
    let z = 0.5 * (17.0_f64.sqrt() - 1.0);
    let rate = CONDUCTIVITY / CAPACITY * wave * wave * (z * z - 1.0);
    let said = |drive: &mut Drive| {
        let texts = drive.0.messages().filter(|message| message.text.starts_with("thermoelastically unstable: "));
        texts.map(|message| message.text.clone()).collect::<Vec<_>>()
    };
    for (level, tolerance) in [(2.0, 1e-2), (2.0, 1e-5), (3.0, 1e-3)] {
        let changes = [("solver.fidelity", level), ("solver.tolerance", tolerance), ("solver.cells", 16.0)];
        let needed = -f64::ln(tolerance) / rate;
        for steps in [1, 20] {
            let mut drive = ring(2.0, &changes, 1e-12);
            assert_eq!(said(&mut drive), [""; 0]);
            drive.steps(steps, 0.97 * needed / f64::from(steps));
            assert_eq!(said(&mut drive), [""; 0], "{level} {tolerance}");
            drive.step(0.06 * needed);
            let texts = said(&mut drive);
            assert!(
                texts.len() == 1 && texts[0].contains(&format!("by exp({:.1})", 1.03 * -f64::ln(tolerance))),
                "{texts:?}"
            );
            assert_eq!(texts[0].contains("this level has one temperature"), level == 2.0);
            drive.step(needed);
            assert_eq!(said(&mut drive), [""; 0]);
        }
    }
    for (speed, load) in [(0.95, 1e4), (2.0, 0.0)] {
        let mut drive = ring(1.0, &[("solver.fidelity", 2.0), ("solver.tolerance", 1e-2)], 1e-12);
        let critical = drive.get("critical_speed");
        drive.set("sliding_velocity", -speed * critical).set("normal_load", load).step(10.0);
        assert_eq!(said(&mut drive), [""; 0], "{speed} {load}");
    }
    // Speed rising linearly to twice the critical one and back: the integral of the exact rate of the longest wave.
    let mut drive = ring(2.0, &[("solver.fidelity", 2.0), ("solver.tolerance", 1e-2)], 1e-12);
    let speed = drive.get("sliding_velocity");
    let exponent_of = |duration: f64| {
        let at = |part: f64| {
            let z = 0.5 * ((1.0_f64 + 8.0 * 2.0 * part).sqrt() - 1.0);
            CONDUCTIVITY / CAPACITY * wave * wave * (z * z - 1.0).max(0.0)
        };
        duration * (0..1000).map(|k| at((f64::from(k) + 0.5) / 1000.0)).sum::<f64>() / 1000.0
    };
    let duration = 0.45 * -f64::ln(1e-2) / exponent_of(1.0);
    drive.set("sliding_velocity", 0.0).slope("sliding_velocity", speed / duration).step(duration);
    drive.slope("sliding_velocity", -speed / duration).step(duration);
    assert_eq!(said(&mut drive), [""; 0]);
    drive.set("sliding_velocity", 0.0).slope("sliding_velocity", speed / duration).step(duration);
    assert_eq!(said(&mut drive).len(), 1);
}

/// Wear stabilises growth by w = k K/(mu alpha (1 + nu) kd): accelerated wear gives a warning above 0.05 and is refused above
/// 0.5.
#[test]
fn accelerated_wear_that_hides_growth_is_warned_of_and_refused() {
    let wear = 1e-14;
    let w = wear * CAPACITY / (FRICTION * EXPANSION * 1.3);
    let start = |acceleration: f64| {
        let changes = [("punch.wear_coefficient", wear), ("wear_acceleration", acceleration)];
        Drive::attempt(&scene::variables::STARTS, &[&ring_changes(0.5, 1e-12)[..], &changes].concat())
    };
    let warned = |drive: &mut Drive| {
        drive.set("normal_load", 1e4).set("sliding_velocity", 0.01).step(1e-3);
        drive.0.messages().filter(|message| message.text.starts_with("wear_acceleration = ")).count()
    };
    for (share, warnings) in [(0.99 * 0.05, 0), (1.01 * 0.05, 1), (0.99 * 0.5, 1)] {
        assert_eq!(warned(&mut start(share / w).unwrap()), warnings, "w = {share}");
    }
    let message = start(1.01 * 0.5 / w).err().unwrap();
    for part in ["wear_acceleration = ", "kd) = 0.505", "the limit is 0.5"] {
        assert!(message.contains(part), "{message}");
    }
    // The parameter is tunable: the next step refuses it, and runs again once it is lowered.
    let mut drive = start(1.0).unwrap();
    assert_eq!(warned(&mut drive), 0);
    drive.0.set_parameter(reference("wear_acceleration"), 1.01 * 0.5 / w);
    let message = drive.0.step(1e-3).unwrap_err();
    assert!(message.contains("the limit is 0.5"), "{message}");
    drive.0.set_parameter(reference("wear_acceleration"), 0.99 * 0.5 / w);
    assert_eq!(warned(&mut drive), 1);
    // Wear of the same rate without acceleration is physical and allowed.
    let own = [("punch.wear_coefficient", wear / w)];
    let natural = Drive::attempt(&scene::variables::STARTS, &[&ring_changes(0.5, 1e-12)[..], &own].concat());
    assert_eq!(warned(&mut natural.unwrap()), 0);
}
