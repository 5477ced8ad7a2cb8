//! The wearing contact line: relaxation, stability bound of explicit steps, order in time. What steps through time is the component.
//!
//! Theory: docs/theory.md, sections 5.2, 5.6, 10.

use super::contact_line::deviation;
use super::driver::Driven;
use super::{Fallible, Problem, known};
use crate::explicit_limit::explicit_limit;
use contact::wear::line::{CellRate, Conditions, WearingContact};
use contact::{Normal, Tilt, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid, Winkler};
use exact::{GalinRelaxation, winkler_relaxation_rate, worn_cylinder_half_width};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use numerics::maximum::maximum;
use scene::STATIONS;

pub(super) fn problems(all: &mut Vec<Problem>) {
    winkler(all);
    galin(all);
    cylinder(all);
    explicit(all);
    orders(all);
}

/// Half-plane with E* = 1.
pub(super) fn half_plane() -> Fallible<HalfPlane> {
    Ok(HalfPlane { material: Material::new(0.91, 0.3)? })
}

/// A rigid punch on a body without friction.
fn contact(cells: &Cells, body: &dyn ElasticBody) -> Fallible<WearingContact> {
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), &body.compliance(cells));
    Ok(WearingContact::new(cells, cells.widths(), normal, shear * 0.0, vec![0.0; cells.count()])?)
}

fn conditions(load: f64) -> Conditions {
    let rate = CellRate::archard(1.0, 1.0);
    Conditions { signed_friction: 1.0, normal: Normal::Load(load), tilt: Tilt::Fixed(0.0), rate }
}

const HALF_WIDTH: f64 = 0.03;
const DEPTH: f64 = 0.01;
const MEAN_PRESSURE: f64 = 2e7;
const LOAD: f64 = MEAN_PRESSURE * 2.0 * HALF_WIDTH * DEPTH;
/// Rate of the wear depth under the mean pressure, m/s: at 1 m/s, whatever the exponent.
const WEAR_RATE: f64 = 1e-6;
/// `E/(1 - nu^2)` of the half-plane, Pa.
const MODULUS: f64 = 2e11 / 0.91;
const FOUNDATION: f64 = 1e13;
/// Number of `strip.body`.
const WINKLER: f64 = 2.0;
const HALF_PLANE: f64 = 3.0;
/// Numbers of `contact.initial_shape`.
const PARABOLIC: f64 = 2.0;
const TABULATED: f64 = 4.0;

/// A rigid punch on a cold strip, unidirectional: the punch alone wears.
const WEARING: &[(&str, f64)] = &[
    ("solver.fidelity", 3.0),
    ("punch.width", 2.0 * HALF_WIDTH),
    ("depth", DEPTH),
    ("punch.body", 1.0),
    ("strip.youngs_modulus", 2e11),
    ("strip.poissons_ratio", 0.3),
    ("strip.foundation_stiffness", FOUNDATION),
    ("strip.path", 2.0),
    ("strip.length", 2.0),
    ("contact.geometry", 1.0),
    ("contact.mean_radius", 0.0),
    ("contact.shear_coupling", 0.0),
    ("contact.faces", 1.0),
    ("punch.count", 1.0),
    ("punch.thermal_expansion", 0.0),
    ("strip.thermal_expansion", 0.0),
    // Pressure and wear alone.
    ("solver.heat", 2.0),
    ("strip.wear_coefficient", 0.0),
    ("nominal.load", LOAD),
    ("nominal.velocity", 1.0),
];

/// [`WEARING`] on a body of this number with wear of this exponent, and with changes; under [`LOAD`] at 1 m/s.
fn wearing(body: f64, exponent: f64, changes: &[(&str, f64)]) -> Fallible<Driven> {
    let own = [
        ("strip.body", body),
        ("punch.wear_pressure_exponent", exponent),
        ("punch.wear_coefficient", WEAR_RATE / (1e6 * (MEAN_PRESSURE / 1e6).powf(exponent))),
    ];
    let mut driven = Driven::new(&[WEARING, &own, changes].concat())?;
    driven.set("sliding_velocity", 1.0)?;
    driven.set("normal_load", LOAD)?;
    Ok(driven)
}

/// Values of a profile at its stations, over `scale`.
fn stations(driven: &mut Driven, name: &str, scale: f64) -> Fallible<Vec<f64>> {
    (1..=STATIONS).map(|station| Ok(driven.get(&format!("{name}[{station}]"))? / scale)).collect()
}

/// Settings of a tabulated gap (m) over x/a.
fn tabulated(gap: impl Fn(f64) -> f64) -> Vec<(String, f64)> {
    let station =
        |k: usize| (format!("contact.initial_gap[{}]", k + 1), gap(2.0 * k as f64 / (STATIONS - 1) as f64 - 1.0));
    (0..STATIONS).map(station).chain([("contact.initial_shape".into(), TABULATED)]).collect()
}

/// Winkler foundation, p - pm decays as exp(-k_w k s): one time constant.
fn winkler(all: &mut Vec<Problem>) {
    for (exponent, amplitude, bound) in [(0.3, 1e-5, 1e-3), (1.0, 0.2, 1e-4), (3.0, 1e-5, 1e-3)] {
        all.push(Problem {
            name: format!("wear on a Winkler foundation, b = {exponent}"),
            quantity: "deviation from the mean pressure after one time constant over that before, 1",
            exact: known((-1.0f64).exp()),
            scale: None,
            compute: Box::new(move || {
                let gap = tabulated(|x| amplitude * MEAN_PRESSURE / FOUNDATION * (1.0 + x));
                let mut changes: Vec<(&str, f64)> = gap.iter().map(|(name, value)| (name.as_str(), *value)).collect();
                changes.extend([("solver.cells", 9.0), ("solver.tolerance", 1e-8)]);
                let mut driven = wearing(WINKLER, exponent, &changes)?;
                let deviation = |driven: &mut Driven| -> Fallible<f64> {
                    let pressure = stations(driven, "profile.pressure", MEAN_PRESSURE)?;
                    Ok(pressure[0] - pressure[STATIONS - 1])
                };
                let before = deviation(&mut driven)?;
                // Rate of the depth under p relative to the mean: WEAR_RATE (p/pm)^b.
                let rate = winkler_relaxation_rate(FOUNDATION / MEAN_PRESSURE, WEAR_RATE, exponent, 1.0);
                driven.steps(1.0 / rate, 1)?;
                Ok(deviation(&mut driven)? / before)
            }),
            bound,
            reason: "steps to 1e-8 of the elastic displacement; linearised for b other than 1",
        });
    }
}

/// Largest error of p/pm over tau = 0.1, 0.5, 1, 3 at the station nearest to x = `part` a: its mean over the station's
/// interval.
fn galin_error(count: usize, part: f64, tolerance: f64) -> Fallible<f64> {
    let exact = GalinRelaxation::new(150);
    let mut driven = wearing(HALF_PLANE, 1.0, &[("solver.cells", count as f64), ("solver.tolerance", tolerance)])?;
    let station = ((part + 1.0) * 0.5 * (STATIONS - 1) as f64).round() as usize;
    let spacing = 2.0 / (STATIONS - 1) as f64;
    let x = spacing * station as f64 - 1.0;
    let (mut time, mut largest) = (0.0, 0.0f64);
    for end in [0.1, 0.5, 1.0, 3.0] {
        driven.steps((end - time) * HALF_WIDTH * MEAN_PRESSURE / (MODULUS * WEAR_RATE), 1)?;
        time = end;
        let computed = stations(&mut driven, "profile.pressure", MEAN_PRESSURE)?[station];
        let mean = exact.mean_pressure(end, x - 0.5 * spacing, x + 0.5 * spacing);
        largest = maximum(largest, (computed - mean).abs());
    }
    Ok(largest)
}

/// Largest eigenvalues of C on pressures of zero mean, E* = a = 1.
fn eigenvalues(count: usize) -> Fallible<Vec<f64>> {
    let cells = Cells::graded(1.0, count)?;
    let normal = half_plane()?.compliance(&cells).normal;
    let root: Vec<f64> = cells.widths().iter().map(|c| (c / 2.0).sqrt()).collect();
    let mut matrix = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] * root[i] / root[j]);
    let unit = DVector::from_column_slice(&root);
    let image = &matrix * &unit;
    let energy = unit.dot(&image);
    matrix -= &image * unit.transpose() + &unit * image.transpose();
    matrix += &unit * unit.transpose() * energy;
    let eigen = factorization::symmetric_eigen(matrix)?;
    let mut values: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    Ok(values)
}

/// Flat rigid punch on a half-plane, b = 1.
fn galin(all: &mut Vec<Problem>) {
    for (count, bound) in [(64, 1e-3), (256, 1e-4)] {
        for (x, factor) in [(0.0, 1.0), (0.5, 1.0), (0.875, 5.0)] {
            all.push(deviation(
                format!("wear of a flat punch on a half-plane, {count} cells, x = {x} a"),
                "largest error of p/pm at tau = .1, .5, 1, 3",
                move || galin_error(count, x, 0.02 * bound),
                factor * bound,
                "second order in the cells; the edges' logarithmic slope is near at .875 a",
            ));
        }
    }
    for (count, bound) in [(64, 5e-3), (256, 3e-4)] {
        for index in 0..3 {
            all.push(Problem {
                name: format!("relaxation lengths on a half-plane, {count} cells, number {}", index + 1),
                quantity: "Lambda E*/a, 1",
                exact: Box::new(move || Ok(GalinRelaxation::new(60).eigenvalues(3)[index])),
                scale: None,
                compute: Box::new(move || Ok(eigenvalues(count)?[index])),
                bound,
                reason: "second order in the cells",
            });
        }
    }
}

/// A cylinder on a stiff flat at late times: a^3 = (3/2) k F' R s.
fn cylinder(all: &mut Vec<Problem>) {
    const RADIUS: f64 = 10.0;
    const DURATION: f64 = 1.5;
    all.push(Problem {
        name: "cylinder wearing a flat, 129 cells".into(),
        quantity: "half-width of the flat, m",
        // Depth under the load per depth F': WEAR_RATE over MEAN_PRESSURE times the pressure.
        exact: known(worn_cylinder_half_width(WEAR_RATE / MEAN_PRESSURE, LOAD / DEPTH, RADIUS, DURATION)),
        scale: None,
        compute: Box::new(|| {
            let mut driven = wearing(
                HALF_PLANE,
                1.0,
                &[
                    ("strip.youngs_modulus", 1e16),
                    ("contact.initial_shape", PARABOLIC),
                    ("contact.initial_radius", RADIUS),
                    ("solver.cells", 129.0),
                    ("solver.tolerance", 1e-2),
                ],
            )?;
            driven.steps(DURATION, 1)?;
            // Mean depth over the interval h of the middle station: (a^2 - h^2/12)/(2 R).
            let worn = stations(&mut driven, "profile.wear_punch", 1.0)?;
            let interval = 2.0 * HALF_WIDTH / (STATIONS - 1) as f64;
            Ok((2.0 * RADIUS * worn[STATIONS / 2] + interval.powi(2) / 12.0).sqrt())
        }),
        bound: 1e-3,
        reason: "cells at the edge of the flat, and an elastic flattening of 1e-5 of the depth",
    });
}

fn explicit(all: &mut Vec<Problem>) {
    all.push(Problem {
        name: "explicit wear steps on a Winkler foundation".into(),
        quantity: "stability bound times k_w k, 1",
        exact: known(2.0),
        scale: None,
        compute: Box::new(|| {
            let cells = Cells::graded(1.0, 12)?;
            let mut contact = contact(&cells, &Winkler::new(4.0)?)?;
            Ok(4.0 * explicit_limit(&mut contact, &conditions(2.0), &[1.0; 12]))
        }),
        bound: 1e-12,
        reason: "closed form",
    });
    let uniform = || -> Fallible<(Cells, WearingContact, Conditions, f64)> {
        let cells = Cells::uniform(1.0, 100)?;
        let mut contact = contact(&cells, &half_plane()?)?;
        let given = conditions(200.0);
        let limit = explicit_limit(&mut contact, &given, &[100.0; 100]);
        Ok((cells, contact, given, limit))
    };
    all.push(Problem {
        name: "explicit wear steps on a half-plane, 100 uniform cells".into(),
        quantity: "stability bound times E*/(k c), 1",
        exact: known(1.0855),
        scale: None,
        compute: Box::new(move || {
            let (cells, _, _, limit) = uniform()?;
            Ok(limit / cells.widths()[0])
        }),
        bound: 1e-3,
        reason: "the bound is that of endless cells; 100 of them have edges",
    });
    for share in [0.98, 1.02] {
        all.push(Problem {
            name: format!("explicit wear steps of {share} of the bound"),
            quantity: "factor of the sawtooth disturbance per step, 1",
            exact: known(1.0 - 2.0 * share),
            scale: None,
            compute: Box::new(move || {
                let (_, mut contact, given, limit) = uniform()?;
                let mut worn: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1e-6 } else { -1e-6 }).collect();
                let (mut before, mut now) = (0.0, 0.0);
                for _ in 0..10 {
                    let pressure = contact.pressure(&worn, &given)?.pressure;
                    worn.iter_mut().zip(&pressure).for_each(|(w, p)| *w += share * limit * p);
                    before = now;
                    // In the middle, where the sawtooth is the least damped disturbance.
                    let alternating = (30..70).map(|i| if i % 2 == 0 { pressure[i] } else { -pressure[i] });
                    now = alternating.sum();
                }
                Ok(now / before)
            }),
            bound: 1e-2,
            reason: "the least damped disturbance of 100 cells is a sawtooth but for its edges",
        });
    }
}

/// Relaxation of the Winkler foundation, or of the half-plane, s.
fn relaxation(lifting: bool) -> f64 {
    MEAN_PRESSURE / WEAR_RATE * if lifting { HALF_WIDTH / MODULUS } else { 1.0 / FOUNDATION }
}

/// Worn depth at the stations after two relaxations in equal communication steps, over the depth under the mean pressure.
///
/// At the largest tolerance every communication step is one step of the method.
fn stepped(steps: u32, lifting: bool) -> Fallible<Vec<f64>> {
    let gap = tabulated(|x| MEAN_PRESSURE / FOUNDATION * 0.2 * (1.0 + (3.0 * x).sin()));
    let mut changes: Vec<(&str, f64)> = gap.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    if lifting {
        let radius = HALF_WIDTH.powi(2) / (2.0 * MEAN_PRESSURE * HALF_WIDTH / MODULUS);
        changes = vec![("contact.initial_shape", PARABOLIC), ("contact.initial_radius", radius)];
    }
    changes.extend([("solver.cells", 33.0), ("solver.tolerance", 0.5)]);
    let mut driven = wearing(if lifting { HALF_PLANE } else { WINKLER }, 1.0, &changes)?;
    let length = 2.0 * relaxation(lifting) / f64::from(steps);
    let load = |step: u32| 0.25 * LOAD * (1.0 + 0.8 * (8.0 * f64::from(step) / f64::from(steps)).sin());
    for step in 0..steps {
        if lifting {
            driven.set("normal_load", load(step))?;
            driven.set_slope("normal_load", (load(step + 1) - load(step)) / length)?;
        }
        driven.steps(length, 1)?;
    }
    // The mean temperature takes one step, the shape another.
    let taken = driven.work().0;
    if taken != 2 * u64::from(steps) {
        return Err(format!("{steps} communication steps took {taken} steps of the method").into());
    }
    stations(&mut driven, "profile.wear_punch", WEAR_RATE * 2.0 * relaxation(lifting))
}

fn orders(all: &mut Vec<Problem>) {
    let order = |lifting: bool, coarse: u32, halvings: u32| -> Fallible<f64> {
        let fine = coarse << halvings;
        let truth = stepped(16 * fine, lifting)?;
        let error = |steps: u32| -> Fallible<f64> {
            let worn = stepped(steps, lifting)?;
            Ok(worn.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
        };
        Ok((error(coarse)? / error(fine)?).log2() / f64::from(halvings))
    };
    for (name, lifting, coarse, halvings, bound) in
        [("full contact", false, 40, 2, 0.05), ("edges that lift off and touch down", true, 16, 5, 0.1)]
    {
        all.push(Problem {
            name: format!("wear in equal steps, {name}"),
            quantity: "order in time, 1",
            exact: known(2.0),
            scale: None,
            compute: Box::new(move || order(lifting, coarse, halvings)),
            bound,
            reason: "slope over a few halvings of the step",
        });
    }
}
