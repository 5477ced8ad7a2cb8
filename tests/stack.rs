//! Measured stack use of the component: it depends on the scene and not on the values of its inputs, and stays within the
//! documented bound (page in the FMU).

use scene::variables::{COUNT, STARTS, find};
use sliding_contact::component::Component;
use std::hint::black_box;
use std::ptr;
use std::sync::Arc;
use std::thread;
use test_support::{LINE, changed};

/// Stack that a thread needs according to the page in the FMU, bytes.
const DOCUMENTED: usize = 256 << 10;

/// Stack of the threads that are measured, and the part of it that is painted, bytes.
const STACK: usize = 16 << 20;
const PAINTED: usize = 12 << 20;

const PAINT: u8 = 0xa5;

/// Address of the caller's stack, about.
#[inline(never)]
fn here() -> usize {
    let mark = 0_u8;
    black_box(ptr::from_ref(&mark)) as usize
}

/// Paints the stack below the caller's.
#[inline(never)]
fn paint() -> usize {
    let mut room = [PAINT; PAINTED];
    black_box(room.as_mut_ptr()) as usize
}

/// The most stack (bytes) below the caller that `work` used.
fn used(work: impl FnOnce()) -> usize {
    let top = here();
    let lowest = paint();
    work();
    // The region holds only the paint and data written by `work`.
    // SAFETY: the addresses belong to this thread's stack, of which they are the painted part.
    let left = (lowest..top).find(|&at| unsafe { ptr::read_volatile(at as *const u8) } != PAINT);
    left.map_or(0, |left| top - left)
}

/// Stack that a scene uses from initialisation on, through steps with these inputs and slopes of velocity and load.
fn of(changes: &'static [(&'static str, f64)], drive: &'static [[f64; 4]]) -> usize {
    let run = move || {
        used(|| {
            let reference = |name: &str| find(name).unwrap();
            let mut component = Box::new(Component::new(Arc::new(changed(&STARTS, changes))));
            component.enter_initialization();
            component.initialise(None).unwrap();
            for [velocity, load, acceleration, rate] in drive {
                let (v, f) = (reference("sliding_velocity"), reference("normal_load"));
                component.set_input(v, *velocity);
                component.set_input(f, *load);
                component.set_input_derivative(v, *acceleration);
                component.set_input_derivative(f, *rate);
                // An error uses stack as well.
                let _ = component.step(0.01);
                (0..COUNT as u32).for_each(|reference| _ = component.get(reference));
            }
        })
    };
    thread::Builder::new().stack_size(STACK).spawn(run).unwrap().join().unwrap()
}

const USUAL: &[[f64; 4]] = &[[10.0, 4e3, 0.0, 0.0], [10.0, 4e3, 1.0, 10.0]];
/// From rest, through zero, round numbers, and far beyond any machine.
const HOSTILE: &[[f64; 4]] = &[
    [10.0, 4e3, 0.0, 0.0],
    [10.0, 4e3, 1.0, 10.0],
    [0.0, 4e3, 4.0, 0.0],
    [0.01, 4e3, -2.0, 0.0],
    [1e-16, 1e-9, 0.0, 1.0],
    [1e6, 1e9, 1e6, 1e9],
    [1e12, 1e12, 0.0, 0.0],
];

#[test]
fn stack_does_not_grow_with_the_inputs_and_stays_within_what_is_documented() {
    let scenes: [(&str, &[(&str, f64)]); 5] = [
        ("lumped", &[("solver.fidelity", 2.0)]),
        ("auto", &[("solver.fidelity", 1.0), ("solver.tolerance", 0.1)]),
        ("9 cells", &[("solver.fidelity", LINE), ("solver.cells", 9.0), ("solver.tolerance", 0.01)]),
        (
            "annulus",
            &[
                ("solver.fidelity", LINE),
                ("solver.cells", 9.0),
                ("solver.tolerance", 0.01),
                ("contact.geometry", 2.0),
                ("strip.length", 0.0),
            ],
        ),
        ("257 cells", &[("solver.fidelity", LINE), ("solver.cells", 257.0), ("solver.tolerance", 0.1)]),
    ];
    for (name, changes) in scenes {
        let usual = of(changes, USUAL);
        // Fine cells run the same code at a higher cost.
        let hostile = if name == "257 cells" { usual } else { of(changes, HOSTILE) };
        assert!(usual > 0 && hostile <= usual + (16 << 10), "{name}: {usual} bytes, hostile inputs {hostile}");
        assert!(hostile <= DOCUMENTED, "{name}: {hostile} bytes, documented {DOCUMENTED}");
    }
}
