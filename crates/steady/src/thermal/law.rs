//! Dependence of the steady pressures on heat: the difference to those without heat as a function of the cycle time.
//!
//! The wear of a cycle follows the mean pressure, and so does the mean heat: for `a = b = 1` a run-in contact has the same sum of
//! mean pressures p+ + p- and the same mean flux with heat as without, and the shape compensates the mean distortion. Only the
//! part of the heat that differs between the two directions changes the pressure. The flux `mu v (p+ - p-)/2` changes its sign
//! with every reversal, and a Fourier mode of it, `q cos(m x) exp(i w t)`, displaces the surface of a half-plane by
//!
//! ```text
//! u = 2 alpha (1 + nu) q/(K L (L + m)),   L^2 = m^2 + i w/kd
//!   = 2 alpha (1 + nu) q/(rho c) [1/(i w) - m kd^(1/2)/(i w)^(3/2) + ...]        w >> kd m^2
//! ```
//!
//! With the cycle time P over the thermal time `a^2/kd` of the contact, r << 1:
//!
//! - the flux heats the surface by `q/(K L)`: the temperature amplitude scales with `r^(1/2)`;
//! - the leading term of u is the heat of a half-stroke, a saw tooth in time: pressures within a half-stroke change by r;
//! - the mean of a saw tooth over the half-stroke is zero. The half-strokes' mean pressures, the p+ and p- of the run-in contact,
//!   are first affected by the second term, which has a different phase: for a wave long against `(kd P)^(1/2)` by `r^(3/2)`;
//! - the flux jumps at the edges, so that its Fourier coefficients decay like 1/m only; short waves behave as in a long cycle,
//!   `u ~ q/m^2` and `p ~ m u`, and close to the edges, over a length `a r^(1/2)`, the pressure changes by `r^(1/2)`: the root
//!   mean square over all of the contact scales with `r^(3/4)`. Inside, the edges have an influence as well, so that the measured
//!   power lies between 1 and 3/2.
//!
//! Besides, a strip in reciprocating sliding carries its warm track under the punch: this changes pressures within a half-stroke
//! in proportion to the stroke over the width, however short the cycle, and does not affect their means. For r >> 1 every
//! half-stroke reaches a steady state of its own, and the difference is a constant: that of a contact with the steady thermal
//! compliance `mu v E0` added to its compliance.
//!
//! Theory: docs/theory.md, section 9.4.

use super::bodies::{heat_leaves, with_steady_bodies};
use super::cycle;
use super::partition::{ActivePartition, steady_bodies};
use crate::states::{Sliding, SteadyState, depth_rate, steady_state};
use crate::{CycleProblem, SteadyError};
use conduction::line::Stage;
use elasticity::{Cells, Compliance};
use model::instability::CriticalSpeed;
use model::line::cycle::MapResolution;
use numerics::maximum::{largest, maximum};
use scene::{Body, Scene};

/// Factor of the wear, so small that the wear of a half-stroke is negligible against its distortion.
const WEAR_FACTOR: f64 = 1e-3;

/// Fraction of the half-width that counts as inside.
const INSIDE: f64 = 0.7;

/// Time steps of the half-strokes: finer than elsewhere, since the means are small differences of a saw tooth.
const RESOLUTION: MapResolution = MapResolution { levels: 5, parts: 4 };

/// Differences of the half-strokes' mean pressures, with heat less without: root mean squares over the mean pressure.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Differences {
    /// Root mean square within 0.7 of the half-width.
    pub inside: f64,
    /// Root mean square over all of the contact.
    pub everywhere: f64,
}

/// Point of the law.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LawPoint {
    /// Duration of a cycle over the thermal time `a^2/kd` of the contact, the longer one of the two bodies.
    pub ratio: f64,
    /// Difference of the half-strokes' mean pressures, see [`Differences::inside`].
    pub inside: f64,
    /// Difference of the half-strokes' mean pressures, see [`Differences::everywhere`].
    pub everywhere: f64,
    /// Difference inside, for the pressures at the ends of the half-strokes.
    pub ends: f64,
    /// Temperature range of the hotter surface in a cycle, root mean square over the contact, over the mean rise.
    pub swing: f64,
}

/// Thermal time of the contact, s.
fn thermal_time(scene: &Scene) -> f64 {
    let half = 0.5 * scene.width;
    let time = |body: &Body| {
        if body.conductivity > 0.0 { half * half * body.capacity() / body.conductivity } else { 0.0 }
    };
    time(&scene.punch).max(time(&scene.strip))
}

/// The scene at this ratio: by its heat capacities, so that friction, heat, stroke and steady distortion are unchanged.
fn at(scene: &Scene, ratio: f64) -> Scene {
    let mut scene = scene.clone();
    let cycle = 2.0 * scene.nominal_stroke / scene.nominal_velocity.abs();
    let factor = cycle / thermal_time(&scene) / ratio;
    for body in [&mut scene.punch, &mut scene.strip] {
        body.density *= factor;
        body.wear_coefficient *= WEAR_FACTOR;
    }
    scene.nominal_duration = cycle;
    // Tolerance of the reduced bodies, relative to the total temperature, of which short cycles change only a small part.
    scene.tolerance = 2e-5;
    scene
}

/// Computes the law at `ratio` for a scene in reciprocating sliding.
pub fn law(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2], ratio: f64) -> Result<LawPoint, SteadyError> {
    let scene = at(scene, ratio);
    let cold = cold_state(&scene, cells, compliances)?;
    let speed = scene.nominal_velocity.abs();
    heat_leaves(&scene, speed)?;
    let scene = with_steady_bodies(&scene, speed);
    let sliding = [scene.nominal_stroke; 2];
    let hot = cycle::solve(&scene, cells, &cold, sliding, [speed; 2], RESOLUTION)?;
    let mean = scene.nominal_pressure();
    let mut worst = [0.0_f64; 3];
    for ((stroke, heat), without) in hot.state.strokes.iter().zip(&hot.heat.strokes).zip(&cold.strokes) {
        let found = [
            root_mean_square(cells, INSIDE, |i| stroke.pressure[i] - without.pressure[i]),
            root_mean_square(cells, 1.0, |i| stroke.pressure[i] - without.pressure[i]),
            root_mean_square(cells, INSIDE, |i| heat.pressure_at[1][i] - without.pressure[i]),
        ];
        worst.iter_mut().zip(found).for_each(|(worst, value)| *worst = maximum(*worst, value / mean));
    }
    let rise = hot.heat.contact_temperature[1] - scene.ambient_temperature;
    let [low, high] = &hot.heat.range;
    let swing = largest((0..2).map(|side| root_mean_square(cells, 1.0, |i| high[side][i] - low[side][i])));
    let [inside, everywhere, ends] = worst;
    Ok(LawPoint { ratio, inside, everywhere, ends, swing: swing / rise })
}

/// Root mean square over the cells whose centres lie within `part` of the half-width.
fn root_mean_square(cells: &Cells, part: f64, values: impl Fn(usize) -> f64) -> f64 {
    let inside = |i: &usize| cells.centres()[*i].abs() <= part * cells.half_width();
    let (mut sum, mut width) = (0.0, 0.0);
    for i in (0..cells.count()).filter(inside) {
        sum += cells.widths()[i] * values(i) * values(i);
        width += cells.widths()[i];
    }
    (sum / width).sqrt()
}

fn cold_state(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<SteadyState, SteadyError> {
    match Sliding::nominal(scene) {
        sliding @ Sliding::Reciprocating { .. } => steady_state(scene, cells, compliances, &sliding),
        Sliding::Unidirectional { .. } => {
            Err(SteadyError::Heat("the law is one of reciprocating sliding: nominal.stroke = 0 m".into()))
        }
    }
}

/// Difference of the half-strokes' mean pressures in the limit of long cycles, over the mean pressure: every half-stroke has the
/// steady distortion of its own heat, that of the strip as at rest.
///
/// # Errors
/// As [`super::hot_state`]; friction and wear that depend on the temperature, or a load shifted by a pivot.
pub fn endless_cycles(scene: &Scene, cells: &Cells, compliances: &[Compliance; 2]) -> Result<Differences, SteadyError> {
    let cold = cold_state(scene, cells, compliances)?;
    let speed = scene.nominal_velocity.abs();
    heat_leaves(scene, speed)?;
    let scene = with_steady_bodies(scene, speed);
    let (mut bodies, _) = steady_bodies(&scene, cells, 0.0)?;
    let influence = bodies.each_mut().map(|body| body.as_mut().map(|body| body.influence(Stage::End)));
    let mut partition = ActivePartition::new(influence, cells.count(), scene.conductance);
    partition.set_active_set(influence, &vec![true; cells.count()]);
    let friction = cold.strokes[0].friction;
    let [mut punch, strip] = [compliances[0].clone(), compliances[1].clone()];
    punch.normal += &partition.distortion * (friction * speed);
    let problem = CycleProblem {
        cells,
        punch: &punch,
        strip: &strip,
        friction: [friction; 2],
        load: scene.nominal_load / (scene.count * scene.depth),
        pivot_height: (scene.constraint == scene::Constraint::TranslateAndRotate).then_some(scene.pivot_height),
        rate: &depth_rate(&scene, &scene.punch, &vec![1.0; cells.count()], speed, scene.friction_coefficient),
        durations: [1.0; 2],
    };
    let hot = problem.solve().map_err(|reason| {
        let critical = CriticalSpeed::new(&scene).modelled(scene.friction_coefficient);
        if critical == 0.0 || speed <= critical {
            return reason;
        }
        SteadyError::Heat(format!(
            "no steady pressures of endless half-strokes: {speed:.4} m/s is above the critical speed of thermoelastic \
             instability, {critical:.4} m/s"
        ))
    })?;
    let mean = problem.load / (2.0 * cells.half_width());
    let both = [(&hot.forward, &cold.strokes[0].pressure), (&hot.backward, &cold.strokes[1].pressure)];
    let worst = |part: f64| {
        let one = |(hot, cold): (&Vec<f64>, &Vec<f64>)| root_mean_square(cells, part, |i| hot[i] - cold[i]);
        largest(both.into_iter().map(one)) / mean
    };
    Ok(Differences { inside: worst(INSIDE), everywhere: worst(1.0) })
}
