//! Steady states of the wearing contact line, without time integration.
//!
//! Theory: docs/theory.md, section 9.

use super::contact_line::deviation;
use super::wear_line::half_plane;
use super::{Fallible, Problem, known};
use crate::integrator::{Integrator, Scheme};
use contact::wear::law::PressureLaw;
use contact::wear::line::{CellRate, Conditions, WearTerm, WearingContact};
use contact::{ContactState, Normal, Tilt, pair_operators};
use elasticity::block::{Block, BlockProperties, Discretization};
use elasticity::{Cells, Compliance, ElasticBody, Rigid};
use exact::{CyclicHalfPlane, HolderKind, annular_pressure, unidirectional_rotating_pressure};
use steady::{CycleProblem, Reciprocating, ReciprocatingProblem, punch_run_in};

/// Load per depth on a width of 2: a mean pressure of 1.
const LOAD: f64 = 2.0;

pub(super) fn problems(all: &mut Vec<Problem>) {
    unidirectional(all);
    half_planes(all);
    stepping(all);
    even_wear(all);
    block_table(all);
}

/// Cycle of a rigid punch on a half-plane, E* = 1, nu = 0.3, a = 1.
fn cycle(cells: &Cells, friction: f64, pivot_height: Option<f64>, wear_per_stroke: f64) -> Fallible<Reciprocating> {
    let (punch, strip) = (Rigid.compliance(cells), half_plane()?.compliance(cells));
    let problem = ReciprocatingProblem {
        cells,
        punch: &punch,
        strip: &strip,
        friction,
        load: LOAD,
        pivot_height,
        wear_per_stroke,
    };
    Ok(problem.solve()?)
}

fn unidirectional(all: &mut Vec<Problem>) {
    for lever in [0.1, 1.0 / 6.0] {
        all.push(deviation(
            format!("unidirectional punch free to rotate, lever {lever:.3} of the width, 129 cells"),
            "largest error of p/pm",
            move || {
                let cells = Cells::graded(0.5, 129)?;
                let rate = CellRate::uniform(1.0, 1.0, 1.0);
                let state = punch_run_in(&cells, cells.widths(), &rate, 1.0, Tilt::ResultantAt(lever))?;
                let error = |(x, p): (&f64, &f64)| (p - unidirectional_rotating_pressure(*x, lever, 1.0)).abs();
                Ok(cells.centres().iter().zip(&state.pressure).map(error).fold(0.0, f64::max))
            },
            1e-3,
            "the moment is taken with constant pressure on each cell: second order",
        ));
    }
    for (a, b) in [(1.0, 1.0), (2.0, 1.0), (1.0, 0.5), (0.5, 1.5)] {
        all.push(deviation(
            format!("annular punch from 1 to 2 m, a = {a}, b = {b}, 65 cells"),
            "largest relative error of p = C r^(-a/b)",
            move || {
                let cells = Cells::graded(0.5, 65)?;
                let radii: Vec<f64> = cells.centres().iter().map(|x| (1.5 + x) / 1.5).collect();
                let weights: Vec<f64> = cells.widths().iter().zip(&radii).map(|(c, r)| c * r).collect();
                let coefficient: Vec<f64> = radii.iter().map(|r: &f64| r.powf(a)).collect();
                let terms = vec![WearTerm { coefficient: coefficient.into(), law: PressureLaw::power(b) }];
                let rate = CellRate { reference_pressure: 1.0, terms };
                let state = punch_run_in(&cells, &weights, &rate, LOAD, Tilt::Fixed(0.0))?;
                let error =
                    |(x, p): (&f64, &f64)| (p / annular_pressure(1.5 + x, LOAD, (1.0, 2.0), (a, b)) - 1.0).abs();
                Ok(cells.centres().iter().zip(&state.pressure).map(error).fold(0.0, f64::max))
            },
            5e-4,
            "the load is summed over cells: second order",
        ));
    }
}

fn half_planes(all: &mut Vec<Problem>) {
    let cases = [
        ("free to rotate, m = .5", Some(1.0), HolderKind::Rotate { relative_height: 1.0 }),
        ("free to rotate, m = .2", Some(0.4), HolderKind::Rotate { relative_height: 0.4 }),
        ("translating, nu = .3", None, HolderKind::Translate { poissons_ratio: 0.3 }),
    ];
    for (name, pivot_height, holder) in cases {
        let exact = move || CyclicHalfPlane::new(0.25, holder).ok_or_else(|| "no steady cycle".to_owned());
        all.push(deviation(
            format!("reciprocating on a half-plane, mu = .25, {name}, 65 cells"),
            "largest error of the cell means of p+/pm at |x| < .8 a",
            move || {
                let exact = exact()?;
                let cells = Cells::graded(1.0, 65)?;
                let found = cycle(&cells, 0.25, pivot_height, 0.0)?;
                let means = cells.means_from_primitive(|x| exact.forward_primitive(x));
                let inside = |i: &usize| cells.centres()[*i].abs() < 0.8;
                Ok((0..65).filter(inside).map(|i| (found.forward[i] - means[i]).abs()).fold(0.0, f64::max))
            },
            1e-3,
            "the clipped edge lies anywhere in a cell",
        ));
        all.push(Problem {
            name: format!("reciprocating on a half-plane, mu = .25, {name}, clipped edge of 65 cells"),
            quantity: "distance from the middle over a, 1",
            exact: Box::new(move || Ok(exact()?.inner_half_width())),
            scale: Some(1.0),
            compute: Box::new(move || {
                let cells = Cells::graded(1.0, 65)?;
                let found = cycle(&cells, 0.25, pivot_height, 0.0)?;
                let clipped = found.forward.iter().filter(|p| **p == 0.0).count();
                // By symmetry the same number of cells at either edge.
                Ok(cells.edges()[cells.count() - clipped])
            }),
            bound: match pivot_height {
                Some(1.0) => 0.0255,
                Some(_) => 0.01,
                None => 0.0066,
            },
            reason: "one cell there",
        });
    }
}

/// Implicit Euler, one step per half-stroke, 400 cycles; forward and backward means over the half-strokes.
fn stepped(cells: &Cells, friction: f64, height: Option<f64>, wear: f64) -> Fallible<[Vec<f64>; 2]> {
    let count = cells.count();
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), &half_plane()?.compliance(cells));
    let mut contact = WearingContact::new(cells, cells.widths(), normal, shear, vec![0.0; count])?;
    let mut integrator = Integrator::new(Scheme::ImplicitEuler, count);
    let (mut worn, mut state) = (vec![0.0; count], ContactState::new(count));
    let mut means = [vec![0.0; count], vec![0.0; count]];
    for _ in 0..400 {
        for (mean, sign) in means.iter_mut().zip([1.0, -1.0]) {
            let before = worn.clone();
            let mut given = |_: f64, c: &mut Conditions| {
                *c = Conditions {
                    signed_friction: sign * friction,
                    normal: Normal::Load(LOAD),
                    tilt: height.map_or(Tilt::Fixed(0.0), |h| Tilt::ResultantAt(sign * friction * h)),
                    rate: CellRate::uniform(1.0, wear, 1.0),
                };
            };
            integrator.step(&mut contact, &mut worn, 0.0, 1.0, &mut given, &mut state)?;
            *mean = worn.iter().zip(&before).map(|(a, b)| (a - b) / wear).collect();
        }
    }
    Ok(means)
}

fn stepping(all: &mut Vec<Problem>) {
    for (name, height) in [("translating", None), ("free to rotate", Some(1.1))] {
        let cells = || Cells::graded(1.0, 33);
        all.push(deviation(
            format!("reciprocating, by 400 cycles of time stepping, {name}, 33 cells"),
            "largest |p+ + p- - 2 pm|/pm of the half-stroke means",
            move || {
                let [forward, backward] = stepped(&cells()?, 0.3, height, 0.7)?;
                Ok(forward.iter().zip(&backward).map(|(p, q)| (p + q - 2.0).abs()).fold(0.0, f64::max))
            },
            1e-10,
            "the slowest disturbance has decayed to rounding",
        ));
        all.push(deviation(
            format!("direct steady cycle against 400 cycles of time stepping, {name}, 33 cells"),
            "largest |difference of p|/pm at equal wear per step",
            move || {
                let cells = cells()?;
                let [forward, backward] = stepped(&cells, 0.3, height, 0.7)?;
                let direct = cycle(&cells, 0.3, height, 0.7)?;
                let forward = forward.iter().zip(&direct.forward).map(|(p, q)| (p - q).abs());
                let backward = backward.iter().zip(&direct.backward).map(|(p, q)| (p - q).abs());
                Ok(forward.chain(backward).fold(0.0, f64::max))
            },
            1e-8,
            "the same equations; what 400 cycles have left",
        ));
    }
}

/// For every exponent the wear of the cycle is uniform: t+ p+^b + t- p-^b is constant.
fn even_wear(all: &mut Vec<Problem>) {
    for exponent in [0.3, 0.5, 2.0, 3.0] {
        all.push(deviation(
            format!("reciprocating on a half-plane, b = {exponent}, half-strokes of 1 and .6"),
            "largest deviation of the depth per cycle from its mean, over it",
            move || {
                let cells = Cells::graded(1.0, 65)?;
                let (punch, strip) = (Rigid.compliance(&cells), half_plane()?.compliance(&cells));
                let rate = CellRate::uniform(1.0, 1.0, exponent);
                let problem = CycleProblem {
                    cells: &cells,
                    punch: &punch,
                    strip: &strip,
                    friction: [0.3; 2],
                    load: LOAD,
                    pivot_height: None,
                    rate: &rate,
                    durations: [1.0, 0.6],
                };
                let found = problem.solve()?;
                let pairs = found.forward.iter().zip(&found.backward);
                let depth: Vec<f64> = pairs.map(|(p, q)| p.powf(exponent) + 0.6 * q.powf(exponent)).collect();
                let mean = cells.integral(&depth) / 2.0;
                Ok(depth.iter().map(|d| (d / mean - 1.0).abs()).fold(0.0, f64::max))
            },
            1e-9,
            "Newton's method to rounding",
        ));
    }
}

/// p+/pm in tenths of the width from the trailing edge; width 2, height 2, nu = 0.3, held at the top, translating on a
/// rigid strip, mu = 0.25. By biquadratic finite elements for the whole field, 120 x 60 of them graded to the edges,
/// with one pressure per element: 40 to 120 of them agree to 1e-4 from two tenths on.
const BLOCK_PRESSURES: [f64; 9] = [0.4340, 0.7023, 0.8403, 0.9299, 1.0, 1.0701, 1.1597, 1.2977, 1.5660];
/// Clipped width at either edge, over a.
const BLOCK_CLIPPED: f64 = 0.112;

fn block_cycle(count: usize) -> Fallible<(Cells, Reciprocating)> {
    let cells = Cells::graded(1.0, count)?;
    let properties = BlockProperties { width: 2.0, height: 2.0, youngs_modulus: 0.91, poissons_ratio: 0.3 };
    let block = Block::new(properties, Discretization::for_cells(2.0, 2.0, cells.edges(), 1e-4))?;
    let compliance = block.compliance(cells.edges())?;
    let punch = Compliance { normal: compliance.normal, shear: compliance.shear };
    let strip = Rigid.compliance(&cells);
    let problem = ReciprocatingProblem {
        cells: &cells,
        punch: &punch,
        strip: &strip,
        friction: 0.25,
        load: LOAD,
        pivot_height: None,
        wear_per_stroke: 0.0,
    };
    let found = problem.solve()?;
    Ok((cells, found))
}

fn block_table(all: &mut Vec<Problem>) {
    for (index, exact) in BLOCK_PRESSURES.into_iter().enumerate() {
        all.push(Problem {
            name: format!("reciprocating elastic block, {} tenths of the width, 129 cells", index + 1),
            quantity: "p+/pm, 1",
            exact: known(exact),
            scale: Some(1.0),
            compute: Box::new(move || {
                let (cells, found) = block_cycle(129)?;
                Ok(cells.point_value(&found.forward, -0.8 + 0.2 * index as f64))
            }),
            bound: 5e-4,
            reason: "three figures; the clipped edge lies anywhere in a cell",
        });
    }
    all.push(Problem {
        name: "reciprocating elastic block, clipped edge of 129 cells".into(),
        quantity: "clipped width over a, 1",
        exact: known(BLOCK_CLIPPED),
        scale: Some(1.0),
        compute: Box::new(|| {
            let (cells, found) = block_cycle(129)?;
            let clipped = found.forward.iter().filter(|p| **p == 0.0).count();
            Ok(1.0 + cells.edges()[clipped])
        }),
        bound: 0.012,
        reason: "one cell there",
    });
}
