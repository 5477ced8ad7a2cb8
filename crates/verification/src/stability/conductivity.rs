//! A body with a millionth of the other's conductivity, and an insulator.
//!
//! For two half-spaces of equal heat capacity in perfect contact the heat partition is that of the effusivities: the
//! fraction `sqrt r/(1 + sqrt r)` of the heat enters the body of the conductivity ratio r, from the first moment on. Its
//! heated layer is `sqrt r` times as deep, so at 10^-6 both bodies have to be resolved on depths that differ by a factor of
//! a thousand. An insulator receives no heat.
//!
//! Theory: docs/theory.md, section 2.4.

use super::conductance::run;
use super::half_spaces::HalfSpaces;
use super::{Grid, Map, Panel, Point, Verdict, axis, curve};
use crate::Fallible;

pub(crate) const SUMMARY: &str =
    "conductivity of one body 0 to 1 times the other's by step: the heat partition against its closed form";

/// Conductance that represents perfect contact.
const CONDUCTANCE: f64 = 1e12;
/// Position of a zero ratio in the map.
const NONE: f64 = 1e-9;

pub(crate) fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let mut ratios = grid.spread(1e-8, 1.0, 9);
    ratios.insert(0, 0.0);
    let step_sizes = grid.spread(1e-3, 10.0, 6);
    let (mut points, mut shares) = (Vec::new(), Vec::new());
    for (index, &ratio) in ratios.iter().enumerate() {
        for &step in &step_sizes {
            let (verdict, error) = run(ratio, CONDUCTANCE, step);
            points.push(Point { x: ratio.max(NONE), y: step, verdict, error });
        }
        shares.push((ratio.max(NONE), HalfSpaces { ratio, conductance: CONDUCTANCE }.stepped(0.1, 10)?.0));
        progress((index + 1) as f64 / ratios.len() as f64);
    }
    Ok(assemble(points, shares))
}

fn assemble(points: Vec<Point>, shares: Vec<(f64, f64)>) -> Map {
    let ratio = || axis("conductivity of the punch over the strip's; left: 0", true, (5e-10, 2.0));
    let part = |ratio: f64| ratio.sqrt() / (1.0 + ratio.sqrt());
    let known: Vec<(f64, f64)> =
        (0..=90).map(|k| 10f64.powf(-9.0 + 0.1 * f64::from(k))).map(|ratio| (ratio, part(ratio))).collect();
    let judged = Panel {
        title: "default: part of the heat in the punch".to_owned(),
        x: ratio(),
        y: axis("communication step (s)", true, (6e-4, 20.0)),
        points,
        curves: Vec::new(),
    };
    let conducting = shares.iter().filter(|point| point.0 > NONE);
    let apart = conducting.map(|&(ratio, share)| (share / part(ratio) - 1.0).abs()).fold(0.0, f64::max);
    let insulator = shares.first().map_or(f64::NAN, |point| point.1);
    let findings = vec![
        format!(
            "The default is right in {} of {} runs, with conductivities whose ratio is 1e-8 to 1 and with an insulator. Its largest \
             error is {:.1e} of the heat.",
            judged.count(Verdict::Right),
            judged.points.len(),
            judged.largest_error()
        ),
        format!(
            "The part of the heat in the poor conductor is √r/(1 + √r) within {apart:.1e} (relative) down to r = 1e-8; an insulator \
             takes {insulator:.1e}."
        ),
    ];
    let split = Panel {
        title: "after ten steps of 0.1 s".to_owned(),
        x: ratio(),
        y: axis("part of the heat in the punch", true, (1e-5, 1.0)),
        points: Vec::new(),
        curves: vec![
            curve("theory", known, true),
            curve("default", shares.into_iter().filter(|point| point.0 > NONE).collect(), false),
        ],
    };
    Map {
        title: "A body of low conductivity",
        problem: "Two half-spaces of equal heat capacity in perfect contact (1e12 W/(m².K)), heated by friction from rest; line \
             level, solver.tolerance = 1e-3, ten communication steps, against the closed form."
                .to_owned(),
        findings,
        panels: vec![judged, split],
        columns: 2,
    }
}
