use super::*;
use crate::elastic::{self, Material};
use crate::heat::line::GAMMA;
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
        let resolution = Resolution { duration: 1000.0, shortest: 0.01, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        println!("{:?} {} states, error {:.1e}", body.size(), body.states(), body.error());
        for velocity in [0.0, 1e-4, 0.01, 1.0, -1.0, 30.0] {
            // In a step much longer than every decay but the mean's, the response is the steady one.
            let step = 1e9;
            body.prepare(step, [velocity, velocity]);
            let gains = body.gains(Stage::End).temperature.clone();
            let answer: Vec<f64> = (0..33).map(|i| gains.row(i).sum()).collect();
            let [level, _] = body.mean_levels(
                &vec![0.0; body.states()],
                &Surroundings::default(),
                &body.step.end,
                [0.0, 2.0 * 0.0475 / 0.74],
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
    let resolution = Resolution { duration: 1.0, shortest: 0.02, tolerance: 1e-4, way: f64::INFINITY };
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
    let resolution = Resolution { duration: 80.0 * period, shortest: step, tolerance: 1e-4, way: f64::INFINITY };
    let start = std::time::Instant::now();
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    println!("{:?} {} states error {:.1e} {:?}", body.size(), body.states(), body.error(), start.elapsed());
    let mut state = vec![0.0; body.states()];
    let mut results = Vec::new();
    for (periods, exact) in [(20, 2.41276), (20, 2.63325), (40, 2.85382)] {
        let temperature = march(&mut body, &mut state, step, periods * per_period, |t| 0.5 * t.cos());
        let centre = cells.point_value(&temperature, 0.0);
        let error = centre / exact - 1.0;
        println!("{centre} {exact} {error:.1e} {:?}", start.elapsed());
        results.push(error);
    }
    assert!(results.iter().all(|error| error.abs() < 1e-4), "{results:?}");
}

#[test]
fn jaeger_on_a_long_closed_path() {
    let cells = Cells::graded(1.0, 65).unwrap();
    // The printed maximum of the half-plane and where it lies; layers so high that it is reached to `layer`.
    for (peclet, height, max, at, layer) in
        [(0.1, 38.0, 2.20033, -0.2435, 1e-3), (1.0, 12.0, 0.99185, -0.6664, 2e-4), (10.0, 4.0, 0.34850, -0.9244, 1e-4)]
    {
        let properties = unit(height, Base::Held, Path::Closed(2000.0));
        let resolution = Resolution { duration: 1e6, shortest: 10.0, tolerance: 1e-4, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        body.prepare(1e12, [2.0 * peclet; 2]);
        let gains = &body.gains(Stage::End).temperature;
        let answer: Vec<f64> = (0..65).map(|i| gains.row(i).sum()).collect();
        let exact = band_mean(peclet, Some((height, LayerBase::Held)));
        println!("{peclet} {} {exact} {:.1e}", mean(&cells, &answer), mean(&cells, &answer) / exact - 1.0);
        assert!((mean(&cells, &answer) / exact - 1.0).abs() < 1e-4);
        let candidates = (0..20_000).map(|k| {
            let x = -1.0 + 1e-4 * f64::from(k);
            (cells.point_value(&answer, x), x)
        });
        let (value, place) = candidates.max_by(|left, right| left.0.total_cmp(&right.0)).unwrap();
        println!("   max {value} {:.1e} at {place} {at}", value / max - 1.0);
        assert!((value / max - 1.0).abs() < layer, "{peclet}: {value} {max}");
        assert!((place - at).abs() < 2e-3, "{peclet}: {place} {at}");
    }
}

fn steel(height: f64, base: Base, path: Path, convection: f64) -> StripProperties {
    StripProperties { height, conductivity: 55.0, capacity: 7800.0 * 460.0, convection, base, path, expansion: None }
}

fn expanding(nu: f64, base: crate::elastic::Base) -> Option<Expansion> {
    let material = crate::elastic::Material::new(200e9, nu).unwrap();
    Some(Expansion { material, coefficient: 1.1e-5, base })
}

/// Fluxes that differ from cell to cell and step to step.
fn uneven(cells: &Cells, index: usize) -> Vec<f64> {
    let a = cells.half_width();
    cells.centres().iter().map(|x| 1e4 * (1.0 + 0.5 * (3.0 * x / a + index as f64).sin())).collect()
}

#[test]
fn what_a_stage_says_is_what_the_state_then_shows_and_heat_is_conserved() {
    for (base, path, convection, cooling) in [
        (Base::Held, Path::Closed(0.3), 0.0, 0.0),
        (Base::Insulated, Path::Stroke { stroke: 0.01, length: 0.0 }, 3000.0, 0.0),
        (Base::Convecting(500.0), Path::Closed(0.1), 2000.0, -700.0),
        (Base::Convecting(500.0), Path::OneWay, 1000.0, -300.0),
    ] {
        let mut properties = steel(0.02, base, path, convection);
        properties.expansion = expanding(0.3, crate::elastic::Base::Bonded);
        let cells = Cells::graded(0.02, 12).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        let far = if base == Base::Held { 2.0 } else { 0.0 };
        let air = Surroundings { cooling, cooling_fall: -0.3 * cooling, ambient: 5.0, far };
        let (mut temperature, mut distortion) = (vec![0.0; 12], vec![0.0; 12]);
        let (mut held, mut moved) = (vec![0.0; 12], vec![0.0; 12]);
        let (mut received, mut largest) = (0.0, 0.0f64);
        for index in 0..40 {
            let velocity = [0.05 * (index as f64 * 0.3).sin(), 0.05 * (index as f64 * 0.3 + 0.3).sin()];
            let step = if index % 3 == 0 { 0.02 } else { 0.3 };
            body.prepare(step, velocity);
            let (first, end) = (uneven(&cells, 2 * index), uneven(&cells, 2 * index + 1));
            body.base(&state, &air, Stage::End, &first, &mut temperature, &mut distortion);
            let gains = body.gains(Stage::End).clone();
            let flux = nalgebra::DVector::from_column_slice(&end);
            let (warm, lifted) = (&gains.temperature * &flux, &gains.distortion * &flux);
            body.advance(&mut state, &air, &first, &end);
            let gamma = GAMMA;
            received += step * ((1.0 - gamma) * cells.integral(&first) + gamma * cells.integral(&end));
            body.held(&state, &air, &end, velocity[1], &mut held);
            body.held_distortion(&state, &air, &end, velocity[1], &mut moved);
            for i in 0..12 {
                largest = largest.max((temperature[i] + warm[i] - held[i]).abs() / held[i].abs());
                largest = largest.max((distortion[i] + lifted[i] - moved[i]).abs() / moved[i].abs());
            }
        }
        // The gains at a velocity that changes are interpolated between velocities.
        assert!(largest < 1e-4, "{base:?}: {largest:e}");
        let account = body.account(&state);
        let balance = account.received - account.stored - account.ambient - account.far;
        assert!((account.received - received).abs() < 1e-12 * received && balance.abs() < 1e-9 * received);
        if base == Base::Insulated {
            assert!(account.far.abs() < 1e-9 * received, "{}", account.far / received);
        }
    }
}

#[test]
fn cooling_that_falls_over_a_step_falls_over_its_parts() {
    for path in [Path::Closed(0.3), Path::Stroke { stroke: 0.01, length: 0.0 }, Path::OneWay] {
        let properties = steel(0.02, Base::Convecting(500.0), path, 0.0);
        let cells = Cells::graded(0.02, 12).unwrap();
        let resolution = Resolution { duration: 60.0, shortest: 0.02, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let (mut state, zero) = (vec![0.0; body.states()], vec![0.0; 12]);
        body.uniform(20.0, &mut state);
        let mut parts = state.clone();
        let (step, velocity, fall) = (2.0, [0.01; 2], 3e4);
        let air = Surroundings { cooling: -4e4, cooling_fall: fall, ambient: 5.0, far: 0.0 };
        body.prepare(step, velocity);
        let ahead = body.cooled_ahead(&state, &air, &zero, &zero);
        let more = Surroundings { cooling: air.cooling + 1.0, cooling_fall: fall - 1.0, ..air };
        let rise = body.cooled_ahead(&state, &more, &zero, &zero).temperature - ahead.temperature;
        assert!(rise > 0.0 && (ahead.rise - rise).abs() < 1e-7 * rise, "{path:?}: {ahead:?} {rise}");
        let [mut early, mut shown, mut moved] = [zero.clone(), zero.clone(), zero.clone()];
        body.base(&state, &air, Stage::First, &zero, &mut early, &mut moved);
        body.advance(&mut state, &air, &zero, &zero);
        for part in [GAMMA, 1.0 - GAMMA] {
            let later = if part == GAMMA { 1.0 - GAMMA } else { 0.0 };
            let around = Surroundings { cooling: air.cooling + later * fall, cooling_fall: part * fall, ..air };
            body.prepare(part * step, velocity);
            body.base(&parts, &around, Stage::End, &zero, &mut shown, &mut moved);
            body.advance(&mut parts, &around, &zero, &zero);
            if part == GAMMA {
                let apart = shown.iter().zip(&early).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-3 * fall * rise, "{path:?}: {shown:?} {early:?}");
            }
        }
        // Up to answers that are interpolated between velocities.
        let lost = body.account(&state).ambient;
        assert!((body.account(&parts).ambient / lost - 1.0).abs() < 1e-9, "{path:?}");
        let cooled = [&state, &parts].map(|state| body.cooled_temperature(state, &air, &zero));
        let followed = ahead.temperature - ahead.lagging;
        let lagged = cooled[0] - followed;
        assert!((cooled[0] - cooled[1]).abs() < 1e-3 * fall * rise, "{path:?}: {cooled:?}");
        // What lags behind is what the contact lacks of the cooling.
        assert!(lagged.abs() < 0.3 * (20.0 - cooled[0]), "{path:?}: {ahead:?} {cooled:?}");
        if path == Path::OneWay {
            assert!(lagged.abs() < 1e-9 && ahead.lagging == 0.0, "{ahead:?} {cooled:?}");
        }
    }
}

#[test]
fn convection_acts_beside_the_contact_only() {
    // So good a conductor that it is of one temperature: all heat leaves through the free surface.
    let mut properties = steel(0.02, Base::Insulated, Path::Closed(0.3), 400.0);
    properties.conductivity = 1e6;
    let cells = Cells::graded(0.1, 16).unwrap();
    let resolution = Resolution { duration: 1e4, shortest: 1.0, tolerance: 1e-4, way: f64::INFINITY };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let mut state = vec![0.0; body.states()];
    march(&mut body, &mut state, 1e4, 20, |_| 0.3);
    let air = Surroundings::default();
    let flux = vec![1.0; 16];
    let mut temperature = vec![0.0; 16];
    body.held(&state, &air, &flux, 0.3, &mut temperature);
    let exact = 0.2 / (400.0 * 0.1);
    assert!((mean(&cells, &temperature) / exact - 1.0).abs() < 1e-3, "{} {exact}", mean(&cells, &temperature));
    let [ambient, far] = body.flows(&state, &air, &flux);
    assert!((ambient / 0.2 - 1.0).abs() < 1e-6 && far.abs() < 1e-6 * 0.2, "{ambient} {far}");
    let free = body.cooled_temperature(&state, &air, &flux);
    assert!((free * 400.0 * 0.1 / 0.2 - 1.0).abs() < 1e-6, "{free}");
}

#[test]
fn everything_at_one_temperature_stays_there() {
    for base in [Base::Held, Base::Insulated, Base::Convecting(300.0)] {
        let properties = steel(0.02, base, Path::Closed(0.3), 100.0);
        let cells = Cells::graded(0.05, 9).unwrap();
        let resolution = Resolution { duration: 100.0, shortest: 0.1, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        body.uniform(10.0, &mut state);
        let far = if base == Base::Held { 10.0 } else { 0.0 };
        let air = Surroundings { ambient: 10.0, far, ..Surroundings::default() };
        body.prepare(5.0, [1.0, 1.0]);
        let (zero, mut temperature, mut distortion) = (vec![0.0; 9], vec![0.0; 9], vec![0.0; 9]);
        for _ in 0..5 {
            body.base(&state, &air, Stage::End, &zero, &mut temperature, &mut distortion);
            assert!(temperature.iter().all(|t| (t - 10.0).abs() < 1e-2), "{base:?} {temperature:?}");
            body.advance(&mut state, &air, &zero, &zero);
        }
        assert!((body.mean_temperature(&state) - 10.0).abs() < 1e-2);
    }
}

#[test]
fn heated_half_plane_curves_by_its_flux() {
    // u'' = alpha (1+nu) q/K where the flux q enters, steady, at rest.
    let mut properties = steel(100.0, Base::Held, Path::Stroke { stroke: 0.01, length: 0.0 }, 0.0);
    properties.expansion = expanding(0.3, crate::elastic::Base::Smooth);
    let cells = Cells::graded(0.1, 33).unwrap();
    let resolution = Resolution { duration: 1e10, shortest: 100.0, tolerance: 1e-3, way: f64::INFINITY };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    body.prepare(1e14, [0.0, 0.0]);
    let gains = &body.gains(Stage::End).distortion;
    let moved: Vec<f64> = (0..33).map(|i| gains.row(i).sum()).collect();
    assert!(moved.iter().all(|u| *u < 0.0), "{moved:?}");
    let at = |x: f64| cells.point_value(&moved, x);
    let curvature = (at(0.05) + at(-0.05) - 2.0 * at(0.0)) / 0.05f64.powi(2);
    let exact = 1.1e-5 * 1.3 / 55.0;
    println!("{curvature:e} {exact:e} {:.1e}", curvature / exact - 1.0);
    assert!((curvature / exact - 1.0).abs() < 2e-3, "{curvature:e} {exact:e}");
}

#[test]
fn full_periodic_contact_is_the_layer_wave_by_wave() {
    // A flux that varies once round the ring: its cells' values hold only the aliases n, N - n, N + n, ... of one wave.
    let length = 0.2;
    let mut properties = steel(0.02, Base::Held, Path::Closed(length), 0.0);
    properties.expansion = expanding(0.3, crate::elastic::Base::Bonded);
    let count = 32;
    let cells = Cells::uniform(0.5 * length, count).unwrap();
    let resolution = Resolution { duration: 1e3, shortest: 0.01, tolerance: 1e-4, way: f64::INFINITY };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let slab = crate::heat::slab::Slab {
        height: 0.02,
        conductivity: 55.0,
        capacity: 7800.0 * 460.0,
        surface_transfer: 0.0,
        volume_transfer: 0.0,
        base: Base::Held,
        cooling: crate::heat::slab::CoolingPort::Surface,
    };
    for velocity in [0.0, 1e-3, 0.5] {
        body.prepare(1e9, [velocity; 2]);
        let spacing = 2.0 * std::f64::consts::PI / length;
        let phase = |i: usize| 3.0 * spacing * cells.centres()[i];
        // Response to exp(i q x): the sum over n = 3 + k N of sinc^2 Z(q_n, -i q_n v).
        let exact: nalgebra::Complex<f64> = (-2000..=2000)
            .map(|k| {
                let q = spacing * f64::from(3 + k * count as i32);
                let half = 0.5 * q * length / count as f64;
                let s = nalgebra::Complex::new(0.0, -q * velocity);
                slab.impedance(s, q) * (half.sin() / half).powi(2)
            })
            .sum();
        let gains = &body.gains(Stage::End).temperature;
        for i in 0..count {
            let computed: f64 = (0..count).map(|j| gains[(i, j)] * phase(j).cos()).sum();
            let expected = exact.re * phase(i).cos() - exact.im * phase(i).sin();
            assert!((computed - expected).abs() < 1e-4 * exact.norm(), "{velocity} {i}: {computed} {expected}");
        }
    }
}

#[test]
fn one_way_on_fresh_material_is_the_moving_source_at_every_speed() {
    let cells = Cells::graded(1.0, 33).unwrap();
    for (height, base, layer) in [
        (40.0, Base::Held, LayerBase::Held),
        (0.4, Base::Held, LayerBase::Held),
        (2.0, Base::Insulated, LayerBase::Insulated),
    ] {
        let properties = unit(height, base, Path::OneWay);
        let resolution = Resolution { duration: 1e4, shortest: 0.1, tolerance: 1e-3, way: f64::INFINITY };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        println!("{:?} period {} {} states error {:.1e}", body.size(), body.period(), body.states(), body.error());
        for peclet in [0.05, 0.2, 1.0, 5.0, 100.0, 1e4, 1e6] {
            body.prepare(1e7, [2.0 * peclet; 2]);
            let gains = &body.gains(Stage::End).temperature;
            let answer: Vec<f64> = (0..33).map(|i| gains.row(i).sum()).collect();
            let exact = band_mean(peclet, Some((height, layer)));
            println!("{height} {base:?} {peclet} {:.1e}", mean(&cells, &answer) / exact - 1.0);
            // Slower than this a band is not steady within the duration.
            if peclet > 0.1 {
                let bound = if peclet < 1.0 { 2e-3 } else { 3e-4 };
                assert!((mean(&cells, &answer) / exact - 1.0).abs() < bound, "{height} {peclet}");
            }
        }
    }
}

#[test]
fn one_way_starts_like_a_band_at_rest_and_ends_like_a_moving_one() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let resolution = Resolution { duration: 400.0, shortest: 0.02, tolerance: 1e-3, way: f64::INFINITY };
    for peclet in [0.1, 1.0, 10.0] {
        let mut one_way = StripHeat::new(&unit(40.0, Base::Held, Path::OneWay), &cells, &resolution).unwrap();
        // The exact transient: a closed path that the contact does not go round within the time.
        let round = Path::Closed(600.0);
        let mut exact = StripHeat::new(&unit(40.0, Base::Held, round), &cells, &resolution).unwrap();
        let (mut state, mut reference) = (vec![0.0; one_way.states()], vec![0.0; exact.states()]);
        let steady = band_mean(peclet, Some((40.0, LayerBase::Held)));
        for (step, steps) in [(0.02, 5), (0.1, 5), (0.4, 5), (2.0, 5)] {
            let computed = mean(&cells, &march(&mut one_way, &mut state, step, steps, |_| 2.0 * peclet));
            let expected = mean(&cells, &march(&mut exact, &mut reference, step, steps, |_| 2.0 * peclet));
            println!("Pe {peclet} step {step}: {computed} {expected} {:.1e}", (computed - expected) / steady);
            assert!((computed - expected).abs() < 0.02 * steady, "{peclet} {step}: {computed} {expected}");
        }
    }
}

#[test]
fn two_bodies_in_perfect_contact_even_out_at_every_speed_and_step() {
    // Steel at rest on a glass ceramic that turns: whatever the start, the flux between them dies away.
    let count = 8;
    let length = 0.0754;
    let cells = Cells::uniform(0.5 * length, count).unwrap();
    let resolution = Resolution { duration: 200.0, shortest: 0.2, tolerance: 1e-4, way: f64::INFINITY };
    let body = |conductivity: f64, capacity: f64, path: Path| {
        let properties = StripProperties {
            height: 0.05,
            conductivity,
            capacity,
            convection: 0.0,
            base: Base::Held,
            path,
            expansion: None,
        };
        StripHeat::new(&properties, &cells, &resolution).unwrap()
    };
    for path in [Path::Closed(length), Path::Closed(2.0 * length), Path::OneWay] {
        let (mut still, mut moving) = (body(55.0, 3.588e6, Path::Closed(length)), body(1.46, 1.991e6, path));
        for velocity in [0.01, 0.05, 0.5] {
            for step in [1e-3, 3e-3, 1e-2, 0.1] {
                still.prepare(step, [0.0; 2]);
                moving.prepare(step, [velocity; 2]);
                let (mut own, mut other) = (vec![0.0; still.states()], vec![0.0; moving.states()]);
                let air = Surroundings::default();
                let mut sizes = Vec::new();
                for number in 0..60 {
                    let mut fluxes = [vec![0.0; count], vec![0.0; count]];
                    for (s, stage) in [Stage::First, Stage::End].into_iter().enumerate() {
                        let [mut here, mut there, mut moved] = [0; 3].map(|_| vec![0.0; count]);
                        let back: Vec<f64> = fluxes[0].iter().map(|q| -q).collect();
                        still.base(&own, &air, stage, &fluxes[0], &mut here, &mut moved);
                        moving.base(&other, &air, stage, &back, &mut there, &mut moved);
                        // A jump between the surfaces in the first step only.
                        let jump = |i: usize| if number == 0 { [1.0, -0.3, 0.7][i % 3] } else { 0.0 };
                        let difference = nalgebra::DVector::from_fn(count, |i, _| there[i] - here[i] + jump(i));
                        let both = &still.gains(stage).temperature + &moving.gains(stage).temperature;
                        fluxes[s] = both.lu().solve(&difference).unwrap().iter().copied().collect();
                    }
                    let back = fluxes.each_ref().map(|flux| flux.iter().map(|q| -q).collect::<Vec<f64>>());
                    still.advance(&mut own, &air, &fluxes[0], &fluxes[1]);
                    moving.advance(&mut other, &air, &back[0], &back[1]);
                    sizes.push(fluxes[1].iter().fold(0.0, |most: f64, q| most.max(q.abs())));
                }
                let (first, last) = (sizes[0], sizes[59]);
                assert!(last < 0.1 * first, "{path:?} {velocity} m/s, {step} s: {first:e} W/m2 became {last:e}");
            }
        }
    }
}

#[test]
fn answers_do_not_depend_on_when_they_were_found() {
    let cells = Cells::graded(0.03, 9).unwrap();
    let resolution = Resolution { duration: 100.0, shortest: 0.1, tolerance: 1e-2, way: f64::INFINITY };
    for path in [Path::OneWay, Path::Stroke { stroke: 0.02, length: 0.0 }] {
        let properties = StripProperties { convection: 0.2, ..unit(0.5, Base::Held, path) };
        let strip = || StripHeat::new(&properties, &cells, &resolution).unwrap();
        let gains = |body: &mut StripHeat, velocity: f64| {
            body.prepare(0.3, [velocity; 2]);
            body.gains(Stage::End).clone()
        };
        let [mut planned, mut asked, mut fast] = [strip(), strip(), strip()];
        planned.expect(900.0);
        let velocities = [0.0, 3.0, -40.0, 800.0];
        let expected = velocities.map(|velocity| gains(&mut planned, velocity));
        // The fastest first, and from a copy that shares what is found.
        let mut copy = fast.clone();
        gains(&mut copy, 800.0);
        for (velocity, expected) in velocities.into_iter().zip(&expected) {
            assert_eq!(&gains(&mut asked, velocity), expected, "{path:?} {velocity}");
            assert_eq!(&gains(&mut fast, velocity), expected, "{path:?} {velocity}");
        }
    }
}

#[test]
fn a_step_that_was_prepared_before_has_the_same_answer_to_the_bit() {
    let cells = Cells::graded(0.02, 9).unwrap();
    let properties = StripProperties {
        expansion: expanding(0.3, crate::elastic::Base::Bonded),
        ..steel(0.02, Base::Held, Path::Stroke { stroke: 0.05, length: 0.0 }, 30.0)
    };
    let resolution = Resolution { duration: 10.0, shortest: 0.02, tolerance: 1e-2, way: f64::INFINITY };
    let body = || StripHeat::new(&properties, &cells, &resolution).unwrap().for_few_steps(0.1);
    let steps = [(0.05, [0.1, 0.2]), (0.01, [0.2, -0.1]), (0.05, [0.1, 0.2]), (0.05, [0.1, 0.1]), (0.01, [0.2, -0.1])];
    let flux = uneven(&cells, 1);
    let air = Surroundings::default();
    let run = |body: &mut StripHeat| -> (Vec<f64>, Vec<Gains>) {
        let mut state = vec![0.0; body.states()];
        let mut gains = Vec::new();
        for (length, velocity) in steps {
            body.prepare(length, velocity);
            gains.extend([Stage::First, Stage::End].map(|stage| body.gains(stage).clone()));
            body.advance(&mut state, &air, &flux, &flux);
        }
        (state, gains)
    };
    // A copy finds all of its steps prepared; the other body none, because it keeps none.
    let mut first = body();
    let mut copy = first.clone();
    let mut other = body();
    Arc::get_mut(&mut other.operators).unwrap().kept = None;
    let found = run(&mut first);
    assert!(found.0.iter().any(|value| *value != 0.0));
    assert_eq!(found, run(&mut copy));
    assert_eq!(found, run(&mut other));
}

#[test]
fn the_way_back_has_the_answers_of_the_way_there_mirrored() {
    let cells = Cells::graded(0.02, 9).unwrap();
    let material = Material::new(2e11, 0.3).unwrap();
    let resolution = Resolution { duration: 10.0, shortest: 0.02, tolerance: 1e-2, way: f64::INFINITY };
    for path in [Path::Closed(0.3), Path::Stroke { stroke: 0.05, length: 0.0 }] {
        let properties = StripProperties {
            height: 0.02,
            conductivity: 55.0,
            capacity: 7800.0 * 460.0,
            convection: 500.0,
            base: Base::Convecting(300.0),
            path,
            expansion: Some(Expansion { material, coefficient: 1.1e-5, base: elastic::Base::Bonded }),
        };
        let body = || StripHeat::new(&properties, &cells, &resolution).unwrap().for_few_steps(0.1);
        let (mut mirrored, mut found) = (body(), body());
        Arc::get_mut(&mut found.operators).unwrap().kept = None;
        let (flux, air) = (uneven(&cells, 1), Surroundings { ambient: 3.0, ..Surroundings::default() });
        let run = |body: &mut StripHeat| -> (Vec<f64>, Vec<f64>) {
            let (mut state, mut seen) = (vec![0.0; body.states()], Vec::new());
            for velocity in [[0.1, 0.2], [0.2, 0.0], [0.0, -0.2], [-0.2, 0.1], [-0.1, -0.2], [-0.2, 0.0]] {
                body.prepare(0.05, velocity);
                for stage in [Stage::First, Stage::End] {
                    let (mut warm, mut moved) = (vec![0.0; 9], vec![0.0; 9]);
                    body.base(&state, &air, stage, &flux, &mut warm, &mut moved);
                    let gains = body.gains(stage);
                    let scale = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    for values in [gains.temperature.as_slice(), gains.distortion.as_slice(), &warm, &moved] {
                        let largest = scale(values).max(f64::MIN_POSITIVE);
                        seen.extend(values.iter().map(|value| value / largest));
                    }
                }
                body.advance(&mut state, &air, &flux, &flux);
            }
            (state, seen)
        };
        let (there, other) = (run(&mut mirrored), run(&mut found));
        let largest = other.0.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(there.0.iter().zip(&other.0).all(|(one, other)| (one - other).abs() < 1e-11 * largest), "{path:?}");
        for (place, (one, other)) in there.1.iter().zip(&other.1).enumerate() {
            assert!((one - other).abs() < 1e-9, "{path:?} {place}: {one} {other}");
        }
        // Two of the six steps are mirrored ones of others.
        assert_eq!(mirrored.operators.kept.as_ref().unwrap().count(), 4, "{path:?}");
    }
}

#[test]
fn a_short_way_on_fresh_material_needs_no_long_period() {
    let (width, velocity, duration) = (0.04, 0.4, 0.2);
    let cells = Cells::graded(0.5 * width, 9).unwrap();
    // The exact transient: a closed path that the contact does not go round within the time.
    let paths =
        [(Path::Closed(1.0), f64::INFINITY), (Path::OneWay, f64::INFINITY), (Path::OneWay, velocity * duration)];
    let [exact, long, short] = paths.map(|(path, way)| {
        let resolution = Resolution { duration, shortest: 1e-3 * duration, tolerance: 1e-3, way };
        let mut body = StripHeat::new(&steel(0.02, Base::Held, path, 0.0), &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        let middle = march(&mut body, &mut state, 0.02 * duration, 25, |_| velocity);
        (body.period(), [middle, march(&mut body, &mut state, 0.02 * duration, 25, |_| velocity)])
    });
    assert!(short.0 < 0.5 * long.0, "{} {}", short.0, long.0);
    let error = |found: &[Vec<f64>; 2]| -> f64 {
        let peak = exact.1[1].iter().copied().fold(0.0, f64::max);
        let apart = found.iter().flatten().zip(exact.1.iter().flatten()).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max) / peak
    };
    println!("short {:.1e}, long {:.1e}", error(&short.1), error(&long.1));
    assert!(error(&short.1) < error(&long.1) && error(&short.1) < 1e-2, "{:e} {:e}", error(&short.1), error(&long.1));
}
