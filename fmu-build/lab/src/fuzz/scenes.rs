//! Target `scenes`: the text of the shipped scenes, changed.

use std::sync::LazyLock;

use fmu_build::scenes;
use scene::Scene;
use scene::variables::{Causality, FLAT, TABLE, check_parameter};
use scene_file::property_tables::TABLES;

use super::random::Random;
use super::text;
use super::watchdog::enter;
use super::{Kinds, Verdict};

/// Texts of the shipped scenes.
static SHIPPED: LazyLock<Vec<String>> = LazyLock::new(|| {
    let text = |name: &String| std::fs::read_to_string(scenes::locate(name).ok()?).ok();
    scenes::names().iter().filter_map(text).collect()
});

/// Replacements of a value, beside numbers.
const VALUES: [&str; 30] = [
    "true",
    "\"\"",
    "[]",
    "[[[[[[[[1]]]]]]]]",
    "{}",
    "{ a = 1 }",
    "inf",
    "-nan",
    "1_000",
    "0x7fffffffffffffff",
    "99999999999999999999",
    "1e400",
    "-0.0",
    "1979-05-27T07:32:00Z",
    "\"20 degC\"",
    "\"-273.15 degC\"",
    "\"-300 degC\"",
    "\"1 mm\"",
    "\"1e308 km/h\"",
    "\"1e-320 mm\"",
    "\"12 parsec\"",
    "\"grey_cast_iron\"",
    "\"elastic\"",
    "\"half_plane\"",
    "\"run_in\"",
    "\"line\"",
    "\"external\"",
    "\"\\u0000\"",
    "\"\"\"\n\n\"\"\"",
    "'\u{1d11e}'",
];

/// A value as it stands in a scene file.
fn value(random: &mut Random) -> String {
    match random.below(4) {
        0 => (*random.pick(&VALUES)).to_owned(),
        1 => format!("{:?}", random.any()),
        2 => format!("{}", random.round()),
        _ => {
            let units = ["mm", "um", "m", "K", "degC", "MPa", "kN", "km/h", "min", "h", "W/(m2.K)", "mm3/(N.m)", "%"];
            format!("\"{} {}\"", random.round(), random.pick(&units))
        }
    }
}

/// A key of the table, or none.
fn key(random: &mut Random) -> String {
    let row = random.pick(TABLE);
    match random.below(6) {
        0 => format!("\"{}\"", row.name),
        1 => format!("{}[1]", row.name),
        2 => ["experiment.stop", "experiment.step", "experiment.tolerance", "experiment.start", "punch.material"]
            [random.below(5)]
        .to_owned(),
        _ => row.name.to_owned(),
    }
}

fn change(text: &mut String, random: &mut Random) {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = random.below(lines.len().max(1));
    match random.below(9) {
        0..=2 if !lines.is_empty() => {
            let value = value(random);
            if let Some((key, _)) = lines[at].split_once('=') {
                lines[at] = format!("{key}= {value}");
            }
        }
        3 if !lines.is_empty() => {
            let line = lines[random.below(lines.len())].clone();
            lines.insert(at, line);
        }
        4 if !lines.is_empty() => {
            lines.remove(at);
        }
        5 if random.one_in(2) => {
            let names: Vec<&str> = TABLES.iter().map(|table| table.name).chain(["unobtainium"]).collect();
            let at = lines.iter().position(|line| line.starts_with("material")).unwrap_or(at);
            lines.insert(at.min(lines.len()), format!("property_table.material = {:?}", random.pick(&names)));
        }
        5 => {
            let line = format!("{} = {}", key(random), value(random));
            lines.insert(at.min(lines.len()), line);
        }
        6 if random.one_in(8) => {
            let depth = 1 + random.below(3000);
            let (open, close) = *random.pick(&[("[", "]"), ("{a=", "}"), ("[{a=", "}]"), ("a.", "")]);
            lines.push(format!("nested = {}1{}", open.repeat(depth), close.repeat(depth)));
            lines.insert(0, format!("{}b = 1", "a.".repeat(depth)));
        }
        _ => {
            text::change(text, &SHIPPED, random);
            return;
        }
    }
    *text = lines.join("\n");
}

pub(crate) fn run(seed: u64, kinds: &mut Kinds) -> Verdict {
    let mut random = Random::new(seed, 0);
    let mut text = random.pick(&SHIPPED).clone();
    for _ in 0..1 + random.below(4) {
        change(&mut text, &mut random);
    }
    check(&text, kinds)
}

pub(crate) fn check(text: &str, kinds: &mut Kinds) -> Verdict {
    enter("scene_file::parse");
    let read = match scene_file::parse(text) {
        Ok(read) => read,
        Err(problems) => {
            if problems.0.is_empty() {
                return Err("a scene is refused without a reason".into());
            }
            let lines = text.matches('\n').count() + 1;
            for problem in problems.0 {
                if problem.line > lines || problem.reason.is_empty() {
                    return Err(format!("a problem without its place: {problem:?}"));
                }
                kinds.note(&problem.reason);
            }
            return Ok(());
        }
    };
    let packaged = read.packaged;
    for &reference in &read.given {
        let (row, value) = (&TABLE[FLAT[reference as usize].0 as usize], packaged.starts[reference as usize]);
        if row.causality == Causality::Parameter {
            check_parameter(reference, value)
                .map_err(|refusal| format!("accepted, but the FMU refuses it: {refusal}"))?;
        } else if !value.is_finite() {
            return Err(format!("the start value {value} of {} is accepted", row.name));
        }
    }
    scene::slot::check(&packaged).map_err(|reason| format!("accepted, but not packaged: {reason}"))?;
    enter("Scene::new");
    match Scene::new(&packaged.starts, Some(packaged.experiment.tolerance)) {
        Ok(scene) => {
            for text in scene.warnings() {
                kinds.note(&text);
            }
        }
        Err(broken) => kinds.note(&broken.to_string()),
    }
    enter("description::write");
    let xml = fmu_build::package::model_description(&packaged, &read.description);
    enter("Description::parse");
    fmu_host::Description::parse(&xml).map_err(|failure| format!("modelDescription.xml: {}", failure.reason))?;
    Ok(())
}
