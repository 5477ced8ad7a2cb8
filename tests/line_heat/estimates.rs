//! Level that `auto` takes, and the error that a run states.

use model::Inputs;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use scene::Scene;
use scene::variables::{COUNT, STARTS};
use sliding_contact::component::{Component, Message, Snapshot, Subject};
use std::sync::Arc;
use test_support::{Application, Drive, HELD, LUMPED, changed, changed_scene, reference, scene};

fn started(starts: &[f64; COUNT], changes: &[(&str, f64)]) -> Component {
    let mut component = Component::new(Arc::new(changed(starts, changes)));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component
}

fn texts(component: &mut Component) -> Vec<String> {
    component.messages().map(|message| message.text.clone()).collect()
}

/// Warnings since the last call.
fn warnings(component: &mut Component) -> Vec<String> {
    let of = |message: &Message| (message.subject == Subject::Warning).then(|| message.text.clone());
    component.messages().filter_map(of).collect()
}

fn slide(component: &mut Component, speed: f64, load: f64) {
    component.set_input(reference("sliding_velocity"), speed);
    component.set_input(reference("normal_load"), load);
}

/// A stop, changing in every step.
fn brake(component: &mut Component, steps: std::ops::Range<u32>) {
    for step in steps {
        slide(component, 10.0 - 0.3 * f64::from(step), 3e3);
        component.set_input_derivative(reference("sliding_velocity"), -0.6);
        component.step(0.5).unwrap();
    }
}

/// A stock scene whose lumped level is within a tolerance of 0.2.
const LUMPED_ENOUGH: &[(&str, f64)] =
    &[("*.thermal_expansion", 0.0), ("nominal.duration", 100.0), ("solver.tolerance", 0.2)];

#[test]
fn two_rigid_bodies_are_lumped_and_exact_but_for_their_steps() {
    let mut component = started(&STARTS, &[("*.body", 1.0), ("solver.tolerance", 1e-2)]);
    let said = texts(&mut component);
    assert!(said[0].contains("auto takes lumped") && said[0].contains("both bodies are rigid"), "{said:?}");
    slide(&mut component, 5.0, 2e3);
    component.step(1.0).unwrap();
    let [whole, steps] = ["estimated_error", "estimated_step_error"].map(|name| component.get(reference(name)));
    assert!(whole == steps && whole < 2e-2, "{whole} {steps}");
}

#[test]
fn the_level_follows_the_tolerance_of_the_scene_before_that_of_the_importer() {
    let level = |own: f64, importer: Option<f64>| {
        let mut component =
            Component::new(Arc::new(changed(&changed(&STARTS, LUMPED_ENOUGH), &[("solver.tolerance", own)])));
        component.enter_initialization();
        component.initialise(importer).unwrap();
        texts(&mut component).remove(0)
    };
    for (own, importer, wanted) in [
        (0.0, None, "tolerance 1e-3 from the default; auto takes line, 33 cells"),
        (0.0, Some(0.2), "tolerance 2e-1 from the importer; auto takes lumped"),
        (5e-3, Some(0.5), "tolerance 5e-3 from solver.tolerance; auto takes line, 17 cells"),
        (0.2, Some(1e-3), "tolerance 2e-1 from solver.tolerance; auto takes lumped"),
    ] {
        let said = level(own, importer);
        assert!(said.contains(wanted), "{said}");
    }
}

/// Fresh material under a band that an insulating, soft punch presses evenly: the highest and the mean temperature of Jaeger's
/// moving band at a Peclet number of 10, without expansion, fade or wear. With the heat of the line lumped, the highest was the mean.
#[test]
fn a_line_whose_bodies_do_not_expand_resolves_its_heat() {
    let (width, depth, conductivity, capacity) = (0.02, 0.005, 40.0, 7800.0 * 500.0);
    let velocity = 2.0 * 10.0 * (conductivity / capacity) / (0.5 * width);
    let changes = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 65.0),
        ("solver.tolerance", 1e-4),
        ("punch.body", 2.0),
        ("punch.youngs_modulus", 1e6),
        ("punch.conductivity", 0.0),
        ("punch.width", width),
        ("depth", depth),
        ("*.thermal_expansion", 0.0),
        ("*.wear_coefficient", 0.0),
        ("strip.body", 1.0),
        ("strip.path", 1.0),
        ("strip.length", 0.0),
        ("strip.height", 0.5),
        ("strip.conductivity", conductivity),
        ("strip.density", 7800.0),
        ("strip.specific_heat", 500.0),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("strip.emissivity", 0.0),
        ("contact.faces", 1.0),
        ("contact.mean_radius", 0.0),
        ("contact.shear_coupling", 0.0),
        ("contact.conductance", 1e12),
        ("nominal.velocity", velocity),
        ("nominal.duration", 100.0 * width / velocity),
    ];
    let mut drive = Drive::stock(&changes);
    drive.set("sliding_velocity", velocity).set("normal_load", 1e3).steps(50, 2.0 * width / velocity);
    let flux = drive.get("friction_power") / (width * depth);
    let unit = flux * 0.5 * width / conductivity;
    let [mean, highest] =
        ["contact_temperature", "contact_temperature_max"].map(|name| (drive.get(name) - 293.15) / unit);
    assert!((mean / 0.24132 - 1.0).abs() < 5e-3, "{mean}");
    // The highest is a mean over 1/32 of the width at a cusp.
    assert!((highest / 0.34850 - 1.0).abs() < 0.01, "{highest}");
}

/// A pad that a held disc heats from below bulges and touches in its middle only, which `lumped` cannot know: measured, its error says so.
/// Bodies that do not expand are as warm at both levels.
#[test]
fn lumped_on_a_disc_that_is_held_hot_states_its_error() {
    let run = |fidelity: f64, expands: bool| {
        let hot = 293.15 + 380.0;
        let own = [
            ("solver.fidelity", fidelity),
            ("solver.cells", 33.0),
            ("solver.tolerance", 1e-3),
            ("solver.error_estimate", 3.0),
            ("strip.base_thermal", HELD),
            ("strip.base_at_ambient", 0.0),
            ("strip.base_temperature", hot),
            ("strip.initial_at_ambient", 0.0),
            ("strip.initial_temperature", hot),
        ];
        let flat = [("*.thermal_expansion", 0.0)];
        let mut drive =
            Drive::from_starts(&scene("disc_brake"), &[&own[..], if expands { &[] } else { &flat }].concat());
        drive.set("normal_load", 2.6e3).steps(20, 30.0);
        (drive.get("contact_temperature") - 293.15, drive.get("estimated_error"))
    };
    let [(lumped, stated), (line, _)] = [LUMPED, 3.0].map(|fidelity| run(fidelity, true));
    let error = (lumped / line - 1.0).abs();
    assert!(error > 0.02 && (0.5..5.0).contains(&(stated / error)), "{lumped} and {line} K, stated {stated}");
    let [(lumped, _), (line, _)] = [LUMPED, 3.0].map(|fidelity| run(fidelity, false));
    assert!((lumped / line - 1.0).abs() < 1e-2, "{lumped} and {line} K");
}

/// Reciprocating sliding on a closed track: most of the heat stays in the part of the track that the strokes cover.
#[test]
fn a_stroke_on_a_closed_track_heats_that_part_of_the_track() {
    let cycle_mean = |fidelity: f64| {
        let (stroke, speed) = (0.02, 0.2);
        let mut drive = Drive::from_starts(
            &scene("disc_brake"),
            &[
                ("solver.fidelity", fidelity),
                ("solver.cells", 17.0),
                ("solver.tolerance", 1e-3),
                ("punch.width", 0.03),
                ("*.thermal_expansion", 0.0),
                ("nominal.stroke", stroke),
                ("nominal.velocity", speed),
                ("nominal.duration", 60.0),
            ],
        );
        drive.set("normal_load", 1e3);
        let half = stroke / speed;
        let mut sum = 0.0;
        for stroke in 0..600 {
            drive.set("sliding_velocity", if stroke % 2 == 0 { speed } else { -speed });
            for _ in 0..4 {
                drive.step(0.25 * half);
                sum += if stroke >= 580 { drive.get("contact_temperature") - 293.15 } else { 0.0 };
            }
        }
        sum / 80.0
    };
    let [lumped, line] = [LUMPED, 3.0].map(cycle_mean);
    assert!(line > 1.0 && (lumped / line - 1.0).abs() < 0.1, "{lumped} {line}");
}

/// The estimate is the largest difference of two lines that are driven side by side, the coarse one at twice the tolerance and with
/// bodies reduced to a tenth of it, and a third of the error of the steps.
#[test]
fn a_line_states_its_distance_from_one_on_half_of_the_cells() {
    let level = |cells: f64, tolerance: f64| {
        [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", tolerance)]
    };
    let line =
        |estimate: f64| started(&STARTS, &[&level(17.0, 1e-2)[..], &[("solver.error_estimate", estimate)]].concat());
    let [mut alone, mut measured] = [2.0, 3.0].map(line);
    let coarse = Scene { reduction_share: 0.05, ..changed_scene(&STARTS, &level(9.0, 2e-2)) };
    let operators = ModelOperators::new(&coarse, steady::run_in).unwrap();
    let mut inputs = Inputs::new(0.0, 0.0, 293.15);
    let mut companion = Model::new(&operators, Tunables::of(&coarse), &inputs);
    let slopes = Inputs { sliding_velocity: -0.6, ..Inputs::constant(0.0) };
    let outputs = ["wear_depth", "contact_temperature", "friction_force"].map(reference);
    let (mut apart, mut largest, mut values) = ([0.0_f64; 3], [0.0_f64; 3], [0.0; COUNT]);
    for step in 0..20 {
        [&mut alone, &mut measured].into_iter().for_each(|run| brake(run, step..step + 1));
        (inputs.sliding_velocity, inputs.normal_load) = (10.0 - 0.3 * f64::from(step), 3e3);
        companion.step(&inputs, Some(&slopes), 0.5).unwrap();
        companion.write_end(&mut values);
        for (at, output) in outputs.into_iter().enumerate() {
            let from = if at == 1 { 293.15 } else { 0.0 };
            let [fine, coarse] = [alone.get(output), values[output as usize]].map(|value| value - from);
            apart[at] = apart[at].max((fine - coarse).abs());
            largest[at] = largest[at].max(fine.abs());
        }
    }
    let distance = (0..3).map(|at| apart[at] / largest[at]).fold(0.0, f64::max);
    let steps = measured.get(reference("estimated_step_error"));
    let stated = measured.get(reference("estimated_error"));
    assert!((stated / distance.hypot(steps / 3.0) - 1.0).abs() < 1e-9, "{stated} {distance} {steps}");
    assert!(distance > 1e-4 && distance < 0.1, "{distance}");
    // The run itself is the same, and alone knows nothing of the error of its cells.
    for name in ["wear_depth", "contact_temperature", "pressure_max", "estimated_step_error"] {
        assert_eq!(measured.get(reference(name)).to_bits(), alone.get(reference(name)).to_bits(), "{name}");
    }
    assert_eq!(alone.get(reference("estimated_error")), 1.0);
    // auto has a companion without asking, and none where it is switched off.
    let auto = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)];
    let mut chosen = started(&STARTS, &auto);
    brake(&mut chosen, 0..20);
    assert_eq!(chosen.operators().unwrap().cells(), 17);
    assert_eq!(chosen.get(reference("estimated_error")).to_bits(), stated.to_bits());
    let mut off = started(&STARTS, &[&auto[..], &[("solver.error_estimate", 2.0)]].concat());
    brake(&mut off, 0..20);
    assert_eq!(off.get(reference("estimated_error")), 1.0);
}

/// In the first milliseconds of a drag from cold the error is that of the reduced bodies, whatever the cells.
#[test]
fn the_error_of_the_reduction_is_stated_from_the_first_step() {
    let run = |cells: f64, tolerance: f64, estimate: f64| {
        let level = [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.error_estimate", estimate)];
        let mut drive =
            Drive::attempt(&scene("disc_brake"), &[&level[..], &[("solver.tolerance", tolerance)]].concat()).unwrap();
        let cold = drive.get("contact_temperature");
        drive.set("sliding_velocity", 2.0).set("normal_load", 1000.0);
        let step = |_| {
            drive.0.step(4e-3).unwrap();
            [drive.get("contact_temperature") - cold, drive.get("estimated_error")]
        };
        (0..50).map(step).collect::<Vec<_>>()
    };
    let fine = run(65.0, 1e-5, 2.0);
    for (cells, tolerance) in [(17.0, 1e-2), (33.0, 1e-3)] {
        let mut error: f64 = 0.0;
        for ([rise, stated], [exact, _]) in run(cells, tolerance, 3.0).into_iter().zip(&fine) {
            error = error.max((rise - exact).abs());
            let ratio = stated * exact / error;
            assert!((0.2..5.0).contains(&ratio), "{tolerance}: stated {stated}, true {}", error / exact);
        }
        assert!(error > 0.0);
    }
}

/// Reduction and steps alone, on the same cells: an estimate of them, which is no bound.
#[test]
fn the_error_of_the_steps_of_a_bushing_is_estimated() {
    let scene = Application::read("pom_bushing");
    let of = |tolerance: f64| [("solver.fidelity", 3.0), ("solver.cells", 17.0), ("solver.tolerance", tolerance)];
    for tolerance in [1e-1, 1e-2, 1e-3] {
        let (run, truth) = (scene.run(&of(tolerance)).unwrap(), scene.run(&of(1e-2 * tolerance)).unwrap());
        let mut drive = Drive::from_starts(&scene.starts, &of(tolerance));
        let mut stated: f64 = 0.0;
        for rows in scene.inputs.windows(2) {
            let length = rows[1][0] - rows[0][0];
            for (name, column) in [("sliding_velocity", 1), ("normal_load", 2)] {
                drive.set(name, rows[0][column]).slope(name, (rows[1][column] - rows[0][column]) / length);
            }
            drive.step(length);
            stated = stated.max(drive.get("estimated_step_error"));
        }
        let error = run.error(&truth);
        assert!(stated > 0.2 * error, "{tolerance}: {error:e}, stated {stated:e}");
    }
}

/// Mean heat is compared with resolved heat: what it leaves out is stated.
#[test]
fn the_error_of_mean_heat_is_measured() {
    let stated = |heat: f64| {
        let changes = [
            ("solver.fidelity", 3.0),
            ("solver.heat", heat),
            ("solver.error_estimate", 3.0),
            ("solver.tolerance", 1e-2),
        ];
        let mut drive = Drive::from_starts(&scene("disc_brake"), &changes);
        drive.set("sliding_velocity", 3.8).set("normal_load", 2.6e3).steps(30, 1.0);
        (drive.get("estimated_error"), drive.get("contact_temperature"))
    };
    let [resolved, mean] = [1.0, 2.0].map(stated);
    let apart = (mean.1 - resolved.1).abs() / (resolved.1 - 293.15);
    assert!(resolved.0 < 0.005, "{resolved:?}");
    assert!(apart > 0.01 && mean.0 > 0.8 * apart && mean.0 < 5.0 * apart, "{resolved:?} {mean:?}");
}

#[test]
fn a_lumped_run_beyond_its_nominal_conditions_says_so_once_and_its_error_is_not_known() {
    let mut component = started(&STARTS, LUMPED_ENOUGH);
    assert!(texts(&mut component)[0].contains("auto takes lumped"));
    // Nominal: 10 m/s, 5 kN.
    slide(&mut component, 10.0, 4e3);
    (0..20).for_each(|_| component.step(1.0).unwrap());
    assert_eq!(warnings(&mut component), Vec::<String>::new());
    let within = component.get(reference("estimated_error"));
    assert!(within > 1e-4 && within < 0.2, "{within}");
    let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
    component.snapshot(&mut saved);
    slide(&mut component, 10.0, 1.1e4);
    component.step(1.0).unwrap();
    let said = warnings(&mut component);
    assert!(
        said.len() == 1 && said[0].contains("exceeds the nominal conditions") && said[0].contains("11000 N"),
        "{said:?}"
    );
    component.step(1.0).unwrap();
    assert_eq!(warnings(&mut component), Vec::<String>::new());
    assert_eq!(component.get(reference("estimated_error")), 1.0);
    // Bits are those of the named level.
    let mut named = Drive::stock(&[LUMPED_ENOUGH, &[("solver.fidelity", LUMPED)]].concat());
    for load in std::iter::repeat_n(4e3, 20).chain([1.1e4; 2]) {
        named.set("sliding_velocity", 10.0).set("normal_load", load).step(1.0);
    }
    for name in ["wear_depth", "contact_temperature", "friction_force", "stored_heat"] {
        assert_eq!(component.get(reference(name)).to_bits(), named.get(name).to_bits(), "{name}");
    }
    // Saved states know it, serialised as well.
    let mut beyond = Snapshot::default();
    component.snapshot(&mut beyond);
    beyond.encode(&mut bytes);
    component.restore(&saved).unwrap();
    assert_eq!(component.get(reference("estimated_error")), within);
    component.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
    assert_eq!(component.get(reference("estimated_error")), 1.0);
}

/// A step that begins beyond nominal speed and ends within it counts; so does friction work.
#[test]
fn the_beginning_of_a_step_and_the_work_of_the_run_count() {
    let beyond = |changes: &[(&str, f64)], speed: f64, slope: f64, steps: u32| {
        let mut component = started(&STARTS, &[LUMPED_ENOUGH, changes].concat());
        texts(&mut component);
        slide(&mut component, speed, 100.0);
        component.set_input_derivative(reference("sliding_velocity"), slope);
        (0..steps).for_each(|_| component.step(2.0).unwrap());
        warnings(&mut component)
    };
    assert_eq!(beyond(&[], 10.0, -4.0, 1), Vec::<String>::new());
    let fast = beyond(&[], 15.0, -4.0, 1);
    assert!(fast.len() == 1 && fast[0].contains("15 m/s"), "{fast:?}");
    // 100 N and 10 m/s do the work of 5 kN in 1 s and what follows within 61 s.
    let short = [("nominal.duration", 1.0)];
    assert_eq!(beyond(&short, 10.0, 0.0, 20).len(), 0);
    assert!(beyond(&short, 10.0, 0.0, 40)[0].contains("J of friction, compared up to"));
}

#[test]
fn a_restored_run_goes_on_with_its_companion() {
    let auto = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-2)];
    let [mut whole, fresh] = [(); 2].map(|()| Drive(started(&STARTS, &auto)));
    brake(&mut whole.0, 0..10);
    let error = whole.get("estimated_error");
    assert!(error < 1.0);
    whole.assert_replay(fresh, |run| {
        assert_eq!(run.get("estimated_error").to_bits(), error.to_bits());
        brake(&mut run.0, 10..20);
        assert!(run.get("estimated_error") != error);
        (0..COUNT as u32).map(|index| run.0.get(index).to_bits()).collect::<Vec<_>>()
    });
}

/// At the end of a run whose error is above the tolerance, one warning names the cells to take.
#[test]
fn an_error_above_the_tolerance_names_the_cells_to_take() {
    let advice = |tolerance: f64| {
        let auto = [("solver.fidelity", 1.0), ("solver.cells", 17.0), ("solver.tolerance", tolerance)];
        let mut component = started(&STARTS, &auto);
        brake(&mut component, 0..20);
        texts(&mut component);
        component.conclude();
        (component.get(reference("estimated_error")), warnings(&mut component))
    };
    let (error, said) = advice(1e-3);
    assert!(error > 1e-3, "{error}");
    assert!(
        said.len() == 1 && said[0].contains("take solver.cells = ") && said[0].contains("instead of 17"),
        "{said:?}"
    );
    let (error, said) = advice(0.02);
    assert!(error < 0.02 && said.is_empty(), "{error} {said:?}");
}
