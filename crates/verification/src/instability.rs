//! Growth of pressure waves and of the mean pressure by friction heat: the line level against closed forms.
//!
//! Theory: docs/theory.md, sections 7.4, 10.

use super::driver::Driven;
use super::stability::wear_speed;
use super::wave::{WaveScene, unit};
use super::{Problem, known};
use exact::instability::{critical_frequency, critical_ratio};
use std::sync::{Arc, OnceLock};

pub(super) fn problems(all: &mut Vec<Problem>) {
    growth(all);
    threshold(all);
    slab(all);
    disc(all);
}

/// A disc of 11 mm between two thick pads (K. Lee, J. R. Barber, J. Tribology 115 (1993) 607-614), one wave of 80 1/m along
/// its circumference: its critical speed in the antisymmetric (bending) mode, and that of two thick bodies. Exact values by
/// Simpson's rule through the depth on the stress function of the layer in bending, and bisection.
fn disc(all: &mut Vec<Problem>) {
    for (name, half_thickness, exact) in [("11 mm", 5.5e-3, 8.9107), ("1 m", 0.5, 178.53)] {
        all.push(Problem {
            name: format!("critical speed of a cast iron disc of {name} between two pads, waves of 80 1/m"),
            quantity: "speed, m/s",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || {
                let length = 2.0 * std::f64::consts::PI / 80.0;
                let changes = [
                    ("strip.length", length),
                    ("punch.width", length),
                    ("strip.height", half_thickness),
                    ("strip.specific_heat", 54.0 / 12.98e-6 / 7200.0),
                    ("punch.specific_heat", 0.5 / 0.269e-6 / 2000.0),
                ];
                let mut driven = Driven::read(include_str!("../scenes/lee_disc.toml"), &changes)?;
                driven.get("critical_speed")
            }),
            bound: 5e-3,
            reason: "interpolation between the speeds of the table",
        });
    }
}

/// Growth rates in full periodic contact of a conducting half-plane on a rigid insulator.
fn growth(all: &mut Vec<Problem>) {
    for coupled in [false, true] {
        for (ratio, step, count) in [(0.5, 0.1, 120), (1.0, 0.05, 160), (2.0, 0.02, 160), (5.0, 0.005, 260)] {
            // A decaying wave needs a larger initial amplitude.
            let gap = if ratio < 1.0 { 1e-12 } else { 1e-14 };
            let scene = WaveScene { coupled, gap, ..WaveScene::new(32) };
            let exact = scene.exact(ratio).re;
            all.push(Problem {
                name: format!(
                    "thermoelastic instability at {ratio} times the critical speed, {} shear coupling",
                    if coupled { "with" } else { "without" }
                ),
                quantity: "growth rate, 1/s",
                exact: known(unit() * exact),
                scale: Some(unit() * exact.abs().max(1.0)),
                compute: Box::new(move || Ok(unit() * scene.build()?.growth(ratio, step, count, 8)?.re)),
                bound: 1.2e-3,
                reason: "32 cells on the wavelength, steps of second order, other waves that have not died out",
            });
        }
    }
}

/// The speed at the onset of growing waves on a wearing half-plane, and their frequency there.
fn threshold(all: &mut Vec<Problem>) {
    const REASON: &str =
        "cells that make wear (pi/N)^2/3 too strong, 8e-4 for 64 and 2e-4 for 128; steps of second order";
    for (wear, cells, duration) in [(0.1, 64, 9.0), (1.0, 128, 6.0)] {
        // One run gives both.
        let solved: Arc<OnceLock<Result<(f64, f64), String>>> = Arc::default();
        let found = move || {
            let contact = || WaveScene { wear, ..WaveScene::new(cells) }.build();
            let solve = || contact().and_then(|contact| wear_speed::threshold(&contact, duration));
            solved.get_or_init(|| solve().map_err(|error| error.to_string())).clone()
        };
        let other = found.clone();
        all.push(Problem {
            name: format!("wear-stabilised instability, w = {wear}"),
            quantity: "threshold over the critical speed without wear, 1",
            exact: known(critical_ratio(wear)),
            scale: None,
            compute: Box::new(move || Ok(found()?.0)),
            bound: 1e-3,
            reason: REASON,
        });
        all.push(Problem {
            name: format!("oscillation at the threshold of wear-stabilised instability, w = {wear}"),
            quantity: "angular frequency over kd m^2, 1",
            exact: known(critical_frequency(wear)),
            scale: None,
            compute: Box::new(move || Ok(other()?.1)),
            bound: 1e-3,
            reason: REASON,
        });
    }
}

/// An insulated slab of the thickness L that wears between rigid plates at fixed approach:
/// `p = p0 exp{(M V/L) [alpha' mu/(rho c) - k] t}`, M = E (1-nu)/((1+nu)(1-2nu)), alpha' = alpha (1+nu)/(1-nu), whatever its
/// conductivity, because only its mean temperature matters. The plates are the rigid strip and a caliper 10^7 times as stiff
/// as the slab.
fn slab(all: &mut Vec<Problem>) {
    let (friction, expansion, nu, e) = (0.4, 12e-6, 0.25, 125e9);
    let (thickness, wear, capacity) = (0.01, 1e-13, 7200.0 * 460.0);
    let modulus = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let rate = modulus / thickness * (expansion * (1.0 + nu) / (1.0 - nu) * friction / capacity - wear);
    let side = 0.01;
    let caliper = 1e7 * modulus / thickness * side * side;
    all.push(Problem {
        name: "insulated slab that wears between rigid plates at fixed approach".into(),
        quantity: "growth rate of the pressure, 1/s",
        exact: known(rate),
        scale: None,
        compute: Box::new(move || {
            let mut driven = Driven::new(&[
                ("solver.fidelity", 3.0),
                ("solver.cells", 3.0),
                ("solver.tolerance", 1e-7),
                ("contact.geometry", 3.0),
                ("contact.faces", 1.0),
                ("contact.friction_coefficient", friction),
                ("contact.conductance", 1e12),
                ("holder.stiffness", caliper),
                ("strip.path", 2.0),
                ("strip.length", side),
                ("strip.body", 1.0),
                ("strip.conductivity", 0.0),
                ("strip.wear_coefficient", 0.0),
                ("punch.body", 4.0),
                ("punch.width", side),
                ("depth", side),
                ("punch.height", thickness),
                ("punch.youngs_modulus", e),
                ("punch.poissons_ratio", nu),
                ("punch.density", 7200.0),
                ("punch.specific_heat", 460.0),
                ("punch.conductivity", 54.0),
                ("punch.thermal_expansion", expansion),
                ("punch.wear_coefficient", wear),
                ("punch.convection", 0.0),
                ("punch.top_thermal", 3.0),
                ("nominal.load", 100.0),
                ("nominal.velocity", 1.0),
                ("nominal.duration", 0.05),
            ])?;
            driven.set("normal_load", 100.0)?;
            driven.set("sliding_velocity", 1.0)?;
            driven.steps(1e-4, 50)?;
            let early = driven.get("pressure_mean")?;
            driven.steps(1e-4, 200)?;
            Ok((driven.get("pressure_mean")? / early).ln() / 0.02)
        }),
        bound: 1e-5,
        reason: "steps of second order, and the caliper's own yielding, 1e-7 of the slab's",
    });
}
