//! A small pad far above its nominal speed.

use test_support::component;

#[test]
fn a_long_stop_from_twenty_metres_per_second_stays_above_absolute_zero() {
    let changes = [
        ("punch.width", 0.020),
        ("punch.count", 3.0),
        ("solver.fidelity", 3.0),
        ("solver.cells", 33.0),
        ("solver.tolerance", 0.1),
    ];
    let mut component = component("disc_brake", &changes);
    for load in [4000.0, 10_000.0] {
        for step in [0.001, 0.1, 10.0] {
            component.reset();
            component.enter_initialization();
            component.initialise(None).unwrap();
            component.set_input(0, 20.0);
            component.set_input(1, load);
            for number in 0..4 {
                component.step(step).unwrap_or_else(|error| panic!("{load} N, {step} s, step {number}: {error}"));
            }
        }
    }
}
