//! Response of the bodies, as layers of their own heights, to a pressure wave.
//!
//! A wave of wave number q that moves at the speed c_i in the frame of body i excites it at the frequency `s = -i q c_i`. The
//! layer absorbs the flux `Y T`, has the thermal lift `L T` and the elastic displacement `C p`: Y and L from conduction through
//! its height ([`Depth`]), L by reciprocity with the dilatation under pressure, C by its elastic kernel. With the friction heat
//! `mu V p`, the pressure by the thermal lift and the resistance `r = 1/(2 h_c)` between each surface and the other, the wave is
//! neutral where
//!
//! ```text
//! mu V = Z = (C_1 + C_2) [Y_1 (1 + r Y_2) + Y_2 (1 + r Y_1)]/[L_1 (1 + r Y_2) + L_2 (1 + r Y_1)].
//! ```
//!
//! Theory: docs/theory.md, sections 7.4, 3.6.

use conduction::line::strip::{Depth, dilatation};
use conduction::slab::Slab;
pub use elasticity::kinds::FarFace;
use elasticity::kinds::wave_compliance;
use elasticity::{Base, antisymmetric};
use nalgebra::Complex;
use scene::{Body, FarBoundary, MechanicalBody, Scene};

/// 1/(2 h_c), K m2/W.
pub(crate) fn half_resistance(scene: &Scene) -> f64 {
    // Half of the resistance between surfaces without heat exchange, K m2/W: each receives half of the heat.
    if scene.conductance > 0.0 { 0.5 / scene.conductance } else { 1e12 }
}

/// Layer at one wave number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// `None`: an insulator.
    conduction: Option<Depth>,
    expands: bool,
    /// Displacement per pressure, m/Pa.
    compliance: f64,
}

impl Layer {
    /// Layer of a body at the wave number `wave`, 1/m.
    pub(crate) fn new(body: &Body, far: FarFace, wave: f64) -> Layer {
        let nu = body.poissons_ratio;
        let u = wave * body.height;
        let compliance = wave_compliance(body, far, wave);
        let expands = body.conductivity > 0.0 && body.thermal_expansion > 0.0;
        let coefficient = 2.0 * (1.0 + nu) * body.thermal_expansion;
        let by_pressure = match (body.mechanical, far) {
            (MechanicalBody::HalfPlane, _) => (1.0, 0.0),
            (_, FarFace::Antisymmetric) => antisymmetric::dilatation(u),
            _ => dilatation(far.base(), nu, u),
        };
        let base = match far {
            FarFace::Symmetric => FarBoundary::Insulated,
            FarFace::Antisymmetric => FarBoundary::Held,
            FarFace::Held(_) => body.far_boundary(),
        };
        let slab = Slab { base, ..Slab::of(body) };
        let lifts = expands.then_some((coefficient * by_pressure.0, coefficient * by_pressure.1));
        let conduction = (body.conductivity > 0.0).then(|| Depth::with_dilatation(&slab, lifts, wave));
        Layer { conduction, expands, compliance }
    }

    /// Heat uptake Y, W/(m2 K), and thermal lift L, m/K, at the frequency `s`, 1/s.
    pub(crate) fn respond(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let Some(conduction) = &self.conduction else { return [Complex::from(0.0); 2] };
        let [impedance, distortion] = conduction.respond(s);
        let uptake = impedance.inv();
        [uptake, -distortion * uptake]
    }
}

/// Both bodies at one wave number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layers {
    /// Punch and strip.
    pub bodies: [Layer; 2],
    /// Wave number, 1/m.
    pub wave: f64,
    /// 1/(2 h_c), K m2/W.
    pub half_resistance: f64,
}

impl Layers {
    /// The scene's bodies at the wave number `wave`, 1/m; `strip`: condition at the far face of the strip.
    pub(crate) fn new(scene: &Scene, strip: FarFace, wave: f64) -> Layers {
        let punch = Layer::new(&scene.punch, FarFace::Held(Base::Bonded), wave);
        let strip = Layer::new(&scene.strip, strip, wave);
        Layers { bodies: [punch, strip], wave, half_resistance: half_resistance(scene) }
    }

    /// Compliance C of both, m/Pa.
    pub(crate) fn compliance(&self) -> f64 {
        self.bodies[0].compliance + self.bodies[1].compliance
    }

    /// Whether the wave cannot grow: no thermal expansion, or no elastic compliance.
    pub(crate) fn is_neutral(&self) -> bool {
        let lifts = self.bodies.iter().any(|body| body.expands);
        !lifts || self.compliance() <= 0.0 || !self.compliance().is_finite()
    }

    /// Z of the more unstable body, by itself at rest, Pa.m/s.
    pub(crate) fn alone(&self) -> f64 {
        let rest = Complex::from(0.0);
        let own = |body: &Layer| {
            let [uptake, lift] = body.respond(rest);
            self.compliance() * uptake.re / lift.re
        };
        self.bodies.iter().filter(|body| body.expands).map(own).fold(f64::INFINITY, f64::min)
    }

    /// Z in m/s for a wave that moves at these speeds in the frames of the two bodies.
    pub(crate) fn impedance(&self, speeds: [f64; 2]) -> Complex<f64> {
        let at = |body: usize| self.bodies[body].respond(Complex::new(0.0, -self.wave * speeds[body]));
        let ([first, lift_first], [second, lift_second]) = (at(0), at(1));
        let temperature = [second * self.half_resistance + 1.0, first * self.half_resistance + 1.0];
        let heat = first * temperature[0] + second * temperature[1];
        let lift = lift_first * temperature[0] + lift_second * temperature[1];
        heat / lift * self.compliance()
    }
}
