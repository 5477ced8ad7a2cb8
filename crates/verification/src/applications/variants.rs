//! Variants of the shipped scenes, as users make them: other dimensions, friction and materials, driven by ramps of velocity and load, reciprocating where the
//! scene reciprocates. `nominal.*` are those shipped, which the drives stay below or exceed. Nothing in the choice of the level was adjusted to them.
//!
//! Left out: the clutch and hot spots, which are far above their critical speed, so that there is no reference to compare with.

use super::Application;
use super::courses::Point;
use crate::planning::scenes::Random;
use scene::value;
use scene::variables::{STARTS, reference};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Scene files; the stock scene has none.
const FILES: [(&str, Option<&str>); 4] = [
    ("stock", None),
    ("disc_brake", Some(include_str!("../../../../examples/disc_brake/scene.toml"))),
    ("pin_on_disk", Some(include_str!("../../../../examples/pin_on_disk/scene.toml"))),
    ("reciprocating_punch", Some(include_str!("../../../../examples/reciprocating_punch/scene.toml"))),
];

/// Parameters that are multiplied by a factor from 0.7 to 1.4.
const CHANGED: [&str; 8] = [
    "punch.width",
    "depth",
    "contact.friction_coefficient",
    "punch.youngs_modulus",
    "punch.conductivity",
    "strip.height",
    "punch.height",
    "punch.wear_coefficient",
];

/// Number of scenes.
const COUNT: u64 = 60;

/// Communication points of a ramp and of a period, and longest drives of reciprocating and of unidirectional sliding, s.
const POINTS: usize = 16;
const PERIOD: usize = 24;
const LONGEST: [f64; 2] = [30.0, 600.0];

/// All of them, in a fixed order.
///
/// # Errors
/// An invalid scene file.
pub fn all() -> Result<Vec<Application>, String> {
    (1..=COUNT).map(application).collect()
}

fn application(seed: u64) -> Result<Application, String> {
    let mut random = Random::new(seed);
    let (name, file) = random.one_of(&FILES);
    let mut starts = match file {
        Some(text) => {
            Box::new(scene_file::parse(text).map_err(|problems| format!("{name}: {problems}"))?.packaged.starts)
        }
        None => Box::new(STARTS),
    };
    for parameter in CHANGED {
        starts[reference(parameter) as usize] *= random.scaled(0.7, 1.4);
    }
    let stroke = value!(starts, "nominal.stroke");
    let longest = LONGEST[usize::from(stroke == 0.0)];
    let time = (value!(starts, "nominal.duration") * random.scaled(0.2, 2.0)).min(longest);
    let speed = value!(starts, "nominal.velocity") * random.scaled(0.4, 1.6);
    let load = value!(starts, "nominal.load") * random.scaled(0.1, 1.5);
    let course = if stroke > 0.0 {
        strokes(&mut random, stroke, speed, load, time)
    } else {
        ramps(&mut random, speed, load, time)
    };
    Ok(Application { name: format!("{name}_{seed}"), starts, course, others: Vec::new() })
}

/// Sinusoidal velocity with `speed` as its mean; the load varies slowly.
fn strokes(random: &mut Random, stroke: f64, speed: f64, load: f64, time: f64) -> Vec<Point> {
    let (rate, swing) = (2.0 * speed / stroke, random.between(0.0, 0.5));
    let count = ((time * rate / TAU * PERIOD as f64) as usize).clamp(2 * PERIOD, 100 * PERIOD);
    let at = |point: usize| {
        let now = time * point as f64 / count as f64;
        [now, FRAC_PI_2 * speed * (rate * now).cos(), load * (1.0 + swing * (0.37 * rate * now).sin())]
    };
    (0..=count).map(at).collect()
}

/// Two to seven ramps to other velocities and loads, each held for a while; at times to rest, and to no load.
fn ramps(random: &mut Random, speed: f64, load: f64, time: f64) -> Vec<Point> {
    let count = 2 + random.between(0.0, 6.0) as usize;
    let begins_loaded = random.chance(0.5);
    let mut from =
        [0.0, speed * random.between(0.0, 1.0), if begins_loaded { load * random.between(0.0, 1.0) } else { 0.0 }];
    let mut course = vec![from];
    for _ in 0..count {
        let length = time / count as f64 * random.between(0.4, 1.6);
        let (rests, opens) = (random.chance(0.2), random.chance(0.25));
        let to = [
            from[0] + length,
            if rests { 0.0 } else { speed * random.between(0.2, 1.0) },
            if opens { 0.0 } else { load * random.between(0.1, 1.0) },
        ];
        let ramp = random.between(0.05, 1.0);
        course.extend((1..=POINTS).map(|point| {
            let part = point as f64 / POINTS as f64;
            let done = (part / ramp).min(1.0);
            [from[0] + length * part, from[1] + (to[1] - from[1]) * done, from[2] + (to[2] - from[2]) * done]
        }));
        from = to;
    }
    course
}
