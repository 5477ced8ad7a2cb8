//! Invalid handles, instances in many threads, many instances.

use core::ffi::{c_char, c_void};
use std::ptr;

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, ComponentEnvironment, Status};

use super::sequences::GRID;
use test_support::importer::{Importer, Stage, as_logger, guid};

const OK: Status = Status::Ok;
const ERROR: Status = Status::Error;

/// Calls every function that takes an instance, with arguments that are good except for the handle.
fn call_everything(component: *mut c_void) -> Vec<Status> {
    GRID.iter().map(|(.., call)| call(component, ptr::null_mut())).collect()
}

fn refuses(component: *mut c_void) {
    assert!(call_everything(component).iter().all(|&status| status == ERROR), "{component:?}");
    fmi2FreeInstance(component);
}

#[test]
fn what_is_no_instance_is_an_error_and_nothing_more() {
    let living = Importer::new();
    refuses(ptr::null_mut());
    for small in 1..64 {
        refuses(ptr::without_provenance_mut(small));
    }
    refuses(ptr::without_provenance_mut(usize::MAX));
    refuses(ptr::from_ref(&living).cast_mut().cast());
    refuses(refuses as *mut c_void);
    for bit in 0..usize::BITS {
        refuses(living.component.map_addr(|address| address ^ (1 << bit)));
    }
    let mut state = ptr::null_mut();
    assert_eq!(living.save(&mut state), OK);
    refuses(state);
    assert_eq!(living.free(&mut state), OK);
    living.go(Stage::Stepping);
    assert_eq!(living.step(0.0, 0.1), OK);
}

#[test]
fn a_freed_instance_stays_freed() {
    let first = Importer::new();
    let handle = first.component;
    drop(first);
    refuses(handle);
    let second = Importer::new();
    refuses(handle);
    assert_ne!(second.component, handle);
    second.go(Stage::Stepping);
}

#[test]
fn a_thousand_instances_do_not_know_of_each_other() {
    let importers: Vec<_> = (0..1000).map(|_| Importer::new()).collect();
    for (index, importer) in importers.iter().enumerate() {
        assert_eq!(importer.set_real(&["normal_load"], &[index as f64]), OK);
    }
    // Free every third one in between.
    let importers: Vec<_> = importers.into_iter().enumerate().filter(|(index, _)| index % 3 != 0).collect();
    let later: Vec<_> = (0..500).map(|_| Importer::new()).collect();
    assert!(later.iter().all(|importer| importer.get_real("normal_load") == 0.0));
    for (index, importer) in &importers {
        assert_eq!(importer.get_real("normal_load"), *index as f64);
    }
}

#[test]
fn two_threads_on_one_instance_get_errors_and_leave_it_whole() {
    let importer = Importer::at(Stage::Stepping);
    let reference = scene::variables::find("sliding_velocity").unwrap();
    std::thread::scope(|scope| {
        for worker in 0..2_u32 {
            let importer = &importer;
            scope.spawn(move || {
                let mut rounds = 0;
                while rounds < 5_000 {
                    let value = f64::from(2 * rounds + worker);
                    // The instance may be busy, then the call is refused as a whole.
                    let statuses = [
                        importer.set_reals(&[reference, reference], &[value, value]),
                        importer.step(0.0, 0.0),
                        importer.get_reals(&[reference]).map_or_else(|status| status, |_| OK),
                    ];
                    assert!(statuses.iter().all(|&status| status == OK || status == ERROR), "{statuses:?}");
                    if statuses == [OK; 3] {
                        rounds += 1;
                    } else {
                        std::thread::yield_now();
                    }
                }
            });
        }
    });
    let log = importer.take_log();
    assert!(log.is_empty(), "a busy instance cannot log: {log:?}");
    assert_eq!(importer.step(0.0, 0.1), OK);
    assert!(importer.get_real("sliding_velocity") >= 9998.0);
}

/// Environment of a logger that calls back into the instance.
struct Reentrant {
    component: *mut c_void,
    statuses: Vec<Status>,
}

unsafe extern "C" fn call_back(
    environment: ComponentEnvironment,
    _: types::String,
    _: Status,
    _: types::String,
    _: types::String,
    _: *const c_char,
) {
    // SAFETY: the environment is the test's, which nobody else uses during the call.
    let reentrant = unsafe { &mut *environment.cast::<Reentrant>() };
    reentrant.statuses.extend(call_everything(reentrant.component));
    fmi2FreeInstance(reentrant.component);
}

#[test]
fn a_call_from_the_logger_finds_the_instance_busy() {
    let mut reentrant = Reentrant { component: ptr::null_mut(), statuses: Vec::new() };
    let environment = &raw mut reentrant;
    // SAFETY: as for the logger of `importer`; strings and structure live through the call, and the
    // environment is reached through one pointer only.
    unsafe {
        let callbacks = CallbackFunctions {
            logger: Some(as_logger(call_back)),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: environment.cast(),
        };
        let component = fmi2Instantiate(c"importer".as_ptr(), 1, guid().as_ptr(), ptr::null(), &callbacks, 0, 0);
        (*environment).component = component;
        assert_eq!(fmi2DoStep(component, 0.0, 0.1, 1), ERROR);
        assert!(!(*environment).statuses.is_empty(), "the logger was called");
        assert!((*environment).statuses.iter().all(|&status| status == ERROR));
        assert_eq!(fmi2Reset(component), OK, "the instance was not freed");
        fmi2FreeInstance(component);
    }
}

#[test]
fn instances_in_threads_of_their_own_give_the_same_results() {
    let run = || {
        let importer = Importer::at(Stage::Stepping);
        let mut outputs = Vec::new();
        for step in 0..200_i32 {
            let time = f64::from(step) * 0.01;
            assert_eq!(importer.set_real(&["sliding_velocity", "normal_load"], &[(3.0 * time).sin(), 500.0]), OK);
            assert_eq!(importer.step(time, 0.01), OK);
            outputs.push(importer.get_real("wear_depth").to_bits());
            outputs.push(importer.get_real("friction_force").to_bits());
        }
        outputs
    };
    let alone = run();
    let together: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).collect()
    });
    assert!(together.iter().all(|outputs| *outputs == alone));
    assert!(alone.iter().any(|&bits| bits != 0));
}
