//! Heat: every boundary, insulators, conductances, initial and prescribed temperatures.

use test_support::{CONVECTING, Drive, EXTERNAL, HELD, INSULATED};

const BOUNDARIES: [(&str, f64); 4] =
    [("held", HELD), ("convecting", CONVECTING), ("insulated", INSULATED), ("external", EXTERNAL)];

/// Heat flow outputs and the outputs of their integrals.
const FLOWS: [(&str, &str); 6] = [
    ("heat_flow_ambient", "heat_lost_ambient"),
    ("heat_flow_punch_top", "heat_lost_punch_top"),
    ("heat_flow_strip_base", "heat_lost_strip_base"),
    ("heat_flow_punch", "heat_received_punch"),
    ("heat_flow_strip", "heat_received_strip"),
    ("friction_power", "dissipated_energy"),
];

/// Runs smooth trajectories of load and speed over 20 s in `steps` steps; the integral of every flow by the trapezoidal rule.
/// Inputs in `swing` vary in proportion to the load's trajectory, from their own value by the given amount.
fn trapezoid(drive: &mut Drive, swing: &[(&str, f64, f64)], steps: u32) -> [f64; 6] {
    let mut sums = [0.0; 6];
    let step = 20.0 / f64::from(steps);
    let course = |t: f64| (std::f64::consts::PI * t / 20.0).sin().powi(2);
    let inputs = |t: f64| (4.0 + 2.0 * (0.3 * t).sin(), 4e3 * course(t));
    let mut before = [0.0; 6];
    for index in 0..=steps {
        let (v, f) = inputs(f64::from(index) * step);
        drive.set("sliding_velocity", v).set("normal_load", f);
        for (name, from, by) in swing {
            drive.set(name, from + by * course(f64::from(index) * step));
        }
        let now = FLOWS.map(|(flow, _)| drive.get(flow));
        if index > 0 {
            for ((sum, a), b) in sums.iter_mut().zip(before).zip(now) {
                *sum += 0.5 * step * (a + b);
            }
        }
        before = now;
        if index < steps {
            let (next_v, next_f) = inputs(f64::from(index + 1) * step);
            drive.slope("sliding_velocity", (next_v - v) / step).slope("normal_load", (next_f - f) / step);
            for (name, _, by) in swing {
                drive.slope(name, by * (course(f64::from(index + 1) * step) - course(f64::from(index) * step)) / step);
            }
            drive.step(step);
        }
    }
    sums
}

fn check_flows(what: &str, changes: &[(&str, f64)], swing: &[(&str, f64, f64)]) {
    let mut drive = Drive::stock(&[&[("solver.tolerance", 1e-5)], changes].concat());
    let sums = trapezoid(&mut drive, swing, 2000);
    let moved = FLOWS.map(|(_, integral)| drive.get(integral).abs()).into_iter().fold(0.0, f64::max);
    for ((flow, integral), sum) in FLOWS.iter().zip(sums) {
        let exact = drive.get(integral);
        let error = (sum - exact).abs() / moved;
        assert!(error < 1e-4, "{what}: integral of {flow} {sum}, {integral} {exact}");
    }
    let imbalance = drive.imbalance();
    assert!(imbalance < 1e-9, "{what}: {imbalance:e}");
}

/// External temperatures at initialisation: without a jump, whose flow the trapezoidal rule cannot resolve.
const COLD: &[(&str, f64)] = &[("*.external_temperature", 293.15)];
const SWING: &[(&str, f64, f64)] =
    &[("strip.external_temperature", 293.15, 40.0), ("punch.external_temperature", 293.15, 20.0)];

#[test]
fn every_boundary_balances_and_its_flows_integrate_to_what_was_lost() {
    for (top, punch) in BOUNDARIES {
        for (base, strip) in BOUNDARIES {
            let changes = [&[("punch.top_thermal", punch), ("strip.base_thermal", strip)], COLD].concat();
            check_flows(&format!("top {top}, base {base}"), &changes, SWING);
        }
    }
}

#[test]
fn radiation_forced_convection_and_fade_balance() {
    let swing = [("cooling_velocity", 15.0, 10.0), ("ambient_temperature_offset", 0.0, -20.0)];
    let own: [(&str, &[(&str, f64)]); 3] = [
        ("punch in air", &[]),
        ("both in air", &[("strip.emissivity", 0.9), ("strip.convection_forced", 80.0)]),
        (
            "both in air, of a given area",
            &[("strip.emissivity", 0.9), ("strip.convection_forced", 80.0), ("strip.cooled_area", 0.2)],
        ),
    ];
    for (what, own) in own {
        let both = [
            ("punch.emissivity", 0.7),
            ("punch.convection_forced", 50.0),
            ("contact.friction_fade.factor[3]", 0.6),
            // Alike, so that nothing jumps when they touch.
            ("*.initial_at_ambient", 0.0),
            ("*.initial_temperature", 330.0),
        ];
        let changes = [&both[..], own].concat();
        if what != "both in air" {
            check_flows(what, &changes, &swing);
            continue;
        }
        let mut drive = Drive::stock(&changes);
        trapezoid(&mut drive, &swing, 200);
        let imbalance = drive.imbalance();
        assert!(imbalance < 1e-9, "{what}: {imbalance:e}");
    }
}

#[test]
fn an_insulator_takes_nothing() {
    for (body, other) in [("punch", "strip"), ("strip", "punch")] {
        let mut drive = Drive::stock(&[(&format!("{body}.conductivity"), 0.0)]);
        drive.set("sliding_velocity", 5.0).set("normal_load", 3e3).steps(20, 1.0);
        assert_eq!(drive.get(&format!("heat_received_{body}")), 0.0);
        let (received, heat) = (drive.get(&format!("heat_received_{other}")), drive.get("dissipated_energy"));
        assert!((received / heat - 1.0).abs() < 1e-12, "{received} {heat}");
        // mu F v of both faces.
        assert!((heat / (2.0 * 0.4 * 3e3 * 100.0) - 1.0).abs() < 1e-12, "{heat}");
        assert!(drive.imbalance() < 1e-9);
        // The jump over the conductance: (q2 - q1)/(2 h_c), half of it on either side of the mean.
        let jump = drive.get("contact_temperature_max") - drive.get("contact_temperature");
        let flux = 0.4 * 3e3 * 5.0 / drive.area();
        // The mean comes from the step, whose cooling is iterated to a thousandth of the tolerance of the rise.
        assert!((jump - 0.25 * flux / 2e4).abs() < 1e-6 * 200.0, "{jump}");
    }
    assert!(Drive::attempt(&scene::variables::STARTS, &[("*.conductivity", 0.0)]).is_err());
}

#[test]
fn surfaces_and_flows_obey_the_interface_law() {
    let mut drive = Drive::stock(&[("solver.tolerance", 1e-5)]);
    drive.set("sliding_velocity", 5.0).set("normal_load", 3e3);
    for _ in 0..10 {
        drive.step(0.7);
        let area = 2.0 * drive.area();
        let (punch, strip) = (drive.get("heat_flow_punch") / area, drive.get("heat_flow_strip") / area);
        let power = drive.get("friction_power") / area;
        assert!(((punch + strip) / power - 1.0).abs() < 1e-12);
        let jump = 2.0 * (drive.get("contact_temperature_max") - drive.get("contact_temperature"));
        assert!((jump - (strip - punch).abs() / (2.0 * 2e4)).abs() < 1e-3 * 1e-5 * 200.0, "{jump}");
    }
}

#[test]
fn bodies_start_at_their_own_temperature_or_the_ambient_one() {
    let mut drive = Drive::stock(&[
        ("ambient_temperature", 280.0),
        ("ambient_temperature_offset", 15.0),
        ("strip.initial_at_ambient", 0.0),
        ("strip.initial_temperature", 400.0),
    ]);
    assert!((drive.get("punch.mean_temperature") - 295.0).abs() < 1e-9);
    assert!((drive.get("strip.mean_temperature") - 400.0).abs() < 1e-7, "{}", drive.get("strip.mean_temperature"));
    // Apart, the surfaces keep their own temperatures: the mean is half of either.
    // Except for the boundary layer of the instantaneous response to the air, of a tenth of the tolerance at most.
    assert!((drive.get("contact_temperature") - 347.5).abs() < 1e-4 * 105.0, "{}", drive.get("contact_temperature"));
    // Nothing happens to bodies at rest with their surroundings.
    let mut still = Drive::stock(&[("ambient_temperature", 280.0), ("ambient_temperature_offset", 15.0)]);
    for _ in 0..10 {
        still.set("normal_load", 1e3).step(100.0);
    }
    assert!((still.get("contact_temperature") - 295.0).abs() < 1e-9);
    assert!(still.get("stored_heat").abs() < 1e-6 && still.get("heat_lost_ambient").abs() < 1e-6);
}

#[test]
fn the_ambient_offset_and_the_tunable_ambient_are_the_same() {
    let end = |tunable: bool, base: f64| {
        let mut drive = Drive::stock(&[("solver.tolerance", 1e-5), ("strip.base_thermal", base)]);
        if tunable {
            drive.0.set_parameter(test_support::reference("ambient_temperature"), 313.15);
        } else {
            drive.set("ambient_temperature_offset", 20.0);
        }
        drive.steps(50, 2000.0);
        (drive.get("contact_temperature"), drive.get("stored_heat"), drive.imbalance())
    };
    let area = Drive::stock(&[]).area();
    let depth = Drive::stock(&[]).get("depth");
    let pads = 2600.0 * 1000.0 * 0.012 * area;
    let discs = 7200.0 * 460.0 * 0.011 * depth * 2.0 * std::f64::consts::PI * 0.1175;
    for (name, base) in BOUNDARIES.into_iter().take(3) {
        let (offset, tunable) = (end(false, base), end(true, base));
        assert_eq!(offset, tunable);
        // Everything ends at the new ambient temperature, and has stored rho c V dT of it.
        assert!((offset.0 - 313.15).abs() < 1e-3, "{name} {offset:?}");
        assert!((offset.1 / (2.0 * 20.0 * (pads + discs)) - 1.0).abs() < 1e-4, "{name} {offset:?}");
        assert!(offset.2 < 1e-9);
    }
}
