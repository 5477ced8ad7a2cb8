//! extra/reference: inputs, the FMU's outputs for them, and the settings, to check an installation.
//!
//! The names and the form are those of the FMI cross check: `_in.csv`, `_ref.csv`, `_ref.opt`.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use fmu_host::{Interpolation, Schedule, Span, Worker};
use scene::slot::Packaged;
use scene::variables::find;
use scene_file::nominal;

use crate::archive::Files;
use crate::description::MODEL_IDENTIFIER;
use crate::xml::number;

const FOLDER: &str = "extra/reference";
const README: &str = include_str!("../../../modelDescription/reference.txt");

const INPUTS: [&str; 2] = ["sliding_velocity", "normal_load"];

/// Communication steps of the reference run.
const STEPS: usize = 200;

/// Digits of the outputs: enough to see an error, few enough to be the same whatever the mathematics library.
const DIGITS: usize = 8;

const OUTPUTS: [&str; 12] = [
    "wear_depth",
    "contact_temperature",
    "friction_force",
    "friction_torque",
    "friction_power",
    "contact_temperature_max",
    "pressure_mean",
    "wear_volume_punch",
    "wear_volume_strip",
    "sliding_distance",
    "dissipated_energy",
    "stored_heat",
];

/// Adds the reference files of a scene, whose model description is among the files. The library for this machine runs from `folder`,
/// which is made, with what a host reads of an FMU, and removed.
///
/// # Errors
/// Where the folder cannot be written, the scene not be initialised, or a step fails; the message is then the component's.
pub fn add(files: &mut Files, scene: &Packaged, library: Vec<u8>, folder: &Path) -> Result<()> {
    let own = crate::own_library();
    let written = [(crate::DESCRIPTION, &files[crate::DESCRIPTION]), (own.as_str(), &library)];
    let run = written.into_iter().try_for_each(|(name, bytes)| {
        let path = folder.join(name);
        let context = || format!("writing {}", path.display());
        fs::create_dir_all(path.parent().unwrap_or(folder)).with_context(context)?;
        fs::write(&path, bytes).with_context(context)
    });
    let result = run.and_then(|()| from_folder(files, scene, folder));
    // What is left of it is in a folder for what may be removed.
    let _ = fs::remove_dir_all(folder);
    result
}

/// [`STEPS`] steps of the scene's default experiment by the unpacked FMU in `folder`.
fn from_folder(files: &mut Files, scene: &Packaged, folder: &Path) -> Result<()> {
    let experiment = scene.experiment;
    let span = Span { start: experiment.start, stop: time(scene, STEPS), step: experiment.step };
    let times: Vec<f64> = (0..=STEPS).map(|index| span.time(index)).collect();
    let around = nominal::neighbours(|name| scene.starts[find(name).expect("a row of the variable table") as usize]);
    let names: Vec<&str> = INPUTS.into_iter().chain(around.iter().map(|(name, _)| *name)).collect();
    let ambient = || around.iter().map(|(_, ambient)| *ambient);
    let inputs: Vec<f64> = (0..=STEPS).flat_map(|index| inputs(index, scene).into_iter().chain(ambient())).collect();
    let run = fmu_host::Scene {
        parameters: &[],
        inputs: &names,
        factors: &[],
        schedule: Schedule::new(&times, &inputs, names.len())?,
        interpolation: Interpolation::Hold,
        span,
        tolerance: Some(experiment.tolerance),
        outputs: &OUTPUTS,
        points: &times,
    };
    let answers = Worker::open(folder).and_then(|mut worker| worker.run(&run)).context("the reference run")?;
    let mut given = format!("time,{}\n", names.join(","));
    let mut expected = format!("time,{}\n", OUTPUTS.join(","));
    let rows = inputs.chunks(names.len()).zip(answers.chunks(OUTPUTS.len()));
    for (index, (inputs, outputs)) in rows.enumerate() {
        let row = |values: Vec<String>| format!("{},{}\n", number(time(scene, index)), values.join(","));
        given += &row(inputs.iter().map(|&value| number(value)).collect());
        expected += &row(outputs.iter().map(|&value| number(short(value))).collect());
    }
    for (name, text) in [("in.csv", given), ("ref.csv", expected), ("ref.opt", settings(scene))] {
        files.insert(format!("{FOLDER}/{MODEL_IDENTIFIER}_{name}"), text.into_bytes());
    }
    files.insert(format!("{FOLDER}/README.txt"), README.into());
    Ok(())
}

/// The settings of the run, in the form of the FMI cross check.
fn settings(scene: &Packaged) -> String {
    let experiment = scene.experiment;
    format!(
        "StartTime,{}\nStopTime,{}\nStepSize,{}\nRelTol,{}\n",
        number(experiment.start),
        number(time(scene, STEPS)),
        number(experiment.step),
        number(experiment.tolerance)
    )
}

/// Velocity and load of one step.
///
/// The load rises to its nominal value over the first tenth of the run, stays, and falls to 0 over the last tenth. The
/// velocity is sinusoidal with the scene's stroke (reciprocating), or falls linearly from its nominal value to a half
/// (unidirectional).
fn inputs(index: usize, scene: &Packaged) -> [f64; 2] {
    let nominal = |name: &str| scene.starts[find(name).expect("a row of the variable table") as usize];
    let (velocity, stroke) = (nominal("nominal.velocity"), nominal("nominal.stroke"));
    let share = index as f64 / STEPS as f64;
    let shape = if stroke > 0.0 {
        // The mean speed of a stroke is 2/pi of the highest.
        let period = 2.0 * stroke / velocity;
        let phase = index as f64 * scene.experiment.step / period;
        0.5 * std::f64::consts::PI * (2.0 * std::f64::consts::PI * phase).cos()
    } else {
        1.0 - 0.5 * share
    };
    let load = nominal("nominal.load") * (10.0 * share).min(10.0 * (1.0 - share)).clamp(0.0, 1.0);
    [short(velocity * shape), short(load)]
}

/// Rounded to [`DIGITS`] significant digits, as it is written.
fn short(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Communication point, without the rounding of the sum.
fn time(scene: &Packaged, index: usize) -> f64 {
    let time = scene.experiment.start + index as f64 * scene.experiment.step;
    format!("{time:.11e}").parse().unwrap_or(time)
}

// What the scenes answer is tested on their packages: tests/fmpy/test_reference.py.
#[cfg(test)]
mod tests {
    use super::*;
    use scene_file::shipped;

    #[test]
    fn settings_are_those_of_the_experiment() {
        let scene = shipped::load(Some("pin_on_disk"), &crate::examples()).unwrap().packaged;
        assert_eq!(settings(&scene), "StartTime,0\nStopTime,2000\nStepSize,10\nRelTol,0.001\n");
    }

    #[test]
    fn the_load_comes_and_goes_and_the_velocity_follows_the_stroke() {
        for name in shipped::names(&crate::examples()) {
            let scene = shipped::load(Some(&name), &crate::examples()).unwrap().packaged;
            let nominal = |name: &str| scene.starts[find(name).unwrap() as usize];
            let rows: Vec<[f64; 2]> = (0..=STEPS).map(|index| inputs(index, &scene)).collect();
            assert_eq!([rows[0][1], rows[STEPS / 2][1], rows[STEPS][1]], [0.0, short(nominal("nominal.load")), 0.0]);
            let reverses = rows.iter().any(|row| row[0] < 0.0);
            assert_eq!(reverses, nominal("nominal.stroke") > 0.0, "{name}");
        }
    }
}
