//! Reciprocating sliding on a straight path against a direct Fourier solution of the layer.

use std::f64::consts::PI;
use test_support::{Drive, HELD};

const CONDUCTIVITY: f64 = 54.0;
const CAPACITY: f64 = 7200.0 * 460.0;
const HEIGHT: f64 = 0.005;
const HALF: f64 = 0.01;
const DEPTH: f64 = 0.05;
const LOAD: f64 = 1e3;
const FRICTION: f64 = 0.4;

/// x = A sin(w t) with the flux mu p |v| over |x| < a on a layer with held base, from its temperature.
struct Brute {
    amplitude: f64,
    frequency: f64,
}

impl Brute {
    fn flux(&self, t: f64) -> f64 {
        FRICTION * LOAD / (2.0 * HALF * DEPTH) * self.amplitude * self.frequency * (self.frequency * t).cos().abs()
    }

    /// Mean temperature over the contact at `samples` points of each of the last `kept` of `periods` periods. Modes
    /// cos(b_m z) exp(i q_n x), b_m = (m + 1/2) pi/h; each decays with kd (b^2 + q^2) and takes the flux of the middle
    /// of the step, whose length is `1/steps` of a period. The modes beyond m = 80 are in their steady state.
    fn mean(&self, periods: u32, steps: u32) -> f64 {
        let (harmonics, rows) = (120, 80);
        let length = 2.0 * self.amplitude + 2.0 * HALF + 16.0 * HEIGHT;
        let step = 2.0 * PI / self.frequency / f64::from(steps);
        let diffusivity = CONDUCTIVITY / CAPACITY;
        let waves: Vec<(f64, f64)> = (0..=harmonics)
            .map(|n| {
                let q = 2.0 * PI * f64::from(n) / length;
                let shape = if n == 0 { 1.0 } else { (q * HALF).sin() / (q * HALF) };
                (q, shape)
            })
            .collect();
        let row_rate = |m: u32| ((f64::from(m) + 0.5) * PI / HEIGHT).powi(2);
        // Decay, gain and state (cosine and sine part) of every mode.
        let mut modes: Vec<Vec<[f64; 4]>> = waves
            .iter()
            .map(|(q, _)| {
                (0..rows)
                    .map(|m| {
                        let rate = diffusivity * (row_rate(m) + q * q);
                        let decay = (-rate * step).exp();
                        [decay, 2.0 / (CAPACITY * HEIGHT) * (1.0 - decay) / rate, 0.0, 0.0]
                    })
                    .collect()
            })
            .collect();
        let rest: Vec<f64> = waves
            .iter()
            .map(|(q, _)| {
                let kappa = q.max(1e-6);
                let all = (kappa * HEIGHT).tanh() / (kappa * CONDUCTIVITY);
                all - (0..rows).map(|m| 2.0 / (HEIGHT * CONDUCTIVITY * (row_rate(m) + q * q))).sum::<f64>()
            })
            .collect();
        let mut mean = 0.0;
        for index in 0..periods * steps {
            let (t, end) = ((f64::from(index) + 0.5) * step, f64::from(index + 1) * step);
            let (x, flux) = (self.amplitude * (self.frequency * t).sin(), self.flux(t));
            let last = index >= (periods - 1) * steps;
            let (there, there_flux) = (self.amplitude * (self.frequency * end).sin(), self.flux(end));
            for ((&(q, shape), states), rest) in waves.iter().zip(&mut modes).zip(&rest) {
                let weight = 2.0 * HALF / length * shape * if q == 0.0 { 1.0 } else { 2.0 };
                let (cosine, sine) = (weight * flux * (q * x).cos(), weight * flux * (q * x).sin());
                let (mut c, mut s) = (0.0, 0.0);
                for mode in states {
                    mode[2] = mode[0] * mode[2] + mode[1] * cosine;
                    mode[3] = mode[0] * mode[3] + mode[1] * sine;
                    c += mode[2];
                    s += mode[3];
                }
                if last {
                    let here = (q * there).cos() * c + (q * there).sin() * s;
                    mean += shape * (here + rest * weight * there_flux) / f64::from(steps);
                }
            }
        }
        mean
    }
}

/// The same through the component: mean over the last period.
fn lumped(amplitude: f64, frequency: f64, periods: u32, steps: u32) -> (f64, f64) {
    let period = 2.0 * PI / frequency;
    let changes = [
        ("strip.path", 1.0),
        ("contact.mean_radius", 0.0),
        ("punch.width", 2.0 * HALF),
        ("depth", DEPTH),
        ("strip.height", HEIGHT),
        ("strip.base_thermal", HELD),
        ("contact.faces", 1.0),
        ("contact.friction_coefficient", FRICTION),
        ("punch.conductivity", 0.0),
        ("contact.conductance", 1e15),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("nominal.stroke", 2.0 * amplitude),
        ("nominal.duration", f64::from(periods) * period),
        ("nominal.velocity", 0.0),
        ("solver.tolerance", 1e-4),
    ];
    let mut drive = Drive::stock(&changes);
    drive.set("normal_load", LOAD);
    let step = period / f64::from(steps);
    let mut mean = 0.0;
    for index in 0..periods * steps {
        let t = f64::from(index) * step;
        let v = |t: f64| amplitude * frequency * (frequency * t).cos();
        drive.set("sliding_velocity", v(t)).slope("sliding_velocity", (v(t + step) - v(t)) / step).step(step);
        if index >= (periods - 1) * steps {
            mean += (drive.get("contact_temperature") - 293.15) / f64::from(steps);
        }
    }
    (mean, drive.imbalance())
}

#[test]
fn reciprocating_heating_follows_the_brute_force_solution() {
    for (amplitude, frequency, periods) in [(0.001, 10.0, 20), (0.01, 2.0, 10), (0.05, 2.0, 6), (0.1, 10.0, 6)] {
        let brute = Brute { amplitude, frequency };
        let exact = brute.mean(periods, 400);
        let (mean, imbalance) = lumped(amplitude, frequency, periods, 400);
        println!("amplitude {amplitude} frequency {frequency}: {mean} {exact}: {:.4}", mean / exact - 1.0);
        assert!(imbalance < 1e-9);
        // Accuracy of the lumped level here: it assumes an evenly visited track and one mean sliding rate.
        assert!((mean / exact - 1.0).abs() < 0.06, "amplitude {amplitude}, {frequency} 1/s: {mean} instead of {exact}");
    }
}
