//! `cargo fmu simulate` as a user starts it: results, round trips, and what every wrong input is refused with.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A folder of its own for every test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("simulate-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, text: &str) -> &Self {
        fs::write(self.0.join(name), text).unwrap();
        self
    }

    /// Runs the command in the folder: whether it succeeds, its output and what it tells.
    fn run(&self, arguments: &[&str]) -> (bool, String, String) {
        self.command("simulate", arguments)
    }

    fn command(&self, name: &str, arguments: &[&str]) -> (bool, String, String) {
        let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_fmu-lab"))
            .arg(name)
            .args(arguments)
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        (status.success(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let (success, text, told) = self.run(&[arguments, &["--json"]].concat());
        assert!(success, "{arguments:?}: {told}");
        serde_json::from_str(&text).unwrap()
    }

    fn refusal(&self, arguments: &[&str]) -> String {
        let (success, text, told) = self.run(arguments);
        assert!(!success && text.is_empty(), "{arguments:?} was accepted: {text}");
        told
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Columns of a CSV file.
fn columns(path: &Path) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    names.into_iter().enumerate().map(|(at, name)| (name, rows.iter().map(|row| row[at]).collect())).collect()
}

const STOP: &str = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.5,36,4\n2,0,4\n2.5,0,0\n";
const WITHOUT_RADIUS: [&str; 4] = ["--set", "contact.mean_radius=.0", "--set", "strip.length=.7"];
const LINE: [&str; 4] = ["--set", "solver.fidelity=line", "--set", "solver.cells=9"];

#[test]
fn inputs_are_driven_as_they_stand_and_energy_and_distance_follow() {
    let folder = Folder::new("stop");
    folder.file("in.csv", STOP);
    let result = folder.json(&["disc_brake", "-i", "in.csv", "-o", "out.csv", "--step", "20 ms"]);
    assert_eq!(result["communication_steps"], 125);
    let end = |name: &str| result["variables"][name]["end"].as_f64().unwrap();
    // 10 m/s for 0.5 s, then down to 0 within 1.5 s.
    assert!((end("sliding_distance") - 12.5).abs() < 1e-9);
    // Two faces: mu F v = 2 x 0.4 x 4 kN x v, the load ramped over the first half second; below the fade of friction.
    let heat = 2.0 * 0.4 * 4e3 * (0.5 * 10.0 * 0.5 + 0.5 * 10.0 * 1.5);
    assert!((end("dissipated_energy") / heat - 1.0).abs() < 1e-3, "{} {heat}", end("dissipated_energy"));
    assert!(result["energy_residual"].as_f64().unwrap() < 1e-12);
    let written = columns(&folder.0.join("out.csv"));
    let of = |name: &str| &written.iter().find(|(own, _)| own == name).unwrap().1;
    assert_eq!(of("time [s]").len(), 126);
    let row = of("time [s]").iter().position(|time| (time - 1.1).abs() < 1e-9).unwrap();
    assert!((of("sliding_velocity [m/s]")[row] - 6.0).abs() < 1e-9);
    assert_eq!(of("normal_load [N]")[row], 4000.0);
    let wear = of("wear_depth [m]").last().copied().unwrap();
    assert!(wear > 1e-8 && (wear / end("wear_depth") - 1.0).abs() < 1e-14, "{wear} {}", end("wear_depth"));
}

/// Heat that only passes from a hot disc into its pads, at rest and insulated: nothing is made or lost, and the sum stored is rounding.
#[test]
fn the_balance_closes_where_heat_only_passes_between_the_bodies() {
    let folder = Folder::new("pass");
    folder.file("in.csv", "time [s],sliding_velocity [km/h],normal_load [kN]\n0,0,4\n20,0,4\n");
    let insulated = ["punch.top_thermal=insulated", "punch.convection=0", "strip.convection=0", "strip.emissivity=0"];
    let hot = ["strip.initial_at_ambient=false", "strip.initial_temperature=120 degC"];
    let settings: Vec<&str> = insulated.iter().chain(&hot).flat_map(|one| ["--set", *one]).collect();
    for level in [&["--set", "solver.fidelity=lumped"][..], &LINE] {
        let result = folder.json(&[&["disc_brake", "-i", "in.csv", "--step", "1 s"], level, &settings[..]].concat());
        let end = |name: &str| result["variables"][name]["end"].as_f64().unwrap();
        assert!(end("heat_received_punch") > 1e3 && end("dissipated_energy") == 0.0, "{}", end("heat_received_punch"));
        assert!(result["energy_residual"].as_f64().unwrap() < 1e-11, "{}", result["energy_residual"]);
        let cold = folder.json(&[&["disc_brake", "-i", "in.csv", "--step", "1 s"], level].concat());
        assert!(cold["energy_residual"].as_f64().unwrap() == 0.0, "{}", cold["energy_residual"]);
    }
}

#[test]
fn an_input_that_acts_on_nothing_is_told_and_folders_are_made() {
    let folder = Folder::new("idle");
    folder.file(
        "in.csv",
        &STOP
            .replace("load [kN]", "load [kN],strip.external_temperature [degC]")
            .replace(",0\n", ",0,20\n")
            .replace(",4\n", ",4,20\n"),
    );
    let (success, table, _) = folder.run(&["disc_brake", "-i", "in.csv", "-o", "new/folder/out.csv"]);
    assert!(success && folder.0.join("new/folder/out.csv").is_file(), "{table}");
    assert!(table.contains("strip.external_temperature has no effect: strip.external_conductance is 0 W/K"), "{table}");
    // Rounding is no heat.
    assert!(table.contains(", 0 J through the strip's base"), "{table}");
    let acting = ["disc_brake", "-i", "in.csv", "--set", "strip.external_conductance=2 W/K"];
    assert!(!folder.run(&acting).1.contains("has no effect"));
    // A rotation without a radius, beside a velocity.
    let text = STOP
        .replace("load [kN]", "load [kN],angular_velocity [rad/s]")
        .replace(",0\n", ",0,3\n")
        .replace(",4\n", ",4,3\n");
    folder.file("rotating.csv", &text);
    let rotating = ["disc_brake", "-i", "rotating.csv"];
    assert!(!folder.run(&rotating).1.contains("has no effect"));
    let (_, table, _) = folder.run(&[&rotating[..], &WITHOUT_RADIUS[..]].concat());
    assert!(table.contains("angular_velocity = 3 rad/s has no effect: contact.mean_radius = 0 m"), "{table}");
}

/// A stop of a minute in a day: its peak and its record, made by fine steps, are seen by the steps of the default.
#[test]
fn steps_of_the_default_follow_the_inputs() {
    let folder = Folder::new("day");
    let day = "time [s],sliding_velocity [m/s],normal_load [N]\n0,12,0\n40000,12,0\n40001,12,2000\n40060,0,2000\n40061,0,0\n86400,0,0\n";
    let minute = "time [s],sliding_velocity [m/s],normal_load [N]\n39990,12,0\n40000,12,0\n40001,12,2000\n40060,0,2000\n40061,0,0\n40200,0,0\n";
    folder.file("day.csv", day).file("minute.csv", minute);
    let fine = folder.json(&["disc_brake", "-i", "minute.csv", "--step", "20 ms", "-o", "fine.csv"]);
    let result = folder.json(&["disc_brake", "-i", "day.csv", "-m", "fine.csv"]);
    let number = |result: &Value, name: &str, key: &str| result["variables"][name][key].as_f64().unwrap();
    for name in ["contact_temperature_max", "contact_temperature", "friction_force", "pressure_max"] {
        let [own, exact] = [&result, &fine].map(|result| number(result, name, "maximum"));
        let rise = exact - number(&fine, name, "minimum");
        assert!((own - exact).abs() < 5e-3 * rise, "{name}: {own} {exact}");
    }
    let deviations = result["measured"].as_array().unwrap();
    let temperature = deviations.iter().find(|own| own["name"] == "contact_temperature").unwrap();
    assert!(temperature["largest_over_range"].as_f64().unwrap().abs() < 2e-2, "{temperature}");
    // Up to 1000 of them are times of the record.
    assert!(result["communication_steps"].as_u64().unwrap() < 3000, "{}", result["communication_steps"]);
    // The record is a file of inputs too.
    let again = folder.run(&["disc_brake", "-i", "fine.csv", "--json"]).1;
    assert!(again.contains("other outputs are left out"), "{again}");
}

#[test]
fn without_inputs_the_scene_runs_at_its_nominal_values() {
    let folder = Folder::new("nominal");
    let result = folder.json(&["pin_on_disk", "--set", "solver.fidelity=lumped", "--set", "nominal.load=20 N"]);
    let end = |name: &str| result["variables"][name]["end"].as_f64().unwrap();
    assert_eq!((end("normal_load"), end("sliding_velocity"), result["stop"].as_f64()), (20.0, 0.1, Some(1e4)));
    // k F s of the interlaboratory test at twice its load.
    assert!((end("wear_volume_punch") / (2.0 * 198e-12) - 1.0).abs() < 1e-9, "{}", end("wear_volume_punch"));
    let set = ["--set", "nominal.duration=0.7 s", "--set", "solver.fidelity=lumped"];
    let strokes = folder.json(&[&["reciprocating_punch"], &set[..]].concat());
    let least = strokes["variables"]["sliding_velocity"]["minimum"].as_f64().unwrap();
    assert!((least / -15e-3 - 1.0).abs() < 1e-2, "{least}");
}

#[test]
fn worn_mass_is_stated_over_the_distance_and_over_the_stops() {
    let folder = Folder::new("mass");
    // Two stops, a reversal that passes through rest, and the beginning at rest, which is none.
    let rows = "time [s],sliding_velocity [m/s],normal_load [N]\n0,0,2000\n1,0,2000\n2,5,2000\n4,-5,2000\n5,0,2000\n6,0,0\n\
                7,4,2000\n8,0,2000\n";
    folder.file("in.csv", rows);
    let run = ["disc_brake", "-i", "in.csv", "--set", "solver.fidelity=lumped"];
    let result = folder.json(&run);
    let end = |name: &str| result["variables"][name]["end"].as_f64().unwrap();
    let mass = end("wear_mass_punch") + end("wear_mass_strip");
    let stated = |kind: &str, over: &str| result["wear_mass"][kind][over].as_f64().unwrap();
    assert_eq!([&result["wear_mass"]["stops"], &result["wear_mass"]["applications"]], [2, 2]);
    assert!(mass > 0.0 && (stated("worn", "mass") / mass - 1.0).abs() < 1e-12);
    assert!((2.0 * stated("worn", "per_stop") / mass - 1.0).abs() < 1e-12);
    // 2.5 m, four triangles of 2.5 and 5 m, and 4 m.
    let distance = end("sliding_distance");
    assert!((distance - 14.0).abs() < 1e-9, "{distance}");
    assert!((stated("worn", "per_distance_slid") * distance / mass - 1.0).abs() < 1e-12);
    assert!((stated("airborne", "mass") / (0.35 * mass) - 1.0).abs() < 1e-12);
    let table = folder.run(&run).1;
    assert!(table.contains("mg in each of 2 stops") && table.contains("airborne particles"), "{table}");
    let none = folder.run(&["clutch", "--set", "nominal.duration=0.1 s"]).1;
    assert!(none.contains("mg per km slid") && !none.contains("airborne") && !none.contains("stops"), "{none}");
}

#[test]
fn trips_divide_temperatures_and_masses_and_one_stop_is_one() {
    let folder = Folder::new("trips");
    let rows = "time [s],sliding_velocity [m/s],normal_load [N],trip\n0,5,2000,1\n2,0,2000,1\n3,0,0,2\n5,4,2000,2\n8,4,2000,2\n";
    folder.file("in.csv", rows);
    let run = ["disc_brake", "-i", "in.csv", "--set", "solver.fidelity=lumped"];
    let result = folder.json(&run);
    let end = |name: &str| result["variables"][name]["end"].as_f64().unwrap();
    let trips = result["trips"].as_array().unwrap();
    let of = |trip: usize, name: &str| trips[trip][name].as_f64().unwrap();
    assert_eq!(trips.len(), 2);
    assert_eq!([of(0, "end"), of(1, "start"), of(1, "end")], [3.0, 3.0, 8.0]);
    for (name, whole) in [
        ("worn_mass", end("wear_mass_punch") + end("wear_mass_strip")),
        ("airborne_mass", end("wear_mass_airborne")),
        ("sliding_distance", end("sliding_distance")),
    ] {
        assert!(((of(0, name) + of(1, name)) / whole - 1.0).abs() < 1e-12, "{name}");
    }
    // Triangles of 5 and 4 m, then 12 m; the disc of the second trip starts as that of the first ends.
    assert!((of(0, "sliding_distance") - 5.0).abs() < 1e-9 && (of(1, "sliding_distance") - 16.0).abs() < 1e-9);
    assert!(of(1, "strip_mean_temperature_start") > of(0, "strip_mean_temperature_start"));
    let hottest = of(0, "contact_temperature_max").max(of(1, "contact_temperature_max"));
    assert_eq!(hottest, result["variables"]["contact_temperature_max"]["maximum"].as_f64().unwrap());
    let table = folder.run(&run).1;
    assert!(table.contains("mg in 1 stop, ") && table.contains("trip 1 ") && table.contains("trip 2 "), "{table}");
    // From the released contact to the released contact.
    let masses = &result["wear_mass"];
    assert_eq!([&masses["stops"], &masses["applications"]], [1, 2]);
    assert_eq!(masses["worn"]["per_application"].as_f64().unwrap() * 2.0, masses["worn"]["mass"].as_f64().unwrap());
    assert!(table.contains("mg in each of 2 applications\n"), "{table}");
}

#[test]
fn a_run_does_not_deviate_from_its_own_record_and_an_offset_is_told() {
    let folder = Folder::new("measured");
    folder.file("in.csv", STOP);
    let run = ["disc_brake", "-i", "in.csv"];
    assert!(folder.run(&[&run[..], &["-o", "own.csv"]].concat()).0);
    let result = folder.json(&[&run[..], &["-m", "own.csv"]].concat());
    let measured = result["measured"].as_array().unwrap();
    assert!(measured.len() > 40, "{}", measured.len());
    for own in measured {
        // The inputs pass through their slopes, which is rounding.
        assert!(own["largest"].as_f64().unwrap().abs() <= 1e-12 * own["range"].as_f64().unwrap().max(1.0), "{own}");
    }
    // 10 K above at every point but one, which is 20 K above; one point outside.
    let text = fs::read_to_string(folder.0.join("own.csv")).unwrap();
    let column = text.lines().next().unwrap().split(',').position(|name| name == "contact_temperature [K]").unwrap();
    let mut record = String::from("contact_temperature [°C],time [ms]\n");
    for (at, line) in text.lines().skip(1).step_by(100).enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let offset = if at == 3 { 20.0 } else { 10.0 };
        record += &format!("{},{}\n", cells[column] - 273.15 + offset, 1e3 * cells[0]);
    }
    record += "50,2600\n";
    folder.file("record.csv", &record);
    let result = folder.json(&[&run[..], &["-m", "record.csv"]].concat());
    let own = &result["measured"][0];
    let number = |key: &str| own[key].as_f64().unwrap();
    let count = number("points");
    assert_eq!((number("points_outside"), own["unit"].as_str()), (1.0, Some("K")));
    assert!((number("largest") + 20.0).abs() < 1e-9);
    assert!((number("root_mean_square") - (100.0 + 300.0 / count).sqrt()).abs() < 1e-9, "{own}");
    assert!((number("largest_over_range") * number("range") + 20.0).abs() < 1e-9);
    let (_, table, _) = folder.run(&[&run[..], &["-m", "record.csv"]].concat());
    assert!(table.contains("deviation of contact_temperature") && table.contains("largest -20.000 K"), "{table}");
    assert!(table.contains("1 outside of the simulated time"), "{table}");
}

/// A file of a rig with decimal commas, gaps, a jump and names of its own: its inputs drive the scene and its outputs are compared.
#[test]
fn one_file_of_a_rig_is_inputs_and_record() {
    let folder = Folder::new("rig");
    let rig = "Time [s];Speed [m/s];Clamping force [kN];Friction force [kN];Disc temp [°C];Line pressure [bar]\n\
               0;10,0;2,0;1,6;20,0;8\n0,2;9,5;;1,6;;8\n0,4;9,0;2,0;1,6;20,9;8\n0,4;9,0;4,0;3,2;;16\n0,8;8,0;4,0;3,2;22,4;16\n";
    folder.file("rig.csv", rig);
    let run = ["disc_brake", "-i", "rig.csv", "-m", "rig.csv"];
    let (success, table, told) = folder.run(&[&run[..], &["-o", "out.csv"]].concat());
    assert!(
        success && table.contains("deviation of friction_force") && !table.contains("deviation of normal_load"),
        "{told}"
    );
    assert_eq!(told.matches("left out are \"Line pressure [bar]\"").count(), 1, "{told}");
    let result = folder.json(&run);
    let names: Vec<&str> =
        result["measured"].as_array().unwrap().iter().map(|own| own["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["friction_force", "strip.mean_temperature"]);
    assert_eq!(result["measured"][1]["points"], 3);
    // The row behind the jump is not compared with the force before it.
    assert!(result["measured"][0]["largest"].as_f64().unwrap().abs() < 50.0, "{}", result["measured"][0]);
    let written = columns(&folder.0.join("out.csv"));
    let [time, load] = ["time [s]", "normal_load [N]"].map(|name| &written.iter().find(|own| own.0 == name).unwrap().1);
    let at = |wanted: f64| load[time.iter().position(|own| (own - wanted).abs() < 1e-12).unwrap()];
    // The jump lies behind its time, and each time of the file is a communication point.
    assert_eq!([at(0.2), at(0.4), at(0.8)].map(f64::round), [2000.0, 2000.0, 4000.0]);
    assert!(load[time.iter().position(|own| *own > 0.4).unwrap()] == 4000.0);
    let told = folder.refusal(&[&run[..], &["--strict"]].concat());
    assert!(told.contains("column 6: \"Line pressure [bar]\" is not a known quantity"), "{told}");
    let named = ["--strict", "--column", "Line pressure=", "--column", "Disc temp=contact_temperature"];
    let result = folder.json(&[&run[..], &named].concat());
    assert_eq!(result["measured"][1]["name"], "contact_temperature");
    let told = folder.refusal(&[&run[..], &["--column", "Presure="]].concat());
    assert!(told.contains("there is no column \"Presure\""), "{told}");
    folder.file(
        "force.csv",
        &rig.replace("Friction force [kN]", "Frict. pull [kN]").replace("Disc temp [°C]", "T9 [°C]"),
    );
    let told = folder.refusal(&["disc_brake", "-i", "force.csv", "-m", "force.csv"]);
    assert!(told.contains("left out are \"Frict. pull [kN]\"") && told.contains("has inputs only"), "{told}");
    // What is written can be read as both again, as CSV and as Parquet.
    assert!(folder.run(&[&run[..], &["-o", "out.parquet"]].concat()).0);
    for file in ["out.csv", "out.parquet"] {
        let again = folder.json(&["disc_brake", "-i", file, "-m", file]);
        let own = again["measured"].as_array().unwrap().iter().find(|own| own["name"] == "friction_force").unwrap();
        assert!(own["largest_over_range"].as_f64().unwrap().abs() < 0.05, "{own}");
    }
}

#[test]
fn a_contact_line_has_profiles_at_the_chosen_times() {
    let folder = Folder::new("profiles");
    folder.file("in.csv", STOP);
    let run = [&["disc_brake", "-i", "in.csv", "-o", "out.csv", "--at", "0.333,1 s"], &LINE[..]].concat();
    let result = folder.json(&run);
    let profiles = result["profiles"].as_array().unwrap();
    let times: Vec<f64> = profiles.iter().map(|own| own["time"].as_f64().unwrap()).collect();
    assert_eq!(times, [0.333, 1.0]);
    for own in profiles {
        let list =
            |key: &str| -> Vec<f64> { own[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect() };
        let (x, pressure) = (list("x"), list("pressure"));
        // The trapezoid sum over the stations is the load of one pad: 4 kN, at 0.333 s the ramp's part of it.
        let force: f64 =
            (1..33).map(|k| 0.5 * (pressure[k] + pressure[k - 1]) * (x[k] - x[k - 1])).sum::<f64>() * 0.055;
        let load = if times[0] == own["time"].as_f64().unwrap() { 4e3 * 0.666 } else { 4e3 };
        assert!((force / load - 1.0).abs() < 1e-6, "{force} {load}");
    }
    assert_eq!(columns(&folder.0.join("out.profiles.csv"))[0].1.len(), 66);
    let usual = folder.json(&[&["disc_brake", "-i", "in.csv"], &LINE[..]].concat());
    let times: Vec<f64> =
        usual["profiles"].as_array().unwrap().iter().map(|own| own["time"].as_f64().unwrap()).collect();
    // At both ends the load is less than half of its largest.
    assert!(times.iter().zip([0.25, 1.25, 2.25]).all(|(time, wanted)| (time - wanted).abs() < 2e-3), "{times:?}");
    let told = folder.refusal(&["disc_brake", "--at", "1"]);
    assert!(told.contains("level lumped") && told.contains("solver.fidelity = line"), "{told}");
}

#[test]
fn units_of_brakes_and_tribometers_are_the_same_run() {
    let folder = Folder::new("units");
    folder.file("si.csv", "time [s],angular_velocity [rad/s],normal_load [N],ambient_temperature_offset [K]\n0,31.41592653589793,2e3,0\n120,31.41592653589793,2e3,5\n");
    folder.file(
        "shop.csv",
        "time [min],angular_velocity [rpm],normal_load_kN,ambient_temperature_offset [K]\n0,300,2,0\n2,300,2,5\n",
    );
    let end = |inputs: &str| {
        folder.json(&["disc_brake", "-i", inputs])["variables"]["contact_temperature"]["end"].as_f64().unwrap()
    };
    // The turns are converted, which is rounding.
    assert!((end("si.csv") - end("shop.csv")).abs() < 1e-9);
}

/// What the reader of tables refuses is tested in `scene-file`; here one of its messages, and what a run asks of inputs.
#[test]
fn a_wrong_file_of_inputs_is_refused_by_line_and_column_with_what_is_accepted() {
    let folder = Folder::new("wrong");
    let header = "time [s],sliding_velocity [m/s],normal_load [N]";
    for (name, text, parts) in [
        (
            "slip",
            "time [s],sliding_velocity [m/s],normal_laod [N]\n0,1,1\n",
            &["column 3", "did you mean normal_load?"][..],
        ),
        ("one", &format!("{header}\n0,1,1\n"), &["one row", "at least two"]),
        ("huge", &format!("{header}\n0,1,1\n1,1,1e13\n"), &["line 3", "normal_load = 1e13 N is beyond 1e12 N"]),
        (
            "cold",
            &format!("{header},ambient_temperature_offset [K]\n0,1,1,0\n1,1,1,0\n2,1,1,-400\n"),
            &["lines 3 and 4", "ambient_temperature_offset = ", "above 0 K"],
        ),
        (
            "unmoved",
            "time [s],Tours [rpm],normal_load [N]\n0,5,1\n1,5,1\n",
            &["neither a column sliding_velocity", "found are time [s], Tours [rpm], normal_load [N]"],
        ),
        (
            "unloaded",
            "time [s],sliding_velocity [m/s],Force [N]\n0,1,1\n1,1,1\n",
            &[
                "no column normal_load [N]",
                "0 N",
                "found are time [s], sliding_velocity [m/s], Force [N]",
                "force=normal_load",
            ],
        ),
    ] {
        let name = format!("{name}.csv");
        folder.file(&name, text);
        let told = folder.refusal(&["disc_brake", "--inputs", &name]);
        assert!(told.contains(&name) && parts.iter().all(|part| told.contains(part)), "{told}\n{parts:?}");
    }
    folder.file("rotating.csv", "time [s],angular_velocity [rad/s],normal_load [N]\n0,1,1\n1,1,1\n");
    let told = folder.refusal(&[&["disc_brake", "--inputs", "rotating.csv"], &WITHOUT_RADIUS[..]].concat());
    assert!(told.contains("angular_velocity turns nothing, as contact.mean_radius = 0 m"), "{told}");
    let told = folder.refusal(&["disc_brake", "--inputs", "none.csv"]);
    assert!(told.contains("reading none.csv") && told.contains("No such file"), "{told}");
}

#[test]
fn a_step_that_fails_leaves_the_rows_before_it() {
    let folder = Folder::new("failing");
    let text = "time [s],sliding_velocity [m/s],normal_load [N],ambient_temperature_offset [K]\n0,1,1,0\n1,1,1,0\n2,1,1,-400\n";
    folder.file("in.csv", text);
    let told = folder.refusal(&["disc_brake", "-i", "in.csv", "-o", "out.csv"]);
    assert!(told.contains("the rows before it are in out.csv") && told.contains("in.csv, lines 3 and 4"), "{told}");
    let times = columns(&folder.0.join("out.csv"))[0].1.clone();
    assert!(times.len() > 800 && times.last().is_some_and(|last| (1.5..2.0).contains(last)), "{:?}", times.last());
}

#[test]
fn plan_reads_columns_as_simulate_does() {
    let folder = Folder::new("plan");
    folder.file("rig.csv", "time [s],Kraft [kN],sliding_velocity [m/s]\n0,1,2\n1,1,1\n");
    let plan = ["pin_on_disk", "--inputs", "rig.csv", "--set", "solver.tolerance=0.1"];
    for (more, wanted) in [
        (&["--strict"][..], "\"Kraft [kN]\" is not a known quantity"),
        (&["--column", "Karft=normal_load"], "there is no column \"Karft\""),
    ] {
        let (success, _, told) = folder.command("plan", &[&plan[..], more].concat());
        assert!(!success && told.contains(wanted), "{told}");
    }
    let (_, _, left) = folder.command("plan", &plan);
    assert!(left.contains("left out are \"Kraft [kN]\""), "{left}");
    let (_, _, named) = folder.command("plan", &[&plan[..], &["--strict", "--column", "Kraft=normal_load"]].concat());
    assert!(!named.contains("Kraft"), "{named}");
}

#[test]
fn a_neighbour_is_at_ambient_without_inputs_and_wanted_with_them() {
    let folder = Folder::new("neighbour");
    folder.file("in.csv", STOP);
    let path = ["disc_brake", "--set", "strip.external_conductance=3.5"];
    let (success, _, told) = folder.run(&path);
    assert!(success, "{told}");
    let with_inputs = [&path[..], &["--inputs", "in.csv"]].concat();
    for command in ["simulate", "plan"] {
        let (success, _, told) = folder.command(command, &with_inputs);
        let remedy = "; give it in a column of the inputs, or set strip.external_temperature=\"20 degC\"\n";
        assert!(!success && told.ends_with(remedy) && told.matches(remedy.trim_end()).count() == 1, "{told}");
    }
    let (success, _, told) = folder.run(&[&with_inputs[..], &["--set", "strip.external_temperature=20 degC"]].concat());
    assert!(success, "{told}");
}

/// What a command leaves that Ctrl-C ends after `seconds`: status, output and what it tells.
#[cfg(unix)]
fn interrupted(folder: &Folder, seconds: f64, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-lab"));
    command.args(arguments).current_dir(&folder.0).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let run = command.spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_secs_f64(seconds));
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    let Output { status, stdout, stderr } = run.wait_with_output().unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

#[test]
#[cfg(unix)]
fn what_is_interrupted_keeps_what_is_done() {
    let folder = Folder::new("interrupted");
    let long = ["--set", "nominal.duration=30000 s", "--set", "solver.fidelity=line", "--set", "solver.cells=129"];
    let run = ["simulate", "disc_brake", "--step", "0.1", "-o", "out.csv"];
    let (status, printed, told) = interrupted(&folder, 10.0, &[&run[..], &long].concat());
    assert_eq!((status, printed.as_str()), (Some(130), ""), "{told}");
    let columns = columns(&folder.0.join("out.csv"));
    let last = *columns[0].1.last().unwrap();
    assert!(last > 0.1 && last < 30000.0 && columns.iter().all(|(_, values)| values.iter().all(|v| v.is_finite())));
    assert!(told.contains(" s of 30000 s; the rows up to there are in out.csv"), "{told}");
    let rows = (0..600).map(|row| format!("{},{},4\n", 5 * row, 10 * (row % 2)));
    folder
        .file("stops.csv", &format!("time [s],sliding_velocity [m/s],normal_load [kN]\n{}", rows.collect::<String>()));
    let plan = ["plan", "disc_brake", "--inputs", "stops.csv", "--tolerance", "1e-5"];
    let (status, printed, told) = interrupted(&folder, 10.0, &plan);
    assert_eq!(status, Some(130), "{told}");
    let lumped = printed.lines().find(|line| line.starts_with("lumped")).expect("a row");
    assert!(lumped.split_whitespace().count() == 6 && !printed.contains("The cheapest"), "{printed}");
    assert!(printed.contains("Interrupted: ") && told.contains("interrupted after "), "{printed}{told}");
    let cycles = ["cycles", "reciprocating_punch", "--cycles", "1e12", "--tolerance", "1e-6", "--cells", "33"];
    let (status, printed, told) = interrupted(&folder, 10.0, &cycles);
    assert_eq!(status, Some(130), "{told}");
    assert!(printed.lines().count() > 2 && told.contains(" of 1000000000000 cycles"), "{printed}{told}");
}
