//! The command as a user starts it: warnings, and what happens where nobody reads its output. What it refuses is tested in
//! `tests/fmpy/slow/test_wrong_inputs.py`.

use std::io;
use std::process::{Command, Output, Stdio};

fn command(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-lab"));
    command.args(line.split(' ')).stdin(Stdio::null());
    command
}

fn run(line: &str) -> (bool, String, String) {
    let Output { status, stdout, stderr } = command(line).output().unwrap();
    (status.success(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
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
        "simulate clutch --json",
        "simulate clutch",
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
