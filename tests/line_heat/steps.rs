//! Order in time, steps that a run takes, and quantities independent of heat without expansion.

use test_support::{Application, Drive, scene};

fn reciprocating(changes: &[(&str, f64)]) -> Drive {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0)];
    Drive::from_starts(&scene("reciprocating_punch"), &[&line[..], changes].concat())
}

#[test]
fn heat_that_moves_nothing_leaves_pressure_and_wear() {
    let worn = |expansion: f64| {
        let mut drive = reciprocating(&[("punch.thermal_expansion", expansion), ("strip.thermal_expansion", 0.0)]);
        drive.set("normal_load", 1e4);
        for step in 0..40 {
            drive.set("sliding_velocity", 0.015 * (0.3 * f64::from(step)).cos()).step(0.03);
        }
        ["pressure_max", "wear_depth_punch", "friction_force", "dissipated_energy"].map(|name| drive.get(name))
    };
    let (with, without) = (worn(1e-30), worn(0.0));
    for (with, without) in with.iter().zip(without) {
        assert!((with / without - 1.0).abs() < 1e-6, "{with} {without}");
    }
    let hot = worn(1.1e-5);
    assert!((hot[0] / with[0] - 1.0).abs() > 1e-4, "distortion changes the pressure");
}

/// Profiles of pressure and temperature after a run-up whose speed rises like the cube of time, with `parts` steps.
fn run_up(parts: u32, wear: f64) -> [Vec<f64>; 2] {
    run_up_to(0.01, parts, &[("punch.wear_coefficient", wear)])
}

fn run_up_to(last: f64, parts: u32, changes: &[(&str, f64)]) -> [Vec<f64>; 2] {
    run_up_like(3, last, parts, changes)
}

/// [`run_up`] with a speed proportional to this power of time.
fn run_up_like(power: i32, last: f64, parts: u32, changes: &[(&str, f64)]) -> [Vec<f64>; 2] {
    let plain = [("solver.tolerance", 0.1), ("contact.shear_coupling", 0.0)];
    let mut drive = reciprocating(&[&plain, changes].concat());
    drive.set("normal_load", 1e4);
    let duration = 2.0;
    let step = duration / f64::from(parts);
    let velocity = |time: f64| last * (time / duration).powi(power);
    for part in 0..parts {
        let time = step * f64::from(part);
        let (from, to) = (velocity(time), velocity(time + step));
        drive.set("sliding_velocity", from).slope("sliding_velocity", (to - from) / step);
        drive.step(step);
    }
    let fraction = drive.get("contact_fraction");
    assert!(fraction > 0.999, "{fraction}");
    ["pressure", "temperature"].map(|name| drive.profile(name))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Order of the changes between four runs, each with steps half as long, and the last change.
#[track_caller]
fn order(runs: [&[f64]; 4], what: &dyn std::fmt::Debug, expected: std::ops::Range<f64>) -> f64 {
    let differences = [0, 1, 2].map(|k| distance(runs[k], runs[k + 1]));
    let order = (differences[0] / differences[2]).log2() / 2.0;
    assert!(expected.contains(&order), "{what:?}: {order} {differences:?}");
    differences[2]
}

/// Second order of pressure and temperature.
#[track_caller]
fn both_of_second_order(runs: &[[Vec<f64>; 2]; 4], what: &dyn std::fmt::Debug) {
    for (quantity, name) in ["pressure", "temperature"].iter().enumerate() {
        order([0, 1, 2, 3].map(|k| &runs[k][quantity][..]), &(name, what), 1.9..2.1);
    }
}

/// Second order in full contact from a smooth start: the first stage's flux has the slope of the step before, which avoids the
/// order 3/2 of a stage of constant flux.
#[test]
fn pressure_and_temperature_are_of_second_order() {
    for wear in [0.0, 4e-14] {
        both_of_second_order(&[20, 40, 80, 160].map(|parts| run_up(parts, wear)), &wear);
    }
}

/// Second order with realistic cooling: natural convection, forced convection at the speed of the run-up, radiation; and with
/// unrealistic cooling of 2,500 and 25,000 W/(m2 K) at the end, where the flux at a step's midpoint would suffice for no step.
#[test]
fn cooling_leaves_the_temperature_of_second_order() {
    let [air, moving, radiation] = [("*.convection", 100.0), ("*.convection_forced", 1000.0), ("*.emissivity", 0.9)];
    let wear = ("punch.wear_coefficient", 4e-14);
    let warm = run_up_to(0.01, 320, &[wear, ("*.convection", 0.0)])[1].clone();
    let [strong, boiling] = [1e5, 1e6].map(|most| ("*.convection_forced", most));
    for case in [&[air][..], &[moving, radiation], &[air, moving, radiation], &[strong], &[boiling]] {
        let changes = [case, &[wear]].concat();
        let runs = [40, 80, 160, 320].map(|parts| run_up_to(0.01, parts, &changes)[1].clone());
        order(runs.each_ref().map(|run| &run[..]), &changes, 1.9..2.1);
        let cooled = distance(&warm, &runs[3]) / distance(&warm, &[293.15; 33]);
        assert!(cooled > 1e-4, "{changes:?}: {cooled}");
    }
}

/// Constant convection is part of the Fourier modes of the strip; the Robin correction under the contact is a flux that is linear
/// over the stages. That flux is the coefficient times the temperature, so the order is 2 as long as its error is of second order
/// in the step.
///
/// Beyond `H^2 >> K c/h` the modes are at the temperature of the air whatever the flux, and the half derivative in time of the
/// temperature under the contact is the friction heat. For half derivatives of piecewise linear functions the order is 2 - 1/2.
#[test]
fn constant_convection_leaves_the_order_until_the_cooled_layer_is_thinner_than_the_step() {
    // K c of steel, W2 s/(m4 K2).
    let effusivity_square = 46.0 * 7800.0 * 500.0;
    let unidirectional = [("nominal.stroke", 0.0)];
    for (convection, more) in
        [(1e4, &[][..]), (1e5, &[]), (1e4, &unidirectional), (1e5, &unidirectional), (1e6, &[]), (1e7, &[])]
    {
        let changes = [&[("*.convection", convection)], more].concat();
        let runs = [80, 160, 320, 640].map(|parts| run_up_to(0.01, parts, &changes)[1].clone());
        // Steps over the time of the cooled layer.
        let steps = 2.0 / 160.0 * convection * convection / effusivity_square;
        let expected = if steps < 10.0 { 1.9..2.25 } else { 1.45..1.9 };
        let last = order(runs.each_ref().map(|run| &run[..]), &(&changes, steps), expected);
        assert!(last < 1e-3, "{changes:?}: {last}");
    }
}

/// Second order in unidirectional sliding from rest with a step in the acceleration.
#[test]
fn a_unidirectional_run_up_from_rest_is_of_second_order() {
    let still = [("*.convection", 0.0)];
    let moving = [("*.convection_forced", 1e5)];
    for (power, changes) in [(1, &[][..]), (2, &still), (2, &moving), (3, &[]), (3, &[("nominal.duration", 2.0)])] {
        let changes = [changes, &[("nominal.stroke", 0.0)]].concat();
        let runs = [40, 80, 160, 320].map(|parts| run_up_like(power, 0.01, parts, &changes));
        both_of_second_order(&runs, &(power, changes));
    }
}

/// A cold pad laid lightly on a hot disc bows until few cells touch, and these are fed by short waves.
#[test]
fn a_loose_tolerance_does_not_decide_where_a_light_contact_touches() {
    let scene = Application::read("cold_pad");
    for cells in [17.0, 33.0, 65.0] {
        let run = |tolerance: f64| {
            let changes = [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", tolerance)];
            scene.run(&changes).unwrap()
        };
        let (loose, tight) = (run(1e-2), run(1e-4));
        let error = loose.error(&tight);
        assert!(error < 1e-2, "{cells}: {error:e}");
    }
}

/// Attempts over the first loaded millisecond, and the rise of the contact then and a tenth of a second later, K.
fn begun(tolerance: f64) -> (u64, [f64; 2]) {
    let changes = [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.tolerance", tolerance)];
    let mut drive = Drive::stock(&changes);
    drive.set("sliding_velocity", 3.8).set("normal_load", 0.0).steps(10, 1e-3);
    let rise = |drive: &mut Drive| drive.get("contact_temperature") - 293.15;
    let (accepted, rejected) = drive.0.work();
    drive.set("normal_load", 360.0).step(1e-3);
    let (accepted, rejected) = (drive.0.work().0 - accepted, drive.0.work().1 - rejected);
    let first = rise(&mut drive);
    drive.steps(100, 1e-3);
    (accepted + rejected, [first, rise(&mut drive)])
}

/// A load that jumped from 0 was cut into 2^7 parts in seven attempts, against a rise that falls with the step as its error does.
#[test]
fn heat_that_begins_takes_a_few_steps() {
    let ((attempts, rises), (_, truth)) = (begun(1e-3), begun(1e-7));
    let [first, later] = [0, 1].map(|k| (rises[k] / truth[k] - 1.0).abs());
    assert!(attempts <= 12 && first < 1e-3 && later < 1e-4, "{attempts} attempts, {first:e}, {later:e}");
}

#[test]
fn how_a_run_is_cut_does_not_matter_where_cells_open_at_once() {
    // Bodies that meet at different temperatures, and hot spots that grow until most of the ring is open.
    let cold_pad = |step: f64| {
        let scene = Application::read("cold_pad");
        let changes = [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.tolerance", 1e-3)];
        let mut drive = Drive::from_starts(&scene.starts, &changes);
        drive.set("sliding_velocity", 3.8).set("normal_load", 300.0).steps((10.0 / step).round() as u32, step);
        ["contact_temperature", "contact_temperature_max"].map(|name| drive.get(name) - 293.15)
    };
    let hot_spots = |step: f64| {
        let changes = [("solver.cells", 32.0), ("solver.tolerance", 1e-3)];
        let mut drive = Drive::from_starts(&scene("hot_spots"), &changes);
        drive.set("sliding_velocity", 0.2).set("normal_load", 200.0).steps((200.0 / step).round() as u32, step);
        ["contact_temperature_max", "pressure_max"].map(|name| drive.get(name))
    };
    // No tolerance covers the pressure of a spot that grows: at 1e-3 it is 6 % from that at 1e-5.
    let runs = [([cold_pad(10.0), cold_pad(0.1)], [1e-3, 1e-3]), ([hot_spots(200.0), hot_spots(2.0)], [1e-3, 3e-3])];
    for ([whole, parts], bounds) in runs {
        for ((whole, parts), bound) in whole.iter().zip(parts).zip(bounds) {
            assert!((whole / parts - 1.0).abs() < bound, "{whole} and {parts}");
        }
    }
}

/// Cells at the edge that open hot and close cold alternate; stepped in a 256th of the time of diffusion across a cell of steel, not in what
/// their marks on the phenolic last, they took four times the steps.
#[test]
fn cells_that_alternate_are_passed_in_steps_of_what_their_marks_last() {
    let changes = [("solver.fidelity", 3.0), ("solver.cells", 33.0), ("solver.tolerance", 1e-3)];
    let run = Application::read("saw_blade_guide").run(&changes).unwrap();
    assert!(run.steps < 20_000, "{}", run.steps);
}

/// The pads of a brake touch for the first time in a step of a millisecond, which a thousandth of `nominal.duration` does not resolve.
#[test]
fn a_first_touch_at_a_kilohertz_is_no_longer_step_than_others() {
    let own =
        [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.tolerance", 1e-2), ("nominal.duration", 1369.0)];
    let mut drive = Drive::from_starts(&scene("disc_brake"), &own);
    drive.set("sliding_velocity", 9.0).slope("normal_load", 5e3);
    let mut most = 0;
    for step in 0..1000 {
        let before = drive.0.work();
        drive.set("normal_load", 5.0 * f64::from(step)).step(1e-3);
        let now = drive.0.work();
        most = most.max(now.0 + now.1 - before.0 - before.1);
    }
    assert!(most <= 8, "{most} internal steps in a millisecond");
}

/// Where the velocity passes through 0 over a poor conductor, the operators of a velocity nearby are too far from those of the step: the
/// stages did not converge in steps of any length, as the linearization point stayed where it was.
#[test]
fn rings_of_poor_conductors_that_shake_keep_their_solution() {
    let changes = [("solver.cells", 17.0), ("solver.tolerance", 1e-3), ("nominal.duration", 20.0)];
    let mut drive = Drive::from_starts(&scene("hot_spots"), &changes);
    let velocity = |step: u32| 0.2 * (0.31 * f64::from(step)).sin();
    drive.set("normal_load", 200.0);
    for step in 0..30 {
        drive.set("sliding_velocity", velocity(step));
        drive.slope("sliding_velocity", (velocity(step + 1) - velocity(step)) / 0.01).step(0.01);
    }
    let (accepted, rejected) = drive.0.work();
    assert!(accepted + rejected < 2000, "{accepted} and {rejected} steps");
}
