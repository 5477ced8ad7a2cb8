//! Energy balance: friction work equals heat stored plus heat lost.

use test_support::{Drive, scene};

#[test]
fn the_account_closes_on_every_path() {
    let starts = scene("reciprocating_punch");
    let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0)];
    for changes in [
        &[][..],
        &[("strip.path", 2.0), ("strip.length", 0.3)],
        &[("strip.path", 1.0), ("nominal.stroke", 0.0), ("strip.convection", 50.0)],
        &[("contact.conductance", 0.0), ("punch.emissivity", 0.5), ("strip.emissivity", 0.8)],
        &[("punch.conductivity", 0.0)],
        &[("strip.convection", 50.0), ("strip.path", 2.0), ("strip.length", 0.3)],
    ] {
        let mut drive = Drive::from_starts(&starts, &[&line[..], changes].concat());
        drive.set("normal_load", 1e4);
        for step in 0..60 {
            let t = f64::from(step) * 0.05;
            drive.set("sliding_velocity", 0.015 * (3.0 * t).cos());
            if step == 40 {
                drive.set("normal_load", 0.0);
            }
            drive.step(0.05);
        }
        let received = drive.get("heat_received_punch") + drive.get("heat_received_strip");
        let (work, imbalance) = (drive.get("dissipated_energy"), drive.imbalance());
        println!(
            "{changes:?}: work {work} J, imbalance {imbalance:.1e}, received {:.1e}, punch {}, T {} max {}",
            received / work - 1.0,
            drive.get("heat_received_punch"),
            drive.get("contact_temperature"),
            drive.get("contact_temperature_max"),
        );
        assert!(work > 0.0);
        assert!((received / work - 1.0).abs() < 1e-9, "{changes:?}");
        assert!(imbalance < 1e-9, "{changes:?}: {imbalance}");
    }
}
