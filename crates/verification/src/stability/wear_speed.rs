//! Wear against speed: critical speed of pressure waves whose crests wear.
//!
//! In full periodic contact of a conducting half-plane that wears on a rigid insulator, waves grow beyond
//! `R_cr = [q^2 + 1 + sqrt(1 + 2 q^2)]/q^3`, q = 2 - w, `w = k K/(mu alpha (1+nu) kd)`, and oscillate there with
//! `Omega = kd m^2 sqrt(c^2 - 2c)`, c = q R_cr ([`exact::instability`]). From w = 2 on no wave grows at any speed.
//!
//! Theory: docs/theory.md, sections 7.4, 10.

use super::{Grid, Map, Panel, Point, Verdict, axis, curve};
use crate::Fallible;
use crate::wave::{WaveContact, WaveScene, amplification};
use exact::instability::{critical_frequency, critical_ratio};
use nalgebra::Complex;
use std::f64::consts::PI;

pub(crate) const SUMMARY: &str =
    "wear against speed: where pressure waves begin to grow, and how fast they oscillate there";

/// Number of cells per wavelength: the wear rate of a mode on the cells is too large by a relative (pi/N)^2/3.
const CELLS: usize = 32;
/// Relative distance from the threshold, or from that of the wear on the cells, within which speeds are not judged.
const MARGIN: f64 = 0.02;

/// A contact of the wear number `wear`.
pub fn contact(cells: usize, wear: f64) -> Fallible<WaveContact> {
    WaveScene { wear, tolerance: 1e-4, ..WaveScene::new(cells) }.build()
}

/// Growth rate (complex, over `kd m^2`) of the default scheme at `ratio` times the critical speed without wear, at the end
/// of `duration` (over `1/(kd m^2)`), after which other parts of the wave have decayed.
pub fn growth(contact: &WaveContact, ratio: f64, duration: f64) -> Fallible<Complex<f64>> {
    let exact = contact.scene().exact(ratio);
    let step = 0.1 / (1.0 + exact.norm());
    let count = ((duration / step).ceil() as usize).max(40);
    contact.growth(ratio, step, count, 40)
}

/// Verdict on a run, and the error of its growth rate over `kd m^2 + |b|`.
pub fn run(contact: &WaveContact, ratio: f64) -> Fallible<(Verdict, f64)> {
    let exact = contact.scene().exact(ratio);
    let step = 0.2 / (1.0 + exact.norm());
    // A quarter of the run contains a crest of the oscillation.
    let duration = (12.0 / (1.0 + exact.norm())).max(4.0 * PI / exact.im.abs().max(1.0));
    let count = (duration / step).ceil() as usize;
    let amplitudes = contact.follow(ratio, step, count)?;
    let changes: Vec<f64> = amplitudes.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    let crest = |from: usize, to: usize| changes[from..to].iter().copied().fold(0.0, f64::max);
    let length = changes.len();
    let opened = amplitudes.len() < count;
    let grows = opened || crest(3 * length / 4, length) > crest(length / 4, length / 2);
    let verdict = match (grows, exact.re > 0.0) {
        (false, true) => Verdict::Hides,
        (true, false) => Verdict::Grows,
        _ => Verdict::Right,
    };
    // A decay faster than the continuous spectrum has no rate of its own.
    if exact.re < -0.9 {
        return Ok((verdict, f64::NAN));
    }
    let found = amplification(&amplitudes, 24, exact.im != 0.0).ln() / step;
    Ok((verdict, (found.re - exact.re).abs() / (1.0 + exact.norm())))
}

/// Measured threshold: speed over the critical one without wear at which the growth rate is 0, and the angular frequency
/// there over `kd m^2`; by the secant through growth rates a twentieth below and above the theoretical one, each after
/// `duration`.
pub(crate) fn threshold(contact: &WaveContact, duration: f64) -> Fallible<(f64, f64)> {
    let guess = critical_ratio(contact.scene().wear);
    let (mut low, mut high) = (0.95 * guess, 1.05 * guess);
    let (mut below, mut above) = (growth(contact, low, duration)?, growth(contact, high, duration)?);
    for _ in 0..2 {
        let ratio = low - below.re * (high - low) / (above.re - below.re);
        let found = growth(contact, ratio, duration)?;
        if (ratio - low).abs() < (ratio - high).abs() {
            (high, above) = (low, below);
        }
        (low, below) = (ratio, found);
        if found.re.abs() < 1e-5 * (1.0 + found.norm()) {
            break;
        }
    }
    Ok((low, below.im.abs()))
}

pub(crate) fn map(grid: Grid, progress: &dyn Fn(f64)) -> Fallible<Map> {
    let count = grid.count(12);
    let wears: Vec<f64> = (0..count).map(|k| 2.2 * k as f64 / (count - 1) as f64).collect();
    let (mut points, mut thresholds, mut frequencies) = (Vec::new(), Vec::new(), Vec::new());
    for (index, &wear) in wears.iter().enumerate() {
        let contact = contact(CELLS, wear)?;
        let critical = critical_ratio(wear);
        for ratio in grid.spread(0.4, 60.0, 15) {
            let shifted = critical_ratio(wear * (1.0 + (PI / CELLS as f64).powi(2) / 3.0));
            if ratio > (1.0 - MARGIN) * critical && ratio < (1.0 + MARGIN) * shifted {
                continue;
            }
            let (verdict, error) = run(&contact, ratio)?;
            points.push(Point { x: wear, y: ratio, verdict, error });
        }
        if critical < 60.0 {
            let (ratio, frequency) = threshold(&contact, 9.0)?;
            thresholds.push((wear, ratio));
            if wear > 0.0 {
                frequencies.push((wear, frequency));
            }
        }
        progress((index + 1) as f64 / count as f64);
    }
    Ok(assemble(points, thresholds, frequencies))
}

fn assemble(points: Vec<Point>, thresholds: Vec<(f64, f64)>, frequencies: Vec<(f64, f64)>) -> Map {
    let wear = || axis("wear number w = k K/(μ α (1+ν) kd)", false, (-0.1, 2.3));
    let theory = |value: fn(f64) -> f64| -> Vec<(f64, f64)> {
        (0..=180).map(|k| 0.01 * f64::from(k)).map(|w| (w, value(w))).filter(|point| point.1 < 80.0).collect()
    };
    let farthest = |found: &[(f64, f64)], value: fn(f64) -> f64| {
        let apart = found.iter().filter(|point| point.0 > 0.0).map(|&(w, x)| (x / value(w) - 1.0).abs());
        apart.fold(0.0, f64::max)
    };
    let off = [farthest(&thresholds, critical_ratio), farthest(&frequencies, critical_frequency)];
    let judged = Panel {
        title: "default: growth or decay".to_owned(),
        x: wear(),
        y: axis("speed over the critical speed without wear, V/Vcr", true, (0.3, 100.0)),
        points,
        curves: vec![
            curve("theory: grows above", theory(critical_ratio), true),
            curve("measured threshold", thresholds.clone(), false),
        ],
    };
    let beyond = judged.points.iter().filter(|point| point.x >= 2.0);
    let stable = beyond.clone().filter(|point| point.verdict == Verdict::Right).count();
    let findings = vec![
        format!(
            "The default shows growth and decay as the exact solution does in {} of {} runs.",
            judged.count(Verdict::Right),
            judged.points.len()
        ),
        format!(
            "Thresholds found by stepping agree with the critical speed of the theory within {:.1e}, their oscillation with its \
             frequency within {:.1e}. {CELLS} cells make wear (π/{CELLS})²/3 = {:.1e} too strong.",
            off[0],
            off[1],
            (PI / CELLS as f64).powi(2) / 3.0
        ),
        format!("From w = 2 on nothing grows at any speed: {stable} of {} runs.", beyond.count()),
    ];
    let frequency = Panel {
        title: "oscillation at the threshold".to_owned(),
        x: wear(),
        y: axis("angular frequency over kd m²", true, (0.1, 100.0)),
        points: Vec::new(),
        curves: vec![curve("theory", theory(critical_frequency), true), curve("measured", frequencies, false)],
    };
    Map {
        title: "Wear against speed",
        problem: format!(
            "Half-plane that wears on a rigid insulator, full periodic contact of one wavelength (m = 2π/wavelength) on \
                 {CELLS} cells; default scheme, solver.tolerance = 1e-4."
        ),
        findings,
        panels: vec![judged, frequency],
        columns: 2,
    }
}
