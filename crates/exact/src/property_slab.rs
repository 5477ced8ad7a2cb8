//! Heat conduction through a slab whose conductivity and specific heat depend on its local temperature.
//!
//! ```text
//! rho c(T) dT/dt = (K(T) T')',   0 < z < h,   -K T'(0) = q - H0 (T(0) - T_air)
//! ```
//!
//! Finite volumes around nodes graded towards both faces. The unknown is the temperature, the balance that of the enthalpy, and the
//! flux between two nodes the difference of the Kirchhoff integral of K, so that heat is conserved to rounding. In time TR-BDF2 (Bank et
//! al. 1985), with Newton's method on the tridiagonal system.
//!
//! Theory: docs/theory.md, section 4.15.

/// Conductivity and specific heat at increasing temperatures, linear between and constant beyond.
#[derive(Clone, Debug)]
struct Curve {
    /// Temperatures, K, and values there.
    points: Vec<(f64, f64)>,
    /// Integrals of the values from the first temperature to each.
    integrals: Vec<f64>,
}

impl Curve {
    fn new(points: Vec<(f64, f64)>) -> Curve {
        let mut integrals = vec![0.0];
        for pair in points.windows(2) {
            integrals.push(integrals[integrals.len() - 1] + 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0));
        }
        Curve { points, integrals }
    }

    /// Value and integral from the first temperature.
    fn at(&self, t: f64) -> (f64, f64) {
        let last = self.points.len() - 1;
        let next = self.points.partition_point(|point| point.0 <= t);
        if next == 0 {
            return (self.points[0].1, (t - self.points[0].0) * self.points[0].1);
        }
        let (from, value) = self.points[next - 1];
        if next > last {
            return (value, self.integrals[last] + (t - from) * value);
        }
        let (to, other) = self.points[next];
        let now = value + (other - value) * (t - from) / (to - from);
        (now, self.integrals[next - 1] + 0.5 * (value + now) * (t - from))
    }
}

/// Condition at a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Face {
    /// Heat transfer coefficient (W/(m2 K)) to air of a temperature (K); 0: insulated.
    Convecting(f64, f64),
    /// Temperature prescribed, K.
    Held(f64),
}

/// The slab and its state.
#[derive(Clone, Debug)]
pub struct PropertySlab {
    conductivity: Curve,
    heat: Curve,
    density: f64,
    /// Distances between neighbouring nodes and the volumes of the nodes per area, m.
    spacing: Vec<f64>,
    volume: Vec<f64>,
    /// Conditions at the contact and at the far face.
    pub faces: [Face; 2],
    /// Temperatures of the nodes, K, the first at the contact.
    pub temperature: Vec<f64>,
    /// Heat that has left through both faces without the flux q, J/m2.
    pub lost: [f64; 2],
}

/// TR-BDF2: fraction of the step of the trapezoidal stage.
const PART: f64 = 2.0 - std::f64::consts::SQRT_2;

impl PropertySlab {
    /// Slab of `height` (m) and `density` (kg/m3) at `start` (K), with `points` of temperature (K), conductivity (W/(m K)) and specific
    /// heat (J/(kg K)), between the faces `faces`; `nodes` spaced by the cosine, finest at both faces.
    pub fn new(
        height: f64,
        density: f64,
        points: &[(f64, f64, f64)],
        faces: [Face; 2],
        nodes: usize,
        start: f64,
    ) -> PropertySlab {
        let place = |i: usize| 0.5 * height * (1.0 - (std::f64::consts::PI * i as f64 / (nodes - 1) as f64).cos());
        let spacing: Vec<f64> = (1..nodes).map(|i| place(i) - place(i - 1)).collect();
        let volume = (0..nodes)
            .map(|i| 0.5 * (if i > 0 { spacing[i - 1] } else { 0.0 } + spacing.get(i).copied().unwrap_or(0.0)))
            .collect();
        let mut temperature = vec![start; nodes];
        if let Face::Held(held) = faces[1] {
            temperature[nodes - 1] = held;
        }
        PropertySlab {
            conductivity: Curve::new(points.iter().map(|point| (point.0, point.1)).collect()),
            heat: Curve::new(points.iter().map(|point| (point.0, point.2)).collect()),
            density,
            spacing,
            volume,
            faces,
            temperature,
            lost: [0.0; 2],
        }
    }

    /// Temperature of the contact face, K.
    pub fn surface(&self) -> f64 {
        self.temperature[0]
    }

    /// Mean temperature, K.
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.temperature.iter().zip(&self.volume).map(|(t, volume)| t * volume).sum();
        sum / self.volume.iter().sum::<f64>()
    }

    fn enthalpies(&self, temperature: &[f64]) -> Vec<f64> {
        let of = |(t, volume): (&f64, &f64)| self.density * volume * self.heat.at(*t).1;
        temperature.iter().zip(&self.volume).map(of).collect()
    }

    /// Heat flow into every node under the flux `q` (W/m2) into the contact face, W/m2, and that out of both faces.
    fn flows(&self, temperature: &[f64], q: f64) -> (Vec<f64>, [f64; 2]) {
        let last = temperature.len() - 1;
        let mut flows = vec![0.0; temperature.len()];
        for i in 0..last {
            let [left, right] = [temperature[i], temperature[i + 1]].map(|t| self.conductivity.at(t).1);
            let flow = (left - right) / self.spacing[i];
            flows[i] -= flow;
            flows[i + 1] += flow;
        }
        flows[0] += q;
        let mut out = [0.0; 2];
        for (face, node) in [0, last].into_iter().enumerate() {
            match self.faces[face] {
                Face::Convecting(transfer, air) => out[face] = transfer * (temperature[node] - air),
                Face::Held(_) => out[face] = flows[node],
            }
            flows[node] -= out[face];
        }
        (flows, out)
    }

    /// Advances by `step` (s) under a flux that is linear in time between `from` and `to`, W/m2.
    pub fn advance(&mut self, step: f64, from: f64, to: f64) {
        let before = self.enthalpies(&self.temperature);
        let (flows, out) = self.flows(&self.temperature, from);
        let middle = from + PART * (to - from);
        // Trapezoidal rule to the part, then BDF2.
        let known: Vec<f64> = before.iter().zip(&flows).map(|(heat, flow)| heat + 0.5 * PART * step * flow).collect();
        let start = self.temperature.clone();
        let weight = 0.5 * PART * step;
        let first = self.solve(&known, weight, middle, start);
        let (_, out_first) = self.flows(&first, middle);
        let (a, b) = (1.0 / (PART * (2.0 - PART)), (1.0 - PART).powi(2) / (PART * (2.0 - PART)));
        let heats = self.enthalpies(&first);
        let known: Vec<f64> = heats.iter().zip(&before).map(|(first, before)| a * first - b * before).collect();
        let end = self.solve(&known, weight, to, first);
        let (_, out_end) = self.flows(&end, to);
        for face in 0..2 {
            // The same combination of flows as that of the enthalpies.
            let to_part = weight * (out[face] + out_first[face]);
            self.lost[face] += a * to_part + weight * out_end[face];
        }
        self.temperature = end;
    }

    /// Temperatures T with enthalpies `known` + `weight` times the flows at T under the flux `q`.
    fn solve(&self, known: &[f64], weight: f64, q: f64, mut temperature: Vec<f64>) -> Vec<f64> {
        let count = temperature.len();
        for _ in 0..60 {
            let (flows, _) = self.flows(&temperature, q);
            let heats = self.enthalpies(&temperature);
            let conductivity: Vec<f64> = temperature.iter().map(|t| self.conductivity.at(*t).0).collect();
            // Columns of the Jacobian: below, on and above the diagonal of every row.
            let mut rows = vec![[0.0; 3]; count];
            for i in 0..count {
                rows[i][1] = self.density * self.volume[i] * self.heat.at(temperature[i]).0;
                if i > 0 {
                    rows[i][0] = -weight * conductivity[i - 1] / self.spacing[i - 1];
                    rows[i][1] += weight * conductivity[i] / self.spacing[i - 1];
                }
                if i + 1 < count {
                    rows[i][2] = -weight * conductivity[i + 1] / self.spacing[i];
                    rows[i][1] += weight * conductivity[i] / self.spacing[i];
                }
            }
            for (face, node) in [0, count - 1].into_iter().enumerate() {
                if let Face::Convecting(transfer, _) = self.faces[face] {
                    rows[node][1] += weight * transfer;
                }
            }
            let mut change: Vec<f64> = (0..count).map(|i| known[i] + weight * flows[i] - heats[i]).collect();
            for (face, node) in [0, count - 1].into_iter().enumerate() {
                if let Face::Held(held) = self.faces[face] {
                    rows[node] = [0.0, 1.0, 0.0];
                    change[node] = held - temperature[node];
                }
            }
            for i in 1..count {
                let factor = rows[i][0] / rows[i - 1][1];
                rows[i][1] -= factor * rows[i - 1][2];
                change[i] -= factor * change[i - 1];
            }
            for i in (0..count).rev() {
                let above = if i + 1 < count { rows[i][2] * change[i + 1] } else { 0.0 };
                change[i] = (change[i] - above) / rows[i][1];
            }
            temperature.iter_mut().zip(&change).for_each(|(t, change)| *t += change);
            if change.iter().all(|change| change.abs() < 1e-11 * 300.0) {
                break;
            }
        }
        temperature
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Conductivity and specific heat in proportion, linear in temperature: the Kirchhoff integral obeys the linear equation.
    fn in_proportion(faces: [Face; 2], nodes: usize) -> PropertySlab {
        let points = [(300.0, 50.0, 460.0), (1300.0, 25.0, 230.0)];
        PropertySlab::new(0.05, 7850.0, &points, faces, nodes, 300.0)
    }

    #[test]
    fn a_kirchhoff_integral_that_obeys_the_linear_equation_is_followed() {
        // After 1 s of 5 MW/m2 the integral over K0 is that of a half-space of constants: 2 q sqrt(t/(pi K C)).
        let (q, time) = (5e6, 1.0);
        let integral = 2.0 * q * (time / (PI * 50.0 * 7850.0 * 460.0_f64)).sqrt();
        // rise - rise^2/(4 * 500 K) = integral, for K = K0 (1 - rise/2000 K)
        let exact = 1000.0 * 2.0 * (1.0 - (1.0 - integral / 1000.0).sqrt());
        let errors = [(400, 200), (800, 400)].map(|(nodes, steps)| {
            let mut slab = in_proportion([Face::Convecting(0.0, 300.0); 2], nodes);
            // Steps that grow with time resolve the start.
            let at = |i: i32| time * (f64::from(i) / f64::from(steps)).powi(3);
            (0..steps).for_each(|i| slab.advance(at(i + 1) - at(i), q, q));
            (slab.surface() - 300.0) / exact - 1.0
        });
        assert!(errors[1].abs() < 2e-4 && errors[1].abs() < 0.4 * errors[0].abs(), "{errors:?}");
    }
}
