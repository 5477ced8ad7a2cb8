//! Nominal trajectory of a scene: the inputs described by `nominal.*`, over the nominal duration, or over that of the run where it is
//! known and shorter. Below both are called the nominal duration.
//!
//! Theory: docs/theory.md, section 8.2.

use super::distance::Main;
use crate::INPUTS;
use crate::levels::{Model, ModelOperators};
use crate::lumped::conditions::Tunables;
use scene::Scene;
use scene::variables::{COUNT, reference};
use std::f64::consts::PI;

/// Ends of the segments of unidirectional sliding, as fractions of the nominal duration: dense at the beginning, where the
/// temperatures rise fastest.
const UNIDIRECTIONAL: [f64; 17] =
    [0.0, 1e-3, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// Ends of the segments of a half-stroke, as fractions of it. The first is short: just after the reversal the contact runs over
/// its own hot track, and the temperature on few cells is less accurate there than a quarter of a stroke later.
const HALF_STROKE: [f64; 6] = [0.0, 0.1, 0.3, 0.5, 0.75, 1.0];

/// Largest number of half-strokes of a reciprocating trajectory. Later ones are extrapolated from their second half.
const HALF_STROKES: f64 = 24.0;

/// Load after the release at the end, relative to the nominal one, and the segments of it as fractions of the nominal duration of
/// unidirectional sliding, the first with the falling load. Reciprocating sliding has a half-stroke of it.
///
/// The heated bodies are bowed and their pressure is uneven: under a small load the contact shrinks to its hottest cells, which
/// levels with a uniform pressure do not show. Most runs of brakes and clutches end, or go on, like this.
const RELEASED: f64 = 0.05;
const RELEASE: [f64; 3] = [0.002, 0.01, 0.04];

/// Velocity (m/s) and load (N) at both ends of a segment, and its length (s).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Segment {
    /// Velocity at the start and at the end, m/s.
    pub velocity: [f64; 2],
    /// Load at the start and at the end, N.
    pub load: [f64; 2],
    /// Duration, s.
    pub duration: f64,
}

/// Nominal trajectory.
#[derive(Clone, PartialEq, Debug)]
pub struct NominalTrajectory {
    /// Segments, one communication step each.
    pub segments: Vec<Segment>,
    /// Number of segments under the nominal load; those after them are the release.
    pub loaded: usize,
    /// Nominal duration over that of the segments, at least 1: the factor of wear acceleration by which the segments end with the
    /// worn depth of the whole duration.
    pub repeats: f64,
}

/// Results of a level over a trajectory.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Run {
    /// Wear depth (m), rise of the contact temperature (K) and friction force (N) at the ends of the segments that were completed.
    pub history: Vec<Main>,
    /// `estimated_step_error` at the end of the nominal load, and at the end of the release.
    pub step_bounds: [f64; 2],
    /// Internal steps, accepted and rejected.
    pub steps: u64,
    /// Those of them before the release.
    pub loaded_steps: u64,
    /// Fraction of the segments that was completed.
    pub covered: f64,
    /// First segment at the end of which a part of the contact zone was not in contact.
    pub parted: Option<usize>,
}

impl NominalTrajectory {
    /// Nominal trajectory; `None` where nominal load or velocity is 0.
    pub fn new(scene: &Scene) -> Option<NominalTrajectory> {
        let (speed, load, duration) = (scene.nominal_velocity, scene.nominal_load, scene.planned_duration);
        if !(speed > 0.0 && load > 0.0 && duration > 0.0) {
            return None;
        }
        if scene.nominal_stroke == 0.0 {
            let segment = |load: [f64; 2], part: f64| Segment { velocity: [speed; 2], load, duration: duration * part };
            let mut segments: Vec<_> =
                UNIDIRECTIONAL.windows(2).map(|ends| segment([load; 2], ends[1] - ends[0])).collect();
            let loaded = segments.len();
            let mut before = load;
            for part in RELEASE {
                segments.push(segment([before, RELEASED * load], part));
                before = RELEASED * load;
            }
            return Some(NominalTrajectory { segments, loaded, repeats: 1.0 });
        }
        let half = scene.nominal_stroke / speed;
        let count = (duration / half).clamp(1.0, HALF_STROKES).round();
        let mut segments = Vec::with_capacity(count as usize * (HALF_STROKE.len() - 1));
        // The last half-stroke is that of the release.
        for n in 0..=count as usize {
            // Sinusoidal, with the nominal speed as its mean. The strokes of one direction are equal to the last bit, so that
            // operators prepared for one are valid for the next.
            let direction = if n % 2 == 0 { 1.0 } else { -1.0 };
            let at = |part: f64| {
                let sine = (PI * part).sin();
                if sine < 1e-9 { 0.0 } else { direction * 0.5 * PI * speed * sine }
            };
            let is_released = n == count as usize;
            let load_at = |part: f64| if is_released && part > 0.0 { RELEASED * load } else { load };
            segments.extend(HALF_STROKE.windows(2).map(|ends| Segment {
                velocity: [at(ends[0]), at(ends[1])],
                load: [load_at(ends[0]), load_at(ends[1])],
                duration: half * (ends[1] - ends[0]),
            }));
        }
        let loaded = segments.len() - (HALF_STROKE.len() - 1);
        Some(NominalTrajectory { segments, loaded, repeats: (duration / (half * count)).max(1.0) })
    }

    /// The scene with the wear of the nominal duration, by its wear coefficients: `wear_acceleration` would be rejected where it
    /// suppresses thermoelastic growth, which does not matter for a comparison of levels.
    pub fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.punch.wear_coefficient *= self.repeats;
        scene.strip.wear_coefficient *= self.repeats;
        scene
    }

    /// Runs the trajectory on operators of [`NominalTrajectory::scene`]. It ends early where it requires more than `most`
    /// internal steps.
    ///
    /// # Errors
    /// Error of a step.
    pub fn run(&self, operators: &ModelOperators, most: u32) -> Result<Run, String> {
        let scene = operators.scene();
        let tunables = Tunables {
            friction_coefficient: scene.friction_coefficient,
            ambient_temperature: scene.ambient_temperature,
            wear_acceleration: scene.wear_acceleration,
        };
        let ambient = scene.ambient_temperature;
        let mut inputs: [f64; INPUTS] =
            [self.segments[0].velocity[0], self.segments[0].load[0], 0.0, 0.0, 0.0, ambient, ambient];
        let mut model = Model::new(operators, tunables, &inputs);
        model.limit_attempts(most);
        let mut values = Box::new([0.0; COUNT]);
        let mut run = Run { history: Vec::with_capacity(self.segments.len()), ..Run::default() };
        for segment in &self.segments {
            let mut slopes = [0.0; INPUTS];
            for (index, [first, last]) in [segment.velocity, segment.load].into_iter().enumerate() {
                inputs[index] = first;
                slopes[index] = (last - first) / segment.duration;
            }
            let varying = (slopes != [0.0; INPUTS]).then_some(&slopes);
            if let Err(failure) = model.step(&inputs, varying, segment.duration) {
                if model.out_of_attempts() {
                    run.steps = u64::from(most);
                    if run.history.len() < self.loaded {
                        run.loaded_steps = run.steps;
                    }
                    break;
                }
                return Err(failure.to_string());
            }
            let (accepted, rejected) = model.work();
            run.steps = accepted + rejected;
            if run.history.len() < self.loaded {
                run.loaded_steps = run.steps;
            }
            model.write_end(&mut values);
            model.write_account(&mut values);
            let of = |name: usize| values[name];
            let step_error = of(const { reference("estimated_step_error") } as usize);
            if run.history.len() < self.loaded {
                run.step_bounds[0] = step_error;
            }
            run.step_bounds[1] = step_error;
            if run.parted.is_none() && !model.touches_everywhere() {
                run.parted = Some(run.history.len());
            }
            run.history.push([
                of(const { reference("wear_depth") } as usize),
                of(const { reference("contact_temperature") } as usize) - ambient,
                of(const { reference("friction_force") } as usize),
            ]);
        }
        run.covered = run.history.len() as f64 / self.segments.len() as f64;
        Ok(run)
    }

    /// Fraction of the nominal duration in the first `count` segments, without the release.
    pub fn part(&self, count: usize) -> f64 {
        let duration = |segments: &[Segment]| segments.iter().map(|segment| segment.duration).sum::<f64>();
        let loaded = &self.segments[..self.loaded];
        duration(&loaded[..count.min(self.loaded)]) / (duration(loaded) * self.repeats)
    }
}
