use super::*;
use crate::heat::slab::Base;
use crate::verification::reference::{ClosedPath, LayerBase, band_mean};

fn unit(height: f64, base: Base, path: Path) -> StripProperties {
    StripProperties { height, conductivity: 1.0, capacity: 1.0, convection: 0.0, base, path, expansion: None }
}

/// Mean temperature over the contact.
fn mean(cells: &Cells, temperature: &[f64]) -> f64 {
    cells.integral(temperature) / (2.0 * cells.half_width())
}

/// Steps of equal length under a constant uniform flux 1 at a velocity; the temperatures at the end.
fn march(body: &mut StripHeat, state: &mut [f64], step: f64, steps: usize, velocity: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = body.cells();
    let flux = vec![1.0; count];
    let air = Surroundings::default();
    let (mut temperature, mut distortion) = (vec![0.0; count], vec![0.0; count]);
    for index in 0..steps {
        body.prepare(step, [velocity(index as f64 * step), velocity((index + 1) as f64 * step)]);
        if index + 1 == steps {
            body.base(state, &air, Stage::End, &flux, &mut temperature, &mut distortion);
            let gains = &body.gains(Stage::End).temperature;
            for i in 0..count {
                temperature[i] += gains.row(i).sum();
            }
        }
        body.advance(state, &air, &flux, &flux);
    }
    temperature
}

#[test]
fn closed_path_steady_means_are_the_plain_fourier_sum() {
    for (base, layer) in [(Base::Held, LayerBase::Held), (Base::Insulated, LayerBase::Insulated)] {
        let exact = ClosedPath {
            length: 0.74,
            half_length: 0.0475,
            height: 0.011,
            conductivity: 54.0,
            diffusivity: 54.0 / (7200.0 * 460.0),
            base: layer,
        };
        let properties = StripProperties {
            height: 0.011,
            conductivity: 54.0,
            capacity: 7200.0 * 460.0,
            convection: 0.0,
            base,
            path: Path::Closed(0.74),
            expansion: None,
        };
        let cells = Cells::graded(0.0475, 33).unwrap();
        let resolution = Resolution { duration: 1000.0, shortest: 0.01, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        println!("{:?} {} states, error {:.1e}", body.size(), body.states(), body.error());
        for velocity in [0.0, 1e-4, 0.01, 1.0, -1.0, 30.0] {
            // In a step much longer than every decay but the mean's, the response is the steady one.
            let step = 1e9;
            body.prepare(step, [velocity, velocity]);
            let gains = body.gains(Stage::End).temperature.clone();
            let answer: Vec<f64> = (0..33).map(|i| gains.row(i).sum()).collect();
            let level = body.mean_level(
                &vec![0.0; body.states()],
                &Surroundings::default(),
                &body.step.end,
                [0.0, 2.0 * 0.0475 / 0.74],
                true,
            );
            let computed = mean(&cells, &answer) - level;
            let steady = exact.steady_mean(velocity, 200_000);
            println!("{base:?} {velocity}: {computed:e} {steady:e} {:.1e}", computed / steady - 1.0);
            assert!((computed / steady - 1.0).abs() < 1e-4, "{base:?} {velocity}: {computed} {steady}");
        }
    }
}

#[test]
fn half_space_at_short_times() {
    // Far from the edges of a wide contact at rest: 84.375 K after 1 s of 1 MW/m2.
    let properties = StripProperties {
        height: 0.1,
        conductivity: 54.0,
        capacity: 7200.0 * 460.0,
        convection: 0.0,
        base: Base::Insulated,
        path: Path::Closed(0.5),
        expansion: None,
    };
    let cells = Cells::graded(0.1, 33).unwrap();
    let resolution = Resolution { duration: 1.0, shortest: 0.02, tolerance: 1e-4 };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let mut state = vec![0.0; body.states()];
    let temperature = march(&mut body, &mut state, 0.02, 50, |_| 0.0);
    println!("{} states error {:.1e} {}", body.states(), body.error(), temperature[16] * 1e6);
    assert!((temperature[16] * 1e6 - 84.375).abs() < 84.375e-4, "{}", temperature[16] * 1e6);
}

#[test]
fn oscillating_band_on_a_half_plane() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let properties = unit(150.0, Base::Held, Path::Stroke { stroke: 1.0, length: 0.0 });
    let period = 2.0 * std::f64::consts::PI;
    let per_period = 64;
    let step = period / per_period as f64;
    let resolution = Resolution { duration: 80.0 * period, shortest: step, tolerance: 1e-4 };
    let start = std::time::Instant::now();
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    println!("{:?} {} states error {:.1e} {:?}", body.size(), body.states(), body.error(), start.elapsed());
    let mut state = vec![0.0; body.states()];
    let mut results = Vec::new();
    for (periods, exact) in [(20, 2.41276), (20, 2.63325), (40, 2.85382)] {
        let temperature = march(&mut body, &mut state, step, periods * per_period, |t| 0.5 * t.cos());
        let error = temperature[16] / exact - 1.0;
        println!("{} {exact} {error:.1e} {:?}", temperature[16], start.elapsed());
        results.push(error);
    }
    assert!(results.iter().all(|error| error.abs() < 1e-4), "{results:?}");
}

#[test]
fn jaeger_on_a_long_closed_path() {
    let cells = Cells::graded(1.0, 65).unwrap();
    let properties = unit(60.0, Base::Held, Path::Closed(2000.0));
    let resolution = Resolution { duration: 1e6, shortest: 10.0, tolerance: 1e-4 };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    println!("{:?} {} states error {:.1e}", body.size(), body.states(), body.error());
    for (peclet, max, at, average) in [(0.1, 2.20033, -0.2435, 2.0618), (1.0, 0.99185, -0.6664, 0.79986), (10.0, 0.34850, -0.9244, 0.24132)] {
        body.prepare(1e12, [2.0 * peclet; 2]);
        let gains = &body.gains(Stage::End).temperature;
        let answer: Vec<f64> = (0..65).map(|i| gains.row(i).sum()).collect();
        let exact = band_mean(peclet, Some((60.0, LayerBase::Held)));
        println!("{peclet} {} {exact} {average} {:.1e}", mean(&cells, &answer), mean(&cells, &answer) / exact - 1.0);
        assert!((mean(&cells, &answer) / exact - 1.0).abs() < 1e-4);
        let (mut best, mut place) = (0.0, 0.0);
        for k in 0..20_000 {
            let x = -1.0 + 1e-4 * f64::from(k);
            let value = cells.point_value(&answer, x);
            if value > best {
                (best, place) = (value, x);
            }
        }
        println!("   max {best} {max} at {place} {at}");
    }
}
