//! The log: categories, switches, special characters.

use std::ffi::CString;
use std::ptr;
use std::sync::Mutex;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{CallbackFunctions, Status};

use test_support::importer::{Entry, Importer, Stage, logger};

const OK: Status = Status::Ok;

/// Speed below the critical one of the stock scene, m/s: initialisation has nothing to warn of.
const STABLE: f64 = 2.0;

fn refuse_something(importer: &Importer) {
    assert_eq!(importer.set_real(&["punch.height"], &[-1.0]), Status::Discard);
}

#[test]
fn errors_and_warnings_are_always_told_and_events_on_request() {
    let quiet = Importer::with_logging(false);
    quiet.go(Stage::Initialization);
    assert_eq!(quiet.take_log(), []);
    assert_eq!(quiet.set_real(&["nominal.velocity"], &[STABLE]), OK);
    refuse_something(&quiet);
    let log = quiet.take_log();
    let [(Status::Discard, category, text)] = &log[..] else { panic!("{log:?}") };
    assert_eq!(category, "logStatusError");
    assert!(text.starts_with("fmi2SetReal: punch.height: -1 m is below the minimum"), "{text}");
    assert_eq!(quiet.exit(), OK);
    assert_eq!(quiet.take_log(), []);
    assert_eq!(quiet.set_real(&["normal_load"], &[-5.0]), OK);
    for step in 0..3 {
        assert_eq!(quiet.step(f64::from(step), 1.0), OK, "a warning is no status");
    }
    let log = quiet.take_log();
    let [(Status::Warning, category, text)] = &log[..] else { panic!("{log:?}") };
    assert_eq!(category, "logStatusWarning");
    assert!(text.starts_with("normal_load = -5 N is below 0 N and counts as 0"), "{text}");

    let loud = Importer::with_logging(true);
    loud.go(Stage::Stepping);
    let log = loud.take_log();
    assert!(log.iter().any(|entry| entry.1 == "logEvents" && entry.0 == OK), "{log:?}");
    assert!(log.iter().all(|entry| ["logEvents", "logStatusWarning", "logStatusError"].contains(&entry.1.as_str())));
}

#[test]
fn categories_switch_and_survive_a_reset() {
    let importer = Importer::with_logging(false);
    let events = |importer: &Importer| {
        assert_eq!(importer.reset(), OK);
        importer.take_log();
        importer.go(Stage::Stepping);
        importer.take_log().iter().filter(|entry| entry.1 == "logEvents").count()
    };
    assert_eq!(events(&importer), 0);
    assert_eq!(importer.debug(true, &[]), OK);
    assert!(events(&importer) > 0);
    assert_eq!(importer.debug(true, &[c"logStatusWarning", c"logAll"]), OK);
    assert_eq!(events(&importer), 0);
    assert_eq!(importer.debug(true, &[c"logEvents"]), OK);
    assert!(events(&importer) > 0);
    assert_eq!(importer.debug(false, &[]), OK);
    assert_eq!(events(&importer), 0);
    assert_eq!(importer.reset(), OK);
    refuse_something(&importer);
    assert_eq!(importer.take_log().len(), 1, "errors stay on");
}

#[test]
fn warnings_are_silent_where_other_categories_are_chosen() {
    let warnings = |on: bool, categories: &[&std::ffi::CStr]| {
        let importer = Importer::with_logging(true);
        importer.go(Stage::Initialization);
        assert_eq!(importer.set_real(&["normal_load", "nominal.velocity"], &[-5.0, STABLE]), OK);
        assert_eq!(importer.debug(on, categories), OK);
        assert_eq!(importer.exit(), OK);
        assert_eq!(importer.step(0.0, 1.0), OK);
        importer.take_log().iter().filter(|entry| entry.1 == "logStatusWarning").count()
    };
    assert_eq!(warnings(true, &[c"logEvents"]), 0);
    assert_eq!(warnings(true, &[c"logStatusWarning"]), 1);
    assert_eq!(warnings(true, &[]), 1);
    assert_eq!(warnings(false, &[]), 1);
}

/// Initialises the lumped level, reading an output before the end, which must use the same tolerance; returns the line of the log
/// that states the tolerance in use.
fn tolerance(importer: &Importer, own: Option<f64>) -> String {
    assert_eq!(importer.set_integer("solver.fidelity", 2), OK);
    assert_eq!(importer.setup(own, 0.0, None), OK);
    assert_eq!(importer.enter(), OK);
    importer.get_real("contact_temperature");
    assert_eq!(importer.exit(), OK);
    let log = importer.take_log();
    let line = log.into_iter().find(|entry| entry.2.starts_with("tolerance ")).expect("a line with the tolerance");
    line.2.split(';').next().unwrap().to_owned()
}

#[test]
fn without_a_tolerance_of_the_importer_that_of_the_default_experiment_counts() {
    let declared = scene::slot::current().unwrap().experiment.tolerance;
    assert_ne!(declared, 1e-3);
    let importer = Importer::with_logging(true);
    for (own, wanted) in [
        (None, format!("tolerance {declared:e} from the scene's DefaultExperiment")),
        (Some(1e-4), "tolerance 1e-4 from the importer".to_owned()),
        (None, format!("tolerance {declared:e} from the scene's DefaultExperiment")),
    ] {
        assert_eq!(tolerance(&importer, own), wanted);
        assert_eq!(importer.reset(), OK);
    }
    assert_eq!(importer.set_real(&["solver.tolerance"], &[2e-2]), OK);
    assert_eq!(tolerance(&importer, Some(1e-4)), "tolerance 2e-2 from solver.tolerance");
}

#[test]
fn awkward_characters_reach_the_logger_unharmed() {
    let log: Box<Mutex<Vec<Entry>>> = Box::default();
    let callbacks = CallbackFunctions {
        logger: Some(logger()),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::from_ref(&*log).cast_mut().cast(),
    };
    let long = "%s #r1# ".repeat(500);
    let guid = CString::new(format!("%n%s%d 100 % #r12# {long}")).unwrap();
    // SAFETY: strings, structure and log live through the call.
    let component = unsafe { fmi2Instantiate(c"importer".as_ptr(), 1, guid.as_ptr(), ptr::null(), &callbacks, 0, 0) };
    assert!(component.is_null());
    let entries = log.lock().unwrap();
    assert!(entries.len() > 1, "a long text goes out in pieces");
    assert!(entries.iter().all(|entry| entry.2.len() <= 900), "that loggers with small buffers can take");
    let whole: Vec<_> = entries.iter().flat_map(|entry| entry.2.split_whitespace()).collect();
    let whole = whole.join(" ");
    assert!(whole.contains("%n%s%d 100 % ##r12## %s ##r1##"), "{whole}");
    assert_eq!(whole.matches("##r1##").count(), 500);
    assert_eq!(whole.replace("##", "").matches('#').count(), 0, "every # is doubled");
}
