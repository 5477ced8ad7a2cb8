//! Cases in which numerical methods tend to fail, through the component, with their required results.

use super::contact::{BASE, line, trapezoid};
use sliding_contact::component::Subject;
use test_support::Drive;

const MEAN: f64 = 1e4 / 6e-4;

/// Ratio of the load integrated over the stations to the given one.
fn carried(drive: &mut Drive) -> f64 {
    trapezoid(&drive.profile("pressure"), 0.06) * 0.01 / 1e4
}

#[test]
fn creeping_and_racing() {
    // The wear of a distance does not depend on how fast it was slid, up to steps of the longest duration.
    let worn: Vec<f64> = [(1e-10, 1e10), (0.01, 100.0), (100.0, 1e-2)]
        .into_iter()
        .map(|(velocity, duration)| {
            let mut drive = line(&[("solver.cells", 17.0), ("punch.wear_coefficient", 4e-13)]);
            drive.set("normal_load", 1e4).set("sliding_velocity", velocity).steps(10, duration / 10.0);
            assert!((carried(&mut drive) - 1.0).abs() < 1e-12);
            drive.get("profile.wear_punch[1]")
        })
        .collect();
    assert!(worn.iter().all(|depth| (depth / worn[1] - 1.0).abs() < 1e-9), "{worn:?}");
}

#[test]
fn a_reversal_in_each_of_a_hundred_steps() {
    for half in [false, true] {
        let mut drive = line(&[("solver.cells", 33.0), ("contact.friction_coefficient", 0.6)]);
        drive.set("normal_load", 1e4);
        for step in 0..100 {
            let velocity = if step % 2 == 0 { 0.2 } else { -0.2 };
            drive.set("sliding_velocity", velocity);
            if half {
                // Turned round within the step.
                drive.slope("sliding_velocity", -2.0 * velocity / 0.1);
            }
            drive.step(0.1);
            assert!((carried(&mut drive) - 1.0).abs() < 1e-12);
            let pressure = drive.profile("pressure");
            assert!(pressure.iter().all(|p| *p >= 0.0 && *p < 20.0 * MEAN));
        }
        // Sliding both ways alike leaves a symmetric shape, to the wear of a stroke.
        let worn = drive.profile("wear_punch");
        for k in 0..16 {
            assert!((worn[k] - worn[32 - k]).abs() < 0.03 * worn[16], "{k}: {} {}", worn[k], worn[32 - k]);
        }
        let way = drive.get("sliding_distance");
        assert!((way / if half { 1.0 } else { 2.0 } - 1.0).abs() < 1e-12, "{way}");
    }
}

#[test]
fn a_load_that_crosses_zero_both_ways_inside_a_step() {
    let mut drive = line(&[("solver.cells", 17.0), ("punch.wear_pressure_exponent", 0.3)]);
    drive.set("sliding_velocity", 0.5);
    // From 1000 N to -500 N within a step, and back: what counts is the part above 0.
    drive.set("normal_load", 1000.0).slope("normal_load", -1500.0).step(1.0);
    assert_eq!((drive.get("pressure_max"), drive.get("contact_fraction")), (0.0, 0.0));
    drive.slope("normal_load", 1500.0).step(1.0);
    assert!((carried(&mut drive) * 1e4 / 1000.0 - 1.0).abs() < 1e-9);
    // Friction heat: mu |v| integral of the load, twice a triangle of 1000 N and 2/3 s.
    let energy = drive.get("dissipated_energy");
    assert!((energy / (0.25 * 0.5 * 1000.0 * 2.0 / 3.0) - 1.0).abs() < 1e-9, "{energy}");
    assert!(drive.get("wear_volume_punch") > 0.0);
    assert!(drive.imbalance() < 1e-9);
}

#[test]
fn edges_that_unload_at_a_small_exponent() {
    // A punch free to rotate, its lever beyond a third of the half-width: the trailing edge lifts off and comes back.
    let mut drive = line(&[
        ("solver.cells", 33.0),
        ("punch.wear_pressure_exponent", 0.3),
        ("holder.constraint", 2.0),
        ("holder.pivot_height", 0.06),
        ("contact.shear_coupling", 0.0),
        ("punch.wear_coefficient", 1e-13),
    ]);
    drive.set("normal_load", 1e4);
    for half in 0..40 {
        drive.set("sliding_velocity", if half % 2 == 0 { 0.1 } else { -0.1 }).step(0.3);
        let pressure = drive.profile("pressure");
        assert!((carried(&mut drive) - 1.0).abs() < 1e-12);
        assert!(pressure.iter().all(|p| p.is_finite() && *p >= 0.0));
        let x = drive.profile("x");
        let moment: Vec<f64> = pressure.iter().zip(&x).map(|(p, x)| p * x).collect();
        let lever = trapezoid(&moment, 0.06) / (1e4 / 0.01);
        assert!((lever.abs() - 0.015).abs() < 1e-3, "{half}: {lever}");
    }
}

#[test]
fn a_ring_without_edges() {
    // Full periodic contact: friction shifts nothing, every cell alike.
    let mut ring = line(&[
        ("contact.geometry", 3.0),
        ("strip.length", 0.06),
        ("strip.body", 4.0),
        ("strip.height", 0.01),
        ("solver.cells", 32.0),
    ]);
    ring.set("normal_load", 1e4).set("sliding_velocity", 0.1).step(10.0);
    let pressure = ring.profile("pressure");
    assert!(pressure.iter().all(|p| (p / MEAN - 1.0).abs() < 1e-9), "{pressure:?}");
}

#[test]
fn a_tilt_that_grows_without_bound_is_reported_and_runs() {
    // mu H = 0.55 a: between a/2 and a.
    let changes =
        [("solver.cells", 17.0), ("holder.constraint", 2.0), ("holder.pivot_height", 0.066), ("nominal.stroke", 3e-3)];
    let mut drive = line(&changes);
    let messages: Vec<_> = drive.0.messages().cloned().collect();
    let tilts =
        |message: &&sliding_contact::component::Message| message.text.contains("increases the tilt without bound");
    let found = messages.iter().find(tilts).expect("a warning");
    assert!(found.subject == Subject::Warning && found.text.contains("0.0165"), "{}", found.text);
    drive.set("normal_load", 1e4);
    let mut tilts = Vec::new();
    for half in 0..400 {
        drive.set("sliding_velocity", if half % 2 == 0 { 0.01 } else { -0.01 }).step(0.3);
        tilts.push(drive.get("tilt"));
        assert!((carried(&mut drive) - 1.0).abs() < 1e-12);
    }
    // It never becomes a cycle: the jump of the tilt from stroke to stroke keeps growing.
    let jump = |half: usize| (tilts[half] - tilts[half - 1]).abs();
    assert!(jump(99) < jump(199) && jump(199) < jump(299) && jump(399) > 1.1 * jump(99), "{tilts:?}");
    // Run-in starts are refused there, with the reason.
    let text = Drive::attempt(
        &scene::variables::STARTS,
        &[BASE, &changes, &[("contact.initial_shape", 3.0), ("strip.path", 1.0), ("strip.length", 0.0)]].concat(),
    )
    .err()
    .unwrap();
    assert!(text.contains("run_in") && text.contains("increases the tilt without bound"), "{text}");
}

#[test]
fn an_instance_is_small() {
    let before = memory();
    let mut drives: Vec<Drive> = (0..4)
        .map(|_| {
            let mut drive = line(&[("solver.cells", 129.0)]);
            drive.set("normal_load", 1e4).set("sliding_velocity", 0.1).step(1.0);
            drive
        })
        .collect();
    let each = (memory() - before) / 4.0;
    assert!(each < 10e6, "{each} bytes an instance");
    drives.iter_mut().for_each(|drive| assert!(drive.get("wear_depth") > 0.0));
}

/// Resident memory of this process, bytes.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() * 1024.0
}

/// Wear proportional to p^0.785, with infinite slope where a cell of a parabola has just touched, friction that falls
/// with temperature, and thermal distortion that opens the cells at the edge.
#[test]
fn a_parabola_whose_edge_wears_steeply_and_fades() {
    let mut lowest: f64 = 1.0;
    for step in [0.01, 0.05, 0.1, 0.2, 0.3, 1.0] {
        let mut drive = line(&[
            ("solver.cells", 22.0),
            ("contact.initial_shape", 2.0),
            ("contact.initial_radius", 300.0),
            ("*.thermal_expansion", 1e-7),
            ("punch.wear_pressure_exponent", 0.785),
            ("contact.friction_fade.factor[2]", 0.724),
        ]);
        for (velocity, load) in [(-3.17, 4.3e3), (-7.63, 5.6e3)] {
            drive.set("sliding_velocity", velocity).set("normal_load", load).steps(2, step);
            assert!((carried(&mut drive) * 1e4 / load - 1.0).abs() < 1e-9, "{step} s");
        }
        let (worn, kinetic_coefficient) = (drive.get("wear_volume_punch"), drive.get("friction_coefficient"));
        // Hot enough, the friction is that of the cold contact again: only one factor of the table is below 1.
        assert!(
            worn > 0.0 && kinetic_coefficient <= 0.25 && kinetic_coefficient > 0.18,
            "{step} s: {worn} {kinetic_coefficient}"
        );
        lowest = lowest.min(kinetic_coefficient);
        assert!(drive.imbalance() < 1e-9, "{step} s: {:e}", drive.imbalance());
    }
    assert!(lowest < 0.249, "friction fades: {lowest}");
}
