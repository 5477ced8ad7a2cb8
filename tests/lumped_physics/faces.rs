//! Heat loss of convecting tops and bases: constant and forced convection and radiation, as on every free face.

use exact::property_slab::{Face, PropertySlab};
use test_support::{CONVECTING, Drive, HELD, INSULATED, named};

const AREA: f64 = 0.1;
const AMBIENT: f64 = 300.0;
const CONVECTION: f64 = 12.0;
const FORCED: f64 = 40.0;
const EMISSIVITY: f64 = 0.8;

/// A one-dimensional scene: punch and strip cover each other entirely, and their sides are not cooled.
const COVERED: &[(&str, f64)] = &[
    ("contact.geometry", 3.0),
    ("punch.width", 1.0),
    ("strip.length", 1.0),
    ("depth", 0.1),
    ("contact.faces", 1.0),
    ("contact.friction_coefficient", 1.0),
    ("contact.conductance", 1e9),
    ("punch.cooled_area", 1e-12),
    ("*.wear_coefficient", 0.0),
    ("punch.top_thermal", INSULATED),
    ("strip.base_thermal", INSULATED),
    ("ambient_temperature", AMBIENT),
    ("nominal.velocity", 0.0),
    ("nominal.load", 0.0),
    ("nominal.duration", 400.0),
    // Heat is on the cells of the line, and moves nothing.
    ("*.thermal_expansion", 1e-10),
    ("solver.tolerance", 1e-4),
];

/// The scene in which only `body` conducts: 10 mm of iron, or of a poorly conducting lining.
fn alone(body: &str, conductivity: f64, more: &[(&str, f64)]) -> Drive {
    let (other, face) = if body == "punch" { ("strip", "punch.top_thermal") } else { ("punch", "strip.base_thermal") };
    let own = [
        ("conductivity", conductivity),
        ("height", 0.01),
        ("density", 7200.0),
        ("specific_heat", 460.0),
        ("convection", CONVECTION),
        ("convection_forced", FORCED),
        ("emissivity", EMISSIVITY),
    ]
    .map(|(name, value)| named(format!("{body}.{name}"), value));
    let changes = [COVERED, &own, &[named(format!("{other}.conductivity"), 0.0), (face, CONVECTING)], more].concat();
    Drive::stock(&changes)
}

/// Heat (W/m2) per kelvin above the air that a face of `t` (K) loses, where the air has the speed `speed` (m/s).
fn transfer(t: f64, speed: f64) -> f64 {
    let radiation = 5.670_374_419e-8 * EMISSIVITY * (t * t + AMBIENT * AMBIENT) * (t + AMBIENT);
    CONVECTION + FORCED * speed.powf(0.8) + radiation
}

/// Temperatures (K) of the heated face and in the mean, and the heat that has left (J/m2), of the slab of that conductivity after [`PHASES`].
fn slab(conductivity: f64) -> [f64; 3] {
    const STEPS: usize = 2000;
    let points = [(AMBIENT, conductivity, 460.0)];
    let mut slab = PropertySlab::new(0.01, 7200.0, &points, [Face::Convecting(0.0, AMBIENT); 2], 60, AMBIENT);
    for (flux, speed, duration) in PHASES {
        for _ in 0..STEPS {
            slab.faces[1] = Face::Convecting(transfer(slab.temperature[59], speed), AMBIENT);
            slab.advance(duration / STEPS as f64, flux, flux);
        }
    }
    [slab.surface(), slab.mean(), slab.lost[1]]
}

/// Heats with 3e4 W/m2, raises the air speed, then cools, in steps of `step` s: contact and mean temperature, heat lost per area.
fn course(drive: &mut Drive, body: &str, step: f64) -> [f64; 3] {
    for (velocity, cooling, load) in [(2.0, 0.0, 1.5e3), (2.0, 6.0, 1.5e3), (2.0, 6.0, 0.0)] {
        drive.set("sliding_velocity", velocity).set("cooling_velocity", cooling).set("normal_load", load);
        drive.steps((100.0 / step) as u32, step);
    }
    let lost = if body == "punch" { "heat_lost_punch_top" } else { "heat_lost_strip_base" };
    ["contact_temperature", &format!("{body}.mean_temperature"), lost].map(|name| drive.get(name))
}

const PHASES: [(f64, f64, f64); 3] = [(3e4, 2.0, 100.0), (3e4, 8.0, 100.0), (0.0, 8.0, 100.0)];

/// At every level and for either body, temperatures and heat lost equal those of an independent finite-volume solution.
#[test]
fn a_convecting_far_face_cools_as_a_slab_of_finite_volumes() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0)];
    for (level, more) in [("lumped", &[][..]), ("line", &line[..])] {
        for body in ["punch", "strip"] {
            for conductivity in [54.0, 1.0] {
                let mut drive = alone(body, conductivity, more);
                let found = course(&mut drive, body, 1.0);
                let exact = slab(conductivity);
                let rise = 3e4 * 100.0 / (7200.0 * 460.0 * 0.01);
                let text = format!("{level} {body} {conductivity}: {found:?} {exact:?}");
                assert!((found[0] - exact[0]).abs() < 1.5e-3 * rise, "{text}");
                assert!((found[1] - exact[1]).abs() < 1e-3 * rise, "{text}");
                assert!((found[2] / AREA / exact[2] - 1.0).abs() < 2e-3, "{text}");
                assert!(exact[2] > 0.4 * 3e4 * 200.0 * conductivity / 54.0, "{text}");
                assert!(drive.imbalance() < 1e-9, "{level} {body}: {:e}", drive.imbalance());
            }
        }
    }
}

/// Steady state: the heat flux through the slab equals the loss of the far face at its temperature, and conduction gives the
/// rise.
#[test]
fn a_steady_far_face_gives_off_what_enters() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0)];
    for more in [&[][..], &line] {
        for body in ["punch", "strip"] {
            let mut drive = alone(body, 54.0, more);
            drive.set("sliding_velocity", 3.0).set("normal_load", 1e3).steps(200, 20.0);
            let flux = 3e4;
            let far = (0..100).fold(AMBIENT, |t, _| AMBIENT + flux / transfer(t, 3.0));
            let expected = far + flux * 0.01 / 54.0;
            let found = drive.get("contact_temperature");
            assert!((found - expected).abs() < 1e-4 * (expected - AMBIENT), "{body}: {found} {expected}");
            let flow = drive.get(if body == "punch" { "heat_flow_punch_top" } else { "heat_flow_strip_base" });
            let (air, power) = (drive.get("heat_flow_ambient"), drive.get("friction_power"));
            assert!((flow / power - 1.0).abs() < 1e-4 && air.abs() < 1e-4 * power, "{body}: {flow} {air} {power}");
            assert!(drive.imbalance() < 1e-9, "{body}: {:e}", drive.imbalance());
        }
    }
}

/// A hot punch out of contact, its top insulated: all round it has no sides and keeps its heat; the given area cools it at
/// `h A/(rho c V)`, and of the two sides of a block it is 2 height x depth.
#[test]
fn a_punch_all_round_has_no_sides_to_cool() {
    let (width, height, depth) = (0.2, 0.01, 0.05);
    for level in [2.0, 3.0] {
        for (geometry, given, area) in
            [(3.0, 0.0, 0.0), (3.0, 2e-3, 2e-3), (1.0, 0.0, 2.0 * height * depth), (1.0, 2e-3, 2e-3)]
        {
            let mut drive = Drive::stock(&[
                ("solver.fidelity", level),
                ("solver.cells", 9.0),
                ("solver.tolerance", 1e-4),
                ("contact.geometry", geometry),
                ("punch.width", width),
                ("punch.height", height),
                ("depth", depth),
                ("strip.path", 2.0),
                ("strip.length", if geometry == 3.0 { width } else { 1.0 }),
                ("punch.conductivity", 400.0),
                ("punch.density", 8000.0),
                ("punch.specific_heat", 400.0),
                ("punch.convection", 20.0),
                ("punch.convection_forced", 0.0),
                ("punch.emissivity", 0.0),
                ("punch.cooled_area", given),
                ("punch.top_thermal", INSULATED),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", AMBIENT + 100.0),
                ("ambient_temperature", AMBIENT),
                ("nominal.duration", 1000.0),
            ]);
            drive.set("sliding_velocity", 1.0).step(1000.0);
            let exact = 100.0 * f64::exp(-20.0 * area * 1000.0 / (8000.0 * 400.0 * width * height * depth));
            let found = drive.get("punch.mean_temperature") - AMBIENT;
            // The block is not quite uniform across.
            assert!(
                (found - exact).abs() < 5e-3 * 100.0,
                "level {level}, geometry {geometry}, {given} m2: {found} {exact}"
            );
            assert!(given > 0.0 || geometry == 1.0 || (found - 100.0).abs() < 1e-9, "{found}");
        }
    }
}

/// Bodies as warm as the faces that are held, in surroundings as warm: nothing flows, and every temperature stays.
#[test]
fn a_body_as_warm_as_its_held_face_has_that_mean_temperature() {
    for level in [2.0, 3.0] {
        let hot = AMBIENT + 350.0;
        let mut drive = Drive::stock(&[
            ("solver.fidelity", level),
            ("solver.cells", 9.0),
            ("punch.top_thermal", HELD),
            ("punch.top_at_ambient", 0.0),
            ("punch.top_temperature", hot),
            ("*.initial_at_ambient", 0.0),
            ("*.initial_temperature", hot),
            ("strip.base_thermal", HELD),
            ("strip.base_at_ambient", 0.0),
            ("strip.base_temperature", hot),
            ("*.convection", 0.0),
            ("strip.convection_forced", 0.0),
            ("strip.emissivity", 0.0),
            ("ambient_temperature", AMBIENT),
        ]);
        drive.set("normal_load", 1e3);
        for _ in 0..3 {
            for body in ["punch.mean_temperature", "strip.mean_temperature", "contact_temperature"] {
                let found = drive.get(body);
                assert!((found - hot).abs() < 1e-6 * 350.0, "level {level}: {body} {found}");
            }
            drive.step(100.0);
        }
    }
}
