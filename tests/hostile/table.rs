//! Reads the rows of `cases.txt`.
//!
//! | column | holds |
//! |---|---|
//! | levels | `all`, `each` (without `auto`), `cells`, or levels by name |
//! | from | `new` (instantiated) or `stepping` (after three steps) |
//! | scene | parameters of this instance and of the one it is compared with, or `example NAME` |
//! | calls | `NAME = VALUE`, `slope NAME = VALUE`, `step S`, `steps S N`, `tolerance T` and `start S` (`fmi2SetupExperiment`), `initialise` |
//! | status | `ok`, `discard`, `error`; `any`: `ok` or a refusal that says why |
//! | words | parts of the message, joined by ` & `; with `ok`, of a warning that is logged on the way |

use scene::variables::Kind;
use sliding_contact::fmi2::types::Status;

use crate::run::{Call, Case, From, Level, check, kind};

/// A number, or an item of an enumeration by its name.
fn value(name: &str, text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| {
        let Kind::Enumeration(kind) = kind(name) else { panic!("{name}: {text:?}") };
        1.0 + kind.items.iter().position(|item| item.0 == text).unwrap_or_else(|| panic!("{name}: {text:?}")) as f64
    })
}

fn assignment(text: &str) -> (String, f64) {
    let (name, given) = text.split_once(" = ").unwrap_or_else(|| panic!("{text:?}"));
    (name.to_owned(), value(name, given))
}

fn call(text: &str) -> Call {
    let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("{text:?}"));
    match text.split(' ').collect::<Vec<_>>()[..] {
        ["initialise"] => Call::Initialise,
        ["step", step] => Call::Steps(number(step), 1),
        ["steps", step, count] => Call::Steps(number(step), count.parse().unwrap()),
        ["tolerance", tolerance] => Call::SetUp(Some(number(tolerance)), 0.0),
        ["start", start] => Call::SetUp(None, number(start)),
        ["slope", name, "=", slope] => Call::Slope(name.to_owned(), number(slope)),
        _ => {
            let (name, value) = assignment(text);
            Call::Set(name, value)
        }
    }
}

fn list<T>(text: &str, separator: &str, of: impl Fn(&str) -> T) -> Vec<T> {
    text.split(separator).map(str::trim).filter(|part| !part.is_empty()).map(of).collect()
}

fn case(line: &str) -> Case {
    let columns: Vec<&str> = line.split('|').map(str::trim).collect();
    let [what, levels, from, scene, calls, status, says] = columns[..] else { panic!("{line}") };
    let level = |name: &str| match name {
        "lumped" => Level::Lumped,
        "cold" => Level::Cold,
        "hot" => Level::Hot,
        "auto" => Level::Auto,
        _ => panic!("{line}"),
    };
    let levels = match levels {
        "all" => "lumped cold hot auto",
        "each" => "lumped cold hot",
        "cells" => "cold hot",
        named => named,
    };
    let example = scene.strip_prefix("example ").unwrap_or("");
    Case {
        what: what.to_owned(),
        levels: list(levels, " ", level),
        example: example.to_owned(),
        scene: if example.is_empty() { list(scene, ";", assignment) } else { Vec::new() },
        from: if from == "new" { From::Instantiated } else { From::Stepping },
        calls: list(calls, ";", call),
        status: match status {
            "ok" => Some(Status::Ok),
            "discard" => Some(Status::Discard),
            "error" => Some(Status::Error),
            "any" => None,
            _ => panic!("{line}"),
        },
        says: list(says, " & ", str::to_owned),
    }
}

/// The rows below a heading.
fn group(title: &str) -> Vec<Case> {
    let mut groups = include_str!("cases.txt").split("\n## ").skip(1);
    let group = groups.find_map(|group| group.strip_prefix(title)?.strip_prefix('\n'));
    group.unwrap().lines().filter(|line| !line.is_empty()).map(case).collect()
}

macro_rules! groups {
    ($($test:ident: $title:literal;)*) => {
        $(
            #[test]
            fn $test() {
                check(&group($title));
            }
        )*

        #[test]
        fn every_group_is_run() {
            assert_eq!(include_str!("cases.txt").matches("\n## ").count(), [$($title),*].len());
        }
    };
}

groups! {
    inputs_that_are_no_numbers: "inputs that are no numbers";
    inputs_beyond_their_limits: "inputs beyond their limits";
    extreme_inputs_that_are_allowed: "extreme inputs that are allowed";
    lengths_of_steps_and_times: "lengths of steps and times";
    tuned_parameters: "tuned parameters";
    geometry: "geometry";
    options_that_contradict_each_other: "options that contradict each other";
    limits_of_the_model: "limits of the model";
}
