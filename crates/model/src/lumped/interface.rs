//! Laws of the interface: heat partition, and consistency of friction and temperature.
//!
//! Theory: docs/theory.md, sections 2.4, 6.8.

use contact::friction::FrictionLaw;
use numerics::scalar::Scalar;

/// Response of a body at the contact: `T = level + gain q`; no `gain` for an insulator.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Side<S> {
    /// Temperature without contact flux, K.
    pub level: S,
    /// Temperature per flux into the body, K m2/W.
    pub gain: Option<f64>,
}

/// Heat fluxes into both bodies and their surface temperatures.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct InterfaceFluxes<S> {
    /// Flux into the punch, W/m2.
    pub punch: S,
    /// Flux into the strip, W/m2.
    pub strip: S,
    /// Surface temperature of the punch, K.
    pub punch_temperature: S,
    /// Surface temperature of the strip, K.
    pub strip_temperature: S,
}

/// Solves `q1 + q2 = q`, `T1 - T2 = (q2 - q1)/(2 h_c)` for the friction heat `q` (W/m2) and the contact conductance `conductance`
/// (W/(m2 K)), with both temperatures as level + gain q_i. An insulator receives no heat; its surface temperature follows from
/// the same second law, and without conductance is that of the other surface.
#[inline]
pub(crate) fn partition<S: Scalar>(punch: Side<S>, strip: Side<S>, q: S, conductance: f64) -> InterfaceFluxes<S> {
    let none = S::from(0.0);
    let jump = || if conductance > 0.0 { q * (0.5 / conductance) } else { none };
    let (into_punch, into_strip) = match (punch.gain, strip.gain) {
        (Some(gain_punch), Some(gain_strip)) if conductance > 0.0 => {
            let resistance = 1.0 / conductance;
            let into_punch = (strip.level - punch.level + q * (gain_strip + 0.5 * resistance))
                * (1.0 / (gain_punch + gain_strip + resistance));
            (into_punch, q - into_punch)
        }
        (Some(_), Some(_)) => (q * 0.5, q - q * 0.5),
        (Some(_), None) => (q, none),
        (None, Some(_)) => (none, q),
        (None, None) => (none, none),
    };
    let heated = |side: Side<S>, into: S| side.gain.map(|gain| side.level + into * gain);
    let (punch_temperature, strip_temperature) = match (heated(punch, into_punch), heated(strip, into_strip)) {
        (Some(punch), Some(strip)) => (punch, strip),
        (Some(punch), None) => (punch, punch + jump()),
        (None, Some(strip)) => (strip + jump(), strip),
        (None, None) => (punch.level, strip.level),
    };
    InterfaceFluxes { punch: into_punch, strip: into_strip, punch_temperature, strip_temperature }
}

/// Heat partition of separated surfaces: no heat passes. The surface temperature of an insulator is that of the other surface.
#[inline]
pub(crate) fn separated<S: Scalar>(punch: Side<S>, strip: Side<S>) -> InterfaceFluxes<S> {
    let (punch_temperature, strip_temperature) = match (punch.gain, strip.gain) {
        (Some(_), None) => (punch.level, punch.level),
        (None, Some(_)) => (strip.level, strip.level),
        _ => (punch.level, strip.level),
    };
    InterfaceFluxes { punch: S::from(0.0), strip: S::from(0.0), punch_temperature, strip_temperature }
}

/// Contact temperature (K, absolute) that satisfies `T = level + gain mu(T)`, with `level` in K, absolute, and `gain` >= 0 the
/// rise per unit of the kinetic friction coefficient at temperature: the smallest solution, found segment by segment of the fade
/// table, so the search always ends. Where a rising table permits several solutions the smallest is the one that a heating
/// contact reaches first.
#[inline]
pub(crate) fn agree<S: Scalar>(friction: &FrictionLaw, level: S, gain: S) -> S {
    let fade = &friction.fade;
    if fade.flat || gain.value() == 0.0 {
        return level + gain * (friction.coefficient * fade.factor[0]);
    }
    let first = fade.temperature.iter().position(|node| level.value() < *node).unwrap_or(8);
    for segment in first..8 {
        // mu = a + b T on the segment that ends at temperature[segment].
        let (a, b) = match segment {
            0 => (fade.factor[0], 0.0),
            _ => {
                let (left, right) = (fade.temperature[segment - 1], fade.temperature[segment]);
                let slope = (fade.factor[segment] - fade.factor[segment - 1]) / (right - left);
                (fade.factor[segment - 1] - slope * left, slope)
            }
        };
        let (a, b) = (a * friction.coefficient, b * friction.coefficient);
        let denominator = S::from(1.0) - gain * b;
        if denominator.value() > 0.0 {
            let temperature = (level + gain * a) / denominator;
            if temperature.value() <= fade.temperature[segment] {
                return temperature;
            }
        }
    }
    // Beyond the table the factor is constant; a NaN level ends here as well.
    level + gain * (friction.coefficient * fade.factor[7])
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::variables::STARTS;
    use scene::{FadeTable, Scene};

    #[test]
    fn split_by_effusivity_and_its_limits() {
        let side = |level, gain| Side { level, gain: Some(gain) };
        let perfect = partition(side(0.0, 2.0), side(0.0, 1.0), 30.0, 1e15);
        assert!((perfect.punch - 10.0).abs() < 1e-9 && (perfect.strip - 20.0).abs() < 1e-9);
        assert!((perfect.punch_temperature - perfect.strip_temperature).abs() < 1e-9);
        let none = partition(side(5.0, 2.0), side(0.0, 1.0), 30.0, 0.0);
        assert_eq!((none.punch, none.strip), (15.0, 15.0));
        let finite = partition(side(5.0, 2.0), side(1.0, 1.0), 30.0, 0.4);
        let jump = finite.punch_temperature - finite.strip_temperature;
        assert!((jump - (finite.strip - finite.punch) / 0.8).abs() < 1e-12);
        let insulated = partition(Side { level: 7.0, gain: None }, side(1.0, 1.0), 30.0, 10.0);
        assert_eq!((insulated.punch, insulated.strip_temperature, insulated.punch_temperature), (0.0, 31.0, 32.5));
    }

    #[test]
    fn friction_and_temperature_agree() {
        let mut law = FrictionLaw::new(&Scene::new(&STARTS, None).unwrap());
        law.coefficient = 0.4;
        law.fade = FadeTable::new(
            [300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0],
            [1.0, 1.1, 0.9, 0.5, 0.4, 0.4, 0.3, 0.2],
        );
        for level in [250.0, 320.0, 480.0, 950.0, 1500.0] {
            for gain in [0.0, 10.0, 300.0, 2000.0, 1e5] {
                let temperature = agree(&law, level, gain);
                let residual = level + gain * law.kinetic_coefficient(temperature) - temperature;
                assert!(residual.abs() < 1e-9 * temperature, "{level} {gain}: {temperature} {residual}");
            }
        }
        // A steeply rising table: the smallest of several solutions, in finitely many steps.
        law.fade = FadeTable::new(law.fade.temperature, [0.1, 0.1, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
        let low = agree(&law, 300.0, 500.0);
        assert!((low - 320.0).abs() < 1e-9, "{low}");
        let high = agree(&law, 395.0, 500.0);
        assert!((high - 795.0).abs() < 1e-9, "{high}");
    }
}
