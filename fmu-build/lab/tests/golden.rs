//! Regression test: every golden scene against its record, and detection of a change.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn golden(arguments: &[&str]) -> (bool, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-lab"));
    let output = command.arg("golden").args(arguments).stdin(Stdio::null()).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    (output.status.success(), out, err)
}

/// An empty folder that only this test uses.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("golden-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn replace(path: &Path, change: impl FnOnce(&str) -> String) {
    let before = fs::read_to_string(path).unwrap();
    let after = change(&before);
    assert_ne!(before, after, "{}", path.display());
    fs::write(path, after).unwrap();
}

#[test]
fn every_golden_scene_is_what_was_recorded() {
    let (success, told, error) = golden(&["compare"]);
    println!("{told}");
    assert!(success, "{told}{error}");
    assert!(told.contains("0 of ") && told.contains(" golden scenes differ"), "{told}");
}

#[test]
fn a_difference_is_shown_with_variable_time_values_and_size() {
    let folder = folder("difference");
    let place = ["lumped_slopes", "steady_groove", "--folder", folder.to_str().unwrap()];
    let with = |action: &'static str| [&[action][..], &place[..]].concat();
    assert!(golden(&with("record")).0);
    let (success, told, _) = golden(&with("compare"));
    assert!(success && told.contains("0 of 2 golden scenes differ"), "{told}");

    // One unit in the last place of the third kept wear depth.
    let record = folder.join("lumped_slopes.txt");
    replace(&record, |text| {
        let line = text.lines().find(|line| line.starts_with("wear_depth ")).unwrap();
        let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        words[4] = format!("{:e}", words[4].parse::<f64>().unwrap().next_up());
        text.replace(line, &words.join(" "))
    });
    let (success, told, error) = golden(&with("compare"));
    assert!(!success && error.contains("1 of 2 golden scenes differ: lumped_slopes"), "{error}");
    for part in ["first: wear_depth at ", " s (communication point ", ": recorded ", ", 1 unit in the last place"] {
        assert!(told.contains(part), "no {part:?} in {told}");
    }
    assert!(
        told.contains("largest relative difference ") && told.contains("e-16: wear_depth of lumped_slopes"),
        "{told}"
    );
    let (success, told, _) = golden(&[&with("compare")[..], &["--tolerance", "1e-12"]].concat());
    assert!(success && told.contains("0 compared to the bit, 2 with the relative tolerance 1e-12; 1 scenes"), "{told}");

    // On another machine the same difference is borne, and that is told.
    replace(&folder.join("machine"), |text| text.replace("functions", "other functions"));
    let (success, told, _) = golden(&with("compare"));
    assert!(success && told.contains("recorded on ") && told.contains("2 with the relative tolerance 1e-6"), "{told}");
    let (success, _, _) = golden(&[&with("compare")[..], &["--bits"]].concat());
    assert!(!success);
    let (success, _, error) = golden(&with("record"));
    assert!(!success && error.contains("made on another machine"), "{error}");
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn work_counters_messages_and_missing_records_are_differences() {
    let folder = folder("work");
    let place = ["line_cold_9", "fails_two_cells", "--folder", folder.to_str().unwrap()];
    let with = |action: &'static str| [&[action][..], &place[..]].concat();
    assert!(golden(&with("record")).0);
    replace(&folder.join("fails_two_cells.txt"), |text| text.replace("solver.cells = 2", "solver.cells = 1"));
    replace(&folder.join("line_cold_9.txt"), |text| {
        let line = text.lines().find(|line| line.starts_with("work.steps ")).unwrap();
        text.replace(line, &format!("{} 1e9", line.rsplit_once(' ').unwrap().0))
    });
    let (success, told, error) = golden(&[&with("compare")[..], &["--bits"]].concat());
    assert!(!success && error.contains("2 of 2 golden scenes differ: line_cold_9, fails_two_cells"), "{error}");
    for part in ["error: recorded \"initialisation: solver.cells = 1", "work.steps: recorded 1000000000, now "] {
        assert!(told.contains(part), "no {part:?} in {told}");
    }
    fs::remove_file(folder.join("line_cold_9.txt")).unwrap();
    let (success, _, error) = golden(&with("compare"));
    assert!(!success && error.contains("line_cold_9.txt; cargo fmu golden record writes it"), "{error}");
    fs::remove_dir_all(&folder).unwrap();
}
