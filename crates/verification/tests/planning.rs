//! Generated scenes, and plans for them judged by their truth.

use verification::planning::judge::{judge, truth};
use verification::planning::scenes::{Group, generate};

/// Generated scenes of three groups, quick ones among the first.
const SEEDS: [u64; 3] = [0, 3, 9];

#[test]
fn plans_meet_their_tolerance_at_the_cost_of_the_cheapest_setting() {
    for seed in SEEDS {
        let scene = generate(seed);
        let truth = truth(&scene, 17).unwrap();
        for tolerance in [1e-1, 1e-2] {
            let judged = judge(&scene, tolerance, &truth).unwrap();
            let name = scene.name();
            assert!(judged.chosen.error() <= tolerance, "{name} at {tolerance}: {judged:?}");
            let ratio = judged.cost_ratio().unwrap_or_else(|| panic!("{name}: no setting meets {tolerance}"));
            assert!(ratio <= 2.0, "{name} at {tolerance}: {ratio} times the cheapest: {judged:?}");
        }
    }
}

#[test]
fn generated_scenes_are_reproducible_and_of_every_group() {
    for (seed, group) in Group::ALL.into_iter().enumerate() {
        let [one, other] = [generate(seed as u64), generate(seed as u64)];
        assert_eq!(one.group, group);
        assert_eq!((&one.starts, &one.course), (&other.starts, &other.course));
        assert_ne!(one.starts, generate(seed as u64 + 5).starts);
        one.scene(1e-3).unwrap();
    }
}
