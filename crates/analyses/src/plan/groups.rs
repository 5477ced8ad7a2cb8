//! Dimensionless groups of a scene at its nominal conditions.
//!
//! Symbols: [`Groups`].

use contact::wear::law::WearLaw;
use elasticity::kinds::{mean_compliance, plane_strain_compliance};
use model::instability::CriticalSpeed;
use scene::{Body, Scene};

/// Symbols: V speed, W width, a = W/2, h height, t duration, kd diffusivity, K conductivity, p mean pressure, C mean
/// compliance of both bodies, T rise of the contact temperature at the end.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Groups {
    /// V a/kd of the strip; 0: an insulator.
    pub peclet: f64,
    /// kd t/h^2 of punch and strip.
    pub fourier: [f64; 2],
    /// Heat transfer coefficient times h/K of punch and strip.
    pub biot: [f64; 2],
    /// (1/E2* - 1/E1*)/(1/E1* + 1/E2*): 1 for a rigid punch, -1 for a rigid strip.
    pub dundurs: f64,
    /// Fraction of the mean compliance in the strip.
    pub strip_compliance: f64,
    /// alpha (1 + nu) T min(h, W) of both bodies over C p.
    pub distortion_over_approach: f64,
    /// Wear of both bodies at the end over C p.
    pub wear_over_approach: f64,
    /// Fraction of the worn depth in the strip.
    pub strip_wear: f64,
    /// V over the critical speed of thermoelastic instability; 0 without thermal expansion.
    pub speed_over_critical: f64,
    /// mu H/a: lever of the friction force over the half-width; 0 where the punch cannot rotate.
    pub lever: f64,
    /// Larger |b - 1| of the bodies that wear, b the exponent of the pressure at the nominal load.
    pub exponent: f64,
    /// Largest change of a fade table's factor between ambient temperature and T, of friction and of wear.
    pub fade: [f64; 2],
}

impl Groups {
    /// Groups of `scene` with this critical speed, for a rise `rise` (K) of the contact temperature.
    pub(crate) fn new(scene: &Scene, critical: &CriticalSpeed, rise: f64) -> Groups {
        let bodies = [&scene.punch, &scene.strip];
        let pressure = scene.nominal_pressure();
        let [soft_punch, soft_strip] = bodies.map(plane_strain_compliance);
        let compliances = [mean_compliance(scene, &scene.punch, true), mean_compliance(scene, &scene.strip, false)];
        let approach = (compliances[0] + compliances[1]) * pressure;
        let over = |value: f64| if approach > 0.0 { value / approach } else { 0.0 };
        let expansion: f64 = bodies
            .iter()
            .map(|body| body.thermal_expansion * (1.0 + body.poissons_ratio) * rise * body.height.min(scene.width))
            .sum();
        let covered = if scene.coverage() > 0.0 { scene.coverage() } else { 1.0 };
        let law = |body: &Body| WearLaw::new(body, scene.friction_coefficient, &scene.friction_fade);
        let worn = |body: &Body| {
            law(body).rate(pressure, scene.nominal_velocity, scene.friction_coefficient, scene.ambient_temperature)
                * scene.nominal_duration
                * scene.wear_acceleration
        };
        let depths = [worn(&scene.punch), worn(&scene.strip) * covered];
        let critical = critical.modelled(scene.friction_coefficient);
        let rotates =
            scene.constraint == scene::Constraint::TranslateAndRotate && scene.geometry == scene::Geometry::Line;
        let hot = scene.ambient_temperature + rise;
        let change = |table: &scene::FadeTable| {
            let start = table.at(scene.ambient_temperature).0;
            (table.at(hot).0 - start).abs() / start.abs().max(1e-9)
        };
        let wears = bodies.map(|body| body.wear_coefficient > 0.0);
        Groups {
            peclet: if scene.strip.conductivity > 0.0 {
                scene.nominal_velocity * 0.5 * scene.sliding_extent() / scene.strip.diffusivity()
            } else {
                0.0
            },
            fourier: bodies.map(|body| body.diffusivity() * scene.nominal_duration / (body.height * body.height)),
            biot: bodies.map(|body| {
                if body.conductivity > 0.0 { body.convection * body.height / body.conductivity } else { 0.0 }
            }),
            dundurs: if soft_punch + soft_strip > 0.0 {
                (soft_strip - soft_punch) / (soft_punch + soft_strip)
            } else {
                0.0
            },
            strip_compliance: if approach > 0.0 { compliances[1] * pressure / approach } else { 0.0 },
            distortion_over_approach: over(expansion),
            wear_over_approach: over(depths[0] + depths[1]),
            strip_wear: if depths[0] + depths[1] > 0.0 { depths[1] / (depths[0] + depths[1]) } else { 0.0 },
            speed_over_critical: if critical > 0.0 { scene.nominal_velocity / critical } else { 0.0 },
            lever: if rotates { scene.friction_coefficient * scene.pivot_height / (0.5 * scene.width) } else { 0.0 },
            exponent: bodies
                .iter()
                .zip(wears)
                .filter(|(_, wears)| *wears)
                .map(|(body, _)| (law(body).logarithmic_slope(pressure) - 1.0).abs())
                .fold(0.0, f64::max),
            fade: [
                change(&scene.friction_fade),
                bodies
                    .iter()
                    .zip(wears)
                    .map(|(body, wears)| if wears { change(&body.wear_fade) } else { 0.0 })
                    .fold(0.0, f64::max),
            ],
        }
    }

    pub(crate) fn named(&self) -> [(&'static str, f64); 15] {
        [
            ("Peclet number of the strip", self.peclet),
            ("Fourier number of the punch", self.fourier[0]),
            ("Fourier number of the strip", self.fourier[1]),
            ("Biot number of the punch", self.biot[0]),
            ("Biot number of the strip", self.biot[1]),
            ("Dundurs parameter", self.dundurs),
            ("compliance of the strip over that of both", self.strip_compliance),
            ("thermal distortion over elastic approach", self.distortion_over_approach),
            ("wear over elastic approach", self.wear_over_approach),
            ("wear of the strip over that of both", self.strip_wear),
            ("speed over critical speed", self.speed_over_critical),
            ("lever of the friction force over half-width", self.lever),
            ("pressure exponent less 1", self.exponent),
            ("change of friction by fade", self.fade[0]),
            ("change of wear by fade", self.fade[1]),
        ]
    }
}
