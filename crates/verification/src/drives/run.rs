//! Solution of a problem with one setting.

use super::{DriveProblem, Errors, Quantity, Sample, Setting, Truth};
use scene::STATIONS;
use scene::variables::{ValueReference, reference};
use sliding_contact::component::{Component, Values};
use std::sync::Arc;

/// Sliding velocity (m/s) and normal load (N) over the time (s).
pub type Schedule = Box<dyn Fn(f64) -> [f64; 2]>;

const VELOCITY: ValueReference = reference("sliding_velocity");
const LOAD: ValueReference = reference("normal_load");
const MAIN: [ValueReference; 3] =
    [reference("wear_depth"), reference("contact_temperature"), reference("friction_force")];
/// Variables set to 0 to switch off heat generation and conduction.
const HEAT: [ValueReference; 3] =
    [reference("punch.conductivity"), reference("strip.conductivity"), reference("contact.friction_coefficient")];
const PRESSURE: ValueReference = reference("profile.pressure");

/// End of a run.
#[derive(Clone, PartialEq, Debug)]
pub enum Ending {
    /// At the last sample.
    Finished,
    /// The scene was not accepted with this setting.
    Refused(String),
    /// A step failed at this time (s).
    Failed(f64, String),
    /// The budget ran out at this time (s).
    Stopped(f64),
}

/// Record of a run.
#[derive(Clone, PartialEq, Debug)]
pub struct Record {
    /// Setting.
    pub setting: Setting,
    /// Samples up to the end of the run.
    pub samples: Vec<Sample>,
    /// End of the run.
    pub ending: Ending,
    /// Initialisation and stepping, s of the caller's clock.
    pub seconds: [f64; 2],
    /// Communication steps done.
    pub communications: u64,
    /// Internal steps accepted and rejected: the work counters.
    pub work: (u64, u64),
}

impl Record {
    /// Time of the whole run, s of the caller's clock.
    pub fn cost(&self) -> f64 {
        self.seconds[0] + self.seconds[1]
    }

    /// Internal steps tried.
    pub fn tried(&self) -> u64 {
        self.work.0 + self.work.1
    }
}

impl DriveProblem {
    /// Solves the problem with `setting`; `clock` gives the time in s, and the run ends where it has used `budget` s.
    ///
    /// As by an importer: at every communication point the inputs of the next step are set, the three main outputs read, and
    /// the step done; profiles are read at the samples. Outputs at a sample correspond to its inputs.
    pub fn run(&self, setting: &Setting, clock: &dyn Fn() -> f64, budget: f64) -> Record {
        let mut record = Record {
            setting: *setting,
            samples: Vec::with_capacity(self.samples.len()),
            ending: Ending::Finished,
            seconds: [0.0; 2],
            communications: 0,
            work: (0, 0),
        };
        if !setting.heat && !self.isothermal {
            record.ending =
                Ending::Refused(format!("{}: wear and pressure follow the heat, which cannot go", self.name));
            return record;
        }
        let points = match self.communication_points(setting.step) {
            Ok(points) => points,
            Err(text) => {
                record.ending = Ending::Refused(text);
                return record;
            }
        };
        let begin = clock();
        let mut component = Component::new(Arc::new(self.starts_with(setting)));
        component.enter_initialization();
        let initialised = component.initialise(None);
        let ready = clock();
        record.seconds[0] = ready - begin;
        if let Err(text) = initialised {
            record.ending = Ending::Refused(text);
            return record;
        }
        for (index, &(time, sampled)) in points.iter().enumerate() {
            let inputs = (self.inputs)(time);
            component.set_input(VELOCITY, inputs[0]);
            component.set_input(LOAD, inputs[1]);
            if sampled {
                record.samples.push(sample(&mut component, setting.heat));
            } else {
                std::hint::black_box(MAIN.map(|output| component.get(output)));
            }
            let Some((next, _)) = points.get(index + 1) else { break };
            let step = if setting.step.is_finite() { setting.step } else { next - time };
            if setting.order > 0 {
                let end = (self.inputs)(time + step);
                for ((input, from), to) in [VELOCITY, LOAD].into_iter().zip(inputs).zip(end) {
                    component.set_input_derivative(input, (to - from) / step);
                }
            }
            if let Err(text) = component.step(step) {
                record.ending = Ending::Failed(time, text);
                break;
            }
            record.communications += 1;
            if clock() - begin > budget {
                record.ending = Ending::Stopped(time + step);
                break;
            }
        }
        record.seconds[1] = clock() - ready;
        record.work = component.work();
        record
    }

    /// The truth at the samples and its derivation; `solve` does one of the finest runs. Where none of them finishes, the
    /// longest one gives the samples that it reached; the others are unknown.
    ///
    /// # Errors
    /// None of the runs reaches a quarter of the samples: the reason for each.
    pub fn truth(&self, solve: &mut dyn FnMut(&Setting) -> Record) -> Result<(String, Vec<Sample>), String> {
        let candidates = match &self.truth {
            Truth::Exact { how, samples } => return Ok(((*how).to_owned(), samples(&self.samples)?)),
            Truth::Finest(candidates) => candidates,
        };
        let mut reasons = Vec::new();
        let mut farthest: Option<Record> = None;
        for setting in candidates {
            let record = solve(setting);
            match &record.ending {
                Ending::Finished => return Ok((format!("the finest run: {setting}"), record.samples)),
                Ending::Refused(text) => reasons.push(format!("{setting}: {text}")),
                Ending::Failed(time, text) => reasons.push(format!("{setting}: at {time} s: {text}")),
                Ending::Stopped(time) => reasons.push(format!("{setting}: too slow, stopped at {time:.4} s")),
            }
            if farthest.as_ref().is_none_or(|known| known.samples.len() < record.samples.len()) {
                farthest = Some(record);
            }
        }
        match farthest.filter(|record| 4 * record.samples.len() >= self.samples.len()) {
            Some(mut record) => {
                let known = record.samples.len();
                let last = self.samples[known - 1];
                record.samples.resize(self.samples.len(), [f64::NAN; 4]);
                Ok((format!("the finest run as far as it came, {last:.4} s: {}", record.setting), record.samples))
            }
            None => Err(format!("{}: no run gives the truth: {}", self.name, reasons.join("; "))),
        }
    }

    /// Errors of samples against the truth.
    pub fn errors(&self, samples: &[Sample], truth: &[Sample]) -> Errors {
        let ambient = self.starts[const { reference("ambient_temperature") } as usize];
        Errors(Quantity::ALL.map(|quantity| {
            let at = quantity as usize;
            let zero = if quantity == Quantity::ContactTemperature { ambient } else { 0.0 };
            let judged = || truth.iter().zip(samples).filter(|(known, _)| known[at].is_finite());
            let scale = truth
                .iter()
                .filter(|known| known[at].is_finite())
                .map(|known| (known[at] - zero).abs())
                .fold(0.0, f64::max);
            // Quantities that a peer does not model are not judged.
            let modelled = samples.iter().any(|found| !found[at].is_nan());
            if scale == 0.0 || samples.len() < truth.len() || !modelled {
                return f64::NAN;
            }
            judged()
                .map(|(known, found)| (found[at] - known[at]).abs() / scale)
                .fold(0.0, |worst, error| if error.is_finite() { worst.max(error) } else { f64::INFINITY })
        }))
    }

    /// Times of all communication points (s), and whether a sample lies there.
    fn communication_points(&self, step: f64) -> Result<Vec<(f64, bool)>, String> {
        if step == f64::INFINITY {
            let start = (self.samples.first() != Some(&0.0)).then_some((0.0, false));
            return Ok(start.into_iter().chain(self.samples.iter().map(|&time| (time, true))).collect());
        }
        let index = |time: &f64| {
            let index = (time / step).round();
            if (time - index * step).abs() > 1e-6 * step {
                return Err(format!("the sample at {time} s is no communication point of steps of {step} s"));
            }
            Ok(index as u64)
        };
        let sampled: Vec<u64> = self.samples.iter().map(index).collect::<Result<_, String>>()?;
        let last = sampled.last().copied().unwrap_or(0);
        let mut ahead = sampled.iter().peekable();
        let point = |index: u64| (index as f64 * step, ahead.next_if_eq(&&index).is_some());
        Ok((0..=last).map(point).collect())
    }

    /// Start values of every variable for this setting.
    pub fn starts_with(&self, setting: &Setting) -> Values {
        let mut starts = self.starts;
        let changes = [
            (const { reference("solver.fidelity") }, f64::from(setting.fidelity as u8 + 1)),
            (const { reference("solver.tolerance") }, setting.tolerance),
            (const { reference("solver.cells") }, setting.cells as f64),
        ];
        for (parameter, value) in changes {
            starts[parameter as usize] = value;
        }
        if !setting.heat {
            for parameter in HEAT {
                starts[parameter as usize] = 0.0;
            }
        }
        starts
    }
}

fn sample(component: &mut Component, heat: bool) -> Sample {
    let [wear, temperature, force] = MAIN.map(|output| component.get(output));
    let [temperature, force] = if heat { [temperature, force] } else { [f64::NAN; 2] };
    let stations = (0..STATIONS as ValueReference).map(|station| component.get(PRESSURE + station));
    [wear, temperature, force, stations.fold(0.0, f64::max)]
}
