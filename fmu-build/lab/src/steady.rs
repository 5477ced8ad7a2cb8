//! `cargo fmu steady`: the steady state of a scene, without time integration.

mod law;

use std::path::{Path, PathBuf};

use analyses::steady::{Options, solve};
use anyhow::{Result, bail};
use scene::Scene;
use scene_file::SceneFile;

use crate::output::{self, print_line, print_text};
use crate::{arguments, drawing, scenes};

/// Default number of cells for the law, which computes many states.
const LAW_CELLS: usize = 33;

/// Pressure of both directions, worn shape, wear rate, wear dissipation power; and the magnitude of the relative velocity
/// beyond the rigid motion. First without heat, then with it: temperatures and their range in a cycle,
/// heat flows, pressure and shape. Ends with an error that gives the reason where there is no steady state; where there is
/// one without heat but not with it, the reason is printed.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock scene.
    scene: Option<String>,
    /// Print the state as JSON instead of a table: at the cells, and at the stations of the FMU's profiles.
    #[arg(long)]
    json: bool,
    /// Cells of the contact line; by default the scene's, or 65.
    #[arg(long, value_name = "N", value_parser = arguments::whole::<u16>(3..=1025), allow_negative_numbers = true)]
    cells: Option<u16>,
    /// Speed of the backward half-stroke, in m/s, where it is not the nominal velocity.
    #[arg(long, value_name = "M_PER_S", value_parser = arguments::number, allow_negative_numbers = true)]
    return_speed: Option<f64>,
    /// Give a variable of the scene another value, as holder.pivot_height="30 mm"; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Without heat.
    #[arg(long)]
    cold: bool,
    /// Instead of one state, the law of the influence of heat on the steady pressures: their difference with and without
    /// heat against the length of a cycle over the thermal time of the contact, over five decades.
    #[arg(long, conflicts_with_all = ["cold", "return_speed"])]
    law: bool,
    /// Draw pressure, shape and temperature, as SVG, PDF or PNG by the file's ending; of the law its curves (SVG) and a table (CSV) beside
    /// them.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.law {
        output::check_ending(arguments.output.as_deref(), &["svg"])?;
    } else if let Some(path) = &arguments.output {
        output::check_file("--output", path)?;
        drawing::format("--output", path)?;
    }
    if let (Some(path), Some(scene)) = (&arguments.output, &arguments.scene)
        && output::would_replace(path, Path::new(scene))
    {
        bail!("--output {} would replace the scene file", path.display());
    }
    if arguments.law {
        return write_law(arguments);
    }
    let solved = solve(&read(arguments)?, &arguments.options())?;
    if arguments.json {
        print_line!("{:#}", solved.record());
    } else {
        print_text!("{}", solved.table());
    }
    if let Some(path) = &arguments.output {
        drawing::write("steady", &solved.record(), "--output", path)?;
        if !arguments.json {
            print_line!("drawn in {}", path.display());
        }
    }
    for warning in analyses::steady::heat::warnings(&solved) {
        eprintln!("warning: {warning}");
    }
    solved.check()
}

/// The scene with what the command sets.
fn read(arguments: &Arguments) -> Result<SceneFile> {
    let scene = scenes::changed(arguments.scene.as_deref(), &arguments.set)?;
    scenes::warn(&scene);
    Ok(scene)
}

impl Arguments {
    fn options(&self) -> Options {
        Options { cells: self.cells, return_speed: self.return_speed, cold: self.cold }
    }
}

fn write_law(arguments: &Arguments) -> Result<()> {
    let packaged = read(arguments)?.packaged;
    let scene = Scene::new(&packaged.starts, Some(packaged.experiment.tolerance))?;
    let name = packaged.name;
    if scene.nominal_stroke == 0.0 {
        bail!("the law is one of reciprocating sliding; the scene {name} is unidirectional (nominal.stroke = 0 m)");
    }
    let law = law::Law::new(&name, &scene, arguments.cells.map_or(LAW_CELLS, usize::from))?;
    if arguments.json {
        print_line!("{:#}", law.record());
    } else {
        print_text!("{}", law.table());
    }
    if let Some(path) = &arguments.output {
        law.write(path)?;
        if !arguments.json {
            print_line!("drawn in {}", path.display());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use analyses::steady::Solved;

    fn arguments(scene: &str) -> Arguments {
        Arguments {
            scene: Some(scene.to_owned()),
            json: false,
            cells: Some(33),
            return_speed: None,
            set: Vec::new(),
            cold: false,
            law: false,
            output: None,
        }
    }

    fn solved(arguments: &Arguments) -> Result<Solved> {
        solve(&read(arguments)?, &arguments.options())
    }

    #[test]
    fn the_reciprocating_punch_is_printed_and_recorded() {
        let solved = solved(&arguments("reciprocating_punch")).unwrap();
        let table = solved.table();
        for text in ["run-in, reciprocating", "peak pressure, MPa", "  33.3333\n", "jump of the approach"] {
            assert!(table.contains(text), "{text} is missing in\n{table}");
        }
        let record = solved.record();
        assert_eq!(record["strokes"][1]["direction"], "backward");
        assert_eq!(record["x"].as_array().unwrap().len(), 33);
        assert!(record["relative_velocity"]["elastic"]["reversal"].as_f64().unwrap() > 0.0);
        // With heat: all friction heat leaves the bodies.
        assert!(table.contains("contact temperature, degC"), "{table}");
        let flow = |name: &str| record["heat"]["heat_flow"][name].as_f64().unwrap();
        let lost = flow("punch_top") + flow("strip_base") + flow("ambient");
        assert!((lost / flow("friction") - 1.0).abs() < 1e-6, "{lost} of {}", flow("friction"));
        assert!((flow("friction") / record["friction_power"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_scene_without_a_steady_state_is_refused_with_the_reason() {
        let mut wearing = arguments("reciprocating_punch");
        wearing.return_speed = Some(-1.0);
        let error = format!("{:#}", solved(&wearing).err().unwrap());
        assert!(error.contains("return_speed = -1 m/s must be above 0 m/s and at most 10000 m/s"), "{error}");
    }

    #[test]
    fn every_built_in_scene_has_a_steady_state_or_says_why_not() {
        for name in scenes::names() {
            match solved(&arguments(&name)) {
                Ok(solved) => assert!(solved.table().contains(&name)),
                Err(error) => assert!(format!("{error:#}").contains("no "), "{name}: {error:#}"),
            }
        }
    }
}
