//! The command as a user starts it: refusals, and behaviour with a closed output pipe.

use std::io;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn command(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-build"));
    command.args(line.split(' ')).stdin(Stdio::null());
    command
}

fn run(line: &str) -> (bool, String, String) {
    let Output { status, stdout, stderr } = command(line).output().unwrap();
    (status.success(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

fn file(name: &str, text: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("command-line-{}-{name}", std::process::id()));
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn nobody_reading_the_output_is_no_panic() {
    for line in [
        "stability --list",
        "chart --list",
        "verify --json --filter galin",
        "verify --filter galin",
        "steady reciprocating_punch --cold --cells 9 --json",
        "steady reciprocating_punch --cold --cells 9",
        "plan pin_on_disk --json",
        "plan pin_on_disk",
        "tables",
        "cycles reciprocating_punch --cycles 2 --cells 9 --cold --json",
        "golden compare lumped_held",
        "--help",
    ] {
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let output = command(line).stdout(writer).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(!told.contains("panicked") && !told.contains("error"), "{line}: {told}");
        if line != "--help" {
            assert_eq!(output.status.code(), Some(141), "{line}: {told}");
        }
    }
}

#[test]
fn what_does_not_apply_or_fit_is_refused_with_what_is_accepted() {
    let fast = file("fast.csv", "time_s,speed_m_per_s\n0,0\n60,108\n");
    let bare = file("bare.csv", "time,speed\n0,0\n60,50\n");
    let (fast, bare) = (format!("run --cycle {}", fast.display()), format!("run --cycle {}", bare.display()));
    for (line, parts) in [
        ("plan --tolerance 7", &["7", "--tolerance", "at most 0.5"][..]),
        ("plan --tolerance 0", &["above 0"]),
        ("plan --tolerance nan", &["above 0"]),
        ("tables --tolerance 7", &["at most 0.5"]),
        ("golden compare --tolerance 7", &["at most 0.5"]),
        ("golden compare lumped_hold", &["\"lumped_hold\" is no golden scene; they are ", "lumped_held"]),
        ("plan -o plans.csv", &["--campaign"]),
        ("plan --campaign --set punch.width=1", &["--set"]),
        ("plan --campaign -o plans.parquet", &[".csv is written, not .parquet"]),
        ("steady disc_brake -o st.png", &[".svg is written, not .png"]),
        ("cycles reciprocating_punch -o st.png", &[".svg is written, not .png"]),
        ("batch d.csv --fmu x.fmu --inputs i.csv -o r.parquet", &[".csv is written, not .parquet"]),
        ("batch --example fit --step 3", &["--step"]),
        ("package clutch -o clutch.zip", &[".fmu is written, not .zip"]),
        ("package --ssv --platform win64", &["--platform"]),
        ("stability -o maps.svg", &["a folder must be named"]),
        ("stability --list --json", &["--json"]),
        ("chart --list --json", &["--json"]),
        ("steady disc_brake --return-speed 3", &["nominal.stroke = 0 m"]),
        ("steady reciprocating_punch --return-speed 0", &["sliding speed = 0"]),
        ("run clutch --cycle hwfet", &["does not apply to clutch"]),
        ("run vehicle_brake --step 0.2", &["does not apply to vehicle_brake"]),
        ("run --scene clutch", &["contact.geometry = annular", "covers 1.000"]),
        ("run clutch --scene disc_brake", &["contact.geometry = line"]),
        (&fast, &["line 3", "108 m/s (389 km/h)", "100 m/s"]),
        (&bare, &["\"speed\" does not say its unit", "speed [m/s or km/h"]),
    ] {
        let (success, _, told) = run(line);
        assert!(!success, "{line} was accepted");
        assert!(parts.iter().all(|part| told.contains(part)), "{line}: {told}");
    }
}

#[test]
fn a_steady_state_beyond_its_limits_is_told() {
    let (success, table, told) = run("steady disc_brake --cells 9");
    assert!(success && table.contains("650.0000, exceeded"), "{table}");
    assert!(told.contains("warning: the steady state is above contact.temperature_limit = 650.0000 degC"), "{told}");
    let (success, _, told) = run("steady disc_brake --cells 9 --set nominal.load=1e3");
    assert!(success && !told.contains("warning"), "{told}");
    let (success, table, told) = run("steady clutch --cells 9");
    assert!(!success && table.contains("mean pressure"), "{table}");
    assert!(told.contains("nominal.velocity = 29.7 m/s") && told.contains("the limit is 2226.8500 degC"), "{told}");
    assert!(run("steady clutch --cells 9 --cold").0);
}

#[test]
fn temperatures_that_look_like_degrees_celsius_are_told() {
    let told = |line: &str| run(line).2;
    let cold = "warning: ambient_temperature = 20 K is -253.15 degC";
    assert!(told("plan pin_on_disk --set ambient_temperature=20").contains(cold));
    assert!(told("steady reciprocating_punch --cold --cells 9 --set ambient_temperature=20").contains(cold));
    assert_eq!(told("plan pin_on_disk"), "");
}
