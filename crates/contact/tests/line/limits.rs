//! Cases in which contact and wear methods tend to fail, each with its required result.

use super::implicit_step;
use contact::wear::line::{CellRate, Conditions, WearingContact};
use contact::{Normal, Tilt, pair_operators};
use elasticity::{Base, Cells, Compliance, ElasticBody, Extent, HalfPlane, Material, Rigid, Strip};

fn half_plane(cells: &Cells) -> Compliance {
    HalfPlane { material: Material::new(0.91, 0.3).unwrap() }.compliance(cells)
}

/// A rigid punch on a strip. The shear coupling includes the friction coefficient; the conditions supply its sign.
fn contact(cells: &Cells, strip: &Compliance, friction: f64, gap: Vec<f64>) -> WearingContact {
    let (normal, shear) = pair_operators(&Rigid.compliance(cells), strip);
    WearingContact::new(cells, cells.widths(), normal, shear * friction, gap).unwrap()
}

fn power_rate(exponent: f64) -> CellRate {
    CellRate::uniform(1.0, 1.0, exponent)
}

#[test]
fn load_crossing_zero_in_both_directions() {
    // A spring that lifts off and presses again: no pressure and no wear while it is relaxed beyond touching, and the
    // worn area is the sum of the loads at the ends of the steps while it is not.
    let cells = Cells::graded(1.0, 17).unwrap();
    let mut contact = contact(&cells, &half_plane(&cells), 0.3, vec![0.0; 17]);
    let load = |time: f64| (1.0 + 2.0 * (5.0 * time).sin()).max(0.0);
    let conditions = |time: f64| Conditions {
        signed_friction: 1.0,
        normal: Normal::Load(load(time)),
        tilt: Tilt::ResultantAt(0.1),
        rate: CellRate::archard(1.0, 1.0),
    };
    let mut worn = vec![0.0; 17];
    let (steps, mut exact) = (4000, 0.0);
    for step in 0..steps {
        let (time, length) = (step as f64 * 3.0 / steps as f64, 3.0 / steps as f64);
        let before = worn.clone();
        let state = implicit_step(&mut contact, &mut worn, length, &conditions(time + length));
        assert!((cells.integral(&state.pressure) - load(time + length)).abs() < 1e-12);
        if load(time) == 0.0 && load(time + length) == 0.0 && load(time + 0.5 * length) == 0.0 {
            assert_eq!(worn, before);
        }
        exact += length * load(time + length);
    }
    assert!((cells.integral(&worn) / exact - 1.0).abs() < 1e-12);
}

#[test]
fn a_reversal_in_each_of_a_hundred_steps() {
    // The worn area does not notice; by symmetry of forward and backward the shape is even up to the last half-stroke.
    let cells = Cells::graded(1.0, 33).unwrap();
    for exponent in [0.3, 1.0, 3.0] {
        let mut contact = contact(&cells, &half_plane(&cells), 0.5, vec![0.0; 33]);
        let mut worn = vec![0.0; 33];
        let mut last = Vec::new();
        for step in 0..100 {
            let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
            let conditions = Conditions {
                signed_friction: sign,
                normal: Normal::Load(2.0),
                tilt: Tilt::ResultantAt(0.2 * sign),
                rate: power_rate(exponent),
            };
            let before = worn.clone();
            implicit_step(&mut contact, &mut worn, 0.02, &conditions);
            last = worn.iter().zip(&before).map(|(a, b)| a - b).collect::<Vec<f64>>();
            assert!(last.iter().all(|d| *d >= 0.0), "b {exponent}: negative wear");
        }
        let asymmetry = (0..33).map(|i| (worn[i] - worn[32 - i]).abs()).fold(0.0, f64::max);
        let stroke = last.iter().copied().fold(0.0, f64::max);
        assert!(asymmetry < 2.0 * stroke, "b {exponent}: {asymmetry} {stroke}");
        if exponent == 1.0 {
            assert!((cells.integral(&worn) / 4.0 - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn nearly_incompressible_layers_and_wide_pads() {
    // Every cell keeps finite positive pressure, the load is carried, and wear makes the pressure uniform.
    for (nu, height, base) in [
        (0.4999, 1.0, Base::Bonded),
        (0.4999, 0.02, Base::Bonded),
        (0.4999, 0.02, Base::Smooth),
        (0.3, 0.02, Base::Bonded),
        (0.3, 1e-4, Base::Smooth),
    ] {
        let cells = Cells::graded(1.0, 33).unwrap();
        let strip = Strip::new(Material::new(1.0, nu).unwrap(), height, base, Extent::Straight).unwrap();
        let compliance = strip.compliance(&cells);
        let mut contact = contact(&cells, &compliance, 0.3, vec![0.0; 33]);
        let conditions = Conditions {
            signed_friction: 1.0,
            normal: Normal::Load(2.0),
            tilt: Tilt::Fixed(0.0),
            rate: power_rate(1.0),
        };
        let fresh = contact.pressure(&[0.0; 33], &conditions).unwrap();
        assert!((cells.integral(&fresh.pressure) - 2.0).abs() < 1e-9);
        assert!(fresh.pressure.iter().all(|p| p.is_finite() && *p >= 0.0), "nu {nu} h {height}");
        let mut worn = vec![0.0; 33];
        for _ in 0..10 {
            implicit_step(&mut contact, &mut worn, 1e3, &conditions);
        }
        let state = contact.pressure(&worn, &conditions).unwrap();
        let error = state.pressure.iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < 1e-5, "nu {nu} h {height}: {error:e}");
    }
}

#[test]
fn one_cell_and_one_cell_in_contact() {
    let single = Cells::graded(1.0, 1).unwrap();
    let mut contact_of_one = contact(&single, &half_plane(&single), 0.3, vec![0.0]);
    let conditions = || Conditions {
        signed_friction: -1.0,
        normal: Normal::Load(2.0),
        tilt: Tilt::Fixed(0.0),
        rate: power_rate(0.5),
    };
    let mut worn = vec![0.0];
    implicit_step(&mut contact_of_one, &mut worn, 3.0, &conditions());
    assert!((worn[0] - 3.0).abs() < 1e-12);
    // A spike on one of 33 cells carries all the load until it is worn down to its neighbours.
    let cells = Cells::graded(1.0, 33).unwrap();
    let gap: Vec<f64> = (0..33).map(|i| if i == 20 { 0.0 } else { 1e4 }).collect();
    let mut spike = contact(&cells, &half_plane(&cells), 0.3, gap);
    let state = spike.pressure(&[0.0; 33], &conditions()).unwrap();
    assert_eq!(state.pressure.iter().filter(|p| **p > 0.0).count(), 1);
    assert!((state.pressure[20] * cells.widths()[20] - 2.0).abs() < 1e-12);
}

#[test]
fn a_tilt_that_grows_without_bound() {
    // mu H between a/2 and a: no steady state, but every half-stroke has an equilibrium. The edges wear more than the
    // middle for ever, so the worn shape grows rounder with every cycle.
    let cells = Cells::graded(1.0, 33).unwrap();
    let mut contact = contact(&cells, &half_plane(&cells), 0.0, vec![0.0; 33]);
    let mut worn = vec![0.0; 33];
    let mut roundness = Vec::new();
    for cycle in 0..200 {
        for (sign, lever) in [(1.0, 0.7), (-1.0, -0.7)] {
            let conditions = Conditions {
                signed_friction: sign,
                normal: Normal::Load(2.0),
                tilt: Tilt::ResultantAt(lever),
                rate: power_rate(1.0),
            };
            let state = implicit_step(&mut contact, &mut worn, 0.5, &conditions);
            assert!((cells.moment(&state.pressure) / 2.0 - lever).abs() < 1e-10);
        }
        if cycle % 20 == 19 {
            roundness.push(0.5 * (worn[0] + worn[32]) - worn[16]);
        }
    }
    for pair in roundness.windows(2) {
        assert!(pair[1] - pair[0] > 0.5 * (roundness[1] - roundness[0]), "{roundness:?}");
    }
    assert!((cells.integral(&worn) / 400.0 - 1.0).abs() < 1e-12);
}

#[test]
fn edges_that_unload_at_an_exponent_of_three_tenths() {
    // A worn parabola whose load falls to a fiftieth: cells leave, those that have left wear no more, the load is carried
    // by the others, and steps need not be short.
    let cells = Cells::graded(1.0, 33).unwrap();
    let gap = cells.centres().iter().map(|x| x * x).collect();
    let mut contact = contact(&cells, &half_plane(&cells), 0.3, gap);
    let (mut worn, mut in_contact) = (vec![0.0; 33], Vec::new());
    for step in 0..20 {
        let load = if step < 10 { 1.0 } else { 1.0 - 0.98 * f64::from(step - 9) / 10.0 };
        let conditions = Conditions {
            signed_friction: 1.0,
            normal: Normal::Load(load),
            tilt: Tilt::Fixed(0.0),
            rate: power_rate(0.3),
        };
        let before = worn.clone();
        let state = implicit_step(&mut contact, &mut worn, 0.02, &conditions);
        assert!((cells.integral(&state.pressure) / load - 1.0).abs() < 1e-9);
        let now = state.pressure.iter().filter(|p| **p > 0.0).count();
        if step > 10 && in_contact.last() == Some(&now) {
            // Cells that are open at the end of two steps have been open throughout.
            assert!((0..33).all(|i| state.pressure[i] > 0.0 || worn[i] == before[i]), "step {step}");
        }
        assert!((0..33).all(|i| worn[i] >= before[i]), "step {step}: negative wear");
        in_contact.push(now);
    }
    assert!(in_contact[9] > 17 && in_contact[19] < in_contact[9] / 2, "{in_contact:?}");
    assert!(in_contact[10..].windows(2).all(|pair| pair[1] <= pair[0]), "{in_contact:?}");
}
