//! Heat in the punch: the reduced body of the contact line against the plain sum over all modes of the rectangle.
//!
//! Theory: docs/theory.md, section 4.6.

use super::Problem;
use crate::Fallible;
use conduction::line::punch;
use conduction::line::{GAMMA, Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use elasticity::Cells;
use scene::Scene;
use scene::variables::{STARTS, changed};
use sliding_contact::component::Values;
use std::f64::consts::PI;

const WIDTH: f64 = 0.06;
const HEIGHT: f64 = 0.1;
const CONDUCTIVITY: f64 = 55.0;
const CAPACITY: f64 = 7800.0 * 460.0;
const CELLS: usize = 32;
/// Duration of the reduction, s.
const DURATION: f64 = 10.0;
/// Tolerance of the reduction, relative to the rise by a uniform flux over the duration.
const TOLERANCE: f64 = 1e-4;

/// Flux of 1 W/m2 times a function of time, into the half x > 0 of the contact.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Flux {
    Step,
    /// Ramp from 0 by 1 per second.
    Ramp,
    /// Sine sin(omega t).
    Sine(f64),
}

impl Flux {
    fn at(self, time: f64) -> f64 {
        match self {
            Self::Step => 1.0,
            Self::Ramp => time,
            Self::Sine(frequency) => (frequency * time).sin(),
        }
    }

    /// Transient part `integral exp(-rate (t - s)) flux(s) ds - flux(t)/rate` at `time`.
    fn remainder(self, rate: f64, time: f64) -> f64 {
        let decay = (-rate * time).exp();
        match self {
            Self::Step => -decay / rate,
            Self::Ramp => (decay - 1.0) / (rate * rate),
            Self::Sine(frequency) => {
                let sum = rate * rate + frequency * frequency;
                let (sine, cosine) = (frequency * time).sin_cos();
                (frequency * (decay - cosine) - frequency * frequency * sine / rate) / sum
            }
        }
    }

    /// Mean temperature of the heated half at `time`: sides insulated, top held.
    ///
    /// Modes `cos(m pi (x + a)/(2a)) cos((n + 1/2) pi z/h)`; the sums of 1/rate over n are `tanh(q h)/(K q)`.
    fn temperature(self, time: f64) -> f64 {
        let diffusivity = CONDUCTIVITY / CAPACITY;
        let part = 2.0 / (HEIGHT * CAPACITY);
        let mode = |m: i32| {
            let q = f64::from(m) * PI / WIDTH;
            // Mean over the half of the normalised mode, times its heat there, per width.
            let shape =
                if m == 0 { 0.5 } else { 4.0 * (0.5 * f64::from(m) * PI).sin().powi(2) / (f64::from(m) * PI).powi(2) };
            let steady = if m == 0 { HEIGHT / CONDUCTIVITY } else { (q * HEIGHT).tanh() / (CONDUCTIVITY * q) };
            let left: f64 = (0..2000)
                .map(|n| diffusivity * (((f64::from(n) + 0.5) * PI / HEIGHT).powi(2) + q * q))
                .map(|rate| part * self.remainder(rate, time))
                .sum();
            shape * (self.at(time) * steady + left)
        };
        (0..400).filter(|m| *m == 0 || m % 2 == 1).map(mode).sum()
    }

    /// The same temperature by the reduced body with `count` steps up to `time`.
    fn reduced(self, time: f64, count: u32) -> Fallible<f64> {
        let cells = Cells::graded(0.5 * WIDTH, CELLS)?;
        let scene = Scene::new(&starts()?, None)?;
        let body = punch::reduce(&scene, &cells, TOLERANCE, DURATION)?;
        let mut body = body.ok_or("the punch conducts")?;
        if body.error() > 3.0 * TOLERANCE {
            return Err(format!("the reduction states an error of {:e}", body.error()).into());
        }
        let air = Surroundings::default();
        let mut state = vec![0.0; body.states()];
        let step = time / f64::from(count);
        let into = |value: f64| -> Vec<f64> { (0..CELLS).map(|i| if i < CELLS / 2 { 0.0 } else { value }).collect() };
        body.prepare(&Step::new(step, [0.0; 2]));
        let mut temperature = vec![0.0; CELLS];
        let mut distortion = vec![0.0; CELLS];
        for index in 0..count {
            let start = f64::from(index) * step;
            let [first, end] = [GAMMA * step, step].map(|part| into(self.at(start + part)));
            if index + 1 == count {
                body.free_response(&state, &air, Stage::End, &first, &mut temperature, &mut distortion);
                let influence = &body.influence(Stage::End).temperature;
                for (i, value) in temperature.iter_mut().enumerate() {
                    *value += (0..CELLS).map(|j| influence[(i, j)] * end[j]).sum::<f64>();
                }
            }
            body.step(&mut state, &air, &first, &end);
        }
        let half = CELLS / 2..CELLS;
        Ok(half.map(|i| cells.widths()[i] * temperature[i]).sum::<f64>() / (0.5 * WIDTH))
    }
}

fn starts() -> Fallible<Values> {
    let changes = [
        ("punch.width", WIDTH),
        ("punch.height", HEIGHT),
        ("punch.conductivity", CONDUCTIVITY),
        ("punch.density", 7800.0),
        ("punch.specific_heat", 460.0),
        ("punch.convection", 0.0),
        ("punch.top_thermal", 1.0),
        ("punch.thermal_expansion", 0.0),
    ];
    Ok(changed(&STARTS, &changes)?)
}

pub(super) fn problems() -> Vec<Problem> {
    let cases = [
        ("a step, after 10 s", Flux::Step, 10.0, 20, 1.0),
        ("a step, after 0.1 s", Flux::Step, 0.1, 20, 1.0),
        ("a ramp, after 10 s", Flux::Ramp, 10.0, 20, 10.0),
        ("10 Hz, after 1.22 periods", Flux::Sine(20.0 * PI), 0.122, 600, 1.0),
    ];
    let problem = |(name, function, time, count, flux): (&str, Flux, f64, u32, f64)| Problem {
        name: format!("reduced punch of 60 x 100 mm, flux into half of its contact: {name}"),
        quantity: "mean temperature of that half, K.m2/W",
        exact: Box::new(move || Ok(function.temperature(time))),
        // The rise by a uniform flux over the duration.
        scale: Some(flux * 2.0 * (DURATION / (PI * CONDUCTIVITY * CAPACITY)).sqrt()),
        compute: Box::new(move || function.reduced(time, count)),
        bound: TOLERANCE,
        reason: "the reduction's tolerance; what it states is at most 1.2 of it, by any flux and at any frequency",
    };
    cases.into_iter().map(problem).collect()
}
