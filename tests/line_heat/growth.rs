//! Thermoelastic instability in full periodic contact: one conducting half-plane on a rigid insulator.
//!
//! A pressure wave of the number m grows at the rate b with `z (1 + z) = 2 R`, `z^2 = 1 + b/(kd m^2)`, R the speed over
//! `2 K m (1 - nu)/(mu E alpha)`.

use crate::drive::Drive;
use std::f64::consts::PI;

const STATIONS: usize = 33;
const FRICTION: f64 = 0.3;
const WAVELENGTH: f64 = 0.01;
const CONDUCTIVITY: f64 = 45.0;
const CAPACITY: f64 = 7800.0 * 460.0;
const YOUNGS_MODULUS: f64 = 2e11;
const EXPANSION: f64 = 1.1e-5;

/// Growth rate in 1/s at R times the critical speed.
fn computed(ratio: f64, step: f64, samples: [u32; 3]) -> f64 {
    let wave = 2.0 * PI / WAVELENGTH;
    let critical = 2.0 * CONDUCTIVITY * wave * 0.7 / (FRICTION * YOUNGS_MODULUS * EXPANSION);
    let mut changes = vec![
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
        ("punch.wear_coefficient", 0.0),
        ("strip.body", 1.0),
        ("strip.conductivity", 0.0),
        ("strip.wear_coefficient", 0.0),
        ("nominal.velocity", ratio * critical),
        ("nominal.load", 1e4),
        ("nominal.duration", 1.0),
        ("solver.tolerance", 1e-5),
    ];
    let names: Vec<String> = (1..=STATIONS).map(|station| format!("contact.initial_gap[{station}]")).collect();
    for (station, name) in names.iter().enumerate() {
        let x = station as f64 / (STATIONS - 1) as f64;
        changes.push((name.as_str(), 1e-12 * (1.0 + (2.0 * PI * x).cos())));
    }
    let mut drive = Drive::stock(&changes);
    drive.set("normal_load", 1e4).set("sliding_velocity", ratio * critical);
    let mut amplitudes = Vec::new();
    for number in 1..=samples[2] {
        drive.step(step);
        if samples.contains(&number) {
            let amplitude: f64 = (1..STATIONS)
                .map(|station| {
                    let x = (station - 1) as f64 / (STATIONS - 1) as f64;
                    let mean = 0.5 * (drive.get("profile.pressure[1]") + drive.get("profile.pressure[33]"));
                    let pressure = if station == 1 { mean } else { drive.get(&format!("profile.pressure[{station}]")) };
                    pressure * (2.0 * PI * x).cos()
                })
                .sum();
            amplitudes.push(amplitude);
        }
    }
    // The gap stays, so the wave grows on top of a constant.
    let duration = f64::from(samples[2] - samples[1]) * step;
    ((amplitudes[2] - amplitudes[1]) / (amplitudes[1] - amplitudes[0])).ln() / duration
}

#[test]
fn the_longest_wave_grows_at_the_rate_of_theory() {
    let wave = 2.0 * PI / WAVELENGTH;
    let unit = CONDUCTIVITY / CAPACITY * wave * wave;
    for (ratio, step, samples) in [
        (0.5, 5e-3, [100, 140, 180]),
        (1.0, 5e-3, [100, 140, 180]),
        (2.0, 5e-3, [60, 100, 140]),
        (5.0, 1e-3, [60, 110, 160]),
    ] {
        let z = 0.5 * ((1.0_f64 + 8.0 * ratio).sqrt() - 1.0);
        let exact = unit * (z * z - 1.0);
        let rate = computed(ratio, step, samples);
        println!("R = {ratio}: {rate} against {exact} 1/s");
        assert!(
            (rate - exact).abs() < 1e-2 * unit * (1.0 + (z * z - 1.0).abs()),
            "R = {ratio}: {rate} against {exact} 1/s"
        );
    }
}
