//! Cooling of hot bodies in one communication step against a closed form and an independent finite-volume solution.

use super::{LEVELS, temperatures};
use test_support::{CONVECTING, Drive, INSULATED, LINE};

const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// A punch of 60 x 100 x 10 mm and nearly one temperature, beside a strip that keeps its heat; neither gives heat to the air.
const BLOCK: [(&str, f64); 13] = [
    ("punch.width", 0.06),
    ("punch.height", 0.1),
    ("depth", 0.01),
    ("punch.conductivity", 1e4),
    ("punch.density", 7800.0),
    ("punch.specific_heat", 460.0),
    ("punch.convection", 0.0),
    ("punch.top_thermal", INSULATED),
    ("punch.initial_at_ambient", 0.0),
    ("strip.convection", 0.0),
    ("strip.base_thermal", INSULATED),
    ("ambient_temperature", 300.0),
    ("nominal.duration", 1e4),
];

/// Heat capacity of the block, J/K.
const CAPACITY: f64 = 7800.0 * 460.0 * 0.06 * 0.1 * 0.01;

/// Temperature of a body that starts at `start` and radiates to surroundings at `around`, K, after `time`: the root T, by bisection, of
/// `2 c Ta^3 t = F(T) - F(T0)`, `F(T) = ln((T + Ta)/(T - Ta))/2 + atan(T/Ta)`, where `dT/dt = -c (T^4 - Ta^4)`.
fn radiated(start: f64, around: f64, per_capacity: f64, time: f64) -> f64 {
    let spent = |t: f64| {
        let primitive = |t: f64| ((t + around) / (t - around)).ln() / 2.0 + (t / around).atan();
        (primitive(t) - primitive(start)) / (2.0 * around.powi(3) * per_capacity * STEFAN_BOLTZMANN)
    };
    let (mut low, mut high) = (around, start);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if spent(middle) > time { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

#[test]
fn a_body_of_one_temperature_radiates_as_the_closed_form_says() {
    // The sides along x radiate, 2 x 100 x 10 mm.
    let (emissivity, start, ambient) = (0.8, 900.0, 300.0);
    let per_capacity = emissivity * 2.0 * 0.1 * 0.01 / CAPACITY;
    for (level, changes) in LEVELS {
        for tolerance in [1e-2, 1e-3, 1e-4] {
            for time in [60.0, 600.0, 3600.0, 4e4] {
                let scene = [
                    ("punch.emissivity", emissivity),
                    ("punch.initial_temperature", start),
                    ("solver.tolerance", tolerance),
                ];
                let mut drive = Drive::stock(&[&BLOCK[..], &scene, changes].concat());
                drive.step(time);
                let [punch, strip, _] = temperatures(&mut drive);
                let exact = radiated(start, ambient, per_capacity, time);
                let error = (punch - exact).abs() / (start - ambient);
                assert!(error < tolerance.max(3e-4), "{level}, {tolerance}, {time} s: {punch} K for {exact} K");
                assert!((strip - ambient).abs() < 1e-6, "{level}: {strip}");
            }
        }
    }
}

/// Solves the equations with this `diagonal` and `-link` beside it; `t` is the right side, then the solution.
fn eliminate<const CELLS: usize>(mut diagonal: [f64; CELLS], link: f64, t: &mut [f64; CELLS]) {
    for i in 1..CELLS {
        let factor = -link / diagonal[i - 1];
        diagonal[i] += factor * link;
        t[i] -= factor * t[i - 1];
    }
    t[CELLS - 1] /= diagonal[CELLS - 1];
    for i in (0..CELLS - 1).rev() {
        t[i] = (t[i] + link * t[i + 1]) / diagonal[i];
    }
}

/// Mean temperature (K) of a slab of `height` that radiates from both faces and gives heat to air whose speed rises from 0 to
/// `fastest`, after `time`, by finite volumes and implicit steps: both faces with these emissivities and forced coefficients.
fn slab(
    start: f64,
    ambient: f64,
    [k, capacity, height]: [f64; 3],
    faces: [[f64; 2]; 2],
    fastest: f64,
    time: f64,
) -> f64 {
    const CELLS: usize = 40;
    const STEPS: usize = 20_000;
    let (dx, dt) = (height / CELLS as f64, time / STEPS as f64);
    let mut t = [start; CELLS];
    let link = k * dt / (capacity * dx * dx);
    for step in 0..STEPS {
        let speed = fastest * (step as f64 + 0.5) / STEPS as f64;
        let mut diagonal = [1.0 + 2.0 * link; CELLS];
        for (cell, [emissivity, forced]) in [0, CELLS - 1].into_iter().zip(faces) {
            let surface = t[cell];
            let transfer = forced * speed.powf(0.8)
                + emissivity * STEFAN_BOLTZMANN * (surface * surface + ambient * ambient) * (surface + ambient);
            let through = 1.0 / (1.0 / transfer + 0.5 * dx / k) * dt / (capacity * dx);
            diagonal[cell] += through - link;
            t[cell] += through * ambient;
        }
        eliminate(diagonal, link, &mut t);
    }
    t.iter().sum::<f64>() / CELLS as f64
}

#[test]
fn a_slab_in_a_rising_wind_cools_as_finite_volumes_do() {
    // A disc of 20 mm under a pad of a thousandth of its length, whose load is 0.
    let (start, ambient, fastest) = (800.0, 300.0, 30.0);
    for (level, changes) in LEVELS {
        for time in [30.0, 300.0, 1800.0] {
            let scene = [
                ("punch.width", 0.001),
                ("strip.path", 2.0),
                ("strip.length", 1.0),
                ("strip.height", 0.02),
                ("strip.conductivity", 20.0),
                ("strip.density", 7200.0),
                ("strip.specific_heat", 500.0),
                ("strip.convection", 0.0),
                ("strip.convection_forced", 40.0),
                ("strip.emissivity", 0.7),
                ("strip.base_thermal", CONVECTING),
                ("strip.initial_at_ambient", 0.0),
                ("strip.initial_temperature", start),
                ("ambient_temperature", ambient),
                ("nominal.duration", 1e3),
                ("solver.tolerance", 1e-3),
            ];
            let mut drive = Drive::stock(&[&scene[..], changes].concat());
            drive.slope("cooling_velocity", fastest / time).step(time);
            let [_, strip, _] = temperatures(&mut drive);
            let faces = [[0.7 * 0.999, 40.0 * 0.999], [0.7, 40.0]];
            let exact = slab(start, ambient, [20.0, 7200.0 * 500.0, 0.02], faces, fastest, time);
            let error = (strip - exact).abs() / (start - ambient);
            assert!(error < 2e-3, "{level}, {time} s: {strip} K for {exact} K");
        }
    }
}

#[test]
fn a_heat_path_cools_a_stack_as_its_closed_form_says() {
    // A block of nearly one temperature behind a conductance: T - Tn falls as exp(-G t/C), however large G t/C is.
    for (level, changes) in LEVELS {
        for number in [0.01, 0.3, 3.0, 30.0, 3e4] {
            let time = 1000.0;
            let scene = [
                ("punch.external_conductance", number * CAPACITY / time),
                ("punch.external_temperature", 350.0),
                ("contact.faces", 1.0),
                ("punch.initial_temperature", 800.0),
                ("solver.tolerance", 1e-3),
            ];
            let mut drive = Drive::stock(&[&BLOCK[..], &scene, changes].concat());
            drive.step(time);
            let [punch, ..] = temperatures(&mut drive);
            // In series with a third of the block's own resistance.
            let inside = 0.1 / (3.0 * 1e4 * 0.06 * 0.01);
            let rate = 1.0 / (CAPACITY * (time / (number * CAPACITY) + inside));
            let exact = 350.0 + 450.0 * (-rate * time).exp();
            let error = (punch - exact).abs() / 450.0;
            assert!(error < 2e-3, "{level}, {number}: {punch} K for {exact} K");
            let gone = drive.get("heat_lost_punch_external");
            assert!((gone / (CAPACITY * (800.0 - punch)) - 1.0).abs() < 1e-3, "{level}, {number}: {gone} J");
        }
    }
}

/// The levels, and the line with the mean heat of the lumped level.
fn levels_and_mean_heat() -> impl Iterator<Item = (&'static str, &'static [(&'static str, f64)])> {
    let mean = ("mean heat", &[("solver.fidelity", LINE), ("solver.cells", 9.0), ("solver.heat", 2.0)][..]);
    LEVELS.into_iter().chain([mean])
}

#[test]
fn wear_of_a_cooling_block_is_that_of_its_closed_form() {
    // Half of the rise of the block, which falls as exp(-t/tau), stands in the contact. Wear rises from 1 to 5 times over it:
    // k p v (t + 4 tau (1 - exp(-t/tau))).
    let (time, start, around) = (1000.0, 800.0, 300.0);
    let names = ["temperature", "factor"].map(|what| (1..=8).map(move |k| format!("punch.wear_fade.{what}[{k}]")));
    let rows = names.map(Iterator::collect::<Vec<_>>);
    let part = |k: usize| k as f64 / 7.0;
    let temperatures = rows[0].iter().enumerate().map(|(k, row)| (&row[..], around + 0.5 * (start - around) * part(k)));
    let factors = rows[1].iter().enumerate().map(|(k, row)| (&row[..], 1.0 + 4.0 * part(k)));
    let table: Vec<(&str, f64)> = temperatures.chain(factors).collect();
    for (level, changes) in levels_and_mean_heat() {
        for number in [0.5, 5.0, 50.0] {
            let scene = [
                ("punch.external_conductance", number * CAPACITY / time),
                ("punch.external_temperature", around),
                ("contact.faces", 1.0),
                ("contact.friction_coefficient", 1e-9),
                ("contact.conductance", 0.0),
                ("punch.initial_temperature", start),
                ("punch.wear_coefficient", 1e-15),
                ("strip.wear_coefficient", 0.0),
                ("solver.tolerance", 1e-3),
            ];
            let mut drive = Drive::stock(&[&BLOCK[..], &scene, &table, changes].concat());
            drive.set("normal_load", 600.0).set("sliding_velocity", 1.0).step(time);
            let tau = CAPACITY * (time / (number * CAPACITY) + 0.1 / (3.0 * 1e4 * 0.06 * 0.01));
            let exact = 1e-15 * 600.0 / (0.06 * 0.01) * (time + 4.0 * tau * (1.0 - (-time / tau).exp()));
            let error = drive.get("wear_depth") / exact - 1.0;
            println!("{level}, {number}: {error:.1e}");
            assert!(error.abs() < 5e-3, "{level}, {number}: {} m for {exact} m", drive.get("wear_depth"));
        }
    }
}

#[test]
fn a_caliper_on_an_expanding_block_heats_as_its_closed_form_says() {
    // The load F + k a T of a caliper of stiffness k on columns that expand by a = alpha (1 + nu) h heats it:
    // C T = mu v F (exp(r t) - 1)/r, r = mu v k a/C.
    let (time, load, alpha, friction, speed) = (1000.0, 500.0, 1e-5, 0.3, 0.1);
    for (level, changes) in levels_and_mean_heat() {
        for growth in [0.3, 1.0, 2.0] {
            let expansion = alpha * 1.3 * 0.1;
            let stiffness = growth / time * CAPACITY / (friction * speed * expansion);
            let scene = [
                ("punch.initial_at_ambient", 1.0),
                ("punch.body", 2.0),
                ("punch.foundation_stiffness", 1e15),
                ("strip.body", 1.0),
                ("punch.poissons_ratio", 0.3),
                ("strip.conductivity", 0.0),
                ("contact.faces", 1.0),
                ("contact.friction_coefficient", friction),
                ("contact.stick_stiffness", 0.0),
                ("holder.stiffness", stiffness),
                ("punch.wear_coefficient", 0.0),
                ("strip.wear_coefficient", 0.0),
                ("solver.tolerance", 1e-3),
            ];
            let expands = [("punch.thermal_expansion", alpha), ("strip.thermal_expansion", 0.0)];
            let mut drive = Drive::stock(&[&BLOCK[..], &scene, changes, &expands].concat());
            drive.set("normal_load", load).set("sliding_velocity", speed).step(time);
            let rate = growth / time;
            let exact = friction * speed * load * (growth.exp() - 1.0) / rate;
            let error = drive.get("dissipated_energy") / exact - 1.0;
            println!("{level}, {growth}: {error:.1e}");
            assert!(error.abs() < 5e-3, "{level}, {growth}: {} J for {exact} J", drive.get("dissipated_energy"));
        }
    }
}

#[test]
fn a_caliper_on_a_wearing_block_lets_go_as_its_closed_form_says() {
    // The load F - c w falls as exp(-t/tau) with the wear, tau = A/(c k v): w = F (1 - exp(-t/tau))/c.
    let (time, load, stiffness) = (1000.0, 500.0, 1e6);
    for (level, changes) in levels_and_mean_heat() {
        for number in [0.3, 1.0, 3.0, 10.0] {
            let scene = [
                ("punch.initial_at_ambient", 1.0),
                ("punch.body", 2.0),
                ("punch.foundation_stiffness", 1e15),
                ("strip.body", 1.0),
                ("contact.faces", 1.0),
                ("contact.friction_coefficient", 1e-9),
                ("contact.stick_stiffness", 0.0),
                ("holder.stiffness", stiffness),
                ("punch.wear_coefficient", number / time * (0.06 * 0.01) / stiffness),
                ("strip.wear_coefficient", 0.0),
                ("solver.tolerance", 1e-3),
            ];
            let mut drive = Drive::stock(&[&BLOCK[..], &scene, changes].concat());
            drive.set("normal_load", load).set("sliding_velocity", 1.0).step(time);
            let exact = load / stiffness * (1.0 - (-number).exp());
            let error = drive.get("wear_depth") / exact - 1.0;
            println!("{level}, {number}: {error:.1e}");
            assert!(error.abs() < 1e-3, "{level}, {number}: {} m for {exact} m", drive.get("wear_depth"));
        }
    }
}

/// Temperature of the heated face, mean temperature (K) and heat given to the neighbour (J/m2) of a slab of `height` from `start` on,
/// under a flux `heat` into one face and with the transfer coefficient `through` to `neighbour` at the other: finite volumes, implicit.
fn slab_with_path(
    [start, neighbour]: [f64; 2],
    [k, capacity, height]: [f64; 3],
    [heat, through]: [f64; 2],
    time: f64,
) -> [f64; 3] {
    const CELLS: usize = 200;
    const STEPS: usize = 20_000;
    let (dx, dt) = (height / CELLS as f64, time / STEPS as f64);
    let (link, enters) = (k * dt / (capacity * dx * dx), dt / (capacity * dx));
    let out = 1.0 / (1.0 / through + 0.5 * dx / k);
    let (mut t, mut given) = ([start; CELLS], 0.0);
    for _ in 0..STEPS {
        let mut diagonal = [1.0 + 2.0 * link; CELLS];
        diagonal[0] -= link;
        diagonal[CELLS - 1] += out * enters - link;
        t[0] += heat * enters;
        t[CELLS - 1] += out * enters * neighbour;
        eliminate(diagonal, link, &mut t);
        given += out * (t[CELLS - 1] - neighbour) * dt;
    }
    [t[0] + heat * 0.5 * dx / k, t.iter().sum::<f64>() / CELLS as f64, given]
}

/// A pad of 800 K without load, its top beside a neighbour of 293 K through 1 and 1,000 W/K, where the pad itself limits the flow.
#[test]
fn a_hot_pad_without_load_cools_through_its_heat_path_as_finite_volumes_say() {
    let (k, capacity, height, area) = (2.0, 2500.0 * 1000.0, 0.012, 0.06 * 0.05);
    for (level, changes) in LEVELS {
        for (time, conductance) in [1.0, 10.0, 100.0].into_iter().flat_map(|time| [(time, 1.0), (time, 1e3)]) {
            let scene = [
                ("punch.width", 0.06),
                ("depth", 0.05),
                ("punch.height", height),
                ("punch.conductivity", k),
                ("punch.density", 2500.0),
                ("punch.specific_heat", 1000.0),
                ("punch.convection", 0.0),
                ("punch.convection_forced", 0.0),
                ("punch.emissivity", 0.0),
                ("punch.count", 1.0),
                ("contact.faces", 1.0),
                ("punch.top_thermal", INSULATED),
                ("punch.external_conductance", conductance),
                ("punch.external_temperature", 293.15),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", 800.0),
                ("solver.tolerance", 1e-3),
            ];
            let mut drive = Drive::stock(&[&scene[..], changes].concat());
            drive.step(time);
            let [punch, ..] = temperatures(&mut drive);
            let through = [0.0, conductance / area];
            let [_, exact, _] = slab_with_path([800.0, 293.15], [k, capacity, height], through, time);
            let text = format!("{level}, {conductance} W/K, {time} s: {punch} K for {exact} K");
            assert!((punch - exact).abs() < 4e-3 * (800.0 - 293.15), "{text}");
        }
    }
}

#[test]
fn a_heat_path_of_the_strip_acts_as_finite_volumes_say() {
    // A ring that slides on its whole path heats the strip evenly; its base has a path to a neighbour that is hotter.
    let (start, neighbour, height, depth, load) = (300.0, 400.0, 0.02, 0.05, 2e3);
    let (k, capacity, area) = (20.0, 7200.0 * 500.0, 2.0 * std::f64::consts::PI * 0.1175 * depth);
    let heat = 0.3 * load / area;
    for (level, changes) in LEVELS {
        for biot in [0.1, 1.0, 10.0, 1e3] {
            for time in [0.1, 1.0, 10.0, 100.0, 1000.0] {
                let scene = [
                    ("contact.geometry", 3.0),
                    ("contact.faces", 1.0),
                    ("contact.friction_coefficient", 0.3),
                    ("contact.stick_stiffness", 0.0),
                    ("contact.conductance", 1e7),
                    ("punch.width", area / depth),
                    ("depth", depth),
                    ("punch.conductivity", 0.0),
                    ("punch.wear_coefficient", 0.0),
                    ("strip.wear_coefficient", 0.0),
                    ("strip.height", height),
                    ("strip.conductivity", k),
                    ("strip.density", 7200.0),
                    ("strip.specific_heat", 500.0),
                    ("strip.convection", 0.0),
                    ("strip.convection_forced", 0.0),
                    ("strip.base_thermal", INSULATED),
                    ("strip.external_conductance", biot * k / height * area),
                    ("strip.external_temperature", neighbour),
                    ("ambient_temperature", start),
                    ("nominal.duration", 1e3),
                    ("solver.tolerance", 1e-3),
                ];
                let flat = [("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)];
                let mut drive = Drive::stock(&[&scene[..], changes, &flat].concat());
                drive.set("normal_load", load).set("sliding_velocity", 1.0);
                drive.step(time);
                let through = [heat, biot * k / height];
                let exact = slab_with_path([start, neighbour], [k, capacity, height], through, time);
                let found = ["contact_temperature", "strip.mean_temperature", "heat_lost_strip_external"];
                let found = found.map(|name| drive.get(name));
                let heat_scale = capacity * height * (neighbour - start);
                let errors = [
                    (found[0] - exact[0]) / (neighbour - start),
                    (found[1] - exact[1]) / (neighbour - start),
                    (found[2] / area - exact[2]) / heat_scale,
                ];
                println!("{level}, {biot}, {time} s: {errors:?}");
                // The layer at the base that the states do not resolve fills later.
                let bounds = if time > 1.0 { [1e-3; 3] } else { [1e-3, 8e-3, 8e-3] };
                for (error, bound) in errors.iter().zip(bounds) {
                    assert!(error.abs() < bound, "{level}, {biot}, {time} s: {found:?} {exact:?}");
                }
            }
        }
    }
}

#[test]
fn sides_in_fast_air_cool_a_pad_as_the_series_says() {
    // Mean of a plate that cools from both sides (Carslaw and Jaeger, section 3.11): its waves shorter than those with states hold heat.
    let (width, k, capacity) = (0.095, 1.5, 2500.0 * 1000.0);
    let (start, ambient) = (800.0, 300.0);
    let (_, line) = LEVELS[1];
    for transfer in [100.0, 1e3, 1e4] {
        let biot = transfer * 0.5 * width / k;
        let exact = |time: f64| -> f64 {
            let term = |n: i32| {
                let (mut low, mut high) = (0.0, 0.5 * std::f64::consts::PI);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let root = f64::from(n) * std::f64::consts::PI + middle;
                    if root * middle.tan() < biot { low = middle } else { high = middle }
                }
                let root = f64::from(n) * std::f64::consts::PI + low;
                let part = 2.0 * low.sin().powi(2) / (root * (root + low.sin() * low.cos()));
                part * (-root * root * k / capacity * time / (0.25 * width * width)).exp()
            };
            (0..4000).map(term).sum()
        };
        for tolerance in [1e-2, 1e-3] {
            let scene = [
                ("punch.width", width),
                ("punch.height", 0.012),
                ("punch.conductivity", k),
                ("punch.density", 2500.0),
                ("punch.specific_heat", 1000.0),
                ("punch.convection", transfer),
                ("punch.convection_forced", 0.0),
                ("punch.top_thermal", INSULATED),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", start),
                ("contact.conductance", 0.0),
                ("ambient_temperature", ambient),
                ("solver.tolerance", tolerance),
            ];
            let mut drive = Drive::stock(&[&scene[..], line].concat());
            let mut now = 0.0;
            for step in [1e-6, 0.01, 0.1, 1.0, 10.0, 100.0] {
                drive.step(step);
                now += step;
                let [punch, ..] = temperatures(&mut drive);
                let error = (punch - ambient) / (start - ambient) - exact(now);
                println!("{transfer} W/(m2 K), {tolerance}, {now} s: {error:.1e}");
                assert!(error.abs() < 0.2 * tolerance, "{transfer}, {tolerance}, {now} s: {punch} K, off by {error}");
            }
        }
    }
}
