//! extra/reference: inputs, the FMU's outputs for them, and the settings, to check an installation.
//!
//! The names and the form are those of the FMI cross check: `_in.csv`, `_ref.csv`, `_ref.opt`.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use scene::slot::Packaged;
use scene::variables::{ValueReference, find, reference};
use sliding_contact::component::Component;

use super::archive::Files;
use super::description::MODEL_IDENTIFIER;
use super::xml::number;

const FOLDER: &str = "extra/reference";
const README: &str = include_str!("../../../modelDescription/reference.txt");

const VELOCITY: ValueReference = reference("sliding_velocity");
const LOAD: ValueReference = reference("normal_load");

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

/// Adds the reference files of a scene: [`STEPS`] steps of its default experiment.
///
/// # Errors
/// Where the scene cannot be initialised or a step fails; the message is the component's.
pub fn add(files: &mut Files, scene: &Packaged) -> Result<()> {
    let experiment = scene.experiment;
    let inputs: Vec<Inputs> = (0..=STEPS).map(|index| Inputs::at(index, scene)).collect();
    let mut given = String::from("time,sliding_velocity,normal_load\n");
    let mut expected = format!("time,{}\n", OUTPUTS.join(","));
    let references: Vec<ValueReference> =
        OUTPUTS.map(|name| find(name).expect("an output of the variable table")).to_vec();
    let mut component = Component::new(Arc::new(scene.starts));
    component.enter_initialization();
    inputs[0].set(&mut component);
    component.initialise(Some(experiment.tolerance)).map_err(|reason| anyhow!(reason)).context("the reference run")?;
    for (index, inputs) in inputs.iter().enumerate() {
        let time = rounded(experiment.start + index as f64 * experiment.step);
        given += &format!("{},{},{}\n", number(time), number(inputs.velocity), number(inputs.load));
        let outputs: Vec<String> =
            references.iter().map(|&reference| number(short(component.get(reference)))).collect();
        expected += &format!("{},{}\n", number(time), outputs.join(","));
        if index < STEPS {
            inputs.set(&mut component);
            component
                .step(experiment.step)
                .map_err(|reason| anyhow!(reason))
                .with_context(|| format!("the reference run at {time} s"))?;
        }
    }
    let settings = format!(
        "StartTime,{}\nStopTime,{}\nStepSize,{}\nRelTol,{}\n",
        number(experiment.start),
        number(rounded(experiment.start + STEPS as f64 * experiment.step)),
        number(experiment.step),
        number(experiment.tolerance)
    );
    for (name, text) in [("in.csv", given), ("ref.csv", expected), ("ref.opt", settings)] {
        files.insert(format!("{FOLDER}/{MODEL_IDENTIFIER}_{name}"), text.into_bytes());
    }
    files.insert(format!("{FOLDER}/README.txt"), README.into());
    Ok(())
}

/// Inputs of one step.
struct Inputs {
    velocity: f64,
    load: f64,
}

impl Inputs {
    /// The load rises to its nominal value over the first tenth of the run, stays, and falls to 0 over the last
    /// tenth. The velocity is sinusoidal with the scene's stroke (reciprocating), or falls linearly from its nominal value to
    /// a half (unidirectional).
    fn at(index: usize, scene: &Packaged) -> Inputs {
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
        Inputs { velocity: short(velocity * shape), load: short(load) }
    }

    fn set(&self, component: &mut Component) {
        component.set_input(VELOCITY, self.velocity);
        component.set_input(LOAD, self.load);
    }
}

/// Rounded to [`DIGITS`] significant digits, as it is written.
fn short(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Times without the rounding of their sum.
fn rounded(time: f64) -> f64 {
    format!("{time:.11e}").parse().unwrap_or(time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    fn table(files: &Files, name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
        let text = std::str::from_utf8(&files[&format!("{FOLDER}/SlidingContact_{name}")]).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        (names, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
    }

    #[test]
    fn every_scene_runs_slides_heats_wears_and_keeps_its_books() {
        for name in scenes::names().iter().map(|name| Some(name.as_str())).chain([None]) {
            let scene = scenes::load(name).unwrap().packaged;
            let mut files = Files::new();
            add(&mut files, &scene).unwrap();
            let (given, inputs) = table(&files, "in.csv");
            let (names, outputs) = table(&files, "ref.csv");
            assert_eq!(given, ["time", "sliding_velocity", "normal_load"]);
            assert_eq!((inputs.len(), outputs.len()), (STEPS + 1, STEPS + 1));
            let column = |wanted: &str| names.iter().position(|name| name == wanted).unwrap();
            let end = |wanted: &str| outputs[STEPS][column(wanted)];
            assert!(end("wear_volume_punch") > 0.0 && end("dissipated_energy") > 0.0, "{}", scene.name);
            assert!(outputs.iter().all(|row| row.iter().all(|value| value.is_finite())));
            let value = |name: &str| scene.starts[find(name).unwrap() as usize];
            // The inputs are held over a step, so the distance is their sum to the digits written, less what a
            // bristle gives way before it slides.
            let bristle = match value("contact.stick_stiffness") {
                0.0 => 0.0,
                stiffness => {
                    let limit = value("contact.friction_coefficient") * value("contact.static_friction_ratio");
                    limit * value("nominal.load") * value("contact.faces") / stiffness
                }
            };
            let distance: f64 = inputs[..STEPS].iter().map(|row| row[1].abs() * scene.experiment.step).sum();
            let slack = bristle + 1e-6 * distance;
            assert!((end("sliding_distance") - distance).abs() < slack, "{}", scene.name);
            // Archard's volume where nothing fades: exponents are 1 and mu is at its reference.
            let expected: f64 = inputs[..STEPS].iter().map(|row| row[1].abs() * row[2]).sum::<f64>()
                * scene.experiment.step
                * value("punch.wear_coefficient")
                * value("contact.faces");
            let ratio = end("wear_volume_punch") / expected;
            assert!((0.95..1.5).contains(&ratio), "{}: {ratio} of Archard's volume", scene.name);
        }
    }

    #[test]
    fn settings_are_those_of_the_experiment() {
        let scene = scenes::load(Some("pin_on_disk")).unwrap().packaged;
        let mut files = Files::new();
        add(&mut files, &scene).unwrap();
        let settings = String::from_utf8(files[&format!("{FOLDER}/SlidingContact_ref.opt")].clone()).unwrap();
        assert_eq!(settings, "StartTime,0\nStopTime,2000\nStepSize,10\nRelTol,0.001\n");
    }
}
