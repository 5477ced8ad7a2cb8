//! Wear of the contact line: stages and steps of any length. Galin's relaxation and the annulus are problems of `verification`;
//! reversals, loads across zero and growing tilts are run by the component.

use super::implicit_step;
use contact::wear::law::PressureLaw;
use contact::wear::line::{CellRate, Coefficient, Conditions, WearTerm, WearingContact};
use contact::{Normal, Tilt, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use test_support::Random;

/// E* = 1 and a = 1, k = 1: time is the tau of the exact solution.
fn unit_half_plane() -> HalfPlane {
    HalfPlane { material: Material::new(0.91, 0.3).unwrap() }
}

/// A rigid punch on a body. The shear coupling includes the friction coefficient; the conditions supply its sign.
fn contact(cells: &Cells, body: &dyn ElasticBody, friction: f64, gap: Vec<f64>) -> WearingContact {
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), &body.compliance(cells));
    WearingContact::new(cells, cells.widths(), normal, shear * friction, gap).unwrap()
}

fn unidirectional(load: f64, tilt: Tilt, rate: CellRate) -> Conditions {
    Conditions { signed_friction: 1.0, normal: Normal::Load(load), tilt, rate }
}

fn power_rate(exponent: f64) -> CellRate {
    CellRate::uniform(1.0, 1.0, exponent)
}

#[test]
fn steps_of_any_length_end_in_uniform_wear() {
    // 10,000 times the explicit limit and more, exponents from 0.3 to 3, friction, edges that unload.
    let cells = Cells::graded(1.0, 33).unwrap();
    for exponent in [0.3, 0.5, 1.0, 2.0, 3.0] {
        let conditions = unidirectional(2.0, Tilt::Fixed(0.0), power_rate(exponent));
        let gap: Vec<f64> = cells.centres().iter().map(|x| 3.0 * x * x).collect();
        let mut contact = contact(&cells, &unit_half_plane(), 0.5, gap);
        let mut worn = vec![0.0; 33];
        for _ in 0..12 {
            implicit_step(&mut contact, &mut worn, 1e4, &conditions);
        }
        let state = contact.pressure(&worn, &conditions).unwrap();
        let error = state.pressure.iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "b {exponent}: {error:e}");
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
    }
}

/// At an exponent other than 1 a stage that differs little from the one before is solved with the factors of that one.
#[test]
fn stages_near_the_last_factorise_nothing() {
    let cells = Cells::graded(1.0, 17).unwrap();
    let mut contact = contact(&cells, &unit_half_plane(), 0.4, vec![0.0; 17]);
    let conditions = unidirectional(1.0, Tilt::Fixed(0.0), power_rate(1.7));
    let mut worn = vec![0.0; 17];
    let mut factorisations = |steps: usize| {
        let before = contact.counter().factorisations;
        for _ in 0..steps {
            implicit_step(&mut contact, &mut worn, 1e-4, &conditions);
        }
        contact.counter().factorisations - before
    };
    assert!(factorisations(1) > 1);
    assert!(factorisations(20) <= 1);
}

/// A light load leaves displacements that are small compared with the gap. Rounding errors then make the active set cycle where a
/// cell is about to touch, however short the stage.
#[test]
fn light_loads_on_wide_gaps_are_solved_to_rounding() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let terms = [1.52, 0.88]
        .map(|exponent| WearTerm { law: PressureLaw::power(exponent), coefficient: Coefficient::Uniform(1.0) });
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

#[test]
fn one_cell_and_one_cell_in_contact() {
    let single = Cells::graded(1.0, 1).unwrap();
    let mut contact_of_one = contact(&single, &unit_half_plane(), 0.3, vec![0.0]);
    let conditions = || Conditions { signed_friction: -1.0, ..unidirectional(2.0, Tilt::Fixed(0.0), power_rate(0.5)) };
    let mut worn = vec![0.0];
    implicit_step(&mut contact_of_one, &mut worn, 3.0, &conditions());
    assert!((worn[0] - 3.0).abs() < 1e-12);
    // A spike on one of 33 cells carries all the load until it is worn down to its neighbours.
    let cells = Cells::graded(1.0, 33).unwrap();
    let gap: Vec<f64> = (0..33).map(|i| if i == 20 { 0.0 } else { 1e4 }).collect();
    let mut spike = contact(&cells, &unit_half_plane(), 0.3, gap);
    let state = spike.pressure(&[0.0; 33], &conditions()).unwrap();
    assert_eq!(state.pressure.iter().filter(|p| **p > 0.0).count(), 1);
    assert!((state.pressure[20] * cells.widths()[20] - 2.0).abs() < 1e-12);
}
