//! Runs of an [`Application`] as by an importer, and their distance from a far finer run.
//!
//! Errors of wear depth, contact temperature and friction force are maxima over the communication points, relative to the
//! largest wear, the peak temperature rise and the peak force.
//!
//! Theory: docs/theory.md, section 8.2.

use super::Application;
use model::INPUTS;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use model::plan::cost;
use scene::variables::{COUNT, reference};
use scene::{Scene, value};
use sliding_contact::component::Component;
use std::sync::Arc;

/// Names of the judged outputs.
pub const OUTPUTS: [&str; 3] = ["wear_depth", "contact_temperature", "friction_force"];

/// Limit of the processor time of a run, s.
const LONGEST: f64 = 20.0;

/// Model level of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Setting {
    /// `solver.fidelity = auto`.
    Auto,
    /// `solver.fidelity = lumped`.
    Lumped,
    /// `solver.fidelity = line` with this number of `solver.cells`.
    Line(usize),
}

impl Setting {
    /// `starts` with this level at a tolerance.
    fn apply(self, starts: &[f64; COUNT], tolerance: f64) -> [f64; COUNT] {
        let mut starts = *starts;
        let (fidelity, cells) = match self {
            Self::Auto => (1.0, 0.0),
            Self::Lumped => (2.0, 0.0),
            Self::Line(cells) => (3.0, cells as f64),
        };
        starts[reference("solver.fidelity") as usize] = fidelity;
        starts[reference("solver.cells") as usize] = cells;
        starts[reference("solver.tolerance") as usize] = tolerance;
        starts
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Lumped => f.write_str("lumped"),
            Self::Line(cells) => write!(f, "line {cells}"),
        }
    }
}

/// Result of a run.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Run {
    /// Wear depth (m), contact temperature (K) and friction force (N) at the communication points.
    pub main: Vec<[f64; 3]>,
    /// `estimated_error` at the communication points; 0 at the first one.
    pub estimated: Vec<f64>,
    /// `estimated_step_error` at the end.
    pub step_error: f64,
    /// Accepted and rejected internal steps.
    pub steps: u64,
    /// Their expected cost by work counters, microseconds.
    pub work: f64,
    /// Processor time of initialisation and of the communication steps, s.
    pub seconds: [f64; 2],
    /// Processor time of rebuilding the final level without selecting it, s.
    pub building: f64,
    /// Level at the end, and cells.
    pub level: String,
}

/// Runs an application at a setting through the component, as an importer drives the FMU with linear inputs.
///
/// # Errors
/// A refused initialisation or step.
pub fn run(application: &Application, setting: Setting, tolerance: f64) -> Result<Run, String> {
    let begin = process_seconds();
    let starts = setting.apply(&application.starts, tolerance);
    let mut component = Component::new(Arc::new(starts));
    let (inputs, course) = (application.inputs(), &application.course);
    let set = |component: &mut Component, point: usize| {
        inputs.iter().for_each(|(input, values)| component.set_input(*input, values[point]));
    };
    set(&mut component, 0);
    component.set_run_duration(course.last().map(|last| last[0] - course[0][0]));
    component.enter_initialization();
    component.initialise(None)?;
    component.messages().for_each(drop);
    let mut run = Run::default();
    run.seconds[0] = process_seconds() - begin;
    let ambient = starts[reference("ambient_temperature") as usize];
    run.main.push([0.0, ambient, 0.0]);
    run.estimated.push(0.0);
    let begin = processor_seconds();
    let mut counted = 0;
    for point in 1..course.len() {
        let step = course[point][0] - course[point - 1][0];
        set(&mut component, point - 1);
        for (input, values) in &inputs {
            let slope = (values[point] - values[point - 1]) / step;
            if slope != 0.0 {
                component.set_input_derivative(*input, slope);
            }
        }
        component.step(step).map_err(|text| format!("at {} s: {text}", course[point - 1][0]))?;
        run.main.push(OUTPUTS.map(|name| component.get(reference(name))));
        run.estimated.push(component.get(reference("estimated_error")));
        component.messages().for_each(drop);
        if processor_seconds() - begin > LONGEST {
            return Err(format!("at {} s: {LONGEST} s of processor time are used up", course[point][0]));
        }
        let (accepted, rejected) = component.work();
        let steps = accepted + rejected;
        let new = steps - counted;
        counted = steps;
        run.steps += new;
        run.work += new as f64 * component.operators().as_ref().map_or(0.0, cost::per_step);
    }
    run.seconds[1] = processor_seconds() - begin;
    run.step_error = component.get(reference("estimated_step_error"));
    if let Some(operators) = component.operators() {
        let begin = processor_seconds();
        ModelOperators::new(operators.scene(), steady::run_in)?;
        run.building = processor_seconds() - begin;
        run.level = level(&operators);
    }
    Ok(run)
}

fn level(operators: &ModelOperators) -> String {
    match operators {
        ModelOperators::Lumped(_) => "lumped".into(),
        ModelOperators::Line(line) if line.heat.is_none() => format!("line {}, mean heat", line.count()),
        ModelOperators::Line(line) => format!("line {}", line.count()),
    }
}

/// A far finer run of the contact line, as a user can select it: with resolved heat where it feeds back.
///
/// # Errors
/// A refused set-up or step.
pub fn fine_run(application: &Application, cells: usize, tolerance: f64) -> Result<Run, String> {
    let scene =
        Scene::new(&Setting::Line(cells).apply(&application.starts, tolerance), None).map_err(|broken| broken.0)?;
    let operators = ModelOperators::new(&scene, steady::run_in)?;
    let ambient = scene.ambient_temperature;
    let tunables = Tunables {
        friction_coefficient: scene.friction_coefficient,
        ambient_temperature: ambient,
        wear_acceleration: scene.wear_acceleration,
    };
    let course = &application.course;
    let starts = &application.starts;
    let inputs_at = |point: usize| {
        let mut inputs: [f64; INPUTS] = std::array::from_fn(|index| starts[index]);
        inputs[..2].copy_from_slice(&course[point][1..]);
        inputs
    };
    let mut model = Model::new(&operators, tunables, &inputs_at(0));
    let mut values = Box::new([0.0; COUNT]);
    let mut run = Run { main: vec![[0.0, ambient, 0.0]], estimated: vec![0.0], ..Run::default() };
    let begin = processor_seconds();
    for point in 1..course.len() {
        let (inputs, next) = (inputs_at(point - 1), inputs_at(point));
        let step = course[point][0] - course[point - 1][0];
        let slopes = std::array::from_fn(|index| (next[index] - inputs[index]) / step);
        let failed = |failure| format!("{cells} cells at {} s: {failure}", course[point - 1][0]);
        model.step(&inputs, Some(&slopes), step).map_err(failed)?;
        model.write_end(&mut values);
        run.main.push([
            value!(values, "wear_depth"),
            value!(values, "contact_temperature"),
            value!(values, "friction_force"),
        ]);
        run.estimated.push(0.0);
    }
    let (accepted, rejected) = model.work();
    run.steps = accepted + rejected;
    run.work = run.steps as f64 * cost::per_step(&operators);
    run.seconds[1] = processor_seconds() - begin;
    run.level = level(&operators);
    Ok(run)
}

/// Ratio of the largest speed of an input trajectory to the critical speed of thermoelastic instability; 0 where there is
/// none.
///
/// # Errors
/// A refused initialisation.
pub fn speed_ratio(application: &Application) -> Result<f64, String> {
    let mut component = Component::new(Arc::new(Setting::Lumped.apply(&application.starts, 1e-2)));
    let [fastest, most] = [1, 2].map(|input| largest(application.course.iter().map(|point| point[input])));
    component.set_input(reference("sliding_velocity"), fastest);
    component.set_input(reference("normal_load"), most);
    component.enter_initialization();
    component.initialise(None)?;
    let critical = component.get(reference("critical_speed"));
    Ok(if critical > 0.0 { fastest / critical } else { 0.0 })
}

/// Scales of the errors: the largest wear, the peak temperature rise and the peak force.
pub fn scales(truth: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|output| {
        let reference = if output == 1 { truth[0][1] } else { 0.0 };
        largest(truth.iter().map(|main| main[output] - reference))
    })
}

/// Errors of a run up to every communication point.
pub fn errors_so_far(run: &[[f64; 3]], truth: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let scales = scales(truth);
    let mut most = [0.0_f64; 3];
    let apart = run.iter().zip(truth).map(|(run, truth)| {
        for output in 0..3 {
            let scale = if scales[output] > 0.0 { scales[output] } else { 1.0 };
            most[output] = largest([most[output], (run[output] - truth[output]) / scale]);
        }
        most
    });
    apart.collect()
}

/// Errors of a whole run.
pub fn errors(run: &[[f64; 3]], truth: &[[f64; 3]]) -> [f64; 3] {
    errors_so_far(run, truth).last().copied().unwrap_or_default()
}

/// Remaining error of a run by Richardson extrapolation: `apart` is its distance from the next coarser run, `last` the
/// distance of the two before. Differences are taken as a geometric series; their ratio is limited to between 1.2, nearly no
/// convergence, and 4, second order.
pub fn remaining(last: Option<[f64; 3]>, apart: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|output| match last {
        Some(last) => apart[output] / (last[output] / apart[output].max(1e-300) - 1.0).clamp(0.2, 3.0),
        None => apart[output],
    })
}

/// Largest magnitude; NaN counts as infinite.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, value| if value.is_nan() { f64::INFINITY } else { most.max(value.abs()) })
}

pub use crate::planning::runs::{process_seconds, processor_seconds};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_the_largest_values_and_never_shrink() {
        let truth = [[0.0, 300.0, 0.0], [1.0, 400.0, -50.0], [2.0, 350.0, 20.0]];
        let run = [[0.0, 300.0, 0.0], [1.2, 390.0, -45.0], [2.1, 350.0, 20.0]];
        assert_eq!(scales(&truth), [2.0, 100.0, 50.0]);
        let so_far = errors_so_far(&run, &truth);
        assert!(so_far.windows(2).all(|pair| (0..3).all(|output| pair[1][output] >= pair[0][output])));
        let [wear, temperature, force] = errors(&run, &truth);
        assert!((wear - 0.1).abs() < 1e-12 && (temperature - 0.1).abs() < 1e-12 && (force - 0.1).abs() < 1e-12);
        // First order, second order, and one that does not converge.
        assert_eq!(remaining(None, [1e-3, 0.0, 2.0]), [1e-3, 0.0, 2.0]);
        let [first, second, none] = remaining(Some([2e-3, 4e-3, 1e-3]), [1e-3; 3]);
        assert!(
            (first / 1e-3 - 1.0).abs() < 1e-12
                && (second * 3e3 - 1.0).abs() < 1e-12
                && (none / 5e-3 - 1.0).abs() < 1e-12
        );
        assert_eq!(errors(&[[f64::NAN, 300.0, 0.0], run[1], run[2]], &truth)[0], f64::INFINITY);
    }
}
