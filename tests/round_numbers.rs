//! Round numbers, as users type them: every shipped scene, at every level, driven with velocities, loads, slopes and steps from
//! {0, 1, 2, 5} x 10^k and their halves and quarters, from rest and through zero, with held and linear inputs.
//!
//! A successful step gives finite outputs; a failed one states the reason and leaves the state unchanged. Moderate inputs do not
//! fail. `cargo test` takes a deterministic selection of the runs; `ROUND_NUMBERS=12000` makes that many.

use scene::variables::{STARTS, ValueReference, find};
use sliding_contact::component::{Component, Values};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

const VELOCITY: ValueReference = 0;
const LOAD: ValueReference = 1;
const OUTPUTS: std::ops::Range<ValueReference> = 7..250;

/// Numbers in the order of their indices (W. Weyl's sequence through a bit mixer: D. Steele et al., OOPSLA 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// {0, 1, 2, 5} x 10^k, their halves and quarters, with k from `low` to `high`.
    fn round(&mut self, low: i32, high: i32) -> f64 {
        let mantissa = [0.0, 1.0, 2.0, 5.0, 1.0, 2.0, 5.0][self.below(7) as usize];
        let part = [1.0, 0.5, 0.25][self.below(3) as usize];
        let exponent = low + self.below((high - low + 1) as u64) as i32;
        // As typed, not as multiplied.
        format!("{}e{exponent}", mantissa * part).parse().unwrap()
    }

    fn positive(&mut self, low: i32, high: i32) -> f64 {
        loop {
            let number = self.round(low, high);
            if number > 0.0 {
                return number;
            }
        }
    }

    fn signed(&mut self, low: i32, high: i32) -> f64 {
        let sign = if self.below(2) == 0 { 1.0 } else { -1.0 };
        sign * self.round(low, high)
    }
}

/// A communication step: inputs, their derivatives (held where there are none) and its length.
#[derive(Clone, Copy, Debug)]
struct Drive {
    velocity: f64,
    load: f64,
    slopes: Option<[f64; 2]>,
    step: f64,
}

impl Drive {
    /// The three steps of run `number`.
    fn of(number: u64) -> [Drive; 3] {
        let mut numbers = Numbers(number);
        let path = numbers.below(6);
        let step = numbers.positive(-3, 1);
        let mut drives =
            [(); 3].map(|()| Drive { velocity: numbers.signed(-3, 2), load: numbers.round(0, 4), slopes: None, step });
        let slopes = [(); 3].map(|()| [numbers.signed(-2, 2), numbers.signed(0, 4)]);
        match path {
            // Held, from rest, and a jump through zero.
            0 => drives[0].velocity = 0.0,
            1 => drives[1].velocity = -drives[0].velocity,
            // Linear, from rest; through zero inside the step; and onto zero, and on from there.
            2 => {
                drives[0].velocity = 0.0;
                for (drive, slopes) in drives.iter_mut().zip(slopes) {
                    drive.slopes = Some(slopes);
                }
            }
            3 => {
                for (drive, slopes) in drives.iter_mut().zip(slopes) {
                    drive.slopes = Some([-2.0 * drive.velocity / drive.step, slopes[1]]);
                }
            }
            4 => {
                let slope = -drives[0].velocity / step;
                for (number, drive) in drives.iter_mut().enumerate() {
                    drive.velocity = if number == 0 { drive.velocity } else { f64::NAN };
                    drive.slopes = Some([slope, 0.0]);
                }
            }
            // As the integrator of a plant gives it, with all the steps on one line.
            _ => {
                for (number, drive) in drives.iter_mut().enumerate() {
                    (drive.velocity, drive.slopes) = (f64::NAN, Some(slopes[0]));
                    if number == 0 {
                        drive.velocity = 0.0;
                    }
                }
            }
        }
        drives
    }

    /// Whether the inputs are moderate, so that the step must succeed: speeds and loads not far beyond those of the scene.
    fn is_tame(&self, scene: &Scene) -> bool {
        let slopes = self.slopes.unwrap_or_default();
        let most = |value: f64, slope: f64| {
            let value = if value.is_nan() { 0.0 } else { value };
            value.abs().max((value + 3.0 * slope * self.step).abs())
        };
        most(self.velocity, slopes[0]) <= 2.0 * scene.velocity && most(self.load, slopes[1]) <= 2.0 * scene.load
    }
}

/// A scene at a level.
struct Scene {
    name: String,
    component: Component,
    load: f64,
    velocity: f64,
}

fn start_values(name: &str) -> Values {
    if name == "stock" { STARTS } else { test_support::scene(name) }
}

/// All shipped scenes and the stock one, in the order of their names.
fn names() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(test_support::examples())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("scene.toml").exists())
        .map(|path| path.file_name().unwrap().to_str().unwrap().into())
        .collect();
    names.push("stock".into());
    names.sort();
    names
}

fn scene(name: &str, fidelity: f64, cells: f64, tolerance: f64) -> Scene {
    let starts = test_support::changed(
        &start_values(name),
        &[("solver.fidelity", fidelity), ("solver.cells", cells), ("solver.tolerance", tolerance)],
    );
    let index = |name: &str| find(name).unwrap() as usize;
    let (load, velocity) = (starts[index("nominal.load")], starts[index("nominal.velocity")]);
    let level = ["auto", "lumped", "line"][fidelity as usize - 1];
    let name = format!("{name} {level} {cells} {tolerance:e}");
    Scene { name, component: Component::new(Arc::new(starts)), load, velocity }
}

/// Scenes and levels with the share of the runs that each takes.
fn scenes(full: bool) -> Vec<(Scene, u64)> {
    let mut scenes = Vec::new();
    for name in names() {
        scenes.push((scene(&name, 2.0, 0.0, 1e-2), 8));
        scenes.push((scene(&name, 2.0, 0.0, 1e-4), 4));
        scenes.push((scene(&name, 3.0, 9.0, 1e-1), 4));
        scenes.push((scene(&name, 3.0, 8.0, 1e-2), 2));
        if full {
            scenes.push((scene(&name, 3.0, 17.0, 1e-2), 4));
            scenes.push((scene(&name, 3.0, 33.0, 1e-1), 1));
            scenes.push((scene(&name, 3.0, 3.0, 1e-2), 4));
            scenes.push((scene(&name, 1.0, 0.0, 1e-2), 1));
        }
    }
    scenes
}

fn outputs(component: &mut Component) -> Vec<f64> {
    OUTPUTS.map(|output| component.get(output)).collect()
}

/// Adds what is wrong with a run to the `defects`.
fn run(scene: &mut Scene, number: u64, defects: &mut Vec<String>) {
    let component = &mut scene.component;
    component.reset();
    component.enter_initialization();
    component.initialise(None).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
    let drives = Drive::of(number);
    for (index, drive) in drives.iter().enumerate() {
        let label = format!("{} run {number} step {index} {drives:?}", scene.name);
        let component = &mut scene.component;
        if !drive.velocity.is_nan() {
            component.set_input(VELOCITY, drive.velocity);
        }
        component.set_input(LOAD, drive.load);
        if let Some([velocity, load]) = drive.slopes {
            component.set_input_derivative(VELOCITY, velocity);
            component.set_input_derivative(LOAD, load);
        }
        let before = outputs(component);
        let outcome = component.step(drive.step);
        let after = outputs(component);
        match outcome {
            Ok(()) => {
                if let Some(bad) = OUTPUTS.zip(&after).find(|(_, value)| !value.is_finite()) {
                    defects.push(format!("not finite {bad:?}: {label}"));
                    return;
                }
            }
            Err(error) => {
                if before != after {
                    defects.push(format!("changed by a failed step ({error}): {label}"));
                }
                let tame = drives.iter().all(|drive| drive.is_tame(scene));
                if tame && !error.contains("worn through") {
                    defects.push(format!("{error}: {label}"));
                }
                return;
            }
        }
    }
}

#[test]
fn round_numbers_neither_crash_nor_leave_numbers_that_are_none() {
    let asked = std::env::var("ROUND_NUMBERS").ok().and_then(|runs| runs.parse::<u64>().ok());
    let runs = asked.unwrap_or(400);
    let mut scenes = scenes(asked.is_some());
    let shares: u64 = scenes.iter().map(|(_, share)| share).sum();
    let mut defects = Vec::new();
    let mut number = 0;
    for (scene, share) in &mut scenes {
        for _ in 0..(runs * *share).div_ceil(shares) {
            number += 1;
            if catch_unwind(AssertUnwindSafe(|| run(scene, number, &mut defects))).is_err() {
                defects.push(format!("panic: {} run {number} {:?}", scene.name, Drive::of(number)));
            }
        }
    }
    assert!(defects.is_empty(), "{} defects:\n{}", defects.len(), defects.join("\n"));
}

/// From rest with all defaults: the drift of a wave over the step is one rounding above the largest that its series takes.
#[test]
fn the_stock_scene_starts_from_rest_with_a_round_slope() {
    let mut starts = STARTS;
    starts[find("solver.tolerance").unwrap() as usize] = 0.0;
    let mut component = Component::new(Arc::new(starts));
    for slope in [4.0, 3.0, 2.0, 1.0, 0.5, -4.0] {
        component.reset();
        component.enter_initialization();
        component.initialise(None).unwrap();
        component.set_input(VELOCITY, 0.0);
        component.set_input(LOAD, 4000.0);
        component.set_input_derivative(VELOCITY, slope);
        component.step(0.1).unwrap();
        assert!(outputs(&mut component).iter().all(|value| value.is_finite()), "slope {slope}");
    }
}

/// A pressure on one cell or two has no shape; three cells work in every scene, also where `auto` compares them with fewer.
#[test]
fn cells_below_three_are_refused_by_name_value_and_limit() {
    for name in names() {
        for fidelity in [1.0, 3.0] {
            for cells in [1.0, 2.0] {
                let mut scene = scene(&name, fidelity, cells, 1e-1);
                scene.component.enter_initialization();
                outputs(&mut scene.component);
                match scene.component.initialise(None) {
                    Err(error) => {
                        assert!(
                            error.contains(&format!("solver.cells = {cells} must be 0 (automatic) or at least 3")),
                            "{error}"
                        );
                    }
                    Ok(()) => panic!("{} is accepted", scene.name),
                }
            }
        }
        for (fidelity, cells) in [(1.0, 3.0), (1.0, 4.0), (3.0, 3.0), (3.0, 4.0), (2.0, 1.0)] {
            let mut scene = scene(&name, fidelity, cells, 1e-1);
            scene.component.enter_initialization();
            scene.component.initialise(None).unwrap();
            scene.component.set_input(VELOCITY, scene.velocity);
            scene.component.set_input(LOAD, scene.load);
            scene.component.step(0.1).unwrap();
            assert!(outputs(&mut scene.component).iter().all(|value| value.is_finite()), "{}", scene.name);
        }
    }
}

/// A strip with a worn track moves a quarter of the half-width per internal step: 100 km need more steps than the limit.
#[test]
fn a_step_that_needs_too_much_work_says_how_much_and_changes_nothing() {
    let mut scene = scene("reciprocating_punch", 3.0, 3.0, 1e-1);
    let changes =
        [("strip.wear_coefficient", 1e-20), ("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
    for (name, value) in changes {
        scene.component.set_parameter(find(name).unwrap(), value);
    }
    scene.component.enter_initialization();
    scene.component.initialise(None).unwrap();
    scene.component.set_input(VELOCITY, 100.0);
    scene.component.set_input(LOAD, 1e3);
    scene.component.step(0.01).unwrap();
    let before = outputs(&mut scene.component);
    let error = scene.component.step(1000.0).unwrap_err();
    for part in
        ["exceeds the work limit", "after 200000 internal steps (at most 200000)", "of a piece of 1000 s", "3 cells"]
    {
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(before, outputs(&mut scene.component));
}
