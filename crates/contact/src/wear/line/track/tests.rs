use super::*;
use crate::wear::line::{CellRate, Conditions, WearingContact};
use crate::{Normal, Tilt};
use elasticity::{ElasticBody, HalfPlane, Material, Winkler};
use test_support::Random;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Worn depth of a point of the strip after motions, each (x0, x1, depth per cell), by its definition.
fn brute_force(cells: &Cells, motions: &[(f64, f64, Vec<f64>)], point: f64) -> f64 {
    let part = |x0: f64, x1: f64, j: usize| {
        // Fraction of the time that the point is between the edges of the cell.
        let (low, high) = (cells.edges()[j], cells.edges()[j + 1]);
        let (from, to) = ((point - x0).min(point - x1), (point - x0).max(point - x1));
        if to == from {
            return if (low..high).contains(&from) { 1.0 } else { 0.0 };
        }
        ((to.min(high) - from.max(low)) / (to - from)).max(0.0)
    };
    motions.iter().flat_map(|(x0, x1, d)| d.iter().enumerate().map(move |(j, d)| part(*x0, *x1, j) * d)).sum()
}

#[test]
fn worn_volume_is_the_integral_of_the_law() {
    for (count, stroke) in [(1, 3.0), (9, 0.0), (33, 0.7), (129, 10.0), (33, 0.016)] {
        let cells = Cells::graded(1.0, count).unwrap();
        let mut track = LineTrack::new(&cells, stroke);
        let mut random = Random(count as u64);
        let (mut x, mut total) = (0.0, 0.0);
        for _ in 0..500 {
            let next = stroke.max(0.3) * random.next() + 1e-9 * random.next();
            let depth: Vec<f64> = (0..count).map(|_| 1e-6 * random.next()).collect();
            // Some motions are far shorter than a cell, and some have zero length.
            let next = [next, x + 1e-13, x][(3.0 * random.next().powi(3)) as usize];
            track.deposit(x, next, &depth);
            total += cells.integral(&depth);
            x = next;
        }
        let error = track.volume() / total - 1.0;
        assert!(error.abs() < 1e-12, "N {count} stroke {stroke}: {error:e}");
        assert!(!track.revisited());
    }
}

#[test]
fn shape_after_strokes_reciprocating_is_that_of_brute_force() {
    let cells = Cells::graded(0.5, 17).unwrap();
    let mut random = Random(3);
    let mut track = LineTrack::new(&cells, 1.7);
    let (mut motions, mut x): (Vec<(f64, f64, Vec<f64>)>, f64) = (Vec::new(), 0.0);
    for step in 0..60 {
        let sign = if step % 20 < 10 { 1.0 } else { -1.0 };
        let next = x + sign * (0.1 + 0.07 * random.next());
        let depth: Vec<f64> = (0..17).map(|i| 1e-6 * (1.0 + (0.3 * i as f64).sin() + random.next())).collect();
        track.deposit(x, next, &depth);
        motions.push((x, next, depth));
        x = next;
    }
    // Means of the track's cells.
    let mut largest: f64 = 0.0;
    for k in (track.first..track.first + track.count as i64).step_by(7) {
        let points = 400;
        let at = |m: usize| (k as f64 + (m as f64 + 0.5) / points as f64) * track.cell;
        let exact = (0..points).map(|m| brute_force(&cells, &motions, at(m))).sum::<f64>() / points as f64;
        largest = largest.max((track.at(k) - exact).abs());
    }
    assert!(largest < 1e-11, "cell means: {largest:e}");
    // Mean depths under the contact, at positions unrelated to the track's cells.
    let mut worn = vec![0.0; 17];
    for position in [-0.2, 0.0, 0.4321, 1.1, x] {
        track.depth_under(position, &mut worn);
        for i in 0..17 {
            let points = 800;
            let at = |m: usize| position + cells.edges()[i] + cells.widths()[i] * (m as f64 + 0.5) / points as f64;
            let exact = (0..points).map(|m| brute_force(&cells, &motions, at(m))).sum::<f64>() / points as f64;
            // Depths are some 2e-5; where a point enters or leaves, W has kinks.
            assert!((worn[i] - exact).abs() < 2e-8, "position {position} cell {i}: {:e} {exact:e}", worn[i]);
        }
    }
}

#[test]
fn operator_is_the_depth_that_a_deposit_leaves() {
    for count in [1, 9, 33] {
        let cells = Cells::graded(1.0, count).unwrap();
        let mut random = Random(5);
        let mut operator = DMatrix::zeros(count, count);
        for travel in [0.0, 1e-12, 1e-4, -0.01, 0.1, -0.25, 0.25, 1.0, -1.9, 2.0, 2.7] {
            let mut track = LineTrack::new(&cells, 3.0);
            let depth: Vec<f64> = (0..count).map(|_| 1.0 + 0.01 * random.next()).collect();
            track.deposit(0.3, 0.3 + travel, &depth);
            let mut worn = vec![0.0; count];
            track.depth_under(0.3 + travel, &mut worn);
            track.operator(travel, &mut operator);
            let exact = &operator * nalgebra::DVector::from_column_slice(&depth);
            // Standstill leaves a jump of the depth at both edges, which a cell cannot resolve.
            let inner = if travel.abs() < 0.02 { 2..count.max(4) - 2 } else { 0..count };
            for i in inner.filter(|i| *i < count) {
                let error = worn[i] - exact[i];
                assert!(error.abs() < 4e-3, "N {count} travel {travel} cell {i}: {error:e} of {}", exact[i]);
            }
            // The sum of a row is the fraction of the time that the strip under the cell has been in contact.
            for i in 0..count {
                let sum: f64 = operator.row(i).sum();
                let (left, right) = (cells.edges()[i], cells.edges()[i + 1]);
                let ahead = |x: f64| if travel < 0.0 { 1.0 + x } else { 1.0 - x };
                let part = |x: f64| (ahead(x) / travel.abs()).min(1.0);
                let inside = ahead(left).min(ahead(right)) >= travel.abs();
                let expected = if inside { 1.0 } else { 0.5 * (part(left) + part(right)) };
                let kink = !inside && ahead(left).max(ahead(right)) > travel.abs();
                assert!(kink || (sum - expected).abs() < 1e-13, "N {count} travel {travel} row {i}: {sum} {expected}");
                assert!(operator.row(i).iter().all(|t| *t >= 0.0));
            }
        }
    }
}

#[test]
fn long_travel_is_the_operator_of_the_groove() {
    let cells = Cells::graded(1.0, 9).unwrap();
    let track = LineTrack::new(&cells, 0.0);
    let mut operator = DMatrix::zeros(9, 9);
    for travel in [2.5, -7.0] {
        track.operator(travel, &mut operator);
        for i in 0..9 {
            for j in 0..9 {
                let ahead = if travel > 0.0 { j > i } else { j < i };
                let exact = if i == j { 0.5 } else { f64::from(u8::from(ahead)) } * cells.widths()[j];
                assert!((operator[(i, j)] * f64::abs(travel) - exact).abs() < 1e-14, "{travel} {i} {j}");
            }
        }
    }
}

fn wearing(cells: &Cells, compliance: &DMatrix<f64>, operator: &DMatrix<f64>) -> WearingContact {
    let (count, shear) = (cells.count(), DMatrix::zeros(cells.count(), cells.count()));
    let mut contact = WearingContact::new(cells, cells.widths(), compliance.clone(), shear, vec![0.0; count]).unwrap();
    contact.set_operator(Some(operator));
    contact
}

#[test]
fn the_window_forgets_and_says_so() {
    let cells = Cells::graded(1.0, 9).unwrap();
    let mut track = LineTrack::new(&cells, 0.0);
    let depth = [1e-3; 9];
    for step in 0..400 {
        track.deposit(0.1 * f64::from(step), 0.1 * f64::from(step + 1), &depth);
    }
    let mut worn = [0.0; 9];
    track.depth_under(40.0, &mut worn);
    // One long motion leaves the same groove.
    let mut long = LineTrack::new(&cells, 0.0);
    long.deposit(0.0, 40.0, &[0.4; 9]);
    let mut again = [0.0; 9];
    long.depth_under(40.0, &mut again);
    assert!(difference(&worn, &again) < 1e-12, "{worn:?} {again:?}");
    assert!(!track.revisited() && !long.revisited());
    for track in [&mut track, &mut long] {
        track.deposit(40.0, 39.8, &depth);
        assert!(!track.revisited());
        track.deposit(39.8, 30.0, &depth);
        assert!(track.revisited());
    }
    // Kilometres in one motion: the end of them remains.
    long.deposit(30.0, 3e6, &[1.0; 9]);
    assert!(long.depth.iter().all(|d| d.is_finite() && *d >= 0.0) && long.volume() < 1e-2);
    long.deposit(3e6, 30.0, &[1.0; 9]);
    assert!(long.revisited() && long.volume() < 1e-2);
}

#[test]
fn averaging_keeps_the_volume_and_ends_with_the_stroke() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let mut track = LineTrack::new(&cells, 0.02);
    assert!(track.is_averaged() && track.longest_travel() == f64::INFINITY);
    let depth: Vec<f64> = cells.centres().iter().map(|x| 1e-6 * (2.0 + x)).collect();
    let volume = cells.integral(&depth);
    for stroke in 0..10 {
        let (from, to) = if stroke % 2 == 0 { (0.0, 0.02) } else { (0.02, 0.0) };
        track.deposit(from, to, &depth);
    }
    assert!((track.volume() / (10.0 * volume) - 1.0).abs() < 1e-12);
    let mut worn = vec![0.0; 33];
    track.depth_under(0.01, &mut worn);
    let mut saved = Vec::new();
    track.save(&mut saved);
    let averaged = track.clone();
    // A longer motion goes on from the same shape.
    track.deposit(0.0, 0.3, &vec![0.0; 33]);
    assert!(!track.is_averaged());
    assert!((track.volume() / (10.0 * volume) - 1.0).abs() < 1e-12);
    let mut resolved = vec![0.0; 33];
    track.depth_under(0.01, &mut resolved);
    assert!(difference(&worn, &resolved) < 2e-6, "{:e}", difference(&worn, &resolved));
    // Restored from the numbers and from a copy.
    let mut copy = track.clone();
    copy.copy_from(&averaged);
    assert!(copy.is_averaged() && copy.volume() == averaged.volume());
    track.load(&mut saved.iter()).unwrap();
    assert!(track.is_averaged() && track.volume() == averaged.volume());
}

#[test]
fn a_track_goes_on_from_its_numbers() {
    let cells = Cells::graded(1.0, 129).unwrap();
    let mut track = LineTrack::new(&cells, 10.0);
    let depth = vec![1e-6; 129];
    for step in 0..100 {
        track.deposit(0.2 * f64::from(step), 0.2 * f64::from(step + 1), &depth);
    }
    let mut numbers = Vec::new();
    track.save(&mut numbers);
    assert!(8 * numbers.len() < 80_000, "{} numbers", numbers.len());
    numbers.push(7.0);
    let mut other = LineTrack::new(&cells, 10.0);
    other.deposit(3.0, 9.0, &depth);
    let mut iterator = numbers.iter();
    other.load(&mut iterator).unwrap();
    assert_eq!(iterator.as_slice(), [7.0]);
    for track in [&mut track, &mut other] {
        track.deposit(20.0, 15.0, &depth);
    }
    assert_eq!(track, other);
    let mut copy = LineTrack::new(&cells, 10.0);
    copy.copy_from(&track);
    assert_eq!((&copy.depth, copy.discarded), (&track.depth, track.discarded));
    for length in [0, 3, 40, numbers.len() - 2] {
        assert!(other.load(&mut numbers[..length].iter()).is_none());
        assert_eq!(track, other);
    }
    numbers[40] = f64::NAN;
    assert!(other.load(&mut numbers.iter()).is_none());
}

/// Mean pressure over the last of 20 cycles of strokes about 0; over all cycles the strip wears by `wear` times the mean
/// pressure and 1/E*.
fn mean_pressure(cells: &Cells, body: &dyn ElasticBody, stroke: f64, wear: f64, averaged: bool) -> Vec<f64> {
    const CYCLES: usize = 20;
    const PARTS: usize = 16;
    let count = cells.count();
    let mut track = LineTrack::resolved(cells, stroke);
    track.averaged = averaged.then(|| Averaged::new(cells, stroke));
    track.averaging = averaged;
    let compliance = body.compliance(cells).normal;
    let mut contacts = [1.0, -1.0].map(|sign| {
        let mut operator = DMatrix::zeros(count, count);
        track.operator(sign * stroke / PARTS as f64, &mut operator);
        wearing(cells, &compliance, &operator)
    });
    let conditions = Conditions {
        signed_friction: 0.0,
        normal: Normal::Load(2.0),
        tilt: Tilt::Fixed(0.0),
        rate: CellRate::archard(wear, 1.0),
    };
    let (mut mean, mut worn, mut x) = (vec![0.0; count], vec![0.0; count], -0.5 * stroke);
    let step = 1.0 / (2 * PARTS * CYCLES) as f64;
    for cycle in 0..CYCLES {
        for half in 0..2 * PARTS {
            let side = half / PARTS;
            let to = x + [1.0, -1.0][side] * stroke / PARTS as f64;
            track.depth_under(to, &mut worn);
            let pressure = contacts[side].stage(&worn, step, &conditions).unwrap().pressure;
            let taken: Vec<f64> = pressure.iter().map(|p| step * wear * p).collect();
            track.deposit(x, to, &taken);
            x = to;
            if cycle + 1 == CYCLES {
                mean.iter_mut().zip(&pressure).for_each(|(m, p)| *m += p / (2 * PARTS) as f64);
            }
        }
    }
    mean
}

#[test]
fn error_of_averaging_is_the_stated_one() {
    let cells = Cells::graded(1.0, 33).unwrap();
    let half_plane = HalfPlane { material: Material::new(0.91, 0.3).unwrap() };
    let winkler = Winkler::new(2.0).unwrap();
    for (body, name, bound) in [(&half_plane as &dyn ElasticBody, "half-plane", 4e-3), (&winkler, "Winkler", 6e-4)] {
        for wear in [0.1, 1.0] {
            let errors = [0.2, AVERAGED_STROKE, 0.25 * AVERAGED_STROKE].map(|stroke| {
                let [resolved, averaged] =
                    [false, true].map(|averaged| mean_pressure(&cells, body, stroke, wear, averaged));
                let inner = (0..33).filter(|i| cells.centres()[*i].abs() < 0.8);
                inner.map(|i| (resolved[i] - averaged[i]).abs()).fold(0.0, f64::max)
            });
            assert!(errors[1].max(errors[2]) < bound, "{name}, worn {wear}: {errors:?}");
            // Longer strokes are outside the validity of averaging.
            assert!(errors[0] > 3.0 * errors[1], "{name}, worn {wear}: {errors:?}");
        }
    }
}
