//! Heat conduction resolved along the contact line: both bodies, the partition of the friction heat between them, and the thermal
//! distortion.
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
//! contact problem ([`partition`]); the cells that exchange heat are found by iteration ([`stage`]).
//!
//! Theory: docs/theory.md, sections 6.1, 6.2.

mod acceleration;
mod accept;
pub mod air;
pub mod bodies;
mod evaluation;
mod growth;
mod outputs;
pub mod partition;
mod partitions;
mod prepare;
mod stage;
mod staggered;
mod start;
pub mod state;

use super::operators::LineOperators;
use crate::fastest_growth::FastestGrowth;
use acceleration::Acceleration;
use bodies::Bodies;
use conduction::line::{Surroundings, ThermalBody};
use contact::wear::line::WearingContact;
use growth::GrowthGuard;
use partition::HeatPartition;
use partitions::PartitionCache;
use scene::Scheme;

/// Part of the tolerance allowed for the error in pressure from operators in single precision. Their rounding errors roughen the
/// distortion on the scale of a cell, and the resulting error in pressure grows with the number of cells.
const ROUNDING: f64 = 0.02;

/// Number of cells above which products in single precision are faster; smaller operators fit the processor's caches.
const MANY: usize = 72;

/// Linearization point of the operators reused from step to step.
#[derive(Clone, Copy, Debug, Default)]
struct FrozenCoefficients {
    /// Sliding velocity, m/s.
    velocity: f64,
    /// The step under way has this velocity throughout, so that the operators are exact for it.
    exact: bool,
    /// mu s v, m/s.
    per_pressure: f64,
    /// Friction coefficient of the shear coupling.
    friction: f64,
    /// Sliding speed in the wear law, m/s, and kinetic friction coefficient (without Stribeck factor).
    speed: f64,
    kinetic_coefficient: f64,
}

/// Thermal coupling of both bodies through the contact: bodies, operators and workspace of a step.
#[derive(Debug)]
pub struct ThermalCoupling {
    /// Punch and strip; `None`: an insulator.
    pub bodies: [Option<Box<dyn ThermalBody>>; 2],
    /// Contact problem of either stage, with the thermal compliance of the stage added to its compliance.
    pub contacts: [WearingContact; 2],
    /// Heat partition of either stage, and the cache slot whose thermal compliance the contact problem of the stage holds.
    pub partitions: PartitionCache,
    installed: [usize; 2],
    /// Fluxes into punch and strip at either stage, W/m2.
    pub flux: [[Vec<f64>; 2]; 2],
    /// Temperatures of punch and strip at either stage, K above the reference.
    pub temperature: [[Vec<f64>; 2]; 2],
    /// Friction heat at either stage, W/m2.
    pub friction: [Vec<f64>; 2],
    /// Kinetic friction coefficient of the cells at their temperature (without Stribeck factor).
    pub kinetic_coefficient: Vec<f64>,
    /// Wear depth rates of punch and strip at the reference pressure, m/s.
    pub reference_wear_rates: [Vec<f64>; 2],
    /// Ambient, far-face temperatures and cooling of the bodies during the step under way.
    pub surroundings: [Surroundings; 2],
    /// Heat paths to the neighbours: flow out of the body at the end of the step under way, W/m2, and the heat of the step, J/m2.
    pub external: [(f64, f64); 2],
    /// Part of the temperature of the cooled surfaces that the bodies do not predict to the end of the step, at its start, K.
    unpredicted_rise: [f64; 2],
    /// Thermal distortion: displacement of both surfaces at the end of the step, m into the bodies.
    pub distortion: Vec<f64>,
    /// Length of the step under way, s, and the sliding velocities at its ends, m/s.
    step: f64,
    velocity: [f64; 2],
    /// Linearization point of the operators reused from step to step.
    reference: FrozenCoefficients,
    /// Largest number of iterations of a stage in the step under way.
    iterations: usize,
    /// Anderson acceleration of the stage iteration.
    acceleration: Acceleration,
    /// The operators of the stage are exact, so that one solution needs no iteration.
    exact: [bool; 2],
    /// Punch and strip have thermal expansion.
    expands: [bool; 2],
    /// Operator split between contact and heat: the bodies have no first stage.
    staggered: bool,
    /// Thermal diffusivity of the strip, the body that slides, m2/s.
    diffusivity: f64,
    /// Pressure of the current iterate, which determines the friction heat of the stage, Pa, and mu s v of the cells, m/s.
    pressure: Vec<f64>,
    per_pressure: Vec<f64>,
    /// Sliding velocity of the cells over that at the mean radius.
    ratio: Vec<f64>,
    /// 1/(2 h_c), K m2/W; 0: no exchange.
    half_resistance: f64,
    /// Cells in the active set: they carry friction heat and exchange heat.
    closed: Vec<bool>,
    /// The temperatures of the stage under way are up to date with its fluxes.
    temperatures_current: bool,
    /// Local contact temperature that enters friction and wear, K.
    contact_temperature: Vec<f64>,
    pub(super) difference: Vec<f64>,
    /// Bound of the growth rate of thermoelastic waves; heat partition of the stage examined by the growth guard, and workspace
    /// for its matrix, N x N.
    growth: FastestGrowth,
    guard_partition: HeatPartition,
    matrix: Vec<f64>,
    growth_guard: GrowthGuard,
    free_response: [Vec<f64>; 2],
    free_distortion: [Vec<f64>; 2],
    gap: Vec<f64>,
    sums: [Vec<f64>; 2],
}

impl ThermalCoupling {
    /// Thermal coupling along the contact line of `operators`, at least one of whose bodies conducts.
    pub fn new(operators: &LineOperators, bodies: &Bodies) -> ThermalCoupling {
        let count = operators.count();
        let zeros = || vec![0.0; count];
        let pair = || [zeros(), zeros()];
        let conductance = operators.scene.conductance;
        let strip = &operators.scene.strip;
        let expands = [&operators.scene.punch, strip].map(|body| body.thermal_expansion > 0.0);
        let smallest = operators.cells.widths().iter().copied().fold(f64::INFINITY, f64::min);
        let rounded = f64::from(f32::EPSILON) * count as f64;
        let rough = count > MANY && rounded <= ROUNDING * operators.scene.tolerance;
        let partition = || HeatPartition::new(operators.cells.widths(), &operators.radius_ratio, conductance);
        let own = if rough { partition().in_single_precision() } else { partition() };
        let mut bodies = bodies.copies();
        // The first preparation allocates the workspaces, so that no step does.
        bodies.iter_mut().flatten().for_each(|own| own.prepare(1.0, [0.0; 2]));
        ThermalCoupling {
            bodies,
            contacts: [operators.contact(), operators.contact()],
            partitions: PartitionCache::new(&own, count),
            installed: [usize::MAX; 2],
            flux: [pair(), pair()],
            temperature: [pair(), pair()],
            friction: pair(),
            kinetic_coefficient: zeros(),
            reference_wear_rates: pair(),
            surroundings: [Surroundings::default(); 2],
            external: [(0.0, 0.0); 2],
            distortion: zeros(),
            unpredicted_rise: [0.0; 2],
            step: 0.0,
            velocity: [0.0; 2],
            reference: FrozenCoefficients::default(),
            iterations: 0,
            acceleration: Acceleration::new(count),
            exact: [false; 2],
            expands,
            staggered: operators.scene.scheme == Scheme::Staggered,
            diffusivity: strip.conductivity / strip.capacity(),
            pressure: zeros(),
            per_pressure: zeros(),
            ratio: operators.radius_ratio.clone(),
            half_resistance: if conductance > 0.0 { 0.5 / conductance } else { 0.0 },
            closed: vec![false; count],
            temperatures_current: false,
            contact_temperature: zeros(),
            difference: zeros(),
            growth: FastestGrowth::new(&operators.scene, smallest),
            guard_partition: partition(),
            matrix: vec![0.0; count * count],
            growth_guard: GrowthGuard::new(count),
            free_response: pair(),
            free_distortion: pair(),
            gap: zeros(),
            sums: pair(),
        }
    }
}

impl Clone for ThermalCoupling {
    fn clone(&self) -> ThermalCoupling {
        ThermalCoupling {
            bodies: std::array::from_fn(|body| self.bodies[body].as_ref().map(|heat| heat.boxed())),
            contacts: self.contacts.clone(),
            partitions: self.partitions.clone(),
            installed: self.installed,
            flux: self.flux.clone(),
            temperature: self.temperature.clone(),
            friction: self.friction.clone(),
            kinetic_coefficient: self.kinetic_coefficient.clone(),
            reference_wear_rates: self.reference_wear_rates.clone(),
            surroundings: self.surroundings,
            external: self.external,
            distortion: self.distortion.clone(),
            unpredicted_rise: self.unpredicted_rise,
            step: self.step,
            velocity: self.velocity,
            reference: self.reference,
            iterations: self.iterations,
            acceleration: self.acceleration.clone(),
            exact: self.exact,
            expands: self.expands,
            staggered: self.staggered,
            diffusivity: self.diffusivity,
            pressure: self.pressure.clone(),
            per_pressure: self.per_pressure.clone(),
            ratio: self.ratio.clone(),
            half_resistance: self.half_resistance,
            closed: self.closed.clone(),
            temperatures_current: self.temperatures_current,
            contact_temperature: self.contact_temperature.clone(),
            difference: self.difference.clone(),
            growth: self.growth.clone(),
            guard_partition: self.guard_partition.clone(),
            matrix: self.matrix.clone(),
            growth_guard: self.growth_guard.clone(),
            free_response: self.free_response.clone(),
            free_distortion: self.free_distortion.clone(),
            gap: self.gap.clone(),
            sums: self.sums.clone(),
        }
    }
}
