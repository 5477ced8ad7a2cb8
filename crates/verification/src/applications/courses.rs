//! Input trajectories of test benches, machines and vehicles: linear between communication points.

use std::f64::consts::TAU;

/// Time (s), sliding velocity (m/s) and normal load (N) at a communication point.
pub type Point = [f64; 3];

/// Constant velocity and load for `time` (s), in `points` communication steps that are shorter at the beginning.
pub fn held(velocity: f64, load: f64, time: f64, points: usize) -> Vec<Point> {
    (0..=points).map(|point| [time * (point as f64 / points as f64).powf(1.5), velocity, load]).collect()
}

/// Reciprocating with V cos wt from the middle of the stroke; the load varies by the fraction `pulse` twice in a period.
pub fn reciprocating(velocity: f64, load: f64, period: f64, cycles: f64, pulse: f64) -> Vec<Point> {
    const POINTS: usize = 24;
    let count = (cycles * POINTS as f64).round() as usize;
    let at = |point: usize| {
        let angle = TAU * point as f64 / POINTS as f64;
        [period * point as f64 / POINTS as f64, velocity * angle.cos(), load * (1.0 + pulse * (2.0 * angle).sin())]
    };
    (0..=count).map(at).collect()
}

/// An input trajectory composed of ramps.
struct Ramps(Vec<Point>);

impl Ramps {
    fn from(velocity: f64, load: f64) -> Self {
        Self(vec![[0.0, velocity, load]])
    }

    /// Ramp to `velocity` and `load` within `time`, in `points` communication steps.
    fn to(&mut self, time: f64, velocity: f64, load: f64, points: usize) -> &mut Self {
        let from = *self.0.last().expect("a course has a beginning");
        for point in 1..=points {
            let part = point as f64 / points as f64;
            self.0.push([
                from[0] + time * part,
                from[1] + (velocity - from[1]) * part,
                from[2] + (load - from[2]) * part,
            ]);
        }
        self
    }
}

/// Stops from `velocity` under `load` within `stop` (s), each followed by a hold, a release, a rest and a run-up in `rest` (s).
pub fn stop_and_go(velocity: f64, load: f64, stop: f64, rest: f64, count: f64) -> Vec<Point> {
    let mut ramps = Ramps::from(velocity, 0.0);
    for _ in 0..count as usize {
        ramps.to(0.1 * stop, velocity, load, 2);
        ramps.to(0.9 * stop, 0.0, load, 12).to(0.2 * rest, 0.0, load, 2);
        ramps.to(0.05 * rest, 0.0, 0.0, 1).to(0.25 * rest, 0.0, 0.0, 2).to(0.5 * rest, velocity, 0.0, 4);
    }
    ramps.0
}

/// Load cycles of `on` (s) under `load` and of `off` under the fraction `idle` of it, at constant speed; each begins with a
/// ramp of a hundredth of its time.
pub fn duty_cycle(velocity: f64, load: f64, on: f64, off: f64, count: f64, idle: f64) -> Vec<Point> {
    let mut ramps = Ramps::from(velocity, idle * load);
    for _ in 0..count as usize {
        ramps.to(0.01 * on, velocity, load, 1).to(0.99 * on, velocity, load, 12);
        ramps.to(0.01 * off, velocity, idle * load, 1).to(0.99 * off, velocity, idle * load, 6);
    }
    ramps.0
}

/// Engagements: the load rises within a fifth of `slip` (s) and stays, the sliding velocity falls to 0 at the end of it;
/// after four times as long closed and open the next one begins.
pub fn engagements(velocity: f64, load: f64, slip: f64, count: f64) -> Vec<Point> {
    let mut ramps = Ramps::from(velocity, 0.0);
    for _ in 0..count as usize {
        ramps.to(0.2 * slip, 0.97 * velocity, load, 8);
        ramps.to(0.4 * slip, 0.55 * velocity, load, 12).to(0.4 * slip, 0.0, load, 12).to(slip, 0.0, load, 3);
        ramps.to(0.2 * slip, 0.0, 0.0, 1).to(2.0 * slip, velocity, 0.0, 3);
    }
    ramps.0
}

/// Aperiodic velocity and load, never negative: three incommensurate sines each. The largest values are about twice the means.
pub fn wandering(velocity: f64, load: f64, time: f64, points: usize) -> Vec<Point> {
    let at = |point: usize| {
        let part = point as f64 / points as f64;
        let swing = |cycles: [f64; 3], phase: f64| {
            let sines = [0.5, 0.3, 0.2]
                .iter()
                .zip(cycles)
                .map(|(height, cycles)| height * (TAU * (cycles * part + phase)).sin());
            0.5 + 0.5 * sines.sum::<f64>()
        };
        [time * part, velocity * swing([3.0, 7.3, 17.9], 0.1), load * swing([2.2, 5.7, 13.1], 0.65)]
    };
    (0..=points).map(at).collect()
}

/// A run-up from rest to `velocity` within half of the `time` (s), then coasting to a third of it.
pub fn run_up(velocity: f64, load: f64, time: f64) -> Vec<Point> {
    let mut ramps = Ramps::from(0.0, load);
    ramps.to(0.5 * time, velocity, load, 40).to(0.3 * time, velocity, load, 20).to(
        0.2 * time,
        velocity / 3.0,
        load,
        12,
    );
    ramps.0
}
