//! The reduced slab against the exact impedance, steady flows and series of Carslaw and Jaeger.

use super::*;
use crate::reduced::{Observation, Port};
use nalgebra::{DMatrix, DVector};

fn iron(base: FarBoundary) -> Slab {
    Slab::bare(0.011, [54.0, 7200.0 * 460.0], base)
}

fn cases() -> Vec<Slab> {
    let mut cases = Vec::new();
    for base in
        [FarBoundary::Held, FarBoundary::Insulated, FarBoundary::Convecting(200.0), FarBoundary::Convecting(1e6)]
    {
        for (surface, volume, cooling) in
            [(0.0, 0.0, CoolingPort::Surface), (80.0, 0.0, CoolingPort::Surface), (0.0, 4e3, CoolingPort::Sides)]
        {
            cases.push(Slab { surface_transfer: surface, volume_transfer: volume, cooling, ..iron(base) });
        }
    }
    cases
}

#[test]
fn reduced_impedance_follows_the_exact_one() {
    for slab in cases() {
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let body = slab.reduce(1000.0, tolerance);
            assert!(body.error <= 0.1 * tolerance, "{slab:?} {tolerance}: {} at {} states", body.error, body.count);
            assert!(body.rate[..body.count].iter().all(|&rate| rate >= 0.0));
        }
    }
}

#[test]
fn heat_is_conserved_and_steady_flows_are_exact() {
    for slab in cases() {
        let body = slab.reduce(1000.0, 1e-3);
        if body.rate[0] == 0.0 {
            // No heat leaves: the flow is zero for every state and for the flux.
            assert!(body.base_flow.states[..body.count].iter().all(|flow| flow.abs() < 1e-9 * 7200.0 * 460.0));
            assert!(body.base_flow.direct[0].abs() < 1e-10, "{:?}", body.base_flow.direct);
            continue;
        }
        // Constant unit contact flux: all of it leaves, in the exact proportion.
        let steady = |observation: &Observation, port: usize| -> f64 {
            (0..body.count).map(|k| observation.states[k] * body.input[port][k] / body.rate[k]).sum::<f64>()
                + observation.direct[port]
        };
        let (ambient, base) = (steady(&body.ambient_flow, 0), steady(&body.base_flow, 0));
        assert!((ambient + base - 1.0).abs() < 1e-10, "{slab:?}: {ambient} + {base}");
        let surface = slab.impedance(Complex::from(0.0), 0.0).re;
        assert!(
            (steady(&body.contact_temperature, 0) / surface - 1.0).abs() < 1e-8,
            "{slab:?}: {} {surface}",
            steady(&body.contact_temperature, 0)
        );
        if slab.surface_transfer > 0.0 {
            assert!((ambient - slab.surface_transfer * surface).abs() < 1e-8, "{slab:?}: {ambient}");
        }
        // Uniform temperature everywhere: zero flow.
        let both = |observation: &Observation| {
            steady(observation, Port::Ambient as usize)
                + if slab.base == FarBoundary::Held { steady(observation, Port::Base as usize) } else { 0.0 }
        };
        let level = both(&body.contact_temperature);
        assert!((level - 1.0).abs() < 1e-7, "{slab:?}: {level}");
        assert!(both(&body.ambient_flow).abs() < 1e-4, "{slab:?} {}", both(&body.ambient_flow));
        assert!(both(&body.base_flow).abs() < 1e-4, "{slab:?} {}", both(&body.base_flow));
    }
}

#[test]
fn a_temperature_of_the_base_arrives_by_diffusion() {
    // Slab that is insulated at the contact: Carslaw and Jaeger, section 3.4.
    let slab = iron(FarBoundary::Held);
    for tolerance in [1e-1, 1e-2, 1e-3] {
        let body = slab.reduce(1000.0, tolerance);
        let time = slab.height.powi(2) / slab.diffusivity();
        let exact = |t: f64| {
            let term = |n: i32| {
                let root = (f64::from(n) + 0.5) * std::f64::consts::PI;
                2.0 * (-root * root * t).exp() / (root * if n % 2 == 0 { 1.0 } else { -1.0 })
            };
            1.0 - (0..400).map(term).sum::<f64>()
        };
        let base = Port::Base as usize;
        for (part, bound) in [(0.0, 4e-3), (1e-4, 4e-3), (0.001, 4e-3), (0.01, 1e-3), (0.1, 1e-4), (1.0, 1e-5)] {
            let states: f64 = (0..body.count)
                .map(|k| {
                    let grown = -(-body.rate[k] * part * time).exp_m1() / body.rate[k];
                    body.contact_temperature.states[k] * body.input[base][k] * grown
                })
                .sum();
            let found = states + body.contact_temperature.direct[base];
            // By reciprocity a flux into the contact does not leave at once through the base.
            assert!(body.base_flow.direct[0].abs() < 4e-3, "{}", body.base_flow.direct[0]);
            let expected = if part < 1e-3 { 0.0 } else { exact(part) };
            assert!((found - expected).abs() < bound, "after {part} of h^2/kd: {found} for {expected}");
        }
    }
}

#[test]
fn a_heat_path_at_the_base_cools_the_contact_by_diffusion() {
    // Slab at 1 K, insulated at the contact, with a conductance G to 0 K: Carslaw and Jaeger, section 3.11.
    let slab = iron(FarBoundary::Insulated);
    let time = slab.height.powi(2) / slab.diffusivity();
    for tolerance in [1e-1, 1e-2, 1e-3] {
        let body = slab.reduce(1000.0, tolerance);
        for biot in [0.1, 1.0, 10.0, 1e3, 1e9] {
            let roots: Vec<f64> = (0..2000)
                .map(|n| {
                    let (mut low, mut high) = (0.0, 0.5 * std::f64::consts::PI);
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        let root = f64::from(n) * std::f64::consts::PI + middle;
                        if root * middle.tan() < biot { low = middle } else { high = middle }
                    }
                    f64::from(n) * std::f64::consts::PI + low
                })
                .collect();
            let exact = |part: f64| -> [f64; 2] {
                let terms = roots.iter().map(|root| {
                    let size = 2.0 * biot / (biot * (biot + 1.0) + root * root) * (-root * root * part).exp();
                    // cos(root) has the sign of n; at the base it cancels.
                    [size / root.cos(), size]
                });
                terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
            };
            // da/dt = -(R + g b b^T) a, with the flux of the path at the reduced temperature of the base.
            let (port, conductance) = (Port::Base as usize, biot * slab.conductivity / slab.height);
            let inputs = DVector::from_fn(body.count, |k, _| body.input[port][k]);
            let gain = conductance / (1.0 + conductance * body.base_temperature.direct[port]);
            let rates = DMatrix::from_fn(body.count, body.count, |i, j| {
                gain * inputs[i] * inputs[j] + if i == j { body.rate[i] } else { 0.0 }
            });
            let eigen = rates.symmetric_eigen();
            let start = eigen.eigenvectors.tr_mul(&DVector::from_fn(body.count, |k, _| body.uniform[k]));
            for part in [0.0, 1e-3, 0.01, 0.1, 1.0] {
                let decayed =
                    DVector::from_fn(body.count, |k, _| start[k] * (-eigen.eigenvalues[k] * part * time).exp());
                let states = &eigen.eigenvectors * decayed;
                let flux = -gain * states.dot(&inputs);
                let [contact, base] = [&body.contact_temperature, &body.base_temperature].map(|seen| {
                    (0..body.count).map(|k| seen.states[k] * states[k]).sum::<f64>() + seen.direct[port] * flux
                });
                let expected = if part == 0.0 { [1.0, 1.0] } else { exact(part) };
                assert!((contact - expected[0]).abs() < 1e-3, "{biot} {part}: {contact} for {expected:?}");
                // Before, the flux has not left the layer over which it is spread.
                let resolved = part >= 0.01;
                assert!(!resolved || (base - expected[1]).abs() < 4e-3, "{biot} {part}: {base} for {expected:?}");
            }
        }
    }
}
