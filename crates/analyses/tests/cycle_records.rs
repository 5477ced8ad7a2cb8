//! Every quantity that `steady` and `cycles` draw or return of a reciprocating scene with heat, beside the others of its record and
//! beside time integration, from cold and flat bodies until nothing changes from cycle to cycle.

use analyses::{cycles, steady};
use model::Inputs;
use model::line::Line;
use model::line::operators::LineOperators;
use model::lumped::conditions::Tunables;
use scene::Scene;
use scene_file::SceneFile;
use scene_file::assign;
use serde_json::Value;
use std::sync::Arc;
use test_support::{Drive, examples};

const LOAD: f64 = 1e3;
const SPEED: f64 = 0.01;
const HALF: f64 = 0.1;
const WEAR: f64 = 4e-13;

/// The reciprocating punch at a tenth of its size: heat is steady after ten cycles, wear after some fifty.
fn small(holder: &[&str]) -> SceneFile {
    let mut file = scene_file::shipped::load(Some("reciprocating_punch"), &examples()).unwrap();
    let small = [
        "solver.fidelity=line",
        "solver.cells=17",
        "solver.tolerance=1e-4",
        "punch.width=6 mm",
        "punch.height=6 mm",
        "strip.height=6 mm",
        "punch.wear_coefficient=4e-13",
        "nominal.stroke=1 mm",
        "nominal.velocity=0.01",
        "nominal.load=1000",
        "nominal.duration=60",
    ];
    small.iter().chain(holder).for_each(|text| assign(&mut file, text).unwrap());
    file
}

/// Ends of the communication steps of a half-stroke, s from the reversal: closer behind it, after which stresses and temperatures change
/// like the square root of time. The twelfth is that of the first step of a computed cycle.
fn moments() -> Vec<f64> {
    let early = HALF / 48.0;
    let begin = (1..=12).map(|k| early * (f64::from(k) / 12.0).powi(2));
    begin.chain((1..=47).map(|k| early + (HALF - early) * f64::from(k) / 47.0)).collect()
}

/// What a half-stroke gives by time integration: means by the trapezoidal rule.
struct Stroke {
    pressure: Vec<f64>,
    after_reversal: Vec<f64>,
    at_end: Vec<f64>,
    temperature: [Vec<f64>; 2],
    flux: [Vec<f64>; 2],
    approach: f64,
    tilt: f64,
}

struct Stepped {
    line: Line,
    reference: f64,
}

/// Values of a moment: pressure, temperatures, fluxes, approach and tilt in a row.
fn values(line: &Line) -> Vec<f64> {
    let state = line.state();
    let heat = state.heat.as_ref().unwrap();
    let cells = [&state.pressure, &heat.temperature[0], &heat.temperature[1], &heat.flux[0], &heat.flux[1]];
    cells.into_iter().flatten().copied().chain([state.approach, state.tilt]).collect()
}

impl Stepped {
    fn new(file: &SceneFile) -> Stepped {
        let scene = Scene::new(&file.packaged.starts, None).unwrap();
        let tunables = Tunables::of(&scene);
        let reference = scene.ambient_temperature;
        let operators = LineOperators::with_heat(&scene, true, ::steady::thermal::run_in).unwrap();
        let line = Line::new(Arc::new(operators), tunables, &Inputs::new(SPEED, LOAD, 0.0));
        Stepped { line, reference }
    }

    fn half_stroke(&mut self, velocity: f64, moments: &[f64], mut watch: impl FnMut(&Line)) -> Stroke {
        let count = self.line.operators().count();
        let inputs = Inputs::new(velocity, LOAD, 0.0);
        let mut means = vec![0.0; 5 * count + 2];
        let (mut last, mut before, mut after_reversal) = (0.0, None, Vec::new());
        for &moment in moments {
            self.line.step(&inputs, None, moment - last).unwrap();
            let now = values(&self.line);
            // Pressure and flux jump at the reversal: the first step has its end alone.
            let from = before.take().unwrap_or_else(|| now.clone());
            for (mean, (a, b)) in means.iter_mut().zip(from.iter().zip(&now)) {
                *mean += (moment - last) / HALF * 0.5 * (a + b);
            }
            if (moment * 48.0 / HALF - 1.0).abs() < 1e-9 {
                after_reversal = now[..count].to_vec();
            }
            (last, before) = (moment, Some(now));
            watch(&self.line);
        }
        let part = |index: usize, offset: f64| -> Vec<f64> {
            means[index * count..(index + 1) * count].iter().map(|value| value + offset).collect()
        };
        Stroke {
            pressure: part(0, 0.0),
            after_reversal,
            at_end: self.line.state().pressure.clone(),
            temperature: [part(1, self.reference), part(2, self.reference)],
            flux: [part(3, 0.0), part(4, 0.0)],
            approach: means[5 * count],
            tilt: means[5 * count + 1],
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Fails where values differ by more than `part` of `scale`.
fn agree(name: &str, found: &[f64], expected: &[f64], part: f64, scale: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    let most = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale;
    assert!(most <= part, "{name}: {found:?}\n{expected:?}");
}

fn scene_of(file: &SceneFile) -> Scene {
    Scene::new(&file.packaged.starts, None).unwrap()
}

/// Rigid motions removed: less the value at the middle.
fn shape(depth: &[f64]) -> Vec<f64> {
    depth.iter().map(|value| value - depth[depth.len() / 2]).collect()
}

fn spread(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Compares the quantities of a record with heat with each other.
fn own_sums(record: &Value, scene: &Scene) {
    let heat = &record["heat"];
    let widths = numbers(&record["widths"]);
    let area_mean = |values: &[f64]| {
        values.iter().zip(&widths).map(|(value, width)| value * width).sum::<f64>() / widths.iter().sum::<f64>()
    };
    let mean_pressure = number(&record["pressure_mean"]);
    let mean = number(&heat["contact_temperature"]["mean"]);
    let rise = mean - scene.ambient_temperature;
    let strokes = heat["strokes"].as_array().unwrap();
    let of_strokes = |name: &str| strokes.iter().map(|stroke| area_mean(&numbers(&stroke[name]))).sum::<f64>() / 2.0;
    let both = 0.5 * (of_strokes("temperature_punch") + of_strokes("temperature_strip"));
    agree("mean of the strokes' temperatures", &[both], &[mean], 1e-9, rise);
    let flow = |name: &str| number(&heat["heat_flow"][name]);
    let whole = scene.depth * widths.iter().sum::<f64>();
    for body in ["punch", "strip"] {
        let flux = of_strokes(&format!("heat_flux_{body}")) * whole;
        agree(&format!("flux and flow into the {body}"), &[flux], &[flow(body)], 1e-9, flow("friction"));
    }
    agree("friction power", &[flow("friction")], &[number(&heat["friction_power"])], 1e-9, flow("friction"));
    for stroke in strokes {
        agree(
            "load of the mean pressure",
            &[area_mean(&numbers(&stroke["pressure"]))],
            &[mean_pressure],
            1e-9,
            mean_pressure,
        );
        for body in ["punch", "strip"] {
            let range = |name: &str| numbers(&heat["surface_temperature"][name][usize::from(body == "strip")]);
            let stroke_mean = numbers(&stroke[format!("temperature_{body}")]);
            for ((low, high), own) in range("least").iter().zip(range("largest")).zip(stroke_mean) {
                assert!(*low - 1e-9 <= own && own <= high + 1e-9, "{body}: {low} {own} {high}");
            }
        }
    }
}

/// The scene as it is shipped: in its steady cycle the operators of every step are exact, and nothing needs the temperature of a first
/// stage.
#[test]
fn everything_of_the_shipped_scene_agrees_with_its_own_sums() {
    let file = scene_file::shipped::load(Some("reciprocating_punch"), &examples()).unwrap();
    own_sums(&steady::solve(&file, &steady::Options::default()).unwrap().record(), &scene_of(&file));
}

#[test]
fn everything_of_a_steady_cycle_is_that_of_time_integration_and_of_its_own_sums() {
    for holder in [&[][..], &["holder.constraint=translate_and_rotate", "holder.pivot_height=3 mm"]] {
        let file = small(holder);
        let scene = scene_of(&file);
        let record = steady::solve(&file, &steady::Options::default()).unwrap().record();
        let heat = &record["heat"];
        let ambient = scene.ambient_temperature;
        let mean_pressure = LOAD / (6e-3 * scene.depth);
        let contact = &heat["contact_temperature"];
        let [least, mean, largest] = ["least", "mean", "largest"].map(|name| number(&contact[name]));
        let rise = mean - ambient;

        own_sums(&record, &scene);
        let strokes = heat["strokes"].as_array().unwrap();
        let flow = |name: &str| number(&heat["heat_flow"][name]);
        assert!((least..=largest).contains(&mean));

        // Beside time integration.
        let mut stepped = Stepped::new(&file);
        let mut drive = Drive::from_starts(&file.packaged.starts, &[]);
        drive.set("normal_load", LOAD);
        let coarse: Vec<f64> = (1..=10).map(|k| HALF * f64::from(k) / 10.0).collect();
        for _ in 0..250 {
            for velocity in [SPEED, -SPEED] {
                stepped.half_stroke(velocity, &coarse, |_| ());
                drive.set("sliding_velocity", velocity);
                for _ in &coarse {
                    drive.step(HALF / 10.0);
                }
            }
        }
        let totals = [
            ("heat_received_punch", "punch"),
            ("heat_received_strip", "strip"),
            ("heat_lost_punch_top", "punch_top"),
            ("heat_lost_strip_base", "strip_base"),
            ("heat_lost_ambient", "ambient"),
            ("dissipated_energy", "friction"),
        ];
        let before = totals.map(|(name, _)| drive.get(name));
        let volume_before = stepped.line.state().volume[0];
        let moments = moments();
        let (mut range, mut hottest) = ([f64::INFINITY, 0.0, f64::NEG_INFINITY], f64::NEG_INFINITY);
        let (mut low, mut high) = (vec![f64::INFINITY; 34], vec![f64::NEG_INFINITY; 34]);
        let mut work = 0.0;
        let mut reference = Vec::new();
        for velocity in [SPEED, -SPEED] {
            drive.set("sliding_velocity", velocity);
            let (mut last, mut power_before) = (0.0, None);
            for &moment in &moments {
                drive.step(moment - last);
                let temperature = drive.get("contact_temperature");
                range = [range[0].min(temperature), range[1], range[2].max(temperature)];
                hottest = f64::max(hottest, drive.get("contact_temperature_max"));
                let power = drive.get("wear_dissipation_power");
                work += (moment - last) * 0.5 * (power + power_before.unwrap_or(power));
                (last, power_before) = (moment, Some(power));
            }
            reference.push(stepped.half_stroke(velocity, &moments, |line| {
                let heat = line.state().heat.as_ref().unwrap();
                for (i, t) in heat.temperature.iter().flatten().enumerate() {
                    (low[i], high[i]) = (low[i].min(ambient + t), high[i].max(ambient + t));
                }
            }));
        }
        agree("contact temperature, least and largest", &[least, largest], &[range[0], range[2]], 2e-3, rise);
        let highest = number(&contact["highest"]);
        agree("highest temperature", &[highest], &[hottest], 2e-3, hottest - ambient);
        for (name, extreme) in [("least", &low), ("largest", &high)] {
            let surfaces = &heat["surface_temperature"][name];
            let own: Vec<f64> = (0..2).flat_map(|side| numbers(&surfaces[side])).collect();
            agree(&format!("surface temperature, {name}"), &own, extreme, 1e-2, rise);
        }
        let period = 2.0 * HALF;
        for ((name, own), before) in totals.iter().zip(before) {
            let mean = (drive.get(name) - before) / period;
            agree(own, &[flow(own)], &[mean], 2e-3, flow("friction"));
        }
        agree(
            "wear dissipation power",
            &[number(&heat["wear_dissipation_power"])],
            &[work / period],
            3e-3,
            work / period,
        );
        let volume = (stepped.line.state().volume[0] - volume_before) * scene.depth / period;
        agree("volume rate", &[number(&heat["volume_rates"][0])], &[volume], 1e-3, volume);
        agree(
            "wear rate",
            &[number(&heat["punch_wear_rate"])],
            &[WEAR * mean_pressure * SPEED],
            1e-3,
            WEAR * mean_pressure * SPEED,
        );
        if holder.is_empty() {
            let worn = shape(&stepped.line.state().punch);
            agree("shape", &shape(&numbers(&heat["shape"])), &worn, 1e-2, spread(&worn));
        }
        for (own, expected) in strokes.iter().zip(&reference) {
            agree("pressure", &numbers(&own["pressure"]), &expected.pressure, 5e-3, mean_pressure);
            agree(
                "pressure after the reversal",
                &numbers(&own["pressure_after_reversal"]),
                &expected.after_reversal,
                1e-2,
                mean_pressure,
            );
            agree("pressure at the end", &numbers(&own["pressure_at_end"]), &expected.at_end, 5e-3, mean_pressure);
            for (side, body) in ["punch", "strip"].into_iter().enumerate() {
                let temperature = numbers(&own[format!("temperature_{body}")]);
                agree(&format!("temperature of the {body}"), &temperature, &expected.temperature[side], 5e-3, rise);
                let flux = numbers(&own[format!("heat_flux_{body}")]);
                let scale = scene.friction_coefficient * mean_pressure * SPEED;
                agree(&format!("flux into the {body}"), &flux, &expected.flux[side], 3e-2, scale);
            }
        }
        // Worn depths stay in the steps from cold: what is left of approach and tilt are their jumps at the reversals.
        let jump = |name: &str| number(&strokes[0][name]) - number(&strokes[1][name]);
        let [forward, backward] = &reference[..] else { panic!("two strokes") };
        let sunk = WEAR * mean_pressure * SPEED * HALF;
        agree("jump of the approach", &[jump("approach")], &[forward.approach - backward.approach], 2e-2, sunk);
        agree("jump of the tilt", &[jump("tilt")], &[forward.tilt - backward.tilt], 2e-2, sunk / 3e-3);
    }
}

/// Also where conductivity falls by two fifths and specific heat doubles over the rise: jumps have the properties of the steady cycle.
#[test]
fn everything_of_many_cycles_is_that_of_every_cycle() {
    let table = "property_table={temperature=[293.15, 300], conductivity=[50, 30], specific_heat=[460, 920]}";
    let tables = ["punch", "strip"].map(|body| format!("{body}.{table}"));
    let [constant, tabulated] = [&[][..], &[&*tables[0], &*tables[1]]].map(many_cycles);
    assert!(tabulated > 1.1 * constant, "{tabulated} {constant}");
}

/// Rise of the contact temperature (K) in many cycles of the small scene with changes, which its jumps must give.
fn many_cycles(changes: &[&str]) -> f64 {
    let file = small(changes);
    let mut stepped = Stepped::new(&file);
    let cycles = 60_u32;
    let moments = moments();
    let coarse: Vec<f64> = (1..=10).map(|k| HALF * f64::from(k) / 10.0).collect();
    for _ in 1..cycles {
        for velocity in [SPEED, -SPEED] {
            stepped.half_stroke(velocity, &coarse, |_| ());
        }
    }
    let widths = stepped.line.operators().cells.widths().to_vec();
    let mean =
        |values: &[f64]| values.iter().zip(&widths).map(|(v, w)| v * w).sum::<f64>() / widths.iter().sum::<f64>();
    let last = [SPEED, -SPEED].map(|velocity| stepped.half_stroke(velocity, &moments, |_| ()));
    let temperature = last.iter().flat_map(|stroke| &stroke.temperature).map(|values| mean(values)).sum::<f64>() / 4.0;
    let worn = stepped.line.state().punch.clone();
    let highest = last[0].pressure.iter().copied().fold(0.0, f64::max);
    let options = cycles::Options { cycles: f64::from(cycles), tolerance: 1e-4, cells: None, cold: false };
    let record = cycles::advance(&file, &options, &mut |_, _| ()).unwrap().record();
    let station = record["jumps"].as_array().unwrap().last().unwrap();
    let rise = temperature - scene_of(&file).ambient_temperature;
    agree("temperature", &[number(&station["contact_temperature"])], &[temperature], 3e-3, rise);
    agree("worn depth", &[number(&station["wear_depth_punch"])], &[mean(&worn)], 1e-3, mean(&worn));
    agree("pressure", &[number(&station["pressure_max"])], &[highest], 5e-3, highest);
    agree("profile", &numbers(&record["wear_profile_punch"]), &worn, 1e-2, spread(&worn));
    assert_eq!(number(&station["wear_depth_strip"]), 0.0);
    rise
}

/// Above the critical speed, here the FMU's output of that name, a steady state says so, and so does a run-in shape that starts a run.
#[test]
fn an_unstable_steady_state_and_its_shape_say_so() {
    let mut file = scene_file::shipped::load(Some("reciprocating_punch"), &examples()).unwrap();
    for text in
        ["solver.fidelity=line", "solver.cells=17", "contact.initial_shape=run_in", "punch.thermal_expansion=1.2e-4"]
    {
        assign(&mut file, text).unwrap();
    }
    let critical = Drive::from_starts(&file.packaged.starts, &[]).get("critical_speed");
    assert!(critical > 0.0);
    for ratio in [0.9, 1.1] {
        assign(&mut file, &format!("nominal.velocity={}", ratio * critical)).unwrap();
        let solved = steady::solve(&file, &steady::Options::default()).unwrap();
        let record = solved.record();
        assert!(record["heat"]["refused"].is_null(), "{}", record["heat"]["refused"]);
        let warnings = record["heat"]["warnings"].to_string();
        assert_eq!(warnings.contains(&format!("{ratio:.2} times the critical speed")), ratio > 1.0, "{warnings}");
        let scene = Scene::new(&file.packaged.starts, None).unwrap();
        let operators = LineOperators::with_heat(&scene, true, ::steady::thermal::run_in).unwrap();
        let warnings = operators.warnings().join("; ");
        assert_eq!(warnings.contains("run_in is the shape of an unstable steady state"), ratio > 1.0, "{warnings}");
    }
}

/// The highest temperature stands beside that of the same state on half the cells, computed by itself.
#[test]
fn the_highest_temperature_stands_beside_that_on_half_the_cells() {
    let file = small(&[]);
    let solve = |cells| {
        let options = steady::Options { cells: Some(cells), ..steady::Options::default() };
        steady::solve(&file, &options).unwrap().record()["heat"]["contact_temperature"].clone()
    };
    let [fine, half] = [17, 9].map(solve);
    assert_eq!(fine["highest_on_half"]["cells"], 9);
    assert_eq!(fine["highest_on_half"]["value"], half["highest"]);
    assert_ne!(half["highest"], fine["highest"]);
}
