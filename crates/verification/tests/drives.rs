//! The harness of the charts: scenes over time, judged by their truth.

use scene::Fidelity;
use scene::variables::reference;
use sliding_contact::component::Component;
use std::sync::Arc;
use verification::drives::{DriveProblem, Ending, Errors, Quantity, Record, Setting, problems};

fn problem(name: &str) -> DriveProblem {
    problems().unwrap().into_iter().find(|problem| problem.name == name).unwrap()
}

fn line(problem: &DriveProblem, cells: usize) -> Setting {
    Setting { fidelity: Fidelity::Line, tolerance: 1e-4, cells, step: problem.step, order: 1, heat: true }
}

fn judged(problem: &DriveProblem, setting: &Setting) -> (Record, Errors) {
    let (_, truth) = problem.truth(&mut |_| unreachable!("the truth is exact")).unwrap();
    let record = problem.run(setting, &|| 0.0, f64::INFINITY);
    assert_eq!(record.ending, Ending::Finished, "{setting}");
    let errors = problem.errors(&record.samples, &truth);
    (record, errors)
}

#[test]
fn the_line_converges_to_the_exact_pin_and_lumped_is_exact_but_for_the_pressure() {
    let pin = problem("unidirectional_pin");
    let peak = |cells| judged(&pin, &line(&pin, cells)).1.of(Quantity::PeakPressure);
    let (coarse, middle, fine) = (peak(9), peak(33), peak(65));
    assert!(coarse < 0.05 && middle < 5e-3 && fine < 2e-3, "{coarse} {middle} {fine}");
    // First order in the number of cells at least.
    assert!((coarse / fine).log2() > (65.0_f64 / 9.0).log2(), "{coarse} {fine}");
    let (record, errors) = judged(&pin, &Setting { fidelity: Fidelity::Lumped, cells: 0, ..line(&pin, 0) });
    assert!(errors.of_main_outputs() < 1e-4, "{errors:?}");
    assert!(errors.of(Quantity::PeakPressure) > 0.5, "{errors:?}");
    // Work: one internal step per communication step, where nothing changes.
    assert_eq!((record.work, record.communications), ((100, 0), 100));
}

#[test]
fn the_line_converges_to_the_integral_equation_of_the_hot_spot() {
    let clutch = problem("clutch_engagement");
    let error = |cells| {
        let (_, errors) = judged(&clutch, &line(&clutch, cells));
        assert!(errors.of_main_outputs() < 1e-4, "{errors:?}");
        errors.of(Quantity::PeakPressure)
    };
    let (coarse, fine) = (error(9), error(17));
    assert!(coarse < 0.04 && fine < 0.01 && coarse > 3.0 * fine, "{coarse} {fine}");
}

#[test]
fn what_fails_is_refused_or_stopped_and_says_why() {
    let mut thin = problem("unidirectional_pin");
    thin.starts[reference("punch.wear_coefficient") as usize] *= 1e9;
    let lumped = Setting { fidelity: Fidelity::Lumped, cells: 0, ..line(&thin, 0) };
    match thin.run(&lumped, &|| 0.0, f64::INFINITY).ending {
        Ending::Failed(time, text) => assert!(time == 0.0 && text.contains("worn through"), "{time} {text}"),
        other => panic!("{other:?}"),
    }
    let pin = problem("unidirectional_pin");
    // No sample lies on such a step.
    let odd = Setting { step: 0.07, ..line(&pin, 33) };
    assert!(matches!(pin.run(&odd, &|| 0.0, f64::INFINITY).ending, Ending::Refused(text) if text.contains("0.07")));
    // The clock that this caller brings says a second more at every look.
    let time = std::cell::Cell::new(0.0);
    let clock = || time.replace(time.get() + 1.0);
    assert!(matches!(pin.run(&line(&pin, 9), &clock, 4.5).ending, Ending::Stopped(_)));
}

#[test]
fn heat_is_switched_off_only_where_neither_wear_nor_pressure_know_of_it() {
    let pin = problem("unidirectional_pin");
    let cold = Setting { heat: false, ..line(&pin, 17) };
    let ((warm_record, warm), (cold_record, errors)) = (judged(&pin, &line(&pin, 17)), judged(&pin, &cold));
    // With heat the steps follow it.
    assert!(cold_record.work.0 < warm_record.work.0);
    for (cold, warm) in cold_record.samples.iter().zip(&warm_record.samples) {
        assert!((cold[0] / warm[0] - 1.0).abs() < 1e-5 && (cold[3] / warm[3] - 1.0).abs() < 5e-4, "{cold:?} {warm:?}");
    }
    for unknown in [Quantity::ContactTemperature, Quantity::FrictionForce] {
        assert!(errors.of(unknown).is_nan() && !warm.of(unknown).is_nan(), "{errors:?} {warm:?}");
    }
    // There really is none.
    let mut component = Component::new(Arc::new(pin.starts_with(&cold)));
    let ambient = component.get(reference("ambient_temperature"));
    component.enter_initialization();
    component.initialise(None).unwrap();
    component.set_input(reference("sliding_velocity"), 0.5);
    component.set_input(reference("normal_load"), 100.0);
    component.step(1.0).unwrap();
    let heat = ["contact_temperature", "friction_force", "stored_heat"].map(|name| component.get(reference(name)));
    assert_eq!(heat, [ambient, 0.0, 0.0]);
    assert!(component.get(reference("wear_depth")) > 0.0);
    // One communication step to each sample; the step is cut inside where the tolerance asks for it.
    let (record, long) = judged(&pin, &Setting { step: f64::INFINITY, order: 0, ..cold });
    assert_eq!((record.communications, record.samples.len()), (8, 8));
    assert!(record.tried() > 80, "{:?}", record.work);
    let [peak, known] = [long, errors].map(|errors| errors.of(Quantity::PeakPressure));
    assert!((peak - known).abs() < 1e-3, "{peak} {known}");
    let punch = problem("reciprocating_punch");
    let refused = punch.run(&Setting { heat: false, ..line(&punch, 9) }, &|| 0.0, f64::INFINITY).ending;
    assert!(matches!(&refused, Ending::Refused(text) if text.contains("follow the heat")), "{refused:?}");
}

#[test]
fn errors_are_relative_to_the_largest_value_and_to_the_rise() {
    let pin = problem("unidirectional_pin");
    let ambient = 293.15;
    let truth = [[1.0, f64::NAN, -2.0, 8.0], [4.0, ambient + 10.0, 2.0, 4.0]];
    let found = [[1.2, 1e9, -2.0, 8.4], [4.0, ambient + 11.0, 2.0, f64::NAN]];
    let Errors(errors) = pin.errors(&found, &truth);
    for (error, expected) in errors.into_iter().zip([0.05, 0.1, 0.0, f64::INFINITY]) {
        assert!(error == expected || (error - expected).abs() < 1e-12, "{errors:?}");
    }
    // Not modelled at all is not judged.
    let without: Vec<_> = found.iter().map(|[a, b, c, _]| [*a, *b, *c, f64::NAN]).collect();
    assert!(pin.errors(&without, &truth).of(Quantity::PeakPressure).is_nan());
}
