//! Conduction through the height of a body: the exact impedance, and its reduction to a few states.
//!
//! The mean temperature over the cross-section, `T(z, t)` relative to the reference, obeys
//!
//! ```text
//! C dT/dt = K T'' - B (T - T_ambient),                     0 < z < h, contact at z = 0
//! -K T'(0) = q_contact + q_cooling - H0 (T(0) - T_ambient)  (cooling here: strip)
//! -K T'(h) = Hb (T(h) - T_ambient), or T(h) = T_base
//! ```
//!
//! with capacity C (J/(m3 K)), conductivity K (W/(m K)), loss to air by volume B (W/(m3 K), the fin
//! equation of a block cooled on its sides) and heat transfer coefficients H0, Hb (W/(m2 K)).
//!
//! Reduction: Galerkin on exact solutions at real frequencies spread geometrically from the slab's own
//! `kd/h^2` to the highest frequency that matters (a rational Krylov space), the stationary solutions
//! and the uniform temperature. The projected problem is symmetric, so its states are real and decay;
//! it reproduces the exact impedance and its derivative at those frequencies, and because the uniform
//! temperature is in the space, heat is conserved exactly. The fastest state becomes the static remainder.
//!
//! Validity: uniform temperature over the cross-section (small transverse Biot number) for the
//! loss by volume; any slab otherwise.

use super::reduced::{MAX_SLAB_STATES, MAX_STATES, Observation, PORTS, Port, ReducedBody};
use nalgebra::{Complex, DMatrix, SymmetricEigen};

/// Condition at the face opposite to the contact.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Base {
    /// Temperature prescribed.
    Held,
    /// No heat passes.
    Insulated,
    /// Heat transfer coefficient to ambient, W/(m2 K).
    Convecting(f64),
}

/// Where the body is cooled beyond the constant heat transfer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum CoolingPort {
    /// On the contact face (a strip's free surface).
    Surface,
    /// Evenly along the height (a block's sides).
    Sides,
}

/// A body seen as a slab: see the module for the symbols.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Slab {
    /// h, m.
    pub height: f64,
    /// K, W/(m K), > 0.
    pub conductivity: f64,
    /// C, J/(m3 K).
    pub capacity: f64,
    /// H0, W/(m2 K).
    pub surface_transfer: f64,
    /// B, W/(m3 K).
    pub volume_transfer: f64,
    /// Condition at z = h.
    pub base: Base,
    /// Where variable cooling acts.
    pub cooling: CoolingPort,
}

/// Square root with positive real part. Without angles, so a few times faster than by polar form; exact
/// enough because the argument never lies near the negative axis in these problems.
fn principal_root(z: Complex<f64>) -> Complex<f64> {
    let modulus = (z.re * z.re + z.im * z.im).sqrt();
    if z.re >= 0.0 {
        let re = (0.5 * (modulus + z.re)).sqrt();
        let im = if re > 0.0 { 0.5 * z.im / re } else { 0.0 };
        return Complex::new(re, im);
    }
    let im = (0.5 * (modulus - z.re)).sqrt().copysign(z.im);
    Complex::new(0.5 * z.im / im, im)
}

impl Slab {
    /// Thermal diffusivity, m2/s.
    pub fn diffusivity(&self) -> f64 {
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
        let admittance = if u.norm() < 1e-4 {
            // Small argument: the slab is a capacity behind (or beside) its base.
            let own = k * kappa_squared * self.height;
            match self.base {
                Base::Held => (k / self.height).into(),
                Base::Insulated => own / (1.0 + kappa_squared * self.height.powi(2) / 3.0),
                Base::Convecting(transfer) => (own + transfer) / (1.0 + transfer * self.height / k),
            }
        } else {
            // Beyond 20 decay lengths the base is not felt to rounding.
            if u.re > 20.0 {
                return (kappa * k + self.surface_transfer).inv();
            }
            let decay = (-2.0 * u).exp();
            let (sum, difference) = (1.0 + decay, 1.0 - decay);
            match self.base {
                Base::Held => sum / difference * kappa * k,
                Base::Insulated => difference / sum * kappa * k,
                Base::Convecting(transfer) => {
                    let beta = transfer / (kappa * k);
                    (difference + beta * sum) / (sum + beta * difference) * kappa * k
                }
            }
        };
        (admittance + self.surface_transfer).inv()
    }

    /// Heat a mean temperature of 1 K is worth, J/(m2 K).
    fn areal_capacity(&self) -> f64 {
        self.capacity * self.height
    }

    /// Reduces the slab to a few states that follow the exact impedance on the frequencies from
    /// `1/duration` (1/s) up, to `tolerance` relative to the temperature rise of the whole duration.
    pub fn reduce(&self, duration: f64, tolerance: f64) -> ReducedBody {
        // Above this frequency the impedance has fallen to the tolerance.
        let rise = self.impedance(Complex::from(1.0 / duration), 0.0).re;
        let effusivity = (self.conductivity * self.capacity).sqrt();
        let fastest = (1.0 / (tolerance * rise * effusivity)).powi(2).max(3.0 / duration);
        let mut best: Option<ReducedBody> = None;
        for ratio in [20.0, 8.0, 5.0, 3.6, 2.8, 2.3, 1.9] {
            let Some(body) = self.project(0.05 / duration, fastest, ratio) else { continue };
            let error = self.largest_error(&body, 1.0 / duration, fastest);
            let better = best.as_ref().is_none_or(|known| error < known.error);
            if better {
                best = Some(ReducedBody { error, ..body });
            }
            if error <= 0.1 * tolerance {
                break;
            }
        }
        best.expect("the coarsest space has few functions, so it always fits")
    }

    /// Largest error of the reduced frequency response relative to the exact one at `slowest`: on the
    /// imaginary axis, where it bounds the error of the response to any bounded flux.
    fn largest_error(&self, body: &ReducedBody, slowest: f64, fastest: f64) -> f64 {
        let scale = self.impedance(Complex::new(0.0, slowest), 0.0).norm();
        let points = 40;
        (0..=points)
            // A constant flux has content below its own frequency, so the scan begins there.
            .map(|i| 0.03 * slowest * (fastest / slowest / 0.03).powf(f64::from(i) / f64::from(points)))
            .map(|frequency| Complex::new(0.0, frequency))
            .map(|s| (body.impedance(s) - self.impedance(s, 0.0)).norm() / scale)
            .fold(0.0, f64::max)
    }

    /// Galerkin projection with shifts from `slowest` (or the slab's own rate) to `fastest` in steps that
    /// begin with `ratio`; `None` if too many.
    fn project(&self, slowest: f64, fastest: f64, ratio: f64) -> Option<ReducedBody> {
        let own = self.diffusivity() / self.height.powi(2);
        let mut shifts = Vec::new();
        let (mut shift, mut step) = (slowest.max(0.5 * own), ratio);
        while shift < fastest {
            shifts.push(shift);
            shift *= step;
            // The impedance falls with frequency, and with it what an error there costs.
            step *= 1.08;
        }
        shifts.push(fastest);
        let grid = Grid::new(self, fastest.max(own));
        let mut basis = Basis::new(self, &grid);
        basis.stationary();
        for &shift in &shifts {
            basis.add_contact_response(shift);
        }
        basis.add_base_response(own);
        basis.add_base_response(30.0 * own);
        if basis.count() > MAX_SLAB_STATES + 1 {
            return None;
        }
        Some(basis.modes())
    }
}

impl ReducedBody {
    /// Contact impedance of the reduced body at the complex frequency `s` (1/s), K m2/W.
    pub fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        let contact = Port::Contact as usize;
        let states: Complex<f64> = (0..self.count)
            .map(|k| self.contact_temperature.states[k] * self.input[contact][k] / (self.rate[k] + s))
            .sum();
        states + self.contact_temperature.direct[contact]
    }
}

/// Gauss points through the height, graded towards both faces down to the shortest decay length.
struct Grid {
    position: Vec<f64>,
    weight: Vec<f64>,
}

/// Ten-point Gauss-Legendre rule on [0, 1] (half of it; the rule is symmetric).
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

impl Grid {
    fn new(slab: &Slab, fastest: f64) -> Grid {
        let shortest = (slab.diffusivity() / fastest).sqrt().min(slab.height);
        let mut edges = vec![0.0];
        let mut edge = shortest;
        while edge < 0.5 * slab.height {
            edges.push(edge);
            edge *= 3.0;
        }
        // The base sees only slower shifts: 30 times the slab's own rate at most.
        edges.extend([0.5, 0.7, 0.85, 0.95, 1.0].map(|part| part * slab.height));
        let mut grid = Grid { position: Vec::new(), weight: Vec::new() };
        for pair in edges.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (node, weight) in GAUSS {
                for sign in [-1.0, 1.0] {
                    grid.position.push(middle + sign * half * node);
                    grid.weight.push(half * weight);
                }
            }
        }
        grid
    }
}

/// A trial function: values and slopes at the grid points, and values at the two faces.
struct Function {
    value: Vec<f64>,
    slope: Vec<f64>,
    contact: f64,
    base: f64,
}

impl Function {
    fn combine(&mut self, factor: f64, other: &Function) {
        for (mine, its) in self.value.iter_mut().zip(&other.value) {
            *mine += factor * its;
        }
        for (mine, its) in self.slope.iter_mut().zip(&other.slope) {
            *mine += factor * its;
        }
        self.contact += factor * other.contact;
        self.base += factor * other.base;
    }

    fn scale(&mut self, factor: f64) {
        self.value.iter_mut().chain(&mut self.slope).for_each(|value| *value *= factor);
        self.contact *= factor;
        self.base *= factor;
    }
}

/// Trial functions, orthonormal in the capacity-weighted product.
struct Basis<'a> {
    slab: &'a Slab,
    grid: &'a Grid,
    functions: Vec<Function>,
}

impl<'a> Basis<'a> {
    fn new(slab: &'a Slab, grid: &'a Grid) -> Self {
        Basis { slab, grid, functions: Vec::new() }
    }

    fn count(&self) -> usize {
        self.functions.len()
    }

    /// Integral of left times right over the height; the grid has a whole number of groups of two.
    fn product(&self, left: &[f64], right: &[f64]) -> f64 {
        let mut sum = [0.0; 2];
        let groups =
            self.grid.weight.as_chunks::<2>().0.iter().zip(left.as_chunks::<2>().0).zip(right.as_chunks::<2>().0);
        for ((weight, left), right) in groups {
            sum[0] += weight[0] * left[0] * right[0];
            sum[1] += weight[1] * left[1] * right[1];
        }
        sum[0] + sum[1]
    }

    fn function(&self, evaluate: impl Fn(f64) -> (f64, f64)) -> Function {
        let values: Vec<(f64, f64)> = self.grid.position.iter().map(|&z| evaluate(z)).collect();
        Function {
            value: values.iter().map(|pair| pair.0).collect(),
            slope: values.iter().map(|pair| pair.1).collect(),
            contact: evaluate(0.0).0,
            base: evaluate(self.slab.height).0,
        }
    }

    /// Adds a function after orthogonalising it (twice is enough); drops it if the space has it already.
    fn add(&mut self, mut function: Function) {
        let capacity = self.slab.capacity;
        let before = (capacity * self.product(&function.value, &function.value)).sqrt();
        for _ in 0..2 {
            for known in 0..self.functions.len() {
                let part = capacity * self.product(&self.functions[known].value, &function.value);
                function.combine(-part, &self.functions[known]);
            }
        }
        let norm = (capacity * self.product(&function.value, &function.value)).sqrt();
        if norm > 1e-7 * before {
            function.scale(1.0 / norm);
            self.functions.push(function);
        }
    }

    /// Uniform temperature, and the shapes that constant fluxes settle to.
    fn stationary(&mut self) {
        let slab = *self.slab;
        let h = slab.height;
        let held = slab.base == Base::Held;
        if !held {
            self.add(self.function(|_| (1.0, 0.0)));
        }
        let fin = (slab.volume_transfer / slab.conductivity).sqrt();
        if fin * h > 1e-3 {
            self.add_contact_response(0.0);
            if !held {
                self.add_base_response(0.0);
            }
        } else {
            self.add(self.function(|z| (1.0 - z / h, -1.0 / h)));
        }
        if !held {
            self.add(self.function(|z| ((1.0 - z / h).powi(2), -2.0 * (1.0 - z / h) / h)));
        }
        if slab.cooling == CoolingPort::Sides && held {
            self.add(self.function(|z| (1.0 - (z / h).powi(2), -2.0 * z / (h * h))));
        }
    }

    /// Exact response to a contact flux at the real frequency `shift`.
    fn add_contact_response(&mut self, shift: f64) {
        let slab = *self.slab;
        let kappa = (shift / slab.diffusivity() + slab.volume_transfer / slab.conductivity).sqrt();
        let h = slab.height;
        // Sum of a wave leaving the contact and its reflection; scaled so that nothing overflows.
        let reflection = match slab.base {
            Base::Held => -1.0,
            Base::Insulated => 1.0,
            Base::Convecting(transfer) => {
                let beta = transfer / (slab.conductivity * kappa);
                (1.0 - beta) / (1.0 + beta)
            }
        };
        self.add(self.function(|z| {
            let (down, up) = ((-kappa * z).exp(), reflection * (-kappa * (2.0 * h - z)).exp());
            (down + up, kappa * (up - down))
        }));
    }

    /// Exact response to what happens at the base at the real frequency `shift`.
    fn add_base_response(&mut self, shift: f64) {
        let slab = *self.slab;
        let kappa = (shift / slab.diffusivity() + slab.volume_transfer / slab.conductivity).sqrt();
        let h = slab.height;
        if slab.base == Base::Held {
            // A function of the space vanishes at the base: the response minus its value there.
            let at_base = 1.0 + (-2.0 * kappa * h).exp();
            self.add(self.function(|z| {
                let (up, down) = ((-kappa * (h - z)).exp(), (-kappa * (h + z)).exp());
                ((up + down) / at_base - 1.0 + (1.0 - z / h), kappa * (up - down) / at_base - 1.0 / h)
            }));
        } else {
            self.add(self.function(|z| {
                let (up, down) = ((-kappa * (h - z)).exp(), (-kappa * (h + z)).exp());
                (up + down, kappa * (up - down))
            }));
        }
    }

    /// Loads of the four ports on a function: contact, cooling, ambient, base.
    fn loads(&self, function: &Function) -> [f64; PORTS] {
        let slab = self.slab;
        let integral: f64 = self.grid.weight.iter().zip(function.value.iter()).map(|(w, v)| w * v).sum();
        let cooling = match slab.cooling {
            CoolingPort::Surface => function.contact,
            CoolingPort::Sides => integral / slab.height,
        };
        let through_base = match slab.base {
            Base::Convecting(transfer) => transfer * function.base,
            Base::Held | Base::Insulated => 0.0,
        };
        let ambient = slab.surface_transfer * function.contact + slab.volume_transfer * integral + through_base;
        [function.contact, cooling, ambient, 0.0]
    }

    fn stiffness(&self, left: &Function, right: &Function) -> f64 {
        let slab = self.slab;
        let through_base = match slab.base {
            Base::Convecting(transfer) => transfer * left.base * right.base,
            Base::Held | Base::Insulated => 0.0,
        };
        slab.conductivity * self.product(&left.slope, &right.slope)
            + slab.volume_transfer * self.product(&left.value, &right.value)
            + slab.surface_transfer * left.contact * right.contact
            + through_base
    }

    /// Diagonalises the projected problem and closes its fastest state statically.
    fn modes(&self) -> ReducedBody {
        let count = self.count();
        let slab = self.slab;
        let mut stiffness = DMatrix::zeros(count, count);
        for i in 0..count {
            for j in 0..=i {
                stiffness[(i, j)] = self.stiffness(&self.functions[i], &self.functions[j]);
                stiffness[(j, i)] = stiffness[(i, j)];
            }
        }
        let eigen = SymmetricEigen::new(stiffness);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let modes: Vec<Function> = order
            .iter()
            .map(|&index| {
                let mut mode = self.function(|_| (0.0, 0.0));
                for (function, &weight) in self.functions.iter().zip(eigen.eigenvectors.column(index).iter()) {
                    mode.combine(weight, function);
                }
                mode
            })
            .collect();
        let lossless = slab.base == Base::Insulated && slab.surface_transfer == 0.0 && slab.volume_transfer == 0.0;
        let rates: Vec<f64> = modes
            .iter()
            .enumerate()
            // The Rayleigh quotient keeps the slow rates accurate beside the fast ones.
            .map(|(k, mode)| if k == 0 && lossless { 0.0 } else { self.stiffness(mode, mode) })
            .collect();
        self.assemble(&modes, &rates)
    }

    fn assemble(&self, modes: &[Function], rates: &[f64]) -> ReducedBody {
        let slab = self.slab;
        let areal = slab.areal_capacity();
        let kept = (modes.len() - 1).max(1);
        let integral = |mode: &Function| -> f64 {
            self.grid.weight.iter().zip(mode.value.iter()).map(|(w, v)| w * v).sum::<f64>()
        };
        let lift = BaseLift::new(slab);
        let mut body = ReducedBody {
            count: kept,
            rate: [0.0; MAX_STATES],
            input: [[0.0; MAX_STATES]; PORTS],
            contact_temperature: Observation::NONE,
            cooled_temperature: Observation::NONE,
            mean_temperature: Observation::NONE,
            stored: Observation::NONE,
            ambient_flow: Observation::NONE,
            base_flow: Observation::NONE,
            error: 0.0,
        };
        let base = Port::Base as usize;
        let ambient = Port::Ambient as usize;
        // What the stationary base temperature gives directly, before the states take their part.
        body.contact_temperature.direct[base] = lift.at(0.0);
        body.mean_temperature.direct[base] = lift.mean();
        body.cooled_temperature.direct[base] = match slab.cooling {
            CoolingPort::Surface => lift.at(0.0),
            CoolingPort::Sides => lift.mean(),
        };
        body.ambient_flow.direct[base] =
            slab.surface_transfer * lift.at(0.0) + slab.volume_transfer * slab.height * lift.mean();
        body.ambient_flow.direct[ambient] = -(slab.surface_transfer + slab.volume_transfer * slab.height);
        for (k, (mode, &rate)) in modes.iter().zip(rates).enumerate() {
            let mut loads = self.loads(mode);
            let mean = integral(mode) / slab.height;
            let projection: f64 = slab.capacity
                * self
                    .grid
                    .position
                    .iter()
                    .zip(&self.grid.weight)
                    .zip(mode.value.iter())
                    .map(|((&z, w), v)| w * v * lift.at(z))
                    .sum::<f64>();
            loads[base] = rate * projection;
            let flow = slab.surface_transfer * mode.contact + slab.volume_transfer * slab.height * mean;
            let observed = [
                (&mut body.contact_temperature, mode.contact),
                (&mut body.cooled_temperature, loads[Port::Cooling as usize]),
                (&mut body.mean_temperature, mean),
                (&mut body.ambient_flow, flow),
            ];
            for (observation, weight) in observed {
                if k < kept {
                    observation.states[k] = weight;
                    // The states carry the base's stationary field from here on.
                    observation.direct[base] -= weight * projection;
                } else {
                    for port in [Port::Contact, Port::Cooling, Port::Ambient] {
                        observation.direct[port as usize] += weight * loads[port as usize] / rate;
                    }
                }
            }
            if k < kept {
                body.rate[k] = rate;
                body.stored.states[k] = areal * mean;
                for port in 0..PORTS {
                    body.input[port][k] = loads[port];
                }
            }
        }
        body.close_balance();
        // Heat of the stationary field that the states do not hold: it enters and leaves with the base temperature
        // itself, through the base, so it is no part of the flow that the balance closes.
        body.stored.direct[base] = areal * body.mean_temperature.direct[base];
        body
    }
}

impl ReducedBody {
    /// The flow out of the base is what the balance leaves: input - stored' - flow to ambient. For a
    /// convecting base this equals `Hb (T(h) - T_ambient)` of the reduced field.
    pub fn close_balance(&mut self) {
        for k in 0..self.count {
            self.base_flow.states[k] = self.stored.states[k] * self.rate[k] - self.ambient_flow.states[k];
        }
        for port in 0..PORTS {
            let entering = if port <= Port::Cooling as usize { 1.0 } else { 0.0 };
            let storing: f64 = (0..self.count).map(|k| self.stored.states[k] * self.input[port][k]).sum();
            self.base_flow.direct[port] = entering - storing - self.ambient_flow.direct[port];
        }
    }
}

/// Stationary temperature field per unit temperature prescribed at the base; zero for other bases.
struct BaseLift {
    kappa: f64,
    height: f64,
    beta: f64,
    held: bool,
}

impl BaseLift {
    fn new(slab: &Slab) -> BaseLift {
        BaseLift {
            kappa: (slab.volume_transfer / slab.conductivity).sqrt(),
            height: slab.height,
            beta: slab.surface_transfer / slab.conductivity,
            held: slab.base == Base::Held,
        }
    }

    fn at(&self, z: f64) -> f64 {
        if !self.held {
            return 0.0;
        }
        let profile = |z: f64| {
            if self.kappa * self.height < 1e-6 {
                1.0 + self.beta * z
            } else {
                let u = self.kappa * z;
                u.cosh() + self.beta / self.kappa * u.sinh()
            }
        };
        profile(z) / profile(self.height)
    }

    fn mean(&self) -> f64 {
        // Gauss-Legendre over a smooth profile.
        GAUSS
            .iter()
            .flat_map(|&(node, weight)| [(0.5 + 0.5 * node, 0.5 * weight), (0.5 - 0.5 * node, 0.5 * weight)])
            .map(|(x, weight)| weight * self.at(x * self.height))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn iron(base: Base) -> Slab {
        Slab {
            height: 0.011,
            conductivity: 54.0,
            capacity: 7200.0 * 460.0,
            surface_transfer: 0.0,
            volume_transfer: 0.0,
            base,
            cooling: CoolingPort::Surface,
        }
    }

    fn cases() -> Vec<Slab> {
        let mut cases = Vec::new();
        for base in [Base::Held, Base::Insulated, Base::Convecting(200.0), Base::Convecting(1e6)] {
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
                // Nothing leaves: the balance must say so for every state and for the flux.
                assert!(body.base_flow.states[..body.count].iter().all(|flow| flow.abs() < 1e-9 * 7200.0 * 460.0));
                assert!(body.base_flow.direct[0].abs() < 1e-10, "{:?}", body.base_flow.direct);
                continue;
            }
            // Unit contact flux for ever: all of it leaves, in the exact proportion.
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
            // Everything at the same temperature: no flow at all.
            let both = |observation: &Observation| {
                steady(observation, Port::Ambient as usize)
                    + if slab.base == Base::Held { steady(observation, Port::Base as usize) } else { 0.0 }
            };
            let level = both(&body.contact_temperature);
            assert!((level - 1.0).abs() < 1e-7, "{slab:?}: {level}");
            assert!(both(&body.ambient_flow).abs() < 1e-4, "{slab:?} {}", both(&body.ambient_flow));
            assert!(both(&body.base_flow).abs() < 1e-4, "{slab:?} {}", both(&body.base_flow));
        }
    }

    #[test]
    fn short_times_are_those_of_the_half_space() {
        // T = 2 q sqrt(t / (pi k rho c)): 84.375 K after 1 s of 1 MW/m2 on a body thick enough.
        let slab = Slab { height: 0.1, ..iron(Base::Insulated) };
        let body = slab.reduce(1.0, 1e-4);
        let rise = |t: f64| -> f64 {
            let states: f64 = (0..body.count)
                .map(|k| {
                    let grown = if body.rate[k] == 0.0 { t } else { -(-body.rate[k] * t).exp_m1() / body.rate[k] };
                    body.contact_temperature.states[k] * body.input[0][k] * grown
                })
                .sum();
            1e6 * (states + body.contact_temperature.direct[0])
        };
        assert!(body.error <= 1e-4, "{}", body.error);
        assert!((rise(1.0) - 84.375).abs() < 84.375e-4, "{}", rise(1.0));
        assert!((rise(0.01) / 8.4375 - 1.0).abs() < 2e-3, "{}", rise(0.01));
    }
}
