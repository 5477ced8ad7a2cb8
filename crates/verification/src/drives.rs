//! Scenes with input trajectories and known solutions, shared by the charts of accuracy against cost, their tests and the
//! examples.
//!
//! A [`DriveProblem`] is a scene with its inputs over time, its sample times, and its truth: a closed form, an integral
//! equation, or a run far finer than all judged ones. A [`Setting`] is a method of solving it; the result is a [`Record`],
//! whose [`Errors`] are those of the main output quantities. Time is measured with the caller's clock.

mod brake;
mod clutch;
mod families;
mod pin;
mod punch;
mod run;

pub use families::{FORMER, Family};
pub use run::{Ending, Record, Schedule};

use scene::Fidelity;
use sliding_contact::component::Values;
use std::fmt;

/// Judged quantity of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Quantity {
    /// Wear depth, m.
    WearDepth,
    /// Contact temperature, K; errors are relative to the peak rise above ambient.
    ContactTemperature,
    /// Friction force, N.
    FrictionForce,
    /// Largest of the 33 station means of the pressure, Pa.
    PeakPressure,
}

impl Quantity {
    /// All quantities, in the order of a [`Sample`].
    pub const ALL: [Self; 4] = [Self::WearDepth, Self::ContactTemperature, Self::FrictionForce, Self::PeakPressure];

    /// Reference quantity of its error.
    pub fn relative_to(self) -> &'static str {
        match self {
            Self::ContactTemperature => "peak rise",
            _ => "largest value",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::WearDepth => "wear depth",
            Self::ContactTemperature => "contact temperature",
            Self::FrictionForce => "friction force",
            Self::PeakPressure => "peak pressure",
        })
    }
}

/// Wear depth (m), contact temperature (K), friction force (N) and peak pressure (Pa); NaN: not known, not judged.
pub type Sample = [f64; 4];

/// Largest error over the samples of each quantity, relative to the largest value of the truth (temperature: to the peak
/// rise); NaN: not judged.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Errors(pub [f64; 4]);

impl Errors {
    /// The error of one quantity.
    pub fn of(&self, quantity: Quantity) -> f64 {
        self.0[quantity as usize]
    }

    /// Largest error of wear depth, contact temperature and friction force, to which `solver.tolerance` refers.
    pub fn of_main_outputs(&self) -> f64 {
        self.0[..3].iter().copied().fold(0.0, f64::max)
    }
}

/// Solver settings of a run.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Setting {
    /// Model level.
    pub fidelity: Fidelity,
    /// `solver.tolerance`.
    pub tolerance: f64,
    /// Number of cells of the contact line; 0: chosen automatically.
    pub cells: usize,
    /// Communication step, s; infinite: from sample to sample.
    pub step: f64,
    /// Order of the inputs within a step: held (0) or with their derivatives (1).
    pub order: u8,
    /// Whether heat is modelled. Without it both bodies are insulators that slide without friction: temperature and friction
    /// force are not judged. Only for a [`DriveProblem::isothermal`].
    pub heat: bool,
}

impl fmt::Display for Setting {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.fidelity {
            Fidelity::Auto => "auto",
            Fidelity::Lumped => "lumped",
            Fidelity::Line => "line",
        };
        write!(formatter, "{level}")?;
        if self.cells > 0 {
            write!(formatter, ", {} cells", self.cells)?;
        }
        if !self.heat {
            write!(formatter, ", no heat")?;
        }
        write!(formatter, ", tolerance {:.0e}, ", self.tolerance)?;
        if self.step.is_finite() {
            write!(formatter, "step {:.4e} s", self.step)
        } else {
            write!(formatter, "steps from sample to sample")
        }?;
        write!(formatter, ", inputs {}", if self.order == 0 { "held" } else { "linear" })
    }
}

type ExactSamples = Box<dyn Fn(&[f64]) -> Result<Vec<Sample>, String>>;

/// Reference solution of the runs.
pub enum Truth {
    /// Solution independent of the model under test.
    Exact {
        /// Derivation, with the source.
        how: &'static str,
        /// Samples at the given times.
        samples: ExactSamples,
    },
    /// The first of these runs that the component accepts and that ends within the caller's budget: finer in every respect
    /// than all judged runs.
    Finest(Vec<Setting>),
}

/// A scene with its input trajectory, sample times and truth.
pub struct DriveProblem {
    /// Name on the command line and of the files.
    pub name: &'static str,
    /// Description in one line.
    pub title: &'static str,
    /// Its data, in one or two lines.
    pub data: &'static str,
    /// Start values of every variable.
    pub starts: Values,
    /// Sliding velocity (m/s) and normal load (N) at a time (s).
    pub inputs: Schedule,
    /// Typical communication step of an importer, s.
    pub step: f64,
    /// Compared communication steps, s, from coarse to fine.
    pub steps: Vec<f64>,
    /// Sample times, s, ascending; the last ends the run.
    pub samples: Vec<f64>,
    /// Reference solution.
    pub truth: Truth,
    /// Reason for the accuracy of the truth.
    pub reason: &'static str,
    /// Wear and pressure are independent of heat and friction force, so that heat may be switched off.
    pub isothermal: bool,
}

/// All problems, in the order of the charts.
pub fn problems() -> Result<Vec<DriveProblem>, String> {
    Ok(vec![pin::problem()?, punch::cold()?, punch::hot()?, brake::stop()?, brake::cycle()?, clutch::problem()?])
}

/// Multiples of `spacing` up to `last`.
fn every(spacing: f64, last: f64) -> Vec<f64> {
    (1..=(last / spacing).round() as u32).map(|index| f64::from(index) * spacing).collect()
}
