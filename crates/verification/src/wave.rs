//! One pressure wave in full periodic contact, stepped by the line level: thermoelastic instability by the equations of the
//! component.
//!
//! The punch is a conducting half-plane, the strip a rigid insulator. The contact is one wavelength long and begins with a
//! gap of 1e-14 m in a cosine, so that the problem is linear until the wave has grown a million times. Exact rates:
//! [`exact::instability`].
//!
//! Theory: docs/theory.md, sections 7.4, 10.

use crate::Fallible;
use conduction::line::{FrozenState, SingleStep, Stage, Step, Surroundings, ThermalBody};
use elasticity::discretization::compliances;
use exact::instability;
use model::Inputs;
use model::line::Line;
use model::line::operators::LineOperators;
use model::lumped::conditions::Tunables;
use nalgebra::{Complex, DMatrix};
use scene::variables::{STARTS, changed, find};
use scene::{STATIONS, Scene};
use sliding_contact::component::Values;
use std::f64::consts::PI;
use std::sync::Arc;

const WAVELENGTH: f64 = 0.01;
const FRICTION: f64 = 0.3;
const CONDUCTIVITY: f64 = 45.0;
const CAPACITY: f64 = 7800.0 * 460.0;
const YOUNGS_MODULUS: f64 = 2e11;
const POISSONS_RATIO: f64 = 0.3;
const EXPANSION: f64 = 1.1e-5;
/// Mean pressure, Pa.
const PRESSURE: f64 = 1e6;

#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct WaveScene {
    /// Number of cells, over one wavelength.
    pub cells: usize,
    /// Wear number `k K/(mu alpha (1+nu) kd)` of the punch.
    pub wear: f64,
    /// Whether shear tractions displace the surface normally.
    pub coupled: bool,
    /// `solver.tolerance`.
    pub tolerance: f64,
    /// Amplitude of the gap at the start, m; 1e-14: 7e-7 of the mean pressure.
    pub gap: f64,
    /// Duration for which the heat is resolved, over `1/(kd m^2)`.
    pub duration: f64,
}

impl WaveScene {
    /// A contact without wear and shear coupling.
    pub(crate) fn new(cells: usize) -> WaveScene {
        WaveScene { cells, wear: 0.0, coupled: false, tolerance: 1e-5, gap: 1e-14, duration: 1.0 }
    }

    /// Shear coupling `mu (1-2nu)/(2(1-nu))` if enabled.
    pub(crate) fn coupling(&self) -> f64 {
        if self.coupled { FRICTION * (1.0 - 2.0 * POISSONS_RATIO) / (2.0 * (1.0 - POISSONS_RATIO)) } else { 0.0 }
    }

    /// Exact growth rate over `kd m^2` at `ratio` times the critical speed.
    pub(crate) fn exact(&self, ratio: f64) -> Complex<f64> {
        instability::growth_rate(ratio, self.wear, self.coupling())
    }

    /// Initial amplitude over the mean pressure by the gap, before any heat, `E m g/(2 (1 - nu^2) p)`.
    pub(crate) fn beginning(&self) -> f64 {
        let stiffness = YOUNGS_MODULUS / (2.0 * (1.0 - POISSONS_RATIO * POISSONS_RATIO));
        stiffness * (2.0 * PI / WAVELENGTH) * self.gap / PRESSURE
    }

    /// Growing part of the amplitude, at `time` (over `1/(kd m^2)`) from the start and without wear and shear coupling: the
    /// residue at b of the response to a gap that exists from the start,
    ///
    /// ```text
    /// p(s) = (g/s)/(1 - 2R/(l (1 + l))),   l^2 = 1 + s   =>   p = g 4 z R/(b (1 + 2 z)) exp(b t)
    /// ```
    pub(crate) fn grown(&self, ratio: f64, time: f64) -> f64 {
        let b = self.exact(ratio).re;
        let z = (1.0 + b).sqrt();
        self.beginning() * (4.0 * z * ratio / (b * (1.0 + 2.0 * z))) * (b * time).exp()
    }

    fn starts(&self) -> Fallible<Values> {
        let changes = [
            ("solver.fidelity", 3.0),
            ("solver.cells", self.cells as f64),
            ("solver.tolerance", self.tolerance),
            ("contact.geometry", 3.0),
            ("contact.faces", 1.0),
            ("contact.shear_coupling", f64::from(u8::from(self.coupled))),
            ("contact.friction_coefficient", FRICTION),
            ("contact.initial_shape", 4.0),
            ("strip.path", 2.0),
            ("strip.length", WAVELENGTH),
            ("punch.width", WAVELENGTH),
            ("depth", WAVELENGTH),
            ("punch.height", 10.0 * WAVELENGTH),
            ("punch.body", 3.0),
            ("punch.youngs_modulus", YOUNGS_MODULUS),
            ("punch.poissons_ratio", POISSONS_RATIO),
            ("punch.density", 7800.0),
            ("punch.specific_heat", 460.0),
            ("punch.conductivity", CONDUCTIVITY),
            ("punch.thermal_expansion", EXPANSION),
            ("punch.convection", 0.0),
            (
                "punch.wear_coefficient",
                self.wear * FRICTION * EXPANSION * (1.0 + POISSONS_RATIO) / (CONDUCTIVITY * CAPACITY / CONDUCTIVITY),
            ),
            ("strip.body", 1.0),
            ("strip.conductivity", 0.0),
            ("strip.wear_coefficient", 0.0),
            ("nominal.velocity", critical_speed()),
            ("nominal.load", PRESSURE * WAVELENGTH * WAVELENGTH),
            ("nominal.duration", self.duration / unit()),
        ];
        let mut starts = changed(&STARTS, &changes)?;
        let first = find("contact.initial_gap[1]").ok_or("there is no initial gap")? as usize;
        for station in 0..STATIONS {
            let x = station as f64 / (STATIONS - 1) as f64;
            starts[first + station] = self.gap * (1.0 + (2.0 * PI * x).cos());
        }
        Ok(starts)
    }

    /// Operators of the contact, from which waves start.
    pub(crate) fn build(&self) -> Fallible<WaveContact> {
        let scene = Scene::new(&self.starts()?, None)?;
        let operators = Arc::new(LineOperators::new(&scene, steady::run_in)?);
        let angles: Vec<f64> = operators.cells.centres().iter().map(|x| 2.0 * PI * x / WAVELENGTH).collect();
        Ok(WaveContact { scene: *self, operators, angles })
    }
}

/// `kd m^2`, 1/s: the unit of growth rates.
pub(crate) fn unit() -> f64 {
    CONDUCTIVITY / CAPACITY * (2.0 * PI / WAVELENGTH).powi(2)
}

fn critical_speed() -> f64 {
    2.0 * CONDUCTIVITY * (2.0 * PI / WAVELENGTH) * (1.0 - POISSONS_RATIO) / (FRICTION * YOUNGS_MODULUS * EXPANSION)
}

/// A contact in which waves are started.
#[derive(Debug)]
pub struct WaveContact {
    scene: WaveScene,
    operators: Arc<LineOperators>,
    angles: Vec<f64>,
}

impl WaveContact {
    pub(crate) fn scene(&self) -> &WaveScene {
        &self.scene
    }

    pub(crate) fn wave(&self, ratio: f64) -> Wave<'_> {
        let mut inputs = Inputs::from_array(std::array::from_fn(|index| STARTS[index]));
        inputs.sliding_velocity = ratio * critical_speed();
        inputs.normal_load = PRESSURE * WAVELENGTH * WAVELENGTH;
        let tunables =
            Tunables { friction_coefficient: FRICTION, wear_acceleration: 1.0, ..Tunables::of(&self.operators.scene) };
        Wave { contact: self, line: Line::new(self.operators.clone(), tunables, &inputs), inputs }
    }

    /// The same wave as a linear problem, without opening of the contact and without step control.
    pub(crate) fn linear_wave(&self, ratio: f64) -> Fallible<LinearWave> {
        let operators = &self.operators;
        let cosine: Vec<f64> = self.angles.iter().map(|angle| angle.cos()).collect();
        let [body, _] = operators.heat.as_ref().ok_or("the contact line carries no heat")?.prototypes.clone();
        let body = body.ok_or("the punch conducts no heat")?;
        let [punch, _] = compliances(&operators.scene, &operators.cells)?;
        Ok(LinearWave {
            compliance: along(&cosine, &punch.normal, &cosine),
            heat: FRICTION * ratio * critical_speed(),
            gap: self.scene.gap,
            state: vec![0.0; body.states()],
            body,
            cosine,
            amplitude: 0.0,
        })
    }

    /// Communication steps of `step` (over `1/(kd m^2)`), at most `count`, at `ratio` times the critical speed: amplitudes
    /// after each, as long as every cell is in contact.
    pub(crate) fn follow(&self, ratio: f64, step: f64, count: usize) -> Fallible<Vec<Complex<f64>>> {
        let mut wave = self.wave(ratio);
        let mut amplitudes = Vec::with_capacity(count);
        for _ in 0..count {
            wave.step(step)?;
            // The problem is linear as long as every cell is in contact.
            if !wave.touches() {
                break;
            }
            amplitudes.push(wave.amplitude());
        }
        if amplitudes.len() < 6 {
            return Err(format!(
                "the contact opens within {} steps at {ratio} times the critical speed",
                amplitudes.len()
            )
            .into());
        }
        Ok(amplitudes)
    }

    /// Growth rate over `kd m^2` measured over the last `counted` of at most `count` steps of `step` (over `1/(kd m^2)`) at
    /// `ratio` times the critical speed. The step control may subdivide the steps.
    pub(crate) fn growth(&self, ratio: f64, step: f64, count: usize, counted: usize) -> Fallible<Complex<f64>> {
        let amplitudes = self.follow(ratio, step, count)?;
        let oscillates = self.scene.exact(ratio).im != 0.0 && !self.scene.coupled;
        Ok(amplification(&amplitudes, counted, oscillates).ln() / step)
    }
}

#[derive(Debug)]
pub(crate) struct Wave<'a> {
    contact: &'a WaveContact,
    line: Line,
    inputs: Inputs,
}

impl Wave<'_> {
    /// A communication step of `step`, over `1/(kd m^2)`, with the full step control.
    pub(crate) fn step(&mut self, step: f64) -> Fallible<()> {
        Ok(self.line.step(&self.inputs, None, step / unit())?)
    }

    /// Amplitude of the wave over the mean pressure.
    pub(crate) fn amplitude(&self) -> Complex<f64> {
        let pressure = &self.line.state().pressure;
        let parts = pressure.iter().zip(&self.contact.angles).map(|(p, angle)| Complex::from_polar(*p, -angle));
        parts.sum::<Complex<f64>>() * (2.0 / (PRESSURE * pressure.len() as f64))
    }

    /// Whether every cell is in contact.
    pub(crate) fn touches(&self) -> bool {
        self.line.state().pressure.iter().all(|p| *p > 0.0)
    }
}

/// A wave whose pressure, heat and distortion are all one cosine: the stages of the implicit step as equations for two
/// amplitudes, without the inequality constraints of contact.
#[derive(Debug)]
pub(crate) struct LinearWave {
    body: Box<dyn ThermalBody>,
    state: Vec<f64>,
    cosine: Vec<f64>,
    /// Displacement per pressure, m/Pa.
    compliance: f64,
    /// Friction heat per pressure, m/s.
    heat: f64,
    /// Amplitude of the gap, m.
    gap: f64,
    /// Amplitude of the pressure, Pa.
    amplitude: f64,
}

impl LinearWave {
    /// One implicit step of `step`, over `1/(kd m^2)`: `g + C p + u_T(p) = 0` at both stages, the flux constant in the first
    /// and linear through both in the second.
    pub(crate) fn step(&mut self, step: f64) {
        let count = self.cosine.len();
        let air = Surroundings::default();
        let (mut temperature, mut moved) = (vec![0.0; count], vec![0.0; count]);
        self.body.prepare(&Step::new(step / unit(), [0.0; 2]));
        let mut fluxes = [vec![0.0; count], vec![0.0; count]];
        for (index, stage) in [Stage::First, Stage::End].into_iter().enumerate() {
            self.body.free_response(&self.state, &air, stage, &fluxes[0], &mut temperature, &mut moved);
            let base: f64 = 2.0 / count as f64 * self.cosine.iter().zip(&moved).map(|(c, u)| c * u).sum::<f64>();
            let own = along(&self.cosine, &self.body.influence(stage).distortion, &self.cosine);
            self.amplitude = -(self.gap + base) / (self.compliance + self.heat * own);
            let flux = self.heat * self.amplitude;
            fluxes[index] = self.cosine.iter().map(|c| flux * c).collect();
        }
        self.body.step(&mut self.state, &air, &fluxes[0], &fluxes[1]);
    }

    pub(crate) fn amplitude(&self) -> Complex<f64> {
        Complex::new(self.amplitude / PRESSURE, 0.0)
    }
}

/// The same wave by the operator split of the literature: the pressure follows from the distortion at the start of the step, then
/// heats the body by implicit Euler.
///
/// Every state of the body decays independently, `da/dt = b q - rate a`, so that its step is `a <- (a + h b q)/(1 + rate h)`. The
/// inputs b are those of an exact step from rest under a constant flux, `a = b q (1 - exp(-rate h))/rate`.
#[derive(Debug)]
pub(crate) struct SplitWave {
    wave: LinearWave,
    rates: Vec<f64>,
    /// b: rates of change of the states by a flux of 1 W/m2 in the cosine.
    inputs: Vec<f64>,
    /// Amplitude of the thermal distortion, m.
    moved: f64,
}

impl SplitWave {
    pub(crate) fn new(mut wave: LinearWave) -> SplitWave {
        let rates = wave.body.decay_rates(0.0);
        // Resolves the fastest state: no input is lost to rounding.
        let step = 1.0 / rates.iter().copied().fold(0.0, f64::max);
        let mut inputs = wave.state.clone();
        wave.body.prepare(&Step::new(step, [0.0; 2]));
        wave.body.step(&mut inputs, &Surroundings::default(), &wave.cosine, &wave.cosine);
        for (input, rate) in inputs.iter_mut().zip(&rates) {
            *input *= if *rate > 0.0 { -rate / (-rate * step).exp_m1() } else { 1.0 / step };
        }
        SplitWave { wave, rates, inputs, moved: 0.0 }
    }

    /// One step of `step`, over `1/(kd m^2)`.
    pub(crate) fn step(&mut self, step: f64) {
        let SplitWave { wave, rates, inputs, moved } = self;
        wave.amplitude = -(wave.gap + *moved) / wave.compliance;
        let (flux, step) = (wave.heat * wave.amplitude, step / unit());
        for ((state, input), rate) in wave.state.iter_mut().zip(inputs).zip(rates) {
            *state = (*state + step * flux * *input) / (1.0 + *rate * step);
        }
        let fluxes: Vec<f64> = wave.cosine.iter().map(|c| flux * c).collect();
        let (state, surroundings) = (&wave.state, &Surroundings::default());
        let distortion = FrozenState { state, surroundings, flux: &fluxes, velocity: 0.0 }.distortion(&*wave.body);
        *moved = 2.0 / fluxes.len() as f64 * wave.cosine.iter().zip(&distortion).map(|(c, u)| c * u).sum::<f64>();
    }

    pub(crate) fn amplitude(&self) -> Complex<f64> {
        self.wave.amplitude()
    }
}

/// Amplitude of the cosine `shape` in `matrix` times `values`.
fn along(shape: &[f64], matrix: &DMatrix<f64>, values: &[f64]) -> f64 {
    let count = shape.len();
    let row = |i: usize| (0..count).map(|j| matrix[(i, j)] * values[j]).sum::<f64>();
    2.0 / count as f64 * (0..count).map(|i| shape[i] * row(i)).sum::<f64>()
}

/// Factor by which the changes of `amplitudes` grow from one to the next, over the last `counted`: of a single mode, or of
/// an oscillating pair. A constant part, such as the wave of an unworn gap, does not contribute to the changes.
pub(crate) fn amplification(amplitudes: &[Complex<f64>], counted: usize, oscillates: bool) -> Complex<f64> {
    let changes: Vec<Complex<f64>> = amplitudes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let last = &changes[changes.len().saturating_sub(counted)..];
    if !oscillates {
        let (mut product, mut square) = (Complex::new(0.0, 0.0), 0.0);
        for pair in last.windows(2) {
            // Relative changes, so that the last does not outweigh all others.
            product += pair[1] / pair[0];
            square += 1.0;
        }
        return product / square;
    }
    // c_{n+1} = s c_n - d c_{n-1}, least squares in real numbers.
    let mut normal = [[0.0; 2]; 2];
    let mut right = [0.0; 2];
    for triple in last.windows(3) {
        let scale = triple.iter().map(|change| change.re.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let [earlier, now, later] = [triple[0].re / scale, triple[1].re / scale, triple[2].re / scale];
        let row = [now, -earlier];
        for i in 0..2 {
            right[i] += row[i] * later;
            for j in 0..2 {
                normal[i][j] += row[i] * row[j];
            }
        }
    }
    let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
    let s = (right[0] * normal[1][1] - right[1] * normal[0][1]) / determinant;
    let d = (normal[0][0] * right[1] - normal[1][0] * right[0]) / determinant;
    let root = Complex::new(0.25 * s * s - d, 0.0).sqrt();
    let pair = [Complex::new(0.5 * s, 0.0) + root, Complex::new(0.5 * s, 0.0) - root];
    if pair[0].norm() >= pair[1].norm() { pair[0] } else { pair[1] }
}
