//! Galerkin projection of the conduction of one transverse mode through the height: trial functions, their reduced problem and its
//! decaying shapes.
//!
//! Theory: docs/theory.md, sections 4.6, 4.2.

use super::depth::Depth;
use crate::reduced::lagging;
use crate::trial_functions::{Function, Points};
use nalgebra::DMatrix;
use numerics::factorization;
use numerics::grading::towards_face;
use scene::FarBoundary;

/// Decays of the trial functions for a flux into the top, times the height.
const TOP_DECAYS: [f64; 4] = [1.0, 4.0, 12.0, 40.0];

/// Decays of the trial functions for a temperature of the top, times the height.
const HELD_DECAYS: [f64; 5] = [1.5, 4.5, 14.0, 40.0, 120.0];

/// Part of a shape that follows the top at once, see [`lagging`].
pub(super) fn lag(depth: &Depth, shape: &Shape) -> f64 {
    let steepest = if depth.driven_top { &TOP_DECAYS[2..] } else { &HELD_DECAYS[3..] };
    let [second, first] = [0, 1].map(|k| depth.diffusivity() * (steepest[k] / depth.height).powi(2));
    lagging(shape.rate_through_height, [first, second])
}

/// Points for decays up to `steepest` (1/m) through a body of this height, with the extra points `extra`.
pub(super) fn points(height: f64, steepest: f64, extra: &[f64]) -> Points {
    let mut ends = towards_face(1.0 / steepest, height, 3.0);
    ends.extend([0.5, 0.75, 0.9, 1.0].map(|part| part * height));
    Points::new(&ends, extra)
}

/// Eigenvalues (ascending, at least 0) and eigenvectors of a conduction matrix. The slower half is that of the inverse: rounding of
/// the fastest rates, ten decades above, would perturb it, and a steady state with it.
fn decaying(matrix: DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let count = matrix.nrows();
    let ordered = |matrix: DMatrix<f64>, sign: f64| {
        let eigen = factorization::symmetric_eigen_or_nan(matrix);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| (sign * eigen.eigenvalues[i]).total_cmp(&(sign * eigen.eigenvalues[j])));
        (order.iter().map(|&i| eigen.eigenvalues[i]).collect::<Vec<_>>(), eigen.eigenvectors.select_columns(&order))
    };
    let inverse = factorization::cholesky(matrix.clone()).map(|factor| factor.inverse());
    let (mut rates, mut vectors) = ordered(matrix, 1.0);
    if let Ok(inverse) = inverse {
        let (times, slow) = ordered(inverse, -1.0);
        for k in 0..count.div_ceil(2) {
            rates[k] = times[k].recip();
            vectors.set_column(k, &slow.column(k));
        }
    }
    rates.iter_mut().for_each(|rate| *rate = rate.max(0.0));
    (rates, vectors)
}

/// One decaying shape (Ritz mode) through the height; `C integral Z^2 dz = 1`.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Decay rate of a field with this shape, 1/s.
    pub rate: f64,
    /// Contribution of conduction through the height to `rate`, 1/s.
    pub rate_through_height: f64,
    /// Z at the contact.
    pub contact: f64,
    /// Z at the top.
    pub top: f64,
    /// Integral of Z over the height.
    pub integral: f64,
    /// Z at the extra points.
    pub extra: Vec<f64>,
}

/// Trial functions of one mode, orthonormal in the capacity-weighted product, and the reduced problem they span.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    depth: Depth,
    decay: f64,
    functions: Vec<Function>,
    /// Whether the first function is the uniform temperature.
    has_uniform: bool,
    stiffness: DMatrix<f64>,
    /// Decay rates through the height, ascending, and the coefficients of the shapes in the functions, by columns.
    rates: Vec<f64>,
    vectors: DMatrix<f64>,
}

impl Basis {
    pub(crate) fn new(depth: Depth, decay: f64) -> Basis {
        let nothing = DMatrix::zeros(0, 0);
        Basis {
            depth,
            decay,
            functions: Vec::new(),
            has_uniform: false,
            stiffness: nothing.clone(),
            rates: Vec::new(),
            vectors: nothing,
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.functions.len()
    }

    /// Adds the functions that the mean temperature needs in every body: the uniform one, for exact heat conservation; under
    /// a top of prescribed temperature those that transmit its changes.
    pub(crate) fn add_means(&mut self, points: &Points) {
        let h = self.depth.height;
        if self.depth.top == FarBoundary::Held {
            for kappa in HELD_DECAYS.map(|part| part / h) {
                self.add(
                    points,
                    Function::new(points, |z| {
                        // cosh(kappa z)/cosh(kappa h), and sinh(kappa z) over the same.
                        let (way, back) = ((kappa * (z - h)).exp(), (-2.0 * kappa * z).exp());
                        let whole = 1.0 + (-2.0 * kappa * h).exp();
                        (1.0 - way * (1.0 + back) / whole, -kappa * way * (1.0 - back) / whole)
                    }),
                );
            }
            return;
        }
        self.add_uniform(points);
        if !self.depth.has_steady_state(self.decay) {
            // Quasi-steady profile of a constant flux while the mean temperature rises linearly.
            self.add(points, Function::new(points, |z| ((1.0 - z / h).powi(2), -2.0 * (1.0 - z / h) / h)));
        }
        if self.depth.driven_top {
            if self.depth.has_steady_state(self.decay) {
                self.add_from_top(points, self.decay);
            } else {
                self.add(points, Function::new(points, |z| ((z / h).powi(2), 2.0 * z / (h * h))));
            }
            for decay in TOP_DECAYS {
                self.add_from_top(points, self.decay.hypot(decay / h));
            }
        }
    }

    /// Adds the uniform temperature through the height, the first function.
    pub(crate) fn add_uniform(&mut self, points: &Points) {
        self.has_uniform = true;
        self.add(points, Function::new(points, |_| (1.0, 0.0)));
    }

    /// Whether the uniform temperature is a trial function.
    pub(crate) fn has_uniform(&self) -> bool {
        self.has_uniform
    }

    fn add_from_top(&mut self, points: &Points, kappa: f64) {
        let field = self.depth.driven_from_top(kappa);
        self.add(points, Function::new(points, |z| field.at(z)));
    }

    /// Adds the response to a contact flux at the real rate `rate`, 1/s; false if it is linearly dependent.
    pub(crate) fn add_response(&mut self, points: &Points, rate: f64) -> bool {
        let kappa = (self.decay * self.decay + rate / self.depth.diffusivity()).sqrt();
        let profile = self.depth.profile(kappa);
        self.add(points, Function::new(points, profile))
    }

    /// Adds a function after orthogonalising it; false if it is linearly dependent.
    fn add(&mut self, points: &Points, function: Function) -> bool {
        let capacity = self.depth.capacity;
        let joined = function.join(&mut self.functions, |left, right| capacity * points.product(left, right));
        if joined {
            self.project(points);
        }
        joined
    }

    /// Completes the reduced conduction matrix by its last row and solves the eigenvalue problem for the decaying shapes.
    fn project(&mut self, points: &Points) {
        let last = self.functions.len() - 1;
        let stiffness = std::mem::replace(&mut self.stiffness, DMatrix::zeros(0, 0));
        self.stiffness = stiffness.resize(last + 1, last + 1, 0.0);
        let transfer = self.depth.top.transfer();
        let newest = &self.functions[last];
        for (i, other) in self.functions.iter().enumerate() {
            // The uniform temperature has no slope; this removes its rounding error.
            let inside = if i == 0 && self.has_uniform { 0.0 } else { points.product(&other.slope, &newest.slope) };
            let entry = self.depth.conductivity * inside
                + transfer * other.far * newest.far
                + self.depth.face * other.contact * newest.contact;
            self.stiffness[(i, last)] = entry;
            self.stiffness[(last, i)] = entry;
        }
        // Under an insulated top the uniform temperature does not decay.
        let apart = usize::from(self.has_uniform && transfer == 0.0 && self.depth.face == 0.0);
        let rest = self.stiffness.view((apart, apart), (last + 1 - apart, last + 1 - apart)).into_owned();
        if rest.is_empty() {
            (self.rates, self.vectors) = (vec![0.0], DMatrix::identity(1, 1));
            return;
        }
        let (rates, vectors) = decaying(rest);
        self.rates = vec![0.0; apart];
        self.rates.extend(rates);
        self.vectors = DMatrix::zeros(last + 1, last + 1);
        if apart == 1 {
            self.vectors[(0, 0)] = 1.0;
        }
        self.vectors.view_mut((apart, apart), (last + 1 - apart, last + 1 - apart)).copy_from(&vectors);
    }

    /// Decay rate and value at the contact of every shape, the slowest first.
    pub(crate) fn residues(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let own = self.depth.diffusivity() * self.decay * self.decay;
        self.rates.iter().enumerate().map(move |(k, rate)| {
            let contact = self.functions.iter().enumerate().map(|(i, f)| f.contact * self.vectors[(i, k)]).sum();
            (own + rate, contact)
        })
    }

    /// The shapes, the slowest first.
    pub(crate) fn shapes(&self, points: &Points) -> Vec<Shape> {
        let quadrature = points.weight.len();
        (self.residues().enumerate())
            .map(|(k, (rate, contact))| {
                let factors = self.vectors.column(k);
                let mut values = Function::sum_of_values(&self.functions, factors.iter());
                let top = self.functions.iter().zip(&factors).map(|(function, factor)| factor * function.far).sum();
                // Orthogonal to the uniform temperature where that is a shape of its own.
                let uniform = self.has_uniform && self.depth.top == FarBoundary::Insulated && self.depth.face == 0.0;
                let integral = if uniform && k > 0 { 0.0 } else { points.integral(&values) };
                Shape {
                    rate,
                    rate_through_height: self.rates[k],
                    contact,
                    top,
                    integral,
                    extra: values.split_off(quadrature),
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slowest_rate_keeps_its_digits() {
        // A block with a small heat loss through its top: 1/(C h (1/H + h/3k)) to first order.
        let depth = Depth {
            height: 0.1,
            conductivity: 55.0,
            capacity: 3.6e6,
            top: FarBoundary::Convecting(1e-6),
            face: 0.0,
            driven_top: false,
        };
        let points = points(0.1, 1e5, &[]);
        let mut basis = Basis::new(depth, 0.0);
        basis.add_means(&points);
        for rate in [0.0, 0.01, 1.0, 1e2, 1e4] {
            basis.add_response(&points, rate);
        }
        let slowest = basis.shapes(&points)[0].rate;
        let expected = 1e-6 / (3.6e6 * 0.1);
        assert!((slowest / expected - 1.0).abs() < 1e-8, "{slowest:e} {expected:e}");
    }
}
