//! The packaged FMU in an importer written in Rust, against fmpy's recording of the same drive.

use fmi::CS;
use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common, Instance};
use fmi::import;
use fmi::traits::FmiImport;
use scene::variables;
use std::path::PathBuf;

/// File named by an environment variable that `cargo fmu test --importers` sets.
fn file(variable: &str) -> PathBuf {
    let path =
        std::env::var_os(variable).unwrap_or_else(|| panic!("{variable} is not set: use cargo fmu test --importers"));
    PathBuf::from(path)
}

fn load() -> Fmi2Import {
    import::from_path(file("SLIDING_CONTACT_FMU")).expect("the FMU is imported")
}

fn references(names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| variables::find(name).unwrap_or_else(|| panic!("no variable {name}"))).collect()
}

/// Columns of the recording without their units, and its rows.
fn recording() -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(file("SLIDING_CONTACT_RECORDING")).expect("the recording is there");
    let mut lines = text.lines();
    let names = lines.next().expect("a heading").split(',').map(|name| name.split(" [").next().unwrap().to_owned());
    let rows = lines.map(|line| line.split(',').map(|word| word.parse().expect("a number")).collect());
    (names.collect(), rows.collect())
}

/// Initialised as fmpy does it.
fn start(import: &Fmi2Import, inputs: &[f64], stop: f64) -> Instance<CS> {
    let mut instance = import.instantiate_cs("native", false, true).expect("an instance");
    let experiment = import.model_description().default_experiment.as_ref();
    let tolerance = experiment.and_then(|experiment| experiment.tolerance);
    instance.setup_experiment(tolerance, 0.0, Some(stop)).expect("set-up");
    instance.enter_initialization_mode().expect("initialisation begins");
    instance.set_real(&references(&["sliding_velocity", "normal_load"]), inputs).expect("inputs");
    instance.exit_initialization_mode().expect("initialisation ends");
    instance
}

#[test]
fn the_description_is_read_and_agrees_with_the_table() {
    let import = load();
    let description = import.model_description();
    assert_eq!(description.model_name, "SlidingContact.disc_brake");
    assert_eq!(description.co_simulation.as_ref().expect("co-simulation").model_identifier, "SlidingContact");
    assert_eq!(description.model_variables.variables.len(), variables::COUNT);
    let instance = start(&import, &[0.0, 0.0], 1.0);
    assert_eq!((instance.get_version(), instance.get_types_platform()), ("2.0", "default"));
}

/// The same library, the same inputs, another importer: the same bits.
#[test]
fn the_drive_gives_the_bits_that_fmpy_recorded() {
    let (names, rows) = recording();
    let column =
        |name: &str| names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no column {name}"));
    let (time, velocity, load_column) = (column("time"), column("sliding_velocity"), column("normal_load"));
    let outputs: Vec<&str> =
        names.iter().map(String::as_str).filter(|name| !["time", "car.speed"].contains(name)).collect();
    let (inputs, read) = (references(&["sliding_velocity", "normal_load"]), references(&outputs));
    let columns: Vec<usize> = outputs.iter().map(|name| column(name)).collect();
    assert!(rows.len() > 10_000, "the recording has only {} rows", rows.len());

    let import = load();
    let first = &rows[0];
    let mut instance = start(&import, &[first[velocity], first[load_column]], rows.last().unwrap()[time]);
    let mut values = vec![0.0; read.len()];
    for pair in rows.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        // A row holds the inputs of the step that ends there.
        instance.set_real(&inputs, &[after[velocity], after[load_column]]).expect("inputs");
        instance.do_step(before[time], after[time] - before[time], true).expect("a step");
        instance.get_real(&read, &mut values).expect("outputs");
        for ((value, &column), name) in values.iter().zip(&columns).zip(&outputs) {
            assert_eq!(
                value.to_bits(),
                after[column].to_bits(),
                "{name} at {} s: {value} and {}",
                after[time],
                after[column]
            );
        }
    }
    assert!(values[columns.iter().position(|&at| at == column("wear_depth_punch")).unwrap()] > 0.0);
}

#[test]
fn a_state_is_kept_restored_and_carried_to_another_instance() {
    let import = load();
    let read = references(&["wear_depth", "contact_temperature", "stored_heat"]);
    let advance = |instance: &mut Instance<CS>, from: usize| {
        let mut values = vec![0.0; read.len()];
        for step in from..from + 50 {
            instance.do_step(0.1 * step as f64, 0.1, true).expect("a step");
        }
        instance.get_real(&read, &mut values).expect("outputs");
        values
    };
    let mut instance = start(&import, &[5.0, 2000.0], 100.0);
    advance(&mut instance, 0);
    let state = instance.get_fmu_state().expect("a state");
    let bytes = instance.serialize_fmu_state(&state).expect("bytes");
    let expected = advance(&mut instance, 50);
    instance.set_fmu_state(&state);
    assert_eq!(advance(&mut instance, 50), expected);

    let mut other = start(&import, &[1.0, 1.0], 100.0);
    let copy = other.deserialize_fmu_state(&bytes).expect("a state from bytes");
    other.set_fmu_state(&copy);
    assert_eq!(advance(&mut other, 50), expected);
}
