//! Every warning: a scene that must log it, and a similar scene that must not.

use scene::slot::Packaged;
use sliding_contact::component::{Component, Subject};
use std::sync::Arc;
use test_support::{EXTERNAL, HELD, LINE, LUMPED, changed, reference};

type Values<'a> = &'a [(&'a str, f64)];

/// Below the critical speed of the stock scene, of which initialisation warns.
const STABLE: (&str, f64) = ("nominal.velocity", 1.0);

/// Few cells, so that a line costs little.
const FEW: (&str, f64) = ("solver.cells", 9.0);

fn component(starts: Values) -> Component {
    let values = changed(&changed(&Packaged::stock().starts, &[("solver.fidelity", LUMPED)]), starts);
    let mut component = Component::new(Arc::new(values)).declaring(1e-2);
    component.enter_initialization();
    component
}

fn warnings(component: &mut Component) -> Vec<String> {
    let warnings = component.messages().filter(|message| message.subject == Subject::Warning);
    warnings.map(|message| message.text.clone()).collect()
}

/// Warnings when initialisation ends with these parameters and inputs, below the critical speed unless they say otherwise.
fn at_start(starts: Values) -> Vec<String> {
    let mut component = component(&[&[STABLE], starts].concat());
    component.initialise(None).unwrap();
    warnings(&mut component)
}

/// Warnings of steps of 0.1 s with these inputs and their slopes, begun with these parameters.
fn in_steps(starts: Values, inputs: Values, slopes: Values, steps: usize) -> Vec<String> {
    let mut component = component(starts);
    component.initialise(None).unwrap();
    warnings(&mut component);
    let mut all = Vec::new();
    for (name, value) in inputs {
        component.set_input(reference(name), *value);
    }
    for _ in 0..steps {
        for (name, value) in slopes {
            component.set_input_derivative(reference(name), *value);
        }
        component.step(0.1).unwrap();
        all.extend(warnings(&mut component));
    }
    all
}

fn assert_one(warnings: &[String], wanted: &[&str]) {
    let [text] = warnings else { panic!("{warnings:?} instead of one with {wanted:?}") };
    assert!(wanted.iter().all(|part| text.contains(part)), "{text} does not contain all of {wanted:?}");
}

const SILENT: [&str; 0] = [];
const SLIDING: Values = &[("sliding_velocity", 8.0), ("normal_load", 2000.0)];

#[test]
fn temperatures_that_look_like_degrees_celsius_are_told() {
    assert_eq!(at_start(&[]), SILENT);
    assert_one(&at_start(&[("ambient_temperature", 149.9)]), &["ambient_temperature = 149.9 K is -123.25 degC"]);
    assert_eq!(at_start(&[("ambient_temperature", 150.0)]), SILENT);
    let twenty = ["= 20 K is -253.15 degC", "kelvin"];
    for (name, others) in [
        ("punch.initial_temperature", vec![("punch.initial_at_ambient", 0.0)]),
        ("strip.initial_temperature", vec![("strip.initial_at_ambient", 0.0)]),
        ("contact.temperature_limit", vec![("contact.temperature_limited", 1.0)]),
        ("punch.top_temperature", vec![("punch.top_thermal", HELD), ("punch.top_at_ambient", 0.0)]),
        ("strip.base_temperature", vec![("strip.base_thermal", HELD), ("strip.base_at_ambient", 0.0)]),
        ("punch.external_temperature", vec![("punch.top_thermal", EXTERNAL)]),
        ("strip.external_temperature", vec![("strip.base_thermal", EXTERNAL)]),
        ("contact.friction_fade.temperature", vec![("contact.friction_fade.factor", 0.9)]),
        ("punch.wear_fade.temperature", vec![("punch.wear_fade.factor", 0.9)]),
        ("strip.wear_fade.temperature", vec![("strip.wear_fade.factor", 0.9)]),
    ] {
        let first = |name: &str| {
            if name.contains("fade") { format!("{name}[1]") } else { name.to_owned() }
        };
        let owned: Vec<(String, f64)> = others.iter().map(|(name, value)| (first(name), *value)).collect();
        let mut starts: Vec<(&str, f64)> = owned.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let name = first(name);
        if name.contains("friction_fade") {
            starts.push(("solver.fidelity", LUMPED));
        }
        starts.push((&name, 20.0));
        assert_one(&at_start(&starts), &[&name, twenty[0], twenty[1]]);
        if name.ends_with("initial_temperature") || name.ends_with("temperature_limit") {
            let refused = component(&[(&name, 20.0)]).initialise(None).unwrap_err();
            let (choice, acts) = others[0];
            let said =
                format!("{name} = 20 K has no effect while {choice} = {}; set {choice} = {}", acts == 0.0, acts != 0.0);
            assert_eq!(refused, said);
        } else if !others.is_empty() {
            // Where it has no effect, it is no matter.
            assert_eq!(at_start(&[(&name, 20.0)]), SILENT, "{name}");
        }
        starts.pop();
        starts.push((&name, 293.15));
        assert_eq!(at_start(&starts), SILENT, "{name}");
    }
}

/// A table that a scene has replaces its constants and is switched off by its number of points; what an importer sets beside that is told.
#[test]
fn properties_without_effect_are_told() {
    let set = |name: &str, values: Values| {
        let mut component = Component::new(Arc::new(test_support::scene(name)));
        component.enter_initialization();
        values.iter().for_each(|(name, value)| component.set_parameter(reference(name), *value));
        component.initialise(None).unwrap();
        let mut told = warnings(&mut component);
        told.retain(|text| text.contains("property_table"));
        told
    };
    let remedy = "has no effect while strip.property_table.points = 7; set strip.property_table.points = 0";
    for name in ["disc_brake", "clutch"] {
        assert_one(&set(name, &[("strip.conductivity", 40.0)]), &[&format!("strip.conductivity = 40 {remedy}")]);
        assert_one(&set(name, &[("strip.specific_heat", 500.0)]), &[&format!("strip.specific_heat = 500 {remedy}")]);
        assert_eq!(set(name, &[("strip.conductivity", 40.0), ("strip.property_table.points", 0.0)]), SILENT);
        assert_eq!(set(name, &[("punch.conductivity", 40.0), ("strip.conductivity", 54.0)]), SILENT);
    }
    for (name, point, points) in [("disc_brake", 8, 7), ("pin_on_disk", 1, 0)] {
        let own = format!("strip.property_table.conductivity[{point}]");
        let told = format!("{own} = 40 has no effect while strip.property_table.points = {points}");
        assert_one(&set(name, &[(&own, 40.0)]), &[&told]);
    }
}

#[test]
fn both_velocities_are_told_once_with_their_sum() {
    let both = [("sliding_velocity", 8.0), ("angular_velocity", 10.0), ("normal_load", 2000.0)];
    let radius = Packaged::stock().starts[reference("contact.mean_radius") as usize];
    let sum = format!("slides at {} m/s", 8.0 + radius * 10.0);
    let told = in_steps(&[], &both, &[], 3);
    assert_one(&told, &["sliding_velocity = 8 m/s and angular_velocity = 10 rad/s", "contact.mean_radius", &sum]);
    assert_eq!(in_steps(&[], &both[1..], &[], 3), SILENT);
    assert_eq!(in_steps(&[], &[both[0], both[2]], &[], 3), SILENT);
    // Once a run: another one tells it again.
    let mut component = component(&[]);
    for _ in 0..2 {
        component.reset();
        component.set_parameter(reference("solver.fidelity"), LUMPED);
        component.enter_initialization();
        component.initialise(None).unwrap();
        warnings(&mut component);
        for (name, value) in both {
            component.set_input(reference(name), value);
        }
        component.step(0.1).unwrap();
        assert_eq!(warnings(&mut component).len(), 1);
    }
}

#[test]
fn a_negative_load_is_told_once_with_its_value() {
    for level in [LUMPED, LINE] {
        let starts = [("solver.fidelity", level), FEW];
        let told = in_steps(&starts, &[("sliding_velocity", 8.0), ("normal_load", -500.0)], &[], 3);
        assert_one(&told, &["normal_load = -500 N is below 0 N"]);
        let told = in_steps(&starts, SLIDING, &[("normal_load", -15_000.0)], 3);
        assert_one(&told, &["normal_load = -1000 N is below 0 N"]);
        assert_eq!(in_steps(&starts, SLIDING, &[("normal_load", -500.0)], 3), SILENT);
        assert_eq!(in_steps(&starts, &[("sliding_velocity", 8.0)], &[], 3), SILENT);
    }
}

/// A ramp to 0 ends beside it by the rounding of slope and time.
#[test]
fn a_load_below_zero_by_rounding_is_not_told() {
    for level in [LUMPED, LINE] {
        let starts = [("solver.fidelity", level), FEW];
        let ramp = |slope| in_steps(&starts, SLIDING, &[("normal_load", slope)], 1);
        assert_eq!(ramp(-20_000.000_000_000_1), SILENT);
        assert_one(&ramp(-20_000.01), &["normal_load = -0.001"]);
        assert_eq!(in_steps(&starts, &[("sliding_velocity", 8.0), ("normal_load", -1e-13)], &[], 3), SILENT);
        let rises = [("sliding_velocity", 8.0), ("normal_load", -1e-13)];
        assert_eq!(in_steps(&starts, &rises, &[("normal_load", 5_000.0)], 2), SILENT);
    }
}

#[test]
fn limits_are_told_where_they_are_reached() {
    // With a bristle the lumped level takes the general form of its step.
    for (level, stick) in [(LUMPED, 0.0), (LUMPED, 1e6), (LINE, 0.0)] {
        let at = |name, value, inputs: Values| {
            let level = [("solver.fidelity", level), FEW, ("contact.stick_stiffness", stick)];
            let own = [("*.thermal_expansion", 0.0), ("contact.temperature_limited", 1.0), (name, value)];
            let starts = [&level[..], &own].concat();
            in_steps(&starts, inputs, &[], 3)
        };
        let told = at("contact.temperature_limit", 295.0, SLIDING);
        assert_one(&told, &["contact.temperature_limit = 295 K is exceeded", "bit 2"]);
        assert_eq!(at("contact.temperature_limit", 500.0, SLIDING), SILENT);
        assert_one(&at("punch.wear_limit", 1e-10, SLIDING), &["a wear limit is reached", "bit 1"]);
        assert_eq!(at("punch.wear_limit", 1e-3, SLIDING), SILENT);
        // Ten times the nominal speed, whichever input brings it.
        let radius = Packaged::stock().starts[reference("contact.mean_radius") as usize];
        for (name, factor) in [("sliding_velocity", 1.0), ("angular_velocity", 1.0 / radius)] {
            let speed = |speed: f64| at("nominal.velocity", 1.0, &[(name, speed * factor), ("normal_load", 100.0)]);
            assert_one(&speed(10.1), &["outside the model's validity", "bit 4"]);
            assert_eq!(speed(9.9), SILENT, "{name}");
        }
        let load = |load: f64| at("nominal.load", 100.0, &[("sliding_velocity", 1.0), ("normal_load", load)]);
        assert_one(&load(1001.0), &["outside the model's validity"]);
        assert_eq!(load(999.0), SILENT);
    }
}

#[test]
fn a_bristle_leaves_regularisation_without_effect() {
    let (stick, regular) = (("contact.stick_stiffness", 1e6), ("contact.regularization_velocity", 1e-3));
    assert_one(&at_start(&[stick, regular]), &["contact.stick_stiffness = 1000000 N/m", "0.001 m/s has no effect"]);
    assert_eq!(at_start(&[stick]), SILENT);
    assert_eq!(at_start(&[regular]), SILENT);
}

#[test]
fn a_tilt_that_grows_without_bound_warns_in_reciprocating_sliding() {
    let starts = |stroke: f64, height: f64| {
        let friction = Packaged::stock().starts[reference("contact.friction_coefficient") as usize];
        let half_width = 0.5 * Packaged::stock().starts[reference("punch.width") as usize];
        vec![
            ("solver.fidelity", LINE),
            FEW,
            ("holder.constraint", 2.0),
            ("holder.pivot_height", height * half_width / friction),
            ("nominal.stroke", stroke),
            ("nominal.velocity", 0.1),
        ]
    };
    // In reciprocating sliding half of the half-width is the limit for wear in proportion to the pressure.
    assert_one(&at_start(&starts(0.01, 0.6)), &["increases the tilt without bound", "holder.pivot_height"]);
    assert_eq!(at_start(&starts(0.01, 0.4)), SILENT);
    assert_eq!(at_start(&starts(0.0, 0.6)), SILENT);
}

#[test]
fn a_scene_made_to_slide_above_its_critical_speed_starts_in_silence_and_the_run_tells_of_growth() {
    for (level, coarse) in [(LUMPED, true), (LINE, false)] {
        let starts = |nominal: f64| vec![("solver.fidelity", level), FEW, ("nominal.velocity", nominal)];
        let mut slow = component(&starts(1.0));
        slow.initialise(None).unwrap();
        slow.set_input(reference("normal_load"), 100.0);
        let critical = slow.get(reference("critical_speed"));
        assert!(critical > 0.0);
        assert_eq!(at_start(&starts(2.0 * critical)), SILENT);
        let after = |ratio: f64, load: f64| {
            let inputs = [("sliding_velocity", ratio * critical), ("normal_load", load)];
            in_steps(&starts(critical), &inputs, &[], 2)
        };
        assert_eq!(after(0.99, 1.0), SILENT);
        assert_eq!(after(9.0, 0.0), SILENT);
        // A load that is 0 but for rounding.
        assert_eq!(after(9.0, 1e-13), SILENT);
        let told = after(9.0, 1.0);
        assert_one(&told, &["thermoelastically unstable: pressure perturbations may have grown by exp("]);
        assert_eq!(told[0].contains("this level has one temperature along the contact"), coarse);
    }
}
