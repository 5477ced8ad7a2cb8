use super::*;
use elasticity::{ElasticBody, HalfPlane, Material, Rigid};
use nalgebra::DVector;

fn steel() -> Material {
    Material::new(200e9, 0.3).unwrap()
}

fn half_plane(cells: &Cells, signed_friction: f64) -> DMatrix<f64> {
    let strip = HalfPlane { material: steel() }.compliance(cells);
    pair_compliance(&Rigid.compliance(cells), &strip, signed_friction)
}

/// Checks all conditions of the solution against the unscaled problem.
fn check(cells: &Cells, compliance: &DMatrix<f64>, gap: &[f64], state: &ContactState) {
    let pressure = DVector::from_column_slice(&state.pressure);
    let displacement = compliance * &pressure;
    let scale = displacement.amax() + state.approach.abs();
    for i in 0..cells.count() {
        let computed = gap[i] + displacement[i] - state.approach - state.tilt * cells.centres()[i];
        assert!((computed - state.gap[i]).abs() < 1e-10 * scale, "cell {i}: {computed:e} {:e}", state.gap[i]);
        assert!(state.gap[i] >= 0.0 && state.pressure[i] >= 0.0 && state.gap[i] * state.pressure[i] == 0.0);
    }
}

fn wavy(cells: &Cells, seed: u64, height: f64) -> Vec<f64> {
    let mut random = test_support::Random(seed);
    cells.centres().iter().map(|_| height * random.next()).collect()
}

#[test]
fn rough_surfaces_satisfy_every_condition() {
    for count in [1, 2, 9, 65] {
        let cells = Cells::graded(0.03, count).unwrap();
        let compliance = half_plane(&cells, 0.4);
        let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
        for seed in 0..20 {
            for height in [1e-7, 1e-5, 1e-3] {
                let gap = wavy(&cells, seed, height);
                let state = solver.solve(&gap, Normal::Load(1e6), Tilt::Fixed(1e-5)).unwrap();
                check(&cells, &compliance, &gap, &state);
                assert!((cells.integral(&state.pressure) / 1e6 - 1.0).abs() < 1e-10);
                if count > 2 {
                    let state = solver.solve(&gap, Normal::Load(1e6), Tilt::ResultantAt(0.01)).unwrap();
                    check(&cells, &compliance, &gap, &state);
                    assert!((cells.moment(&state.pressure) / 1e6 - 0.01).abs() < 1e-11);
                    // The same resultant, given as a moment about another point.
                    let tilt = Tilt::Moment { lever: -0.002, moment: 0.012 * 1e6 };
                    let again = solver.solve(&gap, Normal::Load(1e6), tilt).unwrap();
                    for i in 0..count {
                        assert!((again.pressure[i] - state.pressure[i]).abs() < 1e-9 * 1e6 / 0.06);
                    }
                }
            }
        }
    }
}

#[test]
fn pivoting_alone_finds_the_same_contact() {
    let cells = Cells::graded(0.03, 41).unwrap();
    for (normal, tilt) in [
        (Normal::Load(1e6), Tilt::Fixed(0.0)),
        (Normal::Load(1e6), Tilt::ResultantAt(-0.012)),
        (Normal::Approach(4e-6), Tilt::Fixed(1e-5)),
        (Normal::Approach(4e-6), Tilt::ResultantAt(0.0)),
        (Normal::Spring { load: 1e6, stiffness: 1e11 }, Tilt::Fixed(0.0)),
        (Normal::Load(1e6), Tilt::Moment { lever: 0.01, moment: -2e4 }),
    ] {
        let mut solver = ContactSolver::new(&cells, half_plane(&cells, -0.4)).unwrap();
        for seed in 0..10 {
            let gap = wavy(&cells, seed, 3e-6);
            solver.solve(&gap, normal, tilt).unwrap();
            let newton = solver.active.clone();
            let diagonal = vec![0.0; 41];
            let problem = ContactProblem { gap: &gap, signed_friction: 0.0, diagonal: &diagonal, normal, tilt };
            let balance = solver.balance(&problem).unwrap();
            let mut memory = solver.memory.clone();
            solver.pivot_active_set(&problem, &balance, &mut memory).unwrap();
            assert_eq!(memory.set, newton, "{normal:?} {tilt:?} {seed}");
        }
        assert_eq!(solver.counter().fallbacks, 0);
    }
}

#[test]
fn fallback_is_taken_when_the_sets_run_in_a_circle() {
    // A P-matrix on which the active-set iteration cycles through three sets (Murty); approach given, 3 cells.
    let cells = Cells::uniform(1.0, 3).unwrap();
    let compliance = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 2.0, 2.0, 1.0, 0.0, 0.0, 2.0, 1.0]);
    let mut cycles = 0;
    for start in 0..8 {
        let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
        solver.set_active(&[start & 1 != 0, start & 2 != 0, start & 4 != 0]);
        let state = solver.solve(&[0.0; 3], Normal::Approach(1.0), Tilt::Fixed(0.0)).unwrap();
        check(&cells, &compliance, &[0.0; 3], &state);
        assert!((state.pressure[0] - 1.0 / 3.0).abs() < 1e-14);
        let fallbacks = solver.counter().fallbacks;
        assert!(fallbacks <= 1, "{fallbacks} in one solution");
        cycles += fallbacks;
    }
    assert!(cycles > 0);
}

#[test]
fn unchanged_status_costs_one_back_substitution() {
    let cells = Cells::graded(0.03, 33).unwrap();
    let mut solver = ContactSolver::new(&cells, half_plane(&cells, 0.2)).unwrap();
    for step in 0..50 {
        let load = 1e6 * (1.0 + 0.3 * f64::from(step).sin());
        solver.solve(&[0.0; 33], Normal::Load(load), Tilt::Fixed(0.0)).unwrap();
    }
    let expected = WorkCounter { solves: 50, iterations: 50, factorisations: 1, fallbacks: 0, pivots: 0 };
    assert_eq!(solver.counter(), expected);
}

#[test]
fn touch_down_and_lift_off() {
    // A parabolic punch: from one cell in contact to all, and back to none.
    let cells = Cells::graded(0.03, 33).unwrap();
    let compliance = half_plane(&cells, 0.0);
    let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
    let gap: Vec<f64> = cells.centres().iter().map(|x| x * x / 2.0).collect();
    let mut in_contact = Vec::new();
    for load in [1e-3, 1e2, 1e4, 1e6, 1e8, 1e9, 1e10, 1e6, 1e-3] {
        let state = solver.solve(&gap, Normal::Load(load), Tilt::Fixed(0.0)).unwrap();
        check(&cells, &compliance, &gap, &state);
        in_contact.push(state.pressure.iter().filter(|p| **p > 0.0).count());
    }
    assert_eq!((in_contact[0], in_contact[8]), (1, 1));
    assert_eq!(in_contact[6], 33);
    assert_eq!(in_contact[3], in_contact[7]);
    assert!(in_contact[..7].windows(2).all(|w| w[0] <= w[1]), "{in_contact:?}");
    let state = solver.solve(&gap, Normal::Load(0.0), Tilt::Fixed(1e-3)).unwrap();
    assert_eq!(state.pressure, [0.0; 33]);
    assert_eq!(state.gap.iter().copied().fold(f64::INFINITY, f64::min), 0.0);
    assert!(solver.counter().iterations < 12 * solver.counter().solves, "{:?}", solver.counter());
}

#[test]
fn approach_load_and_spring_agree() {
    let cells = Cells::graded(0.03, 25).unwrap();
    let compliance = half_plane(&cells, 0.3);
    let mut solver = ContactSolver::new(&cells, compliance).unwrap();
    let gap: Vec<f64> = cells.centres().iter().map(|x| x * x / 20.0).collect();
    let by_load = solver.solve(&gap, Normal::Load(2e6), Tilt::ResultantAt(0.004)).unwrap();
    let by_approach = solver.solve(&gap, Normal::Approach(by_load.approach), Tilt::Fixed(by_load.tilt)).unwrap();
    let stiffness = 3e11;
    let spring = Normal::Spring { load: 2e6 + stiffness * by_load.approach, stiffness };
    let by_spring = solver.solve(&gap, spring, Tilt::ResultantAt(0.004)).unwrap();
    for i in 0..25 {
        assert!((by_approach.pressure[i] - by_load.pressure[i]).abs() < 1e-3);
        assert!((by_spring.pressure[i] - by_load.pressure[i]).abs() < 1e-3);
    }
    assert!((by_spring.approach / by_load.approach - 1.0).abs() < 1e-9);
    // A relaxed spring stays in place, out of contact.
    let apart = solver.solve(&gap, Normal::Spring { load: -6e5, stiffness }, Tilt::ResultantAt(0.004)).unwrap();
    assert_eq!((apart.pressure[12], apart.approach), (0.0, -2e-6));
}

#[test]
fn equal_bodies_have_no_shear_coupling() {
    // Friction acts on the punch against the direction in which it acts on the strip.
    let cells = Cells::graded(0.03, 9).unwrap();
    let (elastic, rigid) = (HalfPlane { material: steel() }.compliance(&cells), Rigid.compliance(&cells));
    assert_eq!(pair_compliance(&elastic, &elastic, 0.5), &elastic.normal * 2.0);
    assert_eq!(pair_compliance(&elastic, &rigid, 0.5), pair_compliance(&rigid, &elastic, -0.5));
    assert_eq!(pair_compliance(&rigid, &elastic, 0.5), &elastic.normal + &elastic.shear * 0.5);
}

#[test]
fn refusals_carry_the_numbers() {
    let cells = Cells::graded(0.03, 9).unwrap();
    let rigid = Rigid.compliance(&cells);
    assert_eq!(ContactSolver::new(&cells, rigid.normal).unwrap_err(), ContactError::Rigid);
    let mut rigid_cell = half_plane(&cells, 0.0);
    rigid_cell[(4, 4)] = 0.0;
    assert_eq!(ContactSolver::new(&cells, rigid_cell).unwrap_err(), ContactError::Rigid);
    let mut solver = ContactSolver::new(&cells, half_plane(&cells, 0.0)).unwrap();
    let gap = [0.0; 9];
    let message = solver.solve(&gap, Normal::Load(1.0), Tilt::ResultantAt(0.03)).unwrap_err().to_string();
    assert!(message.starts_with("the punch tips over: equilibrium needs the resultant at x = 0.03 m"), "{message}");
    for load in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            solver.solve(&gap, Normal::Load(load), Tilt::Fixed(0.0)),
            Err(ContactError::Invalid { quantity: "load", .. })
        ));
    }
    assert!(solver.solve(&[f64::NAN; 9], Normal::Load(1.0), Tilt::Fixed(0.0)).is_err());
    // Bodies that overlap so far that the pressure exceeds the range of numbers.
    assert!(solver.solve(&[-1e300; 9], Normal::Approach(0.0), Tilt::Fixed(0.0)).is_err());
}

/// Half-plane under a parabolic punch, contact partial, solved for one friction coefficient.
fn parabolic(solver: &mut ContactSolver, cells: &Cells, friction: f64, wear: f64, active: &mut [bool]) -> ContactState {
    let gap: Vec<f64> = cells.centres().iter().map(|x| x * x / 2.0).collect();
    let diagonal = vec![wear; cells.count()];
    let (normal, tilt) = (Normal::Load(1e8), Tilt::ResultantAt(0.01 * friction));
    let problem = ContactProblem { gap: &gap, signed_friction: friction, diagonal: &diagonal, normal, tilt };
    let mut state = ContactState::new(cells.count());
    solver.solve_into(&problem, active, &mut state).unwrap();
    state
}

#[test]
fn kept_factors_change_nothing_but_the_time() {
    let cells = Cells::graded(0.03, 33).unwrap();
    let strip = HalfPlane { material: steel() }.compliance(&cells);
    let (normal, shear) = pair_operators(&Rigid.compliance(&cells), &strip);
    let fresh = || ContactSolver::with_operators(&cells, cells.widths(), normal.clone(), shear.clone()).unwrap();
    let mut solver = fresh();
    // Friction and wear values that recur after longer and shorter intervals, more of them than are cached.
    for round in 0..200_u32 {
        let friction = 0.2 * f64::from(round % 4) - 0.3;
        let wear = 1e-12 * f64::from(round * round % 5);
        let start: Vec<bool> = (0..33).map(|i| !(i + round as usize / 50).is_multiple_of(3)).collect();
        let (mut active, mut again) = (start.clone(), start);
        let kept = parabolic(&mut solver, &cells, friction, wear, &mut active);
        let alone = parabolic(&mut fresh(), &cells, friction, wear, &mut again);
        assert_eq!((kept, active), (alone, again), "round {round}");
    }
    assert!(solver.counter().factorisations < solver.counter().iterations);
}

#[test]
fn an_extra_compliance_adds_to_that_of_the_bodies() {
    let cells = Cells::graded(0.03, 17).unwrap();
    let compliance = half_plane(&cells, 0.2);
    let added_compliance =
        DMatrix::from_fn(17, 17, |i, j| 1e-12 * f64::from(u8::from(i == j)) + 1e-14 * (i as f64 - j as f64));
    let gap = wavy(&cells, 3, 1e-6);
    let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
    let before = solver.solve(&gap, Normal::Load(1e5), Tilt::Fixed(0.0)).unwrap();
    solver.set_added_compliance(Some(&added_compliance)).unwrap();
    let with = solver.solve(&gap, Normal::Load(1e5), Tilt::Fixed(0.0)).unwrap();
    check(&cells, &(&compliance + &added_compliance), &gap, &with);
    assert!((0..17).any(|i| (with.pressure[i] / before.pressure[i] - 1.0).abs() > 1e-3));
    solver.set_added_compliance(None).unwrap();
    solver.set_active(&[true; 17]);
    assert_eq!(solver.solve(&gap, Normal::Load(1e5), Tilt::Fixed(0.0)).unwrap(), before);
    let bad = DMatrix::from_element(17, 17, f64::NAN);
    assert!(matches!(
        solver.set_added_compliance(Some(&bad)),
        Err(ContactError::Invalid { quantity: "extra compliance", .. })
    ));
}

#[test]
fn extra_compliances_by_turns_are_factorised_once() {
    let cells = Cells::graded(0.03, 17).unwrap();
    let compliance = half_plane(&cells, 0.2);
    let gap = wavy(&cells, 3, 1e-7);
    let added_compliance = |part: f64| DMatrix::from_fn(17, 17, |i, j| part * 1e-12 * f64::from(u8::from(i == j)));
    let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
    let mut first = 0;
    for turn in 0..20 {
        let own = added_compliance(f64::from(turn % 4));
        // None is one of the cases.
        solver.set_added_compliance((turn % 4 > 0).then_some(&own)).unwrap();
        solver.set_active(&[true; 17]);
        let found = solver.solve(&gap, Normal::Load(1e6), Tilt::Fixed(0.0)).unwrap();
        let mut fresh = ContactSolver::new(&cells, compliance.clone()).unwrap();
        fresh.set_added_compliance(Some(&own)).unwrap();
        assert_eq!(found, fresh.solve(&gap, Normal::Load(1e6), Tilt::Fixed(0.0)).unwrap(), "{turn}");
        if turn == 3 {
            first = solver.counter().factorisations;
        }
    }
    assert_eq!(solver.counter().factorisations, first);
}

#[test]
fn bodies_without_a_uniform_displacement_are_solved_where_the_approach_is_free() {
    // A periodic half-plane has no displacement of the mean: the compliance is singular, the contact is not.
    let cells = Cells::uniform(1.0, 16).unwrap();
    let mode = |i: usize, j: usize, q: f64| ((i as f64 - j as f64) * q * std::f64::consts::PI / 8.0).cos() / q;
    let compliance = DMatrix::from_fn(16, 16, |i, j| (1..8).map(|q| mode(i, j, f64::from(q))).sum::<f64>());
    let compliance = compliance + DMatrix::from_fn(16, 16, |i, j| mode(i, j, 8.0));
    let gap: Vec<f64> = (0..16).map(|i| (f64::from(i) * std::f64::consts::PI / 8.0).cos()).collect();
    let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
    for load in [0.1, 100.0] {
        let state = solver.solve(&gap, Normal::Load(load), Tilt::Fixed(0.0)).unwrap();
        check(&cells, &compliance, &gap, &state);
        assert!((cells.integral(&state.pressure) / load - 1.0).abs() < 1e-12);
        assert_eq!(state.pressure.iter().all(|p| *p > 0.0), load > 1.0);
    }
    let spring = Normal::Spring { load: 1e2, stiffness: 0.3 };
    let state = solver.solve(&gap, spring, Tilt::Fixed(0.0)).unwrap();
    check(&cells, &compliance, &gap, &state);
    assert!((cells.integral(&state.pressure) - (1e2 - 0.3 * state.approach)).abs() < 1e-10);
}

#[test]
fn a_load_holds_a_contact_that_its_heat_lifts_by_more_than_it_is_pressed() {
    // A uniform displacement of all cells changes only the approach under a load.
    let cells = Cells::graded(0.03, 33).unwrap();
    let compliance = half_plane(&cells, 0.3);
    let own = compliance.diagonal().max();
    for tilt in [Tilt::Fixed(0.0), Tilt::ResultantAt(0.004)] {
        for seed in 0..5 {
            let gap = wavy(&cells, seed, 3e-6);
            let mut solver = ContactSolver::new(&cells, compliance.clone()).unwrap();
            let cold = solver.solve(&gap, Normal::Load(1e6), tilt).unwrap();
            assert!(cold.pressure.contains(&0.0));
            let added_compliance = DMatrix::from_fn(33, 33, |_, j| -200.0 * own * cells.widths()[j] / 0.06);
            solver.set_added_compliance(Some(&added_compliance)).unwrap();
            solver.set_active(&[true; 33]);
            let hot = solver.solve(&gap, Normal::Load(1e6), tilt).unwrap();
            assert_eq!(solver.counter().fallbacks, 0, "cells in tension are found without pivoting");
            let highest = cold.pressure.iter().copied().fold(0.0, f64::max);
            for (hot, cold) in hot.pressure.iter().zip(&cold.pressure) {
                assert!((hot - cold).abs() < 1e-8 * highest, "{seed}: {hot:e} {cold:e}");
            }
            let diagonal = vec![0.0; 33];
            let problem = ContactProblem {
                gap: &gap,
                signed_friction: 0.0,
                diagonal: &diagonal,
                normal: Normal::Load(1e6),
                tilt,
            };
            let balance = solver.balance(&problem).unwrap();
            let mut memory = solver.memory.clone();
            memory.set.fill(true);
            solver.pivot_active_set(&problem, &balance, &mut memory).unwrap();
            assert!(memory.set.iter().zip(&cold.pressure).all(|(set, p)| *set == (*p > 0.0)), "{seed}");
        }
    }
}
