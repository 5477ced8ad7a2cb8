//! Lateral conduction out of the plane: the fraction of a contact's heat that remains under it, in the direction normal to
//! sliding.
//!
//! A plane source is as deep as the body under it. A contact of the depth 2b on a body that extends beyond its track loses
//! heat to both sides. Conduction in the lateral direction separates from that along and through the body. The temperature
//! under the contact at the time t after an impulse of heat is therefore the plane response times the mean of a diffused
//! uniform source over its own width,
//!
//! ```text
//! Y(tau) = erf(b/sqrt(tau)) - sqrt(tau/pi)/b [1 - exp(-b^2/tau)]
//!        = integral_0^inf (2/pi) sinc^2(x) exp(-x^2 tau/b^2) dx,   tau = kd t
//! ```
//!
//! exact for a layer of any height and boundary conditions, for every Fourier mode along the path and at every velocity.
//! With a sum of decays for the integral, any plane response R(s) becomes
//!
//! ```text
//! R_3(s) = sum_j c_j R(s + kd x_j^2/b^2),      sum_j c_j = 1,
//! ```
//!
//! again a sum of decays. Both limits follow: the plane response where b is large against the diffusion length of the
//! contact's transit time, and that of a rectangle on a half-space for small b and slow sliding, 0.9464 q a/K in the
//! mean of a square at rest.
//!
//! Only local heating, the deviation from the mean along the path, spreads; the mean is that of a track as deep as the
//! contact.
//!
//! Quadrature: two Gauss nodes in x on each of the intervals between 0, 0.1, 0.4, 1.5, 5 and 20, and the rest at
//! 20 sqrt 3. Error of the mean temperature of a square, and of rectangles half and four times as deep as wide, against
//! the integral: 2.4e-3 for Peclet numbers from 0.1 (V a/(2 kd)), 6e-3 from 0.01.
//!
//! Theory: docs/theory.md, section 4.4.

use nalgebra::Complex;
use scene::{Geometry, Scene};

/// Quadrature weights c_j and squared nodes x_j^2.
const DECAYS: [[f64; 2]; 11] = [
    [3.181400519655e-02, 4.462481913670e-04],
    [3.177729307392e-02, 6.217824333646e-03],
    [9.410309649377e-02, 2.656389606457e-02],
    [9.248391648246e-02, 1.129024297537e-01],
    [2.832196660463e-01, 3.736911177980e-01],
    [2.212012531643e-01, 1.519046669058],
    [1.448350301918e-01, 3.374718975817],
    [3.922363992264e-02, 18.72214638403],
    [3.184585996063e-02, 47.37706236889],
    [1.327210723259e-02, 230.6122856360],
    [1.622413223510e-02, 1200.0],
];

/// Lateral conduction to both sides of a contact.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lateral {
    /// b, half of the contact's depth, m.
    half_depth: f64,
    /// kd/b^2, rate of lateral diffusion, 1/s.
    rate: f64,
}

impl Lateral {
    /// Lateral conduction of a contact of the depth `depth`, m, on a body of the diffusivity `diffusivity`, m2/s.
    pub fn new(depth: f64, diffusivity: f64) -> Lateral {
        let half_depth = 0.5 * depth;
        Lateral { half_depth, rate: diffusivity / (half_depth * half_depth) }
    }

    /// Lateral conduction in the strip of a scene: on a line contact at least half as deep as it is wide, on a strip at
    /// least as high as the contact is deep. A flatter strip is taken for a ring as wide as the contact, a more slender
    /// contact for one as deep as the strip; neither spreads (`None`).
    pub fn of(scene: &Scene) -> Option<Lateral> {
        let strip = &scene.strip;
        // Least ratio of depth to width of a contact; a more slender one is the slice of a plane problem.
        let spreads = scene.geometry == Geometry::Line
            && scene.depth >= 0.5 * scene.width
            && strip.height >= scene.depth
            && strip.conductivity > 0.0;
        spreads.then(|| Lateral::new(scene.depth, strip.diffusivity()))
    }

    /// Wave number along the path beyond which lateral spreading has no effect, 1/m.
    pub(crate) fn shortest_wave(&self) -> f64 {
        // Wave number times b beyond which a Fourier mode along the path decays before it spreads laterally.
        12.0 / self.half_depth
    }

    /// Weights c_j, and the frequencies s + kd x_j^2/b^2, 1/s.
    pub(crate) fn frequencies(&self, s: Complex<f64>) -> [(f64, Complex<f64>); 11] {
        DECAYS.map(|[share, square]| (share, s + square * self.rate))
    }
}

/// Weighted mean of `answer` over the frequencies into which spreading turns `s`, 1/s; at `s` itself without lateral conduction.
pub(crate) fn spread(
    lateral: Option<&Lateral>,
    s: Complex<f64>,
    answer: impl Fn(Complex<f64>) -> Complex<f64>,
) -> Complex<f64> {
    let Some(lateral) = lateral else { return answer(s) };
    lateral.frequencies(s).into_iter().map(|(share, s)| answer(s) * share).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moving_source::{MovingSource, Path};
    use crate::slab::Slab;
    use exact::special::complementary_error;
    use scene::FarBoundary;
    use std::f64::consts::PI;

    fn erf(x: f64) -> f64 {
        (1.0 - complementary_error(x.abs())).copysign(x)
    }

    /// Temperature rise on a half-space, in q a/K, at the point (`x`, `y`) of a uniform source 2 x 2b that slides in +x at
    /// the Peclet number `peclet`: the integral over the history of the remaining temperature of every instantaneous source.
    fn local(peclet: f64, b: f64, x: f64, y: f64) -> f64 {
        over_history(|t| {
            let root = 2.0 * t.sqrt();
            let along = x + 2.0 * peclet * t;
            let part = |from: f64, to: f64| 0.5 * (erf(to / root) - erf(from / root));
            part(along - 1.0, along + 1.0) * part(y - b, y + b)
        })
    }

    fn over_history(left: impl Fn(f64) -> f64) -> f64 {
        let (steps, low, high) = (2000, 1e-8_f64.ln(), 1e8_f64.ln());
        let step = (high - low) / f64::from(steps);
        (0..steps)
            .map(|k| {
                let t = (low + step * (f64::from(k) + 0.5)).exp();
                left(t) * (t / PI).sqrt() * step
            })
            .sum()
    }

    /// Mean of [`local`] over the source.
    fn mean(peclet: f64, b: f64) -> f64 {
        let n = 24;
        let places = |half: f64| (0..n).map(move |k| half * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0));
        // Even in y.
        let sum: f64 = places(1.0)
            .flat_map(|x| places(b).take(12).map(move |y| (x, y)))
            .map(|(x, y)| local(peclet, b, x, y))
            .sum();
        2.0 * sum / f64::from(n * n)
    }

    fn spread_source(height: f64, path: Path, b: f64) -> MovingSource {
        let slab = Slab::bare(height, [1.0, 1.0], FarBoundary::Held);
        MovingSource::new(slab, 1.0, path).spreading(Some(Lateral::new(2.0 * b, 1.0)))
    }

    /// Mean temperature along a closed path, which is not part of the local heating, with the same lateral spreading.
    fn mean_along(source: &MovingSource, path: Path) -> f64 {
        let Path::Closed(length) = path else { return 0.0 };
        let spread = spread(Some(&Lateral::new(2.0, 1.0)), Complex::from(0.0), |s| source.slab().impedance(s, 0.0));
        2.0 / length * spread.re
    }

    /// The reference has the published maximum of a square, 2 q a/(K sqrt(pi (1.011 + Pe))) (X. Tian, F. E. Kennedy, Maximum
    /// and average flash temperatures in sliding contacts, J. Tribology 116 (1994) 167-174), and the reduction has the mean
    /// of the reference.
    #[test]
    fn a_square_has_the_published_flash_temperature_at_every_peclet_number() {
        for (peclet, plane) in [(0.1, 2.0618), (1.0, 0.79986), (10.0, 0.24132), (100.0, 0.07524)] {
            let highest = (0..100).map(|k| local(peclet, 1.0, -0.02 * f64::from(k) + 1.0, 0.0)).fold(0.0, f64::max);
            let published = 2.0 / (PI * (1.011 + peclet)).sqrt();
            assert!((highest / published - 1.0).abs() < 0.05, "{peclet}: {highest} {published}");
            let exact = mean(peclet, 1.0);
            // A circumference so long that no heat of the previous revolution is left.
            let round = (peclet <= 10.0).then(|| Path::Closed(2000.0 * f64::max(peclet, 1.0)));
            for path in [Path::Endless].into_iter().chain(round) {
                let source = spread_source(1e3, path, 1.0);
                let found = source.resistance(2.0 * peclet) + mean_along(&source, path);
                assert!((found / exact - 1.0).abs() < 0.01, "{path:?} {peclet}: {found} {exact}");
                assert!(found < 0.985 * plane, "{peclet}: {found} {plane}");
            }
        }
    }

    #[test]
    fn both_limits_are_right() {
        // A band: the diffusion length of the transit time is short against its depth.
        for (peclet, plane) in [(1.0, 0.79986), (10.0, 0.24132)] {
            let found = spread_source(1e3, Path::Endless, 1e3).resistance(2.0 * peclet);
            assert!((found / plane - 1.0).abs() < 5e-3, "{peclet}: {found} {plane}");
        }
        // Fast sliding convects the heat away before it spreads.
        let fast = spread_source(1e3, Path::Endless, 1.0).resistance(2e6);
        assert!((fast * PI.sqrt() * 0.75 * 1e3 - 1.0).abs() < 5e-3, "{fast}");
        // V a/kd = 0.1: a band is 2.727 times as hot, by numerical integration of the history of a moving square and a band.
        let [band, square] = [1e3, 1.0].map(|b| spread_source(1e3, Path::Endless, b).resistance(0.1));
        assert!((band / square / 2.727 - 1.0).abs() < 0.01, "{}", band / square);
        // A square at rest on a half-space: 0.9464 q a/K.
        let path = Path::Closed(2000.0);
        let source = spread_source(1e3, path, 1.0);
        let rest = source.resistance(1e-6) + mean_along(&source, path);
        assert!((rest / 0.9464 - 1.0).abs() < 0.01, "{rest}");
        assert!((DECAYS.iter().map(|[share, _]| share).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
