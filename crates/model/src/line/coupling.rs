//! Thermal coupling of both bodies over a step with resolved heat: fluxes, temperatures and thermal distortion together with the
//! contact.
//!
//! At a stage of the step the surface of body i (1: punch, 2: strip) responds to the flux `q_i` into its cells with
//!
//! ```text
//! T_i = b_i + G_i q_i,    u_i = d_i + D_i q_i
//! q_1 + q_2 = Q = mu s v p,    T_1 - T_2 = (q_2 - q_1)/(2 h_c)    on cells in contact;    q_1 = q_2 = 0 elsewhere
//! ```
//!
//! `b_i`, `d_i` are the free response, `G_i`, `D_i` the surface influence matrices. For a given active set both temperature and
//! distortion are linear in the pressure, so heat is a thermal compliance added to that of the contact and the stage remains one
//! contact problem ([`super::heat::partition`]); the cells that exchange heat are found by iteration ([`stage`]).
//!
//! Theory: docs/theory.md, sections 6.1, 6.2.

pub(super) mod accept;
mod evaluation;
mod faces;
mod growth_guard;
mod prepare;
mod properties;
mod stage;
mod start;

use super::heat::bodies::{Bodies, shortest};
use super::heat::edges::Edges;
use super::heat::partition::HeatPartition;
use super::heat::partitions::PartitionCache;
use super::operators::LineOperators;
use conduction::line::contact_parts::ContactParts;
use conduction::line::{End, Step, Surroundings, ThermalBody, Workspace};
use contact::wear::line::WearingContact;
use faces::Faces;
use growth_guard::GrowthGuard;
use numerics::acceleration::Anderson;
use properties::FrozenProperties;

/// Differences stored for the Anderson acceleration of a stage.
const ACCELERATION_DEPTH: usize = 8;

/// Linearization point of the operators reused from step to step.
#[derive(Clone, Copy, Debug, Default)]
struct FrozenCoefficients {
    /// Sliding velocity, m/s.
    velocity: f64,
    /// The step under way has this velocity throughout, so that the operators are exact for it.
    exact: bool,
    /// mu s v, m/s: friction heat flux over pressure.
    per_pressure: f64,
    /// |s| mu, in the shear coupling.
    friction: f64,
    /// Sliding speed in the wear law, m/s, and kinetic friction coefficient (without Stribeck factor).
    speed: f64,
    kinetic_coefficient: f64,
}

/// Constants of the coupling.
#[derive(Clone, Debug)]
struct Parameters {
    /// Punch and strip have thermal expansion.
    expands: [bool; 2],
    /// Thermal diffusivity of the strip, whose material passes the contact, m2/s.
    diffusivity: f64,
    /// Sliding velocity of the cells over that at the mean radius; 1 on a line.
    ratio: Vec<f64>,
    /// 1/(2 h_c), K m2/W; 0: no exchange.
    half_resistance: f64,
    /// Shortest time to be resolved, at most that of diffusion through either body, and time of diffusion across a cell, s.
    times: [f64; 2],
}

/// Iterate of the stage under way, N values each, and workspace of the iteration.
#[derive(Clone, Debug)]
struct Iterate {
    /// Pressure, which determines the friction heat of the stage, Pa, and mu s v of the cells, m/s.
    pressure: Vec<f64>,
    per_pressure: Vec<f64>,
    /// Local contact temperature that enters friction and wear, K.
    contact_temperature: Vec<f64>,
    /// Cells in the active set: they carry friction heat and exchange heat.
    closed: Vec<bool>,
    /// Contraction of the pressure that the next stage may expect.
    contraction: f64,
    /// Cells added to it in the stage.
    added: Vec<bool>,
    /// The temperatures of the stage are up to date with its fluxes.
    temperatures_current: bool,
    /// Temperature (K) and distortion (m) of the bodies without flux in the stage.
    free_response: [Vec<f64>; 2],
    free_distortion: [Vec<f64>; 2],
    /// Gap before the deformation by the pressure, m; then workspace.
    gap: Vec<f64>,
    /// Workspace: residuals and changes by cell.
    difference: Vec<f64>,
    sums: [Vec<f64>; 2],
    /// Anderson acceleration: of pressure, flux into the punch and contact temperature; 1/Pa, m2/W and 1/K scale their residuals.
    anderson: Anderson<ACCELERATION_DEPTH>,
    acceleration_scale: [f64; 3],
}

impl Iterate {
    fn new(count: usize) -> Iterate {
        let zeros = || vec![0.0; count];
        let pair = || [zeros(), zeros()];
        Iterate {
            pressure: zeros(),
            per_pressure: zeros(),
            contact_temperature: zeros(),
            closed: vec![false; count],
            contraction: 1.0,
            added: vec![false; count],
            temperatures_current: false,
            free_response: pair(),
            free_distortion: pair(),
            gap: zeros(),
            difference: zeros(),
            sums: pair(),
            anderson: Anderson::new(3 * count),
            acceleration_scale: [0.0; 3],
        }
    }

    /// Sets the contact temperature of the cells, the mean of both `surfaces` (K above `reference`).
    fn take_mean_temperature(&mut self, surfaces: &[Vec<f64>; 2], reference: f64) {
        let cells = surfaces[0].iter().zip(&surfaces[1]);
        for (contact_temperature, (punch, strip)) in self.contact_temperature.iter_mut().zip(cells) {
            *contact_temperature = 0.5 * (punch + strip) + reference;
        }
    }
}

/// Thermal coupling of both bodies through the contact: operators, the step under way and its stages.
#[derive(Clone, Debug)]
pub(crate) struct ThermalCoupling {
    parameters: Parameters,
    // Operators.
    /// Punch and strip; `None`: an insulator.
    pub bodies: [Option<Box<dyn ThermalBody>>; 2],
    /// Memory of their steps, and their states before the last one.
    pub work: [Option<Workspace>; 2],
    before: [Vec<f64>; 2],
    /// Contact problem of either stage, with the thermal compliance of the stage added to its compliance.
    pub contacts: [WearingContact; 2],
    /// Heat partition of either stage, and the cache slot whose thermal compliance the contact problem of the stage holds.
    pub partitions: PartitionCache,
    installed: [usize; 2],
    /// Finds the parts of the cells in contact; `None`: whole cells.
    edges: Option<Edges>,
    /// Linearization point of the operators reused from step to step.
    reference: FrozenCoefficients,
    growth: GrowthGuard,
    // Step under way.
    /// Length, s, and sliding velocities at its ends, m/s.
    step: f64,
    velocity: [f64; 2],
    /// Nothing touches in it: the bodies are prepared without the influence on cells.
    open: bool,
    /// Properties of the bodies.
    pub frozen: FrozenProperties,
    /// Parts of the cells in contact at both stages, and 1/(2 phi h_c) by the fractions phi of the cells in contact, K m2/W.
    contact_parts: [ContactParts; 2],
    /// Rounded parts, for which the heat partitions are built.
    rounded_parts: [ContactParts; 2],
    half_resistance: [Vec<f64>; 2],
    /// Ambient and far-face temperatures of the bodies, and the fluxes into their cooled faces.
    pub surroundings: [Surroundings; 2],
    faces: Faces,
    /// Largest number of iterations of a stage.
    iterations: usize,
    // Either stage.
    /// The operators of the stage are exact, so that one solution needs no iteration.
    exact: [bool; 2],
    /// The thermal compliance of the stage is that of the cells that exchange heat, by a low-rank update.
    reduced: [bool; 2],
    /// Fluxes into punch and strip, W/m2.
    pub flux: [[Vec<f64>; 2]; 2],
    /// Temperatures of punch and strip, K above the reference.
    pub temperature: [[Vec<f64>; 2]; 2],
    /// Free responses at the end of the step, from which the bodies advance when it is accepted.
    ends: [Option<End>; 2],
    /// Friction heat, W/m2.
    pub friction: [Vec<f64>; 2],
    // Stage under way.
    iterate: Iterate,
    /// Kinetic friction coefficient of the cells at their temperature (without Stribeck factor).
    pub kinetic_coefficient: Vec<f64>,
    /// Wear depth rates of punch and strip at the reference pressure, m/s.
    pub reference_wear_rates: [Vec<f64>; 2],
    /// Thermal distortion: displacement of both surfaces, m into the bodies.
    pub distortion: Vec<f64>,
}

impl ThermalCoupling {
    /// Thermal coupling along the contact line of `operators`, at least one of whose bodies conducts.
    pub fn new(operators: &LineOperators, bodies: &Bodies) -> ThermalCoupling {
        let mut bodies = bodies.prototypes.clone();
        // The first preparation allocates the weights, so that no step does.
        bodies.iter_mut().flatten().for_each(|own| own.prepare(&Step::new(1.0, [0.0; 2])));
        Self::with_bodies(operators, bodies)
    }

    /// Takes tuned operators. The steps of the bodies depend on nothing that is tuned, cooled faces on the cooling, the rest on the conductance.
    pub(super) fn set_operators(&mut self, operators: &LineOperators) {
        if operators.mean.half_resistance == self.parameters.half_resistance {
            self.faces = Faces::new(&operators.mean, operators.count());
        } else {
            *self = Self::with_bodies(operators, std::mem::take(&mut self.bodies));
        }
    }

    /// Thermal coupling of these bodies, which are prepared.
    fn with_bodies(operators: &LineOperators, bodies: [Option<Box<dyn ThermalBody>>; 2]) -> ThermalCoupling {
        let count = operators.count();
        let pair = || [vec![0.0; count], vec![0.0; count]];
        let conductance = operators.scene.conductance;
        let strip = &operators.scene.strip;
        let partition = || HeatPartition::new(&operators.radius_ratio, conductance);
        let before = bodies.each_ref().map(|body| vec![0.0; body.as_ref().map_or(0, |own| own.states())]);
        let half_resistance = operators.mean.half_resistance;
        let conducting = [&operators.scene.punch, strip].into_iter().filter(|body| body.conductivity > 0.0);
        let slowness = conducting.map(|body| (body.capacity() / body.conductivity, body.height));
        let through = slowness.clone().map(|(slowness, height)| slowness * height.powi(2));
        let width = 2.0 * operators.cells.half_width() / count as f64;
        let across = slowness.map(|(slowness, _)| slowness * width.powi(2)).fold(f64::INFINITY, f64::min);
        let exchanges = conductance > 0.0 && bodies.iter().all(Option::is_some);
        let divides = exchanges && bodies[0].as_ref().is_some_and(|punch| punch.divides_cells());
        ThermalCoupling {
            parameters: Parameters {
                expands: [&operators.scene.punch, strip].map(|body| body.thermal_expansion > 0.0),
                diffusivity: strip.diffusivity(),
                ratio: operators.radius_ratio.clone(),
                half_resistance,
                times: [through.fold(shortest(&operators.scene), f64::min), across],
            },
            work: bodies.each_ref().map(|body| body.as_ref().map(|own| own.workspace())),
            bodies,
            before,
            contacts: [operators.contact(), operators.contact()],
            partitions: PartitionCache::new(&if divides { partition().with_parts() } else { partition() }, count),
            installed: [usize::MAX; 2],
            edges: divides.then(|| operators.edges()),
            reference: FrozenCoefficients::default(),
            growth: GrowthGuard::new(partition(), count),
            step: 0.0,
            velocity: [0.0; 2],
            open: false,
            frozen: FrozenProperties::new(),
            contact_parts: [ContactParts::whole(count), ContactParts::whole(count)],
            rounded_parts: [ContactParts::whole(count), ContactParts::whole(count)],
            half_resistance: [vec![half_resistance; count], vec![half_resistance; count]],
            surroundings: [Surroundings::default(); 2],
            faces: Faces::new(&operators.mean, count),
            iterations: 0,
            exact: [false; 2],
            reduced: [false; 2],
            flux: [pair(), pair()],
            temperature: [pair(), pair()],
            ends: [None, None],
            friction: pair(),
            iterate: Iterate::new(count),
            kinetic_coefficient: vec![0.0; count],
            reference_wear_rates: pair(),
            distortion: vec![0.0; count],
        }
    }

    /// Contact temperature (K) of the cells, the mean of both `surfaces` (K above `reference`), in the workspace of the stages.
    pub fn mean_temperature(&mut self, surfaces: &[Vec<f64>; 2], reference: f64) -> &[f64] {
        self.iterate.take_mean_temperature(surfaces, reference);
        &self.iterate.contact_temperature
    }
}
