//! Pressure at one instant: closed forms, balances, the holder.

use exact::{FlatPunch, HertzLine, friction_exponent};
use test_support::{Drive, initial_gap};

/// Rigid punch, 60 mm wide and 10 mm deep, on a half-plane of E = 200 GPa, nu = 0.3; friction 0.25, no heat feeds back.
pub const BASE: &[(&str, f64)] = &[
    ("solver.fidelity", 3.0),
    // Pressure and wear alone.
    ("solver.heat", 2.0),
    ("solver.cells", 65.0),
    ("punch.width", 0.06),
    ("depth", 0.01),
    ("punch.body", 1.0),
    ("*.height", 0.1),
    ("strip.body", 3.0),
    ("strip.youngs_modulus", 200e9),
    ("strip.poissons_ratio", 0.3),
    ("strip.path", 2.0),
    ("strip.length", 2.0),
    ("contact.geometry", 1.0),
    ("contact.mean_radius", 0.0),
    ("contact.friction_coefficient", 0.25),
    ("contact.faces", 1.0),
    ("punch.count", 1.0),
    ("*.thermal_expansion", 0.0),
    ("punch.wear_coefficient", 3.9e-14),
    ("strip.wear_coefficient", 0.0),
    ("nominal.load", 1e4),
    ("nominal.velocity", 0.01),
    ("nominal.duration", 100.0),
];

/// [`BASE`] with changes.
pub fn line(changes: &[(&str, f64)]) -> Drive {
    Drive::stock(&[BASE, changes].concat())
}

/// Trapezoid sum over the stations.
pub fn trapezoid(values: &[f64], width: f64) -> f64 {
    let spacing = width / (values.len() - 1) as f64;
    values.windows(2).map(|pair| 0.5 * spacing * (pair[0] + pair[1])).sum()
}

#[test]
fn flat_punch_sliding_and_at_rest() {
    for (velocity, friction) in [(0.0, 0.25), (0.01, 0.25), (-0.01, 0.25), (0.01, 0.6)] {
        let mut drive = line(&[("contact.friction_coefficient", friction)]);
        drive.set("normal_load", 1e4).set("sliding_velocity", velocity);
        let pressure = drive.profile("pressure");
        let sign = if velocity == 0.0 { 0.0 } else { f64::signum(velocity) };
        let exact =
            FlatPunch { load: 1e4 / 0.01, half_width: 0.03, signed_exponent: sign * friction_exponent(friction, 0.3) };
        let spacing = 0.06 / 32.0;
        for station in 2..31 {
            let x = spacing * station as f64 - 0.03;
            let mean = (exact.carried(x + 0.5 * spacing) - exact.carried(x - 0.5 * spacing)) / spacing;
            let error = pressure[station] / mean - 1.0;
            assert!(error.abs() < 1.5e-3, "v = {velocity}, mu = {friction}, x = {x}: {error:e}");
        }
        // The trailing edge is loaded more.
        let edges = (pressure[1] - pressure[31]) * velocity;
        assert!(edges > 0.0 || velocity == 0.0, "{velocity}");
        assert!((trapezoid(&pressure, 0.06) * 0.01 / 1e4 - 1.0).abs() < 1e-13);
        assert!((drive.get("pressure_mean") / (1e4 / 6e-4) - 1.0).abs() < 1e-13);
        assert_eq!(drive.get("contact_fraction"), 1.0);
        assert_eq!(drive.get("tilt"), 0.0);
        assert!(drive.get("approach") > 0.0);
        assert!(drive.get("pressure_max") > 2.0 * drive.get("pressure_mean"));
    }
}

#[test]
fn hertz_and_a_tabulated_gap_agree() {
    let radius = 100.0;
    let mut tabulated: Vec<_> = initial_gap(|x| (0.06 * x).powi(2) / (2.0 * radius)).collect();
    tabulated.extend([("contact.initial_shape", 4.0), ("contact.shear_coupling", 0.0), ("solver.cells", 129.0)]);
    let parabolic = [
        ("contact.initial_shape", 2.0),
        ("contact.initial_radius", radius),
        ("contact.shear_coupling", 0.0),
        ("solver.cells", 129.0),
    ];
    let load = 1e4 / 0.01;
    let exact = HertzLine::new(load, radius, 200e9 / 0.91);
    for (changes, bound) in [(&parabolic[..], 2e-3), (&tabulated[..], 2e-2)] {
        let mut drive = line(changes);
        drive.set("normal_load", 1e4).set("sliding_velocity", 0.01);
        let pressure = drive.profile("pressure");
        let spacing = 0.06 / 32.0;
        for station in 0..33 {
            let x = spacing * station as f64 - 0.03;
            let half = 0.5 * spacing;
            let mean = (exact.carried(x + half) - exact.carried(x - half)) / spacing;
            assert!(
                (pressure[station] - mean).abs() < bound * exact.pressure(0.0),
                "x = {x}: {} {mean}",
                pressure[station]
            );
        }
        let fraction = drive.get("contact_fraction");
        assert!(fraction > 0.3 && fraction < 0.95, "{fraction}");
    }
}

#[test]
fn pivot_moves_the_resultant_to_the_leading_edge() {
    for velocity in [0.01, -0.01] {
        let mut drive =
            line(&[("holder.constraint", 2.0), ("holder.pivot_height", 0.02), ("contact.shear_coupling", 0.0)]);
        drive.set("normal_load", 1e4).set("sliding_velocity", velocity);
        let pressure = drive.profile("pressure");
        let positions = drive.profile("x");
        // The moment from the stations is accurate to the square of their spacing only.
        let moment: Vec<f64> = pressure.iter().zip(&positions).map(|(p, x)| p * x).collect();
        let lever = trapezoid(&moment, 0.06) / trapezoid(&pressure, 0.06);
        assert!((lever - 0.25 * 0.02 * velocity.signum()).abs() < 2e-4, "{lever}");
        assert!(drive.get("tilt") * velocity > 0.0);
    }
    let twice_as_much_at_rest = [
        ("contact.static_friction_ratio", 1.0),
        ("contact.friction_table.points", 2.0),
        ("contact.friction_table.speed[2]", 1.0),
        ("contact.friction_table.coefficient[1]", 0.5),
        ("contact.friction_table.coefficient[2]", 0.25),
    ];
    for (height, friction) in [(0.12, &[][..]), (0.06, &twice_as_much_at_rest)] {
        let holder = [("holder.constraint", 2.0), ("holder.pivot_height", height)];
        let tipping = Drive::attempt(&scene::variables::STARTS, &[BASE, &holder, friction].concat());
        let text = tipping.err().unwrap();
        assert!(text.contains("tips over") && text.contains("0.03"), "{text}");
    }
}

#[test]
fn annulus_wears_where_it_is_fast() {
    let changes = [
        ("contact.geometry", 2.0),
        ("contact.mean_radius", 0.1),
        ("strip.length", 0.0),
        ("punch.width", 0.06),
        ("depth", 0.1),
        ("strip.body", 2.0),
        ("strip.foundation_stiffness", 1e12),
        ("punch.wear_coefficient", 1e-12),
        ("solver.cells", 33.0),
        ("contact.friction_coefficient", 0.4),
    ];
    let mut drive = line(&changes);
    drive.set("normal_load", 2e4).set("sliding_velocity", 5.0);
    let start = drive.get("effective_radius");
    assert!((start / (0.1 * (1.0 + 0.09 / 3.0)) - 1.0).abs() < 1e-3, "{start}");
    drive.steps(100, 1.0);
    // p = C/r: torque/force = (outer^2 - inner^2)/2 / (outer - inner) = r_m in the steady state.
    let radius = drive.get("effective_radius");
    assert!((radius / 0.1 - 1.0).abs() < 1e-3, "{radius}");
    let pressure = drive.profile("pressure");
    let positions = drive.profile("x");
    let constant = pressure[16] * 0.1;
    for station in 2..31 {
        let exact = constant / (0.1 + positions[station]);
        assert!((pressure[station] / exact - 1.0).abs() < 3e-3, "{station}");
    }
    let (force, torque) = (drive.get("friction_force"), drive.get("friction_torque"));
    assert!((force / (0.4 * 2e4 * radius / 0.1) - 1.0).abs() < 1e-9, "{force}");
    assert!((torque / (force * 0.1) - 1.0).abs() < 1e-12);
    assert!(drive.imbalance() < 1e-9);
}
