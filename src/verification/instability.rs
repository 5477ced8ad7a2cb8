//! Thermoelastic instability in full periodic contact: a conducting half-plane that slides on a rigid insulator.
//!
//! A pressure wave of the number m grows like exp(b t) with (Dow, Burton 1972; with the shear coupling of the half-plane)
//!
//! ```text
//! z (1 + z) (1 + i e) = 2 R,    b = kd m^2 (z^2 - 1),    e = mu (1 - 2 nu)/(2 (1 - nu))
//! ```
//!
//! R the speed over the critical one without coupling, `2 K m (1 - nu)/(mu E alpha)`. With coupling b is complex: the wave
//! grows while it travels.

use super::driver::Driven;
use super::{Problem, known};
use crate::scene::STATIONS;
use nalgebra::Complex;
use std::f64::consts::PI;

const FRICTION: f64 = 0.3;
const WAVELENGTH: f64 = 0.01;
const CONDUCTIVITY: f64 = 45.0;
const CAPACITY: f64 = 7800.0 * 460.0;
const POISSONS_RATIO: f64 = 0.3;
const YOUNGS_MODULUS: f64 = 2e11;
const EXPANSION: f64 = 1.1e-5;

/// kd m^2, 1/s.
fn unit() -> f64 {
    let wave = 2.0 * PI / WAVELENGTH;
    CONDUCTIVITY / CAPACITY * wave * wave
}

/// b in units of kd m^2.
fn exact(ratio: f64, coupled: bool) -> Complex<f64> {
    let coupling = if coupled { FRICTION * (1.0 - 2.0 * POISSONS_RATIO) / (2.0 * (1.0 - POISSONS_RATIO)) } else { 0.0 };
    let right = Complex::from(2.0 * ratio) / Complex::new(1.0, coupling);
    let z = ((right * 4.0 + 1.0).sqrt() - 1.0) * 0.5;
    z * z - 1.0
}

/// The same from the growth of the first harmonic of the pressure on top of a constant, its sign of travel left out.
fn computed(ratio: f64, coupled: bool, step: f64, samples: [u32; 3]) -> Result<Complex<f64>, String> {
    let wave = 2.0 * PI / WAVELENGTH;
    let critical = 2.0 * CONDUCTIVITY * wave * (1.0 - POISSONS_RATIO) / (FRICTION * YOUNGS_MODULUS * EXPANSION);
    let mut changes = vec![
        ("solver.fidelity", 3.0),
        ("solver.cells", 32.0),
        ("contact.geometry", 3.0),
        ("contact.shear_coupling", f64::from(u8::from(coupled))),
        ("contact.friction_coefficient", FRICTION),
        ("contact.initial_shape", 4.0),
        ("strip.path", 2.0),
        ("strip.length", WAVELENGTH),
        ("punch.width", WAVELENGTH),
        ("punch.height", 0.1),
        ("punch.body", 3.0),
        ("punch.youngs_modulus", YOUNGS_MODULUS),
        ("punch.poissons_ratio", POISSONS_RATIO),
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
        ("nominal.duration", f64::from(samples[2]) * step),
        ("solver.tolerance", 1e-5),
    ];
    // What decays starts higher, to stay above rounding.
    let gap = if ratio < 1.0 { 1e-9 } else { 1e-12 };
    // Stations stand at both ends of the period.
    let phase = |station: usize| 2.0 * PI * (station - 1) as f64 / (STATIONS - 1) as f64;
    let names: Vec<String> = (1..=STATIONS).map(|station| format!("contact.initial_gap[{station}]")).collect();
    changes.extend(names.iter().enumerate().map(|(k, name)| (name.as_str(), gap * (1.0 + phase(k + 1).cos()))));
    let mut driven = Driven::new(&changes)?;
    driven.set("normal_load", 1e4)?;
    driven.set("sliding_velocity", ratio * critical)?;
    let mut amplitudes = [Complex::from(0.0); 3];
    let mut done = 0;
    for (amplitude, sample) in amplitudes.iter_mut().zip(samples) {
        driven.steps(step, sample - done)?;
        done = sample;
        for station in 1..STATIONS {
            let mut pressure = driven.get(&format!("profile.pressure[{station}]"))?;
            if station == 1 {
                pressure = 0.5 * (pressure + driven.get(&format!("profile.pressure[{STATIONS}]"))?);
            }
            *amplitude += Complex::from_polar(pressure, -phase(station));
        }
    }
    let duration = f64::from(samples[2] - samples[1]) * step;
    let growth = ((amplitudes[2] - amplitudes[1]) / (amplitudes[1] - amplitudes[0])).ln() / (duration * unit());
    Ok(Complex::new(growth.re, growth.im.abs()))
}

pub(super) fn problems() -> Vec<Problem> {
    let mut all = Vec::new();
    for coupled in [false, true] {
        for (ratio, step, samples) in [
            // Late: the half-plane's own conduction decays hardly faster than this wave.
            (0.5, 5e-3, [700, 780, 860]),
            (1.0, 2.5e-3, [200, 280, 360]),
            (2.0, 2.5e-3, [120, 200, 280]),
            (5.0, 5e-4, [120, 220, 320]),
        ] {
            let coupling = if coupled { "with shear coupling" } else { "without shear coupling" };
            let expected = exact(ratio, coupled);
            let (bound, reason) = if ratio < 1.0 {
                (4e-3, "measured in steps of 5 ms: a wave that decays nearly as fast as heat spreads along it")
            } else {
                (1e-3, "32 cells in a wave, second order in time")
            };
            all.push(Problem {
                name: format!("thermoelastic instability {coupling}, R = {ratio}"),
                quantity: "growth rate over kd m^2",
                exact: known(expected.re),
                // At the critical speed the rate is 0.
                scale: Some(1.0 + expected.re.abs()),
                compute: Box::new(move || Ok(computed(ratio, coupled, step, samples)?.re)),
                bound,
                reason,
            });
            if coupled {
                all.push(Problem {
                    name: format!("thermoelastic instability {coupling}, R = {ratio}, turning"),
                    quantity: "rate of turning over kd m^2",
                    exact: known(expected.im.abs()),
                    scale: Some(1.0 + expected.re.abs()),
                    compute: Box::new(move || Ok(computed(ratio, coupled, step, samples)?.im)),
                    bound,
                    reason,
                });
            }
        }
    }
    all
}
