//! Cooling of the faces of a body beyond their constant heat transfer: forced convection and radiation.
//!
//! Theory: docs/theory.md, section 4.11.

use conduction::STEFAN_BOLTZMANN;
use conduction::line::FACES;
use scene::Body;

/// Newton's method for the fluxes into the cooled faces, whose law is convex: largest number of iterations, and the relative
/// change at which they end.
const MOST_ITERATIONS: usize = 20;
const AGREEMENT: f64 = 1e-12;

/// Fluxes into the cooled faces in equilibrium with the face temperatures that they cause: `t` at the fluxes `guess`, plus `rise`
/// (rows: faces, columns: fluxes) per unit of additional flux. `law` is the flux into a face as a function of its temperature,
/// and the negative derivative.
pub fn balance(
    guess: [f64; FACES],
    t: [f64; FACES],
    rise: [[f64; FACES]; FACES],
    law: impl Fn(usize, f64) -> [f64; 2],
) -> [f64; FACES] {
    let mut flux = guess;
    for _ in 0..MOST_ITERATIONS {
        let more = [flux[0] - guess[0], flux[1] - guess[1]];
        let (mut residual, mut matrix) = ([0.0; FACES], [[0.0; FACES]; FACES]);
        for face in 0..FACES {
            let [lost, fall] = law(face, t[face] + (rise[face][0] * more[0] + rise[face][1] * more[1]));
            residual[face] = lost - flux[face];
            matrix[face] = [rise[face][0] * fall, rise[face][1] * fall];
            matrix[face][face] += 1.0;
        }
        let [[a, b], [c, d]] = matrix;
        let determinant = a * d - b * c;
        let change =
            [(residual[0] * d - b * residual[1]) / determinant, (a * residual[1] - c * residual[0]) / determinant];
        flux.iter_mut().zip(change).for_each(|(flux, change)| *flux += change);
        if change.iter().zip(&flux).all(|(change, flux)| change.abs() <= AGREEMENT * flux.abs()) {
            break;
        }
    }
    flux
}

/// Flux (W/m2 of cooled area) into a face of the temperature `t` by forced convection and radiation, and its decrease with t;
/// temperatures in K above the reference. `forced` is (v_c/v_0)^0.8.
pub fn cooling(body: &Body, reference: f64, t: f64, ambient: f64, forced: f64) -> [f64; 2] {
    // Below 0 K, which only an iterate can reach, radiation is 0; NaN stays NaN.
    let absolute = t + reference;
    let (hot, air) = (if absolute < 0.0 { 0.0 } else { absolute }, ambient + reference);
    let (moving, radiation) = (forced * body.convection_forced, STEFAN_BOLTZMANN * body.emissivity);
    [(ambient - t) * moving + radiation * (air.powi(4) - hot.powi(4)), moving + 4.0 * radiation * hot.powi(3)]
}
