//! Line and annular contact, faces, several punches, straight and closed paths.

use exact::reference::{LayerBase, band_mean};
use test_support::{Drive, HELD, INSULATED};

const OUTPUTS: [&str; 14] = [
    "friction_force",
    "friction_torque",
    "friction_power",
    "friction_force_kinetic",
    "friction_force_limit",
    "heat_flow_punch",
    "heat_flow_strip",
    "heat_flow_ambient",
    "stored_heat",
    "dissipated_energy",
    "wear_volume_punch",
    "wear_volume_strip",
    "wear_dissipation_power",
    "heat_lost_ambient",
];

const PER_FACE: [&str; 7] = [
    "pressure_mean",
    "contact_temperature",
    "wear_depth",
    "wear_depth_strip",
    "punch.mean_temperature",
    "strip.mean_temperature",
    "sliding_distance",
];

fn heated(changes: &[(&str, f64)], load: f64) -> Drive {
    let mut drive = Drive::stock(changes);
    drive.set("sliding_velocity", 6.0).set("normal_load", load).steps(20, 1.0);
    drive
}

/// Both closed: the same up to rounding.
fn same(what: &str, a: f64, b: f64, factor: f64) {
    assert!((a * factor - b).abs() <= 1e-9 * b.abs(), "{what}: {a} times {factor} is not {b}");
}

#[test]
fn faces_scale_forces_heat_and_volumes_only() {
    let hot = [("strip.emissivity", 0.5), ("contact.friction_fade.factor[2]", 0.8)];
    let mut one = heated(&[hot.as_slice(), &[("contact.faces", 1.0)]].concat(), 5e3);
    let mut three = heated(&[hot.as_slice(), &[("contact.faces", 3.0)]].concat(), 5e3);
    for name in OUTPUTS {
        same(name, one.get(name), three.get(name), 3.0);
        assert!(one.get(name) != 0.0, "{name}");
    }
    for name in PER_FACE {
        same(name, one.get(name), three.get(name), 1.0);
    }
}

#[test]
fn punches_share_the_load_and_the_path() {
    // Two punches under twice the load round L are one under the load round L/2, twice.
    let cooled = [("punch.convection", 0.0), ("strip.convection_forced", 0.0), ("strip.convection", 0.0)];
    let one_change = [cooled.as_slice(), &[("strip.length", 0.4), ("punch.count", 1.0)]].concat();
    let two_change = [cooled.as_slice(), &[("strip.length", 0.8), ("punch.count", 2.0)]].concat();
    let (mut one, mut two) = (heated(&one_change, 3e3), heated(&two_change, 6e3));
    for name in PER_FACE {
        same(name, one.get(name), two.get(name), 1.0);
    }
    for name in OUTPUTS {
        same(name, one.get(name), two.get(name), 2.0);
    }
}

#[test]
fn annular_contact_has_the_moments_of_its_ring() {
    let (mean, width) = (0.1175, 0.055);
    let changes = [
        ("contact.geometry", 2.0),
        ("contact.mean_radius", mean),
        ("punch.width", width),
        ("depth", 0.08),
        ("punch.wear_velocity_exponent", 0.5),
    ];
    let mut drive = Drive::stock(&changes);
    let (load, velocity) = (4e3, 5.0);
    drive.set("normal_load", load).set("sliding_velocity", velocity);
    // Quadrature over the ring at the uniform pressure p = F/area.
    let count = 20_000;
    let (mut torque, mut wear) = (0.0, 0.0);
    let pressure = load / (width * 0.08);
    for index in 0..count {
        let r = mean + width * ((f64::from(index) + 0.5) / f64::from(count) - 0.5);
        let area = 0.08 * r / mean * width / f64::from(count);
        torque += 0.4 * pressure * r * area;
        wear += 2e-14 * 1e6 * (pressure / 1e6) * (velocity * r / mean).sqrt() * area;
    }
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-8;
    assert!(close(drive.get("friction_torque"), 2.0 * torque));
    assert!(close(drive.get("friction_torque"), 2.0 * 0.4 * load * drive.get("effective_radius")));
    assert!(close(drive.get("friction_force"), 2.0 * torque / mean));
    assert!(close(drive.get("friction_power"), 2.0 * torque / mean * velocity));
    let (outer, inner) = (mean + 0.5 * width, mean - 0.5 * width);
    let exact = 2.0 / 3.0 * (outer.powi(3) - inner.powi(3)) / (outer.powi(2) - inner.powi(2));
    assert!(close(drive.get("effective_radius"), exact));
    drive.step(10.0);
    assert!(close(drive.get("wear_volume_punch"), 2.0 * wear * 10.0), "{}", drive.get("wear_volume_punch"));
    assert!(close(drive.get("dissipated_energy"), 2.0 * torque / mean * velocity * 10.0));
    assert!(drive.imbalance() < 1e-9);
}

#[test]
fn line_contact_turns_about_its_mean_radius_and_angular_velocity_adds_to_the_sliding_one() {
    let mut drive = Drive::stock(&[]);
    drive.set("normal_load", 4e3).set("sliding_velocity", 2.0).set("angular_velocity", -40.0);
    let force = drive.get("friction_force");
    assert_eq!(force, -2.0 * 0.4 * 4e3);
    assert!((drive.get("friction_torque") - force * 0.1175).abs() < 1e-9);
    assert!((drive.get("friction_power") - force * (2.0 - 40.0 * 0.1175)).abs() < 1e-9);
    drive.step(3.0);
    assert!((drive.get("sliding_distance") - 3.0 * 2.7).abs() < 1e-12);
}

#[test]
fn unidirectional_on_a_straight_path_is_the_moving_band_on_fresh_material() {
    for (base, thermal) in [(LayerBase::Held, HELD), (LayerBase::Insulated, INSULATED)] {
        for velocity in [0.002, 0.05, 3.0] {
            let width = 0.02;
            let changes = [
                ("strip.path", 1.0),
                ("contact.mean_radius", 0.0),
                ("punch.width", width),
                ("depth", 0.05),
                ("contact.faces", 1.0),
                ("punch.conductivity", 0.0),
                ("contact.conductance", 1e15),
                ("strip.base_thermal", thermal),
                ("strip.convection", 0.0),
                ("strip.convection_forced", 0.0),
                ("solver.tolerance", 1e-4),
                ("nominal.duration", 1e3),
            ];
            let mut drive = Drive::stock(&changes);
            drive.set("normal_load", 500.0).set("sliding_velocity", velocity);
            let flux = 0.4 * 500.0 * velocity / (width * 0.05);
            let half = 0.5 * width;
            let peclet = velocity * half / (2.0 * 54.0 / (7200.0 * 460.0));
            let exact = flux * half / 54.0 * band_mean(peclet, Some((0.011 / half, base)));
            drive.steps(200, 10.0);
            let rise = drive.get("contact_temperature") - 293.15;
            println!("{base:?} {velocity}: {rise} {exact}");
            assert!((rise / exact - 1.0).abs() < 2e-4, "{base:?} {velocity} m/s: {rise} instead of {exact}");
            assert!(drive.imbalance() < 1e-9);
        }
    }
}

#[test]
fn unidirectional_starts_like_a_half_space() {
    // Short against the time to slide over the contact and to conduct across it: T = 2 q sqrt(t/(pi k rho c)).
    let changes = [
        ("strip.path", 1.0),
        ("contact.mean_radius", 0.0),
        ("punch.width", 0.2),
        ("punch.conductivity", 0.0),
        ("contact.conductance", 1e15),
        ("strip.height", 0.2),
        ("nominal.duration", 10.0),
        ("solver.tolerance", 1e-4),
    ];
    let mut drive = Drive::stock(&changes);
    drive.set("normal_load", 1e6).set("sliding_velocity", 1e-3);
    let flux = 0.4 * 1e6 * 1e-3 / drive.area();
    drive.step(1.0);
    let exact = 2.0 * flux * (1.0 / (std::f64::consts::PI * 54.0 * 7200.0 * 460.0)).sqrt();
    let rise = drive.get("contact_temperature") - 293.15;
    // The edges take part: of the order of the diffusion length over the width, 4 mm over 200 mm.
    println!("{rise} {exact}");
    assert!((rise / exact - 1.0).abs() < 4e-2 && rise < exact, "{rise} {exact}");
}

#[test]
fn worn_depth_times_its_area_is_the_volume() {
    // Closed: the strip loses its height all along. Straight: half of a full pass under the contact.
    let load = 3e3;
    let mut closed = heated(&[("strip.length", 0.6), ("strip.wear_coefficient", 1e-14)], load);
    let worn = |coefficient: f64| coefficient * load * 6.0 * 20.0;
    let depth = closed.get("depth");
    assert!((closed.get("wear_depth_strip") * 0.6 * depth / worn(1e-14) - 1.0).abs() < 1e-9);
    assert!((closed.get("wear_depth_punch") * closed.area() / worn(2e-14) - 1.0).abs() < 1e-9);
    assert!((closed.get("wear_depth") - closed.get("wear_depth_punch") - closed.get("wear_depth_strip")).abs() < 1e-18);
    let mut straight = heated(&[("strip.path", 1.0), ("strip.wear_coefficient", 1e-14)], load);
    assert!((straight.get("wear_volume_strip") / (2.0 * worn(1e-14)) - 1.0).abs() < 1e-9);
    let pass = 1e-14 * load / straight.area() * straight.get("punch.width");
    let groove = straight.get("wear_depth_strip");
    assert!((groove / (0.5 * pass) - 1.0).abs() < 2e-2, "{groove} {pass}");
}

/// Mean rise of a band of half-width `half` that heats a half-space evenly with 1 W/m2 and has moved at `velocity` for `time`: the
/// integral over the time since heat entered of what is still within reach of the band, s = 2 sqrt(kd t), E(z) = z erf z + exp(-z2)/sqrt(pi):
/// s/(4 a) (E((2 a - V t)/s) + E((2 a + V t)/s) - 2 E(V t/s)) / sqrt(pi K rho c t).
fn moving_band([k, capacity]: [f64; 2], half: f64, velocity: f64, time: f64) -> f64 {
    use std::f64::consts::PI;
    let even = |z: f64| z * (1.0 - exact::special::complementary_error(z)) + (-z * z).exp() / PI.sqrt();
    const PARTS: usize = 4000;
    // Over the root of the time: no singularity.
    let root = time.sqrt() / PARTS as f64;
    let at = |part: usize| {
        let age = (root * (part as f64 + 0.5)).powi(2);
        let (s, way) = (2.0 * (k / capacity * age).sqrt(), velocity * age);
        let reach = even((2.0 * half - way) / s) + even((2.0 * half + way) / s) - 2.0 * even(way / s);
        s / (4.0 * half) * reach / (PI * k * capacity).sqrt() * 2.0 * root
    };
    (0..PARTS).map(at).sum()
}

/// Sliding that begins: the reduction of `lumped` errs by no more than theory says of Peclet 1 to 300, over the rise of the moment.
#[test]
fn a_start_from_rest_errs_by_no_more_than_is_stated() {
    let (k, capacity, width) = (54.0, 7200.0 * 460.0, 0.02);
    // Widths in a turn; an endless path.
    for (turn, stated) in [(0.0, 0.18), (2.0, 0.36), (4.0, 0.36), (12.0, 0.36), (40.0, 0.36)] {
        for peclet in [1.0, 3.0, 10.0, 30.0, 100.0, 300.0] {
            let velocity = 4.0 * peclet * k / capacity / width;
            let mut drive = Drive::stock(&[
                ("strip.path", if turn > 0.0 { 2.0 } else { 1.0 }),
                ("strip.length", turn * width),
                ("contact.mean_radius", 0.0),
                ("punch.width", width),
                // Plane: deeper than high.
                ("depth", 1.0),
                ("strip.height", 0.2),
                ("contact.faces", 1.0),
                ("punch.conductivity", 0.0),
                ("contact.conductance", 1e15),
                ("strip.convection", 0.0),
                ("strip.convection_forced", 0.0),
                ("solver.tolerance", 1e-4),
                ("nominal.velocity", velocity),
                ("nominal.duration", 10.0 * width / velocity),
            ]);
            drive.set("normal_load", 1e4).set("sliding_velocity", velocity);
            let flux = drive.get("contact.friction_coefficient") * 1e4 * velocity / width;
            // A tenth of a turn.
            let step = 0.05 * if turn > 0.0 { 0.1 * turn } else { 4.0 } * width / velocity;
            let error = |number: u32| {
                let rise = flux * moving_band([k, capacity], 0.5 * width, velocity, step * f64::from(number));
                ((drive.step(step).get("contact_temperature") - 293.15) / rise - 1.0).abs()
            };
            let most = (1..=20).map(error).fold(0.0, f64::max);
            println!("{turn} widths, Peclet {peclet}: {most:.3}");
            assert!(most < stated, "{turn} widths, Peclet {peclet}: {most}");
        }
    }
}
