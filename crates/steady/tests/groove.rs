//! The steady groove against time steps of a sliding contact.

use contact::wear::line::{CellRate, Conditions, Direction, LineTrack, WearingContact};
use contact::{Normal, Tilt};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Winkler};
use nalgebra::DMatrix;
use numerics::sdirk::GAMMA;
use steady::groove;

fn wearing(cells: &Cells, compliance: &DMatrix<f64>, operator: &DMatrix<f64>) -> WearingContact {
    let (count, shear) = (cells.count(), DMatrix::zeros(cells.count(), cells.count()));
    let mut contact = WearingContact::new(cells, cells.widths(), compliance.clone(), shear, vec![0.0; count]).unwrap();
    contact.set_operator(Some(operator));
    contact
}

/// Pressure after sliding over a fresh strip in equal steps.
fn slide(
    cells: &Cells,
    compliance: &DMatrix<f64>,
    rate: &CellRate,
    distance: f64,
    steps: usize,
    forward: bool,
) -> Vec<f64> {
    let count = cells.count();
    let mut track = LineTrack::new(cells, 0.0);
    let sign = if forward { 1.0 } else { -1.0 };
    let travel = distance / steps as f64;
    let mut operator = DMatrix::zeros(count, count);
    track.operator(sign * GAMMA * travel, &mut operator);
    let mut contact = wearing(cells, compliance, &operator);
    let conditions =
        Conditions { signed_friction: 0.0, normal: Normal::Load(2.0), tilt: Tilt::Fixed(0.0), rate: rate.clone() };
    let (mut x, mut worn, mut state) = (0.0, vec![0.0; count], Vec::new());
    for _ in 0..steps {
        for part in [GAMMA, 1.0] {
            track.depth_under(x + sign * part * travel, &mut worn);
            state = contact.stage(&worn, GAMMA * travel, &conditions).unwrap().pressure;
            let share = if part == 1.0 { GAMMA } else { 1.0 - GAMMA };
            let taken: Vec<f64> = (0..count).map(|i| share * travel * rate.rate(i, state[i])).collect();
            let done = if part == 1.0 { 1.0 - GAMMA } else { 0.0 };
            track.deposit(x + sign * done * travel, x + sign * (done + share) * travel, &taken);
        }
        x += sign * travel;
    }
    state
}

fn root_mean_square(cells: &Cells, a: &[f64], b: &[f64]) -> f64 {
    let square: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).collect();
    (cells.integral(&square) / (2.0 * cells.half_width())).sqrt()
}

#[test]
fn sliding_on_ends_in_the_groove() {
    let half_plane = HalfPlane { material: Material::new(0.91, 0.3).unwrap() };
    let winkler = Winkler::new(2.0).unwrap();
    for (body, name) in [(&half_plane as &dyn ElasticBody, "half-plane"), (&winkler, "Winkler")] {
        for count in [17, 33, 65] {
            let cells = Cells::graded(1.0, count).unwrap();
            let compliance = body.compliance(&cells).normal;
            let rate = CellRate::archard(0.5, 1.0);
            for forward in [true, false] {
                let direction = if forward { Direction::Forward } else { Direction::Backward };
                let gap = vec![0.0; count];
                let (load, tilt) = (Normal::Load(2.0), Tilt::Fixed(0.0));
                let exact =
                    groove(&cells, compliance.clone(), &gap, rate.clone(), direction, load, tilt).unwrap().pressure;
                let stepped = slide(&cells, &compliance, &rate, 20.0, 80, forward);
                let error = root_mean_square(&cells, &stepped, &exact);
                assert!(error < 2e-5, "{name} N {count} forward {forward}: {error:e}");
            }
        }
    }
}

#[test]
fn second_order_in_the_travel() {
    let cells = Cells::graded(1.0, 17).unwrap();
    for exponent in [1.0, 0.7] {
        let compliance = Winkler::new(2.0).unwrap().compliance(&cells).normal;
        let rate = CellRate::uniform(1.0, 0.5, exponent);
        let truth = slide(&cells, &compliance, &rate, 1.0, 512, true);
        let errors: Vec<f64> = [2, 4, 8, 16, 32]
            .iter()
            .map(|steps| root_mean_square(&cells, &slide(&cells, &compliance, &rate, 1.0, *steps, true), &truth))
            .collect();
        let slope = (errors[0] / errors[3]).log2() / 3.0;
        assert!((1.6..2.4).contains(&slope), "b {exponent}: {slope} {errors:?}");
    }
}
