//! The contact line without wear: surface kernels, indenting and sliding punches, the elastic block.
//!
//! Theory: docs/theory.md, sections 3, 6.6.

use super::{Fallible, Problem, Value, known};
use contact::{ContactSolver, Normal, Tilt, pair_compliance};
use elasticity::block::{Block, BlockProperties, Discretization};
use elasticity::{Base, Cells, ElasticBody, HalfPlane, Material, Rigid, StripKernel};
use exact::reference::root;
use exact::{FlatPunch, HertzLine, friction_exponent};

const HALF_WIDTH: f64 = 0.03;
const LOAD: f64 = 1e6;
const NU: f64 = 0.3;

pub(super) fn problems(all: &mut Vec<Problem>) {
    kernels(all);
    punches(all);
    block_energy(all);
}

/// A deviation whose exact value is zero.
pub(super) fn deviation(
    name: String,
    quantity: &'static str,
    compute: impl Fn() -> Fallible<f64> + 'static,
    bound: f64,
    reason: &'static str,
) -> Problem {
    Problem { name, quantity, exact: known(0.0), scale: Some(1.0), compute: Box::new(compute), bound, reason }
}

/// Kernels of the layer as published, with hyperbolic functions.
fn written_kernels(base: Base, u: f64) -> (f64, f64) {
    let kappa: f64 = 3.0 - 4.0 * NU;
    let squeezed: f64 = 1.0 - 2.0 * NU;
    match base {
        Base::Bonded => (
            (2.0 * kappa * (2.0 * u).sinh() - 4.0 * u)
                / (2.0 * kappa * (2.0 * u).cosh() + 1.0 + kappa * kappa + 4.0 * u * u),
            (kappa * squeezed * u.sinh().powi(2) - u * u)
                / (squeezed * (kappa * u.sinh().powi(2) + u * u + 4.0 * (1.0 - NU).powi(2))),
        ),
        Base::Smooth => (
            ((2.0 * u).cosh() - 1.0) / ((2.0 * u).sinh() + 2.0 * u),
            (squeezed * (2.0 * u).sinh() - 2.0 * u) / (squeezed * ((2.0 * u).sinh() + 2.0 * u)),
        ),
    }
}

/// G = 1, q = 2: normal displacement per pressure (1-nu)/(G q) Phi, per shear (1-2nu)/(2 G q) Psi.
fn kernels(all: &mut Vec<Problem>) {
    let reason = "closed forms; rounding";
    for (name, base) in [("bonded", Base::Bonded), ("smooth", Base::Smooth)] {
        for height in [0.15, 1.0, 3.0] {
            let u = 2.0 * height;
            let kernel = StripKernel::new(base, NU);
            let (normal, shear) = written_kernels(base, u);
            all.push(Problem {
                name: format!("layer on a {name} base, q h = {u}, pressure"),
                quantity: "normal displacement per pressure, m/Pa",
                exact: known((1.0 - NU) / 2.0 * normal),
                scale: None,
                compute: Box::new(move || Ok((1.0 - NU) / 2.0 * kernel.normal(u))),
                bound: 1e-10,
                reason,
            });
            all.push(Problem {
                name: format!("layer on a {name} base, q h = {u}, shear"),
                quantity: "normal displacement per shear, m/Pa",
                exact: known((1.0 - 2.0 * NU) / 4.0 * shear),
                scale: None,
                compute: Box::new(move || Ok(kernel.shear(u) / 4.0)),
                bound: 1e-10,
                reason,
            });
        }
        let exact: Value = match base {
            Base::Bonded => {
                Box::new(|| Ok(root(0.5, 2.0, |u| (3.0 - 4.0 * NU) * (1.0 - 2.0 * NU) * u.sinh().powi(2) - u * u)))
            }
            Base::Smooth => Box::new(|| Ok(root(0.5, 2.0, |u| (1.0 - 2.0 * NU) * (2.0 * u).sinh() - 2.0 * u))),
        };
        all.push(Problem {
            name: format!("layer on a {name} base, change of sign of the shear kernel"),
            quantity: "q h, 1",
            exact,
            scale: None,
            compute: Box::new(move || {
                let kernel = StripKernel::new(base, NU);
                Ok(root(0.5, 2.0, |u| kernel.shear(u)))
            }),
            bound: 1e-10,
            reason,
        });
    }
}

/// Pressure of a punch with the given gap on a steel half-plane.
fn pressure(cells: &Cells, signed_friction: f64, gap: &[f64]) -> Fallible<Vec<f64>> {
    let material = Material::new(200e9, NU)?;
    let strip = HalfPlane { material }.compliance(cells);
    let compliance = pair_compliance(&Rigid.compliance(cells), &strip, signed_friction);
    let mut solver = ContactSolver::new(cells, compliance)?;
    let state = solver.solve(gap, Normal::Load(LOAD), Tilt::Fixed(0.0))?;
    Ok(state.pressure)
}

/// Largest deviation of cell means within 0.9 of the contact half-width, relative to `scale`.
fn largest_error(cells: &Cells, pressure: &[f64], carried: impl Fn(f64) -> f64, half_width: f64, scale: f64) -> f64 {
    let exact = cells.means_from_primitive(carried);
    (0..cells.count())
        .filter(|&i| cells.edges()[i].abs().max(cells.edges()[i + 1].abs()) < 0.9 * half_width)
        .map(|i| (pressure[i] - exact[i]).abs() / scale)
        .fold(0.0, f64::max)
}

fn flat_error(count: usize, friction: f64) -> Fallible<f64> {
    let cells = Cells::graded(HALF_WIDTH, count)?;
    let signed_exponent = friction.signum() * friction_exponent(friction.abs(), NU);
    let exact = FlatPunch { load: LOAD, half_width: HALF_WIDTH, signed_exponent };
    let computed = pressure(&cells, friction, &vec![0.0; count])?;
    Ok(largest_error(&cells, &computed, |x| exact.carried(x), HALF_WIDTH, LOAD / (2.0 * HALF_WIDTH)))
}

/// Hertz contact over the fraction `share` of the zone.
fn hertz_error(count: usize, share: f64) -> Fallible<f64> {
    let cells = Cells::graded(HALF_WIDTH, count)?;
    let modulus = 200e9 / (1.0 - NU * NU);
    let radius = (share * HALF_WIDTH).powi(2) * std::f64::consts::PI * modulus / (4.0 * LOAD);
    let exact = HertzLine::new(LOAD, radius, modulus);
    let computed = pressure(&cells, 0.0, &cells.means_from_primitive(|x| x.powi(3) / (6.0 * radius)))?;
    Ok(largest_error(&cells, &computed, |x| exact.carried(x), exact.half_width, exact.pressure(0.0)))
}

type Error = fn(usize) -> Fallible<f64>;

fn punches(all: &mut Vec<Problem>) {
    let cases: [(&str, Error); 4] = [
        ("flat rigid punch on a half-plane", |count| flat_error(count, 0.0)),
        ("flat rigid punch sliding in +x, mu = .5, nu = .3", |count| flat_error(count, 0.5)),
        ("flat rigid punch sliding in -x, mu = .5, nu = .3", |count| flat_error(count, -0.5)),
        ("Hertz contact over .99 of the zone", |count| hertz_error(count, 0.99)),
    ];
    for (name, error) in cases {
        all.push(deviation(
            format!("{name}, 65 cells"),
            "largest error of the pressure's cell means at |x| < .9 a, over the mean pressure",
            move || error(65),
            1e-3,
            "second order in the cells away from the edges",
        ));
        all.push(Problem {
            name: format!("{name}, 33 to 257 cells"),
            quantity: "order of convergence, 1",
            exact: known(2.0),
            scale: None,
            compute: Box::new(move || Ok((error(33)? / error(257)?).log2() / 3.0)),
            bound: 0.1,
            reason: "not every cell number puts a cell's edge at .9 a",
        });
    }
    all.push(deviation(
        "Hertz contact over .8 of the zone, 65 cells".into(),
        "largest error of the pressure's cell means at |x| < .9 of the contact, over the peak",
        || hertz_error(65, 0.8),
        1e-3,
        "the contact's edge lies anywhere in a cell",
    ));
    all.push(Problem {
        name: "flat rigid punch sliding in +x, resultant".into(),
        quantity: "eccentricity over the half-width, 1",
        exact: Box::new(|| Ok(-2.0 * friction_exponent(0.5, NU))),
        scale: None,
        compute: Box::new(|| {
            let cells = Cells::graded(1.0, 65)?;
            let computed = pressure(&cells, 0.5, &[0.0; 65])?;
            Ok(cells.moment(&computed) / LOAD)
        }),
        bound: 1e-3,
        reason: "second order in 65 cells",
    });
}

/// Strain energy under a smooth load against the finest mesh: exponential in the order from 5 layers on.
fn block_energy(all: &mut Vec<Problem>) {
    let energy = |order: usize, layers: usize| -> Fallible<f64> {
        let properties = BlockProperties { width: 2.0, height: 2.0, youngs_modulus: 1.0, poissons_ratio: NU };
        let block = Block::new(properties, Discretization::uniform(order, layers))?;
        Ok(block.strain_energy(|x| (1.0 + 0.5 * x) * (0.7 * x).cos())?)
    };
    for (order, bound) in [(4, 1e-4), (6, 3e-6), (8, 1e-7)] {
        all.push(Problem {
            name: format!("elastic block under a smooth load, order {order} and 6 layers"),
            quantity: "strain energy per depth, J/m",
            exact: Box::new(move || energy(11, 9)),
            scale: None,
            compute: Box::new(move || energy(order, 6)),
            bound,
            reason: "falls exponentially with the order on a mesh graded to the corners; exact: order 11, 9 layers",
        });
    }
}
