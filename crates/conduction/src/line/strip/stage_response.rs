//! Velocity-dependent part of a stage's response to fluxes. All of it enters linearly, so that responses at
//! neighbouring velocities can be interpolated.
//!
//! Theory: docs/theory.md, sections 4.5, 4.1.

use crate::line::SurfaceInfluence;
use nalgebra::DMatrix;
use numerics::dense;

/// Largest dimension of the polynomial space of the Robin correction.
pub(crate) const RANK: usize = 8;

/// Dimensions of the parts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Layout {
    /// Cells.
    pub count: usize,
    /// States with weights.
    pub states: usize,
    /// Modes.
    pub waves: usize,
    /// Polynomials of the Robin correction.
    pub rank: usize,
    /// Lagged fluxes.
    pub lagged: usize,
}

impl Layout {
    fn lengths(&self) -> [usize; 5] {
        [4 * self.states, 4 * self.waves, 4 * self.waves, self.rank * self.count, self.rank * self.rank]
    }
}

/// Response of one stage.
#[derive(Clone, Debug)]
pub(crate) struct StageResponse {
    /// Surface influence matrices of the contact's flux, direct feedthrough included.
    pub influence: SurfaceInfluence,
    /// Direct feedthrough to the distortion, of the lagged flux, m3/W; empty without thermal expansion.
    pub feedthrough: DMatrix<f64>,
    layout: Layout,
    rest: Vec<f64>,
}

/// Parts of a stage response besides the influence matrices. Pairs: temperature, distortion.
pub(crate) struct Parts<'a> {
    /// Weights of the fluxes in each state, input included: of the flux known before the stage (in the first stage its
    /// deviation at the start, at the end the fluxes of the first stage) and of the stage's own; real and imaginary
    /// parts alternate. Empty in the first stage.
    pub weights: [&'a mut [f64]; 4],
    /// Surface amplitude and distortion of each mode due to the known flux, real and imaginary parts alternate.
    pub carried: [&'a mut [f64]; 4],
    /// The same due to the stage's own flux.
    pub own: [&'a mut [f64]; 4],
    /// V'W G of the Robin correction: one row per polynomial, by columns. In open contact for even fluxes only.
    pub response: &'a mut [f64],
    /// `(1 - H0 V'W G V)^-1 H0`, by columns.
    pub solution: &'a mut [f64],
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
        let matrix = || dense::untouched(layout.count);
        StageResponse {
            influence: SurfaceInfluence { temperature: matrix(), distortion: matrix() },
            feedthrough: dense::untouched(layout.lagged),
            rest: vec![0.0; layout.lengths().iter().sum()],
            layout,
        }
    }

    /// Parts besides the influence matrices.
    pub(crate) fn parts(&mut self) -> Parts<'_> {
        self.gains_and_parts().1
    }

    /// Influence matrices and parts.
    pub(crate) fn gains_and_parts(&mut self) -> (&mut SurfaceInfluence, Parts<'_>) {
        let [states, waves, _, polynomials, _] = self.layout.lengths();
        let (weights, rest) = self.rest.split_at_mut(states);
        let (carried, rest) = rest.split_at_mut(waves);
        let (own, rest) = rest.split_at_mut(waves);
        let (response, solution) = rest.split_at_mut(polynomials);
        let parts =
            Parts { weights: quarters(weights), carried: quarters(carried), own: quarters(own), response, solution };
        (&mut self.influence, parts)
    }

    /// See [`Parts::weights`].
    pub(crate) fn weights(&self) -> [&[f64]; 4] {
        let n = self.layout.states;
        std::array::from_fn(|part| &self.rest[part * n..(part + 1) * n])
    }

    /// See [`Parts::carried`].
    pub(crate) fn carried(&self) -> [&[f64]; 4] {
        let (first, n) = (4 * self.layout.states, self.layout.waves);
        std::array::from_fn(|part| &self.rest[first + part * n..first + (part + 1) * n])
    }

    /// See [`Parts::own`].
    pub(crate) fn own(&self) -> [&[f64]; 4] {
        let (first, n) = (4 * (self.layout.states + self.layout.waves), self.layout.waves);
        std::array::from_fn(|part| &self.rest[first + part * n..first + (part + 1) * n])
    }

    /// See [`Parts::response`] and [`Parts::solution`].
    pub(crate) fn robin(&self) -> [&[f64]; 2] {
        let [states, waves, own, polynomials, _] = self.layout.lengths();
        let (response, solution) = self.rest[states + waves + own..].split_at(polynomials);
        [response, solution]
    }

    /// Keeps the direct feedthrough to the distortion.
    pub(crate) fn keep_feedthrough(&mut self, feedthrough: FeedthroughTerms<'_>) {
        let target = self.feedthrough.as_mut_slice();
        match feedthrough {
            _ if target.is_empty() => {}
            [(one, share)] => dense::combine(target, [one[1].as_slice()], [*share]),
            [(one, share), (other, rest)] => {
                dense::combine(target, [one[1].as_slice(), other[1].as_slice()], [*share, *rest]);
            }
            _ => unreachable!("the direct feedthrough of a response is that of one or two velocities"),
        }
    }

    /// Sets this to a linear combination of four responses, with the direct feedthrough added to the influence
    /// matrices.
    pub(crate) fn combine(
        &mut self,
        responses: [&StageResponse; 4],
        factors: [f64; 4],
        (feedthrough, own): (FeedthroughTerms<'_>, f64),
    ) {
        let parts = responses.map(|response| &response.rest[..]);
        dense::combine(&mut self.rest, parts, factors);
        let parts = responses.map(|response| response.influence.temperature.as_slice());
        sum(self.influence.temperature.as_mut_slice(), parts, factors, (feedthrough, 1.0), 0);
        if !feedthrough[0].0[1].is_empty() {
            let parts = responses.map(|response| response.influence.distortion.as_slice());
            sum(self.influence.distortion.as_mut_slice(), parts, factors, (feedthrough, own), 1);
        }
    }
}

/// Direct feedthrough at one or two velocities (temperature and distortion, N x N; the second empty without thermal
/// expansion), each with its weight.
pub(crate) type FeedthroughTerms<'a> = &'a [(&'a [DMatrix<f64>; 2], f64)];

/// Linear combination of four matrices and the one or two of the direct feedthrough.
fn sum(
    target: &mut [f64],
    [a, b, c, d]: [&[f64]; 4],
    factors: [f64; 4],
    (feedthrough, own): (FeedthroughTerms<'_>, f64),
    moving: usize,
) {
    let [f, g, h, i] = factors;
    match feedthrough {
        [(one, share)] => dense::combine(target, [a, b, c, d, one[moving].as_slice()], [f, g, h, i, own * share]),
        [(one, share), (other, rest)] => {
            let sources = [a, b, c, d, one[moving].as_slice(), other[moving].as_slice()];
            dense::combine(target, sources, [f, g, h, i, own * share, own * rest]);
        }
        _ => unreachable!("the direct feedthrough of a response is that of one or two velocities"),
    }
}
