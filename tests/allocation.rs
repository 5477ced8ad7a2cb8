//! A step allocates nothing once the component is initialised, at any level, also when it logs a message.

use scene::slot;
use scene::variables::{Kind, STARTS, find, lookup};
use sliding_contact::component::Component;
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, ComponentEnvironment, Logger, Status};
use std::cell::Cell;
use std::ffi::{CString, c_char, c_void};
use std::ptr;
use std::sync::Arc;
use test_support::counting::{ALLOCATIONS, Counting};
use test_support::{LUMPED, changed};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Steps in reciprocating sliding under changing load and step size, reading every output, and counts the allocations.
fn allocations(changes: &[(&str, f64)], speed: f64, steps: u32) -> (u64, Vec<sliding_contact::component::Message>) {
    // Lumped, unless the changes say otherwise.
    let starts = changed(&changed(&STARTS, &[("solver.fidelity", LUMPED)]), changes);
    let mut component = Component::new(Arc::new(starts));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component.messages().for_each(drop);
    let before = ALLOCATIONS.get();
    for step in 0..steps {
        let phase = f64::from(step) * 0.37;
        component.set_input(0, speed * phase.sin());
        component.set_input(1, 3000.0 * (0.3 * phase).sin().abs());
        if step % 3 == 0 {
            component.set_input_derivative(0, -2.0 * speed);
            component.set_input_derivative(1, 100.0);
        }
        // Changing step sizes recompute the weights.
        component.step(0.05 + 0.01 * f64::from(step % 20)).unwrap();
        for output in 7..250 {
            assert!(component.get(output).is_finite());
        }
    }
    let allocated = ALLOCATIONS.get() - before;
    (allocated, component.messages().cloned().collect())
}

#[test]
fn steps_and_outputs_allocate_nothing() {
    // A closed path, and a straight one with its worn track; a fading friction coefficient takes the general form.
    // There the contact stays within the track's window, so that nothing is logged.
    for (path, fade, speed) in [(2.0, 1.0, 8.0), (1.0, 1.0, 0.01), (2.0, 0.5, 8.0)] {
        let changes = [("strip.path", path), ("contact.friction_fade.factor[2]", fade)];
        let (allocated, messages) = allocations(&changes, speed, 3000);
        assert_eq!(allocated, 0, "path {path}, fade {fade}: {messages:?}");
    }
}

#[test]
fn steps_and_outputs_of_the_contact_line_allocate_nothing() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 17.0)];
    // By default heat is resolved, because the bodies expand; without expansion it is lumped, as it is with a bristle.
    let cold = [("*.thermal_expansion", 0.0)];
    let annulus = [("contact.geometry", 2.0), ("strip.path", 2.0), ("strip.length", 0.0), ("contact.mean_radius", 0.1)];
    let scenes: [&[(&str, f64)]; 11] = [
        &[],
        // Sliding faster than planned: the strip computes its responses within the steps.
        &[("contact.geometry", 1.0), ("nominal.velocity", 1e-4)],
        &cold,
        &[("contact.stick_stiffness", 1e7), ("contact.stick_damping", 1e3)],
        &[("punch.wear_pressure_exponent", 0.5), ("contact.initial_shape", 2.0), ("contact.initial_radius", 20.0)],
        &[("punch.wear_pressure_exponent", 0.7), ("punch.wear_threshold", 1e6), ("strip.wear_threshold", 2e5)],
        &[("strip.path", 1.0), ("contact.geometry", 1.0), ("nominal.stroke", 0.05)],
        &[("holder.stiffness", 1e8), ("contact.friction_fade.factor[2]", 0.5)],
        &[("contact.geometry", 1.0), ("holder.constraint", 2.0), ("holder.pivot_height", 0.02)],
        &annulus,
        &[annulus[0], annulus[1], annulus[2], annulus[3], ("contact.friction_fade.factor[2]", 0.5)],
    ];
    // A line that was planned has the lumped level in parallel.
    let auto = [("solver.fidelity", 1.0), ("solver.tolerance", 1e-3)];
    for scene in scenes.into_iter().chain([&auto[..]]) {
        let (allocated, messages) = allocations(&[&line[..], scene].concat(), 0.01, 100);
        assert_eq!(allocated, 0, "{scene:?}: {messages:?}");
    }
}

/// Above its critical speed a step is rejected and retried with shorter ones, and the contact separates.
#[test]
fn steps_that_follow_growing_hot_spots_allocate_nothing() {
    // A conducting half-plane all round on a rigid insulator: unstable above 0.06 m/s.
    let scene = [
        ("solver.fidelity", 3.0),
        ("solver.cells", 16.0),
        ("contact.geometry", 3.0),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_coefficient", 0.3),
        ("strip.path", 2.0),
        ("strip.length", 0.01),
        ("punch.width", 0.01),
        ("punch.height", 0.1),
        ("punch.body", 3.0),
        ("punch.youngs_modulus", 2e11),
        ("punch.conductivity", 45.0),
        ("punch.thermal_expansion", 1.1e-5),
        ("strip.body", 1.0),
        ("strip.conductivity", 0.0),
        ("nominal.velocity", 0.05),
    ];
    let (allocated, messages) = allocations(&scene, 0.2, 30);
    assert_eq!(allocated, 0, "{messages:?}");
    assert!(messages.iter().any(|message| message.text.starts_with("thermoelastically unstable")), "{messages:?}");
}

/// Counts, and measures the text.
unsafe extern "C" fn count(
    environment: ComponentEnvironment,
    _: types::String,
    _: Status,
    _: types::String,
    _: types::String,
    text: *const c_char,
) {
    // SAFETY: the environment is the test's counter, the text ends with a zero.
    unsafe {
        let counter = &*environment.cast::<Cell<usize>>();
        counter.set(counter.get() + usize::from(*text != 0));
    }
}

/// Allocations between the importer's call and its logger: a load below 0 N, a limit of the temperature, and an exceeded plan.
#[test]
fn steps_that_an_importer_takes_and_that_have_something_to_say_allocate_nothing() {
    let said = Cell::new(0);
    type Fixed =
        unsafe extern "C" fn(ComponentEnvironment, types::String, Status, types::String, types::String, *const c_char);
    // SAFETY: on the platforms of these tests a variadic function takes a pointer as any other does.
    let logger = unsafe { std::mem::transmute::<Fixed, Logger>(count) };
    let callbacks = CallbackFunctions {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::from_ref(&said).cast_mut().cast(),
    };
    let guid = CString::new(slot::current().unwrap().guid()).unwrap();
    let is_real = |output: &u32| matches!(lookup(*output), Some((row, _)) if matches!(row.kind, Kind::Real { .. }));
    let outputs: Vec<u32> = (7..250).filter(is_real).collect();
    let mut values = vec![0.0; outputs.len()];
    // SAFETY: strings, structure and vectors live through the calls.
    unsafe {
        let component =
            fmi2Instantiate(c"importer".as_ptr(), types::CO_SIMULATION, guid.as_ptr(), ptr::null(), &callbacks, 0, 1);
        assert!(!component.is_null());
        let set = |component: *mut c_void, name: &str, value: f64| {
            assert_eq!(fmi2SetReal(component, &find(name).unwrap(), 1, &value), Status::Ok, "{name}");
        };
        // A plan for which the lumped level suffices at the nominal load.
        for (name, value) in [
            ("punch.thermal_expansion", 0.0),
            ("strip.thermal_expansion", 0.0),
            ("punch.wear_pressure_exponent", 1.3),
            ("nominal.duration", 100.0),
            ("solver.tolerance", 0.2),
            ("contact.temperature_limit", 310.0),
        ] {
            set(component, name, value);
        }
        let limited = find("contact.temperature_limited").unwrap();
        assert_eq!(fmi2SetBoolean(component, &limited, 1, &1), Status::Ok);
        assert_eq!(fmi2SetupExperiment(component, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi2EnterInitializationMode(component), Status::Ok);
        assert_eq!(fmi2ExitInitializationMode(component), Status::Ok);
        let [velocity, load] = ["sliding_velocity", "normal_load"].map(|name| find(name).unwrap());
        let announced = said.get();
        let before = ALLOCATIONS.get();
        for step in 0..40 {
            let force = if step == 10 { -1.0 } else { 300.0 * f64::from(step) };
            let set = fmi2SetReal(component, [velocity, load].as_ptr(), 2, [10.0, force].as_ptr());
            assert_eq!((set, fmi2DoStep(component, f64::from(step), 1.0, 1)), (Status::Ok, Status::Ok), "{step}");
            let status = fmi2GetReal(component, outputs.as_ptr(), outputs.len(), values.as_mut_ptr());
            assert_eq!(status, Status::Ok);
        }
        let allocated = ALLOCATIONS.get() - before;
        assert_eq!((said.get() - announced, allocated), (3, 0));
        fmi2FreeInstance(component);
    }
}
