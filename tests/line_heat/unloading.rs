//! A load taken off within milliseconds: cells open, at once or one after another, and what flowed from the hotter body to the colder
//! one stops.

use test_support::{Drive, scene};

/// Rise of the contact temperature over the initial one (K) after `count` steps of `step` s at this speed (m/s) and load (N), and after
/// `released` N of the load have gone within `ramp` s.
fn dragged_and_unloaded(
    drive: &mut Drive,
    (speed, load): (f64, f64),
    (count, step): (u32, f64),
    (released, ramp): (f64, f64),
) -> [f64; 2] {
    let initial = drive.get("contact_temperature");
    drive.set("sliding_velocity", speed).set("normal_load", load).steps(count, step);
    let pressed = drive.get("contact_temperature");
    drive.set("normal_load", load).slope("normal_load", -released / ramp).step(ramp);
    [pressed - initial, drive.get("contact_temperature") - initial]
}

/// The errors of both rises are within the tolerance.
fn assert_tolerance_is_kept(rises: fn(f64) -> [f64; 2]) {
    let exact = rises(1e-5);
    for tolerance in [1e-2, 1e-3] {
        let found = rises(tolerance);
        let errors = [0, 1].map(|i| (found[i] - exact[i]).abs() / exact[0]);
        println!("{tolerance:e}: {errors:?} of {exact:?}");
        assert!(errors.iter().all(|error| *error <= tolerance), "{tolerance:e}: {errors:?}");
    }
}

/// Rise of the contact temperature over the initial one (K) after a long drag and after the load has been taken off, of a badly
/// conducting lining on 9 cells.
fn rises(tolerance: f64) -> [f64; 2] {
    const LOAD: f64 = 4800.0;
    let changes = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 9.0),
        ("solver.tolerance", tolerance),
        ("contact.conductance", 15e3),
        ("contact.friction_coefficient", 0.28),
        ("punch.width", 0.074),
        ("depth", 0.026),
        ("punch.conductivity", 1.6),
        ("nominal.load", LOAD),
        ("nominal.velocity", 1.1),
        ("nominal.duration", 54.0),
    ];
    let mut drive = Drive::from_starts(&scene("disc_brake"), &changes);
    dragged_and_unloaded(&mut drive, (1.1, LOAD), (12, 2.25), (LOAD, 0.023))
}

#[test]
fn a_load_taken_off_fast_keeps_the_tolerance() {
    assert_tolerance_is_kept(rises);
}

/// Rise of the contact temperature over the initial one (K) after a long drag and after all but 3 % of the load has been taken
/// off, of a compliant pad whose hot middle carries the rest.
fn rises_of_bulging_pad(tolerance: f64) -> [f64; 2] {
    const LOAD: f64 = 870.0;
    let changes = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 17.0),
        ("solver.tolerance", tolerance),
        ("contact.conductance", 15e3),
        ("contact.friction_coefficient", 0.31),
        ("contact.mean_radius", 0.18),
        ("punch.width", 0.069),
        ("depth", 0.028),
        ("punch.height", 0.0067),
        ("punch.youngs_modulus", 350e6),
        ("punch.conductivity", 4.9),
        ("strip.height", 0.022),
        ("nominal.load", LOAD),
        ("nominal.velocity", 5.7),
        ("nominal.duration", 72.0),
    ];
    let mut drive = Drive::from_starts(&scene("disc_brake"), &changes);
    let rises = dragged_and_unloaded(&mut drive, (5.7, LOAD), (12, 1.5), (0.97 * LOAD, 0.05));
    assert!(drive.get("contact_fraction") < 0.6, "{}", drive.get("contact_fraction"));
    rises
}

#[test]
fn cells_that_open_one_after_another_do_not_add_up_their_errors() {
    assert_tolerance_is_kept(rises_of_bulging_pad);
}

/// Contact problems solved in an unloaded second that follows a stop, and the contact temperature (K) after it, where the load of
/// the open contact ends at `rest` (N).
fn after_a_stop(rest: f64) -> (u64, f64) {
    const LOAD: f64 = 4800.0;
    let changes = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 9.0),
        ("solver.tolerance", 1e-2),
        ("nominal.load", LOAD),
        ("nominal.velocity", 8.0),
        ("nominal.duration", 54.0),
    ];
    let mut drive = Drive::from_starts(&scene("disc_brake"), &changes);
    drive.set("sliding_velocity", 8.0).set("normal_load", LOAD);
    drive.step(2.0).set("normal_load", 0.0).step(1.0);
    let before = drive.0.contact_work().solves;
    drive.set("normal_load", 0.0).slope("normal_load", rest);
    drive.step(1.0);
    (drive.0.contact_work().solves - before, drive.get("contact_temperature"))
}

/// An importer that interpolates its inputs leaves rounding where the load is to be 0.
#[test]
fn a_load_of_rounding_leaves_the_contact_open() {
    let open = after_a_stop(0.0);
    for rest in [1e-14, 1e-12, 4e-9] {
        assert_eq!(after_a_stop(rest), open, "{rest:e} N");
    }
    // A load that an importer means closes it: the hotter disc heats the pad, and steps resolve it.
    assert!(after_a_stop(1e-3).0 > 10 + open.0);
}
