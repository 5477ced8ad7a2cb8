//! Local heating of the strip: exact kernels against the quadrature in real space and the plain Fourier sum.
//!
//! Theory: docs/theory.md, section 4.3.

use super::bodies::iron;
use super::{Problem, known};
use conduction::flash::Flash;
use conduction::moving_source::{MovingSource, Path};
use conduction::slab::Slab;
use exact::reference::{ClosedPath, LayerBase, band_mean};
use scene::FarBoundary;
use std::f64::consts::PI;

pub(super) fn base_of(base: LayerBase) -> FarBoundary {
    match base {
        LayerBase::Held => FarBoundary::Held,
        LayerBase::Insulated => FarBoundary::Insulated,
    }
}

/// A band of half-width 1 on a layer with k = rho c = 1, so that Pe = V/2.
fn unit_source(height: f64, base: FarBoundary) -> MovingSource {
    let slab = Slab::bare(height, [1.0, 1.0], base);
    MovingSource::new(slab, 1.0, Path::Endless)
}

pub(super) fn problems(all: &mut Vec<Problem>) {
    jaeger(all);
    layers(all);
    closed_paths(all);
}

/// Means of the band on the half-plane: Jaeger (1942), and the quadrature of his kernel.
fn jaeger(all: &mut Vec<Problem>) {
    let quantity = "mean T k/(q l)";
    for (peclet, mean) in [(0.1, 2.0618), (1.0, 0.79986), (10.0, 0.24132)] {
        all.push(Problem {
            name: format!("moving band on a half-plane, Jaeger's value, Pe = {peclet}"),
            quantity,
            exact: known(mean),
            scale: None,
            compute: Box::new(move || Ok(unit_source(1e4, FarBoundary::Insulated).resistance(2.0 * peclet))),
            bound: 3e-5,
            reason: "five digits of the printed value",
        });
    }
    for peclet in [0.03, 0.3, 3.0, 30.0, 1e3, 1e5] {
        all.push(Problem {
            name: format!("moving band on a half-plane, kernel quadrature, Pe = {peclet}"),
            quantity,
            exact: Box::new(move || Ok(band_mean(peclet, None))),
            scale: None,
            compute: Box::new(move || Ok(unit_source(1e4, FarBoundary::Insulated).resistance(2.0 * peclet))),
            bound: 1e-6,
            reason: "quadrature over the wave numbers",
        });
    }
    // Fast limit: 2/3 of (2/sqrt(pi)) Pe^(-1/2).
    all.push(Problem {
        name: "moving band on a half-plane, fast limit, Pe = 1e6".into(),
        quantity,
        exact: known(4.0 / (3.0 * PI.sqrt()) * 1e-3),
        scale: None,
        compute: Box::new(|| Ok(unit_source(1e3, FarBoundary::Insulated).resistance(2e6))),
        bound: 2e-3,
        reason: "the limit itself is off by O(Pe^(-1/2))",
    });
}

/// Layers: the sum over the images.
fn layers(all: &mut Vec<Problem>) {
    for (base, label) in [(LayerBase::Held, "held"), (LayerBase::Insulated, "insulated")] {
        for (height, peclet) in [(0.4, 0.2), (0.4, 5.0), (2.0, 0.2), (2.0, 5.0)] {
            all.push(Problem {
                name: format!("moving band on a layer of {height} l, {label} base, image sum, Pe = {peclet}"),
                quantity: "mean T k/(q l)",
                exact: Box::new(move || Ok(band_mean(peclet, Some((height, base))))),
                scale: None,
                compute: Box::new(move || Ok(unit_source(height, base_of(base)).resistance(2.0 * peclet))),
                bound: 1e-6,
                reason: "quadrature over the wave numbers",
            });
        }
    }
}

/// Closed paths: the plain Fourier sum, and the velocity table of the time step.
fn closed_paths(all: &mut Vec<Problem>) {
    let diffusivity = 54.0 / (7200.0 * 460.0);
    for (base, label) in [(LayerBase::Held, "held"), (LayerBase::Insulated, "insulated")] {
        let path =
            ClosedPath { length: 0.74, half_length: 0.0475, height: 0.011, conductivity: 54.0, diffusivity, base };
        let slab = iron(path.height, base_of(base));
        for velocity in [0.0, 1e-4, 0.01, 1.0, 30.0] {
            all.push(Problem {
                name: format!("brake disc, {label} base, plain Fourier sum, {velocity} m/s"),
                quantity: "steady mean without the mean mode, K.m2/W",
                exact: Box::new(move || Ok(path.steady_mean(velocity, 200_000))),
                scale: None,
                compute: Box::new(move || {
                    Ok(MovingSource::new(slab, path.half_length, Path::Closed(path.length)).resistance(velocity))
                }),
                bound: 1e-6,
                reason: "quadrature in place of the sum beyond harmonic 128",
            });
        }
        for velocity in [1e-3, 0.3, 12.0] {
            all.push(Problem {
                name: format!("brake disc, {label} base, table over the speed, {velocity} m/s"),
                quantity: "steady mean without the mean mode, K.m2/W",
                exact: Box::new(move || Ok(path.steady_mean(velocity, 200_000))),
                scale: None,
                compute: Box::new(move || {
                    let source = MovingSource::new(slab, path.half_length, Path::Closed(path.length));
                    Ok(Flash::new(&source, 1000.0, 1e-3).resistance(velocity))
                }),
                bound: 1e-4,
                reason: "cubic interpolation over the logarithm of the speed, a tenth of the default tolerance",
            });
        }
    }
}
