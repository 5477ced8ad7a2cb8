use super::*;

/// Influence matrices of a punch and of a strip, the latter asymmetric with the direction of sliding.
fn bodies(count: usize) -> [SurfaceInfluence; 2] {
    [(2.0, 0.0), (1.0, 0.05)].map(|(scale, skew)| SurfaceInfluence {
        temperature: DMatrix::from_fn(count, count, |i, j| {
            let distance = i as f64 - j as f64;
            scale * ((-0.7 * distance.abs()).exp() + if i == j { 0.1 } else { skew * distance.signum() })
        }),
        distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
    })
}

#[test]
fn both_laws_hold_on_the_cells_in_contact() {
    let count = 7;
    let [punch, strip] = bodies(count);
    let rise = |influence: &SurfaceInfluence, q: &[f64], i: usize| {
        (0..count).map(|j| influence.temperature[(i, j)] * q[j]).sum::<f64>()
    };
    let base = [[3.0, 1.0, 9.0, 2.0, 0.0, -1.0, 5.0], [0.5; 7]];
    for closed in [[true; 7], [true, true, false, true, true, true, false]] {
        let heat: Vec<f64> = (0..7).map(|i| if closed[i] { 4.0 + i as f64 } else { 0.0 }).collect();
        for conductance in [0.3, 1e9] {
            let mut partition = HeatPartition::new(&vec![1.0; count], conductance);
            partition.build((1.0, 0.0, [Scales::ONE; 2]), &ContactParts::whole(count), [Some(&punch), Some(&strip)]);
            partition.set_active_set(&closed);
            // From any initial flux one correction by the residual gives the solution.
            let mut q1: Vec<f64> = (0..7).map(|i| if closed[i] { 1.0 - i as f64 } else { 0.0 }).collect();
            let residual = |q1: &[f64]| -> Vec<f64> {
                let q2: Vec<f64> = (0..7).map(|i| heat[i] - q1[i]).collect();
                (0..7)
                    .map(|i| {
                        let jump = base[1][i] + rise(&strip, &q2, i) - base[0][i] - rise(&punch, q1, i);
                        jump + 0.5 * (q2[i] - q1[i]) / conductance
                    })
                    .collect()
            };
            let found = residual(&q1);
            partition.exchange(&found, &mut q1);
            let found = residual(&q1);
            for i in 0..7 {
                assert!(if closed[i] { found[i].abs() < 1e-12 } else { q1[i] == 0.0 }, "{conductance} {i}");
            }
        }
    }
}

#[test]
fn the_reduction_makes_the_extra_compliance_that_of_cells_which_exchange_no_heat() {
    let count = 9;
    let [punch, strip] = bodies(count);
    let ratio: Vec<f64> = (0..count).map(|i| 1.0 + 0.1 * i as f64).collect();
    let per_pressure = 0.7;
    for open in [vec![], vec![8], vec![0, 3, 8]] {
        let closed: Vec<bool> = (0..count).map(|i| !open.contains(&i)).collect();
        let pressure: Vec<f64> = (0..count).map(|i| if closed[i] { 2.0 + i as f64 } else { 0.0 }).collect();
        let heat: Vec<f64> = (0..count).map(|i| per_pressure * ratio[i] * pressure[i]).collect();
        for conductance in [0.3, 1e9] {
            let mut partition = HeatPartition::new(&ratio, conductance);
            partition.build((1.0, 0.0, [Scales::ONE; 2]), &ContactParts::whole(count), [Some(&punch), Some(&strip)]);
            partition.set_active_set(&closed);
            assert!(partition.is_exact_with(open.len()));
            assert!(partition.thermal_compliance(per_pressure));
            let mut q1 = vec![0.0; count];
            partition.add_punch_flux_exactly(&heat, &mut q1);
            // Both interface laws, and zero flux on open cells.
            let sum = |influence: &DMatrix<f64>, q: &[f64], i: usize| {
                (0..count).map(|j| influence[(i, j)] * q[j]).sum::<f64>()
            };
            let q2: Vec<f64> = heat.iter().zip(&q1).map(|(heat, q)| heat - q).collect();
            let mut apart = partition.open_temperature_jump().iter();
            for i in 0..count {
                let jump = sum(&punch.temperature, &q1, i) - sum(&strip.temperature, &q2, i);
                if !closed[i] {
                    assert_eq!([q1[i], q2[i]], [0.0; 2]);
                    assert!((jump - apart.next().unwrap()).abs() < 1e-12, "{open:?} {conductance} {i}");
                    continue;
                }
                assert!((jump - 0.5 * (q2[i] - q1[i]) / conductance).abs() < 1e-12, "{open:?} {conductance} {i}");
            }
            let mut moved = vec![0.0; count];
            partition.add_displacement(true, &pressure, &mut moved);
            for i in 0..count {
                let direct = sum(&punch.distortion, &q1, i) + sum(&strip.distortion, &q2, i);
                assert!((moved[i] / direct - 1.0).abs() < 1e-12, "{open:?} {conductance} {i}: {} {direct}", moved[i]);
            }
        }
    }
}

#[test]
fn operators_through_parts_are_those_built_anew_with_their_diagonal() {
    for (count, in_part) in [(9, vec![3]), (33, vec![0, 7, 8, 32]), (33, vec![])] {
        let [punch, strip] = bodies(count);
        let mut parts = ContactParts::whole(count);
        let [mut diagonal, mut through] = [punch.clone(), punch.clone()];
        for &k in &in_part {
            parts.set(k, [0.0, 0.375, 1.0, 1.0]);
            diagonal.temperature[(k, k)] += 0.3;
            for j in 0..count {
                let more = 0.3 * (-0.5 * (k as f64 - j as f64).abs()).exp();
                through.temperature[(j, k)] += more;
                through.distortion[(j, k)] += 0.7 * more;
                if j != k {
                    through.temperature[(k, j)] += 1.1 * more;
                }
            }
        }
        let key = (0.2, 1.0, [Scales::ONE; 2]);
        let new = || HeatPartition::new(&vec![1.0; count], 0.7);
        let mut updated = new().with_parts();
        updated.build_whole(key, [Some(&punch), Some(&strip)]);
        // From other parts before.
        let mut others = ContactParts::whole(count);
        others.set(5, [0.0, 0.0, 1.0, 0.5]);
        assert!(updated.set_parts(&others, &through) && updated.set_parts(&parts, &through));
        let mut anew = new();
        anew.build(key, &parts, [Some(&diagonal), Some(&strip)]);
        assert!(updated.is_for(key, &parts));
        let pairs = [
            (&updated.operators.inverse, &anew.operators.inverse),
            (&updated.operators.shares, &anew.operators.shares),
            (&updated.operators.relative_distortion, &anew.operators.relative_distortion),
            (&updated.operators.distortion, &anew.operators.distortion),
        ];
        for (own, exact) in pairs {
            let scale = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let error = own.iter().zip(exact).fold(0.0_f64, |most, (own, exact)| most.max((own - exact).abs()));
            assert!(error < 1e-12 * scale, "{in_part:?} of {count}: {error:e} of {scale:e}");
        }
        let mut most = ContactParts::whole(count);
        (0..count).for_each(|cell| most.set(cell, [0.0, 1.0, 1.0, 1.0]));
        assert!(!updated.set_parts(&most, &through) && updated.is_for(key, &parts));
    }
}
