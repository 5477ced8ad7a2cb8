//! Jumps over cycles on a straight track where both bodies wear, beside time integration of every cycle.

use analyses::cycles::{Options, advance};
use scene_file::{SceneFile, assign};
use test_support::{Drive, examples};

const CYCLES: u32 = 400;

/// The published fretting test, in which 400 cycles wear ten times the elastic approach.
fn fretting(changes: &[&str]) -> SceneFile {
    let mut file = scene_file::read(&examples().join("published/fretting/scene.toml")).unwrap();
    let fewer = ["solver.cells=33", "wear_acceleration=30"];
    fewer.iter().chain(changes).for_each(|text| assign(&mut file, text).unwrap());
    file
}

/// Largest worn depths of punch and strip at the stations, and worn volumes per area, by steps through every cycle.
fn stepped(file: &SceneFile) -> [f64; 4] {
    let mut drive = Drive::from_starts(&file.packaged.starts, &[]);
    drive.set("normal_load", 185.0);
    for _ in 0..CYCLES {
        for velocity in [1e-4, -1e-4, -1e-4, 1e-4] {
            drive.set("sliding_velocity", velocity).step(0.25);
        }
    }
    let mut deepest = |name: &str| drive.profile(name).into_iter().fold(0.0, f64::max);
    let [punch, strip] = [deepest("wear_punch"), deepest("wear_strip")];
    let area = drive.area();
    [punch, strip, drive.get("wear_volume_punch") / area, drive.get("wear_volume_strip") / area]
}

#[test]
fn jumps_end_where_time_integration_of_every_cycle_ends() {
    for changes in [&[][..], &["contact.tangential_compliance=elastic"], &["punch.wear_coefficient=0"]] {
        let file = fretting(changes);
        let expected = stepped(&file);
        let options = Options { cycles: f64::from(CYCLES), tolerance: 0.1, ..Options::default() };
        let history = advance(&file, &options, &mut |_, _| {}).unwrap();
        let last = history.stations.last().unwrap();
        assert_eq!(last.jump.cycles, f64::from(CYCLES));
        assert!(last.jump.computed < 130, "{} cycles computed", last.jump.computed);
        let deepest = |depth: &[f64]| depth.iter().copied().fold(0.0, f64::max);
        let found =
            [deepest(&history.depth), deepest(history.strip_depth.as_ref().unwrap()), last.worn[0], last.worn[1]];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 0.005 * expected, "{changes:?}: {found:e} {expected:e}");
        }
    }
}

#[test]
fn heat_on_a_worn_track_is_refused_by_name() {
    let mut file = fretting(&["punch.thermal_expansion=1e-5", "punch.conductivity=40"]);
    assign(&mut file, "solver.heat=resolved").unwrap();
    let run = |cold: bool| advance(&file, &Options { cycles: 3.0, cold, ..Options::default() }, &mut |_, _| {});
    let refused = run(false).err().unwrap().to_string();
    assert!(refused.contains("straight track that wears") && refused.contains("cold"), "{refused}");
    assert_eq!(run(true).unwrap().stations.last().unwrap().jump.cycles, 3.0);
}
