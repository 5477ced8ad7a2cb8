//! Wear of the contact line against closed forms: Winkler, Galin, cylinder, annulus, rotating punch.

use contact::wear::line::{CellRate, Coefficient, Conditions, WearTerm, WearingContact, explicit_limit};
use contact::{ContactSolver, ContactState, Normal, Tilt, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid, Winkler};
use exact::{
    GalinRelaxation, annular_pressure, unidirectional_rotating_pressure, winkler_relaxation_rate,
    worn_cylinder_half_width,
};
use test_support::Random;
use verification::integrator::{Integrator, Report, Scheme, StepError};

/// E* = 1 and a = 1, k = 1: time is the tau of the exact solution.
fn unit_half_plane() -> HalfPlane {
    HalfPlane { material: Material::new(0.91, 0.3).unwrap() }
}

/// A rigid punch on a body. The shear coupling includes the friction coefficient; the conditions supply its sign.
fn contact(cells: &Cells, body: &dyn ElasticBody, friction: f64, gap: Vec<f64>) -> WearingContact {
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), &body.compliance(cells));
    WearingContact::new(cells, cells.widths(), normal, shear * friction, gap).unwrap()
}

/// One step, returning the state at its end.
fn step_once(
    integrator: &mut Integrator,
    contact: &mut WearingContact,
    worn: &mut [f64],
    [time, length]: [f64; 2],
    conditions: &dyn Fn(f64) -> Conditions,
) -> Result<ContactState, StepError> {
    let mut state = ContactState::new(worn.len());
    integrator.step(contact, worn, time, length, &mut |t, c| *c = conditions(t), &mut state)?;
    Ok(state)
}

/// Steps chosen by the error control, returning the state at the end.
fn advance(
    integrator: &mut Integrator,
    contact: &mut WearingContact,
    worn: &mut [f64],
    [time, duration]: [f64; 2],
    conditions: &dyn Fn(f64) -> Conditions,
) -> (ContactState, Report) {
    let mut state = ContactState::new(worn.len());
    let report = integrator.advance(contact, worn, time, duration, &mut |t, c| *c = conditions(t), &mut state).unwrap();
    (state, report)
}

fn unidirectional(load: f64, tilt: Tilt, rate: CellRate) -> Conditions {
    Conditions { signed_friction: 1.0, normal: Normal::Load(load), tilt, rate }
}

fn power_rate(exponent: f64) -> CellRate {
    CellRate::uniform(1.0, 1.0, exponent)
}

#[test]
fn winkler_decay_at_second_order() {
    // A tilted wavy shape in full contact, p - pm decays as exp(-k_w k s).
    let cells = Cells::graded(1.0, 17).unwrap();
    let gap: Vec<f64> = cells.centres().iter().map(|x| 0.2 * (3.0 * x).sin()).collect();
    let conditions = unidirectional(2.0, Tilt::Fixed(0.0), CellRate::archard(1.0, 1.0));
    let rate = winkler_relaxation_rate(2.0, 1.0, 1.0, 1.0);
    let error = |scheme: Scheme, steps: usize| {
        let mut contact = contact(&cells, &Winkler::new(2.0).unwrap(), 0.0, gap.clone());
        let start = contact.pressure(&[0.0; 17], &conditions).unwrap().pressure;
        let mut worn = vec![0.0; 17];
        let mut integrator = Integrator::new(scheme, 1.0, cells.count());
        let mut end = start.clone();
        for step in 0..steps {
            let length = 1.0 / steps as f64;
            end = step_once(&mut integrator, &mut contact, &mut worn, [step as f64 * length, length], &|_| {
                conditions.clone()
            })
            .unwrap()
            .pressure;
        }
        (0..17).map(|i| (end[i] - 1.0 - (start[i] - 1.0) * (-rate).exp()).abs()).fold(0.0, f64::max)
    };
    for (scheme, order) in [(Scheme::Sdirk2, 2.0), (Scheme::ImplicitEuler, 1.0), (Scheme::ExplicitEuler, 1.0)] {
        let (coarse, fine) = (error(scheme, 40), error(scheme, 80));
        let slope = (coarse / fine).log2();
        println!("Winkler, {scheme:?}: {coarse:e} {fine:e}, order {slope:.3}");
        assert!((slope - order).abs() < 0.1 && fine < 1e-2, "{scheme:?}: {coarse:e} {fine:e} {slope}");
    }
}

#[test]
fn winkler_small_deviations_decay_at_the_linearised_rate() {
    let cells = Cells::graded(1.0, 9).unwrap();
    for exponent in [0.3, 0.7, 1.0, 1.6, 3.0] {
        let mean: f64 = 4.0;
        let gap: Vec<f64> = cells.centres().iter().map(|x| 1e-5 * x).collect();
        let conditions = unidirectional(2.0 * mean, Tilt::Fixed(0.0), power_rate(exponent));
        let mut contact = contact(&cells, &Winkler::new(2.0).unwrap(), 0.0, gap);
        let start = contact.pressure(&[0.0; 9], &conditions).unwrap().pressure;
        let rate = winkler_relaxation_rate(2.0, 1.0, exponent, mean);
        let mut worn = vec![0.0; 9];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1e-9, 9);
        let end = advance(&mut integrator, &mut contact, &mut worn, [0.0, 1.0 / rate], &|_| conditions.clone()).0;
        let ratio = (end.pressure[8] - mean) / (start[8] - mean);
        assert!((ratio / (-1.0f64).exp() - 1.0).abs() < 2e-4, "b {exponent}: {ratio}");
    }
}

#[test]
fn galin_relaxation() {
    let galin = GalinRelaxation::new(150);
    for (count, bound) in [(64, 1e-3), (256, 1e-4)] {
        let cells = Cells::graded(1.0, count).unwrap();
        let conditions = unidirectional(2.0, Tilt::Fixed(0.0), CellRate::archard(1.0, 1.0));
        let mut contact = contact(&cells, &unit_half_plane(), 0.0, vec![0.0; count]);
        let mut worn = vec![0.0; count];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 0.02 * bound, cells.count());
        let (mut time, mut steps) = (0.0, 0);
        let mut largest: [f64; 3] = [0.0; 3];
        for end in [0.1, 0.5, 1.0, 3.0] {
            let (state, report) =
                advance(&mut integrator, &mut contact, &mut worn, [time, end - time], &|_| conditions.clone());
            time = end;
            steps += report.steps;
            for (k, x) in [0.0, 0.5, 0.9].into_iter().enumerate() {
                let computed = cells.point_value(&state.pressure, x);
                largest[k] = largest[k].max((computed - galin.pressure(end, x)).abs());
            }
        }
        println!("Galin N {count}: {largest:?} in {steps} steps, {:?}", contact.counter());
        assert!(largest[0].max(largest[1]) < bound && largest[2] < 5.0 * bound, "N {count}: {largest:?}");
        // b = 1: the worn area is k P s whatever the step.
        assert!((cells.integral(&worn) / 6.0 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn galin_eigenvalues() {
    // Eigenvalues of C on the zero-mean space, from the steps' own compliance: C phi = Lambda phi + constant.
    let exact = GalinRelaxation::new(60).eigenvalues(3);
    for (count, bound) in [(64, 5e-3), (256, 3e-4)] {
        let cells = Cells::graded(1.0, count).unwrap();
        let normal = unit_half_plane().compliance(&cells).normal;
        let root: Vec<f64> = cells.widths().iter().map(|c| (c / 2.0).sqrt()).collect();
        let mut matrix = nalgebra::DMatrix::from_fn(count, count, |i, j| normal[(i, j)] * root[i] / root[j]);
        // Projection on the complement of the unit vector `root`.
        let unit = nalgebra::DVector::from_column_slice(&root);
        let image = &matrix * &unit;
        let energy = unit.dot(&image);
        matrix -= &image * unit.transpose() + &unit * image.transpose();
        matrix += &unit * unit.transpose() * energy;
        let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let errors: Vec<f64> = (0..3).map(|i| (values[i] / exact[i] - 1.0).abs()).collect();
        println!("Galin eigenvalues N {count}: {errors:?}");
        assert!(errors.iter().all(|e| *e < bound), "N {count}: {errors:?}");
    }
}

#[test]
fn explicit_bound_on_uniform_cells() {
    let count = 100;
    let cells = Cells::uniform(1.0, count).unwrap();
    let conditions = unidirectional(200.0, Tilt::Fixed(0.0), CellRate::archard(1.0, 1.0));
    let fresh = || contact(&cells, &unit_half_plane(), 0.0, vec![0.0; count]);
    let start = fresh().pressure(&vec![0.0; count], &conditions).unwrap();
    let limit = explicit_limit(&mut fresh(), &conditions, &start.pressure);
    let factor = limit / 0.02;
    println!("explicit limit: {factor} c/E*");
    assert!((factor - 1.0855).abs() < 1e-3, "{factor}");
    // The least damped mode (a sawtooth), stepped explicitly beyond the bound to show the instability that refusal prevents.
    let deviation = |share: f64, steps: usize| {
        let mut contact = fresh();
        let mut worn: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { 1e-3 } else { -1e-3 }).collect();
        let mut last = 0.0;
        for _ in 0..steps {
            let pressure = contact.pressure(&worn, &conditions).unwrap().pressure;
            for (w, p) in worn.iter_mut().zip(&pressure) {
                *w += share * limit * p;
            }
            last = (0..count - 1).map(|i| (pressure[i + 1] - pressure[i]).abs()).fold(0.0, f64::max);
        }
        last
    };
    assert!(deviation(0.98, 400) < 0.01 * deviation(0.98, 1));
    assert!(deviation(1.02, 400) > 100.0 * deviation(1.02, 1).min(1.0), "{}", deviation(1.02, 400));
    let mut integrator = Integrator::new(Scheme::ExplicitEuler, 1.0, cells.count());
    let mut worn = vec![0.0; count];
    let too_long = step_once(&mut integrator, &mut fresh(), &mut worn, [0.0, 1.02 * limit], &|_| conditions.clone());
    assert!(matches!(too_long, Err(StepError::Unstable { .. })));
    assert_eq!(worn, vec![0.0; count]);
    assert!(step_once(&mut integrator, &mut fresh(), &mut worn, [0.0, 0.98 * limit], &|_| conditions.clone()).is_ok());
}

#[test]
fn explicit_bound_on_a_winkler_foundation() {
    let cells = Cells::graded(1.0, 12).unwrap();
    let mut contact = contact(&cells, &Winkler::new(4.0).unwrap(), 0.0, vec![0.0; 12]);
    let conditions = unidirectional(2.0, Tilt::ResultantAt(0.2), CellRate::archard(1.0, 1.0));
    let limit = explicit_limit(&mut contact, &conditions, &[1.0; 12]);
    assert!((limit - 0.5).abs() < 1e-12, "{limit}");
}

#[test]
fn steps_of_any_length_end_in_uniform_wear() {
    // 10,000 times the explicit limit and more, exponents from .3 to 3, friction, edges that unload.
    let cells = Cells::graded(1.0, 33).unwrap();
    for exponent in [0.3, 0.5, 1.0, 2.0, 3.0] {
        let conditions = unidirectional(2.0, Tilt::Fixed(0.0), power_rate(exponent));
        let gap: Vec<f64> = cells.centres().iter().map(|x| 3.0 * x * x).collect();
        let mut contact = contact(&cells, &unit_half_plane(), 0.5, gap);
        let mut worn = vec![0.0; 33];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1.0, cells.count());
        for _ in 0..12 {
            step_once(&mut integrator, &mut contact, &mut worn, [0.0, 1e4], &|_| conditions.clone()).unwrap();
        }
        let state = contact.pressure(&worn, &conditions).unwrap();
        let error = state.pressure.iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "b {exponent}: {error:e}");
    }
}

/// A parabola wears into contact while the load falls and rises: cells enter and leave.
struct EdgesLifting {
    cells: Cells,
    gap: Vec<f64>,
    exponent: f64,
}

impl EdgesLifting {
    const DURATION: f64 = 2.0;

    fn new(exponent: f64) -> Self {
        let cells = Cells::graded(1.0, 33).unwrap();
        let gap = cells.centres().iter().map(|x| x * x).collect();
        Self { cells, gap, exponent }
    }

    fn conditions(&self, time: f64) -> Conditions {
        let load = 0.5 * (1.0 + 0.8 * (4.0 * time).sin());
        unidirectional(load, Tilt::Fixed(0.0), power_rate(self.exponent))
    }

    fn contact(&self) -> WearingContact {
        contact(&self.cells, &unit_half_plane(), 0.3, self.gap.clone())
    }

    /// Worn depth at the end after equal steps.
    fn equal_steps(&self, steps: usize) -> Vec<f64> {
        let (mut contact, mut worn) = (self.contact(), vec![0.0; 33]);
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1.0, 33);
        let length = Self::DURATION / steps as f64;
        for step in 0..steps {
            let interval = [step as f64 * length, length];
            step_once(&mut integrator, &mut contact, &mut worn, interval, &|t| self.conditions(t)).unwrap();
        }
        worn
    }

    /// Worn depth at the end under error control, and the steps it took.
    fn controlled(&self, tolerance: f64) -> (Vec<f64>, usize) {
        let (mut contact, mut worn) = (self.contact(), vec![0.0; 33]);
        let mut integrator = Integrator::new(Scheme::Sdirk2, tolerance, 33);
        let interval = [0.0, Self::DURATION];
        let report = advance(&mut integrator, &mut contact, &mut worn, interval, &|t| self.conditions(t)).1;
        (worn, report.steps)
    }

    fn error(&self, worn: &[f64], truth: &[f64]) -> f64 {
        let square: Vec<f64> = worn.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).collect();
        self.cells.integral(&square).sqrt()
    }
}

#[test]
fn second_order_with_edges_lifting() {
    // Where a cell touches down or lifts off, its pressure begins or ends like time, its wear rate like the power b of
    // that. Step control follows that: as many steps, on average half as long, leave a quarter of the error.
    for exponent in [0.3, 0.5, 1.0, 2.0] {
        let problem = EdgesLifting::new(exponent);
        let (truth, _) = problem.controlled(1e-8);
        let at = |tolerance: f64| {
            let (worn, steps) = problem.controlled(tolerance);
            let error = problem.error(&worn, &truth);
            println!("b {exponent}, tolerance {tolerance:e}: error {error:e} in {steps} steps");
            (error, steps as f64)
        };
        let tolerances: Vec<f64> = (0..6).map(|k| 2.5e-3 * 0.25f64.powi(k)).collect();
        let results: Vec<(f64, f64)> = tolerances.into_iter().map(at).collect();
        let (few, many) = (results[0].1, results[5].1);
        // The slope of a straight line through all six: the error of one wavers with where events fall in its steps.
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| results.iter().map(f).sum::<f64>() / 6.0;
        let (steps, errors) = (mean(&|r| r.1.log2()), mean(&|r| r.0.log2()));
        let slope = -mean(&|r| (r.1.log2() - steps) * (r.0.log2() - errors)) / mean(&|r| (r.1.log2() - steps).powi(2));
        println!("order with edges lifting, b {exponent}: {slope:.3}");
        assert!(many > 16.0 * few && (1.8..2.2).contains(&slope), "b {exponent}: {slope}");
    }
}

#[test]
fn equal_steps_with_edges_lifting() {
    // Without control the beginning like a power b of time costs the order 1 + b, where that is less than 2.
    for exponent in [0.3, 0.5, 1.0, 2.0] {
        let problem = EdgesLifting::new(exponent);
        let (truth, _) = problem.controlled(1e-8);
        let error = |steps: usize| problem.error(&problem.equal_steps(steps), &truth);
        let (coarse, fine) = (error(16), error(512));
        let slope = (coarse / fine).log2() / 5.0;
        println!("equal steps with edges lifting, b {exponent}: {slope:.3} ({coarse:e} to {fine:e})");
        let expected = if exponent < 1.0 { 0.8 + exponent..2.2 } else { 1.8..2.3 };
        assert!(expected.contains(&slope), "b {exponent}: {slope} ({coarse:e} {fine:e})");
    }
}

#[test]
fn stages_satisfy_every_condition() {
    // Exponents, stage lengths over 16 decades, rough surfaces, both holders: the residual of the nonlinear problem.
    let cells = Cells::graded(1.0, 33).unwrap();
    let mut random = Random(1);
    for exponent in [0.3, 0.5, 1.0, 1.7, 3.0] {
        let mut contact = contact(&cells, &unit_half_plane(), 0.4, vec![0.0; 33]);
        for round in 0..40 {
            let tau = 10f64.powf(16.0 * random.next() - 8.0);
            let worn: Vec<f64> = (0..33).map(|_| 3.0 * random.next().powi(4)).collect();
            let load = 10f64.powf(4.0 * random.next() - 2.0);
            let tilt = if round % 2 == 0 { Tilt::Fixed(0.1) } else { Tilt::ResultantAt(0.4) };
            let conditions = unidirectional(load, tilt, power_rate(exponent));
            let state = contact.stage(&worn, tau, &conditions).unwrap();
            let pressure = nalgebra::DVector::from_column_slice(&state.pressure);
            let displacement = contact.compliance(1.0) * &pressure;
            let scale = state.approach.abs() + displacement.amax() + tau * load.powf(exponent);
            for i in 0..33 {
                let wear = tau * conditions.rate.rate(i, pressure[i]);
                let gap = worn[i] + wear + displacement[i] - state.approach - state.tilt * cells.centres()[i];
                assert!((gap - state.gap[i]).abs() < 1e-8 * scale, "b {exponent} tau {tau:e} cell {i}: {gap:e}");
                assert!(state.gap[i] >= 0.0 && pressure[i] >= 0.0 && state.gap[i] * pressure[i] == 0.0);
            }
            assert!((cells.integral(&state.pressure) / load - 1.0).abs() < 1e-9, "b {exponent} tau {tau:e}");
            if round % 2 == 1 {
                assert!((cells.moment(&state.pressure) / load - 0.4).abs() < 1e-9, "b {exponent} tau {tau:e}");
            }
        }
        println!("b {exponent}: {} Newton iterations in 40 stages", contact.newton_iterations());
    }
}

#[test]
fn tolerance_is_kept() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let conditions = unidirectional(2.0, Tilt::ResultantAt(0.1), power_rate(0.6));
    let run = |tolerance: f64| {
        let mut contact = contact(&cells, &unit_half_plane(), 0.2, vec![0.0; 33]);
        let mut worn = vec![0.0; 33];
        let mut integrator = Integrator::new(Scheme::Sdirk2, tolerance, cells.count());
        let (state, report) = advance(&mut integrator, &mut contact, &mut worn, [0.0, 1.0], &|_| conditions.clone());
        (state.pressure, report.steps)
    };
    let (truth, _) = run(1e-9);
    let mut previous = 0;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
        let (pressure, steps) = run(tolerance);
        let square: Vec<f64> = pressure.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).collect();
        let error = (cells.integral(&square) / 2.0).sqrt();
        println!("tolerance {tolerance:e}: error {error:e} in {steps} steps");
        assert!(error < 3.0 * tolerance && steps > previous, "{tolerance:e}: {error:e} in {steps} steps");
        previous = steps;
    }
}

#[test]
fn cylinder_wears_a_flat() {
    // Stiff half-plane: the contact follows the worn flat, a^3 = (3/2) k F' R s.
    let cells = Cells::graded(1.0, 129).unwrap();
    let count = cells.count();
    let stiff = HalfPlane { material: Material::new(1e6, 0.3).unwrap() };
    let gap = cells.means_from_primitive(|x| x.powi(3) / 6.0 / 2.0);
    let mut contact = contact(&cells, &stiff, 0.0, gap);
    let conditions = unidirectional(1.0, Tilt::Fixed(0.0), CellRate::archard(1.0, 1.0));
    let mut worn = vec![0.0; count];
    let mut integrator = Integrator::new(Scheme::Sdirk2, 1e-2, cells.count());
    let exact = worn_cylinder_half_width(1.0, 1.0, 2.0, 0.1);
    advance(&mut integrator, &mut contact, &mut worn, [0.0, 0.1], &|_| conditions.clone());
    // Worn depth of the flat's middle: a^2/(2R); the width from the sum of cells in contact is as coarse as a cell.
    let computed = (2.0 * 2.0 * cells.point_value(&worn, 0.0)).sqrt();
    println!("cylinder: a {computed} exact {exact}");
    assert!((computed / exact - 1.0).abs() < 1e-3, "{computed} {exact}");
}

#[test]
fn annular_punch_runs_in() {
    // Radius 1.5 + x, speed in proportion to it, load weighted with the area.
    let cells = Cells::graded(0.5, 33).unwrap();
    let relative: Vec<f64> = cells.centres().iter().map(|x| (1.5 + x) / 1.5).collect();
    let weights: Vec<f64> = cells.widths().iter().zip(&relative).map(|(c, r)| c * r).collect();
    let compliance = unit_half_plane().compliance(&cells).normal;
    for (a, b) in [(1.0, 1.0), (2.0, 1.0), (1.0, 0.5), (0.5, 1.5)] {
        let coefficient = relative.iter().map(|r: &f64| r.powf(a)).collect();
        let rate = CellRate {
            reference_pressure: 1.0,
            terms: vec![WearTerm { coefficient: Coefficient::PerCell(coefficient), exponent: b }],
        };
        let mut contact =
            WearingContact::new(&cells, &weights, compliance.clone(), &compliance * 0.0, vec![0.0; 33]).unwrap();
        let conditions = unidirectional(2.0, Tilt::Fixed(0.0), rate);
        let mut worn = vec![0.0; 33];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1.0, cells.count());
        for step in 0..60 {
            step_once(&mut integrator, &mut contact, &mut worn, [0.0, 0.1 * 1.3f64.powi(step)], &|_| {
                conditions.clone()
            })
            .unwrap();
        }
        let pressure = contact.pressure(&worn, &conditions).unwrap().pressure;
        for (x, p) in cells.centres().iter().zip(&pressure) {
            let error = p / annular_pressure(1.5 + x, 2.0, (1.0, 2.0), (a, b)) - 1.0;
            assert!(error.abs() < 2e-3, "a {a} b {b} x {x}: {error:e}");
        }
    }
}

#[test]
fn unidirectional_punch_free_to_rotate() {
    let cells = Cells::graded(0.5, 33).unwrap();
    for lever in [0.1, 1.0 / 6.0] {
        let mut contact = contact(&cells, &unit_half_plane(), 0.3, vec![0.0; 33]);
        let conditions = unidirectional(1.0, Tilt::ResultantAt(lever), CellRate::archard(1.0, 1.0));
        let mut worn = vec![0.0; 33];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1.0, cells.count());
        for step in 0..60 {
            step_once(&mut integrator, &mut contact, &mut worn, [0.0, 0.1 * 1.3f64.powi(step)], &|_| {
                conditions.clone()
            })
            .unwrap();
        }
        let state = contact.pressure(&worn, &conditions).unwrap();
        for (x, p) in cells.centres().iter().zip(&state.pressure) {
            let error = p - unidirectional_rotating_pressure(*x, lever, 1.0);
            // The moment is taken on cells of constant pressure: second order.
            assert!(error.abs() < 5e-3, "lever {lever} x {x}: {error:e}");
        }
    }
}

#[test]
fn a_load_of_zero_stops_the_wear() {
    let cells = Cells::graded(1.0, 9).unwrap();
    let mut contact = contact(&cells, &unit_half_plane(), 0.3, vec![0.0; 9]);
    for exponent in [0.3, 1.0, 3.0] {
        let conditions = unidirectional(0.0, Tilt::ResultantAt(0.1), power_rate(exponent));
        let mut worn = vec![1e-3; 9];
        let mut integrator = Integrator::new(Scheme::Sdirk2, 1e-3, 9);
        advance(&mut integrator, &mut contact, &mut worn, [0.0, 10.0], &|_| conditions.clone());
        assert_eq!(worn, vec![1e-3; 9]);
    }
    let mut solver = ContactSolver::new(&cells, contact.compliance(1.0)).unwrap();
    assert_eq!(solver.solve(&[0.0; 9], Normal::Load(0.0), Tilt::Fixed(0.0)).unwrap().pressure, [0.0; 9]);
}

/// A light load leaves displacements that are small compared with the gap. Rounding errors then make the active set cycle where a
/// cell is about to touch, however short the stage.
#[test]
fn light_loads_on_wide_gaps_are_solved_to_rounding() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let terms = [1.52, 0.88].map(|exponent| WearTerm { exponent, coefficient: Coefficient::Uniform(1.0) });
    let rate = CellRate { terms: terms.to_vec(), reference_pressure: 1.0 };
    for wide in [1e-3, 1e-1, 1.0] {
        let gap = cells.centres().iter().map(|x| wide + 1e-6 * (9.0 * x).sin()).collect();
        let mut contact = contact(&cells, &unit_half_plane(), 0.0, gap);
        let mut touching = |load: f64| {
            let conditions = unidirectional(load, Tilt::Fixed(0.0), rate.clone());
            let found = contact.stage(&[0.0; 33], 1e-12, &conditions).unwrap();
            let carried: f64 = found.pressure.iter().zip(cells.widths()).map(|(p, c)| p * c).sum();
            assert!((carried / load - 1.0).abs() < 1e-4, "{wide} {load:e}: {carried:e}");
            found.pressure.iter().filter(|p| **p > 0.0).count()
        };
        for load in [1e-7, 3e-7, 1e-6, 3e-6] {
            // The next cell touches somewhere between.
            let (mut low, mut high) = (load, 1.5 * load);
            let few = touching(low);
            while touching(high) <= few {
                high *= 1.5;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if touching(middle) > few {
                    high = middle;
                } else {
                    low = middle;
                }
            }
        }
    }
}
