//! At rest every temperature stays between those of the bodies and their neighbours.

use super::{LEVELS, temperatures};
use crate::cuts::{Case, SCENES};
use test_support::Random;

#[test]
fn at_rest_temperatures_stay_between_those_of_bodies_and_neighbours() {
    for (level, changes) in LEVELS {
        for number in 0..4 * SCENES.len() as u64 {
            let mut random = Random(1 + number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let case = Case::new(SCENES[number as usize % SCENES.len()], &mut random);
            let Some(mut drive) = case.drive(changes) else { continue };
            // The surface of an insulator is counted at its initial temperature.
            let mut around = case.around.to_vec();
            around.extend(["punch.initial_temperature", "strip.initial_temperature"].map(|name| drive.get(name)));
            let [punch, strip, contact] = temperatures(&mut drive);
            around.extend([punch, strip]);
            let [low, high] = [f64::min, f64::max].map(|of| around.iter().copied().reduce(of).unwrap());
            // What the reductions of the bodies leave of a jump.
            let allowance = 2e-2 * (high - low);
            let bounds = low - allowance..=high + allowance;
            assert!(bounds.contains(&contact), "{level} {number} {case:?}: {contact} K at once, not in {bounds:?}");
            if random.next() < 0.5 {
                drive.set("normal_load", case.load * random.between(0.01, 1.0));
            }
            for _ in 0..3 {
                let step = 10f64.powf(random.between(-2.0, 3.5));
                drive.0.step(step).unwrap_or_else(|error| panic!("{level} {number} {case:?}: {error}"));
                let highest = drive.get("contact_temperature_max");
                for t in temperatures(&mut drive).into_iter().chain([highest]) {
                    assert!(bounds.contains(&t), "{level} {number} {case:?}: {t} K after {step} s, not in {bounds:?}");
                }
            }
        }
    }
}
