//! Contact conductance from 0 to 10^12 W/(m2 K) against the step size.
//!
//! Two half-spaces heated by friction, against the closed form ([`super::half_spaces`]). The interface has the time constant
//! `(E/h_c)^2` with `E = e1 e2/(e1 + e2)`: before it each body receives half of the heat, after it the heat partition is
//! that of the effusivities. The result of a step far above that time must not depend on the stiffness of the interface.
//!
//! Theory: docs/theory.md, section 2.4.

use super::half_spaces::HalfSpaces;
use super::{Grid, Map, Panel, Point, Verdict, axis, curve};
use crate::Fallible;

pub(crate) const SUMMARY: &str =
    "contact conductance 0 to 1e12 W/(m².K) by step: the heat partition against its closed form";

/// Conductivity of the punch over that of the strip.
const RATIO: f64 = 0.02;
const STEPS: u32 = 10;
/// Error bound of the heat partition: `solver.tolerance`.
pub(crate) const AGREEMENT: f64 = 1e-3;
/// Position of zero conductance in the map.
const NONE: f64 = 0.1;

/// Verdict, and error of the fraction of the heat in the punch after ten steps of `step` (s).
pub fn run(ratio: f64, conductance: f64, step: f64) -> (Verdict, f64) {
    let pair = HalfSpaces { ratio, conductance };
    match pair.stepped(step, STEPS) {
        Err(_) => (Verdict::Refused, f64::NAN),
        Ok((share, imbalance)) => {
            let error = (share - pair.share(step * f64::from(STEPS))).abs().max(imbalance);
            (if error <= AGREEMENT { Verdict::Right } else { Verdict::Inexact }, error)
        }
    }
}

pub(crate) fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let mut conductances = grid.spread(1.0, 1e12, 9);
    conductances.insert(0, 0.0);
    let step_sizes = grid.spread(1e-4, 10.0, 6);
    let mut points = Vec::new();
    let mut shares = Vec::new();
    for (index, &conductance) in conductances.iter().enumerate() {
        for &step in &step_sizes {
            let (verdict, error) = run(RATIO, conductance, step);
            points.push(Point { x: conductance.max(NONE), y: step, verdict, error });
        }
        let pair = HalfSpaces { ratio: RATIO, conductance };
        shares.push((conductance.max(NONE), pair.stepped(0.1, STEPS)?.0));
        progress((index + 1) as f64 / conductances.len() as f64);
    }
    Ok(assemble(points, shares))
}

fn assemble(points: Vec<Point>, shares: Vec<(f64, f64)>) -> Map {
    let conductance = || axis("contact conductance (W/(m²·K)); left: 0", true, (0.05, 2e12));
    let known: Vec<(f64, f64)> = (0..=130)
        .map(|k| 10f64.powf(-1.0 + 0.1 * f64::from(k)))
        .map(|conductance| (conductance, HalfSpaces { ratio: RATIO, conductance }.share(0.1 * f64::from(STEPS))))
        .collect();
    let strip = (54.0_f64 * 7200.0 * 460.0).sqrt();
    let reduced = strip * RATIO.sqrt() / (1.0 + RATIO.sqrt());
    let own = |time: f64| (reduced / time.sqrt(), time);
    let judged = Panel {
        title: "default: part of the heat in the punch".to_owned(),
        x: conductance(),
        y: axis("communication step (s)", true, (6e-5, 20.0)),
        points,
        curves: vec![curve("the interface's own time", vec![own(6e-5), own(16.0)], true)],
    };
    let apart = shares.iter().map(|&(h, share)| {
        let conductance = if h <= NONE { 0.0 } else { h };
        (share - HalfSpaces { ratio: RATIO, conductance }.share(0.1 * f64::from(STEPS))).abs()
    });
    let findings = vec![
        format!(
            "The default is right in {} of {} runs, largest error {:.1e} of the heat. Steps are up to a million times shorter or \
             longer than the time of the interface; a conductance of 0 gives half of the heat each, one of 1e12 the part of \
             the effusivity.",
            judged.count(Verdict::Right),
            judged.points.len(),
            judged.largest_error()
        ),
        format!(
            "After a second the part of the heat in the punch falls from {:.3} to {:.3} as the conductance rises, within \
             {:.1e} of the closed form.",
            shares.first().map_or(f64::NAN, |point| point.1),
            shares.last().map_or(f64::NAN, |point| point.1),
            apart.fold(0.0, f64::max)
        ),
    ];
    let split = Panel {
        title: "after ten steps of 0.1 s".to_owned(),
        x: conductance(),
        y: axis("part of the heat in the punch", false, (0.0, 0.6)),
        points: Vec::new(),
        curves: vec![curve("theory", known, true), curve("default", shares, false)],
    };
    Map {
        title: "Contact conductance",
        problem: format!(
            "Two half-spaces, conductivity of the punch {RATIO} of the strip's, heated by friction from rest; line level, \
                 solver.tolerance = 1e-3, ten communication steps, against the closed form."
        ),
        findings,
        panels: vec![judged, split],
        columns: 2,
    }
}
