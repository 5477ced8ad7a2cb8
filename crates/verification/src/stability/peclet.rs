//! Peclet number against step size, up to 10^6 and to Fourier modes that rotate in phase without decay.
//!
//! A band of half-width l heats a layer under a closed path from rest. In the punch's frame every Fourier mode q decays at
//! `kd (beta^2 + q^2)` and rotates in phase at `q v`. At a high speed a mode may rotate many times in a step in which it
//! hardly decays: it still needs a state. The exact temperature is the plain sum over the modes
//! ([`crate::path_modes`]); implicit Euler on the same modes damps rotation as if it were decay, and
//! Crank-Nicolson does not damp fast decays.
//!
//! Theory: docs/theory.md, section 4.5.

use super::reversal::{AGREEMENT, PATH, steps, strip};
use super::{Grid, Map, Panel, Point, Verdict, axis, curve};
use crate::Fallible;
use crate::path_modes::{PathModes, crank_nicolson, exact, implicit_euler};
use conduction::line::Observed;
use exact::reference::{ClosedPath, LayerBase};

pub(crate) const SUMMARY: &str =
    "Peclet number 0 to 1e6 by step: implicit Euler, Crank-Nicolson and the default, and a disc that turns";

/// Fourier modes and depth modes of the exact sum.
const MODES: (u32, u32) = (200, 200);
const STEPS: i32 = 10;
/// Position of Pe = 0 in the map.
const AT_PECLET_0: f64 = 1e-3;

/// A brake disc of 11 mm to its middle plane, at 10 m/s with steps of 0.1 s: 1.35 revolutions per step.
pub const DISC: ClosedPath = ClosedPath {
    length: 0.74,
    half_length: 0.0475,
    height: 0.011,
    conductivity: 54.0,
    diffusivity: 54.0 / (7200.0 * 460.0),
    base: LayerBase::Held,
};

/// Errors of implicit Euler, Crank-Nicolson and the default after each of `count` steps of `step` from rest at `velocity`,
/// relative to the temperature at that time.
pub fn errors(path: &ClosedPath, velocity: f64, step: f64, count: i32) -> Fallible<[Vec<f64>; 3]> {
    let (cells, mut strip) = strip(path, step, f64::from(count) * step)?;
    let modes = PathModes::new(path, velocity, MODES.0, MODES.1);
    let mut state = vec![0.0; strip.states()];
    let found = steps(&cells, &mut strip, &mut state, (velocity, 1.0), step, count as usize);
    Ok(compare(&modes, &found, step))
}

fn compare(modes: &PathModes, found: &[f64], step: f64) -> [Vec<f64>; 3] {
    let mut errors = [(); 3].map(|()| Vec::new());
    for (index, value) in found.iter().enumerate() {
        let count = index as i32 + 1;
        let known = modes.after(false, 1.0, step, count, exact);
        let others = [implicit_euler as fn(_) -> _, crank_nicolson];
        let others = others.map(|factor| modes.after(false, 1.0, step, count, factor));
        for (errors, value) in errors.iter_mut().zip([others[0], others[1], *value]) {
            errors.push((value / known - 1.0).abs());
        }
    }
    errors
}

/// Computes the map.
pub fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let mut peclets = grid.spread(1e-2, 1e6, 13);
    peclets.insert(0, 0.0);
    let step_sizes = grid.spread(1e-2, 1e3, 11);
    let modes: Vec<PathModes> = (peclets.iter()).map(|pe| PathModes::new(&PATH, 2.0 * pe, MODES.0, MODES.1)).collect();
    let mut points = [(); 3].map(|()| Vec::new());
    for (index, &step) in step_sizes.iter().enumerate() {
        let (cells, mut strip) = strip(&PATH, step, f64::from(STEPS) * step)?;
        for (&peclet, modes) in peclets.iter().zip(&modes) {
            let mut state = vec![0.0; strip.states()];
            let found = steps(&cells, &mut strip, &mut state, (2.0 * peclet, 1.0), step, STEPS as usize);
            // Only the last step is judged.
            let known = modes.after(false, 1.0, step, STEPS, exact);
            let others = [implicit_euler as fn(_) -> _, crank_nicolson];
            let [first, second] = others.map(|factor| modes.after(false, 1.0, step, STEPS, factor));
            for (points, value) in points.iter_mut().zip([first, second, found[STEPS as usize - 1]]) {
                let error = (value / known - 1.0).abs();
                let verdict = if error <= AGREEMENT { Verdict::Right } else { Verdict::Inexact };
                points.push(Point { x: peclet.max(AT_PECLET_0), y: step, verdict, error });
            }
        }
        progress((index + 1) as f64 / step_sizes.len() as f64);
    }
    let count = if grid == Grid::Coarse { 10 } else { 60 };
    Ok(assemble(points, errors(&DISC, 10.0, 0.1, count)?))
}

fn assemble(points: [Vec<Point>; 3], disc: [Vec<f64>; 3]) -> Map {
    let titles = ["implicit Euler", "Crank-Nicolson", "default"];
    let judged: Vec<Panel> = (titles.into_iter().zip(points))
        .map(|(title, points)| {
            // The longest Fourier mode rotates by one radian per step where q v h = 1: 2 Pe h 2 pi/8 = 1.
            let turning = |peclet: f64| (peclet, PATH.length / (2.0 * std::f64::consts::PI * 2.0 * peclet));
            let ends = [
                turning(PATH.length / (4.0 * std::f64::consts::PI * 2e3)),
                turning(PATH.length / (4.0 * std::f64::consts::PI * 7e-3)),
            ];
            Panel {
                title: title.to_owned(),
                x: axis("Peclet number V l/(2 kd); left: 0", true, (7e-4, 2e6)),
                y: axis("step over the thermal time, kd h/l²", true, (7e-3, 2e3)),
                points,
                curves: vec![curve("longest wave turns 1 rad a step", ends.to_vec(), true)],
            }
        })
        .collect();
    let largest = disc.each_ref().map(|errors| errors.iter().copied().fold(0.0, f64::max));
    let right = |index: usize| judged[index].count(Verdict::Right);
    let findings = vec![
        format!(
            "The default is right in {} of {} runs at Peclet numbers from 0 to 1e6, largest error {:.1e}. Implicit Euler is right \
             in {}, Crank-Nicolson in {}.",
            right(2),
            judged[2].points.len(),
            judged[2].largest_error(),
            right(0),
            right(1)
        ),
        format!(
            "A disc at 10 m/s turns 1.35 times in a step of 0.1 s. Its longest wave turns by 8.5 rad and decays by a factor of \
             0.9999, besides what leaves through the depth. Over {} steps the largest error is {:.1e} by default, {:.1e} with \
             implicit Euler and {:.1e} with Crank-Nicolson.",
            disc[2].len(),
            largest[2],
            largest[0],
            largest[1]
        ),
    ];
    let count = disc[0].len() as f64;
    let curves = titles.into_iter().zip(disc).map(|(name, errors)| {
        let points = errors.iter().enumerate().map(|(n, error)| (n as f64 + 1.0, error.max(1e-9))).collect();
        curve(name, points, false)
    });
    let bound = curve("bound of the verdicts", vec![(0.0, AGREEMENT), (count + 1.0, AGREEMENT)], true);
    let trace = Panel {
        title: "brake disc at 10 m/s, step 0.1 s".to_owned(),
        x: axis("steps from rest", false, (0.0, count + 1.0)),
        y: axis("error over the temperature", true, (1e-7, 1.0)),
        points: Vec::new(),
        curves: std::iter::once(bound).chain(curves).collect(),
    };
    Map {
        title: "Peclet number and step",
        problem: "A band of half-width l on a layer of 4 l with a held base, closed path of 8 l, heated from rest: mean contact \
             temperature after ten steps, against a plain sum of the exact modes."
                .to_owned(),
        findings,
        panels: judged.into_iter().chain([trace]).collect(),
        columns: 2,
    }
}
