//! Galerkin projection of the slab: trial functions, their products, and the resulting modes.
//!
//! Theory: docs/theory.md, section 4.2.

use super::{CoolingPort, Slab};
use crate::reduced::{MAX_STATES, Observation, PORTS, Port, ReducedBody};
use nalgebra::{Complex, DMatrix, DVector};
use numerics::factorization;
use numerics::grading::towards_face;
use scene::FarBoundary;

/// Gauss points through the height, graded towards both faces down to the shortest decay length.
pub(super) struct Grid {
    position: Vec<f64>,
    weight: Vec<f64>,
}

/// Ten-point Gauss-Legendre rule on [0, 1] (half of it; the rule is symmetric).
const GAUSS_10: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

impl Grid {
    pub(super) fn new(slab: &Slab, fastest: f64) -> Grid {
        let mut edges = towards_face((slab.diffusivity() / fastest).sqrt(), slab.height, 3.0);
        // Fields that begin at the base decay over a fortieth of the height at least.
        edges.extend([0.5, 0.7, 0.85, 0.95, 1.0].map(|part| part * slab.height));
        let mut grid = Grid { position: Vec::new(), weight: Vec::new() };
        for pair in edges.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (node, weight) in GAUSS_10 {
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
struct TrialFunction {
    value: Vec<f64>,
    slope: Vec<f64>,
    contact: f64,
    base: f64,
}

impl TrialFunction {
    fn combine(&mut self, factor: f64, other: &TrialFunction) {
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

/// Eigenvalues and eigenvectors of the projected problem.
pub(super) struct Eigen {
    rates: DVector<f64>,
    vectors: DMatrix<f64>,
    /// Order of the columns, the slowest first.
    order: Vec<usize>,
}

/// Trial functions, orthonormal in the capacity-weighted product.
pub(super) struct Basis<'a> {
    slab: &'a Slab,
    grid: &'a Grid,
    functions: Vec<TrialFunction>,
}

impl<'a> Basis<'a> {
    pub(super) fn new(slab: &'a Slab, grid: &'a Grid) -> Self {
        Basis { slab, grid, functions: Vec::new() }
    }

    pub(super) fn count(&self) -> usize {
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

    fn function(&self, evaluate: impl Fn(f64) -> (f64, f64)) -> TrialFunction {
        let values: Vec<(f64, f64)> = self.grid.position.iter().map(|&z| evaluate(z)).collect();
        TrialFunction {
            value: values.iter().map(|pair| pair.0).collect(),
            slope: values.iter().map(|pair| pair.1).collect(),
            contact: evaluate(0.0).0,
            base: evaluate(self.slab.height).0,
        }
    }

    /// Adds a function after orthogonalising it (twice is enough); drops it if it is linearly dependent.
    fn add(&mut self, mut function: TrialFunction) {
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

    /// Adds the uniform temperature and the quasi-steady profiles of constant fluxes.
    pub(super) fn stationary(&mut self) {
        let slab = *self.slab;
        let h = slab.height;
        let held = slab.base == FarBoundary::Held;
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
    pub(super) fn add_contact_response(&mut self, shift: f64) {
        let slab = *self.slab;
        let (kappa, h) = (slab.decay(shift), slab.height);
        // Sum of a wave leaving the contact and its reflection; scaled against overflow.
        let reflection = match slab.base {
            FarBoundary::Held => -1.0,
            FarBoundary::Insulated => 1.0,
            FarBoundary::Convecting(transfer) => {
                let beta = transfer / (slab.conductivity * kappa);
                (1.0 - beta) / (1.0 + beta)
            }
        };
        self.add(self.function(|z| {
            let down = (-kappa * z).exp();
            // The reflection is below rounding over a longer path: exp(-40) = 4e-18.
            let up = if kappa * (h - z) > 20.0 { 0.0 } else { reflection * (-kappa * (2.0 * h - z)).exp() };
            (down + up, kappa * (up - down))
        }));
    }

    /// Exact response to the boundary value at the base at the real frequency `shift`; under a prescribed temperature, what it lacks
    /// of the stationary response, since a function of the space vanishes there.
    pub(super) fn add_base_response(&mut self, shift: f64) {
        let slab = *self.slab;
        let (kappa, h) = (slab.decay(shift), slab.height);
        if slab.base == FarBoundary::Held {
            let [steady, response] = [0.0, shift].map(|shift| BaseLift::new(&slab, shift));
            self.add(self.function(|z| (steady.at(z) - response.at(z), steady.slope(z) - response.slope(z))));
        } else {
            self.add(self.function(|z| {
                let (up, down) = ((-kappa * (h - z)).exp(), (-kappa * (h + z)).exp());
                (up + down, kappa * (up - down))
            }));
        }
    }

    /// Load vectors of the four ports on a function: contact, cooling, ambient, flux into a base without prescribed temperature.
    fn loads(&self, function: &TrialFunction) -> [f64; PORTS] {
        let slab = self.slab;
        let integral: f64 = self.grid.weight.iter().zip(function.value.iter()).map(|(w, v)| w * v).sum();
        let cooling = match slab.cooling {
            CoolingPort::Surface => function.contact,
            CoolingPort::Sides => integral / slab.height,
        };
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * function.base,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        let ambient = slab.surface_transfer * function.contact + slab.volume_transfer * integral + through_base;
        let base = if slab.base == FarBoundary::Held { 0.0 } else { function.base };
        [function.contact, cooling, ambient, base]
    }

    fn stiffness(&self, left: &TrialFunction, right: &TrialFunction) -> f64 {
        let slab = self.slab;
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * left.base * right.base,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        slab.conductivity * self.product(&left.slope, &right.slope)
            + slab.volume_transfer * self.product(&left.value, &right.value)
            + slab.surface_transfer * left.contact * right.contact
            + through_base
    }

    /// Solves the eigenvalue problem of the projection.
    pub(super) fn eigen(&self) -> Eigen {
        let count = self.count();
        let mut stiffness = DMatrix::zeros(count, count);
        for i in 0..count {
            for j in 0..=i {
                stiffness[(i, j)] = self.stiffness(&self.functions[i], &self.functions[j]);
                stiffness[(j, i)] = stiffness[(i, j)];
            }
        }
        let eigen = factorization::symmetric_eigen_or_nan(stiffness);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        Eigen { rates: eigen.eigenvalues, vectors: eigen.eigenvectors, order }
    }

    /// Contact impedance by complex frequency (1/s), K m2/W, of the body that [`Basis::modes`] makes, to the accuracy of the
    /// eigenvalues.
    pub(super) fn impedance(&self, eigen: &Eigen) -> impl Fn(Complex<f64>) -> Complex<f64> {
        let residues = eigen.order.iter().enumerate().map(|(k, &index)| {
            let contact: f64 =
                self.functions.iter().zip(&eigen.vectors.column(index)).map(|(f, part)| f.contact * part).sum();
            let rate = if k == 0 && self.is_lossless() { 0.0 } else { eigen.rates[index] };
            (rate, contact * contact)
        });
        let mut states: Vec<(f64, f64)> = residues.collect();
        let fastest = if states.len() > 1 { states.pop() } else { None };
        let direct = fastest.map_or(0.0, |(rate, residue)| residue / rate);
        move |s| states.iter().map(|&(rate, residue)| (s + rate).inv() * residue).sum::<Complex<f64>>() + direct
    }

    fn is_lossless(&self) -> bool {
        let slab = self.slab;
        slab.base == FarBoundary::Insulated && slab.surface_transfer == 0.0 && slab.volume_transfer == 0.0
    }

    /// Body with these modes, the fastest one as a static correction.
    pub(super) fn modes(&self, eigen: &Eigen) -> ReducedBody {
        let modes: Vec<TrialFunction> = (eigen.order)
            .iter()
            .map(|&index| {
                let mut mode = self.function(|_| (0.0, 0.0));
                for (function, &weight) in self.functions.iter().zip(eigen.vectors.column(index).iter()) {
                    mode.combine(weight, function);
                }
                mode
            })
            .collect();
        let lossless = self.is_lossless();
        let rates: Vec<f64> = modes
            .iter()
            .enumerate()
            // The Rayleigh quotient keeps the slow rates accurate beside the fast ones.
            .map(|(k, mode)| if k == 0 && lossless { 0.0 } else { self.stiffness(mode, mode) })
            .collect();
        self.assemble(&modes, &rates)
    }

    fn assemble(&self, modes: &[TrialFunction], rates: &[f64]) -> ReducedBody {
        let slab = self.slab;
        let areal = slab.areal_capacity();
        let kept = (modes.len() - 1).max(1);
        let lossless = self.is_lossless();
        let integral = |mode: &TrialFunction| -> f64 {
            self.grid.weight.iter().zip(mode.value.iter()).map(|(w, v)| w * v).sum::<f64>()
        };
        let lift = BaseLift::new(slab, 0.0);
        let mut body = ReducedBody {
            count: kept,
            rate: [0.0; MAX_STATES],
            input: [[0.0; MAX_STATES]; PORTS],
            contact_temperature: Observation::NONE,
            cooled_temperature: Observation::NONE,
            base_temperature: Observation::NONE,
            mean_temperature: Observation::NONE,
            stored: Observation::NONE,
            uniform: [0.0; MAX_STATES],
            ambient_flow: Observation::NONE,
            base_flow: Observation::NONE,
            error: 0.0,
        };
        let base = Port::Base as usize;
        let ambient = Port::Ambient as usize;
        // Direct feedthrough of the stationary base temperature, before the projection on the states is subtracted.
        body.contact_temperature.direct[base] = lift.at(0.0);
        // Heat of the stationary field, less that of the states: it enters and leaves with the base temperature itself, through the base, so
        // it is not part of the flow determined by the balance.
        body.stored.direct[base] = if lift.held { areal * lift.mean() } else { 0.0 };
        body.base_temperature.direct[base] = lift.at(slab.height);
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
            // Orthogonal to the uniform temperature where that is a mode.
            let mean = if lossless && k > 0 { 0.0 } else { integral(mode) / slab.height };
            let lag = slab.lag(rate);
            let lifted = self.grid.position.iter().zip(&self.grid.weight).zip(mode.value.iter());
            let projection = lag * slab.capacity * lifted.map(|((&z, w), v)| w * v * lift.at(z)).sum::<f64>();
            if lift.held {
                loads[base] = rate * projection;
            } else if lag < 1.0 {
                // What the lag leaves out of the base's own stationary temperature.
                body.base_temperature.direct[base] += loads[base] * loads[base] * (1.0 - lag * lag) / rate;
                body.base_temperature.direct[ambient] += loads[base] * loads[ambient] * (1.0 - lag) / rate;
                loads[base] *= lag;
            }
            let flow = slab.surface_transfer * mode.contact + slab.volume_transfer * slab.height * mean;
            let observed = [
                (&mut body.contact_temperature, mode.contact),
                (&mut body.cooled_temperature, loads[Port::Cooling as usize]),
                (&mut body.base_temperature, mode.base * lag),
                (&mut body.mean_temperature, mean),
                (&mut body.ambient_flow, flow),
            ];
            for (observation, weight) in observed {
                if k < kept {
                    observation.states[k] = weight;
                    // The projection of the base's stationary field on the states is subtracted.
                    observation.direct[base] -= weight * projection;
                } else {
                    // A base of prescribed temperature acts through its stationary field only.
                    for (port, load) in loads.iter().enumerate().take(if lift.held { base } else { PORTS }) {
                        observation.direct[port] += weight * load / rate;
                    }
                }
            }
            if k < kept {
                body.rate[k] = rate;
                body.stored.states[k] = areal * mean * if lift.held { lag } else { 1.0 };
                if lift.held {
                    body.stored.direct[base] -= body.stored.states[k] * projection;
                }
                body.uniform[k] = match lift.held {
                    // In equilibrium with a base and air as warm.
                    true => (loads[Port::Ambient as usize] + loads[base]) / rate,
                    false => areal * mean,
                };
                for port in 0..PORTS {
                    body.input[port][k] = loads[port];
                }
            }
        }
        body.close_balance(slab.base == FarBoundary::Insulated);
        body
    }
}

impl ReducedBody {
    /// Closes the heat balance: the flow out of the base is input - d(stored)/dt - flow to ambient. For a convecting base
    /// this equals `Hb (T(h) - T_ambient)` of the reduced field, less the flux that is prescribed there; through an `insulated` one
    /// nothing but that flux passes.
    fn close_balance(&mut self, insulated: bool) {
        for k in 0..self.count {
            self.base_flow.states[k] = self.stored.states[k] * self.rate[k] - self.ambient_flow.states[k];
        }
        for port in 0..PORTS {
            let entering = if port <= Port::Cooling as usize { 1.0 } else { 0.0 };
            let storing: f64 = (0..self.count).map(|k| self.stored.states[k] * self.input[port][k]).sum();
            if insulated && port == Port::Base as usize {
                self.ambient_flow.direct[port] = 1.0 - storing;
            }
            self.base_flow.direct[port] = entering - storing - self.ambient_flow.direct[port];
        }
    }
}

/// Height over the decay length of lateral cooling below which the stationary field is a straight line to rounding.
const THIN: f64 = 1e-6;

/// Temperature field per unit temperature prescribed at the base, at a real frequency; zero for other bases.
struct BaseLift {
    kappa: f64,
    height: f64,
    beta: f64,
    held: bool,
}

impl BaseLift {
    pub(super) fn new(slab: &Slab, shift: f64) -> BaseLift {
        BaseLift {
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

    /// Slope of [`BaseLift::at`], 1/m.
    fn slope(&self, z: f64) -> f64 {
        let (u, whole) = (self.kappa * z, self.kappa * self.height);
        if whole < THIN {
            return self.beta / (1.0 + self.beta * self.height);
        }
        let ratio = self.beta / self.kappa;
        let at_base = (1.0 + ratio) + (1.0 - ratio) * (-2.0 * whole).exp();
        self.kappa * ((1.0 + ratio) * (u - whole).exp() - (1.0 - ratio) * (-u - whole).exp()) / at_base
    }

    /// Mean of [`BaseLift::at`] over the height.
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
