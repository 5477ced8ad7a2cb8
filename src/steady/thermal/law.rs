//! When heat leaves the steady pressures alone: the difference that it makes, against the length of a cycle.
//!
//! The wear of a cycle follows the mean pressure, and so does the mean heat: for `a = b = 1` a run-in contact has the same
//! mean pressures p+ + p- and the same mean flux with heat as without, and the shape takes up the mean distortion. What
//! heat changes is what it does differently in the two directions. The flux `mu v (p+ - p-)/2` changes its sign with every
//! reversal, and a wave of it, `q cos(m x) exp(i w t)`, displaces the surface of a half-plane by
//!
//! ```text
//! u = 2 alpha (1 + nu) q/(K L (L + m)),   L^2 = m^2 + i w/kd
//!   = 2 alpha (1 + nu) q/(rho c) [1/(i w) - m kd^(1/2)/(i w)^(3/2) + ...]        w >> kd m^2
//! ```
//!
//! With the cycle time P over the thermal time `a^2/kd` of the contact, r << 1:
//!
//! - the flux heats the surface by `q/(K L)`: the temperature swings by `r^(1/2)`;
//! - the leading term of u is the heat of a half-stroke, a saw tooth: pressures within a half-stroke change by r;
//! - a saw tooth's mean over the half-stroke is zero. The half-strokes' mean pressures, the p+ and p- of the run-in contact,
//!   first feel the second term, which is out of step with the first: they change by `r^(3/2)`.
//!
//! Besides, a strip carries its warm track to and fro under the punch: that changes pressures within a half-stroke in
//! proportion to the stroke over the width, however short the cycle, and leaves their means alone. For r >> 1 every
//! half-stroke reaches a steady state of its own, and the difference is a constant: that of a contact whose compliance has the
//! steady distortion `mu v E0` on top.

use super::bodies::{heat_leaves, with_steady_bodies};
use super::cycle;
use crate::coupled::line::heat::bodies::Bodies;
use crate::coupled::line::heat::split::Split;
use crate::elastic::{Cells, Compliance};
use crate::heat::line::Stage;
use crate::scene::{Body, Scene};
use crate::steady::scene::{Sliding, SteadyState, steady_state};
use crate::steady::{CycleProblem, SteadyError};
use crate::wear::line::CellRate;

/// Part of the wear that is left, so that what a half-stroke wears is nothing against what it distorts.
const WEAR: f64 = 1e-5;

/// A point of the law.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LawPoint {
    /// Duration of a cycle over the thermal time `a^2/kd` of the contact, the longer one of the two bodies'.
    pub ratio: f64,
    /// Root mean square difference, with heat less without, of the half-strokes' mean pressures over the mean pressure.
    pub means: f64,
    /// The same of the pressures at the ends of the half-strokes.
    pub ends: f64,
    /// Swing of the contact's mean temperature in a cycle over its mean rise.
    pub swing: f64,
    /// Root mean square range over the cycle of the surfaces' temperatures over the mean rise.
    pub local_swing: f64,
}

/// Thermal time of the contact, s.
pub fn thermal_time(scene: &Scene) -> f64 {
    let half = 0.5 * scene.width;
    let time = |body: &Body| {
        if body.conductivity > 0.0 { half * half * body.capacity() / body.conductivity } else { 0.0 }
    };
    time(&scene.punch).max(time(&scene.strip))
}

/// The scene at this ratio: with other heat capacities, so that friction, heat, stroke and steady distortion stay.
fn at(scene: &Scene, ratio: f64) -> Scene {
    let mut scene = scene.clone();
    let cycle = 2.0 * scene.nominal_stroke / scene.nominal_velocity.abs();
    let factor = cycle / thermal_time(&scene) / ratio;
    for body in [&mut scene.punch, &mut scene.strip] {
        body.density *= factor;
        body.wear_coefficient *= WEAR;
    }
    // Nothing of the memory may be lost that the scene's own duration would not show.
    scene.nominal_duration = cycle;
    scene
}

/// The law at `ratio` for a scene that slides to and fro.
///
/// # Errors
/// As [`super::hot_state`].
pub fn law(
    scene: &Scene,
    cells: &Cells,
    compliances: &[Compliance; 2],
    ratio: f64,
) -> Result<LawPoint, SteadyError> {
    let scene = at(scene, ratio);
    let cold = cold_state(&scene, cells, compliances)?;
    let speed = scene.nominal_velocity.abs();
    heat_leaves(&scene, speed)?;
    let scene = with_steady_bodies(&scene, speed);
    let hot = cycle::solve(&scene, cells, &cold, [scene.nominal_stroke; 2], [speed; 2])?;
    let mean = scene.nominal_load / (scene.count * scene.contact_area());
    let width = 2.0 * cells.half_width();
    let root_mean_square = |values: &dyn Fn(usize) -> f64| {
        let squares: Vec<f64> = (0..cells.count()).map(|i| values(i) * values(i)).collect();
        (cells.integral(&squares) / width).sqrt()
    };
    let (mut means, mut ends) = (0.0_f64, 0.0_f64);
    for ((stroke, heat), without) in hot.state.strokes.iter().zip(&hot.heat.strokes).zip(&cold.strokes) {
        means = means.max(root_mean_square(&|i| stroke.pressure[i] - without.pressure[i]));
        ends = ends.max(root_mean_square(&|i| heat.pressure_at[1][i] - without.pressure[i]));
    }
    let [least, middle, largest] = hot.heat.contact_temperature;
    let rise = middle - scene.ambient_temperature;
    let [low, high] = &hot.heat.range;
    let local = (0..2).map(|side| root_mean_square(&|i| high[side][i] - low[side][i])).fold(0.0, f64::max);
    Ok(LawPoint {
        ratio,
        means: means / mean,
        ends: ends / mean,
        swing: (largest - least) / rise,
        local_swing: local / rise,
    })
}

fn cold_state(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<SteadyState, SteadyError> {
    match Sliding::nominal(scene) {
        sliding @ Sliding::ToAndFro { .. } => steady_state(scene, cells, compliances, &sliding),
        Sliding::OneWay { .. } => Err(SteadyError::Heat("the law is one of to-and-fro sliding: nominal.stroke = 0 m".into())),
    }
}

/// The difference of the half-strokes' mean pressures for endless cycles, over the mean pressure: every half-stroke has the
/// steady distortion of its own heat, the strip's as at rest.
///
/// # Errors
/// As [`super::hot_state`]; friction and wear that follow the temperature, or a load that a pivot shifts.
pub fn endless_cycles(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<f64, SteadyError> {
    let cold = cold_state(scene, cells, compliances)?;
    let speed = scene.nominal_velocity.abs();
    heat_leaves(scene, speed)?;
    let scene = with_steady_bodies(scene, speed);
    let made = Bodies::new(&scene, cells).map_err(SteadyError::Heat)?;
    let mut bodies = made.copies();
    let step = 1e8 * scene.nominal_duration;
    bodies.iter_mut().flatten().for_each(|body| body.prepare(step, [0.0; 2]));
    let gains = bodies.each_ref().map(|body| body.as_ref().map(|body| body.gains(Stage::End)));
    let mut split = Split::new(cells.count(), scene.conductance);
    split.prepare((step, [0.0; 2]), gains, &vec![true; cells.count()]);
    let friction = cold.strokes[0].friction;
    let [mut punch, strip] = [compliances[0].clone(), compliances[1].clone()];
    punch.normal += &split.distortion * (friction * speed);
    let problem = CycleProblem {
        cells,
        punch: &punch,
        strip: &strip,
        friction: [friction; 2],
        load: scene.nominal_load / (scene.count * scene.depth),
        pivot_height: (scene.constraint == crate::scene::Constraint::TranslateAndRotate).then_some(scene.pivot_height),
        rate: &CellRate::uniform(1.0, 1.0, scene.punch.wear_pressure_exponent),
        durations: [1.0; 2],
    };
    let hot = problem.solve()?;
    let width = 2.0 * cells.half_width();
    let mean = problem.load / width;
    let difference = |hot: &[f64], cold: &[f64]| {
        let squares: Vec<f64> = hot.iter().zip(cold).map(|(h, c)| (h - c) * (h - c)).collect();
        (cells.integral(&squares) / width).sqrt() / mean
    };
    Ok(difference(&hot.forward, &cold.strokes[0].pressure).max(difference(&hot.backward, &cold.strokes[1].pressure)))
}
