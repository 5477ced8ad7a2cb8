//! Output derivatives against their values computed from other outputs.

use test_support::{Drive, reference, scene, scenes};

fn rate(drive: &mut Drive, name: &str) -> f64 {
    let mut result = [f64::NAN];
    drive.0.output_derivatives(&[reference(name)], &mut result).unwrap();
    result[0]
}

#[test]
fn rates_are_the_powers_and_flows() {
    for (name, load, velocity) in scenes() {
        let mut drive = Drive::from_starts(&scene(name), &[]);
        drive.set("normal_load", load).set("sliding_velocity", -velocity).steps(40, 0.05);
        let expected = |drive: &mut Drive, names: &[&str]| names.iter().map(|name| drive.get(name)).sum::<f64>();
        let power = drive.get("friction_power");
        let flows = expected(&mut drive, &["heat_flow_ambient", "heat_flow_punch_top", "heat_flow_strip_base"]);
        for (name, exact) in [
            ("sliding_distance", velocity),
            ("dissipated_energy", power),
            ("stored_heat", power - flows),
            ("heat_lost_ambient", drive.get("heat_flow_ambient")),
        ] {
            let found = rate(&mut drive, name);
            // A bristle gives way while its limit follows the temperature.
            let bound = if drive.get("contact.stick_stiffness") > 0.0 { 1e-3 } else { 1e-5 };
            assert!((found - exact).abs() < bound * (exact.abs() + 1e-6 * power), "{name}: {found} {exact}");
        }
        let refused = drive.0.output_derivatives(&[reference("normal_load")], &mut [0.0]).unwrap_err();
        assert!(refused.contains("not an output"), "{refused}");
        // Nothing has moved, and another step goes on from here to the bit.
        let mut twin = Drive::from_starts(&scene(name), &[]);
        twin.set("normal_load", load).set("sliding_velocity", -velocity).steps(40, 0.05);
        for drive in [&mut drive, &mut twin] {
            drive.step(0.05);
        }
        for name in ["contact_temperature", "wear_depth", "stored_heat"] {
            assert_eq!(drive.get(name).to_bits(), twin.get(name).to_bits(), "{name}");
        }
    }
}

#[test]
fn temperatures_rise_at_their_rate() {
    let mut drive = Drive::stock(&[]);
    // Before the first step too.
    drive.set("sliding_velocity", 3.0);
    assert!((rate(&mut drive, "sliding_distance") / 3.0 - 1.0).abs() < 1e-6);
    drive.set("normal_load", 4e3).set("sliding_velocity", 5.0).steps(20, 0.1);
    let (rate, start) = (rate(&mut drive, "contact_temperature"), drive.get("contact_temperature"));
    let wear = rate_of_wear(&mut drive);
    drive.steps(100, 1e-4);
    let change = (drive.get("contact_temperature") - start) / 1e-2;
    assert!(rate > 0.0 && (rate / change - 1.0).abs() < 2e-2, "{rate} {change}");
    assert!((rate_of_wear(&mut drive) / wear - 1.0).abs() < 1e-2);
}

fn rate_of_wear(drive: &mut Drive) -> f64 {
    let found = rate(drive, "wear_depth");
    let (power, pressure) = (drive.get("wear_dissipation_power"), drive.get("pressure_mean"));
    let area = drive.area() * drive.get("contact.faces") * drive.get("punch.count");
    // p (dw/dt) A over p A; the strip of a closed path loses only its covered share.
    assert!(found <= power / (pressure * area) * (1.0 + 1e-6) && found > 0.0);
    found
}
