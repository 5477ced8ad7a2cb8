//! Short runs of a scene at its nominal conditions: what two levels differ by, where groups do not tell.
//!
//! A probe takes a few coarse steps over the nominal duration, or over the first strokes of it. What wear does to the
//! shape over a longer run, it does to the probe's: wear is as much faster as the probe is shorter. All levels take the
//! same steps, so that their time errors cancel and the differences are those of the levels.

use crate::coupled::INPUTS;
use crate::coupled::lumped::conditions::Tunables;
use crate::coupled::model::{Model, Operators};
use crate::scene::{Path, Scene};
use crate::variables::{COUNT, reference};
use std::f64::consts::PI;

/// Steps of a probe that slides one way: their ends, in parts of it. The first are short, so that something is known where a
/// probe has to end early; the others are short enough for temperatures that go straight within one.
const ONE_WAY: [f64; 15] = [0.0, 1e-3, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0];

/// Steps of such a probe before three hundredths of it.
const BEGINNING: usize = 2;

/// Heat resolves steps of this part of such a probe. What is faster answers at once: from 10 to 250 neither the difference to the lumped
/// level nor that of merged cells changes by more than some hundredths.
const RESOLVED_ONE_WAY: f64 = 15.0;

/// Steps of a half-stroke: their ends, in parts of it. The first is short: just behind the reversal the contact meets its own hot track,
/// and the temperature of few cells is further off there than a quarter of a stroke later, up to tenfold.
const HALF_STROKE: [f64; 6] = [0.0, 0.1, 0.3, 0.5, 0.75, 1.0];

/// Heat resolves steps of this part of a half-stroke: a sixth of a cycle. From 3 to 8 the differences change by less than a tenth.
const RESOLVED_IN_HALF_STROKE: f64 = 3.0;

/// Half-strokes of a probe that slides to and fro.
const HALF_STROKES: f64 = 4.0;

/// Widths that a probe slides where the strip keeps a worn track: in one width the groove is steady.
const WIDTHS: f64 = 2.0;

/// Growth of the errors of temperature and force with the time seen, and the longest time, over what a probe has seen, to which it
/// is carried on. Measured on blocks that slide to and fro: the error of a uniform pressure at the reversals.
const GROWTH: f64 = 0.4;
const CARRIED_ON: f64 = 2.0;

/// Velocity (m/s) at both ends of a step, and its length (s).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Segment {
    /// At the start and the end.
    pub velocity: [f64; 2],
    /// s.
    pub duration: f64,
}

/// What a probe does.
#[derive(Clone, PartialEq, Debug)]
pub struct Course {
    /// Steps.
    pub segments: Vec<Segment>,
    /// Load, N.
    pub load: f64,
    /// Its duration, s.
    pub duration: f64,
    /// What the wear coefficients are multiplied by.
    pub faster_wear: f64,
    /// Steps at the beginning that are compared only where nothing later is known: shorter than anybody looks at.
    pub beginning: usize,
}

/// Wear depth (m), rise of the contact temperature (K) and friction force (N) at the ends of the steps.
pub type History = Vec<[f64; 3]>;

/// What a probe found.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Probe {
    /// At the ends of the steps taken: fewer than those of the course where the probe ended early.
    pub history: History,
    /// Internal steps that were tried.
    pub steps: u64,
    /// Time covered, s.
    pub covered: f64,
}

impl Course {
    /// The probe of a scene; `None` where the nominal conditions leave nothing to be seen.
    pub fn new(scene: &Scene) -> Option<Course> {
        let (speed, load) = (scene.nominal_velocity, scene.nominal_load);
        if !(speed > 0.0 && load > 0.0) {
            return None;
        }
        let duration = scene.nominal_duration;
        if scene.nominal_stroke > 0.0 {
            let half = scene.nominal_stroke / speed;
            let halves = (duration / half).clamp(1.0, HALF_STROKES).round();
            let mut segments = Vec::new();
            for n in 0..halves as usize {
                // Sinusoidal, with the nominal speed as its mean; to the bit the same in every stroke, and opposite on its way back, so
                // that what was prepared for one stroke serves the next.
                let way = if n % 2 == 0 { 1.0 } else { -1.0 };
                let at = |part: f64| {
                    let sine = (PI * part).sin();
                    if sine < 1e-9 { 0.0 } else { way * 0.5 * PI * speed * sine }
                };
                segments.extend(HALF_STROKE.windows(2).map(|ends| Segment {
                    velocity: [at(ends[0]), at(ends[1])],
                    duration: half * (ends[1] - ends[0]),
                }));
            }
            let probed = half * halves;
            let faster_wear = (duration / probed).max(1.0);
            return Some(Course { segments, load, duration: probed, faster_wear, beginning: 0 });
        }
        let tracked = scene.path == Path::Straight && scene.strip.wear_coefficient > 0.0;
        let probed = if tracked { duration.min(WIDTHS * scene.width / speed) } else { duration };
        let segment = |ends: &[f64]| Segment { velocity: [speed; 2], duration: probed * (ends[1] - ends[0]) };
        let segments = ONE_WAY.windows(2).map(segment).collect();
        Some(Course { segments, load, duration: probed, faster_wear: 1.0, beginning: BEGINNING })
    }

    /// Largest difference of two probes in each of the three outputs, relative to the largest value of the second, over the time
    /// that both cover; `None` where that is nothing.
    pub fn distance(&self, one: &Probe, other: &Probe) -> Option<[f64; 3]> {
        let both = one.history.len().min(other.history.len());
        let first = self.beginning.min(both.checked_sub(1)?);
        Some(distance(&one.history[first..both], &other.history[first..both]))
    }

    /// How much larger the errors of temperature and force are over the whole run than over what `probe` has seen. One way the
    /// course of a probe is that of the run, or ends where the groove is steady.
    pub fn growth(&self, scene: &Scene, probe: &Probe) -> f64 {
        let whole = if scene.nominal_stroke > 0.0 { scene.nominal_duration } else { self.duration };
        if probe.covered > 0.0 { (whole / probe.covered).clamp(1.0, CARRIED_ON).powf(GROWTH) } else { 1.0 }
    }

    /// The scene whose operators a probe runs: heat resolves the steps of the probe and reaches as far as its duration lets it, and wear is
    /// as fast as the probe is short. Not by `wear_acceleration`, which is refused where it hides what grows: a probe compares levels only.
    pub fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        let step = match scene.nominal_stroke > 0.0 {
            true => scene.nominal_stroke / scene.nominal_velocity / RESOLVED_IN_HALF_STROKE,
            false => self.duration / RESOLVED_ONE_WAY,
        };
        scene.shortest_step = step;
        scene.nominal_duration = self.duration;
        let faster = self.faster_wear * scene.wear_acceleration;
        scene.punch.wear_coefficient *= faster;
        scene.strip.wear_coefficient *= faster;
        scene.wear_acceleration = 1.0;
        scene
    }

    /// Runs the probe. Where it needs more than `most` internal steps it ends early.
    ///
    /// # Errors
    /// What a step refuses.
    pub fn run(&self, operators: &Operators, most: u32) -> Result<Probe, String> {
        let scene = operators.scene();
        let tunables = Tunables {
            friction_coefficient: scene.friction_coefficient,
            ambient_temperature: scene.ambient_temperature,
            wear_acceleration: scene.wear_acceleration,
        };
        let ambient = scene.ambient_temperature;
        let mut inputs: [f64; INPUTS] = [self.segments[0].velocity[0], self.load, 0.0, 0.0, 0.0, ambient, ambient];
        let mut model = Model::new(operators, tunables, &inputs);
        model.limit_attempts(most);
        let mut values = vec![0.0; COUNT];
        let values: &mut [f64; COUNT] = values.as_mut_slice().try_into().map_err(|_| "no memory for a probe")?;
        let mut probe = Probe { history: Vec::with_capacity(self.segments.len()), ..Probe::default() };
        for segment in &self.segments {
            let [first, last] = segment.velocity;
            let mut slopes = [0.0; INPUTS];
            slopes[0] = (last - first) / segment.duration;
            inputs[0] = first;
            let sloped = (first != last).then_some(&slopes);
            if let Err(failure) = model.step(&inputs, sloped, segment.duration) {
                if model.out_of_attempts() {
                    probe.steps = u64::from(most);
                    break;
                }
                return Err(failure.to_string());
            }
            let (accepted, rejected) = model.work();
            probe.steps = accepted + rejected;
            probe.covered += segment.duration;
            model.write_end(values);
            let of = |name: usize| values[name];
            probe.history.push([
                of(const { reference("wear_depth") } as usize),
                of(const { reference("contact_temperature") } as usize) - ambient,
                of(const { reference("friction_force") } as usize),
            ]);
        }
        Ok(probe)
    }
}

/// The same of two histories of equal length.
fn distance(one: &[[f64; 3]], other: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|output| {
        let scale = other.iter().map(|main| main[output].abs()).fold(0.0, f64::max);
        let apart = one.iter().zip(other).map(|(a, b)| (a[output] - b[output]).abs()).fold(0.0, f64::max);
        if apart == 0.0 || scale == 0.0 { 0.0 } else { apart / scale }
    })
}
