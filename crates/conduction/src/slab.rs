//! Conduction through the height of a body: the exact impedance, and its reduction to a few states.
//!
//! The mean temperature over the cross-section, `T(z, t)` relative to the reference, obeys
//!
//! ```text
//! C dT/dt = K T'' - B (T - T_ambient),                     0 < z < h, contact at z = 0
//! -K T'(0) = q_contact + q_cooling - H0 (T(0) - T_ambient)  (cooling here: strip)
//! -K T'(h) = Hb (T(h) - T_ambient) - q_base, or T(h) = T_base
//! ```
//!
//! with capacity C (J/(m3 K)), conductivity K (W/(m K)), loss to air by volume B (W/(m3 K), the fin
//! equation of a block cooled on its sides) and heat transfer coefficients H0, Hb (W/(m2 K)).
//!
//! Reduction: Galerkin projection on exact solutions at real frequencies spaced geometrically from the slab's own `kd/h^2`
//! to the highest frequency of interest (a rational Krylov space), the stationary solutions and the uniform temperature. The
//! projected problem is symmetric, so its states are real and decay; it interpolates the exact impedance and its derivative
//! at those frequencies, and because the uniform temperature is in the space, heat is conserved exactly. The fastest state
//! becomes a static correction.
//!
//! Validity: uniform temperature over the cross-section (small transverse Biot number) for the
//! loss by volume; any slab otherwise.
//!
//! Theory: docs/theory.md, section 4.2.

mod projection;

use super::reduced::lagging;
use super::trial_functions::Points;
use nalgebra::Complex;
use numerics::grading::towards_face;
use scene::{Body, FarBoundary};

/// Location of the cooling beyond the constant heat transfer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum CoolingPort {
    /// On the contact face (a strip's free surface).
    Surface,
    /// Evenly along the height (a block's sides).
    Sides,
}

/// Slab model of a body; symbols in the module documentation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Slab {
    /// Height h, m.
    pub height: f64,
    /// Conductivity K, W/(m K), > 0.
    pub conductivity: f64,
    /// Heat capacity C by volume, J/(m3 K).
    pub capacity: f64,
    /// Heat transfer coefficient H0 of the contact face, W/(m2 K).
    pub surface_transfer: f64,
    /// Heat loss B by volume, W/(m3 K).
    pub volume_transfer: f64,
    /// Boundary condition at z = h.
    pub base: FarBoundary,
    /// Location of the variable cooling.
    pub cooling: CoolingPort,
}

impl Slab {
    /// The slab of a conducting body, as [`Slab::bare`].
    pub fn of(body: &Body) -> Slab {
        Slab::bare(body.height, [body.conductivity, body.capacity()], body.far_boundary())
    }

    /// A slab of this height (m), conductivity (W/(m K)) and capacity (J/(m3 K)) that loses no heat but through its base; the variable
    /// cooling is at the contact face.
    pub fn bare(height: f64, [conductivity, capacity]: [f64; 2], base: FarBoundary) -> Slab {
        Slab {
            height,
            conductivity,
            capacity,
            surface_transfer: 0.0,
            volume_transfer: 0.0,
            base,
            cooling: CoolingPort::Surface,
        }
    }
}

/// Square root with positive real part. Algebraic, so a few times faster than by polar form; sufficiently accurate because
/// the argument is never close to the negative axis in these problems.
pub(crate) fn principal_root(z: Complex<f64>) -> Complex<f64> {
    let modulus = (z.re * z.re + z.im * z.im).sqrt();
    if z.re >= 0.0 {
        let re = (0.5 * (modulus + z.re)).sqrt();
        let im = if re > 0.0 { 0.5 * z.im / re } else { 0.0 };
        return Complex::new(re, im);
    }
    let im = (0.5 * (modulus - z.re)).sqrt().copysign(z.im);
    Complex::new(0.5 * z.im / im, im)
}

/// Shifts of the responses to a prescribed temperature or a flux at the base, over the slab's own rate `kd/h^2`. Both may jump: a heat
/// path may open at any time.
const BASE_SHIFTS: [f64; 4] = [1.0, 16.0, 160.0, 1600.0];

/// Difference of two decays, in units of 1/h, below which their integral is evaluated by its series.
const CONFLUENT: f64 = 1e-3;

/// q h beyond which the slab equals a half-plane: 2 exp(-2 q h) = 5e-16.
const HALF_PLANE: f64 = 18.0;

/// Temperature field through the height: its value and slope at the depth z.
type Field = Box<dyn Fn(f64) -> (f64, f64)>;

impl Slab {
    /// Thermal diffusivity of the contact face, m2/s.
    pub(crate) fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }

    /// Conductivity (W/(m K)) and capacity (J/(m3 K)) of where heat spreads fastest along the slab.
    pub(crate) fn spreading(&self) -> [f64; 2] {
        [self.conductivity, self.capacity]
    }

    /// Exact temperature of the contact face per uniform heat flux into it, K m2/W, at the complex
    /// frequency `s` (1/s) and wave number `q` along the surface (1/m).
    pub fn impedance(&self, s: Complex<f64>, q: f64) -> Complex<f64> {
        let k = self.conductivity;
        let kappa_squared = s / self.diffusivity() + self.volume_transfer / k + q * q;
        let kappa = principal_root(kappa_squared);
        let u = kappa * self.height;
        // Admittance q/T(0) = K kappa (sinh u + beta cosh u)/(cosh u + beta sinh u), with beta = Hb/(K kappa).
        // Squared modulus: evaluated for every mode at every speed of a table, where an overflow-safe modulus would double
        // the cost.
        let admittance = if u.norm_sqr() < 1e-8 {
            // Small argument: the slab is a heat capacity in series with (or parallel to) its base.
            let own = k * kappa_squared * self.height;
            match self.base {
                FarBoundary::Held => (k / self.height).into(),
                FarBoundary::Insulated => own / (1.0 + kappa_squared * self.height.powi(2) / 3.0),
                FarBoundary::Convecting(transfer) => (own + transfer) / (1.0 + transfer * self.height / k),
            }
        } else {
            // Beyond 20 decay lengths the base has no effect to rounding.
            if u.re > 20.0 {
                return (kappa * k + self.surface_transfer).inv();
            }
            let decay = (-2.0 * u).exp();
            let (sum, difference) = (1.0 + decay, 1.0 - decay);
            match self.base {
                FarBoundary::Held => sum / difference * kappa * k,
                FarBoundary::Insulated => difference / sum * kappa * k,
                FarBoundary::Convecting(transfer) => {
                    let beta = transfer / (kappa * k);
                    (difference + beta * sum) / (sum + beta * difference) * kappa * k
                }
            }
        };
        (admittance + self.surface_transfer).inv()
    }

    /// Integral over the height of the field of frequency `s` (1/s) and wave number `q` (1/m) with the temperature `contact` (K) at the
    /// contact face, without loss by volume, times `A exp(-qz) + B exp(-q(h-z))`, K m. B must be 0 from q h = 20 on.
    pub(crate) fn moment(
        &self,
        s: Complex<f64>,
        q: f64,
        contact: Complex<f64>,
        [direct, reflected]: [f64; 2],
    ) -> Complex<f64> {
        let h = self.height;
        let kappa = principal_root(s / self.diffusivity() + q * q);
        // Integrals over the depth of the four products of exponentials.
        let slow = (-q * h).exp();
        // Decay through the depth, in units of 1/h, from which on the influence of the base is below rounding.
        if kappa.re * h > 40.0 {
            // The temperature at the base is zero to rounding.
            let mut integral = direct / (kappa + q);
            if reflected != 0.0 {
                // B is nonzero only for q h up to 20, so the two decays differ.
                integral += slow * reflected / (kappa - q);
            }
            return contact * integral;
        }
        let reflection = match self.base {
            FarBoundary::Held => Complex::from(-1.0),
            FarBoundary::Insulated => Complex::from(1.0),
            FarBoundary::Convecting(transfer) => {
                let beta = transfer / (kappa * self.conductivity);
                (1.0 - beta) / (1.0 + beta)
            }
        };
        let fast = (-kappa * h).exp();
        let together = (1.0 - slow * fast) / (kappa + q);
        let difference = (kappa - q) * h;
        let apart = if difference.norm_sqr() < CONFLUENT * CONFLUENT {
            // (1 - exp(-x))/x
            slow * h * (1.0 - 0.5 * difference + difference * difference / 6.0 - difference.powi(3) / 24.0)
        } else {
            (slow - fast) / (kappa - q)
        };
        let integral =
            together * direct + apart * reflected + reflection * fast * (apart * direct + together * reflected);
        contact * integral / (1.0 + reflection * fast * fast)
    }

    /// Rate of conduction through the height, 1/s.
    pub(crate) fn own_rate(&self) -> f64 {
        self.diffusivity() / self.height.powi(2)
    }

    /// Lower bound of the decay rates (1/s) of fields of the wave number `q` (1/m) along the slab.
    pub(crate) fn slowest_decay(&self, q: f64) -> f64 {
        self.diffusivity() * q * q
    }

    /// Wave number (1/m) from which on the slab responds as a half-plane of its contact face's material.
    pub(crate) fn half_plane_from(&self) -> f64 {
        HALF_PLANE / self.height
    }

    /// Decay through the height (1/m) of a field at the real frequency `shift`, 1/s.
    fn decay(&self, shift: f64) -> f64 {
        (shift / self.diffusivity() + self.volume_transfer / self.conductivity).sqrt()
    }

    /// Part of a state of decay rate `rate` (1/s) that follows the base at once, see [`lagging`].
    fn lag(&self, rate: f64) -> f64 {
        let [.., second, first] = BASE_SHIFTS;
        let steepest = [first, second].map(|shift| shift * self.diffusivity() / self.height.powi(2));
        lagging(rate, steepest)
    }

    /// Heat capacity per area, J/(m2 K).
    pub(crate) fn areal_capacity(&self) -> f64 {
        self.capacity * self.height
    }

    /// Thermal effusivity of the contact face, W s^(1/2)/(m2 K).
    fn effusivity(&self) -> f64 {
        (self.conductivity * self.capacity).sqrt()
    }

    /// Ends of the panels of a quadrature through the height for fields that decay as those of the rate `fastest`, 1/s.
    fn panels(&self, fastest: f64) -> Vec<f64> {
        let mut ends = towards_face((self.diffusivity() / fastest).sqrt(), self.height, 3.0);
        // Fields that begin at the base decay over a fortieth of the height at least.
        ends.extend([0.5, 0.7, 0.85, 0.95, 1.0].map(|part| part * self.height));
        ends
    }

    /// Fields of uniform temperature and of constant fluxes.
    fn stationary_fields(&self) -> Vec<Field> {
        let (h, held) = (self.height, self.base == FarBoundary::Held);
        let mut fields: Vec<Field> = Vec::new();
        if !held {
            fields.push(Box::new(|_| (1.0, 0.0)));
        }
        let fin = (self.volume_transfer / self.conductivity).sqrt();
        if fin * h > 1e-3 {
            fields.push(self.contact_response(0.0));
            if !held {
                fields.push(self.base_response(0.0));
            }
        } else {
            fields.push(Box::new(move |z| (1.0 - z / h, -1.0 / h)));
        }
        if !held {
            fields.push(Box::new(move |z| ((1.0 - z / h).powi(2), -2.0 * (1.0 - z / h) / h)));
        }
        if self.cooling == CoolingPort::Sides && held {
            fields.push(Box::new(move |z| (1.0 - (z / h).powi(2), -2.0 * z / (h * h))));
        }
        fields
    }

    /// Response to a contact flux at the real frequency `shift`, 1/s.
    fn contact_response(&self, shift: f64) -> Field {
        let (kappa, h) = (self.decay(shift), self.height);
        // Sum of a wave leaving the contact and its reflection; scaled against overflow.
        let reflection = match self.base {
            FarBoundary::Held => -1.0,
            FarBoundary::Insulated => 1.0,
            FarBoundary::Convecting(transfer) => {
                let beta = transfer / (self.conductivity * kappa);
                (1.0 - beta) / (1.0 + beta)
            }
        };
        Box::new(move |z| {
            let down = (-kappa * z).exp();
            // The reflection is below rounding over a longer path: exp(-40) = 4e-18.
            let up = if kappa * (h - z) > 20.0 { 0.0 } else { reflection * (-kappa * (2.0 * h - z)).exp() };
            (down + up, kappa * (up - down))
        })
    }

    /// Response to the boundary value at the base at the real frequency `shift`, 1/s; under a prescribed temperature, what it lacks
    /// of the stationary response, since a trial function vanishes there.
    fn base_response(&self, shift: f64) -> Field {
        let (kappa, h) = (self.decay(shift), self.height);
        if self.base == FarBoundary::Held {
            let [steady, response] = [0.0, shift].map(|shift| BaseField::new(self, shift));
            return Box::new(move |z| (steady.at(z) - response.at(z), steady.slope(z) - response.slope(z)));
        }
        Box::new(move |z| {
            let (up, down) = ((-kappa * (h - z)).exp(), (-kappa * (h + z)).exp());
            (up + down, kappa * (up - down))
        })
    }

    /// Heat of a field, J/m2.
    fn heat_of(&self, points: &Points, field: &[f64]) -> f64 {
        self.areal_capacity() * points.mean(field)
    }

    /// Heat of the product of two fields, J/(m2 K): the inner product of the projection.
    fn heat(&self, points: &Points, left: &[f64], right: &[f64]) -> f64 {
        self.capacity * points.product(left, right)
    }

    /// Conduction through the height by the product of two slopes, W/(m2 K).
    fn conduction(&self, points: &Points, left: &[f64], right: &[f64]) -> f64 {
        self.conductivity * points.product(left, right)
    }
}

/// Height over the decay length of lateral cooling below which the stationary field is a straight line to rounding.
const THIN: f64 = 1e-6;

/// Temperature field per unit temperature prescribed at the base, at a real frequency; zero for other bases.
struct BaseField {
    kappa: f64,
    height: f64,
    beta: f64,
    held: bool,
}

impl BaseField {
    fn new(slab: &Slab, shift: f64) -> BaseField {
        BaseField {
            kappa: slab.decay(shift),
            height: slab.height,
            beta: slab.surface_transfer / slab.conductivity,
            held: slab.base == FarBoundary::Held,
        }
    }

    /// `cosh(kappa z) + (beta/kappa) sinh(kappa z)` over its value at the base, in exponentials that do not overflow.
    fn at(&self, z: f64) -> f64 {
        if !self.held {
            return 0.0;
        }
        let (u, whole) = (self.kappa * z, self.kappa * self.height);
        if whole < THIN {
            return (1.0 + self.beta * z) / (1.0 + self.beta * self.height);
        }
        let ratio = self.beta / self.kappa;
        let scaled = |u: f64| (1.0 + ratio) * (u - whole).exp() + (1.0 - ratio) * (-u - whole).exp();
        scaled(u) / scaled(whole)
    }

    /// Slope of [`BaseField::at`], 1/m.
    fn slope(&self, z: f64) -> f64 {
        let (u, whole) = (self.kappa * z, self.kappa * self.height);
        if whole < THIN {
            return self.beta / (1.0 + self.beta * self.height);
        }
        let ratio = self.beta / self.kappa;
        let at_base = (1.0 + ratio) + (1.0 - ratio) * (-2.0 * whole).exp();
        self.kappa * ((1.0 + ratio) * (u - whole).exp() - (1.0 - ratio) * (-u - whole).exp()) / at_base
    }

    /// Mean of [`BaseField::at`] over the height.
    fn mean(&self) -> f64 {
        if !self.held {
            return 0.0;
        }
        let whole = self.kappa * self.height;
        if whole < THIN {
            return (1.0 + 0.5 * self.beta * self.height) / (1.0 + self.beta * self.height);
        }
        let ratio = self.beta / self.kappa;
        // Twice exp(-whole) times sinh(whole) + ratio (cosh(whole) - 1), and times the profile at the base.
        let integral = -(-2.0 * whole).exp_m1() + ratio * (-whole).exp_m1().powi(2);
        let at_base = (1.0 + ratio) + (1.0 - ratio) * (-2.0 * whole).exp();
        integral / (whole * at_base)
    }
}

#[cfg(test)]
mod tests;
