//! Every parameter at its limits and beyond, from the table of variables.

use scene::variables::{COUNT, Causality, FLAT, Kind, TABLE, Variability, lookup};
use sliding_contact::fmi2::types::Status;

use crate::run::{Level, nonsense, set, set_up};
use test_support::importer::{Importer, Stage};

/// Name, least and largest value of every element of a parameter, and whether it is tunable.
fn parameters() -> impl Iterator<Item = (String, f64, f64, bool)> {
    (0..COUNT as u32).filter_map(|reference| {
        let (row, element) = lookup(reference)?;
        let (Some(least), Some(largest)) = row.bounds() else {
            assert!(row.causality != Causality::Parameter, "{} has no limits", row.name);
            return None;
        };
        let is_tunable = row.variability == Variability::Tunable;
        (row.causality == Causality::Parameter).then(|| (row.element_name(element), least, largest, is_tunable))
    })
}

/// Least magnitude of a Real other than 0.
fn least_magnitude(name: &str) -> Option<f64> {
    let reference = test_support::importer::reference(name);
    let row = &TABLE[FLAT[reference as usize].0 as usize];
    matches!(row.kind, Kind::Real { .. }).then_some(row.least_magnitude)
}

#[test]
fn every_parameter_beyond_its_limits_is_refused_by_name_value_and_limit() {
    let phases = [Importer::at(Stage::Instantiated), Importer::at(Stage::Stepping)];
    let before = phases.each_ref().map(Importer::bytes);
    let mut count = 0;
    for (name, least, largest, is_tunable) in parameters() {
        let values = match least_magnitude(&name).map(f64::next_down) {
            Some(tiny) => {
                let mut values = vec![least.next_down(), largest.next_up(), f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
                values.extend([tiny].into_iter().filter(|value| (least..=largest).contains(value)));
                values
            }
            None => vec![least - 1.0, largest + 1.0],
        };
        for value in values {
            for (importer, before) in phases.iter().zip(&before).take(1 + usize::from(is_tunable)) {
                let status = set(importer, &name, value);
                let log = importer.take_log();
                assert_eq!(status, Status::Discard, "{name} = {value}: {log:?}");
                let [(Status::Discard, _, text)] = &log[..] else { panic!("{name} = {value}: {log:?}") };
                let limits = [
                    "below the minimum ",
                    "below the least value other than 0, ",
                    "above the maximum ",
                    "not a finite number",
                    "not an item of",
                    "0 or 1",
                ];
                assert!(text.contains(&format!("{name}: ")), "{name} = {value}: {text}");
                assert!(limits.iter().any(|limit| text.contains(limit)), "{name} = {value}: {text}");
                assert!(importer.bytes() == *before, "{name} = {value} changes the state");
                count += 1;
            }
        }
    }
    assert!(count > 500, "{count}");
}

/// At its limits a parameter gives finite outputs, or the end of initialisation or a step is refused; the instance is reset and
/// used for the next one.
fn check(level: Level) {
    let importer = Importer::with_logging(false);
    let mut failures = Vec::new();
    for (name, least, largest, _) in parameters() {
        // These choose the level; the cost of 1025 cells is for another test. Of arrays the first two elements.
        let is_skipped = ["solver.fidelity", "solver.cells"].contains(&&name[..])
            || name.ends_with(']') && !["[1]", "[2]"].iter().any(|end| name.ends_with(end));
        let tiny = least_magnitude(&name).filter(|value| (least..=largest).contains(value));
        for value in [Some(least), tiny, Some(largest)].into_iter().flatten() {
            // Their operators take seconds.
            let is_long = level == Level::Hot
                && [("strip.length", largest), ("contact.mean_radius", largest), ("nominal.duration", least)]
                    .contains(&(&name[..], value));
            if is_skipped || is_long {
                continue;
            }
            if let Err(text) = at_a_limit(&importer, level, &name, value) {
                failures.push(format!("{name} = {value:e}: {text}"));
            }
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

/// Initialises and makes three steps, the last one in the other direction.
fn at_a_limit(importer: &Importer, level: Level, name: &str, value: f64) -> Result<(), String> {
    let status = importer.reset();
    if status != Status::Ok {
        return Err(format!("fmi2Reset returns {status:?}"));
    }
    set_up(importer, level, "", &[(name.to_owned(), value)])?;
    importer.take_log();
    let told = |what: &str| {
        let log = importer.take_log();
        let text = log.iter().filter(|entry| entry.0 == Status::Error).map(|entry| &entry.2[..]).next_back();
        match text {
            // The cause is named, be it this parameter, one that contradicts it, or the inputs of a step without solution.
            Some(text) if text.contains(name) || text.contains(" = ") || text.contains("friction coefficient 400") => {
                Ok(())
            }
            _ => Err(format!("{what} is refused without the cause: {log:?}")),
        }
    };
    if importer.enter() != Status::Ok {
        return Err("fmi2EnterInitializationMode fails".into());
    }
    if importer.exit() != Status::Ok {
        return told("initialisation");
    }
    for (step, velocity) in [2.0, 2.0, -1.0].into_iter().enumerate() {
        if let Some(text) = nonsense(importer) {
            return Err(format!("before step {step}: {text}"));
        }
        let status = importer.set_real(&["sliding_velocity", "normal_load"], &[velocity, 2e3]);
        assert_eq!(status, Status::Ok);
        let from = 0.01 * step as f64;
        if importer.step(from, 0.01) != Status::Ok {
            return told("a step");
        }
    }
    nonsense(importer).map_or(Ok(()), Err)
}

#[test]
fn every_parameter_at_its_limits_lumped() {
    check(Level::Lumped);
}

#[test]
fn every_parameter_at_its_limits_on_cells() {
    check(Level::Cold);
}

#[test]
fn every_parameter_at_its_limits_with_resolved_heat() {
    check(Level::Hot);
}
