//! A step allocates nothing once the component is initialised.

use sliding_contact::component::Component;
use sliding_contact::variables::{STARTS, find};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

struct Counting;

thread_local! {
    /// Allocations of this thread: the test harness has threads of its own.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promises are those of this function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the memory came from `alloc`, that is from the system's allocator.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Steps to and fro under changing load and step size, reading every output, and counts what that allocates.
fn allocations(changes: &[(&str, f64)], speed: f64, steps: u32) -> (u64, Vec<sliding_contact::component::Message>) {
    let mut starts = STARTS;
    // Lumped, unless the changes say otherwise.
    starts[find("solver.fidelity").unwrap() as usize] = 2.0;
    for (name, value) in changes {
        starts[find(name).unwrap() as usize] = *value;
    }
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
        // Step sizes that change make new weights.
        component.step(0.05 + 0.01 * f64::from(step % 20)).unwrap();
        for output in 7..250 {
            assert!(component.get(output).is_finite());
        }
    }
    let allocated = ALLOCATIONS.get() - before;
    (allocated, component.messages().collect())
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
    // Where nothing says otherwise heat runs along the cells, because the bodies expand; without expansion it follows the
    // mean, as it does with a bristle.
    let cold = [("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
    let scenes: [&[(&str, f64)]; 7] = [
        &[],
        &cold,
        &[("contact.stick_stiffness", 1e7), ("contact.stick_damping", 1e3)],
        &[("punch.wear_pressure_exponent", 0.5), ("contact.initial_shape", 2.0), ("contact.initial_radius", 20.0)],
        &[("strip.path", 1.0), ("contact.geometry", 1.0), ("nominal.stroke", 0.05)],
        &[("holder.stiffness", 1e8), ("contact.friction_fade.factor[2]", 0.5)],
        &[("contact.geometry", 1.0), ("holder.constraint", 2.0), ("holder.pivot_height", 0.02)],
    ];
    for scene in scenes {
        let (allocated, messages) = allocations(&[&line[..], scene].concat(), 0.01, 300);
        assert_eq!(allocated, 0, "{scene:?}: {messages:?}");
    }
}
