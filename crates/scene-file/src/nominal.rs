//! Nominal inputs: what a scene is driven by where nobody says otherwise.

use anyhow::{Result, bail};
use scene::ThermalBoundary;
use std::f64::consts::PI;

/// Communication steps in a cycle of a reciprocating scene at least.
const STEPS_IN_CYCLE: f64 = 60.0;

/// Communication points at most: all of them are held in memory.
pub const MOST_POINTS: f64 = 2e6;

/// The names of the inputs, in the order of the columns of [`Inputs::values`].
pub const NAMES: [&str; 3] = ["normal_load", "angular_velocity", "sliding_velocity"];

/// External temperatures that act and that the scene does not give, with the ambient temperature, K: nominally neighbours have it.
pub fn neighbours(value: impl Fn(&str) -> f64) -> Vec<(&'static str, f64)> {
    let bodies = [
        ("punch.external_temperature", "punch.external_conductance", "punch.top_thermal"),
        ("strip.external_temperature", "strip.external_conductance", "strip.base_thermal"),
    ];
    let acts = |conductance, face| {
        value(conductance) > 0.0 || ThermalBoundary::from_item(value(face)) == ThermalBoundary::External
    };
    let missing = bodies.into_iter().filter(|(name, conductance, face)| acts(conductance, face) && value(name) == 0.0);
    missing.map(|(name, ..)| (name, value("ambient_temperature"))).collect()
}

/// A message about an external temperature that neither inputs nor scene give, with what gives it.
pub fn with_remedy(message: String) -> String {
    let body =
        ["punch", "strip"].into_iter().find(|body| message.contains(&format!("{body}.external_temperature = 0 K ")));
    let Some(body) = body else { return message };
    format!("{message}; give it in a column of the inputs, or set {body}.external_temperature=\"20 degC\"")
}

/// Nominal conditions of a scene.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conditions {
    /// `nominal.load`, N.
    pub load: f64,
    /// `nominal.velocity`, m/s.
    pub velocity: f64,
    /// `nominal.duration`, s.
    pub duration: f64,
    /// `nominal.stroke`, m; 0 for unidirectional sliding.
    pub stroke: f64,
}

/// Inputs over time, linear between the times.
#[derive(Clone, PartialEq, Debug)]
pub struct Inputs {
    /// Their description.
    pub description: String,
    /// Times, strictly increasing, s.
    pub times: Vec<f64>,
    /// Values of the inputs of [`NAMES`] at the times, in SI units.
    pub values: [Vec<f64>; 3],
    /// Longest communication step, s.
    pub step: f64,
}

impl Conditions {
    /// Nominal load and velocity for the nominal duration; of a reciprocating scene the cosine whose mean speed is the nominal
    /// one, over the nominal stroke. `step`: that of the scene's experiment, s, or one that was asked.
    ///
    /// # Errors
    /// A duration that is no time; a cycle too short for the duration.
    pub fn inputs(&self, step: f64) -> Result<Inputs> {
        let Self { load, velocity, duration, stroke } = *self;
        if duration.is_nan() || duration <= 0.0 {
            bail!("nominal.duration = {duration} s is the time that is simulated without inputs; it must be above 0 s");
        }
        let inputs = |description: String, times: Vec<f64>, speeds: Vec<f64>, step: f64| {
            let values = [vec![load; times.len()], vec![0.0; times.len()], speeds];
            Inputs { description, times, values, step }
        };
        if stroke == 0.0 || velocity == 0.0 {
            let description = format!("nominal: {load} N and {velocity} m/s for {duration} s");
            return Ok(inputs(description, vec![0.0, duration], vec![velocity; 2], step.min(duration)));
        }
        let period = 2.0 * stroke / velocity;
        let step = step.min(period / STEPS_IN_CYCLE);
        let count = (duration / step).ceil();
        if count > MOST_POINTS {
            bail!(
                "{:.0} cycles of {period} s in nominal.duration = {duration} s need {count:.0} communication steps, and at most \
                 {MOST_POINTS:e} are kept; set a shorter nominal.duration, or jump over cycles with `cargo fmu cycles`",
                duration / period
            );
        }
        let times: Vec<f64> = (0..=count as usize).map(|point| duration * point as f64 / count).collect();
        let speeds = times.iter().map(|time| 0.5 * PI * velocity * (2.0 * PI * time / period).cos()).collect();
        let description =
            format!("nominal: {load} N, strokes of {stroke} m at {velocity} m/s in the mean for {duration} s");
        Ok(inputs(description, times, speeds, step))
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `step`, so that the communication points are round numbers.
pub(crate) fn round(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    [5.0, 2.0].into_iter().map(|digit| digit * power).find(|rounded| *rounded <= step).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_steps_are_round() {
        for (step, rounded) in [(0.006, 0.005), (1.37, 1.0), (0.02, 0.02), (4.99e-6, 2e-6)] {
            assert!((round(step) / rounded - 1.0).abs() < 1e-12, "{step}: {}", round(step));
        }
    }

    #[test]
    fn nominal_strokes_are_the_nominal_distance_long() {
        let conditions = Conditions { load: 100.0, velocity: 0.4, duration: 0.05, stroke: 0.04 };
        let quarter = conditions.inputs(1e-4).unwrap();
        let speeds = &quarter.values[2];
        let distance: f64 = (1..speeds.len())
            .map(|end| 0.5 * (speeds[end] + speeds[end - 1]) * (quarter.times[end] - quarter.times[end - 1]))
            .sum();
        assert!((distance / (0.5 * conditions.stroke) - 1.0).abs() < 1e-3, "{distance}");
        let told = Conditions { duration: 1e9, ..conditions }.inputs(1e-4).unwrap_err().to_string();
        assert!(told.contains("cargo fmu cycles"), "{told}");
        for duration in [0.0, -1.0, f64::NAN] {
            assert!(Conditions { duration, ..conditions }.inputs(1e-4).is_err());
        }
    }

    #[test]
    fn neighbours_without_a_temperature_are_at_ambient() {
        let scene = |own: &'static [(&str, f64)]| {
            move |name: &str| match own.iter().find(|(known, _)| *known == name) {
                Some((_, value)) => *value,
                None if name == "ambient_temperature" => 293.15,
                None if name.ends_with("_thermal") => 3.0,
                None => 0.0,
            }
        };
        assert_eq!(neighbours(scene(&[])), []);
        assert_eq!(neighbours(scene(&[("strip.external_conductance", 3.5)])), [("strip.external_temperature", 293.15)]);
        assert_eq!(neighbours(scene(&[("punch.top_thermal", 4.0)])), [("punch.external_temperature", 293.15)]);
        let given = scene(&[("punch.top_thermal", 4.0), ("punch.external_temperature", 300.0)]);
        assert_eq!(neighbours(given), []);
        let told = with_remedy("strip.external_temperature = 0 K must be above 0 K".into());
        assert!(told.ends_with("or set strip.external_temperature=\"20 degC\""), "{told}");
        assert_eq!(with_remedy("strip.external_temperature = 5 m".into()), "strip.external_temperature = 5 m");
    }

    #[test]
    fn unidirectional_sliding_is_steady() {
        let steady = Conditions { load: 100.0, velocity: 3.0, duration: 60.0, stroke: 0.0 }.inputs(0.1).unwrap();
        assert_eq!((steady.times, steady.step), (vec![0.0, 60.0], 0.1));
        assert_eq!(steady.values, [vec![100.0; 2], vec![0.0; 2], vec![3.0; 2]]);
    }
}
