//! Heat in the punch by its finite elements, unreduced: what the reduced punch is judged against.
//!
//! ```text
//! M dT/dt + K T = F q + ports
//! ```
//!
//! on the hp mesh of [`ThermalBlock`], graded to all four corners, with elements that are small against the smallest cell of
//! the contact. Time is stepped as the contact is, by SDIRK2 with the fluxes of the two stages,
//!
//! ```text
//! (K + M/(gamma h)) T_1 = M T_0/(gamma h) + F q_1 + ports
//! (K + M/(gamma h)) T_2 = M [T_0 + (1 - gamma)/gamma (T_1 - T_0)]/(gamma h) + F q_2 + ports
//! ```
//!
//! second order and L-stable (the deviation of the first stage's flux at its start is of no use to it), with `h [(1 - gamma) q_1 + gamma q_2]` as the heat that enters. The sparse factor of a step
//! size, and the N responses to unit fluxes that it takes to know the gains, are kept for the last few sizes. What elements
//! cannot resolve of fluxes that jump between cells acts without delay ([`ThermalBlock::unresolved_response`]).
//!
//! Every step costs sparse solutions with thousands of unknowns, a new step size N more, and both take memory: this is a
//! reference, not a level to run for long.

use super::{Account, GAMMA, Gains, LineHeat, Stage, Surroundings};
use crate::elastic::Cells;
use crate::elastic::block::thermal::ThermalFactor;
use crate::elastic::block::{
    Block, BlockError, BlockProperties, Discretization, ThermalBlock, ThermalProperties, TopCondition,
    unreduced::TopOutflow,
};
use crate::scene::{Scene, ThermalBoundary};
use faer::Mat;
use nalgebra::DMatrix;
use std::sync::Arc;

/// Step sizes whose factors are kept.
const KEPT: usize = 4;

/// Layers of elements towards the contact's corners beyond those that elasticity asks for: the mean temperature of an edge
/// cell needs elements that are small against it.
const EXTRA_LAYERS: usize = 3;

/// Accuracy asked of the mesh, see [`Discretization::for_cells`].
const MESH_TOLERANCE: f64 = 1e-4;

/// Entries of the state behind the temperatures: heat received, lost to the air, lost through the top (J/m), temperature of
/// the top.
const TALLIES: usize = 4;

/// What a scene makes of the punch.
#[derive(Debug)]
struct Operators {
    block: ThermalBlock,
    widths: Vec<f64>,
    /// Integrals of the shape functions over the cells.
    cells: Vec<Vec<(usize, f64)>>,
    unresolved: DMatrix<f64>,
    /// Displacement into the body by unit values of the unknowns, n x N, and by 1 K everywhere, m/K; None: nothing expands.
    distortion: Option<(Mat<f64>, Vec<f64>)>,
    uniform: Mat<f64>,
    capacity: Mat<f64>,
    sides: Mat<f64>,
    top: Mat<f64>,
    outflow: Option<TopOutflow>,
    properties: ThermalProperties,
    /// Cooled area over that of the two sides.
    cooled: f64,
    /// Heat capacity of the whole body, J/(m K).
    total_capacity: f64,
}

/// Factor and gains of a step.
#[derive(Clone, Debug)]
struct Prepared {
    step: f64,
    euler: bool,
    last_used: u64,
    factor: Arc<ThermalFactor>,
    gains: Gains,
}

/// The unreduced punch.
#[derive(Clone, Debug)]
pub struct FieldHeat {
    operators: Arc<Operators>,
    kept: Vec<Prepared>,
    current: usize,
    clock: u64,
}

/// The punch of `scene`; None where it is an insulator.
///
/// # Errors
/// A block that is too flat or slender for its mesh, or of a Poisson's ratio out of range.
pub fn unreduced(scene: &Scene, cells: &Cells) -> Result<Option<FieldHeat>, BlockError> {
    let body = &scene.punch;
    if body.conductivity == 0.0 {
        return Ok(None);
    }
    let (width, height) = (2.0 * cells.half_width(), body.height);
    let boundaries = cells.edges();
    let coarse = Discretization::for_cells(width, height, boundaries, MESH_TOLERANCE);
    let discretization = Discretization { contact_layers: coarse.contact_layers + EXTRA_LAYERS, ..coarse };
    let plain = 2.0 * height * scene.depth * scene.count;
    let cooled = if body.cooled_area > 0.0 { body.cooled_area / plain } else { 1.0 };
    let properties = ThermalProperties {
        width,
        height,
        conductivity: body.conductivity,
        volumetric_heat_capacity: body.capacity(),
        side_convection: body.convection * cooled,
        top: match body.far_thermal {
            ThermalBoundary::Held | ThermalBoundary::External => TopCondition::Held,
            ThermalBoundary::Convecting => TopCondition::Convecting(body.convection),
            ThermalBoundary::Insulated => TopCondition::Convecting(0.0),
        },
    };
    let block = ThermalBlock::new(properties, discretization)?;
    let distortion = if body.thermal_expansion > 0.0 {
        // A surface that is free is distorted by heat whatever the stiffness.
        let elastic = BlockProperties { width, height, youngs_modulus: 1.0, poissons_ratio: body.poissons_ratio };
        let elastic = Block::new(elastic, discretization)?;
        let by_field = elastic.distortion_operator(&block, boundaries)? * faer::Scale(body.thermal_expansion);
        let uniform = elastic.uniform_distortion(boundaries)?;
        Some((by_field, uniform.iter().map(|moved| body.thermal_expansion * moved).collect()))
    } else {
        None
    };
    let operators = Operators {
        widths: cells.widths().to_vec(),
        cells: block.cell_integrals(boundaries)?,
        unresolved: block.unresolved_response(boundaries)?,
        distortion,
        uniform: block.uniform_field(),
        capacity: block.uniform_capacity(),
        sides: block.side_integrals(),
        top: block.top_load(),
        outflow: block.top_outflow(),
        properties,
        cooled,
        total_capacity: properties.volumetric_heat_capacity * width * height,
        block,
    };
    Ok(Some(FieldHeat { operators: Arc::new(operators), kept: Vec::new(), current: 0, clock: 0 }))
}

fn dot(left: &Mat<f64>, right: &Mat<f64>) -> f64 {
    left.col(0).iter().zip(right.col(0).iter()).map(|(left, right)| left * right).sum()
}

impl Operators {
    fn degrees(&self) -> usize {
        self.block.degrees()
    }

    fn held(&self) -> bool {
        self.properties.top == TopCondition::Held
    }

    /// Temperature that the unknowns count from.
    fn origin(&self, surroundings: &Surroundings) -> f64 {
        if self.held() { surroundings.far } else { 0.0 }
    }

    /// The unknowns of a state, from `origin`.
    fn field(&self, state: &[f64], origin: f64) -> Mat<f64> {
        Mat::from_fn(self.degrees(), 1, |i, _| state[i] - origin * self.uniform[(i, 0)])
    }

    /// F q + ports.
    fn load(&self, flux: Option<&[f64]>, surroundings: &Surroundings) -> Mat<f64> {
        let outside = surroundings.ambient - self.origin(surroundings);
        let beside = self.properties.side_convection * outside + self.cooled * surroundings.cooling;
        let mut load = &self.sides * faer::Scale(beside) + &self.top * faer::Scale(outside);
        if let Some(flux) = flux {
            for (integrals, flux) in self.cells.iter().zip(flux) {
                integrals.iter().for_each(|&(degree, integral)| load[(degree, 0)] += integral * flux);
            }
        }
        load
    }

    /// Mean temperatures of the cells, from the origin, without what the elements do not resolve.
    fn means(&self, field: &Mat<f64>, column: usize, target: &mut [f64]) {
        for ((target, integrals), width) in target.iter_mut().zip(&self.cells).zip(&self.widths) {
            *target =
                integrals.iter().map(|&(degree, integral)| integral * field[(degree, column)]).sum::<f64>() / width;
        }
    }

    fn distort(&self, field: &Mat<f64>, origin: f64, target: &mut [f64]) {
        match &self.distortion {
            None => target.fill(0.0),
            Some((by_field, uniform)) => {
                for (j, target) in target.iter_mut().enumerate() {
                    let moved: f64 = by_field.col(j).iter().zip(field.col(0).iter()).map(|(d, t)| d * t).sum();
                    *target = moved + origin * uniform[j];
                }
            }
        }
    }

    fn observe(&self, field: &Mat<f64>, origin: f64, temperature: &mut [f64], distortion: &mut [f64]) {
        self.means(field, 0, temperature);
        temperature.iter_mut().for_each(|mean| *mean += origin);
        self.distort(field, origin, distortion);
    }

    /// Heat flow to the air through the sides, W/m, without `cooling`.
    fn ambient_flow(&self, field: &Mat<f64>, surroundings: &Surroundings) -> f64 {
        let outside = surroundings.ambient - self.origin(surroundings);
        let length = 2.0 * self.properties.height;
        self.properties.side_convection * (dot(&self.sides, field) - length * outside)
    }

    fn stored(&self, state: &[f64]) -> f64 {
        let free: f64 = self.capacity.col(0).iter().zip(state).map(|(c, t)| c * t).sum();
        if self.held() {
            let beyond = self.total_capacity - dot(&self.capacity, &self.uniform);
            free + beyond * state[self.degrees() + TALLIES - 1]
        } else {
            free
        }
    }

    /// 1/s: of the first stage, which all stages share; bounded so that the matrix of a body that loses no heat is definite.
    fn shift(&self, step: f64, euler: bool) -> f64 {
        let ThermalProperties { height, conductivity, volumetric_heat_capacity, .. } = self.properties;
        let slowest = conductivity / volumetric_heat_capacity / (height * height);
        (if euler { step } else { GAMMA * step }).recip().max(1e-10 * slowest)
    }

    fn prepare(&self, step: f64, euler: bool) -> Result<Prepared, BlockError> {
        let factor = self.block.factorize(self.shift(step, euler))?;
        let count = self.widths.len();
        let mut fields = Mat::zeros(self.degrees(), count);
        for (cell, integrals) in self.cells.iter().enumerate() {
            integrals.iter().for_each(|&(degree, integral)| fields[(degree, cell)] += integral);
        }
        self.block.solve_in_place(&factor, &mut fields)?;
        let mut gains = Gains { temperature: self.unresolved.clone(), distortion: DMatrix::zeros(count, count) };
        let mut means = vec![0.0; count];
        for cell in 0..count {
            self.means(&fields, cell, &mut means);
            gains.temperature.column_mut(cell).iter_mut().zip(&means).for_each(|(gain, mean)| *gain += mean);
        }
        if let Some((by_field, _)) = &self.distortion {
            let moved = by_field.transpose() * &fields;
            gains.distortion = DMatrix::from_fn(count, count, |i, j| moved[(i, j)]);
        }
        Ok(Prepared { step, euler, last_used: 0, factor: Arc::new(factor), gains })
    }
}

impl FieldHeat {
    fn select(&mut self, step: f64, euler: bool) {
        self.clock += 1;
        let known = self.kept.iter().position(|prepared| prepared.step == step && prepared.euler == euler);
        if let Some(known) = known {
            self.current = known;
        } else {
            // The shift keeps the matrix definite, so there is always a factor; without memory for it nothing can go on.
            let fresh = self.operators.prepare(step, euler).unwrap_or_else(|error| panic!("punch: {error}"));
            if self.kept.len() < KEPT {
                self.current = self.kept.len();
                self.kept.push(fresh);
            } else {
                self.current = (0..KEPT).min_by_key(|&i| self.kept[i].last_used).unwrap_or(0);
                self.kept[self.current] = fresh;
            }
        }
        self.kept[self.current].last_used = self.clock;
    }

    fn prepared(&self) -> &Prepared {
        self.kept.get(self.current).expect("prepare comes before any step")
    }

    /// The solution of a stage from `start`.
    fn solve(&self, start: &Mat<f64>, flux: Option<&[f64]>, surroundings: &Surroundings) -> Mat<f64> {
        let (operators, prepared) = (&*self.operators, self.prepared());
        let shift = operators.shift(prepared.step, prepared.euler);
        let mut field = operators.block.apply_capacity(start) * faer::Scale(shift) + operators.load(flux, surroundings);
        operators.block.solve_in_place(&prepared.factor, &mut field).unwrap_or_else(|error| panic!("punch: {error}"));
        field
    }

    /// What the second stage starts from.
    fn extrapolated(start: &Mat<f64>, first: &Mat<f64>) -> Mat<f64> {
        start + (first - start) * faer::Scale((1.0 - GAMMA) / GAMMA)
    }
}

impl LineHeat for FieldHeat {
    fn cells(&self) -> usize {
        self.operators.widths.len()
    }

    fn states(&self) -> usize {
        self.operators.degrees() + TALLIES
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let (field, tallies) = state.split_at_mut(self.operators.degrees());
        field.iter_mut().enumerate().for_each(|(i, t)| *t = rise * self.operators.uniform[(i, 0)]);
        tallies.fill(0.0);
        tallies[TALLIES - 1] = rise;
    }

    fn prepare(&mut self, step: f64, _velocity: [f64; 2]) {
        self.select(step, false);
    }

    fn prepare_euler(&mut self, step: f64, _velocity: [f64; 2]) {
        self.select(step, true);
    }

    fn gains(&self, _stage: Stage) -> &Gains {
        // Both stages share the matrix.
        &self.prepared().gains
    }

    fn base(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        let start = operators.field(state, origin);
        let field = if stage == Stage::First || self.prepared().euler {
            self.solve(&start, None, surroundings)
        } else {
            let early = self.solve(&start, Some(known), surroundings);
            self.solve(&Self::extrapolated(&start, &early), None, surroundings)
        };
        operators.observe(&field, origin, temperature, distortion);
    }

    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let operators = &*self.operators;
        let (origin, step) = (operators.origin(surroundings), self.prepared().step);
        let before = operators.stored(state);
        let start = operators.field(state, origin);
        let early = self.solve(&start, Some(first), surroundings);
        let (field, ambient) = if self.prepared().euler {
            let flow = operators.ambient_flow(&early, surroundings);
            (early, flow)
        } else {
            let late = self.solve(&Self::extrapolated(&start, &early), Some(end), surroundings);
            let flows = [&early, &late].map(|field| operators.ambient_flow(field, surroundings));
            (late, (1.0 - GAMMA) * flows[0] + GAMMA * flows[1])
        };
        let heat = |flux: &[f64]| flux.iter().zip(&operators.widths).map(|(q, c)| q * c).sum::<f64>();
        let received = step * ((1.0 - GAMMA) * heat(first) + GAMMA * heat(end));
        let length = 2.0 * operators.properties.height * operators.cooled;
        let lost = step * (ambient - length * surroundings.cooling);
        let degrees = operators.degrees();
        for i in 0..degrees {
            state[i] = field[(i, 0)] + origin * operators.uniform[(i, 0)];
        }
        state[degrees + 3] = surroundings.far;
        let gained = operators.stored(state) - before;
        let tallies = &mut state[degrees..];
        tallies[0] += received;
        tallies[1] += lost;
        // The top takes what the balance leaves; an insulated one nothing, and rounding goes to the sides.
        let rest = received - gained - lost;
        tallies[if operators.properties.top == TopCondition::Convecting(0.0) { 1 } else { 2 }] += rest;
    }

    fn held(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64], _velocity: f64, temperature: &mut [f64]) {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        operators.means(&operators.field(state, origin), 0, temperature);
        for (i, mean) in temperature.iter_mut().enumerate() {
            *mean += origin + (0..flux.len()).map(|j| operators.unresolved[(i, j)] * flux[j]).sum::<f64>();
        }
    }

    fn held_distortion(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        _flux: &[f64],
        _velocity: f64,
        distortion: &mut [f64],
    ) {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        operators.distort(&operators.field(state, origin), origin, distortion);
    }

    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, _flux: &[f64]) -> f64 {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        let field = operators.field(state, origin);
        dot(&operators.sides, &field) / (2.0 * operators.properties.height) + origin
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, _flux: &[f64]) -> [f64; 2] {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        let field = operators.field(state, origin);
        let outside = surroundings.ambient - origin;
        let far = match (&operators.outflow, operators.properties.top) {
            (Some(outflow), _) => dot(&outflow.by_field, &field) - outflow.by_outside * outside,
            (None, TopCondition::Convecting(transfer)) => {
                dot(&operators.top, &field) - transfer * operators.properties.width * outside
            }
            (None, TopCondition::Held) => 0.0,
        };
        [operators.ambient_flow(&field, surroundings), far]
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        self.operators.stored(state) / self.operators.total_capacity
    }

    fn account(&self, state: &[f64]) -> Account {
        let tallies = &state[self.operators.degrees()..];
        Account { received: tallies[0], stored: self.operators.stored(state), ambient: tallies[1], far: tallies[2] }
    }

    fn error(&self) -> f64 {
        // Nothing is reduced.
        0.0
    }

    fn boxed(&self) -> Box<dyn LineHeat> {
        Box::new(self.clone())
    }
}
