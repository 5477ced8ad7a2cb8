//! A brake stop on the line level, and a pad above the speed at which short waves grow too.
//!
//! The lining lies on a disc that takes all heat, behind a layer of the conductance h_c. Below
//! `4 h_c/(mu alpha (1 + nu) E*)` = 10.1 m/s no wave grows; above, all do down to some length, and direct feedthrough of the
//! thermal distortion would make the problem ill-posed.

use test_support::{Application, Drive, scene};

const LOAD: f64 = 14e3;
const CONDUCTANCE: f64 = 20e3;
const FRICTION: f64 = 0.4;

fn brake(changes: &[(&str, f64)]) -> Drive {
    let fixed = [
        ("solver.fidelity", 3.0),
        ("nominal.load", 15e3),
        ("nominal.velocity", 5.0),
        ("nominal.duration", 4.0),
        ("solver.cells", 33.0),
    ];
    Drive::from_starts(&scene("disc_brake"), &[&fixed[..], changes].concat())
}

/// Lowest speed at the mean radius at which every long wave grows, m/s.
fn bound() -> f64 {
    let iron = (1.0 - 0.26_f64.powi(2)) / 1.1e11;
    let lining = (1.0 - 0.25_f64.powi(2)) / 1e9;
    4.0 * CONDUCTANCE * (iron + lining) / (FRICTION * 15e-6 * 1.25)
}

/// Applies the load in 0.2 s from the speed `speed` (m/s) on; temperature, largest pressure and worn depth after `steps` steps
/// of 10 ms, and the number of internal steps.
fn brakes(speed: f64, steps: u32, changes: &[(&str, f64)]) -> ([f64; 3], u64) {
    const STEP: f64 = 0.01;
    let mut drive = brake(changes);
    let deceleration = speed / 3.5;
    let load = |time: f64| LOAD * (time / 0.2).min(1.0);
    for step in 0..steps {
        let time = STEP * f64::from(step);
        drive.set("sliding_velocity", speed - deceleration * time).slope("sliding_velocity", -deceleration);
        drive.set("normal_load", load(time)).slope("normal_load", (load(time + STEP) - load(time)) / STEP);
        drive.step(STEP);
    }
    let carried = drive.get("pressure_mean") * drive.area();
    let expected = load(STEP * f64::from(steps));
    assert!((carried / expected - 1.0).abs() < 1e-9, "{carried} {expected}");
    assert!(drive.imbalance() < 1e-9, "{:e}", drive.imbalance());
    let (accepted, rejected) = drive.0.work();
    (["contact_temperature", "pressure_max", "wear_depth"].map(|name| drive.get(name)), accepted + rejected)
}

/// From 100 km/h the speed is 10.5 m/s: the pad gets hottest where friction falls with the temperature and short waves are near
/// growth.
#[test]
fn a_stop_passes_the_speed_at_which_short_waves_grow() {
    let speed = 100.0 / 3.6 * 0.1175 / 0.31;
    assert!(speed > 1.03 * bound() && 0.9 * speed < bound(), "{speed} {}", bound());
    let exact = brakes(speed, 20, &[("solver.tolerance", 1e-4)]).0;
    for (tolerance, cells, most) in [(1e-3, 33.0, 400), (1e-2, 33.0, 300), (1e-2, 17.0, 300)] {
        let (found, work) = brakes(speed, 20, &[("solver.tolerance", tolerance), ("solver.cells", cells)]);
        let rise = exact[0] - 293.15;
        assert!((found[0] - exact[0]).abs() < 5e-3 * rise, "{found:?} {exact:?}");
        assert!((found[2] / exact[2] - 1.0).abs() < 0.02, "{found:?} {exact:?}");
        assert!(work < most, "{work}");
    }
}

/// At twice that speed, with friction independent of temperature, the pad parts from the disc and slides on patches, as fast at a loose
/// tolerance as at a tight one.
#[test]
fn the_pad_parts_above_that_speed_and_not_below() {
    let plain = [("contact.friction_fade.factor[*]", 1.0), ("*.wear_coefficient", 0.0)];
    let [below, above, tight] = [(0.7, 1e-2), (2.0, 1e-2), (2.0, 1e-4)].map(|(ratio, tolerance)| {
        let mut drive = brake(&[&plain[..], &[("solver.tolerance", tolerance)]].concat());
        drive.set("normal_load", 500.0).set("sliding_velocity", ratio * bound());
        let mut least: f64 = 1.0;
        for _ in 0..300 {
            drive.step(0.01);
            least = least.min(drive.get("contact_fraction"));
        }
        let carried = drive.get("pressure_mean") * drive.area();
        assert!((carried / 500.0 - 1.0).abs() < 1e-9 && drive.imbalance() < 1e-9, "{carried} {:e}", drive.imbalance());
        let rise = drive.get("contact_temperature") - 293.15;
        assert!(drive.0.work().0 + drive.0.work().1 < 4000, "{:?}", drive.0.work());
        (least, rise)
    });
    assert!(below.0 > 0.9 && above.0 < 0.8, "{below:?} {above:?}");
    assert!((above.0 - tight.0).abs() < 0.06 && (above.1 / tight.1 - 1.0).abs() < 1e-2, "{above:?} {tight:?}");
}

/// A rigid pad of 24 mm that insulates slides over fresh steel at 11.6 m/s and stops: heat flows along columns of the strip alone, each
/// heated since it met the pad; conduction along the path is 4e-5 of the peak.
///
/// After heating by `q` for a time `a` the surface of a half-space is `2q/K sqrt(k_d/pi) (sqrt(a + r) - sqrt r)` warmer at `r` after its
/// end (Carslaw and Jaeger, 2.9).
#[test]
fn the_first_moments_of_an_endless_path_and_its_stop_are_those_of_columns() {
    let (width, depth, speed, load, friction) = (0.0241741, 0.01, 11.5721, 1004.25, 0.262319);
    let (conductivity, capacity): (f64, f64) = (50.0, 7800.0 * 460.0);
    let scale = 2.0 * friction * load / (width * depth) * speed / conductivity
        * (conductivity / capacity / std::f64::consts::PI).sqrt();
    // Means over the pad of sqrt(a + r) where a = min(t, x/v) at the distance x from its leading edge.
    let mean = |time: f64, rest: f64| {
        let met = (speed * time / width).min(1.0);
        let age = met * width / speed;
        let root = |t: f64| 2.0 / 3.0 * t.powf(1.5);
        (root(age + rest) - root(rest)) * speed / width + (1.0 - met) * (time + rest).sqrt() - rest.sqrt()
    };
    let own = [
        ("contact.friction_fade.factor[*]", 1.0),
        ("punch.conductivity", 0.0),
        ("*.thermal_expansion", 0.0),
        ("*.convection", 0.0),
        ("strip.emissivity", 0.0),
        ("holder.pivot_height", 0.0),
        ("contact.shear_coupling", 0.0),
        ("*.wear_coefficient", 0.0),
        ("punch.body", 1.0),
        ("contact.conductance", 1e12),
        ("solver.fidelity", 3.0),
        ("solver.cells", 33.0),
    ];
    let starts = Application::read("fading_pin").starts;
    let step = 2.10616e-4;
    let end = 200.0 * step;
    let peak = scale * mean(end, 0.0);
    for (tolerance, bound) in [(1e-2, 1e-4), (1e-3, 6e-5), (1e-4, 6e-5)] {
        let mut drive = Drive::from_starts(&starts, &[&own[..], &[("solver.tolerance", tolerance)]].concat());
        drive.set("normal_load", load).set("sliding_velocity", speed);
        let check = |drive: &mut Drive, exact: f64, what: &str| {
            let found = drive.get("contact_temperature") - 293.15;
            assert!((found - exact).abs() < bound * peak, "{tolerance:e} {what}: {found} and {exact} of {peak} K");
        };
        for number in 1..=200 {
            drive.step(step);
            if [1, 2, 5, 10, 20, 200].contains(&number) {
                check(&mut drive, scale * mean(f64::from(number) * step, 0.0), &format!("step {number}"));
            }
        }
        drive.set("sliding_velocity", 0.0);
        for number in 1..=3 {
            drive.step(step);
            check(&mut drive, scale * mean(end, f64::from(number) * step), &format!("{number} after the stop"));
        }
    }
}
