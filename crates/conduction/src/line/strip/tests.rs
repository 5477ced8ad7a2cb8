mod balance;
mod exact;
mod thresholds;
mod velocities;

use super::{Expansion, SlidingPath, StripHeat, StripProperties};
use crate::line::{Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use crate::slab::Slab;
use elasticity::{self, Cells, Material};
use scene::FarBoundary;

fn unit(height: f64, base: FarBoundary, path: SlidingPath) -> StripProperties {
    StripProperties::bare(Slab::bare(height, [1.0, 1.0], base), path)
}

pub(crate) fn steel(height: f64, base: FarBoundary, path: SlidingPath, convection: f64) -> StripProperties {
    let bare = Slab::bare(height, [55.0, 7800.0 * 460.0], base);
    StripProperties::bare(Slab { surface_transfer: convection, ..bare }, path)
}

fn cast_iron(height: f64, base: FarBoundary, path: SlidingPath) -> StripProperties {
    StripProperties::bare(Slab::bare(height, [54.0, 7200.0 * 460.0], base), path)
}

fn expanding(nu: f64, base: elasticity::Base) -> Option<Expansion> {
    let material = Material::new(200e9, nu).unwrap();
    Some(Expansion { material, coefficient: 1.1e-5, base })
}

/// Expanding steel, 20 mm high, with air above and below.
pub(crate) fn cooled_steel(path: SlidingPath) -> StripProperties {
    let expansion = expanding(0.3, elasticity::Base::Bonded);
    StripProperties { expansion, ..steel(0.02, FarBoundary::Convecting(300.0), path, 500.0) }
}

/// Mean temperature over the contact.
fn mean(cells: &Cells, temperature: &[f64]) -> f64 {
    cells.integral(temperature) / (2.0 * cells.half_width())
}

/// Temperatures at the end of steps of equal length under a constant uniform flux 1 with the given velocity.
fn march(body: &mut StripHeat, state: &mut [f64], step: f64, steps: usize, velocity: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = body.cells();
    let flux = vec![1.0; count];
    let air = Surroundings::default();
    let (mut temperature, mut distortion) = (vec![0.0; count], vec![0.0; count]);
    for index in 0..steps {
        body.prepare(&Step::new(step, [velocity(index as f64 * step), velocity((index + 1) as f64 * step)]));
        if index + 1 == steps {
            body.free_response(state, &air, Stage::End, &flux, &mut temperature, &mut distortion);
            let influence = &body.influence(Stage::End).temperature;
            for i in 0..count {
                temperature[i] += influence.row(i).sum();
            }
        }
        body.step(state, &air, &flux, &flux);
    }
    temperature
}

/// Fluxes that vary from cell to cell and step to step.
fn uneven(cells: &Cells, index: usize) -> Vec<f64> {
    let a = cells.half_width();
    cells.centres().iter().map(|x| 1e4 * (1.0 + 0.5 * (3.0 * x / a + index as f64).sin())).collect()
}

/// A contact that hardly moves in a step is heated as one at rest: what is slower than the nominal duration had entered as if it were
/// steady.
#[test]
fn a_contact_that_creeps_is_heated_as_one_at_rest() {
    let length = 0.0754;
    for path in [
        SlidingPath::Closed(length),
        SlidingPath::Closed(10.0 * length),
        SlidingPath::Stroke { stroke: 0.05, length: 0.0 },
    ] {
        let properties = StripProperties::bare(Slab::bare(0.05, [1.46, 2520.0 * 790.0], FarBoundary::Held), path);
        let cells = Cells::uniform(0.5 * length, 9).unwrap();
        for (duration, tolerance) in [(0.01, 1e-2), (1.0, 1e-1), (1.0, 1e-2), (100.0, 1e-2), (100.0, 1e-3)] {
            let resolution =
                super::Resolution { duration, shortest: 1e-3 * duration, travel: f64::INFINITY, tolerance };
            let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
            let mut influence = |step: f64, velocity: f64| {
                body.prepare(&Step::new(step, [velocity; 2]));
                body.influence(Stage::End).temperature.clone()
            };
            // Over the whole duration the contact moves by a thousandth of a cell.
            let rise = influence(duration, 0.0).amax();
            let velocity = 1e-3 * cells.widths()[0] / duration;
            for step in [1e-2 * duration, duration] {
                let error = (influence(step, velocity) - influence(step, 0.0)).amax() / rise;
                assert!(error < 0.5 * tolerance, "{path:?} {duration} s, {tolerance:e}, {step} s: {error:e}");
            }
        }
    }
}
