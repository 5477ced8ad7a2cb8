//! The reference level: the punch in unreduced finite elements against its reduced model.

use sliding_contact::component::Snapshot;
use test_support::{Drive, scene};

const LINE: f64 = 3.0;
const FIELD: f64 = 4.0;

fn scene_on(level: f64, cells: f64, changes: &[(&str, f64)]) -> Drive {
    let base = [("solver.fidelity", level), ("solver.cells", cells)];
    Drive::from_starts(&scene("reciprocating_punch"), &[&base[..], changes].concat())
}

/// Reciprocating sliding at 0.05 m/s, five times as fast as the example.
fn reciprocating(drive: &mut Drive, count: u32) {
    drive.set("normal_load", 1e4);
    for velocity in [0.05, -0.05] {
        drive.set("sliding_velocity", velocity);
        for _ in 0..count {
            drive.step(0.05);
        }
    }
}

/// Station values of a profile.
fn profile(drive: &mut Drive, name: &str) -> Vec<f64> {
    (1..=33).map(|station| drive.get(&format!("profile.{name}[{station}]"))).collect()
}

fn largest_difference(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| (left - right).abs()).fold(0.0, f64::max)
}

#[test]
fn the_reduced_punch_follows_the_unreduced_one() {
    let changes = [
        ("solver.tolerance", 2e-4),
        ("nominal.velocity", 0.05),
        ("nominal.stroke", 0.015),
        ("nominal.duration", 20.0),
        ("punch.convection", 100.0),
        // No cell opens: the field has whole cells alone.
        ("contact.friction_coefficient", 0.1),
    ];
    let [mut line, mut field] = [LINE, FIELD].map(|level| scene_on(level, 17.0, &changes));
    reciprocating(&mut line, 4);
    reciprocating(&mut field, 4);
    assert_eq!(line.get("contact_fraction"), 1.0);
    let rise = field.get("contact_temperature_max") - 293.15;
    for (name, scale, bound) in [
        ("temperature", rise, 1.5e-3),
        ("pressure", field.get("pressure_mean"), 2e-3),
        ("wear_punch", field.get("wear_depth"), 1.5e-3),
    ] {
        let error = largest_difference(&profile(&mut line, name), &profile(&mut field, name)) / scale;
        println!("{name}: {error:.2e}");
        assert!(error < bound, "{name}: {error:e}");
    }
    for name in ["heat_received_punch", "stored_heat", "friction_force", "punch.mean_temperature", "heat_flow_ambient"]
    {
        let (one, other) = (line.get(name), field.get(name));
        println!("{name}: {one} {other}");
        assert!((one / other - 1.0).abs() < 1e-3, "{name}: {one} {other}");
    }
    let (imbalance, error) = (field.imbalance(), line.get("estimated_step_error"));
    println!("rise {rise} K, imbalance {imbalance:e}, estimated {error:e}");
    assert!(imbalance < 1e-9, "{imbalance:e}");
}

#[test]
fn pressure_and_wear_agree_as_the_cells_get_finer() {
    let values = |level: f64, cells: f64| {
        let mut drive = scene_on(level, cells, &[("nominal.velocity", 0.05), ("nominal.stroke", 0.015)]);
        reciprocating(&mut drive, 2);
        let pressure = profile(&mut drive, "pressure");
        // Away from the edges, where the pressure of a flat punch is not finite.
        [pressure[8..25].to_vec(), vec![drive.get("wear_depth"), drive.get("contact_temperature") - 293.15]]
    };
    let fine = values(FIELD, 33.0);
    let errors = [9.0, 17.0].map(|cells| {
        let coarse = values(LINE, cells);
        [0, 1].map(|k| {
            let scale = fine[k].iter().fold(0.0f64, |most, value| most.max(value.abs()));
            largest_difference(&coarse[k], &fine[k]) / scale
        })
    });
    println!("{errors:?}");
    assert!(errors[1][0] < 0.5 * errors[0][0] && errors[1][0] < 1.2e-2, "{errors:?}");
    assert!(errors.iter().all(|error| error[1] < 5e-3), "{errors:?}");
}

#[test]
fn a_saved_state_of_the_reference_goes_on_to_the_same_bits() {
    let run = |drive: &mut Drive| -> Vec<u64> {
        reciprocating(drive, 1);
        (7..250).map(|output| drive.0.get(output).to_bits()).collect()
    };
    for changes in [&[][..], &[("punch.top_thermal", 2.0)], &[("solver.scheme", 2.0)], &[("punch.conductivity", 0.0)]] {
        let mut drive = scene_on(FIELD, 9.0, changes);
        reciprocating(&mut drive, 1);
        let mut saved = Snapshot::default();
        drive.0.snapshot(&mut saved);
        let straight_on = run(&mut drive);
        drive.0.restore(&saved).unwrap();
        assert!(straight_on == run(&mut drive), "{changes:?}: same instance");
        let mut bytes = Vec::new();
        saved.encode(&mut bytes);
        let mut fresh = scene_on(FIELD, 9.0, changes);
        fresh.0.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
        assert!(straight_on == run(&mut fresh), "{changes:?}: fresh instance");
        let imbalance = drive.imbalance();
        println!("{changes:?}: {} bytes, imbalance {imbalance:e}", bytes.len());
        assert!(imbalance < 1e-9, "{changes:?}: {imbalance:e}");
    }
}

#[test]
fn a_ring_has_no_field() {
    let ring = [("contact.geometry", 2.0), ("strip.length", 0.0)];
    let on = |level: f64| Drive::attempt(&scene("disc_brake"), &[&[("solver.fidelity", level)][..], &ring].concat());
    let message = on(FIELD).err().unwrap();
    assert!(message.starts_with("solver.fidelity = field has finite elements of a block"), "{message}");
    // It is the level that is refused, not the ring.
    on(LINE).unwrap();
}
