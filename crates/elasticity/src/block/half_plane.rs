//! Elastic half-plane z >= 0 under a uniform pressure on an interval of its surface, in closed form.
//!
//! The block's own field differs from it by a part that is smooth away from the corners, so the finite elements need not
//! represent the logarithm of a discontinuous pressure. Plane strain, displacements times the shear modulus, unit pressure
//! pushing into +z, stresses positive in tension. Source: K. L. Johnson, Contact Mechanics, Cambridge 1985, sections 2.2 and
//! 2.5; the constant of the displacement is fixed by the length scale of the logarithm.
//!
//! Theory: docs/theory.md, sections 3.4, 3.2.

use std::f64::consts::PI;

/// Half-plane of a given Poisson's ratio.
#[derive(Clone, Copy, Debug)]
pub struct HalfPlane {
    /// nu, 1.
    pub poissons_ratio: f64,
    /// Length at which the logarithm of the displacement under a line load is zero, m.
    pub scale: f64,
}

/// Stress components (xx, zz, xz) per unit pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stress {
    /// Normal stress along the surface, 1.
    pub xx: f64,
    /// Normal stress across it, 1.
    pub zz: f64,
    /// Shear stress, 1.
    pub xz: f64,
}

impl HalfPlane {
    /// Displacement (u_x, u_z) times the shear modulus at distance `x` along and `z` below a unit line load.
    pub(crate) fn line_load_displacement(&self, x: f64, z: f64) -> (f64, f64) {
        let nu = self.poissons_ratio;
        let square = x * x + z * z;
        let along = x * z / square - (1.0 - 2.0 * nu) * x.atan2(z);
        let into = z * z / square - (1.0 - nu) * (square / (self.scale * self.scale)).ln();
        (along / (2.0 * PI), into / (2.0 * PI))
    }

    /// Displacement (u_x, u_z) times the shear modulus at (x, z) by unit pressure on `cell`.
    pub(crate) fn displacement(&self, cell: (f64, f64), x: f64, z: f64) -> (f64, f64) {
        let (right, left) = (self.primitive(x - cell.0, z), self.primitive(x - cell.1, z));
        (right.0 - left.0, right.1 - left.1)
    }

    /// Antiderivative of the line load's displacement along x.
    fn primitive(&self, x: f64, z: f64) -> (f64, f64) {
        let nu = self.poissons_ratio;
        let square = x * x + z * z;
        let logarithm = if square > 0.0 { 0.5 * (square / (self.scale * self.scale)).ln() } else { 0.0 };
        let angle = x.atan2(z);
        let along = z * logarithm - (1.0 - 2.0 * nu) * (x * angle - z * logarithm);
        let into = z * angle - 2.0 * (1.0 - nu) * (x * logarithm - x + z * angle);
        (along / (2.0 * PI), into / (2.0 * PI))
    }

    /// Stress at (x, z) by unit pressure on `cell`; at an end of the cell on the surface the limit from below.
    pub(crate) fn stress(&self, cell: (f64, f64), x: f64, z: f64) -> Stress {
        let at = |distance: f64| {
            let square = distance * distance + z * z;
            let ratio = |product: f64| if square > 0.0 { product / square } else { 0.0 };
            (distance.atan2(z), ratio(distance * z), ratio(z * z))
        };
        let (right, left) = (at(x - cell.0), at(x - cell.1));
        let angle = right.0 - left.0;
        let product = right.1 - left.1;
        Stress { xx: -(angle - product) / PI, zz: -(angle + product) / PI, xz: (right.2 - left.2) / PI }
    }

    /// Integral over `observed` of the surface's normal displacement (times the shear modulus) by unit pressure on
    /// `loaded`: -(1 - nu)/pi times the double integral of ln(|x - s|/scale). The cells coincide or do not overlap.
    pub(crate) fn normal_influence(&self, observed: (f64, f64), loaded: (f64, f64)) -> f64 {
        -(1.0 - self.poissons_ratio) / PI * logarithm_integral(observed, loaded, self.scale)
    }

    /// Integral over `observed` of the surface's displacement along x (times the shear modulus) by unit pressure on
    /// `loaded`; the cells coincide or do not overlap.
    pub(crate) fn tangential_influence(&self, observed: (f64, f64), loaded: (f64, f64)) -> f64 {
        let side = if observed.0 >= loaded.1 {
            1.0
        } else if observed.1 <= loaded.0 {
            -1.0
        } else {
            0.0
        };
        -(1.0 - 2.0 * self.poissons_ratio) / 4.0 * side * (observed.1 - observed.0) * (loaded.1 - loaded.0)
    }
}

/// Conducting half-plane z >= 0 under a uniform flux on an interval of its surface; temperatures times the conductivity,
/// unit flux into the body, the constant fixed by the scale of the logarithm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConductingHalfPlane {
    /// Length at which the temperature by a line source is zero, m.
    pub scale: f64,
}

impl ConductingHalfPlane {
    /// Temperature at distance `x` along and `z` below a unit line source.
    pub(crate) fn line_source_temperature(&self, x: f64, z: f64) -> f64 {
        -0.5 / PI * ((x * x + z * z) / (self.scale * self.scale)).ln()
    }

    /// Temperature at (x, z), z > 0, by unit flux on `cell`.
    pub(crate) fn temperature(&self, cell: (f64, f64), x: f64, z: f64) -> f64 {
        let primitive = |x: f64| 0.5 * x * ((x * x + z * z) / (self.scale * self.scale)).ln() - x + z * x.atan2(z);
        (primitive(x - cell.1) - primitive(x - cell.0)) / PI
    }

    /// Slope of the temperature along x at (x, z), z > 0, by unit flux on `cell`.
    pub(crate) fn slope_along(&self, cell: (f64, f64), x: f64, z: f64) -> f64 {
        self.line_source_temperature(x - cell.0, z) - self.line_source_temperature(x - cell.1, z)
    }

    /// Integral over `observed` of the surface temperature by unit flux on `loaded`. The cells coincide or do not
    /// overlap.
    pub(crate) fn influence(&self, observed: (f64, f64), loaded: (f64, f64)) -> f64 {
        -logarithm_integral(observed, loaded, self.scale) / PI
    }
}

/// Double integral of ln(|x - s|/scale) over x in `observed` and s in `loaded`, which coincide or do not overlap.
fn logarithm_integral(observed: (f64, f64), loaded: (f64, f64), scale: f64) -> f64 {
    let second = |distance: f64| {
        if distance == 0.0 { 0.0 } else { 0.5 * distance * distance * ((distance / scale).abs().ln() - 1.5) }
    };
    let gap = (observed.0 - loaded.1).max(loaded.0 - observed.1);
    let (a, b) = (observed.1 - observed.0, loaded.1 - loaded.0);
    if gap < 16.0 * a.max(b) {
        return second(observed.1 - loaded.0) - second(observed.1 - loaded.1) - second(observed.0 - loaded.0)
            + second(observed.0 - loaded.1);
    }
    // The differences of the closed form cancel for distant small cells; the mean logarithm does not. Terms of the
    // expansion about the centres: the moments of a uniform density are w^2/12, w^4/80, w^6/448.
    let distance = 0.5 * (observed.0 + observed.1 - loaded.0 - loaded.1).abs();
    let (u, v) = ((a / distance).powi(2), (b / distance).powi(2));
    let second_moment = (u + v) / 12.0;
    let fourth_moment = (u * u + v * v) / 80.0 + 6.0 * u * v / 144.0;
    let sixth_moment = (u * u * u + v * v * v) / 448.0 + 15.0 * (u * u * v + u * v * v) / (80.0 * 12.0);
    a * b * ((distance / scale).ln() - second_moment / 2.0 - fourth_moment / 4.0 - sixth_moment / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::gauss_legendre;

    const BODY: HalfPlane = HalfPlane { poissons_ratio: 0.3, scale: 2.0 };
    const CELL: (f64, f64) = (-0.4, 0.1);

    #[test]
    fn influence_is_the_integral_of_the_surface_displacement() {
        // Pairs on both sides of the switch between closed form and expansion, and a touching one.
        for observed in [(0.1, 0.3), (0.5, 0.9), (8.0, 8.4), (9.0, 9.5), (-12.0, -11.9)] {
            let (middle, half) = (0.5 * (observed.0 + observed.1), 0.5 * (observed.1 - observed.0));
            let mut sums = (0.0, 0.0);
            for (t, weight) in gauss_legendre(200) {
                let (along, into) = BODY.displacement(CELL, middle + half * t, 0.0);
                sums.0 += half * weight * along;
                sums.1 += half * weight * into;
            }
            let exact = BODY.normal_influence(observed, CELL);
            let tolerance = if observed.0 == CELL.1 { 1e-7 } else { 1e-13 };
            assert!((exact - sums.1).abs() < tolerance, "{observed:?}: {exact} {}", sums.1);
            assert!((BODY.tangential_influence(observed, CELL) - sums.0).abs() < 1e-13);
        }
    }
}
