//! Checks that a scene fits the machine of an example.

use super::Example;
use anyhow::{Context, Result, bail};
use fmu_file::archive;
use fmu_host::Description;
use scene::slot::Packaged;
use scene::variables;
use scene_file::nominal::neighbours;
use std::f64::consts::PI;
use std::path::Path;

const CLOSED: f64 = 2.0;
const LINE: f64 = 1.0;
const ANNULAR: f64 = 2.0;
const PERIODIC: f64 = 3.0;

/// Largest fraction of the disc covered by pads.
const PADS: f64 = 0.5;

pub(crate) fn check_scene(example: Example, packaged: &Packaged) -> Result<()> {
    check(example, &packaged.name, &|name| Some(packaged.starts[variables::find(name)? as usize]))
}

/// The same with the start values of an .fmu.
pub(crate) fn check_fmu(example: Example, file: &Path) -> Result<()> {
    let text = archive::entry(file, "modelDescription.xml").with_context(|| {
        format!("--fmu {}: it is no .fmu, which is a zip archive with modelDescription.xml", file.display())
    })?;
    let description =
        Description::parse(&String::from_utf8(text)?).with_context(|| format!("reading {}", file.display()))?;
    check(example, &description.model_name, &|name| description.find(name).ok()?.start.parse().ok())
}

fn check(example: Example, name: &str, start: &dyn Fn(&str) -> Option<f64>) -> Result<()> {
    let of = |variable: &str| start(variable).with_context(|| format!("{name} has no start value of {variable}"));
    let (geometry, radius) = (of("contact.geometry")?, of("contact.mean_radius")?);
    let faces = of("contact.faces")?;
    let closed = of("strip.path")? == CLOSED;
    let covered = covered(&of)?;
    let (fits, wanted) = match example {
        Example::DiscBrake | Example::VehicleBrake => (
            closed && geometry != PERIODIC && radius > 0.0 && covered <= PADS && faces == 2.0,
            "pads on the disc of a car's brake: strip.path = closed, contact.geometry = line or annular, \
             contact.mean_radius above 0 m, contact.faces = 2, at most half of the disc covered",
        ),
        Example::Clutch => (
            closed && geometry == ANNULAR && radius > 0.0 && covered > PADS,
            "the facing of a clutch: strip.path = closed, contact.geometry = annular, contact.mean_radius above 0 m, more than \
             half of the plate covered",
        ),
        Example::ReciprocatingPunch => (
            !closed && of("nominal.stroke")? > 0.0,
            "a reciprocating punch: strip.path = straight, nominal.stroke above 0 m",
        ),
        Example::PinOnDisk => (
            closed && geometry == LINE && radius > 0.0 && covered <= PADS && faces == 1.0,
            "a pin on a turning disk: strip.path = closed, contact.geometry = line, contact.mean_radius above 0 m, contact.faces = 1",
        ),
        // Refused before: its cases have scenes of their own.
        Example::Published => (false, "no scene but those of its cases"),
        Example::HotSpots => {
            (closed && geometry == PERIODIC, "a ring on a ring: strip.path = closed, contact.geometry = periodic")
        }
    };
    if let Some((neighbour, _)) = neighbours(|name| start(name).unwrap_or(0.0)).first().filter(|_| fits) {
        bail!(
            "the scene {name} has no {neighbour}, and no input of {} gives it; set {neighbour}=\"20 degC\"",
            example.folder()
        );
    }
    if fits {
        return Ok(());
    }
    let word = |number: f64, words: &[&'static str]| words.get(number as usize - 1).copied().unwrap_or("unknown");
    bail!(
        "the scene {name} does not fit {}, which drives {wanted}; the scene has strip.path = {}, contact.geometry = {}, \
         contact.mean_radius = {radius} m, contact.faces = {faces}, nominal.stroke = {} m, and covers {covered:.3} of its path",
        example.folder(),
        word(of("strip.path")?, &["straight", "closed"]),
        word(geometry, &["line", "annular", "periodic"]),
        of("nominal.stroke")?,
    )
}

/// Part of the path that the punches cover; 0 of a straight one.
fn covered(of: &dyn Fn(&str) -> Result<f64>) -> Result<f64> {
    let around = 2.0 * PI * of("contact.mean_radius")?;
    let length = of("strip.length")?;
    let length = if length > 0.0 { length } else { around };
    let covered = match (of("strip.path")? == CLOSED, of("contact.geometry")?) {
        (false, _) => 0.0,
        (true, PERIODIC) => 1.0,
        (true, ANNULAR) => of("punch.count")? * of("depth")? / around,
        (true, _) => of("punch.count")? * of("punch.width")? / length,
    };
    Ok(covered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use clap::ValueEnum;

    fn packaged(name: &str) -> Packaged {
        scenes::load(Some(name)).unwrap().packaged
    }

    #[test]
    fn every_example_takes_its_own_scene_and_no_other_machine() {
        let machines = || Example::value_variants().iter().filter(|&&example| example != Example::Published);
        for example in machines() {
            for scene in machines() {
                let fits = check_scene(*example, &packaged(scene.scene()));
                assert_eq!(fits.is_ok(), example.scene() == scene.scene(), "{example:?} {scene:?}: {fits:?}");
            }
        }
    }

    #[test]
    fn a_neighbour_needs_a_temperature() {
        let mut file = scenes::load(Some("disc_brake")).unwrap();
        scenes::assign(&mut file, "strip.external_conductance=3.5").unwrap();
        let told = check_scene(Example::DiscBrake, &file.packaged).unwrap_err().to_string();
        assert!(told.ends_with("set strip.external_temperature=\"20 degC\""), "{told}");
        scenes::assign(&mut file, "strip.external_temperature=20 degC").unwrap();
        check_scene(Example::DiscBrake, &file.packaged).unwrap();
    }

    #[test]
    fn a_refusal_names_the_variables_and_their_values() {
        let told = format!("{:#}", check_scene(Example::DiscBrake, &packaged("clutch")).unwrap_err());
        for part in ["clutch", "disc_brake", "contact.geometry = annular", "covers 1.000 of its path"] {
            assert!(told.contains(part), "{told} does not contain {part}");
        }
        let text = crate::project::root().join("README.md");
        let told = format!("{:#}", check_fmu(Example::DiscBrake, &text).unwrap_err());
        assert!(told.starts_with(&format!("--fmu {}: it is no .fmu", text.display())), "{told}");
    }
}
