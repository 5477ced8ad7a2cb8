//! Velocity-dependent part of a stage's response to fluxes. All of it that the modes give enters linearly, so that responses at
//! neighbouring velocities can be interpolated.
//!
//! Theory: docs/theory.md, sections 4.5, 4.1.

use super::feedthrough::Feedthrough;
use super::mirrored::MirroredInfluence;
use numerics::dense;

/// Largest dimension of the polynomial space of the Robin correction.
pub(crate) const RANK: usize = 8;

/// Dimensions of the parts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Layout {
    /// Cells, and those that are distorted.
    pub count: usize,
    pub distorted: usize,
    /// States with weights.
    pub states: usize,
    /// Modes.
    pub waves: usize,
    /// Polynomials of the Robin correction.
    pub rank: usize,
}

impl Layout {
    fn lengths(&self) -> [usize; 4] {
        let [states, waves] = [4 * self.states, 4 * self.waves];
        [states, waves, waves, 2 * self.rank * self.count]
    }
}

/// Response of one stage.
#[derive(Clone, Debug)]
pub(crate) struct StageResponse {
    /// Influence of the contact's flux on temperature and distortion, direct feedthrough included, without the Robin correction.
    pub influence: [MirroredInfluence; 2],
    layout: Layout,
    by_modes: Vec<f64>,
    /// `(1 - H0 V'W G V)^-1 H0` of the Robin correction, by columns.
    pub solution: Vec<f64>,
}

/// What the modes give besides the influence matrices. Pairs: temperature, distortion.
pub(crate) struct Parts<'a> {
    /// Weights of the fluxes in each state, input included: of the flux known before the stage (in the first stage its
    /// deviation at the start, at the end the fluxes of the first stage) and of the stage's own; real and imaginary
    /// parts alternate. Empty in the first stage.
    pub weights: [&'a mut [f64]; 4],
    /// Surface amplitude and distortion of each mode due to the known flux, real and imaginary parts alternate.
    pub carried: [&'a mut [f64]; 4],
    /// The same due to the stage's own flux.
    pub own: [&'a mut [f64]; 4],
    /// Responses of the cells to the polynomials V of the Robin correction, by columns: by the modes, and in a prepared step of
    /// temperature by the direct feedthrough too.
    pub lifted: [&'a mut [f64]; 2],
}

fn halves<T>(slice: &mut [T]) -> [&mut [T]; 2] {
    let (left, right) = slice.split_at_mut(slice.len() / 2);
    [left, right]
}

fn quarters<T>(slice: &mut [T]) -> [&mut [T]; 4] {
    let [left, right] = halves(slice);
    let ([a, b], [c, d]) = (halves(left), halves(right));
    [a, b, c, d]
}

impl StageResponse {
    /// A response of these dimensions, not yet computed.
    pub(crate) fn new(layout: Layout) -> StageResponse {
        StageResponse {
            influence: [layout.count, layout.distorted].map(MirroredInfluence::new),
            by_modes: vec![0.0; layout.lengths().iter().sum()],
            solution: vec![0.0; layout.rank * layout.rank],
            layout,
        }
    }

    /// Parts besides the influence matrices.
    pub(crate) fn parts(&mut self) -> Parts<'_> {
        self.gains_and_parts().1
    }

    /// Influence and parts.
    pub(crate) fn gains_and_parts(&mut self) -> (&mut [MirroredInfluence; 2], Parts<'_>) {
        let mut rest = &mut self.by_modes[..];
        let [weights, carried, own, lifted] =
            self.layout.lengths().map(|length| rest.split_off_mut(..length).expect("the parts have these lengths"));
        let [weights, carried, own] = [weights, carried, own].map(quarters);
        (&mut self.influence, Parts { weights, carried, own, lifted: halves(lifted) })
    }

    /// See [`Parts::weights`].
    pub(crate) fn weights(&self) -> [&[f64]; 4] {
        self.four(0, self.layout.states)
    }

    /// See [`Parts::carried`].
    pub(crate) fn carried(&self) -> [&[f64]; 4] {
        self.four(4 * self.layout.states, self.layout.waves)
    }

    /// See [`Parts::own`].
    pub(crate) fn own(&self) -> [&[f64]; 4] {
        self.four(4 * (self.layout.states + self.layout.waves), self.layout.waves)
    }

    fn four(&self, first: usize, n: usize) -> [&[f64]; 4] {
        std::array::from_fn(|part| &self.by_modes[first + part * n..first + (part + 1) * n])
    }

    /// See [`Parts::lifted`].
    pub(crate) fn lifted(&self) -> [&[f64]; 2] {
        let length = self.layout.rank * self.layout.count;
        let (rest, distortion) = self.by_modes.split_at(self.by_modes.len() - length);
        [&rest[rest.len() - length..], distortion]
    }

    /// Sets this to a linear combination of four responses, with the direct feedthrough added to the influence matrices; `lagged`: weight
    /// of the stage's own flux in the lagged one.
    pub(crate) fn combine(
        &mut self,
        responses: [&StageResponse; 4],
        factors: [f64; 4],
        (feedthrough, lagged): (&Feedthrough, f64),
    ) {
        let parts = responses.map(|response| &response.by_modes[..]);
        dense::combine(&mut self.by_modes, parts, factors);
        let ([f, g, h, i], directly) = (factors, feedthrough.influence.each_ref());
        for (k, (own, factor)) in self.influence.iter_mut().zip([1.0, lagged]).enumerate() {
            let [a, b, c, d] = responses.map(|response| &response.influence[k]);
            own.combine([a, b, c, d, directly[k]], [f, g, h, i, factor]);
        }
    }

    /// Adds the direct feedthrough to the influence matrices.
    pub(crate) fn add(&mut self, feedthrough: &Feedthrough, lagged: f64) {
        let parts = feedthrough.influence.iter().zip([1.0, lagged]);
        self.influence.iter_mut().zip(parts).for_each(|(own, (other, factor))| own.add(other, factor));
    }
}
