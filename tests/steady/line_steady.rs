//! Direct steady states against time stepping, and as minima of their functionals. Closed forms of the half-plane, the annulus and the
//! rotating punch are problems of `verification`.

use contact::wear::line::{CellRate, Conditions, Direction, WearingContact};
use contact::{ContactState, Normal, Tilt, pair_operators};
use elasticity::{Base, Cells, Compliance, ElasticBody, Extent, HalfPlane, Material, Rigid, Strip, Winkler};
use steady::{CycleProblem, ReciprocatingProblem, SteadyError, groove, punch_run_in};
use verification::integrator::{Integrator, Scheme};

const LOAD: f64 = 2.0;

/// E* = 1.
fn half_plane(cells: &Cells) -> Compliance {
    HalfPlane { material: Material::new(0.91, 0.3).unwrap() }.compliance(cells)
}

fn layer(cells: &Cells) -> Compliance {
    let material = Material::new(0.91, 0.3).unwrap();
    Strip::new(material, 0.8, Base::Bonded, Extent::Straight).unwrap().compliance(cells)
}

fn power_rate(exponent: f64) -> CellRate {
    CellRate::uniform(1.0, 1.0, exponent)
}

/// Reciprocating sliding with a vanishing wear per stroke.
fn reciprocating<'a>(
    cells: &'a Cells,
    [punch, strip]: [&'a Compliance; 2],
    friction: f64,
    pivot_height: Option<f64>,
) -> ReciprocatingProblem<'a> {
    ReciprocatingProblem { cells, punch, strip, friction, load: LOAD, pivot_height, wear_per_stroke: 0.0 }
}

/// The shape of a cycle alone, put into the contact, gives its pressures forward and backward. A punch that cannot rotate keeps the tilt
/// of the shape's gauge, here none.
fn assert_pressures(problem: &ReciprocatingProblem, shape: &[f64], pressures: [&Vec<f64>; 2], case: &str) {
    let ReciprocatingProblem { cells, punch, strip, friction, pivot_height, .. } = *problem;
    let (normal, shear) = pair_operators(punch, strip);
    let mut contact = WearingContact::new(cells, cells.widths(), normal, shear, vec![0.0; cells.count()]).unwrap();
    for (direction, expected) in [Direction::Forward, Direction::Backward].into_iter().zip(pressures) {
        let signed_friction = direction.signed_friction(friction);
        let tilt = pivot_height.map_or(Tilt::Fixed(0.0), |h| Tilt::ResultantAt(signed_friction * h));
        let rate = CellRate::archard(0.0, 0.0);
        let conditions = Conditions { signed_friction, normal: Normal::Load(LOAD), tilt, rate };
        let state = contact.pressure(shape, &conditions).unwrap();
        for (computed, expected) in state.pressure.iter().zip(expected) {
            assert!((computed - expected).abs() < 1e-9, "{case} {direction:?}: {computed} {expected}");
        }
    }
}

/// One step, returning the state at its end.
fn step_once(
    integrator: &mut Integrator,
    contact: &mut WearingContact,
    worn: &mut [f64],
    length: f64,
    conditions: &Conditions,
) -> ContactState {
    let mut state = ContactState::new(worn.len());
    integrator.step(contact, worn, 0.0, length, &mut |_, c| c.clone_from(conditions), &mut state).unwrap();
    state
}

#[test]
fn direct_cycle_equals_time_stepping() {
    // Implicit Euler, one step per half-stroke, to convergence; k half-stroke = 0.7 of the compliance's scale.
    let cells = Cells::graded(1.0, 33).unwrap();
    let (punch, friction, wear_per_stroke) = (Rigid.compliance(&cells), 0.3, 0.7);
    for strip in [half_plane(&cells), layer(&cells)] {
        for pivot_height in [None, Some(1.1)] {
            let problem = ReciprocatingProblem {
                wear_per_stroke,
                ..reciprocating(&cells, [&punch, &strip], friction, pivot_height)
            };
            let direct = problem.solve().unwrap();
            let (normal, shear) = pair_operators(&punch, &strip);
            let mut contact = WearingContact::new(&cells, cells.widths(), normal, shear, vec![0.0; 33]).unwrap();
            let mut integrator = Integrator::new(Scheme::ImplicitEuler, cells.count());
            let mut worn = vec![0.0; 33];
            let mut half_stroke = |worn: &mut Vec<f64>, direction: Direction| {
                let sign = if direction == Direction::Forward { 1.0 } else { -1.0 };
                let tilt = pivot_height.map_or(Tilt::Fixed(0.0), |h| Tilt::ResultantAt(sign * friction * h));
                let rate = CellRate::archard(wear_per_stroke, 1.0);
                let signed_friction = direction.signed_friction(friction);
                let conditions = Conditions { signed_friction, normal: Normal::Load(LOAD), tilt, rate };
                let before = worn.clone();
                let state = step_once(&mut integrator, &mut contact, worn, 1.0, &conditions);
                let mean: Vec<f64> = worn.iter().zip(&before).map(|(a, b)| (a - b) / wear_per_stroke).collect();
                (state, mean)
            };
            let (mut forward, mut backward) = (Vec::new(), Vec::new());
            let mut jump = 0.0;
            for _ in 0..400 {
                let (state, mean) = half_stroke(&mut worn, Direction::Forward);
                (forward, jump) = (mean, state.approach);
                let (state, mean) = half_stroke(&mut worn, Direction::Backward);
                backward = mean;
                jump -= state.approach;
            }
            for i in 0..33 {
                let error = (forward[i] - direct.forward[i]).abs().max((backward[i] - direct.backward[i]).abs());
                assert!(error < 1e-8, "pivot {pivot_height:?} cell {i}: {error:e}");
                assert!((forward[i] + backward[i] - 2.0).abs() < 1e-10, "half-stroke means at cell {i}");
            }
            // Forward stands below what backward reaches by the jump, less the half-stroke's sinking k u pm.
            assert!((jump + wear_per_stroke - direct.approach_jump).abs() < 1e-7, "{jump} {}", direct.approach_jump);
        }
    }
}

#[test]
fn unidirectional_equals_time_stepping() {
    let cells = Cells::graded(1.0, 33).unwrap();
    for exponent in [0.3, 0.6, 1.0, 1.7, 3.0] {
        let rate = power_rate(exponent);
        let tilt = Tilt::ResultantAt(0.15);
        let direct = punch_run_in(&cells, cells.widths(), &rate, LOAD, tilt).unwrap();
        let (normal, shear) = pair_operators(&Rigid.compliance(&cells), &layer(&cells));
        let gap: Vec<f64> = cells.centres().iter().map(|x| 0.1 * x * x).collect();
        let mut contact = WearingContact::new(&cells, cells.widths(), normal, shear, gap.clone()).unwrap();
        let conditions = Conditions { signed_friction: 0.2, normal: Normal::Load(LOAD), tilt, rate };
        let mut integrator = Integrator::new(Scheme::ImplicitEuler, cells.count());
        let mut worn = vec![0.0; 33];
        for step in 0..60 {
            let length = 0.1 * 1.2f64.powi(step);
            step_once(&mut integrator, &mut contact, &mut worn, length, &conditions);
        }
        let stepped = contact.pressure(&worn, &conditions).unwrap();
        // The direct shape, put into the contact, gives the direct pressure.
        let shape = direct.shape(&gap, &contact.compliance(0.2));
        let on_shape = contact.pressure(&shape, &conditions).unwrap();
        for i in 0..33 {
            let error = (stepped.pressure[i] - direct.pressure[i]).abs();
            assert!(error < 1e-8, "b {exponent} cell {i}: {error:e}");
            assert!((on_shape.pressure[i] - direct.pressure[i]).abs() < 1e-9, "b {exponent} cell {i}");
        }
    }
}

#[test]
fn groove_on_a_winkler_foundation() {
    // p/k_w + integral_x^a k p^b = delta: dp/dx = k_w k p^b, forward; mirrored backward.
    let cells = Cells::graded(1.0, 129).unwrap();
    let winkler = Winkler::new(2.0).unwrap().compliance(&cells).normal;
    for exponent in [0.5, 1.0, 2.0] {
        let rate = CellRate::uniform(1.0, 0.3, exponent);
        for direction in [Direction::Forward, Direction::Backward] {
            let gap = vec![0.0; 129];
            let load = Normal::Load(1.0);
            let state = groove(&cells, winkler.clone(), &gap, rate.clone(), direction, load, Tilt::Fixed(0.0)).unwrap();
            let sign = if direction == Direction::Forward { 1.0 } else { -1.0 };
            // From the pressure at the centre: p^(1-b) = p(0)^(1-b) + (1-b) k_w k x, or the exponential.
            let centre = cells.point_value(&state.pressure, 0.0);
            for x in [-0.9, -0.3, 0.4, 0.95] {
                let exact = if exponent == 1.0 {
                    centre * f64::exp(0.6 * sign * x)
                } else {
                    let power = 1.0 - exponent;
                    (centre.powf(power) + power * 0.6 * sign * x).powf(1.0 / power)
                };
                let error = cells.point_value(&state.pressure, x) / exact - 1.0;
                assert!(error.abs() < 1e-4, "b {exponent} {direction:?} x {x}: {error:e}");
            }
            assert!((cells.integral(&state.pressure) - 1.0).abs() < 1e-10);
        }
    }
}

#[test]
fn states_that_do_not_exist_are_refused() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let (punch, strip) = (Rigid.compliance(&cells), half_plane(&cells));
    let problem = |friction, pivot_height| reciprocating(&cells, [&punch, &strip], friction, pivot_height);
    for height in [1.0, 1.5] {
        let refused = problem(0.5, Some(height)).solve().unwrap_err();
        assert_eq!(refused, SteadyError::RocksItselfRound { lever: 0.5 * height, limit: 0.5, exponent: 1.0 });
    }
    let message = problem(0.5, Some(1.2)).solve().unwrap_err().to_string();
    assert!(message.contains("mu H = 0.6 m is not below 0.5 m"), "{message}");
    // Just below the limit it exists: nearly all of the contact is clipped.
    let cycle = problem(0.5, Some(0.99)).solve().unwrap();
    assert!(cycle.forward.iter().filter(|p| **p == 0.0).count() > 10);
    let lifted = punch_run_in(&cells, cells.widths(), &power_rate(1.0), LOAD, Tilt::ResultantAt(1.0));
    let message = lifted.unwrap_err().to_string();
    assert!(message.contains("the punch tips over, mu H = 1 m is not below 0.997"), "{message}");
    let nothing = punch_run_in(&cells, cells.widths(), &CellRate::archard(0.0, 1.0), LOAD, Tilt::Fixed(0.0));
    assert_eq!(nothing, Err(SteadyError::NothingWears));
    for load in [0.0, -1.0, f64::NAN] {
        assert!(matches!(
            ReciprocatingProblem { load, ..problem(0.2, None) }.solve(),
            Err(SteadyError::Invalid { quantity: "load", .. })
        ));
    }
}

fn cycle_problem<'a>(
    cells: &'a Cells,
    bodies: [&'a Compliance; 2],
    rate: &'a CellRate,
    pivot_height: Option<f64>,
    durations: [f64; 2],
) -> CycleProblem<'a> {
    let [punch, strip] = bodies;
    CycleProblem { cells, punch, strip, friction: [0.3; 2], load: LOAD, pivot_height, rate, durations }
}

#[test]
fn general_cycle_is_the_programme_for_the_archard_law() {
    let cells = Cells::graded(1.0, 65).unwrap();
    let (punch, strip, rate) = (Rigid.compliance(&cells), layer(&cells), power_rate(1.0));
    for pivot_height in [None, Some(0.5), Some(1.4)] {
        let cycle = cycle_problem(&cells, [&punch, &strip], &rate, pivot_height, [1.0; 2]).solve().unwrap();
        let problem = reciprocating(&cells, [&punch, &strip], 0.3, pivot_height);
        let programme = problem.solve().unwrap();
        for i in 0..65 {
            assert!((cycle.forward[i] - programme.forward[i]).abs() < 1e-10, "{pivot_height:?} cell {i}");
            assert!((cycle.shape[i] - programme.shape[i]).abs() < 1e-10, "{pivot_height:?} cell {i}");
        }
        assert!((cycle.approach_jump - programme.approach_jump).abs() < 1e-10);
        assert!((cycle.tilt_jump - programme.tilt_jump).abs() < 1e-10);
    }
}

#[test]
fn general_cycles_wear_evenly_and_give_their_pressures() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let (punch, strip) = (Rigid.compliance(&cells), layer(&cells));
    for exponent in [0.3, 0.5, 0.8, 1.0, 1.5, 3.0] {
        let rate = power_rate(exponent);
        for (pivot_height, durations) in [
            (None, [1.0, 1.0]),
            (None, [1.0, 0.3]),
            (Some(0.5), [1.0, 1.0]),
            (Some(1.2), [1.0, 1.0]),
            (Some(0.6), [1.0, 2.0]),
        ] {
            let case = format!("b {exponent} pivot {pivot_height:?} durations {durations:?}");
            let cycle = cycle_problem(&cells, [&punch, &strip], &rate, pivot_height, durations)
                .solve()
                .unwrap_or_else(|error| panic!("{case}: {error}"));
            for (i, x) in cells.centres().iter().enumerate() {
                let depth =
                    durations[0] * rate.rate(i, cycle.forward[i]) + durations[1] * rate.rate(i, cycle.backward[i]);
                let rigid = cycle.sinking + cycle.tilting * x;
                assert!((depth / rigid - 1.0).abs() < 1e-9, "{case} cell {i}: {depth} {rigid}");
            }
            // Clipped edges included.
            let problem = reciprocating(&cells, [&punch, &strip], 0.3, pivot_height);
            assert_pressures(&problem, &cycle.shape, [&cycle.forward, &cycle.backward], &case);
        }
    }
}
