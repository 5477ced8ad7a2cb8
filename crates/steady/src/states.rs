//! Steady state of a scene.
//!
//! Theory: docs/theory.md, section 9.

use super::{CycleProblem, ReciprocatingProblem, SteadyError, groove, groove_operator, positive, punch_run_in};
use contact::friction::{FrictionLaw, OperatingPoint};
use contact::wear::law::WearLaw;
use contact::wear::line::{CellRate, Coefficient, Direction, WearTerm};
use contact::wear::rocking::rocking_limit;
use contact::{ContactError, ContactSolver, Normal, Tilt, pair_compliance};
use elasticity::discretization::{load_weights, relative_radii};
use elasticity::{Cells, Compliance};
use model::line::profile::initial_gap;
use nalgebra::{DMatrix, DVector};
use scene::{Body, Constraint, Geometry, MechanicalBody, Path, Scene};

/// Sliding motion of the punch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sliding {
    /// Unidirectional sliding of unlimited duration, at this velocity in m/s, signed.
    Unidirectional {
        /// Velocity v, m/s.
        velocity: f64,
    },
    /// Reciprocating sliding, forward and backward half-strokes.
    Reciprocating {
        /// Lengths of the half-strokes, in m.
        strokes: [f64; 2],
        /// Speeds on them, in m/s.
        speeds: [f64; 2],
    },
}

impl Sliding {
    /// Nominal sliding of the scene: reciprocating where it has a stroke.
    pub fn nominal(scene: &Scene) -> Sliding {
        let velocity = scene.nominal_velocity;
        match scene.nominal_stroke > 0.0 {
            true => Sliding::Reciprocating { strokes: [scene.nominal_stroke; 2], speeds: [velocity.abs(); 2] },
            false => Sliding::Unidirectional { velocity },
        }
    }

    fn check(&self) -> Result<(), SteadyError> {
        match *self {
            Sliding::Unidirectional { velocity } => positive("sliding speed", velocity.abs()),
            Sliding::Reciprocating { strokes, speeds } => {
                strokes.iter().try_for_each(|&stroke| positive("length of a half-stroke", stroke))?;
                speeds.iter().try_for_each(|&speed| positive("sliding speed", speed))
            }
        }
    }

    /// Velocity and duration of every stroke; unidirectional sliding is one stroke of 1 s.
    fn strokes(&self) -> Vec<(f64, f64)> {
        match *self {
            Sliding::Unidirectional { velocity } => vec![(velocity, 1.0)],
            Sliding::Reciprocating { strokes, speeds } => {
                vec![(speeds[0], strokes[0] / speeds[0]), (-speeds[1], strokes[1] / speeds[1])]
            }
        }
    }
}

/// Kind of steady state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SteadyKind {
    /// The wear of the punch (on an annulus also of the strip) is a rigid motion.
    RunIn,
    /// The strip enters unworn and leaves a steady groove; the punch does not wear.
    Groove,
    /// Uniform wear along a closed path, without a change of shape: the pressure is elastic.
    Elastic,
}

/// Pressure of one direction of sliding.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyStroke {
    /// Sliding velocity, in m/s.
    pub velocity: f64,
    /// Length of the half-stroke, in s; 1 for unidirectional sliding.
    pub duration: f64,
    /// Friction coefficient with the sign of the velocity, `s mu`.
    pub friction: f64,
    /// N cell means of the pressure, in Pa.
    pub pressure: Vec<f64>,
    /// Approach, in m, for the shape's minimum 0. Half-planes: up to a constant per load.
    pub approach: f64,
    /// Tilt, in rad, positive lowers the +x edge; 0 for a run-in state whose tilt is arbitrary because the punch wears
    /// (unidirectional).
    pub tilt: f64,
    /// Wear depth rates of punch and strip in this direction, N cell values each, in m/s; of the strip where it is in contact.
    pub wear_rates: [Vec<f64>; 2],
}

/// Steady state of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyState {
    /// Kind of the state.
    pub kind: SteadyKind,
    /// One stroke (unidirectional) or two (forward, backward).
    pub strokes: Vec<SteadyStroke>,
    /// Gap of the unloaded bodies by the punch: its initial shape and worn depth; N cell means, in m, minimum 0 where it is run
    /// in.
    pub shape: Vec<f64>,
    /// Depth of the strip's groove under the cells, in m; 0 on a closed path and in reciprocating sliding.
    pub groove: Vec<f64>,
    /// Mean wear depth rate of the punch over contact and time, in m/s.
    pub punch_wear_rate: f64,
    /// Worn volumes of punch and strip per time, all punches and faces, in m3/s.
    pub volume_rates: [f64; 2],
    /// Wear dissipation power, `integral p dw/dt` of both bodies over contact, cycle mean, all punches and faces, in W.
    pub dissipation_power: f64,
    /// Friction power, likewise, in W.
    pub friction_power: f64,
}

/// Steady state of a scene under its nominal load, on the given cells with the compliances of punch and strip
/// ([`elasticity::discretization::compliances`]).
///
/// Without heat: friction and wear at the ambient temperature. Wear is multiplied by `wear_acceleration`. The nominal load is
/// that on the contact, for any holder stiffness. The wear per stroke is taken as vanishing against the elastic displacements:
/// the error is the change of the pressure within a stroke.
///
/// | sliding | wears | state |
/// |---|---|---|
/// | unidirectional | punch (both) | depth rate a rigid motion; the shape includes the strip's groove on a straight path |
/// | unidirectional | strip, straight path | steady groove under the initial shape |
/// | reciprocating | punch (closed path: both) | pair of pressures over one shape, uniform wear over the cycle |
/// | any | strip, closed path | elastic pressure on the initial shape |
/// | annular | punch and strip, the strip diluted by the covered part of the circle | p = C r^(-a/b) for one law |
/// | periodic | punch | uniform pressure |
///
/// # Errors
/// States that do not exist: nothing wears, a wearing strip on a straight reciprocating track, tipping, a tilt
/// that wear increases without bound; two rigid bodies; values out of range.
pub fn steady_state(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    sliding: &Sliding,
) -> Result<SteadyState, SteadyError> {
    positive("nominal.load", scene.nominal_load)?;
    sliding.check()?;
    if [scene.punch.mechanical, scene.strip.mechanical] == [MechanicalBody::Rigid; 2] {
        return Err(ContactError::Rigid.into());
    }
    Contact::new(scene, cells, compliances, sliding).solve()
}

/// Shape of the run-in punch under nominal load and sliding: gap of the unloaded bodies, N cell means, in m, minimum 0.
///
/// # Errors
/// Those of [`steady_state`], and [`SteadyError::OnlyStripWears`] where the punch would keep its shape.
pub fn run_in_shape(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<Vec<f64>, SteadyError> {
    let state = steady_state(scene, cells, compliances, &Sliding::nominal(scene))?;
    match state.kind {
        SteadyKind::RunIn => Ok(state.shape),
        SteadyKind::Groove | SteadyKind::Elastic => Err(SteadyError::OnlyStripWears),
    }
}

/// Stroke without its pressure.
pub(crate) struct Stroke {
    pub(crate) velocity: f64,
    duration: f64,
    /// s mu.
    pub(crate) friction: f64,
    /// Wear depth rates of punch and strip.
    pub(crate) rates: [CellRate; 2],
}

pub(crate) struct Contact<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) cells: &'a Cells,
    compliances: &'a [Compliance; 2],
    pub(crate) weights: Vec<f64>,
    pub(crate) strokes: Vec<Stroke>,
    /// Load of one punch per depth, in N/m.
    pub(crate) load: f64,
}

impl<'a> Contact<'a> {
    pub(crate) fn new(scene: &'a Scene, cells: &'a Cells, compliances: &'a [Compliance; 2], sliding: &Sliding) -> Self {
        let law = FrictionLaw::new(scene);
        let kinetic_coefficient: f64 = law.kinetic_coefficient(scene.ambient_temperature);
        let radii = relative_radii(scene, cells);
        let pressure = scene.nominal_pressure();
        let stroke = |(velocity, duration): (f64, f64)| Stroke {
            velocity,
            duration,
            friction: kinetic_coefficient * law.stribeck(OperatingPoint { velocity, pressure }) * law.sign(velocity),
            rates: [&scene.punch, &scene.strip]
                .map(|body| depth_rate(scene, body, &radii, velocity, kinetic_coefficient)),
        };
        Self {
            scene,
            cells,
            compliances,
            weights: load_weights(scene, cells),
            strokes: sliding.strokes().into_iter().map(stroke).collect(),
            load: scene.nominal_load / (scene.count * scene.depth),
        }
    }

    fn solve(&self) -> Result<SteadyState, SteadyError> {
        let closed = self.scene.path == Path::Closed;
        let wears = |body: &Body| body.wear_coefficient > 0.0;
        let (punch, strip) = (wears(&self.scene.punch), wears(&self.scene.strip));
        let annular = self.scene.geometry == Geometry::Annular;
        if !punch && !strip {
            return Err(SteadyError::NothingWears);
        }
        if !punch && closed && !annular {
            return self.elastic();
        }
        // The shape of these states is found from wear alone, by a law without a range of pressures that do not wear.
        for body in 0..if annular { 2 } else { 1 } {
            self.exponent(body)?;
        }
        if annular || self.scene.geometry == Geometry::Periodic {
            return self.without_shift();
        }
        if self.strokes.len() == 1 {
            return if punch { self.unidirectional() } else { self.groove() };
        }
        // The ends of a straight track are rarely in contact. On a closed path the strip wears evenly along the path.
        if strip && !closed {
            let (stroke, width) = (self.scene.nominal_stroke, self.scene.width);
            return Err(SteadyError::WearingStripReciprocating { stroke, width });
        }
        self.reciprocating()
    }

    /// Exponent of the pressure in the wear law of a body (0: punch, 1: strip); 1 without wear.
    fn exponent(&self, body: usize) -> Result<f64, SteadyError> {
        let power = self.strokes[0].rates[body].terms.first().map_or(Ok(1.0), |term| term.law.as_power());
        let body = ["punch", "strip"][body];
        power.map_err(|parameter| {
            let text = format!(
                "no run-in state with {body}.{parameter}: it is known for wear by a power of the pressure alone"
            );
            SteadyError::Other(text)
        })
    }

    /// Pivot height where friction exerts a moment on the punch.
    fn pivot_height(&self) -> Option<f64> {
        (self.scene.constraint == Constraint::TranslateAndRotate).then_some(self.scene.pivot_height)
    }

    pub(crate) fn tilt(&self, stroke: &Stroke) -> Tilt {
        match self.pivot_height() {
            None => Tilt::Fixed(0.0),
            // Friction acts normal to the line.
            Some(_) if self.scene.geometry == Geometry::Annular => Tilt::ResultantAt(0.0),
            Some(height) => Tilt::ResultantAt(stroke.friction * height),
        }
    }

    pub(crate) fn compliance(&self, stroke: &Stroke) -> DMatrix<f64> {
        let [punch, strip] = self.compliances;
        pair_compliance(punch, strip, stroke.friction)
    }

    pub(crate) fn groove_depth(&self, stroke: &Stroke, pressure: &[f64]) -> Vec<f64> {
        let rate = per_distance(&stroke.rates[1], stroke.velocity);
        let depth = DVector::from_fn(pressure.len(), |i, _| rate.rate(i, pressure[i]));
        (groove_operator(self.cells, direction(stroke.velocity)) * depth).as_slice().to_vec()
    }

    fn unidirectional(&self) -> Result<SteadyState, SteadyError> {
        let stroke = &self.strokes[0];
        let run_in = punch_run_in(self.cells, &self.weights, &stroke.rates[0], self.load, self.tilt(stroke))?;
        let groove = match self.scene.path {
            Path::Straight => self.groove_depth(stroke, &run_in.pressure),
            Path::Closed => vec![0.0; self.cells.count()],
        };
        let shape = run_in.shape(&groove, &self.compliance(stroke));
        Ok(self.state(SteadyKind::RunIn, vec![run_in.pressure], shape, groove))
    }

    fn groove(&self) -> Result<SteadyState, SteadyError> {
        let stroke = &self.strokes[0];
        let gap = initial_gap(self.scene, self.cells);
        let rate = per_distance(&stroke.rates[1], stroke.velocity);
        let direction = direction(stroke.velocity);
        let load = Normal::Load(self.load);
        let state = groove(self.cells, self.compliance(stroke), &gap, rate, direction, load, self.tilt(stroke))?;
        let groove = self.groove_depth(stroke, &state.pressure);
        Ok(self.state(SteadyKind::Groove, vec![state.pressure], gap, groove))
    }

    fn elastic(&self) -> Result<SteadyState, SteadyError> {
        let gap = initial_gap(self.scene, self.cells);
        let pressure = |stroke: &Stroke| -> Result<Vec<f64>, SteadyError> {
            let mut solver = ContactSolver::with_weights(self.cells, &self.weights, self.compliance(stroke))?;
            Ok(solver.solve(&gap, Normal::Load(self.load), self.tilt(stroke))?.pressure)
        };
        let pressures = self.strokes.iter().map(pressure).collect::<Result<_, _>>()?;
        Ok(self.state(SteadyKind::Elastic, pressures, gap, vec![0.0; self.cells.count()]))
    }

    /// Steady state of annular and periodic contact, in which friction does not shift the pressure: the same in all strokes.
    fn without_shift(&self) -> Result<SteadyState, SteadyError> {
        // The strip of an annulus wears where it is covered, at fixed radius.
        let annular = self.scene.geometry == Geometry::Annular;
        let total: f64 = self.strokes.iter().map(|stroke| stroke.duration).sum();
        let mut terms = Vec::new();
        for stroke in &self.strokes {
            let shares = [1.0, if annular { self.scene.coverage() } else { 0.0 }];
            for (rate, share) in stroke.rates.iter().zip(shares).filter(|(_, share)| *share > 0.0) {
                terms.extend(rate.terms.iter().map(|term| WearTerm {
                    coefficient: scaled(&term.coefficient, share * stroke.duration / total),
                    law: term.law,
                }));
            }
        }
        let rate = CellRate::of_bodies(terms);
        let run_in = punch_run_in(self.cells, &self.weights, &rate, self.load, self.tilt(&self.strokes[0]))?;
        let shape = run_in.shape(&vec![0.0; self.cells.count()], &self.compliance(&self.strokes[0]));
        let pressures = vec![run_in.pressure; self.strokes.len()];
        Ok(self.state(SteadyKind::RunIn, pressures, shape, vec![0.0; self.cells.count()]))
    }

    fn reciprocating(&self) -> Result<SteadyState, SteadyError> {
        let [punch, strip] = self.compliances;
        let [forward, backward] = [&self.strokes[0], &self.strokes[1]];
        let friction = [forward.friction, -backward.friction];
        let exponent = self.exponent(0)?;
        // Durations at the rate of the forward speed with the wear of the strokes.
        let coefficient = |stroke: &Stroke| stroke.rates[0].terms[0].coefficient.at(0);
        let durations = [forward, backward].map(|stroke| stroke.duration * coefficient(stroke) / coefficient(forward));
        let equal = |pair: [f64; 2]| (pair[0] - pair[1]).abs() <= 1e-14 * (pair[0] + pair[1]);
        let symmetric = equal(durations) && equal(friction);
        let pivot_height = self.pivot_height();
        if let (Some(height), true) = (pivot_height, symmetric) {
            let (lever, limit) = (friction[0] * height, rocking_limit(exponent) * self.cells.half_width());
            if lever >= limit {
                return Err(SteadyError::RocksItselfRound { lever, limit, exponent });
            }
        }
        let (pressures, shape) = if symmetric && forward.rates[0].is_linear() {
            let problem = ReciprocatingProblem {
                cells: self.cells,
                punch,
                strip,
                friction: friction[0],
                load: self.load,
                pivot_height,
                wear_per_stroke: 0.0,
            };
            let cycle = problem.solve()?;
            (vec![cycle.forward, cycle.backward], cycle.shape)
        } else {
            let problem = CycleProblem {
                cells: self.cells,
                punch,
                strip,
                friction,
                load: self.load,
                pivot_height,
                rate: &forward.rates[0],
                durations,
            };
            let cycle = problem.solve()?;
            (vec![cycle.forward, cycle.backward], cycle.shape)
        };
        Ok(self.state(SteadyKind::RunIn, pressures, shape, vec![0.0; self.cells.count()]))
    }

    pub(crate) fn state(
        &self,
        kind: SteadyKind,
        pressures: Vec<Vec<f64>>,
        shape: Vec<f64>,
        groove: Vec<f64>,
    ) -> SteadyState {
        let mut strokes = Vec::with_capacity(pressures.len());
        for (stroke, pressure) in self.strokes.iter().zip(pressures) {
            let rates = stroke
                .rates
                .each_ref()
                .map(|rate| pressure.iter().enumerate().map(|(i, &p)| rate.rate(i, p)).collect::<Vec<f64>>());
            let (approach, tilt) = self.rigid_motion(stroke, &pressure, &shape, &groove);
            let Stroke { velocity, duration, friction, .. } = *stroke;
            strokes.push(SteadyStroke { velocity, duration, friction, pressure, approach, tilt, wear_rates: rates });
        }
        let total: f64 = strokes.iter().map(|stroke| stroke.duration).sum();
        let mean = |value: &dyn Fn(&SteadyStroke, usize) -> f64| -> f64 {
            let one = |stroke: &SteadyStroke| -> f64 {
                stroke.duration * (0..self.weights.len()).map(|i| self.weights[i] * value(stroke, i)).sum::<f64>()
            };
            // From 0, because the empty sum of floats is -0.
            strokes.iter().map(one).fold(0.0, |sum, value| sum + value) / total
        };
        let radii = relative_radii(self.scene, self.cells);
        let all = self.scene.depth * self.scene.count * self.scene.faces;
        let width: f64 = self.weights.iter().sum();
        let punch = mean(&|stroke, i| stroke.wear_rates[0][i]);
        SteadyState {
            kind,
            punch_wear_rate: punch / width,
            volume_rates: [punch * all, mean(&|stroke, i| stroke.wear_rates[1][i]) * all],
            dissipation_power: all
                * mean(&|stroke, i| stroke.pressure[i] * (stroke.wear_rates[0][i] + stroke.wear_rates[1][i])),
            friction_power: all * mean(&|stroke, i| stroke.pressure[i] * stroke.friction * stroke.velocity * radii[i]),
            strokes,
            shape,
            groove,
        }
    }

    /// Approach and tilt in contact: the straight line through `gap + A p` of the cells in contact.
    fn rigid_motion(&self, stroke: &Stroke, pressure: &[f64], shape: &[f64], groove: &[f64]) -> (f64, f64) {
        let displacement = self.compliance(stroke) * DVector::from_column_slice(pressure);
        let x = self.cells.centres();
        let touching = || (0..x.len()).filter(|&i| pressure[i] > 0.0);
        let sum = |value: &dyn Fn(usize) -> f64| -> f64 { touching().map(|i| self.weights[i] * value(i)).sum() };
        let level = |i: usize| shape[i] + groove[i] + displacement[i];
        let total = sum(&|_| 1.0);
        let (centre, mean) = (sum(&|i| x[i]) / total, sum(&level) / total);
        let spread = sum(&|i| (x[i] - centre).powi(2));
        let rotates = self.pivot_height().is_some() && spread > 0.0;
        let tilt = if rotates { sum(&|i| (x[i] - centre) * (level(i) - mean)) / spread } else { 0.0 };
        (mean - tilt * centre, tilt)
    }
}

pub(crate) fn direction(velocity: f64) -> Direction {
    if velocity < 0.0 { Direction::Backward } else { Direction::Forward }
}

/// Wear depth rate of a body on the cells at a sliding velocity and the ambient temperature, in m/s.
pub(crate) fn depth_rate(scene: &Scene, body: &Body, radii: &[f64], velocity: f64, friction: f64) -> CellRate {
    let law = WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade);
    let factors = radii.iter().map(|radius| {
        scene.wear_acceleration * law.coefficient(velocity.abs() * radius, friction, scene.ambient_temperature)
    });
    of_law(&law, factors)
}

/// Wear depth rate by this law with these factors of its dependence on the pressure, by cell.
pub(crate) fn of_law(law: &WearLaw, factors: impl Iterator<Item = f64>) -> CellRate {
    let term = WearTerm { coefficient: factors.collect::<Vec<f64>>().into(), law: law.pressure };
    CellRate::of_bodies(if law.active() { vec![term] } else { Vec::new() })
}

/// Wear depth of a body per sliding distance.
pub(crate) fn per_distance(rate: &CellRate, velocity: f64) -> CellRate {
    let slower =
        |term: &WearTerm| WearTerm { coefficient: scaled(&term.coefficient, 1.0 / velocity.abs()), law: term.law };
    CellRate { reference_pressure: rate.reference_pressure, terms: rate.terms.iter().map(slower).collect() }
}

fn scaled(coefficient: &Coefficient, factor: f64) -> Coefficient {
    match coefficient {
        Coefficient::Uniform(value) => Coefficient::Uniform(factor * value),
        Coefficient::PerCell(values) => Coefficient::PerCell(values.iter().map(|value| factor * value).collect()),
    }
}
