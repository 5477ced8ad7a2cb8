//! Conduction through one body: the reduced slab against closed forms.
//!
//! Theory: docs/theory.md, section 4.2.

use super::{Problem, known};
use conduction::reduced::{Port, ReducedBody};
use conduction::slab::Slab;
use exact::reference::root;
use scene::FarBoundary;
use std::f64::consts::PI;

/// Slab of grey cast iron.
pub(super) fn iron(height: f64, base: FarBoundary) -> Slab {
    Slab::bare(height, [54.0, 7200.0 * 460.0], base)
}

/// Rise of the contact surface at `time` (s) under a constant `flux` (W/m2) from a uniform temperature.
fn rise(body: &ReducedBody, flux: f64, time: f64) -> f64 {
    let contact = Port::Contact as usize;
    let states: f64 = (0..body.count)
        .map(|k| {
            let z = body.rate[k] * time;
            let grown = if z < 1e-8 { time } else { -(-z).exp_m1() / body.rate[k] };
            body.contact_temperature.states[k] * body.input[contact][k] * grown
        })
        .sum();
    flux * (states + body.contact_temperature.direct[contact])
}

pub(super) fn problems(all: &mut Vec<Problem>) {
    half_space(all);
    steady(all);
    decay_rates(all);
}

/// A slab heated for so short a time that its base has no effect: T = 2 q sqrt(t/(pi k rho c)), 84.375 K.
fn half_space(all: &mut Vec<Problem>) {
    for (time, bound, reason) in [
        (1.0, 1e-4, "reduced with a tolerance of 1e-4 of the rise over its duration of 1 s"),
        (0.01, 1e-3, "the tolerance of 1e-4 is relative to the rise over 1 s, ten times this one"),
    ] {
        all.push(Problem {
            name: format!("half-space under constant flux, slab of 100 mm, {time} s"),
            quantity: "temperature rise, K",
            exact: known(2.0 * 1e6 * (time / (PI * 54.0 * 7200.0 * 460.0)).sqrt()),
            scale: None,
            compute: Box::new(move || Ok(rise(&iron(0.1, FarBoundary::Insulated).reduce(1.0, 1e-4), 1e6, time))),
            bound,
            reason,
        });
    }
}

/// Stationary temperature under a constant flux: the resistances h/k and 1/H in series.
fn steady(all: &mut Vec<Problem>) {
    for (name, base, transfer) in [
        ("held base", FarBoundary::Held, f64::INFINITY),
        ("base convecting 200 W/(m2.K)", FarBoundary::Convecting(200.0), 200.0),
    ] {
        let resistance = 0.011 / 54.0 + transfer.recip();
        all.push(Problem {
            name: format!("steady slab, {name}"),
            quantity: "temperature rise, K",
            exact: known(1e4 * resistance),
            scale: None,
            compute: Box::new(move || Ok(rise(&iron(0.011, base).reduce(1000.0, 1e-3), 1e4, 1e7))),
            bound: 1e-8,
            reason: "stationary solutions are in the reduced space; rounding of the eigenvalues remains",
        });
    }
}

/// Slowest decay rates kd beta^2: beta h = n pi insulated, (n - 1/2) pi held, beta h tan(beta h) = H h/k convecting.
fn decay_rates(all: &mut Vec<Problem>) {
    let (height, conductivity, diffusivity): (f64, f64, f64) = (0.011, 54.0, 54.0 / (7200.0 * 460.0));
    let own = diffusivity / height.powi(2);
    let biot = 2e4 * height / conductivity;
    let convecting = root(0.0, 0.5 * PI, |x| x * x.tan() - biot);
    let cases = [
        ("insulated, first", FarBoundary::Insulated, 1, PI, 1e-6),
        ("insulated, second", FarBoundary::Insulated, 2, 2.0 * PI, 1e-4),
        ("held, first", FarBoundary::Held, 0, 0.5 * PI, 1e-6),
        ("held, second", FarBoundary::Held, 1, 1.5 * PI, 1e-4),
        ("convecting 20 kW/(m2.K), first", FarBoundary::Convecting(2e4), 0, convecting, 1e-6),
    ];
    for (name, base, index, root, bound) in cases {
        all.push(Problem {
            name: format!("decay rate of a slab, {name}"),
            quantity: "rate, 1/s",
            exact: known(own * root * root),
            scale: None,
            compute: Box::new(move || Ok(iron(height, base).reduce(1000.0, 1e-4).rate[index])),
            bound,
            reason: "Ritz values from above; the faster the mode the fewer of the chosen frequencies are near it",
        });
    }
}
