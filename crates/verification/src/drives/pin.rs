//! A pin in unidirectional sliding.

use super::{DriveProblem, Sample, Truth};
use exact::GalinRelaxation;
use exact::reference::{LayerBase, band_mean};
use scene::STATIONS;
use scene::variables::{STARTS, changed};

const HALF_WIDTH: f64 = 1e-3;
const DEPTH: f64 = 2e-3;
const LOAD: f64 = 100.0;
const VELOCITY: f64 = 0.5;
const FRICTION: f64 = 0.3;
const WEAR: f64 = 4.5e-15;
const YOUNGS_MODULUS: f64 = 200e9;
const POISSONS_RATIO: f64 = 0.3;
const CONDUCTIVITY: f64 = 50.0;
const CAPACITY: f64 = 7800.0 * 460.0;
/// Lower than the depth of the pin: a track as deep as the pin, without lateral conduction.
const HEIGHT: f64 = 1.9e-3;
const CONDUCTANCE: f64 = 1e6;
const DURATION: f64 = 10.0;

/// A flat, rigid, insulating ceramic pin on a track of steel: every quantity in closed form.
pub(super) fn problem() -> Result<DriveProblem, String> {
    let changes = [
        ("depth", DEPTH),
        ("punch.width", 2.0 * HALF_WIDTH),
        ("punch.count", 1.0),
        ("punch.body", 1.0),
        ("punch.conductivity", 0.0),
        ("punch.thermal_expansion", 0.0),
        ("punch.wear_coefficient", WEAR),
        ("punch.convection", 0.0),
        ("strip.body", 3.0),
        ("strip.youngs_modulus", YOUNGS_MODULUS),
        ("strip.poissons_ratio", POISSONS_RATIO),
        ("strip.height", HEIGHT),
        ("strip.path", 1.0),
        ("strip.length", 0.0),
        ("strip.conductivity", CONDUCTIVITY),
        ("strip.density", 7800.0),
        ("strip.specific_heat", 460.0),
        ("strip.thermal_expansion", 0.0),
        ("strip.wear_coefficient", 0.0),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("strip.base_thermal", 1.0),
        ("contact.geometry", 1.0),
        ("contact.mean_radius", 0.0),
        ("contact.faces", 1.0),
        ("contact.shear_coupling", 0.0),
        ("contact.friction_coefficient", FRICTION),
        ("contact.conductance", CONDUCTANCE),
        ("nominal.load", LOAD),
        ("nominal.velocity", VELOCITY),
        ("nominal.duration", DURATION),
        ("nominal.stroke", 0.0),
    ];
    let starts = changed(&STARTS, &changes)?;
    let ambient = starts[const { scene::variables::reference("ambient_temperature") } as usize];
    Ok(DriveProblem {
        name: "unidirectional_pin",
        title: "Unidirectional pin: a flat rigid pin wears on a track of steel",
        data: "2 x 2 mm, 100 N, 0.5 m/s for 10 s, mu 0.3, wear 4.5e-6 mm3/(N m), track 1.9 mm high on a held base, Peclet number 18",
        starts,
        inputs: Box::new(|_| [VELOCITY, LOAD]),
        step: 0.1,
        steps: vec![0.2, 0.1, 0.05, 0.02, 0.01, 0.005],
        samples: vec![0.2, 0.4, 1.0, 2.0, 4.0, 6.0, 8.0, DURATION],
        truth: Truth::Exact {
            how: "exact: Galin's eigenfunctions of the wearing punch; Jaeger's moving band on a layer, by images, for the steady end",
            samples: Box::new(move |times| Ok(exact_samples(times, ambient))),
        },
        reason: "150 polynomials leave 1e-6 of the pressure; at the end 1e-4 of it is still uneven, and no more of the temperature",
        isothermal: true,
    })
}

fn exact_samples(times: &[f64], ambient: f64) -> Vec<Sample> {
    let mean = LOAD / (2.0 * HALF_WIDTH * DEPTH);
    let galin = GalinRelaxation::new(150);
    let modulus = YOUNGS_MODULUS / (1.0 - POISSONS_RATIO * POISSONS_RATIO);
    let peclet = VELOCITY * HALF_WIDTH * CAPACITY / (2.0 * CONDUCTIVITY);
    let flux = FRICTION * mean * VELOCITY;
    let band = band_mean(peclet, Some((HEIGHT / HALF_WIDTH, LayerBase::Held)));
    // The pin's side is hotter by flux/(2 h_c), half of which enters the contact temperature.
    let rise = flux * (HALF_WIDTH / CONDUCTIVITY * band + 0.25 / CONDUCTANCE);
    let last = times.last().copied().unwrap_or(0.0);
    let at = |&time: &f64| {
        let path = WEAR * VELOCITY * time;
        let peak = (0..STATIONS).map(|station| {
            let x = |offset: f64| ((station as f64 + offset) / 16.0 - 1.0).clamp(-1.0, 1.0);
            galin.mean_pressure(path * modulus / HALF_WIDTH, x(-0.5), x(0.5))
        });
        let temperature = if time == last { ambient + rise } else { f64::NAN };
        [path * mean, temperature, FRICTION * LOAD, mean * peak.fold(0.0, f64::max)]
    };
    times.iter().map(at).collect()
}
