//! Elastic displacement along the sliding direction before the bodies slide (`contact.tangential_compliance` = elastic).

use std::f64::consts::PI;
use test_support::{Drive, LUMPED, scene};

/// Scene of a published fretting test: two half-planes of 200 GPa, 6 and 10 mm high, a cylinder of 6 mm, 185 N on
/// 10 mm, mu = 0.9.
fn fretting(changes: &[(&str, f64)]) -> Drive {
    let elastic = [("contact.tangential_compliance", 2.0)];
    let mut drive = Drive::from_starts(&scene("published/fretting"), &[&elastic, changes].concat());
    drive.set("normal_load", 185.0);
    drive
}

const MODULUS: f64 = 200e9 / 0.91;
const FORCE: f64 = 0.9 * 185.0;

/// Force over displacement (N/m) of both half-planes in series, where -ln|x - s| has the mean `logarithm` under the traction.
fn stiffness(logarithm: f64) -> f64 {
    let compliance = |height: f64| 2.0 / (PI * MODULUS) * (f64::ln(height) + logarithm + 1.0 / (2.0 * 0.7));
    0.01 / (compliance(6e-3) + compliance(10e-3))
}

/// Force over displacement between full slip to one side and to the other, with the loss of slip beside that displacement.
fn reversal(drive: &mut Drive) -> (f64, f64) {
    let speed = 1e-4;
    let mut run = |velocity: f64, parts: u32, length: f64| {
        let step = length / velocity.abs() / f64::from(parts);
        (0..parts)
            .map(|_| {
                drive.set("sliding_velocity", velocity).step(step);
                (drive.get("friction_force"), drive.get("sliding_distance"))
            })
            .collect::<Vec<_>>()
    };
    let there = *run(speed, 20, 5e-6).last().unwrap();
    assert!((there.0 / FORCE - 1.0).abs() < 1e-9, "{there:?}");
    let back = run(-speed, 40, 4e-7);
    let slope = (there.0 - back[39].0) / 4e-7;
    // A straight line, without slip.
    assert!((there.0 - back[19].0 - 2e-7 * slope).abs() < 1e-6 * FORCE && back[39].0.abs() < FORCE);
    assert!((back[39].1 - there.1).abs() < 1e-15, "{back:?}");
    let end = *run(-speed, 20, 5e-6).last().unwrap();
    (slope, 5.4e-6 - (end.1 - there.1))
}

#[test]
fn the_force_over_displacement_of_a_reversal_has_the_slope_of_the_bodies() {
    // Uniform traction over the zone of 0.5 mm: the mean of -ln|x - s| is 3/2 - ln W.
    let uniform = stiffness(1.5 - f64::ln(0.5e-3));
    // The pressure of Hertz, whose half-width follows from load and radius: 1/4 - ln(a/2).
    let half_width = (4.0 * 18500.0 * 6e-3 / (PI * 0.5 * MODULUS)).sqrt();
    let hertz = stiffness(0.25 - f64::ln(0.5 * half_width));
    let narrow = [("punch.width", 1.2e-4), ("*.wear_coefficient", 0.0)];
    for (expected, changes, tolerance) in
        [(uniform, &[("solver.fidelity", LUMPED)][..], 0.005), (hertz, &narrow[..], 0.005)]
    {
        let (slope, lost) = reversal(&mut fretting(changes));
        assert!((slope / expected - 1.0).abs() < tolerance, "{slope:e} {expected:e}");
        assert!((lost * slope / (2.0 * FORCE) - 1.0).abs() < 1e-4, "{lost:e}");
    }
}

#[test]
fn a_spring_for_standing_still_acts_in_series() {
    let lumped = ("solver.fidelity", LUMPED);
    let slope = |changes: &[(&str, f64)]| reversal(&mut fretting(&[&[lumped], changes].concat())).0;
    let (alone, spring) = (slope(&[]), 6e8);
    let both = slope(&[("contact.stick_stiffness", spring)]);
    assert!((alone.recip() + spring.recip() - both.recip()).abs() < 1e-9 / both);
    let given = slope(&[("contact.tangential_compliance", 1.0), ("contact.stick_stiffness", spring)]);
    assert!((given / spring - 1.0).abs() < 1e-9);
}

/// The contact of a wearing cylinder grows, and its stiffness with it, which takes no energy.
#[test]
fn work_is_heat_or_stored_while_the_contact_grows() {
    let mut drive = fretting(&[("wear_acceleration", 1000.0)]);
    let (mut work, mut before) = (0.0, 0.0);
    for step in 0..200 {
        let velocity = if step / 10 % 2 == 0 { 1e-4 } else { -1e-4 };
        drive.set("sliding_velocity", velocity);
        for _ in 0..20 {
            drive.step(2.5e-3);
            let force = drive.get("friction_force");
            work += 0.5 * (before + force) * velocity * 2.5e-3;
            before = force;
        }
    }
    let (heat, stored) = (drive.get("dissipated_energy"), drive.get("bristle_energy"));
    assert!(drive.get("wear_depth_strip") > 1e-6);
    // Trapezoidal work, which misses corners of the force.
    assert!((work - heat - stored).abs() < 2e-3 * work, "{work:e} {heat:e} {stored:e}");
}

#[test]
fn slip_that_is_neglected_enters_the_error_and_falls_with_the_stroke() {
    // The height of an insulated half-plane matters for its elastic displacement alone.
    let squared_error = |stroke: f64, height: f64| {
        let changes = [
            ("contact.tangential_compliance", 1.0),
            ("nominal.stroke", stroke),
            ("punch.height", height),
            ("solver.error_estimate", 3.0),
            ("solver.cells", 33.0),
        ];
        let mut drive = fretting(&changes);
        for velocity in [1e-4, -1e-4] {
            drive.set("sliding_velocity", velocity).step(0.25);
        }
        drive.get("estimated_error").powi(2)
    };
    let lower = 2.0 * FORCE / stiffness(1.5 - f64::ln(0.5e-3));
    let higher = lower + 2.0 * FORCE / 0.01 * 2.0 / (PI * MODULUS) * f64::ln(100.0);
    for stroke in [50e-6, 500e-6] {
        let found = squared_error(stroke, 0.6) - squared_error(stroke, 6e-3);
        let expected = (higher / stroke).powi(2) - (lower / stroke).powi(2);
        assert!((found / expected - 1.0).abs() < 0.01, "{stroke}: {found:e} {expected:e}");
    }
}
