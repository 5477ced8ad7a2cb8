//! Choice of the automatic model level, and cost of the levels compared.

use model::INPUTS;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use model::plan::course::Course;
use model::plan::prepared::Prepared;
use model::plan::trajectory::NominalTrajectory;
use model::plan::{self, model_level::ModelLevel};
use scene::variables::{STARTS, reference};
use scene::{Fidelity, HeatResolution, Scene};
use test_support::{changed_scene, scene};
use verification::planning::runs;
use verification::planning::scenes::{Group, generate};

#[test]
fn the_same_scene_has_the_same_plan() {
    let scene = generate(5).scene(1e-2).unwrap();
    let [one, other] = [plan::make(&scene, steady::run_in).unwrap(), plan::make(&scene, steady::run_in).unwrap()];
    assert_eq!(one.plan, other.plan);
    assert!(one.plan.candidates.len() > 5 && one.plan.effects.len() == 8, "{:#?}", one.plan);
}

/// Premises of the choice: refinement reduces the error and raises the cost, and no candidate cheaper than the chosen
/// one is accurate enough.
#[test]
fn finer_cells_have_smaller_errors_at_a_higher_cost_and_the_cheapest_that_suffices_is_chosen() {
    let plan = plan::make(&generate(5).scene(1e-2).unwrap(), steady::run_in).unwrap().plan;
    for heat in [HeatResolution::Lumped, HeatResolution::Resolved] {
        let mut alike: Vec<_> =
            plan.candidates.iter().filter(|candidate| candidate.model_level.heat() == Some(heat)).collect();
        alike.sort_by_key(|candidate| candidate.model_level.cells());
        assert!(heat == HeatResolution::Lumped || alike.len() >= 3, "{plan:#?}");
        for pair in alike.windows(2) {
            assert!(pair[1].cost > pair[0].cost && pair[1].run_cost > pair[0].run_cost, "{plan:#?}");
            // Lumped heat is the same on all cells, and with it the errors of temperature and force.
            let (fewer, more) = (pair[0].error(), pair[1].error());
            let falls = more < fewer || heat == HeatResolution::Lumped && more == fewer;
            assert!(falls, "{plan:#?}");
        }
    }
    let chosen = plan.candidates.iter().find(|candidate| candidate.model_level == plan.model_level).unwrap();
    assert!(plan.meets && chosen.error() <= 1e-2, "{plan:#?}");
    for candidate in plan.candidates.iter().filter(|candidate| candidate.run_cost < chosen.run_cost) {
        assert!(candidate.error() > 0.9e-2, "{candidate:?} is cheaper and good enough: {plan:#?}");
    }
}

/// Counted work: no clock is asked.
#[test]
fn planning_costs_what_it_may_and_covers_the_nominal_duration() {
    for seed in [1, 5, 7, 12, 18, 24] {
        let generated = generate(seed);
        for tolerance in [1e-1, 1e-2] {
            let plan = plan::make(&generated.scene(tolerance).unwrap(), steady::run_in).unwrap().plan;
            let name = format!("{} at {tolerance:e}: {plan:#?}", generated.name());
            assert!(plan.planning_cost <= 250e3 && plan.compared_steps > 20, "{name}");
            let repeated = generated.group == Group::Reciprocating;
            assert!(plan.covered >= 0.2 || repeated, "{name}");
        }
    }
}

/// Above the critical speed of thermoelastic instability waves grow from what the cells leave over: no number of cells agrees with another.
#[test]
fn above_the_critical_speed_the_error_is_not_known() {
    let changes = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)];
    let plan = plan::make(&changed_scene(&scene("hot_spots"), &changes), steady::run_in).unwrap().plan;
    assert!(plan.groups.speed_over_critical > 1.0, "{plan:#?}");
    assert!(!plan.meets && plan.estimated_error == Some(plan::UNKNOWN), "{plan:#?}");
    assert!(matches!(plan.model_level, ModelLevel::Line { heat: HeatResolution::Resolved, .. }), "{plan:#?}");
}

/// Where the temperature rise by the whole friction heat would more than cancel the friction, the friction of the
/// previous iteration alternates however short the step is, and stepping ended without a solution.
#[test]
fn friction_that_fades_within_the_rise_of_the_first_moment_is_solved() {
    let generated = generate(113);
    let [coarse, fine] = [17, 33].map(|cells| {
        let scene = ModelLevel::Line { cells, heat: HeatResolution::Resolved }.apply(&generated.scene(1e-2).unwrap());
        runs::run(&generated, &scene).unwrap()
    });
    let errors = runs::distance(&coarse, &fine);
    assert!(errors.iter().all(|error| *error < 0.02), "{errors:?}");
}

/// With many cells and their heat a stage's wear is found to rounding only, above what Newton's method asks for: not taken as found, it was
/// stepped in picoseconds.
#[test]
fn wear_is_found_to_rounding_at_129_cells() {
    let generated = generate(120);
    let model_level = ModelLevel::Line { cells: 129, heat: HeatResolution::Resolved };
    let operators = ModelOperators::new(&model_level.apply(&generated.scene(1e-4).unwrap()), steady::run_in).unwrap();
    let record = runs::run_with(&generated, &operators).unwrap();
    println!("{:?} internal steps", record.steps);
    assert!(record.steps.0 < 10_000, "{:?}", record.steps);
}

fn plan_of(name: &str, tolerance: f64) -> plan::Plan {
    plan_of_run(name, tolerance, f64::INFINITY)
}

/// Plan for a run that ends after `duration` s.
fn plan_of_run(name: &str, tolerance: f64, duration: f64) -> plan::Plan {
    let scene = changed_scene(&scene(name), &[("solver.fidelity", 1.0), ("solver.tolerance", tolerance)]);
    plan::make(&scene.for_run_of(Some(duration)), steady::run_in).unwrap().plan
}

/// Over its nominal 93 s of braking the lumped level is off by 0.1, over a stop of 20 s by a fifth of that.
#[test]
fn a_stop_of_a_disc_brake_needs_no_more_than_the_lumped_level() {
    let whole = plan_of("disc_brake", 1e-1);
    assert!((whole.duration, whole.model_level.cells()) == (93.0, 9) && whole.meets, "{whole:#?}");
    let plan = plan_of_run("disc_brake", 1e-1, 20.0);
    assert_eq!(plan.duration, 20.0);
    assert_eq!(plan.model_level, ModelLevel::Lumped, "{plan:#?}");
    assert!(plan.meets && plan.estimated_error.is_some_and(|error| error > 1e-4), "{plan:#?}");
}

/// The first segment at whose end a part of the zone is not in contact, on 9 cells over the nominal course; `None` where there is none under
/// load.
fn parted_under_load(scene: &Scene) -> Option<usize> {
    let course = NominalTrajectory::new(scene).unwrap();
    let line = ModelLevel::Line { cells: 9, heat: HeatResolution::Resolved }.apply(scene);
    let run = course.run(&ModelOperators::new(&line, steady::run_in).unwrap(), 10_000).unwrap();
    run.parted.filter(|&segment| segment < course.loaded)
}

/// The pad of the disc brake lifts off at its ends once it is hot, and not at all under load where nothing expands.
#[test]
fn a_contact_parts_where_it_opens_and_not_before() {
    let brake = scene("disc_brake");
    let at = parted_under_load(&changed_scene(&brake, &[]));
    assert!(at.is_some_and(|segment| segment > 0), "{at:?}");
    let without_expansion = [("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
    assert_eq!(parted_under_load(&changed_scene(&brake, &without_expansion)), None);
}

/// Held at full slip for its whole duration, the clutch gets bands, which its mean knows nothing of.
#[test]
fn a_clutch_at_full_slip_needs_its_heat_along_the_radius() {
    let plan = plan_of("clutch", 5e-2);
    assert!(matches!(plan.model_level, ModelLevel::Line { heat: HeatResolution::Resolved, .. }), "{plan:#?}");
    let distortion = plan.effects.iter().find(|effect| effect.name == "thermal distortion").unwrap();
    assert!(distortion.kept, "{plan:#?}");
}

/// A model at a level, and its inputs.
fn on(model_level: ModelLevel, scene: &Scene, inputs: &[f64; INPUTS]) -> Model {
    let tunables = Tunables {
        friction_coefficient: scene.friction_coefficient,
        ambient_temperature: scene.ambient_temperature,
        wear_acceleration: 1.0,
    };
    Model::new(&ModelOperators::new(&model_level.apply(scene), steady::run_in).unwrap(), tunables, inputs)
}

/// Open, or standing under load, a contact line whose heat is the mean's solves no contact. With heat on the cells an open one
/// factors nothing, and a standing one solves less in a step than a sliding one.
#[test]
fn an_open_or_standing_contact_pays_for_conduction_only() {
    let scene = Scene::new(&STARTS, None).unwrap();
    let ambient = scene.ambient_temperature;
    for heat in [HeatResolution::Lumped, HeatResolution::Resolved] {
        let run = [5.0, 3e3, 0.0, 0.0, 0.0, ambient, ambient];
        let mut model = on(ModelLevel::Line { cells: 17, heat }, &scene, &run);
        let mut work = |inputs: [f64; INPUTS]| {
            // Two steps to settle in.
            (0..2).for_each(|_| model.step(&inputs, None, 0.1).unwrap());
            let (before, steps) = (model.contact_work(), model.work());
            (0..20).for_each(|_| model.step(&inputs, None, 0.1).unwrap());
            let after = model.contact_work();
            let now = model.work();
            (
                after.solves - before.solves,
                after.factorisations - before.factorisations,
                now.0 - steps.0,
                now.1 - steps.1,
            )
        };
        let sliding = work(run);
        let standing = work([0.0, 3e3, 0.0, 0.0, 0.0, ambient, ambient]);
        let open = work([5.0, 0.0, 0.0, 0.0, 0.0, ambient, ambient]);
        let work = format!("{heat:?}: sliding {sliding:?}, standing {standing:?}, open {open:?}");
        println!("{work}");
        assert!(sliding.0 >= 40, "{work}");
        if heat == HeatResolution::Lumped {
            assert_eq!((standing.0, open.0), (0, 0), "{work}");
        } else {
            assert_eq!((open.1, open.3), (0, 0), "{work}");
            assert!(open.0 <= open.2, "{work}");
            // Standing, the distortion fades and shifts the pressure: a solution for each of two stages, none repeated.
            assert!(standing.0 <= 2 * standing.2, "{work}");
        }
    }
}

/// Accelerated wear is refused on a contact line where it hides growth; a comparison of levels, which wears fast itself, is not.
#[test]
fn accelerated_wear_is_compared_as_well() {
    let changes = [("wear_acceleration", 10.0), ("nominal.duration", 2.5), ("solver.tolerance", 1e-2)];
    let plan = plan::make(&changed_scene(&scene("reciprocating_punch"), &changes), steady::run_in).unwrap().plan;
    assert!(matches!(plan.model_level, ModelLevel::Line { heat: HeatResolution::Resolved, .. }), "{plan:#?}");
    assert!(plan.meets && plan.estimated_error.is_some_and(|error| error < 1e-2), "{plan:#?}");
}

/// Beyond twice the nominal conditions the error of the level is in proportion to them; beyond ten times it is unknown.
#[test]
fn the_error_of_the_level_is_extrapolated_beyond_the_nominal_conditions() {
    let mut scene = generate(5).scene(1e-2).unwrap();
    scene.fidelity = Fidelity::Auto;
    let prepared = Prepared::new(&scene, steady::run_in).unwrap();
    let [speed, load] = [scene.nominal_velocity, scene.nominal_load];
    assert_eq!(prepared.severity(-3.0 * speed, 2.0 * load, 0.0), 3.0);
    assert_eq!(prepared.severity(speed, 2.5 * load, 4.0 * prepared.planned_work()), 4.0);
    for is_released in [false, true] {
        let at = |severity: f64| prepared.estimated_error(0.0, &Course { severity, is_released, ..Course::default() });
        let nominal = at(1.0);
        assert!(nominal > 0.0 && nominal < 0.02, "{nominal}");
        assert_eq!([at(0.0), at(2.0), at(4.0), at(10.0)], [nominal, nominal, 2.0 * nominal, 5.0 * nominal]);
        assert_eq!([at(10.0_f64.next_up()), at(f64::INFINITY)], [plan::UNKNOWN; 2]);
    }
}

/// Within them that of the lumped level is in proportion to the temperature rise over the load.
#[test]
fn the_error_of_the_lumped_level_follows_temperature_over_load() {
    let brake = changed_scene(&scene("disc_brake"), &[("solver.fidelity", 1.0), ("solver.tolerance", 1e-1)]);
    let prepared = Prepared::new(&brake.clone().for_run_of(Some(20.0)), steady::run_in).unwrap();
    let plan = prepared.plan.as_ref().unwrap();
    assert_eq!(plan.model_level, ModelLevel::Lumped);
    let (rise, load) = (plan.rise, brake.nominal_load);
    let bows = [0.0, 0.5 * rise, rise, 3.0 * rise].map(|rise| prepared.relative_bow(rise, load));
    assert_eq!([bows, [prepared.relative_bow(rise, 2.0 * load); 4]], [[0.0, 0.5, 1.0, 1.0], [0.5; 4]]);
    let at = |relative_bow: f64| prepared.estimated_error(0.0, &Course { relative_bow, ..Course::default() });
    assert!(at(1.0) == plan.estimated_error.unwrap() && at(1.0) < plan::UNKNOWN, "{plan:#?}");
    assert_eq!([at(0.5), at(0.0)], [0.5 * at(1.0), 0.25 * at(1.0)]);
}

/// A tolerance at which even a coarse contact line is too costly to compare calls for resolved cells, not for the lumped level.
#[test]
fn a_level_too_costly_to_compare_is_the_one_that_neglects_least() {
    let mut starts = scene("disc_brake");
    starts[reference("solver.tolerance") as usize] = 1e-8;
    let plan = plan::make(&Scene::new(&starts, None).unwrap(), steady::run_in).unwrap().plan;
    assert_eq!((plan.model_level.cells(), plan.estimated_error), (129, Some(plan::UNKNOWN)), "{plan:#?}");
    assert!(plan.reason.contains("too costly"), "{}", plan.reason);
}

/// The error of the steps is found from runs whose tolerances are a factor of two apart at least, so also where that of the scene is
/// just above the one at which levels are compared.
#[test]
fn the_error_of_steps_is_continuous_in_the_tolerance() {
    let ratios = |tolerance: f64| {
        let plan = plan::make(&generate(5).scene(tolerance).unwrap(), steady::run_in).unwrap().plan;
        plan.candidates.iter().find(|candidate| candidate.model_level == ModelLevel::Lumped).unwrap().step_ratios
    };
    let at = ratios(2.5e-2);
    for tolerance in [2.501e-2, 2.7e-2, 4.9e-2] {
        for (own, at) in ratios(tolerance).into_iter().zip(at) {
            assert!(own > 0.5 * at && own < 2.0 * at, "{own} at {tolerance}, {at} at .025");
        }
    }
}
