//! Thermoelastic growth under the operator split, in full periodic contact of one conducting half-plane with a rigid insulator.
//!
//! A distortion that comes one step of tau late lets a pressure wave of the number m grow by `g = exp(b tau)` per step with
//! `z (1 + z) = 2 R/g`, `z^2 = 1 + (1 - 1/g)/(tau kd m^2)`, R the speed over `2 K m (1 - nu)/(mu E alpha)`: more slowly than
//! the exact `z (1 + z) = 2 R`, `z^2 = 1 + b/(kd m^2)`, at first order in tau.

use super::driver::Driven;
use super::{Problem, known};
use crate::scene::STATIONS;
use std::f64::consts::PI;

const FRICTION: f64 = 0.3;
const WAVELENGTH: f64 = 0.01;
const CONDUCTIVITY: f64 = 45.0;
const YOUNGS_MODULUS: f64 = 2e11;
const EXPANSION: f64 = 1.1e-5;
const RATIO: f64 = 5.0;

/// Growth rate in 1/s of the longest wave under `scheme`, from the amplitudes after these numbers of steps.
fn growth(scheme: f64, step: f64, samples: [u32; 3]) -> Result<f64, String> {
    let wave = 2.0 * PI / WAVELENGTH;
    let speed = RATIO * 2.0 * CONDUCTIVITY * wave * 0.7 / (FRICTION * YOUNGS_MODULUS * EXPANSION);
    let mut changes = vec![
        ("solver.fidelity", 3.0),
        ("solver.scheme", scheme),
        ("solver.cells", 32.0),
        ("solver.tolerance", 1e-5),
        ("contact.geometry", 3.0),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_coefficient", FRICTION),
        ("contact.initial_shape", 4.0),
        ("strip.path", 2.0),
        ("strip.length", WAVELENGTH),
        ("strip.body", 1.0),
        ("strip.conductivity", 0.0),
        ("strip.wear_coefficient", 0.0),
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
        ("nominal.velocity", speed),
        ("nominal.load", 1e4),
        ("nominal.duration", 1.0),
    ];
    let phase = |station: usize| 2.0 * PI * (station - 1) as f64 / (STATIONS - 1) as f64;
    let gaps: Vec<String> = (1..=STATIONS).map(|station| format!("contact.initial_gap[{station}]")).collect();
    for (name, station) in gaps.iter().zip(1..) {
        changes.push((name, 1e-13 * (1.0 + phase(station).cos())));
    }
    let mut driven = Driven::new(&changes)?;
    driven.set("normal_load", 1e4)?;
    driven.set("sliding_velocity", speed)?;
    let (mut amplitudes, mut done) = ([0.0; 3], 0);
    for (amplitude, sample) in amplitudes.iter_mut().zip(samples) {
        driven.steps(step, sample - done)?;
        done = sample;
        // The first and the last station are halves of the same interval.
        *amplitude = 0.5 * (driven.get("profile.pressure[1]")? + driven.get("profile.pressure[33]")?);
        for station in 2..STATIONS {
            *amplitude += driven.get(&format!("profile.pressure[{station}]"))? * phase(station).cos();
        }
    }
    // The gap stays, so the wave grows on top of a constant.
    let duration = f64::from(samples[2] - samples[1]) * step;
    Ok(((amplitudes[2] - amplitudes[1]) / (amplitudes[1] - amplitudes[0])).ln() / duration)
}

pub(super) fn problems() -> Vec<Problem> {
    [(0.05, 14.515, [10, 13, 16]), (0.01, 24.943, [30, 40, 50])]
        .into_iter()
        .map(|(step, exact, samples)| Problem {
            name: format!("thermoelastic growth at 5 critical speeds, heat split off the contact, steps of {step} s"),
            quantity: "growth rate of the longest wave, 1/s",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || growth(2.0, step, samples)),
            bound: 1e-3,
            reason: "cells of a wave, and the reduction of the punch",
        })
        .collect()
}
