//! Contribution of one body to the stage equations of a step.
//!
//! Theory: docs/theory.md, sections 6.8, 4.11.

use super::air::{BESIDE, FACES, FAR, PORTS_OF_FACES};
use super::estimate::{cooling_error, varying_cooling_error};
use super::operators::BodyOperators;
use super::property_step::PropertyStep;
use super::stage::{BASIS, Matrix, Observed, Pair, Propagator, QUADRATURE, apply, inverse, product, sum};
use super::stage_partition::Response;
use super::state::BodyState;
use conduction::reduced::{PORTS, Port};
use numerics::maximum::{all_finite, maximum};

/// Contribution of one body to the stage equations; `COMMON` as in [`super::stepper::Stepper::attempt`].
pub(crate) struct StageBody<'a, const COMMON: bool> {
    pub body: &'a BodyOperators,
    /// Propagator and number of states; `None` for an insulator.
    own: Option<(&'a Propagator, usize)>,
    /// Contact temperature without contact flux and cooling, K above the reference; also of the cooled faces.
    free: Pair,
    free_of_faces: [Pair; FACES],
    /// Temperature at which the contact enters, with the response of its moving source.
    source: Response,
    /// Contact temperature with the cooling.
    pub contact: Response,
    /// Likewise of the cooled faces.
    faces: [Response; FACES],
    /// Linearised laws of cooling: the flux into a face of the temperature T is `offset - slope T`.
    offset: [Pair; FACES],
    slope: [Pair; FACES],
    /// Stage fluxes through every port.
    pub flux: [Pair; PORTS],
    active: [bool; PORTS],
    /// Faces whose cooling is solved for: not in proportion to their temperature alone.
    cools: [bool; FACES],
}

pub(crate) const NONE: Response = Response { level: [0.0; 2], gain: [[0.0; 2]; 2] };

/// Product of a matrix and a diagonal one.
#[inline(always)]
fn columns(matrix: &Matrix, by: Pair) -> Matrix {
    [[matrix[0][0] * by[0], matrix[0][1] * by[1]], [matrix[1][0] * by[0], matrix[1][1] * by[1]]]
}

/// `(I + G S)^-1` for the gain G of a face from its own flux and the slope S of its law.
#[inline(always)]
fn settling(by_own: &Matrix, slope: Pair) -> Matrix {
    let through = columns(by_own, slope);
    inverse(&[[1.0 + through[0][0], through[0][1]], [through[1][0], 1.0 + through[1][1]]])
}

/// Response of a face with its own law.
#[inline(always)]
fn settled(settle: &Matrix, bare: &Response, by_own: &Matrix, offset: Pair) -> Response {
    Response { level: apply(settle, sum(bare.level, apply(by_own, offset))), gain: product(settle, &bare.gain) }
}

#[inline(always)]
fn less(left: &Matrix, right: &Matrix) -> Matrix {
    [[left[0][0] - right[0][0], left[0][1] - right[0][1]], [left[1][0] - right[1][0], left[1][1] - right[1][1]]]
}

impl<'a, const COMMON: bool> StageBody<'a, COMMON> {
    /// Number of faces that may be cooled.
    const COOLED: usize = if COMMON { 1 } else { FACES };

    /// Whether heat may pass a port: in the common form that of the ambient temperature has none.
    #[inline(always)]
    fn may_pass(port: usize) -> bool {
        !COMMON || port != Port::Ambient as usize
    }

    /// Body in this state between the prescribed temperatures at both stages; `cools` and `source` as in the fields.
    #[inline(always)]
    pub(crate) fn new(
        body: &'a BodyOperators,
        own: Option<(&'a Propagator, usize)>,
        state: &BodyState,
        ambient: Pair,
        far: Pair,
        cools: [bool; FACES],
        source: Response,
    ) -> Self {
        let mut stage = StageBody {
            body,
            own,
            free: ambient,
            free_of_faces: [[0.0; 2]; FACES],
            source,
            contact: NONE,
            faces: [NONE; FACES],
            offset: [[0.0; 2]; FACES],
            slope: [[0.0; 2]; FACES],
            flux: [[0.0; 2], [0.0; 2], ambient, far],
            active: [true, false, ambient != [0.0; 2], far != [0.0; 2]],
            cools,
        };
        let mut bare = NONE;
        if let Some((own, count)) = own {
            let contact = own.contact_at([0, 2], &state.heat, count);
            stage.free = sum(contact, [stage.prescribed(&own.contact, 0), stage.prescribed(&own.contact, 2)]);
            bare.gain = own.contact.gain_at_stages(Port::Contact as usize);
            for face in 0..Self::COOLED {
                if cools[face] {
                    let observed = stage.observed(own, face);
                    let free = |point: usize| {
                        observed.of_states(point, &state.heat, count) + stage.prescribed(observed, point)
                    };
                    let level = if stage.is_contact(face) { stage.free } else { [free(0), free(2)] };
                    stage.free_of_faces[face] = level;
                    stage.faces[face] = Response { level, gain: observed.gain_at_stages(Port::Contact as usize) };
                }
            }
            // A flux into the far face takes the place of its prescribed temperature.
            for face in 0..Self::COOLED {
                stage.active[PORTS_OF_FACES[face]] |= cools[face];
            }
        }
        bare.level = stage.free;
        stage.join(bare);
        stage
    }

    #[inline(always)]
    fn join(&mut self, own: Response) {
        let Response { level, gain } = self.source;
        self.contact =
            Response { level: sum(own.level, level), gain: [sum(own.gain[0], gain[0]), sum(own.gain[1], gain[1])] };
    }

    /// Whether the temperature of a cooled face is that of the contact without moving source.
    #[inline(always)]
    fn is_contact(&self, face: usize) -> bool {
        face == BESIDE && (COMMON || self.body.cooled_is_contact)
    }

    #[inline(always)]
    fn observed(&self, own: &'a Propagator, face: usize) -> &'a Observed {
        if COMMON && face == BESIDE { &own.contact } else { &own.cooled[face] }
    }

    /// Part of an observation at `point` by prescribed temperatures.
    #[inline(always)]
    fn prescribed(&self, observed: &Observed, point: usize) -> f64 {
        let mut sum = 0.0;
        for (port, found) in [(Port::Ambient as usize, false), (Port::Base as usize, self.cools[FAR])] {
            if !COMMON && self.active[port] && !found {
                sum += observed.of_flux(port, point, self.flux[port]);
            }
        }
        sum
    }

    /// Whether the body conducts.
    #[inline(always)]
    pub(crate) fn conducts(&self) -> bool {
        self.own.is_some()
    }

    /// Whether any cooling depends on temperatures still to be solved for.
    #[inline(always)]
    pub(crate) fn cools(&self) -> bool {
        self.cools[BESIDE] || !COMMON && self.cools[FAR]
    }

    /// Eliminates the cooling: [`StageBody::contact`] becomes the response with it. The laws are linear at the temperatures of the faces
    /// under the contact flux of the last solution.
    #[inline(always)]
    pub(crate) fn cool(&mut self, reference: f64, around: &Around) {
        let Some((own, _)) = self.own else { return };
        for face in 0..Self::COOLED {
            if self.cools[face] {
                let air = &own.air[face];
                let law = |i: usize, t: f64| {
                    let (ambient, forced) = (around.ambient[i], around.forced[i]);
                    let [flux, slope] = air.law(reference, t, ambient, forced, around.neighbour[i]);
                    (slope, flux + slope * t)
                };
                let (first, last) = if air.is_curved() {
                    let t = self.faces[face].at(self.flux[0]);
                    (law(0, t[0]), law(1, t[1]))
                } else {
                    // A linear law is the same at every temperature.
                    (law(0, 0.0), law(1, 0.0))
                };
                (self.slope[face], self.offset[face]) = ([first.0, last.0], [first.1, last.1]);
            }
        }
        if COMMON {
            let observed = &own.contact;
            let bare = Response { level: self.free, gain: observed.gain_at_stages(Port::Contact as usize) };
            let by_own = observed.gain_at_stages(PORTS_OF_FACES[BESIDE]);
            let settle = settling(&by_own, self.slope[BESIDE]);
            self.faces[BESIDE] = settled(&settle, &bare, &by_own, self.offset[BESIDE]);
            self.join(self.faces[BESIDE]);
        } else {
            self.cool_faces(own);
        }
    }

    /// Eliminates the linearised cooling face by face.
    #[inline(never)]
    fn cool_faces(&mut self, own: &Propagator) {
        // Responses of the faces and, last, of the contact to the contact flux and to those into the faces.
        let observed = [&own.cooled[BESIDE], &own.cooled[FAR], &own.contact];
        let gain = |observed: &Observed| observed.gain_at_stages(Port::Contact as usize);
        let level = [self.free_of_faces[BESIDE], self.free_of_faces[FAR], self.free];
        let mut rows: [_; FACES + 1] =
            std::array::from_fn(|row| Response { level: level[row], gain: gain(observed[row]) });
        let mut by_face = observed.map(|observed| PORTS_OF_FACES.map(|port| observed.gain_at_stages(port)));
        for face in (0..FACES).filter(|&face| self.cools[face]) {
            let (slope, offset) = (self.slope[face], self.offset[face]);
            let settle = settling(&by_face[face][face], slope);
            rows[face] = settled(&settle, &rows[face], &by_face[face][face], offset);
            by_face[face] = by_face[face].map(|gain| product(&settle, &gain));
            for row in (0..=FACES).filter(|&row| row != face) {
                let by = by_face[row][face];
                let through = columns(&by, slope);
                let (flux, fall) = (apply(&by, offset), apply(&through, rows[face].level));
                rows[row].level = sum(rows[row].level, [flux[0] - fall[0], flux[1] - fall[1]]);
                rows[row].gain = less(&rows[row].gain, &product(&through, &rows[face].gain));
                for other in (0..FACES).filter(|&other| other != face) {
                    by_face[row][other] = less(&by_face[row][other], &product(&through, &by_face[face][other]));
                }
            }
        }
        let [beside, far, contact] = rows;
        self.faces = [beside, far];
        self.join(contact);
    }

    /// Sets the contact fluxes at both stages, and those of the cooling with them.
    #[inline(always)]
    pub(crate) fn take(&mut self, into: Pair) {
        self.flux[0] = into;
        for face in 0..Self::COOLED {
            if self.cools[face] {
                let (t, offset, slope) = (self.faces[face].at(into), self.offset[face], self.slope[face]);
                self.flux[PORTS_OF_FACES[face]] = [offset[0] - slope[0] * t[0], offset[1] - slope[1] * t[1]];
            }
        }
    }

    /// Largest linearisation error of the cooling at either stage, as the temperature (K) that it causes at the end of the step.
    #[inline(always)]
    pub(crate) fn left(&self, reference: f64, around: &Around) -> f64 {
        let mut most = 0.0;
        let Some((own, _)) = self.own else { return most };
        for face in 0..Self::COOLED {
            let (air, port) = (&own.air[face], PORTS_OF_FACES[face]);
            if self.cools[face] && air.is_curved() {
                let (t, gain) = (self.face(face), self.observed(own, face).gain[port][2]);
                let left = |i: usize| {
                    let flux = air.flux(reference, t[i], around.ambient[i], around.forced[i], around.neighbour[i]);
                    ((flux - self.flux[port][i]) * gain[i]).abs()
                };
                most = maximum(most, maximum(left(0), left(1)));
            }
        }
        most
    }

    /// Temperatures of a cooled face at both stages.
    #[inline(always)]
    fn face(&self, face: usize) -> Pair {
        self.faces[face].at(self.flux[0])
    }

    /// Contact temperature at the point 2/3 under the stage fluxes, and its gain from the contact's, for the error estimate; `source`
    /// is the response of the moving source there.
    #[inline(always)]
    pub(crate) fn contact_in_middle(&self, state: &BodyState, source: (f64, Pair)) -> (f64, Pair) {
        let Some((own, count)) = self.own else {
            return (0.5 * (self.contact.level[0] + self.contact.level[1]), [0.0; 2]);
        };
        let [free] = own.contact_at([1], &state.heat, count);
        let level = free + self.prescribed(&own.contact, 1) + source.0;
        let level = self.add_cooling(level, &own.contact, 1);
        let gain = sum(own.contact.gain[0][1], source.1);
        (level + (gain[0] * self.flux[0][0] + gain[1] * self.flux[0][1]), gain)
    }

    #[inline(always)]
    fn add_cooling(&self, mut sum: f64, observed: &Observed, point: usize) -> f64 {
        for face in 0..Self::COOLED {
            if self.cools[face] {
                let port = PORTS_OF_FACES[face];
                sum += observed.of_flux(port, point, self.flux[port]);
            }
        }
        sum
    }

    #[inline(always)]
    fn add_fluxes(&self, level: f64, observed: &Observed, point: usize) -> f64 {
        self.add_cooling(level + observed.of_flux(0, point, self.flux[0]), observed, point)
    }

    /// Whether a face is linear: eliminated in the propagator.
    #[inline(always)]
    pub(crate) fn has_linear_faces(&self) -> bool {
        self.own.is_some_and(|(own, _)| own.is_linear(BESIDE) || own.is_linear(FAR))
    }

    /// Sets the fluxes into the linear faces to those under the others, of which none is linear.
    #[inline(always)]
    pub(crate) fn take_linear(&mut self, state: &BodyState) {
        // Not in a loop or a closure: where every index is a constant, the compiler keeps a body in registers.
        self.take_linear_face(BESIDE, state);
        self.take_linear_face(FAR, state);
    }

    #[inline(always)]
    fn take_linear_face(&mut self, face: usize, state: &BodyState) {
        let Some((own, count)) = self.own else { return };
        if own.is_linear(face) {
            let (port, drivers) = (PORTS_OF_FACES[face], if COMMON { 2 } else { PORTS });
            self.flux[port] = own.linear_flux(face, &state.heat, count, &self.flux[..drivers]);
            self.active[port] = true;
        }
    }

    /// Error of the step by the cooling, in K, from the residuals of its laws at the point 2/3 with the conditions `middle`, and at the
    /// start with those `start` where they change; and the largest temperature of a face that is solved for, K. Where fluxes relax, a linear
    /// face has a bound in place of its residual: a flux that relaxes deviates from the line through both stages by at most half their
    /// difference.
    #[inline(always)]
    pub(crate) fn cooling_error(
        &self,
        state: &BodyState,
        reference: f64,
        start: Option<&Around>,
        middle: &Around,
        relaxes: bool,
    ) -> [f64; 2] {
        let beside = self.error_of_face(BESIDE, state, reference, start, middle, relaxes);
        let far = self.error_of_face(FAR, state, reference, start, middle, relaxes);
        [beside[0] + far[0], maximum(beside[1], far[1])]
    }

    /// [`StageBody::cooling_error`] of one face.
    #[inline(always)]
    fn error_of_face(
        &self,
        face: usize,
        state: &BodyState,
        reference: f64,
        start: Option<&Around>,
        middle: &Around,
        relaxes: bool,
    ) -> [f64; 2] {
        let Some((own, count)) = self.own else { return [0.0; 2] };
        let cools = face < Self::COOLED && self.cools[face];
        if !cools && !own.is_linear(face) {
            return [0.0; 2];
        }
        let (air, port, is_contact) = (&own.air[face], PORTS_OF_FACES[face], COMMON && cools);
        if relaxes && !cools {
            let [first, last] = self.flux[port];
            return [cooling_error(0.5 * (last - first), air.rest, own.by_face[face]), 0.0];
        }
        let law =
            |t: f64, around: &Around| air.law(reference, t, around.ambient[0], around.forced[0], around.neighbour[0]);
        let observed = if is_contact { &own.contact } else { &own.cooled[face] };
        let free = if is_contact {
            own.contact_at([1], &state.heat, count)[0]
        } else {
            observed.of_states(1, &state.heat, count) + self.prescribed(observed, 1)
        };
        let t = self.add_fluxes(free, observed, 1);
        let between = BASIS[1][0] * self.flux[port][0] + BASIS[1][1] * self.flux[port][1];
        let [flux, fall] = law(t, middle);
        let (residual, gains) = (flux - between, own.by_face[face]);
        let error = match (start, &self.body.heat) {
            (Some(start), Some(heat)) => {
                let observation = if face == BESIDE { &heat.cooled_temperature } else { &heat.base_temperature };
                let extrapolated = self.flux.map(|[first, last]| 1.5 * first - 0.5 * last);
                let mut t = observation.of_states(&state.heat, count);
                for (direct, flux) in own.direct[face].iter().zip(&extrapolated) {
                    t += direct * flux;
                }
                varying_cooling_error(law(t, start)[0] - extrapolated[port], residual, fall, gains)
            }
            _ => cooling_error(residual, fall, gains),
        };
        let [first, last] = if cools { self.face(face) } else { [0.0; 2] };
        [error, maximum(first.abs(), last.abs())]
    }

    /// Mean temperature of a body with a table of properties at the end of the step, K above the reference; 0 for another.
    #[inline(always)]
    pub(crate) fn mean_at_end(&self, state: &BodyState) -> f64 {
        let (Some((own, count)), Some(_)) = (self.own, &self.body.properties) else { return 0.0 };
        let free = own.mean.of_states(2, &state.heat, count) + self.prescribed(&own.mean, 2);
        self.add_fluxes(free, &own.mean, 2)
    }

    /// Mean temperature of the body at the end per flux from the contact that is constant over the step, K m2/W.
    pub(crate) fn kept(&self) -> f64 {
        self.own.map_or(0.0, |(own, _)| own.mean.gain[Port::Contact as usize][2].iter().sum())
    }

    /// Approach by the thermal expansion of the body at a point, m.
    pub(crate) fn expansion(&self, state: &BodyState, point: usize) -> f64 {
        let Some((own, count)) = self.own else { return 0.0 };
        let free = own.mean.of_states(point, &state.heat, count) + self.prescribed(&own.mean, point);
        self.body.expansion * self.add_fluxes(free, &own.mean, point)
    }

    /// Whether all fluxes are finite.
    #[inline(always)]
    pub(crate) fn is_finite(&self) -> bool {
        let [contact, cooling, ambient, far] = self.flux;
        all_finite(&[contact[0], contact[1], cooling[0], cooling[1], far[0], far[1]])
            && (COMMON || all_finite(&[ambient[0], ambient[1]]))
    }

    /// Advances the thermal states and the received heat of the ports over the step; `table`: properties of both bodies, and which of
    /// them this one is.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        state: &mut BodyState,
        reference: f64,
        around: &Around,
        step: f64,
        table: Option<(&PropertyStep, usize)>,
    ) {
        let Some((own, count)) = self.own else { return };
        let table = table.filter(|_| self.body.properties.is_some());
        if table.is_some() && self.body.loses_to_air {
            state.lost += own.lost(&state.heat, count, &self.flux);
        }
        let [contact, cooling, ..] = self.flux;
        own.advance(&mut state.heat, count, contact, self.active[Port::Cooling as usize].then_some(cooling));
        const AMBIENT: usize = Port::Ambient as usize;
        const BASE: usize = Port::Base as usize;
        if Self::may_pass(AMBIENT) && self.active[AMBIENT] {
            own.add(&mut state.heat, count, AMBIENT, self.flux[AMBIENT]);
        }
        if self.active[BASE] {
            own.add(&mut state.heat, count, BASE, self.flux[BASE]);
        }
        let mut passed = [0.0; PORTS];
        for port in 0..PORTS {
            if Self::may_pass(port) {
                passed[port] = step * (QUADRATURE[0] * self.flux[port][0] + QUADRATURE[1] * self.flux[port][1]);
                state.received[port] += passed[port];
            }
        }
        if let Some((properties, side)) = table {
            properties.settle(side, self.body, state, &passed, step);
        }
        let air = &own.air[FAR];
        if !COMMON && air.path > 0.0 {
            let t = self.face(FAR);
            for stage in 0..2 {
                let by_air = air.flux_by_air(reference, t[stage], around.ambient[stage], around.forced[stage]);
                state.external += step * QUADRATURE[stage] * (by_air - self.flux[PORTS_OF_FACES[FAR]][stage]);
            }
        }
    }
}

/// Conditions around a body at both stages, or twice at one point.
pub(crate) struct Around {
    /// Ambient temperature, K above the reference.
    pub ambient: Pair,
    /// Velocity factor of forced convection.
    pub forced: Pair,
    /// Temperature of the neighbour behind the heat path, K above the reference.
    pub neighbour: Pair,
}
