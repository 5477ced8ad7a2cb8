//! A clutch engaged above its critical speed: hot spots of the pressure plate grow, then decay.
//!
//! Theory: docs/theory.md, section 7.4.

use super::{DriveProblem, Sample, Truth, every};
use exact::PressureWave;
use scene::STATIONS;
use scene::variables::{STARTS, changed};
use std::f64::consts::PI;

const WAVELENGTH: f64 = 0.02;
const DEPTH: f64 = 0.039;
const PRESSURE: f64 = 0.25e6;
/// Slip at the mean radius when the clutch begins to close.
const VELOCITY: f64 = 29.7;
const DURATION: f64 = 1.0;
const FRICTION: f64 = 0.35;
const CONDUCTIVITY: f64 = 50.0;
const DENSITY: f64 = 7200.0;
const SPECIFIC_HEAT: f64 = 460.0;
const EXPANSION: f64 = 1.2e-5;
const CONDUCTANCE: f64 = 1e6;
/// Young's modulus and Poisson's ratio of plate and facing.
const PLATE: (f64, f64) = (110e9, 0.26);
const FACING: (f64, f64) = (300e6, 0.25);
/// Wear coefficients of plate and facing, m2/N.
const WEAR: (f64, f64) = (5e-16, 1.5e-14);
/// Waviness of the plate, m.
const WAVINESS: f64 = 1.5e-6;

fn load() -> f64 {
    PRESSURE * WAVELENGTH * DEPTH
}

fn velocity(time: f64) -> f64 {
    VELOCITY * (1.0 - time / DURATION).max(0.0)
}

/// One wave of a ring in full contact. The plate, at rest in the frame of its hot spots, conducts; the facing is an insulator.
pub(super) fn problem() -> Result<DriveProblem, String> {
    let names: Vec<String> = (1..=STATIONS).map(|station| format!("contact.initial_gap[{station}]")).collect();
    let mut changes = vec![
        ("depth", DEPTH),
        ("punch.width", WAVELENGTH),
        ("punch.count", 1.0),
        ("punch.height", 0.026),
        ("punch.body", 3.0),
        ("punch.youngs_modulus", PLATE.0),
        ("punch.poissons_ratio", PLATE.1),
        ("punch.density", DENSITY),
        ("punch.specific_heat", SPECIFIC_HEAT),
        ("punch.conductivity", CONDUCTIVITY),
        ("punch.thermal_expansion", EXPANSION),
        ("punch.wear_coefficient", WEAR.0),
        ("punch.top_thermal", 3.0),
        ("punch.convection", 0.0),
        ("strip.height", 0.026),
        ("strip.body", 3.0),
        ("strip.youngs_modulus", FACING.0),
        ("strip.poissons_ratio", FACING.1),
        ("strip.conductivity", 0.0),
        ("strip.thermal_expansion", 0.0),
        ("strip.wear_coefficient", WEAR.1),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("strip.path", 2.0),
        ("strip.length", WAVELENGTH),
        ("contact.geometry", 3.0),
        ("contact.faces", 1.0),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_coefficient", FRICTION),
        ("contact.conductance", CONDUCTANCE),
        ("contact.initial_shape", 4.0),
        ("nominal.load", load()),
        ("nominal.velocity", VELOCITY),
        ("nominal.duration", DURATION),
        ("nominal.stroke", 0.0),
    ];
    for (station, name) in names.iter().enumerate() {
        let angle = 2.0 * PI * station as f64 / (STATIONS - 1) as f64;
        changes.push((name.as_str(), WAVINESS * (1.0 + angle.cos())));
    }
    let starts = changed(&STARTS, &changes)?;
    let ambient = starts[const { scene::variables::reference("ambient_temperature") } as usize];
    Ok(DriveProblem {
        name: "clutch_engagement",
        title: "Clutch engagement from above the thermoelastic limit: a hot spot grows, then fades",
        data: "slip 29.7 m/s to 0 in 1 s, 0.25 MPa, mu 0.35, one wave of 20 mm of an iron plate on a facing of 300 MPa",
        starts,
        inputs: Box::new(|time| [velocity(time), load()]),
        step: 0.005,
        steps: vec![0.05, 0.025, 0.01, 0.005, 0.0025],
        samples: every(0.05, DURATION),
        truth: Truth::Exact {
            how: "exact: integral equation of every wave of the plate's waviness (second kind, 2,000 steps), half-space for the mean",
            samples: Box::new(move |times| Ok(exact_samples(times, ambient))),
        },
        reason: "the integral equation to 1e-6; bodies high against the wave to 1e-7",
        isothermal: false,
    })
}

/// Amplitude of the Fourier mode `n` of the waviness, which is linear between the stations: a cosine sampled at 32 points
/// contains the modes 32 k +- 1 with the square of the sinc function.
fn share(n: u32) -> f64 {
    let angle = PI * f64::from(n) / (STATIONS - 1) as f64;
    (angle.sin() / angle).powi(2)
}

fn exact_samples(times: &[f64], ambient: f64) -> Vec<Sample> {
    const STEPS: usize = 2000;
    let diffusivity = CONDUCTIVITY / (DENSITY * SPECIFIC_HEAT);
    let waves = [1, 31, 33, 63, 65].map(|n| {
        let wave_number = 2.0 * PI * f64::from(n) / WAVELENGTH;
        let compliance = |(modulus, ratio): (f64, f64)| 2.0 * (1.0 - ratio * ratio) / (modulus * wave_number);
        let wave = PressureWave {
            wave_number,
            compliance: compliance(PLATE) + compliance(FACING),
            distortion: 2.0 * (1.0 + PLATE.1) * EXPANSION,
            conductivity: CONDUCTIVITY,
            diffusivity,
            friction: FRICTION,
            wear: WEAR.0,
        };
        (f64::from(n), wave.course(WAVINESS * share(n), DURATION, STEPS, velocity))
    });
    let effusivity = (CONDUCTIVITY * DENSITY * SPECIFIC_HEAT).sqrt();
    times
        .iter()
        .map(|&time| {
            let index = (time / DURATION * STEPS as f64).round() as usize;
            let distance = VELOCITY * time * (1.0 - 0.5 * time / DURATION);
            let flux = FRICTION * PRESSURE * VELOCITY;
            // Half-space under a flux that falls linearly; the facing's side is hotter by flux/(2 h_c).
            let rise = 2.0 * flux / effusivity * (time / PI).sqrt() * (1.0 - 2.0 * time / (3.0 * DURATION))
                + 0.25 * FRICTION * PRESSURE * velocity(time) / CONDUCTANCE;
            let stations = (STATIONS - 1) as f64;
            let peak = (0..STATIONS).map(|station| {
                let edge = |offset: f64| ((station as f64 + offset) / stations).clamp(0.0, 1.0) * 2.0 * PI;
                let (left, right) = (edge(-0.5), edge(0.5));
                let part = |(n, course): &(f64, Vec<f64>)| {
                    course[index] * ((n * right).sin() - (n * left).sin()) / (n * (right - left))
                };
                PRESSURE + waves.iter().map(part).sum::<f64>()
            });
            let wear = (WEAR.0 + WEAR.1) * PRESSURE * distance;
            let force = FRICTION * load() * velocity(time).signum();
            [wear, ambient + rise, if velocity(time) > 0.0 { force } else { 0.0 }, peak.fold(0.0, f64::max)]
        })
        .collect()
}
