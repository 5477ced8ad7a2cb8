//! Arguments that `fmi2Instantiate` accepts and refuses.

use core::ffi::CStr;
use std::ffi::CString;
use std::ptr;
use std::sync::Mutex;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{CallbackFunctions, Status};

use test_support::importer::{Entry, guid, logger};

struct Call<'a> {
    name: Option<&'a CStr>,
    kind: u32,
    guid: Option<&'a CStr>,
    resources: Option<&'a CStr>,
    visible: i32,
    with_logger: bool,
}

/// Whether there is an instance, and the log.
fn instantiate(call: &Call) -> (bool, Vec<Entry>) {
    let log: Box<Mutex<Vec<Entry>>> = Box::default();
    let callbacks = CallbackFunctions {
        logger: call.with_logger.then(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::from_ref(&*log).cast_mut().cast(),
    };
    let pointer = |text: Option<&CStr>| text.map_or(ptr::null(), CStr::as_ptr);
    // SAFETY: strings, structure and log live through the calls.
    let component = unsafe {
        fmi2Instantiate(
            pointer(call.name),
            call.kind,
            pointer(call.guid),
            pointer(call.resources),
            &callbacks,
            call.visible,
            0,
        )
    };
    fmi2FreeInstance(component);
    let entries = log.lock().unwrap().clone();
    (!component.is_null(), entries)
}

#[test]
fn any_resource_location_is_fine() {
    let guid = guid();
    let good =
        Call { name: Some(c"importer"), kind: 1, guid: Some(&guid), resources: None, visible: 0, with_logger: true };
    let spellings = [
        c"",
        c"file:///tmp/fmu/resources",
        c"file:/tmp/fmu/resources",
        c"file://localhost/C:/x%20y/resources",
        c"C:\\fmu\\resources",
        c"/nowhere",
        c"fmi:\xff\xfe not UTF-8",
    ];
    assert_eq!(instantiate(&good), (true, vec![]));
    for resources in spellings {
        assert_eq!(instantiate(&Call { resources: Some(resources), ..good }), (true, vec![]));
    }
    assert_eq!(instantiate(&Call { visible: 1, ..good }), (true, vec![]));
    assert!(instantiate(&Call { with_logger: false, ..good }).0);
}

#[test]
fn a_wrong_type_guid_or_name_gives_no_instance_and_a_reason() {
    let guid = guid();
    let upper = CString::new(guid.to_str().unwrap().to_uppercase()).unwrap();
    let good =
        || Call { name: Some(c"importer"), kind: 1, guid: Some(&guid), resources: None, visible: 0, with_logger: true };
    let cases = [
        (Call { kind: 0, ..good() }, "co-simulation"),
        (Call { kind: 2, ..good() }, "fmuType 2"),
        (Call { kind: u32::MAX, ..good() }, "co-simulation"),
        (Call { guid: Some(c"{00000000-0000-0000-0000-000000000000}"), ..good() }, "GUID"),
        (Call { guid: Some(&upper), ..good() }, "GUID"),
        (Call { guid: Some(c""), ..good() }, "GUID"),
        (Call { guid: Some(c"\xff %s %n"), ..good() }, "%n"),
        (Call { guid: None, ..good() }, "none was given"),
    ];
    for (call, reason) in cases {
        let (instance, log) = instantiate(&call);
        assert!(!instance, "{reason}");
        let [(status, category, text)] = &log[..] else { panic!("{log:?}") };
        assert_eq!((*status, category.as_str()), (Status::Error, "logStatusError"));
        assert!(text.contains(reason), "{text}");
        assert!(!instantiate(&Call { with_logger: false, ..call }).0, "and without a logger");
    }
}

#[test]
fn no_name_or_no_callbacks_gives_no_instance() {
    let guid = guid();
    let callbacks = CallbackFunctions {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::null_mut(),
    };
    let instantiate = |name: *const _, callbacks| {
        // SAFETY: strings and structure live through the call, or are NULL.
        unsafe { fmi2Instantiate(name, 1, guid.as_ptr(), ptr::null(), callbacks, 0, 1) }
    };
    assert!(instantiate(ptr::null(), &callbacks).is_null());
    assert!(instantiate(c"".as_ptr(), &callbacks).is_null());
    assert!(instantiate(c"importer".as_ptr(), ptr::null()).is_null());
    let component = instantiate(c"importer".as_ptr(), &callbacks);
    assert!(!component.is_null());
    fmi2FreeInstance(component);
}

#[test]
fn version_and_platform_are_those_of_the_standard() {
    // SAFETY: both are strings of the library.
    unsafe {
        assert_eq!(CStr::from_ptr(fmi2GetVersion()), c"2.0");
        assert_eq!(CStr::from_ptr(fmi2GetTypesPlatform()), c"default");
    }
}
