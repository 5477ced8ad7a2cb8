//! Nominal course: the inputs that `nominal.*` describe, over which levels are compared.
//!
//! Unidirectional: sliding at nominal load and velocity for the nominal duration, standing under load for a tenth of it, sliding with a
//! twentieth of the load for a tenth. Reciprocating: at most 24 half-strokes, sinusoidal with the nominal velocity as their mean,
//! then one with a twentieth of the load. Standing shows how fast the heat at the surface decays, the light load how unevenly the
//! hot bodies touch.
//!
//! Theory: docs/theory.md, section 8.2.

use super::distance::{Main, main_outputs};
use crate::Inputs;
use crate::levels::{Model, ModelOperators};
use crate::lumped::conditions::Tunables;
use numerics::maximum::maximum;
use scene::Scene;
use scene::variables::COUNT;
use std::f64::consts::PI;

/// Ends of the segments of sliding, as fractions of the nominal duration: dense at the beginning, where temperatures rise fastest.
const SLIDING: [f64; 17] = [0.0, 1e-3, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// Ends of the segments of standing, and of sliding under the light load, as fractions of the nominal duration.
const AFTERWARDS: [f64; 5] = [0.0, 2e-3, 0.01, 0.04, 0.1];

/// Ends of the segments of a half-stroke, as fractions of it.
const HALF_STROKE: [f64; 6] = [0.0, 0.1, 0.3, 0.5, 0.75, 1.0];

/// Largest number of half-strokes under the nominal load.
const MOST_HALF_STROKES: usize = 24;

/// The light load, relative to the nominal one.
const LIGHT: f64 = 0.05;

/// Velocity (m/s) and load (N) at both ends of a segment, and its length (s).
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Segment {
    /// Velocity at the start and at the end, m/s.
    pub velocity: [f64; 2],
    /// Load, N.
    pub load: f64,
    /// Duration, s.
    pub duration: f64,
}

/// Nominal course.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct NominalCourse {
    /// Segments, one communication step each.
    pub segments: Vec<Segment>,
    /// Nominal duration over that of the half-strokes, at least 1: by this factor they wear faster.
    pub repeats: f64,
}

/// A run over the nominal course.
#[derive(Clone, Debug, Default)]
pub(crate) struct Run {
    /// Main outputs at the ends of the segments.
    pub history: Vec<Main>,
    /// Friction work, J.
    pub work: f64,
    /// Internal steps, accepted and rejected.
    pub steps: u64,
}

impl NominalCourse {
    /// Nominal course of `scene`.
    ///
    /// # Errors
    /// A text where nominal load or velocity is 0.
    pub(crate) fn new(scene: &Scene) -> Result<NominalCourse, String> {
        let (speed, load, duration) = (scene.nominal_velocity, scene.nominal_load, scene.nominal_duration);
        if !(speed > 0.0 && load > 0.0) {
            return Err(format!("nominal.load = {load} N and nominal.velocity = {speed} m/s are not both above 0"));
        }
        let mut segments = Vec::new();
        let mut repeats = 1.0;
        if scene.nominal_stroke > 0.0 {
            let half = scene.nominal_stroke / speed;
            let count = (duration / half).clamp(1.0, MOST_HALF_STROKES as f64).round();
            repeats = (duration / (half * count)).max(1.0);
            for n in 0..=count as usize {
                // Strokes of one direction are equal to the last bit, so that operators prepared for one are valid for the next.
                let direction = if n % 2 == 0 { 1.0 } else { -1.0 };
                let at = |part: f64| {
                    let sine = (PI * part).sin();
                    if sine < 1e-9 { 0.0 } else { direction * 0.5 * PI * speed * sine }
                };
                let load = if n == count as usize { LIGHT * load } else { load };
                segments.extend(HALF_STROKE.windows(2).map(|ends| Segment {
                    velocity: [at(ends[0]), at(ends[1])],
                    load,
                    duration: half * (ends[1] - ends[0]),
                }));
            }
        } else {
            let mut add = |ends: &[f64], speed: f64, load: f64| {
                let segment = |ends: &[f64]| {
                    let duration = duration * (ends[1] - ends[0]);
                    Segment { velocity: [speed; 2], load, duration }
                };
                segments.extend(ends.windows(2).map(segment));
            };
            add(&SLIDING, speed, load);
            add(&AFTERWARDS, 0.0, load);
            add(&AFTERWARDS, speed, LIGHT * load);
        }
        Ok(NominalCourse { segments, repeats })
    }

    /// The scene with the wear of the nominal duration. By its wear coefficients: `wear_acceleration` would be refused where it
    /// suppresses thermoelastic growth, which does not matter for a comparison.
    pub(crate) fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.punch.wear_coefficient *= self.repeats;
        scene.strip.wear_coefficient *= self.repeats;
        scene
    }

    /// Highest speed, m/s.
    pub(crate) fn fastest(&self) -> f64 {
        self.segments.iter().flat_map(|segment| segment.velocity).fold(0.0, |most, speed| maximum(most, speed.abs()))
    }

    /// Runs the course on operators of [`NominalCourse::scene`] with at most `most` internal steps of a contact line, and not further
    /// than to the segment whose number and outputs at its end are `enough`.
    ///
    /// # Errors
    /// A step that has no solution, or too many steps.
    pub(crate) fn run(
        &self,
        operators: &ModelOperators,
        most: u32,
        mut enough: impl FnMut(usize, &Main) -> bool,
    ) -> Result<Run, String> {
        let tunables = Tunables::of(operators.scene());
        let ambient = tunables.ambient_temperature;
        let mut inputs = Inputs::new(self.segments[0].velocity[0], self.segments[0].load, ambient);
        let mut model = Model::new(operators, tunables, &inputs);
        // The steps of two half-strokes recur in the next, each with one at the constant velocity of its Jacobian.
        let strokes = self.segments.iter().any(|segment| segment.velocity[0] != segment.velocity[1]);
        model.limit_attempts(most, strokes.then_some(2 * 2 * most as usize / MOST_HALF_STROKES));
        let mut values = Box::new([0.0; COUNT]);
        let mut run = Run::default();
        for (number, segment) in self.segments.iter().enumerate() {
            let [first, last] = segment.velocity;
            (inputs.sliding_velocity, inputs.normal_load) = (first, segment.load);
            let mut slopes = Inputs::constant(0.0);
            slopes.sliding_velocity = (last - first) / segment.duration;
            model
                .step(&inputs, (first != last).then_some(&slopes), segment.duration)
                .map_err(|failure| format!("{}: {failure}", operators.description()))?;
            model.write_end(&mut values);
            run.history.push(main_outputs(&values, ambient));
            if enough(number, &run.history[number]) {
                break;
            }
        }
        let (accepted, rejected) = model.work();
        (run.steps, run.work) = (accepted + rejected, model.friction_work());
        Ok(run)
    }
}
