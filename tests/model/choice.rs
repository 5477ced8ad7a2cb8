//! Choice of the automatic level: what it costs, and what it depends on.

use model::Inputs;
use model::levels::{Model, ModelOperators};
use model::line::operators::Shared;
use model::lumped::conditions::Tunables;
use model::plan::distance::Distance;
use model::plan::{BuiltModel, Choice, ModelLevel};
use model::run_error::{RunError, SavedRunError};
use scene::Scene;
use test_support::{Application, changed, changed_scene, scene};

fn choice(scene: &Scene) -> Choice {
    Choice::new(scene, &mut Shared::default(), steady::run_in).0
}

/// Steps are counted, so the same scene has the same level everywhere; the coarser pair ends a comparison that it settles.
#[test]
fn a_comparison_is_reproducible_and_ends_when_it_is_settled() {
    let auto = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)];
    let brake = changed_scene(&scene("disc_brake"), &auto);
    let [one, other] = [choice(&brake), choice(&brake)];
    assert_eq!(one, other);
    let comparison = one.comparison.unwrap();
    assert!(one.level == ModelLevel::Line(0) && comparison.error > 1e-2, "{comparison:?}");
    // At a tolerance that lumped meets the finer line is run as well, which takes more steps.
    let wide = Scene { tolerance: 0.5, ..brake };
    let loose = choice(&wide);
    let all = loose.comparison.unwrap();
    assert!(
        loose.level == ModelLevel::Lumped && all.steps > comparison.steps && all.error >= comparison.error,
        "{all:?}"
    );
    // What ends it early is below the whole error: just above and below that the level is the one of the whole comparison.
    let [above, below] = [1.001, 0.999].map(|part| choice(&Scene { tolerance: part * all.error, ..wide.clone() }));
    assert_eq!((above.level, above.comparison), (ModelLevel::Lumped, Some(all.clone())));
    let found = below.comparison.unwrap();
    assert!(below.level == ModelLevel::Line(0) && found.error <= all.error && found.steps <= all.steps, "{found:?}");
}

/// No line of a comparison takes more than 200 internal steps; where one would, the run itself measures its error.
#[test]
fn a_comparison_is_short() {
    for name in ["piston_ring", "rod_seal", "slideway", "safety_gear", "pom_bushing", "drum_brake", "fading_pin"] {
        for tolerance in [1e-1, 1e-2] {
            let own = Application::read(name).starts;
            let scene = Scene::new(&changed(&own, &[("solver.tolerance", tolerance)]), None).unwrap();
            let found = choice(&scene);
            match found.comparison {
                Some(comparison) => assert!(comparison.steps < 2500, "{name}: {comparison:?}"),
                None => {
                    assert!(found.level == ModelLevel::Line(0) && found.reason.contains("nothing to compare"), "{name}")
                }
            }
        }
    }
}

/// Without nominal conditions there is nothing to compare: the line runs, and measures its error.
#[test]
fn without_nominal_conditions_the_line_runs() {
    let starts = changed(&scene("disc_brake"), &[("solver.fidelity", 1.0), ("nominal.load", 0.0)]);
    let prepared = BuiltModel::new(&Scene::new(&starts, Some(1e-2)).unwrap(), steady::run_in).unwrap();
    let choice = prepared.choice.unwrap();
    assert!(choice.reason.contains("nominal.load = 0 N"), "{}", choice.reason);
    assert_eq!((prepared.operators.cells(), prepared.companion.unwrap().cells()), (17, 9));
}

/// Cells follow from the tolerance, at the level `line` as with `auto`.
#[test]
fn cells_follow_from_the_tolerance() {
    for (tolerance, cells) in
        [(1e-1, 17), (5e-3, 17), (4.9e-3, 33), (5e-4, 33), (4.9e-4, 65), (5e-5, 65), (4.9e-5, 129)]
    {
        let line = changed_scene(&scene("disc_brake"), &[("solver.fidelity", 3.0), ("solver.tolerance", tolerance)]);
        let prepared = BuiltModel::new(&line, steady::run_in).unwrap();
        assert_eq!((prepared.operators.cells(), prepared.companion.is_some()), (cells, false), "{tolerance}");
    }
}

/// What operators share with those that were built before does not depend on these.
#[test]
fn operators_built_beside_others_are_those_built_alone() {
    for name in ["clutch", "disc_brake", "reciprocating_punch"] {
        let level = |fidelity: f64, tolerance: f64| {
            changed_scene(&scene(name), &[("solver.fidelity", fidelity), ("solver.tolerance", tolerance)])
        };
        let known = ModelOperators::new(&level(2.0, 1e-2), steady::run_in).unwrap();
        for scene in [level(2.0, 1e-2), level(2.0, 1e-3), level(3.0, 1e-2), level(3.0, 1e-3)] {
            let alone = ModelOperators::new(&scene, steady::run_in).unwrap();
            let beside = known.beside(&scene, steady::run_in).unwrap();
            let same = match [&alone, &beside] {
                [ModelOperators::Lumped(alone), ModelOperators::Lumped(beside)] => alone == beside,
                [ModelOperators::Line(alone), ModelOperators::Line(beside)] => {
                    alone.mean.growth == beside.mean.growth && alone.mean.punch.heat == beside.mean.punch.heat
                }
                _ => false,
            };
            assert!(same, "{name}, {:?}, {}", scene.fidelity, scene.tolerance);
        }
    }
}

/// Lines that share finite elements and modes of the strip run as those built alone, to the last bit, whatever was built before.
#[test]
fn lines_that_share_run_as_those_built_alone() {
    for name in ["disc_brake", "reciprocating_punch"] {
        let auto = changed_scene(&scene(name), &[("solver.fidelity", 1.0), ("solver.tolerance", 1e-3)]);
        let built = BuiltModel::new(&auto, steady::run_in).unwrap();
        for shared in [built.operators, built.companion.unwrap()] {
            let alone = ModelOperators::new(shared.scene(), steady::run_in).unwrap();
            let [alone, shared] = [alone, shared].map(|operators| {
                let inputs = Inputs::new(auto.nominal_velocity, auto.nominal_load, 293.15);
                let mut model = Model::new(&operators, Tunables::of(operators.scene()), &inputs);
                model.step(&inputs, None, 0.1 * auto.nominal_duration).unwrap();
                model.save()
            });
            assert!(alone == shared, "{name}");
        }
    }
}

/// The output is at most 1, which stands for an error that is not known: the advice says the same number, and no cells.
#[test]
fn advice_has_the_number_of_the_output_and_names_cells_below_it_only() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.error_estimate", 3.0)];
    let scene = changed_scene(&scene("disc_brake"), &line);
    let prepared = BuiltModel::new(&scene, steady::run_in).unwrap();
    let mut run = RunError::new(&prepared, Tunables::of(&scene), &Inputs::constant(0.0));
    let start = run.save();
    for (apart, advised) in [(0.5, true), (1.5, false), (f64::INFINITY, false)] {
        let distance = Some(Distance { apart: [0.0, apart, 0.0], largest: [1.0; 3] });
        run.set(&SavedRunError { distance, ..start.clone() }, start.companion.as_ref());
        let (mut text, output) = (String::new(), run.of(&prepared, 0.0));
        run.write_advice(&prepared, 0.0, &mut text).unwrap();
        assert_eq!(output, apart.min(1.0));
        assert!(text.starts_with(&format!("estimated_error = {output} is above")), "{text}");
        assert_eq!([text.contains("solver.cells"), text.ends_with("not known")], [advised, !advised], "{text}");
    }
}
