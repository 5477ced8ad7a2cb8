//! Drives the component along a trajectory and records every input and output.

use super::neglected_slip::NeglectedSlip;
use super::trajectory::{Trajectory, unit_of};
use crate::largest;
use anyhow::{Result, anyhow, bail};
use model::levels::ModelOperators;
use numerics::interruption::part;
use scene::message::{Number, Quantity};
use scene::variables::{Causality, TABLE, ValueReference, find, lookup};
use scene::{Geometry, STATIONS, Scene};
use scene_file::SceneFile;
use scene_file::nominal::with_remedy;
use sliding_contact::component::{Component, Subject};
use std::sync::Arc;
use std::time::Instant;

/// A recorded variable.
#[derive(Clone, PartialEq, Debug)]
pub struct Channel {
    /// Name of the variable.
    pub name: &'static str,
    /// SI unit; `1` of a number.
    pub unit: &'static str,
    /// Its value reference.
    pub reference: ValueReference,
    /// Values at the communication points.
    pub values: Vec<f64>,
}

/// Distributions over the contact at a time, at the stations.
#[derive(Clone, PartialEq, Debug)]
pub struct Profiles {
    /// s
    pub time: f64,
    /// Position along the contact line, m.
    pub x: [f64; STATIONS],
    /// Pa
    pub pressure: [f64; STATIONS],
    /// K
    pub temperature: [f64; STATIONS],
    /// Worn depths of punch and strip, m.
    pub worn: [[f64; STATIONS]; 2],
}

/// Called with the time that a run has reached, s.
pub type Progress<'a> = &'a mut dyn FnMut(f64);

/// A run, complete or up to its failure.
#[derive(Clone, PartialEq, Debug)]
pub struct Recording {
    /// Communication points, s.
    pub times: Vec<f64>,
    /// Integral of the sliding velocity up to them, m.
    pub displacement: Vec<f64>,
    /// Inputs and outputs at them.
    pub channels: Vec<Channel>,
    /// Distributions at the times asked for.
    pub profiles: Vec<Profiles>,
    /// Level at which the scene ran.
    pub level: String,
    /// Whether the contact line lies along the radius.
    pub radial: bool,
    /// Time and text of the warnings.
    pub warnings: Vec<(f64, String)>,
    /// Accepted and rejected internal steps.
    pub internal_steps: (u64, u64),
    /// Wall-clock time of initialisation and of the steps, s.
    pub seconds: [f64; 2],
    /// Numbers of trips and their first times, s, where the inputs have them.
    pub trips: Vec<(f64, f64)>,
    /// Slip by which the distance is too long, where elastic displacement is neglected and the run reverses.
    pub neglected_slip: Option<NeglectedSlip>,
    /// The reason why the run ended early.
    pub failure: Option<String>,
    /// Whether it was ended early on request ([`numerics::interruption`]).
    pub interrupted: bool,
}

impl Recording {
    pub(crate) fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// Values of an output, which must be there.
    pub(crate) fn values(&self, name: &str) -> &[f64] {
        &self.channel(name).unwrap_or_else(|| panic!("no output {name}")).values
    }

    fn record(&mut self, time: f64, component: &mut Component) -> Result<(), String> {
        // Nothing of a point is recorded unless all of it can be.
        let values: Vec<f64> = self.channels.iter().map(|channel| component.get(channel.reference)).collect();
        for (channel, value) in self.channels.iter().zip(&values) {
            if !value.is_finite() {
                return Err(format!("at {} s {} = {value} is not a finite number", Number(time), channel.name));
            }
        }
        self.channels.iter_mut().zip(values).for_each(|(channel, value)| channel.values.push(value));
        self.times.push(time);
        Ok(())
    }

    fn take_warnings(&mut self, time: f64, component: &mut Component) {
        if component.has_messages() {
            let warnings = component.messages().filter(|message| message.subject == Subject::Warning);
            self.warnings.extend(warnings.map(|message| (time, message.text.clone())));
        }
    }
}

fn channels() -> Vec<Channel> {
    let rows = TABLE.iter().filter(|row| row.causality == Causality::Input || row.is_result());
    let channel =
        |name| find(name).map(|reference| Channel { name, unit: unit_of(reference), reference, values: Vec::new() });
    rows.filter_map(|row| channel(row.name)).collect()
}

fn profiles(time: f64, component: &mut Component) -> Profiles {
    let mut at = |name: &str| {
        let first = find(&format!("{name}[1]")).unwrap_or_default();
        std::array::from_fn(|station| component.get(first + station as ValueReference))
    };
    Profiles {
        time,
        x: at("profile.x"),
        pressure: at("profile.pressure"),
        temperature: at("profile.temperature"),
        worn: [at("profile.wear_punch"), at("profile.wear_strip")],
    }
}

/// Part of its largest value from which on the load counts as pressing, for the times of profiles.
const PRESSED: f64 = 0.5;

/// The first, the middle and the last of the points at which the load is at least [`PRESSED`] of its largest: a released contact has no
/// profiles to see.
fn pressed(points: &[f64], trajectory: &Trajectory) -> Vec<f64> {
    let load =
        trajectory.inputs.iter().find(|(input, _)| Some(*input) == find("normal_load")).map(|(_, values)| values);
    let at = |time: f64| load.map_or(1.0, |values| trajectory.at(values, trajectory.interval(time), time).abs());
    let least = PRESSED * largest(points.iter().map(|time| at(*time)));
    let pressed: Vec<f64> = points.iter().copied().filter(|time| at(*time) >= least).collect();
    let (first, last) = (pressed[0], pressed[pressed.len() - 1]);
    let middle = 0.5 * (first + last);
    let nearest = pressed.iter().copied().min_by(|one, other| (one - middle).abs().total_cmp(&(other - middle).abs()));
    vec![first, nearest.unwrap_or(first), last]
}

/// Warnings about inputs that are given and have no effect.
fn without_effect(file: &SceneFile, trajectory: &Trajectory, scene: &Scene) -> Vec<String> {
    let replaced =
        trajectory.inputs.iter().filter(|(input, _)| trajectory.file.is_none() && file.given.contains(input));
    let replaced = replaced.filter_map(|(input, _)| {
        let (row, _) = lookup(*input)?;
        let start = Quantity(file.packaged.starts[*input as usize], unit_of(*input));
        Some(format!(
            "{} = {start} has no effect: without a file of inputs nominal.load and nominal.velocity act for nominal.duration",
            row.name
        ))
    });
    // As in what a run writes, whose inputs are all there.
    let is_start = |input: ValueReference, values: &[f64]| {
        values.iter().all(|value| *value == file.packaged.starts[input as usize])
    };
    let given = |name: &str| {
        trajectory.inputs.iter().any(|(input, values)| Some(*input) == find(name) && !is_start(*input, values))
    };
    let bodies = [("strip", "base", &scene.strip), ("punch", "top", &scene.punch)].into_iter();
    let idle = bodies.filter(|(name, _, body)| given(&format!("{name}.external_temperature")) && !body.has_neighbour());
    let idle = idle.map(|(name, face, _)| {
        format!(
            "{name}.external_temperature has no effect: {name}.external_conductance is 0 W/K and {name}.{face}_thermal is not external"
        )
    });
    replaced.chain(idle).collect()
}

/// Runs the scene along the trajectory, with profiles at the times `at`; where it has none, at the first, middle and last time at which
/// the load is at least half of its largest, for a contact line.
///
/// # Errors
/// A scene that is refused; times `at` outside of the trajectory or for a level without profiles; too many points. A step that
/// fails, or within which the run is to end, ends the recording.
pub fn run(file: &SceneFile, trajectory: &Trajectory, at: &[f64], progress: Progress) -> Result<Recording> {
    let at = &trajectory.within(at)?[..];
    let points = trajectory.points(at)?;
    let begin = Instant::now();
    let packaged = &file.packaged;
    let mut component = Component::new(Arc::new(packaged.starts)).declaring(packaged.experiment.tolerance);
    for (input, values) in &trajectory.inputs {
        component.set_input(*input, values[0]);
    }
    component.enter_initialization();
    component
        .initialise(None)
        .map_err(|text| anyhow!("the scene {}{}: {}", packaged.name, trajectory.place(1), with_remedy(text)))?;
    let operators = component.operators();
    let (level, has_profiles) = operators.as_ref().map_or((String::new(), false), level);
    if !has_profiles && !at.is_empty() {
        bail!(
            "at: the scene {} runs at the level {level}, whose pressure is uniform; profiles need the contact line, as with \
             solver.fidelity = line",
            packaged.name
        );
    }
    let wanted = match at {
        [] => pressed(&points, trajectory),
        at => at.to_vec(),
    };
    let mut recording = Recording {
        times: Vec::new(),
        displacement: Vec::new(),
        channels: channels(),
        profiles: Vec::new(),
        level,
        radial: operators.as_ref().is_some_and(|operators| operators.scene().geometry == Geometry::Annular),
        warnings: operators
            .iter()
            .flat_map(|operators| without_effect(file, trajectory, operators.scene()))
            .map(|text| (points[0], text))
            .collect(),
        internal_steps: (0, 0),
        seconds: [begin.elapsed().as_secs_f64(), 0.0],
        trips: trajectory.trips.clone(),
        neglected_slip: None,
        failure: None,
        interrupted: false,
    };
    let (begin, mut displacement) = (Instant::now(), 0.0);
    for (count, &time) in points.iter().enumerate() {
        let point = part(|| {
            let stepped = match count {
                0 => Ok(0.0),
                _ => step(&mut component, trajectory, points[count - 1], time),
            };
            recording.take_warnings(time, &mut component);
            displacement += stepped?;
            let profiles = (has_profiles && wanted.contains(&time)).then(|| profiles(time, &mut component));
            recording.record(time, &mut component)?;
            Ok::<_, String>(profiles)
        });
        match point {
            None => {
                recording.interrupted = true;
                break;
            }
            Some(Err(reason)) => {
                recording.failure = Some(reason);
                break;
            }
            Some(Ok(profiles)) => recording.profiles.extend(profiles),
        }
        recording.displacement.push(displacement);
        progress(time);
    }
    if let Some(&last) = recording.times.last().filter(|_| !recording.interrupted) {
        component.conclude();
        recording.take_warnings(last, &mut component);
    }
    recording.neglected_slip =
        operators.as_ref().and_then(|operators| NeglectedSlip::of(operators.scene(), &recording));
    recording.internal_steps = component.work();
    recording.seconds[1] = begin.elapsed().as_secs_f64();
    Ok(recording)
}

/// A communication step with the inputs linear; the displacement in it, m.
fn step(component: &mut Component, trajectory: &Trajectory, from: f64, to: f64) -> Result<f64, String> {
    let velocity = find("sliding_velocity");
    let mut displacement = 0.0;
    let interval = trajectory.interval(from);
    let step = to - from;
    for (input, values) in &trajectory.inputs {
        let (before, after) = (trajectory.at(values, interval, from), trajectory.at(values, interval, to));
        component.set_input(*input, before);
        if after != before {
            component.set_input_derivative(*input, (after - before) / step);
        }
        if Some(*input) == velocity {
            displacement = 0.5 * (before + after) * step;
        }
    }
    let stepped = component.step(step).map_err(|text| {
        format!("the step from {} s to {} s failed{}: {text}", Number(from), Number(to), trajectory.place(interval))
    });
    stepped.map(|()| displacement)
}

/// Name of the level, and whether it has profiles over the contact.
fn level(operators: &ModelOperators) -> (String, bool) {
    match operators {
        ModelOperators::Lumped(_) => ("lumped".into(), false),
        ModelOperators::Line(line) => {
            let heat = if line.heat.is_some() { "resolved heat" } else { "mean heat" };
            (format!("line, {} cells, {heat}", line.count()), true)
        }
    }
}

/// Largest magnitude of the energy balance's residual over the largest energy that has moved: dissipated, stored, lost, or passed
/// through the contact from one body to the other. From the outputs alone; 0 where nothing has moved.
pub fn energy_residual(recording: &Recording) -> f64 {
    let balance =
        ["dissipated_energy", "stored_heat", "heat_lost_ambient", "heat_lost_punch_top", "heat_lost_strip_base"]
            .map(|name| recording.values(name));
    let passed = ["heat_received_punch", "heat_received_strip"].map(|name| recording.values(name));
    let rows = 0..recording.times.len();
    let residuals = rows.map(|row| balance[0][row] - balance[1..].iter().map(|part| part[row]).sum::<f64>());
    let moved = largest(balance.iter().chain(&passed).flat_map(|part| part.iter().copied()));
    if moved == 0.0 { 0.0 } else { largest(residuals) / moved }
}
