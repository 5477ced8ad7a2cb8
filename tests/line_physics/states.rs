//! Saved states: replay to the bit, and states that do not fit.

use super::contact::line;
use sliding_contact::component::Snapshot;

#[test]
fn a_replay_gives_the_same_bits() {
    let scenes: [&[(&str, f64)]; 5] = [
        &[],
        &[("punch.wear_pressure_exponent", 0.6), ("contact.initial_shape", 2.0), ("contact.initial_radius", 60.0)],
        &[("strip.path", 1.0), ("strip.length", 0.0), ("strip.wear_coefficient", 1e-13), ("nominal.stroke", 0.02)],
        &[("holder.stiffness", 1e8), ("holder.constraint", 2.0), ("holder.pivot_height", 0.02)],
        &[("contact.friction_fade.factor[3]", 0.6), ("contact.stick_stiffness", 1e6), ("contact.stick_damping", 1e3)],
    ];
    for changes in scenes {
        let changes = [changes, &[("solver.cells", 17.0), ("punch.wear_coefficient", 4e-13)]].concat();
        let mut drive = line(&changes);
        drive.strokes(0..7, 0.3, 0.5);
        let straight_on = drive.assert_replay(line(&changes), |drive| drive.strokes(7..30, 0.3, 0.5));
        // Looking at outputs for other inputs changes nothing.
        for load in [0.0, 2e4, 100.0] {
            drive.set("normal_load", load).get("pressure_max");
            drive.set("sliding_velocity", -load).get("profile.pressure[5]");
        }
        assert_eq!(straight_on, drive.strokes(7..30, 0.3, 0.5), "{changes:?}: after looking");
    }
}

#[test]
fn a_state_of_another_number_of_cells_is_refused() {
    let mut saved = Snapshot::default();
    line(&[("solver.cells", 17.0)]).0.snapshot(&mut saved);
    let text = line(&[("solver.cells", 65.0)]).0.restore(&saved).unwrap_err();
    assert!(text.contains("do not fit"), "{text}");
}
