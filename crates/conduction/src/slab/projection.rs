//! Reduction of the slab by Galerkin projection: trial functions, their products, and the resulting modes. What the slab is made of
//! enters by its fields, its two inner products and its exact impedance alone.
//!
//! Theory: docs/theory.md, section 4.2.

use super::{BASE_SHIFTS, BaseField, CoolingPort, Slab};
use crate::reduced::{MAX_SLAB_STATES, MAX_STATES, Observation, PORTS, Port, ReducedBody};
use nalgebra::{Complex, DMatrix, DVector};
use numerics::factorization;
use numerics::grading::LEAST_PANEL;
use numerics::maximum::maximum;
use scene::FarBoundary;

/// Ratios of neighbouring shifts to be tried, and the largest factor by which the error falls from one to the next.
const RATIOS: [f64; 7] = [20.0, 8.0, 5.0, 3.6, 2.8, 2.3, 1.9];
const LARGEST_FALL: f64 = 4.0;

impl Slab {
    /// Reduces the slab to a few states that follow the exact impedance on the frequencies from `1/duration` (1/s) up, to
    /// `tolerance` relative to the temperature rise of the whole duration.
    pub fn reduce(&self, duration: f64, tolerance: f64) -> ReducedBody {
        // Above this frequency the impedance is below the tolerance.
        let rise = self.impedance(Complex::from(1.0 / duration), 0.0).re;
        let own = self.own_rate();
        // Above the last of these a heated layer is thinner than the grid resolves.
        let fastest =
            (1.0 / (tolerance * rise * self.effusivity())).powi(2).max(3.0 / duration).min(own / LEAST_PANEL.powi(2));
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

/// Gauss points through the height, graded towards both faces down to the shortest decay length.
pub(super) struct Grid {
    height: f64,
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
    fn new(slab: &Slab, fastest: f64) -> Grid {
        let edges = slab.panels(fastest);
        let mut grid = Grid { height: slab.height, position: Vec::new(), weight: Vec::new() };
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

    /// Mean over the height.
    pub(super) fn mean(&self, values: &[f64]) -> f64 {
        self.weight.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>() / self.height
    }

    /// Integral of left times right over the height; the grid has a whole number of groups of two.
    pub(super) fn integral(&self, left: &[f64], right: &[f64]) -> f64 {
        let mut sum = [0.0; 2];
        let groups = self.weight.as_chunks::<2>().0.iter().zip(left.as_chunks::<2>().0).zip(right.as_chunks::<2>().0);
        for ((weight, left), right) in groups {
            sum[0] += weight[0] * left[0] * right[0];
            sum[1] += weight[1] * left[1] * right[1];
        }
        sum[0] + sum[1]
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
    fn new(slab: &'a Slab, grid: &'a Grid) -> Self {
        Basis { slab, grid, functions: Vec::new() }
    }

    fn count(&self) -> usize {
        self.functions.len()
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
        let heat = |left: &TrialFunction, right: &TrialFunction| self.slab.heat(self.grid, &left.value, &right.value);
        let before = heat(&function, &function).sqrt();
        for _ in 0..2 {
            for known in &self.functions {
                let part = heat(known, &function);
                function.combine(-part, known);
            }
        }
        let norm = heat(&function, &function).sqrt();
        if norm > 1e-7 * before {
            function.scale(1.0 / norm);
            self.functions.push(function);
        }
    }

    /// Adds the stationary fields.
    fn stationary(&mut self) {
        for field in self.slab.stationary_fields() {
            self.add(self.function(field));
        }
    }

    /// Adds the response to a contact flux at the real frequency `shift`.
    fn add_contact_response(&mut self, shift: f64) {
        self.add(self.function(self.slab.contact_response(shift)));
    }

    /// Adds the response to the boundary value at the base at the real frequency `shift`.
    fn add_base_response(&mut self, shift: f64) {
        self.add(self.function(self.slab.base_response(shift)));
    }

    /// Load vectors of the four ports on a function: contact, cooling, ambient, flux into a base without prescribed temperature.
    fn loads(&self, function: &TrialFunction) -> [f64; PORTS] {
        let slab = self.slab;
        let mean = self.grid.mean(&function.value);
        let cooling = match slab.cooling {
            CoolingPort::Surface => function.contact,
            CoolingPort::Sides => mean,
        };
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * function.base,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        let ambient =
            slab.surface_transfer * function.contact + slab.volume_transfer * slab.height * mean + through_base;
        let base = if slab.base == FarBoundary::Held { 0.0 } else { function.base };
        [function.contact, cooling, ambient, base]
    }

    fn stiffness(&self, left: &TrialFunction, right: &TrialFunction) -> f64 {
        let slab = self.slab;
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * left.base * right.base,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        slab.conduction(self.grid, &left.slope, &right.slope)
            + slab.volume_transfer * self.grid.integral(&left.value, &right.value)
            + slab.surface_transfer * left.contact * right.contact
            + through_base
    }

    /// Solves the eigenvalue problem of the projection.
    fn eigen(&self) -> Eigen {
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
    fn impedance(&self, eigen: &Eigen) -> impl Fn(Complex<f64>) -> Complex<f64> {
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
    fn modes(&self, eigen: &Eigen) -> ReducedBody {
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
        let kept = (modes.len() - 1).max(1);
        let lossless = self.is_lossless();
        let lift = BaseField::new(slab, 0.0);
        let lifted: Vec<f64> = self.grid.position.iter().map(|&z| lift.at(z)).collect();
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
        body.stored.direct[base] = slab.heat_of(self.grid, &lifted);
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
            let mean = if lossless && k > 0 { 0.0 } else { self.grid.mean(&mode.value) };
            let heat = if lossless && k > 0 { 0.0 } else { slab.heat_of(self.grid, &mode.value) };
            let lag = slab.lag(rate);
            let projection = lag * slab.heat(self.grid, &mode.value, &lifted);
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
                body.stored.states[k] = heat * if lift.held { lag } else { 1.0 };
                if lift.held {
                    body.stored.direct[base] -= body.stored.states[k] * projection;
                }
                body.uniform[k] = match lift.held {
                    // In equilibrium with a base and air as warm.
                    true => (loads[Port::Ambient as usize] + loads[base]) / rate,
                    false => heat,
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
    /// Contact impedance of the reduced body at the complex frequency `s` (1/s), K m2/W.
    pub(crate) fn impedance(&self, s: Complex<f64>) -> Complex<f64> {
        let contact = Port::Contact as usize;
        let states: Complex<f64> = (0..self.count)
            .map(|k| self.contact_temperature.states[k] * self.input[contact][k] / (self.rate[k] + s))
            .sum();
        states + self.contact_temperature.direct[contact]
    }

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
