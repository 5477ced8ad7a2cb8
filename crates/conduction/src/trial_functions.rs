//! Trial functions through the height of a body, orthonormal in a product of their values, and the quadrature of that product.
//!
//! Theory: docs/theory.md, section 4.2.

use numerics::quadrature::gauss_legendre;

/// Points of every panel of the quadrature.
const PANEL: usize = 10;

/// Points through the height: a quadrature that resolves every trial function, then extra points at which values of the
/// functions are needed.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    pub position: Vec<f64>,
    /// Weights of the quadrature, m.
    pub weight: Vec<f64>,
    height: f64,
}

impl Points {
    /// Gauss points of the panels between these `ends`, which span the height, and the extra points `extra`.
    pub(crate) fn new(ends: &[f64], extra: &[f64]) -> Points {
        let rule = gauss_legendre(PANEL);
        let mut points = Points { position: Vec::new(), weight: Vec::new(), height: ends[ends.len() - 1] };
        for pair in ends.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for &(node, weight) in &rule {
                points.position.push(middle + half * node);
                points.weight.push(half * weight);
            }
        }
        points.position.extend(extra);
        points
    }

    /// Integral of a function over the height by its values.
    pub(crate) fn integral(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.weight).map(|(value, weight)| value * weight).sum()
    }

    /// Mean of a function over the height by its values.
    pub(crate) fn mean(&self, values: &[f64]) -> f64 {
        self.integral(values) / self.height
    }

    /// Integral of left times right over the height.
    pub(crate) fn product(&self, left: &[f64], right: &[f64]) -> f64 {
        // Two running sums for vector instructions; the ten points of a panel come in pairs.
        let mut sum = [0.0; 2];
        let pairs = self.weight.as_chunks::<2>().0.iter().zip(left.as_chunks::<2>().0).zip(right.as_chunks::<2>().0);
        for ((weight, left), right) in pairs {
            sum[0] += weight[0] * left[0] * right[0];
            sum[1] += weight[1] * left[1] * right[1];
        }
        sum[0] + sum[1]
    }
}

/// Values and slopes of a function at the points, and its values at both faces.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub value: Vec<f64>,
    pub slope: Vec<f64>,
    pub contact: f64,
    pub far: f64,
}

impl Function {
    /// The function that gives value and slope at a distance from the contact.
    pub(crate) fn new(points: &Points, evaluate: impl Fn(f64) -> (f64, f64)) -> Function {
        let (value, slope) = points.position.iter().map(|&z| evaluate(z)).unzip();
        Function { value, slope, contact: evaluate(0.0).0, far: evaluate(points.height).0 }
    }

    /// Sum of the functions times these factors.
    pub(crate) fn sum<'a>(functions: &[Function], factors: impl Iterator<Item = &'a f64>) -> Function {
        let zeros = vec![0.0; functions[0].value.len()];
        let mut sum = Function { value: zeros.clone(), slope: zeros, contact: 0.0, far: 0.0 };
        functions.iter().zip(factors).for_each(|(function, &factor)| sum.add(factor, function));
        sum
    }

    /// Values at the points of the sum of the functions times these factors.
    pub(crate) fn sum_of_values<'a>(functions: &[Function], factors: impl Iterator<Item = &'a f64>) -> Vec<f64> {
        let mut values = vec![0.0; functions[0].value.len()];
        functions.iter().zip(factors).for_each(|(function, &factor)| add(&mut values, factor, &function.value));
        values
    }

    fn add(&mut self, factor: f64, other: &Function) {
        add(&mut self.value, factor, &other.value);
        add(&mut self.slope, factor, &other.slope);
        self.contact += factor * other.contact;
        self.far += factor * other.far;
    }

    fn scale(&mut self, factor: f64) {
        self.value.iter_mut().chain(&mut self.slope).for_each(|value| *value *= factor);
        self.contact *= factor;
        self.far *= factor;
    }

    /// Appends the part of this function orthogonal to the `others` in the `product`, with the norm 1 (orthogonalised twice, which is
    /// enough); false if it depends on them.
    pub(crate) fn join(mut self, others: &mut Vec<Function>, product: impl Fn(&[f64], &[f64]) -> f64) -> bool {
        let before = product(&self.value, &self.value).sqrt();
        for _ in 0..2 {
            for known in &*others {
                let part = product(&known.value, &self.value);
                self.add(-part, known);
            }
        }
        let norm = product(&self.value, &self.value).sqrt();
        if norm.is_nan() || norm <= 1e-7 * before {
            return false;
        }
        self.scale(1.0 / norm);
        others.push(self);
        true
    }
}

/// Adds `factor` times the values of `other`.
fn add(values: &mut [f64], factor: f64, other: &[f64]) {
    values.iter_mut().zip(other).for_each(|(value, other)| *value += factor * other);
}
