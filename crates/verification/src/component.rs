//! The whole component against closed forms, with variables set by name as in the FMU.
//!
//! Theory: docs/theory.md, section 10.

use super::driver::Driven;
use super::{Fallible, Problem, Value, known};
use conduction::STEFAN_BOLTZMANN;
use exact::reference::{ClosedPath, LayerBase};
use std::f64::consts::PI;

const STRAIGHT: f64 = 1.0;
const PERIODIC: f64 = 3.0;
const HELD: f64 = 1.0;
const CONVECTING: f64 = 2.0;
const INSULATED: f64 = 3.0;

/// Iron strip of 0.1 m2 that the punch covers entirely: one-dimensional. No cooling, no wear, no fade, perfect conductance,
/// one face; mu F v = 10 N m/s per N and m/s of mu = 1.
const COVERED: &[(&str, f64)] = &[
    ("contact.geometry", PERIODIC),
    ("punch.width", 1.0),
    ("strip.length", 1.0),
    ("depth", 0.1),
    ("contact.faces", 1.0),
    ("contact.friction_coefficient", 1.0),
    ("contact.conductance", 1e15),
    ("punch.convection", 0.0),
    ("strip.convection", 0.0),
    ("strip.convection_forced", 0.0),
    ("punch.wear_coefficient", 0.0),
    ("strip.wear_coefficient", 0.0),
    ("punch.top_thermal", INSULATED),
    ("strip.base_thermal", INSULATED),
    ("strip.conductivity", 54.0),
    ("strip.density", 7200.0),
    ("strip.specific_heat", 460.0),
    ("ambient_temperature", 300.0),
    ("nominal.velocity", 0.0),
    ("nominal.load", 0.0),
    ("solver.tolerance", 1e-4),
];

const AREA: f64 = 0.1;

/// [`COVERED`] with changes, under the friction heat flux `flux` (W/m2).
fn heated(changes: &[(&str, f64)], flux: f64) -> Fallible<Driven> {
    let mut all = COVERED.to_vec();
    all.extend(changes);
    let mut driven = Driven::new(&all)?;
    driven.set("sliding_velocity", 10.0)?;
    driven.set("normal_load", flux * AREA / 10.0)?;
    Ok(driven)
}

/// What `of` reads after `count` steps (s) of [`heated`].
fn after<const N: usize>(
    changes: [(&'static str, f64); N],
    flux: f64,
    (step, count): (f64, u32),
    of: impl Fn(&mut Driven) -> Fallible<f64> + 'static,
) -> Value {
    Box::new(move || {
        let mut driven = heated(&changes, flux)?;
        driven.steps(step, count)?;
        of(&mut driven)
    })
}

fn part_of_punch(driven: &mut Driven) -> Fallible<f64> {
    Ok(driven.get("heat_received_punch")? / driven.get("dissipated_energy")?)
}

/// Hotter side less the mean, K.
fn jump(driven: &mut Driven) -> Fallible<f64> {
    Ok(driven.get("contact_temperature_max")? - driven.get("contact_temperature")?)
}

/// Rise of the contact temperature, K.
fn rise(driven: &mut Driven) -> Fallible<f64> {
    Ok(driven.get("contact_temperature")? - 300.0)
}

pub(super) fn problems(all: &mut Vec<Problem>) {
    short_heating(all);
    interface(all);
    balances(all);
    cooling(all);
    wear(all);
}

const OWN_TOLERANCE: &str = "solver.tolerance = 1e-4 of the peak rise";

fn short_heating(all: &mut Vec<Problem>) {
    let effusivity = (54.0_f64 * 7200.0 * 460.0).sqrt();
    all.push(Problem {
        name: "component: half-space under constant flux".into(),
        quantity: "temperature rise after 1 s, K",
        exact: known(2e6 / effusivity / PI.sqrt()),
        scale: None,
        compute: after(
            [("punch.conductivity", 0.0), ("strip.height", 0.1), ("nominal.duration", 1.0)],
            1e6,
            (0.1, 10),
            rise,
        ),
        bound: 1e-4,
        reason: OWN_TOLERANCE,
    });
    // q = q0 (1 - t/ts): T = (2 q0/e) sqrt(t/pi) (1 - 2 t/(3 ts)), largest at ts/2. A stop from 100 km/h at 8 m/s2.
    let stop = 100.0 / 3.6 / 8.0;
    for part in [0.25, 0.5, 0.9] {
        let exact = |part: f64| 2.0 * 1.336e6 / effusivity * (part * stop / PI).sqrt() * (1.0 - 2.0 / 3.0 * part);
        all.push(Problem {
            name: format!("component: stop from 100 km/h on a half-space, {part} of its time"),
            quantity: "temperature rise, K",
            exact: known(exact(part)),
            scale: Some(exact(0.5)),
            compute: Box::new(move || {
                let changes = [("punch.conductivity", 0.0), ("strip.height", 0.2), ("nominal.duration", stop)];
                let mut driven = heated(&changes, 1.336e6)?;
                let count = 20_u32;
                let step = part * stop / f64::from(count);
                for index in 0..count {
                    driven.set("sliding_velocity", 10.0 * (1.0 - part * f64::from(index) / f64::from(count)))?;
                    driven.set_slope("sliding_velocity", -10.0 / stop)?;
                    driven.steps(step, 1)?;
                }
                rise(&mut driven)
            }),
            bound: 1e-4,
            reason: OWN_TOLERANCE,
        });
    }
}

fn interface(all: &mut Vec<Problem>) {
    // Heat partition of two half-spaces in contact: in proportion to their effusivities.
    let (punch, strip) = ((1.2_f64 * 2600.0 * 1000.0).sqrt(), (54.0_f64 * 7200.0 * 460.0).sqrt());
    let thick = [("punch.height", 0.1), ("strip.height", 0.1), ("nominal.duration", 1.0)];
    all.push(Problem {
        name: "component: heat split of two half-spaces".into(),
        quantity: "part of the heat that enters the punch",
        exact: known(punch / (punch + strip)),
        scale: Some(1.0),
        compute: after(thick, 1e6, (0.1, 10), part_of_punch),
        bound: 1e-4,
        reason: OWN_TOLERANCE,
    });
    all.push(Problem {
        name: "component: contact conductance 0 halves the heat".into(),
        quantity: "part of the heat that enters the punch",
        exact: known(0.5),
        scale: None,
        compute: after([thick[0], thick[1], thick[2], ("contact.conductance", 0.0)], 1e6, (0.1, 10), part_of_punch),
        bound: 1e-12,
        reason: "exact but for rounding",
    });
    all.push(Problem {
        name: "component: contact conductance 1e15 joins the surfaces".into(),
        quantity: "hotter side less the mean, K",
        exact: known(0.0),
        scale: Some(80.0),
        compute: after(thick, 1e6, (0.1, 10), jump),
        bound: 1e-9,
        reason: "exact but for rounding",
    });
    // T1 - T2 = (q2 - q1)/(2 h_c): over an insulated punch q1 = 0, and the mean is (T1 + T2)/2.
    all.push(Problem {
        name: "component: jump over a contact conductance of 10 kW/(m2.K), insulating punch".into(),
        quantity: "hotter side less the mean, K",
        exact: known(1e6 / 4e4),
        scale: None,
        compute: after([("punch.conductivity", 0.0), ("contact.conductance", 1e4)], 1e6, (0.1, 10), jump),
        bound: 1e-9,
        reason: "exact but for rounding",
    });
}

fn balances(all: &mut Vec<Problem>) {
    let closed = [("strip.height", 0.011), ("nominal.duration", 100.0)];
    let insulator = ("punch.conductivity", 0.0);
    all.push(Problem {
        name: "component: two insulated slabs keep all heat".into(),
        quantity: "stored over dissipated heat",
        exact: known(1.0),
        scale: None,
        compute: after(closed, 1e5, (1.0, 100), |driven| {
            Ok(driven.get("stored_heat")? / driven.get("dissipated_energy")?)
        }),
        bound: 1e-9,
        reason: "heat is conserved by construction",
    });
    all.push(Problem {
        name: "component: insulated slab, mean temperature".into(),
        quantity: "mean temperature rise after 100 s of 1e5 W/m2, K",
        exact: known(1e5 * 100.0 / (0.011 * 7200.0 * 460.0)),
        scale: None,
        compute: after([closed[0], closed[1], insulator], 1e5, (1.0, 100), |driven| {
            Ok(driven.get("strip.mean_temperature")? - 300.0)
        }),
        bound: 1e-9,
        reason: "heat is conserved by construction",
    });
    all.push(Problem {
        name: "component: steady slab with held base".into(),
        quantity: "temperature rise q h/k, K",
        exact: known(1e6 * 0.011 / 54.0),
        scale: None,
        compute: after([closed[0], closed[1], insulator, ("strip.base_thermal", HELD)], 1e6, (100.0, 100), rise),
        bound: 1e-7,
        reason: "stationary solutions are in the reduced space; rounding where it holds many functions that look alike",
    });
    // The covered fraction is in the strip's mean mode, the rest in the moving source.
    let path = ClosedPath {
        length: 1.0,
        half_length: 0.05,
        height: 0.011,
        conductivity: 54.0,
        diffusivity: 54.0 / (7200.0 * 460.0),
        base: LayerBase::Held,
    };
    all.push(Problem {
        name: "component: steady closed path with held base, 10 m/s, Fourier sum".into(),
        quantity: "temperature rise, K",
        exact: Box::new(move || Ok(1e6 * (0.1 * path.height / path.conductivity + path.steady_mean(10.0, 200_000)))),
        scale: None,
        compute: after(
            [
                closed[0],
                closed[1],
                insulator,
                ("strip.base_thermal", HELD),
                ("contact.geometry", 1.0),
                ("punch.width", 0.1),
                ("depth", 1.0),
            ],
            1e6,
            (10.0, 100),
            rise,
        ),
        bound: 1e-4,
        reason: OWN_TOLERANCE,
    });
}

fn cooling(all: &mut Vec<Problem>) {
    // So conductive that its temperature is uniform: exp(-H t/(rho c h)); the Biot number H h/k is 1e-6.
    let (transfer, capacity) = (10.0, 2600.0 * 1000.0 * 0.01);
    let time = 0.5 * capacity / transfer;
    all.push(Problem {
        name: "component: body of uniform temperature in air".into(),
        quantity: "mean temperature above ambient, K",
        exact: known(100.0 * (-0.5_f64).exp()),
        scale: Some(100.0),
        compute: Box::new(move || {
            let changes = [
                ("strip.conductivity", 0.0),
                ("punch.conductivity", 1e5),
                ("punch.height", 0.01),
                ("punch.convection", transfer),
                ("punch.cooled_area", 1e-12),
                ("punch.top_thermal", CONVECTING),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", 400.0),
                ("nominal.duration", time),
            ];
            let mut driven = heated(&changes, 0.0)?;
            driven.steps(0.1 * time, 10)?;
            Ok(driven.get("punch.mean_temperature")? - 300.0)
        }),
        bound: 1e-5,
        reason: "the body's own Biot number, 1e-6, and the rounding of the eigenvalues",
    });
    // Cooled on its sides by moving air: H = H1 (v_c/v0)^0.8, v_c = 3 m/s, v0 = 1 m/s.
    let forced = transfer * 3.0_f64.powf(0.8);
    all.push(Problem {
        name: "component: body of uniform temperature in moving air".into(),
        quantity: "mean temperature above ambient, K",
        exact: known(100.0 * (-0.5 * forced / transfer).exp()),
        scale: Some(100.0),
        compute: Box::new(move || {
            let changes = [
                ("strip.conductivity", 0.0),
                ("punch.conductivity", 1e5),
                ("punch.height", 0.01),
                ("punch.convection_forced", transfer),
                ("punch.cooled_area", AREA),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", 400.0),
                ("nominal.duration", time),
            ];
            let mut driven = heated(&changes, 0.0)?;
            driven.set("sliding_velocity", -1.0)?;
            driven.set("cooling_velocity", 2.0)?;
            driven.steps(0.01 * time, 100)?;
            Ok(driven.get("punch.mean_temperature")? - 300.0)
        }),
        bound: 1e-4,
        reason: OWN_TOLERANCE,
    });
    // epsilon sigma (T^4 - Ta^4) = q at the heated surface; the base is insulated.
    let flux = 2e4;
    let equilibrium = (flux / (0.8 * STEFAN_BOLTZMANN) + 300.0_f64.powi(4)).powf(0.25);
    all.push(Problem {
        name: "component: radiation in equilibrium with the friction heat".into(),
        quantity: "temperature, K",
        exact: known(equilibrium),
        scale: Some(equilibrium - 300.0),
        compute: Box::new(move || {
            let changes = [
                ("punch.conductivity", 0.0),
                ("strip.emissivity", 0.8),
                ("strip.cooled_area", AREA),
                ("nominal.duration", 1e4),
            ];
            let mut driven = heated(&changes, flux)?;
            driven.steps(100.0, 500)?;
            driven.get("contact_temperature")
        }),
        bound: 1e-5,
        reason: "what is left of the approach to equilibrium, and the static remainder at the surface",
    });
}

fn wear(all: &mut Vec<Problem>) {
    // V = k F s of both bodies, all faces.
    let exact = 2.0 * 3e3 * 200.0 * (2e-14 + 1e-15);
    for (name, path) in [("closed", 2.0), ("straight", STRAIGHT)] {
        all.push(Problem {
            name: format!("component: Archard wear, {name} path, two faces"),
            quantity: "worn volume k F s, m3",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || {
                let mut driven = Driven::new(&[("strip.path", path), ("contact.conductance", 1e6)])?;
                driven.set("normal_load", 3e3)?;
                for velocity in [4.0, -6.0] {
                    driven.set("sliding_velocity", velocity)?;
                    driven.steps(1.0, 20)?;
                }
                Ok(driven.get("wear_volume_punch")? + driven.get("wear_volume_strip")?)
            }),
            bound: 1e-12,
            reason: "the law integrates in closed form at constant inputs",
        });
    }
    // dw/dt = k p0 v0 (p/p0)^b (v/v0)^a with p0 = 1 MPa, v0 = 1 m/s.
    let depth = 2e-14 * 1e6 * (3e3_f64 / (0.055 * 0.08) / 1e6).sqrt() * 4.0_f64.powf(0.3) * 50.0;
    all.push(Problem {
        name: "component: wear with b = 0.5, a = 0.3".into(),
        quantity: "worn depth of the punch, m",
        exact: known(depth),
        scale: None,
        compute: Box::new(|| {
            let changes = [
                ("punch.wear_pressure_exponent", 0.5),
                ("punch.wear_velocity_exponent", 0.3),
                ("punch.width", 0.055),
                ("depth", 0.08),
            ];
            let mut driven = Driven::new(&changes)?;
            driven.set("normal_load", 3e3)?;
            driven.set("sliding_velocity", 4.0)?;
            driven.steps(1.0, 50)?;
            driven.get("wear_depth_punch")
        }),
        bound: 1e-12,
        reason: "the law integrates in closed form at constant inputs",
    });
}
