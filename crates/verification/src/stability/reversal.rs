//! Reversal of the sliding direction with a jump of the flux, at steps up to 10^4 times the contact's thermal time.
//!
//! A band of half-width l heats a layer under a closed path up to the steady state; then the velocity changes its sign and
//! the flux falls to a half, as pressures on a worn contact do. The mean temperature of the contact ten steps later is
//! compared with the exact one, a plain sum over the modes ([`crate::path_modes`]).
//!
//! The trapezoidal rule (Crank and Nicolson) multiplies a mode of the decay rate lambda by
//! `(1 - lambda h/2)/(1 + lambda h/2)`: modes with `lambda h` far above the number of steps still alternate. The default
//! propagates every mode exactly.
//!
//! Theory: docs/theory.md, section 5.3.

use super::{Grid, Map, Panel, Point, Verdict, axis, curve};
use crate::Fallible;
use crate::path_modes::{PathModes, crank_nicolson, exact};
use conduction::line::strip::{Resolution, SlidingPath, StripHeat, StripProperties};
use conduction::line::{Observed, SingleStep, Stage, Step, Surroundings, ThermalBody};
use conduction::slab::Slab;
use elasticity::Cells;
use exact::reference::{ClosedPath, LayerBase};
use scene::FarBoundary;

pub(crate) const SUMMARY: &str =
    "jump of velocity and flux at reversal by Peclet number and step: Crank-Nicolson, the default";

/// The layer: half-width, conductivity and diffusivity are 1, so that times are in l^2/kd and Pe = V/2.
pub(crate) const PATH: ClosedPath = ClosedPath {
    length: 8.0,
    half_length: 1.0,
    height: 4.0,
    conductivity: 1.0,
    diffusivity: 1.0,
    base: LayerBase::Held,
};
/// Fourier modes and depth modes of the exact sum: the shortest wavelength is a hundredth of the contact.
const MODES: (u32, u32) = (200, 200);
/// Steps after the reversal.
const STEPS: i32 = 10;
/// Flux after the reversal over that before.
const FLUX: f64 = 0.5;
/// Error bound over the steady temperature before.
pub const AGREEMENT: f64 = 1e-3;

/// Heat of the strip for steps of `step`, with a tolerance of a fifth of [`AGREEMENT`].
pub(crate) fn strip(path: &ClosedPath, step: f64, duration: f64) -> Fallible<(Cells, StripHeat)> {
    let cells = Cells::graded(path.half_length, 17)?;
    let properties = StripProperties::bare(
        Slab::bare(path.height, [path.conductivity, path.conductivity / path.diffusivity], FarBoundary::Held),
        SlidingPath::Closed(path.length),
    );
    let resolution = Resolution { duration, shortest: step, travel: f64::INFINITY, tolerance: 0.2 * AGREEMENT };
    let strip = StripHeat::new(&properties, &cells, &resolution)?;
    Ok((cells, strip))
}

/// Mean temperature of the contact after each of `count` steps with the uniform flux `flux`.
pub(crate) fn steps(
    cells: &Cells,
    strip: &mut StripHeat,
    state: &mut [f64],
    (velocity, flux): (f64, f64),
    step: f64,
    count: usize,
) -> Vec<f64> {
    let air = Surroundings::default();
    let flux = vec![flux; cells.count()];
    let (mut base, mut distortion) = (flux.clone(), flux.clone());
    strip.prepare(&Step::new(step, [velocity; 2]));
    (0..count)
        .map(|_| {
            strip.free_response(state, &air, Stage::End, &flux, &mut base, &mut distortion);
            let influence = &strip.influence(Stage::End).temperature;
            let values: Vec<f64> = (0..flux.len())
                .map(|i| base[i] + (0..flux.len()).map(|j| influence[(i, j)] * flux[j]).sum::<f64>())
                .collect();
            strip.step(state, &air, &flux, &flux);
            cells.integral(&values) / (2.0 * cells.half_width())
        })
        .collect()
}

/// Errors over the steady temperature after the ninth and the tenth step: of Crank-Nicolson and of the default.
struct Errors {
    crank_nicolson: [f64; 2],
    default: [f64; 2],
}

fn errors(cells: &Cells, strip: &mut StripHeat, modes: &PathModes, velocity: f64, step: f64) -> Errors {
    let mut state = vec![0.0; strip.states()];
    steps(cells, strip, &mut state, (velocity, 1.0), 1e6, 2);
    let found = steps(cells, strip, &mut state, (-velocity, FLUX), step, STEPS as usize);
    let last = [STEPS - 1, STEPS];
    let known = last.map(|count| modes.after(true, FLUX, step, count, exact));
    let other = last.map(|count| modes.after(true, FLUX, step, count, crank_nicolson));
    let steady = modes.steady();
    Errors {
        crank_nicolson: [0, 1].map(|i| (other[i] - known[i]) / steady),
        default: [0, 1].map(|i| (found[last[i] as usize - 1] - known[i]) / steady),
    }
}

fn verdict([before, last]: [f64; 2]) -> Verdict {
    if before.abs().max(last.abs()) <= AGREEMENT {
        Verdict::Right
    } else if before * last < 0.0 {
        Verdict::Rings
    } else {
        Verdict::Inexact
    }
}

/// Computes the map.
pub fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let (peclets, step_sizes) = (grid.spread(0.01, 1e3, 11), grid.spread(1e-3, 1e4, 15));
    let modes: Vec<PathModes> = (peclets.iter()).map(|pe| PathModes::new(&PATH, -2.0 * pe, MODES.0, MODES.1)).collect();
    let mut points = [Vec::new(), Vec::new()];
    for (index, &step) in step_sizes.iter().enumerate() {
        let (cells, mut strip) = strip(&PATH, step, f64::from(STEPS) * step)?;
        for (&peclet, modes) in peclets.iter().zip(&modes) {
            let found = errors(&cells, &mut strip, modes, 2.0 * peclet, step);
            for (points, errors) in points.iter_mut().zip([found.crank_nicolson, found.default]) {
                let error = errors[0].abs().max(errors[1].abs());
                points.push(Point { x: peclet, y: step, verdict: verdict(errors), error });
            }
        }
        progress((index + 1) as f64 / step_sizes.len() as f64);
    }
    Ok(assemble(points, trace()?))
}

/// Temperatures over the steady one by the number of steps of a hundred thermal times at Pe = 10: exact, Crank-Nicolson, default.
fn trace() -> Fallible<[Vec<(f64, f64)>; 3]> {
    let (velocity, step, count) = (20.0, 100.0, 20);
    let (cells, mut strip) = strip(&PATH, step, f64::from(count) * step)?;
    let modes = PathModes::new(&PATH, -velocity, MODES.0, MODES.1);
    let mut state = vec![0.0; strip.states()];
    let before = steps(&cells, &mut strip, &mut state, (velocity, 1.0), 1e6, 2);
    let found = steps(&cells, &mut strip, &mut state, (-velocity, FLUX), step, count as usize);
    let steady = modes.steady();
    let by = |factor: fn(_) -> _| -> Vec<(f64, f64)> {
        let after = (1..=count).map(|n| (f64::from(n), modes.after(true, FLUX, step, n, factor) / steady));
        std::iter::once((0.0, 1.0)).chain(after).collect()
    };
    let stepped = found.iter().enumerate().map(|(n, value)| (n as f64 + 1.0, value / steady));
    let default = std::iter::once((0.0, before[1] / steady)).chain(stepped).collect();
    Ok([by(exact), by(crank_nicolson), default])
}

fn assemble([other, default]: [Vec<Point>; 2], [known, ringing, followed]: [Vec<(f64, f64)>; 3]) -> Map {
    let step = || axis("step over the thermal time, kd h/l²", true, (7e-4, 2e4));
    let peclet = || axis("Peclet number V l/(2 kd)", true, (7e-3, 1.4e3));
    let titles = ["Crank-Nicolson", "default"];
    let judged: Vec<Panel> = (titles.into_iter().zip([other, default]))
        .map(|(title, points)| Panel { title: title.to_owned(), x: peclet(), y: step(), points, curves: Vec::new() })
        .collect();
    let by_step = |panel: &Panel| -> Vec<(f64, f64)> {
        let middle = panel.points.iter().map(|point| point.x).filter(|x| (1.0..40.0).contains(x)).fold(0.0, f64::max);
        panel.points.iter().filter(|p| p.x == middle).map(|p| (p.y, p.error.max(1e-9))).collect()
    };
    let amplitude = ringing[1..].iter().zip(&known[1..]).map(|(a, b)| (a.1 - b.1).abs()).fold(0.0, f64::max);
    let findings = vec![
        format!(
            "Crank-Nicolson rings in {} of {} runs and is right in {}. At steps of 100 thermal times it swings by {amplitude:.2} \
             of the steady temperature for {} steps.",
            judged[0].count(Verdict::Rings),
            judged[0].points.len(),
            judged[0].count(Verdict::Right),
            ringing.len() - 1
        ),
        format!(
            "The default is right in {} of {} runs, at steps from 1e-3 to 1e4 thermal times. Its largest error is {:.1e}.",
            judged[1].count(Verdict::Right),
            judged[1].points.len(),
            judged[1].largest_error()
        ),
    ];
    let errors = Panel {
        title: "error by the step, Pe between 1 and 40".to_owned(),
        x: step(),
        y: axis("error over the steady temperature", true, (1e-8, 1.0)),
        points: Vec::new(),
        curves: vec![
            curve("bound of the verdicts", vec![(7e-4, AGREEMENT), (3e5, AGREEMENT)], true),
            curve("Crank-Nicolson", by_step(&judged[0]), false),
            curve("default", by_step(&judged[1]), false),
        ],
    };
    let last = known.len() as f64;
    let traces = Panel {
        title: "steps of 100 thermal times, Pe = 10".to_owned(),
        x: axis("steps after the reversal", false, (0.0, last)),
        y: axis("mean contact temperature over the steady one", false, (0.0, 1.1)),
        points: Vec::new(),
        curves: vec![
            curve("exact", known, true),
            curve("Crank-Nicolson", ringing, false),
            curve("default", followed, false),
        ],
    };
    Map {
        title: "Jumps at reversal",
        problem: "A band of half-width l on a layer of 4 l with a held base, closed path of 8 l: steady, then the velocity changes \
             its sign and the flux falls to a half; mean contact temperature ten steps later, against a plain sum of the \
             exact modes."
                .to_owned(),
        findings,
        panels: judged.into_iter().chain([errors, traces]).collect(),
        columns: 2,
    }
}
