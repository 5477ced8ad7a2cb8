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
    fn lengths(&self) -> [usize; 8] {
        let lifted = self.rank * self.count;
        let [states, waves] = [4 * self.states, 4 * self.waves];
        [states, waves, waves, lifted, self.rank * self.rank, 2 * lifted, lifted, self.count]
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
    /// G V by the modes alone, by columns: temperature, distortion.
    pub by_modes: [&'a mut [f64]; 2],
    /// Direct feedthrough of the polynomials V, by columns, and of a uniform unit flux.
    pub direct: &'a mut [f64],
    pub uniform: &'a mut [f64],
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
        let mut rest = &mut self.rest[..];
        let [weights, carried, own, response, solution, by_modes, direct, uniform] =
            self.layout.lengths().map(|length| rest.split_off_mut(..length).expect("the parts have these lengths"));
        let [weights, carried, own] = [weights, carried, own].map(quarters);
        let by_modes = halves(by_modes);
        let parts = Parts { weights, carried, own, response, solution, by_modes, direct, uniform };
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
        [3, 4].map(|part| self.part(part))
    }

    /// See [`Parts::direct`] and [`Parts::uniform`].
    pub(crate) fn direct(&self) -> [&[f64]; 2] {
        [6, 7].map(|part| self.part(part))
    }

    fn part(&self, number: usize) -> &[f64] {
        let lengths = self.layout.lengths();
        let first: usize = lengths[..number].iter().sum();
        &self.rest[first..first + lengths[number]]
    }

    /// Keeps the direct feedthrough of the polynomials and of a uniform flux.
    pub(crate) fn keep_direct(&mut self, feedthrough: FeedthroughTerms<'_>) {
        let Parts { direct, uniform, .. } = self.parts();
        direct.fill(0.0);
        uniform.fill(0.0);
        for (at, share) in feedthrough {
            dense::multiply_add(&at.uniform, &[*share], uniform);
            if !direct.is_empty() {
                dense::multiply_add(&at.lifted, &[*share], direct);
            }
        }
    }

    /// Keeps the direct feedthrough to the distortion.
    pub(crate) fn keep_feedthrough(&mut self, feedthrough: FeedthroughTerms<'_>) {
        let target = self.feedthrough.as_mut_slice();
        match feedthrough {
            _ if target.is_empty() => {}
            [(one, share)] => dense::combine(target, [one.matrices[1].as_slice()], [*share]),
            [(one, share), (other, rest)] => {
                let matrices = [one, other].map(|feedthrough| feedthrough.matrices[1].as_slice());
                dense::combine(target, matrices, [*share, *rest]);
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
        if !feedthrough[0].0.matrices[1].is_empty() {
            let parts = responses.map(|response| response.influence.distortion.as_slice());
            sum(self.influence.distortion.as_mut_slice(), parts, factors, (feedthrough, own), 1);
        }
    }
}

/// Direct feedthrough at a velocity.
#[derive(Clone, Debug)]
pub(crate) struct Feedthrough {
    /// Of temperature and distortion, N x N; the second empty without thermal expansion.
    pub matrices: [DMatrix<f64>; 2],
    /// Temperatures by the polynomials of the Robin correction, by columns, and by a uniform unit flux.
    pub lifted: Vec<f64>,
    pub uniform: Vec<f64>,
}

/// Direct feedthrough at one or two velocities, each with its weight.
pub(crate) type FeedthroughTerms<'a> = &'a [(&'a Feedthrough, f64)];

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
        [(one, share)] => {
            dense::combine(target, [a, b, c, d, one.matrices[moving].as_slice()], [f, g, h, i, own * share]);
        }
        [(one, share), (other, rest)] => {
            let [one, other] = [one, other].map(|feedthrough| feedthrough.matrices[moving].as_slice());
            let sources = [a, b, c, d, one, other];
            dense::combine(target, sources, [f, g, h, i, own * share, own * rest]);
        }
        _ => unreachable!("the direct feedthrough of a response is that of one or two velocities"),
    }
}
