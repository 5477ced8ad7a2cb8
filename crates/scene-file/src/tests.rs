//! Valid scene files, and the message for every invalid entry.

use super::*;
use scene::variables::{COUNT, check_parameter, lookup};
use std::collections::BTreeSet;

fn start(scene: &SceneFile, name: &str) -> f64 {
    scene.packaged.starts[find(name).unwrap() as usize]
}

#[test]
fn a_value_in_another_unit_than_the_si_one_is_doubted_and_no_shipped_one_is() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut scene = crate::shipped::load(Some("disc_brake"), &folder.join("examples")).unwrap();
    for (given, told) in [
        ("contact.mean_radius=117.5", "contact.mean_radius = 117.5 m is improbable; \"117.5 mm\" may be meant"),
        ("depth=55", "depth = 55 m is improbable; \"55 mm\" may be meant"),
        ("strip.density=7.2", "strip.density = 7.2 kg/m3 is improbable; \"7.2 g/cm3\" may be meant"),
    ] {
        crate::assign(&mut scene, given).unwrap();
        assert!(crate::shipped::doubts(&scene).contains(&told.to_owned()), "{:?}", crate::shipped::doubts(&scene));
    }
    let mut scenes = 0;
    let mut folders = vec![folder.join("examples"), folder.join("tests")];
    while let Some(next) = folders.pop() {
        for path in std::fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "toml")
                && let Ok(scene) = crate::shipped::load(path.to_str(), &folder)
            {
                scenes += 1;
                // The circumference of a ring that is large against its width.
                let is_large = path.to_string_lossy().contains("hot_bands");
                let doubts = crate::shipped::doubts(&scene);
                assert!(
                    is_large || !doubts.iter().any(|text| text.contains("improbable")),
                    "{}: {doubts:?}",
                    path.display()
                );
            }
        }
    }
    assert!(scenes > 30, "{scenes}");
}

#[test]
fn values_units_items_arrays_and_materials_are_read() {
    let scene = parse(
        r#"
        name = "bench"
        description = "A bench"
        depth = 0.01
        wear_acceleration = 1_000
        sliding_velocity = "36 km/h"
        ambient_temperature_offset = "5 K"

        [experiment]
        start = 10
        stop = "20 min"
        step = "0.5 s"
        tolerance = "0.01 %"

        [punch]
        material = "grey_cast_iron"
        conductivity = 40.0
        width = "60 mm"
        count = 0x3
        body = "winkler"
        wear_coefficient = "2.0e-5mm3/(N.m)"

        [contact]
        shear_coupling = false
        conductance = 5
        friction_fade.factor = [1, 1.0, "95 %", 0.9, 0.8, 0.7, 0.6, "0.5"]

        [strip]
        base_thermal = "held"
        base_at_ambient = false
        base_temperature = "15 degC"
        "#,
    )
    .unwrap();
    assert_eq!((scene.packaged.name.as_str(), scene.description.as_str()), ("bench", "A bench"));
    assert_eq!(scene.packaged.experiment, Experiment { start: 10.0, stop: 1200.0, step: 0.5, tolerance: 1e-4 });
    for (name, expected) in [
        ("depth", 0.01),
        ("wear_acceleration", 1000.0),
        ("sliding_velocity", 10.0),
        ("ambient_temperature_offset", 5.0),
        ("punch.youngs_modulus", 1.1e11),
        ("punch.conductivity", 40.0),
        ("punch.width", 0.06),
        ("punch.count", 3.0),
        ("punch.body", 2.0),
        ("punch.wear_coefficient", 2e-14),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_fade.factor[3]", 0.95),
        ("contact.friction_fade.factor[8]", 0.5),
        ("strip.base_thermal", 1.0),
        ("strip.base_temperature", 288.15),
        // Not mentioned: the table's own.
        ("strip.height", STARTS[find("strip.height").unwrap() as usize]),
    ] {
        assert_eq!(start(&scene, name), expected, "{name}");
    }
    let given = |name: &str| scene.given.contains(&find(name).unwrap());
    assert!(given("punch.density") && given("depth") && given("contact.friction_fade.factor[1]"));
    assert!(!given("strip.density"));
}

#[test]
fn an_explicit_key_overrides_the_material_wherever_it_stands() {
    for text in ["punch.density = 1\npunch.material = \"bronze\"", "punch.material = \"bronze\"\npunch.density = 1"] {
        let scene = parse(&format!("name = \"a\"\n{text}")).unwrap();
        assert_eq!((start(&scene, "punch.density"), start(&scene, "punch.conductivity")), (1.0, 67.0));
    }
}

#[test]
fn the_experiment_follows_the_nominal_duration() {
    let scene = parse("name = \"a\"\nnominal.duration = \"1 h\"\nexperiment.start = 100").unwrap();
    assert_eq!(
        scene.packaged.experiment,
        Experiment { start: 100.0, stop: 3700.0, step: 3.6, tolerance: STOCK_EXPERIMENT.tolerance }
    );
}

#[test]
fn wear_coefficients_are_read_as_data_sheets_write_them() {
    let read = |text: &str| parse(&format!("name = \"bench\"\n[punch]\nwear_coefficient = \"{text}\""));
    for text in ["2e-5 mm3/(N m)", "2e-5 mm3/N/m", "2e-5 mm^3/(N*m)", "2e-5 mm³/N·m", "2e-14 1/Pa", "2e-14 m3/(N.m)"]
    {
        assert_eq!(start(&read(text).unwrap(), "punch.wear_coefficient"), 2e-14, "{text}");
    }
    let problems = read("2e-5 mm3/J").unwrap_err().to_string();
    assert!(problems.contains("times the friction coefficient"), "{problems}");
}

#[test]
fn every_display_unit_is_the_decimal_number_one_means() {
    for (text, name, expected) in [
        ("20 um", "punch.width", 2e-5),
        ("1.1 kN", "normal_load", 1100.0),
        ("207.9 GPa", "punch.youngs_modulus", 2.079e11),
        ("1.2e-6 mm3/(N.m)", "punch.wear_coefficient", 1.2e-15),
        ("11.9 um/(m.K)", "punch.thermal_expansion", 1.19e-5),
        ("15 degC", "ambient_temperature", 288.15),
        ("0.7 h", "nominal.duration", 2520.0),
        ("7.2 km/h", "sliding_velocity", 2.0),
    ] {
        let scene = parse(&format!("name = \"a\"\n{name} = \"{text}\"")).unwrap();
        assert_eq!(start(&scene, name), expected, "{text}");
    }
}

/// Lines of a scene file that are wrong, and parts of the message that each must give.
#[test]
fn every_mistake_is_named_with_its_key_value_and_what_is_accepted() {
    const WRONG: &[(&str, &[&str])] = &[
        // Text that is no TOML.
        ("punch = ", &["line 2, column", "not TOML"]),
        ("depth = 1\ndepth = 2", &["line 3, column 1", "not TOML", "duplicate key"]),
        ("[punch]\nwidth = 1\n[punch]\nheight = 1", &["not TOML", "line 4"]),
        // Keys.
        ("punch.widht = 1", &["line 2, column 7", "punch.widht", "did you mean punch.width?"]),
        ("solver.scheme = 2", &["line 2, column 8", "solver.scheme", "no such key", "monolithic", "leave it out"]),
        ("strip.width = 1", &["strip.width", "no such key", "punch.width"]),
        ("colour = \"red\"", &["colour", "no such key"]),
        ("experiment.steps = 1", &["experiment.steps", "experiment.step"]),
        ("[profile]\nx = 1", &["profile.x", "calculated by the FMU"]),
        ("wear_depth = 1", &["wear_depth", "calculated by the FMU"]),
        ("punch = 1", &["punch", "no such key"]),
        ("depth.of = 1", &["depth", "a table", "number"]),
        ("\"contact.friction_coefficient\" = 0.1\ncontact.friction_coefficient = 0.2", &["more than once"]),
        // Units.
        ("punch.width = \"60\"", &["punch.width", "\"60\" has no unit", "m, mm, um, km"]),
        ("punch.width = \"60 kg\"", &["\"60 kg\" has the wrong unit \"kg\"", "m, mm, um, km"]),
        ("punch.width = \"mm\"", &["\"mm\" is not a number with a unit", "20 mm"]),
        ("punch.width = \"nan mm\"", &["\"nan mm\" is not a number"]),
        ("ambient_temperature_offset = \"5 degC\"", &["wrong unit \"degC\"", "accepted are K"]),
        ("experiment.stop = \"9 m\"", &["experiment.stop", "s, min, h"]),
        // Ranges, in the unit that was written.
        ("punch.width = \"20000 mm\"", &["punch.width: 20000 mm is outside", "from 0.001 mm to 10000 mm"]),
        ("punch.width = -1", &["-1 m is outside", "from 0.000001 m to 10 m"]),
        ("ambient_temperature = \"-300 degC\"", &["-300 degC is outside", "from -272.15 degC to 9726.85 degC"]),
        ("punch.width = 40", &["40 m is outside", "from 0.000001 m to 10 m; in mm it is written as \"40 mm\""]),
        ("punch.width = \"0,04\"", &["\"0,04\" has a comma; numbers have a decimal point"]),
        ("normal_load = -5", &["-5 N is outside", "at least 0 N"]),
        ("solver.tolerance = 1e-12", &["solver.tolerance: 1e-12 is below the least value other than 0, 1e-10"]),
        ("normal_load = \"1e306 kN\"", &["line 2", "normal_load: 1e306 kN is no finite number in the SI unit"]),
        ("depth = inf", &["depth: inf is not a finite number"]),
        ("depth = nan", &["depth: NaN is not a finite number"]),
        ("contact.faces = 0", &["contact.faces: 0 is outside", "from 1 to 1000"]),
        ("contact.faces = 9223372036854775808", &["contact.faces", "not a finite number"]),
        ("wear_acceleration = \"0 %\"", &["0 % is outside", "from 1e-7 %"]),
        // Types.
        ("depth = true", &["the boolean true", "a number or a string such as \"20 mm\""]),
        ("depth = 2020-01-01", &["the date 2020-01-01"]),
        ("depth = [1]", &["an array", "must be a number"]),
        ("contact.faces = 2.0", &["the number 2.0, but must be an integer"]),
        ("contact.shear_coupling = 1", &["the number 1, but must be true or false"]),
        ("punch.body = 2", &["the number 2", "rigid, winkler, half_plane, elastic"]),
        ("punch.body = \"soft\"", &["\"soft\" is none of rigid, winkler, half_plane, elastic"]),
        ("description = 3", &["description: is the number 3, but must be a string"]),
        // Arrays.
        ("contact.friction_fade.factor = 1", &["an array of 8 elements"]),
        ("contact.friction_fade.factor = [1, 2]", &["has 2 elements, but must have 8"]),
        ("contact.friction_table.speed = []", &["has 0 elements, but must have 1 to 16"]),
        (
            "contact.friction_table.points = 3\ncontact.friction_table.speed = [0, 1]\ncontact.friction_table.coefficient = [0.4, 0.3, 0.2]",
            &["contact.friction_table.speed: has 2 elements, but contact.friction_table.points = 3"],
        ),
        (
            "contact.friction_fade.factor = [1, 1, 1, 1, -1, 1, 1, 1]",
            &["contact.friction_fade.factor[5]: -1 is outside", "from 0 to 1000"],
        ),
        // Texts.
        ("description = \"a\\u0001b\"", &["description: has the character U+0001", "XML"]),
        ("description = \"a\\uFFFFb\"", &["description: has the character U+FFFF"]),
        // Materials.
        ("punch.material = \"wood\"", &["punch.material", "\"wood\"", "grey_cast_iron", "ptfe"]),
        ("strip.material = 1", &["strip.material: is the number 1, but must be a string"]),
        // The experiment.
        ("experiment.stop = -1", &["stop time -1 s"]),
        ("experiment.step = 1e9", &["step 1000000000 s"]),
        ("experiment.tolerance = 0", &["tolerance 0"]),
    ];
    for (text, expected) in WRONG {
        let message = parse(&format!("name = \"a\"\n{text}")).expect_err(text).to_string();
        for part in *expected {
            assert!(message.contains(part), "{text:?} gave {message:?}, without {part:?}");
        }
    }
}

#[test]
fn all_problems_are_told_at_once_in_the_order_of_the_lines() {
    let problems = parse("depth = -1\n[punch]\nwidth = \"1 s\"\nheigth = 2").unwrap_err().0;
    let lines: Vec<(usize, &str)> = problems.iter().map(|problem| (problem.line, problem.key.as_str())).collect();
    assert_eq!(lines, [(1, "name"), (1, "depth"), (3, "punch.width"), (4, "punch.heigth")]);
}

#[test]
fn a_scene_without_its_dimensions_names_those_that_it_runs_with() {
    let of = |text: &str| shipped::warnings(&parse(text).unwrap());
    let own =
        "name = \"own\"\ndepth = 0.02\n[punch]\nwidth = 0.01\nheight = 0.02\n[contact]\nfriction_coefficient = 0.1\n";
    assert_eq!(of(own), ["own does not give strip.height = 0.011: these are of the stock brake, in SI units"]);
    assert_eq!(of(&format!("{own}[strip]\nheight = 0.01\n")), [""; 0]);
}

#[test]
fn a_zero_that_meant_something_names_what_is_set_instead() {
    for (key, instead) in [
        ("punch.initial_temperature", "punch.initial_at_ambient = true"),
        ("strip.base_temperature", "strip.base_at_ambient = true"),
        ("contact.temperature_limit", "contact.temperature_limited = false"),
    ] {
        let problems = parse(&format!("name = \"a\"\n{key} = 0.0")).unwrap_err().to_string();
        assert!(problems.contains(&format!("{key}: 0 K is outside")) && problems.contains(instead), "{problems}");
        let refused = check_parameter(find(key).unwrap(), 0.0).unwrap_err().to_string();
        assert_eq!(refused, format!("{key}: 0 K is below the minimum 1 K; set {instead} instead"));
    }
}

/// A table has as many points as its arrays have elements.
#[test]
fn tables_are_as_long_as_they_are_given() {
    let starts = |scene: &SceneFile, name: &str, count: usize| -> Vec<f64> {
        let first = find(&format!("{name}[1]")).unwrap() as usize;
        scene.packaged.starts[first..first + count].to_vec()
    };
    let fade = "contact.friction_fade";
    let read = parse("name = \"a\"\n[contact]\nfriction_fade.temperature = [300, \"226.85 degC\"]\nfriction_fade.factor = [1, \"70 %\"]").unwrap();
    // Behind the last point the table is constant.
    let temperatures: Vec<f64> = [300.0].into_iter().chain((0..7).map(|k| 500.0 + f64::from(k))).collect();
    assert_eq!(starts(&read, &format!("{fade}.temperature"), 8), temperatures);
    assert_eq!(starts(&read, &format!("{fade}.factor"), 8), [1.0, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7]);
    assert_eq!(read.given.len(), 16);
    let speeds = "[contact]\nfriction_table.speed = [0, 2, 8]\nfriction_table.coefficient = [0.5, 0.4, 0.36]\n";
    let read = parse(&format!("name = \"a\"\n{speeds}")).unwrap();
    assert_eq!(start(&read, "contact.friction_table.points"), 3.0);
    let fewer = parse(&format!("name = \"a\"\n{speeds}friction_table.points = 2")).unwrap();
    assert_eq!(start(&fewer, "contact.friction_table.points"), 2.0);
    // The same by an assignment; an array alone leaves the number of points.
    let mut scene = read.clone();
    assign(&mut scene, "contact.friction_fade={temperature=[\"20 degC\", 500], factor=[1, 0.5]}").unwrap();
    assert_eq!(starts(&scene, &format!("{fade}.factor"), 3), [1.0, 0.5, 0.5]);
    assign(&mut scene, "contact.friction_table.speed=[0, 3]").unwrap();
    assert_eq!(start(&scene, "contact.friction_table.points"), 3.0);
    assert_eq!(starts(&scene, "contact.friction_table.speed", 3), [0.0, 3.0, 8.0]);
    for (text, told) in [
        (
            "contact.friction_fade.factor = [1, 2]",
            "has 2 elements, but must have 8, or as many as contact.friction_fade.temperature",
        ),
        (
            "contact.friction_fade = { temperature = [300, 400, 500], factor = [1, 2] }",
            "contact.friction_fade.factor: has 2 elements, but must have 8, or as many as contact.friction_fade.temperature",
        ),
        (
            "contact.friction_table = { speed = [0, 1], coefficient = [0.4, 0.4, 0.4] }",
            "contact.friction_table.speed: has 2 elements, but contact.friction_table.coefficient has 3",
        ),
    ] {
        let message = parse(&format!("name = \"a\"\n{text}")).unwrap_err().to_string();
        assert!(message.contains(told), "{text}: {message}");
    }
}

#[test]
fn values_without_effect_are_refused_with_the_remedy() {
    let table = "name = \"a\"\n[strip]\nmaterial = \"grey_cast_iron\"\nproperty_table.material = \"grey_cast_iron\"\n";
    let scene = parse(table).unwrap();
    let made = |assignments: &[&str]| {
        let mut scene = scene.clone();
        assign_all(&mut scene, assignments).map(|()| scene).map_err(|error| format!("{error:#}"))
    };
    let remedy = "has no effect while strip.property_table.points = 7; set strip.property_table.points = 0";
    for (assignment, name) in [
        ("strip.conductivity=40", "strip.conductivity = 40"),
        ("strip.specific_heat=500", "strip.specific_heat = 500"),
        ("strip.material=bronze", "strip.conductivity = 67"),
    ] {
        let told = made(&[assignment]).unwrap_err();
        assert!(told.contains(name) && told.contains(remedy), "{told}");
        // In any order.
        for both in [[assignment, "strip.property_table.points=0"], ["strip.property_table.points=0", assignment]] {
            made(&both).unwrap();
        }
    }
    let told = made(&["strip.property_table.points=0", "strip.property_table.conductivity[2]=40"]).unwrap_err();
    assert!(told.contains("conductivity[2] = 40 has no effect while strip.property_table.points = 0"), "{told}");
    let told = parse(&format!("{table}conductivity = 40\n")).unwrap_err().to_string();
    assert!(told.contains(remedy), "{told}");
    parse(&format!("{table}conductivity = 40\nproperty_table.points = 0\n")).unwrap();
    // A shorter table leaves what the scene has behind its last point.
    let other = made(&["strip.property_table.material=aluminium_6061"]).unwrap();
    assert_eq!(scene::Scene::new(&other.packaged.starts, None).unwrap().strip.properties.unwrap().points, 2);
}

/// Numbers as engineers type them, which TOML would not read.
#[test]
fn assigned_numbers_may_begin_and_end_with_their_point_or_begin_with_a_sign() {
    let assigned = |text: &str| {
        let mut scene = parse("name = \"a\"").unwrap();
        assign(&mut scene, text).map(|()| scene).map_err(|error| format!("{error:#}"))
    };
    for (text, name, value) in [
        ("punch.width=.005", "punch.width", 0.005),
        ("punch.width = +.5", "punch.width", 0.5),
        ("punch.width=1.", "punch.width", 1.0),
        ("punch.width=+5.e-3", "punch.width", 5e-3),
        ("punch.width=.5 mm", "punch.width", 5e-4),
        ("punch.width [mm]=+5.", "punch.width", 5e-3),
        ("punch.youngs_modulus=+2E11", "punch.youngs_modulus", 2e11),
        ("contact.faces=+2", "contact.faces", 2.0),
        ("contact.faces=02", "contact.faces", 2.0),
        ("ambient_temperature_offset=-.5", "ambient_temperature_offset", -0.5),
        ("contact.friction_fade.factor[2]=.9", "contact.friction_fade.factor[2]", 0.9),
        (
            "contact.friction_fade.factor=[1., +1, .9, 0.8, \"70 %\", .6, .5, .4]",
            "contact.friction_fade.factor[3]",
            0.9,
        ),
        (
            "contact.friction_fade.factor=[1., +1, .9, 0.8, \"70 %\", .6, .5, .4]",
            "contact.friction_fade.factor[5]",
            0.7,
        ),
    ] {
        assert_eq!(start(&assigned(text).unwrap(), name), value, "{text}");
    }
    for (text, told) in [
        ("punch.width=1,5", "\"1,5\" has a comma"),
        ("punch.width=.mm", "\".mm\" is not a number"),
        ("contact.faces=2.5", "the number 2.5, but must be an integer"),
        ("punch.width=inf", "inf is not a finite number"),
        ("punch.width=-nan", "NaN is not a finite number"),
    ] {
        let message = assigned(text).unwrap_err();
        assert!(message.contains(told), "{text}: {message}");
    }
}

/// Whatever is given, a message stays one that can be read.
#[test]
fn messages_quote_no_more_than_the_beginning_of_a_text() {
    let long = "x".repeat(100_000);
    let fade = "contact.friction_fade.factor";
    let mut messages: Vec<String> = [
        format!("punch.width = \"{long}\""),
        format!("punch.width = \"1 {long}\""),
        format!("punch.body = \"{long}\""),
        format!("punch.material = \"{long}\""),
        format!("{long} = 1"),
        format!("{long}.{long} = 1"),
        format!("{fade} = \"{long}\""),
        format!("depth = 1{}", "0".repeat(100_000)),
    ]
    .map(|text| parse(&format!("name = \"a\"\n{text}")).unwrap_err().to_string())
    .to_vec();
    messages.push(parse(&format!("name = \"{long} \"")).unwrap_err().to_string());
    let mut scene = parse("name = \"a\"").unwrap();
    for text in [
        long.clone(),
        format!("{long}=1"),
        format!("punch.width={long}"),
        format!("{fade}[9{long}]=1"),
        format!("{long}[1]=1"),
    ] {
        messages.push(format!("{:#}", assign(&mut scene, &text).unwrap_err()));
    }
    for text in [
        format!("time,{long}\n0,1\n"),
        format!("time,normal_load [{long}]\n0,1\n"),
        format!("time,normal_load [N]\n0,{long}\n"),
        format!("{long},normal_load [N]\n0,1\n"),
    ] {
        messages.push(format!(
            "{:#}",
            columns::parse(
                text.as_bytes(),
                Path::new("a.csv"),
                &columns::Column::inputs(),
                &columns::Reading::strict()
            )
            .unwrap_err()
        ));
    }
    messages.push(format!("{:#}", shipped::load(Some(&long), Path::new("nowhere")).unwrap_err()));
    for message in messages {
        assert!(message.len() < 1000, "{} bytes: {}", message.len(), &message[..1000]);
    }
}

#[test]
fn the_stock_brake_is_that_of_the_example_without_its_tables_radiation_limits_and_conditions() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let [stock, example] = [None, Some("disc_brake")].map(|name| shipped::load(name, &folder).unwrap().packaged);
    let differing = (0..COUNT).filter(|&at| stock.starts[at] != example.starts[at]);
    let names: BTreeSet<&str> = differing.map(|at| lookup(at as u32).unwrap().0.name).collect();
    let expected = [
        "contact.friction_fade.factor",
        "contact.friction_fade.temperature",
        "contact.temperature_limit",
        "contact.temperature_limited",
        "nominal.duration",
        "nominal.load",
        "nominal.velocity",
        "punch.airborne_fraction",
        "punch.wear_fade.factor",
        "punch.wear_fade.temperature",
        "punch.wear_limit",
        "solver.fidelity",
        "strip.airborne_fraction",
        "strip.emissivity",
        "strip.property_table.conductivity",
        "strip.property_table.points",
        "strip.property_table.specific_heat",
        "strip.property_table.temperature",
        "strip.wear_limit",
    ];
    assert_eq!(names.into_iter().collect::<Vec<_>>(), expected);
}
