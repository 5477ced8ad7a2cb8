//! Contact pressure on cells against closed forms: Hertz and flat punches, cell means at |x| < .9 a.

use sliding_contact::contact::{ContactSolver, Normal, Tilt, pair_compliance};
use sliding_contact::elastic::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use sliding_contact::exact::{FlatPunch, HertzLine, friction_exponent};

const HALF_WIDTH: f64 = 0.03;
const LOAD: f64 = 1e6;

fn steel() -> Material {
    Material::new(200e9, 0.3).unwrap()
}

/// Pressure of a punch with the given initial gap on the half-plane.
fn pressure(cells: &Cells, signed_friction: f64, gap: &[f64]) -> Vec<f64> {
    let strip = HalfPlane { material: steel() }.compliance(cells);
    let compliance = pair_compliance(&Rigid.compliance(cells), &strip, signed_friction);
    let mut solver = ContactSolver::new(cells, compliance).unwrap();
    solver.solve(gap, Normal::Load(LOAD), Tilt::Fixed(0.0)).unwrap().pressure
}

/// Largest deviation of cell means within .9 of the contact half-width, relative to `scale`.
fn deviation(cells: &Cells, pressure: &[f64], carried: impl Fn(f64) -> f64, half_width: f64, scale: f64) -> f64 {
    let exact = cells.means_from_primitive(carried);
    (0..cells.count())
        .filter(|&i| cells.edges()[i].abs().max(cells.edges()[i + 1].abs()) < 0.9 * half_width)
        .map(|i| (pressure[i] - exact[i]).abs() / scale)
        .fold(0.0, f64::max)
}

/// Errors at N = 33, 65, 129, 257 and the order of convergence over the three doublings.
fn convergence(mut error: impl FnMut(&Cells) -> f64) -> ([f64; 4], f64) {
    let errors = [33, 65, 129, 257].map(|count| error(&Cells::graded(HALF_WIDTH, count).unwrap()));
    (errors, (errors[0] / errors[3]).log2() / 3.0)
}

#[test]
fn flat_punch_at_rest() {
    let punch = FlatPunch { load: LOAD, half_width: HALF_WIDTH, signed_exponent: 0.0 };
    let mean = LOAD / (2.0 * HALF_WIDTH);
    let (errors, order) = convergence(|cells| {
        let computed = pressure(cells, 0.0, &vec![0.0; cells.count()]);
        deviation(cells, &computed, |x| punch.carried(x), HALF_WIDTH, mean)
    });
    println!("flat punch: {errors:?}, order {order:.2}");
    assert!(errors[1] < 1e-3 && order > 1.75, "{errors:?}, order {order:.2}");
}

#[test]
fn flat_punch_sliding_both_ways() {
    let mean = LOAD / (2.0 * HALF_WIDTH);
    for direction in [1.0, -1.0] {
        let signed_exponent = direction * friction_exponent(0.5, 0.3);
        let punch = FlatPunch { load: LOAD, half_width: HALF_WIDTH, signed_exponent };
        let mut eccentricity = 0.0;
        let (errors, order) = convergence(|cells| {
            let computed = pressure(cells, 0.5 * direction, &vec![0.0; cells.count()]);
            eccentricity = cells.moment(&computed) / LOAD;
            deviation(cells, &computed, |x| punch.carried(x), HALF_WIDTH, mean)
        });
        let deviation = eccentricity / punch.eccentricity() - 1.0;
        println!("sliding flat punch {direction:+}: {errors:?}, order {order:.2}, eccentricity {deviation:.1e}");
        assert!(errors[1] < 1e-3 && order > 1.75, "{errors:?}, order {order:.2}");
        assert!(deviation.abs() < 1e-4, "eccentricity {deviation:e}");
    }
}

/// Hertz contact of `share` of the zone's width.
fn hertz(share: f64) -> (f64, HertzLine) {
    let modulus = steel().plane_strain_modulus();
    let radius = (share * HALF_WIDTH).powi(2) * std::f64::consts::PI * modulus / (4.0 * LOAD);
    (radius, HertzLine::new(LOAD, radius, modulus))
}

fn hertz_error(cells: &Cells, share: f64) -> (f64, usize) {
    let (radius, exact) = hertz(share);
    let computed = pressure(cells, 0.0, &cells.means_from_primitive(|x| x.powi(3) / (6.0 * radius)));
    let error = deviation(cells, &computed, |x| exact.carried(x), exact.half_width, exact.pressure(0.0));
    (error, computed.iter().filter(|p| **p > 0.0).count())
}

#[test]
fn hertz_contact() {
    // The free edge lies at .8 of the zone, where the error wavers with its place in a cell, and at .99.
    for (share, least_order) in [(0.8, 1.2), (0.99, 1.9)] {
        let (errors, order) = convergence(|cells| hertz_error(cells, share).0);
        println!("Hertz over {share} of the zone: {errors:?}, order {order:.2}");
        assert!(errors[1] < 1e-3 && order > least_order, "{errors:?}, order {order:.2}");
    }
}

#[test]
fn hertz_error_follows_from_the_cells_in_contact() {
    // However narrow the contact in its zone: at most 4/n^2 with n cells in contact.
    for count in [33, 65, 129, 257] {
        let cells = Cells::graded(HALF_WIDTH, count).unwrap();
        for share in [0.1, 0.3, 0.5, 0.6, 0.7, 0.9] {
            let (error, in_contact) = hertz_error(&cells, share);
            let scaled = error * (in_contact as f64).powi(2);
            assert!(scaled < 4.0, "N {count}, {share} of the zone: error {error:e} with {in_contact} cells in contact");
        }
    }
}
