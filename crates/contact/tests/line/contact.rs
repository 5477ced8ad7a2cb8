//! Contact pressure on cells: a narrow Hertz contact, steps, replays, derivatives. Flat punches and the order of convergence are
//! problems of `verification`.

use contact::wear::line::{CellRate, Conditions, ContactRate, Disturbance, WarmStart, WearingContact};
use contact::{ContactSolver, ContactState, Normal, Tilt, pair_compliance, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use exact::HertzLine;
use test_support::counting::{ALLOCATIONS, Counting};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

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

/// E* = 1, a = 1, a slightly round rigid punch.
fn wearing(count: usize) -> WearingContact {
    let cells = Cells::graded(1.0, count).unwrap();
    let strip = HalfPlane { material: Material::new(0.91, 0.3).unwrap() }.compliance(&cells);
    let (normal, shear) = pair_operators(&Rigid.compliance(&cells), &strip);
    let gap = cells.centres().iter().map(|x| 0.6 * x * x).collect();
    WearingContact::new(&cells, cells.widths(), normal, shear, gap).unwrap()
}

/// Reciprocating half-strokes of five steps, with a friction coefficient, speed and load that keep changing.
fn drive(step: usize, conditions: &mut Conditions) {
    let n = step as f64;
    let friction = (0.3 + 0.05 * (0.7 * n).sin()) * if (step / 5).is_multiple_of(2) { 1.0 } else { -1.0 };
    conditions.signed_friction = friction;
    conditions.normal = Normal::Load(1.0 + 0.8 * (0.4 * n).sin());
    conditions.tilt = Tilt::ResultantAt(0.3 * friction);
    conditions.rate.terms[0].coefficient = (1.0 + 0.5 * (0.3 * n).cos()).into();
}

/// The contact and its conditions of the step under way.
struct Strokes {
    contact: WearingContact,
    worn: Vec<f64>,
    gap: Vec<f64>,
    state: ContactState,
    conditions: Conditions,
}

impl Strokes {
    fn new(exponent: f64, worn: Vec<f64>) -> Strokes {
        let conditions = Conditions {
            signed_friction: 0.0,
            normal: Normal::Load(0.0),
            tilt: Tilt::Fixed(0.0),
            rate: CellRate::uniform(1.0, 1.0, exponent),
        };
        let count = worn.len();
        Strokes { contact: wearing(count), worn, gap: vec![0.0; count], state: ContactState::new(count), conditions }
    }

    /// Step by the implicit Euler method.
    fn step(&mut self, step: usize) {
        const LENGTH: f64 = 0.05;
        drive(step, &mut self.conditions);
        for ((gap, initial), worn) in self.gap.iter_mut().zip(self.contact.initial_gap()).zip(&self.worn) {
            *gap = initial + worn;
        }
        self.contact.stage_into(&self.gap, LENGTH, &self.conditions, &mut self.state).unwrap();
        for (i, depth) in self.worn.iter_mut().enumerate() {
            *depth += LENGTH * self.conditions.rate.rate(i, self.state.pressure[i]);
        }
    }
}

#[test]
fn steps_allocate_nothing_and_replay_to_the_last_bit() {
    for exponent in [0.4, 1.0, 2.5] {
        let mut strokes = Strokes::new(exponent, vec![0.0; 33]);
        strokes.step(0);
        let before = ALLOCATIONS.get();
        for n in 1..40 {
            strokes.step(n);
        }
        assert_eq!(ALLOCATIONS.get(), before, "b {exponent}");
        // Saved as numbers, restored into a contact that has not taken these steps.
        let mut numbers = Vec::new();
        strokes.contact.status().save(&mut numbers);
        assert_eq!(numbers.len(), WarmStart::saved_len(33));
        let mut status = WarmStart::new(33);
        status.load(&mut numbers.iter()).unwrap();
        assert!(WarmStart::new(33).load(&mut numbers[1..].iter()).is_none());
        let mut other = Strokes::new(exponent, strokes.worn.clone());
        other.contact.set_status(&status);
        for n in 40..80 {
            strokes.step(n);
            other.step(n);
        }
        assert_eq!((&other.worn, &other.state), (&strokes.worn, &strokes.state), "b {exponent}");
        assert_eq!(other.contact.status(), strokes.contact.status(), "b {exponent}");
    }
}

#[test]
fn response_is_the_derivative_of_the_contact() {
    let cells = Cells::graded(1.0, 17).unwrap();
    for normal in [Normal::Load(0.7), Normal::Approach(0.8), Normal::Spring { load: 1.2, stiffness: 0.7 }] {
        for tilt in [Tilt::Fixed(0.05), Tilt::ResultantAt(0.1), Tilt::Moment { lever: 0.05, moment: 0.02 }] {
            let mut contact = wearing(17);
            let gap_rate: Vec<f64> = cells.centres().iter().map(|x| 0.3 * x + (2.0 * x).cos()).collect();
            let disturbance = Disturbance { gap: &gap_rate, normal: 0.8, tilt: 0.2, moment: 0.3, signed_friction: 1.4 };
            let at = |h: f64| Conditions {
                signed_friction: 0.3 + h * disturbance.signed_friction,
                normal: match normal {
                    Normal::Load(load) => Normal::Load(load + h * disturbance.normal),
                    Normal::Approach(approach) => Normal::Approach(approach + h * disturbance.normal),
                    Normal::Spring { load, stiffness } => {
                        Normal::Spring { load: load + h * disturbance.normal, stiffness }
                    }
                },
                tilt: match tilt {
                    Tilt::Fixed(tilt) => Tilt::Fixed(tilt + h * disturbance.tilt),
                    Tilt::ResultantAt(lever) => {
                        Tilt::Moment { lever: lever + h * disturbance.tilt, moment: h * disturbance.moment }
                    }
                    Tilt::Moment { lever, moment } => {
                        Tilt::Moment { lever: lever + h * disturbance.tilt, moment: moment + h * disturbance.moment }
                    }
                },
                rate: CellRate::archard(0.0, 1.0),
            };
            let mut solve = |h: f64| {
                let worn: Vec<f64> = gap_rate.iter().map(|g| h * g).collect();
                contact.pressure(&worn, &at(h)).unwrap()
            };
            let h = 1e-6;
            let (low, middle, high) = (solve(-h), solve(0.0), solve(h));
            assert!(middle.pressure.contains(&0.0) || matches!(normal, Normal::Approach(_)));
            let mut rate = ContactRate::new(17);
            contact.response_into(&at(0.0), &middle, &disturbance, &mut rate).unwrap();
            let case = format!("{normal:?} {tilt:?}");
            for i in 0..17 {
                let numeric = (high.pressure[i] - low.pressure[i]) / (2.0 * h);
                assert!(
                    (rate.pressure[i] - numeric).abs() < 1e-5 * (1.0 + numeric.abs()),
                    "{case} cell {i}: {numeric}"
                );
            }
            let (approach, tilt) = ((high.approach - low.approach) / (2.0 * h), (high.tilt - low.tilt) / (2.0 * h));
            assert!((rate.approach - approach).abs() < 1e-6 * (1.0 + approach.abs()), "{case}: {approach}");
            assert!((rate.tilt - tilt).abs() < 1e-6 * (1.0 + tilt.abs()), "{case}: {tilt}");
        }
    }
}
