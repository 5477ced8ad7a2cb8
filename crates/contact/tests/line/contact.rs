//! Contact pressure on cells: steps, replays, derivatives. Hertz contacts, flat punches and the order of convergence are
//! problems of `verification`.

use contact::wear::line::{CellRate, Conditions, ContactRate, Disturbance, WarmStart, WearingContact};
use contact::{ContactState, Normal, Tilt, pair_operators};
use elasticity::{Cells, ElasticBody, HalfPlane, Material, Rigid};
use test_support::counting::{ALLOCATIONS, Counting};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

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
