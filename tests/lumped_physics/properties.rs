//! Conductivity and specific heat over temperature at both levels, against a slab whose properties are those of its local temperature.

use exact::property_slab::{Face, PropertySlab};
use scene::Scene;
use scene::variables::STARTS;
use test_support::{CONVECTING, Drive, EXTERNAL, HELD, INSULATED, LINE, LUMPED, changed, property_table};

const AIR: f64 = 293.15;
const HEIGHT: f64 = 0.011;
const DENSITY: f64 = 7850.0;
const AREA: f64 = 0.1;
const PERIODIC: f64 = 3.0;

/// A level, and the largest error of temperatures by a step in it: properties are constant over parts of the temperature on the line.
const LEVELS: [(&str, &[(&str, f64)]); 2] =
    [("lumped", &[("solver.fidelity", LUMPED)]), ("line", &[("solver.fidelity", LINE), ("solver.cells", 9.0)])];

/// Carbon steel by EN 1993-1-2, section 3.4.1, at a temperature in degC: conductivity and specific heat.
fn steel(t: f64) -> (f64, f64) {
    let heat = match t {
        t if t < 600.0 => 425.0 + 0.773 * t - 1.69e-3 * t * t + 2.22e-6 * t * t * t,
        t if t < 735.0 => 666.0 + 13002.0 / (738.0 - t),
        t if t < 900.0 => 545.0 + 17820.0 / (t - 731.0),
        _ => 650.0,
    };
    (if t < 800.0 { 54.0 - 3.33e-2 * t } else { 27.3 }, heat)
}

const POINTS: [f64; 10] = [20.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 650.0, 700.0, 735.0];

/// Temperature (K), conductivity and specific heat.
fn points() -> Vec<(f64, f64, f64)> {
    POINTS.iter().map(|&t| (t + 273.15, steel(t).0, steel(t).1)).collect()
}

/// A strip that an insulating punch covers all round: conduction through its height alone. mu F v = 10 N m/s per N.
fn covered(more: &[(&'static str, f64)]) -> Vec<(&'static str, f64)> {
    let fixed = [
        ("contact.geometry", PERIODIC),
        ("punch.width", 1.0),
        ("strip.length", 1.0),
        ("depth", AREA),
        ("contact.faces", 1.0),
        ("contact.friction_coefficient", 1.0),
        ("contact.conductance", 1e15),
        ("punch.conductivity", 0.0),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("*.wear_coefficient", 0.0),
        ("strip.base_thermal", INSULATED),
        ("strip.height", HEIGHT),
        ("strip.density", DENSITY),
        ("strip.conductivity", steel(20.0).0),
        ("strip.specific_heat", steel(20.0).1),
        ("ambient_temperature", AIR),
        ("nominal.velocity", 0.0),
        ("nominal.load", 0.0),
        ("nominal.duration", 100.0),
    ];
    [&fixed, more].concat()
}

fn drive(changes: &[(&str, f64)]) -> Drive {
    let mut drive = Drive::stock(changes);
    drive.set("sliding_velocity", 10.0);
    drive
}

/// A flux (W/m2) that goes linearly from the first to the second value in a duration (s).
type Phase = (f64, f64, f64);

/// Contact temperatures (K) of the component at the ends of steps of about `step` (s).
fn component(drive: &mut Drive, phases: &[Phase], step: f64) -> Vec<f64> {
    let mut all = Vec::new();
    for &(from, to, duration) in phases {
        let count = (duration / step).round().max(1.0);
        let step = duration / count;
        let slope = (to - from) / duration;
        for i in 0..count as u32 {
            let flux = from + slope * step * f64::from(i);
            drive.set("normal_load", flux * AREA / 10.0).slope("normal_load", slope * AREA / 10.0).step(step);
            all.push(drive.get("contact_temperature"));
        }
    }
    all
}

/// The same of the slab, in `parts` parts of a step.
fn slab(slab: &mut PropertySlab, phases: &[Phase], step: f64, parts: u32) -> Vec<f64> {
    let mut all = Vec::new();
    for &(from, to, duration) in phases {
        let count = (duration / step).round().max(1.0) as u32 * parts;
        let step = duration / f64::from(count);
        let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(count);
        for i in 0..count {
            slab.advance(step, at(i), at(i + 1));
            if (i + 1) % parts == 0 {
                all.push(slab.surface());
            }
        }
    }
    all
}

/// Largest difference over the largest rise.
fn difference(computed: &[f64], exact: &[f64]) -> f64 {
    let rise = exact.iter().fold(0.0, |most: f64, t| most.max((t - exact[0]).abs()));
    computed.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / rise
}

/// Stops of 4 s every 60 s.
fn stops(count: usize, flux: f64) -> Vec<Phase> {
    (0..count).flat_map(|_| [(flux, 0.0, 4.0), (0.0, 0.0, 56.0)]).collect()
}

#[test]
fn temperatures_are_those_of_local_properties_to_a_hundredth() {
    let none = Face::Convecting(0.0, AIR);
    let air = Face::Convecting(120.0, AIR);
    let to_air = [("strip.base_thermal", CONVECTING), ("strip.convection", 120.0)];
    let both = [to_air[0], to_air[1], ("strip.cooled_area", AREA)];
    let held = [("strip.base_thermal", HELD)];
    let mut failed = Vec::new();
    for (name, phases, more, faces, constants) in [
        ("one stop", stops(1, 3e6), &[][..], [none, none], 0.05),
        ("fifteen stops", stops(15, 2.2e6), &to_air, [none, air], 0.1),
        ("fifteen stops, both faces in air", stops(15, 2.9e6), &both, [air, air], 0.1),
        ("drag", vec![(2.2e5, 2.2e5, 150.0)], &to_air, [none, air], 0.1),
        ("held base", vec![(1.5e6, 1.5e6, 20.0), (0.0, 0.0, 10.0)], &held, [none, Face::Held(AIR)], 0.05),
        ("heating and cooling", vec![(6e5, 6e5, 50.0), (0.0, 0.0, 600.0)], &both, [air, air], 0.1),
    ] {
        let step = if phases.len() < 4 { 0.1 } else { 1.0 };
        let mut exact = PropertySlab::new(HEIGHT, DENSITY, &points(), faces, 60, AIR);
        let exact = slab(&mut exact, &phases, step, 20);
        let constant = difference(&component(&mut drive(&covered(more)), &phases, step), &exact);
        for (level, of_level) in LEVELS {
            // The line has no air beside a contact that covers everything.
            if level == "line" && faces[0] != none {
                continue;
            }
            let with = [covered(&[more, of_level].concat()), property_table("strip", &points())].concat();
            let error = difference(&component(&mut drive(&with), &phases, step), &exact);
            if error >= 0.01 || constant <= constants {
                failed.push(format!("{level}, {name}: {error}, of constants {constant}"));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn a_table_of_constants_is_a_body_of_constants() {
    let more = [("strip.base_thermal", CONVECTING), ("strip.convection", 120.0)];
    let constant = |t: f64| (t, steel(20.0).0, steel(20.0).1);
    let phases = stops(3, 3e6);
    for (level, of_level) in LEVELS {
        let scene = covered(&[&more[..], of_level].concat());
        let with = [scene.clone(), property_table("strip", &[constant(300.0), constant(800.0)])].concat();
        let mut runs = [drive(&with), drive(&scene)];
        let [computed, exact] = runs.each_mut().map(|run| component(run, &phases, 1.0));
        let error = difference(&computed, &exact);
        assert!(error < 2e-6, "{level}: {error}");
        for name in ["heat_lost_strip_base", "stored_heat", "heat_received_strip", "strip.mean_temperature"] {
            let [one, other] = runs.each_mut().map(|run| run.get(name));
            assert!((one - other).abs() < 2e-6 * other.abs(), "{level}, {name}: {one} {other}");
        }
    }
}

#[test]
fn steps_are_of_second_order() {
    // A smooth course of the flux, as the limits of a step in a jump are another question.
    for (level, of_level) in LEVELS {
        let run = |steps: u32| {
            let with =
                [covered(&[&[("solver.tolerance", 0.1)], of_level].concat()), property_table("strip", &points())]
                    .concat();
            let mut drive = drive(&with);
            let flux = |part: f64| 4e6 * (std::f64::consts::PI * part).sin().powi(2);
            for i in 0..steps {
                let [now, next] = [i, i + 1].map(|i| flux(f64::from(i) / f64::from(steps)));
                let step = 8.0 / f64::from(steps);
                drive.set("normal_load", now * AREA / 10.0).slope("normal_load", (next - now) / step * AREA / 10.0);
                drive.step(step);
            }
            drive.get("contact_temperature")
        };
        let fine = run(2048);
        let errors = [8, 16, 32, 64].map(|steps| (run(steps) - fine).abs());
        // Properties are constant over parts of a hundredth, and the error falls to that.
        assert!(errors.windows(2).all(|pair| pair[1] < (0.35 * pair[0]).max(0.05)), "{level}: {errors:?}");
    }
}

#[test]
fn heat_is_conserved_and_flows_are_those_of_the_account() {
    let held = [("strip.base_thermal", HELD)];
    let air = [("strip.base_thermal", CONVECTING), ("strip.convection", 300.0), ("strip.cooled_area", AREA)];
    for (level, of_level) in LEVELS {
        for more in [&[][..], &held, &air] {
            let with = [
                covered(&[more, of_level, &[("solver.tolerance", 1e-4)]].concat()),
                property_table("strip", &points()),
            ]
            .concat();
            let mut drive = drive(&with);
            let (mut sums, step, count) = ([0.0; 2], 0.02, 1500);
            let mut before = [0.0; 2];
            for i in 0..=count {
                let flux =
                    |i: u32| 2e6 * (std::f64::consts::PI * f64::from(i) / f64::from(count)).sin().powi(2) * AREA / 10.0;
                let now = ["heat_flow_ambient", "heat_flow_strip_base"].map(|name| drive.get(name));
                for k in 0..2 {
                    sums[k] += if i > 0 { 0.5 * step * (before[k] + now[k]) } else { 0.0 };
                }
                before = now;
                if i < count {
                    drive.set("normal_load", flux(i)).slope("normal_load", (flux(i + 1) - flux(i)) / step).step(step);
                }
            }
            let imbalance = drive.imbalance();
            assert!(imbalance < 1e-11, "{level} {more:?}: {imbalance:e}");
            let received = drive.get("heat_received_strip");
            for (name, sum) in [("heat_lost_ambient", sums[0]), ("heat_lost_strip_base", sums[1])] {
                let lost = drive.get(name);
                assert!((lost - sum).abs() < 2e-4 * received, "{level} {more:?} {name}: {lost} {sum} of {received}");
            }
        }
    }
}

#[test]
fn nothing_jumps_where_a_property_changes() {
    // Heating at a constant flux through points of the table and parts of the temperature.
    for (level, of_level) in LEVELS {
        let with = [covered(of_level), property_table("strip", &points())].concat();
        let mut drive = drive(&with);
        let temperatures = component(&mut drive, &[(5e5, 5e5, 40.0)], 0.02);
        let rises: Vec<f64> = temperatures.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // After ten seconds the rise is nearly steady. A part of the temperature ends in a kink, not in a jump: the
        // heated layer of a step is that of the next properties.
        let kink = rises.windows(2).skip(500).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let last = temperatures[temperatures.len() - 1];
        assert!(last > 700.0 && kink < 2e-4 * (last - AIR), "{level}: {kink}");
    }
}

/// A run with tables of both bodies whose values do not change is that without, wherever tables meet another part of the model.
#[test]
fn tables_of_constants_change_nothing_on_an_annulus_with_elastic_slip_tracks_and_neighbours() {
    let annulus = [("contact.geometry", 2.0), ("contact.mean_radius", 0.1), ("punch.width", 0.04), ("depth", 0.08)];
    let slip = [("contact.tangential_compliance", 1.0), ("nominal.stroke", 1e-3), ("nominal.velocity", 0.05)];
    let track =
        [("strip.path", 1.0), ("strip.length", 0.0), ("nominal.stroke", 0.05), ("strip.wear_coefficient", 1e-14)];
    let neighbour =
        [("strip.base_thermal", EXTERNAL), ("*.external_temperature", AIR), ("punch.external_conductance", 2.0)];
    let mut failed = Vec::new();
    for (level, of_level) in LEVELS {
        for (name, more) in [("annulus", &annulus[..]), ("slip", &slip), ("track", &track), ("neighbour", &neighbour)] {
            let own = [("punch.conductivity", 20.0), ("punch.convection", 60.0), ("solver.tolerance", 1e-4)];
            let scene = [&own, of_level, more].concat();
            let run = |tables: [[f64; 3]; 2]| {
                let mut with = scene.clone();
                for (body, [conductivity, specific_heat, change]) in ["punch", "strip"].into_iter().zip(tables) {
                    let hot = (1500.0, conductivity * (1.0 - 0.5 * change), specific_heat * (1.0 + change));
                    with.extend(property_table(body, &[(AIR, conductivity, specific_heat), hot]));
                }
                Drive::stock(&with)
            };
            let constants = run([[20.0, 1000.0, 0.0], [54.0, 460.0, 0.0]]);
            let mut drives = [Drive::stock(&scene), constants, run([[20.0, 1000.0, 1.0], [54.0, 460.0, 1.0]])];
            for drive in &mut drives {
                for step in 0..60 {
                    let velocity = if more.iter().any(|(name, _)| *name == "nominal.stroke") {
                        if step / 5 % 2 == 0 { 0.05 } else { -0.05 }
                    } else {
                        8.0
                    };
                    let air = if step < 30 { AIR } else { AIR + 150.0 };
                    if name == "neighbour" {
                        drive.set("strip.external_temperature", air).set("punch.external_temperature", air);
                    }
                    drive.set("sliding_velocity", velocity).set("normal_load", 3e3).step(0.05);
                }
                let imbalance = drive.imbalance();
                if imbalance >= 1e-9 {
                    failed.push(format!("{level}, {name}: imbalance {imbalance:e}"));
                }
            }
            for output in ["contact_temperature", "wear_volume_punch", "strip.mean_temperature", "friction_force"] {
                let [without, with, changing] = drives.each_mut().map(|drive| drive.get(output));
                let origin = if output.ends_with("temperature") { AIR } else { 0.0 };
                if (with - without).abs() > 2e-4 * (without - origin).abs() {
                    failed.push(format!("{level}, {name}, {output}: {without} {with}"));
                }
                if output == "contact_temperature" && with == changing {
                    failed.push(format!("{level}, {name}: the tables have no effect"));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn a_table_with_a_fault_is_refused_by_name() {
    let falling = [property_table("strip", &points()), vec![("strip.property_table.temperature[3]", 373.15)]].concat();
    for (changes, words) in [
        (&falling[..], ["temperature[3] = 373.15 K must be above", "temperature[2] = 373.15 K"]),
        (&[("punch.property_table.points", 1.0)], ["punch.property_table.points = 1", "at least 2"]),
    ] {
        let text = Scene::new(&changed(&STARTS, changes), None).unwrap_err().to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
}
