//! What planning costs, and what the run costs that is planned: counted work with constants calibrated once, in microseconds of a
//! core of 3 GHz, so that no plan depends on a clock.

use super::probe::Probe;
use super::rung::Rung;
use crate::coupled::line::heat::bodies::shortest;
use crate::coupled::model::Operators;
use crate::scene::{Geometry, HeatAlongContact, Scene};

/// What planning may cost in any case, microseconds, and as a part of the run.
const ALLOWED: (f64, f64) = (20e3, 0.01);

/// Part of what is left after building that one probe may take: two of them step with heat on the cells, the others cost little.
const PROBE_SHARE: f64 = 0.45;

/// Bounds of the internal steps of a probe. Most of them go into its first steps, as edges settle: one that ends early saves little
/// and sees next to nothing.
const ATTEMPTS: (f64, f64) = (60.0, 600.0);

/// What planning has done, counted.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Work {
    /// Lumped levels and contact lines built.
    pub lumped: u64,
    pub lines: u64,
    /// Bodies with heat along the contact, of them rings; thermal states of punch and strip.
    pub bodies: u64,
    pub rings: u64,
    pub states: [u64; 2],
    /// Internal steps at the lumped level, along the contact with heat by its mean, and with heat on its cells.
    pub steps: [u64; 3],
    /// Steps of the last kind times thermal states of punch and strip.
    pub carried: [u64; 2],
}

impl Work {
    /// What it costs, microseconds.
    pub fn cost(&self) -> f64 {
        let sum =
            |counts: &[u64], costs: &[f64]| -> f64 { counts.iter().zip(costs).map(|(&n, cost)| n as f64 * cost).sum() };
        sum(&[self.lumped, self.lines, self.bodies, self.rings], &BUILD)
            + sum(&self.states, &BUILD_STATE)
            + sum(&self.steps, &STEP)
            + sum(&self.carried, &CARRY)
    }
}

/// Costs of building a lumped level, a contact line, and heat along it, more for rings; of a thermal state of punch and strip.
const BUILD: [f64; 4] = [300.0, 1500.0, 500.0, 1200.0];
const BUILD_STATE: [f64; 2] = [5.0, 1.7];

/// Costs of the steps in [`Work`], and of carrying a thermal state of punch and strip through one.
const STEP: [f64; 3] = [1.4, 12.0, 14.0];
const CARRY: [f64; 2] = [0.22, 0.012];

/// See the module.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Effort {
    /// Of planning: what the probes needed built, and their steps; not the chosen rung, which any other choice of it costs too.
    pub work: Work,
    /// Of the run: its expected internal steps on the chosen rung, microseconds.
    pub run: f64,
    /// Expected internal steps of the whole run on the rungs that were probed.
    pub paces: Vec<(Rung, f64)>,
}

impl Effort {
    /// Cost of planning, microseconds.
    pub fn planning(&self) -> f64 {
        self.work.cost()
    }

    /// Counts what `operators` took to build.
    pub fn built(&mut self, operators: &Operators) {
        match operators {
            Operators::Lumped(_) => self.work.lumped += 1,
            Operators::Line(line) => {
                self.work.lines += 1;
                if let Some(bodies) = &line.heat {
                    self.work.bodies += 1;
                    self.work.rings += u64::from(line.scene.geometry == Geometry::Annular);
                    self.work.states = std::array::from_fn(|side| self.work.states[side] + bodies.states[side] as u64);
                }
            }
        }
    }

    /// Counts internal steps of a probe.
    pub fn stepped(&mut self, steps: u64, operators: &Operators) {
        self.work = self.work_with(steps, operators);
    }

    fn work_with(&self, steps: u64, operators: &Operators) -> Work {
        let mut work = self.work;
        match operators {
            Operators::Lumped(_) => work.steps[0] += steps,
            Operators::Line(line) => match &line.heat {
                None => work.steps[1] += steps,
                Some(bodies) => {
                    work.steps[2] += steps;
                    work.carried = std::array::from_fn(|side| work.carried[side] + steps * bodies.states[side] as u64);
                }
            },
        }
        work
    }

    /// Internal steps that a probe on `operators` may take.
    pub fn attempts(&self, operators: &Operators) -> u32 {
        let planning = self.planning();
        let left = PROBE_SHARE * (ALLOWED.0 - planning).max(0.0);
        let per_step = self.work_with(1, operators).cost() - planning;
        let (least, most) = ATTEMPTS;
        (left / per_step).clamp(least, most) as u32
    }

    /// Whether planning is cheap against the run: at most a hundredth of it, or 20 ms.
    pub fn is_small(&self) -> bool {
        let (least, part) = ALLOWED;
        self.planning() <= least.max(part * self.run)
    }

    /// Expected internal steps of a run of `scene` on `rung`: those of the probe of its kind, or those that the bodies are made to
    /// resolve.
    pub fn steps(&self, scene: &Scene, rung: Rung) -> f64 {
        let kind = |rung: Rung| match rung {
            Rung::Lumped => None,
            Rung::Line { heat, .. } => Some(heat == HeatAlongContact::ByItsMean),
        };
        let known = self.paces.iter().find(|(known, _)| kind(*known) == kind(rung)).map_or(0.0, |(_, steps)| *steps);
        known.max(resolved(scene))
    }
}

/// Steps that a run is expected to have at least: the shortest that its bodies resolve, a thousandth of the duration or a 60th of
/// a cycle.
fn resolved(scene: &Scene) -> f64 {
    let step = shortest(scene);
    if step > 0.0 { scene.nominal_duration / step } else { 0.0 }
}

/// Internal steps of the whole nominal duration after what a probe of it took: to and fro every stroke begins anew; one way what
/// changes slows down, so that every part of the course that is as long as all before it takes as many.
pub fn steps_of(scene: &Scene, probe: &Probe) -> f64 {
    let (steps, parts) = (probe.steps as f64, scene.nominal_duration / probe.covered);
    match probe.covered > 0.0 && parts > 1.0 {
        true if scene.nominal_stroke > 0.0 => steps * parts,
        true => steps * (1.0 + parts.log2()),
        false => steps,
    }
}
