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
//! size, and the gains that N responses to unit fluxes give, are kept for the last few sizes. What elements
//! cannot resolve of fluxes that jump between cells acts without delay ([`ThermalBlock::unresolved_response`]).
//!
//! Every step costs sparse solutions with thousands of unknowns, a new step size a factorisation and N more: this is a
//! reference, not a level to run for long. The memory for all of it is taken when the body is made (the matrix product keeps
//! some of its own for every thread, taken the first time that it runs there).

use super::{Account, CooledAhead, GAMMA, Gains, LineHeat, Stage, Surroundings};
use crate::elastic::Cells;
use crate::elastic::block::{
    Block, BlockError, BlockProperties, Discretization, ThermalBlock, ThermalFactor, ThermalProperties,
    ThermalWorkspace, TopCondition,
};
use crate::scene::{Scene, ThermalBoundary};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, Par};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::fmt;
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

/// What a scene makes of the punch. Vectors over the unknowns hold one number for each.
struct Operators {
    block: ThermalBlock,
    widths: Vec<f64>,
    /// Integrals of the shape functions over the cells.
    cells: Vec<Vec<(usize, f64)>>,
    unresolved: DMatrix<f64>,
    /// Displacement into the body by unit values of the unknowns, n x N, and by 1 K everywhere, m/K; None: nothing expands.
    distortion: Option<(Mat<f64>, Vec<f64>)>,
    uniform: Vec<f64>,
    capacity: Vec<f64>,
    sides: Vec<f64>,
    top: Vec<f64>,
    /// Heat flow out of a held top by the unknowns, and by the temperature beside the body; see
    /// [`ThermalBlock::top_outflow`].
    outflow: Option<(Vec<f64>, f64)>,
    properties: ThermalProperties,
    /// Cooled area over that of the two sides.
    cooled: f64,
    /// Heat capacity of the whole body, J/(m K).
    total_capacity: f64,
}

impl fmt::Debug for Operators {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Operators").field("cells", &self.widths.len()).field("degrees", &self.degrees()).finish()
    }
}

/// Factor and gains of a step; before the first one room for them, for a step that is no number.
#[derive(Clone, Debug)]
struct Prepared {
    step: f64,
    euler: bool,
    last_used: u64,
    factor: ThermalFactor,
    gains: Gains,
    /// See [`CooledAhead::rise`].
    cooled_rise: f64,
}

impl Prepared {
    fn empty(operators: &Operators) -> Prepared {
        let count = operators.widths.len();
        Prepared {
            step: f64::NAN,
            euler: false,
            last_used: 0,
            factor: operators.block.empty_factor(),
            gains: Gains { temperature: DMatrix::zeros(count, count), distortion: DMatrix::zeros(count, count) },
            cooled_rise: 0.0,
        }
    }
}

/// What steps work in.
#[derive(Debug)]
struct Room {
    workspace: ThermalWorkspace,
    /// Responses to unit fluxes, n x N.
    responses: Mat<f64>,
    means: Vec<f64>,
    /// Fields at the start, of the first stage, and of the second.
    start: Vec<f64>,
    early: Vec<f64>,
    late: Vec<f64>,
}

impl Room {
    fn new(operators: &Operators) -> Result<Room, BlockError> {
        let (degrees, count) = (operators.degrees(), operators.widths.len());
        let field = || vec![0.0; degrees];
        Ok(Room {
            workspace: operators.block.workspace(count)?,
            responses: Mat::zeros(degrees, count),
            means: vec![0.0; count],
            start: field(),
            early: field(),
            late: field(),
        })
    }
}

/// The unreduced punch.
#[derive(Debug)]
pub struct FieldHeat {
    operators: Arc<Operators>,
    kept: Vec<Prepared>,
    current: usize,
    clock: u64,
    room: RefCell<Room>,
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
        uniform: vector(&block.uniform_field()),
        capacity: vector(&block.uniform_capacity()),
        sides: vector(&block.side_integrals()),
        top: vector(&block.top_load()),
        outflow: block.top_outflow().map(|outflow| (vector(&outflow.by_field), outflow.by_outside)),
        properties,
        cooled,
        total_capacity: properties.volumetric_heat_capacity * width * height,
        block,
    };
    let room = Room::new(&operators)?;
    let kept = (0..KEPT).map(|_| Prepared::empty(&operators)).collect();
    Ok(Some(FieldHeat { operators: Arc::new(operators), kept, current: 0, clock: 0, room: RefCell::new(room) }))
}

/// The only column of a matrix.
fn vector(matrix: &Mat<f64>) -> Vec<f64> {
    matrix.col(0).iter().copied().collect()
}

fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
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
    fn field(&self, state: &[f64], origin: f64, field: &mut [f64]) {
        for ((field, state), uniform) in field.iter_mut().zip(state).zip(&self.uniform) {
            *field = state - origin * uniform;
        }
    }

    /// F q + ports.
    fn load(&self, flux: Option<&[f64]>, surroundings: &Surroundings, load: &mut [f64]) {
        let outside = surroundings.ambient - self.origin(surroundings);
        let beside = self.properties.side_convection * outside + self.cooled * surroundings.cooling;
        for ((load, side), top) in load.iter_mut().zip(&self.sides).zip(&self.top) {
            *load = side * beside + top * outside;
        }
        if let Some(flux) = flux {
            for (integrals, flux) in self.cells.iter().zip(flux) {
                integrals.iter().for_each(|&(degree, integral)| load[degree] += integral * flux);
            }
        }
    }

    /// Mean temperatures of the cells, from the origin, without what the elements do not resolve.
    fn means(&self, field: &[f64], target: &mut [f64]) {
        for ((target, integrals), width) in target.iter_mut().zip(&self.cells).zip(&self.widths) {
            *target = integrals.iter().map(|&(degree, integral)| integral * field[degree]).sum::<f64>() / width;
        }
    }

    fn distort(&self, field: &[f64], origin: f64, target: &mut [f64]) {
        match &self.distortion {
            None => target.fill(0.0),
            Some((by_field, uniform)) => {
                for (j, target) in target.iter_mut().enumerate() {
                    let moved: f64 = by_field.col(j).iter().zip(field).map(|(d, t)| d * t).sum();
                    *target = moved + origin * uniform[j];
                }
            }
        }
    }

    fn observe(&self, field: &[f64], origin: f64, temperature: &mut [f64], distortion: &mut [f64]) {
        self.means(field, temperature);
        temperature.iter_mut().for_each(|mean| *mean += origin);
        self.distort(field, origin, distortion);
    }

    /// Heat flow to the air through the sides, W/m, without `cooling`.
    fn ambient_flow(&self, field: &[f64], surroundings: &Surroundings) -> f64 {
        let outside = surroundings.ambient - self.origin(surroundings);
        let length = 2.0 * self.properties.height;
        self.properties.side_convection * (dot(&self.sides, field) - length * outside)
    }

    fn stored(&self, state: &[f64]) -> f64 {
        let free = dot(&self.capacity, state);
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

    fn prepare(&self, step: f64, euler: bool, prepared: &mut Prepared, room: &mut Room) -> Result<(), BlockError> {
        // Of no use to anybody until it is done.
        prepared.step = f64::NAN;
        self.block.factorize_into(&mut prepared.factor, self.shift(step, euler), &mut room.workspace)?;
        let responses = &mut room.responses;
        responses.fill(0.0);
        for (cell, integrals) in self.cells.iter().enumerate() {
            integrals.iter().for_each(|&(degree, integral)| responses[(degree, cell)] += integral);
        }
        self.block.solve_in_workspace(&prepared.factor, responses.as_mut(), &mut room.workspace);
        let Gains { temperature, distortion } = &mut prepared.gains;
        temperature.copy_from(&self.unresolved);
        for (cell, response) in responses.col_iter().enumerate() {
            // Columns of a matrix of faer are contiguous.
            let Some(response) = response.try_as_col_major() else { continue };
            self.means(response.as_slice(), &mut room.means);
            temperature.column_mut(cell).iter_mut().zip(&room.means).for_each(|(gain, mean)| *gain += mean);
        }
        if let Some((by_field, _)) = &self.distortion {
            let count = self.widths.len();
            let target = MatMut::from_column_major_slice_mut(distortion.as_mut_slice(), count, count);
            matmul(target, Accum::Replace, by_field.transpose(), responses.as_ref(), 1.0, Par::Seq);
        }
        (prepared.step, prepared.euler) = (step, euler);
        let Room { workspace, start, early, late, .. } = room;
        start.fill(0.0);
        let fall = if euler { 0.0 } else { -1.0 };
        let rising = Surroundings { cooling: 1.0, cooling_fall: fall, ..Surroundings::default() };
        self.solve_both(prepared, start, None, &rising, workspace, [early, late]);
        prepared.cooled_rise = self.cooled_mean(late);
        Ok(())
    }

    /// Solutions of both stages from `start`, which is lost, with the fluxes of both.
    fn solve_both(
        &self,
        prepared: &Prepared,
        start: &mut [f64],
        fluxes: Option<[&[f64]; 2]>,
        surroundings: &Surroundings,
        workspace: &mut ThermalWorkspace,
        [early, late]: [&mut [f64]; 2],
    ) {
        let until = surroundings.until(Stage::First);
        self.solve(prepared, start, fluxes.map(|[first, _]| first), &until, workspace, early);
        if prepared.euler {
            return late.copy_from_slice(early);
        }
        extrapolate(start, early);
        self.solve(prepared, start, fluxes.map(|[_, end]| end), surroundings, workspace, late);
    }

    /// Mean temperature of the sides, from the origin.
    fn cooled_mean(&self, field: &[f64]) -> f64 {
        dot(&self.sides, field) / (2.0 * self.properties.height)
    }

    /// The solution of a stage from `start`.
    fn solve(
        &self,
        prepared: &Prepared,
        start: &[f64],
        flux: Option<&[f64]>,
        surroundings: &Surroundings,
        workspace: &mut ThermalWorkspace,
        field: &mut [f64],
    ) {
        self.load(flux, surroundings, field);
        self.block.add_capacity(self.shift(prepared.step, prepared.euler), start, field, workspace);
        let loads = MatMut::from_column_major_slice_mut(field, self.degrees(), 1);
        self.block.solve_in_workspace(&prepared.factor, loads, workspace);
    }
}

/// What the second stage starts from, in place of the start.
fn extrapolate(start: &mut [f64], first: &[f64]) {
    for (start, first) in start.iter_mut().zip(first) {
        *start += (first - *start) * ((1.0 - GAMMA) / GAMMA);
    }
}

impl FieldHeat {
    fn select(&mut self, step: f64, euler: bool) {
        self.clock += 1;
        let known = self.kept.iter().position(|prepared| prepared.step == step && prepared.euler == euler);
        self.current = known.unwrap_or_else(|| {
            let oldest = (0..KEPT).min_by_key(|&i| self.kept[i].last_used).unwrap_or(0);
            let (prepared, room) = (&mut self.kept[oldest], self.room.get_mut());
            // The shift keeps the matrix definite, so there is always a factor.
            self.operators
                .prepare(step, euler, prepared, room)
                .unwrap_or_else(|error| panic!("punch, step of {step} s: {error}"));
            oldest
        });
        self.kept[self.current].last_used = self.clock;
    }

    fn prepared(&self) -> &Prepared {
        &self.kept[self.current]
    }

    /// What `observe` sees of the field of a state, with the temperature that it counts from.
    fn of_state<T>(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        observe: impl FnOnce(&Operators, &[f64], f64) -> T,
    ) -> T {
        let operators = &*self.operators;
        let origin = operators.origin(surroundings);
        let room = &mut *self.room.borrow_mut();
        operators.field(state, origin, &mut room.start);
        observe(operators, &room.start, origin)
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
        field.iter_mut().zip(&self.operators.uniform).for_each(|(t, uniform)| *t = rise * uniform);
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
        let (operators, prepared) = (&*self.operators, self.prepared());
        let origin = operators.origin(surroundings);
        let Room { workspace, start, early, late, .. } = &mut *self.room.borrow_mut();
        operators.field(state, origin, start);
        let until = surroundings.until(Stage::First);
        if stage == Stage::First || prepared.euler {
            operators.solve(prepared, start, None, &until, workspace, late);
        } else {
            operators.solve(prepared, start, Some(known), &until, workspace, early);
            extrapolate(start, early);
            operators.solve(prepared, start, None, surroundings, workspace, late);
        }
        operators.observe(late, origin, temperature, distortion);
    }

    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let (operators, prepared) = (&*self.operators, self.prepared());
        let (origin, step) = (operators.origin(surroundings), prepared.step);
        let Room { workspace, start, early, late, .. } = &mut *self.room.borrow_mut();
        let before = operators.stored(state);
        operators.field(state, origin, start);
        operators.solve_both(prepared, start, Some([first, end]), surroundings, workspace, [&mut *early, &mut *late]);
        let flows = [early, &mut *late].map(|field| operators.ambient_flow(field, surroundings));
        let ambient = if prepared.euler { flows[1] } else { (1.0 - GAMMA) * flows[0] + GAMMA * flows[1] };
        let heat = |flux: &[f64]| flux.iter().zip(&operators.widths).map(|(q, c)| q * c).sum::<f64>();
        let received = step * ((1.0 - GAMMA) * heat(first) + GAMMA * heat(end));
        let length = 2.0 * operators.properties.height * operators.cooled;
        let lost = step * (ambient - length * surroundings.mean_cooling());
        let degrees = operators.degrees();
        for ((state, field), uniform) in state.iter_mut().zip(&*late).zip(&operators.uniform) {
            *state = field + origin * uniform;
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
        self.of_state(state, surroundings, |operators, field, origin| {
            operators.means(field, temperature);
            for (i, mean) in temperature.iter_mut().enumerate() {
                *mean += origin + (0..flux.len()).map(|j| operators.unresolved[(i, j)] * flux[j]).sum::<f64>();
            }
        });
    }

    fn held_distortion(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        _flux: &[f64],
        _velocity: f64,
        distortion: &mut [f64],
    ) {
        self.of_state(state, surroundings, |operators, field, origin| operators.distort(field, origin, distortion));
    }

    fn cooled_temperature(&self, state: &[f64], surroundings: &Surroundings, _flux: &[f64]) -> f64 {
        self.of_state(state, surroundings, |operators, field, origin| operators.cooled_mean(field) + origin)
    }

    fn cooled_ahead(&self, state: &[f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) -> CooledAhead {
        let (operators, prepared) = (&*self.operators, self.prepared());
        let origin = operators.origin(surroundings);
        let Room { workspace, start, early, late, .. } = &mut *self.room.borrow_mut();
        operators.field(state, origin, start);
        operators.solve_both(prepared, start, Some([first, end]), surroundings, workspace, [early, late]);
        let temperature = operators.cooled_mean(late) + origin;
        CooledAhead { temperature, rise: prepared.cooled_rise, lagging: 0.0 }
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, _flux: &[f64]) -> [f64; 2] {
        self.of_state(state, surroundings, |operators, field, origin| {
            let outside = surroundings.ambient - origin;
            let far = match (&operators.outflow, operators.properties.top) {
                (Some((by_field, by_outside)), _) => dot(by_field, field) - by_outside * outside,
                (None, TopCondition::Convecting(transfer)) => {
                    dot(&operators.top, field) - transfer * operators.properties.width * outside
                }
                (None, TopCondition::Held) => 0.0,
            };
            [operators.ambient_flow(field, surroundings), far]
        })
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
        let operators = self.operators.clone();
        // Room that nothing was prepared in costs no memory until something is.
        let copy = |prepared: &Prepared| {
            if prepared.step.is_nan() { Prepared::empty(&operators) } else { prepared.clone() }
        };
        let kept = self.kept.iter().map(copy).collect();
        let room = RefCell::new(Room::new(&operators).unwrap_or_else(|error| panic!("punch: {error}")));
        Box::new(FieldHeat { operators, kept, current: self.current, clock: self.clock, room })
    }
}
