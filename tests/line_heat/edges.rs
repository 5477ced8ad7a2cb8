//! Contact that ends within the zone, and within cells.

use sliding_contact::component::Snapshot;
use test_support::{Application, Drive, scene};

/// A brake whose heat bows the pad, on `cells` cells.
fn brake(cells: f64, changes: &[(&str, f64)]) -> Drive {
    let line = [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", 1e-3)];
    let mut drive = Drive::from_starts(&scene("disc_brake"), &[&line[..], changes].concat());
    drive.set("sliding_velocity", 20.0).set("normal_load", 3000.0);
    drive
}

#[test]
fn heat_is_balanced_while_edges_move_through_cells() {
    for changes in [&[][..], &[("punch.top_thermal", 2.0)], &[("strip.base_thermal", 2.0)]] {
        let mut drive = brake(17.0, changes);
        let mut open = false;
        for step in 0..60 {
            drive.set("sliding_velocity", 20.0 - 0.3 * f64::from(step)).step(0.25);
            open |= drive.get("contact_fraction") < 0.95;
            let imbalance = drive.imbalance();
            assert!(imbalance < 1e-9, "{changes:?} step {step}: {imbalance:e}");
        }
        assert!(open, "{changes:?}: the ends of the pad lift off");
    }
}

#[test]
fn a_saved_state_goes_on_to_the_same_bits_from_within_a_cell() {
    let run = |drive: &mut Drive| -> Vec<u64> {
        let mut bits = Vec::new();
        for step in 0..12 {
            drive.set("normal_load", 3000.0 + 200.0 * f64::from(step % 3)).step(0.2);
            bits.extend((7..250).map(|output| drive.0.get(output).to_bits()));
        }
        bits
    };
    let mut drive = brake(9.0, &[]);
    drive.steps(15, 0.4);
    assert!(drive.get("contact_fraction") < 0.95);
    let mut saved = Snapshot::default();
    drive.0.snapshot(&mut saved);
    let straight_on = run(&mut drive);
    drive.0.restore(&saved).unwrap();
    assert!(straight_on == run(&mut drive), "same instance");
    let mut bytes = Vec::new();
    saved.encode(&mut bytes);
    let mut fresh = brake(9.0, &[]);
    fresh.0.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
    assert!(straight_on == run(&mut fresh), "fresh instance");
}

/// Contact that ends within the zone: the temperature converges as the edges move through the cells, not as cells open.
#[test]
fn the_temperature_converges_where_ends_lift_off() {
    for (name, bounds) in [
        ("long_drag", [3e-3, 1.5e-3, 7e-4]),
        ("stiff_caliper", [1e-2, 3.5e-3, 2e-3]),
        ("cooled_disc", [1.4e-2, 5e-3, 1.7e-3]),
        ("duty_cycle", [3.3e-3, 1.6e-3, 6e-4]),
    ] {
        let scene = Application::read(name);
        let on = |cells: f64| {
            let line = [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", 1e-3)];
            scene.run(&line).unwrap()
        };
        let fine = on(129.0);
        let found = [9.0, 17.0, 33.0].map(|cells| on(cells).errors(&fine)[1]);
        assert!(found.iter().zip(bounds).all(|(error, bound)| *error < bound), "{name}: {found:?}");
    }
}
