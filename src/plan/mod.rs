//! What `solver.fidelity = auto` chooses: the cheapest rung whose error is below the tolerance.
//!
//! # How
//!
//! The lumped level, nine cells, and the same nine merged to five take the same short probe at nominal conditions ([`probe`]).
//! With `d` the largest difference of wear depth (relative to the most worn), contact temperature (to the peak rise) and
//! friction force (to its peak):
//!
//! ```text
//! error(N cells) = c d(5 cells, 9 cells) (9/N)^(3/2)
//! error(lumped)  = d(lumped, 9 cells) + error(9 cells)
//! error(N cells, mean heat) = d(9 cells with mean heat, 9 cells) + error(N cells)
//! ```
//!
//! c and the exponent are measured on generated scenes: graded cells converge with N^-2 where the pressure is finite, and
//! slower where friction follows the temperature of edges that carry much. The plan depends on computed numbers alone, never
//! on timings: the same scene has the same plan everywhere.
//!
//! Where the lumped level is good enough with d(lumped, 9 cells) in the place of d(5 cells, 9 cells), the probe of five
//! cells is left out: cells are closer to each other than to a uniform pressure.
//!
//! # What it costs
//!
//! At most 20 ms or 1 % of the run that is planned, in counted work ([`effort`]). One contact line is built, with the lumped level's bodies
//! for its mean and with blocks, strips and punches as coarse and far-reaching as the comparison asks for; the five cells are merged from
//! its matrices and take the steps that nine have prepared where they take the same. Every stroke of a probe repeats the velocities of the
//! last one to the bit, so its steps are prepared once, and those of the way back are their mirror images. Stages are solved to 1e-6.
//! A probe that needs more internal steps than this pays for ends early and compares what it covers.
//!
//! # Limits
//!
//! Nominal values of 0 leave nothing to compare: the plan is then lumped and says so. Sliding to and fro is probed over a
//! few strokes with wear as fast as that of the whole duration. Errors of temperature and force grow with what diffuses, and are
//! carried on to the run as `(run/probe)^0.4`, to twice the probe's length: slower heating of thick bodies is common to all levels.

pub mod effects;
pub mod effort;
pub mod groups;
pub mod ladder;
pub mod probe;
pub mod rung;
mod text;

use crate::coupled::line::heat::bodies::possible_on_the_cells;
use crate::coupled::model::Operators;
use crate::scene::{Escalation, HeatAlongContact, MechanicalBody, Scene};
use effects::Effect;
use effort::Effort;
use groups::Groups;
use probe::{Course, Probe};
use rung::Rung;

/// Part of the tolerance that a level may take; the rest is for the time steps.
const LEVEL_SHARE: f64 = 0.9;

/// c of the module's text: error of nine cells over their difference to five.
const REMAINDER: f64 = 0.6;

/// Exponent of the cells in the error.
const ORDER: f64 = 1.5;

/// Most cells of a rung that a run goes on with.
const FINEST_NEXT: usize = 65;

/// Error of a level that nothing could be compared with.
const UNKNOWN: f64 = 1.0;

/// Bounds of a probe's tolerance: its steps and bodies need not be finer than the comparison. From 5e-3 to 5e-2 neither difference of
/// two levels changes by more than its fifth, but for the noise of steps that are not the same.
const PROBE_TOLERANCE: (f64, f64) = (1e-2, 5e-2);

/// A probe's tolerance within them over that of the scene.
const LOOSER: f64 = 2.0;

/// The least for bodies of a probe that slides to and fro, and its steps' tolerance: the differences are those just behind the
/// reversals, of which both levels miss the same. From 1e-2 on they change by less than a fifth; coarser bodies lose the punch's heated layer.
const TO_AND_FRO: (f64, f64) = (2e-2, 5e-2);

/// A rung with its estimated errors.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Candidate {
    /// The rung.
    pub rung: Rung,
    /// Relative errors of wear depth, contact temperature and friction force.
    pub errors: [f64; 3],
    /// Expected cost of an internal step, microseconds; see [`rung::cost_per_step`].
    pub cost: f64,
}

impl Candidate {
    /// The largest of the errors.
    pub fn error(&self) -> f64 {
        largest(self.errors)
    }
}

/// What was chosen, and why.
#[derive(Clone, PartialEq, Debug)]
pub struct Plan {
    /// The tolerance it was made for.
    pub tolerance: f64,
    /// The rung.
    pub rung: Rung,
    /// Whether its estimated error is below the tolerance.
    pub meets: bool,
    /// Why it is this rung.
    pub reason: String,
    /// Effects, what decided on them, and what they cost.
    pub effects: Vec<Effect>,
    /// Dimensionless groups at nominal conditions.
    pub groups: Groups,
    /// Every rung that was looked at, by cost; empty where there was nothing to choose.
    pub candidates: Vec<Candidate>,
    /// Thermal states of punch, strip and moving source.
    pub states: [usize; 3],
    /// Order of the time steps.
    pub order: u8,
    /// Estimated relative error of the rung, the largest of the three main outputs; 1 where nothing could be
    /// compared, 0 where both bodies are rigid.
    pub estimated_error: f64,
    /// Relative error of the reduced thermal bodies.
    pub reduction_error: f64,
    /// Expected cost of an internal step, microseconds; see [`rung::cost_per_step`].
    pub cost_per_step: f64,
    /// Internal steps that the probes took.
    pub probe_steps: u64,
    /// Part of the probe that was run before its steps were used up.
    pub covered: f64,
    /// What planning and the run cost.
    pub effort: Effort,
    /// Peak rise of the contact temperature at nominal conditions, K; 0 where nothing was probed.
    pub rise: f64,
    /// The rung that a run goes on with when it leaves what was planned for.
    pub next: Option<Rung>,
}

/// A plan and the operators that it needs.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The plan.
    pub plan: Plan,
    /// Of the chosen rung.
    pub operators: Operators,
    /// Of [`Plan::next`], where it is to be prepared.
    pub prepared: Option<Operators>,
}

/// What the probes found.
struct Findings {
    fine: Operators,
    candidates: Vec<Candidate>,
    /// Peak rise of the contact temperature, K.
    rise: f64,
    steps: u64,
    covered: f64,
    effort: Effort,
}

/// Plans `scene`.
///
/// # Errors
/// A text with the numbers where the chosen level cannot be built.
pub fn make(scene: &Scene) -> Result<Planned, String> {
    make_watched(scene, &mut || {})
}

/// The same, telling when the rung is chosen: what comes then is to build it, as any choice has to.
///
/// # Errors
/// Those of [`make`].
pub fn make_watched(scene: &Scene, chosen: &mut dyn FnMut()) -> Result<Planned, String> {
    if [scene.punch.mechanical, scene.strip.mechanical] == [MechanicalBody::Rigid; 2] {
        return only_lumped(scene, "both bodies are rigid".into(), chosen);
    }
    let Some(course) = Course::new(scene) else {
        let reason = format!(
            "nominal.load = {} N and nominal.velocity = {} m/s leave nothing to compare levels with",
            scene.nominal_load, scene.nominal_velocity
        );
        return only_lumped(scene, reason, chosen).map(unknown);
    };
    if possible_on_the_cells(scene) {
        match explore(scene, &course, true) {
            Ok(findings) => return decide(scene, findings, chosen),
            // Where heat on the cells has no solution (friction that runs away, instability), its mean still has one.
            Err(reason) => {
                let reason = format!("nothing to compare the mean heat with: {reason}");
                let Ok(findings) = explore(scene, &course, false) else {
                    return only_lumped(scene, reason, chosen).map(unknown);
                };
                let mut planned = decide(scene, findings, chosen)?;
                planned.plan.reason = reason;
                return Ok(unknown(planned));
            }
        }
    }
    match explore(scene, &course, false) {
        Ok(findings) => decide(scene, findings, chosen),
        // The lumped level knows nothing of what the contact line refuses.
        Err(reason) => {
            let reason = format!("no contact line to compare with: {reason}");
            only_lumped(scene, reason, chosen).map(unknown)
        }
    }
}

/// A plan that nothing was compared for.
fn unknown(mut planned: Planned) -> Planned {
    (planned.plan.meets, planned.plan.estimated_error) = (false, UNKNOWN);
    planned
}

fn explore(scene: &Scene, course: &Course, by_cells: bool) -> Result<Findings, String> {
    let heat = if by_cells { HeatAlongContact::OnTheCells } else { HeatAlongContact::ByItsMean };
    let cells = if scene.cells > 0 { scene.cells } else { rung::CELLS[0] };
    let mut probed = course.scene(scene);
    let (low, high) = PROBE_TOLERANCE;
    let stepping = match scene.nominal_stroke > 0.0 {
        true => TO_AND_FRO.1,
        false => (LOOSER * scene.tolerance).clamp(low, high),
    };
    let low = if scene.nominal_stroke > 0.0 { TO_AND_FRO.0 } else { low };
    probed.tolerance = (LOOSER * scene.tolerance).clamp(low, high);
    let mut effort = Effort::default();
    let uniform = Operators::new(&Rung::Lumped.apply(&probed))?;
    let fine = uniform.line_beside(&Rung::Line { cells, heat }.apply(&probed))?;
    let [uniform, fine] = [uniform, fine].map(|operators| operators.stepping_to(stepping));
    effort.built(&uniform);
    effort.built(&fine);
    let most = effort.attempts(&fine);
    let (mut steps, mut paces) = (0, Vec::new());
    let mut probe = |rung: Option<Rung>, operators: &Operators| -> Result<Probe, String> {
        let probe = course.run(operators, most)?;
        steps += probe.steps;
        effort.stepped(probe.steps, operators);
        paces.extend(rung.map(|rung| (rung, effort::steps_of(scene, &probe))));
        Ok(probe)
    };
    let finest = probe(Some(Rung::Line { cells, heat }), &fine)?;
    if finest.history.is_empty() {
        return Err(format!("{most} internal steps do not reach the end of a thousandth of the nominal duration"));
    }
    let distance = |other: &Probe| course.distance(other, &finest).unwrap_or([UNKNOWN; 3]);
    let apart = distance(&probe(Some(Rung::Lumped), &uniform)?);
    let growth = course.growth(scene, &finest);
    // Cells are closer to each other than to the lumped level: where that is enough, nothing finer is asked.
    let enough = growth * (1.0 + REMAINDER) * largest(apart) <= LEVEL_SHARE * scene.tolerance;
    let closest = match fine.merged() {
        Some(merged) if !enough => distance(&probe(None, &merged)?),
        _ => apart,
    };
    let mean = HeatAlongContact::ByItsMean;
    let averaged = match by_cells {
        true => Some(distance(&probe(Some(Rung::Line { cells, heat: mean }), &fine.of_the_mean(stepping))?)),
        false => None,
    };
    let [apart, closest] = [apart, closest].map(|errors| grown(errors, growth));
    let averaged = averaged.map(|errors| grown(errors, growth));
    let own = closest.map(|apart| REMAINDER * apart);
    let add = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|output| a[output] + b[output]);
    let mut candidates = vec![Candidate { rung: Rung::Lumped, errors: add(apart, own), cost: rung::cost(1, None) }];
    let Operators::Line(line) = &fine else { return Err("the contact line is not one".into()) };
    let states = line.heat.as_ref().map(|bodies| bodies.states[0] + bodies.states[1]);
    let ladder = if scene.cells > 0 { vec![cells] } else { rung::CELLS.to_vec() };
    for count in ladder {
        let errors = own.map(|error| error * (cells as f64 / count as f64).powf(ORDER));
        if let Some(averaged) = averaged {
            let rung = Rung::Line { cells: count, heat: mean };
            candidates.push(Candidate { rung, errors: add(averaged, errors), cost: rung::cost(count, None) });
        }
        candidates.push(Candidate { rung: Rung::Line { cells: count, heat }, errors, cost: rung::cost(count, states) });
    }
    candidates.sort_by(|one, other| one.cost.total_cmp(&other.cost));
    let rise = finest.history.iter().map(|main| main[1].abs()).fold(0.0, f64::max);
    let covered = finest.covered / course.duration;
    effort.paces = paces;
    Ok(Findings { fine, candidates, rise, steps, covered, effort })
}

fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, f64::max)
}

/// Errors of a probe as those of the whole run: of the worn depth the probe has already seen the end.
fn grown([wear, temperature, force]: [f64; 3], growth: f64) -> [f64; 3] {
    [wear, growth * temperature, growth * force]
}

fn decide(scene: &Scene, findings: Findings, told: &mut dyn FnMut()) -> Result<Planned, String> {
    let enough = LEVEL_SHARE * scene.tolerance;
    let good = findings.candidates.iter().find(|candidate| candidate.error() <= enough);
    let best = findings.candidates.iter().min_by(|one, other| one.error().total_cmp(&other.error()));
    let Some(&chosen) = good.or(best) else { return Err("a plan without candidates".into()) };
    let reason = match good {
        Some(_) => "the cheapest whose estimated error is below the tolerance".to_owned(),
        None => format!("no rung has an estimated error below the tolerance; this one has {:.1e}", chosen.error()),
    };
    // One effect or one step finer.
    let on_cells = findings.candidates.iter().any(|known| known.rung.on_the_cells());
    let heat = if on_cells { HeatAlongContact::OnTheCells } else { HeatAlongContact::ByItsMean };
    let finer = |cells: usize| rung::CELLS.into_iter().find(|&count| count > cells && count <= FINEST_NEXT);
    let next = match chosen.rung {
        Rung::Lumped => Some(Rung::Line { cells: findings.fine.scene().cells, heat }),
        Rung::Line { cells, heat: HeatAlongContact::ByItsMean } if on_cells => Some(Rung::Line { cells, heat }),
        Rung::Line { cells, .. } if scene.cells == 0 => finer(cells).map(|cells| Rung::Line { cells, heat }),
        Rung::Line { .. } => None,
    };
    told();
    let prepared = match (next, scene.escalation) {
        (Some(next), Escalation::Prepared) => Some(Operators::new(&next.apply(scene))?),
        _ => None,
    };
    let operators = Operators::new(&chosen.rung.apply(scene))?;
    let groups = Groups::new(scene, findings.rise);
    let effects = effects::judge(scene, &groups, &findings.fine, &findings.candidates, chosen.rung);
    let (states, order, reduction_error) = made_of(&operators);
    let mut effort = findings.effort;
    effort.run = effort.steps(scene, chosen.rung) * rung::cost_per_step(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        rung: chosen.rung,
        meets: good.is_some(),
        reason,
        effects,
        groups,
        candidates: findings.candidates,
        states,
        order,
        estimated_error: chosen.error(),
        reduction_error,
        cost_per_step: rung::cost_per_step(&operators),
        probe_steps: findings.steps,
        covered: findings.covered,
        effort,
        rise: findings.rise,
        next,
    };
    Ok(Planned { plan, operators, prepared })
}

fn only_lumped(scene: &Scene, reason: String, chosen: &mut dyn FnMut()) -> Result<Planned, String> {
    chosen();
    let operators = Operators::new(&Rung::Lumped.apply(scene))?;
    let (states, order, reduction_error) = made_of(&operators);
    let mut effort = Effort::default();
    effort.built(&operators);
    effort.run = effort.steps(scene, Rung::Lumped) * rung::cost_per_step(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        rung: Rung::Lumped,
        meets: true,
        reason,
        effects: Vec::new(),
        groups: Groups::new(scene, 0.0),
        candidates: Vec::new(),
        states,
        order,
        estimated_error: 0.0,
        reduction_error,
        cost_per_step: rung::cost_per_step(&operators),
        probe_steps: 0,
        covered: 0.0,
        effort,
        rise: 0.0,
        next: None,
    };
    Ok(Planned { plan, operators, prepared: None })
}

/// Thermal states of punch, strip and moving source, order of the time steps, error of the reduced bodies.
fn made_of(operators: &Operators) -> ([usize; 3], u8, f64) {
    let (mean, line, order) = match operators {
        Operators::Lumped(mean) => (mean, None, 3),
        Operators::Line(line) => (&line.mean, line.heat.as_ref(), 2),
    };
    if let Some(bodies) = line {
        return ([bodies.states[0], bodies.states[1], 0], order, bodies.error);
    }
    let bodies = [&mean.punch, &mean.strip].map(|body| body.heat.as_ref());
    let [punch, strip] = bodies.map(|heat| heat.map_or(0, |heat| heat.count));
    let source = mean.flash.as_ref().map_or(0, |flash| flash.decays.rate.len());
    let error = bodies.into_iter().flatten().map(|heat| heat.error).fold(0.0, f64::max);
    ([punch, strip, source], order, error)
}
