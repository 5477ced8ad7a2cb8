//! Front disc brake of a car: one stop, and the urban drive cycle.

use super::{DriveProblem, Setting, Truth, every};
use scene::Fidelity;
use scene::variables::changed;
use sliding_contact::component::Values;

const MASS: f64 = 1500.0;
/// Fraction of the braking force on one front brake.
const SHARE: f64 = 0.35;
const WHEEL_RADIUS: f64 = 0.31;
const MEAN_RADIUS: f64 = 0.1175;
const FRICTION: f64 = 0.4;
const FACES: f64 = 2.0;

/// With constant properties, as the peers have them.
fn scene() -> Result<Values, String> {
    let text = include_str!("../../../../examples/disc_brake/scene.toml");
    let constant = text.replace("property_table.material", "# property_table.material");
    Ok(scene_file::parse(&constant).map_err(|wrong| wrong.to_string())?.packaged.starts)
}

/// Load per face (N) of one front brake for the force (N) of all brakes at the wheels.
fn load(force: f64) -> f64 {
    SHARE * force * WHEEL_RADIUS / (FACES * FRICTION * MEAN_RADIUS)
}

fn setting(fidelity: Fidelity, cells: usize, tolerance: f64, step: f64) -> Setting {
    Setting { fidelity, tolerance, cells, step, order: 1, heat: true }
}

/// From 100 km/h to rest: the pedal is applied within `RAMP`, then the deceleration is constant.
pub(super) fn stop() -> Result<DriveProblem, String> {
    const RAMP: f64 = 0.2;
    let (speed, duration) = (100.0 / 3.6, 3.5);
    let deceleration = speed / (duration - 0.5 * RAMP);
    let pressed = load(MASS * deceleration);
    let ratio = MEAN_RADIUS / WHEEL_RADIUS;
    let changes = [("nominal.load", pressed), ("nominal.velocity", speed * ratio), ("nominal.duration", duration)];
    let inputs = move |time: f64| {
        // Zero velocity at the end, free of rounding.
        let lost = if time < RAMP { 0.5 * time * time / RAMP } else { time - 0.5 * RAMP };
        let left = if time < duration - 1e-9 { (speed - deceleration * lost).max(0.0) } else { 0.0 };
        [left * ratio, pressed * (time / RAMP).min(1.0)]
    };
    Ok(DriveProblem {
        name: "brake_stop",
        title: "Disc-brake stop: one front brake from 100 km/h to rest",
        data: "1,500 kg, 35 % of the braking, 8.2 m/s2 for 3.5 s; 95 x 55 mm pad; friction and wear follow the temperature",
        starts: changed(&scene()?, &changes)?,
        inputs: Box::new(inputs),
        step: 0.01,
        steps: vec![0.1, 0.05, 0.02, 0.01, 0.005],
        samples: every(0.1, duration),
        truth: Truth::Finest(vec![
            setting(Fidelity::Line, 129, 1e-4, 0.01),
            setting(Fidelity::Line, 65, 1e-4, 0.01),
            setting(Fidelity::Line, 17, 1e-4, 0.01),
        ]),
        reason: "what remains is the difference to a run of twice its cells",
        isothermal: false,
    })
}

/// Speed (m/s) of the Urban Dynamometer Driving Schedule at every second.
fn schedule() -> Result<Vec<f64>, String> {
    let rows = include_str!("../../../../examples/data/udds.csv").lines().skip(1);
    rows.map(|row| row.split_once(',').and_then(|(_, speed)| speed.trim().parse().ok()))
        .collect::<Option<_>>()
        .ok_or_else(|| "the drive cycle has a row without a speed".into())
}

/// Sliding velocity and load at every second: force of all brakes = -(m a + m g f + rho cd A v^2/2) where that is
/// positive, a by central differences, and 3 % of the weight while the car stands.
fn drive() -> Result<Vec<[f64; 2]>, String> {
    let speed = schedule()?;
    let last = speed.len() - 1;
    let weight = MASS * 9.806_65;
    let at_rest = |index: usize| speed[index.saturating_sub(1)] == 0.0 && speed[(index + 1).min(last)] == 0.0;
    Ok((0..=last)
        .map(|index| {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
            let acceleration = (speed[after] - speed[before]) / (after - before) as f64;
            let resistance = 0.012 * weight + 0.5 * 1.2 * 0.66 * speed[index].powi(2);
            let mut force = (-(MASS * acceleration + resistance)).max(0.0);
            if speed[index] == 0.0 && at_rest(index) {
                force = force.max(0.03 * weight);
            }
            [speed[index] * MEAN_RADIUS / WHEEL_RADIUS, load(force)]
        })
        .collect())
}

/// The whole Urban Dynamometer Driving Schedule.
pub(super) fn cycle() -> Result<DriveProblem, String> {
    let drive = drive()?;
    let duration = (drive.len() - 1) as f64;
    let inputs = move |time: f64| {
        let index = ((time + 1e-9) as usize).min(drive.len() - 2);
        let part = (time - index as f64).clamp(0.0, 1.0);
        std::array::from_fn(|input| drive[index][input] + part * (drive[index + 1][input] - drive[index][input]))
    };
    Ok(DriveProblem {
        name: "udds_brake",
        title: "UDDS brake: one front brake over the urban drive cycle",
        data: "1,369 s, the disc_brake example: 1,500 kg, 35 % of the braking; 95 x 55 mm pad; friction and wear follow the temperature",
        starts: scene()?,
        inputs: Box::new(inputs),
        step: 0.1,
        steps: vec![1.0, 0.5, 0.2, 0.1, 0.05],
        samples: every(37.0, duration),
        // The unreduced punch would take a quarter of an hour in steps that do not resolve the brake's transients.
        truth: Truth::Finest(vec![setting(Fidelity::Line, 65, 1e-4, 0.1), setting(Fidelity::Line, 33, 1e-4, 0.1)]),
        reason: "what remains is the difference to a run of twice its cells",
        isothermal: false,
    })
}
