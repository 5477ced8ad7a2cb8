//! Comparison with exact solutions. Jaeger's moving band, the oscillating one and a heated half-plane are problems of `verification`.

use super::{cast_iron, expanding, march, mean, steel, unit};
use crate::line::strip::{Resolution, SlidingPath, StripHeat, StripProperties};
use crate::line::{GAMMA, Observed, Stage, Step, Surroundings, ThermalBody};
use crate::slab::Slab;
use elasticity::Cells;
use exact::reference::{ClosedPath, LayerBase, band_mean, band_on_fresh_material};
use nalgebra::{DMatrix, DVector};
use scene::FarBoundary;
use std::f64::consts::PI;

#[test]
fn closed_path_steady_means_are_the_plain_fourier_sum() {
    for (base, layer) in [(FarBoundary::Held, LayerBase::Held), (FarBoundary::Insulated, LayerBase::Insulated)] {
        let exact = ClosedPath {
            length: 0.74,
            half_length: 0.0475,
            height: 0.011,
            conductivity: 54.0,
            diffusivity: 54.0 / (7200.0 * 460.0),
            base: layer,
        };
        let properties = cast_iron(0.011, base, SlidingPath::Closed(0.74));
        let cells = Cells::graded(0.0475, 33).unwrap();
        let resolution = Resolution { duration: 1000.0, shortest: 0.01, travel: f64::INFINITY, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        println!("{:?} {} states, error {:.1e}", body.size(), body.states(), body.operators.error);
        for velocity in [0.0, 1e-4, 0.01, 1.0, -1.0, 30.0] {
            // In a step much longer than every decay time but the mean's, the response is the steady one.
            let step = 1e9;
            body.prepare(&Step::new(step, [velocity, velocity]));
            let influence = body.influence(Stage::End).temperature.clone();
            let response: Vec<f64> = (0..33).map(|i| influence.row(i).sum()).collect();
            let [level, _] = body.mean_levels(
                &vec![0.0; body.states()],
                &Surroundings::default(),
                &body.step.end,
                [0.0, 2.0 * 0.0475 / 0.74],
            );
            let computed = mean(&cells, &response) - level;
            let steady = exact.steady_mean(velocity, 200_000);
            println!("{base:?} {velocity}: {computed:e} {steady:e} {:.1e}", computed / steady - 1.0);
            assert!((computed / steady - 1.0).abs() < 1e-4, "{base:?} {velocity}: {computed} {steady}");
        }
    }
}

/// Convection on the whole top, and what is lost under the contact given back there: `T = G (q + H0 T)`, G by the plain sum over the
/// waves of a layer that is cooled everywhere. At a tolerance of 1e-2 most of the rise is direct feedthrough.
#[test]
fn convection_takes_no_heat_from_under_a_moving_contact() {
    let (count, width, length) = (40, 0.095, 0.738);
    let cells = Cells::uniform(0.5 * width, count).unwrap();
    let resolution = Resolution { duration: 3e3, shortest: 3.0, travel: f64::INFINITY, tolerance: 1e-2 };
    for (convection, velocity) in [(20.0, 3.0), (2e3, 3.0), (2e3, 0.1), (2e3, 20.0), (2e5, 3.0)] {
        let properties = steel(0.011, FarBoundary::Held, SlidingPath::Closed(length), convection);
        let cell = width / count as f64;
        let mut kernel = vec![0.0; 2 * count - 1];
        for n in 0..20_000 {
            let q = 2.0 * PI * f64::from(n) / length;
            let half = (0.5 * q * cell).max(1e-9);
            let impedance = properties.slab.impedance(nalgebra::Complex::new(0.0, -q * velocity), q);
            let share = if n == 0 { 1.0 } else { 2.0 } * cell / length * (half.sin() / half).powi(2);
            for (k, gain) in kernel.iter_mut().enumerate() {
                let turned = nalgebra::Complex::from_polar(1.0, q * cell * (k as f64 + 1.0 - count as f64));
                *gain += share * (impedance * turned).re;
            }
        }
        let cooled = nalgebra::DMatrix::from_fn(count, count, |i, j| kernel[i + count - 1 - j]);
        let rise = &cooled * nalgebra::DVector::from_element(count, 1.0);
        let exact = (nalgebra::DMatrix::identity(count, count) - convection * cooled).lu().solve(&rise).unwrap();
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        body.prepare(&Step::new(1e9, [velocity; 2]));
        let influence = &body.influence(Stage::End).temperature;
        let found: Vec<f64> = (0..count).map(|i| influence.row(i).sum()).collect();
        let error = mean(&cells, &found) / exact.mean() - 1.0;
        println!("{convection} {velocity}: {error:.1e}");
        assert!(error.abs() < 1e-4, "{convection} W/(m2 K), {velocity} m/s: {error:.1e}");
    }
}

#[test]
fn half_space_at_short_times() {
    // Far from the edges of a wide contact at rest: 84.375 K after 1 s of 1 MW/m2.
    let properties = cast_iron(0.1, FarBoundary::Insulated, SlidingPath::Closed(0.5));
    let cells = Cells::graded(0.1, 33).unwrap();
    let resolution = Resolution { duration: 1.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-4 };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let mut state = vec![0.0; body.states()];
    let temperature = march(&mut body, &mut state, 0.02, 50, |_| 0.0);
    println!("{} states error {:.1e} {}", body.states(), body.operators.error, temperature[16] * 1e6);
    assert!((temperature[16] * 1e6 - 84.375).abs() < 84.375e-4, "{}", temperature[16] * 1e6);
}

/// Every mode of a pin on a disk decays faster than its shortest time, so most of its response is the static correction.
#[test]
fn the_stated_error_of_a_short_contact_is_that_of_its_temperature() {
    let lateral = Some(crate::lateral::Lateral::new(2e-3, 55.0 / (7800.0 * 460.0)));
    let properties = StripProperties { lateral, ..steel(0.01, FarBoundary::Held, SlidingPath::Closed(0.1), 10.0) };
    let cells = Cells::graded(1e-3, 17).unwrap();
    let after = |steps: usize, shortest: f64| {
        let resolution = Resolution { duration: 1e4, shortest, travel: f64::INFINITY, tolerance: 1e-3 };
        let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
        let mut state = vec![0.0; body.states()];
        let temperature = march(&mut body, &mut state, 10.0 / steps as f64, steps, |_| 0.0);
        (mean(&cells, &temperature), body.operators.error, body.states())
    };
    let [(coarse, error, states), (fine, _, more)] = [after(1, 10.0), after(200, 0.05)];
    let apart = (coarse / fine - 1.0).abs();
    println!("{states} and {more} states: apart by {apart:.1e}, stated {error:.1e}");
    assert!(states < more && apart < 3.0 * error && error < 5e-4, "{apart} and {error}");
}

#[test]
fn full_periodic_contact_is_the_layer_wave_by_wave() {
    // A harmonic flux on the ring: its cell values contain only the aliases n, N - n, N + n, ... of one wave.
    let length = 0.2;
    let mut properties = steel(0.02, FarBoundary::Held, SlidingPath::Closed(length), 0.0);
    properties.expansion = expanding(0.3, elasticity::Base::Bonded);
    let count = 32;
    let cells = Cells::uniform(0.5 * length, count).unwrap();
    let resolution = Resolution { duration: 1e3, shortest: 0.01, travel: f64::INFINITY, tolerance: 1e-4 };
    let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
    let slab = crate::slab::Slab::bare(0.02, [55.0, 7800.0 * 460.0], FarBoundary::Held);
    for velocity in [0.0, 1e-3, 0.5] {
        body.prepare(&Step::new(1e9, [velocity; 2]));
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
        let influence = &body.influence(Stage::End).temperature;
        for i in 0..count {
            let computed: f64 = (0..count).map(|j| influence[(i, j)] * phase(j).cos()).sum();
            let expected = exact.re * phase(i).cos() - exact.im * phase(i).sin();
            assert!((computed - expected).abs() < 1e-4 * exact.norm(), "{velocity} {i}: {computed} {expected}");
        }
    }
}

#[test]
fn unidirectional_starts_like_a_band_at_rest_and_ends_like_a_moving_one() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let resolution = Resolution { duration: 400.0, shortest: 0.02, travel: f64::INFINITY, tolerance: 1e-3 };
    for peclet in [0.1, 1.0, 10.0] {
        let mut unidirectional =
            StripHeat::new(&unit(40.0, FarBoundary::Held, SlidingPath::Unidirectional), &cells, &resolution).unwrap();
        // Exact transient: a closed path that the contact does not complete within the time.
        let round = SlidingPath::Closed(600.0);
        let mut exact = StripHeat::new(&unit(40.0, FarBoundary::Held, round), &cells, &resolution).unwrap();
        let (mut state, mut reference) = (vec![0.0; unidirectional.states()], vec![0.0; exact.states()]);
        let steady = band_mean(peclet, Some((40.0, LayerBase::Held)));
        for (step, steps) in [(0.02, 5), (0.1, 5), (0.4, 5), (2.0, 5)] {
            let computed = mean(&cells, &march(&mut unidirectional, &mut state, step, steps, |_| 2.0 * peclet));
            let expected = mean(&cells, &march(&mut exact, &mut reference, step, steps, |_| 2.0 * peclet));
            println!("Pe {peclet} step {step}: {computed} {expected} {:.1e}", (computed - expected) / steady);
            assert!((computed - expected).abs() < 0.02 * steady, "{peclet} {step}: {computed} {expected}");
        }
    }
}

/// Means over the cells after 40 steps of 0.05 with this velocity and uniform flux, linear over each step.
fn run(mut body: StripHeat, cells: &Cells, velocity: impl Fn(f64) -> f64, flux: impl Fn(f64) -> f64) -> Vec<f64> {
    let (count, air, mut work) = (cells.count(), Surroundings::default(), body.workspace());
    let (mut state, mut after) = (vec![0.0; body.states()], vec![0.0; body.states()]);
    let (mut temperature, mut distortion) = (vec![0.0; count], vec![0.0; count]);
    let step = 0.05;
    let mut means = Vec::new();
    for k in 0..40 {
        let start = step * f64::from(k);
        body.prepare(&Step::new(step, [velocity(start), velocity(start + step)]));
        let [before, first, own] = [0.0, GAMMA * step, step].map(|t| vec![flux(start + t); count]);
        let deviation = vec![before[0] - first[0]; count];
        let begun = body.first(&state, &air, &deviation, [&mut temperature, &mut distortion], &mut work);
        let ended = body.end(begun, &state, &air, &first, [&mut temperature, &mut distortion], &mut work);
        let influence = &body.influence(Stage::End).temperature;
        (0..count).for_each(|i| temperature[i] += influence.row(i).sum() * own[0]);
        body.advance(ended, (&state, &mut after), &air, [&first, &own], &mut work);
        std::mem::swap(&mut state, &mut after);
        means.push(mean(cells, &temperature));
    }
    means
}

/// Whatever the contact does within the width of its own trail: slides at any speed, stops, creeps on, starts again, turns.
#[test]
fn an_endless_path_is_a_band_on_fresh_material_at_every_time() {
    let cells = Cells::graded(1.0, 17).unwrap();
    let (end, fine) = (2.0, 20_000);
    let ramp = |t: f64| (10.0 * t).clamp(0.0, 1.0);
    for nominal in [0.2, 2.0, 20.0, 200.0, 2e4] {
        // With the heat of friction, or with as much at rest.
        let drives: [(&dyn Fn(f64) -> f64, f64); 6] = [
            (&|_| 1.0, 1.0),
            (&|t: f64| ramp(1.0 - t), 0.0),
            (&|t: f64| 0.03 + 0.97 * ramp(1.0 - t), 0.0),
            (&|t: f64| ramp(0.5 - t) + ramp(t - 1.0), 0.0),
            (&|t: f64| ramp(0.5 - t) + ramp(t - 1.0), 1.0),
            // To and fro over what the contact remembers.
            (&|t: f64| (10.0 * (1.0 - t)).clamp(-1.0, 1.0), 1.0),
        ];
        for (number, (part, hot)) in drives.iter().enumerate() {
            let nominal = if number == 5 { f64::min(nominal, 3.0) } else { nominal };
            let (velocity, flux) = (|t: f64| nominal * part(t), |t: f64| hot + (1.0 - hot) * part(t));
            let mut way = vec![0.0];
            for k in 0..fine {
                let t = end * (f64::from(k) + 0.5) / f64::from(fine);
                way.push(way[way.len() - 1] + velocity(t) * end / f64::from(fine));
            }
            let position = |t: f64| {
                let x = (t / end * f64::from(fine)).clamp(0.0, f64::from(fine) - 1e-9);
                let (k, part) = (x as usize, x.fract());
                way[k] + part * (way[k + 1] - way[k])
            };
            let exact: Vec<f64> =
                (1..=40).map(|k| band_on_fresh_material(position, flux, 0.05 * f64::from(k))).collect();
            let largest = exact.iter().copied().fold(0.0, f64::max);
            for tolerance in [1e-1, 1e-2, 1e-3] {
                let resolution = Resolution { duration: end, shortest: 2e-3, travel: nominal * end, tolerance };
                let properties = unit(400.0, FarBoundary::Held, SlidingPath::Unidirectional);
                let body = StripHeat::new(&properties, &cells, &resolution).unwrap();
                let (length, states) = (body.length(), body.states());
                let found = run(body, &cells, velocity, flux);
                let errors = found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs() / largest);
                let error = errors.fold(0.0, f64::max);
                println!("{nominal} {number} {tolerance:e}: {error:.1e}, period {length:.1}, {states} states");
                assert!(error < 0.5 * tolerance, "{nominal} {number} {tolerance:e}: {error:e}");
            }
        }
    }
}

/// Lengths of `count` cells that grow geometrically from `first` and fill `length`.
fn growing(count: i32, first: f64, length: f64) -> Vec<f64> {
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..60 {
        let ratio: f64 = 0.5 * (low + high);
        let filled: f64 = (0..count).map(|k| first * ratio.powi(k)).sum();
        *(if filled > length { &mut high } else { &mut low }) = ratio;
    }
    (0..count).map(|k| first * f64::powi(low, k)).collect()
}

/// Steady temperature, K, of the surface of a held layer at rest under a unit flux on |x| < 0.03 m, with convection beside it up to
/// |x| = 0.2 m: mean over the contact, and at `x`. Finite volumes on half of it, from the base up by the conductance of all that is below.
fn by_finite_volumes(conductivity: f64, height: f64, transfer: f64, x: f64) -> [f64; 2] {
    const HEATED: usize = 60;
    let size = 0.03 / HEATED as f64;
    let across = [vec![size; HEATED], growing(60, size, 0.17)].concat();
    let layers = growing(60, 2e-4, height);
    let count = across.len();
    let along = |layer: f64| {
        let mut matrix = DMatrix::zeros(count, count);
        for i in 1..count {
            let conductance = 2.0 * conductivity * layer / (across[i - 1] + across[i]);
            for (a, b, sign) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0), (i - 1, i, -1.0)] {
                matrix[(a, b)] += sign * conductance;
            }
        }
        matrix
    };
    let between =
        |distance: f64| DMatrix::from_diagonal(&DVector::from_vec(across.clone())) * (conductivity / distance);
    let mut below = between(0.5 * layers[layers.len() - 1]);
    for pair in layers.windows(2).rev() {
        let up = between(0.5 * (pair[0] + pair[1]));
        let inverse = (along(pair[1]) + below + &up).try_inverse().unwrap();
        below = &up - &up * inverse * &up;
    }
    let depth = 0.5 * layers[0] / conductivity;
    let mut matrix = along(layers[0]) + below;
    (HEATED..count).for_each(|i| matrix[(i, i)] += across[i] / (1.0 / transfer + depth));
    let heat = DVector::from_fn(count, |i, _| if i < HEATED { across[i] } else { 0.0 });
    let surface: Vec<f64> = matrix.lu().solve(&heat).unwrap().iter().take(HEATED).map(|t| t + depth).collect();
    let place = x / size - 0.5;
    let (i, part) = (place as usize, place.fract());
    [surface.iter().sum::<f64>() / HEATED as f64, (1.0 - part) * surface[i] + part * surface[i + 1]]
}

/// A contact does not convect. What four polynomials and eight miss of that is what [`RobinCorrection::rank`](super::super::robin_correction)
/// says; the finite volumes are within 3e-4.
#[test]
fn convection_beside_the_contact_is_that_of_finite_volumes() {
    let cells = Cells::graded(0.03, 33).unwrap();
    for transfer in [300.0, 3000.0] {
        let slab = Slab { surface_transfer: transfer, ..Slab::bare(0.05, [50.0, 3.6e6], FarBoundary::Held) };
        let exact = by_finite_volumes(50.0, 0.05, transfer, -cells.centres()[8]);
        for (tolerance, per_biot) in [(1e-2, 2e-3), (1e-5, 1e-4)] {
            let resolution = Resolution { duration: 1000.0, shortest: 0.01, travel: f64::INFINITY, tolerance };
            let properties = StripProperties::bare(slab, SlidingPath::Closed(0.4));
            let mut body = StripHeat::new(&properties, &cells, &resolution).unwrap();
            body.prepare(&Step::new(1e12, [0.0; 2]));
            let influence = &body.influence(Stage::End).temperature;
            let found: Vec<f64> = (0..33).map(|i| influence.row(i).sum()).collect();
            for (found, exact) in [mean(&cells, &found), found[8]].into_iter().zip(exact) {
                let error = (found / exact - 1.0).abs();
                assert!(error < 6e-4 + per_biot * transfer * 0.06 / 50.0, "{transfer} {tolerance}: {error:e}");
            }
        }
    }
}
