//! Heat through parts of the cells.

use super::super::super::contact_parts::{ContactParts, PARTS};
use super::super::super::{Exchange, FaceInfluence, FrozenState, Observed, Stage, Step, ThermalBody};
use super::{Run, cells, largest, leaning, scene};
use nalgebra::DMatrix;

/// Cells 2, 4 and 6 of nine are partly in contact, cell 4 with a fraction of a part.
pub(super) fn in_part() -> ContactParts {
    let mut contact_parts = ContactParts::whole(9);
    contact_parts.set(2, [0.0, 1.0, 1.0, 1.0]);
    contact_parts.set(4, [1.0, 1.0, 0.375, 0.0]);
    contact_parts.set(6, [1.0, 0.0, 0.0, 0.0]);
    contact_parts
}

/// The same at the end of a step in which the edges move.
fn in_part_later() -> ContactParts {
    let mut contact_parts = in_part();
    contact_parts.set(2, [0.0, 0.5, 1.0, 1.0]);
    contact_parts.set(6, [1.0, 0.25, 0.0, 0.0]);
    contact_parts
}

#[test]
fn parts_of_cells_respond_like_cells_of_their_own() {
    let cells = cells(9);
    let (contact_parts, parts) = ([in_part(), in_part_later()], cells.divided(PARTS));
    let fraction = |stage: Stage, part: usize| contact_parts[stage as usize].of_part(part / PARTS, part % PARTS);
    for changes in [
        &[][..],
        &[("punch.top_thermal", 3.0), ("punch.convection", 30.0)],
        &[
            ("punch.conductivity", 1.2),
            ("punch.density", 2500.0),
            ("punch.specific_heat", 1000.0),
            ("punch.height", 0.015),
        ],
    ] {
        let scene = scene(changes);
        let mut run = Run::new(&scene, &cells, 1e-3, 100.0);
        let mut divided = Run::new(&scene, &parts, 1e-3, 100.0);
        let spread = |stage: Stage, flux: &[f64]| -> Vec<f64> {
            let density = |part: usize| flux[part / PARTS] / contact_parts[stage as usize].fraction(part / PARTS);
            (0..9 * PARTS).map(|part| fraction(stage, part) * density(part)).collect()
        };
        let mut worst = [0.0f64; 2];
        for i in 0..60 {
            let flux = |k: i32| -> Vec<f64> { (0..9).map(|j| 1e4 * (1.0 + (0.2 * f64::from(k + j)).sin())).collect() };
            let (first, end) = (flux(i), flux(i + 1));
            let step = [0.03, 0.7, 4.0][i as usize % 3];
            run.step_through(Exchange::Parts(contact_parts.each_ref()), step, &first, &end);
            divided.step(step, &spread(Stage::First, &first), &spread(Stage::End, &end));
            let scale = largest(&divided.temperature);
            for cell in 0..9 {
                let own = cell * PARTS..(cell + 1) * PARTS;
                let weighted: f64 = own.map(|part| fraction(Stage::End, part) * divided.temperature[part]).sum();
                let mean = weighted / (PARTS as f64 * contact_parts[1].fraction(cell));
                let error = (run.temperature[cell] - mean) / scale;
                worst[usize::from(i > 2)] = worst[usize::from(i > 2)].max(error.abs());
            }
        }
        // Waves without states follow in the time of whole cells, which differs shortly after the beginning.
        assert!(worst[0] < 2e-3 && worst[1] < 5e-4, "{changes:?}: {worst:?}");
        // At frozen state a temperature is the mean of the whole cell.
        let whole = run.frozen(&[0.0; 9]).temperature(&run.heat);
        let mean =
            |cell: usize| divided.temperature[cell * PARTS..(cell + 1) * PARTS].iter().sum::<f64>() / PARTS as f64;
        let scale = largest(&divided.temperature);
        for (cell, rise) in whole.iter().enumerate() {
            assert!((rise - mean(cell)).abs() < 0.02 * scale, "{changes:?} {cell}: {rise} {}", mean(cell));
        }
        assert!(run.temperature[2] > whole[2] + 0.005 * scale, "the parts in contact are hotter than the cell");
    }
}

#[test]
fn influence_through_parts_is_reciprocal_and_that_of_whole_cells_keeps_its_bits() {
    let cells = cells(9);
    let mut run = Run::new(&scene(&[("punch.convection", 30.0)]), &cells, 1e-3, 100.0);
    run.heat.prepare(&Step::new(0.5, [0.0; 2]));
    let whole = run.heat.influence(Stage::End).clone();
    let parts = in_part();
    let in_part = |length: f64| Step { exchange: Exchange::Parts([&parts; 2]), ..Step::new(length, [0.0; 2]) };
    run.heat.prepare(&in_part(0.5));
    let through_parts = run.heat.influence(Stage::End).clone();
    for i in 0..9 {
        for j in 0..9 {
            let [one, other] = [(i, j), (j, i)].map(|(i, j)| cells.widths()[i] * through_parts.temperature[(i, j)]);
            assert!((one - other).abs() < 1e-9 * through_parts.temperature.amax(), "{i} {j}: {one:e} {other:e}");
        }
    }
    assert!(through_parts.temperature[(2, 2)] > 1.02 * whole.temperature[(2, 2)]);
    // The same parts on another copy, after other steps, and whole cells again.
    let mut other = Run::new(&scene(&[("punch.convection", 30.0)]), &cells, 1e-3, 100.0);
    [0.1, 0.5].into_iter().for_each(|step| other.heat.prepare(&in_part(step)));
    assert_eq!(other.heat.influence(Stage::End), &through_parts);
    run.heat.prepare(&Step::new(0.5, [0.0; 2]));
    assert_eq!(run.heat.influence(Stage::End), &whole);
}

#[test]
fn what_is_prepared_and_observed_between_a_free_response_and_its_step_leaves_the_step_as_it_is() {
    let cells = cells(9);
    let flux: Vec<f64> = leaning(&cells).iter().map(|q| 1e4 * q).collect();
    let after = |between: bool| {
        let mut run = Run::new(&scene(&[]), &cells, 1e-3, 100.0);
        let parts = in_part();
        let in_part = |length: f64| Step { exchange: Exchange::Parts([&parts; 2]), ..Step::new(length, [0.0; 2]) };
        run.heat.prepare(&in_part(0.5));
        let (temperature, distortion) = (&mut run.temperature, &mut run.distortion);
        let (state, around, work) = (&run.state, &run.surroundings, &mut run.heat.workspace());
        let first = run.heat.first(state, around, &[0.0; 9], [&mut *temperature, &mut *distortion], work);
        let end = run.heat.end(first, state, around, &flux, [temperature, distortion], work);
        if between {
            run.heat.prepare(&in_part(1.7));
            run.heat.prepare(&in_part(0.5));
            run.heat.face_influence(Stage::End, 0, &mut FaceInfluence::new(9), work);
            let at = FrozenState { state: &run.state, surroundings: &run.surroundings, flux: &flux, velocity: 0.0 };
            run.heat.temperature_at_frozen_state(&at, &mut [0.0; 9], work);
        }
        let mut after = vec![0.0; run.state.len()];
        run.heat.advance(end, (&run.state, &mut after), &run.surroundings, [&flux; 2], work);
        after
    };
    assert_eq!(after(true), after(false));
}

/// Heat that enters warms what it enters: with the sum over 4 modes a part, parts of the narrow cells at the edge had cooled down.
#[test]
fn influence_through_parts_is_passive_on_narrow_cells_too() {
    let lining = [
        ("punch.width", 0.095),
        ("punch.height", 0.012),
        ("punch.conductivity", 1.2),
        ("punch.density", 2500.0),
        ("punch.specific_heat", 1000.0),
        ("punch.convection", 10.0),
    ];
    for (count, duration) in [(9, 100.0), (33, 0.1), (33, 10.0), (49, 1.0)] {
        let cells = elasticity::Cells::graded(0.0475, count).unwrap();
        let mut run = Run::new(&scene(&lining), &cells, 1e-3, duration);
        let root: Vec<f64> = cells.widths().iter().map(|width| width.sqrt()).collect();
        for step in [1e-6, 1e-3, 1.0] {
            for (cell, covered) in (0..count / 2).flat_map(|cell| [0.02, 0.7, 1.3, 3.2].map(|covered| (cell, covered)))
            {
                let mut parts = ContactParts::whole(count);
                parts.set(cell, std::array::from_fn(|part| (covered - part as f64).clamp(0.0, 1.0)));
                run.heat.prepare(&Step { exchange: Exchange::Parts([&parts; 2]), ..Step::new(step, [0.0; 2]) });
                let influence = &run.heat.influence(Stage::End).temperature;
                let per_heat = DMatrix::from_fn(count, count, |i, j| influence[(i, j)] * root[i] / root[j]);
                let found = (0.5 * (&per_heat + per_heat.transpose())).symmetric_eigenvalues();
                let [least, most] = [found.min(), found.max()];
                assert!(
                    least > -1e-9 * most,
                    "{count} cells, {step} s, {covered} of cell {cell}: {least:e} of {most:e}"
                );
            }
        }
    }
}
