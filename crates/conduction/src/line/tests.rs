//! What tests of several bodies share: the stages of a step with fluxes into cells and cooled faces.

use super::{Boundary, FACES, FaceInfluence, GAMMA, SingleStep, Stage, Surroundings, ThermalBody};

/// Temperatures and distortion of the cells and temperatures of the cooled faces at a stage of the prepared step; `known` as in
/// [`SingleStep::free_response`], `own` the fluxes of the stage into the cells.
pub(crate) fn at_stage(
    body: &dyn ThermalBody,
    state: &[f64],
    around: &Surroundings,
    (stage, held): (Stage, bool),
    [known, own]: [&[f64]; 2],
) -> (Vec<f64>, Vec<f64>, [f64; FACES]) {
    let count = body.cells();
    let (mut temperature, mut distortion) = (vec![0.0; count], vec![0.0; count]);
    let mut faces = body.free_response(state, around, stage, known, &mut temperature, &mut distortion);
    let influence = body.influence(stage);
    for i in 0..count {
        temperature[i] += (0..count).map(|j| influence.temperature[(i, j)] * own[j]).sum::<f64>();
        distortion[i] += (0..count).map(|j| influence.distortion[(i, j)] * own[j]).sum::<f64>();
    }
    let mut by_face = FaceInfluence::new(count);
    for (face, flux) in [around.at(stage).cooling, around.at(stage).far].into_iter().enumerate() {
        if face == 1 && held {
            continue;
        }
        body.face_influence(stage, face, &mut by_face, &mut body.workspace());
        (0..FACES).for_each(|other| faces[other] += by_face.faces[other] * flux);
        faces[face] += by_face.by_cell.iter().zip(own).map(|(rise, flux)| rise * flux).sum::<f64>();
        for i in 0..count {
            temperature[i] += by_face.temperature[i] * flux;
            distortion[i] += by_face.distortion[i] * flux;
        }
    }
    (temperature, distortion, faces)
}

/// Linear from the first stage of one step to the end of the next, over the two parts of a step that end at its stages.
pub(crate) fn in_two_parts(start: Boundary, end: Boundary) -> [Surroundings; 2] {
    let middle = start.combined(&end, |start, end| start + GAMMA * (end - start));
    [Surroundings::linear(start, middle), Surroundings::linear(middle, end)]
}

#[test]
fn linear_surroundings_have_their_mean() {
    let start = Boundary { cooling: 2.0, ambient: -3.0, far: 7.0 };
    let end = Boundary { cooling: 5.0, ambient: 4.0, far: 1.0 };
    let linear = Surroundings::linear(start, end);
    let (mean, fall) = (linear.mean(), linear.fall(Stage::End));
    for (got, expected) in [
        (mean.cooling, 3.5),
        (mean.ambient, 0.5),
        (mean.far, 4.0),
        (fall.cooling, -3.0),
        (fall.ambient, -7.0),
        (linear.fall(Stage::First).far, GAMMA * 6.0),
    ] {
        assert!((got - expected).abs() < 1e-14, "{got} {expected}");
    }
}
