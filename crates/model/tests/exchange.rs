//! Bodies that start at different temperatures: the heat that they exchange, and steps that cross the opening and closing of cells.

use exact::special::complementary_error as erfc;
use std::f64::consts::PI;
use test_support::{Drive, changed, scene};

const LINE: f64 = 3.0;

/// Two half-spaces, the warmer one at `DIFFERENCE` above the other, touch at t = 0 through the conductance h. With the effusivities
/// e and `b = h (1/e_1 + 1/e_2)` the flux is `h DIFFERENCE E(t)`, `E = exp(b^2 t) erfc(b sqrt t)`; the surfaces have moved by
/// `e_j/(e_1 + e_2) (1 - E)` of the difference, and `h DIFFERENCE/b^2 (E - 1 + 2 b sqrt(t/pi))` has passed (Carslaw & Jaeger).
#[test]
fn bodies_of_different_temperature_exchange_what_half_spaces_do() {
    const DIFFERENCE: f64 = 200.0;
    const CONDUCTANCE: f64 = 1e5;
    const DURATION: f64 = 100.0;
    let pairs = [([54.0, 7200.0, 460.0], [54.0, 7200.0, 460.0]), ([1.2, 2600.0, 1000.0], [54.0, 7200.0, 460.0])];
    for (own, mate) in pairs {
        for tolerance in [1e-2, 1e-3] {
            let changes = [
                ("solver.fidelity", LINE),
                ("solver.cells", 16.0),
                ("solver.tolerance", tolerance),
                ("contact.geometry", 3.0),
                ("contact.mean_radius", 0.05 / PI),
                ("contact.conductance", CONDUCTANCE),
                ("contact.faces", 1.0),
                ("punch.width", 0.1),
                ("strip.length", 0.1),
                ("depth", 0.01),
                ("punch.height", 0.5),
                ("strip.height", 0.5),
                ("punch.top_thermal", 3.0),
                ("strip.base_thermal", 3.0),
                ("punch.convection", 0.0),
                ("strip.convection", 0.0),
                ("strip.convection_forced", 0.0),
                ("punch.thermal_expansion", 1e-9),
                ("strip.thermal_expansion", 0.0),
                ("punch.conductivity", own[0]),
                ("punch.density", own[1]),
                ("punch.specific_heat", own[2]),
                ("strip.conductivity", mate[0]),
                ("strip.density", mate[1]),
                ("strip.specific_heat", mate[2]),
                ("strip.initial_at_ambient", 0.0),
                ("strip.initial_temperature", 293.15 + DIFFERENCE),
                ("nominal.duration", DURATION),
                ("normal_load", 1000.0),
                ("sliding_velocity", 0.0),
            ];
            let effusivity = |[k, density, heat]: [f64; 3]| (k * density * heat).sqrt();
            let [e1, e2] = [own, mate].map(effusivity);
            let b = CONDUCTANCE * (e1.recip() + e2.recip());
            let mut drive = Drive::stock(&changes);
            let mut time = 0.0;
            for end in [1e-3, 1e-2, 0.1, 0.5] {
                let end = end * DURATION;
                drive.step(end - time);
                time = end;
                let root = b * end.sqrt();
                let decayed = if root < 20.0 { (root * root).exp() * erfc(root) } else { 1.0 / (PI.sqrt() * root) };
                let moved = DIFFERENCE * (1.0 - decayed) / (e1 + e2);
                let expected = 293.15 + 0.5 * (e2 * moved + DIFFERENCE - e1 * moved);
                let found = drive.get("contact_temperature");
                assert!(
                    (found - expected).abs() < tolerance * DIFFERENCE,
                    "{own:?} {tolerance} {end} s: {found} K, exact {expected}"
                );
                let passed = 1e-3 * CONDUCTANCE * DIFFERENCE / (b * b) * (decayed - 1.0 + 2.0 * b * (end / PI).sqrt());
                let found = drive.get("heat_received_punch");
                assert!(
                    (found - passed).abs() < 2.0 * tolerance * passed,
                    "{own:?} {tolerance} {end} s: {found} J, exact {passed}"
                );
            }
        }
    }
}

/// Contact temperatures (K above the initial ones) and highest pressures at the ends of the rows (s, m/s, N), linear between, in
/// communication steps of at most `longest` s.
fn driven(drive: &mut Drive, rows: &[[f64; 3]], longest: f64) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for pair in rows.windows(2) {
        let length = pair[1][0] - pair[0][0];
        let steps = (length / longest - 1e-9).ceil().max(1.0);
        for step in 0..steps as usize {
            for (name, column) in [("sliding_velocity", 1), ("normal_load", 2)] {
                let rate = (pair[1][column] - pair[0][column]) / length;
                drive.set(name, pair[0][column] + rate * length * step as f64 / steps).slope(name, rate);
            }
            drive.step(length / steps);
        }
        found.push(["contact_temperature", "pressure_max"].map(|name| drive.get(name)));
    }
    found
}

/// A cold pad laid lightly on a hot disc, a stop with the release and the next touch, hot spots that grow: the same within the
/// tolerance in one communication step and in many.
#[test]
fn results_do_not_depend_on_the_length_of_the_communication_steps() {
    let brake = |tolerance: f64| {
        let changes = [("solver.fidelity", LINE), ("solver.cells", 17.0), ("solver.tolerance", tolerance)];
        changed(&scene("disc_brake"), &changes)
    };
    let cold_pad = changed(
        &brake(1e-2),
        &[("strip.initial_at_ambient", 0.0), ("strip.initial_temperature", 673.15), ("normal_load", 100.0)],
    );
    let stop = brake(1e-3);
    let spots = changed(&scene("hot_spots"), &[("solver.tolerance", 1e-3), ("solver.cells", 32.0)]);
    let light = [[0.0, 0.0, 100.0], [0.3, 0.0, 100.0], [1.0, 0.0, 100.0], [3.0, 0.0, 100.0], [10.0, 0.0, 100.0]];
    let stops = [
        [0.0, 6.0, 0.0],
        [0.5, 6.0, 2600.0],
        [5.0, 0.5, 2600.0],
        [5.2, 0.2, 0.0],
        [8.0, 0.0, 0.0],
        [8.2, 0.0, 500.0],
        [12.0, 0.0, 500.0],
    ];
    let growing = [[0.0, 0.2, 200.0], [10.0, 0.2, 200.0], [20.0, 0.2, 200.0]];
    let cases = [
        ("cold pad", cold_pad, &light[..], [10.0, 1.0, 0.1], 1e-2 * 380.0),
        ("stop", stop, &stops[..], [5.0, 0.5, 0.05], 1e-3 * 30.0),
        ("hot spots", spots, &growing[..], [20.0, 1.0, 0.1], 1e-3 * 15.0),
    ];
    for (name, starts, rows, lengths, allowed) in cases {
        let [whole, tens, many] = lengths.map(|longest| driven(&mut Drive::from_starts(&starts, &[]), rows, longest));
        for (row, one) in whole.iter().enumerate() {
            for other in [&tens[row], &many[row]] {
                let apart = (one[0] - other[0]).abs();
                assert!(apart < allowed, "{name}, row {row}: {apart} K, {one:?} and {other:?}");
                assert!(
                    name == "cold pad" || (one[1] - other[1]).abs() <= 3e-3 * other[1].abs(),
                    "{name}, row {row}: {one:?} and {other:?}"
                );
            }
        }
    }
}
