//! What a test rig is read for: running-in, worn volume over distance, and the friction loop of a stroke.
//!
//! The wear rate is that of the approach by wear: its power, `integral of p dw/dt dA`, over load and speed. It is taken per distance slid,
//! over a fiftieth of it. Running-in ends where it comes for good within a tenth
//! of its final value, that over the last tenth of the distance. A run in which it comes there in the last fifth of the
//! distance has not run in.

use super::measured::Measured;
use super::quantity::{Shown, number, rounded};
use super::run::Recording;
use serde_json::{Value, json};
use std::ops::Range;

/// Relative deviation from the final wear rate up to which the contact is run in.
const RUN_IN: f64 = 0.1;

/// Windows of the distance in which rates are taken; the last tenth of them has the final rate.
const WINDOWS: usize = 50;

pub(super) struct Rig {
    /// Time and distance at which running-in has ended, s and m; `None`: not within the run.
    pub running_in: Option<[f64; 2]>,
    /// Worn volume of both bodies over the distance: of the run, and of its last tenth, m2.
    pub volume_per_distance: [f64; 2],
    /// The last stroke there and back.
    pub friction_loop: Option<Loop>,
}

pub(super) struct Loop {
    /// Rows of the recording.
    pub rows: Range<usize>,
    /// Work of the friction force, J, and distance slid, m.
    pub work: f64,
    distance: f64,
    /// Range of the displacement, m.
    pub stroke: f64,
}

/// Rows at which the sliding velocity has a new sign.
pub(super) fn reversals(recording: &Recording) -> Vec<usize> {
    let mut sign = 0.0;
    let turns = |(row, value): (usize, &f64)| {
        let turns = sign * value < 0.0;
        sign = if *value == 0.0 { sign } else { value.signum() };
        turns.then_some(row)
    };
    recording.values("sliding_velocity").iter().enumerate().filter_map(turns).collect()
}

impl Rig {
    /// Of a run that is one of a rig: it reciprocates, or stands beside a measured record. `None` else, and where nothing slides.
    pub(super) fn of(recording: &Recording, measured: &[Measured]) -> Option<Self> {
        let turns = reversals(recording);
        let distance = recording.values("sliding_distance");
        let way = distance.last().copied()?;
        if turns.len() < 3 && measured.is_empty() || way <= 0.0 {
            return None;
        }
        let [punch, strip] = ["punch", "strip"].map(|body| recording.values(&format!("wear_volume_{body}")));
        let volume: Vec<f64> = punch.iter().zip(strip).map(|(one, other)| one + other).collect();
        let tenth = interpolated(distance, &volume, 0.9 * way);
        let worn = volume[volume.len() - 1];
        Some(Self {
            running_in: running_in(&recording.times, distance, &wear_power(recording)),
            volume_per_distance: [worn / way, (worn - tenth) / (0.1 * way)],
            friction_loop: (turns.len() >= 3).then(|| Loop::new(recording, &turns)),
        })
    }

    pub(super) fn lines(&self) -> Vec<(String, String)> {
        let per_km = self.volume_per_distance.map(|own| number(1e12 * own));
        let mut lines = vec![(
            "worn volume".to_owned(),
            format!("{} mm³ per km slid, {} over the last tenth of the distance", per_km[0], per_km[1]),
        )];
        if self.volume_per_distance[0] > 0.0 {
            let text = match self.running_in {
                Some([time, distance]) => {
                    format!(
                        "{} s, {} m: from there the wear rate is within 10 % of its final value",
                        rounded(time),
                        rounded(distance)
                    )
                }
                None => "the wear rate still changes by more than 10 % at the end".to_owned(),
            };
            lines.push(("running-in".to_owned(), text));
        }
        lines.extend(self.friction_loop.as_ref().map(|own| {
            let shown = |unit, value: f64| Shown::of_difference(unit, value.abs()).text(value);
            let text = format!(
                "{} over a stroke of {}, mean friction force {}",
                shown("J", own.work),
                shown("m", own.stroke),
                shown("N", own.work / own.distance)
            );
            ("friction loop".to_owned(), text)
        }));
        lines
    }

    /// The same in SI units.
    pub(super) fn record(&self) -> Value {
        json!({
            "running_in": self.running_in.map(|[time, distance]| json!({ "time": time, "distance": distance })),
            "worn_volume_per_distance": self.volume_per_distance[0],
            "worn_volume_per_distance_of_last_tenth": self.volume_per_distance[1],
            "friction_loop": self.friction_loop.as_ref().map(|own| json!({ "work": own.work, "stroke": own.stroke })),
        })
    }
}

impl Loop {
    /// From the last reversal but two to the last: there and back.
    fn new(recording: &Recording, turns: &[usize]) -> Self {
        // The row before a reversal has the end of the last stroke.
        let [first, last] = [turns[turns.len() - 3], turns[turns.len() - 1]].map(|row| row - 1);
        let rows = first..last + 1;
        let x = &recording.displacement[rows.clone()];
        let (low, high) = x.iter().fold((x[0], x[0]), |(low, high), x| (low.min(*x), high.max(*x)));
        let gained = |name: &str| recording.values(name)[last] - recording.values(name)[first];
        Self { rows, work: gained("dissipated_energy"), distance: gained("sliding_distance"), stroke: high - low }
    }
}

/// Integral of the power of wear over time, J.
fn wear_power(recording: &Recording) -> Vec<f64> {
    let (times, power) = (&recording.times, recording.values("wear_dissipation_power"));
    let steps = (1..times.len()).map(|row| 0.5 * (power[row - 1] + power[row]) * (times[row] - times[row - 1]));
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(steps)
        .map(|own| {
            sum += own;
            sum
        })
        .collect()
}

/// Time and distance at which running-in has ended; `worn`: integral of the wear rate.
fn running_in(times: &[f64], distance: &[f64], worn: &[f64]) -> Option<[f64; 2]> {
    let way = distance[distance.len() - 1];
    let depths: Vec<f64> =
        (0..=WINDOWS).map(|window| interpolated(distance, worn, way * window as f64 / WINDOWS as f64)).collect();
    let mean = |windows: Range<usize>| (depths[windows.end] - depths[windows.start]) / windows.len() as f64;
    let last = WINDOWS / 10;
    let rate = mean(WINDOWS - last..WINDOWS);
    let is_run_in = |own: f64| (own - rate).abs() <= RUN_IN * rate;
    let changes = (0..WINDOWS).rev().find(|window| !is_run_in(mean(*window..window + 1)));
    let end = changes.map_or(0, |window| window + 1);
    if rate <= 0.0 || end > WINDOWS - 2 * last {
        return None;
    }
    let reached = way * end as f64 / WINDOWS as f64;
    Some([interpolated(distance, times, reached), reached])
}

/// Value at `at` of a quantity over an abscissa that does not decrease.
pub(super) fn interpolated(x: &[f64], y: &[f64], at: f64) -> f64 {
    let row = x.partition_point(|own| *own < at).clamp(1, x.len() - 1);
    let length = x[row] - x[row - 1];
    let part = if length > 0.0 { ((at - x[row - 1]) / length).clamp(0.0, 1.0) } else { 1.0 };
    y[row - 1] + part * (y[row] - y[row - 1])
}

#[cfg(test)]
mod tests {
    use super::super::run::run;
    use super::super::trajectory::Trajectory;
    use super::*;
    use crate::tests::shipped;
    use scene::Scene;

    fn record() -> Measured {
        Measured {
            name: "wear_depth".into(),
            unit: "m",
            points: Vec::new(),
            outside: 0,
            root_mean_square: 0.0,
            largest: 0.0,
            at: 0.0,
            range: 0.0,
        }
    }

    fn recorded(name: &str, assignments: &[&str]) -> (Scene, Recording) {
        let mut file = shipped(name);
        assignments.iter().for_each(|assignment| scene_file::assign(&mut file, assignment).unwrap());
        let scene = Scene::new(&file.packaged.starts, None).unwrap();
        let trajectory = Trajectory::nominal(&file, &scene, None).unwrap();
        let recording = run(&file, &trajectory, &[], &mut |_| ()).unwrap();
        (scene, recording)
    }

    #[test]
    fn a_rounded_punch_is_run_in_when_it_touches_over_its_width() {
        let (scene, recording) = recorded(
            "pin_on_disk",
            &[
                "solver.fidelity=line",
                "solver.heat=mean",
                "solver.cells=65",
                "contact.initial_shape=parabolic",
                "contact.initial_radius=1 m",
                "contact.shear_coupling=false",
                "punch.youngs_modulus=5000 GPa",
                "strip.youngs_modulus=5000 GPa",
                "strip.wear_coefficient=0",
                "punch.wear_coefficient=1e-4 mm3/(N.m)",
                "nominal.duration=25 s",
            ],
        );
        // A rigid cylinder worn to the half-width a has lost 2 a^3/(3 R) per depth, which is k F s, and comes closer by k F/(2 a b) per distance, from
        // half of the width on at a constant rate. A tenth above it a is 1.1 times smaller.
        let half = 0.5 * scene.width / (1.0 + RUN_IN);
        let exact = 2.0 * half.powi(3) / 3.0 * scene.depth / (scene.punch.wear_coefficient * scene.nominal_load);
        let way = *recording.values("sliding_distance").last().unwrap();
        assert!((0.2..0.7).contains(&(exact / way)), "{exact} {way}");
        let Some([time, distance]) = Rig::of(&recording, &[record()]).unwrap().running_in else {
            panic!("it has not run in")
        };
        assert!((distance - exact).abs() <= 2.0 * way / WINDOWS as f64, "{distance} {exact}");
        assert!((time * scene.nominal_velocity - distance).abs() < 1e-6 * distance, "{time}");
    }

    #[test]
    fn a_stroke_has_the_work_of_friction_and_the_volume_of_the_wear_law() {
        let (scene, recording) = recorded(
            "reciprocating_punch",
            &["solver.fidelity=lumped", "nominal.duration=20 s", "strip.wear_coefficient=0"],
        );
        let rig = Rig::of(&recording, &[]).unwrap();
        let own = rig.friction_loop.as_ref().unwrap();
        let force = scene.friction_coefficient * scene.nominal_load * scene.faces;
        // The communication points next to the reversals.
        assert!((own.stroke / scene.nominal_stroke - 1.0).abs() < 5e-3, "{}", own.stroke);
        assert!((own.distance / (2.0 * scene.nominal_stroke) - 1.0).abs() < 5e-3, "{}", own.distance);
        assert!((own.work - force * own.distance).abs() < 1e-6 * own.work, "{}", own.work);
        let exact = scene.punch.wear_coefficient * scene.nominal_load * scene.faces;
        for volume in rig.volume_per_distance {
            assert!((volume - exact).abs() < 1e-6 * exact, "{volume} {exact}");
        }
        // The rate is the same from the start.
        assert_eq!(rig.running_in, Some([0.0; 2]));
        let text: Vec<String> = rig.lines().into_iter().map(|(name, text)| format!("{name}: {text}")).collect();
        assert!(text[2].starts_with("friction loop: ") && text[0].contains("mm³ per km slid"), "{text:?}");
    }

    #[test]
    fn a_rate_that_still_falls_is_not_run_in() {
        let way: Vec<f64> = (0..=100).map(f64::from).collect();
        let falling: Vec<f64> = way.iter().map(|s| s.powf(0.2)).collect();
        assert_eq!(running_in(&way, &way, &falling), None);
        // Exactly exponential: within a tenth of 1 where exp(-s/8) = 0.1.
        let settling: Vec<f64> = way.iter().map(|s| s + 8.0 * (1.0 - (-s / 8.0).exp())).collect();
        let Some([_, distance]) = running_in(&way, &way, &settling) else { panic!("it has not run in") };
        assert!((distance - 8.0 * 10.0_f64.ln()).abs() <= 2.0, "{distance}");
    }
}
