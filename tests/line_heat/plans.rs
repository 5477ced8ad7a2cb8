//! Choices of `auto`, and runs beyond the planned conditions.

use model::plan::{self, model_level::ModelLevel};
use scene::Scene;
use scene::variables::{COUNT, STARTS};
use sliding_contact::component::{Component, Message, Snapshot, Subject};
use std::sync::Arc;
use test_support::{Drive, LUMPED, reference, scene};
use verification::applications;
use verification::applications::trial::{self, Setting};

/// A steel pin in a holder at 0.1 m/s, far below its critical speed: the thermal bulging of a tenth of a second exceeds the
/// elastic approach, which is immaterial under a given load, so that hours take a few steps.
#[test]
fn a_pin_that_its_heat_lifts_takes_long_steps_and_has_a_plan() {
    let mut starts = scene("pin_on_disk");
    let plan = plan::make(&Scene::new(&starts, None).unwrap(), steady::run_in).unwrap().plan;
    assert!(
        matches!(plan.model_level, ModelLevel::Line { .. })
            && plan.estimated_error.is_some_and(|error| error < plan::UNKNOWN),
        "{plan:?}"
    );
    for (name, value) in [("solver.fidelity", 3.0), ("solver.cells", 9.0), ("solver.tolerance", 1e-2)] {
        starts[reference(name) as usize] = value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component.set_input(0, 0.1);
    component.set_input(1, 10.0);
    component.step(200.0).unwrap();
    let before = component.work().0;
    component.step(3600.0).unwrap();
    assert!(component.work().0 - before <= 20, "{} steps", component.work().0 - before);
}

#[test]
fn what_can_only_be_lumped_stays_so() {
    let rigid = [("punch.body", 1.0), ("strip.body", 1.0), ("solver.tolerance", 1e-3)];
    let mut component = component(&rigid);
    let messages: Vec<String> = component.messages().map(|message| message.text.clone()).collect();
    assert!(messages[0].contains("auto takes lumped") && messages[0].contains("both bodies are rigid"), "{messages:?}");
    component.set_input(reference("sliding_velocity"), 5.0);
    component.set_input(reference("normal_load"), 2e3);
    component.step(1.0).unwrap();
    assert!(component.get(reference("wear_depth")) > 0.0);
}

#[test]
fn plans_are_made_by_the_tolerance_of_the_scene() {
    let plan = |own: f64, importer: Option<f64>| -> String {
        let mut starts = STARTS;
        for (name, value) in LUMPED_ENOUGH.iter().chain(&[("solver.tolerance", own)]) {
            starts[reference(name) as usize] = *value;
        }
        let mut component = Component::new(Arc::new(starts));
        component.enter_initialization();
        component.initialise(importer).unwrap();
        component.messages().next().unwrap().text.clone()
    };
    let default = plan(0.0, None);
    assert!(default.contains("tolerance 1e-3 from the default; auto takes line"), "{default}");
    let importer = plan(0.0, Some(0.2));
    assert!(importer.contains("tolerance 2e-1 from the importer; auto takes lumped"), "{importer}");
    let fine = plan(1e-3, Some(0.5));
    assert!(fine.contains("tolerance 1e-3 from solver.tolerance; auto takes line"), "{fine}");
    let rough = plan(0.5, Some(1e-3));
    assert!(rough.contains("auto takes lumped"), "{rough}");
}

fn component(changes: &[(&str, f64)]) -> Component {
    let mut starts = STARTS;
    for (name, value) in changes {
        starts[reference(name) as usize] = *value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component
}

/// Without thermal expansion, so that a coarse tolerance takes the lumped level; wear depends on the pressure nonlinearly.
const LUMPED_ENOUGH: &[(&str, f64)] = &[
    ("punch.thermal_expansion", 0.0),
    ("strip.thermal_expansion", 0.0),
    ("punch.wear_pressure_exponent", 1.3),
    ("nominal.duration", 100.0),
    ("solver.tolerance", 0.2),
];

/// Warnings since the last call.
fn warnings(component: &mut Component) -> Vec<String> {
    let of = |message: &Message| (message.subject == Subject::Warning).then(|| message.text.clone());
    component.messages().filter_map(of).collect()
}

#[test]
fn a_run_beyond_the_plan_keeps_its_level_says_so_once_and_its_error_grows_with_it() {
    let mut component = component(LUMPED_ENOUGH);
    let plan: Vec<String> = component.messages().map(|message| message.text.clone()).collect();
    assert!(plan[0].contains("auto takes lumped"), "{plan:?}");
    let set = |component: &mut Component, load: f64| {
        component.set_input(reference("sliding_velocity"), 10.0);
        component.set_input(reference("normal_load"), load);
    };
    set(&mut component, 4e3);
    (0..20).for_each(|_| component.step(1.0).unwrap());
    assert_eq!(warnings(&mut component).len(), 0);
    let error = component.get(reference("estimated_error"));
    assert!(error > 1e-4 && error < 0.3, "{error}");
    let mut saved = Snapshot::default();
    component.snapshot(&mut saved);
    // The same step from the same state on the lumped level, in bits.
    set(&mut component, 1.1e4);
    let mut stays = Drive::stock(&[LUMPED_ENOUGH, &[("solver.fidelity", LUMPED)]].concat());
    for load in std::iter::repeat_n(4e3, 20).chain([1.1e4; 2]) {
        stays.set("sliding_velocity", 10.0).set("normal_load", load).step(1.0);
    }
    component.step(1.0).unwrap();
    let said = warnings(&mut component);
    assert!(
        said.len() == 1 && said[0].contains("the run exceeds the conditions planned") && said[0].contains("11000 N"),
        "{said:?}"
    );
    component.step(1.0).unwrap();
    assert_eq!(warnings(&mut component).len(), 0);
    // 2.2 times the nominal load.
    let beyond_error = component.get(reference("estimated_error"));
    assert!(beyond_error > error && beyond_error < 0.9, "{beyond_error} after {error}");
    for name in ["wear_depth", "contact_temperature", "friction_force", "stored_heat", "pressure_max"] {
        assert_eq!(component.get(reference(name)).to_bits(), stays.get(name).to_bits(), "{name}");
    }
    // The record of the exceeded plan is part of the saved state, serialised as well.
    let (mut beyond, mut bytes) = (Snapshot::default(), Vec::new());
    component.snapshot(&mut beyond);
    beyond.encode(&mut bytes);
    component.restore(&saved).unwrap();
    assert_eq!(component.get(reference("estimated_error")), error);
    component.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
    assert_eq!(component.get(reference("estimated_error")), beyond_error);
    // Beyond ten times the nominal load it is unknown.
    set(&mut component, 5.1e4);
    component.step(1.0).unwrap();
    assert!(warnings(&mut component).iter().all(|text| !text.contains("exceeds the conditions planned")));
    assert_eq!(component.get(reference("estimated_error")), 1.0);
}

/// Estimated error of the disc brake at `speed` m/s and its nominal load for 20 s at the lumped level.
fn estimate(speed: f64, changes: &[(&str, f64)]) -> f64 {
    let mut starts = scene("disc_brake");
    for (name, value) in [("solver.fidelity", 1.0), ("solver.tolerance", 4e-2)].iter().chain(changes) {
        starts[reference(name) as usize] = *value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.set_run_duration(Some(20.0));
    component.enter_initialization();
    component.initialise(None).unwrap();
    let plan: Vec<String> = component.messages().map(|message| message.text.clone()).collect();
    assert!(plan[0].contains("auto takes lumped"), "{plan:?}");
    component.set_input(reference("sliding_velocity"), speed);
    component.set_input(reference("normal_load"), 2600.0);
    (0..20).for_each(|_| component.step(1.0).unwrap());
    component.get(reference("estimated_error"))
}

/// At the lumped level the heat of a run at half the speed bows the bodies half as much; without expansion it bows none.
#[test]
fn the_error_of_a_gentle_run_is_a_part_of_that_of_its_plan() {
    let errors = |changes: &[(&str, f64)]| [3.8, 1.9].map(|speed| estimate(speed, changes));
    let [nominal, gentle] = errors(&[]);
    assert!(gentle > 0.4 * nominal && gentle < 0.65 * nominal, "{nominal} {gentle}");
    let unbowed =
        [("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0), ("punch.wear_pressure_exponent", 1.3)];
    let [nominal, gentle] = errors(&unbowed);
    println!("{nominal} {gentle}");
    assert!(gentle > 0.8 * nominal, "{nominal} {gentle}");
}

#[test]
fn a_run_that_outlasts_its_plan_says_so_and_its_error_grows() {
    let mut component = component(&[LUMPED_ENOUGH, &[("nominal.duration", 4.0)]].concat());
    component.messages().for_each(drop);
    component.set_input(reference("sliding_velocity"), 5.0);
    component.set_input(reference("normal_load"), 2.5e3);
    // A quarter of nominal power: twice the planned work is done after 32 s.
    component.step(31.0).unwrap();
    assert_eq!(warnings(&mut component).len(), 0);
    component.step(2.0).unwrap();
    let said = warnings(&mut component);
    assert!(said.len() == 1 && said[0].contains("J of friction, planned for"), "{said:?}");
    let first = component.get(reference("estimated_error"));
    component.step(32.0).unwrap();
    let second = component.get(reference("estimated_error"));
    assert!(second > first && second < 1.0, "{first}, {second}");
    // Ten times the planned work after 160 s.
    component.step(100.0).unwrap();
    assert_eq!(component.get(reference("estimated_error")), 1.0);
}

/// A step that begins beyond the plan and ends within it leaves the plan: the first of a stop.
#[test]
fn the_beginning_of_a_step_counts() {
    for (slope, said) in [(-7.5, 1), (0.0, 0)] {
        let mut component = component(LUMPED_ENOUGH);
        component.messages().for_each(drop);
        // Nominal: 10 m/s.
        component.set_input(reference("sliding_velocity"), if slope == 0.0 { 10.0 } else { 25.0 });
        component.set_input(reference("normal_load"), 100.0);
        component.set_input_derivative(reference("sliding_velocity"), slope);
        component.step(2.0).unwrap();
        let warnings = warnings(&mut component);
        let of_plan =
            warnings.iter().filter(|text| text.contains("exceeds the conditions planned") && text.contains("25 m/s"));
        assert_eq!(of_plan.count(), said, "{warnings:?}");
    }
}

/// The highest speed of a sinusoid is 1.57 times its mean, which is within the plan. Changing the level at that speed raised the
/// highest temperature from 5.1 to 7.3 K within a step.
#[test]
fn a_sinusoid_stays_within_its_plan() {
    let mut starts = scene("reciprocating_punch");
    for (name, value) in [("solver.fidelity", 1.0), ("solver.tolerance", 1e-1)] {
        starts[reference(name) as usize] = value;
    }
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component.messages().for_each(drop);
    let velocity = |time: f64| 0.015 * (10.0 * time).cos();
    component.set_input(reference("normal_load"), 1e4);
    let (mut highest, mut jump): (f64, f64) = (0.0, 0.0);
    for step in 0..800 {
        let time = 0.01 * f64::from(step);
        component.set_input(reference("sliding_velocity"), velocity(time));
        component.set_input_derivative(reference("sliding_velocity"), (velocity(time + 0.01) - velocity(time)) / 0.01);
        component.step(0.01).unwrap();
        let now = component.get(reference("contact_temperature_max")) - 293.15;
        if step > 500 {
            jump = jump.max(now - highest);
        }
        highest = highest.max(now);
    }
    assert_eq!(warnings(&mut component), Vec::<String>::new());
    assert!(component.get(reference("estimated_error")) < 0.3);
    assert!(jump < 0.05 * highest, "{jump} K in a step of {highest} K");
}

/// The model error is unknown where no finer level was run: then the estimate is exactly 1, and the error of steps and reduction
/// is a separate output.
#[test]
fn a_level_that_was_not_compared_knows_the_error_of_its_steps_only() {
    for (fidelity, cells) in [(2.0, 0.0), (3.0, 9.0)] {
        let mut component =
            component(&[("solver.fidelity", fidelity), ("solver.cells", cells), ("solver.tolerance", 1e-2)]);
        component.set_input(reference("sliding_velocity"), 5.0);
        component.set_input(reference("normal_load"), 2e3);
        component.step(1.0).unwrap();
        assert_eq!(component.get(reference("estimated_error")), 1.0);
        let steps = component.get(reference("estimated_step_error"));
        assert!(steps > 0.0 && steps < 2e-2, "{steps}");
    }
    // Two rigid bodies have a uniform pressure on any cells: the error is that of the steps.
    let mut component = component(&[("punch.body", 1.0), ("strip.body", 1.0), ("solver.tolerance", 1e-2)]);
    component.set_input(reference("sliding_velocity"), 5.0);
    component.set_input(reference("normal_load"), 2e3);
    component.step(1.0).unwrap();
    let [whole, steps] = ["estimated_error", "estimated_step_error"].map(|name| component.get(reference(name)));
    assert!(whole == steps && whole < 2e-2, "{whole} {steps}");
}

/// A pad that its heat has bowed rests on its hottest cells once the load is released: the lumped level is off there by several times
/// its error under load, and a run that is not released must not be told so.
#[test]
fn the_error_after_a_release_is_told_once_the_load_is_released() {
    let all = applications::all().unwrap();
    let duty = all.iter().find(|scene| scene.name == "duty_1").unwrap();
    let truth = trial::fine_run(duty, 33, 2e-3).unwrap();
    let run = trial::run(duty, Setting::Auto, 1e-1).unwrap();
    assert_eq!(run.level, "lumped");
    let so_far = trial::errors_so_far(&run.main, &truth.main);
    let fall = duty.course.windows(2).position(|pair| pair[1][2] < 0.5 * pair[0][2]).unwrap();
    let [before, after] = [fall, run.main.len() - 1].map(|point| (trial::largest(so_far[point]), run.estimated[point]));
    assert!(after.0 > 2.0 * before.0 && after.1 > before.1, "{before:?} {after:?}");
    // The nominal course is loaded for 36 s, the run for 5 s before its first release: its error is that much smaller.
    for ((error, estimate), most) in [(before, 10.0), (after, 5.0)] {
        assert!((0.2..most).contains(&(estimate / error)), "{error:e}, estimated {estimate:e}");
    }
}

/// A light load for ten times the nominal duration: the error was that of the nominal conditions, ten times that of the run.
#[test]
fn the_error_of_a_contact_line_is_in_proportion_to_its_distance_from_the_lumped_level() {
    let all = applications::all().unwrap();
    let light = all.iter().find(|scene| scene.name == "light_2").unwrap();
    let run = trial::run(light, Setting::Auto, 1e-2).unwrap();
    assert_eq!(run.level, "line 9");
    let mut starts = light.starts.clone();
    for (name, value) in [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)] {
        starts[reference(name) as usize] = value;
    }
    let plan = plan::make(&Scene::new(&starts, None).unwrap(), steady::run_in).unwrap().plan;
    let [lumped, line] = [Setting::Lumped, Setting::Line(9)].map(|level| trial::run(light, level, 1e-2).unwrap());
    assert_eq!(line.main, run.main);
    let distance = trial::largest(trial::errors(&lumped.main, &line.main));
    let [uniform, _] = plan.lumped_errors.unwrap();
    let level = plan.estimated_error.unwrap() * distance / uniform;
    let expected = level.hypot(plan.step_ratios[0] * line.step_error);
    let [first, estimate] = [run.estimated[1], *run.estimated.last().unwrap()];
    assert!((estimate / expected - 1.0).abs() < 1e-9, "{estimate:e} for {expected:e}");
    assert!(distance < 0.3 * uniform && first < 1.0, "{distance:e} of {uniform:e}, {first:e} at first");
}

#[test]
fn a_restored_run_goes_on_with_its_lumped_level_in_parallel() {
    let auto = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)];
    let drive = |component: &mut Component, steps: std::ops::Range<u32>| {
        for step in steps {
            component.set_input(reference("sliding_velocity"), 10.0 - 0.3 * f64::from(step));
            component.set_input(reference("normal_load"), 3e3);
            component.set_input_derivative(reference("sliding_velocity"), -0.6);
            component.step(0.5).unwrap();
        }
    };
    let mut whole = component(&auto);
    drive(&mut whole, 0..10);
    assert!(whole.operators().unwrap().cells() > 1);
    let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
    whole.snapshot(&mut saved);
    saved.encode(&mut bytes);
    assert_eq!(bytes.len(), saved.encoded_size());
    let before = whole.get(reference("estimated_error"));
    drive(&mut whole, 10..20);
    let after: Vec<u64> = (0..COUNT as u32).map(|index| whole.get(index).to_bits()).collect();
    assert_ne!(whole.get(reference("estimated_error")), before);
    // Into a new component, and back into the same.
    for mut other in [component(&auto), whole] {
        other.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
        assert_eq!(other.get(reference("estimated_error")).to_bits(), before.to_bits());
        drive(&mut other, 10..20);
        let now: Vec<u64> = (0..COUNT as u32).map(|index| other.get(index).to_bits()).collect();
        assert!(now == after, "a replay differs");
    }
}

/// A short time above the critical speed: perturbations have no time to grow, and the error stays known. It was 1.
#[test]
fn the_error_stays_known_while_perturbations_hardly_grow() {
    let all = applications::all().unwrap();
    let stops = all.iter().find(|scene| scene.name == "stop_and_go_2").unwrap();
    assert!(trial::speed_ratio(stops).unwrap() > 1.2);
    let truth = trial::fine_run(stops, 17, 2e-3).unwrap();
    let run = trial::run(stops, Setting::Auto, 1e-1).unwrap();
    let error = trial::largest(trial::errors(&run.main, &truth.main));
    let estimate = run.estimated.last().copied().unwrap();
    assert!((0.5..10.0).contains(&(estimate / error)), "{error:e}, estimated {estimate:e}");
}

/// A stop time before the nominal duration shortens what levels are compared over; a saved state brings it along, and a level that is named
/// does not depend on it.
#[test]
fn a_level_is_chosen_for_the_time_that_the_run_lasts() {
    let of = |fidelity: f64, duration: Option<f64>| {
        let mut starts = scene("disc_brake");
        for (name, value) in [("solver.fidelity", fidelity), ("solver.tolerance", 1e-1)] {
            starts[reference(name) as usize] = value;
        }
        let mut component = Component::new(Arc::new(starts));
        component.set_run_duration(duration);
        component.enter_initialization();
        component.initialise(None).unwrap();
        component
    };
    let cells = |component: &Component| component.operators().unwrap().cells();
    let durations = [None, Some(f64::INFINITY), Some(1370.0), Some(93.0), Some(20.0), Some(1e-300), Some(0.0)];
    assert_eq!(durations.map(|duration| cells(&of(1.0, duration))), [9, 9, 9, 9, 1, 9, 9]);
    let step = |component: &mut Component| {
        component.set_input(reference("sliding_velocity"), 3.0);
        component.set_input(reference("normal_load"), 2e3);
        component.step(1.0).unwrap();
        (0..COUNT as u32).map(|index| component.get(index).to_bits()).collect::<Vec<_>>()
    };
    for (duration, planned) in [(20.0, 1), (f64::INFINITY, 9)] {
        let mut first = of(1.0, Some(duration));
        step(&mut first);
        let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
        first.snapshot(&mut saved);
        saved.encode(&mut bytes);
        assert_eq!(bytes.len(), saved.encoded_size());
        let mut other = of(1.0, None);
        other.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
        assert_eq!(cells(&other), planned);
        assert!(step(&mut other) == step(&mut first), "a replay differs");
    }
    let [short, long] = [Some(20.0), None].map(|duration| step(&mut of(2.0, duration)));
    assert!(short == long, "a named level depends on the stop time");
}
