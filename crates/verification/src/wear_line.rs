//! The wearing contact line: relaxation, stability bound of explicit steps, order in time.
//!
//! Theory: docs/theory.md, sections 5.2, 5.6, 10.

use super::contact_line::deviation;
use super::{Problem, known};
use crate::integrator::{Integrator, Scheme};
use contact::wear::line::{CellRate, Conditions, WearingContact, explicit_limit};
use contact::{ContactState, Normal, Tilt, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid, Winkler};
use exact::{GalinRelaxation, winkler_relaxation_rate, worn_cylinder_half_width};
use nalgebra::{DMatrix, DVector};
use numerics::factorization;

pub(super) fn problems() -> Vec<Problem> {
    let mut all = Vec::new();
    winkler(&mut all);
    galin(&mut all);
    cylinder(&mut all);
    explicit(&mut all);
    orders(&mut all);
    all
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Half-plane with E* = 1.
pub(super) fn half_plane() -> Result<HalfPlane, String> {
    Ok(HalfPlane { material: Material::new(0.91, 0.3).map_err(text)? })
}

/// A rigid punch on a body; a signed friction of 1 stands for this friction coefficient.
fn contact(cells: &Cells, body: &dyn ElasticBody, friction: f64, gap: Vec<f64>) -> Result<WearingContact, String> {
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), &body.compliance(cells));
    WearingContact::new(cells, cells.widths(), normal, shear * friction, gap).map_err(text)
}

fn conditions(load: f64, exponent: f64) -> Conditions {
    let rate = CellRate::uniform(1.0, 1.0, exponent);
    Conditions { signed_friction: 1.0, normal: Normal::Load(load), tilt: Tilt::Fixed(0.0), rate }
}

/// Integrates the wear for `duration` with steps chosen to `tolerance`; returns the state at the end.
fn advance(
    contact: &mut WearingContact,
    worn: &mut [f64],
    duration: f64,
    tolerance: f64,
    given: &Conditions,
) -> Result<ContactState, String> {
    let mut state = ContactState::new(worn.len());
    let mut integrator = Integrator::new(Scheme::Sdirk2, tolerance, worn.len());
    integrator.advance(contact, worn, 0.0, duration, &mut |_, c| c.clone_from(given), &mut state).map_err(text)?;
    Ok(state)
}

/// Winkler foundation, p - pm decays as exp(-k_w k s): k_w = 2, one time constant.
fn winkler(all: &mut Vec<Problem>) {
    for (exponent, amplitude, bound) in [(0.3, 1e-5, 1e-3), (1.0, 0.2, 1e-4), (3.0, 1e-5, 1e-3)] {
        let mean: f64 = 4.0;
        let rate = winkler_relaxation_rate(2.0, 1.0, exponent, mean);
        all.push(Problem {
            name: format!("wear on a Winkler foundation, b = {exponent}"),
            quantity: "deviation from the mean pressure after one time constant over that before, 1",
            exact: known((-1.0f64).exp()),
            scale: None,
            compute: Box::new(move || {
                let cells = Cells::graded(1.0, 9).map_err(text)?;
                let gap: Vec<f64> = cells.centres().iter().map(|x| amplitude * x).collect();
                let given = conditions(2.0 * mean, exponent);
                let mut contact = contact(&cells, &Winkler::new(2.0).map_err(text)?, 0.0, gap)?;
                let start = contact.pressure(&[0.0; 9], &given).map_err(text)?;
                let mut worn = vec![0.0; 9];
                let end = advance(&mut contact, &mut worn, 1.0 / rate, 1e-8, &given)?;
                Ok((end.pressure[8] - mean) / (start.pressure[8] - mean))
            }),
            bound,
            reason: "steps to 1e-8 of the elastic displacement; linearised for b other than 1",
        });
    }
}

/// Largest error of p/pm at x over tau = .1, .5, 1, 3.
fn galin_error(count: usize, x: f64, tolerance: f64) -> Result<f64, String> {
    let exact = GalinRelaxation::new(150);
    let cells = Cells::graded(1.0, count).map_err(text)?;
    let given = conditions(2.0, 1.0);
    let mut contact = contact(&cells, &half_plane()?, 0.0, vec![0.0; count])?;
    let mut worn = vec![0.0; count];
    let (mut time, mut largest) = (0.0, 0.0f64);
    for end in [0.1, 0.5, 1.0, 3.0] {
        let state = advance(&mut contact, &mut worn, end - time, tolerance, &given)?;
        time = end;
        largest = largest.max((cells.point_value(&state.pressure, x) - exact.pressure(end, x)).abs());
    }
    Ok(largest)
}

/// Largest eigenvalues of C on pressures of zero mean, E* = a = 1.
fn eigenvalues(count: usize) -> Result<Vec<f64>, String> {
    let cells = Cells::graded(1.0, count).map_err(text)?;
    let normal = half_plane()?.compliance(&cells).normal;
    let root: Vec<f64> = cells.widths().iter().map(|c| (c / 2.0).sqrt()).collect();
    let mut matrix = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] * root[i] / root[j]);
    let unit = DVector::from_column_slice(&root);
    let image = &matrix * &unit;
    let energy = unit.dot(&image);
    matrix -= &image * unit.transpose() + &unit * image.transpose();
    matrix += &unit * unit.transpose() * energy;
    let eigen = factorization::symmetric_eigen(matrix).map_err(text)?;
    let mut values: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    Ok(values)
}

/// Flat rigid punch on a half-plane, b = 1.
fn galin(all: &mut Vec<Problem>) {
    for (count, bound) in [(64, 1e-3), (256, 1e-4)] {
        for (x, factor) in [(0.0, 1.0), (0.5, 1.0), (0.9, 5.0)] {
            all.push(deviation(
                format!("wear of a flat punch on a half-plane, {count} cells, x = {x} a"),
                "largest error of p/pm at tau = .1, .5, 1, 3",
                move || galin_error(count, x, 0.02 * bound),
                factor * bound,
                "second order in the cells; the edges' logarithmic slope is near at .9 a",
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
    all.push(Problem {
        name: "cylinder wearing a flat, 129 cells".into(),
        quantity: "half-width of the flat, m",
        exact: known(worn_cylinder_half_width(1.0, 1.0, 2.0, 0.1)),
        scale: None,
        compute: Box::new(|| {
            let cells = Cells::graded(1.0, 129).map_err(text)?;
            let stiff = HalfPlane { material: Material::new(1e6, 0.3).map_err(text)? };
            let mut contact = contact(&cells, &stiff, 0.0, cells.means_from_primitive(|x| x.powi(3) / 12.0))?;
            let mut worn = vec![0.0; 129];
            advance(&mut contact, &mut worn, 0.1, 1e-2, &conditions(1.0, 1.0))?;
            // Depth in the middle: a^2/(2 R).
            Ok((4.0 * cells.point_value(&worn, 0.0)).sqrt())
        }),
        bound: 1e-3,
        reason: "cells at the edge of the flat, and an elastic flattening of 1e-6",
    });
}

fn explicit(all: &mut Vec<Problem>) {
    all.push(Problem {
        name: "explicit wear steps on a Winkler foundation".into(),
        quantity: "stability bound times k_w k, 1",
        exact: known(2.0),
        scale: None,
        compute: Box::new(|| {
            let cells = Cells::graded(1.0, 12).map_err(text)?;
            let mut contact = contact(&cells, &Winkler::new(4.0).map_err(text)?, 0.0, vec![0.0; 12])?;
            Ok(4.0 * explicit_limit(&mut contact, &conditions(2.0, 1.0), &[1.0; 12]))
        }),
        bound: 1e-12,
        reason: "closed form",
    });
    let uniform = || -> Result<(Cells, WearingContact, Conditions, f64), String> {
        let cells = Cells::uniform(1.0, 100).map_err(text)?;
        let mut contact = contact(&cells, &half_plane()?, 0.0, vec![0.0; 100])?;
        let given = conditions(200.0, 1.0);
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
                    let pressure = contact.pressure(&worn, &given).map_err(text)?.pressure;
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

/// Integrates the wear over the time 2 in equal steps.
fn stepped(scheme: Scheme, exponent: f64, count: usize, steps: usize, lifting: bool) -> Result<Vec<f64>, String> {
    let cells = Cells::graded(1.0, count).map_err(text)?;
    let (body, friction): (Box<dyn ElasticBody>, f64) = match lifting {
        true => (Box::new(half_plane()?), 0.3),
        false => (Box::new(Winkler::new(2.0).map_err(text)?), 0.0),
    };
    let gap = cells.centres().iter().map(|x| if lifting { x * x } else { 0.2 * (3.0 * x).sin() }).collect();
    let mut contact = contact(&cells, &*body, friction, gap)?;
    let mut given = |time: f64, c: &mut Conditions| {
        let load = if lifting { 0.5 * (1.0 + 0.8 * (4.0 * time).sin()) } else { 2.0 };
        *c = conditions(load, exponent);
    };
    let (mut worn, mut state) = (vec![0.0; count], ContactState::new(count));
    let mut integrator = Integrator::new(scheme, 1.0, count);
    let length = 2.0 / steps as f64;
    for step in 0..steps {
        integrator.step(&mut contact, &mut worn, step as f64 * length, length, &mut given, &mut state).map_err(text)?;
    }
    Ok(worn)
}

fn orders(all: &mut Vec<Problem>) {
    let order = |lifting: bool, scheme: Scheme, coarse: usize, halvings: u32| -> Result<f64, String> {
        let fine = coarse << halvings;
        let truth = stepped(Scheme::Sdirk2, 1.0, 33, 16 * fine, lifting)?;
        let widths = Cells::graded(1.0, 33).map_err(text)?;
        let error = |steps: usize| -> Result<f64, String> {
            let worn = stepped(scheme, 1.0, 33, steps, lifting)?;
            let square: Vec<f64> = worn.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).collect();
            Ok(widths.integral(&square).sqrt())
        };
        Ok((error(coarse)? / error(fine)?).log2() / f64::from(halvings))
    };
    for (name, lifting, scheme, exact, coarse, halvings, bound) in [
        ("full contact", false, Scheme::Sdirk2, 2.0, 40, 2, 0.05),
        ("full contact, implicit Euler", false, Scheme::ImplicitEuler, 1.0, 40, 2, 0.1),
        ("edges that lift off and touch down", true, Scheme::Sdirk2, 2.0, 16, 5, 0.1),
    ] {
        all.push(Problem {
            name: format!("wear in equal steps, {name}"),
            quantity: "order in time, 1",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || order(lifting, scheme, coarse, halvings)),
            bound,
            reason: "slope over a few halvings of the step",
        });
    }
}
