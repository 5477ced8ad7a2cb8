//! `cargo fmu cycles`: reciprocating sliding over many cycles by cycle jumps.

use crate::output::{self, print_line, print_text};
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use crate::{arguments, scenes};
use analyses::cycles::{Course, Options, Station, advance};
use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;

/// Advance a reciprocating scene over many cycles at nominal load and speed.
///
/// Cycles are computed one by one only where the contact changes from one to the next; elsewhere implicit cycle jumps with an
/// error estimate each skip many cycles. On a straight track that wears, without heat, a jump is a cycle with many times the wear.
/// Prints the jumps, and the worn depths and contact temperature at the end.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of a built-in scene; without one the stock scene.
    scene: Option<String>,
    /// Number of cycles.
    #[arg(long, value_name = "N", default_value_t = 1e6, value_parser = arguments::number, allow_negative_numbers = true)]
    cycles: f64,
    /// Largest estimated error of a jump: of the shape over the elastic displacement under the mean pressure, of the heat over
    /// the heat, of the wear over that of the jump.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-3, value_parser = arguments::number, allow_negative_numbers = true)]
    tolerance: f64,
    /// Cells of the contact line; by default the scene's, or 33.
    #[arg(long, value_name = "N", value_parser = arguments::whole::<u16>(3..=1025), allow_negative_numbers = true)]
    cells: Option<u16>,
    /// Without heat.
    #[arg(long)]
    cold: bool,
    /// Give a variable of the scene another value, as punch.wear_coefficient=1e-14; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the jumps as JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Draw edge pressure, wear and temperature over the cycles as SVG into this file.
    #[arg(short, long, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Everything wrong with the scene, one without reciprocating sliding, a cycle without a solution, a file that cannot be
/// written.
pub fn execute(arguments: &Arguments) -> Result<()> {
    output::check_ending(arguments.output.as_deref(), &["svg"])?;
    let course = course(arguments)?;
    if arguments.json {
        print_line!("{:#}", course.record());
    } else {
        print_text!("{}", course.table());
    }
    if let Some(path) = &arguments.output {
        course.figure().write(path)?;
        if !arguments.json {
            print_line!("drawn in {}", path.display());
        }
    }
    if let Some(warning) = &course.warning {
        eprintln!("warning: {warning}");
    }
    Ok(())
}

fn course(arguments: &Arguments) -> Result<Course> {
    let mut file = scenes::load(arguments.scene.as_deref())?;
    for assignment in &arguments.set {
        scenes::assign(&mut file, assignment)?;
    }
    scenes::warn(&file);
    let Arguments { cycles, tolerance, cells, cold, .. } = *arguments;
    let bar = ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:30} {msg}")?);
    let course = advance(&file, &Options { cycles, tolerance, cells, cold }, &mut |passed, computed| {
        bar.set_position((1000.0 * (1.0 + passed).ln() / (1.0 + cycles).ln()) as u64);
        bar.set_message(format!("{passed} cycles, {computed} computed"));
    });
    bar.finish_and_clear();
    course
}

/// A scene over its cycles as the command prints and draws it.
trait Presentation {
    fn table(&self) -> String;
    fn figure(&self) -> Figure;
}

impl Presentation for Course {
    fn table(&self) -> String {
        let mut text = format!(
            "{}{}\n{:>12} {:>12} {:>10} {:>9} {:>10} {:>12} {:>12}",
            self.name,
            if self.warm { ", with heat" } else { ", without heat" },
            "cycles",
            "jump",
            "estimate",
            "computed",
            "p_max/p_m",
            "punch, µm",
            "strip, µm"
        );
        text += if self.warm { "    T, degC\n" } else { "\n" };
        // Of cycles computed one after the other, the first and the last.
        let single = |index: usize| self.stations.get(index).is_some_and(|station| station.length == 1.0);
        for (index, station) in self.stations.iter().enumerate() {
            if index > 0 && single(index - 1) && single(index) && single(index + 1) {
                continue;
            }
            text += &format!(
                "{:>12} {:>12} {:>10.1e} {:>9} {:>10.4} {:>12.6} {:>12.6}",
                station.cycles,
                station.length,
                station.estimate,
                station.computed,
                station.highest_pressure / self.mean_pressure,
                1e6 * station.worn[0],
                1e6 * station.worn[1]
            );
            text += &if self.warm { format!(" {:>10.2}\n", station.temperature - 273.15) } else { "\n".into() };
        }
        if let Some(last) = self.stations.last() {
            text += &format!(
                "{} cycles from {} computed ones; sum of the error estimates {:.1e}\n",
                last.cycles, last.computed, last.accumulated
            );
        }
        text
    }

    fn figure(&self) -> Figure {
        let over = |value: &dyn Fn(&Station) -> f64| -> Vec<(f64, f64)> {
            self.stations.iter().map(|station| (station.cycles, value(station))).collect()
        };
        let cycles = || Axis::logarithmic("cycles");
        let worn = ["punch", "strip"].into_iter().enumerate().filter_map(|(body, name)| {
            let depth = over(&|s| 1e6 * s.worn[body]);
            let wears = depth.iter().any(|(_, depth)| *depth > 0.0);
            wears.then(|| Series::line(name, depth).with(Mark::LineAndPoints))
        });
        let worn: Vec<Series> = worn.collect();
        let mut panels = vec![
            Panel::new(
                "Largest mean pressure of the forward half-stroke",
                cycles(),
                Axis::new("pressure (MPa)"),
                vec![Series::line("", over(&|s| 1e-6 * s.highest_pressure)).with(Mark::LineAndPoints)],
            ),
            Panel::new("Mean worn depth", cycles(), Axis::logarithmic("depth (µm)"), worn),
        ];
        if self.warm {
            let temperature = vec![Series::line("", over(&|s| s.temperature - 273.15)).with(Mark::LineAndPoints)];
            panels.push(Panel::new("Mean contact temperature", cycles(), Axis::new("temperature (°C)"), temperature));
        }
        Figure::new(format!("{} over its cycles", self.name), panels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_cycles_of_the_reciprocating_punch() {
        let arguments = Arguments {
            scene: Some("reciprocating_punch".into()),
            cycles: 1e6,
            tolerance: 1e-2,
            cells: Some(17),
            cold: true,
            set: Vec::new(),
            json: false,
            output: None,
        };
        let course = course(&arguments).unwrap();
        let last = course.stations.last().unwrap();
        // k p s, independent of the path.
        let expected = 3.9e-14 * course.mean_pressure * 6e-3 * 1e6;
        assert!((last.worn[0] / expected - 1.0).abs() < 1e-6, "{} {expected}", last.worn[0]);
        assert!(last.computed < 2000 && course.table().contains("1000000"), "{}", course.table());
        assert!((last.highest_pressure / course.mean_pressure - 2.0).abs() < 1e-3, "{}", course.table());
        assert!(course.figure().svg().unwrap().contains("depth (µm)"));
    }
}
