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

#[test]
fn steps_and_outputs_allocate_nothing() {
    // A closed path, and a straight one with its worn track; a fading friction coefficient takes the general form.
    // There the contact stays within the track's window, so that nothing is logged.
    for (path, fade, speed) in [(2.0, 1.0, 8.0), (1.0, 1.0, 0.01), (2.0, 0.5, 8.0)] {
        let mut starts = STARTS;
        starts[find("strip.path").unwrap() as usize] = path;
        starts[find("contact.friction_fade.factor[2]").unwrap() as usize] = fade;
        let mut component = Component::new(Arc::new(starts));
        component.enter_initialization();
        component.initialise(None).unwrap();
        let before = ALLOCATIONS.get();
        for step in 0..3000 {
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
        assert_eq!(allocated, 0, "path {path}, fade {fade}: {:?}", component.messages().collect::<Vec<_>>());
    }
}
