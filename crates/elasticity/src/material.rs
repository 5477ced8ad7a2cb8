//! Isotropic linear elasticity and the error for a value outside its range.
//!
//! Theory: docs/theory.md, section 1.4.

use std::fmt;

/// A value outside the range in which the model holds.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfRange {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// The value found.
    pub value: f64,
    /// Admissible range.
    pub requirement: &'static str,
}

impl OutOfRange {
    /// `Ok` where the condition holds.
    pub fn unless(
        condition: bool,
        quantity: &'static str,
        value: f64,
        requirement: &'static str,
    ) -> Result<(), OutOfRange> {
        if condition { Ok(()) } else { Err(OutOfRange { quantity, value, requirement }) }
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {} is out of range: must be {}", self.quantity, self.value, self.requirement)
    }
}

impl std::error::Error for OutOfRange {}

/// Isotropic linear elastic material in plane strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    youngs_modulus: f64,
    poissons_ratio: f64,
}

impl Material {
    /// Material with Young's modulus in Pa, positive, and Poisson's ratio from 0 to below 0.5.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self, OutOfRange> {
        let positive = youngs_modulus.is_finite() && youngs_modulus > 0.0;
        OutOfRange::unless(positive, "Young's modulus", youngs_modulus, "positive, in Pa")?;
        let valid = (0.0..0.5).contains(&poissons_ratio);
        OutOfRange::unless(valid, "Poisson's ratio", poissons_ratio, "from 0 to below 0.5")?;
        Ok(Self { youngs_modulus, poissons_ratio })
    }

    /// Poisson's ratio nu.
    pub fn poissons_ratio(&self) -> f64 {
        self.poissons_ratio
    }

    /// Shear modulus `G = E/(2 (1 + nu))`, in Pa.
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)
    }

    /// Plane strain modulus `E* = E/(1 - nu^2)`, in Pa.
    pub fn plane_strain_modulus(&self) -> f64 {
        self.youngs_modulus / (1.0 - self.poissons_ratio * self.poissons_ratio)
    }

    /// Modulus of uniaxial strain `lambda + 2 G = E (1 - nu)/((1 + nu)(1 - 2 nu))`, in Pa.
    pub fn uniaxial_modulus(&self) -> f64 {
        let nu = self.poissons_ratio;
        self.youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_values_are_named() {
        let error = Material::new(200e9, 0.5).unwrap_err();
        assert_eq!(error.to_string(), "Poisson's ratio = 0.5 is out of range: must be from 0 to below 0.5");
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Material::new(bad, 0.3).is_err());
        }
        for bad in [-0.1, 0.6, f64::NAN] {
            assert!(Material::new(1.0, bad).is_err());
        }
    }
}
