//! Runs of generated scenes at given settings, and the distance of two runs.
//!
//! Theory: docs/theory.md, section 8.2.

use super::scenes::Generated;
use model::INPUTS;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use model::plan::cost;
use scene::variables::COUNT;
use scene::{Scene, value};

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Wear depth (m), contact temperature (K) and friction force (N) at the communication points.
    pub main: Vec<[f64; 3]>,
    /// `estimated_step_error` at the communication points.
    pub estimated: Vec<f64>,
    /// Accepted and rejected internal steps.
    pub steps: (u64, u64),
    /// Processor time of the steps, and of the set-up, s.
    pub seconds: [f64; 2],
    /// Expected cost of all internal steps, microseconds.
    pub work: f64,
}

/// Runs `scene` with the input trajectory of `generated`.
///
/// # Errors
/// A refused set-up or step.
pub fn run(generated: &Generated, scene: &Scene) -> Result<Record, String> {
    let begin = processor_seconds();
    let operators = ModelOperators::new(scene, steady::run_in)?;
    let setup = processor_seconds() - begin;
    let mut record = run_with(generated, &operators)?;
    record.seconds[1] += setup;
    Ok(record)
}

/// Runs the model of `operators` with the input trajectory of `generated`.
///
/// # Errors
/// A refused step.
pub fn run_with(generated: &Generated, operators: &ModelOperators) -> Result<Record, String> {
    let begin = processor_seconds();
    let scene = operators.scene();
    let tunables = Tunables {
        friction_coefficient: scene.friction_coefficient,
        ambient_temperature: scene.ambient_temperature,
        wear_acceleration: scene.wear_acceleration,
    };
    let mut inputs = generated.inputs(0);
    let mut model = Model::new(operators, tunables, &inputs);
    let setup = processor_seconds() - begin;
    let begin = processor_seconds();
    let mut record = Record::default();
    let mut values = Box::new([0.0; COUNT]);
    record.main.push([0.0, scene.ambient_temperature, 0.0]);
    for point in 1..generated.course.len() {
        let step = generated.course[point][0] - generated.course[point - 1][0];
        let next = generated.inputs(point);
        let mut slopes = [0.0; INPUTS];
        for index in 0..INPUTS {
            slopes[index] = (next[index] - inputs[index]) / step;
        }
        model.step(&inputs, Some(&slopes), step).map_err(|failure| failure.to_string())?;
        model.write_end(&mut values);
        model.write_account(&mut values);
        record.main.push([
            value!(values, "wear_depth"),
            value!(values, "contact_temperature"),
            value!(values, "friction_force"),
        ]);
        record.estimated.push(value!(values, "estimated_step_error"));
        inputs = next;
    }
    record.steps = model.work();
    record.work = (record.steps.0 + record.steps.1) as f64 * cost::per_step(operators);
    record.seconds = [processor_seconds() - begin, setup];
    Ok(record)
}

/// Largest distance of the main outputs over the run: of wear relative to the largest wear, of temperature to the peak rise,
/// of force to its peak, all of `truth`.
pub fn distance(run: &Record, truth: &Record) -> [f64; 3] {
    let start = truth.main[0][1];
    std::array::from_fn(|output| {
        let reference = if output == 1 { start } else { 0.0 };
        let scale = truth.main.iter().map(|main| (main[output] - reference).abs()).fold(0.0, f64::max);
        let apart = run.main.iter().zip(&truth.main).map(|(a, b)| (a[output] - b[output]).abs()).fold(0.0, f64::max);
        if scale > 0.0 { apart / scale } else { apart }
    })
}

/// Processor time of this thread, s; wall time where the system does not provide it.
pub fn processor_seconds() -> f64 {
    seconds(Clock::Thread)
}

/// Processor time of all threads, s: what an initialisation takes, which runs on a thread of its own; wall time where the system
/// does not provide it.
pub fn process_seconds() -> f64 {
    seconds(Clock::Process)
}

#[derive(Clone, Copy)]
enum Clock {
    Thread,
    Process,
}

#[cfg(unix)]
fn seconds(clock: Clock) -> f64 {
    let clock = match clock {
        Clock::Thread => libc::CLOCK_THREAD_CPUTIME_ID,
        Clock::Process => libc::CLOCK_PROCESS_CPUTIME_ID,
    };
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the clock writes the structure, which outlives the call.
    unsafe { libc::clock_gettime(clock, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(unix))]
fn seconds(_: Clock) -> f64 {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
