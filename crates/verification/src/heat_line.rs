//! The strip along the contact line: moving bands resolved on the cells against Jaeger, image sums and plain Fourier sums.
//!
//! Theory: docs/theory.md, section 4.5.

use super::moving_source::base_of;
use super::{Fallible, Problem, known};
use conduction::lateral::Lateral;
use conduction::line::strip::{Expansion, Resolution, SlidingPath, StripHeat, StripProperties};
use conduction::line::{FrozenState, Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use conduction::slab::Slab;
use elasticity::{self, Cells, Material};
use exact::reference::{ClosedPath, LayerBase, band_maximum, band_mean, square_mean};
use scene::FarBoundary;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Step longer than all transients: the response is the steady one.
const FOR_EVER: f64 = 1e12;

/// A band of half-width 1 on a layer with K = rho c = 1, so that Pe = V/2.
fn unit(height: f64, base: FarBoundary, path: SlidingPath) -> StripProperties {
    StripProperties::bare(Slab::bare(height, [1.0, 1.0], base), path)
}

fn resolution(duration: f64, shortest: f64, tolerance: f64) -> Resolution {
    Resolution { duration, shortest, travel: f64::INFINITY, tolerance }
}

/// Cells, and their steady temperatures under a uniform flux 1 at `velocity`.
fn steady(
    properties: &StripProperties,
    cells: usize,
    half_width: f64,
    resolution: Resolution,
    velocity: f64,
) -> Fallible<(Cells, Vec<f64>)> {
    let cells = Cells::graded(half_width, cells)?;
    let mut body = StripHeat::new(properties, &cells, &resolution)?;
    body.prepare(&Step::new(FOR_EVER, [velocity; 2]));
    let influence = &body.influence(Stage::End).temperature;
    let answer = (0..cells.count()).map(|i| influence.row(i).sum()).collect();
    Ok((cells, answer))
}

fn mean(cells: &Cells, values: &[f64]) -> f64 {
    cells.integral(values) / (2.0 * cells.half_width())
}

/// Largest value over the contact and its position.
fn maximum(cells: &Cells, values: &[f64]) -> (f64, f64) {
    let points = (0..=20_000).map(|k| -1.0 + 1e-4 * f64::from(k));
    points
        .map(|x| (cells.point_value(values, x), x))
        .fold((0.0, 0.0), |best, here| if here.0 > best.0 { here } else { best })
}

pub(super) fn problems(all: &mut Vec<Problem>) {
    jaeger(all);
    unidirectional(all);
    between_nodes(all);
    closed_paths(all);
    oscillating(all);
    squares(all);
    distortion(all);
}

/// Jaeger (1942) on a layer so high that it is a half-plane, and on low layers against the sum over images.
fn jaeger(all: &mut Vec<Problem>) {
    // Heat of a slow band spreads so far that steps of a tenth of its thermal time would need too many Fourier modes.
    let slow = resolution(1e6, 10.0, 1e-4);
    let fast = resolution(1e4, 0.1, 1e-3);
    for (peclet, height, cells, path, resolution) in [
        (0.1, 60.0, 65, SlidingPath::Closed(4000.0), slow),
        (1.0, 12.0, 65, SlidingPath::Unidirectional, fast),
        (10.0, 4.0, 65, SlidingPath::Unidirectional, fast),
        (100.0, 1.0, 129, SlidingPath::Unidirectional, fast),
    ] {
        moving_band(all, peclet, None, move || {
            steady(&unit(height, FarBoundary::Held, path), cells, 1.0, resolution, 2.0 * peclet)
        });
    }
    for (height, base) in [(0.4, LayerBase::Held), (2.0, LayerBase::Insulated)] {
        for (peclet, cells) in [(0.1, 65), (1.0, 65), (10.0, 65), (100.0, 129)] {
            moving_band(all, peclet, Some((height, base)), move || {
                let resolution = if peclet < 1.0 { slow } else { fast };
                steady(&unit(height, base_of(base), SlidingPath::Unidirectional), cells, 1.0, resolution, 2.0 * peclet)
            });
        }
    }
}

/// A square on a half-space with lateral conduction to both sides, against the history integral of the instantaneous sources.
fn squares(all: &mut Vec<Problem>) {
    let fast = resolution(1e4, 0.1, 1e-3);
    for (peclet, height, cells, path, resolution) in
        [(1.0, 30.0, 33, SlidingPath::Unidirectional, fast), (10.0, 4.0, 33, SlidingPath::Unidirectional, fast)]
    {
        all.push(Problem {
            name: format!("moving square by cells, half-space, {path:?}, Pe = {peclet}"),
            quantity: "mean T k/(q l)",
            exact: Box::new(move || Ok(square_mean(peclet))),
            scale: None,
            compute: Box::new(move || {
                let lateral = Some(Lateral::new(2.0, 1.0));
                let properties = StripProperties { lateral, ..unit(height, FarBoundary::Held, path) };
                let (cells, values) = steady(&properties, cells, 1.0, resolution, 2.0 * peclet)?;
                Ok(mean(&cells, &values))
            }),
            bound: 5e-3,
            reason: "eleven decays for what spreads to both sides",
        });
    }
}

/// Maximum, its position and mean of a moving band from one steady response on the cells.
fn moving_band(
    all: &mut Vec<Problem>,
    peclet: f64,
    layer: Option<(f64, LayerBase)>,
    steady: impl Fn() -> Fallible<(Cells, Vec<f64>)> + Copy + Send + Sync + 'static,
) {
    let body = match layer {
        None => "half-plane".to_owned(),
        Some((height, LayerBase::Held)) => format!("layer of {height} l, held base"),
        Some((height, LayerBase::Insulated)) => format!("layer of {height} l, insulated base"),
    };
    // One solution serves all three.
    let solved: Arc<OnceLock<Result<[f64; 3], String>>> = Arc::default();
    let solve = move || {
        let (cells, values) = steady().map_err(|error| error.to_string())?;
        let (highest, place) = maximum(&cells, &values);
        Ok([highest, place, mean(&cells, &values)])
    };
    let answer = |index: usize| {
        let solved = solved.clone();
        Box::new(move || Ok(solved.get_or_init(solve).clone()?[index]))
    };
    let found: Arc<OnceLock<(f64, f64)>> = Arc::default();
    let highest = |part: fn((f64, f64)) -> f64| {
        let found = found.clone();
        Box::new(move || Ok(part(*found.get_or_init(|| band_maximum(peclet, layer)))))
    };
    all.push(Problem {
        name: format!("moving band by cells, {body}, Jaeger, Pe = {peclet}"),
        quantity: "max T k/(q l)",
        exact: highest(|(value, _)| value),
        scale: None,
        compute: answer(0),
        bound: 1e-4,
        reason: "reduction and table over the velocity, interpolation between the cells",
    });
    all.push(Problem {
        name: format!("moving band by cells, {body}, Jaeger's place of the maximum, Pe = {peclet}"),
        quantity: "place of the maximum x/l",
        exact: highest(|(_, place)| place),
        scale: Some(1.0),
        compute: answer(1),
        bound: 3e-4,
        reason: "flat at the maximum, which is looked for in steps of 1e-4",
    });
    all.push(Problem {
        name: format!("moving band by cells, {body}, Jaeger's mean, Pe = {peclet}"),
        quantity: "mean T k/(q l)",
        exact: Box::new(move || Ok(band_mean(peclet, layer))),
        scale: None,
        compute: answer(2),
        bound: 1e-4,
        reason: "reduction and table over the velocity",
    });
}

/// Unidirectional on fresh material: the image sum, at every speed.
fn unidirectional(all: &mut Vec<Problem>) {
    for (base, label, height) in
        [(LayerBase::Held, "held", 0.4), (LayerBase::Held, "held", 40.0), (LayerBase::Insulated, "insulated", 2.0)]
    {
        for peclet in [1.0, 100.0, 1e6] {
            all.push(Problem {
                name: format!("moving band by cells, unidirectional, layer of {height} l, {label} base, Pe = {peclet}"),
                quantity: "mean T k/(q l)",
                exact: Box::new(move || Ok(band_mean(peclet, Some((height, base))))),
                scale: None,
                compute: Box::new(move || {
                    let properties = unit(height, base_of(base), SlidingPath::Unidirectional);
                    let resolution = resolution(1e4, 0.1, 1e-3);
                    let (cells, values) = steady(&properties, 33, 1.0, resolution, 2.0 * peclet)?;
                    Ok(mean(&cells, &values))
                }),
                bound: 1e-4,
                reason: "reduction and table over the velocity",
            });
        }
    }
}

/// Unidirectional on fresh material at velocities between the nodes of the velocity table.
fn between_nodes(all: &mut Vec<Problem>) {
    const HEIGHT: f64 = 2.0;
    const COUNT: usize = 24;
    for tolerance in [1e-3, 1e-4] {
        all.push(Problem {
            name: format!(
                "moving band by cells, unidirectional, {COUNT} speeds from Pe = 1 to 1000, tolerance {tolerance}"
            ),
            quantity: "largest relative error of the mean T",
            exact: Box::new(|| Ok(0.0)),
            scale: Some(1.0),
            compute: Box::new(move || {
                let cells = Cells::graded(1.0, 33)?;
                let resolution = resolution(1e4, 0.1, tolerance);
                let mut body =
                    StripHeat::new(&unit(HEIGHT, FarBoundary::Held, SlidingPath::Unidirectional), &cells, &resolution)?;
                let errors = (0..COUNT).map(|k| {
                    let peclet = 1e3f64.powf(k as f64 / (COUNT - 1) as f64);
                    body.prepare(&Step::new(FOR_EVER, [2.0 * peclet; 2]));
                    let influence = &body.influence(Stage::End).temperature;
                    let answer: Vec<f64> = (0..cells.count()).map(|i| influence.row(i).sum()).collect();
                    (mean(&cells, &answer) / band_mean(peclet, Some((HEIGHT, LayerBase::Held))) - 1.0).abs()
                });
                Ok(errors.fold(0.0, f64::max))
            }),
            bound: 0.1 * tolerance,
            reason: "table over the velocity, whose interpolation nodes are closer at tighter tolerances",
        });
    }
}

/// Brake disc: excess temperature of the contact over the disc's mean, against the plain Fourier sum.
fn closed_paths(all: &mut Vec<Problem>) {
    let (conductivity, capacity) = (54.0, 7200.0 * 460.0);
    for velocity in [0.01, 1.0, -1.0, 30.0] {
        let path = ClosedPath {
            length: 0.74,
            half_length: 0.0475,
            height: 0.011,
            conductivity,
            diffusivity: conductivity / capacity,
            base: LayerBase::Held,
        };
        // Contribution of the mean mode: the flux over the period through the layer.
        let uniform = 2.0 * path.half_length / path.length * path.height / conductivity;
        all.push(Problem {
            name: format!("brake disc by cells, held base, plain Fourier sum, {velocity} m/s"),
            quantity: "steady mean, K.m2/W",
            exact: Box::new(move || Ok(path.steady_mean(velocity, 200_000) + uniform)),
            scale: None,
            compute: Box::new(move || {
                let properties = StripProperties::bare(
                    Slab::bare(path.height, [conductivity, capacity], FarBoundary::Held),
                    SlidingPath::Closed(path.length),
                );
                let resolution = resolution(1000.0, 0.01, 1e-3);
                let (cells, values) = steady(&properties, 33, path.half_length, resolution, velocity)?;
                Ok(mean(&cells, &values))
            }),
            bound: 1e-4,
            reason: "reduction and table over the velocity",
        });
    }
}

/// A band that oscillates by half of its half-width: temperature at its centre after 20, 40 and 80 periods.
fn oscillating(all: &mut Vec<Problem>) {
    for (periods, exact) in [(20, 2.41276), (40, 2.63325), (80, 2.85382)] {
        all.push(Problem {
            name: format!("oscillating band on a half-plane, {periods} periods"),
            quantity: "T k/(q l) at the centre",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || {
                let cells = Cells::graded(1.0, 33)?;
                let properties = unit(150.0, FarBoundary::Held, SlidingPath::Stroke { stroke: 1.0, length: 0.0 });
                let step = 2.0 * PI / 64.0;
                let resolution = resolution(160.0 * PI, step, 1e-4);
                let mut body = StripHeat::new(&properties, &cells, &resolution)?;
                let mut state = vec![0.0; body.states()];
                let (flux, air) = (vec![1.0; cells.count()], Surroundings::default());
                let velocity = |index: i32| 0.5 * (f64::from(index) * step).cos();
                for index in 0..64 * periods {
                    body.prepare(&Step::new(step, [velocity(index), velocity(index + 1)]));
                    body.step(&mut state, &air, &flux, &flux);
                }
                let velocity = velocity(64 * periods);
                let end = FrozenState { state: &state, surroundings: &air, flux: &flux, velocity };
                Ok(cells.point_value(&end.temperature(&body), 0.0))
            }),
            bound: 1e-4,
            reason: "reduction, and a velocity that is linear in each of 64 steps a period",
        });
    }
}

/// A steadily heated half-plane has the curvature alpha (1+nu) q/K.
fn distortion(all: &mut Vec<Problem>) {
    all.push(Problem {
        name: "thermal distortion of a half-plane under a uniform flux at rest".into(),
        quantity: "curvature per flux, 1/(W/m)",
        exact: known(1.1e-5 * 1.3 / 55.0),
        scale: None,
        compute: Box::new(|| {
            let material = Material::new(200e9, 0.3)?;
            let expansion = Expansion { material, coefficient: 1.1e-5, base: elasticity::Base::Smooth };
            let properties = StripProperties {
                expansion: Some(expansion),
                ..StripProperties::bare(
                    Slab::bare(100.0, [55.0, 7800.0 * 460.0], FarBoundary::Held),
                    SlidingPath::Stroke { stroke: 0.01, length: 0.0 },
                )
            };
            let cells = Cells::graded(0.1, 33)?;
            let resolution = resolution(1e10, 100.0, 1e-3);
            let mut body = StripHeat::new(&properties, &cells, &resolution)?;
            body.prepare(&Step::new(1e14, [0.0; 2]));
            let influence = &body.influence(Stage::End).distortion;
            let moved: Vec<f64> = (0..33).map(|i| influence.row(i).sum()).collect();
            let at = |x: f64| cells.point_value(&moved, x);
            Ok((at(0.05) + at(-0.05) - 2.0 * at(0.0)) / 0.05f64.powi(2))
        }),
        bound: 2e-3,
        reason: "second difference of the cells; waves shorter than a quarter of the shortest with states are left out",
    });
}
