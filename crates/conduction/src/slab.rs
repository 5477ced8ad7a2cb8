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

use super::reduced::{MAX_SLAB_STATES, Port, ReducedBody, lagging};
use nalgebra::Complex;
use numerics::grading::LEAST_PANEL;
use numerics::maximum::maximum;
use projection::{Basis, Eigen, Grid};
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

/// Ratios of neighbouring shifts to be tried, and the largest factor by which the error falls from one to the next.
const RATIOS: [f64; 7] = [20.0, 8.0, 5.0, 3.6, 2.8, 2.3, 1.9];
const LARGEST_FALL: f64 = 4.0;

/// Shifts of the responses to a prescribed temperature or a flux at the base, over the slab's own rate `kd/h^2`. Both may jump: a heat
/// path may open at any time.
const BASE_SHIFTS: [f64; 4] = [1.0, 16.0, 160.0, 1600.0];

/// Difference of two decays, in units of 1/h, below which their integral is evaluated by its series.
const CONFLUENT: f64 = 1e-3;

/// q h beyond which the slab equals a half-plane: 2 exp(-2 q h) = 5e-16.
const HALF_PLANE: f64 = 18.0;

impl Slab {
    /// Thermal diffusivity, m2/s.
    pub(crate) fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
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

    /// Reduces the slab to a few states that follow the exact impedance on the frequencies from `1/duration` (1/s) up, to
    /// `tolerance` relative to the temperature rise of the whole duration.
    pub fn reduce(&self, duration: f64, tolerance: f64) -> ReducedBody {
        // Above this frequency the impedance is below the tolerance.
        let rise = self.impedance(Complex::from(1.0 / duration), 0.0).re;
        let effusivity = (self.conductivity * self.capacity).sqrt();
        let own = self.own_rate();
        // Above the last of these a heated layer is thinner than the grid resolves.
        let fastest =
            (1.0 / (tolerance * rise * effusivity)).powi(2).max(3.0 / duration).min(own / LEAST_PANEL.powi(2));
        // The fastest state, which becomes a static correction, is to be one of the contact, not of a base that jumps.
        let fastest = fastest.max(4.0 * BASE_SHIFTS[3] * own);
        let scan = SlabSweep::new(self, 1.0 / duration, fastest);
        let grid = Grid::new(self, fastest.max(own));
        let mut best: Option<(f64, Basis<'_>, Eigen)> = None;
        // Indices of the next ratio, of the first one not yet reached, and of the first one with too many functions.
        let (mut next, mut open, mut end) = (0, 0, RATIOS.len());
        while next < end {
            let Some(basis) = self.space(&grid, 0.05 / duration, fastest, RATIOS[next]) else {
                (end, next) = (next, open);
                continue;
            };
            open = next + 1;
            let eigen = basis.eigen();
            let error = scan.largest_error(basis.impedance(&eigen));
            if best.as_ref().is_none_or(|(known, ..)| error < *known) {
                best = Some((error, basis, eigen));
            }
            if error <= 0.1 * tolerance {
                break;
            }
            // Spaces that cannot meet the tolerance are skipped; the last is always tried.
            let falls = (error / (0.1 * tolerance)).log(LARGEST_FALL) as usize;
            next = (next + falls.max(1)).min(end - 1).max(open);
        }
        let (_, basis, eigen) = best.expect("the coarsest space has few functions, so it always fits");
        // Modes are computed for the accepted space only.
        let body = basis.modes(&eigen);
        ReducedBody { error: scan.largest_error(|s| body.impedance(s)), ..body }
    }

    /// Trial functions with shifts from `slowest` (or the slab's own rate) to `fastest` with an initial ratio of `ratio`;
    /// `None` if there are too many.
    fn space<'a>(&'a self, grid: &'a Grid, slowest: f64, fastest: f64, ratio: f64) -> Option<Basis<'a>> {
        let own = self.own_rate();
        let mut shifts = Vec::new();
        let (mut shift, mut step) = (slowest.max(0.5 * own), ratio);
        while shift < fastest {
            shifts.push(shift);
            shift *= step;
            // The impedance falls with frequency, and with it the weight of its errors.
            step *= 1.08;
        }
        shifts.push(fastest);
        let mut basis = Basis::new(self, grid);
        basis.stationary();
        for &shift in &shifts {
            basis.add_contact_response(shift);
        }
        for factor in BASE_SHIFTS {
            basis.add_base_response(factor * own);
        }
        if basis.count() > MAX_SLAB_STATES + 1 {
            return None;
        }
        Some(basis)
    }
}

/// Reduction error sweep: frequencies at which a reduced response is compared with the exact one, on the imaginary axis,
/// where the largest error bounds that of the response to any bounded flux.
struct SlabSweep {
    /// Frequencies and the exact response.
    exact: Vec<(Complex<f64>, Complex<f64>)>,
    /// Exact response at the slowest frequency, the scale of the errors.
    scale: f64,
}

impl SlabSweep {
    fn new(slab: &Slab, slowest: f64, fastest: f64) -> SlabSweep {
        let points = 40;
        let exact = (0..=points)
            // The spectrum of a constant flux lies below its own frequency, so the sweep begins there.
            .map(|i| 0.03 * slowest * (fastest / slowest / 0.03).powf(f64::from(i) / f64::from(points)))
            .map(|frequency| Complex::new(0.0, frequency))
            .map(|s| (s, slab.impedance(s, 0.0)));
        SlabSweep { exact: exact.collect(), scale: slab.impedance(Complex::new(0.0, slowest), 0.0).norm() }
    }

    fn largest_error(&self, response: impl Fn(Complex<f64>) -> Complex<f64>) -> f64 {
        self.exact.iter().map(|&(s, exact)| (response(s) - exact).norm() / self.scale).fold(0.0, maximum)
    }
}

impl ReducedBody {
    /// Contact impedance of the reduced body at the complex frequency `s` (1/s), K m2/W.
    pub(crate) fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        let contact = Port::Contact as usize;
        let states: Complex<f64> = (0..self.count)
            .map(|k| self.contact_temperature.states[k] * self.input[contact][k] / (self.rate[k] + s))
            .sum();
        states + self.contact_temperature.direct[contact]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduced::Observation;
    use nalgebra::{DMatrix, DVector};

    fn iron(base: FarBoundary) -> Slab {
        Slab::bare(0.011, [54.0, 7200.0 * 460.0], base)
    }

    fn cases() -> Vec<Slab> {
        let mut cases = Vec::new();
        for base in
            [FarBoundary::Held, FarBoundary::Insulated, FarBoundary::Convecting(200.0), FarBoundary::Convecting(1e6)]
        {
            for (surface, volume, cooling) in
                [(0.0, 0.0, CoolingPort::Surface), (80.0, 0.0, CoolingPort::Surface), (0.0, 4e3, CoolingPort::Sides)]
            {
                cases.push(Slab { surface_transfer: surface, volume_transfer: volume, cooling, ..iron(base) });
            }
        }
        cases
    }

    #[test]
    fn reduced_impedance_follows_the_exact_one() {
        for slab in cases() {
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
                let body = slab.reduce(1000.0, tolerance);
                println!("{:?} tol {tolerance:e}: {} states, error {:.1e}", slab.base, body.count, body.error);
                assert!(body.error <= 0.1 * tolerance, "{slab:?} {tolerance}: {} at {} states", body.error, body.count);
                assert!(body.rate[..body.count].iter().all(|&rate| rate >= 0.0));
            }
        }
    }

    #[test]
    fn heat_is_conserved_and_steady_flows_are_exact() {
        for slab in cases() {
            let body = slab.reduce(1000.0, 1e-3);
            if body.rate[0] == 0.0 {
                // No heat leaves: the flow is zero for every state and for the flux.
                assert!(body.base_flow.states[..body.count].iter().all(|flow| flow.abs() < 1e-9 * 7200.0 * 460.0));
                assert!(body.base_flow.direct[0].abs() < 1e-10, "{:?}", body.base_flow.direct);
                continue;
            }
            // Constant unit contact flux: all of it leaves, in the exact proportion.
            let steady = |observation: &Observation, port: usize| -> f64 {
                (0..body.count).map(|k| observation.states[k] * body.input[port][k] / body.rate[k]).sum::<f64>()
                    + observation.direct[port]
            };
            let (ambient, base) = (steady(&body.ambient_flow, 0), steady(&body.base_flow, 0));
            assert!((ambient + base - 1.0).abs() < 1e-10, "{slab:?}: {ambient} + {base}");
            let surface = slab.impedance(Complex::from(0.0), 0.0).re;
            assert!(
                (steady(&body.contact_temperature, 0) / surface - 1.0).abs() < 1e-8,
                "{slab:?}: {} {surface}",
                steady(&body.contact_temperature, 0)
            );
            if slab.surface_transfer > 0.0 {
                assert!((ambient - slab.surface_transfer * surface).abs() < 1e-8, "{slab:?}: {ambient}");
            }
            // Uniform temperature everywhere: zero flow.
            let both = |observation: &Observation| {
                steady(observation, Port::Ambient as usize)
                    + if slab.base == FarBoundary::Held { steady(observation, Port::Base as usize) } else { 0.0 }
            };
            let level = both(&body.contact_temperature);
            assert!((level - 1.0).abs() < 1e-7, "{slab:?}: {level}");
            assert!(both(&body.ambient_flow).abs() < 1e-4, "{slab:?} {}", both(&body.ambient_flow));
            assert!(both(&body.base_flow).abs() < 1e-4, "{slab:?} {}", both(&body.base_flow));
        }
    }

    #[test]
    fn a_temperature_of_the_base_arrives_by_diffusion() {
        // Slab that is insulated at the contact: Carslaw and Jaeger, section 3.4.
        let slab = iron(FarBoundary::Held);
        for tolerance in [1e-1, 1e-2, 1e-3] {
            let body = slab.reduce(1000.0, tolerance);
            let time = slab.height.powi(2) / slab.diffusivity();
            let exact = |t: f64| {
                let term = |n: i32| {
                    let root = (f64::from(n) + 0.5) * std::f64::consts::PI;
                    2.0 * (-root * root * t).exp() / (root * if n % 2 == 0 { 1.0 } else { -1.0 })
                };
                1.0 - (0..400).map(term).sum::<f64>()
            };
            let base = Port::Base as usize;
            for (part, bound) in [(0.0, 4e-3), (1e-4, 4e-3), (0.001, 4e-3), (0.01, 1e-3), (0.1, 1e-4), (1.0, 1e-5)] {
                let states: f64 = (0..body.count)
                    .map(|k| {
                        let grown = -(-body.rate[k] * part * time).exp_m1() / body.rate[k];
                        body.contact_temperature.states[k] * body.input[base][k] * grown
                    })
                    .sum();
                let found = states + body.contact_temperature.direct[base];
                // By reciprocity a flux into the contact does not leave at once through the base.
                assert!(body.base_flow.direct[0].abs() < 4e-3, "{}", body.base_flow.direct[0]);
                let expected = if part < 1e-3 { 0.0 } else { exact(part) };
                println!("{part} of h^2/kd: {found:.6} {expected:.6}, {} states", body.count);
                assert!((found - expected).abs() < bound, "after {part} of h^2/kd: {found} for {expected}");
            }
        }
    }

    #[test]
    fn a_heat_path_at_the_base_cools_the_contact_by_diffusion() {
        // Slab at 1 K, insulated at the contact, with a conductance G to 0 K: Carslaw and Jaeger, section 3.11.
        let slab = iron(FarBoundary::Insulated);
        let time = slab.height.powi(2) / slab.diffusivity();
        for tolerance in [1e-1, 1e-2, 1e-3] {
            let body = slab.reduce(1000.0, tolerance);
            for biot in [0.1, 1.0, 10.0, 1e3, 1e9] {
                let roots: Vec<f64> = (0..2000)
                    .map(|n| {
                        let (mut low, mut high) = (0.0, 0.5 * std::f64::consts::PI);
                        for _ in 0..60 {
                            let middle = 0.5 * (low + high);
                            let root = f64::from(n) * std::f64::consts::PI + middle;
                            if root * middle.tan() < biot { low = middle } else { high = middle }
                        }
                        f64::from(n) * std::f64::consts::PI + low
                    })
                    .collect();
                let exact = |part: f64| -> [f64; 2] {
                    let terms = roots.iter().map(|root| {
                        let size = 2.0 * biot / (biot * (biot + 1.0) + root * root) * (-root * root * part).exp();
                        // cos(root) has the sign of n; at the base it cancels.
                        [size / root.cos(), size]
                    });
                    terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
                };
                // da/dt = -(R + g b b^T) a, with the flux of the path at the reduced temperature of the base.
                let (port, conductance) = (Port::Base as usize, biot * slab.conductivity / slab.height);
                let inputs = DVector::from_fn(body.count, |k, _| body.input[port][k]);
                let gain = conductance / (1.0 + conductance * body.base_temperature.direct[port]);
                let rates = DMatrix::from_fn(body.count, body.count, |i, j| {
                    gain * inputs[i] * inputs[j] + if i == j { body.rate[i] } else { 0.0 }
                });
                let eigen = rates.symmetric_eigen();
                let start = eigen.eigenvectors.tr_mul(&DVector::from_fn(body.count, |k, _| body.uniform[k]));
                for part in [0.0, 1e-3, 0.01, 0.1, 1.0] {
                    let decayed =
                        DVector::from_fn(body.count, |k, _| start[k] * (-eigen.eigenvalues[k] * part * time).exp());
                    let states = &eigen.eigenvectors * decayed;
                    let flux = -gain * states.dot(&inputs);
                    let [contact, base] = [&body.contact_temperature, &body.base_temperature].map(|seen| {
                        (0..body.count).map(|k| seen.states[k] * states[k]).sum::<f64>() + seen.direct[port] * flux
                    });
                    let expected = if part == 0.0 { [1.0, 1.0] } else { exact(part) };
                    println!("{tolerance} {biot} {part}: {contact:.6} {base:.6} for {expected:?}");
                    assert!((contact - expected[0]).abs() < 1e-3, "{biot} {part}: {contact} for {expected:?}");
                    // Before, the flux has not left the layer over which it is spread.
                    let resolved = part >= 0.01;
                    assert!(!resolved || (base - expected[1]).abs() < 4e-3, "{biot} {part}: {base} for {expected:?}");
                }
            }
        }
    }
}
