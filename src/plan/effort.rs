//! What planning costs, and what the run costs that is planned: counted work with constants calibrated once, in microseconds of a
//! core of 3 GHz, so that no plan depends on a clock.

use super::probe::Probe;
use super::rung::{Rung, cost};
use crate::coupled::line::heat::bodies::{possible_on_the_cells, shortest};
use crate::coupled::model::Operators;
use crate::scene::{HeatAlongContact, Scene};

/// What planning may cost in any case, microseconds, and as a part of the run.
const ALLOWED: (f64, f64) = (20e3, 0.01);

/// Thermal states of both bodies before any is built.
const TYPICAL_STATES: usize = 100;

/// Part of what is left after building that one probe may take: two of them step along the contact.
const PROBE_SHARE: f64 = 0.4;

/// Bounds of the internal steps of a probe. Most of them go into its first steps, as edges settle: one that ends early saves little
/// and sees next to nothing.
const ATTEMPTS: (f64, f64) = (300.0, 600.0);

/// Costs of building: the lumped level; the bodies of a contact line, and for each pair of cells; heat along it, for each
/// thermal state and pair of cells.
const BUILD_LUMPED: f64 = 600.0;
const BUILD_LINE: f64 = 2500.0;
const BUILD_PAIR: f64 = 7.0;
const BUILD_HEAT: f64 = 4500.0;
const BUILD_STATE: f64 = 3.0;
const BUILD_HEAT_PAIR: f64 = 9.0;

/// See the module.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Effort {
    /// Of planning: what the probes needed built, and their steps; not the chosen rung, which any other choice of it costs too.
    pub planning: f64,
    /// Of the run: its expected internal steps on the chosen rung.
    pub run: f64,
    /// Expected internal steps of the whole run on the rungs that were probed.
    pub paces: Vec<(Rung, f64)>,
}

impl Effort {
    /// Counts what `operators` took to build.
    pub fn built(&mut self, operators: &Operators) {
        self.planning += match operators {
            Operators::Lumped(_) => BUILD_LUMPED,
            Operators::Line(line) => {
                let pairs = (line.count() * line.count()) as f64;
                let heat = line.heat.as_ref().map_or(0.0, |bodies| {
                    let states = (bodies.states[0] + bodies.states[1]) as f64;
                    BUILD_HEAT + BUILD_STATE * states + BUILD_HEAT_PAIR * pairs
                });
                BUILD_LUMPED + BUILD_LINE + BUILD_PAIR * pairs + heat
            }
        };
    }

    /// Counts internal steps of a probe.
    pub fn stepped(&mut self, steps: u64, cost_per_step: f64) {
        self.planning += steps as f64 * cost_per_step;
    }

    /// What planning may cost for a run of `scene` on the cheapest contact line with the same heat.
    fn allowed(scene: &Scene) -> f64 {
        let (least, part) = ALLOWED;
        let states = possible_on_the_cells(scene).then_some(TYPICAL_STATES);
        least.max(part * resolved(scene) * cost(super::rung::CELLS[0], states))
    }

    /// Internal steps that a probe may take at this cost of a step.
    pub fn attempts(&self, scene: &Scene, cost_per_step: f64) -> u32 {
        let left = PROBE_SHARE * (Self::allowed(scene) - self.planning).max(0.0);
        let (least, most) = ATTEMPTS;
        (left / cost_per_step).clamp(least, most) as u32
    }

    /// Whether planning is cheap against the run: at most a hundredth of it, or 20 ms.
    pub fn is_small(&self) -> bool {
        let (least, part) = ALLOWED;
        self.planning <= least.max(part * self.run)
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
