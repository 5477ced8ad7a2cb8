//! Reduction of the slab by Galerkin projection: trial functions, their products, and the resulting modes. What the slab is made of
//! enters by its fields, its two inner products and its exact impedance alone.
//!
//! Theory: docs/theory.md, section 4.2.

use super::{BASE_SHIFTS, BaseField, CoolingPort, Slab};
use crate::reduced::{MAX_SLAB_STATES, PORTS, Port, ReducedBody};
use crate::shares;
use crate::trial_functions::{Function, Points};
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
        let points = Points::new(&self.panels(fastest.max(own)), &[]);
        let mut best: Option<(f64, Basis<'_>, Eigen)> = None;
        // Indices of the next ratio, of the first one not yet reached, and of the first one with too many functions.
        let (mut next, mut open, mut end) = (0, 0, RATIOS.len());
        while next < end {
            let Some(basis) = self.space(&points, 0.05 / duration, fastest, RATIOS[next]) else {
                (end, next) = (next, open);
                continue;
            };
            open = next + 1;
            let eigen = basis.eigen();
            let error = scan.largest_error(basis.impedance(&eigen));
            if best.as_ref().is_none_or(|(known, ..)| error < *known) {
                best = Some((error, basis, eigen));
            }
            if error <= shares::SLAB * tolerance {
                break;
            }
            // Spaces that cannot meet the tolerance are skipped; the last is always tried.
            let falls = (error / (shares::SLAB * tolerance)).log(LARGEST_FALL) as usize;
            next = (next + falls.max(1)).min(end - 1).max(open);
        }
        let (_, basis, eigen) = best.expect("the coarsest space has few functions, so it always fits");
        // Modes are computed for the accepted space only.
        let body = basis.modes(&eigen);
        ReducedBody { error: scan.largest_error(|s| body.impedance(s)), ..body }
    }

    /// Trial functions with shifts from `slowest` (or the slab's own rate) to `fastest` with an initial ratio of `ratio`;
    /// `None` if there are too many.
    fn space<'a>(&'a self, points: &'a Points, slowest: f64, fastest: f64, ratio: f64) -> Option<Basis<'a>> {
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
        let mut basis = Basis::new(self, points);
        let by_contact = shifts.iter().map(|&shift| self.contact_response(shift));
        let by_base = BASE_SHIFTS.iter().map(|factor| self.base_response(factor * own));
        self.stationary_fields().into_iter().chain(by_contact).chain(by_base).for_each(|field| basis.add(field));
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

/// Eigenvalues and eigenvectors of the projected problem.
struct Eigen {
    rates: DVector<f64>,
    vectors: DMatrix<f64>,
    /// Order of the columns, the slowest first.
    order: Vec<usize>,
}

/// Trial functions, orthonormal in the capacity-weighted product.
struct Basis<'a> {
    slab: &'a Slab,
    points: &'a Points,
    functions: Vec<Function>,
}

impl<'a> Basis<'a> {
    fn new(slab: &'a Slab, points: &'a Points) -> Self {
        Basis { slab, points, functions: Vec::new() }
    }

    fn count(&self) -> usize {
        self.functions.len()
    }

    /// Adds a field, unless it depends on the others.
    fn add(&mut self, field: impl Fn(f64) -> (f64, f64)) {
        let product = |left: &[f64], right: &[f64]| self.slab.heat(self.points, left, right);
        Function::new(self.points, field).join(&mut self.functions, product);
    }

    /// Load vectors of the four ports on a function: contact, cooling, ambient, flux into a base without prescribed temperature.
    fn loads(&self, function: &Function) -> [f64; PORTS] {
        let slab = self.slab;
        let mean = self.points.mean(&function.value);
        let cooling = match slab.cooling {
            CoolingPort::Surface => function.contact,
            CoolingPort::Sides => mean,
        };
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * function.far,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        let ambient =
            slab.surface_transfer * function.contact + slab.volume_transfer * slab.height * mean + through_base;
        let base = if slab.base == FarBoundary::Held { 0.0 } else { function.far };
        [function.contact, cooling, ambient, base]
    }

    fn stiffness(&self, left: &Function, right: &Function) -> f64 {
        let slab = self.slab;
        let through_base = match slab.base {
            FarBoundary::Convecting(transfer) => transfer * left.far * right.far,
            FarBoundary::Held | FarBoundary::Insulated => 0.0,
        };
        slab.conduction(self.points, &left.slope, &right.slope)
            + slab.volume_transfer * self.points.product(&left.value, &right.value)
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
        let modes: Vec<Function> = (eigen.order)
            .iter()
            .map(|&index| Function::sum(&self.functions, eigen.vectors.column(index).iter()))
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

    fn assemble(&self, modes: &[Function], rates: &[f64]) -> ReducedBody {
        let slab = self.slab;
        let kept = (modes.len() - 1).max(1);
        let lossless = self.is_lossless();
        let lift = BaseField::new(slab, 0.0);
        let lifted: Vec<f64> = self.points.position.iter().map(|&z| lift.at(z)).collect();
        let mut body = ReducedBody { count: kept, ..ReducedBody::default() };
        let base = Port::Base as usize;
        let ambient = Port::Ambient as usize;
        // Direct feedthrough of the stationary base temperature, before the projection on the states is subtracted.
        body.contact_temperature.direct[base] = lift.at(0.0);
        // Heat of the stationary field, less that of the states: it enters and leaves with the base temperature itself, through the base, so
        // it is not part of the flow determined by the balance.
        body.stored.direct[base] = slab.heat_of(self.points, &lifted);
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
            let mean = self.points.mean(&mode.value);
            // Orthogonal to the uniform temperature where that is a mode.
            let heat = if lossless && k > 0 { 0.0 } else { slab.heat_of(self.points, &mode.value) };
            let lag = slab.lag(rate);
            let projection = lag * slab.heat(self.points, &mode.value, &lifted);
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
                (&mut body.base_temperature, mode.far * lag),
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
