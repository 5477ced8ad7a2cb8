//! Operators of the contact line, built once from the scene and shared by all its states.
//!
//! Theory: docs/theory.md, sections 2.5, 3.1, 8.1.

use super::heat::bodies::{Bodies, is_resolved};
use super::heat::edges::{Edges, Worn};
use super::hottest::Hottest;
use super::profile::{Profile, initial_gap};
use crate::fastest_growth::FastestGrowth;
use crate::growth::grows_otherwise;
use crate::lumped;
use crate::lumped::conditions::Tunables;
use crate::tolerance::ToleranceBudget;
use conduction::line::strip::Reductions;
use contact::wear::law::WearLaw;
use contact::wear::line::{CellRate, Coefficient, Conditions, WearTerm, WearingContact};
use contact::wear::rocking::rocking_limit;
use contact::{ContactState, Normal, Tilt, check_operators};
use elasticity::block::Block;
use elasticity::discretization::{cells_for, compliances_with, load_weights, punch_block_among, relative_radii};
use elasticity::tangential::tangential_compliances_with;
use elasticity::{Cells, Compliance};
use nalgebra::DMatrix;
use scene::message::Number;
use scene::{Constraint, FadeTable, Geometry, InitialShape, Path, Scene};
use std::sync::Arc;

/// Number of cells for a tolerance: its error is mostly below it, and stated where it is not.
fn cells_of(tolerance: f64) -> usize {
    match tolerance {
        5e-3.. => 17,
        5e-4.. => 33,
        5e-5.. => 65,
        _ => 129,
    }
}

/// Evolution of the strip's worn depth under the punch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StripWear {
    /// No wear.
    None,
    /// Closed path: uniform wear along the path, one depth for all cells, because every point passes through the contact.
    Even,
    /// Annular contact: one depth per radius.
    ByRadius,
    /// Straight path: a worn track in the strip's own coordinate.
    Track,
}

impl StripWear {
    fn of(scene: &Scene) -> StripWear {
        match (scene.strip.wear_coefficient > 0.0, scene.geometry, scene.path) {
            (false, ..) => StripWear::None,
            (true, Geometry::Annular, _) => StripWear::ByRadius,
            (true, _, Path::Closed) => StripWear::Even,
            (true, _, Path::Straight) => StripWear::Track,
        }
    }
}

/// Wear laws of punch and strip.
fn wear_laws(scene: &Scene) -> [WearLaw; 2] {
    [&scene.punch, &scene.strip].map(|body| WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade))
}

/// Width of the smallest cell, m.
fn smallest(cells: &Cells) -> f64 {
    cells.widths().iter().copied().fold(f64::INFINITY, f64::min)
}

/// Nonuniformity of a pressure, relative to its mean.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Nonuniformity {
    /// Root mean square of its deviation from the mean.
    pub pressure: f64,
    /// Root mean square of the change by shear coupling.
    pub shear: f64,
    /// Root mean square of the change by the moment about the pivot.
    pub rotation: f64,
}

/// Operators of the contact line.
#[derive(Clone, Debug)]
pub struct LineOperators {
    /// Scene from which the operators were built.
    pub scene: Scene,
    /// What its errors may reach of its tolerance.
    pub budget: ToleranceBudget,
    /// Operators of the lumped level: heat, friction and everything else that depends on the mean pressure.
    pub mean: Arc<lumped::operators::LumpedOperators>,
    /// Conducting bodies of resolved heat; `None`: lumped heat.
    pub heat: Option<Arc<Bodies>>,
    /// Bound of the growth rate of thermoelastic waves on the cells.
    pub(crate) growth_bound: FastestGrowth,
    /// Cells of the contact.
    pub cells: Cells,
    /// Weights of the load integral, m: areas of the cells per depth.
    pub weights: Vec<f64>,
    /// Weights of the torque over the mean radius, m.
    pub torque_weights: Vec<f64>,
    /// r/r_m of the cells; all 1 but in annular geometry.
    pub radius_ratio: Vec<f64>,
    /// Wear depth rate of punch and strip on the cells relative to that at the mean radius.
    pub radial: [Vec<f64>; 2],
    /// Gap of the unworn bodies, N cell means, m.
    pub initial_gap: Vec<f64>,
    /// Normal compliance of both bodies and shear coupling (strip less punch), N x N, m/Pa.
    normal: DMatrix<f64>,
    shear: DMatrix<f64>,
    /// Displacement of the faces against each other along the sliding direction per shear traction, N x N, m/Pa, where elastic slip
    /// depends on the pressure along the line.
    tangential: Option<DMatrix<f64>>,
    /// Displacement per mean pressure (m/Pa): scale of the error of a worn shape.
    pub displacement_scale: f64,
    /// Wear laws of punch and strip, with the factor of the mean over the path.
    pub wear: [(WearLaw, f64); 2],
    /// Evolution of the strip's worn depth.
    pub strip_wear: StripWear,
    /// Stations of the profiles.
    pub profile: Profile,
    /// Intervals of the highest contact temperature.
    pub hottest: Hottest,
    /// Length that converts load per face into load per depth: depth times number of punches, m.
    pub shared_depth: f64,
    /// Pivot height where the punch can rotate and friction exerts a moment, m.
    pub pivot: Option<f64>,
    /// The tilt is free.
    pub rotates: bool,
}

/// What does not depend on the cells of contact lines, or serves several: made once for all lines of an initialisation.
#[derive(Debug, Default)]
pub struct Shared {
    blocks: Vec<Arc<Block>>,
    strips: Reductions,
}

/// Finds the gap of a run-in punch, N cell means in m, of a scene with or without (`false`) resolved heat. Steady states are a layer above
/// this one, so whoever builds operators passes the function that finds them.
pub(crate) type RunIn = fn(&Scene, bool, &Cells, &[Compliance; 2]) -> Result<Vec<f64>, String>;

impl LineOperators {
    /// Builds the contact line of `scene`.
    ///
    /// # Errors
    /// A text with the numbers where the bodies or the run-in shape do not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<LineOperators, String> {
        Self::with_heat(scene, is_resolved(scene), run_in)
    }

    /// Builds the contact line with what it shares with `known`, [`lumped::operators::LumpedOperators::beside`], and with other lines.
    ///
    /// # Errors
    /// As [`LineOperators::new`].
    pub(crate) fn beside(
        scene: &Scene,
        known: Option<&lumped::operators::LumpedOperators>,
        shared: &mut Shared,
        run_in: RunIn,
    ) -> Result<LineOperators, String> {
        Self::build(scene, is_resolved(scene), known, shared, run_in)
    }

    /// Builds the contact line with resolved or lumped heat, whether heat feeds back or not.
    ///
    /// # Errors
    /// As [`LineOperators::new`].
    pub fn with_heat(scene: &Scene, heat: bool, run_in: RunIn) -> Result<LineOperators, String> {
        Self::build(scene, heat, None, &mut Shared::default(), run_in)
    }

    /// Sets a tolerance at which the step control accepts every step.
    pub(super) fn accept_any_step(&mut self) {
        self.scene.tolerance = 1e6;
        self.budget = ToleranceBudget::of(&self.scene);
    }

    /// Finds the edges of the contact within cells.
    pub(crate) fn edges(&self) -> Edges {
        let closed_ring = self.scene.geometry == Geometry::Periodic;
        Edges::new(self.cells.widths(), closed_ring, |i, j| self.normal[(i, j)])
    }

    /// Of the worn depths of punch and strip (m), those that shape the contact along the line.
    pub(crate) fn shaping<'a>(&self, punch: &'a [f64], strip: &'a [f64]) -> Worn<'a> {
        Worn { punch, strip: (self.scene.geometry == Geometry::Annular).then_some(strip) }
    }

    fn build(
        scene: &Scene,
        heat: bool,
        known: Option<&lumped::operators::LumpedOperators>,
        shared: &mut Shared,
        run_in: RunIn,
    ) -> Result<LineOperators, String> {
        let count = if scene.cells == 0 { cells_of(scene.tolerance) } else { scene.cells };
        let cells = cells_for(scene, count).map_err(|error| error.to_string())?;
        let weights = load_weights(scene, &cells);
        let radius_ratio = relative_radii(scene, &cells);
        let block = punch_block_among(&mut shared.blocks, scene, &cells, heat).map_err(|error| error.to_string())?;
        let block = block.as_deref();
        let bodies = compliances_with(scene, &cells, block).map_err(|error| error.to_string())?;
        let [punch, strip] = &bodies;
        let mut initial_gap = initial_gap(scene, &cells);
        if scene.initial_shape == InitialShape::RunIn {
            initial_gap = run_in(scene, heat, &cells, &bodies)
                .map_err(|error| format!("contact.initial_shape = run_in: {error}"))?;
        }
        let tangential = if scene.elastic_slip && scene.geometry != Geometry::Annular {
            let [punch, strip] =
                tangential_compliances_with(scene, &cells, block).map_err(|error| error.to_string())?;
            Some(punch.to_far_face + strip.to_far_face)
        } else {
            None
        };
        let normal = &punch.normal + &strip.normal;
        let shear = &strip.shear - &punch.shear;
        let profile_pressure = nalgebra::DVector::from_fn(count, |i, _| match count {
            1 => 1.0,
            _ => cells.centres()[i] / cells.half_width(),
        });
        let displacement: Vec<f64> = (&normal * profile_pressure).iter().map(|u| u * u).collect();
        let displacement_scale = (cells.integral(&displacement) / (2.0 * cells.half_width())).sqrt();
        // Checks the matrices once.
        check_operators(count, &normal, &shear).map_err(|error| error.to_string())?;
        let laws = wear_laws(scene);
        let radial = laws.each_ref().map(|law| radius_ratio.iter().map(|&ratio| law.by_radius(ratio)).collect());
        let coverage = if scene.path == Path::Closed { scene.coverage() } else { 1.0 };
        let rotates = scene.constraint == Constraint::TranslateAndRotate;
        let pressed = normal.column_sum();
        let compliance = cells.integral(pressed.as_slice()) / (2.0 * cells.half_width());
        let moves = !heat || scene.stick_stiffness > 0.0 || scene.elastic_slip;
        let mean = lumped::operators::LumpedOperators::build(&mean_scene(scene, heat), compliance, moves, known);
        let mean = Arc::new(mean);
        let heat = heat.then(|| Bodies::new(scene, &cells, block, &mut shared.strips).map(Arc::new)).transpose()?;
        let [punch, strip] = laws;
        let operators = LineOperators {
            heat,
            growth_bound: FastestGrowth::new(scene, smallest(&cells)),
            profile: Profile::new(&cells),
            hottest: Hottest::new(&cells, scene.geometry == Geometry::Periodic),
            wear: [(punch, 1.0), (strip, coverage)],
            shared_depth: scene.depth * scene.count,
            pivot: (rotates && scene.geometry == Geometry::Line).then_some(scene.pivot_height),
            scene: scene.clone(),
            budget: ToleranceBudget::of(scene),
            mean,
            cells,
            torque_weights: weights.iter().zip(&radius_ratio).map(|(weight, ratio)| weight * ratio).collect(),
            weights,
            radius_ratio,
            radial,
            initial_gap,
            normal,
            shear,
            tangential,
            displacement_scale,
            strip_wear: StripWear::of(scene),
            rotates,
        };
        operators.check_acceleration(scene.friction_coefficient, scene.wear_acceleration)?;
        Ok(operators)
    }

    /// These operators with other wear coefficients, convection, heat paths or conductance, those of `scene`: states keep their
    /// meaning. The strip keeps a track that it has.
    pub(crate) fn tuned(&self, scene: Scene) -> LineOperators {
        let [punch, strip] = wear_laws(&scene);
        let keeps = self.strip_wear == StripWear::Track;
        let growth_bound = match grows_otherwise(&self.scene, &scene) {
            true => FastestGrowth::new(&scene, smallest(&self.cells)),
            false => self.growth_bound.clone(),
        };
        let of_mean = Tunables { wear_coefficient: [0.0; 2], ..Tunables::of(&scene) }.tuned(&self.mean.scene);
        LineOperators {
            mean: of_mean.map_or_else(|| self.mean.clone(), |scene| Arc::new(self.mean.tuned(scene))),
            growth_bound,
            wear: [(punch, self.wear[0].1), (strip, self.wear[1].1)],
            strip_wear: if keeps { StripWear::Track } else { StripWear::of(&scene) },
            scene,
            ..self.clone()
        }
    }

    /// Checks that the states are enough for a scene to which the operators are to be tuned.
    ///
    /// # Errors
    /// A text with variable, value and limit.
    pub(crate) fn check_tuned(&self, scene: &Scene) -> Result<(), String> {
        if StripWear::of(scene) == StripWear::Track && self.strip_wear != StripWear::Track {
            return Err(format!(
                "strip.wear_coefficient = {} m2/N must have been above 0 at initialisation: with strip.path = straight a contact \
                 line keeps the worn track of the strip from the start",
                Number(scene.strip.wear_coefficient)
            ));
        }
        Ok(())
    }

    /// Number of cells N.
    pub fn count(&self) -> usize {
        self.cells.count()
    }

    /// Whether friction or wear of a cell depend on its local contact temperature.
    pub(crate) fn wears_by_cell(&self) -> bool {
        let fades = !self.scene.friction_fade.flat;
        self.heat.is_some() && self.wear.iter().any(|(law, _)| law.active() && law.follows_temperature(fades))
    }

    /// Contact problem before the first step, with its own workspace.
    pub(crate) fn contact(&self) -> WearingContact {
        let (normal, shear) = (self.normal.clone(), self.shear.clone());
        let mut contact = WearingContact::new(&self.cells, &self.weights, normal, shear, self.initial_gap.clone())
            .expect("the same matrices were accepted when the operators were made");
        if self.strip_wear == StripWear::Track {
            // The first operator allocates memory for all later ones.
            contact.set_operator(Some(&DMatrix::identity(self.count(), self.count())));
        }
        contact
    }

    /// Conditions of an unloaded contact, with a wear term for every body that reshapes it.
    pub(crate) fn conditions(&self) -> Conditions {
        let term = |body: usize| WearTerm {
            coefficient: match self.scene.geometry {
                _ if self.wears_by_cell() => Coefficient::PerCell(vec![0.0; self.count()]),
                Geometry::Annular => Coefficient::PerCell(vec![0.0; self.count()]),
                _ => Coefficient::Uniform(0.0),
            },
            law: self.wear[body].0.pressure,
        };
        let terms = (0..2).filter(|&body| self.reshapes(body)).map(term).collect();
        Conditions {
            signed_friction: 0.0,
            normal: Normal::Load(0.0),
            tilt: Tilt::Fixed(0.0),
            rate: CellRate::of_bodies(terms),
        }
    }

    /// Load per face (N) that determines heat and friction at the lumped level: the contact's, on an annulus by its torque.
    pub(crate) fn carried(&self, pressure: &[f64]) -> f64 {
        let (mut torque, mut load) = (0.0, 0.0);
        for i in 0..pressure.len() {
            load += self.weights[i] * pressure[i];
            torque += self.weights[i] * pressure[i] * self.radius_ratio[i];
        }
        let carried = if self.mean.power_factor == 1.0 { load } else { torque / self.mean.power_factor };
        carried * self.shared_depth
    }

    /// Whether elastic slip depends on the pressure along the line.
    pub(crate) fn has_tangential_compliance(&self) -> bool {
        self.tangential.is_some()
    }

    /// Friction force of all faces over the elastic displacement along the sliding direction at this pressure, N/m: the spring that
    /// holds the elastic energy of the friction traction, `n_f n b P^2/(p' w V p)`. `None` where the contact is open, or where the
    /// displacement is that of a uniform traction.
    pub(crate) fn tangential_stiffness(&self, pressure: &[f64]) -> Option<f64> {
        let tangential = self.tangential.as_ref()?;
        let (mut load, mut work) = (0.0, 0.0);
        for (j, column) in tangential.column_iter().enumerate() {
            load += self.weights[j] * pressure[j];
            let moved: f64 = (0..pressure.len()).map(|i| self.weights[i] * pressure[i] * column[i]).sum();
            work += moved * pressure[j];
        }
        (load > 0.0 && work > 0.0).then(|| self.scene.faces * self.shared_depth * load * load / work)
    }

    /// Nonuniformity of the pressure of the unworn, cold contact at nominal load.
    pub fn unevenness(&self) -> Nonuniformity {
        let scene = &self.scene;
        let friction = scene.friction_coefficient;
        let coupled = if scene.shear_coupling && scene.geometry != Geometry::Annular { friction } else { 0.0 };
        let lever = self.pivot.map_or(0.0, |height| friction * height);
        let pressure = |signed: f64, lever: f64| -> Option<Vec<f64>> {
            let (mut contact, mut conditions) = (self.contact(), self.conditions());
            conditions.normal = Normal::Load(scene.nominal_load / self.shared_depth);
            conditions.signed_friction = signed;
            if self.rotates {
                conditions.tilt = Tilt::ResultantAt(lever);
            }
            let mut state = ContactState::new(self.count());
            contact.stage_into(&self.initial_gap, 0.0, &conditions, &mut state).ok().map(|()| state.pressure)
        };
        let width = 2.0 * self.cells.half_width();
        let root_mean_square = |of: &dyn Fn(usize) -> f64| {
            let square: f64 = self.cells.widths().iter().enumerate().map(|(i, c)| c * of(i) * of(i)).sum();
            (square / width).sqrt()
        };
        let Some(full) = pressure(coupled, lever) else { return Nonuniformity::default() };
        let mean = self.cells.integral(&full) / width;
        let apart = |other: Option<Vec<f64>>| match other {
            Some(other) if mean > 0.0 => root_mean_square(&|i| full[i] - other[i]) / mean,
            _ => 0.0,
        };
        Nonuniformity {
            pressure: if mean > 0.0 { root_mean_square(&|i| full[i] - mean) / mean } else { 0.0 },
            shear: if coupled == 0.0 { 0.0 } else { apart(pressure(0.0, lever)) },
            rotation: if lever == 0.0 { 0.0 } else { apart(pressure(coupled, 0.0)) },
        }
    }

    /// Description of the choices made, for the log.
    pub(crate) fn description(&self) -> String {
        let strip = match self.strip_wear {
            StripWear::None => "does not wear",
            StripWear::Even => "wears evenly along its path",
            StripWear::ByRadius => "wears by radius",
            StripWear::Track => "keeps its worn track",
        };
        let chosen = if self.scene.cells == 0 { " (by the tolerance)" } else { "" };
        let heat = match &self.heat {
            Some(bodies) => {
                format!("resolved heat, thermal states: punch {}, strip {}", bodies.states[0], bodies.states[1])
            }
            None => "mean heat, without thermal distortion".into(),
        };
        format!("{} cells{chosen}; the strip {strip}; {heat}", self.count())
    }

    /// Warnings about the scene, at initialisation.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let scene = &self.scene;
        let (friction, speed) = (scene.friction_coefficient, scene.nominal_velocity.abs());
        let critical = self.mean.growth.critical.modelled(friction);
        if scene.initial_shape == InitialShape::RunIn && self.heat.is_some() && critical > 0.0 && speed > critical {
            warnings.push(format!(
                "contact.initial_shape = run_in is the shape of an unstable steady state: nominal.velocity = {} m/s is {:.2} times the \
                 critical speed {} m/s",
                Number(speed),
                speed / critical,
                Number(critical)
            ));
        }
        let limit = |exponent: f64| rocking_limit(exponent) * 0.5 * scene.width;
        if let Some(height) = self.pivot
            && scene.nominal_stroke > 0.0
            && scene.punch.wear_coefficient > 0.0
            && let Ok(limit) = self.wear[0].0.pressure.as_power().map(limit)
            && scene.friction_coefficient * height >= limit
        {
            warnings.push(format!(
                "reciprocating sliding has no steady cycle: wear rounds the contact and increases the tilt without \
                 bound, since contact.friction_coefficient x holder.pivot_height = {} m is not below {limit} m",
                scene.friction_coefficient * height
            ));
        }
        warnings
    }
}

/// Scene of the lumped level beneath the contact line, which integrates the wear and stands between holder and load.
fn mean_scene(scene: &Scene, heat: bool) -> Scene {
    let mut mean = scene.clone();
    for body in [&mut mean.punch, &mut mean.strip] {
        body.wear_coefficient = 0.0;
        body.wear_limit = 0.0;
    }
    mean.holder_stiffness = 0.0;
    if heat {
        // The contact line supplies the friction coefficient, and its temperature is the one that has a limit.
        mean.temperature_limit = 0.0;
        mean.friction_fade = FadeTable::new(scene.friction_fade.temperature, [1.0; 8]);
    }
    mean
}
