//! The log: categories, switches, awkward characters.

use std::ffi::CString;
use std::ptr;
use std::sync::Mutex;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{CallbackFunctions, Status};

use crate::importer::{Entry, Importer, Stage, logger};

const OK: Status = Status::Ok;

fn refuse_something(importer: &Importer) {
    assert_eq!(importer.set_real(&["punch.height"], &[-1.0]), Status::Discard);
}

#[test]
fn errors_are_always_told_and_events_on_request() {
    let quiet = Importer::with_logging(false);
    quiet.go(Stage::Initialization);
    assert_eq!(quiet.take_log(), []);
    refuse_something(&quiet);
    let log = quiet.take_log();
    let [(Status::Discard, category, text)] = &log[..] else { panic!("{log:?}") };
    assert_eq!(category, "logStatusError");
    assert!(text.starts_with("fmi2SetReal: punch.height: -1 m is below the minimum"), "{text}");

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
