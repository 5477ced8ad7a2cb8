//! Contact that ends within the zone, and within cells.

use test_support::Application;

/// Contact that ends within the zone: the temperature converges as the edges move through the cells, not as cells open.
#[test]
fn the_temperature_converges_where_ends_lift_off() {
    for (name, bounds) in [
        ("long_drag", [3e-3, 1.5e-3, 7e-4]),
        ("stiff_caliper", [1e-2, 3.5e-3, 2e-3]),
        ("cooled_disc", [1.4e-2, 5e-3, 1.7e-3]),
        ("duty_cycle", [3.3e-3, 1.6e-3, 6e-4]),
    ] {
        let scene = Application::read(name);
        let on = |cells: f64| {
            let line = [("solver.fidelity", 3.0), ("solver.cells", cells), ("solver.tolerance", 1e-3)];
            scene.run(&line).unwrap()
        };
        let fine = on(129.0);
        let found = [9.0, 17.0, 33.0].map(|cells| on(cells).errors(&fine)[1]);
        assert!(found.iter().zip(bounds).all(|(error, bound)| *error < bound), "{name}: {found:?}");
    }
}
