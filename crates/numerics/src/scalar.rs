//! Number types of the contact point: f64, or dual numbers with a derivative.
//!
//! Directional derivatives are computed by the same formulas as the outputs, in [`Dual`], so they are exact and consistent with
//! the outputs.
//!
//! Theory: docs/theory.md, section 6.8.

use crate::four_fifths::four_fifths;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Operations on numbers in the formulas of the contact point.
pub trait Scalar:
    Copy
    + PartialEq
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Mul<f64, Output = Self>
    + Neg<Output = Self>
{
    /// Value without the derivative.
    fn value(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Power with a constant exponent.
    fn powf(self, exponent: f64) -> Self;
    /// Power 4/5 of a number > 0.
    fn four_fifths(self) -> Self;
    /// Absolute value; its derivative at 0 is 0.
    #[inline]
    fn abs(self) -> Self {
        if self.value() < 0.0 {
            -self
        } else if self.value() == 0.0 {
            Self::from(0.0)
        } else {
            self
        }
    }

    /// Maximum of self and 0; its derivative at 0 is 0.
    #[inline]
    fn positive(self) -> Self {
        if self.value() <= 0.0 { Self::from(0.0) } else { self }
    }
}

impl Scalar for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline]
    fn exp(self) -> f64 {
        f64::exp(self)
    }
    #[inline]
    fn powf(self, exponent: f64) -> f64 {
        f64::powf(self, exponent)
    }
    #[inline]
    fn four_fifths(self) -> f64 {
        four_fifths(self)
    }
}

/// Dual number: value and derivative in one direction; nested, with the second derivative.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Dual<T = f64> {
    /// Value.
    pub value: T,
    /// Derivative.
    pub derivative: T,
}

impl<T: Scalar> From<f64> for Dual<T> {
    fn from(value: f64) -> Self {
        Dual { value: T::from(value), derivative: T::from(0.0) }
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Dual { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Dual {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
        }
    }
}

impl<T: Scalar> Mul<f64> for Dual<T> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Dual { value: self.value * factor, derivative: self.derivative * factor }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    fn value(self) -> f64 {
        self.value.value()
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Dual { value: root, derivative: self.derivative / (root * 2.0) }
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        Dual { value, derivative: self.derivative * value }
    }
    fn powf(self, exponent: f64) -> Self {
        let value = self.value.powf(exponent);
        let derivative =
            if self.value.value() == 0.0 { T::from(0.0) } else { self.derivative * value / self.value * exponent };
        Dual { value, derivative }
    }
    fn four_fifths(self) -> Self {
        let value = self.value.four_fifths();
        Dual { value, derivative: self.derivative * value / self.value * 0.8 }
    }
}

#[cfg(test)]
mod tests {
    use super::{Dual, Scalar};

    fn formula<S: Scalar>(x: S) -> S {
        (x * x + S::from(2.0)).sqrt() / (x.exp() + x.powf(1.7) * 3.0 + x.four_fifths()) - x.abs()
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        for x in [0.3, 1.0, 4.0] {
            let exact = formula(Dual { value: x, derivative: 1.0 }).derivative;
            let step = 1e-6;
            let difference = (formula(x + step) - formula(x - step)) / (2.0 * step);
            assert!((exact - difference).abs() < 1e-8, "{exact} {difference}");
            let slope = |x: f64| formula(Dual { value: x, derivative: 1.0 }).derivative;
            let nested = Dual { value: Dual { value: x, derivative: 1.0 }, derivative: Dual::from(1.0) };
            let second = formula(nested).derivative.derivative;
            let difference = (slope(x + step) - slope(x - step)) / (2.0 * step);
            assert!((second - difference).abs() < 1e-7, "{second} {difference}");
        }
    }
}
