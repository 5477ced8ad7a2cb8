//! Files as rigs, loggers, spreadsheets and pandas write them, read as measured records and as inputs.

use scene_file::columns::{self, Column, Reading, Table};
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/records").join(name)
}

fn record(name: &str) -> Table {
    columns::read(&path(name), &Column::record(), &Reading::default()).unwrap()
}

fn inputs(name: &str) -> Table {
    columns::read(&path(name), &Column::inputs(), &Reading::default()).unwrap()
}

/// Values in the SI unit, `None` of gaps.
fn values(table: &Table, name: &str) -> Vec<Option<f64>> {
    let column = table.column(name).unwrap_or_else(|| panic!("{name}: {:?}, {:?}", table.names, table.notes));
    column.map(|value| value.is_finite().then_some((1e9 * value).round() / 1e9)).collect()
}

#[test]
fn a_tribometer_with_gaps_and_its_own_names() {
    let table = record("tribometer.csv");
    assert_eq!(table.times, [0.0, 10.0, 20.0, 30.0, 40.0]);
    assert_eq!(values(&table, "friction_force")[1], Some(4.81));
    assert_eq!(values(&table, "friction_coefficient")[4], Some(0.508));
    assert_eq!(values(&table, "wear_depth"), [Some(0.0), None, Some(4e-7), None, Some(9e-7)]);
    assert_eq!(values(&table, "contact_temperature")[1..3], [Some(296.55), None]);
    let [meant, ignored] = table.notes.as_slice() else { panic!("{:?}", table.notes) };
    assert!(
        meant.contains("\"Temp. [degC]\" as contact_temperature") && meant.contains("\"COF\" as friction_coefficient"),
        "{meant}"
    );
    assert!(ignored.contains("left out are \"Humidity [%]\""), "{ignored}");
    assert_eq!(table.lines, [3, 4, 5, 6, 7]);
}

/// A pin that was weighed, driven by a shaft: the candidates are named, and the shaft's speed is one for inputs.
#[test]
fn a_weighed_pin_with_the_clock_of_its_computer() {
    let table = record("weighed_pin.csv");
    assert_eq!(table.times, [0.0, 1800.0, 3600.5]);
    assert!(table.notes.iter().any(|note| note.contains("wear_mass_punch or wear_mass_strip")), "{:?}", table.notes);
    let turns = 2.0 * std::f64::consts::PI / 60.0;
    let shaft = (1e9 * 300.0 * turns).round() / 1e9;
    assert_eq!(values(&inputs("weighed_pin.csv"), "angular_velocity"), [Some(shaft); 3]);
}

#[test]
fn a_bench_in_latin_1_with_decimal_commas_and_empty_last_cells() {
    let table = inputs("bench_latin1.csv");
    let turns = 2.0 * std::f64::consts::PI / 60.0;
    assert_eq!(values(&table, "normal_load"), [0.0, 2500.0, 2500.0, 2480.0].map(Some));
    assert!((table.column("angular_velocity").unwrap().nth(1).unwrap() - 240.0 * turns).abs() < 1e-12);
    assert_eq!(table.left_out, ["friction_torque", "contact_temperature"]);
    assert_eq!(table.lines, [4, 5, 6, 7]);
    let measured = record("bench_latin1.csv");
    assert_eq!(values(&measured, "contact_temperature")[2], Some(304.35));
    assert_eq!(values(&measured, "friction_torque")[1], Some(118.4));
    assert!(measured.notes[1].contains("Speed [Umdr.]"), "{:?}", measured.notes);
}

#[test]
fn a_logger_with_lines_above_and_units_below_its_header() {
    let table = record("logger.txt");
    assert_eq!(values(&table, "sliding_velocity")[0], Some(10.0));
    assert_eq!(values(&table, "normal_load")[1], Some(4000.0));
    assert_eq!(values(&table, "friction_torque"), [Some(0.0), Some(301.0), Some(311.0), None, Some(318.0)]);
    assert_eq!(values(&table, "strip.mean_temperature")[..2], [Some(313.25), None]);
    assert_eq!(table.lines[0], 6);
    // The same file is the inputs, with what it measures left out.
    let driven = inputs("logger.txt");
    assert_eq!(driven.names, ["sliding_velocity", "normal_load"]);
    assert_eq!(driven.left_out, ["friction_torque", "strip.mean_temperature"]);
}

#[test]
fn channels_of_two_rates_and_a_jump() {
    let table = inputs("two_rates.csv");
    let load: Vec<f64> = table.column("normal_load").unwrap().collect();
    for (own, exact) in load.iter().zip([10.0, 10.1, 10.2, 10.3, 10.4, 10.5, 10.6, 20.0, 20.0]) {
        assert!((own - exact).abs() < 1e-12, "{load:?}");
    }
    assert_eq!(table.times[6..8], [0.6, 0.6]);
    let measured = record("two_rates.csv");
    assert_eq!(values(&measured, "contact_temperature").iter().flatten().count(), 4);
    assert_eq!(values(&measured, "friction_force").iter().flatten().count(), 9);
    assert_eq!(values(&measured, "normal_load")[1], None);
}

#[test]
fn a_spreadsheet_in_utf_16() {
    let table = record("spreadsheet_utf16.txt");
    assert_eq!(values(&table, "wear_depth_punch"), [0.0, 1.2e-6, 2.1e-6].map(Some));
    assert_eq!(values(&table, "sliding_velocity")[2], Some(0.5));
}

#[test]
fn what_pandas_writes_as_parquet_and_with_decimal_commas_is_the_same_table() {
    let (parquet, text) = (record("drive.parquet"), record("frame_german.csv"));
    assert_eq!(parquet.names, text.names);
    for name in &parquet.names {
        assert_eq!(values(&parquet, name), values(&text, name), "{name}");
    }
    assert_eq!(values(&parquet, "contact_temperature"), [Some(293.15), None, Some(304.15), Some(308.65)]);
    assert!(parquet.notes[0].contains("\"note\""), "{:?}", parquet.notes);
    assert_eq!(inputs("drive.parquet").names, ["sliding_velocity", "normal_load"]);
}

/// pandas keeps an index of nanoseconds as such.
#[test]
fn dates_in_parquet_are_times() {
    let table = record("dated.parquet");
    assert_eq!(table.times, [0.0, 0.5, 0.5, 600.75]);
    assert_eq!(values(&table, "friction_force"), [Some(4.1), None, Some(8.2), Some(8.3)]);
}
