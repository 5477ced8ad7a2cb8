//! Contact that ends within the zone: the temperature converges as the edges move through the cells, not as cells open.

use verification::applications::{all, trial};

/// Errors of the contact temperature on 9, 17 and 33 cells, relative to its rise on 129 cells.
fn errors(name: &str) -> [f64; 3] {
    let all = all().unwrap();
    let application = all.iter().find(|application| application.name == name).unwrap();
    let run = |cells: usize| trial::fine_run(application, cells, 1e-3).unwrap().main;
    let fine = run(129);
    [9, 17, 33].map(|cells| trial::errors(&run(cells), &fine)[1])
}

#[test]
fn the_temperature_converges_where_ends_lift_off() {
    // With whole cells that open one by one: 7e-3, 2.4e-3, 1.7e-3; 2.3e-2, 9e-3, 3.4e-3; 9e-3, 1.2e-2, 4e-3; 4e-3, 3e-3, 1.5e-3.
    for (name, bounds) in [
        ("drag_4", [3e-3, 1.5e-3, 7e-4]),
        ("caliper_3", [1e-2, 3e-3, 2e-3]),
        ("cooled_1", [1.4e-2, 5e-3, 1.5e-3]),
        ("duty_1", [3e-3, 1e-3, 7e-4]),
    ] {
        let found = errors(name);
        println!("{name}: {found:?}");
        assert!(found.iter().zip(bounds).all(|(error, bound)| *error < bound), "{name}: {found:?}");
    }
}
